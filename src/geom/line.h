/* line.h - what a ray meets on its straight way through surfaces (inside geom/
 * only)
 *
 * Behind a pane, a mist's boundary or antimatter most rays go straight on, and
 * what they meet there the walk to the pane has been near already.  So where a
 * scene has such surfaces the walk does not end at them: it collects the
 * nearest, up to the first that stops it, and the rays behind take what they
 * meet from that (rad_geom_beyond).  A shadow ray collects all that does not
 * stop it.
 *
 * An entry stands for itself only if no other is near enough to tie with it,
 * and if it is farther behind the one before than where a ray is started that
 * leaves that; else the line ends before it, and the ray walks as any does. */
#ifndef RAD_GEOM_LINE_H
#define RAD_GEOM_LINE_H

#include "base/vec.h"
#include "geom/bvh.h"

/* Put what w meets of item i, first at t, into w->line, which keeps the
 * nearest.  Returns how far it is complete. */
double rad_line_note(const struct rad_walk *w, uint32_t i, double t);

/* Is p, which the ray meets, likely to be passed? */
static inline bool
rad_line_passes(const struct rad_prim *p, const struct rad_probe *r)
{
    bool flat = p->kind == PRIM_POLYGON || p->kind == PRIM_RING;

    return p->surf & RAD_SURF_PASSED ||
           (p->surf & RAD_SURF_ONESIDED && flat && rad_dot(p->k, r->dir) > 0);
}

/* Let w's line end before the first two entries that may tie.  True: those are
 * number 0 and the one behind it, and nothing is left. */
bool rad_line_untie(const struct rad_walk *w);

/* After a walk along: let w->best, w->prim and w->tie be those of the first
 * thing met, whether it is passed or not, and w->line all of them. */
void rad_line_end(struct rad_walk *w);

#endif
