/* partition_queue.c - windows whose order is not fixed
 *
 * A window's cost is not known before it is done; but the neighbours of a dear
 * window are likely dear.  So windows go out at random at first, which spreads
 * workers over the picture, each with ambient values of its own to make.  Later
 * the neighbours of dear windows go out first, and those of cheap windows last,
 * so that nobody waits long for the last window.
 * A cost is compared with costs measured about the same time, for the first
 * windows pay for ambient values that later windows find.
 *
 * The queue is a heap of the windows that wait, by frame, guessed cost and a
 * random rank.  A window that is taken out of turn stays in the heap, and is
 * skipped. */
#include "config.h"

#include "partition/partition_impl.h"

#include "base/rng.h"

#include <stdlib.h>

/* The usual cost of a pixel is the mean of about so many recent windows. */
#define RECENT 16

struct guess {
    float sum; /* of costs of n neighbours per pixel; 1: the usual cost */
    uint32_t n;
    uint32_t rank;  /* random; no two equal, those of earlier frames below */
    uint32_t place; /* in the heap; PARTITION_NONE: not in the heap any more */
};

struct partition_queue {
    struct guess *guess; /* by unit */
    uint32_t *heap;
    uint32_t n;    /* in heap */
    double usual;  /* cost of a pixel lately; 0: not known */
    uint32_t done; /* all units before this unit are done */
    bool fresh;    /* a frame begins when those before it are done */
};

static double
guessed(const struct guess *g)
{
    return g->n > 0 ? (double)g->sum / g->n : 1;
}

/* Does window a go out before b? */
static bool
is_before(const struct partition *p, uint32_t a, uint32_t b)
{
    const struct guess *guess = p->queue->guess;
    uint32_t fa = p->unit[a].area.frame, fb = p->unit[b].area.frame;
    double ca = guessed(&guess[a]), cb = guessed(&guess[b]);

    if (fa != fb)
        return fa < fb;
    if (ca != cb)
        return ca > cb;
    return guess[a].rank < guess[b].rank;
}

static void
put_at(struct partition_queue *q, uint32_t place, uint32_t unit)
{
    q->heap[place] = unit;
    q->guess[unit].place = place;
}

static void
sift_up(struct partition *p, uint32_t at)
{
    struct partition_queue *q = p->queue;
    uint32_t unit = q->heap[at];

    for (; at > 0; at = (at - 1) / 2) {
        if (!is_before(p, unit, q->heap[(at - 1) / 2]))
            break;
        put_at(q, at, q->heap[(at - 1) / 2]);
    }
    put_at(q, at, unit);
}

static void
sift_down(struct partition *p, uint32_t at)
{
    struct partition_queue *q = p->queue;
    uint32_t unit = q->heap[at];

    for (uint32_t kid; (kid = 2 * at + 1) < q->n; at = kid) {
        if (kid + 1 < q->n && is_before(p, q->heap[kid + 1], q->heap[kid]))
            kid++;
        if (!is_before(p, q->heap[kid], unit))
            break;
        put_at(q, at, q->heap[kid]);
    }
    put_at(q, at, unit);
}

/* Give units [first, end), which are all of a frame, random ranks. */
static void
rank_frame(struct partition_queue *q, uint64_t key, uint32_t first,
           uint32_t end)
{
    for (uint32_t u = first; u < end; u++)
        q->guess[u].rank = u;
    for (uint32_t u = first; u + 1 < end; u++) {
        uint32_t v = u + (uint32_t)(rad_rand(key, u) * (end - u));
        uint32_t t = q->guess[u].rank;

        q->guess[u].rank = q->guess[v].rank;
        q->guess[v].rank = t;
    }
}

bool
queue_new(struct partition *p, uint64_t seed, bool fresh)
{
    struct partition_queue *q = calloc(1, sizeof *q);

    p->queue = q;
    if (!q)
        return false;
    q->guess = calloc(p->total + 1, sizeof *q->guess);
    q->heap = calloc(p->total + 1, sizeof *q->heap);
    if (!q->guess || !q->heap)
        return false;
    for (uint32_t first = 0, end; first < p->total; first = end) {
        uint32_t frame = p->unit[first].area.frame;

        for (end = first; end < p->total; end++)
            if (p->unit[end].area.frame != frame)
                break;
        rank_frame(q, rad_key_branch(rad_mix64(seed), frame), first, end);
    }
    /* nothing is guessed yet: the order is that of ranks, and a sorted array is
     * a heap */
    for (uint32_t u = 0; u < p->total; u++)
        put_at(q, q->guess[u].rank, u);
    q->n = p->total;
    q->fresh = fresh;
    return true;
}

