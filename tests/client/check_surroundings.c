/* check_surroundings.c - how much larger scenes are than what views show
 *
 * A room of 5 by 5 by 3 with a window in its south wall, alone or on ground. */
#include "config.h"

#include "trial/surroundings.h"
#include "base/vec.h"
#include "tests/unit.h"
#include "tests/world.h"

#include <math.h>

#define ROOM                                                                   \
    "void plastic white 0 0 5 .7 .7 .7 0 0\n"                                  \
    "white polygon floor 0 0 12 0 0 0 5 0 0 5 5 0 0 5 0\n"                     \
    "white polygon ceiling 0 0 12 0 0 3 0 5 3 5 5 3 5 0 3\n"                   \
    "white polygon west 0 0 12 0 0 0 0 5 0 0 5 3 0 0 3\n"                      \
    "white polygon east 0 0 12 5 0 0 5 0 3 5 5 3 5 5 0\n"                      \
    "white polygon north 0 0 12 0 5 0 5 5 0 5 5 3 0 5 3\n"                     \
    "white polygon south 0 0 30 0 0 0 0 0 3 5 0 3 5 0 0 1 0 0 1 0 1 4 0 1 "    \
    "4 0 2.5 1 0 2.5 1 0 1\n"
#define GROUND "white ring ground 0 0 8 2 2 -.1 0 0 1 0 1e4\n"
#define RING   "white ring near 0 0 8 4.44 4.7 1.585 0 1 0 0 .06\n"
#define PANES                                                                  \
    "void glass clear 0 0 3 .9 .9 .9\nclear sphere pane 0 0 4 4.5 4.8 1.6 "    \
    ".1\n"                                                                     \
    "void illum lit 0 0 3 1 1 1\nlit sphere pane 0 0 4 4.5 4.8 1.6 .12\n"      \
    "void sphere nothing 0 0 4 4.5 4.8 1.6 .15\n"
#define MIRROR                                                                 \
    "void mirror glass 0 0 3 .9 .9 .9\n"                                       \
    "glass polygon pane 0 0 12 4 4.9 1 4 4.9 2 5 4.9 2 5 4.9 1\n"
#define COLUMN                                                                 \
    "white polygon column 0 0 12 2.2 -19.7 4 2.45 -19.7 4 2.45 -19.7 6 2.2 "   \
    "-19.7 6\n"
#define SLAT(z, low)                                                           \
    "white polygon slat" #z " 0 0 12 1 .05 " #z " 4 .05 " #z " 4 .07 " #low    \
    " 1 .07 " #low "\n"
#define BLIND                                                                  \
    SLAT(1.62, 1.61)                                                           \
    SLAT(1.64, 1.63)                                                           \
    SLAT(1.66, 1.65)                                                           \
    SLAT(1.68, 1.67) SLAT(1.7, 1.69) SLAT(1.72, 1.71) SLAT(1.74, 1.73)
#define LAMP                                                                   \
    "void plastic white 0 0 5 .7 .7 .7 0 0\nwhite bubble hall 0 0 4 0 0 0 "    \
    "15\n"                                                                     \
    "white cup shade 0 0 8 0 0 2.15 0 0 2.4 .2 .08\n"
#define WITHIN "-vp 4.5 4.8 1.6 -vd -.6 -1 -.15 -vh 80 -vv 60"

