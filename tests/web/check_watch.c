/* check_watch.c - what radweb asks its coordinator for: of jobs that are looked
 * at one picture or one statistics at a time, whatever their number and size;
 * of its lists the jobs that run, however many wait */
#include "config.h"

#include "ground/sanitized.h"
#include "image/edge.h"
#include "observer/model.h"
#include "observer/watch.h"
#include "tests/unit.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sysexits.h>

/* --- a coordinator: the session's functions, which keep what is asked --- */

#define MOST 64

struct session {
    bool up;
    struct question {
        struct msg m;
        char text[MSG_JOB_HEX]; /* of a query */
        uint8_t job[MSG_JOB];   /* of a fetch */
        char state[20];         /* of a page */
        size_t most;
        bool head;
        session_fn *fn;
        void *arg;
    } asked[MOST];
    unsigned n;
    unsigned fetches; /* ever */
};

bool
session_is_up(const struct session *s)
{
    return s->up;
}

const char *
session_why(const struct session *s)
{
    return s->up ? "" : "a test";
}

bool
session_ask(struct session *s, struct msg *m, size_t most, bool head,
            session_fn *fn, void *arg)
{
    struct question *q = &s->asked[s->n];

    if (!s->up || s->n == MOST)
        return false;
    s->n++;
    *q = (struct question){
        .m = *m, .most = most, .head = head, .fn = fn, .arg = arg
    };
    if (m->type == MSG_QUERY)
        snprintf(q->text, sizeof q->text, "%s", m->query.text);
    if (m->type == MSG_PAGE)
        snprintf(q->state, sizeof q->state, "%s", m->page.state);
    if (m->type == MSG_FETCH) {
        memcpy(q->job, m->fetch.job, MSG_JOB);
        s->fetches++;
    }
    return true;
}

static void
answer_with(struct session *s, unsigned i, const struct session_answer *a)
{
    struct question q = s->asked[i];

    memmove(s->asked + i, s->asked + i + 1, (--s->n - i) * sizeof s->asked[0]);
    q.fn(q.arg, a);
}

static void
answer(struct session *s, unsigned i, const void *bytes, size_t n)
{
    struct session_answer a = { .bytes = bytes, .n = n };
    size_t most = s->asked[i].most;

    if (n > most && s->asked[i].head)
        a.n = most;
    else if (n > most)
        a = (struct session_answer){ .status = 65, .text = "too large" };
    answer_with(s, i, &a);
}

/* --- jobs that are looked at --- */

static struct session session;
static struct watches watches;

static void
no_news(void *arg, struct watch *w)
{
    (void)arg;
    (void)w;
}

static void
begin(uv_loop_t *loop)
{
    ck_assert_int_eq(uv_loop_init(loop), 0);
    session = (struct session){ .up = true };
    watch_init(&watches, loop, &session, no_news, NULL);
}

static void
end(uv_loop_t *loop)
{
    uv_run(loop, UV_RUN_DEFAULT);
    watch_release(&watches);
    ck_assert_int_eq(uv_loop_close(loop), 0);
}

static const char *
hex_of(unsigned i)
{
    static char hex[MSG_JOB_HEX];

    snprintf(hex, sizeof hex, "%032x", i + 1);
    return hex;
}

/* Answer all that is asked about details: a job that runs. */
static void
tell_details(int side)
{
    char text[300];

    for (unsigned i = 0; i < session.n;) {
        const struct question *q = &session.asked[i];

        if (q->m.type != MSG_QUERY) {
            i++;
            continue;
        }
        snprintf(text, sizeof text,
                 "{\"job\":\"%s\",\"state\":\"running\",\"done\":0.5,"
                 "\"width\":%d,\"height\":%d}",
                 q->text, side, side);
        answer(&session, i, text, strlen(text));
    }
}

static unsigned
fetches_out(void)
{
    unsigned n = 0;

    for (unsigned i = 0; i < session.n; i++)
        n += session.asked[i].m.type == MSG_FETCH;
    return n;
}

TEST(one_picture_at_a_time_is_asked_for)
{
    uv_loop_t loop;

    begin(&loop);
    for (unsigned i = 0; i < WATCH_MOST; i++)
        ck_assert_ptr_nonnull(watch_look_at(&watches, hex_of(i), 0));
    watch_tick(&watches);
    ck_assert_uint_eq(session.n, WATCH_MOST);
    tell_details(100);
    for (int i = 0; i < 5; i++) {
        watch_tick(&watches);
        ck_assert_uint_eq(fetches_out(), 1);
    }
    while (session.n > 0)
        answer(&session, 0, "", 0);
    end(&loop);
}

/* Whoever goes through many jobs does not have those that gave way asked about
 * anew each time. */
