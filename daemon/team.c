/* team.c - see team.h
 *
 * What a line needs from the one above:
 *   - its densities, up to a little ahead of where it is itself (`ready`);
 *   - at last, its pixels as they are in the picture, small sources painted,
 *     as the top of the bar.
 * The bar's bottom is the line as it was sampled, before painting, as in
 * rpict; so a line keeps both.
 *
 * Nobody but the member of the line below waits for a line, and it is woken
 * when there is what it waits for, not at each step.  Before it goes to sleep
 * it traces what its own line will want whatever the densities are: where the
 * line above makes ambient records that the one below finds there, the one
 * below is faster and would wait most of the time.  Lines are begun in order,
 * and the lowest one that is not done waits for nobody; so nobody waits for
 * ever.  Buffers form a ring: line i is begun only when line i - nlines + 1,
 * the last to look at its buffers, is done and its rows are handed on.  The top
 * lies where the ring has line first - 1. */
#include "config.h"

#include "team.h"

#include <assert.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <uv.h>

/* Looks at a number that is about to change before a thread goes to sleep. */
#define SPINS 200

/* A member adds its rays to the team's when so many are new: some ms of work,
 * so that members do not wait for each other's cache line. */
#define RAYS_UNTOLD 4096

/* It counts them when it has traced so many pixels. */
#define PIXELS_UNSEEN 16

/* Columns of a bar between two looks at whether the team is stopped. */
#define BAR_COLUMNS 4

/* The bottom is painted, and told of, in pieces of so many columns at least. */
#define BOTTOM_COLUMNS 64

struct line {
    uint8_t *density;          /* for the line below; written by its member */
    struct rad_pixel *sampled; /* written by its member */
    /* Pixels of the base line that its member traced while it waited, where
     * known says so; they are its own.  NULL: nobody waits. */
    struct rad_pixel *early;
    bool *known;
    /* Densities that are final, stored after them; pairs with the load in
     * wait_for().  One more than all of them: the line is painted. */
    _Atomic size_t ready;
    /* So many does the member of the line below wait for, asleep; 0: none. */
    _Atomic size_t wanted;
    uv_cond_t moved;   /* with ready, as far as wanted, and stopped */
    _Atomic int shown; /* columns that are in their row, painted */
    bool done;         /* [mu] and the bar above it */
};

struct team {
    struct team_spec spec;    /* [fixed] but for last; see there */
    size_t ndensity;          /* [fixed] */
    int nlines, nslots;       /* [fixed] */
    uint8_t *density;         /* [fixed] the top's, then the lines' */
    bool *known;              /* [fixed] the lines'; NULL: one thread */
    struct rad_pixel *pixels; /* [fixed] the lines' and the slots' */
    struct rad_pixel *slots;  /* [fixed] row k in slot k modulo nslots */
    struct line *lines;       /* [fixed] line i is number i % nlines */
    uv_mutex_t mu;
    uv_cond_t moved;       /* with finished, last and stopped */
    _Atomic int last;      /* written with mu held; relaxed without */
    int begun;             /* [mu] lines */
    int finished;          /* [mu] lines whose rows, and all above, are out */
    bool handing_on;       /* [mu] a member hands rows on */
    double waited_s;       /* [mu] in wait_for() */
    _Atomic uint64_t rays; /* relaxed: shown, never decided on */
    _Atomic uint64_t traced, primary; /* relaxed: read when all have left */
    _Atomic bool stopped; /* relaxed where it only ends work earlier */
};

/* One member at work on one line. */
struct member {
    struct team *team;
    struct rad_ctx *ctx;
    struct rad_quincunx q;
    int i;
    _Atomic(struct rad_facts *) *facts; /* of line i; NULL: never any */
    int row0;                           /* the first of line i */
    bool truth;    /* what is asked for now is wanted indeed */
    bool early;    /* or will be, and counts then */
    int row;       /* of line i's base line, in the picture */
    int ahead;     /* the first of its gaps that were traced while it waited */
    bool unsure;   /* of the colours that the bar is filled between */
    uint64_t told; /* of count(ctx) */
    uint64_t traced, primary;
    uint64_t looked; /* traced when the rays were last counted */
};

static struct line *
line_at(const struct team *t, int i)
{
    return &t->lines[i % t->nlines];
}

static struct rad_pixel *
row_at(const struct team *t, int row)
{
    return t->slots + (size_t)(row % t->nslots) * (size_t)t->spec.sampler.width;
}

