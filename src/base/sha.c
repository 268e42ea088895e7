/* sha.c - see sha.h */
#include "config.h"

#include "base/sha.h"

#include "base/hex.h"

#include <stdlib.h>
#include <string.h>

/* These functions are deprecated.  The ones that OpenSSL recommends read a
 * configuration file first and list all algorithms, which takes a millisecond;
 * a small picture starts four processes that would do so. */
#define OPENSSL_SUPPRESS_DEPRECATED
#include <openssl/sha.h>

int
rad_sha_init(struct rad_sha *sha, struct rad_error *err)
{
    sha->bad = false;
    sha->ctx = malloc(sizeof(SHA256_CTX));
    if (!sha->ctx)
        return rad_fail_memory(err);
    if (!SHA256_Init(sha->ctx)) {
        rad_sha_release(sha);
        return rad_fail(err, RAD_EINTERNAL, "SHA-256 is not available");
    }
    return 0;
}

void
rad_sha_update(struct rad_sha *sha, const void *p, size_t n)
{
    if (n && !SHA256_Update(sha->ctx, p, n))
        sha->bad = true;
}

int
rad_sha_final(struct rad_sha *sha, char hex[RAD_SHA_HEX + 1],
              struct rad_error *err)
{
    uint8_t sum[RAD_SHA_BYTES];

    if (!SHA256_Final(sum, sha->ctx))
        sha->bad = true;
    rad_sha_release(sha);
    if (sha->bad)
        return rad_fail(err, RAD_EINTERNAL, "SHA-256 failed");
    rad_sha_to_hex(sum, hex);
    return 0;
}

void
rad_sha_release(struct rad_sha *sha)
{
    free(sha->ctx);
    sha->ctx = NULL;
}

int
rad_sha_hex(const void *p, size_t n, char hex[RAD_SHA_HEX + 1],
            struct rad_error *err)
{
    struct rad_sha sha;
    int rc = rad_sha_init(&sha, err);

    if (rc)
        return rc;
    rad_sha_update(&sha, p, n);
    return rad_sha_final(&sha, hex, err);
}

void
rad_sha_to_hex(const uint8_t digest[RAD_SHA_BYTES], char hex[RAD_SHA_HEX + 1])
{
    rad_hex_write(digest, RAD_SHA_BYTES, hex);
}

void
rad_sha_from_hex(const char *hex, uint8_t digest[RAD_SHA_BYTES])
{
    rad_hex_read(hex, RAD_SHA_BYTES, digest);
}

static int
compare(const void *a, const void *b)
{
    return memcmp(a, b, RAD_SHA_BYTES);
}

size_t
rad_sha_unique(uint8_t *digests, size_t n)
{
    size_t kept = 0;

    if (n > 0)
        qsort(digests, n, RAD_SHA_BYTES, compare);
    for (size_t i = 0; i < n; i++) {
        const uint8_t *d = digests + i * RAD_SHA_BYTES;

        if (kept > 0 && compare(d - RAD_SHA_BYTES, d) == 0)
            continue;
        memmove(digests + kept++ * RAD_SHA_BYTES, d, RAD_SHA_BYTES);
    }
    return kept;
}

bool
rad_sha_among(const uint8_t *digests, size_t n,
              const uint8_t digest[RAD_SHA_BYTES])
{
    return n > 0 && bsearch(digest, digests, n, RAD_SHA_BYTES, compare) != NULL;
}

bool
rad_sha_valid(const char *hex)
{
    return rad_hex_valid(hex, RAD_SHA_BYTES);
}
