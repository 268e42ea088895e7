/* host.c - a worker of a simulated cluster: its radd and its job's child
 *
 * The child has one team, as fast as the host.  Units of windows are done one
 * after the other.  Strict units are strict.c's: the team goes over the lines
 * of a pass as team.c does, base line, then bar, in blocks of columns, and puts
 * what it traced into the facts; what it lends it leaves out.  Every second
 * pixel is one that the sampler wants.  What is known already takes no time. So
 * a guess never misleads: the few rays that wrong guesses cost are left out. */
#include "config.h"

#include "cluster.h"

#include "base/bits.h"
#include "picture/hdr.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Rows are sent when so many bytes of them are done, as in pool.c. */
#define PIECE_BYTES (64u << 10)

/* Columns, in percent, whose mantissas are no run: so a coded pixel has 2.4
 * bytes, as in pictures of the office at night with bench/hosts.sh's options.
 */
#define NOISY 78

/* Columns that lie between traced pixels together, and those that do not. */
#define SURE_COLUMNS 8

#define TICK_US 10000 /* of strict_tick() */
#define PS      1e-12 /* seconds that nobody waits for */

/* The office at night makes so many rays in a second on one processor. */
#define RAYS_PER_S 1.7e6

/* A pixel's cost has about its mean as standard deviation. */
#define SPREAD 1.0

struct window {
    struct window *next;
    struct msg_unit unit;
};

struct asked {
    struct asked *next;
    uint32_t id, n;
    struct msg_cost *costs;
    double seconds;
};

/* A base line that was made here, and who waits for one. */
struct bottom {
    struct bottom *next;
    uint32_t frame, line;
    bool made;
    int to; /* -1: nobody */
};

struct host {
    struct cluster *cluster;
    int number;
    char name[16];
    double speed;
    uint64_t conn;
    unsigned life; /* those that died before: their events are void */
    uint64_t up_us, down_us, peer_us;
    struct rad_quincunx *frames; /* for strict_new() */
    struct strict *strict;       /* NULL: no job */
    struct strict_pass *pass;
    int line, block, last; /* of the pass: where it is, and its end */
    bool in_bar;
    struct team_blocks lent; /* of the pass's last line */
    bool skipped;            /* the pass left some of that out */
    int sent_row;            /* of a TRUTH pass: those above are out */
    double pass_s;
    bool lines; /* it has had strict units */
    struct window *windows;
    struct asked *asked;
    struct bottom *bottoms;
    bool working, ticking;
    uint64_t idle_us; /* since when it waits for a top; 0: it does not */
    bool ready;
    enum host_state state;
    uint64_t state_us; /* since when */
    /* for the result */
    double busy_s, wait_s;
    uint64_t traced, units;
    struct rad_pixel *pixels; /* a base line, black */
    uint8_t *density, *bytes; /* rows, black */
    uint8_t *code;            /* rows of a piece, each of so many bytes, */
    size_t row_bytes;
    uint32_t code_width; /* of so many columns */
};

/* --- small things --- */

size_t
host_size(void)
{
    return sizeof(struct host);
}

struct host *
host_at(const struct cluster *c, int i)
{
    return &c->hosts[i];
}

uint64_t
host_conn(const struct host *h)
{
    return h->conn;
}

uint64_t *
host_up_us(struct host *h)
{
    return &h->up_us;
}

uint64_t *
host_down_us(struct host *h)
{
    return &h->down_us;
}

uint64_t *
host_peer_us(struct host *h)
{
    return &h->peer_us;
}

static const struct map *
map_of(const struct host *h)
{
    return h->cluster->spec->map;
}

static void
later(struct host *h, double delay_us, void (*fn)(void *arg, struct event *e))
{
    struct event e = { .at_us =
                           h->cluster->events.now_us + (uint64_t)ceil(delay_us),
                       .fn = fn,
                       .host = h->number,
                       .n = h->life };

    events_add(&h->cluster->events, &e);
}

/* The host that an event is for; NULL: it died since. */
static struct host *
alive(void *arg, const struct event *e)
{
    struct host *h = host_at(arg, e->host);

    return h->life == e->n ? h : NULL;
}

static void
say(struct host *h, const struct msg *m)
{
    if (h->conn != 0)
        cluster_send(h->cluster, h->number, m);
}

static void
send_tally(struct host *h)
{
    struct msg m = { .type = MSG_TALLY };

    m.tally.job = h->cluster->job;
    m.tally.busy_s = h->busy_s + h->wait_s;
    m.tally.wait_base_line_s = h->wait_s;
    say(h, &m);
}

