/* check_render.c - a job's child, a process of its own, and what it tells
 *
 * The test is radd: it has the other end of the child's link. */
#include "config.h"

#include "child/render.h"
#include "base/files.h"
#include "base/output.h"
#include "base/sha.h"
#include "proto/ambshare.h"
#include "proto/frame.h"
#include "scene/file/bundle.h"
#include "scene/file/parse.h"
#include "scene/octfile.h"
#include "scene/octree.h"

#include "tests/scratch.h"
#include "tests/world.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <sysexits.h>
#include <unistd.h>

enum { SIDE = 64 }; /* as the options say */

static const uint8_t job[MSG_JOB] = { 3, 1, 4 };
static const struct msg_frame frames[] = {
    { 1, SIDE, SIDE, "-vp 0 -4.9 2.5 -vd 0 1 0 -vh 80 -vv 80" },
    { 2, SIDE, SIDE, "-vp 0 -4.9 2.4 -vd 0 1 0 -vh 80 -vv 80" },
};

static struct {
    pid_t pid;
    int fd;
    struct frame_reader reader;
    uint8_t bytes[4096];
    const uint8_t *at; /* in bytes[], and how many are left there */
    size_t left;
    struct msg heard;           /* the last one */
    uint8_t files[2][MSG_HASH]; /* scene, manifest */
} f;

/* --- the job's files --- */

/* Into a file of the folder that has its hash as its name. */
static void
put_file(const void *bytes, size_t n, char hex[RAD_SHA_HEX + 1])
{
    char path[200];

    ck_assert_int_eq(rad_sha_hex(bytes, n, hex, NULL), 0);
    snprintf(path, sizeof path, "%s/%s", dir, hex);
    ck_assert_int_eq(rad_output_write(path, bytes, n, false, NULL), 0);
}

static void
put_scene(void)
{
    struct rad_scene *s = rad_scene_new();
    struct rad_octree tree;
    struct rad_memory_out oct;
    struct rad_sink sink = rad_memory_sink(&oct);
    struct rad_bundle bundle;
    char hex[RAD_SHA_HEX + 1], *manifest;
    size_t n;

    ck_assert_int_eq(
        rad_parse_text(s, WORLD_ROOM, strlen(WORLD_ROOM), "a.rad", NULL, NULL),
        0);
    ck_assert_int_eq(rad_octree_build(&tree, s, RAD_OCTREE_LEAF, NULL), 0);
    ck_assert_int_eq(rad_octfile_write(s, &tree, &sink, NULL), 0);
    rad_octree_release(&tree);
    rad_scene_free(s);
    put_file(oct.bytes, oct.len, hex);
    rad_sha_from_hex(hex, f.files[0]);
    rad_bundle_init(&bundle);
    ck_assert_int_eq(
        rad_bundle_add(&bundle, RAD_BUNDLE_SCENE, "a.oct", hex, oct.len, NULL),
        0);
    free(oct.bytes);
    manifest = rad_bundle_format(&bundle, &n);
    ck_assert_ptr_nonnull(manifest);
    rad_bundle_release(&bundle);
    put_file(manifest, n, hex);
    rad_sha_from_hex(hex, f.files[1]);
    free(manifest);
}

/* --- the link --- */

static void
say(const struct msg *m)
{
    struct wire_out out;

    wire_out_init(&out, MSG_FRAME_MAX);
    ck_assert_int_eq(msg_pack(&out, m), 0);
    ck_assert_int_eq(write(f.fd, out.buf, out.len), (ssize_t)out.len);
    wire_out_release(&out);
}

/* The next message, valid until the next call; NULL: the child has closed the
 * link. */
static const struct msg *
hear(void)
{
    struct rad_error err = { 0 };
    ssize_t n;
    int rc;

    while ((rc = frame_read(&f.reader, &f.at, &f.left, &f.heard, &err)) == 0) {
        n = read(f.fd, f.bytes, sizeof f.bytes);
        if (n <= 0)
            return NULL;
        f.at = f.bytes;
        f.left = (size_t)n;
    }
    ck_assert_msg(rc == 1, "%s", err.what);
    return &f.heard;
}

