/* model.c - see model.h
 *
 * A round of requests asks for the status, the workers, the open jobs, the
 * running jobs if more jobs are open than are listed, and the jobs that are
 * over.  Each list comes page by page; the next request is sent when an answer
 * has come.  With the last answer of a round all lists are replaced at once. */
#include "config.h"

#include "observer/model.h"

#include "machine/lists.h"
#include "observer/markup.h"

#include <string.h>

enum {
    STEP_NONE,
    STEP_STATUS,
    STEP_WORKERS,
    STEP_OPEN,
    STEP_RUNNING,
    STEP_OVER
};

#define RATE_MS 2500 /* least time over which rays per second are measured */

static void ask_step(struct model *m);

/* --- a round --- */

static void
drop_round(struct model *m)
{
    json_decref(m->coming);
    json_decref(m->next_status);
    json_decref(m->next_workers);
    json_decref(m->next_open);
    json_decref(m->next_over);
    m->coming = m->next_status = m->next_workers = NULL;
    m->next_open = m->next_over = NULL;
    m->round = STEP_NONE;
    m->text = 0;
    m->cursor = 0;
}

static void
fail_round(struct model *m)
{
    bool was = m->up;

    drop_round(m);
    m->sums.lost++;
    m->up = false;
    m->rays_s = m->at_work = 0;
    m->rate_ms = 0;
    m->due_ms = uv_now(m->loop) + MODEL_BUSY_MS;
    if (was) {
        m->version++;
        m->changed(m->arg);
    }
}

/* --- sums --- */

/* How much a counter of a job has risen since it was last added to the sums. */
static double
rise(json_t *seen, const json_t *row, const char *key)
{
    double now = markup_number(row, key), had = markup_number(seen, key);

    if (now <= had)
        return 0;
    json_object_set_new(seen, key, json_real(now));
    return now - had;
}

static void
count_end(struct model *m, json_t *seen, const json_t *row, bool before)
{
    const char *state = markup_member(row, "state");

    if (json_object_get(seen, "over"))
        return;
    json_object_set_new(seen, "over", json_true());
    if (before)
        return; /* the job was over before radweb saw it */
    m->sums.done += strcmp(state, "done") == 0;
    m->sums.failed += strcmp(state, "failed") == 0;
    m->sums.cancelled += strcmp(state, "cancelled") == 0;
}

/* Add the work that the jobs of a list did since the last round to the sums.
 * `next` gets the counters of each job as they are now.  All work of a job that
 * is seen for the first time counts if the job is new: if it is open, or if it
 * is over and stands ahead of all known jobs, the newest being first.  It does
 * not count in the first round, nor after a round that did not list all open
 * jobs: the job may be old. */
static void
count_list(struct model *m, const json_t *list, bool over, json_t *next)
{
    bool first = m->sums.polls == 1, known = false;
    const json_t *row;
    size_t i;

    json_array_foreach(list, i, row)
    {
        const char *id = markup_member(row, "job");
        json_t *had = json_object_get(m->counted, id);
        json_t *seen = had ? json_incref(had) : json_object();
        double rays = rise(seen, row, "rays");
        double bytes = rise(seen, row, "bytes");
        double redundant = rise(seen, row, "ambient_redundant");
        bool before = first || (!had && (m->was_cut || (over && known)));

        known |= had != NULL;
        if (over)
            count_end(m, seen, row, before);
        m->sums.rays += before ? 0 : rays;
        m->sums.bytes += before ? 0 : bytes;
        m->sums.redundant += before ? 0 : redundant;
        json_object_set_new(next, id, seen);
    }
}

/* Keep the counters of jobs that are not listed now, in case a job is listed
 * again. */
static void
keep_counted(const struct model *m, json_t *next)
{
    const char *id;
    json_t *seen;

    json_object_foreach(m->counted, id, seen)
    {
        if (json_object_size(next) >= MODEL_COUNTED)
            return;
        if (!json_object_get(next, id))
            json_object_set(next, id, seen);
    }
}

static void
count_jobs(struct model *m)
{
    json_t *next = json_object();

    count_list(m, m->open, false, next);
    count_list(m, m->over, true, next);
    if (m->cut)
        keep_counted(m, next);
    m->was_cut = m->cut;
    json_decref(m->counted);
    m->counted = next;
}

/* The share of connected workers' threads whose worker is at work, 0 to 1. */
static double
share_at_work(const json_t *workers)
{
    double all = 0, busy = 0;
    const json_t *row;
    size_t i;

    json_array_foreach(workers, i, row)
    {
        double n = markup_number(row, "threads");
        const char *state = markup_member(row, "state");

        if (strcmp(state, "gone") == 0)
            continue;
        all += n;
        busy += strcmp(state, "working") == 0 || markup_number(row, "units") > 0
                    ? n
                    : 0;
    }
    return all > 0 ? busy / all : 0;
}

static void
take_rates(struct model *m, uint64_t now)
{
    m->at_work = share_at_work(m->workers);
    if (m->rate_ms == 0) {
        m->rate_ms = now;
        m->rate_rays = m->sums.rays;
    } else if (now - m->rate_ms >= RATE_MS) {
        m->rays_s =
            (m->sums.rays - m->rate_rays) / ((double)(now - m->rate_ms) / 1000);
        m->rate_ms = now;
        m->rate_rays = m->sums.rays;
    }
    history_note(&m->history, now, m->rays_s, m->at_work);
}

/* --- the end of a round --- */

static void
replace(json_t **at, json_t **by)
{
    json_decref(*at);
    *at = *by;
    *by = NULL;
}

