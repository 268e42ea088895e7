/* strict.c - see strict.h
 *
 * Everything is found by frame and line.  Facts belong to a line, not to a
 * unit: they stay while a unit here covers the line, or while they wait to be
 * sent.  So what one unit traced ahead of another's last line serves when that
 * line comes here, and a unit that is split leaves its facts to the next.
 * Tops belong to a line too (struct edge): they are put together from pieces,
 * which may come in any order, twice, or before the unit that needs them.  A
 * bottom that was made here is kept for a unit below that may come; since the
 * coordinator has a copy, an edge that nobody has asked for may go when there
 * are too many.
 * What goes out is of two kinds: what others may wait for is sent at once, the
 * facts of parked units, which only a lost worker makes needed, when there is
 * room; these are dropped when the top comes first. */
#include "config.h"

#include "strict.h"

#include <limits.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* A unit has waited so long for its top before its facts go out: short waits
 * cost no traffic. */
#define PARK_MS 200

/* Pixels of a unit whose facts are kept in case that it gets a twin. */
#define MOST_KEPT (1 << 22)

/* Edges that no unit here asks for; and bytes of facts that none does. */
#define SPARE_EDGES 256
#define SPARE_FACTS (64u << 20)

/* Units and edges are found by frame and line in tables of so many slots: a
 * child may have thousands of units that wait. */
#define SLOTS 1024

/* The base line under some unit, true. */
struct edge {
    struct edge *next;    /* the newer one */
    struct edge *chained; /* in its slot */
    uint32_t frame;
    int line;
    struct rad_pixel *pixels; /* the width */
    uint8_t *density;
    uint8_t *have;  /* by column, then by density: it is there */
    size_t missing; /* how many are not */
};

struct strict_unit {
    struct strict_unit *next;
    struct strict_unit *same_first, *same_last; /* in their slots; the newer */
    uint32_t unit, attempt, frame;
    int first, last; /* lines [first, last) */
    enum team_end end;
    bool make_top; /* base line first - 1 is gone over ahead here too, since
                    * nobody has it, or with the facts of whoever has */
    bool twin;     /* facts go out as they are made */
    bool gone;     /* to be freed when its pass has ended */
    bool over;     /* all its rows are made */
    bool split;    /* GAVE is due when its pass has ended */
    bool at_end;   /* it had nothing to give: others are at its last lines */
    bool lines_done, ahead_done;
    bool bottom_done;   /* the bottom is out, true */
    bool ahead_guessed; /* AHEAD had colours above the first bar */
    bool parked;        /* said, or about to be */
    bool kept;          /* facts went out in case it is lost, or are about to */
    bool waiting;
    uint64_t since_ms; /* waiting: from when */
    struct strict_pass *pass;
    struct msg_counts spent; /* by its passes so far */
    /* its bottom after LINES or AHEAD; NULL: none yet */
    struct rad_pixel *guess;
    uint8_t *guess_density;
    bool guess_poor; /* of one line, with nothing known above it */
};

/* Something to send. */
struct item {
    struct item *next;
    enum { ITEM_FACTS, ITEM_PARKED, ITEM_GAVE, ITEM_PIECE } kind;
    uint32_t unit, attempt; /* of PARKED and GAVE, and of lazy FACTS */
    uint32_t height;        /* of GAVE */
    uint32_t frame;
    int line;
    int row;                  /* of FACTS: those above are out */
    uint32_t x, n;            /* of PIECE */
    uint32_t first, ndensity; /* of PIECE */
    uint8_t *bytes;           /* of PIECE: densities, then pixels */
};

/* A line whose facts came before a unit that has it, as they do with a unit
 * that others were at. */
struct early {
    struct early *next; /* the later one */
    uint32_t frame;
    int line;
    size_t bytes;
};

struct queue {
    struct item *first;
    struct item **end;
};

struct frame {
    struct rad_quincunx q;
    size_t ndensity;
    int nlines;
    _Atomic(struct rad_facts *) *facts; /* by line; NULL: none needed yet */
};

struct strict {
    uint8_t job[MSG_JOB];
    struct frame *frames;
    uint32_t nframes;
    int threads;
    struct strict_unit *units;
    struct strict_unit *by_first[SLOTS], *by_last[SLOTS];
    struct edge *edges; /* the oldest first */
    struct edge *by_line[SLOTS];
    struct early *early, **early_end;
    size_t early_bytes;
    struct queue urgent, lazy;
    struct msg_counts dropped;
    struct item *saying; /* what the message lies in */
    struct msg msg;
    uint8_t *bitmap, *bytes; /* of the message */
    float *floats;
    size_t bitmap_room, floats_room;
    int error;
};

/* --- lines --- */

static const struct frame *
frame_of(const struct strict *s, uint32_t frame)
{
    return &s->frames[frame];
}

static int
channels_of(const struct frame *f)
{
    return f->q.depth ? 4 : 3;
}

/* The first row of the lines from i on: nlines gives the height. */
static int
row_of(const struct frame *f, int i)
{
    return i < f->nlines ? team_line_row(&f->q, i) : f->q.height;
}

/* The line whose first row it is, or nlines for the height; -1: none. */
static int
line_from_row(const struct frame *f, uint32_t row)
{
    int i = row == 0 ? 0 : (int)((row - 1) / (uint32_t)f->q.ystep) + 1;

    if (row == (uint32_t)f->q.height)
        return f->nlines;
    return i < f->nlines && (uint32_t)row_of(f, i) == row ? i : -1;
}

/* Its own lines, and the one whose base line is its top. */
static bool
covers(const struct strict_unit *u, uint32_t frame, int line)
{
    return u->frame == frame && line < u->last && line >= u->first - 1;
}

