/* kernel.c - list of the kernels, best first
 *
 * AVX-512 tests a node in fewer instructions than AVX2.  Yet on the one machine
 * that was measured, scenes of some dozen surfaces take 10 to 17 % longer with
 * it, and meshes take as long. */
#include "config.h"

#include "geom/kernel.h"

#include <stddef.h>

static const struct rad_kernel *const kernels[] = {
#ifdef RAD_X86
    &rad_kernel_avx2,  &rad_kernel_avx512,
    &rad_kernel_sse2,
#endif
#ifdef RAD_ARM64
    &rad_kernel_neon,
#endif
    &rad_kernel_plain, NULL
};

const struct rad_kernel *const *
rad_kernels(void)
{
    return kernels;
}
