/* render_tell.c - messages of a job's child to radd: rows, those of strict
 * units, TALLY and FAILED */
#include "config.h"

#include "child/render.h"
#include "child/render_impl.h"

#include "net/conn.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sysexits.h>
#include <unistd.h>

/* Time between tallies while rays are traced. */
#define TALLY_MS 500
/* Most time between tallies, so that radd sees that the loop runs. */
#define SIGN_OF_LIFE_MS 10000

int
render_blame_limit(unsigned own, unsigned limit, char *text, size_t size)
{
    size_t n = strlen(text);

    if (own > 0 && own == limit) {
        snprintf(text + n, size - n,
                 ", and the job may have %u MiB (--memory-mib)", own);
        return RAD_EDATA;
    }
    if (limit > 0)
        snprintf(text + n, size - n,
                 ", and a job's process may have %u MiB here (memory_mib)",
                 limit);
    return RAD_ENOMEM;
}

static void
send_failed(struct render *r, const struct rad_error *err)
{
    struct msg m = { .type = MSG_FAILED };
    char text[MSG_MAX_TEXT + 1];
    int code;

    rad_error_format(err, text, sizeof text);
    code = err->code;
    if (code == RAD_ENOMEM || code == UV_ENOMEM)
        code = render_blame_limit(r->start.job_start.memory_mib, r->memory_mib,
                                  text, sizeof text);
    m.failed.job = r->id;
    m.failed.status = (uint16_t)rad_exit_status(code);
    m.failed.text = text;
    if (r->link)
        conn_send(r->link, &m);
}

void
render_end(struct render *r, int status)
{
    if (r->ended)
        return;
    r->ended = true;
    r->status = status;
    uv_timer_stop(&r->drain);
    uv_timer_stop(&r->teller);
    uv_timer_stop(&r->ticker);
    conn_finish(r->link);
    r->link = NULL;
}

void
render_fail(struct render *r, const struct rad_error *err)
{
    send_failed(r, err);
    render_end(r, rad_exit_status(err->code));
}

/* What all pools of the child have done so far. */
static struct pool_tally
tally_of(const struct render *r)
{
    struct pool_tally all = r->past, now;

    if (!r->pool)
        return all;
    now = pool_tally(r->pool);
    all.busy_s += now.busy_s;
    all.wait_base_line_s += now.wait_base_line_s;
    all.rays_under_way = now.rays_under_way;
    all.pixels_under_way = now.pixels_under_way;
    msg_counts_add(&all.dropped, &now.dropped);
    return all;
}

/* The same, with strict units brought up to date. */
static struct pool_tally
settled_tally(const struct render *r)
{
    if (r->pool)
        pool_settle(r->pool);
    return tally_of(r);
}

void
render_keep_tally(struct render *r)
{
    r->past = settled_tally(r);
    r->past.rays_under_way = r->past.pixels_under_way = 0;
}

void
render_send_tally(struct render *r)
{
    struct msg m = { .type = MSG_TALLY };
    struct pool_tally did = settled_tally(r);
    struct rusage use;

    r->told_rays = did.rays_under_way;
    r->told_dropped = did.dropped.rays;
    r->told_ms = uv_now(&r->loop);

    getrusage(RUSAGE_SELF, &use);
    m.tally.job = r->id;
    m.tally.ambient_sent = r->sent;
    m.tally.ambient_received = r->received;
    m.tally.ambient_redundant = r->redundant;
    m.tally.cache_values =
        r->job->ambient ? rad_ambient_count(r->job->ambient) : 0;
    m.tally.peak_rss_bytes = (uint64_t)use.ru_maxrss * 1024;
    m.tally.busy_s = did.busy_s;
    m.tally.wait_base_line_s = did.wait_base_line_s;
    m.tally.rays_under_way = did.rays_under_way;
    m.tally.pixels_under_way = did.pixels_under_way;
    m.tally.dropped = did.dropped;
    conn_send(r->link, &m);
}

/* If a pixel takes so long that it never ends, say so. */
static void
watch(struct render *r)
{
    struct rad_error err = { 0 };
    int x, y;

    if (!r->link || !pool_stuck(r->pool, r->pixel_s, &x, &y))
        return;
    rad_fail(&err, RAD_EINTERNAL,
             "the pixel at x %d, y %d took more than %d s of a processor", x, y,
             r->pixel_s);
    send_failed(r, &err);
    /* the pixel's thread cannot be joined: radd ends this process */
    uv_timer_stop(&r->drain);
    uv_timer_stop(&r->teller);
    uv_timer_stop(&r->ticker);
}

static void
on_teller(uv_timer_t *timer)
{
    struct render *r = timer->data;
    struct pool_tally did = tally_of(r);

    if (r->link && (did.rays_under_way != r->told_rays ||
                    uv_now(&r->loop) - r->told_ms >= SIGN_OF_LIFE_MS))
        render_send_tally(r);
    watch(r);
}

void
render_begin_tallies(struct render *r)
{
    uv_timer_start(&r->teller, on_teller, TALLY_MS, TALLY_MS);
}

void
render_on_rows(void *arg, const struct pool_rows *p)
{
    struct render *r = arg;
    struct msg m = { .type = MSG_RESULT };
    uint8_t *floats = NULL;

    if (!r->link)
        return;
    if (p->err.code) {
        render_fail(r, &p->err);
        return;
    }
    if (p->channels > 1) {
        floats = malloc(p->bytes + 1);
        if (!floats)
            _exit(EX_OSERR); /* radd gives the unit to another child */
        wire_floats_put(floats, (const float *)p->pixels,
                        p->bytes / sizeof(float));
    }
    m.result.job = r->id;
    m.result.unit = p->unit.unit;
    m.result.attempt = p->unit.attempt;
    m.result.row = p->row;
    m.result.rows = p->rows;
    m.result.width = (uint32_t)p->unit.window.width;
    m.result.channels = (uint8_t)p->channels;
    m.result.last = p->last;
    m.result.counts = p->counts;
    m.result.pixels = floats ? floats : (const uint8_t *)p->pixels;
    m.result.len = p->bytes;
    if (p->last && r->records) /* after the last rows nobody waits for them */
        render_drain(r);
    if (p->last)
        render_send_tally(r);
    conn_send(r->link, &m);
    free(floats);
}

void
render_send_news(struct render *r)
{
    struct rad_error err = { 0 };
    const struct msg *m;

    while (r->link && r->strict &&
           (m = pool_message(r->pool, conn_queued(r->link) < RENDER_AHEAD))) {
        /* the job may be done when this PAID arrives */
        if (m->type == MSG_PAID && r->records)
            render_drain(r);
        /* the worker may leave when this GAVE arrives */
        if (m->type == MSG_GAVE && m->gave.height == 0)
            render_send_tally(r);
        conn_send(r->link, m);
    }
    if (!r->link || !r->strict)
        return;
    if (tally_of(r).dropped.rays != r->told_dropped)
        render_send_tally(r);
    if (pool_error(r->pool) < 0) {
        rad_fail_memory(&err);
        render_fail(r, &err);
    }
}

static void
on_ticker(uv_timer_t *timer)
{
    render_on_news(timer->data);
}

void
render_on_news(void *arg)
{
    struct render *r = arg;
    uint64_t now = uv_now(&r->loop), due;

    if (!r->link || !r->strict)
        return;
    due = pool_tick(r->pool, now);
    if (due == STRICT_NEVER)
        uv_timer_stop(&r->ticker);
    else
        uv_timer_start(&r->ticker, on_ticker, due > now ? due - now : 0, 0);
    render_send_news(r);
}
