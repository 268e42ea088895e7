/* check_seeds.c - seeds of the fuzz targets that hold messages
 *
 * What a session is and what it should reach is said here, in messages; the
 * seeds in tests/fuzz/corpus are their bytes.  A layout that changes changes
 * them, so they must be recorded again, or they would end where the first
 * message of the old layout stands.  That they get as far as they should is
 * looked at by fuzz/replay.sh.
 * RADD_RECORD=FOLDER/tests/golden records them, as it does recorded frames. */
#include "config.h"

#include "proto/ambshare.h"
#include "proto/frame.h"
#include "proto/message.h"
#include "picture/quincunx.h"
#include "tests/unit.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>
#include <sysexits.h>

enum { WIDTH = 16, HEIGHT = 31, BAR = 3, LINES = 11 };

/* Who acts, in a session of a coordinator and in one of a worker. */
enum { WS1, ANA, ADMIN, WS2 };
enum { COORD, CHILD, DIALLED, CALLER };

static const uint8_t id[MSG_JOB] = { 0xaa };
static const uint8_t other[MSG_TOKEN] = { 0xbb };
static const uint8_t here[MSG_HASH] = { 1 }, missing[MSG_HASH] = { 2 };
static const struct msg_frame frame = { 0, WIDTH, HEIGHT, "" };
static const uint8_t pixels[HEIGHT * WIDTH * 12], density[WIDTH];
static const uint8_t bitmap[BAR * 2] = { 0x81 };

static struct wire_out seed;

/* --- steps, as in fuzz/steps.h --- */

static void
says(unsigned who, const struct msg *m)
{
    struct wire_out frame_bytes;

    wire_out_init(&frame_bytes, MSG_FRAME_MAX);
    ck_assert_int_eq(msg_pack(&frame_bytes, m), 0);
    ck_assert_uint_le(frame_bytes.len, 0xffff);
    wire_put_u8(&seed, (uint8_t)who);
    wire_put_u16(&seed, (uint16_t)frame_bytes.len);
    wire_put_bytes(&seed, frame_bytes.buf, frame_bytes.len);
    wire_out_release(&frame_bytes);
}

static void
is_lost(unsigned who)
{
    wire_put_u8(&seed, (uint8_t)(63 << 2 | who));
}

/* 50 ms, or 20 s. */
static void
passes(unsigned who, bool long_while)
{
    wire_put_u8(&seed, (uint8_t)((long_while ? 61 : 62) << 2 | who));
}

/* --- what they say --- */

static void
hello(unsigned who, uint8_t role, const char *name)
{
    says(who, &(struct msg){ .type = MSG_HELLO,
                             .hello = { 1, 2, role, name, "t",
                                        *name ? "tcp a" : "", 1, 0 } });
}

static struct msg
spec(uint16_t type, uint8_t partition, const char *estimate)
{
    return (struct msg){ .type = type,
                         .request = type == MSG_SUBMIT ? 5 : 0,
                         .submit = { .job = id,
                                     .manifest = here,
                                     .name = "n",
                                     .params = "-ps 4",
                                     .needs = "",
                                     .estimate = estimate,
                                     .flags = MSG_JOB_SHARE,
                                     .partition = partition,
                                     .windows = 2,
                                     .files = { 1, here },
                                     .nframes = 1,
                                     .frames = &frame } };
}

static void
ready(unsigned who)
{
    says(who, &(struct msg){ .type = MSG_READY, .ready = { id, .1, 7, 1, 0 } });
}

/* Everybody is there, and a job. */
static void
cluster(uint8_t partition, const char *estimate, uint32_t flags)
{
    struct msg offer = { .type = MSG_OFFER, .offer = { 1, missing } };
    struct msg submit = spec(MSG_SUBMIT, partition, estimate);

    submit.submit.flags |= flags;
    hello(WS1, MSG_ROLE_WORKER, "ws1");
    hello(WS2, MSG_ROLE_WORKER, "ws2");
    hello(ANA, MSG_ROLE_USER, "");
    hello(ADMIN, MSG_ROLE_ADMIN, "");
    says(ANA, &offer);
    says(ANA, &submit);
}

