/* strict_out.c - the messages of the strict units
 *
 * There are two queues.  Urgent messages, for which other workers may wait, are
 * sent at once.  Lazy ones are facts of parked units, which matter only if this
 * worker is lost: they are sent when there is room, and dropped if the unit's
 * top comes before. */
#include "config.h"

#include "strict/strict_out.h"

#include "strict/strict_facts.h"
#include "strict/strict_state.h"

#include <stdlib.h>
#include <string.h>

/* A copy of an item, in no queue; NULL: memory is out. */
static struct item *
copy_of(struct strict *s, const struct item *it)
{
    struct item *copy = malloc(sizeof *copy);

    if (!copy) {
        s->error = RAD_ENOMEM;
        return NULL;
    }
    *copy = *it;
    copy->next = NULL;
    return copy;
}

/* Put a copy of the item last into the queue; NULL: memory is out. */
static struct item *
push(struct strict *s, struct queue *q, const struct item *it)
{
    struct item *copy = copy_of(s, it);

    if (!copy)
        return NULL;
    if (q->last)
        q->last->next = copy;
    else
        q->first = copy;
    q->last = copy;
    return copy;
}

static struct item *
push_first(struct strict *s, struct queue *q, const struct item *it)
{
    struct item *copy = copy_of(s, it);

    if (!copy)
        return NULL;
    copy->next = q->first;
    q->first = copy;
    if (!q->last)
        q->last = copy;
    return copy;
}

static struct item *
pop(struct queue *q)
{
    struct item *it = q->first;

    if (it) {
        q->first = it->next;
        if (!q->first)
            q->last = NULL;
    }
    return it;
}

static void
item_free(struct item *it)
{
    if (!it)
        return;
    free(it->bytes);
    free(it->cpu_ns);
    free(it);
}

/* Queue the facts of a line's rows from `row' on. */
static void
push_facts(struct strict *s, struct queue *q, const struct strict_unit *u,
           int line, int row)
{
    const struct rad_facts *facts = facts_at(s, u->frame, line);
    struct item it = { .kind = ITEM_FACTS,
                       .unit = u->unit,
                       .attempt = u->attempt,
                       .frame = u->frame,
                       .line = line,
                       .row = row };

    if (!facts || rad_facts_fresh(facts) == 0)
        return;
    for (const struct item *i = q->first; i; i = i->next)
        if (i->kind == ITEM_FACTS && i->frame == u->frame && i->line == line &&
            i->row <= row)
            return;
    push(s, q, &it);
}

void
out_facts(struct strict *s, struct queue *q, const struct strict_unit *u,
          int line)
{
    push_facts(s, q, u, line, 0);
}

void
out_base_facts(struct strict *s, const struct strict_unit *u, int line)
{
    int rows = team_line_rows(&frame_of(s, u->frame)->q, line);

    push_facts(s, &s->urgent, u, line, rows - 1);
}

void
out_forget(struct strict *s, const struct strict_unit *u)
{
    struct item **at = &s->lazy.first, *it, *last = NULL;

    while ((it = *at)) {
        if (it->unit == u->unit && it->attempt == u->attempt) {
            *at = it->next;
            item_free(it);
        } else {
            last = it;
            at = &it->next;
        }
    }
    s->lazy.last = last;
}

void
out_state(struct strict *s, enum item_kind kind, const struct strict_unit *u)
{
    struct item it = {
        .kind = kind, .unit = u->unit, .attempt = u->attempt, .counts = u->spent
    };

    push(s, &s->urgent, &it);
}

/* If memory is out the message is left out: the job does without it. */
void
out_line_costs(struct strict *s, const struct strict_unit *u)
{
    int from = u->first > 0 ? 0 : 1;
    size_t n = (size_t)(u->nlines - from);
    struct item it = { .kind = ITEM_LINE_COSTS,
                       .frame = u->frame,
                       .line = u->first - 1 + from,
                       .nlines = (uint32_t)n,
                       .cpu_ns = malloc(n * sizeof *it.cpu_ns) };

    if (!it.cpu_ns)
        return;
    memcpy(it.cpu_ns, u->cpu_ns + from, n * sizeof *it.cpu_ns);
    if (!push(s, &s->urgent, &it))
        free(it.cpu_ns);
}

