/* quota.c - see quota.h */
#include "config.h"

#include "registry/quota.h"

#include "desk/desk.h"
#include "jobs/job.h"

#include <inttypes.h>
#include <jansson.h>
#include <stdio.h>
#include <string.h>

/* --- what a user has --- */

struct use {
    uint64_t jobs, frames; /* jobs that are not over, and their frames */
    uint64_t bytes;        /* on the disk: of jobs and of uploads */
    uint64_t uploads;      /* bundles and files that are being sent */
    uint64_t upload_bytes; /* of files that no job of the user names yet */
    uint64_t unfetched;    /* jobs with pictures that were not fetched */
    uint64_t conns, answers;
    uint64_t unread; /* bytes of answers that were not read */
};

static uint64_t
row_bytes(const struct msg_spec *s)
{
    return s->flags & MSG_JOB_DEPTH ? 16 : 4; /* of a pixel (rows.h) */
}

static uint64_t
spec_bytes(const struct msg_spec *s)
{
    uint64_t pixels = 0;

    for (uint32_t i = 0; i < s->nframes; i++)
        pixels += (uint64_t)s->frames[i].width * s->frames[i].height;
    return pixels * row_bytes(s);
}

/* Bytes on the disk for a job: the files sent for it, and its rows or pictures.
 */
static uint64_t
job_bytes(const struct job *job)
{
    return job->sent_bytes + (job_over(job)
                                  ? job->kept_bytes
                                  : job->pixels_total * row_bytes(&job->spec));
}

static void
count_jobs(const struct coord *c, const struct coord_owner *o, struct use *out)
{
    for (size_t i = 0; i < c->njobs; i++) {
        const struct job *job = c->jobs[i];

        if (job->payer != o)
            continue;
        out->bytes += job_bytes(job);
        out->unfetched += desk_unfetched(c, job);
        if (job_over(job))
            continue;
        out->jobs++;
        out->frames += job->frames_counted;
    }
}

/* Count all but what jobs take: those of all users have to be looked at for
 * that, and they are thousands. */
static const struct coord_owner *
count_small(const struct coord *c, const char *owner, struct use *out)
{
    const struct coord_owner *o = c->owners;

    *out = (struct use){ 0 };
    for (const struct coord_conn *i = c->conns; i; i = i->next) {
        if (strcmp(i->owner, owner) != 0)
            continue;
        out->conns++;
        out->uploads += i->offer_ms != 0;
        out->answers += i->answers;
    }
    while (o && strcmp(o->name, owner) != 0)
        o = o->next;
    if (o) {
        out->uploads += o->uploads.under_way;
        out->upload_bytes = o->uploads.bytes;
        out->bytes += o->uploads.bytes;
    }
    if (c->env.unread)
        out->unread = c->env.unread(c->env.arg, owner);
    return o;
}

static void
count_use(const struct coord *c, const char *owner, struct use *out)
{
    count_jobs(c, count_small(c, owner, out), out);
}

/* --- what a user may have --- */

/* Has the connection no limits?  Administrators could end the cluster anyway.
 */
static bool
is_free(const struct coord_conn *conn)
{
    return conn->roles != 1u << MSG_ROLE_USER &&
           conn->roles != 1u << MSG_ROLE_OBSERVER;
}

/* May there be `more` beside `used`, up to `most` in all?  remedy: what the
 * user can do to have room. */
static int
check(const char *name, uint64_t used, uint64_t more, uint64_t most,
      const char *what, const char *remedy, struct rad_error *err)
{
    if (used <= most && more <= most - used)
        return 0;
    if (more > most)
        return rad_fail(err, RAD_EDATA,
                        "limit %s: %" PRIu64 " %s are wanted, and %" PRIu64
                        " is the most: take less, or ask for a higher limit",
                        name, more, what, most);
    return rad_fail(err, RAD_ETEMPFAIL,
                    "limit %s: you have %" PRIu64 " of %" PRIu64
                    " %s: %s or try again later (see 'radctl limits')",
                    name, used, most, what, remedy);
}

int
quota_priority(int32_t priority, struct rad_error *err)
{
    if (priority >= -MSG_MOST_PRIORITY && priority <= MSG_MOST_PRIORITY)
        return 0;
    return rad_fail(err, RAD_EUSAGE, "priority %d: it may be from %d to %d",
                    priority, -MSG_MOST_PRIORITY, MSG_MOST_PRIORITY);
}

static uint64_t
mib(uint64_t bytes)
{
    return (bytes + (1u << 20) - 1) >> 20;
}

static int
check_stored(const struct coord_limits *l, const struct use *u, uint64_t bytes,
             struct rad_error *err)
{
    return check("user_mib", mib(u->bytes), mib(bytes), l->bytes >> 20,
                 "MiB stored", "delete jobs that are over", err);
}

static int
check_uploads(const struct coord_limits *l, const struct use *u,
              struct rad_error *err)
{
    return check("user_uploads", u->uploads, 1, l->uploads, "uploads under way",
                 "end some", err);
}

