/* check_bygone.c - jobs that are over, and how long they are kept */
#include "config.h"

#include "coord_fixture.h"

#include "registry/bygone.h"
#include "registry/recover.h"

FIXTURE(set_up, tear_down)

static void
whole_job(const uint8_t *job)
{
    submit(ANA, job, 0);
    ready(WORKER, job);
    for (uint32_t u = 0; u < 4; u++)
        result(WORKER, job, u, 1);
}

/* By number, by age, and by size, but not before its user can have it. */
LOOP_TEST(jobs_that_are_over_are_kept_for_a_while, 3)
{
    static const struct coord_keep keeps[] = { { 1, 0, 0, 0, 0 },
                                               { 9, 90000, 0, 0, 0 },
                                               { 9, 0, 1000, 0, 0 } };
    static const unsigned until_s[] = { 0, 90, 60 };

    coord_set_keep(f.c, &keeps[_i]);
    whole_job(job_a);
    coord_job_filed(f.c, f.now_ms, job_a, job_number(job_a), 900, 0);
    whole_job(job_b);
    coord_job_filed(f.c, f.now_ms, job_b, job_number(job_b), 900, 0);
    carry_out();
    if (until_s[_i] > 0) {
        wait_s(until_s[_i] / 2);
        ck_assert_ptr_nonnull(desk_find_job(f.c, job_a));
        wait_s(until_s[_i]);
        coord_job_filed(f.c, f.now_ms, job_b, job_number(job_b), 900, 0);
    }
    wait_s(1);
    ck_assert_ptr_null(desk_find_job(f.c, job_a));
    ck_assert((desk_find_job(f.c, job_b) == NULL) == (_i == 1));
}

static bool
is_recalled(const uint8_t *job)
{
    char hex[MSG_JOB_HEX];

    msg_job_format(job, hex);
    return bygone_find(f.c, hex);
}

TEST(a_forgotten_job_that_is_submitted_again_is_not_forgotten)
{
    coord_set_keep(f.c, &(struct coord_keep){ .jobs = 1 });
    whole_job(job_a);
    whole_job(job_b);
    wait_s(1);
    ck_assert(!desk_find_job(f.c, job_a) && is_recalled(job_a));
    submit(ANA, job_a, 0);
    ck_assert(!is_recalled(job_a));
    about(ANA, MSG_CANCEL, job_a);
    about(ANA, MSG_DELETE, job_a); /* which its user knows */
    ck_assert(!is_recalled(job_a));
}

/* Searches for work look at the others alone. */
TEST(jobs_that_are_over_stand_behind_the_others)
{
    uint8_t id[MSG_JOB] = { 0 };

    for (id[0] = 1; id[0] <= 8; id[0]++) {
        submit(ANA, id, id[0] % 3);
        if (id[0] % 2 == 0)
            about(ANA, MSG_CANCEL, id);
    }
    ck_assert_uint_eq(f.c->njobs, 8);
    ck_assert_uint_eq(f.c->nopen, 4);
    for (size_t i = 0; i < 8; i++)
        ck_assert(job_over(f.c->jobs[i]) == (i >= 4));
    for (size_t i = 1; i < 4; i++) { /* the begun jobs, then those queued */
        const struct job *a = f.c->jobs[i - 1], *b = f.c->jobs[i];

        ck_assert(a->rank < b->rank ||
                  (a->rank == b->rank && a->spec.priority >= b->spec.priority));
    }
}

/* Recover a job that was over at so many ms. */
static void
recover_over(const char *owner, const uint8_t *id, uint64_t end_ms)
{
    static const struct saved_frame frames[9];
    struct msg m = usual_submit(id);
    struct saved_job s = { .spec = m.submit,
                           .owner = owner,
                           .state = JOB_CANCELLED,
                           .text = "",
                           .end_ms = end_ms,
                           .frames = frames };

    ck_assert_uint_le(s.spec.nframes, N_ELEM(frames));
    ck_assert_int_eq(recover_job(f.c, f.now_ms, &s, NULL, NULL, NULL), 0);
}

/* When fewer jobs are kept from now on, the oldest of each owner go, whatever
 * the order in which they came. */
TEST(a_lower_limit_leaves_the_youngest_jobs_of_each_owner)
{
    static const struct coord_keep many = { .jobs = 99 }, few = { .jobs = 10 };
    uint8_t id[2][MSG_JOB] = { { 1 }, { 2 } };

    wait_s(1);
    coord_set_keep(f.c, &many);
    for (uint8_t i = 0; i < 30; i++) {
        id[0][1] = id[1][1] = i;
        recover_over("ana", id[0], 1 + 7 * i % 30);
        recover_over("bob", id[1], 1 + i);
    }
    coord_set_keep(f.c, &few);
    for (uint8_t i = 0; i < 30; i++) {
        id[0][1] = id[1][1] = i;
        ck_assert(!desk_find_job(f.c, id[0]) == (7 * i % 30 < 20));
        ck_assert(!desk_find_job(f.c, id[1]) == (i < 20));
    }
}

