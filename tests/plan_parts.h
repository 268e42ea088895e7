/* plan_parts.h - a small picture's passes in parts, as a large picture's are */
#ifndef RADD_TESTS_PLAN_PARTS_H
#define RADD_TESTS_PLAN_PARTS_H

#include "passes/passplan.h"

/* Each pass of the plan in parts, of which none needs anything of another; of
 * the scattered pass they replace its rounds, and have all of it.  The picture
 * is a square. */
static inline uint32_t
plan_parts(const struct rad_params *params, int side,
           struct rad_pass pass[RAD_MOST_PASSES])
{
    static struct rad_pass whole[RAD_MOST_PASSES];
    struct rad_pass_size size = { side, side };
    uint32_t n = rad_passes_plan(params, &size, 1, whole), to = 1;

    pass[0] = whole[0];
    for (uint32_t i = 1; i < n && !(whole[i].scattered && whole[i].first); i++)
        for (int part = 0; part < RAD_PASS_PARTS; part++) {
            struct rad_pass *k = &pass[to];

            *k = whole[i];
            k->part = part;
            k->reads = to < RAD_PASS_PARTS ? 1 : to + 1 - RAD_PASS_PARTS;
            k->tiles = k->level > 0 ? (k->tiles + 3) / RAD_PASS_PARTS
                                    : rad_pass_tiles(k, side, side);
            if (k->scattered) {
                k->squares = k->end = k->tiles;
                k->leap = 1;
            }
            to += k->tiles > 0;
        }
    return to;
}

#endif
