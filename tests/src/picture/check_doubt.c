/* check_doubt.c - how far a picture is off, by pixels that are made again */
#include "config.h"

#include "picture/doubt.h"

#include "base/rng.h"
#include "light/indirect/ambient.h"
#include "tests/world_picture.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

static const char scene_text[] =
    "void glow bright 0 0 4 4 4 4 0\n"
    "bright polygon window 0 0 12 -2 4.9 1 2 4.9 1 2 4.9 4 -2 4.9 4\n"
    "void light lamp 0 0 3 6e7 6e7 6e7\n"
    "lamp sphere bulb 0 0 4 2 -2 4.5 .0001\n"
    "void plastic white 0 0 5 .7 .7 .7 0 0\n"
    "void plastic shiny 0 0 5 .2 .2 .2 .05 .02\n"
    "shiny polygon floor 0 0 12 -5 -5 0 5 -5 0 5 5 0 -5 5 0\n"
    "white polygon ceiling 0 0 12 -5 -5 5 -5 5 5 5 5 5 5 -5 5\n"
    "white polygon west 0 0 12 -5 -5 0 -5 5 0 -5 5 5 -5 -5 5\n"
    "white polygon east 0 0 12 5 -5 0 5 -5 5 5 5 5 5 5 0\n"
    "white polygon north 0 0 12 -5 5 0 5 5 0 5 5 5 -5 5 5\n";

static struct picture pic;

static void
tear_down(void)
{
    picture_close(&pic);
}

FIXTURE(NULL, tear_down)

static const char view_text[] = "-vp 0 -4.9 2.5 -vd 0 1 -.3 -vh 80 -vv 80";

static void
open_of(const char *scene, const char *view, const char *options)
{
    picture_close(&pic);
    world_open(&pic.w, scene, options);
    world_frame(&pic.w, view, false, &pic.frame);
}

static void
make_of(const char *scene, const char *view, const char *options)
{
    open_of(scene, view, options);
    picture_render(&pic);
}

static void
make(const char *options)
{
    make_of(scene_text, view_text, options);
}

/* Make one of so many pixels again, by lines of n rows. */
static struct rad_doubt
look(int n, struct rad_doubt_share share)
{
    const struct rad_frame *f = &pic.frame;
    struct rad_doubt found = { { 0 } };
    const struct rad_pixel *row[8];

    for (int y = 0; y < f->height; y += n) {
        struct rad_doubt_rows r = { .frame = f,
                                    .y = y,
                                    .width = f->width,
                                    .n = f->height - y < n ? f->height - y : n,
                                    .row = row };

        for (int i = 0; i < r.n; i++)
            row[i] = pic.pixel + (size_t)(y + i) * (size_t)f->width;
        ck_assert(rad_doubt_look(&r, &pic.w.ctx, &share, NULL, &found));
    }
    return found;
}

/* Without indirect light, noise and interpolation: nothing can be off. */
#define PURE                                                                   \
    "-x 90 -y 90 -pa 1 -ab 0 -ps 1 -pj 0 -dj 0 -ds 0 -dt 0 -ss 0 -st 0 "

TEST(a_true_picture_has_no_error)
{
    static const int lines[] = { 1, 2, 3, 5, 8 };

    make(PURE);
    for (int i = 0; i < 5; i++) {
        struct rad_doubt d = look(lines[i], (struct rad_doubt_share){ .01, 0 });
        struct rad_error_estimate e = rad_doubt_error(&d);

        /* the lamp, which is tiny, has a penumbra */
        ck_assert_double_lt(e.all, 1e-4);
        /* as many areas as there are, on average */
        ck_assert_double_eq_tol(d.v[RAD_DOUBT_AREAS], 90 * 90 / 25., 120);
    }
}

/* Bulbs narrower than a pixel, before a wall that is as bright: with -z their
 * distance tells them from the wall, in the picture and when made again. */