/* Both are at it. */
static void
at_work(uint8_t partition, const char *estimate, uint32_t flags)
{
    cluster(partition, estimate, flags);
    ready(WS1);
    ready(WS2);
}

static void
of_unit(unsigned who, uint16_t type, uint32_t unit, uint32_t attempt)
{
    says(who, &(struct msg){ .type = type, .parked = { id, unit, attempt } });
}

static void
of_job(unsigned who, uint16_t type)
{
    says(who, &(struct msg){ .type = type, .cancel = { id } });
}

static void
query(void)
{
    says(ADMIN,
         &(struct msg){ .type = MSG_QUERY, .query = { MSG_QUERY_JOBS, "" } });
    says(ADMIN, &(struct msg){ .type = MSG_PAGE,
                               .page = { MSG_ROWS_JOBS, 1, "", "open", 0, 0 } });
}

static void
tally(unsigned who, double busy_s, uint64_t rays)
{
    says(who, &(struct msg){ .type = MSG_TALLY,
                             .tally = { .job = id,
                                        .busy_s = busy_s,
                                        .rays_under_way = rays,
                                        .dropped = { .rays = 3 } } });
}

static void
facts(unsigned who, uint32_t line)
{
    says(who, &(struct msg){ .type = MSG_FACTS,
                             .facts = { id, 0, line, 0, line ? BAR : 1, WIDTH,
                                        0, 3, bitmap, pixels, 2 } });
}

static uint32_t
ndensity(void)
{
    struct rad_quincunx q = { .width = WIDTH, .height = HEIGHT };

    rad_quincunx_steps(4, &q.xstep, &q.ystep);
    return (uint32_t)rad_quincunx_ndensity(&q);
}

static void
guess(unsigned who, uint32_t line)
{
    says(who,
         &(struct msg){ .type = MSG_GUESS,
                        .guess = { id, 0, line, 2, ndensity(), density } });
}

/* The right of line 1. */
static void
loan(unsigned who, uint32_t unit, uint32_t attempt)
{
    says(who,
         &(struct msg){ .type = MSG_LOAN,
                        .loan = { id, unit, attempt, 0, 1, 6, 10, 30000, 20000,
                                  0, 3, 0, density, bitmap, pixels, pixels } });
}

static void
paid(unsigned who, uint32_t unit, uint32_t attempt)
{
    says(who, &(struct msg){ .type = MSG_PAID,
                             .paid = { id, unit, attempt, { .rays = 5 } } });
}

static void
gave(unsigned who, uint32_t unit, uint32_t attempt, uint32_t height)
{
    says(who, &(struct msg){ .type = MSG_GAVE,
                             .gave = { id, unit, attempt, height } });
}

static void
base_line(unsigned who, uint32_t line)
{
    says(who, &(struct msg){ .type = MSG_BASE_LINE,
                             .base_line = { id, 0, line, 0, WIDTH, 0,
                                            ndensity(), 3, density, pixels } });
}

/* Rows, each a run a component; or all but their last byte. */
static void
send_rows(unsigned who, uint32_t unit, uint32_t attempt, uint32_t row,
          uint32_t rows, bool end, bool damaged)
{
    static const uint8_t run[] = { 2,           2, 0,           WIDTH,
                                   128 + WIDTH, 7, 128 + WIDTH, 8,
                                   128 + WIDTH, 9, 128 + WIDTH, 128 };
    uint8_t code[HEIGHT * sizeof run];

    for (uint32_t i = 0; i < rows; i++)
        memcpy(code + i * sizeof run, run, sizeof run);
    says(who, &(struct msg){ .type = MSG_RESULT,
                             .result = { id,
                                         unit,
                                         attempt,
                                         row,
                                         rows,
                                         WIDTH,
                                         1,
                                         end,
                                         { .rays = 10 },
                                         code,
                                         rows * sizeof run - damaged } });
}

