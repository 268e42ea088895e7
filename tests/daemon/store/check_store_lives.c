/* check_store_lives.c - what a store finds of the one before it: jobs, rows,
 * base lines; damage */
#include "config.h"

#include "check/statecheck.h"
#include "journal/journal_impl.h"
#include "store/store_impl.h"
#include "store_fixture.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>

/* --- another life --- */

static const uint8_t kept_job[MSG_JOB] = { 9, 8, 7 };
static const uint8_t kept_manifest[MSG_HASH] = { 6, 5, 4 };
static const struct msg_frame kept_frame = { 0, W, H, "-vtv -vp 0 0 0" };

static void
open_for(uv_loop_t *loop, struct store **s, const struct store_handler *to,
         struct heard *h)
{
    struct rad_error err = { 0 };

    memset(h, 0, sizeof *h);
    uv_loop_init(loop);
    *s = store_open(loop, dir, true, to, h, &err);
    ck_assert_msg(*s != NULL, "%s: %s", err.where, err.what);
}

static void
open_kept(uv_loop_t *loop, struct store **s, struct heard *h)
{
    open_for(loop, s, &handler, h);
}

static void
close_kept(uv_loop_t *loop, struct store *s)
{
    run(loop, s);
    store_close(s);
    ck_assert_int_eq(uv_loop_close(loop), 0);
}

static void
open_job_as(struct store *s, uint32_t flags)
{
    struct saved_job p = { .spec = { .manifest = kept_manifest,
                                     .params = "-ab 0",
                                     .flags = flags,
                                     .frames = &kept_frame,
                                     .nframes = 1 },
                           .owner = "ana" };

    store_open_job(s, kept_job, &p);
}

static void
open_job(struct store *s)
{
    open_job_as(s, 0);
}

/* End the job as cancelled. */
static void
end_job(struct store *s)
{
    struct saved_job end = { .spec = { .job = kept_job,
                                       .manifest = kept_manifest,
                                       .params = "-ab 0",
                                       .frames = &kept_frame,
                                       .nframes = 1 },
                             .sequence = 6,
                             .state = 5,
                             .last = { .state = 5 } };

    store_end_job(s, &end, strdup("{ }"), 3);
}

static void
forget(struct store *s, const uint8_t *job)
{
    struct saved_gone gone = { .why = GONE_DELETED };

    memcpy(gone.job, job, MSG_JOB);
    store_forget_job(s, &gone);
}

static void
forget_job(struct store *s)
{
    forget(s, kept_job);
}

static int
note_job(void *arg, const struct saved_job *s, struct rad_error *err)
{
    struct saved_job *to = arg;

    (void)err;
    ck_assert_mem_eq(s->spec.job, kept_job, MSG_JOB);
    ck_assert_str_eq(s->spec.params, "-ab 0");
    ck_assert_str_eq(s->owner, "ana");
    ck_assert_str_eq(s->spec.frames[0].view, kept_frame.view);
    *to = *s;
    if (s->nunits > 0) {
        ck_assert_uint_eq(s->units[0].area.height, 3);
        ck_assert_str_eq(s->units[0].worker, "ws1");
        ck_assert_uint_eq(s->units[0].stored, 3);
    }
    return 0;
}

static int
recover(struct store *s, struct saved_job *job, struct rad_error *err)
{
    uint64_t epoch;

    memset(job, 0, sizeof *job);
    return store_recover(s, 1000, &epoch, note_job, job, err);
}

static void
make_kept(uv_loop_t *loop, struct store **s, struct heard *h)
{
    struct saved_job none;

    open_kept(loop, s, h);
    ck_assert_int_eq(recover(*s, &none, NULL), 0);
    open_job(*s);
    put_unit(*s, kept_job, 0, 3, 3);
    run(loop, *s);
    ck_assert_int_eq(h->jobs, 1);
    ck_assert_int_eq(h->rows, 1);
    ck_assert_int_eq(h->status, 0);
}

START_TEST(a_job_goes_on_in_another_life)
{
    struct saved_job job;
    struct heard h;
    uint8_t row[W * 3 * 4];
    float px[3];
    uv_loop_t loop;
    struct store *s;

    make_kept(&loop, &s, &h);
    close_kept(&loop, s);
    open_kept(&loop, &s, &h);
    ck_assert_int_eq(recover(s, &job, NULL), 0);
    ck_assert_uint_eq(job.nunits, 1);
    ck_assert_uint_eq(job.lives, 1);
    ck_assert(store_read_row(s, kept_job, 0, 2, row));
    wire_floats_get(px, row, 3);
    ck_assert_float_eq(px[0], 2);
    put_unit(s, kept_job, 1, 3, 3);
    store_write_picture(s, kept_job, 5, 0);
    store_settle(s, 5, 44);
    close_kept(&loop, s);
    ck_assert_int_eq(h.pictures, 1);
    ck_assert_uint_eq(h.settled, 44);
    ck_assert(is_there("jobs/09080700000000000000000000000000/0.hdr"));
    ck_assert(!is_there("jobs/09080700000000000000000000000000/0.rows"));
}
END_TEST

