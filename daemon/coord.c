/* coord.c - see coord.h
 *
 * Connections and the life of a job; who works on what is in sched.c, what
 * users and admins ask for in request.c.  Messages go through tables of short
 * handlers; which of them may come from whom was checked by the session before
 * (proto/message.def).
 *
 * A job waits until its bundle is stored and there is room for its rows; then
 * it is accepted.  It is over when every frame's picture is written, when it
 * failed, or when it was cancelled; it is then remembered, without its place
 * in the queue, for a while (struct coord_keep). */
#include "config.h"

#include "coord.h"

#include "address.h"
#include "base/sha.h"
#include "keyfile.h"
#include "request.h"
#include "sched.h"
#include "stats.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define PROGRESS_MS  500
#define LEASE_MS     60000
#define FETCH_MS     60000 /* in which a user gets a picture that is done */
#define KEPT_JOBS    100   /* that are over */
#define MOST_JOBS    1000  /* that are not */
#define MOST_THREADS 4096  /* of one worker */

struct coord *
coord_new(const struct coord_env *env)
{
    struct coord *c = calloc(1, sizeof *c);

    if (!c)
        return NULL;
    c->env = *env;
    c->keep.jobs = KEPT_JOBS;
    c->lease_ms = LEASE_MS;
    actions_init(&c->actions);
    return c;
}

void
coord_set_lease(struct coord *c, uint64_t ms)
{
    c->lease_ms = ms;
}

void
coord_free(struct coord *c)
{
    if (!c)
        return;
    while (c->conns) {
        struct coord_conn *next = c->conns->next;

        free(c->conns);
        c->conns = next;
    }
    while (c->workers) {
        struct coord_worker *next = c->workers->next;

        free(c->workers);
        c->workers = next;
    }
    while (c->owners) {
        struct coord_owner *next = c->owners->next;

        free(c->owners);
        c->owners = next;
    }
    for (size_t i = 0; i < c->njobs; i++)
        job_free(c->jobs[i]);
    free(c->jobs);
    actions_release(&c->actions);
    free(c);
}

void
coord_set_epoch(struct coord *c, uint64_t epoch)
{
    c->env.epoch = epoch;
}

struct action_list *
coord_actions(struct coord *c)
{
    return &c->actions;
}

/* The low bits count up in the shell, and are a host's in the simulation. */
static size_t
slot_of(uint64_t id)
{
    return (size_t)(id ^ id >> 16) % COORD_CONNS;
}

struct coord_conn *
coord_find_conn(const struct coord *c, uint64_t id)
{
    struct coord_conn *conn = c->by_id[slot_of(id)];

    while (conn && conn->id != id)
        conn = conn->chain;
    return conn;
}

struct job *
coord_find_job(const struct coord *c, const uint8_t id[MSG_JOB])
{
    for (size_t i = 0; i < c->njobs; i++)
        if (memcmp(c->jobs[i]->id, id, MSG_JOB) == 0)
            return c->jobs[i];
    return NULL;
}

/* --- replies --- */

void
coord_reply_failed(struct coord *c, const struct coord_conn *conn,
                   uint32_t request, const uint8_t *job, int status,
                   const char *text)
{
    struct msg m = { .type = MSG_FAILED,
                     .request = request,
                     .failed = { job, (uint16_t)status, text } };

    actions_send(&c->actions, conn->id, &m);
}

/* --- the life of a job --- */

static void
send_progress(struct coord *c, const struct coord_conn *conn,
              const struct job *job)
{
    struct msg m = { .type = MSG_PROGRESS, .request = conn->watch_request };

    job_progress(job, c->now_ms, &m.progress);
    actions_send(&c->actions, conn->id, &m);
}

