/* sky.c - closed forms of light from all around, by sampling */
#include "config.h"

#include "accuracy.h"
#include "base/vec.h"

static const double origin[3] = { 0, 0, 0 };

#define SAMPLED "-ab 1 -aa 0 -ad 16384 -as 0 -lw 0 -lr 9"

/* What a surface tilted by a[0] degrees gets of a uniform sky: the share of the
 * sky that it sees, by the cosine, is (1 + cos) / 2. */
static struct outcome
uniform_sky(struct stage *s, const double *a)
{
    double t = a[0] * M_PI / 180, n[3] = { sin(t), 0, cos(t) };

    stage_open(s, SAMPLED,
               "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 180\n");
    return (struct outcome){ stage_irradiance(s, origin, n),
                             M_PI * (1 + cos(t)) / 2 };
}

/* The same of the CIE's overcast sky, whose radiance grows as 1 + 2 sin of the
 * altitude (Moon & Spencer 1942; Muneer 1990 for tilted planes). */
static struct outcome
overcast_sky(struct stage *s, const double *a)
{
    double t = a[0] * M_PI / 180, n[3] = { sin(t), 0, cos(t) };
    double half = sin(t / 2);

    stage_open(s, SAMPLED,
               "void brightfunc f 2 (1+2*Dz)/3 . 0 0\n"
               "f glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 180\n");
    return (struct outcome){
        stage_irradiance(s, origin, n),
        7 * M_PI / 9 *
            (1 - half * half +
             4 / (7 * M_PI) * (sin(t) - t * cos(t) - M_PI * half * half))
    };
}

/* A surface of reflectance a[0] in a furnace is as bright as its walls times
 * the reflectance. */
static struct outcome
furnace(struct stage *s, const double *a)
{
    static const double eye[3] = { 0, 0, 2 }, down[3] = { .2, .1, -1 };

    stage_open(s, SAMPLED,
               "void glow g 0 0 4 3 3 3 0\ng bubble wall 0 0 4 0 0 0 50\n"
               "void plastic p 0 0 5 %.17g %.17g %.17g 0 0\n"
               "p sphere b 0 0 4 0 0 0 1\n",
               a[0], a[0], a[0]);
    return (struct outcome){ stage_radiance(s, eye, down, 1), 3 * a[0] };
}

/* Light of -av that is passed on by closed walls of reflectance a[0], a[1]
 * times. */
static struct outcome
closed_box(struct stage *s, const double *a)
{
    static const double in[3] = { .3, -.2, 0 }, way[3] = { .3, .4, .6 };
    char options[80] = "-ab 0 -aa 0 -ad 64 -as 0 -lw 0 -lr 9 -av 1 1 1";

    options[4] = (char)('0' + (int)a[1]);
    stage_open(s, options,
               "void plastic p 0 0 5 %.17g %.17g %.17g 0 0\n"
               "p bubble wall 0 0 4 0 0 0 1\n",
               a[0], a[0], a[0]);
    return (struct outcome){ stage_radiance(s, in, way, 1),
                             pow(a[0], a[1] + 1) };
}

/* An integrating sphere of reflectance a[0] whose lamp is a disk in the mouth
 * of a cap: direct light is the same everywhere (L cap / 4 R^2), and so is
 * each bounce, of which the share that does not fall on the lamp goes on. */
static struct outcome
integrating_sphere(struct stage *s, const double *a)
{
    static const double p[3] = { .6, 0, -.8 }, n[3] = { -.6, 0, .8 };
    double z = sqrt(1 - .25), cap = (1 - z) / 2, E = 0;

    stage_open(
        s, "-ab 2 -aa 0 -ad 1024 -as 0 -lw 0 -lr 9 -dt 0 -ds .3",
        "void light l 0 0 3 1 1 1\nl ring d 0 0 8 0 0 %.17g 0 0 -1 0 .5\n"
        "void plastic p 0 0 5 %.17g %.17g %.17g 0 0\n"
        "p bubble wall 0 0 4 0 0 0 1\n",
        z, a[0], a[0], a[0]);
    for (int k = 0; k <= 2; k++)
        E += M_PI * cap * pow(a[0] * (1 - cap), k);
    return (struct outcome){ stage_irradiance(s, p, n), E };
}

const struct row sky_rows[] = {
    /* clang-format off */
    { "uniform sky, horizontal", uniform_sky, { 0 }, 1e-6 },
    { "uniform sky, tilted by 30 degrees", uniform_sky, { 30 }, 2e-3 },
    { "uniform sky, vertical", uniform_sky, { 90 }, 2e-3 },
    { "overcast sky, horizontal", overcast_sky, { 0 }, 1e-3 },
    { "overcast sky, tilted by 45 degrees", overcast_sky, { 45 }, 2e-3 },
    { "overcast sky, vertical", overcast_sky, { 90 }, 3e-3 },
    { "furnace, reflectance 0.1", furnace, { .1 }, 1e-6 },
    { "furnace, reflectance 0.5", furnace, { .5 }, 1e-6 },
    { "furnace, reflectance 1", furnace, { 1 }, 1e-6 },
    { "closed box, 1 bounce", closed_box, { .5, 1 }, 1e-6 },
    { "closed box, 3 bounces", closed_box, { .8, 3 }, 1e-5 },
    { "integrating sphere", integrating_sphere, { .7 }, 5e-3 },
    { NULL, NULL, { 0 }, 0 }
    /* clang-format on */
};