TEST(with_distances_small_lamps_are_painted_again_as_they_were)
{
    static const char bright[] =
        "void glow same 0 0 4 2 2 2 0\n"
        "same polygon wall 0 0 12 -9 5 -9 9 5 -9 9 5 9 -9 5 9\n"
        "void light lamp 0 0 3 2 2 2\n"
        "lamp sphere bulb1 0 0 4 .03 0 .03 .02\n"
        "lamp sphere bulb2 0 0 4 1.03 0 .03 .02\n"
        "lamp sphere bulb3 0 0 4 -1.03 0 .03 .02\n"
        "lamp sphere bulb4 0 0 4 .03 0 1.03 .02\n"
        "lamp sphere bulb5 0 0 4 .03 0 -1.03 .02\n";
    const struct rad_doubt_share all = { INFINITY, 0 };
    struct rad_doubt d;

    picture_close(&pic);
    world_open(&pic.w, bright, PURE);
    world_frame(&pic.w, "-vp 0 -4 0 -vd 0 1 0 -vh 60 -vv 60", true, &pic.frame);
    picture_render(&pic);
    ck_assert_uint_gt(pic.w.ctx.counts.paint_rays, 0);
    d = look(3, all);
    ck_assert_double_lt(rad_doubt_error(&d).all, 1e-6);
}

/* All of it too bright, or a part of it that has contrast, or has none. */
static const struct {
    int x0, y0, x1, y1;
} parts[] = { { 0, 0, 90, 90 }, { 25, 10, 65, 40 }, { 0, 60, 90, 90 } };

LOOP_TEST(what_is_off_is_found, N_ELEM(parts))
{
    double share, off = log(1.2);
    struct rad_doubt d;

    make(PURE);
    for (int y = parts[_i].y0; y < parts[_i].y1; y++)
        for (int x = parts[_i].x0; x < parts[_i].x1; x++) {
            struct rad_rgb *L = &pic.pixel[y * 90 + x].L;

            *L = rad_rgb_scale(*L, 1.2f);
        }
    share = (parts[_i].x1 - parts[_i].x0) * (parts[_i].y1 - parts[_i].y0) /
            (90. * 90);
    d = look(3, (struct rad_doubt_share){ .02, 0 });
    ck_assert_double_eq_tol(rad_doubt_error(&d).all, off * sqrt(share),
                            .15 * off);
    ck_assert_double_eq(rad_doubt_error(&d).ambient, 0);
}

/* Put the picture's pixels off by .3, up or down by chance, some times; returns
 * the error that is found if so many pixels a side are one of the picture that
 * is written. */
static double
error_of_noise(int oversample, int lines)
{
    /* evenly lit: what is bright in an area has its noise alone */
    static const char wall[] = "-vp 0 0 2.5 -vd -1 0 0 -vh 45 -vv 45";
    const struct rad_doubt_share all = { INFINITY, 0 };
    struct rad_doubt sums = { { 0 } };

    for (uint64_t key = 0; key < 12; key++) {
        struct rad_doubt d;

        make_of(scene_text, wall, PURE);
        pic.frame.oversample = oversample;
        for (uint32_t i = 0; i < 90 * 90; i++) {
            struct rad_rgb *L = &pic.pixel[i].L;

            *L = rad_rgb_scale(*L, rad_rand(key, i) < .5 ? .7f : 1.3f);
        }
        d = look(lines, all);
        rad_doubt_add(&sums, &d);
    }
    return rad_doubt_error(&sums).all;
}

/* Noise averages out over the pixels of a larger area.  The areas of 8 lines
 * are whole ones, those of a single line are too short. */
TEST(noise_is_less_where_pixels_are_filtered_down)
{
    double one = error_of_noise(1, 5);

    ck_assert_double_eq_tol(one, sqrt(1.3) * .3 / 5, .008);
    ck_assert_double_eq_tol(error_of_noise(2, 8), one / 2, .1 * one);
    ck_assert_double_eq_tol(error_of_noise(3, 8), one / 3, .1 * one);
    ck_assert_double_eq_tol(error_of_noise(5, 1), one / 5, .1 * one);
}

/* The error of all areas of 10 by 10 pixels. */
static double
error_of_squares(void)
{
    const struct rad_doubt_share all = { INFINITY, 0 };
    struct rad_doubt found = { { 0 } };
    const struct rad_pixel *row[90];
    const struct rad_doubt_rows whole = { &pic.frame, 0, 0, 90, 90, row };

    for (int y = 0; y < 90; y++)
        row[y] = pic.pixel + y * 90;
    ck_assert(rad_doubt_look_at_window(&whole, &pic.w.ctx, &all, NULL, &found));
    return rad_doubt_error(&found).all;
}

