/* unit.h - what every unit test's main does */
#ifndef RADD_TESTS_UNIT_H
#define RADD_TESTS_UNIT_H

#include "base/list.h"

#include <check.h>
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

#endif