void
out_gave(struct strict *s, const struct strict_unit *u, int last)
{
    const struct frame *f = frame_of(s, u->frame);
    struct item it = { .kind = ITEM_GAVE,
                       .unit = u->unit,
                       .attempt = u->attempt,
                       .height =
                           (uint32_t)(row_of(f, last) - row_of(f, u->first)) };

    push(s, &s->urgent, &it);
}

static uint8_t *
put_pixels(uint8_t *to, const struct rad_pixel *from, uint32_t n, int channels)
{
    for (uint32_t i = 0; i < n; i++) {
        const float v[4] = { from[i].L.r, from[i].L.g, from[i].L.b, from[i].z };

        wire_floats_put(to, v, (size_t)channels);
        to += (size_t)channels * sizeof(float);
    }
    return to;
}

/* If memory is out the message is left out: the job does without it. */
void
out_guess(struct strict *s, const struct strict_unit *u, int line, int known,
          const uint8_t *density)
{
    size_t n = frame_of(s, u->frame)->ndensity;
    struct item it = { .kind = ITEM_GUESS,
                       .frame = u->frame,
                       .line = line,
                       .n = (uint32_t)known,
                       .ndensity = (uint32_t)n,
                       .bytes = malloc(n + 1) };

    if (!it.bytes)
        return;
    memcpy(it.bytes, density, n);
    if (!push(s, &s->urgent, &it))
        free(it.bytes);
}

/* Copy densities and pixels of a piece into the item; false: memory is out. */
static bool
fill_piece(struct strict *s, struct item *it, const struct rad_pixel *pixels,
           const uint8_t *density)
{
    int channels = channels_of(frame_of(s, it->frame));
    uint8_t *to;

    it->bytes = to = malloc(it->ndensity + it->n * sizeof(float) * 4 + 1);
    if (!to) {
        s->error = RAD_ENOMEM;
        return false;
    }
    memcpy(to, density + it->first, it->ndensity);
    to += it->ndensity;
    put_pixels(to, pixels + it->x, it->n, channels);
    return true;
}

/* Copy the arrays of a LOAN into the item; false: memory is out. */
static bool
fill_loan(struct strict *s, struct item *it, const struct team_loan *loan)
{
    struct msg_loan *m = &it->loan;
    size_t floats = (size_t)m->n * m->channels * sizeof(float);
    size_t bits = (m->n + 7) / 8;
    uint8_t *to = malloc(m->ndensity + bits + 2 * floats + 1);

    it->bytes = to;
    if (!to) {
        s->error = RAD_ENOMEM;
        return false;
    }
    m->density = to;
    if (m->ndensity > 0)
        memcpy(to, loan->density, m->ndensity);
    m->wanted = to += m->ndensity;
    memcpy(to, loan->wanted, bits);
    m->top = to += bits;
    to = put_pixels(to, loan->top, m->n, m->channels);
    m->bottom = to;
    if (loan->bottom)
        put_pixels(to, loan->bottom, m->n, m->channels);
    return true;
}

void
out_loan(struct strict *s, const struct strict_unit *u,
         const struct team_loan *loan)
{
    const struct frame *f = frame_of(s, u->frame);
    struct item it = { .kind = ITEM_LOAN };

    it.loan =
        (struct msg_loan){ .job = s->job,
                           .unit = u->unit,
                           .attempt = u->attempt,
                           .frame = u->frame,
                           .line = (uint32_t)loan->line,
                           .x = (uint32_t)loan->x,
                           .n = (uint32_t)loan->n,
                           .given = (uint16_t)(65535 * loan->given),
                           .left = (uint16_t)(65535 * loan->left),
                           .flags = loan->base ? MSG_LOAN_LINE : 0,
                           .channels = (uint8_t)channels_of(f),
                           .ndensity =
                               loan->density ? (uint32_t)f->ndensity : 0 };
    if (fill_loan(s, &it, loan) && !push(s, &s->urgent, &it))
        free(it.bytes);
}

