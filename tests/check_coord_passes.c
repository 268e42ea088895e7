/* check_coord_passes.c - the coordinator gives out tiles and closes passes */
#include "config.h"

#include "coord_fixture.h"

#include "jobs/progress.h"
#include "machine/sums.h"
#include "passes/passplan.h"
#include "proto/ambshare.h"
#include "refine/refine.h"
#include "filling/dearest.h"
#include "filling/passes.h"
#include "filling/stages.h"
#include "filling/tiles.h"
#include "links/feeding.h"

#include <math.h>

static const struct msg_frame wide = { 0, 200, 100, "" };

/* Lattices of 32, and of 16, 8 and 4 pixels in two fields each. */
enum { PASSES = 8, LAST = PASSES - 1 };
static uint8_t records[4 * AMBSHARE_BYTES];

static void
submit_passes(uint64_t conn, const struct msg_frame *frames, uint32_t n)
{
    struct msg m = usual_submit(job_a);

    m.request = 5;
    m.submit.params = "-ab 1 -ps 4";
    m.submit.flags = MSG_JOB_PASSES;
    m.submit.partition = MSG_PART_WINDOW;
    m.submit.windows = 4;
    m.submit.frames = frames;
    m.submit.nframes = n;
    say(&f, conn, &m);
}

/* The last thing that was said to a worker is a tile. */
static bool
has_tile(uint64_t conn)
{
    return f.last[conn].type == MSG_TILE;
}

/* The workers say that they have what they are asked for. */
static void
hold(bool whole)
{
    for (uint64_t conn = WORKER; conn <= SECOND; conn++)
        while (f.last[conn].type == MSG_CLOSED) {
            struct msg m = { .type = MSG_HOLDS,
                             .holds = { job_a, f.last[conn].closed.pass,
                                        whole } };

            f.last[conn].type = 0;
            say(&f, conn, &m);
        }
}

static uint64_t tile_rays; /* that each tile takes, */
static double tile_cpu_s;  /* and seconds */

static void
make(uint64_t conn, uint32_t pass, uint32_t tile, uint32_t n)
{
    struct msg m = { .type = MSG_TILE_MADE,
                     .tile_made = {
                         .job = job_a,
                         .pass = pass,
                         .tile = tile,
                         .counts = { .rays = tile_rays, .cpu_s = tile_cpu_s },
                         .count = n,
                         .data = records,
                         .len = n * AMBSHARE_BYTES } };

    say(&f, conn, &m);
}

static void
made(uint64_t conn, uint32_t pass, uint32_t tile, uint32_t n)
{
    make(conn, pass, tile, n);
    hold(true);
}

static struct passes_state
state(void)
{
    return passes_state(desk_find_job(f.c, job_a));
}

static uint32_t
tiles_of(uint32_t pass)
{
    struct rad_pass_size size = { 200, 100 };
    struct rad_pass plan[RAD_MOST_PASSES];
    struct rad_params params;

    rad_params_init(&params);
    params.ambounce = 1;
    ck_assert_uint_eq(rad_passes_plan(&params, &size, 1, plan), PASSES);
    return plan[pass].tiles;
}

/* One worker makes all tiles of a pass. */
static void
make_pass(uint64_t conn, uint32_t pass)
{
    for (uint32_t i = 0; i < tiles_of(pass); i++) {
        ck_assert_uint_eq(state().open, pass);
        made(conn, pass, i, 1);
    }
}

START_TEST(units_come_when_all_passes_are_closed)
{
    submit_passes(ANA, &wide, 1);
    ready(&f, WORKER, job_a);
    ck_assert(has_tile(WORKER));
    for (uint32_t pass = 0; pass < PASSES; pass++) {
        ck_assert_uint_eq(f.units[WORKER], 0);
        make_pass(WORKER, pass);
    }
    ck_assert_uint_gt(f.units[WORKER], 0);
    ck_assert_uint_eq(state().open, PASSES);
}
END_TEST

/* The records of all tiles in their order, whatever the order in which they
 * came; to workers that come later, too. */