/* Errors that run as far as areas do, here over blocks of 9 by 9 pixels, are
 * found in rows of few lines to be what they are in squares. */
TEST(low_rows_find_what_squares_find)
{
    static const int lines[] = { 1, 2, 4 };
    const struct rad_doubt_share all = { INFINITY, 0 };
    double squares;

    make(PURE);
    pic.frame.oversample = 2;
    for (int i = 0; i < 90 * 90; i++) {
        uint32_t block = (uint32_t)(i / 90 / 9 * 10 + i % 90 / 9);
        struct rad_rgb *L = &pic.pixel[i].L;

        *L = rad_rgb_scale(*L, rad_rand(7, block) < .5 ? .8f : 1.25f);
    }
    squares = error_of_squares();
    ck_assert_double_gt(squares, .1);
    for (int i = 0; i < 3; i++) {
        struct rad_doubt d = look(lines[i], all);

        ck_assert_double_eq_tol(rad_doubt_error(&d).all, squares, .1 * squares);
    }
}

/* An error that neighbours share does not, and fewer areas are looked at for as
 * many pixels. */
TEST(what_pixels_share_is_no_less_where_they_are_filtered_down)
{
    uint64_t rays[2];

    for (int i = 0; i < 2; i++) {
        struct rad_doubt d;

        make(PURE);
        pic.frame.oversample = i == 0 ? 1 : 3;
        for (int k = 0; k < 90 * 90; k++)
            pic.pixel[k].L = rad_rgb_scale(pic.pixel[k].L, 1.2f);
        rays[i] = pic.w.ctx.counts.primary_rays;
        d = look(3, (struct rad_doubt_share){ .02, 0 });
        rays[i] = pic.w.ctx.counts.primary_rays - rays[i];
        ck_assert_double_eq_tol(rad_doubt_error(&d).all, sqrt(1.3) * 2 / 11,
                                .01);
    }
    ck_assert_uint_gt(rays[1], rays[0] / 2);
    ck_assert_uint_lt(rays[1], rays[0] * 2);
}

/* One pixel of each 5 by 5, which is most of their light. */
TEST(what_few_pixels_are_off_by_is_found)
{
    struct rad_doubt d;

    make(PURE);
    for (int y = 2; y < 90; y += 5)
        for (int x = 3; x < 90; x += 5) {
            struct rad_rgb *L = &pic.pixel[y * 90 + x].L;

            *L = rad_rgb_scale(*L, 1000);
        }
    d = look(5, (struct rad_doubt_share){ .02, 0 });
    ck_assert_double_gt(rad_doubt_error(&d).all, .8);
    ck_assert_double_le(rad_doubt_error(&d).all, 1.2);
}

/* One pixel of one area in nine has all the error, and makes the area rough:
 * then the area is looked at.  Of even areas one in ten is. */
TEST(rough_areas_are_looked_at)
{
    struct rad_doubt d;

    make(PURE);
    for (int y = 7; y < 90; y += 15)
        for (int x = 7; x < 90; x += 15)
            pic.pixel[y * 90 + x].L = rad_grey(1e9f);
    d = look(5, (struct rad_doubt_share){ .004, 0 });
    ck_assert_double_eq_tol(d.v[RAD_DOUBT_PIXEL], 6 * 6, 1);
}

/* By chance the pixel would be missed in six of ten areas. */
TEST(a_single_pixel_is_found_where_all_are_looked_at)
{
    const struct rad_doubt_share all = { INFINITY, 0 };

    make(PURE);
    for (int i = 2; i < 90; i += 9) {
        struct rad_rgb *L = &pic.pixel[i * 90 + i].L, kept = *L;
        struct rad_doubt d;

        *L = rad_grey(1e9f);
        d = look(5, all);
        *L = kept;
        ck_assert_double_eq_tol(d.v[RAD_DOUBT_PIXEL], 1, .1);
        ck_assert_double_eq(d.v[RAD_DOUBT_AREAS], 18 * 18);
    }
}

/* Hemispheres of many rays take more of a picture's rays than areas do, and of
 * a small picture a few areas tell too little. */
