/* render.c - see render.h
 *
 * The loop's thread talks and loads; the pool's threads render.  Ambient
 * records that the threads made are collected every few ms; those that
 * arrive are put into the cache by the loop's thread while the others go on. */
#include "config.h"

#include "render.h"

#include "ambshare.h"
#include "conn.h"
#include "estimate.h"
#include "fingerprint.h"
#include "jobtext.h"
#include "log.h"
#include "pool.h"
#include "sandbox.h"
#include "scene/bundle.h"
#include "scene/octfile.h"
#include "scene/part.h"
#include "blobs.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sysexits.h>
#include <unistd.h>

/* Far below the 50 ms that a record may wait: eight workers with a fifth of a
 * processor each made 19 % of an office's records twice at 40 ms, 14 % at 10 ms
 * and 9 % at 2 ms, in the same time.  Nearly all of these are deep ones of the
 * first half second, when all are at the whole room at once. */
#define DRAIN_MS 2
/* A record is needed elsewhere soon, or not for long: later they may wait for
 * such a part of the time since the first, and go out together, since each
 * message costs as much as making a record. */
#define DRAIN_PART    100
#define CALM_MS       50
#define BATCH_RECORDS (65536 / AMBSHARE_BYTES)
/* how often strict units are looked at: others wait for their base lines, and
 * twins for their facts, for at most 20 ms */
#define TICK_MS 10
/* Looking up whether a record was needed costs more than putting it in, so one
 * of so many is looked up and stands for the others. */
#define METER_EACH 8
/* how often the coordinator hears of rays while units are under way */
#define TALLY_MS 500
/* and at least, so that radd knows that the loop runs */
#define SIGN_OF_LIFE_MS 10000
/* someone who gets the whole cache, or facts for the case of a loss, is given
 * more when so little waits */
#define GIVE_AHEAD       (1u << 20)
#define LARGEST_MANIFEST (64u << 20)

/* Somebody who is being sent all records. */
struct give {
    struct give *next;
    uint32_t to;
    uint64_t cursor;
};

struct render {
    uv_loop_t loop;
    uv_timer_t drain;  /* of ambient records */
    uv_timer_t teller; /* of what was done so far */
    uv_timer_t ticker; /* of strict units */
    struct conn *link; /* NULL once it is gone */
    const char *files_dir;
    int nthreads;
    unsigned memory_mib; /* most that it may have; 0: any */
    uint8_t id[MSG_JOB];
    bool share, ended;
    bool records;         /* radsubmit wants them */
    bool sandboxed;       /* must be */
    int pixel_s;          /* most processor time of a pixel; 0: any */
    struct msg start;     /* JOB-START, in start_bytes */
    uint8_t *start_bytes; /* its payload */
    uint32_t frame;       /* of the last unit; nframes before the first */
    struct rad_scene *scene;
    struct rad_job *job;
    struct rad_frame *frames;
    uint32_t nframes;
    struct strict *strict; /* NULL: the picture is not shared by lines */
    struct pool *pool;
    struct give *gives;
    uint64_t loaded;   /* where records begin that others may lack */
    uint64_t first_ms; /* records were drained; 0: not yet */
    uint64_t sent, received, redundant; /* ambient records */
    uint64_t told_rays;                 /* under way, in the last TALLY */
    uint64_t told_dropped;              /* likewise */
    uint64_t told_ms;                   /* when that was */
    int status;
};

/* --- what is said --- */

/* Whose limit it was where memory is out: the job's own is the same everywhere
 * and fails it, radd's or the machine's is not. */
static int
blame_limit(const struct render *r, int code, char *text, size_t size)
{
    size_t n = strlen(text);
    uint32_t own = r->start.job_start.memory_mib;

    if (code != RAD_ENOMEM && code != UV_ENOMEM)
        return code;
    if (own > 0 && own == r->memory_mib) {
        snprintf(text + n, size - n,
                 ", and the job may have %u MiB (--memory-mib)", own);
        return RAD_EDATA;
    }
    if (r->memory_mib > 0)
        snprintf(text + n, size - n,
                 ", and a job's process may have %u MiB here (memory_mib)",
                 r->memory_mib);
    return RAD_ENOMEM;
}

