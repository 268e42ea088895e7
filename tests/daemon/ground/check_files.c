/* check_files.c - files by hash, and what a daemon writes for others */
#include "config.h"

#include "base/output.h"
#include "files/blobs.h"
#include "files/sound.h"
#include "ground/disk.h"
#include "ground/service.h"
#include "tests/scratch.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

FIXTURE(scratch_make, scratch_remove)

static int no_lock; /* why the file system locks nothing; 0: it does */

/* In place of the C library's. */
int
flock(int fd, int how)
{
    errno = no_lock;
    return no_lock ? -1 : (int)syscall(SYS_flock, fd, how);
}

/* Is it there?  *size (may be NULL) gets its length. */
static bool
has_blob(const struct blobs *b, const char *hash, uint64_t *size)
{
    char path[BLOBS_PATH_MAX];
    struct stat st;

    blobs_path(b, hash, path);
    if (stat(path, &st) < 0)
        return false;
    if (size)
        *size = (uint64_t)st.st_size;
    return true;
}

static int
read_blob(const struct blobs *b, const char *hash, off_t at, void *buf,
          size_t n)
{
    char path[BLOBS_PATH_MAX];
    int fd, rc;

    blobs_path(b, hash, path);
    fd = open(path, O_RDONLY);
    ck_assert_int_ge(fd, 0);
    rc = disk_read_at(fd, buf, n, at, path, NULL);
    close(fd);
    return rc;
}

TEST(file_that_came_in_pieces_is_there)
{
    static const char text[] = "void plastic white 0 0 5 1 1 1 0 0";
    size_t n = sizeof text;
    char hex[RAD_SHA_HEX + 1], back[sizeof text];
    struct blob_part p;
    struct blobs b;
    uint64_t size;

    ck_assert_int_eq(rad_sha_hex(text, n, hex, NULL), 0);
    ck_assert_int_eq(blobs_open(&b, dir, NULL), 0);
    ck_assert_int_eq(blobs_part_open(&p, &b, hex, n, NULL), 0);
    ck_assert_int_eq(blobs_part_write(&p, 0, text, 10, NULL), 0);
    ck_assert(!has_blob(&b, hex, NULL));
    ck_assert_int_eq(blobs_part_write(&p, 10, text + 10, n - 10, NULL), 1);
    ck_assert(has_blob(&b, hex, &size));
    ck_assert_uint_eq(size, n);
    ck_assert_int_eq(read_blob(&b, hex, 5, back, n - 5), 0);
    ck_assert_mem_eq(back, text + 5, n - 5);
    ck_assert_int_eq(read_blob(&b, hex, 6, back, n - 5), RAD_EIO);
}

TEST(empty_file_is_a_file)
{
    char hex[RAD_SHA_HEX + 1];
    struct blob_part p;
    struct blobs b;

    ck_assert_int_eq(rad_sha_hex("", 0, hex, NULL), 0);
    ck_assert_int_eq(blobs_open(&b, dir, NULL), 0);
    ck_assert_int_eq(blobs_part_open(&p, &b, hex, 0, NULL), 0);
    ck_assert_int_eq(blobs_part_write(&p, 0, NULL, 0, NULL), 1);
    ck_assert(has_blob(&b, hex, NULL));
}

static const struct {
    uint64_t total, offset;
    size_t n;
    bool other; /* another file's hash */
} wrong[] = {
    { 8, 1, 4, false }, /* does not begin at 0 */
    { 8, 0, 9, false }, /* more than was said */
    { 8, UINT64_MAX, 1, false },
    { 8, 0, 8, true }, /* not what its name says */
};

LOOP_TEST(wrong_pieces_leave_nothing, N_ELEM(wrong))
{
    static const char text[] = "12345678x";
    struct blob_part p;
    struct blobs b;
    char hex[RAD_SHA_HEX + 1], path[160];
    struct rad_error err = { 0 };

    ck_assert_int_eq(rad_sha_hex(wrong[_i].other ? "other" : text,
                                 wrong[_i].other ? 5 : 8, hex, NULL),
                     0);
    ck_assert_int_eq(blobs_open(&b, dir, NULL), 0);
    ck_assert_int_eq(blobs_part_open(&p, &b, hex, wrong[_i].total, NULL), 0);
    ck_assert_int_eq(
        blobs_part_write(&p, wrong[_i].offset, text, wrong[_i].n, &err),
        RAD_EPROTO);
    ck_assert_str_ne(err.what, "");
    ck_assert(!has_blob(&b, hex, NULL));
    snprintf(path, sizeof path, "%s/0.part", dir);
    ck_assert_int_ne(access(path, F_OK), 0);
}