static const struct {
    const char *scene, *view;
    double least, most; /* what is shown */
    int times;
} views[] = {
    { ROOM, WITHIN, 2, 7, 0 },
    { ROOM GROUND, WITHIN, 2, 7, 1024 },
    { ROOM GROUND PANES, WITHIN, 2, 7, 1024 },
    { ROOM GROUND MIRROR, "-vp 4.5 4.8 1.6 -vd -.2 1 -.1 -vh 80 -vv 60", 1, 7,
      1024 },
    /* most of the picture is a window */
    { ROOM GROUND, "-vp 2.5 1 1.7 -vd 0 -1 -.1 -vh 90 -vv 60", 1, 10, 1024 },
    /* a part of a wall, which the whole room lights */
    { ROOM GROUND, "-vp 2 4 1.5 -vd 0 1 0 -vh 5 -vv 5", 2, 5, 1024 },
    /* the slats of a blind, and a lamp's shade, near the eye: the room about
     * them counts, not what is between them */
    { ROOM BLIND, "-vp 2.5 .12 1.67 -vd 0 -1 -.1 -vh 50 -vv 35", .4, 7, 0 },
    { LAMP, "-vp 0 .4 2 -vd 0 -1 .5 -vh 30 -vv 25", 2, 30, 0 },
    /* what stands close before the eye is not what is shown */
    { ROOM RING, WITHIN, 2, 7, 0 },
    { ROOM RING GROUND, WITHIN, 2, 7, 256 },
    /* a column near the eye */
    { ROOM GROUND COLUMN, "-vp 2.5 -20 5 -vd 0 1 -.1 -vh 60 -vv 45", 2, 10,
      1024 },
    /* from afar, in a small and in a parallel picture */
    { ROOM GROUND, "-vp 2.5 -1000 900 -vd 0 1 -.9 -vh .3 -vv .3", 1, 10, 256 },
    { ROOM GROUND, "-vtl -vp 2 2 900 -vd 0 0 -1 -vu 0 1 0 -vh 9 -vv 9", 1, 13,
      256 },
    /* the whole of the ground, and nothing */
    { ROOM GROUND, "-vtl -vp 2 2 90 -vd 0 0 -1 -vu 0 1 0 -vh 2e4 -vv 2e4", 5e3,
      2e4, 0 },
    { ROOM GROUND, "-vp 0 0 9 -vd 0 0 1 -vu 0 1 0", 0, 0, 0 },
    /* little but sky */
    { ROOM GROUND, "-vp 2.5 -20 1.6 -vd 0 1 .32 -vh 60 -vv 30", 0, 0, 0 },
};

static struct surroundings
find(const char *scene, const struct msg_frame *frames, uint32_t n,
     const struct rad_points *points)
{
    struct surroundings s;
    struct world w;

    memset(&w, 0, sizeof w);
    world_open(&w, scene, "");
    ck_assert_int_eq(
        surroundings_find(&s, w.scene,
                          &(struct surroundings_of){ frames, n, points },
                          &w.err),
        0);
    world_close(&w);
    return s;
}

LOOP_TEST(what_a_view_shows_is_found, N_ELEM(views))
{
    struct msg_frame frame = { .view = views[_i].view };
    struct surroundings s = find(views[_i].scene, &frame, 1, NULL);

    ck_assert_double_ge(s.shown, views[_i].least);
    ck_assert_double_le(s.shown, views[_i].most);
    ck_assert_int_eq(surroundings_times(&s), views[_i].times);
}

/* Does the ball hold the point? */
static bool
holds(const double ball[4], double x, double y, double z)
{
    double p[3] = { x, y, z };

    return rad_dist2(p, ball) <= ball[3] * ball[3];
}

static void
place(const struct surroundings *s, const struct msg_frame *frames, uint32_t n,
      const struct rad_points *points, double ball[4])
{
    struct surroundings_of of = { frames, n, points };
    struct rad_error err;

    ck_assert_int_eq(surroundings_place(s, &of, ball, &err), 0);
}

