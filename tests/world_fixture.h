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

#endif