TEST(areas_are_denser_where_hemispheres_take_the_rays)
{
    static const struct {
        int width; /* of the picture */
        const char *options;
        double pixels; /* for an even area */
    } row[] = { { 60, "-ab 0 -ad 512", 900 },
                { 60, "-ab 1 -aa .2 -ad 16", 400 },
                { 60, "-ab 1 -aa .2 -ad 192", 800 / 3. },
                { 60, "-ab 1 -aa .2 -ad 1024", 100 },
                { 240, "-ab 1 -aa .2 -ad 16", 720 },
                { 300, "-ab 1 -aa .2 -ad 16", 900 },
                { 960, "-ab 1 -aa .2 -ad 16", 2304 },
                { 960, "-ab 1 -aa .2 -ad 1024", 2304 },
                { 960, "-ab 0", 2304 } };

    for (unsigned i = 0; i < N_ELEM(row); i++) {
        char options[100];

        snprintf(options, sizeof options, "-x %d -y %d %s", row[i].width,
                 row[i].width, row[i].options);
        open_of(scene_text, view_text, options);
        ck_assert_double_eq_tol(rad_doubt_of_picture(&pic.frame).areas,
                                1 / row[i].pixels, 1e-12);
    }
}

/* What a row's width leaves over when areas are cut off it is no area that
 * counts as much as all others: its columns are part of the last one. */
TEST(a_narrow_rest_is_no_area_by_itself)
{
    struct rad_doubt d;

    make(PURE);
    for (int y = 0; y < 90; y++)
        for (int x = 88; x < 90; x++) {
            struct rad_rgb *L = &pic.pixel[y * 90 + x].L;

            *L = rad_rgb_scale(*L, 1.5f);
        }
    d = look(3, (struct rad_doubt_share){ .02, 0 });
    /* of 11 areas the last has 2 of 9 columns that are off */
    ck_assert_double_gt(rad_doubt_error(&d).all, .01);
    ck_assert_double_lt(rad_doubt_error(&d).all, .06);
}

/* A lamp that is smaller than a pixel is painted, with the light that it has
 * there; a ray that misses it does not say otherwise. */
TEST(painted_lamps_are_no_error)
{
    const struct rad_doubt_share all = { INFINITY, 0 };
    struct rad_doubt d;

    make_of(scene_text, "-vp 0 0 1 -vd 0 0 1 -vu 0 1 0 -vh 80 -vv 80", PURE);
    ck_assert_uint_gt(pic.w.ctx.counts.paint_rays, 0);
    d = look(5, all);
    ck_assert_double_lt(rad_doubt_error(&d).all, 1e-4);
}

/* A floor that reflects a window is too dark without it. */
TEST(gloss_that_is_left_out_shows)
{
    struct rad_doubt d;

    make(PURE "-st .1");
    d = look(3, (struct rad_doubt_share){ .02, 0 });
    ck_assert_double_gt(rad_doubt_error(&d).all, .03);
    ck_assert_double_eq(pic.w.ctx.job->params.specthresh, .1);
}

struct made_again {
    uint64_t pixels, rays; /* of hemispheres */
    double usual;          /* such rays for each pixel of the picture */
};

/* Make a picture of 30 by 30 pixels over a frozen cache without records, and
 * some of its pixels again. */
static struct made_again
make_without_records(const char *options, const char *view)
{
    const struct rad_counts *now = &pic.w.ctx.counts;
    struct made_again m;

    picture_close(&pic);
    world_open(&pic.w, scene_text, options);
    rad_ambient_freeze(pic.w.job->ambient);
    world_frame(&pic.w, view, false, &pic.frame);
    picture_render(&pic);
    m.pixels = now->primary_rays;
    m.rays = now->ambient_rays;
    m.usual = (double)m.rays / (double)m.pixels;
    look(5, (struct rad_doubt_share){ .1, 0 });
    m.pixels = now->primary_rays - m.pixels;
    m.rays = now->ambient_rays - m.rays;
    ck_assert_uint_gt(m.pixels, 100);
    return m;
}

/* No record of a frozen cache serves where gloss below -st would lead, and each
 * pixel that is made again samples the light there: by its small part in the
 * pixel, not by as many rays as for the floor itself. */
TEST(light_of_gloss_that_is_left_out_takes_few_rays)
{
    struct made_again m = make_without_records(
        PURE "-x 30 -y 30 -ab 1 -aa .3 -ad 256 -as 0 -st .1",
        "-vp 0 0 4 -vd 0 0 -1 -vu 0 1 0 -vh 80 -vv 80");

    ck_assert_uint_ge(m.rays, 64 * m.pixels); /* for the floor: -ad / 4 */
    ck_assert_uint_lt(m.rays, 70 * m.pixels);
}

