/* filter.h - a filter of system calls for the process
 *
 * Where libseccomp cannot allocate it may load a filter that lacks calls, and
 * say nothing. */
#ifndef DAEMON_FILTER_H
#define DAEMON_FILTER_H

#include <seccomp.h>
#include <stdint.h>

/* Put a filter on all threads; with calls that no rule of fill() names the
 * kernel does `otherwise`.  fill() returns 0 or a negative errno, and so does
 * this: -ENOMEM: the filter, if it is on, may lack calls.  */
int filter_put_on(uint32_t otherwise, int (*fill)(scmp_filter_ctx f));

#endif
