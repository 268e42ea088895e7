/* kinds.h - kinds of rays, and numbers that keep random numbers apart
 *
 * Source: Radiance's ray types, for the meaning of kinds. */
#ifndef RAD_TRACE_KINDS_H
#define RAD_TRACE_KINDS_H

enum rad_raykind {
    RAD_RAY_PRIMARY = 01,
    RAD_RAY_RSHADOW = 02,   /* to a light source, off the near side */
    RAD_RAY_REFLECTED = 04, /* mirror reflection */
    RAD_RAY_REFRACTED = 010,
    RAD_RAY_TRANS = 020,       /* passed on, straight */
    RAD_RAY_RAMBIENT = 040,    /* indirect diffuse, near side */
    RAD_RAY_RSPECULAR = 0100,  /* sampled gloss, reflected */
    RAD_RAY_TSHADOW = 0200,    /* to a light source through the surface */
    RAD_RAY_TAMBIENT = 0400,   /* indirect diffuse, far side */
    RAD_RAY_TSPECULAR = 01000, /* sampled gloss, transmitted */
    /* flags that are kept with kinds: */
    RAD_RAY_UNTESTED = 02000, /* in path: a shadow ray for which surfaces in the
                               * way do not count */
    RAD_RAY_CUT = 04000       /* in kind: the surface it met is cut away */
};
#define RAD_RAY_SHADOW   (RAD_RAY_RSHADOW | RAD_RAY_TSHADOW)
#define RAD_RAY_AMBIENT  (RAD_RAY_RAMBIENT | RAD_RAY_TAMBIENT)
#define RAD_RAY_SPECULAR (RAD_RAY_RSPECULAR | RAD_RAY_TSPECULAR)
/* kinds that count as a reflection for -lr */
#define RAD_RAY_REFL                                                           \
    (RAD_RAY_RSHADOW | RAD_RAY_REFLECTED | RAD_RAY_RAMBIENT | RAD_RAY_RSPECULAR)

/* Branch numbers of the rays that a surface spawns (rad_ray_spawn): a class in
 * the high byte, and below it an index, or 0 if there is one ray of the
 * class. */
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

/* Dimensions of the random numbers that are drawn at a ray's key (rad_rand).
 * All are listed here, so that no two uses share one. */
enum {
    RAD_DIM_ROULETTE = 0,           /* does this ray live on (-lr <= 0)? */
    RAD_DIM_PIXEL = 1,              /* and 2: place within the pixel */
    RAD_DIM_MOTION = 3,             /* time, with -pm */
    RAD_DIM_LENS = 4,               /* and 5, 6: place on the lens, with -pd */
    RAD_DIM_TREE = 7,               /* does it live on in a large tree? */
    RAD_DIM_SOURCE = 0x01000000,    /* + anything below 2^24 */
    RAD_DIM_AMBIENT = 0x02000000,   /* + anything below 2^24 */
    RAD_DIM_RSPECULAR = 0x03000000, /* the same: glossy reflection */
    RAD_DIM_TSPECULAR = 0x04000000  /* the same: glossy transmission */
};

#endif
