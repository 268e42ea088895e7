/* team_line.c - a member's work on one line
 *
 * The member samples the base line close behind the member on the line above,
 * then fills the bar between the two; team_impl.h tells what it waits for. */
#include "config.h"

#include "team/team_member.h"

#include <string.h>
#include <time.h>

/* The bottom is painted and shown in pieces of at least so many columns. */
#define BOTTOM_COLUMNS 64

/* Does this pass paint the member's base line?  In LINES only the bottom is
 * painted, for it is the top of the unit below. */
static bool
is_painted(const struct member *m)
{
    const struct team *t = m->team;

    return t->spec.mode == TEAM_TRUTH ||
           (t->spec.ahead.true_top &&
            m->i + 1 == atomic_load_explicit(&t->last, memory_order_relaxed));
}

/* Put columns up to `end` of the member's base line into their row, painted if
 * need be. */
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

/* Show columns of the bottom up to `end`: the unit below may wait for them. */
static void
show_bottom(struct member *m, int end)
{
    struct team *t = m->team;

    if (is_bottom(m) && end - atomic_load_explicit(&line_at(t, m->i)->shown,
                                                   memory_order_relaxed) >=
                            BOTTOM_COLUMNS)
        show(m, end);
}

/* How many densities of the line above the next step needs.  The last step of a
 * line copies all that lie beyond the line's own. */
static size_t
densities_needed(const struct member *m, const struct rad_quincunx_line *s)
{
    size_t n = rad_quincunx_line_needs(s);

    if (n == 0)
        return 0;
    if (n > m->team->ndensity || m->q.width - 1 - s->x <= m->q.xstep)
        n = m->team->ndensity;
    return n;
}

/* While the densities of the line above are not there, trace gaps of the line
 * to the right of s's: only pixels that the ends of a gap force, to which
 * densities can only add.  They are kept as facts, or by the line.  Gaps are
 * taken from the right, far from where the line above is: close to it both
 * lines would make the same ambient records (2 % more rays in a Cornell box).
 */
static void
trace_early(struct member *m, const struct rad_quincunx_line *s, size_t need)
{
    struct rad_pixel pixels[RAD_QUINCUNX_MAX_XSTEP + 1];
    struct team *t = m->team;

    if (!line_at(t, m->i)->known || m->i == t->spec.first || need == 0)
        return;
    m->early = true;
    while (atomic_load(&line_at(t, m->i - 1)->ready) < need && !is_stopped(t)) {
        if (m->ahead - 1 <= (int)s->gap || !help_claim_early(m, m->ahead - 1))
            break;
        rad_quincunx_gap(&m->q, m->i, --m->ahead, NULL, pixels);
        member_tell_rays(m);
    }
    m->early = false;
}

/* Note that only lent blocks are left of the line; returns false. */
static bool
leave_blocked(struct member *m)
{
    struct team *t = m->team;

    uv_mutex_lock(&t->mu);
    t->blocked = true;
    uv_mutex_unlock(&t->mu);
    return false;
}

/* Blocks of the base line are lent: trace the others, and the bar above them.
 * The first columns of a block belong to a gap that begins in the block before,
 * so the bar of a block needs both. */
static bool
leave_lent_blocks(struct member *m)
{
    struct rad_pixel *rows[RAD_QUINCUNX_MAX_YSTEP + 1];
    uint64_t mine;

    if (!sweep_line(m) || !help_await_base(m))
        return false;
    mine = m->mine[LINE_BASE];
    if (has_bar(m->team, m->i)) {
        member_bar_rows(m, rows);
        if (!sweep_bar(m, rows, mine & (mine << 1 | 1)))
            return false;
    }
    return leave_blocked(m);
}

/* Is the gap of the base line for the member to fill?  Not if it is lent.  Its
 * last pixel may be the first of the next block, which a helper may be at. */
static bool
claim_gap(struct member *m, size_t gap)
{
    int columns = team_block_columns(&m->q), b, next;

    if ((int)gap >= rad_quincunx_ngaps(&m->q, m->i))
        return true;
    b = rad_quincunx_gap_begin(&m->q, m->i, (int)gap) / columns;
    next = rad_quincunx_gap_begin(&m->q, m->i, (int)gap + 1) / columns;
    if (!help_claim(m, LINE_BASE, b))
        return false;
    if (next > b)
        help_claim(m, LINE_BASE, next);
    return true;
}

/* The base line is complete. */
static void
finish_base(struct member *m)
{
    struct team *t = m->team;

    member_publish(t, line_at(t, m->i), t->ndensity + 1);
    if (t->spec.help)
        t->spec.help(t->spec.arg);
}

/* Sample the base line; false: the team is stopped, or blocks are lent. */
static bool
sample_line(struct member *m)
{
    struct team *t = m->team;
    struct line *l = line_at(t, m->i);
    struct rad_quincunx_line s;

    if (!help_claim(m, LINE_BASE, 0))
        return leave_lent_blocks(m);
    rad_quincunx_line_start(&s, &m->q, m->i, density_above(m), l->density,
                            l->sampled);
    do {
        size_t need = densities_needed(m, &s);

        if (s.ndensity > 0 && t->spec.nthreads > 1) /* else nobody waits */
            member_publish(t, l, s.ndensity);
        show_bottom(m, s.x + 1);
        member_tell_rays(m);
        trace_early(m, &s, need);
        if (is_stopped(t) || !member_wait(m, need))
            return false;
        if (!claim_gap(m, s.gap))
            return leave_lent_blocks(m);
    } while (rad_quincunx_line_step(&s));
    show(m, m->q.width);
    team_add(t, &t->base, 1);
    finish_base(m);
    if (is_bottom(m) && t->spec.bottom)
        t->spec.bottom(t->spec.arg);
    return true;
}

