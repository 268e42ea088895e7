/* pointstream.h - sensor points from a pipe, as they come
 *
 * Read whenever the loop runs, so also while the coordinator's answers are
 * waited for, and taken in batches.  A batch is of POINTSTREAM_FIRST points,
 * and each that was full makes the next four times as large, up to
 * POINTSTREAM_MOST: so where points come without a pause it is their number
 * alone that cuts them.  A smaller batch is due when nothing has come for a
 * moment, for the writer may wait for its answer, when its first point has
 * waited for long, and at the end. Thread: the loop's. */
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
    uv_timer_t timer;    /* ends a wait */
    bool open, reading;  /* the handles; whether the loop looks */
    struct pointfile in; /* read and not yet taken */
    unsigned char *rest; /* bytes of a point that is not whole */
    size_t nrest;
    uint32_t size;              /* of a full batch */
    uint64_t first_ms, last_ms; /* when points came, of those in .in */
    bool ended;                 /* nothing more comes: */
    struct rad_error end;       /* because of what is wrong behind the points */
};

/* Is standard input a pipe, a socket or a terminal?  A file is read whole. */
bool pointstream_is_one(void);

/* Begin to read standard input.  RAD_ENOMEM, RAD_EIO; *s is to be closed in
 * either case. */
int pointstream_open(struct pointstream *s, const struct pointspec *spec,
                     uv_loop_t *loop, struct rad_error *err);

/* Run the loop until a batch is due, the input has ended, or *wake is not 0. */
void pointstream_wait(struct pointstream *s, const int *wake);

/* The batch, of no points when the input has ended and all were taken.
 * RAD_ENOMEM. */
int pointstream_take(struct pointstream *s, struct pointfile *batch,
                     struct rad_error *err);

/* Points before those that are still in *s. */
uint64_t pointstream_taken(const struct pointstream *s);

void pointstream_close(struct pointstream *s);

#endif