int
team_line_row(const struct rad_quincunx *q, int i)
{
    return i > 0 ? rad_quincunx_base_row(q, i - 1) + 1 : 0;
}

int
team_line_rows(const struct rad_quincunx *q, int i)
{
    return rad_quincunx_base_row(q, i) + 1 - team_line_row(q, i);
}

/* The facts of the member's line; NULL: there are none. */
static struct rad_facts *
facts_of(const struct member *m)
{
    return m->facts ? atomic_load_explicit(m->facts, memory_order_acquire)
                    : NULL;
}

static bool
trace_new(struct member *m, int x, int y, struct rad_pixel *out)
{
    const struct team_spec *spec = &m->team->spec;

    if (!spec->trace(spec->arg, m->ctx, x, y, out))
        return false;
    m->traced++;
    return true;
}

/* A pixel that the true sampler wants. */
static void
trace_truth(struct member *m, struct rad_facts *f, int x, int y,
            struct rad_pixel *out)
{
    int column = x - m->q.x0, row = y - m->q.y0 - m->row0;

    if (rad_facts_use(f, column, row, out)) {
        m->primary++;
        return;
    }
    if (!trace_new(m, x, y, out))
        return;
    m->primary++;
    /* another worker may have been first just now; then that one is used */
    if (!rad_facts_put(f, column, row, out, RAD_FACT_USED))
        rad_facts_use(f, column, row, out);
}

/* A pixel that may be wanted one day. */
static void
trace_ahead(struct member *m, struct rad_facts *f, int x, int y,
            struct rad_pixel *out)
{
    int column = x - m->q.x0, row = y - m->q.y0 - m->row0;

    if (!rad_facts_get(f, column, row, out) && trace_new(m, x, y, out))
        rad_facts_put(f, column, row, out, 0);
}

/* A pixel that was traced while the member waited; false: it was not. */
static bool
recall(const struct member *m, int x, int y, struct rad_pixel *out)
{
    const struct line *l = line_at(m->team, m->i);

    if (!l->known || y != m->row || !l->known[x - m->q.x0])
        return false;
    *out = l->early[x - m->q.x0];
    return true;
}

static void
remember(const struct member *m, int column, const struct rad_pixel *p)
{
    struct line *l = line_at(m->team, m->i);

    l->early[column] = *p;
    l->known[column] = true;
}

static void
trace(void *arg, int x, int y, struct rad_pixel *out)
{
    struct member *m = arg;
    struct rad_facts *f = facts_of(m);

    if (recall(m, x, y, out)) {
        m->primary += !m->early;
    } else if (!f && m->early) {
        if (trace_new(m, x, y, out))
            remember(m, x - m->q.x0, out);
    } else if (!f)
        m->primary += trace_new(m, x, y, out);
    else if (m->truth && !m->early)
        trace_truth(m, f, x, y, out);
    else
        trace_ahead(m, f, x, y, out);
}

static bool
is_stopped(const struct team *t)
{
    return atomic_load_explicit(&t->stopped, memory_order_relaxed);
}

/* The order of store and load here, and in wait_for(), is what keeps a waker
 * from missing a sleeper: both are sequentially consistent. */
static void
publish(struct team *t, struct line *l, size_t ready)
{
    size_t wanted;

    atomic_store(&l->ready, ready);
    wanted = atomic_load(&l->wanted);
    if (wanted == 0 || ready < wanted)
        return;
    uv_mutex_lock(&t->mu);
    uv_cond_signal(&l->moved);
    uv_mutex_unlock(&t->mu);
}

/* Wait until `need` of the line's densities are final; false: stopped. */
static bool
wait_for(struct team *t, struct line *l, size_t need)
{
    uint64_t begin;

    for (int spin = 0; spin < SPINS; spin++)
        if (atomic_load(&l->ready) >= need)
            return true;
    begin = uv_hrtime();
    uv_mutex_lock(&t->mu);
    atomic_store(&l->wanted, need);
    while (atomic_load(&l->ready) < need && !is_stopped(t))
        uv_cond_wait(&l->moved, &t->mu);
    atomic_store(&l->wanted, 0);
    t->waited_s += 1e-9 * (double)(uv_hrtime() - begin);
    uv_mutex_unlock(&t->mu);
    return !is_stopped(t);
}

static uint64_t
count_rays(const struct member *m)
{
    const struct team_spec *spec = &m->team->spec;

    return spec->count ? spec->count(spec->arg, m->ctx) : m->traced;
}

