/* journal_read.c - read the database
 *
 * Each value is checked as if a stranger had sent it: a failing disk, or
 * somebody with an editor, may have changed it. */
#include "config.h"

#include "journal/journal_impl.h"

#include "proto/codec.h"
#include "jobs/job.h"

#include "base/list.h"

#include <stdlib.h>
#include <string.h>

static int
has_row(struct journal *j, enum journal_sql what, const uint8_t job[MSG_JOB],
        bool *has, struct rad_error *err)
{
    sqlite3_stmt *s = journal_statement(j, what, err);
    int rc;

    if (!s)
        return err->code;
    sqlite3_bind_blob(s, 1, job, MSG_JOB, SQLITE_STATIC);
    rc = sqlite3_step(s);
    *has = rc == SQLITE_ROW;
    sqlite3_reset(s);
    return rc == SQLITE_ROW || rc == SQLITE_DONE ? 0
                                                 : journal_failed(j, rc, err);
}

int
journal_has(struct journal *j, const uint8_t job[MSG_JOB], bool *has,
            struct rad_error *err)
{
    return has_row(j, SQL_HAS, job, has, err);
}

int
journal_has_gone(struct journal *j, const uint8_t job[MSG_JOB], bool *gone,
                 struct rad_error *err)
{
    return has_row(j, SQL_HAS_GONE, job, gone, err);
}

/* Say that `what` of job number n is damaged; returns RAD_EDATA. */
static int
bad(struct rad_error *err, const char *what, sqlite3_int64 n)
{
    return rad_fail(err, RAD_EDATA, "database: %s of job %lld cannot be", what,
                    (long long)n);
}

static bool
get_u32(sqlite3_stmt *s, int i, uint32_t *v)
{
    sqlite3_int64 n = sqlite3_column_int64(s, i);

    *v = (uint32_t)n;
    return sqlite3_column_type(s, i) == SQLITE_INTEGER && n >= 0 &&
           n <= UINT32_MAX;
}

static bool
get_u64(sqlite3_stmt *s, int i, uint64_t *v)
{
    *v = (uint64_t)sqlite3_column_int64(s, i);
    return sqlite3_column_type(s, i) == SQLITE_INTEGER;
}

/* Get column i, a text of at most max bytes without a NUL in it; *text is valid
 * until the next row. */
static bool
get_text(sqlite3_stmt *s, int i, size_t max, const char **text)
{
    *text = sqlite3_column_type(s, i) == SQLITE_TEXT
                ? (const char *)sqlite3_column_text(s, i)
                : NULL;
    return *text && (size_t)sqlite3_column_bytes(s, i) <= max &&
           strlen(*text) == (size_t)sqlite3_column_bytes(s, i);
}

/* Get column i, a blob or NULL; of NULL *n is 0.  *v is never NULL, to which
 * not even 0 may be added. */
static bool
get_blob(sqlite3_stmt *s, int i, const uint8_t **v, size_t *n)
{
    static const uint8_t none[1];
    int type = sqlite3_column_type(s, i);
    const uint8_t *bytes = sqlite3_column_blob(s, i);

    *v = bytes ? bytes : none;
    *n = (size_t)sqlite3_column_bytes(s, i);
    return type == SQLITE_BLOB || type == SQLITE_NULL;
}

/* A job that is being read. */
struct reading {
    struct journal *j;
    sqlite3_int64 n; /* the job's number in the table of jobs */
    struct saved_job saved;
    struct msg spec, progress;
    struct saved_frame *frames;
    struct saved_unit *units;
    struct rad_arena mem; /* texts and blobs of units */
    struct rad_error *err;
};

static bool
get_counts(struct msg_counts *c, const uint8_t *v, size_t n)
{
    struct wire_in in;

    wire_in_init(&in, v, n);
    in.version = JOURNAL_LAYOUT;
    msg_get_counts(&in, c);
    return !in.bad && wire_left(&in) == 0;
}

static bool
is_unit(const struct reading *r, const struct saved_unit *u)
{
    const struct msg_spec *spec = &r->saved.spec;
    uint32_t before = r->saved.nunits;

    return u->area.frame < spec->nframes && u->area.width > 0 &&
           u->area.height > 0 && u->unit < PARTITION_MAX_LINES &&
           (before == 0 || u->unit > r->units[before - 1].unit) &&
           u->area.width <= MSG_MAX_SIDE && u->area.height <= MSG_MAX_SIDE;
}

