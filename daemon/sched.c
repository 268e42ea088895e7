/* sched.c - see sched.h
 *
 * A worker has room for as many units as it has threads and a few more, so
 * that no thread waits for the network; near the end of a job, when fewer
 * units wait than there are threads, it gets no more than it can work on.
 *
 * A unit keeps the number of its latest attempt.  When its worker goes, it
 * waits again; while nobody else has it, late rows of that attempt still
 * count, so that a connection that breaks for a moment costs little.  From the
 * next attempt on they are ignored.
 *
 * A child that dies leaves suspects: the units it was at work on.  Each is
 * tried again alone, on another worker if there is one, so that a second crash
 * names the culprit. */
#include "config.h"

#include "sched.h"

#include <stdio.h>
#include <string.h>
#include <sysexits.h>

#define MOST_PEERS 2000 /* in one JOB-PEERS */

/* --- helpers --- */

static struct coord_worker *
find_worker(const struct coord *c, const char *name)
{
    struct coord_worker *w = c->workers;

    while (w && strcmp(w->name, name) != 0)
        w = w->next;
    return w;
}

static bool
takes_units(const struct coord_worker *w)
{
    return w->conn != 0 && !w->drained && !w->leaving;
}

static void
send_job_end(struct coord *c, uint64_t conn, const uint8_t *job)
{
    struct msg m = { .type = MSG_JOB_END, .job_end = { job } };

    actions_send(&c->actions, conn, &m);
}

static void
send_ack(struct coord *c, uint64_t conn, const uint8_t *job, uint32_t unit,
         uint32_t attempt, uint32_t row, uint32_t rows)
{
    struct msg m = { .type = MSG_ACK,
                     .ack = { job, unit, attempt, row, rows } };

    actions_send(&c->actions, conn, &m);
}

/* The job and the index of w in it; NULL when the job is over or unknown, and
 * then the worker is told so. */
static struct job *
job_of_worker(struct coord *c, const struct coord_worker *w, const uint8_t *id,
              uint32_t *index)
{
    struct job *job = coord_find_job(c, id);

    if (!job || job_over(job)) {
        send_job_end(c, w->conn, id);
        return NULL;
    }
    *index = job_worker_find(job, w->name);
    if (*index == JOB_NOBODY) {
        send_job_end(c, w->conn, id);
        return NULL;
    }
    return job;
}

static void
less_in_flight(struct coord_worker *w, uint32_t n)
{
    w->in_flight -= n;
    if (w->in_flight == 0)
        w->alone = false;
}

/* --- handing out --- */

static uint32_t
ready_threads(const struct job *job)
{
    uint32_t n = 0;

    for (uint32_t i = 0; i < job->nworkers; i++)
        if (job->workers[i].state == JW_READY)
            n += job->workers[i].threads;
    return n;
}

static uint32_t
room_for(const struct job *job, const struct coord_worker *w)
{
    if (job_waiting(job) <= ready_threads(job))
        return w->threads;
    return w->threads + (w->threads + 1) / 2;
}

static void
start_job(struct coord *c, struct job *job, struct coord_worker *w)
{
    struct msg m = { .type = MSG_JOB_START, .job_start = job->spec };
    uint32_t i = job_worker_add(job, w->name);

    if (i == JOB_NOBODY) {
        c->actions.failed = true;
        return;
    }
    job->workers[i].state = JW_LOADING;
    job->workers[i].threads = w->threads;
    w->loading = job;
    actions_send(&c->actions, w->conn, &m);
}

/* The unit's earlier rows do not count any more. */
static void
forget_rows(struct job *job, struct job_unit *u, const struct partition_area *a)
{
    uint64_t pixels = (uint64_t)u->stored_rows * a->width;

    job->pixels_done -= pixels;
    job->frames[a->frame].rows_pixels -= pixels;
    u->next_row = u->stored_rows = 0;
}

static void
hand_out(struct coord *c, struct job *job, struct coord_worker *w,
         uint32_t index, uint32_t unit)
{
    struct job_unit *u = &job->units[unit];
    struct partition_area a;
    struct msg m = { .type = MSG_UNIT };

    partition_area(job->partition, unit, &a);
    forget_rows(job, u, &a);
    u->attempt++;
    if (u->attempt > 1)
        job->units_redone++;
    u->holder = u->worker = index;
    job->workers[index].in_flight++;
    w->in_flight++;
    if (job->first_ms == 0)
        job->first_ms = c->now_ms;
    if (job->state == JOB_WAITING)
        job->state = JOB_RUNNING;
    m.unit = (struct msg_unit){ .job = job->id,
                                .unit = unit,
                                .attempt = u->attempt,
                                .frame = a.frame,
                                .x = a.x,
                                .y = a.y,
                                .width = a.width,
                                .height = a.height };
    actions_send(&c->actions, w->conn, &m);
}

