/* pointjob.h - a job of sensor points: what is read and sent
 *
 * Thread: one. */
#ifndef RADD_CLIENT_POINTJOB_H
#define RADD_CLIENT_POINTJOB_H

#include "compile/compile.h"
#include "points/pointfile.h"
#include "points/pointspec.h"
#include "points/points.h"

/* Zeroed at first. */
struct pointjob {
    const struct pointspec *spec;
    struct pointfile in;
    uint64_t first;    /* number of the first of them */
    uint32_t *pixel;   /* of each point, in the picture */
    int width, height; /* of that */
};

/* Read the points and lay them out; *spec must outlive *j.  Errors of
 * pointfile_read(). */
int pointjob_read(struct pointjob *j, const struct pointspec *spec,
                  struct rad_error *err);

/* Lay out the points that are there, which are of *j->spec.  RAD_ENOMEM. */
int pointjob_lay(struct pointjob *j, struct rad_error *err);

/* Fewer than -x and -y promise? */
bool pointjob_is_short(const struct pointjob *j);

/* Which point, from 1, a pixel is of; 0: of none. */
uint64_t pointjob_number(const struct pointjob *j, uint32_t x, uint32_t y);

/* The file of a job's points, to be freed, and what is in it.  RAD_ENOMEM. */
int pointjob_pack(const struct pointjob *j, struct rad_points *points,
                  uint8_t **file, struct rad_error *err);

/* Put them into the bundle of the scene, and the folder (compile_add()). */
int pointjob_add(const struct pointjob *j, struct compiled *scene,
                 const char *folder, struct rad_error *err);

/* Take them out again. */
void pointjob_drop(struct compiled *scene, const char *folder);

void pointjob_release(struct pointjob *j);

#endif
