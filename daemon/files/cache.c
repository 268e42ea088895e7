/* cache.c - see cache.h
 *
 * A file has an entry while it is there or some job uses it; entries are found
 * by a table of chains.  Entries that no job uses are in a list by their last
 * use; room is made from the oldest end.  A file that another program removed
 * is missed when a job comes that uses it; until then its bytes are counted.
 *
 * Whether the disk has room is found by allocating it (blobs_probe()), for
 * statvfs() knows no quotas. */
#include "config.h"

#include "files/cache.h"

#include "base/list.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define LEAST_BUCKETS 256

struct entry {
    struct entry *chain;
    struct entry *older, *newer; /* while no job uses the file */
    uint8_t hash[MSG_HASH];
    uint64_t bytes;
    bool there;
    uint32_t users; /* jobs that use the file */
};

/* A job that uses files. */
struct user {
    struct user *next;
    uint8_t job[MSG_JOB];
    uint32_t n;
    uint8_t hash[]; /* no two are the same */
};

struct cache {
    struct blobs *blobs;
    uint64_t limit;
    uint64_t bytes;    /* of files that are there */
    uint64_t unused;   /* of files that are there, but that no job uses */
    uint64_t expected; /* of files that arrive */
    struct entry **buckets;
    size_t nbuckets; /* a power of 2 */
    size_t n;        /* entries */
    struct entry *oldest, *newest;
    struct user *users;
};

/* --- entries --- */

static struct entry **
bucket_of(const struct cache *c, const uint8_t *hash)
{
    uint64_t first;

    memcpy(&first, hash, sizeof first);
    return &c->buckets[first & (c->nbuckets - 1)];
}

static struct entry *
find(const struct cache *c, const uint8_t *hash)
{
    struct entry *e = *bucket_of(c, hash);

    while (e && memcmp(e->hash, hash, MSG_HASH) != 0)
        e = e->chain;
    return e;
}

/* Double the table; without memory the chains stay as long as they are. */
static void
grow(struct cache *c)
{
    size_t n = 2 * c->nbuckets, old = c->nbuckets;
    struct entry **was = c->buckets, **v = calloc(n, sizeof *v);

    if (!v)
        return;
    c->buckets = v;
    c->nbuckets = n;
    for (size_t i = 0; i < old; i++)
        while (was[i]) {
            struct entry *e = was[i], **at = bucket_of(c, e->hash);

            was[i] = e->chain;
            e->chain = *at;
            *at = e;
        }
    free(was);
}

/* Put an entry into the list of those that no job uses. */
static void
push_newest(struct cache *c, struct entry *e)
{
    c->unused += e->bytes;
    e->newer = NULL;
    e->older = c->newest;
    *(c->newest ? &c->newest->newer : &c->oldest) = e;
    c->newest = e;
}

static void
unlist(struct cache *c, struct entry *e)
{
    *(e->older ? &e->older->newer : &c->oldest) = e->newer;
    *(e->newer ? &e->newer->older : &c->newest) = e->older;
    e->older = e->newer = NULL;
    c->unused -= e->bytes;
}

/* Find the file's entry, or make one that no job uses.  NULL: memory is out. */
static struct entry *
put(struct cache *c, const uint8_t *hash)
{
    struct entry *e = find(c, hash), **at;

    if (e)
        return e;
    e = calloc(1, sizeof *e);
    if (!e)
        return NULL;
    memcpy(e->hash, hash, MSG_HASH);
    if (c->n++ >= c->nbuckets)
        grow(c);
    at = bucket_of(c, hash);
    e->chain = *at;
    *at = e;
    push_newest(c, e);
    return e;
}

/* Forget an entry without users. */
static void
drop(struct cache *c, struct entry *e)
{
    struct entry **at = bucket_of(c, e->hash);

    while (*at != e)
        at = &(*at)->chain;
    *at = e->chain;
    unlist(c, e);
    c->bytes -= e->bytes;
    c->n--;
    free(e);
}

static void
set_there(struct cache *c, struct entry *e, bool there, uint64_t bytes)
{
    uint64_t was = e->bytes;

    e->there = there;
    e->bytes = there ? bytes : 0;
    c->bytes += e->bytes - was;
    if (e->users == 0)
        c->unused += e->bytes - was;
}

/* --- room --- */

