/* check_listing.c - tests of daemon/front/listing.c: lists of any length, in
 * pages; and of what makes them shorter */
#include "config.h"

#include "coord_fixture.h"

#include "front/listing.h"

FIXTURE(set_up, tear_down)

enum { JOBS = 3000 };

static void
make_job(int i, uint64_t conn)
{
    uint8_t id[MSG_JOB] = { (uint8_t)(i >> 8), (uint8_t)i, 7 };
    struct msg cancel = { .type = MSG_CANCEL, .request = 6, .cancel = { id } };

    submit(conn, id, i % 7 - 3);
    if (i % 10 != 0)
        say(conn, &cancel);
}

/* The rows of all pages, in their order; each page is small enough.  Between
 * pages `between` changes something. */
static json_t *
walk(uint64_t conn, struct msg_page ask, void (*between)(int page))
{
    json_t *all = json_array(), *page, *rows;
    int n = 0;

    do {
        struct msg m = { .type = MSG_PAGE, .request = 9, .page = ask };
        const struct msg *answer = &f.last[conn];

        say(conn, &m);
        ck_assert_int_eq(answer->type, MSG_ANSWER);
        ck_assert_uint_lt(answer->answer.len, LISTING_BYTES + 65536);
        page = json_loadb((const char *)answer->answer.text, answer->answer.len,
                          0, NULL);
        ck_assert_ptr_nonnull(page);
        rows = json_object_get(page, "rows");
        ck_assert_uint_le(json_array_size(rows), LISTING_ROWS);
        if (ask.most > 0)
            ck_assert_uint_le(json_array_size(rows), ask.most);
        json_array_extend(all, rows);
        ask.cursor =
            (uint64_t)json_integer_value(json_object_get(page, "next"));
        json_decref(page);
        if (between)
            between(n);
        n++;
        ck_assert_int_lt(n, 2 * JOBS);
    } while (ask.cursor != 0);
    return all;
}

static int
number_of(const json_t *row)
{
    unsigned i;

    sscanf(json_string_value(json_object_get(row, "job")), "%4x", &i);
    return (int)i;
}

static void
many_jobs(void)
{
    struct coord_keep keep = { .jobs = 100000 };

    coord_closed(f.c, f.now_ms, WORKER, "gone"); /* nobody starts them */

    coord_set_keep(f.c, &keep);
    for (int i = 1; i <= JOBS; i++)
        make_job(i, i % 2 ? ANA : BOB);
}

TEST(all_jobs_come_newest_first)
{
    static const uint32_t most[] = { 0, 7, 1000000 };
    json_t *all;

    many_jobs();
    for (int k = 0; k < N_ELEM(most); k++) {
        all =
            walk(ANA, (struct msg_page){ MSG_ROWS_JOBS, 0, "", "", 0, most[k] },
                 NULL);
        ck_assert_uint_eq(json_array_size(all), JOBS);
        for (size_t i = 0; i < JOBS; i++)
            ck_assert_int_eq(number_of(json_array_get(all, i)), JOBS - (int)i);
        json_decref(all);
    }
}

static const struct {
    const char *user, *state;
    uint8_t mine;
    size_t n;
} asked[] = {
    { "bob", "", 0, JOBS / 2 },
    { "ana", "cancelled", 0, JOBS / 2 },
    { "bob", "cancelled", 0, JOBS / 2 - JOBS / 10 },
    { "", "open", 0, JOBS / 10 },
    { "", "over", 0, JOBS - JOBS / 10 },
    { "", "", 1, JOBS / 2 },
    { "bob", "", 1, 0 }, /* ana asks */
    { "eve", "", 0, 0 },
    { "", "done", 0, 0 },
};

TEST(rows_are_those_asked_for)
{
    json_t *all;

    many_jobs();
    for (int i = 0; i < N_ELEM(asked); i++) {
        all = walk(ANA,
                   (struct msg_page){ MSG_ROWS_JOBS, asked[i].mine,
                                      asked[i].user, asked[i].state, 0, 0 },
                   NULL);
        ck_assert_msg(json_array_size(all) == asked[i].n,
                      "user '%s' state '%s' mine %d: %zu", asked[i].user,
                      asked[i].state, asked[i].mine, json_array_size(all));
        json_decref(all);
    }
}

