/* calcprism.c - light through a pane of prisms: the function fprism_val()
 *
 * The pane is flat on one side and ribbed on the other.  In the section across
 * the ribs, x is the normal away from the flat side and y runs along it; each
 * rib is a triangle on the flat side, of height d, whose apex divides the base
 * into a and b.  A ray is followed from surface to surface.  At each its energy
 * is divided by Fresnel's formulas for two states of polarization, and by the
 * part of a rib's width from which each next surface is met.  Rays that leave
 * in nearly the same direction are merged.
 * Source: the function's arguments as Radiance's fprism.cal describes them, and
 * their effect there (R. Compagnon, EPFL 1992). */
#include "config.h"

#include "scene/calc/calcimpl.h"

#include <math.h>

#include "arith/elementary.h"

/* Limits on the surfaces met, in all and one after the other; further rays are
 * lost. */
#define MAX_MET  4096
#define MAX_DEEP 100

/* Surfaces: the flat side, the ribs' sides over a and b, and the plane of the
 * ridges. */
enum face { FLAT, SIDE_A, SIDE_B, RIDGES };

struct state {
    double par, per; /* amplitudes in and across the plane of incidence */
};

struct beam {
    double v[3]; /* unit */
    struct state pol[2];
    double energy;
    bool inside; /* the glass */
    enum face from, to;
};

struct pane {
    double a, b, d;
    double axis[2][2]; /* cosine and sine of the turn into a side's axes */
    double index2;     /* square of the refractive index */
    double least;      /* rays of less energy are dropped */
    int mirror;        /* face that is metallic, or -1 */
    double metal;      /* its reflectance */
    double together;   /* rays closer than this are merged [rad] */
    double to_source;
};

struct prism {
    struct pane pane;
    struct prism_rays *out;
    int nmet;
};

/* --- one surface, with normal x ------------------------------------------- */

static double
root(double x)
{
    return x > 0 ? sqrt(x) : 0;
}

struct incidence {
    double cosine;
    double ratio;  /* square of the refractive index behind over that before */
    double behind; /* ratio of the indices times the cosine behind */
    bool passes;
};

static void
meet(const struct pane *p, const struct beam *r, struct incidence *i)
{
    double sine2 = r->v[1] * r->v[1] + r->v[2] * r->v[2];

    i->cosine = fabs(r->v[0]);
    i->ratio = r->inside ? 1 / p->index2 : p->index2;
    i->behind = root(i->ratio - sine2);
    i->passes = !(sine2 > i->ratio) && (int)r->to != p->mirror;
}

/* Multiply the amplitudes; returns the mean factor of intensity. */
static double
polarize(struct beam *r, double par, double per)
{
    double gain = 0;

    for (int k = 0; k < 2; k++) {
        struct state *s = &r->pol[k];
        double before = s->par * s->par + s->per * s->per;

        s->par *= par;
        s->per *= per;
        if (before > 0)
            gain += (s->par * s->par + s->per * s->per) / before / 2;
    }
    return gain;
}

/* Divide a beam into the reflected and the refracted one. */
static void
divide(const struct pane *p, const struct beam *r, struct beam *back,
       struct beam *on)
{
    struct incidence i;
    double index, c;

    *back = *on = *r;
    meet(p, r, &i);
    back->v[0] = -r->v[0];
    if (!i.passes) {
        back->energy *= (int)r->to == p->mirror ? p->metal : 1;
        on->energy = 0;
        return;
    }
    c = i.ratio * i.cosine;
    back->energy *= polarize(back, (c - i.behind) / (c + i.behind),
                             (i.cosine - i.behind) / (i.cosine + i.behind));
    index = sqrt(i.ratio);
    on->v[0] = copysign(
        root(1 - (r->v[1] * r->v[1] + r->v[2] * r->v[2]) / i.ratio), r->v[0]);
    on->v[1] /= index;
    on->v[2] /= index;
    on->energy *= i.behind / i.cosine *
                  polarize(on, 2 * index * i.cosine / (i.behind + c),
                           2 * i.cosine / (i.cosine + i.behind));
    on->inside = !r->inside;
}

/* --- from one surface's axes to another's --------------------------------- */

/* Turn a beam about z by an angle with cosine c and sine s.  The plane of
 * incidence, through x and the beam, is turned about the beam by an angle with
 * cosine (y y' + z^2 c) / (r r') and sine z s / (r r'), with r^2 = y^2 +
 * z^2. */
