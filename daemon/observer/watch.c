/* watch.c - see watch.h */
#include "config.h"

#include "observer/watch.h"

#include "base/text.h"
#include "machine/lists.h"
#include "observer/markup.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define DETAIL_MS  1000
#define STATS_MS   4000
#define PICTURE_MS 2000
#define SLOWER     20 /* a request that took t is sent again after 20 t */

static void
note_change(struct watch *w)
{
    w->version++;
    w->all->changed(w->all->arg, w);
}

/* Write the job's progress as a text.  The picture and the statistics are asked
 * for again only when this text has changed. */
static void
state_of(const struct watch *w, char text[96])
{
    snprintf(text, 96, "%.20s %.9g %.0f %.9g %.0f",
             markup_member(w->detail, "state"),
             markup_number(w->detail, "done"),
             markup_number(w->detail, "units_done"),
             markup_number(w->detail, "pass_done"),
             markup_number(w->detail, "pass"));
}

/* --- decoding, off the loop --- */

struct work {
    uv_work_t req;
    struct watch *watch;
    char *bytes;
    size_t n;
    bool partial;
    int rc;
    struct rad_error err;
    struct units units;
    struct picture picture;
};

static void
free_work(struct work *k)
{
    units_release(&k->units);
    picture_release(&k->picture);
    free(k->bytes);
    free(k);
}

static struct work *
new_work(struct watch *w, const struct session_answer *a)
{
    struct work *k = calloc(1, sizeof *k);

    if (!k)
        return NULL;
    k->watch = w;
    k->req.data = k;
    k->partial = !lists_is_over(w->detail);
    k->n = a->n;
    k->bytes = malloc(a->n + 1);
    if (!k->bytes) {
        free(k);
        return NULL;
    }
    memcpy(k->bytes, a->bytes, a->n);
    return k;
}

/* Ask for statistics or a picture. */
static void
begin(struct watch *w, struct watch_query *q, struct msg *m, size_t most,
      session_fn *answer)
{
    state_of(w, q->of);
    q->from_ms = uv_now(w->all->loop);
    q->out = session_ask(w->all->session, m, most, q == &w->picture, answer, w);
    if (!q->out)
        q->of[0] = '\0';
}

/* End a request; came: its answer can be used.  The request is due again after
 * SLOWER times as long as it took, and at least least_ms.  No picture or
 * statistics are asked for meanwhile for as long as it took. */
static void
end(struct watch *w, struct watch_query *q, unsigned least_ms, bool came)
{
    uint64_t now = uv_now(w->all->loop), took = now - q->from_ms;
    uint64_t wait = SLOWER * took;

    q->out = false;
    q->answered = true;
    q->due_ms = now + (wait > least_ms ? wait : least_ms);
    w->all->rest_ms = now + took;
    if (!came)
        q->of[0] = '\0';
}

/* --- statistics --- */

static void
run_stats(uv_work_t *req)
{
    struct work *k = req->data;

    k->rc = units_read(&k->units, k->bytes, k->n, &k->err);
}

static void
stats_done(uv_work_t *req, int status)
{
    struct work *k = req->data;
    struct watch *w = k->watch;

    end(w, &w->stats, STATS_MS, true);
    if (status == 0 && k->rc == 0) {
        struct units had = w->units;

        w->units = k->units;
        k->units = had;
        note_change(w);
    }
    free_work(k);
}

static void
on_stats(void *arg, const struct session_answer *a)
{
    struct watch *w = arg;
    struct work *k = a->status == 0 ? new_work(w, a) : NULL;

    if (k && uv_queue_work(w->all->loop, &k->req, run_stats, stats_done) == 0)
        return;
    if (k)
        free_work(k);
    end(w, &w->stats, STATS_MS, false);
}

static void
ask_stats(struct watch *w)
{
    struct msg m = { .type = MSG_FETCH, .fetch = { w->id, 0, MSG_WHAT_STATS } };

    begin(w, &w->stats, &m, WATCH_STATS, on_stats);
}

/* --- picture --- */

static void
run_picture(uv_work_t *req)
{
    struct work *k = req->data;

    k->rc = picture_make(&k->picture, (const uint8_t *)k->bytes, k->n,
                         k->partial, &k->err);
}

static void
end_picture(struct watch *w, const char *note)
{
    end(w, &w->picture, PICTURE_MS, note[0] == '\0');
    rad_text_print(w->note, sizeof w->note, "%s", note);
}

