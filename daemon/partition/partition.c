/* partition.c - see partition.h
 *
 * What windows and lines have in common: the table of units, and the stack of
 * those that came back. */
#include "config.h"

#include "partition/partition.h"

#include "partition/partition_impl.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A row of pixels must fit a RESULT. */
#define WIDEST (MSG_MAX_PIXELS / 16)

static bool
by_lines(const struct partition_spec *spec)
{
    return spec->kind == MSG_PART_STATIC || spec->kind == MSG_PART_SCANBAR ||
           (spec->kind == MSG_PART_AUTO && spec->strict);
}

int
partition_check(const struct partition_spec *spec, struct rad_error *err)
{
    for (uint32_t i = 0; i < spec->nframes; i++)
        if (spec->frames[i].width > WIDEST)
            return rad_fail(err, RAD_EUSAGE,
                            "picture of %u columns: at most %u are supported",
                            spec->frames[i].width, WIDEST);
    if (spec->ncosts > 0 && spec->ncosts != lines_of(spec))
        return rad_fail(err, RAD_EUSAGE,
                        "costs of %u lines, but the pictures have %llu",
                        spec->ncosts, (unsigned long long)lines_of(spec));
    return by_lines(spec) ? lines_check(spec, err) : window_check(spec, err);
}

uint32_t
partition_add(struct partition *p, const struct partition_area *area)
{
    struct partition_unit *u;

    if (p->total == p->cap) {
        uint32_t cap = p->cap ? 2 * p->cap : 64;

        u = realloc(p->unit, cap * sizeof *u);
        if (!u)
            return PARTITION_NONE;
        p->unit = u;
        p->cap = cap;
    }
    u = &p->unit[p->total];
    memset(u, 0, sizeof *u);
    u->area = *area;
    u->keeper = PARTITION_NONE;
    p->waiting++;
    p->undone++;
    return p->total++;
}

bool
partition_back(struct partition *p, uint32_t unit)
{
    if (p->nback == p->cap_back) {
        uint32_t cap = p->cap_back ? 2 * p->cap_back : 64;
        uint32_t *v = realloc(p->back, cap * sizeof *v);

        if (!v)
            return false;
        p->back = v;
        p->cap_back = cap;
    }
    p->back[p->nback++] = unit;
    return true;
}

static void
drop_back(struct partition *p, uint32_t i)
{
    p->nback--;
    memmove(p->back + i, p->back + i + 1, (p->nback - i) * sizeof *p->back);
}

struct partition *
partition_new(const struct partition_spec *spec, struct rad_error *err)
{
    struct partition *p;

    if (partition_check(spec, err) != 0)
        return NULL;
    p = calloc(1, sizeof *p);
    if (!p || !(by_lines(spec) ? lines_new(p, spec) : window_new(p, spec))) {
        partition_free(p);
        rad_fail(err, RAD_ENOMEM, "out of memory");
        return NULL;
    }
    return p;
}

void
partition_free(struct partition *p)
{
    if (!p)
        return;
    window_free(p->window);
    queue_free(p);
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
    return p->waiting + (p->lines ? lines_free_count(p) : 0);
}

/* --- costs --- */

uint32_t
partition_parts(const struct partition *p)
{
    return p->lines ? lines_parts(p) : p->total;
}

void
partition_part(const struct partition *p, uint32_t part,
               struct partition_area *area)
{
    if (p->lines)
        lines_part(p, part, area);
    else
        *area = p->unit[part].area;
}

/* Nothing is free: a cost of nothing would never be chosen and never be late.
 */
static double
least_cost(const double *cost, uint32_t n)
{
    double sum = 0;

    for (uint32_t i = 0; i < n; i++)
        sum += cost[i];
    return sum > 0 ? 1e-6 * sum / n : 1;
}

void
partition_set_costs(struct partition *p, const double *cost)
{
    uint32_t n = partition_parts(p);
    double least = least_cost(cost, n);
    double *v = malloc(n * sizeof *v);

    if (!v)
        return; /* goes on as if there were no estimate */
    p->cost_total = 0;
    for (uint32_t i = 0; i < n; i++) {
        v[i] = cost[i] > least ? cost[i] : least;
        p->cost_total += v[i];
    }
    if (p->lines)
        lines_set_costs(p, v);
    else
        window_set_costs(p, v);
    free(v);
}

/* --- units --- */

/* The last that came back, of those that are kept for that worker, or for none;
 * false: there is none.  Units that were taken out of turn are skipped where
 * they lie. */
static bool
next_kept(struct partition *p, uint32_t worker, uint32_t *unit)
{
    for (uint32_t i = p->nback; i-- > 0;) {
        *unit = p->back[i];
        if (p->unit[*unit].state != PART_WAITING) {
            drop_back(p, i);
        } else if (p->unit[*unit].keeper == worker) {
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

bool
partition_next(struct partition *p, const struct partition_who *who,
               uint32_t *unit)
{
    if (!next_back(p, who->worker, unit) &&
        !(p->lines ? lines_next(p, who, unit) : window_next(p, unit)))
        return false;
    p->unit[*unit].state = PART_OUT;
    p->waiting--;
    return true;
}

void
partition_lost(struct partition *p, uint32_t unit)
{
    if (p->unit[unit].state != PART_OUT || !partition_back(p, unit))
        return;
    p->unit[unit].state = PART_WAITING;
    p->unit[unit].keeper = PARTITION_NONE;
    p->unit[unit].bars = false; /* others are further, and wait for it */
    p->waiting++;
}

void
partition_keep(struct partition *p, uint32_t unit, uint32_t worker)
{
    if (p->unit[unit].state == PART_WAITING)
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
    if (p->unit[unit].state != PART_WAITING)
        return;
    p->unit[unit].state = PART_OUT;
    p->waiting--;
    for (uint32_t i = 0; i < p->nback; i++)
        if (p->back[i] == unit) {
            drop_back(p, i);
            break;
        }
}

void
partition_done(struct partition *p, uint32_t unit, double took)
{
    if (p->unit[unit].state != PART_OUT)
        return;
    p->unit[unit].state = PART_DONE;
    p->undone--;
    if (p->lines)
        lines_done(p, unit);
    if (p->queue && took > 0)
        queue_measured(p, unit, took);
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
