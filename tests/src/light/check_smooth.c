/* check_smooth.c - noise of neighbouring places, averaged */
#include "config.h"

#include "base/rng.h"
#include "base/vec.h"
#include "light/smooth/smooth.h"
#include "tests/unit.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

enum { SIDE = 40, N = SIDE * SIDE };

/* Places on the unit square, a 40th apart, whose E is about linear within
 * .06: neighbours are up to .3 off. */
#define REACH .06f
#define NOISE .1

typedef double field(const double p[3], const float n[3]);

static double
frand(uint32_t i, uint32_t dim)
{
    return rad_rand(rad_mix64(dim), i);
}

static void
set_light(struct rad_smooth_place *at, double E, double noise, uint32_t i)
{
    double measured = E * (1 + noise * sqrt(12) * (frand(i, 3) - .5));

    at->E[0] = (float)(1.2 * measured);
    at->E[1] = (float)measured;
    at->E[2] = (float)(.5 * measured);
    at->var = (float)(noise * noise);
}

static void
set_place(struct rad_smooth_place *at, uint32_t i, field *E, double noise)
{
    memset(at, 0, sizeof *at);
    at->p[0] = (i % SIDE + frand(i, 1)) / SIDE;
    at->p[1] = (i / SIDE + frand(i, 2)) / SIDE;
    at->n[2] = at->u[0] = at->v[1] = 1;
    at->reach = REACH;
    at->bend = 1;
    set_light(at, E(at->p, at->n), noise, i);
}

static struct rad_smooth_place place[N];
static struct rad_smooth_value value[N];

static void
lay_out(field *E, double noise)
{
    for (uint32_t i = 0; i < N; i++)
        set_place(&place[i], i, E, noise);
}

static _Atomic uint64_t looks; /* at places, of all threads */

static const double *
point_of(const void *arg, uint32_t i)
{
    const struct rad_smooth_place *at = arg;

    atomic_fetch_add_explicit(&looks, 1, memory_order_relaxed);
    return at[i].p;
}

static void
place_of(const void *arg, uint32_t i, struct rad_smooth_place *to)
{
    const struct rad_smooth_place *at = arg;

    atomic_fetch_add_explicit(&looks, 1, memory_order_relaxed);
    *to = at[i];
}

static bool has_wall; /* at x = .5 */

static bool
are_parted(const void *arg, const struct rad_smooth_place *a,
           const struct rad_smooth_place *b)
{
    (void)arg;
    return has_wall && (a->p[0] < .5) != (b->p[0] < .5);
}

/* Of the first n places. */
static struct rad_smooth *
smooth_of(uint32_t n)
{
    struct rad_smooth *s = rad_smooth_new(&(struct rad_smooth_source){
        place, n, point_of, place_of, are_parted });

    ck_assert_ptr_nonnull(s);
    return s;
}

static void
smooth(void)
{
    struct rad_smooth *s = smooth_of(N);

    for (uint32_t i = 0; i < N; i++)
        rad_smooth_at(s, i, &value[i]);
    rad_smooth_free(s);
}

struct off {
    double mean, rms; /* relative, of green */
};

static struct off
off_by(field *E, bool smoothed, bool (*among)(const struct rad_smooth_place *))
{
    double sum = 0, sum2 = 0, n = 0;

    for (int i = 0; i < N; i++) {
        const struct rad_smooth_place *at = &place[i];
        double is = smoothed ? value[i].E[1] : at->E[1];
        double d = is / E(at->p, at->n) - 1;

        if (among && !among(at))
            continue;
        sum += d;
        sum2 += d * d;
        n++;
    }
    return (struct off){ sum / n, sqrt(sum2 / n) };
}

/* --- fields --- */

static double
plane(const double p[3], const float n[3])
{
    (void)n;
    return 1 + .5 * p[0] - .3 * p[1];
}

static double
bowl(const double p[3], const float n[3])
{
    double x = p[0] - .5, y = p[1] - .4;

    (void)n;
    return 2 - 2 * x * x - 1.5 * y * y + x * y;
}

