/* check_coord.c - the coordinator's answers, one at a time
 *
 * What it does under accidents is tested by sim/; here are the refusals, the
 * roles, and the order in which jobs are served. */
#include "config.h"

#include "coord.h"
#include "frame.h"
#include "sched.h"
#include "stats.h"
#include "unit.h"

#include "picture/hdr.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

enum { WORKER = 1, ANA, BOB, ADMIN, SECOND };

static const struct msg_frame frame = { 0, 8, 8, "" };
static const uint8_t job_a[MSG_JOB] = { 0xaa }, job_b[MSG_JOB] = { 0xbb };
static const uint8_t hash[MSG_HASH] = { 1 };
static const uint8_t pixels[8 * 8 * 12];

enum { CONNS = 300 };

struct fixture {
    struct coord *c;
    uint64_t now_ms;
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
    int nan_logs;
    char nan_log[80];
    int differ_logs; /* of duplicates */
    int hang_logs;
    int exclude_logs;
    int break_logs, unlogged; /* of connections that it closed */
    unsigned version[CONNS];
    int peers[CONNS]; /* JOB_PEERS that came */
    int seeds[CONNS]; /* SEEDs, before any UNIT of theirs */
    struct msg_seed seed[CONNS];
    uint16_t peer_version[CONNS];
    bool stuck;        /* nothing gets to the disk */
    uint64_t settling; /* who is to hear when that is over; and of what */
    uint32_t settling_what;
};

static bool
has_file(void *arg, const uint8_t *h)
{
    (void)h;
    return ((struct fixture *)arg)->have;
}

static void
no_random(void *arg, void *buf, size_t n)
{
    (void)arg;
    memset(buf, 1, n);
}

static void
sent(struct fixture *f, const struct action *a)
{
    struct msg *m = &f->last[a->conn];
    struct msg_header h;
    struct wire_out *b = &f->bytes[a->conn];

    ck_assert(!f->closed[a->conn]);
    b->len = 0;
    wire_put_bytes(b, a->bytes, a->len);
    h.type = (uint16_t)(b->buf[4] << 8 | b->buf[5]);
    ck_assert_int_eq(msg_unpack(m, h.type, b->buf[11], b->buf + MSG_HEADER,
                                b->len - MSG_HEADER, NULL),
                     0);
    f->sent[a->conn]++;
    if (m->type == MSG_UNIT) {
        f->units[a->conn]++;
        f->unit_job = m->unit.job[0];
    }
    if (m->type == MSG_SEED) {
        f->seeds[a->conn] += f->units[a->conn] == 0;
        f->seed[a->conn] = m->seed;
    }
    if (m->type == MSG_PROGRESS)
        f->progress = m->progress;
    if (m->type == MSG_JOB_PEERS) {
        f->peers[a->conn]++;
        f->peer_version[a->conn] = m->job_peers.peers[0].version;
    }
}

static void
carry_out(struct fixture *f)
{
    struct action_list *l = coord_actions(f->c);

    for (size_t i = 0; i < l->n; i++) {
        struct action a = l->v[i];

        if (a.type == ACT_SEND)
            sent(f, &a);
        else if (a.type == ACT_SESSION)
            f->version[a.conn] = a.version;
        else if (a.type == ACT_CLOSE)
            f->closed[a.conn] = true;
        else if (a.type == ACT_SETTLE && f->stuck) {
            f->settling = a.conn;
            f->settling_what = a.request;
        } else if (a.type == ACT_SETTLE)
            coord_settled(f->c, f->now_ms, a.conn, a.request);
        else if (a.type == ACT_JOB_OPEN && !f->stuck)
            coord_job_opened(f->c, f->now_ms, a.job, 0, NULL);
        else if (a.type == ACT_PUT_ROWS) {
            f->rows = a.rows;
            if (a.rows.len <= sizeof f->code)
                memcpy(f->code, a.rows.pixels, a.rows.len);
            coord_rows_stored(f->c, f->now_ms, &a.rows, 0, NULL);
        } else if (a.type == ACT_WRITE_PICTURE)
            coord_picture_written(f->c, f->now_ms, a.job, a.frame, 0, NULL);
        else if (a.type == ACT_LOG && strstr(a.text, "no numbers"))
            snprintf(f->nan_log, sizeof f->nan_log, "%d %s", ++f->nan_logs,
                     strstr(a.text, "pixels="));
    }
    for (size_t i = 0; i < l->n; i++)
        if (l->v[i].type == ACT_LOG) {
            f->differ_logs += !!strstr(l->v[i].text, "duplicate differs");
            f->hang_logs += !!strstr(l->v[i].text, "worker hangs");
            f->exclude_logs += !!strstr(l->v[i].text, "worker excluded");
            f->break_logs += !!strstr(l->v[i].text, "connection closed");
            sscanf(l->v[i].text, "connections closed and not logged n=%d",
                   &f->unlogged);
        }
    ck_assert(!l->failed);
    actions_clear(l);
}

static void
wait_s(struct fixture *f, unsigned s)
{
    for (unsigned i = 0; i < 10 * s; i++) {
        f->now_ms += 100;
        coord_tick(f->c, f->now_ms);
        carry_out(f);
    }
}

static void
say(struct fixture *f, uint64_t conn, const struct msg *m)
{
    coord_message(f->c, ++f->now_ms, conn, m);
    carry_out(f);
}

static void
join(struct fixture *f, uint64_t conn, unsigned role, const char *name,
     const char *owner)
{
    struct coord_peer peer = { "test", owner, 14, NULL };
    struct msg m = { .type = MSG_HELLO,
                     .hello = { MSG_VERSION_MIN, MSG_VERSION, (uint8_t)role,
                                name, "t", "", 2, 0 } };

    coord_opened(f->c, f->now_ms, conn, &peer);
    say(f, conn, &m);
}

static uint32_t submit_flags; /* of jobs that are submitted from now on */

/* A SUBMIT of the usual job of one file and one frame; what else it has is for
 * the caller to set. */
static struct msg
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

static void
submit_with(struct fixture *f, uint64_t conn, const uint8_t *job, int priority,
            uint32_t windows, uint32_t flags)
{
    struct msg m = usual_submit(job);

    m.request = 5;
    m.submit.priority = priority;
    m.submit.flags = flags | submit_flags;
    m.submit.partition = MSG_PART_WINDOW;
    m.submit.windows = windows;
    say(f, conn, &m);
}

static void
submit(struct fixture *f, uint64_t conn, const uint8_t *job, int priority)
{
    submit_with(f, conn, job, priority, 4, 0);
}

static void
ready(struct fixture *f, uint64_t conn, const uint8_t *job)
{
    struct msg m = { .type = MSG_READY, .ready = { job, .1, 7, 2 } };

    say(f, conn, &m);
}

static void
result(struct fixture *f, uint64_t conn, const uint8_t *job, uint32_t unit,
       uint32_t attempt)
{
    struct msg m = {
        .type = MSG_RESULT,
        .result = { job, unit, attempt, 0, 4, 4, 3, 1, { .rays = 10 }, pixels }
    };

    say(f, conn, &m);
}

static void
about(struct fixture *f, uint64_t conn, uint16_t type, const uint8_t *job)
{
    struct msg m = { .type = type, .request = 6, .cancel = { job } };

    say(f, conn, &m);
}

static struct fixture f;

