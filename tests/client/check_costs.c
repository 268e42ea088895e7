/* check_costs.c - a former job's statistics as the cost of lines */
#include "config.h"

#include "job/costs.h"
#include "tests/unit.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* -ps 6 has a base line every 4 rows: of 10 rows, rows 0, 4, 8 and 9. */
#define HEAD(frames)                                                           \
    "{\"options\": \"-ab 0 -ps 6 -pt .05\","                                   \
    "\"picture\": {\"width\": 20, \"height\": 10, \"frames\": " frames "},"    \
    "\"units\": ["
#define UNIT(frame, x, y, w, h, rays, cpu)                                     \
    "{\"frame\": " frame ", \"x\": " x ", \"y\": " y ", \"width\": " w         \
    ", \"height\": " h ", \"rays\": " rays ", \"cpu_s\": " cpu "}"
#define TAIL "]}"

/* Two units of a worker, then one of another that begins below. */
#define BY(y, h, cpu, start, worker)                                           \
    "{\"frame\": 0, \"x\": 0, \"y\": " y ", \"width\": 20, \"height\": " h     \
    ", \"rays\": 1, \"cpu_s\": " cpu ", \"start_s\": " start                   \
    ", \"worker\": \"" worker "\"}"
#define LINED(lines)                                                           \
    HEAD("1")                                                                  \
    BY("0", "1", "9", "3", "ws1")                                              \
    "," BY("1", "8", "9", "1", "ws1") "," BY(                                  \
        "9", "1", "9", "1.5", "ws2") "], \"line_s\": " lines "}"

/* Bars, and windows that cut them. */
#define BARS                                                                   \
    HEAD("1")                                                                  \
    UNIT("0", "0", "0", "20", "5", "7", "2.5")                                 \
    "," UNIT("0", "0", "5", "20", "4", "9", "1") "," UNIT("0", "0", "9", "20", \
                                                          "1", "0", "3") TAIL

static const struct {
    const char *text;
    float line[4];
} good[] = {
    { BARS, { .5, 2, 1, 3 } },
    /* rays where a unit has no time */
    { HEAD("1") UNIT("0", "0", "0", "20", "5", "10", "2.5") "," UNIT(
          "0", "0", "5", "20", "5", "30", "0.0") TAIL,
      { 2, 8, 24, 6 } },
    /* windows side by side */
    { HEAD("1") UNIT("0", "0", "0", "12", "10", "1", "10") "," UNIT(
          "0", "12", "0", "8", "6", "1", "6") "," UNIT("0", "12", "6", "8", "4",
                                                       "1", "8") TAIL,
      { 2, 8, 4 + 1 + 3 * 2, 3 } },
    /* by line, whatever units cost; ws1 began with line 1, which took 8 more
     * than the middle one of those after it */
    { LINED("[[1, 12, 4, 2]]"), { 3, 6, 6, 4 } },
    /* no less */
    { LINED("[[5, 1, 4, 2]]"), { 5, 1, 4, 2 } },
    { LINED("[[0, 0, 0, 0]]"), { 0, 0, 0, 0 } },
};

/* Who wants the cost of windows finds them as they were; bars say no more than
 * their rows do. */
TEST(windows_are_kept)
{
    struct costs c;

    ck_assert_int_eq(costs_parse(&c, good[2].text, strlen(good[2].text), NULL),
                     0);
    ck_assert_uint_eq(c.frames[0].nwindows, 3);
    ck_assert_uint_eq(c.frames[0].window[2].x, 12);
    ck_assert_uint_eq(c.frames[0].window[2].y, 6);
    ck_assert_uint_eq(c.frames[0].window[2].width, 8);
    ck_assert_uint_eq(c.frames[0].window[2].height, 4);
    ck_assert_double_eq(c.frames[0].window[2].cost, 8);
    costs_release(&c);
    ck_assert_int_eq(costs_parse(&c, BARS, strlen(BARS), NULL), 0);
    ck_assert_ptr_null(c.frames[0].window);
    costs_release(&c);
}

LOOP_TEST(units_are_spread_over_lines, N_ELEM(good))
{
    struct msg_frame frame = { .width = 20, .height = 10 };
    const struct frames frames = { .list = &frame, .n = 1 };
    struct rad_error err = { 0 };
    struct costs c;
    uint8_t *bytes = NULL;
    float line[4];
    uint32_t n = 0;

    ck_assert_msg(costs_parse(&c, good[_i].text, strlen(good[_i].text), &err) ==
                      0,
                  "%s", err.what);
    ck_assert_msg(costs_of_lines(&c, &frames, 6, &bytes, &n, &err) == 0, "%s",
                  err.what);
    ck_assert_uint_eq(n, 4);
    wire_floats_get(line, bytes, n);
    for (int i = 0; i < 4; i++)
        ck_assert_msg(line[i] > good[_i].line[i] - 1e-6f &&
                          line[i] < good[_i].line[i] + 1e-6f,
                      "line %d: %g, expected %g", i, line[i], good[_i].line[i]);
    free(bytes);
    costs_release(&c);
}

/* Frames are known by their order, whatever number the first has. */
TEST(frames_of_an_animation_follow_each_other)
{
    static const char text[] = HEAD("2")
        UNIT("8", "0", "0", "20", "10", "1",
             "10") "," UNIT("7", "0", "0", "20", "10", "1", "20") TAIL;
    struct msg_frame list[] = { { .width = 20, .height = 10 },
                                { .width = 20, .height = 10 } };
    const struct frames two = { .list = list, .n = 2 };
    struct costs c;
    uint8_t *bytes = NULL;
    float line[8];
    uint32_t n = 0;

    ck_assert_int_eq(costs_parse(&c, text, strlen(text), NULL), 0);
    ck_assert_int_eq(costs_of_lines(&c, &two, 6, &bytes, &n, NULL), 0);
    ck_assert_uint_eq(n, 8);
    wire_floats_get(line, bytes, n);
    ck_assert_float_eq(line[0], 2);
    ck_assert_float_eq(line[1], 8);
    ck_assert_float_eq(line[4], 1);
    free(bytes);
    costs_release(&c);
}

