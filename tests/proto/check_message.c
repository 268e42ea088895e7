/* check_message.c - the bytes of every message, and what is refused
 *
 * tests/golden/NAME.hex holds the recorded frame of one example of each
 * message; with RADD_RECORD=FOLDER in the environment they are written there
 * instead (after a change of the protocol, with its new version). */
#include "config.h"

#include "message_fixture.h"

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <sysexits.h>

static const uint32_t units[] = { 5, 0x01020304 };
static const struct msg_peer peers[] = {
    { "ws1", "tcp 127.0.0.1:4711", ID, MSG_PEER_DIAL, 1 },
    { "ws2", "", ID + 1, MSG_PEER_DROP, 1 },
};
static const uint8_t bitmap[2 * 2] = { 0x81, 0x01, 0x00, 0x02 };
static const uint8_t facts[4 * 3 * 4] = { 0x3f, 0x80 };
static const uint8_t density[3] = { 4, 0, 2 };
static const uint8_t lent[1] = { 2 };
static const struct msg_area areas[] = { { 1, 2, 3, 4, 5 },
                                         { 6, 7, 8, 9, 10 } };
static const uint64_t line_ns[] = { 1000000000, UINT64_MAX };
static const struct msg_cost line_costs[] = { { 1, 2 }, { 3, 4 } };
static const uint8_t pixels[2 * 3 * 4] = { 0x3f, 0x80 };

#define COUNTS                                                                 \
    {                                                                          \
        1, 2, 3, 4, 5, 6, 7, 8, 9, { 10, 0, 11, 12 }, { { 13, 14 } }, .5, .75, \
        {                                                                      \
            {                                                                  \
                15.5, -16.5, 17.5, 18.5, 19.5, 20.5                            \
            }                                                                  \
        }                                                                      \
    }

