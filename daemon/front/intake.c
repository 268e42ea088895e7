/* intake.c - see intake.h */
#include "config.h"

#include "front/intake.h"

#include "front/reply.h"
#include "jobs/job.h"
#include "registry/bygone.h"
#include "registry/joblife.h"
#include "registry/quota.h"
#include "registry/reuse.h"
#include "users/known.h"
#include "users/uploads.h"

#include "base/text.h"

#include <string.h>
#include <sysexits.h>

#define MOST_JOBS 20000 /* jobs of all users that are not over */

/* --- files --- */

void
intake_looked(struct coord *c, struct coord_conn *conn,
              const struct action_look *l)
{
    struct msg want = { .type = MSG_WANT, .request = l->request };
    const struct msg_hashes *f = &l->files;
    uint8_t *list = rad_arena_alloc(&c->actions.mem, (size_t)f->n * MSG_HASH);

    if (!list) {
        c->actions.failed = true;
        return;
    }
    for (uint32_t i = 0; i < f->n; i++) {
        const uint8_t *hash = f->hash + (size_t)i * MSG_HASH;

        if (i >= l->nlook || !c->env.has_file(c->env.arg, hash))
            memcpy(list + (size_t)want.want.n++ * MSG_HASH, hash, MSG_HASH);
    }
    want.want.hash = list;
    actions_send(&c->actions, conn->id, &want);
}

/* Sort the offered files: first the files that the user may know to be here, at
 * which the store looks.  The user is asked for the other files without a look,
 * for the time of a look would tell what other users have sent. */
static bool
sort_offer(struct coord *c, struct coord_owner *payer, struct action_look *l,
           const struct msg_hashes *offer)
{
    size_t bytes = (size_t)offer->n * MSG_HASH;
    uint8_t *list = rad_arena_alloc(&c->actions.mem, bytes), *end = list;

    if (!list)
        return false;
    for (int here = 1; here >= 0; here--) {
        for (uint32_t i = 0; i < offer->n; i++) {
            const uint8_t *hash = offer->hash + (size_t)i * MSG_HASH;

            if ((c->env.one_user || known_has(&payer->files, hash)) != here)
                continue;
            memcpy(end, hash, MSG_HASH);
            end += MSG_HASH;
            l->nlook += (uint32_t)here;
        }
    }
    l->files = (struct msg_hashes){ offer->n, list };
    for (uint32_t i = 0; i < l->nlook; i++) {
        const uint8_t *hash = list + (size_t)i * MSG_HASH;

        if (!known_sent(&payer->files, c->now_ms, hash))
            return false;
        uploads_offered(&c->uploads, &payer->uploads, hash, c->now_ms);
    }
    return true;
}

void
intake_offer(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct action_look l = { .conn = conn->id, .request = m->request };

    if (conn->offer_ms == 0 && reply_refused(c, conn, m, quota_upload))
        return;
    if (!sort_offer(c, conn->payer, &l, &m->offer)) {
        c->actions.failed = true;
        return;
    }
    if (conn->offer_ms == 0)
        conn->offer_ms = c->now_ms;
    conn->moved_ms = c->now_ms;
    if (!c->env.look || c->env.look(c->env.arg, &l))
        intake_looked(c, conn, &l);
    else
        conn->answers++;
}

/* May the store get this piece of a file?  A file is admitted or refused with
 * its first piece; later pieces of a refused file are dropped. */
static bool
admit_chunk(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    const struct msg_chunk *k = &m->chunk;
    struct rad_error err = { 0 };

    if (uploads_knows(&c->uploads, conn->id, k->hash))
        return true;
    if (k->offset != 0)
        return false;
    if (quota_file(c, conn, k->total, &err) != 0) {
        desk_reply_failed(c, conn, m->request, NULL, rad_exit_status(err.code),
                          err.what);
        return false;
    }
    if (uploads_begin(&c->uploads, conn->id, k->hash, k->total,
                      &conn->payer->uploads))
        return true;
    c->actions.failed = true;
    return false;
}

void
intake_chunk(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct action *a;

    conn->moved_ms = c->now_ms;
    if (!admit_chunk(c, conn, m))
        return;
    conn->sent_bytes += m->chunk.len;
    a = actions_add(&c->actions, ACT_PUT_CHUNK, conn->id);
    if (!a)
        return;
    a->request = m->request;
    a->chunk = m->chunk;
}

/* --- jobs --- */

