/* check_view.c - views: options, rays of each type, inverse, round trip */
#include "config.h"

#include "base/rng.h"
#include "base/vec.h"
#include "picture/view.h"
#include "tests/unit.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

/* A view from options, set up. */
static struct rad_view
view_of(const char *text)
{
    struct rad_view v;
    struct rad_error err = { 0 };
    char line[RAD_VIEW_TEXT + 8];

    snprintf(line, sizeof line, "VIEW= %s", text);
    rad_view_init(&v);
    ck_assert_int_ge(rad_view_line(&v, line, strlen(line), &err), 0);
    ck_assert_msg(rad_view_setup(&v, &err) == 0, "%s", err.what);
    return v;
}

/* Rays of views that look along +y with z up: x is to the right.  The
 * expected directions are worked out from what each projection means. */
static const struct {
    const char *view;
    double x, y, dir[3], org[3], aft;
} rays[] = {
    /* perspective: half a width off is half the angle off */
    { "-vh 90 -vv 90", .5, .5, { 0, 1, 0 }, { 0, 0, 0 }, 0 },
    { "-vh 90 -vv 90", 1, .5, { 1, 1, 0 }, { 0, 0, 0 }, 0 },
    { "-vh 90 -vv 60", .5, 1, { 0, 1, .5773502691896258 }, { 0 }, 0 },
    { "-vh 90 -vv 90 -vp 1 2 3", 0, 0, { -1, 1, -1 }, { 1, 2, 3 }, 0 },
    { "-vh 90 -vv 90 -vs 1", 0, .5, { 1, 1, 0 }, { 0 }, 0 },
    { "-vh 90 -vv 90 -vl -.5", .5, .5, { 0, 1, -1 }, { 0 }, 0 },
    { "-vh 90 -vv 90 -vo 2 -va 5",
      1,
      .5,
      { 1, 1, 0 },
      { 2, 2, 0 },
      4.242640687119285 },
    /* parallel */
    { "-vtl -vh 4 -vv 2", 1, 0, { 0, 1, 0 }, { 2, 0, -1 }, 0 },
    { "-vtl -vh 4 -vv 2 -vo 3 -va 7", 0, .5, { 0, 1, 0 }, { -2, 3, 0 }, 4 },
    /* hemispherical: the offset is the sine */
    { "-vth -vh 180 -vv 180", .75, .5, { .5, .8660254037844386, 0 }, { 0 }, 0 },
    { "-vth -vh 180 -vv 180 -vo 2 -va 3",
      .5,
      .75,
      { 0, .8660254037844386, .5 },
      { 0, 1.7320508075688772, 1 },
      1 },
    /* angular: the offset is the angle, here 90 and 45 degrees */
    { "-vta -vh 180 -vv 180", 1, .5, { 1, 0, 0 }, { 0 }, 0 },
    { "-vta -vh 360 -vv 360", .5, .625, { 0, 1, 1 }, { 0 }, 0 },
    { "-vta -vh 360 -vv 360", .5, 1, { 0, -1, 0 }, { 0 }, 0 },
    /* cylinder: angle across, tangent up */
    { "-vtc -vh 360 -vv 90", .75, .5, { 1, 0, 0 }, { 0 }, 0 },
    { "-vtc -vh 360 -vv 90", 0, 1, { 0, -1, 1 }, { 0 }, 0 },
    { "-vtc -vh 180 -vv 90 -vo 1 -va 2",
      1,
      1,
      { 1, 0, 1 },
      { 1, 0, 1 },
      1.4142135623730951 },
    /* planisphere: twice the tangent of half the angle; the edge of 180
     * degrees is at 90, half way to it at atan(1/2)*2 */
    { "-vts -vh 180 -vv 180", 1, .5, { 1, 0, 0 }, { 0 }, 0 },
    { "-vts -vh 180 -vv 180", .75, .5, { .8, .6, 0 }, { 0 }, 0 },
    /* length of -vd and direction of -vu do not matter */
    { "-vd 0 9 0 -vu 0 5 3 -vh 90 -vv 90", 1, .5, { 1, 1, 0 }, { 0 }, 0 },
};

