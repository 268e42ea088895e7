/* host_pass.c - passes of strict units, by the real team (tests/sim/task.h)
 *
 * A pixel that the team traces costs its part of the row (map.h).  Costs gather
 * up to a slice, which then takes its time; so nothing is early by more than
 * that. */
#include "config.h"

#include "host_impl.h"

#define SLICES 64 /* of a line of mean cost */

/* Let what was traced take its time. */
static void
pay(struct host *h)
{
    if (h->owed > 0 && !h->task.dropped)
        task_yield(&h->task);
}

static bool
trace(void *arg, struct rad_ctx *ctx, int x, int y, struct rad_pixel *out)
{
    struct host *h = arg;
    const struct map *m = host_map(h);

    (void)ctx;
    *out = (struct rad_pixel){ .L = map_pixel(m, x, y) };
    if (h->task.dropped)
        return true;
    h->traced++;
    h->owed += map_pixel_cost(m, h->task.unit.frame, y);
    if (h->owed * m->nframes * m->nlines * SLICES > m->total)
        pay(h);
    return true;
}

/* Send the rows that are made and not sent; total: what the unit cost, if they
 * are its last. */
static void
send_rows(struct host *h, const struct msg_counts *total)
{
    struct task *t = &h->task;

    host_rows_send(h, t->unit.unit, t->unit.attempt, t->unit.width, t->nsent,
                   t->nrows - t->nsent, total ? t->nrows : UINT32_MAX, total);
    t->nsent = t->nrows;
}

static void
on_row(void *arg, int row, const struct rad_pixel *pixels)
{
    struct host *h = arg;
    struct task *t = &h->task;

    (void)row;
    (void)pixels;
    pay(h);
    if (t->dropped)
        return;
    if (t->nrows - t->nsent >= host_rows_piece(h, t->unit.width))
        send_rows(h, NULL);
    t->nrows++;
}

/* The bottom goes out before the bar above it is begun. */
static void
on_bottom(void *arg)
{
    pay(arg);
}

bool
host_pass_begin(struct host *h)
{
    const struct team_spec spec = { .sampler = host_map(h)->q,
                                    .trace = trace,
                                    .truth.rows = on_row,
                                    .bottom = on_bottom,
                                    .arg = h };
    struct strict_pass *p = strict_next(h->strict, STRICT_AHEAD);

    if (!p)
        return false;
    task_begin(&h->task, &spec, p, NULL);
    h->pass_s = 0;
    host_time_tell(h, "begins");
    return true;
}

static void
end(struct host *h)
{
    struct msg_counts spent = host_counts(h, h->pass_s, h->pass_s, 0), total;
    bool whole = task_end(&h->task, h->strict, &spent, &total);

    host_flush(h);
    if (whole || h->task.nrows > h->task.nsent)
        send_rows(h, whole ? &total : NULL);
    task_release(&h->task);
}

static void
paid(void *arg, struct event *e)
{
    struct host *h = host_alive(arg, e);

    if (!h)
        return;
    h->working = false;
    host_go_on(h);
}

bool
host_pass_trace(struct host *h)
{
    double seconds;

    task_run(&h->task);
    if (h->owed > 0) {
        seconds = host_seconds(h, h->owed);
        h->owed = 0;
        h->pass_s += seconds;
        host_spend(h, seconds, paid);
        return true;
    }
    end(h);
    return false;
}
