/* check_coord_jobs.c - the life of a job: submitted, steered, fetched,
 * cancelled, kept */
#include "config.h"

#include "coord_fixture.h"

/* --- every job can be cancelled, and who does hears of it --- */

static void
disk_is_full(void)
{
    f.stuck = true;
    coord_fullness(f.c, f.now_ms, true, "cannot write 'x'");
    carry_out(&f);
}

static void
disk_has_room(void)
{
    f.stuck = false;
    coord_fullness(f.c, f.now_ms, false, "");
    if (f.settling)
        coord_settled(f.c, f.now_ms, f.settling, f.settling_what);
    carry_out(&f);
}

static void
be_begun(void)
{
    submit(&f, ANA, job_a, 0);
    ready(&f, WORKER, job_a);
    result(&f, WORKER, job_a, 0, 1);
}

static void
be_without_files(void)
{
    f.have = false;
    submit(&f, ANA, job_a, 0);
}

static void
be_held(void)
{
    disk_is_full();
    submit(&f, ANA, job_a, 0);
}

static void
be_waiting(void)
{
    submit(&f, ANA, job_a, 0);
}

static void
be_paused(void)
{
    be_begun();
    about(&f, ANA, MSG_PAUSE, job_a);
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
        result(&f, WORKER, job_a, i, 1);
    ck_assert_int_eq(f.last[ANA].type, MSG_DONE);
}

static void
be_cancelled(void)
{
    be_begun();
    about(&f, ANA, MSG_CANCEL, job_a);
}

static void (*const states[])(void) = {
    be_without_files,   be_held,   be_waiting,
    be_begun,           be_paused, be_held_under_way,
    be_held_and_paused, be_done,   be_cancelled,
};

START_TEST(cancel_is_answered_whatever_the_job_is_at)
{
    unsigned before;

    tear_down();
    set_up_coord(_i % 2);
    states[_i / 2]();
    before = f.sent[ADMIN];
    about(&f, ADMIN, MSG_CANCEL, job_a);
    if (f.settling == 0) {
        ck_assert_uint_eq(f.sent[ADMIN], before + 1);
        ck_assert_int_eq(f.last[ADMIN].type, MSG_ANSWER);
    } else { /* the disk gets its time to make room */
        wait_s(&f, 2);
        ck_assert_uint_eq(f.sent[ADMIN], before);
        wait_s(&f, 2);
        ck_assert_uint_eq(f.sent[ADMIN], before + 1);
        ck_assert_int_eq(f.last[ADMIN].type, MSG_FAILED);
        ck_assert_int_eq(f.last[ADMIN].failed.status, EX_TEMPFAIL);
        disk_has_room();
        wait_s(&f, 2);
    }
    ck_assert_uint_eq(f.last[ADMIN].request, 6);
    ck_assert_uint_eq(f.sent[ADMIN], before + 1); /* once */
    ck_assert(job_over(coord_find_job(f.c, job_a)));
}
END_TEST

/* As where the job itself waits for room. */
START_TEST(an_answer_comes_as_soon_as_there_is_room)
{
    tear_down();
    set_up_coord(true);
    be_held();
    about(&f, ADMIN, MSG_CANCEL, job_a);
    wait_s(&f, 1);
    disk_has_room();
    ck_assert_int_eq(f.last[ADMIN].type, MSG_ANSWER);
}
END_TEST

START_TEST(a_job_goes_from_submit_to_done)
{
    submit(&f, ANA, job_a, 0);
    ck_assert_int_eq(f.last[ANA].type, MSG_ACCEPT);
    ck_assert_int_eq(f.last[WORKER].type, MSG_JOB_START);
    ready(&f, WORKER, job_a);
    /* two threads, and with two left nothing ahead */
    ck_assert_uint_eq(f.units[WORKER], 2);
    for (uint32_t u = 0; u < 4; u++)
        result(&f, WORKER, job_a, u, 1);
    ck_assert_int_eq(f.last[ANA].type, MSG_DONE);
    ck_assert_int_eq(f.last[WORKER].type, MSG_JOB_END);
}
END_TEST