static void
result(unsigned who, uint32_t unit, uint32_t attempt, uint32_t row,
       uint32_t rows, bool end)
{
    send_rows(who, unit, attempt, row, rows, end, false);
}

static void
fetch(uint8_t what)
{
    says(ANA, &(struct msg){ .type = MSG_FETCH, .fetch = { id, 0, what } });
}

/* --- sessions of a coordinator --- */

/* All of a unit of whole lines, from row y; its base line first. */
static void
finish(unsigned who, uint32_t unit, uint32_t attempt, uint32_t y,
       uint32_t height)
{
    if (y + height < HEIGHT)
        base_line(who, (y + height - 1) / BAR);
    result(who, unit, attempt, 0, height, true);
}

/* Of -ab 1 and one small frame: four lattices, and what they leave. */
enum { NPASSES = 5 }; /* the last has two tiles, the others have one */

static void
tile(unsigned who, uint32_t pass, uint32_t number, bool down)
{
    /* of the pixels of the frame's lattices */
    static const size_t colours[] = { 4 * 1, 4 * 2, 4 * 8 };
    struct msg m = { .type = MSG_TILE, .tile = { id, pass, number, 1 } };

    if (!down) {
        m.type = MSG_TILE_MADE;
        m.tile_made = (struct msg_tile_made){
            .job = id,
            .pass = pass,
            .tile = number,
            .counts = { .rays = 7 },
            .count = 1,
            .data = pixels,
            .len = AMBSHARE_BYTES,
            .colours = pixels,
            .colours_len = pass < N_ELEM(colours) ? colours[pass] : 0
        };
    }
    says(who, &m);
}

static void
holds(unsigned who, const uint8_t *job, uint32_t pass)
{
    says(who, &(struct msg){ .type = MSG_HOLDS, .holds = { job, pass, 1 } });
}

/* All tiles of a pass. */
static void
whole_pass(unsigned who, uint32_t pass)
{
    tile(who, pass, 0, false);
    if (pass == NPASSES - 1)
        tile(who, pass, 1, false);
    holds(who, id, pass);
}

/* A cache in passes: a worker that is lost in one, tiles that come twice, and
 * one that comes late. */
static void
session_passes(void)
{
    struct msg offer = { .type = MSG_OFFER, .offer = { 1, missing } };
    struct msg submit = spec(MSG_SUBMIT, MSG_PART_WINDOW, "uniform");

    submit.submit.flags = MSG_JOB_PASSES;
    submit.submit.params = "-ab 1 -ps 4";
    hello(WS1, MSG_ROLE_WORKER, "ws1");
    hello(ANA, MSG_ROLE_USER, "");
    says(ANA, &offer);
    says(ANA, &submit);
    fetch(MSG_WHAT_PREVIEW);
    ready(WS1);
    tile(WS1, 0, 0, false);
    tile(WS1, 0, 0, false);
    fetch(MSG_WHAT_PREVIEW);
    is_lost(WS1);
    hello(WS2, MSG_ROLE_WORKER, "ws2");
    ready(WS2);
    for (uint32_t i = 1; i < NPASSES; i++)
        whole_pass(WS2, i);
    result(WS2, 0, 1, 0, 1, false);
}

/* A job that is done leaves its cache, and the next begins with it; a third
 * names one that is not there. */
static void
session_reuse(void)
{
    static const uint8_t next[MSG_JOB] = { 0xab }, any[MSG_JOB];
    struct msg offer = { .type = MSG_OFFER, .offer = { 1, missing } };
    struct msg submit = spec(MSG_SUBMIT, MSG_PART_WINDOW, "uniform");
    struct msg is_ready = { .type = MSG_READY, .ready = { next, .1, 7, 1, 0 } };

    submit.submit.flags = MSG_JOB_PASSES | MSG_JOB_SCENE;
    submit.submit.params = "-ab 1 -ps 4";
    submit.submit.scene = here;
    hello(WS1, MSG_ROLE_WORKER, "ws1");
    hello(ANA, MSG_ROLE_USER, "");
    says(ANA, &offer);
    says(ANA, &submit);
    fetch(MSG_WHAT_PREVIEW);
    ready(WS1);
    for (uint32_t i = 0; i < NPASSES; i++)
        whole_pass(WS1, i);
    result(WS1, 0, 1, 0, 15, true);
    result(WS1, 1, 1, 0, 16, true);
    submit.submit.job = next;
    submit.submit.flags |= MSG_JOB_REUSE;
    submit.submit.reuse = any;
    says(ANA, &submit);
    says(WS1, &is_ready);
    submit.submit.job = other;
    submit.submit.reuse = other;
    says(ANA, &submit);
}