static void
set_up_coord(bool keeps)
{
    struct coord_env env = { .has_file = has_file,
                             .random = no_random,
                             .arg = &f,
                             .program = "radcoord",
                             .epoch = 1,
                             .keeps = keeps };

    memset(&f, 0, sizeof f);
    f.c = coord_new(&env);
    f.now_ms = 1;
    f.have = true;
    for (int i = 0; i < CONNS; i++)
        wire_out_init(&f.bytes[i], MSG_FRAME_MAX);
    join(&f, WORKER, MSG_ROLE_WORKER, "ws1", "daemon");
    join(&f, ANA, MSG_ROLE_USER, "", "ana");
    join(&f, BOB, MSG_ROLE_USER, "", "bob");
    join(&f, ADMIN, MSG_ROLE_ADMIN, "", "root");
}

static void
set_up(void)
{
    set_up_coord(false);
}

static void
tear_down(void)
{
    coord_free(f.c);
    for (int i = 0; i < CONNS; i++) {
        wire_out_release(&f.bytes[i]);
        msg_release(&f.last[i]);
    }
}

START_TEST(pixels_that_are_no_numbers_are_told_once_with_the_first)
{
    static const uint32_t order[] = { 1, 0, 3, 2 };
    struct msg m = { .type = MSG_RESULT,
                     .result = { job_a, 0, 1, 0, 4, 4, 3, 1, { 0 }, pixels } };

    submit(&f, ANA, job_a, 0);
    ready(&f, WORKER, job_a);
    for (int i = 0; i < 4; i++) {
        m.result.unit = order[i];
        m.result.counts.nan = (struct msg_nan){ order[i], 0, 5, 9 - order[i] };
        say(&f, WORKER, &m);
    }
    ck_assert_int_eq(f.last[ANA].type, MSG_DONE);
    ck_assert_str_eq(f.nan_log, "1 pixels=6 frame=0 x=5 y=6");
    ck_assert_uint_eq(f.progress.nan.pixels, 6);
    ck_assert_uint_eq(f.progress.nan.y, 6);
}
END_TEST

/* --- every job can be cancelled, and who does hears of it --- */

static void
disk_is_full(void)
{
    f.stuck = true;
    coord_fullness(f.c, f.now_ms, true, "cannot write 'x'");
    carry_out(&f);
}

static void
disk_has_room(void)
{
    f.stuck = false;
    coord_fullness(f.c, f.now_ms, false, "");
    if (f.settling)
        coord_settled(f.c, f.now_ms, f.settling, f.settling_what);
    carry_out(&f);
}

static void
be_begun(void)
{
    submit(&f, ANA, job_a, 0);
    ready(&f, WORKER, job_a);
    result(&f, WORKER, job_a, 0, 1);
}

static void
be_without_files(void)
{
    f.have = false;
    submit(&f, ANA, job_a, 0);
}

static void
be_held(void)
{
    disk_is_full();
    submit(&f, ANA, job_a, 0);
}

static void
be_waiting(void)
{
    submit(&f, ANA, job_a, 0);
}

static void
be_paused(void)
{
    be_begun();
    about(&f, ANA, MSG_PAUSE, job_a);
}

static void
be_held_under_way(void)
{
    be_begun();
    disk_is_full();
}

static void
be_held_and_paused(void)
{
    be_paused();
    disk_is_full();
}

static void
be_done(void)
{
    be_begun();
    for (uint32_t i = 1; i < 4; i++)
        result(&f, WORKER, job_a, i, 1);
    ck_assert_int_eq(f.last[ANA].type, MSG_DONE);
}

static void
be_cancelled(void)
{
    be_begun();
    about(&f, ANA, MSG_CANCEL, job_a);
}

static void (*const states[])(void) = {
    be_without_files,   be_held,   be_waiting,
    be_begun,           be_paused, be_held_under_way,
    be_held_and_paused, be_done,   be_cancelled,
};

START_TEST(cancel_is_answered_whatever_the_job_is_at)
{
    unsigned before;

    tear_down();
    set_up_coord(_i % 2);
    states[_i / 2]();
    before = f.sent[ADMIN];
    about(&f, ADMIN, MSG_CANCEL, job_a);
    if (f.settling == 0) {
        ck_assert_uint_eq(f.sent[ADMIN], before + 1);
        ck_assert_int_eq(f.last[ADMIN].type, MSG_ANSWER);
    } else { /* the disk gets its time to make room */
        wait_s(&f, 2);
        ck_assert_uint_eq(f.sent[ADMIN], before);
        wait_s(&f, 2);
        ck_assert_uint_eq(f.sent[ADMIN], before + 1);
        ck_assert_int_eq(f.last[ADMIN].type, MSG_FAILED);
        ck_assert_int_eq(f.last[ADMIN].failed.status, EX_TEMPFAIL);
        disk_has_room();
        wait_s(&f, 2);
    }
    ck_assert_uint_eq(f.last[ADMIN].request, 6);
    ck_assert_uint_eq(f.sent[ADMIN], before + 1); /* once */
    ck_assert(job_over(coord_find_job(f.c, job_a)));
}
END_TEST

/* As where the job itself waits for room. */
START_TEST(an_answer_comes_as_soon_as_there_is_room)
{
    tear_down();
    set_up_coord(true);
    be_held();
    about(&f, ADMIN, MSG_CANCEL, job_a);
    wait_s(&f, 1);
    disk_has_room();
    ck_assert_int_eq(f.last[ADMIN].type, MSG_ANSWER);
}
END_TEST

static const struct {
    uint8_t partition;
    uint32_t flags, started; /* of the SUBMIT and of the JOB_START */
} codings[] = {
    { MSG_PART_AUTO, 0, MSG_JOB_CODED },
    { MSG_PART_STATIC, MSG_JOB_SHARE, MSG_JOB_SHARE | MSG_JOB_CODED },
    { MSG_PART_WINDOW, MSG_JOB_CODED, MSG_JOB_CODED },
    { MSG_PART_AUTO, MSG_JOB_DEPTH | MSG_JOB_CODED, MSG_JOB_DEPTH },
};

START_TEST(rows_come_coded_unless_distances_do)
{
    struct msg m = usual_submit(job_a);

    m.submit.estimate = "uniform";
    m.submit.flags = codings[_i].flags;
    m.submit.partition = codings[_i].partition;
    say(&f, ANA, &m);
    ck_assert_int_eq(f.last[WORKER].type, MSG_JOB_START);
    ck_assert_uint_eq(f.last[WORKER].job_start.flags, codings[_i].started);
}
END_TEST

static const struct {
    const char *code;
    size_t len;
    uint32_t rows;
    uint8_t channels;
    bool taken;
} coded_rows[] = {
    /* eight columns, one component after the other */
    { "\2\2\0\10\210\1\210\2\210\3\210\4", 12, 1, 1, true },
    { "\2\2\0\10\210\1\210\2\210\3\210\4", 12, 2, 1, false },
    { "\2\2\0\10\210\1\210\2\210\3\210\4\0", 13, 1, 1, false },
    { "\2\2\0\10\210\1\210\2\210\3\210", 11, 1, 1, false },
    { "\2\2\0\7\207\1\207\2\207\3\207\4", 12, 1, 1, false },
    /* floats are coded here; they have no distance */
    { NULL, 0, 1, 3, true },
    { NULL, 0, 1, 4, false },
};

START_TEST(coded_rows_that_are_none_end_the_connection)
{
    struct msg m = usual_submit(job_a);
    struct msg r = { .type = MSG_RESULT,
                     .result = { job_a, 0, 1, 0, coded_rows[_i].rows, 8,
                                 coded_rows[_i].channels } };

    m.submit.params = "-ps 1";
    m.submit.estimate = "uniform";
    m.submit.partition = MSG_PART_AUTO;
    say(&f, ANA, &m);
    ready(&f, WORKER, job_a);
    ck_assert_uint_gt(f.units[WORKER], 0);
    r.result.pixels =
        coded_rows[_i].code ? (const uint8_t *)coded_rows[_i].code : pixels;
    r.result.len = coded_rows[_i].len;
    say(&f, WORKER, &r);
    ck_assert(f.closed[WORKER] == !coded_rows[_i].taken);
    ck_assert(!coded_rows[_i].taken || f.last[WORKER].type == MSG_ACK);
}
END_TEST

