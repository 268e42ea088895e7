/* check_coord_passes.c - the coordinator gives out tiles and closes passes */
#include "config.h"

#include "coord_passes_fixture.h"

#include "tests/scarce.h"

#include "filling/tiles.h"
#include "jobs/progress.h"
#include "registry/recover.h"

FIXTURE(set_up, tear_down)

TEST(units_come_when_all_passes_are_closed)
{
    start_passes(&wide);
    ck_assert(has_tile(WORKER));
    for (uint32_t pass = 0; pass < PASSES; pass++) {
        ck_assert_uint_eq(f.units[WORKER], 0);
        make_pass(WORKER, pass);
    }
    ck_assert_uint_gt(f.units[WORKER], 0);
    ck_assert_uint_eq(state().open, PASSES);
}

/* The records of all tiles in their order, whatever the order in which they
 * came; to workers that come later, too. */
TEST(a_pass_that_is_closed_goes_to_all)
{
    struct msg_frozen *z = &f.last[SECOND].frozen;

    start_passes(&wide);
    ck_assert_uint_eq(tiles_of(0), 2);
    records[0] = 2;
    made(WORKER, 0, 1, 3);
    records[0] = 1;
    made(WORKER, 0, 0, 1);
    ck_assert_uint_eq(state().open, 1);
    ck_assert(has_tile(WORKER)); /* of the next */
    join(SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    desk_find_job(f.c, job_a)->state = JOB_PAUSED; /* no tile hides it */
    ready(SECOND, job_a);
    ck_assert_int_eq(f.last[SECOND].type, MSG_FROZEN);
    ck_assert(z->pass == 0 && z->first == 0 && z->last && z->count == 4);
    ck_assert_uint_eq(z->data[0], 1);
    ck_assert_uint_eq(z->data[AMBSHARE_BYTES], 2);
}

static const struct {
    uint32_t pass, tile;
    size_t len;
} wrong[] = { { 1, 0, AMBSHARE_BYTES },
              { 0, 2, AMBSHARE_BYTES },
              { 0, 0, AMBSHARE_BYTES - 1 } };

LOOP_TEST(what_fits_no_tile_ends_the_connection, N_ELEM(wrong))
{
    struct msg m = { .type = MSG_TILE_MADE,
                     .tile_made = { .job = job_a,
                                    .pass = wrong[_i].pass,
                                    .tile = wrong[_i].tile,
                                    .count = 1,
                                    .data = records,
                                    .len = wrong[_i].len } };

    start_passes(&wide);
    say(WORKER, &m);
    ck_assert(f.closed[WORKER]);
}

TEST(tiles_of_a_lost_worker_go_to_another)
{
    start_passes(&wide);
    second_ready(job_a);
    ck_assert(has_tile(WORKER) && !has_tile(SECOND)); /* it has both */
    f.now_ms++;
    cut(WORKER);
    ck_assert(has_tile(SECOND));
    make_pass(SECOND, 0);
    ck_assert_uint_eq(state().open, 1);
}

/* Before any worker is there, and as after. */
TEST(a_job_of_an_earlier_life_tells_how_far_its_passes_are)
{
    struct msg m = passes_submit(&wide, 1);
    struct saved_pass passes[3];
    struct saved_frame none = { 0 };
    struct saved_job s = { .spec = m.submit,
                           .owner = "ana",
                           .text = "",
                           .submit_ms = 1000,
                           .frames = &none,
                           .npasses = N_ELEM(passes),
                           .passes = passes };
    struct msg_progress p[2];
    const struct job *job;

    for (int i = 0; i < N_ELEM(passes); i++)
        passes[i] = (struct saved_pass){ .bytes = records,
                                         .len = AMBSHARE_BYTES,
                                         .counts = { .rays = 100 } };
    wait_s(8);
    ck_assert_int_eq(recover_job(f.c, f.now_ms, &s, NULL, NULL, NULL), 0);
    job = desk_find_job(f.c, job_a);
    progress_tell(job, f.now_ms, &p[0]);
    ck_assert_double_eq_tol(p[0].elapsed_s, 7, .5);
    wait_s(1);
    ready(WORKER, job_a);
    ck_assert_uint_eq(state().open, N_ELEM(passes));
    progress_tell(job, f.now_ms, &p[1]);
    for (int i = 0; i < 2; i++) {
        ck_assert_uint_eq(p[i].rays, 300);
        ck_assert_double_gt(p[i].cost_done, 0);
        ck_assert_double_eq_tol(p[i].cost_done / p[i].cost_total,
                                p[0].cost_done / p[0].cost_total, 1e-9);
    }
}

/* A tile that is late is made by two; what comes second is dropped. */
TEST(a_late_tile_goes_to_a_second_worker)
{
    struct job *job;

    tile_rays = 10;
    start_passes(&wide);
    second_ready(job_a);
    ck_assert(!has_tile(SECOND));
    wait_s(1);
    ck_assert(has_tile(SECOND));
    make_pass(SECOND, 0);
    made(WORKER, 0, 0, 1);
    ck_assert(!f.closed[WORKER]);
    job = desk_find_job(f.c, job_a);
    ck_assert_uint_eq(job->tiled.rays, 20);
    ck_assert_uint_eq(job->parts[0].past.dropped.rays, 10);
    tile_rays = 0;
}

/* A tick that comes a little early, behind one that came late, counts. */
TEST(a_late_tile_is_seen_at_the_next_tick)
{
    wait_s(1);
    f.now_ms += 60;
    start_passes(&wide);
    second_ready(job_a);
    for (uint64_t ms = 50; ms < 100; ms += 49) {
        ck_assert(!has_tile(SECOND));
        f.now_ms += ms;
        coord_tick(f.c, f.now_ms);
        carry_out();
    }
    ck_assert(has_tile(SECOND));
}

/* A worker of two threads has a third tile while many wait, and two more while
 * twice as many do; none when few do: it may stand behind a dear one. */
TEST(near_the_end_of_a_pass_no_tile_stands_ahead)
{
    uint32_t tiles = tiles_of(LAST), out;

    start_passes(&wide);
    for (uint32_t pass = 0; pass < LAST; pass++)
        make_pass(WORKER, pass);
    ck_assert_uint_gt(tiles, 24);
    for (uint32_t i = 0; i < tiles; i++) {
        out = tiles_out(&desk_find_job(f.c, job_a)->parts[0]);
        if (tiles - i >= 22)
            ck_assert_uint_ge(out, 5);
        if (tiles - i >= 12 && tiles - i <= 18)
            ck_assert_uint_eq(out, 3);
        if (tiles - i >= 2 && tiles - i <= 10)
            ck_assert_uint_eq(out, 2);
        made(WORKER, LAST, i, 0);
    }
}

/* Of many tiles that are out the one that is out for longest is late first, and
 * a worker that is lost has none, not even of those that another made. */
TEST(the_oldest_tile_is_late_first)
{
    struct job *job;

    start_passes(&wide);
    for (uint32_t pass = 0; pass < LAST; pass++)
        make_pass(WORKER, pass);
    ck_assert_uint_gt(tiles_of(LAST), 6);
    second_ready(job_a);
    for (uint32_t i = 3; i < tiles_of(LAST);
         i++) /* WORKER has the first three */
        made(SECOND, LAST, i, 0);
    wait_s(1);
    ck_assert_uint_eq(f.last[SECOND].tile.tile, 1); /* it has 0 and 1 */
    job = desk_find_job(f.c, job_a);
    made(SECOND, LAST, 0, 0);
    ck_assert_uint_gt(tiles_out(&job->parts[0]), 0);
    f.now_ms++;
    cut(WORKER);
    ck_assert_uint_eq(tiles_out(&job->parts[0]), 0);
    join(WORKER, MSG_ROLE_WORKER, "ws1", "daemon");
    ready(WORKER, job_a);
    made(WORKER, LAST, 0, 0);
    ck_assert_uint_le(tiles_out(&job->parts[0]), 3);
}

/* A tile with n colours. */
static void
made_shown(uint64_t conn, uint32_t pass, uint32_t tile, uint32_t n)
{
    static const uint8_t rgbe[MSG_MAX_COLOURS];
    struct msg m = { .type = MSG_TILE_MADE,
                     .tile_made = { .job = job_a,
                                    .pass = pass,
                                    .tile = tile,
                                    .colours = rgbe,
                                    .colours_len = 4 * (size_t)n } };

    say(conn, &m);
    hold(true);
}

static void
fetch_preview(uint64_t conn)
{
    struct msg m = { .type = MSG_FETCH,
                     .request = 6,
                     .fetch = { job_a, 0, MSG_WHAT_PREVIEW } };

    f.last[conn].type = MSG_DONE;
    say(conn, &m);
}

/* From the first look on tiles tell their colours, and there is a preview as
 * soon as those of a pass are there; nobody else pays for that. */
TEST(tiles_tell_their_colours_to_who_watches)
{
    start_passes(&wide);
    ck_assert(has_tile(WORKER) && !f.last[WORKER].tile.colours);
    made_shown(WORKER, 0, 0, 0);
    fetch_preview(ANA);
    ck_assert_int_eq(f.last[ANA].type, MSG_FAILED);
    ck_assert_str_eq(f.last[ANA].failed.text, "nothing is rendered yet");
    made_shown(WORKER, 0, 1, 3 * 4);
    ck_assert_uint_eq(f.ncolours, 1);
    ck_assert(f.colours.x == 128 && f.colours.y == 0 && f.colours.step == 32 &&
              f.colours.columns == 3 && f.colours.rows == 4);
    ck_assert_uint_eq(state().open, 1);
    ck_assert(has_tile(WORKER) && f.last[WORKER].tile.colours);
    fetch_preview(ANA);
    ck_assert_int_eq(f.last[ANA].type, MSG_DONE);
    made_shown(WORKER, 1, 0, 16);
    made_shown(WORKER, 1, 0, 16); /* by another worker, perhaps */
    ck_assert_uint_eq(f.ncolours, 2);
    for (uint32_t pass = 1; pass < 5; pass++)
        make_pass(WORKER, pass);
    ck_assert(has_tile(WORKER) && !f.last[WORKER].tile.colours); /* too fine */
}

static double
share_done(void)
{
    struct msg_progress p;

    progress_tell(desk_find_job(f.c, job_a), f.now_ms, &p);
    ck_assert_uint_eq(p.pixels_done, 0);
    return p.cost_done / p.cost_total;
}

/* Tiles are most of the work: each brings the job on, whichever pass it is of;
 * one that comes again does not. */
TEST(tiles_count_as_progress)
{
    double done = 0, middle = 0;

    submit_passes(ANA, &wide, 1);
    ck_assert_double_eq(share_done(), 0);
    ready(WORKER, job_a);
    for (uint32_t pass = 0; pass < PASSES; pass++)
        for (uint32_t i = 0; i < tiles_of(pass); i++) {
            made(WORKER, pass, i, 1);
            ck_assert_double_gt(share_done(), done);
            done = share_done();
            made(WORKER, pass, i, 1);
            ck_assert_double_eq(share_done(), done);
            if (pass < PASSES - 7) /* before the last ones */
                middle = done;
        }
    ck_assert_double_gt(middle, .1);
    ck_assert_double_gt(done, 1.5 * middle);
    ck_assert_double_lt(done, .95);
}

/* What passes took tells what the others will take, but what was told stays. */
TEST(dear_passes_do_not_take_progress_back)
{
    double done = 0, foreseen;

    start_passes(&wide);
    foreseen = desk_find_job(f.c, job_a)->filled.share;
    for (uint32_t pass = 0; pass < PASSES; pass++) {
        tile_rays = pass < PASSES / 2 ? 1000 : 50000;
        for (uint32_t i = 0; i < tiles_of(pass); i++) {
            made(WORKER, pass, i, 1);
            ck_assert_double_ge(share_done(), done);
            done = share_done();
        }
        if (pass < PASSES - 1)
            ck_assert_double_lt(done, foreseen);
    }
    ck_assert_double_eq_tol(done, foreseen, 1e-9);
    tile_rays = 0;
}

TEST(colours_that_nobody_wants_are_dropped)
{
    start_passes(&wide);
    made_shown(WORKER, 0, 1, 3 * 4);
    ck_assert_uint_eq(f.ncolours, 0);
    ck_assert(!f.closed[WORKER]);
}

static const struct {
    uint32_t pass, n;
} unfit[] = { { 0, 1 }, { 0, 11 }, { 0, 13 }, { 0, 64 }, { 5, 64 } };

LOOP_TEST(colours_that_fit_no_tile_end_the_connection, N_ELEM(unfit))
{
    submit_passes(ANA, &wide, 1);
    fetch_preview(ANA);
    ready(WORKER, job_a);
    for (uint32_t pass = 0; pass < unfit[_i].pass; pass++)
        make_pass(WORKER, pass);
    made_shown(WORKER, unfit[_i].pass, 1, unfit[_i].n);
    ck_assert(f.closed[WORKER]);
    ck_assert_uint_eq(f.ncolours, 0);
}

/* By two workers' children, or three of one worker's. */
TEST(a_tile_that_brings_children_down_fails_the_job)
{
    struct msg lost = { .type = MSG_LOST,
                        .lost = { job_a, EX_SOFTWARE, "signal 11", 0, NULL } };
    int times = 0;

    submit_passes(ANA, &wide, 1);
    for (; times < 10 && f.last[ANA].type != MSG_FAILED; times++) {
        ready(WORKER, job_a);
        say(WORKER, &lost);
    }
    ck_assert_int_eq(times, JOB_MAX_CRASHES);
    ck_assert_ptr_nonnull(strstr(f.last[ANA].failed.text,
                                 "of the ambient cache, brought the renderer "
                                 "down"));
}

/* Nobody knows what else was on the machine that killed it. */
TEST(a_tile_is_not_blamed_for_a_child_that_was_killed)
{
    struct msg lost = { .type = MSG_LOST,
                        .lost = { job_a, EX_OSERR, "signal 9", 0, NULL } };
    int times = 0;

    start_passes(&wide);
    for (; times < 3 * JOB_MAX_CRASHES; times++) {
        ck_assert(has_tile(WORKER));
        if (times % JOB_MAX_CRASHES == 0) /* which is no setback */
            make(WORKER, f.last[WORKER].tile.pass, f.last[WORKER].tile.tile, 0);
        say(WORKER, &lost);
        ready(WORKER, job_a);
    }
    for (times = 1; times < 10 && f.last[ANA].type != MSG_FAILED; times++) {
        say(WORKER, &lost);
        ready(WORKER, job_a);
    }
    ck_assert_int_eq(f.last[ANA].failed.status, EX_UNAVAILABLE);
    ck_assert_ptr_nonnull(strstr(f.last[ANA].failed.text, "signal 9"));
}

/* Whichever allocation fails when the passes begin. */
TEST(what_lacks_memory_is_freed)
{
    struct msg m = { .type = MSG_READY, .ready = { job_a, .1, 7, 0, 0 } };
    long n = 0;

    do {
        tear_down();
        set_up();
        submit_passes(ANA, &wide, 1);
        scarce_at = ++n;
        coord_message(f.c, ++f.now_ms, WORKER, &m);
    } while (scarce_at == 0);
    scarce_at = 0;
    ck_assert(RAD_SANITIZED || n > 15);
}

/* A child that knows passes of an earlier life begins anew. */
TEST(a_worker_that_is_ahead_begins_anew)
{
    struct msg m = { .type = MSG_READY, .ready = { job_a, .1, 7, 2, 3 } };

    submit_passes(ANA, &wide, 1);
    say(WORKER, &m);
    ck_assert_int_eq(f.last[WORKER].type, MSG_JOB_START);
    ready(WORKER, job_a);
    ck_assert(has_tile(WORKER));
}

/* What no coordinator has memory for, and no message a number. */
TEST(more_tiles_than_there_may_be_are_refused)
{
    enum { FRAMES = 3000 }; /* 94 in a batch */
    static struct msg_frame huge[FRAMES];

    for (uint32_t i = 0; i < FRAMES; i++)
        huge[i] = (struct msg_frame){ i, 65520, 1000, "" };
    submit_passes(ANA, huge, FRAMES);
    ready(WORKER, job_a);
    ck_assert_int_eq(f.last[ANA].type, MSG_FAILED);
    ck_assert_msg(f.last[ANA].failed.status == EX_DATAERR, "%s",
                  f.last[ANA].failed.text);
    ck_assert_ptr_nonnull(
        strstr(f.last[ANA].failed.text, "too much for --ambient=passes"));
}

/* Do the first unit that ws1 was given, else the first tile of a worker; false:
 * there is none. */
static bool
work(void)
{
    size_t at = f.ntodo;
    struct to_do k;

    for (size_t i = f.ntodo; i-- > 0;)
        if (f.todo[i].m.type == MSG_TILE
                ? at == f.ntodo || f.todo[at].m.type == MSG_TILE
                : f.todo[i].conn == WORKER)
            at = i;
    if (at == f.ntodo)
        return false;
    k = f.todo[at];
    memmove(f.todo + at, f.todo + at + 1, (--f.ntodo - at) * sizeof *f.todo);
    if (k.m.type == MSG_TILE)
        made(k.conn, k.m.tile.pass, k.m.tile.tile, 1);
    else
        result(k.conn, job_a, k.m.unit.unit, k.m.unit.attempt);
    return true;
}

/* Of an animation the next batch's first pass is closed when all pictures of
 * this batch are done.  A worker that waits for that is free for other jobs. */
TEST(a_worker_leaves_passes_that_wait_for_pictures)
{
    enum { FRAMES = RAD_PASS_BATCH + 1 };
    struct msg_frame walk[FRAMES];
    const struct coord_worker *w;

    for (uint32_t i = 0; i < FRAMES; i++)
        walk[i] = (struct msg_frame){ i, 8, 8, "" };
    join(SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    submit_passes(ANA, walk, FRAMES);
    ready(WORKER, job_a);
    ready(SECOND, job_a);
    w = desk_find_worker(f.c, "ws1");
    ck_assert_ptr_nonnull(w->fills);
    while (work())
        ;
    ck_assert_uint_gt(f.units[SECOND], 0);
    ck_assert(desk_find_job(f.c, job_a)->filling && w->in_flight == 0);
    ck_assert_ptr_null(w->fills);
}
