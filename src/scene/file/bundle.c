/* bundle.c - see bundle.h */
#include "config.h"

#include "scene/file/bundle.h"
#include "base/list.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define MAGIC      "radd-bundle 1\n"
#define SCENE_NAME "-"

static const char *const role_name[RAD_BUNDLE_NROLES] = { "scene", "file" };

void
rad_bundle_init(struct rad_bundle *b)
{
    memset(b, 0, sizeof *b);
}

void
rad_bundle_release(struct rad_bundle *b)
{
    for (int i = 0; i < b->n; i++)
        free(b->entries[i].name);
    free(b->entries);
    rad_bundle_init(b);
}

/* Compare in the order of a manifest's lines. */
static int
compare(const struct rad_bundle_entry *e, enum rad_bundle_role role,
        const char *name)
{
    if (e->role != role)
        return e->role < role ? -1 : 1;
    return strcmp(e->name, name);
}

/* Index of the first entry not before (role, name). */
static int
lower_bound(const struct rad_bundle *b, enum rad_bundle_role role,
            const char *name)
{
    int lo = 0, hi = b->n;

    while (lo < hi) {
        int mid = lo + (hi - lo) / 2;

        if (compare(&b->entries[mid], role, name) < 0)
            lo = mid + 1;
        else
            hi = mid;
    }
    return lo;
}

static int
check_name(const char *name, struct rad_error *err)
{
    size_t len = strlen(name);

    if (len == 0 || len > RAD_MAX_BUNDLE_NAME)
        return rad_fail(err, RAD_EDATA, "file name of %zu bytes", len);
    for (const char *p = name; *p; p++)
        if ((unsigned char)*p < ' ' || *p == 0x7f)
            return rad_fail(err, RAD_EDATA,
                            "control character in file name '%s'", name);
    return 0;
}

static int
reserve_one(struct rad_bundle *b, struct rad_error *err)
{
    if (b->n >= RAD_MAX_BUNDLE_FILES)
        return rad_fail(err, RAD_EDATA, "more than %d files",
                        RAD_MAX_BUNDLE_FILES);
    if (!rad_list_grow(&b->entries, (size_t)b->n, sizeof *b->entries))
        return rad_fail_memory(err);
    return 0;
}

int
rad_bundle_add(struct rad_bundle *b, enum rad_bundle_role role,
               const char *name, const char *hash, uint64_t size,
               struct rad_error *err)
{
    struct rad_bundle_entry *e, fresh = { .size = size, .role = role };
    int rc, at;

    if (role == RAD_BUNDLE_SCENE)
        name = SCENE_NAME;
    rc = check_name(name, err);
    if (rc)
        return rc;
    if (!rad_sha_valid(hash))
        return rad_fail(err, RAD_EDATA, "'%s' has no SHA-256", name);
    at = lower_bound(b, role, name);
    if (at < b->n && compare(&b->entries[at], role, name) == 0) {
        e = &b->entries[at];
        if (strcmp(e->hash, hash) != 0 || e->size != size)
            return rad_fail(err, RAD_EDATA, "'%s' is named twice", name);
        return 0;
    }
    rc = reserve_one(b, err);
    if (rc)
        return rc;
    fresh.name = strdup(name);
    if (!fresh.name)
        return rad_fail_memory(err);
    memcpy(fresh.hash, hash, sizeof fresh.hash);
    e = b->entries + at;
    memmove(e + 1, e, (size_t)(b->n - at) * sizeof *e);
    *e = fresh;
    b->n++;
    return 0;
}

const struct rad_bundle_entry *
rad_bundle_find(const struct rad_bundle *b, enum rad_bundle_role role,
                const char *name)
{
    int at;

    if (role == RAD_BUNDLE_SCENE)
        name = SCENE_NAME;
    at = lower_bound(b, role, name);
    if (at < b->n && compare(&b->entries[at], role, name) == 0)
        return &b->entries[at];
    return NULL;
}