LOOP_TEST(rays_follow_the_projection, N_ELEM(rays))
{
    struct rad_view v = view_of(rays[_i].view);
    double want[3], org[3], dir[3];
    double aft = rad_view_ray(&v, rays[_i].x, rays[_i].y, org, dir);

    rad_copy(want, rays[_i].dir);
    rad_normalize(want);
    ck_assert_double_eq_tol(aft, rays[_i].aft, 1e-14);
    for (int k = 0; k < 3; k++) {
        ck_assert_double_eq_tol(dir[k], want[k], 1e-15);
        ck_assert_double_eq_tol(org[k], rays[_i].org[k], 1e-14);
    }
}

/* All rays through the lens meet where the picture is sharp, and start on the
 * fore plane. */
static const struct {
    const char *view;
    double thick; /* of the lens over its diameter */
} lenses[] = {
    { "-vd 0 5 0 -vo 1 -va 9", 0 },
    { "-vtl -vd 0 5 0 -vh 4 -vv 4 -vo 1 -va 9", 0 },
    { "-vth -vd 0 5 0 -vh 120 -vv 120", M_PI / 4 },
    { "-vta -vd 0 5 0 -vh 120 -vv 120 -vp 1 2 3", M_PI / 4 },
    { "-vts -vd 0 5 0 -vh 120 -vv 120", M_PI / 4 },
    { "-vtc -vd 0 5 0 -vh 120 -vv 60", M_PI / 4 },
};

LOOP_TEST(lens_is_in_focus_at_the_length_of_the_direction, N_ELEM(lenses))
{
    struct rad_view v = view_of(lenses[_i].view);
    bool flat = lenses[_i].thick == 0;
    double o0[3], d0[3], focus[3], thick = 0, wide = 0;
    double aft = rad_view_ray(&v, .7, .6, o0, d0);

    rad_madd(focus, o0, (5 - v.vfore) / (flat ? d0[1] : 1), d0);
    for (int i = 0; i < 1000; i++) {
        double u[3] = { i % 10 / 9., i / 10 % 10 / 9., i / 100 / 9. };
        double o[3], d[3], off[3], to[3], cosine;

        rad_copy(o, o0);
        rad_copy(d, d0);
        double end = rad_view_lens(&v, .2, u, o, d, aft);

        rad_sub(to, focus, o);
        cosine = rad_dot(to, d) / sqrt(rad_dot(to, to));
        ck_assert_double_eq_tol(cosine, 1, 1e-12);
        if (flat) {
            ck_assert_double_eq_tol(o[1] - v.vp[1], 1, 1e-12);
            ck_assert_double_eq_tol(o[1] + end * d[1] - v.vp[1], 9, 1e-12);
            rad_madd(o, o, -1 / d[1], d); /* back to the lens */
        }
        rad_sub(off, o, v.vp);
        if (v.type == 'l')
            rad_sub(off, o, (double[3]){ o0[0], 0, o0[2] });
        thick = fmax(thick, fabs(off[1]));
        wide = fmax(wide, hypot(off[0], off[2]));
    }
    ck_assert_double_eq_tol(wide, .1, 1e-12);
    ck_assert_double_eq_tol(thick, .1 * lenses[_i].thick, 1e-12);
}

TEST(corners_of_fisheyes_are_no_rays)
{
    struct rad_view v = view_of("-vth -vh 180 -vv 180");
    double org[3], dir[3];

    ck_assert_double_lt(rad_view_ray(&v, .01, .01, org, dir), 0);
    v = view_of("-vta -vh 360 -vv 360");
    ck_assert_double_lt(rad_view_ray(&v, .99, .01, org, dir), 0);
}

static const char *const turned[] = {
    "-vtv -vp 1 2 3 -vd 1 -.4 .3 -vu .1 .2 1 -vh 70 -vv 40 -vs .2 -vl -.1",
    "-vtv -vp 1 2 3 -vd 1 2 3 -vu 0 0 1 -vh 30 -vv 50 -vo .5 -va 20",
    "-vtl -vp 1 2 3 -vd -1 .4 .3 -vu .1 .2 1 -vh 7 -vv 4 -vs 1 -vo 1",
    "-vth -vp 0 5 1 -vd 1 .4 .3 -vu .1 .2 1 -vh 160 -vv 170",
    "-vta -vp 0 5 1 -vd 1 .4 -3 -vu .1 .2 1 -vh 300 -vv 200 -vl .3",
    "-vtc -vp 0 5 1 -vd 1 .4 .3 -vu .1 .2 1 -vh 350 -vv 80 -vo .1",
    "-vts -vp 0 5 1 -vd 1 .4 .3 -vu .1 .2 1 -vh 200 -vv 170",
};

