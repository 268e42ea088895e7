/* coord_fixture.h - a coordinator that is asked one thing at a time
 *
 * What it does under accidents is tested by sim/; check_coord_*.c and others
 * look at its answers, with users and workers of which each is a connection.
 * All is static: each test program has its own. */
#ifndef RADD_TESTS_COORD_FIXTURE_H
#define RADD_TESTS_COORD_FIXTURE_H

#include "desk/desk.h"
#include "front/coord.h"
#include "proto/frame.h"
#include "tests/stats_text.h"
#include "tests/unit.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

enum { WORKER = 1, ANA, BOB, ADMIN, SECOND, STRANGER };

static const struct msg_frame frame = { 0, 8, 8, "" };
static const uint8_t job_a[MSG_JOB] = { 0xaa }, job_b[MSG_JOB] = { 0xbb };
static const uint8_t hash[MSG_HASH] = { 1 };
static const uint8_t pixels[8 * 8 * 12];

enum { CONNS = 300 };

/* A tile or a unit that a worker was given. */
struct to_do {
    uint64_t conn;
    struct msg m;
};

static struct {
    struct coord *c;
    uint64_t now_ms, slept_ms;
    bool have;              /* the file is stored */
    struct msg last[CONNS]; /* by connection: what was said to it last */
    struct wire_out bytes[CONNS];
    unsigned sent[CONNS];
    bool closed[CONNS];
    unsigned units[CONNS];        /* UNITs by connection */
    uint8_t unit_job;             /* first byte of the job of the last UNIT */
    struct msg_progress progress; /* the last */
    struct action_rows rows;      /* the last, and what they are */
    uint8_t code[2000];
    struct action_colours colours; /* the last but for its bytes */
    unsigned ncolours;
    int nan_logs;
    char nan_log[80];
    int differ_logs; /* of duplicates */
    int hang_logs;
    int exclude_logs;
    int break_logs, unlogged; /* of connections that it closed */
    int full_logs, room_logs; /* that the disk is full, and has room again */
    unsigned version[CONNS];
    int peers[CONNS]; /* JOB_PEERS that came */
    uint16_t peer_version[CONNS];
    unsigned files_sent; /* to workers, and the last of them */
    uint8_t file_sent[MSG_HASH];
    uint64_t files_dropped; /* the connection of the last such action */
    unsigned ends;          /* of jobs, for the store */
    unsigned loads, drops; /* of caches of jobs, and the job of the last */
    uint8_t cache_of[MSG_JOB];
    struct to_do todo[100]; /* what workers were given first */
    size_t ntodo;
    struct msg_closed to_hold[CONNS]; /* passes that workers were told of, until
                                       * they say that they have the records */
    bool crammed;      /* nobody reads answers */
    bool stuck;        /* nothing gets to the disk */
    uint64_t settling; /* who is to hear when that is over; and of what */
    uint32_t settling_what;
} f;

static inline bool
has_file(void *arg, const uint8_t *h)
{
    (void)arg;
    (void)h;
    return f.have;
}

static inline bool
has_room(void *arg, uint64_t conn)
{
    (void)arg;
    (void)conn;
    return !f.crammed;
}

static inline uint64_t
slept_ms(void *arg)
{
    (void)arg;
    return f.slept_ms;
}

static inline void
no_random(void *arg, void *buf, size_t n)
{
    (void)arg;
    memset(buf, 1, n);
}

static inline void
sent(const struct action *a)
{
    struct msg *m = &f.last[a->conn];
    struct msg_header h;
    struct wire_out *b = &f.bytes[a->conn];

    ck_assert(!f.closed[a->conn]);
    b->len = 0;
    wire_put_bytes(b, a->bytes, a->len);
    h.type = (uint16_t)(b->buf[4] << 8 | b->buf[5]);
    ck_assert_int_eq(msg_unpack(m, h.type, b->buf[11], b->buf + MSG_HEADER,
                                b->len - MSG_HEADER, NULL),
                     0);
    f.sent[a->conn]++;
    if (m->type == MSG_UNIT) {
        f.units[a->conn]++;
        f.unit_job = m->unit.job[0];
    }
    if ((m->type == MSG_TILE || m->type == MSG_UNIT) &&
        f.ntodo < N_ELEM(f.todo))
        f.todo[f.ntodo++] = (struct to_do){ a->conn, *m };
    if (m->type == MSG_CLOSED)
        f.to_hold[a->conn] = m->closed;
    if (m->type == MSG_PROGRESS)
        f.progress = m->progress;
    if (m->type == MSG_JOB_PEERS) {
        f.peers[a->conn]++;
        f.peer_version[a->conn] = m->job_peers.peers[0].version;
    }
}

