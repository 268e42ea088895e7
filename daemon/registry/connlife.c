/* connlife.c - see connlife.h
 *
 * A connection has a number from the shell, and a session, which says which
 * messages may come.  The roles that it may have are known when it opens; its
 * HELLO chooses a role.  A worker has one connection: a new connection by the
 * worker's name replaces the old one. */
#include "config.h"

#include "registry/connlife.h"

#include "desk/desk.h"
#include "desk/verdict.h"
#include "net/address.h"
#include "net/key/key.h"
#include "registry/telling.h"
#include "sched/loss.h"
#include "users/uploads.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define MOST_THREADS 4096 /* of a worker, by its HELLO */

static const char crowded[] =
    "too many connections of this user: close some, or try again later (limit "
    "user_connections)";

/* Free a connection that has ended, or is about to. */
static void
drop_conn(struct coord *c, struct coord_conn *conn)
{
    struct coord_conn **link = &c->conns;

    while (*link != conn)
        link = &(*link)->next;
    *link = conn->next;
    link = &c->by_id[desk_slot(conn->id)];
    while (*link != conn)
        link = &(*link)->chain;
    *link = conn->chain;
    if (conn->verdict != CONN_STAYS)
        c->verdicts--;
    if (conn->worker) {
        conn->worker->conn = 0;
        conn->worker->since_ms = c->now_ms;
        loss_worker_gone(c, conn->worker);
    }
    telling_release(conn);
    uploads_closed(&c->uploads, conn->id);
    free(conn);
}

/* The name of the connection's worker or user, for the log; before a worker's
 * HELLO is taken, the worker's name in its key. */
static const char *
whose(const struct coord_conn *conn)
{
    if (conn->worker)
        return conn->worker->name;
    return conn->name[0] ? conn->name : conn->owner;
}

void
connlife_closed(struct coord *c, uint64_t id, const char *why)
{
    struct coord_conn *conn = desk_find_conn(c, id);

    if (!conn)
        return;
    actions_log(&c->actions, conn->worker ? ACT_WARN : ACT_DEBUG,
                "connection lost peer=%s name=%s why=%s", conn->address,
                whose(conn), why);
    drop_conn(c, conn);
}

/* Log that the coordinator closes a connection.  A stranger may open any number
 * of connections that are closed at once, so lines about connections without a
 * worker are limited. */
static void
log_break(struct coord *c, const struct coord_conn *conn,
          enum action_level level, const char *why)
{
    unsigned dropped = 0;

    if (!conn->worker && !log_allowed(&c->breaks, c->now_ms, &dropped))
        return;
    if (dropped > 0)
        actions_log(&c->actions, ACT_WARN,
                    "connections closed and not logged n=%u", dropped);
    actions_log(&c->actions, level, "connection closed peer=%s name=%s why=%s",
                conn->address, whose(conn), why);
}

static void
end_conn(struct coord *c, struct coord_conn *conn, enum action_level level,
         const char *why)
{
    log_break(c, conn, level, why);
    actions_session(&c->actions, conn->id, MSG_NSESSION, conn->version);
    actions_close(&c->actions, conn->id);
    drop_conn(c, conn);
}

void
connlife_end_all(struct coord *c)
{
    for (struct coord_conn *conn = c->conns, *next; conn; conn = next) {
        next = conn->next;
        if (conn->verdict != CONN_STAYS)
            end_conn(c, conn,
                     conn->verdict == CONN_BREAKS ? ACT_WARN : ACT_INFO,
                     conn->why);
    }
}

/* How many connections the user of this connection has, or, if `greeted`, how
 * many of these have said HELLO; 0 for workers and administrators, who have no
 * limit.  *oldest: the user's oldest connection without HELLO, or NULL. */
static unsigned
count_user(const struct coord *c, const struct coord_conn *conn, bool greeted,
           const struct coord_conn **oldest)
{
    unsigned n = 0;

    *oldest = NULL;
    if (conn->roles >> MSG_ROLE_WORKER & 1 || conn->roles >> MSG_ROLE_ADMIN & 1)
        return 0;
    for (const struct coord_conn *i = c->conns; i; i = i->next) {
        bool is_new = i->session == MSG_AT_COORD_NEW;

        if (i->roles != conn->roles || strcmp(i->owner, conn->owner) != 0)
            continue;
        n += !(greeted && is_new);
        if (is_new)
            *oldest = i; /* the list begins with the newest */
    }
    return n;
}

/* End the oldest connection without HELLO of a user who opens a new connection
 * and has as many as the limit allows. */
