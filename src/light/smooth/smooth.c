/* smooth.c - see smooth.h
 *
 * Neighbours are found in a k-d tree.  Fits of several widths are tried, and
 * the fit with the least expected error is taken.  A fit errs by its noise, and
 * by how far its samples are off the fit beyond their own noise.  The value is
 * a mean of the fit and the place's own measurement, weighted by their expected
 * errors.
 *
 * Samples are not weighted by their own variances: of two hemispheres beside a
 * small bright patch the hemisphere that hit the patch has the larger variance,
 * and such weights would lose the patch's light.
 *
 * If one ray makes most of a place's E, its variance is large.  If such a place
 * is far above its neighbours too, it is cut down to LARGEST times their mean;
 * else it would be a splotch as wide as the fits.  But if more than FEW of the
 * neighbours have such a variance, they met the same light, which few rays
 * find: then all are averaged as they are.  A place without light, whose
 * variance is 0, is a sample like the others: without such samples the mean
 * would be that of the places that met light.
 * Source of the tree: Bentley 1975. */
#include "config.h"

#include "light/smooth/smooth.h"
#include "light/smooth/quadric.h"
#include "base/color.h"
#include "base/vec.h"

#include <stdatomic.h>
#include <stdlib.h>

/* Neighbours are at most so many times a place's `reach' away. */
#define REACH 4

/* At most so many neighbours.  If there are more, the distance within which
 * they are searched is multiplied by NEARER, down to NEAREST times the first
 * distance. */
#define MOST_NEAR 160
#define NEARER    .7
#define NEAREST   1e-9

/* The least cosine between the normals of neighbours. */
#define LEAST_COSINE .98
/* How far neighbours may be off each other's plane, over their distance: the
 * sum for both, with signs that cancel on a round surface. */
#define OFF_PLANE .05
/* Places nearer than this, relative to the search distance, need not pass the
 * tests for OFF_PLANE and for what stands between them. */
#define ROUNDING 1e-6

/* Turning a neighbour's E to the place's normal changes it at most by this
 * factor. */
#define MOST_TURNED 2

/* A single ray may rule a place's E if the variance of E, over its square, is
 * larger than this.  LARGEST and FEW: see above. */
#define RULED   .25
#define LARGEST 4
#define FEW     2

/* A place's `bend' is a mean over all directions; along a single direction E
 * may bend so many times as much. */
#define SHARPEST 6

/* States of a value: not made, being stored, stored. */
enum { WAITING, BUSY, DONE };

/* A node of the tree is the number of a place, and from this bit on the axis
 * along which it parts the nodes before it from those behind. */
#define AXIS 30
#define MANY (UINT32_C(1) << AXIS)

struct rad_smooth {
    struct rad_smooth_source of;
    uint32_t *node;                 /* the tree: n nodes in order */
    struct rad_smooth_value *value; /* by number of a place */
    _Atomic uint8_t *state;         /* of the value, by number */
};

/* The point of a node's place. */
static inline const double *
point(const struct rad_smooth_source *of, uint32_t node)
{
    return of->point(of->arg, node & (MANY - 1));
}

/* --- the tree --- */

static void
swap(uint32_t *a, uint32_t *b)
{
    uint32_t t = *a;

    *a = *b;
    *b = t;
}

/* Partition p[lo..hi] along the axis by the coordinate of the middle node
 * (Hoare 1961): nodes up to the returned index, which is below hi, have at most
 * that coordinate, those behind at least that. */
static size_t
part_at_middle(const struct rad_smooth_source *of, uint32_t *p, size_t lo,
               size_t hi, int axis)
{
    double pivot = point(of, p[lo + (hi - lo) / 2])[axis];

    for (;;) {
        while (point(of, p[lo])[axis] < pivot)
            lo++;
        while (point(of, p[hi])[axis] > pivot)
            hi--;
        if (lo >= hi)
            return hi;
        swap(&p[lo++], &p[hi--]);
    }
}