/* Let others see the rays that are new. */
static void
tell_rays(struct member *m)
{
    uint64_t n = count_rays(m) - m->told;

    m->told += n;
    atomic_fetch_add_explicit(&m->team->rays, n, memory_order_relaxed);
}

/* The same, if there are so many; called often. */
static void
maybe_tell_rays(struct member *m)
{
    if (m->traced - m->looked < PIXELS_UNSEEN)
        return;
    m->looked = m->traced;
    if (count_rays(m) - m->told >= RAYS_UNTOLD)
        tell_rays(m);
}

/* Is the member's base line painted in this pass?  In one ahead of the truth,
 * only to be the top of the unit below. */
static bool
is_painted(const struct member *m)
{
    const struct team *t = m->team;

    return t->spec.mode == TEAM_TRUTH ||
           (t->spec.true_top &&
            m->i + 1 == atomic_load_explicit(&t->last, memory_order_relaxed));
}

/* Put columns up to `end` of the member's base line into the picture. */
static void
show(struct member *m, int end)
{
    const struct team_spec *spec = &m->team->spec;
    struct line *l = line_at(m->team, m->i);
    int row = rad_quincunx_base_row(&m->q, m->i);
    int x = atomic_load_explicit(&l->shown, memory_order_relaxed);
    struct rad_pixel *to = row_at(m->team, row) + x;

    memcpy(to, l->sampled + x, (size_t)(end - x) * sizeof *to);
    if (spec->paint && is_painted(m))
        spec->paint(spec->arg, m->ctx, m->q.x0 + x, m->q.x0 + end,
                    m->q.y0 + row, to);
    /* pairs with the load in team_bottom() */
    atomic_store_explicit(&l->shown, end, memory_order_release);
}

static bool
is_bottom(const struct member *m)
{
    return m->i + 1 ==
           atomic_load_explicit(&m->team->last, memory_order_relaxed);
}

/* The unit below may wait for what this line has: do not keep it. */
static void
show_bottom(struct member *m, int end)
{
    struct team *t = m->team;

    if (is_bottom(m) && end - atomic_load_explicit(&line_at(t, m->i)->shown,
                                                   memory_order_relaxed) >=
                            BOTTOM_COLUMNS)
        show(m, end);
}

/* Densities of the line above that the next step reads.  The last step of a
 * line takes over what lies beyond its own. */
static size_t
needed(const struct member *m, const struct rad_quincunx_line *s)
{
    size_t n = rad_quincunx_line_needs(s);

    if (n == 0)
        return 0;
    if (n > m->team->ndensity || m->q.width - 1 - s->x <= m->q.xstep)
        n = m->team->ndensity;
    return n;
}

/* The first line's top is there from the start. */
static bool
wait_above(const struct member *m, size_t need)
{
    struct team *t = m->team;

    return m->i == t->spec.first || need == 0 ||
           wait_for(t, line_at(t, m->i - 1), need);
}

static const uint8_t *
density_above(const struct member *m)
{
    const struct team *t = m->team;

    if (t->ndensity == 0)
        return NULL;
    return m->i > t->spec.first ? line_at(t, m->i - 1)->density : t->density;
}

/* Is that pixel of base line i, as it is here, a traced one?  There may be
 * facts that this pass did not want: of an estimate, or of another's better
 * guess. */
static bool
was_traced(const struct team *t, int i, int x, const struct rad_pixel *here)
{
    const struct rad_facts *f =
        atomic_load_explicit(&t->spec.facts[i], memory_order_acquire);
    struct rad_pixel p;

    return f && rad_facts_get(f, x, rad_facts_rows(f) - 1, &p) &&
           memcmp(&p, here, sizeof p) == 0;
}

/* What is traced between two pixels that were traced themselves the truth wants
 * too: it has the same colours there, and no less density.  Where the sampler
 * found nothing in a gap it may have been for lack of densities. */
static bool
is_certain(const struct member *m, struct rad_pixel *const rows[], int x)
{
    int n = team_line_rows(&m->q, m->i);

    return was_traced(m->team, m->i, x, &rows[n][x]) &&
           was_traced(m->team, m->i - 1, x, &rows[0][x]);
}

/* Fill columns up to `end` of the bar below base line i - 1, some. */
static void
fill_some(struct member *m, struct rad_pixel *const rows[],
          struct rad_quincunx_fill *s, int end)
{
    if (!m->unsure) {
        rad_quincunx_bar_to(&m->q, m->i - 1, rows, s, end);
        return;
    }
    for (int x = s->x; x < end; x++)
        if (is_certain(m, rows, x)) {
            if (s->x < x)
                *s = (struct rad_quincunx_fill){ x, 0 };
            rad_quincunx_bar_to(&m->q, m->i - 1, rows, s, x + 1);
        }
    s->x = end;
    s->found = 0;
}

