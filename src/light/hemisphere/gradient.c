/* gradient.c - see gradient.h
 *
 * An edge from a to b = a + e adds n.(a x b) I / 2 to the irradiance, where
 *     I = integral over the edge of dt / |r|^2,  r = a + t e, 0 <= t <= 1,
 * and the derivatives with respect to the point x, for which dr = -dx, are
 *     grad = [ (n x e) I + n.(a x b) G ] / 2
 *     hess = [ (n x e) G^T + G (n x e)^T + n.(a x b) K ] / 2
 *     G = 2 integral r / |r|^4,  K = integral of 8 r r^T / |r|^6 - 2 / |r|^4.
 * With h the foot of the perpendicular on the edge's line and s the length
 * along it from there, r = h + s e/|e|, every integral is one of
 *     A_k = integral ds / q^k,  B_k = ... s / q^k,  C_3 = ... s^2 / q^3,
 * q = h^2 + s^2, which have closed forms.  Only derivatives in the plane of the
 * point are wanted: those along x and y, since the normal is along z.
 *
 * Within a sphere the part of E that comes from a part of the sphere is its
 * radiosity times its area over the sphere's, wherever the point is: as the
 * point moves along the sphere and the normal turns, the changes by either
 * cancel.  So these parts are left out of both: with them moving, by itself,
 * would seem to bend E much, and a lamp's globe would have several times the
 * records that it needs.  */
#include "config.h"

#include "light/hemisphere/gradient.h"
#include "arith/angle.h"
#include "arith/elementary.h"
#include "base/vec.h"

/* An edge whose line passes this close to the point, relative to its distance,
 * is seen end on and left out: it spans no angle to speak of, and h has lost
 * its digits to cancellation. */
#define END_ON 1e-6

/* The end of an edge. */
struct corner {
    const double *p;
    double q, rcp; /* |p|^2, 1 / q */
};

static inline struct corner
corner_at(const double p[3])
{
    double q = rad_dot(p, p);

    return (struct corner){ p, q, 1 / q };
}

/* As rad_edge_slope(), for ends whose squared lengths are known. */
static inline void
add_edge(const struct corner *a, const struct corner *b, double scale,
         struct rad_slope *sum)
{
    double e[3], axb[3];

    rad_sub(e, b->p, a->p);
    rad_cross(axb, a->p, b->p);

    double len2 = rad_dot(e, e), area2 = rad_dot(axb, axb);

    if (!(area2 > END_ON * END_ON * len2 * rad_least(a->q, b->q)))
        return;

    double len = sqrt(len2), area = sqrt(area2), per = 1 / len;
    double x = e[0] * per, y = e[1] * per; /* the edge's unit vector */
    double s0 = rad_dot(a->p, e) * per, s1 = s0 + len;
    double hx = a->p[0] - s0 * x, hy = a->p[1] - s0 * y;
    double rcp = len2 / area2; /* 1 / h^2 */
    double d = axb[2] * per;   /* the integrals are over s = t len */
    double A1 = rad_angle(area, rad_dot(a->p, b->p)) * area * rcp * per;
    double A2 = ((s1 * b->rcp - s0 * a->rcp) + A1) * rcp / 2;
    double B2 = (a->rcp - b->rcp) / 2;
    double A3 =
        ((s1 * b->rcp * b->rcp - s0 * a->rcp * a->rcp) + 3 * A2) * rcp / 4;
    double B3 = (a->rcp + b->rcp) * B2 / 2;
    double C3 = A2 - area2 * per * per * A3;
    double Gx = 2 * (A2 * hx + B2 * x), Gy = 2 * (A2 * hy + B2 * y);

    d *= scale;
    sum->grad[0] += (d * Gx - scale * A1 * y) / 2;
    sum->grad[1] += (d * Gy + scale * A1 * x) / 2;
    d *= 4;
    A2 /= 4;
    sum->hess[0] +=
        d * (A3 * hx * hx + 2 * B3 * hx * x + C3 * x * x - A2) - scale * y * Gx;
    sum->hess[1] += d * (A3 * hx * hy + B3 * (hx * y + hy * x) + C3 * x * y) +
                    scale / 2 * (x * Gx - y * Gy);
    sum->hess[2] +=
        d * (A3 * hy * hy + 2 * B3 * hy * y + C3 * y * y - A2) + scale * x * Gy;
}

