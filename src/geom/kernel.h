/* kernel.h - list of the kernels, and what their files share (inside geom/
 * only) */
#ifndef RAD_GEOM_KERNEL_H
#define RAD_GEOM_KERNEL_H

#include "geom/bvh.h"
#include "geom/line.h"
#include "geom/meshed.h"
#include "geom/place.h"
#include "geom/polygon.h"

#include <math.h>
#include <string.h>

#if defined(__x86_64__) || defined(__i386__)
#define RAD_X86 1
#elif defined(__aarch64__)
#define RAD_ARM64 1
#endif

/* Makes up for the three roundings of a plane's distance, entering and leaving:
 * 1 + 2 gamma_3 < 1 + 2^-21 in float (Ize 2013). */
#define RAD_BVH_WIDEN (1 + 0x1p-21f)

/* How far behind the nearest hit, at t, another one may tie with it: ample,
 * even for surfaces that are grazed.  geom.c then applies the exact bound. */
static inline double
rad_walk_window(const struct rad_walk *w, double t)
{
    return 0x1p-30 * (w->probe.size + t);
}

/* Defined here for the files of geom/. */
struct rad_geom {
    const struct rad_scene *scene;
    const struct rad_kernel *kernel;
    struct rad_arena arena;
    struct rad_set top;   /* the scene's own surfaces */
    struct rad_set *sets; /* by index of the part */
    int32_t nown;         /* number of the scene's own objects */
    uint32_t *prim_of;    /* item of each in top; RAD_NO_PRIM: none */
    bool passes;          /* top has surfaces with RAD_SURF_PASSED or
                           * RAD_SURF_ONESIDED */
};

/* All kernels, best first, then NULL. */
const struct rad_kernel *const *rad_kernels(void);

/* Use kernel k from now on, instead of the best, which rad_geom_new() takes: to
 * measure and compare kernels. */
void rad_geom_use(struct rad_geom *g, const struct rad_kernel *k);

extern const struct rad_kernel rad_kernel_plain;
#ifdef RAD_X86
extern const struct rad_kernel rad_kernel_sse2;
extern const struct rad_kernel rad_kernel_avx2;
extern const struct rad_kernel rad_kernel_avx512;
#endif
#ifdef RAD_ARM64
extern const struct rad_kernel rad_kernel_neon;
#endif

#endif