/* clang-format off */
static const struct msg examples[] = {
    { .type = MSG_HELLO, .request = 1,
      .hello = { 1, 1, MSG_ROLE_WORKER, "ws1", "radd 0.1.0",
                 "tcp 127.0.0.1:4711", 8, 0x0123456789abcdef } },
    { .type = MSG_WELCOME, .request = 1,
      .welcome = { 1, 0xfedcba9876543210, "radcoord 0.1.0" } },
    { .type = MSG_REFUSE, .refuse = { 76, "version 2 is not spoken here" } },
    { .type = MSG_PING, .ping = { 42, 150 } },
    { .type = MSG_PONG, .pong = { 42, 150 } },
    { .type = MSG_BYE, .bye = { "drained" } },
    { .type = MSG_OFFER, .request = 2, .offer = { 2, two_hashes } },
    { .type = MSG_WANT, .request = 2, .want = { 1, two_hashes } },
    { .type = MSG_CHUNK, .request = 2,
      .chunk = { ID, 4, 9, (const uint8_t *)"hello", 5 } },
    { .type = MSG_HAVE, .have = { ID } },
    { .type = MSG_SUBMIT, .request = 3, .submit = SPEC },
    { .type = MSG_ACCEPT, .request = 3, .accept = { ID, 1, ID + 1 } },
    { .type = MSG_PROGRESS, .request = 3,
      .progress = { ID, 1, 2, 3, 4, 5, 6, 7.5, 8.5, 9, 10, 11, 12.5,
                    .25, { 13, 14, 15, 16 }, { { 17, 18 }, { 19, 20 } }, .0625,
                    .5, 2, 1, { 3, 4 }, .125 } },
    { .type = MSG_DONE, .request = 3, .done = { ID, 2 } },
    { .type = MSG_FAILED, .request = 3, .failed = { ID, 70, "no light" } },
    { .type = MSG_CANCEL, .request = 4, .cancel = { ID } },
    { .type = MSG_PAUSE, .request = 5, .pause = { ID } },
    { .type = MSG_RESUME, .request = 6, .resume = { ID } },
    { .type = MSG_PRIORITY, .request = 11, .priority = { ID, -5 } },
    { .type = MSG_FETCH, .request = 7, .fetch = { ID, 1, MSG_WHAT_DEPTH } },
    { .type = MSG_QUERY, .request = 8, .query = { MSG_QUERY_JOB, "1011" } },
    { .type = MSG_ANSWER, .request = 8,
      .answer = { (const uint8_t *)"{}", 2 } },
    { .type = MSG_DRAIN, .request = 9, .drain = { "ws1", MSG_DRAIN_HOURS } },
    { .type = MSG_UNDRAIN, .request = 9, .undrain = { "ws1" } },
    { .type = MSG_KEY, .request = 10,
      .key = { MSG_KEY_ADD, "worker:ws1", 1798761600 } },
    { .type = MSG_PAGE, .request = 11,
      .page = { MSG_ROWS_WORKERS, 1, "ana", "running", 12, 13 } },
    { .type = MSG_DELETE, .request = 12, .delete = { ID } },
    { .type = MSG_FORGET, .request = 13, .forget = { "ws1" } },
    { .type = MSG_JOB_START, .job_start = SPEC },
    { .type = MSG_READY, .ready = { ID, .125, 42, 8, 3 } },
    { .type = MSG_JOB_END, .job_end = { ID } },
    { .type = MSG_UNIT, .unit = { ID, 1, 2, 3, 4, 5, 6, 7,
                                    MSG_MODE_STRICT, MSG_UNIT_TOP } },
    { .type = MSG_RESULT,
      .result = { ID, 1, 2, 3, 1, 2, 3, 1, COUNTS, .pixels = pixels } },
    { .type = MSG_ACK, .ack = { ID, 1, 2, 3, 4 } },
    { .type = MSG_REVOKE, .revoke = { ID, 1, 2 } },
    { .type = MSG_LOST, .lost = { ID, EX_SOFTWARE, "killed by signal 11", 2, units } },
    { .type = MSG_TALLY, .tally = { ID, 1, 2, 3, 13, 4, 5, 6, 7, 8, 9.5, 10.5, 11,
                                   COUNTS, COUNTS, 12 } },
    { .type = MSG_FACTS,
      .facts = { ID, 1, 2, 3, 2, 10, MSG_FACTS_ESTIMATE, 3, bitmap, .pixels = facts } },
    { .type = MSG_PARKED, .parked = { ID, 1, 2 } },
    { .type = MSG_BASE_LINE,
      .base_line = { ID, 1, 2, 3, 2, 5, 3, 3, density, pixels } },
    { .type = MSG_GUESS, .guess = { ID, 1, 2, 3, 3, density } },
    { .type = MSG_NEXT_HOLDER, .next_holder = { ID, 1, 2, "ws1" } },
    { .type = MSG_SPLIT, .split = { ID, 1, 2 } },
    { .type = MSG_GAVE, .gave = { ID, 1, 2, 3 } },
    { .type = MSG_ESTIMATE, .estimate = { ID, 1, 2, 2, areas } },
    { .type = MSG_ESTIMATED, .estimated = { ID, 1, 2, line_costs, COUNTS } },
    { .type = MSG_LEND, .lend = { ID, 1, 2, 32768 } },
    { .type = MSG_LOAN,
      .loan = { ID, 1, 2, 3, 4, 5, 2, 6, 7, MSG_LOAN_LINE, 3, 3, density,
                lent, .top = pixels } },
    { .type = MSG_BACK, .back = { ID, 1, 2, 3, 4, 5 } },
    { .type = MSG_PAID, .paid = { ID, 1, 2, COUNTS } },
    { .type = MSG_LINE_COSTS, .line_costs = { ID, 1, 2, 2, line_ns } },
    { .type = MSG_RESUMED, .resumed = { ID, 1, 2 } },
    { .type = MSG_STILL, .still = { ID, 1, 2, 3 } },
    { .type = MSG_ROOM, .room = { ID, 0, "no room on the disk" } },
    { .type = MSG_YIELD, .yield = { ID, 1, 2 } },
    { .type = MSG_TILE, .tile = { ID, 1, 2, 1 } },
    { .type = MSG_TILE_MADE,
      .tile_made = { ID, 1, 2, COUNTS, 2, (const uint8_t *)"records", 7,
                     (const uint8_t *)"colours.", 8 } },
    { .type = MSG_FROZEN,
      .frozen = { ID, 1, 2, 1, 2, (const uint8_t *)"records", 7 } },
    { .type = MSG_STAGE, .stage = { ID, 8, "-ab 2 -aa .1" } },
    { .type = MSG_SHOW, .show = { ID, 8, "-ab 2 -aa .1 --samples=4" } },
    { .type = MSG_TILE_RECORDS,
      .tile_records = { ID, 1, 2, 2, (const uint8_t *)"records", 7 } },
    { .type = MSG_CLOSED, .closed = { ID, 1, 2, 3, 1 } },
    { .type = MSG_HOLDS, .holds = { ID, 1, 1 } },
    { .type = MSG_FEED, .feed = { ID, 2, { "ws2", "ws3" } } },
    { .type = MSG_JOB_PEERS, .job_peers = { ID, 2, peers } },
    { .type = MSG_PEER_HELLO, .peer_hello = { ID, "ws1", ID + 1 } },
    { .type = MSG_AMBIENT,
      .ambient = { 2, (const uint8_t *)"records", 7 } },
    { .type = MSG_RECORDS,
      .records = { ID, 2, (const uint8_t *)"records", 7 } },
};
/* clang-format on */

#define N_EXAMPLES N_ELEM(examples)

static FILE *
open_golden(const char *folder, const char *under, uint16_t type,
            const char *mode)
{
    char path[4096];
    FILE *f;

    snprintf(path, sizeof path, "%s%s/%s.hex", folder, under, msg_name(type));
    f = fopen(path, mode);
    ck_assert_msg(f != NULL, "%s: cannot open", path);
    return f;
}

/* What was recorded of a message. */
static FILE *
golden(uint16_t type)
{
    const char *top = getenv("top_srcdir");

    return open_golden(top ? top : ".", "/tests/golden", type, "r");
}

