/* store_rows.c - rows of a job's units, and the pictures made of them
 *
 * Rows are written to the job's folder before they are noted, so the journal
 * never lists rows that are not there.  The same holds for a picture: first its
 * file, then the note; when the note is on the disk the frame's rows are
 * removed. */
#include "config.h"

#include "store/store_impl.h"

#include "ground/memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Bytes that each piece of rows and each picture adds to the backlog, beside
 * the rows' own: with small frames the disk is busy with files rather than with
 * bytes, and every request waits behind the tasks in the queue. */
#define ROWS_WEIGHT    (128u << 10)
#define PICTURE_WEIGHT (1u << 20)

/* --- units and rows --- */

struct unit_task {
    struct task task;
    uint8_t id[MSG_JOB];
    struct saved_unit unit;
    char worker[MSG_MAX_NAME + 1];
};

static int
unit_run(struct task *t)
{
    struct unit_task *u = (struct unit_task *)t;

    return journal_put_unit(store_of(t)->journal, u->id, &u->unit, &t->err);
}

void
store_keep_unit(struct store *s, const uint8_t job[MSG_JOB],
                const struct saved_unit *unit)
{
    struct unit_task *u =
        s->journal ? store_new_task(s, sizeof *u, unit_run, store_free_task)
                   : NULL;

    if (!u)
        return;
    memcpy(u->id, job, MSG_JOB);
    u->unit = *unit;
    snprintf(u->worker, sizeof u->worker, "%s", unit->worker);
    u->unit.worker = u->worker;
    store_push_lasting(s, &u->task);
}

struct rows_task {
    struct task task;
    struct action_rows key;
    struct msg_counts counts;
    struct folder_pixels pixels; /* owned */
    uint8_t *bottom;
};

static int
note_rows(struct rows_task *r, uint64_t sum)
{
    const struct action_rows *k = &r->key;
    struct saved_unit u = { .unit = k->unit,
                            .attempt = k->attempt,
                            .stored = k->row + k->rows,
                            .now = k->rows,
                            .sum = sum,
                            .done = k->last,
                            .end_ms = k->date_ms,
                            .counts = r->counts,
                            .bottom = r->bottom,
                            .nbottom = k->nbottom };

    return journal_put_rows(store_of(&r->task)->journal, k->job, &u,
                            &r->task.err);
}

static int
rows_run(struct task *t)
{
    struct rows_task *r = (struct rows_task *)t;
    struct store *s = store_of(t);
    bool noted = s->journal;
    uint64_t sum = 0;
    int rc = folder_put_rows(&s->folder, &r->key, &r->pixels,
                             noted ? &sum : NULL, &t->err);

    return rc == 0 && noted ? note_rows(r, sum) : rc;
}

static void
free_rows(struct rows_task *r)
{
    free(r->pixels.bytes);
    free(r->pixels.line);
    free(r->bottom);
    free(r);
}

static void
rows_done(struct task *t)
{
    struct rows_task *r = (struct rows_task *)t;
    struct store *s = store_of(t);

    s->backlog -= r->pixels.n + ROWS_WEIGHT;
    if (!is_mute(s, t))
        s->handler->rows(s->arg, &r->key, status_of(t), failure(t));
    free_rows(r);
}

/* Copy the base line that comes with the rows, if there is a journal: only
 * another life of the coordinator reads the line. */
static void
copy_line(struct rows_task *r, const uint8_t *line)
{
    size_t n = 3 * (size_t)r->key.width;

    if (!line || !store_of(&r->task)->journal)
        return;
    r->pixels.line = memory_need(n * sizeof *r->pixels.line);
    wire_floats_get(r->pixels.line, line, n);
}

/* Copy the pixels, densities and base line, which belong to the action. */
static void
copy_rows(struct rows_task *r, const struct action_rows *rows)
{
    size_t n = (size_t)rows->rows * rows->width * rows->channels;

    r->key = *rows;
    r->key.pixels = NULL;
    r->key.counts = NULL;
    r->key.bottom = NULL;
    r->key.line = NULL;
    if (rows->counts)
        r->counts = *rows->counts;
    r->pixels.n = rows->channels == 1 ? rows->len : n * sizeof(float);
    r->pixels.bytes = memory_need(r->pixels.n + 1);
    r->bottom = memory_need(rows->nbottom + 1);
    copy_line(r, rows->line);
    if (rows->channels == 1)
        memcpy(r->pixels.bytes, rows->pixels, r->pixels.n);
    else
        wire_floats_get(r->pixels.bytes, rows->pixels, n);
    if (rows->nbottom > 0)
        memcpy(r->bottom, rows->bottom, rows->nbottom);
}

void
store_put_rows(struct store *s, const struct action_rows *rows)
{
    struct rows_task *r = store_new_task(s, sizeof *r, rows_run, rows_done);

    copy_rows(r, rows);
    s->backlog += r->pixels.n + ROWS_WEIGHT;
    r->task.awaited = rows->awaited;
    store_push_lasting(s, &r->task);
}

/* --- pictures --- */

static int
picture_run(struct task *t)
{
    struct job_task *p = (struct job_task *)t;
    struct store *s = store_of(t);
    struct saved_frame f = { .written = true };
    int rc = folder_picture(&s->folder, p->id, p->frame, s->journal ? &f : NULL,
                            &t->err);

    if (rc == 0 && s->journal)
        rc = journal_put_frame(s->journal, p->id, p->frame, &f, &t->err);
    return rc;
}

static int
rows_gone_run(struct task *t)
{
    struct job_task *p = (struct job_task *)t;

    folder_drop_rows(&store_of(t)->folder, p->id, p->frame);
    return 0;
}

static void
picture_done(struct task *t)
{
    struct job_task *p = (struct job_task *)t, *gone;
    struct store *s = store_of(t);

    s->backlog -= PICTURE_WEIGHT;
    if (t->code == 0) {
        gone = store_new_job_task(s, p->id, rows_gone_run, store_free_task);
        gone->frame = p->frame;
        task_push(&s->queue, &gone->task);
    }
    if (!is_mute(s, t))
        s->handler->picture(s->arg, p->id, p->sequence, p->frame, status_of(t),
                            failure(t));
    free(p);
}

void
store_write_picture(struct store *s, const uint8_t job[MSG_JOB],
                    uint64_t sequence, uint32_t frame)
{
    struct job_task *p = store_new_job_task(s, job, picture_run, picture_done);

    p->sequence = sequence;
    p->frame = frame;
    s->backlog += PICTURE_WEIGHT;
    p->task.awaited = true;
    store_push_lasting(s, &p->task);
}
