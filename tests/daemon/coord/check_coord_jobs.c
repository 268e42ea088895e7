/* check_coord_jobs.c - the life of a job: submitted, steered, fetched,
 * cancelled */
#include "config.h"

#include "coord_fixture.h"

#include "jobs/progress.h"

FIXTURE(set_up, tear_down)

/* --- every job can be cancelled, and who does hears of it --- */

static void
disk_is_full(void)
{
    f.stuck = true;
    coord_fullness(f.c, f.now_ms, true, "cannot write 'x'");
    carry_out();
}

static void
disk_has_room(void)
{
    f.stuck = false;
    coord_fullness(f.c, f.now_ms, false, "");
    if (f.settling)
        coord_settled(f.c, f.now_ms, f.settling, f.settling_what);
    carry_out();
}

static void
be_begun(void)
{
    start_job();
    result(WORKER, job_a, 0, 1);
}

static void
be_without_files(void)
{
    f.have = false;
    submit(ANA, job_a, 0);
}

static void
be_held(void)
{
    disk_is_full();
    submit(ANA, job_a, 0);
}

static void
be_waiting(void)
{
    submit(ANA, job_a, 0);
}

static void
be_paused(void)
{
    be_begun();
    about(ANA, MSG_PAUSE, job_a);
}

static void
be_held_under_way(void)
{
    be_begun();
    disk_is_full();
}

static void
be_held_and_paused(void)
{
    be_paused();
    disk_is_full();
}

static void
be_done(void)
{
    be_begun();
    for (uint32_t i = 1; i < 4; i++)
        result(WORKER, job_a, i, 1);
    ck_assert_int_eq(f.last[ANA].type, MSG_DONE);
}

static void
be_cancelled(void)
{
    be_begun();
    about(ANA, MSG_CANCEL, job_a);
}

static void (*const states[])(void) = {
    be_without_files,   be_held,   be_waiting,
    be_begun,           be_paused, be_held_under_way,
    be_held_and_paused, be_done,   be_cancelled,
};

static bool
is_over(int state)
{
    return states[state] == be_done || states[state] == be_cancelled;
}

LOOP_TEST(cancel_is_answered_whatever_the_job_is_at, 2 * N_ELEM(states))
{
    unsigned before;

    tear_down();
    set_up_coord(_i % 2);
    states[_i / 2]();
    before = f.sent[ADMIN];
    about(ADMIN, MSG_CANCEL, job_a);
    if (f.settling == 0) {
        ck_assert_uint_eq(f.sent[ADMIN], before + 1);
        ck_assert_int_eq(f.last[ADMIN].type,
                         is_over(_i / 2) ? MSG_FAILED : MSG_ANSWER);
    } else { /* the disk gets its time to make room */
        wait_s(2);
        ck_assert_uint_eq(f.sent[ADMIN], before);
        wait_s(2);
        ck_assert_uint_eq(f.sent[ADMIN], before + 1);
        ck_assert_int_eq(f.last[ADMIN].type, MSG_FAILED);
        ck_assert_int_eq(f.last[ADMIN].failed.status, EX_TEMPFAIL);
        disk_has_room();
        wait_s(2);
    }
    ck_assert_uint_eq(f.last[ADMIN].request, 6);
    ck_assert_uint_eq(f.sent[ADMIN], before + 1); /* once */
    ck_assert(job_over(desk_find_job(f.c, job_a)));
}

/* As where the job itself waits for room. */
TEST(an_answer_comes_as_soon_as_there_is_room)
{
    tear_down();
    set_up_coord(true);
    be_held();
    about(ADMIN, MSG_CANCEL, job_a);
    wait_s(1);
    disk_has_room();
    ck_assert_int_eq(f.last[ADMIN].type, MSG_ANSWER);
}

TEST(a_job_goes_from_submit_to_done)
{
    submit(ANA, job_a, 0);
    ck_assert_int_eq(f.last[ANA].type, MSG_ACCEPT);
    ck_assert_int_eq(f.last[WORKER].type, MSG_JOB_START);
    ready(WORKER, job_a);
    /* two threads, and with two left nothing ahead */
    ck_assert_uint_eq(f.units[WORKER], 2);
    for (uint32_t u = 0; u < 4; u++)
        result(WORKER, job_a, u, 1);
    ck_assert_int_eq(f.last[ANA].type, MSG_DONE);
    ck_assert_int_eq(f.last[WORKER].type, MSG_JOB_END);
    ck_assert_uint_eq(f.ends, 0); /* nothing is kept here */
}