START_TEST(a_job_that_is_over_is_remembered_and_forgotten)
{
    struct store_source from = { .what = MSG_WHAT_STATS };
    struct saved_job job, end = { .spec = { .job = kept_job,
                                            .manifest = kept_manifest,
                                            .params = "-ab 0",
                                            .frames = &kept_frame,
                                            .nframes = 1 },
                                  .sequence = 6,
                                  .state = 4,
                                  .status = 70,
                                  .text = "it was too late",
                                  .last = { .state = 4, .rays = 17 } };
    struct heard h;
    char buf[100];
    uv_loop_t loop;
    struct store *s;

    memcpy(from.job, kept_job, MSG_JOB);
    make_kept(&loop, &s, &h);
    store_end_job(s, &end, strdup("{ }"), 3);
    close_kept(&loop, s);
    ck_assert_int_eq(h.filed, 1);
    ck_assert_uint_eq(h.sequence, 6);
    open_kept(&loop, &s, &h);
    ck_assert_int_eq(recover(s, &job, NULL), 0);
    ck_assert_uint_eq(job.state, 4);
    ck_assert_int_eq(job.status, 70);
    ck_assert_uint_eq(job.last.rays, 17);
    read_all(s, &from, buf, sizeof buf, &h);
    run(&loop, s);
    ck_assert_int_eq(h.n, 3);
    store_forget_job(s, &(struct saved_gone){ .job = { 9, 8, 7 } });
    close_kept(&loop, s);
    open_kept(&loop, &s, &h);
    ck_assert_int_eq(recover(s, &job, NULL), 0);
    ck_assert_ptr_null(job.spec.job);
    close_kept(&loop, s);
}
END_TEST

#define KEPT_DIR "jobs/09080700000000000000000000000000"

/* How far the database was with a job whose folder was being removed when the
 * coordinator was killed. */
enum unsettled { UNSETTLED_JOB, UNSETTLED_END, UNSETTLED_STRIKE };

/* In a process of its own: forget a job, and be killed when the folder has its
 * other name, before the tasks that write the database are committed. */
static void
die_forgetting(enum unsettled how)
{
    struct saved_job none;
    struct heard h;
    uv_loop_t loop;
    struct store *s;

    if (how == UNSETTLED_JOB) {
        open_kept(&loop, &s, &h);
        recover(s, &none, NULL);
        store_settle(s, 5, 1); /* the next commit is 20 ms away */
        run(&loop, s);
        open_job(s);
        while (!is_there(KEPT_DIR "/room"))
            uv_run(&loop, UV_RUN_NOWAIT);
    } else {
        make_kept(&loop, &s, &h);
    }
    end_job(s);
    if (how == UNSETTLED_STRIKE)
        run(&loop, s);
    forget_job(s);
    while (!is_there(KEPT_DIR ".gone"))
        uv_run(&loop, UV_RUN_NOWAIT);
    kill(getpid(), SIGKILL);
}

static void
tell_problem(void *arg, bool problem, const char *text)
{
    (void)arg;
    ck_assert_msg(!problem, "%s", text);
}