/* Remove the file that was used the longest time ago; false: jobs use all
 * files.
 */
static bool
evict(struct cache *c)
{
    char hex[RAD_SHA_HEX + 1], path[BLOBS_PATH_MAX];

    if (!c->oldest)
        return false;
    rad_sha_to_hex(c->oldest->hash, hex);
    blobs_path(c->blobs, hex, path);
    unlink(path);
    drop(c, c->oldest);
    return true;
}

/* Not rounded to whole MiB: a full cache of small files would seem to have
 * room.
 */
static double
mib(uint64_t bytes)
{
    return (double)bytes / (1 << 20);
}

/* Would there be room for so many bytes without all files that no job uses?  If
 * not, none of these is removed. */
static int
check_room(const struct cache *c, uint64_t bytes, struct rad_error *err)
{
    uint64_t used = c->bytes - c->unused + c->expected;
    uint64_t room = blobs_disk_free(c->blobs);

    if (used > c->limit || bytes > c->limit - used)
        return rad_fail(err, RAD_EFULL,
                        "no room in the cache: %.4g MiB more are needed, %.4g "
                        "are in use, and it may have %.4g (cache_mib)",
                        mib(bytes), mib(used), mib(c->limit));
    if (room < UINT64_MAX - c->unused && bytes > room + c->unused)
        return rad_fail(err, RAD_EFULL,
                        "no room on the disk: %.4g MiB more are needed, and "
                        "%.4g are free",
                        mib(bytes), mib(room + c->unused));
    return 0;
}

static void
keep_limit(struct cache *c, uint64_t bytes)
{
    while (c->bytes + c->expected + bytes > c->limit && evict(c))
        ;
}

static int
make_room(struct cache *c, uint64_t bytes, struct rad_error *err)
{
    struct rad_error why;
    int rc = check_room(c, bytes, err);

    if (rc < 0)
        return rc;
    keep_limit(c, bytes);
    do {
        memset(&why, 0, sizeof why);
        rc = blobs_probe(c->blobs, bytes, &why);
    } while (rc == RAD_EFULL && evict(c));
    if (rc < 0 && err)
        *err = why;
    return rc;
}

/* --- the start --- */

struct found {
    uint8_t hash[MSG_HASH];
    uint64_t bytes;
    struct timespec used;
};

struct listing {
    struct found *v;
    size_t n;
};

static int
list_file(void *arg, const char *name, const struct stat *st)
{
    struct listing *l = arg;
    struct found *f;

    if (!rad_list_grow(&l->v, l->n, sizeof *l->v))
        return RAD_ENOMEM;
    f = &l->v[l->n++];
    rad_sha_from_hex(name, f->hash);
    f->bytes = (uint64_t)st->st_size;
    f->used = st->st_atim;
    if (st->st_mtim.tv_sec > f->used.tv_sec)
        f->used = st->st_mtim;
    return 0;
}

static int
by_use(const void *a, const void *b)
{
    const struct timespec *s = &((const struct found *)a)->used;
    const struct timespec *t = &((const struct found *)b)->used;

    if (s->tv_sec != t->tv_sec)
        return s->tv_sec < t->tv_sec ? -1 : 1;
    return (s->tv_nsec > t->tv_nsec) - (s->tv_nsec < t->tv_nsec);
}

static int
take_stock(struct cache *c)
{
    struct listing l = { NULL, 0 };
    int rc = blobs_each(c->blobs, list_file, &l);

    if (rc == 0 && l.n > 0)
        qsort(l.v, l.n, sizeof *l.v, by_use);
    for (size_t i = 0; i < l.n && rc == 0; i++) {
        struct entry *e = put(c, l.v[i].hash);

        if (e)
            set_there(c, e, true, l.v[i].bytes);
        else
            rc = RAD_ENOMEM;
    }
    free(l.v);
    return rc;
}

struct cache *
cache_new(struct blobs *b, uint64_t limit, struct rad_error *err)
{
    struct cache *c = calloc(1, sizeof *c);

    if (c) {
        c->blobs = b;
        c->nbuckets = LEAST_BUCKETS;
        c->buckets = calloc(c->nbuckets, sizeof *c->buckets);
    }
    if (!c || !c->buckets || take_stock(c) < 0) {
        rad_fail_memory(err);
        cache_free(c);
        return NULL;
    }
    cache_set_limit(c, limit);
    return c;
}

