/* check_spec.c - what a job's specification may say, and its frames in a file
 */
#include "config.h"

#include "message_fixture.h"

#include <math.h>

/* Where a picture is from is lines of a header: none of them empty. */
LOOP_TEST(an_origin_that_is_no_lines_is_refused, 9)
{
    static const struct {
        const char *origin;
        bool fits;
    } rows[] = {
        { "", true },        { "a\n", true },    { "a\nb\n", true },
        { "a", false },      { "\n", false },    { "a\n\nb\n", false },
        { "a\tb\n", false }, { "a\r\n", false }, { "a\n\x7f\n", false }
    };
    struct msg m = { .type = MSG_SUBMIT, .submit = SPEC };
    struct wire_out out;

    m.submit.origin = rows[_i].origin;
    wire_out_init(&out, 1 << 16);
    ck_assert_int_eq(msg_pack(&out, &m) == 0, rows[_i].fits);
    wire_out_release(&out);
}

/* A spec whose frames lie in a file, with the sizes of SPEC's. */
static struct msg
by_file(void)
{
    struct msg m = { .type = MSG_SUBMIT, .submit = SPEC };

    m.submit.flags |= MSG_JOB_VIEWS;
    m.submit.views = two_hashes;
    for (uint32_t i = 0; i < m.submit.nframes; i++) {
        const struct msg_frame *f = &m.submit.frames[i];

        if (f->width > m.submit.width)
            m.submit.width = f->width;
        if (f->height > m.submit.height)
            m.submit.height = f->height;
    }
    return m;
}

/* A message has no more of many frames than where they are. */
TEST(frames_in_a_file_are_left_out)
{
    struct msg job = by_file(), m = { 0 };
    uint8_t bytes[MOST];
    size_t n = pack(&job, bytes);

    ck_assert_int_eq(
        msg_unpack(&m, MSG_SUBMIT, 0, bytes + MSG_HEADER, n - MSG_HEADER, NULL),
        0);
    ck_assert_ptr_null(m.submit.frames);
    ck_assert_uint_eq(m.submit.ncosts, 0);
    ck_assert_uint_eq(m.submit.nframes, job.submit.nframes);
    ck_assert_uint_eq(m.submit.width, job.submit.width);
    ck_assert_mem_eq(m.submit.views, two_hashes, MSG_HASH);
    msg_release(&m);
}

/* What a file of frames says is taken for what it is, or not at all. */
TEST(a_file_of_frames_is_read_back)
{
    struct msg job = by_file(), list = { 0 };
    struct msg_spec got = { .nframes = job.submit.nframes,
                            .oversample = job.submit.oversample,
                            .width = job.submit.width,
                            .height = job.submit.height };
    struct msg_spec other = got;
    struct wire_out out;

    wire_out_init(&out, MOST);
    ck_assert_int_eq(msg_views_pack(&out, &job.submit), 0);
    ck_assert_mem_eq(out.buf, "RVEW\0\0\0\1", 8);
    ck_assert_int_eq(msg_views_unpack(&list, &got, out.buf, out.len, NULL), 0);
    ck_assert_uint_eq(got.ncosts, job.submit.ncosts);
    ck_assert_mem_eq(got.costs, job.submit.costs, 4 * got.ncosts);
    for (uint32_t i = 0; i < got.nframes; i++) {
        ck_assert_uint_eq(got.frames[i].number, job.submit.frames[i].number);
        ck_assert_uint_eq(got.frames[i].width, job.submit.frames[i].width);
        ck_assert_str_eq(got.frames[i].view, job.submit.frames[i].view);
    }
    other.width++;
    ck_assert_int_eq(msg_views_unpack(&list, &other, out.buf, out.len, NULL),
                     RAD_EDATA);
    for (size_t n = 0; n < out.len; n++) {
        uint8_t *cut = malloc(n + 1);

        memcpy(cut, out.buf, n);
        ck_assert_int_eq(msg_views_unpack(&list, &got, cut, n, NULL),
                         RAD_EDATA);
        free(cut);
    }
    for (size_t i = 0; i < out.len; i++) { /* no matter what, but no harm */
        out.buf[i] ^= 0xff;
        msg_views_unpack(&list, &got, out.buf, out.len, NULL);
        out.buf[i] ^= 0xff;
    }
    msg_release(&list);
    wire_out_release(&out);
}

/* How a picture is filtered, of one that is 4 by 5. */
static const struct {
    uint8_t oversample;
    double clamp;
    bool fine;
} filters[] = {
    { 0, 0, true },     { 1, 0, true },    { 2, 0, true },
    { 8, 0, true },     { 9, 0, false },   { 255, 0, false },
    { 2, 1, true },     { 2, 1000, true }, { 2, .5, false },
    { 2, 1001, false }, { 2, NAN, false }, { 2, -3, false },
    { 1, 2, false },    { 0, 2, false },   { 2, INFINITY, false },
};