/* The last words to one who watches the job. */
void
coord_send_end(struct coord *c, const struct coord_conn *conn,
               const struct job *job)
{
    struct msg m = { .type = MSG_DONE,
                     .request = conn->watch_request,
                     .done = { job->id, job->spec.nframes } };

    send_progress(c, conn, job);
    if (job->state == JOB_DONE)
        actions_send(&c->actions, conn->id, &m);
    else
        coord_reply_failed(c, conn, conn->watch_request, job->id, job->status,
                           job->text);
}

void
coord_send_accept(struct coord *c, const struct coord_conn *conn,
                  const struct job *job, bool again)
{
    struct msg m = { .type = MSG_ACCEPT,
                     .request = conn->watch_request,
                     .accept = { job->id, again } };

    actions_send(&c->actions, conn->id, &m);
}

uint8_t *
coord_files(const struct coord *c, size_t *n)
{
    size_t all = 0, at = 0;
    uint8_t *list;

    for (size_t i = 0; i < c->njobs; i++)
        all += c->jobs[i]->spec.files.n;
    list = malloc(all * MSG_HASH + 1);
    if (!list)
        return NULL;
    for (size_t i = 0; i < c->njobs; i++) {
        const struct msg_hashes *f = &c->jobs[i]->spec.files;

        if (f->n > 0)
            memcpy(list + at * MSG_HASH, f->hash, (size_t)f->n * MSG_HASH);
        at += f->n;
    }
    *n = rad_sha_unique(list, all);
    return list;
}

/* Forget that job, of c->jobs. */
static void
forget(struct coord *c, size_t i)
{
    actions_log(&c->actions, ACT_INFO, "job forgotten job=%s", c->jobs[i]->hex);
    actions_add_job(&c->actions, ACT_JOB_FORGET, 0, c->jobs[i]->id);
    job_free(c->jobs[i]);
    memmove(c->jobs + i, c->jobs + i + 1, (c->njobs - i - 1) * sizeof *c->jobs);
    c->njobs--;
}

/* Forget the oldest of the jobs that are over while there are too many, or they
 * take too much room, or it is too old. */
static void
forget_old(struct coord *c)
{
    for (;;) {
        uint64_t bytes = 0;
        size_t over = 0, oldest = 0;

        for (size_t i = 0; i < c->njobs; i++) {
            if (!job_over(c->jobs[i]))
                continue;
            bytes += c->jobs[i]->kept_bytes;
            if (over++ == 0 || c->jobs[i]->end_ms < c->jobs[oldest]->end_ms)
                oldest = i;
        }
        if (over == 0 || (over <= c->keep.jobs &&
                          (c->keep.bytes == 0 || bytes <= c->keep.bytes ||
                           c->now_ms - c->jobs[oldest]->end_ms < FETCH_MS) &&
                          (c->keep.ms == 0 ||
                           c->now_ms - c->jobs[oldest]->end_ms < c->keep.ms)))
            return;
        forget(c, oldest);
    }
}

void
coord_set_keep(struct coord *c, const struct coord_keep *keep)
{
    c->keep = *keep;
    forget_old(c);
}

/* The store learns how the job ended, if it knows it at all. */
static void
file_job(struct coord *c, const struct job *job)
{
    struct action *a;
    char *text;

    if (!c->env.keeps || !job->asked_open)
        return;
    text = stats_json(job, c->now_ms);
    a = actions_add_job(&c->actions, ACT_JOB_END, 0, job->id);
    if (!text || !a) {
        c->actions.failed = true;
    } else {
        a->len = strlen(text);
        a->bytes = rad_arena_dup(&c->actions.mem, (uint8_t *)text, a->len);
        c->actions.failed |= !a->bytes;
    }
    free(text);
}

