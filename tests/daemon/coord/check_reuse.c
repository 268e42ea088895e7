/* check_reuse.c - a job begins with the ambient cache of a former job: which
 * one, what does not fit, what is kept for how long, and the files of it */
#include "config.h"

#include "folder/folder.h"
#include "proto/ambshare.h"
#include "registry/recover.h"
#include "filling/passes.h"
#include "coord_fixture.h" /* last: it has a variable f */
#include "tests/scratch.h"

#include <errno.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

/* Of 8 by 8 pixels, each of one tile: four lattices, and what they leave. */
enum { PASSES = 5 };

static const uint8_t job_c[MSG_JOB] = { 0xcc };
static const uint8_t scene[MSG_HASH] = { 1 }, other_scene[MSG_HASH] = { 2 };
static const uint8_t last[MSG_JOB];
static uint8_t records[PASSES * AMBSHARE_BYTES];

static struct msg
submit_of(const uint8_t *job, const uint8_t *reuse)
{
    struct msg m = usual_submit(job);

    m.request = 5;
    m.submit.params = "-ab 1 -ps 4";
    m.submit.flags = MSG_JOB_PASSES | MSG_JOB_SCENE;
    m.submit.scene = scene;
    m.submit.partition = MSG_PART_WINDOW;
    m.submit.windows = 4;
    m.submit.reuse = reuse;
    if (reuse)
        m.submit.flags |= MSG_JOB_REUSE;
    return m;
}

static void
submit_job(uint64_t conn, const uint8_t *job, const uint8_t *reuse)
{
    struct msg m = submit_of(job, reuse);

    say(conn, &m);
}

/* The tile of a pass, with so many records. */
static void
made(const uint8_t *job, uint32_t pass, uint32_t n)
{
    struct msg m = { .type = MSG_TILE_MADE,
                     .tile_made = { .job = job,
                                    .pass = pass,
                                    .counts = { .rays = 10 },
                                    .count = n,
                                    .data = records,
                                    .len = n * AMBSHARE_BYTES } };

    say(WORKER, &m);
    while (f.last[WORKER].type == MSG_CLOSED) {
        struct msg holds = { .type = MSG_HOLDS,
                             .holds = { job, f.last[WORKER].closed.pass, 1 } };

        f.last[WORKER].type = 0;
        say(WORKER, &holds);
    }
}

static struct job *
find(const uint8_t *job)
{
    return desk_find_job(f.c, job);
}

/* From its tiles to its end; first: of the passes that have tiles. */
static void
render(const uint8_t *job, uint32_t first, uint32_t n)
{
    for (uint32_t i = 0; i < PASSES; i++)
        made(job, first + i, n);
    for (uint32_t u = 0; u < 4; u++)
        result(WORKER, job, u, 1);
    ck_assert_int_eq(find(job)->state, JOB_DONE);
}

/* The store has it as it was told. */
static void
file(const uint8_t *job)
{
    coord_job_filed(f.c, f.now_ms, job, find(job)->sequence, 900,
                    find(job)->cache.bytes);
    carry_out();
}

static void
whole_job(const uint8_t *job)
{
    submit_job(ANA, job, NULL);
    ready(WORKER, job);
    render(job, 0, 1);
    file(job);
}

static void
set_up_kept(void)
{
    set_up_coord(true);
}

FIXTURE(set_up_kept, tear_down)

/* --- which one --- */

TEST(a_job_that_is_done_leaves_its_cache)
{
    whole_job(job_a);
    ck_assert_uint_eq(find(job_a)->cache.bytes, PASSES * AMBSHARE_BYTES);
    ck_assert_uint_eq(find(job_a)->cache.range.all, PASSES);
    tear_down();
    set_up_coord(false); /* and nothing where nothing is kept */
    submit_job(ANA, job_a, NULL);
    ready(WORKER, job_a);
    render(job_a, 0, 1);
    ck_assert_uint_eq(find(job_a)->cache.bytes, 0);
}

