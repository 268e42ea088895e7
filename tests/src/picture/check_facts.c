/* check_facts.c - traced pixels are kept once, given once, and counted */
#include "config.h"

#include "base/error.h"
#include "picture/facts.h"
#include "tests/unit.h"

#include <math.h>
#include <pthread.h>
#include <string.h>

enum { WIDTH = 43, ROWS = 3, MOST = WIDTH * ROWS };

/* What pixel i is, whoever traces it. */
static struct rad_pixel
pixel(int i)
{
    float v = (float)i;
    struct rad_pixel p = { { v, 2 * v, v + .5f }, 3 * v };

    return p;
}

static bool
put(struct rad_facts *f, int i, unsigned origin)
{
    struct rad_pixel p = pixel(i);

    return rad_facts_put(f, i % WIDTH, i / WIDTH, &p, origin);
}

static void
assert_known(const struct rad_facts *f, int i)
{
    struct rad_pixel p, want = pixel(i);

    ck_assert(rad_facts_get(f, i % WIDTH, i / WIDTH, &p));
    ck_assert_mem_eq(&p, &want, sizeof p);
}

TEST(the_first_fact_of_a_pixel_is_kept)
{
    struct rad_facts *f = rad_facts_new(WIDTH, ROWS);
    struct rad_pixel p = { { 7, 7, 7 }, 7 };

    ck_assert_int_eq(rad_facts_rows(f), ROWS);
    ck_assert(!rad_facts_get(f, 5, 1, &p));
    ck_assert(!rad_facts_use(f, 5, 1, &p));
    ck_assert(p.L.g == 7);
    ck_assert(put(f, WIDTH + 5, 0));
    ck_assert(!rad_facts_put(f, 5, 1, &p, 0));
    assert_known(f, WIDTH + 5);
    ck_assert(!rad_facts_get(f, 5, 0, &p));
    ck_assert(!rad_facts_get(f, 6, 1, &p));
    rad_facts_free(f);
}

TEST(what_nobody_used_is_counted)
{
    struct rad_facts *f = rad_facts_new(WIDTH, ROWS);
    struct rad_pixel p;

    put(f, 0, 0);
    put(f, 1, RAD_FACT_FOREIGN);
    put(f, 2, RAD_FACT_ESTIMATE);
    put(f, 3, RAD_FACT_ESTIMATE | RAD_FACT_FOREIGN);
    put(f, 4, RAD_FACT_USED);
    ck_assert_uint_eq(rad_facts_unused(f), 2);
    ck_assert(rad_facts_use(f, 1, 0, &p));
    ck_assert(rad_facts_use(f, 2, 0, &p));
    ck_assert(rad_facts_use(f, 1, 0, &p));
    ck_assert_uint_eq(rad_facts_unused(f), 1);
    rad_facts_free(f);
}

/* Others were first while it was traced here. */
TEST(what_was_known_when_it_was_traced_is_counted)
{
    struct rad_facts *f = rad_facts_new(WIDTH, ROWS);

    put(f, 0, RAD_FACT_FOREIGN);
    put(f, 1, 0);
    ck_assert_uint_eq(rad_facts_late(f), 0);
    ck_assert(!put(f, 0, RAD_FACT_USED));
    ck_assert(!put(f, 1, 0));
    ck_assert(!put(f, 1, RAD_FACT_FOREIGN)); /* came twice */
    ck_assert(!put(f, 1, RAD_FACT_ESTIMATE));
    ck_assert_uint_eq(rad_facts_late(f), 2);
    ck_assert_uint_eq(rad_facts_doubled(f), 2);
    rad_facts_settle(f);
    ck_assert_uint_eq(rad_facts_doubled(f), 0);
    rad_facts_free(f);
}

struct parcel {
    uint8_t bitmap[MOST];
    float pixels[4 * MOST];
    size_t n;
};

#define ROWS_OF(row, n, channels, origin)                                      \
    (&(struct rad_fact_rows){ (row), (n), (channels), (origin) })

static void export(struct rad_facts *f, int row, int n, unsigned origin,
                   struct parcel *p)
{
    p->n =
        rad_facts_export(f, ROWS_OF(row, n, 4, origin), p->bitmap, p->pixels);
}

static int
import(struct rad_facts *f, int row, int n, unsigned origin,
       const struct parcel *p)
{
    return rad_facts_import(f, ROWS_OF(row, n, 4, origin), p->bitmap, p->pixels,
                            p->n);
}

