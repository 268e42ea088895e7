/* route.c - the answer of each path; see radweb_impl.h */
#include "config.h"

#include "web/radweb_impl.h"

#include "base/number.h"
#include "web/answer.h"
#include "web/assets.h"
#include "web/page.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WAIT_MS 4000 /* longest wait for a job's data */

/* A request that waits until the coordinator has answered about its job. */
struct waiting {
    struct waiting *next;
    struct radweb *r;
    struct MHD_Connection *conn;
    uint64_t until_ms;
    char hex[MSG_JOB_HEX];
    uint32_t frame;
    bool picture; /* the request waits for the picture */
};

static const char html[] = "text/html; charset=utf-8";
static const char json[] = "application/json";

/* --- pages and lists of the cluster --- */

static void
whole_home(struct markup *m, const struct model *c)
{
    page_begin(m, "/", "radd cluster", "events");
    page_home(m, c);
    page_end(m, "/");
}

static const struct {
    const char *path, *type;
    void (*fill)(struct markup *m, const struct model *c);
} sheets[] = {
    { "/", html, whole_home },
    { "/api/v1/status.json", json, report_status },
    { "/api/v1/workers.json", json, report_workers },
    { "/api/v1/jobs.json", json, report_jobs },
    { "/api/v1/history.json", json, report_history },
};
enum { NSHEETS = sizeof sheets / sizeof sheets[0] };
_Static_assert(NSHEETS <= RADWEB_SHEETS, "a sheet without a place");

/* Send sheet number i, a page or list of the cluster.  It is made once for each
 * version of the model; while the coordinator is away for each request, for it
 * tells the age of the data. */
static enum MHD_Result
send_sheet(struct radweb *r, struct MHD_Connection *c, int i)
{
    struct radweb_sheet *s = &r->sheets[i];
    struct markup m = { 0 };

    if (!s->blob || s->version != r->model.version || !r->model.up) {
        sheets[i].fill(&m, &r->model);
        blob_unref(s->blob);
        s->blob = answer_made(&m);
        s->version = r->model.version;
    }
    return answer_blob(c, MHD_HTTP_OK, sheets[i].type, blob_ref(s->blob));
}

static enum MHD_Result
send_metrics(struct radweb *r, struct MHD_Connection *c)
{
    struct markup m = { 0 };

    r->served.guests = serve_guests(r->serve);
    r->served.answer_bytes = blob_alive();
    report_metrics(&m, &r->model, &r->served);
    return answer_text(c, MHD_HTTP_OK,
                       "application/openmetrics-text; version=1.0.0; "
                       "charset=utf-8",
                       &m);
}

static enum MHD_Result
send_asset(struct MHD_Connection *c, const struct asset *a)
{
    return answer_send(c, MHD_HTTP_OK, a->type,
                       MHD_create_response_from_buffer(
                           (size_t)(a->end - a->bytes), (void *)a->bytes,
                           MHD_RESPMEM_PERSISTENT));
}

/* --- pages and data of a job --- */

static enum MHD_Result
send_page(struct radweb *r, struct MHD_Connection *c, struct watch *w)
{
    struct markup m = { 0 };
    char events[100], title[200];

    snprintf(events, sizeof events, "%s/events?frame=%u", w->hex, w->frame);
    snprintf(title, sizeof title, "%.150s - radd",
             markup_member(w->detail, "name"));
    page_begin(&m, r->path, title, events);
    page_job(&m, &r->model, w);
    page_end(&m, r->path);
    return answer_text(c, MHD_HTTP_OK, html, &m);
}

static enum MHD_Result
send_job_json(struct radweb *r, struct MHD_Connection *c, struct watch *w)
{
    struct markup m = { 0 };

    (void)r;
    report_job(&m, w);
    return answer_text(c, MHD_HTTP_OK, json, &m);
}

static enum MHD_Result
send_png(struct radweb *r, struct MHD_Connection *c, struct watch *w)
{
    if (!w->png)
        return answer_error(c, r->path, MHD_HTTP_NOT_FOUND,
                            "there is no picture of it yet");
    return answer_blob(c, MHD_HTTP_OK, "image/png", blob_ref(w->png));
}

static enum MHD_Result
send_rgbe(struct radweb *r, struct MHD_Connection *c, struct watch *w)
{
    if (!w->rgbe)
        return answer_error(c, r->path, MHD_HTTP_NOT_FOUND,
                            "there is no picture of it yet");
    return answer_blob(c, MHD_HTTP_OK, "application/octet-stream",
                       blob_ref(w->rgbe));
}

static enum MHD_Result
send_events(struct radweb *r, struct MHD_Connection *c, struct watch *w)
{
    return events_begin(r, c, w);
}

/* The paths of a job: each consists of `ahead`, the 32 digits of the job's id,
 * and `behind`. */
static const struct job_path {
    const char *ahead, *behind;
    bool picture;
    enum MHD_Result (*send)(struct radweb *r, struct MHD_Connection *c,
                            struct watch *w);
} job_paths[] = {
    { "/jobs/", "", false, send_page },
    { "/jobs/", "/events", false, send_events },
    { "/jobs/", "/picture.png", true, send_png },
    { "/jobs/", "/picture.rgbe", true, send_rgbe },
    { "/api/v1/jobs/", ".json", false, send_job_json },
};

