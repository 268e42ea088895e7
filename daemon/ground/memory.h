/* memory.h - libraries that cannot do without memory
 *
 * libuv and libcrypto abort or crash where they cannot allocate, and jansson
 * leaves a member out of an object.  A daemon or client ends instead by
 * log_out_of_memory(): nothing that was acknowledged is lost. */
#ifndef DAEMON_MEMORY_H
#define DAEMON_MEMORY_H

#include <stddef.h>

/* For libuv and libcrypto; to be called before the first use of both. */
void memory_catch(void);

/* As malloc(), for json_set_alloc_funcs(). */
void *memory_need(size_t n);

#endif
