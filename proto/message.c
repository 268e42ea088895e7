/* message.c - the codec of every message
 *
 * A pair of short functions per body, entered by message.def in one table;
 * those of the messages by which workers share a picture are in sharing.c.
 * Readers rely on wire_in's sticky error: a range that is wrong sets it. */
#include "config.h"

#include "message.h"

#include "codec.h"
#include "frame.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

/* --- session --- */

unsigned
msg_common_version(unsigned min, unsigned max)
{
    unsigned highest = max < MSG_VERSION ? max : MSG_VERSION;

    return highest < min || highest < MSG_VERSION_MIN ? 0 : highest;
}

static void
msg_pack_hello(struct wire_out *o, const struct msg_hello *b)
{
    wire_put_u16(o, b->min);
    wire_put_u16(o, b->max);
    wire_put_u8(o, b->role);
    wire_put_str(o, b->name, MSG_MAX_NAME);
    wire_put_str(o, b->program, MSG_MAX_NAME);
    wire_put_str(o, b->address, MSG_MAX_ADDRESS);
    wire_put_u16(o, b->threads);
    wire_put_u64(o, b->fingerprint);
}

static void
msg_unpack_hello(struct wire_in *in, struct msg_hello *b, struct msg *m)
{
    (void)m;
    b->min = wire_get_u16(in);
    b->max = wire_get_u16(in);
    b->role = wire_get_u8(in);
    if (msg_common_version(b->min, b->max) == 0) {
        b->name = b->program = b->address = "";
        wire_get_view(in, wire_left(in));
        return;
    }
    msg_must(in, b->role >= MSG_ROLE_WORKER && b->role <= MSG_ROLE_ADMIN);
    b->name = wire_get_str(in, MSG_MAX_NAME);
    b->program = wire_get_str(in, MSG_MAX_NAME);
    b->address = wire_get_str(in, MSG_MAX_ADDRESS);
    b->threads = wire_get_u16(in);
    b->fingerprint = wire_get_u64(in);
}

static void
msg_pack_welcome(struct wire_out *o, const struct msg_welcome *b)
{
    wire_put_u16(o, b->version);
    wire_put_u64(o, b->epoch);
    wire_put_str(o, b->program, MSG_MAX_NAME);
}

static void
msg_unpack_welcome(struct wire_in *in, struct msg_welcome *b, struct msg *m)
{
    (void)m;
    b->version = wire_get_u16(in);
    b->epoch = wire_get_u64(in);
    b->program = wire_get_str(in, MSG_MAX_NAME);
}

static void
msg_pack_refuse(struct wire_out *o, const struct msg_refuse *b)
{
    wire_put_u16(o, b->status);
    wire_put_str(o, b->text, MSG_MAX_TEXT);
}

static void
msg_unpack_refuse(struct wire_in *in, struct msg_refuse *b, struct msg *m)
{
    (void)m;
    b->status = wire_get_u16(in);
    b->text = wire_get_str(in, MSG_MAX_TEXT);
}

static void
msg_pack_ping(struct wire_out *o, const struct msg_ping *b)
{
    wire_put_u64(o, b->progress);
}

static void
msg_unpack_ping(struct wire_in *in, struct msg_ping *b, struct msg *m)
{
    (void)m;
    b->progress = wire_get_u64(in);
}

static void
msg_pack_bye(struct wire_out *o, const struct msg_bye *b)
{
    wire_put_str(o, b->text, MSG_MAX_TEXT);
}

static void
msg_unpack_bye(struct wire_in *in, struct msg_bye *b, struct msg *m)
{
    (void)m;
    b->text = wire_get_str(in, MSG_MAX_TEXT);
}

/* --- store --- */

static void
msg_pack_hashes(struct wire_out *o, const struct msg_hashes *b)
{
    msg_put_must(o, b->n <= MSG_MAX_FILES);
    if (o->bad)
        return;
    wire_put_u32(o, b->n);
    wire_put_bytes(o, b->hash, (size_t)b->n * MSG_HASH);
}

static void
msg_unpack_hashes(struct wire_in *in, struct msg_hashes *b, struct msg *m)
{
    (void)m;
    b->n = wire_get_count(in, MSG_HASH, MSG_MAX_FILES);
    b->hash = wire_get_view(in, (size_t)b->n * MSG_HASH);
}

static bool
chunk_fits(const struct msg_chunk *b)
{
    return b->offset <= b->total && b->len <= b->total - b->offset &&
           (b->len > 0 || b->total == 0);
}

static void
msg_pack_chunk(struct wire_out *o, const struct msg_chunk *b)
{
    msg_put_must(o, chunk_fits(b));
    msg_put_hash(o, b->hash);
    wire_put_u64(o, b->offset);
    wire_put_u64(o, b->total);
    wire_put_blob(o, b->data, b->len, MSG_MAX_CHUNK);
}

