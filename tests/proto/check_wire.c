/* check_wire.c - bounded reading and writing of fields */
#include "config.h"

#include "tests/unit.h"
#include "proto/wire.h"

#include <string.h>

TEST(fields_are_big_endian_and_come_back)
{
    static const uint8_t want[] = { 0x01, 0x02, 0x03, 0x04, 0x05, 0x06, 0x07,
                                    0xff, 0xff, 0xff, 0xfe, 0x3f, 0x80, 0,
                                    0,    0,    1,    'x',  0 };
    struct wire_out out;
    struct wire_in in;

    wire_out_init(&out, 100);
    wire_put_u8(&out, 1);
    wire_put_u16(&out, 0x0203);
    wire_put_u32(&out, 0x04050607);
    wire_put_i32(&out, -2);
    wire_put_f32(&out, 1);
    wire_put_str(&out, "x", 1);
    ck_assert(!out.bad);
    ck_assert_uint_eq(out.len, sizeof want);
    ck_assert_mem_eq(out.buf, want, sizeof want);
    wire_in_init(&in, want, sizeof want);
    ck_assert_uint_eq(wire_get_u8(&in), 1);
    ck_assert_uint_eq(wire_get_u16(&in), 0x0203);
    ck_assert_uint_eq(wire_get_u32(&in), 0x04050607);
    ck_assert_int_eq(wire_get_i32(&in), -2);
    ck_assert(wire_get_f32(&in) == 1);
    ck_assert_str_eq(wire_get_str(&in, 1), "x");
    ck_assert(!in.bad && wire_left(&in) == 0);
    wire_out_release(&out);
}

/* Else what a reader forgets to set would be any layout. */
TEST(a_reader_begins_with_no_version)
{
    static const uint8_t one[] = { 1 };
    struct wire_in in;

    memset(&in, 0xff, sizeof in);
    wire_in_init(&in, one, 1);
    ck_assert_uint_eq(in.version, 0);
    ck_assert(!in.bad && !in.nomem && wire_left(&in) == 1);
}

TEST(a_read_past_the_end_is_bad_and_stays_bad)
{
    static const uint8_t three[] = { 1, 2, 3 };
    struct wire_in in;

    wire_in_init(&in, three, 3);
    ck_assert_uint_eq(wire_get_u32(&in), 0);
    ck_assert(in.bad);
    ck_assert_uint_eq(wire_get_u8(&in), 0); /* though a byte is left */
    ck_assert(in.bad);
}

TEST(bytes_are_checked_against_both_ends)
{
    static const uint8_t four[] = { 1, 2, 3, 4 };
    uint8_t dst[2] = { 9, 9 };
    struct wire_in in;

    wire_in_init(&in, four, 4);
    wire_get_bytes(&in, dst, 3, sizeof dst); /* there, but does not fit */
    ck_assert(in.bad);
    ck_assert(dst[0] == 9 && dst[1] == 9);
    wire_in_init(&in, four, 1);
    wire_get_bytes(&in, dst, 2, sizeof dst); /* fits, but is not there */
    ck_assert(in.bad);
    ck_assert(dst[0] == 0 && dst[1] == 0);
}

static const struct {
    size_t n;
    const char *bytes; /* a whole string field */
    bool good;
} strings[] = {
    { 3, "\0\0\0", true },
    { 5, "\0\2ab\0", true },
    { 4, "\0\2ab", false },                 /* not ended */
    { 5, "\0\2abc", false },                /* ends with something else */
    { 5, "\0\2a\0\0", false },              /* NUL inside */
    { 5, "\0\2\xc3\xa4\0", true },          /* a umlaut */
    { 5, "\0\2\xc0\x80\0", false },         /* overlong NUL */
    { 4, "\0\1\xc3\0", false },             /* cut sequence */
    { 6, "\0\3\xed\xa0\x80\0", false },     /* surrogate */
    { 7, "\0\4\xf4\x90\x80\x80\0", false }, /* above U+10FFFF */
    { 7, "\0\4\xf0\x9f\x92\xa1\0", true },
    { 9, "\0\6abcdef\0", false }, /* longer than allowed here, 5 */
    { 2, "\xff\xff", false },
};

