/* check_points.c - sensor points: the curves, the layout, the file, the pixels
 */
#include "config.h"

#include "picture/doubt.h"
#include "picture/frame.h"
#include "points/curve.h"
#include "points/points.h"
#include "picture/path.h"
#include "tests/world.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- curves --- */

TEST(square_curve_goes_once_through_all_cells_in_steps_of_one)
{
    enum { BITS = 4, N = 1 << 2 * BITS };
    bool seen[1 << BITS][1 << BITS] = { { false } };
    uint32_t last[2] = { 0, 0 }, at[2];

    for (uint64_t i = 0; i < N; i++) {
        rad_curve_in_square(BITS, i, at);
        ck_assert_uint_lt(at[0], 1 << BITS);
        ck_assert_uint_lt(at[1], 1 << BITS);
        ck_assert(!seen[at[0]][at[1]]);
        seen[at[0]][at[1]] = true;
        if (i > 0)
            ck_assert_int_eq(abs((int)at[0] - (int)last[0]) +
                                 abs((int)at[1] - (int)last[1]),
                             1);
        memcpy(last, at, sizeof at);
    }
    /* so that the next square, below, goes on beside it */
    ck_assert_uint_eq(last[0], (1 << BITS) - 1);
    ck_assert_uint_eq(last[1], 0);
}

static int
by_number(const void *a, const void *b)
{
    const uint64_t *x = a, *y = b;

    return (x[0] > y[0]) - (x[0] < y[0]);
}

/* The cells of a corner of the cube, which the curve begins with. */
TEST(cube_curve_goes_once_through_all_cells_in_steps_of_one)
{
    enum { SIDE = 8, N = SIDE * SIDE * SIDE };
    static uint64_t at[N][2];

    for (uint32_t i = 0; i < N; i++) {
        uint32_t cell[3] = { i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE };

        at[i][0] = rad_curve_in_cube(cell);
        at[i][1] = i;
    }
    qsort(at, N, sizeof at[0], by_number);
    for (uint32_t i = 0; i < N; i++) {
        ck_assert_uint_eq(at[i][0], i);
        if (i > 0) {
            int a = (int)at[i][1], b = (int)at[i - 1][1];

            ck_assert_int_eq(abs(a % SIDE - b % SIDE) +
                                 abs(a / SIDE % SIDE - b / SIDE % SIDE) +
                                 abs(a / SIDE / SIDE - b / SIDE / SIDE),
                             1);
        }
    }
}

/* --- layout and file --- */

static double
chance(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 40) / (1 << 24);
}

static double (*some_points(uint32_t n))[6]
{
    double(*p)[6] = malloc(n * sizeof *p);
    uint64_t state = n;

    ck_assert_ptr_nonnull(p);
    for (uint32_t i = 0; i < n; i++)
        for (int k = 0; k < 6; k++)
            p[i][k] = chance(&state) - (k > 2 ? .5 : 0);
    return p;
}

static const uint32_t sizes[] = { 1,   2,   7,    8,    9,    31,   32,   33,
                                  100, 512, 2049, 4097, 8192, 8193, 70000 };

