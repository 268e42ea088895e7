/* check_coord_rows.c - rows that come to the coordinator, and what is counted
 * of them */
#include "config.h"

#include "coord_fixture.h"

FIXTURE(set_up, tear_down)

TEST(pixels_that_are_no_numbers_are_told_once_with_the_first)
{
    static const uint32_t order[] = { 1, 0, 3, 2 };
    struct msg m = {
        .type = MSG_RESULT,
        .result = { job_a, 0, 1, 0, 4, 4, 1, 1, { 0 }, pixels, 4 * 4 * 4 }
    };

    start_job();
    for (int i = 0; i < 4; i++) {
        m.result.unit = order[i];
        m.result.counts.nan = (struct msg_nan){ order[i], 0, 5, 9 - order[i] };
        say(WORKER, &m);
    }
    ck_assert_int_eq(f.last[ANA].type, MSG_DONE);
    ck_assert_str_eq(f.nan_log, "1 pixels=6 frame=0 x=5 y=6");
    ck_assert_uint_eq(f.progress.nan.pixels, 6);
    ck_assert_uint_eq(f.progress.nan.y, 6);
}

static const struct {
    uint8_t partition;
    uint32_t flags, started; /* of the SUBMIT and of the JOB_START */
} codings[] = {
    { MSG_PART_AUTO, 0, MSG_JOB_CODED },
    { MSG_PART_STATIC, MSG_JOB_SHARE, MSG_JOB_SHARE | MSG_JOB_CODED },
    { MSG_PART_WINDOW, MSG_JOB_CODED, MSG_JOB_CODED },
    { MSG_PART_AUTO, MSG_JOB_DEPTH | MSG_JOB_CODED, MSG_JOB_DEPTH },
};

LOOP_TEST(rows_come_coded_unless_distances_do, N_ELEM(codings))
{
    struct msg m = usual_submit(job_a);

    m.submit.estimate = "uniform";
    m.submit.flags = codings[_i].flags;
    m.submit.partition = codings[_i].partition;
    say(ANA, &m);
    ck_assert_int_eq(f.last[WORKER].type, MSG_JOB_START);
    ck_assert_uint_eq(f.last[WORKER].job_start.flags, codings[_i].started);
}

static const struct {
    const char *code;
    size_t len;
    uint32_t rows;
    uint8_t channels;
    bool taken;
} coded_rows[] = {
    /* eight columns, one component after the other */
    { "\2\2\0\10\210\1\210\2\210\3\210\4", 12, 1, 1, true },
    { "\2\2\0\10\210\1\210\2\210\3\210\4", 12, 2, 1, false },
    { "\2\2\0\10\210\1\210\2\210\3\210\4\0", 13, 1, 1, false },
    { "\2\2\0\10\210\1\210\2\210\3\210", 11, 1, 1, false },
    { "\2\2\0\7\207\1\207\2\207\3\207\4", 12, 1, 1, false },
    /* nor are floats */
    { NULL, 0, 1, 3, false },
    { NULL, 0, 1, 4, false },
};

LOOP_TEST(coded_rows_that_are_none_end_the_connection, N_ELEM(coded_rows))
{
    struct msg m = usual_submit(job_a);
    struct msg r = { .type = MSG_RESULT,
                     .result = { job_a, 0, 1, 0, coded_rows[_i].rows, 8,
                                 .channels = coded_rows[_i].channels } };

    m.submit.params = "-ps 1";
    m.submit.estimate = "uniform";
    m.submit.partition = MSG_PART_AUTO;
    say(ANA, &m);
    ready(WORKER, job_a);
    ck_assert_uint_gt(f.units[WORKER], 0);
    r.result.pixels =
        coded_rows[_i].code ? (const uint8_t *)coded_rows[_i].code : pixels;
    r.result.len = coded_rows[_i].len;
    say(WORKER, &r);
    ck_assert(f.closed[WORKER] == !coded_rows[_i].taken);
    ck_assert(!coded_rows[_i].taken || f.last[WORKER].type == MSG_ACK);
}

