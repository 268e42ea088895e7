/* team_sweep.c - a line is traced ahead, block by block of its columns
 *
 * The member that claims a block traces all gaps that begin in it.  Blocks are
 * taken from the end that spec.end names; where another worker's facts are met,
 * from the middle of the widest gap left, so that workers at the same line meet
 * late and seldom. */
#include "config.h"

#include "team/team_member.h"

/* The blocks of a member's base line or bar that are traced ahead. */
struct sweep {
    struct member *m;
    enum line_part part;
    int row, rows; /* the rows of the line that the blocks lie in */
    int nblocks;   /* at most MOST_BLOCKS */
    int columns;   /* of a block, but the last */
    uint64_t done; /* blocks that were begun, or need no work */
    int at, step;  /* the next block, and the way from there */
};

/* Begin at the end that spec.end names. */
static void
start_sweep(struct sweep *s, struct member *m, enum line_part part)
{
    int n = team_line_rows(&m->q, m->i), columns = team_block_columns(&m->q);
    enum team_end end = m->team->spec.end;
    bool middle = end >= TEAM_MIDDLE_RIGHTWARDS;

    s->m = m;
    s->part = part;
    s->row = part == LINE_BASE ? n - 1 : 0;
    s->rows = part == LINE_BASE ? 1 : n - 1;
    s->columns = columns;
    s->nblocks = (m->q.width + columns - 1) / columns;
    s->done = m->mine[part];
    s->step = end == TEAM_FROM_RIGHT || end == TEAM_MIDDLE_LEFTWARDS ? -1 : 1;
    s->at = s->step > 0 ? 0 : s->nblocks - 1;
    if (middle)
        s->at = s->nblocks / 2 - (s->step < 0 && s->nblocks > 1);
}

/* Was block b begun, by this member or another worker? */
static bool
is_taken(struct sweep *s, int b)
{
    int x = b * s->columns, left = s->m->q.width - x;
    const struct rad_facts *f = team_facts(s->m->team, s->m->i);

    return s->done >> b & 1 ||
           rad_facts_met(f, s->row, s->rows, x,
                         left < s->columns ? left : s->columns);
}

/* The middle of the longest run of blocks that are not taken; -1: all are. */
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

/* Claim the next block; -1: none is left, or the team is stopped. */
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
        if (sweep_claim(s->m, s->part, b))
            return b;
    }
    return -1;
}

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

bool
sweep_line(struct member *m)
{
    struct sweep s;
    int b;

    if (!member_wait(m, m->team->ndensity))
        return false;
    start_sweep(&s, m, LINE_BASE);
    while ((b = next_block(&s)) >= 0)
        sweep_base_block(m, b, line_at(m->team, m->i)->sampled);
    return !is_stopped(m->team);
}

bool
sweep_bar(struct member *m, struct rad_pixel *const rows[], uint64_t blocks)
{
    struct sweep s;
    int b;

    if (team_line_rows(&m->q, m->i) == 1)
        return true;
    start_sweep(&s, m, LINE_BAR);
    s.done |= ~blocks;
    while ((b = next_block(&s)) >= 0)
        sweep_bar_block(m, rows, b);
    return !is_stopped(m->team);
}
