/* check_quincunx.c - the sampler against a model of it, and in pieces */
#include "config.h"

#include "base/rng.h"
#include "picture/quincunx.h"
#include "tests/unit.h"

#include <math.h>
#include <string.h>

enum { MOST = 256 }; /* columns or rows of a test picture */

/* A picture by formula: a disk, a checkerboard and a ramp, and two distances
 * that meet on a diagonal. */
static struct rad_pixel
formula(int x, int y)
{
    int dx = x - 31, dy = y - 22;
    struct rad_pixel p;

    p.L.r = dx * dx + dy * dy < 225 ? 2 : .1f;
    p.L.g = (x / 16 + y / 16) % 2 ? 1 : .2f;
    p.L.b = 1 + .01f * (float)x + .02f * (float)y;
    p.z = x > y ? 4 : 7;
    return p;
}

/* A picture that is sampled. */
struct picture {
    struct rad_quincunx q;
    struct rad_pixel pixel[MOST][MOST]; /* row, column, from the window's
                                         * upper left */
    int asked[MOST][MOST];              /* how often it was traced */
    double gentle; /* not 0: all differ by chance, up to that times -pt */
    int ntraced;
};

/* A picture about 1, also its distances, with a black channel; no place is like
 * the next. */
static struct rad_pixel
chance(int x, int y, double amplitude)
{
    uint64_t h = rad_mix64((uint64_t)x << 32 | (uint64_t)y);
    struct rad_pixel p = { { 1, 0, 1 }, 1 };

    p.L.r += (float)(amplitude * (double)(h >> 48) * 0x1p-16);
    p.L.b += (float)(amplitude * (double)(h >> 32 & 0xffff) * 0x1p-16);
    p.z += (float)(amplitude * (double)(h >> 16 & 0xffff) * 0x1p-16);
    return p;
}

static void
trace(void *arg, int x, int y, struct rad_pixel *out)
{
    struct picture *p = arg;

    ck_assert(x >= p->q.x0 && x < p->q.x0 + p->q.width);
    ck_assert(y >= p->q.y0 && y < p->q.y0 + p->q.height);
    *out =
        p->gentle > 0 ? chance(x, y, p->gentle * p->q.maxdiff) : formula(x, y);
    if (!p->q.depth)
        out->z = 0;
    else if (p->gentle > 0) /* distances alone differ */
        out->L = rad_grey(0);
    p->asked[y - p->q.y0][x - p->q.x0]++;
    p->ntraced++;
}

static struct picture *
picture_new(int psample, int width, int height, double maxdiff, bool depth)
{
    struct picture *p = calloc(1, sizeof *p);

    ck_assert_ptr_nonnull(p);
    rad_quincunx_steps(psample, &p->q.xstep, &p->q.ystep);
    p->q.width = width;
    p->q.height = height;
    p->q.maxdiff = maxdiff;
    p->q.depth = depth;
    p->q.trace = trace;
    p->q.arg = p;
    return p;
}

static void
rows_of(struct picture *p, int from, int to, struct rad_pixel *rows[])
{
    for (int y = from; y <= to; y++)
        rows[y - from] = p->pixel[y];
}

static void
sample(struct picture *p)
{
    struct rad_pixel *rows[RAD_QUINCUNX_MAX_YSTEP + 1];
    uint8_t *density = malloc(rad_quincunx_ndensity(&p->q) + 1);

    rad_quincunx_start(&p->q, density);
    for (int i = 0; i < rad_quincunx_nbases(&p->q); i++) {
        int y = rad_quincunx_base_row(&p->q, i);

        rad_quincunx_base(&p->q, i, density, p->pixel[y]);
        if (i > 0) {
            rows_of(p, rad_quincunx_base_row(&p->q, i - 1), y, rows);
            rad_quincunx_bar_below(&p->q, i - 1, rows);
        }
    }
    free(density);
}

/* The model: the rules as sentences say them, on coordinates from the lower
 * left corner, without regard to speed. */
struct model {
    struct picture *p;
    int last_found;
};

static struct rad_pixel *
model_at(struct model *m, int x, int y)
{
    return &m->p->pixel[m->p->q.height - 1 - y][x];
}

