/* msg_sharing.c - the codec of the messages by which workers share a picture
 *
 * See "sharing a picture" in message.h. */
#include "config.h"

#include "codec.h"

static bool
area_fits(uint32_t x, uint32_t y, uint32_t width, uint32_t height)
{
    return width >= 1 && width <= MSG_MAX_SIDE && height >= 1 &&
           height <= MSG_MAX_SIDE && x <= MSG_MAX_SIDE - width &&
           y <= MSG_MAX_SIDE - height;
}

static bool
unit_fits(const struct msg_unit *b)
{
    return area_fits(b->x, b->y, b->width, b->height) && b->mode < MSG_NMODE &&
           b->end < MSG_NEND && (b->flags & ~MSG_UNIT_FLAGS) == 0 &&
           (b->mode == MSG_MODE_STRICT || b->flags == 0);
}

void
msg_pack_unit(struct wire_out *o, const struct msg_unit *b)
{
    msg_put_must(o, unit_fits(b));
    msg_put_job(o, b->job);
    wire_put_u32(o, b->unit);
    wire_put_u32(o, b->attempt);
    wire_put_u32(o, b->frame);
    wire_put_u32(o, b->x);
    wire_put_u32(o, b->y);
    wire_put_u32(o, b->width);
    wire_put_u32(o, b->height);
    wire_put_u8(o, b->mode);
    wire_put_u8(o, b->end);
    wire_put_u8(o, b->flags);
}

void
msg_unpack_unit(struct wire_in *in, struct msg_unit *b, struct msg *m)
{
    (void)m;
    b->job = wire_get_view(in, MSG_JOB);
    b->unit = wire_get_u32(in);
    b->attempt = wire_get_u32(in);
    b->frame = wire_get_u32(in);
    b->x = wire_get_u32(in);
    b->y = wire_get_u32(in);
    b->width = wire_get_u32(in);
    b->height = wire_get_u32(in);
    b->mode = wire_get_u8(in);
    b->end = wire_get_u8(in);
    b->flags = wire_get_u8(in);
    msg_must(in, unit_fits(b));
}

void
msg_pack_attempt(struct wire_out *o, const struct msg_attempt *b)
{
    msg_put_job(o, b->job);
    wire_put_u32(o, b->unit);
    wire_put_u32(o, b->attempt);
}

void
msg_unpack_attempt(struct wire_in *in, struct msg_attempt *b, struct msg *m)
{
    (void)m;
    b->job = wire_get_view(in, MSG_JOB);
    b->unit = wire_get_u32(in);
    b->attempt = wire_get_u32(in);
}

/* --- facts --- */

static bool
facts_fit(const struct msg_facts *b)
{
    return b->rows >= 1 && b->rows <= MSG_MAX_LINE_ROWS &&
           b->row <= MSG_MAX_LINE_ROWS - b->rows && b->width >= 1 &&
           b->width <= MSG_MAX_SIDE && (b->flags & ~MSG_FACTS_FLAGS) == 0 &&
           (b->channels == 3 || b->channels == 4);
}

/* Bits that are set in the bitmap; false: some lie past the width. */
static bool
count_bits(const struct msg_facts *b, uint32_t *n)
{
    size_t stride = (b->width + 7) / 8;
    unsigned past = b->width % 8 ? 0xffu << b->width % 8 : 0;

    *n = 0;
    for (uint32_t r = 0; r < b->rows; r++) {
        const uint8_t *row = b->bitmap + r * stride;

        for (size_t i = 0; i < stride; i++)
            for (unsigned v = row[i]; v; v &= v - 1)
                ++*n;
        if (row[stride - 1] & past)
            return false;
    }
    return true;
}

void
msg_pack_facts(struct wire_out *o, const struct msg_facts *b)
{
    uint32_t n = 0;

    msg_put_must(o, facts_fit(b) && count_bits(b, &n));
    if (o->bad)
        return;
    msg_put_job(o, b->job);
    wire_put_u32(o, b->frame);
    wire_put_u32(o, b->line);
    wire_put_u32(o, b->row);
    wire_put_u32(o, b->rows);
    wire_put_u32(o, b->width);
    wire_put_u8(o, b->flags);
    wire_put_u8(o, b->channels);
    wire_put_bytes(o, b->bitmap, (size_t)b->rows * ((b->width + 7) / 8));
    wire_put_bytes(o, b->pixels, (size_t)n * b->channels * 4);
}

void
msg_unpack_facts(struct wire_in *in, struct msg_facts *b, struct msg *m)
{
    (void)m;
    b->job = wire_get_view(in, MSG_JOB);
    b->frame = wire_get_u32(in);
    b->line = wire_get_u32(in);
    b->row = wire_get_u32(in);
    b->rows = wire_get_u32(in);
    b->width = wire_get_u32(in);
    b->flags = wire_get_u8(in);
    b->channels = wire_get_u8(in);
    msg_must(in, facts_fit(b));
    if (in->bad)
        return;
    b->bitmap = wire_get_view(in, (size_t)b->rows * ((b->width + 7) / 8));
    msg_must(in, b->bitmap && count_bits(b, &b->npixels));
    if (!in->bad)
        b->pixels = wire_get_view(in, (size_t)b->npixels * b->channels * 4);
}

/* --- base lines --- */

static bool
base_line_fits(const struct msg_base_line *b)
{
    return b->n <= MSG_MAX_SIDE && b->x <= MSG_MAX_SIDE - b->n &&
           b->ndensity <= MSG_MAX_SIDE &&
           b->first <= MSG_MAX_SIDE - b->ndensity &&
           (b->channels == 3 || b->channels == 4);
}

