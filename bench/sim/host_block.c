/* host_block.c - what one block of columns of a line lacks, costs and leaves
 *
 * A pass goes over its lines in blocks of columns as team.c does, and puts what
 * it traced into the facts.  Every second pixel is one that the sampler wants.
 * What is known already takes no time.  So a guess never misleads: the few rays
 * that wrong guesses cost are left out. */
#include "config.h"

#include "host_impl.h"

#include <stdatomic.h>

/* Columns that lie between traced pixels together, and those that do not. */
#define SURE_COLUMNS 8

static bool
is_wanted(int x, int row)
{
    return (x + row) % 2 == 0;
}

/* Where too little is known of the densities above a bar, team.c traces ahead
 * only columns between two traced pixels (TEAM_SURE): here half of them, in
 * groups. */
static bool
is_unsure(const struct host *h)
{
    const struct strict_pass *p = h->pass;
    int known = h->line - p->first + (p->top_density ? p->top_known : 0);

    return h->in_bar && (p->mode == TEAM_AHEAD || p->mode == TEAM_LINES) &&
           !p->true_top && p->first > 0 && known < TEAM_SURE;
}

/* Whether a guess traces column x, of which the truth wants some rows. */
static bool
is_sure(const struct host *h, bool unsure, int x)
{
    const struct team_loan *loan = h->pass->loan;
    int i = loan ? x - loan->x : 0;

    if (loan && h->in_bar)
        return loan->wanted[i / 8] >> i % 8 & 1;
    return !unsure || x / SURE_COLUMNS % 5 < 3;
}

static bool
is_traced(const struct host *h, bool unsure, int x, int row)
{
    return is_wanted(x, row) && is_sure(h, unsure, x);
}

int
host_block_count(const struct host *h)
{
    const struct rad_quincunx *q = &host_map(h)->q;
    int columns = team_block_columns(q);

    return (q->width + columns - 1) / columns;
}

int
host_block_nth(const struct host *h, int k)
{
    int n = host_block_count(h);

    switch (h->pass->end) {
    case TEAM_FROM_LEFT:
        break;
    case TEAM_FROM_RIGHT:
        return n - 1 - k;
    case TEAM_MIDDLE_RIGHTWARDS:
        return (k + n / 2) % n;
    case TEAM_MIDDLE_LEFTWARDS:
        return (n + n / 2 - 1 - k) % n;
    }
    return k;
}

void
host_block_columns(const struct host *h, int *x0, int *x1)
{
    const struct rad_quincunx *q = &host_map(h)->q;
    int columns = team_block_columns(q);

    *x0 = columns * host_block_nth(h, h->block);
    *x1 = *x0 + columns < q->width ? *x0 + columns : q->width;
}

bool
host_block_is_lent(const struct host *h)
{
    uint64_t lent = h->in_bar ? h->lent.bar : h->lent.base;

    return h->line == h->last - 1 && lent >> host_block_nth(h, h->block) & 1;
}

/* Rows of the line that the pass is at, as its facts number them. */
static void
rows_of(const struct host *h, int *r0, int *r1)
{
    int n = team_line_rows(&host_map(h)->q, h->line);

    *r0 = h->in_bar ? 0 : n - 1;
    *r1 = h->in_bar ? n - 1 : n;
}

static struct rad_facts *
facts_of(const struct host *h)
{
    if (!h->pass->facts)
        return NULL;
    return atomic_load_explicit(&h->pass->facts[h->line], memory_order_relaxed);
}

double
host_block_cost(const struct host *h)
{
    const struct rad_facts *facts = facts_of(h);
    const struct map *m = host_map(h);
    int top = team_line_row(&m->q, h->line), x0, x1, r0, r1;
    bool unsure = is_unsure(h);
    double sum = 0;
    struct rad_pixel p;

    host_block_columns(h, &x0, &x1);
    rows_of(h, &r0, &r1);
    for (int r = r0; r < r1; r++) {
        int n = 0, wanted = 0;

        for (int x = x0; x < x1; x++) {
            wanted += is_wanted(x, r);
            n += is_traced(h, unsure, x, r) &&
                 (!facts || !rad_facts_get(facts, x, r, &p));
        }
        if (n > 0)
            sum += map_row(m, h->pass->frame, top + r, x1 - x0) * n / wanted;
    }
    return sum;
}

/* The ends of a base line's gaps, where the sampler looks whether another's
 * facts are all that it needs; they cost nothing more. */
static void
fill_ends(struct host *h, struct rad_facts *facts, int x0, int x1)
{
    const struct rad_quincunx *q = &host_map(h)->q;
    int row = rad_facts_rows(facts) - 1, n = rad_quincunx_ngaps(q, h->line);
    static const struct rad_pixel black;
    struct rad_pixel p;

    for (int g = 0; g <= n; g++) {
        int x = rad_quincunx_gap_begin(q, h->line, g);

        if (x >= x0 && x < x1 && !rad_facts_use(facts, x, row, &p))
            rad_facts_put(facts, x, row, &black, RAD_FACT_USED);
    }
}

void
host_block_fill(struct host *h)
{
    bool truth = h->pass->mode == TEAM_TRUTH, unsure = is_unsure(h);
    struct rad_facts *facts = facts_of(h);
    static const struct rad_pixel black;
    int x0, x1, r0, r1;
    struct rad_pixel p;

    host_block_columns(h, &x0, &x1);
    rows_of(h, &r0, &r1);
    for (int r = r0; r < r1; r++)
        for (int x = x0; x < x1; x++) {
            if (!is_traced(h, unsure, x, r))
                continue;
            if (!facts) {
                h->traced++;
            } else if (truth ? rad_facts_use(facts, x, r, &p)
                             : rad_facts_get(facts, x, r, &p)) {
                continue;
            } else {
                h->traced++;
                rad_facts_put(facts, x, r, &black, truth ? RAD_FACT_USED : 0);
            }
        }
    if (facts && !h->in_bar)
        fill_ends(h, facts, x0, x1);
}

/* Is anything known of that column of the bar? */
static bool
knows(const struct host *h, int x)
{
    int rows = team_line_rows(&host_map(h)->q, h->line) - 1;
    struct rad_pixel p;

    for (int r = 0; r < rows; r++)
        if (rad_facts_get(facts_of(h), x, r, &p))
            return true;
    return false;
}

bool
host_block_keeps(const struct host *h)
{
    return facts_of(h) != NULL;
}

bool
host_block_lacks(const struct host *h, int x)
{
    return is_sure(h, is_unsure(h), x) && !knows(h, x);
}

uint64_t
host_block_unknown(const struct host *h, uint64_t blocks)
{
    const struct rad_quincunx *q = &host_map(h)->q;
    int columns = team_block_columns(q), last = team_line_rows(q, h->line) - 1;
    struct rad_pixel p;

    for (int x = 0; x < q->width; x++) {
        uint64_t bit = UINT64_C(1) << x / columns;

        if (!h->in_bar && is_wanted(x, last) &&
            rad_facts_get(facts_of(h), x, last, &p))
            blocks &= ~bit;
    }
    for (int b = 0; b * columns < q->width; b++) {
        bool lacks = false;

        for (int x = b * columns; x < (b + 1) * columns && x < q->width; x++)
            lacks |= host_block_lacks(h, x);
        if (!lacks)
            blocks &= ~(UINT64_C(1) << b);
    }
    return blocks;
}
