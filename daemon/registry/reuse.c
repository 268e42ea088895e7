/* reuse.c - see reuse.h
 *
 * The specifications of jobs that are over are in memory.  So specifications
 * are compared, not hashes of them, and the user is told what differs. */
#include "config.h"

#include "registry/reuse.h"

#include "machine/jobtext.h"
#include "filling/passes.h"
#include "filling/stages.h"

#include <string.h>

static const uint8_t no_job[MSG_JOB];

/* The options that records depend on, as text. */
static void
records_text(const struct rad_params *params, char text[RAD_PARAMS_TEXT])
{
    struct rad_params p;

    rad_params_of_records(params, &p);
    rad_params_format(&p, text, RAD_PARAMS_TEXT);
}

/* Set *theirs to the options of the other job's pictures, and *ours to the
 * options with which the new job would begin. */
static int
options_of(const struct job *from, const struct msg_spec *spec,
           struct rad_params *theirs, struct rad_params *ours,
           struct rad_error *err)
{
    int rc = jobtext_params(spec->params, ours, err);

    if (rc == 0)
        rc = stages_params(from, theirs, err);
    if (rc == 0 && msg_has_goal(spec))
        rad_refine_join(ours, theirs);
    return rc;
}

/* Check that the new job would make the records that the other job has;
 * RAD_EDATA says what differs. */
static int
check_fit(const struct job *job, const struct msg_spec *spec,
          struct rad_error *err)
{
    char ours[RAD_PARAMS_TEXT], theirs[RAD_PARAMS_TEXT];
    struct rad_params p, q;
    const char *name;
    int n;

    if (memcmp(job->spec.scene, spec->scene, MSG_HASH) != 0)
        return rad_fail(err, RAD_EDATA, "job %s is of another scene", job->hex);
    if (options_of(job, spec, &p, &q, err) < 0)
        return RAD_EDATA;
    records_text(&p, theirs);
    records_text(&q, ours);
    if (strcmp(ours, theirs) == 0)
        return 0;
    name = rad_params_differ(theirs, ours, &n);
    return rad_fail(err, RAD_EDATA,
                    "job %s has other options for ambient values: %.*s differs",
                    job->hex, n, name);
}

/* Has the job a cache? */
static int
check_cache(const struct coord *c, const struct job *job, struct rad_error *err)
{
    if (!job_over(job) || job->filing)
        return rad_fail(err, RAD_ETEMPFAIL, "job %s is not done yet", job->hex);
    if (job->state != JOB_DONE)
        return rad_fail(err, RAD_EDATA, "job %s is %s: it has no ambient cache",
                        job->hex, job_state_name(job->state));
    if (!(job->spec.flags & MSG_JOB_SCENE))
        return rad_fail(err, RAD_EDATA,
                        "job %s had no ambient cache in passes to be kept",
                        job->hex);
    if (job->cache.bytes > 0)
        return 0;
    return rad_fail(err, RAD_ENOINPUT,
                    "the ambient cache of job %s is not kept%s", job->hex,
                    c->keep.cache_bytes > 0
                        ? ", or not any more: see keep_caches_mib"
                        : ": keep_caches_mib is 0 here");
}

static int
check(const struct coord *c, const char *owner, const struct msg_spec *spec,
      const struct job *job, struct rad_error *err)
{
    int rc;

    if (strcmp(job->owner, owner) != 0)
        return rad_fail(err, RAD_EPERM, "job %s belongs to another user",
                        job->hex);
    rc = check_cache(c, job, err);
    return rc == 0 ? check_fit(job, spec, err) : rc;
}

static bool
is_later(const struct job *a, const struct job *b)
{
    return a->end_ms != b->end_ms ? a->end_ms > b->end_ms
                                  : a->sequence > b->sequence;
}

static const struct job *
find_last(const struct coord *c, const char *owner, const struct msg_spec *spec)
{
    const struct job *last = NULL;

    for (size_t i = 0; i < c->njobs; i++) {
        const struct job *job = c->jobs[i];

        if ((!last || is_later(job, last)) &&
            check(c, owner, spec, job, NULL) == 0)
            last = job;
    }
    return last;
}

const struct job *
reuse_find(const struct coord *c, const char *owner,
           const struct msg_spec *spec, struct rad_error *err)
{
    const struct job *job;
    char hex[MSG_JOB_HEX];

    if (memcmp(spec->reuse, no_job, MSG_JOB) == 0)
        return find_last(c, owner, spec);
    msg_job_format(spec->reuse, hex);
    job = desk_find_job(c, spec->reuse);
    if (!job)
        rad_fail(err, RAD_ENOINPUT, "no job %s to reuse the ambient cache of",
                 hex);
    return job && check(c, owner, spec, job, err) == 0 ? job : NULL;
}

void
reuse_options(const struct job *from, const struct msg_spec *spec,
              char text[RAD_PARAMS_TEXT])
{
    struct rad_params theirs, ours;

    if (options_of(from, spec, &theirs, &ours, NULL) == 0) /* as it was before
                                                            */
        rad_params_format(&ours, text, RAD_PARAMS_TEXT);
}

void
reuse_keep(const struct coord *c, struct job *job)
{
    struct passes_state s = passes_state(job);

    if (job->state != JOB_DONE || !(job->spec.flags & MSG_JOB_SCENE) ||
        !c->env.keeps || s.open < s.n ||
        job->goal.bytes + s.bytes > c->keep.cache_bytes)
        return;
    job->cache.bytes = s.bytes;
    job->cache.range =
        (struct pass_range){ .first = job->goal.base,
                             .end =
                                 job->goal.base + s.n -
                                 msg_has_goal(&job->spec), /* no check pass */
                             .all = job->goal.base + s.n };
}