/* To whoever waits for the job that wants them, and to nobody else. */
TEST(records_go_to_the_radsubmit_that_wants_them)
{
    struct msg m = { .type = MSG_RECORDS, .records = { job_a, 1, hash, 7 } };
    unsigned to_ana, to_bob;

    submit(ANA, job_a, 0);
    submit_flags = MSG_JOB_RECORDS;
    submit(BOB, job_b, 0);
    submit_flags = 0;
    ready(WORKER, job_a);
    ready(WORKER, job_b);
    to_ana = f.sent[ANA];
    to_bob = f.sent[BOB];
    say(WORKER, &m);
    m.records.job = hash; /* of no job */
    say(WORKER, &m);
    ck_assert_uint_eq(f.sent[BOB], to_bob);
    m.records.job = job_b;
    say(WORKER, &m);
    ck_assert_uint_eq(f.sent[ANA], to_ana);
    ck_assert_uint_eq(f.sent[BOB], to_bob + 1);
    ck_assert_int_eq(f.last[BOB].type, MSG_RECORDS);
    ck_assert_uint_eq(f.last[BOB].request, 5);
    ck_assert_mem_eq(f.last[BOB].records.job, job_b, MSG_JOB);
    ck_assert_uint_eq(f.last[BOB].records.len, 7);
    ck_assert_mem_eq(f.last[BOB].records.data, hash, 7);
}

/* The file that a user's job waits for comes: the job is accepted. */
static void
file_comes(uint64_t who)
{
    f.have = true;
    file_came(who, hash);
    ck_assert_int_eq(f.last[who].type, MSG_ACCEPT);
}

TEST(a_job_waits_for_its_files)
{
    f.have = false;
    submit(ANA, job_a, 0);
    ck_assert_int_ne(f.last[ANA].type, MSG_ACCEPT);
    file_comes(ANA);
}

/* So many are not looked for in one go. */
TEST(a_job_of_many_files_is_accepted)
{
    enum { MANY = 1100 };
    static uint8_t names[MANY][MSG_HASH];
    static const struct coord_limits patient = { .upload_ms = 60000 };
    struct msg m = usual_submit(job_a);

    coord_set_limits(f.c, &patient);
    for (unsigned i = 0; i < MANY; i++) {
        names[i][0] = (uint8_t)(i >> 8);
        names[i][1] = (uint8_t)i;
        file_came(ANA, names[i]);
    }
    m.submit.files = (struct msg_hashes){ MANY, names[0] };
    say(ANA, &m);
    ck_assert_int_eq(desk_find_job(f.c, job_a)->place, PLACE_ARRIVING);
    wait_s(1);
    ck_assert_int_eq(desk_find_job(f.c, job_a)->place, PLACE_OPEN);
}

/* A user of whom nothing has come, and what is wanted of that one. */
static uint32_t
stranger_is_asked_for(struct msg_hashes files)
{
    struct msg offer = { .type = MSG_OFFER, .request = 9, .offer = files };

    join(STRANGER, MSG_ROLE_USER, "", "eve");
    say(STRANGER, &offer);
    ck_assert_int_eq(f.last[STRANGER].type, MSG_WANT);
    return f.last[STRANGER].want.n;
}

TEST(nobody_hears_what_others_have_sent)
{
    static const uint8_t both[2 * MSG_HASH] = { [MSG_HASH] = 1 };
    struct msg offer = { .type = MSG_OFFER, .offer = { 2, both } };

    ck_assert_uint_eq(stranger_is_asked_for((struct msg_hashes){ 2, both }), 2);
    ck_assert_mem_eq(f.last[STRANGER].want.hash, both, sizeof both);
    say(ANA, &offer); /* who has sent the second */
    ck_assert_uint_eq(f.last[ANA].want.n, 1);
    ck_assert_mem_eq(f.last[ANA].want.hash, both, MSG_HASH);
}