/* Rows of so many columns as they travel; returns how many are in a piece. */
static uint32_t
code_piece(struct host *h, uint32_t width)
{
    uint8_t *rgbe;

    if (h->code_width != width) {
        rgbe = sim_alloc(4 * (size_t)width);
        for (uint32_t i = 0; i < 4 * width * NOISY / 100; i++)
            rgbe[i] = i % 4 == 3 ? 128 : (uint8_t)(i * 2654435761u >> 24);
        h->row_bytes = rad_hdr_encode_rgbe(rgbe, (int)width, h->code);
        for (size_t n = h->row_bytes; n <= PIECE_BYTES; n += h->row_bytes)
            memcpy(h->code + n, h->code, h->row_bytes);
        h->code_width = width;
        free(rgbe);
    }
    return PIECE_BYTES / (uint32_t)h->row_bytes + 1;
}

/* Rows of a unit, in pieces as long as a child's. */
static void
send_rows(struct host *h, uint32_t unit, uint32_t attempt, uint32_t width,
          uint32_t row, uint32_t rows, uint32_t height,
          const struct msg_counts *counts)
{
    uint32_t most = code_piece(h, width);
    struct msg m = { .type = MSG_RESULT };

    while (rows > 0) {
        uint32_t n = rows < most ? rows : most;

        m.result = (struct msg_result){ .job = h->cluster->job,
                                        .unit = unit,
                                        .attempt = attempt,
                                        .row = row,
                                        .rows = n,
                                        .width = width,
                                        .channels = 1,
                                        .last = row + n == height,
                                        .pixels = h->code,
                                        .len = n * h->row_bytes };
        if (m.result.last) {
            m.result.counts = *counts;
            send_tally(h);
            h->units++;
        }
        say(h, &m);
        row += n;
        rows -= n;
    }
}

static struct msg_counts
counts_of(const struct host *h, double seconds, double wall_s, uint64_t pixels)
{
    double rays = seconds * h->speed * RAYS_PER_S;

    return (struct msg_counts){ .rays = (uint64_t)rays,
                                .primary_rays = pixels,
                                .intersection_tests = (uint64_t)(3 * rays),
                                .cpu_s = seconds,
                                .wall_s = wall_s };
}

/* Work costs more where it is done twice over. */
static double
seconds_for(const struct host *h, double cost)
{
    const struct cluster_spec *s = h->cluster->spec;

    return cost * (1 + s->growth * log2(s->hosts)) / h->speed;
}

/* --- strict units: pixels --- */

static bool
is_wanted(int x, int row)
{
    return (x + row) % 2 == 0;
}

/* Where too little is known of the densities above a bar, team.c traces ahead
 * only columns between two traced pixels (TEAM_SURE): here half of them, in
 * groups. */
static bool
is_unsure(const struct host *h)
{
    const struct strict_pass *p = h->pass;
    int known = h->line - p->first + (p->top_density ? p->top_known : 0);

    return h->in_bar && (p->mode == TEAM_AHEAD || p->mode == TEAM_LINES) &&
           !p->true_top && p->first > 0 && known < TEAM_SURE;
}

/* Whether a guess traces column x, of which the truth wants some rows. */
static bool
is_sure(const struct host *h, bool unsure, int x)
{
    const struct team_loan *loan = h->pass->loan;
    int i = loan ? x - loan->x : 0;

    if (loan && h->in_bar)
        return loan->wanted[i / 8] >> i % 8 & 1;
    return !unsure || x / SURE_COLUMNS % 5 < 3;
}

static bool
is_traced(const struct host *h, bool unsure, int x, int row)
{
    return is_wanted(x, row) && is_sure(h, unsure, x);
}

/* Blocks of columns, as team.c has them, each an event. */
static int
blocks(const struct host *h)
{
    const struct rad_quincunx *q = &map_of(h)->q;
    int columns = team_block_columns(q);

    return (q->width + columns - 1) / columns;
}

/* The block that is number k in the order of the pass. */
static int
nth_block(const struct host *h, int k)
{
    int n = blocks(h);

    switch (h->pass->end) {
    case TEAM_FROM_LEFT:
        break;
    case TEAM_FROM_RIGHT:
        return n - 1 - k;
    case TEAM_MIDDLE_RIGHTWARDS:
        return (k + n / 2) % n;
    case TEAM_MIDDLE_LEFTWARDS:
        return (n + n / 2 - 1 - k) % n;
    }
    return k;
}