LOOP_TEST(points_on_a_ray_are_located_where_it_started, N_ELEM(turned))
{
    struct rad_view v = view_of(turned[_i]);
    int n = 0;

    for (uint32_t i = 0; i < 1000; i++) {
        double x = rad_rand(1, 2 * i), y = rad_rand(1, 2 * i + 1);
        double org[3], dir[3], p[3], pos[2];
        double aft = rad_view_ray(&v, x, y, org, dir);

        if (aft < 0)
            continue;
        rad_madd(p, org, aft > 0 ? aft / 2 : .5 + i, dir);
        ck_assert_uint_eq(rad_view_locate(&v, p, pos), 0);
        ck_assert_double_eq_tol(pos[0], x, 1e-11);
        ck_assert_double_eq_tol(pos[1], y, 1e-11);
        n++;
    }
    ck_assert_int_gt(n, 500);
}

static const struct {
    const char *view;
    double p[3];
    unsigned bits;
} places[] = {
    { "-vh 90 -vv 90", { 0, 1, 0 }, 0 },
    { "-vh 90 -vv 90", { 2, 1, 0 }, RAD_VIEW_OUTSIDE },
    { "-vh 90 -vv 90", { 0, -1, 0 }, RAD_VIEW_BEHIND },
    { "-vh 90 -vv 90 -vo 2", { 0, 1, 0 }, RAD_VIEW_BEHIND },
    { "-vh 90 -vv 90 -va 2", { 0, 3, 0 }, RAD_VIEW_BEYOND },
    { "-vtl -vh 2 -vv 2", { 0, -1, 0 }, RAD_VIEW_BEHIND },
    { "-vtl -vh 2 -vv 2", { 2, 1, 0 }, RAD_VIEW_OUTSIDE },
    { "-vth -vh 180 -vv 180", { 0, -1, .5 }, RAD_VIEW_BEHIND },
    { "-vta -vh 360 -vv 360", { .01, -1, 0 }, 0 },
    { "-vta -vh 180 -vv 180", { .01, -1, 0 }, RAD_VIEW_OUTSIDE },
    { "-vtc -vh 360 -vv 90", { .1, -1, 0 }, 0 },
    { "-vtc -vh 360 -vv 90", { .1, -1, 2 }, RAD_VIEW_OUTSIDE },
};

LOOP_TEST(places_out_of_view_are_told_apart, N_ELEM(places))
{
    struct rad_view v = view_of(places[_i].view);
    double pos[2];

    ck_assert_uint_eq(rad_view_locate(&v, places[_i].p, pos), places[_i].bits);
}

LOOP_TEST(text_gives_the_same_view, N_ELEM(turned))
{
    struct rad_view v = view_of(turned[_i]), w;
    char text[RAD_VIEW_TEXT], again[RAD_VIEW_TEXT];

    v.vp[0] = 1. / 3;
    v.vdir[1] = 1e-17 / 7;
    ck_assert_int_eq(rad_view_setup(&v, NULL), 0);
    rad_view_format(&v, text, sizeof text);
    w = view_of(text);
    ck_assert_mem_eq(&v, &w, sizeof v);
    rad_view_format(&w, again, sizeof again);
    ck_assert_str_eq(text, again);
}

TEST(longest_text_fits)
{
    struct rad_view v;
    char text[RAD_VIEW_TEXT];
    double longest = -1.2345678901234567e-300;

    rad_view_init(&v);
    for (int k = 0; k < 3; k++)
        v.vp[k] = v.vdir[k] = v.vup[k] = longest;
    v.horiz = v.vert = v.hoff = v.voff = v.vfore = v.vaft = longest;
    rad_view_format(&v, text, sizeof text);
    ck_assert_uint_lt(strlen(text), sizeof text - 1);
    ck_assert_ptr_nonnull(strstr(text, "-vl -1.23456789"));
}

