/* line.h - surfaces that a ray meets one after the other, straight on (inside
 * geom/ only)
 *
 * Behind a pane, a mist's boundary or antimatter most rays go straight on to
 * surfaces that the walk to the pane has already been near.  So in a scene with
 * such surfaces the walk does not end at them: it collects the nearest ones, up
 * to the first that stops the ray, and rays that go on find what they meet in
 * this line (rad_geom_beyond).  A shadow ray collects all that does not stop
 * it.
 *
 * An entry is used only if no other is near enough to tie with it, and if it is
 * farther behind the entry before it than where a ray that leaves that one
 * starts.  Else the line ends before it, and the ray walks by itself. */
#ifndef RAD_GEOM_LINE_H
#define RAD_GEOM_LINE_H

#include "base/vec.h"
#include "geom/bvh.h"

/* Put item i, which w meets at t[0] and, if it is round, again at t[1], into
 * w->line, which keeps the nearest surfaces.  Returns the distance up to which
 * the line is complete. */
double rad_line_note(const struct rad_walk *w, uint32_t i, const double t[2]);

/* Do most rays that meet p from r's side pass it? */
static inline bool
rad_line_passes(const struct rad_prim *p, const struct rad_probe *r)
{
    return p->surf & RAD_SURF_PASSED ||
           (p->surf & RAD_SURF_ONESIDED && rad_prim_is_flat(p) &&
            rad_dot(p->k, r->dir) > 0);
}

/* Let w's line end before the first two entries that may tie.  True: those are
 * entries 0 and 1, and the line is empty. */
bool rad_line_untie(const struct rad_walk *w);

/* After WALK(along): set w->best, w->prim and w->tie to those of the first
 * surface met, passed or not, and complete w->line. */
void rad_line_end(struct rad_walk *w);

#endif
