/* calclib.c - library functions and noise of the function language
 *
 * noise3() is Perlin's gradient noise of 2002.  fnoise3() is Radiance's fractal
 * noise: a cube is halved again and again, and each new corner is the mean of
 * its neighbours plus a random number that shrinks with the cube.  Slopes are
 * differences over 1/2000 instead of derivatives, because pictures depend on
 * it.
 * Source: Perlin 2002, Improving noise; Radiance's reference manual. */
#include "config.h"

#include "scene/calc/calcimpl.h"

#include <math.h>
#include <string.h>

#include "arith/elementary.h"

#define STEP .0005 /* of slopes, and of the finest cube */

const struct library rad_calc_library[] = {
    { "if", 3, false, true, 0 },
    { "select", 1, true, true, 0 },
    { "min", 1, true, true, 0 },
    { "max", 1, true, true, 0 },
    { "atan2", 2, false, true, 0 },
    { "arg", 1, false, false, 0 },
    { "fprism_val", 3, false, false, RAD_CALC_OFFER_AIM },
    { "rand", 1, false, true, 0 },
    { "sqrt", 1, false, true, 0 },
    { "sin", 1, false, true, 0 },
    { "cos", 1, false, true, 0 },
    { "tan", 1, false, true, 0 },
    { "asin", 1, false, true, 0 },
    { "acos", 1, false, true, 0 },
    { "atan", 1, false, true, 0 },
    { "floor", 1, false, true, 0 },
    { "ceil", 1, false, true, 0 },
    { "exp", 1, false, true, 0 },
    { "log", 1, false, true, 0 },
    { "log10", 1, false, true, 0 },
    { "erf", 1, false, true, 0 },
    { "erfc", 1, false, true, 0 },
    { "noise3", 3, false, true, 0 },
    { "noise3x", 3, false, true, 0 },
    { "noise3y", 3, false, true, 0 },
    { "noise3z", 3, false, true, 0 },
    { "fnoise3", 3, false, true, 0 },
    { "source_corr", 2, false, false, 0 },
    { "source_theta", 1, false, false, 0 },
    { "source_phi", 1, false, false, 0 },
};
const int rad_calc_nlibrary =
    sizeof rad_calc_library / sizeof rad_calc_library[0];

/* the table's order, behind LIB_PRISM */
enum {
    LIB_RAND = LIB_PRISM + 1,
    LIB_SQRT,
    LIB_SIN,
    LIB_COS,
    LIB_TAN,
    LIB_ASIN,
    LIB_ACOS,
    LIB_ATAN,
    LIB_FLOOR,
    LIB_CEIL,
    LIB_EXP,
    LIB_LOG,
    LIB_LOG10,
    LIB_ERF,
    LIB_ERFC,
    LIB_NOISE3,
    LIB_NOISE3X,
    LIB_NOISE3Y,
    LIB_NOISE3Z,
    LIB_FNOISE3,
    LIB_CORR,
    LIB_THETA,
    LIB_PHI
};

/* --- noise -------------------------------------------------------------- */

/* Perlin's permutation. */
static const uint8_t perm[256] = {
    /* clang-format off */
    151, 160, 137, 91, 90, 15, 131, 13, 201, 95, 96, 53, 194, 233, 7, 225,
    140, 36, 103, 30, 69, 142, 8, 99, 37, 240, 21, 10, 23, 190, 6, 148,
    247, 120, 234, 75, 0, 26, 197, 62, 94, 252, 219, 203, 117, 35, 11, 32,
    57, 177, 33, 88, 237, 149, 56, 87, 174, 20, 125, 136, 171, 168, 68, 175,
    74, 165, 71, 134, 139, 48, 27, 166, 77, 146, 158, 231, 83, 111, 229, 122,
    60, 211, 133, 230, 220, 105, 92, 41, 55, 46, 245, 40, 244, 102, 143, 54,
    65, 25, 63, 161, 1, 216, 80, 73, 209, 76, 132, 187, 208, 89, 18, 169,
    200, 196, 135, 130, 116, 188, 159, 86, 164, 100, 109, 198, 173, 186, 3, 64,
    52, 217, 226, 250, 124, 123, 5, 202, 38, 147, 118, 126, 255, 82, 85, 212,
    207, 206, 59, 227, 47, 16, 58, 17, 182, 189, 28, 42, 223, 183, 170, 213,
    119, 248, 152, 2, 44, 154, 163, 70, 221, 153, 101, 155, 167, 43, 172, 9,
    129, 22, 39, 253, 19, 98, 108, 110, 79, 113, 224, 232, 178, 185, 112, 104,
    218, 246, 97, 228, 251, 34, 242, 193, 238, 210, 144, 12, 191, 179, 162, 241,
    81, 51, 145, 235, 249, 14, 239, 107, 49, 192, 214, 31, 181, 199, 106, 157,
    184, 84, 204, 176, 115, 121, 50, 45, 127, 4, 150, 254, 138, 236, 205, 93,
    222, 114, 67, 29, 24, 72, 243, 141, 128, 195, 78, 66, 215, 61, 156, 180,
    /* clang-format on */
};

