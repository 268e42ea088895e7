/* partition.c - see partition.h
 *
 * Hands the scheduler's calls on to windows or to lines. */
#include "config.h"

#include "partition/partition.h"

#include "partition/partition_lines.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int
partition_check(const struct partition_spec *spec, struct rad_error *err)
{
    for (uint32_t i = 0; i < spec->nframes; i++)
        if (spec->frames[i].width > MSG_MAX_COLUMNS)
            return rad_fail(err, RAD_EUSAGE,
                            "picture of %u columns: at most %u are supported",
                            spec->frames[i].width, MSG_MAX_COLUMNS);
    if (spec->ncosts > 0 && spec->ncosts != lines_of(spec))
        return rad_fail(err, RAD_EUSAGE,
                        "costs of %u lines, but the pictures have %llu",
                        spec->ncosts, (unsigned long long)lines_of(spec));
    return msg_shares_lines(spec->kind) ? lines_check(spec, err)
                                        : window_check(spec, err);
}

static void
drop_back(struct partition *p, uint32_t i)
{
    p->nback--;
    memmove(p->back + i, p->back + i + 1, (p->nback - i) * sizeof *p->back);
}

/* --- costs --- */

uint32_t
partition_areas(const struct partition *p)
{
    return p->lines ? lines_areas(p) : p->total;
}

void
partition_nth_area(const struct partition *p, uint32_t n,
                   struct partition_area *area)
{
    if (p->lines)
        lines_nth_area(p, n, area);
    else
        *area = p->unit[n].area;
}

/* The least cost of an area, above 0: an area without cost would never be
 * chosen, and never be late. */
static double
least_cost(const double *cost, uint32_t n)
{
    double sum = 0;

    for (uint32_t i = 0; i < n; i++)
        sum += cost[i];
    return sum > 0 ? 1e-6 * sum / n : 1;
}

void
partition_set_costs(struct partition *p, double *cost)
{
    uint32_t n = partition_areas(p);
    double least = least_cost(cost, n);

    p->cost_total = 0;
    for (uint32_t i = 0; i < n; i++) {
        if (!(cost[i] > least))
            cost[i] = least;
        p->cost_total += cost[i];
    }
    if (p->lines)
        lines_set_costs(p, cost);
    else
        window_set_costs(p, cost);
}

/* Set costs as given, or by lines' pixels; windows have theirs by pixels
 * already.  False: memory is out. */
static bool
set_first_costs(struct partition *p, const struct partition_spec *spec)
{
    double *cost;

    if (!p->lines && spec->ncosts == 0)
        return true;
    cost = p->lines ? lines_first_costs(p->lines, spec)
                    : window_first_costs(p, spec);
    if (cost)
        partition_set_costs(p, cost);
    free(cost);
    return cost != NULL;
}

/* --- set-up and end --- */

struct partition *
partition_new(const struct partition_spec *spec, struct rad_error *err)
{
    struct partition *p;

    if (partition_check(spec, err) != 0)
        return NULL;
    p = calloc(1, sizeof *p);
    if (p)
        p->open = spec->nframes;
    if (!p ||
        !(msg_shares_lines(spec->kind) ? lines_new(p, spec)
                                       : window_new(p, spec)) ||
        !set_first_costs(p, spec)) {
        partition_free(p);
        rad_fail_memory(err);
        return NULL;
    }
    if (p->lines)
        region_choose(p);
    return p;
}

void
partition_free(struct partition *p)
{
    if (!p)
        return;
    window_free(p->window);
    lines_free(p->lines);
    free(p->unit);
    free(p->back);
    free(p);
}

bool
partition_is_strict(const struct partition *p)
{
    return p->lines != NULL;
}

uint32_t
partition_total(const struct partition *p)
{
    return p->total;
}

uint32_t
partition_waiting(const struct partition *p)
{
    return p->waiting - p->shut + (p->lines ? lines_free_count(p) : 0);
}

void
partition_open(struct partition *p, uint32_t frames)
{
    if (frames == p->open)
        return;
    p->open = frames;
    p->shut = 0;
    for (uint32_t i = 0; i < p->total; i++)
        p->shut +=
            p->unit[i].state == PARTITION_WAITING && partition_is_shut(p, i);
}

/* --- units --- */

