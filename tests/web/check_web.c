/* check_web.c - what radweb's pages are made of: text of others, the last hour,
 * statistics, pictures */
#include "config.h"

#include "image/edge.h"

#include "web/chart.h"
#include "observer/history.h"
#include "observer/markup.h"
#include "observer/picture.h"
#include "observer/units.h"
#include "tests/unit.h"
#include "web/page.h"

#include <stdlib.h>
#include <string.h>

static char *
taken(struct markup *m)
{
    char *text = markup_take(m, NULL);

    ck_assert_ptr_nonnull(text);
    return text;
}

/* --- text --- */

static const struct {
    const char *text, *html;
} texts[] = {
    { "room.rad", "room.rad" },
    { "<b a='1'>&\"", "&lt;b a=&#39;1&#39;&gt;&amp;&quot;" },
    { "a\nb\\", "a?b\\" },
    { "\xe2\x80\xae"
      "evil\x1b[2J",
      "?evil?[2J" },
    { "\xff\xfe", "??" },
    { "r\xc3\xa4um", "r\xc3\xa4um" },
    { NULL, "" },
};

LOOP_TEST(text_of_others_stays_text, N_ELEM(texts))
{
    struct markup m = { 0 };
    char *text;

    markup_text(&m, texts[_i].text);
    text = taken(&m);
    ck_assert_str_eq(text, texts[_i].html);
    free(text);
}

static const struct {
    double v;
    const char *count, *span;
} numbers[] = {
    { 0, "0", "0 s" },
    { .0042, "0", "4 ms" },
    { 9.9, "10", "9.9 s" },
    { 59, "59", "59 s" },
    { 999, "999", "16 min 39 s" },
    { 1000, "1.00 k", "16 min 40 s" },
    { 99960, "100 k", "27 h 46 min" },
    { 4.56e6, "4.56 M", "52 days 18 h" },
    { -1, "0", "-" },
};

LOOP_TEST(numbers_are_readable, N_ELEM(numbers))
{
    struct markup m = { 0 };
    char *text;

    markup_count(&m, numbers[_i].v);
    text = taken(&m);
    ck_assert_str_eq(text, numbers[_i].count);
    free(text);
    markup_span(&m, numbers[_i].v);
    text = taken(&m);
    ck_assert_str_eq(text, numbers[_i].span);
    free(text);
}

/* --- the last hour --- */

TEST(history_is_the_mean_of_ten_seconds)
{
    static struct history h;

    memset(&h, 0, sizeof h);
    history_note(&h, 50000, 10, .5);
    history_note(&h, 59999, 20, 1);
    ck_assert_uint_eq(history_at(&h, 0)->notes, 2);
    ck_assert_double_eq_tol(history_at(&h, 0)->rays_s, 15, 1e-12);
    ck_assert_double_eq_tol(history_at(&h, 0)->at_work, .75, 1e-12);
    history_note(&h, 75000, 7, 0);
    ck_assert_double_eq(history_at(&h, 0)->rays_s, 7);
    ck_assert_uint_eq(history_at(&h, 1)->notes, 0); /* nothing was known */
    ck_assert_uint_eq(history_at(&h, 2)->notes, 2);
    history_advance(&h, 75000 + 3600000);
    for (unsigned i = 0; i < HISTORY_POINTS; i++)
        ck_assert_uint_eq(history_at(&h, i)->notes, 0);
}

/* --- statistics --- */

static int
read_text(struct units *u, const char *text)
{
    return units_read(u, text, strlen(text), NULL);
}

#define UNIT(w, s, e)                                                          \
    "{\"worker\": \"" w "\", \"start_s\": " s ", \"end_s\": " e "}"

TEST(units_lie_side_by_side)
{
    struct units u;

    ck_assert_int_eq(
        read_text(
            &u,
            "{\n \"job\": \"ab\",\n \"totals\": {\"rays\": 7},"
            "\n \"running\": [" UNIT(
                "w2", "2",
                "6") "]"
                     ",\n \"units\": [\n  " UNIT("w2", "1", "2") ",\n  " UNIT(
                         "w1", "1.5",
                         "3") ",\n  " UNIT("w1", "2",
                                           "4") ",\n  " UNIT("w1", "3",
                                                             "5") "\n ],\n "
                                                                  "\"line_s\": "
                                                                  "[]\n}"),
        0);
    ck_assert_double_eq(
        markup_number(json_object_get(u.head, "totals"), "rays"), 7);
    ck_assert_uint_eq(u.nworkers, 2);
    ck_assert_str_eq(u.workers[0], "w1"); /* by name */
    ck_assert_uint_eq(u.lanes[0], 2);
    ck_assert_uint_eq(u.lanes[1], 1);
    ck_assert_uint_eq(u.nspans, 5);
    ck_assert_double_eq(u.spans[0].start, 1.5); /* lane 0 of w1: 1.5, 3 */
    ck_assert_double_eq(u.spans[1].start, 3);
    ck_assert_uint_eq(u.spans[2].lane, 1);
    ck_assert_double_eq(u.start_s, 1);
    ck_assert_double_eq(u.end_s, 6);
    ck_assert_int_eq(u.spans[4].kind, UNITS_RUN); /* of w2 */
    ck_assert_int_eq(u.spans[3].kind, UNITS_DONE);
    units_release(&u);
}

