/* check_screen.c - a picture as a screen shows it, as PNG */
#include "config.h"

#include "tone/screen.h"

#include "tests/made_picture.h"

#include <string.h>

static struct rad_memory_out
png_of(int width, int height, int bits)
{
    static const float v[] = { 1, 2, 3, 4, 5, 6 };
    struct rad_picture p = grey(width, height, v);
    struct rad_memory_out out = { 0 };
    struct rad_sink sink = rad_memory_sink(&out);
    struct rad_screen screen;
    struct rad_tone tone = { 0 };

    memset(&screen, 1, sizeof screen);
    rad_screen_init(&screen);
    ck_assert(!screen.tone.absolute && !screen.tone.partial);
    screen.bits = bits;
    ck_assert_int_eq(rad_screen_png(&screen, &tone, &p, NULL, &sink, NULL), 0);
    rad_picture_release(&p);
    return out;
}

TEST(png_has_its_signature_size_and_end)
{
    static const uint8_t start[] = { 0x89, 'P', 'N', 'G', 13,  10,  26,  10,
                                     0,    0,   0,   13,  'I', 'H', 'D', 'R',
                                     0,    0,   0,   3,   0,   0,   0,   2 };

    for (int bits = 8; bits <= 16; bits += 8) {
        struct rad_memory_out out = png_of(3, 2, bits);

        ck_assert_uint_gt(out.len, sizeof start);
        ck_assert_mem_eq(out.bytes, start, sizeof start);
        ck_assert_int_eq(out.bytes[sizeof start], bits);
        ck_assert_int_eq(out.bytes[sizeof start + 1], 2);
        ck_assert_mem_eq(out.bytes + out.len - 8, "IEND\xae\x42\x60\x82", 8);
        free(out.bytes);
    }
}

/* The values that PNG's specification wants beside sRGB; 4-byte lengths and
 * checksums are libpng's. */
TEST(png_says_that_it_is_srgb)
{
    static const struct {
        const char *bytes;
        size_t n;
    } chunk[] = {
        { "sRGB\0", 5 },
        { "gAMA\0\0\261\217", 8 },
        { "cHRM\0\0\172\046\0\0\200\204\0\0\372\0\0\0\200\350\0\0\165\060"
          "\0\0\352\140\0\0\072\230\0\0\027\160",
          36 },
    };
    struct rad_memory_out out = png_of(3, 2, 8);

    for (int i = 0; i < N_ELEM(chunk); i++) {
        bool found = false;

        for (size_t at = 0; at + chunk[i].n <= out.len; at++)
            found |= memcmp(out.bytes + at, chunk[i].bytes, chunk[i].n) == 0;
        ck_assert_msg(found, "%.4s", chunk[i].bytes);
    }
    free(out.bytes);
}