static void
model_trace(struct model *m, int x, int y)
{
    trace(m->p, m->p->q.x0 + x, m->p->q.y0 + m->p->q.height - 1 - y,
          model_at(m, x, y));
}

static bool
model_far_apart(double a, double b, double tolerance)
{
    return fabs(a - b) > tolerance * fmin(a, b);
}

static bool
model_needs(struct model *m, const struct rad_pixel *a,
            const struct rad_pixel *b)
{
    double t = m->p->q.maxdiff;

    return model_far_apart(a->L.r, b->L.r, t) ||
           model_far_apart(a->L.g, b->L.g, t) ||
           model_far_apart(a->L.b, b->L.b, t) ||
           (m->p->q.depth && fabs(a->z - b->z) > t * ((double)a->z + b->z) / 2);
}

static float
model_between(float a, float b, int k, int n)
{
    return a + (b - a) * (float)k / (float)n;
}

/* Bisect from (x0, y0) to (x1, y1), on a row or a column. */
static int
model_bisect(struct model *m, int x0, int y0, int x1, int y1, int density)
{
    int n = x1 - x0 + y1 - y0, k = n / 2;
    int x = x1 > x0 ? x0 + k : x0, y = y1 > y0 ? y0 + k : y0;
    struct rad_pixel *a = model_at(m, x0, y0), *b = model_at(m, x1, y1);
    struct rad_pixel *c = model_at(m, x, y);
    int found = 0;

    if (n <= 1)
        return 0;
    if (density > 0 || model_needs(m, a, b)) {
        model_trace(m, x, y);
        found++;
    } else {
        c->L.r = model_between(a->L.r, b->L.r, k, n);
        c->L.g = model_between(a->L.g, b->L.g, k, n);
        c->L.b = model_between(a->L.b, b->L.b, k, n);
        c->z = model_between(a->z, b->z, k, n);
    }
    found += model_bisect(m, x0, y0, x, y, density > 0 ? (density - 1) / 2 : 0);
    return found + model_bisect(m, x, y, x1, y1, density / 2);
}

/* One base line; density[k] belongs to the k-th sample of an even line. */
static void
model_base(struct model *m, int i, int y, int *density)
{
    const struct rad_quincunx *q = &m->p->q;
    int found[MOST + 2], k = 0, x = 0, next;

    model_trace(m, 0, y);
    for (; x < q->width - 1; x = next, k++) {
        int most = density[k] > density[k + 1] ? density[k] : density[k + 1];

        next = x + (x == 0 && i % 2 && q->xstep > 1 ? q->xstep / 2 : q->xstep);
        if (next > q->width - 1)
            next = q->width - 1;
        model_trace(m, next, y);
        found[k] = model_bisect(m, x, y, next, y, most / 2);
    }
    if (i % 2) { /* each gap's count is its own */
        memcpy(density, found, (size_t)k * sizeof *density);
    } else { /* the first counts as full, each other has the one before */
        memcpy(density + 1, found, (size_t)k * sizeof *density);
        density[0] = q->xstep;
    }
}

static void
model_sample(struct picture *p)
{
    struct model m = { p, 0 };
    int density[MOST + 4], above = p->q.height - 1;

    for (int k = 0; k < MOST + 4; k++)
        density[k] = p->q.xstep;
    model_base(&m, 0, above, density);
    for (int i = 1; above > 0; i++) {
        int y = above > p->q.ystep ? above - p->q.ystep : 0;
        int found = above - y;

        model_base(&m, i, y, density);
        for (int x = 0; x < p->q.width; x++)
            found = model_bisect(&m, x, y, x, above, found / 2);
        above = y;
    }
}

/* ntraced is what rpict's sampler traced on the same formula. */
static const struct {
    int psample, width, height;
    double maxdiff;
    bool depth;
    int ntraced;
} cases[] = {
    { 1, 64, 48, .05, false, 3072 },     { 2, 64, 48, .05, false, 1557 },
    { 4, 64, 48, .05, false, 897 },      { 4, 64, 48, .05, true, 979 },
    { 4, 61, 47, .2, true, 940 },        { 8, 100, 80, .1, false, 2182 },
    { 16, 200, 130, .017, true, 16005 }, { 5, 3, 9, .05, false, 16 },
    { 6, 1, 40, .05, false, 32 },        { 6, 40, 1, .05, true, 27 },
    { 4, 64, 48, 5, false, 472 },
};