static struct strict_unit *
find_unit(const struct strict *s, uint32_t unit, uint32_t attempt)
{
    struct strict_unit *u = s->units;

    while (u && (u->unit != unit || u->attempt != attempt || u->gone))
        u = u->next;
    return u;
}

static size_t
slot_of(uint32_t frame, int line)
{
    return (frame * 31 + (uint32_t)line) % SLOTS;
}

/* Units whose first line, or the one after the last, may be that line. */
static struct strict_unit **
first_slot(struct strict *s, uint32_t frame, int line)
{
    return &s->by_first[slot_of(frame, line)];
}

static struct strict_unit **
last_slot(struct strict *s, uint32_t frame, int line)
{
    return &s->by_last[slot_of(frame, line)];
}

static void
link_first(struct strict *s, struct strict_unit *u)
{
    struct strict_unit **at = first_slot(s, u->frame, u->first);

    while (*at)
        at = &(*at)->same_first;
    *at = u;
}

static void
link_last(struct strict *s, struct strict_unit *u)
{
    struct strict_unit **at = last_slot(s, u->frame, u->last);

    while (*at)
        at = &(*at)->same_last;
    *at = u;
}

static void
unlink_first(struct strict *s, struct strict_unit *u)
{
    struct strict_unit **at = first_slot(s, u->frame, u->first);

    while (*at != u)
        at = &(*at)->same_first;
    *at = u->same_first;
    u->same_first = NULL;
}

static void
unlink_last(struct strict *s, struct strict_unit *u)
{
    struct strict_unit **at = last_slot(s, u->frame, u->last);

    while (*at != u)
        at = &(*at)->same_last;
    *at = u->same_last;
    u->same_last = NULL;
}

/* --- facts --- */

static bool
facts_needed(const struct strict *s, uint32_t frame, int line)
{
    for (const struct strict_unit *u = s->units; u; u = u->next)
        if (covers(u, frame, line))
            return true;
    for (const struct item *i = s->urgent.first; i; i = i->next)
        if (i->kind == ITEM_FACTS && i->frame == frame && i->line == line)
            return true;
    return false; /* lazy ones are of units that are there */
}

static struct rad_facts *
facts_at(const struct strict *s, uint32_t frame, int line)
{
    const struct frame *f = frame_of(s, frame);

    if (!f->facts)
        return NULL;
    return atomic_load_explicit(&f->facts[line], memory_order_relaxed);
}

/* Room for the facts of a frame's lines; teams look there for new ones. */
static bool
facts_table(struct strict *s, uint32_t frame)
{
    struct frame *f = &s->frames[frame];

    if (!f->facts)
        f->facts = calloc((size_t)f->nlines, sizeof *f->facts);
    if (!f->facts)
        s->error = RAD_ENOMEM;
    return f->facts;
}

/* Facts of a line, new ones if there are none; NULL: memory is out. */
static struct rad_facts *
facts_make(struct strict *s, uint32_t frame, int line)
{
    struct frame *f = &s->frames[frame];
    struct rad_facts *facts = facts_at(s, frame, line);

    if (facts)
        return facts;
    if (facts_table(s, frame))
        facts = rad_facts_new(f->q.width, team_line_rows(&f->q, line));
    if (!facts) {
        s->error = RAD_ENOMEM;
        return NULL;
    }
    /* pairs with the loads of a team that looks for new facts */
    atomic_store_explicit(&f->facts[line], facts, memory_order_release);
    return facts;
}

static bool
facts_make_all(struct strict *s, const struct strict_unit *u)
{
    for (int i = u->first - (u->make_top ? 1 : 0); i < u->last; i++)
        if (!facts_make(s, u->frame, i))
            return false;
    return true;
}

static void
early_unlink(struct strict *s, struct early **at)
{
    struct early *e = *at;

    *at = e->next;
    if (!*at)
        s->early_end = at;
    s->early_bytes -= e->bytes;
    free(e);
}

static void
early_forget(struct strict *s, uint32_t frame, int line)
{
    struct early **at = &s->early;

    while (*at && ((*at)->frame != frame || (*at)->line != line))
        at = &(*at)->next;
    if (*at)
        early_unlink(s, at);
}

static void
facts_drop(struct strict *s, uint32_t frame, int line)
{
    struct rad_facts *facts = facts_at(s, frame, line);

    if (!facts || facts_needed(s, frame, line))
        return;
    early_forget(s, frame, line);
    atomic_store_explicit(&s->frames[frame].facts[line], NULL,
                          memory_order_relaxed);
    rad_facts_free(facts);
}

/* New facts of a line that no unit here has; the oldest such go if there are
 * too many. */
static void
early_add(struct strict *s, uint32_t frame, int line)
{
    const struct frame *f = frame_of(s, frame);
    struct early *e = calloc(1, sizeof *e);

    if (!e) {
        s->error = RAD_ENOMEM;
        return;
    }
    e->frame = frame;
    e->line = line;
    e->bytes = (size_t)f->q.width * (size_t)team_line_rows(&f->q, line) *
               (sizeof(struct rad_pixel) + 1);
    *s->early_end = e;
    s->early_end = &e->next;
    s->early_bytes += e->bytes;
    while (s->early != e && s->early_bytes > SPARE_FACTS) {
        uint32_t old_frame = s->early->frame;
        int old_line = s->early->line;

        early_unlink(s, &s->early);
        facts_drop(s, old_frame, old_line);
    }
}

/* --- tops and bottoms --- */

static struct edge *
find_edge(const struct strict *s, uint32_t frame, int line)
{
    struct edge *e = s->by_line[slot_of(frame, line)];

    while (e && (e->frame != frame || e->line != line))
        e = e->chained;
    return e;
}

