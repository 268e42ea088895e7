/* quad.c - see quad.h
 *
 * A parallelogram is halved across its longer side until each part is small.
 * A part's axes are those of the whole times s and t, powers of two.  With a
 * and b the axes of the whole's moments, c the part's middle and q = c.c, the
 * second order of the flux (sample.c) is
 *     e = (2 (s^2 a.a + t^2 b.b) - 8 h / q) / q,
 *     corr = -4/q (s^2 (c.a) a + t^2 (c.b) b - h/q c),
 *     h = s^2 (c.a)^2 + t^2 (c.b)^2.
 * Two parts are computed at a time, in vectors of two doubles, which every
 * processor has: square roots and divisions are most of a sample's cost. */
#include "config.h"

#include "light/sample/quad.h"
#include "light/sample/contour.h"
#include "base/rng.h"
#include "base/vec.h"

#include <string.h>

/* Halvings that make RAD_LIGHT_PATCHES. */
enum { LEVELS = 6 };

/* A part's variance over its squared distance up to which the expansion to
 * second order is off by 3e-3 at most.  A part that could not be cut further,
 * since there are 64 parts at most, may exceed this variance: such a part gets
 * the flux of its outline. */
#define FAR_VARIANCE .02

/* This bound for parts that are as small as -ds asks, where view->sizerat is
 * large, as for rays of little weight: with variances below the bound the mean
 * over all places is too bright by 3e-3, with variances up to .5 by a fifth. */
#define COARSE_VARIANCE .05

typedef double pair __attribute__((vector_size(16)));

/* A part that may be cut further.  Its numbers are members by themselves, since
 * an array would be copied by vectors, and their loads would wait until the
 * stores of all elements are done. */
struct part {
    double x, y, z; /* middle, relative to the point */
    double s, t;    /* its axes over the axes of the whole */
    int budget;     /* how many parts it may be cut into */
};

/* The parts that are cut, in arrays that are read two elements at a time. */
struct parts {
    double c[3][RAD_LIGHT_PATCHES]; /* middles, relative to the point */
    double s[RAD_LIGHT_PATCHES], t[RAD_LIGHT_PATCHES];
    bool last[RAD_LIGHT_PATCHES]; /* this part could not be cut further */
    bool coarse;                  /* parts may be above COARSE_VARIANCE */
    int n;
};

/* --- cutting --- */

static void
keep(struct parts *l, const struct part *p)
{
    l->c[0][l->n] = p->x;
    l->c[1][l->n] = p->y;
    l->c[2][l->n] = p->z;
    l->s[l->n] = p->s;
    l->t[l->n] = p->t;
    l->last[l->n] = p->budget <= 1;
    l->n++;
}

/* Halve p across the axis whose factor is *size (&p->s or &p->t): *p becomes
 * one half, *half the other. */
static inline void
halve(struct part *p, struct part *half, double *size, const double axis[3])
{
    *size *= .5;
    p->budget /= 2;

    double dx = *size * axis[0], dy = *size * axis[1], dz = *size * axis[2];

    half->x = p->x + dx;
    half->y = p->y + dy;
    half->z = p->z + dz;
    half->s = p->s;
    half->t = p->t;
    half->budget = p->budget;
    p->x -= dx;
    p->y -= dy;
    p->z -= dz;
}

/* Cut a parallelogram into parts that are small enough for -ds. */
static void
cut(const struct rad_source *src, const struct rad_light_view *view,
    struct parts *l)
{
    const struct rad_moments *m = &src->root;
    const double *u = src->axis[0], *v = src->axis[1];
    double uu = rad_dot(u, u), vv = rad_dot(v, v);
    double aa = rad_dot(m->a, m->a), bb = rad_dot(m->b, m->b);
    double ab = rad_dot(m->a, m->b);
    double limit = rad_side_limit(view->sizerat);
    struct part stack[LEVELS], p = { .s = 1, .t = 1 };
    int n = 0;