/* Columns of the block that the pass is at. */
static void
block_of(const struct host *h, int *x0, int *x1)
{
    const struct rad_quincunx *q = &map_of(h)->q;
    int columns = team_block_columns(q);

    *x0 = columns * nth_block(h, h->block);
    *x1 = *x0 + columns < q->width ? *x0 + columns : q->width;
}

/* Is it another's? */
static bool
is_lent(const struct host *h)
{
    uint64_t lent = h->in_bar ? h->lent.bar : h->lent.base;

    return h->line == h->last - 1 && lent >> nth_block(h, h->block) & 1;
}

/* Rows of the line that the pass is at, as its facts number them. */
static void
rows_of(const struct host *h, int *r0, int *r1)
{
    int n = team_line_rows(&map_of(h)->q, h->line);

    *r0 = h->in_bar ? 0 : n - 1;
    *r1 = h->in_bar ? n - 1 : n;
}

static struct rad_facts *
facts_of(const struct host *h)
{
    if (!h->pass->facts)
        return NULL;
    return atomic_load_explicit(&h->pass->facts[h->line], memory_order_relaxed);
}

/* What the block that the pass is at still costs, in seconds of speed 1. */
static double
missing(const struct host *h)
{
    const struct rad_facts *facts = facts_of(h);
    const struct map *m = map_of(h);
    int top = team_line_row(&m->q, h->line), x0, x1, r0, r1;
    bool unsure = is_unsure(h);
    double sum = 0;
    struct rad_pixel p;

    block_of(h, &x0, &x1);
    rows_of(h, &r0, &r1);
    for (int r = r0; r < r1; r++) {
        int n = 0, wanted = 0;

        for (int x = x0; x < x1; x++) {
            wanted += is_wanted(x, r);
            n += is_traced(h, unsure, x, r) &&
                 (!facts || !rad_facts_get(facts, x, r, &p));
        }
        if (n > 0)
            sum += map_row(m, h->pass->frame, top + r, x1 - x0) * n / wanted;
    }
    return sum;
}

/* The ends of a base line's gaps, where the sampler looks whether another's
 * facts are all that it needs; they cost nothing more. */
static void
fill_ends(struct host *h, struct rad_facts *facts, int x0, int x1)
{
    const struct rad_quincunx *q = &map_of(h)->q;
    int row = rad_facts_rows(facts) - 1, n = rad_quincunx_ngaps(q, h->line);
    static const struct rad_pixel black;
    struct rad_pixel p;

    for (int g = 0; g <= n; g++) {
        int x = rad_quincunx_gap_begin(q, h->line, g);

        if (x >= x0 && x < x1 && !rad_facts_use(facts, x, row, &p))
            rad_facts_put(facts, x, row, &black, RAD_FACT_USED);
    }
}

/* The block is traced; with TRUTH its facts are used. */
static void
fill(struct host *h)
{
    bool truth = h->pass->mode == TEAM_TRUTH, unsure = is_unsure(h);
    struct rad_facts *facts = facts_of(h);
    static const struct rad_pixel black;
    int x0, x1, r0, r1;
    struct rad_pixel p;

    block_of(h, &x0, &x1);
    rows_of(h, &r0, &r1);
    for (int r = r0; r < r1; r++)
        for (int x = x0; x < x1; x++) {
            if (!is_traced(h, unsure, x, r))
                continue;
            if (!facts) {
                h->traced++;
            } else if (truth ? rad_facts_use(facts, x, r, &p)
                             : rad_facts_get(facts, x, r, &p)) {
                continue;
            } else {
                h->traced++;
                rad_facts_put(facts, x, r, &black, truth ? RAD_FACT_USED : 0);
            }
        }
    if (facts && !h->in_bar)
        fill_ends(h, facts, x0, x1);
}

/* --- base lines to peers --- */

static struct bottom *
bottom_of(struct host *h, uint32_t frame, uint32_t line)
{
    struct bottom *b = h->bottoms;

    while (b && (b->frame != frame || b->line != line))
        b = b->next;
    if (!b) {
        b = sim_alloc(sizeof *b);
        b->frame = frame;
        b->line = line;
        b->to = -1;
        b->next = h->bottoms;
        h->bottoms = b;
    }
    return b;
}

/* A piece goes to whoever waits; what was made before is sent when one says
 * that it waits. */
static void
pass_on(struct host *h, const struct msg *m)
{
    const struct msg_base_line *l = &m->base_line;
    struct bottom *b = bottom_of(h, l->frame, l->line);

    b->made |= l->x + l->n == (uint32_t)map_of(h)->q.width;
    if (b->to >= 0)
        cluster_send_peer(h->cluster, h->number, b->to, m);
}

