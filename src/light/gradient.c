/* gradient.c - see gradient.h
 *
 * An edge from a to b = a + e adds n.(a x b) I / 2 to the irradiance, where
 *     I = integral over the edge of dt / |r|^2,  r = a + t e, 0 <= t <= 1,
 * and differentiating twice with respect to the point, for which dr = -dx,
 *     grad = [ (n x e) I + n.(a x b) G ] / 2
 *     hess = [ (n x e) G^T + G (n x e)^T + n.(a x b) K ] / 2
 *     G = 2 integral r / |r|^4,  K = integral of 8 r r^T / |r|^6 - 2 / |r|^4.
 * With h the foot of the perpendicular on the edge's line and s the length
 * along it from there, r = h + s e/|e|, every integral is one of
 *     A_k = integral ds / q^k,  B_k = ... s / q^k,  C_3 = ... s^2 / q^3,
 * q = h^2 + s^2, which have closed forms.  */
#include "config.h"

#include "light/gradient.h"
#include "base/vec.h"

#include <string.h>

/* An edge whose line passes this close to the point, relative to its distance,
 * is seen end on: it spans no angle worth the cancellation in h. */
#define END_ON 1e-6

/* m (xx xy xz yy yz zz) += s (a b^T + b a^T) / 2 */
static void
add_outer(double m[6], double s, const double a[3], const double b[3])
{
    int k = 0;

    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++)
            m[k++] += s / 2 * (a[i] * b[j] + a[j] * b[i]);
}

void
rad_edge_derivatives(const double a[3], const double b[3], const double n[3],
                     double scale, double grad[3], double hess[6])
{
    double e[3], h[3], axb[3], nxe[3], G[3];

    rad_sub(e, b, a);
    double len = rad_normalize(e);
    double s0 = rad_dot(a, e), s1 = s0 + len;

    rad_madd(h, a, -s0, e);
    double h2 = rad_dot(h, h), q0 = rad_dot(a, a), q1 = rad_dot(b, b);

    if (!(h2 > END_ON * END_ON * rad_least(q0, q1)))
        return;
    rad_cross(axb, a, b);
    rad_cross(nxe, n, e);

    double d = rad_dot(n, axb) / len; /* the integrals are over s = t len */
    double hh = sqrt(h2);
    double A1 = atan2(hh * len, h2 + s0 * s1) / hh;
    double A2 = ((s1 / q1 - s0 / q0) + A1) / (2 * h2);
    double B2 = (1 / q0 - 1 / q1) / 2;
    double A3 = ((s1 / (q1 * q1) - s0 / (q0 * q0)) + 3 * A2) / (4 * h2);
    double B3 = (1 / (q0 * q0) - 1 / (q1 * q1)) / 4;
    double C3 = A2 - h2 * A3;

    rad_scale(G, 2 * A2, h);
    rad_madd(G, G, 2 * B2, e);
    rad_madd(grad, grad, scale / 2 * A1, nxe);
    rad_madd(grad, grad, scale / 2 * d, G);
    add_outer(hess, scale, nxe, G);
    add_outer(hess, 4 * scale * d * A3, h, h);
    add_outer(hess, 8 * scale * d * B3, h, e);
    add_outer(hess, 4 * scale * d * C3, e, e);
    hess[0] -= scale * d * A2;
    hess[3] -= scale * d * A2;
    hess[5] -= scale * d * A2;
}

/* What a cell may count for at most, over the mean. */
#define MOST_SHARE 4

/* The mean luminance of the cells, of which none counts for more than *most,
 * about MOST_SHARE times that.  A cell that drew a rare bright sample would
 * else make all other differences small, so that its record, which is too
 * bright, would get a larger zone than those without, which are too dark: the
 * picture would be too bright.  Where most cells are black and some alike the
 * limit is small, but so is the mean, and their ratio stays. */
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

/* Luminance of the farthest of three cells, at most `most`. */
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

/* The two triangles of the square of cells above and right of (i, j). */
static double
lower(const struct rad_hemi *h, int i, int j, double most)
{
    int k = i * h->n + j;

    return behind(h, k, k + 1, k + h->n, most);
}

