/* store.c - see store.h
 *
 * Each request is a task that owns copies of all it needs.  The lists of
 * arriving files and of jobs are the pool thread's; the loop never looks at
 * them. */
#include "config.h"

#include "store.h"

#include "blobs.h"
#include "jobtext.h"
#include "rows.h"
#include "log.h"
#include "service.h"
#include "sound.h"
#include "task.h"

#include <assert.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* A file that a connection sends. */
struct arriving {
    struct arriving *next;
    uint64_t conn;
    uint8_t hash[MSG_HASH];
    struct blob_part part;
};

struct frame_rows {
    struct rows rows;
    char *view;
    uint32_t number;
    bool open; /* rows are there */
};

struct job {
    struct job *next;
    uint8_t id[MSG_JOB];
    char *params;
    bool depth;
    uint32_t nframes;
    struct frame_rows *frames;
};

struct store {
    struct task_queue queue;
    const struct store_handler *handler;
    void *arg;
    char dir[BLOBS_DIR_MAX];
    struct blobs blobs;
    struct sounds sounds;      /* [loop] */
    bool durable;              /* [fixed] */
    size_t backlog;            /* [loop] */
    struct arriving *arriving; /* [pool] */
    struct job *jobs;          /* [pool] */
};

static const char *
failure(const struct task *t)
{
    return t->code < 0 ? t->err.what : "";
}

static int
status_of(const struct task *t)
{
    return t->code < 0 ? rad_exit_status(t->code) : 0;
}

static void *
task_alloc(size_t size)
{
    void *p = calloc(1, size);

    /* a store that cannot answer must not go on as if it would */
    if (!p)
        abort();
    return p;
}

/* --- arriving files --- */

struct chunk_task {
    struct task task;
    struct store *store;
    uint64_t conn, offset, total;
    uint8_t hash[MSG_HASH];
    size_t len;
    uint8_t data[];
};

static struct arriving **
find_arriving(struct store *s, uint64_t conn, const uint8_t *hash)
{
    struct arriving **at = &s->arriving;

    while (*at && ((*at)->conn != conn ||
                   (hash && memcmp((*at)->hash, hash, MSG_HASH) != 0)))
        at = &(*at)->next;
    return at;
}

static void
end_arriving(struct arriving **at)
{
    struct arriving *a = *at;

    *at = a->next;
    blob_part_abort(&a->part);
    free(a);
}

static int
begin_arriving(struct store *s, const struct chunk_task *c,
               struct rad_error *err)
{
    struct arriving *a = calloc(1, sizeof *a);
    char name[RAD_SHA_HEX + 1];
    int rc;

    if (!a)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    blobs_name(c->hash, name);
    rc = blob_part_open(&a->part, &s->blobs, name, c->total, err);
    if (rc < 0) {
        free(a);
        return rc;
    }
    a->conn = c->conn;
    memcpy(a->hash, c->hash, MSG_HASH);
    a->next = s->arriving;
    s->arriving = a;
    return 0;
}

static int
chunk_run(struct task *t)
{
    struct chunk_task *c = (struct chunk_task *)t;
    struct arriving **at;
    int rc;

    if (c->offset == 0 && !*find_arriving(c->store, c->conn, c->hash)) {
        rc = begin_arriving(c->store, c, &t->err);
        if (rc < 0)
            return rc;
    }
    at = find_arriving(c->store, c->conn, c->hash);
    if (!*at)
        return rad_fail(&t->err, RAD_EPROTO, "a file that did not begin at 0");
    if ((*at)->part.total != c->total)
        rc = rad_fail(&t->err, RAD_EPROTO, "a file that changed its length");
    else
        rc = blob_part_write(&(*at)->part, c->offset, c->data, c->len, &t->err);
    if (rc != 0)
        end_arriving(at);
    return rc;
}

static void
note_file(struct store *s, const uint8_t *hash)
{
    char name[RAD_SHA_HEX + 1], path[BLOBS_PATH_MAX];

    blobs_name(hash, name);
    blobs_path(&s->blobs, name, path);
    sounds_note(&s->sounds, hash, path);
}

