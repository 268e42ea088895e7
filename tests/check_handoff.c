/* check_handoff.c - lines of a picture shared among workers, as the coordinator
 * sees it: one event at a time
 *
 * Whole clusters under accidents are in sim/; here is what it says to whom when
 * units wait, are given away, doubled, lost or late. */
#include "config.h"

#include "frame.h"
#include "picture/quincunx.h"
#include "sched.h"
#include "stats.h"
#include "unit.h"

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
    uint8_t version; /* of the protocol, that workers speak; 0: 1 */
    char why[MSG_MAX_TEXT + 1];
} f;

static bool
has_file(void *arg, const uint8_t *h)
{
    (void)arg;
    (void)h;
    return true;
}

static void
no_random(void *arg, void *buf, size_t n)
{
    (void)arg;
    memset(buf, 1, n);
}

static void
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

static void
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
            coord_job_opened(f.c, f.now_ms, a.job, 0, NULL);
        else if (a.type == ACT_PUT_ROWS && a.rows.last)
            f.kept_rays = a.rows.counts->rays;
        if (a.type == ACT_PUT_ROWS && !f.slow_disk)
            coord_rows_stored(f.c, f.now_ms, &a.rows, 0, NULL);
        else if (a.type == ACT_WRITE_PICTURE)
            coord_picture_written(f.c, f.now_ms, a.job, a.frame, 0, NULL);
    }
    ck_assert(!l->failed);
    actions_clear(l);
}

static void
clear(void)
{
    f.nsaid = 0;
}

static void
say(uint64_t conn, const struct msg *m)
{
    coord_message(f.c, f.now_ms, conn, m);
    carry_out();
}

static void
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
static const struct said *
last(uint64_t conn, uint16_t type)
{
    for (int i = f.nsaid; i-- > 0;)
        if (f.said[i].conn == conn && f.said[i].m.type == type)
            return &f.said[i];
    return NULL;
}

static int
count(uint64_t conn, uint16_t type)
{
    int n = 0;

    for (int i = 0; i < f.nsaid; i++)
        n += f.said[i].conn == conn && f.said[i].m.type == type;
    return n;
}

/* --- what users and workers say --- */

static void
join(uint64_t conn, unsigned role, const char *name, const char *address)
{
    struct coord_peer peer = { "test", "ana", 14, NULL };
    struct msg m = { .type = MSG_HELLO,

                     .hello = { 1, f.version ? f.version : 1, (uint8_t)role,
                                name, "t", address, 1, 0 } };

    f.closed[conn] = false;
    coord_opened(f.c, f.now_ms, conn, &peer);
    say(conn, &m);
}

static void
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

    say(ANA, &m);
}

static void
ready(uint64_t conn)
{
    struct msg m = { .type = MSG_READY, .ready = { id, .1, 7, 1 } };

    say(conn, &m);
}

/* A job of that kind, and ws1 to wsN ready for it. */
static void
start(enum msg_partition kind, uint32_t flags, int workers)
{
    submit(kind, flags, "uniform", 1);
    for (int i = 0; i < workers; i++)
        ready((uint64_t)(W1 + i));
}

static void
attempt(uint64_t conn, uint16_t type, const struct msg_unit *u)
{
    struct msg m = { .type = type, .parked = { id, u->unit, u->attempt } };

    say(conn, &m);
}

/* All of a loan is traced, with so many rays. */
static void
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

static void
gave(uint64_t conn, const struct msg_unit *u, uint32_t height)
{
    struct msg m = { .type = MSG_GAVE,
                     .gave = { id, u->unit, u->attempt, height } };

    say(conn, &m);
}

/* Two facts of a line's first row. */
static void
facts(uint64_t conn, uint32_t line)
{
    struct msg m = { .type = MSG_FACTS,
                     .facts = { id, 0, line, 0, line ? BAR : 1, WIDTH, 0, 3,
                                bitmap, pixels, 2 } };

    say(conn, &m);
}

static uint32_t
ndensity(void)
{
    struct rad_quincunx q = { .width = WIDTH, .height = HEIGHT };

    rad_quincunx_steps(4, &q.xstep, &q.ystep);
    return (uint32_t)rad_quincunx_ndensity(&q);
}

/* A base line, in two pieces. */
static void
base_line(uint64_t conn, uint32_t frame, uint32_t line)
{
    struct msg m = { .type = MSG_BASE_LINE,
                     .base_line = { id, frame, line, 0, 7, 0, 1, 3, density,
                                    pixels } };

    say(conn, &m);
    m.base_line.x = 7;
    m.base_line.n = WIDTH - 7;
    m.base_line.first = 1;
    m.base_line.ndensity = ndensity() - 1;
    say(conn, &m);
}

/* Rows of a unit. */
static void
result(uint64_t conn, const struct msg_unit *u, uint32_t row, uint32_t rows,
       bool end)
{
    struct msg m = { .type = MSG_RESULT,
                     .result = { id,
                                 u->unit,
                                 u->attempt,
                                 row,
                                 rows,
                                 WIDTH,
                                 3,
                                 end,
                                 { .rays = 10 },
                                 pixels } };

    say(conn, &m);
}

/* The line under which row y - 1 lies, which ends at it. */
static uint32_t
line_above(uint32_t y)
{
    return y == 0 ? 0 : (y - 1) / BAR;
}

/* All of it, its base line first. */
static void
finish(uint64_t conn, const struct msg_unit *u)
{
    if (u->y + u->height < HEIGHT)
        base_line(conn, u->frame, line_above(u->y + u->height));
    result(conn, u, 0, u->height, true);
}

static const struct msg_unit *
unit_of(uint64_t conn)
{
    const struct said *s = last(conn, MSG_UNIT);

    ck_assert_ptr_nonnull(s);
    return &s->m.unit;
}

/* The first since clear(). */
static const struct msg_unit *
first_unit_of(uint64_t conn)
{
    for (int i = 0; i < f.nsaid; i++)
        if (f.said[i].conn == conn && f.said[i].m.type == MSG_UNIT)
            return &f.said[i].m.unit;
    ck_abort_msg("no unit");
}

static double
stat_of(const char *group, const char *key)
{
    char *text = stats_json(coord_find_job(f.c, id), f.now_ms);
    json_t *root = json_loads(text, 0, NULL);
    double v =
        json_number_value(json_object_get(json_object_get(root, group), key));

    json_decref(root);
    free(text);
    return v;
}

static double
worker_stat(const char *name, const char *key)
{
    char *text = stats_json(coord_find_job(f.c, id), f.now_ms);
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

static void
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
    join(ANA, MSG_ROLE_USER, "", "");
    join(ADMIN, MSG_ROLE_ADMIN, "", "");
    join(W1, MSG_ROLE_WORKER, "ws1", "tcp a");
    join(W2, MSG_ROLE_WORKER, "ws2", "tcp b");
}

static void
tear_down(void)
{
    coord_free(f.c);
}

/* --- hand-out --- */

/* Where records are shared, workers begin their first lines at different ends;
 * later, at the top of a frame, and where nothing is shared, all go from left
 * to right. */
START_TEST(workers_begin_apart_while_records_are_few)
{
    int n = 0;

    submit(MSG_PART_SCANBAR, _i ? MSG_JOB_SHARE : 0, "uniform", 3);
    ready(W1);
    ready(W2);
    ck_assert_uint_eq(first_unit_of(W1)->end, MSG_END_LEFT);
    for (int i = 0; i < f.nsaid; i++) {
        const struct msg_unit u = f.said[i].m.unit;

        if (f.said[i].conn != W2 || f.said[i].m.type != MSG_UNIT ||
            u.flags & MSG_UNIT_TWIN)
            continue;
        ck_assert_uint_eq(u.end, _i && u.y > 0 && n < 8 ? MSG_END_RIGHT
                                                        : MSG_END_LEFT);
        n += u.y > 0;
        finish(W2, &u);
    }
    ck_assert_int_gt(n, 12);
}
END_TEST

