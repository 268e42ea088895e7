/* check_ambcache.c - tests of src/light/record/ambcache.c
 *
 * RADD_EACH=n inserts so many records from each of eight threads, in place of
 * 1500. */
#include "config.h"

#include "base/rng.h"
#include "base/vec.h"
#include "light/record/ambcache.h"
#include "light/record/ambread.h"
#include "tests/world.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <string.h>

/* A cube that is not at the origin and not of side 1. */
static const double org[3] = { -3, 5, 100 };
#define SIDE 7.

struct sample {
    struct rad_ambrec rec;
    struct rad_ambzone zone;
};

static double
draw(uint64_t key, uint32_t i)
{
    return rad_rand(key, i);
}

static void
widen(double d[3], const float v[3])
{
    for (int k = 0; k < 3; k++)
        d[k] = v[k];
}

/* Mostly on walls of the cube's grid and upright on them; of any size. */
static struct sample
invent(uint64_t key)
{
    struct sample s = { .rec = { .weight = (float)(.25 + .75 * draw(key, 1)),
                                 .level = (uint16_t)(3 * draw(key, 2)) } };
    double n[3], u[3], v[3], turn = 2 * M_PI * draw(key, 15);

    for (uint32_t k = 0; k < 3; k++) {
        s.rec.p[k] = org[k] + SIDE * draw(key, 3 + k);
        n[k] = draw(key, 6 + k) - .5;
    }
    rad_normalize(n);
    for (int k = 0; k < 3; k++)
        s.rec.n[k] = (float)n[k];
    if (draw(key, 9) < .7) {
        int axis = (int)(3 * draw(key, 10));

        memset(s.rec.n, 0, sizeof s.rec.n);
        s.rec.n[axis] = draw(key, 11) < .5 ? -1 : 1;
        s.rec.p[axis] = org[axis] + SIDE / 4 * (int)(5 * draw(key, 12));
    }
    widen(n, s.rec.n);
    rad_frame(u, v, n);
    for (int k = 0; k < 3; k++)
        s.rec.u[k] = (float)(cos(turn) * u[k] + sin(turn) * v[k]);
    s.zone.reach = SIDE * exp(-1.1 - 13 * draw(key, 13));
    s.zone.height = s.zone.reach * (.3 + .7 * draw(key, 14));
    s.zone.behind = .01 * s.zone.height;
    return s;
}

struct question {
    struct rad_ambquery q;
    double min_cos, weight;
};

static void
ask(const struct rad_ambcache *c, const struct question *question,
    rad_ambcache_fn *fn, rad_ambcache_more_fn *more, void *arg)
{
    struct rad_ambquery q = question->q;
    struct rad_ambfit fit;

    rad_ambfit_set(&fit, question->min_cos, question->weight);
    q.fit = &fit;
    rad_ambcache_visit(c, &q, fn, more, arg);
}

/* Asked near the edge of some record's zone, on its side or nearly. */
static struct question
ask_near(const struct sample *s, uint64_t key)
{
    struct question ask = { .weight = draw(key, 2), .min_cos = draw(key, 3) };
    struct rad_ambquery q = { .level = (int)(3 * draw(key, 1)) };
    double out = s->zone.reach * (.2 + draw(key, 4)), n[3], u[3], v[3];

    widen(n, s->rec.n);
    rad_normalize(n);
    rad_frame(u, v, n);
    double phi = 2 * M_PI * draw(key, 5);
    double up = s->zone.height * (draw(key, 6) - .2);

    for (int k = 0; k < 3; k++) {
        q.p[k] = s->rec.p[k] + out * (cos(phi) * u[k] + sin(phi) * v[k]) +
                 (draw(key, 7) < .5 ? up * n[k] : 0);
        q.n[k] = n[k] + draw(key, 8) * (draw(key, 9 + (uint32_t)k) - .5);
    }
    rad_normalize(q.n);
    ask.q = q;
    return ask;
}

