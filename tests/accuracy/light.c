/* light.c - closed forms of direct light, and of what is seen of shapes */
#include "config.h"

#include "accuracy.h"
#include "base/vec.h"
#include "tests/lambert.h"

#include <stdio.h>

static const double origin[3] = { 0, 0, 0 }, up[3] = { 0, 0, 1 };

/* A lamp of radiance 1 and this surface. */
#define LAMP    "void light l 0 0 3 1 1 1\nl "
#define DIVIDED "-dt 0 -ds .1"

static double
radians(double deg)
{
    return deg * M_PI / 180;
}

/* Sphere of radius a[0] at distance a[1], a[2] degrees from the normal:
 * E = pi L (r/d)^2 cos (Lambert 1760). */
static struct outcome
sphere(struct stage *s, const double *a)
{
    double t = radians(a[2]), n[3] = { sin(t), 0, cos(t) };

    stage_open(s, DIVIDED, LAMP "sphere b 0 0 4 0 0 %.17g %.17g\n", a[1], a[0]);
    return (struct outcome){ stage_irradiance(s, origin, n),
                             M_PI * a[0] * a[0] / (a[1] * a[1]) * cos(t) };
}

/* Ring from a[0] to a[1], a[2] beside the point, at height a[3]. */
static struct outcome
ring(struct stage *s, const double *a)
{
    stage_open(s, DIVIDED,
               LAMP "ring b 0 0 8 %.17g 0 %.17g 0 0 -1 %.17g %.17g\n", a[2],
               a[3], a[0], a[1]);
    return (struct outcome){ stage_irradiance(s, origin, up),
                             lambert_disk(a[1], a[2], a[3]) -
                                 lambert_disk(a[0], a[2], a[3]) };
}

/* Rectangle a[0] by a[1] parallel to the surface at height a[2], with a corner
 * above the point (Lambert 1760; Howell 2010, B-3). */
static struct outcome
parallel_rectangle(struct stage *s, const double *a)
{
    double x = a[0] / a[2], y = a[1] / a[2];
    double p = sqrt(1 + x * x), q = sqrt(1 + y * y);

    stage_open(s, DIVIDED,
               LAMP "polygon b 0 0 12 0 0 %.17g 0 %.17g %.17g %.17g %.17g "
                    "%.17g %.17g 0 %.17g\n",
               a[2], a[1], a[2], a[0], a[1], a[2], a[0], a[2]);
    return (struct outcome){ stage_irradiance(s, origin, up),
                             (x / p * atan(y / p) + y / q * atan(x / q)) / 2 };
}

/* Rectangle a[0] wide and a[1] high that stands on the surface at distance
 * a[2], with a corner before the point (Howell 2010, B-4). */
static struct outcome
standing_rectangle(struct stage *s, const double *a)
{
    double r = hypot(a[1], a[2]);

    stage_open(s, DIVIDED,
               LAMP "polygon b 0 0 12 %.17g 0 0 %.17g 0 %.17g %.17g %.17g "
                    "%.17g %.17g %.17g 0\n",
               a[2], a[2], a[1], a[2], a[0], a[1], a[2], a[0]);
    return (struct outcome){ stage_irradiance(s, origin, up),
                             (atan(a[0] / a[2]) - a[2] / r * atan(a[0] / r)) /
                                 2 };
}

/* Polygons above a tilted surface (Lambert 1760): a triangle, and a concave
 * arrow head, from place a[1] beside and with a[2] degrees of tilt. */
static struct outcome
polygon(struct stage *s, const double *a)
{
    static const double arrow[] = { 0, 0, 2, -1, -1, 2, 0, 1.5, 2.4, 1, -1, 2 };
    static const double triangle[] = { 0, 0, 1, 0, 1, 2, 1, 0, 1.5 };
    const double *v = a[0] == 3 ? triangle : arrow;
    double t = radians(a[2]), p[3] = { a[1], .3, 0 };
    double n[3] = { -sin(t), 0, cos(t) };
    char text[400] = "";
    int used = 0;

    for (int i = 0; i < 3 * (int)a[0]; i++)
        used +=
            snprintf(text + used, sizeof text - (size_t)used, " %.17g", v[i]);
    stage_open(s, DIVIDED, LAMP "polygon b 0 0 %d%s\n", 3 * (int)a[0], text);
    return (struct outcome){ stage_irradiance(s, p, n),
                             lambert(v, (int)a[0], p, n) };
}

/* Share of what disk a[0] sends that reaches coaxial disk a[1] at distance
 * a[2], from the irradiance at radii of equal areas (Howell 2010, C-41). */
static struct outcome
coaxial_disks(struct stage *s, const double *a)
{
    double r1 = a[0] / a[2], r2 = a[1] / a[2], sum = 0;
    double S = 1 + (1 + r2 * r2) / (r1 * r1), x[STAGE_GAUSS], w[STAGE_GAUSS];

    stage_open(s, DIVIDED, LAMP "ring b 0 0 8 0 0 %.17g 0 0 -1 0 %.17g\n", a[2],
               a[0]);
    stage_gauss(12, x, w);
    for (int i = 0; i < 12; i++) {
        double p[3] = { a[1] * sqrt(x[i]), 0, 0 };

        sum += w[i] * stage_irradiance(s, p, up);
    }
    return (struct outcome){ sum / M_PI * r2 * r2 / (r1 * r1),
                             (S - sqrt(S * S - 4 * r2 * r2 / (r1 * r1))) / 2 };
}

