/* ambshape.c - see ambshape.h */
#include "config.h"

#include "light/indirect/ambshape.h"
#include "light/hemisphere/gradient.h"
#include "arith/elementary.h"
#include "base/vec.h"

/* Records of level 0, which pixels show, are made where no other is within its
 * zone, and serve up to so many times farther out.  A live cache averages all
 * of these: the mean of more records has less noise.  With 64 to 128 rays a
 * record this lowers a picture's error by 5 to 15 %; at a factor of 2 the error
 * of extrapolation begins to count, and look-ups take longer.  With a large -aa
 * that error is most of the error already, so -aa times the factor is limited
 * to FARTHEST_OVERLAP.  A frozen cache smooths its records, and needs those
 * beyond -aa for the gaps that passes have left alone.  Deeper records are
 * averaged by hemispheres anyway. */
#define OVERLAP          1.5
#define FARTHEST_OVERLAP .75

/* The length that stands for the unit in radius_of(), in sides of what is shown
 * (struct rad_ambscale): where E bends within a tenth of that, zones are as
 * small as -ar 32 allows.  With a much larger length most zones are as large as
 * they may be, and their error, then most of the picture's, hardly falls with
 * more rays; with a smaller length there are more records for little gain. */
#define ERROR_UNIT .003

/* Where E would be off by more than a quarter at the edge of the smallest zone
 * that -ar allows, zones are smaller, down to FINEST of that: in a scene much
 * larger than the room in view such places make most of the error, far more
 * than the samples' noise. */
#define MOST_BENT .5 /* E'' r^2 / E; the error is half of it */
#define FINEST    .5

/* The largest radius of a zone far from what is shown, over the distance: as
 * seen from there far zones look as large as near ones, and their errors
 * average as those do.  With zones as small as near by, hills some kilometres
 * from a room take a hundred times the rays of the room. */
#define FAR_WIDTH .2

/* Each bounce leaves about half of the light, and the errors of deep records
 * are averaged over the hemisphere above.  So a bounce halves a record's
 * samples and doubles the area of its zone, beyond the effect of its weight;
 * but not of zones that are as small as -ar allows. */
#define LESS_BY_BOUNCE .5

/* As in rpict, no radius is larger than a fifth of the scene, or than 64 times
 * the smallest radius; without -ar the smallest radius is well above rounding.
 * But where pictures show a small part of the scene (--surroundings), a fifth
 * and the unit are of that part: by the ground of 10 km that a room stands on,
 * zones would miss what lies beside them however fine -ar is.  Far from that
 * part (--shown) they may be wider again: see FAR_WIDTH. */
void
rad_ambscale_set(struct rad_ambscale *s, double side,
                 const struct rad_params *par)
{
    double aa = par->ambacc;

    s->side = side > 0 ? side : 1; /* no surfaces: any cube will do */
    s->shown_side = s->side / (par->surroundings > 1 ? par->surroundings : 1);
    s->most = .2 * s->side;
    s->least = par->ambres > 0 ? s->side / par->ambres : 1e-7 * s->side;
    if (par->ambres > 0)
        s->most = rad_least(s->most, 64 * s->least);
    if (s->most <= s->least)
        s->most = 64 * s->least;
    if (par->surroundings > 1)
        s->most = rad_least(s->most, rad_most(.2 * s->shown_side, s->least));
    s->widest =
        par->surroundings > 1 ? rad_most(.2 * s->side, s->most) : s->most;
    rad_copy(s->at, par->shown);
    s->within = par->shown[3] > 0 ? par->shown[3] : INFINITY;
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

    return scale->shown_side * ERROR_UNIT / (r2 * sqrt(r2));
}

/* The radius for an eigenvalue of the Hessian over E.  In its zone a record is
 * off by about value * r^2, and an area has 1 / r^2 records (Schwarzhaupt et
 * al. 2012).  For a given number of records, the squared error summed over the
 * area is least if value^2 r^6 is the same for all; their paper, which sums the
 * error itself, has value r^4.  Lengths are relative to the size of what is
 * shown, so units do not matter. */
static double
radius_of(const struct rad_ambscale *scale, double value)
{
    return value > 0 ? rad_cbrt(scale->shown_side * ERROR_UNIT / value)
                     : INFINITY;
}

/* The least radius, where `value` is the larger eigenvalue of the Hessian over
 * E: that of -ar, or smaller (MOST_BENT). */
static double
least_radius(const struct rad_ambscale *scale, double value)
{
    double aa = scale->ambacc;

    value = fabs(value) * aa * aa;
    if (!(value * scale->least * scale->least > MOST_BENT))
        return scale->least;
    return rad_most(sqrt(MOST_BENT / value), FINEST * scale->least);
}