START_TEST(lines_go_out_with_what_is_known_of_them)
{
    struct msg_unit a, b, c;

    start(MSG_PART_SCANBAR, 0, 2);
    a = *first_unit_of(W1);
    b = *first_unit_of(W2);
    ck_assert(a.mode == MSG_MODE_STRICT && a.y == 0 && a.height == 1 + BAR);
    ck_assert(a.width == WIDTH && a.flags == 0 && a.end == MSG_END_LEFT);
    ck_assert_uint_eq(b.height, BAR);
    ck_assert_uint_gt(b.y, a.y + a.height);   /* not what follows */
    ck_assert_uint_eq(b.flags, MSG_UNIT_TOP); /* nobody has what is above */
    ck_assert_int_eq(count(W1, MSG_JOB_PEERS), 1); /* lines need links */
    a = *unit_of(W2); /* the one that follows is at hand */
    ck_assert_uint_eq(a.y, b.y + b.height);
    ck_assert_uint_eq(a.flags, 0);
    clear();
    base_line(W2, 0, line_above(a.y + a.height));
    attempt(W2, MSG_PARKED, &b);
    c = *unit_of(W2); /* and the next */
    ck_assert_uint_eq(c.y, a.y + a.height);
    ck_assert_uint_eq(c.flags, 0);
    ck_assert_str_eq(last(W2, MSG_NEXT_HOLDER)->name, "ws2");
    ck_assert_int_eq(count(W2, MSG_BASE_LINE), 1); /* its top is here */
    ck_assert_uint_eq(last(W2, MSG_BASE_LINE)->m.base_line.n, WIDTH);
}
END_TEST

static uint32_t
waiting(void)
{
    return job_waiting(coord_find_job(f.c, id));
}

/* Two that make a base line make one of them for nothing. */
START_TEST(a_line_that_the_one_below_makes_is_kept_till_it_is_there)
{
    struct msg_unit b;
    uint32_t n;

    start(MSG_PART_SCANBAR, 0, 2);
    b = *first_unit_of(W2);
    n = waiting();
    facts(W2, line_above(b.y) - 1); /* another's */
    facts(W1, line_above(b.y));     /* by another */
    ck_assert_uint_eq(waiting(), n);
    facts(W2, line_above(b.y));
    ck_assert_uint_eq(waiting(), n + 1);
}
END_TEST

START_TEST(a_kept_line_is_free_when_its_maker_has_no_more_to_do)
{
    struct msg_unit b;
    uint32_t n;

    start(MSG_PART_SCANBAR, 0, 2);
    b = *first_unit_of(W2);
    n = waiting();
    attempt(W2, MSG_PARKED, &b);
    ck_assert_uint_eq(waiting(), n); /* one is out for it */
}
END_TEST

START_TEST(a_kept_line_is_free_when_its_maker_is_lost)
{
    uint32_t n;

    start(MSG_PART_SCANBAR, 0, 2);
    n = waiting();
    coord_closed(f.c, f.now_ms, W2, "cut");
    carry_out();
    ck_assert_uint_eq(waiting(), n + 3); /* and its two units */
}
END_TEST

START_TEST(a_kept_line_is_free_when_its_maker_is_stuck)
{
    uint32_t n;

    start(MSG_PART_SCANBAR, 0, 2);
    n = waiting();
    wait_ms(4900);
    ck_assert_uint_eq(waiting(), n);
    wait_ms(200);
    ck_assert_uint_eq(waiting(), n + 1);
}
END_TEST

/* However long a line takes: no thread waits for our answer.  In the end what
 * one has at hand another would wait for. */
START_TEST(a_line_is_at_hand_until_few_are_left)
{
    struct msg_unit u[2];
    int given = 0;

    start(MSG_PART_SCANBAR, 0, 2);
    ck_assert_int_eq(count(W1, MSG_UNIT), 2);
    ck_assert_int_eq(count(W2, MSG_UNIT), 2);
    u[0] = *first_unit_of(W2);
    u[1] = *unit_of(W2);
    for (;; given++) {
        wait_ms(1000);
        clear();
        attempt(W2, MSG_PARKED, &u[given % 2]);
        if (count(W2, MSG_UNIT) == 0)
            break;
        u[given % 2] = *unit_of(W2);
    }
    ck_assert_int_ge(given, 2);
    clear();
    attempt(W2, MSG_PARKED, &u[(given + 1) % 2]);
    ck_assert_int_eq(count(W2, MSG_UNIT), 1);
    ck_assert_int_eq(job_waiting(coord_find_job(f.c, id)), 3);
}
END_TEST

START_TEST(both_sides_hear_who_waits_for_a_base_line)
{
    struct msg_unit a, b;
    const struct said *s;

    start(MSG_PART_STATIC, 0, 2);
    a = *unit_of(W1);
    b = *unit_of(W2);
    ck_assert_uint_eq(a.y + a.height, b.y);
    ck_assert_uint_eq(b.y + b.height, HEIGHT);
    s = last(W1, MSG_NEXT_HOLDER);
    ck_assert_ptr_nonnull(s);
    ck_assert_uint_eq(s->m.next_holder.line, line_above(b.y));
    ck_assert_str_eq(s->name, "ws2");
    ck_assert_uint_eq(b.flags, 0); /* its first bar's colours come soon */
    clear();
    coord_closed(f.c, f.now_ms, W1, "cut"); /* and another gets it */
    carry_out();
    join(W3, MSG_ROLE_WORKER, "ws3", "");
    ready(W3);
    ck_assert_uint_eq(unit_of(W3)->y, 0);
    ck_assert_str_eq(last(W3, MSG_NEXT_HOLDER)->name, "ws2");
}
END_TEST

START_TEST(a_single_worker_has_no_links_and_whole_frames)
{
    f.closed[W2] = true;
    coord_closed(f.c, f.now_ms, W2, "cut");
    submit(MSG_PART_AUTO, 0, "uniform", 2);
    ready(W1);
    for (uint32_t i = 0; i < 2; i++) {
        struct msg_unit u = i ? *unit_of(W1) : *first_unit_of(W1);

        ck_assert(u.frame == i && u.y == 0 && u.height == HEIGHT);
        ck_assert_uint_eq(u.flags, 0);
        finish(W1, &u);
    }
    ck_assert(f.done);
    ck_assert_int_eq(count(W1, MSG_JOB_PEERS), 0);
    ck_assert_int_eq(count(W1, MSG_NEXT_HOLDER), 0);
}
END_TEST

/* Each frame has a run of each worker; those of one that is drained would wait
 * for ever. */
START_TEST(what_was_to_be_a_drained_workers_goes_to_others)
{
    struct msg drain = { .type = MSG_DRAIN, .drain = { "ws2" } };
    struct msg_unit a[2], b;

    submit(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, "uniform", 2);
    ready(W1);
    ready(W2);
    a[0] = *unit_of(W1);
    b = *unit_of(W2);
    say(ADMIN, &drain);
    finish(W1, &a[0]);
    finish(W2, &b);
    a[1] = *unit_of(W1);
    ck_assert(a[1].frame == 1 && a[1].y == 0);
    clear();
    finish(W1, &a[1]);
    b = *unit_of(W1);
    ck_assert(b.frame == 1 && b.y == a[1].height);
    finish(W1, &b);
    ck_assert(f.done);
}
END_TEST

/* Its child is stopped: it has the first unit, and would have another run. */
START_TEST(what_was_to_be_a_stopped_workers_goes_to_others)
{
    struct msg tally = { .type = MSG_TALLY, .tally = { .job = id } };
    struct msg_unit u[2], b;

    submit(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, "uniform", 3);
    ready(W1);
    ready(W2);
    b = *unit_of(W2);
    for (int i = 0; i < 3; i++) {
        u[0] = *unit_of(W1);
        ck_assert(u[0].frame == (uint32_t)i && u[0].y == 0);
        clear();
        finish(W1, &u[0]);
    }
    ck_assert_int_eq(count(W1, MSG_UNIT), 0);
    wait_ms(61000);
    u[0] = *unit_of(W1);
    ck_assert_uint_eq(u[0].unit, b.unit);
    clear();
    finish(W1, &u[0]);
    ck_assert_int_eq(count(W2, MSG_REVOKE), 1);
    ck_assert_int_eq(count(W2, MSG_UNIT), 0);
    u[1] = *unit_of(W1); /* W2's run of the next frame */
    ck_assert(u[1].frame == 1 && u[1].y == b.y);
    clear();
    say(W2, &tally);
    wait_ms(100);
    u[0] = *unit_of(W2); /* it goes on after all */
    ck_assert(u[0].frame == 2 && u[0].y == b.y);
    finish(W1, &u[1]);
    finish(W2, &u[0]);
    ck_assert(f.done);
}
END_TEST

