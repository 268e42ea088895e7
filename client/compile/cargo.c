/* cargo.c - see cargo.h */
#include "config.h"

#include "compile/cargo.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int
cargo_init(struct cargo *c, const struct rad_bundle *bundle, const char *dir,
           struct rad_error *err)
{
    char hex[RAD_SHA_HEX + 1];
    int rc;

    memset(c, 0, sizeof *c);
    c->bundle = bundle;
    c->dir = dir;
    if (bundle->n + 1 > MSG_MAX_FILES)
        return rad_fail(err, RAD_EDATA, "the scene needs more than %d files",
                        MSG_MAX_FILES - 1);
    c->manifest = rad_bundle_format(bundle, &c->manifest_len);
    c->hashes = calloc((size_t)bundle->n + 1, MSG_HASH);
    if (!c->manifest || !c->hashes) {
        rc = rad_fail_memory(err);
    } else {
        rc = rad_sha_hex(c->manifest, c->manifest_len, hex, err);
    }
    if (rc < 0) {
        cargo_release(c);
        return rc;
    }
    rad_sha_from_hex(hex, c->hashes);
    for (int i = 0; i < bundle->n; i++)
        rad_sha_from_hex(bundle->entries[i].hash,
                         c->hashes + ((size_t)i + 1) * MSG_HASH);
    /* the manifest stays first, whatever its hash */
    c->n =
        1 + (uint32_t)rad_sha_unique(c->hashes + MSG_HASH, (size_t)bundle->n);
    return 0;
}

void
cargo_release(struct cargo *c)
{
    free(c->manifest);
    free(c->hashes);
    memset(c, 0, sizeof *c);
}

static int
read_manifest(const struct cargo *c, unsigned char **bytes, size_t *len,
              struct rad_error *err)
{
    *bytes = malloc(c->manifest_len + 1);
    if (!*bytes)
        return rad_fail_memory(err);
    memcpy(*bytes, c->manifest, c->manifest_len);
    *len = c->manifest_len;
    return 0;
}

int
cargo_read(const struct cargo *c, const uint8_t hash[MSG_HASH],
           unsigned char **bytes, size_t *len, struct rad_error *err)
{
    char hex[RAD_SHA_HEX + 1], path[4096];

    if (memcmp(hash, c->hashes, MSG_HASH) == 0)
        return read_manifest(c, bytes, len, err);
    rad_sha_to_hex(hash, hex);
    for (int i = 0; i < c->bundle->n; i++) {
        const struct rad_bundle_entry *e = &c->bundle->entries[i];

        if (strcmp(e->hash, hex) != 0)
            continue;
        if (snprintf(path, sizeof path, "%s/%s", c->dir, hex) >=
            (int)sizeof path)
            return rad_fail(err, RAD_EIO, "path too long: '%s'", c->dir);
        *bytes = rad_file_read(path, e->size, len, err);
        return *bytes ? 0 : err->code;
    }
    return rad_fail(err, RAD_EPROTO,
                    "the coordinator wants a file that is not the scene's");
}