static bool
edge_needed(const struct strict *s, const struct edge *e)
{
    const struct strict_unit *u = s->by_first[slot_of(e->frame, e->line + 1)];

    while (u && (u->gone || u->frame != e->frame || u->first - 1 != e->line))
        u = u->same_first;
    return u;
}

static void
edge_free(struct edge *e)
{
    if (!e)
        return;
    free(e->pixels);
    free(e->density);
    free(e->have);
    free(e);
}

static void
edge_drop(struct strict *s, uint32_t frame, int line)
{
    struct edge *e = find_edge(s, frame, line);
    struct edge **at = &s->edges, **slot = &s->by_line[slot_of(frame, line)];

    if (!e || edge_needed(s, e))
        return;
    while (*at != e)
        at = &(*at)->next;
    *at = e->next;
    while (*slot != e)
        slot = &(*slot)->chained;
    *slot = e->chained;
    edge_free(e);
}

/* Let the oldest go that nobody asks for, if there are too many. */
static void
edges_limit(struct strict *s)
{
    size_t spare = 0;

    for (const struct edge *e = s->edges; e; e = e->next)
        spare += !edge_needed(s, e);
    for (struct edge *e = s->edges, *next; e && spare > SPARE_EDGES; e = next) {
        next = e->next;
        if (edge_needed(s, e))
            continue;
        spare--;
        edge_drop(s, e->frame, e->line);
    }
}

static struct edge *
edge_make(struct strict *s, uint32_t frame, int line)
{
    struct edge *e = find_edge(s, frame, line), **at = &s->edges;
    const struct frame *f = frame_of(s, frame);
    size_t width = (size_t)f->q.width;

    if (e)
        return e;
    edges_limit(s);
    e = calloc(1, sizeof *e);
    if (e) {
        e->frame = frame;
        e->line = line;
        e->pixels = calloc(width, sizeof *e->pixels);
        e->density = calloc(f->ndensity + 1, 1);
        e->have = calloc(width + f->ndensity, 1);
        e->missing = width + f->ndensity;
    }
    if (!e || !e->pixels || !e->density || !e->have) {
        edge_free(e);
        s->error = RAD_ENOMEM;
        return NULL;
    }
    while (*at)
        at = &(*at)->next;
    *at = e;
    e->chained = s->by_line[slot_of(frame, line)];
    s->by_line[slot_of(frame, line)] = e;
    return e;
}

static void
edge_have(struct edge *e, size_t i)
{
    e->missing -= !e->have[i];
    e->have[i] = 1;
}

static void
edge_pixel(struct edge *e, int x, const struct rad_pixel *p)
{
    e->pixels[x] = *p;
    edge_have(e, (size_t)x);
}

static void
edge_density(struct edge *e, const struct frame *f, size_t d, uint8_t density)
{
    e->density[d] = density;
    edge_have(e, (size_t)f->q.width + d);
}

/* --- what waits to be sent --- */

static void
queue_init(struct queue *q)
{
    q->first = NULL;
    q->end = &q->first;
}

static struct item *
push(struct strict *s, struct queue *q, const struct item *it)
{
    struct item *copy = malloc(sizeof *copy);

    if (!copy) {
        s->error = RAD_ENOMEM;
        return NULL;
    }
    *copy = *it;
    copy->next = NULL;
    *q->end = copy;
    q->end = &copy->next;
    return copy;
}

static struct item *
pop(struct queue *q)
{
    struct item *it = q->first;

    if (it) {
        q->first = it->next;
        if (!q->first)
            q->end = &q->first;
    }
    return it;
}

static void
item_free(struct item *it)
{
    if (it)
        free(it->bytes);
    free(it);
}

/* Send the facts of a line that are new, once. */
static void
push_facts(struct strict *s, struct queue *q, const struct strict_unit *u,
           int line)
{
    const struct rad_facts *facts = facts_at(s, u->frame, line);
    struct item it = { .kind = ITEM_FACTS,
                       .unit = u->unit,
                       .attempt = u->attempt,
                       .frame = u->frame,
                       .line = line };

    if (!facts || rad_facts_fresh(facts) == 0)
        return;
    for (const struct item *i = q->first; i; i = i->next)
        if (i->kind == ITEM_FACTS && i->frame == u->frame && i->line == line &&
            i->row == 0)
            return;
    push(s, q, &it);
}

/* Nobody needs the facts of a parked unit any more. */
static void
forget_lazy(struct strict *s, const struct strict_unit *u)
{
    struct item **at = &s->lazy.first, *it;

    while ((it = *at)) {
        if (it->unit == u->unit && it->attempt == u->attempt) {
            *at = it->next;
            item_free(it);
        } else {
            at = &it->next;
        }
    }
    s->lazy.end = at;
}

static void
push_gave(struct strict *s, const struct strict_unit *u)
{
    const struct frame *f = frame_of(s, u->frame);
    struct item it = { .kind = ITEM_GAVE,
                       .unit = u->unit,
                       .attempt = u->attempt,
                       .height = (uint32_t)(row_of(f, u->last) -
                                            row_of(f, u->first)) };

    push(s, &s->urgent, &it);
}

/* --- units --- */

static void
unit_free(struct strict_unit *u)
{
    free(u->guess);
    free(u->guess_density);
    free(u);
}

/* With many frames, do not keep what those that are done had. */
static void
table_drop(struct strict *s, uint32_t frame)
{
    struct frame *f = &s->frames[frame];

    for (const struct strict_unit *u = s->units; u; u = u->next)
        if (u->frame == frame)
            return; /* its pass may look there */
    for (int i = 0; f->facts && i < f->nlines; i++)
        if (facts_at(s, frame, i))
            return;
    free((void *)f->facts);
    f->facts = NULL;
}