/* The same, any number; false: stopped. */
static bool
fill_columns(struct member *m, struct rad_pixel *const rows[],
             struct rad_quincunx_fill *s, int end)
{
    while (s->x < end) {
        int left = end - s->x;

        fill_some(m, rows, s, s->x + (left < BAR_COLUMNS ? left : BAR_COLUMNS));
        maybe_tell_rays(m);
        if (is_stopped(m->team))
            return false;
    }
    return true;
}

/* A line that is traced ahead in blocks of gaps or of columns. */
struct sweep {
    struct member *m;
    int row, rows; /* of the line, that the blocks have */
    int nblocks;   /* at most 64 */
    int columns;   /* of a block, but for the last */
    uint64_t done; /* blocks begun or not worth it */
    int at, step;  /* the block that comes next, and which way then */
};

/* Begin where the spec says. */
static void
start_sweep(struct sweep *s, struct member *m, int row, int rows, int columns)
{
    enum team_end end = m->team->spec.end;
    bool middle = end >= TEAM_MIDDLE_RIGHTWARDS;

    s->m = m;
    s->row = row;
    s->rows = rows;
    s->columns = columns;
    s->nblocks = (m->q.width + columns - 1) / columns;
    s->done = 0;
    s->step = end == TEAM_FROM_RIGHT || end == TEAM_MIDDLE_LEFTWARDS ? -1 : 1;
    s->at = s->step > 0 ? 0 : s->nblocks - 1;
    if (middle)
        s->at = s->nblocks / 2 - (s->step < 0 && s->nblocks > 1);
}

/* Is there nothing to do in block b: begun here, or by another worker? */
static bool
is_taken(struct sweep *s, int b)
{
    int x = b * s->columns, left = s->m->q.width - x;
    const struct rad_facts *f = facts_of(s->m);

    return s->done >> b & 1 ||
           rad_facts_met(f, s->row, s->rows, x,
                         left < s->columns ? left : s->columns);
}

/* The middle of the longest run of blocks that are not taken; -1: none. */
static int
widest_gap(struct sweep *s)
{
    int best = -1, most = 0, run = 0;

    for (int b = 0; b < s->nblocks; b++) {
        run = is_taken(s, b) ? 0 : run + 1;
        if (run > most) {
            most = run;
            best = b;
        }
    }
    return most > 0 ? best - most / 2 : -1;
}

/* The next block; -1: all are taken, or the team is stopped. */
static int
next_block(struct sweep *s)
{
    int b = s->at;

    if (is_stopped(s->m->team))
        return -1;
    if (b < 0 || b >= s->nblocks || is_taken(s, b))
        b = widest_gap(s);
    if (b >= 0)
        s->done |= UINT64_C(1) << b;
    s->at = b + s->step;
    return b;
}

/* At most 64 blocks, none too small to be worth the look at it. */
static int
block_columns(const struct rad_quincunx *q)
{
    int columns = (q->width + 63) / 64;

    return columns > q->xstep ? columns : q->xstep;
}

/* Trace base line i ahead; false: stopped. */
static bool
sweep_line(struct member *m)
{
    const struct rad_quincunx *q = &m->q;
    struct team *t = m->team;
    int ngaps = rad_quincunx_ngaps(q, m->i), b;
    bool truth = m->truth;
    struct sweep s;

    if (!wait_above(m, t->ndensity))
        return false;
    m->truth = false;
    start_sweep(&s, m, team_line_rows(q, m->i) - 1, 1, block_columns(q));
    while ((b = next_block(&s)) >= 0) {
        int end = (b + 1) * s.columns;

        for (int g = b * s.columns / q->xstep; g < ngaps; g++) {
            int x = rad_quincunx_gap_begin(q, m->i, g);

            if (x >= end || is_stopped(t))
                break;
            if (x >= b * s.columns)
                rad_quincunx_gap(q, m->i, g, density_above(m),
                                 line_at(t, m->i)->sampled);
            maybe_tell_rays(m);
        }
    }
    m->truth = truth;
    return !is_stopped(t);
}

