/* check_edge.c - what meets within a pixel: told apart, kept in a file, shown
 */
#include "config.h"

#include "base/rng.h"
#include "image/edge.h"
#include "image/filter.h"
#include "image/hdr.h"
#include "tests/made_picture.h"
#include "tone/tone.h"

#include <stdio.h>
#include <string.h>

#define LAMP  10000.f
#define WALL  .3f
#define WIDTH 60
#define LINES 45

/* Is sample (x, y) of a picture of WIDTH by LINES pixels on the side of the
 * lamp, which a slanted line parts from the wall? */
static bool
is_lamp(int x, int y, int n)
{
    return .31 * x + y < .6 * LINES * n;
}

static uint8_t *
slanted(const struct rad_filter_shape *s, int (*noise)(int i))
{
    uint8_t *rgbe = malloc(4 * (size_t)s->width * (size_t)s->height);

    ck_assert_ptr_nonnull(rgbe);
    for (int i = 0; i < s->width * s->height; i++) {
        bool lamp = is_lamp(i % s->width, i / s->width, s->oversample);
        struct rad_rgb L =
            lamp ? rad_rgb(LAMP, LAMP / 2, LAMP / 4) : rad_grey(WALL);

        rad_rgbe(rad_rgb_scale(L, noise ? 1 + .03f * (float)noise(i) : 1),
                 rgbe + 4 * i);
    }
    return rgbe;
}

static struct rad_filter_shape
shape(int n)
{
    return (struct rad_filter_shape){ .width = WIDTH * n,
                                      .height = LINES * n,
                                      .oversample = n };
}

/* Pull row after row; the pixels, and the edges of all rows coded as in a file.
 */
static void
filter(int n, const uint8_t *rgbe, struct rad_rgb *pixels,
       struct rad_memory_out *edges)
{
    struct rad_filter_shape s = shape(n);
    struct rad_edge edge[WIDTH];
    uint8_t code[RAD_EDGE_ROW_BYTES(WIDTH) + RAD_EDGE_END_BYTES];
    struct rad_filter *f;
    int row = 0, count;

    ck_assert_int_eq(edges ? rad_filter_new_edges(&f, &s, NULL)
                           : rad_filter_new(&f, &s, NULL),
                     0);
    for (int y = 0; y < s.height; y++) {
        rad_filter_push(f, rgbe + 4 * (size_t)y * (size_t)s.width);
        if (!edges) {
            while (rad_filter_pull(f, pixels + row * WIDTH))
                row++;
            continue;
        }
        while ((count = rad_filter_pull_edges(f, edge)) >= 0) {
            size_t len = rad_edge_encode_row(edge, count, code);

            ck_assert_int_eq(rad_memory_add(edges, code, len, NULL), 0);
            row++;
        }
    }
    ck_assert_int_eq(row, LINES);
    rad_filter_free(f);
    if (edges) {
        rad_edge_encode_end(edges->len, code);
        rad_memory_add(edges, code, RAD_EDGE_END_BYTES, NULL);
    }
}

static void
read_edges(const struct rad_memory_out *file, struct rad_edge_rows *e)
{
    ck_assert_int_eq(
        rad_edges_read(file->bytes, file->len, WIDTH, LINES, e, NULL), 0);
}

static int
some_noise(int i)
{
    return (int)(rad_mix64((uint64_t)i) % 3) - 1;
}

/* Both sides have their own radiance, and the pixel is their mean by the share,
 * for which a byte has to do. */
RANGE_TEST(sides_are_told_apart, 2, 6)
{
    int n = _i, found = 0;
    struct rad_filter_shape s = shape(n);
    uint8_t *rgbe = slanted(&s, some_noise);
    static struct rad_rgb pixels[WIDTH * LINES];
    struct rad_memory_out file = { 0 };
    struct rad_edge_rows e;

    filter(n, rgbe, pixels, NULL);
    filter(n, rgbe, NULL, &file);
    read_edges(&file, &e);
    for (int y = 0; y < LINES; y++)
        for (int i = 0; i < rad_edges_count(&e, y); i++) {
            struct rad_edge edge;
            float mean;

            rad_edges_get(&e, y, i, &edge);
            ck_assert_float_eq_tol(edge.bright.r, LAMP, .04f * LAMP);
            ck_assert_float_eq_tol(edge.bright.b, LAMP / 4, .05f * LAMP / 4);
            ck_assert_float_eq_tol(edge.dark.r, WALL, .04f * WALL);
            mean = edge.share * edge.bright.r + (1 - edge.share) * edge.dark.r;
            ck_assert_float_eq_tol(pixels[y * WIDTH + edge.x].r, mean,
                                   LAMP * (1.1f / 255 + .01f));
            found++;
        }
    /* the line crosses all columns; the filter is some pixels wide */
    ck_assert_int_ge(found, WIDTH);
    ck_assert_int_le(found, 5 * WIDTH);
    rad_edges_release(&e);
    free(file.bytes);
    free(rgbe);
}

/* A screen's steps are finest where it is dark: of a lamp in the night no halo
 * must be left where the filter ends. */
TEST(small_shares_are_kept_most_exactly)
{
    static const float share[] = { 1e-5f, 1e-4f, .001f, .02f, .5f, .9999f };

    for (int i = 0; i < N_ELEM(share); i++) {
        uint8_t code[RAD_EDGE_ROW_BYTES(1) + RAD_EDGE_END_BYTES];
        struct rad_edge edge = { 0, share[i], rad_grey(LAMP), rad_grey(0) };
        size_t len = rad_edge_encode_row(&edge, 1, code);
        struct rad_edge_rows e;

        rad_edge_encode_end(len, code + len);
        ck_assert_int_eq(rad_edges_read(code, sizeof code, 1, 1, &e, NULL), 0);
        ck_assert_int_eq(rad_edges_count(&e, 0), 1);
        rad_edges_get(&e, 0, 0, &edge);
        ck_assert_float_eq_tol(sqrtf(edge.share), sqrtf(share[i]), 1 / 255.f);
        rad_edges_release(&e);
    }
}