TEST(facts_made_here_are_given_once)
{
    struct rad_facts *f = rad_facts_new(WIDTH, ROWS);
    struct rad_facts *g = rad_facts_new(WIDTH, ROWS);
    static struct parcel p;

    ck_assert_uint_eq(rad_facts_stride(WIDTH), 6);
    for (int i = 0; i < MOST; i += 3)
        put(f, i, i % 2 ? RAD_FACT_USED : 0);
    put(f, 1, RAD_FACT_FOREIGN);
    put(f, 2, RAD_FACT_ESTIMATE);
    ck_assert_uint_eq(rad_facts_fresh(f), MOST / 3 + 1);
    export(f, 1, 2, 0, &p);
    ck_assert_uint_eq(p.n, 2 * WIDTH / 3);
    ck_assert_int_eq(import(g, 1, 2, RAD_FACT_FOREIGN, &p), 0);
    export(f, 0, 3, 0, &p);
    ck_assert_uint_eq(p.n, WIDTH / 3 + 1);
    ck_assert_uint_eq(p.bitmap[0], 1 | 1 << 3 | 1 << 6); /* of 0, 3, 6 */
    ck_assert_float_eq(p.pixels[4 * 1 + 1], 2 * 3);
    ck_assert_int_eq(import(g, 0, 3, RAD_FACT_FOREIGN, &p), 0);
    export(f, 0, 3, 0, &p);
    ck_assert_uint_eq(p.n, 0);
    ck_assert_uint_eq(rad_facts_fresh(f), 1);
    export(f, 0, 3, RAD_FACT_ESTIMATE, &p);
    ck_assert_uint_eq(p.n, 1);
    ck_assert_uint_eq(rad_facts_fresh(f), 0);
    for (int i = 0; i < MOST; i++) {
        struct rad_pixel out;

        if (i % 3 == 0)
            assert_known(g, i);
        else
            ck_assert(!rad_facts_get(g, i % WIDTH, i / WIDTH, &out));
    }
    export(g, 0, 3, 0, &p); /* they are not its own */
    ck_assert_uint_eq(p.n, 0);
    ck_assert_uint_eq(rad_facts_fresh(g), 0);
    rad_facts_free(f);
    rad_facts_free(g);
}

TEST(settled_facts_are_not_given)
{
    struct rad_facts *f = rad_facts_new(WIDTH, ROWS);
    static struct parcel p;

    for (int i = 0; i < MOST; i += 3)
        put(f, i, i % 2 ? RAD_FACT_USED : 0);
    put(f, 1, RAD_FACT_FOREIGN);
    put(f, 2, RAD_FACT_ESTIMATE);
    export(f, 0, 1, 0, &p);
    rad_facts_settle(f);
    ck_assert_uint_eq(rad_facts_fresh(f), 0);
    export(f, 0, ROWS, 0, &p);
    ck_assert_uint_eq(p.n, 0);
    export(f, 0, ROWS, RAD_FACT_ESTIMATE, &p);
    ck_assert_uint_eq(p.n, 0);
    put(f, 4, 0); /* one that comes later */
    export(f, 0, ROWS, 0, &p);
    ck_assert_uint_eq(p.n, 1);
    rad_facts_free(f);
}

TEST(without_depth_there_are_three_channels)
{
    struct rad_facts *f = rad_facts_new(WIDTH, 1);
    struct rad_facts *g = rad_facts_new(WIDTH, 1);
    struct rad_pixel out;
    static struct parcel p;

    put(f, 4, 0);
    put(f, 9, 0);
    p.n = rad_facts_export(f, ROWS_OF(0, 1, 3, 0), p.bitmap, p.pixels);
    ck_assert_uint_eq(p.n, 2);
    ck_assert_float_eq(p.pixels[3], 9);
    ck_assert_int_eq(
        rad_facts_import(g, ROWS_OF(0, 1, 3, 0), p.bitmap, p.pixels, 2), 0);
    ck_assert(rad_facts_get(g, 9, 0, &out));
    ck_assert_float_eq(out.L.g, 18);
    ck_assert(out.z == 0);
    rad_facts_free(f);
    rad_facts_free(g);
}

/* One thing that is wrong with a parcel of two rows. */
static const struct {
    int row, n, channels;
    int byte;
    uint8_t bits; /* set there */
    int more;     /* pixels than bits */
} bad[] = {
    { 0, 2, 3, 5, 1 << 3, 0 }, /* column 43 of 43 */
    { 0, 2, 3, 11, 1 << 7, 0 }, { 0, 2, 3, 0, 0, 1 },  { 0, 2, 3, 0, 0, -1 },
    { 2, 2, 3, 0, 0, 0 }, /* ROWS is 3 */
    { 4, 0, 3, 0, 0, 0 },       { -1, 2, 3, 0, 0, 0 }, { 1, -1, 3, 0, 0, 0 },
    { 0, 2, 2, 0, 0, 0 },       { 0, 2, 5, 0, 0, 0 },
};