/* The gradients of lattice points: the twelve directions to the edges of a
 * cube, four of them twice. */
static const double gradient[16][3] = {
    /* clang-format off */
    { 1, 1, 0 }, { -1, 1, 0 }, { 1, -1, 0 }, { -1, -1, 0 },
    { 1, 0, 1 }, { -1, 0, 1 }, { 1, 0, -1 }, { -1, 0, -1 },
    { 0, 1, 1 }, { 0, -1, 1 }, { 0, 1, -1 }, { 0, -1, -1 },
    { 1, 1, 0 }, { 0, -1, 1 }, { -1, 1, 0 }, { 0, -1, -1 },
    /* clang-format on */
};

/* The gradient of a lattice point times the vector from there.  h: the hash of
 * its first coordinates, plus the cell's last. */
static inline double
slope(int h, int z, double dx, double dy, double dz)
{
    const double *g = gradient[perm[(h + z) & 255] & 15];

    return g[0] * dx + g[1] * dy + g[2] * dz;
}

/* Set value[] to the gradients of a cell's corners, each times the vector from
 * there to f, the place within the cell: bit i of the index says on which side
 * of axis i a corner is. */
static void
corners(const int cell[3], const double f[3], double value[8])
{
    for (int x = 0; x < 2; x++) {
        int hx = perm[(cell[0] + x) & 255] + cell[1];

        for (int y = 0; y < 2; y++) {
            int h = perm[(hx + y) & 255] + cell[2];
            double *v = &value[x + 2 * y];

            v[0] = slope(h, 0, f[0] - x, f[1] - y, f[2]);
            v[4] = slope(h, 1, f[0] - x, f[1] - y, f[2] - 1);
        }
    }
}

static double
noise(const double p[3])
{
    double f[3], s[3], value[8];
    int cell[3];

    for (int i = 0; i < 3; i++) {
        if (!(fabs(p[i]) < 1e9))
            return 0; /* beyond the lattice, where floats have no fraction */
        /* truncated, and one less below 0, as in Radiance; so negative whole
         * numbers are at the far end of a cell */
        cell[i] = (int)p[i] - (p[i] < 0);
        f[i] = p[i] - cell[i];
        s[i] = f[i] * f[i] * f[i] * (f[i] * (f[i] * 6 - 15) + 10);
    }
    corners(cell, f, value);
    for (int i = 0, n = 4; i < 3; i++, n /= 2)
        for (int k = 0; k < n; k++)
            value[k] = value[2 * k] + s[i] * (value[2 * k + 1] - value[2 * k]);
    return value[0];
}

static double
noise_slope(const double p[3], int axis)
{
    double q[3] = { p[0], p[1], p[2] };

    q[axis] -= STEP;
    return (noise(p) - noise(q)) / STEP;
}

/* Lattice points are numbered: the sum of coordinates times strides, which
 * wraps around. */
static const uint64_t stride[3] = { 17, 23, 29 };

/* A random number in (-1, 1] for a lattice point: an integer hash. */
static double
lattice(uint64_t point)
{
    uint64_t s = point << 13 ^ point;

    s = s * (s * s * 15731 + 789221) + 1376312589;
    return 1 - (double)(s & 0x7fffffff) / 1073741824.0;
}

/* Divide the cube of edge 2*size at point `beg`, and keep the octant `branch`:
 * its corners become fval.  One of these is a corner of the cube.  The others
 * lie half-way along the axes in `mid`; each is the mean of the corners around
 * it plus a random number of its own. */
static void
subdivide(double fval[8], uint64_t beg, uint64_t size, int branch)
{
    static const double share[8] = { 1, .5, .5, .25, .5, .25, .25, .125 };
    double sum[8];
    uint64_t at[8];

    at[0] = beg;
    for (int i = 0; i < 3; i++)
        at[0] += branch >> i & 1 ? 2 * size * stride[i] : 0;
    for (int mid = 0; mid < 8; mid++)
        sum[mid] = fval[mid ^ branch];
    for (int i = 0; i < 3; i++)
        for (int mid = 1 << i; mid < 8; mid++)
            if (mid >> i & 1)
                sum[mid] += sum[mid ^ 1 << i];
    fval[branch] = sum[0];
    for (int mid = 1; mid < 8; mid++) {
        int i = mid & 4 ? 2 : mid & 2 ? 1 : 0;
        uint64_t step = size * stride[i];

        at[mid] = at[mid ^ 1 << i] + (branch >> i & 1 ? -step : step);
        fval[mid ^ branch] =
            share[mid] * sum[mid] + (double)size * STEP * lattice(at[mid]);
    }
}

