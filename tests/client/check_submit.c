/* check_submit.c - radsubmit's conversation against coordinators of all kinds
 *
 * Each test forks a process that plays the coordinator on a Unix socket by a
 * script, and checks what the client made of it; the player's exit status says
 * whether the client said what it should have. */
#include "config.h"

#include "proto/frame.h"
#include "link/submit.h"
#include "tests/scratch.h"

#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <sysexits.h>
#include <unistd.h>

FIXTURE(scratch_make, scratch_remove)

static struct target target;

/* --- the player: a coordinator in a process of its own --- */

struct player {
    int listening, fd;
    struct frame_reader reader;
    struct msg in;
    uint8_t bytes[1 << 16];
    const uint8_t *next;
    size_t left;
    int may_ask;    /* questions about workers that may come at any time */
    bool may_leave; /* the client, whenever its time is over */
};

enum {
    WRONG = 99,      /* exit status when the client strays from the script */
    CANCEL_MS = 5000 /* most time that it waits for a job to be cancelled */
};

/* The client has hung up. */
static void
player_is_left(const struct player *p)
{
    _exit(p->may_leave ? EX_OK : WRONG);
}

/* Send the message so often, in one piece. */
static void
player_send_often(struct player *p, const struct msg *m, int times)
{
    struct wire_out out;
    size_t done = 0;

    wire_out_init(&out, (size_t)times * MSG_FRAME_MAX);
    for (int i = 0; i < times; i++)
        if (msg_pack_as(p->reader.version, &out, m) < 0)
            _exit(WRONG);
    while (done < out.len) {
        ssize_t n = write(p->fd, out.buf + done, out.len - done);

        if (n <= 0)
            player_is_left(p);
        done += (size_t)n;
    }
    wire_out_release(&out);
}

static void
player_send(struct player *p, const struct msg *m)
{
    player_send_often(p, m, 1);
}

static void
player_tell_workers(struct player *p, const struct msg *in, const char *page)
{
    struct msg m = { .type = MSG_ANSWER, .request = in->request };

    m.answer.text = (const uint8_t *)page;
    m.answer.len = strlen(page);
    player_send(p, &m);
}

static const char busy[] =
    "{\"rows\": [{\"name\": \"ws1\", \"state\": \"working\"}]}";

/* The next message but PINGs and what may be asked; NULL: none comes for so
 * long (ms below 0: wait for it). */
static const struct msg *
player_next(struct player *p, int ms)
{
    for (;;) {
        int rc = frame_read(&p->reader, &p->next, &p->left, &p->in, NULL);
        struct pollfd in = { p->fd, POLLIN, 0 };
        ssize_t n;

        if (rc < 0)
            _exit(WRONG);
        if (rc == 1 && p->in.type == MSG_PAGE && p->may_ask > 0) {
            p->may_ask--;
            player_tell_workers(p, &p->in, busy);
        } else if (rc == 1 && p->in.type != MSG_PING) {
            return &p->in;
        }
        if (rc == 1)
            continue;
        if (poll(&in, 1, ms) == 0)
            return NULL;
        n = read(p->fd, p->bytes, sizeof p->bytes);
        if (n <= 0)
            player_is_left(p);
        p->next = p->bytes;
        p->left = (size_t)n;
    }
}

/* The next message must be of that type. */
static const struct msg *
player_expect(struct player *p, uint16_t type)
{
    const struct msg *m = player_next(p, -1);

    if (m->type != type) {
        fprintf(stderr, "expected %s, got %s\n", msg_name(type),
                msg_name(m->type));
        _exit(WRONG);
    }
    return m;
}

static void
player_accept(struct player *p)
{
    p->fd = accept(p->listening, NULL, NULL);
    if (p->fd < 0)
        _exit(WRONG);
    frame_reader_init(&p->reader, MSG_AT_COORD_NEW);
    p->left = 0;
}

