/* peer.h - the other workers of a job, and sending to them
 *
 * Thread: one. */
#ifndef DAEMON_PEER_H
#define DAEMON_PEER_H

#include "worker/wjob.h"

/* The peer of that name, linked or not yet; the same if it is linked; NULL:
 * there is none. */
struct wpeer *peer_named(const struct wjob *job, const char *name);
struct wpeer *peer_linked(const struct wjob *job, const char *name);
/* Send a peer the frame of records in w's scratch, or keep the frame for a
 * while if there is no link yet; kept as in peer_pass_on(). */
void peer_records(struct worker *w, struct wjob *job, struct wpeer *p,
                  uint8_t **kept);
/* Send a peer a message that may not be dropped. */
void peer_send(struct worker *w, struct wjob *job, struct wpeer *p,
               const struct msg *m);
/* Ambient records came from a peer: they go to the child. */
void peer_receive(struct worker *w, struct wjob *job,
                  const struct msg_ambient *m);

/* Dial a peer. */
void peer_dial(struct worker *w, const struct wjob *job, struct wpeer *p);
/* Close the link to a peer, or stop dialling, and forget the peer. */
void peer_free(struct worker *w, struct wjob *job, struct wpeer *peer);
/* Close a connection that is of no use any more. */
void peer_close_conn(struct worker *w, uint64_t conn);

/* Send the frames that wait in the queue, as far as the connection takes them.
 */
void peer_pump(struct worker *w, uint64_t conn, struct lossy *q);
/* Send the frame in w's scratch to a connection.  For several connections pass
 * the same kept: *kept is NULL for the first; do not free it. */
void peer_pass_on(struct worker *w, uint64_t conn, struct lossy *q,
                  uint8_t **kept);

#endif
