/* stats.c - see stats.h */
#include "config.h"

#include "registry/stats.h"

#include "filling/stages.h"
#include "jobs/job.h"
#include "jobs/part.h"
#include "jobs/progress.h"
#include "machine/jobtext.h"
#include "machine/lists.h"

#include "base/files.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Most attempts under way that are listed, for the loop waits meanwhile. */
#define MOST_RUNNING 1000

/* Seconds from a to b; 0 if a or b has not happened. */
static double
seconds(uint64_t a, uint64_t b)
{
    return a == 0 || b < a ? 0 : (double)(b - a) / 1000;
}

static json_int_t
integer(uint64_t n)
{
    return n > INT64_MAX ? INT64_MAX : (json_int_t)n;
}

/* The fingerprint of all workers that took part, or "mixed". */
static json_t *
fingerprint(const struct job *job)
{
    const struct job_part *first = NULL;
    char hex[17];

    for (uint32_t i = 0; i < job->nparts; i++) {
        const struct job_part *part = &job->parts[i];

        if (!part->took_part)
            continue;
        if (first && part->fingerprint != first->fingerprint)
            return json_string("mixed");
        first = part;
    }
    snprintf(hex, sizeof hex, "%016llx",
             first ? (unsigned long long)first->fingerprint : 0);
    return json_string(first ? hex : "");
}

static json_t *
times(const struct job *job, uint64_t now_ms)
{
    const struct msg_spec *s = &job->spec;
    uint64_t end = job_over(job) ? job->end_ms : now_ms;
    double load = 0;

    for (uint32_t i = 0; i < job->nparts; i++)
        if (job->parts[i].load_s > load)
            load = job->parts[i].load_s;
    return json_pack(
        "{s:f,s:f,s:f,s:f,s:f,s:f,s:f}", "wall_s",
        s->compile_s + seconds(job->offer_ms, end), "compile_s", s->compile_s,
        "transfer_s", seconds(job->offer_ms, job->open_ms), "load_s", load,
        "estimate_s", (double)job->estimate_ms / 1000, "render_s",
        seconds(job->first_ms, job->last_ms), "write_s",
        job_over(job) && job->last_ms ? seconds(job->last_ms, end) : 0.0);
}

/* Sum over accepted units, tiles and the estimate. */
static struct msg_counts
sum_counts(const struct job *job)
{
    uint32_t n = job->partition ? partition_total(job->partition) : 0;
    struct msg_counts t = job->surveyed;

    t.speculative_rays += job->late_rays;
    msg_counts_add(&t, &job->tiled);
    for (uint32_t i = 0; i < n; i++)
        if (job->units[i].state == UNIT_DONE)
            msg_counts_add(&t, &job->units[i].counts);
    return t;
}

static json_t *
totals(const struct job *job)
{
    struct msg_counts t = sum_counts(job);
    uint64_t sent = 0, received = 0, redundant = 0;
    uint64_t line_bytes = job->base_line_bytes, line_pixels = 0;
    uint64_t dropped = 0;
    uint32_t took_part = 0;

    for (uint32_t i = 0; i < job->nparts; i++) {
        struct msg_tally w = part_tally(&job->parts[i]);

        dropped += w.dropped.rays; /* rays whose results were not accepted */
        sent += w.ambient_sent;
        received += w.ambient_received;
        redundant += w.ambient_redundant;
        line_bytes += w.base_line_bytes;
        line_pixels += w.base_line_pixels;
        took_part += job->parts[i].took_part;
    }
    return json_pack(
        "{s:I,s:I,s:I,s:I,s:f,s:I,s:I,s:I,s:I,s:I,s:I,s:I,s:I,s:I,"
        "s:f,"
        "s:I,s:I,s:I,"
        "s:I,"
        "s:I,s:I}",
        "rays", integer(t.rays), "dropped_rays", integer(dropped), "tile_rays",
        integer(job->tiled.rays), "tile_values",
        integer(job->tiled.ambient_values), "tile_s", job->tiled.cpu_s,
        "reused_values", integer(job->cache.reused), "primary_rays",
        integer(t.primary_rays), "speculative_rays",
        integer(t.speculative_rays), "shadow_rays", integer(t.shadow_rays),
        "ambient_rays", integer(t.ambient_rays), "intersection_tests",
        integer(t.intersection_tests), "ambient_values",
        integer(t.ambient_values), "ambient_sent", integer(sent),
        "ambient_received", integer(received), "ambient_redundant",
        took_part > 1 ? (double)redundant / (took_part - 1) : 0.0, "nan_pixels",
        integer(t.nan.pixels), "units_redone", integer(job->units_redone),
        "estimate_rays", integer(t.estimate_rays), "paint_rays",
        integer(t.paint_rays), "base_line_bytes", integer(line_bytes),
        "base_line_pixels", integer(line_pixels));
}

