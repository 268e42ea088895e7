/* pool_thread.c - the next work of a thread of the pool
 *
 * A thread takes a unit from the queue and renders it as the first member of
 * its team (team.h).  If the queue is empty it joins a team that has lines left
 * to begin, else one whose members it can help with their lines.  So each of
 * many units has a thread of its own, and a single unit, or the last units,
 * have all threads to their last columns.
 *
 * Of a strict unit a team makes one pass at a time; strict_rank.c chooses the
 * next.  Passes under true tops come before passes ahead.  A thread joins a pass
 * of TRUTH or LINES rather than begin a less urgent pass, for other workers may
 * wait for its result. */
#include "config.h"

#include "pool/pool_impl.h"

/* A thread's next work: one of these is set. */
struct work {
    struct pool_tile_work tile;
    bool at_tile;
    struct estimating *estimate;
    struct active *help;
    struct queued *window;
    struct strict_pass *pass;
};

/* A unit with lines left to begin, at least as urgent as `least`. */
static struct active *
find_open_locked(const struct pool *p, enum strict_rank least)
{
    struct active *u = p->active;

    while (u && (u->rank > least || !team_open(u->team)))
        u = u->next;
    return u;
}

/* The most urgent unit with blocks to help with. */
static struct active *
find_help_locked(const struct pool *p)
{
    struct active *best = NULL;

    for (struct active *u = p->active; u; u = u->next)
        if ((!best || u->rank < best->rank) && team_helps(u->team))
            best = u;
    return best;
}

static struct queued *
take_queued_locked(struct pool *p)
{
    struct queued *q = p->todo;

    if (q) {
        p->todo = q->next;
        if (!p->todo)
            p->todo_end = &p->todo;
    }
    return q;
}

/* Strict work at least as urgent as `least`: a pass to begin or help with. */
static bool
find_strict_locked(struct pool *p, enum strict_rank least, struct work *w)
{
    if (p->strict && !(w->pass = strict_next(p->strict, least))) {
        w->help = find_open_locked(p, least);
        if (strict_error(p->strict) < 0)
            wake_send(&p->wake);
    }
    return w->pass || w->help;
}

static bool
find_locked(struct pool *p, struct work *w)
{
    *w = (struct work){ 0 };
    if (p->tiling.passes && (w->at_tile = pool_find_tile_locked(p, &w->tile)))
        return true;
    if (p->tiling.state != POOL_CACHE_READ || p->tiling.frozen)
        return false; /* the cache changes, and units read it */
    if ((w->estimate = pool_find_estimate_locked(p)))
        w->estimate->members++;
    else if (!find_strict_locked(p, STRICT_TRUTH, w) &&
             !(w->window = take_queued_locked(p)) &&
             !find_strict_locked(p, STRICT_LINES, w) &&
             !find_strict_locked(p, STRICT_AHEAD, w) &&
             !(w->help = find_open_locked(p, STRICT_AHEAD)) &&
             !(w->help = find_help_locked(p)))
        return false;
    if (w->help)
        w->help->members++;
    p->beginning += w->window || w->pass;
    return true;
}

/* Wait for work; false: the pool is stopping. */
static bool
find_work(struct pool *p, struct work *w)
{
    bool found = false;

    uv_mutex_lock(&p->mu);
    while (!atomic_load(&p->stopping) && !(found = find_locked(p, w))) {
        pool_settle_waits_locked(p);
        p->idle++;
        uv_cond_wait(&p->work, &p->mu);
        pool_settle_waits_locked(p);
        p->idle--;
    }
    uv_mutex_unlock(&p->mu);
    return found;
}

void
pool_run_thread(void *arg)
{
    struct renderer *by = arg;
    struct work w;

    while (find_work(by->pool, &w)) {
        if (w.at_tile) {
            pool_work_on_tile(by, &w.tile);
            continue;
        }
        if (w.estimate) {
            pool_work_on_estimate(by, w.estimate);
            continue;
        }
        if (!w.help)
            w.help = pool_unit_begin(by->pool, w.window, w.pass);
        if (w.help)
            pool_unit_work(by, w.help);
    }
}
