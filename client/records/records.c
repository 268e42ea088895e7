/* records.c - see records.h */
#include "config.h"

#include "records/records.h"

#include "proto/ambshare.h"
#include "base/files.h"
#include "base/output.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Most bytes of a file and of the list.  A worker that loads the list needs as
 * much again. */
#define LARGEST ((size_t)4 << 30)

static void
take_first(void *arg, const struct rad_ambrec *rec)
{
    struct records *r = arg;

    ambshare_pack(&r->list, rec);
    r->nfirst++;
}

static int
read_file(struct records *r, struct rad_error *err)
{
    unsigned char *bytes;
    size_t len;
    int rc;

    if (!r->path || (access(r->path, F_OK) != 0 && errno == ENOENT))
        return 0;
    bytes = rad_file_read(r->path, LARGEST, &len, err);
    if (!bytes)
        return err->code;
    /* an empty file, such as mktemp(1) makes, counts as missing */
    rc = len > 0 ? ambfile_parse(&r->file, bytes, len, take_first, r, err) : 0;
    free(bytes);
    if (rc == 0 && r->list.bad)
        rc = rad_fail_memory(err);
    if (rc < 0)
        rad_error_where(err, "%s", r->path);
    return rc;
}

int
records_begin(struct records *r, const char *path, bool keep,
              const struct rad_params *params, const struct compiled *scene,
              struct rad_error *err)
{
    int rc;

    memset(r, 0, sizeof *r);
    r->path = path;
    r->keep = keep;
    r->file.params = *params;
    wire_out_init(&r->list, LARGEST);
    rc = compile_name(scene, r->file.scene, err);
    return rc < 0 ? rc : read_file(r, err);
}

int
records_add(const struct records *r, struct compiled *scene, const char *dir,
            struct rad_error *err)
{
    if (r->nfirst + r->nfresh == 0 || r->list.bad)
        return 0;
    return compile_add(scene, RAD_BUNDLE_RECORDS, r->list.buf, r->list.len, dir,
                       err);
}

void
records_drop(struct compiled *scene, const char *dir)
{
    compile_drop(scene, RAD_BUNDLE_RECORDS, dir);
}

/* Records beyond LARGEST are dropped, which only costs the next run time. */
void
records_take(struct records *r, const struct msg_records *m)
{
    struct rad_ambrec rec;
    struct wire_in in;

    if (!r->keep)
        return;
    wire_in_init(&in, m->data, m->len);
    while (wire_left(&in) >= AMBSHARE_BYTES)
        if (ambshare_unpack(&in, &rec) &&
            r->list.len <= LARGEST - AMBSHARE_BYTES) {
            ambshare_pack(&r->list, &rec);
            r->nfresh++;
        }
}

int
records_write(const struct records *r, bool durable, struct rad_error *err)
{
    struct rad_output out;
    int rc;

    if (!r->path || !r->keep || r->nfresh == 0)
        return 0;
    if (r->list.bad)
        return rad_fail(err, RAD_ENOMEM,
                        "out of memory: '%s' has no new ambient values",
                        r->path);
    rc = rad_output_open(&out, r->path, durable, err);
    if (rc < 0)
        return rc;
    rc = ambfile_format_list(&r->file, r->list.buf, r->list.len, out.file, err);
    if (rc < 0) {
        rad_error_where(err, "%s", r->path);
        rad_output_abort(&out);
        return rc;
    }
    return rad_output_commit(&out, err);
}

void
records_release(struct records *r)
{
    wire_out_release(&r->list);
}
