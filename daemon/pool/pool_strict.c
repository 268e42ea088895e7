/* pool_strict.c - the strict units' machine (strict.h) in the pool
 *
 * After each call of the machine, and each change of a pass, all passes are
 * looked at, under the pool's lock. */
#include "config.h"

#include "pool/pool_impl.h"

void
pool_settle_waits_locked(struct pool *p)
{
    double now, waited;

    if (!p->strict)
        return;
    now = pool_seconds(CLOCK_MONOTONIC);
    waited = p->waits ? p->idle * (now - p->waits_at) : 0;
    p->busy_s += waited;
    p->wait_s += waited;
    p->waits = strict_waits(p->strict);
    p->waits_at = now;
}

void
pool_look_locked(struct pool *p)
{
    for (struct active *u = p->active; u; u = u->next)
        if (u->pass)
            strict_look(p->strict, u->pass, u->team);
}

void
pool_changed_locked(struct pool *p)
{
    pool_look_locked(p);
    /* a new bottom may prove another unit's top true, and end its pass */
    pool_look_locked(p);
    pool_settle_waits_locked(p);
    uv_cond_broadcast(&p->work);
    wake_send(&p->wake);
}

void
pool_on_bottom(void *arg)
{
    struct active *u = arg;

    uv_mutex_lock(&u->pool->mu);
    pool_changed_locked(u->pool);
    uv_mutex_unlock(&u->pool->mu);
}

void
pool_on_help(void *arg)
{
    struct pool *p = ((struct active *)arg)->pool;

    uv_mutex_lock(&p->mu);
    if (p->idle > 0)
        uv_cond_broadcast(&p->work);
    uv_mutex_unlock(&p->mu);
}

void
pool_end_pass_locked(struct active *u)
{
    struct pool *p = u->pool;
    struct msg_counts spent = u->counts;
    struct team_bottom b;
    int finished;

    spent.primary_rays = team_primary(u->team);
    if (team_blocked(u->team, &finished))
        strict_blocked(u->pass, finished);
    strict_cut(p->strict, u->pass, u->team);
    team_bottom(u->team, &b);
    u->pass->finished = finished;
    u->pass->made = team_made(u->team);
    u->whole = strict_ended(p->strict, u->pass, team_done(u->team), &b, &spent,
                            &u->counts);
    u->pass = NULL;
    pool_changed_locked(p);
}

struct strict *
pool_lock_strict(struct pool *p)
{
    uv_mutex_lock(&p->mu);
    return p->strict;
}

void
pool_unlock_strict(struct pool *p)
{
    pool_changed_locked(p);
    uv_mutex_unlock(&p->mu);
}

uint64_t
pool_tick(struct pool *p, uint64_t now_ms)
{
    uint64_t due;

    uv_mutex_lock(&p->mu);
    pool_look_locked(p);
    due = strict_tick(p->strict, now_ms);
    pool_settle_waits_locked(p);
    if (p->idle > 0 && strict_has_work(p->strict))
        uv_cond_broadcast(&p->work);
    uv_mutex_unlock(&p->mu);
    return due;
}

const struct msg *
pool_message(struct pool *p, bool room)
{
    const struct msg *m;

    uv_mutex_lock(&p->mu);
    m = p->strict ? strict_message(p->strict, room) : NULL;
    uv_mutex_unlock(&p->mu);
    return m;
}

int
pool_error(struct pool *p)
{
    int rc;

    uv_mutex_lock(&p->mu);
    rc = p->strict ? strict_error(p->strict) : 0;
    uv_mutex_unlock(&p->mu);
    return rc;
}
