/* walk_plain.c - the walks in plain C, for any processor */
#include "config.h"

#include "geom/kernel.h"

#define WALK_TARGET
#define WALK(name) plain_##name

static inline unsigned
plain_boxes(const struct rad_bvh_node *node, const struct rad_bvh_ray *r,
            float limit, float enter[RAD_BVH_WIDTH])
{
    unsigned mask = 0;

    for (int i = 0; i < RAD_BVH_WIDTH; i++) {
        float in = r->tmin, out = INFINITY;

        for (int a = 0; a < 3; a++) {
            float near =
                (node->bound[r->enter[a] + i] - r->org[0][a]) * r->inv[a];
            float far =
                (node->bound[r->leave[a] + i] - r->org[1][a]) * r->inv[a];

            in = near > in ? near : in;
            out = far < out ? far : out;
        }
        out *= RAD_BVH_WIDEN;
        enter[i] = in;
        mask |= (unsigned)(in <= out && in <= limit) << i;
    }
    return mask;
}

#include "geom/walk.inc"

static bool
usable(void)
{
    return true;
}

const struct rad_kernel rad_kernel_plain = { "plain", usable, WALK_ALL };
