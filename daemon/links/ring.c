/* ring.c - see ring.h */
#include "config.h"

#include "links/ring.h"

#include "jobs/part.h"
#include "links/introduce.h"

#include <stdlib.h>
#include <string.h>

#define ALL_LINKED 64 /* workers of a job, but for coord_env.all_linked */

/* With a radix of 2, 3, 4 and 8, each of 1000 places has 10, 13, 15 and 22
 * links each way, and a record passes 5.0, 4.2, 3.7 and 2.9 links on its way.
 */
#define RADIX 4

#define REBUILD_MS 2000 /* least time between two changes of places */
#define LINE_LINKS 16   /* of a worker, beside those of the ring */

#define HOPELESS 2 /* links in a row that never came about */

enum pair_kind {
    PAIR_RING,
    PAIR_GUEST,
    PAIR_LINES,
    PAIR_STALE /* of the former ring: for records under way on it */
};

struct pair {
    uint32_t a, b; /* workers of the job, a < b */
    uint8_t kind;
    uint32_t sequence; /* of those for lines */
};

/* A pair of workers whose link broke, or never came about. */
struct broken {
    uint32_t a, b;  /* workers of the job, a < b */
    unsigned times; /* reports in a row that there is no link */
};

struct ring {
    bool changed; /* since places were given */
    bool stale;   /* there are links of before */
    uint64_t built_ms;
    uint32_t generation;
    uint32_t *member; /* worker by place; JOB_NOBODY: the worker has gone */
    uint32_t nmembers;
    uint32_t cap;                     /* of the arrays by worker: */
    uint32_t *place, *host, *nguests; /* JOB_NOBODY: none */
    bool *out;                        /* may have no place, for lack of links */
    struct broken *broken;
    size_t nbroken;
    struct pair *pair; /* in the order of a and b */
    size_t npairs, cap_pairs;
    uint32_t sequence;
};

bool
ring_link(uint32_t places, uint32_t i, uint32_t *offset, uint32_t *below)
{
    uint64_t power = 1, at;

    for (uint32_t k = i / (RADIX - 1); k > 0 && power < places; k--)
        power *= RADIX;
    at = power * (i % (RADIX - 1) + 1);
    if (at >= places)
        return false;
    *offset = (uint32_t)at;
    *below = (uint32_t)power;
    return true;
}

void
ring_free(struct ring *r)
{
    if (!r)
        return;
    free(r->member);
    free(r->place);
    free(r->host);
    free(r->nguests);
    free(r->out);
    free(r->broken);
    free(r->pair);
    free(r);
}

/* --- workers that may have a place --- */

static bool
is_here(const struct job *job, uint32_t i)
{
    return job->workers[i].state == PART_READY && job->workers[i].worker->conn;
}

static bool
may_have_place(const struct job *job, uint32_t i)
{
    const struct coord_worker *w = job->workers[i].worker;

    return is_here(job, i) && w->address[0] != '\0';
}

static bool
shares_records(const struct job *job)
{
    return job->spec.flags & MSG_JOB_SHARE;
}

bool
ring_wanted(const struct coord *c, const struct job *job)
{
    uint32_t most = c->env.all_linked ? c->env.all_linked : ALL_LINKED, n = 0;

    for (uint32_t i = 0; i < job->nworkers; i++) {
        const struct coord_worker *w = job->workers[i].worker;

        n += part_is_here(&job->workers[i]) && w->conn != 0 &&
             w->address[0] != '\0';
    }
    return job->ring || n > most;
}

/* --- pairs --- */

static int
by_workers(const void *x, const void *y)
{
    const struct pair *p = x, *q = y;

    if (p->a != q->a)
        return p->a < q->a ? -1 : 1;
    return (p->b > q->b) - (p->b < q->b);
}

static struct pair
pair_of(uint32_t a, uint32_t b, enum pair_kind kind)
{
    return (struct pair){ a < b ? a : b, a < b ? b : a, (uint8_t)kind, 0 };
}

static struct pair *
find_pair(const struct ring *r, uint32_t a, uint32_t b)
{
    struct pair key = pair_of(a, b, PAIR_RING);

    return r->npairs > 0
               ? bsearch(&key, r->pair, r->npairs, sizeof key, by_workers)
               : NULL;
}

static bool
make_room_for_pairs(struct ring *r, size_t n)
{
    struct pair *p;

    if (n <= r->cap_pairs)
        return true;
    p = realloc(r->pair, 2 * n * sizeof *p);
    if (!p)
        return false;
    r->pair = p;
    r->cap_pairs = 2 * n;
    return true;
}

