/* fuzz_session.c - a coordinator that hears anything from a worker and a user
 *
 * Each input is a row of steps: a byte that says what happens (its low bits:
 * which connection), then, for a message, bytes for its frame reader up to the
 * length in the next two bytes.  The coordinator may refuse, but must keep its
 * word: no action on a connection that it closed. */
#include "config.h"

#include "coord.h"
#include "frame.h"

#include <stdlib.h>
#include <string.h>

enum { CONNS = 4 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

struct session {
    struct coord *coord;
    struct frame_reader reader[CONNS];
    bool open[CONNS];
    uint64_t now_ms;
};

static bool
has_file(void *arg, const uint8_t hash[MSG_HASH])
{
    (void)arg;
    return hash[0] & 1;
}

static void
no_random(void *arg, void *buf, size_t n)
{
    (void)arg;
    memset(buf, 7, n);
}

static void
carry_out(struct session *s)
{
    struct action_list *l = coord_actions(s->coord);

    for (size_t i = 0; i < l->n; i++) {
        struct action a = l->v[i];

        if (a.type == ACT_SEND || a.type == ACT_SESSION || a.type == ACT_CLOSE)
            if (a.conn < 1 || a.conn > CONNS || !s->open[a.conn - 1])
                abort();
        if (a.type == ACT_SESSION)
            s->reader[a.conn - 1].session = a.session;
        else if (a.type == ACT_CLOSE)
            s->open[a.conn - 1] = false;
        else if (a.type == ACT_JOB_OPEN)
            coord_job_opened(s->coord, s->now_ms, a.job, 0, NULL);
        else if (a.type == ACT_PUT_ROWS)
            coord_rows_stored(s->coord, s->now_ms, &a.rows, 0, NULL);
        else if (a.type == ACT_WRITE_PICTURE)
            coord_picture_written(s->coord, s->now_ms, a.job, a.frame, 0, NULL);
    }
    if (l->failed)
        abort();
    actions_clear(l);
}

static void
open_conn(struct session *s, unsigned i)
{
    struct coord_peer peer = { "fuzz", "ana", 14, NULL };

    if (s->open[i])
        return;
    frame_reader_release(&s->reader[i]);
    frame_reader_init(&s->reader[i], MSG_AT_COORD_NEW);
    s->open[i] = true;
    coord_opened(s->coord, s->now_ms, i + 1, &peer);
    carry_out(s);
}

static void
hear(struct session *s, unsigned i, const uint8_t *p, size_t n, struct msg *m)
{
    int rc = 0;

    while (s->open[i] &&
           (rc = frame_read(&s->reader[i], &p, &n, m, NULL)) == 1) {
        coord_message(s->coord, s->now_ms, i + 1, m);
        carry_out(s);
    }
    if (s->open[i] && rc < 0) {
        s->open[i] = false;
        coord_closed(s->coord, s->now_ms, i + 1, "malformed");
        carry_out(s);
    }
}

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct coord_env env = { .has_file = has_file,
                             .random = no_random,
                             .arg = NULL,
                             .program = "radcoord",
                             .epoch = 1 };
    struct session s = { .coord = coord_new(&env), .now_ms = 1 };
    struct msg m = { 0 };

    for (size_t at = 0; s.coord && at < size;) {
        unsigned what = data[at] >> 2, i = data[at] & 3;
        size_t n;

        at++;
        s.now_ms += 50;
        open_conn(&s, i);
        if (what == 63) {
            s.open[i] = false;
            coord_closed(s.coord, s.now_ms, i + 1, "closed");
        } else if (what == 62) {
            coord_tick(s.coord, s.now_ms);
        } else if (size - at >= 2) {
            n = (size_t)data[at] << 8 | data[at + 1];
            at += 2;
            if (n > size - at)
                n = size - at;
            hear(&s, i, data + at, n, &m);
            at += n;
        }
        carry_out(&s);
    }
    for (int i = 0; i < CONNS; i++)
        frame_reader_release(&s.reader[i]);
    msg_release(&m);
    coord_free(s.coord);
    return 0;
}
