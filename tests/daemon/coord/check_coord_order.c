/* check_coord_order.c - which job a worker gets units of */
#include "config.h"

#include "coord_passes_fixture.h"
#include "filling/tiles.h"
#include "front/report.h"
#include "jobs/part.h"
#include "registry/recover.h"

FIXTURE(set_up, tear_down)

TEST(a_paused_job_gets_no_units)
{
    submit(ANA, job_a, 0);
    about(ANA, MSG_PAUSE, job_a);
    ready(WORKER, job_a);
    ck_assert_uint_eq(f.units[WORKER], 0);
    about(ANA, MSG_RESUME, job_a);
    ck_assert_uint_eq(f.units[WORKER], 2);
}

TEST(a_drained_worker_gets_nothing_new)
{
    struct msg m = { .type = MSG_DRAIN, .drain = { .name = "ws1" } };

    say(ADMIN, &m);
    submit(ANA, job_a, 0);
    ck_assert_int_eq(f.last[WORKER].type, MSG_WELCOME);
    m.type = MSG_UNDRAIN;
    say(ADMIN, &m);
    ck_assert_int_eq(f.last[WORKER].type, MSG_JOB_START);
}

TEST(a_worker_that_leaves_is_let_go_when_it_is_empty)
{
    struct msg m = { .type = MSG_DRAIN, .drain = { .name = "ws1" } };

    start_job();
    say(WORKER, &m);
    for (uint32_t u = 0; u < 2; u++) {
        ck_assert(!f.closed[WORKER]);
        result(WORKER, job_a, u, 1);
    }
    ck_assert_int_eq(f.last[WORKER].type, MSG_BYE);
    ck_assert(f.closed[WORKER]);
    ck_assert_uint_eq(f.units[WORKER], 2);
}

TEST(higher_priority_goes_first)
{
    start_job();
    submit(BOB, job_b, 1);
    ready(WORKER, job_b);
    result(WORKER, job_a, 0, 1);
    ck_assert_uint_eq(f.unit_job, 0xbb);
}