TEST(the_job_that_was_asked_for_is_begun_with)
{
    whole_job(job_a);
    whole_job(job_b);
    submit_job(ANA, job_c, job_a);
    ck_assert_int_eq(f.last[ANA].type, MSG_ACCEPT);
    ck_assert_mem_eq(f.last[ANA].accept.reuse, job_a, MSG_JOB);
    ck_assert_mem_eq(find(job_c)->spec.reuse, job_a, MSG_JOB);
}

TEST(the_last_is_the_one_that_ended_last)
{
    whole_job(job_b);
    whole_job(job_a);
    submit_job(ANA, job_c, last);
    ck_assert_mem_eq(f.last[ANA].accept.reuse, job_a, MSG_JOB);
}

TEST(without_a_last_one_that_fits_a_job_begins_with_nothing)
{
    submit_job(ANA, job_c, last);
    ck_assert_int_eq(f.last[ANA].type, MSG_ACCEPT);
    ck_assert_mem_eq(f.last[ANA].accept.reuse, last, MSG_JOB);
    ck_assert(!(find(job_c)->spec.flags & MSG_JOB_REUSE));
    ck_assert_ptr_null(find(job_c)->spec.reuse);
}

static const struct {
    const char *params;
    const uint8_t *scene;
    uint64_t conn;
    bool fits;
    int status;
    const char *text;
} fits[] = {
    /* what decides about pixels alone */
    { "-ab 1 -x 90 -y 9 -ps 1 -pt 0 -pj .9 -pa 0", scene, ANA, true, 0, "" },
    { "-ab 1 -pm .5 -pd .1 -pXYZ", scene, ANA, true, 0, "" },
    { "-ab 1 -aa .3", scene, ANA, false, EX_DATAERR, "-aa differs" },
    { "-ab 2", scene, ANA, false, EX_DATAERR, "-ab differs" },
    { "-ab 1 -ad 99", scene, ANA, false, EX_DATAERR, "-ad differs" },
    { "-ab 1 -av 1 1 1", scene, ANA, false, EX_DATAERR, "-av differs" },
    { "-ab 1 -ae wall", scene, ANA, false, EX_DATAERR, "differs" },
    { "-ab 1 -lw .1", scene, ANA, false, EX_DATAERR, "-lw differs" },
    { "-ab 1 -ds .1", scene, ANA, false, EX_DATAERR, "-ds differs" },
    { "-ab 1 -st .7", scene, ANA, false, EX_DATAERR, "-st differs" },
    { "-ab 1 -dv-", scene, ANA, false, EX_DATAERR, "-dv" },
    { "-ab 1 --seed=3", scene, ANA, false, EX_DATAERR, "--seed differs" },
    { "-ab 1", other_scene, ANA, false, EX_DATAERR, "of another scene" },
    { "-ab 1", scene, BOB, false, EX_NOPERM, "another user" },
    { "-ab 1", scene, ADMIN, false, EX_NOPERM, "another user" },
};

LOOP_TEST(only_what_decides_about_records_must_be_equal, N_ELEM(fits))
{
    struct msg m = submit_of(job_c, job_a);

    whole_job(job_a);
    m.submit.params = fits[_i].params;
    m.submit.scene = fits[_i].scene;
    say(fits[_i].conn, &m);
    if (fits[_i].fits) {
        ck_assert_int_eq(f.last[ANA].type, MSG_ACCEPT);
        return;
    }
    ck_assert_int_eq(f.last[fits[_i].conn].type, MSG_FAILED);
    ck_assert_msg(f.last[fits[_i].conn].failed.status == fits[_i].status &&
                      strstr(f.last[fits[_i].conn].failed.text, fits[_i].text),
                  "%s", f.last[fits[_i].conn].failed.text);
    ck_assert_ptr_null(find(job_c));
    /* the last one that fits is none, then */
    m.submit.reuse = last;
    say(fits[_i].conn, &m);
    ck_assert_int_eq(f.last[fits[_i].conn].type, MSG_ACCEPT);
    ck_assert(!(find(job_c)->spec.flags & MSG_JOB_REUSE));
}