static void
make_room(struct coord *c, const struct coord_conn *conn)
{
    const struct coord_conn *oldest;

    if (count_user(c, conn, false, &oldest) >= c->limits.conns && oldest)
        verdict_break(c, oldest->id, crowded);
}

void
connlife_opened(struct coord *c, uint64_t id, const struct coord_peer *peer)
{
    struct coord_conn *conn = calloc(1, sizeof *conn);
    struct coord_owner *payer = desk_owner(c, peer->owner);

    if (!conn || !payer) {
        free(conn);
        c->actions.failed = true;
        return;
    }
    conn->id = id;
    conn->session = MSG_AT_COORD_NEW;
    conn->version = MSG_VERSION;
    conn->roles = peer->roles;
    conn->payer = payer;
    snprintf(conn->address, sizeof conn->address, "%s", peer->address);
    snprintf(conn->owner, sizeof conn->owner, "%s", peer->owner);
    snprintf(conn->name, sizeof conn->name, "%s", peer->name ? peer->name : "");
    make_room(c, conn);
    conn->next = c->conns;
    c->conns = conn;
    conn->chain = c->by_id[desk_slot(id)];
    c->by_id[desk_slot(id)] = conn;
}

static void
refuse(struct coord *c, struct coord_conn *conn, uint32_t request, int status,
       const char *text)
{
    struct msg m = { .type = MSG_REFUSE,
                     .request = request,
                     .refuse = { (uint16_t)status, text } };

    actions_send(&c->actions, conn->id, &m);
    verdict_break(c, conn->id, text);
}

struct coord_worker *
connlife_worker(struct coord *c, const char *name)
{
    struct coord_worker *w = desk_find_worker(c, name), **end = &c->workers;

    if (w || !(w = calloc(1, sizeof *w)))
        return w;
    snprintf(w->name, sizeof w->name, "%s", name);
    w->id = c->nworkers++;
    w->relative = 1;
    w->priority = w->rank = INT64_MIN;
    w->since_ms = c->now_ms; /* if it is not connected it is gone since now */
    while (*end)
        end = &(*end)->next;
    *end = w;
    return w;
}

static bool
has_part(const struct coord *c, const struct coord_worker *w)
{
    for (size_t i = 0; i < c->nended; i++)
        for (uint32_t k = 0; k < c->jobs[i]->nparts; k++)
            if (c->jobs[i]->parts[k].worker == w)
                return true;
    return false;
}

void
connlife_drop_forgotten(struct coord *c)
{
    struct coord_worker *w, **link = &c->workers;

    while ((w = *link) != NULL) {
        if (!w->forgotten || has_part(c, w)) {
            link = &w->next;
        } else {
            *link = w->next;
            free(w);
        }
    }
}

/* Note where peers dial the worker: at the address in its HELLO, or, if that is
 * a wildcard, at the address from which its connection comes. */
static void
note_address(struct coord_worker *w, const struct coord_conn *conn,
             const char *said)
{
    const char *from = conn->address, *colon = strrchr(from, ':');
    bool named = colon && strncmp(from, "uid:", 4) != 0;

    if (strncmp(said, "tcp ", 4) == 0 && address_is_wildcard(said + 4))
        snprintf(w->address, sizeof w->address, "tcp %.*s:%s",
                 named ? (int)(colon - from) : 9, named ? from : "127.0.0.1",
                 strrchr(said, ':') + 1);
    else
        snprintf(w->address, sizeof w->address, "%s", said);
}

/* End the worker's old connection.  Either it is dead, and that was not known
 * yet; or two hosts have the same name, and both should hear of that.  It is
 * ended at once and not by a verdict, for the worker must leave its jobs before
 * it comes back on the new connection. */
static void
replace(struct coord *c, const struct coord_worker *w,
        const struct coord_conn *by)
{
    struct coord_conn *old = desk_find_conn(c, w->conn);
    char why[MSG_MAX_TEXT + 1];
    struct msg m = { .type = MSG_BYE, .bye = { why } };

    snprintf(why, sizeof why, "replaced by a connection of that name from %s",
             by->address);
    actions_send(&c->actions, old->id, &m);
    end_conn(c, old, ACT_WARN, why);
}

static bool
join_worker(struct coord *c, struct coord_conn *conn, const struct msg_hello *m)
{
    struct coord_worker *w = connlife_worker(c, m->name);

    if (!w) {
        c->actions.failed = true;
        return false;
    }
    if (w->conn != 0)
        replace(c, w, conn);
    w->conn = conn->id;
    w->version = conn->version;
    w->threads = m->threads;
    w->fingerprint = m->fingerprint;
    w->since_ms = c->now_ms;
    w->progressed_ms = c->now_ms; /* its progress counter begins anew */
    w->leaving = 0;
    w->alone = w->hangs = w->forgotten = w->expelled = false;
    snprintf(w->program, sizeof w->program, "%s", m->program);
    note_address(w, conn, m->address);
    conn->worker = w;
    return true;
}

