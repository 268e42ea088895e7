/* lines_fixture.h - lines of a picture shared among workers, as the coordinator
 * sees it: one event at a time
 *
 * Whole clusters under accidents are in sim/; those who use this look at what
 * it says to whom when units wait, are given away, doubled, lent, lost or late.
 * All is static: each test program has its own. */
#ifndef RADD_TESTS_LINES_FIXTURE_H
#define RADD_TESTS_LINES_FIXTURE_H

#include "proto/frame.h"
#include "picture/quincunx.h"
#include "desk/desk.h"
#include "front/coord.h"
#include "tests/stats_text.h"
#include "tests/unit.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

enum {
    ANA = 1,
    W1,
    W2,
    W3,
    ADMIN,
    CONNS
}; /* connections; W1 is worker "ws1" */
enum { WIDTH = 16, HEIGHT = 31, LINES = 11, BAR = 3 };

static const struct msg_frame frames[] = { { 0, WIDTH, HEIGHT, "" },
                                           { 1, WIDTH, HEIGHT, "" },
                                           { 2, WIDTH, HEIGHT, "" } };
static const uint8_t id[MSG_JOB] = { 0xaa }, hash[MSG_HASH] = { 1 };
/* Lines enough for two workers to have regions. */
static const struct msg_frame tall = { 0, WIDTH, 150, "" };

static const uint8_t pixels[HEIGHT * WIDTH * 12], density[WIDTH];
static const uint8_t bitmap[BAR * 2] = { 0x81 }; /* two pixels */

struct said {
    uint64_t conn;
    struct msg m; /* strings and bytes are gone, but for next_holder.name */
    char name[MSG_MAX_NAME + 1];
};

static const char *const NAMES[] = { "ws1", "ws2", "ws3" };

static struct {
    struct coord *c;
    uint64_t now_ms;
    struct said said[400];
    int nsaid;
    bool closed[CONNS], done, failed;
    bool slow_disk;     /* nothing is kept */
    uint64_t kept_rays; /* of the last unit whose rows were all kept */
    bool tall;
    uint16_t threads; /* of workers that join, or get ready, from now on */
    char why[MSG_MAX_TEXT + 1];
} f;

static inline bool
has_file(void *arg, const uint8_t *h)
{
    (void)arg;
    (void)h;
    return true;
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
    uint16_t type = (uint16_t)(a->bytes[4] << 8 | a->bytes[5]);
    struct said *s = &f.said[f.nsaid];

    if (type == MSG_PROGRESS)
        return;
    f.nsaid++;
    ck_assert_int_le(f.nsaid, N_ELEM(f.said));
    ck_assert(!f.closed[a->conn]);
    memset(s, 0, sizeof *s);
    s->conn = a->conn;
    ck_assert_int_eq(msg_unpack(&s->m, type, 0, a->bytes + MSG_HEADER,
                                a->len - MSG_HEADER, NULL),
                     0);
    if (type == MSG_NEXT_HOLDER)
        snprintf(s->name, sizeof s->name, "%s", s->m.next_holder.name);
    if (type == MSG_FAILED)
        snprintf(f.why, sizeof f.why, "%s", s->m.failed.text);
    f.done |= type == MSG_DONE;
    f.failed |= type == MSG_FAILED;
    free(s->m.list);
    s->m.list = NULL;
}

static inline void
carry_out(void)
{
    struct action_list *l = coord_actions(f.c);

    for (size_t i = 0; i < l->n; i++) {
        struct action a = l->v[i];

        if (a.type == ACT_SEND)
            sent(&a);
        else if (a.type == ACT_CLOSE)
            f.closed[a.conn] = true;
        else if (a.type == ACT_JOB_OPEN)
            coord_job_opened(f.c, f.now_ms, a.job, a.sequence, 0, NULL);
        else if (a.type == ACT_PUT_ROWS && a.rows.last)
            f.kept_rays = a.rows.counts->rays;
        if (a.type == ACT_PUT_ROWS && !f.slow_disk)
            coord_rows_stored(f.c, f.now_ms, &a.rows, 0, NULL);
        else if (a.type == ACT_WRITE_PICTURE)
            coord_picture_written(f.c, f.now_ms, a.job, a.sequence, a.frame, 0,
                                  NULL);
    }
    ck_assert(!l->failed);
    actions_clear(l);
}

static inline void
clear(void)
{
    f.nsaid = 0;
}

static inline void
say(uint64_t conn, const struct msg *m)
{
    coord_message(f.c, f.now_ms, conn, m);
    carry_out();
}

static inline void
wait_ms(unsigned ms)
{
    for (; ms > 0; ms -= ms < 50 ? ms : 50) {
        f.now_ms += ms < 50 ? ms : 50;
        coord_tick(f.c, f.now_ms);
        carry_out();
    }
}

