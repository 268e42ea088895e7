/* check_shell.c - what both daemons' shells have in common */
#include "config.h"

#include "shell.h"
#include "unit.h"

#include <uv.h>

enum { MORE = 200 };

static struct action_list list;
static int ncarried;

static struct action_list *
actions(void *arg)
{
    (void)arg;
    return &list;
}

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

START_TEST(an_action_stays_while_it_brings_about_others)
{
    static const struct shell_ops ops = { .action = on_action,
                                          .actions = actions };
    struct shell s;

    actions_init(&list);
    shell_init(&s, uv_default_loop(), &ops, NULL);
    ck_assert_ptr_nonnull(actions_add(&list, ACT_KEY, 1));
    shell_run(&s);
    ck_assert_int_eq(ncarried, 1 + MORE);
    ck_assert_uint_eq(list.n, 0);
    shell_close(&s);
    actions_release(&list);
}
END_TEST

int
main(void)
{
    Suite *s = suite_create("shell");
    TCase *tc = tcase_create("shell");

    tcase_add_test(tc, an_action_stays_while_it_brings_about_others);
    suite_add_tcase(s, tc);
    return unit_run(s);
}
