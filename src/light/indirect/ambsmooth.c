/* ambsmooth.c - see ambsmooth.h */
#include "config.h"

#include "light/indirect/ambsmooth.h"
#include "base/vec.h"

#include <stdlib.h>
#include <string.h>

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

/* Of struct rad_smooth_source. */
static const double *
point(const void *arg, uint32_t i)
{
    return item_of(arg, i)->p;
}

static void
place(const void *arg, uint32_t i, struct rad_smooth_place *p)
{
    const struct rad_ambsmooth *s = arg;
    const struct rad_ambitem *it = item_of(s, i);

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
    p->fence = it->fence;
}

bool
rad_ambsmooth_make(struct rad_ambsmooth *s, const struct rad_ambscale *scale,
                   const struct rad_ambitem *item, size_t n)
{
    struct rad_smooth_source source = { .arg = s,
                                        .point = point,
                                        .place = place };

    rad_ambsmooth_release(s);
    for (size_t i = 0; i < n; i++)
        source.n += item[i].level == 0;
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

size_t
rad_ambsmooth_bytes(const struct rad_ambsmooth *s)
{
    return s->smooth ? s->n * sizeof *s->place + s->nshown * sizeof *s->shown +
                           rad_smooth_bytes(s->smooth)
                     : 0;
}
