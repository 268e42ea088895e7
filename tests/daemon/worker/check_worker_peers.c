/* check_worker_peers.c - a worker and other workers: links, ambient records,
 * records of tiles */
#include "config.h"

#include "proto/ambshare.h"
#include "ground/lossy.h"
#include "machine/rowsum.h"
#include "worker_fixture.h"
#include "worker/state.h"

#include <sysexits.h>

FIXTURE(set_up, tear_down)

static void
child_records(void)
{
    struct msg m = { .type = MSG_AMBIENT, .ambient = { 1, token, 9 } };

    hear(f.child, &m);
}

TEST(records_go_to_peers_and_from_peers_to_the_child)
{
    struct msg m = { .type = MSG_AMBIENT, .ambient = { 1, token, 9 } };

    load_job();
    introduce(MSG_PEER_DIAL);
    ck_assert_uint_ne(f.peer, 0);
    child_records(); /* not linked yet: lost */
    ck_assert_int_eq(said(f.peer, MSG_AMBIENT), 0);
    peer_opened();
    ck_assert_int_eq(said(f.peer, MSG_PEER_HELLO), 1);
    child_records();
    ck_assert_int_eq(said(f.peer, MSG_AMBIENT), 1);
    hear(f.peer, &m);
    ck_assert_int_eq(said(f.child, MSG_AMBIENT), 1);
}

/* To the peers, too, where they are shared. */
static void
keep_records(uint32_t flags, int to_peer)
{
    job_flags = flags;
    start_job();
    job_flags = MSG_JOB_SHARE;
    child_ready();
    introduce(MSG_PEER_DIAL);
    peer_opened();
    child_records();
    ck_assert_int_eq(said(f.coord, MSG_RECORDS), 1);
    ck_assert_int_eq(said(f.peer, MSG_AMBIENT), to_peer);
}

TEST(records_that_radsubmit_wants_go_to_the_coordinator)
{
    keep_records(MSG_JOB_RECORDS | MSG_JOB_SHARE, 1);
}

TEST(records_that_are_not_shared_go_nowhere_else)
{
    keep_records(MSG_JOB_RECORDS, 0);
}

TEST(records_that_nobody_wants_stay)
{
    load_job();
    child_records();
    ck_assert_int_eq(said(f.coord, MSG_RECORDS), 0);
}

static bool
is_token(void *arg, const uint8_t job[MSG_JOB], const uint8_t its[MSG_TOKEN])
{
    (void)arg;
    return memcmp(job, job_id, MSG_JOB) == 0 &&
           memcmp(its, token, MSG_TOKEN) == 0;
}

static bool
is_none(void *arg, const uint8_t job[MSG_JOB], const uint8_t its[MSG_TOKEN])
{
    (void)arg;
    (void)job;
    (void)its;
    return false;
}

/* Only while the peer is expected, and not after the job. */
TEST(a_peers_key_is_forgotten)
{
    struct msg end = { .type = MSG_JOB_END, .job_end = { job_id } };

    load_job();
    ck_assert(!worker_peer_token(f.w, is_token, NULL));
    introduce(MSG_PEER_DIAL); /* ours is to dial: nobody may come with it */
    ck_assert(!worker_peer_token(f.w, is_token, NULL));
    introduce(0);
    ck_assert(worker_peer_token(f.w, is_token, NULL));
    ck_assert(!worker_peer_token(f.w, is_none, NULL));
    hear(f.coord, &end);
    ck_assert(!worker_peer_token(f.w, is_token, NULL));
}

TEST(a_peer_that_is_no_longer_welcome_is_let_go)
{
    load_job();
    introduce(MSG_PEER_DIAL);
    peer_opened();
    child_records();
    ck_assert_int_eq(said(f.peer, MSG_AMBIENT), 1);
    introduce(MSG_PEER_DROP);
    child_records();
    ck_assert_int_eq(said(f.peer, MSG_AMBIENT), 1);
    introduce(MSG_PEER_DROP); /* and again: there is none */
}