/* Get a unit from a row of SQL_UNITS; false: the row is damaged. */
static bool
get_unit(const struct reading *r, sqlite3_stmt *s, struct saved_unit *u)
{
    const uint8_t *counts, *bottom;
    size_t ncounts, nbottom;
    uint32_t done;
    bool ok = get_u32(s, 0, &u->unit) && get_u32(s, 1, &u->area.frame) &&
              get_u32(s, 2, &u->area.x) && get_u32(s, 3, &u->area.y) &&
              get_u32(s, 4, &u->area.width) && get_u32(s, 5, &u->area.height) &&
              get_u32(s, 6, &u->attempt) && get_u32(s, 7, &u->tries) &&
              get_text(s, 8, MSG_MAX_NAME, &u->worker) &&
              get_u64(s, 9, &u->fingerprint) && get_u32(s, 10, &u->stored) &&
              get_u32(s, 11, &done) && get_u64(s, 12, &u->end_ms) &&
              get_blob(s, 13, &counts, &ncounts) &&
              get_blob(s, 14, &bottom, &nbottom) && get_u64(s, 15, &u->sum);

    if (!ok || done > 1 || nbottom > MSG_MAX_SIDE || !is_unit(r, u))
        return false;
    u->done = done;
    u->nbottom = (uint32_t)nbottom;
    u->bottom = bottom;
    return !done || get_counts(&u->counts, counts, ncounts);
}

/* Copy the texts and blobs of u, which are valid until the next row, into
 * r->mem. */
static int
copy_unit(struct reading *r, struct saved_unit *u)
{
    u->worker = rad_arena_strndup(&r->mem, u->worker, strlen(u->worker));
    if (u->nbottom > 0)
        u->bottom = rad_arena_dup(&r->mem, u->bottom, u->nbottom);
    return u->worker && u->bottom ? 0 : rad_fail_memory(r->err);
}

static int
add_unit(struct reading *r, sqlite3_stmt *s)
{
    struct saved_unit *u;

    if (!rad_list_grow(&r->units, r->saved.nunits, sizeof *u))
        return rad_fail_memory(r->err);
    u = &r->units[r->saved.nunits];
    memset(u, 0, sizeof *u);
    if (!get_unit(r, s, u))
        return bad(r->err, "a unit", r->n);
    r->saved.nunits++;
    return copy_unit(r, u);
}

/* Get a mark from columns i and i + 1, both NULL if it is not known; false:
 * they are damaged. */
static bool
get_mark(sqlite3_stmt *s, int i, struct mark *m)
{
    const uint8_t *hash;
    size_t n;

    *m = (struct mark){ 0 };
    if (sqlite3_column_type(s, i) == SQLITE_NULL)
        return sqlite3_column_type(s, i + 1) == SQLITE_NULL;
    if (!get_u64(s, i, &m->size) || !get_blob(s, i + 1, &hash, &n) ||
        n != RAD_SHA_BYTES)
        return false;
    m->known = true;
    memcpy(m->hash, hash, n);
    return true;
}

int
journal_find_mark(struct journal *j, const uint8_t job[MSG_JOB], uint32_t frame,
                  enum msg_what what, struct mark *m, struct rad_error *err)
{
    bool stats = what == MSG_WHAT_STATS;
    sqlite3_stmt *s =
        journal_statement(j, stats ? SQL_STATS_MARK : SQL_MARKS, err);
    int rc, step;

    *m = (struct mark){ 0 };
    if (!s)
        return err->code;
    sqlite3_bind_blob(s, 1, job, MSG_JOB, SQLITE_STATIC);
    if (!stats)
        sqlite3_bind_int64(s, 2, frame);
    step = sqlite3_step(s);
    if (step == SQLITE_DONE)
        rc = 0;
    else if (step != SQLITE_ROW)
        rc = journal_failed(j, step, err);
    else if (get_mark(s, what == MSG_WHAT_DEPTH ? 2 : 0, m))
        rc = 0;
    else
        rc = rad_fail(err, RAD_EDATA, "database: the mark of a file cannot be");
    sqlite3_reset(s);
    return rc;
}