/* Why a connection may not have a role, and what would give the right to it. */
static const char *const not_allowed[] = {
    [MSG_ROLE_WORKER] =
        "this role is not allowed from there: workers need a key 'worker:NAME' "
        "or, on the Unix socket, to be root or the coordinator's own user",
    [MSG_ROLE_USER] = "this role is not allowed from there: users need a key "
                      "'user:NAME' or 'admin:NAME'",
    [MSG_ROLE_ADMIN] =
        "this role is not allowed from there: administrators need a key "
        "'admin:NAME' or, on the Unix socket, to be root or the coordinator's "
        "own user",
    [MSG_ROLE_OBSERVER] =
        "this role is not allowed from there: observers need a key "
        "'observer:NAME' or, on the Unix socket, to be root or the "
        "coordinator's own user",
};

/* Why a HELLO is refused; NULL: the connection is welcome. */
static const char *
hello_fault(const struct coord *c, const struct coord_conn *conn,
            const struct msg_hello *m, char text[MSG_MAX_TEXT + 1], int *status)
{
    const struct coord_conn *oldest;

    *status = EX_PROTOCOL;
    if (msg_common_version(m->min, m->max) == 0) {
        snprintf(text, MSG_MAX_TEXT + 1,
                 "protocol versions %u to %u are not spoken here, only %u to "
                 "%u",
                 m->min, m->max, MSG_VERSION_MIN, MSG_VERSION);
        return text;
    }
    *status = EX_NOPERM;
    if (!(conn->roles >> m->role & 1))
        return not_allowed[m->role];
    if (m->role != MSG_ROLE_WORKER) {
        *status = EX_TEMPFAIL;
        return count_user(c, conn, true, &oldest) < c->limits.conns ? NULL
                                                                    : crowded;
    }
    if (conn->name[0] && strcmp(conn->name, m->name) != 0) {
        snprintf(text, MSG_MAX_TEXT + 1,
                 "the key is that of a worker called '%s'", conn->name);
        return text;
    }
    *status = EX_CONFIG;
    if (!key_name_valid(m->name, strlen(m->name)))
        return "a worker's name needs letters, digits, '.', '_' or '-'";
    if (m->threads < 1 || m->threads > MOST_THREADS)
        return "a worker needs 1 to 4096 threads";
    return NULL;
}

/* Log a HELLO: a worker has a name, other connections have an owner. */
static void
log_hello(struct coord *c, const struct coord_conn *conn,
          const struct msg_hello *m)
{
    if (m->role == MSG_ROLE_WORKER)
        actions_log(&c->actions, ACT_INFO,
                    "hello peer=%s role=worker name=%s threads=%u protocol=%u",
                    conn->address, m->name, m->threads, conn->version);
    else
        actions_log(&c->actions, ACT_INFO,
                    "hello peer=%s role=%s owner=%s protocol=%u", conn->address,
                    key_role_name(m->role), conn->owner, conn->version);
}

void
connlife_hello(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    static const enum msg_session session[] = {
        [MSG_ROLE_WORKER] = MSG_AT_COORD_WORKER,
        [MSG_ROLE_USER] = MSG_AT_COORD_USER,
        [MSG_ROLE_ADMIN] = MSG_AT_COORD_ADMIN,
        [MSG_ROLE_OBSERVER] = MSG_AT_COORD_OBSERVER,
    };
    struct msg welcome = { .type = MSG_WELCOME,
                           .request = m->request,
                           .welcome = { 0, c->env.epoch, c->env.program } };
    char text[MSG_MAX_TEXT + 1];
    int status;
    const char *fault = hello_fault(c, conn, &m->hello, text, &status);

    if (fault) {
        refuse(c, conn, m->request, status, fault);
        return;
    }
    conn->version = msg_common_version(m->hello.min, m->hello.max);
    welcome.welcome.version = (uint16_t)conn->version;
    if (m->hello.role == MSG_ROLE_WORKER && !join_worker(c, conn, &m->hello))
        return;
    conn->session = session[m->hello.role];
    log_hello(c, conn, &m->hello);
    actions_session(&c->actions, conn->id, conn->session, conn->version);
    actions_send(&c->actions, conn->id, &welcome);
}