static void
msg_unpack_chunk(struct wire_in *in, struct msg_chunk *b, struct msg *m)
{
    (void)m;
    b->hash = wire_get_view(in, MSG_HASH);
    b->offset = wire_get_u64(in);
    b->total = wire_get_u64(in);
    b->data = wire_get_blob(in, MSG_MAX_CHUNK, &b->len);
    msg_must(in, chunk_fits(b));
}

static void
msg_pack_have(struct wire_out *o, const struct msg_have *b)
{
    msg_put_hash(o, b->hash);
}

static void
msg_unpack_have(struct wire_in *in, struct msg_have *b, struct msg *m)
{
    (void)m;
    b->hash = wire_get_view(in, MSG_HASH);
}

/* --- jobs --- */

#define FRAME_MIN 15 /* bytes of a frame with an empty view */

static bool
frame_fits(const struct msg_frame *f)
{
    return f->width >= 1 && f->width <= MSG_MAX_SIDE && f->height >= 1 &&
           f->height <= MSG_MAX_SIDE;
}

static void
msg_pack_frames(struct wire_out *o, const struct msg_spec *b)
{
    msg_put_must(o, b->nframes >= 1 && b->nframes <= MSG_MAX_FRAMES);
    wire_put_u32(o, b->nframes);
    for (uint32_t i = 0; i < b->nframes && !o->bad; i++) {
        const struct msg_frame *f = &b->frames[i];

        msg_put_must(o, frame_fits(f));
        wire_put_u32(o, f->number);
        wire_put_u32(o, f->width);
        wire_put_u32(o, f->height);
        wire_put_str(o, f->view, MSG_MAX_VIEW);
    }
}

static void
msg_unpack_frames(struct wire_in *in, struct msg_spec *b, struct msg *m)
{
    struct msg_frame *f;

    b->nframes = wire_get_count(in, FRAME_MIN, MSG_MAX_FRAMES);
    msg_must(in, b->nframes >= 1);
    b->frames = f = msg_list_room(m, in, b->nframes, sizeof *f);
    if (!f)
        b->nframes = 0;
    for (uint32_t i = 0; i < b->nframes; i++) {
        f[i].number = wire_get_u32(in);
        f[i].width = wire_get_u32(in);
        f[i].height = wire_get_u32(in);
        f[i].view = wire_get_str(in, MSG_MAX_VIEW);
        msg_must(in, frame_fits(&f[i]));
    }
}

/* The flags that a version has. */
static uint32_t
job_flags(unsigned version)
{
    return version < 2 ? MSG_JOB_FLAGS_1 : MSG_JOB_FLAGS;
}

static bool
spec_fits(const struct msg_spec *b, uint32_t flags)
{
    return (b->flags & ~flags) == 0 && b->partition < MSG_NPART &&
           b->order < MSG_NORDER;
}

/* Each a number, and not below 0. */
static bool
costs_fit(const struct msg_spec *b)
{
    for (uint32_t i = 0; i < b->ncosts; i++) {
        float cost;

        wire_floats_get(&cost, b->costs + (size_t)i * 4, 1);
        if (!(cost >= 0 && cost <= FLT_MAX))
            return false;
    }
    return true;
}

static void
put_costs(struct wire_out *o, const struct msg_spec *b)
{
    msg_put_must(o, b->ncosts <= MSG_MAX_COSTS && costs_fit(b));
    if (o->bad)
        return;
    wire_put_u32(o, b->ncosts);
    wire_put_bytes(o, b->costs, (size_t)b->ncosts * 4);
}

static void
get_costs(struct wire_in *in, struct msg_spec *b)
{
    b->ncosts = wire_get_count(in, 4, MSG_MAX_COSTS);
    b->costs = wire_get_view(in, (size_t)b->ncosts * 4);
    msg_must(in, in->bad || costs_fit(b));
}

static void
msg_pack_spec(struct wire_out *o, const struct msg_spec *b)
{
    msg_put_must(o, spec_fits(b, MSG_JOB_FLAGS));
    /* who cannot code rows cannot work on that job */
    msg_put_must(o, o->version >= 2 || !(b->flags & MSG_JOB_CODED));
    msg_put_job(o, b->job);
    msg_put_hash(o, b->manifest);
    wire_put_str(o, b->name, MSG_MAX_NAME);
    wire_put_str(o, b->params, MSG_MAX_PARAMS);
    wire_put_str(o, b->needs, MSG_MAX_NEEDS);
    wire_put_str(o, b->estimate, MSG_MAX_NAME);
    put_costs(o, b);
    wire_put_u64(o, b->seed);
    wire_put_i32(o, b->priority);
    wire_put_u32(o, b->flags & job_flags(o->version));
    wire_put_u8(o, b->partition);
    wire_put_u8(o, b->order);
    wire_put_u32(o, b->windows);
    wire_put_u32(o, b->objects);
    wire_put_u64(o, b->bundle_bytes);
    wire_put_f64(o, b->compile_s);
    if (o->version >= 2)
        wire_put_u32(o, b->memory_mib);
    msg_pack_hashes(o, &b->files);
    msg_pack_frames(o, b);
}

