/* render_units.c - work for a job's child
 *
 * Units, facts and base lines of other workers, and estimates come from the
 * network, are checked here, and go to the pool. */
#include "config.h"

#include "child/render_impl.h"

#include "pool/estimate.h"
#include "net/log.h"

/* Most bytes of a row in a message: as a base line with its densities, or as
 * facts with a bit for each pixel. */
static size_t
row_bytes(const struct rad_frame *f, const struct msg_unit *u)
{
    const struct rad_window w = { 0, 0, (int)u->width, 1 };
    size_t pixels = (size_t)u->width * (f->depth ? 16 : 12);
    size_t bits = rad_facts_stride((int)u->width), densities;
    struct rad_quincunx q;

    rad_frame_sampler(f, &w, &q);
    densities = rad_quincunx_ndensity(&q);
    return pixels + (bits > densities ? bits : densities);
}

static int
check_unit(const struct render *r, const struct msg_unit *u,
           struct rad_error *err)
{
    const struct rad_frame *f;

    if (u->frame >= r->nframes)
        return rad_fail(err, RAD_EPROTO, "unit %u of frame %u, of %u", u->unit,
                        u->frame, r->nframes);
    if (!render_cache_serves(r, u->frame))
        return rad_fail(err, RAD_EPROTO, "unit %u comes without its cache",
                        u->unit);
    f = &r->frames[u->frame];
    if (u->width > (uint32_t)f->width || u->height > (uint32_t)f->height ||
        u->x > (uint32_t)f->width - u->width ||
        u->y > (uint32_t)f->height - u->height)
        return rad_fail(err, RAD_EPROTO, "unit %u lies outside the picture",
                        u->unit);
    /* the other fields of a RESULT take far less than this */
    if (row_bytes(f, u) > MSG_MAX - 1024)
        return rad_fail(err, RAD_EDATA, "a row of %u pixels is too wide",
                        u->width);
    return 0;
}

/* Begin a frame.  With --fresh-frames nothing is kept from the frame before:
 * the job is loaded again. */
static int
begin_frame(struct render *r, uint32_t frame, struct rad_error *err)
{
    const struct msg_spec *spec = &r->start.job_start;
    int rc;

    if (r->frame != r->nframes && r->frame != frame &&
        spec->flags & MSG_JOB_FRESH_FRAMES) {
        render_keep_tally(r);
        render_unload(r);
        rc = render_load(r, spec, err);
        if (rc < 0)
            return rc;
        render_records_again(r);
    }
    r->frame = frame;
    return 0;
}

static int
push_window(struct render *r, const struct msg_unit *u, struct rad_error *err)
{
    struct pool_unit unit = { .unit = u->unit,
                              .attempt = u->attempt,
                              .frame = u->frame,
                              .window = { (int)u->x, (int)u->y, (int)u->width,
                                          (int)u->height } };

    if (!pool_push(r->pool, &unit))
        return rad_fail_memory(err);
    return 0;
}

static int
push_strict(struct render *r, const struct msg_unit *u, struct rad_error *err)
{
    int rc;

    if (!r->strict)
        return rad_fail(err, RAD_EPROTO, "unit %u is strict, the job is not",
                        u->unit);
    rc = strict_unit(pool_lock_strict(r->pool), u, err);
    pool_unlock_strict(r->pool);
    return rc;
}

void
render_take_unit(struct render *r, const struct msg_unit *u)
{
    struct rad_error err = { 0 };
    int rc = check_unit(r, u, &err);

    if (rc == 0)
        rc = begin_frame(r, u->frame, &err);
    if (rc == 0)
        rc = u->mode == MSG_MODE_STRICT ? push_strict(r, u, &err)
                                        : push_window(r, u, &err);
    if (rc < 0)
        render_fail(r, &err);
}

/* Facts, base lines, guesses and loans may come before the first unit of their
 * frame.  Those of a later frame begin that frame, or its first unit would drop
 * them.  Those of an earlier frame are late, and ignored. */
static int
begin_lines(struct render *r, const struct msg *m, struct rad_error *err)
{
    uint32_t frame;

    if (!strict_brings(m, &frame) || frame >= r->nframes ||
        (r->frame != r->nframes && frame < r->frame))
        return 0;
    return begin_frame(r, frame, err);
}

void
render_take_strict(struct render *r, const struct msg *m)
{
    struct rad_error err = { 0 };
    int rc;

    if (!r->strict)
        return;
    if (begin_lines(r, m, &err) < 0) {
        render_fail(r, &err);
        return;
    }
    r->borrowed |= m->type == MSG_LOAN;
    rc = strict_take(pool_lock_strict(r->pool), m, &err);
    pool_unlock_strict(r->pool);
    /* a wrong LOAN is the fault of the worker that made it: it does not fail
     * the job */
    if (rc == RAD_EPROTO)
        log_warn("loan refused: %s", err.what);
    else if (rc < 0)
        render_fail(r, &err);
}

/* --- estimates --- */

/* An estimate is done: send its pixels as facts, then its costs.  Not the
 * pixels of frames for which the cache still changes. */
static void
on_estimated(void *arg, struct estimate *e, double wall_s)
{
    struct render *r = arg;
    struct msg m = { .type = MSG_FACTS };
    struct msg_facts *f;

    while (r->link && r->strict && (f = estimate_facts(e))) {
        if (f->frame >= render_first_batch(r))
            continue;
        m.facts = *f;
        m.facts.job = r->id;
        conn_send(r->link, &m);
    }
    m = (struct msg){ .type = MSG_ESTIMATED };
    estimate_result(e, &m.estimated);
    m.estimated.job = r->id;
    m.estimated.counts.wall_s = wall_s;
    if (r->link)
        conn_send(r->link, &m);
    estimate_free(e);
}

void
render_take_estimate(struct render *r, const struct msg_estimate *m)
{
    struct rad_error err = { 0 };
    struct estimate *e = NULL;

    if (render_cache_serves(r, 0))
        e = estimate_new(r->frames, r->nframes, m, &err);
    else
        rad_fail(&err, RAD_EPROTO, "an estimate comes before its cache");
    if (e && !pool_estimate(r->pool, e, on_estimated)) {
        estimate_free(e);
        rad_fail_memory(&err);
    }
    if (err.code)
        render_fail(r, &err);
}
