/* check_worker.c - a worker, its coordinator and its children, one event at a
 * time: files, units, rows, what is lost */
#include "config.h"

#include "worker_fixture.h"

#include <sysexits.h>

FIXTURE(set_up, tear_down)

TEST(it_dials_again_and_waits_longer_each_time)
{
    static const unsigned delays[] = { 500,  1000,  2000,  4000,
                                       8000, 16000, 30000, 30000 };

    for (int i = 0; i < N_ELEM(delays); i++) {
        cut();
        f.dials = 0;
        tick(delays[i] - 1);
        ck_assert_uint_eq(f.dials, 0);
        tick(1);
        ck_assert_uint_eq(f.dials, 1);
    }
    connect(); /* and after a good connection it begins anew */
    f.now_ms += 20000;
    cut();
    f.dials = 0;
    tick(500);
    ck_assert_uint_eq(f.dials, 1);
}

TEST(files_that_it_lacks_come_before_the_child)
{
    f.have = false;
    start_job();
    ck_assert_int_eq(said(f.coord, MSG_WANT), 1);
    ck_assert_uint_eq(f.last.want.n, 1);
    ck_assert_uint_eq(f.spawns, 0);
    f.have = true;
    worker_file_stored(f.w, f.now_ms, hash);
    carry_out();
    ck_assert_uint_eq(f.spawns, 1);
    ck_assert_int_eq(said(f.child, MSG_JOB_START), 1);
}

/* It is the disk's affair and not the job's. */
TEST(what_finds_no_room_is_told_and_again_when_it_does)
{
    cut();
    tick(1000);
    connect();
    f.have = false;
    start_job();
    worker_file_failed(f.w, f.now_ms, hash, EX_IOERR, "no room on the disk");
    worker_file_failed(f.w, f.now_ms, hash, EX_PROTOCOL, "what is left of it");
    carry_out();
    ck_assert_int_eq(said(f.coord, MSG_ROOM), 1);
    ck_assert_int_eq(said(f.coord, MSG_LOST), 0);
    ck_assert_uint_eq(f.last.room.has, 0);
    ck_assert_str_eq(f.last.room.text, "no room on the disk");
    clear();
    tick(900);
    ck_assert_int_eq(said(f.coord, MSG_ROOM), 0);
    tick(100);
    ck_assert_int_eq(said(f.coord, MSG_ROOM), 1);
    ck_assert_uint_eq(f.last.room.has, 1);
    tick(60000);
    ck_assert_int_eq(said(f.coord, MSG_ROOM), 1);
    ck_assert_int_eq(said(f.coord, MSG_WANT), 0);
    start_job();
    ck_assert_int_eq(said(f.coord, MSG_WANT), 1);
    ck_assert_uint_eq(f.spawns, 0);
}

/* But in a cluster of radsubmit's own no other worker has another disk. */
TEST(what_finds_no_room_on_the_only_disk_fails_the_job)
{
    tear_down();
    set_up_on(true);
    f.have = false;
    start_job();
    worker_file_failed(f.w, f.now_ms, hash, EX_IOERR, "no room on the disk");
    carry_out();
    ck_assert_int_eq(said(f.coord, MSG_ROOM), 0);
    ck_assert_int_eq(said(f.coord, MSG_FAILED), 1);
    ck_assert_uint_eq(f.last.failed.status, EX_IOERR);
    ck_assert_str_eq(f.last.failed.text, "no room on the disk");
}

/* The store tells of the job's files when nobody can be asked for them. */
TEST(what_is_missing_while_the_coordinator_is_away_is_wanted_later)
{
    struct action_look l = { .status = 0 };

    f.have = false;
    start_job();
    cut();
    memcpy(l.job, job_id, MSG_JOB);
    worker_looked(f.w, f.now_ms, &l);
    carry_out();
    tick(1000);
    clear();
    connect();
    start_job();
    ck_assert_int_eq(said(f.coord, MSG_WANT), 1);
}

static void
chunk(const uint8_t *of, uint64_t offset)
{
    struct msg m = { .type = MSG_CHUNK,
                     .chunk = { of, offset, 2, (const uint8_t *)"x", 1 } };

    hear(f.coord, &m);
}