static void
chunk_done(struct task *t)
{
    struct chunk_task *c = (struct chunk_task *)t;
    struct store *s = c->store;

    s->backlog -= c->len;
    if (t->code > 0)
        note_file(s, c->hash);
    if (t->code != 0)
        s->handler->file(s->arg, c->conn, c->hash, status_of(t), failure(t));
    else if (s->handler->progress)
        s->handler->progress(s->arg);
    free(c);
}

void
store_put_chunk(struct store *s, uint64_t conn, const struct msg_chunk *chunk)
{
    struct chunk_task *c = task_alloc(sizeof *c + chunk->len);

    c->task.run = chunk_run;
    c->task.done = chunk_done;
    c->store = s;
    c->conn = conn;
    c->offset = chunk->offset;
    c->total = chunk->total;
    memcpy(c->hash, chunk->hash, MSG_HASH);
    c->len = chunk->len;
    if (chunk->len)
        memcpy(c->data, chunk->data, chunk->len);
    s->backlog += c->len;
    task_push(&s->queue, &c->task);
}

struct drop_task {
    struct task task;
    struct store *store;
    uint64_t conn;
};

static int
drop_run(struct task *t)
{
    struct drop_task *d = (struct drop_task *)t;
    struct arriving **at;

    while (*(at = find_arriving(d->store, d->conn, NULL)))
        end_arriving(at);
    return 0;
}

static void
free_task(struct task *t)
{
    free(t);
}

void
store_drop_conn(struct store *s, uint64_t conn)
{
    struct drop_task *d = task_alloc(sizeof *d);

    d->task.run = drop_run;
    d->task.done = free_task;
    d->store = s;
    d->conn = conn;
    task_push(&s->queue, &d->task);
}

/* --- jobs --- */

static struct job **
find_job(struct store *s, const uint8_t *id)
{
    struct job **at = &s->jobs;

    while (*at && memcmp((*at)->id, id, MSG_JOB) != 0)
        at = &(*at)->next;
    return at;
}

static void
free_job(struct job *j)
{
    if (!j)
        return;
    for (uint32_t i = 0; i < j->nframes; i++) {
        if (j->frames[i].open)
            rows_rest(&j->frames[i].rows);
        free(j->frames[i].view);
    }
    free(j->frames);
    free(j->params);
    free(j);
}

static struct job *
copy_job(const uint8_t *id, const struct msg_spec *p)
{
    struct job *j = calloc(1, sizeof *j);

    if (!j)
        return NULL;
    memcpy(j->id, id, MSG_JOB);
    j->depth = p->flags & MSG_JOB_DEPTH;
    j->params = strdup(p->params);
    j->frames = calloc(p->nframes, sizeof *j->frames);
    if (!j->params || !j->frames) {
        free_job(j);
        return NULL;
    }
    j->nframes = p->nframes;
    for (uint32_t i = 0; i < p->nframes; i++) {
        struct frame_rows *f = &j->frames[i];

        f->number = p->frames[i].number;
        f->rows.fd = -1;
        f->rows.width = (int)p->frames[i].width;
        f->rows.height = (int)p->frames[i].height;
        f->view = strdup(p->frames[i].view);
        if (!f->view) {
            free_job(j);
            return NULL;
        }
    }
    return j;
}

/* DIR/jobs/ID, or DIR/jobs/ID/FRAMEsuffix. */
static void
job_path(const struct store *s, const uint8_t *id, char path[ROWS_PATH_MAX])
{
    char hex[MSG_JOB_HEX];

    msg_job_format(id, hex);
    snprintf(path, ROWS_PATH_MAX, "%s/jobs/%s", s->dir, hex);
}

static void
frame_path(const struct store *s, const uint8_t *id, uint32_t frame,
           const char *suffix, char path[ROWS_PATH_MAX])
{
    size_t n;

    job_path(s, id, path);
    n = strlen(path);
    snprintf(path + n, ROWS_PATH_MAX - n, "/%u%s", frame, suffix);
}

static const char *
suffix_of(enum msg_what what)
{
    return what == MSG_WHAT_PICTURE ? ".hdr"
           : what == MSG_WHAT_DEPTH ? ".z"
                                    : ".preview";
}

struct job_task {
    struct task task;
    struct store *store;
    uint8_t id[MSG_JOB];
    uint32_t frame;
    struct job *job; /* of open_run; handed over to the list */
};

