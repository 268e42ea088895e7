/* foresee.c - see foresee.h */
#include "config.h"

#include "trial/foresee.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>

/* A tenth of the effort of --dry-run. */
static const struct trial_effort SMALL_EFFORT = {
    .seconds = .3, .pixels = 128, .windows = 4, .side = 32
};

struct foresee {
    struct dryrun_job job; /* [fixed] */
    pthread_t thread;      /* [fixed] */
    double rays;           /* written by the thread until `done` */
    _Atomic bool done;     /* release; pairs with the acquire in
                            * foresee_rays() */
    _Atomic bool stop;
};

static void *
try_job(void *arg)
{
    struct foresee *f = arg;
    struct trial_effort effort = SMALL_EFFORT;
    struct rad_error ignored = { 0 };
    struct prediction p;

    effort.stop = &f->stop;
    if (dryrun_predict(&p, &f->job, &effort, &ignored) == 0)
        f->rays = p.rays;
    atomic_store_explicit(&f->done, true, memory_order_release);
    return NULL;
}

struct foresee *
foresee_begin(const struct dryrun_job *job)
{
    struct foresee *f = calloc(1, sizeof *f);

    if (!f)
        return NULL;
    f->job = *job;
    if (pthread_create(&f->thread, NULL, try_job, f) != 0) {
        free(f);
        return NULL;
    }
    return f;
}

double
foresee_rays(const struct foresee *f)
{
    return atomic_load_explicit(&f->done, memory_order_acquire) ? f->rays : 0;
}

bool
foresee_end(struct foresee *f, bool hurry)
{
    if (!f)
        return true;
    atomic_store_explicit(&f->stop, true, memory_order_relaxed);
    if (hurry && !atomic_load_explicit(&f->done, memory_order_acquire))
        return false;
    pthread_join(f->thread, NULL);
    free(f);
    return true;
}
