/* check_estimate.c - random pixels that tell what a part of a picture costs */
#include "config.h"

#include "picture/estimate.h"
#include "ground/sanitized.h"

#include "pool_fixture.h"

#include <malloc.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <sysexits.h>
#include <unistd.h>

enum { WIDTH = 64, HEIGHT = 48 };

/* --- which pixels --- */

static const struct rad_window parts[] = { { 0, 0, 1, 1 },   { 5, 7, 2, 1 },
                                           { 3, 1, 17, 5 },  { 0, 0, 64, 64 },
                                           { 0, 9, 65, 63 }, { 100, 0, 1, 97 },
                                           { 0, 3, 480, 3 } };

LOOP_TEST(an_order_has_each_pixel_once, N_ELEM(parts))
{
    const struct rad_window *w = &parts[_i];
    int n = w->width * w->height;
    uint8_t *seen = calloc((size_t)n, 1);

    for (int i = 0; i < n; i++) {
        int x, y;

        rad_estimate_pixel(7, 1, w, (uint32_t)i, &x, &y);
        ck_assert_int_ge(x, w->x);
        ck_assert_int_lt(x, w->x + w->width);
        ck_assert_int_ge(y, w->y);
        ck_assert_int_lt(y, w->y + w->height);
        seen[(y - w->y) * w->width + x - w->x]++;
    }
    for (int i = 0; i < n; i++)
        ck_assert_uint_eq(seen[i], 1);
    free(seen);
}

/* Is the first half of an order that of another seed, frame or place? */
static bool
same_order(uint64_t seed, uint32_t frame, struct rad_window w, int dx, int dy)
{
    const struct rad_window first = { 0, 0, 40, 3 };
    int same = 0;

    for (uint32_t i = 0; i < 60; i++) {
        int x0, y0, x, y;

        rad_estimate_pixel(1, 0, &first, i, &x0, &y0);
        rad_estimate_pixel(seed, frame, &w, i, &x, &y);
        same += x == x0 + dx && y == y0 + dy;
    }
    return same > 10; /* of 60, where chance gives half a one */
}

TEST(seed_frame_and_part_decide)
{
    ck_assert(same_order(1, 0, (struct rad_window){ 0, 0, 40, 3 }, 0, 0));
    ck_assert(!same_order(2, 0, (struct rad_window){ 0, 0, 40, 3 }, 0, 0));
    ck_assert(!same_order(1, 1, (struct rad_window){ 0, 0, 40, 3 }, 0, 0));
    ck_assert(!same_order(1, 0, (struct rad_window){ 0, 3, 40, 3 }, 0, 3));
    ck_assert(!same_order(1, 0, (struct rad_window){ 8, 0, 40, 3 }, 8, 0));
    ck_assert(!same_order(1, 0, (struct rad_window){ 0, 0, 40, 4 }, 0, 0));
}

/* Chi squared of counts that should be equal. */
static double
chi_squared(const int *count, int n, double expected)
{
    double sum = 0;

    for (int i = 0; i < n; i++)
        sum += (count[i] - expected) * (count[i] - expected) / expected;
    return sum;
}

/* Over many parts, first pixels, and pairs of first and second, fall as chance
 * would have them: chi squared of n - 1 freedoms is below n + 5 sqrt(2 n) but
 * once in a million. */
