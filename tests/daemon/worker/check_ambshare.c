/* check_ambshare.c - ambient records on the wire */
#include "config.h"

#include "proto/ambshare.h"

#include "tests/unit.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

static const struct rad_ambrec good = {
    .p = { 1.5, -2.25e6, 3e-9 },
    .n = { 0.6f, 0, 0.8f },
    .u = { 0, -1, 0 },
    .radius = { 0.25f, 4 },
    .E = { 1, 0, 1e6f },
    .gpos = { -3, 0.5f },
    .gdir = { 0, -7 },
    .var = 0.03125f,
    .glint = { { 7, -8, 9 }, 300 },
    .corral = 0xdeadbeef,
    .weight = 0.125f,
    .level = 3,
};

static bool
trip(const struct rad_ambrec *in, struct rad_ambrec *out)
{
    struct wire_out w;
    struct wire_in r;
    bool ok;

    wire_out_init(&w, 1000);
    ambshare_pack(&w, in);
    ck_assert(!w.bad);
    ck_assert_uint_eq(w.len, AMBSHARE_BYTES);
    wire_in_init(&r, w.buf, w.len);
    ok = ambshare_unpack(&r, out);
    ck_assert_uint_eq(wire_left(&r), 0);
    wire_out_release(&w);
    return ok;
}

TEST(record_survives_the_trip)
{
    struct rad_ambrec out;

    memset(&out, 0x55, sizeof out);
    ck_assert(trip(&good, &out));
    ck_assert_mem_eq(out.p, good.p, sizeof good.p);
    ck_assert_mem_eq(out.n, good.n, sizeof good.n);
    ck_assert_mem_eq(out.u, good.u, sizeof good.u);
    ck_assert_mem_eq(out.radius, good.radius, sizeof good.radius);
    ck_assert_mem_eq(&out.E, &good.E, sizeof good.E);
    ck_assert_mem_eq(out.gpos, good.gpos, sizeof good.gpos);
    ck_assert_mem_eq(out.gdir, good.gdir, sizeof good.gdir);
    ck_assert_float_eq(out.var, good.var);
    ck_assert_mem_eq(&out.glint, &good.glint, sizeof good.glint);
    ck_assert_uint_eq(out.corral, good.corral);
    ck_assert_float_eq(out.weight, good.weight);
    ck_assert_uint_eq(out.level, good.level);
}

TEST(record_of_unknown_variance_is_sound)
{
    struct rad_ambrec rec = good, out;

    rec.var = RAD_AMBREC_UNSURE;
    ck_assert(trip(&rec, &out));
    ck_assert_float_eq(out.var, RAD_AMBREC_UNSURE);
}

TEST(truncated_record_is_refused)
{
    struct wire_out w;
    struct wire_in r;
    struct rad_ambrec out;

    wire_out_init(&w, 1000);
    ambshare_pack(&w, &good);
    for (size_t n = 0; n < AMBSHARE_BYTES; n++) {
        wire_in_init(&r, w.buf, n);
        ck_assert(!ambshare_unpack(&r, &out));
        ck_assert(r.bad);
    }
    wire_out_release(&w);
}

/* Fields of a good record, and what makes them wrong. */
#define WRONG(field, v)                                                        \
    {                                                                          \
        offsetof(struct rad_ambrec, field), sizeof good.field, v               \
    }
/* clang-format off */
static const struct {
    size_t at, size;
    double value;
} wrong[] = {
    WRONG(p[1], NAN), WRONG(p[2], INFINITY),
    WRONG(n[0], 0.61f), WRONG(n[1], NAN), WRONG(u[1], 0),
    WRONG(radius[0], 0), WRONG(radius[1], -1), WRONG(radius[1], INFINITY),
    WRONG(E.g, -1e-9f), WRONG(E.r, NAN),
    WRONG(gpos[0], INFINITY), WRONG(gdir[1], NAN),
    WRONG(weight, 0), WRONG(weight, 1.5f), WRONG(weight, NAN),
    WRONG(var, -0.5f), WRONG(var, INFINITY),
    WRONG(glint.p[1], NAN), WRONG(glint.lum, -1)
};
/* clang-format on */

static struct rad_ambrec
spoiled(int i)
{
    struct rad_ambrec r = good;
    char *field = (char *)&r + wrong[i].at;
    float f = (float)wrong[i].value;

    if (wrong[i].size == sizeof(double))
        memcpy(field, &wrong[i].value, sizeof(double));
    else
        memcpy(field, &f, sizeof f);
    return r;
}

LOOP_TEST(unsound_record_is_refused, N_ELEM(wrong))
{
    struct rad_ambrec bad = spoiled(_i), out;

    ck_assert(!trip(&bad, &out));
}