static json_t *
workers(const struct job *job)
{
    json_t *list = json_array();

    for (uint32_t i = 0; i < job->nparts; i++) {
        const struct job_part *part = &job->parts[i];
        struct msg_tally t = part_tally(part);
        double wait = t.wait_base_line_s, work = t.busy_s - wait;
        double busy = work > part->cpu_s ? work : part->cpu_s;
        double idle =
            part->threads * seconds(part->ready_ms, job->last_ms) - busy - wait;

        if (!part->took_part)
            continue;
        json_array_append_new(
            list,
            json_pack("{s:s,s:I,s:I,s:I,s:f,s:f,s:f,s:I,s:I,s:I,s:I}", "name",
                      part->name, "threads", (json_int_t)part->threads, "rays",
                      integer(part_rays(part)), "rays_under_way",
                      integer(part_under_way(part)), "busy_s", busy, "idle_s",
                      idle > 0 ? idle : 0.0, "wait_base_line_s", wait,
                      "bytes_in", integer(t.bytes_in), "bytes_out",
                      integer(t.bytes_out), "peak_rss_bytes",
                      integer(t.peak_rss_bytes), "units",
                      (json_int_t)part->units));
    }
    return list;
}

/* Is the cost of each line of each frame known? */
static bool
knows_lines(const struct job *job)
{
    for (uint32_t k = 0; k < job->spec.nframes; k++)
        if (!job->frames[k].line_s || job->frames[k].untold || job->lives > 0)
            return false;
    return true;
}

/* A unit; times are since the job was submitted. */
static json_t *
unit(const struct job *job, uint32_t i)
{
    const struct job_unit *u = &job->units[i];
    struct partition_area a;
    double end = seconds(job->submit_ms, u->end_ms);
    double start = end > u->counts.wall_s ? end - u->counts.wall_s : 0;

    partition_area(job->partition, i, &a);
    return json_pack(
        "{s:I,s:I,s:I,s:I,s:I,s:I,s:I,s:I,s:f,s:f,s:f,s:f,s:s,s:I}", "frame",
        (json_int_t)job->spec.frames[a.frame].number, "x", (json_int_t)a.x, "y",
        (json_int_t)a.y, "width", (json_int_t)a.width, "height",
        (json_int_t)a.height, "rays", integer(u->counts.rays), "primary_rays",
        integer(u->counts.primary_rays), "intersection_tests",
        integer(u->counts.intersection_tests), "estimate",
        partition_cost(job->partition, i), "cpu_s", u->counts.cpu_s, "start_s",
        start, "end_s", end, "worker", job->parts[u->part].name, "attempts",
        (json_int_t)u->tries);
}

