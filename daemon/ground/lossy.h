/* lossy.h - a queue of frames that may lose its oldest
 *
 * Ambient records on their way to one connection.  At most LOSSY_WINDOW bytes
 * are with the connection; what waits behind them is kept up to LOSSY_MAX, and
 * then the oldest goes.
 * Thread: one. */
#ifndef DAEMON_LOSSY_H
#define DAEMON_LOSSY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define LOSSY_WINDOW ((size_t)1 << 20)
#define LOSSY_MAX    ((size_t)8 << 20)

struct lossy_frame {
    struct lossy_frame *next;
    size_t len;
    uint8_t bytes[];
};

struct lossy {
    struct lossy_frame *head, **tail;
    size_t queued;      /* bytes that wait */
    size_t outstanding; /* bytes that the connection has, these and others */
    uint64_t dropped;   /* frames */
};

void lossy_init(struct lossy *q);
/* What waits is gone, and the queue as it was at first. */
void lossy_release(struct lossy *q);

/* Queue a copy; a frame that there is no memory for counts as dropped. */
void lossy_put(struct lossy *q, const uint8_t *bytes, size_t len);

/* May a frame of that length go out now, past the queue?  Then it counts as
 * outstanding. */
bool lossy_pass(struct lossy *q, size_t len);

/* The next frame that may go out now, or NULL; the caller frees it.  It counts
 * as outstanding. */
struct lossy_frame *lossy_take(struct lossy *q);

/* Other bytes were sent on the same connection; n bytes were written out. */
void lossy_sent(struct lossy *q, size_t n);
void lossy_written(struct lossy *q, size_t n);

#endif
