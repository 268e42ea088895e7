/* link.c - see link.h */
#include "config.h"

#include "worker/link.h"

#include "worker/gather.h"
#include "worker/peer.h"
#include "worker/relay.h"
#include "worker/state.h"
#include "worker/wjob.h"
#include "worker/worker.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CALLER_MS       10000 /* time for PEER_HELLO and JOB_PEERS to come */
#define FIRST_REDIAL_MS 100   /* before dialling again, doubled each time */
#define PATIENCE_MS     3000  /* time in which a peer should be reached */
#define MOST_CALLERS    64

static struct wpeer *
find_peer(const struct worker *w, uint64_t conn, struct wjob **job)
{
    for (*job = w->jobs; *job; *job = (*job)->next)
        for (struct wpeer *p = (*job)->peers; p; p = p->next)
            if (p->conn == conn && conn != 0)
                return p;
    return NULL;
}

static struct wcaller *
find_caller(const struct worker *w, uint64_t conn)
{
    struct wcaller *k = w->callers;

    while (k && k->conn != conn)
        k = k->next;
    return k;
}

static void
drop_caller(struct worker *w, struct wcaller *caller)
{
    struct wcaller **link = &w->callers;

    while (*link != caller)
        link = &(*link)->next;
    *link = caller->next;
    free(caller);
}

static void
link_up(struct worker *w, struct wjob *job, struct wpeer *p)
{
    p->state = PEER_LINKED;
    p->since_ms = w->now_ms;
    actions_session(&w->actions, p->conn, MSG_AT_PEER, p->version);
    actions_log(&w->actions, ACT_DEBUG, "peer linked job=%s peer=%s", job->hex,
                p->name);
    peer_pump(w, p->conn, &p->queue); /* records that waited for the link */
    relay_linked(w, job, p->name);
}

/* Compare two tokens in a time that does not depend on where they differ. */
static bool
same_token(const uint8_t *a, const uint8_t *b)
{
    uint8_t differ = 0;

    for (int i = 0; i < MSG_TOKEN; i++)
        differ |= a[i] ^ b[i];
    return differ == 0;
}

/* Link a caller that said PEER_HELLO with the peer that it is; false: no such
 * peer is expected. */
static bool
match(struct worker *w, struct wcaller *caller)
{
    struct wjob *job = worker_find_job(w, caller->job);
    struct wpeer *p = job ? job->peers : NULL;

    for (; p; p = p->next)
        if (p->state == PEER_EXPECTED && strcmp(p->name, caller->name) == 0 &&
            same_token(p->token, caller->token))
            break;
    if (!p)
        return false;
    p->conn = caller->conn;
    drop_caller(w, caller);
    link_up(w, job, p);
    return true;
}

bool
worker_peer_token(const struct worker *w, worker_token_fn *fits, void *arg)
{
    for (const struct wjob *job = w->jobs; job; job = job->next)
        for (const struct wpeer *p = job->peers; p; p = p->next)
            if (p->state == PEER_EXPECTED && fits(arg, job->id, p->token))
                return true;
    return false;
}

static void
match_callers(struct worker *w)
{
    for (struct wcaller *k = w->callers, *next; k; k = next) {
        next = k->next;
        if (k->said)
            match(w, k);
    }
}

void
link_introduce(struct worker *w, struct wjob *job,
               const struct msg_job_peers *m)
{
    for (uint32_t i = 0; i < m->npeers; i++) {
        const struct msg_peer *in = &m->peers[i];
        struct wpeer *p = peer_named(job, in->name);

        if (p) /* it is introduced anew, or dropped */
            peer_free(w, job, p);
        if (in->flags & MSG_PEER_DROP)
            continue;
        p = calloc(1, sizeof *p);
        if (!p) {
            w->actions.failed = true;
            return;
        }
        p->id = ++w->next_peer;
        p->flags = in->flags;
        p->version = in->version;
        snprintf(p->name, sizeof p->name, "%s", in->name);
        snprintf(p->address, sizeof p->address, "%s", in->address);
        memcpy(p->token, in->token, MSG_TOKEN);
        p->since_ms = w->now_ms;
        lossy_init(&p->queue);
        p->next = job->peers;
        job->peers = p;
        if (p->flags & MSG_PEER_DIAL)
            peer_dial(w, job, p);
    }
    match_callers(w);
}

void
link_accepted(struct worker *w, uint64_t conn)
{
    struct wcaller *k;
    unsigned n = 0;

    for (k = w->callers; k; k = k->next)
        n++;
    k = n < MOST_CALLERS ? calloc(1, sizeof *k) : NULL;
    if (!k) {
        peer_close_conn(w, conn);
        return;
    }
    k->conn = conn;
    k->since_ms = w->now_ms;
    k->next = w->callers;
    w->callers = k;
}

bool
link_opened(struct worker *w, uint64_t conn)
{
    struct wjob *job;
    struct wpeer *p = find_peer(w, conn, &job);
    struct msg m = { .type = MSG_PEER_HELLO };

    if (!p)
        return false;
    m.peer_hello = (struct msg_peer_hello){ job->id, w->env.name, p->token };
    actions_send(&w->actions, conn, &m);
    link_up(w, job, p);
    return true;
}

static void
dial_later(struct worker *w, struct wpeer *p)
{
    bool steady =
        p->state == PEER_LINKED && w->now_ms - p->since_ms >= WORKER_STEADY_MS;

    if (p->delay_ms == 0 || steady)
        p->delay_ms = FIRST_REDIAL_MS;
    p->retry_ms = worker_redial_ms(w, &p->delay_ms);
}

