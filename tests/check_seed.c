/* check_seed.c - parts of space, and the deep records that each is given */
#include "config.h"

#include "picture/parts.h"
#include "base/rng.h"
#include "machine/jobtext.h"
#include "light/indirect/ambient.h"
#include "picture/seed.h"

#include "world.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>

/* --- parts --- */

enum { POINTS = 3000, SHARES = 8 };

static void
draw_points(double (*p)[3])
{
    for (uint32_t i = 0; i < POINTS; i++)
        for (uint32_t k = 0; k < 3; k++)
            p[i][k] = rad_rand(5, 3 * i + k) * (k == 1 ? 2 : 1);
}

START_TEST(equal_shares_hold_as_many_points)
{
    static double p[POINTS][3];
    struct rad_parts *parts;
    int n[SHARES] = { 0 };

    draw_points(p);
    parts = rad_parts_new(p, POINTS);
    ck_assert(parts != NULL);
    for (int i = 0; i < POINTS; i++) {
        double place = rad_parts_place(parts, p[i]);

        ck_assert(place >= 0 && place < 1);
        /* to a leaf of 512 */
        ck_assert_double_eq_tol(place, (i + .5) / POINTS, 2. / 512);
        n[(int)(place * SHARES)]++;
    }
    for (int i = 0; i < SHARES; i++)
        ck_assert_int_le(abs(n[i] - POINTS / SHARES), 8);
    rad_parts_free(parts);
}
END_TEST

/* An eighth of a box of sides 1, 2 and 1 has sides of a half and once of one,
 * or of a half: not a slice. */
START_TEST(shares_are_compact)
{
    static double p[POINTS][3];
    double lo[SHARES][3], hi[SHARES][3];
    struct rad_parts *parts;

    draw_points(p);
    parts = rad_parts_new(p, POINTS);
    for (int i = 0; i < SHARES; i++)
        for (int k = 0; k < 3; k++) {
            lo[i][k] = INFINITY;
            hi[i][k] = -INFINITY;
        }
    for (int i = 0; i < POINTS; i++) {
        int s = (int)(rad_parts_place(parts, p[i]) * SHARES);

        for (int k = 0; k < 3; k++) {
            lo[s][k] = fmin(lo[s][k], p[i][k]);
            hi[s][k] = fmax(hi[s][k], p[i][k]);
        }
    }
    for (int s = 0; s < SHARES; s++) {
        double v = 1;

        for (int k = 0; k < 3; k++) {
            ck_assert_double_lt(hi[s][k] - lo[s][k], 1.1);
            v *= hi[s][k] - lo[s][k];
        }
        ck_assert_double_lt(v, .3);
    }
    rad_parts_free(parts);
}
END_TEST

START_TEST(points_at_one_place_and_single_ones_have_a_place)
{
    static double same[100][3];
    double one[1][3] = { { 1, 2, 3 } };
    struct rad_parts *parts = rad_parts_new(same, 100);
    double place = rad_parts_place(parts, same[0]);

    ck_assert(place >= 0 && place < 1);
    rad_parts_free(parts);
    parts = rad_parts_new(one, 1);
    ck_assert_double_eq(rad_parts_place(parts, one[0]), .5);
    rad_parts_free(parts);
}
END_TEST

/* --- the pass --- */

/* A closed room with two boxes, a lamp and a mirror, seen through a pane. */
static const char scene_text[] =
    "void light lamp 0 0 3 60 60 60\n"
    "lamp sphere bulb 0 0 4 2 2 4.5 .3\n"
    "void glass pane 0 0 3 .9 .9 .9\n"
    "pane polygon window 0 0 12 -4 -4.5 0 4 -4.5 0 4 -4.5 5 -4 -4.5 5\n"
    "void mirror silver 0 0 3 .9 .9 .9\n"
    "silver polygon glass 0 0 12 4.9 -1 1 4.9 1 1 4.9 1 3 4.9 -1 3\n"
    "void plastic white 0 0 5 .7 .7 .7 0 0\n"
    "white polygon floor 0 0 12 -5 -5 0 5 -5 0 5 5 0 -5 5 0\n"
    "white polygon ceiling 0 0 12 -5 -5 5 -5 5 5 5 5 5 5 -5 5\n"
    "white polygon west 0 0 12 -5 -5 0 -5 5 0 -5 5 5 -5 -5 5\n"
    "white polygon east 0 0 12 5 -5 0 5 -5 5 5 5 5 5 5 0\n"
    "white polygon north 0 0 12 -5 5 0 5 5 0 5 5 5 -5 5 5\n"
    "white polygon south 0 0 12 -5 -5 0 -5 -5 5 5 -5 5 5 -5 0\n"
    "void plastic red 0 0 5 .6 .2 .2 .02 .05\n"
    "red sphere ball 0 0 4 -2 1 1 1\n"
    "red sphere other 0 0 4 1 -1 .7 .7\n";

#define OPTIONS "-x 48 -y 48 -ar 16 -aa .25 -ad 64 -as 0 -lw 0 -lr 8 -ps 1 "

struct room {
    struct world w;
    struct rad_frame frame;
};

