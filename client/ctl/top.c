/* top.c - the state of radctl top, and what keys do to it; see top.h */
#include "config.h"

#include "ctl/top.h"

#include "ctl/row.h"
#include "ctl/top_rows.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PAGE = 10 };

void
top_init(struct top *t)
{
    *t = (struct top){ .pane = TOP_JOBS };
    for (int p = 0; p < TOP_NPANE; p++)
        t->list[p].sort = -1;
}

void
top_release(struct top *t)
{
    for (int p = 0; p < TOP_NPANE; p++) {
        json_decref(t->list[p].rows);
        json_decref(t->list[p].rates);
    }
    json_decref(t->status);
    json_decref(t->stats);
}

/* --- new data --- */

/* The mean of a row's new rate and its last mean, while it is at work: workers
 * report their rays in lumps. */
static double
steady(const struct top *t, enum top_pane pane, const json_t *row, double rate)
{
    const json_t *was =
        json_object_get(t->list[pane].rates, top_name(pane, row));
    const char *state = row_text(row, "state");
    bool works = strcmp(state, "working") == 0 || strcmp(state, "running") == 0;

    return was && works ? (json_number_value(was) + rate) / 2 : rate;
}

/* Rays a second of each row since the rows before. */
static json_t *
rates_of(const struct top *t, enum top_pane pane, const json_t *rows, double s)
{
    json_t *rates = json_object(), *row;
    size_t i;

    json_array_foreach(rows, i, row)
    {
        const char *name = top_name(pane, row);
        const json_t *was = top_row(t, pane, name);
        const json_t *then = json_object_get(was, "rays");
        const json_t *now = json_object_get(row, "rays");
        double more = json_number_value(now) - json_number_value(then);

        /* a worker's sum gets smaller when a job of its ends */
        if (then && now && s > 0 && more >= 0)
            json_object_set_new(rates, name,
                                json_real(steady(t, pane, row, more / s)));
    }
    return rates;
}

/* Drop the earlier of two rows of a job: it ended after the open jobs were
 * told, and was told again among those that are over. */
static void
drop_earlier(json_t *jobs)
{
    json_t *seen = json_object();

    for (size_t i = json_array_size(jobs); i-- > 0;) {
        const char *name = top_name(TOP_JOBS, json_array_get(jobs, i));

        if (json_object_get(seen, name))
            json_array_remove(jobs, i);
        else
            json_object_set_new(seen, name, json_true());
    }
    json_decref(seen);
}

void
top_take(struct top *t, double now_s, json_t *status, json_t *workers,
         json_t *jobs, json_t *stats)
{
    json_t *rows[TOP_NPANE] = { workers, jobs };

    drop_earlier(jobs);
    json_decref(t->stats);
    t->stats = stats;
    for (int p = 0; p < TOP_NPANE; p++) {
        json_t *rates = rates_of(t, (enum top_pane)p, rows[p],
                                 t->at_s > 0 ? now_s - t->at_s : 0);

        json_decref(t->list[p].rows);
        json_decref(t->list[p].rates);
        t->list[p].rows = rows[p];
        t->list[p].rates = rates;
    }
    json_decref(t->status);
    t->status = status;
    t->at_s = now_s;
    t->lost = false;
}

/* --- keys --- */

static void
move(struct top *t, int by)
{
    struct top_list *l = &t->list[t->pane];
    size_t n;
    const json_t **v = top_rows(t, t->pane, &n);
    long at;

    if (v && n > 0) {
        at = (long)top_place(v, n, t->pane, l->chosen) + by;
        at = at < 0 ? 0 : at >= (long)n ? (long)n - 1 : at;
        snprintf(l->chosen, sizeof l->chosen, "%s", top_name(t->pane, v[at]));
    }
    free(v);
}

static enum top_wish
edit_filter(struct top *t, int key)
{
    size_t n = strlen(t->filter);

    if (key == TOP_KEY_ENTER || key == TOP_KEY_BACK)
        t->editing = false;
    if (key == TOP_KEY_BACK)
        t->filter[0] = '\0';
    else if (key == TOP_KEY_ERASE && n > 0)
        t->filter[n - 1] = '\0';
    else if (key >= ' ' && key < 127 && n + 1 < sizeof t->filter) {
        t->filter[n] = (char)key;
        t->filter[n + 1] = '\0';
    }
    return TOP_NOTHING;
}

