/* check_store_lives.c - jobs that a store finds of the one before it; damage */
#include "config.h"

#include "lives_fixture.h"

#include "store/statecheck.h"
#include "jobs/job.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <sysexits.h>
#include <unistd.h>

FIXTURE(scratch_make, remove_kept)

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
recover(struct saved_job *job, struct rad_error *err)
{
    uint64_t date_ms = 1000, epoch;
    int rc = store_begin_life(store, &date_ms, &epoch, err);

    memset(job, 0, sizeof *job);
    return rc == 0 ? store_recover(store, date_ms, note_job, job, err) : rc;
}

/* Begin a life of the store. */
static void
live(struct saved_job *job)
{
    open_kept();
    ck_assert_int_eq(recover(job, NULL), 0);
}

static void
make_kept(void)
{
    struct saved_job none;

    live(&none);
    open_job();
    put_unit(kept_job, 0, 3, 3);
    run();
    ck_assert_int_eq(heard.jobs, 1);
    ck_assert_int_eq(heard.rows, 1);
    ck_assert_int_eq(heard.status, 0);
}

TEST(a_job_goes_on_in_another_life)
{
    struct saved_job job;
    uint8_t row[W * 3 * 4];
    float px[3];

    make_kept();
    close_kept();
    live(&job);
    ck_assert_uint_eq(job.nunits, 1);
    ck_assert_uint_eq(job.lives, 1);
    ck_assert(store_read_row(store, kept_job, 0, 2, row));
    wire_floats_get(px, row, 3);
    ck_assert_float_eq(px[0], 2);
    put_unit(kept_job, 1, 3, 3);
    store_write_picture(store, kept_job, 5, 0);
    store_settle(store, 5, 44);
    close_kept();
    ck_assert_int_eq(heard.pictures, 1);
    ck_assert_uint_eq(heard.settled, 44);
    ck_assert(is_there("jobs/09080700000000000000000000000000/0.hdr"));
    ck_assert(!is_there("jobs/09080700000000000000000000000000/0.rows"));
}

TEST(a_picture_that_is_damaged_is_not_given_out)
{
    struct store_source from = { .what = MSG_WHAT_PICTURE };
    char buf[2000], path[200];
    FILE *f;
    int c;

    memcpy(from.job, kept_job, MSG_JOB);
    make_kept();
    put_unit(kept_job, 1, 3, 3);
    store_write_picture(store, kept_job, 5, 0);
    read_all(&from, buf, sizeof buf);
    run();
    ck_assert_int_eq(heard.read_status, 0);
    ck_assert_int_eq(heard.n, (ssize_t)heard.size);
    snprintf(path, sizeof path, "%s/" KEPT_DIR "/0.hdr", dir);
    f = fopen(path, "r+");
    ck_assert_ptr_nonnull(f);
    fseek(f, -1, SEEK_END);
    c = fgetc(f);
    fseek(f, -1, SEEK_END);
    fputc(c ^ 1, f);
    fclose(f);
    read_all(&from, buf, sizeof buf);
    run();
    ck_assert_int_eq(heard.read_status, EX_IOERR);
}

/* Its pictures may be all that is left of another state folder. */
TEST(a_job_that_the_database_does_not_know_is_not_removed)
{
    struct rad_error err = { 0 };
    struct saved_job none;
    char command[300];

    open_kept();
    snprintf(command, sizeof command,
             "mkdir %s/" KEPT_DIR " && touch %s/" KEPT_DIR "/0.hdr", dir, dir);
    ck_assert_int_eq(system(command), 0);
    ck_assert_int_eq(recover(&none, &err), RAD_EDATA);
    ck_assert(is_there(KEPT_DIR "/0.hdr"));
}

