/* worker_fixture.h - a worker that is told one event at a time
 *
 * check_worker*.c look at the actions that it answers with.  All is static:
 * each test program has its own. */
#ifndef RADD_TESTS_WORKER_FIXTURE_H
#define RADD_TESTS_WORKER_FIXTURE_H

#include "proto/frame.h"
#include "tests/unit.h"
#include "worker/worker.h"

#include <string.h>
#include <sysexits.h>

static const struct msg_frame frame = { 0, 8, 8, "" };
static const uint8_t job_id[MSG_JOB] = { 0xaa }, token[MSG_TOKEN] = { 3 };
static const uint8_t hash[MSG_HASH] = { 1 };
static const uint8_t pixels[4 * 2 * 12];
static const uint8_t line_bytes[8 * 12] = { 0x3f, 0x80 };
static const uint8_t density[4] = { 3, 0, 1, 2 };

struct fixture {
    struct worker *w;
    uint64_t now_ms;
    bool have;
    uint8_t chance;              /* each byte of it */
    uint64_t coord, child, peer; /* connections that it asked for */
    unsigned dials, spawns, kills;
    unsigned warnings; /* in the log, and worse */
    unsigned chunks;   /* to be kept */
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

static inline bool
has_file(void *arg, const uint8_t *h)
{
    (void)arg;
    (void)h;
    return f.have;
}

static inline void
chance(void *arg, void *buf, size_t n)
{
    (void)arg;
    memset(buf, f.chance, n);
}

static inline void
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

static inline void
dialled(const struct action *a)
{
    f.dials++;
    if (a->text[0])
        f.peer = a->conn;
    else
        f.coord = a->conn;
}

static inline void
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

static inline void
clear(void)
{
    f.nsaid = 0;
}

/* How often it said that to a connection since clear(). */
static inline int
said(uint64_t conn, uint16_t type)
{
    int n = 0;

    for (int i = 0; i < f.nsaid; i++)
        n += f.said[i].conn == conn && f.said[i].type == type;
    return n;
}

static inline void
hear(uint64_t conn, const struct msg *m)
{
    worker_message(f.w, ++f.now_ms, conn, m);
    carry_out();
}

static inline void
tick(unsigned ms)
{
    f.now_ms += ms;
    worker_tick(f.w, f.now_ms);
    carry_out();
}

static inline void
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

static inline void
cut(void)
{
    worker_closed(f.w, f.now_ms, f.coord, "cut");
    carry_out();
}

/* The child dies, as its scene may have it. */
static inline void
child_crashes(void)
{
    worker_child_ended(f.w, f.now_ms, f.child, EX_SOFTWARE,
                       "killed by signal 11");
    carry_out();
}

static uint32_t job_flags = MSG_JOB_SHARE;
static int32_t job_priority;
static uint64_t job_seed;
static const uint8_t *job_files = hash;
static uint32_t job_nfiles = 1;
static const uint8_t *job_reuse;

static inline void
start_job(void)
{
    struct msg m = { .type = MSG_JOB_START,
                     .job_start = { .job = job_id,
                                    .manifest = hash,
                                    .name = "",
                                    .params = "",
                                    .needs = "",
                                    .estimate = "",
                                    .seed = job_seed,
                                    .priority = job_priority,
                                    .flags = job_flags,
                                    .files = { job_nfiles, job_files },
                                    .nframes = 1,
                                    .frames = &frame,
                                    .scene = hash,
                                    .reuse = job_reuse } };

    if (job_reuse)
        m.job_start.flags = MSG_JOB_PASSES | MSG_JOB_SCENE | MSG_JOB_REUSE;
    hear(f.coord, &m);
}

static inline void
child_ready(void)
{
    static const uint8_t untold[MSG_JOB]; /* the worker knows whose it is */
    struct msg m = { .type = MSG_READY, .ready = { untold, .5, 7, 2, 0 } };

    hear(f.child, &m);
}

/* The job comes, and its child is ready. */
static inline void
load_job(void)
{
    start_job();
    child_ready();
}

static inline void
unit(uint32_t number)
{
    struct msg m = { .type = MSG_UNIT,
                     .unit = { job_id, number, 1, 0, 0, 0, 4, .height = 4 } };

    hear(f.coord, &m);
}

/* Two of a unit's four rows. */
static inline void
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

static inline void
ack(uint32_t number, uint32_t row)
{
    struct msg m = { .type = MSG_ACK, .ack = { job_id, number, 1, row, 2 } };

    hear(f.coord, &m);
}

static inline void
set_up_on(bool one_disk)
{
    const struct worker_env env = { .has_file = has_file,
                                    .random = chance,
                                    .program = "radd",
                                    .name = "ws1",
                                    .coordinator = "test:7420",
                                    .address = "",
                                    .threads = 2,
                                    .one_disk = one_disk,
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

static inline void
set_up(void)
{
    set_up_on(false);
}

static inline void
tear_down(void)
{
    worker_free(f.w);
    wire_out_release(&f.bytes);
    msg_release(&f.last);
}

static inline void
introduce(uint32_t flags)
{
    struct msg_peer p = { "ws2", flags & MSG_PEER_DIAL ? "tcp x" : "", token,
                          flags, MSG_VERSION };
    struct msg m = { .type = MSG_JOB_PEERS, .job_peers = { job_id, 1, &p } };

    hear(f.coord, &m);
}

/* The link to the peer that it dialled is there. */
static inline void
peer_opened(void)
{
    worker_opened(f.w, f.now_ms, f.peer);
    carry_out();
}

#endif
