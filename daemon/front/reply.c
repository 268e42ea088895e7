/* reply.c - see reply.h */
#include "config.h"

#include "front/reply.h"

#include "jobs/job.h"
#include "registry/bygone.h"
#include "registry/telling.h"

#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define FULL_MS 3000 /* how long an answer waits for room on the disk */

void
reply_answer(struct coord *c, const struct coord_conn *conn, uint32_t request,
             const char *text)
{
    struct msg m = { .type = MSG_ANSWER,
                     .request = request,
                     .answer = { (const uint8_t *)text, strlen(text) } };

    if (m.answer.len > MSG_MAX - 4)
        desk_reply_failed(c, conn, request, NULL, EX_SOFTWARE,
                          "the answer is too long");
    else
        actions_send(&c->actions, conn->id, &m);
}

void
reply_settled(struct coord *c, struct coord_conn *conn, uint32_t request)
{
    struct coord_settling *s;
    struct action *a;

    if (!c->env.keeps) {
        reply_answer(c, conn, request, "");
        return;
    }
    s = calloc(1, sizeof *s);
    a = actions_add(&c->actions, ACT_SETTLE, conn->id);
    if (!a || !s) {
        free(s);
        c->actions.failed = true;
        return;
    }
    a->request = request;
    s->request = request;
    s->since_ms = c->now_ms;
    s->next = conn->settling;
    conn->settling = s;
    conn->answers++;
}

void
reply_kept(struct coord *c, struct coord_conn *conn, uint32_t request)
{
    struct coord_settling **at = &conn->settling;

    while (*at && (*at)->request != request)
        at = &(*at)->next;
    if (!*at)
        return; /* tell_unsettled() has answered */
    telling_drop_settling(conn, at);
    reply_answer(c, conn, request, "");
}

/* While the disk is full, answer requests whose changes have waited too long to
 * be kept.  The end of a job that waits for room is kept within a second, for
 * it makes room; other changes wait for room themselves. */
static void
tell_unsettled(struct coord *c, struct coord_conn *conn)
{
    struct coord_settling **at = &conn->settling;

    while (*at) {
        if (c->now_ms - (*at)->since_ms < FULL_MS) {
            at = &(*at)->next;
            continue;
        }
        desk_reply_failed(c, conn, (*at)->request, NULL, EX_TEMPFAIL,
                          "it is done, but the coordinator's disk is full: a "
                          "restart before there is room may undo it");
        telling_drop_settling(conn, at);
    }
}

void
reply_tick(struct coord *c)
{
    for (struct coord_conn *conn = c->conns; c->full && conn; conn = conn->next)
        tell_unsettled(c, conn);
}

bool
reply_refused(struct coord *c, const struct coord_conn *conn,
              const struct msg *m, reply_limit_fn *limit)
{
    struct rad_error err = { 0 };

    if (limit(c, conn, &err) == 0)
        return false;
    desk_reply_failed(c, conn, m->request, NULL, rad_exit_status(err.code),
                      err.what);
    return true;
}

static bool
may_steer(const struct coord_conn *conn, const struct job *job)
{
    return conn->session == MSG_AT_COORD_ADMIN ||
           strcmp(conn->owner, job->owner) == 0;
}

/* Tell the sender that there is no such job.  If the job was forgotten its
 * owner and admins are told why. */
static void
reply_no_job(struct coord *c, struct coord_conn *conn, uint32_t request,
             const uint8_t *id)
{
    char hex[MSG_JOB_HEX], text[MSG_MAX_TEXT + 1] = "no such job";
    const struct saved_gone *g;

    msg_job_format(id, hex);
    g = bygone_find(c, hex);
    if (g && (conn->session == MSG_AT_COORD_ADMIN ||
              strcmp(conn->owner, g->owner) == 0))
        bygone_text(g, text);
    desk_reply_failed(c, conn, request, id, EX_NOINPUT, text);
}

struct job *
reply_find_job(struct coord *c, struct coord_conn *conn, uint32_t request,
               const uint8_t *id, bool look)
{
    struct job *job = desk_find_job(c, id);

    if (!job) {
        reply_no_job(c, conn, request, id);
        return NULL;
    }
    if (!may_steer(conn, job) &&
        !(look && conn->session == MSG_AT_COORD_OBSERVER)) {
        desk_reply_failed(c, conn, request, id, EX_NOPERM,
                          "the job belongs to another user");
        return NULL;
    }
    return job;
}
