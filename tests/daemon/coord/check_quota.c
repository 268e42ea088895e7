/* check_quota.c - what one user may have, and what becomes of the rest */
#include "config.h"

#include "coord_fixture.h"

enum { EVE = 10, EVE_TOO, UPLOAD_MS = 60000 };

static const struct coord_limits few = {
    .jobs = 2,
    .frames = 3,
    .bytes = 8 << 20,
    .uploads = 2,
    .upload_bytes = 4 << 20,
    .conns = 2,
    .answers = 2,
    .unfetched = 3,
    .unread = 1 << 20,
    .upload_ms = UPLOAD_MS,
};

/* Who may use the coordinator and no more. */
static void
join_plain(uint64_t conn, const char *owner)
{
    struct coord_peer peer = { "test", owner, 1u << MSG_ROLE_USER, NULL };
    struct msg m = { .type = MSG_HELLO,
                     .hello = { MSG_VERSION_MIN, MSG_VERSION, MSG_ROLE_USER, "",
                                "t", "", 0, 0 } };

    coord_opened(f.c, f.now_ms, conn, &peer);
    say(conn, &m);
}

static void
set_up_few(void)
{
    set_up_coord(true);
    coord_set_limits(f.c, &few);
    join_plain(EVE, "eve");
    join_plain(EVE_TOO, "eve");
    file_came(EVE, hash);
}

FIXTURE(set_up_few, tear_down)

static void
expect_refused(uint64_t conn, int status, const char *limit)
{
    ck_assert_int_eq(f.last[conn].type, MSG_FAILED);
    ck_assert_int_eq(f.last[conn].failed.status, status);
    ck_assert_ptr_nonnull(strstr(f.last[conn].failed.text, limit));
}

static const uint8_t *
job_id(int i)
{
    static uint8_t id[MSG_JOB];

    id[0] = (uint8_t)(i + 1);
    return id;
}

TEST(jobs_of_one_user_are_limited_and_not_those_of_another)
{
    submit(EVE, job_id(0), 0);
    submit(EVE_TOO, job_id(1), 0);
    ck_assert_int_eq(f.last[EVE_TOO].type, MSG_ACCEPT);
    submit(EVE, job_id(2), 0);
    expect_refused(EVE, EX_TEMPFAIL, "limit user_jobs: you have 2 of 2 ");
    for (int i = 3; i < 8; i++) { /* who is administrator is not limited */
        submit(ANA, job_id(i), 0);
        ck_assert_int_eq(f.last[ANA].type, MSG_ACCEPT);
    }
    about(EVE, MSG_CANCEL, job_id(0));
    submit(EVE, job_id(2), 0);
    ck_assert_int_eq(f.last[EVE].type, MSG_ACCEPT);
}

static void
submit_frames(uint64_t conn, const uint8_t *job, const struct msg_frame *frames,
              uint32_t n)
{
    struct msg m = usual_submit(job);

    m.submit.nframes = n;
    m.submit.frames = frames;
    m.submit.partition = MSG_PART_WINDOW;
    say(conn, &m);
}

/* A job that no place would help keeps none. */
TEST(who_meets_another_limit_is_not_in_line)
{
    enum { LATER = EVE_TOO + 1 };
    static const struct msg_frame many[4] = {
        { 0, 8, 8, "" }, { 1, 8, 8, "" }, { 2, 8, 8, "" }, { 3, 8, 8, "" }
    };
    struct coord_limits one = few;

    one.jobs = 1;
    one.conns = 3;
    coord_set_limits(f.c, &one);
    join_plain(LATER, "eve");
    submit(EVE, job_id(0), 0);
    submit(EVE_TOO, job_id(1), 0);
    expect_refused(EVE_TOO, EX_TEMPFAIL, "limit user_jobs");
    submit_frames(EVE_TOO, job_id(1), many, 4);
    expect_refused(EVE_TOO, EX_DATAERR, "limit user_frames");
    about(EVE, MSG_CANCEL, job_id(0));
    submit(LATER, job_id(2), 0);
    ck_assert_int_eq(f.last[LATER].type, MSG_ACCEPT);
}