START_TEST(one_that_is_drained_before_the_layout_has_no_part)
{
    struct msg drain = { .type = MSG_DRAIN, .drain = { "ws2" } };

    submit(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, "uniform", 1);
    say(ADMIN, &drain);
    ready(W1);
    ready(W2);
    ck_assert_uint_eq(unit_of(W1)->height, HEIGHT);
}
END_TEST

/* --- facts --- */

START_TEST(facts_go_to_whoever_has_the_line_now_and_later)
{
    struct msg_unit a, b;
    uint32_t line;

    start(MSG_PART_STATIC, 0, 2);
    a = *unit_of(W1);
    b = *unit_of(W2);
    line = line_above(b.y);
    facts(W1, line - 1); /* its own: nobody else wants it */
    ck_assert_int_eq(count(W1, MSG_FACTS) + count(W2, MSG_FACTS), 0);
    facts(W2, line); /* the base line above, made ahead */
    ck_assert_int_eq(count(W1, MSG_FACTS), 1);
    ck_assert_int_eq(count(W2, MSG_FACTS), 0);
    facts(W1, line); /* its bottom: a guess for the one below */
    ck_assert_int_eq(count(W1, MSG_FACTS), 1);
    ck_assert_int_eq(count(W2, MSG_FACTS), 1);
    clear();
    coord_closed(f.c, f.now_ms, W1, "cut");
    carry_out();
    join(W3, MSG_ROLE_WORKER, "ws3", "");
    ready(W3);
    ck_assert_uint_eq(unit_of(W3)->unit, a.unit);
    ck_assert_int_eq(count(W3, MSG_FACTS), 3);
    ck_assert_uint_eq(last(W3, MSG_FACTS)->m.facts.npixels, 2);
    a = *unit_of(W3);
    finish(W3, &a);
    clear();
    facts(W2, 1); /* nobody wants it any more */
    ck_assert_int_eq(f.nsaid, 0);
    /* and two that both had made */
    ck_assert_double_eq(stat_of("totals", "speculative_rays"), 2 + 2);
}
END_TEST

START_TEST(facts_that_fit_no_line_end_the_connection)
{
    struct msg m = { .type = MSG_FACTS,
                     .facts = { id, 0, 0, 0, BAR, WIDTH, 0, 3, bitmap, pixels,
                                2 } };

    start(MSG_PART_SCANBAR, 0, 2);
    say(W1, &m); /* line 0 has one row */
    ck_assert(f.closed[W1]);
}
END_TEST

/* --- base lines, and waiting for them --- */

START_TEST(a_parked_unit_takes_no_room)
{
    struct msg_unit b, c;

    start(MSG_PART_SCANBAR, 0, 2);
    b = *first_unit_of(W2);
    c = *unit_of(W2);
    clear();
    attempt(W1, MSG_PARKED, &b); /* another's */
    ck_assert_int_eq(count(W1, MSG_UNIT), 0);
    attempt(W2, MSG_PARKED, &b);
    ck_assert_int_eq(count(W2, MSG_UNIT), 1);
    ck_assert_uint_eq(unit_of(W2)->y, c.y + c.height);
    attempt(W2, MSG_PARKED, &b); /* once is enough */
    ck_assert_int_eq(count(W2, MSG_UNIT), 1);
}
END_TEST

START_TEST(a_parked_unit_is_work_again_when_its_top_is_there)
{
    const struct job_worker *w;
    struct msg_unit b;
    struct job *job;

    start(MSG_PART_STATIC, 0, 2);
    job = coord_find_job(f.c, id);
    w = &job->workers[job_worker_find(job, "ws2")];
    b = *unit_of(W2);
    attempt(W2, MSG_PARKED, &b);
    ck_assert(w->parked == 1 && w->in_flight == 0 && w->lines == 0);
    base_line(W1, 0, line_above(b.y));
    ck_assert(w->parked == 0 && w->in_flight == 1 && w->lines > 0);
    finish(W2, &b);
    ck_assert(w->parked == 0 && w->in_flight == 0 && w->lines == 0);
}
END_TEST

START_TEST(while_its_rows_go_to_the_disk_a_worker_has_other_work)
{
    struct msg bye = { .type = MSG_DRAIN, .drain = { "ws1" } };
    struct msg_unit a;

    start(MSG_PART_SCANBAR, 0, 2);
    a = *first_unit_of(W1);
    clear();
    f.slow_disk = true;
    finish(W1, &a);
    ck_assert_int_ge(count(W1, MSG_UNIT), 1);
    a = *first_unit_of(W1);
    say(W1, &bye);
    clear();
    finish(W1, &a);
    ck_assert_int_eq(count(W1, MSG_UNIT), 0);
    ck_assert_int_eq(count(W1, MSG_BYE), 0); /* it may have to send again */
}
END_TEST

START_TEST(a_base_line_reaches_one_that_waits_when_its_link_is_broken)
{
    struct msg_unit a, b;

    start(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, 2);
    a = *unit_of(W1);
    b = *unit_of(W2);
    attempt(W2, MSG_PARKED, &b);
    clear();
    base_line(W2, 0, line_above(b.y)); /* not his to make */
    wait_ms(300);
    ck_assert_int_eq(count(W2, MSG_BASE_LINE), 0);
    base_line(W1, 0, line_above(b.y));
    ck_assert_int_eq(count(W2, MSG_BASE_LINE), 0); /* it comes over the link */
    wait_ms(300);
    ck_assert_int_eq(count(W2, MSG_BASE_LINE), 1); /* it did not */
    result(W1, &a, 0, a.height, true);
    finish(W2, &b);
    ck_assert(f.done);
    ck_assert_int_eq(count(W2, MSG_BASE_LINE), 1);
}
END_TEST

START_TEST(a_base_line_goes_at_once_where_there_can_be_no_link)
{
    struct msg_unit b;

    coord_closed(f.c, f.now_ms, W1, "cut");
    coord_closed(f.c, f.now_ms, W2, "cut");
    join(W1, MSG_ROLE_WORKER, "ws1", "");
    join(W2, MSG_ROLE_WORKER, "ws2", "");
    start(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, 2);
    b = *unit_of(W2);
    attempt(W2, MSG_PARKED, &b);
    base_line(W1, 0, line_above(b.y));
    ck_assert_int_eq(count(W2, MSG_BASE_LINE), 1);
}
END_TEST

START_TEST(a_base_line_that_fits_no_line_ends_the_connection)
{
    struct msg m = { .type = MSG_BASE_LINE,
                     .base_line = { id, 0, 3, 1, WIDTH, 0, 0, 3, density,
                                    pixels } };

    start(MSG_PART_SCANBAR, 0, 2);
    say(W1, &m);
    ck_assert(f.closed[W1]);
}
END_TEST

/* Three times, and the job fails; the rows are not taken. */
START_TEST(a_unit_without_its_base_line_is_done_again)
{
    submit(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, "uniform", 1);
    ready(W1);
    for (int i = 0; i < JOB_MAX_CRASHES; i++) {
        struct msg_unit a = *unit_of(W1);

        ck_assert_uint_eq(a.attempt, i + 1);
        result(W1, &a, 0, a.height, true);
        ck_assert_int_eq(count(W1, MSG_ACK), i + 1);
    }
    ck_assert(f.failed);
    ck_assert_ptr_nonnull(strstr(f.why, "unit 0 came incomplete"));
}
END_TEST

/* --- losses and leaving --- */

