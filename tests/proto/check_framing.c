/* check_framing.c - messages out of a stream of bytes */
#include "config.h"

#include "message_fixture.h"

static const struct {
    const char *bytes; /* a header */
    const char *what;
} headers[] = {
    { "RADX\0\1\0\0\0\0\0\0\0\0\0\0", "not radd's protocol" },
    { "RADD\3\1\0\0\0\0\0\0\0\0\0\0", "unknown message 769, flags 0" },
    { "RADD\0\1\0\1\0\0\0\0\0\0\0\0", "unknown message 1, flags 1" },
    { "RADD\0\2\0\0\0\0\0\0\0\0\0\0", "unexpected WELCOME" },
    { "RADD\0\1\0\0\0\0\0\0\0\0\4\1", "HELLO of 1025 bytes is too long" },
    { "RADD\0\1\0\0\0\0\0\0\xff\xff\xff\xff",
      "HELLO of 4294967295 bytes is too long" },
};

LOOP_TEST(a_bad_header_is_refused_before_its_body, N_ELEM(headers))
{
    const uint8_t *p = (const uint8_t *)headers[_i].bytes;
    struct frame_reader r;
    struct rad_error err = { 0 };
    struct msg m = { 0 };
    size_t n = MSG_HEADER;

    frame_reader_init(&r, MSG_AT_COORD_NEW);
    ck_assert_int_eq(frame_read(&r, &p, &n, &m, &err), RAD_EPROTO);
    ck_assert_str_eq(err.what, headers[_i].what);
    ck_assert_int_eq(frame_read(&r, &p, &n, &m, NULL), RAD_EPROTO);
    frame_reader_release(&r);
}

LOOP_TEST(frames_come_out_whole_however_they_come_in, 40)
{
    size_t piece = (size_t)_i + 1, total = 0, count = 0;
    uint8_t bytes[MOST];
    struct frame_reader r;
    struct msg m = { 0 };

    for (int k = 0; k < 3; k++) {
        struct msg ping = { .type = MSG_PING, .ping = { (uint64_t)k, 0 } };

        total += pack(&ping, bytes + total);
    }
    frame_reader_init(&r, MSG_AT_PEER);
    for (size_t at = 0; at < total; at += piece) {
        const uint8_t *p = bytes + at;
        size_t n = total - at < piece ? total - at : piece;
        int rc;

        while ((rc = frame_read(&r, &p, &n, &m, NULL)) == 1)
            ck_assert_uint_eq(m.ping.progress, count++);
        ck_assert_int_eq(rc, 0);
        ck_assert_uint_eq(n, 0);
    }
    ck_assert_uint_eq(count, 3);
    frame_reader_release(&r);
    msg_release(&m);
}

TEST(memory_follows_what_came_not_what_was_claimed)
{
    static const char head[] = "RADD\0\54\0\0\0\0\0\0\0\xf\xff\0"; /* RESULT */
    const uint8_t *p = (const uint8_t *)head;
    size_t n = MSG_HEADER;
    struct frame_reader r;
    struct msg m = { 0 };

    frame_reader_init(&r, MSG_AT_PARENT);
    ck_assert_int_eq(frame_read(&r, &p, &n, &m, NULL), 0);
    ck_assert_uint_eq(r.head.length, 0xfff00);
    ck_assert_uint_le(r.cap, 1024);
    frame_reader_release(&r);
}