void
queue_free(struct partition *p)
{
    if (!p->queue)
        return;
    free(p->queue->guess);
    free(p->queue->heap);
    free(p->queue);
    p->queue = NULL;
}

static void
drop_first(struct partition *p)
{
    struct partition_queue *q = p->queue;

    q->guess[q->heap[0]].place = PARTITION_NONE;
    if (--q->n == 0)
        return;
    put_at(q, 0, q->heap[q->n]);
    sift_down(p, 0);
}

/* May the unit's frame not go out yet, or are units of earlier frames not
 * done? */
static bool
must_wait(struct partition *p, uint32_t unit)
{
    struct partition_queue *q = p->queue;

    while (q->done < unit && p->unit[q->done].state == PARTITION_DONE)
        q->done++;
    return partition_is_shut(p, unit) ||
           (q->fresh && p->unit[q->done].area.frame < p->unit[unit].area.frame);
}

bool
queue_next(struct partition *p, uint32_t *unit)
{
    struct partition_queue *q = p->queue;

    while (q->n > 0 && !partition_is_free(p, q->heap[0]))
        drop_first(p);
    if (q->n == 0)
        return false;
    *unit = q->heap[0];
    if (must_wait(p, *unit))
        return false;
    drop_first(p);
    return true;
}

static void
guess_beside(struct partition *p, uint32_t unit, double cost)
{
    struct guess *g = &p->queue->guess[unit];

    if (g->place == PARTITION_NONE)
        return;
    g->sum += (float)cost;
    g->n++;
    sift_up(p, g->place);
    sift_down(p, g->place);
}

/* The first unit whose corner is (x, y) of the frame or lies behind: units lie
 * row by row, from left to right. */
static uint32_t
first_from(const struct partition *p, uint32_t frame, uint32_t y, uint32_t x)
{
    uint32_t low = 0, high = p->total;

    while (low < high) {
        uint32_t mid = low + (high - low) / 2;
        const struct partition_area *a = &p->unit[mid].area;
        bool before = a->frame != frame ? a->frame < frame
                      : a->y != y       ? a->y < y
                                        : a->x < x;

        if (before)
            low = mid + 1;
        else
            high = mid;
    }
    return low;
}

/* Does the unit begin left of a, in the row at y, and reach it? */
static bool
reaches(const struct partition *p, uint32_t unit,
        const struct partition_area *a, uint32_t y)
{
    const struct partition_area *b = &p->unit[unit].area;

    return b->frame == a->frame && b->y == y && b->x + b->width >= a->x;
}

/* Note a measured cost at the units of the row at y that share an edge or a
 * corner with area a. */
static void
guess_row(struct partition *p, const struct partition_area *a, uint32_t y,
          double cost)
{
    uint32_t u = first_from(p, a->frame, y, a->x);
    uint32_t end = first_from(p, a->frame, y, a->x + a->width + 1);

    if (u > 0 && reaches(p, u - 1, a, y))
        u--;
    for (; u < end; u++)
        guess_beside(p, u, cost);
}

void
queue_measured(struct partition *p, uint32_t unit, double cost)
{
    struct partition_queue *q = p->queue;
    const struct partition_area a = p->unit[unit].area;
    uint32_t row = first_from(p, a.frame, a.y, 0);
    uint32_t below = first_from(p, a.frame, a.y + 1, 0);

    cost /= (double)a.width * a.height;
    q->usual += (cost - q->usual) / (q->usual > 0 ? RECENT : 1);
    if (!(q->usual > 0))
        return;
    cost /= q->usual;
    if (row > 0 && p->unit[row - 1].area.frame == a.frame)
        guess_row(p, &a, p->unit[row - 1].area.y, cost);
    guess_row(p, &a, a.y, cost);
    if (below < p->total && p->unit[below].area.frame == a.frame)
        guess_row(p, &a, p->unit[below].area.y, cost);
}
