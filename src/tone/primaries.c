/* primaries.c - see primaries.h */
#include "config.h"

#include "tone/primaries.h"

#include <math.h>
#include <string.h>

static const double srgb[8] = {
    .640, .330, .300, .600, .150, .060, .3127, .3290
};
static const double radiances[8] = { .640, .330, .290,   .600,
                                     .150, .060, 1. / 3, 1. / 3 };

static const double bradford[3][3] = { { .8951, .2664, -.1614 },
                                       { -.7502, 1.7135, .0367 },
                                       { .0389, -.0685, 1.0296 } };

static void
multiply(double to[3][3], const double a[3][3], const double b[3][3])
{
    double p[3][3];

    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            p[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
    memcpy(to, p, sizeof p);
}

static void
apply(double to[3], const double m[3][3], const double v[3])
{
    double p[3];

    for (int i = 0; i < 3; i++)
        p[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
    memcpy(to, p, sizeof p);
}

static bool
invert(double to[3][3], const double m[3][3])
{
    double c[3][3], det = 0;

    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int a = (i + 1) % 3, b = (i + 2) % 3;
            int k = (j + 1) % 3, l = (j + 2) % 3;

            c[j][i] = m[a][k] * m[b][l] - m[a][l] * m[b][k];
        }
    for (int j = 0; j < 3; j++)
        det += m[0][j] * c[j][0];
    if (!(fabs(det) > 1e-9))
        return false;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            to[i][j] = c[i][j] / det;
    return true;
}

/* X, Y, Z of the colour with these chromaticities and Y = 1. */
static bool
tristimulus(const double xy[2], double xyz[3])
{
    if (!(xy[1] > 1e-6))
        return false;
    xyz[0] = xy[0] / xy[1];
    xyz[1] = 1;
    xyz[2] = (1 - xy[0] - xy[1]) / xy[1];
    return true;
}

/* The matrix from numbers in the primaries to X, Y, Z; also the cone responses
 * to white. */
static bool
to_xyz(const double chroma[8], double m[3][3], double white_cones[3])
{
    double xyz[3][3], inverse[3][3], white[3], amount[3];

    for (int p = 0; p < 3; p++) { /* x, y, z instead of X, Y, Z: y may be 0 */
        xyz[0][p] = chroma[2 * p];
        xyz[1][p] = chroma[2 * p + 1];
        xyz[2][p] = 1 - chroma[2 * p] - chroma[2 * p + 1];
    }
    if (!tristimulus(chroma + 6, white) || !invert(inverse, xyz))
        return false;
    apply(amount, inverse, white);
    for (int i = 0; i < 3; i++)
        for (int p = 0; p < 3; p++)
            m[i][p] = xyz[i][p] * amount[p];
    apply(white_cones, bradford, white);
    return true;
}

bool
rad_primaries_matrix(const double chroma[8], double m[3][3])
{
    double from[3][3], to[3][3], adapt[3][3], back[3][3];
    double cones[3], wanted[3];

    if (!to_xyz(chroma, from, cones) || !to_xyz(srgb, to, wanted) ||
        !invert(back, bradford) || !invert(to, to))
        return false;
    for (int i = 0; i < 3; i++) {
        if (!(fabs(cones[i]) > 1e-9))
            return false;
        for (int j = 0; j < 3; j++)
            adapt[i][j] = bradford[i][j] * wanted[i] / cones[i];
    }
    multiply(m, adapt, from);
    multiply(m, back, m);
    multiply(m, to, m);
    return true;
}

/* Are these Radiance's own primaries, as four digits in a header give them? */
static bool
are_radiances(const double chroma[8])
{
    for (int i = 0; i < 8; i++)
        if (!(fabs(chroma[i] - radiances[i]) < 1e-3))
            return false;
    return true;
}

void
rad_primaries_convert(struct rad_picture *pic)
{
    size_t n = rad_picture_pixels(pic);
    double m[3][3];

    if (!pic->other_primaries || are_radiances(pic->chroma) ||
        !rad_primaries_matrix(pic->chroma, m))
        return;
    for (size_t i = 0; i < n; i++) {
        double v[3] = { pic->L[i].r, pic->L[i].g, pic->L[i].b };

        apply(v, m, v);
        pic->L[i] = rad_rgb((float)fmax(v[0], 0), (float)fmax(v[1], 0),
                            (float)fmax(v[2], 0));
    }
    pic->other_primaries = false;
}
