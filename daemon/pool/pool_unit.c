/* pool_unit.c - one unit, or one pass of a strict unit: its team and its rows
 *
 * The member that leaves last reports the end of the unit, with the counts of
 * all members. */
#include "config.h"

#include "pool/pool_impl.h"
#include "machine/counted.h"
#include "machine/sums.h"
#include "picture/doubt.h"
#include "image/hdr.h"
#ifdef RADD_TEST_HOOKS
#include "tests/tools/hook.h"
#endif

#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <unistd.h>

/* A piece of rows is handed on when it has more bytes than this. */
#define PIECE_BYTES (64u << 10)

/* Many coded rows fit in a piece.  So that previews show them a piece waits no
 * longer than this [s]. */
#define PIECE_AGE .25

/* --- rows --- */

static void
put_done_locked(struct pool *p, struct pool_rows *rows, size_t bytes)
{
    p->unsent += bytes;
    *p->done_end = rows;
    p->done_end = &rows->next;
    wake_send(&p->wake);
}

/* Hand a piece to the loop; waits while too many bytes are not sent. */
static void
put_done(struct pool *p, struct pool_rows *rows, size_t bytes)
{
    uv_mutex_lock(&p->mu);
    while (p->unsent > POOL_UNSENT && !atomic_load(&p->stopping))
        uv_cond_wait(&p->room, &p->mu);
    put_done_locked(p, rows, bytes);
    uv_mutex_unlock(&p->mu);
}

/* Write a row to `to` in the form of a RESULT; returns its bytes. */
static size_t
put_row(void *to, const struct rad_pixel *from, int width, int channels)
{
    float *p = to;

    if (channels == 1)
        return rad_hdr_encode_pixels(from, width, to);
    for (int x = 0; x < width; x++, p += channels) {
        p[0] = from[x].L.r;
        p[1] = from[x].L.g;
        p[2] = from[x].L.b;
        if (channels == 4)
            p[3] = from[x].z;
    }
    return (size_t)((char *)p - (char *)to);
}

/* Most bytes that put_row() may write for a row. */
static size_t
row_room(const struct active *u)
{
    size_t width = (size_t)u->unit.window.width;

    if (u->channels == 1)
        return RAD_HDR_ROW_BYTES(width);
    return width * (size_t)u->channels * sizeof(float);
}

/* Begin a piece at `row` of the unit; NULL: memory is out, and the unit ends.
 */
static struct pool_rows *
new_piece(struct active *u, int row)
{
    size_t left = (size_t)(u->unit.window.height - row) * row_room(u);
    size_t most = PIECE_BYTES + row_room(u);
    struct pool_rows *p;

    /* not cleared: pixels are written before they are read */
    p = malloc(sizeof *p + (left < most ? left : most));
    if (!p) {
        rad_fail_memory(&u->err);
        team_stop(u->team);
        return NULL;
    }
    memset(p, 0, sizeof *p);
    u->piece_wall0 = pool_seconds(CLOCK_MONOTONIC);
    p->unit = u->unit;
    p->row = (uint32_t)row;
    p->channels = u->channels;
    return p;
}

static bool
trace(void *arg, struct rad_ctx *ctx, int x, int y, struct rad_pixel *out)
{
    const struct active *u = arg;
    bool seen =
        rad_frame_pixel(&u->pool->frames[u->unit.frame], ctx, x, y, out);

#ifdef RADD_TEST_HOOKS
    test_hook_pixel(u->pool->job->scene, x, y);
#endif
    return seen;
}

/* Trace a pixel of borrowed columns; false: its value was no number.  Such a
 * pixel is left to the lender, who counts it: as a fact it would be black, and
 * counted nowhere. */
static bool
trace_lent(void *arg, struct rad_ctx *ctx, int x, int y, struct rad_pixel *out)
{
    uint64_t unsound = ctx->counts.unsound_rays;

    return trace(arg, ctx, x, y, out) && ctx->counts.unsound_rays == unsound;
}

static void
paint(void *arg, struct rad_ctx *ctx, int x0, int x1, int y,
      struct rad_pixel *row)
{
    const struct active *u = arg;

    rad_frame_paint_row(&u->pool->frames[u->unit.frame], ctx, x0, x1, y, row);
}

