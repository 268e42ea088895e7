/* passes.c - see passes.h
 *
 * The open pass's tiles go out, the dearest first (dearest.h), a few more to
 * each worker than it has threads.  When none is left, those that are out for
 * long go to a second worker: a tile has the same records whoever makes it.
 * Meanwhile the records of tiles that are made travel to all workers, by way of
 * some of them (links/feeding.h). When all tiles are made the pass is closed,
 * and the next is open.  A worker gets nothing more before it has said that it
 * has all records of the pass; if it lacks some it gets all of them, in the
 * order of tiles.  So does a worker that comes later, of each pass that is
 * closed.  What a worker had and did not send is made again by others. The
 * first pass of a job that begins with a former job's records is closed from
 * the start; the store is asked for the records, and until they are here
 * nothing is sent to workers that lack them.
 * Frames come in batches (passes/passplan.h): the units of one go out when its
 * last pass is closed, and the first pass of the next batch is closed when they
 * are done, for that changes the cache that they read.  Its tiles go out before
 * that, to workers for which there are no units.
 * With a goal (stages.h) that is one stage: its last pass is a check pass,
 * whose tiles have sums in place of records.  When that is closed all begins
 * anew, with the next stage's plan, or the goal is reached.  Workers count
 * passes on through all stages. */
#include "config.h"

#include "sched/passes.h"

#include "desk/desk.h"
#include "desk/part.h"
#include "desk/progress.h"
#include "desk/speed.h"
#include "desk/verdict.h"
#include "links/feeding.h"
#include "machine/rowsum.h"
#include "machine/sums.h"
#include "passes/passcost.h"
#include "sched/stages.h"
#include "proto/ambshare.h"
#include "sched/colours.h"
#include "sched/dearest.h"
#include "sched/lead.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

/* A tile goes to a second worker when it is out for so many times what tiles
 * took so far, but no sooner than that. */
#define LATE_TIMES 3
#define LATE_MS    100

/* Records in a message. */
#define TOGETHER 1000
_Static_assert(TOGETHER *AMBSHARE_BYTES <= MSG_MAX_AMBIENT, "too many");

/* Records of a job, in bytes: when passes that are closed have half of it there
 * are no further ones, and one pass cannot have more. */
#define MOST_BYTES (512u << 20)

enum { HOLDERS = 2 };
#define NO_TILE UINT32_MAX

struct tile {
    uint32_t holder[HOLDERS]; /* workers that have it */
    uint8_t nholders;
    bool made;
    uint8_t crashes;       /* of children that had it */
    uint32_t crasher;      /* the first of their workers */
    uint64_t out_ms;       /* when it last went out */
    uint32_t place;        /* in the order in which they go out */
    uint32_t before, then; /* in the list of tiles that are out */
    uint8_t *records;      /* or sums */
    uint32_t n;            /* of them */
};

/* The records of a pass that is closed. */
struct closed {
    uint8_t *records;
    uint32_t n;
    uint64_t sum;             /* of their bytes */
    struct msg_counts counts; /* of its tiles that were the first */
};

struct passes {
    struct rad_pass *plan;
    double *weight; /* of each, passcost.h */
    uint32_t n;
    uint32_t base; /* passes of the stages before */
    uint32_t open; /* of the plan; n: all are closed */
    bool awaits;   /* the records of the first from the store, */
    bool asked;    /* which was asked for them */
    struct closed *closed; /* as many */
    uint32_t done;         /* frames before are done */
    size_t bytes;      /* of all records that are here */
    struct rad_pass_size *size; /* of the frames */
    struct dearest *dearest;
    struct tile *tile; /* of the open pass */
    uint32_t ntiles;
    uint32_t *order;  /* in which they go out */
    uint32_t next;    /* in that order; those before are out, or made */
    uint32_t oldest, newest; /* of the tiles that workers have, made by others
                              * or not: a list by when they went out */
    uint32_t left;    /* that are not made */
    uint32_t waiting; /* of these, that nobody has */
    uint64_t took_ms; /* of all that were made, from out to made */
    uint32_t ntook;
};

_Static_assert(RAD_MOST_PASSES <= MSG_MOST_PASSES, "as in READY");

/* --- the plan --- */

static void
drop_tiles(struct passes *s)
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