static void
tally(double busy_s, double wait_s, uint64_t rays)
{
    struct msg m = { .type = MSG_TALLY,
                     .tally = { .job = job_a,
                                .busy_s = busy_s,
                                .wait_base_line_s = wait_s,
                                .rays_under_way = rays } };

    say(WORKER, &m);
}

TEST(waits_for_the_line_above_are_summed_over_children)
{
    start_job();
    tally(8, 2.5, 0);
    ck_assert_double_eq(worker_stat("wait_base_line_s"), 2.5);
    ck_assert_double_eq(worker_stat("busy_s"), 5.5);
    tally(1, .25, 0); /* less than before: another child's */
    ck_assert_double_eq(worker_stat("wait_base_line_s"), 2.75);
    ck_assert_double_eq(worker_stat("busy_s"), 6.25);
}

TEST(what_was_counted_for_an_earlier_job_of_the_id_is_not_this_jobs)
{
    start_job();
    about(ANA, MSG_CANCEL, job_a);
    about(ANA, MSG_DELETE, job_a);
    submit(ANA, job_a, 0);
    ck_assert_int_eq(f.last[WORKER].type, MSG_JOB_START);
    tally(8, 0, 0); /* it has not heard of that yet */
    ready(WORKER, job_a);
    ck_assert_double_eq(worker_stat("busy_s"), 0);
    tally(1, 0, 0);
    ck_assert_double_eq(worker_stat("busy_s"), 1);
}

/* The first worker's row in the list of workers. */
static json_t *
worker_row(void)
{
    struct msg m = { .type = MSG_QUERY, .query = { MSG_QUERY_WORKERS, "" } };
    json_t *list, *row;

    say(ANA, &m);
    list = json_loadb((const char *)f.last[ANA].answer.text,
                      f.last[ANA].answer.len, 0, NULL);
    row = json_incref(json_array_get(list, 0));
    json_decref(list);
    return row;
}

static double
number(const json_t *o, const char *key)
{
    ck_assert_msg(json_is_number(json_object_get(o, key)), "no %s", key);
    return json_number_value(json_object_get(o, key));
}

TEST(a_worker_s_row_has_what_open_jobs_have_of_it)
{
    struct msg ping = { .type = MSG_PING, .ping = { 1, 325 } };
    struct msg t = { .type = MSG_TALLY,
                     .tally = { .job = job_a,
                                .ambient_redundant = 5,
                                .cache_values = 70,
                                .peak_rss_bytes = 4096,
                                .busy_s = 2,
                                .rays_under_way = 9 } };
    json_t *row;

    start_job();
    result(WORKER, job_a, 0, 1); /* of ten rays */
    say(WORKER, &ping);
    say(WORKER, &t);
    row = worker_row();
    ck_assert_double_eq(number(row, "load"), 3.25);
    ck_assert_double_eq(number(row, "rays"), 19);
    ck_assert_double_eq(number(row, "redundant"), 5);
    ck_assert_double_eq(number(row, "cache"), 70);
    ck_assert_double_eq(number(row, "memory"), 4096);
    json_decref(row);
    t.tally.busy_s = 1; /* another child's: what the first did stays */
    t.tally.ambient_redundant = 1;
    t.tally.cache_values = 3;
    t.tally.rays_under_way = 0;
    say(WORKER, &t);
    row = worker_row();
    ck_assert_double_eq(number(row, "rays"), 10);
    ck_assert_double_eq(number(row, "redundant"), 6);
    ck_assert_double_eq(number(row, "cache"), 3);
    json_decref(row);
    for (uint32_t u = 1; u < 4; u++)
        result(WORKER, job_a, u, 1);
    row = worker_row(); /* the job is over */
    ck_assert_double_eq(number(row, "rays"), 0);
    ck_assert_double_eq(number(row, "memory"), 0);
    json_decref(row);
}

