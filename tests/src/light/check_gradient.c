/* check_gradient.c - gradients and radii of a record, from its hemisphere */
#include "config.h"

#include "light/hemisphere/gradient.h"

#include "arith/elementary.h"
#include "base/vec.h"
#include "tests/lambert.h"
#include "tests/unit.h"

/* --- edges --- */

/* From below it shows its back: lambert() is negative. */
static const double quad[] = { -1, -.5, 1, 2, -.3, 1.2, 1.5, 2, 2, -.4, 1, .8 };

/* Central differences of the closed form; step and tolerance balance their own
 * rounding. */
LOOP_TEST(edge_slopes_match_differences, 3)
{
    static const double place[][3] = { { 0, 0, 0 },
                                       { 3, -1, .2 },
                                       { -9, 4, 0 } };
    const double *p = place[_i];
    struct rad_slope sum = { .grad = { 0 } };
    double axis[3][3], n[3] = { .1, -.2, 1 }, step = 1e-4, corner[4][3];

    rad_normalize(n);
    rad_frame(axis[0], axis[1], n);
    rad_copy(axis[2], n);
    for (int i = 0; i < 4; i++) {
        double a[3];

        rad_sub(a, quad + 3 * i, p);
        for (int k = 0; k < 3; k++)
            corner[i][k] = rad_dot(axis[k], a);
    }
    for (int i = 0; i < 4; i++)
        rad_edge_slope(corner[i], corner[(i + 1) % 4], 1, &sum);
    double E = -lambert(quad, 4, p, n), q[3];
    double scale = fabs(sum.grad[0]) + fabs(sum.grad[1]);

    for (int i = 0, k = 0; i < 2; i++)
        for (int j = i; j < 2; j++, k++) {
            double f[2][2], want;

            for (int s = 0; s < 4; s++) {
                rad_madd(q, p, s & 1 ? step : -step, axis[i]);
                rad_madd(q, q, s & 2 ? step : -step, axis[j]);
                f[s & 1][s >> 1] = -lambert(quad, 4, q, n);
            }
            want = i == j ? (f[1][1] + f[0][0] - 2 * E) / (4 * step * step)
                          : (f[1][1] + f[0][0] - f[0][1] - f[1][0]) /
                                (4 * step * step);
            ck_assert_msg(fabs(sum.hess[k] - want) < 1e-5 * (1 + fabs(want)),
                          "hess %d%d: %g, not %g", i, j, sum.hess[k], want);
            if (i == j) {
                want = (f[1][1] - f[0][0]) / (4 * step);
                ck_assert_msg(fabs(sum.grad[i] - want) < 1e-5 * scale,
                              "grad %d: %g, not %g", i, sum.grad[i], want);
            }
        }
}

TEST(eigenvector_belongs_to_the_larger_value)
{
    static const double m[][3] = { { 2, 0, 1 },   { 1, 0, -2 }, { 1, 3, -2 },
                                   { 0, 1, 0 },   { -5, 2, 1 }, { 4, 0, 4 },
                                   { -1, .1, -3 } };
    double value[2], v[2];

    for (int i = 0; i < N_ELEM(m); i++) {
        rad_eigen2(m[i], value, v);
        ck_assert(fabs(value[0]) >= fabs(value[1]));
        ck_assert_double_eq_tol(m[i][0] * v[0] + m[i][1] * v[1],
                                value[0] * v[0], 1e-12);
        ck_assert_double_eq_tol(m[i][1] * v[0] + m[i][2] * v[1],
                                value[0] * v[1], 1e-12);
        ck_assert_double_eq_tol(value[0] + value[1], m[i][0] + m[i][2], 1e-12);
    }
}

/* --- gradients of a made-up sampling --- */

enum { SIDE = 64 };
static struct rad_hemicell cells[SIDE * SIDE];

/* A hemisphere about the z axis that sees a disk of radiance 1 parallel to the
 * surface, of radius 1, centred at (x, 0, 1), before a far background of
 * radiance `back`. */
