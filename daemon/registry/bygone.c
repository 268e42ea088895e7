/* bygone.c - how long jobs that are over are remembered, and the records of
 * jobs that were forgotten
 *
 * Each owner's jobs are counted by themselves, so no user's jobs push out the
 * pictures of another user.  A job with frames that the owner has not fetched
 * is kept for unfetched_ms, whatever the other limits say; quota.c takes no
 * further job from a user with too many such jobs.  Of an owner's other jobs
 * the oldest is forgotten while there are too many jobs, the oldest is too old,
 * or all take too much room.  A job with whose cache a new job begins stays
 * until the new job has the records, however long its files take to come. */
#include "config.h"

#include "registry/bygone.h"

#include "desk/desk.h"
#include "jobs/job.h"
#include "registry/joblife.h"

#include "base/list.h"
#include "base/text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define FETCH_MS 60000 /* time in which a user fetches all files of a job */
#define FETCHING 64    /* jobs of a user that may be fetched at once */
#define LOOK_MS  1000  /* between two looks if no job ended or was fetched */

static uint64_t
since(const struct coord *c, uint64_t ms)
{
    return c->now_ms > ms ? c->now_ms - ms : 0;
}

/* --- jobs that are remembered --- */

/* Is a file of the job being sent, or may the user still ask for other files of
 * it, such as distances and statistics? */
static bool
is_being_fetched(const struct coord *c, const struct job *job)
{
    return job->fetched_ms > 0 && since(c, job->fetched_ms) < FETCH_MS;
}

/* Why the oldest job of an owner must be forgotten; GONE_NWHYS: it may stay. */
static enum gone_why
reason(const struct coord *c, const struct coord_kept *k)
{
    if (!k->oldest)
        return GONE_NWHYS;
    if (k->jobs > c->keep.jobs || (k->jobs > 1 && k->weight > c->keep.jobs))
        return GONE_MANY;
    if (c->keep.ms > 0 && desk_age_ms(c, k->oldest) >= c->keep.ms)
        return GONE_OLD;
    if (c->keep.bytes > 0 && k->bytes > c->keep.bytes &&
        since(c, k->oldest->end_ms) >= FETCH_MS)
        return GONE_LARGE;
    return GONE_NWHYS;
}

/* Note that a file of the job is being sent.  On a slow line a file takes
 * longer than FETCH_MS, and a line that breaks is dialled again: from then on,
 * too, the job stays for FETCH_MS. */
static void
note_sent(void *with, const uint8_t id[MSG_JOB])
{
    const struct coord *c = with;
    struct job *job = desk_find_job(c, id);

    if (job && job_over(job))
        job->fetched_ms = c->now_ms;
}

/* Is the job over, and may it be forgotten once it is not being fetched? */
static bool
is_limited(const struct coord *c, const struct job *job)
{
    return job_over(job) && !desk_unfetched(c, job) && !job->cache.held;
}

static void
count_kept(struct coord *c)
{
    for (struct coord_owner *o = c->owners; o; o = o->next)
        o->kept = (struct coord_kept){ 0 };
    for (size_t i = 0; i < c->njobs; i++) {
        struct job *job = c->jobs[i];
        struct coord_kept *k = &job->payer->kept;

        if (job_over(job))
            k->bytes += job->kept_bytes;
        if (!is_limited(c, job))
            continue;
        if (is_being_fetched(c, job)) {
            k->fetching++;
            if (!k->fetched || job->fetched_ms < k->fetched->fetched_ms)
                k->fetched = job;
            continue;
        }
        k->jobs++;
        k->weight += job_weight(job);
        if (!k->oldest || job->end_ms < k->oldest->end_ms)
            k->oldest = job;
    }
}

static int
by_end(const void *a, const void *b)
{
    const struct job *p = *(struct job *const *)a;
    const struct job *q = *(struct job *const *)b;

    if (p->end_ms != q->end_ms)
        return p->end_ms < q->end_ms ? -1 : 1;
    return (p->sequence > q->sequence) - (p->sequence < q->sequence);
}

/* List the jobs for which `is` holds, the oldest first: *n of them, malloc'd;
 * NULL: memory is out. */
static struct job **
list_oldest(struct coord *c,
            bool (*is)(const struct coord *c, const struct job *job), size_t *n)
{
    struct job **v = malloc((c->njobs + 1) * sizeof *v);

    *n = 0;
    for (size_t i = 0; v && i < c->njobs; i++)
        if (is(c, c->jobs[i]))
            v[(*n)++] = c->jobs[i];
    if (v)
        qsort(v, *n, sizeof *v, by_end);
    else
        c->actions.failed = true;
    return v;
}

static bool
may_be_forgotten(const struct coord *c, const struct job *job)
{
    return is_limited(c, job) && !is_being_fetched(c, job);
}

