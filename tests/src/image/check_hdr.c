/* check_hdr.c - RGBE: rounding, coding, headers, damaged pictures */
#include "config.h"

#include "base/rng.h"
#include "image/hdr.h"
#include "picture/quincunx.h"
#include "tests/unit.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A file in memory. */
struct file {
    uint8_t *data;
    size_t len;
};

static int
append(void *arg, const void *data, size_t len, struct rad_error *err)
{
    struct file *f = arg;

    (void)err;
    f->data = realloc(f->data, f->len + len + 1);
    ck_assert_ptr_nonnull(f->data);
    memcpy(f->data + f->len, data, len);
    f->len += len;
    return 0;
}

static struct file
write_picture(const struct rad_hdr_info *info, const struct rad_rgb *L)
{
    struct file f = { NULL, 0 };
    struct rad_sink sink = { append, &f };
    uint8_t *row = malloc(RAD_HDR_ROW_BYTES(info->width));

    ck_assert_ptr_nonnull(row);
    ck_assert_int_eq(rad_hdr_write_header(info, &sink, NULL), 0);
    for (int y = 0; y < info->height; y++) {
        size_t n = rad_hdr_encode_row(L + y * info->width, info->width, row);

        ck_assert_uint_le(n, RAD_HDR_ROW_BYTES(info->width));
        append(&f, row, n, NULL);
    }
    free(row);
    return f;
}

static const struct {
    struct rad_rgb L;
    uint8_t rgbe[4];
} codes[] = {
    { { 0, 0, 0 }, { 0, 0, 0, 0 } },
    { { 1, 1, 1 }, { 128, 128, 128, 129 } },
    { { 1, .5f, .25f }, { 128, 64, 32, 129 } },
    { { .999f, 0, 0 }, { 255, 0, 0, 128 } }, /* cut off, not rounded */
    { { 1e-33f, 0, 0 }, { 0, 0, 0, 0 } },
    { { -1, 2, -3 }, { 0, 128, 0, 130 } },
    { { NAN, 2, 1 }, { 0, 128, 64, 130 } },
    { { NAN, NAN, NAN }, { 0, 0, 0, 0 } },
    { { INFINITY, 0, 0 }, { 255, 0, 0, 255 } },
    { { 3.4e38f, 1e38f, 0 }, { 255, 150, 0, 255 } },
};

LOOP_TEST(mantissas_are_cut_off, N_ELEM(codes))
{
    uint8_t rgbe[4];

    rad_rgbe(codes[_i].L, rgbe);
    ck_assert_mem_eq(rgbe, codes[_i].rgbe, 4);
}

/* One component of n pixels from a coded row; returns what follows. */
static const uint8_t *
decode(const uint8_t *at, uint8_t *c, int n)
{
    for (int i = 0; i < n;) {
        int run = *at > 128, k = run ? *at - 128 : *at;

        at++;
        ck_assert_int_le(k, n - i);
        for (; k > 0; k--, at += !run)
            c[i++] = *at;
        at += run;
    }
    return at;
}

/* Rows are coded many pixels at a time. */
TEST(rows_hold_what_each_pixel_has_alone)
{
    struct rad_rgb L[53];
    uint8_t row[RAD_HDR_ROW_BYTES(N_ELEM(L))], c[4][N_ELEM(L)], rgbe[4];
    const uint8_t *at = row + 4;
    struct rad_pixel p[N_ELEM(L)];
    uint8_t same[sizeof row];
    size_t n;

    for (int x = 0; x < N_ELEM(L); x++) {
        L[x] = codes[x % N_ELEM(codes)].L;
        if (x % 3 == 1)
            L[x] = rad_rgb(L[x].b, L[x].r, L[x].g);
        if (x % 7 == 6)
            L[x] = rad_grey(ldexpf(1.3f, 5 * x - 130));
    }
    n = rad_hdr_encode_row(L, N_ELEM(L), row);
    for (int k = 0; k < 4; k++)
        at = decode(at, c[k], N_ELEM(L));
    for (int x = 0; x < N_ELEM(L); x++)
        p[x] = (struct rad_pixel){ L[x], (float)x };
    ck_assert_uint_eq(rad_hdr_encode_pixels(p, N_ELEM(p), same), n);
    ck_assert_mem_eq(same, row, n);
    for (int x = 0; x < N_ELEM(L); x++) {
        rad_rgbe(L[x], rgbe);
        for (int k = 0; k < 4; k++)
            ck_assert_uint_eq(c[k][x], rgbe[k]);
    }
}

