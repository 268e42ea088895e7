/* records.h - the ambient records of a job (-af)
 *
 * They are read from a file before the job, sent with the scene, and written to
 * the file after the job with those that workers have made.
 * Thread: one. */
#ifndef RADD_CLIENT_RECORDS_H
#define RADD_CLIENT_RECORDS_H

#include "records/ambfile.h"
#include "compile/compile.h"
#include "proto/message.h"

struct records {
    const char *path; /* NULL: no file */
    bool keep;        /* new ones are wanted, and written at the end */
    struct ambfile file;
    struct wire_out list; /* sound records, as they travel (ambshare.h) */
    size_t nfresh;        /* those that were made since the file was read */
};

/* Read the file at path, if it exists.  path NULL: records are only kept for
 * the next job.  path must outlive *r.  The scene must be compiled and bundled.
 * Errors of ambfile_parse(), with the file's name. */
int records_begin(struct records *r, const char *path, bool keep,
                  const struct rad_params *params,
                  const struct compiled *scene, struct rad_error *err);

/* Put all records into the scene's bundle, whose files are in dir, for a job
 * that begins with them.  Errors of compile_add(). */
int records_add(const struct records *r, struct compiled *scene,
                const char *dir, struct rad_error *err);

/* Add the sound records of a message. */
void records_take(struct records *r, const struct msg_records *m);

/* Write the file, whole or not at all, if there are new records.  RAD_EIO,
 * RAD_ECANTCREAT, RAD_ENOMEM: the file is unchanged. */
int records_write(const struct records *r, bool durable, struct rad_error *err);

void records_release(struct records *r);

#endif
