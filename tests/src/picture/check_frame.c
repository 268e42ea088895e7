/* check_frame.c - pixels, windows, depth and painted sources of small scenes */
#include "config.h"

#include "picture/frame.h"
#include "base/rng.h"
#include "tests/world_picture.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static struct picture pic;

static void
tear_down(void)
{
    picture_close(&pic);
}

FIXTURE(NULL, tear_down)

static void
show_in(struct picture *at, const char *scene, struct rad_params p,
        const char *view, bool depth)
{
    picture_close(at);
    at->w.params = p;
    ck_assert_msg(world_build(&at->w, scene, NULL) == 0, "%s", at->w.err.what);
    world_frame(&at->w, view, depth, &at->frame);
}

static void
show(const char *scene, struct rad_params p, const char *view, bool depth)
{
    show_in(&pic, scene, p, view, depth);
}

static struct rad_params
params(int size, int psample)
{
    struct rad_params p;

    rad_params_init(&p);
    p.xres = p.yres = size;
    p.psample = psample;
    p.shadthresh = 0;
    return p;
}

static void
render(struct rad_pixel *pixel, struct rad_window part)
{
    world_render(&pic.w, &pic.frame, part, pixel);
}

/* A lamp overhead and a ball before a wall; a lamp too small to be met. */
static const char room[] =
    "void plastic grey 0 0 5 .5 .5 .5 0 0 void light lamp 0 0 3 9 9 9\n"
    "void light dot 0 0 3 4000 4000 4000\n"
    "grey polygon wall 0 0 12 -9 5 -9 9 5 -9 9 5 9 -9 5 9\n"
    "grey sphere ball 0 0 4 .4 4 -.2 .5\n"
    "lamp polygon l 0 0 12 -1 3 3 -1 4 3 1 4 3 1 3 3\n"
    "dot sphere d 0 0 4 -.61 4.01 .33 .003\n";
static const char ahead[] = "-vp 0 0 0 -vd 0 1 0 -vu 0 0 1 -vh 40 -vv 40";

TEST(windows_make_the_whole_with_every_pixel_traced)
{
    struct rad_pixel *whole, *parts;
    struct rad_counts first;

    show(room, params(48, 1), ahead, true);
    ck_assert_int_eq(pic.frame.paint.n, 1);
    whole = picture_render(&pic);
    first = pic.w.ctx.counts;
    ck_assert_uint_eq(first.primary_rays, 48 * 48);
    ck_assert_uint_gt(first.paint_rays, 0);
    parts = calloc(48 * 48, sizeof *parts);
    for (int i = 11; i >= 0; i--) { /* 3 by 4 windows, the last one first */
        struct rad_window w = { i % 3 * 16, i / 3 * 12, 16, 12 };

        render(parts, w);
    }
    ck_assert_mem_eq(whole, parts, 48 * 48 * sizeof *whole);
    ck_assert_uint_eq(pic.w.ctx.counts.primary_rays, 2 * first.primary_rays);
    ck_assert_uint_eq(pic.w.ctx.counts.paint_rays, 2 * first.paint_rays);
    ck_assert_uint_eq(pic.w.ctx.counts.nan_pixels, 0);
    free(parts);
}

/* What it sends is infinite; its edges lie between the centres of pixels. */
static const char hot[] =
    "void glow hot 0 0 4 1e39 1 1 0\n"
    "hot polygon p 0 0 12 .11 .51 0 .39 .51 0 .39 .69 0 .11 .69 0\n";

TEST(pixels_that_are_no_numbers_are_black_and_the_first_is_kept)
{
    struct rad_params p = params(10, 1);
    struct rad_pixel *whole;

    p.pixjitter = 0;
    show(hot, p, "-vtl -vp .5 .5 1 -vd 0 0 -1 -vu 0 1 0 -vh 1 -vv 1", false);
    whole = picture_render(&pic);
    ck_assert_uint_eq(pic.w.ctx.counts.nan_pixels, 6);
    ck_assert_int_eq(pic.w.ctx.counts.nan_x, 1);
    ck_assert_int_eq(pic.w.ctx.counts.nan_y, 3);
    for (int i = 0; i < 100; i++)
        ck_assert(whole[i].L.r == 0 && whole[i].L.g == 0 && whole[i].L.b == 0);
}

