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

/* Blocks of a line at most: bits of a number. */
#define MOST_BLOCKS 64

/* A base line's row costs so much more than a bar's. */
#define BASE_WEIGHT 1.5

/* Columns that are lent at a time: what is said of them fits a message. */
#define MOST_LENT 24000

/* The bottom is painted, and told of, in pieces of so many columns at least. */
#define BOTTOM_COLUMNS 64

/* The two things that blocks of a line are of. */
enum part { PART_BASE, PART_BAR, NPART };

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
    /* Blocks that its member began, or that are lent: whoever sets a bit has
     * the block.  Nothing else is told by it: sequentially consistent for want
     * of a reason. */
    _Atomic uint64_t taken[NPART];
    bool done; /* [mu] and the bar above it */
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
    _Atomic uint64_t primary; /* relaxed: read when all have left */
    _Atomic bool stopped;     /* relaxed where it only ends work earlier */
    struct team_blocks lent;  /* [mu] of line spec.last - 1 */
    bool blocked; /* [mu] a member has left because of what is lent */
};

/* One member at work on one line. */
struct member {
    struct team *team;
    struct rad_ctx *ctx;
    struct rad_quincunx q;
    int i;
    _Atomic(struct rad_facts *) *facts; /* of line i; NULL: never any */
    int row0;                           /* the first of line i */
    bool truth;  /* what is asked for now is wanted indeed */
    bool early;  /* or will be, and counts then */
    int row;     /* of line i's base line, in the picture */
    int ahead;   /* the first of its gaps that were traced while it waited */
    bool unsure; /* of the colours that the bar is filled between */
    uint64_t mine[NPART]; /* blocks of line i that it began */
    uint64_t told;        /* of count(ctx) */
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
is_certain(const struct team *t, int i, struct rad_pixel *const rows[], int x)
{
    int n = team_line_rows(&t->spec.sampler, i);

    return was_traced(t, i, x, &rows[n][x]) &&
           was_traced(t, i - 1, x, &rows[0][x]);
}

static bool
is_wanted(const struct team_loan *loan, int x)
{
    int i = x - loan->x;

    return loan->wanted[i / 8] >> i % 8 & 1;
}

/* Fill columns up to `end` of the bar below base line i - 1, some. */
static void
fill_some(struct member *m, struct rad_pixel *const rows[],
          struct rad_quincunx_fill *s, int end)
{
    const struct team_loan *loan = m->team->spec.loan;

