/* check_passes.c - the ambient cache as a function of the job */
#include "config.h"

#include "light/indirect/ambient.h"
#include "image/hdr.h"
#include "passes/passes.h"

#include "tests/plan_parts.h"
#include "tests/world_picture.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

/* The room with a mirror, seen through a pane. */
static const char scene_text[] = WORLD_ROOM
    "void glass pane 0 0 3 .9 .9 .9\n"
    "pane polygon window 0 0 12 -4 -4.5 0 4 -4.5 0 4 -4.5 5 -4 -4.5 5\n"
    "void mirror silver 0 0 3 .9 .9 .9\n"
    "silver polygon glass 0 0 12 4.9 -1 1 4.9 1 1 4.9 1 3 4.9 -1 3\n";

#define OPTIONS                                                                \
    "-x 96 -y 96 -ar 16 -aa .25 -ad 64 -as 16 -lw 0 -lr 8 -ps 1 -pj .9 "

enum { SIDE = 96, MOST = 20000, THREADS = 4 };

struct room {
    struct world w;
    struct rad_frame frame;
    struct rad_ambrec rec[MOST];
    size_t nrecs;
    struct rad_pixel picture[SIDE * SIDE];
};

static struct room rooms[2];

/* Without a cache that is frozen. */
static void
open_live(struct room *m, const char *scene, const char *options)
{
    char text[200];

    snprintf(text, sizeof text, OPTIONS "%s", options);
    world_open(&m->w, scene, text);
    world_frame(&m->w, "-vp 0 -4.9 2.5 -vd 0 1 0 -vh 80 -vv 80", false,
                &m->frame);
    m->nrecs = 0;
}

static void
open_room(struct room *m, const char *options)
{
    open_live(m, scene_text, options);
    rad_ambient_freeze(m->w.job->ambient);
}

static void
close_room(struct room *m)
{
    rad_frame_release(&m->frame);
    world_close(&m->w);
}

static uint32_t
plan(const struct room *m, struct rad_pass pass[RAD_MOST_PASSES])
{
    struct rad_pass_size size = { m->frame.width, m->frame.height };

    return rad_passes_plan(&m->w.job->params, &size, 1, pass);
}

/* --- tiles, by one thread or several, in any order --- */

struct tiles {
    const struct rad_passes *passes;
    const struct rad_job *job;
    const struct rad_pass *pass;
    uint32_t n;
    bool backward, twice;
    _Atomic uint32_t next;
    struct list {
        struct rad_ambrec rec[3000];
        size_t n;
    } * list;
};

static const _Atomic bool never;

static void
keep(void *arg, const struct rad_ambrec *rec, size_t n)
{
    struct list *l = arg;

    ck_assert_uint_le(l->n + n, N_ELEM(l->rec));
    memcpy(&l->rec[l->n], rec, n * sizeof *rec);
    l->n += n;
}

/* Make a tile; its records are added to *list, its colours put into *colours,
 * unless NULL. */
static void
make_shown_tile(struct room *m, const struct rad_passes *p,
                const struct rad_pass *pass, uint32_t tile, struct list *list,
                struct rad_pass_colours *colours)
{
    ck_assert(
        rad_passes_make(p, &m->w.ctx,
                        &(struct rad_passes_order){ .pass = pass,
                                                    .tile = tile,
                                                    .stop = &never,
                                                    .fn = keep,
                                                    .arg = list,
                                                    .colours = colours }));
}

static void
make_tile(struct room *m, const struct rad_passes *p,
          const struct rad_pass *pass, uint32_t tile, struct list *list)
{
    make_shown_tile(m, p, pass, tile, list, NULL);
}

static void *
work(void *arg)
{
    struct tiles *t = arg;
    struct rad_ctx ctx;
    uint32_t i;

    ck_assert_int_eq(rad_ctx_init(&ctx, t->job, NULL), 0);
    while ((i = atomic_fetch_add(&t->next, 1)) < t->n) {
        uint32_t tile = t->backward ? t->n - 1 - i : i;

        for (int k = 0; k <= t->twice; k++) {
            t->list[tile].n = 0;
            ck_assert(rad_passes_make(
                t->passes, &ctx,
                &(struct rad_passes_order){
                    .pass = t->pass,
                    .seen = rad_ambient_view(t->job->ambient, t->pass->reads),
                    .tile = tile,
                    .stop = &never,
                    .fn = keep,
                    .arg = &t->list[tile] }));
        }
    }
    ck_assert_uint_eq(ctx.counts.primary_rays, 0);
    rad_ctx_release(&ctx);
    return NULL;
}