/* A link broke, or a dial failed: the worker that dialled dials again, as long
 * as it has the job, and the other waits for that: the coordinator names the
 * two to each other only once.  If a peer is gone for good the coordinator says
 * so.
 */
static void
link_lost(struct worker *w, const struct wjob *job, struct wpeer *p,
          const char *why)
{
    enum peer_state was = p->state;

    p->conn = 0;
    if (p->flags & MSG_PEER_DIAL)
        dial_later(w, p);
    if (was == PEER_LINKED)
        p->since_ms = w->now_ms;
    if (p->since_ms != 0 && w->now_ms - p->since_ms >= PATIENCE_MS) {
        p->since_ms = 0;
        actions_log(&w->actions, ACT_WARN,
                    "peer not reached job=%s peer=%s at=%s why=%s", job->hex,
                    p->name, p->address, why);
    }
    p->state = p->flags & MSG_PEER_DIAL ? PEER_DIALLING : PEER_EXPECTED;
    if (was == PEER_LINKED)
        lossy_release(&p->queue); /* records under way are lost */
    if (p->state == PEER_EXPECTED)
        match_callers(w);
}

bool
link_closed(struct worker *w, uint64_t conn, const char *why)
{
    struct wjob *job;
    struct wpeer *p = find_peer(w, conn, &job);
    struct wcaller *k = find_caller(w, conn);

    if (k)
        drop_caller(w, k);
    if (!p)
        return k != NULL;
    link_lost(w, job, p, why);
    return true;
}

static void
caller_hello(struct worker *w, struct wcaller *k,
             const struct msg_peer_hello *m)
{
    if (k->said) {
        peer_close_conn(w, k->conn);
        drop_caller(w, k);
        return;
    }
    k->said = true;
    memcpy(k->job, m->job, MSG_JOB);
    memcpy(k->token, m->token, MSG_TOKEN);
    snprintf(k->name, sizeof k->name, "%s", m->name);
    /* messages of a caller are ignored until it is matched with a peer */
    actions_session(&w->actions, k->conn, MSG_AT_PEER, MSG_VERSION);
    match(w, k);
}

/* Give the child a base line from a peer; false: the job has no such line. */
static bool
receive_line(struct worker *w, struct wjob *job, const struct msg *m)
{
    struct msg pass = { .type = MSG_BASE_LINE, .base_line = m->base_line };

    if (!wjob_fits_line(job, &m->base_line))
        return false;
    job->bytes_in += (size_t)m->base_line.n * m->base_line.channels * 4 +
                     m->base_line.ndensity;
    if (job->child == 0 || job->state != WJOB_READY)
        return true;
    pass.base_line.job = job->id;
    worker_send_child(w, job, &pass);
    return true;
}

bool
link_message(struct worker *w, uint64_t conn, const struct msg *m)
{
    struct wjob *job;
    struct wpeer *p = find_peer(w, conn, &job);
    struct wcaller *k = p ? NULL : find_caller(w, conn);

    if (p && m->type == MSG_AMBIENT) {
        peer_receive(w, job, &m->ambient);
    } else if (p && m->type == MSG_TILE_RECORDS) {
        gather_take(w, job, &m->tile_records);
    } else if (p && m->type == MSG_BASE_LINE) {
        if (!receive_line(w, job, m)) {
            actions_log(&w->actions, ACT_WARN,
                        "peer closed job=%s peer=%s why=a BASE_LINE that fits "
                        "no line",
                        job->hex, p->name);
            peer_free(w, job, p);
        }
        return true;
    } else if (k && m->type == MSG_PEER_HELLO) {
        caller_hello(w, k, &m->peer_hello);
    }
    return p || k;
}

void
link_written(struct worker *w, uint64_t conn, size_t n)
{
    struct wjob *job;
    struct wpeer *p = find_peer(w, conn, &job);

    if (!p)
        return;
    lossy_written(&p->queue, n);
    peer_pump(w, conn, &p->queue);
}

void
link_spread(struct worker *w, struct wjob *job, const struct msg_ambient *m)
{
    struct wire_out *out = &w->actions.scratch;
    struct msg pass = { .type = MSG_AMBIENT, .ambient = *m };
    uint8_t *kept = NULL;

    out->len = 0;
    if (!job->peers || msg_pack(out, &pass) != 0)
        return;
    for (struct wpeer *p = job->peers; p; p = p->next) {
        if (p->state != PEER_LINKED)
            continue;
        job->bytes_out += out->len;
        peer_pass_on(w, p->conn, &p->queue, &kept);
    }
}

void
link_tick(struct worker *w)
{
    for (struct wjob *job = w->jobs; job; job = job->next) {
        for (struct wpeer *p = job->peers; p; p = p->next)
            if (p->retry_ms != 0 && w->now_ms >= p->retry_ms)
                peer_dial(w, job, p);
        gather_tick(w, job);
    }
    for (struct wcaller *k = w->callers, *next; k; k = next) {
        next = k->next;
        if (w->now_ms - k->since_ms < CALLER_MS)
            continue;
        peer_close_conn(w, k->conn);
        drop_caller(w, k);
    }
}

void
link_release_job(struct worker *w, struct wjob *job)
{
    while (job->peers)
        peer_free(w, job, job->peers);
}

void
link_release_callers(struct worker *w)
{
    while (w->callers)
        drop_caller(w, w->callers);
}
