/* tell.h - what a program prints: a line of its own words with text of others
 *
 * What a terminal would obey in it is made harmless (base/text.h).
 * Thread: any.  */
#ifndef RADD_CLIENT_TELL_H
#define RADD_CLIENT_TELL_H

#include "base/error.h"

#include <stdio.h>

/* The line, without its end in fmt; one above 8 KiB is cut. */
void tell(FILE *to, const char *fmt, ...) __attribute__((format(printf, 2, 3)));

/* Is all that was printed to standard output out?  RAD_EIO. */
int tell_printed(struct rad_error *err);

#endif