TEST(a_hash_alone_gives_no_right_to_a_file)
{
    ck_assert_uint_eq(stranger_is_asked_for((struct msg_hashes){ 1, hash }), 1);
    submit(STRANGER, job_a, 0);
    wait_s(1);
    ck_assert_int_ne(f.last[STRANGER].type, MSG_ACCEPT);
    ck_assert_int_ne(f.last[WORKER].type, MSG_JOB_START);
    file_came(STRANGER, hash);
    ck_assert_int_eq(f.last[STRANGER].type, MSG_ACCEPT);
    ck_assert_int_eq(f.last[WORKER].type, MSG_JOB_START);
}

TEST(a_store_of_one_user_hides_nothing)
{
    static const uint8_t both[2 * MSG_HASH] = { [MSG_HASH] = 1 };

    f.c->env.one_user = true;
    ck_assert_uint_eq(stranger_is_asked_for((struct msg_hashes){ 2, both }), 0);
    submit(STRANGER, job_a, 0);
    ck_assert_int_eq(f.last[STRANGER].type, MSG_ACCEPT);
}

TEST(a_store_of_one_user_asks_for_what_is_not_there)
{
    f.c->env.one_user = true;
    f.have = false;
    ck_assert_uint_eq(stranger_is_asked_for((struct msg_hashes){ 1, hash }), 1);
    submit(STRANGER, job_a, 0);
    ck_assert_int_ne(f.last[STRANGER].type, MSG_ACCEPT);
    file_comes(STRANGER);
}

/* As long as the store would keep it for that user alone. */
enum { UPLOAD_MS = 3600 * 1000 };

TEST(what_a_user_sent_is_known_for_a_while_or_as_long_as_a_job_names_it)
{
    struct msg offer = { .type = MSG_OFFER, .offer = { 1, hash } };
    const struct coord_keep none = { .jobs = 0 };

    submit(ANA, job_a, 0);
    f.now_ms += UPLOAD_MS + 1;
    wait_s(1);
    say(ANA, &offer);
    ck_assert_uint_eq(f.last[ANA].want.n, 0);
    say(BOB, &offer); /* who has no job */
    ck_assert_uint_eq(f.last[BOB].want.n, 1);
    about(ANA, MSG_CANCEL, job_a);
    coord_set_keep(f.c, &none);
    carry_out();
    say(ANA, &offer);
    ck_assert_uint_eq(f.last[ANA].want.n, 0);
    f.now_ms += UPLOAD_MS + 1;
    wait_s(1);
    ck_assert(f.closed[ANA]); /* it offered, and nothing came */
    join(SECOND, MSG_ROLE_USER, "", "ana");
    say(SECOND, &offer);
    ck_assert_uint_eq(f.last[SECOND].want.n, 1);
}

TEST(a_worker_gets_files_of_the_job_that_it_loads_alone)
{
    static const uint8_t both[2 * MSG_HASH] = { [MSG_HASH] = 1 };
    struct msg want = { .type = MSG_WANT, .want = { 2, both } };

    say(WORKER, &want);
    ck_assert_uint_eq(f.files_sent, 0);
    submit(ANA, job_a, 0);
    say(WORKER, &want);
    ck_assert_uint_eq(f.files_sent, 1);
    ck_assert_mem_eq(f.file_sent, hash, MSG_HASH);
    ready(WORKER, job_a);
    say(WORKER, &want);
    about(ANA, MSG_CANCEL, job_a);
    say(WORKER, &want);
    ck_assert_uint_eq(f.files_sent, 1);
}

/* Else the next job waits for them, behind a slow line. */
TEST(files_of_a_job_that_was_cancelled_are_not_sent_any_more)
{
    struct msg want = { .type = MSG_WANT, .want = { 1, hash } };

    submit(ANA, job_a, 0);
    say(WORKER, &want);
    ready(WORKER, job_a);
    submit(ANA, job_b, 0);
    about(ANA, MSG_CANCEL, job_a);
    ck_assert_uint_eq(f.files_dropped, 0); /* files of B may be among them */
    say(WORKER, &want);
    about(ANA, MSG_CANCEL, job_b);
    ck_assert_uint_eq(f.files_dropped, WORKER);
}

static void
room(const uint8_t *job, bool has)
{
    struct msg m = { .type = MSG_ROOM,
                     .room = { job, has, "the disk is full" } };

    say(WORKER, &m);
}