/* Facts of a unit that go with it, and nobody was told of. */
static uint64_t
count_untold(const struct strict *s, const struct strict_unit *u)
{
    uint64_t n = 0;

    for (int i = u->first; i < u->last; i++) {
        const struct rad_facts *facts = facts_at(s, u->frame, i);

        if (facts && !facts_needed(s, u->frame, i))
            n += rad_facts_fresh(facts);
    }
    return n;
}

/* Forget a unit that has no pass, its facts and its top. */
static void
unit_drop(struct strict *s, struct strict_unit *u)
{
    struct strict_unit **at = &s->units;

    while (*at != u)
        at = &(*at)->next;
    *at = u->next;
    if (!u->over) {
        msg_counts_add(&s->dropped, &u->spent);
        s->dropped.speculative_rays += count_untold(s, u);
    }
    unlink_first(s, u);
    unlink_last(s, u);
    forget_lazy(s, u);
    for (int i = u->first > 0 ? u->first - 1 : 0; i < u->last; i++)
        facts_drop(s, u->frame, i);
    table_drop(s, u->frame);
    unit_free(u);
}

static bool
top_is_true(const struct strict *s, const struct strict_unit *u)
{
    const struct edge *e;

    if (u->first == 0)
        return true;
    e = find_edge(s, u->frame, u->first - 1);
    return e && e->missing == 0;
}

/* The unit here whose bottom is this one's top; NULL: none. */
static struct strict_unit *
unit_above(const struct strict *s, const struct strict_unit *u)
{
    struct strict_unit *a = s->by_last[slot_of(u->frame, u->first)];

    while (a && (a->gone || a->frame != u->frame || a->last != u->first))
        a = a->same_last;
    return a;
}

static struct strict_unit *
unit_below(const struct strict *s, const struct strict_unit *u)
{
    struct strict_unit *b = s->by_first[slot_of(u->frame, u->last)];

    while (b && (b->gone || b->frame != u->frame || b->first != u->last))
        b = b->same_first;
    return b;
}

static bool
top_is_guessed(const struct strict *s, const struct strict_unit *u)
{
    const struct strict_unit *a = unit_above(s, u);

    return !u->make_top && a && a->guess;
}

/* Is the bottom, to be had before the bars, of use to others? */
static bool
wants_true_lines(const struct strict *s, const struct strict_unit *u)
{
    if (u->bottom_done || u->last == frame_of(s, u->frame)->nlines)
        return false;
    /* over facts it takes no time, and those who wait need not wait until the
     * rows are out; TRUTH makes the bottom of a single line first */
    return u->ahead_done || u->last - u->first > 1;
}

/* What to do for a unit next; false: nothing. */
static bool
next_rank(const struct strict *s, const struct strict_unit *u,
          enum strict_rank *rank)
{
    if (u->pass || u->gone)
        return false;
    if (top_is_true(s, u))
        *rank = wants_true_lines(s, u) ? STRICT_TRUE_LINES : STRICT_TRUTH;
    else if (!u->lines_done)
        *rank = STRICT_LINES;
    else if (!u->ahead_done || (!u->ahead_guessed && top_is_guessed(s, u)))
        *rank = STRICT_AHEAD;
    else
        return false;
    return true;
}

static bool
is_waiting(const struct strict *s, const struct strict_unit *u)
{
    enum strict_rank rank;

    return !u->pass && !u->gone && !next_rank(s, u, &rank);
}

bool
strict_waits(const struct strict *s)
{
    for (const struct strict_unit *u = s->units; u; u = u->next)
        if (is_waiting(s, u))
            return true;
    return false;
}

uint64_t
strict_rays(const struct strict *s)
{
    uint64_t n = 0;

    for (const struct strict_unit *u = s->units; u; u = u->next)
        n += u->gone ? 0 : u->spent.rays;
    return n;
}

void
strict_dropped(const struct strict *s, struct msg_counts *out)
{
    *out = s->dropped;
    out->primary_rays = 0;
    out->nan = (struct msg_nan){ 0 };
    memset(out->faults, 0, sizeof out->faults);
}

static bool
comes_before(enum strict_rank rank, const struct strict_unit *u,
             enum strict_rank than_rank, const struct strict_unit *than)
{
    if (rank != than_rank)
        return rank < than_rank;
    if (u->frame != than->frame)
        return u->frame < than->frame;
    return u->first < than->first;
}

/* What others wait for is due: have a thread leave what is traced ahead, the
 * least urgent of it. */
static void
make_way(struct strict *s)
{
    struct strict_pass *last = NULL;

    for (struct strict_unit *u = s->units; u; u = u->next)
        if (u->pass && !u->pass->true_top && !u->pass->stop &&
            (!last || comes_before(last->rank, last->of, u->pass->rank, u)))
            last = u->pass;
    if (last)
        last->stop = true;
}

/* The tops that this edge was: stop what goes on without it. */
static void
edge_is_true(struct strict *s, const struct edge *e)
{
    for (struct strict_unit *u = s->units; u; u = u->next) {
        if (u->gone || u->frame != e->frame || u->first - 1 != e->line)
            continue;
        forget_lazy(s, u);
        if (!u->pass)
            make_way(s);
        else if (!u->pass->true_top)
            u->pass->stop = true;
    }
}

/* --- what comes in --- */

static int
unit_lines(const struct strict *s, const struct msg_unit *m,
           struct strict_unit *u, struct rad_error *err)
{
    const struct frame *f;
    uint32_t end = m->y + m->height;

