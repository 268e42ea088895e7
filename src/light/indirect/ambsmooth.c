/* ambsmooth.c - see ambsmooth.h */
#include "config.h"

#include "light/indirect/ambsmooth.h"
#include "base/vec.h"

#include <stdlib.h>
#include <string.h>

/* The way that finds out whether something stands between two places rises to
 * this height over them, by their distance: so it passes over small objects,
 * which hide little from either place.  A sensor's way begins and ends at the
 * part ROUNDED of that height, for a place may be behind its surface by
 * rounding. */
#define LIFT    .05
#define ROUNDED .01

void
rad_ambsmooth_release(struct rad_ambsmooth *s)
{
    rad_smooth_free(s->smooth);
    free(s->place);
    free(s->shown);
    *s = (struct rad_ambsmooth){ 0 };
}

static const struct rad_ambitem *
item_of(const struct rad_ambsmooth *s, uint32_t place)
{
    return &s->item[s->shown[place]];
}

/* struct rad_smooth_source's */
static const double *
point(const void *arg, uint32_t i)
{
    return item_of(arg, i)->p;
}

static void
set_place(const struct rad_ambsmooth *s, const struct rad_ambitem *it,
          struct rad_smooth_place *p)
{
    rad_copy(p->p, it->p);
    memcpy(p->n, it->n, sizeof p->n);
    memcpy(p->u, it->u, sizeof p->u);
    rad_ambitem_across(it, p->v);
    p->E[0] = it->E.r;
    p->E[1] = it->E.g;
    p->E[2] = it->E.b;
    memcpy(p->gpos, it->gpos, sizeof p->gpos);
    memcpy(p->gdir, it->gdir, sizeof p->gdir);
    p->var = it->var;
    p->reach = (float)rad_ambscale_linear(s->scale, it->radius);
    p->bend = (float)rad_ambscale_bend(s->scale, it->radius);
}

static void
place(const void *arg, uint32_t i, struct rad_smooth_place *p)
{
    set_place(arg, item_of(arg, i), p);
}

/* Does a surface stand on the straight way from one point to another? */
static bool
meets(const struct rad_geom *geom, const double from[3], const double to[3],
      struct rad_geom_counts *counts)
{
    struct rad_span span = { .tmin = 0 };
    struct rad_hit hit;

    rad_copy(span.org, from);
    rad_sub(span.dir, to, from);
    span.tmax = rad_normalize(span.dir);
    return rad_geom_nearest(geom, &span, &hit, counts);
}

static void
set_over(double over[3], const double p[3], const float n[3], double height)
{
    for (int k = 0; k < 3; k++)
        over[k] = p[k] + height * (double)n[k];
}

bool
rad_ambsmooth_parted(const struct rad_geom *geom, const double p[3],
                     const float n[3], const double q[3], const float m[3],
                     struct rad_geom_counts *counts)
{
    double corner[4][3], lift = LIFT * sqrt(rad_dist2(p, q));

    set_over(corner[0], p, n, ROUNDED * lift);
    set_over(corner[1], p, n, lift);
    set_over(corner[2], q, m, lift);
    set_over(corner[3], q, m, ROUNDED * lift);
    return lift > 0 && (meets(geom, corner[0], corner[1], counts) ||
                        meets(geom, corner[1], corner[2], counts) ||
                        meets(geom, corner[2], corner[3], counts));
}

/* struct rad_smooth_source's.  Records lie on surfaces, so the way over these
 * is enough.  Its rays are in no statistics: their number depends on which
 * pixels a worker makes. */
static bool
are_parted(const void *arg, const struct rad_smooth_place *a,
           const struct rad_smooth_place *b)
{
    const struct rad_ambsmooth *s = arg;
    struct rad_geom_counts counts = { 0, 0 };
    double from[3], to[3], lift = LIFT * sqrt(rad_dist2(a->p, b->p));

    set_over(from, a->p, a->n, lift);
    set_over(to, b->p, b->n, lift);
    return meets(s->geom, from, to, &counts);
}

bool
rad_ambsmooth_make(struct rad_ambsmooth *s, const struct rad_geom *geom,
                   const struct rad_ambscale *scale,
                   const struct rad_ambitem *item, size_t n)
{
    struct rad_smooth_source source = {
        .arg = s, .point = point, .place = place, .are_parted = are_parted
    };

    rad_ambsmooth_release(s);
    for (size_t i = 0; i < n; i++)
        source.n += item[i].level == 0;
    s->geom = geom;
    s->item = item;
    s->scale = scale;
    s->place = malloc((n + 1) * sizeof *s->place);
    s->shown = malloc(((size_t)source.n + 1) * sizeof *s->shown);
    if (s->place && s->shown) {
        uint32_t count = 0;

        for (uint32_t i = 0; i < n; i++) {
            s->place[i] = item[i].level == 0 ? count : UINT32_MAX;
            if (item[i].level == 0)
                s->shown[count++] = i;
        }
        s->nshown = count;
        s->smooth = rad_smooth_new(&source);
    }
    if (s->smooth)
        s->n = n;
    else
        rad_ambsmooth_release(s);
    return s->smooth != NULL;
}

bool
rad_ambsmooth_beside(const struct rad_ambsmooth *s,
                     const struct rad_ambitem *item, struct rad_smooth_value *v)
{
    struct rad_smooth_place at;

    if (!s->smooth)
        return false;
    set_place(s, item, &at);
    rad_smooth_beside(s->smooth, &at, v);
    return true;
}

size_t
rad_ambsmooth_bytes(const struct rad_ambsmooth *s)
{
    return s->smooth ? s->n * sizeof *s->place + s->nshown * sizeof *s->shown +
                           rad_smooth_bytes(s->smooth)
                     : 0;
}
