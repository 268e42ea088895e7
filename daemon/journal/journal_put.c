/* journal_put.c - put jobs, their units, frames and ends into the database */
#include "config.h"

#include "journal/journal_impl.h"

#include "proto/codec.h"
#include "proto/frame.h"

static sqlite3_stmt *
writer_of(struct journal *j, enum journal_sql what, const uint8_t job[MSG_JOB],
          struct rad_error *err)
{
    sqlite3_stmt *s = journal_writer(j, what, err);

    if (s)
        sqlite3_bind_blob(s, 1, job, MSG_JOB, SQLITE_STATIC);
    return s;
}

static void
bind_u64(sqlite3_stmt *s, int i, uint64_t v)
{
    sqlite3_bind_int64(s, i, (sqlite3_int64)v);
}

static void
bind_text(sqlite3_stmt *s, int i, const char *text)
{
    sqlite3_bind_text(s, i, text, -1, SQLITE_STATIC);
}

/* Run a statement that must change a row; RAD_EDATA: it changed none. */
static int
change(struct journal *j, sqlite3_stmt *s, struct rad_error *err)
{
    int rc = journal_run(j, s, err);

    if (rc == 0 && sqlite3_changes(j->db) == 0)
        rc = rad_fail(err, RAD_EDATA, "database: no such job or unit");
    return rc;
}

/* Pack a message into j->out; its payload lies behind the header. */
static int
pack(struct journal *j, const struct msg *m, struct rad_error *err)
{
    j->out.len = 0;
    j->out.bad = false;
    if (msg_pack_as(JOURNAL_LAYOUT, &j->out, m) != 0)
        return rad_fail_memory(err);
    return 0;
}

static void
bind_payload(const struct journal *j, sqlite3_stmt *s, int i)
{
    sqlite3_bind_blob(s, i, j->out.buf + MSG_HEADER,
                      (int)(j->out.len - MSG_HEADER), SQLITE_STATIC);
}

int
journal_put_job(struct journal *j, const struct saved_job *saved,
                struct rad_error *err)
{
    struct msg m = { .type = MSG_SUBMIT, .submit = saved->spec };
    sqlite3_stmt *s = writer_of(j, SQL_PUT_JOB, saved->spec.job, err);

    if (!s || pack(j, &m, err) < 0)
        return err->code;
    bind_text(s, 2, saved->owner);
    bind_payload(j, s, 3);
    sqlite3_bind_int(s, 4, saved->state);
    bind_u64(s, 5, saved->offer_ms);
    bind_u64(s, 6, saved->submit_ms);
    bind_u64(s, 7, saved->open_ms);
    bind_u64(s, 8, saved->sent_bytes);
    return journal_run(j, s, err);
}

int
journal_put_state(struct journal *j, const uint8_t job[MSG_JOB], int state,
                  int32_t priority, struct rad_error *err)
{
    sqlite3_stmt *s = writer_of(j, SQL_PUT_STATE, job, err);

    if (!s)
        return err->code;
    sqlite3_bind_int(s, 2, state);
    sqlite3_bind_int(s, 3, priority);
    return journal_run(j, s, err);
}

int
journal_put_drained(struct journal *j, const char *worker, bool drained,
                    struct rad_error *err)
{
    sqlite3_stmt *s = journal_writer(
        j, drained ? SQL_PUT_DRAINED : SQL_DROP_DRAINED, err);

    if (!s)
        return err->code;
    bind_text(s, 1, worker);
    return journal_run(j, s, err);
}

static int
drop(struct journal *j, enum journal_sql what, const uint8_t job[MSG_JOB],
     struct rad_error *err)
{
    sqlite3_stmt *s = writer_of(j, what, job, err);

    return s ? journal_run(j, s, err) : err->code;
}

/* Bind a mark to parameters i and i + 1, which stay NULL if it is not known. */
static void
bind_mark(sqlite3_stmt *s, int i, const struct mark *m)
{
    if (!m->known)
        return;
    bind_u64(s, i, m->size);
    sqlite3_bind_blob(s, i + 1, m->hash, RAD_SHA_BYTES, SQLITE_STATIC);
}

int
journal_put_end(struct journal *j, const struct saved_job *saved,
                struct rad_error *err)
{
    struct msg m = { .type = MSG_PROGRESS, .progress = saved->last };
    sqlite3_stmt *s = writer_of(j, SQL_PUT_END, saved->spec.job, err);
    int rc;