/* Could another worker than that one try a suspect? */
static bool
others_than(const struct coord *c, const char *name)
{
    for (const struct coord_worker *w = c->workers; w; w = w->next)
        if (takes_units(w) && strcmp(w->name, name) != 0)
            return true;
    return false;
}

/* A suspect that this worker may try; false: none. */
static bool
find_suspect(const struct coord *c, const struct job *job, uint32_t index,
             uint32_t *unit)
{
    for (uint32_t i = 0; i < job->nsuspects; i++) {
        uint32_t crasher = job->units[job->suspects[i]].crasher;

        if (crasher != index || !others_than(c, job->workers[crasher].name)) {
            *unit = job->suspects[i];
            return true;
        }
    }
    return false;
}

/* The worker gets nothing more until it can take a suspect alone. */
static bool
runs_empty(const struct coord *c, const struct job *job,
           const struct coord_worker *w, uint32_t index)
{
    uint32_t unit;

    return w->in_flight > 0 && find_suspect(c, job, index, &unit);
}

/* One unit of the job for the worker; false: it gets none now. */
static bool
give_unit(struct coord *c, struct job *job, struct coord_worker *w,
          uint32_t index)
{
    uint32_t unit;

    if (runs_empty(c, job, w, index))
        return false;
    if (find_suspect(c, job, index, &unit)) {
        job_suspect_remove(job, unit);
        w->alone = true;
    } else if (w->in_flight >= room_for(job, w) ||
               !partition_next(job->partition,
                               &(struct partition_who){
                                   .worker = index, .workers = 1, .share = 1 },
                               &unit)) {
        return false;
    }
    hand_out(c, job, w, index, unit);
    return true;
}

/* Nothing of this job for any worker now. */
static bool
idle_job(const struct job *job)
{
    return job_over(job) || !job->opened || job->state == JOB_PAUSED ||
           (job->partition && job_waiting(job) == 0);
}

/* One unit of the first job that has one for this worker; jobs that it does
 * not know yet it starts to load, one at a time. */
static bool
serve(struct coord *c, struct coord_worker *w)
{
    if (!takes_units(w) || w->alone)
        return false;
    for (size_t i = 0; i < c->njobs; i++) {
        struct job *job = c->jobs[i];
        uint32_t index;

        if (idle_job(job))
            continue;
        index = job_worker_find(job, w->name);
        if (index == JOB_NOBODY || job->workers[index].state == JW_GONE) {
            if (!w->loading &&
                (index == JOB_NOBODY || !job->workers[index].excluded))
                start_job(c, job, w);
        } else if (job->workers[index].state == JW_READY) {
            if (give_unit(c, job, w, index))
                return true;
            if (runs_empty(c, job, w, index))
                return false;
        }
    }
    return false;
}

/* A worker that leaves has nothing left to do. */
static void
let_go(struct coord *c, struct coord_worker *w)
{
    struct msg m = { .type = MSG_BYE, .bye = { "drained" } };

    if (w->conn == 0 || !w->leaving || w->in_flight > 0)
        return;
    actions_send(&c->actions, w->conn, &m);
    coord_break(c, w->conn, "drained");
}

void
sched_run(struct coord *c)
{
    bool gave;

    do { /* one each, in turn, so that few units spread over all workers */
        gave = false;
        for (struct coord_worker *w = c->workers; w; w = w->next)
            gave |= serve(c, w);
    } while (gave);
    for (struct coord_worker *w = c->workers; w; w = w->next)
        let_go(c, w);
}

/* --- peers --- */

/* Tell one worker of one peer. */
static void
send_peer(struct coord *c, const struct coord_worker *to, const uint8_t *job,
          const struct msg_peer *peer)
{
    struct msg m = { .type = MSG_JOB_PEERS, .job_peers = { job, 1, peer } };

    actions_send(&c->actions, to->conn, &m);
}

/* Link a worker that just became ready with those that are; the first of them
 * gives it what its cache holds. */