TEST(many_units_are_joined)
{
    struct markup m = { 0 };
    struct units u;
    char *text;

    markup_raw(&m, "{\"a\": 1,\n \"units\": [");
    for (int i = 0; i < 20000; i++)
        markup_print(&m,
                     "%s{\"worker\": \"w%d\", \"start_s\": %d, \"end_s\": %d}",
                     i > 0 ? ",\n" : "", i % 3, i, i + 3);
    markup_raw(&m, "]}");
    text = taken(&m);
    ck_assert_int_eq(read_text(&u, text), 0);
    free(text);
    ck_assert_uint_le(u.nspans, UNITS_SPANS);
    for (size_t i = 0, n = 0; i <= u.nspans; i++) {
        if (i == u.nspans)
            ck_assert_uint_eq(n, 20000); /* none is lost */
        else
            n += u.spans[i].units;
    }
    chart_units(&m, &u);
    text = taken(&m);
    ck_assert_uint_lt(strlen(text), 600000);
    free(text);
    units_release(&u);
}

static const char *const damaged[] = {
    "",
    "{}",
    "[1,\n \"units\": []}",
    "{\"a\": 1,\n \"units\": [",
    "{\"a\": 1,\n \"units\": [{\"worker\": \"w\"",
    "{\"a\": 1,\n \"units\": [1]}",
    "{\"a\": 1,\n \"units\": [{}{]}",
    "{\"a\",\n \"units\": []}",
};

LOOP_TEST(damaged_statistics_are_refused, N_ELEM(damaged))
{
    struct units u;

    ck_assert_int_eq(read_text(&u, damaged[_i]), RAD_EDATA);
    ck_assert_ptr_null(u.head);
}

/* --- pictures --- */

static char hdr_text[200000];

/* A flat picture whose pixel i has the exponent 128 and a red mantissa of i. */
static size_t
flat_picture(int width, int height)
{
    int n = snprintf(hdr_text, sizeof hdr_text,
                     "#?RADIANCE\nSCENE= a b.rad\nVIEW= -vtv -vp 1 2 3\n"
                     "FORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n",
                     height, width);

    for (int i = 0; i < width * height; i++) {
        const unsigned char p[4] = { (unsigned char)(128 + i % 100), 128, 128,
                                     128 };

        memcpy(hdr_text + n + 4 * i, p, 4);
    }
    return (size_t)n + 4 * (size_t)(width * height);
}

TEST(a_picture_is_handed_out_to_the_bit)
{
    size_t n = flat_picture(7, 5);
    struct picture pic;

    ck_assert_int_eq(
        picture_make(&pic, (const uint8_t *)hdr_text, n, false, NULL), 0);
    ck_assert_int_eq(pic.width, 7);
    ck_assert_int_eq(pic.height, 5);
    ck_assert_int_eq(pic.factor, 1);
    ck_assert_uint_eq(pic.nrgbe, PICTURE_HEAD + 4 * 35);
    ck_assert_mem_eq(pic.rgbe, "RWP1\0\0\0\7\0\0\0\5\0\0\0\1", PICTURE_HEAD);
    ck_assert_mem_eq(pic.rgbe + PICTURE_HEAD, hdr_text + n - 4 * 35, 4 * 35);
    ck_assert_mem_eq(pic.png, "\x89PNG", 4);
    ck_assert_str_eq(pic.view, "-vtv -vp 1 2 3");
    ck_assert_str_eq(pic.scene, "a b.rad");
    picture_release(&pic);
    for (size_t k = 0; k < n; k += 7) /* one that ends early */
        ck_assert_int_lt(
            picture_make(&pic, (const uint8_t *)hdr_text, k, false, NULL), 0);
}

/* A pixel in which a lamp meets the dark is another on the screen than one of
 * their mean, and the same radiance. */