static void
next_holder(struct host *h, const struct msg_next_holder *n)
{
    struct bottom *b = bottom_of(h, n->frame, n->line);
    const struct map *map = map_of(h);
    struct msg m = { .type = MSG_BASE_LINE };

    b->to = cluster_find(h->cluster, n->name);
    if (b->to == h->number)
        b->to = -1; /* it has it itself */
    if (b->to < 0 || !b->made)
        return;
    m.base_line =
        (struct msg_base_line){ .job = h->cluster->job,
                                .frame = n->frame,
                                .line = n->line,
                                .n = (uint32_t)map->q.width,
                                .ndensity =
                                    (uint32_t)rad_quincunx_ndensity(&map->q),
                                .channels = 3,
                                .density = h->density,
                                .pixels = h->bytes };
    cluster_send_peer(h->cluster, h->number, b->to, &m);
}

/* --- strict units: passes --- */

static void flush(struct host *h);
static void go_on(struct host *h);

static int
row_of(const struct host *h, int line)
{
    const struct map *m = map_of(h);

    return line < m->nlines ? team_line_row(&m->q, line) : m->q.height;
}

/* Send rows of a TRUTH pass above `row`; total: what the unit cost, if these
 * are its last. */
static void
send_strict_rows(struct host *h, const struct strict_pass *p, int row,
                 const struct msg_counts *total)
{
    uint32_t y = (uint32_t)row_of(h, p->least - 1);
    uint32_t width = (uint32_t)map_of(h)->q.width;

    send_rows(h, p->unit, p->attempt, width, (uint32_t)h->sent_row - y,
              (uint32_t)(row - h->sent_row),
              total ? (uint32_t)row - y : UINT32_MAX, total);
    h->sent_row = row;
}

/* Rows above `row` are done: out with them when they fill a piece. */
static void
rows_done(struct host *h, int row)
{
    uint32_t width = (uint32_t)map_of(h)->q.width;

    if (row > h->sent_row &&
        (uint32_t)(row - h->sent_row) >= code_piece(h, width))
        send_strict_rows(h, h->pass, row, NULL);
}

/* Bottoms and what was given away are told before the last rows. */
static void
end_pass(struct host *h, bool done)
{
    struct strict_pass *p = h->pass, was = *p;
    uint64_t pixels = (uint64_t)map_of(h)->q.width *
                      (uint64_t)(row_of(h, h->last) - row_of(h, p->first)) / 2;
    struct msg_counts total;
    bool blocked = done && h->skipped && p->mode == TEAM_TRUTH;
    struct msg_counts spent =
        counts_of(h, h->pass_s, h->pass_s,
                  p->mode == TEAM_TRUTH && !blocked ? pixels : 0);

    if (blocked) {
        done = false;
        strict_blocked(h->strict, p, h->last - 1);
        if (row_of(h, h->last - 1) > h->sent_row)
            send_strict_rows(h, p, row_of(h, h->last - 1), NULL);
    }
    h->pass = NULL;
    p->finished = h->line;
    if (!strict_ended(h->strict, p, done, h->pixels, h->density, &spent,
                      &total))
        return;
    flush(h);
    send_strict_rows(h, &was, row_of(h, h->last), &total);
}

/* Half of the lines that are not begun, as team_shrink() does. */
static void
shrink(struct host *h)
{
    int begun = h->line + 1;

    if (begun < h->pass->least)
        begun = h->pass->least;
    if (begun < h->last)
        h->last -= (h->last - begun + 1) / 2;
    strict_shrunk(h->strict, h->pass, h->last);
}

/* The bits of those that follow in the order of the pass. */
static uint64_t
not_begun(const struct host *h, int from)
{
    uint64_t bits = 0;

    for (int k = from; k < blocks(h); k++)
        bits |= UINT64_C(1) << nth_block(h, k);
    return bits;
}

static bool
has_bar(const struct host *h)
{
    const struct strict_pass *p = h->pass;

    return (p->mode != TEAM_LINES || h->line < p->filled) && h->line != 0 &&
           (p->mode == TEAM_TRUTH || p->loan || h->line != p->first || p->top);
}

/* Is anything known of that column of the bar? */
static bool
knows(const struct host *h, int x)
{
    int rows = team_line_rows(&map_of(h)->q, h->line) - 1;
    struct rad_pixel p;

    for (int r = 0; r < rows; r++)
        if (rad_facts_get(facts_of(h), x, r, &p))
            return true;
    return false;
}

/* Of the blocks' bars: those of which something is not known yet.  Of base
 * lines those of which nothing is. */