TEST(jobs_that_gave_way_keep_their_pace)
{
    uv_loop_t loop;
    unsigned fetches = 0;

    begin(&loop);
    for (unsigned turn = 0; turn < 6; turn++) {
        for (unsigned i = 0; i < 2 * WATCH_MOST; i++) {
            ck_assert_ptr_nonnull(watch_look_at(&watches, hex_of(i), 0));
            for (int k = 0; k < 3; k++) {
                uv_update_time(&loop);
                watches.rest_ms = 0;
                watch_tick(&watches);
                tell_details(100);
                while (session.n > 0)
                    answer(&session, 0, "", 0);
                uv_run(&loop, UV_RUN_DEFAULT);
            }
        }
        if (turn == 0)
            fetches = session.fetches;
    }
    ck_assert_uint_ge(fetches, WATCH_MOST);
    ck_assert_uint_le(session.fetches, 4 * WATCH_MOST);
    end(&loop);
}

/* An answer about the picture, which was asked for before, comes behind. */
TEST(why_a_job_is_gone_is_not_forgotten)
{
    static const struct session_answer deleted = { .status = EX_NOINPUT,
                                                   .text = "deleted" },
                                       none = { .status = EX_NOINPUT,
                                                .text = "no such picture" };
    struct watch *w;
    uv_loop_t loop;

    begin(&loop);
    w = watch_look_at(&watches, hex_of(0), 0);
    watch_tick(&watches);
    tell_details(100);
    watch_tick(&watches);
    ck_assert_uint_eq(fetches_out(), 1);
    if (session.asked[0].m.fetch.what != MSG_WHAT_PREVIEW) {
        answer(&session, 0, "", 0);
        uv_run(&loop, UV_RUN_DEFAULT);
        watches.rest_ms = 0;
        watch_tick(&watches);
    }
    ck_assert_uint_eq(session.asked[0].m.fetch.what, MSG_WHAT_PREVIEW);
    w->row.due_ms = 0;
    watch_tick(&watches);
    answer_with(&session, 1, &deleted);
    answer_with(&session, 0, &none);
    ck_assert_str_eq(w->gone, "deleted");
    end(&loop);
}

/* --- memory --- */

#define SIDE  4000 /* PICTURE_MOST pixels */
#define EDGES (SIDE * RAD_EDGE_ROW_BYTES(SIDE))

/* A picture whose lines cannot be packed, with room behind its *n bytes for
 * edges in all of its pixels. */
static uint8_t *
hdr_of(int side, size_t *n)
{
    size_t line = 4 + 4 * ((size_t)side + (size_t)(side + 127) / 128);
    uint8_t *hdr = calloc(1, 100 + (size_t)side * line + EDGES), *p = hdr;
    uint32_t noise = 1;

    ck_assert_ptr_nonnull(hdr);
    p += sprintf((char *)p,
                 "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n", side,
                 side);
    for (int y = 0; y < side; y++) {
        *p++ = 2;
        *p++ = 2;
        *p++ = (uint8_t)(side >> 8);
        *p++ = (uint8_t)(side & 255);
        for (int c = 0; c < 4; c++)
            for (int x = 0; x < side; x += 128) {
                int run = side - x < 128 ? side - x : 128;

                *p++ = (uint8_t)run;
                for (int i = 0; i < run; i++) {
                    noise = noise * 1664525 + 1013904223;
                    *p++ = (uint8_t)(c < 3 ? 128 | noise >> 25 : 128);
                }
            }
    }
    *n = (size_t)(p - hdr);
    return hdr;
}

/* Statistics of as many bytes as are taken. */
static char *
statistics(size_t *n)
{
    char *text = malloc(WATCH_STATS + 200);
    int at = sprintf(text, "{\"a\": 1,\n \"units\": [");

    while (at < WATCH_STATS - 200)
        at += sprintf(text + at,
                      "%s{\"worker\": \"w%d\", \"start_s\": %d, "
                      "\"end_s\": %d}",
                      text[at - 1] == '[' ? "" : ",\n", at % 16, at / 100,
                      at / 100 + 1);
    at += sprintf(text + at, "]}");
    *n = (size_t)at;
    return text;
}

static size_t
peak_mib(void)
{
    struct rusage u;

    getrusage(RUSAGE_SELF, &u);
    return (size_t)u.ru_maxrss >> 10;
}