static int
longest_side(const struct rad_smooth_source *of, const uint32_t *p, size_t n)
{
    double lo[3], hi[3], most = -1;
    int axis = 0;

    rad_copy(lo, point(of, p[0]));
    rad_copy(hi, lo);
    for (size_t i = 1; i < n; i++) {
        const double *at = point(of, p[i]);

        for (int k = 0; k < 3; k++) {
            lo[k] = rad_least(lo[k], at[k]);
            hi[k] = rad_most(hi[k], at[k]);
        }
    }
    for (int k = 0; k < 3; k++)
        if (hi[k] - lo[k] > most) {
            most = hi[k] - lo[k];
            axis = k;
        }
    return axis;
}

/* Put n nodes in order: the middle one parts those before it from those behind
 * along the axis in which they extend most; the same holds for both halves. */
static void
make_tree(const struct rad_smooth_source *of, uint32_t *p, size_t n)
{
    while (n > 1) {
        size_t lo = 0, hi = n - 1, half = n / 2;
        int axis = longest_side(of, p, n);

        while (lo < hi) {
            size_t j = part_at_middle(of, p, lo, hi, axis);

            if (half <= j)
                hi = j;
            else
                lo = j + 1;
        }
        p[half] |= (uint32_t)axis << AXIS;
        make_tree(of, p, half);
        p += half + 1;
        n -= half + 1;
    }
}

struct rad_smooth *
rad_smooth_new(const struct rad_smooth_source *source)
{
    struct rad_smooth *s = calloc(1, sizeof *s);
    size_t n = source->n;

    if (!s || n >= MANY)
        goto fail;
    s->of = *source;
    s->node = malloc((n + 1) * sizeof *s->node);
    s->value = malloc((n + 1) * sizeof *s->value);
    s->state = calloc(n + 1, sizeof *s->state);
    if (!s->node || !s->value || !s->state)
        goto fail;
    for (uint32_t i = 0; i < n; i++)
        s->node[i] = i;
    make_tree(&s->of, s->node, n);
    return s;
fail:
    rad_smooth_free(s);
    return NULL;
}

void
rad_smooth_free(struct rad_smooth *s)
{
    if (!s)
        return;
    free(s->node);
    free(s->value);
    free((void *)s->state);
    free(s);
}

size_t
rad_smooth_bytes(const struct rad_smooth *s)
{
    return sizeof *s +
           ((size_t)s->of.n + 1) *
               (sizeof *s->node + sizeof *s->value + sizeof *s->state);
}

/* --- neighbours --- */

/* A search for the neighbours of a place. */
struct search {
    const struct rad_smooth *s;
    struct rad_smooth_place of; /* the place */
    uint32_t number;            /* of the place; MANY: it is not of the tree */
    double far;                 /* neighbours are nearer than this */
    bool full;                  /* there are more than MOST_NEAR */
    int n;
    struct rad_quadric_sample near[MOST_NEAR]; /* in units of `far' */
};

static double
dot_mixed(const double a[3], const float b[3])
{
    return a[0] * (double)b[0] + a[1] * (double)b[1] + a[2] * (double)b[2];
}

static double
dot_floats(const float a[3], const float b[3])
{
    return (double)a[0] * (double)b[0] + (double)a[1] * (double)b[1] +
           (double)a[2] * (double)b[2];
}

static double
luminance(const float E[3])
{
    return rad_rgb_lum(rad_rgb(E[0], E[1], E[2]));
}

/* Are k->of and b, which is at d from it, neighbours on one surface? */
static bool
are_neighbours(const struct search *k, const struct rad_smooth_place *b,
               const double d[3], double d2)
{
    const struct rad_smooth_place *a = &k->of;
    const struct rad_smooth_source *of = &k->s->of;
    double off = dot_mixed(d, a->n) + dot_mixed(d, b->n);

    if (!(dot_floats(a->n, b->n) >= LEAST_COSINE))
        return false;
    if (d2 <= ROUNDING * ROUNDING * k->far * k->far)
        return true;
    return off * off <= OFF_PLANE * OFF_PLANE * d2 &&
           !of->are_parted(of->arg, a, b);
}

/* The factor by which E changes from b's normal to a's. */
static double
turned(const struct rad_smooth_place *a, const struct rad_smooth_place *b)
{
    double f = 1 + (double)b->gdir[1] * dot_floats(a->n, b->u) -
               (double)b->gdir[0] * dot_floats(a->n, b->v);

    return rad_least(rad_most(f, 1. / MOST_TURNED), MOST_TURNED);
}