/* An attempt at a unit that is out. */
static json_t *
attempt(const struct job *job, const struct job_attempt *attempt,
        uint64_t now_ms)
{
    struct partition_area a;

    partition_area(job->partition, attempt->unit, &a);
    return json_pack("{s:I,s:I,s:I,s:I,s:I,s:f,s:f,s:s}", "frame",
                     (json_int_t)job->spec.frames[a.frame].number, "x",
                     (json_int_t)a.x, "y", (json_int_t)a.y, "width",
                     (json_int_t)a.width, "height", (json_int_t)a.height,
                     "start_s", seconds(job->submit_ms, attempt->out_ms),
                     "end_s", seconds(job->submit_ms, now_ms), "worker",
                     job->parts[attempt->part].name);
}

/* The attempts under way. */
static json_t *
running(const struct job *job, uint64_t now_ms)
{
    json_t *list = json_array();
    size_t n = 0;

    for (uint32_t k = 0; k < job->nout && !job_over(job); k++) {
        const struct job_unit *u = &job->units[job->out[k]];

        for (uint8_t g = 0; g < u->nattempts && n < MOST_RUNNING; g++)
            if (u->attempts[g].state != ATTEMPT_OVER &&
                u->attempts[g].origin != ATTEMPT_LOAN) {
                json_array_append_new(list,
                                      attempt(job, &u->attempts[g], now_ms));
                n++;
            }
    }
    return list;
}

/* The passes that were closed, each with the time since the pass before. */
static json_t *
passes(const struct job *job)
{
    json_t *list = json_array();
    double start = 0;

    for (uint32_t i = 0; i < job->cache.nclosed; i++) {
        double end = seconds(job->submit_ms, job->cache.closed_ms[i]);

        json_array_append_new(
            list, json_pack("{s:f,s:f}", "start_s", start, "end_s", end));
        start = end;
    }
    return list;
}

/* Add the job's goal, if it has any, and how far the goal was reached. */
static json_t *
with_goal(json_t *o, const struct job *job)
{
    const struct job_goal *g = &job->goal;

    if (o && msg_has_goal(&job->spec))
        json_object_set_new(
            o, "goal",
            json_pack("{s:f,s:f,s:f,s:f,s:I,s:b,s:b,s:b,s:b}", "error",
                      job->spec.error_ppm / 1e6, "time_s",
                      job->spec.time_ms / 1e3, "estimate", g->error,
                      "mean_estimate", g->mean, "stages",
                      (json_int_t)g->number + 1, "time_up", goal_time_up(job),
                      "rays_up", goal_rays_up(job), "stages_up",
                      stages_are_all(job), "by_clock", g->by_clock));
    return o;
}

/* All but the lists of units and lines. */
static json_t *
head(const struct job *job, uint64_t now_ms)
{
    const struct msg_spec *s = &job->spec;
    const struct partition *p = job->partition;
    struct rad_error_estimate error = progress_error(job);
    struct job_size size = job_size(job);
    char options[RAD_FILTER_OPTIONS], reuse[MSG_JOB_HEX] = "";
    bool said = jobtext_options(goal_options(job), s->oversample, s->clamp,
                                options, NULL) == 0;
    json_t *o;

    if (s->reuse)
        msg_job_format(s->reuse, reuse);
    o = json_pack(
        "{s:s,s:s,s:s,s:s,s:s,s:o,s:I,s:s,s:I,s:{s:I,s:I,s:I,s:o},"
        "s:{s:I,s:I,s:I},s:o,s:o,s:{s:f,s:f,s:f,s:f},s:o,s:o,s:o}",
        "job", job->hex, "radd", PACKAGE_VERSION, "options",
        said ? options : goal_options(job), "partition",
        partition_kind_name(p ? partition_kind(p) : s->partition), "choice",
        p ? partition_choice(p) : "", "fingerprint", fingerprint(job), "seed",
        integer(s->seed), "reuse", reuse, "oversample",
        integer(size.oversample), "scene", "objects", (json_int_t)s->objects,
        "bundle_bytes", integer(s->bundle_bytes), "sent_bytes",
        integer(job->sent_bytes), "needs", lists_words(s->needs), "picture",
        "width", (json_int_t)size.width, "height", (json_int_t)size.height,
        "frames", (json_int_t)s->nframes, "time", times(job, now_ms), "totals",
        totals(job), "error", "estimate", error.all, "ambient", error.ambient,
        "sampling", error.sampling, "left_out", progress_left_out(job),
        "workers", workers(job), "passes", passes(job), "running",
        running(job, now_ms));
    return with_goal(o, job);
}

