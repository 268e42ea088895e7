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

/* The next pass must be of that rank; it ends at once, done. */
static inline void
expect_pass(struct strict *s, enum strict_rank rank, bool last)
{
    static const struct rad_pixel bottom[64];
    static const uint8_t density[64];
    const struct msg_counts spent = { 0 };
    struct msg_counts total;
    struct strict_pass *p = strict_next(s, STRICT_AHEAD);

    ck_assert_ptr_nonnull(p);
    ck_assert_int_eq(p->rank, rank);
    ck_assert(strict_ended(s, p, true, bottom, density, &spent, &total) ==
              last);
}

static inline struct rad_quincunx
sampler(int width, int height)
{
    struct rad_quincunx q = { .width = width, .height = height };

    rad_quincunx_steps(4, &q.xstep, &q.ystep);
    return q;
}

/* A whole base line of a picture of 64 columns, black. */
static inline void
give_line(struct strict *s, const struct rad_quincunx *q, uint32_t frame,
          uint32_t line)
{
    static const uint8_t pixels[64 * 12], density[64];
    const struct msg_base_line top = { .job = job_id,
                                       .frame = frame,
                                       .line = line,
                                       .n = 64,
                                       .ndensity =
                                           (uint32_t)rad_quincunx_ndensity(q),
                                       .channels = 3,
                                       .density = density,
                                       .pixels = pixels };

    strict_base_line(s, &top);
}

/* The top of line 4. */
static inline void
give_top(struct strict *s, const struct rad_quincunx *q)
{
    give_line(s, q, 0, 3);
}

static inline void
give_flagged(struct strict *s, const struct rad_quincunx *q, uint32_t number,
             int first, int last, uint8_t flags)
{
    uint32_t y = (uint32_t)team_line_row(q, first);
    const struct msg_unit u = { .job = job_id,
                                .unit = number,
                                .attempt = 1,
                                .y = y,
                                .width = 64,
                                .height = (uint32_t)team_line_row(q, last) - y,
                                .mode = MSG_MODE_STRICT,
                                .flags = flags };

    ck_assert_int_eq(strict_unit(s, &u, NULL), 0);
}

static inline void
give_unit(struct strict *s, const struct rad_quincunx *q, uint32_t number,
          int first, int last)
{
    give_flagged(s, q, number, first, last, 0);
}

static inline bool
is_said(struct strict *s, enum msg_type type)
{
    const struct msg *m;

    while ((m = strict_message(s, true)))
        if (m->type == type)
            return true;
    return false;
}

#endif
