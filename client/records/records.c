/* records.c - see records.h */
#include "config.h"

#include "records/records.h"

#include "proto/ambshare.h"

#include <string.h>

/* Most bytes of a file and of the list.  A worker that loads the list needs as
 * much again. */
#define LARGEST ((size_t)4 << 30)

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
    if (rc == 0 && path)
        rc = ambfile_read(&r->file, path, &r->list, err);
    return rc;
}

int
records_add(const struct records *r, struct compiled *scene, const char *dir,
            struct rad_error *err)
{
    if (r->list.len == 0 || r->list.bad)
        return 0;
    return compile_add(scene, RAD_BUNDLE_RECORDS, r->list.buf, r->list.len, dir,
                       err);
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
    if (!r->path || !r->keep || r->nfresh == 0)
        return 0;
    if (r->list.bad)
        return rad_fail(err, RAD_ENOMEM,
                        "out of memory: '%s' has no new ambient values",
                        r->path);
    return ambfile_write(&r->file, r->path, &r->list, durable, err);
}

void
records_release(struct records *r)
{
    wire_out_release(&r->list);
}
