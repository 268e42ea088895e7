/* walk_avx512.c - the walks with AVX-512: both planes of an axis, of all eight
 * boxes, in one register
 *
 * A register holds the eight distances where the ray enters, and the negatives
 * of those where it leaves, so that one maximum serves both; negation rounds
 * nothing. */
#include "config.h"

#include "geom/kernel.h"

#ifdef RAD_X86

#include <immintrin.h>

#define WALK_TARGET __attribute__((target("avx512f,avx512dq,avx2")))
#define WALK(name)  avx512_##name

/* lo in the lower half, hi in the upper half */
static inline WALK_TARGET __m512
avx512_halves(float lo, float hi)
{
    return _mm512_insertf32x8(_mm512_set1_ps(lo), _mm256_set1_ps(hi), 1);
}

static inline WALK_TARGET unsigned
avx512_boxes(const struct rad_bvh_node *node, const struct rad_bvh_ray *r,
             float limit, float enter[RAD_BVH_WIDTH])
{
    __m512 m = avx512_halves(r->tmin, -INFINITY);

    for (int a = 0; a < 3; a++) {
        __m512 b = _mm512_loadu_ps(node->bound + RAD_BVH_BOUND(a, 0));

        if (r->enter[a] > r->leave[a]) /* it enters at the upper bound */
            b = _mm512_shuffle_f32x4(b, b, 0x4e);
        b = _mm512_sub_ps(b, avx512_halves(r->org[0][a], r->org[1][a]));
        b = _mm512_mul_ps(b, avx512_halves(r->inv[a], -r->inv[a]));
        m = _mm512_max_ps(b, m);
    }
    __m256 in = _mm512_castps512_ps256(m);
    __m256 out = _mm512_extractf32x8_ps(m, 1);

    out = _mm256_mul_ps(out, _mm256_set1_ps(-RAD_BVH_WIDEN));
    out = _mm256_min_ps(out, _mm256_set1_ps(limit));
    _mm256_storeu_ps(enter, in);
    return (unsigned)_mm256_movemask_ps(_mm256_cmp_ps(in, out, _CMP_LE_OQ));
}

#include "geom/walk.inc"

static bool
usable(void)
{
    return __builtin_cpu_supports("avx512f") &&
           __builtin_cpu_supports("avx512dq");
}

const struct rad_kernel rad_kernel_avx512 = { "avx512", usable, WALK_ALL };

#endif
