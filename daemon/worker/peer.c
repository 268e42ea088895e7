/* peer.c - see peer.h */
#include "config.h"

#include "worker/peer.h"

#include "worker/spread.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CALLER_MS    10000 /* for a PEER-HELLO, and for the coordinator's word */
#define RETRY_MS     100   /* twice as long each time */
#define MOST_TRIES   6
#define MOST_CALLERS 64

/* Who is to call has done so by then, or cannot. */
#define EXPECT_MS 10000

/* Records that may wait for a link which is to come. */
#define EARLY_BYTES ((size_t)1 << 20)

/* --- helpers --- */

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
close_conn(struct worker *w, uint64_t conn)
{
    actions_session(&w->actions, conn, MSG_NSESSION, MSG_VERSION);
    actions_close(&w->actions, conn);
}

static void
free_peer(struct worker *w, struct wjob *job, struct wpeer *peer)
{
    struct wpeer **link = &job->peers;

    while (*link != peer)
        link = &(*link)->next;
    *link = peer->next;
    if (peer->conn != 0 && peer->state == PEER_LINKED)
        close_conn(w, peer->conn);
    else if (peer->conn != 0)
        actions_close(&w->actions, peer->conn); /* stop dialling */
    lossy_release(&peer->queue);
    explicit_bzero(peer, sizeof *peer);
    free(peer);
}

/* Pass on what waits, as far as the connection takes it. */
static void
pump(struct worker *w, uint64_t conn, struct lossy *q)
{
    struct lossy_frame *f;

    while ((f = lossy_take(q)) != NULL) {
        actions_send_bytes(&w->actions, conn, f->bytes, f->len);
        free(f);
    }
}

/* A frame of records for one connection, or for several: *kept is NULL for the
 * first, and freed by nobody.  What can go now is copied once for all. */
static void
pass_on(struct worker *w, uint64_t conn, struct lossy *q, uint8_t **kept)
{
    const struct wire_out *frame = &w->actions.scratch;

    if (!lossy_pass(q, frame->len)) {
        lossy_put(q, frame->buf, frame->len);
        pump(w, conn, q);
        return;
    }
    if (!*kept)
        *kept = actions_keep(&w->actions, frame->buf, frame->len);
    if (*kept)
        actions_send_kept(&w->actions, conn, *kept, frame->len);
}

/* --- linking --- */

static void
dial(struct worker *w, const struct wjob *job, struct wpeer *p)
{
    struct action *a;

    p->conn = worker_new_conn(w);
    p->state = PEER_DIALLING;
    p->retry_ms = 0;
    p->tries++;
    a = actions_add_job(&w->actions, ACT_DIAL, p->conn, job->id);
    if (!a)
        return;
    a->text =
        rad_arena_strndup(&w->actions.mem, p->address, strlen(p->address));
    a->token = rad_arena_dup(&w->actions.mem, p->token, MSG_TOKEN);
    if (!a->text || !a->token)
        w->actions.failed = true;
}

static void
linked(struct worker *w, struct wjob *job, struct wpeer *p)
{
    struct msg give = { .type = MSG_GIVE, .give = { p->id } };

    p->state = PEER_LINKED;
    actions_session(&w->actions, p->conn, MSG_AT_PEER, p->version);
    actions_log(&w->actions, ACT_DEBUG, "peer linked job=%s peer=%s", job->hex,
                p->name);
    if ((p->flags & MSG_PEER_GIVE) && job->state == WJOB_READY)
        worker_send_child(w, job, &give);
    pump(w, p->conn, &p->queue); /* what was early */
    relay_linked(w, job, p->name);
    spread_linked(job, p->name, true);
}

/* Both tokens compare in the same time, whatever they are. */
static bool
same_token(const uint8_t *a, const uint8_t *b)
{
    uint8_t differ = 0;

    for (int i = 0; i < MSG_TOKEN; i++)
        differ |= a[i] ^ b[i];
    return differ == 0;
}

/* A caller that said hello belongs to a peer that is expected: link them. */
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
    linked(w, job, p);
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

struct wpeer *
peer_named(const struct wjob *job, const char *name)
{
    struct wpeer *p = job->peers;

    while (p && strcmp(p->name, name) != 0)
        p = p->next;
    return p;
}

