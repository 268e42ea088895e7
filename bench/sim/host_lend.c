/* host_lend.c - columns of a pass's last line for another, as team_lend() has
 * it
 */
#include "config.h"

#include "host_impl.h"

#include "base/bits.h"

#include <string.h>

/* The bits of those that follow in the order of the pass. */
static uint64_t
not_begun(const struct host *h, int from)
{
    uint64_t bits = 0;

    for (int k = from; k < host_block_count(h); k++)
        bits |= UINT64_C(1) << host_block_nth(h, k);
    return bits;
}

void
host_lend(struct host *h)
{
    struct strict_pass *p = h->pass;
    const struct rad_quincunx *q = &host_map(h)->q;
    int columns = team_block_columns(q), n = 0, end = host_block_count(h);
    int rows = team_line_rows(q, h->line) - 1, bars;
    double base = 1.5 / (1.5 + rows), bar = rows / (1.5 + rows), left;
    uint64_t lines = h->in_bar ? 0 : not_begun(h, h->block + 1);
    uint64_t free = h->in_bar ? not_begun(h, h->block + 1) : UINT64_MAX;
    uint8_t wanted[8192];
    struct team_loan loan = { .line = h->line, .wanted = wanted };

    if (h->line != h->last - 1 || !host_pass_has_bar(h) ||
        !host_block_keeps(h) || (!h->in_bar && p->mode == TEAM_AHEAD))
        return;
    free &= team_blocks_of(q, 0, q->width) & ~h->lent.bar & ~h->lent.ever;
    lines &= ~h->lent.base & ~h->lent.ever;
    free = host_block_unknown(h, free);
    bars = rad_count_bits(free);
    left = base * rad_count_bits(lines) + bar * bars;
    if (!h->in_bar)
        free &= lines;
    loan.base = !h->in_bar;
    loan.given = loan.base ? base + bar : bar;
    while (end > 0 && !(free >> (end - 1) & 1))
        end--;
    while (n < end && free >> (end - 1 - n) & 1 &&
           (n + 1) * loan.given <= p->lend * left + .5 * loan.given)
        n++;
    if (n == 0)
        return;
    loan.x = (end - n) * columns;
    loan.n = (end * columns < q->width ? end * columns : q->width) - loan.x;
    loan.given *= (double)n / host_block_count(h);
    loan.left = left / host_block_count(h) - loan.given;
    loan.top = h->pixels;
    loan.density = loan.base ? h->density : NULL;
    loan.bottom = loan.base ? NULL : h->pixels;
    memset(wanted, 0, sizeof wanted);
    for (int i = 0; i < loan.n; i++)
        if (host_block_lacks(h, loan.x + i))
            wanted[i / 8] |= (uint8_t)(1u << i % 8);
    h->lent.bar |= team_blocks_of(q, loan.x, loan.n);
    if (loan.base)
        h->lent.base |= team_blocks_of(q, loan.x, loan.n);
    h->lent.ever |= team_blocks_of(q, loan.x, loan.n);
    strict_lent(h->strict, p, &loan);
}
