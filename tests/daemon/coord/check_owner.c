/* check_owner.c - tests of daemon/users/owner.c: one person is one owner */
#include "config.h"

#include "net/conn.h"
#include "users/owner.h"
#include "tests/unit.h"

#include <pwd.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { MOST = 100 };

struct seen {
    int n;
    char owner[MOST][OWNER_TEXT];
    bool refused;
};

static void
on_login(void *arg, uv_stream_t *stream, const char *owner)
{
    struct seen *s = arg;

    s->refused |= !owner;
    if (owner)
        snprintf(s->owner[s->n++], OWNER_TEXT, "%s", owner);
    conn_stream_close(stream);
}

static uv_stream_t *
stream_of_mine(uv_loop_t *loop, int *other)
{
    uv_stream_t *stream = conn_stream_new(loop, true);
    int fd[2];

    ck_assert_int_eq(socketpair(AF_UNIX, SOCK_STREAM, 0, fd), 0);
    ck_assert_int_eq(uv_pipe_open((uv_pipe_t *)stream, fd[0]), 0);
    *other = fd[1];
    return stream;
}

/* As the system calls the user of that number. */
static void
name_of(uid_t uid, char name[OWNER_TEXT])
{
    const struct passwd *pw = getpwuid(uid);

    if (pw)
        snprintf(name, OWNER_TEXT, "%s", pw->pw_name);
    else
        snprintf(name, OWNER_TEXT, "uid:%ld", (long)uid);
}

TEST(socket_gives_the_login)
{
    char mine[OWNER_TEXT];
    struct seen seen = { 0 };
    uv_loop_t loop;
    struct owners *o;
    int other[10];

    name_of(geteuid(), mine);
    uv_loop_init(&loop);
    o = owners_new(&loop, on_login, &seen);
    for (int i = 0; i < 10; i++)
        owners_local(o, stream_of_mine(&loop, &other[i]));
    uv_run(&loop, UV_RUN_DEFAULT);
    ck_assert_int_eq(seen.n, 10);
    ck_assert(!seen.refused);
    for (int i = 0; i < 10; i++) {
        ck_assert_str_eq(seen.owner[i], mine);
        close(other[i]);
    }
    /* and now it is known: at once */
    owners_local(o, stream_of_mine(&loop, &other[0]));
    ck_assert_int_eq(seen.n, 11);
    close(other[0]);
    owners_close(o);
    uv_run(&loop, UV_RUN_DEFAULT);
    owners_free(o);
    ck_assert_int_eq(uv_loop_close(&loop), 0);
}

TEST(those_that_wait_are_bounded_and_closed_at_the_end)
{
    struct seen seen = { 0 };
    uv_loop_t loop;
    struct owners *o;
    int other[MOST];

    uv_loop_init(&loop);
    o = owners_new(&loop, on_login, &seen);
    for (int i = 0; i < MOST; i++)
        owners_local(o, stream_of_mine(&loop, &other[i]));
    ck_assert(seen.refused);
    ck_assert_int_eq(seen.n, 0);
    owners_close(o);
    uv_run(&loop, UV_RUN_DEFAULT);
    ck_assert_int_eq(seen.n, 0);
    owners_free(o);
    ck_assert_int_eq(uv_loop_close(&loop), 0);
    for (int i = 0; i < MOST; i++)
        close(other[i]);
}

/* nobody has uid 0 but root, and these logins are on no machine of ours */
static const struct {
    enum msg_role role;
    const char *key, *owner;
} keys[] = {
    { MSG_ROLE_USER, "bob", "bob" },
    { MSG_ROLE_USER, "bob.smith", "rsmith" }, /* mapped */
    { MSG_ROLE_USER, "bob.smit", "bob.smit" },
    { MSG_ROLE_USER, "mail", "user:mail" }, /* mapped to nobody */
    { MSG_ROLE_USER, "root", "user:root" },
    { MSG_ROLE_USER, "boss", "user:boss" }, /* mapped to root */
    { MSG_ROLE_ADMIN, "root", "root" },
    { MSG_ROLE_ADMIN, "boss", "root" },
    { MSG_ROLE_ADMIN, "mail", "admin:mail" },
};

LOOP_TEST(key_gives_the_login_that_it_is_for, N_ELEM(keys))
{
    uv_loop_t loop;
    struct owners *o;
    struct key k = { .role = keys[_i].role };
    char owner[OWNER_TEXT];

    snprintf(k.name, sizeof k.name, "%s", keys[_i].key);
    uv_loop_init(&loop);
    o = owners_new(&loop, on_login, NULL);
    owners_set_map(o, "bob.smith=rsmith, mail=-,boss=root");
    owners_of_key(o, &k, owner);
    ck_assert_str_eq(owner, keys[_i].owner);
    owners_free(o);
    uv_loop_close(&loop);
}

TEST(users_key_is_not_the_daemons_own_user)
{
    char mine[OWNER_TEXT], owner[OWNER_TEXT], want[2 * OWNER_TEXT];
    struct key k = { .role = MSG_ROLE_USER };
    uv_loop_t loop;
    struct owners *o;

    name_of(geteuid(), mine);
    snprintf(k.name, sizeof k.name, "%s", mine);
    snprintf(want, sizeof want, "user:%s", mine);
    uv_loop_init(&loop);
    o = owners_new(&loop, on_login, NULL);
    owners_of_key(o, &k, owner);
    ck_assert_str_eq(owner, want);
    owners_free(o);
    uv_loop_close(&loop);
}

static const struct {
    const char *map;
    int rc;
} maps[] = {
    { "", 0 },
    { " , ", 0 },
    { "a=b", 0 },
    { "a=b,c=-, d.e=DOMAIN\\f", 0 },
    { "a", RAD_EUSAGE },
    { "a=", RAD_EUSAGE },
    { "=b", RAD_EUSAGE },
    { "a=b,c", RAD_EUSAGE },
    { "user:a=b", RAD_EUSAGE }, /* a name, not an id */
    { "a=user:b", RAD_EUSAGE },
    { "a=uid:0", RAD_EUSAGE },
};

LOOP_TEST(map_is_checked, N_ELEM(maps))
{
    ck_assert_int_eq(owners_check_map(maps[_i].map, NULL), maps[_i].rc);
}

TEST(owner_of_before_is_the_login)
{
    char mine[OWNER_TEXT], saved[OWNER_TEXT], owner[OWNER_TEXT];

    name_of(geteuid(), mine);
    snprintf(saved, sizeof saved, "uid:%ld", (long)geteuid());
    owners_of_saved(saved, owner);
    ck_assert_str_eq(owner, mine);
    owners_of_saved("bob", owner);
    ck_assert_str_eq(owner, "bob");
    owners_of_saved("uid:bob", owner);
    ck_assert_str_eq(owner, "uid:bob");
    owners_of_saved("uid:-1", owner);
    ck_assert_str_eq(owner, "uid:-1");
    owners_of_saved("uid:4294967299", owner); /* 3, if it were cut */
    ck_assert_str_eq(owner, "uid:4294967299");
    owners_of_saved("uid:4000000000", owner); /* nobody's */
    ck_assert_str_eq(owner, "uid:4000000000");
}
