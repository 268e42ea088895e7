/* ambserving.c - see ambserving.h */
#include "config.h"

#include "light/indirect/ambserving.h"

#include <math.h>
#include <stddef.h>

void
rad_ambserving_add(struct rad_ambserving *s, const void *record, double share)
{
    if (s->n == RAD_AMBSERVING_MOST)
        return;
    s->v[s->n].record = record;
    s->v[s->n++].share = share;
}

void
rad_ambserving_scale(struct rad_ambserving *s, double lum)
{
    double sum = 0;

    for (int i = s->scaled; i < s->n; i++)
        sum += s->v[i].share;
    if (s->scaled == s->n)
        rad_ambserving_add(s, NULL, lum);
    else
        for (int i = s->scaled; i < s->n; i++)
            s->v[i].share = sum > 0 ? s->v[i].share * lum / sum : 0;
    s->scaled = s->n;
}

/* The sum, over records that serve in both pixels, of the products of their
 * shares.  A hemisphere for a pixel alone serves in no other pixel. */
static double
product(const struct rad_ambserving *a, const struct rad_ambserving *b)
{
    double sum = 0;

    for (int i = 0; i < a->n; i++)
        for (int k = 0; k < b->n; k++)
            if (a->v[i].record ? a->v[i].record == b->v[k].record
                               : a == b && i == k)
                sum += a->v[i].share * b->v[k].share;
    return sum;
}

double
rad_ambserving_common(const struct rad_ambserving *a,
                      const struct rad_ambserving *b)
{
    double own = product(a, a) * product(b, b);

    return own > 0 ? product(a, b) / sqrt(own) : 0;
}
