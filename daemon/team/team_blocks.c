/* team_blocks.c - the rows of a line, and its blocks of columns */
#include "config.h"

#include "team/team_impl.h"

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
