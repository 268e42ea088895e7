/* check_coord_conns.c - who is let in by the coordinator, as what, and how
 * often */
#include "config.h"

#include "coord_fixture.h"

FIXTURE(set_up, tear_down)

TEST(a_new_connection_of_a_name_replaces_the_old)
{
    start_job();
    join(SECOND, MSG_ROLE_WORKER, "ws1", "daemon");
    ck_assert(f.closed[WORKER]);
    ck_assert_int_eq(f.last[SECOND].type, MSG_JOB_START);
    result(SECOND, job_a, 0, 1); /* finished before the connection broke */
    ck_assert_int_eq(f.last[SECOND].type, MSG_ACK);
    ready(SECOND, job_a);
    ck_assert_uint_eq(f.units[SECOND], 2);
    for (uint32_t u = 1; u < 4; u++)
        result(SECOND, job_a, u, u == 1 ? 2 : 1);
    ck_assert_int_eq(f.last[ANA].type, MSG_DONE);
}

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

LOOP_TEST(a_hello_that_does_not_fit_is_refused, N_ELEM(hellos))
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
    say(7, &m);
    ck_assert_int_eq(f.last[7].type, MSG_REFUSE);
    ck_assert_int_eq(f.last[7].refuse.status, hellos[_i].status);
    ck_assert(f.closed[7]);
}

TEST(a_worker_that_calls_again_replaces_itself)
{
    join(7, MSG_ROLE_WORKER, "w", "x");
    ck_assert(!f.closed[7]);
    join(6, MSG_ROLE_WORKER, "w", "x");
    ck_assert_int_eq(f.last[7].type, MSG_BYE);
    ck_assert_str_eq(f.last[7].bye.text,
                     "replaced by a connection of that name from test");
    ck_assert(f.closed[7]);
    ck_assert_int_eq(f.last[6].type, MSG_WELCOME);
}

static void
call(uint64_t conn, unsigned roles, const char *owner, bool hello)
{
    struct coord_peer peer = { "test", owner, roles, NULL };
    struct msg m = { .type = MSG_HELLO,
                     .hello = { MSG_VERSION_MIN, MSG_VERSION, MSG_ROLE_USER, "",
                                "t", "", 0, 0 } };

    coord_opened(f.c, f.now_ms, conn, &peer);
    carry_out();
    if (hello)
        say(conn, &m);
}

/* A user, by a socket or a key, has 256; who steers or renders has any. */
TEST(one_user_has_not_all_connections)
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
    cut(first);
    call(first + 259, user, "eve", true);
    ck_assert_int_eq(f.last[first + 259].type, MSG_WELCOME);
}

/* Nor do those that say nothing keep the next one out. */
TEST(a_silent_connection_goes_when_a_user_has_too_many)
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

/* One that calls for ever does not fill the log; of workers each is said. */
TEST(refused_connections_are_logged_some_at_a_time)
{
    const unsigned user = 1u << MSG_ROLE_USER, first = 10;
    unsigned i;

    for (i = 0; i < 286; i++)
        call(first + i, user, "eve", true);
    ck_assert(f.closed[first + 256] && f.closed[first + 285]);
    ck_assert_int_eq(f.break_logs, 10);
    join(7, MSG_ROLE_WORKER, "w", "x");
    join(6, MSG_ROLE_WORKER, "w", "x");
    ck_assert_int_eq(f.break_logs, 11);
    wait_s(11);
    call(first + i, user, "eve", true);
    ck_assert_int_eq(f.break_logs, 12);
    ck_assert_int_eq(f.unlogged, 20);
}

static const struct {
    uint16_t min, max, spoken; /* 0: it is refused */
} versions[] = { { 1, 1, 1 }, { 1, 9, 1 }, { 2, 9, 0 } };

