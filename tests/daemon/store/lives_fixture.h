/* lives_fixture.h - a job in a store that another store finds afterwards
 *
 * All is static: each test program has its own. */
#ifndef RADD_TESTS_LIVES_FIXTURE_H
#define RADD_TESTS_LIVES_FIXTURE_H

#include "store_fixture.h"

#include "store/store_impl.h"

#define KEPT_DIR "jobs/09080700000000000000000000000000"

static const uint8_t kept_job[MSG_JOB] = { 9, 8, 7 };
static const uint8_t kept_manifest[MSG_HASH] = { 6, 5, 4 };
static const struct msg_frame kept_frame = { 0, W, H, "-vtv -vp 0 0 0" };
static const struct msg_spec kept_spec = { .job = kept_job,
                                           .manifest = kept_manifest,
                                           .params = "-ab 0",
                                           .frames = &kept_frame,
                                           .nframes = 1 };

static inline void
open_for(uv_loop_t *loop, struct store **s, const struct store_handler *to,
         struct heard *h)
{
    struct rad_error err = { 0 };

    memset(h, 0, sizeof *h);
    uv_loop_init(loop);
    *s = store_open(loop, dir, true, to, h, &err);
    ck_assert_msg(*s != NULL, "%s: %s", err.where, err.what);
}

static inline void
open_kept(uv_loop_t *loop, struct store **s, struct heard *h)
{
    open_for(loop, s, &handler, h);
}

static inline void
close_kept(uv_loop_t *loop, struct store *s)
{
    run(loop, s);
    store_close(s);
    ck_assert_int_eq(uv_loop_close(loop), 0);
}

static inline void
open_job_as(struct store *s, uint32_t flags)
{
    struct saved_job p = { .spec = kept_spec, .owner = "ana" };

    p.spec.flags = flags;
    store_open_job(s, kept_job, &p);
}

static inline void
open_job(struct store *s)
{
    open_job_as(s, 0);
}

/* End the job as cancelled. */
static inline void
end_job(struct store *s)
{
    struct saved_job end = {
        .spec = kept_spec, .sequence = 6, .state = 5, .last = { .state = 5 }
    };

    store_end_job(s, &end, strdup("{ }"), 3);
}

static inline void
forget(struct store *s, const uint8_t *job)
{
    struct saved_gone gone = { .why = GONE_DELETED };

    memcpy(gone.job, job, MSG_JOB);
    store_forget_job(s, &gone);
}

static inline void
forget_job(struct store *s)
{
    forget(s, kept_job);
}

static inline void
count_waits(void *arg, const uint8_t job[MSG_JOB], uint64_t sequence,
            const char *text)
{
    struct heard *h = arg;

    (void)job;
    (void)sequence;
    (void)text;
    h->waits++;
}

#endif