/* Wait for the client to dial again; false: it has ended. */
static bool
player_is_dialled(struct player *p)
{
    struct pollfd in = { p->listening, POLLIN, 0 };
    char path[100];

    snprintf(path, sizeof path, "%s/socket", dir);
    while (access(path, F_OK) == 0)
        if (poll(&in, 1, 50) == 1)
            return true;
    return false;
}

static void
player_welcome(struct player *p, uint64_t epoch)
{
    struct msg m = { .type = MSG_WELCOME };
    const struct msg *in;

    player_accept(p);
    in = player_expect(p, MSG_HELLO);
    if (in->hello.role != MSG_ROLE_USER || in->hello.min != MSG_VERSION_MIN ||
        in->hello.max != MSG_VERSION)
        _exit(WRONG);
    p->reader.session = MSG_AT_COORD_USER;
    p->reader.version = MSG_VERSION;
    m.welcome.version = (uint16_t)p->reader.version;
    m.welcome.epoch = epoch;
    m.welcome.program = "player";
    player_send(p, &m);
}

static void
player_hang_up(struct player *p)
{
    close(p->fd);
    frame_reader_release(&p->reader);
}

static const char file_text[] = "the scene";

/* OFFER to SUBMIT; want: ask for the second file offered.  Returns SUBMIT. */
static const struct msg *
player_take_scene(struct player *p, bool want)
{
    struct msg m = { 0 };
    const struct msg *in = player_expect(p, MSG_OFFER);
    uint8_t hash[MSG_HASH];

    if (in->offer.n != 2)
        _exit(WRONG);
    memcpy(hash, in->offer.hash + MSG_HASH, MSG_HASH);
    m.type = MSG_WANT;
    m.request = in->request;
    m.want.n = want ? 1 : 0;
    m.want.hash = hash;
    player_send(p, &m);
    if (want) {
        in = player_expect(p, MSG_CHUNK);
        if (memcmp(in->chunk.hash, hash, MSG_HASH) != 0 ||
            in->chunk.total != strlen(file_text) ||
            memcmp(in->chunk.data, file_text, in->chunk.len) != 0)
            _exit(WRONG);
        m = (struct msg){ .type = MSG_HAVE };
        m.have.hash = hash;
        player_send(p, &m);
    }
    in = player_expect(p, MSG_SUBMIT);
    if (strcmp(in->submit.params, "-ab 0") != 0 || in->submit.nframes != 1)
        _exit(WRONG);
    return in;
}

static void
player_take_job(struct player *p, bool want)
{
    const struct msg *in = player_take_scene(p, want);
    struct msg m = { .type = MSG_ACCEPT, .request = in->request };

    m.accept.job = in->submit.job;
    player_send(p, &m);
}

static void
player_refuse_job(struct player *p)
{
    const struct msg *in = player_take_scene(p, false);
    struct msg m = { .type = MSG_FAILED, .request = in->request };

    m.failed.job = in->submit.job;
    m.failed.status = EX_TEMPFAIL;
    m.failed.text = "limit user_jobs";
    player_send(p, &m);
}

static uint8_t job_id[MSG_JOB] = { 1, 2, 3 };

static void
player_progress(struct player *p, uint32_t workers, uint32_t ready)
{
    struct msg m = { .type = MSG_PROGRESS };

    m.progress.job = job_id;
    m.progress.state = workers > 0 ? MSG_STATE_RUNNING : MSG_STATE_WAITING;
    m.progress.pixels_done = 10;
    m.progress.pixels_total = 100;
    m.progress.workers = workers;
    m.progress.frames_ready = ready;
    player_send(p, &m);
}

static void
player_done(struct player *p)
{
    struct msg m = { .type = MSG_DONE };

    m.done.job = job_id;
    m.done.frames = 1;
    player_send(p, &m);
}

