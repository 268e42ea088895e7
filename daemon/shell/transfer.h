/* transfer.h - sends what the store has over connections, piece by piece
 *
 * A source goes out as CHUNKs at the pace of its connection: the next piece
 * is read when little of what was sent before still waits.  Connections are
 * known by the numbers of action.h.
 * Thread: the loop's. */
#ifndef RADD_DAEMON_TRANSFER_H
#define RADD_DAEMON_TRANSFER_H

#include "net/conn.h"
#include "store/store_read.h"

struct transfers;

/* done (or NULL) is called at the end of each transfer whose connection is still
 * there; `whole` is the source if all of it was sent, else NULL.  Returns NULL
 * when memory is out. */
typedef void transfer_done_fn(void *arg, uint64_t id,
                              const struct store_source *whole);
struct transfers *transfers_new(struct store *store, transfer_done_fn *done,
                                void *arg);
/* When the store is idle. */
void transfers_free(struct transfers *t);

/* May a further piece of an answer go over c: little of what was sent before
 * waits, and its user has not too much unread? */
bool transfers_have_room(const struct conn *c);

/* Send `from` over c, whose number is id; a FAILED with that request if it
 * cannot be read. */
void transfers_start(struct transfers *t, uint64_t id, struct conn *c,
                     uint32_t request, const struct store_source *from);

/* c has written something: go on. */
void transfers_resume(struct transfers *t, uint64_t id);

/* Time has passed: what waited for a user to read on other connections may go
 * on. */
void transfers_tick(struct transfers *t);

/* The connection is gone. */
void transfers_drop(struct transfers *t, uint64_t id);

#endif
