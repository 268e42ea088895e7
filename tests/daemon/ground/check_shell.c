/* check_shell.c - what both daemons' shells have in common */
#include "config.h"

#include "radd/children.h"
#include "shell/shell.h"
#include "tests/unit.h"

#include <sys/wait.h>
#include <sysexits.h>
#include <unistd.h>

enum { MORE = 200 };

static struct action_list list;
static int ncarried;

/* The first brings about many others, as a key that is retired does. */
static void
on_action(void *arg, const struct action *a)
{
    (void)arg;
    ck_assert(a < list.v || a >= list.v + list.cap); /* which moves */
    if (ncarried == 0)
        for (int i = 0; i < MORE; i++)
            ck_assert_ptr_nonnull(actions_add(&list, ACT_KEY, (uint64_t)i + 2));
    ncarried++;
    ck_assert_uint_eq(a->conn, (uint64_t)ncarried);
}

TEST(an_action_stays_while_it_brings_about_others)
{
    static const struct shell_ops ops = { .action = on_action };
    struct shell s;

    actions_init(&list);
    shell_init(&s, NULL, &ops, NULL);
    s.actions = &list;
    ck_assert_ptr_nonnull(actions_add(&list, ACT_KEY, 1));
    shell_run(&s);
    ck_assert_int_eq(ncarried, 1 + MORE);
    ck_assert_uint_eq(list.n, 0);
    shell_close(&s);
    actions_release(&list);
}

static void
on_any_action(void *arg, const struct action *a)
{
    (void)arg;
    (void)a;
    _exit(EX_SOFTWARE);
}

/* What follows an action that is missing may stand on it. */
TEST(actions_of_which_one_found_no_memory_are_not_carried_out)
{
    static const struct shell_ops ops = { .action = on_any_action };
    struct shell s;
    int status;
    pid_t pid = fork();

    if (pid == 0) {
        actions_init(&list);
        shell_init(&s, NULL, &ops, NULL);
        s.actions = &list;
        actions_add(&list, ACT_KEY, 1);
        list.failed = true;
        shell_run(&s);
        _exit(EX_OK);
    }
    ck_assert_int_eq(waitpid(pid, &status, 0), pid);
    ck_assert(WIFEXITED(status));
    ck_assert_int_eq(WEXITSTATUS(status), EX_OSERR);
}

TEST(a_child_gets_no_more_of_an_environment_than_it_needs)
{
    static char given[][40] = { "PATH=/bin",          "TZ=Europe/Vienna",
                                "SECRET=sesame",      "LD_LIBRARY_PATH=/lib",
                                "LD_LIBRARY_PATHS=1", "NOTIFY_SOCKET=/run/n",
                                "TZ" };
    char *all[8] = { NULL };
    char *got[CHILDREN_MAX_ENV + 1];

    for (int i = 0; i < 7; i++)
        all[i] = given[i];
    children_environment(all, got);
    ck_assert_str_eq(got[0], "TZ=Europe/Vienna");
    ck_assert_str_eq(got[1], "LD_LIBRARY_PATH=/lib");
    ck_assert_ptr_null(got[2]);
}

TEST(a_name_that_comes_often_fills_no_more_than_there_is)
{
    static char zone[] = "TZ=UTC";
    char *all[3 * CHILDREN_MAX_ENV + 1] = { NULL };
    char *got[CHILDREN_MAX_ENV + 1];

    for (int i = 0; i < 3 * CHILDREN_MAX_ENV; i++)
        all[i] = zone;
    children_environment(all, got);
    ck_assert_str_eq(got[CHILDREN_MAX_ENV - 1], "TZ=UTC");
    ck_assert_ptr_null(got[CHILDREN_MAX_ENV]);
}