/* All tiles of a pass. */
static void
make_pass(struct tiles *t, struct room *m, struct rad_passes *p,
          const struct rad_pass *pass, int threads, bool backward, bool twice)
{
    pthread_t thread[THREADS];

    *t = (struct tiles){ p,        m->w.job,
                         pass,     pass->tiles,
                         backward, twice,
                         0,        calloc(pass->tiles, sizeof *t->list) };
    ck_assert_ptr_nonnull(t->list);
    ck_assert_int_eq(rad_passes_begin(p, &m->w.ctx, pass, NULL), 0);
    for (int i = 0; i < threads; i++)
        ck_assert_int_eq(pthread_create(&thread[i], NULL, work, t), 0);
    for (int i = 0; i < threads; i++)
        ck_assert_int_eq(pthread_join(thread[i], NULL), 0);
}

static void
close_pass(struct room *m, const struct tiles *t)
{
    for (uint32_t i = 0; i < t->n; i++) {
        ck_assert_uint_le(m->nrecs + t->list[i].n, MOST);
        memcpy(&m->rec[m->nrecs], t->list[i].rec,
               t->list[i].n * sizeof *m->rec);
        m->nrecs += t->list[i].n;
        rad_ambient_insert_all(m->w.job->ambient, t->list[i].rec, t->list[i].n);
    }
    ck_assert(rad_ambient_settle(m->w.job->ambient));
    free(t->list);
}

static void
fill(struct room *m, int threads, bool backward, bool twice)
{
    struct rad_passes *p = rad_passes_new(&m->frame, 1, NULL);
    struct rad_pass pass[RAD_MOST_PASSES];
    uint32_t n = plan(m, pass);

    ck_assert_ptr_nonnull(p);
    for (uint32_t i = 0; i < n; i++) {
        struct tiles t;

        make_pass(&t, m, p, &pass[i], threads, backward, twice);
        close_pass(m, &t);
    }
    ck_assert(rad_ambient_smooth(m->w.job->ambient));
    rad_passes_free(p);
}

/* Make the tiles of passes from number i on, up to `ahead` behind it, as soon
 * as those that they read are closed. */
static void
fill_parts(struct room *m, int threads, uint32_t ahead)
{
    struct rad_passes *p = rad_passes_new(&m->frame, 1, NULL);
    static struct rad_pass pass[RAD_MOST_PASSES];
    static struct tiles t[RAD_MOST_PASSES];
    uint32_t n = plan_parts(&m->w.job->params, SIDE, pass);

    memset(t, 0, sizeof t);
    ck_assert_ptr_nonnull(p);
    for (uint32_t i = 0; i < n; i++) {
        for (uint32_t k = i; k <= i + ahead && k < n; k++)
            if (!t[k].list && pass[k].reads <= i)
                make_pass(&t[k], m, p, &pass[k], threads, ahead > 0, false);
        close_pass(m, &t[i]);
    }
    ck_assert(rad_ambient_smooth(m->w.job->ambient));
    rad_passes_free(p);
}

/* A tile does not see a pass that it does not read, whether that is closed by
 * then or not. */
LOOP_TEST(a_tile_sees_the_passes_that_it_reads, 3)
{
    static const char *const options[] = { "-ab 3", "-ab 3",
                                           "-ab 2 -aw 64 -av .1 .1 .1" };
    struct room *one = &rooms[0], *other = &rooms[1];

    open_room(one, options[_i]);
    open_room(other, options[_i]);
    fill_parts(one, 1, 0);
    fill_parts(other, 2, 1 + (uint32_t)_i);
    ck_assert_uint_gt(one->nrecs, 100);
    ck_assert_uint_eq(one->nrecs, other->nrecs);
    ck_assert_mem_eq(one->rec, other->rec, one->nrecs * sizeof *one->rec);
    close_room(one);
    close_room(other);
}

/* Records of a tile by level, in the order in which they are handed on. */
struct levels {
    size_t n, of[2];
    bool mixed; /* one of level 0 came after one of level 1 */
};

