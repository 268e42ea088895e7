/* matter.c - closed forms of glass, dielectrics, mist and diffusing sheets */
#include "config.h"

#include "accuracy.h"
#include "base/vec.h"

/* Everything beyond is of radiance 1 below z = 0, and black above. */
#define BACKLIGHT "void glow g 0 0 4 1 1 1 0\ng source below 0 0 4 0 0 -1 180\n"

/* Amplitudes that a surface of this relative index reflects of both
 * polarizations (Fresnel 1823). */
static void
fresnel(double n, double t, double *rs, double *rp)
{
    double c = cos(t), q = sqrt(1 - sin(t) * sin(t) / (n * n));

    *rs = (c - n * q) / (c + n * q);
    *rp = (q - n * c) / (q + n * c);
}

/* Looking down at the origin from the angle t off the vertical. */
static double
look(struct stage *s, double t)
{
    double from[3] = { -sin(t), 0, cos(t) }, to[3] = { sin(t), 0, -cos(t) };

    return stage_radiance(s, from, to, 1);
}

/* A pane of glass of transmissivity a[0] at a[1] degrees: all reflections
 * within are summed (Radiance's reference manual, "glass"). */
static struct outcome
glass(struct stage *s, const double *a)
{
    double t = a[1] * M_PI / 180, r[2];
    struct outcome o = { 0, 0 };

    stage_open(s, "-lw 0",
               "void glass m 0 0 3 %.17g %.17g %.17g\n"
               "m ring p 0 0 8 0 0 0 0 0 1 0 9\n" BACKLIGHT,
               a[0], a[0], a[0]);
    o.found = look(s, t);
    fresnel(1.52, t, &r[0], &r[1]);
    for (int k = 0; k < 2; k++) {
        double R = r[k] * r[k];
        double d = pow(a[0], 1 / sqrt(1 - pow(sin(t) / 1.52, 2)));

        o.truth += .5 * (1 - R) * (1 - R) * d / (1 - R * R * d * d);
    }
    return o;
}

/* A clear slab of index a[0], met at right angles, passes (1-R)/(1+R). */
static struct outcome
slab(struct stage *s, const double *a)
{
    double r = pow((a[0] - 1) / (a[0] + 1), 2);

    stage_open(s, "-lr 40 -lw 0",
               "void dielectric m 0 0 5 1 1 1 %.17g 0\n"
               "m ring top 0 0 8 0 0 0 0 0 1 0 9\n"
               "m ring bottom 0 0 8 0 0 -1 0 0 -1 0 9\n" BACKLIGHT,
               a[0]);
    return (struct outcome){ look(s, 0), (1 - r) / (1 + r) };
}

/* What the surface of a dielectric of index a[0] reflects at a[1] degrees; at
 * Brewster's angle, atan n, that is one polarization alone. */
static struct outcome
reflection(struct stage *s, const double *a)
{
    double t = a[1] < 0 ? atan(a[0]) : a[1] * M_PI / 180, rs, rp;

    stage_open(s, "-lw 0",
               "void dielectric m 0 0 5 1 1 1 %.17g 0\n"
               "m ring top 0 0 8 0 0 0 0 0 1 0 9\n"
               "void glow g 0 0 4 1 1 1 0\ng source above 0 0 4 0 0 1 180\n",
               a[0]);
    fresnel(a[0], t, &rs, &rp);
    return (struct outcome){ look(s, t), (rs * rs + rp * rp) / 2 };
}

/* Within a dielectric of index a[0] the outside is brighter by its square, less
 * what the surface reflects. */
static struct outcome
radiance_within(struct stage *s, const double *a)
{
    static const double in[3] = { 0, 0, 1 }, down[3] = { 0, 0, -1 };

    stage_open(s, "-lw 0",
               "void dielectric m 0 0 5 1 1 1 %.17g 0\n"
               "m ring bottom 0 0 8 0 0 0 0 0 -1 0 9\n" BACKLIGHT,
               a[0]);
    return (struct outcome){ stage_radiance(s, in, down, 1),
                             a[0] * a[0] *
                                 (1 - pow((a[0] - 1) / (a[0] + 1), 2)) };
}

/* a[0] thick, a[1] of the light through each unit, the way at a[2] degrees;
 * index 1, so that nothing else happens (Bouguer 1729). */
static struct outcome
absorption(struct stage *s, const double *a)
{
    double t = a[2] * M_PI / 180;

    stage_open(s, "-lw 0",
               "void dielectric m 0 0 5 %.17g %.17g %.17g 1 0\n"
               "m ring top 0 0 8 0 0 0 0 0 1 0 99\n"
               "m ring bottom 0 0 8 0 0 %.17g 0 0 -1 0 99\n" BACKLIGHT,
               a[1], a[1], a[1], -a[0]);
    return (struct outcome){ look(s, t), pow(a[1], a[0] / cos(t)) };
}

/* A slab of index a[0], a[1] thick, met at a[2] degrees: the place on the
 * ground where the way ends, told by its brightness (Snell 1621). */
static struct outcome
shift(struct stage *s, const double *a)
{
    double t = a[2] * M_PI / 180, in = asin(sin(t) / a[0]), T;
    double rs, rp, x = a[1] * tan(in) + (2 - a[1]) * tan(t);

    stage_open(s, "-lw 0 -lr 1",
               "void dielectric m 0 0 5 1 1 1 %.17g 0\n"
               "m ring top 0 0 8 0 0 0 0 0 1 0 9\n"
               "m ring bottom 0 0 8 0 0 %.17g 0 0 -1 0 9\n"
               "void brightfunc place 2 Px . 0 0\n"
               "place glow g 0 0 4 1 1 1 0\ng ring ground 0 0 8 0 0 -2 0 0 1 0 "
               "99\n",
               a[0], -a[1]);
    fresnel(a[0], t, &rs, &rp);
    T = 1 - (rs * rs + rp * rp) / 2; /* each surface by itself */
    return (struct outcome){ look(s, t) / (T * T), x };
}