static void
look_at_disk(struct rad_hemi *h, double x, float back)
{
    static const double frame[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
    double sum = 0;

    rad_copy(h->u, frame[0]);
    rad_copy(h->v, frame[1]);
    rad_copy(h->w, frame[2]);
    h->n = SIDE;
    h->cell = cells;
    for (int i = 0; i < SIDE; i++)
        for (int j = 0; j < SIDE; j++) {
            struct rad_hemicell *c = &cells[i * SIDE + j];
            double a = 2 * (j + .5) / SIDE - 1, b = 2 * (i + .5) / SIDE - 1;
            double r = fabs(a) > fabs(b) ? a : b;
            double phi = fabs(a) > fabs(b) ? M_PI / 4 * b / a
                                           : M_PI / 2 - M_PI / 4 * a / b;
            double d[3] = { r * cos(phi), r * sin(phi), sqrt(1 - r * r) };
            double hx = d[0] / d[2] - x, hy = d[1] / d[2];
            bool hit = hx * hx + hy * hy < 1;
            double t = hit ? 1 / d[2] : 1e4;

            rad_scale(c->p, t, d);
            c->near = (float)(1 / t);
            c->L = rad_grey(hit ? 1 : back);
            sum += c->L.g;
        }
    h->E = rad_grey((float)(sum * M_PI / (SIDE * SIDE)));
}

static double
disk_irradiance(double x)
{
    return lambert_disk(1, x, 1);
}

LOOP_TEST(gradient_of_a_disk_matches_the_closed_form, 3)
{
    static const double offset[] = { .3, .8, 1.5 };
    double x = offset[_i], step = 1e-3;
    struct rad_gradients g;
    struct rad_hemi h;

    look_at_disk(&h, x, 0);
    rad_hemi_gradients(&h, &g);
    double E = disk_irradiance(x);
    /* the point moves along x, so the disk moves back */
    double want =
        (disk_irradiance(x - step) - disk_irradiance(x + step)) / (2 * step);
    double want2 =
        (disk_irradiance(x - step) + disk_irradiance(x + step) - 2 * E) /
        (step * step);

    ck_assert_double_eq_tol(h.E.g, E, .02 * E);
    ck_assert_msg(fabs(g.move[0] - want / E) < .12 * fabs(want / E),
                  "%g, not %g", g.move[0], want / E);
    ck_assert_double_eq_tol(g.move[1], 0, .02 * fabs(want / E));
    ck_assert_msg(fabs(g.hess[0] - want2 / E) < .15 * fabs(want / E) + .15,
                  "%g, not %g", g.hess[0], want2 / E);
}

/* A black disk before a bright background is the complement. */
TEST(gradient_sees_what_an_occluder_hides)
{
    struct rad_gradients g, g1;
    struct rad_hemi h;

    look_at_disk(&h, .8, 0);
    rad_hemi_gradients(&h, &g);
    double dE = g.move[0] * h.E.g;

    look_at_disk(&h, .8, 2);
    for (int k = 0; k < SIDE * SIDE; k++)
        if (cells[k].L.g == 1)
            cells[k].L = rad_grey(0);
    h.E = rad_grey((float)(2 * (M_PI - disk_irradiance(.8))));
    rad_hemi_gradients(&h, &g1);
    ck_assert_double_eq_tol(g1.move[0] * h.E.g / 2, -dE, .1 * fabs(dE));
}

/* A hemisphere that sees a far sky of radiance 1, and before it in the
 * direction (x, y) a black wall, .25 high and 1.4 wide, at a distance of 1: so
 * low that no ray but those at the horizon meets it. */
static void
look_at_wall(struct rad_hemi *h, double x, double y)
{
    int met = 0;

    look_at_disk(h, 100, 1); /* all sky */
    for (int k = 0; k < SIDE * SIDE; k++) {
        double *p = cells[k].p, ahead = x * p[0] + y * p[1];
        double aside = x * p[1] - y * p[0];

        if (ahead > 0 && fabs(aside) < .7 * ahead && p[2] < .25 * ahead) {
            rad_scale(p, 1 / ahead, p);
            cells[k].near = (float)(1 / sqrt(rad_dot(p, p)));
            cells[k].L = rad_grey(0);
            met++;
        }
    }
    h->E = rad_grey((float)(M_PI * (1 - met / (double)(SIDE * SIDE))));
}

/* The irradiance that the wall takes away at (x, 0, 0), where it is ahead on x.
 */
static double
wall_irradiance(double x)
{
    const double v[] = { 1, -.7, 0, 1, .7, 0, 1, .7, .25, 1, -.7, .25 };
    const double p[3] = { x, 0, 0 }, n[3] = { 0, 0, 1 };

    return fabs(lambert(v, 4, p, n));
}

/* What only the outermost cells meet, as houses are from afar, counts as well:
 * else its zone would reach from a plain into the houses. */
LOOP_TEST(gradient_sees_what_stands_at_the_horizon, 4)
{
    static const double to[][2] = { { 1, 0 }, { 0, 1 }, { -1, 0 }, { 0, -1 } };
    const double *d = to[_i], step = 1e-3;
    int axis = d[0] == 0, hess = 2 * axis;
    struct rad_gradients g;
    struct rad_hemi h;
    double E = wall_irradiance(0), plus = wall_irradiance(step),
           minus = wall_irradiance(-step);
    double slope = -(plus - minus) / (2 * step) / (M_PI - E);
    double bend = -(plus + minus - 2 * E) / (step * step) / (M_PI - E);

    look_at_wall(&h, d[0], d[1]);
    rad_hemi_gradients(&h, &g);
    ck_assert_msg(fabs(d[axis] * g.move[axis] - slope) < .5 * fabs(slope),
                  "%g, not %g", d[axis] * g.move[axis], slope);
    ck_assert_msg(fabs(g.hess[hess] - bend) < .5 * fabs(bend), "%g, not %g",
                  g.hess[hess], bend);
    ck_assert_double_eq_tol(g.move[!axis], 0, .1 * fabs(slope));
}

/* One sample of a lamp that is hardly ever met brightens a record, but must not
 * make its zone much larger. */
TEST(rare_bright_sample_leaves_the_zone_alone)
{
    struct rad_gradients plain, bright;
    struct rad_hemi h;

    look_at_disk(&h, .5, .2f);
    rad_hemi_gradients(&h, &plain);
    cells[SIDE * SIDE / 8].L = rad_grey(SIDE * SIDE);
    h.E = rad_grey(h.E.g + (float)M_PI);
    rad_hemi_gradients(&h, &bright);
    ck_assert(fabs(bright.hess[0]) > .7 * fabs(plain.hess[0]));
    ck_assert(fabs(bright.hess[2]) > .7 * fabs(plain.hess[2]));
}

/* What a lone ray meets before the dark is in no triangle; behind what is near
 * it is in six. */
TEST(lone_light_before_the_dark_is_overlooked)
{
    enum { LONE = SIDE * SIDE / 2 + SIDE / 2 };
    struct rad_gradients g;
    struct rad_hemi h;

    look_at_disk(&h, 100, 0); /* nothing */
    cells[LONE].L = rad_grey(1);
    cells[LONE].near = .5f;
    rad_scale(cells[LONE].p, 2e-4, cells[LONE].p); /* from 1e4 */
    h.E = rad_grey((float)(M_PI / (SIDE * SIDE)));
    rad_hemi_gradients(&h, &g);
    ck_assert(g.overlooked == 1);
    ck_assert(g.hess[0] == 0 && g.hess[2] == 0);

    cells[LONE].near = 1e-5f;
    rad_hemi_gradients(&h, &g);
    ck_assert(g.overlooked == 0);
    ck_assert(g.hess[0] != 0 && g.hess[2] != 0);
}

TEST(uniform_surrounding_has_no_gradient)
{
    struct rad_gradients g;
    struct rad_hemi h;

    look_at_disk(&h, .3, 1);
    rad_hemi_gradients(&h, &g);
    ck_assert(g.move[0] == 0 && g.move[1] == 0);
    ck_assert(g.hess[0] == 0 && g.hess[1] == 0 && g.hess[2] == 0);
    ck_assert_double_eq_tol(g.overlooked, 0, 1e-12);
    ck_assert_double_eq_tol(g.turn[0], 0, 1e-6);
    ck_assert_double_eq_tol(g.turn[1], 0, 1e-6);
}

/* A hemisphere within a sphere of diameter 3 whose surface the point is on. */
static void
look_within_sphere(struct rad_hemi *h)
{
    look_at_disk(h, 100, 1);
    for (int k = 0; k < SIDE * SIDE; k++) {
        double *p = cells[k].p;

        rad_normalize(p);
        cells[k].near = (float)(1 / (3 * p[2]));
        rad_scale(p, 3 * p[2], p);
    }
}

/* All parts of a sphere light a point on it by their area alone. */
TEST(sphere_lights_its_inside_evenly)
{
    struct rad_gradients g;
    struct rad_hemi h;
    double sum = 0;

    look_within_sphere(&h);
    for (int k = 0; k < SIDE * SIDE; k++) {
        cells[k].L = rad_grey((float)(k * k % 7));
        sum += k * k % 7;
    }
    h.E = rad_grey((float)(sum * M_PI / (SIDE * SIDE)));
    rad_hemi_gradients(&h, &g);
    ck_assert(g.move[0] == 0 && g.move[1] == 0);
    ck_assert(g.hess[0] == 0 && g.hess[1] == 0 && g.hess[2] == 0);
    ck_assert(g.turn[0] == 0 && g.turn[1] == 0);
    ck_assert_double_eq_tol(g.overlooked, 0, 1e-12);
}

/* What stands in the sphere counts as ever. */
TEST(body_in_a_sphere_counts_and_light_beside_it_does_not)
{
    struct rad_gradients even, uneven;
    struct rad_hemi h;
    int dark = 0;

    look_within_sphere(&h);
    for (int k = 0; k < SIDE * SIDE; k++)
        if (cells[k].p[0] > .8) {
            rad_scale(cells[k].p, .5, cells[k].p);
            cells[k].near *= 2;
            cells[k].L = rad_grey(0);
            dark++;
        }
    h.E = rad_grey((float)(M_PI * (1 - dark / (double)(SIDE * SIDE))));
    rad_hemi_gradients(&h, &even);
    for (int k = 0; k < SIDE * SIDE; k++)
        if (cells[k].p[0] < -.2)
            cells[k].L = rad_grey(k % 2 ? 1.5f : .5f);
    rad_hemi_gradients(&h, &uneven);
    double bend = fabs(even.hess[0]) + fabs(even.hess[2]);

    ck_assert(even.move[0] < -.1 && bend > 1e-3);
    ck_assert_double_eq_tol(uneven.move[0], even.move[0], .01);
    for (int k = 0; k < 3; k++)
        ck_assert_double_eq_tol(uneven.hess[k], even.hess[k], .02 * bend);
}

/* Half the sky bright, x > 0: turning the normal about y by da toward +x gives
 * E = pi/2 (1 + sin da). */
TEST(turning_toward_the_light_brightens)
{
    struct rad_gradients g;
    struct rad_hemi h;

    look_at_disk(&h, 0, 1);
    for (int k = 0; k < SIDE * SIDE; k++)
        if (cells[k].p[0] < 0)
            cells[k].L = rad_grey(0);
    h.E = rad_grey((float)(M_PI / 2));
    rad_hemi_gradients(&h, &g);
    ck_assert_double_eq_tol(g.turn[1], 1, .01);
    ck_assert_double_eq_tol(g.turn[0], 0, 1e-6);
}

/* Whether a ray happens to graze the horizon hardly changes how E turns. */
TEST(grazing_ray_does_not_rule_the_turn)
{
    double turn[2], before;
    struct rad_hemi h;

    look_at_disk(&h, 0, 1);
    cells[SIDE / 2].L = rad_grey(0); /* on the outermost ring */
    rad_hemi_turn(&h, turn);
    before = rad_hypot(turn[0], turn[1]);
    cells[SIDE / 2].p[2] =
        1e-4 * rad_hypot(cells[SIDE / 2].p[0], cells[SIDE / 2].p[1]);
    rad_hemi_turn(&h, turn);
    ck_assert_double_gt(before, 0);
    ck_assert_double_le(rad_hypot(turn[0], turn[1]), 1.5 * before);
}