void
rad_bundle_remove(struct rad_bundle *b, enum rad_bundle_role role,
                  const char *name)
{
    const struct rad_bundle_entry *found = rad_bundle_find(b, role, name);
    ptrdiff_t at = found ? found - b->entries : b->n;

    if (!found)
        return;
    free(b->entries[at].name);
    b->n--;
    memmove(b->entries + at, b->entries + at + 1,
            (size_t)(b->n - at) * sizeof *b->entries);
}

static int
by_hash(const void *a, const void *b)
{
    const struct rad_bundle_entry *const *x = a, *const *y = b;

    return strcmp((*x)->hash, (*y)->hash);
}

uint64_t
rad_bundle_bytes(const struct rad_bundle *b)
{
    const struct rad_bundle_entry **e = malloc((size_t)b->n * sizeof *e + 1);
    uint64_t sum = 0;

    for (int i = 0; e && i < b->n; i++)
        e[i] = &b->entries[i];
    if (e)
        qsort(e, (size_t)b->n, sizeof *e, by_hash);
    for (int i = 0; e && i < b->n; i++)
        if (i == 0 || strcmp(e[i]->hash, e[i - 1]->hash) != 0)
            sum += e[i]->size;
    free(e);
    return sum;
}

char *
rad_bundle_format(const struct rad_bundle *b, size_t *len)
{
    size_t size = sizeof MAGIC, used;
    char *text;

    for (int i = 0; i < b->n; i++) /* hash, 20 digits, role, name, separators */
        size += RAD_SHA_HEX + 20 + 5 + strlen(b->entries[i].name) + 4;
    text = malloc(size);
    if (!text)
        return NULL;
    used = (size_t)snprintf(text, size, "%s", MAGIC);
    for (int i = 0; i < b->n; i++) {
        const struct rad_bundle_entry *e = &b->entries[i];

        used += (size_t)snprintf(text + used, size - used, "%s %llu %s %s\n",
                                 e->hash, (unsigned long long)e->size,
                                 role_name[e->role], e->name);
    }
    *len = used;
    return text;
}

/* Read decimal digits, at most 19, which cannot overflow, and a blank. */
static const char *
parse_size(const char *p, const char *end, uint64_t *size)
{
    const char *first = p;

    *size = 0;
    while (p < end && *p >= '0' && *p <= '9' && p - first < 19)
        *size = *size * 10 + (uint64_t)(*p++ - '0');
    if (p == first || (*first == '0' && p - first > 1) || p == end || *p != ' ')
        return NULL;
    return p + 1;
}

static const char *
parse_role(const char *p, const char *end, enum rad_bundle_role *role)
{
    for (int r = 0; r < RAD_BUNDLE_NROLES; r++) {
        size_t n = strlen(role_name[r]);

        if (n < (size_t)(end - p) && memcmp(p, role_name[r], n) == 0 &&
            p[n] == ' ') {
            *role = (enum rad_bundle_role)r;
            return p + n + 1;
        }
    }
    return NULL;
}

/* Read the line from p to its newline, end. */
static int
parse_line(struct rad_bundle *b, const char *p, const char *end,
           struct rad_error *err)
{
    char hash[RAD_SHA_HEX + 1], name[RAD_MAX_BUNDLE_NAME + 1];
    enum rad_bundle_role role;
    uint64_t size;

    if (end - p <= RAD_SHA_HEX || p[RAD_SHA_HEX] != ' ')
        return rad_fail(err, RAD_EDATA, "bad line in manifest");
    memcpy(hash, p, RAD_SHA_HEX);
    hash[RAD_SHA_HEX] = '\0';
    p = parse_size(p + RAD_SHA_HEX + 1, end, &size);
    p = p ? parse_role(p, end, &role) : NULL;
    if (!p || end - p > RAD_MAX_BUNDLE_NAME || memchr(p, 0, end - p))
        return rad_fail(err, RAD_EDATA, "bad line in manifest");
    memcpy(name, p, (size_t)(end - p));
    name[end - p] = '\0';
    if (role == RAD_BUNDLE_SCENE && strcmp(name, SCENE_NAME) != 0)
        return rad_fail(err, RAD_EDATA, "bad line in manifest");
    if (b->n && compare(&b->entries[b->n - 1], role, name) >= 0)
        return rad_fail(err, RAD_EDATA, "manifest is out of order");
    return rad_bundle_add(b, role, name, hash, size, err);
}

