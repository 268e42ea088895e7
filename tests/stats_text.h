/* stats_text.h - a job's statistics, whole */
#ifndef RADD_TESTS_STATS_TEXT_H
#define RADD_TESTS_STATS_TEXT_H

#include "registry/stats.h"
#include "tests/unit.h"

/* malloc'd */
static inline char *
stats_text(const struct job *job, uint64_t now_ms)
{
    struct stats_text *t = stats_begin(job, now_ms);

    ck_assert_ptr_nonnull(t);
    ck_assert_int_eq(stats_more(t, job, UINT32_MAX), 1);
    return stats_take(t);
}

#endif