/* Connections of the same user that are in line before this one. */
static uint64_t
count_line(const struct coord *c, const struct coord_conn *conn)
{
    uint64_t n = 0;

    for (const struct coord_conn *i = c->conns; i; i = i->next)
        n += i->in_line && i->id < conn->id &&
             strcmp(i->owner, conn->owner) == 0;
    return n;
}

static int
check_jobs(const struct coord *c, const struct coord_conn *conn, uint64_t used,
           struct rad_error *err)
{
    uint64_t most = c->limits.jobs, before = count_line(c, conn);
    int rc = check("user_jobs", used, 1, most, "jobs that are not over",
                   "cancel some", err);

    if (rc < 0 || before < most - used)
        return rc;
    return rad_fail(err, RAD_ETEMPFAIL,
                    "limit user_jobs: you have %" PRIu64 " of %" PRIu64
                    " jobs that are not over, and %" PRIu64
                    " are in line before this one: try again later (see "
                    "'radctl limits')",
                    used, most, before);
}

int
quota_job(const struct coord *c, struct coord_conn *conn,
          const struct msg_spec *spec, struct rad_error *err)
{
    const struct coord_limits *l = &c->limits;
    struct use u;
    int rc;

    conn->in_line = false;
    if (is_free(conn))
        return 0;
    count_use(c, conn->owner, &u);
    /* first the limits that the job alone may exceed */
    rc = check("user_frames", u.frames, job_count_frames(spec), l->frames,
               "frames to render", "cancel jobs", err);
    /* the job's pixels alone: the bundle's files are in u.bytes already */
    if (rc == 0)
        rc = check_stored(l, &u, spec_bytes(spec), err);
    if (rc == 0) {
        rc = check_jobs(c, conn, u.jobs, err);
        conn->in_line = rc == RAD_ETEMPFAIL;
    }
    if (rc == 0 && u.unfetched >= l->unfetched)
        rc = rad_fail(err, RAD_ETEMPFAIL,
                      "limit user_unfetched: you have %" PRIu64 " of %" PRIu64
                      " jobs that are done and not fetched: fetch or delete "
                      "some (see 'radctl jobs' and 'radctl limits')",
                      u.unfetched, l->unfetched);
    return rc;
}

int
quota_upload(const struct coord *c, const struct coord_conn *conn,
             struct rad_error *err)
{
    struct use u;

    if (is_free(conn))
        return 0;
    count_small(c, conn->owner, &u);
    return check_uploads(&c->limits, &u, err);
}

int
quota_file(const struct coord *c, const struct coord_conn *conn, uint64_t bytes,
           struct rad_error *err)
{
    const struct coord_limits *l = &c->limits;
    struct use u;
    int rc;

    if (is_free(conn))
        return 0;
    count_use(c, conn->owner, &u);
    rc = check_uploads(l, &u, err);
    if (rc == 0)
        rc = check("user_upload_mib", mib(u.upload_bytes), mib(bytes),
                   l->upload_bytes >> 20, "MiB sent for no job yet",
                   "end uploads", err);
    if (rc == 0)
        rc = check_stored(l, &u, bytes, err);
    return rc;
}

int
quota_answer(const struct coord *c, const struct coord_conn *conn,
             struct rad_error *err)
{
    struct use u;

    if (is_free(conn))
        return 0;
    count_small(c, conn->owner, &u);
    return check("user_answers", u.answers, 1, c->limits.answers,
                 "answers under way", "end some", err);
}

/* --- as a report --- */

static json_t *
row(const char *name, uint64_t used, uint64_t most, const char *what)
{
    return json_pack("{s:s,s:I,s:I,s:s}", "limit", name, "used",
                     (json_int_t)used, "most", (json_int_t)most, "what", what);
}

char *
quota_report(const struct coord *c, const char *owner)
{
    const struct coord_limits *l = &c->limits;
    struct use u;
    json_t *root;
    char *text;

    count_use(c, owner, &u);
    root = json_pack(
        "{s:s,s:[o,o,o,o,o,o,o,o,o]}", "user", owner, "limits",
        row("user_jobs", u.jobs, l->jobs, "jobs that are not over"),
        row("user_frames", u.frames, l->frames, "frames of these"),
        row("user_unfetched", u.unfetched, l->unfetched,
            "jobs whose pictures are not fetched"),
        row("user_mib", mib(u.bytes), l->bytes >> 20, "MiB stored"),
        row("user_uploads", u.uploads, l->uploads, "uploads under way"),
        row("user_upload_mib", mib(u.upload_bytes), l->upload_bytes >> 20,
            "MiB sent for no job yet"),
        row("user_connections", u.conns, l->conns, "connections"),
        row("user_answers", u.answers, l->answers, "answers under way"),
        row("user_unread_mib", mib(u.unread), l->unread >> 20,
            "MiB of answers not read"));
    if (!root)
        return NULL;
    text = json_dumps(root, JSON_INDENT(1));
    json_decref(root);
    return text;
}
