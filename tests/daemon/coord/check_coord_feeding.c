/* check_coord_feeding.c - which worker feeds which with records of tiles */
#include "config.h"

#include "coord_passes_fixture.h"

#include "desk/feeding.h"

FIXTURE(set_up, tear_down)

/* A first worker, and a second that it may dial. */
static void
two_are_ready(void)
{
    struct job *job;

    start_passes(&wide);
    join(SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    job = desk_find_job(f.c, job_a);
    strcpy(job->parts[0].worker->address, "tcp 127.0.0.1:1");
    ready(SECOND, job_a);
}

/* What is made goes to a worker at once, and to others by way of that one; when
 * the pass is closed those that lack it get it. */
TEST(records_travel_while_tiles_are_made)
{
    const struct msg_frozen *z = &f.last[SECOND].frozen;
    const struct job_part *part;

    two_are_ready();
    part = desk_find_job(f.c, job_a)->parts;
    ck_assert_uint_eq(part[0].feeder, 0);
    ck_assert_uint_eq(part[1].feeder, 1);
    ck_assert_int_eq(f.last[WORKER].type, MSG_FEED);
    ck_assert(f.last[WORKER].feed.n == 1 &&
              strcmp(f.last[WORKER].feed.name[0], "ws2") == 0);
    f.last[SECOND].type = 0;
    make(WORKER, 0, 1, 2);
    ck_assert_int_eq(f.last[WORKER].type, MSG_TILE_RECORDS);
    ck_assert(f.last[WORKER].tile_records.tile == 1 &&
              f.last[WORKER].tile_records.count == 2);
    ck_assert_int_eq(f.last[SECOND].type, 0);
    make(WORKER, 0, 0, 0);
    ck_assert(part[0].passes == 1 && part[1].passes == 1);
    ck_assert(has_tile(WORKER)); /* without a word */
    say(SECOND, &(struct msg){ .type = MSG_HOLDS, .holds = { job_a, 0, 0 } });
    ck_assert(f.last[SECOND].type == MSG_FROZEN && z->count == 2);
    f.last[SECOND].type = 0;
    for (uint32_t pass = 0; pass < 2; pass++)
        say(SECOND,
            &(struct msg){ .type = MSG_HOLDS, .holds = { job_a, pass, 0 } });
    ck_assert_int_eq(f.last[SECOND].type, 0); /* sent, and not closed */
}

/* Of five the coordinator feeds the first, that one two, and so on.  When the
 * first hangs the coordinator feeds the second, and a worker below the second
 * feeds the third and, in case it does not hang, the first. */
TEST(workers_below_one_that_hangs_are_fed_by_others)
{
    static const uint32_t before[] = { 0, 1, 1, 2, 2 },
                          after[] = { 4, 0, 4, 2, 2 };
    static const char *const name[] = { "ws2", "ws3", "ws4", "ws5" };
    struct job_part *part;

    submit_passes(ANA, &wide, 1);
    for (uint64_t i = 0; i < N_ELEM(name); i++)
        join(SECOND + i, MSG_ROLE_WORKER, name[i], "daemon");
    for (struct coord_worker *w = f.c->workers; w; w = w->next)
        strcpy(w->address, "tcp 127.0.0.1:1");
    for (uint64_t i = 0; i < N_ELEM(before); i++)
        ready(i > 0 ? SECOND + i - 1 : WORKER, job_a);
    part = desk_find_job(f.c, job_a)->parts;
    for (uint32_t i = 0; i < N_ELEM(before); i++)
        ck_assert_uint_eq(part[i].feeder, before[i]);
    make(SECOND, 0, 0, 2);
    make(SECOND, 0, 1, 2);
    for (uint64_t i = 0; i < N_ELEM(name); i++)
        say(SECOND + i,
            &(struct msg){ .type = MSG_HOLDS, .holds = { job_a, 0, 0 } });
    for (uint32_t i = 0; i < N_ELEM(before); i++)
        ck_assert_uint_eq(part[i].feeder, before[i]);
    make_pass(SECOND, 1);
    for (uint32_t i = 0; i < N_ELEM(after); i++)
        ck_assert_uint_eq(part[i].feeder, after[i]);
}

/* Workers that can all be dialled, one and n more, become ready one after the
 * other. */
static struct job *
begin_with(uint64_t n)
{
    start_passes(&wide);
    for (uint64_t i = 0; i < n; i++) {
        char name[] = { 'x', (char)('0' + i), '\0' };

        join(SECOND + i, MSG_ROLE_WORKER, name, "daemon");
        for (struct coord_worker *w = f.c->workers; w; w = w->next)
            strcpy(w->address, "tcp 127.0.0.1:1");
        ready(SECOND + i, job_a);
    }
    return desk_find_job(f.c, job_a);
}

/* A worker that got another feeder lacks what passed its former one, in all
 * passes that were open then: its new one did not fail. */
TEST(a_new_feeder_does_not_fail_at_once)
{
    struct job_part *part;
    struct job *job;

    job = begin_with(3);
    part = job->parts;
    ck_assert(part[3].feeder == 2 && part[1].feeder == 1);
    feeding_lacked(job, 3);
    feeding_mend(f.c, job);
    ck_assert(part[3].feeder == 3 && part[1].failures == 1);
    for (int pass = 0; pass < MSG_OPEN_PASSES; pass++) {
        feeding_lacked(job, 3);
        feeding_mend(f.c, job);
        ck_assert(part[3].feeder == 3 && part[2].failures == 0);
    }
    feeding_lacked(job, 3);
    feeding_mend(f.c, job);
    ck_assert_uint_eq(part[2].failures, 1);
    carry_out();
}

/* Records come late now and then, by any of them. */
TEST(the_coordinator_does_not_come_to_feed_all)
{
    struct job *job;
    uint64_t random = 1;

    job = begin_with(9);
    for (int k = 0; k < 1000; k++) {
        uint32_t direct = 0;

        random = random * 6364136223846793005u + 1442695040888963407u;
        feeding_lacked(job, (uint32_t)(random >> 33) % job->nparts);
        feeding_mend(f.c, job);
        for (uint32_t i = 0; i < job->nparts; i++)
            direct += feeding_is_direct(job, i);
        ck_assert_msg(direct <= 1, "%u after %d", direct, k);
    }
    carry_out();
}

/* A link that neither end can dial never comes about. */
TEST(workers_without_an_address_are_not_fed_by_each_other)
{
    const struct job_part *part;

    start_passes(&wide);
    for (uint64_t i = 0; i < 2; i++) {
        join(SECOND + i, MSG_ROLE_WORKER, i > 0 ? "ws3" : "ws2", "daemon");
        ready(SECOND + i, job_a);
    }
    part = desk_find_job(f.c, job_a)->parts;
    for (uint32_t i = 0; i < 3; i++)
        ck_assert_uint_eq(part[i].feeder, 0);
}

/* Whoever a worker fed gets another place when that one is gone. */
TEST(workers_that_were_fed_are_fed_by_others)
{
    const struct job *job;

    two_are_ready();
    job = desk_find_job(f.c, job_a);
    ck_assert_uint_eq(job->parts[1].feeder, 1);
    f.now_ms++;
    cut(WORKER);
    ck_assert_uint_eq(job->parts[1].feeder, 0);
    join(WORKER, MSG_ROLE_WORKER, "ws1", "daemon");
    strcpy(job->parts[0].worker->address, "tcp 127.0.0.1:1");
    ready(WORKER, job_a);
    ck_assert_uint_eq(job->parts[0].feeder, 2);
}

/* Nobody knows whether a worker is there that has a tile which another made:
 * it gets nothing before it has said that it has the pass. */
TEST(a_worker_that_was_too_slow_has_to_say_what_it_has)
{
    two_are_ready();
    wait_s(1);
    make(SECOND, 0, 0, 1);
    make(SECOND, 0, 1, 1);
    ck_assert(has_tile(SECOND));
    ck_assert_int_eq(f.last[WORKER].type, MSG_CLOSED);
    ck_assert(f.last[WORKER].closed.asks);
    say(WORKER, &(struct msg){ .type = MSG_HOLDS, .holds = { job_a, 1, 1 } });
    ck_assert_int_eq(f.last[WORKER].type, MSG_CLOSED); /* of no such pass */
    hold(true);
    ck_assert(has_tile(WORKER));
}
