/* ctl_list.c - radctl's lists of workers and jobs, and its answers about the
 * coordinator */
#include "config.h"

#include "ctl/ctl.h"
#include "base/number.h"
#include "common/table.h"
#include "common/tell.h"
#include "machine/lists.h"

#include <pwd.h>
#include <stdio.h>
#include <string.h>

/* A column that is printed: the member of a row, and the column's title. */
struct column {
    const char *key, *head;
};

/* The columns of the list of jobs; --json and `job` have more. */
static const struct column job_columns[] = {
    { "job", "job" },           { "state", "state" },
    { "done", "done" },         { "owner", "owner" },
    { "priority", "priority" }, { "workers", "workers" },
    { "elapsed_s", "time" },    { "name", "name" },
    { "text", "note" },         { NULL, NULL },
};
static const struct column worker_columns[] = {
    { "name", "name" },     { "state", "state" },     { "threads", "threads" },
    { "units", "units" },   { "address", "address" }, { "program", "program" },
    { "since_s", "since" }, { "text", "note" },       { NULL, NULL },
};

/* A member of a row, made readable. */
static json_t *
readable(const json_t *row, const char *key)
{
    json_t *value = json_object_get(row, key);
    double v = json_number_value(value);
    char span[CTL_SPAN];

    if (strcmp(key, "text") == 0 && /* the text would only repeat the state */
        json_equal(value, json_object_get(row, "state")))
        return json_string("");
    if (strcmp(key, "done") == 0) /* rounded down, so 100 means done */
        return json_sprintf("%3d %%", (int)(v * 100));
    if (strcmp(key, "elapsed_s") == 0)
        return json_string(ctl_span(span, v));
    if (strcmp(key, "since_s") == 0)
        return json_sprintf("%s ago", ctl_span(span, v));
    return json_incref(value);
}

static json_t *
for_people(const json_t *rows, const struct column *columns)
{
    json_t *list = json_array(), *shown;
    const json_t *row;
    size_t i;

    json_array_foreach(rows, i, row)
    {
        shown = json_object();
        for (const struct column *c = columns; c->key; c++)
            if (json_object_get(row, c->key))
                json_object_set_new(shown, c->head, readable(row, c->key));
        json_array_append_new(list, shown);
    }
    return list;
}

/* --- which rows are shown --- */

static const char *const job_states[] = { "waiting",   "running", "paused",
                                          "held",      "done",    "failed",
                                          "cancelled", "open",    "over",
                                          "forgotten", NULL };
static const char *const worker_states[] = { "idle",     "loading", "working",
                                             "draining", "drained", "no room",
                                             "gone",     NULL };
static const char *const key_states[] = { "valid", "expired", "retired", NULL };

int
ctl_check_list(struct ctl *c)
{
    bool workers = c->command->number == MSG_QUERY_WORKERS;
    const char *const *state = c->command->number == MSG_KEY ? key_states
                               : workers                     ? worker_states
                                                             : job_states;
    char known[200] = "";

    for (; c->state && *state; state++) {
        if (strcmp(c->state, *state) == 0)
            return 0;
        snprintf(known + strlen(known), sizeof known - strlen(known), "%s%s",
                 known[0] ? ", " : "", *state);
    }
    if (c->state)
        return rad_fail(c->err, RAD_EUSAGE,
                        "unknown state '%.40s': expected one of %s", c->state,
                        known);
    return 0;
}

/* The user of --user.  "uid:1002" becomes the login where that is known, on the
 * coordinator's own machine; earlier releases printed such names. */
static const char *
user_of(const struct ctl *c)
{
    const struct passwd *pw;
    int uid;

    if (!c->user)
        return "";
    if (c->local && strncmp(c->user, "uid:", 4) == 0 &&
        rad_parse_int(c->user + 4, &uid) && uid >= 0 &&
        (pw = getpwuid((uid_t)uid)) != NULL)
        return pw->pw_name;
    return c->user;
}

static bool
is_state(const json_t *row, const char *state)
{
    const char *is = json_string_value(json_object_get(row, "state"));

    if (strcmp(state, "over") == 0)
        return lists_is_over(row);
    if (strcmp(state, "open") == 0)
        return !lists_is_over(row) && is && strcmp(is, "forgotten") != 0;
    return is && strcmp(is, state) == 0;
}

void
ctl_filter(const struct ctl *c, json_t *rows, const char *user)
{
    for (size_t i = 0; i < json_array_size(rows);) {
        const json_t *row = json_array_get(rows, i);
        const char *of =
            user ? json_string_value(json_object_get(row, user)) : NULL;
        bool fits = (!c->user || !user || (of && !strcmp(of, user_of(c)))) &&
                    (!c->state || is_state(row, c->state)) &&
                    (c->limit == 0 || i < (size_t)c->limit);

        if (fits)
            i++;
        else
            json_array_remove(rows, i);
    }
}

