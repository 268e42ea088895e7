/* stored.h - data and picture files that several modifiers of a job may use
 *
 * A file is read once, however many objects name it, and lives as long as the
 * job.
 * Thread: the one that makes the job. */
#ifndef RAD_PATTERN_STORED_H
#define RAD_PATTERN_STORED_H

#include "trace/material.h"

struct rad_data;
struct rad_pict;

/* Makes an object of a file's bytes, in arena; NULL and *err on failure. */
typedef const void *(*rad_stored_parse)(struct rad_arena *arena,
                                        const char *bytes, size_t len,
                                        struct rad_error *err);

/* The object that parse makes of the file called `name`, which o names.  NULL
 * and *err, with o and the file, on failure. */
const void *rad_stored(struct rad_job *job, const struct rad_object *o,
                       const struct rad_files *files, const char *name,
                       rad_stored_parse parse, struct rad_error *err);

/* The same for a data file, a picture (scene/file/data.h) and a hyperspectral
 * picture (specpict.h). */
const struct rad_data *rad_stored_data(struct rad_job *job,
                                       const struct rad_object *o,
                                       const struct rad_files *files,
                                       const char *name, struct rad_error *err);
const struct rad_pict *rad_stored_picture(struct rad_job *job,
                                          const struct rad_object *o,
                                          const struct rad_files *files,
                                          const char *name,
                                          struct rad_error *err);

const struct rad_data *rad_stored_specpict(struct rad_job *job,
                                           const struct rad_object *o,
                                           const struct rad_files *files,
                                           const char *name,
                                           struct rad_error *err);

#endif
