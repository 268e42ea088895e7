/* team_help.c - blocks of lines that other members are at
 *
 * A member that has no line to begin helps others with theirs: it traces blocks
 * of a base line or bar into facts, from the right, as in team_sweep.c.  The
 * member whose line it is fills it from the left, as ever, and comes to find
 * these pixels known.  So the pixels traced are the same, for what a block is
 * traced by is as final as for that member:
 *   - a base line by the densities above it, all of which are there;
 *   - a bar by the two base lines.  What the column left of a block would add
 *     is left to the line's member.
 * No pixel is traced twice.  Where spec.facts has none of a line helpers put
 * what they trace into facts of its own. */
#include "config.h"

#include "team/team_member.h"

#include "base/bits.h"

/* Base lines are helped with if a block has so many gaps, the last of which is
 * left to the line's member. */
#define LEAST_GAPS 3

/* A block for a helper. */
struct help {
    int i; /* the line */
    enum line_part part;
    int b;
};

/* How many densities of line i are final. */
static size_t
ready_of(const struct team *t, int i)
{
    return atomic_load(&line_at(t, i)->ready);
}

/* Which part of line i, which is begun and not done, can be helped with?  For
 * the bar the line above is not only to be known but in its row, too. */
static bool
part_of(const struct team *t, int i, enum line_part *part)
{
    size_t above = i > t->spec.first ? ready_of(t, i - 1) : t->ndensity + 1;

    if (ready_of(t, i) > t->ndensity) {
        *part = LINE_BAR;
        return above > t->ndensity && has_bar(t, i);
    }
    *part = LINE_BASE;
    return above >= t->ndensity && team_block_columns(&t->spec.sampler) >=
                                       LEAST_GAPS * t->spec.sampler.xstep;
}

/* The end of the columns whose blocks the line's member will claim: in the last
 * block of a base line no gap may begin. */
static int
end_of(const struct rad_quincunx *q, int i, enum line_part part)
{
    int ngaps = rad_quincunx_ngaps(q, i), columns = team_block_columns(q), end;

    if (part == LINE_BAR)
        return team_line_rows(q, i) > 1 ? q->width : 0;
    if (ngaps == 0)
        return 0;
    end = rad_quincunx_gap_begin(q, i, ngaps - 1) / columns * columns + columns;
    return end < q->width ? end : q->width;
}

/* Blocks that nobody has begun. */
static uint64_t
free_blocks(const struct team *t, int i, enum line_part part)
{
    const struct rad_quincunx *q = &t->spec.sampler;

    return team_blocks_of(q, 0, end_of(q, i, part)) &
           ~atomic_load(&line_at(t, i)->taken[part]);
}

/* Find the line with the most blocks left, the base line of which other lines
 * wait for first; false: no line has any. */
static bool
find_locked(const struct team *t, struct help *h, uint64_t *blocks)
{
    int most = 1; /* a line's member can do the last block by itself */

    if (is_stopped(t) || t->helpless)
        return false;
    for (int i = t->finished; i < t->begun; i++) {
        enum line_part part;
        uint64_t free;

        if (line_at(t, i)->done || !part_of(t, i, &part))
            continue;
        free = free_blocks(t, i, part);
        if (rad_count_bits(free) <= most)
            continue;
        most = rad_count_bits(free);
        *h = (struct help){ .i = i, .part = part };
        *blocks = free;
        if (part == LINE_BASE)
            break;
    }
    return most > 1;
}

static bool
make_facts_locked(struct team *t, int i)
{
    struct line *l = line_at(t, i);

    if (team_facts(t, i) || l->own)
        return true;
    atomic_store_explicit(&l->own,
                          rad_facts_new(t->spec.sampler.width,
                                        team_line_rows(&t->spec.sampler, i)),
                          memory_order_release);
    t->helpless = !l->own; /* else helpers would ask and fail until the end */
    return l->own;
}

/* Take the rightmost of these blocks; false: its member was quicker, or memory
 * is out. */