/* No sample meets it, and what is painted for it is infinite. */
TEST(painted_sources_that_are_no_numbers_count_too)
{
    static const char dot[] = "void light hot 0 0 3 1e39 1 1\n"
                              "hot sphere p 0 0 4 .22 .52 0 .001\n";
    struct rad_params p = params(10, 1);

    p.pixjitter = 0;
    show(dot, p, "-vtl -vp .5 .5 1 -vd 0 0 -1 -vu 0 1 0 -vh 1 -vv 1", false);
    picture_render(&pic);
    ck_assert_uint_eq(pic.w.ctx.counts.nan_pixels, 1);
    ck_assert_int_eq(pic.w.ctx.counts.nan_x, 2);
    ck_assert_int_eq(pic.w.ctx.counts.nan_y, 4);
}

TEST(sampled_windows_repeat_themselves_in_any_order)
{
    static const struct rad_window w[] = { { 0, 0, 31, 17 },
                                           { 31, 0, 17, 48 },
                                           { 0, 17, 31, 31 } };
    struct rad_pixel *a, *b;
    uint64_t n;

    show(room, params(48, 4), ahead, false);
    a = calloc(48 * 48, sizeof *a);
    b = calloc(48 * 48, sizeof *b);
    for (int i = 0; i < 3; i++)
        render(a, w[i]);
    n = pic.w.ctx.counts.primary_rays;
    ck_assert_uint_lt(n, 48 * 48);
    for (int i = 2; i >= 0; i--)
        render(b, w[i]);
    ck_assert_mem_eq(a, b, 48 * 48 * sizeof *a);
    ck_assert_uint_eq(pic.w.ctx.counts.primary_rays, 2 * n);
    free(a);
    free(b);
}

/* A thread sets rays up before it is asked for their pixels.  What it has of
 * one frame must not be taken for another's that lies where that lay. */
TEST(a_frame_in_anothers_place_has_rays_of_its_own)
{
    static const char *const views[] = {
        "-vp 0 0 0 -vd .3 1 0 -vu 0 0 1 -vh 40 -vv 40",
        "-vp .2 0 0 -vd 0 1 0 -vu 0 0 1 -vh 50 -vv 50 -vo .1 -va 30",
    };
    struct picture fresh = { 0 };
    struct rad_pixel got, want;

    show(room, params(48, 1), ahead, true);
    for (int i = 0; i < 2; i++) {
        for (int x = 10; x < 20; x += 3)
            rad_frame_pixel(&pic.frame, &pic.w.ctx, x, 20, &got);
        rad_frame_release(&pic.frame);
        world_frame(&pic.w, views[i], true, &pic.frame);
        show_in(&fresh, room, params(48, 1), views[i], true);
        for (int x = 22; x < 30; x++) {
            rad_frame_pixel(&pic.frame, &pic.w.ctx, x, 20, &got);
            rad_frame_pixel(&fresh.frame, &fresh.w.ctx, x, 20, &want);
            ck_assert_mem_eq(&got, &want, sizeof got);
        }
        picture_close(&fresh);
    }
}

/* Of two pictures with other random numbers; *mean of the first. */
static double
noise_of(int samples, double *mean)
{
    struct rad_pixel *picture[2];
    double sum = 0;

    *mean = 0;
    for (int k = 0; k < 2; k++) {
        struct rad_params p = params(32, 1);

        p.samples = samples;
        p.pixjitter = p.srcjitter = 1;
        p.seed = (uint64_t)k;
        show(room, p, ahead, false);
        picture[k] = picture_render(&pic);
        pic.pixel = NULL;
        ck_assert_uint_eq(pic.w.ctx.counts.primary_rays, 32 * 32);
    }
    for (int i = 0; i < 32 * 32; i++) {
        double d = (double)(picture[0][i].L.g - picture[1][i].L.g);

        sum += d * d;
        *mean += (double)picture[0][i].L.g;
    }
    free(picture[0]);
    free(picture[1]);
    return sqrt(sum);
}

TEST(a_pixel_is_the_mean_of_its_samples)
{
    double one, many, noise = noise_of(1, &one), left = noise_of(16, &many);

    ck_assert_double_gt(left, 0);
    ck_assert_double_lt(left, noise / 3);
    ck_assert_double_eq_tol(many, one, .03 * one);
}