LOOP_TEST(a_filter_is_within_its_range, N_ELEM(filters))
{
    static const struct msg_frame small = { 0, 4, 5, "" };
    struct msg m = { .type = MSG_SUBMIT, .submit = SPEC }, back = { 0 };
    uint8_t bytes[MOST];
    size_t n;
    int rc;

    m.submit.nframes = 1;
    m.submit.frames = &small;
    m.submit.oversample = filters[_i].oversample;
    m.submit.clamp = filters[_i].clamp;
    if (m.submit.oversample > 8) { /* no pixel would be left of it */
        static const struct msg_frame large = { 0, 400, 500, "" };

        m.submit.frames = &large;
    }
    n = pack(&m, bytes) - MSG_HEADER;
    rc = unpack_exactly(m.type, bytes + MSG_HEADER, n, &back);
    ck_assert_int_eq(rc, filters[_i].fine ? 0 : RAD_EPROTO);
    if (filters[_i].fine) {
        ck_assert_uint_eq(back.submit.oversample, filters[_i].oversample);
        ck_assert(back.submit.clamp == filters[_i].clamp);
    }
    msg_release(&back);
}

static const struct {
    uint32_t flags, error_ppm, time_ms;
    bool fine;
} reuses[] = {
    { MSG_JOB_PASSES | MSG_JOB_SCENE, 0, 0, true },
    { MSG_JOB_PASSES | MSG_JOB_SCENE | MSG_JOB_REUSE, 0, 0, true },
    { MSG_JOB_PASSES | MSG_JOB_REUSE, 0, 0, false },
    { MSG_JOB_SCENE, 0, 0, false },
    { MSG_JOB_SHARE | MSG_JOB_SCENE, 0, 0, false },
    { MSG_JOB_PASSES | MSG_JOB_SCENE, 50000, 0, true },
    { MSG_JOB_PASSES | MSG_JOB_SCENE | MSG_JOB_REUSE, 50000, 9000, true },
};

LOOP_TEST(a_cache_is_reused_in_passes_of_one_scene, N_ELEM(reuses))
{
    struct msg m = { .type = MSG_SUBMIT, .submit = SPEC }, back = { 0 };
    bool begins = reuses[_i].flags & MSG_JOB_REUSE;
    uint8_t bytes[MOST];
    size_t n;
    int rc;

    m.submit.flags = reuses[_i].flags;
    m.submit.error_ppm = reuses[_i].error_ppm;
    m.submit.time_ms = reuses[_i].time_ms;
    m.submit.scene = two_hashes;
    m.submit.reuse = ID;
    n = pack(&m, bytes) - MSG_HEADER;
    rc = unpack_exactly(m.type, bytes + MSG_HEADER, n, &back);
    ck_assert_int_eq(rc, reuses[_i].fine ? 0 : RAD_EPROTO);
    msg_release(&back);
    if (reuses[_i].fine) {
        ck_assert_int_eq(
            msg_unpack(&back, m.type, 0, bytes + MSG_HEADER, n, NULL), 0);
        ck_assert_mem_eq(back.submit.scene, two_hashes, MSG_HASH);
        ck_assert_int_eq(back.submit.reuse != NULL, begins);
        if (begins)
            ck_assert_mem_eq(back.submit.reuse, ID, MSG_JOB);
    }
    for (size_t i = 1; i <= MSG_HASH + MSG_JOB; i++) {
        struct msg cut = { 0 };

        ck_assert_int_eq(
            unpack_exactly(m.type, bytes + MSG_HEADER, n - i, &cut),
            RAD_EPROTO);
        msg_release(&cut);
    }
    msg_release(&back);
}

static const struct {
    uint32_t flags, nframes;
    uint8_t oversample;
    bool fine;
} points[] = {
    { MSG_JOB_POINTS | MSG_JOB_DEPTH, 1, 1, true },
    { MSG_JOB_POINTS | MSG_JOB_DEPTH | MSG_JOB_PASSES, 1, 1, true },
    { MSG_JOB_POINTS, 1, 1, false },
    { MSG_JOB_POINTS | MSG_JOB_DEPTH, 2, 1, false },
    { MSG_JOB_POINTS | MSG_JOB_DEPTH, 1, 2, false },
    { MSG_JOB_DEPTH, 2, 2, true },
};

LOOP_TEST(points_are_one_frame_with_distances, N_ELEM(points))
{
    struct msg m = { .type = MSG_SUBMIT, .submit = SPEC }, back = { 0 };
    uint8_t bytes[MOST];
    size_t n;
    int rc;

    m.submit.flags = points[_i].flags;
    m.submit.nframes = points[_i].nframes;
    m.submit.oversample = points[_i].oversample;
    m.submit.clamp = 0;
    m.submit.ncosts = 0;
    n = pack(&m, bytes) - MSG_HEADER;
    rc = unpack_exactly(m.type, bytes + MSG_HEADER, n, &back);
    ck_assert_int_eq(rc, points[_i].fine ? 0 : RAD_EPROTO);
    if (points[_i].fine)
        ck_assert_uint_eq(back.submit.flags, points[_i].flags);
    msg_release(&back);
}
