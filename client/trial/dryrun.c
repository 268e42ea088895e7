/* dryrun.c - see dryrun.h */
#include "config.h"

#include "trial/dryrun.h"
#include "common/figure.h"
#include "job/quality.h"

#include "image/filter.h"
#include "machine/lists.h"

#include <inttypes.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ANSWER_MS = 5000 };

/* --- the cluster --- */

static int
take_status(struct dryrun_cluster *c, const struct msg *m,
            struct rad_error *err)
{
    json_int_t workers, threads, jobs, drained = 0, drained_threads = 0;
    json_t *j =
        json_loadb((const char *)m->answer.text, m->answer.len, 0, NULL);
    int rc = json_unpack(j, "{s:I,s:I,s:I,s?I,s?I}", "workers", &workers,
                         "threads", &threads, "jobs", &jobs, "drained",
                         &drained, "drained_threads", &drained_threads);

    json_decref(j);
    if (rc != 0)
        return rad_fail(err, RAD_EPROTO, "an answer that is no status");
    c->workers = (int)(workers - drained);
    c->threads = (int)(threads - drained_threads);
    c->drained = (int)drained;
    c->jobs = (int)jobs;
    return 0;
}

int
dryrun_ask(struct dryrun_cluster *c, const struct link_where *where,
           const struct target *to, struct rad_error *err)
{
    struct msg ask = { .type = MSG_QUERY, .request = 1 };
    const struct msg *m;
    struct link *l;
    int rc = link_open(&l, where, to, MSG_ROLE_USER, ANSWER_MS, err);

    if (rc < 0)
        return rc;
    ask.query.what = MSG_QUERY_STATUS;
    ask.query.text = "";
    rc = link_send(l, &ask, err);
    do {
        if (rc == 0)
            rc = link_recv(l, ANSWER_MS, &m, err);
        if (rc == 0)
            rc = rad_fail(err, RAD_EUNAVAIL, "the coordinator does not answer");
    } while (rc > 0 && m->request != 1 && (rc = 0) == 0);
    if (rc > 0 && m->type == MSG_FAILED)
        rc = rad_fail(err, link_code(m->failed.status), "%s", m->failed.text);
    else if (rc > 0)
        rc = m->type == MSG_ANSWER
                 ? take_status(c, m, err)
                 : rad_fail(err, RAD_EPROTO, "no answer to a query");
    link_close(l);
    return rc;
}

/* --- the trial --- */

/* The view of the middle frame. */
static int
read_view(struct rad_view *view, const struct dryrun_job *job,
          struct rad_error *err)
{
    const struct msg_frame *middle = &job->frames[job->nframes / 2];
    size_t n = strlen(middle->view) + sizeof "VIEW= ";
    char *text = malloc(n);
    int rc;

    if (!text)
        return rad_fail_memory(err);
    snprintf(text, n, "VIEW= %s", middle->view);
    rad_view_init(view);
    rc = rad_view_read(view, text, strlen(text), err);
    free(text);
    return rc < 0 ? rc : 0;
}

int
dryrun_predict(struct prediction *p, const struct dryrun_job *job,
               struct rad_error *err)
{
    struct rad_view view;
    struct trial_scene tried = { job->scene,  &job->files, &view,
                                 job->points, job->passes, job->oversample };
    struct trial t;
    double pixels = 0;
    int rc = job->points ? 0 : read_view(&view, job, err);

    if (rc < 0 || (rc = trial_run(&t, &tried, job->params, err)) < 0)
        return rc;
    for (uint32_t i = 0; i < job->nframes; i++)
        pixels += (double)job->frames[i].width * job->frames[i].height;
    trial_predict(&t, pixels, p);
    p->points = job->points ? job->points->n : 0;
    return 0;
}

/* --- output --- */

/* Elapsed seconds if the cluster does nothing else: each worker loads the
 * scene, and all threads share the rest. */
static double
wall_seconds(const struct prediction *p, const struct dryrun_cluster *c)
{
    int n = c->threads > 0 ? c->threads : 1;

    return p->load_s + (p->cpu_s - p->load_s) / n;
}

static void
print_seconds(double s)
{
    char text[FIGURE_TEXT];

    if (s < 100)
        printf("%s s", figure(text, s, 2));
    else if (s < 6000)
        printf("%.0f min", s / 60);
    else
        printf("%.1f h", s / 3600);
}

static void
print_count(double n)
{
    char text[FIGURE_TEXT];

    if (n < 1e4)
        printf("%.0f", n);
    else if (n < 1e7)
        printf("%.0f thousand", n / 1e3);
    else
        printf("%s million", figure(text, n / 1e6, 3));
}

static void
print_picture(const struct msg_spec *spec, const struct prediction *p)
{
    int n = msg_oversample(spec);

    if (p->points > 0)
        printf("points   %" PRIu32, p->points);
    else
        printf("picture  %d x %d",
               rad_filter_side((int)spec->frames[0].width, n),
               rad_filter_side((int)spec->frames[0].height, n));
    if (n > 1)
        printf(" of %d x %d samples a pixel", n, n);
    if (spec->nframes > 1)
        printf(", %u frames", (unsigned)spec->nframes);
    printf("\n");
}