static struct beam
turned(const struct beam *b, double c, double s)
{
    struct beam out = *b;
    double x = b->v[0], y = b->v[1], z = b->v[2], r2, cosine, sine;

    out.v[0] = x * c - y * s;
    out.v[1] = x * s + y * c;
    r2 = sqrt((y * y + z * z) * (out.v[1] * out.v[1] + z * z));
    if (r2 == 0)
        return out;
    cosine = (y * out.v[1] + z * z * c) / r2;
    sine = z * s / r2;
    for (int k = 0; k < 2; k++) {
        const struct state *p = &b->pol[k];

        out.pol[k].par = p->par * cosine + p->per * sine;
        out.pol[k].per = p->per * cosine - p->par * sine;
    }
    return out;
}

/* --- which surface is next ------------------------------------------------ */

/* For a beam from FLAT or RIDGES the part that meets SIDE_A, not SIDE_B; for a
 * beam from one of these sides the part that does not meet the other side. */
static double
share(const struct pane *p, const struct beam *r, enum face from)
{
    double slope, a = p->a, b = p->b, base = a + b;

    if (r->v[0] == 0)
        return 0;
    slope = r->v[1] / r->v[0] * p->d;
    switch (from) {
    case SIDE_A:
        return slope > b ? base / (a + slope) : slope >= -a ? 1 : 0;
    case SIDE_B:
        return slope > b ? 0 : slope >= -a ? 1 : base / (b - slope);
    default:
        return slope > b ? 1 : slope >= -a ? (a + slope) / base : 0;
    }
}

static void follow(struct prism *m, const struct beam *r, int depth);

static void
go(struct prism *m, const struct beam *r, double part, enum face to, int depth)
{
    struct beam next = *r;

    next.energy *= part;
    next.to = to;
    if (next.energy > m->pane.least && depth < MAX_DEEP)
        follow(m, &next, depth);
}

/* Follow a beam that leaves a side of the ribs, given in that side's axes,
 * inside or outside the glass. */
static void
leave_side(struct prism *m, const struct beam *there, enum face side, int depth)
{
    const double *axis = m->pane.axis[side == SIDE_B];
    struct beam turned_back, *r = &turned_back;
    double past;
    enum face other = side == SIDE_A ? SIDE_B : SIDE_A;

    if (!(there->energy > m->pane.least))
        return;
    turned_back = turned(there, axis[0], -axis[1]);
    past = share(&m->pane, r, side);
    r->from = side;
    if (r->inside)
        go(m, r, past, FLAT, depth);
    go(m, r, 1 - past, other, depth);
    if (!r->inside)
        go(m, r, past, RIDGES, depth);
}

static void
leave_level(struct prism *m, const struct beam *r, int depth)
{
    double part = share(&m->pane, r, FLAT);

    go(m, r, part, SIDE_A, depth);
    go(m, r, 1 - part, SIDE_B, depth);
}

/* The angle between two directions, at most pi. */
static double
apart(double a, double b)
{
    double d = fabs(a - b);

    return d < M_PI ? d : 2 * M_PI - d;
}

static void
come_out(struct prism *m, const struct beam *r)
{
    double angle;

    if (!(r->energy > m->pane.least))
        return;
    angle = rad_atan2(r->v[1], r->v[0]);
    for (int i = 0; i < m->out->n; i++) {
        struct prism_ray *o = &m->out->ray[i];

        if (apart(angle, o->angle) <= m->pane.together) {
            o->energy += r->energy;
            return;
        }
    }
    if (m->out->n < MAX_PRISM_RAYS)
        m->out->ray[m->out->n++] = (struct prism_ray){
            { r->v[0], r->v[1], r->v[2] }, r->energy, angle
        };
}

/* Follow a beam that meets the flat side: from outside only the first ray. */
static void
follow_flat(struct prism *m, const struct beam *r, int depth)
{
    struct beam back, on;

    divide(&m->pane, r, &back, &on);
    if (r->from == FLAT) {
        come_out(m, &back);
        leave_level(m, &on, depth);
    } else {
        leave_level(m, &back, depth);
        come_out(m, &on);
    }
}

static void
follow_side(struct prism *m, const struct beam *r, int depth)
{
    const double *axis = m->pane.axis[r->to == SIDE_B];
    struct beam there = turned(r, axis[0], axis[1]), back, on;

    divide(&m->pane, &there, &back, &on);
    leave_side(m, &back, r->to, depth);
    leave_side(m, &on, r->to, depth);
}

static void
follow(struct prism *m, const struct beam *r, int depth)
{
    if (++m->nmet > MAX_MET)
        return;
    switch (r->to) {
    case FLAT:
        follow_flat(m, r, depth + 1);
        break;
    case SIDE_A:
    case SIDE_B:
        follow_side(m, r, depth + 1);
        break;
    default:
        if (r->from != RIDGES)
            come_out(m, r);
        else
            leave_level(m, r, depth + 1);
    }
}

/* --- the function --------------------------------------------------------- */

