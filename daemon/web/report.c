/* report.c - see report.h */
#include "config.h"

#include "web/report.h"

#include <inttypes.h>
#include <string.h>

/* --- JSON --- */

/* Begin an answer: the version of the API, whether the coordinator answers, and
 * the age of the data. */
static void
begin(struct markup *m, const struct model *c)
{
    double age =
        c->asked_ms ? (double)(uv_now(c->loop) - c->asked_ms) / 1000 : -1;

    markup_print(m, "{\"api\":1,\"up\":%s,\"age_s\":%.3f,",
                 c->up ? "true" : "false", age);
}

static void
put_rows(struct markup *m, const char *name, const json_t *rows)
{
    markup_print(m, "\"%s\":", name);
    markup_json(m, rows);
}

void
report_status(struct markup *m, const struct model *c)
{
    begin(m, c);
    markup_print(m, "\"rays_s\":%.9g,\"at_work\":%.6g,", c->rays_s, c->at_work);
    put_rows(m, "status", c->status);
    markup_raw(m, "}\n");
}

void
report_workers(struct markup *m, const struct model *c)
{
    begin(m, c);
    put_rows(m, "workers", c->workers);
    markup_raw(m, "}\n");
}

void
report_jobs(struct markup *m, const struct model *c)
{
    begin(m, c);
    put_rows(m, "open", c->open);
    markup_raw(m, ",");
    put_rows(m, "over", c->over);
    markup_raw(m, "}\n");
}

void
report_history(struct markup *m, const struct model *c)
{
    begin(m, c);
    markup_print(m, "\"step_s\":%d,\"points\":[", HISTORY_STEP_S);
    for (unsigned i = HISTORY_POINTS; i-- > 0;) {
        const struct history_point *p = history_at(&c->history, i);

        if (p->notes > 0)
            markup_print(m, "{\"rays_s\":%.9g,\"at_work\":%.6g}", p->rays_s,
                         p->at_work);
        else
            markup_raw(m, "null");
        markup_raw(m, i > 0 ? "," : "]}\n");
    }
}

void
report_job(struct markup *m, const struct watch *w)
{
    markup_raw(m, "{\"api\":1,");
    put_rows(m, "job", w->detail);
    if (w->units.head) {
        markup_raw(m, ",");
        put_rows(m, "statistics", w->units.head);
    }
    if (w->rgbe)
        markup_print(m,
                     ",\"picture\":{\"frame\":%u,\"version\":%" PRIu64
                     ",\"width\":%d,\"height\":%d,\"factor\":%d}",
                     w->frame, w->picture_version, w->width, w->height,
                     w->factor);
    markup_raw(m, "}\n");
}

/* --- OpenMetrics --- */

static void
put_type(struct markup *m, const char *name, const char *type, const char *help)
{
    markup_print(m, "# TYPE %s %s\n# HELP %s %s\n", name, type, name, help);
}

static void
put_gauge(struct markup *m, const char *name, const char *help, double v)
{
    put_type(m, name, "gauge", help);
    markup_print(m, "%s %.15g\n", name, v);
}

static void
put_counter(struct markup *m, const char *name, const char *help, double v)
{
    put_type(m, name, "counter", help);
    markup_print(m, "%s_total %.15g\n", name, v);
}

static void
put_states(struct markup *m, const char *name, const json_t *rows,
           const char *const states[])
{
    for (int i = 0; states[i]; i++) {
        const json_t *row;
        unsigned n = 0;
        size_t k;

        json_array_foreach(rows, k, row) n +=
            strcmp(markup_member(row, "state"), states[i]) == 0;
        markup_print(m, "%s{state=\"%s\"} %u\n", name, states[i], n);
    }
}

/* Age of the job that has waited for longest, of the jobs that wait. */
static double
oldest(const json_t *jobs)
{
    const json_t *row;
    double s = 0, at;
    size_t i;

    json_array_foreach(jobs, i, row)
    {
        at = markup_number(row, "elapsed_s");
        if (strcmp(markup_member(row, "state"), "waiting") == 0 && at > s)
            s = at;
    }
    return s;
}

static void
put_cluster(struct markup *m, const struct model *c)
{
    static const char *const workers[] = { "idle",     "loading", "working",
                                           "draining", "drained", "no room",
                                           "gone",     NULL };
    static const char *const jobs[] = { "waiting", "running", "paused", "held",
                                        NULL };

    put_type(m, "radd_workers", "gauge", "workers by state");
    put_states(m, "radd_workers", c->workers, workers);
    put_gauge(m, "radd_threads", "threads of the workers that are there",
              markup_number(c->status, "threads"));
    put_gauge(m, "radd_threads_at_work_ratio",
              "share of these whose worker is at work", c->at_work);
    put_type(m, "radd_jobs", "gauge", "jobs that are not over by state");
    put_states(m, "radd_jobs", c->open, jobs);
    put_gauge(m, "radd_jobs_kept", "jobs that the coordinator remembers",
              markup_number(c->status, "jobs_kept"));
    put_gauge(m, "radd_queue_oldest_seconds",
              "for how long the job that waits for longest has",
              oldest(c->open));
    put_gauge(m, "radd_kept_bytes", "on the disk, of jobs that are over",
              markup_number(c->status, "kept_bytes"));
    put_gauge(m, "radd_disk_full", "1 while jobs are held for want of room",
              json_is_true(json_object_get(c->status, "disk_full")));
    put_counter(m, "radd_slow_turns",
                "turns of the coordinator's loop that took long",
                markup_number(c->status, "slow_turns"));
}

static void
put_sums(struct markup *m, const struct model *c)
{
    const struct model_sums *s = &c->sums;

    put_counter(m, "radd_rays", "rays of all jobs since radweb started",
                s->rays);
    put_counter(m, "radd_worker_bytes", "bytes that jobs' workers sent",
                s->bytes);
    put_counter(m, "radd_redundant_values",
                "ambient values that a worker got and had made, too",
                s->redundant);
    put_type(m, "radd_jobs_ended", "counter", "jobs that ended");
    markup_print(m,
                 "radd_jobs_ended_total{state=\"done\"} %" PRIu64
                 "\nradd_jobs_ended_total{state=\"failed\"} %" PRIu64
                 "\nradd_jobs_ended_total{state=\"cancelled\"} %" PRIu64 "\n",
                 s->done, s->failed, s->cancelled);
}

void
report_metrics(struct markup *m, const struct model *c,
               const struct report_served *s)
{
    put_gauge(m, "radd_up", "1 while the coordinator answers", c->up);
    put_cluster(m, c);
    put_sums(m, c);
    put_counter(m, "radweb_polls", "times that the coordinator was asked",
                (double)c->sums.polls);
    put_counter(m, "radweb_lost", "times that it did not answer",
                (double)c->sums.lost);
    put_counter(m, "radweb_requests", "requests of browsers",
                (double)s->requests);
    put_counter(m, "radweb_refused", "requests that were refused",
                (double)s->refused);
    put_gauge(m, "radweb_streams", "pages that are open", s->streams);
    put_gauge(m, "radweb_connections", "of browsers", s->guests);
    put_gauge(m, "radweb_answer_bytes", "of answers that are kept",
              (double)s->answer_bytes);
    markup_raw(m, "# EOF\n");
}
