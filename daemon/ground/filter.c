/* filter.c - see filter.h */
#include "config.h"

#include "ground/filter.h"

#include <errno.h>

int
filter_put_on(uint32_t otherwise, int (*fill)(scmp_filter_ctx f))
{
    scmp_filter_ctx f = seccomp_init(otherwise);
    int rc = f ? seccomp_attr_set(f, SCMP_FLTATR_CTL_TSYNC, 1) : -ENOMEM;

    errno = 0;
    if (rc == 0)
        rc = fill(f);
    if (rc == 0)
        rc = seccomp_load(f);
    if (errno == ENOMEM) /* the library does not tell: it loads what it has */
        rc = -ENOMEM;
    seccomp_release(f);
    return rc;
}
