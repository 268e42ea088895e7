/* hours.h - when a machine may be used
 *
 * A text like "mon-fri 19:00-07:00, sat, sun 0-24": ranges of days, times or
 * both, a range of times that ends before it begins going into the next day.
 * Thread: any. */
#ifndef RADD_DAEMON_HOURS_H
#define RADD_DAEMON_HOURS_H

#include "base/error.h"

#include <stdbool.h>
#include <stdint.h>

#define HOURS_MINUTES (7 * 24 * 60)

struct hours {
    uint8_t open[HOURS_MINUTES / 8]; /* bit of each minute from Sunday 0:00 */
};

/* RAD_EUSAGE for a text that is none of these.  Empty: always. */
int hours_parse(const char *text, struct hours *h, struct rad_error *err);

/* weekday: 0 is Sunday, as in struct tm; minute of the day. */
bool hours_open(const struct hours *h, int weekday, int minute);

#endif
