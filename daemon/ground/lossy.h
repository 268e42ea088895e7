/* lossy.h - a queue of frames that may lose its oldest
 *
 * Ambient records on their way to one connection.  A frame goes out while the
 * connection has fewer than LOSSY_WINDOW bytes to write.  Other frames wait in
 * the queue; above LOSSY_MAX bytes the oldest of these are dropped.
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
    size_t queued;      /* bytes of frames that wait */
    size_t outstanding; /* bytes that the connection has to write, other
                         * messages' too */
    uint64_t dropped;   /* frames */
};

void lossy_init(struct lossy *q);
/* Free the frames that wait; the queue is as lossy_init() makes it. */
void lossy_release(struct lossy *q);

/* Queue a copy of a frame; without memory the frame counts as dropped. */
void lossy_put(struct lossy *q, const uint8_t *bytes, size_t len);

/* Count a frame of len bytes as outstanding, if no frame waits and it may go
 * out now; true: the caller sends it. */
bool lossy_pass(struct lossy *q, size_t len);

/* Take the next frame that may go out now, and count it as outstanding.  The
 * caller sends and frees the frame; NULL: there is none. */
struct lossy_frame *lossy_take(struct lossy *q);

/* Count n bytes of other messages that were sent on the connection; n bytes of
 * any that it has written. */
void lossy_sent(struct lossy *q, size_t n);
void lossy_written(struct lossy *q, size_t n);

#endif