/* So the store has one kind of rows, whoever made them. */
START_TEST(rows_of_version_1_are_coded_here)
{
    float row[4 * 4 * 3];
    uint8_t bytes[sizeof row], want[4 * 4 * 4];
    struct msg m = { .type = MSG_RESULT,
                     .result = {
                         job_a, 0, 1, 0, 4, 4, 3, 1, { .rays = 10 }, bytes } };

    for (int i = 0; i < N_ELEM(row); i++)
        row[i] = 1 / (float)(i + 3);
    wire_floats_put(bytes, row, N_ELEM(row));
    for (int i = 0; i < 16; i++) /* so short a row is flat */
        rad_rgbe(rad_rgb(row[3 * i], row[3 * i + 1], row[3 * i + 2]),
                 want + 4 * (ptrdiff_t)i);
    submit(&f, ANA, job_a, 0);
    ready(&f, WORKER, job_a);
    say(&f, WORKER, &m);
    ck_assert_uint_eq(f.rows.channels, 1);
    ck_assert_uint_eq(f.rows.len, sizeof want);
    ck_assert_mem_eq(f.code, want, sizeof want);
}
END_TEST

static void
tally(double busy_s, double wait_s, uint64_t rays)
{
    struct msg m = { .type = MSG_TALLY,
                     .tally = { .job = job_a,
                                .busy_s = busy_s,
                                .wait_base_line_s = wait_s,
                                .rays_under_way = rays } };

    say(&f, WORKER, &m);
}

/* The number of the first worker's statistics. */
static double
worker_stat(const char *key)
{
    char *text = stats_json(coord_find_job(f.c, job_a), f.now_ms);
    json_t *root = json_loads(text, 0, NULL);
    json_t *w = json_array_get(json_object_get(root, "workers"), 0);
    double v = json_number_value(json_object_get(w, key));

    json_decref(root);
    free(text);
    return v;
}

START_TEST(waits_for_the_line_above_are_summed_over_children)
{
    submit(&f, ANA, job_a, 0);
    ready(&f, WORKER, job_a);
    tally(8, 2.5, 0);
    ck_assert_double_eq(worker_stat("wait_base_line_s"), 2.5);
    ck_assert_double_eq(worker_stat("busy_s"), 5.5);
    tally(1, .25, 0); /* less than before: another child's */
    ck_assert_double_eq(worker_stat("wait_base_line_s"), 2.75);
    ck_assert_double_eq(worker_stat("busy_s"), 6.25);
}
END_TEST

static uint64_t
rays_told(void)
{
    f.now_ms += 1000;
    coord_tick(f.c, f.now_ms);
    carry_out(&f);
    return f.progress.rays;
}

START_TEST(rays_under_way_are_told_and_never_fewer)
{
    submit(&f, ANA, job_a, 0);
    ready(&f, WORKER, job_a);
    tally(1, 0, 7);
    ck_assert_uint_eq(rays_told(), 7);
    tally(1, 0, 3); /* seven of a unit whose RESULT is on its way */
    ck_assert_uint_eq(rays_told(), 7);
    result(&f, WORKER, job_a, 0, 1); /* ten, and three under way */
    ck_assert_uint_eq(rays_told(), 13);
    for (uint32_t u = 1; u < 4; u++)
        result(&f, WORKER, job_a, u, 1);
    ck_assert_uint_eq(f.progress.rays, 40);
}
END_TEST

START_TEST(a_job_goes_from_submit_to_done)
{
    submit(&f, ANA, job_a, 0);
    ck_assert_int_eq(f.last[ANA].type, MSG_ACCEPT);
    ck_assert_int_eq(f.last[WORKER].type, MSG_JOB_START);
    ready(&f, WORKER, job_a);
    /* two threads, and with two left nothing ahead */
    ck_assert_uint_eq(f.units[WORKER], 2);
    for (uint32_t u = 0; u < 4; u++)
        result(&f, WORKER, job_a, u, 1);
    ck_assert_int_eq(f.last[ANA].type, MSG_DONE);
    ck_assert_int_eq(f.last[WORKER].type, MSG_JOB_END);
}
END_TEST

/* To whoever waits for the job that wants them, and to nobody else. */
START_TEST(records_go_to_the_radsubmit_that_wants_them)
{
    struct msg m = { .type = MSG_RECORDS, .records = { job_a, 1, hash, 7 } };
    unsigned to_ana, to_bob;

    submit(&f, ANA, job_a, 0);
    submit_flags = MSG_JOB_RECORDS;
    submit(&f, BOB, job_b, 0);
    submit_flags = 0;
    ready(&f, WORKER, job_a);
    ready(&f, WORKER, job_b);
    to_ana = f.sent[ANA];
    to_bob = f.sent[BOB];
    say(&f, WORKER, &m);
    m.records.job = hash; /* of no job */
    say(&f, WORKER, &m);
    ck_assert_uint_eq(f.sent[BOB], to_bob);
    m.records.job = job_b;
    say(&f, WORKER, &m);
    ck_assert_uint_eq(f.sent[ANA], to_ana);
    ck_assert_uint_eq(f.sent[BOB], to_bob + 1);
    ck_assert_int_eq(f.last[BOB].type, MSG_RECORDS);
    ck_assert_uint_eq(f.last[BOB].request, 5);
    ck_assert_mem_eq(f.last[BOB].records.job, job_b, MSG_JOB);
    ck_assert_uint_eq(f.last[BOB].records.len, 7);
    ck_assert_mem_eq(f.last[BOB].records.data, hash, 7);
}
END_TEST

START_TEST(a_job_waits_for_its_files)
{
    f.have = false;
    submit(&f, ANA, job_a, 0);
    ck_assert_int_eq(f.last[ANA].type, MSG_WELCOME);
    f.have = true;
    coord_file_stored(f.c, f.now_ms, ANA, hash);
    carry_out(&f);
    ck_assert_int_eq(f.last[ANA].type, MSG_ACCEPT);
}
END_TEST

START_TEST(the_same_id_again_attaches)
{
    submit(&f, ANA, job_a, 0);
    submit(&f, ANA, job_a, 0);
    ck_assert_int_eq(f.last[ANA].type, MSG_ACCEPT);
    ck_assert_uint_eq(f.last[ANA].accept.again, 1);
    submit(&f, BOB, job_a, 0); /* somebody else's */
    ck_assert_int_eq(f.last[BOB].type, MSG_FAILED);
    ck_assert_int_eq(f.last[BOB].failed.status, EX_NOPERM);
}
END_TEST

START_TEST(only_owner_and_admin_steer_a_job)
{
    static const uint16_t types[] = { MSG_PAUSE, MSG_RESUME, MSG_CANCEL };

    submit(&f, ANA, job_a, 0);
    for (int i = 0; i < N_ELEM(types); i++) {
        about(&f, BOB, types[i], job_a);
        ck_assert_int_eq(f.last[BOB].failed.status, EX_NOPERM);
    }
    about(&f, ADMIN, MSG_PAUSE, job_a);
    ck_assert_int_eq(f.last[ADMIN].type, MSG_ANSWER);
    about(&f, ADMIN, MSG_CANCEL, job_b);
    ck_assert_int_eq(f.last[ADMIN].failed.status, EX_NOINPUT);
    about(&f, ADMIN, MSG_CANCEL, job_a);
    ck_assert_int_eq(f.last[ANA].type, MSG_FAILED);
    ck_assert_str_eq(f.last[ANA].failed.text, "cancelled");
}
END_TEST

