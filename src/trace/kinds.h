/* kinds.h - what rays are for, and which random numbers belong to which use
 *
 * Source: what each ray kind means: Radiance's ray types. */
#ifndef RAD_TRACE_KINDS_H
#define RAD_TRACE_KINDS_H

enum rad_raykind {
    RAD_RAY_PRIMARY = 01,
    RAD_RAY_RSHADOW = 02,   /* to a light source, off the near side */
    RAD_RAY_REFLECTED = 04, /* mirror reflection */
    RAD_RAY_REFRACTED = 010,
    RAD_RAY_TRANS = 020,      /* passed on unbent */
    RAD_RAY_RAMBIENT = 040,   /* indirect diffuse, near side */
    RAD_RAY_RSPECULAR = 0100, /* sampled gloss */
    RAD_RAY_TSHADOW = 0200,   /* to a light source through the surface */
    RAD_RAY_TAMBIENT = 0400,
    RAD_RAY_TSPECULAR = 01000,
    /* no kinds, but kept with them: */
    RAD_RAY_UNTESTED = 02000, /* in path: a shadow ray that nothing stops
                               * between mirrors */
    RAD_RAY_CUT = 04000       /* in kind: what it met is cut away */
};
#define RAD_RAY_SHADOW   (RAD_RAY_RSHADOW | RAD_RAY_TSHADOW)
#define RAD_RAY_AMBIENT  (RAD_RAY_RAMBIENT | RAD_RAY_TAMBIENT)
#define RAD_RAY_SPECULAR (RAD_RAY_RSPECULAR | RAD_RAY_TSPECULAR)
/* kinds that count as a reflection for -lr */
#define RAD_RAY_REFL                                                           \
    (RAD_RAY_RSHADOW | RAD_RAY_REFLECTED | RAD_RAY_RAMBIENT | RAD_RAY_RSPECULAR)

/* Branch numbers of the rays that a surface spawns (rad_ray_spawn): a class in
 * the high byte, and below it an index, or 0 where there is one of a kind. */
enum {
    RAD_BRANCH_TRANSMIT = 0x01000000,
    RAD_BRANCH_REFLECT = 0x02000000,
    RAD_BRANCH_REFRACT = 0x03000000,
    RAD_BRANCH_RSPECULAR = 0x04000000, /* | sample */
    RAD_BRANCH_TSPECULAR = 0x05000000, /* | sample */
    RAD_BRANCH_SHADOW = 0x06000000,    /* | light sample */
    RAD_BRANCH_RAMBIENT = 0x07000000,  /* | hemisphere sample */
    RAD_BRANCH_TAMBIENT = 0x08000000,  /* | hemisphere sample */
    RAD_BRANCH_SCATTER = 0x09000000    /* a medium's sources: see mist.c */
};

/* Dimensions of the random numbers that a ray's key is good for (rad_rand):
 * all of them, so that no two uses share one. */
enum {
    RAD_DIM_ROULETTE = 0,           /* does this ray live on (-lr <= 0)? */
    RAD_DIM_PIXEL = 1,              /* and 2: place in the pixel */
    RAD_DIM_MOTION = 3,             /* time, with -pm */
    RAD_DIM_LENS = 4,               /* and 5, 6: place on the lens, with -pd */
    RAD_DIM_SOURCE = 0x01000000,    /* + anything below 2^24 */
    RAD_DIM_AMBIENT = 0x02000000,   /* + anything below 2^24 */
    RAD_DIM_RSPECULAR = 0x03000000, /* the same: glossy reflection */
    RAD_DIM_TSPECULAR = 0x04000000  /* the same: glossy transmission */
};

#endif
