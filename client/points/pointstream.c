/* pointstream.c - see pointstream.h */
#include "config.h"

#include "points/pointstream.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    PIECE = 1 << 16,   /* bytes read at once */
    LONGEST = 1 << 16, /* most bytes of a line of text */
    PAUSE_MS = 50,     /* after which the writer may be waiting */
    ASKED_MS = 5,      /* the same, of a writer that asks for its answers */
    LATEST_MS = 1000   /* longest wait of a point for others */
};

bool
pointstream_is_one(void)
{
    struct stat st;

    return fstat(STDIN_FILENO, &st) == 0 &&
           (S_ISFIFO(st.st_mode) || S_ISSOCK(st.st_mode) ||
            isatty(STDIN_FILENO));
}

/* --- reading --- */

static void look(struct pointstream *s, bool on);

static void
end(struct pointstream *s)
{
    s->ended = true;
    look(s, false);
}

/* Parse n more bytes, which were read to the end of s->rest. */
static void
take_bytes(struct pointstream *s, size_t n)
{
    uint32_t before = s->in.n;
    uint64_t now = uv_now(s->loop);
    bool last = n == 0;
    size_t used = 0;

    s->nrest += n;
    if (pointfile_more(&s->in, s->rest, s->nrest, last, &used, &s->end) < 0)
        end(s);
    s->nrest -= used;
    memmove(s->rest, s->rest + used, s->nrest);
    if (s->in.n > before) {
        s->first_ms = before > 0 ? s->first_ms : now;
        s->last_ms = now;
    }
    if (s->in.taken + s->in.n == s->in.most || last)
        end(s);
    else if (s->nrest > LONGEST && !s->ended) {
        rad_fail(&s->end, RAD_EDATA, "a line of more than %d bytes", LONGEST);
        rad_error_where(&s->end, "stdin:%ld", s->in.line + 1);
        end(s);
    }
}

static void
on_readable(uv_poll_t *h, int status, int events)
{
    struct pointstream *s = h->data;
    ssize_t n = read(STDIN_FILENO, s->rest + s->nrest, PIECE);

    (void)events;
    if (n < 0 && (errno == EINTR || errno == EAGAIN) && status == 0)
        return;
    if (n < 0) {
        rad_fail(&s->end, RAD_EIO, "cannot read standard input: %s",
                 strerror(errno));
        end(s);
        return;
    }
    uv_update_time(s->loop);
    take_bytes(s, (size_t)n);
    if (s->in.n >= POINTSTREAM_MOST)
        look(s, false);
}

/* Read from the pipe or not; if not, its writer has to wait. */
static void
look(struct pointstream *s, bool on)
{
    if (s->reading == on)
        return;
    s->reading = on;
    if (on)
        uv_poll_start(&s->poll, UV_READABLE | UV_DISCONNECT, on_readable);
    else
        uv_poll_stop(&s->poll);
}

/* Begin to watch standard input.  libuv makes what it watches non-blocking, and
 * with it standard output, if both are one terminal or socket: undo that. */
static int
watch_input(struct pointstream *s)
{
    int flags = fcntl(STDIN_FILENO, F_GETFL);
    int rc = uv_poll_init(s->loop, &s->poll, STDIN_FILENO);

    if (flags >= 0)
        (void)!fcntl(STDIN_FILENO, F_SETFL, flags);
    return rc;
}

int
pointstream_open(struct pointstream *s, const struct pointspec *spec,
                 uv_loop_t *loop, struct rad_error *err)
{
    int rc;

    *s = (struct pointstream){ .loop = loop,
                               .size = POINTSTREAM_FIRST,
                               .flush = pointspec_flush(spec) };
    pointfile_init(&s->in, "stdin", spec->in, pointspec_most(spec));
    s->rest = malloc(LONGEST + PIECE);
    if (!s->rest)
        return rad_fail_memory(err);
    rc = watch_input(s);
    if (rc < 0)
        return rad_fail(err, RAD_EIO, "cannot read standard input: %s",
                        uv_strerror(rc));
    uv_timer_init(loop, &s->timer);
    s->poll.data = s->timer.data = s;
    s->open = true;
    look(s, true);
    return 0;
}

static void
on_closed(uv_handle_t *h)
{
    struct pointstream *s = h->data;

    s->open = false;
}

void
pointstream_close(struct pointstream *s)
{
    if (s->open) {
        look(s, false);
        uv_close((uv_handle_t *)&s->poll, NULL);
        uv_close((uv_handle_t *)&s->timer, on_closed);
        while (s->open)
            uv_run(s->loop, UV_RUN_ONCE);
    }
    pointfile_release(&s->in);
    free(s->rest);
    memset(s, 0, sizeof *s);
}

/* --- batches --- */

static void
on_time(uv_timer_t *t)
{
    (void)t; /* only to make the loop return */
}

static bool
has_direction(const double point[6])
{
    return point[3] != 0 || point[4] != 0 || point[5] != 0;
}

/* Does the writer ask for its answers?  It does so as with rtrace: by a point
 * without a direction behind others, or where -x says how many it writes.  More
 * than one point without a direction are the outside of a round picture. */
static bool
is_asked(const struct pointstream *s)
{
    const struct pointfile *in = &s->in;
    uint32_t n = in->n;

    if (s->flush > 0 && (in->taken + n) % s->flush == 0)
        return true;
    return n > 1 && !has_direction(in->point[n - 1]) &&
           has_direction(in->point[n - 2]);
}

uint64_t
pointstream_due_in(const struct pointstream *s)
{
    uint64_t now = uv_now(s->loop), latest = s->first_ms + LATEST_MS, pause;

    if (s->ended || s->in.n >= s->size)
        return 0;
    pause = s->last_ms + (is_asked(s) ? ASKED_MS : PAUSE_MS);
    pause = pause < latest ? pause : latest;
    return pause > now ? pause - now : 0;
}

void
pointstream_wait(struct pointstream *s, const int *wake)
{
    uv_update_time(s->loop);
    while (*wake == 0 && !s->ended &&
           (s->in.n == 0 || pointstream_due_in(s) > 0)) {
        if (s->in.n > 0)
            uv_timer_start(&s->timer, on_time, pointstream_due_in(s), 0);
        uv_run(s->loop, UV_RUN_ONCE);
    }
    uv_timer_stop(&s->timer);
}

int
pointstream_take(struct pointstream *s, struct pointfile *batch,
                 struct rad_error *err)
{
    uint32_t n = s->in.n < s->size ? s->in.n : s->size;
    int rc = pointfile_take(&s->in, n, batch, err);

    if (n == s->size && s->size < POINTSTREAM_MOST)
        s->size *= 4;
    if (!s->ended && s->in.n < POINTSTREAM_MOST)
        look(s, true);
    return rc;
}