TEST(bad_names_are_refused)
{
    struct blob_part p;
    struct blobs b;

    ck_assert_int_eq(blobs_open(&b, dir, NULL), 0);
    ck_assert_int_eq(blobs_part_open(&p, &b, "../../etc/passwd", 1, NULL),
                     RAD_EPROTO);
    ck_assert(!rad_sha_valid(".."));
}

TEST(half_files_of_an_earlier_life_go)
{
    struct blobs b;
    char path[160];
    FILE *f;

    snprintf(path, sizeof path, "%s/17.part", dir);
    f = fopen(path, "w");
    ck_assert_ptr_nonnull(f);
    fclose(f);
    ck_assert_int_eq(blobs_open(&b, dir, NULL), 0);
    ck_assert_int_ne(access(path, F_OK), 0);
}

/* Of one bucket, which is where the bound is. */
TEST(sounds_of_very_many_files_are_forgotten)
{
    const uint32_t most = SOUND_MOST / SOUND_BUCKETS, n = 3 * most;
    uint8_t digest[RAD_SHA_BYTES] = { 7 };
    struct sounds s = { 0 };
    uint32_t known = 0;
    char path[100];

    snprintf(path, sizeof path, "%s/file", dir);
    fclose(fopen(path, "w"));
    for (uint32_t i = 0; i < n; i++) {
        memcpy(digest + 4, &i, sizeof i);
        sounds_note(&s, digest, path);
    }
    ck_assert(sounds_known(&s, digest, path));
    for (uint32_t i = 0; i < n; i++) {
        memcpy(digest + 4, &i, sizeof i);
        known += sounds_known(&s, digest, path);
    }
    ck_assert_uint_eq(known, most);
    sounds_release(&s);
}

TEST(folders_are_made_and_files_written_whole)
{
    char deep[160], ports[200], text[100];
    const char *lines[] = { "unix /x", "tcp 127.0.0.1:1" };
    struct rad_error err = { 0 };
    FILE *f;

    snprintf(deep, sizeof deep, "%s/a/b/c", dir);
    ck_assert_int_eq(rad_make_dir(deep, 0700, NULL), 0);
    ck_assert_int_eq(rad_make_dir(deep, 0700, NULL), 0);
    snprintf(ports, sizeof ports, "%s/ports", deep);
    ck_assert_int_eq(service_ports_file(ports, lines, 2, NULL), 0);
    f = fopen(ports, "r");
    ck_assert_ptr_nonnull(f);
    text[fread(text, 1, sizeof text - 1, f)] = '\0';
    fclose(f);
    ck_assert_str_eq(text, "unix /x\ntcp 127.0.0.1:1\n");
    snprintf(deep, sizeof deep, "%s/ports/x", dir);
    snprintf(ports, sizeof ports, "%s/ports", dir);
    ck_assert_int_eq(service_ports_file(ports, lines, 1, NULL), 0);
    ck_assert_int_eq(rad_make_dir(deep, 0700, &err), RAD_ECANTCREAT);
}

TEST(locked_folder_is_told_from_one_that_cannot_be_locked)
{
    struct rad_error err = { 0 }, other = { 0 };
    int lock = service_lock_dir(dir, &err);

    ck_assert_int_ge(lock, 0);
    ck_assert_int_eq(service_lock_dir(dir, &err), RAD_ECANTCREAT);
    ck_assert_ptr_nonnull(strstr(err.what, "another process"));
    close(lock);
    no_lock = ENOLCK;
    ck_assert_int_eq(service_lock_dir(dir, &other), RAD_EIO);
    ck_assert_ptr_nonnull(strstr(other.what, strerror(ENOLCK)));
    no_lock = 0;
}