void
cache_free(struct cache *c)
{
    if (!c)
        return;
    while (c->users)
        cache_leave(c, c->users->job);
    while (c->oldest)
        drop(c, c->oldest);
    free(c->buckets);
    free(c);
}

void
cache_set_limit(struct cache *c, uint64_t limit)
{
    c->limit = limit > 0 ? limit : blobs_disk_bytes(c->blobs) / 10;
    keep_limit(c, 0);
}

/* --- jobs --- */

static struct user *
new_user(const uint8_t *job, const struct msg_hashes *files)
{
    size_t bytes = (size_t)files->n * MSG_HASH;
    struct user *u = malloc(sizeof *u + bytes);

    if (!u)
        return NULL;
    memcpy(u->job, job, MSG_JOB);
    if (bytes > 0)
        memcpy(u->hash, files->hash, bytes);
    u->n = (uint32_t)rad_sha_unique(u->hash, files->n);
    return u;
}

/* Count one more job that uses the file, and look whether the file is there. */
static bool
use(struct cache *c, const uint8_t *hash)
{
    struct entry *e = put(c, hash);
    uint64_t bytes;
    bool there;

    if (!e)
        return false;
    if (e->users++ == 0)
        unlist(c, e);
    there = blobs_size(c->blobs, hash, &bytes);
    set_there(c, e, there, bytes);
    return true;
}

/* Count one job less that uses the file.  A file that no job uses any more is
 * the newest of these, by its time of access also in the next life. */
static void
leave(struct cache *c, const uint8_t *hash)
{
    struct entry *e = find(c, hash);
    char hex[RAD_SHA_HEX + 1];

    if (--e->users > 0)
        return;
    push_newest(c, e);
    rad_sha_to_hex(hash, hex);
    blobs_touch(c->blobs, hex);
    if (!e->there)
        drop(c, e);
}

static void
leave_first(struct cache *c, struct user *u, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++)
        leave(c, u->hash + (size_t)i * MSG_HASH);
    free(u);
}

void
cache_leave(struct cache *c, const uint8_t job[MSG_JOB])
{
    struct user **at = &c->users, *u;

    while (*at && memcmp((*at)->job, job, MSG_JOB) != 0)
        at = &(*at)->next;
    if (!(u = *at))
        return;
    *at = u->next;
    leave_first(c, u, u->n);
}

/* Of so many bytes of u's files, those that are not there. */
static uint64_t
missing(const struct cache *c, const struct user *u, uint64_t bytes)
{
    uint64_t there = 0;

    for (uint32_t i = 0; i < u->n; i++)
        there += find(c, u->hash + (size_t)i * MSG_HASH)->bytes;
    return there < bytes ? bytes - there : 0;
}

int
cache_use(struct cache *c, const uint8_t job[MSG_JOB],
          const struct msg_hashes *files, uint64_t bytes, struct rad_error *err)
{
    struct user *u = new_user(job, files);
    int rc = 0;

    if (!u)
        return rad_fail_memory(err);
    for (uint32_t i = 0; i < u->n; i++)
        if (!use(c, u->hash + (size_t)i * MSG_HASH)) {
            leave_first(c, u, i);
            return rad_fail_memory(err);
        }
    cache_leave(c, job); /* the job may have used files before */
    bytes = missing(c, u, bytes);
    if (bytes > 0)
        rc = make_room(c, bytes, err);
    if (rc < 0) {
        leave_first(c, u, u->n);
        return rc;
    }
    u->next = c->users;
    c->users = u;
    return 0;
}

/* --- files that arrive --- */

int
cache_expect(struct cache *c, uint64_t bytes, struct rad_error *err)
{
    int rc = make_room(c, bytes, err);

    if (rc == 0)
        c->expected += bytes;
    return rc;
}

void
cache_arrived(struct cache *c, const uint8_t hash[MSG_HASH], uint64_t bytes)
{
    struct entry *e = put(c, hash); /* NULL: counted in the next life only */

    c->expected -= bytes;
    if (e)
        set_there(c, e, true, bytes);
}

void
cache_given_up(struct cache *c, uint64_t bytes)
{
    c->expected -= bytes;
}

uint64_t
cache_bytes(const struct cache *c)
{
    return c->bytes;
}