TEST(seed_and_frame_move_the_jitter)
{
    struct rad_params p = params(16, 1);
    struct rad_pixel *seen[3];

    for (int i = 0; i < 3; i++) {
        p.seed = i == 1;
        show(room, p, ahead, true);
        pic.frame.key = rad_key_frame(p.seed, i == 2);
        seen[i] = picture_render(&pic);
        pic.pixel = NULL;
    }
    ck_assert_mem_ne(seen[0], seen[1], 256 * sizeof *seen[0]);
    ck_assert_mem_ne(seen[0], seen[2], 256 * sizeof *seen[0]);
    for (int i = 0; i < 3; i++)
        free(seen[i]);
}

/* The mean of many jittered pixels is that of their middles, both ways. */
TEST(jitter_is_even_about_the_middle)
{
    static const char wall[] =
        "void colorfunc f 4 99+Px 99+Pz 1 . 0 0\nf glow g 0 0 4 1 1 1 0\n"
        "g polygon p 0 0 12 -99 8 -99 99 8 -99 99 8 99 -99 8 99\n";
    struct rad_params p = params(64, 1);
    struct rad_pixel *seen;
    double sum[2] = { 0 };

    p.pixjitter = 1;
    show(wall, p, "-vtl -vp 0 0 0 -vd 0 1 0 -vu 0 0 1 -vh 64 -vv 64", false);
    seen = picture_render(&pic);
    for (int i = 0; i < 64 * 64; i++) {
        sum[0] += ((double)seen[i].L.r - 99) / (64 * 64);
        sum[1] += ((double)seen[i].L.g - 99) / (64 * 64);
    }
    ck_assert_double_eq_tol(sum[0], 0, .02); /* of a pixel */
    ck_assert_double_eq_tol(sum[1], 0, .02);
}

/* A near wall on the left, before a far one. */
static const struct {
    const char *clip;
    float left, right;
} clipped[] = {
    { "", 2, 1 },
    { "-va 5", 2, 0 },
    { "-vo 5", 1, 1 },
    { "-vo 5 -va 6", 0, 0 },
    { "-vo 5 -va 9", 1, 1 },
};

LOOP_TEST(what_lies_before_and_beyond_the_planes_is_not_seen, N_ELEM(clipped))
{
    static const char walls[] =
        "void glow near 0 0 4 2 2 2 0\nvoid glow far 0 0 4 1 1 1 0\n"
        "near polygon p 0 0 12 -9 3 -9 0 3 -9 0 3 9 -9 3 9\n"
        "far polygon q 0 0 12 -9 8 -9 9 8 -9 9 8 9 -9 8 9\n";

    for (int flat = 0; flat < 2; flat++) {
        struct rad_pixel *seen;
        char view[128];

        snprintf(view, sizeof view, "%s -vp 0 0 0 -vd 0 1 0 -vu 0 0 1 %s",
                 flat ? "-vtl -vh 2 -vv 2" : "-vtv -vh 60 -vv 60",
                 clipped[_i].clip);
        show(walls, params(16, 1), view, false);
        seen = picture_render(&pic);
        for (int i = 0; i < 16 * 16; i++)
            ck_assert_float_eq(seen[i].L.g, i % 16 < 8 ? clipped[_i].left
                                                       : clipped[_i].right);
    }
}

/* The edge of a half plane that glows, at twice the focal distance, seen
 * through a lens of diameter 1: the share of the lens that sees it. */
TEST(what_is_out_of_focus_blurs_by_the_lens)
{
    static const char half[] = "void glow g 0 0 4 1 1 1 0\n"
                               "g polygon p 0 0 12 0 8 -50 50 8 -50 50 8 50 0 "
                               "8 50\n";
    struct rad_params p = params(64, 1);
    struct rad_pixel *seen;
    double sum[64] = { 0 };

    p.pixjitter = 0;
    p.aperture = 1;
    show(half, p, "-vtv -vd 0 4 0 -vh 90 -vv 90", false);
    seen = picture_render(&pic);
    for (int i = 0; i < 64 * 64; i++)
        sum[i % 64] += seen[i].L.r / 64;
    for (int x = 0; x < 64; x++) {
        /* from lens position u the way by focus (4 h, 4) meets 8 h - u */
        double h = 2 * (x + .5) / 64 - 1, u = fmax(-.5, fmin(.5, 8 * h));
        double share =
            .5 + (u * sqrt(.25 - u * u) + asin(2 * u) / 4) * 4 / M_PI;

        ck_assert_double_eq_tol(sum[x], share, .2);
        if (fabs(u) == .5)
            ck_assert_double_eq(sum[x], share);
    }
}

