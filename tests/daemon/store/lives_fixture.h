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
open_for(const struct store_handler *to)
{
    struct rad_error err = { 0 };

    memset(&heard, 0, sizeof heard);
    uv_loop_init(&loop);
    store = store_open(&loop, dir, true, to, &heard, &err);
    ck_assert_msg(store != NULL, "%s: %s", err.where, err.what);
}

static inline void
open_kept(void)
{
    open_for(&handler);
}

static inline void
close_kept(void)
{
    run();
    store_close(store);
    store = NULL;
    ck_assert_int_eq(uv_loop_close(&loop), 0);
}

/* For FIXTURE(): also closes a store that is open. */
static inline void
remove_kept(void)
{
    if (store)
        close_kept();
    scratch_remove();
}

static inline void
open_job_as(uint32_t flags)
{
    struct saved_job p = { .spec = kept_spec, .owner = "ana" };

    p.spec.flags = flags;
    store_open_job(store, kept_job, &p);
}

static inline void
open_job(void)
{
    open_job_as(0);
}

/* End the job as cancelled. */
static inline void
end_job(void)
{
    struct saved_job end = {
        .spec = kept_spec, .sequence = 6, .state = 5, .last = { .state = 5 }
    };

    store_end_job(store, &end, strdup("{ }"), 3);
}

static inline void
forget(const uint8_t *job)
{
    struct saved_gone gone = { .why = GONE_DELETED };

    memcpy(gone.job, job, MSG_JOB);
    store_forget_job(store, &gone);
}

static inline void
forget_job(void)
{
    forget(kept_job);
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