TEST(a_job_without_room_waits_and_others_go_on)
{
    unsigned sent;

    submit(ANA, job_a, 0);
    sent = f.sent[WORKER];
    for (int i = 0; i < 10; i++)
        room(job_a, false);
    wait_s(100);
    ck_assert_uint_eq(f.sent[WORKER], sent);
    ck_assert_int_ne(f.last[ANA].type, MSG_FAILED);
    submit(BOB, job_b, 0);
    ck_assert_int_eq(f.last[WORKER].type, MSG_JOB_START);
    ready(WORKER, job_b);
    ck_assert_uint_gt(f.units[WORKER], 0);
    room(job_a, true);
    ck_assert_int_eq(f.last[WORKER].type, MSG_JOB_START);
    ck_assert_mem_eq(f.last[WORKER].job_start.job, job_a, MSG_JOB);
}

TEST(a_worker_without_room_may_have_some_when_it_comes_again)
{
    submit(ANA, job_a, 0);
    room(job_a, false);
    cut(WORKER);
    join(SECOND, MSG_ROLE_WORKER, "ws1", "daemon");
    ck_assert_int_eq(f.last[SECOND].type, MSG_JOB_START);
}

/* Room for its rows is made meanwhile: nobody renders before that is there. */
TEST(workers_load_while_a_job_is_stored)
{
    f.stuck = true;
    submit(ANA, job_a, 0);
    ck_assert_uint_eq(f.last[WORKER].type, MSG_JOB_START);
    ready(WORKER, job_a);
    wait_s(1);
    ck_assert_uint_eq(f.units[WORKER], 0);
    coord_job_opened(f.c, f.now_ms, job_a, job_number(job_a), 0, NULL);
    carry_out();
    ck_assert_uint_gt(f.units[WORKER], 0);
}

TEST(workers_forget_a_job_that_could_not_be_stored)
{
    f.stuck = true;
    start_job();
    coord_job_opened(f.c, f.now_ms, job_a, job_number(job_a), EX_IOERR,
                     "no room for rows");
    carry_out();
    ck_assert_uint_eq(f.last[WORKER].type, MSG_JOB_END);
    ck_assert_uint_eq(f.units[WORKER], 0);
}

/* The last of its files came, and nothing else happens. */
TEST(workers_load_when_the_last_file_is_there)
{
    f.stuck = true;
    f.have = false;
    submit(ANA, job_a, 0);
    ck_assert_uint_ne(f.last[WORKER].type, MSG_JOB_START);
    f.have = true;
    file_came(ANA, hash);
    ck_assert_uint_eq(f.last[WORKER].type, MSG_JOB_START);
}

static bool
says_of_jobs(const char *words)
{
    const struct msg query = { .type = MSG_QUERY,
                               .query = { MSG_QUERY_JOBS, "" } };

    say(BOB, &query);
    ck_assert_int_eq(f.last[BOB].type, MSG_ANSWER);
    return memmem(f.last[BOB].answer.text, f.last[BOB].answer.len, words,
                  strlen(words)) != NULL;
}

/* For want of room for its own rows, not of any. */
TEST(a_job_waits_for_much_room_alone)
{
    f.stuck = true;
    submit(ANA, job_a, 0);
    room(job_a, false);
    coord_job_waits(f.c, f.now_ms, job_a, job_number(job_a), "it needs more");
    wait_s(1);
    ck_assert_uint_eq(f.last[ANA].progress.state, MSG_STATE_HELD);
    ck_assert(
        says_of_jobs("it needs more")); /* and not what its worker lacks */
    f.stuck = false;
    submit(BOB, job_b, 0);
    wait_s(1);
    ck_assert_uint_ne(f.last[BOB].progress.state, MSG_STATE_HELD);
    ck_assert_uint_eq(f.last[ANA].progress.state, MSG_STATE_HELD);
    disk_is_full();
    disk_has_room();
    wait_s(1);
    ck_assert_uint_eq(f.last[ANA].progress.state, MSG_STATE_HELD);
    coord_job_opened(f.c, f.now_ms, job_a, job_number(job_a), 0, "");
    wait_s(1);
    ck_assert_uint_ne(f.last[ANA].progress.state, MSG_STATE_HELD);
}

TEST(the_same_id_again_attaches)
{
    submit(ANA, job_a, 0);
    submit(ANA, job_a, 0);
    ck_assert_int_eq(f.last[ANA].type, MSG_ACCEPT);
    ck_assert_uint_eq(f.last[ANA].accept.again, 1);
    submit(BOB, job_a, 0); /* somebody else's */
    ck_assert_int_eq(f.last[BOB].type, MSG_FAILED);
    ck_assert_int_eq(f.last[BOB].failed.status, EX_NOPERM);
}