/* Answer a FETCH with text in two pieces that overlap by some bytes. */
static void
player_give(struct player *p, enum msg_what what, const char *text,
            size_t overlap)
{
    static const uint8_t none[MSG_HASH];
    const struct msg *in = player_expect(p, MSG_FETCH);
    struct msg m = { .type = MSG_CHUNK, .request = in->request };
    size_t half = strlen(text) / 2;

    if (in->fetch.what != what)
        _exit(WRONG);
    m.chunk.hash = none;
    m.chunk.total = strlen(text);
    m.chunk.data = (const uint8_t *)text;
    m.chunk.len = half;
    player_send(p, &m);
    m.chunk.offset = half - overlap;
    m.chunk.data += half;
    m.chunk.len = strlen(text) - half;
    player_send(p, &m);
}

static void
player_cancelled(struct player *p)
{
    const struct msg *in = player_expect(p, MSG_CANCEL);
    struct msg m = { .type = MSG_ANSWER, .request = in->request };

    m.answer.text = (const uint8_t *)"";
    player_send(p, &m);
}

static void
player_cancels_too_late(struct player *p)
{
    const struct msg *in = player_expect(p, MSG_CANCEL);
    struct msg m = { .type = MSG_FAILED, .request = in->request };

    m.failed.job = job_id;
    m.failed.status = EX_USAGE;
    m.failed.text = "the job is over";
    player_send(p, &m);
}

/* --- the scripts --- */

static void
script_speaks_nonsense(struct player *p)
{
    player_accept(p);
    player_expect(p, MSG_HELLO);
    if (write(p->fd, "HTTP/1.1 400 Bad Request\r\n\r\n", 28) != 28)
        _exit(WRONG);
}

static void
script_speaks_out_of_turn(struct player *p)
{
    struct msg m = { .type = MSG_OFFER }; /* may not arrive at a client */

    player_welcome(p, 1);
    player_expect(p, MSG_OFFER);
    m.offer.hash = (const uint8_t *)"";
    player_send(p, &m);
}

/* The frame is ready, and what there is is fetched. */
static void
player_deliver(struct player *p)
{
    player_progress(p, 1, 1);
    player_give(p, MSG_WHAT_PICTURE, "a picture", 0);
    player_done(p);
    player_give(p, MSG_WHAT_STATS, "{ }", 0);
}

static void
player_render(struct player *p)
{
    player_take_job(p, true);
    player_progress(p, 1, 0);
    player_deliver(p);
}

static void
script_renders(struct player *p)
{
    player_welcome(p, 1);
    player_render(p);
}

/* More than the client holds of what it has not looked at: it stops reading,
 * and must go on. */
static void
script_says_more_than_fits(struct player *p)
{
    static const uint8_t other[MSG_JOB], records[60000];
    struct msg m = { .type = MSG_RECORDS,
                     .records = { other, 1, records, sizeof records } };

    player_welcome(p, 1);
    player_take_job(p, true);
    player_send_often(p, &m, 200);
    player_progress(p, 1, 0);
    player_deliver(p);
}

/* The client stays, and keeps its place in line. */
static void
script_lets_it_wait_its_turn(struct player *p)
{
    player_welcome(p, 1);
    player_refuse_job(p);
    player_refuse_job(p);
    player_render(p);
}

/* When --wait would be over, had it not begun with the refusal. */
static void
script_refuses_late(struct player *p)
{
    player_welcome(p, 1);
    uv_sleep(300);
    player_refuse_job(p);
    player_render(p);
}

/* The coordinator starts anew. */
static void
script_loses_who_is_in_line(struct player *p)
{
    player_welcome(p, 1);
    player_refuse_job(p);
    player_hang_up(p);
    player_welcome(p, 1);
    player_refuse_job(p);
    player_render(p);
}

/* The connection breaks when files have been on their way for longer than
 * --wait. */
static void
script_breaks_a_long_upload(struct player *p)
{
    player_welcome(p, 1);
    player_expect(p, MSG_OFFER);
    sleep(6);
    player_hang_up(p);
    player_welcome(p, 1);
    player_render(p);
}

/* Of such connections nothing comes, so --wait ends the job after pauses of .5,
 * 1 and 1.5 s. */