static void
count_levels(void *arg, const struct rad_ambrec *rec, size_t n)
{
    struct levels *l = arg;

    for (size_t i = 0; i < n; i++) {
        ck_assert_int_lt(rec[i].level, 2);
        l->mixed |= rec[i].level == 0 && l->of[1] > 0;
        l->of[rec[i].level]++;
        l->n++;
    }
}

/* Make tiles of the last pass, which end at no number of rays, over an empty
 * cache; what the one with most records has. */
static struct levels
levels_of_tile(const char *options)
{
    struct room *m = &rooms[0];
    struct rad_passes *p;
    struct rad_pass pass[RAD_MOST_PASSES];
    struct levels l, most = { 0 };
    uint32_t i;

    open_room(m, options);
    i = plan(m, pass) - 1;
    ck_assert_uint_eq(pass[i].rays, 0);
    p = rad_passes_new(&m->frame, 1, NULL);
    ck_assert_ptr_nonnull(p);
    ck_assert_int_eq(rad_passes_begin(p, &m->w.ctx, &pass[i], NULL), 0);
    for (uint32_t k = 0; k < pass[i].tiles && most.n < RAD_PASS_MOST_RECORDS;
         k++) {
        l = (struct levels){ 0 };
        ck_assert(
            rad_passes_make(p, &m->w.ctx,
                            &(struct rad_passes_order){ .pass = &pass[i],
                                                        .tile = k,
                                                        .stop = &never,
                                                        .fn = count_levels,
                                                        .arg = &l }));
        most = l.n > most.n ? l : most;
    }
    rad_passes_free(p);
    close_room(m);
    return most;
}

/* Of too many records those that pixels ask for are all kept. */
TEST(a_tile_with_too_many_records_leaves_out_deep_ones)
{
    struct levels few = levels_of_tile("-ab 2");
    struct levels many = levels_of_tile("-ab 2 -aa .1 -ar 1024 -ad 32 -as 0");

    ck_assert(few.mixed); /* in the order of making */
    ck_assert_uint_lt(few.n, RAD_PASS_MOST_RECORDS);
    ck_assert_msg(!many.mixed, "%zu %zu", many.of[0], many.of[1]);
    ck_assert_uint_eq(many.n, RAD_PASS_MOST_RECORDS);
    ck_assert_uint_gt(many.of[0], few.of[0]);
    ck_assert_uint_gt(many.of[1], 0);
}

/* The room is closed and all paths bounce within it: their ends are on all of
 * its sides. */
static void
check_spots(const struct rad_pass_spot *spot, size_t n)
{
    for (int axis = 0; axis < 3; axis++) {
        int least = RAD_PASS_NO_SPOT, most = 0;

        for (size_t i = 0; i < n; i++) {
            int at = spot[i].at[axis];

            if (at != RAD_PASS_NO_SPOT) {
                least = at < least ? at : least;
                most = at > most ? at : most;
            }
        }
        ck_assert_int_gt(most - least, RAD_PASS_NO_SPOT / 3);
    }
}

/* Make the tiles of a pass again, over its records: none is made, and no path
 * whose end is known is walked to find that out.  (Rays tell whether a record
 * is hidden from an end.) */
static void
check_served(struct room *m, const struct rad_passes *p,
             const struct rad_pass *pass, struct list *made)
{
    static struct list none;

    rad_ambient_insert_all(m->w.job->ambient, made->rec, made->n);
    ck_assert(rad_ambient_settle(m->w.job->ambient));
    memset(&m->w.ctx.counts, 0, sizeof m->w.ctx.counts);
    for (uint32_t i = 0; i < pass->tiles; i++)
        make_tile(m, p, pass, i, &none);
    ck_assert_uint_eq(none.n, 0);
    ck_assert_uint_lt(m->w.ctx.counts.rays, pass->end - pass->first);
}

/* Who is told where paths go finds the same tiles as who walks them, and so
 * does who comes when the walk is over. */
