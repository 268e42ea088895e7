/* ambcache_find.c - look-ups in the octree of ambient records; see ambcache.c
 *
 * A vector is loaded whole, although a writer may just be filling some of its
 * places; their results are masked out.  C11 does not define such a load:
 * load16() relies on the compiler to make it one instruction, whose bytes do
 * not depend on each other.  ThreadSanitizer is told to overlook this load
 * alone, and checks all other accesses. */
#include "config.h"

#include "light/record/ambcache_impl.h"
#include "base/vec.h"

#include <stdlib.h>
#ifdef __x86_64__
#define WITH_VECTORS 1
#include <emmintrin.h>
#endif

/* A query in a cell, as bytes that compare with those of a block. */
struct probe {
    uint8_t at[3], n[3], weight;
    uint8_t turn; /* how far a normal may be off along each axis */
};

/* By how many steps two normals with at least this cosine may differ along an
 * axis: by no more than the chord between them, and rounding. */
static uint8_t
turn_byte(double cosine)
{
    return (uint8_t)ceil(sqrt(2 - 2 * clamp(cosine, -1, 1)) * NORMAL_STEPS +
                         1.1);
}

void
rad_ambfit_set(struct rad_ambfit *fit, double min_cos, double weight)
{
    fit->sine = min_cos > 0 ? sqrt(rad_most(1 - min_cos * min_cos, 0)) : 2;
    fit->turn = turn_byte(min_cos);
    fit->weight = (uint8_t)weight_steps(weight);
}

/* The normals of a face, which are nearest to its axis, lie on the axis' side
 * of four planes, such as x = y.  If n is on the other side of such a plane,
 * the sine of its angle to these normals is at least its distance to the plane:
 * if that distance is above fit->sine, with a margin, since normals are not
 * quite of unit length, the face is ruled out.  These normals are also within
 * 55 degrees of their axis, so an axis more than 145 degrees from n is ruled
 * out. */
unsigned
rad_ambfit_faces(const struct rad_ambfit *fit, const double n[3])
{
    double sine = fit->sine, slack = M_SQRT2 * sine + 1e-3, at[3];
    double least, middle, most;
    unsigned faces = 0;

    for (int k = 0; k < 3; k++)
        at[k] = fabs(n[k]);
    least = rad_least(at[0], at[1]);
    most = rad_most(at[0], at[1]);
    middle = rad_most(least, rad_least(most, at[2]));
    most = rad_most(most, at[2]);
    if (most - middle > slack) { /* all planes are farther: one axis alone */
        int k = at[0] == most ? 0 : at[1] == most ? 1 : 2;

        return 1u << (2 * k + (n[k] < 0));
    }
    for (int k = 0; k < 3; k++) {
        double aside = at[k] == most ? middle : most;
        unsigned below = n[k] < 0;

        faces |= (unsigned)(aside - at[k] <= slack) << (2 * k + below);
        faces |= (unsigned)((aside + at[k] <= slack && at[k] < .82) || sine > 1)
                 << (2 * k + !below);
    }
    return faces;
}

/* The places of a block that are ready, as bits. */
static inline unsigned
ready_places(const struct block *b)
{
    /* acquire: pairs with the release in push */
    return atomic_load_explicit(&b->ready, memory_order_acquire);
}

#ifdef WITH_VECTORS

/* A vector, some of whose bytes may be being written: see above. */
__attribute__((no_sanitize("thread"))) static inline __m128i
load16(const void *p)
{
    return _mm_load_si128(p);
}

/* The larger of `far` and the distance of each byte to `from`. */
static inline __m128i
apart(__m128i far, const uint8_t *bytes, uint8_t from)
{
    __m128i a = load16(bytes), b = _mm_set1_epi8((char)from);

    return _mm_max_epu8(far,
                        _mm_or_si128(_mm_subs_epu8(a, b), _mm_subs_epu8(b, a)));
}

/* The ready places whose records may serve, as bits: the point is within their
 * reach along each axis, and their normal and weight fit. */
static inline unsigned
passing(const struct block *b, const struct probe *q, unsigned ready)
{
    const __m128i zero = _mm_setzero_si128();
    __m128i far = zero, turn = zero, over;

    far = apart(far, b->at[0], q->at[0]);
    far = apart(far, b->at[1], q->at[1]);
    far = apart(far, b->at[2], q->at[2]);
    turn = apart(turn, b->n[0], q->n[0]);
    turn = apart(turn, b->n[1], q->n[1]);
    turn = apart(turn, b->n[2], q->n[2]);
    over = _mm_or_si128(_mm_subs_epu8(far, load16(b->reach)),
                        _mm_subs_epu8(turn, _mm_set1_epi8((char)q->turn)));
    over = _mm_or_si128(
        over, _mm_subs_epu8(_mm_set1_epi8((char)q->weight), load16(b->weight)));
    return ready & (unsigned)_mm_movemask_epi8(_mm_cmpeq_epi8(over, zero));
}

#else

static bool
may_serve(const struct block *b, const struct probe *q, unsigned i)
{
    for (int k = 0; k < 3; k++)
        if (abs(b->at[k][i] - q->at[k]) > b->reach[i] ||
            abs(b->n[k][i] - q->n[k]) > q->turn)
            return false;
    return b->weight[i] >= q->weight;
}

/* The ready places whose records may serve, as bits. */
static unsigned
passing(const struct block *b, const struct probe *q, unsigned ready)
{
    unsigned pass = 0;

    for (; ready; ready &= ready - 1) {
        unsigned i = (unsigned)__builtin_ctz(ready);

        pass |= (unsigned)may_serve(b, q, i) << i;
    }
    return pass;
}