static inline void
carry_out(void)
{
    struct action_list *l = coord_actions(f.c);

    for (size_t i = 0; i < l->n; i++) {
        struct action a = l->v[i];

        if (a.type == ACT_SEND)
            sent(&a);
        else if (a.type == ACT_SEND_FILE) {
            f.files_sent++;
            memcpy(f.file_sent, a.hash, MSG_HASH);
        } else if (a.type == ACT_DROP_FILES)
            f.files_dropped = a.conn;
        else if (a.type == ACT_SESSION)
            f.version[a.conn] = a.version;
        else if (a.type == ACT_CLOSE)
            f.closed[a.conn] = true;
        else if (a.type == ACT_SETTLE && f.stuck) {
            f.settling = a.conn;
            f.settling_what = a.request;
        } else if (a.type == ACT_SETTLE)
            coord_settled(f.c, f.now_ms, a.conn, a.request);
        else if (a.type == ACT_JOB_OPEN && !f.stuck)
            coord_job_opened(f.c, f.now_ms, a.job, a.sequence, 0, NULL);
        else if (a.type == ACT_JOB_END)
            f.ends++;
        else if (a.type == ACT_PUT_ROWS) {
            ck_assert_uint_ne(a.conn, 0);
            f.rows = a.rows;
            if (a.rows.len <= sizeof f.code)
                memcpy(f.code, a.rows.pixels, a.rows.len);
            if (!f.stuck)
                coord_rows_stored(f.c, f.now_ms, &a.rows, 0, NULL);
        } else if (a.type == ACT_PUT_COLOURS) {
            f.colours = a.colours;
            f.ncolours++;
        } else if (a.type == ACT_WRITE_PICTURE)
            coord_picture_written(f.c, f.now_ms, a.job, a.sequence, a.frame, 0,
                                  NULL);
        else if (a.type == ACT_LOAD_CACHE || a.type == ACT_DROP_CACHE) {
            f.loads += a.type == ACT_LOAD_CACHE;
            f.drops += a.type == ACT_DROP_CACHE;
            memcpy(f.cache_of, a.job, MSG_JOB);
        } else if (a.type == ACT_LOG && strstr(a.text, "no numbers"))
            snprintf(f.nan_log, sizeof f.nan_log, "%d %s", ++f.nan_logs,
                     strstr(a.text, "pixels="));
    }
    for (size_t i = 0; i < l->n; i++)
        if (l->v[i].type == ACT_LOG) {
            f.differ_logs += !!strstr(l->v[i].text, "duplicate differs");
            f.hang_logs += !!strstr(l->v[i].text, "worker hangs");
            f.full_logs += !!strstr(l->v[i].text, "disk full");
            f.room_logs += !!strstr(l->v[i].text, "disk has room");
            f.exclude_logs += !!strstr(l->v[i].text, "worker excluded");
            f.break_logs += !!strstr(l->v[i].text, "connection closed");
            sscanf(l->v[i].text, "connections closed and not logged n=%d",
                   &f.unlogged);
        }
    ck_assert(!l->failed);
    actions_clear(l);
}

static inline void
wait_s(unsigned s)
{
    for (unsigned i = 0; i < 10 * s; i++) {
        f.now_ms += 100;
        coord_tick(f.c, f.now_ms);
        carry_out();
    }
}

static inline void
say(uint64_t conn, const struct msg *m)
{
    coord_message(f.c, ++f.now_ms, conn, m);
    carry_out();
}

static inline void
join(uint64_t conn, unsigned role, const char *name, const char *owner)
{
    struct coord_peer peer = { "test", owner, 30, NULL }; /* any role */
    struct msg m = { .type = MSG_HELLO,
                     .hello = { MSG_VERSION_MIN, MSG_VERSION, (uint8_t)role,
                                name, "t", "", 2, 0 } };

    coord_opened(f.c, f.now_ms, conn, &peer);
    say(conn, &m);
}

/* Its connection breaks. */
static inline void
cut(uint64_t conn)
{
    coord_closed(f.c, f.now_ms, conn, "cut");
    carry_out();
}

/* The user has sent the file. */
static inline void
file_came(uint64_t conn, const uint8_t name[MSG_HASH])
{
    coord_file_stored(f.c, f.now_ms, conn, name);
    carry_out();
}

static uint32_t submit_flags; /* of jobs that are submitted from now on */