/* Where the picture's own rays lead, the noise that is looked for is that of
 * the picture: a place that no record serves has as many rays as in it. */
TEST(a_pixel_that_no_record_serves_takes_as_many_rays_as_in_the_picture)
{
    struct made_again m =
        make_without_records(PURE "-x 30 -y 30 -ab 1 -aa .3 -ad 16 -as 0",
                             "-vp 0 0 1 -vd 0 0 1 -vu 0 1 0 -vh 80 -vv 80");

    ck_assert_double_eq((double)m.rays, m.usual * (double)m.pixels);
}

TEST(noise_of_hemispheres_shows)
{
    const struct rad_doubt_share share = { .002, .02 };
    double last = 1;

    /* where no record serves, or without a cache, it is the pixels' */
    static const char *const finer[] = { "-ad 8", "-ad 64", "-ad 512" };

    for (int i = 0; i < 3; i++) {
        char options[300];
        struct rad_doubt d;
        struct rad_error_estimate e;

        snprintf(options, sizeof options,
                 PURE "-x 45 -y 45 -ab 1 -aa .3 -ar 32 %s", finer[i]);
        make(options);
        d = look(3, share);
        e = rad_doubt_error(&d);
        ck_assert_double_gt(d.v[RAD_DOUBT_PLACES], 2);
        ck_assert_double_gt(e.ambient, 0);
        ck_assert_double_lt(e.ambient, .8 * last);
        ck_assert(!pic.w.ctx.fresh && pic.w.ctx.job == pic.w.job);
        last = e.ambient;
    }
}

/* A floor under a sky gets no light by deep records; its error is the same with
 * -ab 2, but what deep records may have in common is added there. */
TEST(deep_records_count_where_there_may_be_some)
{
    double square[2];

    for (int i = 0; i < 2; i++) {
        make_of("void glow g 0 0 4 1 1 1 0\n"
                "g source sky 0 0 4 1 0 1 90\n"
                "void plastic grey 0 0 5 .5 .5 .5 0 0\n"
                "grey ring floor 0 0 8 0 0 0 0 0 1 0 50\n",
                "-vp 0 0 4 -vd 0 0 -1 -vu 0 1 0 -vh 80 -vv 80",
                i == 0 ? "-x 30 -y 30 -aa .3 -ad 16 -as 0 -ab 1"
                       : "-x 30 -y 30 -aa .3 -ad 16 -as 0 -ab 2");
        square[i] =
            look(3, (struct rad_doubt_share){ 0, .3 }).v[RAD_DOUBT_AMBIENT];
    }
    ck_assert_double_ne(square[0], 0);
    ck_assert_double_eq_tol(square[1] / square[0], 1.4, 1e-9); /* DEEPER */
}

/* Where each pixel has a record of its own, areas average their noise out. */
TEST(noise_of_small_zones_averages_out_in_areas)
{
    static const char *const zones[] = { "-aa .3 -ar 32", "-aa .05 -ar 4096" };
    double square[2], said[2];

    for (int i = 0; i < 2; i++) {
        char options[300];
        struct rad_doubt d;

        snprintf(options, sizeof options, PURE "-x 45 -y 45 -ab 1 -ad 8 %s",
                 zones[i]);
        make(options);
        d = look(3, (struct rad_doubt_share){ .002, 3 });
        ck_assert_double_gt(d.v[RAD_DOUBT_PLACES], 100);
        square[i] = d.v[RAD_DOUBT_AMBIENT] / d.v[RAD_DOUBT_PLACES];
        said[i] = d.v[RAD_DOUBT_SAID] / d.v[RAD_DOUBT_PLACES];
    }
    ck_assert_double_lt(square[1], .5 * square[0]);
    /* what records say is no more than twice what is found, or so: a pixel's
     * error is off by five times that */
    ck_assert_double_lt(said[0], 3 * square[0]);
    ck_assert_double_lt(said[1], said[0] / 100);
}

