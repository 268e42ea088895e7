/* report.c - see report.h */
#include "config.h"

#include "front/report.h"

#include "desk/holding.h"
#include "desk/desk.h"
#include "jobs/job.h"
#include "jobs/part.h"
#include "jobs/progress.h"
#include "registry/bygone.h"
#include "filling/passes.h"
#include "filling/tiles.h"

#include "base/text.h"
#include "refine/refine.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define MOST_WHOLE 1000 /* rows of a list that is sent whole, not in pages */
#define LIST_LABEL 80   /* most bytes of a job's name in such a list */

static double
since(const struct coord *c, uint64_t ms)
{
    return c->now_ms > ms ? (double)(c->now_ms - ms) / 1000 : 0;
}

static void
add_share(struct report_share *s, const struct job_part *part)
{
    const struct msg_tally *t = &part->tally;
    const bool here = part_is_here(part);

    s->lacks_room |= part->state == PART_NO_ROOM;
    s->prepares |= tiles_out(part) > 0 || part->surveying > 0;
    s->rays += part_rays(part) + part_under_way(part);
    s->redundant += t->ambient_redundant + part->past.ambient_redundant;
    s->cache += here ? t->cache_values : 0;
    s->memory += here ? t->peak_rss_bytes : 0;
}

struct report_share *
report_shares(const struct coord *c)
{
    struct report_share *all = calloc(c->nworkers + 1u, sizeof *all);

    for (size_t i = 0; all && i < c->nbegun; i++) {
        const struct job *job = c->jobs[i];

        for (uint32_t k = 0; k < job->nparts; k++)
            add_share(&all[job->parts[k].worker->id], &job->parts[k]);
    }
    return all;
}

const char *
report_worker_state(const struct coord_worker *w,
                    const struct report_share *shares)
{
    if (w->conn == 0)
        return "gone";
    if (w->drained || w->leaving)
        return w->in_flight ? "draining" : "drained";
    if (w->in_flight || shares[w->id].prepares)
        return "working";
    if (w->loading)
        return "loading";
    return shares[w->id].lacks_room ? "no room" : "idle";
}

/* Why a worker gets no work, in a word for scripts and for people. */
static const struct {
    const char *word, *note;
} away[MSG_NDRAIN] = {
    [MSG_DRAIN_ORDER] = { "order", "drained by an administrator" },
    [MSG_DRAIN_STOPPED] = { "stopped", "it was stopped" },
    [MSG_DRAIN_HOURS] = { "hours", "outside hours of its radd.conf" },
    [MSG_DRAIN_IN_USE] = { "in use", "somebody uses the machine "
                                     "(idle_only of its radd.conf)" },
};

/* Why the worker gets no work, where its state alone does not say. */
static const char *
worker_note(const struct coord_worker *w, const struct report_share *s)
{
    if (w->leaving)
        return away[w->leaving].note;
    if (w->conn == 0)
        return "no connection to it";
    if (w->drained)
        return away[MSG_DRAIN_ORDER].note;
    return s->lacks_room ? w->no_room : "";
}

static const char *
worker_away(const struct coord_worker *w)
{
    if (w->leaving)
        return away[w->leaving].word;
    return w->drained ? away[MSG_DRAIN_ORDER].word : "";
}

static json_int_t
integer(uint64_t n)
{
    return (json_int_t)(n & INT64_MAX);
}

json_t *
report_worker(const struct coord *c, const struct coord_worker *w,
              const struct report_share *shares)
{
    const struct report_share *s = &shares[w->id];

    return json_pack(
        "{s:s,s:s,s:s,s:f,s:I,s:I,s:I,s:I,s:I,s:I,s:s,s:s,s:f,s:s}", "name",
        w->name, "state", report_worker_state(w, shares), "away",
        worker_away(w), "load", w->conn ? w->load / 100.0 : 0.0, "threads",
        (json_int_t)w->threads, "units", (json_int_t)w->in_flight, "rays",
        integer(s->rays), "redundant", integer(s->redundant), "memory",
        integer(s->memory), "cache", integer(s->cache), "address", w->address,
        "program", w->program, "since_s", since(c, w->since_ms), "text",
        worker_note(w, s));
}

static json_t *
all_workers(const struct coord *c)
{
    struct report_share *shares = report_shares(c);
    json_t *list = shares ? json_array() : NULL;

    for (const struct coord_worker *w = c->workers; list && w; w = w->next)
        if (!w->forgotten)
            json_array_append_new(list, report_worker(c, w, shares));
    free(shares);
    return list;
}

/* The first worker of a job with --same-bits that no worker is at, while a
 * connected worker of another arithmetic is excluded from it; else NULL. */