static uint64_t
count_rays(void *arg, const struct rad_ctx *ctx)
{
    (void)arg;
    return ctx->counts.rays;
}

static void
send_piece(struct active *u)
{
    put_done(u->pool, u->piece, u->piece->bytes);
    u->piece = NULL;
}

static bool
is_full(const struct active *u)
{
    return u->piece->bytes > PIECE_BYTES ||
           (u->channels == 1 &&
            pool_seconds(CLOCK_MONOTONIC) - u->piece_wall0 > PIECE_AGE);
}

/* Trace some pixels of a line again, to estimate the error.  They belong to no
 * picture, so only their number is counted. */
static void
trace_again(void *arg, struct rad_ctx *ctx, int first, int n,
            const struct rad_pixel *const row[])
{
    struct active *u = arg;
    const struct rad_frame *f = &u->pool->frames[u->unit.frame];
    const struct rad_window *w = &u->unit.window;
    struct rad_doubt_share share = rad_doubt_of_picture(f);
    struct rad_doubt_rows rows = { .frame = f,
                                   .x = w->x,
                                   .y = w->y + first - u->row0,
                                   .width = w->width,
                                   .n = n,
                                   .row = row };
    struct rad_counts before = ctx->counts;
    struct rad_doubt found = { { 0 } };

    rad_doubt_look(&rows, ctx, &share, &u->pool->stopping, &found);
    u->again += ctx->counts.primary_rays - before.primary_rays;
    ctx->counts = before;
    sums_count(&u->doubt, &found);
}

/* A row is done: put it into the piece.  A full piece is handed on only when
 * the next row comes: the unit's last piece must have the counts, and a strict
 * unit does not know which row is its last. */
static void
on_row(void *arg, int row, const struct rad_pixel *pixels)
{
    struct active *u = arg;

    if (u->piece && is_full(u))
        send_piece(u);
    if (!u->piece && !(u->piece = new_piece(u, row - u->row0)))
        return;
    u->piece->bytes += put_row((char *)u->piece->pixels + u->piece->bytes,
                               pixels, u->unit.window.width, u->channels);
    u->piece->rows++;
}

static void
free_active(struct active *u)
{
    if (u) {
        team_free(u->team);
        free(u->piece);
        free(u);
    }
}

static void
send_failure(struct pool *p, const struct pool_unit *unit,
             const struct rad_error *err)
{
    struct pool_rows *r = calloc(1, sizeof *r);

    if (!r)
        _exit(EX_OSERR); /* else the unit would never end */
    r->unit = *unit;
    r->err = *err;
    put_done(p, r, 0);
}

/* The last member has left the unit: hand on the rest of its rows. */
static void
end_active(struct active *u)
{
    if (u->err.code < 0) {
        send_failure(u->pool, &u->unit, &u->err);
    } else if (u->whole) {
        u->piece->last = true;
        u->piece->counts = u->counts;
        send_piece(u);
    } else if (u->piece) {
        send_piece(u); /* a window that was revoked */
    }
    free_active(u);
}

/* --- teams --- */

static struct team *
new_team(struct active *u)
{
    const struct rad_frame *f = &u->pool->frames[u->unit.frame];
    const struct rad_window all = { 0, 0, f->width, f->height };
    const struct strict_pass *pass = u->pass;
    struct team_spec spec =
        pass ? pass->spec : (struct team_spec){ .mode = TEAM_TRUTH };

    rad_frame_sampler(f, pass ? &all : &u->unit.window, &spec.sampler);
    spec.trace = spec.loan ? trace_lent : trace;
    spec.paint = paint;
    spec.count = count_rays;
    spec.help = pool_on_help;
    spec.arg = u;
    spec.nthreads = u->pool->nthreads;
    if (spec.mode == TEAM_TRUTH) {
        spec.truth.rows = on_row;
        spec.truth.look = trace_again;
    }
    if (!pass)
        spec.last = rad_quincunx_nbases(&spec.sampler);
    else if (strict_has_true_top(pass))
        spec.bottom = pool_on_bottom;
    if (pass && spec.nthreads > spec.last - spec.first)
        spec.nthreads = spec.last - spec.first;
    return team_new(&spec);
}

/* A unit for threads to work on; NULL: memory is out. */
static struct active *
new_active(struct pool *p, const struct pool_unit *unit,
           struct strict_pass *pass)
{
    struct active *u = calloc(1, sizeof *u);