TEST(frames_and_bytes_are_limited_too)
{
    static const struct msg_frame many[4] = {
        { 0, 8, 8, "" }, { 1, 8, 8, "" }, { 2, 8, 8, "" }, { 3, 8, 8, "" }
    };
    static const struct msg_frame large = { 0, 1024, 1024, "" },
                                  huge = { 0, 2048, 2048, "" };

    submit_frames(EVE, job_id(0), many, 4); /* too many by themselves */
    expect_refused(EVE, EX_DATAERR, "limit user_frames");
    submit_frames(EVE, job_id(0), many, 2);
    ck_assert_int_eq(f.last[EVE].type, MSG_ACCEPT);
    submit_frames(EVE, job_id(1), many, 2);
    expect_refused(EVE, EX_TEMPFAIL, "limit user_frames");
    about(EVE, MSG_CANCEL, job_id(0));
    submit_frames(EVE, job_id(1), &huge, 1); /* 16 MiB */
    expect_refused(EVE, EX_DATAERR, "limit user_mib");
    submit_frames(EVE, job_id(1), &large, 1);
    ck_assert_int_eq(f.last[EVE].type, MSG_ACCEPT);
    submit_frames(EVE, job_id(2), &large, 1); /* 4 MiB each */
    ck_assert_int_eq(f.last[EVE].type, MSG_ACCEPT);
    coord_set_limits(f.c, &(struct coord_limits){ .jobs = 9, .frames = 9 });
    submit_frames(EVE, job_id(3), many, 1);
    expect_refused(EVE, EX_DATAERR, "limit user_mib");
}

static void
send_chunk(uint64_t conn, uint8_t file, uint64_t offset, uint64_t total)
{
    static uint8_t name[MSG_HASH], data[1000];
    struct msg m = { .type = MSG_CHUNK,
                     .chunk = { name, offset, total, data, sizeof data } };

    name[0] = file;
    say(conn, &m);
}

static void
file_is_whole(uint64_t conn, uint8_t file)
{
    uint8_t name[MSG_HASH] = { file };

    file_came(conn, name);
}

static json_int_t
used(uint64_t conn, const char *limit)
{
    struct msg m = { .type = MSG_QUERY,
                     .query = { .what = MSG_QUERY_LIMITS, .text = "eve" } };
    json_t *root, *row;
    json_int_t n = -1;
    size_t i;

    say(conn, &m);
    ck_assert_int_eq(f.last[conn].type, MSG_ANSWER);
    root = json_loadb((const char *)f.last[conn].answer.text,
                      f.last[conn].answer.len, 0, NULL);
    ck_assert_ptr_nonnull(root);
    json_array_foreach(json_object_get(root, "limits"), i, row)
    {
        if (strcmp(json_string_value(json_object_get(row, "limit")), limit) ==
            0)
            n = json_integer_value(json_object_get(row, "used"));
    }
    json_decref(root);
    return n;
}

/* Of jobs that are submitted again and again none has to wait for ever. */
TEST(whose_job_was_refused_comes_before_who_comes_later)
{
    enum { LATER = EVE_TOO + 1, MALLORY };
    struct msg offer = { .type = MSG_OFFER, .offer = { 1, hash } };
    struct coord_limits one = few;

    one.jobs = 1;
    one.conns = 4;
    coord_set_limits(f.c, &one);
    submit(EVE, job_id(0), 0);
    say(EVE_TOO, &offer);
    submit(EVE_TOO, job_id(1), 0);
    expect_refused(EVE_TOO, EX_TEMPFAIL, "limit user_jobs: you have 1 of 1 ");
    ck_assert_int_eq(used(EVE, "user_uploads"), 0); /* it only waits */
    join_plain(LATER, "eve");
    join_plain(MALLORY, "mallory");
    about(EVE, MSG_CANCEL, job_id(0));
    submit(LATER, job_id(2), 0);
    expect_refused(LATER, EX_TEMPFAIL,
                   "limit user_jobs: you have 0 of 1 jobs that are not over, "
                   "and 1 are in line before this one");
    submit(MALLORY, job_id(3), 0);
    ck_assert_int_ne(f.last[MALLORY].type, MSG_FAILED);
    submit(EVE_TOO, job_id(1), 0);
    ck_assert_int_eq(f.last[EVE_TOO].type, MSG_ACCEPT);
    about(EVE, MSG_CANCEL, job_id(1));
    submit(LATER, job_id(2), 0);
    ck_assert_int_eq(f.last[LATER].type, MSG_ACCEPT);
    submit(EVE, job_id(4), 0); /* it goes without a job */
    cut(EVE);
    about(EVE_TOO, MSG_CANCEL, job_id(2));
    submit(LATER, job_id(5), 0);
    ck_assert_int_eq(f.last[LATER].type, MSG_ACCEPT);
}

static void
submit_windows(const uint8_t *job, const struct msg_frame *picture, uint32_t n)
{
    struct msg m = usual_submit(job);

    m.submit.frames = picture;
    m.submit.windows = n;
    m.submit.partition = MSG_PART_WINDOW;
    say(EVE, &m);
}