/* Windows: pauses, pictures and statistics, before it is done and after. */
static void
session_job(void)
{
    at_work(MSG_PART_WINDOW, "uniform", 0);
    query();
    tally(WS1, 1, 9);
    of_job(ANA, MSG_PAUSE);
    of_job(ANA, MSG_RESUME);
    result(WS1, 0, 1, 0, 7, false);
    fetch(MSG_WHAT_PREVIEW);
    result(WS1, 0, 1, 7, 8, true);
    fetch(MSG_WHAT_STATS);
    result(WS2, 1, 1, 0, 16, true);
    tally(WS2, 2, 0);
    fetch(MSG_WHAT_PICTURE);
    of_job(ANA, MSG_CANCEL);
}

/* Lines of which many go out at a time: one waits, one is given away. */
static void
session_auto(void)
{
    at_work(MSG_PART_AUTO, "uniform", 0);
    facts(WS1, 3);
    guess(WS1, 2);
    facts(WS2, 4);
    of_unit(WS2, MSG_PARKED, 1, 1);
    query();
    tally(WS1, 1, 0);
    finish(WS2, 1, 1, 13, 9);
    finish(WS2, 2, 1, 22, 3);
    finish(WS2, 3, 1, 25, 3);
    finish(WS2, 4, 1, 28, 3);
    gave(WS1, 0, 1, 7);
    finish(WS1, 0, 1, 0, 7);
    finish(WS2, 5, 1, 7, 6);
    fetch(MSG_WHAT_PICTURE);
}

static void
estimated(unsigned who, uint32_t number, uint32_t nareas)
{
    static const struct msg_cost cost[LINES] = { { 30, 7 }, { 30, 7 } };

    says(who,
         &(struct msg){ .type = MSG_ESTIMATED,
                        .estimated = { id,
                                       number,
                                       nareas,
                                       cost,
                                       { .rays = 9, .estimate_rays = 5 } } });
}

/* Areas by turns, one lost with its worker; then units by what they cost. */
static void
session_estimate(void)
{
    at_work(MSG_PART_STATIC, "20b", 0);
    estimated(WS1, 0, 1);
    estimated(WS2, 1, 1);
    query();
    is_lost(WS2);
    for (uint32_t i = 2; i < LINES; i++)
        estimated(WS1, i, 1);
    tally(WS1, 1, 0);
    finish(WS1, 0, 1, 0, HEIGHT);
}

/* Coded rows and floats, one sent twice, one that is damaged. */
static void
session_rows(void)
{
    at_work(MSG_PART_SCANBAR, "uniform", MSG_JOB_CODED);
    base_line(WS1, 1);
    result(WS1, 0, 1, 0, 2, false);
    result(WS1, 0, 1, 0, 2, false);
    result(WS1, 0, 1, 2, 2, true);
    base_line(WS1, 2);
    result(WS1, 1, 1, 0, 3, true);
    fetch(MSG_WHAT_PREVIEW);
    base_line(WS2, 4);
    send_rows(WS2, 2, 1, 0, 3, true, true);
}

/* Children that die, a worker that goes, rows of one that is no more. */
static void
session_lost(void)
{
    static const uint32_t units[] = { 0, 1 };

    at_work(MSG_PART_SCANBAR, "uniform", 0);
    says(WS1, &(struct msg){ .type = MSG_LOST,
                             .lost = { id, EX_SOFTWARE, "killed", 2, units } });
    ready(WS1);
    is_lost(WS2);
    passes(ANA, true);
    hello(WS2, MSG_ROLE_WORKER, "ws2");
    result(WS2, 2, 1, 0, 3, true);
    ready(WS2);
    query();
    of_job(ANA, MSG_CANCEL);
}