/* Does the query meet the record, whose zone is as wide along u as across? */
static bool
meets(const struct sample *s, const struct question *ask)
{
    const struct rad_ambquery *q = &ask->q;
    double d[3], n[3], h, reach = s->zone.reach, height = s->zone.height;

    rad_sub(d, q->p, s->rec.p);
    widen(n, s->rec.n);
    h = rad_dot(d, n);
    return (rad_dot(d, d) - h * h) / (reach * reach) +
                   h * h / (height * height) <
               1 &&
           h >= -s->zone.behind && rad_dot(n, q->n) >= ask->min_cos &&
           s->rec.level == q->level && (double)s->rec.weight >= ask->weight;
}

/* The same of a zone that is no wider along u than high. */
static bool
meets_ellipsoid(const struct sample *s, const struct question *ask)
{
    double d[3], u[3], reach = s->zone.reach, height = s->zone.height, along;

    rad_sub(d, ask->q.p, s->rec.p);
    widen(u, s->rec.u);
    along = rad_dot(d, u);
    rad_madd(d, d, along * reach / height - along, u);
    struct question moved = *ask;

    for (int k = 0; k < 3; k++)
        moved.q.p[k] = s->rec.p[k] + d[k];
    return meets(s, &moved);
}

/* May it come in vain?  In the cube about its zone, by what bytes are rounded
 * by: three steps of at most a 21st of its reach; and in the cube that holds
 * the normals, by little more than three steps of those. */
static bool
nearly_meets(const struct sample *s, const struct question *ask)
{
    const struct rad_ambquery *q = &ask->q;
    double reach = s->zone.reach * (1 + 3. / 21);
    double chord = sqrt(2 - 2 * ask->min_cos) + 3.2 / 127;

    for (int k = 0; k < 3; k++) {
        double p = rad_least(rad_most(q->p[k], org[k]), org[k] + SIDE);

        if (fabs(p - s->rec.p[k]) > reach ||
            fabs(q->n[k] - (double)s->rec.n[k]) > chord)
            return false;
    }
    return s->rec.level == q->level &&
           (double)s->rec.weight >= ask->weight - .011;
}

struct found {
    const struct rad_ambitem *rec[4096];
    int n;
    double reach, enough; /* last told to want, and where to stop */
};

static bool
keep(void *arg, const struct rad_ambitem *const *found, int n)
{
    struct found *f = arg;

    if (n > N_ELEM(f->rec) - f->n)
        ck_abort_msg("too many");
    for (int i = 0; i < n; i++)
        f->rec[f->n++] = found[i];
    return true;
}

static bool
want(void *arg, double reach)
{
    struct found *f = arg;

    if (!(reach > f->reach))
        ck_abort_msg("%g after %g", reach, f->reach);
    f->reach = reach;
    return reach < f->enough;
}

enum { RECORDS = 2000, QUERIES = 1000 };
static struct sample sample[RECORDS];

/* One after the other, and then some at a time. */
static struct rad_ambcache *
filled(void)
{
    struct rad_ambcache *c = rad_ambcache_new(org, SIDE, false);
    static struct rad_ambrec rec[RECORDS];
    static struct rad_ambzone zone[RECORDS];
    bool ok = c != NULL;

    for (int i = 0; ok && i < RECORDS; i++) {
        sample[i] = invent(rad_key_branch(1, (uint64_t)i));
        sample[i].rec.E.g = (float)i;
        rec[i] = sample[i].rec;
        zone[i] = sample[i].zone;
        if (i < RECORDS / 4)
            ok &= rad_ambcache_insert(c, &rec[i], &zone[i], i % 2 == 0);
    }
    for (int i = RECORDS / 4, n = 0; ok && i < RECORDS; i += n, n++) {
        n = n < RECORDS - i ? n : RECORDS - i;
        ok &= rad_ambcache_insert_all(c, rec + i, zone + i, (size_t)n, true);
    }
    ck_assert(ok);
    ck_assert_uint_eq(rad_ambcache_count(c), RECORDS);
    return c;
}

static struct rad_ambzone
zone_of(const void *arg, const struct rad_ambitem *rec)
{
    (void)arg;
    return sample[(int)rec->E.g].zone;
}

/* Settle while no visit is under way. */
static bool
settle(struct rad_ambread *r)
{
    size_t n = rad_ambread_settle_begin(r, true, zone_of, NULL);

    for (size_t i = 0; i < n; i++)
        rad_ambread_settle_piece(r, i);
    return rad_ambread_settle_end(r);
}