static void
send_failed(struct render *r, const struct rad_error *err)
{
    struct msg m = { .type = MSG_FAILED };
    char text[MSG_MAX_TEXT + 1];
    int code;

    rad_error_format(err, text, sizeof text);
    code = blame_limit(r, err->code, text, sizeof text);
    m.failed.job = r->id;
    m.failed.status = (uint16_t)rad_exit_status(code);
    m.failed.text = text;
    if (r->link)
        conn_send(r->link, &m);
}

static void
send_tally(struct render *r)
{
    struct msg m = { .type = MSG_TALLY };
    struct pool_tally did = { 0 };
    struct rusage use;

    if (r->pool)
        did = pool_tally(r->pool);
    r->told_rays = did.rays_under_way;
    r->told_dropped = did.dropped.rays;
    r->told_ms = uv_now(&r->loop);

    getrusage(RUSAGE_SELF, &use);
    m.tally.job = r->id;
    m.tally.ambient_sent = r->sent;
    m.tally.ambient_received = r->received;
    m.tally.ambient_redundant = r->redundant;
    m.tally.peak_rss_bytes = (uint64_t)use.ru_maxrss * 1024;
    m.tally.busy_s = did.busy_s;
    m.tally.wait_base_line_s = did.wait_base_line_s;
    m.tally.rays_under_way = did.rays_under_way;
    m.tally.dropped = did.dropped;
    conn_send(r->link, &m);
}

/* Leave when what was said is out. */
static void
end(struct render *r, int status)
{
    if (r->ended)
        return;
    r->ended = true;
    r->status = status;
    uv_timer_stop(&r->drain);
    uv_timer_stop(&r->teller);
    uv_timer_stop(&r->ticker);
    conn_finish(r->link);
    r->link = NULL;
}

/* A pixel that takes so long never ends: say so, and no more. */
static void
watch(struct render *r)
{
    struct rad_error err = { 0 };
    int x, y;

    if (!r->link || !pool_stuck(r->pool, r->pixel_s, &x, &y))
        return;
    rad_fail(&err, RAD_EINTERNAL,
             "the pixel at x %d, y %d took more than %d s of a processor", x, y,
             r->pixel_s);
    send_failed(r, &err);
    /* its thread would never be joined: radd ends this process */
    uv_timer_stop(&r->drain);
    uv_timer_stop(&r->teller);
    uv_timer_stop(&r->ticker);
}

static void
on_teller(uv_timer_t *timer)
{
    struct render *r = timer->data;

    if (r->link && (pool_tally(r->pool).rays_under_way != r->told_rays ||
                    uv_now(&r->loop) - r->told_ms >= SIGN_OF_LIFE_MS))
        send_tally(r);
    watch(r);
}

static void drain(struct render *r);

static void
on_rows(void *arg, const struct pool_rows *p)
{
    struct render *r = arg;
    struct msg m = { .type = MSG_RESULT };
    uint8_t *floats = NULL;

    if (!r->link)
        return;
    if (p->err.code) {
        send_failed(r, &p->err);
        end(r, rad_exit_status(p->err.code));
        return;
    }
    if (p->channels > 1) {
        floats = malloc(p->bytes + 1);
        if (!floats)
            _exit(EX_OSERR); /* radd hands the unit to somebody else */
        wire_floats_put(floats, (const float *)p->pixels,
                        p->bytes / sizeof(float));
    }
    m.result.job = r->id;
    m.result.unit = p->unit.unit;
    m.result.attempt = p->unit.attempt;
    m.result.row = p->row;
    m.result.rows = p->rows;
    m.result.width = (uint32_t)p->unit.window.width;
    m.result.channels = (uint8_t)p->channels;
    m.result.last = p->last;
    m.result.counts = p->counts;
    m.result.pixels = floats ? floats : (const uint8_t *)p->pixels;
    m.result.len = p->bytes;
    if (p->last && r->records)
        drain(r); /* after the last unit's rows nobody would wait for them */
    if (p->last)
        send_tally(r);
    conn_send(r->link, &m);
    free(floats);
}