void
rad_edge_slope(const double a[3], const double b[3], double scale,
               struct rad_slope *sum)
{
    struct corner from = corner_at(a), to = corner_at(b);

    add_edge(&from, &to, scale, sum);
}

/* Hits are on a sphere about the point, whose surface the point is on, if a
 * SPHERE_PART of all cells are on it, within SPHERE_WIDTH of its diameter. */
#define SPHERE_PART  .25
#define SPHERE_WIDTH 1e-4

/* A cell's luminance counts as at most so many times the mean. */
#define MOST_SHARE 4

/* Is p on the sphere of find_sphere(), or beyond? */
static inline bool
on_sphere(const double p[3], double curve)
{
    return curve > 0 && p[2] <= curve * rad_dot(p, p);
}

/* The sphere that the point is in, as 1 / diameter, made smaller by its width;
 * 0: it is in none.  All else in the sphere is nearer, so has more of z / r^2.
 */
static double
find_sphere(const struct rad_hemi *h)
{
    int n2 = h->n * h->n, count = 0;
    double curve = INFINITY;

    for (int k = 0; k < n2; k++) {
        const double *p = h->cell[k].p;

        curve = rad_least(curve, p[2] / rad_dot(p, p));
    }
    curve *= 1 + SPHERE_WIDTH;
    for (int k = 0; k < n2; k++)
        count += on_sphere(h->cell[k].p, curve);
    return count > SPHERE_PART * n2 ? curve : 0;
}

/* The mean luminance of the cells, each counted as *most at most, which is set
 * to about MOST_SHARE times that mean.
 * A rare bright sample would else make all other differences small, relative to
 * E: the record that drew it, which is too bright, would get a larger zone than
 * records that drew none, which are too dark, and the picture would be too
 * bright.  Where most cells are black and the others alike, the limit is small,
 * but so is the mean, and the ratio of the others to it stays right. */
static double
fair_mean(const struct rad_hemi *h, double *most)
{
    int n2 = h->n * h->n;
    double mean = rad_rgb_lum(h->E) / M_PI;

    for (int pass = 0; pass < 8; pass++) {
        double sum = 0;

        *most = MOST_SHARE * mean;
        for (int k = 0; k < n2; k++)
            sum += rad_least(rad_rgb_lum(h->cell[k].L), *most);
        mean = sum / n2;
    }
    return mean;
}

/* The mesh of a hemisphere, as it is summed. */
struct mesh {
    const struct rad_hemi *h;
    double most;  /* limit of luminances */
    double curve; /* find_sphere() */
};

/* Luminance of the farthest of three cells, limited to `most`. */
static double
behind(const struct rad_hemi *h, int a, int b, int c, double most)
{
    const struct rad_hemicell *far = &h->cell[a];

    if (h->cell[b].near < far->near)
        far = &h->cell[b];
    if (h->cell[c].near < far->near)
        far = &h->cell[c];
    return rad_least(rad_rgb_lum(far->L), most);
}

/* Luminance of the lower triangle between cell (i, j) and the cells to its
 * right and above. */
static double
lower(const struct rad_hemi *h, int i, int j, double most)
{
    int k = i * h->n + j;

    return behind(h, k, k + 1, k + h->n, most);
}

/* Luminance of the upper triangle of the same square of four cells. */
static double
upper(const struct rad_hemi *h, int i, int j, double most)
{
    int k = i * h->n + j;

    return behind(h, k + h->n + 1, k + h->n, k + 1, most);
}

/* An object at the horizon stands out if it is nearer by this factor than the
 * hit above it. */
#define STANDS_OUT 2

/* An edge of the mesh's outline: cells a and b, counter-clockwise, and c, the
 * third corner of their triangle. */
struct rim {
    int a, b, c;
    double in; /* luminance of the triangle */
};

/* Count an object that stands out at the horizon, like a house seen from afar.
 * If cells a and b met it and c met something much farther, their triangle has
 * the luminance of c's hit, and the object would be overlooked.  So it is taken
 * to fill the quadrangle between the edge from a to b and the horizon. */