    if (!s || pack(j, &m, err) < 0)
        return err->code;
    sqlite3_bind_int(s, 2, saved->state);
    sqlite3_bind_int(s, 3, saved->status);
    bind_text(s, 4, saved->text);
    bind_u64(s, 5, saved->end_ms);
    bind_u64(s, 6, saved->kept_bytes);
    bind_payload(j, s, 7);
    bind_mark(s, 8, &saved->stats);
    rc = journal_run(j, s, err);
    return rc == 0 ? drop(j, SQL_DROP_UNITS, saved->spec.job, err) : rc;
}

int
journal_put_unit(struct journal *j, const uint8_t job[MSG_JOB],
                 const struct saved_unit *u, struct rad_error *err)
{
    sqlite3_stmt *s = writer_of(j, SQL_PUT_UNIT, job, err);

    if (!s)
        return err->code;
    bind_u64(s, 2, u->unit);
    bind_u64(s, 3, u->area.frame);
    bind_u64(s, 4, u->area.x);
    bind_u64(s, 5, u->area.y);
    bind_u64(s, 6, u->area.width);
    bind_u64(s, 7, u->area.height);
    bind_u64(s, 8, u->attempt);
    bind_u64(s, 9, u->tries);
    bind_text(s, 10, u->worker);
    bind_u64(s, 11, u->fingerprint);
    return journal_run(j, s, err);
}

static void
bind_counts(struct journal *j, sqlite3_stmt *s, int i,
            const struct msg_counts *counts)
{
    j->out.len = 0;
    j->out.bad = false;
    msg_put_counts(&j->out, counts);
    if (!j->out.bad)
        sqlite3_bind_blob(s, i, j->out.buf, (int)j->out.len, SQLITE_STATIC);
}

int
journal_put_rows(struct journal *j, const uint8_t job[MSG_JOB],
                 const struct saved_unit *u, struct rad_error *err)
{
    sqlite3_stmt *s = writer_of(j, SQL_PUT_ROWS, job, err);

    if (!s)
        return err->code;
    bind_u64(s, 2, u->unit);
    bind_u64(s, 3, u->attempt);
    bind_u64(s, 4, u->stored);
    sqlite3_bind_int(s, 5, u->done);
    bind_u64(s, 6, u->end_ms);
    if (u->done)
        bind_counts(j, s, 7, &u->counts);
    if (j->out.bad)
        return rad_fail_memory(err);
    if (u->nbottom > 0)
        sqlite3_bind_blob(s, 8, u->bottom, (int)u->nbottom, SQLITE_STATIC);
    bind_u64(s, 9, u->sum);
    bind_u64(s, 10, u->now);
    return change(j, s, err);
}

int
journal_put_frame(struct journal *j, const uint8_t job[MSG_JOB], uint32_t frame,
                  const struct saved_frame *f, struct rad_error *err)
{
    sqlite3_stmt *s = writer_of(j, SQL_PUT_FRAME, job, err);

    if (!s)
        return err->code;
    bind_u64(s, 2, frame);
    bind_mark(s, 3, &f->picture);
    bind_mark(s, 5, &f->depth);
    return journal_run(j, s, err);
}

int
journal_put_fetched(struct journal *j, const uint8_t job[MSG_JOB],
                    uint32_t frame, struct rad_error *err)
{
    sqlite3_stmt *s = writer_of(j, SQL_PUT_FETCHED, job, err);

    if (!s)
        return err->code;
    bind_u64(s, 2, frame);
    return journal_run(j, s, err);
}

static int
put_gone(struct journal *j, const struct saved_gone *g, struct rad_error *err)
{
    sqlite3_stmt *s = writer_of(j, SQL_PUT_GONE, g->job, err);
    int rc;

    if (!s)
        return err->code;
    bind_text(s, 2, g->owner);
    bind_text(s, 3, g->name);
    sqlite3_bind_int(s, 4, (int)g->why);
    sqlite3_bind_int(s, 5, g->fetched);
    bind_u64(s, 6, g->end_ms);
    bind_u64(s, 7, g->gone_ms);
    rc = journal_run(j, s, err);
    s = rc == 0 ? journal_writer(j, SQL_DROP_GONES, err) : NULL;
    if (!s)
        return err->code;
    bind_text(s, 1, g->owner);
    sqlite3_bind_int(s, 2, SAVED_GONES);
    return journal_run(j, s, err);
}

int
journal_forget(struct journal *j, const struct saved_gone *g,
               struct rad_error *err)
{
    int rc = drop(j, SQL_DROP_UNITS, g->job, err);

    if (rc == 0)
        rc = drop(j, SQL_DROP_FRAMES, g->job, err);
    if (rc == 0)
        rc = drop(j, SQL_DROP_JOB, g->job, err);
    return rc == 0 ? put_gone(j, g, err) : rc;
}