/* The next message of that type. */
static const struct msg *
hear_of(uint16_t type)
{
    const struct msg *m;

    do {
        m = hear();
        ck_assert_ptr_nonnull(m);
        ck_assert_msg(m->type != MSG_FAILED, "%s", m->failed.text);
    } while (m->type != type);
    return m;
}

/* FAILED comes with that status and text, and no rows do; and the child ends by
 * itself. */
static void
check_failed(int status, const char *text)
{
    const struct msg *m;
    int how;

    do {
        m = hear();
        ck_assert_ptr_nonnull(m);
        ck_assert_int_ne(m->type, MSG_RESULT);
    } while (m->type != MSG_FAILED);
    ck_assert_msg(strstr(m->failed.text, text) != NULL, "%s", m->failed.text);
    ck_assert_int_eq(m->failed.status, status);
    while (hear())
        ;
    ck_assert_int_eq(waitpid(f.pid, &how, 0), f.pid);
    f.pid = 0;
    ck_assert(WIFEXITED(how));
    ck_assert_int_eq(WEXITSTATUS(how), status);
}

/* --- the child --- */

static void
be_child(int fd, pid_t radd)
{
    char program[] = "radd", option[] = RENDER_CHILD_OPTION, one[] = "1",
         none[] = "0", parent[20];
    char *argv[] = { program, option, dir,         one,    none,
                     none,    none,   program + 4, parent, NULL };

    snprintf(parent, sizeof parent, "%ld", (long)radd);
    if (dup2(fd, RENDER_LINK_FD) < 0)
        _exit(EX_OSERR);
    _exit(render_main(9, argv));
}

/* A child that is ready for a job of so many frames. */
static void
begin(const char *options, uint8_t partition, uint32_t flags, uint32_t nframes)
{
    struct msg m = { .type = MSG_JOB_START };
    pid_t radd = getpid();
    int end[2];

    put_scene();
    ck_assert_int_eq(socketpair(AF_UNIX, SOCK_STREAM, 0, end), 0);
    f.pid = fork();
    if (f.pid == 0)
        be_child(end[1], radd);
    ck_assert_int_gt(f.pid, 0);
    close(end[1]);
    f.fd = end[0];
    frame_reader_init(&f.reader, MSG_AT_PARENT_NEW);
    m.job_start = (struct msg_spec){ .job = job,
                                     .manifest = f.files[1],
                                     .params = options,
                                     .partition = partition,
                                     .flags = flags,
                                     .files = { 2, f.files[0] },
                                     .frames = frames,
                                     .nframes = nframes };
    say(&m);
    hear_of(MSG_READY);
    f.reader.session = MSG_AT_PARENT;
}

static void
open_folder(void)
{
    memset(&f, 0, sizeof f);
    f.fd = -1;
    scratch_make();
}

/* A child whose link is closed ends, whatever it is at. */
static void
close_all(void)
{
    if (f.fd >= 0) {
        close(f.fd);
        frame_reader_release(&f.reader);
        msg_release(&f.heard);
    }
    if (f.pid > 0)
        waitpid(f.pid, NULL, 0);
    scratch_remove();
}

FIXTURE(open_folder, close_all)

static void
give(uint32_t frame, uint32_t x, uint32_t y, uint32_t width, uint32_t height,
     uint8_t mode)
{
    struct msg m = { .type = MSG_UNIT };

    m.unit = (struct msg_unit){ .job = job,
                                .unit = 7,
                                .attempt = 1,
                                .frame = frame,
                                .x = x,
                                .y = y,
                                .width = width,
                                .height = height,
                                .mode = mode };
    say(&m);
}