/* The same beside visits, the last piece first. */
static bool
settle_backwards(struct rad_ambread *r)
{
    size_t n = rad_ambread_settle_begin(r, false, zone_of, NULL);

    ck_assert(r->n < 100 || n > 1);
    while (n-- > 0)
        rad_ambread_settle_piece(r, n);
    return rad_ambread_settle_end(r);
}

/* The same records, laid out for reading in a cube: settled at several times,
 * some of them far outside it if they may be strays. */
static void
settle_in(struct rad_ambread *r, const double corner[3], double side,
          bool strays)
{
    bool ok = true;

    rad_ambread_init(r, corner, side);
    for (int i = 0; i < RECORDS; i++) {
        sample[i] = invent(rad_key_branch(1, (uint64_t)i));
        sample[i].rec.E.g = (float)i;
        if (strays && i % 50 == 0)
            sample[i].rec.p[i % 3] += (i % 4 - 1.5) * SIDE;
        ok &= rad_ambread_add(r, &sample[i].rec);
        if (i % 700 == 3)
            ok &= settle_backwards(r);
    }
    ok &= settle(r);
    ck_assert(ok);
}

static void
settled(struct rad_ambread *r)
{
    settle_in(r, org, SIDE, true);
}

/* Ask near the edges of zones, in corners of the cube's grid, outside it. */
static struct question
ask_anywhere(int i)
{
    uint64_t key = rad_key_branch(8, (uint64_t)i);
    const struct sample *s = &sample[(int)(RECORDS * draw(key, 0))];
    struct question q = ask_near(s, key);

    if (i % 4 == 0)
        rad_copy(q.q.p, s->rec.p);
    if (i % 8 == 1)
        for (uint32_t k = 0; k < 3; k++)
            q.q.p[k] = org[k] + SIDE / 4 * (int)(6 * draw(key, 20 + k));
    return q;
}

/* Records that look-ups found, those that serve and the others; and how many
 * look-ups found fewer where large zones were not wanted. */
struct matches {
    int served, vain, shorter;
};

/* Look up for a question, which finds what a search of all finds. */
static void
look_up(const struct rad_ambread *r, int i, struct matches *t)
{
    static int times[RECORDS];
    struct question ask = ask_anywhere(i);
    struct found f = { .enough = INFINITY }, some = { .enough = .02 };
    struct rad_ambquery q = ask.q;
    struct rad_ambfit fit;
    double reach = 0;

    rad_ambfit_set(&fit, ask.min_cos, ask.weight);
    q.fit = &fit;
    rad_ambread_visit(r, RECORDS, &q, keep, want, &f);
    rad_ambread_visit(r, RECORDS, &q, keep, want, &some);
    ck_assert(some.n <= f.n &&
              memcmp(f.rec, some.rec, (size_t)some.n * sizeof *some.rec) == 0);
    t->shorter += some.n < f.n;
    memset(times, 0, sizeof times);
    for (int k = 0; k < f.n; k++) {
        double its = sample[(int)f.rec[k]->E.g].zone.reach;

        times[(int)f.rec[k]->E.g]++;
        if (2.001 * its < reach)
            ck_abort_msg("%d: %g after %g", i, its, reach);
        reach = rad_most(reach, its);
    }
    for (int k = 0; k < RECORDS; k++) {
        bool in = meets_ellipsoid(&sample[k], &ask);

        if (times[k] > 1)
            ck_abort_msg("query %d: record %d %d times", i, k, times[k]);
        if (in && times[k] == 0)
            ck_abort_msg("query %d: no record %d", i, k);
        t->served += in;
        t->vain += times[k] > in;
    }
}

TEST(frozen_look_up_finds_what_a_search_of_all_finds)
{
    struct rad_ambread r;
    struct matches t = { 0 };

    settled(&r);
    for (int i = 0; i < 4 * QUERIES; i++)
        look_up(&r, i, &t);
    ck_assert_int_gt(t.shorter, 0);
    ck_assert_int_gt(t.served, QUERIES / 2);
    ck_assert_int_lt(t.vain, 20 * t.served);
    rad_ambread_release(&r);
}

