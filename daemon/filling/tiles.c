/* tiles.c - see tiles.h */
#include "config.h"

#include "filling/tiles.h"

#include "desk/holding.h"
#include "desk/verdict.h"
#include "filling/colours.h"
#include "filling/passes_impl.h"
#include "filling/records.h"
#include "jobs/part.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

/* Many tiles wait if there are more than this for each thread of the job.  A
 * worker may have more ahead for each further PLENTY, up to MOST_PLENTY times:
 * many tiles take less time than an answer of the coordinator does. */
#define PLENTY      4
#define MOST_PLENTY 4

/* A tile goes to a second worker when it is out for LATE_TIMES the usual time
 * of a tile and at least LATE_MS.  The usual time is a mean in which each tile
 * counts by its own time, for many tiles take no time. */
#define LATE_TIMES 3
#define LATE_MS    100

/* --- sheets of open passes --- */

void
tiles_close(struct passes *s, uint32_t pass)
{
    struct sheet *k = passes_sheet(s, pass);

    for (uint32_t i = 0; k->tile && i < k->ntiles; i++)
        free(k->tile[i].records);
    free(k->tile);
    *k = (struct sheet){ .oldest = NO_TILE, .newest = NO_TILE };
}

void
tiles_drop(struct passes *s)
{
    for (uint32_t i = 0; i < MSG_OPEN_PASSES; i++)
        tiles_close(s, i);
    s->opened = s->open;
}

bool
tiles_open(struct passes *s, uint32_t pass)
{
    struct sheet *k = passes_sheet(s, pass);

    k->ntiles = k->left = k->waiting = s->plan[pass].tiles;
    k->tile = calloc(k->ntiles + 1, sizeof *k->tile);
    return k->tile != NULL;
}

/* --- tiles go out --- */

static void
unlist(struct sheet *s, struct tile *t)
{
    *(t->before == NO_TILE ? &s->oldest : &s->tile[t->before].then) = t->then;
    *(t->then == NO_TILE ? &s->newest : &s->tile[t->then].before) = t->before;
}

static void
list_newest(struct sheet *s, struct tile *t)
{
    uint32_t i = (uint32_t)(t - s->tile);

    t->before = s->newest;
    t->then = NO_TILE;
    *(s->newest == NO_TILE ? &s->oldest : &s->tile[s->newest].then) = i;
    s->newest = i;
}

static bool
has_tile(const struct tile *t, uint32_t index)
{
    for (uint8_t i = 0; i < t->nholders; i++)
        if (t->holder[i] == index)
            return true;
    return false;
}

static bool
is_late(const struct coord *c, const struct passes *s, const struct tile *t)
{
    uint64_t usual = s->took_ms > 0 ? (uint64_t)(s->took_ms2 / s->took_ms) : 0;
    uint64_t late = LATE_TIMES * usual;

    return c->now_ms - t->out_ms >= (late > LATE_MS ? late : LATE_MS);
}

/* May the worker have the tile? */
static bool
may_have(const struct coord *c, const struct job *job, const struct tile *t,
         uint32_t index)
{
    return !t->made && t->nholders < HOLDERS && !has_tile(t, index) &&
           desk_may_try(c, job, &t->crashes, index);
}

static bool
is_gone(const struct tile *t)
{
    return t->made || t->nholders > 0;
}

/* The next tile of the sheet that no worker has and that this worker may have;
 * NULL: none. */
static struct tile *
choose_new(const struct coord *c, const struct job *job, struct sheet *s,
           uint32_t index)
{
    while (s->next < s->ntiles && is_gone(&s->tile[s->next]))
        s->next++;
    for (uint32_t i = s->next; i < s->ntiles && s->waiting > 0; i++) {
        struct tile *t = &s->tile[i];

        if (t->nholders == 0 && may_have(c, job, t, index))
            return t;
    }
    return NULL;
}

/* The tile that is late for longest and that this worker may have; NULL: none.
 */
static struct tile *
choose_late(const struct coord *c, const struct job *job, struct sheet *s,
            uint32_t index)
{
    for (uint32_t i = s->oldest; i != NO_TILE; i = s->tile[i].then)
        if (!is_late(c, job->passes, &s->tile[i]))
            break;
        else if (may_have(c, job, &s->tile[i], index))
            return &s->tile[i];
    return NULL;
}

/* Index after the last open pass of which the worker may have tiles. */
static uint32_t
beyond_for(const struct job *job, uint32_t index)
{
    const struct passes *s = job->passes;
    uint32_t n = s->opened;

    while (n > s->open && !records_allow(job, index, s->plan[n - 1].reads))
        n--;
    return n;
}

/* Choose a tile for the worker, and set *pass to its pass; NULL: there is none.
 */
static struct tile *
choose(const struct coord *c, const struct job *job, uint32_t index,
       uint32_t *pass)
{
    struct passes *s = job->passes;
    uint32_t beyond = beyond_for(job, index);
    struct tile *t = NULL;

    for (*pass = s->open; *pass < beyond; ++*pass)
        if ((t = choose_new(c, job, passes_sheet(s, *pass), index)))
            return t;
    for (*pass = s->open; *pass < beyond; ++*pass)
        if ((t = choose_late(c, job, passes_sheet(s, *pass), index)))
            return t;
    return NULL;
}

uint32_t
tiles_out(const struct job_part *part)
{
    uint32_t n = 0;

    for (int i = 0; i < MSG_OPEN_PASSES; i++)
        n += part->ntiles[i];
    return n;
}

/* Do all threads of the worker render lines of another job, of no lower
 * priority? */