/* The last line of a job, of which the worker that has nothing gets columns. */
static void
session_loans(void)
{
    at_work(MSG_PART_SCANBAR, "uniform", 0);
    finish(WS1, 1, 1, 4, 3);
    finish(WS2, 2, 1, 10, 3);
    finish(WS2, 3, 1, 13, 3);
    finish(WS1, 4, 1, 22, 3);
    finish(WS2, 5, 1, 16, 3);
    finish(WS2, 6, 1, 19, 3);
    finish(WS2, 7, 1, 7, 3);
    passes(WS1, false);
    finish(WS2, 8, 1, 25, 3);
    finish(WS2, 9, 1, 28, 3);
    passes(WS1, false);
    loan(WS1, 0, 1);
    facts(WS2, 1);
    paid(WS2, 0, 2);
    tally(WS2, 1, 0);
    finish(WS1, 0, 1, 0, 4);
}

/* --- sessions of a worker --- */

static void
welcome(void)
{
    says(COORD,
         &(struct msg){ .type = MSG_WELCOME, .welcome = { MSG_VERSION, 1, "radcoord" } });
}

/* A job begins, and its child is there. */
static void
job_begins(void)
{
    struct msg start = spec(MSG_JOB_START, MSG_PART_AUTO, "uniform");

    welcome();
    says(COORD, &start);
    ready(CHILD);
}

static void
unit(uint32_t number)
{
    says(COORD, &(struct msg){ .type = MSG_UNIT,
                               .unit = { id, number, 1, 0, 0, 4, WIDTH, BAR,
                                         MSG_MODE_STRICT, 0 } });
}

static void
estimate(void)
{
    static const struct msg_area area = { 0, 0, 1, WIDTH, BAR };

    says(COORD, &(struct msg){ .type = MSG_ESTIMATE,
                               .estimate = { id, 0, 20, 1, &area } });
}

static void
chunk(const uint8_t *hash)
{
    says(COORD,
         &(struct msg){ .type = MSG_CHUNK,
                        .chunk = { hash, 0, 5, (const uint8_t *)"bytes", 5 } });
}

/* A job of which a file is not there: its units are for nothing. */
static void
worker_no_files(void)
{
    struct msg start = spec(MSG_JOB_START, MSG_PART_AUTO, "uniform");

    start.job_start.files.hash = missing;
    welcome();
    says(COORD, &start);
    chunk(missing);
    unit(0);
    facts(COORD, 1);
    base_line(COORD, 1);
    of_job(COORD, MSG_JOB_END);
}

/* All that is passed on, down and up. */
static void
worker_sharing(void)
{
    job_begins();
    unit(0);
    facts(COORD, 1);
    guess(COORD, 0);
    base_line(COORD, 1);
    says(COORD, &(struct msg){ .type = MSG_NEXT_HOLDER,
                               .next_holder = { id, 0, 2, "ws2" } });
    of_unit(COORD, MSG_SPLIT, 0, 1);
    estimate();
    says(COORD, &(struct msg){ .type = MSG_LEND, .lend = { id, 0, 1, 32768 } });
    loan(COORD, 1, 2);
    loan(CHILD, 0, 1);
    says(COORD,
         &(struct msg){ .type = MSG_BACK, .back = { id, 0, 1, 1, 6, 10 } });
    of_unit(CHILD, MSG_PARKED, 0, 1);
    of_unit(CHILD, MSG_RESUMED, 0, 1);
    gave(CHILD, 0, 1, BAR);
    estimated(CHILD, 0, 1);
    facts(CHILD, 2);
    guess(CHILD, 1);
    base_line(CHILD, 2);
    paid(CHILD, 1, 2);
    tally(CHILD, 1, 9);
    of_unit(COORD, MSG_REVOKE, 0, 1);
    passes(COORD, false);
}