static void
refused(int status, const char *text)
{
    submit_job(ANA, job_c, job_a);
    ck_assert_int_eq(f.last[ANA].type, MSG_FAILED);
    ck_assert_msg(f.last[ANA].failed.status == status &&
                      strstr(f.last[ANA].failed.text, text),
                  "%d: %s", f.last[ANA].failed.status, f.last[ANA].failed.text);
}

TEST(a_job_that_has_no_cache_is_refused_with_why)
{
    struct msg live = submit_of(job_b, NULL);

    refused(EX_NOINPUT, "no job aa0");
    submit_job(ANA, job_a, NULL);
    refused(EX_TEMPFAIL, "is not done yet");
    about(ANA, MSG_CANCEL, job_a);
    refused(EX_DATAERR, "is cancelled");
    about(ANA, MSG_DELETE, job_a);
    live.submit.flags = MSG_JOB_SHARE;
    live.submit.job = job_a;
    say(ANA, &live);
    ready(WORKER, job_a);
    for (uint32_t u = 0; u < 4; u++)
        result(WORKER, job_a, u, 1);
    refused(EX_DATAERR, "had no ambient cache in passes");
}

TEST(a_cache_that_is_gone_is_refused)
{
    whole_job(job_a);
    coord_job_filed(f.c, f.now_ms, job_a, find(job_a)->sequence, 900, 0);
    refused(EX_NOINPUT, "or not any more");
    coord_set_keep(f.c, &(struct coord_keep){ .jobs = 10 });
    refused(EX_NOINPUT, "keep_caches_mib is 0");
}

/* --- for how long --- */

TEST(the_oldest_caches_go_first)
{
    struct coord_keep keep = { .jobs = 10,
                               .cache_bytes = 2 * PASSES * AMBSHARE_BYTES };

    coord_set_keep(f.c, &keep);
    whole_job(job_b);
    whole_job(job_a);
    wait_s(1);
    ck_assert_uint_eq(f.drops, 0);
    whole_job(job_c);
    wait_s(1);
    ck_assert_uint_eq(f.drops, 1);
    ck_assert_mem_eq(f.cache_of, job_b, MSG_JOB);
    ck_assert_uint_eq(find(job_b)->cache.bytes, 0);
    ck_assert_uint_gt(find(job_a)->cache.bytes, 0);
    coord_job_filed(f.c, f.now_ms, job_b, find(job_b)->sequence, 500, 0);
    ck_assert_uint_eq(find(job_b)->kept_bytes, 500);
    keep.cache_bytes = 0;
    coord_set_keep(f.c, &keep);
    carry_out();
    ck_assert_uint_eq(f.drops, 3);
    ck_assert_uint_eq(find(job_a)->cache.bytes + find(job_c)->cache.bytes, 0);
}

/* With the end the store keeps the cache, which would stay then. */
TEST(a_cache_is_not_dropped_before_the_end_of_its_job_is_kept)
{
    submit_job(ANA, job_a, NULL);
    ready(WORKER, job_a);
    render(job_a, 0, 1);
    coord_set_keep(f.c, &(struct coord_keep){ .jobs = 10 });
    carry_out();
    ck_assert_uint_eq(f.drops, 0);
    file(job_a);
    wait_s(1);
    ck_assert_uint_eq(f.drops, 1);
}

