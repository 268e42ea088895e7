/* pointjob.h - the sensor points of a job
 *
 * Thread: one. */
#ifndef RADD_CLIENT_POINTJOB_H
#define RADD_CLIENT_POINTJOB_H

#include "compile/compile.h"
#include "points/pointfile.h"
#include "points/pointspec.h"
#include "points/points.h"

/* Begins zeroed. */
struct pointjob {
    const struct pointspec *spec;
    struct pointfile in;
    uint64_t first;    /* number of the first in the whole input, from 0 */
    uint32_t *pixel;   /* of each point: its pixel in the picture */
    int width, height; /* of the picture */
};

/* Read the points and lay them out as a picture; *spec must outlive *j.  Errors
 * of pointfile_read(). */
int pointjob_read(struct pointjob *j, const struct pointspec *spec,
                  struct rad_error *err);

/* Lay out the points in j->in.  RAD_ENOMEM. */
int pointjob_lay(struct pointjob *j, struct rad_error *err);

/* Are there fewer points than -x and -y promise? */
bool pointjob_is_short(const struct pointjob *j);

/* The number of a pixel's point, from 1; 0: the pixel has none. */
uint64_t pointjob_number(const struct pointjob *j, uint32_t x, uint32_t y);

/* Make the file of a job's points, to be freed, and *points, which lie in it.
 * RAD_ENOMEM. */
int pointjob_pack(const struct pointjob *j, struct rad_points *points,
                  uint8_t **file, struct rad_error *err);

/* Put the file into the scene's bundle and folder (compile_add()). */
int pointjob_add(const struct pointjob *j, struct compiled *scene,
                 const char *folder, struct rad_error *err);

void pointjob_release(struct pointjob *j);

#endif