/* rowsum_hash() of a record of blank bytes. */
#define BLANK_SUM UINT64_C(0xed0b67fecacfe8c0)

static void
worker_tiles(void)
{
    static const struct msg_peer fed = { "ws2", "tcp b", other, MSG_PEER_DIAL,
                                         1 };
    struct msg frozen = {
        .type = MSG_FROZEN, .frozen = { id, 0, 0, 1, 1, pixels, AMBSHARE_BYTES }
    };

    struct msg stage = { .type = MSG_STAGE, .stage = { id, 5, "-ab 1" } };

    struct msg feed = { .type = MSG_FEED, .feed = { id, 1, { "ws2" } } };
    struct msg records = { .type = MSG_TILE_RECORDS,
                           .tile_records = { id, 5, 1, 1, pixels,
                                             AMBSHARE_BYTES } };
    struct msg closed = { .type = MSG_CLOSED, .closed = { id, 5, 1, 7, 0 } };

    job_begins();
    says(COORD,
         &(struct msg){ .type = MSG_JOB_PEERS, .job_peers = { id, 1, &fed } });
    says(COORD, &feed);
    tile(COORD, 0, 0, true);
    tile(CHILD, 0, 0, false);
    says(COORD, &frozen);
    tile(CHILD, 0, 1, false);
    tile(COORD, 1, 0, true);
    says(COORD, &stage);
    tile(COORD, 5, 0, true);
    tile(CHILD, 5, 0, false);
    says(COORD, &records);
    says(COORD, &closed); /* its sum is another */
    closed.closed.sum = BLANK_SUM;
    records.tile_records.tile = 3;
    says(DIALLED, &records);
    says(COORD, &closed);
    unit(0);
}

/* Rows that are kept while the coordinator is away, and peers that come. */
static void
worker_work(void)
{
    static const struct msg_peer peers[] = {
        { "ws2", "tcp b", other, MSG_PEER_DIAL, 1 }, { "ws3", "", other, 0, 1 }
    };
    struct msg start = spec(MSG_JOB_START, MSG_PART_AUTO, "uniform");

    job_begins();
    says(COORD, &(struct msg){ .type = MSG_JOB_PEERS,
                               .job_peers = { id, N_ELEM(peers), peers } });
    unit(0);
    result(CHILD, 0, 1, 0, 1, false);
    says(DIALLED,
         &(struct msg){ .type = MSG_AMBIENT, .ambient = { 1, pixels, 8 } });
    says(CALLER, &(struct msg){ .type = MSG_PEER_HELLO,
                                .peer_hello = { id, "ws3", other } });
    says(CALLER,
         &(struct msg){ .type = MSG_AMBIENT, .ambient = { 1, pixels, 8 } });
    base_line(CALLER, 0);
    says(CHILD,
         &(struct msg){ .type = MSG_AMBIENT, .ambient = { 1, pixels, 8 } });
    is_lost(COORD);
    result(CHILD, 0, 1, 1, 2, true);
    passes(CHILD, true);
    welcome();
    says(COORD, &start);
    says(COORD, &(struct msg){ .type = MSG_ACK, .ack = { id, 0, 1, 1, 2 } });
    of_job(COORD, MSG_JOB_END);
}

/* Sensor points, whose values are floats; a worker is lost. */
static void
session_points(void)
{
    struct msg offer = { .type = MSG_OFFER, .offer = { 1, missing } };
    struct msg submit = spec(MSG_SUBMIT, MSG_PART_WINDOW, "uniform");

    submit.submit.flags = MSG_JOB_POINTS | MSG_JOB_DEPTH;
    submit.submit.nframes = 1;
    hello(WS1, MSG_ROLE_WORKER, "ws1");
    hello(ANA, MSG_ROLE_USER, "");
    says(ANA, &offer);
    says(ANA, &submit);
    ready(WS1);
    result(WS1, 0, 1, 0, 7, false);
    fetch(MSG_WHAT_DEPTH);
    is_lost(WS1);
    hello(WS2, MSG_ROLE_WORKER, "ws2");
    ready(WS2);
    result(WS2, 0, 1, 0, 16, true);
    fetch(MSG_WHAT_DEPTH);
    fetch(MSG_WHAT_STATS);
}