/* What strict units have to say. */
static void
on_news(void *arg)
{
    struct render *r = arg;
    const struct msg *m;

    while (r->link && r->strict &&
           (m = pool_message(r->pool, conn_queued(r->link) < GIVE_AHEAD)))
        conn_send(r->link, m);
    if (r->link && r->strict &&
        pool_tally(r->pool).dropped.rays != r->told_dropped)
        send_tally(r);
}

static void
on_ticker(uv_timer_t *timer)
{
    struct render *r = timer->data;
    struct rad_error err = { 0 };

    if (strict_error(r->strict) < 0) {
        rad_fail(&err, RAD_ENOMEM, "out of memory");
        send_failed(r, &err);
        end(r, rad_exit_status(err.code));
        return;
    }
    pool_tick(r->pool, uv_now(&r->loop));
    on_news(r);
}

/* --- ambient records --- */

static void
send_batch(struct render *r, uint32_t to, const struct rad_ambrec *recs,
           size_t n)
{
    struct msg m = { .type = MSG_AMBIENT };
    struct wire_out w;

    wire_out_init(&w, MSG_MAX_AMBIENT);
    for (size_t i = 0; i < n; i++)
        ambshare_pack(&w, &recs[i]);
    m.ambient.to = to;
    m.ambient.count = (uint32_t)n;
    m.ambient.data = w.buf;
    m.ambient.len = w.len;
    if (!w.bad && conn_send(r->link, &m) && r->share)
        r->sent += n;
    wire_out_release(&w);
}

/* Go on sending everything to those that asked. */
static void
go_on_giving(struct render *r, struct rad_ambrec *recs)
{
    while (r->gives && r->link && conn_queued(r->link) < GIVE_AHEAD) {
        struct give *g = r->gives;
        size_t n =
            rad_ambient_list(r->job->ambient, &g->cursor, recs, BATCH_RECORDS);

        if (n > 0) {
            send_batch(r, g->to, recs, n);
            continue;
        }
        r->gives = g->next;
        free(g);
    }
}

/* When to look for records again. */
static uint64_t
drain_ms(const struct render *r)
{
    uint64_t ms =
        r->first_ms ? (uv_now(&r->loop) - r->first_ms) / DRAIN_PART : DRAIN_MS;

    return ms < DRAIN_MS ? DRAIN_MS : ms > CALM_MS ? CALM_MS : ms;
}

/* Send what the threads have made since the last call. */
static void
drain(struct render *r)
{
    struct rad_ambrec recs[BATCH_RECORDS];
    size_t n;

    while (r->link &&
           (n = rad_ambient_drain(r->job->ambient, recs, BATCH_RECORDS)) > 0) {
        send_batch(r, 0, recs, n);
        if (r->first_ms == 0)
            r->first_ms = uv_now(&r->loop);
    }
}

static void
on_drain(uv_timer_t *timer)
{
    struct render *r = timer->data;
    struct rad_ambrec recs[BATCH_RECORDS];

    drain(r);
    go_on_giving(r, recs);
    if (!r->ended)
        uv_timer_start(timer, on_drain, drain_ms(r), 0);
}

