/* mist.h - media that scatter light, and the surfaces that bound them
 *
 * A ray in a medium loses light by extinction, and gains light that the medium
 * scatters into it: of the ambient value uniformly, of light sources that a
 * mist names by samples along the way.  The whole scene has a medium by -me -ma
 * -mg; closed surfaces of material mist add to it within.
 * Extinction is in 1/unit; the albedo is the scattered part of it.
 * Sources: Radiance reference manual, "mist"; rpict(1) on -me -ma -mg -ms;
 *          Henyey & Greenstein 1941 (phase function).  */
#ifndef RAD_SHADE_MIST_H
#define RAD_SHADE_MIST_H

#include "trace/asks.h"

struct rad_mist;

/* A link of the chain of media that a ray is in.  r->medium is the innermost; a
 * link lives as long as the rays that entered it.  A ray without links (NULL)
 * is in a medium that only dims, by its `ext`. */
struct rad_medium {
    const struct rad_medium *outer; /* entered before this; NULL: none */
    const struct rad_mist *mist;    /* NULL: the scene's own medium, or a
                                     * solid */
    bool solid;                     /* inside of a dielectric: it scatters
                                     * nothing, but keeps the links outside */
    struct rad_rgb ext, outer_ext;  /* extinction here, and in `outer` */
    struct rad_rgb own_ext;         /* their difference */
    struct rad_rgb albedo;
    float g;               /* Henyey-Greenstein's eccentricity */
    int32_t nlights;       /* number of sources and images that light it */
    const int32_t *lights; /* these, of all links, each once */
};

int rad_mist_prepare(struct rad_job *job, int32_t index,
                     const struct rad_files *files, const void **data,
                     struct rad_error *err);
bool rad_mist_shade(struct rad_ctx *ctx, const struct rad_material *mat,
                    struct rad_ray *r);

/* Make job->medium, and find the sources that mists name; to be called when
 * materials, sources and their images are made.  0 or RAD_ENOMEM. */
int rad_mists_resolve(struct rad_job *job, struct rad_error *err);

/* The medium of a ray that enters a dielectric from medium m: *link, made the
 * solid's, or NULL if m is NULL. */
const struct rad_medium *rad_medium_solid(struct rad_medium *link,
                                          const struct rad_medium *m);

/* The medium outside the innermost solid of chain m; the scene's own medium if
 * the chain has no solid. */
const struct rad_medium *rad_medium_about(const struct rad_job *job,
                                          const struct rad_medium *m);

#endif
