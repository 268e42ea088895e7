/* stored.h - files that several modifiers of a job read: data, pictures
 *
 * A file is read once, however many objects name it, and lives as long as the
 * job.
 * Thread: while the job is being made, one. */
#ifndef RAD_SHADE_STORED_H
#define RAD_SHADE_STORED_H

#include "trace/material.h"

struct rad_data;
struct rad_pict;

/* What is made of a file's bytes, in arena; NULL and *err on failure. */
typedef const void *(*rad_stored_parse)(struct rad_arena *arena,
                                        const char *bytes, size_t len,
                                        struct rad_error *err);

/* The file that object o names, as parse makes it.  NULL and *err, which names
 * o and the file, on failure. */
const void *rad_stored(struct rad_job *job, const struct rad_object *o,
                       const struct rad_files *files, const char *name,
                       rad_stored_parse parse, struct rad_error *err);

/* A data file, a picture (scene/file/data.h), a hyperspectral one
 * (specpict.h). */
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