static void
msg_unpack_spec(struct wire_in *in, struct msg_spec *b, struct msg *m)
{
    b->job = wire_get_view(in, MSG_JOB);
    b->manifest = wire_get_view(in, MSG_HASH);
    b->name = wire_get_str(in, MSG_MAX_NAME);
    b->params = wire_get_str(in, MSG_MAX_PARAMS);
    b->needs = wire_get_str(in, MSG_MAX_NEEDS);
    b->estimate = wire_get_str(in, MSG_MAX_NAME);
    get_costs(in, b);
    b->seed = wire_get_u64(in);
    b->priority = wire_get_i32(in);
    b->flags = wire_get_u32(in);
    b->partition = wire_get_u8(in);
    b->order = wire_get_u8(in);
    b->windows = wire_get_u32(in);
    b->objects = wire_get_u32(in);
    b->bundle_bytes = wire_get_u64(in);
    b->compile_s = wire_get_f64(in);
    if (in->version >= 2)
        b->memory_mib = wire_get_u32(in);
    msg_must(in, spec_fits(b, job_flags(in->version)) && b->compile_s >= 0);
    msg_unpack_hashes(in, &b->files, m);
    msg_unpack_frames(in, b, m);
}

static void
msg_pack_accept(struct wire_out *o, const struct msg_accept *b)
{
    msg_put_job(o, b->job);
    wire_put_u8(o, b->again);
}

static void
msg_unpack_accept(struct wire_in *in, struct msg_accept *b, struct msg *m)
{
    (void)m;
    b->job = wire_get_view(in, MSG_JOB);
    b->again = msg_get_below(in, 2);
}

/* A disk that is full is no state of version 1: the job waits. */
static uint8_t
state_as(unsigned version, uint8_t state)
{
    return version < 2 && state == MSG_STATE_HELD ? 0 : state;
}

static void
msg_pack_progress(struct wire_out *o, const struct msg_progress *b)
{
    msg_put_job(o, b->job);
    wire_put_u8(o, state_as(o->version, b->state));
    wire_put_u64(o, b->pixels_done);
    wire_put_u64(o, b->pixels_total);
    wire_put_u32(o, b->units_done);
    wire_put_u32(o, b->units_total);
    wire_put_u32(o, b->units_redone);
    wire_put_f64(o, b->cost_done);
    wire_put_f64(o, b->cost_total);
    wire_put_u64(o, b->rays);
    wire_put_u32(o, b->workers);
    wire_put_u32(o, b->frames_ready);
    wire_put_f64(o, b->elapsed_s);
    wire_put_u64(o, b->nan.pixels);
    wire_put_u32(o, b->nan.frame);
    wire_put_u32(o, b->nan.x);
    wire_put_u32(o, b->nan.y);
    msg_put_faults(o, b->faults);
    if (o->version >= 2)
        wire_put_f64(o, b->error);
}

static void
msg_unpack_progress(struct wire_in *in, struct msg_progress *b, struct msg *m)
{
    (void)m;
    b->job = wire_get_view(in, MSG_JOB);
    b->state = wire_get_u8(in);
    b->pixels_done = wire_get_u64(in);
    b->pixels_total = wire_get_u64(in);
    b->units_done = wire_get_u32(in);
    b->units_total = wire_get_u32(in);
    b->units_redone = wire_get_u32(in);
    b->cost_done = wire_get_f64(in);
    b->cost_total = wire_get_f64(in);
    b->rays = wire_get_u64(in);
    b->workers = wire_get_u32(in);
    b->frames_ready = wire_get_u32(in);
    b->elapsed_s = wire_get_f64(in);
    b->nan.pixels = wire_get_u64(in);
    b->nan.frame = wire_get_u32(in);
    b->nan.x = wire_get_u32(in);
    b->nan.y = wire_get_u32(in);
    msg_get_faults(in, b->faults);
    if (in->version >= 2)
        b->error = wire_get_f64(in);
}

static void
msg_pack_done(struct wire_out *o, const struct msg_done *b)
{
    msg_put_job(o, b->job);
    wire_put_u32(o, b->frames);
}

static void
msg_unpack_done(struct wire_in *in, struct msg_done *b, struct msg *m)
{
    (void)m;
    b->job = wire_get_view(in, MSG_JOB);
    b->frames = wire_get_u32(in);
}

