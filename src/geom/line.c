/* line.c - see line.h */
#include "config.h"

#include "geom/line.h"

#include "base/vec.h"
#include "geom/kernel.h"

#include <math.h>

/* Insert item i, met at t.  Returns the distance up to which the line holds all
 * that was inserted. */
static double
put(struct rad_line *line, uint32_t i, double t)
{
    double end = INFINITY;
    int k = line->n;

    if (k == RAD_LINE_MOST) {
        line->open = true;
        end = line->at[--k].t;
        if (!(t < end))
            return t;
    } else {
        line->n++;
    }
    for (; k > 0 && line->at[k - 1].t > t; k--)
        line->at[k] = line->at[k - 1];
    line->at[k].t = t;
    line->at[k].item = i;
    return end;
}

double
rad_line_note(const struct rad_walk *w, uint32_t i, const double t[2])
{
    uint8_t kind = w->prims[i].kind;
    double end = put(w->line, i, t[0]);

    if ((kind == PRIM_SPHERE || kind == PRIM_CONE) && t[1] < INFINITY)
        end = rad_least(put(w->line, i, t[1]), end);
    return end;
}

bool
rad_line_untie(const struct rad_walk *w)
{
    struct rad_line *line = w->line;

    for (int k = 1; k < line->n; k++)
        if (!(line->at[k].t - line->at[k - 1].t >
              rad_walk_window(w, line->at[k - 1].t))) {
            line->n = k - 1;
            line->open = true;
            return k == 1;
        }
    return false;
}

/* Drop the entries at or behind the surface that stops w, and note ties with
 * it.  True: no entry is left. */
static bool
only_stopped(struct rad_walk *w)
{
    struct rad_line *line = w->line;

    while (line->n > 0 && line->at[line->n - 1].t >= w->best) {
        line->n--;
        w->tie |= line->at[line->n].t < w->cut;
    }
    return line->n == 0;
}

/* rad_line_untie(); also drop the last entry if it is unsure. */
static bool
untie_but(const struct rad_walk *w, bool unsure)
{
    int n = w->line->n;
    bool tied = rad_line_untie(w);

    if (unsure && w->line->n == n)
        w->line->n--;
    return tied;
}

void
rad_line_end(struct rad_walk *w)
{
    struct rad_line *line = w->line;
    bool stopped = w->prim != RAD_NO_PRIM;
    bool unsure = w->tie || (stopped && w->prims[w->prim].kind == PRIM_PLACE);

    if (!only_stopped(w)) {
        unsure |= w->tie;
        if (stopped)
            put(line, w->prim, w->best);
        w->best = line->at[0].t;
        w->prim = line->at[0].item;
        w->tie = untie_but(w, unsure);
    }
    line->open |= stopped;
    if (w->tie)
        w->cut = rad_least(w->best + rad_walk_window(w, w->best), w->tmax);
}

enum rad_beyond
rad_geom_beyond(const struct rad_geom *g, const struct rad_line *line, int i,
                const struct rad_hit *last, const double org[3],
                const double dir[3], struct rad_hit *hit)
{
    struct rad_probe probe;
    double t;

    if (i >= line->n)
        return line->open ? RAD_BEYOND_UNKNOWN : RAD_BEYOND_NONE;
    t = line->at[i].t - line->at[i - 1].t;
    if (!(t * fabs(rad_dot(last->n, dir)) > 4 * last->err))
        return RAD_BEYOND_UNKNOWN;
    rad_copy(probe.org, org);
    rad_copy(probe.dir, dir);
    rad_prim_surface(&g->top.prims[line->at[i].item], &probe, t, hit);
    return RAD_BEYOND_MET;
}

int32_t
rad_geom_ahead(const struct rad_geom *g, const struct rad_line *line, int i)
{
    return i < line->n ? g->top.prims[line->at[i].item].obj : RAD_VOID;
}

bool
rad_geom_faces(const struct rad_geom *g, const struct rad_line *line, int i,
               const struct rad_span *span)
{
    const struct rad_prim *p = &g->top.prims[line->at[i].item];
    struct rad_probe probe;
    struct rad_hit hit;

    if (rad_prim_is_flat(p))
        return rad_dot(p->k, span->dir) < 0;
    rad_copy(probe.org, span->org);
    rad_copy(probe.dir, span->dir);
    rad_prim_surface(p, &probe, line->at[i].t, &hit);
    return rad_dot(hit.n, span->dir) < 0;
}

bool
rad_geom_passes(const struct rad_geom *g)
{
    return g->passes;
}
