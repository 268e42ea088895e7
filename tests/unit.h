/* unit.h - what every unit test's main does */
#ifndef RADD_TESTS_UNIT_H
#define RADD_TESTS_UNIT_H

#include "base/list.h"

#include <check.h>
#include <errno.h>
#include <stdlib.h>

/* Run a suite; CK_FORK=no in the environment keeps it in one process. */
static inline int
unit_run(Suite *s)
{
    SRunner *sr = srunner_create(s);
    int failed;

    srunner_run_all(sr, CK_NORMAL);
    failed = srunner_ntests_failed(sr);
    srunner_free(sr);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

/* The same of a program's only test case: the suite has the program's name. */
static inline int
unit_run_case(TCase *tc)
{
    Suite *s = suite_create(program_invocation_short_name);

    suite_add_tcase(s, tc);
    return unit_run(s);
}

#endif