static void
remove_pair(struct ring *r, size_t i)
{
    memmove(&r->pair[i], &r->pair[i + 1],
            (--r->npairs - i) * sizeof r->pair[0]);
}

/* End the link of a pair. */
static void
drop(struct coord *c, const struct job *job, const struct pair *p)
{
    const uint32_t end[2] = { p->a, p->b };

    for (int i = 0; i < 2; i++)
        if (job->workers[end[i]].worker->conn != 0 &&
            part_is_here(&job->workers[end[i]]))
            introduce_unlink(c, job, job->workers[end[i]].worker,
                             job->workers[end[!i]].worker);
}

/* --- pairs that have no link --- */

static struct broken *
find_broken(const struct ring *r, uint32_t a, uint32_t b)
{
    for (size_t i = 0; i < r->nbroken; i++)
        if (r->broken[i].a == (a < b ? a : b) &&
            r->broken[i].b == (a < b ? b : a))
            return &r->broken[i];
    return NULL;
}

/* Note that the link of two workers is gone, or never came about; NULL: memory
 * is out. */
static struct broken *
note_broken(struct ring *r, uint32_t a, uint32_t b, bool was)
{
    struct broken *p = find_broken(r, a, b);

    if (!p) {
        p = realloc(r->broken, (r->nbroken + 1) * sizeof *p);
        if (!p)
            return NULL;
        r->broken = p;
        p += r->nbroken++;
        *p = (struct broken){ .a = a < b ? a : b, .b = a < b ? b : a };
    }
    p->times = was ? 0 : p->times + 1;
    return p;
}

/* Forget the broken links of a worker that is new or comes again: it may be
 * another machine. */
static void
forget_broken(struct ring *r, uint32_t index)
{
    size_t n = 0;

    for (size_t i = 0; i < r->nbroken; i++)
        if (r->broken[i].a != index && r->broken[i].b != index)
            r->broken[n++] = r->broken[i];
    r->nbroken = n;
}

static bool
is_hopeless(const struct ring *r, uint32_t a, uint32_t b)
{
    const struct broken *p = find_broken(r, a, b);

    return p && p->times >= HOPELESS;
}

static size_t
count_hopeless(const struct ring *r, uint32_t index)
{
    size_t n = 0;

    for (size_t i = 0; i < r->nbroken; i++)
        n += r->broken[i].times >= HOPELESS &&
             (r->broken[i].a == index || r->broken[i].b == index);
    return n;
}

/* On a ring any two may come to need a link; so of two workers that can have
 * none, the worker that lacks more links has no place. */
static void
find_out(struct ring *r)
{
    memset(r->out, 0, r->cap * sizeof *r->out);
    for (size_t i = 0; i < r->nbroken; i++) {
        const struct broken *p = &r->broken[i];

        if (p->times < HOPELESS || r->out[p->a] || r->out[p->b])
            continue;
        if (count_hopeless(r, p->a) > count_hopeless(r, p->b))
            r->out[p->a] = true;
        else
            r->out[p->b] = true;
    }
}

static bool
link_two(struct coord *c, const struct job *job, uint32_t a, uint32_t b,
         uint32_t give)
{
    return introduce_link(c, job, job->workers[a].worker,
                          job->workers[b].worker, give);
}

/* Link a pair that has no link; the first may be asked to give the second its
 * records. */
static bool
introduce(struct coord *c, struct job *job, uint32_t a, uint32_t b,
          enum pair_kind kind, uint32_t give)
{
    struct ring *r = job->ring;
    struct pair p = pair_of(a, b, kind);
    size_t i = r->npairs;

    if (!make_room_for_pairs(r, r->npairs + 1)) {
        c->actions.failed = true;
        return false;
    }
    if (!link_two(c, job, a, b, give))
        return false;
    while (i > 0 && by_workers(&r->pair[i - 1], &p) > 0)
        i--;
    memmove(&r->pair[i + 1], &r->pair[i], (r->npairs++ - i) * sizeof p);
    p.sequence = r->sequence++;
    r->pair[i] = p;
    return true;
}

/* --- messages to workers --- */

/* A worker's links on the ring, and those to its guests. */
static uint32_t
list_links(const struct job *job, uint32_t index, struct msg_ring_link *v)
{
    const struct ring *r = job->ring;
    uint32_t offset, below, n = 0;

    for (uint32_t i = 0; r->place[index] != JOB_NOBODY &&
                         ring_link(r->nmembers, i, &offset, &below);
         i++) {
        uint32_t to = r->member[(r->place[index] + offset) % r->nmembers];

        if (to != JOB_NOBODY)
            v[n++] =
                (struct msg_ring_link){ offset, below, job->workers[to].name };
    }
    for (uint32_t i = 0; i < r->cap; i++)
        if (r->host[i] == index || r->host[index] == i)
            v[n++] = (struct msg_ring_link){ 0, 0, job->workers[i].name };
    return n;
}

