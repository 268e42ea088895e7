/* srgb.c - see srgb.h */
#include "config.h"

#include "image/srgb.h"

#include <math.h>
#include <string.h>

#define STRAIGHT .0031308 /* below this the curve is a straight line */
#define SLOPE    12.92

static double
encode(double v)
{
    return v <= STRAIGHT ? SLOPE * v : 1.055 * pow(v, 1 / 2.4) - .055;
}

/* 2^-9 is below STRAIGHT, so the table's first octave has the end of the line.
 * The line itself is not in the table. */
void
rad_srgb_init(struct rad_srgb_table *t)
{
    enum { N = RAD_SRGB_OCTAVES * RAD_SRGB_STEPS };

    for (int i = 0; i < N; i++) {
        int octave = i / RAD_SRGB_STEPS - RAD_SRGB_OCTAVES;
        double part = (double)(i % RAD_SRGB_STEPS) / RAD_SRGB_STEPS;

        t->at[i] = (float)encode(ldexp(1 + part, octave));
    }
    t->at[N] = 1;
}

/* The upper bits of a float, exponent and mantissa, are the step's number. */
float
rad_srgb_encode(const struct rad_srgb_table *t, float v)
{
    enum { SHIFT = 15, FIRST = (127 - RAD_SRGB_OCTAVES) << 8 };
    uint32_t bits, i;
    float part;

    if (!(v > 0))
        return 0;
    if (v >= 1)
        return 1;
    if (v <= (float)STRAIGHT)
        return (float)SLOPE * v;
    memcpy(&bits, &v, sizeof bits);
    i = (bits >> SHIFT) - FIRST;
    part = (float)(bits & ((1u << SHIFT) - 1)) * (1.f / (1 << SHIFT));
    return t->at[i] + part * (t->at[i + 1] - t->at[i]);
}