void
coord_job_ends(struct coord *c, struct job *job, enum job_state state,
               int status, const char *text)
{
    if (job_over(job))
        return;
    job->state = state;
    job->status = status;
    job->end_ms = c->now_ms;
    snprintf(job->text, sizeof job->text, "%s", text ? text : "");
    actions_log(&c->actions, ACT_INFO, "job over job=%s state=%s why=%s",
                job->hex, job_state_name(state), job->text);
    if (job->nan.pixels > 0)
        actions_log(&c->actions, ACT_WARN,
                    "pixels are no numbers job=%s pixels=%" PRIu64
                    " frame=%u x=%u y=%u",
                    job->hex, job->nan.pixels, job->nan.frame, job->nan.x,
                    job->nan.y);
    for (int i = 0; i < MSG_FAULTS && job->faults[i].count > 0; i++)
        actions_log(&c->actions, ACT_WARN,
                    "function has no value job=%s object=%u times=%" PRIu64,
                    job->hex, job->faults[i].object, job->faults[i].count);
    sched_job_over(c, job);
    file_job(c, job);
    for (struct coord_conn *conn = c->conns; conn; conn = conn->next)
        if (conn->watch == job) {
            coord_send_end(c, conn, job);
            conn->watch = NULL;
        }
}

/* Once its files are all there, ask for room for its rows. */
void
coord_try_open(struct coord *c, struct job *job)
{
    const struct msg_hashes *f = &job->spec.files;

    if (job->asked_open || job_over(job))
        return;
    for (uint32_t i = 0; i < f->n; i++)
        if (!c->env.has_file(c->env.arg, f->hash + (size_t)i * MSG_HASH))
            return;
    job->asked_open = true;
    actions_add_job(&c->actions, ACT_JOB_OPEN, 0, job->id);
}

/* NULL when memory is out. */
static struct coord_owner *
owner_of(struct coord *c, const char *name)
{
    struct coord_owner *o = c->owners;

    while (o && strcmp(o->name, name) != 0)
        o = o->next;
    if (o)
        return o;
    o = calloc(1, sizeof *o);
    if (!o)
        return NULL;
    snprintf(o->name, sizeof o->name, "%s", name);
    o->next = c->owners;
    return c->owners = o;
}

bool
coord_add_job(struct coord *c, struct job *job)
{
    size_t i = c->njobs;

    if (c->njobs == c->cap_jobs) {
        size_t cap = c->cap_jobs ? 2 * c->cap_jobs : 16;
        struct job **v = realloc(c->jobs, cap * sizeof *v);

        if (!v)
            return false;
        c->jobs = v;
        c->cap_jobs = cap;
    }
    job->payer = owner_of(c, job->owner);
    if (!job->payer)
        return false;
    while (i > 0 && c->jobs[i - 1]->spec.priority < job->spec.priority) {
        c->jobs[i] = c->jobs[i - 1];
        i--;
    }
    c->jobs[i] = job;
    c->njobs++;
    job->sequence = ++c->sequence;
    job->held = c->full;
    return true;
}

/* --- session messages --- */

/* Forget a connection that is closed, or about to be. */
static void
drop_conn(struct coord *c, struct coord_conn *conn)
{
    struct coord_conn **link = &c->conns;

    while (*link != conn)
        link = &(*link)->next;
    *link = conn->next;
    link = &c->by_id[slot_of(conn->id)];
    while (*link != conn)
        link = &(*link)->chain;
    *link = conn->chain;
    if (conn->worker) {
        conn->worker->conn = 0;
        conn->worker->since_ms = c->now_ms;
        sched_worker_gone(c, conn->worker);
    }
    free(conn);
}

void
coord_break(struct coord *c, uint64_t id, const char *why)
{
    struct coord_conn *conn = coord_find_conn(c, id);

    if (!conn)
        return;
    actions_log(&c->actions, ACT_WARN,
                "connection closed peer=%s name=%s why=%s", conn->address,
                conn->worker ? conn->worker->name : "", why);
    actions_session(&c->actions, id, MSG_NSESSION, conn->version);
    actions_close(&c->actions, id);
    drop_conn(c, conn);
}

