/* fuzz_worker.c - a worker that hears anything from its coordinator, a peer and
 * its child
 *
 * Each input is a row of steps (steps.h); bytes go to the frame reader of who
 * speaks.  The worker may hang up, but must keep its word: no action on a
 * connection that is closed. */
#include "config.h"

#include "proto/frame.h"
#include "steps.h"
#include "worker/worker.h"
#include "tests/fuzz/fuzz.h"

#include <stdlib.h>
#include <string.h>

/* the coordinator, a child that was spawned, a peer that was dialled, one that
 * called */
enum { COORD, CHILD, DIALLED, CALLER, ENDS };
#define CALLER_ID 7

struct end {
    uint64_t id; /* 0: none */
    bool up;     /* the connection is there */
    struct frame_reader reader;
};

struct session {
    struct worker *worker;
    struct end ends[ENDS];
    uint64_t now_ms, next_caller;
    bool stopped;
};

static struct end *
end_of(struct session *s, uint64_t id)
{
    for (int i = 0; i < ENDS; i++)
        if (s->ends[i].id == id)
            return &s->ends[i];
    return NULL;
}

static void
set_end(struct end *e, uint64_t id, bool up, enum msg_session session)
{
    frame_reader_release(&e->reader);
    frame_reader_init(&e->reader, session);
    e->id = id;
    e->up = up;
}

static void
carry_out_one(struct session *s, const struct action *a)
{
    struct end *e = end_of(s, a->conn);

    switch (a->type) {
    case ACT_SEND:
    case ACT_SESSION:
        if (e && !e->up)
            abort(); /* to one that was never there */
        if (e && a->type == ACT_SEND)
            steps_say((unsigned)(e - s->ends), "is told",
                      msg_name((uint16_t)(a->bytes[4] << 8 | a->bytes[5])));
        if (e && a->type == ACT_SESSION)
            e->reader.session = a->session;
        break;
    case ACT_DIAL:
        if ((a->token != NULL) != (a->job != NULL))
            abort();
        set_end(&s->ends[a->token ? DIALLED : COORD], a->conn, false,
                MSG_AT_DIALLER);
        break;
    case ACT_SPAWN:
        set_end(&s->ends[CHILD], a->conn, true, MSG_AT_PARENT_NEW);
        break;
    case ACT_CLOSE:
    case ACT_KILL:
        if (e)
            steps_say((unsigned)(e - s->ends), "is let go", "");
        if (e)
            e->id = 0;
        break;
    case ACT_STOP:
        steps_say(COORD, "stops it", "");
        s->stopped = true;
        break;
    default:
        break;
    }
}

static void
carry_out(struct session *s)
{
    struct action_list *l = worker_actions(s->worker);

    for (size_t i = 0; i < l->n; i++)
        carry_out_one(s, &l->v[i]);
    if (l->failed)
        abort();
    actions_clear(l);
}

static void
lose(struct session *s, int i)
{
    uint64_t id = s->ends[i].id;

    if (id == 0)
        return;
    s->ends[i].id = 0;
    if (i == CHILD)
        worker_child_ended(s->worker, s->now_ms, id, false, "killed");
    else
        worker_closed(s->worker, s->now_ms, id, "closed");
    carry_out(s);
}

/* Make sure that somebody is there to speak, as far as we decide it. */
static void
bring_up(struct session *s, int i)
{
    struct end *e = &s->ends[i];

    if (i == CALLER && e->id == 0) {
        set_end(e, CALLER_ID + s->next_caller++, true, MSG_AT_PEER_NEW);
        worker_accepted(s->worker, s->now_ms, e->id);
    } else if (e->id != 0 && !e->up) {
        e->up = true;
        worker_opened(s->worker, s->now_ms, e->id);
    }
    carry_out(s);
}

static void
hear(struct session *s, int i, const uint8_t *p, size_t n, struct msg *m)
{
    struct end *e = &s->ends[i];
    uint64_t id = e->id;
    struct rad_error err = { 0 };
    int rc = 0;

    while (id != 0 && e->id == id &&
           (rc = frame_read(&e->reader, &p, &n, m, &err)) == 1) {
        steps_say((unsigned)i, "says", msg_name(m->type));
        worker_message(s->worker, s->now_ms, id, m);
        carry_out(s);
    }
    if (rc < 0 && e->id == id) {
        steps_say((unsigned)i, "breaks the protocol:", err.what);
        lose(s, i);
    }
}

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct worker_env env = { .has_file = steps_has_file,
                              .random = steps_no_random,
                              .program = "radd",
                              .name = "w",
                              .address = "tcp 127.0.0.1:1",
                              .threads = 2 };
    struct session s = { .worker = worker_new(&env), .now_ms = 1 };
    struct msg m = { 0 };
    struct step step;
    size_t at = 0;

    if (!s.worker)
        return 0;
    worker_start(s.worker, s.now_ms);
    carry_out(&s);
    while (!s.stopped && step_next(&step, data, size, &at)) {
        int i = (int)step.who;

        s.now_ms += step.ms;
        bring_up(&s, i);
        if (step.what == STEP_LOSE)
            lose(&s, i);
        else if (step.what == STEP_TICK)
            worker_tick(s.worker, s.now_ms);
        else
            hear(&s, i, step.p, step.n, &m);
        carry_out(&s);
    }
    for (int i = 0; i < ENDS; i++)
        frame_reader_release(&s.ends[i].reader);
    msg_release(&m);
    worker_free(s.worker);
    return 0;
}