TEST(only_what_was_asked_for_is_kept)
{
    static const uint8_t other[MSG_HASH] = { 99 };

    f.have = false;
    chunk(hash, 0);
    ck_assert_uint_eq(f.chunks, 0);
    start_job();
    chunk(other, 0);
    chunk(hash, 1); /* the end of one that was given up */
    ck_assert_uint_eq(f.chunks, 0);
    chunk(hash, 0);
    chunk(hash, 1);
    ck_assert_uint_eq(f.chunks, 2);
}

/* The coordinator may have known of its end before it heard of the WANT. */
TEST(what_a_job_wanted_that_is_over_is_wanted_again_by_the_next)
{
    struct msg over = { .type = MSG_JOB_END, .job_end = { job_id } };

    f.have = false;
    start_job();
    hear(f.coord, &over);
    clear();
    start_job();
    ck_assert_int_eq(said(f.coord, MSG_WANT), 1);
}

/* What has begun goes on. */
TEST(a_file_that_comes_is_not_wanted_again_by_the_next_job)
{
    struct msg over = { .type = MSG_JOB_END, .job_end = { job_id } };

    f.have = false;
    start_job();
    chunk(hash, 0);
    hear(f.coord, &over);
    clear();
    start_job();
    ck_assert_int_eq(said(f.coord, MSG_WANT), 0);
    chunk(hash, 1);
    ck_assert_uint_eq(f.chunks, 2);
}

/* The coordinator sends no more of its files, however many it wanted. */
TEST(what_a_job_wanted_that_had_no_room_is_wanted_again_by_the_next)
{
    static const uint8_t two[2 * MSG_HASH] = { 1, [MSG_HASH] = 2 };
    struct msg over = { .type = MSG_JOB_END, .job_end = { job_id } };

    f.have = false;
    job_files = two;
    job_nfiles = 2;
    start_job();
    worker_file_failed(f.w, f.now_ms, hash, EX_IOERR, "no room on the disk");
    hear(f.coord, &over);
    clear();
    start_job();
    job_files = hash;
    job_nfiles = 1;
    ck_assert_int_eq(said(f.coord, MSG_WANT), 1);
    ck_assert_uint_eq(f.last.want.n, 2);
}

/* The store goes on until all that was asked of it is done. */
TEST(a_worker_that_has_stopped_starts_no_child)
{
    f.have = false;
    start_job();
    worker_drain(f.w, f.now_ms);
    worker_drain(f.w, f.now_ms);
    carry_out();
    ck_assert(f.stopped);
    f.have = true;
    worker_file_stored(f.w, f.now_ms, hash);
    carry_out();
    ck_assert_uint_eq(f.spawns, 0);
}

TEST(units_go_down_and_results_up)
{
    load_job();
    ck_assert_int_eq(said(f.coord, MSG_READY), 1);
    ck_assert_mem_eq(f.last.ready.job, job_id, MSG_JOB);
    unit(3);
    ck_assert_int_eq(said(f.child, MSG_UNIT), 1);
    rows(3, 0);
    ck_assert_int_eq(f.last.type, MSG_RESULT);
    ck_assert_uint_eq(f.last.result.row, 0);
    rows(3, 2);
    ck_assert_int_eq(said(f.coord, MSG_RESULT), 2);
    rows(3, 2); /* of a unit that it does not have any more */
    rows(9, 0);
    ck_assert_int_eq(said(f.coord, MSG_RESULT), 2);
}

TEST(what_was_not_acknowledged_is_sent_again)
{
    load_job();
    for (uint32_t u = 0; u < 3; u++)
        unit(u);
    rows(0, 0);
    rows(0, 2);
    ack(0, 0);
    rows(1, 0); /* and its second half is missing */
    cut();
    clear();
    tick(500);
    connect();
    start_job();
    /* what was not acknowledged, of units that go on, too; then READY */
    ck_assert_int_eq(said(f.coord, MSG_RESULT), 2);
    ck_assert_int_eq(said(f.child, MSG_REVOKE), 0);
    ck_assert_int_eq(f.last.type, MSG_READY);
    ack(0, 2);
    ack(1, 0);
    cut();
    clear();
    tick(1000);
    connect();
    start_job();
    ck_assert_int_eq(said(f.coord, MSG_RESULT), 0);
    ck_assert_uint_eq(f.spawns, 1); /* the child lived on */
}