TEST(paths_can_be_walked_elsewhere)
{
    static struct list here, there, then;
    struct room *m = &rooms[0];
    struct rad_passes *p, *told, *late;
    struct rad_pass pass[RAD_MOST_PASSES];
    struct rad_pass_spot *spot;
    uint64_t rays;

    open_room(m, "-ab 3");
    ck_assert_uint_gt(plan(m, pass), 2);
    ck_assert_int_eq(pass[0].walks, 2);
    p = rad_passes_new(&m->frame, 1, NULL);
    told = rad_passes_new(&m->frame, 1, NULL);
    late = rad_passes_new(&m->frame, 1, NULL);
    spot = calloc(pass[0].paths, 2 * sizeof *spot);
    ck_assert(p && told && late && spot);
    ck_assert_int_eq(rad_passes_begin(p, &m->w.ctx, &pass[0], NULL), 0);
    for (uint32_t i = 0, first; i < pass[0].tiles; i++) {
        rad_pass_paths(&pass[0], i, &first);
        ck_assert(rad_passes_walk(p, &m->w.ctx, &pass[0], i, &never,
                                  &spot[2 * (size_t)first]));
    }
    check_spots(spot, 2 * (size_t)pass[0].paths);
    ck_assert(rad_passes_place(told, &pass[0], spot));
    rays = m->w.ctx.counts.rays;
    ck_assert_int_eq(rad_passes_begin(p, &m->w.ctx, &pass[1], NULL), 0);
    ck_assert_int_eq(rad_passes_begin(told, &m->w.ctx, &pass[1], NULL), 0);
    ck_assert_uint_eq(m->w.ctx.counts.rays, rays);
    ck_assert_int_eq(rad_passes_begin(late, &m->w.ctx, &pass[1], NULL), 0);
    here.n = there.n = then.n = 0;
    for (uint32_t i = 0; i < pass[1].tiles; i++) {
        memset(&m->w.ctx.counts, 0, sizeof m->w.ctx.counts);
        make_tile(m, p, &pass[1], i, &here);
        rays = m->w.ctx.counts.rays;
        memset(&m->w.ctx.counts, 0, sizeof m->w.ctx.counts);
        make_tile(m, told, &pass[1], i, &there);
        ck_assert_uint_eq(m->w.ctx.counts.rays, rays);
        make_tile(m, late, &pass[1], i, &then);
    }
    ck_assert_uint_gt(here.n, 10);
    ck_assert(here.n == there.n && here.n == then.n);
    ck_assert_mem_eq(here.rec, there.rec, here.n * sizeof *here.rec);
    ck_assert_mem_eq(here.rec, then.rec, here.n * sizeof *here.rec);
    check_served(m, p, &pass[1], &here);
    free(spot);
    rad_passes_free(p);
    rad_passes_free(told);
    rad_passes_free(late);
    close_room(m);
}

static void
render(struct room *m, bool backward)
{
    for (int i = 0; i < SIDE * SIDE; i++) {
        int at = backward ? SIDE * SIDE - 1 - i : i;

        rad_frame_pixel(&m->frame, &m->w.ctx, at % SIDE, at / SIDE,
                        &m->picture[at]);
    }
}

static const struct {
    const char *options;
    int threads;
    bool backward, twice;
} ways[] = {
    { "-ab 1", THREADS, false, false },
    { "-ab 2", 1, true, false },
    { "-ab 2", THREADS, false, true },
    { "-ab 3", THREADS, true, false },
    { "-ab 2 -aw 64 -av .1 .1 .1", THREADS, true, false },
};

/* Whoever makes the tiles, in whatever order, and however often. */
LOOP_TEST(records_and_picture_are_a_function_of_the_job, N_ELEM(ways))
{
    struct room *one = &rooms[0], *other = &rooms[1];

    open_room(one, ways[_i].options);
    open_room(other, ways[_i].options);
    fill(one, 1, false, false);
    fill(other, ways[_i].threads, ways[_i].backward, ways[_i].twice);
    ck_assert_uint_gt(one->nrecs, 100);
    ck_assert_uint_eq(one->nrecs, other->nrecs);
    ck_assert_mem_eq(one->rec, other->rec, one->nrecs * sizeof *one->rec);
    render(one, false);
    render(other, true);
    ck_assert_mem_eq(one->picture, other->picture, sizeof one->picture);
    ck_assert_uint_eq(rad_ambient_count(one->w.job->ambient), one->nrecs);
    close_room(one);
    close_room(other);
}

