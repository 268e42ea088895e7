/* folder_cache.c - the passes of a job's ambient cache that are closed
 *
 * DIR/jobs/ID/cache has the passes one after the other, each behind a head: the
 * number of the pass, its bytes, their sum and the pass's counts.  The file is
 * read up to the first pass that is damaged, and written on from there.  A pass
 * that is lost is made again, to the bit: so it is not synced, and a pass for
 * which there is no room is left out, with all that follow.  Check passes
 * (filling/stages.h) are synced, for rows are made by what they decide.
 *
 * The file of a job that is done may be kept, as DIR/jobs/ID/kept with a tail
 * that says how many passes there are, and which have the records of the last
 * stage.  It is synced before it is kept, for nobody makes it again.  Another
 * job that begins with this cache has the records of these, one behind the
 * other, as its own first pass.  That pass cannot be made again, so it is
 * synced before the job is accepted. */
#include "config.h"

#include "folder/folder_impl.h"

#include "base/files.h"
#include "machine/rowsum.h"
#include "proto/codec.h"
#include "refine/refine.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define MAGIC      UINT32_C(0x52414443) /* "RADC" */
#define TAIL_MAGIC UINT32_C(0x52414445) /* "RADE" */
#define HEAD_BYTES 24
#define TAIL_BYTES 16
#define LAYOUT     1 /* version of the protocol in which counts are packed */

/* Largest file: all records that a job may have, heads of passes and a tail. */
#define MOST_CACHE                                                             \
    (RAD_REFINE_STAGES * SAVED_STAGE_BYTES +                                   \
     MSG_MOST_PASSES * (HEAD_BYTES + sizeof(struct msg_counts)) + TAIL_BYTES)

/* Pack the head of a pass. */
static void
put_head(struct wire_out *w, uint32_t pass, const struct saved_pass *p)
{
    struct wire_out counts;

    wire_out_init(&counts, MSG_MAX);
    counts.version = LAYOUT;
    msg_put_counts(&counts, &p->counts);
    wire_out_init(w, HEAD_BYTES + counts.len);
    wire_put_u32(w, MAGIC);
    wire_put_u32(w, pass);
    wire_put_u64(w, p->len);
    wire_put_u64(w, rowsum_hash(counts.buf, counts.len) ^
                        rowsum_hash(p->bytes, p->len));
    wire_put_bytes(w, counts.buf, counts.len);
    w->bad |= counts.bad;
    wire_out_release(&counts);
}

/* Write the job's next pass behind those that are kept. */
static int
write_pass(struct folder_job *j, int fd, const struct saved_pass *p,
           const char *path, struct rad_error *err)
{
    off_t at = (off_t)j->pass_bytes;
    struct wire_out head;
    int rc = 0;

    put_head(&head, j->npasses, p);
    if (head.bad)
        rc = rad_fail_memory(err);
    if (rc == 0)
        rc = disk_write_at(fd, head.buf, head.len, at, path, err);
    if (rc == 0)
        rc = disk_write_at(fd, p->bytes, p->len, at + (off_t)head.len, path,
                           err);
    if (rc == 0) {
        j->npasses++;
        j->pass_bytes += head.len + p->len;
    }
    wire_out_release(&head);
    return rc;
}

static int
open_cache(const struct folder *f, const uint8_t id[MSG_JOB],
           char path[DISK_PATH_MAX])
{
    folder_path(f, id, FOLDER_CACHE, path);
    return open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
}

void
folder_put_pass(struct folder *f, const uint8_t id[MSG_JOB], uint32_t pass,
                const struct saved_pass *p)
{
    struct folder_job *j = *folder_find_job(f, id);
    char path[DISK_PATH_MAX];
    int fd;

    if (!j || pass != j->npasses)
        return;
    fd = open_cache(f, id, path);
    if (fd < 0)
        return;
    if (write_pass(j, fd, p, path, NULL) == 0 && f->durable) {
        syncs_begin(fd); /* so that little is left to be done in the end */
        if (p->firm && disk_sync_data(fd, path, NULL) == 0)
            disk_sync_dir_of(path, NULL);
    }
    close(fd);
}

/* Read the pass that begins at *at, and move *at behind it.  False: the pass
 * has another number, or is damaged. */
static bool
take_pass(const uint8_t *bytes, size_t n, uint32_t pass, size_t *at,
          struct saved_pass *out)
{
    const uint8_t *counts;
    struct wire_in in;
    uint64_t len, sum;

    if (n - *at < HEAD_BYTES)
        return false;
    wire_in_init(&in, bytes + *at, n - *at);
    in.version = LAYOUT;
    if (wire_get_u32(&in) != MAGIC || wire_get_u32(&in) != pass)
        return false;
    len = wire_get_u64(&in);
    sum = wire_get_u64(&in);
    counts = bytes + *at + HEAD_BYTES;
    if (in.bad)
        return false;
    msg_get_counts(&in, &out->counts);
    if (in.bad || len > wire_left(&in))
        return false;
    out->bytes = bytes + n - wire_left(&in);
    out->len = (size_t)len;
    *at = (size_t)(out->bytes - bytes) + out->len;
    return (rowsum_hash(counts, (size_t)(out->bytes - counts)) ^
            rowsum_hash(out->bytes, out->len)) == sum;
}