/* Forget jobs of all owners, each owner's oldest first, until there is no
 * reason to forget a further job.  There may be very many: a limit was lowered,
 * or they have become too old while no coordinator ran. */
static void
forget_listed(struct coord *c)
{
    size_t n;
    struct job **v = list_oldest(c, may_be_forgotten, &n);

    for (size_t i = 0; i < n; i++) {
        struct coord_kept *k = &v[i]->payer->kept;
        enum gone_why why;

        k->oldest = v[i];
        why = reason(c, k);
        if (why == GONE_NWHYS)
            continue;
        k->jobs--;
        k->weight -= job_weight(v[i]);
        k->bytes -= v[i]->kept_bytes;
        bygone_forget(c, v[i], why);
    }
    free(v);
}

/* Small jobs may be fetched by the hundred in a minute: if more than FETCHING
 * of an owner are being fetched, the job that was fetched from the longest ago
 * may be forgotten.  False: all may stay. */
static bool
forget_fetched(struct coord *c, const struct coord_kept *k)
{
    if (k->fetching <= FETCHING || k->fetching + k->jobs <= c->keep.jobs)
        return false;
    bygone_forget(c, k->fetched, GONE_MANY);
    return true;
}

static bool
has_reason(const struct coord *c)
{
    const struct coord_owner *o = c->owners;

    while (o && reason(c, &o->kept) == GONE_NWHYS)
        o = o->next;
    return o;
}

static void
hold_caches(struct coord *c)
{
    struct job *from;

    for (size_t i = 0; i < c->njobs; i++)
        c->jobs[i]->cache.held = false;
    for (size_t i = 0; i < c->njobs; i++) {
        const struct job *job = c->jobs[i];

        if (job->spec.reuse && job->place < PLACE_OPEN && !job_over(job) &&
            (from = desk_find_job(c, job->spec.reuse)))
            from->cache.held = true;
    }
}

static void
drop_cache(struct coord *c, struct job *job)
{
    struct action *a = actions_add_job(&c->actions, ACT_DROP_CACHE, 0, job->id);

    if (a)
        a->sequence = job->sequence;
    job->cache.bytes = 0;
    actions_log(&c->actions, ACT_INFO, "cache dropped job=%s owner=%s",
                job->hex, job->owner);
}

/* Not before the store has kept the job's end: with the end it keeps the cache.
 */
static bool
may_lose_cache(const struct coord *c, const struct job *job)
{
    (void)c;
    return job->cache.bytes > 0 && !job->cache.held && job->place >= PLACE_KEPT;
}

/* Drop ambient caches, the oldest first, while the caches of all users together
 * are too large. */
static void
limit_caches(struct coord *c)
{
    uint64_t all = 0;
    struct job **v;
    size_t n;

    for (size_t i = 0; i < c->njobs; i++)
        all += c->jobs[i]->cache.bytes;
    if (all <= c->keep.cache_bytes)
        return;
    v = list_oldest(c, may_lose_cache, &n);
    for (size_t i = 0; i < n && all > c->keep.cache_bytes; i++) {
        all -= v[i]->cache.bytes;
        drop_cache(c, v[i]);
    }
    free(v);
}

void
bygone_forget_old(struct coord *c)
{
    bool again = c->keep_due || since(c, c->keep_ms) >= LOOK_MS;

    c->keep_due = false;
    if (again) {
        if (c->env.each_sent)
            c->env.each_sent(c->env.arg, note_sent, c);
        hold_caches(c);
        limit_caches(c);
    }
    while (again) {
        c->keep_ms = c->now_ms;
        count_kept(c);
        if (has_reason(c))
            forget_listed(c);
        again = false;
        for (struct coord_owner *o = c->owners; o; o = o->next)
            again |= forget_fetched(c, &o->kept);
    }
}

/* --- frames that are fetched --- */

/* The file of a frame for which the job's owner waits.  Sensor points have no
 * picture that can be fetched: their values travel as distances do. */
static enum msg_what
main_file(const struct job *job)
{
    return job->spec.flags & MSG_JOB_POINTS ? MSG_WHAT_DEPTH : MSG_WHAT_PICTURE;
}

/* Does the connection belong to the job's owner, who may change it? */
static bool
is_owners(const struct coord_conn *conn, const struct job *job)
{
    return conn->session != MSG_AT_COORD_OBSERVER &&
           strcmp(conn->owner, job->owner) == 0;
}

void
bygone_fetching(const struct coord *c, const struct coord_conn *conn,
                struct job *job)
{
    if (is_owners(conn, job))
        job->fetched_ms = c->now_ms;
}

