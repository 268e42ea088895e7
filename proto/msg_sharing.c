/* msg_sharing.c - the codec of the messages by which workers share a picture
 *
 * See msg_sharing.h. */
#include "config.h"

#include "proto/codec.h"

#include "base/bits.h"

static bool
area_fits(uint32_t x, uint32_t y, uint32_t width, uint32_t height)
{
    return width >= 1 && width <= MSG_MAX_SIDE && height >= 1 &&
           height <= MSG_MAX_SIDE && x <= MSG_MAX_SIDE - width &&
           y <= MSG_MAX_SIDE - height;
}

void
msg_code_unit(struct codec *c, struct msg_unit *b)
{
    code_attempt(c, &b->job, &b->unit, &b->attempt);
    code_u32(c, &b->frame);
    code_u32(c, &b->x);
    code_u32(c, &b->y);
    code_u32(c, &b->width);
    code_u32(c, &b->height);
    code_below(c, &b->mode, MSG_NMODE);
    code_u8(c, &b->flags);
    code_must(c, area_fits(b->x, b->y, b->width, b->height));
    code_must(c, (b->flags & ~MSG_UNIT_FLAGS) == 0 &&
                     (b->mode == MSG_MODE_STRICT || b->flags == 0));
}

void
msg_code_attempt(struct codec *c, struct msg_attempt *b)
{
    code_attempt(c, &b->job, &b->unit, &b->attempt);
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

/* Count the bits that are set in the bitmap; false: some lie past the width. */
static bool
count_bits(const struct msg_facts *b, uint32_t *n)
{
    size_t stride = (b->width + 7) / 8;
    unsigned past = b->width % 8 ? 0xffu << b->width % 8 : 0;

    *n = 0;
    for (uint32_t r = 0; r < b->rows; r++) {
        const uint8_t *row = b->bitmap + r * stride;

        for (size_t i = 0; i < stride; i++)
            *n += (uint32_t)rad_count_bits(row[i]);
        if (row[stride - 1] & past)
            return false;
    }
    return true;
}

void
msg_code_facts(struct codec *c, struct msg_facts *b)
{
    code_job(c, &b->job);
    code_u32(c, &b->frame);
    code_u32(c, &b->line);
    code_u32(c, &b->row);
    code_u32(c, &b->rows);
    code_u32(c, &b->width);
    code_u8(c, &b->flags);
    code_u8(c, &b->channels);
    code_must(c, facts_fit(b));
    if (code_bad(c))
        return;
    code_view(c, &b->bitmap, (size_t)b->rows * ((b->width + 7) / 8));
    code_must(c, b->bitmap && count_bits(b, &b->npixels));
    if (code_bad(c))
        return;
    code_view(c, &b->pixels, (size_t)b->npixels * b->channels * 4);
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
msg_code_base_line(struct codec *c, struct msg_base_line *b)
{
    code_job(c, &b->job);
    code_u32(c, &b->frame);
    code_u32(c, &b->line);
    code_u32(c, &b->x);
    code_u32(c, &b->n);
    code_u32(c, &b->first);
    code_u32(c, &b->ndensity);
    code_u8(c, &b->channels);
    code_must(c, base_line_fits(b));
    if (code_bad(c))
        return;
    code_view(c, &b->density, b->ndensity);
    code_view(c, &b->pixels, (size_t)b->n * b->channels * 4);
}

void
msg_code_guess(struct codec *c, struct msg_guess *b)
{
    code_job(c, &b->job);
    code_u32(c, &b->frame);
    code_u32(c, &b->line);
    code_u8(c, &b->known);
    code_u32(c, &b->ndensity);
    code_must(c, b->known >= 1 && b->ndensity <= MSG_MAX_SIDE);
    if (!code_bad(c))
        code_view(c, &b->density, b->ndensity);
}

void
msg_code_next_holder(struct codec *c, struct msg_next_holder *b)
{
    code_job(c, &b->job);
    code_u32(c, &b->frame);
    code_u32(c, &b->line);
    code_str(c, &b->name, MSG_MAX_NAME);
}

void
msg_code_gave(struct codec *c, struct msg_gave *b)
{
    code_attempt(c, &b->job, &b->unit, &b->attempt);
    code_u32(c, &b->height);
    code_must(c, b->height <= MSG_MAX_SIDE);
}

/* --- columns --- */

void
msg_code_lend(struct codec *c, struct msg_lend *b)
{
    code_attempt(c, &b->job, &b->unit, &b->attempt);
    code_u16(c, &b->part);
}

static bool
loan_fits(const struct msg_loan *b)
{
    return b->n >= 1 && b->n <= MSG_MAX_SIDE && b->x <= MSG_MAX_SIDE - b->n &&
           (b->flags & ~MSG_LOAN_FLAGS) == 0 &&
           (b->channels == 3 || b->channels == 4) &&
           b->ndensity <= (b->flags & MSG_LOAN_LINE ? MSG_MAX_SIDE : 0);
}

void
msg_code_loan(struct codec *c, struct msg_loan *b)
{
    size_t pixels;

    code_attempt(c, &b->job, &b->unit, &b->attempt);
    code_u32(c, &b->frame);
    code_u32(c, &b->line);
    code_u32(c, &b->x);
    code_u32(c, &b->n);
    code_u16(c, &b->given);
    code_u16(c, &b->left);
    code_u8(c, &b->flags);
    code_u8(c, &b->channels);
    code_u32(c, &b->ndensity);
    code_must(c, loan_fits(b));
    if (code_bad(c))
        return;
    pixels = (size_t)b->n * b->channels * 4;
    code_view(c, &b->density, b->ndensity);
    code_view(c, &b->wanted, (b->n + 7) / 8);
    code_view(c, &b->top, pixels);
    if (!(b->flags & MSG_LOAN_LINE))
        code_view(c, &b->bottom, pixels);
}

void
msg_code_back(struct codec *c, struct msg_back *b)
{
    code_attempt(c, &b->job, &b->unit, &b->attempt);
    code_u32(c, &b->line);
    code_u32(c, &b->x);
    code_u32(c, &b->n);
    code_must(c, b->n <= MSG_MAX_SIDE && b->x <= MSG_MAX_SIDE - b->n);
}

void
msg_code_paid(struct codec *c, struct msg_paid *b)
{
    code_attempt(c, &b->job, &b->unit, &b->attempt);
    code_counts(c, &b->counts);
}

void
msg_code_line_costs(struct codec *c, struct msg_line_costs *b)
{
    uint64_t *ns;

    code_job(c, &b->job);
    code_u32(c, &b->frame);
    code_u32(c, &b->line);
    ns = code_list(c, b->cpu_ns, &b->nlines, 8, MSG_MAX_SIDE, sizeof *ns);
    for (uint32_t i = 0; i < b->nlines; i++)
        code_u64(c, &ns[i]);
    b->cpu_ns = ns;
}

/* --- estimates --- */

#define AREA_BYTES 20
#define COST_BYTES 16
#define MAX_AREAS  50000 /* as many as fit a message */

static void
code_area(struct codec *c, struct msg_area *a)
{
    code_u32(c, &a->frame);
    code_u32(c, &a->x);
    code_u32(c, &a->y);
    code_u32(c, &a->width);
    code_u32(c, &a->height);
    code_must(c, area_fits(a->x, a->y, a->width, a->height));
}

void
msg_code_estimate(struct codec *c, struct msg_estimate *b)
{
    struct msg_area *a;

    code_job(c, &b->job);
    code_u32(c, &b->id);
    code_u32(c, &b->rays);
    a = code_list(c, b->areas, &b->nareas, AREA_BYTES, MAX_AREAS, sizeof *a);
    for (uint32_t i = 0; i < b->nareas; i++)
        code_area(c, &a[i]);
    b->areas = a;
}

void
msg_code_estimated(struct codec *c, struct msg_estimated *b)
{
    struct msg_cost *cost;

    code_job(c, &b->job);
    code_u32(c, &b->id);
    cost =
        code_list(c, b->costs, &b->ncosts, COST_BYTES, MAX_AREAS, sizeof *cost);
    for (uint32_t i = 0; i < b->ncosts; i++) {
        code_u64(c, &cost[i].rays);
        code_u64(c, &cost[i].tests);
    }
    b->costs = cost;
    code_counts(c, &b->counts);
}