/* All records are in one part of the scene's cube, and of that part, and so on:
 * leaves are as small as in a cube of the room's size. */
TEST(a_room_that_is_small_in_its_scene_is_searched_as_well)
{
    static const double cells[3] = { 170, 75, 225 }; /* each four rooms wide */
    struct rad_ambread r;
    struct matches t = { 0 };
    double corner[3];

    for (int k = 0; k < 3; k++)
        corner[k] = org[k] - (4 * cells[k] + 1.5) * SIDE;
    settle_in(&r, corner, 1024 * SIDE, false);
    for (int i = 0; i < QUERIES; i++)
        look_up(&r, i, &t);
    ck_assert_int_gt(t.served, QUERIES / 8);
    ck_assert_int_lt(t.vain, 20 * t.served);
    rad_ambread_release(&r);
}

TEST(frozen_records_come_in_an_order_that_ignores_how_they_were_settled)
{
    struct rad_ambread often, once;

    settled(&often);
    rad_ambread_init(&once, org, SIDE);
    for (int i = 0; i < RECORDS; i++)
        ck_assert(rad_ambread_add(&once, &sample[i].rec));
    ck_assert(settle(&once));
    for (int i = 0; i < QUERIES; i++) {
        struct question ask = ask_anywhere(i);
        struct found a = { .enough = .02 }, b = { .enough = .02 };
        struct rad_ambquery q = ask.q;
        struct rad_ambfit fit;

        rad_ambfit_set(&fit, ask.min_cos, ask.weight);
        q.fit = &fit;
        rad_ambread_visit(&often, RECORDS, &q, keep, want, &a);
        rad_ambread_visit(&once, RECORDS, &q, keep, want, &b);
        ck_assert_int_eq(a.n, b.n);
        for (int k = 0; k < a.n; k++)
            if (a.rec[k]->E.g != b.rec[k]->E.g)
                ck_abort_msg("query %d: place %d", i, k);
    }
    rad_ambread_release(&often);
    rad_ambread_release(&once);
}

/* Of the first half alone the same serve, in the same order, as if the others
 * were not there. */
TEST(of_frozen_records_the_later_ones_can_be_left_out)
{
    struct rad_ambread all, half;
    int served = 0;

    settled(&all);
    rad_ambread_init(&half, org, SIDE);
    for (int i = 0; i < RECORDS / 2; i++)
        ck_assert(rad_ambread_add(&half, &sample[i].rec));
    ck_assert(settle(&half));
    for (int i = 0; i < QUERIES; i++) {
        struct question ask = ask_anywhere(i);
        struct found a = { .enough = INFINITY }, b = { .enough = INFINITY };
        struct rad_ambquery q = ask.q;
        struct rad_ambfit fit;
        int k = 0;

        rad_ambfit_set(&fit, ask.min_cos, ask.weight);
        q.fit = &fit;
        rad_ambread_visit(&all, RECORDS / 2, &q, keep, want, &a);
        rad_ambread_visit(&half, RECORDS, &q, keep, want, &b);
        for (int j = 0; j < a.n; j++) {
            const struct sample *s = &sample[(int)a.rec[j]->E.g];

            ck_assert_int_lt((int)a.rec[j]->E.g, RECORDS / 2);
            if (!meets_ellipsoid(s, &ask))
                continue;
            while (k < b.n &&
                   !meets_ellipsoid(&sample[(int)b.rec[k]->E.g], &ask))
                k++;
            ck_assert_int_lt(k, b.n);
            ck_assert(a.rec[j]->E.g == b.rec[k++]->E.g);
            served++;
        }
        for (; k < b.n; k++)
            ck_assert(!meets_ellipsoid(&sample[(int)b.rec[k]->E.g], &ask));
    }
    ck_assert_int_gt(served, QUERIES / 20);
    rad_ambread_release(&all);
    rad_ambread_release(&half);
}

