/* transfer.h - sends what the store has over connections, piece by piece
 *
 * A source goes out as CHUNKs at the pace of its connection: the next piece
 * is read when little of what was sent before still waits.  Connections are
 * known by the numbers of action.h.
 * Thread: the loop's. */
#ifndef RADD_DAEMON_TRANSFER_H
#define RADD_DAEMON_TRANSFER_H

#include "conn.h"
#include "store.h"

struct transfers;

/* NULL when memory is out. */
struct transfers *transfers_new(struct store *store);
/* When the store is idle. */
void transfers_free(struct transfers *t);

/* Send `from` over c, whose number is id; a FAILED with that request if it
 * cannot be read. */
void transfers_start(struct transfers *t, uint64_t id, struct conn *c,
                     uint32_t request, const struct store_source *from);

/* c has written something: go on. */
void transfers_resume(struct transfers *t, uint64_t id);

/* The connection is gone. */
void transfers_drop(struct transfers *t, uint64_t id);

#endif