static const struct job_part *
lacks_bits(const struct job *job)
{
    const struct job_part *first;
    bool other = false;

    if (!(job->spec.flags & MSG_JOB_SAME_BITS) || job_active(job) > 0)
        return NULL;
    first = part_first(job);
    for (uint32_t i = 0; first && i < job->nparts; i++) {
        const struct job_part *part = &job->parts[i];

        other |= part->state == PART_EXCLUDED && part->worker->conn != 0 &&
                 part->worker->fingerprint != first->fingerprint;
    }
    return other ? first : NULL;
}

/* A worker that has no room for the job's files, if no worker is at the job. */
static const struct coord_worker *
without_room(const struct job *job)
{
    for (uint32_t i = 0; i < job->nparts && job_active(job) == 0; i++)
        if (job->parts[i].state == PART_NO_ROOM)
            return job->parts[i].worker;
    return NULL;
}

/* Is no worker at the job, and are all that take units excluded from it? */
static bool
all_excluded(const struct coord *c, const struct job *job)
{
    bool any = false;

    for (const struct coord_worker *w = c->workers; w; w = w->next)
        any |= desk_takes_units(w);
    return any && job_active(job) == 0 && !desk_others_may(c, job, NULL, true);
}

/* Say how many workers may not work now, of those that will by themselves. */
static void
say_away(char buf[MSG_MAX_TEXT + 1], const unsigned n[MSG_NDRAIN],
         unsigned drained)
{
    const struct {
        unsigned n;
        const char *what;
    } why[] = { { n[MSG_DRAIN_HOURS], "outside hours" },
                { n[MSG_DRAIN_IN_USE], "in use" },
                { drained, "drained" } };
    const char *before = "no worker may work: ";

    buf[0] = '\0';
    for (size_t i = 0; i < sizeof why / sizeof why[0]; i++)
        if (why[i].n > 0) {
            size_t used = strlen(buf);

            snprintf(buf + used, MSG_MAX_TEXT + 1 - used, "%s%u %s", before,
                     why[i].n, why[i].what);
            before = ", ";
        }
}

/* Why a job that waits or runs gets no worker; NULL: it may get a worker.  The
 * text is in buf if it has to be made. */
static const char *
lacks_workers(const struct coord *c, const struct job *job,
              char buf[MSG_MAX_TEXT + 1])
{
    unsigned drained = 0, n[MSG_NDRAIN] = { 0 };

    if (job->state != JOB_WAITING && job->state != JOB_RUNNING)
        return NULL;
    for (const struct coord_worker *w = c->workers; w; w = w->next) {
        if (w->conn != 0 && ((!w->drained && !w->leaving) || w->in_flight > 0))
            return NULL;
        if (w->leaving)
            n[w->leaving] += !w->forgotten;
        else
            drained += w->conn != 0;
    }
    if (n[MSG_DRAIN_HOURS] + n[MSG_DRAIN_IN_USE] > 0) {
        say_away(buf, n, drained);
        return buf;
    }
    return drained > 0 ? "all workers are drained" : "no worker is there";
}

/* Is no worker at the job, and are all workers that may work at others? */
static bool
waits_its_turn(const struct coord *c, const struct job *job)
{
    if (job->place != PLACE_OPEN || job->state == JOB_PAUSED ||
        (job->state == JOB_RUNNING && holding_workers(job) > 0))
        return false;
    for (const struct coord_worker *w = c->workers; w; w = w->next)
        if (desk_takes_units(w) && w->in_flight == 0 && !w->fills)
            return false;
    return true;
}

/* Why the job is over or gets nowhere, for users; the text is in buf if it has
 * to be made. */
static const char *
why(const struct coord *c, const struct job *job, char buf[MSG_MAX_TEXT + 1])
{
    const struct coord_worker *full = without_room(job);
    const char *nobody = lacks_workers(c, job, buf);
    const struct job_part *first = lacks_bits(job);
    char when[BYGONE_TIME];

    if (desk_unfetched(c, job) && !job->text[0]) {
        bygone_time_text(desk_shown_ms(c, job->over_ms + c->keep.unfetched_ms),
                         when);
        snprintf(buf, MSG_MAX_TEXT + 1, "not fetched; kept until %s", when);
        return buf;
    }
    if (job_over(job))
        return job->text;
    if (job_held(job))
        return job->place == PLACE_NO_ROOM ? job->text : c->full_text;
    if (nobody)
        return nobody;
    if (full) {
        rad_text_print(buf, MSG_MAX_TEXT + 1, "worker %s: %s", full->name,
                       full->no_room);
        return buf;
    }
    if (!first && all_excluded(c, job))
        return "no worker that is here can keep a process for it";
    if (!first)
        return !job->text[0] && waits_its_turn(c, job)
                   ? "the workers are at other jobs, which go first"
                   : job->text;
    snprintf(buf, MSG_MAX_TEXT + 1,
             "--same-bits: no worker here has the arithmetic of the first, %s",
             first->name);
    return buf;
}