/* Whatever the thread has rendered meanwhile. */
TEST(it_is_a_function_of_the_job_and_the_rows)
{
    const struct rad_doubt_share share = { .01, .003 };
    struct rad_doubt a, b;
    struct rad_pixel other;

    make(PURE "-ps 4 -pt .2 -dj .9 -pj .9 -ss 1 -ab 1 -aa .3 -ad 16");
    a = look(3, share);
    for (int i = 0; i < 9; i++)
        rad_frame_pixel(&pic.frame, &pic.w.ctx, 7 * i, 4, &other);
    b = look(3, share);
    for (int i = 0; i < RAD_DOUBT_SUMS; i++)
        ck_assert_double_eq(a.v[i], b.v[i]);
    ck_assert_double_gt(rad_doubt_error(&a).sampling, 0);
    ck_assert_double_gt(rad_doubt_error(&a).ambient, 0);
}

TEST(it_can_be_stopped)
{
    static const _Atomic bool stop = true;
    const struct rad_doubt_share share = { 1, 0 };
    const struct rad_pixel *row;
    struct rad_doubt found = { { 0 } };
    struct rad_doubt_rows r;

    make(PURE);
    row = pic.pixel;
    r = (struct rad_doubt_rows){
        .frame = &pic.frame, .width = pic.frame.width, .n = 1, .row = &row
    };
    ck_assert(!rad_doubt_look(&r, &pic.w.ctx, &share, &stop, &found));
    ck_assert_double_eq(found.v[RAD_DOUBT_AREAS], 0);
}

/* Of 64 places fresh samples count as much as what records predict, of fewer
 * less. */
TEST(fresh_samples_count_by_their_number)
{
    struct rad_doubt said = { { 0 } }, fresh = { { 0 } };

    for (int n = 16; n <= 256; n *= 4) {
        double share = n / (n + 64.);

        said.v[RAD_DOUBT_PLACES] = fresh.v[RAD_DOUBT_PLACES] = n;
        said.v[RAD_DOUBT_SAID] = n * .01;
        fresh.v[RAD_DOUBT_AMBIENT] = n * .01;
        ck_assert_double_eq_tol(rad_doubt_squares(&said).ambient,
                                (1 - share) * .01, 1e-12);
        ck_assert_double_eq_tol(rad_doubt_squares(&fresh).ambient, share * .01,
                                1e-12);
    }
}

TEST(parts_add_by_their_squares)
{
    struct rad_doubt d = { { 0 } };
    struct rad_error_estimate e = rad_doubt_error(&d);

    ck_assert(e.ambient == 0 && e.sampling == 0 && e.all == 0);
    d.v[RAD_DOUBT_AREAS] = 100;
    d.v[RAD_DOUBT_PIXEL] = 1 / 1.3; /* PIXELS */
    ck_assert_double_eq_tol(rad_doubt_error(&d).all, .1, 1e-12);
    d.v[RAD_DOUBT_PLACES] = 10;
    d.v[RAD_DOUBT_AMBIENT] = .1;
    d.v[RAD_DOUBT_SAID] = .1;
    e = rad_doubt_error(&d);
    ck_assert_double_eq_tol(e.ambient, .1, 1e-12);
    ck_assert_double_eq_tol(e.all, hypot(.1, .1), 1e-12);
    rad_doubt_add(&d, &d);
    ck_assert_double_eq_tol(rad_doubt_error(&d).all, e.all, 1e-12);
    /* by chance less than nothing */
    d.v[RAD_DOUBT_PIXEL] = -1;
    d.v[RAD_DOUBT_PIXEL2] = 4;
    ck_assert_double_gt(rad_doubt_error(&d).sampling, 0);
}

/* In a sphere of reflectance r with a small lamp in its middle each bounce
 * brings r times the light of the one before, everywhere (a series of powers):
 * of all light, the lamp's own too, r^(n + 1) is lacking after n bounces. */
LOOP_TEST(light_beyond_the_last_bounce_is_known, 6)
{
    static const double reflectance[] = { .3, .8 };
    static const int bounces[] = { 2, 3, 5 };
    double r = reflectance[_i % 2];
    int n = bounces[_i / 2];
    char scene[300], options[200];
    struct rad_doubt d;

    snprintf(scene, sizeof scene,
             "void light lamp 0 0 3 1e6 1e6 1e6\n"
             "lamp sphere bulb 0 0 4 0 0 0 .001\n"
             "void plastic wall 0 0 5 %g %g %g 0 0\n"
             "wall bubble room 0 0 4 0 0 0 5\n",
             r, r, r);
    snprintf(options, sizeof options,
             "-x 40 -y 40 -ab %d -aa .3 -ar 16 -ad 256 -as 0 -ps 1 -lw 0", n);
    make_of(scene, "-vp 0 1 0 -vd 0 1 0 -vh 60 -vv 60", options);
    d = look(5, (struct rad_doubt_share){ 0, .02 });
    ck_assert_double_gt(d.v[RAD_DOUBT_PLACES], 20);
    ck_assert_double_eq_tol(rad_doubt_left_out(&d) / pow(r, n + 1), 1, .01);
}

