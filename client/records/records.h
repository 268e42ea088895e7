/* records.h - the ambient records of a job (-af)
 *
 * Read from a file before the job, sent along with the scene, added to as the
 * workers make more, written back after it.
 * Thread: one. */
#ifndef RADD_CLIENT_RECORDS_H
#define RADD_CLIENT_RECORDS_H

#include "records/ambfile.h"
#include "compile/compile.h"
#include "proto/message.h"

struct records {
    const char *path; /* NULL: there is no file */
    bool keep;        /* new ones are wanted, and written in the end */
    struct ambfile file;
    struct wire_out list;  /* as they travel, sound ones alone */
    size_t nfirst, nfresh; /* of the file, and made since */
};

/* Read the file, if it is there; path NULL: records are kept for the next job
 * alone.  The scene was compiled and bundled; path outlives *r.  Errors:
 * ambfile_parse()'s, with the file's name. */
int records_begin(struct records *r, const char *path, bool keep,
                  const struct rad_params *params,
                  const struct compiled *scene, struct rad_error *err);

/* Put those that there are into the scene's bundle, whose files are in dir, for
 * a job that begins with them.  Errors of compile_add(). */
int records_add(const struct records *r, struct compiled *scene,
                const char *dir, struct rad_error *err);

/* Take them out again. */
void records_drop(struct compiled *scene, const char *dir);

/* Add what a worker has made. */
void records_take(struct records *r, const struct msg_records *m);

/* Write the file, whole or not at all, if there is something new.  RAD_EIO,
 * RAD_ECANTCREAT, RAD_ENOMEM: it is as it was. */
int records_write(const struct records *r, bool durable, struct rad_error *err);

void records_release(struct records *r);

#endif
