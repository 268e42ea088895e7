/* render.c - see render.h
 *
 * The loop thread talks and loads; the pool's threads render. */
#include "config.h"

#include "child/render.h"

#include "child/render_impl.h"

#include "net/conn.h"
#include "machine/fingerprint.h"
#include "net/log.h"
#include "child/sandbox.h"
#include "ground/memory.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sysexits.h>
#include <unistd.h>

/* --- the start of a job --- */

/* Copy JOB_START into r->start, for the message is valid only for the call. */
static int
keep_start(struct render *r, const struct msg *m, struct rad_error *err)
{
    struct wire_out out;
    size_t n;

    wire_out_init(&out, MSG_FRAME_MAX);
    if (msg_pack(&out, m) < 0) {
        wire_out_release(&out);
        return rad_fail_memory(err);
    }
    n = out.len - MSG_HEADER;
    r->start_bytes = malloc(n + 1);
    if (r->start_bytes)
        memcpy(r->start_bytes, out.buf + MSG_HEADER, n);
    wire_out_release(&out);
    if (!r->start_bytes)
        return rad_fail_memory(err);
    return msg_unpack(&r->start, m->type, 0, r->start_bytes, n, err);
}

/* The scene is loaded: open no files from now on.  Not yet if each frame is
 * loaded again, or each stage: then the last pass is followed by the seal. */
static int
seal(const struct render *r, const struct msg_spec *spec, struct rad_error *err)
{
    if ((spec->nframes > 1 && spec->flags & MSG_JOB_FRESH_FRAMES) ||
        msg_has_goal(&r->start.job_start))
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
    render_begin_tallies(r);
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
    case MSG_TILE:
        render_take_tile(r, &m->tile);
        break;
    case MSG_FROZEN:
        render_take_frozen(r, &m->frozen);
        break;
    case MSG_STAGE:
        render_take_stage(r, &m->stage);
        break;
    case MSG_SHOW:
        render_take_show(r, &m->show);
        break;
    case MSG_ESTIMATE:
        render_take_estimate(r, &m->estimate);
        break;
    case MSG_REVOKE:
        pool_revoke(r->pool, m->revoke.unit, m->revoke.attempt);
        break;
    case MSG_SPLIT:
    case MSG_YIELD:
    case MSG_LEND:
    case MSG_LOAN:
    case MSG_BACK:
    case MSG_FACTS:
    case MSG_BASE_LINE:
    case MSG_GUESS:
        render_take_strict(r, m);
        break;
    case MSG_AMBIENT:
        render_take_ambient(r, &m->ambient);
        break;
    case MSG_JOB_END:
        render_send_tally(r);
        render_end(r, EX_OK);
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
    /* radd is gone, so nobody wants the pictures; or memory is out, and radd
     * gives the units to another child.  Do not wait for threads in a bar. */
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
    render_send_news(r); /* there may be room for more */
}

static const struct conn_handler handler = { .message = on_message,
                                             .closed = on_closed,
                                             .written = on_written };

/* --- the process --- */

/* Let the kernel, where memory is short, end this process before others of its
 * size: its units are done elsewhere.  Half of the machine's memory counts as
 * ours besides what we have; more, and a small child would go for nothing.  A
 * container may have given radd more than that, which the child keeps: with
 * less, radd would go first. */
static void
yield_memory(void)
{
    static const char half[] = "500";
    char given[16] = "";
    int fd = open("/proc/self/oom_score_adj", O_RDWR | O_CLOEXEC);
    ssize_t ignored;

    if (fd < 0)
        return;
    ignored = read(fd, given, sizeof given - 1);
    if (strtol(given, NULL, 10) < strtol(half, NULL, 10))
        ignored = pwrite(fd, half, sizeof half - 1, 0);
    (void)ignored;
    close(fd);
}

/* Limit memory, give way to other processes, and die with radd, whose process
 * id is given: the first process of a container may be radd itself, and whoever
 * adopts an orphan need not be the first. */
static void
confine(unsigned memory_mib, int give_way, pid_t radd)
{
    struct rlimit memory = { (rlim_t)memory_mib << 20,
                             (rlim_t)memory_mib << 20 };
    int ignored;

    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != radd)
        _exit(EX_OK); /* radd ended before PR_SET_PDEATHSIG */
    if (memory_mib > 0)
        setrlimit(RLIMIT_DATA, &memory);
    signal(SIGPIPE, SIG_IGN);
    signal(SIGINT, SIG_IGN); /* from a terminal: radd decides */
    ignored = nice(give_way);
    (void)ignored;
    yield_memory();
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
    uv_loop_close(&r->loop);
}

int
render_main(int argc, char *argv[])
{
    static struct render r;
    struct rad_error err = { 0 };
    int rc;

    if (argc != 9)
        return EX_USAGE; /* only radd starts this */
    r.files_dir = argv[2];
    r.nthreads = atoi(argv[3]);
    r.pixel_s = atoi(argv[6]);
    r.sandboxed = strcmp(argv[7], RENDER_SANDBOXED) == 0;
    r.memory_mib = (unsigned)strtoul(argv[4], NULL, 10);
    confine(r.memory_mib, atoi(argv[5]), (pid_t)atoi(argv[8]));
    log_open("radd-child", LOG_LEVEL_WARN);
    if (sandbox_begin(r.files_dir, r.sandboxed, &err) < 0) {
        log_err("%s", err.what);
        return rad_exit_status(err.code);
    }
    memory_catch();
    rc = uv_loop_init(&r.loop);
    if (rc < 0) {
        log_err("cannot start: %s", uv_strerror(rc));
        return EX_OSERR;
    }
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