/* Add the bytes that workers sent, and the redundant ambient records that came;
 * zeros in PLACE_FILED. */
static void
add_traffic(json_t *o, const struct job *job)
{
    uint64_t bytes = 0, redundant = 0;

    for (uint32_t i = 0; i < job->nparts; i++) {
        bytes += job->parts[i].tally.bytes_out + job->parts[i].past.bytes_out;
        redundant += job->parts[i].tally.ambient_redundant +
                     job->parts[i].past.ambient_redundant;
    }
    json_object_set_new(o, "bytes", json_integer(integer(bytes)));
    json_object_set_new(o, "ambient_redundant",
                        json_integer(integer(redundant)));
}

/* Add how far the passes are (zeros: none is open), the job whose cache this
 * job began with, and the size of its own cache that is kept. */
static void
add_passes(json_t *o, const struct job *job)
{
    struct passes_state s = passes_state(job);
    char reuse[MSG_JOB_HEX] = "";
    bool open = s.open < s.n;

    if (job->spec.reuse)
        msg_job_format(job->spec.reuse, reuse);
    json_object_set_new(o, "reuse", json_string(reuse));
    json_object_set_new(
        o, "cache_bytes",
        json_integer((json_int_t)(job_over(job) ? job->cache.bytes : 0)));
    json_object_set_new(o, "pass", json_integer(open ? s.open + 1 : 0));
    json_object_set_new(o, "passes", json_integer(open ? s.n : 0));
    json_object_set_new(o, "pass_done", json_real(open ? s.made : 0));
}

/* Add the goal of a job with --error or --time, and how far it is reached. */
static void
add_goal(json_t *o, const struct job *job)
{
    const struct job_goal *g = &job->goal;

    if (!msg_has_goal(&job->spec))
        return;
    json_object_set_new(o, "stage", json_integer((json_int_t)g->number + 1));
    json_object_set_new(o, "stages", json_integer(RAD_REFINE_STAGES));
    json_object_set_new(o, "goal_error", json_real(job->spec.error_ppm / 1e6));
    json_object_set_new(o, "goal_time_s", json_real(job->spec.time_ms / 1e3));
    json_object_set_new(o, "estimated_error", json_real(g->error));
    json_object_set_new(o, "time_up", json_boolean(goal_time_up(job)));
    json_object_set_new(o, "rays_up", json_boolean(goal_rays_up(job)));
}

json_t *
report_job(const struct coord *c, const struct job *job, size_t label)
{
    char name[MSG_MAX_LABEL + 1];
    char text[MSG_MAX_TEXT + 1];
    struct msg_progress p;
    struct job_size size = job_size(job);
    json_t *o;

    progress_tell(job, c->now_ms, &p);
    rad_text_print(name, label + 1, "%s", job->spec.name);
    o = json_pack(
        "{s:s,s:s,s:s,s:s,s:i,s:f,s:I,s:I,s:I,s:I,s:I,s:I,s:I,s:I,s:I,s:I,"
        "s:f,s:f,s:f,s:s,s:i}",
        "job", job->hex, "name", name, "owner", job->owner, "state",
        job_is(job), "priority", (int)job->spec.priority, "done",
        msg_progress_share(&p), "frames", (json_int_t)job->spec.nframes,
        "frames_ready", (json_int_t)p.frames_ready, "width",
        (json_int_t)size.width, "height", (json_int_t)size.height, "oversample",
        (json_int_t)size.oversample, "units_done", (json_int_t)p.units_done,
        "units_total", (json_int_t)p.units_total, "units_redone",
        (json_int_t)p.units_redone, "rays", (json_int_t)p.rays, "workers",
        (json_int_t)holding_workers(job), "elapsed_s", p.elapsed_s, "error",
        p.error, "left_out", p.left_out, "text", why(c, job, text), "status",
        job->status);
    if (!o)
        return NULL;
    if (p.left_s > 0)
        json_object_set_new(o, "left_s", json_real(p.left_s));
    add_traffic(o, job);
    add_passes(o, job);
    add_goal(o, job);
    return o;
}

json_t *
report_gone(const struct saved_gone *g)
{
    char hex[MSG_JOB_HEX], text[MSG_MAX_TEXT + 1];

    msg_job_format(g->job, hex);
    bygone_text(g, text);
    return json_pack("{s:s,s:s,s:s,s:s,s:b,s:s}", "job", hex, "name", g->name,
                     "owner", g->owner, "state", "forgotten", "fetched",
                     g->fetched, "text", text);
}