static const struct job_path *
find_job_path(const char *path, char hex[MSG_JOB_HEX])
{
    uint8_t id[MSG_JOB];

    for (size_t i = 0; i < sizeof job_paths / sizeof job_paths[0]; i++) {
        const struct job_path *p = &job_paths[i];
        size_t n = strlen(p->ahead);

        if (strncmp(path, p->ahead, n) != 0 ||
            strlen(path + n) < MSG_JOB_HEX - 1 ||
            strcmp(path + n + MSG_JOB_HEX - 1, p->behind) != 0)
            continue;
        snprintf(hex, MSG_JOB_HEX, "%s", path + n);
        if (!msg_job_parse(hex, id))
            return NULL;
        msg_job_format(id, hex);
        return p;
    }
    return NULL;
}

static uint32_t
frame_of(struct MHD_Connection *c)
{
    const char *text =
        MHD_lookup_connection_value(c, MHD_GET_ARGUMENT_KIND, "frame");
    int n;

    return text && rad_parse_int(text, &n) && n >= 0 && n < MSG_MAX_FRAMES
               ? (uint32_t)n
               : 0;
}

/* --- requests that wait --- */

static void
forget(struct waiting *w)
{
    struct waiting **at = &w->r->waiting;

    while (*at && *at != w)
        at = &(*at)->next;
    if (*at)
        *at = w->next;
}

void
route_ended(void *arg, void *state)
{
    struct waiting *w = state;

    (void)arg;
    if (!w)
        return;
    forget(w);
    free(w);
}

static bool
is_ready(const struct watch *w, bool picture)
{
    return picture ? watch_has_picture(w) : watch_is_ready(w);
}

void
route_tick(struct radweb *r, bool all)
{
    uint64_t now = uv_now(&r->daemon.loop);

    for (struct waiting *w = r->waiting, *next; w; w = next) {
        /* a job is looked at as long as a request waits for it */
        struct watch *job = watch_look_at(&r->watches, w->hex, w->frame);

        next = w->next;
        if (!all && job && now < w->until_ms && !is_ready(job, w->picture))
            continue;
        forget(w);
        serve_wake(w->conn);
    }
}

static enum MHD_Result
put_off(struct radweb *r, struct MHD_Connection *c, const struct watch *job,
        bool picture, void **state)
{
    struct waiting *w = calloc(1, sizeof *w);

    if (!w)
        return MHD_NO;
    *w = (struct waiting){ .next = r->waiting,
                           .r = r,
                           .conn = c,
                           .until_ms = uv_now(&r->daemon.loop) + WAIT_MS,
                           .frame = job->frame,
                           .picture = picture };
    memcpy(w->hex, job->hex, sizeof w->hex);
    r->waiting = w;
    *state = w;
    serve_put_off(c);
    return MHD_YES;
}

static enum MHD_Result
send_job(struct radweb *r, struct MHD_Connection *c, const struct job_path *p,
         const char *hex, void **state)
{
    const struct waiting *was = *state;
    struct watch *w = watch_look_at(&r->watches, hex, frame_of(c));

    if (!w)
        return answer_error(c, r->path, MHD_HTTP_SERVICE_UNAVAILABLE,
                            "too many jobs are looked at just now");
    if (!is_ready(w, p->picture) && !was && !r->closing &&
        session_is_up(r->session))
        return put_off(r, c, w, p->picture, state);
    if (w->gone[0] && p->send == send_events)
        return send_events(r, c, w); /* a page that was hidden hears of it */
    if (!w->detail)
        return w->gone[0]
                   ? answer_error(c, r->path, MHD_HTTP_NOT_FOUND, w->gone)
                   : answer_error(c, r->path, MHD_HTTP_SERVICE_UNAVAILABLE,
                                  "the coordinator cannot be asked now");
    if (w->frame > 0 && w->frame >= markup_number(w->detail, "frames"))
        return answer_error(c, r->path, MHD_HTTP_NOT_FOUND,
                            "the job has no such frame");
    return p->send(r, c, w);
}

/* --- any path --- */

static enum MHD_Result
send_path(struct radweb *r, struct MHD_Connection *c, const char *path,
          void **state)
{
    const struct asset *a = assets_find(path);
    const struct job_path *p;
    char hex[MSG_JOB_HEX];

    if (a)
        return send_asset(c, a);
    if (blob_alive() > BLOB_MOST)
        return answer_error(c, r->path, MHD_HTTP_SERVICE_UNAVAILABLE,
                            "too many answers are not read yet");
    model_seen(&r->model);
    for (int i = 0; i < NSHEETS; i++)
        if (strcmp(path, sheets[i].path) == 0)
            return send_sheet(r, c, i);
    if (strcmp(path, "/metrics") == 0)
        return send_metrics(r, c);
    if (strcmp(path, "/events") == 0)
        return events_begin(r, c, NULL);
    p = find_job_path(path, hex);
    if (p)
        return send_job(r, c, p, hex, state);
    return answer_error(c, r->path, MHD_HTTP_NOT_FOUND,
                        "there is no such page");
}

enum MHD_Result
route_request(void *arg, struct MHD_Connection *c, const char *method,
              const char *path, void **state)
{
    struct radweb *r = arg;
    unsigned status;

    r->path = path;
    r->served.requests += *state == NULL;
    if (strcmp(method, "GET") != 0 && strcmp(method, "HEAD") != 0)
        return answer_error(c, r->path, MHD_HTTP_METHOD_NOT_ALLOWED,
                            "pages here are read, not written");
    status = radweb_refuses(r, c);
    if (status == MHD_HTTP_UNAUTHORIZED)
        return answer_error(c, r->path, status,
                            "this takes the token as password");
    if (status)
        return answer_error(c, r->path, status,
                            "the name by which you ask is none of this "
                            "machine's: a token would permit it");
    return send_path(r, c, path, state);
}