size_t
folder_parse_passes(const uint8_t *bytes, size_t len,
                    struct saved_pass pass[MSG_MOST_PASSES], uint32_t *n)
{
    size_t at = 0, end = 0;

    *n = 0;
    while (*n < MSG_MOST_PASSES && take_pass(bytes, len, *n, &at, &pass[*n])) {
        ++*n;
        end = at;
    }
    return end;
}

/* Make a kept cache the job's again: the last life may have kept it, but not
 * noted that the job is over, which therefore goes on. */
static void
take_back(const struct folder *f, const uint8_t id[MSG_JOB])
{
    char path[DISK_PATH_MAX], kept[DISK_PATH_MAX];

    folder_path(f, id, FOLDER_CACHE, path);
    folder_path(f, id, FOLDER_KEPT, kept);
    if (!f->looks && access(path, F_OK) < 0)
        rename(kept, path);
}

/* Read a file of passes, and sync it, for rows are made by what is in it: *n
 * bytes, malloc'd.  NULL: RAD_EDATA if the file is missing or too large;
 * RAD_ENOMEM, RAD_ESHORT, RAD_EIO. */
static uint8_t *
read_file(const char *path, size_t *n, struct rad_error *err)
{
    int fd = open(path, O_RDONLY | O_CLOEXEC);
    uint8_t *bytes;

    if (fd < 0) {
        mark_missing(path, errno, err);
        return NULL;
    }
    bytes = rad_fd_read(fd, path, MOST_CACHE, n, err);
    if (bytes && disk_sync_data(fd, path, err) < 0) {
        free(bytes);
        bytes = NULL;
    }
    close(fd);
    return bytes;
}

int
folder_read_passes(struct folder *f, const uint8_t id[MSG_JOB],
                   struct saved_pass pass[MSG_MOST_PASSES], uint32_t *n,
                   uint8_t **bytes, struct rad_error *err)
{
    struct folder_job *j = *folder_find_job(f, id);
    struct rad_error why = { 0 };
    char path[DISK_PATH_MAX];
    size_t len = 0, end;

    take_back(f, id);
    folder_path(f, id, FOLDER_CACHE, path);
    *n = 0;
    *bytes = NULL;
    if (access(path, F_OK) < 0 && errno == ENOENT)
        return 0;
    *bytes = read_file(path, &len, &why);
    if (!*bytes)
        return rad_fail(err, why.code, "%s", why.what);
    end = folder_parse_passes(*bytes, len, pass, n);
    if (j) {
        j->npasses = *n;
        j->pass_bytes = end;
    }
    return 0;
}

/* --- caches of jobs that are done --- */

static int
write_tail(const struct folder_job *j, const struct pass_range *passes, int fd,
           const char *path)
{
    struct wire_out w;
    int rc;

    wire_out_init(&w, TAIL_BYTES);
    wire_put_u32(&w, TAIL_MAGIC);
    wire_put_u32(&w, passes->first);
    wire_put_u32(&w, passes->end);
    wire_put_u32(&w, passes->all);
    rc = w.bad ? RAD_ENOMEM
               : disk_write_at(fd, w.buf, w.len, (off_t)j->pass_bytes, path,
                               NULL);
    wire_out_release(&w);
    if (rc == 0 && ftruncate(fd, (off_t)j->pass_bytes + TAIL_BYTES) < 0)
        rc = RAD_EIO;
    return rc;
}

void
folder_keep_cache(struct folder *f, const uint8_t id[MSG_JOB],
                  const struct pass_range *passes)
{
    const struct folder_job *j = *folder_find_job(f, id);
    char path[DISK_PATH_MAX], kept[DISK_PATH_MAX];
    int fd;

    folder_path(f, id, FOLDER_CACHE, path);
    folder_path(f, id, FOLDER_KEPT, kept);
    if (!j || j->npasses != passes->all || access(path, F_OK) < 0)
        return;
    fd = open_cache(f, id, path);
    if (fd < 0)
        return;
    if (write_tail(j, passes, fd, path) == 0 &&
        disk_sync_data(fd, path, NULL) == 0)
        rename(path, kept);
    close(fd);
}

uint64_t
folder_cache_bytes(const struct folder *f, const uint8_t id[MSG_JOB])
{
    char path[DISK_PATH_MAX];
    struct stat st;

    folder_path(f, id, FOLDER_KEPT, path);
    return stat(path, &st) == 0 && st.st_size > 0 ? (uint64_t)st.st_size : 0;
}

