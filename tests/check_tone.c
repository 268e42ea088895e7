/* check_tone.c - tone curves, sRGB, PNG */
#include "config.h"

#include "picture/png.h"
#include "picture/screen.h"
#include "picture/srgb.h"
#include "unit.h"

#include <math.h>
#include <string.h>

/* A grey picture of the values. */
static struct rad_picture
grey(int width, int height, const float *v)
{
    struct rad_picture p = { .width = width, .height = height, .pixaspect = 1 };

    p.L = malloc((size_t)width * (size_t)height * sizeof *p.L);
    ck_assert_ptr_nonnull(p.L);
    for (int i = 0; i < width * height; i++)
        p.L[i] = rad_grey(v[i]);
    return p;
}

START_TEST(srgb_follows_its_standard)
{
    ck_assert_int_eq(rad_srgb(0), 0);
    ck_assert_int_eq(rad_srgb(-1), 0);
    ck_assert_int_eq(rad_srgb(NAN), 0);
    ck_assert_int_eq(rad_srgb(.0031308), 10);
    ck_assert_int_eq(rad_srgb(.2140411), 128 - 1); /* half, 127.5 below */
    ck_assert_int_eq(rad_srgb(1), 255);
    ck_assert_int_eq(rad_srgb(INFINITY), 255);
}
END_TEST

/* The table against the formula, where its steps meet and between. */
START_TEST(table_of_srgb_is_the_curve)
{
    static struct rad_srgb_table t;
    float v;

    rad_srgb_init(&t);
    for (v = 1e-5f; v < 1; v *= 1.0007f) {
        double want =
            v <= .0031308f ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - .055;

        ck_assert_double_eq_tol(rad_srgb_encode(&t, v), want, .05 / 65535);
    }
    ck_assert_float_eq(rad_srgb_encode(&t, 1), 1);
    ck_assert_float_eq(rad_srgb_encode(&t, 2), 1);
    ck_assert_float_eq(rad_srgb_encode(&t, nextafterf(1, 0)), 1);
    ck_assert_float_eq(rad_srgb_encode(&t, 0), 0);
    ck_assert_float_eq(rad_srgb_encode(&t, -1), 0);
    ck_assert_float_eq(rad_srgb_encode(&t, NAN), 0);
}
END_TEST

START_TEST(png_has_its_signature_size_and_end)
{
    static const uint8_t start[] = { 0x89, 'P', 'N', 'G', 13,  10,  26,  10, 0,
                                     0,    0,   13,  'I', 'H', 'D', 'R', 0,  0,
                                     0,    3,   0,   0,   0,   2,   8,   2 };
    static const float v[] = { 1, 2, 3, 4, 5, 6 };
    struct rad_picture p = grey(3, 2, v);
    struct rad_memory_out out = { 0 };
    struct rad_sink sink = rad_memory_sink(&out);

    struct rad_screen screen;
    struct rad_tone tone = { 0 };

    rad_screen_init(&screen);
    ck_assert_int_eq(rad_screen_png(&screen, &tone, &p, NULL, &sink, NULL), 0);
    ck_assert_uint_gt(out.len, sizeof start);
    ck_assert_mem_eq(out.bytes, start, sizeof start);
    ck_assert_mem_eq(out.bytes + out.len - 8, "IEND\xae\x42\x60\x82", 8);
    free(out.bytes);
    rad_picture_release(&p);
}
END_TEST

int
main(void)
{
    Suite *s = suite_create("tone");
    TCase *tc = tcase_create("tone");

    tcase_add_test(tc, srgb_follows_its_standard);
    tcase_add_test(tc, table_of_srgb_is_the_curve);
    tcase_add_test(tc, png_has_its_signature_size_and_end);
    suite_add_tcase(s, tc);
    return unit_run(s);
}