static void
drop_records(struct passes *s)
{
    for (uint32_t i = 0; s->closed && i < s->n; i++)
        free(s->closed[i].records);
    s->bytes = 0;
}

void
passes_free(struct passes *s)
{
    if (!s)
        return;
    drop_tiles(s);
    drop_records(s);
    free(s->plan);
    free(s->weight);
    free(s->closed);
    dearest_free(s->dearest);
    free(s->size);
    free(s);
}

/* Are the frames done that the passes before the open one were for? */
static bool
is_due(struct passes *s, const struct job *job)
{
    uint32_t ready = rad_passes_ready(s->plan, s->open);

    while (s->done < ready && job->frames[s->done].pixels_left == 0)
        s->done++;
    return s->done >= ready;
}

/* The units of frames whose passes are closed may go out. */
static void
open_frames(struct job *job)
{
    struct passes *s = job->passes;

    job->filling = s->open < s->n;
    if (s->n > 0 && job->partition) /* it may be over before it has units */
        partition_open(job->partition, rad_passes_ready(s->plan, s->open));
}

/* Passes that an earlier life of the coordinator closed are closed. */
static void
take_up(struct coord *c, struct job *job)
{
    struct kept_passes *kept = &job->kept;
    struct passes *s = job->passes;

    for (uint32_t i = s->base; i < kept->n && s->open < s->n && is_due(s, job);
         i++, s->open++) {
        struct saved_pass *p = &kept->pass[i];
        struct closed *k = &s->closed[s->open];

        if (!s->plan[s->open].check) {
            if (p->len % AMBSHARE_BYTES != 0)
                break;
            k->records = (uint8_t *)p->bytes;
            k->n = (uint32_t)(p->len / AMBSHARE_BYTES);
            if (k->records)
                k->sum = rowsum_hash(k->records, p->len);
            s->bytes += p->len;
            p->bytes = NULL;
        }
        k->counts = p->counts;
        msg_counts_add(&job->tiled, &p->counts);
    }
    if (s->open > 0 && job->spec.flags & MSG_JOB_REUSE)
        job->cache.reused = s->closed[0].n;
    if (s->open > 0)
        actions_log(&c->actions, ACT_INFO, "passes kept job=%s passes=%u of=%u",
                    job->hex, s->open, s->n);
    kept_drop(kept);
}