static uint64_t
not_known(const struct host *h, uint64_t blocks)
{
    const struct rad_quincunx *q = &map_of(h)->q;
    int columns = team_block_columns(q), last = team_line_rows(q, h->line) - 1;
    struct rad_pixel p;

    for (int x = 0; x < q->width; x++) {
        uint64_t bit = UINT64_C(1) << x / columns;

        if (!h->in_bar && is_wanted(x, last) &&
            rad_facts_get(facts_of(h), x, last, &p))
            blocks &= ~bit;
    }
    for (int b = 0; b * columns < q->width; b++) {
        bool lacks = false;

        for (int x = b * columns; x < (b + 1) * columns && x < q->width; x++)
            lacks |= is_sure(h, is_unsure(h), x) && !knows(h, x);
        if (!lacks)
            blocks &= ~(UINT64_C(1) << b);
    }
    return blocks;
}

/* Lend part of the last line, as team_lend() does: the right end of it. */
static void
lend(struct host *h)
{
    struct strict_pass *p = h->pass;
    const struct rad_quincunx *q = &map_of(h)->q;
    int columns = team_block_columns(q), n = 0, end = blocks(h);
    int rows = team_line_rows(q, h->line) - 1, bars;
    double base = 1.5 / (1.5 + rows), bar = rows / (1.5 + rows), left;
    uint64_t lines = h->in_bar ? 0 : not_begun(h, h->block + 1);
    uint64_t free = h->in_bar ? not_begun(h, h->block + 1) : UINT64_MAX;
    uint8_t wanted[8192];
    struct team_loan loan = { .line = h->line, .wanted = wanted };

    if (h->line != h->last - 1 || !has_bar(h) || !facts_of(h) ||
        (!h->in_bar && p->mode == TEAM_AHEAD))
        return;
    free &= team_blocks_of(q, 0, q->width) & ~h->lent.bar & ~h->lent.ever;
    lines &= ~h->lent.base & ~h->lent.ever;
    free = not_known(h, free);
    bars = rad_count_bits(free);
    left = base * rad_count_bits(lines) + bar * bars;
    if (!h->in_bar)
        free &= lines;
    loan.base = !h->in_bar;
    loan.given = loan.base ? base + bar : bar;
    while (end > 0 && !(free >> (end - 1) & 1))
        end--;
    while (n < end && free >> (end - 1 - n) & 1 &&
           (n + 1) * loan.given <= p->lend * left + .5 * loan.given)
        n++;
    if (n == 0)
        return;
    loan.x = (end - n) * columns;
    loan.n = (end * columns < q->width ? end * columns : q->width) - loan.x;
    loan.given *= (double)n / blocks(h);
    loan.left = left / blocks(h) - loan.given;
    loan.top = h->pixels;
    loan.density = loan.base ? h->density : NULL;
    loan.bottom = loan.base ? NULL : h->pixels;
    memset(wanted, 0, sizeof wanted);
    for (int i = 0; i < loan.n; i++)
        if (is_sure(h, is_unsure(h), loan.x + i) && !knows(h, loan.x + i))
            wanted[i / 8] |= (uint8_t)(1u << i % 8);
    h->lent.bar |= team_blocks_of(q, loan.x, loan.n);
    if (loan.base)
        h->lent.base |= team_blocks_of(q, loan.x, loan.n);
    h->lent.ever |= team_blocks_of(q, loan.x, loan.n);
    strict_lent(h->strict, p, &loan);
}

/* What the machine wants of the pass that is under way. */
static void
look(struct host *h)
{
    struct strict_pass *p = h->pass;

    if (!p)
        return;
    h->lent.base &= ~p->back;
    h->lent.bar &= ~p->back;
    p->back = 0;
    if (p->lend > 0)
        lend(h);
}

/* A line's base line, from its first column to this block's end, is true. */
static void
tell_bottom(struct host *h)
{
    const struct map *m = map_of(h);
    size_t n = rad_quincunx_ndensity(&m->q);
    int x0, x1;

    if (!h->pass->true_top || h->in_bar || h->skipped ||
        h->line != h->last - 1 || h->pass->end != TEAM_FROM_LEFT)
        return;
    block_of(h, &x0, &x1);
    strict_bottom(h->strict, h->pass, x1, n * (size_t)x1 / (size_t)m->q.width,
                  h->pixels, h->density);
}

/* On to the next block, base line, then bar, then line; false: the end. */
static bool
step(struct host *h)
{
    const struct strict_pass *p = h->pass;

    if (++h->block < blocks(h))
        return true;
    h->block = 0;
    if (!h->in_bar && has_bar(h)) {
        h->in_bar = true;
        return true;
    }
    h->in_bar = false;
    h->line++;
    if (p->mode == TEAM_TRUTH && h->line < h->last)
        rows_done(h, row_of(h, h->line));
    return h->line < h->last;
}