static const struct {
    uint32_t width, height, n;
    int psample;
    const char *what;
} others[] = {
    { 20, 11, 1, 6, "20 by 10 pixels, not 20 by 11" },
    { 21, 10, 1, 6, "not 21 by 10" },
    { 20, 10, 2, 6, "1 frames, not 2" },
    { 20, 10, 1, 4, "4 rows apart, not 3" },
};

LOOP_TEST(another_picture_is_refused, N_ELEM(others))
{
    struct msg_frame list[2] = {
        { .width = others[_i].width, .height = others[_i].height },
        { .width = others[_i].width, .height = others[_i].height }
    };
    const struct frames other = { .list = list, .n = others[_i].n };
    struct rad_error err = { 0 };
    uint8_t *bytes = NULL;
    struct costs c;
    uint32_t n;

    ck_assert_int_eq(costs_parse(&c, BARS, strlen(BARS), NULL), 0);
    ck_assert_int_eq(
        costs_of_lines(&c, &other, others[_i].psample, &bytes, &n, &err),
        RAD_EDATA);
    ck_assert_msg(strstr(err.what, others[_i].what) != NULL, "%s", err.what);
    ck_assert_ptr_null(bytes);
    costs_release(&c);
}

#define ONE UNIT("0", "0", "0", "20", "5", "7", "1")

static const struct {
    const char *text, *what;
} bad[] = {
    { "", "line 1: no statistics" },
    { "{\n\"options\": }", "line 2: no statistics" },
    { "[]", "lacks options" },
    { "{\"options\": \"-ps 4\", \"units\": []}", "lacks options" },
    { HEAD("0") TAIL, "0 frames" },
    { HEAD("99999") TAIL, "99999 frames" },
    { HEAD("1") TAIL, "not done" },
    { HEAD("1") ONE "," ONE TAIL, "not done" }, /* twice */
    { HEAD("1") ONE "," UNIT("0", "0", "6", "20", "4", "7", "1") TAIL,
      "not done" },
    { HEAD("2") ONE TAIL, "not done" },
    { HEAD("1") ONE "," UNIT("1", "0", "0", "20", "5", "7", "1") TAIL,
      "frame 1" },
    { HEAD("1") "{\"frame\": 0}" TAIL, "lacks a number" },
    { HEAD("1") "7" TAIL, "lacks a number" },
    { HEAD("1") UNIT("0", "-1", "0", "20", "5", "7", "1") TAIL, "impossible" },
    { HEAD("1") UNIT("0", "0", "0", "0", "5", "7", "1") TAIL, "impossible" },
    { HEAD("1") UNIT("0", "65000", "0", "1000", "5", "7", "1") TAIL,
      "impossible" },
    { HEAD("1") UNIT("0", "0", "0", "20", "5", "-7", "1") TAIL, "impossible" },
    { HEAD("1") UNIT("0", "0", "0", "20", "5", "7", "-1") TAIL, "impossible" },
    { HEAD("1") UNIT("0", "0", "0", "20", "5", "7", "1e300") TAIL,
      "impossible" },
    { LINED("7"), "line_s is not of 1 frames" },
    { LINED("[[1, 2, 3, 4], []]"), "line_s is not of 1 frames" },
    { LINED("[5]"), "a line_s of not 4" },
    { LINED("[[1, 2, 3]]"), "a line_s of not 4" },
    { LINED("[[1, 2, 3, -4]]"), "impossible line_s" },
    { LINED("[[1, 2, 3, 1e300]]"), "impossible line_s" },
    { LINED("[[1, 2, 3, \"4\"]]"), "impossible line_s" },
    { HEAD("1") UNIT("-3", "0", "0", "20", "5", "7", "1") TAIL, "impossible" },
    { "{\"options\": \"-maps 4\", \"picture\": {\"frames\": 1}, \"units\": []}",
      "no -ps" },
    { "{\"options\": \"-ps x\", \"picture\": {\"frames\": 1}, \"units\": []}",
      "a wrong -ps" },
    { "{\"options\": \"-ps 17\", \"picture\": {\"frames\": 1}, \"units\": []}",
      "a wrong -ps" },
};

LOOP_TEST(bad_statistics_are_refused, N_ELEM(bad))
{
    struct rad_error err = { 0 };
    struct costs c;

    ck_assert_int_eq(costs_parse(&c, bad[_i].text, strlen(bad[_i].text), &err),
                     RAD_EDATA);
    ck_assert_msg(strstr(err.what, bad[_i].what) != NULL, "%s", err.what);
    costs_release(&c);
}

TEST(files_are_named)
{
    char path[] = "/tmp/check_costs.XXXXXX";
    struct rad_error err = { 0 };
    struct costs c;
    int fd = mkstemp(path);

    ck_assert_int_ge(fd, 0);
    ck_assert_int_eq(write(fd, "{", 1), 1);
    close(fd);
    ck_assert_int_eq(costs_read(&c, path, &err), RAD_EDATA);
    ck_assert_str_eq(err.where, path);
    costs_release(&c);
    unlink(path);
    err = (struct rad_error){ 0 };
    ck_assert_int_eq(costs_read(&c, path, &err), RAD_ENOINPUT);
    costs_release(&c);
}