static bool
open_pass(struct passes *s)
{
    drop_tiles(s);
    for (uint32_t i = s->open; s->bytes > MOST_BYTES / 2 && i < s->n; i++)
        if (!s->plan[i].check)
            s->plan[i].tiles = 0;
    if (s->open == s->n)
        return true;
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

static void close_whole(struct coord *c, struct job *job);

void
passes_ask(struct coord *c, struct job *job)
{
    struct passes *s = job->passes;
    struct action *a;

    if (!s || !s->awaits || s->asked || job->stage != STAGE_OPEN ||
        job_over(job))
        return;
    a = actions_add_job(&c->actions, ACT_LOAD_CACHE, 0, job->id);
    if (a)
        a->sequence = job->sequence;
    s->asked = true;
}

/* Without the first pass, where that is awaited, it is not known how many bytes
 * the others may have. */
static bool
is_at_start(const struct passes *s)
{
    return s->awaits && s->open == 0;
}

/* Memory for the plan, and the plan. */
static int
plan_in(struct passes *s, const struct job *job, struct rad_error *err)
{
    struct rad_pass *plan;
    int rc;

    free(s->plan);
    free(s->weight);
    free(s->closed);
    s->weight = NULL;
    s->closed = NULL;
    s->plan = malloc(RAD_MOST_PASSES * sizeof *s->plan);
    if (!s->plan)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    rc = stages_plan(job, s->size, s->plan, &s->n, err);
    if (rc < 0)
        return rc;
    plan = realloc(s->plan, (s->n + 1) * sizeof *plan);
    s->plan = plan ? plan : s->plan;
    s->weight = calloc(s->n + 1, sizeof *s->weight);
    s->closed = calloc(s->n + 1, sizeof *s->closed);
    return s->weight && s->closed ? 0
                                  : rad_fail(err, RAD_ENOMEM, "out of memory");
}

/* Lay out the passes of the job's stage, of which none is closed. */
static int
plan_stage(struct job *job, struct rad_error *err)
{
    struct passes *s = job->passes;
    int rc = plan_in(s, job, err);

    s->base = job->goal.base;
    s->open = 0;
    for (uint32_t i = 0; rc == 0 && i < s->n; i++)
        if (s->plan[i].tiles > MSG_MOST_TILES)
            rc = rad_fail(err, RAD_EDATA,
                          "so many and large frames are too much for "
                          "--ambient=passes: a pass would have %u tiles, at "
                          "most %u are allowed",
                          s->plan[i].tiles, MSG_MOST_TILES);
    if (rc == 0 && s->base + s->n > MSG_MOST_PASSES)
        rc =
            rad_fail(err, RAD_EDATA,
                     "so many frames are too much for a goal: its stages would "
                     "have more than %u passes",
                     MSG_MOST_PASSES);
    if (rc == 0)
        rad_passcost_weigh(s->plan, s->n, s->weight);
    return rc;
}

/* How far the passes are: of the open one its tiles tell. */
static void
note_progress(struct job *job)
{
    const struct passes *s = job->passes;
    double all = 0, done = 0;

    for (uint32_t i = 0; i < s->n; i++) {
        all += s->weight[i];
        done += i < s->open ? s->weight[i] : 0;
    }
    if (s->ntiles > 0)
        done += s->weight[s->open] * (s->ntiles - s->left) / s->ntiles;
    lead_note(job, all > 0 ? done / all : 1, s->open == s->n);
}

int
passes_begin(struct coord *c, struct job *job, struct rad_error *err)
{
    struct passes *s;
    int rc;

    if (!(job->spec.flags & MSG_JOB_PASSES))
        return 0;
    s = job->passes = calloc(1, sizeof *s);
    if (!s || !(s->size = stages_sizes(&job->spec)) ||
        !(s->dearest = dearest_new(s->size, job->spec.nframes)))
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    rc = plan_stage(job, err);
    if (rc < 0)
        return rc;
    lead_begin(job, s->size);
    take_up(c, job);
    open_frames(job);
    s->awaits = s->n > 0 && job->spec.flags & MSG_JOB_REUSE;
    passes_ask(c, job);
    if (is_at_start(s)) {
        drop_tiles(s);
        return 0;
    }
    if (!open_pass(s))
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    close_whole(c, job);
    note_progress(job);
    return 0;
}

bool
passes_open(const struct job *job)
{
    struct passes *s = job->passes;

    return s && ((s->open < s->n && is_due(s, job)) || s->awaits);
}

struct passes_state
passes_state(const struct job *job)
{
    const struct passes *s = job->passes;
    struct passes_state out = { 0 };

    if (!s)
        return out;
    out.open = s->open;
    out.n = s->n;
    out.bytes = s->bytes;
    out.checks = s->open < s->n && s->plan[s->open].check;
    if (s->ntiles > 0)
        out.made = 1 - (double)s->left / s->ntiles;
    return out;
}

/* --- records --- */

/* Call send() for each FROZEN of a pass that is closed. */
static void
send_closed(struct coord *c, const struct job *job, uint32_t pass,
            void (*send)(struct coord *c, const struct job *job,
                         const struct msg *m, void *arg),
            void *arg)
{
    const struct closed *k = &job->passes->closed[pass];
    struct msg m = { .type = MSG_FROZEN };
    uint32_t at = 0, n;

    do {
        n = k->n - at < TOGETHER ? k->n - at : TOGETHER;
        m.frozen = (struct msg_frozen){ .job = job->id,
                                        .pass = job->passes->base + pass,
                                        .first = at,
                                        .last = at + n == k->n,
                                        .count = n,
                                        .data = k->records +
                                                (size_t)at * AMBSHARE_BYTES,
                                        .len = (size_t)n * AMBSHARE_BYTES };
        send(c, job, &m, arg);
        at += n;
    } while (at < k->n);
}

static void
send_to_one(struct coord *c, const struct job *job, const struct msg *m,
            void *arg)
{
    struct coord_worker *w = arg;

    (void)job;
    actions_send(&c->actions, w->conn, m);
}

/* The number of the open pass, through all stages. */
static uint32_t
open_number(const struct passes *s)
{
    return s->base + s->open;
}

/* Has the worker the records of all passes before the open one? */
static bool
is_up_to_date(const struct job *job, const struct job_worker *jw)
{
    return jw->state == PART_READY && jw->worker->conn != 0 &&
           jw->passes == open_number(job->passes) && !jw->lags;
}

static struct msg
stage_of(const struct job *job)
{
    return (struct msg){ .type = MSG_STAGE,
                         .stage = { job->id, job->passes->base,
                                    goal_options(job) } };
}

/* A frame to each worker that the function chooses. */
static void
send_some(struct coord *c, const struct job *job, const struct msg *m,
          bool (*wanted)(const struct job *job, uint32_t index))
{
    struct wire_out *out = &c->actions.scratch;
    uint8_t *kept;

    out->len = 0;
    if (msg_pack(out, m) != 0 ||
        !(kept = actions_keep(&c->actions, out->buf, out->len))) {
        c->actions.failed = true;
        return;
    }
    for (uint32_t i = 0; i < job->nworkers; i++)
        if (wanted(job, i))
            actions_send_kept(&c->actions, job->workers[i].worker->conn, kept,
                              out->len);
}

static struct msg
records_of(const struct job *job, uint32_t tile)
{
    const struct tile *t = &job->passes->tile[tile];
    size_t len = (size_t)t->n * AMBSHARE_BYTES;

    return (struct msg){ .type = MSG_TILE_RECORDS,
                         .tile_records = { job->id, open_number(job->passes),
                                           tile, t->n, t->records, len } };
}

/* Records of the open pass that are there already, to a worker that comes. */
static void
send_made(struct coord *c, const struct job *job, const struct coord_worker *w)
{
    const struct passes *s = job->passes;

    for (uint32_t i = 0; i < s->ntiles; i++)
        if (s->tile[i].made && s->tile[i].n > 0) {
            struct msg m = records_of(job, i);

            actions_send(&c->actions, w->conn, &m);
        }
}

/* The worker is asked whether it has the records of the pass after those that
 * it has. */
static void
ask(struct coord *c, const struct job *job, struct job_worker *jw)
{
    const struct passes *s = job->passes;
    const struct closed *k = &s->closed[jw->passes - s->base];
    struct msg m = { .type = MSG_CLOSED,
                     .closed = { job->id, jw->passes, k->n, k->sum } };

    jw->lags = true;
    actions_send(&c->actions, jw->worker->conn, &m);
}

/* To whoever keeps them (-af). */
static void
send_records(struct coord *c, const struct job *job, const struct msg *m,
             void *arg)
{
    (void)arg;
    if (m->frozen.count > 0)
        desk_send_records(c, job,
                          &(struct msg_records){ job->id, m->frozen.count,
                                                 m->frozen.data,
                                                 m->frozen.len });
}

/* Send a worker the records that it lacks, if they are here. */
static void
catch_up(struct coord *c, const struct job *job, struct job_worker *jw)
{
    const struct passes *s = job->passes;

    if (!s || (s->awaits && jw->passes == 0))
        return;
    if (jw->passes < s->base) {
        struct msg m = stage_of(job);

        actions_send(&c->actions, jw->worker->conn, &m);
        jw->passes = s->base;
    }
    for (; jw->passes < open_number(s); jw->passes++)
        send_closed(c, job, jw->passes - s->base, send_to_one, jw->worker);
    if (job->filling)
        send_made(c, job, jw->worker);
}

/* By the clock another stage may have begun in an earlier life. */
static bool
may_differ(const struct job *job, const struct job_worker *jw, uint32_t have)
{
    return job->spec.time_ms > 0 && have > jw->passes;
}

bool
passes_ready(struct coord *c, struct job *job, uint32_t index, uint32_t have)
{
    struct job_worker *jw = &job->workers[index];
    struct passes *s = job->passes;
    uint32_t closed = s ? open_number(s) : 0;

    if (have > closed || may_differ(job, jw, have))
        return false;
    jw->passes = have;
    jw->lags = false;
    jw->ntiles = 0;
    catch_up(c, job, jw);
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
passes_has(const struct coord *c, const struct job *job, uint32_t index)
{
    return job->workers[index].ntiles > 0 || choose(c, job, index);
}

bool
passes_give(struct coord *c, struct job *job, uint32_t index)
{
    struct job_worker *jw = &job->workers[index];
    struct passes *s = job->passes;
    struct msg m = { .type = MSG_TILE };
    struct tile *t;

    if (!is_up_to_date(job, jw) || !has_room(job, index) ||
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
    while (s->next < s->ntiles &&
           (s->tile[s->order[s->next]].nholders > 0 ||
            s->tile[s->order[s->next]].made))
        s->next++;
    if (job->first_ms == 0)
        job->first_ms = c->now_ms;
    if (job->state == JOB_WAITING)
        job->state = JOB_RUNNING;
    m.tile =
        (struct msg_tile){ job->id, open_number(s), (uint32_t)(t - s->tile),
                           colours_wanted(job, &s->plan[s->open]) };
    actions_send(&c->actions, jw->worker->conn, &m);
    return true;
}

/* --- back --- */

static void
drop_holder(struct passes *s, struct tile *t, uint32_t index)
{
    if (!has_tile(t, index))
        return;
    for (uint8_t i = 0; i < t->nholders; i++)
        if (t->holder[i] == index)
            t->holder[i--] = t->holder[--t->nholders];
    if (t->nholders > 0)
        return;
    unlist(s, t);
    if (t->made)
        return;
    s->waiting++;
    if (t->place < s->next)
        s->next = t->place;
}

void
passes_lost(struct job *job, uint32_t index)
{
    struct passes *s = job->passes;

    job->workers[index].ntiles = 0;
    job->workers[index].lags = false;
    for (uint32_t i = s ? s->oldest : NO_TILE, then; i != NO_TILE; i = then) {
        then = s->tile[i].then;
        drop_holder(s, &s->tile[i], index);
    }
}

bool
passes_crashed(struct coord *c, struct job *job, uint32_t index,
               const char *why)
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
                 i, open_number(s), t->crashes, why);
        verdict_job(c, job, JOB_FAILED, EX_SOFTWARE, text);
        return false;
    }
    return true;
}

