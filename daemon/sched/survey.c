/* survey.c - see survey.h
 *
 * With --estimate=NNa or NNb workers trace NN random pixels of each area (a
 * line or a window) before the first unit goes out, and count rays (a) or
 * intersection tests (b).  Areas go out in chunks; when all have gone out, a
 * chunk that is not answered in time goes to another worker, too.  The pixels
 * follow from the area, so the costs do not depend on which worker answers
 * first.  If two children die of a chunk the estimate is given up: units will
 * tell which pixel it was.  A chunk takes seconds, so a worker ends it whatever
 * comes first by then. */
#include "config.h"

#include "sched/survey.h"

#include "desk/desk.h"
#include "desk/holding.h"
#include "desk/speed.h"
#include "desk/verdict.h"
#include "jobs/part.h"

#include <stdlib.h>
#include <string.h>

#define MOST_RAYS       10000
#define MOST_PARTS      40000 /* of a chunk, which must fit a message */
#define CHUNKS_A_WORKER 4
#define MOST_CRASHES    2    /* children that may die of a chunk */
#define LATE_MS         2000 /* then a chunk goes to another worker, too */

struct chunk {
    uint32_t first, n; /* areas [first, first + n) */
    uint32_t holders, crashes;
    bool done;
    uint64_t out_ms; /* when it last went to a worker */
};

struct survey {
    uint32_t rays;          /* pixels to trace of each area */
    bool tests;             /* costs are intersection tests, else rays */
    bool failed;            /* the estimate is given up */
    uint32_t nchunks, left; /* left: chunks that are not done */
    struct chunk *chunk;
    double *cost;      /* of each area */
    uint64_t begin_ms; /* when the first ESTIMATE was sent; 0: not yet */
};

/* Does the text ask for a survey, as "5a" and "20b" do? */
static bool
wanted(const char *text, uint32_t *rays, bool *tests)
{
    char *end;
    unsigned long n = strtoul(text, &end, 10);

    if (text[0] < '0' || text[0] > '9' || n < 1 || n > MOST_RAYS ||
        (strcmp(end, "a") != 0 && strcmp(end, "b") != 0))
        return false;
    *rays = (uint32_t)n;
    *tests = *end == 'b';
    return true;
}

void
survey_free(struct survey *s)
{
    if (!s)
        return;
    free(s->chunk);
    free(s->cost);
    free(s);
}

int
survey_begin(struct job *job, uint32_t workers, struct rad_error *err)
{
    uint32_t rays, n = partition_areas(job->partition), size;
    struct survey *s;
    bool tests;

    if (job->spec.ncosts > 0 || !wanted(job->spec.estimate, &rays, &tests))
        return 0;
    size = n / (CHUNKS_A_WORKER * (workers ? workers : 1));
    size = size < 1 ? 1 : size > MOST_PARTS ? MOST_PARTS : size;
    job->survey = s = calloc(1, sizeof *s);
    if (!s)
        return rad_fail_memory(err);
    s->rays = rays;
    s->tests = tests;
    s->nchunks = s->left = (n + size - 1) / size;
    s->chunk = calloc(s->nchunks, sizeof *s->chunk);
    s->cost = calloc(n, sizeof *s->cost);
    if (!s->chunk || !s->cost)
        return rad_fail_memory(err);
    for (uint32_t i = 0; i < s->nchunks; i++) {
        s->chunk[i].first = i * size;
        s->chunk[i].n = n - i * size < size ? n - i * size : size;
    }
    return 0;
}

/* --- out --- */

/* A chunk that no worker has, else a late chunk; NULL: neither. */
static struct chunk *
choose(struct survey *s, uint64_t now_ms)
{
    struct chunk *late = NULL;

    for (uint32_t i = 0; i < s->nchunks; i++) {
        struct chunk *k = &s->chunk[i];

        if (!k->done && k->holders == 0)
            return k;
        if (!k->done && now_ms - k->out_ms >= LATE_MS)
            late = k;
    }
    return late;
}

static void
send_chunk(struct coord *c, const struct job *job, const struct job_part *part,
           const struct chunk *k)
{
    const struct survey *s = job->survey;
    struct msg_area *v = rad_arena_alloc(&c->actions.mem, k->n * sizeof *v);
    struct msg m = { .type = MSG_ESTIMATE };

    if (!v) {
        c->actions.failed = true;
        return;
    }
    for (uint32_t i = 0; i < k->n; i++) {
        struct partition_area a;

        partition_nth_area(job->partition, k->first + i, &a);
        v[i] = (struct msg_area){ a.frame, a.x, a.y, a.width, a.height };
    }
    m.estimate = (struct msg_estimate){ job->id, (uint32_t)(k - s->chunk),
                                        s->rays, k->n, v };
    actions_send(&c->actions, part->worker->conn, &m);
}