/* --- as text --- */

struct stats_text {
    struct rad_memory_out text;
    uint32_t unit;        /* the next unit to write */
    uint32_t frame, line; /* the next line to write */
    bool any;             /* the list being written is not empty */
    enum { IN_UNITS, IN_LINES, AT_END } at;
};

static bool
put_text(struct stats_text *t, const char *s)
{
    return rad_memory_add(&t->text, s, strlen(s), NULL) == 0;
}

/* Write one more item of a list; takes the item. */
static bool
put_entry(struct stats_text *t, json_t *value)
{
    char *s = value
                  ? json_dumps(value, JSON_ENCODE_ANY | JSON_REAL_PRECISION(9))
                  : NULL;
    bool ok = s && put_text(t, t->any ? ",\n  " : "\n  ") && put_text(t, s);

    t->any = true;
    free(s);
    json_decref(value);
    return ok;
}

static bool
put_units(struct stats_text *t, const struct job *job, uint32_t *left)
{
    uint32_t n = job->partition ? partition_total(job->partition) : 0;

    for (; *left > 0 && t->unit < n; t->unit++, --*left)
        if (job->units[t->unit].state == UNIT_DONE &&
            !put_entry(t, unit(job, t->unit)))
            return false;
    if (t->unit < n)
        return true;
    t->at = knows_lines(job) ? IN_LINES : AT_END;
    return put_text(t,
                    t->at == IN_LINES ? "\n ],\n \"line_s\": [\n [" : "\n ]");
}

static bool
put_lines(struct stats_text *t, const struct job *job, uint32_t *left)
{
    const struct job_frame *f = &job->frames[t->frame];

    t->any = t->line > 0;
    for (; *left > 0 && t->line < f->nlines; t->line++, --*left)
        if (!put_entry(t, json_real(f->line_s[t->line])))
            return false;
    if (t->line < f->nlines)
        return true;
    t->line = 0;
    if (++t->frame < job->spec.nframes)
        return put_text(t, "],\n [");
    t->at = AT_END;
    return put_text(t, "]\n ]");
}

int
stats_more(struct stats_text *t, const struct job *job, uint32_t most)
{
    bool ok = true;

    while (ok && most > 0 && t->at != AT_END)
        ok = t->at == IN_UNITS ? put_units(t, job, &most)
                               : put_lines(t, job, &most);
    if (!ok)
        return RAD_ENOMEM;
    if (t->at != AT_END)
        return 0;
    return rad_memory_add(&t->text, "\n}", sizeof "\n}", NULL) == 0
               ? 1
               : RAD_ENOMEM;
}

struct stats_text *
stats_begin(const struct job *job, uint64_t now_ms)
{
    struct stats_text *t = calloc(1, sizeof *t);
    json_t *root = head(job, now_ms);
    char *s =
        root ? json_dumps(root, JSON_INDENT(1) | JSON_REAL_PRECISION(9)) : NULL;

    json_decref(root);
    /* without the closing brace: further lists follow */
    if (!t || !s ||
        rad_memory_add(&t->text, s, strlen(s) - strlen("\n}"), NULL) != 0 ||
        !put_text(t, ",\n \"units\": [")) {
        stats_free(t);
        t = NULL;
    }
    free(s);
    return t;
}

void
stats_free(struct stats_text *t)
{
    if (!t)
        return;
    free(t->text.bytes);
    free(t);
}

char *
stats_take(struct stats_text *t)
{
    char *text = (char *)t->text.bytes;

    free(t);
    return text;
}