/* The same half plane, from a view that moves across: one frame before, the
 * edge was a quarter of the picture to the left, so with half the shutter open
 * it smears an eighth to both sides together. */
TEST(motion_blurs_between_the_views)
{
    static const char half[] = "void glow g 0 0 4 1 1 1 0\n"
                               "g polygon p 0 0 12 0 8 -50 50 8 -50 50 8 50 0 "
                               "8 50\n";
    struct rad_params p = params(64, 1);
    struct rad_view before;
    struct rad_pixel *seen;
    double sum[64] = { 0 };
    char line[] = "-vtl -vp 4 0 0 -vh 16 -vv 16";

    p.pixjitter = 0;
    p.motion = .5;
    show(half, p, "-vtl -vh 16 -vv 16", false);
    ck_assert_int_eq(jobtext_view(line, &before, NULL), 0);
    ck_assert_int_eq(rad_frame_move(&pic.frame, &before, NULL), 0);
    seen = picture_render(&pic);
    for (int i = 0; i < 64 * 64; i++)
        sum[i % 64] += seen[i].L.r / 64;
    for (int x = 0; x < 64; x++) {
        double at = (x + .5 - 32) / 64 * 16; /* of the pixel in the world */
        double share = fmax(0, fmin(1, .5 + at / 2));

        ck_assert_double_eq_tol(sum[x], share,
                                share > 0 && share < 1 ? .2 : 1e-12);
    }
}

/* A glowing square in the upper left quarter, seen without perspective; the
 * edge of each pixel's jitter stays within the pixel. */
TEST(rows_count_from_the_top_and_jitter_stays_inside)
{
    static const char square[] =
        "void glow g 0 0 4 1 1 1 -1\n"
        "g polygon q 0 0 12 -1 2 0 0 2 0 0 2 1 -1 2 1\n";
    struct rad_params p = params(10, 1);
    struct rad_pixel *picture;

    p.pixjitter = 1;
    show(square, p, "-vtl -vp 0 0 0 -vd 0 1 0 -vu 0 0 1 -vh 2 -vv 2", true);
    picture = picture_render(&pic);
    for (int y = 0; y < 10; y++)
        for (int x = 0; x < 10; x++) {
            bool lit = x < 5 && y < 5;

            ck_assert_float_eq(picture[10 * y + x].L.g, lit);
            ck_assert_float_eq_tol(picture[10 * y + x].z, lit ? 2 : 1e10f,
                                   lit ? 1e-6f : 1);
        }
}

/* One lamp, smaller than a pixel, between the centres of pixels: what it sends
 * is what its area says, spread over the pixels that it covers. */
TEST(small_lamps_are_painted_with_their_area)
{
    static const char lamp[] =
        "void light l 0 0 3 100 50 25\n"
        "l polygon q 0 0 12 -.004 1 -.003 .006 1 -.003 .006 1 .005 "
        "-.004 1 .005\n";
    double area = .01 * .008; /* of the picture's 2 by 2 */
    struct rad_params p = params(20, 4);
    double sum[3] = { 0 };

    for (int visible = 0; visible < 2; visible++) {
        struct rad_pixel *picture;

        p.directvis = visible;
        p.pixjitter = 0;
        show(lamp, p, "-vh 90 -vv 90", false);
        ck_assert_int_eq(pic.frame.paint.n, visible);
        picture = picture_render(&pic);
        sum[0] = sum[1] = sum[2] = 0;
        for (int i = 0; i < 400; i++) {
            sum[0] += picture[i].L.r;
            sum[1] += picture[i].L.g;
            sum[2] += picture[i].L.b;
        }
        if (!visible)
            ck_assert_double_eq(sum[0] + sum[1] + sum[2], 0);
        /* about the picture's centre: four pixels share it */
        ck_assert_uint_eq(pic.w.ctx.counts.paint_rays, visible ? 4 : 0);
    }
    ck_assert_double_eq_tol(sum[0], 100 * area / 4 * 400, 1e-4);
    ck_assert_double_eq_tol(sum[2], 25 * area / 4 * 400, 1e-4);
}

/* Balls, disks, tubes and polygons as large as rpict's, which takes them for
 * boxes and squares: how many pixels of 20 by 20, .1 wide in the parallel
 * views, they fill, and those .8 of it that mirrors show of lamps behind the
 * eye, one of them none to the eye.  What is more than a sample wide is met or
 * missed. */
