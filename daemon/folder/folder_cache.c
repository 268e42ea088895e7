/* folder_cache.c - the passes of a job's ambient cache that are closed
 *
 * DIR/jobs/ID/cache has one after the other, each behind a head: the number of
 * the pass, its bytes, their sum and what it counted.  It is read up to the
 * first that is damaged, and written on from there.  What is lost of it is made
 * again, the same: so nobody waits for it to be on the disk, and a pass for
 * which there is no room is left out, with those that follow it. */
#include "config.h"

#include "folder/folder_impl.h"

#include "base/files.h"
#include "machine/rowsum.h"
#include "proto/codec.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MAGIC      UINT32_C(0x52414443) /* "RADC" */
#define HEAD_BYTES 24
#define LAYOUT     1 /* the version of the protocol that counts are as in */

/* A pass as it is in the file. */
static void
put(struct wire_out *w, uint32_t pass, const struct saved_pass *p)
{
    struct wire_out counts;

    wire_out_init(&counts, MSG_MAX);
    counts.version = LAYOUT;
    msg_put_counts(&counts, &p->counts);
    wire_out_init(w, HEAD_BYTES + counts.len + p->len);
    wire_put_u32(w, MAGIC);
    wire_put_u32(w, pass);
    wire_put_u64(w, p->len);
    wire_put_u64(w, rowsum_hash(counts.buf, counts.len) ^
                        rowsum_hash(p->bytes, p->len));
    wire_put_bytes(w, counts.buf, counts.len);
    wire_put_bytes(w, p->bytes, p->len);
    w->bad |= counts.bad;
    wire_out_release(&counts);
}

void
folder_put_pass(struct folder *f, const uint8_t id[MSG_JOB], uint32_t pass,
                const struct saved_pass *p)
{
    struct folder_job *j = *folder_find_job(f, id);
    char path[DISK_PATH_MAX];
    struct wire_out w;
    int fd;

    if (!j || pass != j->npasses)
        return;
    folder_path(f, id, FOLDER_CACHE, path);
    fd = open(path, O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    if (fd < 0)
        return;
    put(&w, pass, p);
    if (!w.bad && disk_write_at(fd, w.buf, w.len, (off_t)j->pass_bytes, path,
                                NULL) == 0) {
        j->npasses++;
        j->pass_bytes += w.len;
    }
    wire_out_release(&w);
    close(fd);
}

/* The pass that begins at *at, which then stands behind it; false: it is not
 * the one of that number, or damaged. */
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

uint8_t *
folder_read_passes(struct folder *f, const uint8_t id[MSG_JOB],
                   struct saved_pass pass[MSG_MOST_PASSES], uint32_t *n)
{
    struct folder_job *j = *folder_find_job(f, id);
    char path[DISK_PATH_MAX];
    size_t len = 0, end;
    uint8_t *bytes;

    folder_path(f, id, FOLDER_CACHE, path);
    bytes = rad_file_read(path, FOLDER_MOST_CACHE, &len, NULL);
    end = folder_parse_passes(bytes, len, pass, n);
    if (j) {
        j->npasses = *n;
        j->pass_bytes = end;
    }
    return bytes;
}