TEST(look_up_finds_what_a_search_of_all_finds)
{
    struct rad_ambcache *c = filled();
    static int times[RECORDS];
    int served = 0;

    for (int i = 0; i < QUERIES; i++) {
        uint64_t key = rad_key_branch(2, (uint64_t)i);
        struct question q =
            ask_near(&sample[(int)(RECORDS * draw(key, 0))], key);
        struct found f = { .enough = INFINITY };

        ask(c, &q, keep, want, &f);
        memset(times, 0, sizeof times);
        for (int k = 0; k < f.n; k++)
            times[(int)f.rec[k]->E.g]++;
        for (int k = 0; k < RECORDS; k++) {
            bool in = meets(&sample[k], &q);
            bool near = nearly_meets(&sample[k], &q);
            int n = times[k];

            if (n > 1)
                ck_abort_msg("query %d: record %d %d times", i, k, n);
            if (n == 0 && in)
                ck_abort_msg("query %d: no record %d", i, k);
            /* what comes in vain is near the edge of what is asked for */
            if (n > 0 && !near)
                ck_abort_msg("query %d: record %d", i, k);
            served += in;
        }
    }
    ck_assert_int_gt(served, QUERIES / 4); /* of three levels one serves */
    rad_ambcache_free(c);
}

TEST(small_zones_come_first_and_large_ones_if_wanted)
{
    struct rad_ambcache *c = filled();
    int shorter = 0;

    for (int i = 0; i < QUERIES; i++) {
        uint64_t key = rad_key_branch(3, (uint64_t)i);
        struct question q =
            ask_near(&sample[(int)(RECORDS * draw(key, 0))], key);
        struct found all = { .enough = INFINITY }, some = { .enough = .02 };
        double reach = 0;

        ask(c, &q, keep, want, &all);
        for (int k = 0; k < all.n; k++) {
            double r = sample[(int)all.rec[k]->E.g].zone.reach;

            /* within a factor of two */
            if (2 * r < reach)
                ck_abort_msg("%d: %g after %g", i, r / SIDE, reach / SIDE);
            reach = rad_most(reach, r);
        }
        ask(c, &q, keep, want, &some);
        ck_assert_int_le(some.n, all.n);
        ck_assert(
            memcmp(all.rec, some.rec, (size_t)some.n * sizeof *some.rec) == 0);
        shorter += some.n < all.n;
    }
    ck_assert_int_gt(shorter, 0);
    rad_ambcache_free(c);
}

/* --- memory --- */

/* The linker sends every allocation here. */
void *__real_malloc(size_t n);
void *__real_calloc(size_t n, size_t size);
void *__real_realloc(void *p, size_t n);
void *__real_aligned_alloc(size_t align, size_t n);
void *__wrap_malloc(size_t n);
void *__wrap_calloc(size_t n, size_t size);
void *__wrap_realloc(void *p, size_t n);
void *__wrap_aligned_alloc(size_t align, size_t n);

static _Atomic unsigned long allocations;
static unsigned long fails_at; /* the allocation that fails; 0: none does */

void *
__wrap_malloc(size_t n)
{
    return ++allocations == fails_at ? NULL : __real_malloc(n);
}

void *
__wrap_calloc(size_t n, size_t size)
{
    return ++allocations == fails_at ? NULL : __real_calloc(n, size);
}

void *
__wrap_realloc(void *p, size_t n)
{
    return ++allocations == fails_at ? NULL : __real_realloc(p, n);
}

void *
__wrap_aligned_alloc(size_t align, size_t n)
{
    return ++allocations == fails_at ? NULL : __real_aligned_alloc(align, n);
}

/* ck_assert() allocates. */
static bool
tally(void *arg, const struct rad_ambitem *const *found, int n)
{
    struct found *f = arg;

    for (int i = 0; i < n; i++)
        f->n += found[i]->level < 3;
    return true;
}

static bool
want_any(void *arg, double reach)
{
    (void)arg;
    return reach < INFINITY;
}

TEST(insertions_allocate_in_bulk_and_look_ups_never)
{
    unsigned long before = allocations, between, after;
    struct rad_ambcache *c = filled();
    struct found f = { .n = 0 };

    between = allocations;
    for (int i = 0; i < QUERIES; i++) {
        uint64_t key = rad_key_branch(4, (uint64_t)i);
        struct question q = ask_near(&sample[i], key);

        ask(c, &q, tally, want_any, &f);
    }
    after = allocations;
    ck_assert_int_gt(f.n, 0);
    ck_assert_uint_eq(after, between);
    /* 256 at a time of records, of blocks of fourteen places, and of cells */
    ck_assert_uint_gt(between, before);
    ck_assert_uint_lt(between - before, RECORDS / 8);
    rad_ambcache_free(c);
}

