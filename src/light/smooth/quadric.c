/* quadric.c - see quadric.h
 *
 * Let x be a sample's terms 1, x, y, x^2, xy, y^2 and w its weight.  With the
 * moments M = sum w x x^T and the prior's weights D on the diagonal, the
 * coefficients are (M + D)^-1 sum w x E.  The noise of the fit follows from M
 * and from V = sum w^2 x x^T, so one loop over the samples is enough. */
#include "config.h"

#include "light/smooth/quadric.h"
#include "base/vec.h"

#include <string.h>

#define TERMS  RAD_QUADRIC_TERMS
#define LINEAR 3 /* terms of a plane */
#define FEWEST 8 /* samples of a fit */

/* A pivot below this part of its diagonal element is all rounding. */
#define SINGULAR 1e-3

typedef double matrix[TERMS][TERMS];

struct sums {
    matrix M, V;     /* see above; lower halves */
    double y[TERMS]; /* sum of w x (lum - base) */
    double y2;       /* sum of w (lum - base)^2 */
    double base;     /* a luminance near all others */
    int n;           /* samples of positive weight */
};

static void
set_terms(const struct rad_quadric_sample *s, double x[TERMS])
{
    x[0] = 1;
    x[1] = s->x;
    x[2] = s->y;
    x[3] = s->x * s->x;
    x[4] = s->x * s->y;
    x[5] = s->y * s->y;
}

static double
weight(const struct rad_quadric_sample *s, double width)
{
    return 1 - s->d2 / (width * width);
}

static void
add_up(const struct rad_quadric_sample *s, int n, double width, struct sums *k)
{
    double x[TERMS];

    memset(k, 0, sizeof *k);
    k->base = s[0].lum; /* differences keep more digits than luminances */
    for (; n > 0; n--, s++) {
        double w = weight(s, width), lum = s->lum - k->base;

        if (!(w > 0))
            continue;
        set_terms(s, x);
        for (int i = 0; i < TERMS; i++) {
            double wx = w * x[i];

            for (int j = 0; j <= i; j++) {
                k->M[i][j] += wx * x[j];
                k->V[i][j] += w * wx * x[j];
            }
            k->y[i] += wx * lum;
        }
        k->y2 += w * lum * lum;
        k->n++;
    }
}

/* K is set to the inverse of the Cholesky factor of a symmetric matrix, whose
 * lower half is m: m^-1 = K^T K.  False: the matrix is singular. */
static bool
invert_root(matrix m, matrix K)
{
    matrix L;

    for (int i = 0; i < TERMS; i++) {
        for (int j = 0; j <= i; j++) {
            double a = m[i][j];

            for (int k = 0; k < j; k++)
                a -= L[i][k] * L[j][k];
            if (j < i)
                L[i][j] = a / L[j][j];
            else if (a > SINGULAR * m[i][i])
                L[i][i] = sqrt(a);
            else
                return false;
        }
        K[i][i] = 1 / L[i][i];
        for (int j = 0; j < i; j++) {
            double a = 0;

            for (int k = j; k < i; k++)
                a -= L[i][k] * K[k][j];
            K[i][j] = a / L[i][i];
        }
    }
    return true;
}

/* r = K^T K y */
static void
solve(matrix K, const double y[TERMS], double r[TERMS])
{
    memset(r, 0, TERMS * sizeof *r);
    for (int i = 0; i < TERMS; i++) {
        double a = 0;

        for (int j = 0; j <= i; j++)
            a += K[i][j] * y[j];
        for (int j = 0; j <= i; j++)
            r[j] += K[i][j] * a;
    }
}

/* a^T m b of a symmetric matrix, whose lower half is m. */
static double
product(const double a[TERMS], matrix m, const double b[TERMS])
{
    double sum = 0;

    for (int i = 0; i < TERMS; i++) {
        sum += a[i] * m[i][i] * b[i];
        for (int j = 0; j < i; j++)
            sum += m[i][j] * (a[i] * b[j] + a[j] * b[i]);
    }
    return sum;
}

/* The residual degrees of freedom, as a weight: the sum of all weights, less
 * trace(K V K^T), by which samples pull the fit at their own places. */
static double
freedom(matrix K, struct sums *k)
{
    double sum = k->M[0][0];

    for (int i = 0; i < TERMS; i++)
        sum -= product(K[i], k->V, K[i]);
    return sum;
}

double
rad_quadric_noise(const struct rad_quadric_sample *s, int n)
{
    double sum = 0, all = 0;

    for (int i = 0; i < n; i++) {
        double w = weight(&s[i], 1);

        if (!(w > 0))
            continue;
        sum += w * s[i].noise;
        all += w;
    }
    return all > 0 ? sum / all : 0;
}

bool
rad_quadric_fit(const struct rad_quadric_sample *s, int n, double width,
                double noise, double bend, struct rad_quadric *q)
{
    static const double middle[TERMS] = { 1 };
    double b[TERMS], hold, left;
    struct sums k;
    matrix A, K = { { 0 } };

    add_up(s, n, width, &k);
    if (k.n < FEWEST || !(bend > 0))
        return false;
    q->width = width;
    q->noise = noise;
    hold = q->noise / (bend * bend);
    memcpy(A, k.M, sizeof A);
    for (int i = LINEAR; i < TERMS; i++)
        A[i][i] += hold;
    if (!invert_root(A, K))
        return false;
    solve(K, k.y, b);
    solve(K, middle, q->pull);
    left = freedom(K, &k);
    if (!(left > 0))
        return false;
    /* first the mean square of what the fit leaves; then its part beyond the
     * noise; then the noise of the fit itself is added, by the samples and by
     * the prior */
    q->risk = (k.y2 - 2 * b[0] * k.y[0] + product(b, k.M, b)) / left;
    for (int i = 1; i < TERMS; i++)
        q->risk -= 2 * b[i] * k.y[i] / left;
    q->risk = rad_most(q->risk - q->noise, 0);
    q->risk += q->noise * product(q->pull, k.V, q->pull);
    for (int i = LINEAR; i < TERMS; i++)
        q->risk += q->pull[i] * q->pull[i] * hold * q->noise;
    q->slope[0] = b[1];
    q->slope[1] = b[2];
    return true;
}

void
rad_quadric_middle(const struct rad_quadric_sample *s, int n,
                   const struct rad_quadric *q, double E[3])
{
    double x[TERMS];

    E[0] = E[1] = E[2] = 0;
    for (; n > 0; n--, s++) {
        double w = weight(s, q->width), pull = 0;

        if (!(w > 0))
            continue;
        set_terms(s, x);
        for (int i = 0; i < TERMS; i++)
            pull += q->pull[i] * x[i];
        for (int c = 0; c < 3; c++)
            E[c] += w * pull * s->E[c];
    }
}