    if (m->frame >= s->nframes)
        return rad_fail(err, RAD_EPROTO, "unit %u of frame %u, of %u", m->unit,
                        m->frame, s->nframes);
    f = frame_of(s, m->frame);
    if (m->height < 1 || m->y >= (uint32_t)f->q.height || end < m->y ||
        end > (uint32_t)f->q.height || m->x != 0 ||
        m->width != (uint32_t)f->q.width)
        return rad_fail(err, RAD_EPROTO, "unit %u is not within the frame",
                        m->unit);
    u->first = line_from_row(f, m->y);
    u->last = line_from_row(f, end);
    if (u->first < 0 || u->last <= u->first)
        return rad_fail(err, RAD_EPROTO, "unit %u is no run of lines", m->unit);
    return 0;
}

int
strict_unit(struct strict *s, const struct msg_unit *m, struct rad_error *err)
{
    struct strict_unit *u, **at = &s->units;
    int rc;

    if (find_unit(s, m->unit, m->attempt))
        return 0;
    u = calloc(1, sizeof *u);
    if (!u)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    rc = unit_lines(s, m, u, err);
    if (rc < 0) {
        free(u);
        return rc;
    }
    u->unit = m->unit;
    u->attempt = m->attempt;
    u->frame = m->frame;
    u->end = (enum team_end)m->end;
    u->make_top = m->flags & MSG_UNIT_TOP && u->first > 0;
    u->twin = m->flags & MSG_UNIT_TWIN;
    while (*at)
        at = &(*at)->next;
    *at = u;
    link_first(s, u);
    link_last(s, u);
    return 0;
}

void
strict_revoke(struct strict *s, uint32_t unit, uint32_t attempt)
{
    struct strict_unit *u = find_unit(s, unit, attempt);

    if (!u)
        return;
    if (u->pass) {
        u->gone = true;
        u->pass->stop = true;
    } else {
        unit_drop(s, u);
    }
}

/* Lines from `last` on are no longer the unit's; say so. */
static void
give_lines(struct strict *s, struct strict_unit *u, int last)
{
    int end = u->last;

    u->at_end = last == end;
    if (last < end) {
        /* and the base line above, which whoever gets them would make */
        for (int i = last - 1; i < end; i++)
            push_facts(s, &s->urgent, u, i);
        unlink_last(s, u);
        u->last = last;
        link_last(s, u);
        u->bottom_done = false;
        /* it was that of another line */
        free(u->guess);
        free(u->guess_density);
        u->guess = NULL;
        u->guess_density = NULL;
        for (int i = last; i < end; i++)
            facts_drop(s, u->frame, i);
    }
    push_gave(s, u);
}

/* Give half of a unit that no team is at. */
static void
split_idle(struct strict *s, struct strict_unit *u)
{
    bool begun = u->lines_done && u->ahead_done;

    u->split = false;
    give_lines(s, u, begun ? u->last : u->last - (u->last - u->first) / 2);
}

/* Bars count, so a LINES pass has begun nothing; but its lines are everywhere:
 * it ends first, and is made again, through its facts. */
void
strict_split(struct strict *s, uint32_t unit, uint32_t attempt)
{
    struct strict_unit *u = find_unit(s, unit, attempt);

    if (!u)
        return;
    if (!u->pass) {
        split_idle(s, u);
    } else if (u->pass->mode == TEAM_LINES || u->pass->stop) {
        u->split = true;
        u->pass->stop = true;
    } else {
        u->split = true;
        u->pass->split = true;
    }
}

void
strict_shrunk(struct strict *s, struct strict_pass *p, int last)
{
    struct strict_unit *u = p->of;

    p->split = false;
    if (!u->split)
        return;
    u->split = false;
    p->last = last;
    give_lines(s, u, last);
}

/* What others at the unit need of its facts. */
static void
push_twin_facts(struct strict *s, const struct strict_unit *u)
{
    int from = u->at_end ? u->last - s->threads - 1 : u->first;

    for (int i = from < u->first ? u->first : from; i < u->last; i++)
        push_facts(s, &s->urgent, u, i);
}

void
strict_twin(struct strict *s, uint32_t unit, uint32_t attempt)
{
    struct strict_unit *u = find_unit(s, unit, attempt);

    if (!u || u->twin)
        return;
    u->twin = true;
    if (facts_make_all(s, u))
        push_twin_facts(s, u);
}

static bool
facts_fit(const struct strict *s, const struct msg_facts *m)
{
    const struct frame *f;

    if (m->frame >= s->nframes)
        return false;
    f = frame_of(s, m->frame);
    return m->line < (uint32_t)f->nlines && m->width == (uint32_t)f->q.width &&
           m->channels == channels_of(f);
}

/* Facts of the base line above a unit came from whoever has it: with these
 * colours the first bar can be traced, too. */
static void
use_above(struct strict *s, const struct msg_facts *m)
{
    const struct frame *f = frame_of(s, m->frame);
    int line = (int)m->line;

    if (m->flags & MSG_FACTS_ESTIMATE ||
        (int)(m->row + m->rows) < team_line_rows(&f->q, line))
        return;
    for (struct strict_unit *u = s->units; u; u = u->next)
        if (!u->gone && !u->make_top && u->frame == m->frame &&
            u->first - 1 == line && !top_is_true(s, u) && !unit_above(s, u)) {
            u->make_top = true;
            u->ahead_done = u->ahead_done && u->ahead_guessed;
        }
}

void
strict_facts(struct strict *s, const struct msg_facts *m)
{
    unsigned origin = RAD_FACT_FOREIGN;
    struct rad_facts *facts;
    size_t n = (size_t)m->npixels * m->channels;
    float *pixels;

    if (!facts_fit(s, m))
        return;
    facts = facts_at(s, m->frame, (int)m->line);
    if (!facts && (facts = facts_make(s, m->frame, (int)m->line)) &&
        !facts_needed(s, m->frame, (int)m->line))
        early_add(s, m->frame, (int)m->line);
    pixels = malloc(n * sizeof *pixels + 1);
    if (facts && pixels) {
        if (m->flags & MSG_FACTS_ESTIMATE)
            origin |= RAD_FACT_ESTIMATE;
        wire_floats_get(pixels, m->pixels, n);
        rad_facts_import(facts, (int)m->row, (int)m->rows, m->channels, origin,
                         m->bitmap, pixels, m->npixels);
        use_above(s, m);
    }
    free(pixels);
}