void
folder_drop_cache(const struct folder *f, const uint8_t id[MSG_JOB])
{
    char path[DISK_PATH_MAX];

    folder_path(f, id, FOLDER_KEPT, path);
    unlink(path);
}

/* --- caches with which other jobs begin --- */

size_t
folder_parse_kept(uint8_t *bytes, size_t len)
{
    struct saved_pass pass[MSG_MOST_PASSES];
    struct wire_in in;
    struct pass_range kept;
    uint32_t n;
    size_t at = 0, end = folder_parse_passes(bytes, len, pass, &n);
    bool is_tail;

    wire_in_init(&in, bytes + end, len - end);
    is_tail = wire_get_u32(&in) == TAIL_MAGIC;
    kept.first = wire_get_u32(&in);
    kept.end = wire_get_u32(&in);
    kept.all = wire_get_u32(&in);
    if (!is_tail || kept.all != n || kept.end > n || kept.first >= kept.end ||
        in.bad || wire_left(&in) > 0)
        return FOLDER_NO_CACHE;
    for (uint32_t i = kept.first; i < kept.end; at += pass[i++].len)
        memmove(bytes + at, pass[i].bytes, pass[i].len);
    return at;
}

/* Say in *err why a cache has no records: it is damaged or, if *why tells of
 * another error, could not be read now. */
static void
no_records(const char *what, const uint8_t id[MSG_JOB],
           const struct rad_error *why, struct rad_error *err)
{
    char hex[MSG_JOB_HEX];

    msg_job_format(id, hex);
    if (why->code == 0 || why->code == RAD_EDATA)
        rad_fail(err, RAD_EDATA, "the ambient cache %s job %s is damaged", what,
                 hex);
    else
        rad_fail(err, why->code, "%s", why->what);
}

/* Read the records of the job's kept cache: *n bytes, malloc'd. */
static uint8_t *
read_kept(const struct folder *f, const uint8_t id[MSG_JOB], size_t *n,
          struct rad_error *err)
{
    char path[DISK_PATH_MAX], hex[MSG_JOB_HEX];
    struct rad_error why = { 0 };
    uint8_t *bytes;
    size_t len = 0;

    folder_path(f, id, FOLDER_KEPT, path);
    msg_job_format(id, hex);
    if (access(path, F_OK) < 0) {
        rad_fail(err, RAD_ENOINPUT,
                 "the ambient cache of job %s is not kept any more", hex);
        return NULL;
    }
    bytes = read_file(path, &len, &why);
    *n = bytes ? folder_parse_kept(bytes, len) : FOLDER_NO_CACHE;
    if (*n != FOLDER_NO_CACHE)
        return bytes;
    free(bytes);
    no_records("of", id, &why, err);
    return NULL;
}

/* Write a pass as the job's first, and sync it. */
static int
write_first(struct folder *f, struct folder_job *j, const struct saved_pass *p,
            struct rad_error *err)
{
    char path[DISK_PATH_MAX];
    int fd = open_cache(f, j->id, path), rc;

    if (fd < 0)
        return disk_fail(err, errno, "create", path);
    j->npasses = 0; /* this may be a second attempt */
    j->pass_bytes = 0;
    rc = write_pass(j, fd, p, path, err);
    if (rc == 0)
        rc = disk_sync_data(fd, path, err);
    close(fd);
    return rc == 0 ? disk_sync_dir_of(path, err) : rc;
}

int
folder_reuse(struct folder *f, const uint8_t id[MSG_JOB],
             const uint8_t from[MSG_JOB], struct rad_error *err)
{
    struct folder_job *j = *folder_find_job(f, id);
    struct saved_pass p = { .len = 0 };
    uint8_t *bytes = read_kept(f, from, &p.len, err);
    char path[DISK_PATH_MAX];
    int rc;

    if (!bytes)
        return err ? err->code : RAD_EDATA;
    p.bytes = bytes;
    folder_path(f, id, "", path);
    rc = j ? disk_sync_path(path, err) /* "new" comes before any other file */
           : rad_fail(err, RAD_EINTERNAL, "a job without a folder");
    if (rc == 0)
        rc = write_first(f, j, &p, err);
    free(bytes);
    return rc;
}

uint8_t *
folder_read_first(const struct folder *f, const uint8_t id[MSG_JOB],
                  size_t *len, struct rad_error *err)
{
    struct saved_pass first;
    struct rad_error why = { 0 };
    char path[DISK_PATH_MAX];
    size_t n = 0, at = 0;
    uint8_t *bytes, *less;

    folder_path(f, id, FOLDER_CACHE, path);
    bytes = read_file(path, &n, &why);
    if (!bytes || !take_pass(bytes, n, 0, &at, &first)) {
        free(bytes);
        no_records("that began", id, &why, err);
        return NULL;
    }
    *len = first.len;
    memmove(bytes, first.bytes, first.len);
    less = realloc(bytes, first.len + 1); /* without later passes */
    return less ? less : bytes;
}