    p.x = src->centre[0] - view->p[0];
    p.y = src->centre[1] - view->p[1];
    p.z = src->centre[2] - view->p[2];
    p.budget = view->sizerat > 0 ? RAD_LIGHT_PATCHES : 1;
    l->n = 0;
    /* a part's two variances add up to 2 limit d2 at most */
    l->coarse = 2 * limit > COARSE_VARIANCE;
    for (;;) {
        while (p.budget > 1) {
            double ss = p.s * p.s, tt = p.t * p.t;
            double d2 = p.x * p.x + p.y * p.y + p.z * p.z;

            if (rad_side_small_enough(aa * ss, bb * tt, ab * (p.s * p.t),
                                      limit * d2))
                break;
            if (uu * ss > vv * tt)
                halve(&p, &stack[n++], &p.s, u);
            else
                halve(&p, &stack[n++], &p.t, v);
        }
        keep(l, &p);
        if (n == 0)
            return;
        p = stack[--n];
    }
}

/* --- samples, two at a time --- */

static pair
take(const double *v)
{
    pair p;

    memcpy(&p, v, sizeof p);
    return p;
}

static pair
root(pair x)
{
    for (int i = 0; i < 2; i++)
        x[i] = sqrt(x[i]);
    return x;
}

static pair
dot(const pair c[3], const double a[3])
{
    return c[0] * a[0] + c[1] * a[1] + c[2] * a[2];
}

/* Aim two samples at the places c; returns the inverses of their distances. */
static pair
aim(struct rad_light_sample s[2], const pair c[3])
{
    pair dist = root(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]), per = 1 / dist;

    for (int i = 0; i < 2; i++)
        s[i].dist = dist[i];
    for (int k = 0; k < 3; k++) {
        pair d = c[k] * per;

        s[0].aim[k] = d[0];
        s[1].aim[k] = d[1];
    }
    return per;
}

/* The factor of the flux along c that its second order makes, where e is the
 * correction: 1 / (1 + e), or 1 - e, at most 2, if e is not positive. */
static pair
along(pair e)
{
    pair f = 1 / (1 + e);

    for (int i = 0; i < 2; i++)
        if (!(e[i] > 0))
            f[i] = rad_least(1 - e[i], 2);
    return f;
}

/* The factor that cuts the correction across c to half the length of c at most
 * (per2 is the inverse square of that length): so the flux points at the part
 * even where the expansion does not hold. */
static pair
across(const pair corr[3], pair per2)
{
    pair side =
             (corr[0] * corr[0] + corr[1] * corr[1] + corr[2] * corr[2]) * per2,
         f = { 1, 1 };

    for (int i = 0; i < 2; i++)
        if (side[i] > .25)
            f[i] = .5 / sqrt(side[i]);
    return f;
}

/* Make the samples of two parts with middles c by the expansion to second
 * order.  Their axes are s and t times the whole's; k is -n.c times their area.
 */
static void
expand(struct rad_light_sample smp[2], const struct rad_moments *m,
       const pair c[3], pair s, pair t, pair k)
{
    pair per = aim(smp, c), per2 = per * per, s2 = s * s, t2 = t * t;
    pair ca = dot(c, m->a), cb = dot(c, m->b), sa = s2 * ca, tb = t2 * cb;
    pair h = (sa * ca + tb * cb) * per2;
    pair e =
        (2 * (s2 * rad_dot(m->a, m->a) + t2 * rad_dot(m->b, m->b)) - 8 * h) *
        per2;
    pair corr[3], F[3], f, len;

    for (int i = 0; i < 3; i++)
        corr[i] = -4 * per2 * (sa * m->a[i] + tb * m->b[i] - h * c[i]);
    f = across(corr, per2);
    e = along(e);
    for (int i = 0; i < 3; i++)
        F[i] = corr[i] * f + e * c[i];
    len = root(F[0] * F[0] + F[1] * F[1] + F[2] * F[2]);
    k *= per2 * per2 * len;
    len = 1 / len;
    for (int i = 0; i < 2; i++)
        smp[i].omega = k[i];
    for (int i = 0; i < 3; i++) {
        pair d = F[i] * len;

        smp[0].dir[i] = d[0];
        smp[1].dir[i] = d[1];
    }
}