/* Trace the bar ahead whose rows those are; false: stopped. */
static bool
sweep_bar(struct member *m, struct rad_pixel *const rows[])
{
    bool truth = m->truth;
    struct sweep s;
    int b;

    m->truth = false;
    start_sweep(&s, m, 0, team_line_rows(&m->q, m->i) - 1,
                block_columns(&m->q));
    while ((b = next_block(&s)) >= 0) {
        struct rad_quincunx_fill fill = { b * s.columns, 0 };
        int end = fill.x + s.columns;

        fill_columns(m, rows, &fill, end < m->q.width ? end : m->q.width);
    }
    m->truth = truth;
    return !is_stopped(m->team);
}

/* Is the member's line to be traced ahead in an order of its own? */
static bool
wants_sweep(const struct member *m)
{
    return m->team->spec.end != TEAM_FROM_LEFT && facts_of(m);
}

/* While the line above has not come so far, trace gaps of line i that follow
 * the one that s is at: what their ends force, which more densities only add
 * to. With facts they keep it, else the line does.  They are taken from the
 * right, far from where the line above is: close by, both would make the same
 * ambient records (2 % more rays in a Cornell box). */
static void
trace_early(struct member *m, const struct rad_quincunx_line *s, size_t need)
{
    struct team *t = m->team;
    struct line *l = line_at(t, m->i);

    if (!l->known || m->i == t->spec.first || need == 0)
        return;
    m->early = true;
    while (atomic_load(&line_at(t, m->i - 1)->ready) < need && !is_stopped(t)) {
        if (m->ahead - 1 <= (int)s->gap)
            break;
        rad_quincunx_gap(&m->q, m->i, --m->ahead, NULL, l->sampled);
        maybe_tell_rays(m);
    }
    m->early = false;
}

/* Sample base line i; false: stopped. */
static bool
sample_line(struct member *m)
{
    struct team *t = m->team;
    struct line *l = line_at(t, m->i);
    struct rad_quincunx_line s;

    if (wants_sweep(m) && !sweep_line(m))
        return false;
    rad_quincunx_line_start(&s, &m->q, m->i, density_above(m), l->density,
                            l->sampled);
    do {
        size_t need = needed(m, &s);

        if (s.ndensity > 0 && t->spec.nthreads > 1) /* else nobody waits */
            publish(t, l, s.ndensity);
        show_bottom(m, s.x + 1);
        maybe_tell_rays(m);
        trace_early(m, &s, need);
        if (is_stopped(t) || !wait_above(m, need))
            return false;
    } while (rad_quincunx_line_step(&s));
    show(m, m->q.width);
    publish(t, l, t->ndensity + 1);
    if (is_bottom(m) && t->spec.bottom)
        t->spec.bottom(t->spec.arg);
    return true;
}

/* Fill the bar above base line i; false: stopped. */
static bool
fill_bar(struct member *m)
{
    struct team *t = m->team;
    const struct team_spec *spec = &t->spec;
    struct rad_pixel *rows[RAD_QUINCUNX_MAX_YSTEP + 1];
    struct rad_quincunx_fill s = { 0, 0 };
    int top = rad_quincunx_base_row(&m->q, m->i - 1);
    int n = rad_quincunx_base_row(&m->q, m->i) - top;

    if (!wait_above(m, t->ndensity + 1))
        return false;
    for (int k = 0; k < n; k++)
        rows[k] = row_at(t, top + k);
    rows[n] = line_at(t, m->i)->sampled;
    if (wants_sweep(m) && n > 1 && !sweep_bar(m, rows))
        return false;
    if (!fill_columns(m, rows, &s, m->q.width))
        return false;
    for (int k = 1; k < n && m->truth && spec->paint; k++)
        spec->paint(spec->arg, m->ctx, m->q.x0, m->q.x0 + m->q.width,
                    m->q.y0 + top + k, rows[k]);
    return true;
}

/* Has line i's bar to be filled in this pass? */
static bool
has_bar(const struct team *t, int i)
{
    return i > 0 && t->spec.mode != TEAM_LINES &&
           (i > t->spec.first || t->spec.top);
}

/* Lines whose densities go into those above line i, as far as the guess knows
 * of them. */
static int
known_above(const struct team *t, int i)
{
    return i - t->spec.first + (t->spec.top_density ? t->spec.top_known : 0);
}

/* Are the colours above the member's bar sampled with too little known of the
 * densities? */
static bool
is_unsure(const struct member *m)
{
    const struct team *t = m->team;

    return t->spec.mode == TEAM_AHEAD && !t->spec.true_top && t->ndensity > 0 &&
           t->spec.first > 0 && known_above(t, m->i) < TEAM_SURE;
}