static double
upper(const struct rad_hemi *h, int i, int j, double most)
{
    int k = i * h->n + j;

    return behind(h, k + h->n + 1, k + h->n, k + 1, most);
}

struct sums {
    double grad[3], hess[6];
};

static void
add_edge(const struct rad_hemi *h, struct sums *s, int from, int to,
         double difference)
{
    if (difference != 0)
        rad_edge_derivatives(h->cell[from].p, h->cell[to].p, h->w, difference,
                             s->grad, s->hess);
}

/* Each edge between two triangles, with the difference of its left one and its
 * right one.  The mesh's outline has no right side: what lies beyond is taken
 * to go on as it is. */
static void
sum_edges(const struct rad_hemi *h, struct sums *s, double most)
{
    int n = h->n;

    for (int i = 0; i < n - 1; i++)
        for (int j = 0; j < n - 1; j++) {
            int k = i * n + j;
            double low = lower(h, i, j, most);

            add_edge(h, s, k + 1, k + n, low - upper(h, i, j, most));
            if (i > 0)
                add_edge(h, s, k, k + 1, low - upper(h, i - 1, j, most));
            if (j > 0)
                add_edge(h, s, k, k + n, upper(h, i, j - 1, most) - low);
        }
}

void
rad_hemi_gradients(const struct rad_hemi *h, struct rad_gradients *g)
{
    struct sums s = { .grad = { 0 } };
    double most, E = M_PI * fair_mean(h, &most);

    sum_edges(h, &s, most);
    rad_hemi_turn(h, g->turn);
    g->move[0] = rad_dot(s.grad, h->u) / E;
    g->move[1] = rad_dot(s.grad, h->v) / E;

    const double *m = s.hess;
    double Hu[3] = { m[0] * h->u[0] + m[1] * h->u[1] + m[2] * h->u[2],
                     m[1] * h->u[0] + m[3] * h->u[1] + m[4] * h->u[2],
                     m[2] * h->u[0] + m[4] * h->u[1] + m[5] * h->u[2] };
    double Hv[3] = { m[0] * h->v[0] + m[1] * h->v[1] + m[2] * h->v[2],
                     m[1] * h->v[0] + m[3] * h->v[1] + m[4] * h->v[2],
                     m[2] * h->v[0] + m[4] * h->v[1] + m[5] * h->v[2] };

    g->hess[0] = rad_dot(h->u, Hu) / E;
    g->hess[1] = rad_dot(h->u, Hv) / E;
    g->hess[2] = rad_dot(h->v, Hv) / E;
}

/* Turning the normal by da about axis t adds L da.(n x d) / (n.d) per sample
 * of direction d, for samples are as dense as n.d. */
void
rad_hemi_turn(const struct rad_hemi *h, double turn[2])
{
    double n2 = (double)h->n * h->n, scale = M_PI / n2 / rad_rgb_lum(h->E);
    double mean = rad_rgb_lum(h->E) / M_PI;

    turn[0] = turn[1] = 0;
    for (int k = 0; k < h->n * h->n; k++) {
        const double *d = h->cell[k].p;
        /* a uniform part turns nothing, but low rays would make it noise */
        double f = (rad_rgb_lum(h->cell[k].L) - mean) / rad_dot(h->w, d);

        turn[0] -= scale * f * rad_dot(h->v, d);
        turn[1] += scale * f * rad_dot(h->u, d);
    }
}

void
rad_eigen2(const double m[3], double value[2], double vec[2])
{
    double mean = (m[0] + m[2]) / 2, half = (m[0] - m[2]) / 2;
    double root = hypot(half, m[1]), sign = mean < 0 ? -1 : 1;
    double angle = atan2(m[1], half) / 2; /* of the larger eigenvalue */

    value[0] = mean + sign * root;
    value[1] = mean - sign * root;
    if (sign < 0)
        angle += M_PI / 2;
    vec[0] = cos(angle);
    vec[1] = sin(angle);
}
