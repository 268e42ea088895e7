/* team_member.c - how a member of a team traces pixels, waits for the line
 * above, and wakes the member below */
#include "config.h"

#include "team/team_member.h"

#include <string.h>

/* How often a member looks for the densities before it sleeps. */
#define SPINS 200

/* A member adds its rays to the team's when so many are new.  That is some ms
 * of work, so members do not contend for the counter's cache line. */
#define RAYS_UNTOLD 4096

/* Pixels between two looks at the number of rays. */
#define PIXELS_UNSEEN 16

/* Columns of a bar between two looks at whether the team is stopped. */
#define BAR_COLUMNS 4

static bool
trace_new(struct member *m, int x, int y, struct rad_pixel *out)
{
    const struct team_spec *spec = &m->team->spec;

    if (!spec->trace(spec->arg, m->ctx, x, y, out))
        return false;
    m->traced++;
    return true;
}

/* A pixel that the true sampler wants: use the fact, or trace it. */
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
    /* if another worker's fact came meanwhile, use that */
    if (!rad_facts_put(f, column, row, out, RAD_FACT_USED))
        rad_facts_use(f, column, row, out);
}

/* Trace a pixel that TRUTH may want, into facts.  If another worker's fact came
 * meanwhile it counts, as it will in TRUTH. */
static void
trace_ahead(struct member *m, struct rad_facts *f, int x, int y,
            struct rad_pixel *out)
{
    int column = x - m->q.x0, row = y - m->q.y0 - m->row0;

    if (!rad_facts_get(f, column, row, out) && trace_new(m, x, y, out) &&
        !rad_facts_put(f, column, row, out, 0))
        rad_facts_get(f, column, row, out);
}

/* Get a pixel that the member traced before it slept, or a helper before there
 * were facts (which may come at any time); false: none did. */
static bool
recall(const struct member *m, int x, int y, struct rad_pixel *out)
{
    const struct line *l = line_at(m->team, m->i);
    const struct rad_facts *own =
        atomic_load_explicit(&l->own, memory_order_acquire);

    if (own && rad_facts_get(own, x - m->q.x0, y - m->q.y0 - m->row0, out))
        return true;
    if (m->helps || !l->known || y != m->row || !l->known[x - m->q.x0])
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
    struct rad_facts *f = team_facts(m->team, m->i);

    if (recall(m, x, y, out)) {
        m->primary += !m->early;
    } else if (m->helps) {
        trace_ahead(m, f ? f : line_at(m->team, m->i)->own, x, y, out);
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

/* Stores ready, then loads wanted; wait_for() stores wanted, then loads ready.
 * All are sequentially consistent, so no wake-up is missed. */
void
member_publish(struct team *t, struct line *l, size_t ready)
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

/* Wait until `need` densities of line l are final; false: the team is stopped.
 */
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

void
member_tell_all(struct member *m)
{
    uint64_t n = count_rays(m) - m->told;

    m->told += n;
    atomic_fetch_add_explicit(&m->team->rays, n, memory_order_relaxed);
}

void
member_tell_rays(struct member *m)
{
    if (m->traced - m->looked < PIXELS_UNSEEN)
        return;
    m->looked = m->traced;
    if (count_rays(m) - m->told >= RAYS_UNTOLD)
        member_tell_all(m);
}

/* The first line's top is there from the start, so it need not wait. */
bool
member_wait(const struct member *m, size_t need)
{
    struct team *t = m->team;

    return m->i == t->spec.first || need == 0 ||
           wait_for(t, line_at(t, m->i - 1), need);
}

/* Was this pixel of base line i traced in this pass?  That there is a fact is
 * not enough: it may be of an estimate, or of another worker's better guess. */
static bool
was_traced(const struct team *t, int i, int x, const struct rad_pixel *here)
{
    const struct rad_facts *f =
        atomic_load_explicit(&t->spec.facts[i], memory_order_acquire);
    struct rad_pixel p;

    return f && rad_facts_get(f, x, rad_facts_rows(f) - 1, &p) &&
           memcmp(&p, here, sizeof p) == 0;
}

/* A column between two pixels that were traced themselves is certain: TRUTH has
 * the same colours there, and no less density.  Where the sampler traced none
 * in a gap, that may be for lack of densities. */
bool
member_bar_is_certain(const struct team *t, int i,
                      struct rad_pixel *const rows[], int x)
{
    int n = team_line_rows(&t->spec.sampler, i);

    return was_traced(t, i, x, &rows[n][x]) &&
           was_traced(t, i - 1, x, &rows[0][x]);
}

/* Fill columns up to `end` of the bar, without a look at whether the team is
 * stopped. */
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

void
member_bar_rows(const struct member *m, struct rad_pixel *rows[])
{
    int top = rad_quincunx_base_row(&m->q, m->i - 1);
    int n = team_line_rows(&m->q, m->i);

    for (int k = 0; k < n; k++)
        rows[k] = row_at(m->team, top + k);
    rows[n] = line_at(m->team, m->i)->sampled;
}

/* How many lines the densities above line i follow from, as far as is known. */
static int
known_above(const struct team *t, int i)
{
    return i - t->spec.first +
           (t->spec.top_density ? t->spec.ahead.top_known : 0);
}

bool
member_is_unsure(const struct member *m)
{
    const struct team *t = m->team;

    return (t->spec.mode == TEAM_AHEAD || t->spec.mode == TEAM_LINES) &&
           !t->spec.ahead.true_top && t->ndensity > 0 && t->spec.first > 0 &&
           known_above(t, m->i) < TEAM_SURE;
}

void
member_set_line(struct member *m, int i)
{
    m->i = i;
    m->row0 = team_line_row(&m->q, i);
    m->row = m->q.y0 + rad_quincunx_base_row(&m->q, i);
    m->ahead = rad_quincunx_ngaps(&m->q, i);
    m->unsure = member_is_unsure(m);
    m->mine[LINE_BASE] = m->mine[LINE_BAR] = m->begun_early = 0;
}

void
member_init(struct member *m, struct team *t, struct rad_ctx *ctx)
{
    *m = (struct member){ .team = t, .ctx = ctx, .q = t->spec.sampler };
    m->truth = t->spec.mode == TEAM_TRUTH;
    m->told = count_rays(m);
    m->q.trace = trace;
    m->q.arg = m;
}
