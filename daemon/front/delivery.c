/* delivery.c - see delivery.h
 *
 * Statistics are made and sent in pieces.  Users take turns for these, and so
 * do the connections of each user.  A user has at most one text in the making.
 * It is begun only while the user's whole texts have fewer bytes than the user
 * may leave unread.  So a user's texts take that many bytes and one text more,
 * however many connections ask, and read nothing. */
#include "config.h"

#include "front/delivery.h"

#include "front/reply.h"
#include "jobs/job.h"
#include "registry/bygone.h"
#include "registry/stats.h"
#include "registry/telling.h"

#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

/* Most bytes of statistics that a tick sends to a connection; takes well below
 * a millisecond. */
#define TELL_BYTES ((size_t)4 * MSG_MAX_CHUNK)

/* Most pieces of statistics that a tick makes or sends, for all users; each
 * takes about a millisecond. */
#define TELL_PIECES 4

/* Send more of a whole text of statistics; false: all of it is sent. */
static bool
send_more(struct coord *c, const struct coord_conn *conn,
          struct coord_telling *t)
{
    size_t end = t->len - t->sent < TELL_BYTES ? t->len : t->sent + TELL_BYTES;

    while (t->sent < end) {
        size_t n =
            end - t->sent < MSG_MAX_CHUNK ? end - t->sent : MSG_MAX_CHUNK;
        struct msg m = { .type = MSG_CHUNK,
                         .request = t->request,
                         .chunk = { NULL, t->sent, t->len,
                                    (const uint8_t *)t->whole + t->sent, n } };

        actions_send(&c->actions, conn->id, &m);
        t->sent += n;
    }
    return end < t->len;
}

/* Have the store send a file of the job. */
static void
send_kept(struct coord *c, struct coord_conn *conn, uint32_t request,
          struct job *job, uint32_t frame, enum msg_what what)
{
    struct action *a =
        actions_add_job(&c->actions, ACT_SEND_PICTURE, conn->id, job->id);

    if (!a)
        return;
    a->request = request;
    a->frame = frame;
    a->what = what;
    conn->answers++;
    bygone_fetching(c, conn, job);
}

/* Begin to make a text.  False: the store sends it, or memory is out. */
static bool
begin(struct coord *c, struct coord_conn *conn, struct coord_telling *t,
      struct job *job)
{
    if (job->place == PLACE_FILED) {
        send_kept(c, conn, t->request, job, 0, MSG_WHAT_STATS);
        return false;
    }
    if (telling_begin(conn, t, job, c->now_ms))
        return true;
    c->actions.failed = true;
    return false;
}

/* Make or send the next piece of a text of statistics; false: the request is
 * answered. */
static bool
tell_more(struct coord *c, struct coord_conn *conn, struct coord_telling *t)
{
    struct job *job = desk_same_job(c, t->job, t->sequence);
    int rc;

    conn->payer->told.turn = t->turn = ++c->pieces_told;
    if (t->whole)
        return send_more(c, conn, t);
    if (!job) {
        desk_reply_failed(c, conn, t->request, t->job, EX_NOINPUT,
                          "no such job");
        return false;
    }
    if (!t->text && !begin(c, conn, t, job))
        return false;
    rc = stats_more(t->text, job, STATS_PIECE);
    c->actions.failed |= rc < 0;
    if (rc != 1)
        return rc == 0;
    telling_whole(conn, t);
    return send_more(c, conn, t);
}

/* May the connection's first text go on now?  A text that is begun is made to
 * its end even if nobody reads, for the user's other texts wait for it. */
static bool
may_go_on(const struct coord *c, const struct coord_conn *conn)
{
    const struct coord_telling *t = conn->telling;
    const struct coord_told *told = &conn->payer->told;

    if (t->text)
        return true;
    if (c->env.has_room && !c->env.has_room(c->env.arg, conn->id))
        return false;
    return t->whole || (!told->making && told->bytes < c->limits.unread);
}

static void
fetch_stats(struct coord *c, struct coord_conn *conn, const struct msg *m,
            const struct job *job)
{
    struct coord_telling *t = calloc(1, sizeof *t), **at = &conn->telling;

    if (!t) {
        c->actions.failed = true;
        return;
    }
    memcpy(t->job, job->id, MSG_JOB);
    t->sequence = job->sequence;
    t->request = m->request;
    t->turn = c->pieces_told;
    while (*at)
        at = &(*at)->next;
    *at = t;
    conn->answers++;
    /* the first piece has all units if these are few */
    if (at == &conn->telling && may_go_on(c, conn) && !tell_more(c, conn, t))
        telling_drop(conn, at);
}

/* Why a frame cannot be fetched; NULL: it can. */
static const char *
fetch_fault(const struct job *job, const struct msg_fetch *m, int *status)
{
    const struct job_frame *f;

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
    f = &job->frames[m->frame];
    if (m->what == MSG_WHAT_PREVIEW)
        return f->rows_pixels > 0 || f->has_colours || frame_is_written(f)
                   ? NULL
                   : "nothing is rendered yet";
    if (frame_is_written(f))
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
    int status;

    if (!job)
        return;
    if (m->fetch.what == MSG_WHAT_STATS && job->place != PLACE_FILED) {
        fetch_stats(c, conn, m, job);
        return;
    }
    job->watched |= m->fetch.what == MSG_WHAT_PREVIEW;
    fault = fetch_fault(job, &m->fetch, &status);
    if (fault) {
        desk_reply_failed(c, conn, m->request, job->id, status, fault);
        return;
    }
    send_kept(c, conn, m->request, job, m->fetch.frame, m->fetch.what);
}

/* Does connection a get its turn before connection b? */
static bool
is_before(const struct coord_conn *a, const struct coord_conn *b)
{
    if (a->payer != b->payer)
        return a->payer->told.turn < b->payer->told.turn;
    return a->telling->turn < b->telling->turn;
}

/* The connection that gets its turn now, of the connections that wait for
 * statistics and had no turn since pieces_told was `from`; NULL: none. */
static struct coord_conn *
whose_turn(const struct coord *c, uint64_t from)
{
    struct coord_conn *first = NULL;

    for (struct coord_conn *i = c->conns; i; i = i->next)
        if (i->telling && i->telling->turn <= from &&
            (!first || is_before(i, first)) && may_go_on(c, i))
            first = i;
    return first;
}

void
delivery_tick(struct coord *c)
{
    uint64_t from = c->pieces_told;
    struct coord_conn *conn;

    for (int i = 0; i < TELL_PIECES && (conn = whose_turn(c, from)); i++)
        if (!tell_more(c, conn, conn->telling))
            telling_drop(conn, &conn->telling);
}