#define FEW 300

static void
few_added(struct rad_ambread *r)
{
    rad_ambread_init(r, org, SIDE);
    for (int i = 0; i < FEW; i++) {
        sample[i] = invent(rad_key_branch(1, (uint64_t)i));
        sample[i].rec.E.g = (float)i;
        ck_assert(rad_ambread_add(r, &sample[i].rec));
    }
}

/* Of memory that is out settling tells; what it says is settled serves. */
TEST(settling_without_memory_fails)
{
    int failed = 0;

    fails_at = allocations;
    for (unsigned long i = 1; allocations >= fails_at; i++) {
        struct found f = { .n = 0 };
        struct rad_ambread r;
        bool ok;

        few_added(&r);
        fails_at = allocations + i;
        ok = settle(&r);
        failed += !ok;
        for (int k = 0; ok && k < FEW; k++) {
            struct question q = ask_near(&sample[k], (uint64_t)k);
            struct rad_ambfit fit;

            rad_ambfit_set(&fit, q.min_cos, q.weight);
            q.q.fit = &fit;
            rad_ambread_visit(&r, r.n, &q.q, tally, want_any, &f);
        }
        rad_ambread_release(&r);
        if (ok && f.n == 0)
            ck_abort_msg("allocation %lu: none serves", i);
    }
    fails_at = 0;
    ck_assert_int_gt(failed, 10);
}

/* Of a floor, whose leaves small zones were shared out among, each large zone
 * touches many. */
TEST(large_zones_that_come_last_are_not_in_all_small_leaves)
{
    struct rad_ambread r;
    bool ok = true;

    rad_ambread_init(&r, org, SIDE);
    for (int i = 0; i < RECORDS; i++) {
        double reach = SIDE * (i < RECORDS / 4 * 3 ? 1e-4 : .5);
        struct sample *s = &sample[i];

        *s = invent(rad_key_branch(1, (uint64_t)i));
        s->rec = (struct rad_ambrec){
            .p = { s->rec.p[0], s->rec.p[1], org[2] + SIDE / 2 },
            .n = { 0, 0, 1 },
            .u = { 1, 0, 0 },
            .E.g = (float)i,
        };
        s->zone = (struct rad_ambzone){ reach, reach / 2, 0 };
        ok &= rad_ambread_add(&r, &s->rec);
        if (i % 100 == 99)
            ok &= settle(&r);
    }
    ok &= settle(&r);
    ck_assert(ok);
    ck_assert_uint_lt(rad_ambread_bytes(&r), 300 * r.n);
    rad_ambread_release(&r);
}

static void
trace_room(struct world *w)
{
    static const double up[3] = { 0, 0, 1 };

    for (int i = 0; i < 400; i++) {
        double p[3] = { .04 * (i % 20) - .4, .04 * (i / 20) - .4, -.8 };
        struct rad_ray r;

        rad_ray_irradiance(&w->ctx, &r, p, up, (uint64_t)i);
    }
}

TEST(rays_allocate_nothing)
{
    unsigned long before, between, after;
    struct world w = { 0 };

    world_open(&w,
               "void plastic grey 0 0 5 .5 .4 .3 0 0\n"
               "void light lamp 0 0 3 9 9 9\n"
               "lamp sphere a 0 0 4 0 0 .5 .1\n"
               "grey bubble b 0 0 4 0 0 0 1\n",
               "-ab 2 -aa .1 -ar 32 -ad 64 -as 32");
    trace_room(&w); /* makes the records, and room for a hemisphere */
    uint64_t values = w.ctx.counts.ambient_values, rays = w.ctx.counts.rays;

    before = allocations;
    trace_room(&w);
    between = allocations;
    ck_assert_uint_eq(w.ctx.counts.ambient_values, values);
    ck_assert_uint_eq(between, before);
    /* where records are made: in bulk again */
    double p[3] = { 0, .1, .6 }, down[3] = { 0, 0, -1 };

    between = allocations;
    for (int i = 0; i < 50; i++) {
        struct rad_ray r;

        p[0] = .01 * i;
        rad_ray_irradiance(&w.ctx, &r, p, down, (uint64_t)i);
    }
    after = allocations;
    ck_assert_uint_gt(w.ctx.counts.ambient_values, values);
    ck_assert_uint_gt(w.ctx.counts.rays - rays, 1000);
    ck_assert_uint_lt(after - between, 10);
    world_close(&w);
}

