/* transfer.h - send files and pictures of the store over connections, piece by
 * piece
 *
 * A source goes out as CHUNKs at the pace of its connection: the next piece is
 * read when few of the bytes before it still wait to be sent.  Connections are
 * known by the numbers of action.h.
 * Thread: the loop's. */
#ifndef RADD_DAEMON_TRANSFER_H
#define RADD_DAEMON_TRANSFER_H

#include "net/conn.h"
#include "store/store_read.h"

struct transfers;

/* done (or NULL) is called at the end of each transfer whose connection is
 * still there; `whole` is the source if all of it was sent, else NULL.
 * transfers_new(): NULL: memory is out. */
typedef void transfer_done_fn(void *arg, uint64_t id,
                              const struct store_source *whole);
struct transfers *transfers_new(struct store *store, transfer_done_fn *done,
                                void *arg);
/* Called when all were dropped and the store is idle. */
void transfers_free(struct transfers *t);

/* May a further piece of an answer go over c: do few bytes wait to be sent, and
 * has its user not too much unread? */
bool transfers_have_room(const struct conn *c);

/* Send `from` over c, whose number is id; if it cannot be read, FAILED with
 * that request; of a scene's file, an empty file.  A file of a scene that waits
 * already until it is sent over c is sent once. */
void transfers_start(struct transfers *t, uint64_t id, struct conn *c,
                     uint32_t request, const struct store_source *from);

/* Call fn for each file of a job that is being sent, or waits to be sent. */
void transfers_of_jobs(const struct transfers *t,
                       void (*fn)(void *with, const uint8_t job[MSG_JOB]),
                       void *with);

/* The connection has sent some bytes: go on with its transfers. */
void transfers_resume(struct transfers *t, uint64_t id);

/* Time has passed: transfers that waited until their user read answers on other
 * connections may go on. */
void transfers_tick(struct transfers *t);

/* Do not send files of scenes over the connection that have not begun: their
 * job is over. */
void transfers_drop_files(struct transfers *t, uint64_t id);

/* The connection is gone: end its transfers; or all connections go. */
void transfers_drop(struct transfers *t, uint64_t id);
void transfers_drop_all(struct transfers *t);

#endif
