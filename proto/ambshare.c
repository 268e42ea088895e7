/* ambshare.c - see ambshare.h */
#include "config.h"

#include "proto/ambshare.h"

#include "proto/message.h"

#include <math.h>

#define TOGETHER 1000 /* most records in a FROZEN */
_Static_assert(TOGETHER *AMBSHARE_BYTES <= MSG_MAX_AMBIENT, "too many");

/* Tolerance of the squared length of a unit vector in floats.  Each component
 * is rounded by at most 2^-24 of itself, which changes the square of the length
 * by about 2^-23 at most; a vector beyond the tolerance was never normalized.
 */
#define UNIT_TOLERANCE 1e-5

static void
put_floats(struct wire_out *out, const float *v, int n)
{
    for (int i = 0; i < n; i++)
        wire_put_f32(out, v[i]);
}

static void
get_floats(struct wire_in *in, float *v, int n)
{
    for (int i = 0; i < n; i++)
        v[i] = wire_get_f32(in);
}

void
ambshare_pack(struct wire_out *out, const struct rad_ambrec *rec)
{
    const float E[3] = { rec->E.r, rec->E.g, rec->E.b };

    for (int i = 0; i < 3; i++)
        wire_put_f64(out, rec->p[i]);
    put_floats(out, rec->n, 3);
    put_floats(out, rec->u, 3);
    put_floats(out, rec->radius, 2);
    put_floats(out, E, 3);
    put_floats(out, rec->gpos, 2);
    put_floats(out, rec->gdir, 2);
    wire_put_f32(out, rec->var);
    put_floats(out, rec->glint.p, 3);
    wire_put_f32(out, rec->glint.lum);
    wire_put_u32(out, rec->corral);
    wire_put_f32(out, rec->weight);
    wire_put_u16(out, rec->level);
}

static bool
all_finite(const float *v, int n)
{
    for (int i = 0; i < n; i++)
        if (!isfinite(v[i]))
            return false;
    return true;
}

static bool
is_unit(const float v[3])
{
    double len2 =
        (double)v[0] * v[0] + (double)v[1] * v[1] + (double)v[2] * v[2];

    return fabs(len2 - 1) <= UNIT_TOLERANCE;
}

static bool
is_variance(float var)
{
    return isfinite(var) && (var >= 0 || var == RAD_AMBREC_UNSURE);
}

bool
ambshare_sound(const struct rad_ambrec *r)
{
    return isfinite(r->p[0]) && isfinite(r->p[1]) && isfinite(r->p[2]) &&
           is_unit(r->n) && is_unit(r->u) && all_finite(r->radius, 2) &&
           r->radius[0] > 0 && r->radius[1] > 0 && rad_rgb_sound(r->E) &&
           all_finite(r->gpos, 2) && all_finite(r->gdir, 2) &&
           is_variance(r->var) && all_finite(r->glint.p, 3) &&
           isfinite(r->glint.lum) && r->glint.lum >= 0 && r->weight > 0 &&
           r->weight <= 1;
}

bool
ambshare_unpack(struct wire_in *in, struct rad_ambrec *rec)
{
    float E[3];

    for (int i = 0; i < 3; i++)
        rec->p[i] = wire_get_f64(in);
    get_floats(in, rec->n, 3);
    get_floats(in, rec->u, 3);
    get_floats(in, rec->radius, 2);
    get_floats(in, E, 3);
    rec->E = rad_rgb(E[0], E[1], E[2]);
    get_floats(in, rec->gpos, 2);
    get_floats(in, rec->gdir, 2);
    rec->var = wire_get_f32(in);
    get_floats(in, rec->glint.p, 3);
    rec->glint.lum = wire_get_f32(in);
    rec->corral = wire_get_u32(in);
    rec->weight = wire_get_f32(in);
    rec->level = wire_get_u16(in);
    return !in->bad && ambshare_sound(rec);
}

bool
ambshare_piece(struct msg_frozen *m, const uint8_t *records, uint32_t n)
{
    if (m->last)
        return false;
    m->first += m->count;
    m->count = n - m->first < TOGETHER ? n - m->first : TOGETHER;
    m->last = m->first + m->count == n;
    m->data = records ? records + (size_t)m->first * AMBSHARE_BYTES : NULL;
    m->len = (size_t)m->count * AMBSHARE_BYTES;
    return true;
}

int
ambshare_load(struct rad_ambient *amb, const void *bytes, size_t len,
              struct rad_error *err)
{
    struct rad_ambrec rec;
    struct wire_in in;
    bool any = false;

    if (len % AMBSHARE_BYTES != 0)
        return rad_fail(err, RAD_EDATA,
                        "the ambient records end in the middle of one");
    wire_in_init(&in, bytes, len);
    while (wire_left(&in) > 0)
        if (ambshare_unpack(&in, &rec) && rad_ambient_fits(amb, &rec)) {
            any = true;
            if (!rad_ambient_insert(amb, &rec))
                return rad_fail_memory(err);
        }
    if (!rad_ambient_settle(amb))
        return rad_fail_memory(err);
    return any || len == 0 ? 0
                           : rad_fail(err, RAD_EDATA,
                                      "no ambient record of %zu fits the scene",
                                      len / AMBSHARE_BYTES);
}