TEST(first_pixels_are_spread_evenly)
{
    enum { SIDE = 8, PARTS = 25600, CELLS = SIDE * SIDE };
    int first[CELLS] = { 0 }, second[CELLS] = { 0 }, step[CELLS] = { 0 };

    for (int part = 0; part < PARTS; part++) {
        struct rad_window w = { 0, SIDE * part, SIDE, SIDE };
        int x, y, x1, y1;

        rad_estimate_pixel(0, 0, &w, 0, &x, &y);
        rad_estimate_pixel(0, 0, &w, 1, &x1, &y1);
        y -= w.y;
        y1 -= w.y;
        first[y * SIDE + x]++;
        second[y1 * SIDE + x1]++;
        step[(y1 - y + SIDE) % SIDE * SIDE + (x1 - x + SIDE) % SIDE]++;
    }
    ck_assert_double_lt(chi_squared(first, CELLS, (double)PARTS / CELLS),
                        CELLS + 57);
    ck_assert_double_lt(chi_squared(second, CELLS, (double)PARTS / CELLS),
                        CELLS + 57);
    ck_assert_int_eq(step[0], 0); /* never the same pixel again */
    ck_assert_double_lt(
        chi_squared(step + 1, CELLS - 1, (double)PARTS / (CELLS - 1)),
        CELLS + 57);
}

/* --- what they cost --- */

static const char scene_text[] =
    "void light lamp 0 0 3 60 60 60\n"
    "lamp sphere bulb 0 0 4 2 -2 4 .4\n"
    "void plastic red 0 0 5 .6 .3 .2 .02 .05\n"
    "red sphere ball 0 0 4 0 0 1 1\n"
    "void plastic grey 0 0 5 .4 .4 .4 0 0\n"
    "grey polygon floor 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0\n";

static void
on_rows(void *arg, const struct pool_rows *r)
{
    (void)arg;
    (void)r;
    ck_abort_msg("no unit was given");
}

static struct estimate *done;
static double done_s; /* how long it took */

static void
on_estimated(void *arg, struct estimate *e, double wall_s)
{
    (void)arg;
    ck_assert_ptr_null(done);
    done = e;
    done_s = wall_s;
}

/* A fish-eye shows nothing in its corners. */
static void
open_pool(const char *options, bool depth, int threads)
{
    pool_open(scene_text, options,
              "-vth -vp 0 -6 2 -vd 0 1 -.2 -vh 180 -vv 180", depth, threads,
              on_rows);
    ck_assert_int_eq(f.frame.width, WIDTH);
    ck_assert_int_eq(f.frame.height, HEIGHT);
}

static void
tear_down(void)
{
    estimate_free(done);
    done = NULL;
    pool_close();
}

FIXTURE(NULL, tear_down)

static const char usual[] =
    "--seed=3 -x 64 -y 48 -pa 0 -ab 0 -ps 6 -pt .05 -pj .67";

TEST(more_pixels_than_there_are_is_all_of_them)
{
    static struct rad_sampled out[1000];
    const struct rad_window part = { 20, 20, 8, 5 };
    const struct rad_estimate_order order = { part, 0, 1000, NULL };
    struct rad_estimate cost = { 0 };
    size_t n;

    open_pool(usual, false, 1);
    n = rad_estimate_trace(&f.frame, &f.w.ctx, &order, &cost, out);
    rad_estimate_sort(out, n);
    ck_assert_uint_eq(n, 40);
    for (size_t i = 0; i < n; i++) { /* in order, and as they are */
        struct rad_pixel p;

        ck_assert_int_eq(out[i].x, part.x + (int)i % 8);
        ck_assert_int_eq(out[i].y, part.y + (int)i / 8);
        rad_frame_pixel(&f.frame, &f.w.ctx, out[i].x, out[i].y, &p);
        ck_assert_mem_eq(&p.L, &out[i].pixel.L, sizeof p.L);
    }
    ck_assert_uint_eq(2 * cost.rays, f.w.ctx.counts.rays);
    ck_assert_uint_eq(2 * cost.tests, f.w.ctx.counts.geom.tests);
    ck_assert_uint_gt(cost.tests, 0);
}