static void
add_rim(const struct mesh *m, const struct rim *r, struct rad_slope *sum)
{
    const struct rad_hemicell *cell = m->h->cell;
    const struct rad_hemicell *a = &cell[r->a], *b = &cell[r->b];
    float near = a->near < b->near ? a->near : b->near;
    double d = r->in - (rad_least(rad_rgb_lum(a->L), m->most) +
                        rad_least(rad_rgb_lum(b->L), m->most)) /
                           2;

    if (!(near > STANDS_OUT * cell[r->c].near) || d == 0 ||
        on_sphere(cell[r->c].p, m->curve))
        return;

    const double below[2][3] = { { a->p[0], a->p[1], 0 },
                                 { b->p[0], b->p[1], 0 } };

    rad_edge_slope(a->p, b->p, d, sum);
    rad_edge_slope(b->p, below[1], d, sum);
    rad_edge_slope(below[1], below[0], d, sum);
    rad_edge_slope(below[0], a->p, d, sum);
}

static void
sum_rims(const struct mesh *m, struct rad_slope *sum)
{
    const struct rad_hemi *h = m->h;
    double most = m->most;
    int n = h->n, last = n - 2, top = (n - 1) * n;

    for (int k = 0; k < n - 1; k++) {
        const struct rim side[4] = {
            { k, k + 1, k + n, lower(h, 0, k, most) },
            { (k + 1) * n, k * n, k * n + 1, lower(h, k, 0, most) },
            { top + k + 1, top + k, top - n + k + 1, upper(h, last, k, most) },
            { k * n + n - 1, k * n + n + n - 1, k * n + n + last,
              upper(h, k, last, most) },
        };

        for (int i = 0; i < 4; i++)
            add_rim(m, &side[i], sum);
    }
}

/* Are two triangles that share an edge on the sphere that the point is in? */
static inline bool
is_still(const struct mesh *m, const double *a, const double *b,
         const double *c, const double *d)
{
    return on_sphere(a, m->curve) && on_sphere(b, m->curve) &&
           on_sphere(c, m->curve) && on_sphere(d, m->curve);
}

/* The light of the mesh and of its cells, which may differ. */
struct found {
    double mesh, cells;
};

/* Add the light of the square of cells from c on: that of its triangles, `two`
 * together, and the means of their corners. */
static void
add_square(const struct mesh *m, const struct rad_hemicell *c, double two,
           struct found *found)
{
    int n = m->h->n;
    double most = m->most;
    double four = (rad_least(rad_rgb_lum(c[0].L), most) +
                   2 * rad_least(rad_rgb_lum(c[1].L), most) +
                   2 * rad_least(rad_rgb_lum(c[n].L), most) +
                   rad_least(rad_rgb_lum(c[n + 1].L), most)) /
                  3;

    found->cells += four;
    found->mesh += is_still(m, c[0].p, c[1].p, c[n].p, c[n + 1].p) ? four : two;
}

/* Add each edge between two triangles, times the luminance of its left triangle
 * less that of its right one.  Edges of the mesh's outline add nothing, as if
 * the luminance were the same beyond; but see add_rim().  Sets *found. */
static void
sum_edges(const struct mesh *m, struct rad_slope *sum, struct found *found)
{
    const struct rad_hemi *h = m->h;
    int n = h->n;

    *found = (struct found){ 0, 0 };
    for (int i = 0; i < n - 1; i++) {
        const struct rad_hemicell *c = &h->cell[i * n];
        struct corner at = corner_at(c->p);
        double left = 0; /* the upper triangle of the square before */

        for (int j = 0; j < n - 1; j++, c++) {
            struct corner right = corner_at(c[1].p), above = corner_at(c[n].p);
            double low = lower(h, i, j, m->most), up = upper(h, i, j, m->most);
            double d = low - up;

            add_square(m, c, low + up, found);
            if (d != 0 && !is_still(m, right.p, above.p, c->p, c[n + 1].p))
                add_edge(&right, &above, d, sum);
            d = i > 0 ? low - upper(h, i - 1, j, m->most) : 0;
            if (d != 0 && !is_still(m, at.p, right.p, above.p, c[1 - n].p))
                add_edge(&at, &right, d, sum);
            d = j > 0 ? left - low : 0;
            if (d != 0 && !is_still(m, at.p, above.p, c[n - 1].p, right.p))
                add_edge(&at, &above, d, sum);
            at = right;
            left = up;
        }
    }
}

