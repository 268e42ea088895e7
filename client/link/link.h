/* link.h - a client's connection to the coordinator
 *
 * Its calls block: each runs the caller's loop until what it waits for has
 * come, so the caller's signals and timers go on meanwhile.  The link answers
 * PINGs, sends its own, and fails after 15 s without a byte.  Over TCP both
 * sides first prove that they have the user's key (tls.h).
 *
 * Errors: RAD_EUNAVAIL: the coordinator cannot be reached, or the connection is
 * lost; trying again may help.  RAD_EPERM: the coordinator wants a key that it
 * accepts; or codes of keyfile_load().  RAD_EPROTO: bytes that break the
 * protocol.  The error of a REFUSE.  RAD_ENOMEM.
 * Thread: the loop's. */
#ifndef RADD_CLIENT_LINK_H
#define RADD_CLIENT_LINK_H

#include "proto/message.h"
#include "link/target.h"

#include <uv.h>

struct link;

/* A call that waits returns at once when *wake changes, which a signal handler
 * of the loop may do.  wake must outlive the link. */
struct link_where {
    uv_loop_t *loop;
    const int *wake;
};

/* As uv_loop_init(), which aborts the program where it finds no descriptor for
 * what libuv makes but once.  If work will be queued its threads are started
 * (threads.h), and *first is the loop's until that has run it; else NULL.
 * Without memory libuv ends the program from now on (memory.h).  RAD_ENOMEM:
 * memory or descriptors are short. */
int link_loop_init(uv_loop_t *loop, uv_work_t *first, struct rad_error *err);

/* Run the loop for ms, or until woken. */
void link_pause(const struct link_where *where, uint64_t ms);

/* The role with most rights that this client can have: administrator on a Unix
 * socket; else administrator, user or observer, by the keys in its file. */
enum msg_role link_role(const struct target *to);

/* Connect and send HELLO for the role, within timeout_ms.  RAD_EUNAVAIL also
 * when woken. */
int link_open(struct link **l, const struct link_where *where,
              const struct target *to, enum msg_role role, int timeout_ms,
              struct rad_error *err);

/* Close and free; messages that are queued are lost. */
void link_close(struct link *l);

/* Queue a copy of a message; waits while the queue is long. */
int link_send(struct link *l, const struct msg *m, struct rad_error *err);

/* Get the next message.  Returns 1 and *m, valid until the next call on this
 * link; 0 after timeout_ms or when woken; or an error. */
int link_recv(struct link *l, int timeout_ms, const struct msg **m,
              struct rad_error *err);

/* The code of ours for a status of sysexits.h that came in a message. */
int link_code(unsigned status);

#endif