static void
refuse(struct coord *c, struct coord_conn *conn, uint32_t request, int status,
       const char *text)
{
    struct msg m = { .type = MSG_REFUSE,
                     .request = request,
                     .refuse = { (uint16_t)status, text } };

    actions_send(&c->actions, conn->id, &m);
    coord_break(c, conn->id, text);
}

struct coord_worker *
coord_worker_of(struct coord *c, const char *name)
{
    struct coord_worker *w, **link = &c->workers;

    for (; (w = *link) != NULL; link = &w->next)
        if (strcmp(w->name, name) == 0)
            return w;
    w = calloc(1, sizeof *w);
    if (w) {
        snprintf(w->name, sizeof w->name, "%s", name);
        w->id = c->nworkers++;
        w->relative = 1;
        *link = w;
    }
    return w;
}

/* Where peers dial a worker: as it says, but one that listens on all of its
 * addresses has that by which it came. */
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

static bool
join_worker(struct coord *c, struct coord_conn *conn, const struct msg_hello *m)
{
    struct coord_worker *w = coord_worker_of(c, m->name);

    if (!w) {
        c->actions.failed = true;
        return false;
    }
    if (w->conn != 0)
        coord_break(c, w->conn, "replaced by a new connection of that name");
    w->conn = conn->id;
    w->version = conn->version;
    w->threads = m->threads;
    w->fingerprint = m->fingerprint;
    w->since_ms = c->now_ms;
    w->leaving = w->alone = false;
    snprintf(w->program, sizeof w->program, "%s", m->program);
    note_address(w, conn, m->address);
    conn->worker = w;
    return true;
}

