/* team_member.c - what a member of a team does with one line
 *
 * It samples the base line close behind the member on the line above, then
 * fills the bar between the two; see team_impl.h for what it waits for. */
#include "config.h"

#include "team/team_impl.h"

#include <string.h>
#include <time.h>

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

/* A pixel that may be wanted one day.  Where another worker was first just now
 * that one counts, as it will for the truth. */
static void
trace_ahead(struct member *m, struct rad_facts *f, int x, int y,
            struct rad_pixel *out)
{
    int column = x - m->q.x0, row = y - m->q.y0 - m->row0;

    if (!rad_facts_get(f, column, row, out) && trace_new(m, x, y, out) &&
        !rad_facts_put(f, column, row, out, 0))
        rad_facts_get(f, column, row, out);
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
void
member_tell_rays(struct member *m)
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
bool
member_wait(const struct member *m, size_t need)
{
    struct team *t = m->team;

    return m->i == t->spec.first || need == 0 ||
           wait_for(t, line_at(t, m->i - 1), need);
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
bool
member_bar_is_certain(const struct team *t, int i,
                      struct rad_pixel *const rows[], int x)
{
    int n = team_line_rows(&t->spec.sampler, i);

    return was_traced(t, i, x, &rows[n][x]) &&
           was_traced(t, i - 1, x, &rows[0][x]);
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
        if (loan ? is_wanted(loan, x)
                 : member_bar_is_certain(m->team, m->i, rows, x)) {
            if (s->x < x)
                *s = (struct rad_quincunx_fill){ x, 0 };
            rad_quincunx_bar_to(&m->q, m->i - 1, rows, s, x + 1);
        }
    s->x = end;
    s->found = 0;
}

/* The same, any number; false: stopped. */
bool
member_fill(struct member *m, struct rad_pixel *const rows[],
            struct rad_quincunx_fill *s, int end)
{
    while (s->x < end) {
        int left = end - s->x;

        fill_some(m, rows, s, s->x + (left < BAR_COLUMNS ? left : BAR_COLUMNS));
        member_tell_rays(m);
        if (is_stopped(m->team))
            return false;
    }
    return true;
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
        member_tell_rays(m);
    }
    m->early = false;
}

/* The rows of line i, and of the base line above, as the bar wants them. */
void
member_bar_rows(const struct member *m, struct rad_pixel *rows[])
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
        member_bar_rows(m, rows);
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
    return sweep_claim(m, PART_BASE, x / team_block_columns(&m->q));
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
    if (!sweep_claim(m, PART_BASE, 0))
        return leave_line(m);
    rad_quincunx_line_start(&s, &m->q, m->i, density_above(m), l->density,
                            l->sampled);
    do {
        size_t need = needed(m, &s);

        if (s.ndensity > 0 && t->spec.nthreads > 1) /* else nobody waits */
            publish(t, l, s.ndensity);
        show_bottom(m, s.x + 1);
        member_tell_rays(m);
        trace_early(m, &s, need);
        if (is_stopped(t) || !member_wait(m, need))
            return false;
        if (!claim_gap(m, s.gap))
            return leave_line(m);
    } while (rad_quincunx_line_step(&s));
    show(m, m->q.width);
    team_add(t, &t->base, 1);
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
        if (sweep_claim(m, PART_BAR, b)) {
            if (!member_fill(m, rows, &s, end))
                return false;
        } else if (m->truth) {
            return sweep_bar(m, rows, UINT64_MAX) && leave_blocked(m);
        } else {
            s = (struct rad_quincunx_fill){ end, 0 };
        }
    }
    return true;
}

/* Paint a bar that is full.  One whose rows are out has been: it is filled
 * again to count its pixels, and nobody reads what it looks like. */
static void
paint_bar(struct member *m, struct rad_pixel *const rows[])
{
    const struct team_spec *spec = &m->team->spec;
    int y = m->q.y0 + rad_quincunx_base_row(&m->q, m->i - 1);
    int n = team_line_rows(&m->q, m->i);

    if (!m->truth || !spec->paint || m->i < spec->out)
        return;
    for (int k = 1; k < n; k++)
        spec->paint(spec->arg, m->ctx, m->q.x0, m->q.x0 + m->q.width, y + k,
                    rows[k]);
}

/* Fill the bar above base line i; false: stopped, or blocked. */
static bool
fill_bar(struct member *m)
{
    struct team *t = m->team;
    struct rad_pixel *rows[RAD_QUINCUNX_MAX_YSTEP + 1];

    if (!member_wait(m, t->ndensity + 1))
        return false;
    member_bar_rows(m, rows);
    if (wants_sweep(m) && !sweep_bar(m, rows, UINT64_MAX))
        return false;
    if (!fill_blocks(m, rows))
        return false;
    team_add(t, &t->bars, team_line_rows(&m->q, m->i) - 1);
    paint_bar(m, rows);
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
    member_bar_rows(m, rows);
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
bool
member_is_unsure(const struct member *m)
{
    const struct team *t = m->team;

    return (t->spec.mode == TEAM_AHEAD || t->spec.mode == TEAM_LINES) &&
           !t->spec.true_top && t->ndensity > 0 && t->spec.first > 0 &&
           known_above(t, m->i) < TEAM_SURE;
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
    m->unsure = member_is_unsure(m);
    m->facts = t->spec.facts ? &t->spec.facts[m->i] : NULL;
    m->mine[PART_BASE] = m->mine[PART_BAR] = 0;
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

/* The member leaves its line: note what that cost since the last one. */
static void
count_line(const struct member *m, uint64_t *since)
{
    const struct team_spec *spec = &m->team->spec;
    uint64_t now;

    if (!spec->cpu_ns)
        return;
    now = cpu_ns();
    spec->cpu_ns[m->i - spec->first] += now - *since;
    *since = now;
}

/* Work on lines until there is none. */
static void
do_lines(struct member *m)
{
    uint64_t since = m->team->spec.cpu_ns ? cpu_ns() : 0;

    while ((m->i = team_line_begin(m->team)) >= 0) {
        uint64_t primary = m->primary;
        bool done = do_line(m);

        count_line(m, &since);
        if (!done)
            return;
        tell_rays(m);
        team_line_finish(m->team, m->i, m->primary - primary);
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
}
