/* stages.c - see stages.h */
#include "config.h"

#include "filling/stages.h"

#include "jobs/progress.h"
#include "machine/jobtext.h"
#include "proto/wire.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct rad_pass_size *
stages_sizes(const struct msg_spec *spec)
{
    struct rad_pass_size *size = malloc(spec->nframes * sizeof *size);

    for (uint32_t i = 0; size && i < spec->nframes; i++)
        size[i] = (struct rad_pass_size){ (int)spec->frames[i].width,
                                          (int)spec->frames[i].height };
    return size;
}

/* Rungs in a byte: whole rungs, and in the upper bits quarters of a rung. */
enum { WHOLE = 63, QUARTERS = 6 };

static uint8_t
pack_rung(uint8_t rung)
{
    return (uint8_t)(rung / RAD_REFINE_RUNG | rung % RAD_REFINE_RUNG
                                                  << QUARTERS);
}

static uint8_t
unpack_rung(uint8_t packed)
{
    return (uint8_t)((packed & WHOLE) * RAD_REFINE_RUNG + (packed >> QUARTERS));
}

static struct rad_refine_rungs
unpack_rungs(const uint8_t packed[2])
{
    return (struct rad_refine_rungs){ unpack_rung(packed[0]),
                                      unpack_rung(packed[1]) };
}

int
stages_params(const struct job *job, struct rad_params *out,
              struct rad_error *err)
{
    struct rad_refine_rungs rungs = unpack_rungs(job->goal.rungs);
    struct rad_params params;
    int rc = jobtext_params(job->spec.params, &params, err);

    if (rc == 0)
        rad_refine_params(&params, rungs, out);
    return rc;
}

bool
stages_reuse(const struct job *job)
{
    return job->spec.flags & MSG_JOB_REUSE && job->goal.number == 0;
}

bool
stages_are_all(const struct job *job)
{
    return job->goal.number + 1 >= RAD_REFINE_STAGES;
}

int
stages_plan(const struct job *job, const struct rad_pass_size *size,
            struct rad_pass plan[RAD_MOST_PASSES], uint32_t *n,
            struct rad_error *err)
{
    struct rad_params params;
    int rc = stages_params(job, &params, err);

    if (rc < 0)
        return rc;
    *n = rad_refine_plan(&params, size, job->spec.nframes, stages_reuse(job),
                         msg_has_goal(&job->spec), plan);
    return 0;
}

/* --- decisions --- */

/* Set goal.options to the text of the options at the goal's rungs; false:
 * memory is out. */
static bool
set_options(struct job *job)
{
    struct rad_params params;
    char text[RAD_PARAMS_TEXT];

    if (stages_params(job, &params, NULL) != 0)
        return false; /* cannot be: the options were read before */
    rad_params_format(&params, text, sizeof text);
    job->goal.options = rad_arena_dup(&job->mem, text, strlen(text) + 1);
    return job->goal.options != NULL;
}

/* About how many rays the records took that the stage got from another job: a
 * further stage begins with an empty cache and has to make such records, too.
 */
static uint64_t
reused_rays(const struct job *job)
{
    struct rad_params p;

    if (!stages_reuse(job) || stages_params(job, &p, NULL) != 0)
        return 0;
    return job->cache.reused * ((uint64_t)p.ambdiv + (uint64_t)p.ambssamp);
}

/* Seconds by the clock for a ray of a pass that took cpu_s processor seconds
 * and so many rays, while `busy` processors were at work. */
static double
seconds_a_ray(double cpu_s, uint64_t rays, double busy)
{
    return rays > 0 && busy > 0 ? cpu_s / (double)rays / busy : 0;
}

/* Fill in the times of the question.  The time of passes that an earlier life
 * of the coordinator closed is not known, so a stage is taken to have lasted at
 * least its processor time divided by the number of threads now. */
static void
note_clock(const struct job *job, const struct stage_found *found, double spent,
           struct rad_refine_ask *ask)
{
    double cpu_s = found->rays_s + found->check_s;
    double begun_s = job->goal.begun_s, stage_s = spent - begun_s, busy;