/* A new job, and one that is forgotten: the ones that were told last. */
static void
stir(int page)
{
    struct coord_keep keep = { .jobs = JOBS - JOBS / 10 };

    make_job(JOBS + 1 + page, BOB);
    coord_set_keep(f.c, &keep);
    carry_out();
}

TEST(jobs_that_stay_come_once_whatever_else_comes_and_goes)
{
    json_t *all;
    size_t n;
    int last = JOBS + 1;

    many_jobs();
    all = walk(ANA, (struct msg_page){ MSG_ROWS_JOBS, 0, "", "", 0, 0 }, stir);
    n = json_array_size(all);
    ck_assert_uint_gt(n, JOBS - 2 * JOBS / LISTING_ROWS);
    for (size_t i = 0; i < n; i++) { /* those that came are not there */
        int number = number_of(json_array_get(all, i));

        ck_assert_int_lt(number, last);
        while (--last > number) { /* and no others went */
            uint8_t id[MSG_JOB] = { (uint8_t)(last >> 8), (uint8_t)last, 7 };

            ck_assert_ptr_null(desk_find_job(f.c, id));
        }
    }
    json_decref(all);
}

/* Names that are all escapes: pages have a bound in bytes, too. */
TEST(long_rows_make_short_pages)
{
    char name[2001];
    json_t *all;

    memset(name, 1, sizeof name - 1);
    name[sizeof name - 1] = '\0';
    for (int i = 1; i <= 500; i++) {
        uint8_t id[MSG_JOB] = { (uint8_t)(i >> 8), (uint8_t)i, 7 };
        struct msg m = usual_submit(id);

        m.submit.name = name;
        say(ANA, &m);
    }
    all = walk(ANA, (struct msg_page){ MSG_ROWS_JOBS, 0, "", "", 0, 0 }, NULL);
    ck_assert_uint_eq(json_array_size(all), 500);
    json_decref(all);
}

/* QUERY asks for the whole list: an answer that is too long for a message is
 * not made. */
TEST(a_whole_list_that_is_too_long_is_refused)
{
    struct msg m = { .type = MSG_QUERY, .query = { MSG_QUERY_JOBS, "" } };

    many_jobs();
    say(ANA, &m);
    ck_assert_int_eq(f.last[ANA].type, MSG_FAILED);
    ck_assert_int_eq(f.last[ANA].failed.status, EX_PROTOCOL);
    m.query.what = MSG_QUERY_WORKERS;
    say(ANA, &m);
    ck_assert_int_eq(f.last[ANA].type, MSG_ANSWER);
}

TEST(workers_come_in_pages)
{
    char name[20];
    json_t *all;

    for (int i = 0; i < 3000; i++) { /* one after the other, all but WORKER */
        snprintf(name, sizeof name, "host%d", i);
        join(SECOND, MSG_ROLE_WORKER, name, "");
        cut(SECOND);
    }
    all =
        walk(ANA, (struct msg_page){ MSG_ROWS_WORKERS, 0, "", "", 0, 0 }, NULL);
    ck_assert_uint_eq(json_array_size(all), 3001);
    for (size_t i = 1; i < 3001; i++) {
        snprintf(name, sizeof name, "host%d", (int)i - 1);
        ck_assert_str_eq(
            json_string_value(json_object_get(json_array_get(all, i), "name")),
            name);
    }
    json_decref(all);
    all = walk(ANA, (struct msg_page){ MSG_ROWS_WORKERS, 0, "", "gone", 0, 0 },
               NULL);
    ck_assert_uint_eq(json_array_size(all), 3000);
    json_decref(all);
}

/* The status of what was last refused; 0: it was not. */
static int
status_for(uint64_t conn)
{
    const struct msg *m = &f.last[conn];

    return m->type == MSG_FAILED ? m->failed.status : 0;
}

