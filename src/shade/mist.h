/* mist.h - media that scatter light, and the surfaces that bound them
 *
 * A ray in a medium loses light to extinction, and gains what the medium
 * scatters into it: of the ambient value evenly, and of light sources that are
 * named for the place, by sampling along the way.  The medium of the whole
 * scene is -me -ma -mg; surfaces of material mist add to it within.
 * Extinction is in 1/unit; the albedo is the part of it that is scattering.
 * Sources: Radiance reference manual, "mist"; rpict(1) on -me -ma -mg -ms;
 *          Henyey & Greenstein 1941 (phase function).  */
#ifndef RAD_SHADE_MIST_H
#define RAD_SHADE_MIST_H

#include "trace/asks.h"

struct rad_mist;

/* What a ray goes through where light scatters, or once scattered: the
 * innermost of a chain whose links live as long as the ray that entered.
 * A ray without any (NULL) is in no such medium: its `ext` says all. */
struct rad_medium {
    const struct rad_medium *outer; /* entered before this; NULL: none */
    const struct rad_mist *mist;    /* that bounds it; NULL: the scene's own,
                                     * or a solid */
    bool solid;                     /* a dielectric: nothing scatters */
    struct rad_rgb ext, outer_ext;  /* here, and before this was entered */
    struct rad_rgb own_ext;         /* the difference */
    struct rad_rgb albedo;
    float g;               /* Henyey-Greenstein's eccentricity */
    int32_t nlights;       /* sources, or images of them, that light it: */
    const int32_t *lights; /* their numbers, all of the chain, no two the
                            * same */
};

int rad_mist_prepare(struct rad_job *job, int32_t index,
                     const struct rad_files *files, const void **data,
                     struct rad_error *err);
bool rad_mist_shade(struct rad_ctx *ctx, const struct rad_material *mat,
                    struct rad_ray *r);

/* Once materials and all sources are there: make job->medium, and find the
 * sources that mists name.  0 or RAD_ENOMEM. */
int rad_mists_resolve(struct rad_job *job, struct rad_error *err);

/* Make *link the inside of a dielectric that is met in medium m, and return
 * what a ray in there has for its medium. */
const struct rad_medium *rad_medium_solid(struct rad_medium *link,
                                          const struct rad_medium *m);

/* What is about the innermost solid of chain m; the scene's own medium where
 * there is none. */
const struct rad_medium *rad_medium_about(const struct rad_job *job,
                                          const struct rad_medium *m);

#endif