static void
traced(void *arg, struct event *e)
{
    struct host *h = alive(arg, e);

    if (!h)
        return;
    h->working = false;
    if (h->pass) {
        fill(h);
        tell_bottom(h);
        if (!step(h))
            end_pass(h, !h->pass->stop);
    }
    go_on(h);
}

/* Trace what the pass lacks; true: it takes time. */
static bool
trace(struct host *h)
{
    double seconds;

    for (;;) {
        if (h->pass->stop) {
            end_pass(h, false);
            return false;
        }
        if (h->pass->split)
            shrink(h);
        look(h);
        if (is_lent(h)) {
            h->skipped |= !h->pass->loan;
        } else {
            seconds = seconds_for(h, missing(h));
            if (seconds > PS)
                break;
            fill(h);
            tell_bottom(h);
        }
        if (!step(h)) {
            end_pass(h, true);
            return false;
        }
    }
    h->pass_s += seconds;
    h->busy_s += seconds;
    h->working = true;
    later(h, 1e6 * seconds, traced);
    return true;
}

static bool
begin_pass(struct host *h)
{
    h->pass = strict_next(h->strict, STRICT_AHEAD);
    if (!h->pass)
        return false;
    h->line = h->pass->first;
    h->last = h->pass->last;
    h->block = 0;
    h->in_bar = h->pass->loan && !h->pass->loan->base;
    h->lent = h->pass->lent;
    h->skipped = false;
    if (h->pass->loan)
        h->lent.bar |=
            ~team_blocks_of(&map_of(h)->q, h->pass->loan->x, h->pass->loan->n);
    if (h->pass->loan)
        h->lent.base |= h->lent.bar;
    h->sent_row = row_of(h, h->pass->out > h->line ? h->pass->out : h->line);
    h->pass_s = 0;
    return true;
}

/* --- windows and estimates --- */

static void
window_done(void *arg, struct event *e)
{
    struct host *h = alive(arg, e);
    struct window *w;
    struct msg_counts counts;
    double seconds;

    if (!h)
        return;
    h->working = false;
    w = h->windows;
    h->windows = w->next;
    seconds = seconds_for(h, map_window(map_of(h), &w->unit));
    counts = counts_of(h, seconds, seconds, w->unit.width * w->unit.height / 2);
    send_rows(h, w->unit.unit, w->unit.attempt, w->unit.width, 0,
              w->unit.height, w->unit.height, &counts);
    free(w);
    go_on(h);
}

static void
estimate_done(void *arg, struct event *e)
{
    struct host *h = alive(arg, e);
    struct msg m = { .type = MSG_ESTIMATED };
    struct asked *a;

    if (!h)
        return;
    h->working = false;
    a = h->asked;
    h->asked = a->next;
    m.estimated = (struct msg_estimated){ .job = h->cluster->job,
                                          .id = a->id,
                                          .ncosts = a->n,
                                          .costs = a->costs,
                                          .counts = counts_of(h, a->seconds,
                                                              a->seconds, 0) };
    say(h, &m);
    free(a->costs);
    free(a);
    go_on(h);
}

static void
spend(struct host *h, double seconds, void (*fn)(void *arg, struct event *e))
{
    h->busy_s += seconds;
    h->working = true;
    later(h, 1e6 * seconds, fn);
}

/* A number of mean 0 and deviation 1. */
static double
gauss(struct cluster *c)
{
    double sum = 0;

    for (int i = 0; i < 12; i++)
        sum += cluster_random(c);
    return sum - 6;
}

/* What n pixels of the area cost, by chance, in seconds of speed 1. */
static double
sampled(struct host *h, const struct msg_area *a, uint32_t n)
{
    const struct map *m = map_of(h);
    uint32_t pixels = a->width * a->height;
    double mean = 0, chance;

    for (uint32_t y = a->y; y < a->y + a->height; y++)
        mean += map_row(m, a->frame, (int)y, (int)a->width);
    mean /= .5 * pixels; /* of a pixel that is traced */
    if (n > pixels)
        n = pixels;
    chance = 1 + SPREAD / sqrt(n) * gauss(h->cluster);
    return n * mean * (chance > 0 ? chance : 0);
}