LOOP_TEST(layout_gives_each_point_a_pixel_of_its_own, N_ELEM(sizes))
{
    uint32_t n = sizes[_i], *pixel = malloc(n * sizeof *pixel);
    double(*p)[6] = some_points(n), org[3], dir[3];
    struct rad_points in;
    struct rad_error err = { 0 };
    bool *taken;
    uint8_t *file;
    int width, height;

    ck_assert_int_eq(
        rad_points_lay((const double(*)[6])p, n, &width, &height, pixel, NULL),
        0);
    ck_assert_int_ge(width * height, (int)n);
    ck_assert_int_le(width * height, (int)n + (int)n / 3 + width);
    taken = calloc((size_t)width * (size_t)height, 1);
    for (uint32_t i = 0; i < n; i++) {
        ck_assert_uint_lt(pixel[i], (uint32_t)(width * height));
        ck_assert(!taken[pixel[i]]);
        taken[pixel[i]] = true;
    }
    file = rad_points_pack((const double(*)[6])p, n, UINT64_C(5000000000),
                           RAD_POINTS_IRRADIANCE, width, height, pixel);
    ck_assert_ptr_nonnull(file);
    ck_assert_msg(
        rad_points_open(&in, file, rad_points_bytes(width, height), &err) == 0,
        "%s", err.what);
    ck_assert_uint_eq(in.n, n);
    ck_assert_uint_eq(in.flags, RAD_POINTS_IRRADIANCE);
    for (uint32_t i = 0; i < n; i++) {
        ck_assert(rad_points_at(&in, (int)pixel[i] % width,
                                (int)pixel[i] / width, org, dir));
        ck_assert_mem_eq(org, p[i], sizeof org);
        ck_assert_mem_eq(dir, p[i] + 3, sizeof dir);
        ck_assert_uint_eq(rad_points_number(&in, (int)pixel[i] % width,
                                            (int)pixel[i] / width),
                          UINT64_C(5000000000) + i);
    }
    for (int i = 0; i < width * height; i++)
        ck_assert(taken[i] ||
                  !rad_points_at(&in, i % width, i / width, org, dir));
    free(file);
    free(taken);
    free(pixel);
    free(p);
}

/* Points of a plane: a block of 8 by 8 pixels is as compact as points can be,
 * where in the order of the input it would be a long stripe. */
TEST(layout_keeps_what_is_near_near)
{
    enum { SIDE = 64, N = SIDE * SIDE };
    static double p[N][6];
    static uint32_t pixel[N], of[4 * N];
    int width, height, blocks = 0;

    for (int i = 0; i < N; i++) {
        p[i][0] = i % SIDE;
        p[i][1] = (double)i / SIDE;
        p[i][5] = 1;
    }
    ck_assert_int_eq(
        rad_points_lay((const double(*)[6])p, N, &width, &height, pixel, NULL),
        0);
    ck_assert_int_le(width * height, 2 * N);
    for (uint32_t i = 0; i < N; i++)
        of[pixel[i]] = i + 1;
    for (int by = 0; by + 8 <= height; by += 8)
        for (int bx = 0; bx + 8 <= width; bx += 8) {
            double lo[2] = { SIDE, SIDE }, hi[2] = { 0, 0 };
            int n = 0;

            for (int k = 0; k < 64; k++) {
                uint32_t i = of[(by + k / 8) * width + bx + k % 8];

                for (int a = 0; a < 2 && i > 0; a++) {
                    lo[a] = fmin(lo[a], p[i - 1][a]);
                    hi[a] = fmax(hi[a], p[i - 1][a]);
                }
                n += i > 0;
            }
            if (n < 64)
                continue;
            blocks++;
            ck_assert_double_le(hi[0] - lo[0], 20);
            ck_assert_double_le(hi[1] - lo[1], 20);
        }
    ck_assert_int_gt(blocks, N / 64 / 2);
}

TEST(points_at_one_place_are_laid_out_too)
{
    double(*p)[6] = some_points(50);
    uint32_t pixel[50];
    int width, height;

    for (int i = 0; i < 50; i++)
        p[i][0] = p[i][1] = p[i][2] = i % 2 ? 1e308 : -1e308;
    ck_assert_int_eq(
        rad_points_lay((const double(*)[6])p, 50, &width, &height, pixel, NULL),
        0);
    ck_assert_int_ge(width * height, 50);
    free(p);
}

/* what is put where in a file of 2 by 1 pixels, and does it still open? */
static const struct {
    size_t at, cut; /* bytes that are missing at the end */
    uint8_t byte;
    bool opens;
} damage[] = {
    { 0, 0, 'r', true },    { 0, 0, 'x', false },      { 8, 0, 4, false },
    { 12, 0, 0, false },    { 12, 0, 3, false },       { 16, 0, 2, false },
    { 19, 0, 255, false },  { 20, 0, 1, false },       { 23, 0, 255, false },
    { 0, 1, 'r', false },   { 0, 52, 'r', false },     { 0, 110, 'r', false },
    { 0, 120, 'r', false }, { 32 + 6, 0, 0xf0, true },
};