TEST(a_worker_that_may_not_work_leaves_and_comes_back)
{
    struct msg bye = { .type = MSG_BYE, .bye = { "drained" } };
    unsigned dials;

    load_job();
    unit(0);
    worker_allow(f.w, f.now_ms, MSG_DRAIN_HOURS);
    carry_out();
    ck_assert_int_eq(f.last.type, MSG_DRAIN);
    ck_assert_int_eq(f.last.drain.why, MSG_DRAIN_HOURS);
    ck_assert_uint_eq(f.kills, 0);
    rows(0, 0);
    rows(0, 2); /* what is begun is finished */
    ck_assert_int_eq(f.last.type, MSG_RESULT);
    hear(f.coord, &bye);
    ck_assert(!f.stopped);
    cut();
    ck_assert_uint_eq(f.warnings, 0);
    ck_assert_uint_eq(f.kills, 1); /* and nothing stays */
    dials = f.dials;
    for (int i = 0; i < 100; i++)
        tick(1000);
    ck_assert_uint_eq(f.dials, dials);
    worker_allow(f.w, f.now_ms, MSG_DRAIN_IN_USE); /* for another reason */
    carry_out();
    ck_assert_uint_eq(f.dials, ++dials);
    connect();
    ck_assert_int_eq(f.last.type, MSG_DRAIN);
    ck_assert_int_eq(f.last.drain.why, MSG_DRAIN_IN_USE);
    hear(f.coord, &bye);
    cut();
    for (int i = 0; i < 100; i++)
        tick(1000);
    ck_assert_uint_eq(f.dials, dials);
    worker_allow(f.w, f.now_ms, 0);
    tick(100);
    ck_assert_uint_eq(f.dials, dials + 1);
    cut(); /* and that is one */
    ck_assert_uint_eq(f.warnings, 1);
    worker_allow(f.w, f.now_ms, MSG_DRAIN_HOURS);
    worker_allow(f.w, f.now_ms, 0); /* the pause before a dial is over, too */
    tick(1);
    ck_assert_uint_eq(f.dials, dials + 2);
}

TEST(a_worker_that_is_welcomed_when_it_may_not_work_leaves)
{
    struct msg m = { .type = MSG_WELCOME,
                     .welcome = { MSG_VERSION, 1, "radcoord" } };

    cut();
    tick(500);
    worker_opened(f.w, f.now_ms, f.coord);
    worker_allow(f.w, f.now_ms, MSG_DRAIN_IN_USE);
    hear(f.coord, &m);
    ck_assert_int_eq(f.last.type, MSG_DRAIN);
    ck_assert_int_eq(f.last.drain.why, MSG_DRAIN_IN_USE);
    worker_drain(f.w, f.now_ms);
    carry_out();
    ck_assert_int_eq(f.last.drain.why, MSG_DRAIN_STOPPED);
    clear();
    worker_allow(f.w, f.now_ms, 0);
    worker_allow(f.w, f.now_ms, MSG_DRAIN_HOURS);
    carry_out();
    ck_assert_int_eq(said(f.coord, MSG_DRAIN), 0);
}

/* Nobody takes its work back: it waits for the next dial, it dials, or the
 * coordinator has parted from it. */
static const enum {
    BEFORE_DIAL,
    DIALLING,
    PARTED
} no_coord[] = { BEFORE_DIAL, DIALLING, PARTED };

LOOP_TEST(a_worker_that_may_not_work_and_has_no_coordinator_ends_its_children,
          N_ELEM(no_coord))
{
    struct msg bye = { .type = MSG_BYE, .bye = { "drained" } };
    unsigned dials;

    load_job();
    unit(0);
    if (no_coord[_i] == PARTED)
        hear(f.coord, &bye);
    else
        cut();
    if (no_coord[_i] == DIALLING)
        tick(500);
    dials = f.dials;
    ck_assert_uint_eq(dials, no_coord[_i] == DIALLING ? 2 : 1);
    worker_allow(f.w, f.now_ms, MSG_DRAIN_IN_USE);
    carry_out();
    ck_assert_uint_eq(f.kills, 1);
    ck_assert_int_eq(said(f.coord, MSG_DRAIN), 0);
    tick(60000);
    ck_assert_uint_eq(f.dials, dials);
    ck_assert_uint_eq(f.spawns, 1);
}

