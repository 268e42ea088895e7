/* pointwriter.h - values of sensor points, as rtrace(1) writes them
 *
 * A header, then a record of each point, in the order of the input.
 * Thread: one. */
#ifndef RADD_CLIENT_POINTWRITER_H
#define RADD_CLIENT_POINTWRITER_H

#include "points/pointjob.h"

/* What the header says, and what letters of -o need. */
struct pointwriter_text {
    const char *origin, *options;
    const struct rad_params *params;
    bool spectral; /* with more than three bands all of them are written, and
                    * not their colour */
    struct compiled *scene;
};

/* The light of a job's pixels: four floats each, red, green, blue and distance,
 * of each plane (base/bands.h); n 0: no letter asks for light. */
struct pointwriter_light {
    const void *plane[RAD_MAX_PLANES];
    int n;
    size_t len; /* bytes of a plane */
};

struct pointwriter;

/* Begin to write what -o asks for, of points that come in any number of jobs,
 * to path (NULL: standard output).  *w is to be closed in any case; all that
 * points to must outlive it.  Errors of output.h, and of rad_job_new(). */
int pointwriter_open(struct pointwriter **w, const struct pointspec *spec,
                     const struct pointwriter_text *text, const char *path,
                     bool durable, struct rad_error *err);

/* The values of *j, in the order of its points.  They are out of the program
 * then.  RAD_EPROTO for pixels of another picture; RAD_EIO. */
int pointwriter_put(struct pointwriter *w, const struct pointjob *j,
                    const struct pointwriter_light *light,
                    struct rad_error *err);

/* The end, with what was written kept or not, free.  RAD_EIO. */
int pointwriter_close(struct pointwriter *w, bool keep, struct rad_error *err);

/* All three. */
int pointwriter_all(const struct pointjob *j,
                    const struct pointwriter_text *text,
                    const struct pointwriter_light *light, const char *path,
                    bool durable, struct rad_error *err);

#endif