TEST(owners_share_the_workers)
{
    submit(ANA, job_a, 0);
    submit(BOB, job_b, 0);
    join(SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    ready(WORKER, job_a);
    ck_assert_uint_eq(f.unit_job, 0xaa);
    ready(WORKER, job_b);
    ready(SECOND, job_a);
    ready(SECOND, job_b);
    ck_assert_uint_eq(f.unit_job, 0xaa); /* while it loads bob's */
    ck_assert_int_eq(f.last[SECOND].type, MSG_UNIT);
    result(SECOND, job_a, f.last[SECOND].unit.unit, 1);
    /* ana's is older, but she has more threads at work */
    ck_assert_uint_eq(f.unit_job, 0xbb);
}

static const uint8_t job_c[MSG_JOB] = { 0xcc };

static unsigned
starts(uint64_t conn)
{
    return f.last[conn].type == MSG_JOB_START ? f.last[conn].job_start.job[0]
                                              : 0;
}

/* However many wait: each takes a child, and memory for its scene. */
TEST(a_busy_worker_loads_one_job_ahead)
{
    submit_with(ANA, job_a, 0, 8, 0);
    submit_with(ANA, job_b, 0, 8, 0);
    submit_with(ANA, job_c, 0, 8, 0);
    ready(WORKER, job_a);
    ck_assert_uint_eq(starts(WORKER), 0xbb);
    ready(WORKER, job_b);
    wait_s(1);
    ck_assert_uint_eq(f.unit_job, 0xaa);
    ck_assert_uint_ne(starts(WORKER), 0xcc);
    about(ANA, MSG_CANCEL, job_a);
    ck_assert_uint_eq(f.unit_job, 0xbb);
    ck_assert_uint_eq(starts(WORKER), 0xcc);
}

/* A job that goes first is loaded, whatever is loaded ahead. */
TEST(a_job_that_goes_first_is_loaded_ahead_of_others)
{
    submit(ANA, job_a, 0);
    submit(ANA, job_b, 0);
    ready(WORKER, job_a);
    ready(WORKER, job_b);
    submit(BOB, job_c, 0);
    ck_assert_uint_eq(starts(WORKER), 0xcc);
}

TEST(a_job_without_room_is_not_loaded)
{
    const struct job *job;

    cut(WORKER);
    f.stuck = true;
    submit(ANA, job_a, 0);
    job = desk_find_job(f.c, job_a);
    coord_job_waits(f.c, f.now_ms, job_a, job->sequence, "full");
    join(SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    wait_s(1);
    ck_assert_uint_eq(starts(SECOND), 0);
    coord_job_opened(f.c, f.now_ms, job_a, job->sequence, 0, NULL);
    carry_out();
    ck_assert_uint_eq(starts(SECOND), 0xaa);
}

/* Are so many jobs begun, queued and over, and does job number i have this id?
 */
static void
ranks(size_t begun, size_t queued, size_t over, const char *first_bytes)
{
    ck_assert_uint_eq(f.c->nbegun, begun);
    ck_assert_uint_eq(f.c->nopen, begun + queued);
    ck_assert_uint_eq(f.c->njobs, begun + queued + over);
    for (size_t i = 0; i < f.c->njobs; i++) {
        ck_assert_uint_eq(f.c->jobs[i]->id[0], (uint8_t)first_bytes[i]);
        ck_assert_ptr_eq(desk_find_job(f.c, f.c->jobs[i]->id), f.c->jobs[i]);
    }
}

/* What is asked often goes over the jobs that are begun, and over no others. */
TEST(jobs_that_are_begun_stand_in_front)
{
    struct msg up = { .type = MSG_PRIORITY, .priority = { job_c, 3 } };

    submit(ANA, job_a, 0);
    submit(ANA, job_b, 0);
    submit(BOB, job_c, 0);
    ranks(1, 2, 0, "\xaa\xbb\xcc");
    say(BOB, &up);
    ranks(1, 2, 0, "\xaa\xcc\xbb");
    ready(WORKER, job_a); /* and it loads bob's */
    ranks(2, 1, 0, "\xcc\xaa\xbb");
    about(ANA, MSG_CANCEL, job_a);
    ranks(1, 1, 1, "\xcc\xbb\xaa");
    about(ANA, MSG_CANCEL, job_b);
    ranks(1, 0, 2, "\xcc\xaa\xbb");
    about(ANA, MSG_DELETE, job_a);
    ranks(1, 0, 1, "\xcc\xbb");
    ck_assert_ptr_null(desk_find_job(f.c, job_a));
}

/* Of many tiles. */
static const struct msg_frame huge = { 0, 4000, 3000, "" };

/* The worker makes the tile that it was last sent. */
static void
make_tile(uint64_t conn)
{
    struct msg_tile t = f.last[conn].tile;

    ck_assert(has_tile(conn));
    made(conn, t.pass, t.tile, 0); /* no records, which all would be told */
}

/* Bob's job comes while both workers make tiles for ana. */
TEST(owners_share_workers_that_are_at_passes)
{
    submit_passes(ANA, &huge, 1);
    join(SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    ready(WORKER, job_a);
    ready(SECOND, job_a);
    make_tile(WORKER);
    ck_assert(has_tile(WORKER) && has_tile(SECOND));
    submit(BOB, job_b, 0);
    ck_assert_int_eq(f.last[WORKER].type, MSG_JOB_START);
    ready(WORKER, job_b);
    ck_assert_uint_eq(f.unit_job, 0xbb);
    ck_assert_uint_eq(f.units[WORKER], 2);
    ready(SECOND, job_b);
    ck_assert_uint_eq(f.units[SECOND], 0);
}

/* Neither does ana's second worker follow, nor bob's come back. */
TEST(workers_stay_with_an_owner_at_passes)
{
    struct msg_tile left, next;
    const struct job *job;

    submit_passes(ANA, &huge, 1);
    job = desk_find_job(f.c, job_a);
    join(SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    ready(WORKER, job_a);
    ready(SECOND, job_a);
    left = f.last[WORKER].tile;
    next = f.last[SECOND].tile;
    submit(BOB, job_b, 0);
    ready(WORKER, job_b);
    ready(SECOND, job_b);
    made(WORKER, left.pass, left.tile, 0); /* what it had in hand */
    ck_assert_int_eq(f.last[WORKER].type, MSG_UNIT);
    made(SECOND, next.pass, next.tile, 0);
    for (int i = 0; i < 3; i++)
        make_tile(SECOND);
    ck_assert(has_tile(SECOND));
    wait_s(2);
    result(WORKER, job_b, 0, 1);
    ck_assert_uint_eq(f.units[WORKER], 3);
    ck_assert(!has_tile(WORKER));
    ck_assert_uint_eq(f.units[SECOND], 0);
    for (uint32_t u = 1; u < 4; u++)
        result(WORKER, job_b, u, 1);
    ck_assert_uint_eq(tiles_out(&job->parts[0]), 9); /* bob's is over */
}

/* Bob submits a job of a frame of so many pixels a side. */
static void
submit_frame(uint32_t side, int partition, uint32_t windows)
{
    const struct msg_frame square = { 0, side, side, "" };
    struct msg m = usual_submit(job_b);

    m.submit.frames = &square;
    m.submit.partition = (uint8_t)partition;
    m.submit.windows = windows;
    say(BOB, &m);
}

/* Bob renders lines at both workers when ana's job with passes comes. */
TEST(lines_make_way_for_passes_of_another_owner)
{
    submit_frame(64, MSG_PART_STATIC, 0);
    join(SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    ready(WORKER, job_b);
    ready(SECOND, job_b);
    ck_assert(f.units[WORKER] > 0 && f.units[SECOND] > 0);
    start_passes(&huge);
    ready(SECOND, job_a);
    wait_s(1);
    ck_assert_int_eq(has_tile(WORKER) + has_tile(SECOND), 1);
}

/* Of windows a worker has as many in hand as leave no room for tiles: they are
 * not replaced. */
TEST(windows_make_way_for_passes_of_another_owner)
{
    submit_frame(32, MSG_PART_WINDOW, 64); /* windows of 4 x 4 */
    ready(WORKER, job_b);
    ck_assert_uint_eq(f.units[WORKER], 3);
    submit_passes(ANA, &huge, 1);
    result(WORKER, job_b, 0, 1);
    ready(WORKER, job_a);
    result(WORKER, job_b, 1, 1);
    result(WORKER, job_b, 2, 1);
    ck_assert_uint_gt(tiles_out(&desk_find_job(f.c, job_a)->parts[0]), 0);
    ck_assert_uint_eq(f.units[WORKER], 4); /* one while the scene loaded */
}

/* Once it has begun, too, a job makes way for an older job of its owner. */
TEST(of_an_owners_jobs_the_older_goes_first)
{
    struct msg_tile left;

    submit(ANA, job_b, 0);
    ready(WORKER, job_b);
    about(ANA, MSG_PAUSE, job_b);
    submit_passes(ANA, &huge, 1);
    for (uint32_t u = 0; u < 2; u++)
        result(WORKER, job_b, u, 1);
    ready(WORKER, job_a);
    ck_assert(has_tile(WORKER));
    left = f.last[WORKER].tile;
    f.unit_job = 0;
    about(ANA, MSG_RESUME, job_b);
    made(WORKER, left.pass, left.tile, 0);
    ck_assert_uint_eq(f.unit_job, 0xbb);
}

/* Bob's is older than both, and the second worker is at the younger. */
TEST(an_owners_older_job_goes_first_whoever_else_has_one)
{
    const struct msg_frame square = { 0, 32, 32, "" };
    struct msg many = usual_submit(job_c); /* windows of 4 x 4 */
    struct msg up = { .type = MSG_PRIORITY, .priority = { job_a, 0 } };

    submit(BOB, job_b, 0);
    ready(WORKER, job_b);
    submit(ANA, job_a, -1);
    many.submit.partition = MSG_PART_WINDOW;
    many.submit.windows = 64;
    many.submit.frames = &square;
    say(ANA, &many);
    second_ready(job_c);
    ready(SECOND, job_b);
    say(ANA, &up);
    ready(SECOND, job_a);
    ck_assert_uint_eq(f.unit_job, 0xcc);
    result(SECOND, job_c, 0, 1);
    ck_assert_uint_eq(f.unit_job, 0xaa);
}

TEST(priority_goes_before_fairness)
{
    submit(ANA, job_a, 1);
    submit(BOB, job_b, 0);
    join(SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    ready(WORKER, job_a);
    ready(WORKER, job_b);
    ready(SECOND, job_a);
    ready(SECOND, job_b);
    ck_assert_uint_eq(f.unit_job, 0xaa);
}

/* Four units, of which a worker has two at a time. */
static void
two_arithmetics(uint32_t flags)
{
    struct msg other = { .type = MSG_READY, .ready = { job_a, .1, 8, 2, 0 } };

    submit_with(ANA, job_a, 0, 4, flags);
    join(SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    ready(WORKER, job_a);
    say(SECOND, &other);
}

TEST(same_bits_takes_workers_of_one_arithmetic)
{
    two_arithmetics(MSG_JOB_SAME_BITS);
    ck_assert_int_eq(f.last[SECOND].type, MSG_JOB_END);
    ck_assert_uint_eq(f.units[SECOND], 0);
    ck_assert_int_eq(f.exclude_logs, 1);
    /* nor is it asked again, and one that is the same takes part */
    join(6, MSG_ROLE_WORKER, "ws3", "daemon");
    ready(6, job_a);
    ck_assert_uint_gt(f.units[6], 0);
    wait_s(10);
    ck_assert_uint_eq(f.units[SECOND], 0);
}

/* The first worker was one of an earlier life of the coordinator. */
TEST(same_bits_are_those_of_an_earlier_life)
{
    struct saved_unit unit = { .area = { 0, 0, 0, 4, 4 },
                               .attempt = 1,
                               .worker = "ws9",
                               .fingerprint = 8,
                               .stored = 4,
                               .done = true };
    struct saved_frame none = { 0 };
    struct saved_job s = { .spec = usual_submit(job_a).submit,
                           .owner = "ana",
                           .text = "",
                           .frames = &none,
                           .nunits = 1,
                           .units = &unit };
    struct msg same = { .type = MSG_READY, .ready = { job_a, .1, 8, 2, 0 } };

    s.spec.flags = MSG_JOB_SAME_BITS;
    s.spec.partition = MSG_PART_WINDOW;
    s.spec.windows = 4;
    ck_assert_int_eq(recover_job(f.c, f.now_ms, &s, NULL, NULL, NULL), 0);
    wait_s(1);
    ready(WORKER, job_a);
    ck_assert_int_eq(f.exclude_logs, 1);
    join(SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    say(SECOND, &same);
    ck_assert_uint_gt(f.units[SECOND], 0);
}

TEST(lines_of_a_busy_worker_are_not_waited_for_in_vain)
{
    static const struct msg_frame line = { 0, 8, 2, "" };
    struct msg m = usual_submit(job_a);

    m.submit.frames = &line;
    m.submit.priority = 5;
    m.submit.partition = MSG_PART_AUTO;
    say(ANA, &m);
    join(SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    ready(WORKER, job_a);
    ready(SECOND, job_a);
    ck_assert_uint_eq(f.units[SECOND], 0);
    submit(ANA, job_b, 0);
    wait_s(1);
    ready(SECOND, job_b);
    ck_assert_uint_gt(f.units[SECOND], 0);
}

/* What radctl shows of job_a; to be released. */
static json_t *
job_told(void)
{
    char hex[MSG_JOB_HEX], *out;
    json_t *root;
    int status;

    msg_job_format(job_a, hex);
    out = report_query(f.c, MSG_QUERY_JOB, hex, &status);
    ck_assert_int_eq(status, 0);
    root = json_loads(out, 0, NULL);
    free(out);
    return root;
}

static const char *
text_of_job(void)
{
    static char text[MSG_MAX_TEXT + 1];
    json_t *root = job_told();

    snprintf(text, sizeof text, "%s",
             json_string_value(json_object_get(root, "text")));
    json_decref(root);
    return text;
}

static unsigned
workers_of_job(void)
{
    json_t *root = job_told();
    json_int_t n = json_integer_value(json_object_get(root, "workers"));

    json_decref(root);
    return (unsigned)n;
}

TEST(a_job_that_no_arithmetic_is_left_for_says_so)
{
    two_arithmetics(MSG_JOB_SAME_BITS);
    ck_assert_str_eq(text_of_job(), "");
    cut(WORKER);
    ck_assert_str_eq(
        text_of_job(),
        "--same-bits: no worker here has the arithmetic of the first, ws1");
    join(6, MSG_ROLE_WORKER, "ws3", "daemon");
    ready(6, job_a);
    ck_assert_str_eq(text_of_job(), "");
}

TEST(other_reasons_are_not_taken_for_the_arithmetic)
{
    struct msg lost = { .type = MSG_LOST,
                        .lost = { job_a, EX_OSERR, "out of memory", 0, NULL } };

    submit_with(ANA, job_a, 0, 4, MSG_JOB_SAME_BITS);
    join(SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    ready(WORKER, job_a);
    for (int i = 0; i < JOB_MAX_SETBACKS; i++) {
        ready(SECOND, job_a);
        say(SECOND, &lost);
    }
    ck_assert_str_eq(text_of_job(), "");
    cut(WORKER);
    ck_assert_str_eq(text_of_job(),
                     "no worker that is here can keep a process for it");
    join(WORKER, MSG_ROLE_WORKER, "ws1", "daemon");
    ck_assert_str_eq(text_of_job(), "");
}

TEST(a_job_that_waits_its_turn_says_so)
{
    submit(BOB, job_b, 1);
    ready(WORKER, job_b);
    submit(ANA, job_a, 0);
    ck_assert_str_eq(text_of_job(),
                     "the workers are at other jobs, which go first");
    about(BOB, MSG_CANCEL, job_b);
    ck_assert_str_eq(text_of_job(), "");
}

TEST(a_job_whose_workers_left_for_another_has_none)
{
    start_job();
    ck_assert_uint_eq(workers_of_job(), 1);
    submit(BOB, job_b, 1);
    ready(WORKER, job_b);
    result(WORKER, job_a, 0, 1);
    result(WORKER, job_a, 1, 1);
    ck_assert_uint_eq(workers_of_job(), 0);
    ck_assert_str_eq(text_of_job(),
                     "the workers are at other jobs, which go first");
    about(BOB, MSG_CANCEL, job_b);
    ck_assert_uint_eq(workers_of_job(), 1);
    ck_assert_str_eq(text_of_job(), "");
}

TEST(a_job_whose_workers_are_drained_has_none)
{
    struct msg m = { .type = MSG_DRAIN, .drain = { .name = "ws1" } };

    start_job();
    say(ADMIN, &m);
    ck_assert_uint_eq(workers_of_job(), 1);
    result(WORKER, job_a, 0, 1);
    result(WORKER, job_a, 1, 1);
    ck_assert_uint_eq(workers_of_job(), 0);
    ck_assert_str_eq(text_of_job(), "all workers are drained");
}

TEST(a_job_whose_workers_may_not_work_says_why)
{
    struct msg m = { .type = MSG_DRAIN, .drain = { "ws1", MSG_DRAIN_HOURS } };

    join(SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    join(6, MSG_ROLE_WORKER, "ws3", "daemon");
    say(WORKER, &m);
    m.drain = (struct msg_drain){ "ws2", MSG_DRAIN_IN_USE };
    say(SECOND, &m);
    ck_assert(f.closed[WORKER] && f.closed[SECOND]);
    m.drain = (struct msg_drain){ "ws3", MSG_DRAIN_ORDER };
    say(ADMIN, &m);
    submit(ANA, job_a, 0);
    ck_assert_str_eq(text_of_job(), "no worker may work: 1 outside hours, 1 in "
                                    "use, 1 drained");
    m = (struct msg){ .type = MSG_FORGET, .forget = { "ws2" } };
    say(ADMIN, &m);
    ck_assert_str_eq(text_of_job(),
                     "no worker may work: 1 outside hours, 1 drained");
}

TEST(without_same_bits_all_workers_take_part)
{
    two_arithmetics(0);
    ck_assert_uint_gt(f.units[SECOND], 0);
    ck_assert_int_eq(f.exclude_logs, 0);
}