static bool
take_locked(struct team *t, struct help *h, uint64_t blocks)
{
    struct line *l = line_at(t, h->i);
    uint64_t bit;

    if (!make_facts_locked(t, h->i))
        return false;
    h->b = MOST_BLOCKS - 1;
    while (!(blocks >> h->b & 1))
        h->b--;
    bit = UINT64_C(1) << h->b;
    if (atomic_fetch_or(&l->taken[h->part], bit) & bit)
        return false;
    l->helped[h->part] |= bit;
    return true;
}

static bool
take(struct team *t, struct help *h)
{
    uint64_t blocks;
    bool found;

    uv_mutex_lock(&t->mu);
    found = find_locked(t, h, &blocks) && take_locked(t, h, blocks);
    uv_mutex_unlock(&t->mu);
    return found;
}

bool
team_helps(struct team *t)
{
    struct help h;
    uint64_t blocks;
    bool found;

    uv_mutex_lock(&t->mu);
    found = find_locked(t, &h, &blocks);
    uv_mutex_unlock(&t->mu);
    return found;
}

bool
help_with_block(struct member *m)
{
    struct rad_pixel *rows[RAD_QUINCUNX_MAX_YSTEP + 1];
    struct team *t = m->team;
    struct help h;

    if (!take(t, &h))
        return false;
    member_set_line(m, h.i);
    m->helps = true;
    if (h.part == LINE_BASE) {
        sweep_base_block(m, h.b, NULL);
    } else {
        member_bar_rows(m, rows);
        sweep_bar_block(m, rows, h.b);
    }
    uv_mutex_lock(&t->mu);
    line_at(t, h.i)->helped_done[h.part] |= UINT64_C(1) << h.b;
    uv_cond_broadcast(&t->moved);
    uv_mutex_unlock(&t->mu);
    return true;
}

/* Wait until helpers have done those of these blocks that they took. */
static void
await_locked(struct member *m, enum line_part part, uint64_t blocks)
{
    struct team *t = m->team;
    struct line *l = line_at(t, m->i);

    while (l->helped[part] & ~l->helped_done[part] & blocks && !is_stopped(t))
        uv_cond_wait(&t->moved, &t->mu);
    m->mine[part] |= l->helped_done[part] & blocks;
}

bool
help_claim(struct member *m, enum line_part part, int b)
{
    uint64_t bit = UINT64_C(1) << b;

    if (sweep_claim(m, part, b))
        return true;
    uv_mutex_lock(&m->team->mu);
    await_locked(m, part, bit);
    uv_mutex_unlock(&m->team->mu);
    return m->mine[part] & bit && !is_stopped(m->team);
}

bool
help_claim_early(struct member *m, int gap)
{
    struct line *l = line_at(m->team, m->i);
    int x = rad_quincunx_gap_begin(&m->q, m->i, gap);
    uint64_t bit = UINT64_C(1) << x / team_block_columns(&m->q);

    if ((m->begun_early | m->mine[LINE_BASE]) & bit)
        return true;
    if (atomic_fetch_or(&l->taken[LINE_BASE], bit) & bit)
        return false;
    m->begun_early |= bit;
    uv_mutex_lock(&m->team->mu);
    l->helped[LINE_BASE] |= bit;
    l->helped_done[LINE_BASE] |= bit;
    uv_mutex_unlock(&m->team->mu);
    return true;
}

bool
help_await_base(struct member *m)
{
    struct line *l = line_at(m->team, m->i);
    uint64_t done;

    uv_mutex_lock(&m->team->mu);
    await_locked(m, LINE_BASE, UINT64_MAX);
    done = l->helped_done[LINE_BASE];
    uv_mutex_unlock(&m->team->mu);
    for (int b = 0; b < MOST_BLOCKS; b++)
        if (done >> b & 1)
            sweep_base_block(m, b, l->sampled);
    return !is_stopped(m->team);
}