static void
take_ambient(struct render *r, const struct msg_ambient *a)
{
    struct wire_in in;
    struct rad_ambrec rec;

    if (!r->job || !r->job->ambient)
        return;
    wire_in_init(&in, a->data, a->len);
    for (uint32_t i = 0; i < a->count && !in.bad; i++) {
        if (!ambshare_unpack(&in, &rec))
            continue;
        if (r->received++ % METER_EACH == 0 &&
            rad_ambient_covers(r->job->ambient, &rec))
            r->redundant += METER_EACH;
        rad_ambient_insert(r->job->ambient, &rec);
    }
}

static void
take_give(struct render *r, const struct msg_give *m)
{
    struct give *g;

    if (!r->job || !r->job->ambient)
        return;
    g = calloc(1, sizeof *g);
    if (!g)
        return; /* costs the other one time, nothing else */
    g->to = m->to;
    g->cursor = r->loaded; /* the job's file of records is everybody's */
    g->next = r->gives;
    r->gives = g;
}

/* --- loading --- */

static int
read_manifest(struct render *r, const uint8_t *hash, struct rad_bundle *bundle,
              struct rad_error *err)
{
    char name[RAD_SHA_HEX + 1], path[BLOBS_PATH_MAX];
    unsigned char *text;
    size_t len;
    int rc;

    rad_sha_to_hex(hash, name);
    snprintf(path, sizeof path, "%s/%s", r->files_dir, name);
    text = rad_file_read(path, LARGEST_MANIFEST, &len, err);
    if (!text)
        return err->code;
    rc = rad_bundle_parse(bundle, (const char *)text, len, err);
    free(text);
    return rc;
}

/* Those that the job begins with, if there are any. */
static int
load_records(struct render *r, const struct rad_bundle *bundle,
             struct rad_error *err)
{
    struct rad_bundle_dir where = { bundle, r->files_dir };
    struct rad_files files = rad_bundle_files(&where);
    struct rad_ambrec recs[BATCH_RECORDS];
    unsigned char *bytes;
    size_t len;
    int rc;

    r->loaded = 0;
    if (!r->job->ambient ||
        !rad_bundle_find(bundle, RAD_BUNDLE_FILE, RAD_BUNDLE_RECORDS))
        return 0;
    bytes = files.read(files.arg, RAD_BUNDLE_RECORDS, &len, err);
    if (!bytes)
        return err->code;
    rc = ambshare_load(r->job->ambient, bytes, len, err);
    free(bytes);
    while (rad_ambient_list(r->job->ambient, &r->loaded, recs, BATCH_RECORDS))
        ;
    return rc;
}

static int
load_job(struct render *r, const struct rad_bundle *bundle,
         const struct msg_spec *spec, struct rad_error *err)
{
    const struct rad_bundle_entry *e =
        rad_bundle_find(bundle, RAD_BUNDLE_SCENE, NULL);
    struct rad_bundle_dir where = { bundle, r->files_dir };
    struct rad_files files = rad_bundle_files(&where);
    struct rad_params params;
    char path[BLOBS_PATH_MAX];
    int rc = jobtext_params(spec->params, &params, err);

    if (rc < 0)
        return rc;
    if (!e)
        return rad_fail(err, RAD_EDATA, "the bundle has no scene");
    params.seed = spec->seed;
    snprintf(path, sizeof path, "%s/%s", r->files_dir, e->hash);
    r->scene = rad_octfile_load(path, err);
    if (r->scene && !rad_scene_include(r->scene, &files, NULL, NULL, err))
        r->job = rad_job_new(r->scene, &params, &files, err);
    return r->job ? load_records(r, bundle, err) : err->code;
}

static int
load_frames(struct render *r, const struct msg_spec *spec,
            struct rad_error *err)
{
    bool depth = spec->flags & MSG_JOB_DEPTH;
    struct rad_view before;

