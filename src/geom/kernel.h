/* kernel.h - the kernels there are, and what their files share (inside geom/
 * only) */
#ifndef RAD_GEOM_KERNEL_H
#define RAD_GEOM_KERNEL_H

#include "geom/bvh.h"
#include "geom/line.h"
#include "geom/place.h"
#include "geom/polygon.h"

#include <math.h>
#include <string.h>

#if defined(__x86_64__) || defined(__i386__)
#define RAD_X86 1
#elif defined(__aarch64__)
#define RAD_ARM64 1
#endif

/* Pays for the three roundings of each plane's distance, entering and leaving:
 * 1 + 2 gamma_3 < 1 + 2^-21 in float (Ize 2013). */
#define RAD_BVH_WIDEN (1 + 0x1p-21f)

/* How far behind the nearest hit another may tie with it, of the size of the
 * numbers: ample for grazing faces. */
#define RAD_WALK_WINDOW 0x1p-30

static inline double
rad_walk_window(const struct rad_walk *w, double t)
{
    return RAD_WALK_WINDOW * (w->probe.size + t);
}

/* What all that is in geom/ may see. */
struct rad_geom {
    const struct rad_scene *scene;
    const struct rad_kernel *kernel;
    struct rad_arena arena;
    struct rad_set top;   /* the scene's own surfaces */
    struct rad_set *sets; /* by part */
    int32_t nown;         /* objects of the scene itself */
    uint32_t *prim_of;    /* by these; RAD_NO_PRIM: none */
    bool passes;          /* top holds surfaces with RAD_SURF_PASSED */
};

/* Best first, ended by NULL. */
const struct rad_kernel *const *rad_kernels(void);

/* Walk with k from now on; rad_geom_new() takes the best.  For measuring and
 * comparing kernels. */
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
