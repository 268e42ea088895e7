/* strict.c - see strict.h; strict_state.h names the other files */
#include "config.h"

#include "strict/strict.h"

#include "strict/strict_edge.h"
#include "strict/strict_facts.h"
#include "strict/strict_out.h"
#include "strict/strict_state.h"

#include <stdlib.h>
#include <string.h>

int
strict_error(const struct strict *s)
{
    return s->error;
}

void
strict_free(struct strict *s)
{
    if (!s)
        return;
    while (s->units) {
        struct strict_unit *u = s->units;

        s->units = u->next;
        strict_unit_free(u);
    }
    edge_release(s);
    out_release(s);
    facts_release(s);
    free(s->frames);
    free(s);
}

struct strict *
strict_new(const struct rad_quincunx *frames, uint32_t nframes, bool painted,
           const uint8_t job[MSG_JOB])
{
    struct strict *s = calloc(1, sizeof *s);

    if (!s)
        return NULL;
    s->early_end = &s->early;
    memcpy(s->job, job, MSG_JOB);
    s->painted = painted;
    s->frames = calloc(nframes + 1, sizeof *s->frames);
    if (!s->frames) {
        strict_free(s);
        return NULL;
    }
    s->nframes = nframes;
    for (uint32_t i = 0; i < nframes; i++) {
        s->frames[i].q = frames[i];
        s->frames[i].ndensity = rad_quincunx_ndensity(&frames[i]);
        s->frames[i].nlines = rad_quincunx_nbases(&frames[i]);
    }
    return s;
}

uint64_t
strict_rays(const struct strict *s)
{
    uint64_t n = 0;

    for (const struct strict_unit *u = s->units; u; u = u->next)
        n += is_gone(u) ? 0 : u->spent.rays;
    return n;
}

static uint64_t
pixels_of(const struct strict *s, const struct strict_unit *u)
{
    const struct frame *f = frame_of(s, u->frame);
    struct team_made made = { 0 };
    struct strict_unit now = { .made = u->made };
    int begin = row_of(f, u->first);
    uint64_t all, out;

    if (u->fate >= FATE_OVER || u->loan)
        return 0;
    if (u->pass)
        made = u->pass->made;
    strict_unit_made(&now, &made);
    all = (uint64_t)(row_of(f, u->last) - begin) * (uint64_t)f->q.width;
    out = made.out;
    if (u->out > u->first)
        out += (uint64_t)(row_of(f, u->out) - begin) * (uint64_t)f->q.width;
    /* given lines do not count, nor the base line above */
    if (now.made.base + now.made.bars < all)
        all = now.made.base + now.made.bars;
    return all > out ? all - out : 0;
}

uint64_t
strict_pixels(const struct strict *s)
{
    uint64_t n = 0;

    for (const struct strict_unit *u = s->units; u; u = u->next)
        n += pixels_of(s, u);
    return n;
}

void
strict_dropped(const struct strict *s, struct msg_counts *out)
{
    *out = s->dropped;
    out->primary_rays = 0;
    out->nan = (struct msg_nan){ 0 };
    memset(out->faults, 0, sizeof out->faults);
}

int
strict_take(struct strict *s, const struct msg *m, struct rad_error *err)
{
    int rc;

    switch (m->type) {
    case MSG_SPLIT:
        strict_split(s, m->split.unit, m->split.attempt);
        return 1;
    case MSG_YIELD:
        strict_yield(s, m->yield.unit, m->yield.attempt);
        return 1;
    case MSG_LEND:
        strict_lend(s, &m->lend);
        return 1;
    case MSG_LOAN:
        rc = strict_loan(s, &m->loan, err);
        return rc < 0 ? rc : 1;
    case MSG_BACK:
        strict_back(s, &m->back);
        return 1;
    case MSG_FACTS:
        strict_facts(s, &m->facts);
        return 1;
    case MSG_GUESS:
        strict_guess(s, &m->guess);
        return 1;
    case MSG_BASE_LINE:
        strict_base_line(s, &m->base_line);
        return 1;
    default:
        return 0;
    }
}

bool
strict_brings(const struct msg *m, uint32_t *frame)
{
    switch (m->type) {
    case MSG_LOAN:
        *frame = m->loan.frame;
        return true;
    case MSG_FACTS:
        *frame = m->facts.frame;
        return true;
    case MSG_BASE_LINE:
        *frame = m->base_line.frame;
        return true;
    case MSG_GUESS:
        *frame = m->guess.frame;
        return true;
    default:
        return false;
    }
}