    r->frames = calloc(spec->nframes + 1, sizeof *r->frames);
    if (!r->frames)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    for (uint32_t i = 0; i < spec->nframes; i++) {
        const struct msg_frame *f = &spec->frames[i];
        struct rad_view view;
        int rc = jobtext_view(f->view, &view, err);

        if (rc == 0)
            rc = rad_frame_init(&r->frames[i], r->job, &view, f->number, depth,
                                err);
        if (rc < 0)
            return rc;
        r->nframes = i + 1;
        if (i > 0 && (rc = rad_frame_move(&r->frames[i], &before, err)) < 0)
            return rc;
        before = view;
        if (r->frames[i].width != (int)f->width ||
            r->frames[i].height != (int)f->height)
            return rad_fail(
                err, RAD_EDATA, "frame %u is %dx%d by its view, not %ux%u", i,
                r->frames[i].width, r->frames[i].height, f->width, f->height);
    }
    return 0;
}

/* The machine of strict units, where there may be some. */
static int
load_strict(struct render *r, const struct msg_spec *spec,
            struct rad_error *err)
{
    struct rad_quincunx *q;
    bool painted = false;

    if (spec->partition == MSG_PART_WINDOW)
        return 0;
    q = calloc(r->nframes + 1, sizeof *q);
    if (q) {
        for (uint32_t i = 0; i < r->nframes; i++) {
            const struct rad_frame *f = &r->frames[i];
            const struct rad_window all = { 0, 0, f->width, f->height };

            rad_frame_sampler(f, &all, &q[i]);
            painted |= f->paint.n > 0;
        }
        r->strict = strict_new(q, r->nframes, painted, r->nthreads, r->id);
        free(q);
    }
    return r->strict ? 0 : rad_fail(err, RAD_ENOMEM, "out of memory");
}

static int
load(struct render *r, const struct msg_spec *spec, struct rad_error *err)
{
    struct rad_bundle bundle;
    int rc;

    rad_bundle_init(&bundle);
    rc = read_manifest(r, spec->manifest, &bundle, err);
    if (rc == 0)
        rc = load_job(r, &bundle, spec, err);
    if (rc == 0)
        rc = load_frames(r, spec, err);
    rad_bundle_release(&bundle);
    if (rc == 0)
        rc = load_strict(r, spec, err);
    if (rc < 0)
        return rc;
    r->frame = r->nframes;
    r->pool = pool_new(&r->loop, r->job, r->frames, r->strict, r->nthreads,
                       spec->flags & MSG_JOB_CODED, on_rows, on_news, r, err);
    return r->pool ? 0 : err->code;
}

/* Free all that load() made. */
static void
unload(struct render *r)
{
    pool_free(r->pool);
    r->pool = NULL;
    strict_free(r->strict);
    r->strict = NULL;
    for (uint32_t i = 0; i < r->nframes; i++)
        rad_frame_release(&r->frames[i]);
    r->nframes = 0;
    free(r->frames);
    r->frames = NULL;
    rad_job_free(r->job);
    r->job = NULL;
    rad_scene_free(r->scene);
    r->scene = NULL;
}

/* Keep JOB-START: what it has borrowed is gone when the next message comes. */
static int
keep_start(struct render *r, const struct msg *m, struct rad_error *err)
{
    struct wire_out out;
    size_t n;

    wire_out_init(&out, MSG_FRAME_MAX);
    if (msg_pack(&out, m) < 0) {
        wire_out_release(&out);
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    }
    n = out.len - MSG_HEADER;
    r->start_bytes = malloc(n + 1);
    if (r->start_bytes)
        memcpy(r->start_bytes, out.buf + MSG_HEADER, n);
    wire_out_release(&out);
    if (!r->start_bytes)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    return msg_unpack(&r->start, m->type, 0, r->start_bytes, n, err);
}

/* What came from others has been read: that was the last file, unless each
 * frame begins anew. */
static int
seal(const struct render *r, const struct msg_spec *spec, struct rad_error *err)
{
    if (spec->nframes > 1 && spec->flags & MSG_JOB_FRESH_FRAMES)
        return 0;
    return sandbox_seal(r->sandboxed, err);
}

