/* peer.c - see peer.h */
#include "config.h"

#include "worker/peer.h"

#include "worker/state.h"

#include <stdlib.h>
#include <string.h>

/* Most bytes of records that wait for a link to come up. */
#define EARLY_BYTES ((size_t)1 << 20)

void
peer_close_conn(struct worker *w, uint64_t conn)
{
    actions_session(&w->actions, conn, MSG_NSESSION, MSG_VERSION);
    actions_close(&w->actions, conn);
}

void
peer_free(struct worker *w, struct wjob *job, struct wpeer *peer)
{
    struct wpeer **link = &job->peers;

    while (*link != peer)
        link = &(*link)->next;
    *link = peer->next;
    if (peer->conn != 0 && peer->state == PEER_LINKED)
        peer_close_conn(w, peer->conn);
    else if (peer->conn != 0)
        actions_close(&w->actions, peer->conn); /* stop dialling */
    lossy_release(&peer->queue);
    explicit_bzero(peer, sizeof *peer);
    free(peer);
}

void
peer_pump(struct worker *w, uint64_t conn, struct lossy *q)
{
    struct lossy_frame *f;

    while ((f = lossy_take(q)) != NULL) {
        actions_send_bytes(&w->actions, conn, f->bytes, f->len);
        free(f);
    }
}

void
peer_pass_on(struct worker *w, uint64_t conn, struct lossy *q, uint8_t **kept)
{
    const struct wire_out *frame = &w->actions.scratch;

    if (!lossy_pass(q, frame->len)) {
        lossy_put(q, frame->buf, frame->len);
        peer_pump(w, conn, q);
        return;
    }
    if (!*kept)
        *kept = actions_keep(&w->actions, frame->buf, frame->len);
    if (*kept)
        actions_send_kept(&w->actions, conn, *kept, frame->len);
}

void
peer_dial(struct worker *w, const struct wjob *job, struct wpeer *p)
{
    struct action *a;

    p->conn = worker_new_conn(w);
    p->state = PEER_DIALLING;
    p->retry_ms = 0;
    a = actions_add_job(&w->actions, ACT_DIAL, p->conn, job->id);
    if (!a)
        return;
    a->text = actions_keep_text(&w->actions, p->address);
    a->token = actions_keep(&w->actions, p->token, MSG_TOKEN);
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
peer_receive(struct worker *w, struct wjob *job, const struct msg_ambient *m)
{
    struct wire_out *out = &w->actions.scratch;
    struct msg pass = { .type = MSG_AMBIENT, .ambient = *m };
    uint8_t *kept = NULL;

    job->bytes_in += m->len;
    if (job->child == 0 || job->state != WJOB_READY)
        return;
    out->len = 0;
    if (msg_pack(out, &pass) == 0)
        peer_pass_on(w, job->child, &job->to_child, &kept);
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
        peer_pass_on(w, p->conn, &p->queue, kept);
    else
        lossy_put(&p->queue, frame->buf, frame->len);
}

struct wpeer *
peer_linked(const struct wjob *job, const char *name)
{
    struct wpeer *p = peer_named(job, name);

    return p && p->state == PEER_LINKED ? p : NULL;
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