static void
record(const char *folder, uint16_t type, const uint8_t *bytes, size_t n)
{
    FILE *f = open_golden(folder, "", type, "w");

    for (size_t i = 0; i < n; i++)
        fprintf(f, "%02x%c", bytes[i], i % 16 == 15 || i == n - 1 ? '\n' : ' ');
    fclose(f);
}

/* The first by frame, then row, then column, in whatever order they come. */
TEST(the_first_pixel_that_is_no_number_is_kept)
{
    static const struct msg_nan none, some[] = {
        { 2, 1, 0, 0 }, { 1, 0, 9, 8 }, { 3, 0, 5, 7 }, { 1, 0, 6, 7 }
    };
    struct msg_nan up = none, down = none;

    for (int i = 0; i < N_ELEM(some); i++) {
        msg_nan_add(&up, &some[i]);
        msg_nan_add(&up, &none);
        msg_nan_add(&down, &some[N_ELEM(some) - 1 - i]);
    }
    ck_assert_uint_eq(up.pixels, 7);
    ck_assert(up.frame == 0 && up.x == 5 && up.y == 7);
    ck_assert(down.frame == 0 && down.x == 5 && down.y == 7);
}

TEST(what_a_sum_lacks_of_another_is_no_less_than_nothing)
{
    static const struct msg_counts all = { .rays = 9,
                                           .primary_rays = 8,
                                           .shadow_rays = 7,
                                           .cpu_s = 2,
                                           .wall_s = 3,
                                           .doubt = { { [1] = 5 } } };
    static const struct msg_counts have = {
        .rays = 4, .shadow_rays = 8, .cpu_s = .5, .doubt = { { [1] = 1 } }
    };
    struct msg_counts lack;

    msg_counts_lack(&lack, &all, &have);
    ck_assert_uint_eq(lack.rays, 5);
    ck_assert_uint_eq(lack.primary_rays, 0);
    ck_assert_uint_eq(lack.shadow_rays, 0);
    ck_assert_double_eq(lack.cpu_s, 1.5);
    ck_assert_double_eq(lack.wall_s, 0);
    ck_assert_double_eq(lack.doubt.v[1], 4);
    msg_counts_add(&lack, &have);
    ck_assert_uint_eq(lack.rays, all.rays);
}

TEST(each_count_of_a_sum_is_added)
{
    enum { N = offsetof(struct msg_counts, nan) / sizeof(uint64_t) };
    struct msg_counts sum = { .cpu_s = 1, .wall_s = 2 };
    struct msg_counts more = { .cpu_s = 10, .wall_s = 20 };
    uint64_t *of_sum = (uint64_t *)&sum, *of_more = (uint64_t *)&more;

    for (uint64_t i = 0; i < N; i++) {
        of_sum[i] = i + 1;
        of_more[i] = 100 * (i + 1);
    }
    for (int i = 0; i < MSG_DOUBT_SUMS; i++) {
        sum.doubt.v[i] = i + 1;
        more.doubt.v[i] = 100 * (i + 1);
    }
    msg_counts_add(&sum, &more);
    for (uint64_t i = 0; i < N; i++)
        ck_assert_uint_eq(of_sum[i], 101 * (i + 1));
    for (int i = 0; i < MSG_DOUBT_SUMS; i++)
        ck_assert_double_eq(sum.doubt.v[i], 101 * (i + 1));
    ck_assert_double_eq(sum.cpu_s, 11);
    ck_assert_double_eq(sum.wall_s, 22);
}

/* The first four objects with all their counts, in whatever order they come. */
TEST(functions_without_a_value_are_summed_by_object)
{
    static const struct msg_fault some[][MSG_FAULTS] = {
        { { 5, 1 }, { 9, 2 } },
        { { 2, 10 }, { 5, 100 }, { 7, 1000 } },
        { { 0, 0 } },
        { { 1, 3 }, { 2, 4 }, { 8, 5 }, { 9, 6 } },
    };
    static const struct msg_fault sum[MSG_FAULTS] = {
        { 1, 3 }, { 2, 14 }, { 5, 101 }, { 7, 1000 }
    };
    struct msg_fault up[MSG_FAULTS] = { { 0, 0 } }, down[MSG_FAULTS];

    memcpy(down, up, sizeof down);
    for (int i = 0; i < N_ELEM(some); i++) {
        msg_faults_add(up, some[i]);
        msg_faults_add(down, some[N_ELEM(some) - 1 - i]);
    }
    for (int i = 0; i < MSG_FAULTS; i++) {
        ck_assert_uint_eq(up[i].object, sum[i].object);
        ck_assert_uint_eq(up[i].count, sum[i].count);
        ck_assert_uint_eq(down[i].object, sum[i].object);
        ck_assert_uint_eq(down[i].count, sum[i].count);
    }
}

