/* walk_sse2.c - the walks with SSE2: a node's eight boxes in two registers */
#include "config.h"

#include "geom/kernel.h"

#ifdef RAD_X86

#include <immintrin.h>

#define WALK_TARGET __attribute__((target("sse2")))
#define WALK(name)  sse2_##name

static inline WALK_TARGET __m128
sse2_slab(const float *bound, float org, float inv)
{
    return _mm_mul_ps(_mm_sub_ps(_mm_loadu_ps(bound), _mm_set1_ps(org)),
                      _mm_set1_ps(inv));
}

/* lanes i to i + 3 */
static inline WALK_TARGET unsigned
sse2_half(const struct rad_bvh_node *node, const struct rad_bvh_ray *r,
          float limit, float *enter, int i)
{
    __m128 in = _mm_set1_ps(r->tmin), out = _mm_set1_ps(INFINITY);

    for (int a = 0; a < 3; a++) {
        in = _mm_max_ps(
            sse2_slab(node->bound + r->enter[a] + i, r->org[0][a], r->inv[a]),
            in);
        out = _mm_min_ps(
            sse2_slab(node->bound + r->leave[a] + i, r->org[1][a], r->inv[a]),
            out);
    }
    out = _mm_mul_ps(out, _mm_set1_ps(RAD_BVH_WIDEN));
    out = _mm_min_ps(out, _mm_set1_ps(limit));
    _mm_storeu_ps(enter + i, in);
    return (unsigned)_mm_movemask_ps(_mm_cmple_ps(in, out)) << i;
}

static inline WALK_TARGET unsigned
sse2_boxes(const struct rad_bvh_node *node, const struct rad_bvh_ray *r,
           float limit, float enter[RAD_BVH_WIDTH])
{
    return sse2_half(node, r, limit, enter, 0) |
           sse2_half(node, r, limit, enter, 4);
}

#include "geom/walk.inc"

static bool
usable(void)
{
    return __builtin_cpu_supports("sse2");
}

const struct rad_kernel rad_kernel_sse2 = { "sse2", usable, WALK_ALL };

#endif
