/* team_sweep.c - a line is traced ahead, block by block of its columns
 *
 * The member that claims a block traces all gaps that begin in it.  Blocks are
 * taken from the left: helpers and borrowers take them from the right. */
#include "config.h"

#include "team/team_member.h"

bool
sweep_claim(struct member *m, enum line_part part, int b)
{
    uint64_t bit = UINT64_C(1) << b;

    if (!(m->mine[part] & bit) &&
        atomic_fetch_or(&line_at(m->team, m->i)->taken[part], bit) & bit)
        return false;
    m->mine[part] |= bit;
    return true;
}

/* Trace block b of the member's base line into line[]; or, as a helper (NULL),
 * into facts alone, but for a gap that ends in the next block: the pixel that
 * both share is for whoever has that block. */
void
sweep_base_block(struct member *m, int b, struct rad_pixel *line)
{
    struct rad_pixel own[RAD_QUINCUNX_MAX_XSTEP + 1];
    const struct rad_quincunx *q = &m->q;
    struct team *t = m->team;
    int columns = team_block_columns(q), end = (b + 1) * columns;
    int ngaps = rad_quincunx_ngaps(q, m->i);
    bool truth = m->truth;

    m->truth = false;
    for (int g = b * columns / q->xstep; g < ngaps; g++) {
        int x = rad_quincunx_gap_begin(q, m->i, g);
        int next = rad_quincunx_gap_begin(q, m->i, g + 1);

        if (x >= end || (!line && next >= end && g + 1 < ngaps) ||
            is_stopped(t))
            break;
        if (x >= b * columns)
            rad_quincunx_gap(q, m->i, g, density_above(m),
                             line ? line + x : own);
        member_tell_rays(m);
    }
    m->truth = truth;
}

void
sweep_bar_block(struct member *m, struct rad_pixel *const rows[], int b)
{
    int columns = team_block_columns(&m->q), end = (b + 1) * columns;
    struct rad_quincunx_fill fill = { b * columns, 0 };
    bool truth = m->truth;

    m->truth = false;
    member_fill(m, rows, &fill, end < m->q.width ? end : m->q.width);
    m->truth = truth;
}

/* Claim the next block at or behind *b that the member has not claimed yet;
 * false: none is left, or the team is stopped. */
static bool
next_block(struct member *m, enum line_part part, uint64_t done, int *b)
{
    int columns = team_block_columns(&m->q);

    for (; *b * columns < m->q.width && !is_stopped(m->team); ++*b)
        if (!(done >> *b & 1) && sweep_claim(m, part, *b))
            return true;
    return false;
}

bool
sweep_line(struct member *m)
{
    uint64_t done = m->mine[LINE_BASE];

    if (!member_wait(m, m->team->ndensity))
        return false;
    for (int b = 0; next_block(m, LINE_BASE, done, &b); b++)
        sweep_base_block(m, b, line_at(m->team, m->i)->sampled);
    return !is_stopped(m->team);
}

bool
sweep_bar(struct member *m, struct rad_pixel *const rows[], uint64_t blocks)
{
    uint64_t done = m->mine[LINE_BAR] | ~blocks;

    if (team_line_rows(&m->q, m->i) == 1)
        return true;
    for (int b = 0; next_block(m, LINE_BAR, done, &b); b++)
        sweep_bar_block(m, rows, b);
    return !is_stopped(m->team);
}
