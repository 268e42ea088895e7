/* keyring.c - see keyring.h */
#include "config.h"

#include "net/key/keyring.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

struct keyring {
    char *path; /* NULL: no key file */
    struct keyfile file;
    struct keyfile before; /* the old keys, between reload and settle */
    bool settling;
    struct stat seen;
};

/* The state of the file at path; zeros if there is none. */
static void
look(const char *path, struct stat *st)
{
    if (stat(path, st) < 0)
        memset(st, 0, sizeof *st);
}

int
keyring_open(struct keyring **out, const char *path, struct rad_error *err)
{
    struct keyring *k = calloc(1, sizeof *k);
    int rc = 0;

    *out = NULL;
    if (!k || (path[0] && !(k->path = strdup(path)))) {
        free(k);
        return rad_fail_memory(err);
    }
    if (path[0]) {
        look(path, &k->seen);
        rc = keyfile_load(&k->file, path, err);
    }
    if (rc < 0) {
        keyring_free(k);
        return rc;
    }
    *out = k;
    return 0;
}

void
keyring_free(struct keyring *k)
{
    if (!k)
        return;
    keyring_settle(k);
    keyfile_release(&k->file);
    free(k->path);
    free(k);
}

bool
keyring_has_file(const struct keyring *k)
{
    return k->path != NULL;
}

const char *
keyring_path(const struct keyring *k)
{
    return k->path;
}

int
keyring_reload(struct keyring *k, struct rad_error *err)
{
    struct keyfile next;
    int rc;

    if (!k->path)
        return 0;
    keyring_settle(k);
    look(k->path, &k->seen); /* first: a change meanwhile is noticed later */
    rc = keyfile_load(&next, k->path, err);
    if (rc < 0)
        return rc;
    k->before = k->file;
    k->file = next;
    k->settling = true;
    return 0;
}

void
keyring_settle(struct keyring *k)
{
    if (k->settling)
        keyfile_release(&k->before);
    k->settling = false;
}

bool
keyring_changed(const struct keyring *k)
{
    struct stat st;

    if (!k->path)
        return false;
    look(k->path, &st);
    return st.st_ino != k->seen.st_ino || st.st_dev != k->seen.st_dev ||
           st.st_size != k->seen.st_size ||
           st.st_ctim.tv_sec != k->seen.st_ctim.tv_sec ||
           st.st_ctim.tv_nsec != k->seen.st_ctim.tv_nsec;
}

static const char *
fault_of(const struct key *k)
{
    if (!k)
        return "unknown key";
    switch (key_state(k, (int64_t)time(NULL))) {
    case KEY_EXPIRED:
        return "expired key";
    case KEY_RETIRED:
        return "retired key";
    default:
        return NULL;
    }
}

const char *
keyring_find(void *keyring, const char *id, uint8_t *secret)
{
    struct keyring *k = keyring;
    const struct key *key = keyfile_find(&k->file, id);
    const char *fault = fault_of(key);

    if (!fault)
        memcpy(secret, key->secret, KEY_SECRET);
    return fault;
}

const char *
keyring_fault(void *keyring, const char *id)
{
    struct keyring *k = keyring;
    const struct key *key = keyfile_find(&k->file, id), *old;
    const char *fault = fault_of(key);

    if (fault || !k->settling)
        return fault;
    old = keyfile_find(&k->before, id);
    return old && memcmp(old->secret, key->secret, KEY_SECRET) != 0
               ? "the key is another"
               : NULL;
}