static void
open_room(struct room *m, const char *options)
{
    struct rad_error err = { 0 };
    struct rad_view view;
    char text[200];

    snprintf(text, sizeof text, OPTIONS "%s", options);
    world_open(&m->w, scene_text, text);
    ck_assert_int_eq(
        jobtext_view("-vp 0 -4.9 2.5 -vd 0 1 0 -vh 80 -vv 80", &view, &err), 0);
    ck_assert_int_eq(rad_frame_init(&m->frame, m->w.job, &view, 0, false, &err),
                     0);
}

static void
close_room(struct room *m)
{
    rad_frame_release(&m->frame);
    world_close(&m->w);
}

/* Make the part from `first` up to `last`. */
static void
seed(struct room *m, double first, double last)
{
    _Atomic bool stop = false;
    struct rad_seed *s = rad_seed_new(&m->frame, 1, first, last, NULL);

    ck_assert(s != NULL);
    do
        while (rad_seed_open(s))
            rad_seed_work(s, &m->w.ctx, &stop);
    while (rad_seed_next(s));
    rad_seed_free(s);
}

enum { MOST = 20000 };

static size_t
list(const struct room *m, struct rad_ambrec *rec)
{
    uint64_t cursor = 0;

    return rad_ambient_list(m->w.job->ambient, &cursor, rec, MOST);
}

static const struct {
    const char *options;
    bool wanted;
} kinds[] = {
    { "-ab 0", false }, { "-ab 1", false },       { "-ab 2", true },
    { "-ab 3", true },  { "-ab 2 -aa 0", false }, { "-ab 2 -ad 0", false },
};

START_TEST(there_are_deep_records_from_two_bounces_on)
{
    struct room m;

    open_room(&m, kinds[_i].options);
    m.frame.width = 256;
    m.frame.height = 128;
    ck_assert_int_eq(rad_seed_wanted(&m.frame, 1), kinds[_i].wanted);
    m.frame.height--; /* of a small picture only some of them are needed */
    ck_assert(!rad_seed_wanted(&m.frame, 1));
    close_room(&m);
}
END_TEST

START_TEST(its_rays_are_ambient_and_no_pixels)
{
    struct room m;

    open_room(&m, "-ab 2");
    seed(&m, 0, 1);
    ck_assert_uint_gt(m.w.ctx.counts.ambient_values, 50);
    ck_assert_uint_eq(m.w.ctx.counts.ambient_values,
                      rad_ambient_count(m.w.job->ambient));
    ck_assert_uint_eq(m.w.ctx.counts.primary_rays, 0);
    /* each record is of 25 rays at least, in a hemisphere */
    ck_assert_uint_gt(m.w.ctx.counts.ambient_rays,
                      25 * m.w.ctx.counts.ambient_values);
    ck_assert_uint_gt(m.w.ctx.counts.rays, m.w.ctx.counts.ambient_rays);
    close_room(&m);
}
END_TEST

static const char *const depths[] = { "-ab 2", "-ab 3", "-ab 4" };

/* Deep records that pixels still have to make, and those made before, with all
 * levels among them. */
START_TEST(what_it_makes_serves)
{
    static struct rad_ambrec rec[MOST];
    uint64_t made[2];

    for (int with = 0; with < 2; with++) {
        struct rad_pixel p;
        size_t n = 0, deep = 0;
        struct room m;
        int levels = 0;

        open_room(&m, depths[_i]);
        if (with) {
            seed(&m, 0, 1);
            n = list(&m, rec);
        }
        for (size_t i = 0; i < n; i++) {
            ck_assert_uint_ge(rec[i].level, 1);
            levels |= 1 << rec[i].level;
        }
        if (with)
            ck_assert_int_eq(levels, (2 << (_i + 1)) - 2);
        for (int y = 0; y < 48; y += 2)
            for (int x = 0; x < 48; x += 2)
                rad_frame_pixel(&m.frame, &m.w.ctx, x, y, &p);
        for (size_t all = list(&m, rec); n < all; n++)
            deep += rec[n].level > 0;
        made[with] = deep;
        close_room(&m);
    }
    ck_assert_uint_gt(made[0], 50);
    ck_assert_uint_lt(made[1], made[0] / 3);
}
END_TEST

/* Records of the room that the other one's cache would serve. */
static size_t
doubled(const struct room *of, const struct room *other)
{
    static struct rad_ambrec rec[MOST];
    size_t n = list(of, rec), twice = 0;

    for (size_t i = 0; i < n; i++)
        twice += rad_ambient_covers(other->w.job->ambient, &rec[i]);
    return twice;
}

