/* check_delivery.c - long statistics: piece by piece, users in turn, and within
 * bounds however many ask and nobody reads */
#include "config.h"

#include "registry/telling.h"
#include "tests/daemon/coord/coord_fixture.h"

enum {
    UNITS = 64 * 96, /* more than a MiB of statistics */
    MANY = 40,       /* connections that ask for these: more than a test's ticks
                      * serve */
    FIRST = 10,      /* the first of them */
    PIECES = 4,      /* most that a tick makes or sends */
    CHUNKS = 4       /* most messages of a piece */
};

/* Ana's job of so many units, which is done. */
static void
set_up_long(void)
{
    static const struct msg_frame large = { 0, 64, 96, "" };
    struct msg m;
    struct msg unit = {
        .type = MSG_RESULT,
        .result = { job_a, 0, 1, 0, 1, 1, 1, 1, { .rays = 7 }, pixels, 4 }
    };

    set_up_coord(true);
    m = usual_submit(job_a);
    m.submit.frames = &large;
    m.submit.partition = MSG_PART_WINDOW;
    m.submit.windows = UNITS;
    m.submit.order = MSG_ORDER_FORWARD;
    say(ANA, &m);
    ready(WORKER, job_a);
    for (; unit.result.unit < UNITS; unit.result.unit++)
        say(WORKER, &unit);
    ck_assert_int_eq(f.last[ANA].type, MSG_DONE);
}

FIXTURE(set_up_long, tear_down)

static void
ask(uint64_t conn)
{
    struct msg fetch = { .type = MSG_FETCH,
                         .request = 6,
                         .fetch = { job_a, 0, MSG_WHAT_STATS } };

    say(conn, &fetch);
}

/* All connections are Ana's. */
static void
many_ask(void)
{
    for (uint64_t i = FIRST; i < FIRST + MANY; i++) {
        join(i, MSG_ROLE_USER, "", "ana");
        ask(i);
    }
}

/* Each connection is another administrator's. */
static void
many_users_ask(void)
{
    char name[20];

    for (uint64_t i = FIRST; i < FIRST + MANY; i++) {
        snprintf(name, sizeof name, "user%d", (int)i);
        join(i, MSG_ROLE_ADMIN, "", name);
        ask(i);
    }
}

static void
tick(void)
{
    f.now_ms += 100;
    coord_tick(f.c, f.now_ms);
    carry_out();
}

static unsigned
sent_to_all(void)
{
    unsigned n = 0;

    for (int i = 0; i < CONNS; i++)
        n += f.sent[i];
    return n;
}

static bool
has_all(uint64_t conn)
{
    const struct msg_chunk *m = &f.last[conn].chunk;

    return f.last[conn].type == MSG_CHUNK && m->offset + m->len == m->total;
}

/* How many ticks it takes until n connections from `first` on have all. */
static int
ticks_until(uint64_t first, unsigned n)
{
    int ticks = 0;

    for (uint64_t i = first; i < first + n; i++)
        for (; !has_all(i); ticks++) {
            ck_assert_int_lt(ticks, 10000);
            tick();
        }
    return ticks;
}

/* Bytes of the texts that are whole and wait; *making: how many are not. */
static size_t
texts_wait(unsigned *making)
{
    size_t bytes = 0;

    *making = 0;
    for (const struct coord_conn *i = f.c->conns; i; i = i->next)
        for (const struct coord_telling *t = i->telling; t; t = t->next) {
            bytes += t->whole ? t->len : 0;
            *making += t->text != NULL;
        }
    return bytes;
}

/* Ana's connections ask, one after the other, and read nothing: of each text
 * that may be begun all is made. */
static void
texts_pile_up(void)
{
    unsigned making;

    for (uint64_t i = FIRST; i < FIRST + MANY; i++) {
        join(i, MSG_ROLE_USER, "", "ana");
        f.crammed = false; /* or no text is begun */
        ask(i);
        f.crammed = true;
        do
            tick();
        while (texts_wait(&making), making > 0);
    }
}

/* Nobody waits while a MiB of them is packed. */
TEST(long_statistics_are_told_in_pieces)
{
    struct msg_chunk last = { 0 };
    unsigned before;

    ask(ANA);
    for (int i = 0; i < 30; i++) {
        before = f.sent[ANA];
        tick();
        ck_assert_uint_le(f.sent[ANA] - before, CHUNKS);
        if (f.sent[ANA] == before)
            continue;
        ck_assert_int_eq(f.last[ANA].type, MSG_CHUNK);
        ck_assert_uint_gt(f.last[ANA].chunk.offset, last.offset);
        last = f.last[ANA].chunk;
    }
    ck_assert_uint_gt(last.total, 1 << 20);
    ck_assert(has_all(ANA));
}

