/* check_cache.c - which files a worker keeps */
#include "config.h"

#include "files/cache.h"
#include "tests/scratch.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

enum { KIB = 1024, FILES = 8 };

static struct blobs blobs;
static struct cache *c;
static uint8_t hashes[FILES * MSG_HASH];
static const uint8_t job_a[MSG_JOB] = { 0xaa }, job_b[MSG_JOB] = { 0xbb };

static bool sizeless; /* the file system tells no size */

/* In place of the C library's: a disk of a thousand blocks, all free. */
int
statvfs(const char *path, struct statvfs *s)
{
    (void)path;
    *s = (struct statvfs){ .f_frsize = 4 * KIB };
    s->f_blocks = s->f_bavail = sizeless ? 0 : 1000;
    return 0;
}

static const uint8_t *
hash_of(int i)
{
    return hashes + i * MSG_HASH;
}

static void
path_of(int i, char path[BLOBS_PATH_MAX])
{
    char hex[RAD_SHA_HEX + 1];

    rad_sha_to_hex(hash_of(i), hex);
    blobs_path(&blobs, hex, path);
}

static bool
is_there(int i)
{
    char path[BLOBS_PATH_MAX];

    path_of(i, path);
    return access(path, F_OK) == 0;
}

/* Of 1 KiB, used at that second. */
static void
make_file(int i, int used_s)
{
    struct timespec times[2] = { { used_s, 0 }, { 1, 0 } };
    char path[BLOBS_PATH_MAX];
    int fd;

    path_of(i, path);
    fd = open(path, O_WRONLY | O_CREAT, 0600);
    ck_assert_int_ge(fd, 0);
    ck_assert_int_eq(ftruncate(fd, KIB), 0);
    ck_assert_int_eq(futimens(fd, times), 0);
    close(fd);
}

static int
use(const uint8_t *job, int first, uint32_t n, uint64_t bytes)
{
    const struct msg_hashes files = { n, hash_of(first) };

    return cache_use(c, job, &files, bytes, NULL);
}

/* A file that comes from elsewhere. */
static int
arrive(int i)
{
    int rc = cache_expect(c, KIB, NULL);

    if (rc < 0)
        return rc;
    make_file(i, 1000 + i);
    cache_arrived(c, hash_of(i), KIB);
    return 0;
}

static void
set_up(void)
{
    scratch_make();
    ck_assert_int_eq(blobs_open(&blobs, dir, NULL), 0);
    for (int i = 0; i < FILES; i++)
        hashes[i * MSG_HASH] = (uint8_t)(i + 1);
    c = NULL;
}

static void
tear_down(void)
{
    cache_free(c);
    scratch_remove();
}

FIXTURE(set_up, tear_down)

/* The third of them was used the longest time ago. */
TEST(the_oldest_go_at_the_start)
{
    for (int i = 0; i < 4; i++)
        make_file(i, i == 2 ? 5 : 10 + i);
    c = cache_new(&blobs, 3 * KIB, NULL);
    ck_assert_ptr_nonnull(c);
    ck_assert(!is_there(2));
    ck_assert(is_there(0) && is_there(1) && is_there(3));
    ck_assert_uint_eq(cache_bytes(c), 3 * KIB);
    cache_set_limit(c, KIB);
    ck_assert(!is_there(0) && !is_there(1) && is_there(3));
}

TEST(what_comes_takes_the_place_of_the_oldest_that_no_job_uses)
{
    for (int i = 0; i < 3; i++)
        make_file(i, 10 + i);
    c = cache_new(&blobs, 4 * KIB, NULL);
    ck_assert_int_eq(use(job_a, 0, 1, KIB), 0);
    ck_assert_int_eq(arrive(3), 0); /* there is room */
    ck_assert(is_there(1));
    ck_assert_int_eq(arrive(4), 0);
    ck_assert(!is_there(1) && is_there(0) && is_there(2));
    ck_assert_int_eq(arrive(5), 0);
    ck_assert(!is_there(2) && is_there(0));
    cache_leave(c, job_a); /* now it is the newest */
    ck_assert_int_eq(arrive(6), 0);
    ck_assert(is_there(0) && !is_there(3));
    ck_assert_uint_eq(cache_bytes(c), 4 * KIB);
}

TEST(the_order_outlives_the_process)
{
    for (int i = 0; i < 3; i++)
        make_file(i, 10 + i);
    c = cache_new(&blobs, 3 * KIB, NULL);
    ck_assert_int_eq(use(job_a, 0, 1, KIB), 0);
    cache_leave(c, job_a);
    cache_free(c);
    c = cache_new(&blobs, 3 * KIB, NULL);
    ck_assert_int_eq(arrive(3), 0);
    ck_assert(is_there(0) && !is_there(1));
}