static void
send_ring(struct coord *c, const struct job *job, uint32_t index)
{
    const struct ring *r = job->ring;
    const struct coord_worker *w = job->workers[index].worker;
    struct msg_ring_link *v;
    struct msg m = { .type = MSG_RING };

    if (w->conn == 0)
        return;
    /* no more than a digit for each bit of a place, and guests */
    v = calloc(32 * RADIX + (size_t)r->nguests[index] + 1, sizeof *v);
    if (!v) {
        c->actions.failed = true;
        return;
    }
    m.ring.job = job->id;
    m.ring.generation = r->generation;
    m.ring.places = r->place[index] != JOB_NOBODY ? r->nmembers : 0;
    m.ring.nlinks = list_links(job, index, v);
    m.ring.links = v;
    actions_send(&c->actions, w->conn, &m);
    free(v);
}

/* --- guests --- */

/* A host for the guest: a worker on the ring with few guests, if possible
 * without a broken link to this guest. */
static uint32_t
best_host(const struct job *job, uint32_t guest)
{
    const struct ring *r = job->ring;
    uint32_t best = JOB_NOBODY;
    unsigned least = HOPELESS;

    for (uint32_t i = 0; i < r->nmembers; i++) {
        uint32_t m = r->member[i];
        const struct broken *b =
            m != JOB_NOBODY ? find_broken(r, guest, m) : NULL;
        unsigned times = b ? b->times : 0;

        if (m == JOB_NOBODY || m == guest || times > least || times >= HOPELESS)
            continue;
        if (best == JOB_NOBODY || times < least ||
            r->nguests[m] < r->nguests[best])
            best = m;
        least = times;
    }
    return best;
}

static void
be_guest(struct ring *r, uint32_t guest, uint32_t host)
{
    if (r->host[guest] != JOB_NOBODY)
        r->nguests[r->host[guest]]--;
    r->host[guest] = host;
    if (host != JOB_NOBODY)
        r->nguests[host]++;
}

/* Find a host on the ring for a guest. */
static void
take_in(struct coord *c, struct job *job, uint32_t guest, uint32_t give)
{
    struct ring *r = job->ring;
    uint32_t host = best_host(job, guest);
    struct pair *old;

    r->changed |= may_have_place(job, guest) && !r->out[guest];
    if (host == JOB_NOBODY)
        return;
    old = find_pair(r, host, guest);
    if (old) /* a link of another kind, which the new one replaces */
        remove_pair(r, (size_t)(old - r->pair));
    if (!introduce(c, job, host, guest, PAIR_GUEST, give))
        return;
    be_guest(r, guest, host);
    send_ring(c, job, host);
    send_ring(c, job, guest);
}

/* --- places --- */

/* Make room in the arrays that are indexed by worker. */
static bool
grow(struct ring *r, uint32_t n)
{
    uint32_t **of[] = { &r->place, &r->host, &r->nguests };

    for (int i = 0; i < 3 && n > r->cap; i++) {
        uint32_t *v = realloc(*of[i], n * sizeof *v);

        if (!v)
            return false;
        *of[i] = v;
    }
    if (n > r->cap) {
        bool *out = realloc(r->out, n * sizeof *out);

        if (!out)
            return false;
        r->out = out;
    }
    for (; r->cap < n; r->cap++) {
        r->out[r->cap] = false;
        r->place[r->cap] = r->host[r->cap] = JOB_NOBODY;
        r->nguests[r->cap] = 0;
    }
    return true;
}

/* Give places to all workers that may have one but `except`, and hosts to those
 * that are guests or may never have a place. */
static bool
give_places(struct job *job, uint32_t except)
{
    struct ring *r = job->ring;
    uint32_t *member = realloc(r->member, (r->cap + 1) * sizeof *member);

    if (!member)
        return false;
    r->member = member;
    r->nmembers = 0;
    find_out(r);
    for (uint32_t i = 0; i < job->nworkers; i++) {
        r->place[i] = JOB_NOBODY;
        if (i == except || r->out[i] || !may_have_place(job, i))
            continue;
        be_guest(r, i, JOB_NOBODY);
        r->place[i] = r->nmembers;
        member[r->nmembers++] = i;
    }
    for (uint32_t i = 0; i < job->nworkers; i++)
        if (r->place[i] == JOB_NOBODY && i != except && is_here(job, i) &&
            (r->host[i] == JOB_NOBODY || r->place[r->host[i]] == JOB_NOBODY ||
             is_hopeless(r, i, r->host[i])))
            be_guest(r, i, best_host(job, i));
    return true;
}

