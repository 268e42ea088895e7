/* hours.h - when a machine may be used
 *
 * A text like "mon-fri 19:00-07:00, sat, sun 0-24": items of a range of days, a
 * range of times, or both.  A range of times that ends before it begins goes on
 * into the next day.
 * Thread: any. */
#ifndef RADD_DAEMON_HOURS_H
#define RADD_DAEMON_HOURS_H

#include "base/error.h"

#include <stdbool.h>
#include <stdint.h>

#define HOURS_MINUTES (7 * 24 * 60)

struct hours {
    uint8_t open[HOURS_MINUTES / 8]; /* a bit per minute from Sunday 0:00 */
};

/* Set *h by a text; an empty text means always.  RAD_EUSAGE: it is malformed.
 */
int hours_parse(const char *text, struct hours *h, struct rad_error *err);

/* May the machine be used then?  weekday: 0 is Sunday, as in struct tm.
 * minute: of the day. */
bool hours_open(const struct hours *h, int weekday, int minute);

#endif
