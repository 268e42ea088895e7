/* peer.h - the other workers of a job, and what is sent to them
 *
 * Thread: one. */
#ifndef DAEMON_PEER_H
#define DAEMON_PEER_H

#include "worker/wjob.h"

/* The peer of that name, linked or not yet; NULL: there is none.  And send it a
 * frame of records that is in w's scratch, or keep that for a while until it is
 * linked.  *kept is NULL for the first of several who are sent the same. */
struct wpeer *peer_named(const struct wjob *job, const char *name);
void peer_records(struct worker *w, struct wjob *job, struct wpeer *p,
                  uint8_t **kept);
/* The peer of that name, but for one that should have called by now. */
struct wpeer *peer_awaited(const struct worker *w, const struct wjob *job,
                           const char *name);
/* The peer of that name, if there is a link to it; else NULL. */
struct wpeer *peer_linked(const struct wjob *job, const char *name);
/* Send it what may not be dropped. */
void peer_send(struct worker *w, struct wjob *job, struct wpeer *p,
               const struct msg *m);
/* The same for records from elsewhere; they count as come in. */
void peer_receive(struct worker *w, struct wjob *job,
                  const struct msg_ambient *m);
void peer_feed_child(struct worker *w, struct wjob *job);

/* Dial it. */
void peer_dial(struct worker *w, const struct wjob *job, struct wpeer *p);
/* Close the link to it, or stop dialling, and forget it. */
void peer_free(struct worker *w, struct wjob *job, struct wpeer *peer);
/* Close a connection that says nothing that is wanted any more. */
void peer_close_conn(struct worker *w, uint64_t conn);

/* Send what waits, as far as the connection takes it. */
void peer_pump(struct worker *w, uint64_t conn, struct lossy *q);
/* Send the frame in w's scratch to one connection, or to several: *kept is NULL
 * for the first, and freed by nobody. */
void peer_pass_on(struct worker *w, uint64_t conn, struct lossy *q,
                  uint8_t **kept);

#endif