/* Lines of the frame: the base line and the bar above it. */
static uint32_t
lines_of_frame(struct msg_area *area)
{
    struct rad_quincunx q = { .width = WIDTH, .height = HEIGHT };
    int n, row = 0;

    rad_quincunx_steps(6, &q.xstep, &q.ystep);
    n = rad_quincunx_nbases(&q);
    for (int i = 0; i < n; i++) {
        int base = rad_quincunx_base_row(&q, i);

        area[i] = (struct msg_area){ 0, 0, (uint32_t)row, WIDTH,
                                     (uint32_t)(base - row + 1) };
        row = base + 1;
    }
    return (uint32_t)n;
}

static void
make_estimate(uint32_t rays, const struct msg_area *areas, uint32_t n)
{
    struct msg_estimate m = {
        .id = 9, .rays = rays, .nareas = n, .areas = areas
    };
    struct rad_error err = { 0 };
    struct estimate *e = estimate_new(&f.frame, 1, &m, &err);

    ck_assert_msg(e != NULL, "%s", err.what);
    ck_assert(pool_estimate(f.pool, e, on_estimated));
    while (!done)
        uv_run(&f.loop, UV_RUN_ONCE);
}

static const struct {
    int threads;
    uint32_t rays;
    bool depth;
} runs[] = { { 1, 5, false }, { 3, 20, true }, { 2, 500, false } };

/* Rays are as those of one context.  So are tests of one thread; a context's
 * memory of what hid the last light may spare others some. */
LOOP_TEST(threads_count_what_one_counts, N_ELEM(runs))
{
    static struct rad_sampled out[WIDTH * HEIGHT];
    struct msg_area areas[HEIGHT];
    struct msg_estimated got;
    uint64_t tests = 0;
    uint32_t n = lines_of_frame(areas);

    open_pool(usual, runs[_i].depth, runs[_i].threads);
    make_estimate(runs[_i].rays, areas, n);
    estimate_result(done, &got);
    ck_assert_uint_eq(got.id, 9);
    ck_assert_uint_eq(got.ncosts, n);
    for (uint32_t i = 0; i < n; i++) {
        const struct rad_estimate_order order = {
            { (int)areas[i].x, (int)areas[i].y, (int)areas[i].width,
              (int)areas[i].height },
            .n = runs[_i].rays
        };
        struct rad_estimate cost = { 0 };

        rad_estimate_trace(&f.frame, &f.w.ctx, &order, &cost, out);
        ck_assert_uint_eq(got.costs[i].rays, cost.rays);
        if (runs[_i].threads == 1)
            ck_assert_uint_eq(got.costs[i].tests, cost.tests);
        tests += got.costs[i].tests;
    }
    ck_assert_uint_eq(got.counts.rays, f.w.ctx.counts.rays);
    ck_assert_uint_eq(got.counts.intersection_tests, tests);
    ck_assert_uint_gt(tests, 0);
    ck_assert_uint_eq(got.counts.estimate_rays, f.w.ctx.counts.primary_rays);
    ck_assert_uint_eq(got.counts.primary_rays, 0);
    ck_assert_double_ge(got.counts.cpu_s, 0);
    ck_assert_double_gt(done_s, 0);
    ck_assert_double_gt(pool_tally(f.pool).busy_s, 0);
}

/* Where ambient values are kept other pixels come first, which pay for most of
 * them and are not counted; all are facts, each once, though an area has less
 * than twice as many. */
TEST(ambient_values_are_made_before_rays_are_counted)
{
    const struct msg_area areas[2] = { { 0, 24, 20, 16, 4 },
                                       { 0, 30, 30, 3, 2 } };
    struct msg_estimated got;
    const struct msg_facts *m;
    uint32_t pixels = 0;

    open_pool(
        "--seed=3 -x 64 -y 48 -pa 0 -ab 1 -aa .2 -ar 32 -ad 256 -as 0 -ps 6 "
        "-pt .05 -pj .67",
        false, 1);
    make_estimate(4, areas, 2);
    while ((m = estimate_facts(done)))
        pixels += m->npixels;
    ck_assert_uint_eq(pixels, 4 + 4 + 6);
    estimate_result(done, &got);
    ck_assert_uint_eq(got.counts.estimate_rays, 4 * 4);
    ck_assert_uint_gt(got.counts.ambient_values, 1);
    ck_assert_uint_ge(got.costs[0].rays, 4);
    ck_assert_uint_ge(got.costs[1].rays, 4);
    ck_assert_uint_lt(2 * (got.costs[0].rays + got.costs[1].rays),
                      got.counts.rays);
}