/* On a cylinder along y: lit from the side. */
static double
sidelit(const double p[3], const float n[3])
{
    return 1 + .5 * (double)n[0] + .2 * p[1];
}

/* Lit on one side of a wall at x = .5. */
static double
walled(const double p[3], const float n[3])
{
    (void)n;
    return p[0] < .5 ? 1 + .2 * p[1] : 0;
}

/* --- tests --- */

LOOP_TEST(noise_falls_and_the_mean_stays, 2)
{
    static field *const fields[] = { plane, bowl };
    struct off raw, less;

    lay_out(fields[_i], NOISE);
    raw = off_by(fields[_i], false, NULL);
    smooth();
    less = off_by(fields[_i], true, NULL);
    ck_assert_double_gt(raw.rms, .9 * NOISE);
    ck_assert_msg(less.rms < .35 * raw.rms, "%g, was %g", less.rms, raw.rms);
    ck_assert_msg(fabs(less.mean - raw.mean) < .004, "%g, was %g", less.mean,
                  raw.mean);
    for (int i = 0; i < N; i++) { /* all channels are one surface's */
        ck_assert_double_eq_tol(value[i].E[0] / value[i].E[1], 1.2, 1e-4);
        ck_assert_double_eq_tol(value[i].E[2] / value[i].E[1], .5, 1e-4);
        ck_assert(value[i].var > 0 && value[i].var < NOISE * NOISE);
    }
}

TEST(slopes_are_the_fields)
{
    double sum[2] = { 0, 0 };

    lay_out(plane, .02);
    smooth();
    for (int i = 0; i < N; i++)
        for (int k = 0; k < 2; k++)
            sum[k] += (double)(value[i].gpos[k] * value[i].E[1]) / N;
    ck_assert_double_eq_tol(sum[0], .5, .05);
    ck_assert_double_eq_tol(sum[1], -.3, .05);
}

/* Where nothing is in doubt nothing moves, whatever the field. */
TEST(what_has_no_noise_stays)
{
    lay_out(bowl, 0);
    for (int i = 0; i < N; i++)
        place[i].var = 1e-8f;
    smooth();
    ck_assert_double_lt(off_by(bowl, true, NULL).rms, 2e-4);
    for (int i = 0; i < N; i++)
        place[i].var = i % 2 ? 0 : -1; /* none at all, or nobody knows */
    smooth();
    for (int i = 0; i < N; i++)
        ck_assert(memcmp(value[i].E, place[i].E, sizeof place[i].E) == 0);
}

static bool
is_lit(const struct rad_smooth_place *at)
{
    return at->p[0] < .5;
}

LOOP_TEST(nothing_leaks_through_a_wall, 2)
{
    struct off raw, less;

    lay_out(walled, NOISE);
    for (int i = 0; i < N; i++)
        if (!is_lit(&place[i])) /* dark, as far as samples tell */
            set_light(&place[i], _i * 1e-3, NOISE, (uint32_t)i);
    has_wall = true;
    smooth();
    has_wall = false;
    raw = off_by(walled, false, is_lit);
    less = off_by(walled, true, is_lit);
    ck_assert_double_lt(less.rms, .45 * raw.rms);
    ck_assert_double_lt(fabs(less.mean - raw.mean), .005);
    for (int i = 0; i < N; i++)
        if (!is_lit(&place[i]))
            ck_assert_msg(value[i].E[1] <= 1.2e-3f * (float)_i, "%g at %g",
                          (double)value[i].E[1], place[i].p[0]);
}

/* A place that the others do not know: as little noise, and they stay as they
 * are. */
TEST(a_place_beside_is_as_good)
{
    struct rad_smooth_value v;
    double raw = 0, less = 0, mean = 0;
    struct rad_smooth *s;

    lay_out(bowl, NOISE);
    smooth();
    s = smooth_of(N);
    for (uint32_t i = 0; i < N; i++) {
        struct rad_smooth_place at;
        double E, d;

        set_place(&at, N + i, bowl, NOISE);
        at.p[1] -= 1; /* within the square again */
        E = bowl(at.p, at.n);
        set_light(&at, E, NOISE, N + i);
        rad_smooth_beside(s, &at, &v);
        d = (double)v.E[1] / E - 1;
        less += d * d / N;
        mean += d / N;
        d = (double)at.E[1] / E - 1;
        raw += d * d / N;
        ck_assert(v.var > 0 && v.var < NOISE * NOISE);
    }
    ck_assert_double_lt(sqrt(less), .35 * sqrt(raw));
    ck_assert_double_lt(fabs(mean), .004);
    for (uint32_t i = 0; i < N; i++) {
        rad_smooth_at(s, i, &v);
        ck_assert(memcmp(&v, &value[i], sizeof v) == 0);
    }
    rad_smooth_free(s);
}