static void
take_picture(struct watch *w, struct picture *p)
{
    blob_unref(w->rgbe);
    blob_unref(w->png);
    w->rgbe = blob_new((char *)p->rgbe, p->nrgbe);
    w->png = blob_new((char *)p->png, p->npng);
    p->rgbe = p->png = NULL;
    w->width = p->width;
    w->height = p->height;
    w->factor = p->factor;
    memcpy(w->view, p->view, sizeof w->view);
    memcpy(w->scene, p->scene, sizeof w->scene);
    w->picture_version++;
}

static void
picture_done(uv_work_t *req, int status)
{
    struct work *k = req->data;
    struct watch *w = k->watch;
    bool ok = status == 0 && k->rc == 0;

    end_picture(w, ok ? "" : k->err.what);
    if (ok)
        take_picture(w, &k->picture);
    note_change(w);
    free_work(k);
}

static void
on_picture(void *arg, const struct session_answer *a)
{
    struct watch *w = arg;
    struct work *k = a->status == 0 ? new_work(w, a) : NULL;
    bool new_note;

    if (k &&
        uv_queue_work(w->all->loop, &k->req, run_picture, picture_done) == 0)
        return;
    if (k)
        free_work(k);
    new_note = strcmp(w->note, a->status ? a->text : "") != 0;
    end_picture(w, a->status ? a->text : "out of memory");
    if (new_note)
        note_change(w);
}

static bool
too_large(struct watch *w)
{
    double n =
        markup_number(w->detail, "width") * markup_number(w->detail, "height");

    if (n <= PICTURE_MOST)
        return false;
    w->picture.from_ms = uv_now(w->all->loop);
    end_picture(w, "the picture has too many pixels to be shown here");
    return true;
}

static void
ask_picture(struct watch *w)
{
    struct msg m = { .type = MSG_FETCH,
                     .fetch = { w->id, w->frame, MSG_WHAT_PREVIEW } };

    if (!too_large(w))
        begin(w, &w->picture, &m, PICTURE_BYTES, on_picture);
}

/* --- details --- */

/* Take the job's row; false: it says nothing new, or is another's. */
static bool
take_detail(struct watch *w, json_t *row)
{
    if (strcmp(markup_member(row, "job"), w->hex) != 0 ||
        json_equal(row, w->detail)) {
        json_decref(row);
        return false;
    }
    json_decref(w->detail);
    w->detail = row;
    w->gone[0] = '\0';
    return true;
}

/* The coordinator has no such job (any more), and says why. */
static bool
take_absence(struct watch *w, const char *why)
{
    if (w->gone[0])
        return false;
    json_decref(w->detail);
    w->detail = NULL;
    rad_text_print(w->gone, sizeof w->gone, "%s", why);
    return true;
}

static void
on_detail(void *arg, const struct session_answer *a)
{
    struct watch *w = arg;
    bool news = false;

    w->row.out = false;
    w->row.answered = true;
    w->row.due_ms = uv_now(w->all->loop) + DETAIL_MS;
    if (a->status == 0)
        news =
            take_detail(w, json_loadb((const char *)a->bytes, a->n, 0, NULL));
    else if (a->status == EX_NOINPUT)
        news = take_absence(w, a->text);
    if (news)
        note_change(w);
}

static void
ask_detail(struct watch *w)
{
    struct msg m = { .type = MSG_QUERY, .query = { MSG_QUERY_JOB, w->hex } };

    w->row.out = session_ask(w->all->session, &m, MSG_MAX, false, on_detail, w);
}

/* --- when requests are due --- */

static bool
is_looked_at(const struct watch *w)
{
    return w->streams > 0 || uv_now(w->all->loop) - w->seen_ms < WATCH_SEEN_MS;
}

/* Is the request due before before_ms, and is there a reason to send it: has
 * the job made progress since the last answer, or is there no answer (!has)? */
static bool
is_due(const struct watch *w, const struct watch_query *q, uint64_t before_ms,
       bool has)
{
    char now[sizeof q->of];

    if (q->due_ms >= before_ms || !has)
        return q->due_ms < before_ms;
    state_of(w, now);
    return strcmp(now, q->of) != 0;
}

static void
ask_due_detail(struct watch *w)
{
    uint64_t now = uv_now(w->all->loop);

    if (!w->row.out && now >= w->row.due_ms &&
        !(w->detail && lists_is_over(w->detail) && w->stats.answered &&
          w->picture.answered && now < w->row.due_ms + 10 * DETAIL_MS))
        ask_detail(w);
}

/* Is a picture or are statistics on their way? */
static bool
is_busy(const struct watches *all)
{
    for (const struct watch *w = all->first; w; w = w->next)
        if (w->stats.out || w->picture.out)
            return true;
    return false;
}