#endif

/* Prefetch three of a block's four lines, all but the last items. */
static inline void
prefetch(const struct block *b)
{
    __builtin_prefetch(b);
    __builtin_prefetch((const char *)b + LINE);
    __builtin_prefetch((const char *)b + 2 * LINE);
}

/* Records that were found and are not handed on yet. */
enum { MOST_FOUND = 4 * LANES };

struct finds {
    rad_ambcache_fn *fn;
    void *arg;
    int n;
    const struct rad_ambitem *item[MOST_FOUND];
};

static inline void
hand_on(struct finds *finds)
{
    if (finds->n > 0)
        (void)finds->fn(finds->arg, finds->item, finds->n);
    finds->n = 0;
}

/* Walk a list and find the records that may serve. */
static inline void
scan(const struct block *b, const struct probe *q, struct finds *finds)
{
    for (; b; b = b->next) {
        unsigned pass;

        if (b->next)
            prefetch(b->next);
        pass = passing(b, q, ready_places(b));
        if (finds->n > MOST_FOUND - LANES)
            hand_on(finds);
        for (; pass; pass &= pass - 1) {
            const struct rad_ambitem *item = b->item[__builtin_ctz(pass)];

            __builtin_prefetch(item);
            __builtin_prefetch((const char *)item + LINE);
            finds->item[finds->n++] = item;
        }
    }
}

/* The lists of the cells about a point, from the root to the smallest. */
struct path {
    int depth; /* of the smallest cell */
    const struct block *list[MAX_DEPTH + 1];
};

static inline void
descend(const struct cell *cell, const uint64_t number[3], struct path *path)
{
    uint64_t x = number[0] << (64 - BITS), y = number[1] << (64 - BITS),
             z = number[2] << (64 - BITS);

    for (int depth = 0;; depth++) {
        const struct block *list =
            atomic_load_explicit(&cell->list, memory_order_acquire);
        const struct cell *kids =
            atomic_load_explicit(&cell->kids, memory_order_acquire);

        path->list[depth] = list;
        path->depth = depth;
        if (list)
            prefetch(list);
        if (!kids || depth == MAX_DEPTH)
            return;
        cell = &kids[x >> 63 | y >> 63 << 1 | z >> 63 << 2];
        x <<= 1;
        y <<= 1;
        z <<= 1;
    }
}

/* Set the probe's point for a cell at that depth: as place_byte(), from the
 * bits of the point's number that follow the cell's. */
static inline void
aim(struct probe *probe, const uint64_t number[3], int depth)
{
    for (int k = 0; k < 3; k++)
        probe->at[k] = (uint8_t)(STEPS / 2 + (number[k] >> (MAX_DEPTH - depth) &
                                              (STEPS - 1)));
}

/* A look-up under way. */
struct visit {
    const struct rad_ambcache *c;
    uint64_t number[3];
    struct probe probe;
    bool any; /* a list has been looked at */
    rad_ambcache_more_fn *more;
    struct finds finds;
};

/* Prepare to look at lists of that depth; false: `more` wants none. */
static inline bool
go_on(struct visit *v, int depth)
{
    if (v->any &&
        !v->more(v->finds.arg, v->c->side / (SPAN * cells_across(depth + 1))))
        return false;
    v->any = true;
    aim(&v->probe, v->number, depth);
    return true;
}

static inline void
look_at(struct visit *v, const struct block *list)
{
    scan(list, &v->probe, &v->finds);
    hand_on(&v->finds);
}

/* Look at the lists of a path, from the smallest cell up. */
static inline void
ascend(struct visit *v, const struct path *path)
{
    for (int depth = path->depth; depth >= 0; depth--) {
        if (!path->list[depth])
            continue;
        if (!go_on(v, depth))
            return;
        look_at(v, path->list[depth]);
    }
}

/* Look at the lists of several paths, as ascend() does: all lists of one depth,
 * then those of the next. */
static void
ascend_all(struct visit *v, const struct path *path, int n)
{
    int depth = 0;

    for (int i = 0; i < n; i++)
        depth = path[i].depth > depth ? path[i].depth : depth;
    for (; depth >= 0; depth--) {
        bool here = false;

        for (int i = 0; i < n; i++) {
            if (depth > path[i].depth || !path[i].list[depth])
                continue;
            if (!here && !go_on(v, depth))
                return;
            here = true;
            look_at(v, path[i].list[depth]);
        }
    }
}

void
rad_ambcache_visit(const struct rad_ambcache *c, const struct rad_ambquery *q,
                   rad_ambcache_fn *fn, rad_ambcache_more_fn *more, void *arg)
{
    const struct cell *root = c->root[root_of(q->level)];
    unsigned faces = rad_ambfit_faces(q->fit, q->n);
    struct path path[FACES];
    struct visit v;
    int n = 0;

    v.c = c;
    v.any = false;
    v.more = more;
    v.finds.fn = fn;
    v.finds.arg = arg;
    v.finds.n = 0;
    for (int k = 0; k < 3; k++) {
        v.number[k] = cell_number((q->p[k] - c->org[k]) * c->scale);
        v.probe.n[k] = normal_byte(q->n[k]);
    }
    v.probe.turn = q->fit->turn;
    v.probe.weight = q->fit->weight;
    for (; faces; faces &= faces - 1)
        descend(&root[__builtin_ctz(faces)], v.number, &path[n++]);
    if (n == 1)
        ascend(&v, path);
    else
        ascend_all(&v, path, n);
}