/* All records of the open pass, in the order of tiles. */
static bool
gather(struct passes *s)
{
    struct closed *k = &s->closed[s->open];
    uint8_t *to;

    for (uint32_t i = 0; i < s->ntiles; i++)
        k->n += s->tile[i].n;
    k->records = to = malloc((size_t)k->n * AMBSHARE_BYTES + 1);
    for (uint32_t i = 0; to && i < s->ntiles; i++) {
        size_t len = (size_t)s->tile[i].n * AMBSHARE_BYTES;

        if (len > 0)
            memcpy(to, s->tile[i].records, len);
        to += len;
    }
    if (!to)
        return false;
    k->sum = rowsum_hash(k->records, (size_t)k->n * AMBSHARE_BYTES);
    return true;
}

/* Keep that pass, of the plan that is closed with these bytes, to go on from
 * after a restart. */
static void
keep_closed(struct coord *c, const struct job *job, uint32_t pass,
            const struct msg_counts *counts, const uint8_t *bytes, size_t len,
            bool firm)
{
    struct saved_pass saved = { .len = len, .counts = *counts, .firm = firm };
    struct action *a;

    if (!c->env.keeps ||
        !(a = actions_add_job(&c->actions, ACT_PUT_PASS, 0, job->id)))
        return;
    saved.bytes = actions_keep(&c->actions, bytes, len);
    a->frame = pass;
    a->pass = rad_arena_dup(&c->actions.mem, &saved, sizeof saved);
    if (!saved.bytes || !a->pass)
        c->actions.failed = true;
}