static const struct {
    const char *text;
    int lines;
    double px; /* of -vp */
} files[] = {
    { "VIEW= -vp 3 0 0\n", 1, 3 },
    { "rvu -vtv -vp 3 0 0 -vd 0 1 0 -vh 60 -vv 40\n", 1, 3 },
    { "/usr/local/bin/rpict -x 5 -vp 3 0 0 -ab 2 scene.oct\n", 1, 3 },
    { "VIEW= -vp 1 0 0\nrview -vp 3 0 0\n", 2, 3 },
    { "#?RADIANCE\noconv a.rad\nVIEW= -vp 3 0 0\n\n-Y 1 +X 1\n", 1, 3 },
    { "#?RADIANCE\n\nVIEW= -vp 3 0 0\n", 0, 0 }, /* after the header */
    { "oconv -vp 3 0 0\n", 0, 0 },
    { "rpict -x 3\n", 0, 0 },
    { "", 0, 0 },
    { "VIEW=\t-vp\t3  0 0", 1, 3 },
    { "\xef\xbb\xbfVIEW= -vp 3 0 0\n", 1, 3 },
    { "\xef\xbb\xbf", 0, 0 },
    { "VIEW= -vp 3 0\n", RAD_EDATA, 0 },
    { "VIEW= -vp 3 0 zero\n", RAD_EDATA, 0 },
    { "VIEW= -vtx\n", RAD_EDATA, 0 },
};

LOOP_TEST(view_lines_are_found, N_ELEM(files))
{
    struct rad_view v;

    rad_view_init(&v);
    ck_assert_int_eq(
        rad_view_read(&v, files[_i].text, strlen(files[_i].text), NULL),
        files[_i].lines);
    ck_assert_double_eq(v.vp[0], files[_i].px);
}

static const struct {
    const char *view, *what;
} bad[] = {
    { "-vh 180 -vv 20", "horizontal" },
    { "-vh 20 -vv 0", "vertical" },
    { "-vth -vh 181 -vv 20", "horizontal" },
    { "-vta -vh 20 -vv 361", "vertical" },
    { "-vtc -vh 361 -vv 20", "horizontal" },
    { "-vtc -vh 20 -vv 180", "vertical" },
    { "-vts -vh 360 -vv 20", "horizontal" },
    { "-vtl -vh -1 -vv 1", "horizontal" },
    { "-vd 0 0 0", "zero view direction" },
    { "-vu 0 0 0", "zero view up" },
    { "-vu 0 -2 0", "parallel" },
    { "-vo -1", "clipping" },
    { "-vo 2 -va 1", "clipping" },
};

LOOP_TEST(impossible_views_are_refused, N_ELEM(bad))
{
    struct rad_view v;
    struct rad_error err = { 0 };
    char line[128];

    snprintf(line, sizeof line, "VIEW= %s", bad[_i].view);
    rad_view_init(&v);
    ck_assert_int_eq(rad_view_line(&v, line, strlen(line), NULL), 1);
    ck_assert_int_eq(rad_view_setup(&v, &err), RAD_EUSAGE);
    ck_assert_msg(strstr(err.what, bad[_i].what) != NULL, "%s", err.what);
}

TEST(resolution_keeps_the_pixel_aspect)
{
    static const struct {
        const char *view;
        double aspect, got;
        int x, y, gotx, goty;
    } row[] = {
        { "-vh 45 -vv 45", 1, 1, 512, 512, 512, 512 },
        { "-vtl -vh 2 -vv 1", 1, 1, 384, 384, 384, 192 },
        { "-vtl -vh 1 -vv 2", 1, 1, 384, 384, 192, 384 },
        { "-vtl -vh 1 -vv 1", 2, 2, 100, 100, 100, 50 },
        { "-vtl -vh 1 -vv 1", .5, .5, 100, 100, 50, 100 },
        { "-vtl -vh 1 -vv 1", 0, .5, 50, 100, 50, 100 },
        { "-vtl -vh 1000 -vv 1", 1, 1, 300, 300, 300, 0 },
        /* the office: 45 by 31.25 degrees make 384 by 259 */
        { "-vh 45 -vv 31.25", 1, 1, 384, 384, 384, 259 },
    };

    for (int i = 0; i < N_ELEM(row); i++) {
        struct rad_view v = view_of(row[i].view);
        double aspect = row[i].aspect;
        int x = row[i].x, y = row[i].y;

        rad_view_resolution(&v, &aspect, &x, &y);
        ck_assert_int_eq(x, row[i].gotx);
        ck_assert_int_eq(y, row[i].goty);
        ck_assert_double_eq_tol(aspect, row[i].got, 1e-15);
    }
}