static bool
renders_lines(const struct coord *c, const struct job *job,
              const struct coord_worker *w)
{
    for (size_t i = 0; i < c->nbegun; i++) {
        const struct job *o = c->jobs[i];

        if (o->spec.priority < job->spec.priority)
            break;
        if (o != job && holding_has_any(o, w) &&
            partition_is_strict(o->partition) &&
            partition_kind(o->partition) != MSG_PART_SCANBAR)
            return true;
    }
    return false;
}

/* How many tiles a worker of n threads may have that none of these makes yet:
 * half as many as threads, and for each further PLENTY that wait n more. */
static uint32_t
most_ahead(const struct job *job, uint32_t n, uint32_t waiting)
{
    uint32_t plenty = PLENTY * job->speed.threads;
    uint32_t times = 0;

    while (times < MOST_PLENTY && waiting > (times + 1) * plenty)
        times++;
    return times > 0 ? (n + 1) / 2 + (times - 1) * n : 0;
}

/* Has the worker room for another tile?  A worker has a tile for each thread,
 * and more while many tiles wait, so that no thread waits for the coordinator;
 * but none more beside units of another job.  Only tiles of the
 * first pass that has waiting tiles count as waiting: at the end of a pass no
 * tile must stand behind a dear tile in a worker. */
static bool
has_room(const struct coord *c, const struct job *job, uint32_t index)
{
    const struct passes *s = job->passes;
    const struct job_part *part = &job->parts[index];
    uint32_t n = part->threads;
    uint32_t waiting = 0;
    bool mixed = part->worker->in_flight > part->in_flight;

    if (mixed && renders_lines(c, job, part->worker))
        return false;
    for (uint32_t i = s->open; i < s->opened && waiting == 0; i++)
        waiting = s->sheet[i % MSG_OPEN_PASSES].waiting;
    return part->worker->in_flight + tiles_out(part) <
           n + (mixed ? 0 : most_ahead(job, n, waiting));
}

bool
tiles_has(const struct coord *c, const struct job *job, uint32_t index)
{
    uint32_t pass;

    return tiles_out(&job->parts[index]) > 0 || choose(c, job, index, &pass);
}

bool
tiles_give(struct coord *c, struct job *job, uint32_t index)
{
    struct job_part *part = &job->parts[index];
    struct passes *s = job->passes;
    struct msg m = { .type = MSG_TILE };
    struct sheet *k;
    struct tile *t;
    uint32_t pass;

    if (!has_room(c, job, index) || !(t = choose(c, job, index, &pass)))
        return false;
    k = passes_sheet(s, pass);
    if (t->nholders == 0)
        k->waiting--;
    else
        unlist(k, t);
    list_newest(k, t);
    t->holder[t->nholders++] = index;
    t->out_ms = c->now_ms;
    part->ntiles[pass % MSG_OPEN_PASSES]++;
    holding_fill(part->worker, job);
    life_begin(job, c->now_ms);
    m.tile =
        (struct msg_tile){ job->id, s->base + pass, (uint32_t)(t - k->tile),
                           colours_wanted(job, &s->plan[pass]) };
    actions_send(&c->actions, part->worker->conn, &m);
    return true;
}

/* --- tiles come back --- */

bool
tiles_take(struct sheet *s, struct tile *t, uint32_t index)
{
    if (!has_tile(t, index))
        return false;
    for (uint8_t i = 0; i < t->nholders; i++)
        if (t->holder[i] == index)
            t->holder[i--] = t->holder[--t->nholders];
    if (t->nholders > 0)
        return true;
    unlist(s, t);
    if (t->made)
        return true;
    s->waiting++;
    if ((uint32_t)(t - s->tile) < s->next)
        s->next = (uint32_t)(t - s->tile);
    return true;
}

void
tiles_lost(struct job *job, uint32_t index)
{
    struct passes *s = job->passes;
    struct job_part *part = &job->parts[index];

    memset(part->ntiles, 0, sizeof part->ntiles);
    part->lags = false;
    if (part->worker->fills == job)
        holding_fill(part->worker, NULL);
    for (uint32_t k = 0; s && k < MSG_OPEN_PASSES; k++)
        for (uint32_t i = s->sheet[k].oldest, then; i != NO_TILE; i = then) {
            then = s->sheet[k].tile[i].then;
            tiles_take(&s->sheet[k], &s->sheet[k].tile[i], index);
        }
}

/* Note at the worker's tiles of a pass that its child died; false: a tile has
 * brought down too many children. */
static bool
crashed_in(struct coord *c, struct job *job, uint32_t pass, uint32_t index,
           const char *why)
{
    struct sheet *s = passes_sheet(job->passes, pass);
    char text[MSG_MAX_TEXT + 1];

    for (uint32_t i = s->oldest; i != NO_TILE; i = s->tile[i].then) {
        struct tile *t = &s->tile[i];

        if (t->made || !has_tile(t, index))
            continue;
        if (unit_crashed(&t->crashes, index))
            continue;
        snprintf(text, sizeof text,
                 "tile %u of pass %u, of the ambient cache, brought the "
                 "renderer down %u times: %.200s",
                 i, job->passes->base + pass, t->crashes.n, why);
        verdict_job(c, job, JOB_FAILED, EX_SOFTWARE, text);
        return false;
    }
    return true;
}

bool
tiles_crashed(struct coord *c, struct job *job, uint32_t index, const char *why)
{
    const struct passes *s = job->passes;

    for (uint32_t i = s ? s->open : 0; s && i < s->opened; i++)
        if (!crashed_in(c, job, i, index, why))
            return false;
    return true;
}
