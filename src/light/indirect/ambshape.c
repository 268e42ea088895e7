/* ambshape.c - see ambshape.h */
#include "config.h"

#include "light/indirect/ambshape.h"
#include "light/hemisphere/gradient.h"
#include "arith/elementary.h"
#include "base/vec.h"

/* Records that pixels show stand as far apart as their zones are wide, but each
 * is asked for so much farther out: of the mean of more of them, less is noise.
 * At 64 to 128 rays a record that lessens a picture's error by 5 to 15 %; at 2
 * what extrapolation gets wrong begins to count, and looking up takes longer.
 * With a large -aa that is most of the error already.  Where deeper rays end
 * all is averaged anyway. */
#define OVERLAP          1.5
#define FARTHEST_OVERLAP .75

/* The length that stands for the unit in radius_of(), in sides of the cube:
 * what bends within a tenth of the scene gets zones as small as -ar 32 lets
 * them be. At much more than that most zones are as large as they may be, and
 * their error, then most of the picture's, hardly falls with more rays; at less
 * there are more records, and little is gained. */
#define ERROR_UNIT .003

/* Where light bends so much that at the edge of the smallest zone that -ar
 * allows E would be off by more than a quarter, zones are smaller, down to half
 * of that: in a scene that is much larger than the room in view, that is most
 * of the error, and far beyond the samples' noise. */
#define MOST_BENT .5 /* E'' r^2 / E; the error is half of it */
#define FINEST    .5

/* Each bounce leaves about half of the light, and what deep records get wrong
 * is averaged over the hemisphere of the one above.  So a bounce halves a
 * record's samples and doubles the area of its zone beyond what they are for
 * its weight, but for zones that are as small as -ar lets them be. */
#define LESS_BY_BOUNCE .5

/* As in rpict, no zone is larger than a fifth of the scene, or than 64 times
 * the smallest; without -ar, none is too small for rounding. */
void
rad_ambscale_set(struct rad_ambscale *s, double side,
                 const struct rad_params *par)
{
    double aa = par->ambacc;

    s->side = side > 0 ? side : 1; /* nothing to stand on: any cube will do */
    s->most = .2 * s->side;
    s->least = par->ambres > 0 ? s->side / par->ambres : 1e-7 * s->side;
    if (par->ambres > 0)
        s->most = rad_least(s->most, 64 * s->least);
    if (s->most <= s->least)
        s->most = 64 * s->least;
    s->ambacc = s->deep = aa;
    s->shown = rad_most(aa, rad_least(OVERLAP * aa, FARTHEST_OVERLAP));
}

double
rad_ambrec_worth(const struct rad_ambrec *rec)
{
    return rec->weight * rad_pow(LESS_BY_BOUNCE, rec->level);
}

double
rad_ambscale_linear(const struct rad_ambscale *scale, const float radius[2])
{
    return scale->ambacc * sqrt((double)radius[0] * (double)radius[1]);
}

double
rad_ambscale_bend(const struct rad_ambscale *scale, const float radius[2])
{
    double r2 = (double)radius[0] * (double)radius[1];

    return scale->side * ERROR_UNIT / (r2 * sqrt(r2));
}

/* Radius for an eigenvalue of the Hessian over E.  In its zone a record is
 * wrong by about value * r^2, and there are 1 / r^2 records to the area
 * (Schwarzhaupt et al. 2012).  For so many records the squared error, summed
 * over the area, is least if value^2 r^6 is the same for all; their paper,
 * which sums the error itself, has value r^4.  The scene's size stands for the
 * unit, so that units do not matter. */
static double
radius_of(const struct rad_ambscale *scale, double value)
{
    value = fabs(value);
    return value > 0 ? rad_cbrt(scale->side * ERROR_UNIT / value) : INFINITY;
}

/* The least radius, where the Hessian over E has no larger eigenvalue. */
static double
least_radius(const struct rad_ambscale *scale, double value)
{
    double aa = scale->ambacc;

    value = fabs(value) * aa * aa;
    if (!(value * scale->least * scale->least > MOST_BENT))
        return scale->least;
    return rad_most(sqrt(MOST_BENT / value), FINEST * scale->least);
}

/* Limit the radii: E must not double over them, and they are `least` at least;
 * lighter and deeper rays may do with larger ones.  Where -ar is what stops
 * them E bends more than it should already: there a bounce adds nothing to what
 * the weight allows.  Else bright places would be spread over their dark
 * surroundings where a room is small in its scene. */
static void
limit_radii(const struct rad_ambscale *scale, const double gpos[2],
            double least, const struct rad_ambrec *rec, double r[2])
{
    double larger = 1 / sqrt(rad_ambrec_worth(rec));

    least /= sqrt((double)rec->weight);
    for (int k = 0; k < 2; k++)
        if (r[k] * fabs(gpos[k]) > 1)
            r[k] = 1 / fabs(gpos[k]);
    r[0] = rad_least(r[0], r[1]);
    for (int k = 0; k < 2; k++)
        r[k] = rad_least(rad_most(larger * r[k], least), scale->most);
    r[1] = rad_least(r[1], 2 * r[0]);
}