TEST(faces_at_an_edge_are_apart)
{
    lay_out(plane, NOISE);
    for (int i = 0; i < N; i += 2) { /* every other one on a wall at x = 0 */
        struct rad_smooth_place *at = &place[i];

        at->p[2] = at->p[0];
        at->p[0] = at->n[2] = at->u[0] = 0;
        at->n[0] = at->u[2] = 1;
        set_light(at, 9, NOISE, (uint32_t)i);
    }
    smooth();
    for (int i = 0; i < N; i++)
        ck_assert(i % 2 ? value[i].E[1] < 2.2f : value[i].E[1] > 7);
}

/* Lit a little more from below. */
static double
sheet(const double p[3], const float n[3])
{
    return plane(p, n) * (n[2] < 0 ? 1.1 : 1);
}

static bool
is_below(const struct rad_smooth_place *at)
{
    return at->n[2] < 0;
}

TEST(sides_of_a_sheet_are_apart)
{
    struct off raw, less;

    lay_out(plane, NOISE);
    for (int i = 0; i < N; i += 2) {
        struct rad_smooth_place *at = &place[i];

        at->n[2] = at->v[1] = -1;
        set_light(at, sheet(at->p, at->n), NOISE, (uint32_t)i);
    }
    smooth();
    raw = off_by(sheet, false, is_below);
    less = off_by(sheet, true, is_below);
    ck_assert_double_lt(less.rms, .45 * raw.rms);
    ck_assert_double_lt(fabs(less.mean - raw.mean), .006);
}

/* Places around a cylinder of radius .3, whose E changes as the normal turns,
 * and does not as the place moves. */
TEST(round_surfaces_are_one)
{
    struct off raw, less;
    double moves = 0;

    for (uint32_t i = 0; i < N; i++) {
        struct rad_smooth_place *at = &place[i];
        double angle, s, c;

        set_place(at, i, plane, NOISE);
        angle = at->p[0] * 2 * M_PI;
        s = sin(angle), c = cos(angle);
        at->p[0] = .3 * c;
        at->p[2] = .3 * s;
        at->n[0] = (float)c;
        at->n[2] = (float)s;
        at->u[0] = (float)-s;
        at->u[2] = (float)c;
        /* turning about v = y moves the normal away from u */
        at->gdir[1] = (float)(-.5 * s / sidelit(at->p, at->n));
        set_light(at, sidelit(at->p, at->n), NOISE, i);
    }
    raw = off_by(sidelit, false, NULL);
    smooth();
    less = off_by(sidelit, true, NULL);
    ck_assert_msg(less.rms < .6 * raw.rms, "%g, was %g", less.rms, raw.rms);
    ck_assert_double_lt(fabs(less.mean - raw.mean), .004);
    for (int i = 0; i < N; i++) /* u is (-s, 0, c) */
        moves -= (double)(value[i].gpos[0] * value[i].E[1] * place[i].u[0]) / N;
    ck_assert_double_eq_tol(moves, 0, .15);
}

/* One ray has met a lamp; or there is a bright spot in truth. */
LOOP_TEST(what_one_ray_rules_makes_no_splotch, 2)
{
    const int at = N / 2 + SIDE / 2;
    struct off rest;

    lay_out(plane, NOISE);
    set_light(&place[at], 22, NOISE, (uint32_t)at);
    place[at].var = _i ? 1e-4f : .9f;
    smooth();
    if (_i) {
        ck_assert_double_gt((double)value[at].E[1], 15);
    } else {
        ck_assert_double_lt((double)value[at].E[1], 2);
        place[at].E[1] = value[at].E[1];
        rest = off_by(plane, true, NULL);
        ck_assert_double_lt(rest.rms, .5 * NOISE);
    }
}

