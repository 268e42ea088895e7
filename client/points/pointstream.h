/* pointstream.h - sensor points from a pipe, as they come
 *
 * The pipe is read whenever the loop runs, also while the coordinator's answers
 * are awaited.  Points are taken in batches.  The first has POINTSTREAM_FIRST
 * points, and after each full batch the next is four times as large, up to
 * POINTSTREAM_MOST.  So if points come without a pause, batches depend on their
 * number alone.  A smaller batch is due if nothing has come for a moment, for
 * the writer may wait for its answers, and sooner where it asks for them; if
 * its first point has waited for long; and at the end.
 * Thread: the loop's. */
#ifndef RADD_CLIENT_POINTSTREAM_H
#define RADD_CLIENT_POINTSTREAM_H

#include "points/pointfile.h"
#include "points/pointspec.h"

#include <uv.h>

#define POINTSTREAM_FIRST 1024u
#define POINTSTREAM_MOST  (1u << 20)

struct pointstream {
    uv_loop_t *loop;
    uv_poll_t poll;
    uv_timer_t timer;    /* ends pointstream_wait()'s turn */
    bool open, reading;  /* open: handles exist; reading: stdin is polled */
    struct pointfile in; /* points that were read and not taken */
    unsigned char *rest; /* bytes of an incomplete point */
    size_t nrest;
    uint32_t size;              /* of a full batch */
    uint32_t flush;             /* see pointspec_flush() */
    uint64_t first_ms, last_ms; /* when the first and last points in .in came */
    bool ended;                 /* nothing more comes */
    struct rad_error end;       /* code 0, or what ended it */
};

/* Is standard input a pipe, a socket or a terminal?  A file is read as a whole.
 */
bool pointstream_is_one(void);

/* Begin to read standard input.  RAD_ENOMEM, RAD_EIO; *s must be closed in any
 * case. */
int pointstream_open(struct pointstream *s, const struct pointspec *spec,
                     uv_loop_t *loop, struct rad_error *err);

/* Milliseconds until the points that were read are due as a batch if no more
 * come; 0: now.  There must be some. */
uint64_t pointstream_due_in(const struct pointstream *s);

/* Run the loop until a batch is due, the input has ended, or *wake is not 0. */
void pointstream_wait(struct pointstream *s, const int *wake);

/* Take a batch.  It has no points if the input has ended and all were taken.
 * RAD_ENOMEM. */
int pointstream_take(struct pointstream *s, struct pointfile *batch,
                     struct rad_error *err);

void pointstream_close(struct pointstream *s);

#endif