/* All pairs that are to be linked for records, in their order; NULL: no
 * memory. */
static struct pair *
list_wanted(const struct job *job, size_t *n)
{
    const struct ring *r = job->ring;
    uint32_t offset, below, per = 0;
    struct pair *v;

    while (ring_link(r->nmembers, per, &offset, &below))
        per++;
    v = calloc((size_t)r->nmembers * per + r->cap + 1, sizeof *v);
    *n = 0;
    for (uint32_t p = 0; v && p < r->nmembers; p++)
        for (uint32_t i = 0; ring_link(r->nmembers, i, &offset, &below); i++)
            v[(*n)++] = pair_of(
                r->member[p], r->member[(p + offset) % r->nmembers], PAIR_RING);
    for (uint32_t i = 0; v && i < job->nworkers; i++)
        if (r->host[i] != JOB_NOBODY)
            v[(*n)++] = pair_of(r->host[i], i, PAIR_GUEST);
    if (v)
        qsort(v, *n, sizeof *v, by_workers);
    return v;
}

/* A link that is there and no longer wanted stays for a while, for records that
 * are under way on it. */
static void
spare(struct coord *c, const struct job *job, struct pair *to, size_t *n,
      const struct pair *p)
{
    if (p->kind == PAIR_STALE) {
        drop(c, job, p);
        return;
    }
    to[*n] = *p;
    to[(*n)++].kind = p->kind == PAIR_RING ? PAIR_STALE : PAIR_LINES;
}

/* Link the pairs that are wanted, and keep those that are linked already. */
static bool
relink(struct coord *c, struct job *job)
{
    struct ring *r = job->ring;
    size_t nwanted, i = 0, n = 0;
    struct pair *wanted = list_wanted(job, &nwanted), *to;

    to = wanted ? calloc(nwanted + r->npairs + 1, sizeof *to) : NULL;
    for (size_t k = 0; to && k < nwanted; k++) {
        if (n > 0 && by_workers(&wanted[k], &to[n - 1]) == 0)
            continue; /* from both sides */
        while (i < r->npairs && by_workers(&r->pair[i], &wanted[k]) < 0)
            spare(c, job, to, &n, &r->pair[i++]);
        if (i < r->npairs && by_workers(&r->pair[i], &wanted[k]) == 0)
            i++;
        else if (!link_two(c, job, wanted[k].a, wanted[k].b, 0))
            continue;
        to[n++] = wanted[k];
    }
    while (to && i < r->npairs)
        spare(c, job, to, &n, &r->pair[i++]);
    free(wanted);
    if (!to)
        return false;
    free(r->pair);
    r->pair = to;
    r->npairs = r->cap_pairs = n;
    return true;
}

static void
rebuild(struct coord *c, struct job *job, uint32_t except)
{
    struct ring *r = job->ring;

    r->changed = false;
    r->stale = true;
    r->built_ms = c->now_ms;
    c->env.random(c->env.arg, &r->generation, sizeof r->generation);
    if (!grow(r, job->nworkers) || !give_places(job, except) ||
        !relink(c, job)) {
        c->actions.failed = true;
        return;
    }
    for (uint32_t i = 0; i < job->nworkers; i++)
        if (r->place[i] != JOB_NOBODY || r->host[i] != JOB_NOBODY)
            send_ring(c, job, i);
    actions_log(&c->actions, ACT_DEBUG, "ring job=%s places=%u links=%zu",
                job->hex, r->nmembers, r->npairs);
}

/* The job had few workers, and all that are ready are linked with all: note
 * these pairs. */
static bool
begin(struct coord *c, struct job *job, uint32_t newcomer)
{
    struct ring *r = job->ring = calloc(1, sizeof *r);

    if (!r || !grow(r, job->nworkers))
        return false;
    for (uint32_t a = 0; a < job->nworkers; a++)
        for (uint32_t b = a + 1; b < job->nworkers; b++) {
            if (a == newcomer || b == newcomer || !is_here(job, a) ||
                !is_here(job, b))
                continue;
            if (!make_room_for_pairs(r, r->npairs + 1))
                return false;
            r->pair[r->npairs++] =
                pair_of(a, b, shares_records(job) ? PAIR_RING : PAIR_LINES);
        }
    if (shares_records(job))
        rebuild(c, job, newcomer);
    return true;
}

