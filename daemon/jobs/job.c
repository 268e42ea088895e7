/* job.c - see job.h */
#include "config.h"

#include "jobs/job.h"

#include "jobs/part.h"
#include "jobs/shared.h"
#include "jobs/unit.h"
#include "machine/jobtext.h"
#include "machine/steps.h"

#include "image/filter.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Used by job_count_frames() and job_weight(). */
#define WINDOWS_A_FRAME 4
#define ROWS_A_FRAME    1024
#define FRAMES_A_JOB    400

static const char *
copy_str(struct rad_arena *mem, const char *s, bool *ok)
{
    const char *p = rad_arena_strndup(mem, s, strlen(s));

    if (!p)
        *ok = false;
    return p;
}

static const uint8_t *
copy_bytes(struct rad_arena *mem, const uint8_t *src, size_t n, bool *ok)
{
    const uint8_t *p = rad_arena_dup(mem, src, n);

    if (!p)
        *ok = false;
    return p;
}

/* Copy *from into *s, and into mem all that it points at but the job's id. */
static bool
copy_spec(struct rad_arena *mem, struct msg_spec *s,
          const struct msg_spec *from)
{
    struct msg_frame *f = rad_arena_calloc(mem, from->nframes, sizeof *f);
    bool ok = f != NULL;

    *s = *from;
    s->manifest = copy_bytes(mem, from->manifest, MSG_HASH, &ok);
    s->name = copy_str(mem, from->name, &ok);
    s->params = copy_str(mem, from->params, &ok);
    s->origin = copy_str(mem, from->origin ? from->origin : "", &ok);
    s->needs = copy_str(mem, from->needs, &ok);
    s->estimate = copy_str(mem, from->estimate, &ok);
    if (from->ncosts > 0)
        s->costs = copy_bytes(mem, from->costs, (size_t)from->ncosts * 4, &ok);
    if (from->flags & MSG_JOB_VIEWS)
        s->views = copy_bytes(mem, from->views, MSG_HASH, &ok);
    if (from->flags & MSG_JOB_SCENE)
        s->scene = copy_bytes(mem, from->scene, MSG_HASH, &ok);
    if (from->flags & MSG_JOB_REUSE)
        s->reuse = copy_bytes(mem, from->reuse, MSG_JOB, &ok);
    s->files.hash = copy_bytes(mem, from->files.hash,
                               (size_t)from->files.n * MSG_HASH, &ok);
    for (uint32_t i = 0; ok && i < from->nframes; i++) {
        f[i] = from->frames[i];
        f[i].view = copy_str(mem, from->frames[i].view, &ok);
    }
    s->frames = f;
    return ok;
}

static void
measure_frames(struct job *job)
{
    for (uint32_t i = 0; i < job->spec.nframes; i++) {
        const struct msg_frame *f = &job->spec.frames[i];

        job->frames[i].pixels_left = (uint64_t)f->width * f->height;
        job->pixels_total += job->frames[i].pixels_left;
    }
}

uint64_t
job_count_frames(const struct msg_spec *spec)
{
    uint64_t sum = 0;

    for (uint32_t i = 0; i < spec->nframes; i++) {
        const struct msg_frame *f = &spec->frames[i];
        uint64_t pixels = (uint64_t)f->width * f->height;
        uint64_t n = spec->windows < pixels ? spec->windows : pixels;

        n /= WINDOWS_A_FRAME;
        if (n < f->height / ROWS_A_FRAME)
            n = f->height / ROWS_A_FRAME;
        sum += n > 0 ? n : 1;
    }
    return sum;
}

uint32_t
job_weight(const struct job *job)
{
    uint64_t n =
        job->place == PLACE_FILED ? job->spec.nframes : job->frames_counted;

    return 1 + (uint32_t)(n / FRAMES_A_JOB);
}

struct job *
job_new(const struct msg_spec *spec, const char *owner)
{
    struct job *job = calloc(1, sizeof *job);

    if (!job)
        return NULL;
    rad_arena_init(&job->mem);
    memcpy(job->id, spec->job, MSG_JOB);
    msg_job_format(job->id, job->hex);
    snprintf(job->owner, sizeof job->owner, "%s", owner);
    job->frames = calloc(spec->nframes, sizeof *job->frames);
    if (!job->frames || !copy_spec(&job->mem, &job->spec, spec)) {
        job_free(job);
        return NULL;
    }
    job->spec.job = job->id;
    measure_frames(job);
    job->frames_counted = job_count_frames(spec);
    job->cost_total = (double)job->pixels_total;
    return job;
}

struct job_size
job_size(const struct job *job)
{
    const struct msg_frame *f = &job->spec.frames[0];
    int n = msg_oversample(&job->spec);

    return (struct job_size){ (uint32_t)rad_filter_side((int)f->width, n),
                              (uint32_t)rad_filter_side((int)f->height, n),
                              (uint32_t)n };
}

uint8_t
job_channels(const struct job *job)
{
    if (job->spec.flags & MSG_JOB_CODED)
        return 1;
    return job->spec.flags & MSG_JOB_DEPTH ? 4 : 3;
}