START_TEST(a_lost_workers_units_wait_again_the_parked_ones_too)
{
    struct msg_unit b;
    bool again = false;

    start(MSG_PART_SCANBAR, 0, 2);
    b = *first_unit_of(W2);
    facts(W2, line_above(b.y + b.height));
    attempt(W2, MSG_PARKED, &b);
    clear();
    coord_closed(f.c, f.now_ms, W2, "cut");
    carry_out();
    join(W3, MSG_ROLE_WORKER, "ws3", "");
    ready(W3);
    for (int i = 0; i < f.nsaid && !again; i++) {
        const struct msg_unit *u = &f.said[i].m.unit;

        if (f.said[i].conn != W3 || f.said[i].m.type != MSG_UNIT)
            continue;
        again = u->unit == b.unit && u->attempt == 2;
        attempt(W3, MSG_PARKED, u);
    }
    ck_assert(again);
    /* the unit's, and its last line's to the one below */
    ck_assert_int_eq(count(W3, MSG_FACTS), 2);
}
END_TEST

START_TEST(one_that_leaves_gives_up_what_only_waits)
{
    struct msg drain = { .type = MSG_DRAIN, .drain = { "ws2" } };
    struct msg_unit a, b;

    start(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, 2);
    a = *unit_of(W1);
    b = *unit_of(W2);
    say(W2, &drain);
    attempt(W2, MSG_PARKED, &b);
    clear();
    wait_ms(200); /* its facts may be on their way */
    ck_assert_int_eq(count(W2, MSG_REVOKE), 0);
    wait_ms(500);
    ck_assert_int_eq(count(W2, MSG_REVOKE), 1);
    ck_assert_int_eq(count(W2, MSG_BYE), 1);
    ck_assert(f.closed[W2]);
    finish(W1, &a);
    ck_assert_uint_eq(unit_of(W1)->unit, b.unit);
}
END_TEST

START_TEST(rows_that_cross_a_revoke_bring_nothing_back)
{
    struct msg drain = { .type = MSG_DRAIN, .drain = { "ws2" } };
    struct msg_unit a, b;

    start(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, 2);
    a = *unit_of(W1);
    b = *unit_of(W2);
    say(ADMIN, &drain);
    attempt(W2, MSG_PARKED, &b);
    wait_ms(700);
    ck_assert_int_eq(count(W2, MSG_REVOKE), 1);
    result(W2, &b, 0, 1, false); /* its top had just come from a peer */
    ck_assert_int_eq(count(W2, MSG_ACK), 1);
    finish(W1, &a);
    ck_assert_uint_eq(unit_of(W1)->unit, b.unit);
}
END_TEST

/* --- balance --- */

START_TEST(an_idle_worker_gets_half_of_what_another_has_left)
{
    struct msg_unit a, b, c;

    start(MSG_PART_STATIC, 0, 2);
    a = *unit_of(W1);
    b = *unit_of(W2);
    wait_ms(100);
    finish(W1, &a);
    ck_assert_int_eq(count(W2, MSG_SPLIT), 1);
    gave(W1, &b, BAR); /* not his */
    ck_assert_int_eq(count(W1, MSG_UNIT), 1);
    clear();
    gave(W2, &b, 2 * BAR);
    c = *unit_of(W1);
    ck_assert(c.unit == 2 && c.y == b.y + 2 * BAR);
    ck_assert_uint_eq(c.y + c.height, HEIGHT);
    ck_assert_uint_eq(c.flags, 0); /* the giver makes the shared base line */
    ck_assert_str_eq(last(W2, MSG_NEXT_HOLDER)->name, "ws1");
    ck_assert_uint_eq(last(W2, MSG_NEXT_HOLDER)->m.next_holder.line,
                      line_above(c.y));
    facts(W1, line_above(c.y)); /* goes back to the giver */
    ck_assert_int_eq(count(W2, MSG_FACTS), 1);
    b.height = 2 * BAR;
    finish(W2, &b);
    finish(W1, &c);
    ck_assert(f.done);
}
END_TEST

START_TEST(one_that_has_nothing_to_give_is_not_asked_again)
{
    struct msg_unit a, b;

    start(MSG_PART_STATIC, 0, 2);
    a = *unit_of(W1);
    b = *unit_of(W2);
    wait_ms(100);
    finish(W1, &a);
    gave(W2, &b, b.height);
    wait_ms(5000);
    ck_assert_int_eq(count(W2, MSG_SPLIT), 1);
    ck_assert_int_eq(count(W1, MSG_UNIT), 1); /* static makes no twins */
}
END_TEST

/* It had nothing left ahead of the truth; under that there are pixels again
 * that no guess could be sure of. */
START_TEST(one_whose_top_came_may_be_asked_again)
{
    struct msg_unit a, b, c;

    join(W3, MSG_ROLE_WORKER, "ws3", "");
    start(MSG_PART_STATIC, 0, 3);
    a = *unit_of(W1);
    b = *unit_of(W2);
    c = *unit_of(W3);
    wait_ms(100);
    finish(W3, &c);
    ck_assert_int_eq(count(W2, MSG_SPLIT), 1);
    gave(W2, &b, b.height);
    ck_assert_int_eq(count(W1, MSG_SPLIT), 1);
    gave(W1, &a, a.height);
    attempt(W2, MSG_PARKED, &b);
    wait_ms(1000);
    ck_assert_int_eq(count(W2, MSG_SPLIT), 1);
    base_line(W1, 0, line_above(b.y));
    wait_ms(100);
    ck_assert_int_eq(count(W2, MSG_SPLIT), 2);
    gave(W2, &b, BAR);
    ck_assert_uint_eq(unit_of(W3)->y, b.y + BAR);
}
END_TEST

/* It stood still when it was asked, and a twin has begun meanwhile, with all of
 * the unit. */
START_TEST(lines_that_come_after_a_twin_are_not_given)
{
    struct msg_unit a, b, twin;

    start(MSG_PART_STATIC, 0, 2);
    a = *unit_of(W1);
    b = *unit_of(W2);
    wait_ms(100);
    finish(W1, &a);
    ck_assert_int_eq(count(W2, MSG_SPLIT), 1);
    wait_ms(61000);
    twin = *unit_of(W1);
    ck_assert(twin.unit == b.unit && twin.height == b.height);
    gave(W2, &b, BAR);
    ck_assert_int_eq(count(W2, MSG_REVOKE), 1);
    finish(W1, &twin);
    ck_assert(f.done && !f.closed[W1] && !f.closed[W2]);
}
END_TEST

START_TEST(without_balance_nobody_is_asked)
{
    struct msg_unit a;

    start(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, 2);
    a = *unit_of(W1);
    wait_ms(100);
    finish(W1, &a);
    wait_ms(1000);
    ck_assert_int_eq(count(W2, MSG_SPLIT), 0);
}
END_TEST

START_TEST(a_gave_that_fits_no_lines_ends_the_connection)
{
    struct msg_unit a, b;

    start(MSG_PART_STATIC, 0, 2);
    a = *unit_of(W1);
    b = *unit_of(W2);
    gave(W2, &b, BAR); /* was not asked */
    ck_assert(!f.closed[W2]);
    wait_ms(100);
    finish(W1, &a);
    gave(W2, &b, BAR + 1);
    ck_assert(f.closed[W2]);
}
END_TEST

/* --- columns --- */

static void
lend(uint64_t conn, const struct msg_unit *u, uint32_t x, uint32_t n)
{
    struct msg m = { .type = MSG_LOAN,
                     .loan = { id, u->unit, u->attempt, 0,
                               line_above(u->y + u->height), x, n, 20000, 20000,
                               0, 3, 0, density, bitmap, pixels, pixels } };

    say(conn, &m);
}

static void
speak_version(uint8_t version, int workers)
{
    f.version = version;
    for (int i = 0; i < workers; i++) {
        coord_closed(f.c, f.now_ms, (uint64_t)(W1 + i), "again");
        join((uint64_t)(W1 + i), MSG_ROLE_WORKER, NAMES[i], "");
    }
}

/* Of the first regions bars come along, as a worker of version 1 would not
 * understand. */
START_TEST(who_has_time_makes_bars_along_with_lines)
{
    uint8_t version = (uint8_t)_i;

    f.tall = true;
    speak_version(version, 2);
    start(MSG_PART_AUTO, 0, 2);
    for (uint64_t w = W1; w <= W2; w++)
        ck_assert_uint_eq(first_unit_of(w)->flags,
                          version < 2 ? 0 : MSG_UNIT_BARS);
}
END_TEST

