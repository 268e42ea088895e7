/* check_coord_faults.c - units that are late or crash, and workers that hang */
#include "config.h"

#include "coord_fixture.h"

FIXTURE(set_up, tear_down)

TEST(a_late_unit_goes_to_another_and_the_first_result_wins)
{
    two_are_left();
    wait_s(59);
    ck_assert_uint_eq(f.units[SECOND], 0);
    wait_s(2);
    ck_assert_uint_eq(f.units[SECOND], 2);
    result(SECOND, job_a, 0, 2);
    result(SECOND, job_a, 1, 2);
    ck_assert_int_eq(f.last[ANA].type, MSG_DONE);
    ck_assert_int_eq(f.last[WORKER].type, MSG_JOB_END);
}

TEST(the_lease_is_a_setting)
{
    coord_set_lease_floor(f.c, 2000);
    two_are_left();
    wait_s(1);
    ck_assert_uint_eq(f.units[SECOND], 0);
    wait_s(2);
    ck_assert_uint_eq(f.units[SECOND], 2);
}

static void
ping(uint64_t progress)
{
    struct msg m = { .type = MSG_PING, .ping = { progress, 0 } };

    say(WORKER, &m);
}

/* Units of this job take 100 s. */
static void
slow_job(void)
{
    start_job();
    second_ready(job_a);
    for (int i = 0; i < 50; i++) {
        wait_s(1);
        ping((uint64_t)i);
    }
    result(SECOND, job_a, 2, 1);
    result(SECOND, job_a, 3, 1);
    f.units[SECOND] = 0;
}

TEST(a_worker_that_gets_on_has_time)
{
    slow_job();
    for (int i = 0; i < 400; i++) {
        wait_s(1);
        ping(100 + (uint64_t)i / 8);
    }
    ck_assert_uint_eq(f.units[SECOND], 0);
    ck_assert_int_eq(f.hang_logs, 0);
}

TEST(a_worker_that_hangs_has_not)
{
    slow_job();
    for (int i = 0; i < 70; i++) {
        wait_s(1);
        ping(100);
    }
    ck_assert_uint_eq(f.units[SECOND], 2);
    ck_assert_int_eq(f.hang_logs, 1);
}

TEST(two_crashes_alone_fail_the_job_and_name_the_unit)
{
    uint32_t both[] = { 0, 1 }, one[] = { 1 };
    struct msg m = { .type = MSG_LOST,
                     .lost = { job_a, EX_SOFTWARE, "killed by signal 11", 2,
                               both } };

    start_job();
    say(WORKER, &m);
    second_ready(job_a);
    ck_assert_uint_eq(f.units[SECOND], 1); /* a suspect goes alone */
    ck_assert_uint_le(f.last[SECOND].unit.unit, 1);
    one[0] = f.last[SECOND].unit.unit;
    m.lost.nunits = 1;
    m.lost.units = one;
    say(SECOND, &m);
    ck_assert_int_eq(f.last[ANA].type, MSG_FAILED);
    ck_assert_int_eq(f.last[ANA].failed.status, EX_SOFTWARE);
    ck_assert_ptr_nonnull(strstr(f.last[ANA].failed.text, "brought the"));
}

/* Its user is told whose fault it was. */
LOOP_TEST(a_scene_that_no_worker_can_load_fails_as_it_did_there, 3)
{
    static const uint16_t status[] = { EX_SOFTWARE, EX_OSERR, EX_IOERR };
    struct msg m = { .type = MSG_LOST,
                     .lost = { job_a, status[_i], "came spoilt", 0, NULL } };
    int times = 0;

    submit(ANA, job_a, 0);
    for (; times < 10 && f.last[ANA].type != MSG_FAILED; times++)
        say(WORKER, &m);
    ck_assert_int_eq(times, JOB_MAX_CRASHES);
    ck_assert_int_eq(f.last[ANA].failed.status, status[_i]);
    ck_assert_str_eq(
        f.last[ANA].failed.text,
        "no worker can load the scene; the last, ws1: came spoilt");
}

enum { THIRD = STRANGER };

/* What two of three lack the third may have, which is slow to load; if it has
 * not, the job fails. */