LOOP_TEST(every_message_has_its_recorded_bytes, N_EXAMPLES)
{
    const struct msg *m = &examples[_i];
    uint8_t bytes[MOST];
    const char *folder = getenv("RADD_RECORD");
    size_t n, i = 0;
    unsigned byte;
    FILE *f;

    n = pack(m, bytes);
    if (folder) {
        record(folder, m->type, bytes, n);
        return;
    }
    f = golden(m->type);
    for (; fscanf(f, "%2x", &byte) == 1; i++) {
        ck_assert_msg(i < n, "%s is shorter", msg_name(m->type));
        ck_assert_msg(bytes[i] == byte, "%s: byte %zu", msg_name(m->type), i);
    }
    ck_assert_uint_eq(i, n);
    fclose(f);
}

TEST(every_message_has_an_example)
{
    uint16_t type;

    for (size_t i = 0; (type = msg_nth(i)) != 0; i++)
        ck_assert_msg(i < (size_t)N_ELEM(examples) && examples[i].type == type,
                      "%s has none", msg_name(type));
}

/* Unpacked and packed again it is the same. */
LOOP_TEST(every_message_comes_back, N_EXAMPLES)
{
    const struct msg *example = &examples[_i];
    uint8_t first[MOST], again[MOST];
    struct msg m = { 0 };
    size_t n;

    n = pack(example, first);
    ck_assert_int_eq(msg_unpack(&m, example->type, example->request,
                                first + MSG_HEADER, n - MSG_HEADER, NULL),
                     0);
    ck_assert_uint_eq(pack(&m, again), n);
    ck_assert_mem_eq(again, first, n);
    msg_release(&m);
}

/* Coded rows are all that is left of a RESULT. */
TEST(coded_rows_come_back)
{
    uint8_t bytes[MOST];
    const struct msg m = { .type = MSG_RESULT,
                           .result = { ID, 1, 2, 3, 1, 2, 1, 0,
                                       .pixels = (const uint8_t *)"12345678",
                                       .len = 8 } };
    size_t n = pack(&m, bytes) - MSG_HEADER;
    struct msg back = { 0 };

    for (size_t len = n - 7; len <= n; len++) {
        ck_assert_int_eq(
            msg_unpack(&back, MSG_RESULT, 0, bytes + MSG_HEADER, len, NULL), 0);
        ck_assert_uint_eq(back.result.len, 8 - (n - len));
        ck_assert_mem_eq(back.result.pixels, m.result.pixels, back.result.len);
        msg_release(&back);
    }
    ck_assert_int_eq(
        msg_unpack(&back, MSG_RESULT, 0, bytes + MSG_HEADER, n - 8, NULL),
        RAD_EPROTO); /* no byte of them */
    msg_release(&back);
}

static const struct {
    unsigned min, max, common;
} ranges[] = {
    { 1, 1, 1 }, { 1, 2, 1 }, { 2, 2, 0 }, { 0, 9999, 1 }, { 1, 65535, 1 },
    { 0, 1, 1 }, { 3, 3, 0 }, { 0, 0, 0 }, { 2, 1, 0 }, /* no range at all */
};

LOOP_TEST(the_highest_version_that_both_speak_is_taken, N_ELEM(ranges))
{
    ck_assert_uint_eq(msg_common_version(ranges[_i].min, ranges[_i].max),
                      ranges[_i].common);
}

/* To whoever speaks an older version than the message's, it is none, in neither
 * direction. */
TEST(a_later_message_is_none_of_an_earlier_version)
{
    struct msg m = { .type = MSG_KEY, .key = { MSG_KEY_LIST, "", 0 } };
    unsigned since = msg_since(MSG_KEY);
    struct rad_error err = { 0 };
    uint8_t bytes[MOST];
    size_t n = pack(&m, bytes);
    struct msg_header h;
    struct wire_out out;

    wire_out_init(&out, MOST);
    ck_assert_int_eq(msg_pack_as(since - 1, &out, &m), RAD_EPROTO);
    ck_assert_int_eq(
        frame_header(&h, MSG_AT_COORD_ADMIN, since - 1, bytes, &err),
        RAD_EPROTO);
    ck_assert_str_eq(err.what, "unknown message 33, flags 0");
    ck_assert_int_eq(frame_header(&h, MSG_AT_COORD_ADMIN, since, bytes, NULL),
                     0);
    ck_assert_int_eq(msg_unpack_as(since - 1, &m, MSG_KEY, 0,
                                   bytes + MSG_HEADER, n - MSG_HEADER, NULL),
                     RAD_EPROTO);
    msg_release(&m);
    wire_out_release(&out);
}

LOOP_TEST(a_message_of_any_other_length_is_refused, N_EXAMPLES)
{
    uint16_t type = examples[_i].type;
    uint8_t bytes[MOST] = { 0 };
    const uint8_t *payload = bytes + MSG_HEADER;
    struct msg m = { 0 };
    size_t n;

    n = pack(&examples[_i], bytes) - MSG_HEADER;
    for (size_t len = 0; len <= n + 1; len++)
        if (len != n)
            ck_assert_int_eq(unpack_exactly(type, payload, len, &m),
                             RAD_EPROTO);
    msg_release(&m);
}