static enum top_wish
answer(struct top *t, int key)
{
    enum top_wish asked = t->asked;

    t->asked = TOP_NOTHING;
    t->note[0] = '\0';
    return key == 'y' || key == 'Y' ? asked : TOP_NOTHING;
}

/* Ask the user to confirm. */
static enum top_wish
ask(struct top *t, enum top_wish what, const char *verb, const char *name)
{
    if (!name[0])
        return TOP_NOTHING;
    t->asked = what;
    snprintf(t->about, sizeof t->about, "%s", name);
    snprintf(t->note, sizeof t->note, "%s %.64s? y/n", verb, name);
    return TOP_NOTHING;
}

static enum top_wish
ask_about_job(struct top *t, int key)
{
    const json_t *row =
        t->job[0] ? top_row(t, TOP_JOBS, t->job) : top_chosen(t, TOP_JOBS);
    bool paused = strcmp(row_text(row, "state"), "paused") == 0;

    if (key == 'c')
        return ask(t, TOP_CANCEL, "cancel job", row_text(row, "job"));
    return ask(t, paused ? TOP_RESUME : TOP_PAUSE,
               paused ? "go on with job" : "pause job", row_text(row, "job"));
}

static enum top_wish
ask_about_worker(struct top *t)
{
    const json_t *row = top_chosen(t, TOP_WORKERS);
    const char *state = row_text(row, "state");
    bool drained =
        strcmp(state, "drained") == 0 || strcmp(state, "draining") == 0;

    return ask(t, drained ? TOP_UNDRAIN : TOP_DRAIN,
               drained ? "give work again to" : "drain worker",
               row_text(row, "name"));
}

static enum top_wish
look_into(struct top *t)
{
    if (t->pane != TOP_JOBS || t->job[0])
        return TOP_NOTHING;
    snprintf(t->job, sizeof t->job, "%s",
             top_name(TOP_JOBS, top_chosen(t, TOP_JOBS)));
    json_decref(t->stats); /* they are another job's */
    t->stats = NULL;
    t->scroll = 0;
    return t->job[0] ? TOP_LOOK : TOP_NOTHING;
}

static enum top_wish
leave(struct top *t, int key)
{
    if (t->job[0]) {
        t->job[0] = '\0';
        return TOP_LOOK; /* the lists may leave out jobs that are over */
    }
    if (key == 'q')
        return TOP_QUIT;
    t->filter[0] = '\0';
    return TOP_NOTHING;
}

static enum top_wish
scroll(struct top *t, int by)
{
    if (!t->job[0]) {
        move(t, by);
        return TOP_NOTHING;
    }
    t->scroll = t->scroll + by < 0 ? 0 : t->scroll + by;
    return TOP_NOTHING;
}

/* Keys that change how the lists are shown. */
static enum top_wish
arrange(struct top *t, int key)
{
    struct top_list *l = &t->list[t->pane];

    switch (key) {
    case '\t':
        t->pane = t->pane == TOP_JOBS ? TOP_WORKERS : TOP_JOBS;
        break;
    case 's':
        l->sort = l->sort + 1 < top_ncolumns(t->pane) ? l->sort + 1 : -1;
        break;
    case 'r':
        l->back = !l->back;
        break;
    case '/':
        t->editing = true;
        break;
    case 'a':
        t->closed = !t->closed;
        return TOP_LOOK;
    default:
        break;
    }
    return TOP_NOTHING;
}

enum top_wish
top_key(struct top *t, int key)
{
    if (t->asked != TOP_NOTHING)
        return answer(t, key);
    if (t->editing)
        return edit_filter(t, key);
    if (!t->lost)
        t->note[0] = '\0';
    switch (key) {
    case 'q':
    case TOP_KEY_BACK:
        return leave(t, key);
    case TOP_KEY_UP:
        return scroll(t, -1);
    case TOP_KEY_DOWN:
        return scroll(t, 1);
    case TOP_KEY_PAGE_UP:
        return scroll(t, -PAGE);
    case TOP_KEY_PAGE_DOWN:
        return scroll(t, PAGE);
    case TOP_KEY_ENTER:
        return look_into(t);
    case 'c':
    case 'p':
        return ask_about_job(t, key);
    case 'd':
        return t->job[0] ? TOP_NOTHING : ask_about_worker(t);
    default:
        return t->job[0] ? TOP_NOTHING : arrange(t, key);
    }
}