static const int row_widths[] = { 1, 7, 8, 300, 32767, 32768 };

/* The bytes of a row are found again, with anything behind it, and not where
 * one is missing or a count is wrong. */
LOOP_TEST(a_coded_row_tells_where_it_ends, N_ELEM(row_widths))
{
    int width = row_widths[_i];
    struct rad_rgb *L = calloc((size_t)width, sizeof *L);
    uint8_t *row = malloc(RAD_HDR_ROW_BYTES(width));
    uint8_t *again = malloc(RAD_HDR_ROW_BYTES(width));
    uint8_t *rgbe = malloc(4 * (size_t)width + 4), one[4];
    bool flat = width < 8 || width > 32767;
    size_t n;

    ck_assert(L && row && again && rgbe);
    for (int x = 0; x < width; x++)
        L[x] = rad_grey((float)(x % 97 < 40 ? 1 : x));
    n = rad_hdr_encode_row(L, width, row);
    ck_assert_uint_le(n, RAD_HDR_CODED_BYTES(width));
    ck_assert_uint_eq(rad_hdr_row_bytes(row, n, width), n);
    ck_assert_uint_eq(rad_hdr_row_bytes(row, n + 7, width), n);
    ck_assert_uint_eq(rad_hdr_row_bytes(row, n - 1, width), 0);
    ck_assert_uint_eq(rad_hdr_row_bytes(row, 0, width), 0);
    ck_assert(flat || rad_hdr_row_bytes(row, n, width + 1) == 0);
    /* and decodes to the pixels that it was made of, and these to it */
    ck_assert_uint_eq(rad_hdr_decode_row(row, n + 7, width, rgbe), n);
    for (int x = 0; x < width; x++) {
        rad_rgbe(L[x], one);
        ck_assert_mem_eq(rgbe + 4 * x, one, 4);
    }
    ck_assert_uint_eq(rad_hdr_encode_rgbe(rgbe, width, again), n);
    ck_assert_mem_eq(row, again, n);
    ck_assert_uint_eq(rad_hdr_decode_row(row, n - 1, width, rgbe), 0);
    ck_assert(flat || rad_hdr_decode_row(row, n, width + 1, rgbe) == 0);
    for (int i = 0; i < 2 && !flat; i++) { /* no mark of a coded row */
        row[i] = 3;
        ck_assert_uint_eq(rad_hdr_row_bytes(row, n, width), 0);
        ck_assert_uint_eq(rad_hdr_decode_row(row, n, width, rgbe), 0);
        row[i] = 2;
    }
    row[4] = 0; /* a count of none */
    ck_assert(flat || rad_hdr_row_bytes(row, n, width) == 0);
    ck_assert(flat || rad_hdr_decode_row(row, n, width, rgbe) == 0);
    row[4] = 255; /* more than what is left at the end of a component */
    ck_assert(flat || width > 127 || rad_hdr_row_bytes(row, n, width) == 0);
    free(L);
    free(row);
    free(again);
    free(rgbe);
}

TEST(reading_adds_half_a_step)
{
    static const uint8_t one[4] = { 128, 64, 0, 129 };
    static const uint8_t none[4] = { 5, 5, 5, 0 };
    struct rad_rgb L = rad_rgbe_radiance(one);

    ck_assert_float_eq(L.r, 128.5f / 128);
    ck_assert_float_eq(L.g, 64.5f / 128);
    ck_assert_float_eq(L.b, .5f / 128);
    ck_assert(rad_rgb_black(rad_rgbe_radiance(none)));
}