/* Make two samples at the points c, each a random point of its part. */
static void
shoot(struct rad_light_sample smp[2], const pair c[3], pair k)
{
    pair per = aim(smp, c);

    k *= per * per * per;
    for (int i = 0; i < 2; i++) {
        smp[i].omega = k[i];
        rad_copy(smp[i].dir, smp[i].aim);
    }
}

/* A random number between -jitter and jitter for each of parts i and i + 1;
 * which: 0 along axis u, 1 along v. */
static pair
jittered(const struct rad_light_view *view, int i, int which)
{
    pair x;

    for (int k = 0; k < 2; k++)
        x[k] = (2 * rad_rand(view->key, (uint32_t)(2 * (i + k) + which)) - 1) *
               view->jitter;
    return x;
}

/* Make the samples of parts i and i + 1. */
static void
two_samples(const struct rad_source *src, const struct rad_light_view *view,
            const struct parts *l, int i, struct rad_light_sample smp[2])
{
    const double *u = src->axis[0], *v = src->axis[1];
    pair c[3] = { take(l->c[0] + i), take(l->c[1] + i), take(l->c[2] + i) };
    pair s = take(l->s + i), t = take(l->t + i);
    pair k = dot(c, src->normal) * (s * t) * -src->root.area;

    if (!(view->jitter > 0)) {
        expand(smp, &src->root, c, s, t, k);
        return;
    }
    s *= jittered(view, i, 0);
    t *= jittered(view, i, 1);
    for (int a = 0; a < 3; a++)
        c[a] += s * u[a] + t * v[a];
    shoot(smp, c, k);
}

/* --- parts that are too near --- */

/* Set dir and omega of a part's sample to the flux of its outline, unless that
 * is 0; c is its middle, s and t are its axes over the whole's. */
static void
outlined(struct rad_light_sample *smp, const struct rad_source *src,
         const double c[3], double s, double t)
{
    static const int side[4][2] = {
        { 1, 1 }, { -1, 1 }, { -1, -1 }, { 1, -1 }
    };
    double F[3] = { 0, 0, 0 }, q[4][3], dir[3], omega;

    for (int i = 0; i < 4; i++) {
        rad_madd(q[i], c, side[i][0] * s, src->axis[0]);
        rad_madd(q[i], q[i], side[i][1] * t, src->axis[1]);
    }
    for (int i = 0; i < 4; i++)
        rad_contour_edge(F, q[i], q[(i + 1) % 4]);
    omega = rad_contour_whole(F, c, dir);
    if (!(omega > 0))
        return;
    smp->omega = omega;
    rad_copy(smp->dir, dir);
}

/* Give part i the flux of its outline if it is too near for the expansion. */
static void
outline(const struct rad_source *src, const struct parts *l, int i,
        struct rad_light_sample *smp)
{
    const struct rad_moments *m = &src->root;
    double c[3] = { l->c[0][i], l->c[1][i], l->c[2][i] };
    double s = l->s[i], t = l->t[i];

    if ((l->last[i] || l->coarse) &&
        s * s * rad_dot(m->a, m->a) + t * t * rad_dot(m->b, m->b) >=
            (l->last[i] ? FAR_VARIANCE : COARSE_VARIANCE) * rad_dot(c, c))
        outlined(smp, src, c, s, t);
}

int
rad_quad_samples(const struct rad_source *src,
                 const struct rad_light_view *view,
                 struct rad_light_sample s[RAD_LIGHT_PATCHES])
{
    struct rad_light_sample two[2];
    struct parts l;
    int i;

    cut(src, view, &l);
    for (i = 0; i + 1 < l.n; i += 2)
        two_samples(src, view, &l, i, &s[i]);
    if (i < l.n) { /* an odd part at the end is paired with itself */
        for (int k = 0; k < 3; k++)
            l.c[k][i + 1] = l.c[k][i];
        l.s[i + 1] = l.s[i];
        l.t[i + 1] = l.t[i];
        two_samples(src, view, &l, i, two);
        s[i] = two[0];
    }
    if (view->sizerat > 0 && !(view->jitter > 0))
        for (i = 0; i < l.n; i++)
            outline(src, &l, i, &s[i]);
    return l.n;
}
