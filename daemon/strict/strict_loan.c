/* strict_loan.c - columns that are lent, and that are borrowed
 *
 * The lender leaves lent columns out of its passes, and needs their facts for
 * its rows.  To the borrower these columns, of one line, are a unit. */
#include "config.h"

#include "strict/strict_loan.h"

#include "strict/strict_edge.h"
#include "strict/strict_facts.h"
#include "strict/strict_out.h"
#include "strict/strict_rank.h"
#include "strict/strict_state.h"

#include <stdlib.h>
#include <string.h>

bool
loan_is_out(const struct strict_unit *u)
{
    return (u->lending.lent.base | u->lending.lent.bar) != 0;
}

void
loan_forget(struct strict_unit *u)
{
    u->lending.lent = (struct team_blocks){ 0 };
    u->lending.blocked = false;
}

void
loan_of_other_line(struct strict_unit *u)
{
    u->lending.lent.ever = 0;
}

void
loan_nothing_left(struct strict_unit *u)
{
    u->lending.part = 0;
}

/* --- lending --- */

void
strict_lend(struct strict *s, const struct msg_lend *m)
{
    struct strict_unit *u = strict_unit_find(s, m->unit, m->attempt);

    if (!u)
        return;
    u->lending.part = (m->part + 1) / 65536.;
    if (u->pass && u->pass->keeps)
        u->pass->lend = u->lending.part;
}

void
strict_lent(struct strict *s, struct strict_pass *p,
            const struct team_loan *loan)
{
    struct strict_unit *u = p->of;
    uint64_t blocks =
        team_blocks_of(&frame_of(s, u->frame)->q, loan->x, loan->n);

    p->lend = u->lending.part = 0;
    u->lending.lent.bar |= blocks;
    u->lending.lent.base |= loan->base ? blocks : 0;
    u->lending.lent.ever |= blocks;
    if (!is_gone(u))
        out_loan(s, u, loan);
}

void
strict_blocked(struct strict_pass *p, int finished)
{
    struct strict_unit *u = p->of;

    u->lending.blocked = loan_is_out(u); /* BACK may have come meanwhile */
    u->lending.lent.ever = UINT64_MAX;   /* all other blocks are done */
    u->parked = false;
    if (p->spec.mode == TEAM_TRUTH && finished > u->out)
        u->out = finished;
}

void
strict_back(struct strict *s, const struct msg_back *m)
{
    struct strict_unit *u = strict_unit_find(s, m->unit, m->attempt);
    uint64_t blocks;
    bool blocked;

    if (!u || m->line + 1 != (uint32_t)u->last)
        return;
    if (m->x > (uint32_t)frame_of(s, u->frame)->q.width)
        return;
    blocks = m->n == 0 ? UINT64_MAX
                       : team_blocks_of(&frame_of(s, u->frame)->q, (int)m->x,
                                        (int)m->n);
    blocks &= u->lending.lent.base | u->lending.lent.bar;
    u->lending.lent.base &= ~blocks;
    u->lending.lent.bar &= ~blocks;
    blocked = u->lending.blocked;
    u->lending.blocked = false;
    if (blocked)
        rank_make_way(s);
    if (u->parked) /* PARKED may have been sent while BACK was on its way */
        out_state(s, ITEM_RESUMED, u);
    u->parked = false; /* the unit may wait for its top next */
    if (u->pass)
        u->pass->back |= blocks;
}

/* --- borrowing --- */

static bool
loan_fits(const struct strict *s, const struct msg_loan *m)
{
    const struct frame *f;
    uint32_t ndensity;

    if (m->frame >= s->nframes)
        return false;
    f = frame_of(s, m->frame);
    ndensity = m->flags & MSG_LOAN_LINE ? (uint32_t)f->ndensity : 0;
    return m->line >= 1 && m->line < (uint32_t)f->nlines &&
           m->channels == channels_of(f) && m->ndensity == ndensity &&
           team_blocks_of(&f->q, (int)m->x, (int)m->n) != 0;
}

/* Copy the message's loan into the unit; false: memory is out. */
static bool
copy_loan(struct strict_unit *u, const struct msg_loan *m)
{
    bool base = m->flags & MSG_LOAN_LINE;
    size_t bits = (m->n + 7) / 8;
    struct loan *l = calloc(1, sizeof *l);

    u->loan = l;
    if (!l)
        return false;
    l->pixels = malloc(2 * (size_t)m->n * sizeof *l->pixels);
    l->bytes = malloc(bits + m->ndensity);
    if (!l->pixels || !l->bytes)
        return false;
    memcpy(l->bytes, m->wanted, bits);
    if (m->ndensity > 0)
        memcpy(l->bytes + bits, m->density, m->ndensity);
    edge_decode(l->pixels, m->top, m->n, m->channels);
    if (!base)
        edge_decode(l->pixels + m->n, m->bottom, m->n, m->channels);
    l->is =
        (struct team_loan){ .line = (int)m->line,
                            .x = (int)m->x,
                            .n = (int)m->n,
                            .base = base,
                            .top = l->pixels,
                            .density = m->ndensity > 0 ? l->bytes + bits : NULL,
                            .bottom = base ? NULL : l->pixels + m->n,
                            .wanted = l->bytes };
    return true;
}

int
strict_loan(struct strict *s, const struct msg_loan *m, struct rad_error *err)
{
    struct strict_unit *u;
    int line = (int)m->line;

    if (strict_unit_find(s, m->unit, m->attempt))
        return 0;
    if (!loan_fits(s, m)) {
        out_state(
            s, ITEM_PAID,
            &(struct strict_unit){ .unit = m->unit, .attempt = m->attempt });
        return rad_fail(err, RAD_EPROTO, "a loan of unit %u fits no line",
                        m->unit);
    }
    u = strict_unit_new(m->unit, m->attempt, m->frame, line, line + 1);
    if (!u || !copy_loan(u, m)) {
        strict_unit_free(u);
        return rad_fail_memory(err);
    }
    strict_unit_enter(s, u);
    return 0;
}

void
loan_end(struct strict *s, struct strict_unit *u)
{
    u->spent.speculative_rays += facts_late(s, u);
    out_facts(s, &s->urgent, u, u->first);
    out_line_costs(s, u);
    out_state(s, ITEM_PAID, u);
    strict_unit_decide(u, FATE_OVER);
}
