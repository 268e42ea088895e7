/* ctl_job.c - radctl's commands about jobs, but for fetch */
#include "config.h"

#include "ctl/ctl.h"
#include "base/number.h"
#include "common/table.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

enum {
    ANSWER_MS = 4500,
    AT_ONCE = 64 /* requests without answer: the disk's wait is shared */
};

/* Send the command's message about a job. */
static int
steer(struct ctl *c)
{
    struct msg m = { .type = (uint16_t)c->command->number };
    const struct msg *answer;
    uint8_t job[MSG_JOB];
    int rc = ctl_find_job(c, job);

    if (rc < 0)
        return rc;
    m.cancel.job = job; /* all these messages have the same struct */
    return ctl_ask(c, &m, &answer);
}

/* Take one of the answers that are due to requests first to c->request.  If a
 * job was ended or deleted meanwhile by someone else that is no failure. */
static int
take_answer(struct ctl *c, uint32_t first, unsigned *done)
{
    const struct msg *m;
    int rc;

    for (;;) {
        rc = link_recv(c->link, ANSWER_MS, &m, c->err);
        if (rc < 0)
            return rc;
        if (rc == 0)
            return rad_fail(c->err, RAD_EUNAVAIL,
                            "the coordinator does not answer");
        if (m->request < first || m->request > c->request)
            continue;
        if (m->type == MSG_ANSWER)
            ++*done;
        if (m->type == MSG_FAILED && m->failed.status != EX_USAGE &&
            m->failed.status != EX_NOINPUT)
            return rad_fail(c->err, link_code(m->failed.status), "%s",
                            m->failed.text);
        if (m->type == MSG_ANSWER || m->type == MSG_FAILED)
            return 0;
    }
}

/* Send the command's message for the job of each row, AT_ONCE at a time. */
static int
steer_rows(struct ctl *c, const json_t *rows, unsigned *done)
{
    uint32_t first = c->request + 1, answered = 0;
    size_t n = json_array_size(rows), sent = 0;
    uint8_t job[MSG_JOB];
    int rc = 0;

    while (rc == 0 && answered < n) {
        while (rc == 0 && sent < n && sent - answered < AT_ONCE) {
            struct msg m = { .type = (uint16_t)c->command->number,
                             .request = ++c->request,
                             .cancel = { job } };
            const char *id = json_string_value(
                json_object_get(json_array_get(rows, sent++), "job"));

            if (!id || !msg_job_parse(id, job))
                return rad_fail(c->err, RAD_EPROTO,
                                "the coordinator's answer names no job");
            rc = link_send(c->link, &m, c->err);
        }
        if (rc == 0)
            rc = take_answer(c, first, done);
        answered++;
    }
    return rc;
}

/* cancel --all, delete --all: the user's own jobs, or those of --user */
static int
steer_all(struct ctl *c)
{
    bool cancel = c->command->number == MSG_CANCEL;
    struct msg_page ask = { .what = MSG_ROWS_JOBS,
                            .mine = !c->user,
                            .state = cancel ? "open" : "over" };
    unsigned done = 0;
    json_t *rows;
    int rc;

    if ((rc = ctl_rows(c, &ask, &rows)) < 0)
        return rc;
    rc = steer_rows(c, rows, &done);
    json_decref(rows);
    if (rc == 0 && c->json)
        printf("{ \"ok\": true, \"jobs\": %u }\n", done);
    else if (rc == 0)
        printf("%u job%s %s\n", done, done == 1 ? "" : "s",
               cancel ? "cancelled" : "deleted");
    return rc;
}

/* cancel, delete: jobs by name, or all of a user */
int
ctl_check_job(struct ctl *c)
{
    if (c->all && c->nargs > 0)
        return rad_fail(c->err, RAD_EUSAGE, "command '%s': --all or %s",
                        c->command->name, c->command->arg);
    if (c->user && !c->all)
        return rad_fail(c->err, RAD_EUSAGE, "command '%s': --user needs --all",
                        c->command->name);
    return 0;
}

int
ctl_run_job(struct ctl *c)
{
    int rc = c->all ? steer_all(c) : ctl_each(c, steer);

    return rc < 0 || c->all ? rc : ctl_done(c);
}

int
ctl_check_priority(struct ctl *c)
{
    int n;

    if (!c->name)
        return rad_fail(c->err, RAD_EUSAGE, "command 'priority': missing N");
    if (!rad_parse_int(c->name, &n) || n < -MSG_MOST_PRIORITY ||
        n > MSG_MOST_PRIORITY)
        return rad_fail(c->err, RAD_EUSAGE,
                        "priority: '%.80s' is no whole number from %d to %d",
                        c->name, -MSG_MOST_PRIORITY, MSG_MOST_PRIORITY);
    c->priority = n;
    return 0;
}

int
ctl_run_priority(struct ctl *c)
{
    struct msg m = { .type = MSG_PRIORITY };
    const struct msg *answer;
    uint8_t job[MSG_JOB];
    int rc = ctl_find_job(c, job);

    if (rc < 0)
        return rc;
    m.priority.job = job;
    m.priority.priority = c->priority;
    rc = ctl_ask(c, &m, &answer);
    return rc < 0 ? rc : ctl_done(c);
}

/* Add the job's state to its statistics. */
static int
add_state(struct ctl *c, json_t *stats)
{
    const struct msg *answer;
    json_t *state;
    int rc = ctl_query(c, MSG_QUERY_JOB, c->arg, &answer);

    if (rc < 0)
        return rc;
    state = ctl_parse(c, answer);
    if (!state)
        return c->err->code;
    json_object_update_missing(stats, state);
    json_decref(state);
    return 0;
}

/* job: a summary for people; with --json the statistics so far and the state.
 */
int
ctl_run_job_report(struct ctl *c)
{
    struct rad_memory_out f = { 0 };
    uint8_t job[MSG_JOB];
    json_t *stats = NULL;
    int rc;

    if (!c->json)
        return ctl_run_query(c);
    if ((rc = ctl_find_job(c, job)) < 0)
        return rc;
    rc = ctl_fetch_file(c, job, 0, MSG_WHAT_STATS, INT_MAX, &f);
    if (rc == 0) {
        stats = json_loadb((const char *)f.bytes, f.len, 0, NULL);
        rc = stats ? add_state(c, stats)
                   : rad_fail(c->err, RAD_EPROTO, "the statistics are no JSON");
    }
    if (rc == 0)
        table_print_json(stdout, stats);
    json_decref(stats);
    free(f.bytes);
    return rc;
}
