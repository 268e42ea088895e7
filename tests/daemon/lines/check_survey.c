/* check_survey.c - what lines cost: estimated before, and told after */
#include "config.h"

#include "lines_fixture.h"

FIXTURE(set_up, tear_down)

static void
line_costs(uint32_t frame, uint32_t line, uint32_t nlines)
{
    static const uint64_t ns[LINES] = { 1000000000, 2000000000, 500000000 };
    struct msg m = { .type = MSG_LINE_COSTS,
                     .line_costs = { id, frame, line, nlines, ns } };

    say(W1, &m);
}

/* The statistics' line_s; *root is to be released.  NULL: they have none. */
static json_t *
line_stats(json_t **root)
{
    char *text = stats_text(desk_find_job(f.c, id), f.now_ms);

    *root = json_loads(text, 0, NULL);
    free(text);
    return json_object_get(*root, "line_s");
}

/* What all who were at a line spent; of none that the picture does not have. */
TEST(what_lines_cost_is_added_up)
{
    static const double want[LINES] = { 1, 3, 2.5, .5 };
    json_t *root, *costs;

    start(MSG_PART_SCANBAR, 0, 2);
    ck_assert_ptr_null(line_stats(&root));
    json_decref(root);
    line_costs(0, 0, 3);
    line_costs(0, 1, 3);
    line_costs(1, 0, 3);
    line_costs(0, LINES - 2, 3);
    line_costs(0, UINT32_MAX, 3);
    costs = line_stats(&root);
    ck_assert_uint_eq(json_array_size(costs), 1);
    costs = json_array_get(costs, 0);
    ck_assert_uint_eq(json_array_size(costs), LINES);
    for (size_t i = 0; i < LINES; i++)
        ck_assert_double_eq(json_number_value(json_array_get(costs, i)),
                            want[i]);
    ck_assert(!f.closed[W1]);
    json_decref(root);
}

/* Of what a worker that is lost has done nothing is said: what is known is not
 * all. */
TEST(what_lines_cost_is_not_told_by_half)
{
    json_t *root;

    start(MSG_PART_SCANBAR, 0, 2);
    line_costs(0, 0, LINES);
    ck_assert_ptr_nonnull(line_stats(&root));
    json_decref(root);
    coord_closed(f.c, f.now_ms, W2, "cut");
    ck_assert_ptr_null(line_stats(&root));
    json_decref(root);
}

static void
estimated(uint64_t conn, const struct msg_estimate *m, uint32_t n)
{
    static const struct msg_cost cost[64] = { { 30, 7 }, { 30, 7 } };
    struct msg r = {
        .type = MSG_ESTIMATED,
        .estimated = { id, m->id, n, cost, { .rays = 9, .estimate_rays = 5 } }
    };

    say(conn, &r);
}

TEST(an_estimate_comes_before_the_first_unit)
{
    uint32_t chunks = 0;

    submit(MSG_PART_STATIC, 0, "20b", 1);
    ready(W1);
    ck_assert_int_eq(count(W1, MSG_UNIT), 0);
    ck_assert_uint_eq(last(W1, MSG_ESTIMATE)->m.estimate.rays, 20);
    ready(W2);
    f.now_ms += 50;
    for (int w = W1; !last(W1, MSG_UNIT); w = w == W1 ? W2 : W1) {
        struct msg_estimate m = last((uint64_t)w, MSG_ESTIMATE)->m.estimate;

        estimated((uint64_t)w, &m, m.nareas);
        ck_assert_uint_le(++chunks, 2 * LINES);
    }
    ck_assert_uint_gt(chunks, 4);
    ck_assert_int_eq(count(W2, MSG_UNIT), 1);
    /* two areas of each chunk cost something */
    ck_assert_double_eq(stat_of("totals", "estimate_rays"), 5 * chunks);
    ck_assert_double_eq(stat_of("time", "estimate_s"), .05);
}

TEST(areas_of_a_lost_or_late_worker_go_to_another)
{
    uint32_t lost;

    submit(MSG_PART_STATIC, 0, "5a", 1);
    ready(W1);
    lost = last(W1, MSG_ESTIMATE)->m.estimate.id;
    cut(W1);
    ready(W2);
    ck_assert_uint_eq(last(W2, MSG_ESTIMATE)->m.estimate.id, lost);
    join(W3, MSG_ROLE_WORKER, "ws3", "");
    ready(W3);
    for (int i = 0; i < 40; i++) { /* ws3 does all but that one */
        struct msg_estimate m = last(W3, MSG_ESTIMATE)->m.estimate;

        estimated(W3, &m, m.nareas);
    }
    ck_assert_ptr_null(last(W3, MSG_UNIT));
    wait_ms(3000);
    ck_assert_uint_eq(last(W3, MSG_ESTIMATE)->m.estimate.id, lost);
    estimated(W3, &last(W3, MSG_ESTIMATE)->m.estimate,
              last(W3, MSG_ESTIMATE)->m.estimate.nareas);
    ck_assert_ptr_nonnull(last(W3, MSG_UNIT));
}