static double
fractal(const double p[3])
{
    int64_t size = (int64_t)(1 / STEP), at[3];
    uint64_t point = 0;
    double fval[8], mean = 0;

    for (int i = 0; i < 3; i++) {
        double whole = floor(p[i]);

        if (!(fabs(p[i]) < 1e12))
            return 0;
        at[i] =
            (int64_t)((double)size * p[i]) - (int64_t)((double)size * whole);
        point += (uint64_t)(int64_t)((double)size * whole) * stride[i];
    }
    for (int j = 0; j < 8; j++) {
        uint64_t v = point;

        for (int i = 0; i < 3; i++)
            v += j >> i & 1 ? (uint64_t)size * stride[i] : 0;
        fval[j] = lattice(v);
    }
    while ((size >>= 1) > 0) {
        int branch = 0;

        for (int i = 0; i < 3; i++)
            branch |= (at[i] > size) << i;
        subdivide(fval, point, (uint64_t)size, branch);
        for (int i = 0; i < 3; i++)
            if (branch >> i & 1) {
                at[i] -= size;
                point += (uint64_t)size * stride[i];
            }
    }
    for (int j = 0; j < 8; j++)
        mean += .125 * fval[j];
    return mean;
}

/* --- the table's functions ----------------------------------------------- */

/* A number in [0, 1) that looks random, by Radiance's formula, which patterns
 * depend on. */
static double
scramble(double x)
{
    x *= 1 / (1 + x * x) + 2.71828182845904;
    x += .785398163397447 - floor(x);
    x = 1e5 / x;
    return x - floor(x);
}

static double
real_argument(double which, const struct rad_calc_input *in,
              enum rad_calc_fault *fault)
{
    if (!in || !in->args) {
        *fault = RAD_CALC_NO_CHANNEL;
        return 0;
    }
    if (!(which + .5 >= 1))
        return in->nargs;
    if (which + .5 >= in->nargs + 1.0) {
        *fault = RAD_CALC_NO_ARG;
        return 0;
    }
    return in->args[(int)(which + .5) - 1];
}

double
rad_calc_library_value(int id, const double *v, const struct rad_calc_input *in,
                       enum rad_calc_fault *fault)
{
    switch (id) {
    case LIB_ARG:
        return real_argument(v[0], in, fault);
    case LIB_MIN:
        return v[1] < v[0] ? v[1] : v[0];
    case LIB_MAX:
        return v[0] < v[1] ? v[1] : v[0];
    case LIB_RAND:
        return scramble(v[0]);
    case LIB_SQRT:
        return sqrt(v[0]);
    case LIB_SIN:
        return rad_sin(v[0]);
    case LIB_COS:
        return rad_cos(v[0]);
    case LIB_TAN:
        return rad_tan(v[0]);
    case LIB_ASIN:
        return rad_asin(v[0]);
    case LIB_ACOS:
        return rad_acos(v[0]);
    case LIB_ATAN:
        return rad_atan(v[0]);
    case LIB_ATAN2:
        return rad_atan2(v[1], v[0]);
    case LIB_FLOOR:
        return floor(v[0]);
    case LIB_CEIL:
        return ceil(v[0]);
    case LIB_EXP:
        return rad_exp(v[0]);
    case LIB_LOG:
        return rad_log(v[0]);
    case LIB_LOG10:
        return rad_log10(v[0]);
    case LIB_ERF:
        return erf(v[0]);
    case LIB_ERFC:
        return erfc(v[0]);
    case LIB_NOISE3:
        return noise(v);
    case LIB_NOISE3X:
    case LIB_NOISE3Y:
    case LIB_NOISE3Z:
        return noise_slope(v, id - LIB_NOISE3X);
    case LIB_FNOISE3:
        return fractal(v);
    case LIB_CORR:
        return rad_calc_luminaire(LUMINAIRE_CORR, v, in, fault);
    case LIB_THETA:
        return rad_calc_luminaire(LUMINAIRE_THETA, v, in, fault);
    case LIB_PHI:
        return rad_calc_luminaire(LUMINAIRE_PHI, v, in, fault);
    default:
        return 0;
    }
}