LOOP_TEST(malformed_parcels_leave_nothing, N_ELEM(bad))
{
    struct rad_facts *f = rad_facts_new(WIDTH, ROWS);
    struct rad_pixel out;
    uint8_t bitmap[12] = { 1, 0, 0, 0, 0, 0, 3 };
    static float pixels[8 * 5];
    size_t n = 3 + (bad[_i].bits != 0);

    bitmap[bad[_i].byte] |= bad[_i].bits;
    ck_assert_int_eq(
        rad_facts_import(f,
                         ROWS_OF(bad[_i].row, bad[_i].n, bad[_i].channels, 0),
                         bitmap, pixels, n + (size_t)bad[_i].more),
        RAD_EPROTO);
    for (int i = 0; i < MOST; i++)
        ck_assert(!rad_facts_get(f, i % WIDTH, i / WIDTH, &out));
    rad_facts_free(f);
}

TEST(values_that_no_ray_has_are_left_out)
{
    static const float pixels[] = { NAN, 0, 0, 0, 1, 1,   1, 1,        0, -1,
                                    0,   0, 0, 0, 0, NAN, 0, INFINITY, 0, 0 };
    struct rad_facts *f = rad_facts_new(WIDTH, ROWS);
    struct rad_pixel out;
    uint8_t bitmap[6] = { 31 };

    ck_assert_int_eq(
        rad_facts_import(f, ROWS_OF(0, 1, 4, 0), bitmap, pixels, 5), 0);
    for (int x = 0; x < 5; x++)
        ck_assert_int_eq(rad_facts_get(f, x, 0, &out), x == 1);
    rad_facts_free(f);
}

enum { THREADS = 4, ROUNDS = 60 };

struct racer {
    struct rad_facts *facts;
    int number;
    size_t won;
};

/* Each puts every pixel, in an order of its own, and uses some of them. */
static void *
race(void *arg)
{
    struct racer *r = arg;
    int step = 2 * r->number + 1;

    for (int k = 0; k < MOST; k++) {
        int i = (k * step + 17 * r->number) % MOST;
        struct rad_pixel p, want = pixel(i);

        if (rad_facts_get(r->facts, i % WIDTH, i / WIDTH, &p))
            ck_assert_mem_eq(&p, &want, sizeof p);
        r->won += put(r->facts, i, r->number % 2 ? RAD_FACT_FOREIGN : 0);
        if (i % 4 == 0 && rad_facts_use(r->facts, i % WIDTH, i / WIDTH, &p))
            ck_assert_mem_eq(&p, &want, sizeof p);
    }
    return NULL;
}

LOOP_TEST(threads_that_meet_at_a_pixel_agree, ROUNDS)
{
    struct rad_facts *f = rad_facts_new(WIDTH, ROWS);
    struct rad_facts *g = rad_facts_new(WIDTH, ROWS);
    struct racer r[THREADS];
    pthread_t thread[THREADS];
    static struct parcel p;
    size_t won = 0, used = 0;

    for (int i = 0; i < THREADS; i++) {
        r[i] = (struct racer){ f, i, 0 };
        ck_assert_int_eq(pthread_create(&thread[i], NULL, race, &r[i]), 0);
    }
    for (int k = 0; k < 3; k++) { /* while they are at it */
        export(f, 0, ROWS, 0, &p);
        ck_assert_int_eq(import(g, 0, ROWS, 0, &p), 0);
    }
    for (int i = 0; i < THREADS; i++) {
        ck_assert_int_eq(pthread_join(thread[i], NULL), 0);
        won += r[i].won;
    }
    export(f, 0, ROWS, 0, &p);
    ck_assert_int_eq(import(g, 0, ROWS, 0, &p), 0);
    ck_assert_uint_eq(won, MOST);
    for (int i = 0; i < MOST; i++) {
        struct rad_pixel out;

        assert_known(f, i);
        used += i % 4 == 0;
        if (rad_facts_get(g, i % WIDTH, i / WIDTH, &out))
            assert_known(g, i);
    }
    ck_assert_uint_eq(rad_facts_unused(f), MOST - used);
    ck_assert_uint_eq(rad_facts_fresh(f), 0);
    rad_facts_free(f);
    rad_facts_free(g);
}
