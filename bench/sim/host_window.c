/* host_window.c - windows, done one after the other */
#include "config.h"

#include "host_impl.h"

#include <stdlib.h>

static void
window_done(void *arg, struct event *e)
{
    struct host *h = host_alive(arg, e);
    struct window *w;
    struct msg_counts counts;
    double seconds;

    if (!h)
        return;
    h->working = false;
    w = h->windows;
    h->windows = w->next;
    seconds = host_seconds(h, map_window(host_map(h), &w->unit));
    counts =
        host_counts(h, seconds, seconds, w->unit.width * w->unit.height / 2);
    host_rows_send(h, w->unit.unit, w->unit.attempt, w->unit.width, 0,
                   w->unit.height, w->unit.height, &counts);
    free(w);
    host_go_on(h);
}

void
host_window_begin(struct host *h)
{
    double cost = map_window(host_map(h), &h->windows->unit);

    host_spend(h, host_seconds(h, cost), window_done);
}

void
host_window_take(struct host *h, const struct msg_unit *u)
{
    struct window *w = sim_alloc(sizeof *w), **at = &h->windows;

    w->unit = *u;
    while (*at)
        at = &(*at)->next;
    *at = w;
}

void
host_window_revoke(struct host *h, const struct msg_attempt *r)
{
    struct window **at = &h->windows;

    if (*at && h->working && !h->task.team)
        at = &(*at)->next; /* it is at the first */
    for (; *at; at = &(*at)->next)
        if ((*at)->unit.unit == r->unit && (*at)->unit.attempt == r->attempt) {
            struct window *w = *at;

            *at = w->next;
            free(w);
            return;
        }
}

void
host_window_forget(struct host *h)
{
    while (h->windows) {
        struct window *w = h->windows;

        h->windows = w->next;
        free(w);
    }
}