static bool
base_line_fits(const struct strict *s, const struct msg_base_line *m)
{
    const struct frame *f;

    if (m->frame >= s->nframes)
        return false;
    f = frame_of(s, m->frame);
    return m->line < (uint32_t)f->nlines - 1 && m->x <= (uint32_t)f->q.width &&
           m->n <= (uint32_t)f->q.width - m->x && m->first <= f->ndensity &&
           m->ndensity <= f->ndensity - m->first &&
           m->channels == channels_of(f);
}

static void
take_pixel(struct edge *e, uint32_t x, const uint8_t *from, int channels)
{
    struct rad_pixel p = { .z = 0 };
    float v[4];

    wire_floats_get(v, from, (size_t)channels);
    p.L = rad_rgb(v[0], v[1], v[2]);
    if (channels == 4)
        p.z = v[3];
    edge_pixel(e, (int)x, &p);
}

void
strict_base_line(struct strict *s, const struct msg_base_line *m)
{
    size_t size = m->channels * sizeof(float);
    struct edge *e;

    if (!base_line_fits(s, m))
        return;
    e = edge_make(s, m->frame, (int)m->line);
    if (!e || e->missing == 0)
        return;
    for (uint32_t i = 0; i < m->n; i++)
        take_pixel(e, m->x + i, m->pixels + i * size, m->channels);
    for (uint32_t i = 0; i < m->ndensity; i++)
        edge_density(e, frame_of(s, m->frame), m->first + i, m->density[i]);
    if (e->missing == 0)
        edge_is_true(s, e);
}

/* The unit above is here and gets on with its work: it comes soon enough. */
static bool
is_near(const struct strict *s, const struct strict_unit *u)
{
    const struct strict_unit *a = unit_above(s, u);

    return a && !is_waiting(s, a);
}

/* Say so at once: its thread has room for another. */
static void
park(struct strict *s, struct strict_unit *u)
{
    struct item it = { .kind = ITEM_PARKED,
                       .unit = u->unit,
                       .attempt = u->attempt };

    if (u->gone || u->parked || !is_waiting(s, u) || is_near(s, u))
        return;
    u->parked = true;
    push(s, &s->urgent, &it);
}

/* Its facts go out too, where the wait gets long. */
static void
park_facts(struct strict *s, struct strict_unit *u)
{
    u->kept = true;
    for (int i = u->first; i < u->last; i++)
        push_facts(s, &s->lazy, u, i);
}

void
strict_tick(struct strict *s, uint64_t now_ms)
{
    for (struct strict_unit *u = s->units; u; u = u->next) {
        bool waiting = is_waiting(s, u);

        if (u->make_top && !u->gone)
            push_facts(s, &s->urgent, u, u->first - 1);
        if (u->twin && !u->gone)
            push_twin_facts(s, u);
        if (waiting && !u->waiting)
            u->since_ms = now_ms;
        u->waiting = waiting;
        park(s, u);
        if (waiting && u->parked && !u->kept &&
            now_ms - u->since_ms >= PARK_MS && !is_near(s, u))
            park_facts(s, u);
    }
}

/* --- passes --- */

static struct strict_unit *
choose(const struct strict *s, enum strict_rank *rank)
{
    struct strict_unit *best = NULL;
    enum strict_rank r;

    for (struct strict_unit *u = s->units; u; u = u->next)
        if (next_rank(s, u, &r) && (!best || comes_before(r, u, *rank, best))) {
            best = u;
            *rank = r;
        }
    return best;
}

/* Copy what there is of a top: pixels may be NULL. */
static bool
copy_top(const struct strict *s, struct strict_pass *p,
         const struct rad_pixel *pixels, const uint8_t *density)
{
    const struct frame *f = frame_of(s, p->frame);
    size_t n = (size_t)f->q.width * sizeof *p->top;

    if (pixels) {
        p->top = malloc(n);
        if (!p->top)
            return false;
        memcpy(p->top, pixels, n);
    }
    if (f->ndensity > 0) {
        p->top_density = malloc(f->ndensity);
        if (!p->top_density)
            return false;
        memcpy(p->top_density, density, f->ndensity);
    }
    return true;
}

/* The top of a pass, as it is known. */
static bool
set_top(struct strict *s, struct strict_pass *p)
{
    const struct strict_unit *u = p->of, *a = unit_above(s, u);
    const struct edge *e = find_edge(s, u->frame, p->first - 1);

    /* of a line that is another's only the base line is made, not the bar */
    if (e && e->missing == 0)
        return copy_top(s, p, p->first == u->first ? e->pixels : NULL,
                        e->density);
    if (p->first == u->first && a && a->guess) {
        p->poor_top = a->guess_poor;
        return copy_top(s, p, a->guess, a->guess_density);
    }
    return true;
}

static void
pass_free(struct strict_pass *p)
{
    if (!p)
        return;
    free(p->top);
    free(p->top_density);
    free(p);
}

static enum team_mode
mode_of(enum strict_rank rank)
{
    return rank == STRICT_TRUTH   ? TEAM_TRUTH
           : rank == STRICT_AHEAD ? TEAM_AHEAD
                                  : TEAM_LINES;
}

/* What is traced under a true top is of use if others come to the unit before
 * its end; they do not to a whole frame, nor to much as long as there is less.
 */