    if (job->speed.threads > 0)
        stage_s = fmax(stage_s, cpu_s / job->speed.threads);
    busy = stage_s > 0 ? cpu_s / stage_s : 0;
    ask->left_s = fmax(job->spec.time_ms / 1e3 - begun_s - stage_s, 0);
    ask->look_s = seconds_a_ray(found->check_s, found->check, busy);
    ask->pass_s = found->rays > 0
                      ? seconds_a_ray(found->rays_s, found->rays, busy)
                      : ask->look_s; /* all records are another job's */
}

/* Rays of a pixel by the job's own options. */
static int
own_samples(const struct job *job)
{
    struct rad_params p;

    return jobtext_params(job->spec.params, &p, NULL) == 0 ? p.samples : 1;
}

/* The question that rad_refine_next() decides; it has a copy of the sums. */
static struct rad_refine_ask
make_ask(const struct coord *c, const struct job *job,
         const struct stage_found *found)
{
    const struct job_goal *g = &job->goal;
    struct rad_refine_ask ask = {
        .error = job->spec.error_ppm / 1e6,
        .stage = g->number,
        .rungs = unpack_rungs(g->rungs),
        .sums = found->sums,
        .past = g->past,
        .rays = found->rays + reused_rays(job),
        .check = found->check,
        .samples = own_samples(job),
        .left_s = INFINITY,
    };

    if (job->spec.time_ms > 0)
        note_clock(job, found, goal_spent_s(job, c->now_ms), &ask);
    for (uint32_t i = 0; i < job->spec.nframes; i++)
        ask.pixels +=
            (uint64_t)job->spec.frames[i].width * job->spec.frames[i].height;
    return ask;
}

static void
tell_options(struct coord *c, const struct job *job)
{
    struct action *a = actions_add_job(&c->actions, ACT_OPTIONS, 0, job->id);

    if (a)
        a->text = actions_keep_text(&c->actions, job->goal.options);
}

bool
stages_end(struct coord *c, struct job *job, uint32_t n,
           const struct stage_found *found)
{
    struct job_goal *g = &job->goal;
    struct rad_refine_ask ask = make_ask(c, job, found);
    struct rad_refine_known known = rad_refine_pass_on(&ask);
    struct rad_refine_rungs next;
    bool on = rad_refine_next(&ask, &next, &g->error);

    g->mean = rad_refine_mean(&found->sums);
    g->by_clock = g->by_clock || rad_refine_by_clock(&ask);
    actions_log(
        &c->actions, ACT_INFO,
        "stage ends job=%s stage=%u error=%.4f wanted=%.4f seconds=%.3f "
        "goes_on=%d",
        job->hex, g->number, g->error, job->spec.error_ppm / 1e6,
        goal_spent_s(job, c->now_ms), on);
    g->state = on                          ? GOAL_AHEAD
               : rad_refine_is_short(&ask) ? GOAL_SHORT
                                           : GOAL_REACHED;
    g->rungs[0] = pack_rung(next.ambient);
    g->rungs[1] = pack_rung(next.pixel);
    if (on) {
        g->number++;
        g->base += n;
        g->begun_s = goal_spent_s(job, c->now_ms);
        g->past = known;
    }
    if (!set_options(job))
        c->actions.failed = true;
    else
        tell_options(c, job);
    c->told_progress_ms = 0; /* users who watch hear of each stage, also of a
                              * short stage */
    return !on;
}

/* --- decisions on the disk --- */

/* Version of the bytes of stages_pack() and of the meaning of its rungs. */
enum { LAYOUT = 6 };

void
stages_pack(struct coord *c, const struct job *job, uint8_t out[STAGES_BYTES])
{
    const struct job_goal *g = &job->goal;
    struct wire_out w;

    wire_out_init(&w, STAGES_BYTES);
    wire_put_u8(&w, LAYOUT);
    wire_put_u8(&w, g->state != GOAL_AHEAD);
    wire_put_u8(&w, g->state == GOAL_SHORT);
    wire_put_u8(&w, g->by_clock);
    wire_put_u8(&w, g->rungs[0]);
    wire_put_u8(&w, g->rungs[1]);
    wire_put_f64(&w, g->error);
    wire_put_f64(&w, g->mean);
    wire_put_u8(&w, pack_rung(g->past.rungs.ambient));
    wire_put_u8(&w, pack_rung(g->past.rungs.pixel));
    wire_put_f64(&w, g->past.ambient);
    wire_put_f64(&w, g->past.pixel);
    wire_put_f64(&w, g->past.noise);
    wire_put_f64(&w, g->past.places);
    wire_put_u64(&w, (uint64_t)(1000 * goal_spent_s(job, c->now_ms)));
    if (w.bad)
        c->actions.failed = true;
    else
        memcpy(out, w.buf, STAGES_BYTES);
    wire_out_release(&w);
}