/* It may have been retired before the coordinator was started anew. */
TEST(a_peer_that_another_life_of_the_coordinator_does_not_name_is_let_go)
{
    struct msg m = { .type = MSG_WELCOME,
                     .welcome = { MSG_VERSION, 1, "radcoord" } };

    connect();
    load_job();
    introduce(MSG_PEER_DIAL);
    peer_opened();
    for (m.welcome.epoch = 1; m.welcome.epoch < 3; m.welcome.epoch++) {
        cut();
        tick(1000);
        worker_opened(f.w, f.now_ms, f.coord);
        hear(f.coord, &m);
        start_job();
        child_records();
        ck_assert_int_eq(said(f.peer, MSG_AMBIENT), 1);
    }
    introduce(MSG_PEER_DIAL);
    worker_opened(f.w, f.now_ms, f.peer);
    child_records();
    ck_assert_int_eq(said(f.peer, MSG_AMBIENT), 1);
}

static void
peer_says_hello(uint64_t conn, const uint8_t *its_token)
{
    struct msg m = { .type = MSG_PEER_HELLO,
                     .peer_hello = { job_id, "ws2", its_token } };

    worker_accepted(f.w, f.now_ms, conn);
    hear(conn, &m);
}

TEST(a_peer_is_let_in_by_its_token_alone)
{
    static const uint8_t wrong[MSG_TOKEN] = { 4 };

    load_job();
    introduce(0);
    peer_says_hello(7, wrong);
    child_records();
    ck_assert_int_eq(said(7, MSG_AMBIENT), 0);
    peer_says_hello(8, token);
    child_records();
    ck_assert_int_eq(said(8, MSG_AMBIENT), 1);
    ck_assert_int_eq(said(7, MSG_AMBIENT), 0);
}

TEST(a_peer_may_call_before_the_coordinator_named_it)
{
    load_job();
    peer_says_hello(8, token);
    introduce(0);
    child_records();
    ck_assert_int_eq(said(8, MSG_AMBIENT), 1);
}

/* By the same token, as long as it is not to have been forgotten. */
TEST(a_peer_whose_link_broke_is_let_in_again)
{
    load_job();
    introduce(0);
    peer_says_hello(7, token);
    worker_closed(f.w, f.now_ms, 7, "cut");
    carry_out();
    clear();
    child_records();
    ck_assert_int_eq(f.nsaid, 0);
    peer_says_hello(8, token);
    child_records();
    ck_assert_int_eq(said(8, MSG_AMBIENT), 1);
}

TEST(a_link_that_breaks_is_dialled_again_as_long_as_the_job_lasts)
{
    struct msg end = { .type = MSG_JOB_END, .job_end = { job_id } };
    unsigned dials;

    load_job();
    dials = f.dials;
    introduce(MSG_PEER_DIAL);
    for (int i = 0; i < 20; i++) {
        clear();
        peer_opened();
        child_records();
        ck_assert_int_eq(said(f.peer, MSG_AMBIENT), 1);
        worker_closed(f.w, f.now_ms, f.peer, "cut");
        carry_out();
        tick(30000);
        ck_assert_uint_eq(f.dials - dials, (unsigned)i + 2);
    }
    worker_closed(f.w, f.now_ms, f.peer, "cut");
    hear(f.coord, &end);
    tick(60000);
    ck_assert_uint_eq(f.dials - dials, 21);
}

/* How long after the link was lost, or the dial failed, it dials again [ms]. */
static unsigned
redial_ms(void)
{
    unsigned dials = f.dials, ms = 0;

    worker_closed(f.w, f.now_ms, f.peer, "cut");
    carry_out();
    for (; f.dials == dials; ms += 10)
        tick(10);
    return ms;
}

/* Chance adds nothing, or half.  The log tells it once, after some seconds. */
LOOP_TEST(a_peer_that_is_not_reached_is_dialled_ever_less_often, 2)
{
    static const unsigned ms[] = { 100,  200,   400,   800,   1600, 3200,
                                   6400, 12800, 25600, 30000, 30000 };

    f.chance = _i ? 0xff : 0;
    load_job();
    introduce(MSG_PEER_DIAL);
    for (int i = 0; i < N_ELEM(ms); i++) {
        ck_assert_uint_eq(redial_ms(), ms[i] + (_i ? ms[i] / 2 : 0));
        ck_assert_int_eq(f.warnings, ms[i] >= 3200);
    }
    peer_opened();
    tick(5000); /* soon lost again */
    ck_assert_uint_ge(redial_ms(), 30000);
    peer_opened();
    tick(10000);
    ck_assert_uint_le(redial_ms(), 150);
}

/* A firewall that drops packets lets a dial take ten seconds.  A link that
 * breaks, as at the end of a job, was reached. */