static void
msg_pack_failed(struct wire_out *o, const struct msg_failed *b)
{
    msg_put_job(o, b->job);
    wire_put_u16(o, b->status);
    wire_put_str(o, b->text, MSG_MAX_TEXT);
}

static void
msg_unpack_failed(struct wire_in *in, struct msg_failed *b, struct msg *m)
{
    (void)m;
    b->job = wire_get_view(in, MSG_JOB);
    b->status = wire_get_u16(in);
    b->text = wire_get_str(in, MSG_MAX_TEXT);
}

static void
msg_pack_jobid(struct wire_out *o, const struct msg_jobid *b)
{
    msg_put_job(o, b->job);
}

static void
msg_unpack_jobid(struct wire_in *in, struct msg_jobid *b, struct msg *m)
{
    (void)m;
    b->job = wire_get_view(in, MSG_JOB);
}

static void
msg_pack_fetch(struct wire_out *o, const struct msg_fetch *b)
{
    msg_put_must(o, b->what < MSG_NWHAT);
    msg_put_job(o, b->job);
    wire_put_u32(o, b->frame);
    wire_put_u8(o, b->what);
}

static void
msg_unpack_fetch(struct wire_in *in, struct msg_fetch *b, struct msg *m)
{
    (void)m;
    b->job = wire_get_view(in, MSG_JOB);
    b->frame = wire_get_u32(in);
    b->what = msg_get_below(in, MSG_NWHAT);
}

static void
msg_pack_query(struct wire_out *o, const struct msg_query *b)
{
    msg_put_must(o, b->what < MSG_NQUERY);
    wire_put_u8(o, b->what);
    wire_put_str(o, b->text, MSG_MAX_NAME);
}

static void
msg_unpack_query(struct wire_in *in, struct msg_query *b, struct msg *m)
{
    (void)m;
    b->what = msg_get_below(in, MSG_NQUERY);
    b->text = wire_get_str(in, MSG_MAX_NAME);
}

static void
msg_pack_answer(struct wire_out *o, const struct msg_answer *b)
{
    wire_put_blob(o, b->text, b->len, MSG_MAX - 4);
}

static void
msg_unpack_answer(struct wire_in *in, struct msg_answer *b, struct msg *m)
{
    (void)m;
    b->text = wire_get_blob(in, MSG_MAX - 4, &b->len);
}

static void
msg_pack_key(struct wire_out *o, const struct msg_key *b)
{
    msg_put_must(o, b->what < MSG_NKEY);
    wire_put_u8(o, b->what);
    wire_put_str(o, b->name, MSG_MAX_KEY);
    wire_put_u64(o, b->expires);
}

static void
msg_unpack_key(struct wire_in *in, struct msg_key *b, struct msg *m)
{
    (void)m;
    b->what = msg_get_below(in, MSG_NKEY);
    b->name = wire_get_str(in, MSG_MAX_KEY);
    b->expires = wire_get_u64(in);
    msg_must(in, b->expires <= INT64_MAX);
}

static void
msg_pack_worker(struct wire_out *o, const struct msg_worker *b)
{
    wire_put_str(o, b->name, MSG_MAX_NAME);
}

static void
msg_unpack_worker(struct wire_in *in, struct msg_worker *b, struct msg *m)
{
    (void)m;
    b->name = wire_get_str(in, MSG_MAX_NAME);
}

/* --- work --- */

static void
msg_pack_ready(struct wire_out *o, const struct msg_ready *b)
{
    msg_put_job(o, b->job);
    wire_put_f64(o, b->load_s);
    wire_put_u64(o, b->fingerprint);
    wire_put_u16(o, b->threads);
}

static void
msg_unpack_ready(struct wire_in *in, struct msg_ready *b, struct msg *m)
{
    (void)m;
    b->job = wire_get_view(in, MSG_JOB);
    b->load_s = wire_get_f64(in);
    b->fingerprint = wire_get_u64(in);
    b->threads = wire_get_u16(in);
    msg_must(in, b->load_s >= 0 && b->threads >= 1);
}

/* Bytes of a RESULT's pixels; len is how many there may be of coded ones.
 * False when they cannot be. */
static bool
result_bytes(unsigned version, const struct msg_result *b, size_t len,
             size_t *n)
{
    if (b->rows < 1 || b->rows > MSG_MAX_SIDE || b->row > MSG_MAX_SIDE ||
        b->width < 1 || b->width > MSG_MAX_SIDE)
        return false;
    if (b->channels == 3 || b->channels == 4)
        *n = (size_t)b->rows * b->width * b->channels * 4; /* below 2^36 */
    else if (b->channels == 1 && version >= 2)
        *n = len;
    else
        return false;
    return *n > 0 && *n <= MSG_MAX_PIXELS;
}