/* The last item of a queue, if the piece `it' continues it; else NULL. */
static struct item *
continued(const struct queue *q, const struct item *it)
{
    struct item *last = q->last;

    return last && last->kind == ITEM_PIECE && last->frame == it->frame &&
                   last->line == it->line && last->x + last->n == it->x &&
                   last->first + last->ndensity == it->first
               ? last
               : NULL;
}

/* Over facts pieces of a line are made faster than they are sent: a piece that
 * continues the last one in the queue is joined to it. */
void
out_piece(struct strict *s, const struct strict_pass *p,
          const struct team_bottom *b)
{
    struct item it = { .kind = ITEM_PIECE,
                       .frame = p->frame,
                       .line = p->spec.last - 1,
                       .x = (uint32_t)p->sent_columns,
                       .n = (uint32_t)(b->columns - p->sent_columns),
                       .first = (uint32_t)p->sent_densities,
                       .ndensity =
                           (uint32_t)(b->ndensity - p->sent_densities) };
    struct item *last = continued(&s->urgent, &it);

    if (last) {
        it.x = last->x;
        it.n += last->n;
        it.first = last->first;
        it.ndensity += last->ndensity;
    }
    if (!fill_piece(s, &it, b->pixels, b->density))
        return;
    if (last) {
        free(last->bytes);
        it.next = last->next;
        *last = it;
        return;
    }
    if (!push(s, &s->urgent, &it))
        free(it.bytes);
}

/* Many bottoms may become true at once, of which other workers wait only for
 * the last. */
void
out_bottom(struct strict *s, const struct strict_unit *u,
           const struct rad_pixel *pixels, const uint8_t *density)
{
    const struct frame *f = frame_of(s, u->frame);
    struct queue *q = &s->urgent;
    struct item it = { .kind = ITEM_PIECE,
                       .frame = u->frame,
                       .line = u->last - 1,
                       .n = (uint32_t)f->q.width,
                       .ndensity = (uint32_t)f->ndensity };

    if (!fill_piece(s, &it, pixels, density))
        return;
    if (!(strict_unit_below(s, u) ? push(s, q, &it) : push_first(s, q, &it)))
        free(it.bytes);
}

static bool
make_room(struct strict *s, size_t bitmap, size_t floats)
{
    if (s->bitmap_room < bitmap) {
        free(s->bitmap);
        s->bitmap = malloc(bitmap);
        s->bitmap_room = s->bitmap ? bitmap : 0;
    }
    if (s->floats_room < floats) {
        free(s->floats);
        free(s->bytes);
        s->floats = malloc(floats * sizeof *s->floats);
        s->bytes = malloc(floats * sizeof *s->floats);
        s->floats_room = s->floats && s->bytes ? floats : 0;
    }
    if (!s->bitmap || !s->floats_room)
        s->error = RAD_ENOMEM;
    return !s->error;
}

/* Put the next rows' facts of an item into the message; false: there are no
 * more.
 */