#define FULL_TEXT                                                              \
    "no room in the cache: 0.00293 MiB more are needed, 0.001953 are in use, " \
    "and it may have 0.003906 (cache_mib)"

TEST(nothing_goes_for_what_does_not_fit)
{
    struct rad_error err = { 0 };

    for (int i = 0; i < 3; i++)
        make_file(i, 10 + i);
    c = cache_new(&blobs, 4 * KIB, NULL);
    ck_assert_int_eq(use(job_a, 0, 2, 2 * KIB), 0);
    ck_assert_int_eq(use(job_b, 3, 3, 3 * KIB), RAD_EFULL);
    ck_assert_int_eq(use(job_b, 3, 3, UINT64_MAX), RAD_EFULL);
    ck_assert_int_eq(cache_expect(c, 3 * KIB, &err), RAD_EFULL);
    ck_assert_str_eq(err.what, FULL_TEXT);
    ck_assert_int_eq(cache_expect(c, UINT64_MAX, NULL), RAD_EFULL);
    ck_assert(is_there(0) && is_there(1) && is_there(2));
    cache_leave(c, job_a);
    ck_assert_int_eq(use(job_b, 3, 3, 3 * KIB), 0);
    ck_assert(!is_there(2)); /* the two of the first job are newer */
}

/* Two that arrive at the same time are both counted, until one is given up. */
TEST(what_is_on_its_way_has_its_place)
{
    c = cache_new(&blobs, 3 * KIB, NULL);
    ck_assert_int_eq(cache_expect(c, 2 * KIB, NULL), 0);
    ck_assert_int_eq(cache_expect(c, 2 * KIB, NULL), RAD_EFULL);
    cache_given_up(c, 2 * KIB);
    ck_assert_int_eq(cache_expect(c, 2 * KIB, NULL), 0);
}

TEST(files_of_a_job_are_counted_once)
{
    make_file(0, 10);
    make_file(1, 11);
    c = cache_new(&blobs, 2 * KIB, NULL);
    ck_assert_int_eq(use(job_a, 0, 2, 2 * KIB), 0);
    ck_assert_int_eq(use(job_a, 0, 2, 2 * KIB), 0); /* begun again */
    ck_assert_int_eq(use(job_b, 0, 1, KIB), 0);
    cache_leave(c, job_a);
    ck_assert_int_eq(arrive(2), 0);
    ck_assert(is_there(0) && !is_there(1));
    cache_leave(c, job_b);
    cache_leave(c, job_b);
    ck_assert_int_eq(arrive(3), 0);
    ck_assert_uint_eq(cache_bytes(c), 2 * KIB);
}

/* By somebody else, who also cut one and removed the folder. */
TEST(files_that_went_are_missed)
{
    char path[BLOBS_PATH_MAX];

    make_file(0, 10);
    make_file(1, 11);
    c = cache_new(&blobs, 3 * KIB, NULL);
    path_of(0, path);
    unlink(path);
    path_of(1, path);
    ck_assert_int_eq(truncate(path, 10), 0);
    ck_assert_int_eq(use(job_a, 0, 2, 2 * KIB), 0);
    ck_assert_uint_eq(cache_bytes(c), 10);
    unlink(path);
    ck_assert_int_eq(rmdir(dir), 0);
    ck_assert_int_eq(use(job_a, 0, 2, 2 * KIB), 0);
    ck_assert_uint_eq(cache_bytes(c), 0);
    ck_assert_int_eq(arrive(0), 0);
}

TEST(without_a_limit_it_takes_a_tenth_of_the_disk)
{
    uint64_t disk = blobs_disk_bytes(&blobs);

    c = cache_new(&blobs, 0, NULL);
    ck_assert_int_eq(cache_expect(c, disk / 10 + 1, NULL), RAD_EFULL);
    ck_assert_uint_gt(blobs_disk_free(&blobs), 0);
}

TEST(where_the_disk_tells_no_size_what_comes_is_taken)
{
    sizeless = true;
    c = cache_new(&blobs, 0, NULL);
    ck_assert_int_eq(cache_expect(c, KIB, NULL), 0);
    sizeless = false;
}

TEST(many_files_are_no_trouble)
{
    uint8_t many[5000 * MSG_HASH] = { 0 };
    const struct msg_hashes files = { 5000, many };

    c = cache_new(&blobs, KIB, NULL);
    for (uint32_t i = 0; i < 5000; i++)
        memcpy(many + (size_t)i * MSG_HASH, &i, sizeof i);
    ck_assert_int_eq(cache_use(c, job_a, &files, KIB, NULL), 0);
    cache_leave(c, job_a);
    ck_assert_uint_eq(cache_bytes(c), 0);
}