/* Pixels with runs of all lengths, long literals, and short rows. */
static struct rad_rgb
pattern(int kind, int x, int y)
{
    uint64_t key = rad_key_pixel(3, 0, (uint32_t)x, (uint32_t)y);

    switch (kind) {
    case 0:
        return rad_grey(.25f);
    case 1: /* noise */
        return rad_rgb((float)rad_rand(key, 0), (float)rad_rand(key, 1),
                       (float)rad_rand(key, 2) * 100);
    case 2: /* runs that grow */
        return rad_grey((float)(1 + (int)sqrt(2. * x) % 7));
    default: /* runs of 3 and 4 between single pixels */
        return rad_grey((float)("aaaabcccddddefgh"[x % 16]));
    }
}

/* A stream that gives at most three bytes at a time. */
static long
read_pieces(void *arg, void *buf, size_t n, struct rad_error *err)
{
    struct rad_stream in = rad_memory_stream(arg);
    size_t left = ((struct rad_memory_in *)arg)->left;

    return in.read(in.arg, buf, n < 1 + left % 3 ? n : 1 + left % 3, err);
}

/* What is read from a stream is that which is read from memory, maybe an
 * error. */
static void
stream_is_as_memory(const uint8_t *data, size_t len, size_t most)
{
    struct rad_coded_picture whole, pic;
    struct rad_error want = { 0 };
    int rc = rad_hdr_read_coded(data, len, most, &whole, &want);

    for (int kept = 0; kept < 2; kept++) {
        struct rad_memory_in from = { data, len };
        struct rad_stream in = { read_pieces, &from };
        struct rad_error err = { 0 };

        ck_assert_int_eq(rad_hdr_stream_coded(&in, most, kept == 1, &pic, &err),
                         rc);
        ck_assert_str_eq(err.what, want.what);
        ck_assert(pic.width == whole.width && pic.height == whole.height);
        if (rc == 0 && kept)
            ck_assert_mem_eq(pic.rgbe, whole.rgbe,
                             4 * (size_t)pic.width * (size_t)pic.height);
        else
            ck_assert_ptr_null(pic.rgbe);
        rad_coded_picture_release(&pic);
    }
    rad_coded_picture_release(&whole);
}

static const int widths[] = { 1, 2, 7, 8, 9, 127, 128, 129, 400, 32767, 32768 };

LOOP_TEST(pictures_come_back_as_written, 4 * N_ELEM(widths))
{
    int width = widths[_i / 4], kind = _i % 4, height = 3;
    struct rad_hdr_info info = { .program = "radsubmit",
                                 .options = "-ab 0",
                                 .view = "-vtv",
                                 .pixaspect = 1,
                                 .width = width,
                                 .height = height };
    size_t n = (size_t)width * (size_t)height;
    struct rad_rgb *L = malloc(n * sizeof *L);
    struct rad_picture pic;
    struct file f;

    for (size_t i = 0; i < n; i++)
        L[i] = pattern(kind, (int)(i % (size_t)width), (int)i / width);
    f = write_picture(&info, L);
    ck_assert_int_eq(rad_hdr_read(f.data, f.len, n, &pic, NULL), 0);
    ck_assert(pic.width == width && pic.height == height);
    for (size_t i = 0; i < n; i++) {
        uint8_t want[4], got[4];

        rad_rgbe(L[i], want);
        rad_rgbe(pic.L[i], got);
        ck_assert_mem_eq(got, want, 4);
    }
    if (kind == 0 && width == 400)
        ck_assert_uint_lt(f.len, 300); /* runs were coded as runs */
    rad_picture_release(&pic);
    stream_is_as_memory(f.data, f.len, n);
    stream_is_as_memory(f.data, f.len - 1, n);
    ck_assert_int_eq(rad_hdr_read(f.data, f.len, n - 1, &pic, NULL), RAD_EDATA);
    ck_assert_int_eq(rad_hdr_read(f.data, f.len - 1, n, &pic, NULL), RAD_EDATA);
    ck_assert_ptr_null(pic.L);
    free(f.data);
    free(L);
}