static bool
is_there(const struct job *job, uint32_t index)
{
    const struct job_worker *jw = &job->workers[index];

    return jw->state == PART_READY && jw->worker->conn != 0;
}

/* The job's goal is not reached: drop the records, and begin anew with the next
 * stage's options, whichever pass of this one workers are at. */
static void
begin_stage(struct coord *c, struct job *job)
{
    struct passes *s = job->passes;
    struct rad_error err = { 0 };
    struct msg m;

    drop_tiles(s);
    drop_records(s);
    if (plan_stage(job, &err) < 0) {
        verdict_job(c, job, JOB_FAILED, rad_exit_status(err.code), err.what);
        s->n = 0;
        return;
    }
    for (uint32_t i = 0; i < job->nworkers; i++) {
        struct job_worker *jw = &job->workers[i];

        jw->ntiles = 0;
        jw->passes = is_there(job, i) ? s->base : 0;
        jw->lags = false;
    }
    m = stage_of(job);
    send_some(c, job, &m, is_there);
    if (!open_pass(s))
        c->actions.failed = true;
    c->stirred = true;
}

/* All tiles of the check pass, the open one, are made; false: another stage
 * begins. */
static bool
close_check(struct coord *c, struct job *job)
{
    struct passes *s = job->passes;
    struct msg_counts counts = s->closed[s->open].counts;
    uint32_t number = open_number(s);
    struct rad_refine_sums all = { 0 }, of;
    uint8_t bytes[STAGES_BYTES];
    uint64_t rays = 0;
    bool reached;

    for (uint32_t i = 0; i < s->ntiles; i++) {
        if (sums_unpack(s->tile[i].records, SUMS_BYTES, &of))
            rad_refine_add(&all, &of);
        s->tile[i].n = 0;
    }
    for (uint32_t i = 0; i < s->open; i++)
        rays += s->closed[i].counts.rays;
    reached = stages_end(c, job, s->n, rays, &all);
    stages_pack(c, job, bytes);
    keep_closed(c, job, number, &counts, bytes, sizeof bytes, true);
    if (!reached && !c->actions.failed)
        begin_stage(c, job);
    return reached;
}

