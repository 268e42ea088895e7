/* result.c - see result.h */
#include "config.h"

#include "sched/result.h"

#include "desk/desk.h"
#include "desk/duplicate.h"
#include "desk/holding.h"
#include "desk/speed.h"
#include "desk/verdict.h"
#include "filling/passes.h"
#include "jobs/attempt.h"
#include "jobs/job.h"
#include "jobs/part.h"
#include "jobs/progress.h"
#include "jobs/shared.h"
#include "jobs/unit.h"
#include "lines/handoff.h"
#include "sched/loss.h"

#include "image/hdr.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

/* The leading attempt may have been stopped if it sent rows and then none for
 * this long.  But rows may take that long, so the time doubles whenever a twin
 * takes the lead: else attempts could overtake each other for ever. */
#define LEAD_SILENT_MS 15000
#define SILENT_DOUBLES 16

/* Has the message as many coded rows as it says, and none too long? */
static bool
is_coded_right(const struct msg_result *m)
{
    size_t at = 0;

    for (uint32_t i = 0; i < m->rows; i++) {
        size_t n =
            rad_hdr_row_bytes(m->pixels + at, m->len - at, (int)m->width);

        if (n == 0 || n > RAD_HDR_CODED_BYTES(m->width))
            return false;
        at += n;
    }
    return at == m->len;
}

/* Do the rows lie in the unit, and are they of its kind? */
static bool
result_fits(const struct job *job, const struct msg_result *m,
            const struct partition_area *a)
{
    return m->width == a->width && m->channels == job_channels(job) &&
           m->row <= a->height && m->rows <= a->height - m->row &&
           (m->last || m->row + m->rows < a->height) &&
           (m->channels > 1 || is_coded_right(m));
}

/* Have the densities of the unit's bottom kept with its last row: the unit
 * below needs both. */
static void
add_bottom(const struct job *job, const struct msg_result *m,
           struct action_rows *r)
{
    uint32_t first, last;

    if (!job->shared)
        return;
    partition_unit_lines(job->partition, m->unit, &first, &last);
    r->bottom = shared_densities(job->shared, r->frame, last - 1);
    r->nbottom = r->bottom ? shared_ndensity(job->shared, r->frame) : 0;
    if (m->channels == 1)
        r->line = shared_pixels(job->shared, r->frame, last - 1);
}

static void
put_rows(struct coord *c, const struct job *job, uint32_t index,
         const struct msg_result *m, const struct partition_area *a)
{
    uint64_t conn = job->parts[index].worker->conn;
    struct action *act =
        actions_add_job(&c->actions, ACT_PUT_ROWS, conn, job->id);
    struct action_rows *r;

    if (!act)
        return;
    r = &act->rows;
    *r = (struct action_rows){ .sequence = job->sequence,
                               .part = index,
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
                               .awaited = m->last && job_waiting(job) == 0,
                               .pixels = m->pixels,
                               .len = m->len,
                               .date_ms = desk_date_ms(c) };
    memcpy(r->job, job->id, MSG_JOB);
    if (!m->last)
        return;
    r->counts = actions_keep(&c->actions, &job->units[m->unit].counts,
                             sizeof *r->counts);
    add_bottom(job, m, r);
}

/* Acknowledge rows that do not count, so that the worker forgets them. */
static void
ack(struct coord *c, const struct coord_worker *w, const struct job *job,
    const struct msg_result *m)
{
    desk_send_ack(
        c, w->conn,
        &(struct msg_ack){ job->id, m->unit, m->attempt, m->row, m->rows });
}

/* The attempt's last row came, but other rows or the bottom are missing: the
 * unit waits again.  A message may have been lost with a connection, so only a
 * unit that comes incomplete again and again fails the job. */
static void
drop_incomplete(struct coord *c, struct job *job, struct job_attempt *attempt)
{
    uint32_t unit = attempt->unit;
    struct job_unit *u = &job->units[unit];
    char text[MSG_MAX_TEXT + 1];

    actions_log(&c->actions, ACT_WARN,
                "unit incomplete job=%s unit=%u attempt=%u worker=%s", job->hex,
                unit, attempt->number, job->parts[attempt->part].name);
    holding_forget_rows(job, unit);
    u->lead = 0;
    loss_of(c, job, attempt);
    if (++u->faults < JOB_MAX_CRASHES)
        return;
    snprintf(text, sizeof text, "unit %u came incomplete %u times", unit,
             u->faults);
    verdict_job(c, job, JOB_FAILED, EX_SOFTWARE, text);
}

/* Let the twin that sends its first rows lead, if the leading attempt has been
 * silent for so long that its worker may be stopped. */
