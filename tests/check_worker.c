/* check_worker.c - a worker's side of the protocol, one event at a time */
#include "config.h"

#include "proto/ambshare.h"
#include "proto/frame.h"
#include "ground/lossy.h"
#include "machine/rowsum.h"
#include "unit.h"
#include "worker/worker.h"

#include <string.h>
#include <sysexits.h>

static const struct msg_frame frame = { 0, 8, 8, "" };
static const uint8_t job_id[MSG_JOB] = { 0xaa }, token[MSG_TOKEN] = { 3 };
static const uint8_t hash[MSG_HASH] = { 1 };
static const uint8_t pixels[4 * 2 * 12];

struct fixture {
    struct worker *w;
    uint64_t now_ms;
    bool have;
    uint64_t coord, child, peer; /* connections that it asked for */
    unsigned dials, spawns, kills;
    unsigned warnings; /* in the log, and worse */
    unsigned chunks; /* to be kept */
    bool stopped;
    int status;
    struct {
        uint64_t conn;
        uint16_t type;
    } said[64]; /* since the last clear() */
    int nsaid;
    struct msg last;    /* what was said last */
    uint32_t height[2]; /* by unit, as STILL said last */
    struct wire_out bytes;
    enum msg_session session; /* set last, with the version */
    unsigned version;
};

static struct fixture f;

static bool
has_file(void *arg, const uint8_t *h)
{
    (void)arg;
    (void)h;
    return f.have;
}

static void
no_random(void *arg, void *buf, size_t n)
{
    (void)arg;
    memset(buf, 0, n);
}

static void
sent(const struct action *a)
{
    uint16_t type;

    f.bytes.len = 0;
    wire_put_bytes(&f.bytes, a->bytes, a->len);
    type = (uint16_t)(f.bytes.buf[4] << 8 | f.bytes.buf[5]);
    ck_assert_int_eq(msg_unpack(&f.last, type, 0, f.bytes.buf + MSG_HEADER,
                                f.bytes.len - MSG_HEADER, NULL),
                     0);
    if (type == MSG_STILL && f.last.still.unit < N_ELEM(f.height))
        f.height[f.last.still.unit] = f.last.still.height;
    ck_assert_int_lt(f.nsaid, N_ELEM(f.said));
    f.said[f.nsaid].conn = a->conn;
    f.said[f.nsaid++].type = type;
}

static void
dialled(const struct action *a)
{
    f.dials++;
    if (a->text[0])
        f.peer = a->conn;
    else
        f.coord = a->conn;
}

static void
carry_out(void)
{
    struct action_list *l = worker_actions(f.w);

    for (size_t i = 0; i < l->n; i++) {
        const struct action *a = &l->v[i];

        if (a->type == ACT_SEND)
            sent(a);
        else if (a->type == ACT_DIAL)
            dialled(a);
        else if (a->type == ACT_SPAWN)
            f.child = a->conn, f.spawns++;
        else if (a->type == ACT_KILL)
            f.kills++;
        else if (a->type == ACT_LOG)
            f.warnings += a->level <= ACT_WARN;
        else if (a->type == ACT_PUT_CHUNK)
            f.chunks++;
        else if (a->type == ACT_STOP)
            f.stopped = true, f.status = a->status;
        else if (a->type == ACT_SESSION)
            f.session = a->session, f.version = a->version;
    }
    ck_assert(!l->failed);
    actions_clear(l);
}

static void
clear(void)
{
    f.nsaid = 0;
}

/* How often it said that to a connection since clear(). */
static int
said(uint64_t conn, uint16_t type)
{
    int n = 0;

    for (int i = 0; i < f.nsaid; i++)
        n += f.said[i].conn == conn && f.said[i].type == type;
    return n;
}

static void
hear(uint64_t conn, const struct msg *m)
{
    worker_message(f.w, ++f.now_ms, conn, m);
    carry_out();
}

static void
tick(unsigned ms)
{
    f.now_ms += ms;
    worker_tick(f.w, f.now_ms);
    carry_out();
}

static void
connect(void)
{
    struct msg m = { .type = MSG_WELCOME,
                     .welcome = { MSG_VERSION, 1, "radcoord" } };

    worker_opened(f.w, f.now_ms, f.coord);
    carry_out();
    ck_assert_int_eq(f.last.type, MSG_HELLO);
    ck_assert_int_eq(f.session, MSG_AT_DIALLER);
    hear(f.coord, &m);
    ck_assert_int_eq(f.session, MSG_AT_WORKER);
}

static void
cut(void)
{
    worker_closed(f.w, f.now_ms, f.coord, "cut");
    carry_out();
}

static uint32_t job_flags = MSG_JOB_SHARE;
static const uint8_t *job_reuse;

static void
start_job(void)
{
    struct msg m = { .type = MSG_JOB_START,
                     .job_start = { .job = job_id,
                                    .manifest = hash,
                                    .name = "",
                                    .params = "",
                                    .needs = "",
                                    .estimate = "",
                                    .flags = job_flags,
                                    .files = { 1, hash },
                                    .nframes = 1,
                                    .frames = &frame,
                                    .scene = hash,
                                    .reuse = job_reuse } };

    if (job_reuse)
        m.job_start.flags = MSG_JOB_PASSES | MSG_JOB_SCENE | MSG_JOB_REUSE;
    hear(f.coord, &m);
}

static void
child_ready(void)
{
    struct msg m = { .type = MSG_READY, .ready = { job_id, .5, 7, 2, 0 } };

    hear(f.child, &m);
}