TEST(a_picture_shows_what_meets_within_its_pixels)
{
    struct rad_edge edge = { 3, .5f, rad_grey(1000), rad_grey(0) };
    uint8_t *code = (uint8_t *)hdr_text + flat_picture(7, 5), *at = code;
    struct picture with, without;

    for (int y = 0; y < 5; y++)
        at += rad_edge_encode_row(&edge, y == 2, at);
    rad_edge_encode_end((uint64_t)(at - code), at);
    at += RAD_EDGE_END_BYTES;
    ck_assert_int_eq(picture_make(&with, (const uint8_t *)hdr_text,
                                  (size_t)((char *)at - hdr_text), false, NULL),
                     0);
    ck_assert_int_eq(picture_make(&without, (const uint8_t *)hdr_text,
                                  (size_t)((char *)code - hdr_text), false,
                                  NULL),
                     0);
    ck_assert_uint_eq(with.nrgbe, without.nrgbe);
    ck_assert_mem_eq(with.rgbe, without.rgbe, with.nrgbe);
    ck_assert(with.npng != without.npng ||
              memcmp(with.png, without.png, with.npng) != 0);
    picture_release(&with);
    picture_release(&without);
}

/* Who submits a job has a say in its picture's header. */
static const struct {
    const char *view, *scene, *words;
} commands[] = {
    { "-vtv -vp 1 2 -3e1", "a.rad b.oct",
      "radsubmit -vtv -vp 1 2 -3e1 -ab 1 -o picture.hdr a.rad b.oct" },
    { "-vth", "!touch${IFS}x -f @f $HOME 'q",
      "radsubmit -vth -ab 1 -o picture.hdr ./'!touch${IFS}x' ./-f ./@f "
      "./'$HOME' "
      "''\\''q'" },
    { "-vtv --launch=x", "a.rad", "radsubmit -ab 1 -o picture.hdr a.rad" },
    { "-vp 1 2 3 x.rad", "", "radsubmit -ab 1 -o picture.hdr scene.rad" },
    { "-vf view.vf", "", "radsubmit -ab 1 -o picture.hdr scene.rad" },
};

LOOP_TEST(command_lines_run_nothing_of_others, N_ELEM(commands))
{
    struct watch w = { .detail = json_pack("{s:s}", "state", "done"),
                       .units.head = json_pack("{s:s}", "options", "-ab 1") };
    struct markup m = { 0 }, words = { 0 };
    struct model c = { .up = true };

    strcpy(w.view, commands[_i].view);
    strcpy(w.scene, commands[_i].scene);
    page_job(&m, &c, &w);
    markup_raw(&words, "<pre id=\"words\">");
    markup_text(&words, commands[_i].words);
    markup_raw(&words, "</pre>");
    ck_assert_msg(strstr(m.text, words.text) != NULL, "%s", m.text);
    json_decref(w.detail);
    json_decref(w.units.head);
    markup_release(&m);
    markup_release(&words);
}

TEST(any_frame_is_a_few_links_away)
{
    struct watch w = { .frame = 499,
                       .detail = json_pack("{s:s,s:i}", "state", "done",
                                           "frames", 1000) };
    struct model c = { .up = true };
    struct markup m = { 0 };

    page_job(&m, &c, &w);
    ck_assert_ptr_nonnull(strstr(m.text, "?frame=0\">1<"));
    ck_assert_ptr_nonnull(strstr(m.text, "?frame=498\">&larr; frame 499<"));
    ck_assert_ptr_nonnull(strstr(m.text, "<b>500</b>"));
    ck_assert_ptr_nonnull(strstr(m.text, "?frame=999\">1000<"));
    json_decref(w.detail);
    markup_release(&m);
}

/* All pixels of one radiance: so is their mean. */
TEST(a_large_picture_is_made_smaller)
{
    enum { SIDE = 2500 };
    size_t head, n = 4 * (size_t)SIDE * SIDE;
    struct picture pic;
    uint8_t *all;

    head = (size_t)snprintf(hdr_text, sizeof hdr_text,
                            "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X "
                            "%d\n",
                            SIDE, SIDE);
    all = malloc(head + n);
    ck_assert_ptr_nonnull(all);
    memcpy(all, hdr_text, head);
    for (size_t i = 0; i < n; i += 4)
        memcpy(all + head + i, "\x90\x80\xa0\x81", 4);
    ck_assert_int_eq(picture_make(&pic, all, head + n, false, NULL), 0);
    free(all);
    ck_assert_int_eq(pic.factor, 3);
    ck_assert_int_eq(pic.width, SIDE / 3);
    for (size_t i = PICTURE_HEAD; i < pic.nrgbe; i += 4)
        ck_assert_mem_eq(pic.rgbe + i, "\x90\x80\xa0\x81", 4);
    picture_release(&pic);
}
