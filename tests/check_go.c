/* check_go.c - the states of an attempt, and what may follow what */
#include "config.h"

#include "desk/go.h"
#include "unit.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

/* As in the drawing at the head of go.c, which this says again on purpose. */
static const char *const follow[GO_STATES][GO_STATES + 1] = {
    [GO_OVER] = { "working" },
    [GO_WORKING] = { "parked", "blocked", "yielding", "delivered", "over" },
    [GO_PARKED] = { "working", "yielding", "delivered", "over" },
    [GO_BLOCKED] = { "working", "yielding", "delivered", "over" },
    [GO_YIELDING] = { "delivered", "over" },
    [GO_DELIVERED] = { "over" },
};

static bool
follows(enum go_state from, enum go_state to)
{
    for (int i = 0; follow[from][i]; i++)
        if (strcmp(follow[from][i], go_state_name(to)) == 0)
            return true;
    return false;
}

/* The signal that ends a process which takes the step; 0: it lives. */
static int
signal_of_step(enum go_state from, enum go_state to)
{
    struct job_go go = { .state = from };
    int status;
    pid_t pid = fork();

    ck_assert_int_ge(pid, 0);
    if (pid == 0) {
        setrlimit(RLIMIT_CORE, &(struct rlimit){ 0 });
        if (!freopen("/dev/null", "w", stderr)) /* what assert() says */
            _exit(1);
        go_step(&go, to);
        _exit(go.state == to ? 0 : 2);
    }
    ck_assert_int_eq(waitpid(pid, &status, 0), pid);
    if (WIFSIGNALED(status))
        return WTERMSIG(status);
    ck_assert_int_eq(WEXITSTATUS(status), 0);
    return 0;
}

START_TEST(the_steps_of_the_drawing_and_no_others_can_be_taken)
{
    enum go_state from = (enum go_state)(_i / GO_STATES);
    enum go_state to = (enum go_state)(_i % GO_STATES);

    ck_assert_int_eq(go_permits(from, to), follows(from, to));
    ck_assert_int_eq(signal_of_step(from, to), follows(from, to) ? 0 : SIGABRT);
}
END_TEST

START_TEST(an_attempt_works_or_waits_or_neither)
{
    static const struct {
        bool works, waits;
    } is[GO_STATES] = {
        [GO_WORKING] = { .works = true }, [GO_PARKED] = { .waits = true },
        [GO_BLOCKED] = { .waits = true }, [GO_YIELDING] = { .waits = true },
        [GO_DELIVERED] = { false },
    };
    const struct job_go go = { .state = (enum go_state)_i };

    ck_assert_int_eq(go_works(&go), is[_i].works);
    ck_assert_int_eq(go_waits(&go), is[_i].waits);
}
END_TEST

int
main(void)
{
    Suite *s = suite_create("go");
    TCase *tc = tcase_create("states");

    tcase_add_loop_test(tc, the_steps_of_the_drawing_and_no_others_can_be_taken,
                        0, GO_STATES * GO_STATES);
    tcase_add_loop_test(tc, an_attempt_works_or_waits_or_neither, 0, GO_STATES);
    suite_add_tcase(s, tc);
    return unit_run(s);
}