TEST(statistics_tell_what_is_in_hand)
{
    const struct job *job;
    json_t *root, *list, *one;
    char *text;

    start_job();
    job = desk_find_job(f.c, job_a);
    result(WORKER, job_a, 0, 1);
    f.now_ms += 3000;
    text = stats_text(job, f.now_ms);
    root = json_loads(text, 0, NULL);
    list = json_object_get(root, "running");
    ck_assert_uint_eq(json_array_size(list), job->nout);
    ck_assert_uint_gt(job->nout, 0);
    one = json_array_get(list, 0);
    ck_assert_str_eq(json_string_value(json_object_get(one, "worker")), "ws1");
    ck_assert_double_ge(number(one, "end_s") - number(one, "start_s"), 3);
    ck_assert_double_gt(number(one, "width"), 0);
    json_decref(root);
    free(text);
    for (uint32_t u = 1; u < 4; u++)
        result(WORKER, job_a, u, 1);
    text = stats_text(job, f.now_ms);
    ck_assert_ptr_nonnull(strstr(text, "\"running\": []"));
    free(text);
}

TEST(rays_under_way_are_told_and_never_fewer)
{
    start_job();
    tally(1, 0, 7);
    ck_assert_uint_eq(rays_told(), 7);
    tally(1, 0, 3); /* seven of a unit whose RESULT is on its way */
    ck_assert_uint_eq(rays_told(), 7);
    result(WORKER, job_a, 0, 1); /* ten, and three under way */
    ck_assert_uint_eq(rays_told(), 13);
    for (uint32_t u = 1; u < 4; u++)
        result(WORKER, job_a, u, 1);
    ck_assert_uint_eq(f.progress.rays, 40);
}

/* The share that is done as it is told. */
static double
share_told(void)
{
    rays_told();
    return f.progress.cost_done / f.progress.cost_total;
}

static void
tally_pixels(uint64_t pixels_under_way)
{
    say(WORKER,
        &(struct msg){ .type = MSG_TALLY,
                       .tally = { .job = job_a,
                                  .busy_s = 1,
                                  .pixels_under_way = pixels_under_way } });
}

TEST(the_share_that_is_done_tells_of_units_under_way)
{
    double all;

    start_job();
    ck_assert_double_eq(share_told(), 0);
    all = (double)f.progress.pixels_total;
    tally_pixels(5);
    ck_assert_double_eq_tol(share_told(), 5 / all, 1e-9);
    ck_assert_uint_eq(f.progress.pixels_done, 0);
    tally_pixels(2); /* three of a RESULT that is on its way */
    ck_assert_double_eq_tol(share_told(), 5 / all, 1e-9);
    result(WORKER, job_a, 0, 1); /* a quarter */
    tally_pixels(4);
    ck_assert_double_eq_tol(share_told(), .25 + 4 / all, 1e-9);
    tally_pixels(UINT64_MAX);
    ck_assert_double_eq_tol(share_told(), 1 - 1 / all, 1e-9);
    for (uint32_t u = 1; u < 4; u++)
        result(WORKER, job_a, u, 1);
    ck_assert_int_eq(f.last[ANA].type, MSG_DONE);
    ck_assert_double_eq(f.progress.cost_done, f.progress.cost_total);
}

/* Rows of unit 0, from its first. */
static void
rows_of(uint64_t conn, uint32_t attempt, const uint8_t *bytes, uint32_t rows)
{
    struct msg m = { .type = MSG_RESULT,
                     .result = { job_a,
                                 0,
                                 attempt,
                                 0,
                                 rows,
                                 4,
                                 1,
                                 rows == 4,
                                 { .rays = 10 },
                                 bytes,
                                 rows * 4 * 4 } };

    say(conn, &m);
}

/* What ws1 made of unit 0 comes when ws2 was first. */
static void
late_twin(const uint8_t *bytes)
{
    two_are_left();
    wait_s(61);
    result(SECOND, job_a, 0, 2);
    rows_of(WORKER, 1, bytes, 4);
}

static const uint8_t other[4 * 4 * 4] = { [43] = 129 }; /* an exponent */