static void
print_cluster(const struct dryrun_cluster *c)
{
    printf("cluster  %d worker%s, %d thread%s%s", c->workers,
           c->workers == 1 ? "" : "s", c->threads, c->threads == 1 ? "" : "s",
           c->embedded ? ", of its own" : "");
    if (c->drained > 0)
        printf(" (%d drained)", c->drained);
    if (c->jobs > 0)
        printf(", which %s %d job%s already", c->jobs == 1 ? "has" : "have",
               c->jobs, c->jobs == 1 ? "" : "s");
    printf("\n");
}

void
dryrun_print(const struct msg_spec *spec, const struct prediction *p,
             int quality, const struct dryrun_cluster *c)
{
    char text[FIGURE_TEXT];
    double least, most;
    int len;

    printf("scene    %u objects, %s MB of files\n", (unsigned)spec->objects,
           figure(text, (double)spec->bundle_bytes / 1e6, 3));
    printf("needs    %s\n", spec->needs);
    printf("memory   %.0f MB of each worker\n", p->bytes / 1e6);
    print_picture(spec, p);
    print_cluster(c);
    printf("rays     ");
    print_count(p->rays);
    printf(", ");
    print_count(p->primary_rays);
    printf(" of them primary; ambient values: ");
    print_count(p->ambient_values);
    printf("\ntime     ");
    print_seconds(p->cpu_s);
    printf(" of one processor like this one");
    if (c->threads > 0) {
        printf("; about ");
        print_seconds(wall_seconds(p, c));
    }
    printf("\n");
    if (p->error.all > 0)
        printf("error    about %s %%\n", figure(text, 100 * p->error.all, 2));
    if (quality >= 0 && quality_promise(quality, &least, &most)) {
        const char *word = quality_word(quality, &len);

        printf("quality  %.*s, which left %g to %g %% on six scenes\n", len,
               word, least, most);
    }
}

char *
dryrun_json(const struct msg_spec *spec, const char *options,
            const struct prediction *p, const struct dryrun_cluster *c)
{
    int n = msg_oversample(spec);
    json_t *j = json_pack(
        "{s:b,s:s,s:s,s:I,s:i,s:{s:I,s:I,s:o},s:{s:i,s:i,s:I},"
        "s:{s:b,s:i,s:i,s:i,s:i},"
        "s:{s:f,s:f,s:f,s:f,s:f,s:f,s:f,s:{s:f,s:f,s:f}}}",
        "dry_run", 1, "radd", PACKAGE_VERSION, "options", options, "seed",
        (json_int_t)(spec->seed & INT64_MAX), "oversample", n, "scene",
        "objects", (json_int_t)spec->objects, "bundle_bytes",
        (json_int_t)spec->bundle_bytes, "needs", lists_words(spec->needs),
        "picture", "width", rad_filter_side((int)spec->frames[0].width, n),
        "height", rad_filter_side((int)spec->frames[0].height, n), "frames",
        (json_int_t)spec->nframes, "cluster", "embedded", (int)c->embedded,
        "workers", c->workers, "threads", c->threads, "drained", c->drained,
        "jobs", c->jobs, "predicted", "wall_s", wall_seconds(p, c), "cpu_s",
        p->cpu_s, "load_s", p->load_s, "rays", p->rays, "primary_rays",
        p->primary_rays, "ambient_values", p->ambient_values, "memory_bytes",
        p->bytes, "error", "estimate", p->error.all, "ambient",
        p->error.ambient, "sampling", p->error.sampling);
    char *text;

    if (p->points > 0)
        json_object_set_new(j, "points", json_integer(p->points));
    text = j ? json_dumps(j, JSON_INDENT(1)) : NULL;

    json_decref(j);
    return text;
}

char *
dryrun_json_of_none(const struct msg_spec *s)
{
    json_t *j = json_pack(
        "{s:s,s:s,s:s,s:I,s:{s:I,s:I,s:I,s:o},s:{s:I,s:I,s:I},s:{s:f},s:{s:i}}",
        "job", "", "radd", PACKAGE_VERSION, "options", s->params, "seed",
        (json_int_t)(s->seed & INT64_MAX), "scene", "objects",
        (json_int_t)s->objects, "bundle_bytes", (json_int_t)s->bundle_bytes,
        "sent_bytes", (json_int_t)0, "needs", lists_words(s->needs), "picture",
        "width", (json_int_t)s->frames[0].width, "height",
        (json_int_t)s->frames[0].height, "frames", (json_int_t)s->nframes,
        "time", "compile_s", s->compile_s, "totals", "rays", 0);
    char *text = j ? json_dumps(j, JSON_INDENT(1)) : NULL;

    json_decref(j);
    return text;
}