static void
introduce(struct coord *c, const struct job *job, const struct coord_worker *w)
{
    uint32_t give = MSG_PEER_GIVE, n = 0;

    for (uint32_t i = 0; i < job->nworkers && n < MOST_PEERS; i++) {
        const struct coord_worker *o = find_worker(c, job->workers[i].name);
        uint8_t token[MSG_TOKEN];
        bool dial;

        if (o == w || !o || o->conn == 0 || job->workers[i].state != JW_READY)
            continue;
        if (o->address[0] == '\0' && w->address[0] == '\0')
            continue;
        dial = o->address[0] != '\0'; /* the newcomer, where that is possible */
        c->env.random(c->env.arg, token, sizeof token);
        send_peer(c, o, job->id,
                  &(struct msg_peer){ w->name, dial ? "" : w->address, token,
                                      give | (dial ? 0 : MSG_PEER_DIAL) });
        send_peer(c, w, job->id,
                  &(struct msg_peer){ o->name, dial ? o->address : "", token,
                                      dial ? MSG_PEER_DIAL : 0 });
        give = 0;
        n++;
    }
}

/* --- messages of workers --- */

static bool
one_worker_in_all(const struct coord *c)
{
    uint32_t n = 0;

    for (const struct coord_worker *w = c->workers; w; w = w->next)
        n += takes_units(w);
    return n == 1;
}

/* With --same-bits the first worker's fingerprint is the job's. */
static bool
same_bits(const struct job *job, uint64_t fingerprint)
{
    if (!(job->spec.flags & MSG_JOB_SAME_BITS))
        return true;
    for (uint32_t i = 0; i < job->nworkers; i++)
        if (job->workers[i].took_part)
            return job->workers[i].fingerprint == fingerprint;
    return true;
}

static void
worker_ready(struct coord *c, struct job *job, struct coord_worker *w,
             struct job_worker *jw, const struct msg_ready *m)
{
    jw->state = JW_READY;
    jw->load_s = m->load_s;
    jw->fingerprint = w->fingerprint = m->fingerprint;
    jw->threads = w->threads = m->threads;
    if (!jw->took_part)
        jw->ready_ms = c->now_ms;
    jw->took_part = true;
    if (job->spec.flags & MSG_JOB_SHARE)
        introduce(c, job, w);
}

void
sched_ready(struct coord *c, struct coord_worker *w, const struct msg_ready *m)
{
    struct rad_error err = { 0 };
    struct job_worker *jw;
    uint32_t index;
    struct job *job = job_of_worker(c, w, m->job, &index);

    if (!job)
        return;
    if (w->loading == job)
        w->loading = NULL;
    jw = &job->workers[index];
    if (jw->state != JW_LOADING)
        return;
    if (!same_bits(job, m->fingerprint)) {
        jw->state = JW_GONE;
        jw->excluded = true;
        send_job_end(c, w->conn, job->id);
        return;
    }
    worker_ready(c, job, w, jw, m);
    if (!job->partition && job_split(job, one_worker_in_all(c), &err) != 0)
        coord_job_ends(c, job, JOB_FAILED, rad_exit_status(err.code), err.what);
}

/* Does the piece lie where the unit's rows lie? */
static bool
result_fits(const struct job *job, const struct msg_result *m,
            struct partition_area *a)
{
    uint8_t channels = job->spec.flags & MSG_JOB_DEPTH ? 4 : 3;

    if (m->unit >= partition_total(job->partition))
        return false;
    partition_area(job->partition, m->unit, a);
    return m->width == a->width && m->channels == channels &&
           m->row <= a->height && m->rows <= a->height - m->row &&
           m->last == (m->row + m->rows == a->height);
}

/* The worker that lost the unit turns out to have rows of it, and nobody else
 * began it. */
static void
revive(struct job *job, struct coord_worker *w, uint32_t index, uint32_t unit)
{
    if (!job_suspect_remove(job, unit))
        partition_take(job->partition, unit);
    job->units[unit].holder = index;
    job->workers[index].in_flight++;
    w->in_flight++;
}

static void
put_rows(struct coord *c, const struct job *job, uint64_t conn,
         const struct msg_result *m, const struct partition_area *a)
{
    struct action *act =
        actions_add_job(&c->actions, ACT_PUT_ROWS, conn, job->id);
    struct action_rows *r;

    if (!act)
        return;
    r = &act->rows;
    *r = (struct action_rows){ .conn = conn,
                               .unit = m->unit,
                               .attempt = m->attempt,
                               .row = m->row,
                               .rows = m->rows,
                               .frame = a->frame,
                               .x = a->x,
                               .y = a->y + m->row,
                               .width = m->width,
                               .channels = m->channels,
                               .last = m->last,
                               .pixels = m->pixels };
    memcpy(r->job, job->id, MSG_JOB);
}