static void
msg_pack_result(struct wire_out *o, const struct msg_result *b)
{
    size_t n;

    if (!result_bytes(o->version, b, b->len, &n)) {
        o->bad = true;
        return;
    }
    msg_put_job(o, b->job);
    wire_put_u32(o, b->unit);
    wire_put_u32(o, b->attempt);
    wire_put_u32(o, b->row);
    wire_put_u32(o, b->rows);
    wire_put_u32(o, b->width);
    wire_put_u8(o, b->channels);
    wire_put_u8(o, b->last);
    if (b->last)
        msg_put_counts(o, &b->counts);
    wire_put_bytes(o, b->pixels, n);
}

static void
msg_unpack_result(struct wire_in *in, struct msg_result *b, struct msg *m)
{
    size_t n;

    (void)m;
    b->job = wire_get_view(in, MSG_JOB);
    b->unit = wire_get_u32(in);
    b->attempt = wire_get_u32(in);
    b->row = wire_get_u32(in);
    b->rows = wire_get_u32(in);
    b->width = wire_get_u32(in);
    b->channels = wire_get_u8(in);
    b->last = msg_get_below(in, 2);
    if (b->last)
        msg_get_counts(in, &b->counts);
    if (result_bytes(in->version, b, wire_left(in), &n))
        b->pixels = wire_get_view(in, n);
    else
        in->bad = true;
    b->len = b->channels == 1 && b->pixels ? n : 0;
}

static void
msg_pack_ack(struct wire_out *o, const struct msg_ack *b)
{
    msg_put_job(o, b->job);
    wire_put_u32(o, b->unit);
    wire_put_u32(o, b->attempt);
    wire_put_u32(o, b->row);
    wire_put_u32(o, b->rows);
}

static void
msg_unpack_ack(struct wire_in *in, struct msg_ack *b, struct msg *m)
{
    (void)m;
    b->job = wire_get_view(in, MSG_JOB);
    b->unit = wire_get_u32(in);
    b->attempt = wire_get_u32(in);
    b->row = wire_get_u32(in);
    b->rows = wire_get_u32(in);
}

#define MAX_LOST 4096 /* units that one child can be at work on */

static void
msg_pack_lost(struct wire_out *o, const struct msg_lost *b)
{
    msg_put_must(o, b->nunits <= MAX_LOST);
    msg_put_job(o, b->job);
    wire_put_str(o, b->text, MSG_MAX_TEXT);
    wire_put_u32(o, b->nunits);
    for (uint32_t i = 0; i < b->nunits && !o->bad; i++)
        wire_put_u32(o, b->units[i]);
}

static void
msg_unpack_lost(struct wire_in *in, struct msg_lost *b, struct msg *m)
{
    uint32_t *u;

    b->job = wire_get_view(in, MSG_JOB);
    b->text = wire_get_str(in, MSG_MAX_TEXT);
    b->nunits = wire_get_count(in, 4, MAX_LOST);
    b->units = u = msg_list_room(m, in, b->nunits, sizeof *u);
    if (!u)
        b->nunits = 0;
    for (uint32_t i = 0; i < b->nunits; i++)
        u[i] = wire_get_u32(in);
}

static void
msg_pack_tally(struct wire_out *o, const struct msg_tally *b)
{
    msg_put_job(o, b->job);
    wire_put_u64(o, b->ambient_sent);
    wire_put_u64(o, b->ambient_received);
    wire_put_u64(o, b->ambient_redundant);
    wire_put_u64(o, b->peak_rss_bytes);
    wire_put_u64(o, b->bytes_in);
    wire_put_u64(o, b->bytes_out);
    wire_put_u64(o, b->base_line_bytes);
    wire_put_u64(o, b->base_line_pixels);
    wire_put_f64(o, b->busy_s);
    wire_put_f64(o, b->wait_base_line_s);
    wire_put_u64(o, b->rays_under_way);
    msg_put_counts(o, &b->dropped);
}

static void
msg_unpack_tally(struct wire_in *in, struct msg_tally *b, struct msg *m)
{
    (void)m;
    b->job = wire_get_view(in, MSG_JOB);
    b->ambient_sent = wire_get_u64(in);
    b->ambient_received = wire_get_u64(in);
    b->ambient_redundant = wire_get_u64(in);
    b->peak_rss_bytes = wire_get_u64(in);
    b->bytes_in = wire_get_u64(in);
    b->bytes_out = wire_get_u64(in);
    b->base_line_bytes = wire_get_u64(in);
    b->base_line_pixels = wire_get_u64(in);
    b->busy_s = wire_get_f64(in);
    b->wait_base_line_s = wire_get_f64(in);
    b->rays_under_way = wire_get_u64(in);
    msg_get_counts(in, &b->dropped);
    msg_must(in, b->busy_s >= 0 && b->wait_base_line_s >= 0);
}