/* False: the arguments make no sense. */
static bool
read_pane(struct pane *p, const double *arg)
{
    double which = floor(arg[6] + .5);

    *p = (struct pane){ .a = arg[0],
                        .b = arg[1],
                        .d = arg[3],
                        .index2 = arg[4] * arg[4],
                        .least = arg[5],
                        .mirror = -1,
                        .metal = arg[7],
                        .together = arg[8],
                        .to_source = arg[9] };
    if (which == 1 || which == 2)
        p->mirror = (int)which;
    else if (which != 4)
        return false;
    return p->a >= 0 && p->b >= 0 && arg[2] >= 0 && p->d >= 0 && arg[4] >= 1 &&
           p->least >= 0 && p->least < 1 && p->together > 0 &&
           p->to_source >= 0 &&
           (p->mirror < 0 || (p->metal >= 0 && p->metal <= 1));
}

static void
enter(struct prism *m, const double dir[3])
{
    struct beam r = { .pol = { { 1, 0 }, { 0, 1 } }, .energy = 1 };
    double len;

    if (dir[0] == 0)
        return;
    len = sqrt(dir[0] * dir[0] + dir[1] * dir[1] + dir[2] * dir[2]);
    for (int k = 0; k < 3; k++)
        r.v[k] = dir[k] / len;
    r.from = r.to = dir[0] > 0 ? FLAT : RIDGES;
    follow(m, &r, 0);
}

/* Set rays that miss the source to 0, then sort by energy.  Sorting by exchange
 * orders equal rays as Radiance does. */
static void
order(struct prism_rays *out, const double *source, double angle)
{
    for (int j = 0; source && j < out->n; j++)
        if (!(apart(out->ray[j].angle, rad_atan2(source[1], source[0])) <=
              angle))
            out->ray[j].energy = 0;
    for (int j = 0; j < out->n; j++)
        for (int i = j + 1; i < out->n; i++)
            if (out->ray[j].energy < out->ray[i].energy) {
                struct prism_ray t = out->ray[j];

                out->ray[j] = out->ray[i];
                out->ray[i] = t;
            }
}

static void
set_axis(double axis[2], double base, double rise)
{
    double len = rad_hypot(base, rise);

    axis[0] = base / len;
    axis[1] = rise / len;
}

/* Find all rays that leave the pane. */
static void
find_rays(const struct rad_calc_input *in, const double *source,
          struct prism_rays *out)
{
    struct prism m = { .out = out };

    out->n = 0;
    out->sound = read_pane(&m.pane, in->args);
    if (!out->sound)
        return;
    set_axis(m.pane.axis[0], m.pane.a, -m.pane.d);
    set_axis(m.pane.axis[1], m.pane.b, m.pane.d);
    enter(&m, in->channel);
    order(out, source, m.pane.to_source);
}

/* Ray number `rank` of those whose v.x has the sign of `side` (0: any); NULL:
 * there is none. */
static const struct prism_ray *
pick(const struct prism_rays *out, double side, int rank)
{
    for (int i = 0, n = 0; i < out->n; i++) {
        n += out->ray[i].v[0] * side >= 0;
        if (n == rank)
            return &out->ray[i];
    }
    return NULL;
}

/* The source that a ray is searching for; NULL: none. */
static const double *
source_of(const struct rad_calc_input *in)
{
    const double *s = in->channel + RAD_CALC_AIM;

    return s[0] == 0 && s[1] == 0 && s[2] == 0 ? NULL : s;
}

double
rad_calc_prism(const double *v, const struct rad_calc_input *in, uint64_t clock,
               struct prism_rays *out, enum rad_calc_fault *fault)
{
    const struct prism_ray *ray;
    double ahead;
    int what, rank;

    if (!in->channel || !in->args || in->nargs < 10) {
        *fault = in->channel ? RAD_CALC_NO_ARG : RAD_CALC_NO_CHANNEL;
        return 0;
    }
    if (out->clock != clock)
        find_rays(in, source_of(in), out);
    out->clock = clock;
    if (!out->sound || !(fabs(v[0]) < 100) || !(fabs(v[1]) < 100) ||
        !(fabs(v[2]) < 1e6)) {
        *fault = RAD_CALC_MATH;
        return 0;
    }
    /* Radiance rounds so: a side of -1 becomes 0, which means either */
    what = (int)(v[0] + .5);
    rank = (int)(v[2] + .5);
    ahead = in->channel[0] < 0 ? -1 : 1;
    if (rank == 2 && source_of(in)) /* the second ray made this image */
        rank = 1;
    ray = pick(out, (int)(v[1] + .5) * ahead, rank);
    if (what < 0 || what > 3)
        *fault = RAD_CALC_MATH;
    else if (ray)
        return what == 3 ? ray->energy : ray->v[what];
    return what == 0 && in->channel[0] != 0 ? 1 : 0;
}