TEST(many_windows_count_as_frames)
{
    static const struct msg_frame tiny = { 0, 2, 5, "" },
                                  small = { 0, 64, 64, "" };

    submit_windows(job_id(0), &small, UINT32_MAX);
    expect_refused(EVE, EX_DATAERR, "limit user_frames");
    submit_windows(job_id(0), &small, 16);
    expect_refused(EVE, EX_DATAERR, "limit user_frames");
    submit_windows(job_id(0), &small, 7);
    ck_assert_int_eq(f.last[EVE].type, MSG_ACCEPT);
    ck_assert_int_eq(used(EVE, "user_frames"), 1);
    submit_windows(job_id(1), &small, 12);
    expect_refused(EVE, EX_TEMPFAIL, "limit user_frames");
    submit_windows(job_id(1), &tiny, UINT32_MAX); /* of a pixel each */
    ck_assert_int_eq(f.last[EVE].type, MSG_ACCEPT);
    ck_assert_int_eq(used(EVE, "user_frames"), 3);
}

/* A line takes memory however few columns it has. */
TEST(high_frames_count_as_several)
{
    static const struct msg_frame high = { 0, 1, 4096, "" },
                                  usual = { 0, 1, 2047, "" };
    struct msg m = usual_submit(job_id(0));

    m.submit.frames = &high;
    say(EVE, &m);
    expect_refused(EVE, EX_DATAERR, "limit user_frames");
    m.submit.frames = &usual;
    say(EVE, &m);
    ck_assert_int_eq(f.last[EVE].type, MSG_ACCEPT);
    ck_assert_int_eq(used(EVE, "user_frames"), 1);
}

TEST(files_on_their_way_are_limited_by_number_and_bytes)
{
    struct msg offer = { .type = MSG_OFFER, .offer = { 1, hash } };
    unsigned before;

    send_chunk(EVE, 7, 0, 5 << 20);
    expect_refused(EVE, EX_DATAERR, "limit user_upload_mib");
    before = f.sent[EVE]; /* and of the rest of it nothing is said */
    send_chunk(EVE, 7, 1000, 5 << 20);
    ck_assert_uint_eq(f.sent[EVE], before);
    send_chunk(EVE, 7, 0, 3 << 20);
    send_chunk(EVE_TOO, 8, 0, 1 << 20);
    ck_assert_int_eq(used(EVE, "user_uploads"), 2);
    ck_assert_int_eq(used(EVE, "user_upload_mib"), 4);
    send_chunk(EVE, 9, 0, 1000);
    expect_refused(EVE, EX_TEMPFAIL, "limit user_uploads: you have 2 of 2 ");
    say(EVE, &offer);
    expect_refused(EVE, EX_TEMPFAIL, "limit user_uploads: you have 2 of 2 ");
    file_is_whole(EVE, 7);
    send_chunk(EVE, 9, 0, 1000);
    expect_refused(EVE, EX_TEMPFAIL, "limit user_upload_mib");
    cut(EVE_TOO); /* what it sent goes */
    ck_assert_int_eq(used(EVE, "user_upload_mib"), 3);
    send_chunk(EVE, 9, 0, 1000);
    ck_assert_int_eq(used(EVE, "user_uploads"), 1);
}

/* And then they are forgotten, and the store removes them. */
TEST(files_that_no_job_names_count_for_a_while)
{
    size_t n;

    send_chunk(EVE, 7, 0, 1000);
    file_is_whole(EVE, 7);
    send_chunk(EVE, hash[0], 0, 1000);
    file_is_whole(EVE, hash[0]);
    free(coord_files(f.c, &n));
    ck_assert_uint_eq(n, 2);
    submit(EVE, job_a, 0); /* which names hash */
    ck_assert_int_eq(used(EVE, "user_upload_mib"), 1);
    free(coord_files(f.c, &n));
    ck_assert_uint_eq(n, 2);
    wait_s(UPLOAD_MS / 1000 + 1);
    ck_assert_int_eq(used(EVE, "user_upload_mib"), 0);
    free(coord_files(f.c, &n));
    ck_assert_uint_eq(n, 1);
}

/* A scene that takes longer than upload_s to come: files that came first, and
 * files that were here before it was offered, stay until its job names them. */
TEST(no_file_is_forgotten_while_others_of_its_offer_come)
{
    struct msg offer = { .type = MSG_OFFER, .offer = { 1, hash } };
    const struct coord_owner *eve = desk_owner(f.c, "eve");
    size_t n;

    say(EVE, &offer);
    send_chunk(EVE, 7, 0, 1000);
    file_is_whole(EVE, 7);
    for (uint64_t i = 0; i < 10; i++) {
        wait_s(UPLOAD_MS / 2000);
        send_chunk(EVE, 8, 1000 * i, 10000);
    }
    ck_assert(known_has(&eve->files, hash));
    ck_assert_uint_eq(eve->uploads.bytes, 2 * UPLOADS_LEAST);
    free(coord_files(f.c, &n));
    ck_assert_uint_ge(n, 2); /* hash, and 7, perhaps twice */
    file_is_whole(EVE, 8);
    submit(EVE, job_a, 0); /* which names hash, and neither 7 nor 8 */
    ck_assert_int_eq(f.last[EVE].type, MSG_ACCEPT);
    wait_s(UPLOAD_MS / 1000 + 2);
    ck_assert_int_eq(used(EVE, "user_upload_mib"), 0);
    free(coord_files(f.c, &n));
    ck_assert_uint_eq(n, 1);
}

