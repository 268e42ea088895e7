/* fuzz_session.c - a coordinator that hears anything from a worker and a user
 *
 * Each input is a row of steps (steps.h); bytes go to the frame reader of one
 * of four connections.  The coordinator may refuse, but must keep its word: no
 * action on a connection that it closed. */
#include "config.h"

#include "front/coord.h"
#include "proto/ambshare.h"
#include "proto/frame.h"
#include "steps.h"
#include "tests/fuzz/fuzz.h"

#include <stdlib.h>
#include <string.h>

enum { CONNS = 4 };

struct session {
    struct coord *coord;
    struct frame_reader reader[CONNS];
    bool open[CONNS];
    uint64_t now_ms;
};

static const char *
type_name(const struct action *a)
{
    return msg_name((uint16_t)(a->bytes[4] << 8 | a->bytes[5]));
}

/* Two records, of which nobody looks at the bytes. */
static void
load_cache(struct session *s, const struct action *a)
{
    struct saved_cache cache = { .records = calloc(2, AMBSHARE_BYTES),
                                 .len = (size_t)2 * AMBSHARE_BYTES };

    if (!cache.records)
        abort();
    coord_cache_came(s->coord, s->now_ms, a->job, a->sequence, &cache);
}

/* What a store that keeps all does at once. */
static void
store(struct session *s, const struct action *a)
{
    struct saved_job saved;

    if (a->type == ACT_SETTLE)
        coord_settled(s->coord, s->now_ms, a->conn, a->request);
    else if (a->type == ACT_LOAD_CACHE)
        load_cache(s, a);
    else if (a->type == ACT_JOB_END && coord_saved(s->coord, a->job, &saved))
        coord_job_filed(s->coord, s->now_ms, a->job, a->sequence, 100,
                        saved.cache_bytes);
    else if (a->type == ACT_DROP_CACHE)
        coord_job_filed(s->coord, s->now_ms, a->job, a->sequence, 50, 0);
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
        if (a.type == ACT_SESSION) {
            s->reader[a.conn - 1].session = a.session;
            s->reader[a.conn - 1].version = a.version;
        } else if (a.type == ACT_SEND) {
            steps_say((unsigned)a.conn - 1, "is told", type_name(&a));
        } else if (a.type == ACT_CLOSE) {
            steps_say((unsigned)a.conn - 1, "is let go", "");
            s->open[a.conn - 1] = false;
        }
        if (a.type == ACT_JOB_OPEN)
            coord_job_opened(s->coord, s->now_ms, a.job, a.sequence, 0, NULL);
        else if (a.type == ACT_PUT_ROWS)
            coord_rows_stored(s->coord, s->now_ms, &a.rows, 0, NULL);
        else if (a.type == ACT_WRITE_PICTURE)
            coord_picture_written(s->coord, s->now_ms, a.job, a.sequence,
                                  a.frame, 0, NULL);
        else
            store(s, &a);
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

/* Files that are there are the submitting user's own: without that a job of
 * theirs would wait for ever. */
static void
send_files(struct session *s, unsigned i, const struct msg_hashes *files)
{
    for (uint32_t k = 0; k < files->n; k++) {
        const uint8_t *hash = files->hash + (size_t)k * MSG_HASH;

        if (s->open[i] && steps_has_file(NULL, hash))
            coord_file_stored(s->coord, s->now_ms, i + 1, hash);
        carry_out(s);
    }
}

static void
hear(struct session *s, unsigned i, const uint8_t *p, size_t n, struct msg *m)
{
    struct rad_error err = { 0 };
    int rc = 0;

    while (s->open[i] &&
           (rc = frame_read(&s->reader[i], &p, &n, m, &err)) == 1) {
        steps_say(i, "says", msg_name(m->type));
        if (m->type == MSG_SUBMIT)
            send_files(s, i, &m->submit.files);
        coord_message(s->coord, s->now_ms, i + 1, m);
        carry_out(s);
    }
    if (s->open[i] && rc < 0) {
        steps_say(i, "breaks the protocol:", err.what);
        s->open[i] = false;
        coord_closed(s->coord, s->now_ms, i + 1, "malformed");
        carry_out(s);
    }
}

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct coord_env env = { .has_file = steps_has_file,
                             .random = steps_no_random,
                             .arg = NULL,
                             .program = "radcoord",
                             .keeps = true,
                             .epoch = 1 };
    struct session s = { .coord = coord_new(&env), .now_ms = 1 };
    struct msg m = { 0 };
    struct step step;
    size_t at = 0;

    while (s.coord && step_next(&step, data, size, &at)) {
        unsigned i = step.who;

        s.now_ms += step.ms;
        open_conn(&s, i);
        if (step.what == STEP_LOSE) {
            s.open[i] = false;
            coord_closed(s.coord, s.now_ms, i + 1, "closed");
        } else if (step.what == STEP_TICK) {
            coord_tick(s.coord, s.now_ms);
        } else {
            hear(&s, i, step.p, step.n, &m);
        }
        carry_out(&s);
    }
    for (int i = 0; i < CONNS; i++)
        frame_reader_release(&s.reader[i]);
    msg_release(&m);
    coord_free(s.coord);
    return 0;
}
