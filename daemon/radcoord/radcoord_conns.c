/* radcoord_conns.c - connections to the coordinator, and their roles; see
 * radcoord_impl.h */
#include "config.h"

#include "radcoord/radcoord_impl.h"

#include "net/address.h"
#include "net/log.h"
#include "ground/service.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* --- connections --- */

/* Roles of a local connection: root and the daemon's own user may take any
 * role, other users may be users only. */
static unsigned
roles_of(long uid)
{
    unsigned user = 1u << MSG_ROLE_USER;

    if (uid != 0 && uid != (long)geteuid())
        return user;
    return user | 1u << MSG_ROLE_WORKER | 1u << MSG_ROLE_ADMIN |
           1u << MSG_ROLE_OBSERVER;
}

/* Roles of a key: the key's own, and for an administrator's key the role of a
 * user, too. */
static unsigned
roles_of_key(const struct key *k)
{
    unsigned role = 1u << k->role;

    return k->role == MSG_ROLE_ADMIN ? role | 1u << MSG_ROLE_USER : role;
}

static void
add_conn(struct radcoord *r, uv_stream_t *stream, struct tls *tls,
         const struct coord_peer *who)
{
    uint64_t id = shell_new_id(&r->shell);
    struct conn *c;

    if (!shell_add(&r->shell, id, stream, tls, MSG_AT_COORD_NEW,
                   who->address)) {
        log_err("connection refused peer=%s: out of memory", who->address);
        return;
    }
    coord_opened(r->coord, radcoord_now(r), id, who);
    c = shell_conn(&r->shell, id);
    if (!conn_set_user(c, &r->fair, who->owner))
        conn_break(c, "out of memory");
    shell_run(&r->shell);
}

void
radcoord_on_login(void *arg, uv_stream_t *stream, const char *owner)
{
    struct radcoord *r = arg;
    char peer[ADDRESS_TEXT];
    struct coord_peer who = { .address = peer,
                              .owner = owner,
                              .roles = roles_of(conn_stream_uid(stream)) };

    conn_stream_peer(stream, peer, NULL);
    if (owner) {
        add_conn(r, stream, NULL, &who);
        return;
    }
    log_warn("connection refused peer=%s: its login cannot be found", peer);
    conn_stream_close(stream);
}

/* Take a connection by the Unix socket.  All connections of an embedded
 * coordinator belong to the user who started it. */
static void
on_local(void *arg, uv_stream_t *stream, struct tls *tls, const char *peer)
{
    struct radcoord *r = arg;

    (void)tls;
    if (r->set.common.embedded)
        radcoord_on_login(r, stream, peer);
    else
        owners_local(r->owners, stream);
}

static void
on_keyed(void *arg, uv_stream_t *stream, struct tls *tls, const char *peer)
{
    struct radcoord *r = arg;
    char owner[OWNER_TEXT];
    struct coord_peer who = { .address = peer, .owner = owner };
    struct key k;

    if (!key_id_parse(tls_id(tls), &k)) { /* cannot be: our file has the key */
        tls_free(tls);
        conn_stream_close(stream);
        return;
    }
    owners_of_key(r->owners, &k, owner);
    who.roles = roles_of_key(&k);
    /* workers of an embedded coordinator share one key and choose their names
     */
    if (k.role == MSG_ROLE_WORKER && !r->set.common.embedded) {
        who.name = k.name;
        if (!radcoord_note_key(r, &k, tls_id(tls))) {
            log_err("connection refused peer=%s: out of memory", peer);
            tls_free(tls);
            conn_stream_close(stream);
            return;
        }
    }
    log_debug("connection peer=%s key=%s", peer, tls_id(tls));
    add_conn(r, stream, tls, &who);
}

static const char *
find_key(void *arg, const char *id, uint8_t *secret)
{
    struct radcoord *r = arg;

    return keyring_find(r->keys, id, secret);
}

/* --- sockets --- */

/* Open the Unix socket.  The default path is for the system's coordinator:
 * where it cannot be made, for want of rights or because another coordinator
 * runs, an address to listen at is enough. */
static int
open_local(struct radcoord *r, struct rad_error *err)
{
    struct rad_error why = { 0 };
    struct listener_conf conf = { .fn = on_local,
                                  .handed = r->set.common.embedded,
                                  .arg = r };
    char path[CONF_TEXT + 2];

    /* always a path: "x:80" must not be taken for an address, at which the
     * kernel does not tell the peer's uid */
    snprintf(path, sizeof path, "%s%s", strchr(r->set.socket, '/') ? "" : "./",
             r->set.socket);
    r->local = listener_open(&r->daemon.loop, path, &conf, &why);
    if (r->local)
        return 0;
    if (strcmp(r->set.socket, RADCOORD_SOCKET) != 0 || !r->set.listen[0]) {
        *err = why;
        return why.code;
    }
    log_warn("going on without the default socket: %s", why.what);
    return 0;
}

int
radcoord_listen(struct radcoord *r, struct rad_error *err)
{
    struct listener_conf conf = { .fn = on_keyed,
                                  .find = find_key,
                                  .anywhere = keyring_has_file(r->keys),
                                  .arg = r };
    const char *lines[2];
    int n = 0;

    if (r->set.socket[0] && open_local(r, err) < 0)
        return err->code;
    if (r->local)
        lines[n++] = listener_text(r->local);
    if (r->set.listen[0] && !(r->set.common.embedded &&
                              strcmp(r->set.listen, RADCOORD_LISTEN) == 0)) {
        r->tcp = listener_open(&r->daemon.loop, r->set.listen, &conf, err);
        if (!r->tcp)
            return err->code;
        if (!conf.anywhere)
            log_warn("nobody can come over tcp: there is no key file");
        lines[n++] = listener_text(r->tcp);
    }
    for (int i = 0; i < n; i++)
        log_info("listening on=%s", lines[i]);
    if (r->set.common.ports_file[0])
        return service_ports_file(r->set.common.ports_file, lines, n, err);
    return 0;
}

void
radcoord_refuse_submit(struct radcoord *r, uint64_t id, const struct msg *m,
                       int status, const char *text)
{
    struct conn *c = shell_conn(&r->shell, id);
    struct msg failed = { .type = MSG_FAILED,
                          .request = m->request,
                          .failed = { m->submit.job, (uint16_t)status, text } };

    if (c)
        conn_send(c, &failed);
}