/* So an upload goes on over a line that breaks now and then. */
TEST(files_that_are_offered_again_wait_anew)
{
    static const uint8_t seven[MSG_HASH] = { 7 };
    struct msg offer = { .type = MSG_OFFER, .offer = { 1, seven } };

    say(EVE, &offer);
    send_chunk(EVE, 7, 0, 1000);
    file_is_whole(EVE, 7);
    cut(EVE);
    wait_s(UPLOAD_MS / 2000);
    say(EVE_TOO, &offer);
    cut(EVE_TOO);
    wait_s(UPLOAD_MS / 2000 + 2);
    ck_assert_int_eq(used(ADMIN, "user_upload_mib"), 1);
    wait_s(UPLOAD_MS / 2000 + 2);
    ck_assert_int_eq(used(ADMIN, "user_upload_mib"), 0);
}

TEST(who_sends_and_stops_is_let_go)
{
    struct msg offer = { .type = MSG_OFFER, .offer = { 1, hash } };

    say(EVE, &offer);
    say(EVE_TOO, &offer);
    wait_s(UPLOAD_MS / 2000);
    send_chunk(EVE_TOO, 8, 0, 5000);
    wait_s(UPLOAD_MS / 2000 + 2);
    ck_assert(f.closed[EVE] && !f.closed[EVE_TOO]);
}

/* So a queue of them is not full for ever. */
TEST(a_job_whose_files_do_not_come_fails)
{
    f.have = false;
    submit(EVE, job_a, 0);
    wait_s(UPLOAD_MS / 1000 - 2);
    ck_assert_int_ne(f.last[EVE].type, MSG_FAILED);
    wait_s(4);
    expect_refused(EVE, EX_TEMPFAIL,
                   "files of the scene did not come for 60 s");
    ck_assert_int_eq(used(EVE, "user_jobs"), 0);
}

/* Nobody can send what there is no room for. */
TEST(a_full_disk_does_not_count)
{
    f.have = false;
    submit(EVE, job_a, 0);
    coord_fullness(f.c, f.now_ms, true, "here");
    carry_out();
    wait_s(2 * UPLOAD_MS / 1000);
    ck_assert_int_ne(f.last[EVE].type, MSG_FAILED);
}

TEST(answers_that_wait_for_the_disk_are_limited)
{
    submit(EVE, job_a, 0);
    f.stuck = true;
    about(EVE, MSG_PAUSE, job_a);
    about(EVE, MSG_RESUME, job_a);
    ck_assert_int_eq(used(EVE, "user_answers"), 2);
    about(EVE, MSG_PAUSE, job_a);
    expect_refused(EVE, EX_TEMPFAIL, "limit user_answers: you have 2 of 2 ");
    coord_settled(f.c, f.now_ms, EVE, 6);
    carry_out();
    ck_assert_int_eq(used(EVE, "user_answers"), 1);
    about(EVE, MSG_PAUSE, job_a);
    ck_assert_int_ne(f.last[EVE].type, MSG_FAILED);
}

TEST(connections_are_limited)
{
    join_plain(EVE_TOO + 1, "eve");
    ck_assert_int_eq(f.last[EVE_TOO + 1].type, MSG_REFUSE);
    ck_assert_int_eq(f.last[EVE_TOO + 1].refuse.status, EX_TEMPFAIL);
    ck_assert_ptr_nonnull(
        strstr(f.last[EVE_TOO + 1].refuse.text, "user_connections"));
    join_plain(EVE_TOO + 2, "mallory");
    ck_assert_int_eq(f.last[EVE_TOO + 2].type, MSG_WELCOME);
}

TEST(what_another_user_has_is_for_administrators)
{
    struct msg m = { .type = MSG_QUERY,
                     .query = { .what = MSG_QUERY_LIMITS, .text = "ana" } };

    say(EVE, &m);
    ck_assert_int_eq(f.last[EVE].type, MSG_FAILED);
    ck_assert_int_eq(f.last[EVE].failed.status, EX_NOPERM);
    ck_assert_int_eq(used(ADMIN, "user_connections"), 2);
    submit(EVE, job_a, 0);
    ck_assert_int_eq(used(ADMIN, "user_jobs"), 1);
    ck_assert_int_eq(used(EVE, "user_frames"), 1);
}
