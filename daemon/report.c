/* report.c - see report.h */
#include "config.h"

#include "report.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

static double
since(const struct coord *c, uint64_t ms)
{
    return c->now_ms > ms ? (double)(c->now_ms - ms) / 1000 : 0;
}

static const char *
worker_state(const struct coord_worker *w)
{
    if (w->conn == 0)
        return "gone";
    if (w->drained || w->leaving)
        return w->in_flight ? "draining" : "drained";
    if (w->in_flight)
        return "working";
    return w->loading ? "loading" : "idle";
}

static json_t *
one_worker(const struct coord *c, const struct coord_worker *w)
{
    return json_pack("{s:s,s:s,s:I,s:I,s:s,s:s,s:f}", "name", w->name, "state",
                     worker_state(w), "threads", (json_int_t)w->threads,
                     "units", (json_int_t)w->in_flight, "address", w->address,
                     "program", w->program, "since_s", since(c, w->since_ms));
}

static json_t *
all_workers(const struct coord *c)
{
    json_t *list = json_array();

    for (const struct coord_worker *w = c->workers; w; w = w->next)
        json_array_append_new(list, one_worker(c, w));
    return list;
}

/* Nobody works on it though there are workers: of --same-bits. */
static bool
lacks_bits(const struct job *job)
{
    bool others = false;

    for (uint32_t i = 0; i < job->nworkers; i++)
        others |= job->workers[i].excluded && job->workers[i].worker->conn != 0;
    return others && job->spec.flags & MSG_JOB_SAME_BITS &&
           job_active(job) == 0;
}

/* Why it is over, or gets nowhere; in buf, if that has to be made up. */
static const char *
why(const struct coord *c, const struct job *job, char buf[MSG_MAX_TEXT + 1])
{
    uint32_t first = 0;

    if (job_over(job))
        return job->text;
    if (job->held)
        return c->full_text;
    if (!lacks_bits(job))
        return job->text;
    while (first + 1 < job->nworkers && !job->workers[first].took_part)
        first++;
    snprintf(buf, MSG_MAX_TEXT + 1,
             "--same-bits: no worker here has the arithmetic of the first, %s",
             job->workers[first].name);
    return buf;
}

static json_t *
one_job(const struct coord *c, const struct job *job)
{
    char text[MSG_MAX_TEXT + 1];
    struct msg_progress p;
    double done, rows;

    job_progress(job, c->now_ms, &p);
    /* the cost is that of whole units: of a single one rows tell more */
    done = p.cost_total > 0 ? p.cost_done / p.cost_total : 0;
    rows =
        p.pixels_total > 0 ? (double)p.pixels_done / (double)p.pixels_total : 0;
    if (rows > done)
        done = rows;
    return json_pack(
        "{s:s,s:s,s:s,s:s,s:i,s:f,s:I,s:I,s:I,s:I,s:I,s:I,s:I,s:I,s:I,s:f,"
        "s:s,s:i}",
        "job", job->hex, "name", job->spec.name, "owner", job->owner, "state",
        job_is(job), "priority", (int)job->spec.priority, "done", done,
        "frames", (json_int_t)job->spec.nframes, "frames_ready",
        (json_int_t)p.frames_ready, "width",
        (json_int_t)job->spec.frames[0].width, "height",
        (json_int_t)job->spec.frames[0].height, "units_done",
        (json_int_t)p.units_done, "units_total", (json_int_t)p.units_total,
        "units_redone", (json_int_t)p.units_redone, "rays", (json_int_t)p.rays,
        "workers", (json_int_t)p.workers, "elapsed_s", p.elapsed_s, "text",
        why(c, job, text), "status", job->status);
}

static json_t *
all_jobs(const struct coord *c)
{
    json_t *list = json_array();

    for (size_t i = 0; i < c->njobs; i++)
        json_array_append_new(list, one_job(c, c->jobs[i]));
    return list;
}

static json_t *
status_of(const struct coord *c)
{
    json_int_t workers = 0, threads = 0, jobs = 0;

    for (const struct coord_worker *w = c->workers; w; w = w->next)
        if (w->conn != 0) {
            workers++;
            threads += w->threads;
        }
    for (size_t i = 0; i < c->njobs; i++)
        jobs += !job_over(c->jobs[i]);
    return json_pack("{s:s,s:I,s:I,s:I,s:I,s:I}", "program", c->env.program,
                     "epoch", (json_int_t)(c->env.epoch & INT64_MAX), "workers",
                     workers, "threads", threads, "jobs", jobs, "jobs_kept",
                     (json_int_t)c->njobs);
}

/* The job whose id begins with text; *status says why there is none. */
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

    if (job) {
        *root = one_job(c, job);
        return NULL;
    }
    return message(*status == EX_USAGE ? "several jobs begin with '%s'"
                                       : "no job '%s'",
                   text);
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
        root = all_workers(c);
        break;
    case MSG_QUERY_JOBS:
        root = all_jobs(c);
        break;
    case MSG_QUERY_JOB:
        out = query_job(c, text, status, &root);
        break;
    case MSG_NQUERY:
        break;
    }
    if (!root)
        return out;
    out = json_dumps(root, JSON_INDENT(1) | JSON_REAL_PRECISION(9));
    json_decref(root);
    return out;
}