START_TEST(a_job_that_was_being_forgotten_is_no_damage)
{
    struct rad_error err = { 0 };
    struct statecheck found;
    struct saved_job job;
    struct heard h;
    uv_loop_t loop;
    struct store *s;
    pid_t pid = fork();
    int status;

    if (pid == 0)
        die_forgetting((enum unsettled)_i);
    ck_assert_int_eq(waitpid(pid, &status, 0), pid);
    ck_assert(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
    ck_assert_int_eq(statecheck_run(dir, &found, tell_problem, NULL, &err), 0);
    ck_assert_uint_eq(found.jobs, 0);
    open_kept(&loop, &s, &h);
    ck_assert_msg(recover(s, &job, &err) == 0, "%s: %s", err.where, err.what);
    ck_assert_ptr_null(job.spec.job);
    ck_assert(!is_there(KEPT_DIR));
    ck_assert(!is_there(KEPT_DIR ".gone"));
    close_kept(&loop, s);
}
END_TEST

/* The job takes rows, and has them in another life. */
static void
keeps_a_unit(uv_loop_t *loop, struct store **s, struct heard *h,
             struct saved_job *job)
{
    put_unit(*s, kept_job, 0, 3, 3);
    run(loop, *s);
    ck_assert_int_eq(h->status, 0);
    close_kept(loop, *s);
    open_kept(loop, s, h);
    ck_assert_int_eq(recover(*s, job, NULL), 0);
    ck_assert_uint_eq(job->nunits, 1);
}

static void
note_gone(void *arg, const struct saved_gone *g)
{
    struct heard *h = arg;

    h->files++;
    h->status = (int)g->why;
}

/* That job's record is the later one's. */
START_TEST(an_id_that_is_forgotten_twice_is_recorded_as_it_was_last)
{
    struct store_handler hears = handler;
    struct saved_job job;
    struct heard h;
    uv_loop_t loop;
    struct store *s;

    hears.gone = note_gone;
    open_kept(&loop, &s, &h);
    ck_assert_int_eq(recover(s, &job, NULL), 0);
    for (enum gone_why why = GONE_MANY; why <= GONE_OLD; why++) {
        open_job(s);
        run(&loop, s);
        end_job(s);
        store_forget_job(s, &(struct saved_gone){ { 9, 8, 7 }, .why = why });
    }
    close_kept(&loop, s);
    open_for(&loop, &s, &hears, &h);
    ck_assert_int_eq(recover(s, &job, NULL), 0);
    ck_assert_int_eq(h.files, 1);
    ck_assert_int_eq(h.status, GONE_OLD);
    close_kept(&loop, s);
}
END_TEST

/* Of an earlier job of the same id, which is long forgotten, a file could not
 * be removed. */
START_TEST(what_is_left_of_a_forgotten_job_does_no_harm_to_the_next_of_its_id)
{
    struct rad_error err = { 0 };
    struct statecheck found;
    struct saved_job job;
    char command[200];
    struct heard h;
    uv_loop_t loop;
    struct store *s;

    open_kept(&loop, &s, &h);
    ck_assert_int_eq(recover(s, &job, NULL), 0);
    open_job(s);
    close_kept(&loop, s);
    snprintf(command, sizeof command,
             "cd %s && mkdir " KEPT_DIR ".gone && touch " KEPT_DIR
             ".gone/0.hdr",
             dir);
    ck_assert_int_eq(system(command), 0);
    ck_assert_int_eq(statecheck_run(dir, &found, tell_problem, NULL, &err), 0);
    ck_assert_uint_eq(found.jobs, 1);
    open_kept(&loop, &s, &h);
    ck_assert_int_eq(recover(s, &job, NULL), 0);
    ck_assert_ptr_nonnull(job.spec.job);
    ck_assert(!is_there(KEPT_DIR ".gone"));
    ck_assert(is_there(KEPT_DIR "/room"));
    close_kept(&loop, s);
}
END_TEST

/* How many more files the folder of the job has that is being forgotten, and
 * whether the new job is submitted after DELETE was answered. */
static const struct {
    int files;
    bool answered;
} old_jobs[] = {
    { 0, false },
    { 0, true },
    { 2500, false }, /* more than one task removes */
    { 2500, true },
};

START_TEST(a_job_may_have_the_id_of_one_that_is_being_forgotten)
{
    struct saved_job job;
    struct heard h;
    char path[200];
    uv_loop_t loop;
    struct store *s;
    FILE *f;

    make_kept(&loop, &s, &h);
    end_job(s);
    run(&loop, s);
    for (int i = 0; i < old_jobs[_i].files; i++) {
        snprintf(path, sizeof path, "%s/" KEPT_DIR "/%d.hdr", dir, i + 1);
        f = fopen(path, "w");
        ck_assert_ptr_nonnull(f);
        fclose(f);
    }
    h.jobs = 0;
    forget_job(s);
    store_settle(s, 5, 44);
    while (old_jobs[_i].answered && h.settled != 44)
        uv_run(&loop, UV_RUN_ONCE);
    open_job(s);
    store_put_state(s, kept_job, 2, 7);
    run(&loop, s);
    ck_assert_int_eq(h.jobs, 1);
    ck_assert(!is_there(KEPT_DIR ".gone"));
    keeps_a_unit(&loop, &s, &h, &job);
    ck_assert_int_eq(job.state, 2);
    ck_assert_int_eq(job.spec.priority, 7);
    close_kept(&loop, s);
}
END_TEST

static void
count_jobs(void *arg, const uint8_t job[MSG_JOB], uint64_t sequence, int status,
           const char *text)
{
    struct heard *h = arg;

    (void)job;
    (void)sequence;
    (void)text;
    h->jobs += status == 0;
}

/* The second of three jobs that have one id is over, and forgotten, while its
 * opening waits for the first job to be forgotten. */
START_TEST(a_job_may_have_the_id_of_one_that_was_never_opened)
{
    struct store_handler counts = handler;
    struct saved_job job;
    struct heard h;
    uv_loop_t loop;
    struct store *s;

    counts.job = count_jobs;
    open_for(&loop, &s, &counts, &h);
    ck_assert_int_eq(recover(s, &job, NULL), 0);
    open_job(s);
    run(&loop, s);
    for (int i = 0; i < 2; i++) {
        end_job(s);
        forget_job(s);
        open_job(s);
    }
    run(&loop, s);
    ck_assert_int_eq(h.jobs, 2);
    keeps_a_unit(&loop, &s, &h, &job);
    close_kept(&loop, s);
}
END_TEST

static void
count_waits(void *arg, const uint8_t job[MSG_JOB], uint64_t sequence,
            const char *text)
{
    struct heard *h = arg;

    (void)job;
    (void)sequence;
    (void)text;
    h->waits++;
}

static int
count_open(void *arg, const struct saved_job *s, struct rad_error *err)
{
    int *n = arg;

    (void)err;
    *n += s->state < 3;
    return 0;
}

static bool cache_synced, names_synced, jobs_synced;

static bool
is_open_as(int fd, const char *name)
{
    char path[300];
    struct stat st, there;

    snprintf(path, sizeof path, "%s/%s", dir, name);
    return fstat(fd, &st) == 0 && stat(path, &there) == 0 &&
           st.st_ino == there.st_ino;
}

/* What writes and syncs fail with; 0: they do not. */
static _Atomic int write_fault, sync_fault;

/* In place of the C library's: notes whether the state folder was synced when
 * it had its folders, and the folder of jobs. */
int
fsync(int fd)
{
    jobs_synced |= is_open_as(fd, "jobs");
    names_synced |=
        is_open_as(fd, ".") && is_there("jobs") && is_there("files");
    errno = sync_fault;
    return sync_fault ? -1 : (int)syscall(SYS_fsync, fd);
}

/* In place of the C library's: notes whether a job's cache was synced, before
 * it was given the name under which it is kept. */
int
fdatasync(int fd)
{
    cache_synced |= is_open_as(fd, KEPT_DIR "/cache");
    return fsync(fd);
}

/* In place of the C library's, of which SQLite uses either. */
ssize_t
pwrite(int fd, const void *bytes, size_t n, off_t at)
{
    errno = write_fault;
    return write_fault ? -1 : (ssize_t)syscall(SYS_pwrite64, fd, bytes, n, at);
}

ssize_t
pwrite64(int fd, const void *bytes, size_t n, off_t at)
{
    return pwrite(fd, bytes, n, at);
}

START_TEST(a_new_folder_lasts)
{
    struct heard h;
    uv_loop_t loop;
    struct store *s;

    open_kept(&loop, &s, &h);
    ck_assert(names_synced);
    close_kept(&loop, s);
}
END_TEST

/* In place of the C library's: each other call is interrupted by a signal, as a
 * tmpfs is. */
int
posix_fallocate(int fd, off_t at, off_t n)
{
    static _Atomic unsigned calls;

    if (calls++ % 2 == 0)
        return EINTR;
    return fallocate(fd, 0, at, n) < 0 ? errno : 0;
}

START_TEST(a_job_that_is_said_to_be_deleted_is_gone_after_a_loss_of_power)
{
    struct heard h;
    uv_loop_t loop;
    struct store *s;

    make_kept(&loop, &s, &h);
    end_job(s);
    run(&loop, s);
    jobs_synced = false;
    forget_job(s);
    store_settle(s, 5, 44);
    while (h.settled != 44)
        uv_run(&loop, UV_RUN_ONCE);
    ck_assert(jobs_synced);
    close_kept(&loop, s);
}
END_TEST

/* Leave a job that is done, with a cache of so many bytes. */
static void
make_cache(uv_loop_t *loop, struct store *s, size_t bytes)
{
    uint8_t *records = calloc(1, bytes);
    struct saved_job done = { .spec = { .job = kept_job,
                                        .manifest = kept_manifest,
                                        .params = "-ab 0",
                                        .frames = &kept_frame,
                                        .nframes = 1 },
                              .state = 3,
                              .last = { .state = 3 },
                              .cache_bytes = bytes,
                              .keep = { 0, 1, 1 } };

    open_job(s);
    run(loop, s);
    store_put_pass(s, kept_job, 0,
                   &(struct saved_pass){ .bytes = records, .len = bytes });
    store_end_job(s, &done, strdup("{ }"), 3);
    run(loop, s);
    free(records);
    ck_assert(is_there(KEPT_DIR "/kept"));
    ck_assert(cache_synced);
}

static void
limit_files(rlim_t bytes)
{
    struct rlimit limit;

    ck_assert_int_eq(getrlimit(RLIMIT_FSIZE, &limit), 0);
    limit.rlim_cur = bytes;
    ck_assert_int_eq(setrlimit(RLIMIT_FSIZE, &limit), 0);
}

/* There is room for the rows of a job, but not for the records with which it
 * begins; then it is cancelled. */
START_TEST(a_job_that_is_cancelled_while_it_waits_for_room_does_not_come_back)
{
    static const uint8_t second[MSG_JOB] = { 1 };
    struct saved_job job = { .spec = { .job = second,
                                       .manifest = kept_manifest,
                                       .params = "-ab 0",
                                       .flags = MSG_JOB_PASSES | MSG_JOB_SCENE |
                                                MSG_JOB_REUSE,
                                       .scene = kept_manifest,
                                       .reuse = kept_job,
                                       .frames = &kept_frame,
                                       .nframes = 1 },
                             .owner = "ana" };
    struct store_handler counts = handler;
    struct heard h;
    uint64_t epoch;
    int nopen = 0;
    uv_loop_t loop;
    struct store *s;

    signal(SIGXFSZ, SIG_IGN);
    counts.job = count_jobs;
    counts.waits = count_waits;
    open_for(&loop, &s, &counts, &h);
    ck_assert_int_eq(store_recover(s, 1, &epoch, count_open, &nopen, NULL), 0);
    make_cache(&loop, s, 2 << 20);
    h.jobs = 0;
    limit_files(1 << 20);
    store_open_job(s, second, &job);
    while (h.waits == 0)
        uv_run(&loop, UV_RUN_ONCE);
    job.state = job.last.state = 5;
    store_end_job(s, &job, strdup("{ }"), 3);
    limit_files(RLIM_INFINITY);
    close_kept(&loop, s);
    ck_assert_int_eq(h.jobs, 0);
    open_kept(&loop, &s, &h);
    ck_assert_int_eq(store_recover(s, 1, &epoch, count_open, &nopen, NULL), 0);
    ck_assert_int_eq(nopen, 0);
    close_kept(&loop, s);
}
END_TEST

/* What somebody may do to a state folder, and what is said of it. */
static const struct {
    const char *command, *what;
} damages[] = {
    { "rm jobs/*/0.rows", "missing" },
    { "truncate -s 100 jobs/*/0.rows", "100 bytes" },
    { "rm radcoord.db*", "no database" },
    { "echo no database, this >radcoord.db", "database" },
    { "truncate -s 3000 radcoord.db", "database" },
};

START_TEST(a_damaged_folder_is_refused)
{
    struct rad_error err = { 0 };
    struct saved_job job;
    struct heard h;
    char command[200];
    uv_loop_t loop;
    struct store *s;

    make_kept(&loop, &s, &h);
    close_kept(&loop, s);
    snprintf(command, sizeof command, "cd %s && %s", dir, damages[_i].command);
    ck_assert_int_eq(system(command), 0);
    uv_loop_init(&loop);
    s = store_open(&loop, dir, true, &handler, &h, &err);
    if (s) {
        ck_assert_int_lt(recover(s, &job, &err), 0);
        store_close(s);
    }
    uv_loop_close(&loop);
    ck_assert_int_eq(err.code, RAD_EDATA);
    ck_assert_ptr_nonnull(strstr(err.where, "is damaged"));
    ck_assert_msg(strstr(err.what, damages[_i].what) != NULL, "%s", err.what);
    ck_assert_ptr_nonnull(strstr(err.what, "radctl check"));
}
END_TEST

/* No damage, but no job may be left out without a word. */
START_TEST(a_folder_in_which_no_room_can_be_kept_is_refused)
{
    struct rad_error err = { 0 };
    struct saved_job job;
    struct heard h;
    char path[200];
    uv_loop_t loop;
    struct store *s;

    make_kept(&loop, &s, &h);
    close_kept(&loop, s);
    snprintf(path, sizeof path, "%s/" KEPT_DIR "/room", dir);
    ck_assert_int_eq(mkdir(path, 0700), 0);
    open_kept(&loop, &s, &h);
    ck_assert_int_eq(recover(s, &job, &err), RAD_EIO);
    ck_assert_ptr_nonnull(strstr(err.what, "/room"));
    close_kept(&loop, s);
}
END_TEST

static uint8_t
line_byte(int i)
{
    return (uint8_t)(7 * i % 64);
}

static void
keep_units(struct store *s)
{
    for (uint32_t unit = 0; unit < 2; unit++)
        store_keep_unit(s, kept_job,
                        &(struct saved_unit){ .unit = unit,
                                              .area = { 0, 0, 3 * unit, W, 3 },
                                              .worker = "ws1" });
}

/* Rows of unit 0 come in two pieces, those of unit 1 in one; each unit leaves
 * a base line, with so many densities. */
enum { PIECES = 3 };

static void
put_piece(struct store *s, int i, bool coded, uint32_t densities)
{
    static const uint32_t first[PIECES] = { 0, 1, 3 }, n[PIECES] = { 1, 2, 3 };
    uint8_t bytes[W * H * 12], code[H * RAD_HDR_ROW_BYTES(W)];
    struct action_rows a = { .unit = first[i] / 3,
                             .row = first[i] % 3,
                             .rows = n[i],
                             .y = first[i],
                             .width = W,
                             .channels = coded ? 1 : 3,
                             .pixels = bytes,
                             .last = i > 0,
                             .counts = &(struct msg_counts){ 0 } };

    for (int k = 0; k < N_ELEM(bytes); k++)
        bytes[k] = line_byte(k);
    if (coded) {
        a.pixels = code;
        a.len = code_rows(0, (int)first[i], W, (int)n[i], code);
    }
    if (a.last) {
        a.bottom = bytes;
        a.nbottom = densities;
        a.line = coded ? bytes : NULL;
    }
    memcpy(a.job, kept_job, MSG_JOB);
    store_put_rows(s, &a);
}

static void
put_pieces(struct store *s, bool coded, uint32_t densities)
{
    keep_units(s);
    for (int i = 0; i < PIECES; i++)
        put_piece(s, i, coded, densities);
}

static int
note_stored(void *arg, const struct saved_job *s, struct rad_error *err)
{
    uint32_t *stored = arg;

    (void)err;
    ck_assert_uint_eq(s->nunits, 2);
    for (uint32_t i = 0; i < 2; i++)
        stored[i] = s->units[i].stored;
    return 0;
}

/* What is spoilt: a byte in each row, at a row's column, of floats, of RGBE,
 * and of the lines that are kept behind that. */
static const struct {
    bool coded;
    uint32_t densities;
    long at;
    int unit; /* whose rows are none then; 2: both's, -1: nobody's */
} spoilt[] = {
    { false, 1, 0, 0 },
    { false, 1, W * 12 + 1, 0 },
    { false, 1, 2 * W * 12 + 2, 0 },
    { false, 1, 3 * W * 12 + 3, 1 },
    { false, 1, 5 * W * 12 + 5, 1 },
    { true, 1, 0, 0 },
    { true, 1, W * 4 + 1, 0 },
    { true, 1, 3 * W * 4 - 1, 0 },
    { true, 1, 3 * W * 4, 1 },
    { true, 1, 6 * W * 4 - 1, 1 },
    { true, 1, H *W * 4 + 2 * W * 12 - 1, -1 }, /* no line is there */
    { true, 1, H *W * 4 + 2 * W * 12, 0 },
    { true, 1, H *W * 4 + 6 * W * 12 - 1, 1 },
    { true, 1, -1, -1 },
    { true, 0, H *W * 4 + 2 * W * 12, 0 }, /* -ps 1 has none */
    { true, 0, 0, 0 },
    { true, 0, -1, -1 },
    /* nothing was kept of the base line above */
    { false, 0, 3 * W * 12 + 3, 2 },
    { false, 0, 0, 0 },
};

/* Also in lives to come. */
START_TEST(rows_that_a_disk_has_spoilt_are_none)
{
    bool coded = spoilt[_i].coded;
    int unit = spoilt[_i].unit;
    uint32_t stored[2];
    struct heard h;
    uint64_t epoch;
    char path[200];
    uv_loop_t loop;
    struct store *s;
    FILE *f;

    open_kept(&loop, &s, &h);
    ck_assert_int_eq(store_recover(s, 1, &epoch, note_stored, stored, NULL), 0);
    open_job_as(s, coded ? MSG_JOB_CODED : 0);
    put_pieces(s, coded, spoilt[_i].densities);
    close_kept(&loop, s);
    ck_assert_int_eq(h.rows, 3);
    if (spoilt[_i].at >= 0) {
        snprintf(path, sizeof path, "%s/jobs/%s/0.rows", dir,
                 "09080700000000000000000000000000");
        f = fopen(path, "r+");
        ck_assert_ptr_nonnull(f);
        ck_assert_int_eq(fseek(f, spoilt[_i].at, SEEK_SET), 0);
        ck_assert_int_eq(fputc(0x55, f), 0x55);
        ck_assert_int_eq(fclose(f), 0);
    }
    for (int life = 0; life < 2; life++) {
        open_kept(&loop, &s, &h);
        ck_assert_int_eq(store_recover(s, 1, &epoch, note_stored, stored, NULL),
                         0);
        close_kept(&loop, s);
        ck_assert_uint_eq(stored[0], unit == 0 || unit == 2 ? 0 : 3);
        ck_assert_uint_eq(stored[1], unit == 1 || unit == 2 ? 0 : 3);
    }
}
END_TEST

/* On a full disk the rows of a job that is cancelled are removed before that is
 * noted; a coordinator that is killed then renders them again. */
START_TEST(rows_that_were_given_up_are_no_damage)
{
    struct rad_error err = { 0 };
    uint32_t stored[2];
    struct heard h;
    uint64_t epoch;
    char command[200];
    uv_loop_t loop;
    struct store *s;

    open_kept(&loop, &s, &h);
    ck_assert_int_eq(store_recover(s, 1, &epoch, note_stored, stored, NULL), 0);
    open_job(s);
    put_pieces(s, false, 1);
    close_kept(&loop, s);
    snprintf(command, sizeof command,
             "cd %s/" KEPT_DIR " && mv 0.rows over && : >over", dir);
    ck_assert_int_eq(system(command), 0);
    for (int life = 0; life < 2; life++) {
        open_kept(&loop, &s, &h);
        ck_assert_msg(store_recover(s, 1, &epoch, note_stored, stored, &err) ==
                          0,
                      "%s: %s", err.where, err.what);
        ck_assert_uint_eq(stored[0], life == 0 ? 0 : 3);
        ck_assert_uint_eq(stored[1], life == 0 ? 0 : 3);
        ck_assert(!is_there(KEPT_DIR "/over"));
        put_pieces(s, false, 1);
        close_kept(&loop, s);
    }
}
END_TEST

static void
most_pages(struct store *s, int n)
{
    char text[50];

    snprintf(text, sizeof text, "PRAGMA max_page_count = %d", n);
    ck_assert_int_eq(sqlite3_exec(s->journal->db, text, NULL, NULL, NULL), 0);
}

static struct store *full_store;

/* The disk gets room again as soon as a job waits for it. */
static void
end_fullness(void *arg, const uint8_t job[MSG_JOB], uint64_t sequence,
             const char *text)
{
    count_waits(arg, job, sequence, text);
    most_pages(full_store, 100000);
}

static void
end_all_fullness(void *arg, bool full, const char *text)
{
    (void)arg;
    (void)text;
    if (full)
        most_pages(full_store, 100000);
}

/* A job whose note is what finds no room; SQLite undoes all that was noted and
 * not committed. */
START_TEST(rows_that_come_when_the_database_is_full_are_noted_once)
{
    static const uint8_t second[MSG_JOB] = { 1 };
    struct msg_frame frames[500];
    struct saved_job job = { .spec = { .manifest = kept_manifest,
                                       .params = "-ab 0",
                                       .frames = frames,
                                       .nframes = N_ELEM(frames) } };
    struct store_handler ends = handler;
    uint32_t stored[2];
    struct heard h;
    uint64_t epoch;
    uv_loop_t loop;
    struct store *s;

    for (int i = 0; i < N_ELEM(frames); i++)
        frames[i] = kept_frame;
    ends.waits = end_fullness;
    ends.fullness = end_all_fullness;
    open_for(&loop, &s, &ends, &h);
    full_store = s;
    ck_assert_int_eq(store_recover(s, 1, &epoch, note_stored, stored, NULL), 0);
    open_job(s);
    run(&loop, s);
    keep_units(s);
    put_piece(s, 0, false, 1);
    run(&loop, s);
    most_pages(s, 1);
    store_open_job(s, second, &job);
    put_piece(s, 1, false, 1);
    put_piece(s, 2, false, 1);
    run(&loop, s);
    ck_assert_int_eq(h.jobs, 2);
    ck_assert_int_eq(h.rows, 3);
    forget(s, second);
    close_kept(&loop, s);
    open_kept(&loop, &s, &h);
    ck_assert_int_eq(store_recover(s, 1, &epoch, note_stored, stored, NULL), 0);
    close_kept(&loop, s);
    ck_assert_uint_eq(stored[0], 3);
    ck_assert_uint_eq(stored[1], 3);
}
END_TEST

/* Its floats, of rows that are RGBE. */
START_TEST(a_units_base_line_outlives_the_store)
{
    uint8_t line[W * 12];
    uint32_t stored[2];
    struct heard h;
    uint64_t epoch;
    uv_loop_t loop;
    struct store *s;

    open_kept(&loop, &s, &h);
    ck_assert_int_eq(store_recover(s, 1, &epoch, note_stored, stored, NULL), 0);
    open_job_as(s, MSG_JOB_CODED);
    put_pieces(s, true, 1);
    close_kept(&loop, s);
    open_kept(&loop, &s, &h);
    ck_assert_int_eq(store_recover(s, 1, &epoch, note_stored, stored, NULL), 0);
    for (uint32_t y = 2; y < H; y += 3) {
        ck_assert(store_read_row(s, kept_job, 0, y, line));
        for (int i = 0; i < N_ELEM(line); i++)
            ck_assert_uint_eq(line[i], line_byte(i));
    }
    ck_assert(store_read_row(s, kept_job, 0, 1, line));
    ck_assert_uint_eq(line[1], 0); /* in the middle of a unit */
    close_kept(&loop, s);
}
END_TEST

/* What a loss of power leaves of one that was being made is in nobody's way,
 * and one that has its name is whole, whatever becomes of its log. */
START_TEST(a_database_gets_its_name_when_it_is_whole)
{
    char path[160], made[170], log[170];
    struct journal *j;
    FILE *f;

    snprintf(path, sizeof path, "%s/radcoord.db", dir);
    snprintf(made, sizeof made, "%s.new", path);
    snprintf(log, sizeof log, "%s-wal", path);
    f = fopen(made, "w");
    ck_assert_ptr_nonnull(f);
    fputs("half a database", f);
    fclose(f);
    ck_assert_int_eq(journal_open(&j, path, JOURNAL_MAKE, NULL), 0);
    journal_close(j);
    ck_assert_int_ne(access(made, F_OK), 0);
    f = fopen(log, "w");
    ck_assert_ptr_nonnull(f);
    fputs("half a log", f);
    fclose(f);
    ck_assert_int_eq(journal_open(&j, path, JOURNAL_OPEN, NULL), 0);
    journal_close(j);
}
END_TEST

static const struct {
    int write, sync, code;
} faults[] = {
    { ENOSPC, 0, RAD_EFULL }, { EDQUOT, 0, RAD_EFULL }, { EIO, 0, RAD_EIO },
    { 0, ENOSPC, RAD_EIO }, /* the next sync would prove nothing */
    { 0, EIO, RAD_EIO },
};

START_TEST(a_commit_that_fails_tells_a_full_disk_from_another_fault)
{
    struct saved_job job = { .spec = { .job = kept_job,
                                       .manifest = kept_manifest,
                                       .params = "-ab 0",
                                       .frames = &kept_frame,
                                       .nframes = 1 },
                             .owner = "ana" };
    struct rad_error err = { 0 };
    char path[160];
    struct journal *j;
    bool has;

    snprintf(path, sizeof path, "%s/radcoord.db", dir);
    ck_assert_int_eq(journal_open(&j, path, JOURNAL_MAKE, NULL), 0);
    ck_assert_int_eq(journal_put_job(j, &job, NULL), 0);
    write_fault = faults[_i].write;
    sync_fault = faults[_i].sync;
    ck_assert_int_eq(journal_commit(j, &err), faults[_i].code);
    write_fault = sync_fault = 0;
    ck_assert(faults[_i].write != EDQUOT || strstr(err.what, "quota"));
    journal_rollback(j);
    ck_assert_int_eq(journal_put_job(j, &job, NULL), 0);
    ck_assert_int_eq(journal_commit(j, NULL), 0);
    ck_assert_int_eq(journal_has(j, kept_job, &has, NULL), 0);
    ck_assert(has);
    journal_close(j);
}
END_TEST

/* The log is carried over into the database, for which there is no memory; what
 * is in the log lasts. */
START_TEST(a_commit_without_memory_for_more_is_one)
{
    static uint8_t bottom[60000];
    struct saved_job job = { .spec = { .job = kept_job,
                                       .manifest = kept_manifest,
                                       .params = "-ab 0",
                                       .frames = &kept_frame,
                                       .nframes = 1 },
                             .owner = "ana",
                             .text = "" };
    struct saved_unit u = { .worker = "ws1",
                            .bottom = bottom,
                            .nbottom = sizeof bottom };
    struct rad_error err = { 0 };
    char path[160];
    struct journal *j;

    snprintf(path, sizeof path, "%s/radcoord.db", dir);
    ck_assert_int_eq(journal_open(&j, path, JOURNAL_MAKE, NULL), 0);
    ck_assert_int_eq(journal_put_job(j, &job, &err), 0);
    ck_assert_int_eq(journal_commit(j, &err), 0);
    for (u.unit = 0; u.unit < 100; u.unit++) {
        ck_assert_int_eq(journal_put_unit(j, kept_job, &u, &err), 0);
        ck_assert_int_eq(journal_put_rows(j, kept_job, &u, &err), 0);
    }
    sqlite3_hard_heap_limit64(sqlite3_memory_used() + 4096);
    ck_assert_msg(journal_commit(j, &err) == 0, "%s", err.what);
    sqlite3_hard_heap_limit64(0);
    journal_close(j);
}
END_TEST

int
main(void)
{
    TCase *tc = tcase_create("store_lives");

    tcase_add_checked_fixture(tc, scratch_make, scratch_remove);
    tcase_add_test(tc, a_new_folder_lasts);
    tcase_add_test(tc, a_job_goes_on_in_another_life);
    tcase_add_test(tc, a_job_that_is_over_is_remembered_and_forgotten);
    tcase_add_loop_test(tc, a_job_that_was_being_forgotten_is_no_damage,
                        UNSETTLED_JOB, UNSETTLED_STRIKE + 1);
    tcase_add_test(tc,
                   an_id_that_is_forgotten_twice_is_recorded_as_it_was_last);
    tcase_add_test(
        tc, what_is_left_of_a_forgotten_job_does_no_harm_to_the_next_of_its_id);
    tcase_add_test(
        tc, a_job_that_is_said_to_be_deleted_is_gone_after_a_loss_of_power);
    tcase_add_loop_test(tc,
                        a_job_may_have_the_id_of_one_that_is_being_forgotten, 0,
                        N_ELEM(old_jobs));
    tcase_add_test(tc, a_job_may_have_the_id_of_one_that_was_never_opened);
    tcase_add_test(
        tc, a_job_that_is_cancelled_while_it_waits_for_room_does_not_come_back);
    tcase_add_loop_test(tc, a_damaged_folder_is_refused, 0, N_ELEM(damages));
    tcase_add_test(tc, a_folder_in_which_no_room_can_be_kept_is_refused);
    tcase_add_loop_test(tc, rows_that_a_disk_has_spoilt_are_none, 0,
                        N_ELEM(spoilt));
    tcase_add_test(tc, rows_that_were_given_up_are_no_damage);
    tcase_add_test(tc, rows_that_come_when_the_database_is_full_are_noted_once);
    tcase_add_test(tc, a_units_base_line_outlives_the_store);
    tcase_add_test(tc, a_database_gets_its_name_when_it_is_whole);
    tcase_add_loop_test(
        tc, a_commit_that_fails_tells_a_full_disk_from_another_fault, 0,
        N_ELEM(faults));
    tcase_add_test(tc, a_commit_without_memory_for_more_is_one);
    return unit_run_case(tc);
}