/* Add place p, at d from k->of, to the samples. */
static void
add_sample(struct search *k, const struct rad_smooth_place *p,
           const double d[3], double d2)
{
    const struct rad_smooth_place *of = &k->of;
    struct rad_quadric_sample *to = &k->near[k->n++];
    double f = d2 > 0 ? turned(of, p) : 1;

    to->x = dot_mixed(d, of->u) / k->far;
    to->y = dot_mixed(d, of->v) / k->far;
    to->d2 = d2 / (k->far * k->far);
    for (int c = 0; c < 3; c++)
        to->E[c] = f * (double)p->E[c];
    to->lum = f * luminance(p->E);
    to->noise = (double)p->var * to->lum * to->lum;
}

/* Add place `number', whose point is p, if it is a neighbour. */
static void
try_place(struct search *k, uint32_t number, const double p[3])
{
    struct rad_smooth_place at;
    double d[3], d2;

    rad_sub(d, p, k->of.p);
    d2 = rad_dot(d, d);
    if (!(d2 < k->far * k->far) || number == k->number)
        return;
    k->s->of.place(k->s->of.arg, number, &at);
    if (at.var < 0 || !are_neighbours(k, &at, d, d2))
        return;
    if (k->n < MOST_NEAR)
        add_sample(k, &at, d, d2);
    else
        k->full = true;
}

/* Look for neighbours among the nodes from lo to hi - 1. */
static void
search_part(struct search *k, size_t lo, size_t hi)
{
    while (lo < hi && !k->full) {
        size_t half = lo + (hi - lo) / 2;
        uint32_t node = k->s->node[half], axis = node >> AXIS;
        const double *p = point(&k->s->of, node);
        double d = k->of.p[axis] - p[axis];

        try_place(k, node & (MANY - 1), p);
        if (d < k->far)
            search_part(k, lo, half);
        if (d < -k->far)
            return;
        lo = half + 1;
    }
}

/* Find the neighbours of k->of; its own sample is the first.  (If more than
 * MOST_NEAR places all but coincide, which no cache makes, some sixty searches
 * end with the place alone.) */
static void
find_neighbours(struct search *k)
{
    static const double here[3] = { 0, 0, 0 };
    const double most = REACH * (double)k->of.reach;

    k->far = most;
    do {
        k->n = 0;
        k->full = false;
        add_sample(k, &k->of, here, 0);
        search_part(k, 0, k->s->of.n);
    } while (k->full && (k->far *= NEARER) > NEAREST * most);
    if (k->full)
        k->n = 1;
}

/* --- values --- */

/* Cut down samples that one ray rules, to LARGEST times the mean of all after
 * the cut, which is found by iteration. */
static void
cut_ruled(struct search *k)
{
    double most = INFINITY;
    int ruled = 0;

    for (int i = 0; i < k->n; i++)
        ruled += k->near[i].noise > RULED * k->near[i].lum * k->near[i].lum;
    if (ruled == 0 || ruled > FEW)
        return;
    for (int pass = 0; pass < 8; pass++) {
        double sum = 0;

        for (int i = 0; i < k->n; i++)
            sum += rad_least(k->near[i].lum, most);
        most = LARGEST * sum / k->n;
    }
    for (int i = 0; i < k->n; i++) {
        struct rad_quadric_sample *s = &k->near[i];
        double f = most / s->lum;

        if (!(s->lum > most) || !(s->noise > RULED * s->lum * s->lum))
            continue;
        for (int c = 0; c < 3; c++)
            s->E[c] *= f;
        s->lum = most;
        s->noise *= f * f;
    }
}

/* Set *best to the fit of least risk; false: there is no fit. */
static bool
find_best(const struct search *k, struct rad_quadric *best)
{
    static const double width[] = { .35, .5, .7, 1 };
    double bend = SHARPEST * (double)k->of.bend * k->far * k->far / 2;
    double mean = 0, noise = rad_quadric_noise(k->near, k->n);
    bool any = false;

    for (int i = 0; i < k->n; i++)
        mean += k->near[i].lum / k->n;
    for (int i = 0; i < 4; i++) {
        struct rad_quadric q;

        if (!rad_quadric_fit(k->near, k->n, width[i], noise, bend * mean, &q) ||
            (any && !(q.risk < best->risk)))
            continue;
        *best = q;
        any = true;
    }
    return any;
}

