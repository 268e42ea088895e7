/* color.h - radiance, irradiance and reflectance per channel
 *
 * Three floats: red, green, blue of Radiance's standard primaries (CIE x,y
 * .640 .330, .290 .600, .150 .060, equal-energy white), from which the weights
 * of luminance follow.  The factor 179 lm/W applies only on output. */
#ifndef RAD_BASE_COLOR_H
#define RAD_BASE_COLOR_H

#include <math.h>
#include <stdbool.h>

struct rad_rgb {
    float r, g, b;
};

#define RAD_LUM_R 0.265074126f
#define RAD_LUM_G 0.670114631f
#define RAD_LUM_B 0.064811243f

static inline struct rad_rgb
rad_rgb(float r, float g, float b)
{
    struct rad_rgb c = { r, g, b };

    return c;
}

static inline struct rad_rgb
rad_grey(float v)
{
    return rad_rgb(v, v, v);
}

static inline struct rad_rgb
rad_rgb_add(struct rad_rgb a, struct rad_rgb b)
{
    return rad_rgb(a.r + b.r, a.g + b.g, a.b + b.b);
}

static inline struct rad_rgb
rad_rgb_mul(struct rad_rgb a, struct rad_rgb b)
{
    return rad_rgb(a.r * b.r, a.g * b.g, a.b * b.b);
}

/* Multiplied by s, as a float. */
static inline struct rad_rgb
rad_rgb_scale(struct rad_rgb a, double s)
{
    float f = (float)s;

    return rad_rgb(a.r * f, a.g * f, a.b * f);
}

/* Luminance without the efficacy factor, in the units of the channels. */
static inline float
rad_rgb_lum(struct rad_rgb a)
{
    return RAD_LUM_R * a.r + RAD_LUM_G * a.g + RAD_LUM_B * a.b;
}

/* CIE tristimulus values, times 179 lm/W, so that Y is luminance [cd/m^2]; and
 * back. */
static inline struct rad_rgb
rad_rgb_to_xyz(struct rad_rgb c)
{
    struct rad_rgb xyz = {
        179 * (0.51414462f * c.r + 0.32388448f * c.g + 0.16197090f * c.b),
        179 * (0.26510582f * c.r + 0.67010582f * c.g + 0.06478836f * c.b),
        179 * (0.02410053f * c.r + 0.12285273f * c.g + 0.85304674f * c.b)
    };

    return xyz;
}

static inline struct rad_rgb
rad_xyz_to_rgb(struct rad_rgb c)
{
    struct rad_rgb rgb = {
        (2.56531285f * c.r - 1.16684962f * c.g - 0.39846323f * c.b) / 179,
        (-1.02210817f * c.r + 1.97828662f * c.g + 0.04382156f * c.b) / 179,
        (0.07472437f * c.r - 0.25193956f * c.g + 1.17721519f * c.b) / 179
    };

    return rgb;
}

/* The largest channel, which decides a ray's weight. */
static inline float
rad_rgb_max(struct rad_rgb a)
{
    float m = a.r > a.g ? a.r : a.g;

    return m > a.b ? m : a.b;
}

static inline bool
rad_rgb_black(struct rad_rgb a)
{
    return a.r <= 0 && a.g <= 0 && a.b <= 0;
}

#define RAD_MAX_RADIANCE 3.4e38f

/* Finite, as the radiance of a ray must be? */
static inline bool
rad_rgb_bounded(struct rad_rgb a)
{
    return fabsf(a.r) <= RAD_MAX_RADIANCE && fabsf(a.g) <= RAD_MAX_RADIANCE &&
           fabsf(a.b) <= RAD_MAX_RADIANCE;
}

/* Finite and not negative, as values in a pixel or a cache must be? */
static inline bool
rad_rgb_sound(struct rad_rgb a)
{
    return a.r >= 0 && a.g >= 0 && a.b >= 0 && a.r <= RAD_MAX_RADIANCE &&
           a.g <= RAD_MAX_RADIANCE && a.b <= RAD_MAX_RADIANCE;
}

#endif