/* Fill the bar in order.  Lent blocks are left out, and end TRUTH.  False: the
 * team is stopped, or TRUTH has to wait for lent blocks. */
static bool
fill_blocks(struct member *m, struct rad_pixel *const rows[])
{
    int columns = team_block_columns(&m->q), width = m->q.width;
    struct rad_quincunx_fill s = { 0, 0 };

    while (s.x < width) {
        int b = s.x / columns, end = (b + 1) * columns;

        end = end < width ? end : width;
        if (help_claim(m, LINE_BAR, b)) {
            if (!member_fill(m, rows, &s, end))
                return false;
        } else if (is_stopped(m->team)) {
            return false;
        } else if (m->truth) {
            return sweep_bar(m, rows, UINT64_MAX) && leave_blocked(m);
        } else {
            s = (struct rad_quincunx_fill){ end, 0 };
        }
    }
    return true;
}

/* Paint a bar that is filled; not if its rows were handed on, for then it was
 * painted before, and is filled again only to count its pixels. */
static void
paint_bar(struct member *m, struct rad_pixel *const rows[])
{
    const struct team_spec *spec = &m->team->spec;
    int y = m->q.y0 + rad_quincunx_base_row(&m->q, m->i - 1);
    int n = team_line_rows(&m->q, m->i);

    if (!m->truth || !spec->paint || m->i < spec->truth.out)
        return;
    for (int k = 1; k < n; k++)
        spec->paint(spec->arg, m->ctx, m->q.x0, m->q.x0 + m->q.width, y + k,
                    rows[k]);
}

/* Fill the bar above the base line; result as of fill_blocks(). */
static bool
fill_bar(struct member *m)
{
    struct team *t = m->team;
    struct rad_pixel *rows[RAD_QUINCUNX_MAX_YSTEP + 1];

    if (!member_wait(m, t->ndensity + 1))
        return false;
    member_bar_rows(m, rows);
    if (!fill_blocks(m, rows))
        return false;
    team_add(t, &t->bars, team_line_rows(&m->q, m->i) - 1);
    paint_bar(m, rows);
    return true;
}

/* Blocks of a loan's bar whose base line was traced here, see
 * leave_lent_blocks(). */
static uint64_t
bars_of(const struct member *m, const struct team_loan *loan)
{
    uint64_t mine = m->mine[LINE_BASE];
    int first = loan->x / team_block_columns(&m->q);

    return mine & (mine << 1 | UINT64_C(1) << first);
}

/* Trace the columns that this team borrows; false: the team is stopped. */
static bool
do_loan(struct member *m)
{
    const struct team_loan *loan = m->team->spec.loan;
    struct rad_pixel *rows[RAD_QUINCUNX_MAX_YSTEP + 1];
    struct line *l = line_at(m->team, m->i);
    uint64_t bars = UINT64_MAX;

    if (!loan->base) {
        memcpy(l->sampled + loan->x, loan->bottom,
               (size_t)loan->n * sizeof *l->sampled);
    } else {
        if (!sweep_line(m) || !help_await_base(m))
            return false;
        bars = bars_of(m, loan);
        /* helpers leave the others out, too */
        atomic_fetch_or(&l->taken[LINE_BAR], ~bars);
    }
    finish_base(m);
    member_bar_rows(m, rows);
    return sweep_bar(m, rows, bars);
}

static bool
do_line(struct member *m)
{
    const struct team *t = m->team;

    if (line_at(t, m->i)->known)
        memset(line_at(t, m->i)->known, 0, (size_t)m->q.width * sizeof(bool));
    if (t->spec.loan)
        return do_loan(m);
    return sample_line(m) && (!has_bar(t, m->i) || fill_bar(m));
}

static uint64_t
cpu_ns(void)
{
    struct timespec t;

    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (uint64_t)t.tv_sec * 1000000000 + (uint64_t)t.tv_nsec;
}

/* Add the time since the member left its last line, or block, to this line. */
static void
count_line(const struct member *m, uint64_t *since)
{
    const struct team_spec *spec = &m->team->spec;
    uint64_t now;

    if (!spec->cpu_ns)
        return;
    now = cpu_ns();
    uv_mutex_lock(&m->team->mu);
    spec->cpu_ns[m->i - spec->first] += now - *since;
    uv_mutex_unlock(&m->team->mu);
    *since = now;
}

/* Work on lines until there is none, or the team is stopped or blocked, then on
 * blocks of other members' lines. */
static void
do_lines(struct member *m)
{
    uint64_t since = m->team->spec.cpu_ns ? cpu_ns() : 0;
    int i;

    while ((i = team_line_begin(m->team)) >= 0) {
        uint64_t primary = m->primary;
        bool done;

        member_set_line(m, i);
        done = do_line(m);
        count_line(m, &since);
        if (!done)
            return;
        member_tell_all(m);
        team_line_finish(m->team, m->ctx, m->i, m->primary - primary);
    }
    while (help_with_block(m))
        count_line(m, &since);
}

void
team_work(struct team *t, struct rad_ctx *ctx)
{
    struct member m;

    member_init(&m, t, ctx);
    do_lines(&m);
    member_tell_all(&m);
}