static void
script_breaks_every_upload(struct player *p)
{
    p->may_leave = true;
    for (int i = 0; player_is_dialled(p); i++) {
        if (i == 4)
            _exit(WRONG);
        player_welcome(p, 1);
        player_expect(p, MSG_OFFER);
        player_hang_up(p);
    }
}

static void
player_refuse(struct player *p, int status)
{
    struct msg m = { .type = MSG_REFUSE };

    player_accept(p);
    player_expect(p, MSG_HELLO);
    m.refuse.status = (uint16_t)status;
    m.refuse.text = "not you";
    player_send(p, &m);
}

static void
script_has_too_many_connections(struct player *p)
{
    player_refuse(p, EX_TEMPFAIL);
    player_hang_up(p);
    player_refuse(p, EX_TEMPFAIL);
    player_hang_up(p);
    player_welcome(p, 1);
    player_render(p);
}

/* The files of the scene are refused, each by itself; both refusals come
 * together, for the client is gone after the first. */
static void
script_has_no_room_for_files(struct player *p)
{
    const struct msg *in;
    struct msg m = { .type = MSG_WANT };

    player_welcome(p, 1);
    in = player_expect(p, MSG_OFFER);
    m.request = in->request;
    m.want = in->offer;
    player_send(p, &m);
    m = (struct msg){ .type = MSG_FAILED };
    m.failed.job = NULL;
    m.failed.status = EX_TEMPFAIL;
    m.failed.text = "limit user_upload_mib";
    for (int i = 0; i < 2; i++)
        player_expect(p, MSG_CHUNK);
    player_send_often(p, &m, 2);
    player_hang_up(p);
    player_welcome(p, 1);
    player_render(p);
}

static void
script_refuses_for_ever(struct player *p)
{
    player_welcome(p, 1);
    for (int i = 0; i < 2; i++) /* at once, and when --wait is over */
        player_refuse_job(p);
}

static void
script_refuses(struct player *p)
{
    player_refuse(p, EX_NOPERM);
}

static void
script_refuses_once(struct player *p)
{
    player_welcome(p, 1);
    player_refuse_job(p);
}

static void
script_starts_again(struct player *p)
{
    player_welcome(p, 1);
    player_take_job(p, true);
    player_progress(p, 1, 0);
    player_hang_up(p);
    player_welcome(p, 2);
    player_take_job(p, false);
    player_done(p);
    player_give(p, MSG_WHAT_PICTURE, "a picture", 0);
    player_give(p, MSG_WHAT_STATS, "{ }", 0);
}

static void
player_fails(struct player *p, int status, const char *why)
{
    struct msg m = { .type = MSG_FAILED };

    player_welcome(p, 1);
    player_take_job(p, false);
    m.failed.job = job_id;
    m.failed.status = (uint16_t)status;
    m.failed.text = why;
    player_send(p, &m);
}

static void
script_fails_the_job(struct player *p)
{
    player_fails(p, EX_SOFTWARE, "unit 7 crashed twice");
}

/* The code is that of a connection that fails, which is made again. */
static void
script_lacks_a_worker(struct player *p)
{
    player_fails(p, EX_UNAVAILABLE, "no worker can keep a process for it");
}

static void
script_gives_pieces_that_do_not_fit(struct player *p)
{
    player_welcome(p, 1);
    player_take_job(p, false);
    player_done(p);
    player_give(p, MSG_WHAT_PICTURE, "a picture", 1);
}

static void
script_is_cancelled(struct player *p)
{
    player_welcome(p, 1);
    player_take_job(p, false);
    player_progress(p, 1, 0);
    player_cancelled(p);
}

/* The coordinator ends before it has heard of that. */
static void
script_ends_at_cancel(struct player *p)
{
    player_welcome(p, 1);
    player_take_job(p, false);
    player_progress(p, 1, 0);
    player_expect(p, MSG_CANCEL);
    player_hang_up(p);
}

/* The client is interrupted at PROGRESS; DONE is on its way to it. */
static void
script_is_done_before_cancel(struct player *p)
{
    player_welcome(p, 1);
    player_take_job(p, false);
    player_progress(p, 1, 0);
    player_done(p);
    player_cancels_too_late(p);
}