static void
take_estimate(struct host *h, const struct msg_estimate *m)
{
    struct asked *a = sim_alloc(sizeof *a), **at = &h->asked;

    a->id = m->id;
    a->n = m->nareas;
    a->costs = sim_alloc(m->nareas * sizeof *a->costs);
    for (uint32_t i = 0; i < m->nareas; i++) {
        double cost = sampled(h, &m->areas[i], m->rays);

        a->costs[i].rays = (uint64_t)(cost * RAYS_PER_S);
        a->costs[i].tests = (uint64_t)(3 * cost * RAYS_PER_S);
        a->seconds += cost / h->speed;
    }
    while (*at)
        at = &(*at)->next;
    *at = a;
}

static void
take_unit(struct host *h, const struct msg_unit *u)
{
    struct window *w, **at = &h->windows;

    if (u->mode == MSG_MODE_STRICT) {
        struct rad_error err = { 0 };

        if (strict_unit(h->strict, u, &err) < 0) {
            fprintf(stderr, "sim: %s: %s\n", h->name, err.what);
            abort();
        }
        h->lines = true;
        return;
    }
    w = sim_alloc(sizeof *w);
    w->unit = *u;
    while (*at)
        at = &(*at)->next;
    *at = w;
}

static void
revoke(struct host *h, const struct msg_attempt *r)
{
    struct window **at = &h->windows;

    strict_revoke(h->strict, r->unit, r->attempt);
    if (*at && h->working && !h->pass)
        at = &(*at)->next; /* it is at the first */
    for (; *at; at = &(*at)->next)
        if ((*at)->unit.unit == r->unit && (*at)->unit.attempt == r->attempt) {
            struct window *w = *at;

            *at = w->next;
            free(w);
            return;
        }
}

/* --- what it does next --- */

static void
count_wait(struct host *h)
{
    bool waits = !h->working && strict_waits(h->strict);

    if (waits && h->idle_us == 0)
        h->idle_us = h->cluster->events.now_us;
    if (!waits && h->idle_us != 0) {
        h->wait_s += 1e-6 * (double)(h->cluster->events.now_us - h->idle_us);
        h->idle_us = 0;
    }
}

static enum host_state
state_of(const struct host *h)
{
    if (!h->ready)
        return HOST_LOADS;
    if (h->working)
        return h->pass && !h->pass->true_top && !h->pass->loan ? HOST_AHEAD
                                                               : HOST_TRUTH;
    return strict_waits(h->strict) ? HOST_WAITS : HOST_EMPTY;
}

/* Book what it did since it began with that. */
static void
note_state(struct host *h, enum host_state next)
{
    const struct cluster *c = h->cluster;
    double slice_us = 1e6 * c->out->work / c->out->speed / CLUSTER_SLICES_IDEAL;
    double at = (double)h->state_us - (double)c->start_us;
    double end = (double)c->events.now_us - (double)c->start_us;

    if (at < 0)
        at = 0;
    while (at < end) {
        int k = (int)(at / slice_us);
        double to = fmin(end, (k + 1) * slice_us);

        if (k >= CLUSTER_SLICES)
            k = CLUSTER_SLICES - 1;
        if (to <= at)
            to = end;
        c->out->state_s[k][h->state] += 1e-6 * (to - at);
        at = to;
    }
    h->state = next;
    h->state_us = c->events.now_us;
}

void
host_over(struct host *h)
{
    note_state(h, h->state);
}

static void
work(struct host *h)
{
    while (!h->working) {
        if (h->pass) {
            if (trace(h))
                return;
        } else if (h->asked) {
            spend(h, h->asked->seconds, estimate_done);
        } else if (h->windows) {
            spend(h, seconds_for(h, map_window(map_of(h), &h->windows->unit)),
                  window_done);
        } else if (!begin_pass(h)) {
            return;
        }
    }
}

/* Say what there is to say. */
static void
flush(struct host *h)
{
    const struct msg *m;

    while ((m = strict_message(h->strict, true))) {
        say(h, m);
        if (m->type == MSG_BASE_LINE)
            pass_on(h, m);
    }
}

static void
tick(void *arg, struct event *e)
{
    struct host *h = alive(arg, e);

    if (!h)
        return;
    h->ticking = false;
    if (!h->strict)
        return;
    strict_tick(h->strict, h->cluster->events.now_us / 1000);
    go_on(h);
}

static void
go_on(struct host *h)
{
    work(h);
    flush(h);
    count_wait(h);
    if (state_of(h) != h->state)
        note_state(h, state_of(h));
    if (!h->ticking && h->lines) {
        h->ticking = true;
        later(h, TICK_US, tick);
    }
}

/* --- the job --- */

