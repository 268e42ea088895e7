/* tiles.c - see tiles.h */
#include "config.h"

#include "filling/tiles.h"

#include "desk/part.h"
#include "desk/speed.h"
#include "desk/verdict.h"
#include "filling/colours.h"
#include "filling/passes_impl.h"
#include "filling/records.h"

#include <stdio.h>
#include <stdlib.h>
#include <sysexits.h>

/* A tile goes to a second worker when it is out for so many times what tiles
 * took so far, but no sooner than that. */
#define LATE_TIMES 3
#define LATE_MS    100

/* --- of the open pass --- */

void
tiles_drop(struct passes *s)
{
    for (uint32_t i = 0; i < s->ntiles; i++)
        free(s->tile[i].records);
    free(s->tile);
    free(s->order);
    s->tile = NULL;
    s->order = NULL;
    s->ntiles = s->next = s->left = s->waiting = 0;
    s->oldest = s->newest = NO_TILE;
}

bool
tiles_open(struct passes *s)
{
    s->ntiles = s->left = s->waiting = s->plan[s->open].tiles;
    s->tile = calloc(s->ntiles + 1, sizeof *s->tile);
    s->order = calloc(s->ntiles + 1, sizeof *s->order);
    if (!s->tile || !s->order ||
        !dearest_order(s->dearest, &s->plan[s->open], s->order))
        return false;
    for (uint32_t i = 0; i < s->ntiles; i++)
        s->tile[s->order[i]].place = i;
    return true;
}

/* --- out --- */

static void
unlist(struct passes *s, struct tile *t)
{
    *(t->before == NO_TILE ? &s->oldest : &s->tile[t->before].then) = t->then;
    *(t->then == NO_TILE ? &s->newest : &s->tile[t->then].before) = t->before;
}

static void
list_newest(struct passes *s, struct tile *t)
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
    uint64_t usual = s->ntook > 0 ? s->took_ms / s->ntook : 0;
    uint64_t late = LATE_TIMES * usual;

    return c->now_ms - t->out_ms >= (late > LATE_MS ? late : LATE_MS);
}

/* May the worker have it?  A tile of which its child may have died goes to
 * another worker, if there is one. */
static bool
may_have(const struct coord *c, const struct job *job, const struct tile *t,
         uint32_t index)
{
    return !t->made && t->nholders < HOLDERS && !has_tile(t, index) &&
           (t->crashes == 0 || t->crasher != index ||
            !desk_others_may(c, job, job->workers[index].worker, false));
}

/* A tile that nobody has, else the one that is late for longest; NULL: there is
 * none. */
static struct tile *
choose(const struct coord *c, const struct job *job, uint32_t index)
{
    struct passes *s = job->passes;

    for (uint32_t i = s->next; i < s->ntiles; i++) {
        struct tile *t = &s->tile[s->order[i]];

        if (t->nholders == 0 && may_have(c, job, t, index))
            return t;
    }
    for (uint32_t i = s->oldest; i != NO_TILE; i = s->tile[i].then)
        if (!is_late(c, s, &s->tile[i]))
            break;
        else if (may_have(c, job, &s->tile[i], index))
            return &s->tile[i];
    return NULL;
}

static bool
has_room(const struct job *job, uint32_t index)
{
    const struct job_worker *jw = &job->workers[index];
    uint32_t n = jw->threads;
    bool few = job->passes->waiting <= job->speed.threads;

    return jw->worker->in_flight + jw->ntiles < (few ? n : n + (n + 1) / 2);
}

bool
tiles_has(const struct coord *c, const struct job *job, uint32_t index)
{
    return job->workers[index].ntiles > 0 || choose(c, job, index);
}

bool
tiles_give(struct coord *c, struct job *job, uint32_t index)
{
    struct job_worker *jw = &job->workers[index];
    struct passes *s = job->passes;
    struct msg m = { .type = MSG_TILE };
    struct tile *t;

    if (!records_up_to_date(job, jw) || !has_room(job, index) ||
        !(t = choose(c, job, index)))
        return false;
    if (t->nholders == 0)
        s->waiting--;
    else
        unlist(s, t);
    list_newest(s, t);
    t->holder[t->nholders++] = index;
    t->out_ms = c->now_ms;
    jw->ntiles++;
    while (s->next < s->ntiles && (s->tile[s->order[s->next]].nholders > 0 ||
                                   s->tile[s->order[s->next]].made))
        s->next++;
    if (job->first_ms == 0)
        job->first_ms = c->now_ms;
    if (job->state == JOB_WAITING)
        job->state = JOB_RUNNING;
    m.tile =
        (struct msg_tile){ job->id, passes_number(s), (uint32_t)(t - s->tile),
                           colours_wanted(job, &s->plan[s->open]) };
    actions_send(&c->actions, jw->worker->conn, &m);
    return true;
}

/* --- back --- */

bool
tiles_take(struct passes *s, struct tile *t, uint32_t index)
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
    if (t->place < s->next)
        s->next = t->place;
    return true;
}

void
tiles_lost(struct job *job, uint32_t index)
{
    struct passes *s = job->passes;

    job->workers[index].ntiles = 0;
    job->workers[index].lags = false;
    for (uint32_t i = s ? s->oldest : NO_TILE, then; i != NO_TILE; i = then) {
        then = s->tile[i].then;
        tiles_take(s, &s->tile[i], index);
    }
}

bool
tiles_crashed(struct coord *c, struct job *job, uint32_t index, const char *why)
{
    struct passes *s = job->passes;
    char text[MSG_MAX_TEXT + 1];

    for (uint32_t i = s ? s->oldest : NO_TILE; i != NO_TILE;
         i = s->tile[i].then) {
        struct tile *t = &s->tile[i];

        if (t->made || !has_tile(t, index))
            continue;
        if (t->crashes++ == 0)
            t->crasher = index;
        if (t->crashes == 1 ||
            (t->crasher == index && t->crashes < JOB_MAX_CRASHES))
            continue;
        snprintf(text, sizeof text,
                 "tile %u of pass %u, of the ambient cache, brought the "
                 "renderer down %u times: %.200s",
                 i, passes_number(s), t->crashes, why);
        verdict_job(c, job, JOB_FAILED, EX_SOFTWARE, text);
        return false;
    }
    return true;
}