/* Mist of extinction a[0] over length a[1] (Bouguer 1729). */
static struct outcome
extinction(struct stage *s, const double *a)
{
    stage_open(s, "-lw 0",
               "void mist m 0 0 3 %.17g %.17g %.17g\n"
               "m ring top 0 0 8 0 0 0 0 0 1 0 9\n"
               "m ring bottom 0 0 8 0 0 %.17g 0 0 -1 0 9\n" BACKLIGHT,
               a[0], a[0], a[0], -a[1]);
    return (struct outcome){ look(s, 0), exp(-a[0] * a[1]) };
}

/* What a layer of mist, 2 thick, scatters of a sun at a[2] degrees from the way
 * on, with eccentricity a[1] (Henyey & Greenstein 1941), if it absorbs a[3] of
 * what it takes: E p times the integral over the way, by 4000 rays of 16
 * samples. */
static struct outcome
scattering(struct stage *s, const double *a)
{
    static const double up[3] = { 0, 0, 1 }, down[3] = { 0, 0, -1 };
    double t = a[2] * M_PI / 180, g = a[1], half = sin(M_PI / 1440), sum = 0;
    double q = 1 + g * g - 2 * g * cos(t), omega = 4 * M_PI * half * half;
    double dim = a[3] * a[0] / cos(t); /* on the sun's way, per depth */
    int n = 4000;
    struct outcome o;

    stage_open(
        s, "-lw 0 -ms .125",
        "void light l 0 0 3 1e6 1e6 1e6\n"
        "l source sun 0 0 4 %.17g 0 %.17g .5\n"
        "void mist m 1 sun 0 7 %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n"
        "m ring top 0 0 8 0 0 0 0 0 1 0 99\n"
        "m ring bottom 0 0 8 0 0 -2 0 0 -1 0 99\n",
        sin(t), -cos(t), a[0], a[0], a[0], 1 - a[3], 1 - a[3], 1 - a[3], g);
    for (int i = 0; i < n; i++)
        sum += stage_radiance(s, up, down, (uint64_t)i);
    o.found = sum / n;
    /* the disk's solid angle, 2 pi (1 - cos) of its half angle */
    o.truth = 1e6 * omega * (1 - g * g) / (4 * M_PI * q * sqrt(q)) *
              (1 - a[3]) * (exp(-2 * dim) - exp(-2 * a[0])) / (1 - dim / a[0]);
    return o;
}

/* A sheet of trans under a sun at a[1] degrees, from the side of the sun
 * (a[0] = 0) or from behind: its diffuse reflectance or transmittance times
 * E / pi (Radiance's reference manual, "trans"). */
static struct outcome
sheet(struct stage *s, const double *a)
{
    double t = a[1] * M_PI / 180, half = sin(M_PI / 720), E;
    double color = .8, trans = .6, tspec = .3;

    stage_open(s, "-dt 0",
               "void light l 0 0 3 1e6 1e6 1e6\n"
               "l source sun 0 0 4 %.17g 0 %.17g .5\n"
               "void trans m 0 0 7 %g %g %g 0 0 %g %g\n"
               "m ring top 0 0 8 0 0 0 0 0 1 0 9\n",
               sin(t), a[0] == 0 ? cos(t) : -cos(t), color, color, color, trans,
               tspec);
    E = M_PI * half * half * 1e6 * cos(t);
    return (struct outcome){
        look(s, 0),
        E / M_PI * color * (a[0] == 0 ? 1 - trans : trans * (1 - tspec))
    };
}

const struct row matter_rows[] = {
    /* clang-format off */
    { "glass at 0 degrees", glass, { .96, 0 }, 1e-6 },
    { "glass at 30 degrees", glass, { .96, 30 }, 1e-6 },
    { "glass at 60 degrees", glass, { .96, 60 }, 1e-6 },
    { "glass at 80 degrees", glass, { .6, 80 }, 1e-6 },
    { "dielectric slab at right angles", slab, { 1.5 }, 1e-6 },
    { "dense slab at right angles", slab, { 2.4 }, 1e-6 },
    { "reflection at right angles", reflection, { 1.5, 0 }, 1e-6 },
    { "reflection at Brewster's angle", reflection, { 1.5, -1 }, 1e-6 },
    { "reflection at 80 degrees", reflection, { 1.5, 80 }, 1e-6 },
    { "radiance within a dielectric", radiance_within, { 1.5 }, 1e-6 },
    { "absorption", absorption, { 2.5, .8, 0 }, 1e-6 },
    { "absorption at 60 degrees", absorption, { 2.5, .8, 60 }, 1e-6 },
    { "Snell's shift", shift, { 1.5, 1, 45 }, 1e-6 },
    { "Snell's shift at 80 degrees", shift, { 1.5, .5, 80 }, 1e-6 },
    { "mist, extinction", extinction, { .3, 4 }, 1e-6 },
    { "mist, even scattering", scattering, { .2, 0, 60 }, 1e-3 },
    { "mist, forward scattering", scattering, { .8, .7, 20 }, 1e-3 },
    { "mist that absorbs, even", scattering, { .2, 0, 60, .3 }, 1e-3 },
    { "mist that absorbs, forward", scattering, { .8, .7, 20, .5 }, 1e-3 },
    { "trans from the sun's side", sheet, { 0, 30 }, 1e-5 },
    { "trans from behind", sheet, { 1, 60 }, 1e-4 },
    { NULL, NULL, { 0 }, 0 }
    /* clang-format on */
};