/* --- threads --- */

enum { THREADS = 8 };

struct crowd {
    struct rad_ambcache *cache;
    int each; /* records of a thread */
    _Atomic int missed;
};

struct member {
    pthread_t thread;
    struct crowd *crowd;
    int number;
};

static bool
look_for(void *arg, const struct rad_ambitem *const *found, int n)
{
    struct found *f = arg;

    for (int i = 0; i < n; i++) {
        const struct rad_ambitem *rec = found[i];

        /* E says which it is, p and n whether it is whole */
        f->n += (double)rec->E.r == f->enough;
        if (rec->p[0] < org[0] || rec->p[0] > org[0] + SIDE ||
            rec->n[0] * rec->n[0] + rec->n[1] * rec->n[1] +
                    rec->n[2] * rec->n[2] <
                .99f)
            ck_abort_msg("a record that is not whole");
    }
    return true;
}

static bool
want_all(void *arg, double reach)
{
    (void)arg;
    return reach < INFINITY;
}

static bool
is_there(struct crowd *crowd, int thread, int i)
{
    struct sample s =
        invent(rad_key_branch(7, (uint64_t)i * THREADS + (uint64_t)thread));
    struct question q = { .q.level = s.rec.level, .min_cos = .5 };
    /* `enough` is here what is looked for */
    struct found f = { .enough = (double)(float)(i * THREADS + thread) };

    rad_copy(q.q.p, s.rec.p);
    widen(q.q.n, s.rec.n);
    ask(crowd->cache, &q, look_for, want_all, &f);
    return f.n == 1;
}

static void *
insert_and_look(void *arg)
{
    struct member *me = arg;
    struct crowd *crowd = me->crowd;

    for (int i = 0; i < crowd->each; i++) {
        struct sample s = invent(
            rad_key_branch(7, (uint64_t)i * THREADS + (uint64_t)me->number));

        s.zone.reach *= .1; /* not too many at one place */
        s.zone.height *= .1;
        s.rec.E.r = (float)(i * THREADS + me->number);
        if (!rad_ambcache_insert(crowd->cache, &s.rec, &s.zone, true) ||
            !is_there(crowd, me->number, i))
            atomic_fetch_add(&crowd->missed, 1);
        /* what another may have put there by now */
        is_there(crowd, (me->number + 1) % THREADS, i);
    }
    return NULL;
}

TEST(threads_find_what_they_insert)
{
    const char *each = getenv("RADD_EACH");
    struct crowd crowd = { .each = each ? atoi(each) : 1500 };
    static struct rad_ambrec out[64];
    struct member member[THREADS];
    uint64_t cursor = 0;
    size_t logged = 0, n;

    crowd.cache = rad_ambcache_new(org, SIDE, true);
    for (int i = 0; i < THREADS; i++) {
        member[i] = (struct member){ .crowd = &crowd, .number = i };
        ck_assert_int_eq(pthread_create(&member[i].thread, NULL,
                                        insert_and_look, &member[i]),
                         0);
    }
    for (int i = 0; i < THREADS; i++)
        pthread_join(member[i].thread, NULL);
    ck_assert_int_eq(crowd.missed, 0);
    for (int i = 0; i < THREADS; i++)
        for (int k = 0; k < crowd.each; k++)
            if (!is_there(&crowd, i, k))
                ck_abort_msg("record %d of %d", k, i);
    while ((n = rad_ambcache_read(crowd.cache, &cursor, true, out,
                                  N_ELEM(out))) > 0)
        logged += n;
    ck_assert_uint_eq(logged, (size_t)crowd.each * THREADS);
    ck_assert_uint_eq(rad_ambcache_count(crowd.cache), logged);
    rad_ambcache_free(crowd.cache);
}

/* --- visits beside settling --- */