static int
add_frame(struct reading *r, sqlite3_stmt *s)
{
    struct saved_frame *f;
    uint32_t frame, fetched;

    if (!get_u32(s, 0, &frame) || frame >= r->saved.spec.nframes)
        return bad(r->err, "a frame", r->n);
    f = &r->frames[frame];
    if (!get_mark(s, 1, &f->picture) || !get_mark(s, 3, &f->depth) ||
        !get_u32(s, 5, &fetched) || fetched > 1)
        return bad(r->err, "a frame", r->n);
    f->written = true;
    f->fetched = fetched;
    return 0;
}

/* Step to the next row of s.  False, and s is reset: there are no more, *rc was
 * not 0, or the step failed and *rc says why. */
static bool
next_row(struct journal *j, sqlite3_stmt *s, int *rc, struct rad_error *err)
{
    int step = *rc == 0 ? sqlite3_step(s) : SQLITE_DONE;

    if (step == SQLITE_ROW)
        return true;
    if (step != SQLITE_DONE)
        *rc = journal_failed(j, step, err);
    sqlite3_reset(s);
    return false;
}

/* Call add with each row of a statement whose first parameter is r->n. */
static int
each(struct reading *r, enum journal_sql what,
     int (*add)(struct reading *r, sqlite3_stmt *s))
{
    sqlite3_stmt *s = journal_statement(r->j, what, r->err);
    int rc = 0;

    if (!s)
        return r->err->code;
    sqlite3_bind_int64(s, 1, r->n);
    while (next_row(r->j, s, &rc, r->err))
        rc = add(r, s);
    return rc;
}

static int
add_lives(struct reading *r, sqlite3_stmt *s)
{
    return get_u32(s, 0, &r->saved.lives) ? 0 : bad(r->err, "the life", r->n);
}

static int
get_lives(struct reading *r, sqlite3_int64 epoch)
{
    sqlite3_int64 n = r->n;
    int rc;

    r->n = epoch;
    rc = each(r, SQL_LIVES, add_lives);
    r->n = n;
    return rc;
}

/* Get the job's specification from its SUBMIT, and check its id. */
static int
get_spec(struct reading *r, sqlite3_stmt *s)
{
    const uint8_t *id, *spec;
    size_t nid, nspec;
    int rc;

    if (!get_blob(s, 1, &id, &nid) || nid != MSG_JOB ||
        !get_blob(s, 3, &spec, &nspec))
        return bad(r->err, "the id", r->n);
    rc = msg_unpack_as(JOURNAL_LAYOUT, &r->spec, MSG_SUBMIT, 0, spec, nspec,
                       NULL);
    if (rc < 0)
        return rc == RAD_ENOMEM ? rad_fail_memory(r->err)
                                : bad(r->err, "the specification", r->n);
    r->saved.spec = r->spec.submit;
    if (memcmp(r->saved.spec.job, id, MSG_JOB) != 0)
        return bad(r->err, "the id", r->n);
    r->frames = calloc(r->saved.spec.nframes, sizeof *r->frames);
    return r->frames ? 0 : rad_fail_memory(r->err);
}

/* Get the priority, if it was changed; else that of the SUBMIT stays. */
static int
get_priority(struct reading *r, sqlite3_stmt *s)
{
    sqlite3_int64 n = sqlite3_column_int64(s, 17);

    if (sqlite3_column_type(s, 17) == SQLITE_NULL)
        return 0;
    if (sqlite3_column_type(s, 17) != SQLITE_INTEGER || n < INT32_MIN ||
        n > INT32_MAX)
        return bad(r->err, "the priority", r->n);
    r->saved.spec.priority = (int32_t)n;
    return 0;
}

/* Get the last progress of a job that is over. */
static int
get_progress(struct reading *r, sqlite3_stmt *s)
{
    const uint8_t *v;
    size_t n;

    if (r->saved.state < JOB_DONE)
        return 0;
    if (!get_blob(s, 14, &v, &n))
        return bad(r->err, "the end", r->n);
    if (msg_unpack_as(JOURNAL_LAYOUT, &r->progress, MSG_PROGRESS, 0, v, n,
                      NULL) < 0)
        return bad(r->err, "the end", r->n);
    r->saved.last = r->progress.progress;
    return 0;
}