/* Whatever a byte is changed to: refused, or it packs to the same bytes. */
LOOP_TEST(a_damaged_message_is_refused_or_consistent, N_EXAMPLES)
{
    uint16_t type = examples[_i].type;
    uint8_t bytes[MOST] = { 0 };
    uint8_t *payload = bytes + MSG_HEADER;
    struct msg m = { 0 };
    size_t n;

    if (type == MSG_HELLO) /* of another version it is not read to its end */
        return;
    n = pack(&examples[_i], bytes) - MSG_HEADER;
    for (size_t at = 0; at < n; at++)
        for (int flip = 1; flip < 256; flip *= 2) {
            payload[at] ^= (uint8_t)flip;
            unpack_exactly(type, payload, n, &m);
            payload[at] ^= (uint8_t)flip;
        }
    msg_release(&m);
}

/* Amounts that the coordinator adds up, and tells. */
static const struct {
    enum msg_type type;
    size_t at; /* in the message */
} amounts[] = {
    { MSG_SUBMIT, offsetof(struct msg, submit.compile_s) },
    { MSG_READY, offsetof(struct msg, ready.load_s) },
    { MSG_RESULT, offsetof(struct msg, result.counts.cpu_s) },
    { MSG_RESULT, offsetof(struct msg, result.counts.wall_s) },
    { MSG_TALLY, offsetof(struct msg, tally.busy_s) },
    { MSG_TALLY, offsetof(struct msg, tally.wait_base_line_s) },
    { MSG_TALLY, offsetof(struct msg, tally.dropped.cpu_s) },
    { MSG_TALLY, offsetof(struct msg, tally.paid.cpu_s) },
    { MSG_ESTIMATED, offsetof(struct msg, estimated.counts.cpu_s) },
    { MSG_PAID, offsetof(struct msg, paid.counts.cpu_s) },
    { MSG_TILE_MADE, offsetof(struct msg, tile_made.counts.cpu_s) },
    { MSG_PROGRESS, offsetof(struct msg, progress.cost_done) },
    { MSG_PROGRESS, offsetof(struct msg, progress.cost_total) },
    { MSG_PROGRESS, offsetof(struct msg, progress.elapsed_s) },
    { MSG_PROGRESS, offsetof(struct msg, progress.left_s) },
    { MSG_PROGRESS, offsetof(struct msg, progress.error) },
    { MSG_PROGRESS, offsetof(struct msg, progress.goal_error) },
};

/* Statistics are JSON, which has no infinity, not even one that is a sum. */
LOOP_TEST(an_amount_without_end_is_refused, N_ELEM(amounts))
{
    static const double wrong[] = { -1, NAN, INFINITY, DBL_MAX, 1e100 };
    uint8_t bytes[MOST];
    struct msg m = { 0 }, back = { 0 };

    for (size_t i = 0; i < N_ELEM(examples); i++)
        if (examples[i].type == amounts[_i].type)
            m = examples[i];
    for (size_t i = 0; i < N_ELEM(wrong); i++) {
        size_t n;

        memcpy((char *)&m + amounts[_i].at, &wrong[i], sizeof wrong[i]);
        n = pack(&m, bytes) - MSG_HEADER;
        ck_assert_int_eq(unpack_exactly(m.type, bytes + MSG_HEADER, n, &back),
                         RAD_EPROTO);
    }
    msg_release(&back);
}

TEST(a_sum_of_doubt_has_an_end)
{
    static const double value[] = { -1, 9e99, NAN, INFINITY, -1e100 };
    uint8_t bytes[MOST];
    struct msg back = { 0 };

    for (size_t i = 0; i < N_ELEM(value); i++) {
        struct msg m = { .type = MSG_PAID, .paid = { ID, 1, 2, COUNTS } };
        size_t n;

        m.paid.counts.doubt.v[MSG_DOUBT_SUMS - 1] = value[i];
        n = pack(&m, bytes) - MSG_HEADER;
        ck_assert_int_eq(unpack_exactly(m.type, bytes + MSG_HEADER, n, &back),
                         i < 2 ? 0 : RAD_EPROTO);
    }
    msg_release(&back);
}

static const struct {
    struct msg_fault list[MSG_FAULTS];
    int code;
} faults[] = {
    { { { 0, 0 } }, 0 },
    { { { 0, 5 } }, 0 },
    { { { 0, 5 }, { 7, UINT64_MAX } }, 0 },
    { { { 7, 0 } }, RAD_EPROTO },           /* of an object, none */
    { { { 0, 0 }, { 7, 1 } }, RAD_EPROTO }, /* behind the list's end */
    { { { 7, 1 }, { 7, 1 } }, RAD_EPROTO }, /* an object twice */
    { { { 8, 1 }, { 7, 1 } }, RAD_EPROTO },
    { { { 8, 1 }, { 9, 0 } }, RAD_EPROTO },
};