/* To whoever waits for the job that wants them, and to nobody else. */
START_TEST(records_go_to_the_radsubmit_that_wants_them)
{
    struct msg m = { .type = MSG_RECORDS, .records = { job_a, 1, hash, 7 } };
    unsigned to_ana, to_bob;

    submit(&f, ANA, job_a, 0);
    submit_flags = MSG_JOB_RECORDS;
    submit(&f, BOB, job_b, 0);
    submit_flags = 0;
    ready(&f, WORKER, job_a);
    ready(&f, WORKER, job_b);
    to_ana = f.sent[ANA];
    to_bob = f.sent[BOB];
    say(&f, WORKER, &m);
    m.records.job = hash; /* of no job */
    say(&f, WORKER, &m);
    ck_assert_uint_eq(f.sent[BOB], to_bob);
    m.records.job = job_b;
    say(&f, WORKER, &m);
    ck_assert_uint_eq(f.sent[ANA], to_ana);
    ck_assert_uint_eq(f.sent[BOB], to_bob + 1);
    ck_assert_int_eq(f.last[BOB].type, MSG_RECORDS);
    ck_assert_uint_eq(f.last[BOB].request, 5);
    ck_assert_mem_eq(f.last[BOB].records.job, job_b, MSG_JOB);
    ck_assert_uint_eq(f.last[BOB].records.len, 7);
    ck_assert_mem_eq(f.last[BOB].records.data, hash, 7);
}
END_TEST

START_TEST(a_job_waits_for_its_files)
{
    f.have = false;
    submit(&f, ANA, job_a, 0);
    ck_assert_int_eq(f.last[ANA].type, MSG_WELCOME);
    f.have = true;
    coord_file_stored(f.c, f.now_ms, ANA, hash);
    carry_out(&f);
    ck_assert_int_eq(f.last[ANA].type, MSG_ACCEPT);
}
END_TEST

/* Room for its rows is made meanwhile: nobody renders before that is there. */
START_TEST(workers_load_while_a_job_is_stored)
{
    f.stuck = true;
    submit(&f, ANA, job_a, 0);
    ck_assert_uint_eq(f.last[WORKER].type, MSG_JOB_START);
    ready(&f, WORKER, job_a);
    wait_s(&f, 1);
    ck_assert_uint_eq(f.units[WORKER], 0);
    coord_job_opened(f.c, f.now_ms, job_a, 0, NULL);
    carry_out(&f);
    ck_assert_uint_gt(f.units[WORKER], 0);
}
END_TEST

START_TEST(workers_forget_a_job_that_could_not_be_stored)
{
    f.stuck = true;
    submit(&f, ANA, job_a, 0);
    ready(&f, WORKER, job_a);
    coord_job_opened(f.c, f.now_ms, job_a, EX_IOERR, "no room for rows");
    carry_out(&f);
    ck_assert_uint_eq(f.last[WORKER].type, MSG_JOB_END);
    ck_assert_uint_eq(f.units[WORKER], 0);
}
END_TEST

/* The last of its files came, and nothing else happens. */
START_TEST(workers_load_when_the_last_file_is_there)
{
    f.stuck = true;
    f.have = false;
    submit(&f, ANA, job_a, 0);
    ck_assert_uint_ne(f.last[WORKER].type, MSG_JOB_START);
    f.have = true;
    coord_file_stored(f.c, f.now_ms, ANA, hash);
    carry_out(&f);
    ck_assert_uint_eq(f.last[WORKER].type, MSG_JOB_START);
}
END_TEST

START_TEST(the_same_id_again_attaches)
{
    submit(&f, ANA, job_a, 0);
    submit(&f, ANA, job_a, 0);
    ck_assert_int_eq(f.last[ANA].type, MSG_ACCEPT);
    ck_assert_uint_eq(f.last[ANA].accept.again, 1);
    submit(&f, BOB, job_a, 0); /* somebody else's */
    ck_assert_int_eq(f.last[BOB].type, MSG_FAILED);
    ck_assert_int_eq(f.last[BOB].failed.status, EX_NOPERM);
}
END_TEST

START_TEST(only_owner_and_admin_steer_a_job)
{
    static const uint16_t types[] = { MSG_PAUSE, MSG_RESUME, MSG_CANCEL };

    submit(&f, ANA, job_a, 0);
    for (int i = 0; i < N_ELEM(types); i++) {
        about(&f, BOB, types[i], job_a);
        ck_assert_int_eq(f.last[BOB].failed.status, EX_NOPERM);
    }
    about(&f, ADMIN, MSG_PAUSE, job_a);
    ck_assert_int_eq(f.last[ADMIN].type, MSG_ANSWER);
    about(&f, ADMIN, MSG_CANCEL, job_b);
    ck_assert_int_eq(f.last[ADMIN].failed.status, EX_NOINPUT);
    about(&f, ADMIN, MSG_CANCEL, job_a);
    ck_assert_int_eq(f.last[ANA].type, MSG_FAILED);
    ck_assert_str_eq(f.last[ANA].failed.text, "cancelled");
}
END_TEST

