/* check_ashik.c - tests of src/shade/gloss/ashik.c: Ashikhmin and Shirley's
 * gloss
 *
 * A square in the plane z = 0 is seen at the origin, in the plane y = 0 from
 * the side of negative x, under one sun that gives 1 W/m^2 across its rays, or
 * under a sky. */
#include "config.h"

#include "square.h"

#include <stdlib.h>

static double
schlick(double r0, double deg)
{
    return r0 + (1 - r0) * pow(1 - cos(RADIANS(deg)), 5);
}

/* Ashikhmin & Shirley 2000, eq. 3 without F, by the angles of the half vector:
 * theta to the normal, phi to u, beta to the light. */
static double
lobe(double eye_deg, double theta_deg, double phi_deg, double u_deg, double nu,
     double nv)
{
    double eye[3], sun[3], h[3], theta, phi, beta;

    direction(eye, eye_deg, 180);
    direction(sun, theta_deg, phi_deg);
    rad_madd(h, eye, 1, sun);
    rad_normalize(h);
    theta = acos(fmin(1, h[2]));
    phi = atan2(h[1], h[0]) - RADIANS(u_deg);
    beta = acos(rad_dot(h, sun));
    return sqrt((nu + 1) * (nv + 1)) / (8 * M_PI * cos(beta)) *
           pow(cos(theta), nu * pow(cos(phi), 2) + nv * pow(sin(phi), 2)) /
           cos(RADIANS(fmin(theta_deg, eye_deg)));
}

static const struct {
    const char *along; /* strings of the material */
    double u_deg;      /* where that is */
    double eye_deg, theta, phi, nu, nv;
} lit[] = {
    { "4 1 0 0 .", 0, 30, 30, 0, 100, 10 }, /* the very top of the lobe */
    { "4 1 0 0 .", 0, 0, 0, 0, 100, 10 },
    { "4 1 0 0 .", 0, 30, 40, 20, 10, 100 },
    { "4 1 0 0 .", 0, 30, 40, 20, 100, 10 },
    { "4 0 1 0 .", 90, 50, 20, 70, 30, 3 },
    { "6 1 0 0 . -rz 30", 30, 80, 45, 10, 20, 5 },
    { "4 1 1 9 .", 45, 20, 60, 140, 0, 8 },
};

LOOP_TEST(one_sun_shows_the_lobe, N_ELEM(lit))
{
    struct rad_rgb L;
    double sun[3], cosine = cos(RADIANS(lit[_i].theta)), base, f;
    char scene[1024];

    direction(sun, lit[_i].theta, lit[_i].phi);
    f = lobe(lit[_i].eye_deg, lit[_i].theta, lit[_i].phi, lit[_i].u_deg,
             lit[_i].nu, lit[_i].nv);
    base = (1 - schlick(0, lit[_i].theta)) / M_PI;
    snprintf(scene, sizeof scene,
             "void ashik2 m %s 0 8 .6 .4 .2 .05 .1 .3 %g %g\n" SQUARE,
             lit[_i].along, lit[_i].nu, lit[_i].nv);
    add_sun(scene, sizeof scene, sun, 1);
    L = see(scene, DIRECT, lit[_i].eye_deg);
    ck_assert_double_eq_tol(
        L.r, (.6 * base + schlick(.05, lit[_i].eye_deg) * f) * cosine,
        1e-5 * L.r);
    ck_assert_double_eq_tol(
        L.b, (.2 * base + schlick(.3, lit[_i].eye_deg) * f) * cosine,
        1e-5 * L.b);
}

/* A direction on the normal, or none: the powers' harmonic mean. */
TEST(power_without_a_direction_is_the_harmonic_mean)
{
    static const char *const along[] = { "0 0 3", "1/0 1 0", "0 0 0" };
    double sun[3], expect = lobe(20, 35, 60, 0, 15, 15);
    char scene[1024];

    direction(sun, 35, 60);
    for (int i = 0; i < N_ELEM(along); i++) {
        snprintf(scene, sizeof scene,
                 "void ashik2 m 4 %s . 0 8 0 0 0 1 1 1 10 30\n" SQUARE,
                 along[i]);
        add_sun(scene, sizeof scene, sun, 1);
        ck_assert_double_eq_tol(see(scene, DIRECT, 20).g,
                                expect * cos(RADIANS(35)), 1e-5);
    }
}

/* In a white sky each sample brings what the gloss reflects toward the eye;
 * with -st the base's ambient light brings it. */
TEST(gloss_keeps_its_energy)
{
    static const double deg[] = { 0, 30, 60, 80 };
    const char *scene =
        "void ashik2 m 4 1 0 0 . 0 8 0 0 0 .2 .3 .4 200 20\n" SQUARE ABOVE;

    for (int i = 0; i < N_ELEM(deg); i++) {
        struct rad_rgb L = see(scene, "-av 0 0 0 -st 0 -lw 0", deg[i]);

        ck_assert_double_eq_tol(L.r, schlick(.2, deg[i]), 1e-6);
        ck_assert_double_eq_tol(L.b, schlick(.4, deg[i]), 1e-6);
        /* nothing diffuse that ambient light could join */
        ck_assert_double_eq(see(scene, "-av 1 1 1 -st 1", deg[i]).g, 0);
    }
    scene = "void ashik2 m 4 1 0 0 . 0 8 .5 .5 .5 .2 .3 .4 200 20\n" SQUARE;
    ck_assert_double_eq_tol(see(scene, "-av 1 1 1 -st 1", 60).g,
                            .5 + schlick(.3, 60), 1e-6);
    ck_assert_double_eq_tol(see(scene, "-av 1 1 1 -st 0", 60).g, .5, 1e-6);
}

/* Mean square of the way along x that half vectors throw the zenith's light:
 * slopes tan(theta) with the density (cos theta)^(p + 1) d omega, p by phi. */
static double
mean_throw(double nu, double nv, int axis)
{
    enum { N = 400 };
    double sum = 0, mass = 0;

    for (int i = 0; i < N; i++)
        for (int k = 0; k < N; k++) {
            double t = (i + .5) * M_PI / 2 / N, p = (k + .5) * 2 * M_PI / N;
            double n = nu * pow(cos(p), 2) + nv * pow(sin(p), 2);
            double w = pow(cos(t), n) * sin(t);
            double x = axis ? sin(p) : cos(p);

            if (t > M_PI / 4)
                continue; /* it goes below the surface */
            sum += w * pow(sin(2 * t) * x, 2);
            mass += w;
        }
    return sum / mass;
}

TEST(samples_follow_the_density_of_half_vectors)
{
    enum { N = 4000 };

    for (int axis = 0; axis < 2; axis++) {
        double expect = mean_throw(200, 10, axis);
        double sum =
            square_spread("void ashik2 m 4 1 0 0 . 0 8 0 0 0 1 1 1 200 10",
                          "-av 0 0 0 -st 0 -lw 0 -ss 0", axis, N);

        /* four deviations of the mean of N squares of nearly a Gaussian */
        ck_assert_double_eq_tol(sum, expect, 4 * sqrt(2. / N) * expect);
    }
}

TEST(bad_powers_are_refused)
{
    struct world w = { 0 };

    ck_assert_int_lt(
        world_try(&w, "void ashik2 m 4 1 0 0 . 0 8 0 0 0 1 1 1 9 -1\n" SQUARE,
                  "", NULL),
        0);
    ck_assert_ptr_nonnull(strstr(w.err.what, "power"));
    world_close(&w);
}