/* --- peers --- */

#define PEER_MIN  26 /* bytes of a peer with empty strings, in any version */
#define MAX_PEERS 4096

/* Version 1 knows no keys that are retired, and nobody to be dropped. */
static bool
peer_is_told(unsigned version, const struct msg_peer *p)
{
    return version >= 2 || !(p->flags & MSG_PEER_DROP);
}

static void
put_peer(struct wire_out *o, const struct msg_peer *p)
{
    wire_put_str(o, p->name, MSG_MAX_NAME);
    wire_put_str(o, p->address, MSG_MAX_ADDRESS);
    wire_put_bytes(o, p->token, MSG_TOKEN);
    wire_put_u32(o, p->flags);
    if (o->version >= 2)
        wire_put_u16(o, p->version);
}

static void
msg_pack_job_peers(struct wire_out *o, const struct msg_job_peers *b)
{
    uint32_t n = 0;

    msg_put_must(o, b->npeers <= MAX_PEERS);
    for (uint32_t i = 0; i < b->npeers; i++)
        n += peer_is_told(o->version, &b->peers[i]);
    msg_put_job(o, b->job);
    wire_put_u32(o, n);
    for (uint32_t i = 0; i < b->npeers && !o->bad; i++)
        if (peer_is_told(o->version, &b->peers[i]))
            put_peer(o, &b->peers[i]);
}

static void
msg_unpack_job_peers(struct wire_in *in, struct msg_job_peers *b, struct msg *m)
{
    struct msg_peer *p;

    b->job = wire_get_view(in, MSG_JOB);
    b->npeers = wire_get_count(in, PEER_MIN, MAX_PEERS);
    b->peers = p = msg_list_room(m, in, b->npeers, sizeof *p);
    if (!p)
        b->npeers = 0;
    for (uint32_t i = 0; i < b->npeers; i++) {
        p[i].name = wire_get_str(in, MSG_MAX_NAME);
        p[i].address = wire_get_str(in, MSG_MAX_ADDRESS);
        p[i].token = wire_get_view(in, MSG_TOKEN);
        p[i].flags = wire_get_u32(in);
        p[i].version = in->version >= 2 ? wire_get_u16(in) : 1;
        msg_must(in, p[i].flags <= (MSG_PEER_DIAL | MSG_PEER_GIVE) ||
                         (p[i].flags == MSG_PEER_DROP && in->version >= 2));
        msg_must(in, msg_common_version(p[i].version, p[i].version) != 0);
    }
}

static void
msg_pack_peer_hello(struct wire_out *o, const struct msg_peer_hello *b)
{
    msg_put_job(o, b->job);
    wire_put_str(o, b->name, MSG_MAX_NAME);
    wire_put_bytes(o, b->token, MSG_TOKEN);
}

static void
msg_unpack_peer_hello(struct wire_in *in, struct msg_peer_hello *b,
                      struct msg *m)
{
    (void)m;
    b->job = wire_get_view(in, MSG_JOB);
    b->name = wire_get_str(in, MSG_MAX_NAME);
    b->token = wire_get_view(in, MSG_TOKEN);
}

static void
msg_pack_ambient(struct wire_out *o, const struct msg_ambient *b)
{
    wire_put_u32(o, b->to);
    wire_put_u32(o, b->count);
    wire_put_blob(o, b->data, b->len, MSG_MAX_AMBIENT);
}

static void
msg_unpack_ambient(struct wire_in *in, struct msg_ambient *b, struct msg *m)
{
    (void)m;
    b->to = wire_get_u32(in);
    b->count = wire_get_u32(in);
    b->data = wire_get_blob(in, MSG_MAX_AMBIENT, &b->len);
    msg_must(in, b->count <= b->len);
}

static void
msg_pack_records(struct wire_out *o, const struct msg_records *b)
{
    msg_put_job(o, b->job);
    wire_put_u32(o, b->count);
    wire_put_blob(o, b->data, b->len, MSG_MAX_AMBIENT);
}

static void
msg_unpack_records(struct wire_in *in, struct msg_records *b, struct msg *m)
{
    (void)m;
    b->job = wire_get_view(in, MSG_JOB);
    b->count = wire_get_u32(in);
    b->data = wire_get_blob(in, MSG_MAX_AMBIENT, &b->len);
    msg_must(in, b->count <= b->len);
}

static void
msg_pack_give(struct wire_out *o, const struct msg_give *b)
{
    wire_put_u32(o, b->to);
}

static void
msg_unpack_give(struct wire_in *in, struct msg_give *b, struct msg *m)
{
    (void)m;
    b->to = wire_get_u32(in);
}