TEST(a_peer_that_never_answers_is_told_at_once)
{
    load_job();
    introduce(MSG_PEER_DIAL);
    for (int i = 0; i < 3; i++) {
        peer_opened();
        tick(5000);
        redial_ms();
        ck_assert_int_eq(f.warnings, 0);
    }
    tick(10000);
    redial_ms();
    ck_assert_int_eq(f.warnings, 1);
    tick(10000);
    redial_ms();
    ck_assert_int_eq(f.warnings, 1);
}

/* As the coordinator says of the pair. */
RANGE_TEST(it_speaks_with_a_peer_what_both_know, MSG_VERSION_MIN,
           MSG_VERSION + 1)
{
    const uint16_t version = (uint16_t)_i;
    struct msg_peer p = { "ws2", "tcp x", token, MSG_PEER_DIAL, version };
    struct msg m = { .type = MSG_JOB_PEERS, .job_peers = { job_id, 1, &p } };

    load_job();
    hear(f.coord, &m);
    peer_opened();
    ck_assert_int_eq(f.session, MSG_AT_PEER);
    ck_assert_uint_eq(f.version, version);
}

TEST(a_slow_peer_loses_the_oldest_records)
{
    static uint8_t data[LOSSY_WINDOW / 2];
    struct lossy_frame *frame_out;
    struct lossy q;
    unsigned n = 0;

    lossy_init(&q);
    for (int i = 0; i < 30; i++) { /* 15 MiB */
        data[0] = (uint8_t)i;
        lossy_put(&q, data, sizeof data);
    }
    ck_assert_uint_eq(q.dropped, 30 - LOSSY_MAX / sizeof data);
    while ((frame_out = lossy_take(&q)) != NULL) {
        ck_assert_uint_eq(frame_out->bytes[0], q.dropped + n++);
        free(frame_out);
    }
    ck_assert_uint_eq(n, 2); /* until they are written */
    lossy_written(&q, sizeof data);
    frame_out = lossy_take(&q);
    ck_assert_ptr_nonnull(frame_out);
    free(frame_out);
    ck_assert_ptr_null(lossy_take(&q));
    lossy_release(&q);
}

/* --- records of tiles --- */

/* A record of a tile: bytes that tell which. */
static void
tile_records(uint64_t conn, uint32_t pass, uint32_t tile)
{
    uint8_t data[AMBSHARE_BYTES];
    struct msg m = { .type = MSG_TILE_RECORDS,
                     .tile_records = { job_id, pass, tile, 1, data,
                                       sizeof data } };

    memset(data, (int)tile, sizeof data);
    hear(conn, &m);
}

/* The pass has one record of each of so many tiles. */
static void
closed(uint32_t pass, uint32_t tiles)
{
    uint8_t data[4 * AMBSHARE_BYTES];
    struct msg m = { .type = MSG_CLOSED,
                     .closed = { job_id, pass, tiles, 0, 1 } };

    for (uint32_t i = 0; i < tiles; i++)
        memset(data + i * AMBSHARE_BYTES, (int)i, AMBSHARE_BYTES);
    m.closed.sum = rowsum_hash(data, tiles * AMBSHARE_BYTES);
    hear(f.coord, &m);
}

static void
begin_passes(void)
{
    connect();
    load_job();
    clear();
}

/* In whatever order they come, those of the next pass among them. */
TEST(the_child_gets_records_in_the_order_of_tiles)
{
    const struct msg_frozen *z = &f.last.frozen;

    begin_passes();
    tile_records(f.coord, 0, 2);
    tile_records(f.coord, 1, 0);
    tile_records(f.coord, 0, 0);
    tile_records(f.coord, 0, 0); /* twice */
    ck_assert_int_eq(f.nsaid, 0);
    closed(0, 3);
    ck_assert_int_eq(f.nsaid, 0);
    tile_records(f.coord, 0, 1);
    ck_assert_int_eq(said(f.coord, MSG_HOLDS), 1);
    ck_assert_int_eq(said(f.child, MSG_FROZEN), 1);
    ck_assert(z->pass == 0 && z->first == 0 && z->last && z->count == 3);
    for (uint32_t i = 0; i < 3; i++)
        ck_assert_uint_eq(z->data[i * AMBSHARE_BYTES], i);
    closed(1, 1);
    ck_assert_int_eq(said(f.child, MSG_FROZEN), 2);
    closed(2, 0); /* a pass without records */
    ck_assert(z->pass == 2 && z->last && z->count == 0);
}