LOOP_TEST(faults_stand_in_the_order_of_their_objects, N_ELEM(faults))
{
    struct msg m = { .type = MSG_PAID, .paid = { ID, 1, 2, COUNTS } };
    struct msg back = { 0 };
    uint8_t bytes[MOST];
    size_t n;

    memcpy(m.paid.counts.faults, faults[_i].list, sizeof faults[_i].list);
    n = pack(&m, bytes) - MSG_HEADER;
    ck_assert_int_eq(unpack_exactly(m.type, bytes + MSG_HEADER, n, &back),
                     faults[_i].code);
    msg_release(&back);
}

/* Numbers that are read, and that nobody means. */
static const struct {
    enum msg_type type;
    size_t at, size; /* in the message */
    uint64_t least_wrong, wrong;
} numbers[] = {
#define NUMBER(TYPE, field, least, other)                                      \
    {                                                                          \
        TYPE, offsetof(struct msg, field), sizeof(((struct msg *)0)->field),   \
            least, other                                                       \
    }
    NUMBER(MSG_HELLO, hello.threads, MSG_MAX_THREADS + 1, UINT16_MAX),
    NUMBER(MSG_READY, ready.threads, MSG_MAX_THREADS + 1, 0),
    NUMBER(MSG_READY, ready.passes, MSG_MOST_PASSES + 1, UINT32_MAX),
    NUMBER(MSG_TILE, tile.pass, MSG_MOST_PASSES, UINT32_MAX),
    NUMBER(MSG_TILE, tile.tile, MSG_MOST_TILES, UINT32_MAX),
    NUMBER(MSG_TILE_MADE, tile_made.pass, MSG_MOST_PASSES, UINT32_MAX),
    NUMBER(MSG_TILE_MADE, tile_made.tile, MSG_MOST_TILES, UINT32_MAX),
    NUMBER(MSG_FROZEN, frozen.pass, MSG_MOST_PASSES, UINT32_MAX),
    NUMBER(MSG_TILE_RECORDS, tile_records.pass, MSG_MOST_PASSES, UINT32_MAX),
    NUMBER(MSG_TILE_RECORDS, tile_records.tile, MSG_MOST_TILES, UINT32_MAX),
    NUMBER(MSG_CLOSED, closed.pass, MSG_MOST_PASSES, UINT32_MAX),
    NUMBER(MSG_HOLDS, holds.pass, MSG_MOST_PASSES, UINT32_MAX),
    NUMBER(MSG_STAGE, stage.pass, MSG_MOST_PASSES, UINT32_MAX),
    NUMBER(MSG_SHOW, show.pass, MSG_MOST_PASSES, UINT32_MAX),
    NUMBER(MSG_SUBMIT, submit.error_ppm, 1, 1000001), /* without passes */
    NUMBER(MSG_SUBMIT, submit.time_ms, 1, UINT32_MAX),
    NUMBER(MSG_FAILED, failed.status, EX__BASE - 1, 0),
    NUMBER(MSG_LOST, lost.status, EX__BASE - 1, 0),
    NUMBER(MSG_PROGRESS, progress.state, MSG_STATE_HELD + 1, 255),
    NUMBER(MSG_PROGRESS, progress.ended, 2, 255),
    NUMBER(MSG_SUBMIT, submit.bundle_bytes, MSG_MAX_BYTES + 1, UINT64_MAX),
    NUMBER(MSG_KEY, key.expires, MSG_MAX_DATE + 1, UINT64_MAX),
    NUMBER(MSG_PAID, paid.counts.nan.x, MSG_MAX_SIDE + 1, UINT32_MAX),
    NUMBER(MSG_PAID, paid.counts.nan.y, MSG_MAX_SIDE + 1, UINT32_MAX),
};

LOOP_TEST(a_number_out_of_its_range_is_refused, (int)N_ELEM(numbers))
{
    const uint64_t wrong[] = { numbers[_i].least_wrong, numbers[_i].wrong };
    uint8_t bytes[MOST];
    struct msg m = { 0 }, back = { 0 };

    for (size_t i = 0; i < N_ELEM(examples); i++)
        if (examples[i].type == numbers[_i].type)
            m = examples[i];
    for (size_t i = 0; i < N_ELEM(wrong); i++) {
        size_t n;

        /* of a wider number its first bytes, as this machine has them */
        memcpy((char *)&m + numbers[_i].at, &wrong[i], numbers[_i].size);
        n = pack(&m, bytes) - MSG_HEADER;
        ck_assert_int_eq(unpack_exactly(m.type, bytes + MSG_HEADER, n, &back),
                         RAD_EPROTO);
    }
    msg_release(&back);
}

/* It would be counted as next to nothing. */
TEST(a_file_of_more_than_all_disks_have_is_refused)
{
    static const uint8_t data[MSG_HASH];
    struct msg m = { .type = MSG_CHUNK }, back = { 0 };
    struct wire_out w;

    m.chunk = (struct msg_chunk){ data, 0, MSG_MAX_BYTES + 1, data, 1 };
    wire_out_init(&w, MSG_FRAME_MAX);
    ck_assert_int_ne(msg_pack(&w, &m), 0);
    wire_out_release(&w);
    msg_release(&back);
}