/* --- getting rows --- */

/* Add the rows of an answer to the list, and set the next cursor. */
static int
add_page(struct ctl *c, const struct msg *answer, json_t *rows,
         struct msg_page *ask)
{
    json_t *page = ctl_parse(c, answer);
    json_int_t next = json_integer_value(json_object_get(page, "next"));
    int rc = 0;

    if (!page)
        return c->err->code;
    if (json_array_extend(rows, json_object_get(page, "rows")) < 0 ||
        (next != 0 && (uint64_t)next == ask->cursor))
        rc = rad_fail(c->err, RAD_EPROTO,
                      "the coordinator's answer is no page of a list");
    ask->cursor = (uint64_t)next;
    json_decref(page);
    return rc;
}

/* Get at most `most` rows of the list, page by page. */
static int
rows_of(struct ctl *c, const struct msg_page *ask, size_t most, json_t **rows)
{
    struct msg m = { .type = MSG_PAGE, .page = *ask };
    const struct msg *answer;
    int rc;

    m.page.user = user_of(c);
    *rows = json_array();
    do {
        if (most <= UINT32_MAX)
            m.page.most = (uint32_t)(most - json_array_size(*rows));
        rc = ctl_ask(c, &m, &answer);
        if (rc == 0)
            rc = add_page(c, answer, *rows, &m.page);
    } while (rc == 0 && m.page.cursor != 0 && json_array_size(*rows) < most);
    if (rc < 0) {
        json_decref(*rows);
        *rows = NULL;
    }
    return rc;
}

int
ctl_rows(struct ctl *c, const struct msg_page *ask, json_t **rows)
{
    return rows_of(c, ask, c->limit > 0 ? (size_t)c->limit : SIZE_MAX, rows);
}

/* --- printing rows --- */

static void
show(const struct ctl *c, json_t *rows, bool jobs)
{
    json_t *shown = c->json
                        ? json_incref(rows)
                        : for_people(rows, jobs ? job_columns : worker_columns);

    if (json_array_size(shown) == 0 && !c->json)
        puts(jobs ? "no jobs" : "no workers");
    else
        (c->json ? table_print_json : table_print)(stdout, shown);
    json_decref(shown);
}

/* Tell of jobs that the coordinator has forgotten, so that nobody looks for
 * them. */
static int
tell_forgotten(struct ctl *c)
{
    const struct msg_page ask = { .what = MSG_ROWS_JOBS, .state = "forgotten" };
    json_t *rows;
    size_t n;
    int rc;

    if (c->json || c->state)
        return 0;
    if ((rc = rows_of(c, &ask, SIZE_MAX, &rows)) < 0)
        return rc;
    n = json_array_size(rows);
    if (n > 0)
        tell(
            stderr,
            "%zu job%s forgotten, the last was %s: --state=forgotten lists %s",
            n, n == 1 ? " is" : "s are",
            json_string_value(json_object_get(json_array_get(rows, 0), "text")),
            n == 1 ? "it" : "them");
    json_decref(rows);
    return 0;
}

int
ctl_run_list(struct ctl *c)
{
    bool jobs = c->command->number == MSG_QUERY_JOBS;
    struct msg_page ask = { .what = jobs ? MSG_ROWS_JOBS : MSG_ROWS_WORKERS,
                            .state = c->state ? c->state : "" };
    json_t *rows, *list;
    int rc = ctl_rows(c, &ask, &rows);

    if (rc < 0)
        return rc;
    list = jobs ? lists_served(rows) : json_incref(rows);
    show(c, list, jobs);
    json_decref(list);
    json_decref(rows);
    return jobs ? tell_forgotten(c) : 0;
}

/* --- other queries --- */

int
ctl_run_query(struct ctl *c)
{
    const struct msg *answer;
    json_t *root;
    int rc = ctl_query(c, c->command->number, c->arg, &answer);

    if (rc < 0)
        return rc;
    root = ctl_parse(c, answer);
    if (!root)
        return c->err->code;
    if (c->json)
        table_print_json(stdout, root);
    else if (c->command->number == MSG_QUERY_STATUS)
        ctl_tell_status(stdout, root);
    else if (c->command->number == MSG_QUERY_JOB)
        ctl_tell_job(stdout, root);
    else
        table_print(stdout, root);
    json_decref(root);
    return 0;
}

/* limits: a user's limits, and how much of each is used */
int
ctl_run_limits(struct ctl *c)
{
    c->arg = c->user ? user_of(c) : NULL;
    return ctl_run_query(c);
}