static void
start_job(struct render *r, const struct msg *m)
{
    const struct msg_spec *spec = &m->job_start;
    struct msg ready = { .type = MSG_READY };
    struct rad_error err = { 0 };
    uint64_t t0 = uv_hrtime();

    memcpy(r->id, spec->job, MSG_JOB);
    conn_set_session(r->link, MSG_AT_CHILD);
    conn_live(r->link, false);
    if (keep_start(r, m, &err) < 0 || load(r, spec, &err) < 0 ||
        fingerprint(&ready.ready.fingerprint, &err) < 0 ||
        seal(r, spec, &err) < 0) {
        send_failed(r, &err);
        end(r, rad_exit_status(err.code));
        return;
    }
    r->share = spec->flags & MSG_JOB_SHARE && r->job->ambient;
    r->records = spec->flags & MSG_JOB_RECORDS && r->job->ambient;
    if (r->share || r->records)
        uv_timer_start(&r->drain, on_drain, DRAIN_MS, 0);
    uv_timer_start(&r->teller, on_teller, TALLY_MS, TALLY_MS);
    ready.ready.job = r->id;
    ready.ready.load_s = 1e-9 * (double)(uv_hrtime() - t0);
    ready.ready.threads = (uint16_t)r->nthreads;
    conn_send(r->link, &ready);
}

/* --- units --- */

static int
check_unit(const struct render *r, const struct msg_unit *u,
           struct rad_error *err)
{
    const struct rad_frame *f;

    if (u->frame >= r->nframes)
        return rad_fail(err, RAD_EPROTO, "unit %u of frame %u, of %u", u->unit,
                        u->frame, r->nframes);
    f = &r->frames[u->frame];
    if (u->width < 1 || u->height < 1 || u->width > (uint32_t)f->width ||
        u->height > (uint32_t)f->height ||
        u->x > (uint32_t)f->width - u->width ||
        u->y > (uint32_t)f->height - u->height)
        return rad_fail(err, RAD_EPROTO, "unit %u lies outside the picture",
                        u->unit);
    /* what comes with a row in its message takes far less than this */
    if ((size_t)u->width * (f->depth ? 16 : 12) > MSG_MAX - 1024)
        return rad_fail(err, RAD_EDATA, "a row of %u pixels is too wide",
                        u->width);
    return 0;
}

/* A unit of another frame than the last, where nothing is to be kept: begin as
 * with a new job. */
static int
begin_frame(struct render *r, uint32_t frame, struct rad_error *err)
{
    const struct msg_spec *spec = &r->start.job_start;
    int rc;

    if (r->frame != r->nframes && r->frame != frame &&
        spec->flags & MSG_JOB_FRESH_FRAMES) {
        unload(r);
        rc = load(r, spec, err);
        if (rc < 0)
            return rc;
        for (struct give *g = r->gives; g; g = g->next)
            g->cursor = r->loaded;
    }
    r->frame = frame;
    return 0;
}

static int
push_window(struct render *r, const struct msg_unit *u, struct rad_error *err)
{
    struct pool_unit unit = { .unit = u->unit,
                              .attempt = u->attempt,
                              .frame = u->frame,
                              .window = { (int)u->x, (int)u->y, (int)u->width,
                                          (int)u->height } };

    if (!pool_push(r->pool, &unit))
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    return 0;
}

static int
push_strict(struct render *r, const struct msg_unit *u, struct rad_error *err)
{
    int rc;

    if (!r->strict)
        return rad_fail(err, RAD_EPROTO, "unit %u is strict, the job is not",
                        u->unit);
    rc = strict_unit(pool_strict(r->pool), u, err);
    pool_strict_done(r->pool);
    if (!uv_is_active((uv_handle_t *)&r->ticker))
        uv_timer_start(&r->ticker, on_ticker, TICK_MS, TICK_MS);
    return rc;
}