TEST(what_is_alike_has_no_edges)
{
    struct rad_filter_shape s = shape(3);
    uint8_t *rgbe = slanted(&s, some_noise);
    struct rad_memory_out file = { 0 };
    struct rad_edge_rows e;

    for (int i = 0; i < s.width * s.height; i++)
        rad_rgbe(rad_grey(WALL * (1 + .3f * (float)some_noise(i))),
                 rgbe + 4 * i);
    filter(3, rgbe, NULL, &file);
    read_edges(&file, &e);
    for (int y = 0; y < LINES; y++)
        ck_assert_int_eq(rad_edges_count(&e, y), 0);
    rad_edges_release(&e);
    free(file.bytes);
    free(rgbe);
}

/* A picture's file of WIDTH by LINES pixels, with edges. */
static struct rad_memory_out
picture_file(double exposure)
{
    struct rad_filter_shape s = shape(2);
    uint8_t *rgbe = slanted(&s, NULL), code[RAD_HDR_ROW_BYTES(WIDTH)];
    static struct rad_rgb pixels[WIDTH * LINES];
    struct rad_memory_out file = { 0 }, edges = { 0 };
    char head[200];

    filter(2, rgbe, pixels, NULL);
    filter(2, rgbe, NULL, &edges);
    snprintf(head, sizeof head,
             "#?RADIANCE\nEXPOSURE=%g\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n",
             exposure, LINES, WIDTH);
    rad_memory_add(&file, head, strlen(head), NULL);
    for (int y = 0; y < LINES; y++)
        rad_memory_add(&file, code,
                       rad_hdr_encode_row(pixels + y * WIDTH, WIDTH, code),
                       NULL);
    ck_assert_uint_eq(rad_edge_begin(file.bytes, file.len), file.len);
    rad_memory_add(&file, edges.bytes, edges.len, NULL);
    ck_assert_uint_eq(rad_edge_begin(file.bytes, file.len),
                      file.len - edges.len);
    free(edges.bytes);
    free(rgbe);
    return file;
}

static bool
has_edges(const struct rad_memory_out *file)
{
    struct rad_picture pic;
    bool has;

    ck_assert_int_eq(
        rad_hdr_read(file->bytes, file->len, WIDTH * LINES, &pic, NULL), 0);
    has = pic.edges.row != NULL;
    rad_picture_release(&pic);
    return has;
}

TEST(a_picture_brings_its_edges)
{
    struct rad_memory_out file = picture_file(1), exposed = picture_file(2);

    ck_assert(has_edges(&file));
    ck_assert(!has_edges(&exposed));
    free(file.bytes);
    free(exposed.bytes);
}

/* The picture is there whatever stands behind it. */
TEST(damaged_edges_are_none)
{
    struct rad_memory_out file = picture_file(1);
    size_t begin = rad_edge_begin(file.bytes, file.len);
    size_t count = file.len - RAD_EDGE_END_BYTES + 7;

    for (size_t k = 1; k < file.len - begin; k += 7) {
        struct rad_memory_out cut = { file.bytes, file.len - k, 0 };

        ck_assert(!has_edges(&cut));
    }
    file.bytes[begin]++; /* more edges in the first row than there are */
    ck_assert(!has_edges(&file));
    file.bytes[begin]--;
    ck_assert(has_edges(&file));
    file.bytes[count]--; /* one byte fewer than there are */
    ck_assert(!has_edges(&file));
    memset(file.bytes + file.len - RAD_EDGE_END_BYTES, 255, 8);
    ck_assert_uint_eq(rad_edge_begin(file.bytes, file.len), file.len);
    ck_assert(!has_edges(&file));
    free(file.bytes);
}

/* An edge's pixel lies between what is shown of its sides by their shares, and
 * is not as white as the lamp wherever a part of the lamp is in it. */
LOOP_TEST(a_pixel_is_the_mean_of_what_is_shown, 3)
{
    static const struct rad_tone_options all[] = {
        { RAD_TONE_PHOTOGRAPHIC, true, 1, false },
        { RAD_TONE_LINEAR, true, 1, false },
        { RAD_TONE_HUMAN, false, 1, false },
    };
    struct rad_memory_out file = picture_file(1);
    static struct rad_rgb row[LINES][WIDTH];
    struct rad_tone tone = { 0 };
    struct rad_picture pic;
    struct rad_toner t;
    float lamp, wall;

    ck_assert_int_eq(
        rad_hdr_read(file.bytes, file.len, WIDTH * LINES, &pic, NULL), 0);
    ck_assert_int_eq(rad_toner_init(&t, &all[_i], &tone, &pic, NULL, NULL), 0);
    t.tone.human.veil = false; /* it differs from place to place */
    for (int y = 0; y < LINES; y++)
        rad_toner_row(&t, y, row[y]);
    lamp = row[0][0].r;
    wall = row[LINES - 1][WIDTH - 1].r;
    ck_assert_float_lt(wall, .95f * lamp);
    for (int y = 0; y < LINES; y++)
        for (int i = 0; i < rad_edges_count(&pic.edges, y); i++) {
            struct rad_edge e;

            rad_edges_get(&pic.edges, y, i, &e);
            ck_assert_float_eq_tol(row[y][e.x].r,
                                   e.share * lamp + (1 - e.share) * wall, 1e-5);
        }
    rad_toner_release(&t);
    rad_picture_release(&pic);
    free(file.bytes);
}
