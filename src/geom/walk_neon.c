/* walk_neon.c - the walks with NEON: a node's eight boxes in two registers */
#include "config.h"

#include "geom/kernel.h"

#ifdef RAD_ARM64

#include <arm_neon.h>

#define WALK_TARGET
#define WALK(name) neon_##name

static inline float32x4_t
neon_slab(const float *bound, float org, float inv)
{
    return vmulq_n_f32(vsubq_f32(vld1q_f32(bound), vdupq_n_f32(org)), inv);
}

/* lanes i to i + 3 */
static inline unsigned
neon_half(const struct rad_bvh_node *node, const struct rad_bvh_ray *r,
          float limit, float *enter, int i)
{
    static const uint32_t bit[4] = { 1, 2, 4, 8 };
    float32x4_t in = vdupq_n_f32(r->tmin), out = vdupq_n_f32(INFINITY);

    for (int a = 0; a < 3; a++) {
        in = vmaxq_f32(
            neon_slab(node->bound + r->enter[a] + i, r->org[0][a], r->inv[a]),
            in);
        out = vminq_f32(
            neon_slab(node->bound + r->leave[a] + i, r->org[1][a], r->inv[a]),
            out);
    }
    out = vmulq_n_f32(out, RAD_BVH_WIDEN);
    out = vminq_f32(out, vdupq_n_f32(limit));
    vst1q_f32(enter + i, in);
    return vaddvq_u32(vandq_u32(vcleq_f32(in, out), vld1q_u32(bit))) << i;
}

static inline unsigned
neon_boxes(const struct rad_bvh_node *node, const struct rad_bvh_ray *r,
           float limit, float enter[RAD_BVH_WIDTH])
{
    return neon_half(node, r, limit, enter, 0) |
           neon_half(node, r, limit, enter, 4);
}

#include "geom/walk.inc"

static bool
usable(void)
{
    return true;
}

const struct rad_kernel rad_kernel_neon = { "neon", usable, WALK_ALL };

#endif