/* After a while without any, and at once when they are others. */
TEST(records_that_are_lacking_are_said_to_be)
{
    struct msg frozen = { .type = MSG_FROZEN,
                          .frozen = { job_id, 0, 0, 1, 1, token, 9 } };

    begin_passes();
    tile_records(f.coord, 0, 1);
    closed(0, 4);
    tick(50);
    tile_records(f.coord, 0, 3);
    clear();
    tick(60);
    ck_assert_int_eq(f.nsaid, 0);
    tick(100);
    ck_assert_int_eq(said(f.coord, MSG_HOLDS), 1);
    ck_assert(f.last.holds.pass == 0 && !f.last.holds.whole);
    hear(f.coord, &frozen);
    ck_assert_int_eq(f.last.type, MSG_FROZEN);
    clear();
    tile_records(f.coord, 1, 1); /* where the sum is of tile 0 */
    closed(1, 1);
    ck_assert_int_eq(said(f.child, MSG_FROZEN), 0);
    ck_assert(f.last.type == MSG_HOLDS && !f.last.holds.whole);
}

/* The coordinator goes on while this worker waits for a pass. */
TEST(passes_that_are_closed_wait_for_one_that_lacks_records)
{
    struct msg frozen = { .type = MSG_FROZEN,
                          .frozen = { job_id, 0, 0, 1, 1, token, 9 } };

    begin_passes();
    tile_records(f.coord, 1, 0);
    for (uint32_t pass = 0; pass <= WJOB_PASSES; pass++)
        closed(pass, pass < 2);
    ck_assert_int_eq(f.nsaid, 0);
    tick(100);
    ck_assert_int_eq(said(f.coord, MSG_HOLDS), 1);
    clear();
    tick(100);
    ck_assert_int_eq(f.nsaid, 0);
    hear(f.coord, &frozen);
    ck_assert_int_eq(said(f.child, MSG_FROZEN), WJOB_PASSES);
    ck_assert_int_eq(said(f.coord, MSG_HOLDS), WJOB_PASSES);
    ck_assert(f.last.holds.pass == WJOB_PASSES && !f.last.holds.whole);
}

TEST(records_for_a_peer_wait_for_the_link_to_it)
{
    struct msg feed = { .type = MSG_FEED, .feed = { job_id, 1, { "ws2" } } };

    begin_passes();
    introduce(MSG_PEER_DIAL);
    hear(f.coord, &feed);
    tile_records(f.coord, 0, 0);
    ck_assert_int_eq(said(f.peer, MSG_TILE_RECORDS), 0);
    peer_opened();
    ck_assert_int_eq(said(f.peer, MSG_PEER_HELLO), 1);
    ck_assert_int_eq(said(f.peer, MSG_TILE_RECORDS), 1);
}

TEST(records_go_on_once_to_peers_that_are_fed)
{
    struct msg feed = { .type = MSG_FEED, .feed = { job_id, 1, { "ws2" } } };

    begin_passes();
    introduce(MSG_PEER_DIAL);
    peer_opened();
    clear();
    tile_records(f.coord, 0, 0);
    ck_assert_int_eq(said(f.peer, MSG_TILE_RECORDS), 0);
    hear(f.coord, &feed);
    tile_records(f.coord, 0, 1);
    tile_records(f.peer, 0, 1);
    tile_records(f.peer, 0, 2); /* it feeds us, too: that goes no further */
    ck_assert_int_eq(said(f.peer, MSG_TILE_RECORDS), 2);
    tile_records(f.coord, WJOB_PASSES, 0); /* of a pass that is far */
    ck_assert_int_eq(said(f.peer, MSG_TILE_RECORDS), 2);
    feed.feed.n = 0;
    hear(f.coord, &feed);
    tile_records(f.coord, 0, 3);
    ck_assert_int_eq(said(f.peer, MSG_TILE_RECORDS), 2);
}

/* A child that is new has no pass: what was gathered for another is of no use.
 */
TEST(a_new_child_begins_with_the_first_pass)
{
    begin_passes();
    tile_records(f.coord, 0, 0);
    closed(0, 1);
    tile_records(f.coord, 1, 0);
    tile_records(f.coord, 2, 0);
    worker_child_ended(f.w, ++f.now_ms, f.child, EX_SOFTWARE, "signal 9");
    carry_out();
    load_job();
    clear();
    closed(1, 1);
    ck_assert_int_eq(f.nsaid, 0);
    closed(0, 1);
    tile_records(f.coord, 0, 0);
    ck_assert_int_eq(said(f.child, MSG_FROZEN), 1);
}
