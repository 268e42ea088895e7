/* render_records.c - ambient records that leave a job's child, and that come
 *
 * Records that render threads made are collected every few ms.  The loop thread
 * puts records that arrive into the cache, while render threads go on. */
#include "config.h"

#include "child/render_impl.h"

/* Another worker needs a record soon, or not for long.  So records wait for
 * 1 / DRAIN_PART of the time since the first record, within DRAIN_MS and
 * CALM_MS, and are sent together: a message costs the machines on its way 40
 * microseconds for each receiver, half the cost of a deep record.  Workers that
 * look at the same things make more records twice.  They see that by the
 * records that arrive, and send sooner while more than FEW of these are
 * redundant. */
#define DRAIN_MS   2
#define DRAIN_PART 20
#define CALM_MS    200
#define FEW        .01
/* Records of a worker that borrowed columns wait no longer than this. */
#define LOAN_MS 20
/* Records of which one is looked up, to see whether it was redundant: that
 * costs more than to insert it. */
#define METER_EACH 8
/* About how many look-ups the share of redundant records is a mean of. */
#define METER_MEAN 32

static void
send_batch(struct render *r, const struct rad_ambrec *recs, size_t n)
{
    struct msg m = { .type = MSG_AMBIENT };
    struct wire_out w;

    wire_out_init(&w, MSG_MAX_AMBIENT);
    for (size_t i = 0; i < n; i++)
        ambshare_pack(&w, &recs[i]);
    m.ambient.count = (uint32_t)n;
    m.ambient.data = w.buf;
    m.ambient.len = w.len;
    if (!w.bad && conn_send(r->link, &m) && r->share)
        r->sent += n;
    wire_out_release(&w);
}

/* How long to wait before records are sent again. */
static uint64_t
drain_ms(const struct render *r)
{
    uint64_t most = r->borrowed ? LOAN_MS : CALM_MS;
    double ms =
        r->first_ms ? (double)(uv_now(&r->loop) - r->first_ms) / DRAIN_PART : 0;

    ms = ms < (double)most ? ms : (double)most;
    if (r->doubled > FEW)
        ms *= FEW / r->doubled;
    return ms > DRAIN_MS ? (uint64_t)ms : DRAIN_MS;
}

void
render_drain(struct render *r)
{
    struct rad_ambrec recs[RENDER_BATCH];
    size_t n;

    while (r->link &&
           (n = rad_ambient_drain(r->job->ambient, recs, RENDER_BATCH)) > 0) {
        send_batch(r, recs, n);
        if (r->first_ms == 0)
            r->first_ms = uv_now(&r->loop);
    }
}

static void
on_drain(uv_timer_t *timer)
{
    struct render *r = timer->data;

    render_drain(r);
    if (!r->ended)
        uv_timer_start(timer, on_drain, drain_ms(r), 0);
}

/* Look up whether the record was redundant.  It counts for METER_EACH records.
 */
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

    /* a cache in passes changes by FROZEN alone: threads read it meanwhile */
    if (!r->job || !r->job->ambient || rad_ambient_is_frozen(r->job->ambient))
        return;
    wire_in_init(&in, a->data, a->len);
    for (uint32_t i = 0; i < a->count && !in.bad; i++) {
        if (!ambshare_unpack(&in, &recs[n]))
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

void
render_records_begin(struct render *r)
{
    uv_timer_start(&r->drain, on_drain, DRAIN_MS, 0);
}

void
render_records_again(struct render *r)
{
    /* into an empty cache, several workers want the same records at once */
    r->first_ms = 0;
    r->doubled = 0;
    if (r->share || r->records)
        render_records_begin(r);
}