static const struct {
    const char *name;
    void (*build)(void);
} seeds[] = {
    { "session/auto", session_auto },
    { "session/estimate", session_estimate },
    { "session/job", session_job },
    { "session/loans", session_loans },
    { "session/lost", session_lost },
    { "session/passes", session_passes },
    { "session/points", session_points },
    { "session/reuse", session_reuse },
    { "session/rows", session_rows },
    { "worker/no_files", worker_no_files },
    { "worker/sharing", worker_sharing },
    { "worker/tiles", worker_tiles },
    { "worker/work", worker_work },
};

static FILE *
open_seed(const char *folder, const char *name, const char *mode)
{
    char path[500];
    FILE *f;

    snprintf(path, sizeof path, "%s/tests/fuzz/corpus/%s", folder, name);
    f = fopen(path, mode);
    ck_assert_msg(f != NULL, "%s: cannot open: is it to be recorded?", path);
    return f;
}

/* Is it as it was recorded?  Or record it. */
static void
expect_seed(const char *name)
{
    const char *record = getenv("RADD_RECORD"), *top = getenv("top_srcdir");
    static uint8_t bytes[1 << 16];
    char folder[400];
    size_t n;
    FILE *f;

    if (record) {
        snprintf(folder, sizeof folder, "%s/../..", record);
        f = open_seed(folder, name, "wb");
        ck_assert_uint_eq(fwrite(seed.buf, 1, seed.len, f), seed.len);
        ck_assert_int_eq(fclose(f), 0);
        return;
    }
    f = open_seed(top ? top : ".", name, "rb");
    n = fread(bytes, 1, sizeof bytes, f);
    fclose(f);
    ck_assert_msg(n == seed.len && memcmp(bytes, seed.buf, n) == 0,
                  "seed %s is not what it should be: RADD_RECORD", name);
}

LOOP_TEST(a_session_is_recorded_as_it_is_said, N_ELEM(seeds))
{
    wire_out_init(&seed, 1 << 16);
    seeds[_i].build();
    expect_seed(seeds[_i].name);
    wire_out_release(&seed);
}

/* --- single frames --- */

/* The bytes that were recorded of a message. */
static void
put_golden(uint16_t type)
{
    const char *top = getenv("top_srcdir");
    char path[500];
    unsigned byte;
    FILE *f;

    snprintf(path, sizeof path, "%s/tests/golden/%s.hex", top ? top : ".",
             msg_name(type));
    f = fopen(path, "r");
    ck_assert_msg(f != NULL, "%s: cannot open", path);
    while (fscanf(f, "%2x", &byte) == 1)
        wire_put_u8(&seed, (uint8_t)byte);
    fclose(f);
}

static unsigned
session_of(uint16_t type)
{
    unsigned session = 0;

    while (session < MSG_NSESSION &&
           !msg_allowed((enum msg_session)session, type))
        session++;
    ck_assert_uint_lt(session, MSG_NSESSION);
    return session;
}

/* Of every message, in the first session that has it; RESULT in pieces. */
TEST(every_message_is_a_seed)
{
    uint16_t type;
    char name[60];

    for (size_t i = 0; (type = msg_nth(i)) != 0; i++) {
        size_t n =
            (size_t)snprintf(name, sizeof name, "frame/%s", msg_name(type));

        for (char *c = name; c < name + n; c++)
            *c = (char)tolower((unsigned char)*c);
        wire_out_init(&seed, MSG_FRAME_MAX + 2);
        wire_put_u8(&seed, (uint8_t)session_of(type));
        wire_put_u8(&seed, type == MSG_RESULT ? 9 : 255);
        put_golden(type);
        expect_seed(name);
        wire_out_release(&seed);
    }
}
