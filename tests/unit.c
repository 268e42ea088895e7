/* unit.c - main() of unit tests */
#include "config.h"

#include "tests/unit.h"

#include <errno.h>
#include <stdbool.h>

static Suite *suite;
static SFun set_up_next, tear_down_next;

void
unit_fixture(SFun set_up, SFun tear_down)
{
    set_up_next = set_up;
    tear_down_next = tear_down;
}

/* A case of its own for each test, so that each can be run alone. */
void
unit_enter(const TTest *test, int first, int end)
{
    TCase *tc;

    setenv("CK_DEFAULT_TIMEOUT", "1800", 0); /* s, for busy machines */
    if (!suite)
        suite = suite_create(program_invocation_short_name);
    tc = tcase_create(test->name);
    tcase_add_checked_fixture(tc, set_up_next, tear_down_next);
    tcase_add_loop_test(tc, test, first, end);
    suite_add_tcase(suite, tc);
}

int
unit_run(void)
{
    SRunner *sr = srunner_create(suite);
    bool passed;

    srunner_run_all(sr, CK_NORMAL);
    /* none ran: CK_RUN_CASE names no test of this program */
    passed = srunner_ntests_run(sr) > 0 && srunner_ntests_failed(sr) == 0;
    srunner_free(sr);
    return passed ? EXIT_SUCCESS : EXIT_FAILURE;
}

/* Weak: a program that does more has its own. */
__attribute__((weak)) int
main(void)
{
    return unit_run();
}
