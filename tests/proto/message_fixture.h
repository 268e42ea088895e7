/* message_fixture.h - a job's specification, and messages to bytes and back,
 * for tests */
#ifndef RADD_TESTS_MESSAGE_FIXTURE_H
#define RADD_TESTS_MESSAGE_FIXTURE_H

#include "proto/frame.h"
#include "tests/unit.h"

#include <string.h>

#define MOST 4096 /* bytes of an example frame */

static const uint8_t ID[MSG_HASH] = { 0x10, 0x11, 0x12, 0x13, 0x14, 0x15, 0x16,
                                      0x17, 0x18, 0x19, 0x1a, 0x1b, 0x1c, 0x1d,
                                      0x1e, 0x1f, 0x20, 0x21, 0x22, 0x23, 0x24,
                                      0x25, 0x26, 0x27, 0x28, 0x29, 0x2a, 0x2b,
                                      0x2c, 0x2d, 0x2e, 0x2f };
static const uint8_t two_hashes[2 * MSG_HASH] = { 1, [MSG_HASH] = 2 };
static const struct msg_frame frames[] = {
    { 0, 640, 480, "-vtv -vp 1 2 3" },
    { 7, 1, 65535, "" },
};
static const uint8_t costs[2 * 4] = { 0x3f, 0x80, [4] = 0x40 };

#define SPEC                                                                   \
    {                                                                          \
        .job = ID, .manifest = ID, .name = "office", .params = "-ab 2",        \
        .origin = "oconv room.rad\nSCENE= room.oct\n", .needs = "mist glow",   \
        .estimate = "uniform", .ncosts = 2, .costs = costs, .seed = 1,         \
        .priority = -3, .flags = MSG_JOB_SHARE, .partition = MSG_PART_WINDOW,  \
        .order = MSG_ORDER_RANDOM, .windows = 64, .objects = 4000,             \
        .bundle_bytes = 1u << 20, .compile_s = .25, .memory_mib = 512,         \
        .oversample = 2, .clamp = 4.5, .error_ppm = 0, .time_ms = 0,           \
        .files = { 2, two_hashes }, .nframes = 2, .frames = frames             \
    }

static inline size_t
pack(const struct msg *m, uint8_t *buf)
{
    struct wire_out out;
    size_t n;

    wire_out_init(&out, MOST);
    ck_assert_int_eq(msg_pack(&out, m), 0);
    n = out.len;
    memcpy(buf, out.buf, n);
    wire_out_release(&out);
    return n;
}

/* From a block of its own size, so that a sanitizer sees any read beyond. */
static inline int
unpack_exactly(uint16_t type, const uint8_t *payload, size_t n, struct msg *m)
{
    uint8_t *copy = malloc(n ? n : 1);
    int rc;

    ck_assert_ptr_nonnull(copy);
    memcpy(copy, payload, n);
    rc = msg_unpack(m, type, 0, copy, n, NULL);
    if (rc == 0) { /* touch all that was lent */
        struct wire_out out;

        wire_out_init(&out, MSG_FRAME_MAX);
        ck_assert_int_eq(msg_pack(&out, m), 0);
        ck_assert_uint_eq(out.len, n + MSG_HEADER);
        ck_assert_mem_eq(out.buf + MSG_HEADER, payload, n);
        wire_out_release(&out);
    }
    free(copy);
    return rc;
}

#endif