static struct picture *
picture_of(int i)
{
    return picture_new(cases[i].psample, cases[i].width, cases[i].height,
                       cases[i].maxdiff, cases[i].depth);
}

LOOP_TEST(same_pixels_are_traced_as_in_rpict, N_ELEM(cases))
{
    struct picture *p = picture_of(_i);

    sample(p);
    ck_assert_int_eq(p->ntraced, cases[_i].ntraced);
    for (int y = 0; y < p->q.height; y++)
        for (int x = 0; x < p->q.width; x++)
            ck_assert_int_le(p->asked[y][x], 1);
    free(p);
}

static void
compare(const struct picture *a, const struct picture *b)
{
    for (int y = 0; y < a->q.height; y++)
        for (int x = 0; x < a->q.width; x++) {
            const struct rad_pixel *p = &a->pixel[y][x], *m = &b->pixel[y][x];

            ck_assert_msg(a->asked[y][x] == b->asked[y][x],
                          "column %d row %d traced %d times, not %d", x, y,
                          a->asked[y][x], b->asked[y][x]);
            ck_assert_float_eq_tol(p->L.r, m->L.r, 1e-6f);
            ck_assert_float_eq_tol(p->L.g, m->L.g, 1e-6f);
            ck_assert_float_eq_tol(p->L.b, m->L.b, 1e-6f);
            ck_assert_float_eq_tol(p->z, m->z, 1e-5f);
        }
}

LOOP_TEST(sampler_does_as_the_model, N_ELEM(cases))
{
    for (int where = 0; where < 2; where++) {
        struct picture *p = picture_of(_i);
        struct picture *m = picture_of(_i);

        p->q.x0 = m->q.x0 = 17 * where;
        p->q.y0 = m->q.y0 = 5 * where;
        sample(p);
        model_sample(m);
        compare(p, m);
        free(p);
        free(m);
    }
}

static const double limits[] = { .002, .05, .3, 1, 1.2 };

/* Differences about the limit, where those within it are not asked for again
 * further down. */
LOOP_TEST(what_is_about_the_limit_is_as_in_the_model, N_ELEM(limits))
{
    for (int psample = 1; psample <= 16; psample++) {
        bool depth = psample % 3 == 1;
        struct picture *p = picture_new(psample, 97, 64, limits[_i], depth);
        struct picture *m = picture_new(psample, 97, 64, limits[_i], depth);

        p->gentle = m->gentle = .8 + .03 * psample;
        sample(p);
        model_sample(m);
        compare(p, m);
        ck_assert_int_lt(p->ntraced, psample < 3 ? 97 * 64 + 1 : 97 * 64);
        free(p);
        free(m);
    }
}

/* Base line i, gap by gap, with densities handed over no earlier than they are
 * final above and no later than they are needed. */
static void
step_line(struct picture *p, int i, const uint8_t *above, uint8_t *below)
{
    size_t n = rad_quincunx_ndensity(&p->q), given = 0;
    uint8_t *heard = malloc(n + 1);
    struct rad_quincunx_line s;
    struct rad_pixel *line = p->pixel[rad_quincunx_base_row(&p->q, i)];
    int x = 0;

    memset(heard, 255, n + 1);
    rad_quincunx_line_start(&s, &p->q, i, n ? heard : NULL, below, line);
    do {
        size_t final = s.ndensity;

        ck_assert_int_ge(s.x, x);
        x = s.x;
        for (; n && given < n && given < rad_quincunx_line_needs(&s); given++)
            heard[given] = above[given];
        ck_assert_uint_le(final, n);
        if (s.x + p->q.xstep >= p->q.width - 1) /* the rest, for the end */
            for (; given < n; given++)
                heard[given] = above[given];
    } while (rad_quincunx_line_step(&s));
    ck_assert_int_eq(s.x, p->q.width - 1);
    ck_assert_uint_eq(s.ndensity, n);
    free(heard);
}

