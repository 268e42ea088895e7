/* check_coord_stages.c - stages of a job that has a goal */
#include "config.h"

#include "coord_passes_fixture.h"

#include "filling/stages.h"
#include "machine/jobtext.h"
#include "machine/sums.h"
#include "refine/refine.h"

#include <math.h>

FIXTURE(set_up, tear_down)

static void
submit_goal(uint32_t error_ppm, uint32_t time_ms)
{
    struct msg m = passes_submit(&wide, 1);

    m.submit.error_ppm = error_ppm;
    m.submit.time_ms = time_ms;
    say(ANA, &m);
}

static void
send_sums(uint64_t conn, uint32_t pass, uint32_t tile, double v, size_t cut)
{
    struct rad_refine_sums sums = { 0 };
    double *sum = sums.doubt.v;
    struct wire_out w;
    struct msg m = { .type = MSG_TILE_MADE,
                     .tile_made = { .job = job_a,
                                    .pass = pass,
                                    .tile = tile,
                                    .counts = { .rays = tile_rays,
                                                .cpu_s = tile_cpu_s } } };

    sum[RAD_DOUBT_PLACES] = sum[RAD_DOUBT_AREAS] = 1;
    sum[RAD_DOUBT_AMBIENT] = sum[RAD_DOUBT_SAID] = v;
    wire_out_init(&w, SUMS_BYTES);
    sums_pack(&w, &sums);
    m.tile_made.data = w.buf;
    m.tile_made.len = w.len - cut;
    say(conn, &m);
    wire_out_release(&w);
    hold(true);
}

/* Is the open pass the last of a stage, which is its check pass? */
static bool
checks(void)
{
    return state().open + 1 == state().n;
}

/* All tiles of the stage that begins with that pass, those of its check pass
 * with a square of the error; the job is at rest before the last, so that
 * nothing hides what is said at its end. */
static void
make_stage(uint64_t conn, uint32_t base, double square)
{
    struct job *job = desk_find_job(f.c, job_a);

    for (uint32_t pass = 0; pass < PASSES; pass++)
        for (uint32_t i = 0; i < tiles_of(pass); i++)
            made(conn, base + pass, i, 1);
    ck_assert(checks());
    job->state = JOB_PAUSED;
    for (uint32_t i = 0; checks() && i < 1000; i++)
        send_sums(conn, base + PASSES, i, square, 0);
}

static const struct {
    double v;
    size_t cut;
} unsound[] = { { NAN, 0 }, { INFINITY, 0 }, { -INFINITY, 0 },
                { 1, 1 },   { 1, 8 },        { 1, SUMS_BYTES } };

LOOP_TEST(sums_that_are_no_numbers_end_the_connection, N_ELEM(unsound))
{
    submit_goal(50000, 0);
    ready(WORKER, job_a);
    for (uint32_t pass = 0; pass < PASSES; pass++)
        make_pass(WORKER, pass);
    ck_assert(checks() && !f.closed[WORKER]);
    send_sums(WORKER, PASSES, 0, unsound[_i].v, unsound[_i].cut);
    ck_assert(f.closed[WORKER]);
}

