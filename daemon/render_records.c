/* render_records.c - ambient records on their way out of a job's child and in
 *
 * Those that its threads made are collected every few ms; those that arrive are
 * put into the cache by the loop's thread while the others go on. */
#include "config.h"

#include "render_impl.h"

#include <stdlib.h>

/* Eight workers with a fifth of a processor each made 19 % of an office's
 * records twice at 40 ms, 14 % at 10 ms and 9 % at 2 ms, in the same time.
 * Nearly all of these are deep ones of the first half second, when all are at
 * the whole room at once. */
#define DRAIN_MS 2
/* A record is needed elsewhere soon, or not for long: later they may wait for
 * such a part of the time since the first, and go out together.  A message
 * costs all whom it goes through 40 microseconds for each that gets it, which
 * is as much as making a deep record; and by then hardly one in a hundred is
 * made again while it waits.  Workers that are at the same unit do not wait for
 * so long. */
#define DRAIN_PART 50
#define CALM_MS    200
#define TWIN_MS    20
/* Looking up whether a record was needed costs more than putting it in, so one
 * of so many is looked up and stands for the others. */
#define METER_EACH 8

/* Somebody who is being sent all records. */
struct give {
    struct give *next;
    uint32_t to;
    uint64_t cursor;
};

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
    while (r->gives && r->link && conn_queued(r->link) < RENDER_AHEAD) {
        struct give *g = r->gives;
        size_t n =
            rad_ambient_list(r->job->ambient, &g->cursor, recs, RENDER_BATCH);

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
    uint64_t most = r->twin ? TWIN_MS : CALM_MS;

    return ms < DRAIN_MS ? DRAIN_MS : ms > most ? most : ms;
}

/* Send what the threads have made since the last call. */
void
render_drain(struct render *r)
{
    struct rad_ambrec recs[RENDER_BATCH];
    size_t n;

    while (r->link &&
           (n = rad_ambient_drain(r->job->ambient, recs, RENDER_BATCH)) > 0) {
        send_batch(r, 0, recs, n);
        if (r->first_ms == 0)
            r->first_ms = uv_now(&r->loop);
    }
}

static void
on_drain(uv_timer_t *timer)
{
    struct render *r = timer->data;
    struct rad_ambrec recs[RENDER_BATCH];

    render_drain(r);
    go_on_giving(r, recs);
    if (!r->ended)
        uv_timer_start(timer, on_drain, drain_ms(r), 0);
}

void
render_take_ambient(struct render *r, const struct msg_ambient *a)
{
    struct rad_ambrec recs[RAD_AMBIENT_TOGETHER];
    struct wire_in in;
    size_t n = 0;

    if (!r->job || !r->job->ambient)
        return;
    wire_in_init(&in, a->data, a->len);
    for (uint32_t i = 0; i < a->count && !in.bad; i++) {
        if (!ambshare_unpack(&in, &recs[n]))
            continue;
        if (r->received++ % METER_EACH == 0 &&
            rad_ambient_covers(r->job->ambient, &recs[n]))
            r->redundant += METER_EACH;
        if (++n < RAD_AMBIENT_TOGETHER)
            continue;
        rad_ambient_insert_all(r->job->ambient, recs, n);
        n = 0;
    }
    rad_ambient_insert_all(r->job->ambient, recs, n);
}

void
render_take_give(struct render *r, const struct msg_give *m)
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

void
render_records_begin(struct render *r)
{
    uv_timer_start(&r->drain, on_drain, DRAIN_MS, 0);
}

void
render_records_again(struct render *r)
{
    for (struct give *g = r->gives; g; g = g->next)
        g->cursor = r->loaded;
    /* an empty cache again, in which much is wanted by several at once */
    r->first_ms = 0;
    if (r->share || r->records)
        render_records_begin(r);
}

void
render_records_release(struct render *r)
{
    while (r->gives) {
        struct give *g = r->gives;

        r->gives = g->next;
        free(g);
    }
}