static void
end_round(struct model *m)
{
    uint64_t now = uv_now(m->loop);
    json_t *open = lists_served(m->next_open);

    json_decref(m->next_open);
    m->next_open = NULL;
    replace(&m->open, &open);
    replace(&m->status, &m->next_status);
    replace(&m->workers, &m->next_workers);
    replace(&m->over, &m->next_over);
    m->round = STEP_NONE;
    m->up = true;
    m->asked_ms = now;
    m->sums.polls++;
    count_jobs(m);
    take_rates(m, now);
    m->due_ms = now + (now - m->seen_ms < MODEL_SEEN_MS ? MODEL_BUSY_MS
                                                        : MODEL_IDLE_MS);
    m->version++;
    m->changed(m->arg);
}

/* --- answers --- */

static size_t
most_rows(unsigned step)
{
    return step == STEP_WORKERS ? MODEL_WORKERS
           : step == STEP_OVER  ? MODEL_OVER
                                : MODEL_OPEN;
}

/* Append the rows of jobs that `rows` does not have yet. */
static void
merge(json_t *rows, const json_t *more)
{
    json_t *ids = json_object();
    json_t *row;
    size_t i;

    json_array_foreach(rows, i, row)
        json_object_set_new(ids, markup_member(row, "job"), json_true());
    json_array_foreach(
        more, i, row) if (!json_object_get(ids, markup_member(row, "job")))
        json_array_append(rows, row);
    json_decref(ids);
}

/* End a step: its list has all rows or, if cut, as many as are shown.  Go on
 * with the next step. */
static void
end_list(struct model *m, bool cut)
{
    json_t *rows = m->coming;

    m->coming = NULL;
    m->text = 0;
    m->cursor = 0;
    switch (m->round++) {
    case STEP_WORKERS:
        m->next_workers = rows;
        break;
    case STEP_OPEN:
        m->next_open = rows;
        m->cut = cut;
        m->round += !cut;
        break;
    case STEP_RUNNING:
        merge(m->next_open, rows);
        json_decref(rows);
        break;
    default:
        m->next_over = rows;
        end_round(m);
        return;
    }
    ask_step(m);
}

static void
take_page(struct model *m, json_t *page, size_t text)
{
    json_int_t next = json_integer_value(json_object_get(page, "next"));
    json_t *rows = json_object_get(page, "rows");

    m->text += text;
    if (m->text > MODEL_TEXT || !json_is_array(rows) ||
        json_array_extend(m->coming, rows) < 0 ||
        (next != 0 && (uint64_t)next == m->cursor)) {
        fail_round(m);
        return;
    }
    m->cursor = (uint64_t)next;
    if (next == 0 || json_array_size(m->coming) >= most_rows(m->round))
        end_list(m, next != 0);
    else
        ask_step(m);
}

static void
on_answer(void *arg, const struct session_answer *a)
{
    struct model *m = arg;
    json_t *root = a->status == 0 ? json_loadb((const char *)a->bytes, a->n,
                                               JSON_REJECT_DUPLICATES, NULL)
                                  : NULL;

    if (m->round == STEP_NONE) {
        json_decref(root);
        return;
    }
    if (!json_is_object(root)) {
        json_decref(root);
        fail_round(m);
        return;
    }
    if (m->round != STEP_STATUS) {
        take_page(m, root, a->n);
        json_decref(root);
        return;
    }
    m->next_status = root;
    m->round = STEP_WORKERS;
    ask_step(m);
}

static const char *const list_states[] = { [STEP_WORKERS] = "",
                                           [STEP_OPEN] = "open",
                                           [STEP_RUNNING] = "running",
                                           [STEP_OVER] = "over" };

static void
ask_step(struct model *m)
{
    struct msg q = { .type = MSG_QUERY, .query = { MSG_QUERY_STATUS, "" } };

    if (m->round != STEP_STATUS) {
        if (!m->coming)
            m->coming = json_array();
        q = (struct msg){ .type = MSG_PAGE };
        q.page.what =
            m->round == STEP_WORKERS ? MSG_ROWS_WORKERS : MSG_ROWS_JOBS;
        q.page.user = "";
        q.page.state = list_states[m->round];
        q.page.cursor = m->cursor;
        q.page.most = m->round == STEP_OVER ? MODEL_OVER : 0;
    }
    if (!session_ask(m->session, &q, MSG_MAX, false, on_answer, m))
        fail_round(m);
}

/* --- public --- */

void
model_tick(struct model *m)
{
    uint64_t now = uv_now(m->loop);

    history_advance(&m->history, now);
    if (!session_is_up(m->session)) {
        if (m->up || m->round != STEP_NONE)
            fail_round(m);
        return;
    }
    if (m->round != STEP_NONE || now < m->due_ms)
        return;
    m->round = STEP_STATUS;
    m->cursor = 0;
    ask_step(m);
}

void
model_seen(struct model *m)
{
    uint64_t now = uv_now(m->loop);

    m->seen_ms = now;
    if (m->due_ms > now + MODEL_BUSY_MS)
        m->due_ms = now;
}

bool
model_init(struct model *m, uv_loop_t *loop, struct session *s,
           void (*changed)(void *arg), void *arg)
{
    *m = (struct model){ .session = s,
                         .loop = loop,
                         .status = json_object(),
                         .workers = json_array(),
                         .open = json_array(),
                         .over = json_array(),
                         .counted = json_object(),
                         .changed = changed,
                         .arg = arg };
    history_advance(&m->history, uv_now(loop));
    return m->status && m->workers && m->open && m->over && m->counted;
}

void
model_release(struct model *m)
{
    drop_round(m);
    json_decref(m->status);
    json_decref(m->workers);
    json_decref(m->open);
    json_decref(m->over);
    json_decref(m->counted);
}