static bool
is_sound(const struct rad_refine_known *k)
{
    return fmin(fmin(k->ambient, k->pixel), fmin(k->noise, k->places)) >= 0 &&
           isfinite(k->ambient + k->pixel + k->noise + k->places);
}

static bool
unpack(struct job_goal *g, const struct saved_pass *p)
{
    struct wire_in in;
    bool ended, is_short;

    wire_in_init(&in, p->bytes, p->len);
    if (wire_get_u8(&in) != LAYOUT)
        return false;
    ended = wire_get_u8(&in);
    is_short = wire_get_u8(&in);
    g->state = !ended ? GOAL_AHEAD : is_short ? GOAL_SHORT : GOAL_REACHED;
    g->by_clock = wire_get_u8(&in);
    g->rungs[0] = wire_get_u8(&in);
    g->rungs[1] = wire_get_u8(&in);
    g->error = wire_get_f64(&in);
    g->mean = wire_get_f64(&in);
    g->past.rungs.ambient = unpack_rung(wire_get_u8(&in));
    g->past.rungs.pixel = unpack_rung(wire_get_u8(&in));
    g->past.ambient = wire_get_f64(&in);
    g->past.pixel = wire_get_f64(&in);
    g->past.noise = wire_get_f64(&in);
    g->past.places = wire_get_f64(&in);
    g->spent_ms = wire_get_u64(&in);
    return !in.bad && wire_left(&in) == 0 && is_sound(&g->past) &&
           isfinite(g->error) && isfinite(g->mean);
}

/* Repeat the kept decision at the end of a stage of n passes.  1: done; 0: no
 * decision is kept; negative with *err. */
static int
take_stage(struct job *job, uint32_t n, struct rad_error *err)
{
    struct job_goal *g = &job->goal, read = *g;
    struct kept_passes *kept = &job->kept;
    uint32_t last = g->base + n - 1;

    if (n == 0 || kept->n <= last)
        return 0;
    if (!unpack(&read, &kept->pass[last]) ||
        (read.state == GOAL_AHEAD && stages_are_all(job))) {
        kept_cut(kept, last); /* the check pass is made, and decided, again */
        g->unread = true;
        return 0;
    }
    *g = read;
    for (; g->state == GOAL_AHEAD && g->base <= last; g->base++) {
        progress_count_tiles(job, &kept->pass[g->base].counts);
        free((void *)kept->pass[g->base].bytes);
        kept->pass[g->base].bytes = NULL;
    }
    g->number += g->state == GOAL_AHEAD;
    g->begun_s = (double)g->spent_ms / 1000;
    return set_options(job) ? 1 : rad_fail_memory(err);
}

int
stages_take_up(struct coord *c, struct job *job, struct rad_error *err)
{
    struct rad_pass plan[RAD_MOST_PASSES];
    struct job_goal *g = &job->goal;
    struct rad_pass_size *size;
    uint32_t n;
    int rc = 1;

    if (!msg_has_goal(&job->spec))
        return 0;
    size = stages_sizes(&job->spec);
    if (!size)
        return rad_fail_memory(err);
    while (rc > 0 && g->state == GOAL_AHEAD) {
        rc = stages_plan(job, size, plan, &n, err);
        if (rc == 0 && n == 0)
            g->state = GOAL_REACHED; /* the job has no cache */
        if (rc == 0)
            rc = take_stage(job, n, err);
    }
    free(size);
    if (rc < 0)
        return rc;
    if (g->options)
        tell_options(c, job);
    return 0;
}

const char *
stages_lost(const struct job *job)
{
    if (!msg_has_goal(&job->spec) || job->goal.state != GOAL_AHEAD ||
        job->pixels_done == 0)
        return NULL;
    return job->goal.unread
               ? "the options that its picture was begun with are kept as "
                 "another version of radcoord keeps them: submit it again"
               : "the options that its picture was begun with are lost, as the "
                 "disk had no room for them: submit it again";
}
