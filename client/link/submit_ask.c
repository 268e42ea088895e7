/* submit_ask.c - questions about the cluster; see submit_impl.h */
#include "config.h"

#include "link/submit_impl.h"

#include <jansson.h>
#include <string.h>

enum { REASON_MS = 10000 }; /* least time between questions for a reason */

/* Ask the coordinator about the cluster.  *answer is NULL if it refuses, or if
 * the job has ended meanwhile. */
static int
ask(struct submit *s, struct msg *m, const struct msg_answer **answer)
{
    const struct msg *got;
    int rc;

    *answer = NULL;
    m->request = ++s->request;
    s->fetching = true; /* so that a refusal does not end the job */
    rc = link_send(s->link, m, s->err);
    do
        rc = rc < 0 ? rc : submit_next(s, &got);
    while (rc == 0 ||
           (rc == 1 && got->request != s->request && !submit_is_done(s)));
    s->fetching = false;
    if (rc == 1 && got->request == s->request && got->type == MSG_ANSWER)
        *answer = &got->answer;
    return rc < 0 ? rc : 0;
}

/* Ask for the job's row and tell its text, as radctl jobs shows it. */
static int
ask_row(struct submit *s)
{
    struct msg m = { .type = MSG_QUERY, .query = { MSG_QUERY_JOB, s->id } };
    const struct msg_answer *answer;
    const char *text;
    json_t *row;
    int rc = ask(s, &m, &answer);

    if (rc < 0 || !answer)
        return rc;
    row = json_loadb((const char *)answer->text, answer->len, 0, NULL);
    text = json_string_value(json_object_get(row, "text"));
    s->cb->reason(s->cb->arg, text ? text : "");
    json_decref(row);
    return 0;
}

int
submit_ask_reason(struct submit *s)
{
    if (!s->cb->reason || s->ending != ENDING_NONE ||
        !s->cb->wonders(s->cb->arg) || submit_now_ms(s) < s->reason_due_ms)
        return 0;
    s->reason_due_ms = submit_now_ms(s) + REASON_MS;
    return ask_row(s);
}

int
submit_ask_workers(struct submit *s, struct roll *r)
{
    struct msg_page all = { .what = MSG_ROWS_WORKERS, .user = "", .state = "" };
    struct msg m = { .type = MSG_PAGE, .page = all };
    const struct msg_answer *answer;
    uint64_t next = 0;
    int rc;

    *r = (struct roll){ 0 };
    for (;; m.page.cursor = next) {
        if ((rc = ask(s, &m, &answer)) < 0 || submit_is_done(s))
            return rc;
        if ((rc = roll_page(r, answer, &next, s->err)) < 0)
            return rc;
        if (next <= m.page.cursor)
            return 0;
    }
}