/* Nobody could fetch a picture of them. */
TEST(of_sensor_points_the_values_alone_are_kept)
{
    struct saved_job job;

    live(&job);
    open_job_as(MSG_JOB_DEPTH | MSG_JOB_POINTS);
    put_unit(kept_job, 0, 3, 4);
    put_unit(kept_job, 1, 3, 4);
    store_write_picture(store, kept_job, 5, 0);
    run();
    ck_assert_int_eq(heard.pictures, 1);
    ck_assert(is_there(KEPT_DIR "/0.z"));
    ck_assert(!is_there(KEPT_DIR "/0.hdr"));
    for (int life = 0; life < 2; life++) {
        if (life == 1)
            end_job();
        close_kept();
        live(&job);
        ck_assert_int_eq(job.state == JOB_CANCELLED, life);
    }
}

TEST(a_job_that_is_over_is_remembered_and_forgotten)
{
    struct store_source from = { .what = MSG_WHAT_STATS };
    struct saved_job job, end = { .spec = kept_spec,
                                  .sequence = 6,
                                  .state = 4,
                                  .status = 70,
                                  .text = "it was too late",
                                  .last = { .state = 4, .rays = 17 } };
    char buf[100];

    memcpy(from.job, kept_job, MSG_JOB);
    make_kept();
    store_end_job(store, &end, strdup("{ }"), 3);
    close_kept();
    ck_assert_int_eq(heard.filed, 1);
    ck_assert_uint_eq(heard.sequence, 6);
    live(&job);
    ck_assert_uint_eq(job.state, 4);
    ck_assert_int_eq(job.status, 70);
    ck_assert_uint_eq(job.last.rays, 17);
    read_all(&from, buf, sizeof buf);
    run();
    ck_assert_int_eq(heard.n, 3);
    store_forget_job(store, &(struct saved_gone){ .job = { 9, 8, 7 } });
    close_kept();
    live(&job);
    ck_assert_ptr_null(job.spec.job);
}

/* Without its rows and their room, which are removed when the end is noted. */
TEST(what_a_job_that_is_over_takes_is_known_in_another_life)
{
    struct saved_job job;
    uint64_t bytes;

    make_kept();
    end_job();
    run();
    bytes = heard.size;
    close_kept();
    live(&job);
    ck_assert_uint_eq(job.kept_bytes, bytes);
}

/* How far the database was with a job whose folder was being removed when the
 * coordinator was killed. */
enum unsettled {
    UNSETTLED_JOB, /* the disk was full, so it was not noted */
    UNSETTLED_END,
    UNSETTLED_STRIKE,
    UNSETTLED_NEW /* not forgotten: it had its folder, and nothing in it */
};

/* In a process of its own: forget a job, and be killed when the folder has its
 * other name, before the tasks that write the database are committed. */
