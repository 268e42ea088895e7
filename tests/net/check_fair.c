/* check_fair.c - who is served next, and who has to read first */
#include "config.h"

#include "net/fair.h"

#include "tests/unit.h"

#include <string.h>

enum { PLACES = 4 };

/* Connections that want something each time it is their turn. */
static struct {
    uv_loop_t loop;
    struct fair fair;
    struct fair_place place[PLACES];
    int wants[PLACES];
    char order[100]; /* letters of those who were served */
    uint64_t busy;   /* how long a request takes [ms] */
    uint64_t now_ns;
} t;

static uint64_t
clock_ns(void)
{
    return t.now_ns;
}

/* As a connection that has so many requests. */
static void
on_turn(struct fair_place *p)
{
    int i = (int)(p - t.place);

    while (t.wants[i] > 0 && fair_begin(p)) {
        t.wants[i]--;
        t.order[strlen(t.order)] = (char)('a' + i);
        t.now_ns += t.busy * UINT64_C(1000000);
        fair_done(p);
    }
}

static void
set_up(const char *const users[PLACES])
{
    memset(&t, 0, sizeof t);
    ck_assert_int_eq(uv_loop_init(&t.loop), 0);
    fair_init(&t.fair, &t.loop);
    t.fair.clock = clock_ns;
    for (int i = 0; i < PLACES; i++) {
        t.place[i].user = fair_join(&t.fair, users[i]);
        t.place[i].go = on_turn;
        ck_assert_ptr_nonnull(t.place[i].user);
    }
}

static void
run(void)
{
    for (int i = 0; i < 40; i++)
        uv_run(&t.loop, UV_RUN_NOWAIT);
}

static void
tear_down(void)
{
    for (int i = 0; i < PLACES; i++)
        fair_leave(&t.place[i]);
    fair_close(&t.fair);
    uv_run(&t.loop, UV_RUN_DEFAULT);
    ck_assert_int_eq(uv_loop_close(&t.loop), 0);
}

static const char *const three_and_one[PLACES] = { "ana", "ana", "ana", "bob" };

TEST(who_is_alone_is_served_at_once)
{
    set_up(three_and_one);
    t.wants[0] = 3;
    on_turn(&t.place[0]);
    ck_assert_str_eq(t.order, "aaa");
    tear_down();
}

TEST(users_take_turns_however_many_connections_they_have)
{
    set_up(three_and_one);
    t.busy = 2 * FAIR_MS; /* each takes all of a turn */
    for (int i = 0; i < PLACES; i++)
        t.wants[i] = i < 3 ? 3 : 2;
    for (int i = 0; i < PLACES; i++)
        on_turn(&t.place[i]);
    ck_assert_str_eq(t.order, "a");
    run();
    ck_assert_str_eq(t.order, "aadbdcabcbc");
    tear_down();
}

TEST(who_leaves_too_much_unread_waits_and_others_do_not)
{
    set_up(three_and_one);
    fair_set_unread(&t.fair, 1000);
    fair_owe(&t.place[0], 1000);
    ck_assert_uint_eq(fair_unread(&t.fair, "ana"), 1000);
    ck_assert(fair_full(&t.place[1]) && !fair_full(&t.place[3]));
    for (int i = 0; i < PLACES; i++) {
        t.wants[i] = 1;
        on_turn(&t.place[i]);
    }
    run();
    ck_assert_str_eq(t.order, "d");
    fair_paid(&t.place[0], 100); /* not enough yet */
    run();
    ck_assert_str_eq(t.order, "d");
    fair_paid(&t.place[0], 200);
    run();
    ck_assert_str_eq(t.order, "dabc");
    fair_paid(&t.place[0], 700);
    tear_down();
}

static void
leave_on_turn(struct fair_place *p)
{
    on_turn(p);
    fair_leave(p);
}

TEST(who_leaves_is_in_no_line)
{
    set_up(three_and_one);
    t.busy = 2 * FAIR_MS;
    for (int i = 0; i < PLACES; i++)
        t.wants[i] = 5;
    t.place[1].go = t.place[3].go = leave_on_turn;
    for (int i = 0; i < PLACES; i++)
        on_turn(&t.place[i]);
    fair_leave(&t.place[2]);
    run();
    ck_assert_str_eq(t.order, "aadbaaa");
    ck_assert_uint_eq(fair_unread(&t.fair, "bob"), 0);
    tear_down();
}