void
peer_introduce(struct worker *w, struct wjob *job,
               const struct msg_job_peers *m)
{
    for (uint32_t i = 0; i < m->npeers; i++) {
        const struct msg_peer *in = &m->peers[i];
        struct wpeer *p = peer_named(job, in->name);

        if (p) /* it is new again, or no longer welcome */
            free_peer(w, job, p);
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
        lossy_init(&p->queue);
        p->since_ms = w->now_ms;
        p->next = job->peers;
        job->peers = p;
        spread_linked(job, p->name, false);
        if (p->flags & MSG_PEER_DIAL)
            dial(w, job, p);
    }
    match_callers(w);
}

/* --- events of connections --- */

void
peer_accepted(struct worker *w, uint64_t conn)
{
    struct wcaller *k;
    unsigned n = 0;

    for (k = w->callers; k; k = k->next)
        n++;
    k = n < MOST_CALLERS ? calloc(1, sizeof *k) : NULL;
    if (!k) {
        close_conn(w, conn);
        return;
    }
    k->conn = conn;
    k->since_ms = w->now_ms;
    k->next = w->callers;
    w->callers = k;
}

bool
peer_opened(struct worker *w, uint64_t conn)
{
    struct wjob *job;
    struct wpeer *p = find_peer(w, conn, &job);
    struct msg m = { .type = MSG_PEER_HELLO };

    if (!p)
        return false;
    m.peer_hello = (struct msg_peer_hello){ job->id, w->env.name, p->token };
    actions_send(&w->actions, conn, &m);
    linked(w, job, p);
    return true;
}

bool
peer_closed(struct worker *w, uint64_t conn)
{
    struct wjob *job;
    struct wpeer *p = find_peer(w, conn, &job);
    struct wcaller *k = find_caller(w, conn);

    if (k)
        drop_caller(w, k);
    if (!p)
        return k != NULL;
    p->conn = 0;
    if (p->state == PEER_DIALLING && p->tries < MOST_TRIES)
        p->retry_ms = w->now_ms + ((uint64_t)RETRY_MS << (p->tries - 1));
    else /* it was there and went: the coordinator says when it is back */
        free_peer(w, job, p);
    return true;
}

static void
caller_hello(struct worker *w, struct wcaller *k,
             const struct msg_peer_hello *m)
{
    if (k->said) {
        close_conn(w, k->conn);
        drop_caller(w, k);
        return;
    }
    k->said = true;
    memcpy(k->job, m->job, MSG_JOB);
    memcpy(k->token, m->token, MSG_TOKEN);
    snprintf(k->name, sizeof k->name, "%s", m->name);
    /* until it is matched, what it sends is read and dropped */
    actions_session(&w->actions, k->conn, MSG_AT_PEER, MSG_VERSION);
    match(w, k);
}

static size_t
line_bytes(const struct msg_base_line *m)
{
    return (size_t)m->n * m->channels * 4 + m->ndensity;
}

void
peer_receive(struct worker *w, struct wjob *job, const struct msg_ambient *m)
{
    struct wire_out *out = &w->actions.scratch;
    struct msg pass = { .type = MSG_AMBIENT, .ambient = *m };
    uint8_t *kept = NULL;

    job->bytes_in += m->len;
    if (job->child == 0 || job->state != WJOB_READY)
        return;
    pass.ambient.to = 0;
    out->len = 0;
    if (msg_pack(out, &pass) == 0)
        pass_on(w, job->child, &job->to_child, &kept);
}

/* A base line from a peer, for the child; false: it can be none. */
static bool
receive_line(struct worker *w, struct wjob *job, const struct msg *m)
{
    struct msg pass = { .type = MSG_BASE_LINE, .base_line = m->base_line };

    if (!relay_fits(job, &m->base_line))
        return false;
    job->bytes_in += line_bytes(&m->base_line);
    if (job->child == 0 || job->state != WJOB_READY)
        return true;
    pass.base_line.job = job->id;
    worker_send_child(w, job, &pass);
    return true;
}

