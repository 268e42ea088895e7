/* scratch.h - a folder for the test that runs; it goes with all that is in it
 *
 * For FIXTURE().  All is static: each test program has its own. */
#ifndef RADD_TESTS_SCRATCH_H
#define RADD_TESTS_SCRATCH_H

#include "base/output.h"
#include "tests/unit.h"

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

/* A file of the folder; the name is overwritten by the next call. */
static inline const char *
scratch_file(const char *name, const char *text)
{
    static char path[200];
    FILE *file;

    snprintf(path, sizeof path, "%s/%s", dir, name);
    file = fopen(path, "w");
    ck_assert_ptr_nonnull(file);
    fputs(text, file);
    fclose(file);
    return path;
}

static inline void
scratch_remove(void)
{
    rad_remove_dir(dir);
}

#endif