TEST(a_hello_of_another_version_is_understood_so_far)
{
    static const uint8_t bytes[] = { 0, 3, 0, 4, 1, 0xff, 0xee };
    struct msg m = { 0 };

    ck_assert_int_eq(msg_unpack(&m, MSG_HELLO, 0, bytes, sizeof bytes, NULL),
                     0);
    ck_assert_uint_eq(m.hello.min, 3);
    ck_assert_uint_eq(m.hello.max, 4);
    ck_assert_str_eq(m.hello.name, "");
    msg_release(&m);
}

/* What may arrive where, said once more and in the other direction: a change
 * of message.def must be meant. */
static const struct {
    enum msg_session session;
    const char *types; /* blanks around each */
} arrivals[] = {
    { MSG_AT_COORD_NEW, " HELLO " },
    { MSG_AT_COORD_WORKER,
      " PING PONG BYE WANT FAILED DRAIN READY RESULT LOST TALLY FACTS PARKED "
      "GUESS BASE_LINE GAVE ESTIMATED LOAN PAID LINE_COSTS STILL RECORDS "
      "ROOM TILE_MADE HOLDS " },
    { MSG_AT_COORD_USER,
      " PING PONG BYE OFFER CHUNK SUBMIT CANCEL PAUSE PRIORITY "
      "RESUME FETCH QUERY PAGE DELETE " },
    { MSG_AT_COORD_ADMIN,
      " PING PONG BYE OFFER CHUNK SUBMIT CANCEL PAUSE PRIORITY "
      "RESUME FETCH QUERY DRAIN UNDRAIN KEY PAGE DELETE FORGET " },
    { MSG_AT_COORD_OBSERVER, " PING PONG BYE FETCH QUERY PAGE " },
    { MSG_AT_DIALLER, " WELCOME REFUSE " },
    { MSG_AT_WORKER,
      " PING PONG BYE CHUNK JOB_START JOB_END UNIT ACK REVOKE YIELD "
      "JOB_PEERS FACTS GUESS BASE_LINE NEXT_HOLDER SPLIT "
      "ESTIMATE LEND LOAN BACK TILE FROZEN STAGE SHOW TILE_RECORDS "
      "CLOSED FEED " },
    { MSG_AT_CLIENT, " PING PONG BYE WANT CHUNK HAVE ACCEPT PROGRESS DONE "
                     "FAILED ANSWER RECORDS " },
    { MSG_AT_PEER_NEW, " PEER_HELLO " },
    { MSG_AT_PEER, " PING PONG BYE AMBIENT BASE_LINE TILE_RECORDS " },
    { MSG_AT_CHILD_NEW, " JOB_START " },
    { MSG_AT_CHILD,
      " JOB_END UNIT REVOKE YIELD AMBIENT FACTS BASE_LINE "
      "GUESS SPLIT ESTIMATE LEND LOAN BACK TILE FROZEN STAGE SHOW " },
    { MSG_AT_PARENT_NEW, " FAILED READY " },
    { MSG_AT_PARENT,
      " FAILED RESULT TALLY AMBIENT FACTS PARKED BASE_LINE "
      "GUESS GAVE ESTIMATED LOAN PAID LINE_COSTS RESUMED TILE_MADE " },
    { MSG_NSESSION, " " },
};

LOOP_TEST(each_message_arrives_only_where_it_may, N_ELEM(arrivals))
{
    uint16_t type;

    ck_assert_int_eq(N_ELEM(arrivals), MSG_NSESSION + 1);
    for (size_t i = 0; (type = msg_nth(i)) != 0; i++) {
        char word[40];
        bool want;

        snprintf(word, sizeof word, " %s ", msg_name(type));
        want = strstr(arrivals[_i].types, word) != NULL;
        ck_assert_msg(msg_allowed(arrivals[_i].session, type) == want,
                      "%s in session %d", msg_name(type), _i);
    }
    ck_assert(!msg_allowed(arrivals[_i].session, 9999));
}

static const uint8_t not_costs[2][4] = { { 0xbf, 0x80 }, { 0x7f, 0x80 } };
static const uint8_t past_width[] = { 0, 4 };