static void
close_pass(struct coord *c, struct job *job)
{
    struct passes *s = job->passes;
    struct closed *k = &s->closed[s->open];
    bool checks = s->plan[s->open].check;

    if (checks && !close_check(c, job))
        return;
    if (!gather(s)) {
        c->actions.failed = true;
        return;
    }
    if (!checks)
        keep_closed(c, job, open_number(s), &k->counts, k->records,
                    (size_t)k->n * AMBSHARE_BYTES, false);
    colours_close(job, &s->plan[s->open]);
    if (job->spec.flags & MSG_JOB_RECORDS)
        send_closed(c, job, s->open, send_records, NULL);
    for (uint32_t i = 0; i < job->nworkers; i++) {
        struct job_worker *jw = &job->workers[i];

        jw->ntiles = 0;
        if (is_up_to_date(job, jw))
            ask(c, job, jw);
    }
    actions_log(&c->actions, ACT_DEBUG,
                "pass closed job=%s pass=%u level=%d step=%d tiles=%u "
                "records=%u",
                job->hex, open_number(s), s->plan[s->open].level,
                s->plan[s->open].step, s->ntiles, k->n);
    s->open++;
    open_frames(job);
    if (!open_pass(s))
        c->actions.failed = true;
    c->stirred = true;
}

/* Passes without tiles are closed at once. */
static void
close_whole(struct coord *c, struct job *job)
{
    struct passes *s = job->passes;

    while (s->open < s->n && s->left == 0 && is_due(s, job) &&
           !c->actions.failed)
        close_pass(c, job);
}

/* No unit went out yet if `none_out`: the first go out when the first frames'
 * passes are closed. */
static void
close_passes(struct coord *c, struct job *job, bool none_out)
{
    close_whole(c, job);
    if (none_out && !passes_open(job) && !job->survey)
        speed_share(c, job);
}

static bool
is_before_units(const struct passes *s)
{
    return rad_passes_ready(s->plan, s->open) == 0;
}

void
passes_frame_done(struct coord *c, struct job *job)
{
    if (!job->filling || job_over(job))
        return;
    close_passes(c, job, is_before_units(job->passes));
    note_progress(job);
    c->stirred = true;
}

static bool
keep(struct coord *c, struct job *job, struct tile *t,
     const struct msg_tile_made *m)
{
    struct passes *s = job->passes;

    t->records = malloc(m->len + 1);
    if (!t->records) {
        c->actions.failed = true;
        return false;
    }
    if (m->len > 0)
        memcpy(t->records, m->data, m->len);
    t->n = m->count;
    s->waiting -= t->nholders == 0; /* its worker was thought lost */
    t->made = true;
    s->bytes += m->len;
    s->took_ms += c->now_ms - t->out_ms;
    s->ntook++;
    s->left--;
    return true;
}

static void
count(struct job *job, uint32_t index, const struct msg_counts *counts)
{
    struct passes *s = job->passes;

    msg_counts_add(&s->closed[s->open].counts, counts);
    msg_counts_add(&job->tiled, counts);
    job->workers[index].surveyed_rays += counts->rays;
    job->rays += counts->rays;
    progress_see(job);
}

