/* pointfacts.h - what the ray of a sensor point meets first
 *
 * It needs no light: radsubmit, which has the scene, finds it by itself, and
 * only where it is asked for.
 * Thread: one at a time. */
#ifndef RADD_CLIENT_POINTFACTS_H
#define RADD_CLIENT_POINTFACTS_H

#include "base/files.h"
#include "base/params.h"
#include "scene/scene.h"

struct pointfacts;

struct pointfact {
    double length;       /* to the first surface; 1e10: there is none, or it
                          * is infinitely far */
    double at[3];        /* that place, or the origin */
    double normal[3];    /* of the surface; zeros: there is none */
    double perturbed[3]; /* on the side that the ray comes from */
    const char *surface, *modifier, *material; /* names; "*": nothing is met */
};

/* A scene that is made ready, and stays the caller's.  NULL with *err set. */
struct pointfacts *pointfacts_new(const struct rad_scene *scene,
                                  const struct rad_files *files,
                                  const struct rad_params *params,
                                  struct rad_error *err);
void pointfacts_free(struct pointfacts *p);

/* dir is of unit length; reach is INFINITY or how far the ray goes. */
void pointfacts_find(struct pointfacts *p, const double org[3],
                     const double dir[3], double reach, struct pointfact *out);

/* Of a ray that is none. */
void pointfacts_none(struct pointfact *f, const double org[3]);

#endif
