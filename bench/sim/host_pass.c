/* host_pass.c - a pass of strict.c's, as the team goes over it
 *
 * Line by line, base line, then bar, in blocks of columns, each an event; rows
 * of TRUTH go out as they are done.  What is lent is left out. */
#include "config.h"

#include "host_impl.h"

#define PS 1e-12 /* seconds that nobody waits for */

static int
row_of(const struct host *h, int line)
{
    const struct map *m = host_map(h);

    return line < m->nlines ? team_line_row(&m->q, line) : m->q.height;
}

/* Send rows of a TRUTH pass above `row`; total: what the unit cost, if these
 * are its last. */
static void
send_strict_rows(struct host *h, const struct strict_pass *p, int row,
                 const struct msg_counts *total)
{
    uint32_t y = (uint32_t)row_of(h, p->least - 1);
    uint32_t width = (uint32_t)host_map(h)->q.width;

    host_rows_send(h, p->unit, p->attempt, width, (uint32_t)h->sent_row - y,
                   (uint32_t)(row - h->sent_row),
                   total ? (uint32_t)row - y : UINT32_MAX, total);
    h->sent_row = row;
}

/* Rows above `row` are done: out with them when they fill a piece. */
static void
rows_done(struct host *h, int row)
{
    uint32_t width = (uint32_t)host_map(h)->q.width;

    if (row > h->sent_row &&
        (uint32_t)(row - h->sent_row) >= host_rows_piece(h, width))
        send_strict_rows(h, h->pass, row, NULL);
}

void
host_pass_end(struct host *h, bool done)
{
    struct strict_pass *p = h->pass, was = *p;
    uint64_t pixels = (uint64_t)host_map(h)->q.width *
                      (uint64_t)(row_of(h, h->last) - row_of(h, p->first)) / 2;
    struct msg_counts total;
    bool blocked = done && h->skipped && p->mode == TEAM_TRUTH;
    struct msg_counts spent =
        host_counts(h, h->pass_s, h->pass_s,
                    p->mode == TEAM_TRUTH && !blocked ? pixels : 0);

    if (blocked) {
        done = false;
        strict_blocked(h->strict, p, h->last - 1);
        if (row_of(h, h->last - 1) > h->sent_row)
            send_strict_rows(h, p, row_of(h, h->last - 1), NULL);
    }
    if (!done && !blocked && p->mode == TEAM_TRUTH &&
        row_of(h, h->line) > h->sent_row) /* it goes on from there */
        send_strict_rows(h, p, row_of(h, h->line), NULL);
    h->pass = NULL;
    p->finished = blocked ? h->last - 1 : h->line;
    if (!strict_ended(h->strict, p, done, h->pixels, h->density, &spent,
                      &total))
        return;
    host_flush(h);
    send_strict_rows(h, &was, row_of(h, h->last), &total);
}

/* The base line that the pass is at, or has made, is true from its first column
 * to there: if it is the last one, that may be all that others wait for. */
static void
bottom_until(struct host *h, int end)
{
    const struct rad_quincunx *q = &host_map(h)->q;
    size_t n = rad_quincunx_ndensity(q);

    if (h->pass->true_top && !h->skipped && h->line == h->last - 1)
        strict_bottom(h->strict, h->pass, end,
                      n * (size_t)end / (size_t)q->width, h->pixels,
                      h->density);
}

/* A block of a base line is made. */
static void
tell_bottom(struct host *h)
{
    int x0, x1;

    if (h->in_bar)
        return;
    host_block_columns(h, &x0, &x1);
    if (h->block == host_block_count(h) - 1)
        bottom_until(h, host_map(h)->q.width);
    else if (h->pass->end == TEAM_FROM_LEFT)
        bottom_until(h, x1);
}

void
host_pass_shrink(struct host *h)
{
    int begun = h->line + 1, keep = h->last - (h->last - begun + 1) / 2;

    if (keep == begun && h->pass->mode != TEAM_TRUTH)
        keep++;
    if (keep < strict_least(h->pass))
        keep = strict_least(h->pass);
    if (keep < h->last)
        h->last = keep;
    strict_shrunk(h->strict, h->pass, h->last);
    if (h->in_bar)
        bottom_until(h, host_map(h)->q.width);
}

bool
host_pass_has_bar(const struct host *h)
{
    const struct strict_pass *p = h->pass;

    return (p->mode != TEAM_LINES || h->line < p->filled) && h->line != 0 &&
           (p->mode == TEAM_TRUTH || p->loan || h->line != p->first || p->top);
}

void
host_pass_look(struct host *h)
{
    struct strict_pass *p = h->pass;

    if (!p)
        return;
    h->lent.base &= ~p->back;
    h->lent.bar &= ~p->back;
    p->back = 0;
    if (p->lend > 0)
        host_lend(h);
}

/* On to the next block, base line, then bar, then line; false: the end. */
static bool
step(struct host *h)
{
    const struct strict_pass *p = h->pass;

    if (++h->block < host_block_count(h))
        return true;
    h->block = 0;
    if (!h->in_bar && host_pass_has_bar(h)) {
        h->in_bar = true;
        return true;
    }
    h->in_bar = false;
    h->line++;
    if (p->mode == TEAM_TRUTH && h->line < h->last)
        rows_done(h, row_of(h, h->line));
    return h->line < h->last;
}

static void
traced(void *arg, struct event *e)
{
    struct host *h = host_alive(arg, e);

    if (!h)
        return;
    h->working = false;
    if (h->pass) {
        host_block_fill(h);
        tell_bottom(h);
        if (!step(h))
            host_pass_end(h, !h->pass->stop || h->pass->mode == TEAM_TRUTH);
    }
    host_go_on(h);
}

bool
host_pass_trace(struct host *h)
{
    double seconds;

    for (;;) {
        if (h->pass->stop) {
            host_pass_end(h, false);
            return false;
        }
        if (h->pass->split)
            host_pass_shrink(h);
        host_pass_look(h);
        if (host_block_is_lent(h)) {
            h->skipped |= !h->pass->loan;
        } else {
            seconds = host_seconds(h, host_block_cost(h));
            if (seconds > PS)
                break;
            host_block_fill(h);
            tell_bottom(h);
        }
        if (!step(h)) {
            host_pass_end(h, true);
            return false;
        }
    }
    h->pass_s += seconds;
    h->busy_s += seconds;
    h->working = true;
    host_later(h, 1e6 * seconds, traced);
    return true;
}

bool
host_pass_begin(struct host *h)
{
    h->pass = strict_next(h->strict, STRICT_AHEAD);
    if (!h->pass)
        return false;
    h->line = h->pass->first;
    h->last = h->pass->last;
    h->block = 0;
    h->in_bar = h->pass->loan && !h->pass->loan->base;
    h->lent = h->pass->lent;
    h->skipped = false;
    if (h->pass->loan)
        h->lent.bar |= ~team_blocks_of(&host_map(h)->q, h->pass->loan->x,
                                       h->pass->loan->n);
    if (h->pass->loan)
        h->lent.base |= h->lent.bar;
    h->sent_row = row_of(h, h->pass->out > h->line ? h->pass->out : h->line);
    h->pass_s = 0;
    host_time_tell(h, "begins");
    return true;
}