static struct job_task *
new_job_task(struct store *s, const uint8_t *id, int (*run)(struct task *t),
             void (*done)(struct task *t))
{
    struct job_task *j = task_alloc(sizeof *j);

    j->task.run = run;
    j->task.done = done;
    j->store = s;
    memcpy(j->id, id, MSG_JOB);
    return j;
}

static int
open_run(struct task *t)
{
    struct job_task *o = (struct job_task *)t;
    struct store *s = o->store;
    struct job *j = o->job, **old = find_job(s, o->id);
    char path[ROWS_PATH_MAX];
    int rc;

    if (!j)
        return rad_fail(&t->err, RAD_ENOMEM, "out of memory");
    if (*old) {
        struct job *gone = *old;

        *old = gone->next;
        free_job(gone);
    }
    j->next = s->jobs;
    s->jobs = j;
    o->job = NULL;
    job_path(s, o->id, path);
    rc = service_make_dir(path, 0750, &t->err);
    for (uint32_t i = 0; i < j->nframes && rc == 0; i++) {
        struct frame_rows *f = &j->frames[i];

        frame_path(s, o->id, i, ".rows", path);
        rc = rows_create(&f->rows, path, f->rows.width, f->rows.height,
                         j->depth ? 4 : 3, s->durable, &t->err);
        f->open = rc == 0;
    }
    return rc;
}

static void
open_done(struct task *t)
{
    struct job_task *o = (struct job_task *)t;

    free_job(o->job);
    o->store->handler->job(o->store->arg, o->id, status_of(t), failure(t));
    free(o);
}

void
store_open_job(struct store *s, const uint8_t job[MSG_JOB],
               const struct saved_job *saved)
{
    struct job_task *o = new_job_task(s, job, open_run, open_done);

    o->job = copy_job(job, &saved->spec);
    task_push(&s->queue, &o->task);
}

/* The rows of a frame, or an error. */
static int
find_frame(struct store *s, const uint8_t *id, uint32_t frame, struct job **job,
           struct frame_rows **rows, struct rad_error *err)
{
    struct job *j = *find_job(s, id);

    if (!j || frame >= j->nframes || !j->frames[frame].open)
        return rad_fail(err, RAD_ENOINPUT, "no rows of frame %u", frame);
    *job = j;
    *rows = &j->frames[frame];
    return 0;
}

struct rows_task {
    struct task task;
    struct store *store;
    struct action_rows key;
    float *pixels;
    size_t bytes;
};

static int
rows_run(struct task *t)
{
    struct rows_task *r = (struct rows_task *)t;
    struct action_rows *k = &r->key;
    struct frame_rows *f;
    struct job *j;
    int rc = find_frame(r->store, k->job, k->frame, &j, &f, &t->err);

    if (rc == 0 && k->channels != f->rows.channels)
        rc = rad_fail(&t->err, RAD_EPROTO, "rows of %d channels, expected %d",
                      k->channels, f->rows.channels);
    if (rc == 0)
        rc = rows_write(&f->rows, (int)k->x, (int)k->y, (int)k->width,
                        (int)k->rows, r->pixels, &t->err);
    return rc;
}

static void
rows_done(struct task *t)
{
    struct rows_task *r = (struct rows_task *)t;
    struct store *s = r->store;

    s->backlog -= r->bytes;
    s->handler->rows(s->arg, &r->key, status_of(t), failure(t));
    free(r->pixels);
    free(r);
}

void
store_put_rows(struct store *s, const struct action_rows *rows)
{
    struct rows_task *r = task_alloc(sizeof *r);
    size_t n = (size_t)rows->rows * rows->width * rows->channels;

    r->task.run = rows_run;
    r->task.done = rows_done;
    r->store = s;
    r->key = *rows;
    r->key.pixels = NULL;
    r->bytes = n * sizeof(float);
    r->pixels = task_alloc(r->bytes + 1);
    wire_floats_get(r->pixels, rows->pixels, n);
    s->backlog += r->bytes;
    task_push(&s->queue, &r->task);
}

/* A picture of the rows so far. */
static int
write_rgbe(const struct job *j, struct frame_rows *f, const char *path,
           bool durable, struct rad_error *err)
{
    struct rad_hdr_info info = { .program = "radsubmit",
                                 .options = j->params,
                                 .view = f->view,
                                 .frame = f->number,
                                 .width = f->rows.width,
                                 .height = f->rows.height };

    int rc = jobtext_pixaspect(j->params, f->view, f->rows.width,
                               f->rows.height, &info.pixaspect, err);

    if (rc < 0)
        return rc;
    return rows_picture(&f->rows, &info, path, durable, err);
}