LOOP_TEST(strings_are_bounded_terminated_utf8, N_ELEM(strings))
{
    struct wire_in in;
    const char *s;

    wire_in_init(&in, strings[_i].bytes, strings[_i].n);
    s = wire_get_str(&in, 5);
    ck_assert_int_eq(!in.bad, strings[_i].good);
    ck_assert_uint_eq(strlen(s), in.bad ? 0 : strings[_i].n - 3);
}

TEST(what_is_not_utf8_goes_out_as_question_marks)
{
    struct wire_out out;

    wire_out_init(&out, 100);
    wire_put_str(&out, "a\xff\xc3\xa4\xc3", 10);
    ck_assert(!out.bad);
    ck_assert_str_eq((const char *)out.buf + 2, "a?\xc3\xa4?");
    wire_put_str(&out, "abc", 2); /* longer than its field */
    ck_assert(out.bad);
    wire_out_release(&out);
}

/* By its own limit, and by what there is; and nothing is read of it then. */
TEST(a_blob_is_bounded_at_both_ends)
{
    static const uint8_t data[] = { 0, 0, 0, 3, 1, 2, 3 };
    struct wire_in in;
    size_t n;

    wire_in_init(&in, data, sizeof data);
    ck_assert_ptr_eq(wire_get_blob(&in, 3, &n), data + 4);
    ck_assert(!in.bad && n == 3);
    wire_in_init(&in, data, sizeof data);
    ck_assert_ptr_null(wire_get_blob(&in, 2, &n));
    ck_assert(in.bad && n == 0);
    wire_in_init(&in, data, sizeof data - 1);
    ck_assert_ptr_null(wire_get_blob(&in, 3, &n));
    ck_assert(in.bad && n == 0);
}

TEST(a_count_is_bounded_by_what_is_left)
{
    static const uint8_t data[] = { 0, 0, 0, 3, 1, 2, 3, 4, 5, 6 };
    static const uint8_t huge[] = { 0xff, 0xff, 0xff, 0xff, 1 };
    struct wire_in in;

    wire_in_init(&in, data, sizeof data);
    ck_assert_uint_eq(wire_get_count(&in, 2, 10), 3);
    ck_assert(!in.bad);
    wire_in_init(&in, data, sizeof data);
    ck_assert_uint_eq(wire_get_count(&in, 3, 10), 0);
    ck_assert(in.bad);
    wire_in_init(&in, data, sizeof data);
    ck_assert_uint_eq(wire_get_count(&in, 2, 2), 0);
    ck_assert(in.bad);
    wire_in_init(&in, huge, sizeof huge);
    ck_assert_uint_eq(wire_get_count(&in, 1, UINT32_MAX), 0);
    ck_assert(in.bad);
}

TEST(output_stops_at_its_limit)
{
    struct wire_out out;

    wire_out_init(&out, 6);
    wire_put_u32(&out, 1);
    wire_put_u32(&out, 2);
    ck_assert(out.bad);
    ck_assert_uint_eq(out.len, 4);
    wire_put_u8(&out, 3); /* would fit, but bad is bad */
    ck_assert_uint_eq(out.len, 4);
    wire_out_release(&out);
}

TEST(floats_keep_their_bits)
{
    static const float v[] = { 0, -0.0f, 1.5f, 3e38f, 1e-45f };
    uint8_t bytes[sizeof v];
    float back[N_ELEM(v)];

    wire_floats_put(bytes, v, N_ELEM(v));
    ck_assert_uint_eq(bytes[8], 0x3f); /* 1.5 = 3fc00000 */
    ck_assert_uint_eq(bytes[9], 0xc0);
    wire_floats_get(back, bytes, N_ELEM(v));
    ck_assert_mem_eq(back, v, sizeof v);
}
