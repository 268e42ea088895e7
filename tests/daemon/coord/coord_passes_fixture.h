/* coord_passes_fixture.h - a job with passes at the coordinator of
 * coord_fixture.h, and workers that make its tiles */
#ifndef RADD_TESTS_COORD_PASSES_FIXTURE_H
#define RADD_TESTS_COORD_PASSES_FIXTURE_H

#include "passes/passplan.h"
#include "proto/ambshare.h"
#include "filling/passes.h"
#include "coord_fixture.h" /* last: it has a variable f */

static const struct msg_frame wide = { 0, 200, 100, "" };

/* Lattices of 32, and of 16, 8 and 4 pixels in two fields each; and what these
 * left out, in rounds. */
enum { PASSES = 12, LAST = PASSES - 1 };
static uint8_t records[4 * AMBSHARE_BYTES];

static inline struct msg
passes_submit(const struct msg_frame *frames, uint32_t n)
{
    struct msg m = usual_submit(job_a);

    m.request = 5;
    m.submit.params = "-ab 1 -ps 4";
    m.submit.flags = MSG_JOB_PASSES;
    m.submit.partition = MSG_PART_WINDOW;
    m.submit.windows = 4;
    m.submit.frames = frames;
    m.submit.nframes = n;
    return m;
}

static inline void
submit_passes(uint64_t conn, const struct msg_frame *frames, uint32_t n)
{
    struct msg m = passes_submit(frames, n);

    say(conn, &m);
}

/* Ana submits a job of one frame with passes, and the first worker is ready. */
static inline void
start_passes(const struct msg_frame *of)
{
    submit_passes(ANA, of, 1);
    ready(WORKER, job_a);
}

/* The last thing that was said to a worker is a tile. */
static inline bool
has_tile(uint64_t conn)
{
    return f.last[conn].type == MSG_TILE;
}

/* The workers say that they have what they are asked for. */
static inline void
hold(bool whole)
{
    for (uint64_t conn = WORKER; conn <= SECOND; conn++)
        while (f.to_hold[conn].job) {
            struct msg m = { .type = MSG_HOLDS,
                             .holds = { job_a, f.to_hold[conn].pass, whole } };

            f.to_hold[conn].job = NULL;
            say(conn, &m);
        }
}

static uint64_t tile_rays; /* that each tile takes, */
static double tile_cpu_s;  /* and seconds */

static inline void
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

    say(conn, &m);
}

static inline void
made(uint64_t conn, uint32_t pass, uint32_t tile, uint32_t n)
{
    make(conn, pass, tile, n);
    hold(true);
}

static inline struct passes_state
state(void)
{
    return passes_state(desk_find_job(f.c, job_a));
}

static inline uint32_t
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
static inline void
make_pass(uint64_t conn, uint32_t pass)
{
    for (uint32_t i = 0; i < tiles_of(pass); i++) {
        ck_assert_uint_eq(state().open, pass);
        made(conn, pass, i, 1);
    }
}

#endif
