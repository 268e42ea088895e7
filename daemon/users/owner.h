/* owner.h - whose jobs: one person, by key or by the Unix socket
 *
 * On the socket the kernel says who is there by number, and that user has the
 * name of the login.  Over the network a key says who is there; its name is
 * taken for the login of the same name, but where the map of radcoord.conf
 * (`logins`) has another.  So two ways in are one owner, or, where a key and a
 * login of one name are two people, the map keeps them apart.
 *
 * A user's key never gives the owner that root or the daemon's own user is: a
 * name `user:NAME`, which no login can have, stands for its holder instead.
 *
 * Logins are looked up on a thread of libuv's pool, one at a time, for the
 * database of users may be on another machine; an answer serves for a while.
 * Thread: the loop's. */
#ifndef DAEMON_OWNER_H
#define DAEMON_OWNER_H

#include "net/key/keyfile.h"

#include <uv.h>

#define OWNER_TEXT (MSG_MAX_NAME + 1)

struct owners;

/* The user at the other end of that stream: its login, or "uid:1002" where it
 * has none.  NULL: that cannot be known now.  The stream is
 * the callee's. */
typedef void owners_fn(void *arg, uv_stream_t *stream, const char *owner);

/* NULL when memory is out. */
struct owners *owners_new(uv_loop_t *loop, owners_fn *fn, void *arg);

/* Close the streams that wait.  The loop has then to run out before
 * owners_free(); both accept NULL. */
void owners_close(struct owners *o);
void owners_free(struct owners *o);

/* Is that a map: "KEY=LOGIN, ..." where LOGIN may be "-" for none?
 * RAD_EUSAGE. */
int owners_check_map(const char *map, struct rad_error *err);
/* The map from now on; it was checked, and is copied. */
void owners_set_map(struct owners *o, const char *map);

/* Takes the stream, of a Unix socket: fn is called with it, at once or later.
 */
void owners_local(struct owners *o, uv_stream_t *stream);

/* The owner that a key stands for. */
void owners_of_key(const struct owners *o, const struct key *k,
                   char owner[OWNER_TEXT]);

/* A name as an earlier release kept it: "uid:1002" becomes the login, if it has
 * one; another stays.  Blocks: for the start alone. */
void owners_of_saved(const char *saved, char owner[OWNER_TEXT]);

#endif