TEST(header_holds_options_and_view)
{
    struct rad_hdr_info info = { .origin = "SCENE= a.rad\n",
                                 .software = "radd 1",
                                 .program = "radsubmit",
                                 .options = "-ps 1",
                                 .view = "-vtv -vp 0 0 0",
                                 .pixaspect = .5,
                                 .frame = 7,
                                 .width = 1,
                                 .height = 1 };
    struct rad_rgb L = rad_grey(1);
    struct file f = write_picture(&info, &L);
    static const char want[] =
        "#?RADIANCE\nSCENE= a.rad\nradsubmit -ps 1\nSOFTWARE= radd 1\n"
        "VIEW= -vtv -vp 0 0 0\n"
        "PIXASPECT=0.500000\nFRAME=7\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n"
        "\x80\x80\x80\x81";

    ck_assert_uint_eq(f.len, sizeof want - 1);
    ck_assert_mem_eq(f.data, want, f.len);
    free(f.data);
}

TEST(header_says_what_the_numbers_are)
{
    static const struct {
        const char *options, *lines;
    } colour[] = {
        { "-ps 1 -pXYZ -dt 0", "\nFORMAT=32-bit_rle_xyze\n" },
        { "-pc .7 .3 .2 .7 .1 .1 .3 .4 -dt 0",
          "\nPRIMARIES= 0.7000 0.3000 0.2000 0.7000 0.1000 0.1000 0.3000 "
          "0.4000\nFORMAT=32-bit_rle_rgbe\n" },
        { "-ae -pXYZy -x 1", "\nFORMAT=32-bit_rle_rgbe\n" },
    };

    for (int i = 0; i < N_ELEM(colour); i++) {
        struct rad_hdr_info info = { .program = "radsubmit",
                                     .options = colour[i].options,
                                     .view = "-vtv",
                                     .pixaspect = 1,
                                     .width = 1,
                                     .height = 1 };
        struct rad_rgb L = rad_grey(1);
        struct file f = write_picture(&info, &L);
        char text[400] = "";

        memcpy(text, f.data, f.len - 4 < 399 ? f.len - 4 : 399);
        ck_assert_ptr_nonnull(strstr(text, colour[i].lines));
        free(f.data);
    }
}

TEST(tristimulus_values_are_read_as_rgb)
{
    struct rad_hdr_info info = { .program = "radsubmit",
                                 .options = "-pXYZ",
                                 .view = "-vtv",
                                 .pixaspect = 1,
                                 .width = 1,
                                 .height = 1 };
    struct rad_rgb want = rad_rgb(.5f, 2, 1), L = rad_rgb_to_xyz(want);
    struct file f = write_picture(&info, &L);
    struct rad_coded_picture coded;
    struct rad_picture pic;

    ck_assert_int_eq(rad_hdr_read(f.data, f.len, 1, &pic, NULL), 0);
    ck_assert_float_eq_tol(pic.L[0].r, want.r, .04f);
    ck_assert_float_eq_tol(pic.L[0].g, want.g, .02f);
    ck_assert_float_eq_tol(pic.L[0].b, want.b, .02f);
    rad_picture_release(&pic);
    ck_assert_int_eq(rad_hdr_read_coded(f.data, f.len, 1, &coded, NULL),
                     RAD_EDATA);
    free(f.data);
}

/* Two by three pixels, numbered 1 to 6 in the order of the file, as flat
 * pixels of value n + .5; where pixel 1 and 2 end up. */
static const struct {
    const char *resolution;
    int width, first, second;
} orientations[] = {
    { "-Y 2 +X 3", 3, 0, 1 }, { "-Y 2 -X 3", 3, 2, 1 },
    { "+Y 2 +X 3", 3, 3, 4 }, { "+Y 2 -X 3", 3, 5, 4 },
    { "+X 2 -Y 3", 2, 0, 2 }, { "-X 2 -Y 3", 2, 1, 3 },
    { "+X 2 +Y 3", 2, 4, 2 }, { "-X 2 +Y 3", 2, 5, 3 },
};