int
rad_bundle_parse(struct rad_bundle *b, const char *text, size_t len,
                 struct rad_error *err)
{
    const size_t magic = sizeof MAGIC - 1;
    const char *p = text + magic, *end = text + len, *nl;
    int rc = 0;

    rad_bundle_init(b);
    if (len < magic || memcmp(text, MAGIC, magic) != 0)
        return rad_fail(err, RAD_EDATA, "not a bundle's manifest");
    for (int line = 2; p < end; line++, p = nl + 1) {
        nl = memchr(p, '\n', (size_t)(end - p));
        if (nl)
            rc = parse_line(b, p, nl, err);
        else
            rc = rad_fail(err, RAD_EDATA, "manifest is truncated");
        if (rc) {
            rad_error_where(err, "manifest:%d", line);
            rad_bundle_release(b);
            return rc;
        }
    }
    if (!rad_bundle_find(b, RAD_BUNDLE_SCENE, NULL)) {
        rad_bundle_release(b);
        return rad_fail(err, RAD_EDATA, "manifest has no scene");
    }
    return 0;
}

/* The path of a file of the bundle. */
static const struct rad_bundle_entry *
find_in_dir(const struct rad_bundle_dir *where, const char *name,
            char path[PATH_MAX], struct rad_error *err)
{
    const struct rad_bundle_entry *e =
        rad_bundle_find(where->bundle, RAD_BUNDLE_FILE, name);

    if (!e) {
        rad_fail(err, RAD_ENOINPUT, "file '%s' is not in the bundle", name);
        return NULL;
    }
    if ((size_t)snprintf(path, PATH_MAX, "%s/%s", where->dir, e->hash) >=
        PATH_MAX) {
        rad_fail(err, RAD_ENOINPUT, "path of '%s' is too long", name);
        return NULL;
    }
    return e;
}

static int
check_length(const struct rad_bundle_entry *e, uint64_t len,
             struct rad_error *err)
{
    if (len == e->size)
        return 0;
    return rad_fail(err, RAD_EDATA,
                    "'%s' has %llu bytes, its manifest says %llu", e->name,
                    (unsigned long long)len, (unsigned long long)e->size);
}

static unsigned char *
read_from_dir(void *arg, const char *name, size_t *len, struct rad_error *err)
{
    char path[PATH_MAX];
    const struct rad_bundle_entry *e = find_in_dir(arg, name, path, err);
    unsigned char *bytes =
        e ? rad_file_read(path, (size_t)e->size, len, err) : NULL;

    if (bytes && check_length(e, *len, err) < 0) {
        free(bytes);
        return NULL;
    }
    return bytes;
}

static int
open_in_dir(void *arg, const char *name, struct rad_error *err)
{
    char path[PATH_MAX];
    const struct rad_bundle_entry *e = find_in_dir(arg, name, path, err);
    int fd = e ? rad_file_open(path, err) : RAD_ENOINPUT, rc;
    struct stat st;

    if (fd < 0)
        return fd;
    rc = fstat(fd, &st) < 0 ? rad_fail(err, RAD_EIO, "cannot read '%s': %s",
                                       path, strerror(errno))
                            : check_length(e, (uint64_t)st.st_size, err);
    if (rc < 0) {
        close(fd);
        return rc;
    }
    return fd;
}

struct rad_files
rad_bundle_files(struct rad_bundle_dir *where)
{
    struct rad_files f = { read_from_dir, where, open_in_dir };

    return f;
}