static bool
do_line(struct member *m)
{
    const struct team *t = m->team;

    m->row0 = team_line_row(&m->q, m->i);
    m->row = m->q.y0 + rad_quincunx_base_row(&m->q, m->i);
    m->ahead = rad_quincunx_ngaps(&m->q, m->i);
    if (line_at(t, m->i)->known)
        memset(line_at(t, m->i)->known, 0, (size_t)m->q.width * sizeof(bool));
    m->unsure = is_unsure(m);
    m->facts = t->spec.facts ? &t->spec.facts[m->i] : NULL;
    return sample_line(m) && (!has_bar(t, m->i) || fill_bar(m));
}

/* Hand on the rows of line i: its bar's and its own. */
static void
hand_on(struct team *t, int i)
{
    int row = team_line_row(&t->spec.sampler, i);
    int end = row + team_line_rows(&t->spec.sampler, i);

    if (t->spec.mode != TEAM_TRUTH)
        return;
    for (; row < end; row++)
        t->spec.rows(t->spec.arg, row, row_at(t, row));
}

/* Line i is done.  If it was the one that all others waited to come after,
 * hand on what is complete, unless another member is at it. */
static void
finish_line(struct team *t, int i)
{
    uv_mutex_lock(&t->mu);
    line_at(t, i)->done = true;
    if (!t->handing_on) {
        t->handing_on = true;
        while (t->finished < t->begun && line_at(t, t->finished)->done) {
            uv_mutex_unlock(&t->mu);
            hand_on(t, t->finished);
            uv_mutex_lock(&t->mu);
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

/* The next line to begin, once its buffers are free; -1: there is none. */
static int
begin_line(struct team *t)
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
    }
    uv_mutex_unlock(&t->mu);
    return i;
}

/* Work on lines until there is none. */
static void
do_lines(struct member *m)
{
    while ((m->i = begin_line(m->team)) >= 0) {
        if (!do_line(m))
            return;
        tell_rays(m);
        finish_line(m->team, m->i);
    }
}

void
team_work(struct team *t, struct rad_ctx *ctx)
{
    const struct team_spec *spec = &t->spec;
    struct member m = { .team = t, .ctx = ctx, .q = spec->sampler };

    m.truth = spec->mode == TEAM_TRUTH;
    m.told = count_rays(&m);
    m.q.trace = trace;
    m.q.arg = &m;
    do_lines(&m);
    tell_rays(&m);
    atomic_fetch_add_explicit(&t->traced, m.traced, memory_order_relaxed);
    atomic_fetch_add_explicit(&t->primary, m.primary, memory_order_relaxed);
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
    keep = last - (last - t->begun + 1) / 2; /* it is at another, too */
    if (keep == t->begun && t->spec.mode != TEAM_TRUTH)
        keep++; /* that one was not painted as the bottom */
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

bool
team_done(const struct team *t)
{
    return t->finished == atomic_load(&t->last);
}

uint64_t
team_traced(const struct team *t)
{
    return atomic_load_explicit(&t->traced, memory_order_relaxed);
}

uint64_t
team_primary(const struct team *t)
{
    return atomic_load_explicit(&t->primary, memory_order_relaxed);
}

/* Every buffer; the lines' densities and pixels lie one after the other. */
static bool
make_buffers(struct team *t)
{
    size_t width = (size_t)t->spec.sampler.width, n = (size_t)t->nlines;
    size_t early = t->spec.nthreads > 1 && t->ndensity > 0 ? n : 0;

    t->lines = calloc(n, sizeof *t->lines);
    t->density = calloc(n + 1, t->ndensity + 1);
    t->pixels =
        calloc((early + n + (size_t)t->nslots) * width, sizeof *t->pixels);
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
put_top(struct team *t)
{
    const struct team_spec *spec = &t->spec;
    int above = spec->first - 1;

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
    if (!t)
        return NULL;
    uv_mutex_init(&t->mu);
    uv_cond_init(&t->moved);
    t->spec = *spec;
    t->last = spec->last;
    t->begun = t->finished = spec->first;
    t->ndensity = rad_quincunx_ndensity(&spec->sampler);
    /* each member's line, one above the first and one to begin meanwhile */
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
    for (int i = 0; i < t->nlines && t->slots; i++)
        uv_cond_destroy(&t->lines[i].moved);
    free(t->lines);
    free(t->density);
    free(t->known);
    free(t->pixels);
    free(t);
}