enum { VISITORS = 3, SEEN = 300, STEP = 50, ASKED = 100 };

/* Visitors look up the first SEEN records, ASKED times for a turn, as a tile
 * does, while the others are added and settled. */
struct visits {
    struct rad_ambread r;
    /* what is found before the others come: how many, and their numbers */
    int n[ASKED];
    uint32_t number[ASKED][SEEN];
    _Atomic bool over;
    _Atomic uint32_t turns[VISITORS];
    _Atomic int wrong;
};

struct visitor {
    pthread_t thread;
    struct visits *all;
    int number;
};

static void
look_up_seen(const struct visits *v, int i, struct found *f)
{
    struct question ask = ask_near(&sample[i], rad_key_branch(9, (uint64_t)i));
    struct rad_ambquery q = ask.q;
    struct rad_ambfit fit;

    rad_ambfit_set(&fit, ask.min_cos, ask.weight);
    q.fit = &fit;
    f->n = 0;
    rad_ambread_visit(&v->r, SEEN, &q, keep, want_all, f);
}

static void
take_turn(struct visits *v)
{
    for (int i = 0; i < ASKED; i++) {
        struct found f;
        bool same;

        look_up_seen(v, i, &f);
        same = f.n == v->n[i];
        for (int k = 0; same && k < f.n; k++)
            same = (uint32_t)f.rec[k]->E.g == v->number[i][k];
        v->wrong += !same;
    }
}

static void *
visit(void *arg)
{
    struct visitor *me = arg;
    struct visits *v = me->all;

    while (!v->over) {
        take_turn(v);
        v->turns[me->number]++;
    }
    return NULL;
}

/* Wait until each visitor has ended the turn at which it was `then`. */
static void
wait_for_turns(const struct visits *v, const uint32_t then[VISITORS])
{
    for (int i = 0; i < VISITORS; i++)
        while (v->turns[i] == then[i])
            sched_yield();
}

/* Add and settle the other records; turns that were under way when a settling
 * ended are over when the RAD_AMBREAD_LATE-th after it begins. */
static bool
settle_others(struct visits *v)
{
    uint32_t then[RAD_AMBREAD_LATE][VISITORS];
    bool ok = true;
    int n = 0;

    for (int i = SEEN; i < RECORDS; n++) {
        uint32_t *turns = then[n % RAD_AMBREAD_LATE];

        if (n >= RAD_AMBREAD_LATE)
            wait_for_turns(v, turns);
        for (int end = i + STEP; i < end; i++)
            ok &= rad_ambread_add(&v->r, &sample[i].rec);
        ok &= settle_backwards(&v->r);
        for (int k = 0; k < VISITORS; k++)
            turns[k] = v->turns[k];
    }
    return ok;
}

TEST(visits_go_on_beside_settling)
{
    static struct visits v;
    struct visitor visitor[VISITORS];
    int found = 0;
    bool ok = true;

    rad_ambread_init(&v.r, org, SIDE);
    for (int i = 0; i < RECORDS; i++) {
        sample[i] = invent(rad_key_branch(1, (uint64_t)i));
        sample[i].rec.E.g = (float)i;
        ok &= i >= SEEN || rad_ambread_add(&v.r, &sample[i].rec);
    }
    ok &= settle_backwards(&v.r);
    for (int i = 0; i < ASKED; i++) {
        struct found f;

        look_up_seen(&v, i, &f);
        v.n[i] = f.n;
        for (int k = 0; k < f.n; k++)
            v.number[i][k] = (uint32_t)f.rec[k]->E.g;
        found += f.n;
    }
    ck_assert_int_gt(found, ASKED / 4);
    for (int i = 0; i < VISITORS; i++) {
        visitor[i] = (struct visitor){ .all = &v, .number = i };
        ck_assert_int_eq(
            pthread_create(&visitor[i].thread, NULL, visit, &visitor[i]), 0);
    }
    ok &= settle_others(&v);
    v.over = true;
    for (int i = 0; i < VISITORS; i++)
        pthread_join(visitor[i].thread, NULL);
    ck_assert(ok);
    ck_assert_int_eq(v.wrong, 0);
    rad_ambread_release(&v.r);
}
