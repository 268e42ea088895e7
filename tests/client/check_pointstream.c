/* check_pointstream.c - when points on a pipe are due as a batch */
#include "config.h"

#include "points/pointstream.h"

#include "tests/unit.h"

#include <string.h>
#include <unistd.h>

/* Milliseconds that are certainly less than a pause after which the writer may
 * be waiting, and no less than the pause of one that asks. */
#define SOON_MS 25

static struct pointspec spec;
static struct pointstream input;
static uv_loop_t loop;
static int to; /* the pipe whose end is standard input */

static void
set_up(void)
{
    int fd[2];

    ck_assert_int_eq(pipe(fd), 0);
    ck_assert_int_ge(dup2(fd[0], STDIN_FILENO), 0);
    close(fd[0]);
    to = fd[1];
    uv_loop_init(&loop);
    pointspec_init(&spec);
}

static void
tear_down(void)
{
    pointstream_close(&input);
    uv_loop_close(&loop);
    close(to);
}

static void
come(const char *text)
{
    size_t n = strlen(text);

    ck_assert_int_eq(write(to, text, n), (ssize_t)n);
    uv_run(&loop, UV_RUN_NOWAIT);
}

FIXTURE(set_up, tear_down)

#define RAY  "0 0 1 0 0 -1\n"
#define NONE "0 0 0 0 0 0\n"

static const struct {
    int x, y;
    const char *text;
    bool soon;
} came[] = {
    { 0, 0, RAY, false },
    { 0, 0, RAY NONE, true },
    { 0, 0, RAY RAY NONE, true },
    { 0, 0, NONE, false },
    { 0, 0, RAY NONE NONE, false }, /* outside of a fish-eye's circle */
    { 0, 0, RAY NONE RAY, false },
    { 1, 0, RAY, true },
    { 1, 3, RAY, true },
    { 2, 0, RAY, false },
    { 2, 0, RAY RAY, true },
    { 2, 0, RAY RAY RAY, false },
    { 2, 3, RAY RAY, false }, /* rtrace flushes only at the end */
};

LOOP_TEST(batch_is_due_soon_where_the_writer_asks, N_ELEM(came))
{
    spec.x = came[_i].x;
    spec.y = came[_i].y;
    ck_assert_int_eq(pointstream_open(&input, &spec, &loop, NULL), 0);
    come(came[_i].text);
    ck_assert_int_eq(pointstream_due_in(&input) < SOON_MS, came[_i].soon);
}
END_TEST

TEST(x_counts_points_that_were_taken)
{
    struct pointfile batch = { 0 };

    spec.x = 3;
    ck_assert_int_eq(pointstream_open(&input, &spec, &loop, NULL), 0);
    come(RAY RAY);
    ck_assert_int_eq(pointstream_take(&input, &batch, NULL), 0);
    pointfile_release(&batch);
    come(RAY);
    ck_assert_uint_lt(pointstream_due_in(&input), SOON_MS);
}
END_TEST