/* Files are needed as long as a job is remembered. */
START_TEST(files_of_jobs_are_needed)
{
    size_t n;
    uint8_t *list = coord_files(f.c, &n);

    ck_assert_ptr_nonnull(list);
    ck_assert_uint_eq(n, 0);
    free(list);
    submit(&f, ANA, job_a, 0);
    submit(&f, BOB, job_b, 0);
    about(&f, ANA, MSG_CANCEL, job_a);
    list = coord_files(f.c, &n);
    ck_assert_ptr_nonnull(list);
    ck_assert_uint_eq(n, 1); /* that of both */
    ck_assert_mem_eq(list, hash, MSG_HASH);
    free(list);
}
END_TEST

START_TEST(frames_are_fetched_when_they_are_there)
{
    struct msg m = { .type = MSG_FETCH,
                     .request = 6,
                     .fetch = { job_a, 0, 0 } };

    submit(&f, ANA, job_a, 0);
    say(&f, ANA, &m);
    ck_assert_int_eq(f.last[ANA].failed.status, EX_TEMPFAIL);
    m.fetch.frame = 1;
    say(&f, ANA, &m);
    ck_assert_int_eq(f.last[ANA].failed.status, EX_USAGE);
    m.fetch = (struct msg_fetch){ job_a, 0, MSG_WHAT_DEPTH };
    say(&f, ANA, &m);
    ck_assert_int_eq(f.last[ANA].failed.status, EX_USAGE);
    m.fetch.what = MSG_WHAT_STATS;
    say(&f, ANA, &m);
    ck_assert_int_eq(f.last[ANA].type, MSG_CHUNK);
}
END_TEST

START_TEST(a_full_disk_holds_jobs)
{
    f.have = false;
    submit(&f, ANA, job_a, 0);
    coord_fullness(f.c, f.now_ms, true, "cannot write 'x'");
    wait_s(&f, 1);
    ck_assert_uint_eq(f.progress.state, MSG_STATE_HELD);
    f.have = true;
    coord_file_stored(f.c, f.now_ms, ANA, hash);
    carry_out(&f);
    ck_assert_int_ne(f.last[WORKER].type, MSG_JOB_START);
    coord_fullness(f.c, f.now_ms, false, "");
    carry_out(&f);
    ck_assert_int_eq(f.last[WORKER].type, MSG_JOB_START);
    wait_s(&f, 1);
    ck_assert_uint_ne(f.progress.state, MSG_STATE_HELD);
}
END_TEST

static void
whole_job(const uint8_t *job)
{
    submit(&f, ANA, job, 0);
    ready(&f, WORKER, job);
    for (uint32_t u = 0; u < 4; u++)
        result(&f, WORKER, job, u, 1);
}

/* By number, by age, and by size, but not before its user can have it. */
START_TEST(jobs_that_are_over_are_kept_for_a_while)
{
    static const struct coord_keep keeps[] = { { 1, 0, 0 },
                                               { 9, 90000, 0 },
                                               { 9, 0, 1000 } };
    static const unsigned until_s[] = { 0, 90, 60 };

    coord_set_keep(f.c, &keeps[_i]);
    whole_job(job_a);
    coord_job_filed(f.c, f.now_ms, job_a, 900);
    whole_job(job_b);
    coord_job_filed(f.c, f.now_ms, job_b, 900);
    carry_out(&f);
    if (until_s[_i] > 0) {
        wait_s(&f, until_s[_i] / 2);
        ck_assert_ptr_nonnull(coord_find_job(f.c, job_a));
        wait_s(&f, until_s[_i]);
        coord_job_filed(f.c, f.now_ms, job_b, 900);
    }
    ck_assert_ptr_null(coord_find_job(f.c, job_a));
    ck_assert((coord_find_job(f.c, job_b) == NULL) == (_i == 1));
}
END_TEST

