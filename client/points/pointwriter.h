/* pointwriter.h - values of sensor points, written as rtrace(1) does
 *
 * A header, then a record for each point, in the order of the input.
 * Thread: one. */
#ifndef RADD_CLIENT_POINTWRITER_H
#define RADD_CLIENT_POINTWRITER_H

#include "points/pointjob.h"

/* What the header and the letters of -o need. */
struct pointwriter_text {
    const char *origin;
    const struct rad_params *params;
    bool spectral; /* write all of more than three bands, instead of their
                    * colour */
    struct compiled *scene;
};

/* The light of a job's pixels: for each plane (base/bands.h) four floats a
 * pixel, red, green, blue and distance.  n 0: no letter needs light. */
struct pointwriter_light {
    const void *plane[RAD_MAX_PLANES];
    int n;
    size_t len; /* bytes of each plane */
};

struct pointwriter;

/* Begin to write the values that -o lists, for points of any number of jobs, to
 * path (NULL: standard output).  *w must be closed in any case, and all
 * arguments must outlive it.  Errors of output.h, and of rad_job_new(). */
int pointwriter_open(struct pointwriter **w, const struct pointspec *spec,
                     const struct pointwriter_text *text, const char *path,
                     bool durable, struct rad_error *err);

/* Write the values of *j's points, in their order, and flush them.  RAD_EPROTO:
 * the light is of another size; RAD_EIO. */
int pointwriter_put(struct pointwriter *w, const struct pointjob *j,
                    const struct pointwriter_light *light,
                    struct rad_error *err);

/* Close and free; keep: keep the file.  RAD_EIO. */
int pointwriter_close(struct pointwriter *w, bool keep, struct rad_error *err);

/* The three calls above, for one job. */
int pointwriter_all(const struct pointjob *j,
                    const struct pointwriter_text *text,
                    const struct pointwriter_light *light, const char *path,
                    bool durable, struct rad_error *err);

#endif