/* Free what a job that is over does not need (job_lighten()). */
static void
free_work(struct job *job)
{
    partition_free(job->partition);
    kept_drop(&job->kept);
    for (uint32_t i = 0; i < job->nunits; i++) {
        free(job->units[i].attempts);
        free(job->units[i].hashes.row);
    }
    free(job->units);
    free(job->out);
    free(job->index);
    free(job->suspects);
    kept_forget_times(&job->cache);
    for (uint32_t i = 0; job->frames && i < job->spec.nframes; i++)
        free(job->frames[i].line_s);
    free(job->parts);
}

void
job_free(struct job *job)
{
    if (!job)
        return;
    free_work(job);
    free(job->frames);
    rad_arena_release(&job->mem);
    free(job);
}

/* Free the costs of lines in the specification, up to 32 MiB, by a copy of all
 * the rest.  They stay if memory is out. */
static void
drop_costs(struct job *job)
{
    struct msg_spec less = job->spec, copy;
    struct rad_arena mem;

    if (job->spec.ncosts == 0)
        return;
    less.ncosts = 0;
    less.costs = NULL;
    rad_arena_init(&mem);
    if (!copy_spec(&mem, &copy, &less)) {
        rad_arena_release(&mem);
        return;
    }
    rad_arena_release(&job->mem);
    job->mem = mem;
    job->spec = copy;
}

void
job_lighten(struct job *job)
{
    life_move(job, PLACE_FILED);
    free_work(job);
    for (uint32_t i = 0; i < job->spec.nframes; i++) {
        job->frames[i].line_s = NULL;
        job->frames[i].nlines = 0;
    }
    job->filing = NULL;
    job->partition = NULL;
    job->survey = NULL;
    job->shared = NULL;
    job->links = NULL;
    job->units = NULL;
    job->out = job->suspects = job->index = NULL;
    job->parts = NULL;
    job->nunits = job->nout = job->nsuspects = job->nindex = job->nparts = 0;
    drop_costs(job);
}

bool
job_over(const struct job *job)
{
    return job->state >= JOB_DONE;
}

bool
job_held(const struct job *job)
{
    return !job_over(job) && (job->full || job->place == PLACE_NO_ROOM);
}

const char *
job_state_name(enum job_state state)
{
    return life_states.state[state].name;
}

const char *
job_is(const struct job *job)
{
    return job_held(job) ? "held" : job_state_name(job->state);
}

int
job_partition_spec(const struct msg_spec *from, struct partition_spec *spec,
                   struct rad_error *err)
{
    struct rad_params params;
    int rc = jobtext_params(from->params, &params, err);

    *spec = (struct partition_spec){
        .kind = from->partition,
        .order = from->order,
        .windows = from->windows,
        .seed = from->seed,
        .balance = !(from->flags & MSG_JOB_NO_BALANCE),
        .fresh = from->flags & MSG_JOB_FRESH_FRAMES,
        .ncosts = from->ncosts,
        .nframes = from->nframes,
        .frames = from->frames,
    };
    if (rc == 0)
        spec->psample = params.psample;
    return rc;
}

/* The job's partition; NULL with *err. */
static struct partition *
make_partition(const struct job *job, struct rad_error *err)
{
    const struct msg_spec *s = &job->spec;
    struct partition_spec spec;
    struct partition *p = NULL;
    float *costs = malloc(s->ncosts ? s->ncosts * sizeof *costs : 1);

    if (!costs)
        rad_fail_memory(err);
    else if (job_partition_spec(s, &spec, err) == 0) {
        if (s->ncosts > 0)
            wire_floats_get(costs, s->costs, s->ncosts);
        spec.costs = costs;
        p = partition_new(&spec, err);
    }
    free(costs);
    return p;
}

/* Make job->shared, if the job's lines are shared; false: memory is out. */
static bool
make_shared(struct job *job)
{
    const struct msg_spec *s = &job->spec;
    struct rad_params params;

    if (!partition_is_strict(job->partition))
        return true;
    if (jobtext_params(s->params, &params, NULL) != 0)
        return false; /* cannot be: make_partition() has read them */
    job->shared = shared_new(s->frames, s->nframes, params.psample,
                             s->flags & MSG_JOB_DEPTH ? 4 : 3);
    return job->shared != NULL;
}

/* Has the job no ambient cache, or one that is a function of the job? */
static bool
is_exact(const struct job *job)
{
    struct rad_params p;

    return jobtext_params(job->spec.params, &p, NULL) == 0 &&
           (p.ambounce == 0 || p.ambacc == 0 ||
            job->spec.flags & MSG_JOB_PASSES);
}

int
job_split(struct job *job, struct rad_error *err)
{
    struct partition *p = make_partition(job, err);

    if (!p)
        return err->code;
    job->partition = p;
    job->cost_total = partition_cost_total(p);
    job->exact = is_exact(job);
    if (!unit_grow(job) || !make_shared(job)) {
        job->partition = NULL;
        partition_free(p);
        return rad_fail_memory(err);
    }
    return 0;
}

uint32_t
job_waiting(const struct job *job)
{
    return partition_waiting(job->partition) + job->nsuspects;
}

uint32_t
job_active(const struct job *job)
{
    uint32_t n = 0;

    for (uint32_t i = 0; i < job->nparts; i++)
        n += part_is_here(&job->parts[i]);
    return n;
}
