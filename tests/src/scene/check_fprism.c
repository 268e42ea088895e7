/* check_fprism.c - tests of src/scene/calc/calcprism.c: light through panes of
 * prisms
 */
#include "config.h"

#include "scene/calc/calc.h"
#include "tests/unit.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A pane, as arguments 1 to 10. */
struct pane {
    double a, b, c, d, index, least, face, metal, together, source;
};

/* fprism_val(what, side, rank) for a ray in direction dir that looks for a
 * source in direction aim, or NULL. */
static double
value(const struct pane *pane, const double dir[3], const double *aim, int what,
      int side, int rank, enum rad_calc_fault *fault)
{
    double channel[RAD_CALC_NCHANNELS] = { dir[0], dir[1], dir[2] };
    struct rad_calc_input in = { channel, &pane->a, 10 };
    struct rad_calc *c = rad_calc_new(NULL);
    struct rad_calc_env *env;
    char text[80];
    double v;
    int at;

    ck_assert_ptr_nonnull(c);
    rad_calc_offer(c, RAD_CALC_OFFER_AIM);
    snprintf(text, sizeof text, "fprism_val(%d,%d,%d)", what, side, rank);
    at = rad_calc_expression(c, rad_calc_context(c, ".", NULL), text, NULL);
    ck_assert_int_ge(at, 0);
    if (aim)
        memcpy(channel + RAD_CALC_AIM, aim, 3 * sizeof *aim);
    env = rad_calc_env_new(c);
    ck_assert_ptr_nonnull(env);
    rad_calc_begin(env, &in);
    v = rad_calc_eval(c, at, env, fault);
    rad_calc_env_free(env);
    rad_calc_free(c);
    return v;
}

static double
sound(const struct pane *pane, const double dir[3], int what, int side,
      int rank)
{
    enum rad_calc_fault fault;
    double v = value(pane, dir, NULL, what, side, rank, &fault);

    ck_assert_int_eq(fault, RAD_CALC_SOUND);
    return v;
}

/* Fresnel's reflectances in and across the plane of incidence, by angles. */
static void
fresnel(double n, double i, double R[2])
{
    double t = asin(sin(i) / n);

    if (i == 0) {
        R[0] = R[1] = pow((n - 1) / (n + 1), 2);
        return;
    }
    R[0] = pow(tan(i - t) / tan(i + t), 2);
    R[1] = pow(sin(i - t) / sin(i + t), 2);
}

/* Ribs without height are a slab: (1 - R)/(1 + R) passes, and goes on as it
 * came. R is the mean of both polarizations, for their shares are not followed.
 */
TEST(level_pane_is_a_slab)
{
    static const double angle[] = { 0, .3, .9, 1.3 };
    const struct pane slab = { 1, 2, 0, 0, 1.5, 1e-9, 4, 0, 1e-3, 0 };

    for (int k = 0; k < N_ELEM(angle); k++)
        for (int turn = 0; turn < 3; turn++) {
            double s = sin(angle[k]), R[2], T;
            double dir[3] = { cos(angle[k]), s * cos(turn), s * sin(turn) };

            fresnel(1.5, angle[k], R);
            T = (2 - R[0] - R[1]) / (2 + R[0] + R[1]);
            ck_assert_double_eq_tol(sound(&slab, dir, 3, 1, 1), T, 1e-7);
            for (int axis = 0; axis < 3; axis++)
                ck_assert_double_eq_tol(sound(&slab, dir, axis, 1, 1),
                                        dir[axis], 1e-12);
            /* both the reflected and the passed ray, the stronger first */
            ck_assert_double_eq_tol(sound(&slab, dir, 3, 0, 1) +
                                        sound(&slab, dir, 3, 0, 2),
                                    1, 1e-7);
        }
}

/* Straight onto the flat side: the ribs' sides, inclined by atan(d/a) and
 * atan(d/b), refract each its part of the light by Snell's law. */
TEST(ribs_refract_by_snell)
{
    const struct pane ribs = { 3, 1, 0, .2, 1.5, 1e-6, 4, 0, 1e-9, 0 };
    const double dir[3] = { 1, 0, 0 };
    double tilt[2] = { atan(.2 / 3), atan(.2) }, part[2] = { .75, .25 };

    for (int k = 0; k < 2; k++) {
        double in[2], out[2], turned = asin(1.5 * sin(tilt[k])) - tilt[k];

        fresnel(1.5, 0, in);
        fresnel(1 / 1.5, tilt[k], out);
        ck_assert_double_eq_tol(
            sound(&ribs, dir, 3, 1, k + 1),
            part[k] * (1 - in[0]) * (1 - (out[0] + out[1]) / 2), 1e-9);
        ck_assert_double_eq_tol(sound(&ribs, dir, 0, 1, k + 1), cos(turned),
                                1e-12);
        ck_assert_double_eq_tol(sound(&ribs, dir, 1, 1, k + 1),
                                (k ? 1 : -1) * sin(turned), 1e-12);
        ck_assert_double_eq_tol(sound(&ribs, dir, 2, 1, k + 1), 0, 1e-12);
    }
}