static json_t *
all_jobs(const struct coord *c)
{
    json_t *list = json_array();

    for (size_t i = 0; i < c->njobs; i++)
        json_array_append_new(list, report_job(c, c->jobs[i], LIST_LABEL));
    return list;
}

static json_t *
status_of(const struct coord *c)
{
    json_int_t workers = 0, threads = 0, kept = 0;
    json_int_t drained = 0, drained_threads = 0;
    struct coord_pace pace = { 0 };

    for (const struct coord_worker *w = c->workers; w; w = w->next)
        if (w->conn != 0) {
            bool rests = w->drained || w->leaving;

            workers++;
            threads += w->threads;
            drained += rests;
            drained_threads += rests ? w->threads : 0;
        }
    for (size_t i = 0; i < c->njobs; i++)
        kept += (json_int_t)(c->jobs[i]->kept_bytes & INT64_MAX);
    if (c->env.pace)
        c->env.pace(c->env.arg, &pace);
    return json_pack(
        "{s:s,s:I,s:I,s:I,s:I,s:I,s:I,s:I,s:I,s:I,s:b,s:I,s:f,s:f}", "program",
        c->env.program, "epoch", (json_int_t)(c->env.epoch & INT64_MAX),
        "start_ms", (json_int_t)(desk_shown_ms(c, c->env.epoch) & INT64_MAX),
        "workers", workers, "threads", threads, "drained", drained,
        "drained_threads", drained_threads, "jobs", (json_int_t)c->nopen,
        "jobs_kept", (json_int_t)c->njobs, "kept_bytes", kept, "disk_full",
        c->full, "slow_turns", (json_int_t)pace.slow, "longest_turn_ms",
        pace.longest_ms, "longest_turn_cpu_ms", pace.longest_cpu_ms);
}

/* The job whose id begins with text.  NULL, and *status is set: no job's id
 * does, or the ids of several jobs do. */
static const struct job *
find_prefix(const struct coord *c, const char *text, int *status)
{
    const struct job *found = NULL;

    for (size_t i = 0; i < c->njobs; i++) {
        if (strncmp(c->jobs[i]->hex, text, strlen(text)) != 0)
            continue;
        if (found) {
            *status = EX_USAGE;
            return NULL;
        }
        found = c->jobs[i];
    }
    *status = found ? 0 : EX_NOINPUT;
    return found;
}

static char *
message(const char *fmt, const char *text)
{
    char buf[256];

    snprintf(buf, sizeof buf, fmt, text);
    return strdup(buf);
}

static char *
query_job(const struct coord *c, const char *text, int *status, json_t **root)
{
    const struct job *job = find_prefix(c, text, status);
    const struct saved_gone *gone;
    char why[MSG_MAX_TEXT + 1];

    if (job) {
        *root = report_job(c, job, MSG_MAX_LABEL);
        return NULL;
    }
    gone = *status == EX_NOINPUT && text[0] ? bygone_find(c, text) : NULL;
    if (gone) {
        bygone_text(gone, why);
        return strdup(why);
    }
    return message(*status == EX_USAGE ? "several jobs begin with '%s'"
                                       : "no job '%s'",
                   text);
}

/* A whole list, unless it is too long for a turn of the loop and one answer. */
static char *
query_whole(const struct coord *c, enum msg_topic what, int *status,
            json_t **root)
{
    bool jobs = what == MSG_QUERY_JOBS;

    if ((jobs ? c->njobs : c->nworkers) > MOST_WHOLE) {
        *status = EX_PROTOCOL;
        return message("too many %s for one answer: ask for pages",
                       jobs ? "jobs" : "workers");
    }
    *root = jobs ? all_jobs(c) : all_workers(c);
    return NULL;
}

char *
report_query(const struct coord *c, enum msg_topic what, const char *text,
             int *status)
{
    json_t *root = NULL;
    char *out = NULL;

    *status = 0;
    switch (what) {
    case MSG_QUERY_STATUS:
        root = status_of(c);
        break;
    case MSG_QUERY_WORKERS:
    case MSG_QUERY_JOBS:
        out = query_whole(c, what, status, &root);
        break;
    case MSG_QUERY_JOB:
        out = query_job(c, text, status, &root);
        break;
    case MSG_QUERY_LIMITS: /* quota.h */
    case MSG_NQUERY:
        break;
    }
    if (!root)
        return out;
    out = json_dumps(root, JSON_INDENT(1) | JSON_REAL_PRECISION(9));
    json_decref(root);
    return out;
}
