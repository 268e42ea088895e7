/* tool.h - what the programs here that time the renderer share; before it is
 * included TOOL is the program's name */
#ifndef RADD_BENCH_TOOL_H
#define RADD_BENCH_TOOL_H

#include "base/error.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

/* Processor time of this process [s]. */
static inline double
now(void)
{
    struct timespec ts;

    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &ts);
    return (double)ts.tv_sec + 1e-9 * (double)ts.tv_nsec;
}

static inline _Noreturn void
die_of(const char *what)
{
    fprintf(stderr, TOOL ": %s\n", what);
    exit(EXIT_FAILURE);
}

static inline _Noreturn void
die(const struct rad_error *err)
{
    char text[600];

    rad_error_format(err, text, sizeof text);
    die_of(text);
}

#endif