/* A job that is over holds the memory of its windows: of many, few are kept. */
TEST(large_jobs_that_are_over_count_as_several)
{
    static const struct coord_keep keep = { .jobs = 9 };
    static const struct msg_frame picture = { 0, 200, 200, "" };

    coord_set_keep(f.c, &keep);
    for (int i = 0; i < 2; i++) {
        const uint8_t *job = i == 0 ? job_a : job_b;
        struct msg m = usual_submit(job);

        m.submit.frames = &picture;
        m.submit.partition = MSG_PART_WINDOW;
        m.submit.windows = 8000; /* as 2000 frames: six jobs */
        say(ANA, &m);
        ck_assert_int_eq(f.last[ANA].type, MSG_ACCEPT);
        about(ANA, MSG_CANCEL, job);
        wait_s(2);
        ck_assert_ptr_nonnull(desk_find_job(f.c, job));
    }
    ck_assert_ptr_null(desk_find_job(f.c, job_a));
}

/* What was fetched goes, after a while in which its user gets the rest of it;
 * what was not stays for longer. */
TEST(what_was_not_fetched_is_kept)
{
    static const struct coord_keep keep = { .unfetched_ms = 90000 };
    struct coord_conn *ana;
    enum msg_session was;
    char hex[MSG_JOB_HEX];

    coord_set_keep(f.c, &keep);
    whole_job(job_a);
    whole_job(job_b);
    carry_out();
    /* not the owner */
    bygone_fetched(f.c, f.now_ms, BOB, job_b, 0, MSG_WHAT_PICTURE);
    /* on the socket, whose user the owner is, but to look only */
    ana = desk_find_conn(f.c, ANA);
    was = ana->session;
    ana->session = MSG_AT_COORD_OBSERVER;
    bygone_fetched(f.c, f.now_ms, ANA, job_b, 0, MSG_WHAT_PICTURE);
    ana->session = was;
    bygone_fetched(f.c, f.now_ms, ANA, job_a, 0, MSG_WHAT_PICTURE);
    wait_s(30);
    ck_assert_ptr_nonnull(desk_find_job(f.c, job_a));
    wait_s(40);
    ck_assert_ptr_null(desk_find_job(f.c, job_a));
    ck_assert_ptr_nonnull(desk_find_job(f.c, job_b));
    msg_job_format(job_a, hex);
    ck_assert(bygone_find(f.c, hex)->fetched);
    wait_s(40);
    ck_assert_ptr_null(desk_find_job(f.c, job_b));
    about(ANA, MSG_CANCEL, job_b);
    ck_assert_int_eq(f.last[ANA].failed.status, EX_NOINPUT);
    ck_assert_ptr_nonnull(
        strstr(f.last[ANA].failed.text, "forgotten for keep_jobs on "));
    about(BOB, MSG_CANCEL, job_b);
    ck_assert_str_eq(f.last[BOB].failed.text, "no such job");
}

static const struct {
    uint32_t flags;
    enum msg_what beside, main;
} main_file[] = {
    { MSG_JOB_DEPTH, MSG_WHAT_DEPTH, MSG_WHAT_PICTURE },
    { MSG_JOB_DEPTH | MSG_JOB_POINTS, MSG_WHAT_PICTURE, MSG_WHAT_DEPTH },
};

static unsigned
fetched_actions(void)
{
    const struct action_list *l = coord_actions(f.c);
    unsigned n = 0;

    for (size_t i = 0; i < l->n; i++)
        n += l->v[i].type == ACT_JOB_FETCHED;
    return n;
}

/* Distances beside a picture leave it unfetched; of sensor points, of which no
 * picture is sent, they are all that there is. */
