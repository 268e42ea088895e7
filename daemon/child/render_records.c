/* render_records.c - ambient records on their way out of a job's child and in
 *
 * Those that its threads made are collected every few ms; those that arrive are
 * put into the cache by the loop's thread while the others go on. */
#include "config.h"

#include "child/render_impl.h"

#include <stdlib.h>

/* A record is needed elsewhere soon, or not for long: so they wait for such a
 * part of the time since the first, within these bounds, and go out together.
 * A message costs all whom it goes through 40 microseconds for each that gets
 * it, half of what making a deep record does.  Where workers are at the same
 * things more is made twice; they see that by what arrives, and wait less, as
 * long as more than such a share of it is redundant.
 * Eight workers with a fifth of a processor each, at 1920 x 1280 pixels of an
 * office, sent 280 messages each and made 4 to 9 % twice when they waited for a
 * fiftieth and did not seed the cache (src/picture/seed.h); now it is 2.5 to
 * 4 %, and 1 to 2.5 % more of their processors is left for rays. */
#define DRAIN_MS   2
#define DRAIN_PART 20
#define CALM_MS    200
#define FEW        .01
/* Workers that are at the same unit do not wait for longer. */
#define TWIN_MS 20
/* While the cache is seeded others want the records of their own parts. */
#define SEED_MS 10
/* Looking up whether a record was needed costs more than putting it in, so one
 * of so many is looked up and stands for the others. */
#define METER_EACH 8
/* The mean of about so many says how things are now. */
#define METER_MEAN 32

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
    for (size_t i = 0; i < n; i++) {
        size_t at = w.len;

        ambshare_pack(&w, &recs[i]);
        if (r->share && to == 0 && !w.bad) /* one may be given it back */
            ambseen_add(&r->seen, w.buf + at);
    }
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
    uint64_t least = r->seeding ? SEED_MS : DRAIN_MS;
    uint64_t most = r->twin ? TWIN_MS : CALM_MS;
    double ms =
        r->first_ms ? (double)(uv_now(&r->loop) - r->first_ms) / DRAIN_PART : 0;

    ms = ms < (double)most ? ms : (double)most;
    if (r->doubled > FEW)
        ms *= FEW / r->doubled;
    return ms > (double)least ? (uint64_t)ms : least;
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

/* Was it needed?  It stands for those that are not looked up. */
static void
meter(struct render *r, const struct rad_ambrec *rec)
{
    bool redundant = rad_ambient_covers(r->job->ambient, rec);

    if (redundant)
        r->redundant += METER_EACH;
    r->doubled += ((redundant ? 1 : 0) - r->doubled) / METER_MEAN;
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
        const uint8_t *bytes = a->data + (size_t)i * AMBSHARE_BYTES;

        if (!ambshare_unpack(&in, &recs[n]) || !ambseen_add(&r->seen, bytes))
            continue;
        if (r->received++ % METER_EACH == 0)
            meter(r, &recs[n]);
        if (++n < RAD_AMBIENT_TOGETHER)
            continue;
        rad_ambient_insert_all(r->job->ambient, recs, n);
        n = 0;
    }
    rad_ambient_insert_all(r->job->ambient, recs, n);
}

/* What is left goes out at once: others may wait for it by now. */
static void
on_seeded(void *arg)
{
    struct render *r = arg;

    r->seeding = false;
    if (!r->link)
        return;
    render_drain(r);
    uv_timer_start(&r->drain, on_drain, drain_ms(r), 0);
}

void
render_begin_seed(struct render *r, uint32_t frame)
{
    bool fresh = r->start.job_start.flags & MSG_JOB_FRESH_FRAMES;
    uint32_t first = fresh ? frame : 0, n = fresh ? 1 : r->nframes;
    struct rad_seed *s;

    /* with a file of records most is there */
    if (r->seed.last == 0 || r->loaded > 0 ||
        !rad_seed_wanted(&r->frames[first], n))
        return;
    s = rad_seed_new(&r->frames[first], n, (double)r->seed.first / MSG_SEED_ALL,
                     (double)r->seed.last / MSG_SEED_ALL, NULL);
    if (!s)
        return; /* they are made when they are asked for */
    r->seeding = true;
    pool_seed(r->pool, s, on_seeded);
}

void
render_take_seed(struct render *r, const struct msg_seed *m)
{
    if (!r->share || r->seed.last > 0 || r->frame != r->nframes)
        return;
    r->seed = *m;
    r->seed.job = NULL;
    render_begin_seed(r, 0);
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
    ambseen_release(&r->seen);
    /* an empty cache again, in which much is wanted by several at once */
    r->first_ms = 0;
    r->doubled = 0;
    if (r->share || r->records)
        render_records_begin(r);
}

void
render_records_release(struct render *r)
{
    ambseen_release(&r->seen);
    while (r->gives) {
        struct give *g = r->gives;

        r->gives = g->next;
        free(g);
    }
}
