/* listing.h - lists of any length, a page at a time
 *
 * A page is limited in rows and in bytes, so that neither the loop's turn nor
 * the answer grows with the list.  A page's cursor is a number that a job got
 * when it was submitted, or a worker when it first came.  So the next page goes
 * on from there, whichever jobs or workers come, go or change meanwhile.
 * Pure: reads the coordinator's state and changes nothing.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_LISTING_H
#define DAEMON_LISTING_H

#include "desk/desk.h"

#define LISTING_ROWS  200       /* most rows of a page */
#define LISTING_BYTES (1 << 18) /* no row begins after so many bytes */

/* The answer to a PAGE as malloc'd text; NULL: memory is out.  owner: name of
 * the user who asks. */
char *listing_page(const struct coord *c, const struct msg_page *m,
                   const char *owner);

#endif
