/* msg_work.c - the codec of the messages by which workers and their children
 * say how they get on, with the rows of the picture
 *
 * See "work" in message.h and message.def. */
#include "config.h"

#include "codec.h"

void
msg_pack_ready(struct wire_out *o, const struct msg_ready *b)
{
    msg_put_job(o, b->job);
    wire_put_f64(o, b->load_s);
    wire_put_u64(o, b->fingerprint);
    wire_put_u16(o, b->threads);
}

void
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

void
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

void
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

void
msg_pack_ack(struct wire_out *o, const struct msg_ack *b)
{
    msg_put_job(o, b->job);
    wire_put_u32(o, b->unit);
    wire_put_u32(o, b->attempt);
    wire_put_u32(o, b->row);
    wire_put_u32(o, b->rows);
}

void
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

void
msg_pack_lost(struct wire_out *o, const struct msg_lost *b)
{
    msg_put_must(o, b->nunits <= MAX_LOST);
    msg_put_job(o, b->job);
    wire_put_str(o, b->text, MSG_MAX_TEXT);
    wire_put_u32(o, b->nunits);
    for (uint32_t i = 0; i < b->nunits && !o->bad; i++)
        wire_put_u32(o, b->units[i]);
}

void
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

void
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

void
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
