/* sound.c - see sound.h */
#include "config.h"

#include "files/sound.h"

#include "ground/disk.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define READ_BYTES (256u << 10)

struct sound {
    struct sound *next;
    uint8_t digest[RAD_SHA_BYTES];
    off_t size;
    struct timespec changed;
};

static struct sound *
find(const struct sounds *s, const uint8_t *digest)
{
    struct sound *f = s->bucket[digest[0] % SOUND_BUCKETS];

    while (f && memcmp(f->digest, digest, RAD_SHA_BYTES) != 0)
        f = f->next;
    return f;
}

/* Make room in a bucket: forget the file noted first. */
static void
make_room(struct sounds *s, unsigned bucket)
{
    struct sound **at = &s->bucket[bucket];

    if (s->n[bucket] < SOUND_MOST / SOUND_BUCKETS)
        return;
    while ((*at)->next)
        at = &(*at)->next;
    free(*at);
    *at = NULL;
    s->n[bucket]--;
}

static bool
unchanged(const struct sound *f, const struct stat *st)
{
    return f->size == st->st_size && f->changed.tv_sec == st->st_mtim.tv_sec &&
           f->changed.tv_nsec == st->st_mtim.tv_nsec;
}

/* Note a file with that digest; without memory it is read again next time. */
static void
note(struct sounds *s, const uint8_t *digest, const struct stat *st)
{
    unsigned bucket = digest[0] % SOUND_BUCKETS;
    struct sound *f = find(s, digest);

    if (!f) {
        f = calloc(1, sizeof *f);
        if (!f)
            return;
        make_room(s, bucket);
        memcpy(f->digest, digest, RAD_SHA_BYTES);
        f->next = s->bucket[bucket];
        s->bucket[bucket] = f;
        s->n[bucket]++;
    }
    f->size = st->st_size;
    f->changed = st->st_mtim;
}

/* Read the file, and compare its digest; returns as sounds_read(). */
static int
compare(int fd, const uint8_t *digest)
{
    char wanted[RAD_SHA_HEX + 1], hex[RAD_SHA_HEX + 1];
    char *buf = malloc(READ_BYTES);
    struct rad_sha sha;
    ssize_t n;

    if (!buf || rad_sha_init(&sha, NULL) < 0) {
        free(buf);
        return -1;
    }
    while ((n = read(fd, buf, READ_BYTES)) > 0)
        rad_sha_update(&sha, buf, (size_t)n);
    free(buf);
    if (n < 0) {
        rad_sha_release(&sha);
        return -1;
    }
    if (rad_sha_final(&sha, hex, NULL) < 0)
        return -1;
    rad_sha_to_hex(digest, wanted);
    return strcmp(hex, wanted) == 0;
}

int
sounds_read(const uint8_t digest[RAD_SHA_BYTES], const char *path)
{
    int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    int same = fd < 0 ? -1 : compare(fd, digest);

    if (same == 1 && disk_sync_data(fd, path, NULL) < 0)
        same = -1;
    if (fd >= 0)
        close(fd);
    return same;
}

bool
sounds_known(const struct sounds *s, const uint8_t digest[RAD_SHA_BYTES],
             const char *path)
{
    const struct sound *known = find(s, digest);
    struct stat st;

    return stat(path, &st) < 0 || !S_ISREG(st.st_mode) ||
           (known && unchanged(known, &st));
}

bool
sounds_check(struct sounds *s, const uint8_t digest[RAD_SHA_BYTES],
             const char *path, bool *damaged)
{
    struct stat st;
    int same;

    *damaged = false;
    if (stat(path, &st) < 0 || !S_ISREG(st.st_mode))
        return false;
    if (sounds_known(s, digest, path))
        return true;
    same = sounds_read(digest, path);
    if (same == 1)
        note(s, digest, &st);
    *damaged = same == 0;
    return same == 1;
}

int
sounds_require(struct sounds *s, const uint8_t digest[RAD_SHA_BYTES],
               const char *path, struct rad_error *err)
{
    bool damaged;
    struct stat st;

    if (sounds_check(s, digest, path, &damaged))
        return 0;
    if (stat(path, &st) == 0 && !S_ISREG(st.st_mode))
        return rad_fail(err, RAD_EDATA, "'%s' is no file", path);
    if (damaged)
        return rad_fail(err, RAD_EDATA, "'%s' is damaged: its hash is another",
                        path);
    if (access(path, R_OK) < 0)
        return mark_missing(path, errno, err);
    return rad_fail(err, RAD_EIO, "cannot read '%s'", path);
}

void
sounds_note(struct sounds *s, const uint8_t digest[RAD_SHA_BYTES],
            const char *path)
{
    struct stat st;

    if (stat(path, &st) == 0)
        note(s, digest, &st);
}

void
sounds_release(struct sounds *s)
{
    for (int i = 0; i < SOUND_BUCKETS; i++)
        while (s->bucket[i]) {
            struct sound *f = s->bucket[i];

            s->bucket[i] = f->next;
            free(f);
        }
}