/* What a FACTS says, put where it belongs; false for what is there already. */
static void
unpack_facts(const struct msg_facts *m, float picture[HEIGHT][WIDTH][4],
             bool known[HEIGHT][WIDTH])
{
    struct rad_quincunx q = { .width = WIDTH, .height = HEIGHT };
    const uint8_t *p = m->pixels;
    uint32_t n = 0, stride = (m->width + 7) / 8;
    int top;

    rad_quincunx_steps(6, &q.xstep, &q.ystep);
    top = m->line > 0 ? rad_quincunx_base_row(&q, (int)m->line - 1) + 1 : 0;
    ck_assert_uint_eq(m->width, WIDTH);
    ck_assert_uint_eq(m->flags, MSG_FACTS_ESTIMATE);
    ck_assert_uint_eq(m->channels, f.frame.depth ? 4 : 3);
    ck_assert_int_le(top + (int)(m->row + m->rows) - 1,
                     rad_quincunx_base_row(&q, (int)m->line));
    for (uint32_t r = 0; r < m->rows; r++)
        for (uint32_t x = 0; x < m->width; x++) {
            int y = top + (int)(m->row + r);

            if (!(m->bitmap[r * stride + x / 8] >> x % 8 & 1))
                continue;
            ck_assert(!known[y][x]);
            known[y][x] = true;
            wire_floats_get(picture[y][x], p, m->channels);
            p += m->channels * sizeof(float);
            n++;
        }
    ck_assert_uint_eq(n, m->npixels);
}

LOOP_TEST(pixels_come_back_as_facts, N_ELEM(runs))
{
    static float picture[HEIGHT][WIDTH][4];
    static bool known[HEIGHT][WIDTH];
    struct msg_area areas[HEIGHT];
    struct msg_estimated got;
    struct msg_facts *m;
    uint64_t n = 0;

    memset(known, 0, sizeof known);
    open_pool(usual, runs[_i].depth, runs[_i].threads);
    make_estimate(runs[_i].rays, areas, lines_of_frame(areas));
    while ((m = estimate_facts(done)))
        unpack_facts(m, picture, known);
    ck_assert_ptr_null(estimate_facts(done));
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            struct rad_pixel p;

            rad_frame_pixel(&f.frame, &f.w.ctx, x, y, &p);
            if (!known[y][x])
                continue;
            n++;
            ck_assert_mem_eq(picture[y][x], &p.L, 3 * sizeof(float));
            if (runs[_i].depth)
                ck_assert_mem_eq(&picture[y][x][3], &p.z, sizeof(float));
        }
    estimate_result(done, &got);
    ck_assert_uint_eq(n, got.counts.estimate_rays);
    ck_assert_uint_gt(n, 0);
    if (runs[_i].rays == 500) /* all that the fish-eye shows */
        ck_assert_uint_eq(n, f.w.ctx.counts.primary_rays);
}

/* Areas need not be lines: each message is about one line all the same. */
TEST(facts_of_any_area_are_told_line_by_line)
{
    static float picture[HEIGHT][WIDTH][4];
    static bool known[HEIGHT][WIDTH];
    const struct msg_area area = { 0, 20, 10, 16, 20 };
    struct msg_facts *m;
    int n = 0, told = 0;

    memset(known, 0, sizeof known);
    open_pool(usual, false, 2);
    make_estimate(1000, &area, 1);
    for (; (m = estimate_facts(done)); told++)
        unpack_facts(m, picture, known);
    for (int y = 10; y < 30; y++)
        for (int x = 20; x < 36; x++)
            n += known[y][x];
    ck_assert_int_eq(n, 16 * 20);
    ck_assert_int_ge(told, 20 / 4); /* -ps 6 has a base line every 4 rows */
}

