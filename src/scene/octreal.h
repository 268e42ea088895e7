/* octreal.h - the reals of octree files, for the reader and the writer
 *
 * A real has a mantissa of 31 bits and an exponent of a byte; see octfile.h.
 * Doubles are split by their bits and not by ldexp() and frexp(), because a
 * large scene has tens of millions: ldexp() took a seventh of its loading. */
#ifndef RAD_SCENE_OCTREAL_H
#define RAD_SCENE_OCTREAL_H

#include "arith/bits.h"

#include <stdint.h>

#define RAD_OCT_LARGEST 0x7fffffff

/* Other constants of the formats. */
#define RAD_OCT_FORMAT  "Radiance_octree"
#define RAD_MESH_FORMAT "Radiance_tmesh"
#define RAD_OCT_MAGIC   283 /* plus the bytes of an index */
#define RAD_MESH_MAGIC  319
#define RAD_OCT_EXACT   "radd\1"
enum { RAD_OCT_EMPTY, RAD_OCT_FULL, RAD_OCT_TREE };

struct rad_octreal {
    int32_t mantissa;
    int exponent;
};

/* x = f * 2^e with f from 1/2 to 1 becomes f * (2^31 - 1), cut to an integer.
 * If a byte cannot hold e, the result is the largest number, or zero. */
static inline struct rad_octreal
rad_octreal_of(double x)
{
    const uint64_t exponent_bits = UINT64_C(0x7ff) << 52;
    uint64_t bits = rad_bits_of(x);
    int e = (int)(bits >> 52 & 0x7ff) - 1022;
    struct rad_octreal p = { 0, 0 };

    if (e > 127) {
        p.mantissa = x > 0 ? RAD_OCT_LARGEST : -RAD_OCT_LARGEST;
        p.exponent = 127;
    } else if (e >= -128) {
        bits = (bits & ~exponent_bits) | UINT64_C(1022) << 52;
        p.mantissa = (int32_t)(rad_double_of(bits) * RAD_OCT_LARGEST);
        p.exponent = e;
    }
    return p;
}

static inline double
rad_octreal_value(struct rad_octreal p)
{
    double half = p.mantissa < 0 ? -.5 : .5;

    if (p.mantissa == 0)
        return 0;
    return (p.mantissa + half) * (1. / RAD_OCT_LARGEST) *
           rad_power_of_two(p.exponent);
}

#endif