/* What the store was still at for a job is nothing to the next one of its id.
 */
TEST(a_deleted_jobs_rows_and_pictures_are_not_the_next_ones)
{
    struct action_rows rows = { .unit = 5, .frame = 7, .rows = 1, .width = 8 };
    uint64_t gone;

    submit(ANA, job_a, 0);
    rows.sequence = gone = desk_find_job(f.c, job_a)->sequence;
    memcpy(rows.job, job_a, MSG_JOB);
    about(ANA, MSG_CANCEL, job_a);
    about(ANA, MSG_DELETE, job_a);
    submit(ANA, job_a, 0);
    ck_assert_int_eq(f.last[ANA].type, MSG_ACCEPT);
    coord_rows_stored(f.c, f.now_ms, &rows, 0, NULL);
    coord_rows_stored(f.c, f.now_ms, &rows, EX_IOERR, "the job is gone");
    coord_picture_written(f.c, f.now_ms, job_a, gone, 0, 0, NULL);
    coord_picture_written(f.c, f.now_ms, job_a, gone, 7, 0, NULL);
    coord_picture_written(f.c, f.now_ms, job_a, gone, 0, EX_IOERR, "gone");
    ck_assert(!job_over(desk_find_job(f.c, job_a)));
    ck_assert_uint_eq(desk_find_job(f.c, job_a)->frames_ready, 0);
}

/* Likewise its opening, which fails when it was cancelled before it had room,
 * and its end. */
TEST(a_deleted_jobs_opening_and_end_are_not_the_next_ones)
{
    struct job *job;
    uint64_t gone;

    f.stuck = true;
    submit(ANA, job_a, 0);
    gone = desk_find_job(f.c, job_a)->sequence;
    about(ANA, MSG_CANCEL, job_a);
    about(ANA, MSG_DELETE, job_a);
    submit(ANA, job_a, 0);
    job = desk_find_job(f.c, job_a);
    coord_job_waits(f.c, f.now_ms, job_a, gone, "it is large");
    ck_assert(job->place != PLACE_NO_ROOM);
    coord_job_opened(f.c, f.now_ms, job_a, gone, 0, "");
    ck_assert(job->place != PLACE_OPEN);
    coord_job_opened(f.c, f.now_ms, job_a, gone, EX_TEMPFAIL, "it is over");
    coord_job_filed(f.c, f.now_ms, job_a, gone, 900, 0);
    ck_assert(!job_over(job));
    ck_assert_uint_eq(job->kept_bytes, 0);
    coord_job_opened(f.c, f.now_ms, job_a, job->sequence, 0, "");
    ck_assert(job->place == PLACE_OPEN);
}

TEST(owner_and_admin_delete_a_job_that_is_over)
{
    submit(ANA, job_a, 0);
    submit(ANA, job_b, 0);
    about(ANA, MSG_DELETE, job_a);
    ck_assert_int_eq(status_for(ANA), EX_USAGE);
    about(ANA, MSG_CANCEL, job_a);
    about(ANA, MSG_CANCEL, job_b);
    about(BOB, MSG_DELETE, job_a);
    ck_assert_int_eq(status_for(BOB), EX_NOPERM);
    ck_assert_uint_eq(f.c->njobs, 2);
    about(ANA, MSG_DELETE, job_a);
    ck_assert_int_eq(f.last[ANA].type, MSG_ANSWER);
    ck_assert_ptr_null(desk_find_job(f.c, job_a));
    about(ADMIN, MSG_DELETE, job_b);
    ck_assert_int_eq(f.last[ADMIN].type, MSG_ANSWER);
    ck_assert_uint_eq(f.c->njobs, 0);
    about(ADMIN, MSG_DELETE, job_b);
    ck_assert_int_eq(status_for(ADMIN), EX_NOINPUT);
}

static void
forget(const char *name)
{
    struct msg m = { .type = MSG_FORGET, .request = 7, .forget = { name } };

    say(ADMIN, &m);
}

