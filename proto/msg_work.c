/* msg_work.c - the codec of units, rows, tallies and their like: the work of
 * workers and their children
 *
 * See msg_work.h. */
#include "config.h"

#include "proto/codec.h"

void
msg_code_ready(struct codec *c, struct msg_ready *b)
{
    code_job(c, &b->job);
    code_amount(c, &b->load_s);
    code_u64(c, &b->fingerprint);
    code_u16(c, &b->threads);
    code_u32(c, &b->passes);
    code_read_must(c, b->threads >= 1 && b->threads <= MSG_MAX_THREADS &&
                          b->passes <= MSG_MOST_PASSES);
}

/* *n: the number of bytes of a RESULT's pixels, `len` if they are coded.
 * False: no RESULT can have such rows. */
static bool
result_bytes(const struct msg_result *b, size_t len, size_t *n)
{
    *n = 0;
    if (b->rows < 1 || b->rows > MSG_MAX_SIDE || b->row > MSG_MAX_SIDE ||
        b->width < 1 || b->width > MSG_MAX_SIDE)
        return false;
    if (b->channels == 3 || b->channels == 4)
        *n = (size_t)b->rows * b->width * b->channels * 4; /* below 2^36 */
    else if (b->channels == 1)
        *n = len;
    else
        return false;
    return *n > 0 && *n <= MSG_MAX_PIXELS;
}

void
msg_code_result(struct codec *c, struct msg_result *b)
{
    size_t n;

    code_attempt(c, &b->job, &b->unit, &b->attempt);
    code_u32(c, &b->row);
    code_u32(c, &b->rows);
    code_u32(c, &b->width);
    code_u8(c, &b->channels);
    code_below(c, &b->last, 2);
    if (b->last)
        code_counts(c, &b->counts);
    code_must(c, result_bytes(b, c->out ? b->len : wire_left(c->in), &n));
    if (code_bad(c))
        return;
    code_view(c, &b->pixels, n);
    b->len = b->channels == 1 && b->pixels ? n : 0;
}

void
msg_code_ack(struct codec *c, struct msg_ack *b)
{
    code_attempt(c, &b->job, &b->unit, &b->attempt);
    code_u32(c, &b->row);
    code_u32(c, &b->rows);
}

#define MAX_LOST 4096 /* most units that one child works on */

void
msg_code_lost(struct codec *c, struct msg_lost *b)
{
    uint32_t *u;

    code_job(c, &b->job);
    code_failure(c, &b->status);
    code_str(c, &b->text, MSG_MAX_TEXT);
    u = code_list(c, b->units, &b->nunits, 4, MAX_LOST, sizeof *u);
    for (uint32_t i = 0; i < b->nunits; i++)
        code_u32(c, &u[i]);
    b->units = u;
}

void
msg_code_room(struct codec *c, struct msg_room *b)
{
    code_job(c, &b->job);
    code_below(c, &b->has, 2);
    code_str(c, &b->text, MSG_MAX_TEXT);
}

void
msg_code_tally(struct codec *c, struct msg_tally *b)
{
    code_job(c, &b->job);
    code_u64(c, &b->ambient_sent);
    code_u64(c, &b->ambient_received);
    code_u64(c, &b->ambient_redundant);
    code_u64(c, &b->cache_values);
    code_u64(c, &b->peak_rss_bytes);
    code_u64(c, &b->bytes_in);
    code_u64(c, &b->bytes_out);
    code_u64(c, &b->base_line_bytes);
    code_u64(c, &b->base_line_pixels);
    code_amount(c, &b->busy_s);
    code_amount(c, &b->wait_base_line_s);
    code_u64(c, &b->rays_under_way);
    code_counts(c, &b->dropped);
    code_counts(c, &b->paid);
    code_u64(c, &b->pixels_under_way);
}