LOOP_TEST(orientation_is_undone, N_ELEM(orientations))
{
    struct file f = { NULL, 0 };
    struct rad_picture pic;
    char head[64];
    int n = snprintf(head, sizeof head, "#?RADIANCE\n\n%s\n",
                     orientations[_i].resolution);

    append(&f, head, (size_t)n, NULL);
    for (uint8_t k = 1; k <= 6; k++) {
        uint8_t rgbe[4] = { k, k, k, 136 };

        append(&f, rgbe, 4, NULL);
    }
    /* 1,1,1 is an old run at the start of a row: use 1,1,2 */
    f.data[n + 2] = 2;
    ck_assert_int_eq(rad_hdr_read(f.data, f.len, 6, &pic, NULL), 0);
    stream_is_as_memory(f.data, f.len, 6);
    ck_assert_int_eq(pic.width, orientations[_i].width);
    ck_assert_float_eq(pic.L[orientations[_i].first].r, 1.5f);
    ck_assert_float_eq(pic.L[orientations[_i].second].r, 2.5f);
    rad_picture_release(&pic);
    free(f.data);
}

#define HEAD "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n"

TEST(exposure_and_colour_correction_are_undone)
{
    static const char text[] = "#?RGBE\nEXPOSURE=2\nEXPOSURE= 4\n"
                               "COLORCORR= 1 2 .5\nPIXASPECT=2\n\n"
                               "-Y 1 +X 1\n\x80\x80\x80\x81";
    struct rad_picture pic;

    ck_assert_int_eq(
        rad_hdr_read((const uint8_t *)text, sizeof text - 1, 1, &pic, NULL), 0);
    ck_assert_float_eq(pic.L[0].r, 128.5f / 128 / 8);
    ck_assert_float_eq(pic.L[0].g, 128.5f / 128 / 16);
    ck_assert_float_eq(pic.L[0].b, 128.5f / 128 / 4);
    ck_assert_double_eq(pic.pixaspect, 2);
    rad_picture_release(&pic);
}

static const struct {
    const char *line;
    bool irradiance;
} commands[] = {
    { "rpict -x 1 -y 1", false },
    { "rpict -i -x 1", true },
    { "rpict -i+ -i", false },
    { "radsubmit -x 1 -i+ -u-", true },
    { "radsubmit --points -I+ -fac -i- -u-", true }, /* sensors */
    { "radsubmit --points -I- -fac -i- -u-", false },
    { "rtrace -I -fac -x 1 -y 1", true },
    { "rtrace -fac -x 1 -y 1 -in", false },
    { "\trpict -i", false }, /* of another picture */
    { "pcomb -i", false },
};

LOOP_TEST(commands_say_whether_a_picture_is_of_irradiance, N_ELEM(commands))
{
    struct rad_picture pic;
    char text[200];
    int n = snprintf(text, sizeof text,
                     "#?RADIANCE\n%s\nFORMAT=32-bit_rle_rgbe\n\n"
                     "-Y 1 +X 1\n\x80\x80\x80\x81",
                     commands[_i].line);

    ck_assert_int_eq(
        rad_hdr_read((const uint8_t *)text, (size_t)n, 1, &pic, NULL), 0);
    ck_assert_int_eq(pic.irradiance, commands[_i].irradiance);
    rad_picture_release(&pic);
}

/* As Radiance 1 wrote it. */
TEST(oldest_header_is_read)
{
    static const char text[] = "rpict -x 1 -y 1\nEXPOSURE=2\n\n"
                               "-Y 1 +X 1\n\x80\x80\x80\x81";
    struct rad_picture pic;

    ck_assert_int_eq(
        rad_hdr_read((const uint8_t *)text, sizeof text - 1, 1, &pic, NULL), 0);
    ck_assert_float_eq(pic.L[0].r, 128.5f / 128 / 2);
    rad_picture_release(&pic);
}

TEST(old_runs_are_read)
{
    /* one pixel, 2 repeats, then 1 + 1*256 repeats */
    static const char text[] = HEAD "-Y 1 +X 261\n\x80\x40\x20\x81\1\1\1\2"
                                    "\x40\x40\x40\x81\1\1\1\1\1\1\1\1";
    struct rad_picture pic;
    struct rad_error err = { 0 };

    ck_assert_msg(rad_hdr_read((const uint8_t *)text, sizeof text - 1, 1000,
                               &pic, &err) == 0,
                  "%s", err.what);
    ck_assert_float_eq(pic.L[2].r, 128.5f / 128);
    ck_assert_float_eq(pic.L[3].r, 64.5f / 128);
    ck_assert_float_eq(pic.L[260].r, 64.5f / 128);
    rad_picture_release(&pic);
}