/* Share of what a face of a cube sends to the opposite (a[0] = 0) or to an
 * adjacent one (Howell 2010, C-11 and the sum of all six). */
static struct outcome
cube_faces(struct stage *s, const double *a)
{
    double x[STAGE_GAUSS], w[STAGE_GAUSS], q = sqrt(2), opposite, sum = 0;
    static const double side[3] = { 1, 0, 0 };

    stage_open(s, "-dt 0 -ds .05",
               LAMP "polygon b 0 0 12 0 0 1 0 1 1 1 1 1 1 0 1\n");
    stage_gauss(16, x, w);
    for (int i = 0; i < 16; i++)
        for (int k = 0; k < 16; k++) {
            double floor[3] = { x[i], x[k], 0 }, wall[3] = { 0, x[i], x[k] };

            sum += w[i] * w[k] *
                   (a[0] == 0 ? stage_irradiance(s, floor, up)
                              : stage_irradiance(s, wall, side));
        }
    opposite = 2 / M_PI * (log(2 / sqrt(3)) + 2 * q * atan(1 / q) - M_PI / 2);
    return (struct outcome){ sum / M_PI,
                             a[0] == 0 ? opposite : (1 - opposite) / 4 };
}

/* The flux of a small ball through the faces of a cube about it is all that it
 * sends, 4 pi r^2 times pi L; the ball is off the middle. */
static struct outcome
flux(struct stage *s, const double *a)
{
    double x[STAGE_GAUSS], w[STAGE_GAUSS], sum = 0;

    stage_open(s, "-dt 0", LAMP "sphere b 0 0 4 .1 -.2 .3 %.17g\n", a[0]);
    stage_gauss(24, x, w);
    for (int face = 0; face < 6; face++)
        for (int i = 0; i < 24; i++)
            for (int k = 0; k < 24; k++) {
                double p[3], n[3] = { 0, 0, 0 };

                p[face / 2] = face % 2 ? 1 : -1;
                p[(face / 2 + 1) % 3] = 2 * x[i] - 1;
                p[(face / 2 + 2) % 3] = 2 * x[k] - 1;
                n[face / 2] = face % 2 ? -1 : 1;
                sum += 4 * w[i] * w[k] * stage_irradiance(s, p, n);
            }
    return (struct outcome){ sum, 4 * M_PI * M_PI * a[0] * a[0] };
}

/* A sun of a[0] degrees, a[1] degrees from the normal: pi sin^2 of half its
 * angle, and the cosine. */
static struct outcome
sun(struct stage *s, const double *a)
{
    double t = radians(a[1]), half = sin(radians(a[0] / 2));

    stage_open(s, "-dt 0", LAMP "source b 0 0 4 %.17g 0 %.17g %.17g\n", sin(t),
               cos(t), a[0]);
    return (struct outcome){ stage_irradiance(s, origin, up),
                             M_PI * half * half * cos(t) };
}

/* A spotlight's source lies its focal length a[1] behind the surface: E =
 * L A / (d + f)^2 (Radiance's reference manual). */
static struct outcome
spotlight(struct stage *s, const double *a)
{
    stage_open(s, "-dt 0",
               "void spotlight l 0 0 7 1 1 1 60 0 0 %.17g\n"
               "l ring b 0 0 8 0 0 %.17g 0 0 -1 0 .01\n",
               -a[1], a[0]);
    return (struct outcome){ stage_irradiance(s, origin, up),
                             M_PI * 1e-4 / ((a[0] + a[1]) * (a[0] + a[1])) };
}

/* A thin tube of half length a[0] and radius a[1], centred at height a[2]: the
 * integral of 2 r h^2 / d^4 along it. */
static struct outcome
tube(struct stage *s, const double *a)
{
    double h = a[2], r2 = h * h + a[0] * a[0];

    stage_open(s, DIVIDED,
               LAMP "cylinder b 0 0 7 %.17g 0 %.17g %.17g 0 %.17g "
                    "%.17g\n",
               -a[0], h, a[0], h, a[1]);
    return (struct outcome){ stage_irradiance(s, origin, up),
                             2 * a[1] * (a[0] / r2 + atan(a[0] / h) / h) };
}

/* A small ball before a mirror wall at distance a[0] and its image: the light
 * of both. */
static struct outcome
mirror_wall(struct stage *s, const double *a)
{
    /* squared distances of the ball and of its image, both 2 up */
    double r = .01, near = 4, far = 4 * a[0] * a[0] + 4;

    stage_open(s, "-dt 0 -dr 1",
               LAMP "sphere b 0 0 4 0 0 2 %.17g\n"
                    "void mirror m 0 0 3 .7 .7 .7\n"
                    "m polygon w 0 0 12 %.17g -9 -9 %.17g -9 9 %.17g 9 9 "
                    "%.17g 9 -9\n",
               r, a[0], a[0], a[0], a[0]);
    return (struct outcome){
        stage_irradiance(s, origin, up),
        M_PI * r * r * (2 / (near * sqrt(near)) + .7 * 2 / (far * sqrt(far)))
    };
}

