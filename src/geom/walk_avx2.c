/* walk_avx2.c - the walks with AVX2: a node's eight boxes in one register */
#include "config.h"

#include "geom/kernel.h"

#ifdef RAD_X86

#include <immintrin.h>

#define WALK_TARGET __attribute__((target("avx2")))
#define WALK(name)  avx2_##name

static inline WALK_TARGET __m256
avx2_slab(const float *bound, float org, float inv)
{
    return _mm256_mul_ps(
        _mm256_sub_ps(_mm256_loadu_ps(bound), _mm256_set1_ps(org)),
        _mm256_set1_ps(inv));
}

static inline WALK_TARGET unsigned
avx2_boxes(const struct rad_bvh_node *node, const struct rad_bvh_ray *r,
           float limit, float enter[RAD_BVH_WIDTH])
{
    __m256 in = _mm256_set1_ps(r->tmin), out = _mm256_set1_ps(INFINITY);

#pragma GCC unroll 3
    for (int a = 0; a < 3; a++) {
        in = _mm256_max_ps(
            avx2_slab(node->bound + r->enter[a], r->org[0][a], r->inv[a]), in);
        out = _mm256_min_ps(
            avx2_slab(node->bound + r->leave[a], r->org[1][a], r->inv[a]), out);
    }
    out = _mm256_mul_ps(out, _mm256_set1_ps(RAD_BVH_WIDEN));
    out = _mm256_min_ps(out, _mm256_set1_ps(limit));
    _mm256_storeu_ps(enter, in);
    return (unsigned)_mm256_movemask_ps(_mm256_cmp_ps(in, out, _CMP_LE_OQ));
}

#include "geom/walk.inc"

static bool
usable(void)
{
    return __builtin_cpu_supports("avx2");
}

const struct rad_kernel rad_kernel_avx2 = { "avx2", usable, WALK_ALL };

#endif
