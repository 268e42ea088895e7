/* check_recheck.c - the check pass of a stage: sums of a room's tiles */
#include "config.h"

#include "light/indirect/ambient.h"
#include "refine/recheck.h"

#include "tests/world_picture.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

static const char scene_text[] = WORLD_ROOM;

enum { THREADS = 4, MOST = 200 };

struct room {
    struct world w;
    struct rad_frame frame;
    struct rad_passes *passes;
    uint32_t ntiles;
    bool backward, twice;
    _Atomic uint64_t rays; /* of all tiles */
    _Atomic uint32_t next;
    struct rad_refine_sums of[MOST];
};

/* Records of a pass. */
static struct {
    struct rad_ambrec rec[20000];
    size_t n;
} made;

static void
keep(void *arg, const struct rad_ambrec *rec, size_t n)
{
    (void)arg;
    ck_assert_uint_le(made.n + n, N_ELEM(made.rec));
    memcpy(&made.rec[made.n], rec, n * sizeof *rec);
    made.n += n;
}

static const _Atomic bool never;

/* A room whose cache is filled, at its check pass; so many pixels a side are
 * one of the picture that is written. */
static void
open_filtered_room(struct room *m, const char *options, int oversample)
{
    struct rad_pass pass[RAD_MOST_PASSES];
    struct rad_pass_size size;
    uint32_t n;

    memset(m, 0, sizeof *m);
    world_open(&m->w, scene_text, options);
    rad_ambient_freeze(m->w.job->ambient);
    world_frame(&m->w, "-vp 0 -4.9 2.5 -vd 0 1 0 -vh 80 -vv 80", false,
                &m->frame);
    m->frame.oversample = oversample;
    size = (struct rad_pass_size){ m->frame.width, m->frame.height };
    n = rad_refine_plan(&m->w.job->params, &size, 1, false, true, pass);
    m->passes = rad_passes_new(&m->frame, 1, NULL);
    ck_assert_ptr_nonnull(m->passes);
    for (uint32_t i = 0; i < n; i++) {
        ck_assert_int_eq(rad_passes_begin(m->passes, &m->w.ctx, &pass[i], NULL),
                         0);
        made.n = 0;
        for (uint32_t k = 0; !pass[i].check && k < pass[i].tiles; k++)
            ck_assert(rad_passes_make(
                m->passes, &m->w.ctx,
                &(struct rad_passes_order){
                    .pass = &pass[i], .tile = k, .stop = &never, .fn = keep }));
        rad_ambient_insert_all(m->w.job->ambient, made.rec, made.n);
        ck_assert(rad_ambient_settle(m->w.job->ambient));
        if (rad_pass_is_last(pass, n, i))
            ck_assert(rad_ambient_smooth(m->w.job->ambient));
    }
    m->ntiles = pass[n - 1].tiles;
    ck_assert_uint_le(m->ntiles, MOST);
}

static void
open_room(struct room *m, const char *options)
{
    open_filtered_room(m, options, 1);
}

static void
close_room(struct room *m)
{
    rad_passes_free(m->passes);
    rad_frame_release(&m->frame);
    world_close(&m->w);
}

static void *
work(void *arg)
{
    struct room *m = arg;
    struct rad_ctx ctx;
    uint32_t i;

    ck_assert_int_eq(rad_ctx_init(&ctx, m->w.job, NULL), 0);
    while ((i = atomic_fetch_add(&m->next, 1)) < m->ntiles) {
        uint32_t tile = m->backward ? m->ntiles - 1 - i : i;

        for (int k = 0; k <= m->twice; k++) {
            uint64_t before = ctx.counts.rays;

            ck_assert(
                rad_refine_make(m->passes, &ctx, tile, &never, &m->of[tile]));
            ck_assert_double_ge(m->of[tile].shown, 1);
            ck_assert_double_gt(m->of[tile].rays, 0);
            ck_assert_double_lt(m->of[tile].rays,
                                (double)(ctx.counts.rays - before));
        }
    }
    ck_assert_uint_eq(ctx.counts.primary_rays, 0);
    ck_assert_uint_eq(ctx.counts.ambient_values, 0);
    ck_assert(!ctx.fresh);
    atomic_fetch_add(&m->rays, ctx.counts.rays);
    rad_ctx_release(&ctx);
    return NULL;
}

static void
make_tiles(struct room *m, int threads, bool backward, bool twice)
{
    pthread_t thread[THREADS];

    m->backward = backward;
    m->twice = twice;
    m->next = 0;
    m->rays = 0;
    memset(m->of, 0, sizeof m->of);
    for (int i = 0; i < threads; i++)
        ck_assert_int_eq(pthread_create(&thread[i], NULL, work, m), 0);
    for (int i = 0; i < threads; i++)
        ck_assert_int_eq(pthread_join(thread[i], NULL), 0);
}

static struct rad_error_estimate
error_of(const struct room *m)
{
    struct rad_refine_sums all = { 0 };

    for (uint32_t i = 0; i < m->ntiles; i++)
        rad_refine_add(&all, &m->of[i]);
    return rad_doubt_error(&all.doubt);
}

#define COARSE                                                                 \
    "-x 96 -y 96 -pa 1 -ab 2 -aa .5 -ar 16 -ad 16 -as 0 -pt .2 -ps 4 -pj .9 "