static void
die_forgetting(enum unsettled how)
{
    struct saved_job none;
    char path[200];

    if (how == UNSETTLED_JOB || how == UNSETTLED_NEW) {
        open_kept();
        recover(&none, NULL);
        snprintf(path, sizeof path, "%s/" KEPT_DIR "%s", dir,
                 how == UNSETTLED_NEW ? "" : ".gone");
        ck_assert_int_eq(mkdir(path, 0700), 0);
        kill(getpid(), SIGKILL);
    }
    make_kept();
    end_job();
    if (how == UNSETTLED_STRIKE)
        run();
    forget_job();
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

RANGE_TEST(a_job_that_was_being_forgotten_is_no_damage, UNSETTLED_JOB,
           UNSETTLED_NEW + 1)
{
    struct rad_error err = { 0 };
    struct statecheck found;
    struct saved_job job;
    pid_t pid = fork();
    int status;

    if (pid == 0)
        die_forgetting((enum unsettled)_i);
    ck_assert_int_eq(waitpid(pid, &status, 0), pid);
    ck_assert(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
    ck_assert_int_eq(statecheck_run(dir, &found, tell_problem, NULL, &err), 0);
    ck_assert_uint_eq(found.jobs, 0);
    open_kept();
    ck_assert_msg(recover(&job, &err) == 0, "%s: %s", err.where, err.what);
    ck_assert_ptr_null(job.spec.job);
    ck_assert(!is_there(KEPT_DIR));
    ck_assert(!is_there(KEPT_DIR ".gone"));
}

/* The job takes rows, and has them in another life. */
static void
keeps_a_unit(struct saved_job *job)
{
    put_unit(kept_job, 0, 3, 3);
    run();
    ck_assert_int_eq(heard.status, 0);
    close_kept();
    live(job);
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
TEST(an_id_that_is_forgotten_twice_is_recorded_as_it_was_last)
{
    struct store_handler hears = handler;
    struct saved_job job;

    hears.gone = note_gone;
    live(&job);
    for (enum gone_why why = GONE_MANY; why <= GONE_OLD; why++) {
        open_job();
        run();
        end_job();
        store_forget_job(store,
                         &(struct saved_gone){ { 9, 8, 7 }, .why = why });
    }
    close_kept();
    open_for(&hears);
    ck_assert_int_eq(recover(&job, NULL), 0);
    ck_assert_int_eq(heard.files, 1);
    ck_assert_int_eq(heard.status, GONE_OLD);
}

/* Of an earlier job of the same id, which is long forgotten, a file could not
 * be removed. */
TEST(what_is_left_of_a_forgotten_job_does_no_harm_to_the_next_of_its_id)
{
    struct rad_error err = { 0 };
    struct statecheck found;
    struct saved_job job;
    char command[200];

    live(&job);
    open_job();
    close_kept();
    snprintf(command, sizeof command,
             "cd %s && mkdir " KEPT_DIR ".gone && touch " KEPT_DIR
             ".gone/0.hdr",
             dir);
    ck_assert_int_eq(system(command), 0);
    ck_assert_int_eq(statecheck_run(dir, &found, tell_problem, NULL, &err), 0);
    ck_assert_uint_eq(found.jobs, 1);
    live(&job);
    ck_assert_ptr_nonnull(job.spec.job);
    ck_assert(!is_there(KEPT_DIR ".gone"));
    ck_assert(is_there(KEPT_DIR "/room"));
}

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

LOOP_TEST(a_job_may_have_the_id_of_one_that_is_being_forgotten,
          N_ELEM(old_jobs))
{
    struct saved_job job;
    char name[100];

    make_kept();
    end_job();
    run();
    for (int i = 0; i < old_jobs[_i].files; i++) {
        snprintf(name, sizeof name, KEPT_DIR "/%d.hdr", i + 1);
        scratch_file(name, "");
    }
    heard.jobs = 0;
    forget_job();
    store_settle(store, 5, 44);
    while (old_jobs[_i].answered && heard.settled != 44)
        uv_run(&loop, UV_RUN_ONCE);
    open_job();
    store_put_state(store, kept_job, 2, 7);
    run();
    ck_assert_int_eq(heard.jobs, 1);
    ck_assert(!is_there(KEPT_DIR ".gone"));
    keeps_a_unit(&job);
    ck_assert_int_eq(job.state, 2);
    ck_assert_int_eq(job.spec.priority, 7);
}

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

/* Open a store and a job in it; openings are counted from the first one on. */
static void
open_counted(struct store_handler *counts)
{
    struct saved_job job;

    *counts = handler;
    counts->job = count_jobs;
    open_for(counts);
    ck_assert_int_eq(recover(&job, NULL), 0);
    open_job();
    run();
}

/* The second of three jobs that have one id is over, and forgotten, while its
 * opening waits for the first job to be forgotten. */
TEST(a_job_may_have_the_id_of_one_that_was_never_opened)
{
    struct store_handler counts;
    struct saved_job job;

    open_counted(&counts);
    for (int i = 0; i < 2; i++) {
        end_job();
        forget_job();
        open_job();
    }
    run();
    ck_assert_int_eq(heard.jobs, 2);
    keeps_a_unit(&job);
}

/* Else the folder of the new job would stay, too, when that is forgotten. */
TEST(while_files_of_a_forgotten_job_are_left_its_id_is_not_taken_again)
{
    struct store_handler counts;
    struct saved_job job;
    char folder[200];

    open_counted(&counts);
    snprintf(folder, sizeof folder, "%s/" KEPT_DIR "/folder", dir);
    ck_assert_int_eq(mkdir(folder, 0700), 0); /* not removed with the files */
    end_job();
    forget_job();
    open_job();
    run();
    ck_assert_int_eq(heard.jobs, 1);
    ck_assert(!is_there(KEPT_DIR));
    snprintf(folder, sizeof folder, "%s/" KEPT_DIR ".gone/folder", dir);
    ck_assert_int_eq(rmdir(folder), 0);
    open_job();
    run();
    ck_assert_int_eq(heard.jobs, 2);
    keeps_a_unit(&job);
}

static int
count_open(void *arg, const struct saved_job *s, struct rad_error *err)
{
    int *n = arg;

    (void)err;
    *n += s->state < 3;
    return 0;
}

static bool cache_synced, names_synced, jobs_synced, file_synced, files_synced;
static char one_file[80]; /* its name, below the state folder */
static bool file_fails;   /* it cannot be synced */

static bool
is_open_as(int fd, const char *name)
{
    char path[300];
    struct stat st, there;

    snprintf(path, sizeof path, "%s/%s", dir, name);
    return fstat(fd, &st) == 0 && stat(path, &there) == 0 &&
           st.st_ino == there.st_ino;
}

/* In place of the C library's: notes whether the state folder was synced when
 * it had its folders, and these, and a file of a scene. */
int
fsync(int fd)
{
    jobs_synced |= is_open_as(fd, "jobs");
    files_synced |= is_open_as(fd, "files");
    if (one_file[0] && is_open_as(fd, one_file)) {
        file_synced = !file_fails;
        errno = EIO;
        if (file_fails)
            return -1;
    }
    names_synced |=
        is_open_as(fd, ".") && is_there("jobs") && is_there("files");
    return (int)syscall(SYS_fsync, fd);
}

/* In place of the C library's: notes whether a job's cache was synced, before
 * it was given the name under which it is kept. */
int
fdatasync(int fd)
{
    cache_synced |= is_open_as(fd, KEPT_DIR "/cache");
    return fsync(fd);
}

TEST(a_new_folder_lasts)
{
    open_kept();
    ck_assert(names_synced);
}

/* It was killed after it had named a file, and before the file was synced.  A
 * job may be accepted for which nobody sends that file again. */
TEST(a_file_that_a_killed_store_left_lasts_before_it_counts)
{
    static const char zeros[5];
    uint8_t digest[MSG_HASH];
    struct action_look look = { .request = 7,
                                .nlook = 1,
                                .files = { 1, digest } };
    char hex[RAD_SHA_HEX + 1], path[200];
    FILE *f;

    hash_of(zeros, sizeof zeros, hex);
    rad_sha_from_hex(hex, digest);
    snprintf(one_file, sizeof one_file, "files/%s", hex);
    open_kept();
    close_kept();
    snprintf(path, sizeof path, "%s/%s", dir, one_file);
    f = fopen(path, "w");
    ck_assert_ptr_nonnull(f);
    fwrite(zeros, 1, sizeof zeros, f);
    fclose(f);
    files_synced = file_synced = false;
    open_kept();
    ck_assert(files_synced);
    for (int i = 2; i-- > 0;) {
        file_fails = i;
        ck_assert(!store_look(store, &look));
        run();
    }
    ck_assert(store_look(store, &look)); /* from now on it is known */
    ck_assert(file_synced);
}

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

TEST(a_job_that_is_said_to_be_deleted_is_gone_after_a_loss_of_power)
{
    make_kept();
    end_job();
    run();
    jobs_synced = false;
    forget_job();
    store_settle(store, 5, 44);
    while (heard.settled != 44)
        uv_run(&loop, UV_RUN_ONCE);
    ck_assert(jobs_synced);
}

/* Leave a job that is done, with a cache of so many bytes. */
static void
make_cache(size_t bytes)
{
    uint8_t *records = calloc(1, bytes);
    struct saved_job done = { .spec = kept_spec,
                              .state = 3,
                              .last = { .state = 3 },
                              .cache_bytes = bytes,
                              .keep = { 0, 1, 1 } };

    open_job();
    run();
    store_put_pass(store, kept_job, 0,
                   &(struct saved_pass){ .bytes = records, .len = bytes });
    store_end_job(store, &done, strdup("{ }"), 3);
    run();
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
TEST(a_job_that_is_cancelled_while_it_waits_for_room_does_not_come_back)
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
    int nopen = 0;

    signal(SIGXFSZ, SIG_IGN);
    counts.job = count_jobs;
    counts.waits = count_waits;
    open_for(&counts);
    ck_assert_int_eq(store_recover(store, 1, count_open, &nopen, NULL), 0);
    make_cache(2 << 20);
    heard.jobs = 0;
    limit_files(1 << 20);
    store_open_job(store, second, &job);
    while (heard.waits == 0)
        uv_run(&loop, UV_RUN_ONCE);
    job.state = job.last.state = 5;
    store_end_job(store, &job, strdup("{ }"), 3);
    limit_files(RLIM_INFINITY);
    close_kept();
    ck_assert_int_eq(heard.jobs, 0);
    open_kept();
    ck_assert_int_eq(store_recover(store, 1, count_open, &nopen, NULL), 0);
    ck_assert_int_eq(nopen, 0);
}

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

LOOP_TEST(a_damaged_folder_is_refused, N_ELEM(damages))
{
    struct rad_error err = { 0 };
    struct saved_job job;
    char command[200];

    make_kept();
    close_kept();
    snprintf(command, sizeof command, "cd %s && %s", dir, damages[_i].command);
    ck_assert_int_eq(system(command), 0);
    uv_loop_init(&loop);
    store = store_open(&loop, dir, true, &handler, &heard, &err);
    if (store) {
        ck_assert_int_lt(recover(&job, &err), 0);
        store_close(store);
        store = NULL;
    }
    uv_loop_close(&loop);
    ck_assert_int_eq(err.code, RAD_EDATA);
    ck_assert_ptr_nonnull(strstr(err.where, "is damaged"));
    ck_assert_msg(strstr(err.what, damages[_i].what) != NULL, "%s", err.what);
    ck_assert_ptr_nonnull(strstr(err.what, "radctl check"));
}

static bool no_descriptor;

/* In place of the C library's: there may be no descriptor for a cache. */
int
open(const char *path, int flags, ...)
{
    size_t n = strlen(path);
    va_list ap;
    mode_t mode = 0;

    if (no_descriptor && n > 6 && strcmp(path + n - 6, "/cache") == 0) {
        errno = EMFILE;
        return -1;
    }
    va_start(ap, flags);
    if (flags & O_CREAT)
        mode = va_arg(ap, mode_t);
    va_end(ap);
    return (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode);
}

/* Their records could be made again, but not what a check pass decided; so the
 * next start tries once more. */
TEST(passes_that_cannot_be_read_for_a_shortage_are_not_lost)
{
    struct rad_error err = { 0 };
    struct saved_job job;

    make_kept();
    store_put_pass(store, kept_job, 0,
                   &(struct saved_pass){ .bytes = kept_job, .len = 3 });
    close_kept();
    no_descriptor = true;
    open_kept();
    ck_assert_int_eq(recover(&job, &err), RAD_ESHORT);
    close_kept();
    no_descriptor = false;
    live(&job);
    ck_assert_uint_eq(job.npasses, 1);
}

/* No damage, but no job may be left out without a word. */
TEST(a_folder_in_which_no_room_can_be_kept_is_refused)
{
    struct rad_error err = { 0 };
    struct saved_job job;
    char path[200];

    make_kept();
    close_kept();
    snprintf(path, sizeof path, "%s/" KEPT_DIR "/room", dir);
    ck_assert_int_eq(unlink(path), 0);
    ck_assert_int_eq(mkdir(path, 0700), 0);
    open_kept();
    ck_assert_int_eq(recover(&job, &err), RAD_EIO);
    ck_assert_ptr_nonnull(strstr(err.what, "/room"));
}
