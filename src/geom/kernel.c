/* kernel.c - which kernels there are, best first */
#include "config.h"

#include "geom/kernel.h"

#include <stddef.h>

static const struct rad_kernel *const kernels[] = {
#ifdef RAD_X86
    &rad_kernel_avx512, &rad_kernel_avx2,
    &rad_kernel_sse2,
#endif
#ifdef RAD_ARM64
    &rad_kernel_neon,
#endif
    &rad_kernel_plain,  NULL
};

const struct rad_kernel *const *
rad_kernels(void)
{
    return kernels;
}