LOOP_TEST(damaged_file_is_refused, N_ELEM(damage))
{
    double p[2][6] = { { 1, 2, 3, 0, 0, 1 }, { 4, 5, 6, 0, 1, 0 } };
    uint32_t pixel[2] = { 0, 1 };
    uint8_t *file = rad_points_pack((const double(*)[6])p, 2, 0, 0, 2, 1, pixel);
    struct rad_points in;
    struct rad_error err = { 0 };

    file[damage[_i].at] = damage[_i].byte;
    ck_assert_int_eq(rad_points_open(&in, file,
                                     rad_points_bytes(2, 1) - damage[_i].cut,
                                     &err),
                     damage[_i].opens ? 0 : RAD_EDATA);
    free(file);
}

LOOP_TEST(numbers_that_are_not_finite_are_refused, 6)
{
    double p[2][6] = { { 1, 2, 3, 0, 0, 1 }, { 4, 5, 6, 0, 1, 0 } };
    uint32_t pixel[2] = { 0, 1 };
    struct rad_points in;
    uint8_t *file;

    p[1][_i] = _i % 2 ? NAN : INFINITY;
    file = rad_points_pack((const double(*)[6])p, 2, 0, 0, 2, 1, pixel);
    ck_assert_int_eq(rad_points_open(&in, file, rad_points_bytes(2, 1), NULL),
                     RAD_EDATA);
    free(file);
}

/* --- pixels --- */

/* A disk of radiance 2 at height 3, of radius 4. */
static const char lamp[] = "void light bright 0 0 3 2 2 2\n"
                           "bright ring disk 0 0 8 0 0 3 0 0 -1 0 4\n";

/* All zero before it is opened. */
struct stage {
    struct world w;
    struct rad_points points;
    uint8_t *file;
    struct rad_frame frame;
};

static struct stage s;

static void
stage_close(struct stage *at)
{
    rad_frame_release(&at->frame);
    free(at->file);
    world_close(&at->w);
    memset(at, 0, sizeof *at);
}

static void
tear_down(void)
{
    stage_close(&s);
}

FIXTURE(NULL, tear_down)

static void
stage_open(struct stage *at, const double (*p)[6], uint32_t n, uint64_t first,
           uint32_t flags)
{
    struct rad_error err = { 0 };
    uint32_t pixel[16];

    stage_close(at);
    for (uint32_t i = 0; i < n; i++)
        pixel[i] = i;
    world_open(&at->w, lamp,
               first > 0 ? "-ds .01 -dt 0 -dj 1" : "-ds .01 -dt 0 -dj 0");
    at->file = rad_points_pack(p, n, first, flags, 2, (int)(n + 1) / 2, pixel);
    ck_assert_int_eq(rad_points_open(&at->points, at->file,
                                     rad_points_bytes(2, (int)(n + 1) / 2),
                                     &err),
                     0);
    rad_frame_of_points(&at->frame, at->w.job, &at->points);
}

TEST(pixel_is_radiance_along_its_ray)
{
    /* up, up and long, down, beside the lamp, none */
    const double p[5][6] = { { 0, 0, 0, 0, 0, 1 },
                             { 1, 0, 1, 0, 0, 20 },
                             { 0, 0, 0, 0, 0, -1 },
                             { 5, 0, 0, 0, 0, 1 },
                             { 0, 0, 0, 0, 0, 0 } };
    const double L[6] = { 2, 2, 0, 0, 0, 0 }, z[2] = { 3, 2 };
    struct rad_pixel got;

    stage_open(&s, p, 5, 0, 0);
    for (int i = 0; i < 6; i++) {
        ck_assert_int_eq(
            rad_frame_pixel(&s.frame, &s.w.ctx, i % 2, i / 2, &got), i < 4);
        ck_assert_double_eq_tol((double)got.L.g, L[i], 1e-6);
        if (i < 2)
            ck_assert_double_eq_tol((double)got.z, z[i], 1e-6);
    }
    ck_assert_uint_eq(s.w.ctx.counts.primary_rays, 4);
}