START_TEST(queries_are_answered_in_json)
{
    static const struct {
        uint8_t what;
        const char *text, *begins;
    } q[] = { { MSG_QUERY_STATUS, "", "{" },
              { MSG_QUERY_WORKERS, "", "[" },
              { MSG_QUERY_JOBS, "", "[" },
              { MSG_QUERY_JOB, "aa", "{" } };

    submit(&f, ANA, job_a, 0);
    for (int i = 0; i < N_ELEM(q); i++) {
        struct msg m = { .type = MSG_QUERY, .query = { q[i].what, q[i].text } };
        json_t *root;

        say(&f, BOB, &m);
        ck_assert_int_eq(f.last[BOB].type, MSG_ANSWER);
        ck_assert_int_eq(f.last[BOB].answer.text[0], q[i].begins[0]);
        root = json_loadb((const char *)f.last[BOB].answer.text,
                          f.last[BOB].answer.len, 0, NULL);
        ck_assert_ptr_nonnull(root);
        json_decref(root);
    }
}
END_TEST

/* JSON is UTF-8, and who cut the text did not look; nor is the name of a folder
 * always. */
START_TEST(a_job_whose_text_is_cut_is_told_of)
{
    const struct msg query = { .type = MSG_QUERY,
                               .query = { MSG_QUERY_JOB, "aa" } };
    char text[MSG_MAX_TEXT + 1];
    struct msg m = { .type = MSG_FAILED,
                     .failed = { job_a, EX_DATAERR, text } };

    submit(&f, ANA, job_a, 0);
    ready(&f, WORKER, job_a);
    coord_fullness(f.c, f.now_ms, true, "/var/caf\xe9");
    carry_out(&f);
    say(&f, BOB, &query);
    ck_assert_int_eq(f.last[BOB].type, MSG_ANSWER);
    memset(text, 'x', sizeof text);
    memcpy(text + 399, "\xc3\xa4", 3);
    say(&f, WORKER, &m);
    memset(&f.last[BOB], 0, sizeof f.last[BOB]);
    say(&f, BOB, &query);
    ck_assert_int_eq(f.last[BOB].type, MSG_ANSWER);
}
END_TEST

/* Half of a job's only unit is there. */
START_TEST(how_far_a_job_is_goes_by_rows_where_units_are_large)
{
    struct msg part = { .type = MSG_RESULT,
                        .result = {
                            job_a, 0, 1, 0, 4, 8, 3, 0, { 0 }, pixels } };
    struct msg ask = { .type = MSG_QUERY, .query = { MSG_QUERY_JOB, "aa" } };
    json_t *root;

    submit_with(&f, ANA, job_a, 0, 1, 0);
    ready(&f, WORKER, job_a);
    say(&f, WORKER, &part);
    say(&f, BOB, &ask);
    root = json_loadb((const char *)f.last[BOB].answer.text,
                      f.last[BOB].answer.len, 0, NULL);
    ck_assert_double_eq(json_number_value(json_object_get(root, "done")), .5);
    json_decref(root);
}
END_TEST

int
main(void)
{
    Suite *s = suite_create("coord_jobs");
    TCase *tc = tcase_create("coord_jobs");

    tcase_add_checked_fixture(tc, set_up, tear_down);
    tcase_add_test(tc, a_job_goes_from_submit_to_done);
    tcase_add_test(tc, records_go_to_the_radsubmit_that_wants_them);
    tcase_add_test(tc, a_job_waits_for_its_files);
    tcase_add_test(tc, workers_load_while_a_job_is_stored);
    tcase_add_test(tc, workers_forget_a_job_that_could_not_be_stored);
    tcase_add_test(tc, workers_load_when_the_last_file_is_there);
    tcase_add_test(tc, the_same_id_again_attaches);
    tcase_add_test(tc, only_owner_and_admin_steer_a_job);
    tcase_add_test(tc, files_of_jobs_are_needed);
    tcase_add_test(tc, frames_are_fetched_when_they_are_there);
    tcase_add_test(tc, a_full_disk_holds_jobs);
    tcase_add_loop_test(tc, cancel_is_answered_whatever_the_job_is_at, 0,
                        2 * N_ELEM(states));
    tcase_add_test(tc, an_answer_comes_as_soon_as_there_is_room);
    tcase_add_loop_test(tc, jobs_that_are_over_are_kept_for_a_while, 0, 3);
    tcase_add_test(tc, queries_are_answered_in_json);
    tcase_add_test(tc, a_job_whose_text_is_cut_is_told_of);
    tcase_add_test(tc, how_far_a_job_is_goes_by_rows_where_units_are_large);
    suite_add_tcase(s, tc);
    return unit_run(s);
}