/* Where no surface has a colour all light has the lamp's: also what is kept,
 * smoothed and interpolated, in a frozen cache and in another. */
LOOP_TEST(light_keeps_its_colour, 2)
{
    struct room *m = &rooms[0];
    char grey[sizeof scene_text];

    memcpy(grey, scene_text, sizeof grey);
    memcpy(strstr(grey, "60 60 60"), "64 32 16", 8);
    memcpy(strstr(grey, ".6 .2 .2"), ".4 .4 .4", 8);
    open_live(m, grey, "-ab 2");
    if (_i) {
        rad_ambient_freeze(m->w.job->ambient);
        fill(m, 1, false, false);
    }
    render(m, false);
    for (int i = 0; i < SIDE * SIDE; i++) {
        struct rad_rgb L = m->picture[i].L;

        ck_assert_float_gt(L.r, 0);
        ck_assert_float_eq_tol(2 * L.g, L.r, 1e-5f * L.r);
        ck_assert_float_eq_tol(4 * L.b, L.r, 1e-5f * L.r);
    }
    close_room(m);
}

/* Pixels find what they need, and few records are made for nothing; none takes
 * much room. */
TEST(passes_leave_little_to_do)
{
    struct room *m = &rooms[0], *live = &rooms[1];
    uint64_t before, rays;

    open_room(m, "-ab 2");
    fill(m, 1, false, false);
    before = m->w.ctx.counts.ambient_rays;
    render(m, false);
    rays = m->w.ctx.counts.ambient_rays - before;
    ck_assert_uint_lt(rays, 64 * m->nrecs / 10);
    ck_assert_uint_gt(rad_ambient_bytes(m->w.job->ambient), 100 * m->nrecs);
    ck_assert_uint_le(rad_ambient_bytes(m->w.job->ambient), 200 * m->nrecs);
    ck_assert_uint_eq(m->w.ctx.counts.ambient_values, 0);
    open_live(live, scene_text, "-ab 2");
    render(live, false);
    ck_assert_uint_lt(m->nrecs,
                      1.15 * (double)rad_ambient_count(live->w.job->ambient));
    close_room(live);
    close_room(m);
}

/* The second of two frames comes when the first one's passes are closed, and
 * has tiles of its own. */
TEST(passes_go_over_all_frames)
{
    static struct list list;
    struct room *m = &rooms[0];
    struct rad_frame frames[2];
    struct rad_pass_size size[2] = { { SIDE, SIDE }, { SIDE, SIDE } };
    struct rad_pass pass[RAD_MOST_PASSES];
    struct rad_view back;
    struct rad_passes *p;
    size_t made[2] = { 0, 0 };
    uint32_t n, last = 0;

    open_room(m, "-ab 2");
    frames[0] = m->frame;
    ck_assert_int_eq(
        jobtext_view("-vp 0 4.9 2.5 -vd 0 -1 0 -vh 80 -vv 80", &back, NULL), 0);
    ck_assert_int_eq(
        rad_frame_init(&frames[1], m->w.job, &back, 1, false, NULL), 0);
    n = rad_passes_plan(&m->w.job->params, size, 2, pass);
    p = rad_passes_new(frames, 2, NULL);
    for (uint32_t k = 0; k < n; k++) {
        ck_assert(pass[k].level > 0 || pass[k].frame >= last);
        last = pass[k].frame;
        ck_assert_int_eq(rad_passes_begin(p, &m->w.ctx, &pass[k], NULL), 0);
        for (uint32_t i = 0; i < pass[k].tiles; i++) {
            list.n = 0;
            make_tile(m, p, &pass[k], i, &list);
            made[pass[k].frame] += list.n;
        }
    }
    ck_assert_uint_eq(last, 1);
    ck_assert(made[0] > 0 && made[1] > 0);
    rad_passes_free(p);
    rad_frame_release(&frames[1]);
    close_room(m);
}

/* Whoever watches: the records, and what is counted, are the same; and the
 * colours are those of the picture's pixels but for what the cache yet lacks.
 */