static const struct msg impossible[] = {
    { .type = 9999 },
    { .type = MSG_SUBMIT, .submit = { .nframes = 0 } },
    { .type = MSG_SUBMIT, /* of one column 8 by 8 samples leave none */
      .submit = { .nframes = 2, .frames = frames, .oversample = 8 } },
    { .type = MSG_UNIT, .unit = { ID, 0, 0, 0, 65530, 0, 10, .height = 1 } },
    { .type = MSG_CHUNK, .chunk = { ID, 5, 9, (const uint8_t *)"hello", 5 } },
    { .type = MSG_RESULT, .result = { ID, 0, 0, 0, 1, 1, .channels = 5 } },
    { .type = MSG_RESULT,
      .result = { ID, 0, 0, 0, 60000, 60000, .channels = 3 } },
    { .type = MSG_RESULT, .result = { ID, 0, 0, 0, 1, 1, 1, .len = 0 } },
    { .type = MSG_FETCH, .fetch = { ID, 0, MSG_NWHAT } },
    { .type = MSG_SUBMIT, /* a cost below 0 */
      .submit = { .ncosts = 1,
                  .costs = not_costs[0],
                  .nframes = 1,
                  .frames = frames } },
    { .type = MSG_SUBMIT, /* an infinite one */
      .submit = { .ncosts = 1,
                  .costs = not_costs[1],
                  .nframes = 1,
                  .frames = frames } },
    { .type = MSG_UNIT,
      .unit = { ID, 0, 0, 0, 0, 0, 1, 1, .mode = MSG_NMODE } },
    { .type = MSG_UNIT,
      .unit = { ID, 0, 0, 0, 0, 0, 1, 1, MSG_MODE_WINDOW, MSG_UNIT_TOP } },
    { .type = MSG_FACTS, /* a bit past the width */
      .facts = { ID, 0, 0, 0, 1, 10, 0, 3, past_width, .pixels = facts } },
    { .type = MSG_FACTS, /* rows that no line has */
      .facts = { ID, 0, 0, 31, 2, 10, 0, 3, bitmap, .pixels = facts } },
    { .type = MSG_GUESS, /* from no line */
      .guess = { ID, 0, 0, 0, 3, density } },
    { .type = MSG_BASE_LINE,
      .base_line = { ID, 0, 0, 65535, 1, 0, 0, 3, density, pixels } },
    { .type = MSG_GAVE, .gave = { ID, 0, 0, MSG_MAX_SIDE + 1 } },
    { .type = MSG_LOAN, /* of no columns */
      .loan = { ID, 0, 0, 0, 1, 0, 0, 0, 0, 0, 3, 0, NULL, lent, pixels,
                pixels } },
    { .type = MSG_LOAN, /* densities that it has no use for */
      .loan = { ID, 0, 0, 0, 1, 0, 1, 0, 0, 0, 3, 3, density, lent, pixels,
                pixels } },
    { .type = MSG_BACK, .back = { ID, 0, 0, 1, 65535, 1 } },
};

LOOP_TEST(what_cannot_be_read_is_not_written, N_ELEM(impossible))
{
    struct wire_out out;

    wire_out_init(&out, MSG_FRAME_MAX);
    ck_assert_int_eq(msg_pack(&out, &impossible[_i]), RAD_EPROTO);
    ck_assert_uint_eq(out.len, 0);
    ck_assert(!out.bad); /* good for the next */
    wire_out_release(&out);
}

TEST(job_ids_are_32_hex_digits)
{
    char hex[MSG_JOB_HEX];
    uint8_t id[MSG_JOB];

    msg_job_format(ID, hex);
    ck_assert_str_eq(hex, "101112131415161718191a1b1c1d1e1f");
    ck_assert(msg_job_parse(hex, id));
    ck_assert_mem_eq(id, ID, MSG_JOB);
    ck_assert(!msg_job_parse("1011", id));
    ck_assert(!msg_job_parse("101112131415161718191a1b1c1d1e1g", id));
    ck_assert(!msg_job_parse("101112131415161718191a1b1c1d1e1f0", id));
}

static FILE *
open_page(void)
{
    const char *top = getenv("top_srcdir");
    char path[4096];
    FILE *f;

    snprintf(path, sizeof path, "%s/doc/protocol.md", top ? top : ".");
    f = fopen(path, "r");
    ck_assert_msg(f != NULL, "%s: cannot open", path);
    return f;
}

/* Is the last column of a table's line these words, in any order? */
static bool
last_column_is(char *line, const char *words)
{
    char *end = strrchr(line, '|'), *at, word[40];
    size_t n = 0;

    if (line[0] != '|' || end == line)
        return false;
    *end = '\0';
    at = strrchr(line, '|') + 1;
    for (char *w = strtok(at, " "); w; w = strtok(NULL, " "), n++) {
        snprintf(word, sizeof word, " %s ", w);
        if (!strstr(words, word))
            return false;
    }
    for (const char *p = words; *p; p++)
        n -= *p == ' ' && p[1] != '\0';
    return n == 0;
}

/* "| SESSION | who reads, and when | what may arrive |" */
LOOP_TEST(each_session_is_documented, MSG_NSESSION)
{
    char line[1024];
    bool found = false;
    FILE *f = open_page();

    while (!found && fgets(line, sizeof line, f))
        found = last_column_is(line, arrivals[_i].types);
    fclose(f);
    ck_assert_msg(found, "no row has%s", arrivals[_i].types);
}

/* doc/protocol.md has a heading "### NAME (number)" for each. */
LOOP_TEST(every_message_is_documented, N_EXAMPLES)
{
    char line[512], want[64];
    bool found = false;
    uint16_t type = examples[_i].type;
    FILE *f = open_page();

    snprintf(want, sizeof want, "### %s (%u)\n", msg_name(type), type);
    while (!found && fgets(line, sizeof line, f))
        found = strcmp(line, want) == 0;
    fclose(f);
    ck_assert_msg(found, "%s has no table", msg_name(type));
}