static void
ready(void *arg, struct event *e)
{
    struct host *h = alive(arg, e);
    struct msg m = { .type = MSG_READY };

    if (!h)
        return;
    m.ready = (struct msg_ready){ h->cluster->job,
                                  1e-6 * h->cluster->spec->load_us, 42, 1 };
    say(h, &m);
    h->ready = true;
    note_state(h, HOST_EMPTY);
}

static void
start_job(struct host *h)
{
    const struct map *m = map_of(h);

    h->strict = strict_new(h->frames, m->nframes, false, h->cluster->job);
    if (!h->strict)
        abort();
    later(h, h->cluster->spec->load_us / h->speed, ready);
}

void
host_message(struct cluster *c, struct host *h, const struct msg *m)
{
    (void)c;
    if (m->type == MSG_JOB_START && !h->strict)
        start_job(h);
    if (!h->strict)
        return;
    switch (m->type) {
    case MSG_UNIT:
        take_unit(h, &m->unit);
        break;
    case MSG_REVOKE:
        revoke(h, &m->revoke);
        break;
    case MSG_TWIN:
        strict_twin(h->strict, m->twin.unit, m->twin.attempt);
        break;
    case MSG_SPLIT:
        strict_split(h->strict, m->split.unit, m->split.attempt);
        if (h->pass && h->pass->split)
            shrink(h);
        break;
    case MSG_LEND:
        strict_lend(h->strict, &m->lend);
        look(h);
        break;
    case MSG_LOAN:
        if (strict_loan(h->strict, &m->loan, NULL) < 0)
            abort();
        h->lines = true;
        break;
    case MSG_BACK:
        strict_back(h->strict, &m->back);
        look(h);
        break;
    case MSG_FACTS:
        strict_facts(h->strict, &m->facts);
        break;
    case MSG_BASE_LINE:
        strict_base_line(h->strict, &m->base_line);
        break;
    case MSG_NEXT_HOLDER:
        next_holder(h, &m->next_holder);
        break;
    case MSG_ESTIMATE:
        take_estimate(h, &m->estimate);
        break;
    default:
        return;
    }
    go_on(h);
}

void
host_dial(struct cluster *c, struct host *h)
{
    struct msg m = { .type = MSG_HELLO };

    h->conn = cluster_open(c, h->number);
    m.hello = (struct msg_hello){ 1,       2,     MSG_ROLE_WORKER,
                                  h->name, "sim", "tcp 127.0.0.1:1",
                                  1,       42 };
    say(h, &m);
}

static void
dial_again(void *arg, struct event *e)
{
    struct host *h = alive(arg, e);

    if (h)
        host_dial(arg, h);
}

/* What its process had. */
static void
forget(struct host *h)
{
    if (h->pass)
        end_pass(h, false);
    strict_free(h->strict);
    h->strict = NULL;
    while (h->windows) {
        struct window *w = h->windows;

        h->windows = w->next;
        free(w);
    }
    while (h->asked) {
        struct asked *a = h->asked;

        h->asked = a->next;
        free(a->costs);
        free(a);
    }
    h->lines = false;
    while (h->bottoms) {
        struct bottom *b = h->bottoms;

        h->bottoms = b->next;
        free(b);
    }
}

void
host_fail(struct cluster *c, struct host *h)
{
    h->conn = 0;
    h->life++;
    h->ready = false;
    note_state(h, HOST_LOADS);
    forget(h);
    h->working = h->ticking = false;
    h->idle_us = 0;
    later(h, c->spec->back_us, dial_again);
}

void
host_init(struct cluster *c, struct host *h, int number, double speed)
{
    const struct map *m = c->spec->map;
    size_t width = (size_t)m->q.width;

    h->cluster = c;
    h->number = number;
    h->speed = speed;
    snprintf(h->name, sizeof h->name, "w%d", number);
    h->frames = sim_alloc(m->nframes * sizeof *h->frames);
    for (uint32_t k = 0; k < m->nframes; k++)
        h->frames[k] = m->q;
    h->pixels = sim_alloc(width * sizeof *h->pixels);
    h->density = sim_alloc(rad_quincunx_ndensity(&m->q));
    h->bytes = sim_alloc(PIECE_BYTES + width * 16);
    h->code = sim_alloc(PIECE_BYTES + 2 * RAD_HDR_ROW_BYTES(width));
}

void
host_release(struct host *h)
{
    forget(h);
    free(h->frames);
    free(h->pixels);
    free(h->density);
    free(h->bytes);
    free(h->code);
}

void
host_count(const struct host *h, struct cluster_result *out)
{
    out->busy_s += h->busy_s;
    if (h->wait_s > out->wait_s)
        out->wait_s = h->wait_s;
    out->units += h->units;
    out->traced += h->traced;
}