static void
take_unit(struct render *r, const struct msg_unit *u)
{
    struct rad_error err = { 0 };
    int rc = check_unit(r, u, &err);

    if (rc == 0)
        rc = begin_frame(r, u->frame, &err);
    if (rc == 0)
        rc = u->mode == MSG_MODE_STRICT ? push_strict(r, u, &err)
                                        : push_window(r, u, &err);
    if (rc < 0) {
        send_failed(r, &err);
        end(r, rad_exit_status(err.code));
    }
}

/* Facts and base lines come before the unit that needs them: those of a later
 * frame than what there was begin it, so that they are not forgotten then.
 * Those of an earlier one are late. */
static int
begin_lines(struct render *r, const struct msg *m, struct rad_error *err)
{
    uint32_t frame;

    if (m->type == MSG_FACTS)
        frame = m->facts.frame;
    else if (m->type == MSG_BASE_LINE)
        frame = m->base_line.frame;
    else
        return 0;
    if (frame >= r->nframes || (r->frame != r->nframes && frame < r->frame))
        return 0;
    return begin_frame(r, frame, err);
}

/* What the machine of the strict units is to know. */
static void
take_strict(struct render *r, const struct msg *m)
{
    struct rad_error err = { 0 };
    struct strict *s;

    if (!r->strict)
        return;
    if (begin_lines(r, m, &err) < 0) {
        send_failed(r, &err);
        end(r, rad_exit_status(err.code));
        return;
    }
    s = pool_strict(r->pool);
    switch (m->type) {
    case MSG_SPLIT:
        strict_split(s, m->split.unit, m->split.attempt);
        break;
    case MSG_TWIN:
        strict_twin(s, m->twin.unit, m->twin.attempt);
        break;
    case MSG_FACTS:
        strict_facts(s, &m->facts);
        break;
    default:
        strict_base_line(s, &m->base_line);
    }
    pool_strict_done(r->pool);
}

/* --- estimates --- */

/* What was traced goes first: it need not be traced again. */
static void
on_estimated(void *arg, struct estimate *e, double wall_s)
{
    struct render *r = arg;
    struct msg m = { .type = MSG_FACTS };
    struct msg_facts *f;

    while (r->link && r->strict && (f = estimate_facts(e))) {
        m.facts = *f;
        m.facts.job = r->id;
        conn_send(r->link, &m);
    }
    m = (struct msg){ .type = MSG_ESTIMATED };
    estimate_result(e, &m.estimated);
    m.estimated.job = r->id;
    m.estimated.counts.wall_s = wall_s;
    if (r->link)
        conn_send(r->link, &m);
    estimate_free(e);
}

static void
take_estimate(struct render *r, const struct msg_estimate *m)
{
    struct rad_error err = { 0 };
    struct estimate *e = estimate_new(r->frames, r->nframes, m, &err);

    if (e && !pool_estimate(r->pool, e, on_estimated)) {
        estimate_free(e);
        rad_fail(&err, RAD_ENOMEM, "out of memory");
    }
    if (err.code) {
        send_failed(r, &err);
        end(r, rad_exit_status(err.code));
    }
}

/* --- the link --- */

static void
on_message(void *arg, struct conn *c, const struct msg *m)
{
    struct render *r = arg;

    (void)c;
    switch (m->type) {
    case MSG_JOB_START:
        start_job(r, m);
        break;
    case MSG_UNIT:
        take_unit(r, &m->unit);
        break;
    case MSG_ESTIMATE:
        take_estimate(r, &m->estimate);
        break;
    case MSG_REVOKE:
        pool_revoke(r->pool, m->revoke.unit, m->revoke.attempt);
        break;
    case MSG_SPLIT:
    case MSG_TWIN:
    case MSG_FACTS:
    case MSG_BASE_LINE:
        take_strict(r, m);
        break;
    case MSG_AMBIENT:
        take_ambient(r, &m->ambient);
        break;
    case MSG_GIVE:
        take_give(r, &m->give);
        break;
    case MSG_JOB_END:
        send_tally(r);
        end(r, EX_OK);
        break;
    default:
        break;
    }
}