static void
player_workers(struct player *p, const char *page)
{
    player_tell_workers(p, player_expect(p, MSG_PAGE), page);
}

static void
script_has_no_worker(struct player *p)
{
    player_welcome(p, 1);
    player_take_job(p, false);
    player_progress(p, 0, 0);
    player_workers(p, "{\"rows\": [{\"name\": \"ws1\", \"state\": \"gone\"}]}");
    player_cancelled(p);
}

/* A worker is at another job, on the second page; before the client may ask
 * again one begins ours. */
static void
script_is_in_the_queue(struct player *p)
{
    const struct msg *in;

    player_welcome(p, 1);
    player_take_job(p, false);
    player_progress(p, 0, 0);
    player_workers(p, "{\"rows\": [], \"next\": 7}");
    in = player_expect(p, MSG_PAGE);
    player_progress(p, 1, 0);
    player_tell_workers(p, in, busy);
    player_deliver(p);
}

/* The job is in that state, and no worker is told of, for many times as long as
 * the client would wait.  Before it hears of the state it may ask, once. */
static void
script_stands_still(struct player *p, uint8_t state)
{
    struct msg m = { .type = MSG_PROGRESS };

    player_welcome(p, 1);
    player_take_job(p, false);
    m.progress.job = job_id;
    m.progress.state = state;
    player_send(p, &m);
    p->may_ask = 1;
    if (player_next(p, 1200))
        _exit(WRONG);
    player_deliver(p);
}

/* As long as it is paused no worker can come. */
static void
script_is_paused(struct player *p)
{
    script_stands_still(p, MSG_STATE_PAUSED);
}

/* A worker began the job and left before it was told of. */
static void
script_lost_its_worker(struct player *p)
{
    script_stands_still(p, MSG_STATE_RUNNING);
}

static void
script_gives_a_reason(struct player *p)
{
    const struct msg *in;
    struct msg m = { .type = MSG_ANSWER };

    player_welcome(p, 1);
    player_take_job(p, false);
    player_progress(p, 0, 0);
    in = player_expect(p, MSG_QUERY);
    if (in->query.what != MSG_QUERY_JOB ||
        strncmp(in->query.text, "010203", 6) != 0)
        _exit(WRONG);
    m.request = in->request;
    m.answer.text = (const uint8_t *)"{ \"text\": \"all are drained\" }";
    m.answer.len = strlen((const char *)m.answer.text);
    player_send(p, &m);
    player_deliver(p);
}

/* One that does not tell is no worse for it. */
static void
script_gives_no_reason(struct player *p)
{
    const struct msg *in;
    struct msg m = { .type = MSG_FAILED };

    player_welcome(p, 1);
    player_take_job(p, false);
    player_progress(p, 0, 0);
    in = player_expect(p, MSG_QUERY);
    m.request = in->request;
    m.failed.job = job_id;
    m.failed.status = EX_NOINPUT;
    m.failed.text = "no such job";
    player_send(p, &m);
    player_deliver(p);
}

static void
script_detaches(struct player *p)
{
    player_welcome(p, 1);
    player_take_job(p, true);
}

/* --- the client --- */

struct client {
    pid_t player;
    char picture[32], stats[32];
    int interrupts;
    bool interrupt_at_progress, interrupt_when_told;
    int nsaid, naccepted, nreuse;
    bool wonders;
    char reason[100];
};

static void
on_accepted(void *arg)
{
    ((struct client *)arg)->naccepted++;
}

static void
on_reuse(void *arg, const uint8_t *job)
{
    (void)job;
    ((struct client *)arg)->nreuse++;
}

static bool
on_wonders(void *arg)
{
    return ((struct client *)arg)->wonders;
}

static void
on_reason(void *arg, const char *text)
{
    struct client *c = arg;

    snprintf(c->reason, sizeof c->reason, "%s", text);
}