void
msg_pack_base_line(struct wire_out *o, const struct msg_base_line *b)
{
    msg_put_must(o, base_line_fits(b));
    if (o->bad)
        return;
    msg_put_job(o, b->job);
    wire_put_u32(o, b->frame);
    wire_put_u32(o, b->line);
    wire_put_u32(o, b->x);
    wire_put_u32(o, b->n);
    wire_put_u32(o, b->first);
    wire_put_u32(o, b->ndensity);
    wire_put_u8(o, b->channels);
    wire_put_bytes(o, b->density, b->ndensity);
    wire_put_bytes(o, b->pixels, (size_t)b->n * b->channels * 4);
}

void
msg_unpack_base_line(struct wire_in *in, struct msg_base_line *b, struct msg *m)
{
    (void)m;
    b->job = wire_get_view(in, MSG_JOB);
    b->frame = wire_get_u32(in);
    b->line = wire_get_u32(in);
    b->x = wire_get_u32(in);
    b->n = wire_get_u32(in);
    b->first = wire_get_u32(in);
    b->ndensity = wire_get_u32(in);
    b->channels = wire_get_u8(in);
    msg_must(in, base_line_fits(b));
    if (in->bad)
        return;
    b->density = wire_get_view(in, b->ndensity);
    b->pixels = wire_get_view(in, (size_t)b->n * b->channels * 4);
}

void
msg_pack_next_holder(struct wire_out *o, const struct msg_next_holder *b)
{
    msg_put_job(o, b->job);
    wire_put_u32(o, b->frame);
    wire_put_u32(o, b->line);
    wire_put_str(o, b->name, MSG_MAX_NAME);
}

void
msg_unpack_next_holder(struct wire_in *in, struct msg_next_holder *b,
                       struct msg *m)
{
    (void)m;
    b->job = wire_get_view(in, MSG_JOB);
    b->frame = wire_get_u32(in);
    b->line = wire_get_u32(in);
    b->name = wire_get_str(in, MSG_MAX_NAME);
}

void
msg_pack_gave(struct wire_out *o, const struct msg_gave *b)
{
    msg_put_must(o, b->height >= 1 && b->height <= MSG_MAX_SIDE);
    msg_put_job(o, b->job);
    wire_put_u32(o, b->unit);
    wire_put_u32(o, b->attempt);
    wire_put_u32(o, b->height);
}

void
msg_unpack_gave(struct wire_in *in, struct msg_gave *b, struct msg *m)
{
    (void)m;
    b->job = wire_get_view(in, MSG_JOB);
    b->unit = wire_get_u32(in);
    b->attempt = wire_get_u32(in);
    b->height = wire_get_u32(in);
    msg_must(in, b->height >= 1 && b->height <= MSG_MAX_SIDE);
}

/* --- estimates --- */

#define AREA_BYTES 20
#define COST_BYTES 16
#define MAX_AREAS  50000 /* what fits a message */

void
msg_pack_estimate(struct wire_out *o, const struct msg_estimate *b)
{
    msg_put_must(o, b->nareas <= MAX_AREAS);
    msg_put_job(o, b->job);
    wire_put_u32(o, b->id);
    wire_put_u32(o, b->rays);
    wire_put_u32(o, b->nareas);
    for (uint32_t i = 0; i < b->nareas && !o->bad; i++) {
        const struct msg_area *a = &b->areas[i];

        msg_put_must(o, area_fits(a->x, a->y, a->width, a->height));
        wire_put_u32(o, a->frame);
        wire_put_u32(o, a->x);
        wire_put_u32(o, a->y);
        wire_put_u32(o, a->width);
        wire_put_u32(o, a->height);
    }
}

void
msg_unpack_estimate(struct wire_in *in, struct msg_estimate *b, struct msg *m)
{
    struct msg_area *a;

    b->job = wire_get_view(in, MSG_JOB);
    b->id = wire_get_u32(in);
    b->rays = wire_get_u32(in);
    b->nareas = wire_get_count(in, AREA_BYTES, MAX_AREAS);
    b->areas = a = msg_list_room(m, in, b->nareas, sizeof *a);
    if (!a)
        b->nareas = 0;
    for (uint32_t i = 0; i < b->nareas; i++) {
        a[i].frame = wire_get_u32(in);
        a[i].x = wire_get_u32(in);
        a[i].y = wire_get_u32(in);
        a[i].width = wire_get_u32(in);
        a[i].height = wire_get_u32(in);
        msg_must(in, area_fits(a[i].x, a[i].y, a[i].width, a[i].height));
    }
}

void
msg_pack_estimated(struct wire_out *o, const struct msg_estimated *b)
{
    msg_put_must(o, b->ncosts <= MAX_AREAS);
    msg_put_job(o, b->job);
    wire_put_u32(o, b->id);
    wire_put_u32(o, b->ncosts);
    for (uint32_t i = 0; i < b->ncosts && !o->bad; i++) {
        wire_put_u64(o, b->costs[i].rays);
        wire_put_u64(o, b->costs[i].tests);
    }
    msg_put_counts(o, &b->counts);
}

void
msg_unpack_estimated(struct wire_in *in, struct msg_estimated *b, struct msg *m)
{
    struct msg_cost *c;

    b->job = wire_get_view(in, MSG_JOB);
    b->id = wire_get_u32(in);
    b->ncosts = wire_get_count(in, COST_BYTES, MAX_AREAS);
    b->costs = c = msg_list_room(m, in, b->ncosts, sizeof *c);
    if (!c)
        b->ncosts = 0;
    for (uint32_t i = 0; i < b->ncosts; i++) {
        c[i].rays = wire_get_u64(in);
        c[i].tests = wire_get_u64(in);
    }
    msg_get_counts(in, &b->counts);
}