TEST(a_tile_that_shows_its_colours_is_the_same)
{
    static struct list list, watched;
    struct room *m = &rooms[0];
    struct rad_pass pass[RAD_MOST_PASSES];
    struct rad_pass_colours colours;
    struct rad_counts first, second = { 0 };
    uint32_t n, k = 0;
    struct rad_passes *p;
    struct rad_pixel pixel;
    int near = 0;

    open_room(m, "-ab 1 -dj .5");
    n = plan(m, pass);
    p = rad_passes_new(&m->frame, 1, NULL);
    while (k < n && pass[k].step != 8)
        k++;
    pass[k].rays = 0; /* it is the first one here */
    ck_assert_int_eq(rad_passes_begin(p, &m->w.ctx, &pass[k], NULL), 0);
    list.n = watched.n = 0;
    memset(&m->w.ctx.counts, 0, sizeof m->w.ctx.counts);
    make_tile(m, p, &pass[k], 0, &list);
    first = m->w.ctx.counts;
    m->w.ctx.counts = second;
    make_shown_tile(m, p, &pass[k], 0, &watched, &colours);
    second = m->w.ctx.counts;
    ck_assert_uint_gt(list.n, 0);
    ck_assert_uint_eq(list.n, watched.n);
    ck_assert(memcmp(list.rec, watched.rec, list.n * sizeof *list.rec) == 0);
    ck_assert(first.rays == second.rays && second.primary_rays == 0 &&
              first.ambient_values == second.ambient_values &&
              first.shadow_rays == second.shadow_rays);
    ck_assert_uint_eq(colours.n, 64);
    rad_ambient_insert_all(m->w.job->ambient, list.rec, list.n);
    ck_assert(rad_ambient_settle(m->w.job->ambient));
    for (int i = 0; i < 64; i++) {
        double got = rad_rgbe_radiance(colours.rgbe[i]).g;

        rad_frame_pixel(&m->frame, &m->w.ctx, i % 8 * 8, i / 8 * 8, &pixel);
        near += fabs(got - (double)pixel.L.g) < .02 * (double)pixel.L.g;
    }
    ck_assert_int_ge(near, 52); /* others have hemispheres of their own */
    for (k = 0; k < n && rad_pass_shows(&pass[k]);)
        k++;
    ck_assert_int_eq(rad_passes_begin(p, &m->w.ctx, &pass[k], NULL), 0);
    make_shown_tile(m, p, &pass[k], 0, &list, &colours);
    ck_assert_uint_eq(colours.n, 0);
    rad_passes_free(p);
    close_room(m);
}

/* The number of the last lattice, which scattered passes follow. */
static uint32_t
last_lattice(const struct rad_pass *pass, uint32_t n)
{
    while (pass[n - 1].scattered)
        n--;
    return n - 1;
}

/* Make all tiles of a pass without a limit, and add their records to the cache;
 * returns their number. */
static size_t
make_all(struct room *m, struct rad_passes *p, struct rad_pass pass)
{
    static struct list list;

    list.n = 0;
    pass.rays = 0;
    ck_assert_int_eq(rad_passes_begin(p, &m->w.ctx, &pass, NULL), 0);
    for (uint32_t k = 0; k < pass.tiles; k++)
        make_tile(m, p, &pass, k, &list);
    rad_ambient_insert_all(m->w.job->ambient, list.rec, list.n);
    ck_assert(rad_ambient_settle(m->w.job->ambient));
    return list.n;
}

/* The squared distance between the mean places of a list's first and second
 * half, over what is expected of a random order: 1 in the mean. */
static double
unevenness(const struct list *l)
{
    size_t half = l->n / 2;
    double off = 0;

    for (int axis = 0; axis < 3; axis++) {
        double sum[2] = { 0, 0 }, sum2 = 0, mean, d;

        for (size_t i = 0; i < 2 * half; i++) {
            sum[i / half] += l->rec[i].p[axis] / (double)half;
            sum2 += l->rec[i].p[axis] * l->rec[i].p[axis] / (double)(2 * half);
        }
        mean = (sum[0] + sum[1]) / 2;
        d = sum[0] - sum[1];
        off += d * d / ((sum2 - mean * mean) * 2 / (double)half) / 3;
    }
    return off;
}