static bool
may_get_help(const struct strict *s, const struct strict_unit *u)
{
    const struct frame *f = frame_of(s, u->frame);
    int64_t rows = row_of(f, u->last) - row_of(f, u->first);

    return rows < f->q.height && rows * f->q.width <= MOST_KEPT;
}

static struct strict_pass *
pass_new(struct strict *s, struct strict_unit *u, enum strict_rank rank)
{
    struct strict_pass *p = calloc(1, sizeof *p);
    bool facts = rank != STRICT_TRUTH || u->twin || u->end != TEAM_FROM_LEFT ||
                 may_get_help(s, u);

    if (!p)
        return NULL;
    p->of = u;
    p->unit = u->unit;
    p->attempt = u->attempt;
    p->frame = u->frame;
    p->rank = rank;
    p->mode = mode_of(rank);
    p->true_top = rank <= STRICT_TRUTH;
    p->first = u->first - (!p->true_top && u->make_top ? 1 : 0);
    p->last = u->last;
    p->least = u->first + 1;
    p->end = u->end;
    if (!facts_table(s, u->frame) || (facts && !facts_make_all(s, u)) ||
        !set_top(s, p)) {
        pass_free(p);
        return NULL;
    }
    p->facts = frame_of(s, u->frame)->facts;
    return p;
}

struct strict_pass *
strict_next(struct strict *s, enum strict_rank least)
{
    enum strict_rank rank = STRICT_AHEAD;
    struct strict_unit *u = s->error ? NULL : choose(s, &rank);
    struct strict_pass *p;

    if (!u || rank > least)
        return NULL;
    p = pass_new(s, u, rank);
    if (!p)
        s->error = RAD_ENOMEM;
    u->pass = p;
    u->waiting = false;
    return p;
}

/* Something of a bottom goes out. */
static void
push_piece(struct strict *s, const struct strict_pass *p, int columns,
           size_t densities, const struct rad_pixel *pixels,
           const uint8_t *density)
{
    int channels = channels_of(frame_of(s, p->frame));
    struct item it = { .kind = ITEM_PIECE,
                       .frame = p->frame,
                       .line = p->last - 1,
                       .x = (uint32_t)p->sent_columns,
                       .n = (uint32_t)(columns - p->sent_columns),
                       .first = (uint32_t)p->sent_densities,
                       .ndensity = (uint32_t)(densities - p->sent_densities) };
    uint8_t *to;

    it.bytes = to = malloc(it.ndensity + it.n * sizeof(float) * 4 + 1);
    if (!to) {
        s->error = RAD_ENOMEM;
        return;
    }
    memcpy(to, density + it.first, it.ndensity);
    to += it.ndensity;
    for (int x = p->sent_columns; x < columns; x++) {
        const float v[4] = { pixels[x].L.r, pixels[x].L.g, pixels[x].L.b,
                             pixels[x].z };

        wire_floats_put(to, v, (size_t)channels);
        to += (size_t)channels * sizeof(float);
    }
    if (!push(s, &s->urgent, &it))
        free(it.bytes);
}

void
strict_bottom(struct strict *s, struct strict_pass *p, int columns,
              size_t densities, const struct rad_pixel *pixels,
              const uint8_t *density)
{
    const struct frame *f = frame_of(s, p->frame);
    bool all = columns == f->q.width && densities == f->ndensity;
    struct edge *e;

    if (!p->true_top || p->of->gone || p->of->bottom_done ||
        p->last == f->nlines || columns < p->sent_columns ||
        densities < p->sent_densities ||
        (columns - p->sent_columns < f->q.xstep && !all) ||
        (p->sent_columns == f->q.width && p->sent_densities == f->ndensity) ||
        !(e = edge_make(s, p->frame, p->last - 1)))
        return;
    push_piece(s, p, columns, densities, pixels, density);
    for (int x = p->sent_columns; x < columns; x++)
        edge_pixel(e, x, &pixels[x]);
    for (size_t d = p->sent_densities; d < densities; d++)
        edge_density(e, f, d, density[d]);
    p->sent_columns = columns;
    p->sent_densities = densities;
    if (!all)
        return;
    p->of->bottom_done = true;
    edge_is_true(s, e);
}

/* LINES or AHEAD is done: its bottom is a guess for the unit below. */
static void
keep_guess(struct strict *s, struct strict_unit *u,
           const struct rad_pixel *pixels, const uint8_t *density)
{
    const struct frame *f = frame_of(s, u->frame);
    size_t n = (size_t)f->q.width * sizeof *u->guess;

    if (!u->guess) {
        u->guess = malloc(n);
        u->guess_density = malloc(f->ndensity + 1);
    }
    if (!u->guess || !u->guess_density) {
        s->error = RAD_ENOMEM;
        return;
    }
    memcpy(u->guess, pixels, n);
    if (f->ndensity > 0)
        memcpy(u->guess_density, density, f->ndensity);
}

/* Facts of its lines that are there for nothing. */
static uint64_t
count_unused(const struct strict *s, const struct strict_unit *u)
{
    uint64_t n = 0;

    for (int i = u->first; i < u->last; i++) {
        const struct rad_facts *facts = facts_at(s, u->frame, i);

        n += facts ? rad_facts_unused(facts) : 0;
        n += facts && u->twin ? rad_facts_doubled(facts) : 0;
    }
    return n;
}

static void
end_ahead(struct strict *s, struct strict_unit *u, struct strict_pass *p,
          const struct rad_pixel *pixels, const uint8_t *density)
{
    const struct frame *f = frame_of(s, u->frame);

    strict_bottom(s, p, f->q.width, f->ndensity, pixels, density);
    if (p->mode == TEAM_AHEAD) {
        u->ahead_done = true;
        u->ahead_guessed = p->top || p->first < u->first;
    }
    u->lines_done = true;
    if (p->mode == TEAM_LINES && !p->true_top && u->last < f->nlines &&
        !unit_below(s, u))
        push_facts(s, &s->urgent, u, u->last - 1);
    if (pixels)
        keep_guess(s, u, pixels, density);
    u->guess_poor = p->first > 0 && p->last - p->first == 1 && !p->top_density;
}