TEST(only_owner_and_admin_steer_a_job)
{
    static const uint16_t types[] = { MSG_PAUSE, MSG_RESUME, MSG_CANCEL };

    submit(ANA, job_a, 0);
    for (int i = 0; i < N_ELEM(types); i++) {
        about(BOB, types[i], job_a);
        ck_assert_int_eq(f.last[BOB].failed.status, EX_NOPERM);
    }
    about(ADMIN, MSG_PAUSE, job_a);
    ck_assert_int_eq(f.last[ADMIN].type, MSG_ANSWER);
    about(ADMIN, MSG_CANCEL, job_b);
    ck_assert_int_eq(f.last[ADMIN].failed.status, EX_NOINPUT);
    about(ADMIN, MSG_CANCEL, job_a);
    ck_assert_int_eq(f.last[ANA].type, MSG_FAILED);
    ck_assert_str_eq(f.last[ANA].failed.text,
                     "cancelled by administrator root");
    submit(ANA, job_b, 0);
    about(ANA, MSG_CANCEL, job_b);
    ck_assert_str_eq(desk_find_job(f.c, job_b)->text, "cancelled");
}

/* Files are needed as long as a job is remembered. */
TEST(files_of_jobs_are_needed)
{
    size_t n;
    uint8_t *list = coord_files(f.c, &n);

    ck_assert_ptr_nonnull(list);
    ck_assert_uint_eq(n, 0);
    free(list);
    submit(ANA, job_a, 0);
    submit(BOB, job_b, 0);
    about(ANA, MSG_CANCEL, job_a);
    list = coord_files(f.c, &n);
    ck_assert_ptr_nonnull(list);
    ck_assert_uint_eq(n, 2); /* the same of both */
    ck_assert_mem_eq(list, hash, MSG_HASH);
    free(list);
}

/* Of a job of very many units nobody waits for all of them at once. */
TEST(statistics_in_pieces_are_those_at_once)
{
    struct stats_text *t;
    const struct job *job;
    char *whole, *text;
    int rc, pieces = 0;

    start_job();
    for (uint32_t unit = 0; unit < 3; unit++)
        result(WORKER, job_a, unit, 1);
    job = desk_find_job(f.c, job_a);
    whole = stats_text(job, f.now_ms);
    t = stats_begin(job, f.now_ms);
    ck_assert(whole && t);
    while ((rc = stats_more(t, job, 1)) == 0)
        pieces++;
    ck_assert_int_eq(rc, 1);
    ck_assert_int_ge(pieces, 3);
    text = stats_take(t);
    ck_assert_str_eq(text, whole);
    free(text);
    free(whole);
}

TEST(frames_are_fetched_when_they_are_there)
{
    struct msg m = { .type = MSG_FETCH,
                     .request = 6,
                     .fetch = { job_a, 0, 0 } };

    submit(ANA, job_a, 0);
    say(ANA, &m);
    ck_assert_int_eq(f.last[ANA].failed.status, EX_TEMPFAIL);
    m.fetch.frame = 1;
    say(ANA, &m);
    ck_assert_int_eq(f.last[ANA].failed.status, EX_USAGE);
    m.fetch = (struct msg_fetch){ job_a, 0, MSG_WHAT_DEPTH };
    say(ANA, &m);
    ck_assert_int_eq(f.last[ANA].failed.status, EX_USAGE);
    m.fetch.what = MSG_WHAT_STATS;
    say(ANA, &m);
    ck_assert_int_eq(f.last[ANA].type, MSG_CHUNK);
}