/* The highest that both know: told in the WELCOME, and to the shell. */
LOOP_TEST(newer_peers_are_welcome_if_they_speak_ours, N_ELEM(versions))
{
    struct coord_peer peer = { "test", "x", 14, NULL };
    struct msg m = { .type = MSG_HELLO,
                     .hello = { versions[_i].min, versions[_i].max,
                                MSG_ROLE_WORKER, "w", "t", "", 1, 0 } };

    coord_opened(f.c, f.now_ms, 7, &peer);
    say(7, &m);
    if (versions[_i].spoken == 0) {
        ck_assert_int_eq(f.last[7].type, MSG_REFUSE);
        ck_assert_uint_eq(f.last[7].refuse.status, EX_PROTOCOL);
        return;
    }
    ck_assert_int_eq(f.last[7].type, MSG_WELCOME);
    ck_assert_uint_eq(f.last[7].welcome.version, versions[_i].spoken);
    ck_assert_uint_eq(f.version[7], versions[_i].spoken);
}

/* Two workers speak with each other what both know. */
TEST(peers_are_told_the_version_of_the_pair)
{
    static const uint16_t max[] = { 9, 1, 9 };
    static const char *const name[] = { "w1", "w2", "w3" };
    uint16_t told[3] = { 0 };

    submit_with(ANA, job_a, 0, 64, MSG_JOB_SHARE);
    for (unsigned i = 0; i < 3; i++) {
        struct coord_peer peer = { "test", "x", 14, NULL };
        struct msg m = { .type = MSG_HELLO,
                         .hello = { 1, max[i], MSG_ROLE_WORKER, name[i], "t",
                                    "unix /w", 1, 0 } };

        coord_opened(f.c, f.now_ms, 5 + i, &peer);
        say(5 + i, &m);
        ready(5 + i, job_a);
        for (unsigned k = 0; k <= i; k++)
            if (f.peers[5 + k] > 0)
                told[k] = f.peer_version[5 + k];
    }
    for (unsigned i = 0; i < 3; i++)
        ck_assert_uint_eq(told[i], MSG_VERSION);
}

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

LOOP_TEST(a_credential_is_good_for_its_roles_alone, N_ELEM(credentials))
{
    const bool *may = &credentials[_i].worker;

    for (unsigned role = MSG_ROLE_WORKER; role <= MSG_ROLE_ADMIN; role++) {
        struct coord_peer peer = { "test", "x", credentials[_i].roles, NULL };
        uint64_t conn = 4 + role;
        struct msg m = { .type = MSG_HELLO,
                         .hello = { 1, 1, (uint8_t)role, "w", "t", "", 1, 0 } };

        coord_opened(f.c, f.now_ms, conn, &peer);
        say(conn, &m);
        ck_assert_int_eq(f.last[conn].type, may[role - MSG_ROLE_WORKER]
                                                ? MSG_WELCOME
                                                : MSG_REFUSE);
        ck_assert(f.closed[conn] == !may[role - MSG_ROLE_WORKER]);
    }
}

/* In a JOB_PEERS: that the link with ws2 of job_a ends. */
static bool
drops_second(uint64_t conn)
{
    const struct msg_job_peers *p = &f.last[conn].job_peers;

    return f.last[conn].type == MSG_JOB_PEERS && p->npeers == 1 &&
           p->peers[0].flags == MSG_PEER_DROP &&
           strcmp(p->peers[0].name, "ws2") == 0;
}

/* Links outlive connections to the coordinator, so those of a worker that is
 * expelled end with whoever is there, and with others when they come back. */
TEST(an_expelled_worker_loses_its_links_connected_or_not)
{
    start_job();
    second_ready(job_a);
    cut(SECOND);
    ck_assert(!drops_second(WORKER));
    coord_expel(f.c, f.now_ms, "ws2");
    carry_out();
    ck_assert(drops_second(WORKER));
    cut(WORKER);
    join(STRANGER, MSG_ROLE_WORKER, "ws1", "daemon");
    ready(STRANGER, job_a);
    ck_assert_int_eq(f.peers[STRANGER], 1);
    join(7, MSG_ROLE_WORKER, "ws2", "daemon"); /* by a new key */
    join(8, MSG_ROLE_WORKER, "ws3", "daemon");
    ready(8, job_a);
    ck_assert_int_eq(f.peers[8], 0); /* nobody is expelled any more */
}