static size_t
workers_told(void)
{
    json_t *all =
        walk(ANA, (struct msg_page){ MSG_ROWS_WORKERS, 0, "", "", 0, 0 }, NULL);
    size_t n = json_array_size(all);

    json_decref(all);
    return n;
}

static void
expect_away(const char *state, const char *word, const char *note)
{
    json_t *all = walk(
        ANA, (struct msg_page){ MSG_ROWS_WORKERS, 0, "", state, 0, 0 }, NULL);
    const json_t *row = json_array_get(all, 0);

    ck_assert_uint_eq(json_array_size(all), 1);
    ck_assert_str_eq(json_string_value(json_object_get(row, "away")), word);
    ck_assert_str_eq(json_string_value(json_object_get(row, "text")), note);
    json_decref(all);
}

static const struct {
    int sender; /* of DRAIN; 0: nobody says it */
    uint8_t why;
    const char *word, *note, *note_gone; /* NULL: as before */
} leaves[] = {
    { 0, 0, "", "", "no connection to it" },
    { ADMIN, MSG_DRAIN_ORDER, "order", "drained by an administrator",
      "no connection to it" },
    { SECOND, MSG_DRAIN_ORDER, "stopped", "it was stopped", NULL },
    { SECOND, MSG_DRAIN_STOPPED, "stopped", "it was stopped", NULL },
    { SECOND, MSG_DRAIN_HOURS, "hours", "outside hours of its radd.conf",
      NULL },
    { SECOND, MSG_DRAIN_IN_USE, "in use",
      "somebody uses the machine (idle_only of its radd.conf)", NULL },
};

LOOP_TEST(a_worker_that_gets_no_work_says_why, N_ELEM(leaves))
{
    struct msg drain = { .type = MSG_DRAIN,
                         .drain = { "ws2", leaves[_i].why } };
    const char *gone = leaves[_i].note_gone;

    coord_closed(f.c, f.now_ms, WORKER, "gone");
    forget("ws1");
    join(SECOND, MSG_ROLE_WORKER, "ws2", "");
    if (leaves[_i].sender)
        say((uint64_t)leaves[_i].sender, &drain);
    if (leaves[_i].sender != SECOND) { /* which is let go at once */
        expect_away("", leaves[_i].word, leaves[_i].note);
        cut(SECOND);
    }
    expect_away("gone", leaves[_i].word, gone ? gone : leaves[_i].note);
}

TEST(a_worker_that_is_gone_is_forgotten)
{
    struct msg drain = { .type = MSG_DRAIN, .drain = { .name = "ws2" } };

    join(SECOND, MSG_ROLE_WORKER, "ws2", "");
    forget("ws2");
    ck_assert_int_eq(status_for(ADMIN), EX_USAGE);
    forget("ws3");
    ck_assert_int_eq(status_for(ADMIN), EX_NOINPUT);
    cut(SECOND);
    ck_assert_uint_eq(workers_told(), 2);
    forget("ws2");
    ck_assert_int_eq(f.last[ADMIN].type, MSG_ANSWER);
    ck_assert_uint_eq(workers_told(), 1);
    ck_assert_ptr_null(f.c->workers->next);
    say(ADMIN, &drain);
    ck_assert_int_eq(status_for(ADMIN), EX_NOINPUT);
}

/* A job that is kept says who worked on it, as long as it is. */
TEST(a_forgotten_worker_of_a_job_goes_with_that)
{
    submit(ANA, job_a, 0);
    join(SECOND, MSG_ROLE_WORKER, "ws2", "");
    ready(SECOND, job_a);
    cut(SECOND);
    forget("ws2");
    ck_assert_uint_eq(workers_told(), 1);
    ck_assert_ptr_nonnull(f.c->workers->next);
    join(SECOND, MSG_ROLE_WORKER, "ws2", ""); /* it is back */
    ck_assert_uint_eq(workers_told(), 2);
    cut(SECOND);
    forget("ws2");
    about(ANA, MSG_CANCEL, job_a);
    about(ANA, MSG_DELETE, job_a);
    ck_assert_ptr_null(f.c->workers->next);
}