TEST(an_observer_sees_all_and_changes_nothing)
{
    static const uint16_t orders[] = { MSG_CANCEL, MSG_PAUSE, MSG_DELETE };
    struct msg m = { .type = MSG_FETCH,
                     .request = 6,
                     .fetch = { job_a, 0, MSG_WHAT_STATS } };
    unsigned before;

    submit(ANA, job_a, 0);
    join(STRANGER, MSG_ROLE_OBSERVER, "", "observer:page");
    ck_assert_int_eq(f.last[STRANGER].type, MSG_WELCOME);
    say(STRANGER, &m);
    ck_assert_int_eq(f.last[STRANGER].type, MSG_CHUNK);
    m = (struct msg){ .type = MSG_QUERY, .query = { MSG_QUERY_LIMITS, "ana" } };
    say(STRANGER, &m);
    ck_assert_int_eq(f.last[STRANGER].type, MSG_ANSWER);
    before = f.sent[STRANGER];
    for (int i = 0; i < N_ELEM(orders); i++) {
        m = (struct msg){ .type = orders[i], .cancel = { job_a } };
        say(STRANGER, &m);
        ck_assert_uint_eq(f.sent[STRANGER], before);
        ck_assert(!job_over(desk_find_job(f.c, job_a)));
        ck_assert_int_ne(desk_find_job(f.c, job_a)->state, JOB_PAUSED);
    }
}

/* It is nearly full: room comes and goes twice a second. */
TEST(a_disk_that_is_full_by_turns_is_told_now_and_then)
{
    for (int i = 0; i < 60; i++) {
        coord_fullness(f.c, f.now_ms, i % 2 == 0, "cannot write 'x'");
        wait_s(1);
    }
    ck_assert_int_eq(f.full_logs, 1);
    ck_assert_int_eq(f.room_logs, 1);
    coord_fullness(f.c, f.now_ms, true, "cannot write 'x'");
    wait_s(70); /* and stays full */
    ck_assert_int_eq(f.full_logs, 2);
    coord_fullness(f.c, f.now_ms, false, "");
    wait_s(1);
    ck_assert_int_eq(f.room_logs, 2);
}

TEST(a_full_disk_holds_jobs)
{
    f.have = false;
    submit(ANA, job_a, 0);
    coord_fullness(f.c, f.now_ms, true, "cannot write 'x'");
    wait_s(1);
    ck_assert_uint_eq(f.progress.state, MSG_STATE_HELD);
    f.have = true;
    file_came(ANA, hash);
    ck_assert_int_ne(f.last[WORKER].type, MSG_JOB_START);
    coord_fullness(f.c, f.now_ms, false, "");
    carry_out();
    ck_assert_int_eq(f.last[WORKER].type, MSG_JOB_START);
    wait_s(1);
    ck_assert_uint_ne(f.progress.state, MSG_STATE_HELD);
}

TEST(queries_are_answered_in_json)
{
    static const struct {
        uint8_t what;
        const char *text, *begins;
    } q[] = { { MSG_QUERY_STATUS, "", "{" },
              { MSG_QUERY_WORKERS, "", "[" },
              { MSG_QUERY_JOBS, "", "[" },
              { MSG_QUERY_JOB, "aa", "{" } };

    submit(ANA, job_a, 0);
    for (int i = 0; i < N_ELEM(q); i++) {
        struct msg m = { .type = MSG_QUERY, .query = { q[i].what, q[i].text } };
        json_t *root;

        say(BOB, &m);
        ck_assert_int_eq(f.last[BOB].type, MSG_ANSWER);
        ck_assert_int_eq(f.last[BOB].answer.text[0], q[i].begins[0]);
        root = json_loadb((const char *)f.last[BOB].answer.text,
                          f.last[BOB].answer.len, 0, NULL);
        ck_assert_ptr_nonnull(root);
        json_decref(root);
    }
}

static int64_t
an_hour_ahead(void *arg)
{
    (void)arg;
    return 3600000;
}

/* The system's clock was an hour behind when the coordinator began, and is
 * right now. */
TEST(the_start_follows_a_clock_that_is_put_right)
{
    const struct msg query = { .type = MSG_QUERY,
                               .query = { MSG_QUERY_STATUS, "" } };
    json_t *root;

    coord_set_epoch(f.c, UINT64_C(1700000000000));
    f.c->env.ahead_ms = an_hour_ahead;
    say(BOB, &query);
    root = json_loadb((const char *)f.last[BOB].answer.text,
                      f.last[BOB].answer.len, 0, NULL);
    ck_assert_int_eq(json_integer_value(json_object_get(root, "start_ms")),
                     1700003600000);
    ck_assert_int_eq(json_integer_value(json_object_get(root, "epoch")),
                     1700000000000);
    json_decref(root);
}

/* JSON is UTF-8, and who cut the text did not look; nor is the name of a folder
 * always. */