START_TEST(a_paused_job_gets_no_units)
{
    submit(&f, ANA, job_a, 0);
    about(&f, ANA, MSG_PAUSE, job_a);
    ready(&f, WORKER, job_a);
    ck_assert_uint_eq(f.units[WORKER], 0);
    about(&f, ANA, MSG_RESUME, job_a);
    ck_assert_uint_eq(f.units[WORKER], 2);
}
END_TEST

START_TEST(a_drained_worker_gets_nothing_new)
{
    struct msg m = { .type = MSG_DRAIN, .drain = { "ws1" } };

    say(&f, ADMIN, &m);
    submit(&f, ANA, job_a, 0);
    ck_assert_int_eq(f.last[WORKER].type, MSG_WELCOME);
    m.type = MSG_UNDRAIN;
    say(&f, ADMIN, &m);
    ck_assert_int_eq(f.last[WORKER].type, MSG_JOB_START);
}
END_TEST

START_TEST(a_worker_that_leaves_is_let_go_when_it_is_empty)
{
    struct msg m = { .type = MSG_DRAIN, .drain = { "ws1" } };

    submit(&f, ANA, job_a, 0);
    ready(&f, WORKER, job_a);
    say(&f, WORKER, &m);
    for (uint32_t u = 0; u < 2; u++) {
        ck_assert(!f.closed[WORKER]);
        result(&f, WORKER, job_a, u, 1);
    }
    ck_assert_int_eq(f.last[WORKER].type, MSG_BYE);
    ck_assert(f.closed[WORKER]);
    ck_assert_uint_eq(f.units[WORKER], 2);
}
END_TEST

START_TEST(higher_priority_goes_first)
{
    submit(&f, ANA, job_a, 0);
    ready(&f, WORKER, job_a);
    submit(&f, BOB, job_b, 1);
    ready(&f, WORKER, job_b);
    result(&f, WORKER, job_a, 0, 1);
    ck_assert_uint_eq(f.unit_job, 0xbb);
}
END_TEST