LOOP_TEST(the_file_that_its_owner_waits_for_is_fetched, N_ELEM(main_file))
{
    static const struct coord_keep keep = { .unfetched_ms = 90000 };
    static const uint8_t rows[4 * 4 * 16];
    struct msg m = { .type = MSG_RESULT,
                     .result = { .job = job_a,
                                 .attempt = 1,
                                 .rows = 4,
                                 .width = 4,
                                 .channels = 4,
                                 .last = 1,
                                 .pixels = rows } };
    const struct job *job;

    tear_down();
    set_up_coord(true);
    coord_set_keep(f.c, &keep);
    submit_with(ANA, job_a, 0, 4, main_file[_i].flags);
    ready(WORKER, job_a);
    for (; m.result.unit < 4; m.result.unit++)
        say(WORKER, &m);
    carry_out();
    job = desk_find_job(f.c, job_a);
    ck_assert(desk_unfetched(f.c, job));
    bygone_fetched(f.c, f.now_ms, ANA, job_a, 0, MSG_WHAT_STATS);
    bygone_fetched(f.c, f.now_ms, ANA, job_a, 0, main_file[_i].beside);
    ck_assert(desk_unfetched(f.c, job));
    ck_assert_uint_eq(fetched_actions(), 0);
    bygone_fetched(f.c, f.now_ms, ANA, job_a, 0, main_file[_i].main);
    ck_assert(!desk_unfetched(f.c, job));
    bygone_fetched(f.c, f.now_ms, ANA, job_a, 0, main_file[_i].main);
    ck_assert_uint_eq(fetched_actions(), 1);
    carry_out();
}

static bool sending; /* a file of job_a is on its way */

static void
sends_a(void *arg, coord_sent_fn *fn, void *with)
{
    (void)arg;
    if (sending)
        fn(with, job_a);
}

/* radsubmit -z writes a picture only with its distances, which may come slowly,
 * by a line that breaks. */
TEST(a_job_stays_while_its_files_are_sent)
{
    static const struct coord_keep keep = { .unfetched_ms = 90000 };

    f.c->env.each_sent = sends_a;
    coord_set_keep(f.c, &keep);
    whole_job(job_a);
    carry_out();
    bygone_fetched(f.c, f.now_ms, ANA, job_a, 0, MSG_WHAT_PICTURE);
    sending = true;
    wait_s(300);
    ck_assert_ptr_nonnull(desk_find_job(f.c, job_a));
    sending = false; /* the connection broke, and comes again */
    wait_s(50);
    ck_assert_ptr_nonnull(desk_find_job(f.c, job_a));
    wait_s(11);
    ck_assert_ptr_null(desk_find_job(f.c, job_a));
}

/* Each file that its owner asks for gives the time to ask for the next. */
TEST(each_file_that_is_fetched_keeps_its_job)
{
    static const struct coord_keep keep = { .unfetched_ms = 90000 };
    struct msg fetch = { .type = MSG_FETCH,
                         .request = 9,
                         .fetch = { job_a, 0, MSG_WHAT_PICTURE } };

    coord_set_keep(f.c, &keep);
    whole_job(job_a);
    carry_out();
    bygone_fetched(f.c, f.now_ms, ANA, job_a, 0, MSG_WHAT_PICTURE);
    wait_s(50);
    bygone_fetched(f.c, f.now_ms, ANA, job_a, 0, MSG_WHAT_STATS);
    wait_s(50);
    say(ANA, &fetch);
    wait_s(50);
    ck_assert_ptr_nonnull(desk_find_job(f.c, job_a));
    wait_s(11);
    ck_assert_ptr_null(desk_find_job(f.c, job_a));
}

/* Small jobs are fetched by the hundred in the minute that each has. */
TEST(few_of_those_just_fetched_are_kept)
{
    static const struct coord_keep keep = { .jobs = 10, .unfetched_ms = 90000 };
    uint8_t id[MSG_JOB] = { 0 };

    coord_set_keep(f.c, &keep);
    for (int i = 0; i < 90; i++) {
        id[0] = (uint8_t)i;
        whole_job(id);
        carry_out();
        bygone_fetched(f.c, f.now_ms, ANA, id, 0, MSG_WHAT_PICTURE);
    }
    wait_s(2);
    ck_assert_uint_eq(f.c->njobs, 64);
    id[0] = 0; /* the first was fetched first */
    ck_assert_ptr_null(desk_find_job(f.c, id));
    id[0] = 89;
    ck_assert_ptr_nonnull(desk_find_job(f.c, id));
    wait_s(61);
    ck_assert_uint_eq(f.c->njobs, 10);
}

/* Three weeks, during one of two jobs.  For workers no time passes meanwhile.
 */
TEST(sleep_of_the_machine_makes_no_job_older_that_ended_after_it)
{
    static const struct coord_keep keep = { .unfetched_ms = 90000 };
    const uint64_t weeks_ms = UINT64_C(21) * 24 * 3600 * 1000;
    struct saved_job saved;
    uint64_t end_ms;

    coord_set_keep(f.c, &keep);
    whole_job(job_a);
    ready(WORKER, job_a);
    submit(ANA, job_b, 0);
    ready(WORKER, job_b);
    wait_s(30);
    ck_assert_ptr_nonnull(desk_find_job(f.c, job_a));
    f.slept_ms = weeks_ms;
    wait_s(5);
    ck_assert_ptr_null(desk_find_job(f.c, job_a));
    ck_assert_uint_eq(desk_find_job(f.c, job_b)->late, 0);
    for (uint32_t u = 0; u < 4; u++)
        result(WORKER, job_b, u, 1);
    end_ms = f.now_ms;
    ck_assert(coord_saved(f.c, job_b, &saved)); /* for the next life */
    ck_assert_uint_eq(saved.end_ms, end_ms + weeks_ms);
    ck_assert_uint_eq(desk_find_job(f.c, job_b)->end_ms, end_ms);
    wait_s(85);
    ck_assert_ptr_nonnull(desk_find_job(f.c, job_b));
    wait_s(10);
    ck_assert_ptr_null(desk_find_job(f.c, job_b));
}