/* ws1 is at a line, all else being done, and ws2, and ws3 if it is there, have
 * nothing. */
static void
one_line_left(enum msg_partition kind, int workers, struct msg_unit *a)
{
    speak_version(2, workers);
    start(kind, 0, workers);
    *a = *first_unit_of(W1);
    for (int i = 0; i < f.nsaid; i++) {
        const struct said s = f.said[i];

        if (s.conn == W1 && s.m.type == MSG_SPLIT)
            gave(W1, a, a->height);
        if (s.conn < W1 || s.conn > W3 || s.m.type != MSG_UNIT ||
            s.m.unit.unit == a->unit)
            continue;
        wait_ms(100);
        finish(s.conn, &s.m.unit);
    }
    ck_assert_uint_eq(coord_find_job(f.c, id)->nout, 1);
}

/* What ws2 got of it. */
static struct msg_unit
loan_of(uint64_t conn)
{
    const struct said *s = last(conn, MSG_LOAN);

    ck_assert_ptr_nonnull(s);
    return (struct msg_unit){ .unit = s->m.loan.unit,
                              .attempt = s->m.loan.attempt };
}

/* ws1 lends ws2 the right of its line, all that is left for so many. */
static struct msg_unit
lend_right(int workers, struct msg_unit *a)
{
    one_line_left(MSG_PART_SCANBAR, workers, a);
    lend(W1, a, 6, 10);
    return loan_of(W2);
}

static void
expect_back(uint64_t conn, const struct msg_unit *u, uint32_t x, uint32_t n)
{
    const struct said *s = last(conn, MSG_BACK);

    ck_assert_ptr_nonnull(s);
    ck_assert_uint_eq(s->m.back.attempt, u->attempt);
    ck_assert_uint_eq(s->m.back.line, line_above(u->y + u->height));
    ck_assert(s->m.back.x == x && s->m.back.n == n);
}

/* Those columns come back to ws1, which does them and is done. */
static void
expect_own_again(const struct msg_unit *u)
{
    expect_back(W1, u, 6, 10);
    finish(W1, u);
    ck_assert(f.done);
}

static const enum msg_partition with_loans[] = { MSG_PART_AUTO,
                                                 MSG_PART_SCANBAR,
                                                 MSG_PART_STATIC };

START_TEST(an_idle_worker_is_lent_columns)
{
    struct msg_unit a, b;

    one_line_left(with_loans[_i], 2, &a);
    ck_assert_int_eq(count(W1, MSG_LEND), 1);
    ck_assert_uint_eq(last(W1, MSG_LEND)->m.lend.unit, a.unit);
    ck_assert_uint_gt(last(W1, MSG_LEND)->m.lend.part, 16384);
    clear();
    lend(W1, &a, 6, 10);
    b = loan_of(W2);
    ck_assert(b.unit == a.unit && b.attempt > a.attempt);
    ck_assert_int_eq(count(W2, MSG_UNIT), 0);
    facts(W2, line_above(a.y + a.height));
    ck_assert_int_eq(count(W1, MSG_FACTS), 1);
    facts(W1, line_above(a.y + a.height)); /* no use to it */
    ck_assert_int_eq(count(W2, MSG_FACTS), 0);
    ck_assert_int_eq(count(W1, MSG_BACK), 0);
    attempt(W1, MSG_PARKED, &a); /* nothing else left, and so on */
    paid(W2, &b, 5);
    expect_back(W1, &a, 6, 10);
    ck_assert_int_eq(count(W2, MSG_REVOKE), 0);
    finish(W1, &a);
    ck_assert(f.done && !f.closed[W1] && !f.closed[W2]);
}
END_TEST

/* It is a part of the unit, and what it costs is known from a former run. */
START_TEST(what_was_lent_is_counted_to_its_unit)
{
    struct msg_unit a, b;
    double rays, w1, w2;
    const struct job_unit *u;

    b = lend_right(2, &a);
    w1 = worker_stat("ws1", "rays");
    w2 = worker_stat("ws2", "rays");
    rays = stat_of("totals", "rays");
    paid(W2, &b, 50);
    ck_assert_double_eq(worker_stat("ws2", "rays"), w2 + 50);
    finish(W1, &a); /* with 10 */
    ck_assert(f.done);
    u = &coord_find_job(f.c, id)->units[a.unit];
    ck_assert_uint_eq(u->counts.rays, 60);
    ck_assert_uint_eq(u->counts.faults[0].count, 3);
    ck_assert_uint_eq(u->counts.nan.pixels, 0); /* the lender made those */
    ck_assert_double_lt(u->counts.wall_s, 1000);
    ck_assert_uint_eq(f.kept_rays, 60); /* on the disk, too */
    ck_assert_double_eq(worker_stat("ws1", "rays"), w1 + 10);
    ck_assert_double_eq(stat_of("totals", "rays"), rays + 60);
    ck_assert_double_eq(stat_of("totals", "dropped_rays"), 0);
}
END_TEST

static void
line_costs(uint32_t frame, uint32_t line, uint32_t nlines)
{
    static const uint64_t ns[LINES] = { 1000000000, 2000000000, 500000000 };
    struct msg m = { .type = MSG_LINE_COSTS,
                     .line_costs = { id, frame, line, nlines, ns } };

    say(W1, &m);
}

/* The statistics' line_s; *root is to be released.  NULL: they have none. */
static json_t *
line_stats(json_t **root)
{
    char *text = stats_json(coord_find_job(f.c, id), f.now_ms);

    *root = json_loads(text, 0, NULL);
    free(text);
    return json_object_get(*root, "line_s");
}

/* What all who were at a line spent; of none that the picture does not have. */
START_TEST(what_lines_cost_is_added_up)
{
    static const double want[LINES] = { 1, 3, 2.5, .5 };
    json_t *root, *costs;

    start(MSG_PART_SCANBAR, 0, 2);
    ck_assert_ptr_null(line_stats(&root));
    json_decref(root);
    line_costs(0, 0, 3);
    line_costs(0, 1, 3);
    line_costs(1, 0, 3);
    line_costs(0, LINES - 2, 3);
    line_costs(0, UINT32_MAX, 3);
    costs = line_stats(&root);
    ck_assert_uint_eq(json_array_size(costs), 1);
    costs = json_array_get(costs, 0);
    ck_assert_uint_eq(json_array_size(costs), LINES);
    for (size_t i = 0; i < LINES; i++)
        ck_assert_double_eq(json_number_value(json_array_get(costs, i)),
                            want[i]);
    ck_assert(!f.closed[W1]);
    json_decref(root);
}
END_TEST

/* One of version 1 tells nothing: what is known is not all. */
START_TEST(what_lines_cost_is_not_told_by_half)
{
    json_t *root;

    start(MSG_PART_SCANBAR, 0, 2);
    line_costs(0, 0, LINES);
    ck_assert_ptr_nonnull(line_stats(&root));
    json_decref(root);
    finish(W2, unit_of(W2));
    ck_assert_ptr_null(line_stats(&root));
    json_decref(root);
}
END_TEST

START_TEST(what_was_taken_back_is_in_no_unit)
{
    struct msg_unit a, b;

    b = lend_right(2, &a);
    attempt(W1, MSG_PARKED, &a);
    wait_ms(5000);
    ck_assert_int_eq(count(W2, MSG_REVOKE), 1);
    paid(W2, &b, 50); /* which it had not heard */
    finish(W1, &a);
    ck_assert(f.done);
    ck_assert_uint_eq(coord_find_job(f.c, id)->units[a.unit].counts.rays, 10);
    paid(W2, &b, 7);
    ck_assert_double_eq(stat_of("totals", "dropped_rays"), 57);
    ck_assert_double_eq(stat_of("totals", "nan_pixels"), 0);
}
END_TEST

/* Its PAIDs have said so many rays in all, in so many seconds. */
static void
tally(uint64_t conn, uint64_t rays, double busy_s)
{
    const struct msg m = { .type = MSG_TALLY,
                           .tally = { .job = id,
                                      .busy_s = busy_s,
                                      .paid = { .rays = rays,
                                                .primary_rays = 3,
                                                .cpu_s = (double)rays } } };

    say(conn, &m);
}