START_TEST(parts_are_apart_and_together_all)
{
    struct room left, right, all;
    size_t n;

    open_room(&left, "-ab 2");
    open_room(&right, "-ab 2");
    open_room(&all, "-ab 2");
    seed(&left, 0, .4);
    seed(&right, .4, 1);
    seed(&all, 0, 1);
    n = rad_ambient_count(left.w.job->ambient) +
        rad_ambient_count(right.w.job->ambient);
    ck_assert_uint_gt(rad_ambient_count(left.w.job->ambient), n / 5);
    ck_assert_uint_gt(rad_ambient_count(right.w.job->ambient), n / 5);
    ck_assert_uint_lt(doubled(&left, &right), n / 5);
    ck_assert_uint_lt(doubled(&right, &left), n / 5);
    /* and what all make is about what both do */
    ck_assert_uint_gt(doubled(&left, &all) + doubled(&right, &all), n * 8 / 10);
    ck_assert_uint_gt(rad_ambient_count(all.w.job->ambient), n * 8 / 10);
    ck_assert_uint_lt(rad_ambient_count(all.w.job->ambient), n * 12 / 10);
    close_room(&left);
    close_room(&right);
    close_room(&all);
}
END_TEST

START_TEST(the_same_part_is_the_same_records)
{
    static struct rad_ambrec a[MOST], b[MOST];
    struct room m;
    size_t n;

    open_room(&m, "-ab 3");
    seed(&m, .25, .5);
    n = list(&m, a);
    close_room(&m);
    open_room(&m, "-ab 3");
    seed(&m, .25, .5);
    ck_assert_uint_eq(list(&m, b), n);
    for (size_t i = 0; i < n; i++) {
        ck_assert_mem_eq(a[i].p, b[i].p, sizeof a[i].p);
        ck_assert_mem_eq(&a[i].E, &b[i].E, sizeof a[i].E);
    }
    close_room(&m);
}
END_TEST

/* A worker that is a thousand times slower than all. */
START_TEST(a_part_of_nothing_is_over)
{
    struct room m;

    open_room(&m, "-ab 2");
    seed(&m, .50001, .50002);
    ck_assert_uint_eq(rad_ambient_count(m.w.job->ambient), 0);
    close_room(&m);
}
END_TEST

START_TEST(it_stops_when_it_is_told_to)
{
    _Atomic bool stop = true;
    struct rad_seed *s;
    struct room m;

    open_room(&m, "-ab 2");
    s = rad_seed_new(&m.frame, 1, 0, 1, NULL);
    ck_assert(rad_seed_open(s));
    rad_seed_work(s, &m.w.ctx, &stop);
    ck_assert_uint_eq(m.w.ctx.counts.rays, 0);
    rad_seed_free(s);
    close_room(&m);
}
END_TEST

/* A pattern that never ends is found by the pixel that its thread is at. */
START_TEST(who_watches_sees_where_it_is)
{
    _Atomic bool stop = false;
    struct rad_seed *s;
    struct room m;
    uint64_t at;

    open_room(&m, "-ab 2");
    s = rad_seed_new(&m.frame, 1, 0, 1, NULL);
    rad_seed_work(s, &m.w.ctx, &stop);
    at = atomic_load(&m.w.ctx.at);
    ck_assert_uint_ne(at, 0);
    ck_assert_int_lt(RAD_AT_X(at), 48);
    ck_assert_int_lt(RAD_AT_Y(at), 48);
    rad_seed_free(s);
    close_room(&m);
}
END_TEST

/* Nothing is seen, so nothing can be done. */
START_TEST(without_anything_in_view_it_is_over)
{
    _Atomic bool stop = false;
    struct rad_error err = { 0 };
    struct rad_frame away;
    struct rad_view view;
    struct rad_seed *s;
    struct room m;

    open_room(&m, "-ab 2");
    ck_assert_int_eq(jobtext_view("-vp 0 -50 2 -vd 0 -1 0", &view, &err), 0);
    ck_assert_int_eq(rad_frame_init(&away, m.w.job, &view, 0, false, &err), 0);
    s = rad_seed_new(&away, 1, 0, 1, NULL);
    while (rad_seed_open(s))
        rad_seed_work(s, &m.w.ctx, &stop);
    ck_assert(!rad_seed_next(s));
    ck_assert_uint_eq(rad_ambient_count(m.w.job->ambient), 0);
    rad_seed_free(s);
    rad_frame_release(&away);
    close_room(&m);
}
END_TEST

int
main(void)
{
    Suite *s = suite_create("seed");
    TCase *tc = tcase_create("parts");

    tcase_add_test(tc, equal_shares_hold_as_many_points);
    tcase_add_test(tc, shares_are_compact);
    tcase_add_test(tc, points_at_one_place_and_single_ones_have_a_place);
    suite_add_tcase(s, tc);
    tc = tcase_create("pass");
    tcase_set_timeout(tc, 60); /* on a busy machine */
    tcase_add_loop_test(tc, there_are_deep_records_from_two_bounces_on, 0,
                        N_ELEM(kinds));
    tcase_add_test(tc, its_rays_are_ambient_and_no_pixels);
    tcase_add_loop_test(tc, what_it_makes_serves, 0, N_ELEM(depths));
    tcase_add_test(tc, parts_are_apart_and_together_all);
    tcase_add_test(tc, the_same_part_is_the_same_records);
    tcase_add_test(tc, a_part_of_nothing_is_over);
    tcase_add_test(tc, it_stops_when_it_is_told_to);
    tcase_add_test(tc, who_watches_sees_where_it_is);
    tcase_add_test(tc, without_anything_in_view_it_is_over);
    suite_add_tcase(s, tc);
    return unit_run(s);
}
