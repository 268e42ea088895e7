/* scarce.h - an allocation of a test program fails
 *
 * For one file of a program.  With a sanitizer, which has its own functions,
 * none fails. */
#ifndef RADD_TESTS_SCARCE_H
#define RADD_TESTS_SCARCE_H

#include "ground/sanitized.h"

#include <errno.h>
#include <stdlib.h>

static long scarce_at; /* so many allocations from now on, one fails; 0: none */

#if !RAD_SANITIZED
extern void *__libc_malloc(size_t n);
extern void *__libc_calloc(size_t n, size_t size);
extern void *__libc_realloc(void *p, size_t n);

static inline int
scarce_now(void)
{
    if (scarce_at == 0 || --scarce_at > 0)
        return 0;
    errno = ENOMEM;
    return 1;
}

void *
malloc(size_t n)
{
    return scarce_now() ? NULL : __libc_malloc(n);
}

void *
calloc(size_t n, size_t size)
{
    return scarce_now() ? NULL : __libc_calloc(n, size);
}

void *
realloc(void *p, size_t n)
{
    return scarce_now() ? NULL : __libc_realloc(p, n);
}
#endif

#endif