/* A narrow gap between metals as converters write them: these reflect more than
 * they get, by two rays each. */
LOOP_TEST(paths_among_metals_that_make_light_end, 3)
{
    static const char *const other[] = { "", "-lw 0", "-ss 64" };
    char options[200];
    uint64_t before;
    struct rad_doubt d;

    snprintf(options, sizeof options,
             "-x 30 -y 30 -ab 2 -aa .5 -ar 8 -ad 16 -as 0 -ps 1 -lr 1 %s",
             other[_i]);
    make_of("void glow dim 0 0 4 1 1 1 0\n"
            "dim sphere bulb 0 0 4 1 3 .05 .02\n"
            "void metal m 0 0 5 1.036 1.036 1.036 .75 .02\n"
            "m polygon a 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0\n"
            "m polygon b 0 0 12 0 0 .1 0 4 .1 4 4 .1 4 0 .1\n"
            "m polygon c 0 0 12 0 0 0 0 4 0 0 4 .1 0 0 .1\n"
            "m polygon d 0 0 12 4 0 0 4 0 .1 4 4 .1 4 4 0\n"
            "m polygon e 0 0 12 0 0 0 0 0 .1 4 0 .1 4 0 0\n"
            "m polygon f 0 0 12 0 4 0 4 4 0 4 4 .1 0 4 .1\n",
            "-vp 2 1 .05 -vd 0 1 0 -vh 60 -vv 60", options);
    before = pic.w.ctx.counts.rays;
    d = look(5, (struct rad_doubt_share){ 0, .02 });
    ck_assert_double_gt(d.v[RAD_DOUBT_PLACES], 10);
    ck_assert_double_lt((double)(pic.w.ctx.counts.rays - before),
                        4. * RAD_MAX_WALK * RAD_DOUBT_TRIED *
                            d.v[RAD_DOUBT_PLACES]);
}

/* Nothing is said where no record knows it, and where -av or -aw stand for what
 * is lacking. */
LOOP_TEST(light_beyond_the_last_bounce_may_be_unknown, 5)
{
    static const char *const other[] = { "-ab 1", "-aa 0 -ad 4", "-av .1 .1 .1",
                                         "-aw 32", "-ab 0" };
    char options[200];
    struct rad_doubt d;

    snprintf(options, sizeof options,
             "-x 30 -y 30 -ab 2 -aa .5 -ar 8 -ad 16 -as 0 -ps 1 -pa 1 %s",
             other[_i]);
    make(options);
    d = look(3, (struct rad_doubt_share){ 0, .02 });
    ck_assert_double_eq(rad_doubt_left_out(&d), 0);
}

static const double wild[] = { 0,   -1,    1e-300, 1,        1e99,
                               NAN, -1e99, 1e300,  INFINITY, -INFINITY };

/* Another says these sums, and statistics have no infinity. */
LOOP_TEST(an_error_is_a_number, N_ELEM(wild))
{
    for (int k = 0; k < RAD_DOUBT_SUMS; k++)
        for (int i = 0; i < (int)(sizeof wild / sizeof *wild); i++) {
            struct rad_doubt d = { { 1, 1, 1, 1, 1, 1, 1, 1 } };
            struct rad_error_estimate e;

            d.v[k] = wild[i];
            d.v[(k + 1) % RAD_DOUBT_SUMS] = wild[_i];
            e = rad_doubt_error(&d);
            ck_assert(e.ambient >= 0 && e.ambient <= 1e6);
            ck_assert(e.sampling >= 0 && e.sampling <= 1e6);
            ck_assert(e.all >= 0 && e.all <= 1e6);
            ck_assert(rad_doubt_left_out(&d) >= 0);
            ck_assert(rad_doubt_left_out(&d) <= 1);
        }
}
