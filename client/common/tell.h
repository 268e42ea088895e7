/* tell.h - a line of a program's own words with text of others in it
 *
 * What a terminal would obey in it is made harmless (base/text.h).
 * Thread: any.  */
#ifndef RADD_CLIENT_TELL_H
#define RADD_CLIENT_TELL_H

#include <stdio.h>

/* The line, without its end in fmt; one above 8 KiB is cut. */
void tell(FILE *to, const char *fmt, ...) __attribute__((format(printf, 2, 3)));

#endif