static int
picture_run(struct task *t)
{
    struct job_task *p = (struct job_task *)t;
    struct store *s = p->store;
    struct frame_rows *f;
    struct job *j;
    char path[ROWS_PATH_MAX];
    int rc = find_frame(s, p->id, p->frame, &j, &f, &t->err);

    if (rc < 0)
        return rc;
    if (j->depth) {
        frame_path(s, p->id, p->frame, suffix_of(MSG_WHAT_DEPTH), path);
        rc = rows_depth(&f->rows, path, s->durable, &t->err);
        if (rc < 0)
            return rc;
    }
    frame_path(s, p->id, p->frame, suffix_of(MSG_WHAT_PICTURE), path);
    rc = write_rgbe(j, f, path, s->durable, &t->err);
    if (rc == 0) {
        rows_remove(&f->rows);
        f->open = false;
    }
    return rc;
}

static void
picture_done(struct task *t)
{
    struct job_task *p = (struct job_task *)t;

    p->store->handler->picture(p->store->arg, p->id, p->frame, status_of(t),
                               failure(t));
    free(p);
}

void
store_write_picture(struct store *s, const uint8_t job[MSG_JOB], uint32_t frame)
{
    struct job_task *p = new_job_task(s, job, picture_run, picture_done);

    p->frame = frame;
    task_push(&s->queue, &p->task);
}

static void
remove_dir(const char *path)
{
    DIR *d = opendir(path);
    struct dirent *e;

    if (!d)
        return;
    while ((e = readdir(d)) != NULL)
        unlinkat(dirfd(d), e->d_name, 0);
    closedir(d);
    rmdir(path);
}

/* The folders of jobs that nobody knows any more: jobs live in memory. */
static void
remove_jobs(const struct store *s)
{
    char path[ROWS_PATH_MAX];
    uint8_t id[MSG_JOB];
    struct dirent *e;
    DIR *d;

    snprintf(path, sizeof path, "%s/jobs", s->dir);
    d = opendir(path);
    if (!d)
        return;
    while ((e = readdir(d)) != NULL)
        if (msg_job_parse(e->d_name, id)) {
            job_path(s, id, path);
            remove_dir(path);
        }
    closedir(d);
}

static int
forget_run(struct task *t)
{
    struct job_task *p = (struct job_task *)t;
    struct job **at = find_job(p->store, p->id), *j = *at;
    char path[ROWS_PATH_MAX];

    if (j) {
        *at = j->next;
        free_job(j);
    }
    job_path(p->store, p->id, path);
    remove_dir(path);
    return 0;
}

void
store_forget_job(struct store *s, const uint8_t job[MSG_JOB])
{
    task_push(&s->queue, &new_job_task(s, job, forget_run, free_task)->task);
}

/* --- reading --- */

struct read_task {
    struct task task;
    struct store *store;
    struct store_source from;
    uint64_t offset, size;
    void *buf;
    size_t cap, got;
    store_read_fn *fn;
    void *arg;
};

static int
source_path(struct read_task *r, char path[ROWS_PATH_MAX])
{
    struct store *s = r->store;
    struct frame_rows *f;
    struct job *j;
    char name[RAD_SHA_HEX + 1], part[BLOBS_PATH_MAX];

    if (r->from.file) {
        blobs_name(r->from.hash, name);
        blobs_path(&s->blobs, name, part);
        snprintf(path, ROWS_PATH_MAX, "%s", part);
        return 0;
    }
    frame_path(s, r->from.job, r->from.frame, suffix_of(r->from.what), path);
    if (r->from.what != MSG_WHAT_PREVIEW)
        return 0;
    /* once the rows are gone, the picture is the preview */
    if (find_frame(s, r->from.job, r->from.frame, &j, &f, NULL) < 0) {
        frame_path(s, r->from.job, r->from.frame, suffix_of(MSG_WHAT_PICTURE),
                   path);
        return 0;
    }
    return r->offset ? 0 : write_rgbe(j, f, path, false, &r->task.err);
}