static void
on_say(void *arg, const char *text)
{
    struct client *c = arg;

    (void)text;
    c->nsaid++;
    if (c->interrupt_when_told)
        c->interrupts = 1;
}

static void
on_progress(void *arg, const struct msg_progress *m)
{
    struct client *c = arg;

    c->wonders = m->workers == 0 && m->state != MSG_STATE_PAUSED;
    if (c->interrupt_at_progress)
        c->interrupts = 1;
}

static int
on_frame(void *arg, uint32_t frame, const struct rad_memory_out *picture,
         const struct rad_memory_out *depth, struct rad_error *err)
{
    struct client *c = arg;

    ck_assert_uint_eq(frame, 0);
    ck_assert_ptr_null(depth->bytes);
    if (picture->len >= sizeof c->picture)
        return rad_fail(err, RAD_EINTERNAL, "picture of %zu bytes",
                        picture->len);
    memcpy(c->picture, picture->bytes, picture->len);
    c->picture[picture->len] = '\0';
    return 0;
}

static int
on_stats(void *arg, const uint8_t *json, size_t len, struct rad_error *err)
{
    struct client *c = arg;

    (void)err;
    snprintf(c->stats, sizeof c->stats, "%.*s", (int)len, (const char *)json);
    return 0;
}

/* A player that has ended serves no other call. */
static int
on_alive(void *arg, struct rad_error *err)
{
    siginfo_t info = { 0 };

    if (waitid(P_PID, (id_t)((struct client *)arg)->player, &info,
               WEXITED | WNOHANG | WNOWAIT) == 0 &&
        info.si_pid == 0)
        return 0;
    return rad_fail(err, RAD_EINTERNAL, "the player has ended");
}

static const struct script {
    const char *name;
    void (*play)(struct player *p); /* NULL: nobody listens */
    int rc;
    double wait_s;
    bool interrupt, detach;
    bool points;        /* the job is of sensor points */
    bool refused;       /* the job is never accepted */
    bool told;          /* the user is told once why there is no job yet */
    const char *reason; /* what is learned of why nobody is at it */
    const char *what; /* how the error begins; then the cluster is another's */
} scripts[] = {
    { "nobody", NULL, RAD_EUNAVAIL, 0, .refused = true },
    { "refuses", script_refuses, RAD_EPERM, 30, .refused = true },
    { "nonsense", script_speaks_nonsense, RAD_EPROTO, 30, .refused = true },
    { "out of turn", script_speaks_out_of_turn, RAD_EPROTO, 30,
      .refused = true },
    { "reason", script_gives_a_reason, 0, 30, .reason = "all are drained" },
    { "no reason", script_gives_no_reason, 0, 30, .reason = "" },
    { "renders", script_renders, 0, 30, .detach = false },
    { "more than fits", script_says_more_than_fits, 0, 30, .detach = false },
    { "starts again", script_starts_again, 0, 30, .detach = false },
    { "fails", script_fails_the_job, RAD_EINTERNAL, 30, .detach = false },
    { "lacks a worker", script_lacks_a_worker, RAD_EUNAVAIL, 30,
      .what = "no worker can keep a process for it" },
    { "pieces", script_gives_pieces_that_do_not_fit, RAD_EPROTO, 30,
      .detach = false },
    { "cancelled", script_is_cancelled, RAD_ETEMPFAIL, 30, .interrupt = true },
    { "ends at cancel", script_ends_at_cancel, RAD_ETEMPFAIL, 30,
      .interrupt = true,
      .what = "the coordinator has not said that the job is "
              "cancelled: radctl cancel 0102" },
    { "done before", script_is_done_before_cancel, RAD_ETEMPFAIL, 30,
      .interrupt = true,
      .what = "interrupted; the job is done: radctl fetch 0102" },
    { "values done before", script_is_done_before_cancel, RAD_ETEMPFAIL, 30,
      .interrupt = true, .points = true,
      .what = "interrupted; the job is done: submit again with --job=0102" },
    { "no worker", script_has_no_worker, RAD_EUNAVAIL, .01, .detach = false },
    { "in the queue", script_is_in_the_queue, 0, .2, .detach = false },
    { "is paused", script_is_paused, 0, .01, .detach = false },
    { "lost its worker", script_lost_its_worker, 0, .01, .detach = false },
    { "detaches", script_detaches, 0, 30, .detach = true },
    { "in line", script_lets_it_wait_its_turn, 0, 30, .told = true },
    { "refused late", script_refuses_late, 0, .2, .told = true },
    { "lost in line", script_loses_who_is_in_line, 0, 30, .detach = false },
    { "long upload", script_breaks_a_long_upload, 0, 5, .detach = false },
    { "no upload", script_breaks_every_upload, RAD_EUNAVAIL, 3,
      .refused = true },
    { "too many connections", script_has_too_many_connections, 0, 30,
      .told = true },
    { "no room for files", script_has_no_room_for_files, 0, 30, .told = true },
    { "refused at once", script_refuses_once, RAD_ETEMPFAIL, 0, .refused = true,
      .what = "limit user_jobs" },
    { "refused for ever", script_refuses_for_ever, RAD_ETEMPFAIL, .3,
      .refused = true, .told = true, .what = "limit user_jobs" },
    { "interrupted in line", script_refuses_once, RAD_ETEMPFAIL, 30,
      .interrupt = true, .refused = true, .told = true, .what = "interrupted" },
};

