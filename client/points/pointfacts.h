/* pointfacts.h - what the ray of a sensor point meets first
 *
 * This needs no light, so radsubmit, which has the scene, finds it by itself,
 * if it is asked for.
 * Thread: one at a time. */
#ifndef RADD_CLIENT_POINTFACTS_H
#define RADD_CLIENT_POINTFACTS_H

#include "base/files.h"
#include "base/params.h"
#include "scene/scene.h"

struct pointfacts;

struct pointfact {
    double length;       /* to the first surface; 1e10: there is none, or it is
                          * infinitely far */
    double at[3];        /* that point; else where -ld ends the ray, or else
                          * the origin */
    double normal[3];    /* of the surface; zeros: no surface */
    double perturbed[3]; /* normal after textures, on the ray's side */
    const char *surface, *modifier, *material; /* names; "*": no surface */
};

/* Make a scene ready; it stays the caller's.  NULL with *err set. */
struct pointfacts *pointfacts_new(const struct rad_scene *scene,
                                  const struct rad_files *files,
                                  const struct rad_params *params,
                                  struct rad_error *err);
void pointfacts_free(struct pointfacts *p);

/* dir has unit length; reach: how far the ray goes, or INFINITY. */
void pointfacts_find(struct pointfacts *p, const double org[3],
                     const double dir[3], double reach, struct pointfact *out);

/* The fact for a point without a direction. */
void pointfacts_none(struct pointfact *f, const double org[3]);

#endif