/* Else each record would be on the same side of the places that it serves. */
TEST(deep_records_are_made_in_no_order_of_places)
{
    static struct list list;
    struct room *m = &rooms[0];
    struct rad_pass pass[RAD_MOST_PASSES];
    struct rad_passes *p;
    double off = 0;

    open_room(m, "-ab 2");
    plan(m, pass);
    p = rad_passes_new(&m->frame, 1, NULL);
    ck_assert_int_eq(pass[1].level, 1);
    ck_assert_uint_ge(pass[1].tiles, 4);
    ck_assert_int_eq(rad_passes_begin(p, &m->w.ctx, &pass[1], NULL), 0);
    for (uint32_t k = 0; k < pass[1].tiles; k++) {
        list.n = 0;
        make_tile(m, p, &pass[1], k, &list);
        ck_assert_uint_gt(list.n, 15);
        off += unevenness(&list) / pass[1].tiles;
    }
    ck_assert_msg(off < 2.5, "%g", off);
    rad_passes_free(p);
    close_room(m);
}

/* It has the first of the records that it has without a limit; and what tiles
 * leave out the last passes ask for. */
TEST(a_tile_ends_when_it_has_traced_its_rays)
{
    static struct list all, list;
    struct room *m = &rooms[0];
    struct rad_pass pass[RAD_MOST_PASSES];
    struct rad_passes *p;
    uint32_t n, last;
    size_t made = 0;

    open_room(m, "-ab 1");
    n = plan(m, pass);
    last = last_lattice(pass, n);
    p = rad_passes_new(&m->frame, 1, NULL);
    for (uint32_t i = 0; i <= last; i += last) {
        all.n = list.n = 0;
        pass[i].rays = 0;
        ck_assert_int_eq(rad_passes_begin(p, &m->w.ctx, &pass[i], NULL), 0);
        make_tile(m, p, &pass[i], 0, &all);
        pass[i].rays = 64; /* of one */
        ck_assert_int_eq(rad_passes_begin(p, &m->w.ctx, &pass[i], NULL), 0);
        make_tile(m, p, &pass[i], 0, &list);
        ck_assert_uint_ge(list.n, 1);
        ck_assert_uint_gt(all.n, list.n);
        ck_assert(memcmp(all.rec, list.rec, list.n * sizeof *list.rec) == 0);
    }
    for (uint32_t i = last + 1; i < n; i++)
        made += make_all(m, p, pass[i]);
    ck_assert_uint_gt(made, 10);
    ck_assert_uint_lt(make_all(m, p, pass[last]) * 10, made);
    rad_passes_free(p);
    close_room(m);
}

/* Rays of all tiles of a lattice of which the pixels `done` apart are over. */
static uint64_t
rays_of_lattice(struct room *m, const struct rad_passes *p,
                struct rad_pass pass, int step, int done)
{
    static struct list list;
    uint64_t before = m->w.ctx.counts.rays;

    pass.step = step;
    pass.done = done;
    pass.tiles = rad_pass_tiles(&pass, SIDE, SIDE);
    list.n = 0;
    for (uint32_t k = 0; k < pass.tiles; k++)
        make_tile(m, p, &pass, k, &list);
    rad_ambient_insert_all(m->w.job->ambient, list.rec, list.n);
    ck_assert(rad_ambient_settle(m->w.job->ambient));
    return list.n > 0 ? 0 : m->w.ctx.counts.rays - before;
}

/* A lattice's pixels are looked at once, not again by the next lattice. */
TEST(a_lattice_leaves_out_the_pixels_of_the_one_before)
{
    struct room *m = &rooms[0];
    struct rad_pass pass[RAD_MOST_PASSES], any;
    struct rad_passes *p;
    uint64_t coarse, fine, both = 0;

    open_room(m, "-ab 1");
    any = pass[last_lattice(pass, plan(m, pass))];
    any.finest = false;
    any.field = -1;
    any.rays = 0;
    p = rad_passes_new(&m->frame, 1, NULL);
    ck_assert_int_eq(rad_passes_begin(p, &m->w.ctx, &any, NULL), 0);
    for (int i = 0; i < 4 && both == 0; i++)
        both = rays_of_lattice(m, p, any, 4, 0); /* no hemispheres are left */
    coarse = rays_of_lattice(m, p, any, 8, 0);
    fine = rays_of_lattice(m, p, any, 4, 8);
    ck_assert_uint_ge(coarse, (SIDE / 8) * (SIDE / 8));
    ck_assert_uint_ge(fine, 3 * (SIDE / 8) * (SIDE / 8));
    ck_assert_uint_eq(coarse + fine, both);
    rad_passes_free(p);
    close_room(m);
}