/* The job that begins with it waits for its files. */
TEST(a_cache_stays_until_who_begins_with_it_has_it)
{
    struct coord_keep keep = { .jobs = 1, .ms = 1 };

    whole_job(job_a);
    f.have = false;
    submit_job(ANA, job_c, last);
    ck_assert_int_ne(f.last[ANA].type, MSG_ACCEPT);
    coord_set_keep(f.c, &keep);
    wait_s(120);
    ck_assert(find(job_a) && find(job_a)->cache.bytes > 0 && f.drops == 0);
    f.have = true;
    file_came(ANA, hash);
    ck_assert_int_eq(f.last[ANA].type, MSG_ACCEPT);
    ck_assert_mem_eq(f.last[ANA].accept.reuse, job_a, MSG_JOB);
    wait_s(2);
    ck_assert_ptr_null(find(job_a));
}

TEST(a_cache_beyond_the_limit_is_not_kept_at_all)
{
    coord_set_keep(
        f.c, &(struct coord_keep){
                 .jobs = 10, .cache_bytes = PASSES * AMBSHARE_BYTES - 1 });
    whole_job(job_a);
    ck_assert_uint_eq(find(job_a)->cache.bytes, 0);
    ck_assert_uint_eq(f.drops, 0);
}

/* --- how the job begins --- */

static void
came(const uint8_t *job, uint32_t n, int status)
{
    struct saved_cache cache = { .status = status, .text = "it is damaged" };

    if (!status) {
        cache.len = n * AMBSHARE_BYTES;
        cache.records = calloc(n, AMBSHARE_BYTES);
        ck_assert_ptr_nonnull(cache.records);
        for (uint32_t i = 0; i < n; i++)
            cache.records[i * AMBSHARE_BYTES] = (uint8_t)(i + 1);
    }
    coord_cache_came(f.c, ++f.now_ms, job, find(job)->sequence, &cache);
    carry_out();
}

