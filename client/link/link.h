/* link.h - a client's connection to the coordinator
 *
 * Looks synchronous: each call runs the caller's loop until what it waits for
 * is there, so that signals and timers of the caller's go on meanwhile.  The
 * link answers PINGs, sends its own, and fails after 15 s without a byte.
 * Over TCP both sides prove that they have the user's key (tls.h) before a byte
 * of ours is said.
 * Errors: RAD_EUNAVAIL when the coordinator cannot be reached or the connection
 * is lost, which trying again may mend; RAD_EPERM without a key that the
 * coordinator takes, or codes of keyfile_load(); RAD_EPROTO for bytes against
 * the protocol; what a REFUSE says; RAD_ENOMEM. Thread: the loop's.  */
#ifndef RADD_CLIENT_LINK_H
#define RADD_CLIENT_LINK_H

#include "proto/message.h"
#include "link/target.h"

#include <uv.h>

struct link;

/* A waiting call returns at once when *wake changes (a signal handler of the
 * loop's may do so); wake must outlive the link. */
struct link_where {
    uv_loop_t *loop;
    const int *wake;
};

/* The most that a client may hope to be there: an admin on a Unix socket, else
 * an admin, user or observer by the keys of its file. */
enum msg_role link_role(const struct target *to);

/* Connect and say HELLO in the role (an enum msg_role) within timeout_ms.
 * RAD_EUNAVAIL also when woken. */
int link_open(struct link **l, const struct link_where *where,
              const struct target *to, enum msg_role role, int timeout_ms,
              struct rad_error *err);

/* Close and free; messages still in the queue are lost. */
void link_close(struct link *l);

/* Queue a message, whose bytes are copied; waits while much is queued. */
int link_send(struct link *l, const struct msg *m, struct rad_error *err);

/* The next message: 1 and *m, valid until the next call on this link; 0 after
 * timeout_ms or when woken; negative on failure. */
int link_recv(struct link *l, int timeout_ms, const struct msg **m,
              struct rad_error *err);

/* Which of our codes stands for a sysexits.h status in a message. */
int link_code(unsigned status);

#endif