/* Has the message what tiles of the open pass have? */
static bool
is_sound(const struct passes *s, const struct msg_tile_made *m)
{
    struct rad_refine_sums sums;

    return s->plan[s->open].check
               ? m->count == 0 && sums_unpack(m->data, m->len, &sums)
               : m->len == (size_t)m->count * AMBSHARE_BYTES;
}

void
passes_held(struct coord *c, struct coord_worker *w, const struct msg *msg)
{
    const struct msg_holds *m = &msg->holds;
    uint32_t index;
    struct job *job = desk_job_of(c, w, m->job, &index);
    struct job_worker *jw = job ? &job->workers[index] : NULL;

    if (!jw || !job->passes || !jw->lags || m->pass != jw->passes)
        return;
    if (!m->whole) {
        feeding_lacked(c, job, index);
        send_closed(c, job, m->pass - job->passes->base, send_to_one, w);
    }
    jw->passes++;
    jw->lags = false;
    if (jw->passes < open_number(job->passes))
        ask(c, job, jw);
    c->stirred = true;
}

void
passes_made(struct coord *c, struct coord_worker *w, const struct msg *msg)
{
    const struct msg_tile_made *m = &msg->tile_made;
    uint32_t index;
    struct job *job = desk_job_of(c, w, m->job, &index);
    struct passes *s = job ? job->passes : NULL;
    struct tile *t;
    bool is_open;

    if (!s)
        return;
    is_open = m->pass == open_number(s) && s->open < s->n;
    if (m->pass > open_number(s) || (is_open && m->tile >= s->ntiles) ||
        s->bytes + m->len > MOST_BYTES ||
        (is_open &&
         !colours_fit(job, &s->plan[s->open], m->tile, m->colours_len))) {
        verdict_break(c, w->conn, "a TILE_MADE that fits no tile");
        return;
    }
    if (is_open && !is_sound(s, m)) {
        verdict_break(c, w->conn,
                      s->plan[s->open].check
                          ? "sums of a tile that are no finite numbers"
                          : "a TILE_MADE whose records have not their size");
        return;
    }
    t = is_open ? &s->tile[m->tile] : NULL;
    if (t && has_tile(t, index)) {
        drop_holder(s, t, index);
        job->workers[index].ntiles--;
        c->stirred = true;
    }
    if (!t || t->made) { /* another was first */
        msg_counts_add(&job->workers[index].past.dropped, &m->counts);
        return;
    }
    if (!keep(c, job, t, m))
        return;
    if (t->n > 0) {
        struct msg records = records_of(job, m->tile);

        send_some(c, job, &records, feeding_is_direct);
    }
    count(job, index, &m->counts);
    dearest_note(s->dearest, &s->plan[s->open], m->tile, m->counts.rays);
    colours_keep(c, job, &s->plan[s->open], m);
    close_passes(c, job, is_before_units(job->passes));
    note_progress(job);
}

/* --- from a former job --- */

void
passes_came(struct coord *c, struct job *job, uint8_t *records, size_t n,
            int status, const char *text)
{
    struct passes *s = job->passes;

    if (!s || !s->awaits || status != 0 || n % AMBSHARE_BYTES != 0) {
        free(records);
        if (s && s->awaits)
            verdict_job(c, job, JOB_FAILED, status ? status : EX_DATAERR,
                        status ? text : "no ambient records");
        return;
    }
    s->awaits = false;
    s->closed[0].records = records;
    s->closed[0].n = (uint32_t)(n / AMBSHARE_BYTES);
    job->cache.reused = s->closed[0].n;
    if (s->open == 0) {
        s->open = 1;
        s->bytes = n;
        if (!open_pass(s))
            c->actions.failed = true;
        if (job->spec.flags & MSG_JOB_RECORDS)
            send_closed(c, job, 0, send_records, NULL);
    }
    for (uint32_t i = 0; i < job->nworkers; i++)
        if (job->workers[i].state == PART_READY &&
            job->workers[i].worker->conn != 0 && job->workers[i].passes == 0)
            catch_up(c, job, &job->workers[i]);
    close_passes(c, job, true);
    c->stirred = true;
}