void
bygone_fetched(struct coord *c, uint64_t now_ms, uint64_t conn,
               const uint8_t id[MSG_JOB], uint32_t frame, enum msg_what what)
{
    const struct coord_conn *to = desk_find_conn(c, conn);
    struct job *job = desk_find_job(c, id);
    struct action *a;

    c->now_ms = now_ms;
    if (!to || !job || !is_owners(to, job))
        return;
    job->fetched_ms = now_ms;
    if (what != main_file(job) || frame >= job->spec.nframes ||
        !frame_is_written(&job->frames[frame]) ||
        job->frames[frame].state == FRAME_FETCHED)
        return;
    frame_step(&job->frames[frame], FRAME_FETCHED);
    job->unfetched--;
    c->keep_due = true;
    a = c->env.keeps ? actions_add_job(&c->actions, ACT_JOB_FETCHED, 0, id)
                     : NULL;
    if (a)
        a->frame = frame;
}

/* --- jobs that are forgotten --- */

static void
drop_gone(struct coord *c, size_t i)
{
    memmove(c->gones + i, c->gones + i + 1,
            (c->ngones - i - 1) * sizeof *c->gones);
    c->ngones--;
}

/* Forget the oldest records of an owner's forgotten jobs, beyond SAVED_GONES.
 */
static void
limit_gones(struct coord *c, const char *owner)
{
    size_t n = 0;

    for (size_t i = c->ngones; i-- > 0;)
        if (strcmp(c->gones[i].owner, owner) == 0 && ++n > SAVED_GONES)
            drop_gone(c, i);
}

void
bygone_recall(struct coord *c, const struct saved_gone *g)
{
    if (g->why == GONE_DELETED)
        return; /* a user has deleted the job, and knows */
    if (!rad_list_grow(&c->gones, c->ngones, sizeof *c->gones))
        return; /* memory is out: users are not told why the job is gone */
    c->gones[c->ngones] = *g;
    if (c->gones[c->ngones].sequence == 0)
        c->gones[c->ngones].sequence = ++c->sequence;
    c->ngones++;
    limit_gones(c, g->owner);
}

void
bygone_drop(struct coord *c, const uint8_t job[MSG_JOB])
{
    for (size_t i = c->ngones; i-- > 0;)
        if (memcmp(c->gones[i].job, job, MSG_JOB) == 0)
            drop_gone(c, i);
}

const struct saved_gone *
bygone_find(const struct coord *c, const char *hex)
{
    for (size_t i = c->ngones; i-- > 0;) {
        char text[MSG_JOB_HEX];

        msg_job_format(c->gones[i].job, text);
        if (strncmp(text, hex, strlen(hex)) == 0)
            return &c->gones[i];
    }
    return NULL;
}

void
bygone_time_text(uint64_t ms, char text[BYGONE_TIME])
{
    time_t s = (time_t)(ms / 1000);
    struct tm tm;

    if (!gmtime_r(&s, &tm) ||
        strftime(text, BYGONE_TIME, "%Y-%m-%d %H:%M UTC", &tm) == 0)
        snprintf(text, BYGONE_TIME, "?");
}

void
bygone_text(const struct saved_gone *g, char text[MSG_MAX_TEXT + 1])
{
    static const char *const whys[GONE_NWHYS] = {
        [GONE_MANY] = "forgotten for keep_jobs",
        [GONE_OLD] = "forgotten for keep_days",
        [GONE_LARGE] = "forgotten for keep_mib",
        [GONE_BEFORE] = "forgotten at a restart",
        [GONE_DELETED] = "deleted by radctl",
    };
    char when[BYGONE_TIME];

    bygone_time_text(g->gone_ms, when);
    /* short enough for a cell of a table */
    snprintf(text, MSG_MAX_TEXT + 1, "%s on %s%s",
             g->why < GONE_NWHYS ? whys[g->why] : "forgotten", when,
             g->fetched ? "" : ", not fetched");
}

/* The record of a job that is forgotten. */
static struct saved_gone
gone_of(const struct coord *c, const struct job *job, enum gone_why why)
{
    struct saved_gone g = { .why = why,
                            .fetched = job->unfetched == 0,
                            .end_ms = job->over_ms,
                            .gone_ms = desk_shown_ms(c, desk_date_ms(c)),
                            .sequence = job->sequence };

    memcpy(g.job, job->id, MSG_JOB);
    snprintf(g.owner, sizeof g.owner, "%s", job->owner);
    rad_text_print(g.name, sizeof g.name, "%s", job->spec.name);
    return g;
}

void
bygone_forget(struct coord *c, struct job *job, enum gone_why why)
{
    struct saved_gone gone = gone_of(c, job, why);
    struct action *a = actions_add(&c->actions, ACT_JOB_FORGET, 0);
    char text[MSG_MAX_TEXT + 1];

    if (a)
        a->gone = actions_keep(&c->actions, &gone, sizeof gone);
    bygone_text(&gone, text);
    actions_log(&c->actions, ACT_INFO, "job forgotten job=%s owner=%s why=%s",
                job->hex, job->owner, text);
    bygone_recall(c, &gone);
    joblife_drop(c, job);
}