static void
overtake(const struct coord *c, struct job *job, struct job_attempt *attempt,
         const struct msg_result *m)
{
    struct job_unit *u = &job->units[m->unit];
    uint64_t silent_ms = (c->lease_floor_ms < LEAD_SILENT_MS ? c->lease_floor_ms
                                                             : LEAD_SILENT_MS)
                         << u->overtaken;

    if (m->row != 0 || attempt->rows != ATTEMPT_MAY_LEAD || u->next_row == 0 ||
        c->now_ms - u->row_ms < silent_ms)
        return;
    for (uint8_t i = 0; i < u->nattempts; i++)
        if (u->attempts[i].number == u->lead) {
            if (u->attempts[i].state == ATTEMPT_DELIVERED)
                return; /* it is not silent: the disk is slow */
            u->attempts[i].rows = ATTEMPT_DROPPED;
        }
    holding_forget_rows(job, m->unit);
    u->lead = 0;
    if (u->overtaken < SILENT_DOUBLES)
        u->overtaken++;
}

/* Rows of an attempt came: decide which attempt leads.  The one whose first
 * rows come first. */
static void
choose_lead(struct coord *c, struct job *job, struct job_attempt *attempt,
            const struct msg_result *m)
{
    struct job_unit *u = &job->units[m->unit];

    if (u->lead != m->attempt)
        overtake(c, job, attempt, m);
    if (u->lead == 0 && m->row == 0 && attempt->rows == ATTEMPT_MAY_LEAD) {
        u->lead = m->attempt;
        u->part = attempt->part;
        u->out_ms = attempt->out_ms;
        desk_keep_unit(c, job, m->unit);
    }
    if (u->lead != m->attempt && attempt->rows == ATTEMPT_MAY_LEAD)
        attempt->rows = ATTEMPT_DROPPED;
}

/* Do the rows count?  Only rows of the leading attempt, while the unit is not
 * done.  If no worker has the unit, this attempt was thought lost: its rows
 * count if they go on where the last ended. */
static bool
counts(const struct job *job, uint32_t index, const struct msg_result *m)
{
    const struct job_unit *u = &job->units[m->unit];

    return u->state != UNIT_DONE && part_is_here(&job->parts[index]) &&
           u->lead != 0 && u->lead == m->attempt &&
           m->row + m->rows > u->stored_rows &&
           (attempt_find(job, m->unit, index, m->attempt) ||
            (u->nattempts == 0 && u->part == index && m->row <= u->next_row));
}

/* All rows of the attempt are here: release its worker, and those of its twins,
 * before the rows are on the disk. */
static void
delivered(struct coord *c, struct job *job, struct job_attempt *attempt)
{
    struct job_unit *u = &job->units[attempt->unit];

    speed_finished(job, attempt);
    holding_step(c, job, attempt, ATTEMPT_DELIVERED);
    for (uint8_t i = u->nattempts; i-- > 0;)
        if (u->attempts[i].state != ATTEMPT_DELIVERED) {
            desk_send_attempt(c, job, MSG_REVOKE, &u->attempts[i]);
            holding_end(c, job, &u->attempts[i]);
        }
}

/* Are these rows that the worker kept from an earlier life of the coordinator?
 * It sends those before it is ready. */
static bool
is_old(const struct job *job, uint32_t index, const struct msg_result *m)
{
    return m->attempt < unit_first_attempt(job) ||
           job->parts[index].state != PART_READY;
}

/* If the last row came of an attempt that does not count, note that. */
static void
note_spent(struct job *job, uint32_t index, const struct msg_result *m)
{
    struct job_attempt *attempt = attempt_find(job, m->unit, index, m->attempt);

    if (m->last && attempt && attempt->rows == ATTEMPT_DROPPED &&
        m->attempt != job->units[m->unit].lead)
        attempt->rows = ATTEMPT_SPENT;
}

/* Has the worker given the lines below these rows away, and was its GAVE lost
 * with a connection?  A unit with twins gives no lines away. */
static bool
gave_before(const struct job *job, uint32_t index, const struct msg_result *m,
            const struct partition_area *a)
{
    return m->last && m->row + m->rows < a->height &&
           job->parts[index].state == PART_LOADING &&
           job->units[m->unit].nattempts == 1;
}

/* Drop rows that do not count, but compare them with those that do. */
static void
refuse_rows(struct coord *c, const struct coord_worker *w, struct job *job,
            uint32_t index, const struct msg_result *m,
            const struct partition_area *a)
{
    if (result_fits(job, m, a))
        duplicate_check(c, job, index, m);
    note_spent(job, index, m);
    ack(c, w, job, m);
}

/* Rows came while earlier rows of the attempt are missing. */
static void
out_of_turn(struct coord *c, const struct coord_worker *w,
            const struct job *job, uint32_t index, const struct msg_result *m)
{
    if (is_old(job, index, m))
        ack(c, w, job, m); /* an earlier life of the coordinator lost them */
    else
        verdict_break(c, w->conn, "a RESULT out of turn");
}

