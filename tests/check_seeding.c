/* check_seeding.c - the parts of space that workers make records of first */
#include "config.h"

#include "coord_fixture.h"

static void
join_worker(uint64_t conn, const char *name, uint16_t threads)
{
    struct coord_peer peer = { "test", "daemon", 14, NULL };
    struct msg m = { .type = MSG_HELLO,
                     .hello = { 1, MSG_VERSION, MSG_ROLE_WORKER, name, "t", "",
                                threads, 0 } };

    coord_opened(f.c, f.now_ms, conn, &peer);
    say(&f, conn, &m);
}

/* By what they can do. */
START_TEST(those_who_begin_together_seed_a_part_each)
{
    join_worker(6, "big", 4);
    submit_with(&f, ANA, job_a, 0, 64, MSG_JOB_SHARE);
    ready(&f, WORKER, job_a);
    ready(&f, 6, job_a);
    ck_assert_int_eq(f.seeds[WORKER], 1);
    ck_assert_int_eq(f.seeds[6], 1);
    const struct msg_seed *a = &f.seed[WORKER], *b = &f.seed[6];

    if (a->first > 0) {
        a = &f.seed[6];
        b = &f.seed[WORKER];
    }
    ck_assert_uint_eq(a->first, 0);
    ck_assert_uint_eq(a->last, b->first);
    ck_assert_uint_eq(b->last, MSG_SEED_ALL);
    ck_assert_double_eq_tol(f.seed[6].last - f.seed[6].first,
                            MSG_SEED_ALL * 2 / 3., 1);
}
END_TEST

START_TEST(nobody_seeds_alone_or_for_itself)
{
    submit_with(&f, ANA, job_a, 0, 64, MSG_JOB_SHARE);
    ready(&f, WORKER, job_a);
    ck_assert_int_eq(f.seeds[WORKER], 0);
    join_worker(5, "late", 2); /* the cache is given to it */
    ready(&f, 5, job_a);
    ck_assert_int_eq(f.seeds[5], 0);
    about(&f, ANA, MSG_CANCEL, job_a);
    submit_with(&f, ANA, job_b, 0, 64, 0);
    ready(&f, WORKER, job_b);
    ready(&f, 5, job_b);
    ck_assert_int_eq(f.seeds[WORKER] + f.seeds[5], 0);
}
END_TEST

/* Who takes long to load finds the records made, and so does its next child. */
START_TEST(one_seeds_once_and_not_late)
{
    static const uint32_t none[1];
    struct msg lost = { .type = MSG_LOST, .lost = { job_a, "gone", 0, none } };

    join_worker(5, "slow", 2);
    submit_with(&f, ANA, job_a, 0, 64, MSG_JOB_SHARE);
    ready(&f, WORKER, job_a);
    ck_assert_int_eq(f.seeds[WORKER], 1);
    wait_s(&f, 2);
    ready(&f, 5, job_a);
    ck_assert_int_eq(f.seeds[5], 0);
    memset(f.units, 0, sizeof f.units);
    say(&f, WORKER, &lost);
    ready(&f, WORKER, job_a);
    ck_assert_int_eq(f.seeds[WORKER], 1);
}
END_TEST

static double
total_stat(const char *key)
{
    char *text = stats_json(desk_find_job(f.c, job_a), f.now_ms);
    json_t *root = json_loads(text, 0, NULL);
    double v = json_number_value(
        json_object_get(json_object_get(root, "totals"), key));

    json_decref(root);
    free(text);
    return v;
}

START_TEST(what_seeding_took_is_in_the_totals)
{
    struct msg m = { .type = MSG_TALLY,
                     .tally = { .job = job_a,
                                .busy_s = 2,
                                .seeded = { .rays = 500,
                                            .ambient_rays = 400,
                                            .ambient_values = 3,
                                            .cpu_s = .25 } } };

    submit(&f, ANA, job_a, 0);
    ready(&f, WORKER, job_a);
    say(&f, WORKER, &m);
    m.tally.busy_s = 1; /* another child's */
    say(&f, WORKER, &m);
    ck_assert_double_eq(total_stat("seed_rays"), 1000);
    ck_assert_double_eq(total_stat("rays"), 1000);
    ck_assert_double_eq(worker_stat("rays"), 1000);
    ck_assert_double_eq(total_stat("ambient_rays"), 800);
    ck_assert_double_eq(total_stat("seed_values"), 6);
    ck_assert_double_eq(total_stat("ambient_values"), 6);
    ck_assert_double_eq(total_stat("seed_s"), .5);
    ck_assert_double_eq(total_stat("primary_rays"), 0);
    ck_assert_double_eq(total_stat("dropped_rays"), 0);
    ck_assert_uint_eq(rays_told(), 1000);
}
END_TEST

int
main(void)
{
    Suite *s = suite_create("seeding");
    TCase *tc = tcase_create("seeding");

    tcase_add_checked_fixture(tc, set_up, tear_down);
    tcase_add_test(tc, those_who_begin_together_seed_a_part_each);
    tcase_add_test(tc, nobody_seeds_alone_or_for_itself);
    tcase_add_test(tc, one_seeds_once_and_not_late);
    tcase_add_test(tc, what_seeding_took_is_in_the_totals);
    suite_add_tcase(s, tc);
    return unit_run(s);
}