/* Units that no coordinator gives to a child of a job in windows. */
static const struct {
    uint32_t frame, x, y, width, height;
    uint8_t mode;
    const char *what;
} wrong[] = {
    { 1, 0, 0, SIDE, 8, MSG_MODE_WINDOW, "unit 7 of frame 1, of 1" },
    { UINT32_MAX, 0, 0, SIDE, 8, MSG_MODE_WINDOW, "unit 7 of frame 42" },
    { 0, 0, 0, SIDE + 1, 8, MSG_MODE_WINDOW, "outside" },
    { 0, 1, 0, SIDE, 8, MSG_MODE_WINDOW, "outside" },
    { 0, 0, SIDE - 7, SIDE, 8, MSG_MODE_WINDOW, "outside" },
    { 0, 0, 0, SIDE, SIDE + 1, MSG_MODE_WINDOW, "outside" },
    { 0, 0, 0, SIDE, 8, MSG_MODE_STRICT, "unit 7 is strict" },
};

LOOP_TEST(a_unit_that_makes_no_sense_is_refused, N_ELEM(wrong))
{
    begin("-x 64 -y 64 -ab 0", MSG_PART_WINDOW, 0, 1);
    give(wrong[_i].frame, wrong[_i].x, wrong[_i].y, wrong[_i].width,
         wrong[_i].height, wrong[_i].mode);
    check_failed(EX_PROTOCOL, wrong[_i].what);
}

TEST(a_unit_comes_back_whole)
{
    struct msg end = { .type = MSG_JOB_END };
    const struct msg *m;
    uint32_t rows = 0;

    begin("-x 64 -y 64 -ab 0", MSG_PART_WINDOW, 0, 1);
    give(0, 0, SIDE - 8, SIDE, 8, MSG_MODE_WINDOW);
    do {
        m = hear_of(MSG_RESULT);
        ck_assert_uint_eq(m->result.unit, 7);
        ck_assert_uint_eq(m->result.row, rows);
        rows += m->result.rows;
    } while (!m->result.last);
    ck_assert_uint_eq(rows, 8);
    end.job_end.job = job;
    say(&end);
    ck_assert_uint_eq(hear_of(MSG_TALLY)->tally.pixels_under_way, 0);
}

/* A peer has no say in a cache that is made in passes. */
LOOP_TEST(records_of_peers_are_for_live_caches, 2)
{
    struct rad_ambrec rec = { .p = { 0, 0, 1 },
                              .n = { 0, 0, 1 },
                              .u = { 1, 0, 0 },
                              .radius = { .5f, .5f },
                              .E = { 1, 1, 1 },
                              .weight = 1 };
    struct msg m = { .type = MSG_AMBIENT },
               end = { .type = MSG_JOB_END, .job_end.job = job };
    struct wire_out out;

    begin("-x 64 -y 64 -ab 1 -aa .2", MSG_PART_WINDOW,
          _i == 0 ? 0 : MSG_JOB_PASSES, 1);
    wire_out_init(&out, AMBSHARE_BYTES);
    ambshare_pack(&out, &rec);
    m.ambient = (struct msg_ambient){ 1, out.buf, out.len };
    say(&m);
    say(&end);
    ck_assert_uint_eq(hear_of(MSG_TALLY)->tally.cache_values, _i == 0);
    wire_out_release(&out);
}

/* With --fresh-frames the first message of a frame loads the job again. */
TEST(a_frame_that_cannot_be_loaded_fails_the_job)
{
    static const uint8_t density[SIDE] = { 1 };
    struct msg m = { .type = MSG_GUESS };
    char command[100];

    begin("-x 64 -y 64 -ab 0 -ps 1", MSG_PART_SCANBAR, MSG_JOB_FRESH_FRAMES, 2);
    give(0, 0, 0, SIDE, 8, MSG_MODE_STRICT);
    while (!hear_of(MSG_RESULT)->result.last)
        ;
    snprintf(command, sizeof command, "rm %s/*", dir);
    ck_assert_int_eq(system(command), 0);
    m.guess = (struct msg_guess){ .job = job,
                                  .frame = 1,
                                  .line = 1,
                                  .known = 1,
                                  .ndensity = 1,
                                  .density = density };
    say(&m);
    check_failed(EX_NOINPUT, "");
}