TEST(what_is_kept_is_counted_until_it_is_acknowledged)
{
    struct msg ack = { .type = MSG_ACK, .ack = { job_id, 0, 1, 0, 2 } };
    struct msg other[] = { ack, ack, ack };
    size_t one, two;

    other[0].ack.unit = 1;
    other[1].ack.attempt = 2;
    other[2].ack.row = 1;
    load_job();
    unit(0);
    ck_assert_uint_eq(worker_kept(f.w, f.child), 0);
    rows(0, 0);
    one = worker_kept(f.w, f.child);
    ck_assert_uint_gt(one, 0);
    rows(0, 2);
    two = worker_kept(f.w, f.child);
    ck_assert_uint_gt(two, one);
    for (int i = 0; i < N_ELEM(other); i++) {
        hear(f.coord, &other[i]);
        ck_assert_uint_eq(worker_kept(f.w, f.child), two);
    }
    hear(f.coord, &ack);
    ck_assert_uint_gt(worker_kept(f.w, f.child), 0);
    ack.ack.row = 2;
    hear(f.coord, &ack);
    ck_assert_uint_eq(worker_kept(f.w, f.child), 0);
}

TEST(a_child_that_is_held_does_not_hang)
{
    load_job();
    unit(0);
    worker_hold(f.w, f.child, true);
    for (int i = 0; i < 1000; i++)
        tick(900);
    ck_assert_uint_eq(f.kills, 0);
    worker_hold(f.w, f.child, false);
    for (int i = 0; i < 113; i++)
        tick(900);
    ck_assert_uint_eq(f.kills, 1);
}

/* The second row: a new child loads already. */
LOOP_TEST(rows_of_a_child_that_died_after_a_cut_are_sent_again, 2)
{
    load_job();
    unit(0);
    unit(1);
    rows(0, 0);
    rows(0, 2);
    rows(1, 0); /* its unit goes with the child */
    if (_i == 1) {
        worker_child_ended(f.w, f.now_ms, f.child, EX_SOFTWARE, "gone");
        carry_out();
        start_job();
    }
    cut();
    if (_i == 0) {
        worker_child_ended(f.w, f.now_ms, f.child, EX_SOFTWARE, "gone");
        carry_out();
    }
    clear();
    tick(500);
    connect();
    start_job();
    ck_assert_int_eq(said(f.coord, MSG_RESULT), 2);
    child_ready();
    ck_assert_int_eq(f.last.type, MSG_READY);
    ck_assert_int_eq(said(f.coord, MSG_RESULT), 2);
    ack(0, 0);
    ack(0, 2);
    ck_assert_uint_eq(worker_kept(f.w, f.child), 0);
}

TEST(rows_wait_for_the_start_after_a_cut)
{
    load_job();
    unit(0);
    cut();
    rows(0, 0);
    clear();
    tick(500);
    connect();
    rows(0, 2); /* the first would come after it */
    ck_assert_int_eq(said(f.coord, MSG_RESULT), 0);
    start_job();
    ck_assert_int_eq(said(f.coord, MSG_RESULT), 2);
}

TEST(a_lost_child_is_reported_with_its_suspects)
{
    load_job();
    for (uint32_t u = 0; u < 4; u++)
        unit(u);
    rows(0, 0);
    rows(0, 2);
    child_crashes();
    ck_assert_int_eq(f.last.type, MSG_LOST);
    ck_assert_str_eq(f.last.lost.text, "killed by signal 11");
    ck_assert_uint_eq(f.last.lost.nunits, 2); /* as many as threads */
    ck_assert_uint_eq(f.last.lost.units[0], 1);
    ck_assert_uint_eq(f.last.lost.units[1], 2);
    start_job();
    ck_assert_uint_eq(f.spawns, 2);
}

TEST(the_end_of_a_job_ends_its_child)
{
    struct msg m = { .type = MSG_JOB_END, .job_end = { job_id } };

    load_job();
    hear(f.coord, &m);
    ck_assert_uint_eq(f.kills, 1);
    clear();
    child_ready(); /* from beyond the grave */
    hear(f.coord, &m);
    ck_assert_int_eq(f.nsaid, 0);
}