/* All that comes out, passed and thrown back, is what came in, but for what a
 * metallic side keeps. */
TEST(energy_is_kept)
{
    static const double dirs[][3] = {
        { 1, 0, 0 },    { 1, .7, .1 }, { 1, -2, .5 },
        { -1, .1, .2 }, { -1, 1, 1 },  { -.2, -1, .3 },
    };
    static const struct pane panes[] = {
        { 1, 2, 0, 1.5, 1.49, 1e-7, 4, 0, .2, 0 },
        { 1, 1, 0, 1, 1.6, 1e-7, 1, 1, .2, 0 },
        { 1, 1, 0, 1, 1.6, 1e-7, 2, .5, .2, 0 },
    };

    for (int p = 0; p < N_ELEM(panes); p++)
        for (int k = 0; k < N_ELEM(dirs); k++) {
            double sum = 0;

            for (int rank = 1; rank <= 40; rank++)
                sum += sound(&panes[p], dirs[k], 3, 0, rank);
            if (p < 2)
                ck_assert_double_eq_tol(sum, 1, 1e-4);
            else
                ck_assert_double_le(sum, 1 + 1e-9);
        }
}

/* To a source, only what goes there counts; the second way then has the first
 * of these, for each way has an image of its own. */
TEST(rays_to_a_source_are_found)
{
    const struct pane ribs = { 3, 1, 0, .2, 1.5, 1e-6, 4, 0, 1e-9, .01 };
    const double dir[3] = { 1, 0, 0 };
    double turned = asin(1.5 * sin(atan(.2))) - atan(.2);
    double aim[3] = { cos(turned), sin(turned) + .001, 0 };
    enum rad_calc_fault fault;

    for (int rank = 1; rank <= 2; rank++) {
        ck_assert_double_eq_tol(value(&ribs, dir, aim, 1, 1, rank, &fault),
                                sin(turned), 1e-12);
        ck_assert_double_gt(value(&ribs, dir, aim, 3, 1, rank, &fault), .2);
    }
    ck_assert_double_eq(value(&ribs, dir, aim, 3, 1, 3, &fault), 0);
    aim[1] = .5; /* nothing goes there */
    ck_assert_double_eq(value(&ribs, dir, aim, 3, 1, 1, &fault), 0);
}

/* There is no such ray: none, straight ahead. */
TEST(missing_ray_has_no_energy)
{
    const struct pane slab = { 1, 2, 0, 0, 1.5, 1e-9, 4, 0, 1e-3, 0 };
    const double along[3] = { 0, 1, 0 }, dir[3] = { 1, 0, 0 };

    ck_assert_double_eq(sound(&slab, dir, 3, 1, 9), 0);
    ck_assert_double_eq(sound(&slab, dir, 0, 1, 9), 1);
    for (int what = 0; what < 4; what++)
        ck_assert_double_eq(sound(&slab, along, what, 1, 1), 0);
}

static const struct {
    struct pane pane;
    int what;
} bad[] = {
    { { -1, 2, 0, 1, 1.5, .01, 4, 0, .1, 0 }, 3 },
    { { 1, 2, 0, -1, 1.5, .01, 4, 0, .1, 0 }, 3 },
    { { 1, 2, 0, 1, .9, .01, 4, 0, .1, 0 }, 3 },
    { { 1, 2, 0, 1, 1.5, 1, 4, 0, .1, 0 }, 3 },
    { { 1, 2, 0, 1, 1.5, .01, 3, 0, .1, 0 }, 3 },
    { { 1, 2, 0, 1, 1.5, .01, 1, 2, .1, 0 }, 3 },
    { { 1, 2, 0, 1, 1.5, .01, 4, 0, 0, 0 }, 3 },
    { { 1, 2, 0, 1, 1.5, .01, 4, 0, .1, -1 }, 3 },
    { { 1, 2, 0, 1, 1.5, .01, 4, 0, .1, 0 }, 4 },
    { { NAN, 2, 0, 1, 1.5, .01, 4, 0, .1, 0 }, 3 },
};

LOOP_TEST(what_is_no_pane_is_a_fault, N_ELEM(bad))
{
    const double dir[3] = { 1, 0, 0 };
    enum rad_calc_fault fault;

    value(&bad[_i].pane, dir, NULL, bad[_i].what, 1, 1, &fault);
    ck_assert_int_eq(fault, RAD_CALC_MATH);
}

/* However little is too little, and however near is the same, it ends. */
TEST(work_is_bounded)
{
    const struct pane endless = { 1, 1, 0, 1e-3, 3, 0, 1, 1, 1e-300, 0 };
    const double dir[3] = { 1, 3, 2 };

    ck_assert_double_le(sound(&endless, dir, 3, 0, 1), 1);
}

TEST(other_types_do_not_have_it)
{
    struct rad_calc *c = rad_calc_new(NULL);
    struct rad_error err = { 0 };

    ck_assert_int_eq(rad_calc_expression(c, rad_calc_context(c, ".", NULL),
                                         "fprism_val(3,1,1)", &err),
                     RAD_EDATA);
    ck_assert_ptr_nonnull(strstr(err.what, "'fprism_val'"));
    rad_calc_free(c);
}
