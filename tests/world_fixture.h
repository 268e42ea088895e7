/* world_fixture.h - the world of a test, closed when that ends */
#ifndef RADD_TESTS_WORLD_FIXTURE_H
#define RADD_TESTS_WORLD_FIXTURE_H

#include "tests/world.h"

static struct world w;

static inline void
world_tear_down(void)
{
    world_close(&w);
}

/* To within the rounding of colours, which are floats. */
static inline void
near(double value, double truth)
{
    ck_assert_double_eq_tol(value, truth, 1e-6 * truth);
}

#endif
