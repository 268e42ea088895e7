/* sanitized.h - is this built with a sanitizer that looks at its own process?
 *
 * AddressSanitizer and ThreadSanitizer read /proc, map memory and start threads
 * at any time, so a sandbox has to permit that. */
#ifndef DAEMON_SANITIZED_H
#define DAEMON_SANITIZED_H

#include <stdbool.h>

#ifdef __has_feature
#define RAD_HAS_FEATURE(x) __has_feature(x)
#else
#define RAD_HAS_FEATURE(x) 0
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) ||           \
    RAD_HAS_FEATURE(address_sanitizer) || RAD_HAS_FEATURE(thread_sanitizer)
#define RAD_SANITIZED true
#else
#define RAD_SANITIZED false
#endif

#endif