TEST(a_child_that_gives_up_is_reported)
{
    struct msg m = { .type = MSG_FAILED, .failed = { job_id, 65, "no light" } };

    start_job();
    hear(f.child, &m);
    ck_assert_int_eq(f.last.type, MSG_FAILED);
    ck_assert_uint_eq(f.last.failed.status, 65);
    ck_assert_uint_eq(f.kills, 1);
}

static const struct {
    int status;
    uint16_t told;     /* to the coordinator */
    uint32_t suspects; /* in a LOST */
    uint16_t lost;     /* its status */
} giving_up[] = {
    { EX_DATAERR, MSG_FAILED, 0, 0 }, /* so is the scene everywhere */
    { EX_UNAVAILABLE, MSG_FAILED, 0, 0 },
    { EX_SOFTWARE, MSG_LOST, 1, EX_SOFTWARE }, /* a unit that it cannot do */
    { EX_OSERR, MSG_LOST, 0, EX_OSERR },       /* no memory, here */
    { EX_TEMPFAIL, MSG_LOST, 0, EX_OSERR },
    { EX_IOERR, MSG_LOST, 0, EX_IOERR },
    { EX_NOINPUT, MSG_LOST, 0, EX_IOERR },
    { EX_NOPERM, MSG_LOST, 0, EX_IOERR },
};

LOOP_TEST(what_is_wrong_here_is_not_the_scenes_fault, N_ELEM(giving_up))
{
    struct msg m = { .type = MSG_FAILED,
                     .failed = { job_id, (uint16_t)giving_up[_i].status,
                                 "why" } };

    load_job();
    unit(0);
    hear(f.child, &m);
    ck_assert_int_eq(f.last.type, giving_up[_i].told);
    ck_assert_uint_eq(f.kills, 1);
    if (f.last.type == MSG_LOST) {
        ck_assert_uint_eq(f.last.lost.nunits, giving_up[_i].suspects);
        ck_assert_uint_eq(f.last.lost.status, giving_up[_i].lost);
        ck_assert_str_eq(f.last.lost.text, "why");
    }
}

TEST(a_child_killed_from_outside_leaves_no_suspects)
{
    load_job();
    unit(0);
    worker_child_ended(f.w, f.now_ms, f.child, EX_OSERR, "killed by signal 9");
    carry_out();
    ck_assert_int_eq(f.last.type, MSG_LOST);
    ck_assert_uint_eq(f.last.lost.nunits, 0);
}

/* Its job may have too little memory, which is so at all workers. */
TEST(a_child_may_end_for_its_jobs_fault)
{
    load_job();
    unit(0);
    worker_child_ended(f.w, f.now_ms, f.child, EX_DATAERR, "out of memory");
    carry_out();
    ck_assert_int_eq(f.last.type, MSG_FAILED);
    ck_assert_int_eq(f.last.failed.status, EX_DATAERR);
    ck_assert_mem_eq(f.last.failed.job, job_id, MSG_JOB);
    ck_assert_str_eq(f.last.failed.text, "out of memory");
}

/* load_s is 100 */
TEST(a_child_that_hangs_is_ended)
{
    start_job();
    for (int i = 0; i < 109; i++)
        tick(900);
    ck_assert_uint_eq(f.kills, 0);
    tick(2000000); /* asleep, as the child was: a second of that counts */
    ck_assert_uint_eq(f.kills, 0);
    child_ready();
    unit(0);
    for (int i = 0; i < 111; i++)
        tick(900);
    ck_assert_uint_eq(f.kills, 0);
    tick(900);
    ck_assert_uint_eq(f.kills, 1);
    ck_assert_int_eq(f.last.type, MSG_LOST);
    ck_assert_uint_eq(f.last.lost.nunits, 1);
    ck_assert_str_eq(f.last.lost.text, "silent for 100 s");
}

TEST(a_child_without_units_may_be_silent)
{
    load_job();
    for (int i = 0; i < 1000; i++)
        tick(900);
    ck_assert_uint_eq(f.kills, 0);
}

TEST(a_child_that_hangs_at_a_tile_is_ended)
{
    struct msg tile = { .type = MSG_TILE, .tile = { .job = job_id } };
    struct msg made = { .type = MSG_TILE_MADE, .tile_made = { .job = job_id } };

    load_job();
    hear(f.coord, &tile);
    hear(f.child, &made);
    for (int i = 0; i < 1000; i++)
        tick(900);
    ck_assert_uint_eq(f.kills, 0);
    hear(f.coord, &tile);
    for (int i = 0; i < 112; i++)
        tick(900);
    ck_assert_uint_eq(f.kills, 1);
}

