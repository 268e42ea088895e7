/* pointjob.h - a job of sensor points: what is read, sent and written
 *
 * Thread: one. */
#ifndef RADD_CLIENT_POINTJOB_H
#define RADD_CLIENT_POINTJOB_H

#include "compile/compile.h"
#include "points/pointfile.h"
#include "points/pointspec.h"

/* Zeroed at first. */
struct pointjob {
    const struct pointspec *spec;
    struct pointfile in;
    uint32_t *pixel;   /* of each point, in the picture */
    int width, height; /* of that */
};

/* Read the points and lay them out; *spec must outlive *j.  Errors of
 * pointfile_read(). */
int pointjob_read(struct pointjob *j, const struct pointspec *spec,
                  struct rad_error *err);

/* Fewer than -x and -y promise? */
bool pointjob_is_short(const struct pointjob *j);

/* Put them into the bundle of the scene, and the folder (compile_add()). */
int pointjob_add(const struct pointjob *j, struct compiled *scene,
                 const char *folder, struct rad_error *err);

/* What the values are written of. */
struct pointjob_values {
    const void *pixels; /* four floats each, red, green, blue, distance; NULL:
                         * no letter of -o asks for light */
    size_t len;         /* their bytes */
    const char *origin, *options; /* for the header */
    const struct rad_params *params;
    struct compiled *scene;
};

/* Write what -o asks for, in the order of the input, to path (NULL: standard
 * output), whole.  RAD_EPROTO for pixels of another picture; errors of
 * output.h. */
int pointjob_write(const struct pointjob *j, const struct pointjob_values *v,
                   const char *path, bool durable, struct rad_error *err);

void pointjob_release(struct pointjob *j);

#endif