void
sched_result(struct coord *c, struct coord_worker *w,
             const struct msg_result *m)
{
    struct partition_area a;
    struct job_unit *u;
    uint32_t index;
    struct job *job = job_of_worker(c, w, m->job, &index);

    if (!job)
        return;
    if (!job->partition) { /* of an earlier life of the coordinator */
        send_ack(c, w->conn, job->id, m->unit, m->attempt, m->row, m->rows);
        return;
    }
    if (!result_fits(job, m, &a)) {
        coord_break(c, w->conn, "a RESULT that fits no unit");
        return;
    }
    u = &job->units[m->unit];
    if (u->done || m->attempt != u->attempt || u->worker != index ||
        job->workers[index].state == JW_GONE ||
        m->row + m->rows <= u->stored_rows) {
        /* late or twice: let the worker forget it */
        send_ack(c, w->conn, job->id, m->unit, m->attempt, m->row, m->rows);
        return;
    }
    if (m->row < u->next_row)
        return; /* on its way to the disk */
    if (m->row > u->next_row) {
        coord_break(c, w->conn, "a RESULT out of turn");
        return;
    }
    if (u->holder == JOB_NOBODY)
        revive(job, w, index, m->unit);
    u->next_row += m->rows;
    if (m->last)
        u->counts = m->counts;
    put_rows(c, job, w->conn, m, &a);
}

/* --- losses --- */

/* Take a unit from whoever has it. */
static void
take_back(struct coord *c, struct job *job, struct job_unit *u)
{
    struct job_worker *jw = &job->workers[u->holder];
    struct coord_worker *w = find_worker(c, jw->name);

    jw->in_flight--;
    if (w)
        less_in_flight(w, 1);
    u->holder = JOB_NOBODY;
}

/* The worker has none of the job's units any more; suspects were taken out
 * before. */
static void
take_all_back(struct coord *c, struct job *job, uint32_t index)
{
    uint32_t n = job->partition ? partition_total(job->partition) : 0;

    for (uint32_t i = 0; i < n && job->workers[index].in_flight > 0; i++)
        if (job->units[i].holder == index) {
            take_back(c, job, &job->units[i]);
            if (job->units[i].crashes == 0 || !job_suspect_add(job, i))
                partition_lost(job->partition, i);
        }
}

void
sched_worker_gone(struct coord *c, struct coord_worker *w)
{
    w->loading = NULL;
    for (size_t i = 0; i < c->njobs; i++) {
        struct job *job = c->jobs[i];
        uint32_t index = job_worker_find(job, w->name);

        if (index == JOB_NOBODY || job->workers[index].state == JW_GONE)
            continue;
        take_all_back(c, job, index);
        job->workers[index].state = JW_GONE;
    }
}

/* A unit's child died; false: the job cannot go on. */
static bool
suspect(struct coord *c, struct job *job, uint32_t index, uint32_t unit,
        const char *why)
{
    struct job_unit *u = &job->units[unit];
    struct partition_area a;
    char text[MSG_MAX_TEXT + 1];

    take_back(c, job, u);
    u->crashes++;
    if (u->crashes == 1)
        u->crasher = index;
    if (u->crashes == 1 ||
        (u->crasher == index && u->crashes < JOB_MAX_CRASHES)) {
        if (!job_suspect_add(job, unit))
            c->actions.failed = true;
        return true;
    }
    partition_area(job->partition, unit, &a);
    snprintf(text, sizeof text,
             "unit %u (frame %u, %ux%u pixels at x %u, y %u) brought the "
             "renderer down %u times: %.200s",
             unit, job->spec.frames[a.frame].number, a.width, a.height, a.x,
             a.y, u->crashes, why);
    coord_job_ends(c, job, JOB_FAILED, EX_SOFTWARE, text);
    return false;
}

/* A child died before it was ready; false: the job cannot go on. */
static bool
crashed_loading(struct coord *c, struct job *job, struct job_worker *jw,
                const char *why)
{
    uint32_t workers = 0;
    char text[MSG_MAX_TEXT + 1];

    jw->load_crashes++;
    for (uint32_t i = 0; i < job->nworkers; i++)
        workers += job->workers[i].load_crashes > 0;
    if (workers < 2 && jw->load_crashes < JOB_MAX_CRASHES)
        return true;
    /* as long as others can, or may, it is this worker and not the scene */
    if (ready_threads(job) > 0 || (workers < 2 && others_than(c, jw->name))) {
        jw->excluded = true;
        return true;
    }
    snprintf(text, sizeof text, "no worker can load the scene: %.400s", why);
    coord_job_ends(c, job, JOB_FAILED, EX_SOFTWARE, text);
    return false;
}

