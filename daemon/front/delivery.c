/* delivery.c - see delivery.h */
#include "config.h"

#include "front/delivery.h"

#include "desk/verdict.h"
#include "front/reply.h"
#include "jobs/job.h"
#include "queue/stats.h"
#include "queue/telling.h"

#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

/* Most bytes of statistics that a tick sends to a connection; takes well below
 * a millisecond. */
#define TELL_BYTES ((size_t)4 * MSG_MAX_CHUNK)

/* Send bytes [at, end) of a text of `total` bytes as CHUNKs. */
static void
send_text(struct coord *c, const struct coord_conn *conn, uint32_t request,
          const char *text, size_t total, size_t at, size_t end)
{
    for (; at < end; at += MSG_MAX_CHUNK) {
        size_t n = end - at < MSG_MAX_CHUNK ? end - at : MSG_MAX_CHUNK;
        struct msg m = { .type = MSG_CHUNK,
                         .request = request,
                         .chunk = { NULL, at, total, (const uint8_t *)text + at,
                                    n } };

        actions_send(&c->actions, conn->id, &m);
    }
}

/* Send more of statistics that are made; false: all are sent. */
static bool
send_more(struct coord *c, const struct coord_conn *conn,
          struct coord_telling *t)
{
    size_t end = t->len - t->sent < TELL_BYTES ? t->len : t->sent + TELL_BYTES;

    send_text(c, conn, t->request, t->whole, t->len, t->sent, end);
    t->sent = end;
    return end < t->len;
}

/* Make, or send, the next piece of statistics; false: all are sent. */
static bool
tell_more(struct coord *c, struct coord_conn *conn, struct coord_telling *t)
{
    const struct job *job = desk_same_job(c, t->job, t->sequence);
    int rc;

    if (t->whole)
        return send_more(c, conn, t);
    if (!job) {
        desk_reply_failed(c, conn, t->request, t->job, EX_NOINPUT,
                          "no such job");
        return false;
    }
    rc = stats_more(t->text, job, STATS_PIECE);
    c->actions.failed |= rc < 0;
    if (rc != 1)
        return rc == 0;
    t->whole = stats_take(t->text);
    t->text = NULL;
    t->len = strlen(t->whole);
    return send_more(c, conn, t);
}

/* The first piece is made at once: it has all units, if these are few. */
static void
fetch_stats(struct coord *c, struct coord_conn *conn, const struct msg *m,
            const struct job *job)
{
    struct coord_telling *t = calloc(1, sizeof *t), **at = &conn->telling;

    if (t)
        t->text = stats_begin(job, c->now_ms);
    if (!t || !t->text) {
        free(t);
        c->actions.failed = true;
        return;
    }
    memcpy(t->job, job->id, MSG_JOB);
    t->sequence = job->sequence;
    t->request = m->request;
    while (*at)
        at = &(*at)->next;
    *at = t;
    conn->answers++;
    if (at == &conn->telling && !tell_more(c, conn, t))
        telling_drop(conn, at);
}

/* Why a frame cannot be fetched; NULL: it can. */
static const char *
fetch_fault(const struct job *job, const struct msg_fetch *m, int *status)
{
    *status = EX_USAGE;
    if (m->what == MSG_WHAT_STATS)
        return NULL;
    if (m->frame >= job->spec.nframes)
        return "no such frame";
    if (m->what == MSG_WHAT_DEPTH && !(job->spec.flags & MSG_JOB_DEPTH))
        return "the job has no distances";
    if (m->what != MSG_WHAT_DEPTH && job->spec.flags & MSG_JOB_POINTS)
        return "the job is of sensor points: radsubmit --job writes "
               "their values";
    *status = EX_TEMPFAIL;
    if (m->what == MSG_WHAT_PREVIEW)
        return job->pixels_done > 0 || job->frames[m->frame].shown ||
                       frame_is_written(&job->frames[m->frame])
                   ? NULL
                   : "nothing is rendered yet";
    if (frame_is_written(&job->frames[m->frame]))
        return NULL;
    if (!job_over(job))
        return "the picture is not complete yet";
    if (job->state == JOB_CANCELLED) { /* trying again is no use */
        *status = EX_NOINPUT;
        return "the job was cancelled: it has no picture";
    }
    *status = job->status;
    return job->text;
}

void
delivery_fetch(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct job *job = reply_find_job(c, conn, m->request, m->fetch.job, true);
    const char *fault;
    struct action *a;
    int status;

    if (!job)
        return;
    if (m->fetch.what == MSG_WHAT_STATS && job->stage != STAGE_FILED) {
        fetch_stats(c, conn, m, job);
        return;
    }
    job->watched |= m->fetch.what == MSG_WHAT_PREVIEW;
    fault = fetch_fault(job, &m->fetch, &status);
    if (fault) {
        desk_reply_failed(c, conn, m->request, job->id, status, fault);
        return;
    }
    a = actions_add_job(&c->actions, ACT_SEND_PICTURE, conn->id, job->id);
    if (!a)
        return;
    a->request = m->request;
    a->frame = m->fetch.frame;
    a->what = m->fetch.what;
    conn->answers++;
}

void
delivery_tick(struct coord *c)
{
    for (struct coord_conn *conn = c->conns; conn; conn = conn->next)
        if (conn->telling && !tell_more(c, conn, conn->telling))
            telling_drop(conn, &conn->telling);
}