/* What it said of that type to a connection since clear(): the last, or NULL,
 * and how often. */
static inline const struct said *
last(uint64_t conn, uint16_t type)
{
    for (int i = f.nsaid; i-- > 0;)
        if (f.said[i].conn == conn && f.said[i].m.type == type)
            return &f.said[i];
    return NULL;
}

static inline int
count(uint64_t conn, uint16_t type)
{
    int n = 0;

    for (int i = 0; i < f.nsaid; i++)
        n += f.said[i].conn == conn && f.said[i].m.type == type;
    return n;
}

/* --- what users and workers say --- */

static inline void
join(uint64_t conn, unsigned role, const char *name, const char *address)
{
    struct coord_peer peer = { "test", "ana", 14, NULL };
    struct msg m = { .type = MSG_HELLO,
                     .hello = { 1, MSG_VERSION, (uint8_t)role, name, "t",
                                address, f.threads, 0 } };

    f.closed[conn] = false;
    coord_opened(f.c, f.now_ms, conn, &peer);
    say(conn, &m);
}

static inline void
submit(enum msg_partition kind, uint32_t flags, const char *estimate,
       uint32_t nframes)
{
    struct msg m = { .type = MSG_SUBMIT,
                     .request = 5,
                     .submit = { .job = id,
                                 .manifest = hash,
                                 .name = "n",
                                 .params = "-ps 4",
                                 .needs = "",
                                 .estimate = estimate,
                                 .flags = flags,
                                 .partition = (uint8_t)kind,
                                 .files = { 1, hash },
                                 .nframes = nframes,
                                 .frames = f.tall ? &tall : frames } };

    coord_file_stored(f.c, f.now_ms, ANA, hash);
    say(ANA, &m);
}

static inline void
ready(uint64_t conn)
{
    struct msg m = { .type = MSG_READY, .ready = { id, .1, 7, f.threads, 0 } };

    say(conn, &m);
}

/* Its connection breaks. */
static inline void
cut(uint64_t conn)
{
    coord_closed(f.c, f.now_ms, conn, "cut");
    carry_out();
}

/* A worker is lost for good, and that other one is ready for the job. */
static inline void
replace(uint64_t lost, uint64_t by)
{
    cut(lost);
    wait_ms(2000);
    join(by, MSG_ROLE_WORKER, NAMES[by - W1], "");
    ready(by);
}

/* A job of that kind, and ws1 to wsN ready for it. */
static inline void
start(enum msg_partition kind, uint32_t flags, int workers)
{
    submit(kind, flags, "uniform", 1);
    for (int i = 0; i < workers; i++)
        ready((uint64_t)(W1 + i));
}

static inline void
attempt(uint64_t conn, uint16_t type, const struct msg_unit *u)
{
    struct msg m = { .type = type, .parked = { id, u->unit, u->attempt } };

    say(conn, &m);
}

/* All of a loan is traced, with so many rays. */
static inline void
paid(uint64_t conn, const struct msg_unit *u, uint64_t rays)
{
    struct msg m = { .type = MSG_PAID,
                     .paid = { id,
                               u->unit,
                               u->attempt,
                               { .rays = rays,
                                 .cpu_s = .5,
                                 .wall_s = 1000,
                                 .nan = { 2, 0, 9, 1 },
                                 .faults = { { 5, 3 } } } } };

    say(conn, &m);
}

static inline void
gave(uint64_t conn, const struct msg_unit *u, uint32_t height)
{
    struct msg m = { .type = MSG_GAVE,
                     .gave = { id, u->unit, u->attempt, height } };

    say(conn, &m);
}

/* Two facts of a line's first row. */
static inline void
facts(uint64_t conn, uint32_t line)
{
    struct msg m = { .type = MSG_FACTS,
                     .facts = { id, 0, line, 0, line ? BAR : 1, WIDTH, 0, 3,
                                bitmap, pixels, 2 } };

    say(conn, &m);
}

static inline uint32_t
ndensity(void)
{
    struct rad_quincunx q = { .width = WIDTH, .height = HEIGHT };

    rad_quincunx_steps(4, &q.xstep, &q.ystep);
    return (uint32_t)rad_quincunx_ndensity(&q);
}

/* The densities after a line, which follow from so many lines. */
static inline void
guess(uint64_t conn, uint32_t line, uint8_t known)
{
    struct msg m = { .type = MSG_GUESS,
                     .guess = { id, 0, line, known, ndensity(), density } };

    say(conn, &m);
}

