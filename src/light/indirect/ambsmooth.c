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
    *s = (struct rad_ambsmooth){ 0 };
}

static void
set_place(struct rad_smooth_place *p, const struct rad_ambitem *it,
          const struct rad_ambscale *scale)
{
    const struct rad_ambrec *rec = &it->rec;

    rad_copy(p->p, rec->p);
    memcpy(p->n, rec->n, sizeof p->n);
    memcpy(p->u, rec->u, sizeof p->u);
    memcpy(p->v, it->across, sizeof p->v);
    p->E[0] = rec->E.r;
    p->E[1] = rec->E.g;
    p->E[2] = rec->E.b;
    memcpy(p->gpos, rec->gpos, sizeof p->gpos);
    memcpy(p->gdir, rec->gdir, sizeof p->gdir);
    p->var = rec->var;
    p->reach = (float)rad_ambscale_linear(scale, rec->radius);
    p->bend = (float)rad_ambscale_bend(scale, rec->radius);
    p->fence = rec->fence;
}

bool
rad_ambsmooth_make(struct rad_ambsmooth *s, const struct rad_ambscale *scale,
                   const struct rad_ambitem *item, size_t n)
{
    struct rad_smooth_place *place = malloc((n + 1) * sizeof *place);
    uint32_t count = 0;

    rad_ambsmooth_release(s);
    s->place = malloc((n + 1) * sizeof *s->place);
    for (size_t i = 0; place && s->place && i < n; i++) {
        s->place[i] = item[i].rec.level == 0 ? count : UINT32_MAX;
        if (item[i].rec.level == 0)
            set_place(&place[count++], &item[i], scale);
    }
    if (place && s->place)
        s->smooth = rad_smooth_new(place, count);
    free(place);
    if (s->smooth)
        s->n = n;
    else
        rad_ambsmooth_release(s);
    return s->smooth != NULL;
}