static bool
has_unit(const struct job *job, uint32_t index, uint32_t unit)
{
    return job->partition && unit < partition_total(job->partition) &&
           job->units[unit].holder == index;
}

void
sched_lost(struct coord *c, struct coord_worker *w, const struct msg_lost *m)
{
    struct job_worker *jw;
    uint32_t index;
    struct job *job = job_of_worker(c, w, m->job, &index);

    if (!job)
        return;
    actions_log(&c->actions, ACT_WARN, "child lost job=%s worker=%s why=%s",
                job->hex, w->name, m->text);
    if (w->loading == job)
        w->loading = NULL;
    jw = &job->workers[index];
    if (jw->state == JW_LOADING && !crashed_loading(c, job, jw, m->text))
        return;
    for (uint32_t i = 0; i < m->nunits; i++)
        if (has_unit(job, index, m->units[i]) &&
            !suspect(c, job, index, m->units[i], m->text))
            return;
    take_all_back(c, job, index);
    jw->state = JW_GONE;
}

void
sched_tally(struct coord *c, struct coord_worker *w, const struct msg_tally *m)
{
    struct job_worker *jw;
    uint32_t index;
    struct job *job = job_of_worker(c, w, m->job, &index);

    if (!job)
        return;
    jw = &job->workers[index];
    if (m->busy_s < jw->tally.busy_s) { /* a new child counts from zero */
        jw->past = job_tally(jw);
        memset(&jw->tally, 0, sizeof jw->tally);
    }
    jw->tally = *m;
    jw->tally.job = NULL;
    job_see_rays(job);
}

/* --- rows --- */

static void
frame_done(struct coord *c, struct job *job, uint32_t frame)
{
    struct action *a =
        actions_add_job(&c->actions, ACT_WRITE_PICTURE, 0, job->id);

    job->frames[frame].writing = true;
    if (a)
        a->frame = frame;
}

static void
unit_done(struct coord *c, struct job *job, uint32_t unit, uint32_t frame)
{
    struct job_unit *u = &job->units[unit];
    struct job_worker *jw = &job->workers[u->worker];

    if (u->holder != JOB_NOBODY)
        take_back(c, job, u);
    else if (!job_suspect_remove(job, unit))
        partition_take(job->partition, unit); /* the worker went just now */
    partition_done(job->partition, unit);
    u->done = true;
    u->end_ms = job->last_ms = c->now_ms;
    jw->units++;
    jw->rays += u->counts.rays;
    jw->cpu_s += u->counts.cpu_s;
    job->rays += u->counts.rays;
    u->counts.nan.frame = job->spec.frames[frame].number;
    msg_nan_add(&job->nan, &u->counts.nan);
    job_see_rays(job);
    job->units_done++;
    job->cost_done += partition_cost(job->partition, unit);
    if (--job->frames[frame].units_left == 0)
        frame_done(c, job, frame);
}

void
sched_rows_stored(struct coord *c, const struct action_rows *key)
{
    struct job *job = coord_find_job(c, key->job);
    struct coord_conn *conn = coord_find_conn(c, key->conn);
    struct job_unit *u;
    uint64_t pixels = (uint64_t)key->rows * key->width;

    if (!job || job_over(job))
        return;
    u = &job->units[key->unit];
    if (conn && conn->worker)
        send_ack(c, conn->id, job->id, key->unit, key->attempt, key->row,
                 key->rows);
    if (u->done || u->attempt != key->attempt || u->stored_rows != key->row)
        return;
    u->stored_rows += key->rows;
    job->pixels_done += pixels;
    job->frames[key->frame].rows_pixels += pixels;
    if (key->last)
        unit_done(c, job, key->unit, key->frame);
}

void
sched_job_over(struct coord *c, struct job *job)
{
    for (struct coord_worker *w = c->workers; w; w = w->next) {
        uint32_t index = job_worker_find(job, w->name);
        struct job_worker *jw;

        if (w->loading == job)
            w->loading = NULL;
        if (index == JOB_NOBODY)
            continue;
        jw = &job->workers[index];
        less_in_flight(w, jw->in_flight);
        jw->in_flight = 0;
        jw->state = JW_GONE;
        if (w->conn != 0)
            send_job_end(c, w->conn, job->id);
    }
}
