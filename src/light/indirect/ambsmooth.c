/* ambsmooth.c - see ambsmooth.h */
#include "config.h"

#include "light/indirect/ambsmooth.h"
#include "base/vec.h"

#include <stdlib.h>
#include <string.h>

/* The ray that finds out whether something stands between two places runs so
 * high above them, over their distance: so it passes over small objects, which
 * hide little from either place. */
#define LIFT .05

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

/* struct rad_smooth_source's: any surface between two places parts them, glass
 * too, since light differs behind it.  These rays are in no statistics: their
 * number depends on which pixels a worker makes. */
static bool
are_parted(const void *arg, const struct rad_smooth_place *a,
           const struct rad_smooth_place *b)
{
    const struct rad_ambsmooth *s = arg;
    struct rad_span span = { .tmin = 0 };
    struct rad_geom_counts counts = { 0, 0 };
    struct rad_hit hit;
    double lift;

    rad_sub(span.dir, b->p, a->p);
    lift = LIFT * sqrt(rad_dot(span.dir, span.dir));
    for (int k = 0; k < 3; k++) {
        span.org[k] = a->p[k] + lift * (double)a->n[k];
        span.dir[k] += lift * (double)(b->n[k] - a->n[k]);
    }
    span.tmax = rad_normalize(span.dir);
    return rad_geom_nearest(s->geom, &span, &hit, &counts);
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