void
ring_join(struct coord *c, struct job *job, uint32_t index)
{
    if ((!job->ring && !begin(c, job, index)) ||
        !grow(job->ring, job->nworkers)) {
        c->actions.failed = true;
        return;
    }
    if (!shares_records(job))
        return;
    if (job->ring->nmembers == 0)
        rebuild(c, job, JOB_NOBODY);
    if (job->ring->place[index] == JOB_NOBODY)
        take_in(c, job, index, MSG_PEER_GIVE);
}

void
ring_left(struct coord *c, struct job *job, uint32_t index)
{
    struct ring *r = job->ring;

    if (!r || index >= r->cap)
        return;
    for (size_t i = r->npairs; i-- > 0;)
        if (r->pair[i].a == index || r->pair[i].b == index) {
            drop(c, job, &r->pair[i]);
            remove_pair(r, i);
        }
    if (r->place[index] != JOB_NOBODY)
        r->member[r->place[index]] = JOB_NOBODY;
    r->place[index] = JOB_NOBODY;
    be_guest(r, index, JOB_NOBODY);
    forget_broken(r, index);
    for (uint32_t i = 0; i < r->cap; i++)
        if (r->host[i] == index) {
            be_guest(r, i, JOB_NOBODY);
            take_in(c, job, i, 0);
        }
    r->changed = true;
}

/* End stale links: the records under way on them have come. */
static void
drop_stale(struct coord *c, struct job *job)
{
    struct ring *r = job->ring;
    size_t n = 0;

    for (size_t i = 0; i < r->npairs; i++)
        if (r->pair[i].kind == PAIR_STALE)
            drop(c, job, &r->pair[i]);
        else
            r->pair[n++] = r->pair[i];
    r->npairs = n;
    r->stale = false;
}

void
ring_tick(struct coord *c, struct job *job)
{
    struct ring *r = job->ring;
    uint32_t waiting = 0;

    if (!r || !shares_records(job))
        return;
    if (r->stale && c->now_ms - r->built_ms >= REBUILD_MS)
        drop_stale(c, job);
    if (!r->changed)
        return;
    for (uint32_t i = 0; i < r->cap; i++)
        waiting += r->host[i] != JOB_NOBODY && may_have_place(job, i);
    if (2 * waiting > r->nmembers || c->now_ms - r->built_ms >= REBUILD_MS)
        rebuild(c, job, JOB_NOBODY);
}

/* --- links that are made, and lost, one by one --- */

/* Before one more: of the links that a worker has for base lines the oldest
 * goes if there are LINE_LINKS. */
static void
make_room(struct coord *c, struct job *job, uint32_t index)
{
    struct ring *r = job->ring;
    size_t oldest = 0, n = 0;

    for (size_t i = 0; i < r->npairs; i++) {
        const struct pair *p = &r->pair[i];

        if (p->kind != PAIR_LINES || (p->a != index && p->b != index))
            continue;
        if (n++ == 0 || p->sequence < r->pair[oldest].sequence)
            oldest = i;
    }
    if (n < LINE_LINKS)
        return;
    drop(c, job, &r->pair[oldest]);
    remove_pair(r, oldest);
}

void
ring_need(struct coord *c, struct job *job, uint32_t a, uint32_t b)
{
    struct ring *r = job->ring;
    struct pair *p;

    if (!r || a == b || !is_here(job, a) || !is_here(job, b))
        return;
    p = find_pair(r, a, b);
    if (p && p->kind == PAIR_STALE)
        p->kind = PAIR_LINES;
    if (p)
        return;
    make_room(c, job, a);
    make_room(c, job, b);
    introduce(c, job, a, b, PAIR_LINES, 0);
}

void
ring_unlinked(struct coord *c, struct job *job, uint32_t index,
              const struct msg_unlinked *m)
{
    struct ring *r = job->ring;
    uint32_t other = part_find(job, m->name), guest;
    struct pair *p;

    if (!r || other == JOB_NOBODY || other == index || index >= r->cap ||
        other >= r->cap || !is_here(job, index) || !is_here(job, other))
        return;
    p = find_pair(r, index, other);
    if (!p || p->kind == PAIR_LINES || p->kind == PAIR_STALE)
        return;
    guest = p->kind != PAIR_GUEST     ? JOB_NOBODY
            : r->host[index] == other ? index
                                      : other;
    remove_pair(r, (size_t)(p - r->pair));
    if (!note_broken(r, index, other, m->was)) {
        c->actions.failed = true;
        return;
    }
    if (guest == JOB_NOBODY) {
        r->changed = true;
        return;
    }
    be_guest(r, guest, JOB_NOBODY);
    take_in(c, job, guest, 0);
}