START_TEST(owners_share_the_workers)
{
    submit(&f, ANA, job_a, 0);
    submit(&f, BOB, job_b, 0);
    join(&f, SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    ready(&f, WORKER, job_a);
    ck_assert_uint_eq(f.unit_job, 0xaa);
    ready(&f, WORKER, job_b);
    ready(&f, SECOND, job_a);
    ready(&f, SECOND, job_b);
    ck_assert_uint_eq(f.unit_job, 0xaa); /* while it loads bob's */
    ck_assert_int_eq(f.last[SECOND].type, MSG_UNIT);
    result(&f, SECOND, job_a, f.last[SECOND].unit.unit, 1);
    /* ana's is older, but she has more threads at work */
    ck_assert_uint_eq(f.unit_job, 0xbb);
}
END_TEST

START_TEST(priority_goes_before_fairness)
{
    submit(&f, ANA, job_a, 1);
    submit(&f, BOB, job_b, 0);
    join(&f, SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    ready(&f, WORKER, job_a);
    ready(&f, WORKER, job_b);
    ready(&f, SECOND, job_a);
    ready(&f, SECOND, job_b);
    ck_assert_uint_eq(f.unit_job, 0xaa);
}
END_TEST

/* ws1 has two units, ws2 has done the others. */
static void
two_are_left(void)
{
    submit(&f, ANA, job_a, 0);
    ready(&f, WORKER, job_a);
    join(&f, SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    ready(&f, SECOND, job_a);
    result(&f, SECOND, job_a, 2, 1);
    result(&f, SECOND, job_a, 3, 1);
    f.units[SECOND] = 0;
}

START_TEST(a_late_unit_goes_to_another_and_the_first_result_wins)
{
    two_are_left();
    wait_s(&f, 59);
    ck_assert_uint_eq(f.units[SECOND], 0);
    wait_s(&f, 2);
    ck_assert_uint_eq(f.units[SECOND], 2);
    result(&f, SECOND, job_a, 0, 2);
    result(&f, SECOND, job_a, 1, 2);
    ck_assert_int_eq(f.last[ANA].type, MSG_DONE);
    ck_assert_int_eq(f.last[WORKER].type, MSG_JOB_END);
}
END_TEST

START_TEST(the_lease_is_a_setting)
{
    coord_set_lease(f.c, 2000);
    two_are_left();
    wait_s(&f, 1);
    ck_assert_uint_eq(f.units[SECOND], 0);
    wait_s(&f, 2);
    ck_assert_uint_eq(f.units[SECOND], 2);
}
END_TEST

static void
ping(uint64_t progress)
{
    struct msg m = { .type = MSG_PING, .ping = { progress } };

    say(&f, WORKER, &m);
}

/* Units of this job take 100 s. */
static void
slow_job(void)
{
    submit(&f, ANA, job_a, 0);
    ready(&f, WORKER, job_a);
    join(&f, SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    ready(&f, SECOND, job_a);
    for (int i = 0; i < 50; i++) {
        wait_s(&f, 1);
        ping((uint64_t)i);
    }
    result(&f, SECOND, job_a, 2, 1);
    result(&f, SECOND, job_a, 3, 1);
    f.units[SECOND] = 0;
}

START_TEST(a_worker_that_gets_on_has_time)
{
    slow_job();
    for (int i = 0; i < 400; i++) {
        wait_s(&f, 1);
        ping(100 + (uint64_t)i / 8);
    }
    ck_assert_uint_eq(f.units[SECOND], 0);
    ck_assert_int_eq(f.hang_logs, 0);
}
END_TEST

START_TEST(a_worker_that_hangs_has_not)
{
    slow_job();
    for (int i = 0; i < 70; i++) {
        wait_s(&f, 1);
        ping(100);
    }
    ck_assert_uint_eq(f.units[SECOND], 2);
    ck_assert_int_eq(f.hang_logs, 1);
}
END_TEST

/* What ws1 made of unit 0 comes when ws2 was first. */
static void
late_twin(const uint8_t *bytes)
{
    struct msg m = { .type = MSG_RESULT,
                     .result = {
                         job_a, 0, 1, 0, 4, 4, 3, 1, { .rays = 10 }, bytes } };

    two_are_left();
    wait_s(&f, 61);
    result(&f, SECOND, job_a, 0, 2);
    say(&f, WORKER, &m);
}

START_TEST(a_duplicate_that_differs_is_an_error)
{
    uint8_t other[sizeof pixels] = { 0 };

    other[96] = 0x3f; /* 1, nearly */
    late_twin(other);
    ck_assert_int_eq(f.differ_logs, 1);
    ck_assert_int_ne(f.last[ANA].type, MSG_FAILED);
}
END_TEST

START_TEST(a_duplicate_that_does_not_is_none)
{
    late_twin(pixels);
    ck_assert_int_eq(f.differ_logs, 0);
}
END_TEST

/* Four units, of which a worker has two at a time. */
static void
two_arithmetics(uint32_t flags)
{
    struct msg other = { .type = MSG_READY, .ready = { job_a, .1, 8, 2 } };

    submit_with(&f, ANA, job_a, 0, 4, flags);
    join(&f, SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    ready(&f, WORKER, job_a);
    say(&f, SECOND, &other);
}

START_TEST(same_bits_takes_workers_of_one_arithmetic)
{
    two_arithmetics(MSG_JOB_SAME_BITS);
    ck_assert_int_eq(f.last[SECOND].type, MSG_JOB_END);
    ck_assert_uint_eq(f.units[SECOND], 0);
    ck_assert_int_eq(f.exclude_logs, 1);
    /* nor is it asked again, and one that is the same takes part */
    join(&f, 6, MSG_ROLE_WORKER, "ws3", "daemon");
    ready(&f, 6, job_a);
    ck_assert_uint_gt(f.units[6], 0);
    wait_s(&f, 10);
    ck_assert_uint_eq(f.units[SECOND], 0);
}
END_TEST

START_TEST(without_same_bits_all_workers_take_part)
{
    two_arithmetics(0);
    ck_assert_uint_gt(f.units[SECOND], 0);
    ck_assert_int_eq(f.exclude_logs, 0);
}
END_TEST

START_TEST(a_new_connection_of_a_name_replaces_the_old)
{
    submit(&f, ANA, job_a, 0);
    ready(&f, WORKER, job_a);
    join(&f, SECOND, MSG_ROLE_WORKER, "ws1", "daemon");
    ck_assert(f.closed[WORKER]);
    ck_assert_int_eq(f.last[SECOND].type, MSG_JOB_START);
    result(&f, SECOND, job_a, 0, 1); /* finished before the connection broke */
    ck_assert_int_eq(f.last[SECOND].type, MSG_ACK);
    ready(&f, SECOND, job_a);
    ck_assert_uint_eq(f.units[SECOND], 2);
    for (uint32_t u = 1; u < 4; u++)
        result(&f, SECOND, job_a, u, u == 1 ? 2 : 1);
    ck_assert_int_eq(f.last[ANA].type, MSG_DONE);
}
END_TEST

START_TEST(a_late_result_of_an_old_attempt_is_dropped)
{
    submit(&f, ANA, job_a, 0);
    ready(&f, WORKER, job_a);
    coord_closed(f.c, f.now_ms, WORKER, "cut");
    join(&f, SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    ready(&f, SECOND, job_a); /* has them all again */
    join(&f, 6, MSG_ROLE_WORKER, "ws1", "daemon");
    result(&f, 6, job_a, f.last[SECOND].unit.unit, 1);
    ck_assert_int_eq(f.last[6].type, MSG_ACK); /* so that it forgets it */
    ck_assert_int_ne(f.last[ANA].type, MSG_DONE);
}
END_TEST

static const struct {
    uint16_t min, max;
    uint8_t role;
    const char *name;
    uint16_t threads;
    int status;
} hellos[] = {
    { 3, 4, MSG_ROLE_WORKER, "w", 1, EX_PROTOCOL },
    { 0, 0, MSG_ROLE_WORKER, "w", 1, EX_PROTOCOL },
    { 2, 1, MSG_ROLE_WORKER, "w", 1, EX_PROTOCOL },
    { 1, 1, MSG_ROLE_WORKER, "", 1, EX_CONFIG },
    { 1, 1, MSG_ROLE_WORKER, "a b", 1, EX_CONFIG },
    { 1, 1, MSG_ROLE_WORKER, "w", 0, EX_CONFIG },
    { 1, 1, MSG_ROLE_ADMIN, "", 0, EX_NOPERM },
    { 1, 1, MSG_ROLE_WORKER, "ws8", 1, EX_NOPERM }, /* the key is ws7's */
};

START_TEST(a_hello_that_does_not_fit_is_refused)
{
    struct coord_peer peer = { "test", "x",
                               1u << MSG_ROLE_WORKER | 1u << MSG_ROLE_USER,
                               strcmp(hellos[_i].name, "ws8") == 0 ? "ws7"
                                                                   : NULL };
    struct msg m = { .type = MSG_HELLO,
                     .hello = { hellos[_i].min, hellos[_i].max, hellos[_i].role,
                                hellos[_i].name, "t", "", hellos[_i].threads,
                                0 } };

    coord_opened(f.c, f.now_ms, 7, &peer);
    say(&f, 7, &m);
    ck_assert_int_eq(f.last[7].type, MSG_REFUSE);
    ck_assert_int_eq(f.last[7].refuse.status, hellos[_i].status);
    ck_assert(f.closed[7]);
}
END_TEST

START_TEST(a_worker_that_calls_again_replaces_itself)
{
    join(&f, 7, MSG_ROLE_WORKER, "w", "x");
    ck_assert(!f.closed[7]);
    join(&f, 6, MSG_ROLE_WORKER, "w", "x");
    ck_assert_int_eq(f.last[7].type, MSG_BYE);
    ck_assert_str_eq(f.last[7].bye.text,
                     "replaced by a connection of that name from test");
    ck_assert(f.closed[7]);
    ck_assert_int_eq(f.last[6].type, MSG_WELCOME);
}
END_TEST

static void
call(uint64_t conn, unsigned roles, const char *owner, bool hello)
{
    struct coord_peer peer = { "test", owner, roles, NULL };
    struct msg m = { .type = MSG_HELLO,
                     .hello = { MSG_VERSION_MIN, MSG_VERSION, MSG_ROLE_USER, "",
                                "t", "", 0, 0 } };

    coord_opened(f.c, f.now_ms, conn, &peer);
    carry_out(&f);
    if (hello)
        say(&f, conn, &m);
}

/* A user, by a socket or a key, has 256; who steers or renders has any. */
START_TEST(one_user_has_not_all_connections)
{
    const unsigned user = 1u << MSG_ROLE_USER, first = 10;

    for (unsigned i = 0; i < 256; i++)
        call(first + i, user, "eve", true);
    ck_assert_int_eq(f.last[first + 255].type, MSG_WELCOME);
    call(first + 256, user, "eve", true);
    ck_assert_int_eq(f.last[first + 256].type, MSG_REFUSE);
    ck_assert_int_eq(f.last[first + 256].refuse.status, EX_TEMPFAIL);
    ck_assert(f.closed[first + 256]);
    ck_assert(!f.closed[first]);
    call(first + 257, user, "cleo", true);
    ck_assert_int_eq(f.last[first + 257].type, MSG_WELCOME);
    call(first + 258, user | 1u << MSG_ROLE_ADMIN, "eve", true);
    ck_assert_int_eq(f.last[first + 258].type, MSG_WELCOME);
    coord_closed(f.c, f.now_ms, first, "gone");
    carry_out(&f);
    call(first + 259, user, "eve", true);
    ck_assert_int_eq(f.last[first + 259].type, MSG_WELCOME);
}
END_TEST

/* Nor do those that say nothing keep the next one out. */
START_TEST(a_silent_connection_goes_when_a_user_has_too_many)
{
    const unsigned user = 1u << MSG_ROLE_USER, first = 10;

    for (unsigned i = 0; i < 256; i++)
        call(first + i, user, "eve", i == 0);
    ck_assert(!f.closed[first + 1]);
    call(first + 256, user, "eve", true);
    ck_assert(f.closed[first + 1]); /* the oldest that is silent */
    ck_assert(!f.closed[first] && !f.closed[first + 2]);
    ck_assert_int_eq(f.last[first + 256].type, MSG_WELCOME);
}
END_TEST

/* One that calls for ever does not fill the log; of workers each is said. */
START_TEST(refused_connections_are_logged_some_at_a_time)
{
    const unsigned user = 1u << MSG_ROLE_USER, first = 10;
    unsigned i;

    for (i = 0; i < 286; i++)
        call(first + i, user, "eve", true);
    ck_assert(f.closed[first + 256] && f.closed[first + 285]);
    ck_assert_int_eq(f.break_logs, 10);
    join(&f, 7, MSG_ROLE_WORKER, "w", "x");
    join(&f, 6, MSG_ROLE_WORKER, "w", "x");
    ck_assert_int_eq(f.break_logs, 11);
    wait_s(&f, 11);
    call(first + i, user, "eve", true);
    ck_assert_int_eq(f.break_logs, 12);
    ck_assert_int_eq(f.unlogged, 20);
}
END_TEST

static const struct {
    uint16_t min, max, spoken;
} versions[] = { { 1, 1, 1 }, { 1, 2, 2 }, { 1, 9, 2 }, { 2, 2, 2 } };

/* The highest that both know: told in the WELCOME, and to the shell, which
 * translates. */
START_TEST(old_and_new_ones_are_welcome)
{
    struct coord_peer peer = { "test", "x", 14, NULL };
    struct msg m = { .type = MSG_HELLO,
                     .hello = { versions[_i].min, versions[_i].max,
                                MSG_ROLE_WORKER, "w", "t", "", 1, 0 } };

    coord_opened(f.c, f.now_ms, 7, &peer);
    say(&f, 7, &m);
    ck_assert_int_eq(f.last[7].type, MSG_WELCOME);
    ck_assert_uint_eq(f.last[7].welcome.version, versions[_i].spoken);
    ck_assert_uint_eq(f.version[7], versions[_i].spoken);
}
END_TEST

/* Two workers speak with each other what both know. */
START_TEST(peers_are_told_the_version_of_the_pair)
{
    static const uint16_t max[] = { 2, 1, 2 };
    static const char *const name[] = { "w1", "w2", "w3" };
    uint16_t told[3] = { 0 };

    submit_with(&f, ANA, job_a, 0, 64, MSG_JOB_SHARE);
    for (unsigned i = 0; i < 3; i++) {
        struct coord_peer peer = { "test", "x", 14, NULL };
        struct msg m = { .type = MSG_HELLO,
                         .hello = { 1, max[i], MSG_ROLE_WORKER, name[i], "t",
                                    "unix /w", 1, 0 } };

        coord_opened(f.c, f.now_ms, 5 + i, &peer);
        say(&f, 5 + i, &m);
        ready(&f, 5 + i, job_a);
        for (unsigned k = 0; k <= i; k++)
            if (f.peers[5 + k] > 0)
                told[k] = f.peer_version[5 + k];
        if (i == 1)
            ck_assert(told[0] == 1 && told[1] == 1);
    }
    ck_assert(told[0] == 2 && told[1] == 1);
    ck_assert_uint_eq(told[2], 1); /* the last that it heard of is w2 */
}
END_TEST

static void
join_worker(uint64_t conn, const char *name, uint16_t version, uint16_t threads)
{
    struct coord_peer peer = { "test", "daemon", 14, NULL };
    struct msg m = { .type = MSG_HELLO,
                     .hello = { 1, version, MSG_ROLE_WORKER, name, "t", "",
                                threads, 0 } };

    coord_opened(f.c, f.now_ms, conn, &peer);
    say(&f, conn, &m);
}

/* By what they can do. */
START_TEST(those_who_begin_together_seed_a_part_each)
{
    join_worker(5, "old", 1, 2);
    join_worker(6, "big", 2, 4);
    submit_with(&f, ANA, job_a, 0, 64, MSG_JOB_SHARE);
    ready(&f, WORKER, job_a);
    ready(&f, 5, job_a);
    ready(&f, 6, job_a);
    ck_assert_int_eq(f.seeds[WORKER], 1);
    ck_assert_int_eq(f.seeds[5], 0); /* it has no word for it */
    ck_assert_int_eq(f.seeds[6], 1);
    const struct msg_seed *a = &f.seed[WORKER], *b = &f.seed[6];

    if (a->first > 0) {
        a = &f.seed[6];
        b = &f.seed[WORKER];
    }
    ck_assert_uint_eq(a->first, 0);
    ck_assert_uint_eq(a->last, b->first);
    ck_assert_uint_eq(b->last, MSG_SEED_ALL);
    ck_assert_double_eq_tol(f.seed[6].last - f.seed[6].first,
                            MSG_SEED_ALL * 2 / 3., 1);
}
END_TEST

START_TEST(nobody_seeds_alone_or_for_itself)
{
    submit_with(&f, ANA, job_a, 0, 64, MSG_JOB_SHARE);
    ready(&f, WORKER, job_a);
    ck_assert_int_eq(f.seeds[WORKER], 0);
    join_worker(5, "late", 2, 2); /* the cache is given to it */
    ready(&f, 5, job_a);
    ck_assert_int_eq(f.seeds[5], 0);
    about(&f, ANA, MSG_CANCEL, job_a);
    submit_with(&f, ANA, job_b, 0, 64, 0);
    ready(&f, WORKER, job_b);
    ready(&f, 5, job_b);
    ck_assert_int_eq(f.seeds[WORKER] + f.seeds[5], 0);
}
END_TEST

/* Who takes long to load finds the records made, and so does its next child. */
START_TEST(one_seeds_once_and_not_late)
{
    static const uint32_t none[1];
    struct msg lost = { .type = MSG_LOST, .lost = { job_a, "gone", 0, none } };

    join_worker(5, "slow", 2, 2);
    submit_with(&f, ANA, job_a, 0, 64, MSG_JOB_SHARE);
    ready(&f, WORKER, job_a);
    ck_assert_int_eq(f.seeds[WORKER], 1);
    wait_s(&f, 2);
    ready(&f, 5, job_a);
    ck_assert_int_eq(f.seeds[5], 0);
    memset(f.units, 0, sizeof f.units);
    say(&f, WORKER, &lost);
    ready(&f, WORKER, job_a);
    ck_assert_int_eq(f.seeds[WORKER], 1);
}
END_TEST

static double
total_stat(const char *key)
{
    char *text = stats_json(coord_find_job(f.c, job_a), f.now_ms);
    json_t *root = json_loads(text, 0, NULL);
    double v = json_number_value(
        json_object_get(json_object_get(root, "totals"), key));

    json_decref(root);
    free(text);
    return v;
}

START_TEST(what_seeding_took_is_in_the_totals)
{
    struct msg m = { .type = MSG_TALLY,
                     .tally = { .job = job_a,
                                .busy_s = 2,
                                .seeded = { .rays = 500,
                                            .ambient_rays = 400,
                                            .ambient_values = 3,
                                            .cpu_s = .25 } } };

    submit(&f, ANA, job_a, 0);
    ready(&f, WORKER, job_a);
    say(&f, WORKER, &m);
    m.tally.busy_s = 1; /* another child's */
    say(&f, WORKER, &m);
    ck_assert_double_eq(total_stat("seed_rays"), 1000);
    ck_assert_double_eq(total_stat("rays"), 1000);
    ck_assert_double_eq(worker_stat("rays"), 1000);
    ck_assert_double_eq(total_stat("ambient_rays"), 800);
    ck_assert_double_eq(total_stat("seed_values"), 6);
    ck_assert_double_eq(total_stat("ambient_values"), 6);
    ck_assert_double_eq(total_stat("seed_s"), .5);
    ck_assert_double_eq(total_stat("primary_rays"), 0);
    ck_assert_double_eq(total_stat("dropped_rays"), 0);
    ck_assert_uint_eq(rays_told(), 1000);
}
END_TEST

/* Files are needed as long as a job is remembered. */
START_TEST(files_of_jobs_are_needed)
{
    size_t n;
    uint8_t *list = coord_files(f.c, &n);

    ck_assert_ptr_nonnull(list);
    ck_assert_uint_eq(n, 0);
    free(list);
    submit(&f, ANA, job_a, 0);
    submit(&f, BOB, job_b, 0);
    about(&f, ANA, MSG_CANCEL, job_a);
    list = coord_files(f.c, &n);
    ck_assert_ptr_nonnull(list);
    ck_assert_uint_eq(n, 1); /* that of both */
    ck_assert_mem_eq(list, hash, MSG_HASH);
    free(list);
}
END_TEST

#define BIT(role) (1u << MSG_ROLE_##role)

/* What each credential may ask to be, role by role. */
static const struct {
    unsigned roles;
    bool worker, user, admin;
} credentials[] = {
    { BIT(WORKER), true, false, false },
    { BIT(USER), false, true, false },
    { BIT(USER) | BIT(ADMIN), false, true, true },
    { BIT(WORKER) | BIT(USER) | BIT(ADMIN), true, true, true },
    { 0, false, false, false },
};

START_TEST(a_credential_is_good_for_its_roles_alone)
{
    const bool *may = &credentials[_i].worker;

    for (unsigned role = MSG_ROLE_WORKER; role <= MSG_ROLE_ADMIN; role++) {
        struct coord_peer peer = { "test", "x", credentials[_i].roles, NULL };
        uint64_t conn = 4 + role;
        struct msg m = { .type = MSG_HELLO,
                         .hello = { 1, 1, (uint8_t)role, "w", "t", "", 1, 0 } };

        coord_opened(f.c, f.now_ms, conn, &peer);
        say(&f, conn, &m);
        ck_assert_int_eq(f.last[conn].type, may[role - MSG_ROLE_WORKER]
                                                ? MSG_WELCOME
                                                : MSG_REFUSE);
        ck_assert(f.closed[conn] == !may[role - MSG_ROLE_WORKER]);
    }
}
END_TEST

START_TEST(a_result_that_fits_no_unit_ends_the_connection)
{
    submit(&f, ANA, job_a, 0);
    ready(&f, WORKER, job_a);
    result(&f, WORKER, job_a, 4, 1);
    ck_assert(f.closed[WORKER]);
}
END_TEST

START_TEST(two_crashes_alone_fail_the_job_and_name_the_unit)
{
    uint32_t both[] = { 0, 1 }, one[] = { 1 };
    struct msg m = { .type = MSG_LOST,
                     .lost = { job_a, "killed by signal 11", 2, both } };

    submit(&f, ANA, job_a, 0);
    ready(&f, WORKER, job_a);
    say(&f, WORKER, &m);
    join(&f, SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    ready(&f, SECOND, job_a);
    ck_assert_uint_eq(f.units[SECOND], 1); /* a suspect goes alone */
    ck_assert_uint_le(f.last[SECOND].unit.unit, 1);
    one[0] = f.last[SECOND].unit.unit;
    m.lost.nunits = 1;
    m.lost.units = one;
    say(&f, SECOND, &m);
    ck_assert_int_eq(f.last[ANA].type, MSG_FAILED);
    ck_assert_int_eq(f.last[ANA].failed.status, EX_SOFTWARE);
    ck_assert_ptr_nonnull(strstr(f.last[ANA].failed.text, "brought the"));
}
END_TEST

/* The worker loses its child, and takes the job up again. */
static void
set_back(uint64_t conn)
{
    struct msg m = { .type = MSG_LOST,
                     .lost = { job_a, "out of memory", 0, NULL } };

    say(&f, conn, &m);
}

START_TEST(a_worker_that_cannot_keep_a_child_leaves_the_job_to_others)
{
    submit(&f, ANA, job_a, 0);
    ready(&f, WORKER, job_a);
    join(&f, SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    ready(&f, SECOND, job_a);
    for (int i = 1; i < JOB_MAX_SETBACKS; i++) {
        set_back(SECOND);
        ck_assert_int_eq(f.last[SECOND].type, MSG_JOB_START);
        ready(&f, SECOND, job_a);
    }
    f.sent[SECOND] = 0;
    set_back(SECOND);
    ck_assert_uint_eq(f.sent[SECOND], 0); /* it had its chances */
    ck_assert_int_ne(f.last[ANA].type, MSG_FAILED);
    for (uint32_t u = 0; u < 4; u++)
        for (uint32_t attempt = 1; attempt < 9; attempt++)
            result(&f, WORKER, job_a, u, attempt);
    ck_assert_int_eq(f.last[ANA].type, MSG_DONE);
}
END_TEST

START_TEST(a_job_that_nobody_can_keep_a_child_for_fails)
{
    submit(&f, ANA, job_a, 0);
    for (int i = 1; i <= JOB_MAX_SETBACKS; i++) {
        ck_assert_int_ne(f.last[ANA].type, MSG_FAILED);
        ready(&f, WORKER, job_a);
        set_back(WORKER);
    }
    ck_assert_int_eq(f.last[ANA].type, MSG_FAILED);
    ck_assert_int_eq(f.last[ANA].failed.status, EX_UNAVAILABLE);
    ck_assert_ptr_nonnull(strstr(f.last[ANA].failed.text, "out of memory"));
}
END_TEST

START_TEST(a_unit_done_makes_up_for_setbacks)
{
    submit(&f, ANA, job_a, 0);
    for (uint32_t u = 0; u < 3; u++) {
        ready(&f, WORKER, job_a);
        for (int i = 1; i < JOB_MAX_SETBACKS; i++) {
            set_back(WORKER);
            ready(&f, WORKER, job_a);
        }
        for (uint32_t attempt = 1; attempt < 40; attempt++)
            result(&f, WORKER, job_a, u, attempt);
    }
    ck_assert_int_ne(f.last[ANA].type, MSG_FAILED);
}
END_TEST

START_TEST(frames_are_fetched_when_they_are_there)
{
    struct msg m = { .type = MSG_FETCH,
                     .request = 6,
                     .fetch = { job_a, 0, 0 } };

    submit(&f, ANA, job_a, 0);
    say(&f, ANA, &m);
    ck_assert_int_eq(f.last[ANA].failed.status, EX_TEMPFAIL);
    m.fetch.frame = 1;
    say(&f, ANA, &m);
    ck_assert_int_eq(f.last[ANA].failed.status, EX_USAGE);
    m.fetch = (struct msg_fetch){ job_a, 0, MSG_WHAT_DEPTH };
    say(&f, ANA, &m);
    ck_assert_int_eq(f.last[ANA].failed.status, EX_USAGE);
    m.fetch.what = MSG_WHAT_STATS;
    say(&f, ANA, &m);
    ck_assert_int_eq(f.last[ANA].type, MSG_CHUNK);
}
END_TEST

START_TEST(a_full_disk_holds_jobs)
{
    f.have = false;
    submit(&f, ANA, job_a, 0);
    coord_fullness(f.c, f.now_ms, true, "cannot write 'x'");
    wait_s(&f, 1);
    ck_assert_uint_eq(f.progress.state, MSG_STATE_HELD);
    f.have = true;
    coord_file_stored(f.c, f.now_ms, ANA, hash);
    carry_out(&f);
    ck_assert_int_ne(f.last[WORKER].type, MSG_JOB_START);
    coord_fullness(f.c, f.now_ms, false, "");
    carry_out(&f);
    ck_assert_int_eq(f.last[WORKER].type, MSG_JOB_START);
    wait_s(&f, 1);
    ck_assert_uint_ne(f.progress.state, MSG_STATE_HELD);
}
END_TEST

static void
whole_job(const uint8_t *job)
{
    submit(&f, ANA, job, 0);
    ready(&f, WORKER, job);
    for (uint32_t u = 0; u < 4; u++)
        result(&f, WORKER, job, u, 1);
}

/* By number, by age, and by size, but not before its user can have it. */
START_TEST(jobs_that_are_over_are_kept_for_a_while)
{
    static const struct coord_keep keeps[] = { { 1, 0, 0 },
                                               { 9, 90000, 0 },
                                               { 9, 0, 1000 } };
    static const unsigned until_s[] = { 0, 90, 60 };

    coord_set_keep(f.c, &keeps[_i]);
    whole_job(job_a);
    coord_job_filed(f.c, f.now_ms, job_a, 900);
    whole_job(job_b);
    coord_job_filed(f.c, f.now_ms, job_b, 900);
    carry_out(&f);
    if (until_s[_i] > 0) {
        wait_s(&f, until_s[_i] / 2);
        ck_assert_ptr_nonnull(coord_find_job(f.c, job_a));
        wait_s(&f, until_s[_i]);
        coord_job_filed(f.c, f.now_ms, job_b, 900);
    }
    ck_assert_ptr_null(coord_find_job(f.c, job_a));
    ck_assert((coord_find_job(f.c, job_b) == NULL) == (_i == 1));
}
END_TEST

START_TEST(queries_are_answered_in_json)
{
    static const struct {
        uint8_t what;
        const char *text, *begins;
    } q[] = { { MSG_QUERY_STATUS, "", "{" },
              { MSG_QUERY_WORKERS, "", "[" },
              { MSG_QUERY_JOBS, "", "[" },
              { MSG_QUERY_JOB, "aa", "{" } };

    submit(&f, ANA, job_a, 0);
    for (int i = 0; i < N_ELEM(q); i++) {
        struct msg m = { .type = MSG_QUERY, .query = { q[i].what, q[i].text } };
        json_t *root;

        say(&f, BOB, &m);
        ck_assert_int_eq(f.last[BOB].type, MSG_ANSWER);
        ck_assert_int_eq(f.last[BOB].answer.text[0], q[i].begins[0]);
        root = json_loadb((const char *)f.last[BOB].answer.text,
                          f.last[BOB].answer.len, 0, NULL);
        ck_assert_ptr_nonnull(root);
        json_decref(root);
    }
}
END_TEST

/* Half of a job's only unit is there. */
START_TEST(how_far_a_job_is_goes_by_rows_where_units_are_large)
{
    struct msg part = { .type = MSG_RESULT,
                        .result = {
                            job_a, 0, 1, 0, 4, 8, 3, 0, { 0 }, pixels } };
    struct msg ask = { .type = MSG_QUERY, .query = { MSG_QUERY_JOB, "aa" } };
    json_t *root;

    submit_with(&f, ANA, job_a, 0, 1, 0);
    ready(&f, WORKER, job_a);
    say(&f, WORKER, &part);
    say(&f, BOB, &ask);
    root = json_loadb((const char *)f.last[BOB].answer.text,
                      f.last[BOB].answer.len, 0, NULL);
    ck_assert_double_eq(json_number_value(json_object_get(root, "done")), .5);
    json_decref(root);
}
END_TEST

int
main(void)
{
    Suite *s = suite_create("coord");
    TCase *tc = tcase_create("coord");

    tcase_add_checked_fixture(tc, set_up, tear_down);
    tcase_add_test(tc, pixels_that_are_no_numbers_are_told_once_with_the_first);
    tcase_add_loop_test(tc, rows_come_coded_unless_distances_do, 0,
                        N_ELEM(codings));
    tcase_add_test(tc, rows_of_version_1_are_coded_here);
    tcase_add_loop_test(tc, coded_rows_that_are_none_end_the_connection, 0,
                        N_ELEM(coded_rows));
    tcase_add_test(tc, waits_for_the_line_above_are_summed_over_children);
    tcase_add_test(tc, rays_under_way_are_told_and_never_fewer);
    tcase_add_test(tc, a_job_goes_from_submit_to_done);
    tcase_add_test(tc, records_go_to_the_radsubmit_that_wants_them);
    tcase_add_test(tc, a_job_waits_for_its_files);
    tcase_add_test(tc, the_same_id_again_attaches);
    tcase_add_test(tc, only_owner_and_admin_steer_a_job);
    tcase_add_test(tc, a_paused_job_gets_no_units);
    tcase_add_test(tc, a_drained_worker_gets_nothing_new);
    tcase_add_test(tc, a_worker_that_leaves_is_let_go_when_it_is_empty);
    tcase_add_test(tc, higher_priority_goes_first);
    tcase_add_test(tc, owners_share_the_workers);
    tcase_add_test(tc, priority_goes_before_fairness);
    tcase_add_test(tc, a_late_unit_goes_to_another_and_the_first_result_wins);
    tcase_add_test(tc, the_lease_is_a_setting);
    tcase_add_test(tc, a_worker_that_gets_on_has_time);
    tcase_add_test(tc, a_worker_that_hangs_has_not);
    tcase_add_test(tc, a_duplicate_that_differs_is_an_error);
    tcase_add_test(tc, a_duplicate_that_does_not_is_none);
    tcase_add_test(tc, same_bits_takes_workers_of_one_arithmetic);
    tcase_add_test(tc, without_same_bits_all_workers_take_part);
    tcase_add_test(tc, a_new_connection_of_a_name_replaces_the_old);
    tcase_add_test(tc, a_late_result_of_an_old_attempt_is_dropped);
    tcase_add_loop_test(tc, a_credential_is_good_for_its_roles_alone, 0,
                        N_ELEM(credentials));
    tcase_add_loop_test(tc, a_hello_that_does_not_fit_is_refused, 0,
                        N_ELEM(hellos));
    tcase_add_test(tc, a_worker_that_calls_again_replaces_itself);
    tcase_add_test(tc, one_user_has_not_all_connections);
    tcase_add_test(tc, refused_connections_are_logged_some_at_a_time);
    tcase_add_test(tc, a_silent_connection_goes_when_a_user_has_too_many);
    tcase_add_loop_test(tc, old_and_new_ones_are_welcome, 0, N_ELEM(versions));
    tcase_add_test(tc, those_who_begin_together_seed_a_part_each);
    tcase_add_test(tc, nobody_seeds_alone_or_for_itself);
    tcase_add_test(tc, one_seeds_once_and_not_late);
    tcase_add_test(tc, what_seeding_took_is_in_the_totals);
    tcase_add_test(tc, peers_are_told_the_version_of_the_pair);
    tcase_add_test(tc, files_of_jobs_are_needed);
    tcase_add_test(tc, a_result_that_fits_no_unit_ends_the_connection);
    tcase_add_test(tc, two_crashes_alone_fail_the_job_and_name_the_unit);
    tcase_add_test(tc,
                   a_worker_that_cannot_keep_a_child_leaves_the_job_to_others);
    tcase_add_test(tc, a_job_that_nobody_can_keep_a_child_for_fails);
    tcase_add_test(tc, a_unit_done_makes_up_for_setbacks);
    tcase_add_test(tc, frames_are_fetched_when_they_are_there);
    tcase_add_test(tc, a_full_disk_holds_jobs);
    tcase_add_loop_test(tc, cancel_is_answered_whatever_the_job_is_at, 0,
                        2 * N_ELEM(states));
    tcase_add_test(tc, an_answer_comes_as_soon_as_there_is_room);
    tcase_add_loop_test(tc, jobs_that_are_over_are_kept_for_a_while, 0, 3);
    tcase_add_test(tc, queries_are_answered_in_json);
    tcase_add_test(tc, how_far_a_job_is_goes_by_rows_where_units_are_large);
    suite_add_tcase(s, tc);
    return unit_run(s);
}
