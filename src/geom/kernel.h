/* kernel.h - the kernels there are, and what their files share (inside geom/
 * only) */
#ifndef RAD_GEOM_KERNEL_H
#define RAD_GEOM_KERNEL_H

#include "geom/bvh.h"

#include <math.h>

#if defined(__x86_64__) || defined(__i386__)
#define RAD_X86 1
#endif

/* Pays for the three roundings of each plane's distance, entering and leaving:
 * 1 + 2 gamma_3 < 1 + 2^-21 in float (Ize 2013). */
#define RAD_BVH_WIDEN (1 + 0x1p-21f)

extern const struct rad_kernel rad_kernel_plain;
#ifdef RAD_X86
extern const struct rad_kernel rad_kernel_avx2;
#endif

#endif