#define BAD(text)                                                              \
    {                                                                          \
        text, sizeof(text) - 1                                                 \
    }

static const struct {
    const char *text;
    size_t len;
} bad[] = {
    BAD(""),
    BAD("P6\n1 1\n"),
    BAD("#?RADIANCE\n"),
    BAD(HEAD),
    BAD(HEAD "-Y 1 +X 1"),
    BAD(HEAD "-Y 1 +X 1\n"),
    BAD(HEAD "-Y 1 +X 1\nabc"),
    BAD(HEAD "-Y 0 +X 1\nabcd"),
    BAD(HEAD "-Y -1 +X 1\nabcd"),
    BAD(HEAD "-Y 1 +Y 1\nabcd"),
    BAD(HEAD "-Y 1 +X\nabcd"),
    BAD(HEAD "-Y 1 +X 1 2\nabcd"),
    BAD(HEAD "- 1 + 1\nabcd"),
    BAD(HEAD "-Y 999999999 +X 999999999\nabcd"),
    BAD(HEAD "-Y 1 +X 2\n\1\1\1\1abcd"), /* run of nothing */
    BAD(HEAD "-Y 1 +X 2\nabcd\1\1\1\2"), /* run too long */
    BAD(HEAD "-Y 1 +X 2\nabcd\1\1\1\0\1\1\1\0\1\1\1\0\1\1\1\1"),
    BAD(HEAD "-Y 1 +X 8\n\2\2\0\7abcdefgh"), /* another length */
    BAD(HEAD "-Y 1 +X 8\n\2\2\0\10\211a"),   /* run past the end */
    BAD(HEAD "-Y 1 +X 8\n\2\2\0\10\11abcdefghi"),
    BAD(HEAD "-Y 1 +X 8\n\2\2\0\10\0"),              /* no length */
    BAD(HEAD "-Y 1 +X 8\n\2\2\0\10\10abc"),          /* ends in a literal */
    BAD(HEAD "-Y 1 +X 8\n\2\2\0\10\210a\210b\210c"), /* a component less */
    BAD("#?RADIANCE\nFORMAT=32-bit_rle_spec\n\n-Y 1 +X 1\nabcd"),
    BAD("#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 1\nabcd"),
    BAD("#?RADIANCE\nEXPOSURE=nan\n\n-Y 1 +X 1\nabcd"),
    BAD("#?RADIANCE\nEXPOSURE=1e200\nEXPOSURE=1e200\n\n-Y 1 +X 1\nabcd"),
    BAD("#?RADIANCE\nCOLORCORR=1 1\n\n-Y 1 +X 1\nabcd"),
};

LOOP_TEST(damaged_pictures_are_refused, N_ELEM(bad))
{
    struct rad_picture pic;
    struct rad_error err = { 0 };
    /* an exact copy, so that sanitizers see a read past the end */
    uint8_t *copy = malloc(bad[_i].len + 1);

    memcpy(copy + 1, bad[_i].text, bad[_i].len);
    ck_assert_int_eq(rad_hdr_read(copy + 1, bad[_i].len, 1000, &pic, &err),
                     RAD_EDATA);
    ck_assert_ptr_null(pic.L);
    ck_assert(err.what[0] != '\0');
    stream_is_as_memory(copy + 1, bad[_i].len, 1000);
    free(copy);
}

static long
fail_to_read(void *arg, void *buf, size_t n, struct rad_error *err)
{
    (void)arg, (void)buf, (void)n;
    return rad_fail(err, RAD_EIO, "the disk is gone");
}

TEST(a_stream_that_fails_is_told)
{
    struct rad_stream in = { fail_to_read, NULL };
    struct rad_coded_picture pic;
    struct rad_error err = { 0 };

    ck_assert_int_lt(rad_hdr_stream_coded(&in, 1, true, &pic, &err), 0);
    ck_assert_int_eq(err.code, RAD_EIO);
    ck_assert_str_eq(err.what, "the disk is gone");
}