static int
listen_at(const char *path)
{
    struct sockaddr_un un = { .sun_family = AF_UNIX };
    int fd = socket(AF_UNIX, SOCK_STREAM, 0);

    snprintf(un.sun_path, sizeof un.sun_path, "%s", path);
    unlink(path);
    ck_assert_int_eq(bind(fd, (struct sockaddr *)&un, sizeof un), 0);
    ck_assert_int_eq(listen(fd, 5), 0);
    return fd;
}

static pid_t
start_player(const struct script *s, const char *path)
{
    struct player *p;
    int fd = listen_at(path);
    pid_t pid = fork();

    ck_assert_int_ge(pid, 0);
    if (pid > 0) {
        close(fd);
        return pid;
    }
    p = calloc(1, sizeof *p);
    p->listening = fd;
    alarm(600); /* a client that hangs must not hang the tests */
    s->play(p);
    /* wait for the client to go, so that it reads all that was sent */
    while (read(p->fd, p->bytes, sizeof p->bytes) > 0)
        ;
    _exit(0);
}

static void
make_cargo(struct cargo *c, struct rad_bundle *b)
{
    char hex[RAD_SHA_HEX + 1], path[200];
    FILE *f;

    ck_assert_int_eq(rad_sha_hex(file_text, strlen(file_text), hex, NULL), 0);
    snprintf(path, sizeof path, "%s/%s", dir, hex);
    f = fopen(path, "w");
    fputs(file_text, f);
    fclose(f);
    rad_bundle_init(b);
    ck_assert_int_eq(
        rad_bundle_add(b, RAD_BUNDLE_SCENE, "-", hex, strlen(file_text), NULL),
        0);
    ck_assert_int_eq(cargo_init(c, b, dir, NULL), 0);
}

static int
run_client(const struct script *s, struct client *c, struct rad_error *err)
{
    struct msg_frame frame = { 0, 4, 4, "-vtv" };
    struct msg_spec spec = { .job = job_id, .params = "-ab 0", .nframes = 1 };
    struct submit_callbacks cb = { .say = on_say,
                                   .accepted = on_accepted,
                                   .reuse = on_reuse,
                                   .wonders = on_wonders,
                                   .progress = on_progress,
                                   .frame = on_frame,
                                   .stats = on_stats,
                                   .arg = c };
    struct submit_job job = {
        .spec = &spec, .to = target, .wait_s = s->wait_s, .detach = s->detach
    };
    struct rad_bundle bundle;
    struct cargo cargo;
    uv_loop_t loop;
    int rc;

    if (s->play && !s->what)
        cb.alive = on_alive;
    if (s->reason)
        cb.reason = on_reason;
    make_cargo(&cargo, &bundle);
    job.cargo = &cargo;
    spec.frames = &frame;
    spec.manifest = cargo.hashes;
    spec.files.n = cargo.n;
    spec.files.hash = cargo.hashes;
    spec.windows = 0;
    spec.flags = s->points ? MSG_JOB_POINTS | MSG_JOB_DEPTH : 0;
    c->interrupt_at_progress = s->interrupt;
    c->interrupt_when_told = s->interrupt && s->told;
    uv_loop_init(&loop);
    rc = submit_run(&job, &loop, &c->interrupts, &cb, err);
    ck_assert_int_eq(uv_loop_close(&loop), 0); /* no handle is left */
    cargo_release(&cargo);
    rad_bundle_release(&bundle);
    return rc;
}