TEST(an_estimate_of_other_areas_ends_the_connection)
{
    struct msg_estimate m;

    submit(MSG_PART_STATIC, 0, "5a", 1);
    ready(W1);
    m = last(W1, MSG_ESTIMATE)->m.estimate;
    estimated(W1, &m, m.nareas + 1);
    ck_assert(f.closed[W1]);
}

static void
child_dies(uint64_t conn)
{
    struct msg m = { .type = MSG_LOST,
                     .lost = { id, EX_SOFTWARE, "signal 11", 0, NULL } };

    say(conn, &m);
    ready(conn);
}

/* The unit that has the pixel will be told from the others. */
TEST(an_estimate_that_children_die_of_is_given_up)
{
    submit(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, "5a", 1);
    ready(W1);
    child_dies(W1);
    ck_assert_int_eq(count(W1, MSG_UNIT), 0);
    ck_assert_int_eq(count(W1, MSG_ESTIMATE), 2);
    child_dies(W1);
    ck_assert_int_eq(count(W1, MSG_UNIT), 1);
    ck_assert_int_eq(count(W1, MSG_ESTIMATE), 2);
}

TEST(an_estimate_whose_last_areas_children_die_of_is_given_up)
{
    struct msg_estimate k;

    submit(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, "5a", 1);
    ready(W1);
    for (k = last(W1, MSG_ESTIMATE)->m.estimate; k.id < LINES - 1;
         k = last(W1, MSG_ESTIMATE)->m.estimate)
        estimated(W1, &k, k.nareas);
    child_dies(W1);
    ck_assert_int_eq(count(W1, MSG_UNIT), 0);
    ck_assert_uint_eq(last(W1, MSG_ESTIMATE)->m.estimate.id, LINES - 1);
    child_dies(W1);
    ck_assert_int_eq(count(W1, MSG_UNIT), 1);
}

TEST(an_estimate_that_nobody_asked_for_is_ignored)
{
    struct msg_estimate m = { .id = UINT32_MAX, .nareas = 1 };

    submit(MSG_PART_STATIC, 0, "5a", 1);
    ready(W1);
    ready(W2);
    for (int i = 0; i < 40; i++) { /* ws1 does all but what ws2 has */
        struct msg_estimate k = last(W1, MSG_ESTIMATE)->m.estimate;

        estimated(W1, &k, k.nareas);
    }
    estimated(W1, &m, 1); /* 1 more than none is its number */
    ck_assert(!f.closed[W1]);
    ck_assert_ptr_null(last(W1, MSG_UNIT));
}

TEST(threads_that_estimate_count_for_the_owner)
{
    struct msg cancel = { .type = MSG_CANCEL, .cancel = { id } };
    const struct coord_owner *owner;

    submit(MSG_PART_STATIC, 0, "5a", 1);
    owner = desk_find_job(f.c, id)->payer;
    ck_assert_uint_eq(owner->threads, 0);
    ready(W1);
    ck_assert_uint_gt(owner->threads, 0);
    say(ANA, &cancel);
    ck_assert_uint_eq(owner->threads, 0);
}

TEST(a_worker_that_estimates_stays_at_it)
{
    static const uint8_t bobs[MSG_JOB] = { 0xbb };
    struct msg m = { .type = MSG_SUBMIT,
                     .request = 5,
                     .submit = { .job = bobs,
                                 .manifest = hash,
                                 .name = "n",
                                 .params = "-ps 4",
                                 .needs = "",
                                 .estimate = "5a",
                                 .partition = MSG_PART_STATIC,
                                 .files = { 1, hash },
                                 .nframes = 1,
                                 .frames = frames } };

    join(ADMIN, MSG_ROLE_USER, "", "bob");
    submit(MSG_PART_STATIC, 0, "5a", 1);
    ready(W1);
    say(ADMIN, &m);
    ck_assert_ptr_nonnull(desk_find_job(f.c, bobs));
    ck_assert_int_eq(count(W1, MSG_JOB_START), 1);
}