/* Why a new job cannot be taken; 0: it can. */
static int
submit_fault(const struct coord *c, struct coord_conn *conn,
             const struct msg_spec *spec, struct rad_error *err)
{
    struct partition_spec p;

    if (!spec->frames)
        return rad_fail(err, RAD_EPROTO, "a job without its list of frames");
    if (quota_priority(spec->priority, err) != 0 ||
        quota_job(c, conn, spec, err) != 0)
        return err->code;
    if (c->nopen >= MOST_JOBS)
        return rad_fail(err, RAD_ETEMPFAIL, "the queue is full");
    if (job_partition_spec(spec, &p, err) != 0)
        return err->code;
    return partition_check(&p, err);
}

/* Has the job the options that were submitted?  In a job with a goal that began
 * with another job's cache they may be that job's. */
static bool
has_options(const struct job *job, const struct msg_spec *spec)
{
    return strcmp(job->spec.params, spec->params) == 0 ||
           (msg_has_goal(&job->spec) && job->spec.reuse);
}

/* There is a job of that id: if the SUBMIT has its files and options, let the
 * user watch the job. */
static void
attach(struct coord *c, struct coord_conn *conn, uint32_t request,
       const struct msg_spec *spec)
{
    struct job *job = reply_find_job(c, conn, request, spec->job, false);

    if (!job)
        return;
    if (memcmp(job->spec.manifest, spec->manifest, MSG_HASH) != 0 ||
        !has_options(job, spec)) {
        desk_reply_failed(c, conn, request, job->id, EX_DATAERR,
                          "there is a job of that id, with other files or "
                          "options");
        return;
    }
    conn->watch_request = request;
    if (job->place == PLACE_OPEN || job_over(job))
        joblife_send_accept(c, conn, job, true);
    if (job_over(job))
        joblife_send_end(c, conn, job);
    else
        conn->watch = job;
}

/* Let workers send rows coded as in a picture file, unless they have distances.
 */
static void
choose_coding(struct job *job)
{
    job->spec.flags &= ~MSG_JOB_CODED;
    if (!(job->spec.flags & MSG_JOB_DEPTH))
        job->spec.flags |= MSG_JOB_CODED;
}

/* Choose, once and for all, the job with whose cache this job begins. */
static int
choose_reuse(const struct coord *c, const struct coord_conn *conn,
             struct msg_spec *spec, char options[RAD_PARAMS_TEXT],
             struct rad_error *err)
{
    const struct job *from;

    if (!(spec->flags & MSG_JOB_REUSE))
        return 0;
    from = reuse_find(c, conn->owner, spec, err);
    if (err->code)
        return err->code;
    spec->reuse = from ? from->id : NULL;
    if (!from) {
        spec->flags &= ~MSG_JOB_REUSE;
        return 0;
    }
    if (msg_has_goal(spec)) {
        reuse_options(from, spec, options);
        spec->params = options;
    }
    return 0;
}

void
intake_submit(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct rad_error err = { 0 };
    struct msg_spec spec = m->submit;
    char options[RAD_PARAMS_TEXT];
    char name[200]; /* for the log */
    struct job *job;

    if (desk_find_job(c, m->submit.job)) {
        attach(c, conn, m->request, &m->submit);
        return;
    }
    if (submit_fault(c, conn, &spec, &err) != 0 ||
        choose_reuse(c, conn, &spec, options, &err) != 0) {
        conn->offer_ms = 0; /* what it offers next is another try */
        desk_reply_failed(c, conn, m->request, m->submit.job,
                          rad_exit_status(err.code), err.what);
        return;
    }
    job = job_new(&spec, conn->owner);
    if (!job || !joblife_add(c, job)) {
        job_free(job);
        c->actions.failed = true;
        return;
    }
    bygone_drop(c, job->id);
    choose_coding(job);
    uploads_named(&c->uploads, &conn->payer->uploads, &job->spec.files);
    job->submit_ms = job->found_ms = c->now_ms;
    job->offer_ms = conn->offer_ms ? conn->offer_ms : c->now_ms;
    job->sent_bytes = conn->sent_bytes;
    conn->offer_ms = conn->sent_bytes = 0;
    conn->watch = job;
    conn->watch_request = m->request;
    rad_text_print(name, sizeof name, "%s", job->spec.name);
    actions_log(&c->actions, ACT_INFO, "job new job=%s owner=%s name=%s",
                job->hex, job->owner, name);
    joblife_try_open(c, job);
}