/* TRUTH is made: what the unit cost. */
static void
end_truth(struct strict *s, struct strict_pass *p,
          const struct rad_pixel *pixels, const uint8_t *density,
          struct msg_counts *total)
{
    const struct strict_unit *u = p->of;
    const struct frame *f = frame_of(s, u->frame);

    strict_bottom(s, p, f->q.width, f->ndensity, pixels, density);
    p->of->over = true;
    *total = u->spent;
    total->speculative_rays = count_unused(s, u);
    /* a unit below that made its top may have them still */
    for (int i = u->first; i < u->last; i++)
        if (facts_at(s, u->frame, i))
            rad_facts_settle(facts_at(s, u->frame, i));
}

/* Forget the unit and, if it is done, the top that it needed.  One that was
 * revoked may come again, and its top may have come already: before it. */
static void
end_unit(struct strict *s, struct strict_unit *u, bool over)
{
    uint32_t frame = u->frame;
    int top = u->first - 1;

    unit_drop(s, u);
    if (over)
        edge_drop(s, frame, top);
}

void
strict_look(struct strict *s, struct strict_pass *p, struct team *t)
{
    struct team_bottom b;

    if (p->stop)
        team_stop(t);
    if (p->split)
        strict_shrunk(s, p, team_shrink(t, p->least));
    if (!p->true_top)
        return;
    team_bottom(t, &b);
    if (b.pixels)
        strict_bottom(s, p, b.columns, b.ndensity, b.pixels, b.density);
}

bool
strict_ended(struct strict *s, struct strict_pass *p, bool done,
             const struct rad_pixel *pixels, const uint8_t *density,
             const struct msg_counts *spent, struct msg_counts *total)
{
    struct strict_unit *u = p->of;
    bool over = done && !u->gone && p->mode == TEAM_TRUTH;

    msg_counts_add(&u->spent, spent);
    if (u->make_top && !u->gone)
        push_facts(s, &s->urgent, u, u->first - 1);
    if (over)
        end_truth(s, p, pixels, density, total);
    else if (done && !p->stop)
        end_ahead(s, u, p, pixels, density);
    u->pass = NULL;
    pass_free(p);
    if (over || u->gone)
        end_unit(s, u, over);
    else if (u->split)
        split_idle(s, u);
    for (u = s->units; u; u = u->next)
        park(s, u);
    return over;
}

/* --- what goes out --- */

static bool
room_for(struct strict *s, size_t bitmap, size_t floats)
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

/* The next rows' facts of an item into the message; false: there are no more.
 */
static bool
say_facts(struct strict *s, struct item *it)
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

        if (!room_for(s, (size_t)n * stride, (size_t)n * width * channels))
            return false;
        it->row += n;
        count = rad_facts_export(facts, row, n, (int)channels, 0, s->bitmap,
                                 s->floats);
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
say_piece(struct strict *s, const struct item *it)
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

/* Put an item into the message; false: there is nothing (more) to say. */
static bool
say(struct strict *s, struct item *it)
{
    switch (it->kind) {
    case ITEM_FACTS:
        return say_facts(s, it);
    case ITEM_PIECE:
        say_piece(s, it);
        break;
    case ITEM_PARKED:
        s->msg.type = MSG_PARKED;
        s->msg.parked = (struct msg_attempt){ s->job, it->unit, it->attempt };
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
        bool said = say(s, it);

        if (said && it->kind == ITEM_FACTS)
            return &s->msg; /* there may be more of it */
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

/* --- life --- */

int
strict_error(const struct strict *s)
{
    return s->error;
}

static void
frame_release(struct frame *f)
{
    for (int i = 0; f->facts && i < f->nlines; i++)
        rad_facts_free(
            atomic_load_explicit(&f->facts[i], memory_order_relaxed));
    free((void *)f->facts);
}

void
strict_free(struct strict *s)
{
    struct item *it;

    if (!s)
        return;
    while (s->units) {
        struct strict_unit *u = s->units;

        s->units = u->next;
        unit_free(u);
    }
    while (s->edges) {
        struct edge *e = s->edges;

        s->edges = e->next;
        edge_free(e);
    }
    while (s->early)
        early_unlink(s, &s->early);
    while ((it = pop(&s->urgent)) || (it = pop(&s->lazy)))
        item_free(it);
    item_free(s->saying);
    for (uint32_t i = 0; i < s->nframes; i++)
        frame_release(&s->frames[i]);
    free(s->frames);
    free(s->bitmap);
    free(s->bytes);
    free(s->floats);
    free(s);
}

struct strict *
strict_new(const struct rad_quincunx *frames, uint32_t nframes, int threads,
           const uint8_t job[MSG_JOB])
{
    struct strict *s = calloc(1, sizeof *s);

    if (!s)
        return NULL;
    queue_init(&s->urgent);
    queue_init(&s->lazy);
    s->early_end = &s->early;
    memcpy(s->job, job, MSG_JOB);
    s->threads = threads;
    s->frames = calloc(nframes + 1, sizeof *s->frames);
    if (!s->frames) {
        strict_free(s);
        return NULL;
    }
    s->nframes = nframes;
    for (uint32_t i = 0; i < nframes; i++) {
        s->frames[i].q = frames[i];
        s->frames[i].ndensity = rad_quincunx_ndensity(&frames[i]);
        s->frames[i].nlines = rad_quincunx_nbases(&frames[i]);
    }
    return s;
}