/* Have rows that count written to the disk. */
static void
keep_rows(struct coord *c, const struct coord_worker *w, struct job *job,
          uint32_t index, const struct msg_result *m, struct partition_area *a)
{
    struct job_unit *u = &job->units[m->unit];
    struct job_attempt *attempt;

    if (u->nattempts == 0 && !holding_revive(c, job, index, m->unit))
        return;
    attempt = attempt_find(job, m->unit, index, m->attempt);
    if (gave_before(job, index, m, a) &&
        holding_shrink(c, job, attempt, m->row + m->rows))
        partition_area(job->partition, m->unit, a);
    if (m->last &&
        (m->row + m->rows < a->height || !handoff_complete(job, m->unit))) {
        ack(c, w, job, m);
        drop_incomplete(c, job, attempt);
        return;
    }
    duplicate_keep(job, index, m, a->height);
    u = &job->units[m->unit]; /* holding_shrink() may have added a unit */
    u->next_row += m->rows;
    u->row_ms = c->now_ms;
    if (m->last) {
        u->counts = m->counts;
        msg_counts_add(&u->counts, &u->lent);
        delivered(c, job, attempt);
    }
    put_rows(c, job, index, m, a);
}

static void
take_result(struct coord *c, struct coord_worker *w, struct job *job,
            uint32_t index, const struct msg_result *m)
{
    struct partition_area a;
    struct job_unit *u;
    struct job_attempt *attempt;

    if (!job->partition) { /* an earlier life kept nothing of the job */
        ack(c, w, job, m);
        return;
    }
    if (m->unit >= job->nunits) {
        if (is_old(job, index, m))
            ack(c, w, job, m);
        else
            verdict_break(c, w->conn, "a RESULT of no unit");
        return;
    }
    partition_area(job->partition, m->unit, &a);
    u = &job->units[m->unit];
    attempt = attempt_find(job, m->unit, index, m->attempt);
    if (attempt && u->state != UNIT_DONE && part_is_here(&job->parts[index]))
        choose_lead(c, job, attempt, m);
    if (!counts(job, index, m))
        refuse_rows(c, w, job, index, m, &a);
    else if (!result_fits(job, m, &a))
        verdict_break(c, w->conn, "a RESULT that fits no unit");
    else if (m->row > u->next_row)
        out_of_turn(c, w, job, index, m);
    else if (m->row == u->next_row) /* earlier rows are with the store already
                                     */
        keep_rows(c, w, job, index, m, &a);
}

void
result_rows(struct coord *c, struct coord_worker *w, const struct msg *msg)
{
    const struct msg_result *m = &msg->result;
    uint32_t index;
    struct job *job = desk_job_of(c, w, m->job, &index);

    if (job)
        take_result(c, w, job, index, m);
}

/* --- rows on the disk --- */

void
result_frame_done(struct coord *c, struct job *job, uint32_t frame)
{
    struct action *a =
        actions_add_job(&c->actions, ACT_WRITE_PICTURE, 0, job->id);

    frame_step(&job->frames[frame], FRAME_WRITING);
    if (!a)
        return;
    a->sequence = job->sequence;
    a->frame = frame;
}

/* End all attempts at a unit whose rows are all on the disk. */
static void
release_all(struct coord *c, struct job *job, uint32_t unit)
{
    struct job_unit *u = &job->units[unit];

    while (u->nattempts > 0) {
        struct job_attempt *attempt = &u->attempts[u->nattempts - 1];

        if (attempt->number == u->lead) {
            speed_took(job, c->now_ms - attempt->out_ms);
            speed_finished(job, attempt);
        } else {
            desk_send_attempt(c, job, MSG_REVOKE, attempt);
        }
        holding_end(c, job, attempt);
    }
}

static void
finish_unit(struct coord *c, struct job *job, uint32_t unit)
{
    struct job_unit *u = &job->units[unit];
    struct partition_area a;

    partition_area(job->partition, unit, &a);
    actions_log(&c->actions, ACT_DEBUG, "unit done job=%s unit=%u worker=%s",
                job->hex, unit, job->parts[u->part].name);
    if (u->nattempts > 0)
        release_all(c, job, unit);
    else
        unit_take(job, unit); /* its worker was lost just before */
    unit_done(job, unit, c->now_ms);
    progress_see(job);
    if (job->shared)
        handoff_done(job, unit);
    if (job->frames[a.frame].pixels_left > 0)
        return;
    if (job->shared)
        shared_drop_frame(job->shared, a.frame);
    result_frame_done(c, job, a.frame);
    passes_frame_done(c, job);
}

/* The worker may have another connection by now: then it has sent the rows
 * there, too, and forgets them as well. */
void
result_stored(struct coord *c, const struct action_rows *key)
{
    struct job *job = desk_same_job(c, key->job, key->sequence);
    const struct coord_worker *w;
    struct job_unit *u;
    uint64_t pixels = (uint64_t)key->rows * key->width;

    if (!job || job_over(job))
        return;
    w = job->parts[key->part].worker;
    u = &job->units[key->unit];
    if (w->conn != 0)
        desk_send_ack(c, w->conn,
                      &(struct msg_ack){ job->id, key->unit, key->attempt,
                                         key->row, key->rows });
    if (u->state == UNIT_DONE || u->lead != key->attempt ||
        u->stored_rows != key->row)
        return;
    u->stored_rows += key->rows;
    job->pixels_done += pixels;
    job->frames[key->frame].rows_pixels += pixels;
    if (key->last)
        finish_unit(c, job, key->unit);
}
