/* owner.h - the owner of jobs: one person, by key or by the Unix socket
 *
 * An owner is a login's name.  On the Unix socket the kernel tells the number
 * of the user at the other end, whose login is looked up.  Over the network a
 * key has a name, which stands for the login of the same name, unless the map
 * of radcoord.conf (`logins`) gives the key another login or none.  So a person
 * is one owner by either way; and where a key and a login of one name belong to
 * two people, the map keeps them apart.
 *
 * Only an administrator's key can stand for root or for the daemon's own user.
 * Any other key that would, an observer's key, and a key that the map gives no
 * login have an owner of their own: the key's role and name, `user:NAME`, which
 * no login can be.
 *
 * Logins are looked up on a thread of libuv's pool, one at a time, for the
 * database of users may be on another machine.  An answer serves for a minute.
 * Thread: the loop's, but for owners_of_saved(). */
#ifndef DAEMON_OWNER_H
#define DAEMON_OWNER_H

#include "net/key/key.h"

#include <uv.h>

#define OWNER_TEXT (MSG_MAX_NAME + 1)

struct owners;

/* Called with the owner at the other end of a stream: the user's login, or
 * "uid:1002" if the user has none; NULL: the database of users fails, too many
 * streams wait or memory is out.  Takes the stream. */
typedef void owners_fn(void *arg, uv_stream_t *stream, const char *owner);

/* fn and arg serve owners_local().  NULL: memory is out. */
struct owners *owners_new(uv_loop_t *loop, owners_fn *fn, void *arg);

/* Close the streams that wait for a login.  The loop has to run out before
 * owners_free(); both accept NULL. */
void owners_close(struct owners *o);
void owners_free(struct owners *o);

/* Check a map: "KEY=LOGIN, ...", where LOGIN "-" stands for none.  RAD_EUSAGE:
 * it is malformed. */
int owners_check_map(const char *map, struct rad_error *err);
/* Use a checked map from now on; copies it. */
void owners_set_map(struct owners *o, const char *map);

/* Take a stream of the Unix socket and find its owner: fn is called, at once or
 * later. */
void owners_local(struct owners *o, uv_stream_t *stream);

/* Set owner to the owner that a key stands for. */
void owners_of_key(const struct owners *o, const struct key *k,
                   char owner[OWNER_TEXT]);

/* Set owner to an owner's name as an earlier release kept it: "uid:1002"
 * becomes the login of that user, if there is one; any other name stays.  Waits
 * for the database of users, so call it at the start alone. */
void owners_of_saved(const char *saved, char owner[OWNER_TEXT]);

#endif