/* What it cost is not in the unit, but is not lost either; once. */
START_TEST(what_was_paid_as_the_connection_broke_is_dropped)
{
    struct msg_unit a, b;
    double rays;

    b = lend_right(2, &a);
    tally(W1, 9, 1); /* of an earlier life: its units have that */
    tally(W2, 0, 1);
    paid(W2, &b, 50);
    tally(W2, 50, 2);
    ck_assert_double_eq(stat_of("totals", "dropped_rays"), 0);
    rays = stat_of("totals", "rays");
    coord_closed(f.c, f.now_ms, W2, "cut");
    join(W2, MSG_ROLE_WORKER, "ws2", "127.0.0.1:2");
    for (int i = 0; i < 2; i++) {
        tally(W2, 57, 3);
        ck_assert_double_eq(stat_of("totals", "dropped_rays"), 7);
        ck_assert_double_eq(stat_of("totals", "rays"), rays + 7);
    }
    tally(W2, 0, 0); /* a new child */
    tally(W2, 5, 1);
    ck_assert_double_eq(stat_of("totals", "dropped_rays"), 12);
    finish(W1, &a);
    ck_assert(f.done);
}
END_TEST

START_TEST(nobody_is_asked_for_columns_who_does_not_know_of_them)
{
    struct msg_unit a;

    f.version = 1;
    start(MSG_PART_SCANBAR, 0, 2);
    a = *first_unit_of(W1);
    for (int i = 0; i < f.nsaid; i++) {
        const struct said s = f.said[i];

        if ((s.conn != W1 && s.conn != W2) || s.m.type != MSG_UNIT ||
            s.m.unit.unit == a.unit)
            continue;
        wait_ms(100);
        finish(s.conn, &s.m.unit);
    }
    wait_ms(1000);
    ck_assert_int_eq(count(W1, MSG_LEND), 0);
    finish(W1, &a);
    ck_assert(f.done);
}
END_TEST

START_TEST(what_nobody_takes_goes_back_at_once)
{
    struct msg_unit a;

    one_line_left(MSG_PART_SCANBAR, 2, &a);
    coord_closed(f.c, f.now_ms, W2, "cut");
    clear();
    lend(W1, &a, 6, 10);
    expect_own_again(&a);
}
END_TEST

START_TEST(columns_of_one_that_is_lost_go_back)
{
    struct msg_unit a;

    one_line_left(MSG_PART_SCANBAR, 2, &a);
    lend(W1, &a, 6, 10);
    clear();
    coord_closed(f.c, f.now_ms, W2, "cut");
    carry_out();
    expect_own_again(&a);
}
END_TEST

START_TEST(columns_that_nobody_waits_for_are_not_late)
{
    struct msg_unit a, b;

    b = lend_right(2, &a);
    wait_ms(30000);
    ck_assert_int_eq(count(W2, MSG_REVOKE), 0);
    paid(W2, &b, 5);
    finish(W1, &a);
    ck_assert(f.done);
}
END_TEST

/* LEND and PARKED crossed: it lends once more when its top is there. */
START_TEST(columns_that_are_lent_after_a_wait_are_late_too)
{
    struct msg_unit a, b;

    b = lend_right(3, &a);
    wait_ms(1000);
    attempt(W1, MSG_PARKED, &a);
    wait_ms(100);
    lend(W1, &a, 0, 6);
    ck_assert_int_eq(count(W3, MSG_LOAN), 1);
    paid(W2, &b, 5);
    attempt(W1, MSG_PARKED, &a);
    wait_ms(6000);
    ck_assert_int_eq(count(W3, MSG_REVOKE), 1);
    expect_back(W1, &a, 0, 6);
    finish(W1, &a);
    ck_assert(f.done);
}
END_TEST

START_TEST(columns_of_one_that_is_late_go_back)
{
    struct msg_unit a, b;

    b = lend_right(2, &a);
    clear();
    wait_ms(1000);
    attempt(W1, MSG_PARKED, &a); /* so long for as much */
    wait_ms(200);
    ck_assert_int_eq(count(W2, MSG_REVOKE), 0);
    wait_ms(3000);
    ck_assert_int_eq(count(W2, MSG_REVOKE), 1);
    expect_back(W1, &a, 6, 10);
    clear();
    paid(W2, &b, 5); /* not heard any more */
    ck_assert_int_eq(count(W1, MSG_BACK), 0);
    finish(W1, &a);
    ck_assert(f.done);
}
END_TEST

START_TEST(columns_can_be_lent_on)
{
    struct msg_unit a, b, c;

    b = lend_right(3, &a);
    b.y = a.y;
    b.height = a.height;
    wait_ms(150);
    ck_assert_int_eq(count(W2, MSG_LEND), 1);
    lend(W2, &b, 12, 4);
    c = loan_of(W3);
    clear();
    paid(W2, &b, 5);
    expect_back(W1, &a, 6, 6); /* the rest is ws3's */
    paid(W3, &c, 5);
    expect_back(W1, &a, 12, 4);
    finish(W1, &a);
    ck_assert(f.done);
}
END_TEST

START_TEST(when_the_lender_goes_its_columns_are_dropped)
{
    struct msg tally = { .type = MSG_TALLY,
                         .tally = { .job = id, .dropped = { .rays = 7 } } };
    struct msg_unit a, b;
    double rays;

    one_line_left(MSG_PART_SCANBAR, 2, &a);
    lend(W1, &a, 6, 10);
    facts(W2, line_above(a.y + a.height));
    clear();
    coord_closed(f.c, f.now_ms, W1, "cut");
    carry_out();
    ck_assert_int_eq(count(W2, MSG_REVOKE), 1);
    b = *unit_of(W2);
    ck_assert(b.unit == a.unit && b.y == a.y && b.height == a.height);
    ck_assert_int_eq(count(W2, MSG_FACTS), 1); /* they are kept */
    finish(W2, &b);
    ck_assert(f.done);
    rays = stat_of("totals", "rays");
    say(W2, &tally); /* what it cost, though all is over */
    ck_assert_double_eq(stat_of("totals", "dropped_rays"), 7);
    ck_assert_double_eq(stat_of("totals", "rays"), rays + 7);
}
END_TEST

/* What is wrong with it: columns, flags, densities. */
static const struct {
    uint32_t x, n;
    uint8_t flags, channels;
    uint32_t ndensity;
} wrong[] = { { 12, 5, 0, 3, 0 },
              { 9, 7, 0, 3, 0 },
              { 6, 9, 0, 3, 0 },
              { 6, 10, 0, 4, 0 },
              { 6, 10, MSG_LOAN_LINE, 3, 1 } };

START_TEST(a_loan_that_fits_no_line_ends_the_connection)
{
    struct msg m = { .type = MSG_LOAN,
                     .loan = { .job = id,
                               .x = wrong[_i].x,
                               .n = wrong[_i].n,
                               .flags = wrong[_i].flags,
                               .channels = wrong[_i].channels,
                               .ndensity = wrong[_i].ndensity,
                               .density = density,
                               .wanted = bitmap,
                               .top = pixels,
                               .bottom = pixels } };
    struct msg_unit a, b;

    one_line_left(MSG_PART_SCANBAR, 2, &a);
    m.loan.unit = a.unit;
    m.loan.attempt = a.attempt;
    m.loan.line = line_above(a.y + a.height);
    b = a;
    b.attempt += 7;
    lend(W1, &b, 0, 6); /* of an attempt that is not known */
    ck_assert_int_eq(count(W2, MSG_LOAN), 0);
    expect_back(W1, &b, 0, 6);
    ck_assert(!f.closed[W1]);
    say(W1, &m);
    ck_assert(f.closed[W1]);
    ck_assert_int_eq(count(W2, MSG_LOAN), 0);
    carry_out();
    finish(W2, unit_of(W2)); /* the job goes on */
    ck_assert(f.done && !f.failed);
}
END_TEST

/* --- twins --- */

/* Two at one unit, all else being done: ws1 got it first, ws2 as well when it
 * was late. */
