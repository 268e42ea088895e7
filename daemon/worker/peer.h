/* peer.h - the other workers of a job, and sending to them
 *
 * Thread: radd's loop. */
#ifndef DAEMON_PEER_H
#define DAEMON_PEER_H

#include "worker/wjob.h"

/* The peer of that name, NULL: there is none; peer_linked() only if it is
 * linked. */
struct wpeer *peer_named(const struct wjob *job, const char *name);
struct wpeer *peer_linked(const struct wjob *job, const char *name);
/* Send a peer the message of records in w->actions.scratch, or keep it until
 * the link is up; kept as in peer_pass_on(). */
void peer_records(struct worker *w, struct wjob *job, struct wpeer *p,
                  uint8_t **kept);
/* Send a peer a message that may not be dropped. */
void peer_send(struct worker *w, struct wjob *job, struct wpeer *p,
               const struct msg *m);
/* Give the child ambient records that a peer sent. */
void peer_receive(struct worker *w, struct wjob *job,
                  const struct msg_ambient *m);

/* Dial a peer. */
void peer_dial(struct worker *w, const struct wjob *job, struct wpeer *p);
/* Close the link to a peer, or stop dialling, and forget the peer. */
void peer_free(struct worker *w, struct wjob *job, struct wpeer *peer);
/* Close a connection that is of no use any more. */
void peer_close_conn(struct worker *w, uint64_t conn);

/* Send what waits in the queue, as far as the connection takes it. */
void peer_pump(struct worker *w, uint64_t conn, struct lossy *q);
/* Send the message in w->actions.scratch to a connection.  *kept is NULL before
 * the first of several connections that get this message, and set for the
 * others; it belongs to the actions. */
void peer_pass_on(struct worker *w, uint64_t conn, struct lossy *q,
                  uint8_t **kept);

#endif