/* The weight of the fit in the value, for the least expected squared error.
 * The place's own sample is part of the fit, by pull[0], so the errors of both
 * are correlated. */
static double
share_of(const struct rad_quadric *q)
{
    double own = q->pull[0], risk = q->risk / q->noise;
    double share = (1 - own) / (1 + risk - 2 * own);

    return own < 1 ? rad_least(share, 1) : 0;
}

/* The least luminance among the samples of fit q, or `lum' if that is less.
 * Beyond its samples a fit is often too dark, down to black corners.  Upward it
 * is right more often: toward a bright patch E rises ever more steeply. */
static double
least_sample(const struct search *k, const struct rad_quadric *q, double lum)
{
    for (int i = 0; i < k->n; i++)
        if (k->near[i].d2 < q->width * q->width)
            lum = rad_least(lum, k->near[i].lum);
    return lum;
}

/* Set *v by fit q; false: a channel would be negative, or all channels zero. */
static bool
set_value(const struct search *k, const struct rad_quadric *q,
          struct rad_smooth_value *v)
{
    const struct rad_smooth_place *of = &k->of;
    const struct rad_quadric_sample *own = &k->near[0];
    double share = share_of(q), E[3], lum;

    rad_quadric_middle(k->near, k->n, q, E);
    for (int c = 0; c < 3; c++) {
        if (!(E[c] >= 0))
            return false;
        v->E[c] = (float)(own->E[c] + share * (E[c] - own->E[c]));
    }
    lum = luminance(v->E);
    if (!(lum > 0))
        return false;
    for (int i = 0; i < 2; i++) {
        double slope = (double)of->gpos[i] * own->lum;

        slope += share * (q->slope[i] / k->far - slope);
        v->gpos[i] = (float)(slope / lum);
    }
    v->least = (float)(least_sample(k, q, lum) / lum);
    v->var = (float)((share * share * q->risk +
                      (1 - share) * (1 - share) * q->noise) /
                     (lum * lum));
    return true;
}

/* Set *v to the place's own measurement, times the factor `cut'. */
static void
keep_own(const struct rad_smooth_place *at, double cut,
         struct rad_smooth_value *v)
{
    for (int c = 0; c < 3; c++)
        v->E[c] = (float)(cut * (double)at->E[c]);
    v->gpos[0] = at->gpos[0];
    v->gpos[1] = at->gpos[1];
    v->least = 0;
    v->var = at->var;
}

/* Set *v to the value at k->of. */
static void
make_value(struct search *k, struct rad_smooth_value *v)
{
    struct rad_quadric q = { .noise = 0 }; /* no fit */
    double lum = luminance(k->of.E);

    keep_own(&k->of, 1, v);
    if (k->of.var < 0 || (lum > 0 && !(k->of.var > 0)))
        return;
    find_neighbours(k);
    cut_ruled(k);
    if (!find_best(k, &q) || !(q.noise > 0) || !set_value(k, &q, v))
        keep_own(&k->of, lum > 0 ? k->near[0].lum / lum : 1, v);
}

void
rad_smooth_at(struct rad_smooth *s, uint32_t i, struct rad_smooth_value *v)
{
    /* acquire: pairs with the release below, for `value' */
    uint8_t state = atomic_load_explicit(&s->state[i], memory_order_acquire);
    struct search k; /* only set in part: its array is large */

    if (state == DONE) {
        *v = s->value[i];
        return;
    }
    k.s = s;
    k.number = i;
    s->of.place(s->of.arg, i, &k.of);
    make_value(&k, v);
    /* relaxed: a thread that does not win stores nothing, and reads nothing */
    if (state == WAITING && atomic_compare_exchange_strong_explicit(
                                &s->state[i], &state, BUSY,
                                memory_order_relaxed, memory_order_relaxed)) {
        s->value[i] = *v;
        atomic_store_explicit(&s->state[i], DONE, memory_order_release);
    }
}

void
rad_smooth_beside(const struct rad_smooth *s, const struct rad_smooth_place *at,
                  struct rad_smooth_value *v)
{
    struct search k; /* only set in part */

    k.s = s;
    k.number = MANY;
    k.of = *at;
    make_value(&k, v);
}