TEST(tiles_wait_for_the_records)
{
    struct passes_state s;

    whole_job(job_a);
    submit_job(ANA, job_c, last);
    ck_assert_uint_eq(f.loads, 0);
    ready(WORKER, job_c);
    ck_assert_uint_eq(f.loads, 1);
    ck_assert_mem_eq(f.cache_of, job_c, MSG_JOB);
    wait_s(2);
    ck_assert_int_ne(f.last[WORKER].type, MSG_TILE);
    join(SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    find(job_c)->state = JOB_PAUSED; /* no tile hides the records */
    came(job_c, 3, 0);
    ck_assert_int_eq(f.last[WORKER].type, MSG_FROZEN);
    ck_assert_uint_eq(f.last[WORKER].frozen.pass, 0);
    ck_assert_uint_eq(f.last[WORKER].frozen.count, 3);
    ck_assert_uint_eq(f.last[WORKER].frozen.data[2 * AMBSHARE_BYTES], 3);
    ready(SECOND, job_c);
    ck_assert_int_eq(f.last[SECOND].type, MSG_FROZEN);
    ck_assert_uint_eq(f.last[SECOND].frozen.count, 3);
    find(job_c)->state = JOB_RUNNING;
    wait_s(1);
    ck_assert_int_eq(f.last[WORKER].type, MSG_TILE);
    ck_assert_uint_eq(f.last[WORKER].tile.pass, 1);
    s = passes_state(find(job_c));
    ck_assert_uint_eq(s.open, 1);
    ck_assert_uint_eq(s.n, 1 + PASSES);
    coord_closed(f.c, ++f.now_ms, SECOND, "gone");
    render(job_c, 1, 2);
    ck_assert_uint_eq(find(job_c)->cache.reused, 3);
    ck_assert_uint_eq(find(job_c)->cache.bytes,
                      (3 + 2 * PASSES) * AMBSHARE_BYTES);
}

TEST(a_job_without_its_records_fails)
{
    whole_job(job_a);
    submit_job(ANA, job_c, job_a);
    ready(WORKER, job_c);
    came(job_c, 0, EX_DATAERR);
    ck_assert_int_eq(f.last[ANA].type, MSG_FAILED);
    ck_assert_int_eq(f.last[ANA].failed.status, EX_DATAERR);
    ck_assert_str_eq(f.last[ANA].failed.text, "it is damaged");
}

/* Its own passes are kept, too; the records of the first are asked for again,
 * and a worker that has them need not wait. */
TEST(a_job_of_an_earlier_life_goes_on_with_them)
{
    struct msg m = submit_of(job_c, job_a);
    struct saved_pass passes[2] = { { .len = 3 * AMBSHARE_BYTES },
                                    { .bytes = records,
                                      .len = 2 * AMBSHARE_BYTES } };
    struct saved_frame none = { 0 };
    struct saved_job s = { .spec = m.submit,
                           .owner = "ana",
                           .text = "",
                           .frames = &none,
                           .npasses = 2,
                           .passes = passes };
    struct msg knows = { .type = MSG_READY, .ready = { job_c, .1, 7, 2, 0 } };

    ck_assert_int_eq(recover_job(f.c, f.now_ms, &s, NULL, NULL, NULL), 0);
    join(SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    ready(WORKER, job_c);
    ck_assert_uint_eq(f.loads, 1);
    ck_assert_uint_eq(passes_state(find(job_c)).open, 2);
    ck_assert_uint_eq(passes_state(find(job_c)).bytes, 5 * AMBSHARE_BYTES);
    ck_assert_int_ne(f.last[WORKER].type, MSG_TILE);
    knows.ready.passes = 2;
    say(SECOND, &knows);
    ck_assert_int_eq(f.last[SECOND].type, MSG_TILE);
    ck_assert_uint_eq(f.last[SECOND].tile.pass, 2);
    find(job_c)->state = JOB_PAUSED;
    came(job_c, 3, 0);
    ck_assert_int_eq(f.last[WORKER].type, MSG_FROZEN);
    ck_assert_uint_eq(f.last[WORKER].frozen.pass, 1);
    ck_assert_uint_eq(f.last[WORKER].frozen.count, 2);
    ck_assert_uint_eq(passes_state(find(job_c)).bytes, 5 * AMBSHARE_BYTES);
}

/* It was cancelled on a full disk, where that could not be noted. */
TEST(a_job_that_was_given_up_is_cancelled_in_the_next_life)
{
    struct msg m = submit_of(job_c, job_a);
    struct saved_frame none = { 0 };
    struct saved_job s = { .spec = m.submit,
                           .owner = "ana",
                           .text = "",
                           .frames = &none,
                           .given_up = true };

    ck_assert_int_eq(recover_job(f.c, f.now_ms, &s, NULL, NULL, NULL), 0);
    ck_assert_int_eq(find(job_c)->state, JOB_CANCELLED);
    join(SECOND, MSG_ROLE_WORKER, "ws2", "daemon");
    ready(WORKER, job_c);
    ck_assert_uint_eq(f.loads, 0);
}

/* All rows were there when the coordinator died: it is over before any worker
 * is ready, and has counted what it counted, and left what it left. */
LOOP_TEST(a_job_that_was_all_but_over_leaves_its_cache, 2)
{
    struct msg m = submit_of(job_c, job_a);
    struct saved_pass passes[1 + PASSES] = { { .len = 3 * AMBSHARE_BYTES } };
    struct saved_unit units[4];
    struct saved_frame written = { .written = true };
    struct saved_job s = { .spec = m.submit,
                           .owner = "ana",
                           .text = "",
                           .frames = &written,
                           .nunits = 4,
                           .units = units,
                           .npasses = 1 + PASSES - (_i == 1),
                           .passes = passes };

    for (uint32_t i = 1; i <= PASSES; i++)
        passes[i] = (struct saved_pass){ .bytes = records,
                                         .len = AMBSHARE_BYTES,
                                         .counts = { .rays = 7 } };
    for (uint32_t i = 0; i < 4; i++)
        units[i] =
            (struct saved_unit){ .unit = i,
                                 .area = { 0, i % 2 * 4, i / 2 * 4, 4, 4 },
                                 .attempt = 1,
                                 .worker = "ws1",
                                 .stored = 4,
                                 .done = true };
    ck_assert_int_eq(recover_job(f.c, f.now_ms, &s, NULL, NULL, NULL), 0);
    carry_out();
    ck_assert_int_eq(find(job_c)->state, JOB_DONE);
    ck_assert_uint_eq(find(job_c)->cache.reused, 3);
    ck_assert_uint_eq(find(job_c)->tiled.rays, 7 * (s.npasses - 1));
    ck_assert_uint_eq(find(job_c)->cache.bytes,
                      _i == 0 ? (3 + PASSES) * AMBSHARE_BYTES : 0);
    ck_assert_uint_eq(f.loads, 0);
}

static const struct {
    size_t len; /* of the last stage's decision; 0: it is not there */
    const char *why;
} lost[] = { { 0, "had no room" }, { 36, "another version" } };

/* Rows are there, and what they were made by is not, or cannot be read. */
LOOP_TEST(a_job_whose_decision_is_lost_says_why, N_ELEM(lost))
{
    struct msg m = submit_of(job_c, NULL);
    struct saved_pass passes[PASSES + 1];
    struct saved_unit unit = { .area = { 0, 0, 0, 4, 4 },
                               .attempt = 1,
                               .worker = "ws1",
                               .stored = 4,
                               .done = true };
    struct saved_frame none = { 0 };
    struct saved_job s = { .spec = m.submit,
                           .owner = "ana",
                           .text = "",
                           .frames = &none,
                           .nunits = 1,
                           .units = &unit,
                           .npasses = PASSES + (lost[_i].len > 0),
                           .passes = passes };

    s.spec.error_ppm = 100000;
    for (uint32_t i = 0; i < PASSES; i++)
        passes[i] =
            (struct saved_pass){ .bytes = records, .len = AMBSHARE_BYTES };
    passes[PASSES] =
        (struct saved_pass){ .bytes = records, .len = lost[_i].len };
    ck_assert_int_eq(recover_job(f.c, f.now_ms, &s, NULL, NULL, NULL), 0);
    carry_out();
    ck_assert_int_eq(find(job_c)->state, JOB_FAILED);
    ck_assert_ptr_nonnull(strstr(find(job_c)->text, lost[_i].why));
}

/* --- files --- */

static struct folder folder;
static bool no_sync; /* no file can be synced */

/* In place of the C library's. */
int
fdatasync(int fd)
{
    errno = EIO;
    return no_sync ? -1 : (int)syscall(SYS_fdatasync, fd);
}

static void
set_up_folder(void)
{
    scratch_make();
    memset(&folder, 0, sizeof folder);
    snprintf(folder.dir, sizeof folder.dir, "%s", dir);
    folder.durable = true;
    ck_assert_int_eq(folder_init(&folder, NULL), 0);
}

static void
tear_down_folder(void)
{
    folder_forget(&folder, job_a);
    folder_forget(&folder, job_b);
    folder_forgotten(&folder, job_a);
    folder_forgotten(&folder, job_b);
    folder_release(&folder);
    scratch_remove();
}

FIXTURE(set_up_folder, tear_down_folder)

static void
make(const uint8_t *job)
{
    struct msg m = submit_of(job, NULL);

    ck_assert_int_eq(folder_make(&folder, &m.submit, NULL), 0);
}

static void
put_pass(const uint8_t *job, uint32_t pass, uint8_t first, size_t len)
{
    uint8_t bytes[100];
    struct saved_pass p = { .bytes = bytes,
                            .len = len,
                            .counts = { .rays = pass } };

    for (size_t i = 0; i < len; i++)
        bytes[i] = (uint8_t)(first + i);
    folder_put_pass(&folder, job, pass, &p);
}

static void
make_done(const uint8_t *job)
{
    make(job);
    put_pass(job, 0, 1, 30);
    put_pass(job, 1, 31, 0);
    put_pass(job, 2, 31, 20);
    folder_keep_cache(&folder, job, &(struct pass_range){ 0, 3, 3 });
    folder_rest(&folder, job);
    ck_assert_uint_gt(folder_cache_bytes(&folder, job), 50);
}

TEST(all_passes_become_the_first_of_another_job)
{
    struct saved_pass pass[MSG_MOST_PASSES];
    struct rad_error err = { 0 };
    uint8_t *bytes;
    size_t len;
    uint32_t n;

    make_done(job_a);
    make(job_b);
    for (int twice = 0; twice < 2; twice++) /* room was short */
        ck_assert_int_eq(folder_reuse(&folder, job_b, job_a, &err), 0);
    folder_drop_cache(&folder, job_a);
    ck_assert_uint_eq(folder_cache_bytes(&folder, job_a), 0);
    put_pass(job_b, 1, 90, 5);
    bytes = folder_read_first(&folder, job_b, &len, &err);
    ck_assert_ptr_nonnull(bytes);
    ck_assert_uint_eq(len, 50);
    for (size_t i = 0; i < len; i++)
        ck_assert_uint_eq(bytes[i], i + 1);
    free(bytes);
    ck_assert_int_eq(folder_read_passes(&folder, job_b, pass, &n, &bytes, &err),
                     0);
    ck_assert_uint_eq(n, 2);
    ck_assert_uint_eq(pass[1].len, 5);
    free(bytes);
    /* and these are that job's own cache, in its turn */
    folder_keep_cache(&folder, job_b, &(struct pass_range){ 0, 2, 2 });
    folder_rest(&folder, job_b);
    make(job_a);
    ck_assert_int_eq(folder_reuse(&folder, job_a, job_b, &err), 0);
    bytes = folder_read_first(&folder, job_a, &len, &err);
    ck_assert_uint_eq(len, 55);
    ck_assert_uint_eq(bytes[50], 90);
    free(bytes);
}

/* A life that was killed may have written passes that a loss of power would
 * take; the rows that are made by them would stay. */
TEST(passes_that_cannot_be_synced_are_not_used)
{
    struct saved_pass pass[MSG_MOST_PASSES];
    uint8_t *bytes;
    uint32_t n;

    make(job_a);
    put_pass(job_a, 0, 1, 30);
    no_sync = true;
    ck_assert_int_eq(folder_read_passes(&folder, job_a, pass, &n, &bytes, NULL),
                     RAD_EIO);
    no_sync = false;
    ck_assert_uint_eq(n, 0);
    ck_assert_int_eq(folder_read_passes(&folder, job_a, pass, &n, &bytes, NULL),
                     0);
    ck_assert_uint_eq(n, 1);
    free(bytes);
}

static void
put_row(const uint8_t *job)
{
    float black[8 * 3] = { 0 };
    struct action_rows key = { .rows = 1, .width = 8, .channels = 3 };
    struct folder_pixels px = { black, sizeof black, NULL };

    memcpy(key.job, job, MSG_JOB);
    ck_assert_int_eq(folder_put_rows(&folder, &key, &px, NULL, NULL), 0);
}

/* Its folder is gone. */
TEST(of_a_job_that_is_over_nothing_is_left_to_sync)
{
    make(job_a);
    make(job_b);
    ck_assert_int_eq(folder_sync(&folder, NULL), 0);
    put_row(job_a);
    put_row(job_b);
    folder_rest(&folder, job_a);
    ck_assert_ptr_nonnull(folder.changed);
    folder_rest(&folder, job_b);
    ck_assert_ptr_null(folder.changed);
    ck_assert_int_eq(folder_sync(&folder, NULL), 0);
}

TEST(a_cache_that_lacks_a_pass_is_not_kept)
{
    make(job_a);
    put_pass(job_a, 0, 1, 30);
    folder_keep_cache(&folder, job_a, &(struct pass_range){ 0, 2, 2 });
    folder_rest(&folder, job_a);
    ck_assert_uint_eq(folder_cache_bytes(&folder, job_a), 0);
    make(job_b);
    ck_assert_int_eq(folder_reuse(&folder, job_b, job_a, NULL), RAD_EDATA);
}

/* The coordinator died after the cache was kept, and before the end was noted:
 * the job goes on with its passes. */
TEST(a_job_whose_end_was_not_noted_has_its_passes)
{
    struct saved_pass pass[MSG_MOST_PASSES];
    uint8_t *bytes;
    uint32_t n;

    make(job_a);
    put_pass(job_a, 0, 1, 30);
    folder_keep_cache(&folder, job_a, &(struct pass_range){ 0, 1, 1 });
    ck_assert_int_eq(folder_read_passes(&folder, job_a, pass, &n, &bytes, NULL),
                     0);
    ck_assert_uint_eq(n, 1);
    ck_assert_uint_eq(pass[0].len, 30);
    free(bytes);
    ck_assert_uint_eq(folder_cache_bytes(&folder, job_a), 0);
    put_pass(job_a, 1, 31, 20); /* in place of the tail */
    folder_keep_cache(&folder, job_a, &(struct pass_range){ 0, 2, 2 });
    folder_rest(&folder, job_a);
    make(job_b);
    ck_assert_int_eq(folder_reuse(&folder, job_b, job_a, NULL), 0);
}

/* Cut anywhere, or with any byte other than it was, it is not used. */
TEST(a_cache_that_is_damaged_is_not_used)
{
    uint8_t bytes[2000], work[2000];
    char path[200];
    size_t n;
    FILE *file;

    make_done(job_a);
    snprintf(path, sizeof path, "%s/jobs/aa000000000000000000000000000000/kept",
             dir);
    file = fopen(path, "r");
    ck_assert_ptr_nonnull(file);
    n = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    ck_assert(n > 50 && n < sizeof bytes);
    memcpy(work, bytes, n);
    ck_assert_uint_eq(folder_parse_kept(work, n), 50);
    for (size_t i = 0; i < n; i++) {
        memcpy(work, bytes, n);
        ck_assert_uint_eq(folder_parse_kept(work, i), FOLDER_NO_CACHE);
        memcpy(work, bytes, n);
        work[i] ^= 4;
        ck_assert_uint_eq(folder_parse_kept(work, n), FOLDER_NO_CACHE);
    }
    file = fopen(path, "r+");
    fputc('x', file);
    fclose(file);
    make(job_b);
    ck_assert_int_eq(folder_reuse(&folder, job_b, job_a, NULL), RAD_EDATA);
}

/* Descriptors or memory may be there in a moment. */
TEST(a_cache_that_cannot_be_read_now_is_not_damaged)
{
    struct rad_error err = { 0 };
    struct rlimit before, none;
    uint8_t *bytes;
    size_t len;
    int rc;

    make_done(job_a);
    make(job_b);
    ck_assert_int_eq(getrlimit(RLIMIT_NOFILE, &before), 0);
    none = before;
    none.rlim_cur = 0;
    setrlimit(RLIMIT_NOFILE, &none);
    rc = folder_reuse(&folder, job_b, job_a, &err);
    setrlimit(RLIMIT_NOFILE, &before);
    ck_assert_int_eq(rc, RAD_ESHORT);
    ck_assert_int_eq(folder_reuse(&folder, job_b, job_a, NULL), 0);
    memset(&err, 0, sizeof err);
    setrlimit(RLIMIT_NOFILE, &none);
    bytes = folder_read_first(&folder, job_b, &len, &err);
    setrlimit(RLIMIT_NOFILE, &before);
    ck_assert_ptr_null(bytes);
    ck_assert_int_eq(err.code, RAD_ESHORT);
}
