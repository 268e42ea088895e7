/* listing.h - lists of any length, a page at a time
 *
 * A page has a bound in rows and in bytes, so that neither the loop nor the
 * answer knows how long the list is.  Its cursor is the number that a job got
 * when it was submitted, or a worker when it first came: it says where to go on
 * whatever comes, goes and changes its priority meanwhile.
 * Pure: reads the coordinator's state and changes nothing.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_LISTING_H
#define DAEMON_LISTING_H

#include "desk/desk.h"

#define LISTING_ROWS  200       /* most of one page */
#define LISTING_BYTES (1 << 18) /* and where no further row begins */

/* The answer to a PAGE, as malloc'd text; owner is the asker.  NULL when memory
 * is out. */
char *listing_page(const struct coord *c, const struct msg_page *m,
                   const char *owner);

#endif