/* Light that few hemispheres' rays find, each as much of it as there are others
 * that find none, over what all see: hardly any may be lost, in the mean of
 * several draws. */
static const struct {
    double hits, base, lost;
} rare[] = {
    { .4, 0, .05 },  { .4, 1, .005 }, { .1, 0, .11 },
    { .1, 1, .065 }, { .05, 1, .1 },
};

LOOP_TEST(rare_light_is_not_lost, N_ELEM(rare))
{
    double before = 0, after = 0;

    for (uint32_t round = 0; round < 8; round++) {
        for (uint32_t i = 0; i < N; i++) {
            bool hit = frand(i, 4 + round) < rare[_i].hits;
            double E = rare[_i].base + (hit ? 1 / rare[_i].hits : 0);

            set_place(&place[i], i, plane, NOISE);
            set_light(&place[i], E, NOISE, i);
            if (hit)
                place[i].var = .5f;
            else if (E == 0)
                place[i].var = 0;
            before += (double)place[i].E[1];
        }
        smooth();
        for (int i = 0; i < N; i++)
            after += (double)value[i].E[1];
    }
    ck_assert_msg(fabs(after / before - 1) < rare[_i].lost, "%g of it",
                  after / before);
}

static uint64_t
looks_to_smooth(void)
{
    atomic_store(&looks, 0);
    smooth();
    return atomic_load(&looks);
}

/* More in one point than a fit has room for, as a file or a broken worker may
 * bring them: each keeps what it has measured, and some ten times as many
 * others are looked at as usual, not hundreds of times as many. */
LOOP_TEST(places_in_one_point_are_left_alone, 2)
{
    uint64_t usual, crowded;

    lay_out(plane, NOISE);
    usual = looks_to_smooth();
    for (int i = 0; i < N; i++)
        for (int k = 0; k < 2; k++)
            place[i].p[k] = _i ? .5 + 1e-13 * (double)(i % 7) : 0;
    crowded = looks_to_smooth();
    for (int i = 0; i < N; i++)
        ck_assert(memcmp(value[i].E, place[i].E, sizeof place[i].E) == 0);
    ck_assert_uint_lt(crowded, 40 * usual);
}

/* --- threads --- */

struct asker {
    struct rad_smooth *s;
    uint32_t step;
    struct rad_smooth_value got[N];
};

static void *
ask(void *arg)
{
    struct asker *a = arg;

    for (uint32_t k = 0; k < N; k++) {
        uint32_t i = k * a->step % N;

        rad_smooth_at(a->s, i, &a->got[i]);
    }
    return NULL;
}

TEST(all_threads_see_the_same)
{
    static struct asker asker[4];
    static const uint32_t step[] = { 1, 1, 3, 1597 };
    pthread_t thread[4];
    struct rad_smooth *s;

    lay_out(bowl, NOISE);
    smooth();
    s = smooth_of(N);
    for (int k = 0; k < 4; k++) {
        asker[k].s = s;
        asker[k].step = step[k];
        ck_assert_int_eq(pthread_create(&thread[k], NULL, ask, &asker[k]), 0);
    }
    for (int k = 0; k < 4; k++) {
        ck_assert_int_eq(pthread_join(thread[k], NULL), 0);
        ck_assert(memcmp(asker[k].got, value, sizeof value) == 0);
    }
    rad_smooth_free(s);
}

TEST(few_places_are_left_alone)
{
    struct rad_smooth *s = smooth_of(0);

    rad_smooth_free(s);
    lay_out(plane, NOISE);
    s = smooth_of(3);
    for (uint32_t i = 0; i < 4; i++) {
        if (i < 3)
            rad_smooth_at(s, i, &value[i]);
        else
            rad_smooth_beside(s, &place[i], &value[i]);
        ck_assert(memcmp(value[i].E, place[i].E, sizeof place[i].E) == 0);
    }
    rad_smooth_free(s);
}