/* The irradiance that the cap of a sphere gives anywhere else on the inside of
 * that sphere is L cap / (4 R^2), and a disk in its mouth gives the same
 * (a patch of a sphere sees all equal patches of it alike): the mouth has
 * radius a[0], the place is a[1] degrees from the cap's opposite. */
static struct outcome
patch_in_sphere(struct stage *s, const double *a)
{
    double t = radians(a[1]), z = sqrt(1 - a[0] * a[0]);
    double p[3] = { sin(t), 0, -cos(t) }, n[3] = { -sin(t), 0, cos(t) };

    stage_open(s, DIVIDED, LAMP "ring b 0 0 8 0 0 %.17g 0 0 -1 0 %.17g\n", z,
               a[0]);
    return (struct outcome){ stage_irradiance(s, p, n),
                             2 * M_PI * (1 - z) / 4 };
}

/* Areas of what is seen in parallel along y: a ball, a tube and a cone from
 * their sides, a ring that is tilted by 60 degrees. */
static const struct {
    const char *surface;
    double area;
} outline[] = {
    { "sphere b 0 0 4 0 0 0 .9", M_PI * .81 },
    { "cylinder b 0 0 7 -.8 0 .1 .8 0 .1 .3", 1.6 * .6 },
    { "cone b 0 0 8 0 0 -.7 0 0 .7 .8 .2", 1.4 },
    { "ring b 0 0 8 0 0 0 0 -.5 .866025403784438647 .4 .9",
      M_PI *(.81 - .16) / 2 },
};

static struct outcome
silhouette(struct stage *s, const double *a)
{
    int k = (int)a[0];

    stage_open(s, "-ps 1 -pj 1 -x 400 -y 400",
               "void glow g 0 0 4 1 1 1 0\ng %s\n", outline[k].surface);
    return (struct outcome){
        stage_lit_area(s, "VIEW= -vtl -vp 0 -3 0 -vd 0 1 0 -vh 2 -vv 2"),
        outline[k].area
    };
}

const struct row light_rows[] = {
    /* clang-format off */
    { "sphere overhead", sphere, { .5, 2, 0 }, 1e-6 },
    { "sphere at 60 degrees", sphere, { .5, 2, 60 }, 1e-6 },
    { "sphere, far", sphere, { .01, 1000, 30 }, 1e-6 },
    { "disk on its axis", ring, { 0, 1, 0, 2 }, 1e-5 },
    { "disk on its axis, near", ring, { 0, 1, 0, .2 }, 1e-5 },
    { "disk, far", ring, { 0, 1, 0, 100 }, 1e-5 },
    { "disk off its axis", ring, { 0, 1, 1.5, 2 }, 1e-5 },
    { "disk low at the side", ring, { 0, 1, 4, 1 }, 1e-5 },
    { "ring with a hole", ring, { .8, 1, .5, 1 }, 1e-5 },
    { "parallel rectangle", parallel_rectangle, { 1, 2, 1 }, 5e-4 },
    { "parallel rectangle, near", parallel_rectangle, { 1, 2, .2 }, 5e-4 },
    { "standing rectangle", standing_rectangle, { 1, 2, 1 }, 5e-4 },
    { "triangle over a tilted surface", polygon, { 3, -.5, 20 }, 1e-5 },
    { "concave polygon", polygon, { 4, .4, 10 }, 1e-5 },
    { "form factor of coaxial disks", coaxial_disks, { 1, 1, 1 }, 1e-5 },
    { "form factor of unlike disks", coaxial_disks, { .5, 2, 1 }, 1e-5 },
    { "opposite faces of a cube", cube_faces, { 0 }, 5e-4 },
    { "adjacent faces of a cube", cube_faces, { 1 }, 1e-3 },
    { "flux of a point source", flux, { .001 }, 1e-4 },
    { "sun overhead", sun, { .53, 0 }, 1e-5 },
    { "sun at 75 degrees", sun, { .53, 75 }, 1e-5 },
    { "spotlight", spotlight, { 2, 3 }, 1e-4 },
    { "thin tube", tube, { 3, 5e-4, 2 }, 1e-4 },
    { "mirror wall", mirror_wall, { 1.5 }, 1e-6 },
    { "patch in a sphere, opposite", patch_in_sphere, { .5, 0 }, 1e-5 },
    { "patch in a sphere, beside", patch_in_sphere, { .5, 100 }, 1e-5 },
    { "silhouette of a sphere", silhouette, { 0 }, 1e-3 },
    { "silhouette of a cylinder", silhouette, { 1 }, 1e-3 },
    { "silhouette of a cone", silhouette, { 2 }, 1e-3 },
    { "silhouette of a ring", silhouette, { 3 }, 1e-3 },
    { NULL, NULL, { 0 }, 0 }
    /* clang-format on */
};