LOOP_TEST(a_tick_has_the_same_to_do_however_many_wait, 2)
{
    unsigned before;
    uint64_t pieces;

    (_i ? many_users_ask : many_ask)();
    for (int i = 0; i < 100; i++) {
        before = sent_to_all();
        pieces = f.c->pieces_told;
        tick();
        ck_assert_uint_le(sent_to_all() - before, PIECES * CHUNKS);
        ck_assert_uint_le(f.c->pieces_told - pieces, PIECES);
        if (_i) /* Ana's texts are made one after the other */
            ck_assert_uint_eq(f.c->pieces_told - pieces, PIECES);
    }
    ticks_until(FIRST, MANY);
}

TEST(a_user_with_many_connections_holds_up_no_other)
{
    int alone;

    ask(ADMIN);
    alone = ticks_until(ADMIN, 1);
    many_ask();
    f.last[ADMIN].type = 0;
    ask(ADMIN);
    ck_assert_int_le(ticks_until(ADMIN, 1), alone + 1);
}

/* The same where many of the texts are made and wait to be sent. */
TEST(a_user_with_many_texts_holds_up_no_other)
{
    struct coord_limits limits = f.c->limits;
    unsigned making;
    int alone;

    ask(ADMIN);
    alone = ticks_until(ADMIN, 1);
    limits.unread = MANY * (size_t)f.last[ADMIN].chunk.total;
    coord_set_limits(f.c, &limits);
    texts_pile_up();
    f.crammed = false;
    f.last[ADMIN].type = 0;
    ask(ADMIN);
    ck_assert_int_le(ticks_until(ADMIN, 1), alone + 1);
    ck_assert_uint_gt(texts_wait(&making), 0);
}

TEST(what_nobody_reads_is_not_made)
{
    unsigned making, before;

    f.crammed = true;
    many_ask();
    before = sent_to_all();
    for (int i = 0; i < 100; i++)
        tick();
    ck_assert_uint_eq(sent_to_all(), before);
    ck_assert_uint_eq(texts_wait(&making), 0);
    ck_assert_uint_eq(making, 0);
    f.crammed = false;
    ticks_until(FIRST, MANY);
}

TEST(what_is_made_and_not_read_has_a_bound)
{
    struct coord_limits limits = f.c->limits;
    size_t one, most = 0;
    unsigned making;

    ask(ADMIN);
    ticks_until(ADMIN, 1);
    one = (size_t)f.last[ADMIN].chunk.total;
    limits.unread = 2 * one;
    coord_set_limits(f.c, &limits);
    texts_pile_up();
    for (int i = 0; i < 500; i++) {
        size_t bytes;

        f.crammed = i % 5 != 0;
        tick();
        bytes = texts_wait(&making);
        ck_assert_uint_le(bytes, limits.unread + one);
        ck_assert_uint_le(making, 1);
        most = bytes > most ? bytes : most;
    }
    ck_assert_uint_gt(most, 0);
    for (uint64_t i = FIRST; i < FIRST + MANY; i++)
        coord_closed(f.c, f.now_ms, i, "gone");
    f.crammed = false;
    ask(ANA);
    ticks_until(ANA, 1);
}

/* While it waited for its turn the job came to be only on the disk. */
TEST(the_store_tells_of_a_job_that_was_filed_meanwhile)
{
    const struct action_list *l = coord_actions(f.c);
    unsigned fetched = 0;

    f.crammed = true;
    ask(ANA);
    coord_job_filed(f.c, f.now_ms, job_a, job_number(job_a), 0, 0);
    for (int i = 0; i < 100; i++)
        tick();
    ck_assert_int_eq(desk_find_job(f.c, job_a)->place, PLACE_FILED);
    f.crammed = false;
    coord_tick(f.c, f.now_ms += 100);
    for (size_t i = 0; i < l->n; i++)
        fetched += l->v[i].type == ACT_SEND_PICTURE && l->v[i].conn == ANA &&
                   l->v[i].what == MSG_WHAT_STATS && l->v[i].request == 6;
    ck_assert_uint_eq(fetched, 1);
    carry_out();
}