/* Take the unit that came back last from the stack, of the units that are kept
 * for that worker (PARTITION_NONE: for no worker) and whose frame may go out.
 * False: there is none.  Units that were taken out of turn are dropped from the
 * stack on the way. */
static bool
next_kept(struct partition *p, uint32_t worker, uint32_t *unit)
{
    for (uint32_t i = p->nback; i-- > 0;) {
        *unit = p->back[i];
        if (p->unit[*unit].state != PARTITION_WAITING) {
            drop_back(p, i);
        } else if (p->unit[*unit].keeper == worker &&
                   !partition_is_shut(p, *unit)) {
            drop_back(p, i);
            return true;
        }
    }
    return false;
}

static bool
next_back(struct partition *p, uint32_t worker, uint32_t *unit)
{
    return next_kept(p, worker, unit) || next_kept(p, PARTITION_NONE, unit);
}

/* Cut a unit for a worker. */
static bool
next_lines(struct partition *p, const struct partition_ask *ask, uint32_t *unit)
{
    struct partition_lines *s = p->lines;
    struct asker *w = lines_asker(s, ask->worker);

    if (!w || s->nfree == 0)
        return false;
    if (ask->workers > s->most) {
        s->most = ask->workers;
        region_choose(p);
    }
    return s->kind == MSG_PART_STATIC ? run_next(p, w, ask, unit)
                                      : region_next(p, w, ask, unit);
}

bool
partition_next(struct partition *p, const struct partition_ask *ask,
               uint32_t *unit)
{
    if (!next_back(p, ask->worker, unit) &&
        !(p->lines ? next_lines(p, ask, unit) : window_next(p, unit)))
        return false;
    p->unit[*unit].state = PARTITION_OUT;
    p->waiting--;
    return true;
}

void
partition_lost(struct partition *p, uint32_t unit)
{
    if (p->unit[unit].state != PARTITION_OUT || !partition_back(p, unit))
        return;
    p->unit[unit].state = PARTITION_WAITING;
    p->unit[unit].keeper = PARTITION_NONE;
    p->waiting++;
    p->shut += partition_is_shut(p, unit);
}

void
partition_keep(struct partition *p, uint32_t unit, uint32_t worker)
{
    if (p->unit[unit].state == PARTITION_WAITING)
        p->unit[unit].keeper = worker;
}

void
partition_keep_none(struct partition *p, uint32_t worker)
{
    for (uint32_t i = 0; i < p->nback; i++)
        if (p->unit[p->back[i]].keeper == worker)
            p->unit[p->back[i]].keeper = PARTITION_NONE;
}

void
partition_take(struct partition *p, uint32_t unit)
{
    if (p->unit[unit].state != PARTITION_WAITING)
        return;
    p->unit[unit].state = PARTITION_OUT;
    p->waiting--;
    p->shut -= partition_is_shut(p, unit);
    for (uint32_t i = 0; i < p->nback; i++)
        if (p->back[i] == unit) {
            drop_back(p, i);
            break;
        }
}

void
partition_done(struct partition *p, uint32_t unit)
{
    if (p->unit[unit].state != PARTITION_OUT)
        return;
    p->unit[unit].state = PARTITION_DONE;
    p->undone--;
    if (p->lines)
        lines_done(p, unit);
}

void
partition_area(const struct partition *p, uint32_t unit,
               struct partition_area *area)
{
    *area = p->unit[unit].area;
}

bool
partition_restore(struct partition *p, uint32_t unit,
                  const struct partition_area *area)
{
    if (p->lines ? !lines_restore(p, unit, area)
                 : unit >= p->total ||
                       memcmp(&p->unit[unit].area, area, sizeof *area) != 0)
        return false;
    partition_take(p, unit);
    return true;
}

double
partition_cost(const struct partition *p, uint32_t unit)
{
    return p->unit[unit].cost;
}

double
partition_cost_total(const struct partition *p)
{
    return p->cost_total;
}

const char *
partition_choice(const struct partition *p)
{
    return p->choice;
}

enum msg_partition
partition_kind(const struct partition *p)
{
    return p->kind;
}

const char *
partition_kind_name(enum msg_partition kind)
{
    static const char *const name[] = { "auto", "static", "scanbar", "window" };

    return kind < MSG_NPART ? name[kind] : "?";
}