static void
unit(uint32_t number)
{
    struct msg m = { .type = MSG_UNIT,
                     .unit = { job_id, number, 1, 0, 0, 0, 4, .height = 4 } };

    hear(f.coord, &m);
}

/* Two of a unit's four rows. */
static void
rows(uint32_t number, uint32_t row)
{
    struct msg m = { .type = MSG_RESULT,
                     .result = { job_id,
                                 number,
                                 1,
                                 row,
                                 2,
                                 4,
                                 3,
                                 row == 2,
                                 { .rays = 1 },
                                 .pixels = pixels } };

    hear(f.child, &m);
}

static void
ack(uint32_t number, uint32_t row)
{
    struct msg m = { .type = MSG_ACK, .ack = { job_id, number, 1, row, 2 } };

    hear(f.coord, &m);
}

static void
set_up(void)
{
    static const struct worker_env env = { .has_file = has_file,
                                           .random = no_random,
                                           .program = "radd",
                                           .name = "ws1",
                                           .coordinator = "test:7420",
                                           .address = "",
                                           .threads = 2,
                                           .load_s = 100 };

    memset(&f, 0, sizeof f);
    wire_out_init(&f.bytes, MSG_FRAME_MAX);
    f.have = true;
    f.now_ms = 1000;
    f.w = worker_new(&env);
    worker_start(f.w, f.now_ms);
    carry_out();
    connect();
}

static void
tear_down(void)
{
    worker_free(f.w);
    wire_out_release(&f.bytes);
    msg_release(&f.last);
}

START_TEST(it_dials_again_and_waits_longer_each_time)
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
END_TEST

START_TEST(files_that_it_lacks_come_before_the_child)
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
END_TEST

/* It is the disk's affair and not the job's. */
START_TEST(what_finds_no_room_is_told_and_again_when_it_does)
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
END_TEST

/* The store tells of the job's files when nobody can be asked for them. */
START_TEST(what_is_missing_while_the_coordinator_is_away_is_wanted_later)
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
END_TEST

static void
chunk(const uint8_t *of, uint64_t offset)
{
    struct msg m = { .type = MSG_CHUNK,
                     .chunk = { of, offset, 2, (const uint8_t *)"x", 1 } };

    hear(f.coord, &m);
}

START_TEST(only_what_was_asked_for_is_kept)
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
END_TEST

/* The coordinator may have known of its end before it heard of the WANT. */
START_TEST(what_a_job_wanted_that_is_over_is_wanted_again_by_the_next)
{
    struct msg over = { .type = MSG_JOB_END, .job_end = { job_id } };

    f.have = false;
    start_job();
    hear(f.coord, &over);
    clear();
    start_job();
    ck_assert_int_eq(said(f.coord, MSG_WANT), 1);
}
END_TEST

