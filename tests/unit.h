/* unit.h - unit tests that enter themselves, by Check
 *
 *   TEST(name) { ... }                     a test
 *   LOOP_TEST(name, n) { ... }             n tests: _i is 0, 1, ... n - 1
 *   RANGE_TEST(name, first, end) { ... }   _i is first, first + 1, ... end - 1
 *   FIXTURE(set_up, tear_down)             called before and after each of the
 *                                          tests below it; NULL for none
 *
 * main() is in unit.c.  Tests run in the order of their lines, each in a
 * process of its own unless CK_FORK=no is in the environment; CK_RUN_CASE=name
 * runs that one alone.  */
#ifndef RADD_TESTS_UNIT_H
#define RADD_TESTS_UNIT_H

#include "base/list.h"

#include <check.h>
#include <stdlib.h>

/* Run the tests that were entered, for a main() of a program's own.  Returns
 * the program's status. */
int unit_run(void);

/* What the macros call, before main(). */
void unit_enter(const TTest *test, int first, int end);
void unit_fixture(SFun set_up, SFun tear_down);

/* Constructors of lower priorities run first; those up to 100 are the
 * compiler's. */
#define UNIT_BEFORE_MAIN __attribute__((constructor(1000 + __LINE__)))

#define RANGE_TEST(name, first, end)                                           \
    static const TTest *name;                                                  \
    UNIT_BEFORE_MAIN static void name##_enter(void)                            \
    {                                                                          \
        unit_enter(name, first, end);                                          \
    }                                                                          \
    START_TEST(name)

#define LOOP_TEST(name, n) RANGE_TEST(name, 0, n)
#define TEST(name)         RANGE_TEST(name, 0, 1)

#define FIXTURE(set_up, tear_down)                                             \
    UNIT_BEFORE_MAIN static void fixture_##set_up##_##tear_down(void)          \
    {                                                                          \
        unit_fixture(set_up, tear_down);                                       \
    }

#endif
