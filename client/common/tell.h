/* tell.h - print a line that may hold foreign text
 *
 * Characters that a terminal would obey are made harmless (base/text.h).
 * Thread: any. */
#ifndef RADD_CLIENT_TELL_H
#define RADD_CLIENT_TELL_H

#include "base/error.h"

#include <stdio.h>

/* Print a line; fmt has no newline.  More than 8 KiB are cut. */
void tell(FILE *to, const char *fmt, ...) __attribute__((format(printf, 2, 3)));

/* Print a line of our own to the FILE. */
void tell_line(void *to, const char *text);

/* Flush standard output.  RAD_EIO: some of what was printed is lost. */
int tell_printed(struct rad_error *err);

#endif