/* Of more frames than are looked at the eyes count. */
TEST(the_place_of_what_is_shown_is_found)
{
    struct msg_frame frames[1000];
    struct surroundings s;
    double ball[4];

    for (int i = 0; i < 1000; i++)
        frames[i].view = WITHIN;
    s = find(ROOM GROUND, frames, 1, NULL);
    place(&s, frames, 1, NULL, ball);
    ck_assert(holds(ball, 4.5, 4.8, 1.6) && holds(ball, 2.5, 2.5, 1.5));
    ck_assert_double_lt(ball[3], 10);
    for (int k = 0; k < 4; k++)
        ck_assert_double_eq(ball[k], floor(8 * ball[k]) / 8);
    frames[999].view = "-vp 2 -60 1 -vd 0 0 1 -vu 0 1 0";
    s = find(ROOM GROUND, frames, 1000, NULL);
    place(&s, frames, 1000, NULL, ball);
    ck_assert(holds(ball, 2, -60, 1) && holds(ball, 2.5, 2.5, 1.5));
    ck_assert_double_lt(ball[3], 45);
    s = find(ROOM GROUND, frames + 999, 1, NULL);
    place(&s, frames + 999, 1, NULL, ball);
    ck_assert_double_eq(ball[3], 0);
}

/* An animation from the air into the room. */
TEST(the_view_that_shows_least_counts)
{
    struct msg_frame frames[100];
    struct surroundings all, last;

    for (int i = 0; i < 100; i++)
        frames[i].view = i < 98 ? "-vp 2 2 9000 -vd 0 0 -1 -vu 0 1 0" : WITHIN;
    all = find(ROOM GROUND, frames, 100, NULL);
    last = find(ROOM GROUND, frames + 99, 1, NULL);
    ck_assert_double_eq(all.shown, last.shown);
}

static const struct {
    uint32_t n; /* sensors in a row */
    uint32_t flags;
    double least, most;
} sensors[] = {
    { 1, RAD_POINTS_IRRADIANCE, .5, 5 }, /* near a wall */
    { 9, RAD_POINTS_IRRADIANCE, .5, 5 },
    { 1, 0, .5, 5 },
};

LOOP_TEST(what_sensors_see_is_found, N_ELEM(sensors))
{
    double point[9][6];
    uint32_t pixel[9], n = sensors[_i].n;
    struct rad_points points;
    struct surroundings s;
    double ball[4];
    int width, height;
    uint8_t *file;

    for (uint32_t i = 0; i < n; i++)
        memcpy(point[i], (double[6]){ .5 + .4 * i, 2, .75, 0, 0, 1 },
               sizeof point[i]);
    ck_assert_int_eq(rad_points_lay(point, n, &width, &height, pixel, NULL), 0);
    file = rad_points_pack(point, n, 0, sensors[_i].flags, width, height, pixel);
    ck_assert_int_eq(rad_points_open(&points, file,
                                     rad_points_bytes(width, height), NULL),
                     0);
    s = find(ROOM GROUND, NULL, 1, &points);
    ck_assert_double_ge(s.shown, sensors[_i].least);
    ck_assert_double_le(s.shown, sensors[_i].most);
    place(&s, NULL, 0, &points, ball);
    free(file);
    ck_assert_double_lt(ball[3], 9);
    for (uint32_t i = 0; i < n; i++)
        ck_assert(holds(ball, point[i][0], point[i][1], point[i][2]));
}

TEST(a_coarse_resolution_is_told)
{
    struct surroundings site = { .cube = 2e4, .shown = 3 };
    struct surroundings room = { .cube = 5, .shown = 3 };

    ck_assert(surroundings_blur(&site, 64));
    ck_assert(!surroundings_blur(&site, 64 * 1024));
    ck_assert(!surroundings_blur(&site, 0)); /* no limit */
    ck_assert(!surroundings_blur(&room, 1));
    ck_assert_int_eq(surroundings_ambres(0, 64), 64);
    ck_assert_int_eq(surroundings_ambres(1024, 64), 65536);
    ck_assert_int_eq(surroundings_ambres(1 << 30, 64), 1000000000);
    ck_assert_int_eq(surroundings_ambres(4, 2000000000), 2000000000);
    ck_assert_int_eq(surroundings_ambres(4, 0), 0);
}
