/* stage.h - a scene from text that is measured at a point or along a ray
 *
 * What cannot be built ends the program: the scenes are its own. */
#ifndef RADD_TESTS_STAGE_H
#define RADD_TESTS_STAGE_H

#include "trace/job.h"

struct stage {
    int effort; /* 1 is quick; kept by stage_open() */
    struct rad_scene *scene;
    struct rad_params params;
    struct rad_job *job;
    struct rad_ctx ctx;
};

/* Rendering options, blank-separated, and a scene's text by printf(). */
void stage_open(struct stage *s, const char *options, const char *scene, ...)
    __attribute__((format(printf, 3, 4)));
/* Also closes a stage that is zero, or closed. */
void stage_close(struct stage *s);

/* Red irradiance at p on the side of unit normal n. */
double stage_irradiance(struct stage *s, const double p[3], const double n[3]);

/* Red radiance along the ray from org in direction dir (of any length); the
 * key is that of its random numbers. */
double stage_radiance(struct stage *s, const double org[3], const double dir[3],
                      uint64_t key);

/* Share of a parallel view along -vd that is lit, in scene units squared; the
 * view options are text. */
double stage_lit_area(struct stage *s, const char *view);

/* Nodes in (0, 1) and weights of the Gauss-Legendre rule of order n, at most
 * STAGE_GAUSS. */
enum { STAGE_GAUSS = 32 };
void stage_gauss(int n, double x[STAGE_GAUSS], double w[STAGE_GAUSS]);

#endif