TEST(what_is_far_off_has_another_stage)
{
    const struct msg_stage *st = &f.last[WORKER].stage;
    struct job *job;

    submit_goal(50000, 0);
    ready(WORKER, job_a);
    make_stage(WORKER, 0, 1);
    job = desk_find_job(f.c, job_a);
    ck_assert_int_eq(f.last[WORKER].type, MSG_STAGE);
    ck_assert_uint_eq(st->pass, PASSES + 1);
    ck_assert_str_eq(st->params, goal_options(job));
    ck_assert_str_ne(st->params, job->spec.params);
    ck_assert_uint_eq(state().open, 0);
    ck_assert_uint_eq(f.units[WORKER], 0);
    ck_assert(job->goal.error > .9 && job->goal.state == GOAL_AHEAD);
    /* one that is late gets this stage alone */
    made(WORKER, PASSES + 1, 0, 1);
    for (uint32_t i = 1; i < tiles_of(0); i++)
        made(WORKER, PASSES + 1, i, 1);
    job->state = JOB_RUNNING;
    join(SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    job->state = JOB_PAUSED;
    ready(SECOND, job_a);
    ck_assert_int_eq(f.last[SECOND].type, MSG_FROZEN);
    ck_assert_uint_eq(f.last[SECOND].frozen.pass, PASSES + 1);
    /* tiles of the old one are of no use */
    made(SECOND, 3, 0, 1);
    ck_assert(!f.closed[SECOND]);
}

TEST(what_is_good_enough_has_no_other_stage)
{
    const struct msg_stage *show = &f.last[WORKER].show;
    struct rad_params own;
    char text[RAD_PARAMS_TEXT];
    struct job *job;

    submit_goal(50000, 0);
    ready(WORKER, job_a);
    make_stage(WORKER, 0, 1e-6);
    job = desk_find_job(f.c, job_a);
    ck_assert(job->goal.state == GOAL_REACHED && job->goal.number == 0);
    ck_assert(job->goal.error > 0 && job->goal.error <= .05);
    ck_assert_int_eq(jobtext_params(job->spec.params, &own, NULL), 0);
    rad_params_format(&own, text, sizeof text);
    ck_assert_str_eq(goal_options(job), text);
    ck_assert_int_eq(f.last[WORKER].type, MSG_SHOW);
    ck_assert_uint_eq(show->pass, PASSES);
    ck_assert_str_eq(show->params, text);
    ck_assert(!passes_open(job));
    job->state = JOB_RUNNING;
    wait_s(1);
    ck_assert_uint_gt(f.units[WORKER], 0);
}

/* However much that would bring. */
TEST(without_time_there_is_no_other_stage)
{
    struct job *job;

    submit_goal(0, 1000);
    ready(WORKER, job_a);
    f.now_ms += 5000;
    make_stage(WORKER, 0, 1);
    job = desk_find_job(f.c, job_a);
    ck_assert(job->goal.state == GOAL_SHORT);
}

static double
left_s(void)
{
    struct job *job = desk_find_job(f.c, job_a);
    struct msg_progress p;

    job->state = JOB_RUNNING;
    wait_s(1);
    progress_tell(job, f.now_ms, &p);
    return p.left_s;
}

static const struct {
    uint32_t error_ppm, time_ms;
    double left_s;
} goals[] = { { 50000, 0, 0 }, { 0, 60000, 60 }, { 50000, 60000, 0 } };

/* The share that is done tells nothing of stages to come. */
LOOP_TEST(time_left_before_the_picture_is_that_of_the_option, N_ELEM(goals))
{
    submit_goal(goals[_i].error_ppm, goals[_i].time_ms);
    ready(WORKER, job_a);
    wait_s(10);
    for (uint32_t pass = 0; pass < PASSES; pass++) {
        double left = fmax(goals[_i].left_s - 11 - 3 * pass, 0);

        ck_assert_double_eq_tol(left_s(), left, 1);
        wait_s(2);
        make_pass(WORKER, pass);
    }
    wait_s(100); /* the first stage takes its time */
    ck_assert_double_eq(left_s(), 0);
}

/* That the stages are over is no work that was done. */
TEST(time_left_of_the_picture_begins_with_the_picture)
{
    struct job *job;

    submit_goal(50000, 0);
    ready(WORKER, job_a);
    wait_s(10);
    make_stage(WORKER, 0, 1e-6);
    for (int i = 0; i < 10; i++)
        ck_assert_double_eq(left_s(), 0);
    job = desk_find_job(f.c, job_a);
    ck_assert_int_ne(job->goal.state, GOAL_AHEAD);
    ck_assert_uint_eq(job->pace.nlooks, 2);
}

/* Passes that were kept have taken more than a new life's clock has seen. */
TEST(what_passes_took_before_a_restart_counts)
{
    struct job *job;

    submit_goal(0, 30000);
    ready(WORKER, job_a);
    f.now_ms += 100;
    tile_rays = 1000;
    tile_cpu_s = 30;
    make_stage(WORKER, 0, 1);
    job = desk_find_job(f.c, job_a);
    ck_assert(job->goal.state == GOAL_SHORT);
    tile_rays = 0;
    tile_cpu_s = 0;
}

/* Let a later life take up the job, whose first stage has these bytes as its
 * decision; returns how many of the passes it takes over. */
static uint32_t
take_up(struct job *job, const uint8_t bytes[STAGES_BYTES])
{
    struct saved_pass pass[PASSES + 1] = { 0 };
    struct kept_passes were = job->kept;
    uint32_t n;

    pass[PASSES].len = STAGES_BYTES;
    pass[PASSES].bytes = memcpy(malloc(STAGES_BYTES), bytes, STAGES_BYTES);
    job->goal = (struct job_goal){ 0 };
    job->kept = (struct kept_passes){ .pass = pass, .n = PASSES + 1 };
    ck_assert_int_eq(stages_take_up(f.c, job, NULL), 0);
    n = job->kept.n;
    job->kept = were;
    return n;
}

/* Rungs that the clock chose are quarters, and they are kept.  A decision that
 * another version of the program wrote, or that is spoilt, is made again. */
TEST(a_later_life_takes_up_what_the_clock_chose)
{
    static const struct {
        int at, n, to;
    } spoil[] = {
        { 0, 1, 5 },                    /* a former layout */
        { STAGES_BYTES - 16, 8, 0xff }, /* no number of places */
        { STAGES_BYTES - 40, 1, 0xbf }, /* a negative square */
    };
    uint8_t bytes[STAGES_BYTES], spoilt[STAGES_BYTES];
    struct job_goal goal;
    struct job *job;

    submit_goal(0, 30000);
    ready(WORKER, job_a);
    f.now_ms += 8000; /* the rest is near: no stage comes before it */
    tile_rays = 1000;
    tile_cpu_s = .01;
    make_stage(WORKER, 0, 1);
    job = desk_find_job(f.c, job_a);
    goal = job->goal;
    ck_assert(goal.state == GOAL_AHEAD && goal.number == 1 && goal.by_clock);
    ck_assert_uint_ne((goal.rungs[0] | goal.rungs[1]) >> 6, 0);
    stages_pack(f.c, job, bytes);
    ck_assert_uint_eq(take_up(job, bytes), PASSES + 1);
    ck_assert_uint_eq(job->goal.number, 1);
    ck_assert(job->goal.by_clock);
    ck_assert_mem_eq(job->goal.rungs, goal.rungs, 2);
    ck_assert_mem_eq(&job->goal.past.rungs, &goal.past.rungs, 2);
    ck_assert(job->goal.past.ambient == goal.past.ambient);
    ck_assert(job->goal.past.pixel == goal.past.pixel);
    ck_assert(job->goal.past.noise == goal.past.noise);
    ck_assert(job->goal.past.places == goal.past.places);
    ck_assert_double_gt(goal.past.places, 0);
    ck_assert_str_eq(job->goal.options, goal.options);
    for (int i = 0; i < N_ELEM(spoil); i++) {
        memcpy(spoilt, bytes, sizeof spoilt);
        memset(spoilt + spoil[i].at, spoil[i].to, spoil[i].n);
        ck_assert_uint_eq(take_up(job, spoilt), PASSES);
        ck_assert(job->goal.state == GOAL_AHEAD && job->goal.unread);
        ck_assert_uint_eq(job->goal.number, 0);
        ck_assert(job->goal.past.places == 0 && !job->goal.by_clock);
    }
    tile_rays = 0;
    tile_cpu_s = 0;
}

/* A child from an earlier life may be at a stage with other options, if the
 * clock chose them. */
LOOP_TEST(by_the_clock_a_child_of_an_earlier_life_begins_anew, 2)
{
    struct msg m = { .type = MSG_READY, .ready = { job_a, .1, 7, 2, 1 } };

    submit_goal(50000, _i ? 60000 : 0);
    ready(WORKER, job_a);
    make_pass(WORKER, 0);
    make_pass(WORKER, 1);
    join(SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    desk_find_job(f.c, job_a)->state = JOB_PAUSED;
    say(SECOND, &m);
    ck_assert_int_eq(f.last[SECOND].type, _i ? MSG_JOB_END : MSG_FROZEN);
}