/* --- the table --- */

#define AT(session)     (1u << MSG_AT_##session)
#define AT_COORD_CLIENT (AT(COORD_USER) | AT(COORD_ADMIN))
#define AT_PARENT       (AT(PARENT_NEW) | AT(PARENT))
#define AT_SHARED       (AT(COORD_WORKER) | AT(PARENT)) /* from a child */
/* wherever both sides have said who they are, over a network */
#define AT_LIVE                                                                \
    (AT(COORD_WORKER) | AT_COORD_CLIENT | AT(WORKER) | AT(CLIENT) | AT(PEER))

struct row {
    uint16_t type;
    const char *name;
    unsigned since, bytes; /* versions */
    size_t limit;
    unsigned at; /* bit per enum msg_session */
    void (*pack)(struct wire_out *o, const struct msg *m);
    void (*unpack)(struct wire_in *in, struct msg *m);
};

/* From the body's codec to one that takes the whole message. */
#define MSG(NAME, lower, body, number, since, bytes, limit, at)                \
    static void pack_##lower(struct wire_out *o, const struct msg *m)          \
    {                                                                          \
        msg_pack_##body(o, &m->lower);                                         \
    }                                                                          \
    static void unpack_##lower(struct wire_in *in, struct msg *m)              \
    {                                                                          \
        msg_unpack_##body(in, &m->lower, m);                                   \
    }
#include "message.def"