/* A base line, in two pieces. */
static inline void
base_line(uint64_t conn, uint32_t frame, uint32_t line)
{
    struct msg m = { .type = MSG_BASE_LINE,
                     .base_line = { id, frame, line, 0, 7, 0, 1, 3, density,
                                    .pixels = pixels } };

    say(conn, &m);
    m.base_line.x = 7;
    m.base_line.n = WIDTH - 7;
    m.base_line.first = 1;
    m.base_line.ndensity = ndensity() - 1;
    say(conn, &m);
}

/* Black rows of a unit, each a run a component. */
static inline void
result(uint64_t conn, const struct msg_unit *u, uint32_t row, uint32_t rows,
       bool end)
{
    static const uint8_t run[] = { 2,           2, 0,           WIDTH,
                                   128 + WIDTH, 0, 128 + WIDTH, 0,
                                   128 + WIDTH, 0, 128 + WIDTH, 0 };
    uint8_t code[150 * sizeof run]; /* of `tall` */
    struct msg m = { .type = MSG_RESULT,
                     .result = { id,
                                 u->unit,
                                 u->attempt,
                                 row,
                                 rows,
                                 WIDTH,
                                 1,
                                 end,
                                 { .rays = 10 },
                                 code,
                                 rows * sizeof run } };

    for (uint32_t i = 0; i < rows; i++)
        memcpy(code + i * sizeof run, run, sizeof run);
    say(conn, &m);
}

/* The line under which row y - 1 lies, which ends at it. */
static inline uint32_t
line_above(uint32_t y)
{
    return y == 0 ? 0 : (y - 1) / BAR;
}

/* All of it, its base line first. */
static inline void
finish(uint64_t conn, const struct msg_unit *u)
{
    if (u->y + u->height < HEIGHT)
        base_line(conn, u->frame, line_above(u->y + u->height));
    result(conn, u, 0, u->height, true);
}

static inline const struct msg_unit *
unit_of(uint64_t conn)
{
    const struct said *s = last(conn, MSG_UNIT);

    ck_assert_ptr_nonnull(s);
    return &s->m.unit;
}

/* start() with two workers, which have got units *a and *b. */
static inline void
start_two(enum msg_partition kind, uint32_t flags, struct msg_unit *a,
          struct msg_unit *b)
{
    start(kind, flags, 2);
    *a = *unit_of(W1);
    *b = *unit_of(W2);
}

/* The first since clear(). */
static inline const struct msg_unit *
first_unit_of(uint64_t conn)
{
    for (int i = 0; i < f.nsaid; i++)
        if (f.said[i].conn == conn && f.said[i].m.type == MSG_UNIT)
            return &f.said[i].m.unit;
    ck_abort_msg("no unit");
}

static inline double
stat_of(const char *group, const char *key)
{
    char *text = stats_text(desk_find_job(f.c, id), f.now_ms);
    json_t *root = json_loads(text, 0, NULL);
    double v =
        json_number_value(json_object_get(json_object_get(root, group), key));

    json_decref(root);
    free(text);
    return v;
}

static inline double
worker_stat(const char *name, const char *key)
{
    char *text = stats_text(desk_find_job(f.c, id), f.now_ms);
    json_t *root = json_loads(text, 0, NULL), *o;
    double v = 0;
    size_t i;

    json_array_foreach(json_object_get(root, "workers"), i, o)
    {
        if (strcmp(json_string_value(json_object_get(o, "name")), name) == 0)
            v = json_number_value(json_object_get(o, key));
    }
    json_decref(root);
    free(text);
    return v;
}

static inline void
set_up(void)
{
    struct coord_env env = { .has_file = has_file,
                             .random = no_random,
                             .arg = NULL,
                             .program = "radcoord",
                             .epoch = 1 };

    memset(&f, 0, sizeof f);
    f.c = coord_new(&env);
    f.now_ms = 1;
    f.threads = 1;
    join(ANA, MSG_ROLE_USER, "", "");
    join(ADMIN, MSG_ROLE_ADMIN, "", "");
    join(W1, MSG_ROLE_WORKER, "ws1", "tcp a");
    join(W2, MSG_ROLE_WORKER, "ws2", "tcp b");
}

/* So many workers come, those that were there once more. */
static inline void
come(int workers)
{
    for (int i = 0; i < workers; i++) {
        coord_closed(f.c, f.now_ms, (uint64_t)(W1 + i), "again");
        join((uint64_t)(W1 + i), MSG_ROLE_WORKER, NAMES[i], "");
    }
}

static inline void
tear_down(void)
{
    coord_free(f.c);
}

static inline void
lend(uint64_t conn, const struct msg_unit *u, uint32_t x, uint32_t n)
{
    struct msg m = { .type = MSG_LOAN,
                     .loan = { id, u->unit, u->attempt, 0,
                               line_above(u->y + u->height), x, n, 20000, 20000,
                               0, 3, 0, density, bitmap, pixels, pixels } };

    say(conn, &m);
}

#endif