LOOP_TEST(pieces_give_the_same_as_whole_lines, N_ELEM(cases))
{
    struct picture *whole = picture_of(_i);
    struct picture *p = picture_of(_i);
    struct rad_pixel *rows[RAD_QUINCUNX_MAX_YSTEP + 1];
    uint8_t *density = malloc(2 * (rad_quincunx_ndensity(&p->q) + 1));
    uint8_t *above = density, *below = above + rad_quincunx_ndensity(&p->q) + 1;

    sample(whole);
    rad_quincunx_start(&p->q, above);
    for (int i = 0; i < rad_quincunx_nbases(&p->q); i++) {
        struct rad_quincunx_fill fill = { 0, 0 };
        uint8_t *t = above;

        step_line(p, i, above, below);
        above = below;
        below = t;
        if (i == 0)
            continue;
        rows_of(p, rad_quincunx_base_row(&p->q, i - 1),
                rad_quincunx_base_row(&p->q, i), rows);
        for (int x = 0; x < p->q.width; x += 3)
            rad_quincunx_bar_to(&p->q, i - 1, rows, &fill, x);
        rad_quincunx_bar_to(&p->q, i - 1, rows, &fill, p->q.width);
    }
    ck_assert_int_eq(p->ntraced, whole->ntraced);
    for (int y = 0; y < p->q.height; y++)
        ck_assert_mem_eq(p->pixel[y], whole->pixel[y],
                         (size_t)p->q.width * sizeof p->pixel[y][0]);
    free(density);
    free(p);
    free(whole);
}

static void
trace_flat(void *arg, int x, int y, struct rad_pixel *out)
{
    (void)arg;
    (void)x;
    (void)y;
    *out = (struct rad_pixel){ .z = 1 };
}

/* What lines leave, begun with nothing known at line 1, is what the truth has
 * a few lines on, where there is no detail: to the last, of which no line makes
 * any. */
RANGE_TEST(a_guess_comes_to_the_truth, 2, 17)
{
    enum { LINES = 12 };
    static struct rad_pixel line[MOST];

    for (int width = 1; width < 80; width++) {
        struct rad_quincunx q = { .width = width,
                                  .maxdiff = .05,
                                  .trace = trace_flat };
        uint8_t truth[MOST], guess[MOST];

        rad_quincunx_steps(_i, &q.xstep, &q.ystep);
        q.height = LINES * q.ystep;
        rad_quincunx_start(&q, truth);
        rad_quincunx_guess(&q, guess);
        for (int i = 0; i < LINES; i++) {
            rad_quincunx_base(&q, i, truth, line);
            if (i > 0)
                rad_quincunx_base(&q, i, guess, line);
        }
        ck_assert_mem_eq(truth, guess, rad_quincunx_ndensity(&q));
    }
}

TEST(steps_make_a_lattice_of_ps_by_ps_pixels)
{
    static const int want[][2] = {
        { 1, 1 },  { 3, 1 },   { 4, 2 },   { 6, 3 },  { 7, 4 },  { 8, 4 },
        { 10, 5 }, { 11, 6 },  { 13, 6 },  { 14, 7 }, { 16, 8 }, { 17, 8 },
        { 18, 9 }, { 20, 10 }, { 21, 11 }, { 23, 11 }
    };

    for (int ps = 1; ps <= 16; ps++) {
        int xstep, ystep;

        rad_quincunx_steps(ps, &xstep, &ystep);
        ck_assert_int_eq(xstep, want[ps - 1][0]);
        ck_assert_int_eq(ystep, want[ps - 1][1]);
        ck_assert_int_le(xstep, RAD_QUINCUNX_MAX_XSTEP);
        ck_assert_int_le(ystep, RAD_QUINCUNX_MAX_YSTEP);
    }
}

TEST(base_lines_reach_from_the_first_row_to_the_last)
{
    static const struct {
        int height, n, rows[6];
    } row[] = { { 1, 1, { 0 } },
                { 2, 2, { 0, 1 } },
                { 4, 2, { 0, 3 } },
                { 5, 3, { 0, 3, 4 } },
                { 7, 3, { 0, 3, 6 } } };

    for (int i = 0; i < N_ELEM(row); i++) {
        struct rad_quincunx q = {
            .width = 5, .height = row[i].height, .xstep = 6, .ystep = 3
        };

        ck_assert_int_eq(rad_quincunx_nbases(&q), row[i].n);
        for (int k = 0; k < row[i].n; k++)
            ck_assert_int_eq(rad_quincunx_base_row(&q, k), row[i].rows[k]);
    }
}