TEST(a_job_whose_text_is_cut_is_told_of)
{
    const struct msg query = { .type = MSG_QUERY,
                               .query = { MSG_QUERY_JOB, "aa" } };
    char text[MSG_MAX_TEXT + 1];
    struct msg m = { .type = MSG_FAILED,
                     .failed = { job_a, EX_DATAERR, text } };

    start_job();
    coord_fullness(f.c, f.now_ms, true, "/var/caf\xe9");
    carry_out();
    say(BOB, &query);
    ck_assert_int_eq(f.last[BOB].type, MSG_ANSWER);
    memset(text, 'x', sizeof text);
    memcpy(text + 399, "\xc3\xa4", 3);
    say(WORKER, &m);
    memset(&f.last[BOB], 0, sizeof f.last[BOB]);
    say(BOB, &query);
    ck_assert_int_eq(f.last[BOB].type, MSG_ANSWER);
}

/* After a look at the job's pace. */
static double
left_s(void)
{
    struct msg_progress p;

    wait_s(2);
    progress_tell(desk_find_job(f.c, job_a), f.now_ms, &p);
    return p.left_s;
}

/* A job waits for hours; then a worker makes two of its four units, in so many
 * seconds each.  At the second another worker may be there, too. */
static void
make_half(unsigned first_s, unsigned second_s, bool together)
{
    submit(ANA, job_a, 0);
    wait_s(10000);
    ck_assert_double_eq(left_s(), 0);
    ready(WORKER, job_a);
    wait_s(first_s);
    result(WORKER, job_a, 0, 1);
    ck_assert_double_eq(left_s(), 0); /* how dear the rest is nobody knows */
    if (together) {
        second_ready(job_a);
    }
    wait_s(second_s - 2);
    result(WORKER, job_a, 1, 1);
    ck_assert_uint_eq(desk_find_job(f.c, job_a)->units_done, 2);
}

TEST(time_left_goes_by_the_time_that_a_worker_took)
{
    make_half(60, 40, false);
    ck_assert_double_eq_tol(left_s(), 2 * 40, 4);
}

/* The job is paused, held, and goes on. */
TEST(time_left_goes_by_the_time_that_workers_took)
{
    make_half(60, 30, true);
    ck_assert_double_eq_tol(left_s(), 2 * 60 / 2., 4);
    about(ANA, MSG_PAUSE, job_a);
    wait_s(10000);
    ck_assert_double_eq(left_s(), 0);
    about(ANA, MSG_RESUME, job_a);
    ck_assert_double_eq_tol(left_s(), 2 * 64 / 2., 4);
    disk_is_full();
    ck_assert_double_eq(left_s(), 0);
    disk_has_room();
    ck_assert_double_eq_tol(left_s(), 2 * 72 / 2., 4);
    about(ANA, MSG_CANCEL, job_a);
    ck_assert_double_eq(left_s(), 0);
}

static const struct {
    unsigned first_s, second_s;
} uneven[] = { { 120, 20 }, { 20, 120 } };

LOOP_TEST(no_time_left_is_told_while_costs_differ, N_ELEM(uneven))
{
    make_half(uneven[_i].first_s, uneven[_i].second_s, false);
    ck_assert_double_eq(left_s(), 0);
}

TEST(how_far_a_job_is_goes_by_rows_where_units_are_large)
{
#define ROW "\2\2\0\10\210\1\210\2\210\3\210\4"
    static const char code[] = ROW ROW ROW ROW;
#undef ROW
    struct msg part = { .type = MSG_RESULT,
                        .result = { job_a,
                                    0,
                                    1,
                                    0,
                                    4,
                                    8,
                                    1,
                                    0,
                                    { 0 },
                                    (const uint8_t *)code,
                                    sizeof code - 1 } };
    struct msg ask = { .type = MSG_QUERY, .query = { MSG_QUERY_JOB, "aa" } };
    json_t *root;

    submit_with(ANA, job_a, 0, 1, 0);
    ready(WORKER, job_a);
    say(WORKER, &part);
    say(BOB, &ask);
    root = json_loadb((const char *)f.last[BOB].answer.text,
                      f.last[BOB].answer.len, 0, NULL);
    ck_assert_double_eq(json_number_value(json_object_get(root, "done")), .5);
    json_decref(root);
}
