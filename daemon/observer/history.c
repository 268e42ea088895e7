/* history.c - see history.h */
#include "config.h"

#include "observer/history.h"

#include <string.h>

static struct history_point *
slot(struct history *h, uint64_t step)
{
    return &h->ring[step % HISTORY_POINTS];
}

void
history_advance(struct history *h, uint64_t now_ms)
{
    uint64_t step = now_ms / (1000 * HISTORY_STEP_S), n;

    if (step <= h->step)
        return;
    n = step - h->step;
    if (n > HISTORY_POINTS)
        n = HISTORY_POINTS;
    for (uint64_t i = 0; i < n; i++)
        *slot(h, step - i) = (struct history_point){ 0 };
    h->step = step;
}

void
history_note(struct history *h, uint64_t now_ms, double rays_s, double at_work)
{
    struct history_point *p;

    history_advance(h, now_ms);
    p = slot(h, h->step);
    p->notes++;
    p->rays_s += (rays_s - p->rays_s) / p->notes;
    p->at_work += (at_work - p->at_work) / p->notes;
}

const struct history_point *
history_at(const struct history *h, unsigned back)
{
    return &h->ring[(h->step + HISTORY_POINTS - back % HISTORY_POINTS) %
                    HISTORY_POINTS];
}