TEST(an_estimate_of_nothing_is_answered)
{
    struct msg_estimated got;

    open_pool(usual, false, 2);
    make_estimate(5, NULL, 0);
    estimate_result(done, &got);
    ck_assert_uint_eq(got.ncosts, 0);
    ck_assert_ptr_null(estimate_facts(done));
}

TEST(a_pool_ends_with_an_estimate_under_way)
{
    struct msg_area areas[HEIGHT];
    struct msg_estimate m = { .rays = 1000,
                              .nareas = lines_of_frame(areas),
                              .areas = areas };

    open_pool(usual, false, 2);
    ck_assert(pool_estimate(f.pool, estimate_new(&f.frame, 1, &m, NULL),
                            on_estimated));
}

/* Make an estimate of one area, or the facts of one, without memory for its
 * pixels. */
static void
estimate_in_shortage(bool facts)
{
    static const struct rlimit none;
    const struct msg_area all = { 0, 0, 0, WIDTH, HEIGHT };
    const struct msg_estimate m = { .rays = WIDTH * HEIGHT,
                                    .nareas = 1,
                                    .areas = &all };
    struct estimate *e;
    void *volatile taken; /* lest the compiler leaves its memory out */

    mallopt(M_MMAP_THRESHOLD, 1 << 14); /* less than the pixels take */
    open_pool(usual, false, 1);
    if (facts)
        make_estimate(m.rays, &all, 1);
    e = facts ? done : estimate_new(&f.frame, 1, &m, NULL);
    setrlimit(RLIMIT_DATA, &none);
    do /* nor any that former tests have freed */
        taken = malloc(1 << 14);
    while (taken);
    if (facts)
        estimate_facts(e);
    else if (pool_estimate(f.pool, e, on_estimated))
        while (!done)
            uv_run(&f.loop, UV_RUN_ONCE);
}

/* The process that is short of memory ends, and is no crash. */
LOOP_TEST(a_shortage_of_memory_is_told_as_one, 2)
{
    int status;
    pid_t pid;

    if (RAD_SANITIZED) /* which ends the process itself */
        return;
    pid = fork();
    if (pid == 0) {
        estimate_in_shortage(_i);
        _exit(EX_OK);
    }
    ck_assert_int_eq(waitpid(pid, &status, 0), pid);
    ck_assert_msg(WIFEXITED(status) && WEXITSTATUS(status) == EX_OSERR,
                  "status %#x", (unsigned)status);
}

static const struct {
    struct msg_area area;
    uint32_t rays;
    const char *what;
} bad[] = {
    { { 1, 0, 0, 4, 4 }, 5, "frame 1, of 1" },
    { { 0, 61, 0, 4, 4 }, 5, "outside the picture" },
    { { 0, 0, 45, 4, 4 }, 5, "outside the picture" },
    { { 0, 0, 0, 0, 4 }, 5, "outside the picture" },
    { { 0, UINT32_MAX, 0, 4, 4 }, 5, "outside the picture" },
    { { 0, 0, 0, 4, 4 }, ESTIMATE_MOST_RAYS + 1, "at most 10000" },
};

LOOP_TEST(areas_outside_are_refused, N_ELEM(bad))
{
    struct msg_estimate m = { .rays = bad[_i].rays,
                              .nareas = 1,
                              .areas = &bad[_i].area };
    struct rad_error err = { 0 };

    open_pool(usual, false, 1);
    ck_assert_ptr_null(estimate_new(&f.frame, 1, &m, &err));
    ck_assert_int_eq(err.code, RAD_EPROTO);
    ck_assert_msg(strstr(err.what, bad[_i].what) != NULL, "%s", err.what);
}