/* A SUBMIT of the usual job of one file and one frame; what else it has is for
 * the caller to set. */
static inline struct msg
usual_submit(const uint8_t *job)
{
    return (struct msg){ .type = MSG_SUBMIT,
                         .submit = { .job = job,
                                     .manifest = hash,
                                     .name = "n",
                                     .params = "",
                                     .needs = "",
                                     .estimate = "",
                                     .files = { 1, hash },
                                     .nframes = 1,
                                     .frames = &frame } };
}

static inline void
submit_with(uint64_t conn, const uint8_t *job, int priority, uint32_t windows,
            uint32_t flags)
{
    struct msg m = usual_submit(job);

    m.request = 5;
    m.submit.priority = priority;
    m.submit.flags = flags | submit_flags;
    m.submit.partition = MSG_PART_WINDOW;
    m.submit.windows = windows;
    say(conn, &m);
}

static inline void
submit(uint64_t conn, const uint8_t *job, int priority)
{
    submit_with(conn, job, priority, 4, 0);
}

static inline void
ready(uint64_t conn, const uint8_t *job)
{
    struct msg m = { .type = MSG_READY, .ready = { job, .1, 7, 2, 0 } };

    say(conn, &m);
}

static inline void
result(uint64_t conn, const uint8_t *job, uint32_t unit, uint32_t attempt)
{
    struct msg m = { .type = MSG_RESULT,
                     .result = { job,
                                 unit,
                                 attempt,
                                 0,
                                 4,
                                 4,
                                 1,
                                 1,
                                 { .rays = 10 },
                                 pixels,
                                 4 * 4 * 4 } };

    say(conn, &m);
}

static inline void
about(uint64_t conn, uint16_t type, const uint8_t *job)
{
    struct msg m = { .type = type, .request = 6, .cancel = { job } };

    say(conn, &m);
}

static inline void
set_up_coord(bool keeps)
{
    struct coord_env env = { .has_file = has_file,
                             .random = no_random,
                             .has_room = has_room,
                             .slept_ms = slept_ms,
                             .program = "radcoord",
                             .epoch = 1,
                             .direct = 1,
                             .keeps = keeps };

    memset(&f, 0, sizeof f);
    f.c = coord_new(&env);
    f.now_ms = 1;
    f.have = true;
    for (int i = 0; i < CONNS; i++)
        wire_out_init(&f.bytes[i], MSG_FRAME_MAX);
    join(WORKER, MSG_ROLE_WORKER, "ws1", "daemon");
    join(ANA, MSG_ROLE_USER, "", "ana");
    join(BOB, MSG_ROLE_USER, "", "bob");
    join(ADMIN, MSG_ROLE_ADMIN, "", "root");
    for (uint64_t i = ANA; i <= ADMIN; i++)
        file_came(i, hash);
}

static inline void
set_up(void)
{
    set_up_coord(false);
}

static inline void
tear_down(void)
{
    coord_free(f.c);
    for (int i = 0; i < CONNS; i++) {
        wire_out_release(&f.bytes[i]);
        msg_release(&f.last[i]);
    }
}

/* Ana submits a job, and the first worker is ready for it. */
static inline void
start_job(void)
{
    submit(ANA, job_a, 0);
    ready(WORKER, job_a);
}

/* Another worker comes, and is ready for the job. */
static inline void
second_ready(const uint8_t *job)
{
    join(SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    ready(SECOND, job);
}

/* ws1 has two units, ws2 has done the others. */
static inline void
two_are_left(void)
{
    start_job();
    second_ready(job_a);
    result(SECOND, job_a, 2, 1);
    result(SECOND, job_a, 3, 1);
    f.units[SECOND] = 0;
}

/* The number of the first worker's statistics. */
static inline double
worker_stat(const char *key)
{
    char *text = stats_text(desk_find_job(f.c, job_a), f.now_ms);
    json_t *root = json_loads(text, 0, NULL);
    json_t *w = json_array_get(json_object_get(root, "workers"), 0);
    double v = json_number_value(json_object_get(w, key));

    json_decref(root);
    free(text);
    return v;
}

static inline uint64_t
rays_told(void)
{
    f.now_ms += 1000;
    coord_tick(f.c, f.now_ms);
    carry_out();
    return f.progress.rays;
}

/* As the answers of a store name the job; 0: there is none. */
static inline uint64_t
job_number(const uint8_t *job)
{
    const struct job *j = desk_find_job(f.c, job);

    return j ? j->sequence : 0;
}

#endif