TEST(a_refusal_ends_it_with_the_status)
{
    struct msg m = { .type = MSG_REFUSE, .refuse = { 76, "version" } };

    cut();
    tick(500);
    worker_opened(f.w, f.now_ms, f.coord);
    hear(f.coord, &m);
    ck_assert(f.stopped);
    ck_assert_int_eq(f.status, 76);
}

RANGE_TEST(it_speaks_as_it_is_welcomed, MSG_VERSION_MIN, MSG_VERSION + 1)
{
    const uint16_t version = (uint16_t)_i;
    struct msg m = { .type = MSG_WELCOME,
                     .welcome = { version, 1, "radcoord" } };

    cut();
    tick(500);
    worker_opened(f.w, f.now_ms, f.coord);
    carry_out();
    ck_assert_int_eq(f.last.type, MSG_HELLO);
    ck_assert_uint_eq(f.last.hello.min, MSG_VERSION_MIN);
    ck_assert_uint_eq(f.last.hello.max, MSG_VERSION);
    ck_assert_uint_eq(f.version, MSG_VERSION); /* HELLO is the same in all */
    hear(f.coord, &m);
    ck_assert_int_eq(f.session, MSG_AT_WORKER);
    ck_assert_uint_eq(f.version, version);
}

static const uint16_t strange[] = { 0, MSG_VERSION + 1, 9 };

LOOP_TEST(it_ends_when_welcomed_in_another_version, N_ELEM(strange))
{
    struct msg m = { .type = MSG_WELCOME,
                     .welcome = { strange[_i], 1, "radcoord" } };

    cut();
    tick(500);
    worker_opened(f.w, f.now_ms, f.coord);
    hear(f.coord, &m);
    ck_assert(f.stopped);
    ck_assert_int_eq(f.status, 76);
}

/* The coordinator is lost when two pieces of a job's rows are on their way. */
static void
cut_with_rows(void)
{
    load_job();
    unit(3);
    rows(3, 0);
    rows(3, 2);
    cut();
    tick(500);
}

TEST(results_come_again_in_another_life_of_the_coordinator)
{
    struct msg m = { .type = MSG_WELCOME, .welcome = { 1, 2, "radcoord" } };

    cut_with_rows();
    worker_opened(f.w, f.now_ms, f.coord);
    hear(f.coord, &m);
    clear();
    ck_assert_int_eq(said(f.coord, MSG_RESULT), 0); /* it may not know it */
    start_job();
    ck_assert_int_eq(said(f.coord, MSG_RESULT), 2);
    ck_assert_int_eq(said(f.coord, MSG_READY), 1);
}

TEST(it_leaves_when_the_coordinator_lets_it_go)
{
    struct msg m = { .type = MSG_BYE, .bye = { "drained" } };

    worker_drain(f.w, f.now_ms);
    carry_out();
    ck_assert_int_eq(f.last.type, MSG_DRAIN);
    ck_assert_int_eq(f.last.drain.why, MSG_DRAIN_STOPPED);
    ck_assert(!f.stopped);
    hear(f.coord, &m);
    ck_assert(f.stopped);
    ck_assert_int_eq(f.status, 0);
    cut();
    ck_assert_uint_eq(f.warnings, 0);
}