/* Why a HELLO is not welcome; NULL: it is. */
static const char *
hello_fault(const struct coord_conn *conn, const struct msg_hello *m,
            char text[MSG_MAX_TEXT + 1], int *status)
{
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
        return "this role is not allowed from there";
    if (m->role != MSG_ROLE_WORKER)
        return NULL;
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

static void
on_hello(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    static const enum msg_session session[] = {
        [MSG_ROLE_WORKER] = MSG_AT_COORD_WORKER,
        [MSG_ROLE_USER] = MSG_AT_COORD_USER,
        [MSG_ROLE_ADMIN] = MSG_AT_COORD_ADMIN,
    };
    struct msg welcome = { .type = MSG_WELCOME,
                           .request = m->request,
                           .welcome = { 0, c->env.epoch, c->env.program } };
    char text[MSG_MAX_TEXT + 1];
    int status;
    const char *fault = hello_fault(conn, &m->hello, text, &status);

    if (fault) {
        refuse(c, conn, m->request, status, fault);
        return;
    }
    conn->version = msg_common_version(m->hello.min, m->hello.max);
    welcome.welcome.version = (uint16_t)conn->version;
    if (m->hello.role == MSG_ROLE_WORKER && !join_worker(c, conn, &m->hello))
        return;
    conn->session = session[m->hello.role];
    actions_log(&c->actions, ACT_INFO,
                "hello peer=%s role=%s name=%s threads=%u protocol=%u",
                conn->address, key_role_name(m->hello.role), m->hello.name,
                m->hello.threads, conn->version);
    actions_session(&c->actions, conn->id, conn->session, conn->version);
    actions_send(&c->actions, conn->id, &welcome);
}

/* --- files --- */

/* A worker lacks files. */
static void
on_want(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    for (uint32_t i = 0; i < m->want.n; i++) {
        struct action *a = actions_add(&c->actions, ACT_SEND_FILE, conn->id);

        if (!a)
            return;
        a->request = m->request;
        a->hash = rad_arena_dup(&c->actions.mem,
                                m->want.hash + (size_t)i * MSG_HASH, MSG_HASH);
        if (!a->hash)
            c->actions.failed = true;
    }
}

/* --- workers --- */

/* The shell answers; the number says whether it gets on. */
static void
on_ping(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    if (!conn->worker || conn->worker->progress == m->ping.progress)
        return;
    conn->worker->progress = m->ping.progress;
    conn->worker->progress_ms = c->now_ms;
}

/* Of itself; sched_run says BYE when it has nothing left. */
static void
on_drain(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    (void)c;
    (void)m;
    conn->worker->leaving = true;
}

static void
on_ready(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    sched_ready(c, conn->worker, &m->ready);
}

static void
on_result(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    sched_result(c, conn->worker, &m->result);
}

static void
on_lost(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    sched_lost(c, conn->worker, &m->lost);
}

static void
on_tally(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    sched_tally(c, conn->worker, &m->tally);
}

static void
on_facts(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    handoff_facts(c, conn->worker, &m->facts);
}

/* For those who wait for the job. */
static void
on_records(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct msg pass = { .type = MSG_RECORDS, .records = m->records };
    uint32_t index;
    struct job *job = sched_job_of(c, conn->worker, m->records.job, &index);

    if (!job || !(job->spec.flags & MSG_JOB_RECORDS))
        return;
    for (struct coord_conn *to = c->conns; to; to = to->next)
        if (to->watch == job && to->version >= msg_since(MSG_RECORDS)) {
            pass.request = to->watch_request;
            actions_send(&c->actions, to->id, &pass);
        }
}

static void
on_base_line(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    handoff_base_line(c, conn->worker, &m->base_line);
}

static void
on_parked(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    handoff_parked(c, conn->worker, &m->parked);
}

static void
on_gave(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    balance_gave(c, conn->worker, &m->gave);
}

static void
on_estimated(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    survey_estimated(c, conn->worker, &m->estimated);
}

/* The child says that the job cannot be rendered: it would be so anywhere. */
static void
on_failed(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct job *job = coord_find_job(c, m->failed.job);
    char text[MSG_MAX_TEXT + 1];

    if (!job || job_worker_find(job, conn->worker->name) == JOB_NOBODY)
        return;
    snprintf(text, sizeof text, "%.400s (worker %s)", m->failed.text,
             conn->worker->name);
    coord_job_ends(c, job, JOB_FAILED, m->failed.status, text);
}

/* Of workers, and of those who have not said who they are. */
static const struct {
    enum msg_type type;
    void (*handle)(struct coord *c, struct coord_conn *conn,
                   const struct msg *m);
} handlers[] = {
    { MSG_RESULT, on_result },       { MSG_HELLO, on_hello },
    { MSG_WANT, on_want },           { MSG_READY, on_ready },
    { MSG_LOST, on_lost },           { MSG_TALLY, on_tally },
    { MSG_FAILED, on_failed },       { MSG_DRAIN, on_drain },
    { MSG_FACTS, on_facts },         { MSG_BASE_LINE, on_base_line },
    { MSG_PARKED, on_parked },       { MSG_GAVE, on_gave },
    { MSG_ESTIMATED, on_estimated }, { MSG_PING, on_ping },
    { MSG_RECORDS, on_records },
};

/* BYE is followed by the end of the connection. */
static void
handle(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    if (conn->session == MSG_AT_COORD_USER ||
        conn->session == MSG_AT_COORD_ADMIN) {
        request_handle(c, conn, m);
        return;
    }
    for (size_t i = 0; i < sizeof handlers / sizeof handlers[0]; i++)
        if (handlers[i].type == m->type) {
            handlers[i].handle(c, conn, m);
            return;
        }
}

/* --- events --- */

void
coord_opened(struct coord *c, uint64_t now_ms, uint64_t id,
             const struct coord_peer *peer)
{
    struct coord_conn *conn = calloc(1, sizeof *conn);

    c->now_ms = now_ms;
    if (!conn) {
        c->actions.failed = true;
        return;
    }
    conn->id = id;
    conn->session = MSG_AT_COORD_NEW;
    conn->version = MSG_VERSION;
    conn->roles = peer->roles;
    snprintf(conn->address, sizeof conn->address, "%s", peer->address);
    snprintf(conn->owner, sizeof conn->owner, "%s", peer->owner);
    snprintf(conn->name, sizeof conn->name, "%s", peer->name ? peer->name : "");
    conn->next = c->conns;
    c->conns = conn;
    conn->chain = c->by_id[slot_of(id)];
    c->by_id[slot_of(id)] = conn;
}

void
coord_closed(struct coord *c, uint64_t now_ms, uint64_t id, const char *why)
{
    struct coord_conn *conn = coord_find_conn(c, id);

    c->now_ms = now_ms;
    if (!conn)
        return;
    actions_log(&c->actions, conn->worker ? ACT_WARN : ACT_DEBUG,
                "connection lost peer=%s name=%s why=%s", conn->address,
                conn->worker ? conn->worker->name : "", why);
    drop_conn(c, conn);
    sched_run(c);
}

/* Work that comes in: there are many of these, and where nobody gets room by
 * one it changes nothing for the others. */
static bool
is_work(uint16_t type)
{
    return type == MSG_FACTS || type == MSG_BASE_LINE || type == MSG_RESULT ||
           type == MSG_TALLY || type == MSG_RECORDS || type == MSG_PING ||
           type == MSG_PONG;
}

void
coord_message(struct coord *c, uint64_t now_ms, uint64_t id,
              const struct msg *m)
{
    struct coord_conn *conn = coord_find_conn(c, id);

    c->now_ms = now_ms;
    if (!conn || !msg_allowed(conn->session, m->type))
        return; /* it was on its way when we closed the connection */
    handle(c, conn, m);
    if (c->stirred || !is_work(m->type))
        sched_run(c);
    forget_old(c);
}

void
coord_looked(struct coord *c, uint64_t now_ms, const struct action_look *l)
{
    struct coord_conn *conn = coord_find_conn(c, l->conn);

    c->now_ms = now_ms;
    if (conn)
        request_looked(c, conn, l);
}

void
coord_file_stored(struct coord *c, uint64_t now_ms, uint64_t id,
                  const uint8_t hash[MSG_HASH])
{
    struct coord_conn *conn = coord_find_conn(c, id);
    struct msg m = { .type = MSG_HAVE, .have = { hash } };

    c->now_ms = now_ms;
    if (conn)
        actions_send(&c->actions, id, &m);
    for (size_t i = 0; i < c->njobs; i++)
        coord_try_open(c, c->jobs[i]);
}

void
coord_file_failed(struct coord *c, uint64_t now_ms, uint64_t id,
                  const uint8_t hash[MSG_HASH], int status, const char *text)
{
    struct coord_conn *conn = coord_find_conn(c, id);

    (void)hash;
    c->now_ms = now_ms;
    if (conn)
        coord_reply_failed(c, conn, 0, NULL, status, text);
}

void
coord_job_opened(struct coord *c, uint64_t now_ms, const uint8_t id[MSG_JOB],
                 int status, const char *text)
{
    struct job *job = coord_find_job(c, id);

    c->now_ms = now_ms;
    if (!job || job_over(job))
        return;
    if (status != 0) {
        coord_job_ends(c, job, JOB_FAILED, status, text);
        return;
    }
    job->opened = true;
    job->open_ms = now_ms;
    for (struct coord_conn *conn = c->conns; conn; conn = conn->next)
        if (conn->watch == job)
            coord_send_accept(c, conn, job, false);
    sched_run(c);
}

void
coord_job_filed(struct coord *c, uint64_t now_ms, const uint8_t id[MSG_JOB],
                uint64_t bytes)
{
    struct job *job = coord_find_job(c, id);

    c->now_ms = now_ms;
    if (job)
        job->kept_bytes = bytes;
    forget_old(c);
}

void
coord_settled(struct coord *c, uint64_t now_ms, uint64_t id, uint32_t request)
{
    struct coord_conn *conn = coord_find_conn(c, id);

    c->now_ms = now_ms;
    if (conn)
        request_settled(c, conn, request);
}

void
coord_rows_stored(struct coord *c, uint64_t now_ms,
                  const struct action_rows *key, int status, const char *text)
{
    struct job *job = coord_find_job(c, key->job);

    c->now_ms = now_ms;
    if (status == 0)
        sched_rows_stored(c, key);
    else if (job)
        coord_job_ends(c, job, JOB_FAILED, status, text);
    sched_run(c);
}

void
coord_picture_written(struct coord *c, uint64_t now_ms,
                      const uint8_t id[MSG_JOB], uint32_t frame, int status,
                      const char *text)
{
    struct job *job = coord_find_job(c, id);

    c->now_ms = now_ms;
    if (!job || job_over(job))
        return;
    if (status != 0) {
        coord_job_ends(c, job, JOB_FAILED, status, text);
        return;
    }
    job->frames[frame].writing = false;
    job->frames[frame].written = true;
    job_count_ready(job);
    if (job->frames_ready == job->spec.nframes)
        coord_job_ends(c, job, JOB_DONE, 0, NULL);
    forget_old(c);
}

/* One whose scene does not come through hears why, for it has no job yet. */
static void
say_held(struct coord *c, const struct coord_conn *conn)
{
    struct msg m = { .type = MSG_PROGRESS,
                     .progress = { .state = MSG_STATE_HELD } };

    actions_send(&c->actions, conn->id, &m);
}

void
coord_fullness(struct coord *c, uint64_t now_ms, bool full, const char *text)
{
    c->now_ms = now_ms;
    c->full = full;
    snprintf(c->full_text, sizeof c->full_text, "no room on the disk: %s",
             text);
    if (full)
        actions_log(&c->actions, ACT_ERR, "disk full, jobs are held why=%s",
                    text);
    else
        actions_log(&c->actions, ACT_INFO, "disk has room, jobs go on");
    for (size_t i = 0; i < c->njobs; i++)
        c->jobs[i]->held = full;
    c->progress_ms = 0; /* those who watch hear of it at the next tick */
    sched_run(c);
}

void
coord_expel(struct coord *c, uint64_t now_ms, const char *name)
{
    struct coord_worker *w = c->workers;

    c->now_ms = now_ms;
    while (w && strcmp(w->name, name) != 0)
        w = w->next;
    if (!w)
        return;
    for (size_t i = 0; i < c->njobs; i++)
        if (!job_over(c->jobs[i]))
            sched_drop_peer(c, c->jobs[i], w);
}

void
coord_tick(struct coord *c, uint64_t now_ms)
{
    c->now_ms = now_ms;
    sched_tick(c);
    if (c->keep.ms > 0)
        forget_old(c);
    if (now_ms - c->progress_ms < PROGRESS_MS)
        return;
    c->progress_ms = now_ms;
    for (struct coord_conn *conn = c->conns; conn; conn = conn->next)
        if (conn->watch)
            send_progress(c, conn, conn->watch);
        else if (c->full && conn->offer_ms != 0)
            say_held(c, conn);
}

bool
coord_saved(const struct coord *c, const uint8_t id[MSG_JOB],
            struct saved_job *out)
{
    const struct job *job = coord_find_job(c, id);

    if (!job)
        return false;
    *out = (struct saved_job){ .spec = job->spec,
                               .owner = job->owner,
                               .lives = job->lives,
                               .state = (uint8_t)job->state,
                               .status = job->status,
                               .text = job->text,
                               .offer_ms = job->offer_ms,
                               .submit_ms = job->submit_ms,
                               .open_ms = c->now_ms,
                               .end_ms = job->end_ms,
                               .sent_bytes = job->sent_bytes };
    job_progress(job, c->now_ms, &out->last);
    return true;
}