TEST(a_duplicate_that_differs_is_an_error)
{
    late_twin(other);
    ck_assert_int_eq(f.differ_logs, 1);
    ck_assert_int_ne(f.last[ANA].type, MSG_FAILED);
}

TEST(a_duplicate_that_does_not_is_none)
{
    late_twin(pixels);
    ck_assert_int_eq(f.differ_logs, 0);
}

TEST(a_late_result_of_an_old_attempt_is_dropped)
{
    start_job();
    coord_closed(f.c, f.now_ms, WORKER, "cut");
    second_ready(job_a); /* has them all again */
    join(6, MSG_ROLE_WORKER, "ws1", "daemon");
    result(6, job_a, f.last[SECOND].unit.unit, 1);
    ck_assert_int_eq(f.last[6].type, MSG_ACK); /* so that it forgets it */
    ck_assert_int_ne(f.last[ANA].type, MSG_DONE);
}

TEST(rows_are_acknowledged_on_the_connection_that_the_worker_has_then)
{
    start_job();
    f.stuck = true;
    result(WORKER, job_a, 0, 1);
    cut(WORKER);
    join(6, MSG_ROLE_WORKER, "ws1", "daemon");
    ready(6, job_a);
    result(6, job_a, 0, 1); /* it has heard of no ACK */
    f.sent[6] = 0;
    coord_rows_stored(f.c, f.now_ms, &f.rows, 0, NULL);
    carry_out();
    ck_assert_uint_eq(f.sent[6], 1);
    ck_assert_int_eq(f.last[6].type, MSG_ACK);
    ck_assert_uint_eq(f.last[6].ack.unit, 0);
    ck_assert_uint_eq(f.last[6].ack.rows, 4);
}

/* Not when rows of another have. */
TEST(a_frame_has_a_preview_when_rows_of_it_have_come)
{
    static const struct msg_frame two[] = { { 0, 8, 8, "" }, { 1, 8, 8, "" } };
    struct msg m = usual_submit(job_a);
    struct msg fetch = { .type = MSG_FETCH,
                         .request = 6,
                         .fetch = { job_a, 1, MSG_WHAT_PREVIEW } };

    m.submit.partition = MSG_PART_WINDOW;
    m.submit.windows = 4;
    m.submit.order = MSG_ORDER_FORWARD;
    m.submit.frames = two;
    m.submit.nframes = 2;
    say(ANA, &m);
    ready(WORKER, job_a);
    for (uint32_t unit = 0; unit <= 5; unit++) {
        uint32_t begun = (unit + 3) / 4; /* frames of four units each */

        for (uint32_t i = 0; i < 2; i++) {
            fetch.fetch.frame = i;
            f.last[ANA].type = MSG_DONE;
            say(ANA, &fetch);
            ck_assert((f.last[ANA].type == MSG_FAILED) == (i >= begun));
        }
        result(WORKER, job_a, unit, 1);
    }
}

TEST(a_result_that_fits_no_unit_ends_the_connection)
{
    start_job();
    result(WORKER, job_a, 4, 1);
    ck_assert(f.closed[WORKER]);
}

/* That row is not here yet. */
TEST(a_duplicate_of_rows_to_come_is_none)
{
    two_are_left();
    wait_s(61);
    rows_of(SECOND, 2, pixels, 2);
    rows_of(WORKER, 1, other, 4);
    ck_assert_int_eq(f.differ_logs, 0);
}

/* Of a job whose pixels depend on which ambient values were there; by a machine
 * that computes other bits; or of another unit, to which an earlier life of the
 * coordinator gave the number, and of which nothing was kept. */
LOOP_TEST(a_duplicate_that_may_differ_is_none, 3)
{
    struct job *job;

    two_are_left();
    job = desk_find_job(f.c, job_a);
    job->exact = _i > 0;
    wait_s(61);
    result(SECOND, job_a, 0, 2);
    if (_i == 1)
        job->parts[part_find(job, "ws1")].fingerprint++;
    else
        job->lives += _i == 2;
    rows_of(WORKER, 1, other, 4);
    ck_assert_int_eq(f.differ_logs, 0);
}
