/* scratch.h - a folder for the test that runs; it goes with all that is in it
 *
 * For tcase_add_checked_fixture().  All is static: each test program has its
 * own. */
#ifndef RADD_TESTS_SCRATCH_H
#define RADD_TESTS_SCRATCH_H

#include "base/output.h"
#include "unit.h"

#include <stdio.h>
#include <stdlib.h>

static char dir[64];

static inline void
scratch_make(void)
{
    const char *tmp = getenv("TMPDIR");
    int n = snprintf(dir, sizeof dir, "%s/check.XXXXXX", tmp ? tmp : "/tmp");

    ck_assert_msg(n < (int)sizeof dir, "TMPDIR is too long");
    ck_assert_ptr_nonnull(mkdtemp(dir));
}

static inline void
scratch_remove(void)
{
    rad_remove_dir(dir);
}

#endif