/* Does a ray of the cell meet a surface above the ellipse with half-axes r
 * about the record? */
static bool
is_inside(const struct rad_hemicell *c, double u, double v, const double r[2])
{
    double a = u / r[0], b = v / r[1];

    /* the distance is that of the nearest surface, c->p a direction; seen
     * from above it is shorter by the same part as (u, v) is */
    return rad_dot(c->p, c->p) * c->wall * c->wall > a * a + b * b;
}

/* Directions, 32 of them about the normal from the record's axis u on, which is
 * `axis` in the sampling's frame, in which something at the horizon is nearer
 * than the zone's edge, or may be where the cell's ray did not go: a wall that
 * is met aside of its nearest point seems farther.  r are the half-axes up to
 * which the record is asked for, `low` is how near all is under a low ceiling,
 * where the test would find that.  A pane counts: light may differ behind it.
 */
static uint32_t
find_corral(const struct rad_hemi *h, const double axis[2], const double r[2],
            double low)
{
    double overhead = INFINITY; /* 1 / distance of what is farthest there */
    /* what a cell spans; between two rays that meet a wall, and beyond the
     * last, are up to two spans that none went into */
    double span = M_PI / 2 / h->n, half = 2 * span;
    int n = h->n, quarter = n / 4;
    double wide[2] = { r[0] / rad_cos(span), r[1] / rad_cos(span) };
    uint32_t bins = 0;

    for (int i = quarter; i < n - quarter; i++)
        for (int j = quarter; j < n - quarter; j++)
            overhead = rad_least(overhead, h->cell[i * n + j].wall);
    if (overhead * low >= 1)
        return 0;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j += i == 0 || i == n - 1 ? 1 : n - 1) {
            const struct rad_hemicell *c = &h->cell[i * n + j];
            double u = c->p[0] * axis[0] + c->p[1] * axis[1];
            double v = c->p[1] * axis[0] - c->p[0] * axis[1];

            if (!is_inside(c, u, v, wide))
                continue;
            double at = rad_atan2(v, u);
            int from = (int)floor((at - half) * (16 / M_PI));
            int to = (int)floor((at + half) * (16 / M_PI));

            for (int bin = from; bin <= to; bin++)
                bins |= UINT32_C(1) << (bin & 31);
        }
    return bins;
}

/* Harmonic mean distance of what is seen (Ward et al. 1988). */
static double
mean_distance(const struct rad_hemi *h)
{
    double near = 0;

    for (int k = 0; k < h->n * h->n; k++)
        near += h->cell[k].near;
    return h->n * h->n / near;
}

/* Where all is black there is nothing to differ: distance alone decides. */
void
rad_ambrec_shape(const struct rad_ambscale *scale, const struct rad_hemi *h,
                 struct rad_ambrec *rec)
{
    double aa = scale->ambacc, value[2], vec[2] = { 1, 0 };
    double r[2], gpos[2] = { 0, 0 }, gdir[2] = { 0, 0 }, least = scale->least;
    struct rad_gradients g;

    if (rad_rgb_lum(h->E) > 0) {
        rad_hemi_gradients(h, &g);
        rad_eigen2(g.hess, value, vec);
        gpos[0] = g.move[0] * vec[0] + g.move[1] * vec[1];
        gpos[1] = g.move[1] * vec[0] - g.move[0] * vec[1];
        gdir[0] = g.turn[0] * vec[0] + g.turn[1] * vec[1];
        gdir[1] = g.turn[1] * vec[0] - g.turn[0] * vec[1];
        for (int k = 0; k < 2; k++)
            r[k] = radius_of(scale, value[k]);
        /* what a pixel shows; deeper errors are averaged */
        if (rec->level == 0)
            least = least_radius(scale, value[0]);
    } else {
        r[0] = r[1] = mean_distance(h);
    }
    limit_radii(scale, gpos, least, rec, r);
    /* over the zone E may double, not more */
    double swing = rad_hypot(gpos[0] * r[0], gpos[1] * r[1]);
    double cap = swing > 1 ? 1 / swing : 1;

    for (int k = 0; k < 3; k++)
        rec->u[k] = (float)(vec[0] * h->u[k] + vec[1] * h->v[k]);
    for (int k = 0; k < 2; k++) {
        rec->radius[k] = (float)r[k];
        rec->gpos[k] = (float)(gpos[k] * cap);
        rec->gdir[k] = (float)gdir[k];
    }
    double reach = rad_ambscale_reach(scale, rec->level);
    double zone[2] = { r[0] * reach, r[1] * reach };

    rec->corral = find_corral(h, vec, zone, r[0] * aa);
}