static const struct row rows[] = {
#define MSG(NAME, lower, body, number, since, bytes, limit, at)                \
    { number, #NAME, since, bytes, limit, at, pack_##lower, unpack_##lower },
#include "message.def"
};

#define NROWS (sizeof rows / sizeof rows[0])

static const struct row *
find_row(uint16_t type)
{
    for (size_t i = 0; i < NROWS; i++)
        if (rows[i].type == type)
            return &rows[i];
    return NULL;
}

void
msg_release(struct msg *m)
{
    free(m->list);
    *m = (struct msg){ 0 };
}

int
msg_pack(struct wire_out *out, const struct msg *m)
{
    return msg_pack_as(MSG_VERSION, out, m);
}

int
msg_pack_as(unsigned version, struct wire_out *out, const struct msg *m)
{
    const struct row *row = find_row(m->type);
    size_t start = out->len;

    if (!row || out->bad || version < row->since)
        return RAD_EPROTO;
    out->version = version;
    wire_put_u32(out, MSG_MAGIC);
    wire_put_u16(out, m->type);
    wire_put_u16(out, 0);
    wire_put_u32(out, m->request);
    wire_put_u32(out, 0);
    row->pack(out, m);
    if (!out->bad && out->len - start - MSG_HEADER > row->limit)
        out->bad = true;
    if (out->bad) {
        out->len = start;
        out->bad = false;
        return RAD_EPROTO;
    }
    wire_set_u32(out, start + 12, (uint32_t)(out->len - start - MSG_HEADER));
    return 0;
}

uint16_t
msg_frame_type(const uint8_t *frame, size_t n)
{
    struct wire_in in;

    wire_in_init(&in, frame, n);
    wire_get_u32(&in); /* the magic */
    return wire_get_u16(&in);
}

static uint32_t
frame_request(const uint8_t *frame, size_t n)
{
    struct wire_in in;

    wire_in_init(&in, frame, n);
    wire_get_view(&in, 8); /* magic, type, flags */
    return wire_get_u32(&in);
}

int
msg_frame_as(unsigned version, struct wire_out *out, const uint8_t *frame,
             size_t n)
{
    const struct row *row = find_row(msg_frame_type(frame, n));
    struct msg m = { 0 };
    int rc;

    if (n < MSG_HEADER || !row)
        return RAD_EPROTO;
    if (version >= row->bytes)
        return 0;
    rc = msg_unpack(&m, row->type, frame_request(frame, n), frame + MSG_HEADER,
                    n - MSG_HEADER, NULL);
    if (rc == 0)
        rc = msg_pack_as(version, out, &m);
    msg_release(&m);
    return rc < 0 ? rc : 1;
}

int
msg_unpack(struct msg *m, uint16_t type, uint32_t request,
           const uint8_t *payload, size_t n, struct rad_error *err)
{
    return msg_unpack_as(MSG_VERSION, m, type, request, payload, n, err);
}

int
msg_unpack_as(unsigned version, struct msg *m, uint16_t type, uint32_t request,
              const uint8_t *payload, size_t n, struct rad_error *err)
{
    const struct row *row = find_row(type);
    void *list = m->list;
    size_t list_size = m->list_size;
    struct wire_in in;

    *m = (struct msg){
        .type = type, .request = request, .list = list, .list_size = list_size
    };
    if (!row || version < row->since)
        return rad_fail(err, RAD_EPROTO, "unknown message %u", type);
    wire_in_init(&in, payload, n);
    in.version = version;
    row->unpack(&in, m);
    if (in.bad)
        return rad_fail(err, RAD_EPROTO, "malformed %s of %zu bytes", row->name,
                        n);
    if (wire_left(&in) > 0)
        return rad_fail(err, RAD_EPROTO, "%s has %zu bytes too many", row->name,
                        wire_left(&in));
    return 0;
}

static bool
nan_before(const struct msg_nan *a, const struct msg_nan *b)
{
    if (a->frame != b->frame)
        return a->frame < b->frame;
    return a->y != b->y ? a->y < b->y : a->x < b->x;
}

void
msg_nan_add(struct msg_nan *a, const struct msg_nan *b)
{
    uint64_t sum = a->pixels + b->pixels;

    if (b->pixels > 0 && (a->pixels == 0 || nan_before(b, a)))
        *a = *b;
    a->pixels = sum;
}

static void
add_fault(struct msg_fault a[MSG_FAULTS], const struct msg_fault *b)
{
    int at = 0;

    while (at < MSG_FAULTS && a[at].count > 0 && a[at].object < b->object)
        at++;
    if (at == MSG_FAULTS)
        return;
    if (a[at].count == 0 || a[at].object != b->object) {
        memmove(a + at + 1, a + at, (size_t)(MSG_FAULTS - 1 - at) * sizeof *a);
        a[at] = (struct msg_fault){ b->object, 0 };
    }
    a[at].count += b->count;
}

void
msg_faults_add(struct msg_fault a[MSG_FAULTS],
               const struct msg_fault b[MSG_FAULTS])
{
    for (int i = 0; i < MSG_FAULTS; i++)
        if (b[i].count > 0)
            add_fault(a, &b[i]);
}

void
msg_doubt_add(struct msg_doubt *a, const struct msg_doubt *b)
{
    a->pixels += b->pixels;
    a->variance += b->variance;
    a->known += b->known;
    a->all += b->all;
    a->rough += b->rough;
    a->nrough += b->nrough;
}

void
msg_counts_add(struct msg_counts *a, const struct msg_counts *b)
{
    a->rays += b->rays;
    a->primary_rays += b->primary_rays;
    a->speculative_rays += b->speculative_rays;
    a->shadow_rays += b->shadow_rays;
    a->ambient_rays += b->ambient_rays;
    a->paint_rays += b->paint_rays;
    a->estimate_rays += b->estimate_rays;
    a->intersection_tests += b->intersection_tests;
    a->ambient_values += b->ambient_values;
    msg_nan_add(&a->nan, &b->nan);
    msg_faults_add(a->faults, b->faults);
    a->cpu_s += b->cpu_s;
    a->wall_s += b->wall_s;
    msg_doubt_add(&a->doubt, &b->doubt);
}

const char *
msg_name(uint16_t type)
{
    const struct row *row = find_row(type);

    return row ? row->name : "?";
}

size_t
msg_limit(uint16_t type)
{
    const struct row *row = find_row(type);

    return row ? row->limit : 0;
}

unsigned
msg_since(uint16_t type)
{
    const struct row *row = find_row(type);

    return row ? row->since : 0;
}

unsigned
msg_bytes_since(uint16_t type)
{
    const struct row *row = find_row(type);

    return row ? row->bytes : 0;
}

bool
msg_allowed(enum msg_session session, uint16_t type)
{
    const struct row *row = find_row(type);

    return row && (row->at >> session & 1);
}

uint16_t
msg_nth(size_t i)
{
    return i < NROWS ? rows[i].type : 0;
}

void
msg_job_format(const uint8_t job[MSG_JOB], char hex[MSG_JOB_HEX])
{
    static const char digit[] = "0123456789abcdef";

    for (int i = 0; i < MSG_JOB; i++) {
        hex[2 * i] = digit[job[i] >> 4];
        hex[2 * i + 1] = digit[job[i] & 15];
    }
    hex[2 * MSG_JOB] = '\0';
}

static int
hex_digit(char c)
{
    if (c >= '0' && c <= '9')
        return c - '0';
    if (c >= 'a' && c <= 'f')
        return c - 'a' + 10;
    return -1;
}

bool
msg_job_parse(const char *hex, uint8_t job[MSG_JOB])
{
    if (strlen(hex) != 2 * MSG_JOB)
        return false;
    for (int i = 0; i < MSG_JOB; i++) {
        int hi = hex_digit(hex[2 * i]), lo = hex_digit(hex[2 * i + 1]);

        if (hi < 0 || lo < 0)
            return false;
        job[i] = (uint8_t)(hi << 4 | lo);
    }
    return true;
}