START_TEST(units_go_down_and_results_up)
{
    start_job();
    child_ready();
    ck_assert_int_eq(said(f.coord, MSG_READY), 1);
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
END_TEST

START_TEST(what_was_not_acknowledged_is_sent_again)
{
    start_job();
    child_ready();
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
END_TEST

START_TEST(a_worker_that_may_not_work_leaves_and_comes_back)
{
    struct msg bye = { .type = MSG_BYE, .bye = { "drained" } };
    unsigned dials;

    start_job();
    child_ready();
    unit(0);
    worker_allow(f.w, f.now_ms, false);
    carry_out();
    ck_assert_int_eq(f.last.type, MSG_DRAIN);
    ck_assert_uint_eq(f.kills, 0);
    rows(0, 0);
    rows(0, 2); /* what is begun is finished */
    ck_assert_int_eq(f.last.type, MSG_RESULT);
    hear(f.coord, &bye);
    ck_assert(!f.stopped);
    worker_closed(f.w, f.now_ms, f.coord, "closed");
    carry_out();
    ck_assert_uint_eq(f.warnings, 0);
    ck_assert_uint_eq(f.kills, 1); /* and nothing stays */
    dials = f.dials;
    for (int i = 0; i < 100; i++)
        tick(1000);
    ck_assert_uint_eq(f.dials, dials);
    worker_allow(f.w, f.now_ms, true);
    tick(100);
    ck_assert_uint_eq(f.dials, dials + 1);
    worker_closed(f.w, f.now_ms, f.coord, "refused"); /* and that is one */
    carry_out();
    ck_assert_uint_eq(f.warnings, 1);
}
END_TEST

START_TEST(what_is_kept_is_counted_until_it_is_acknowledged)
{
    struct msg ack = { .type = MSG_ACK, .ack = { job_id, 0, 1, 0, 2 } };
    size_t one;

    start_job();
    child_ready();
    unit(0);
    ck_assert_uint_eq(worker_kept(f.w), 0);
    rows(0, 0);
    one = worker_kept(f.w);
    ck_assert_uint_gt(one, 0);
    rows(0, 2);
    ck_assert_uint_gt(worker_kept(f.w), one);
    hear(f.coord, &ack);
    ck_assert_uint_gt(worker_kept(f.w), 0);
    ack.ack.row = 2;
    hear(f.coord, &ack);
    ck_assert_uint_eq(worker_kept(f.w), 0);
}
END_TEST

START_TEST(a_child_that_is_held_does_not_hang)
{
    start_job();
    child_ready();
    unit(0);
    worker_hold(f.w, true);
    for (int i = 0; i < 1000; i++)
        tick(900);
    ck_assert_uint_eq(f.kills, 0);
    worker_hold(f.w, false);
    for (int i = 0; i < 113; i++)
        tick(900);
    ck_assert_uint_eq(f.kills, 1);
}
END_TEST

START_TEST(rows_wait_for_the_start_after_a_cut)
{
    start_job();
    child_ready();
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
END_TEST

START_TEST(a_lost_child_is_reported_with_its_suspects)
{
    start_job();
    child_ready();
    for (uint32_t u = 0; u < 4; u++)
        unit(u);
    rows(0, 0);
    rows(0, 2);
    worker_child_ended(f.w, f.now_ms, f.child, false, "killed by signal 11");
    carry_out();
    ck_assert_int_eq(f.last.type, MSG_LOST);
    ck_assert_str_eq(f.last.lost.text, "killed by signal 11");
    ck_assert_uint_eq(f.last.lost.nunits, 2); /* as many as threads */
    ck_assert_uint_eq(f.last.lost.units[0], 1);
    ck_assert_uint_eq(f.last.lost.units[1], 2);
    start_job();
    ck_assert_uint_eq(f.spawns, 2);
}
END_TEST

START_TEST(the_end_of_a_job_ends_its_child)
{
    struct msg m = { .type = MSG_JOB_END, .job_end = { job_id } };

    start_job();
    child_ready();
    hear(f.coord, &m);
    ck_assert_uint_eq(f.kills, 1);
    clear();
    child_ready(); /* from beyond the grave */
    hear(f.coord, &m);
    ck_assert_int_eq(f.nsaid, 0);
}
END_TEST

START_TEST(a_child_that_gives_up_is_reported)
{
    struct msg m = { .type = MSG_FAILED, .failed = { job_id, 65, "no light" } };

    start_job();
    hear(f.child, &m);
    ck_assert_int_eq(f.last.type, MSG_FAILED);
    ck_assert_uint_eq(f.last.failed.status, 65);
    ck_assert_uint_eq(f.kills, 1);
}
END_TEST

static const struct {
    int status;
    uint16_t told;     /* to the coordinator */
    uint32_t suspects; /* in a LOST */
} giving_up[] = {
    { EX_DATAERR, MSG_FAILED, 0 }, /* so is the scene everywhere */
    { EX_UNAVAILABLE, MSG_FAILED, 0 },
    { EX_SOFTWARE, MSG_LOST, 1 }, /* a unit that it cannot do */
    { EX_OSERR, MSG_LOST, 0 },    /* no memory, here */
    { EX_IOERR, MSG_LOST, 0 },
    { EX_NOINPUT, MSG_LOST, 0 },
    { EX_NOPERM, MSG_LOST, 0 },
};

START_TEST(what_is_wrong_here_is_not_the_scenes_fault)
{
    struct msg m = { .type = MSG_FAILED,
                     .failed = { job_id, (uint16_t)giving_up[_i].status,
                                 "why" } };

    start_job();
    child_ready();
    unit(0);
    hear(f.child, &m);
    ck_assert_int_eq(f.last.type, giving_up[_i].told);
    ck_assert_uint_eq(f.kills, 1);
    if (f.last.type == MSG_LOST) {
        ck_assert_uint_eq(f.last.lost.nunits, giving_up[_i].suspects);
        ck_assert_str_eq(f.last.lost.text, "why");
    }
}
END_TEST

START_TEST(a_child_killed_from_outside_leaves_no_suspects)
{
    start_job();
    child_ready();
    unit(0);
    worker_child_ended(f.w, f.now_ms, f.child, true, "killed by signal 9");
    carry_out();
    ck_assert_int_eq(f.last.type, MSG_LOST);
    ck_assert_uint_eq(f.last.lost.nunits, 0);
}
END_TEST

/* load_s is 100 */
START_TEST(a_child_that_hangs_is_ended)
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
END_TEST

START_TEST(a_child_without_units_may_be_silent)
{
    start_job();
    child_ready();
    for (int i = 0; i < 1000; i++)
        tick(900);
    ck_assert_uint_eq(f.kills, 0);
}
END_TEST

static void
introduce(uint32_t flags)
{
    struct msg_peer p = { "ws2", flags & MSG_PEER_DIAL ? "tcp x" : "", token,
                          flags, MSG_VERSION };
    struct msg m = { .type = MSG_JOB_PEERS, .job_peers = { job_id, 1, &p } };

    hear(f.coord, &m);
}

static void
child_records(uint32_t to)
{
    struct msg m = { .type = MSG_AMBIENT, .ambient = { to, 1, token, 9 } };

    hear(f.child, &m);
}

START_TEST(records_go_to_peers_and_from_peers_to_the_child)
{
    struct msg m = { .type = MSG_AMBIENT, .ambient = { 0, 1, token, 9 } };

    start_job();
    child_ready();
    introduce(MSG_PEER_DIAL | MSG_PEER_GIVE);
    ck_assert_uint_ne(f.peer, 0);
    child_records(0); /* not linked yet: lost */
    ck_assert_int_eq(said(f.peer, MSG_AMBIENT), 0);
    worker_opened(f.w, f.now_ms, f.peer);
    carry_out();
    ck_assert_int_eq(said(f.peer, MSG_PEER_HELLO), 1);
    ck_assert_int_eq(f.last.type, MSG_GIVE); /* to the child */
    child_records(f.last.give.to);
    child_records(0);
    child_records(99); /* for a peer that is gone */
    ck_assert_int_eq(said(f.peer, MSG_AMBIENT), 2);
    hear(f.peer, &m);
    ck_assert_int_eq(said(f.child, MSG_AMBIENT), 1);
}
END_TEST

/* New ones alone, and to the peers too where they are shared. */
static void
keep_records(uint32_t flags, int to_peer)
{
    job_flags = flags;
    start_job();
    job_flags = MSG_JOB_SHARE;
    child_ready();
    introduce(MSG_PEER_DIAL | MSG_PEER_GIVE);
    worker_opened(f.w, f.now_ms, f.peer);
    carry_out();
    child_records(f.last.give.to); /* what there was */
    ck_assert_int_eq(said(f.coord, MSG_RECORDS), 0);
    child_records(0);
    ck_assert_int_eq(said(f.coord, MSG_RECORDS), 1);
    ck_assert_int_eq(said(f.peer, MSG_AMBIENT), to_peer);
}

START_TEST(records_that_radsubmit_wants_go_to_the_coordinator)
{
    keep_records(MSG_JOB_RECORDS | MSG_JOB_SHARE, 2);
}
END_TEST

START_TEST(records_that_are_not_shared_go_nowhere_else)
{
    keep_records(MSG_JOB_RECORDS, 0);
}
END_TEST

START_TEST(records_that_nobody_wants_stay)
{
    start_job();
    child_ready();
    child_records(0);
    ck_assert_int_eq(said(f.coord, MSG_RECORDS), 0);
}
END_TEST

static bool
is_token(void *arg, const uint8_t job[MSG_JOB], const uint8_t its[MSG_TOKEN])
{
    (void)arg;
    return memcmp(job, job_id, MSG_JOB) == 0 &&
           memcmp(its, token, MSG_TOKEN) == 0;
}

/* Only while the peer is expected, and not after the job. */
START_TEST(a_peers_key_is_forgotten)
{
    struct msg end = { .type = MSG_JOB_END, .job_end = { job_id } };

    start_job();
    child_ready();
    ck_assert(!worker_peer_token(f.w, is_token, NULL));
    introduce(MSG_PEER_DIAL); /* ours is to dial: nobody may come with it */
    ck_assert(!worker_peer_token(f.w, is_token, NULL));
    introduce(0);
    ck_assert(worker_peer_token(f.w, is_token, NULL));
    hear(f.coord, &end);
    ck_assert(!worker_peer_token(f.w, is_token, NULL));
}
END_TEST

START_TEST(a_peer_that_is_no_longer_welcome_is_let_go)
{
    start_job();
    child_ready();
    introduce(MSG_PEER_DIAL);
    worker_opened(f.w, f.now_ms, f.peer);
    carry_out();
    child_records(0);
    ck_assert_int_eq(said(f.peer, MSG_AMBIENT), 1);
    introduce(MSG_PEER_DROP);
    child_records(0);
    ck_assert_int_eq(said(f.peer, MSG_AMBIENT), 1);
    introduce(MSG_PEER_DROP); /* and again: there is none */
}
END_TEST

static void
peer_says_hello(uint64_t conn, const uint8_t *its_token)
{
    struct msg m = { .type = MSG_PEER_HELLO,
                     .peer_hello = { job_id, "ws2", its_token } };

    worker_accepted(f.w, f.now_ms, conn);
    hear(conn, &m);
}

START_TEST(a_peer_is_let_in_by_its_token_alone)
{
    static const uint8_t wrong[MSG_TOKEN] = { 4 };

    start_job();
    child_ready();
    introduce(0);
    peer_says_hello(7, wrong);
    child_records(0);
    ck_assert_int_eq(said(7, MSG_AMBIENT), 0);
    peer_says_hello(8, token);
    child_records(0);
    ck_assert_int_eq(said(8, MSG_AMBIENT), 1);
    ck_assert_int_eq(said(7, MSG_AMBIENT), 0);
}
END_TEST

START_TEST(a_peer_may_call_before_the_coordinator_named_it)
{
    start_job();
    child_ready();
    peer_says_hello(8, token);
    introduce(0);
    child_records(0);
    ck_assert_int_eq(said(8, MSG_AMBIENT), 1);
}
END_TEST

START_TEST(a_refusal_ends_it_with_the_status)
{
    struct msg m = { .type = MSG_REFUSE, .refuse = { 76, "version" } };

    cut();
    tick(500);
    worker_opened(f.w, f.now_ms, f.coord);
    hear(f.coord, &m);
    ck_assert(f.stopped);
    ck_assert_int_eq(f.status, 76);
}
END_TEST

START_TEST(it_speaks_as_it_is_welcomed)
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
END_TEST

/* As the coordinator says of the pair. */
START_TEST(it_speaks_with_a_peer_what_both_know)
{
    const uint16_t version = (uint16_t)_i;
    struct msg_peer p = { "ws2", "tcp x", token, MSG_PEER_DIAL, version };
    struct msg m = { .type = MSG_JOB_PEERS, .job_peers = { job_id, 1, &p } };

    start_job();
    child_ready();
    hear(f.coord, &m);
    worker_opened(f.w, f.now_ms, f.peer);
    carry_out();
    ck_assert_int_eq(f.session, MSG_AT_PEER);
    ck_assert_uint_eq(f.version, version);
}
END_TEST

static const uint16_t strange[] = { 0, MSG_VERSION + 1, 9 };

START_TEST(it_ends_when_welcomed_in_another_version)
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
END_TEST

/* The coordinator is lost when two pieces of a job's rows are on their way. */
static void
cut_with_rows(void)
{
    start_job();
    child_ready();
    unit(3);
    rows(3, 0);
    rows(3, 2);
    cut();
    tick(500);
}

START_TEST(results_come_again_in_another_life_of_the_coordinator)
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
END_TEST

START_TEST(it_leaves_when_the_coordinator_lets_it_go)
{
    struct msg m = { .type = MSG_BYE, .bye = { "drained" } };

    worker_drain(f.w, f.now_ms);
    carry_out();
    ck_assert_int_eq(f.last.type, MSG_DRAIN);
    ck_assert(!f.stopped);
    hear(f.coord, &m);
    ck_assert(f.stopped);
    ck_assert_int_eq(f.status, 0);
    worker_closed(f.w, f.now_ms, f.coord, "closed");
    carry_out();
    ck_assert_uint_eq(f.warnings, 0);
}
END_TEST

START_TEST(a_slow_peer_loses_the_oldest_records)
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
END_TEST

/* --- what workers share --- */

static const uint8_t line_bytes[8 * 12] = { 0x3f, 0x80 };
static const uint8_t density[4] = { 3, 0, 1, 2 };

/* A piece of base line 1 of the job's picture, 8 columns wide. */
static struct msg
piece(uint32_t x, uint32_t n, uint32_t first, uint32_t ndensity)
{
    return (struct msg){ .type = MSG_BASE_LINE,
                         .base_line = { job_id, 0, 1, x, n, first, ndensity, 3,
                                        density, line_bytes } };
}

static void
made(uint32_t x, uint32_t n, uint32_t first, uint32_t ndensity)
{
    struct msg m = piece(x, n, first, ndensity);

    hear(f.child, &m);
}

static void
next_holder(const char *name)
{
    struct msg m = { .type = MSG_NEXT_HOLDER,
                     .next_holder = { job_id, 0, 1, name } };

    hear(f.coord, &m);
}

static void
link_peer(void)
{
    introduce(MSG_PEER_DIAL);
    worker_opened(f.w, f.now_ms, f.peer);
    carry_out();
}

START_TEST(a_base_line_goes_to_whom_waits_and_to_the_coordinator)
{
    start_job();
    child_ready();
    link_peer();
    next_holder("ws2");
    made(0, 5, 0, 2);
    ck_assert_int_eq(said(f.coord, MSG_BASE_LINE), 1);
    ck_assert_int_eq(said(f.peer, MSG_BASE_LINE), 1);
    made(5, 3, 2, 2);
    ck_assert_int_eq(said(f.peer, MSG_BASE_LINE), 2);
    ck_assert_uint_eq(f.last.base_line.x, 5);
    ck_assert_uint_eq(f.last.base_line.first, 2);
    next_holder("ws2"); /* has all of it */
    next_holder("ws9"); /* no link to that */
    next_holder("");
    ck_assert_int_eq(said(f.peer, MSG_BASE_LINE), 2);
    hear(f.child, &(struct msg){ .type = MSG_TALLY, .tally.job = job_id });
    ck_assert_int_eq(said(f.coord, MSG_TALLY), 1);
    /* each piece twice: frame, fields, a float for each colour, densities */
    ck_assert_uint_eq(f.last.tally.base_line_bytes,
                      2 * (2 * (MSG_HEADER + 41) + 8 * 12 + 4));
    ck_assert_uint_eq(f.last.tally.base_line_pixels, 8);
}
END_TEST

START_TEST(a_base_line_that_is_made_goes_to_one_named_late_or_linked_late)
{
    start_job();
    child_ready();
    made(0, 5, 0, 2);
    made(0, 5, 0, 2); /* once more: the same values */
    made(7, 1, 4, 0); /* with a gap before it: not of use */
    made(5, 2, 2, 1);
    next_holder("ws2");
    ck_assert_int_eq(said(f.coord, MSG_BASE_LINE), 4);
    clear();
    link_peer();
    ck_assert_int_eq(said(f.peer, MSG_BASE_LINE), 1);
    ck_assert_uint_eq(f.last.base_line.n, 7);
    ck_assert_uint_eq(f.last.base_line.ndensity, 3);
    ck_assert_mem_eq(f.last.base_line.density, "\3\0\3", 3);
    made(7, 1, 3, 1);
    ck_assert_int_eq(said(f.peer, MSG_BASE_LINE), 2);
    ck_assert_uint_eq(f.last.base_line.x, 7);
}
END_TEST

START_TEST(a_base_line_from_a_peer_goes_to_the_child_if_it_fits)
{
    struct msg m = piece(0, 8, 0, 4);

    start_job();
    child_ready();
    link_peer();
    hear(f.peer, &m);
    ck_assert_int_eq(said(f.child, MSG_BASE_LINE), 1);
    m.base_line.x = 1; /* to column 9 of 8 */
    hear(f.peer, &m);
    ck_assert_int_eq(said(f.child, MSG_BASE_LINE), 1);
    ck_assert_int_eq(f.session, MSG_NSESSION); /* closed */
    m.base_line.x = 0;
    hear(f.peer, &m);
    ck_assert_int_eq(said(f.child, MSG_BASE_LINE), 1);
    hear(f.coord, &m); /* the coordinator has it, too */
    ck_assert_int_eq(said(f.child, MSG_BASE_LINE), 2);
}
END_TEST

START_TEST(base_lines_are_repeated_before_rows_that_were_not_acknowledged)
{
    start_job();
    child_ready();
    made(0, 8, 0, 4);
    unit(0);
    rows(0, 0);
    rows(0, 2);
    cut();
    made(0, 8, 0, 4); /* nobody hears it */
    clear();
    tick(500);
    connect();
    start_job();
    ck_assert_int_eq(said(f.coord, MSG_BASE_LINE), 1);
    ck_assert_int_eq(f.said[f.nsaid - 4].type, MSG_BASE_LINE);
    ck_assert_int_eq(f.said[f.nsaid - 3].type, MSG_RESULT);
    ack(0, 0);
    ack(0, 2);
    ack(1, 0);
    cut();
    clear();
    tick(1000);
    connect();
    start_job();
    ck_assert_int_eq(said(f.coord, MSG_BASE_LINE), 0);
}
END_TEST

/* Down only what is about a unit that the child has, up all of it. */
START_TEST(what_workers_share_passes_through)
{
    static const uint8_t bitmap[1] = { 1 };
    static const struct msg_area area = { 0, 0, 0, 8, 8 };
    static const struct msg_cost cost = { 3, 4 };
    const struct msg down[] = {
        { .type = MSG_SPLIT, .split = { job_id, 3, 1 } },
        { .type = MSG_TWIN, .twin = { job_id, 3, 1 } },
        { .type = MSG_LEND, .lend = { job_id, 3, 1, 9 } },
        { .type = MSG_BACK, .back = { job_id, 3, 1, 1, 0, 6 } },
        { .type = MSG_FACTS,
          .facts = { job_id, 0, 1, 0, 1, 8, 0, 3, bitmap, .pixels = line_bytes } },
        { .type = MSG_ESTIMATE, .estimate = { job_id, 1, 5, 1, &area } },
        { .type = MSG_SEED, .seed = { job_id, 0, 5 } },
    };
    const struct msg up[] = {
        { .type = MSG_PARKED, .parked = { job_id, 3, 1 } },
        { .type = MSG_GAVE, .gave = { job_id, 3, 1, 2 } },
        { .type = MSG_LOAN,
          .loan = { job_id, 3, 1, 0, 1, 0, 6, 1, 2, 0, 3, 0, density, bitmap,
                    line_bytes, line_bytes } },
        { .type = MSG_FACTS,
          .facts = { job_id, 0, 1, 0, 1, 8, 0, 3, bitmap, .pixels = line_bytes } },
        { .type = MSG_ESTIMATED,
          .estimated = { job_id, 1, 1, &cost, { .rays = 9 } } },
    };

    start_job();
    child_ready();
    for (int i = 0; i < 4; i++) { /* nothing about unit 3 */
        hear(f.coord, &down[i]);
        ck_assert_int_eq(said(f.child, down[i].type), 0);
    }
    for (int i = 0; i < 3; i++) {
        hear(f.child, &up[i]);
        ck_assert_int_eq(said(f.coord, up[i].type), 0);
    }
    unit(3);
    for (int i = 0; i < N_ELEM(down); i++) {
        hear(f.coord, &down[i]);
        ck_assert_int_eq(said(f.child, down[i].type), 1);
    }
    for (int i = 0; i < N_ELEM(up); i++) {
        hear(f.child, &up[i]);
        ck_assert_int_eq(said(f.coord, up[i].type), 1);
    }
}
END_TEST

/* Columns that another lends are with the child until it says PAID; again after
 * that, it may not have heard yet that they were taken back. */
START_TEST(what_is_lent_is_a_unit_until_it_is_done)
{
    static const uint8_t bitmap[1] = { 1 };
    struct msg loan = { .type = MSG_LOAN,
                        .loan = { job_id, 3, 2, 0, 1, 0, 6, 1, 2, 0, 3, 0,
                                  density, bitmap, line_bytes, line_bytes } };
    const struct msg paid = { .type = MSG_PAID,
                              .paid = { job_id, 3, 2, { .rays = 9 } } };

    start_job();
    child_ready();
    loan.loan.channels = 4; /* not this job's */
    hear(f.coord, &loan);
    ck_assert_int_eq(said(f.child, MSG_LOAN), 0);
    loan.loan.channels = 3;
    hear(f.coord, &loan);
    hear(f.coord, &loan); /* it has it */
    ck_assert_int_eq(said(f.child, MSG_LOAN), 1);
    hear(f.child, &paid);
    ck_assert_int_eq(said(f.coord, MSG_PAID), 1);
    ck_assert_uint_eq(f.last.paid.counts.rays, 9);
    hear(f.child, &paid);
    ck_assert_int_eq(said(f.coord, MSG_PAID), 2);
    worker_child_ended(f.w, f.now_ms, f.child, false, "killed by signal 11");
    carry_out();
    ck_assert_uint_eq(f.last.lost.nunits, 0);
}
END_TEST

/* Its child would wait for ever. */
static struct msg_tally
tally_said(void)
{
    ck_assert_int_eq(f.last.type, MSG_TALLY);
    return f.last.tally;
}

/* What a loan cost is said once; in sum again, if it may not have come. */
START_TEST(what_loans_cost_is_not_lost_with_a_connection)
{
    const struct msg paid = { .type = MSG_PAID,
                              .paid = { job_id, 3, 2, { .rays = 9 } } };
    const struct msg tally = {
        .type = MSG_TALLY,
        .tally = { .job = job_id, .busy_s = 1, .dropped = { .rays = 2 } }
    };
    struct msg_tally t;

    start_job();
    child_ready();
    hear(f.child, &paid);
    ck_assert_int_eq(said(f.coord, MSG_TALLY), 1); /* the child's sums begin */
    ck_assert_int_eq(said(f.coord, MSG_PAID), 1);
    hear(f.child, &tally);
    t = tally_said();
    ck_assert_uint_eq(t.paid.rays, 9);
    ck_assert_uint_eq(t.dropped.rays, 2);
    cut();
    hear(f.child, &paid); /* there is nobody to tell */
    tick(500);
    connect();
    t = tally_said();
    ck_assert_uint_eq(t.paid.rays, 9);
    ck_assert_uint_eq(t.dropped.rays, 11);
    worker_child_ended(f.w, f.now_ms, f.child, false, "killed by signal 11");
    carry_out();
    start_job(); /* again: of a new child */
    child_ready();
    hear(f.child, &tally);
    t = tally_said();
    ck_assert_uint_eq(t.paid.rays, 0);
    ck_assert_uint_eq(t.dropped.rays, 2);
}
END_TEST

START_TEST(what_it_lends_comes_back_when_the_coordinator_is_gone)
{
    static const uint8_t bitmap[1] = { 1 };
    const struct msg loan = { .type = MSG_LOAN,
                              .loan = { job_id, 3, 1, 0, 5, 0, 6, 1, 2, 0, 3, 0,
                                        density, bitmap, line_bytes,
                                        line_bytes } };

    start_job();
    child_ready();
    unit(2);
    unit(3);
    hear(f.child, &loan);
    ck_assert_int_eq(said(f.coord, MSG_LOAN), 1);
    ck_assert_int_eq(said(f.child, MSG_BACK), 0);
    cut();
    ck_assert_int_eq(said(f.child, MSG_BACK), 1);
    ck_assert(f.last.back.unit == 3 && f.last.back.attempt == 1);
    ck_assert(f.last.back.line == 5 && f.last.back.n == 0);
    hear(f.child, &loan); /* asked for before */
    ck_assert_int_eq(said(f.child, MSG_BACK), 2);
}
END_TEST

/* Nothing is given up but columns that another worker lends. */
START_TEST(units_go_on_when_the_coordinator_is_back)
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

    start_job();
    child_ready();
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
END_TEST

/* The coordinator died before it had kept the job, and another job's cache is
 * the last one that fits by now. */
START_TEST(a_job_that_begins_with_another_cache_begins_anew)
{
    static const uint8_t one[MSG_JOB] = { 1 }, other[MSG_JOB] = { 2 };

    job_reuse = one;
    start_job();
    child_ready();
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
END_TEST

START_TEST(a_parked_unit_is_no_suspect)
{
    struct msg m = { .type = MSG_PARKED, .parked = { job_id, 0, 1 } };

    start_job();
    child_ready();
    for (uint32_t u = 0; u < 4; u++)
        unit(u);
    hear(f.child, &m);
    worker_child_ended(f.w, f.now_ms, f.child, false, "killed by signal 11");
    carry_out();
    ck_assert_uint_eq(f.last.lost.nunits, 2);
    ck_assert_uint_eq(f.last.lost.units[0], 1);
    ck_assert_uint_eq(f.last.lost.units[1], 2);
}
END_TEST

START_TEST(a_unit_that_was_parked_and_is_resumed_is_a_suspect)
{
    struct msg parked = { .type = MSG_PARKED, .parked = { job_id, 0, 1 } };
    struct msg resumed = { .type = MSG_RESUMED, .resumed = { job_id, 1, 1 } };

    start_job();
    child_ready();
    for (uint32_t u = 0; u < 3; u++) {
        unit(u);
        parked.parked.unit = u;
        hear(f.child, &parked);
    }
    hear(f.child, &resumed);
    ck_assert_int_eq(said(f.coord, MSG_RESUMED), 0);
    worker_child_ended(f.w, f.now_ms, f.child, false, "killed by signal 11");
    carry_out();
    ck_assert_uint_eq(f.last.lost.nunits, 1);
    ck_assert_uint_eq(f.last.lost.units[0], 1);
}
END_TEST

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
    struct msg m = { .type = MSG_CLOSED, .closed = { job_id, pass, tiles, 0 } };

    for (uint32_t i = 0; i < tiles; i++)
        memset(data + i * AMBSHARE_BYTES, (int)i, AMBSHARE_BYTES);
    m.closed.sum = rowsum_hash(data, tiles * AMBSHARE_BYTES);
    hear(f.coord, &m);
}

static void
begin_passes(void)
{
    connect();
    start_job();
    child_ready();
    clear();
}

/* In whatever order they come, those of the next pass among them. */
START_TEST(the_child_gets_records_in_the_order_of_tiles)
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
END_TEST

/* After a while without any, and at once when they are others. */
START_TEST(records_that_are_lacking_are_said_to_be)
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
END_TEST

START_TEST(records_go_on_once_to_peers_that_are_fed)
{
    struct msg feed = { .type = MSG_FEED, .feed = { job_id, 1, { "ws2" } } };

    begin_passes();
    introduce(MSG_PEER_DIAL);
    worker_opened(f.w, f.now_ms, f.peer);
    carry_out();
    clear();
    tile_records(f.coord, 0, 0);
    ck_assert_int_eq(said(f.peer, MSG_TILE_RECORDS), 0);
    hear(f.coord, &feed);
    tile_records(f.coord, 0, 1);
    tile_records(f.peer, 0, 1);
    tile_records(f.peer, 0, 2); /* it feeds us, too: that goes no further */
    ck_assert_int_eq(said(f.peer, MSG_TILE_RECORDS), 2);
    tile_records(f.coord, 2, 0); /* of a pass that is far */
    ck_assert_int_eq(said(f.peer, MSG_TILE_RECORDS), 2);
    feed.feed.n = 0;
    hear(f.coord, &feed);
    tile_records(f.coord, 0, 3);
    ck_assert_int_eq(said(f.peer, MSG_TILE_RECORDS), 2);
}
END_TEST

/* A child that is new has no pass: what was gathered for another is of no use.
 */
START_TEST(a_new_child_begins_with_the_first_pass)
{
    begin_passes();
    tile_records(f.coord, 0, 0);
    closed(0, 1);
    tile_records(f.coord, 1, 0);
    tile_records(f.coord, 2, 0);
    worker_child_ended(f.w, ++f.now_ms, f.child, false, "signal 9");
    carry_out();
    start_job();
    child_ready();
    clear();
    closed(1, 1);
    ck_assert_int_eq(f.nsaid, 0);
    closed(0, 1);
    tile_records(f.coord, 0, 0);
    ck_assert_int_eq(said(f.child, MSG_FROZEN), 1);
}
END_TEST

int
main(void)
{
    Suite *s = suite_create("worker");
    TCase *tc = tcase_create("worker");

    tcase_add_checked_fixture(tc, set_up, tear_down);
    tcase_add_test(tc, a_unit_that_was_parked_and_is_resumed_is_a_suspect);
    tcase_add_test(tc, it_dials_again_and_waits_longer_each_time);
    tcase_add_test(tc, files_that_it_lacks_come_before_the_child);
    tcase_add_test(tc, what_finds_no_room_is_told_and_again_when_it_does);
    tcase_add_test(
        tc, what_is_missing_while_the_coordinator_is_away_is_wanted_later);
    tcase_add_test(tc, only_what_was_asked_for_is_kept);
    tcase_add_test(tc,
                   what_a_job_wanted_that_is_over_is_wanted_again_by_the_next);
    tcase_add_test(tc, units_go_down_and_results_up);
    tcase_add_test(tc, what_was_not_acknowledged_is_sent_again);
    tcase_add_test(tc, rows_wait_for_the_start_after_a_cut);
    tcase_add_test(tc, a_worker_that_may_not_work_leaves_and_comes_back);
    tcase_add_test(tc, what_is_kept_is_counted_until_it_is_acknowledged);
    tcase_add_test(tc, a_child_that_is_held_does_not_hang);
    tcase_add_test(tc, a_lost_child_is_reported_with_its_suspects);
    tcase_add_loop_test(tc, what_is_wrong_here_is_not_the_scenes_fault, 0,
                        N_ELEM(giving_up));
    tcase_add_test(tc, a_child_killed_from_outside_leaves_no_suspects);
    tcase_add_test(tc, a_child_that_hangs_is_ended);
    tcase_add_test(tc, a_child_without_units_may_be_silent);
    tcase_add_test(tc, the_end_of_a_job_ends_its_child);
    tcase_add_test(tc, a_child_that_gives_up_is_reported);
    tcase_add_test(tc, records_go_to_peers_and_from_peers_to_the_child);
    tcase_add_test(tc, the_child_gets_records_in_the_order_of_tiles);
    tcase_add_test(tc, records_that_are_lacking_are_said_to_be);
    tcase_add_test(tc, records_go_on_once_to_peers_that_are_fed);
    tcase_add_test(tc, a_new_child_begins_with_the_first_pass);
    tcase_add_test(tc, a_peers_key_is_forgotten);
    tcase_add_test(tc, a_peer_that_is_no_longer_welcome_is_let_go);
    tcase_add_test(tc, records_that_radsubmit_wants_go_to_the_coordinator);
    tcase_add_test(tc, records_that_are_not_shared_go_nowhere_else);
    tcase_add_test(tc, records_that_nobody_wants_stay);
    tcase_add_test(tc, a_peer_is_let_in_by_its_token_alone);
    tcase_add_test(tc, a_peer_may_call_before_the_coordinator_named_it);
    tcase_add_test(tc, a_refusal_ends_it_with_the_status);
    tcase_add_loop_test(tc, it_speaks_as_it_is_welcomed, MSG_VERSION_MIN,
                        MSG_VERSION + 1);
    tcase_add_loop_test(tc, it_speaks_with_a_peer_what_both_know,
                        MSG_VERSION_MIN, MSG_VERSION + 1);
    tcase_add_loop_test(tc, it_ends_when_welcomed_in_another_version, 0,
                        N_ELEM(strange));
    tcase_add_test(tc, results_come_again_in_another_life_of_the_coordinator);
    tcase_add_test(tc, it_leaves_when_the_coordinator_lets_it_go);
    tcase_add_test(tc, a_slow_peer_loses_the_oldest_records);
    tcase_add_test(tc, a_base_line_goes_to_whom_waits_and_to_the_coordinator);
    tcase_add_test(
        tc, a_base_line_that_is_made_goes_to_one_named_late_or_linked_late);
    tcase_add_test(tc, a_base_line_from_a_peer_goes_to_the_child_if_it_fits);
    tcase_add_test(
        tc, base_lines_are_repeated_before_rows_that_were_not_acknowledged);
    tcase_add_test(tc, what_workers_share_passes_through);
    tcase_add_test(tc, what_is_lent_is_a_unit_until_it_is_done);
    tcase_add_test(tc, what_loans_cost_is_not_lost_with_a_connection);
    tcase_add_test(tc, what_it_lends_comes_back_when_the_coordinator_is_gone);
    tcase_add_test(tc, units_go_on_when_the_coordinator_is_back);
    tcase_add_test(tc, a_job_that_begins_with_another_cache_begins_anew);
    tcase_add_test(tc, a_parked_unit_is_no_suspect);
    suite_add_tcase(s, tc);
    return unit_run(s);
}
