/* blocked.h - is a span blocked? */
#ifndef RADD_TESTS_BLOCKED_H
#define RADD_TESTS_BLOCKED_H

#include "geom/geom.h"

/* Does something opaque, other than object `skip`, meet the span?  blocker and
 * counts are as in rad_geom_sight(). */
static inline bool
is_blocked(const struct rad_geom *g, const struct rad_span *span, int32_t skip,
           int32_t *blocker, struct rad_geom_counts *counts)
{
    struct rad_line line;
    struct rad_hit hit;

    return rad_geom_sight(g, span, skip, blocker, &hit, &line, counts) ==
           RAD_SIGHT_BLOCKED;
}

#endif