bool
peer_message(struct worker *w, uint64_t conn, const struct msg *m)
{
    struct wjob *job;
    struct wpeer *p = find_peer(w, conn, &job);
    struct wcaller *k = p ? NULL : find_caller(w, conn);

    if (p && m->type == MSG_AMBIENT) {
        peer_receive(w, job, &m->ambient);
        if (job->spread)
            spread_heard(w, job, p, &m->ambient);
    } else if (p && m->type == MSG_SPREAD) {
        spread_take(w, job, &m->spread);
    } else if (p && m->type == MSG_BASE_LINE) {
        if (!receive_line(w, job, m)) {
            actions_log(&w->actions, ACT_WARN,
                        "peer closed job=%s peer=%s why=a BASE_LINE that fits "
                        "no line",
                        job->hex, p->name);
            free_peer(w, job, p);
        }
        return true;
    } else if (k && m->type == MSG_PEER_HELLO) {
        caller_hello(w, k, &m->peer_hello);
    }
    return p || k;
}

bool
peer_written(struct worker *w, uint64_t conn, size_t n)
{
    struct wjob *job;
    struct wpeer *p = find_peer(w, conn, &job);

    if (!p)
        return false;
    lossy_written(&p->queue, n);
    pump(w, conn, &p->queue);
    return true;
}

/* --- records --- */

void
peer_spread(struct worker *w, struct wjob *job, const struct msg_ambient *m)
{
    struct wire_out *out = &w->actions.scratch;
    struct msg pass = { .type = MSG_AMBIENT, .ambient = *m };
    uint8_t *kept = NULL;

    if (m->to == 0 && !spread_note_own(w, job)) {
        spread_own(w, job, m);
        return;
    }
    pass.ambient.to = 0;
    out->len = 0;
    if (!job->peers || msg_pack(out, &pass) != 0)
        return;
    for (struct wpeer *p = job->peers; p; p = p->next) {
        if (p->state != PEER_LINKED || (m->to != 0 && m->to != p->id))
            continue;
        job->bytes_out += out->len;
        pass_on(w, p->conn, &p->queue, &kept);
    }
}

void
peer_records(struct worker *w, struct wjob *job, struct wpeer *p,
             uint8_t **kept)
{
    const struct wire_out *frame = &w->actions.scratch;

    if (p->state != PEER_LINKED && p->queue.queued >= EARLY_BYTES)
        return;
    job->bytes_out += frame->len;
    if (p->state == PEER_LINKED)
        pass_on(w, p->conn, &p->queue, kept);
    else
        lossy_put(&p->queue, frame->buf, frame->len);
}

struct wpeer *
peer_linked(const struct wjob *job, const char *name)
{
    struct wpeer *p = peer_named(job, name);

    return p && p->state == PEER_LINKED ? p : NULL;
}

struct wpeer *
peer_awaited(const struct worker *w, const struct wjob *job, const char *name)
{
    struct wpeer *p = peer_named(job, name);

    return p && p->state == PEER_EXPECTED &&
                   w->now_ms - p->since_ms >= EXPECT_MS
               ? NULL
               : p;
}

void
peer_send(struct worker *w, struct wjob *job, struct wpeer *p,
          const struct msg *m)
{
    struct wire_out *out = &w->actions.scratch;

    out->len = 0;
    if (msg_pack(out, m) != 0) {
        w->actions.failed = true;
        return;
    }
    job->bytes_out += out->len;
    if (m->type == MSG_BASE_LINE)
        job->base_line_bytes += out->len;
    lossy_sent(&p->queue, out->len);
    actions_send_bytes(&w->actions, p->conn, out->buf, out->len);
}

void
peer_feed_child(struct worker *w, struct wjob *job)
{
    pump(w, job->child, &job->to_child);
}

/* --- time and end --- */

void
peer_tick(struct worker *w)
{
    for (struct wjob *job = w->jobs; job; job = job->next) {
        for (struct wpeer *p = job->peers; p; p = p->next)
            if (p->retry_ms != 0 && w->now_ms >= p->retry_ms)
                dial(w, job, p);
        spread_tick(w, job);
    }
    for (struct wcaller *k = w->callers, *next; k; k = next) {
        next = k->next;
        if (w->now_ms - k->since_ms < CALLER_MS)
            continue;
        close_conn(w, k->conn);
        drop_caller(w, k);
    }
}

void
peer_release_job(struct worker *w, struct wjob *job)
{
    while (job->peers)
        free_peer(w, job, job->peers);
    spread_release(job);
}

void
peer_release_callers(struct worker *w)
{
    while (w->callers)
        drop_caller(w, w->callers);
}