    if (!m->unsure && !loan) {
        rad_quincunx_bar_to(&m->q, m->i - 1, rows, s, end);
        return;
    }
    for (int x = s->x; x < end; x++)
        if (loan ? is_wanted(loan, x) : is_certain(m->team, m->i, rows, x)) {
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

/* Is the block the member's to trace?  Not if it is lent. */
static bool
claim(struct member *m, enum part part, int b)
{
    uint64_t bit = UINT64_C(1) << b;

    if (!(m->mine[part] & bit) &&
        atomic_fetch_or(&line_at(m->team, m->i)->taken[part], bit) & bit)
        return false;
    m->mine[part] |= bit;
    return true;
}

/* A line that is traced ahead in blocks of gaps or of columns. */
struct sweep {
    struct member *m;
    enum part part;
    int row, rows; /* of the line, that the blocks have */
    int nblocks;   /* at most 64 */
    int columns;   /* of a block, but for the last */
    uint64_t done; /* blocks begun or not worth it */
    int at, step;  /* the block that comes next, and which way then */
};

/* Begin where the spec says. */
static void
start_sweep(struct sweep *s, struct member *m, enum part part)
{
    int n = team_line_rows(&m->q, m->i), columns = team_block_columns(&m->q);
    enum team_end end = m->team->spec.end;
    bool middle = end >= TEAM_MIDDLE_RIGHTWARDS;

    s->m = m;
    s->part = part;
    s->row = part == PART_BASE ? n - 1 : 0;
    s->rows = part == PART_BASE ? 1 : n - 1;
    s->columns = columns;
    s->nblocks = (m->q.width + columns - 1) / columns;
    s->done = m->mine[part];
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
    while (!is_stopped(s->m->team)) {
        int b = s->at;

        if (b < 0 || b >= s->nblocks || is_taken(s, b))
            b = widest_gap(s);
        if (b < 0)
            break;
        s->done |= UINT64_C(1) << b;
        s->at = b + s->step;
        if (claim(s->m, s->part, b))
            return b;
    }
    return -1;
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
    start_sweep(&s, m, PART_BASE);
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

/* Trace those blocks ahead of the bar whose rows those are; false: stopped. */
static bool
sweep_bar(struct member *m, struct rad_pixel *const rows[], uint64_t blocks)
{
    bool truth = m->truth;
    struct sweep s;
    int b;

    if (team_line_rows(&m->q, m->i) == 1)
        return true;
    m->truth = false;
    start_sweep(&s, m, PART_BAR);
    s.done |= ~blocks;
    while ((b = next_block(&s)) >= 0) {
        struct rad_quincunx_fill fill = { b * s.columns, 0 };
        int end = fill.x + s.columns;

        fill_columns(m, rows, &fill, end < m->q.width ? end : m->q.width);
    }
    m->truth = truth;
    return !is_stopped(m->team);
}

/* Has line i's bar to be filled in this pass? */
static bool
has_bar(const struct team *t, int i)
{
    return i > 0 && t->spec.mode != TEAM_LINES &&
           (i > t->spec.first || t->spec.top || t->spec.loan);
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

/* The rows of line i, and of the base line above, as the bar wants them. */
static void
bar_rows(const struct member *m, struct rad_pixel *rows[])
{
    int top = rad_quincunx_base_row(&m->q, m->i - 1);
    int n = team_line_rows(&m->q, m->i);

    for (int k = 0; k < n; k++)
        rows[k] = row_at(m->team, top + k);
    rows[n] = line_at(m->team, m->i)->sampled;
}

/* Nothing is left of a line but what is lent. */
static bool
leave_blocked(struct member *m)
{
    struct team *t = m->team;

    uv_mutex_lock(&t->mu);
    t->blocked = true;
    uv_mutex_unlock(&t->mu);
    return false;
}

/* A part of the base line is lent: trace what is not, and the bar above it.  A
 * block's first columns belong to a gap that begins in the one before. */
static bool
leave_line(struct member *m)
{
    struct rad_pixel *rows[RAD_QUINCUNX_MAX_YSTEP + 1];
    uint64_t mine;

    if (!sweep_line(m))
        return false;
    mine = m->mine[PART_BASE];
    if (has_bar(m->team, m->i)) {
        bar_rows(m, rows);
        if (!sweep_bar(m, rows, mine & (mine << 1 | 1)))
            return false;
    }
    return leave_blocked(m);
}

/* Is that gap of the base line the member's to trace? */
static bool
claim_gap(struct member *m, size_t gap)
{
    int x;

    if ((int)gap >= rad_quincunx_ngaps(&m->q, m->i))
        return true;
    x = rad_quincunx_gap_begin(&m->q, m->i, (int)gap);
    return claim(m, PART_BASE, x / team_block_columns(&m->q));
}

/* Sample base line i; false: stopped, or blocked. */
static bool
sample_line(struct member *m)
{
    struct team *t = m->team;
    struct line *l = line_at(t, m->i);
    struct rad_quincunx_line s;

    if (wants_sweep(m) && !sweep_line(m))
        return false;
    if (!claim(m, PART_BASE, 0))
        return leave_line(m);
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
        if (!claim_gap(m, s.gap))
            return leave_line(m);
    } while (rad_quincunx_line_step(&s));
    show(m, m->q.width);
    publish(t, l, t->ndensity + 1);
    if (is_bottom(m) && t->spec.bottom)
        t->spec.bottom(t->spec.arg);
    return true;
}

/* Fill the bar in order, but for blocks that are lent: ahead of the truth these
 * are left out.  False: stopped, or blocked. */
static bool
fill_blocks(struct member *m, struct rad_pixel *const rows[])
{
    int columns = team_block_columns(&m->q), width = m->q.width;
    struct rad_quincunx_fill s = { 0, 0 };

    while (s.x < width) {
        int b = s.x / columns, end = (b + 1) * columns;

        end = end < width ? end : width;
        if (claim(m, PART_BAR, b)) {
            if (!fill_columns(m, rows, &s, end))
                return false;
        } else if (m->truth) {
            return sweep_bar(m, rows, UINT64_MAX) && leave_blocked(m);
        } else {
            s = (struct rad_quincunx_fill){ end, 0 };
        }
    }
    return true;
}

/* Fill the bar above base line i; false: stopped, or blocked. */
static bool
fill_bar(struct member *m)
{
    struct team *t = m->team;
    const struct team_spec *spec = &t->spec;
    struct rad_pixel *rows[RAD_QUINCUNX_MAX_YSTEP + 1];
    int top = rad_quincunx_base_row(&m->q, m->i - 1);
    int n = team_line_rows(&m->q, m->i);

    if (!wait_above(m, t->ndensity + 1))
        return false;
    bar_rows(m, rows);
    if (wants_sweep(m) && !sweep_bar(m, rows, UINT64_MAX))
        return false;
    if (!fill_blocks(m, rows))
        return false;
    for (int k = 1; k < n && m->truth && spec->paint; k++)
        spec->paint(spec->arg, m->ctx, m->q.x0, m->q.x0 + m->q.width,
                    m->q.y0 + top + k, rows[k]);
    return true;
}

/* Blocks of the bar that lie below those of the base line that were traced
 * here: a block's first columns belong to a gap that begins in the one before.
 */
static uint64_t
bars_of(const struct member *m, const struct team_loan *loan)
{
    uint64_t mine = m->mine[PART_BASE];
    int first = loan->x / team_block_columns(&m->q);

    return mine & (mine << 1 | UINT64_C(1) << first);
}

/* Columns that another team lends. */
static bool
do_loan(struct member *m)
{
    const struct team_loan *loan = m->team->spec.loan;
    struct rad_pixel *rows[RAD_QUINCUNX_MAX_YSTEP + 1];
    struct line *l = line_at(m->team, m->i);

    if (!loan->base)
        memcpy(l->sampled + loan->x, loan->bottom,
               (size_t)loan->n * sizeof *l->sampled);
    else if (!sweep_line(m))
        return false;
    publish(m->team, l, m->team->ndensity + 1);
    bar_rows(m, rows);
    return sweep_bar(m, rows, loan->base ? bars_of(m, loan) : UINT64_MAX);
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
    m->mine[PART_BASE] = m->mine[PART_BAR] = 0;
    if (t->spec.loan)
        return do_loan(m);
    return sample_line(m) && (!has_bar(t, m->i) || fill_bar(m));
}

/* Hand on the rows of line i: its bar's and its own. */
static void
hand_on(struct team *t, int i)
{
    int row = team_line_row(&t->spec.sampler, i);
    int end = row + team_line_rows(&t->spec.sampler, i);

    if (t->spec.mode != TEAM_TRUTH || i < t->spec.out)
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

/* What of the line is not the member's to trace. */
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
    atomic_store(&line_at(t, i)->taken[PART_BASE], away.base);
    atomic_store(&line_at(t, i)->taken[PART_BAR], away.bar);
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
        begin_blocks_locked(t, i);
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

int
team_block_columns(const struct rad_quincunx *q)
{
    int columns = (q->width + MOST_BLOCKS - 1) / MOST_BLOCKS;

    return columns > q->xstep ? columns : q->xstep;
}

uint64_t
team_blocks_of(const struct rad_quincunx *q, int x, int n)
{
    int columns = team_block_columns(q), end = x + n;
    int first = x / columns, last = (end + columns - 1) / columns;

    if (n <= 0 || x % columns != 0 || end > q->width ||
        (end % columns != 0 && end != q->width))
        return 0;
    return (UINT64_MAX >> (MOST_BLOCKS - last)) & ~((UINT64_C(1) << first) - 1);
}

static int
count_blocks(uint64_t v)
{
    int n = 0;

    for (; v; v &= v - 1)
        n++;
    return n;
}

/* The longest run of blocks. */
static uint64_t
longest_run(uint64_t blocks)
{
    int end = 0, longest = 0, run = 0;

    for (int b = 0; b < MOST_BLOCKS; b++) {
        run = blocks >> b & 1 ? run + 1 : 0;
        if (run > longest) {
            longest = run;
            end = b + 1;
        }
    }
    if (longest == 0)
        return 0;
    return (UINT64_MAX >> (MOST_BLOCKS - end)) &
           ~((UINT64_C(1) << (end - longest)) - 1);
}

/* Is line i's base line done?  Else it may be lent if it is known what there is
 * to trace, and the member asks before each gap. */
static bool
base_is_done(struct team *t, int i)
{
    return atomic_load(&line_at(t, i)->ready) == t->ndensity + 1;
}

static bool
base_can_be_lent(const struct team *t, int i)
{
    if (t->spec.mode == TEAM_AHEAD)
        return false;
    return i == t->spec.first || t->spec.nthreads == 1;
}

/* Is anything known of columns [x, x + n) of rows [row, row + rows) of line i?
 * It would be traced again. */
static bool
knows(const struct team *t, int i, int x, int n, int row, int rows)
{
    const struct rad_facts *f =
        atomic_load_explicit(&t->spec.facts[i], memory_order_acquire);
    struct rad_pixel p;

    for (int r = row; r < row + rows; r++)
        for (int k = x; k < x + n; k++)
            if (rad_facts_get(f, k, r, &p))
                return true;
    return false;
}

/* What is looked at to lend of a line. */
struct lending {
    struct team *t;
    int i, bars; /* the line, and its bar's rows */
    bool base;   /* its base line is to be traced, too */
    bool unsure;
    struct rad_pixel *rows[RAD_QUINCUNX_MAX_YSTEP + 1];
};

/* Would whoever has column x of the bar trace something there? */
static bool
wants_column(const struct lending *l, int x)
{
    const struct team_loan *loan = l->t->spec.loan;

    if (loan ? !is_wanted(loan, x)
             : l->unsure && !is_certain(l->t, l->i, l->rows, x))
        return false;
    return !knows(l->t, l->i, x, 1, 0, l->bars);
}

/* What block b costs yet, of a line's 1; 0: it is not worth it. */
static double
block_cost(const struct lending *l, int b)
{
    const struct rad_quincunx *q = &l->t->spec.sampler;
    int columns = team_block_columns(q), x = b * columns, n = 0;
    int end = x + columns < q->width ? x + columns : q->width;
    double all = (BASE_WEIGHT + l->bars) * q->width;

    if (l->base && knows(l->t, l->i, x, end - x, l->bars, 1))
        return 0;
    for (int k = x; k < end; k++)
        n += wants_column(l, k);
    if (n == 0)
        return 0;
    return (n * l->bars + (l->base ? BASE_WEIGHT * (end - x) : 0)) / all;
}

/* Take blocks that nobody has; those are given back that do not follow each
 * other, for a member may have been quicker. */
static uint64_t
take_blocks(struct line *l, enum part part, uint64_t blocks)
{
    uint64_t got = blocks & ~atomic_fetch_or(&l->taken[part], blocks);
    uint64_t run = longest_run(got);

    atomic_fetch_and(&l->taken[part], ~(got & ~run));
    return run;
}

/* Of those blocks, which follow each other, the right ones that cost so much,
 * n at most; none, if one is more than twice that. */
static uint64_t
right_part(uint64_t run, const double cost[MOST_BLOCKS], double most, int n)
{
    uint64_t got = 0;
    double sum = 0;

    for (int b = MOST_BLOCKS - 1; b >= 0 && count_blocks(got) < n; b--) {
        if (!(run >> b & 1))
            continue;
        sum += cost[b];
        if (sum - cost[b] / 2 > most)
            break;
        got |= UINT64_C(1) << b;
    }
    return got;
}

/* Blocks for another team: some, if they are a part of what is left. */
static uint64_t
lend_blocks(const struct lending *by, double part, struct team_loan *loan)
{
    struct team *t = by->t;
    struct line *l = line_at(t, by->i);
    const struct rad_quincunx *q = &t->spec.sampler;
    uint64_t free = team_blocks_of(q, 0, q->width), got;
    double cost[MOST_BLOCKS], left = 0;

    free &= ~atomic_load(&l->taken[PART_BAR]) & ~t->lent.ever;
    if (by->base)
        free &= ~atomic_load(&l->taken[PART_BASE]);
    for (int b = 0; b < MOST_BLOCKS; b++) {
        cost[b] = free >> b & 1 ? block_cost(by, b) : 0;
        left += cost[b];
        if (cost[b] == 0)
            free &= ~(UINT64_C(1) << b);
    }
    got = right_part(longest_run(free), cost, part * left,
                     MOST_LENT / team_block_columns(q));
    if (by->base)
        got = take_blocks(l, PART_BASE, got);
    got = take_blocks(l, PART_BAR, got);
    loan->given = 0;
    for (int b = 0; b < MOST_BLOCKS; b++)
        loan->given += got >> b & 1 ? cost[b] : 0;
    loan->left = left - loan->given;
    t->lent.ever |= got;
    return got;
}

/* Columns of the bar that its lender would fill there. */
static void
want_columns(const struct lending *by, struct team_loan *loan)
{
    const struct rad_quincunx *q = &by->t->spec.sampler;
    int from = 0;

    for (int g = 0; loan->base && loan->x > 0; g++) {
        from = rad_quincunx_gap_begin(q, loan->line, g) - loan->x;
        if (from >= 0)
            break;
    }
    memset(loan->wanted, 0, (size_t)(loan->n + 7) / 8);
    for (int i = from; i < loan->n; i++)
        if (wants_column(by, loan->x + i))
            loan->wanted[i / 8] |= (uint8_t)(1u << i % 8);
}

/* The line that may be lent of: -1: none. */
static int
line_to_lend(const struct team *t)
{
    int i = atomic_load_explicit(&t->last, memory_order_relaxed) - 1;

    if (t->spec.mode == TEAM_LINES || t->begun != i + 1 || i < 1 ||
        t->finished > i || line_at(t, i)->done || !t->spec.facts ||
        !atomic_load_explicit(&t->spec.facts[i], memory_order_acquire))
        return -1;
    return i;
}

/* False: nothing can be lent now. */
static bool
start_lending(struct lending *by, struct team *t)
{
    struct member m = { .team = t, .q = t->spec.sampler };

    *by = (struct lending){ .t = t, .i = line_to_lend(t) };
    m.i = by->i;
    if (by->i < 0 || !has_bar(t, by->i) || is_stopped(t) || t->blocked)
        return false;
    by->bars = team_line_rows(&m.q, by->i) - 1;
    by->base = !base_is_done(t, by->i);
    by->unsure = is_unsure(&m);
    bar_rows(&m, by->rows);
    return by->bars > 0 && (!by->base || base_can_be_lent(t, by->i));
}

/* Say what is lent. */
static void
describe_loan(const struct lending *by, uint64_t blocks, struct team_loan *loan)
{
    struct team *t = by->t;
    const struct rad_quincunx *q = &t->spec.sampler;
    int columns = team_block_columns(q), first = 0;
    struct member m = { .team = t, .i = by->i };

    while (!(blocks >> first & 1))
        first++;
    loan->line = by->i;
    loan->base = by->base;
    loan->x = first * columns;
    loan->n = count_blocks(blocks) * columns;
    if (loan->n > q->width - loan->x)
        loan->n = q->width - loan->x;
    loan->top = by->rows[0] + loan->x;
    loan->density = by->base ? density_above(&m) : NULL;
    loan->bottom = by->base ? NULL : by->rows[by->bars + 1] + loan->x;
    want_columns(by, loan);
}

bool
team_lend(struct team *t, double part, struct team_loan *loan)
{
    struct lending by;
    uint64_t blocks = 0;

    uv_mutex_lock(&t->mu);
    if (start_lending(&by, t))
        blocks = lend_blocks(&by, part, loan);
    uv_mutex_unlock(&t->mu);
    if (blocks)
        describe_loan(&by, blocks, loan);
    return blocks != 0;
}

void
team_back(struct team *t, uint64_t blocks)
{
    int i;

    uv_mutex_lock(&t->mu);
    i = atomic_load_explicit(&t->last, memory_order_relaxed) - 1;
    t->lent.base &= ~blocks;
    t->lent.bar &= ~blocks;
    if (t->begun > i)
        for (int k = 0; k < NPART; k++)
            atomic_fetch_and(&line_at(t, i)->taken[k], ~blocks);
    uv_mutex_unlock(&t->mu);
}

bool
team_blocked(const struct team *t, int *finished)
{
    *finished = t->finished;
    return t->blocked;
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