static void
twins(struct msg_unit *a, struct msg_unit *b)
{
    start(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, 2);
    *b = *unit_of(W2);
    finish(W2, b);
    *a = *unit_of(W1);
    wait_ms(61000);
    *b = *unit_of(W2);
    ck_assert(b->flags & MSG_UNIT_TWIN);
    ck_assert_uint_eq(coord_find_job(f.c, id)->nout, 1);
}

START_TEST(the_first_of_twins_whose_rows_come_leads)
{
    struct msg_unit a, b;

    twins(&a, &b);
    ck_assert(a.unit == b.unit && b.attempt == a.attempt + 1);
    ck_assert(b.end == MSG_END_RIGHT && b.height == a.height);
    ck_assert_int_eq(count(W1, MSG_TWIN), 1);
    clear();
    facts(W1, line_above(a.y + a.height));
    facts(W2, line_above(a.y + a.height));
    ck_assert_int_eq(count(W1, MSG_FACTS), 1);
    ck_assert_int_eq(count(W2, MSG_FACTS), 1);
    base_line(W2, 0, line_above(a.y + a.height));
    result(W2, &b, 0, 1, false);
    result(W1, &a, 0, 1, false); /* is forgotten */
    ck_assert_int_eq(count(W1, MSG_ACK), 1);
    result(W1, &a, 1, a.height - 1, true);
    ck_assert_int_eq(count(W1, MSG_ACK), 2);
    ck_assert(!f.done);
    clear();
    result(W2, &b, 1, b.height - 1, true);
    ck_assert_int_eq(count(W1, MSG_REVOKE), 1);
    ck_assert(f.done);
}
END_TEST

START_TEST(when_the_leader_goes_one_that_sent_nothing_goes_on)
{
    struct msg_unit a, b;

    twins(&a, &b);
    result(W2, &b, 0, 2, false);
    coord_closed(f.c, f.now_ms, W2, "cut");
    carry_out();
    ck_assert_int_eq(count(W1, MSG_REVOKE), 0);
    finish(W1, &a);
    ck_assert(f.done);
}
END_TEST

START_TEST(when_the_leader_goes_one_whose_rows_were_dropped_begins_anew)
{
    struct msg_unit a, b;

    twins(&a, &b);
    facts(W2, line_above(a.y + a.height));
    result(W2, &b, 0, 2, false);
    result(W1, &a, 0, 1, false);
    clear();
    coord_closed(f.c, f.now_ms, W2, "cut");
    carry_out();
    ck_assert_int_eq(count(W1, MSG_REVOKE), 1);
    b = *unit_of(W1);
    ck_assert(b.unit == a.unit && b.attempt == a.attempt + 2);
    ck_assert_uint_eq(b.flags & MSG_UNIT_TWIN, 0);
    ck_assert_int_eq(count(W1, MSG_FACTS), 1); /* they are kept */
    finish(W1, &b);
    ck_assert(f.done);
}
END_TEST

START_TEST(a_very_late_unit_gets_a_twin_with_scanbar_too)
{
    start(MSG_PART_SCANBAR, 0, 1);
    f.closed[W2] = true;
    coord_closed(f.c, f.now_ms, W2, "cut");
    join(W3, MSG_ROLE_WORKER, "ws3", "");
    ready(W3);
    for (int i = 0; i < f.nsaid; i++) /* what it gets, and what it gets then */
        if (f.said[i].conn == W3 && f.said[i].m.type == MSG_UNIT)
            attempt(W3, MSG_PARKED, &f.said[i].m.unit);
    ck_assert_int_eq(count(W3, MSG_TWIN), 0);
    clear();
    wait_ms(50000);
    ck_assert_int_eq(count(W3, MSG_UNIT), 0);
    wait_ms(20000);
    ck_assert_int_eq(count(W3, MSG_UNIT), 1);
    ck_assert(unit_of(W3)->flags & MSG_UNIT_TWIN);
    ck_assert_int_eq(count(W1, MSG_TWIN), 1);
}
END_TEST

/* Its child does nothing any more, though radd is there. */
START_TEST(one_that_waited_and_is_stuck_gets_a_twin)
{
    struct msg_unit a, b;

    start(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, 2);
    a = *unit_of(W1);
    b = *unit_of(W2);
    attempt(W2, MSG_PARKED, &b);
    finish(W1, &a); /* it has its base line now */
    clear();
    wait_ms(59000);
    ck_assert_int_eq(count(W1, MSG_UNIT), 0);
    wait_ms(2000);
    ck_assert_uint_eq(unit_of(W1)->unit, b.unit);
    b = *unit_of(W1);
    finish(W1, &b);
    ck_assert(f.done);
}
END_TEST

/* Its child was stopped after its first rows: they count no more once a twin
 * has rows, and what it sends later is dropped. */
START_TEST(a_twin_overtakes_one_that_is_silent)
{
    struct msg_unit a, b, twin;

    start(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, 2);
    a = *unit_of(W1);
    b = *unit_of(W2);
    result(W2, &b, 0, 1, false);
    finish(W1, &a);
    clear();
    wait_ms(61000);
    twin = *unit_of(W1);
    ck_assert_uint_eq(twin.unit, b.unit);
    result(W1, &twin, 0, 1, false);
    result(W2, &b, 1, b.height - 1, true);
    ck_assert(!f.done);
    result(W1, &twin, 1, twin.height - 1, true);
    ck_assert(f.done);
}
END_TEST

/* --- estimates --- */

static void
estimated(uint64_t conn, const struct msg_estimate *m, uint32_t n)
{
    static const struct msg_cost cost[64] = { { 30, 7 }, { 30, 7 } };
    struct msg r = {
        .type = MSG_ESTIMATED,
        .estimated = { id, m->id, n, cost, { .rays = 9, .estimate_rays = 5 } }
    };

    say(conn, &r);
}

START_TEST(an_estimate_comes_before_the_first_unit)
{
    uint32_t chunks = 0;

    submit(MSG_PART_STATIC, 0, "20b", 1);
    ready(W1);
    ck_assert_int_eq(count(W1, MSG_UNIT), 0);
    ck_assert_uint_eq(last(W1, MSG_ESTIMATE)->m.estimate.rays, 20);
    ready(W2);
    f.now_ms += 50;
    for (int w = W1; !last(W1, MSG_UNIT); w = w == W1 ? W2 : W1) {
        struct msg_estimate m = last((uint64_t)w, MSG_ESTIMATE)->m.estimate;

        estimated((uint64_t)w, &m, m.nareas);
        ck_assert_uint_le(++chunks, 2 * LINES);
    }
    ck_assert_uint_gt(chunks, 4);
    ck_assert_int_eq(count(W2, MSG_UNIT), 1);
    /* two areas of each chunk cost something */
    ck_assert_double_eq(stat_of("totals", "estimate_rays"), 5 * chunks);
    ck_assert_double_eq(stat_of("time", "estimate_s"), .05);
}
END_TEST

START_TEST(areas_of_a_lost_or_late_worker_go_to_another)
{
    uint32_t lost;

    submit(MSG_PART_STATIC, 0, "5a", 1);
    ready(W1);
    lost = last(W1, MSG_ESTIMATE)->m.estimate.id;
    coord_closed(f.c, f.now_ms, W1, "cut");
    carry_out();
    ready(W2);
    ck_assert_uint_eq(last(W2, MSG_ESTIMATE)->m.estimate.id, lost);
    join(W3, MSG_ROLE_WORKER, "ws3", "");
    ready(W3);
    for (int i = 0; i < 40; i++) { /* ws3 does all but that one */
        struct msg_estimate m = last(W3, MSG_ESTIMATE)->m.estimate;

        estimated(W3, &m, m.nareas);
    }
    ck_assert_ptr_null(last(W3, MSG_UNIT));
    wait_ms(3000);
    ck_assert_uint_eq(last(W3, MSG_ESTIMATE)->m.estimate.id, lost);
    estimated(W3, &last(W3, MSG_ESTIMATE)->m.estimate,
              last(W3, MSG_ESTIMATE)->m.estimate.nareas);
    ck_assert_ptr_nonnull(last(W3, MSG_UNIT));
}
END_TEST