TEST(the_largest_pictures_of_all_jobs_stay_within_bounds)
{
    uv_loop_t loop;
    size_t nhdr, nstats, own;
    uint8_t *hdr = hdr_of(SIDE, &nhdr);
    char *stats = statistics(&nstats);
    static const char few[] = "{\"a\": 1,\n \"units\": []}";
    bool told = false; /* the long ones */
    unsigned shown = 0;

    ck_assert_uint_le(nhdr, PICTURE_BYTES);
    own = (nhdr + nstats) >> 20; /* radweb has these, too, while they come */
    begin(&loop);
    for (unsigned i = 0; i < WATCH_MOST; i++)
        watch_follow(watch_look_at(&watches, hex_of(i), 0));
    while (shown < WATCH_MOST) {
        watches.rest_ms = 0; /* nothing is measured here but memory */
        uv_update_time(&loop);
        watch_tick(&watches);
        tell_details(SIDE);
        ck_assert_uint_le(fetches_out(), 1);
        if (session.n > 0) { /* all else is answered */
            bool picture = session.asked[0].m.fetch.what == MSG_WHAT_PREVIEW;

            if (picture)
                answer(&session, 0, hdr, nhdr + EDGES);
            else
                answer(&session, 0, told ? few : stats,
                       told ? strlen(few) : nstats);
            told |= !picture;
        }
        uv_run(&loop, UV_RUN_DEFAULT);
        shown = 0;
        for (const struct watch *w = watches.first; w; w = w->next)
            shown += w->rgbe && w->units.head;
    }
    ck_assert_int_eq(watches.first->factor, 4);
    if (!RAD_SANITIZED)
        ck_assert_uint_le(peak_mib(), 320 + own);
    printf("%u pictures of %d x %d: %zu MiB at most, %zu of them the test's\n",
           shown, SIDE, SIDE, peak_mib(), own);
    for (struct watch *w = watches.first; w; w = w->next)
        watch_leave(w);
    end(&loop);
    free(hdr);
    free(stats);
}

/* --- lists --- */

static void
no_change(void *arg)
{
    (void)arg;
}

/* A page of jobs from number `first` down to `last`; so many rays each. */
static void
tell_jobs(const char *state, unsigned first, unsigned last, double rays,
          unsigned next)
{
    json_t *rows = json_array(), *page;
    char *text;

    for (unsigned i = first + 1; i-- > last;)
        json_array_append_new(rows, json_pack("{s:s,s:s,s:f,s:i}", "job",
                                              hex_of(i), "state", state, "rays",
                                              rays, "priority", 0));
    page = json_pack("{s:o,s:i}", "rows", rows, "next", (int)next);
    text = json_dumps(page, 0);
    answer(&session, 0, text, strlen(text));
    free(text);
    json_decref(page);
}

/* One round: jobs 5000 to 4001 wait and are listed, job 3 runs behind them. */
static void
round_of(struct model *m, uv_loop_t *loop, double rays)
{
    m->due_ms = 0;
    uv_update_time(loop);
    model_tick(m);
    ck_assert_int_eq(session.asked[0].m.type, MSG_QUERY);
    answer(&session, 0, "{}", 2);
    tell_jobs("idle", 0, 1, 0, 0); /* no workers */
    for (unsigned i = 5000; i > 4000; i -= 200) {
        ck_assert_str_eq(session.asked[0].state, "open");
        tell_jobs("waiting", i, i - 199, 0, i - 199);
    }
    ck_assert_str_eq(session.asked[0].state, "running");
    tell_jobs("running", 3, 3, rays, 0);
    ck_assert_str_eq(session.asked[0].state, "over");
    tell_jobs("done", 0, 1, 0, 0);
    ck_assert_uint_eq(session.n, 0);
}

TEST(jobs_that_run_are_listed_behind_those_that_wait)
{
    uv_loop_t loop;
    struct model m;

    ck_assert_int_eq(uv_loop_init(&loop), 0);
    session = (struct session){ .up = true };
    ck_assert(model_init(&m, &loop, &session, no_change, NULL));
    round_of(&m, &loop, 1e6);
    ck_assert(m.up);
    ck_assert_uint_eq(json_array_size(m.open), 1001);
    ck_assert_double_eq(m.sums.rays, 0); /* from before we came */
    round_of(&m, &loop, 3e6);
    ck_assert_double_eq(m.sums.rays, 2e6);
    model_release(&m);
    uv_loop_close(&loop);
}

TEST(lists_without_end_are_given_up)
{
    uv_loop_t loop;
    struct model m;
    char *text = malloc(MSG_MAX + 1);
    unsigned pages = 0;

    ck_assert_int_eq(uv_loop_init(&loop), 0);
    session = (struct session){ .up = true };
    ck_assert(model_init(&m, &loop, &session, no_change, NULL));
    model_tick(&m);
    answer(&session, 0, "{}", 2);
    while (session.n > 0 && pages < 100) {
        int n = sprintf(text, "{\"rows\":[\"%0*d\"],\"next\":%u}", 200000, 0,
                        ++pages);

        answer(&session, 0, text, (size_t)n);
    }
    ck_assert_uint_le(pages, (MODEL_TEXT) / 200000 + 1);
    ck_assert(!m.up);
    model_release(&m);
    uv_loop_close(&loop);
    free(text);
}
