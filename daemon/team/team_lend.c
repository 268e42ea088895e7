/* team_lend.c - columns of a team's last line that another team traces
 *
 * A loan is a run of blocks that no thread has begun, the rightmost ones, of a
 * given part of the cost that is left.  The borrower gets it as a message, with
 * the colours and densities that decide which pixels are traced.  No block is
 * lent twice, so a line's work comes to an end. */
#include "config.h"

#include "team/team_member.h"

#include "base/bits.h"

#include <string.h>

/* Cost of a pixel of a base line over that of a bar. */
#define BASE_WEIGHT 1.5

/* Most columns of a loan, which must fit a message. */
#define MOST_LENT 24000

/* The longest run of set bits. */
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

/* Is line i's base line done? */
static bool
base_is_done(struct team *t, int i)
{
    return atomic_load(&line_at(t, i)->ready) == t->ndensity + 1;
}

/* May parts of line i's base line be lent, which is not done?  Its densities
 * above must be known, and the member must claim blocks before their gaps. */
static bool
base_can_be_lent(const struct team *t, int i)
{
    if (t->spec.mode == TEAM_AHEAD)
        return false;
    return i == t->spec.first || t->spec.nthreads == 1;
}

/* Are there facts in columns [x, x + n) of rows [row, row + rows) of line i?  A
 * borrower would trace these pixels again. */
static bool
has_facts(const struct team *t, int i, int x, int n, int row, int rows)
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

/* The line that columns are lent of. */
struct lending {
    struct team *t;
    int i, bars; /* its number, and how many rows its bar has */
    bool base;   /* its base line is to be traced, too */
    bool unsure; /* member_is_unsure() of its member */
    struct rad_pixel *rows[RAD_QUINCUNX_MAX_YSTEP + 1]; /* member_bar_rows() */
};

/* Has column x of the bar a pixel to trace? */
static bool
wants_column(const struct lending *l, int x)
{
    const struct team_loan *loan = l->t->spec.loan;

    if (loan ? !is_wanted(loan, x)
             : l->unsure && !member_bar_is_certain(l->t, l->i, l->rows, x))
        return false;
    return !has_facts(l->t, l->i, x, 1, 0, l->bars);
}

/* Cost of what is left of block b, as a part of the line's; 0: not worth
 * lending.
 */
static double
block_cost(const struct lending *l, int b)
{
    const struct rad_quincunx *q = &l->t->spec.sampler;
    int columns = team_block_columns(q), x = b * columns, n = 0;
    int end = x + columns < q->width ? x + columns : q->width;
    double all = (BASE_WEIGHT + l->bars) * q->width;

    if (l->base && has_facts(l->t, l->i, x, end - x, l->bars, 1))
        return 0;
    for (int k = x; k < end; k++)
        n += wants_column(l, k);
    if (n == 0)
        return 0;
    return (n * l->bars + (l->base ? BASE_WEIGHT * (end - x) : 0)) / all;
}

/* Claim blocks for a loan.  A member may have been quicker at some: of the
 * others keep the longest run, and give the rest back. */
static uint64_t
take_blocks(struct line *l, enum line_part part, uint64_t blocks)
{
    uint64_t got = blocks & ~atomic_fetch_or(&l->taken[part], blocks);
    uint64_t run = longest_run(got);

    atomic_fetch_and(&l->taken[part], ~(got & ~run));
    return run;
}

/* The right end of a run of blocks: about of the cost `most`, at most n blocks;
 * none if the rightmost block costs more than twice `most`. */
static uint64_t
right_part(uint64_t run, const double cost[MOST_BLOCKS], double most, int n)
{
    uint64_t got = 0;
    double sum = 0;

    for (int b = MOST_BLOCKS - 1; b >= 0 && rad_count_bits(got) < n; b--) {
        if (!(run >> b & 1))
            continue;
        sum += cost[b];
        if (sum - cost[b] / 2 > most)
            break;
        got |= UINT64_C(1) << b;
    }
    return got;
}

/* Claim blocks of a part of the cost that is left, for a loan; 0: none. */
static uint64_t
lend_blocks(const struct lending *by, double part, struct team_loan *loan)
{
    struct team *t = by->t;
    struct line *l = line_at(t, by->i);
    const struct rad_quincunx *q = &t->spec.sampler;
    uint64_t free = team_blocks_of(q, 0, q->width), got;
    double cost[MOST_BLOCKS], left = 0;

    free &= ~atomic_load(&l->taken[LINE_BAR]) & ~t->lent.ever;
    if (by->base)
        free &= ~atomic_load(&l->taken[LINE_BASE]);
    for (int b = 0; b < MOST_BLOCKS; b++) {
        cost[b] = free >> b & 1 ? block_cost(by, b) : 0;
        left += cost[b];
        if (cost[b] == 0)
            free &= ~(UINT64_C(1) << b);
    }
    got = right_part(longest_run(free), cost, part * left,
                     MOST_LENT / team_block_columns(q));
    if (by->base)
        got = take_blocks(l, LINE_BASE, got);
    got = take_blocks(l, LINE_BAR, got);
    loan->given = 0;
    for (int b = 0; b < MOST_BLOCKS; b++)
        loan->given += got >> b & 1 ? cost[b] : 0;
    loan->left = left - loan->given;
    t->lent.ever |= got;
    return got;
}

/* The first column of a loan, counted from its own first, whose base line the
 * borrower will have: columns before it belong to a gap that begins further
 * left, which may be all columns of the line's last block. */
static int
first_known(const struct rad_quincunx *q, const struct team_loan *loan)
{
    int ngaps = rad_quincunx_ngaps(q, loan->line);

    if (!loan->base || loan->x == 0)
        return 0;
    for (int g = 0; g < ngaps; g++) {
        int x = rad_quincunx_gap_begin(q, loan->line, g);

        if (x >= loan->x)
            return x - loan->x;
    }
    return loan->n;
}

/* Set loan->wanted: the columns of the bar that the lender would fill. */
static void
want_columns(const struct lending *by, struct team_loan *loan)
{
    memset(loan->wanted, 0, (size_t)(loan->n + 7) / 8);
    for (int i = first_known(&by->t->spec.sampler, loan); i < loan->n; i++)
        if (wants_column(by, loan->x + i))
            loan->wanted[i / 8] |= (uint8_t)(1u << i % 8);
}

/* The line of which columns may be lent; -1: none. */
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

/* Set *by to the line that can be lent of; false: there is none now. */
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
    by->unsure = member_is_unsure(&m);
    member_bar_rows(&m, by->rows);
    return by->bars > 0 && (!by->base || base_can_be_lent(t, by->i));
}

/* Fill in the loan of these claimed blocks. */
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
    loan->n = rad_count_bits(blocks) * columns;
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
        for (int k = 0; k < LINE_PARTS; k++)
            atomic_fetch_and(&line_at(t, i)->taken[k], ~blocks);
    uv_mutex_unlock(&t->mu);
}

bool
team_blocked(const struct team *t, int *finished)
{
    *finished = t->finished;
    return t->blocked;
}
