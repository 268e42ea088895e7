/* team.c - a team's set-up and end, the order of its lines, calls from outside
 */
#include "config.h"

#include "team/team_impl.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

static void
show_rows(struct team *t, struct rad_ctx *ctx, int first, int n)
{
    const struct rad_pixel *row[RAD_QUINCUNX_MAX_YSTEP + 1];

    for (int i = 0; i < n; i++)
        row[i] = row_at(t, first + i);
    t->spec.truth.look(t->spec.arg, ctx, first, n, row);
}

/* Hand on the rows of line i: its bar's and its own. */
static void
hand_on(struct team *t, struct rad_ctx *ctx, int i)
{
    int row = team_line_row(&t->spec.sampler, i);
    int n = team_line_rows(&t->spec.sampler, i), end = row + n;

    if (t->spec.mode != TEAM_TRUTH || i < t->spec.truth.out)
        return;
    if (t->spec.truth.look)
        show_rows(t, ctx, row, n);
    for (; row < end; row++) {
        t->spec.truth.rows(t->spec.arg, row, row_at(t, row));
        team_add(t, &t->out, 1);
    }
}

/* If line i is the first whose rows are not handed on, hand on all rows that
 * are complete, unless another member does so. */
void
team_line_finish(struct team *t, struct rad_ctx *ctx, int i, uint64_t primary)
{
    if (t->spec.ahead.record)
        memcpy(t->spec.ahead.record + (size_t)(i - t->spec.first) * t->ndensity,
               line_at(t, i)->density, t->ndensity);
    uv_mutex_lock(&t->mu);
    line_at(t, i)->primary = primary;
    line_at(t, i)->done = true;
    if (!t->handing_on) {
        t->handing_on = true;
        while (t->finished < t->begun && line_at(t, t->finished)->done) {
            uv_mutex_unlock(&t->mu);
            hand_on(t, ctx, t->finished);
            uv_mutex_lock(&t->mu);
            t->primary += line_at(t, t->finished)->primary;
            t->finished++;
            uv_cond_broadcast(&t->moved);
        }
        t->handing_on = false;
    }
    uv_mutex_unlock(&t->mu);
}

static bool
is_open_locked(const struct team *t)
{
    return t->begun < atomic_load_explicit(&t->last, memory_order_relaxed) &&
           !is_stopped(t);
}

/* Mark blocks of the line as taken that its member may not trace: lent ones,
 * and in TEAM_LOAN all outside of the loan. */
static void
begin_blocks_locked(struct team *t, int i)
{
    const struct team_spec *spec = &t->spec;
    struct team_blocks away = { 0 };

    if (i == spec->last - 1)
        away = t->lent;
    if (spec->loan) {
        away.bar |=
            ~team_blocks_of(&spec->sampler, spec->loan->x, spec->loan->n);
        away.base |= spec->loan->base ? away.bar : UINT64_MAX;
    }
    atomic_store(&line_at(t, i)->taken[LINE_BASE], away.base);
    atomic_store(&line_at(t, i)->taken[LINE_BAR], away.bar);
}

/* The line's buffers had another line, whose helpers are done. */
static void
begin_help_locked(struct team *t, int i)
{
    struct line *l = line_at(t, i);

    for (int k = 0; k < LINE_PARTS; k++)
        l->helped[k] = l->helped_done[k] = 0;
    rad_facts_free(atomic_load_explicit(&l->own, memory_order_relaxed));
    atomic_store_explicit(&l->own, NULL, memory_order_relaxed);
}

int
team_line_begin(struct team *t)
{
    int i = -1;

    uv_mutex_lock(&t->mu);
    while (is_open_locked(t) && t->begun > t->finished + t->nlines - 2)
        uv_cond_wait(&t->moved, &t->mu);
    if (is_open_locked(t)) {
        i = t->begun++;
        line_at(t, i)->done = false;
        atomic_store(&line_at(t, i)->ready, 0);
        atomic_store_explicit(&line_at(t, i)->shown, 0, memory_order_relaxed);
        begin_help_locked(t, i);
        begin_blocks_locked(t, i);
    }
    uv_mutex_unlock(&t->mu);
    return i;
}

bool
team_open(struct team *t)
{
    bool open;

    uv_mutex_lock(&t->mu);
    open = is_open_locked(t);
    uv_mutex_unlock(&t->mu);
    return open;
}

void
team_stop(struct team *t)
{
    atomic_store(&t->stopped, true);
    uv_mutex_lock(&t->mu);
    uv_cond_broadcast(&t->moved);
    for (int i = 0; i < t->nlines; i++)
        uv_cond_signal(&t->lines[i].moved);
    uv_mutex_unlock(&t->mu);
}

int
team_shrink(struct team *t, int least)
{
    int last, keep;

    uv_mutex_lock(&t->mu);
    last = atomic_load_explicit(&t->last, memory_order_relaxed);
    keep = last - (last - t->begun + 1) / 2; /* some lines are begun */
    if (keep == t->begun && t->spec.mode != TEAM_TRUTH)
        keep++; /* the last line begun was not painted as a bottom */
    if (keep < least)
        keep = least;
    if (keep < last) {
        last = keep;
        atomic_store_explicit(&t->last, last, memory_order_relaxed);
        uv_cond_broadcast(&t->moved);
    }
    uv_mutex_unlock(&t->mu);
    return last;
}

int
team_cut(struct team *t)
{
    if (t->spec.mode != TEAM_TRUTH || t->finished <= t->spec.first ||
        t->finished <= t->spec.truth.out)
        return -1;
    t->begun = t->finished;
    atomic_store_explicit(&t->last, t->finished, memory_order_relaxed);
    return t->finished;
}