LOOP_TEST(a_scene_too_large_for_two_workers_is_left_to_a_third, 2)
{
    struct msg m = { .type = MSG_LOST,
                     .lost = { job_a, EX_OSERR, "out of memory", 0, NULL } };

    join(SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    join(THIRD, MSG_ROLE_WORKER, "ws3", "daemon");
    submit(ANA, job_a, 0);
    for (int times = 0; times < JOB_MAX_CRASHES; times++) {
        say(WORKER, &m);
        say(SECOND, &m);
    }
    ck_assert_int_ne(f.last[ANA].type, MSG_FAILED);
    if (_i) {
        for (int times = 0; times < JOB_MAX_CRASHES; times++)
            say(THIRD, &m);
        ck_assert_int_eq(f.last[ANA].type, MSG_FAILED);
        ck_assert_int_eq(f.last[ANA].failed.status, EX_OSERR);
        return;
    }
    ready(THIRD, job_a);
    for (uint32_t u = 0; u < 4; u++)
        for (uint32_t attempt = 1; attempt < 9; attempt++)
            result(THIRD, job_a, u, attempt);
    ck_assert_int_eq(f.last[ANA].type, MSG_DONE);
}

/* The worker loses its child, and takes the job up again. */
static void
set_back(uint64_t conn)
{
    struct msg m = { .type = MSG_LOST,
                     .lost = { job_a, EX_OSERR, "out of memory", 0, NULL } };

    say(conn, &m);
}

TEST(a_worker_that_cannot_keep_a_child_leaves_the_job_to_others)
{
    start_job();
    second_ready(job_a);
    for (int i = 1; i < JOB_MAX_SETBACKS; i++) {
        set_back(SECOND);
        ck_assert_int_eq(f.last[SECOND].type, MSG_JOB_START);
        ready(SECOND, job_a);
    }
    f.sent[SECOND] = 0;
    set_back(SECOND);
    ck_assert_uint_eq(f.sent[SECOND], 0); /* it had its chances */
    ck_assert_int_ne(f.last[ANA].type, MSG_FAILED);
    for (uint32_t u = 0; u < 4; u++)
        for (uint32_t attempt = 1; attempt < 9; attempt++)
            result(WORKER, job_a, u, attempt);
    ck_assert_int_eq(f.last[ANA].type, MSG_DONE);
}

TEST(a_job_that_nobody_can_keep_a_child_for_fails)
{
    submit(ANA, job_a, 0);
    for (int i = 1; i <= JOB_MAX_SETBACKS; i++) {
        ck_assert_int_ne(f.last[ANA].type, MSG_FAILED);
        ready(WORKER, job_a);
        set_back(WORKER);
    }
    ck_assert_int_eq(f.last[ANA].type, MSG_FAILED);
    ck_assert_int_eq(f.last[ANA].failed.status, EX_UNAVAILABLE);
    ck_assert_ptr_nonnull(strstr(f.last[ANA].failed.text, "out of memory"));
}

/* The other may have room again. */
TEST(a_job_waits_for_a_worker_without_room_if_no_other_can_keep_a_child)
{
    struct msg room = { .type = MSG_ROOM,
                        .room = { job_a, false, "the disk is full" } };

    submit(ANA, job_a, 0);
    join(SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    say(SECOND, &room);
    for (int i = 1; i <= JOB_MAX_SETBACKS; i++) {
        ready(WORKER, job_a);
        set_back(WORKER);
    }
    ck_assert_int_ne(f.last[ANA].type, MSG_FAILED);
    room.room.has = true;
    say(SECOND, &room);
    ck_assert_int_eq(f.last[SECOND].type, MSG_JOB_START);
}

TEST(a_unit_done_makes_up_for_setbacks)
{
    submit(ANA, job_a, 0);
    for (uint32_t u = 0; u < 3; u++) {
        ready(WORKER, job_a);
        for (int i = 1; i < JOB_MAX_SETBACKS; i++) {
            set_back(WORKER);
            ready(WORKER, job_a);
        }
        for (uint32_t attempt = 1; attempt < 40; attempt++)
            result(WORKER, job_a, u, attempt);
    }
    ck_assert_int_ne(f.last[ANA].type, MSG_FAILED);
}