/* At each point the lamp is noise, of which some points say nothing. */
TEST(error_of_points_is_not_told_by_some_of_them)
{
    const double p[2][6] = { { 0, 0, 0, 0, 0, 1 }, { 1, 0, 0, 0, 0, 1 } };

    stage_open(&s, p, 2, 1, RAD_POINTS_IRRADIANCE);
    ck_assert(!(rad_doubt_of_picture(&s.frame).areas > 0));
}

TEST(length_of_direction_limits_a_ray_where_asked)
{
    const double p[2][6] = { { 0, 0, 0, 0, 0, 2.9 }, { 0, 0, 0, 0, 0, 3.1 } };
    struct rad_pixel got;

    stage_open(&s, p, 2, 0, RAD_POINTS_LIMITED);
    rad_frame_pixel(&s.frame, &s.w.ctx, 0, 0, &got);
    ck_assert_double_eq_tol((double)got.L.g, 0, 1e-9);
    rad_frame_pixel(&s.frame, &s.w.ctx, 1, 0, &got);
    ck_assert_double_eq_tol((double)got.L.g, 2, 1e-6);
}

/* Below the middle of a disk of radius R at distance h it is
 * pi L R^2 / (R^2 + h^2). */
TEST(pixel_is_irradiance_on_its_surface)
{
    const double p[3][6] = { { 0, 0, 0, 0, 0, 1 },
                             { 0, 0, 1, 0, 0, 5 },
                             { 0, 0, 0, 0, 0, -1 } };
    const double E[3] = { M_PI * 2 * 16 / 25, M_PI * 2 * 16 / 20, 0 };
    struct rad_pixel got;

    stage_open(&s, p, 3, 0, RAD_POINTS_IRRADIANCE);
    for (int i = 0; i < 3; i++) {
        ck_assert(rad_frame_pixel(&s.frame, &s.w.ctx, i % 2, i / 2, &got));
        ck_assert_double_eq_tol((double)got.L.g, E[i], 2e-3 * E[i] + 1e-9);
    }
}

/* Nor job nor pixel has a say in a point's random numbers. */
TEST(value_goes_by_the_number_of_the_point)
{
    const double p[4][6] = { { 3, 0, 2, 0, 0, 1 },
                             { 3, 0, 2, 0, 0, 1 },
                             { 3, 0, 2, 0, 0, 1 },
                             { 3, 0, 2, 0, 0, 1 } };
    struct stage one = { 0 };
    struct rad_pixel a[4], b;

    stage_open(&s, p, 4, 7, RAD_POINTS_IRRADIANCE);
    for (int i = 0; i < 4; i++)
        rad_frame_pixel(&s.frame, &s.w.ctx, i % 2, i / 2, &a[i]);
    for (int i = 0; i < 4; i++) {
        stage_open(&one, p, 1, 7 + (uint64_t)i, RAD_POINTS_IRRADIANCE);
        rad_frame_pixel(&one.frame, &one.w.ctx, 0, 0, &b);
        ck_assert(a[i].L.g == b.L.g);
        ck_assert(i == 0 || a[i].L.g != a[i - 1].L.g);
        stage_close(&one);
    }
}

/* Paths of the passes leave a place on a surface to the side of its normal. */
TEST(path_begins_on_the_surface)
{
    const double p[1][6] = { { 0, 0, 0, 0, 0, 1 } };
    struct rad_ray r, to;
    int begun = 0, met = 0;

    stage_open(&s, p, 1, 0, RAD_POINTS_IRRADIANCE);
    for (uint64_t i = 0; i < 200; i++) {
        if (!rad_path_begin(&s.frame, &s.w.ctx, 1, i, i, &r))
            continue;
        begun++;
        ck_assert(rad_path_bounce(&s.w.ctx, &r, i, 0, &to));
        ck_assert_double_gt(to.dir[2], 0);
        met += rad_path_meet(&s.w.ctx, &to);
    }
    ck_assert_int_ge(begun, 90); /* one of the two pixels has no point */
    ck_assert_int_le(begun, 110);
    /* 16 of 25 go to the lamp */
    ck_assert_int_ge(met, begun / 2);
    ck_assert_int_le(met, begun * 3 / 4);
}
