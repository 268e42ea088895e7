/* events.c - pages that stay open: server-sent events; see radweb_impl.h
 *
 * An event has the page's sections as they are now; it is made once for all
 * streams of the same page.  A stream that has sent its event waits until there
 * is a newer event, so a slow reader misses the events in between. */
#include "config.h"

#include "web/radweb_impl.h"

#include "web/answer.h"
#include "web/page.h"

#include <stdlib.h>
#include <string.h>

#define SIGN_MS 15000 /* without an event, until a sign of life is sent */

struct stream {
    struct stream *next;
    struct radweb *r;
    struct MHD_Connection *conn;
    struct watch *watch; /* of the page's job; NULL: the cluster's page */
    uint64_t version;    /* of the event that is being sent, or was sent last */
    struct blob *now;    /* the event that is being sent; NULL: none is */
    size_t at;
    bool put_off, sign;
    uint64_t sent_ms;
};

/* --- events --- */

/* Make an event of a page's sections: each line of HTML becomes a line of data.
 */
static struct blob *
make_event(struct markup *page)
{
    struct markup m = { 0 };
    size_t n = 0;
    char *text = markup_take(page, &n), *end = NULL;

    if (!text)
        return NULL;
    markup_raw(&m, "retry: 3000\n");
    for (char *p = text; *p; p = end) {
        end = p + strcspn(p, "\r\n");
        markup_raw(&m, "data: ");
        markup_bytes(&m, p, (size_t)(end - p));
        markup_raw(&m, "\n");
        end += *end != '\0';
    }
    markup_raw(&m, "\n");
    free(text);
    return answer_made(&m);
}

static struct blob *
home_event(struct radweb *r)
{
    struct radweb_sheet *s = &r->event;
    struct markup m = { 0 };

    if (!s->blob || s->version != r->model.version || !r->model.up) {
        page_home(&m, &r->model);
        blob_unref(s->blob);
        s->blob = make_event(&m);
        s->version = r->model.version;
    }
    return blob_ref(s->blob);
}

static struct blob *
job_event(struct radweb *r, struct watch *w)
{
    struct markup m = { 0 };

    if (!w->event || w->event_version != w->version || !r->model.up) {
        page_job(&m, &r->model, w);
        blob_unref(w->event);
        w->event = make_event(&m);
        w->event_version = w->version;
    }
    return blob_ref(w->event);
}

static uint64_t
version_of(const struct stream *s)
{
    return s->watch ? s->watch->version : s->r->model.version;
}

/* Begin the newest event, unless this stream has sent it. */
static void
take_event(struct stream *s)
{
    if (s->version == version_of(s) ||
        (s->watch && !s->watch->detail && !s->watch->gone[0]) ||
        blob_alive() > BLOB_MOST)
        return;
    s->version = version_of(s);
    s->now = s->watch ? job_event(s->r, s->watch) : home_event(s->r);
    s->at = 0;
}

/* --- streams --- */

/* Has the page been told that its job is gone?  Nothing more comes then. */
static bool
is_last(const struct stream *s)
{
    return s->watch && s->watch->gone[0] && s->version == version_of(s);
}

static ssize_t
read_stream(void *arg, uint64_t pos, char *buf, size_t most)
{
    static const char sign[] = "event: sign\ndata: -\n\n";
    struct stream *s = arg;
    size_t n;

    (void)pos;
    if (s->r->closing)
        return MHD_CONTENT_READER_END_OF_STREAM;
    if (!s->now)
        take_event(s);
    if (!s->now && is_last(s))
        return MHD_CONTENT_READER_END_OF_STREAM;
    if (!s->now && s->sign && most >= sizeof sign) {
        s->sign = false;
        memcpy(buf, sign, sizeof sign - 1);
        return sizeof sign - 1;
    }
    if (!s->now) {
        s->put_off = true;
        serve_put_off(s->conn);
        return 0;
    }
    n = s->now->len - s->at < most ? s->now->len - s->at : most;
    memcpy(buf, s->now->bytes + s->at, n);
    s->at += n;
    s->sent_ms = uv_now(&s->r->daemon.loop);
    if (s->at == s->now->len) {
        blob_unref(s->now);
        s->now = NULL;
    }
    return (ssize_t)n;
}

static void
end_stream(void *arg)
{
    struct stream *s = arg, **at = &s->r->streams;

    while (*at != s)
        at = &(*at)->next;
    *at = s->next;
    s->r->served.streams--;
    if (s->watch)
        watch_leave(s->watch);
    blob_unref(s->now);
    free(s);
}

enum MHD_Result
events_begin(struct radweb *r, struct MHD_Connection *c, struct watch *w)
{
    struct MHD_Response *response;
    struct stream *s;

    if (r->served.streams >= SERVE_STREAMS)
        return answer_error(c, r->path, MHD_HTTP_SERVICE_UNAVAILABLE,
                            "too many pages are open");
    s = calloc(1, sizeof *s);
    if (!s)
        return MHD_NO;
    *s = (struct stream){ .next = r->streams,
                          .r = r,
                          .conn = c,
                          .watch = w,
                          .version = UINT64_MAX,
                          .sent_ms = uv_now(&r->daemon.loop) };
    r->streams = s;
    r->served.streams++;
    if (w)
        watch_follow(w);
    response = MHD_create_response_from_callback(MHD_SIZE_UNKNOWN, 8192,
                                                 read_stream, s, end_stream);
    if (!response) {
        end_stream(s);
        return MHD_NO;
    }
    serve_is_stream(c);
    return answer_send(c, MHD_HTTP_OK, "text/event-stream", response);
}

static void
go_on(struct stream *s)
{
    if (!s->put_off)
        return;
    s->put_off = false;
    serve_wake(s->conn);
}

void
events_wake(struct radweb *r, const struct watch *w)
{
    for (struct stream *s = r->streams; s; s = s->next)
        if (s->watch == w)
            go_on(s);
}

void
events_tick(struct radweb *r)
{
    uint64_t now = uv_now(&r->daemon.loop);

    if (r->streams)
        model_seen(&r->model);
    for (struct stream *s = r->streams; s; s = s->next) {
        if (now - s->sent_ms < SIGN_MS && !r->closing)
            continue;
        s->sent_ms = now;
        s->sign = true;
        if (!r->model.up)
            s->version = UINT64_MAX; /* the age of the data has changed */
        go_on(s);
    }
}