/* The next life tells for how long a job has been under way by what was saved
 * of the job, its units, and its end. */
TEST(sleep_before_a_job_is_in_all_dates_of_it_that_are_saved)
{
    struct saved_job saved;

    f.slept_ms = 1000 * 3600;
    submit(ANA, job_a, 0);
    ck_assert(coord_saved(f.c, job_a, &saved));
    ck_assert_uint_eq(saved.offer_ms, f.now_ms + f.slept_ms);
    ck_assert_uint_eq(saved.submit_ms, f.now_ms + f.slept_ms);
    ck_assert_uint_eq(saved.open_ms, f.now_ms + f.slept_ms);
    ready(WORKER, job_a);
    result(WORKER, job_a, 0, 1);
    ck_assert_uint_eq(f.rows.date_ms, f.now_ms + f.slept_ms);
}

/* Who asks hears the same of it as before. */
TEST(of_a_job_that_is_filed_its_end_is_kept)
{
    struct msg fetch = { .type = MSG_FETCH,
                         .request = 9,
                         .fetch = { job_a, 0, MSG_WHAT_STATS } };
    struct msg before = { .type = MSG_PROGRESS }, after = before;
    struct wire_out was, is;
    struct job *job;

    tear_down();
    set_up_coord(true);
    whole_job(job_a);
    ck_assert_uint_eq(f.ends, 1);
    job = desk_find_job(f.c, job_a);
    progress_tell(job, f.now_ms, &before.progress);
    coord_job_filed(f.c, f.now_ms, job_a, job_number(job_a), 900, 0);
    wait_s(1); /* a worker may tell something yet */
    ck_assert_ptr_nonnull(job->units);
    wait_s(2);
    ck_assert_int_eq(job->place, PLACE_FILED);
    ck_assert_ptr_null(job->units);
    ck_assert_ptr_null(job->partition);
    ck_assert_uint_eq(job->nparts, 0);
    progress_tell(job, f.now_ms, &after.progress);
    wire_out_init(&was, MSG_FRAME_MAX);
    wire_out_init(&is, MSG_FRAME_MAX);
    ck_assert_int_eq(msg_pack(&was, &before), 0);
    ck_assert_int_eq(msg_pack(&is, &after), 0);
    ck_assert_uint_eq(was.len, is.len);
    ck_assert_mem_eq(was.buf, is.buf, was.len);
    wire_out_release(&was);
    wire_out_release(&is);
    ck_assert_uint_eq(after.progress.units_total, 4);
    coord_message(f.c, f.now_ms, ANA, &fetch);
    ck_assert_int_eq(coord_actions(f.c)->v[0].type, ACT_SEND_PICTURE);
    ck_assert_int_eq(coord_actions(f.c)->v[0].what, MSG_WHAT_STATS);
    carry_out();
    ready(WORKER, job_a); /* it is told that the job is over */
    ck_assert_int_eq(f.last[WORKER].type, MSG_JOB_END);
    fetch.fetch.what = MSG_WHAT_PICTURE;
    coord_message(f.c, f.now_ms, ANA, &fetch);
    ck_assert_int_eq(coord_actions(f.c)->v[0].type, ACT_SEND_PICTURE);
    carry_out();
}

/* The connection has ended, or the job was deleted and another has its id. */
TEST(what_was_sent_of_no_picture_is_not_fetched)
{
    tear_down();
    set_up_coord(true);
    start_job();
    for (uint32_t u = 0; u < 4; u++) {
        bygone_fetched(f.c, f.now_ms, ANA, job_a, 0, MSG_WHAT_PICTURE);
        result(WORKER, job_a, u, 1);
    }
    bygone_fetched(f.c, f.now_ms, STRANGER, job_a, 0, MSG_WHAT_PICTURE);
    bygone_fetched(f.c, f.now_ms, ANA, job_b, 0, MSG_WHAT_PICTURE);
    bygone_fetched(f.c, f.now_ms, ANA, job_a, 1 << 30, MSG_WHAT_PICTURE);
    ck_assert_uint_eq(fetched_actions(), 0);
    ck_assert_uint_eq(desk_find_job(f.c, job_a)->unfetched, 1);
}