/* The largest radius of a record at p. */
static double
most_radius(const struct rad_ambscale *scale, const double p[3])
{
    double far;

    if (!(scale->widest > scale->most))
        return scale->most;
    far = sqrt(rad_dist2(p, scale->at)) - scale->within;
    return rad_least(rad_most(scale->most, FAR_WIDTH * far), scale->widest);
}

void
rad_ambrec_narrow(const struct rad_ambscale *scale, struct rad_ambrec *rec)
{
    float most = (float)most_radius(scale, rec->p);

    if (!(scale->widest > scale->most))
        return;
    for (int k = 0; k < 2; k++)
        rec->radius[k] = rec->radius[k] < most ? rec->radius[k] : most;
}

/* Limit the radii r: E must not double over them, and they are not below
 * `least`.  Records for lighter and deeper rays get larger radii.  Where
 * `least` limits a radius E bends too much already: there the weight counts,
 * but not the bounces.  Else bright places would be spread over their dark
 * surroundings where a room is small in its scene. */
static void
limit_radii(const struct rad_ambscale *scale, const double gpos[2],
            double least, const struct rad_ambrec *rec, double r[2])
{
    double larger = 1 / sqrt(rad_ambrec_worth(rec));
    double most = most_radius(scale, rec->p);

    least /= sqrt((double)rec->weight);
    for (int k = 0; k < 2; k++)
        if (r[k] * fabs(gpos[k]) > 1)
            r[k] = 1 / fabs(gpos[k]);
    r[0] = rad_least(r[0], r[1]);
    for (int k = 0; k < 2; k++)
        r[k] = rad_least(rad_most(larger * r[k], least), most);
    r[1] = rad_least(r[1], 2 * r[0]);
}

/* Did a ray of the cell, in direction (u, v) of the record's axes, meet a
 * surface above the ellipse with half-axes r about the record? */
static bool
is_inside(const struct rad_hemicell *c, double u, double v, const double r[2])
{
    double a = u / r[0], b = v / r[1];

    /* 1 / c->wall is the distance of the surface, and (u, v) the projection of
     * c->p: the surface's distance, projected, is to it as (u, v) to |c->p| */
    return rad_dot(c->p, c->p) * c->wall * c->wall > a * a + b * b;
}

/* The corral of a record, as bits of 32 directions about the normal from its
 * axis u on: those in which a surface at the horizon is nearer than the zone's
 * edge, or may be nearer between the cells' rays, since a wall that is met
 * beside its nearest point seems farther.  A pane counts: the light may differ
 * behind it.
 *   axis  the record's axis u, in the hemisphere's frame
 *   r     half-axes of the zone
 *   low   if all that is overhead is nearer than this, under a low ceiling,
 *         there is no corral: the test's rays would meet the ceiling */
static uint32_t
find_corral(const struct rad_hemi *h, const double axis[2], const double r[2],
            double low)
{
    double overhead = INFINITY; /* 1 / distance of the farthest hit overhead */
    /* the angle that a cell spans at the horizon; between two rays that meet a
     * wall, and beyond the last, up to two spans have no ray */
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

/* The harmonic mean distance of all hits (Ward et al. 1988). */
static double
mean_distance(const struct rad_hemi *h)
{
    double near = 0;

    for (int k = 0; k < h->n * h->n; k++)
        near += h->cell[k].near;
    return h->n * h->n / near;
}

/* The radii by how E bends along the axes.  Light that is a part s of E and
 * comes from a distance d bends E by about s / d^2; the same is assumed of the
 * light that the mesh overlooks, with the mean distance for d.  Without this a
 * sun patch which a few rays meet before a dark wall would be taken for light
 * that is the same everywhere, and one record would serve a whole room. */
static void
bent_radii(const struct rad_ambscale *scale, const struct rad_hemi *h,
           const struct rad_gradients *g, const double value[2], double r[2])
{
    double d = g->overlooked > 0 ? mean_distance(h) : INFINITY;
    double least = g->overlooked / (d * d);

    for (int k = 0; k < 2; k++)
        r[k] = radius_of(scale, rad_most(fabs(value[k]), least));
}

/* Where all is black there are no gradients: the mean distance is the radius.
 */
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
        bent_radii(scale, h, &g, value, r);
        /* only for pixels: hemispheres average the errors of deeper records */
        if (rec->level == 0)
            least = least_radius(scale, value[0]);
    } else {
        r[0] = r[1] = mean_distance(h);
    }
    limit_radii(scale, gpos, least, rec, r);
    /* gradients are cut so that E at most doubles over the zone */
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
