/* strict_fixture.h - the strict units' machine of one child: units, tops and
 * passes, one at a time
 *
 * Clusters of such machines under many seeds are in tests/sim.  All is static:
 * each test program has its own. */
#ifndef RADD_TESTS_STRICT_FIXTURE_H
#define RADD_TESTS_STRICT_FIXTURE_H

#include "strict/strict_unit.h"
#include "tests/unit.h"

static const uint8_t job_id[MSG_JOB] = { 7 };

/* Pixels, and as bytes; densities, too. */
static const struct rad_pixel black[64];
static const uint8_t zeros[64 * 12];

static struct rad_quincunx q; /* of the picture */
static struct strict *s;
static struct msg_counts spent; /* by the pass that ends next */
static struct msg_counts total; /* of the unit whose last pass ended */

static inline struct rad_quincunx
sampler(int step, int width, int height)
{
    struct rad_quincunx of = { .width = width, .height = height };

    rad_quincunx_steps(step, &of.xstep, &of.ystep);
    return of;
}

/* Begin again, with that picture. */
static inline void
start(struct rad_quincunx picture, bool painted)
{
    strict_free(s);
    q = picture;
    s = strict_new(&q, 1, painted, job_id);
}

static inline void
set_up(void)
{
    s = NULL;
    spent = total = (struct msg_counts){ 0 };
    start(sampler(4, 64, 60), false);
}

static inline void
tear_down(void)
{
    strict_free(s);
}

/* A whole bottom. */
static inline struct team_bottom
bottom_of(const struct rad_pixel *pixels, const uint8_t *density)
{
    return (struct team_bottom){ pixels, density, q.width,
                                 rad_quincunx_ndensity(&q) };
}

/* Whether its unit is over. */
static inline bool
end_pass(struct strict_pass *p, bool done)
{
    const struct team_bottom none = { 0 };

    return strict_ended(s, p, done, &none, &spent, &total);
}

/* The same of a pass whose bottom is black, its densities 0. */
static inline bool
end_black(struct strict_pass *p, bool done)
{
    const struct team_bottom b = bottom_of(black, zeros);

    return strict_ended(s, p, done, &b, &spent, &total);
}

/* The next pass must be of that rank; it ends at once, done. */
static inline void
expect_pass(enum strict_rank rank, bool last)
{
    struct strict_pass *p = strict_next(s, STRICT_AHEAD);

    ck_assert_ptr_nonnull(p);
    ck_assert_int_eq(p->rank, rank);
    ck_assert(end_black(p, true) == last);
}

/* A whole base line of a picture of 64 columns, black. */
static inline void
give_line(uint32_t frame, uint32_t line)
{
    const struct msg_base_line top = { .job = job_id,
                                       .frame = frame,
                                       .line = line,
                                       .n = 64,
                                       .ndensity =
                                           (uint32_t)rad_quincunx_ndensity(&q),
                                       .channels = 3,
                                       .density = zeros,
                                       .pixels = zeros };

    strict_base_line(s, &top);
}

/* The top of line 4. */
static inline void
give_top(void)
{
    give_line(0, 3);
}

static inline void
give_unit(uint32_t number, int first, int last)
{
    uint32_t y = (uint32_t)team_line_row(&q, first);
    const struct msg_unit u = { .job = job_id,
                                .unit = number,
                                .attempt = 1,
                                .y = y,
                                .width = 64,
                                .height = (uint32_t)team_line_row(&q, last) - y,
                                .mode = MSG_MODE_STRICT };

    ck_assert_int_eq(strict_unit(s, &u, NULL), 0);
}

static inline bool
is_said(enum msg_type type)
{
    const struct msg *m;

    while ((m = strict_message(s, true)))
        if (m->type == type)
            return true;
    return false;
}

#endif
