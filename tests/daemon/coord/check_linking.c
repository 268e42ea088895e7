/* check_linking.c - which workers of a job are named to which */
#include "config.h"

#include "coord_fixture.h"
#include "jobs/job.h"
#include "jobs/part.h"
#include "desk/linking.h"

FIXTURE(set_up, tear_down)

enum {
    FIRST = 20 /* connection of the first worker that comes */
};

/* Work for all. */
static const struct msg_frame large = { 0, 64, 2000, "" };

/* Workers come, each ready for the job; the first of them can be dialled. */
static void
come_of_which(uint32_t n, uint32_t dialled)
{
    for (uint32_t i = 0; i < n; i++) {
        struct coord_peer peer = { "test", "daemon", 30, NULL };
        char name[16];
        struct msg m = { .type = MSG_HELLO,
                         .hello = { MSG_VERSION_MIN, MSG_VERSION,
                                    MSG_ROLE_WORKER, name, "t",
                                    i < dialled ? "host:1" : "", 2, 0 } };

        snprintf(name, sizeof name, "w%u", i);
        coord_opened(f.c, f.now_ms, FIRST + i, &peer);
        say(FIRST + i, &m);
        ready(FIRST + i, job_a);
    }
}

static void
come(uint32_t n)
{
    come_of_which(n, n);
}

static void
begin_job(uint32_t flags)
{
    struct msg m = usual_submit(job_a);

    m.submit.frames = &large;
    m.submit.partition = MSG_PART_STATIC;
    m.submit.flags = flags;
    say(ANA, &m);
}

/* The worker's number in the job. */
static uint32_t
number(const struct job *job, uint32_t i)
{
    char name[16];

    snprintf(name, sizeof name, "w%u", i);
    return part_find(job, name);
}

static void
need(uint32_t a, uint32_t b)
{
    struct job *job = desk_find_job(f.c, job_a);

    linking_need(f.c, job, number(job, a), number(job, b));
    carry_out();
}

/* JOB_PEERS that all workers got. */
static int
named(uint32_t n)
{
    int all = 0;

    for (uint32_t i = 0; i < n; i++)
        all += f.peers[FIRST + i];
    return all;
}

static const struct {
    uint32_t n; /* workers */
    int last;   /* with how many of them the last is linked */
} live[] = { { 2, 1 }, { 64, 63 }, { 65, 64 }, { 200, 199 }, { 270, 256 } };

LOOP_TEST(records_go_to_all_at_once, N_ELEM(live))
{
    begin_job(MSG_JOB_SHARE);
    come(live[_i].n);
    ck_assert_int_eq(f.peers[FIRST + live[_i].n - 1], live[_i].last);
}

/* Two workers of which neither can be dialled take no links from others. */
TEST(a_link_that_cannot_be_ends_no_other)
{
    begin_job(0);
    come_of_which(90, 88);
    for (uint32_t i = 0; i < 16; i++) {
        need(88, 70 + i);
        need(89, 70 + i);
    }
    ck_assert_int_eq(f.peers[FIRST + 88], 16);
    need(88, 89);
    ck_assert_int_eq(f.peers[FIRST + 88], 16);
    ck_assert_int_eq(f.peers[FIRST + 89], 16);
    ck_assert_int_eq(f.peers[FIRST + 70], 2);
}

/* The oldest link makes way for the 17th. */
TEST(those_are_linked_that_need_it)
{
    begin_job(0);
    come(90);
    memset(f.peers, 0, sizeof f.peers);
    for (uint32_t i = 0; i < 16; i++) {
        need(70, 71 + i);
        need(71 + i, 70); /* is there */
    }
    ck_assert_int_eq(f.peers[FIRST + 70], 16);
    ck_assert_int_eq(named(90), 32);
    need(70, 87);
    ck_assert_int_eq(f.peers[FIRST + 70], 16 + 2);
    ck_assert_int_eq(f.peers[FIRST + 71], 2);
    need(71, 70); /* it has gone, so this is new */
    ck_assert_int_eq(f.peers[FIRST + 71], 3);
}

TEST(links_of_a_worker_that_left_are_made_anew)
{
    struct job *job;

    begin_job(0);
    come(80);
    job = desk_find_job(f.c, job_a);
    need(70, 71);
    linking_left(f.c, job, number(job, 71));
    carry_out();
    memset(f.peers, 0, sizeof f.peers);
    need(70, 71);
    ck_assert_int_eq(f.peers[FIRST + 70], 1);
}