    if (!u)
        return NULL;
    u->pool = p;
    u->unit = *unit;
    u->pass = pass;
    u->rank = pass ? pass->rank : STRICT_AHEAD;
    u->row0 = pass ? unit->window.y : 0;
    u->wall0 = pool_seconds(CLOCK_MONOTONIC);
    u->channels = p->coded ? 1 : p->frames[unit->frame].depth ? 4 : 3;
    u->team = new_team(u);
    if (!u->team) {
        free_active(u);
        return NULL;
    }
    return u;
}

/* End a pass.  If it ends early another thread may go on with the unit as soon
 * as the lock is free, so hand its rows on before that. */
static void
leave_pass_locked(struct active *u)
{
    pool_end_pass_locked(u);
    if (u->whole || !u->piece || u->err.code < 0)
        return;
    put_done_locked(u->pool, u->piece, u->piece->bytes);
    u->piece = NULL;
}

/* The last member of the unit has left. */
static void
leave_locked(struct active *u)
{
    struct pool *p = u->pool;
    struct active **at = &p->active;

    while (*at != u)
        at = &(*at)->next;
    *at = u->next;
    p->wait_s += team_waited(u->team);
    u->counts.wall_s = pool_seconds(CLOCK_MONOTONIC) - u->wall0;
    u->counts.estimate_rays = u->again;
    u->counts.doubt = u->doubt;
    if (u->pass)
        leave_pass_locked(u);
    else
        u->whole = team_done(u->team);
}

void
pool_unit_work(struct renderer *by, struct active *u)
{
    struct pool *p = by->pool;
    struct pool_stint stint = pool_stint_begin(by);
    double cpu;
    bool last;

    team_work(u->team, &by->ctx);
    cpu = pool_stint_end_and_lock(by, &stint);
    counted_add(&u->counts, &by->ctx.counts, cpu);
    last = --u->members == 0;
    if (last)
        leave_locked(u);
    uv_mutex_unlock(&p->mu);
    if (last)
        end_active(u);
}

/* The rows of a pass's unit as a window. */
static struct pool_unit
unit_of_pass(const struct pool *p, const struct strict_pass *pass)
{
    const struct rad_frame *f = &p->frames[pass->frame];
    const struct rad_window all = { 0, 0, f->width, f->height };
    struct rad_quincunx q;
    int y, end;

    rad_frame_sampler(f, &all, &q);
    y = team_line_row(&q, pass->least - 1);
    end = rad_quincunx_base_row(&q, pass->spec.last - 1) + 1;
    return (struct pool_unit){ .unit = pass->unit,
                               .attempt = pass->attempt,
                               .frame = pass->frame,
                               .window = { 0, y, f->width, end - y } };
}

/* Report that a unit could not begin because memory is out. */
static void
fail_begin(struct pool *p, const struct pool_unit *unit,
           struct strict_pass *pass)
{
    const struct team_bottom no_bottom = { 0 };
    const struct msg_counts none = { 0 };
    struct rad_error err = { 0 };

    rad_fail_memory(&err);
    send_failure(p, unit, &err);
    uv_mutex_lock(&p->mu);
    p->beginning--;
    if (pass)
        strict_ended(p->strict, pass, false, &no_bottom, &none, NULL);
    uv_mutex_unlock(&p->mu);
}

struct active *
pool_unit_begin(struct pool *p, struct queued *window, struct strict_pass *pass)
{
    struct pool_unit unit = window ? window->unit : unit_of_pass(p, pass);
    struct active *u = new_active(p, &unit, pass);

    free(window);
    if (!u) {
        fail_begin(p, &unit, pass);
        return NULL;
    }
    u->members = 1;
    uv_mutex_lock(&p->mu);
    u->next = p->active;
    p->active = u;
    p->beginning--;
    if (atomic_load(&p->stopping))
        team_stop(u->team);
    if (u->pass) {
        pool_look_locked(p); /* SPLIT or a stop may have come meanwhile */
        wake_send(&p->wake); /* its bottom may be wanted: send messages */
    }
    if (!p->todo)
        uv_cond_broadcast(&p->work); /* idle threads can help */
    uv_mutex_unlock(&p->mu);
    return u;
}
