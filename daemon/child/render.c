/* render.c - see render.h
 *
 * The loop's thread talks and loads; the pool's threads render. */
#include "config.h"

#include "child/render.h"

#include "child/render_impl.h"

#include "net/conn.h"
#include "radd/fingerprint.h"
#include "ground/log.h"
#include "child/sandbox.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sysexits.h>
#include <unistd.h>

/* how often the coordinator hears of rays while units are under way */
#define TALLY_MS 500
/* and at least, so that radd knows that the loop runs */
#define SIGN_OF_LIFE_MS 10000

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

void
render_fail(struct render *r, const struct rad_error *err)
{
    send_failed(r, err);
    end(r, rad_exit_status(err->code));
}

/* What the child did so far. */
static struct pool_tally
tally_of(const struct render *r)
{
    struct pool_tally all = r->past, now;

    if (!r->pool)
        return all;
    now = pool_tally(r->pool);
    all.busy_s += now.busy_s;
    all.wait_base_line_s += now.wait_base_line_s;
    all.rays_under_way = now.rays_under_way;
    all.pixels_under_way = now.pixels_under_way;
    msg_counts_add(&all.dropped, &now.dropped);
    msg_counts_add(&all.seeded, &now.seeded);
    return all;
}

void
render_keep_tally(struct render *r)
{
    r->past = tally_of(r);
    r->past.rays_under_way = r->past.pixels_under_way = 0;
}

static void
send_tally(struct render *r)
{
    struct msg m = { .type = MSG_TALLY };
    struct pool_tally did = tally_of(r);
    struct rusage use;

    r->told_rays = did.rays_under_way + did.seeded.rays;
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
    m.tally.pixels_under_way = did.pixels_under_way;
    m.tally.dropped = did.dropped;
    m.tally.seeded = did.seeded;
    m.tally.seeded.primary_rays = 0;
    memset(&m.tally.seeded.nan, 0, sizeof m.tally.seeded.nan);
    memset(m.tally.seeded.faults, 0, sizeof m.tally.seeded.faults);
    conn_send(r->link, &m);
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
    struct pool_tally did = tally_of(r);

    if (r->link && (did.rays_under_way + did.seeded.rays != r->told_rays ||
                    uv_now(&r->loop) - r->told_ms >= SIGN_OF_LIFE_MS))
        send_tally(r);
    watch(r);
}

void
render_on_rows(void *arg, const struct pool_rows *p)
{
    struct render *r = arg;
    struct msg m = { .type = MSG_RESULT };
    uint8_t *floats = NULL;

    if (!r->link)
        return;
    if (p->err.code) {
        render_fail(r, &p->err);
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
        render_drain(
            r); /* after the last unit's rows nobody would wait for them */
    if (p->last)
        send_tally(r);
    conn_send(r->link, &m);
    free(floats);
}

/* What strict units have to say. */
static void
send_news(struct render *r)
{
    struct rad_error err = { 0 };
    const struct msg *m;

    while (r->link && r->strict &&
           (m = pool_message(r->pool, conn_queued(r->link) < RENDER_AHEAD))) {
        /* it may be of columns that are all that the job waits for */
        if (m->type == MSG_PAID && r->records)
            render_drain(r);
        /* the worker may be let go for it */
        if (m->type == MSG_GAVE && m->gave.height == 0)
            send_tally(r);
        conn_send(r->link, m);
    }
    if (!r->link || !r->strict)
        return;
    if (tally_of(r).dropped.rays != r->told_dropped)
        send_tally(r);
    if (pool_error(r->pool) < 0) {
        rad_fail(&err, RAD_ENOMEM, "out of memory");
        render_fail(r, &err);
    }
}

static void
on_ticker(uv_timer_t *timer)
{
    render_on_news(timer->data);
}

/* Something changed with strict units, or time has passed for them. */
void
render_on_news(void *arg)
{
    struct render *r = arg;
    uint64_t now = uv_now(&r->loop), due;

    if (!r->link || !r->strict)
        return;
    due = pool_tick(r->pool, now);
    if (due == STRICT_NEVER)
        uv_timer_stop(&r->ticker);
    else
        uv_timer_start(&r->ticker, on_ticker, due > now ? due - now : 0, 0);
    send_news(r);
}

/* --- the start of a job --- */

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
    if (keep_start(r, m, &err) < 0 || render_load(r, spec, &err) < 0 ||
        fingerprint(&ready.ready.fingerprint, &err) < 0 ||
        seal(r, spec, &err) < 0) {
        render_fail(r, &err);
        return;
    }
    r->share = spec->flags & MSG_JOB_SHARE && r->job->ambient;
    r->records = spec->flags & MSG_JOB_RECORDS && r->job->ambient;
    if (r->share || r->records)
        render_records_begin(r);
    uv_timer_start(&r->teller, on_teller, TALLY_MS, TALLY_MS);
    ready.ready.job = r->id;
    ready.ready.load_s = 1e-9 * (double)(uv_hrtime() - t0);
    ready.ready.threads = (uint16_t)r->nthreads;
    conn_send(r->link, &ready);
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
        render_take_unit(r, &m->unit);
        break;
    case MSG_SEED:
        render_take_seed(r, &m->seed);
        break;
    case MSG_ESTIMATE:
        render_take_estimate(r, &m->estimate);
        break;
    case MSG_REST:
        pool_rest(r->pool);
        break;
    case MSG_REVOKE:
        pool_revoke(r->pool, m->revoke.unit, m->revoke.attempt);
        break;
    case MSG_SPLIT:
    case MSG_YIELD:
    case MSG_LEND:
    case MSG_LOAN:
    case MSG_BACK:
    case MSG_TWIN:
    case MSG_FACTS:
    case MSG_BASE_LINE:
        render_take_strict(r, m);
        break;
    case MSG_AMBIENT:
        render_take_ambient(r, &m->ambient);
        break;
    case MSG_GIVE:
        render_take_give(r, &m->give);
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
    /* radd is gone, and nobody is left to render for, or memory is out, and
     * radd hands the units to somebody else; threads may be deep in a bar */
    _exit(EX_OSERR);
}

static void
on_written(void *arg, struct conn *c, size_t n)
{
    struct render *r = arg;

    (void)c;
    if (!r->pool)
        return;
    pool_sent(r->pool, n);
    send_news(r); /* there may be room for more */
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
    render_unload(r);
    uv_close((uv_handle_t *)&r->drain, NULL);
    uv_close((uv_handle_t *)&r->teller, NULL);
    uv_close((uv_handle_t *)&r->ticker, NULL);
    uv_run(&r->loop, UV_RUN_DEFAULT);
    msg_release(&r->start);
    free(r->start_bytes);
    render_records_release(r);
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