START_TEST(a_pass_that_is_closed_goes_to_all)
{
    struct msg_frozen *z = &f.last[SECOND].frozen;

    submit_passes(ANA, &wide, 1);
    ready(&f, WORKER, job_a);
    ck_assert_uint_eq(tiles_of(0), 2);
    records[0] = 2;
    made(WORKER, 0, 1, 3);
    records[0] = 1;
    made(WORKER, 0, 0, 1);
    ck_assert_uint_eq(state().open, 1);
    ck_assert(has_tile(WORKER)); /* of the next */
    join(&f, SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    desk_find_job(f.c, job_a)->state = JOB_PAUSED; /* no tile hides it */
    ready(&f, SECOND, job_a);
    ck_assert_int_eq(f.last[SECOND].type, MSG_FROZEN);
    ck_assert(z->pass == 0 && z->first == 0 && z->last && z->count == 4);
    ck_assert_uint_eq(z->data[0], 1);
    ck_assert_uint_eq(z->data[AMBSHARE_BYTES], 2);
}
END_TEST

/* A first worker, and a second that it may dial. */
static void
two_are_ready(void)
{
    struct job *job;

    submit_passes(ANA, &wide, 1);
    ready(&f, WORKER, job_a);
    join(&f, SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    job = desk_find_job(f.c, job_a);
    strcpy(job->workers[0].worker->address, "tcp 127.0.0.1:1");
    ready(&f, SECOND, job_a);
}

/* What is made goes to a worker at once, and to others by way of that one; when
 * the pass is closed those that lack it get it. */
START_TEST(records_travel_while_tiles_are_made)
{
    const struct msg_frozen *z = &f.last[SECOND].frozen;
    const struct job_worker *jw;

    two_are_ready();
    jw = desk_find_job(f.c, job_a)->workers;
    ck_assert_uint_eq(jw[0].feeder, 0);
    ck_assert_uint_eq(jw[1].feeder, 1);
    ck_assert_int_eq(f.last[WORKER].type, MSG_FEED);
    ck_assert(f.last[WORKER].feed.n == 1 &&
              strcmp(f.last[WORKER].feed.name[0], "ws2") == 0);
    f.last[SECOND].type = 0;
    make(WORKER, 0, 1, 2);
    ck_assert_int_eq(f.last[WORKER].type, MSG_TILE_RECORDS);
    ck_assert(f.last[WORKER].tile_records.tile == 1 &&
              f.last[WORKER].tile_records.count == 2);
    ck_assert_int_eq(f.last[SECOND].type, 0);
    make(WORKER, 0, 0, 0);
    ck_assert(jw[0].passes == 1 && jw[1].passes == 1);
    ck_assert(has_tile(WORKER)); /* without a word */
    say(&f, SECOND,
        &(struct msg){ .type = MSG_HOLDS, .holds = { job_a, 0, 0 } });
    ck_assert(f.last[SECOND].type == MSG_FROZEN && z->count == 2);
    f.last[SECOND].type = 0;
    for (uint32_t pass = 0; pass < 2; pass++)
        say(&f, SECOND,
            &(struct msg){ .type = MSG_HOLDS, .holds = { job_a, pass, 0 } });
    ck_assert_int_eq(f.last[SECOND].type, 0); /* sent, and not closed */
}
END_TEST

/* Of five the coordinator feeds the first, that one two, and so on.  When the
 * first hangs the coordinator feeds the second, and a worker below the second
 * feeds the third and, in case it does not hang, the first. */
START_TEST(workers_below_one_that_hangs_are_fed_by_others)
{
    static const uint32_t before[] = { 0, 1, 1, 2, 2 },
                          after[] = { 4, 0, 4, 2, 2 };
    static const char *const name[] = { "ws2", "ws3", "ws4", "ws5" };
    struct job_worker *jw;

    submit_passes(ANA, &wide, 1);
    for (uint64_t i = 0; i < N_ELEM(name); i++)
        join(&f, SECOND + i, MSG_ROLE_WORKER, name[i], "daemon");
    for (struct coord_worker *w = f.c->workers; w; w = w->next)
        strcpy(w->address, "tcp 127.0.0.1:1");
    for (uint64_t i = 0; i < N_ELEM(before); i++)
        ready(&f, i > 0 ? SECOND + i - 1 : WORKER, job_a);
    jw = desk_find_job(f.c, job_a)->workers;
    for (uint32_t i = 0; i < N_ELEM(before); i++)
        ck_assert_uint_eq(jw[i].feeder, before[i]);
    make(SECOND, 0, 0, 2);
    make(SECOND, 0, 1, 2);
    for (uint64_t i = 0; i < N_ELEM(name); i++)
        say(&f, SECOND + i,
            &(struct msg){ .type = MSG_HOLDS, .holds = { job_a, 0, 0 } });
    for (uint32_t i = 0; i < N_ELEM(before); i++)
        ck_assert_uint_eq(jw[i].feeder, before[i]);
    make_pass(SECOND, 1);
    for (uint32_t i = 0; i < N_ELEM(after); i++)
        ck_assert_uint_eq(jw[i].feeder, after[i]);
}
END_TEST

/* Workers that can all be dialled, one and n more, become ready one after the
 * other. */
static struct job *
begin_with(uint64_t n)
{
    submit_passes(ANA, &wide, 1);
    ready(&f, WORKER, job_a);
    for (uint64_t i = 0; i < n; i++) {
        char name[] = { 'x', (char)('0' + i), '\0' };

        join(&f, SECOND + i, MSG_ROLE_WORKER, name, "daemon");
        for (struct coord_worker *w = f.c->workers; w; w = w->next)
            strcpy(w->address, "tcp 127.0.0.1:1");
        ready(&f, SECOND + i, job_a);
    }
    return desk_find_job(f.c, job_a);
}

/* A worker that got another feeder lacks what passed its former one, in all
 * passes that were open then: its new one did not fail. */
START_TEST(a_new_feeder_does_not_fail_at_once)
{
    struct job_worker *jw;
    struct job *job;

    job = begin_with(3);
    jw = job->workers;
    ck_assert(jw[3].feeder == 2 && jw[1].feeder == 1);
    feeding_lacked(job, 3);
    feeding_mend(f.c, job);
    ck_assert(jw[3].feeder == 3 && jw[1].failures == 1);
    for (int pass = 0; pass < MSG_OPEN_PASSES; pass++) {
        feeding_lacked(job, 3);
        feeding_mend(f.c, job);
        ck_assert(jw[3].feeder == 3 && jw[2].failures == 0);
    }
    feeding_lacked(job, 3);
    feeding_mend(f.c, job);
    ck_assert_uint_eq(jw[2].failures, 1);
    carry_out(&f);
}
END_TEST

/* Records come late now and then, by any of them. */
START_TEST(the_coordinator_does_not_come_to_feed_all)
{
    struct job *job;
    uint64_t random = 1;

    job = begin_with(9);
    for (int k = 0; k < 1000; k++) {
        uint32_t direct = 0;

        random = random * 6364136223846793005u + 1442695040888963407u;
        feeding_lacked(job, (uint32_t)(random >> 33) % job->nworkers);
        feeding_mend(f.c, job);
        for (uint32_t i = 0; i < job->nworkers; i++)
            direct += feeding_is_direct(job, i);
        ck_assert_msg(direct <= 1, "%u after %d", direct, k);
    }
    carry_out(&f);
}
END_TEST

/* A link that neither end can dial never comes about. */
START_TEST(workers_without_an_address_are_not_fed_by_each_other)
{
    const struct job_worker *jw;

    submit_passes(ANA, &wide, 1);
    ready(&f, WORKER, job_a);
    for (uint64_t i = 0; i < 2; i++) {
        join(&f, SECOND + i, MSG_ROLE_WORKER, i > 0 ? "ws3" : "ws2", "daemon");
        ready(&f, SECOND + i, job_a);
    }
    jw = desk_find_job(f.c, job_a)->workers;
    for (uint32_t i = 0; i < 3; i++)
        ck_assert_uint_eq(jw[i].feeder, 0);
}
END_TEST

/* Whoever a worker fed gets another place when that one is gone. */
START_TEST(workers_that_were_fed_are_fed_by_others)
{
    const struct job *job;

    two_are_ready();
    job = desk_find_job(f.c, job_a);
    ck_assert_uint_eq(job->workers[1].feeder, 1);
    coord_closed(f.c, ++f.now_ms, WORKER, "gone");
    carry_out(&f);
    ck_assert_uint_eq(job->workers[1].feeder, 0);
    join(&f, WORKER, MSG_ROLE_WORKER, "ws1", "daemon");
    strcpy(job->workers[0].worker->address, "tcp 127.0.0.1:1");
    ready(&f, WORKER, job_a);
    ck_assert_uint_eq(job->workers[0].feeder, 2);
}
END_TEST

/* Nobody knows whether a worker is there that has a tile which another made:
 * it gets nothing before it has said that it has the pass. */
START_TEST(a_worker_that_was_too_slow_has_to_say_what_it_has)
{
    two_are_ready();
    wait_s(&f, 1);
    make(SECOND, 0, 0, 1);
    make(SECOND, 0, 1, 1);
    ck_assert(has_tile(SECOND));
    ck_assert_int_eq(f.last[WORKER].type, MSG_CLOSED);
    ck_assert(f.last[WORKER].closed.asks);
    say(&f, WORKER,
        &(struct msg){ .type = MSG_HOLDS, .holds = { job_a, 1, 1 } });
    ck_assert_int_eq(f.last[WORKER].type, MSG_CLOSED); /* of no such pass */
    hold(true);
    ck_assert(has_tile(WORKER));
}
END_TEST

static const struct {
    uint32_t pass, tile;
    size_t len;
} wrong[] = { { 1, 0, AMBSHARE_BYTES },
              { 0, 2, AMBSHARE_BYTES },
              { 0, 0, AMBSHARE_BYTES - 1 } };

START_TEST(what_fits_no_tile_ends_the_connection)
{
    struct msg m = { .type = MSG_TILE_MADE,
                     .tile_made = { .job = job_a,
                                    .pass = wrong[_i].pass,
                                    .tile = wrong[_i].tile,
                                    .count = 1,
                                    .data = records,
                                    .len = wrong[_i].len } };

    submit_passes(ANA, &wide, 1);
    ready(&f, WORKER, job_a);
    say(&f, WORKER, &m);
    ck_assert(f.closed[WORKER]);
}
END_TEST

START_TEST(tiles_of_a_lost_worker_go_to_another)
{
    submit_passes(ANA, &wide, 1);
    ready(&f, WORKER, job_a);
    join(&f, SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    ready(&f, SECOND, job_a);
    ck_assert(has_tile(WORKER) && !has_tile(SECOND)); /* it has both */
    coord_closed(f.c, ++f.now_ms, WORKER, "gone");
    carry_out(&f);
    ck_assert(has_tile(SECOND));
    make_pass(SECOND, 0);
    ck_assert_uint_eq(state().open, 1);
}
END_TEST

/* A tile that is late is made by two; what comes second is dropped. */
START_TEST(a_late_tile_goes_to_a_second_worker)
{
    struct job *job;

    tile_rays = 10;
    submit_passes(ANA, &wide, 1);
    ready(&f, WORKER, job_a);
    join(&f, SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    ready(&f, SECOND, job_a);
    ck_assert(!has_tile(SECOND));
    wait_s(&f, 1);
    ck_assert(has_tile(SECOND));
    make_pass(SECOND, 0);
    made(WORKER, 0, 0, 1);
    ck_assert(!f.closed[WORKER]);
    job = desk_find_job(f.c, job_a);
    ck_assert_uint_eq(job->tiled.rays, 20);
    ck_assert_uint_eq(job->workers[0].past.dropped.rays, 10);
    tile_rays = 0;
}
END_TEST

/* A tick that comes a little early, behind one that came late, counts. */
START_TEST(a_late_tile_is_seen_at_the_next_tick)
{
    wait_s(&f, 1);
    f.now_ms += 60;
    submit_passes(ANA, &wide, 1);
    ready(&f, WORKER, job_a);
    join(&f, SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    ready(&f, SECOND, job_a);
    for (uint64_t ms = 50; ms < 100; ms += 49) {
        ck_assert(!has_tile(SECOND));
        f.now_ms += ms;
        coord_tick(f.c, f.now_ms);
        carry_out(&f);
    }
    ck_assert(has_tile(SECOND));
}
END_TEST

/* A worker of two threads has a third tile while many wait, and not when few
 * do: it may stand behind a dear one. */
START_TEST(near_the_end_of_a_pass_no_tile_stands_ahead)
{
    uint32_t tiles = tiles_of(LAST), out;

    submit_passes(ANA, &wide, 1);
    ready(&f, WORKER, job_a);
    for (uint32_t pass = 0; pass < LAST; pass++)
        make_pass(WORKER, pass);
    ck_assert_uint_gt(tiles, 12);
    for (uint32_t i = 0; i < tiles; i++) {
        out = tiles_out(&desk_find_job(f.c, job_a)->workers[0]);
        if (tiles - i >= 12)
            ck_assert_uint_eq(out, 3);
        if (tiles - i >= 2 && tiles - i <= 10)
            ck_assert_uint_eq(out, 2);
        made(WORKER, LAST, i, 0);
    }
}
END_TEST

/* Of many tiles that are out the one that is out for longest is late first, and
 * a worker that is lost has none, not even of those that another made. */
START_TEST(the_oldest_tile_is_late_first)
{
    struct job *job;

    submit_passes(ANA, &wide, 1);
    ready(&f, WORKER, job_a);
    for (uint32_t pass = 0; pass < LAST; pass++)
        make_pass(WORKER, pass);
    ck_assert_uint_gt(tiles_of(LAST), 6);
    join(&f, SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    ready(&f, SECOND, job_a);
    for (uint32_t i = 3; i < tiles_of(LAST);
         i++) /* WORKER has the first three */
        made(SECOND, LAST, i, 0);
    wait_s(&f, 1);
    ck_assert_uint_eq(f.last[SECOND].tile.tile, 1); /* it has 0 and 1 */
    job = desk_find_job(f.c, job_a);
    made(SECOND, LAST, 0, 0);
    ck_assert_uint_gt(tiles_out(&job->workers[0]), 0);
    coord_closed(f.c, ++f.now_ms, WORKER, "gone");
    carry_out(&f);
    ck_assert_uint_eq(tiles_out(&job->workers[0]), 0);
    join(&f, WORKER, MSG_ROLE_WORKER, "ws1", "daemon");
    ready(&f, WORKER, job_a);
    made(WORKER, LAST, 0, 0);
    ck_assert_uint_le(tiles_out(&job->workers[0]), 3);
}
END_TEST

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

    say(&f, conn, &m);
    hold(true);
}

static void
fetch_preview(uint64_t conn)
{
    struct msg m = { .type = MSG_FETCH,
                     .request = 6,
                     .fetch = { job_a, 0, MSG_WHAT_PREVIEW } };

    f.last[conn].type = MSG_DONE;
    say(&f, conn, &m);
}

/* From the first look on tiles tell their colours, and there is a preview as
 * soon as those of a pass are there; nobody else pays for that. */
START_TEST(tiles_tell_their_colours_to_who_watches)
{
    submit_passes(ANA, &wide, 1);
    ready(&f, WORKER, job_a);
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
END_TEST

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
START_TEST(tiles_count_as_progress)
{
    double done = 0, middle = 0;

    submit_passes(ANA, &wide, 1);
    ck_assert_double_eq(share_done(), 0);
    ready(&f, WORKER, job_a);
    for (uint32_t pass = 0; pass < PASSES; pass++)
        for (uint32_t i = 0; i < tiles_of(pass); i++) {
            made(WORKER, pass, i, 1);
            ck_assert_double_gt(share_done(), done);
            done = share_done();
            made(WORKER, pass, i, 1);
            ck_assert_double_eq(share_done(), done);
            if (pass < PASSES - 3) /* before the last ones */
                middle = done;
        }
    ck_assert_double_gt(middle, .1);
    ck_assert_double_gt(done, 1.5 * middle);
    ck_assert_double_lt(done, .95);
}
END_TEST

START_TEST(colours_that_nobody_wants_are_dropped)
{
    submit_passes(ANA, &wide, 1);
    ready(&f, WORKER, job_a);
    made_shown(WORKER, 0, 1, 3 * 4);
    ck_assert_uint_eq(f.ncolours, 0);
    ck_assert(!f.closed[WORKER]);
}
END_TEST

static const struct {
    uint32_t pass, n;
} unfit[] = { { 0, 1 }, { 0, 11 }, { 0, 13 }, { 0, 64 }, { 5, 64 } };

START_TEST(colours_that_fit_no_tile_end_the_connection)
{
    submit_passes(ANA, &wide, 1);
    fetch_preview(ANA);
    ready(&f, WORKER, job_a);
    for (uint32_t pass = 0; pass < unfit[_i].pass; pass++)
        make_pass(WORKER, pass);
    made_shown(WORKER, unfit[_i].pass, 1, unfit[_i].n);
    ck_assert(f.closed[WORKER]);
    ck_assert_uint_eq(f.ncolours, 0);
}
END_TEST

static bool
overlap(const struct rad_pass_area *a, const struct rad_pass_area *b)
{
    return a->x0 < b->x1 && b->x0 < a->x1 && a->y0 < b->y1 && b->y0 < a->y1;
}

static const struct rad_pass_size shown[] = { { 600, 400 }, { 1000, 900 } };

/* Has a pass over the first picture a tile there?  If so, which? */
static bool
find_there(const struct rad_pass *p, const struct rad_pass_area *there,
           uint32_t *tile)
{
    uint32_t n = rad_pass_tiles(p, shown[0].width, shown[0].height);

    for (*tile = 0; *tile < n; ++*tile) {
        struct rad_pass_area a =
            rad_pass_area(p, shown[0].width, shown[0].height, *tile);

        if (overlap(&a, there))
            return true;
    }
    return false;
}

/* Whatever the order, it has each tile once. */
static uint32_t
first_of(const struct dearest *d, const struct rad_pass *p)
{
    uint32_t order[4096];
    bool out[4096] = { false };

    ck_assert_uint_le(p->tiles, N_ELEM(order));
    ck_assert(dearest_order(d, p, order));
    for (uint32_t k = 0; k < p->tiles; k++) {
        ck_assert(order[k] < p->tiles && !out[order[k]]);
        out[order[k]] = true;
    }
    return order[0];
}

/* Where a pass over pixels took many rays the next begins. */
START_TEST(the_dearest_place_goes_out_first)
{
    const struct rad_pass_area spot = { 300, 200, 301, 201 };
    struct rad_pass_area there = spot, is;
    struct rad_pass plan[RAD_MOST_PASSES];
    struct dearest *d = dearest_new(shown, 2);
    struct rad_params params;
    uint32_t n, dear, seen = 0;

    ck_assert_ptr_nonnull(d);
    rad_params_init(&params);
    params.ambounce = 1;
    n = rad_passes_plan(&params, shown, 2, plan);
    for (uint32_t i = 0; i < n && !plan[i].scattered; i++) {
        uint32_t first = first_of(d, &plan[i]);

        if (seen > 0 && find_there(&plan[i], &there, &dear)) {
            is =
                rad_pass_area(&plan[i], shown[0].width, shown[0].height, first);
            ck_assert(overlap(&is, &there));
        }
        for (uint32_t k = 0; k < plan[i].tiles; k++)
            dearest_note(d, &plan[i], k, 1);
        if (find_there(&plan[i], &spot, &dear)) {
            dearest_note(d, &plan[i], dear, 1000000);
            there =
                rad_pass_area(&plan[i], shown[0].width, shown[0].height, dear);
            seen++;
        }
    }
    dearest_free(d);
    ck_assert_uint_gt(seen, 2);
}
END_TEST

/* The same of deep records, by the place in the order of the tree. */
START_TEST(the_dearest_part_goes_out_first)
{
    struct rad_pass pass = { .level = 1, .part = -1, .tiles = 13 };
    struct dearest *d = dearest_new(shown, 2);

    ck_assert_ptr_nonnull(d);
    ck_assert_uint_eq(first_of(d, &pass), 0);
    for (uint32_t k = 0; k < pass.tiles; k++)
        dearest_note(d, &pass, k, k == 7 ? 100 : 10);
    ck_assert_uint_eq(first_of(d, &pass), 7);
    pass.tiles = 130;
    ck_assert_uint_eq(first_of(d, &pass), 70);
    pass = (struct rad_pass){ 0 }; /* a pass without tiles */
    ck_assert(dearest_order(d, &pass, NULL));
    dearest_free(d);
}
END_TEST

/* By two workers' children, or three of one worker's. */
START_TEST(a_tile_that_brings_children_down_fails_the_job)
{
    struct msg lost = { .type = MSG_LOST,
                        .lost = { job_a, "signal 11", 0, NULL } };
    int times = 0;

    submit_passes(ANA, &wide, 1);
    for (; times < 10 && f.last[ANA].type != MSG_FAILED; times++) {
        ready(&f, WORKER, job_a);
        say(&f, WORKER, &lost);
    }
    ck_assert_int_eq(times, JOB_MAX_CRASHES);
    ck_assert_ptr_nonnull(strstr(f.last[ANA].failed.text,
                                 "of the ambient cache, brought the renderer "
                                 "down"));
}
END_TEST

/* A child that knows passes of an earlier life begins anew. */
START_TEST(a_worker_that_is_ahead_begins_anew)
{
    struct msg m = { .type = MSG_READY, .ready = { job_a, .1, 7, 2, 3 } };

    submit_passes(ANA, &wide, 1);
    say(&f, WORKER, &m);
    ck_assert_int_eq(f.last[WORKER].type, MSG_JOB_START);
    ready(&f, WORKER, job_a);
    ck_assert(has_tile(WORKER));
}
END_TEST

/* --- stages --- */

static void
submit_goal(uint32_t error_ppm, uint32_t time_ms)
{
    struct msg m = usual_submit(job_a);

    m.request = 5;
    m.submit.params = "-ab 1 -ps 4";
    m.submit.flags = MSG_JOB_PASSES;
    m.submit.partition = MSG_PART_WINDOW;
    m.submit.windows = 4;
    m.submit.frames = &wide;
    m.submit.nframes = 1;
    m.submit.error_ppm = error_ppm;
    m.submit.time_ms = time_ms;
    say(&f, ANA, &m);
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
    say(&f, conn, &m);
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

START_TEST(sums_that_are_no_numbers_end_the_connection)
{
    submit_goal(50000, 0);
    ready(&f, WORKER, job_a);
    for (uint32_t pass = 0; pass < PASSES; pass++)
        make_pass(WORKER, pass);
    ck_assert(checks() && !f.closed[WORKER]);
    send_sums(WORKER, PASSES, 0, unsound[_i].v, unsound[_i].cut);
    ck_assert(f.closed[WORKER]);
}
END_TEST

START_TEST(what_is_far_off_has_another_stage)
{
    const struct msg_stage *st = &f.last[WORKER].stage;
    struct job *job;

    submit_goal(50000, 0);
    ready(&f, WORKER, job_a);
    make_stage(WORKER, 0, 1);
    job = desk_find_job(f.c, job_a);
    ck_assert_int_eq(f.last[WORKER].type, MSG_STAGE);
    ck_assert_uint_eq(st->pass, PASSES + 1);
    ck_assert_str_eq(st->params, goal_options(job));
    ck_assert_str_ne(st->params, job->spec.params);
    ck_assert_uint_eq(state().open, 0);
    ck_assert_uint_eq(f.units[WORKER], 0);
    ck_assert(job->goal.error > .9 && !job->goal.ended);
    /* one that is late gets this stage alone */
    made(WORKER, PASSES + 1, 0, 1);
    for (uint32_t i = 1; i < tiles_of(0); i++)
        made(WORKER, PASSES + 1, i, 1);
    job->state = JOB_RUNNING;
    join(&f, SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    job->state = JOB_PAUSED;
    ready(&f, SECOND, job_a);
    ck_assert_int_eq(f.last[SECOND].type, MSG_FROZEN);
    ck_assert_uint_eq(f.last[SECOND].frozen.pass, PASSES + 1);
    /* tiles of the old one are of no use */
    made(SECOND, 3, 0, 1);
    ck_assert(!f.closed[SECOND]);
}
END_TEST

START_TEST(what_is_good_enough_has_no_other_stage)
{
    struct job *job;

    submit_goal(50000, 0);
    ready(&f, WORKER, job_a);
    make_stage(WORKER, 0, 1e-6);
    job = desk_find_job(f.c, job_a);
    ck_assert(job->goal.ended && !job->goal.late && job->goal.number == 0);
    ck_assert(job->goal.error > 0 && job->goal.error <= .05);
    ck_assert_str_eq(goal_options(job), job->spec.params);
    ck_assert(!passes_open(job));
    job->state = JOB_RUNNING;
    wait_s(&f, 1);
    ck_assert_uint_gt(f.units[WORKER], 0);
}
END_TEST

/* However much that would bring. */
START_TEST(without_time_there_is_no_other_stage)
{
    struct job *job;

    submit_goal(0, 1000);
    ready(&f, WORKER, job_a);
    f.now_ms += 5000;
    make_stage(WORKER, 0, 1);
    job = desk_find_job(f.c, job_a);
    ck_assert(job->goal.ended && job->goal.late);
}
END_TEST

/* Passes that were kept have taken more than a new life's clock has seen. */
START_TEST(what_passes_took_before_a_restart_counts)
{
    struct job *job;

    submit_goal(0, 30000);
    ready(&f, WORKER, job_a);
    f.now_ms += 100;
    tile_rays = 1000;
    tile_cpu_s = 30;
    make_stage(WORKER, 0, 1);
    job = desk_find_job(f.c, job_a);
    ck_assert(job->goal.ended && job->goal.late);
    tile_rays = 0;
    tile_cpu_s = 0;
}
END_TEST

/* Rungs that the clock chose are quarters, and they are kept. */
START_TEST(a_later_life_takes_up_what_the_clock_chose)
{
    enum { KEPT = PASSES + 1 };
    uint8_t bytes[STAGES_BYTES];
    struct saved_pass pass[KEPT] = { 0 };
    struct kept_passes were;
    struct job_goal goal;
    struct job *job;

    submit_goal(0, 30000);
    ready(&f, WORKER, job_a);
    f.now_ms += 8000; /* the rest is near: no stage comes before it */
    tile_rays = 1000;
    tile_cpu_s = .01;
    make_stage(WORKER, 0, 1);
    job = desk_find_job(f.c, job_a);
    goal = job->goal;
    ck_assert(!goal.ended && goal.number == 1);
    ck_assert_uint_ne((goal.rungs[0] | goal.rungs[1]) >> 6, 0);
    stages_pack(f.c, job, bytes);
    pass[PASSES].len = sizeof bytes;
    job->goal = (struct job_goal){ 0 };
    were = job->kept;
    job->kept = (struct kept_passes){ .pass = pass, .n = KEPT };
    pass[PASSES].bytes = memcpy(malloc(sizeof bytes), bytes, sizeof bytes);
    ck_assert_int_eq(stages_take_up(f.c, job, NULL), 0);
    job->kept = were;
    ck_assert_uint_eq(job->goal.number, 1);
    ck_assert_mem_eq(job->goal.rungs, goal.rungs, 2);
    ck_assert_str_eq(job->goal.options, goal.options);
    tile_rays = 0;
    tile_cpu_s = 0;
}
END_TEST

/* A child from an earlier life may be at a stage with other options, if the
 * clock chose them. */
START_TEST(by_the_clock_a_child_of_an_earlier_life_begins_anew)
{
    struct msg m = { .type = MSG_READY, .ready = { job_a, .1, 7, 2, 1 } };

    submit_goal(50000, _i ? 60000 : 0);
    ready(&f, WORKER, job_a);
    make_pass(WORKER, 0);
    make_pass(WORKER, 1);
    join(&f, SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    desk_find_job(f.c, job_a)->state = JOB_PAUSED;
    say(&f, SECOND, &m);
    ck_assert_int_eq(f.last[SECOND].type, _i ? MSG_JOB_END : MSG_FROZEN);
}
END_TEST

/* What no coordinator has memory for, and no message a number. */
START_TEST(more_tiles_than_there_may_be_are_refused)
{
    enum { FRAMES = 3000 }; /* 94 in a batch */
    static struct msg_frame huge[FRAMES];

    for (uint32_t i = 0; i < FRAMES; i++)
        huge[i] = (struct msg_frame){ i, 65520, 1000, "" };
    submit_passes(ANA, huge, FRAMES);
    ready(&f, WORKER, job_a);
    ck_assert_int_eq(f.last[ANA].type, MSG_FAILED);
    ck_assert_msg(f.last[ANA].failed.status == EX_DATAERR, "%s",
                  f.last[ANA].failed.text);
    ck_assert_ptr_nonnull(
        strstr(f.last[ANA].failed.text, "too much for --ambient=passes"));
}
END_TEST

int
main(void)
{
    Suite *s = suite_create("coord_passes");
    TCase *tc = tcase_create("coord_passes");

    tcase_add_checked_fixture(tc, set_up, tear_down);
    tcase_add_test(tc, units_come_when_all_passes_are_closed);
    tcase_add_test(tc, a_pass_that_is_closed_goes_to_all);
    tcase_add_test(tc, records_travel_while_tiles_are_made);
    tcase_add_test(tc, workers_below_one_that_hangs_are_fed_by_others);
    tcase_add_test(tc, a_new_feeder_does_not_fail_at_once);
    tcase_add_test(tc, the_coordinator_does_not_come_to_feed_all);
    tcase_add_test(tc, workers_without_an_address_are_not_fed_by_each_other);
    tcase_add_test(tc, workers_that_were_fed_are_fed_by_others);
    tcase_add_test(tc, a_worker_that_was_too_slow_has_to_say_what_it_has);
    tcase_add_loop_test(tc, what_fits_no_tile_ends_the_connection, 0,
                        N_ELEM(wrong));
    tcase_add_test(tc, tiles_of_a_lost_worker_go_to_another);
    tcase_add_test(tc, a_late_tile_goes_to_a_second_worker);
    tcase_add_test(tc, a_late_tile_is_seen_at_the_next_tick);
    tcase_add_test(tc, the_dearest_place_goes_out_first);
    tcase_add_test(tc, the_dearest_part_goes_out_first);
    tcase_add_test(tc, near_the_end_of_a_pass_no_tile_stands_ahead);
    tcase_add_test(tc, the_oldest_tile_is_late_first);
    tcase_add_test(tc, tiles_tell_their_colours_to_who_watches);
    tcase_add_test(tc, tiles_count_as_progress);
    tcase_add_test(tc, colours_that_nobody_wants_are_dropped);
    tcase_add_loop_test(tc, colours_that_fit_no_tile_end_the_connection, 0,
                        N_ELEM(unfit));
    tcase_add_test(tc, a_tile_that_brings_children_down_fails_the_job);
    tcase_add_test(tc, a_worker_that_is_ahead_begins_anew);
    tcase_add_test(tc, more_tiles_than_there_may_be_are_refused);
    tcase_add_loop_test(tc, sums_that_are_no_numbers_end_the_connection, 0,
                        N_ELEM(unsound));
    tcase_add_test(tc, what_is_far_off_has_another_stage);
    tcase_add_test(tc, what_is_good_enough_has_no_other_stage);
    tcase_add_test(tc, without_time_there_is_no_other_stage);
    tcase_add_test(tc, what_passes_took_before_a_restart_counts);
    tcase_add_test(tc, a_later_life_takes_up_what_the_clock_chose);
    tcase_add_loop_test(tc, by_the_clock_a_child_of_an_earlier_life_begins_anew,
                        0, 2);
    suite_add_tcase(s, tc);
    return unit_run(s);
}