/* The part of the light that the mesh lacks.  Where cells and triangles differ
 * here and there, by noise, the differences cancel.  Where the mesh has more
 * light than the cells the result is 0. */
static double
overlooked(const struct found *f)
{
    return f->mesh < f->cells ? 1 - f->mesh / f->cells : 0;
}

/* The mean tangent of the angle to the normal, for directions whose projections
 * on the plane fill the ring from r0 to r1. */
static double
mean_tangent(double r0, double r1)
{
    double to = rad_asin(r1) - r1 * sqrt(1 - r1 * r1);
    double from = rad_asin(r0) - r0 * sqrt(1 - r0 * r0);

    return (to - from) / (r1 * r1 - r0 * r0);
}

/* Add the cell's light, less `mean', times its tangent across the normal. */
static void
add_turn(const struct rad_hemicell *c, double mean, double tangent,
         double turn[2])
{
    double across = rad_hypot(c->p[0], c->p[1]);
    double f = across > 0 ? (rad_rgb_lum(c->L) - mean) * tangent / across : 0;

    turn[0] -= f * c->p[1];
    turn[1] += f * c->p[0];
}

/* A turn of the normal by the vector da adds L da.(n x d) / (n.d) for a sample
 * in direction d: the density of samples is in proportion to n.d.  The length
 * of n x d over n.d is the tangent of d's angle to the normal, which has no
 * bound: single rays near the horizon would make most of the sum, and its
 * variance would be infinite.  So each cell has its ring's mean tangent.  The
 * mean of the light is left out, since a uniform part adds only noise, and so
 * are the cells that are on the sphere of find_sphere(). */
static void
turn_within(const struct rad_hemi *h, double curve, double turn[2])
{
    int n = h->n;
    double mean = rad_rgb_lum(h->E) / M_PI, scale = 1 / (mean * n * n);

    turn[0] = turn[1] = 0;
    for (int ring = 1 - n % 2; ring < n; ring += 2) {
        int lo = (n - 1 - ring) / 2, hi = n - 1 - lo;
        double r0 = rad_most(ring - 1, 0) / n, r1 = (ring + 1.) / n;
        double tangent = mean_tangent(r0, r1);

        for (int i = lo; i <= hi; i++)
            for (int j = lo; j <= hi; j += i == lo || i == hi ? 1 : hi - lo)
                if (!on_sphere(h->cell[i * n + j].p, curve))
                    add_turn(&h->cell[i * n + j], mean, tangent, turn);
    }
    for (int k = 0; k < 2; k++)
        turn[k] *= scale;
}

void
rad_hemi_turn(const struct rad_hemi *h, double turn[2])
{
    turn_within(h, 0, turn);
}

void
rad_hemi_gradients(const struct rad_hemi *h, struct rad_gradients *g)
{
    struct rad_slope sum = { .grad = { 0 } };
    struct mesh m = { .h = h, .curve = find_sphere(h) };
    double E = M_PI * fair_mean(h, &m.most);
    struct found found;

    sum_edges(&m, &sum, &found);
    sum_rims(&m, &sum);
    turn_within(h, m.curve, g->turn);
    g->overlooked = overlooked(&found);
    for (int k = 0; k < 2; k++)
        g->move[k] = sum.grad[k] / E;
    for (int k = 0; k < 3; k++)
        g->hess[k] = sum.hess[k] / E;
}

void
rad_eigen2(const double m[3], double value[2], double vec[2])
{
    double mean = (m[0] + m[2]) / 2, half = (m[0] - m[2]) / 2;
    double root = rad_hypot(half, m[1]), sign = mean < 0 ? -1 : 1;
    double angle = rad_atan2(m[1], half) / 2; /* of mean + root's eigenvector */

    value[0] = mean + sign * root;
    value[1] = mean - sign * root;
    if (sign < 0)
        angle += M_PI / 2;
    rad_sin_and_cos(angle, &vec[1], &vec[0]);
}