static int
get_job(struct reading *r, sqlite3_stmt *s)
{
    struct saved_job *o = &r->saved;
    uint32_t state, status;
    uint64_t epoch;
    int rc;

    if (!get_text(s, 2, MSG_MAX_NAME, &o->owner) || !get_u64(s, 4, &epoch) ||
        !get_u32(s, 5, &state) || state > JOB_CANCELLED ||
        !get_u32(s, 6, &status) || !get_text(s, 7, MSG_MAX_TEXT, &o->text) ||
        !get_u64(s, 8, &o->offer_ms) || !get_u64(s, 9, &o->submit_ms) ||
        !get_u64(s, 10, &o->open_ms) || !get_u64(s, 11, &o->end_ms) ||
        !get_u64(s, 12, &o->sent_bytes) || !get_u64(s, 13, &o->kept_bytes) ||
        !get_mark(s, 15, &o->stats))
        return bad(r->err, "the state", r->n);
    o->state = (uint8_t)state;
    o->status = (int)status;
    rc = get_spec(r, s);
    if (rc == 0)
        rc = get_priority(r, s);
    if (rc == 0)
        rc = get_progress(r, s);
    if (rc == 0)
        rc = get_lives(r, (sqlite3_int64)epoch);
    if (rc == 0)
        rc = each(r, SQL_FRAMES, add_frame);
    if (rc == 0)
        rc = each(r, SQL_UNITS, add_unit);
    o->frames = r->frames;
    o->units = r->units;
    return rc;
}

static int
read_job(struct journal *j, sqlite3_stmt *s, journal_job_fn *fn, void *arg,
         struct rad_error *err)
{
    struct reading r = { .j = j, .err = err };
    int rc;

    r.n = sqlite3_column_int64(s, 0);
    rad_arena_init(&r.mem);
    rc = get_job(&r, s);
    if (rc == 0)
        rc = fn(arg, &r.saved, err);
    msg_release(&r.spec);
    msg_release(&r.progress);
    rad_arena_release(&r.mem);
    free(r.frames);
    free(r.units);
    return rc;
}

int
journal_read(struct journal *j, journal_job_fn *fn, void *arg,
             struct rad_error *err)
{
    sqlite3_stmt *s = journal_statement(j, SQL_JOBS, err);
    int rc = 0;

    if (!s)
        return err->code;
    while (next_row(j, s, &rc, err))
        rc = read_job(j, s, fn, arg, err);
    return rc;
}

int
journal_read_drained(struct journal *j, journal_worker_fn *fn, void *arg,
                     struct rad_error *err)
{
    sqlite3_stmt *s = journal_statement(j, SQL_DRAINED, err);
    const char *name;
    int rc = 0;

    if (!s)
        return err->code;
    while (next_row(j, s, &rc, err))
        if (get_text(s, 0, MSG_MAX_NAME, &name))
            rc = fn(arg, name, err);
        else
            rc = rad_fail(err, RAD_EDATA,
                          "database: the name of a drained worker cannot be");
    return rc;
}

/* Get a forgotten job from a row of SQL_GONES; false: the row is damaged. */
static bool
get_gone(sqlite3_stmt *s, struct saved_gone *g)
{
    const char *owner, *name;
    const uint8_t *id;
    uint32_t why, fetched;
    size_t n;

    *g = (struct saved_gone){ 0 };
    if (!get_blob(s, 0, &id, &n) || n != MSG_JOB ||
        !get_text(s, 1, MSG_MAX_NAME, &owner) ||
        !get_text(s, 2, MSG_MAX_NAME, &name) || !get_u32(s, 3, &why) ||
        !get_u32(s, 4, &fetched) || !get_u64(s, 5, &g->end_ms) ||
        !get_u64(s, 6, &g->gone_ms) || why >= GONE_NWHYS || fetched > 1)
        return false;
    memcpy(g->job, id, n);
    memcpy(g->owner, owner, strlen(owner) + 1);
    memcpy(g->name, name, strlen(name) + 1);
    g->why = (enum gone_why)why;
    g->fetched = fetched;
    return true;
}

int
journal_read_gone(struct journal *j,
                  void (*fn)(void *arg, const struct saved_gone *g), void *arg,
                  struct rad_error *err)
{
    sqlite3_stmt *s = journal_statement(j, SQL_GONES, err);
    struct saved_gone g;
    int rc = 0;

    if (!s)
        return err->code;
    while (next_row(j, s, &rc, err))
        if (get_gone(s, &g))
            fn(arg, &g);
        else
            rc = rad_fail(err, RAD_EDATA,
                          "database: a job that was forgotten cannot be");
    return rc;
}