void
team_bottom(struct team *t, struct team_bottom *b)
{
    int last;

    memset(b, 0, sizeof *b);
    uv_mutex_lock(&t->mu);
    last = atomic_load_explicit(&t->last, memory_order_relaxed);
    if (t->begun == last) {
        struct line *l = line_at(t, last - 1);

        b->pixels =
            row_at(t, rad_quincunx_base_row(&t->spec.sampler, last - 1));
        b->density = l->density;
        b->columns = atomic_load_explicit(&l->shown, memory_order_acquire);
        b->ndensity = atomic_load(&l->ready);
        if (b->ndensity > t->ndensity)
            b->ndensity = t->ndensity;
    }
    uv_mutex_unlock(&t->mu);
}

uint64_t
team_rays(const struct team *t)
{
    return atomic_load_explicit(&t->rays, memory_order_relaxed);
}

double
team_waited(struct team *t)
{
    double s;

    uv_mutex_lock(&t->mu);
    s = t->waited_s;
    uv_mutex_unlock(&t->mu);
    return s;
}

struct team_made
team_made(const struct team *t)
{
    return (struct team_made){
        atomic_load_explicit(&t->base, memory_order_relaxed),
        atomic_load_explicit(&t->bars, memory_order_relaxed),
        atomic_load_explicit(&t->out, memory_order_relaxed),
    };
}

bool
team_done(const struct team *t)
{
    return t->finished == atomic_load(&t->last);
}

uint64_t
team_primary(const struct team *t)
{
    return t->primary;
}

/* malloc() for pixels, which are written before they are read: to clear them
 * would take as long as a pass over facts.  But TEAM_LOAN also reads beyond its
 * columns. */
static struct rad_pixel *
make_pixels(const struct team *t, size_t n)
{
    return t->spec.loan ? calloc(n, sizeof *t->pixels)
                        : malloc(n * sizeof *t->pixels);
}

/* Make all buffers; the densities and pixels of lines lie side by side. */
static bool
make_buffers(struct team *t)
{
    size_t width = (size_t)t->spec.sampler.width, n = (size_t)t->nlines;
    size_t early = t->spec.nthreads > 1 && t->ndensity > 0 ? n : 0;

    t->lines = calloc(n, sizeof *t->lines);
    t->density = calloc(n + 1, t->ndensity + 1);
    t->pixels = make_pixels(t, (early + n + (size_t)t->nslots) * width);
    if (early > 0)
        t->known = calloc(early * width, sizeof *t->known);
    if (!t->lines || !t->density || !t->pixels || (early > 0 && !t->known))
        return false;
    for (size_t i = 0; i < n; i++) {
        uv_cond_init(&t->lines[i].moved);
        t->lines[i].density = t->density + (i + 1) * (t->ndensity + 1);
        t->lines[i].sampled = t->pixels + i * width;
        if (early > 0) {
            t->lines[i].early = t->pixels + (n + i) * width;
            t->lines[i].known = t->known + i * width;
        }
    }
    t->slots = t->pixels + (n + early) * width;
    return true;
}

static void
put_loan(struct team *t, const struct team_loan *loan)
{
    int above = rad_quincunx_base_row(&t->spec.sampler, loan->line - 1);

    if (loan->density)
        memcpy(t->density, loan->density, t->ndensity);
    memcpy(row_at(t, above) + loan->x, loan->top,
           (size_t)loan->n * sizeof *loan->top);
}

static void
put_top(struct team *t)
{
    const struct team_spec *spec = &t->spec;
    int above = spec->first - 1;

    if (spec->loan) {
        put_loan(t, spec->loan);
        return;
    }
    if (spec->first == 0) {
        rad_quincunx_start(&spec->sampler, t->density);
        return;
    }
    if (spec->top_density)
        memcpy(t->density, spec->top_density, t->ndensity);
    else if (t->ndensity > 0)
        rad_quincunx_guess(&spec->sampler, t->density);
    if (spec->top)
        memcpy(row_at(t, rad_quincunx_base_row(&spec->sampler, above)),
               spec->top, (size_t)spec->sampler.width * sizeof *spec->top);
}

struct team *
team_new(const struct team_spec *spec)
{
    struct team *t = calloc(1, sizeof *t);

    assert(spec->first >= 0 && spec->first < spec->last &&
           spec->last <= rad_quincunx_nbases(&spec->sampler));
    assert(spec->mode == TEAM_TRUTH ? spec->first == 0 || spec->top
                                    : spec->facts != NULL);
    assert((spec->mode == TEAM_LOAN) == (spec->loan != NULL));
    if (!t)
        return NULL;
    uv_mutex_init(&t->mu);
    uv_cond_init(&t->moved);
    t->spec = *spec;
    t->last = spec->last;
    t->lent = spec->lent;
    t->begun = t->finished = spec->first;
    t->ndensity = rad_quincunx_ndensity(&spec->sampler);
    /* each member's line, the line above the first, and a line to begin */
    t->nlines = 2 * spec->nthreads + 2;
    t->nslots = t->nlines * spec->sampler.ystep + 1;
    if (!make_buffers(t)) {
        team_free(t);
        return NULL;
    }
    put_top(t);
    return t;
}

void
team_free(struct team *t)
{
    if (!t)
        return;
    uv_mutex_destroy(&t->mu);
    uv_cond_destroy(&t->moved);
    for (int i = 0; i < t->nlines && t->slots; i++) {
        uv_cond_destroy(&t->lines[i].moved);
        rad_facts_free(t->lines[i].own);
    }
    free(t->lines);
    free(t->density);
    free(t->known);
    free(t->pixels);
    free(t);
}