void
survey_end(struct job *job)
{
    survey_free(job->survey);
    job->survey = NULL;
    for (uint32_t i = 0; i < job->nparts; i++)
        holding_survey(job, i, 0);
}

/* Let units go out, by the costs that are known. */
static void
let_units_go(struct coord *c, struct job *job)
{
    job->estimate_ms = c->now_ms - job->survey->begin_ms;
    survey_end(job);
    speed_share(c, job);
}

bool
survey_has(const struct coord *c, const struct job *job, uint32_t index)
{
    return job->parts[index].surveying || job->survey->failed ||
           choose(job->survey, c->now_ms);
}

bool
survey_give(struct coord *c, struct job *job, uint32_t index)
{
    struct job_part *part = &job->parts[index];
    struct survey *s = job->survey;
    struct chunk *k;

    if (s->failed) { /* ended here, where units can go out */
        let_units_go(c, job);
        return true;
    }
    k = part->surveying ? NULL : choose(s, c->now_ms);
    if (!k)
        return false;
    k->holders++;
    k->out_ms = c->now_ms;
    holding_survey(job, index, (uint32_t)(k - s->chunk) + 1);
    if (s->begin_ms == 0)
        s->begin_ms = c->now_ms;
    life_set_running(job);
    send_chunk(c, job, part, k);
    return true;
}

void
survey_lost(struct job *job, uint32_t index)
{
    const struct job_part *part = &job->parts[index];

    if (job->survey && part->surveying)
        job->survey->chunk[part->surveying - 1].holders--;
    holding_survey(job, index, 0);
}

/* --- back --- */

void
survey_crashed(struct coord *c, struct job *job, uint32_t chunk)
{
    if (!job->survey || ++job->survey->chunk[chunk].crashes < MOST_CRASHES)
        return;
    actions_log(&c->actions, ACT_WARN, "estimate given up job=%s", job->hex);
    job->survey->failed = true;
}

/* The cost of an area, scaled from its traced pixels to all. */
static double
scaled(const struct survey *s, const struct job *job, uint32_t area,
       const struct msg_cost *cost)
{
    struct partition_area a;
    double pixels, traced = s->rays;

    partition_nth_area(job->partition, area, &a);
    pixels = (double)a.width * a.height;
    if (traced > pixels)
        traced = pixels;
    return (double)(s->tests ? cost->tests : cost->rays) * pixels / traced;
}

static void
use_costs(struct coord *c, struct job *job)
{
    partition_set_costs(job->partition, job->survey->cost);
    job->cost_total = partition_cost_total(job->partition);
    let_units_go(c, job);
    actions_log(&c->actions, ACT_INFO, "job estimated job=%s ms=%llu", job->hex,
                (unsigned long long)job->estimate_ms);
}

static void
count_rays(struct job *job, uint32_t index, const struct msg_counts *counts)
{
    msg_rays_add(&job->surveyed, counts);
    job->parts[index].surveyed_rays += counts->rays;
}

void
survey_estimated(struct coord *c, struct coord_worker *w, const struct msg *msg)
{
    const struct msg_estimated *m = &msg->estimated;
    uint32_t index;
    struct job *job = desk_job_of(c, w, m->job, &index);
    const struct job_part *part;
    struct chunk *k;

    if (!job)
        return;
    part = &job->parts[index];
    if (!job->survey || part->surveying == 0 || part->surveying - 1 != m->id) {
        count_rays(job, index, &m->counts); /* late: only its rays count */
        return;
    }
    k = &job->survey->chunk[m->id];
    if (m->ncosts != k->n) {
        verdict_break(c, w->conn, "an ESTIMATED that fits no ESTIMATE");
        return;
    }
    survey_lost(job, index);
    count_rays(job, index, &m->counts);
    if (k->done)
        return;
    for (uint32_t i = 0; i < k->n; i++)
        job->survey->cost[k->first + i] =
            scaled(job->survey, job, k->first + i, &m->costs[i]);
    k->done = true;
    if (--job->survey->left == 0)
        use_costs(c, job);
}