static bool
pack_facts(struct strict *s, struct item *it)
{
    const struct frame *f = frame_of(s, it->frame);
    struct rad_facts *facts = facts_at(s, it->frame, it->line);
    size_t width = (size_t)f->q.width, stride = rad_facts_stride(f->q.width);
    size_t channels = (size_t)channels_of(f);
    size_t most = (MSG_MAX - 256) / (stride + width * channels * sizeof(float));

    while (facts && it->row < rad_facts_rows(facts)) {
        int left = rad_facts_rows(facts) - it->row;
        int n = most < 1 ? 1 : (size_t)left < most ? left : (int)most;
        int row = it->row;
        size_t count;

        if (!make_room(s, (size_t)n * stride, (size_t)n * width * channels))
            return false;
        it->row += n;
        count = rad_facts_export(
            facts, &(struct rad_fact_rows){ row, n, (int)channels, 0 },
            s->bitmap, s->floats);
        if (count == 0)
            continue;
        wire_floats_put(s->bytes, s->floats, count * channels);
        s->msg.type = MSG_FACTS;
        s->msg.facts = (struct msg_facts){ .job = s->job,
                                           .frame = it->frame,
                                           .line = (uint32_t)it->line,
                                           .row = (uint32_t)row,
                                           .rows = (uint32_t)n,
                                           .width = (uint32_t)width,
                                           .channels = (uint8_t)channels,
                                           .bitmap = s->bitmap,
                                           .pixels = s->bytes,
                                           .npixels = (uint32_t)count };
        return true;
    }
    return false;
}

static void
pack_piece(struct strict *s, const struct item *it)
{
    s->msg.type = MSG_BASE_LINE;
    s->msg.base_line = (struct msg_base_line){
        .job = s->job,
        .frame = it->frame,
        .line = (uint32_t)it->line,
        .x = it->x,
        .n = it->n,
        .first = it->first,
        .ndensity = it->ndensity,
        .channels = (uint8_t)channels_of(frame_of(s, it->frame)),
        .density = it->bytes,
        .pixels = it->bytes + it->ndensity
    };
}

/* Put an item into s->msg; false: it has nothing (more) to say. */
static bool
pack(struct strict *s, struct item *it)
{
    switch (it->kind) {
    case ITEM_FACTS:
        return pack_facts(s, it);
    case ITEM_PIECE:
        pack_piece(s, it);
        break;
    case ITEM_GUESS:
        s->msg.type = MSG_GUESS;
        s->msg.guess = (struct msg_guess){
            s->job,         it->frame,    (uint32_t)it->line,
            (uint8_t)it->n, it->ndensity, it->bytes
        };
        break;
    case ITEM_PARKED:
        s->msg.type = MSG_PARKED;
        s->msg.parked = (struct msg_attempt){ s->job, it->unit, it->attempt };
        break;
    case ITEM_RESUMED:
        s->msg.type = MSG_RESUMED;
        s->msg.resumed = (struct msg_attempt){ s->job, it->unit, it->attempt };
        break;
    case ITEM_PAID:
        s->msg.type = MSG_PAID;
        s->msg.paid =
            (struct msg_paid){ s->job, it->unit, it->attempt, it->counts };
        break;
    case ITEM_LINE_COSTS:
        s->msg.type = MSG_LINE_COSTS;
        s->msg.line_costs =
            (struct msg_line_costs){ s->job, it->frame, (uint32_t)it->line,
                                     it->nlines, it->cpu_ns };
        break;
    case ITEM_LOAN:
        s->msg.type = MSG_LOAN;
        s->msg.loan = it->loan;
        break;
    case ITEM_GAVE:
        s->msg.type = MSG_GAVE;
        s->msg.gave =
            (struct msg_gave){ s->job, it->unit, it->attempt, it->height };
        break;
    }
    return true;
}

const struct msg *
strict_message(struct strict *s, bool room)
{
    struct queue *q;

    item_free(s->saying);
    s->saying = NULL;
    while ((q = s->urgent.first         ? &s->urgent
                : room && s->lazy.first ? &s->lazy
                                        : NULL)) {
        struct item *it = q->first;
        bool said = pack(s, it);

        if (said && it->kind == ITEM_FACTS)
            return &s->msg; /* the item stays: there may be more facts */
        pop(q);
        if (said) {
            s->saying = it;
            return &s->msg;
        }
        facts_drop(s, it->frame, it->line);
        item_free(it);
    }
    return NULL;
}

void
out_release(struct strict *s)
{
    struct item *it;

    while ((it = pop(&s->urgent)) || (it = pop(&s->lazy)))
        item_free(it);
    item_free(s->saying);
    free(s->bitmap);
    free(s->bytes);
    free(s->floats);
}