#define ALONG  "-vtl -vh 2 -vv 2"
#define AROUND "-vtv -vh 90 -vv 90"
#define BEFORE "m polygon f 0 0 12 -9 5 -9 9 5 -9 9 5 9 -9 5 9\n"

static const struct {
    const char *lamp, *view;
    int psample;
    double filled; /* rpict's */
} thin[] = {
    { "l sphere s 0 0 4 .013 1 .021 .04", ALONG, 4, .33496 },
    { "l sphere s 0 0 4 -.05 9 -.06 .04", ALONG, 4, .33625 },
    { "l sphere s 0 0 4 .813 1 .721 .04", AROUND, 4, .84937 },
    { "l ring r 0 0 8 .013 1 .021 0 -1 0 0 .04", ALONG, 4, .50227 },
    { "l ring r 0 0 8 .013 1 .021 .6 -.8 0 0 .04", ALONG, 4, .4018 },
    { "l cylinder c 0 0 7 -.3 1 -.2 .3 1.7 .3 .02", ALONG, 4, 3.61715 },
    { "l cylinder c 0 0 7 -.3 1 0 .3 1 0 .02", ALONG, 4, 2.0475 },
    { "l cylinder c 0 0 7 0 1 0 0 2 0 .02", ALONG, 4, 0 },
    { "l polygon p 0 0 9 -.02 1 -.03 .05 1 -.03 .05 1 .04", ALONG, 4, .10867 },
    { "l polygon p 0 0 9 .05 1 -.03 .05 1 .04 -.02 1 -.03", ALONG, 4, .10867 },
    { "l polygon p 0 0 9 .05 1 .04 -.02 1 -.03 .05 1 -.03", ALONG, 4, .10867 },
    { "l polygon p 0 0 12 -.02 1 -.03 .05 1 -.04 .06 1 .04 -.03 1 .02", ALONG,
      4, .34031 },
    { "l polygon p 0 0 15 -.02 1 -.03 .05 1 -.04 .06 1 .04 .02 1 .06 -.03 1 "
      ".02",
      ALONG, 4, .64953 },
    { BEFORE "l sphere s 0 0 4 .013 -1 .021 .04", ALONG, 4, .26848 },
    { BEFORE "l ring r 0 0 8 .013 -1 .021 0 1 0 0 .04", ALONG, 4, .40305 },
    { BEFORE "l ring r 0 0 8 .013 -1 .021 0 -1 0 0 .04", ALONG, 4, 0 },
    { "m polygon f 0 0 12 -9 14 -9 9 -4 -9 9 -4 9 -9 14 9\n" /* y = 5 - x */
      "l cylinder c 0 0 7 -2 5.3 -.2 -2.7 4.7 .3 .02",
      ALONG, 4, 2.89516 },
    { BEFORE "l sphere s 0 0 4 .13 -5 .21 .08", AROUND, 4, .00487 },
    { BEFORE "l source s 0 0 4 0 -1 .001 .9", AROUND, 4, .01547 },
    { "void mirror h 1 void 0 3 .8 .8 .8\n"
      "h polygon f 0 0 12 -9 5 -9 9 5 -9 9 5 9 -9 5 9\n"
      "l sphere s 0 0 4 .013 -1 .021 .04",
      ALONG, 4, .26848 },
    { "l sphere s 0 0 4 .02 1 .01 .07", ALONG, 1, 2 },
    { "l sphere s 0 0 4 0 1 0 .06", ALONG, 1, .7525 },
    { "l sphere s 0 0 4 0 1 0 .08", ALONG, 1, 4 },
    { "l ring r 0 0 8 0 1 0 0 -1 0 0 .06", ALONG, 1, 0 },
};

LOOP_TEST(thin_lamps_are_painted_as_large_as_rpict_does, N_ELEM(thin))
{
    struct rad_params p = params(20, thin[_i].psample);
    struct rad_pixel *picture;
    char scene[512], view[128];
    double sum = 0;

    p.directvis = true;
    p.pixjitter = 0;
    p.directrelay = 1;
    snprintf(scene, sizeof scene,
             "void light l 0 0 3 100 100 100 void mirror m 0 0 3 .8 .8 .8\n"
             "%s\n",
             thin[_i].lamp);
    snprintf(view, sizeof view, "-vp 0 0 0 -vd 0 1 0 -vu 0 0 1 %s",
             thin[_i].view);
    show(scene, p, view, false);
    picture = picture_render(&pic);
    for (int i = 0; i < 400; i++)
        sum += picture[i].L.r / 100;
    /* rpict's pictures have 8 bits */
    ck_assert_double_eq_tol(sum, thin[_i].filled,
                            .005 * thin[_i].filled + 1e-9);
}

