/* check_link.c - a client whose coordinator takes the connection and says
 * nothing: waiting for it ends in time */
#include "config.h"

#include "link/submit.h"
#include "proto/frame.h"
#include "tests/scratch.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

FIXTURE(scratch_make, scratch_remove)

/* A Unix socket that accepts no connection; dialling it succeeds. */
static int
listen_mutely(struct target *to)
{
    struct sockaddr_un a = { .sun_family = AF_UNIX };
    int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);

    snprintf(a.sun_path, sizeof a.sun_path, "%s/mute", dir);
    unlink(a.sun_path);
    ck_assert_int_eq(bind(fd, (struct sockaddr *)&a, sizeof a), 0);
    ck_assert_int_eq(listen(fd, 16), 0);
    ck_assert_int_eq(target_parse(to, a.sun_path, NULL), 0);
    return fd;
}

/* Whoever dialled said HELLO and nothing else: no PING, of which the first
 * comes after 5 s.  Returns how many dialled. */
static int
only_hellos(int fd)
{
    static uint8_t said[MSG_FRAME_MAX];
    int n = 0, c;

    ck_assert_int_eq(fcntl(fd, F_SETFL, O_NONBLOCK), 0);
    for (; (c = accept(fd, NULL, NULL)) >= 0; n++) {
        ssize_t len = recv(c, said, sizeof said, MSG_WAITALL);
        struct msg_header h;

        ck_assert_int_ge(len, MSG_HEADER);
        ck_assert_int_eq(
            frame_header(&h, MSG_AT_COORD_NEW, MSG_VERSION, said, NULL), 0);
        ck_assert_int_eq(h.type, MSG_HELLO);
        ck_assert_uint_eq((size_t)len, MSG_HEADER + h.length);
        close(c);
    }
    return n;
}

/* Pings, which come every 5 s, do not lengthen the wait. */
TEST(no_welcome_is_no_coordinator_in_time)
{
    struct target to;
    int fd = listen_mutely(&to), wake = 0;
    uv_loop_t loop;
    struct link_where where = { &loop, &wake };
    struct rad_error err = { 0 };
    struct link *l;

    uv_loop_init(&loop);
    ck_assert_int_eq(link_open(&l, &where, &to, MSG_ROLE_USER, 400, &err),
                     RAD_EUNAVAIL);
    ck_assert_int_eq(only_hellos(fd), 1);
    ck_assert_ptr_nonnull(strstr(err.what, "does not answer"));
    ck_assert_int_eq(uv_loop_close(&loop), 0);
    close(fd);
}

static void
say(void *arg, const char *text)
{
    (void)arg;
    (void)text;
}

TEST(a_job_does_not_wait_beyond_its_wait)
{
    static const uint8_t id[MSG_JOB];
    const struct msg_spec spec = { .job = id };
    struct submit_job job = { .spec = &spec, .wait_s = 1 };
    struct submit_callbacks cb = { .say = say };
    int fd = listen_mutely(&job.to), wake = 0;
    uv_loop_t loop;
    struct rad_error err = { 0 };

    uv_loop_init(&loop);
    ck_assert_int_eq(submit_run(&job, &loop, &wake, &cb, &err), RAD_EUNAVAIL);
    ck_assert_int_ge(only_hellos(fd), 1);
    ck_assert_int_eq(uv_loop_close(&loop), 0);
    close(fd);
}