/* Returns how long the client took [ms]. */
static uint64_t
play(const struct script *s)
{
    struct client c = { .picture = "" };
    struct rad_error err = { 0 };
    char path[100];
    int rc, status = 0;
    uint64_t begin_ns = uv_hrtime(), took_ns;

    signal(SIGPIPE, SIG_IGN); /* as in radsubmit */
    snprintf(path, sizeof path, "%s/socket", dir);
    unlink(path);
    ck_assert_int_eq(target_parse(&target, path, NULL), 0);
    if (s->play)
        c.player = start_player(s, path);
    rc = run_client(s, &c, &err);
    took_ns = uv_hrtime() - begin_ns;
    unlink(path); /* tells the player */
    ck_assert_msg(rc == s->rc, "%s: %d (%s), expected %d", s->name, rc,
                  err.what, s->rc);
    if (c.player)
        waitpid(c.player, &status, 0);
    ck_assert_msg(WIFEXITED(status) && WEXITSTATUS(status) == 0,
                  "%s: the coordinator ended with %d", s->name, status);
    ck_assert_int_eq(c.naccepted, s->refused ? 0 : 1);
    if (s->reason)
        ck_assert_str_eq(c.reason, s->reason);
    if (s->what)
        ck_assert_msg(strstr(err.what, s->what) == err.what, "%s", err.what);
    if (s->refused) /* nor does the user have to look for it */
        ck_assert_msg(!strstr(err.what, "may have"), "%s", err.what);
    if (s->what || s->told)
        ck_assert_int_eq(c.nsaid, s->told ? 1 : 0);
    ck_assert_int_le(c.nreuse, 1); /* though it may be accepted again */
    if (s->rc == 0 && !s->detach) {
        ck_assert_int_eq(c.nreuse, 1);
        ck_assert_str_eq(c.picture, "a picture");
        ck_assert_str_eq(c.stats, "{ }");
    }
    return took_ns / 1000000;
}

LOOP_TEST(conversations_end_as_they_should, N_ELEM(scripts))
{
    const struct script *s = &scripts[_i];
    uint64_t took_ms = play(s);

    /* who is interrupted waits for nothing that cannot come, which would take
     * as long each time; a busy machine does not */
    for (int i = 0; s->interrupt && took_ms >= CANCEL_MS; i++) {
        ck_assert_int_lt(i, 5);
        took_ms = play(s);
    }
}

TEST(nothing_is_said_without_a_key)
{
    struct link_where where;
    struct link *l;
    uv_loop_t loop;
    int wake = 0;

    uv_loop_init(&loop);
    where = (struct link_where){ &loop, &wake };
    ck_assert_int_eq(target_parse(&target, "192.0.2.1:7420", NULL), 0);
    ck_assert_int_eq(link_open(&l, &where, &target, MSG_ROLE_USER, 1000, NULL),
                     RAD_EPERM);
    ck_assert_int_eq(target_parse(&target, "127.0.0.1:1", NULL), 0);
    ck_assert_int_eq(link_open(&l, &where, &target, MSG_ROLE_USER, 1000, NULL),
                     RAD_EUNAVAIL);
    ck_assert_int_eq(uv_loop_close(&loop), 0);
}