/* Nothing is given up but columns that another worker lends. */
TEST(units_go_on_when_the_coordinator_is_back)
{
    static const uint8_t bitmap[1] = { 1 };
    const struct msg parked = { .type = MSG_PARKED,
                                .parked = { job_id, 1, 1 } };
    const struct msg gave = { .type = MSG_GAVE, .gave = { job_id, 0, 1, 2 } };
    const struct msg loan = { .type = MSG_LOAN,
                              .loan = { job_id, 3, 1, 0, 5, 0, 6, 1, 2, 0, 3, 0,
                                        density, bitmap, line_bytes,
                                        line_bytes } };
    const struct msg taken = { .type = MSG_REVOKE, .revoke = { job_id, 1, 1 } };
    static const uint16_t order[] = { MSG_RESULT, MSG_STILL, MSG_STILL,
                                      MSG_PARKED, MSG_READY };

    load_job();
    for (uint32_t u = 0; u < 2; u++)
        unit(u);
    hear(f.coord, &loan);
    cut();
    hear(f.child, &parked);
    hear(f.child, &gave); /* which the coordinator does not hear of */
    rows(0, 0);
    tick(500);
    connect();
    clear();
    start_job();
    ck_assert_int_eq(said(f.child, MSG_REVOKE), 1); /* the loan */
    ck_assert_int_eq(f.nsaid, 1 + N_ELEM(order));
    for (int i = 0; i < N_ELEM(order); i++)
        ck_assert_int_eq(f.said[1 + i].type, order[i]);
    ck_assert(f.height[0] == 2 && f.height[1] == 4);
    hear(f.coord, &taken);
    ck_assert_int_eq(said(f.child, MSG_REVOKE), 2);
    rows(0, 2);
    ck_assert_int_eq(said(f.coord, MSG_RESULT), 2);
}

/* The coordinator died before it had kept the job, and another job's cache is
 * the last one that fits by now. */
TEST(a_job_that_begins_with_another_cache_begins_anew)
{
    static const uint8_t one[MSG_JOB] = { 1 }, other[MSG_JOB] = { 2 };

    job_reuse = one;
    load_job();
    ck_assert_uint_eq(f.spawns, 1);
    cut();
    tick(1000);
    connect();
    start_job();
    ck_assert_uint_eq(f.spawns, 1); /* the same */
    cut();
    tick(1000);
    connect();
    job_reuse = other;
    start_job();
    ck_assert_uint_eq(f.spawns, 2);
    job_reuse = NULL;
}

static void
start_job_after_a_cut(void)
{
    cut();
    tick(1000);
    connect();
    clear();
    start_job();
}

/* The job was deleted while the worker was not connected, and its id given to
 * another job, as radsubmit --job can. */
TEST(another_job_of_the_same_id_begins_anew)
{
    static const uint8_t other[MSG_HASH] = { 2 };

    load_job();
    unit(3);
    rows(3, 0);
    job_files = other;
    start_job_after_a_cut();
    job_files = hash;
    ck_assert_uint_eq(f.kills, 1);
    ck_assert_uint_eq(f.spawns, 2);
    ck_assert_int_eq(said(f.coord, MSG_RESULT), 0);
    ck_assert_int_eq(said(f.coord, MSG_STILL), 0);
    ck_assert_int_eq(said(f.coord, MSG_READY), 0);
    job_seed = 7;
    start_job_after_a_cut();
    job_seed = 0;
    ck_assert_uint_eq(f.spawns, 3);
}

TEST(a_job_of_another_priority_goes_on)
{
    load_job();
    job_priority = 5;
    start_job_after_a_cut();
    job_priority = 0;
    ck_assert_uint_eq(f.spawns, 1);
    ck_assert_int_eq(said(f.coord, MSG_READY), 1);
}

TEST(a_parked_unit_is_no_suspect)
{
    struct msg m = { .type = MSG_PARKED, .parked = { job_id, 0, 1 } };

    load_job();
    for (uint32_t u = 0; u < 4; u++)
        unit(u);
    hear(f.child, &m);
    child_crashes();
    ck_assert_uint_eq(f.last.lost.nunits, 2);
    ck_assert_uint_eq(f.last.lost.units[0], 1);
    ck_assert_uint_eq(f.last.lost.units[1], 2);
}

TEST(a_unit_that_was_parked_and_is_resumed_is_a_suspect)
{
    struct msg parked = { .type = MSG_PARKED, .parked = { job_id, 0, 1 } };
    struct msg resumed = { .type = MSG_RESUMED, .resumed = { job_id, 1, 1 } };

    load_job();
    for (uint32_t u = 0; u < 3; u++) {
        unit(u);
        parked.parked.unit = u;
        hear(f.child, &parked);
    }
    hear(f.child, &resumed);
    ck_assert_int_eq(said(f.coord, MSG_RESUMED), 0);
    child_crashes();
    ck_assert_uint_eq(f.last.lost.nunits, 1);
    ck_assert_uint_eq(f.last.lost.units[0], 1);
}