static double
brightness(const struct list *l)
{
    for (size_t i = 0; i < l->n; i++)
        if (l->rec[i].level == 0)
            return (double)rad_rgb_lum(l->rec[i].E);
    return 0;
}

/* Nor is the hemisphere at which it ends dear: deeper records that it lacks are
 * made with fewer rays, and it sees much the same. */
TEST(a_tile_that_ends_makes_coarse_deep_records)
{
    static struct list all, list;
    struct room *m = &rooms[0];
    struct rad_pass pass[RAD_MOST_PASSES], one;
    struct rad_counts *counts = &m->w.ctx.counts;
    struct rad_passes *p;
    uint64_t before, rays;

    open_room(m, "-ab 3 -ad 512");
    one = pass[last_lattice(pass, plan(m, pass))];
    one.step = SIDE;
    one.done = 0;
    one.finest = false;
    one.field = -1;
    p = rad_passes_new(&m->frame, 1, NULL);
    all.n = list.n = 0;
    one.rays = 0;
    before = counts->ambient_rays;
    ck_assert_int_eq(rad_passes_begin(p, &m->w.ctx, &one, NULL), 0);
    make_tile(m, p, &one, 0, &all);
    rays = counts->ambient_rays - before;
    one.rays = rays / 3;
    before = counts->ambient_rays;
    ck_assert_int_eq(rad_passes_begin(p, &m->w.ctx, &one, NULL), 0);
    make_tile(m, p, &one, 0, &list);
    ck_assert_uint_lt(3 * (counts->ambient_rays - before), 2 * rays);
    ck_assert_double_gt(brightness(&all), 0);
    ck_assert_double_eq_tol(brightness(&list), brightness(&all),
                            .1 * brightness(&all));
    one.rays = 1; /* then it is given up */
    list.n = 0;
    make_tile(m, p, &one, 0, &list);
    ck_assert_uint_eq(list.n, 0);
    rad_passes_free(p);
    close_room(m);
}

/* Who watches the thread from outside learns pixels of the picture, which is
 * wide here, and low. */
TEST(a_tile_tells_which_pixel_it_is_at)
{
    static struct list list;
    struct room *m = &rooms[0];
    struct rad_pass pass[RAD_MOST_PASSES];
    struct rad_passes *p;
    int right = 0;

    open_room(m, "-ab 1 -pa 0 -y 8");
    for (uint32_t k = 0, n = plan(m, pass); k < n; k++) {
        p = rad_passes_new(&m->frame, 1, NULL);
        ck_assert_int_eq(rad_passes_begin(p, &m->w.ctx, &pass[k], NULL), 0);
        for (uint32_t i = 0; i < pass[k].tiles; i++) {
            uint64_t at;

            list.n = 0;
            make_tile(m, p, &pass[k], i, &list);
            at = m->w.ctx.at;
            ck_assert_int_lt(RAD_AT_Y(at), m->frame.height);
            right = RAD_AT_X(at) > right ? RAD_AT_X(at) : right;
        }
        rad_passes_free(p);
    }
    ck_assert_int_ge(right, m->frame.width / 2);
    close_room(m);
}

TEST(a_tile_that_is_stopped_hands_on_nothing)
{
    static struct list list;
    static const _Atomic bool now = true;
    struct room *m = &rooms[0];
    struct rad_pass pass[RAD_MOST_PASSES];
    struct rad_passes *p;
    uint32_t n;

    open_room(m, "-ab 2");
    n = plan(m, pass);
    p = rad_passes_new(&m->frame, 1, NULL);
    for (uint32_t i = 0; i < n; i += n - 1) {
        ck_assert_int_eq(rad_passes_begin(p, &m->w.ctx, &pass[i], NULL), 0);
        ck_assert(!rad_passes_make(p, &m->w.ctx,
                                   &(struct rad_passes_order){ .pass = &pass[i],
                                                               .tile = 0,
                                                               .stop = &now,
                                                               .fn = keep,
                                                               .arg = &list }));
        ck_assert_uint_eq(list.n, 0);
        ck_assert(m->w.ctx.tile == NULL && !m->w.ctx.no_direct);
    }
    rad_passes_free(p);
    close_room(m);
}