START_TEST(an_estimate_of_other_areas_ends_the_connection)
{
    struct msg_estimate m;

    submit(MSG_PART_STATIC, 0, "5a", 1);
    ready(W1);
    m = last(W1, MSG_ESTIMATE)->m.estimate;
    estimated(W1, &m, m.nareas + 1);
    ck_assert(f.closed[W1]);
}
END_TEST

static void
child_dies(uint64_t conn)
{
    struct msg m = { .type = MSG_LOST, .lost = { id, "signal 11", 0, NULL } };

    say(conn, &m);
    ready(conn);
}

/* The unit that has the pixel will be told from the others. */
START_TEST(an_estimate_that_children_die_of_is_given_up)
{
    submit(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, "5a", 1);
    ready(W1);
    child_dies(W1);
    ck_assert_int_eq(count(W1, MSG_UNIT), 0);
    ck_assert_int_eq(count(W1, MSG_ESTIMATE), 2);
    child_dies(W1);
    ck_assert_int_eq(count(W1, MSG_UNIT), 1);
    ck_assert_int_eq(count(W1, MSG_ESTIMATE), 2);
}
END_TEST

START_TEST(an_estimate_that_nobody_asked_for_is_ignored)
{
    struct msg_estimate m = { .id = UINT32_MAX, .nareas = 1 };

    submit(MSG_PART_STATIC, 0, "5a", 1);
    ready(W1);
    ready(W2);
    for (int i = 0; i < 40; i++) { /* ws1 does all but what ws2 has */
        struct msg_estimate k = last(W1, MSG_ESTIMATE)->m.estimate;

        estimated(W1, &k, k.nareas);
    }
    estimated(W1, &m, 1); /* 1 more than none is its number */
    ck_assert(!f.closed[W1]);
    ck_assert_ptr_null(last(W1, MSG_UNIT));
}
END_TEST

/* --- speeds --- */

START_TEST(static_weighs_workers_by_what_earlier_jobs_showed)
{
    struct msg_unit a, b;
    struct msg tally = { .type = MSG_TALLY, .tally = { .job = id } };

    start(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, 2);
    a = *unit_of(W1);
    b = *unit_of(W2);
    ck_assert_uint_ge(a.height, HEIGHT / 2 - BAR);
    wait_ms(1000);
    tally.tally.rays_under_way = 1000;
    say(W1, &tally);
    tally.tally.rays_under_way = 4000;
    say(W2, &tally);
    wait_ms(200);
    ck_assert_double_gt(coord_find_job(f.c, id)->workers[1].speed,
                        3 * coord_find_job(f.c, id)->workers[0].speed);
    tally.type = MSG_CANCEL;
    tally.cancel.job = id;
    say(ANA, &tally);
    clear();
    for (struct coord_worker *w = f.c->workers; w; w = w->next)
        ck_assert_double_lt(w->relative, 1.5);
    ck_assert_double_gt(f.c->workers->next->relative,
                        1.5 * f.c->workers->relative);
    (void)b;
}
END_TEST

int
main(void)
{
    Suite *s = suite_create("handoff");
    TCase *tc = tcase_create("handoff");

    tcase_add_checked_fixture(tc, set_up, tear_down);
    tcase_add_loop_test(tc, workers_begin_apart_while_records_are_few, 0, 2);
    tcase_add_test(tc, lines_go_out_with_what_is_known_of_them);
    tcase_add_loop_test(tc, who_has_time_makes_bars_along_with_lines, 1, 3);
    tcase_add_test(tc,
                   a_line_that_the_one_below_makes_is_kept_till_it_is_there);
    tcase_add_test(tc, a_kept_line_is_free_when_its_maker_has_no_more_to_do);
    tcase_add_test(tc, a_kept_line_is_free_when_its_maker_is_lost);
    tcase_add_test(tc, a_kept_line_is_free_when_its_maker_is_stuck);
    tcase_add_test(tc, a_line_is_at_hand_until_few_are_left);
    tcase_add_test(tc, both_sides_hear_who_waits_for_a_base_line);
    tcase_add_test(tc, a_single_worker_has_no_links_and_whole_frames);
    tcase_add_test(tc, what_was_to_be_a_drained_workers_goes_to_others);
    tcase_add_test(tc, what_was_to_be_a_stopped_workers_goes_to_others);
    tcase_add_test(tc, one_that_is_drained_before_the_layout_has_no_part);
    tcase_add_test(tc, facts_go_to_whoever_has_the_line_now_and_later);
    tcase_add_test(tc, facts_that_fit_no_line_end_the_connection);
    tcase_add_test(tc, a_parked_unit_takes_no_room);
    tcase_add_test(tc, a_parked_unit_is_work_again_when_its_top_is_there);
    tcase_add_test(tc, while_its_rows_go_to_the_disk_a_worker_has_other_work);
    tcase_add_test(tc,
                   a_base_line_reaches_one_that_waits_when_its_link_is_broken);
    tcase_add_test(tc, a_base_line_goes_at_once_where_there_can_be_no_link);
    tcase_add_test(tc, a_base_line_that_fits_no_line_ends_the_connection);
    tcase_add_test(tc, a_unit_without_its_base_line_is_done_again);
    tcase_add_test(tc, a_lost_workers_units_wait_again_the_parked_ones_too);
    tcase_add_test(tc, one_that_leaves_gives_up_what_only_waits);
    tcase_add_test(tc, rows_that_cross_a_revoke_bring_nothing_back);
    tcase_add_test(tc, an_idle_worker_gets_half_of_what_another_has_left);
    tcase_add_test(tc, one_that_has_nothing_to_give_is_not_asked_again);
    tcase_add_test(tc, one_whose_top_came_may_be_asked_again);
    tcase_add_test(tc, lines_that_come_after_a_twin_are_not_given);
    tcase_add_test(tc, without_balance_nobody_is_asked);
    tcase_add_test(tc, a_gave_that_fits_no_lines_ends_the_connection);
    tcase_add_test(tc, the_first_of_twins_whose_rows_come_leads);
    tcase_add_loop_test(tc, an_idle_worker_is_lent_columns, 0,
                        N_ELEM(with_loans));
    tcase_add_test(tc, nobody_is_asked_for_columns_who_does_not_know_of_them);
    tcase_add_test(tc, what_nobody_takes_goes_back_at_once);
    tcase_add_test(tc, what_was_lent_is_counted_to_its_unit);
    tcase_add_test(tc, what_lines_cost_is_added_up);
    tcase_add_test(tc, what_lines_cost_is_not_told_by_half);
    tcase_add_test(tc, what_was_taken_back_is_in_no_unit);
    tcase_add_test(tc, what_was_paid_as_the_connection_broke_is_dropped);
    tcase_add_test(tc, columns_of_one_that_is_lost_go_back);
    tcase_add_test(tc, columns_that_nobody_waits_for_are_not_late);
    tcase_add_test(tc, columns_that_are_lent_after_a_wait_are_late_too);
    tcase_add_test(tc, columns_of_one_that_is_late_go_back);
    tcase_add_test(tc, columns_can_be_lent_on);
    tcase_add_test(tc, when_the_lender_goes_its_columns_are_dropped);
    tcase_add_loop_test(tc, a_loan_that_fits_no_line_ends_the_connection, 0,
                        N_ELEM(wrong));
    tcase_add_test(tc, when_the_leader_goes_one_that_sent_nothing_goes_on);
    tcase_add_test(
        tc, when_the_leader_goes_one_whose_rows_were_dropped_begins_anew);
    tcase_add_test(tc, a_very_late_unit_gets_a_twin_with_scanbar_too);
    tcase_add_test(tc, one_that_waited_and_is_stuck_gets_a_twin);
    tcase_add_test(tc, a_twin_overtakes_one_that_is_silent);
    tcase_add_test(tc, an_estimate_comes_before_the_first_unit);
    tcase_add_test(tc, areas_of_a_lost_or_late_worker_go_to_another);
    tcase_add_test(tc, an_estimate_of_other_areas_ends_the_connection);
    tcase_add_test(tc, an_estimate_that_children_die_of_is_given_up);
    tcase_add_test(tc, an_estimate_that_nobody_asked_for_is_ignored);
    tcase_add_test(tc, static_weighs_workers_by_what_earlier_jobs_showed);
    suite_add_tcase(s, tc);
    return unit_run(s);
}