static void
on_closed(void *arg, struct conn *c, const char *why)
{
    (void)arg;
    (void)c;
    (void)why;
    /* nobody is left to render for, and threads may be deep in a bar */
    _exit(EX_OK);
}

static void
on_written(void *arg, struct conn *c, size_t n)
{
    struct render *r = arg;

    (void)c;
    if (!r->pool)
        return;
    pool_sent(r->pool, n);
    on_news(r); /* there may be room for more */
}

static const struct conn_handler handler = { .message = on_message,
                                             .closed = on_closed,
                                             .written = on_written };

/* --- the process --- */

/* Give way to whoever sits at the machine, die with radd. */
static void
confine(unsigned memory_mib, int give_way)
{
    struct rlimit memory = { (rlim_t)memory_mib << 20,
                             (rlim_t)memory_mib << 20 };
    int ignored;

    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() == 1)
        _exit(EX_OK); /* radd was gone before that took effect */
    if (memory_mib > 0)
        setrlimit(RLIMIT_DATA, &memory);
    signal(SIGPIPE, SIG_IGN);
    signal(SIGINT, SIG_IGN); /* a terminal's; radd decides */
    ignored = nice(give_way);
    (void)ignored;
}

static int
open_link(struct render *r)
{
    uv_stream_t *stream = conn_stream_new(&r->loop, true);
    int rc;

    if (!stream)
        return UV_ENOMEM;
    rc = uv_pipe_open((uv_pipe_t *)stream, RENDER_LINK_FD);
    if (rc < 0) {
        conn_stream_close(stream);
        return rc;
    }
    r->link = conn_new(stream, NULL, MSG_AT_CHILD_NEW, "radd", &handler, r);
    if (!r->link)
        return UV_ENOMEM;
    conn_live(r->link, false);
    return 0;
}

static void
release(struct render *r)
{
    unload(r);
    uv_close((uv_handle_t *)&r->drain, NULL);
    uv_close((uv_handle_t *)&r->teller, NULL);
    uv_close((uv_handle_t *)&r->ticker, NULL);
    uv_run(&r->loop, UV_RUN_DEFAULT);
    msg_release(&r->start);
    free(r->start_bytes);
    while (r->gives) {
        struct give *g = r->gives;

        r->gives = g->next;
        free(g);
    }
    uv_loop_close(&r->loop);
}

int
render_main(int argc, char *argv[])
{
    static struct render r;
    struct rad_error err = { 0 };
    int rc;

    if (argc != 8)
        return EX_USAGE; /* radd starts this, nobody else */
    r.files_dir = argv[2];
    r.nthreads = atoi(argv[3]);
    r.pixel_s = atoi(argv[6]);
    r.sandboxed = strcmp(argv[7], RENDER_SANDBOXED) == 0;
    r.memory_mib = (unsigned)strtoul(argv[4], NULL, 10);
    confine(r.memory_mib, atoi(argv[5]));
    log_open("radd-child", LOG_LEVEL_WARN);
    if (sandbox_begin(r.files_dir, r.sandboxed, &err) < 0) {
        log_err("%s", err.what);
        return rad_exit_status(err.code);
    }
    uv_loop_init(&r.loop);
    uv_timer_init(&r.loop, &r.drain);
    uv_timer_init(&r.loop, &r.teller);
    uv_timer_init(&r.loop, &r.ticker);
    r.drain.data = r.teller.data = r.ticker.data = &r;
    rc = open_link(&r);
    if (rc < 0) {
        log_err("no link to radd: %s", uv_strerror(rc));
        return EX_USAGE;
    }
    while (!r.ended)
        uv_run(&r.loop, UV_RUN_ONCE);
    release(&r);
    return r.status;
}