/* A ball whose edge is far behind its middle: a pixel that has met it there is
 * all lamp where depth is known, as in rpict. */
TEST(lamps_before_what_a_sample_met_are_added)
{
    static const double filled[] = { .20672, .47547 }; /* rpict's */
    struct rad_params p = params(16, 1);

    p.directvis = true;
    p.pixjitter = 0;
    for (int depth = 0; depth < 2; depth++) {
        struct rad_pixel *picture;
        double sum = 0;

        show("void light l 0 0 3 20 20 20\nl sphere b 0 0 4 0 0 2.5 .2\n", p,
             "-vp 0 -6 1 -vd 0 1 .1 -vh 45 -vv 45", depth);
        picture = picture_render(&pic);
        for (int i = 0; i < 256; i++)
            sum += picture[i].L.r / 100;
        ck_assert_double_eq_tol(sum, filled[depth], .005 * filled[depth]);
    }
}

TEST(wide_lamps_and_illums_are_not_painted)
{
    static const char lamps[] =
        "void light l 0 0 3 1 1 1 void illum i 0 0 3 1 1 1\n"
        "l polygon wide 0 0 12 -.3 1 -.3 .3 1 -.3 .3 1 .3 -.3 1 .3\n"
        "i sphere window 0 0 4 .1 .9 .1 .001\n"
        "l sphere behind 0 0 4 0 -1 0 .001\n"
        "l sphere beside 0 0 4 5 1 0 .001\n";

    show(lamps, params(20, 1), "-vh 90 -vv 90", false);
    ck_assert_int_eq(pic.frame.paint.n, 0);
}

TEST(coverage_of_all_pixels_is_the_area)
{
    static const struct rad_paint_source s = {
        .ncorners = 4,
        .corner = { { .11, .13 }, { .83, .27 }, { .71, .9 }, { .2, .66 } }
    };
    const struct rad_canvas canvas = { .width = 9, .height = 7 };
    const double(*poly)[2] = s.corner;
    double sum = 0, twice = 0, centre[2];

    for (int i = 0; i < 4; i++)
        twice += poly[i][0] * poly[(i + 1) % 4][1] -
                 poly[(i + 1) % 4][0] * poly[i][1];
    for (int y = 0; y < 7; y++)
        for (int x = 0; x < 9; x++) {
            double w = rad_paint_coverage(&s, &canvas, x, y, centre);

            ck_assert(w >= 0 && w <= 1 + 1e-12);
            if (w > 0)
                ck_assert(centre[0] >= x / 9. && centre[0] <= (x + 1) / 9. &&
                          centre[1] >= y / 7. && centre[1] <= (y + 1) / 7.);
            sum += w;
        }
    ck_assert_double_eq_tol(sum / 63, twice / 2, 1e-12);
}

TEST(windows_stay_in_the_picture)
{
    static const struct rad_window bad[] = {
        { -1, 0, 5, 5 }, { 0, 0, 49, 5 }, { 44, 44, 5, 5 },
        { 0, 0, 0, 5 },  { 0, 0, 5, -1 }, { 5, 2147483647, 5, 2147483647 }
    };
    struct rad_pixel line[48], *rows[48];

    for (int k = 0; k < 48; k++)
        rows[k] = line;
    show(room, params(48, 4), ahead, false);
    for (int i = 0; i < N_ELEM(bad); i++)
        ck_assert_int_eq(
            rad_frame_window(&pic.frame, &pic.w.ctx, &bad[i], rows),
            RAD_EUSAGE);
}

TEST(pictures_without_pixels_are_refused)
{
    struct rad_params p = params(300, 1);
    struct rad_view v;
    struct rad_error err = { 0 };
    int width, height;
    double aspect;

    rad_view_init(&v);
    v.type = 'l';
    v.horiz = 1000;
    v.vert = 1;
    ck_assert_int_eq(rad_view_setup(&v, NULL), 0);
    ck_assert_int_eq(rad_frame_size(&p, &v, &width, &height, &aspect, &err),
                     RAD_EUSAGE);
    ck_assert_ptr_nonnull(strstr(err.what, "empty picture"));
}