static struct room rooms[2];

/* Whoever makes the tiles, in whatever order, and however often. */
TEST(sums_are_a_function_of_the_job)
{
    struct room *one = &rooms[0], *other = &rooms[1];

    open_room(one, COARSE);
    open_room(other, COARSE);
    make_tiles(one, 1, false, false);
    make_tiles(other, THREADS, true, true);
    ck_assert_mem_eq(one->of, other->of, sizeof one->of);
    ck_assert_double_gt(error_of(one).ambient, .005);
    close_room(one);
    close_room(other);
}

TEST(a_finer_cache_is_found_to_be_better)
{
    struct room *m = &rooms[0];
    struct rad_error_estimate coarse, fine;

    open_room(m, COARSE);
    make_tiles(m, 1, false, false);
    coarse = error_of(m);
    close_room(m);
    open_room(m, COARSE "-aa .2 -ar 32 -ad 1024");
    make_tiles(m, 1, false, false);
    fine = error_of(m);
    close_room(m);
    ck_assert_double_lt(fine.ambient, .6 * coarse.ambient);
}

/* So checks of stages with all but the same cache are by chance apart. */
TEST(stages_look_at_windows_of_their_own)
{
    struct room *one = &rooms[0], *other = &rooms[1];
    int same = 0;

    open_room(one, COARSE "-ds 0 -dj 1");
    open_room(other, COARSE "-ds 0 -dj 1 -aa .49999");
    make_tiles(one, THREADS, false, false);
    make_tiles(other, THREADS, false, false);
    ck_assert_uint_eq(one->ntiles, other->ntiles);
    for (uint32_t i = 0; i < one->ntiles; i++) {
        const double *a = one->of[i].doubt.v, *b = other->of[i].doubt.v;

        same += fabs(a[RAD_DOUBT_AREAS] - b[RAD_DOUBT_AREAS]) <
                .05 * a[RAD_DOUBT_AREAS];
    }
    ck_assert_int_lt(same, (int)one->ntiles / 2);
    close_room(one);
    close_room(other);
}

/* Noise of pixels averages out in those of the picture that is written. */
TEST(a_picture_that_is_filtered_down_is_found_to_have_less_noise)
{
    struct room *m = &rooms[0];
    struct rad_error_estimate e[2];

    for (int i = 0; i < 2; i++) {
        open_filtered_room(m, COARSE "-ps 1 -ds 0 -dj 1 -st 0 -dt 0 -dv-",
                           i == 0 ? 1 : 4);
        make_tiles(m, THREADS, false, false);
        e[i] = error_of(m);
        close_room(m);
    }
    ck_assert_double_lt(e[1].sampling, .5 * e[0].sampling);
    ck_assert_double_gt(e[1].ambient, .5 * e[0].ambient);
}

/* A check takes no more rays for it; windows of eight stages, for those of one
 * are few: the ratio is .87 to 1.08. */
TEST(a_picture_that_is_filtered_down_is_checked_as_cheaply)
{
    enum { STAGES = 8 };
    struct room *m = &rooms[0];
    uint64_t rays[2] = { 0, 0 };

    for (int i = 0; i < 2 * STAGES; i++) {
        char options[200];

        snprintf(options, sizeof options,
                 COARSE "-x 192 -y 192 -ps 6 -ds .2 -dj .9 -aa %g",
                 .5 + .001 * (i / 2));
        open_filtered_room(m, options, 1 + i % 2);
        make_tiles(m, THREADS, false, false);
        rays[i % 2] += m->rays;
        close_room(m);
    }
    ck_assert_uint_lt(rays[1], rays[0] + rays[0] / 20);
}

TEST(a_tile_can_be_stopped)
{
    static const _Atomic bool stop = true;
    struct room *m = &rooms[0];

    open_room(m, COARSE);
    ck_assert(!rad_refine_make(m->passes, &m->w.ctx, 0, &stop, &m->of[0]));
    close_room(m);
}

/* One pixel, one column: a window is no larger than the picture. */
static const char *const sizes[] = {
    "-x 1 -y 1 ",   "-x 1 -y 300 ",        "-x 300 -y 1 ",
    "-x 300 -y 4 ", "-x 30 -y 30 -ps 16 ", "-x 30 -y 30 -ps 1 "
};

LOOP_TEST(small_pictures_have_an_error_too, 2 * N_ELEM(sizes))
{
    int size = _i / 2, oversample = _i % 2 == 0 ? 1 : 8;
    struct room *m = &rooms[0];
    const double *a = m->of[0].doubt.v, *b = m->of[1].doubt.v;
    char options[300];

    snprintf(options, sizeof options, COARSE "%s -pa 0", sizes[size]);
    open_filtered_room(m, options, oversample);
    make_tiles(m, 1, false, false);
    ck_assert_double_ge(error_of(m).all, 0);
    ck_assert_double_lt(error_of(m).all, 1);
    ck_assert_double_gt(a[RAD_DOUBT_AREAS], 0);
    ck_assert(a[RAD_DOUBT_PIXEL] != b[RAD_DOUBT_PIXEL]); /* other samples */
    close_room(m);
}