static int
read_run(struct task *t)
{
    struct read_task *r = (struct read_task *)t;
    char path[ROWS_PATH_MAX];
    struct stat st;
    ssize_t n = -1;
    int fd, rc = source_path(r, path);

    if (rc < 0)
        return rc;
    fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0)
        return rad_fail(&t->err, RAD_ENOINPUT, "cannot open '%s': %s", path,
                        strerror(errno));
    if (fstat(fd, &st) == 0)
        n = pread(fd, r->buf, r->cap, (off_t)r->offset);
    if (n < 0)
        rc = rad_fail(&t->err, RAD_EIO, "cannot read '%s': %s", path,
                      strerror(errno));
    close(fd);
    r->got = n > 0 ? (size_t)n : 0;
    r->size = (uint64_t)st.st_size;
    return rc;
}

static void
read_done(struct task *t)
{
    struct read_task *r = (struct read_task *)t;

    if (t->code < 0)
        r->fn(r->arg, -1, 0, t->err.what);
    else
        r->fn(r->arg, (ssize_t)r->got, r->size, "");
    free(r);
}

void
store_read(struct store *s, const struct store_source *from, uint64_t offset,
           void *buf, size_t cap, store_read_fn *fn, void *arg)
{
    struct read_task *r = task_alloc(sizeof *r);

    r->task.run = read_run;
    r->task.done = read_done;
    r->store = s;
    r->from = *from;
    r->offset = offset;
    r->buf = buf;
    r->cap = cap;
    r->fn = fn;
    r->arg = arg;
    task_push(&s->queue, &r->task);
}

/* --- the whole --- */

/* One fdatasync for all rows that a group of tasks wrote to a file. */
static int
settle(void *arg, struct rad_error *err)
{
    struct store *s = arg;
    int rc = 0;

    if (!s->durable)
        return 0;
    for (struct job *j = s->jobs; j && rc == 0; j = j->next)
        for (uint32_t i = 0; i < j->nframes && rc == 0; i++)
            if (j->frames[i].open)
                rc = rows_sync(&j->frames[i].rows, err);
    return rc;
}

struct store *
store_open(uv_loop_t *loop, const char *dir, bool durable,
           const struct store_handler *handler, void *arg,
           struct rad_error *err)
{
    struct store *s = calloc(1, sizeof *s);
    char files[BLOBS_DIR_MAX];

    if (!s) {
        rad_fail(err, RAD_ENOMEM, "out of memory");
        return NULL;
    }
    task_queue_init(&s->queue, loop);
    s->queue.settle = settle;
    s->queue.arg = s;
    s->handler = handler;
    s->arg = arg;
    s->durable = durable;
    if (snprintf(s->dir, sizeof s->dir, "%s", dir) >= (int)sizeof s->dir ||
        snprintf(files, sizeof files, "%s/files", dir) >= (int)sizeof files) {
        rad_fail(err, RAD_ECANTCREAT, "path too long: '%s'", dir);
        goto fail;
    }
    if (service_make_dir(dir, 0750, err) < 0 ||
        service_lock_dir(dir, err) < 0 ||
        blobs_open(&s->blobs, files, durable, err) < 0)
        goto fail;
    remove_jobs(s);
    return s;
fail:
    free(s);
    return NULL;
}

bool
store_idle(const struct store *s)
{
    return task_queue_idle(&s->queue);
}

size_t
store_backlog(const struct store *s)
{
    return s->backlog;
}

void
store_close(struct store *s)
{
    if (!s)
        return;
    assert(store_idle(s));
    while (s->arriving)
        end_arriving(&s->arriving);
    while (s->jobs) {
        struct job *j = s->jobs;

        s->jobs = j->next;
        free_job(j);
    }
    sounds_release(&s->sounds);
    free(s);
}

const char *
store_files_dir(const struct store *s)
{
    return s->blobs.dir;
}

bool
store_has_file(struct store *s, const uint8_t hash[MSG_HASH])
{
    char name[RAD_SHA_HEX + 1], path[BLOBS_PATH_MAX];
    bool damaged, there;

    blobs_name(hash, name);
    blobs_path(&s->blobs, name, path);
    there = sounds_check(&s->sounds, hash, path, &damaged);
    if (damaged)
        log_warn("file removed path=%s: it is damaged", path);
    return there;
}