/* Ask for the picture, or the statistics, that have been due for longest. */
static void
ask_longest_due(struct watches *all)
{
    uint64_t first_ms = uv_now(all->loop) + 1;
    bool room = blob_alive() <= WATCH_ALIVE, picture = false;
    struct watch *found = NULL;

    for (struct watch *w = all->first; w; w = w->next) {
        if (!is_looked_at(w) || !w->detail)
            continue;
        if (is_due(w, &w->stats, first_ms, w->units.head)) {
            found = w;
            first_ms = w->stats.due_ms;
            picture = false;
        }
        if (room && is_due(w, &w->picture, first_ms, w->rgbe)) {
            found = w;
            first_ms = w->picture.due_ms;
            picture = true;
        }
    }
    if (found)
        (picture ? ask_picture : ask_stats)(found);
}

void
watch_tick(struct watches *all)
{
    if (!session_is_up(all->session))
        return;
    for (struct watch *w = all->first; w; w = w->next)
        if (is_looked_at(w))
            ask_due_detail(w);
    if (!is_busy(all) && uv_now(all->loop) >= all->rest_ms)
        ask_longest_due(all);
}

/* --- jobs that are watched --- */

static void
free_watch(struct watch *w)
{
    json_decref(w->detail);
    units_release(&w->units);
    blob_unref(w->rgbe);
    blob_unref(w->png);
    blob_unref(w->event);
    free(w);
}

/* --- when jobs that were dropped may be asked for again --- */

static void
keep_pace(const struct watch *w)
{
    struct watch_pace *p = &w->all->paces[w->all->npaces++ % WATCH_PACES];

    *p = (struct watch_pace){ .frame = w->frame,
                              .stats_ms = w->stats.due_ms,
                              .picture_ms = w->picture.due_ms };
    memcpy(p->id, w->id, sizeof p->id);
}

/* Take the due times that were kept last for this job and frame. */
static void
take_pace(struct watch *w)
{
    const struct watches *all = w->all;

    for (unsigned i = 1; i <= WATCH_PACES && i <= all->npaces; i++) {
        const struct watch_pace *p =
            &all->paces[(all->npaces - i) % WATCH_PACES];

        if (p->frame != w->frame || memcmp(p->id, w->id, sizeof p->id) != 0)
            continue;
        w->stats.due_ms = p->stats_ms;
        w->picture.due_ms = p->picture_ms;
        return;
    }
}

/* --- making room --- */

/* Drop the watch that was looked at the longest ago; false: each watch is
 * followed by a page, or waits for an answer. */
static bool
make_room(struct watches *all)
{
    struct watch **oldest = NULL, *w;

    for (struct watch **at = &all->first; *at; at = &(*at)->next)
        if ((*at)->streams == 0 && !(*at)->row.out && !(*at)->stats.out &&
            !(*at)->picture.out &&
            (!oldest || (*at)->seen_ms < (*oldest)->seen_ms))
            oldest = at;
    if (!oldest)
        return false;
    w = *oldest;
    *oldest = w->next;
    all->n--;
    keep_pace(w);
    free_watch(w);
    return true;
}

static struct watch *
new_watch(struct watches *all, const char *hex, uint32_t frame)
{
    struct watch *w;

    if (all->n >= WATCH_MOST && !make_room(all))
        return NULL;
    w = calloc(1, sizeof *w);
    if (!w || !msg_job_parse(hex, w->id)) {
        free(w);
        return NULL;
    }
    w->all = all;
    w->frame = frame;
    msg_job_format(w->id, w->hex);
    take_pace(w);
    w->next = all->first;
    all->first = w;
    all->n++;
    return w;
}

struct watch *
watch_look_at(struct watches *all, const char *hex, uint32_t frame)
{
    struct watch *w = all->first;

    while (w && (w->frame != frame || strcmp(w->hex, hex) != 0))
        w = w->next;
    if (!w)
        w = new_watch(all, hex, frame);
    if (w)
        w->seen_ms = uv_now(all->loop);
    return w;
}

bool
watch_is_ready(const struct watch *w)
{
    return w->row.answered && (!w->detail || w->stats.answered);
}

bool
watch_has_picture(const struct watch *w)
{
    return w->row.answered && (!w->detail || w->picture.answered);
}

void
watch_follow(struct watch *w)
{
    w->streams++;
}

void
watch_leave(struct watch *w)
{
    w->streams--;
    w->seen_ms = uv_now(w->all->loop);
}

void
watch_init(struct watches *all, uv_loop_t *loop, struct session *s,
           void (*changed)(void *arg, struct watch *w), void *arg)
{
    *all = (struct watches){
        .session = s, .loop = loop, .changed = changed, .arg = arg
    };
}

void
watch_release(struct watches *all)
{
    while (all->first) {
        struct watch *w = all->first;

        all->first = w->next;
        free_watch(w);
    }
}
