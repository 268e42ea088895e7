/* scatter.c - see scatter.h
 *
 * Directions are looked up in the surface's own frame: z along its normal,
 * whichever side is hit, and y as near to the up vector as possible.  Both
 * directions point away from the surface, and may be exchanged.
 * Look-ups are blurred: for each sample the eye's direction is jittered within
 * its cell, so that the cells of the data do not show. */
#include "config.h"

#include "shade/gloss/scatter.h"
#include "base/rng.h"
#include "base/vec.h"
#include "light/indirect/ambient.h"
#include "light/direct/source.h"
#include "scene/bsdf/bsdf.h"
#include "pattern/expr.h"
#include "pattern/stored.h"

#include <string.h>

enum { MAX_SAMPLES = 10000 };

/* Dimensions of a hit's random numbers, by use; below 2^24 altogether. */
enum {
    DIM_TOTAL = 0,       /* 2: jitter of the look-up of the total */
    DIM_DIRECT = 16,     /* 2 for each look-up of direct light */
    DIM_SAMPLE = 1 << 20 /* 3 for each ray that is drawn */
};

struct scatter {
    struct rad_expr expr; /* BSDF: thickness and up; aBSDF: up */
    const struct rad_bsdf *bsdf;
    bool proxy_type;                     /* BSDF, not aBSDF */
    struct rad_rgb front, back, through; /* diffuse parts, by the arguments */
};

/* A hit on such a surface. */
struct scatter_hit {
    struct rad_ctx *ctx;
    struct rad_ray *r;
    const struct scatter *s;
    double norm[3];          /* tilted by textures, on the side that is hit */
    double axis[3][3];       /* axes of the surface's frame, in the world */
    struct rad_bsdf_eye eye; /* direction to the eye, in that frame */
    double cell[2]; /* roots of the projected solid angles of the smallest and
                     * the largest cell for this eye */
    double thick;   /* thickness of the geometry that it stands for */
    bool peak_known;             /* are these two set? */
    struct rad_rgb peak, around; /* the peak's transmittance; value beside it */
    struct rad_rgb rdiff, tdiff; /* diffuse parts, with the patterns */
    struct rad_ray behind;       /* the ray as if it had met the far side */
};

/* --- compiling -------------------------------------------------------------
 */

static const void *
parse(struct rad_arena *arena, const char *bytes, size_t len,
      struct rad_error *err)
{
    return rad_bsdf_parse(arena, bytes, len, err);
}

static struct rad_rgb
read_color(const struct rad_job *job, const struct rad_object *o, int first)
{
    return o->nreals < first + 3 ? rad_grey(0)
                                 : rad_job_colour(job, o->reals + first);
}

int
rad_scatter_prepare(struct rad_job *job, int32_t index,
                    const struct rad_files *files, const void **data,
                    struct rad_error *err)
{
    const struct rad_object *o = &job->scene->objects[index];
    bool proxy = o->type == RAD_BSDF;
    struct scatter *s = rad_arena_calloc(&job->arena, 1, sizeof *s);
    int rc;

    if (!s)
        return rad_fail_memory(err);
    if (o->nstrings < 5 + proxy)
        return rad_scene_fail(job->scene, o, err, RAD_EDATA,
                              "too few string arguments");
    s->proxy_type = proxy;
    s->front = read_color(job, o, 0);
    s->back = read_color(job, o, 3);
    s->through = read_color(job, o, 6);
    rc = rad_expr_prepare(job, o, files, proxy ? 0x1d : 0xe, &s->expr, err);
    if (rc)
        return rc;
    s->bsdf = rad_stored(job, o, files, o->strings[proxy], parse, err);
    *data = s;
    return s->bsdf ? 0 : RAD_EDATA;
}

/* --- colours and frames ----------------------------------------------------
 */

static bool
is_lit(struct rad_rgb c)
{
    return rad_rgb_max(c) > (float)RAD_TINY;
}

/* A colour in the job's channels.  A colour outside the gamut of red, green and
 * blue is made paler. */
static struct rad_rgb
to_rgb(const struct scatter_hit *hit, const double xyz[3])
{
    static const double m[3][3] = { { 2.56531284, -1.16684962, -.398463227 },
                                    { -1.02210817, 1.97828662, .0438215555 },
                                    { .0747243773, -.251939567, 1.17721519 } };
    double c[3], keep = 1;

    if (!(xyz[1] > 0))
        return rad_grey(0);
    for (int i = 0; i < 3; i++) {
        c[i] = rad_dot(m[i], xyz);
        if (c[i] < 0 && xyz[1] < keep * (xyz[1] - c[i]))
            keep = xyz[1] / (xyz[1] - c[i]);
    }
    for (int i = 0; keep < 1 && i < 3; i++)
        c[i] = fmax(keep * c[i] + (1 - keep) * xyz[1], 0);
    return rad_job_colour(hit->ctx->job, c);
}

static void
add_light(struct rad_ray *r, struct rad_rgb L)
{
    r->L = rad_rgb_add(r->L, L);
}

static bool
to_local(const struct scatter_hit *hit, const double v[3], double local[3])
{
    for (int i = 0; i < 3; i++)
        local[i] = rad_dot(hit->axis[i], v);
    return rad_normalize(local) > 0;
}

static void
to_world(const struct scatter_hit *hit, const double local[3], double v[3])
{
    for (int i = 0; i < 3; i++)
        v[i] = local[0] * hit->axis[0][i] + local[1] * hit->axis[1][i] +
               local[2] * hit->axis[2][i];
    rad_normalize(v);
}

/* Set the surface's frame, and the eye in it.  False: up is parallel to the
 * normal. */
static bool
set_frame(struct scatter_hit *hit, const double up[3])
{
    double back[3], eye[3];

    rad_copy(hit->axis[2], hit->norm);
    rad_cross(hit->axis[0], up, hit->axis[2]);
    if (rad_normalize(hit->axis[0]) == 0)
        return false;
    rad_cross(hit->axis[1], hit->axis[2], hit->axis[0]);
    rad_scale(back, -1, hit->r->dir);
    if (!to_local(hit, back, eye))
        return false;
    rad_bsdf_look_from(hit->s->bsdf, eye, &hit->eye);
    return true;
}

/* The eye's direction, jittered within a cell of that width, to look at
 * reflection or (through) transmission alone.  Returns store, or &hit->eye
 * without jitter. */
static const struct rad_bsdf_eye *
jitter(const struct scatter_hit *hit, bool through, double width, uint32_t dim,
       struct rad_bsdf_eye *store)
{
    double v[3];

    width *= fmin(hit->ctx->job->params.specjitter, 1);
    if (!(width > RAD_TINY))
        return &hit->eye;
    rad_copy(v, hit->eye.v);
    v[0] += width * (.5 - rad_rand(hit->r->key, dim));
    v[1] += width * (.5 - rad_rand(hit->r->key, dim + 1));
    rad_normalize(v);
    rad_bsdf_look_one_way(hit->s->bsdf, v, through, store);
    return store;
}

/* Does the ray come from the front side? */
static bool
from_front(const struct scatter_hit *hit)
{
    return hit->eye.v[2] > 0;
}

/* --- the peak straight ahead -----------------------------------------------
 */

/* Directions in which the peak is looked for, relative to straight ahead, in
 * widths of the smallest cell. */
static const double probe[][2] = {
    { 0, 0 },     { -.6, 0 },    { 0, .6 },      { 0, -.6 },    { .6, 0 },
    { -.6, .6 },  { -.6, -.6 },  { .6, .6 },     { .6, -.6 },   { -1.2, 0 },
    { 0, 1.2 },   { 0, -1.2 },   { 1.2, 0 },     { -1.2, 1.2 }, { -1.2, -1.2 },
    { 1.2, 1.2 }, { 1.2, -1.2 }, { -1.8, 0 },    { 0, 1.8 },    { 0, -1.8 },
    { 1.8, 0 },   { -1.8, 1.8 }, { -1.8, -1.8 }, { 1.8, 1.8 },  { 1.8, -1.8 },
    { -2.4, 0 },  { 0, 2.4 },    { 0, -2.4 },    { 2.4, 0 },
};
enum { NPROBES = sizeof probe / sizeof probe[0] };

struct probed {
    double xyz[3], omega;
};

/* Look up all probes; order[] gets their indices, the brightest first. */
static void
look_ahead(const struct scatter_hit *hit, struct probed list[NPROBES],
           uint8_t order[NPROBES])
{
    double width = sqrt(rad_bsdf_finest(hit->s->bsdf, from_front(hit), true));

    for (int i = 0; i < NPROBES; i++) {
        double dir[3] = { -hit->eye.v[0] + probe[i][0] * width,
                          -hit->eye.v[1] + probe[i][1] * width,
                          -hit->eye.v[2] };
        int at = i;

        rad_normalize(dir);
        rad_bsdf_value(&hit->eye, dir, list[i].xyz, &list[i].omega);
        for (; at > 0 && list[order[at - 1]].xyz[1] < list[i].xyz[1]; at--)
            order[at] = order[at - 1];
        order[at] = (uint8_t)i;
    }
}

/* Sums over the cells of the peak [0] and of its surroundings [1]. */
struct sums {
    struct rad_rgb light[2];
    double omega[2];
};

/* Sum up the cells that were probed.  Small cells that are not much dimmer than
 * the brightest belong to the peak.  Two probes with the same value lie in the
 * same cell.  False: there is no peak. */
static bool
sum_peak(const struct scatter_hit *hit, const struct probed list[NPROBES],
         const uint8_t order[NPROBES], struct sums *sums)
{
    double finest = rad_bsdf_finest(hit->s->bsdf, from_front(hit), true);
    double peak = 0, last = -1;
    int n = 0;

    for (int i = 0; i < NPROBES; i++) {
        const struct probed *p = &list[order[i]];
        double y = p->xyz[1];
        bool beside;

        if (y == last)
            continue;
        last = y;
        beside = p->omega > 1.5 * finest || peak > 8 * y * n;
        if (beside && i == 0)
            return false;
        sums->light[beside] = rad_rgb_add(
            sums->light[beside], rad_rgb_scale(to_rgb(hit, p->xyz), p->omega));
        sums->omega[beside] += p->omega;
        if (!beside) {
            peak += y;
            n++;
        }
    }
    return sums->omega[1] >= .2 * sums->omega[0];
}

static struct rad_rgb
minus(struct rad_rgb a, struct rad_rgb b)
{
    return rad_rgb(fmaxf(a.r - b.r, 0), fmaxf(a.g - b.g, 0),
                   fmaxf(a.b - b.b, 0));
}

/* Set hit->peak and hit->around, which are black where there is no peak. */
static void
seek_peak(struct scatter_hit *hit)
{
    struct probed list[NPROBES];
    uint8_t order[NPROBES];
    struct sums sums = { 0 };
    struct rad_rgb rest;
    double xyz[3];

    if (!rad_bsdf_scatters(hit->s->bsdf, from_front(hit), true) ||
        !is_lit(hit->r->pattern))
        return;
    look_ahead(hit, list, order);
    if (!(list[order[0]].xyz[1] > RAD_TINY) ||
        !sum_peak(hit, list, order, &sums))
        return;
    rad_bsdf_diffuse(hit->s->bsdf, from_front(hit), true, xyz);
    rest = rad_rgb_scale(to_rgb(hit, xyz), 1 / M_PI);
    sums.light[0] = minus(sums.light[0], rad_rgb_scale(rest, sums.omega[0]));
    sums.light[1] =
        minus(rad_rgb_scale(sums.light[1], 1 / sums.omega[1]), rest);
    if (rad_rgb_lum(sums.light[0]) < .0005f)
        return;
    hit->peak = rad_rgb_mul(sums.light[0], hit->r->pattern);
    hit->around = rad_rgb_mul(sums.light[1], hit->r->pattern);
}

/* Set hit->peak and hit->around, if they are not known yet: most hits never ask
 * for them, and they take many look-ups.  Only an aBSDF has a peak. */
static void
find_peak(struct scatter_hit *hit)
{
    if (!hit->peak_known && !hit->s->proxy_type)
        seek_peak(hit);
    hit->peak_known = true;
}

static bool
has_peak(struct scatter_hit *hit)
{
    find_peak(hit);
    return is_lit(hit->peak);
}

/* --- light from sources ----------------------------------------------------
 */

/* Is a light in direction way part of the peak, which is traced by a ray? */
static bool
in_peak(struct scatter_hit *hit, const double way[3], double omega)
{
    double dx = way[0] + hit->eye.v[0], dy = way[1] + hit->eye.v[1];
    double cell = rad_bsdf_finest(hit->s->bsdf, from_front(hit), true);

    if ((way[2] > 0) == from_front(hit))
        return false;
    omega *= fabs(way[2]);
    return dx * dx + dy * dy <=
               2.5 * 4 / M_PI * (omega + cell + 2 * sqrt(omega * cell)) &&
           has_peak(hit);
}

/* The mean of jittered look-ups, less the diffuse part.  A look-up in a cell
 * that is much finer than that of the unjittered eye is left out. */
static struct rad_rgb
average(const struct scatter_hit *hit, const double way[3])
{
    bool front = from_front(hit), through = front != (way[2] > 0);
    double rest[3], xyz[3], cell;
    struct rad_rgb sum = rad_grey(0);
    int n, counted = 0;

    rad_bsdf_diffuse(hit->s->bsdf, front, through, rest);
    rad_scale(rest, 1 / M_PI, rest);
    rad_bsdf_value(&hit->eye, way, xyz, &cell);
    n = (int)fmin(
        4 * hit->ctx->job->params.specjitter * (double)hit->r->weight + .5,
        MAX_SAMPLES);
    for (int i = 0; i < (n > 1 ? n : 1); i++) {
        struct rad_bsdf_eye store;
        double size = cell;
        const struct rad_bsdf_eye *eye =
            jitter(hit, through, sqrt(cell),
                   RAD_DIM_RSPECULAR + DIM_DIRECT + 2 * (uint32_t)i, &store);

        if (eye == &store)
            rad_bsdf_value(eye, way, xyz, &size);
        if (!(xyz[1] - rest[1] > RAD_TINY)) {
            counted++;
            continue;
        }
        if (size < .12 * cell)
            continue;
        sum = rad_rgb_add(sum, to_rgb(hit, xyz));
        counted++;
    }
    if (counted == 0)
        return rad_grey(0);
    sum = rad_rgb_scale(sum, 1. / counted);
    return rest[1] > RAD_TINY ? minus(sum, to_rgb(hit, rest)) : sum;
}

/* The BSDF, less the diffuse part, for a light of solid angle omega at ldir
 * [1/sr]. */
static struct rad_rgb
scattered(struct scatter_hit *hit, const double ldir[3], double omega)
{
    bool front = from_front(hit);
    double way[3];

    if (!to_local(hit, ldir, way))
        return rad_grey(0);
    if (in_peak(hit, way, omega))
        return is_lit(hit->around) ? hit->around : rad_grey(0);
    if (!rad_bsdf_scatters(hit->s->bsdf, front, front != (way[2] > 0)))
        return rad_grey(0);
    return average(hit, way);
}

/* rad_brdf_fn: light from both sides; direct_near(): only from the side of the
 * ray; direct_far(): only from the other side. */
static void
direct_both(struct rad_rgb *coef, void *data, const double ldir[3],
            double omega)
{
    struct scatter_hit *hit = data;
    double cos_l = rad_dot(hit->norm, ldir);
    struct rad_rgb diffuse, spec;

    *coef = rad_grey(0);
    if (fabs(cos_l) <= RAD_TINY)
        return;
    diffuse = cos_l > 0 ? hit->rdiff : hit->tdiff;
    spec = scattered(hit, ldir, omega);
    if (cos_l < 0)
        spec = rad_rgb_mul(spec, hit->r->pattern);
    if (is_lit(diffuse))
        spec = rad_rgb_add(spec, rad_rgb_scale(diffuse, 1 / M_PI));
    *coef = rad_rgb_scale(spec, fabs(cos_l) * omega);
}

static void
direct_near(struct rad_rgb *coef, void *data, const double ldir[3],
            double omega)
{
    const struct scatter_hit *hit = data;

    *coef = rad_grey(0);
    if (rad_dot(hit->norm, ldir) > RAD_TINY)
        direct_both(coef, data, ldir, omega);
}

static void
direct_far(struct rad_rgb *coef, void *data, const double ldir[3], double omega)
{
    const struct scatter_hit *hit = data;

    *coef = rad_grey(0);
    if (rad_dot(hit->norm, ldir) < -RAD_TINY)
        direct_both(coef, data, ldir, omega);
}

static bool
passes_any(const struct scatter_hit *hit)
{
    return rad_bsdf_scatters(hit->s->bsdf, true, true) || is_lit(hit->tdiff);
}

static void
add_direct(struct scatter_hit *hit)
{
    if (!passes_any(hit)) {
        rad_direct(hit->ctx, hit->r, direct_near, hit, false);
    } else if (hit->thick == 0) {
        rad_direct(hit->ctx, hit->r, direct_both, hit, true);
    } else {
        rad_direct(hit->ctx, hit->r, direct_near, hit, false);
        hit->behind.L = rad_grey(0);
        rad_direct(hit->ctx, &hit->behind, direct_far, hit, true);
        add_light(hit->r, hit->behind.L);
    }
}

/* --- light from elsewhere --------------------------------------------------
 */

/* Added to the divisor, which -lw 0 makes 0. */
#define NO_WEIGHT 1e-20

/* Spawn *sr as ray i of *n, with 1 / *n of coef.  For ray 0, *n is lowered
 * until each ray has a weight of -lw.  False: do not trace it. */
static bool
spawn_sample(const struct scatter_hit *hit, struct rad_ray *sr, bool through,
             struct rad_rgb coef, int *n, int i)
{
    double least = hit->ctx->job->params.minweight + NO_WEIGHT;
    uint32_t branch = through ? RAD_BRANCH_TSPECULAR : RAD_BRANCH_RSPECULAR;
    int fewer = *n;

    for (;;) {
        struct rad_rgb share = rad_rgb_scale(coef, 1. / *n);

        if (rad_ray_spawn(
                hit->ctx, sr, through ? RAD_RAY_TSPECULAR : RAD_RAY_RSPECULAR,
                through ? &hit->behind : hit->r, &share, branch | (uint32_t)i))
            return true;
        if (i > 0 || *n <= 1)
            return false;
        fewer = (int)fmin(*n * (double)sr->weight / least, *n - 1);
        if (fewer < 1)
            return false;
        *n = fewer;
    }
}

/* A random number in [0, 1) for ray i of n: stratified if n > 1; -ss below 1
 * draws it toward .5. */
static double
draw(const struct scatter_hit *hit, uint32_t dim, int i, int n)
{
    double x = rad_rand(hit->r->key, dim);
    double width = hit->ctx->job->params.specjitter;

    if (n > 1)
        return (i + x) / n;
    return width < 1 ? .5 + width * (x - .5) : x;
}

/* Add scattered light by rays; peak_apart: leave out the peak's directions. */
static void
follow(struct scatter_hit *hit, bool through, bool peak_apart)
{
    double jitter_width = hit->ctx->job->params.specjitter;
    uint32_t dim = through ? RAD_DIM_TSPECULAR : RAD_DIM_RSPECULAR;
    int n = 1;

    if (jitter_width > 1.5)
        n = (int)fmin(jitter_width * (double)hit->r->weight + .5, MAX_SAMPLES);
    if (n < 1)
        n = 1;
    for (int i = 0; i < n; i++) {
        uint32_t at = dim + DIM_SAMPLE + 3 * (uint32_t)i;
        double to[3], xyz[3], dx, dy;
        const struct rad_bsdf_eye *from;
        struct rad_bsdf_eye store;
        struct rad_rgb coef;
        struct rad_ray sr;

        from = jitter(hit, through, hit->cell[0], at, &store);
        if (!rad_bsdf_sample(from, through, draw(hit, at + 2, i, n), to, xyz))
            break;
        dx = from->v[0] + to[0];
        dy = from->v[1] + to[1];
        if (peak_apart && dx * dx + dy * dy <= hit->cell[0] * hit->cell[0])
            continue;
        coef = to_rgb(hit, xyz);
        if (through)
            coef = rad_rgb_mul(coef, hit->r->pattern);
        if (!spawn_sample(hit, &sr, through, coef, &n, i))
            continue;
        to_world(hit, to, sr.dir);
        rad_ray_trace(hit->ctx, &sr);
        add_light(hit->r, rad_rgb_mul(sr.L, sr.coef));
    }
}

/* Trace the peak by one ray straight ahead.  False: it is too weak. */
static bool
follow_peak(struct scatter_hit *hit)
{
    struct rad_ray *r = hit->r, tr;

    if (!rad_ray_spawn(hit->ctx, &tr, RAD_RAY_TRANS, r, &hit->peak,
                       RAD_BRANCH_TRANSMIT))
        return false;
    rad_copy(tr.dir, r->dir);
    rad_ray_trace(hit->ctx, &tr);
    add_light(r, rad_rgb_mul(tr.L, tr.coef));
    r->dist = r->hit.t + rad_ray_way_of(&tr);
    return true;
}

/* Add scattered light from one side (through: from beyond the surface) by rays.
 * If it is weaker than -st, returns the factor for ambient light in its place.
 */
static struct rad_rgb
sample(struct scatter_hit *hit, bool through)
{
    const struct rad_bsdf *b = hit->s->bsdf;
    bool front = from_front(hit);
    bool apart = through &&
                 !(hit->r->path & (RAD_RAY_SPECULAR | RAD_RAY_AMBIENT)) &&
                 has_peak(hit);
    double peak = 0, share = 0;

    if (!rad_bsdf_scatters(b, front, through))
        return rad_grey(0);
    if (apart && (apart = follow_peak(hit)))
        peak = (double)rad_rgb_lum(hit->peak);
    if (rad_bsdf_most(b, front, through) - peak > RAD_TINY) {
        struct rad_bsdf_eye store;

        share = rad_bsdf_total(
            jitter(hit, through, hit->cell[1],
                   (through ? RAD_DIM_TSPECULAR : RAD_DIM_RSPECULAR) +
                       DIM_TOTAL,
                   &store),
            through);
        share = fmax(share - peak, 0);
    }
    if (share > hit->ctx->job->params.specthresh + RAD_TINY) {
        follow(hit, through, apart);
        return rad_grey(0);
    }
    if (!(share > RAD_TINY))
        return rad_grey(0);
    return through ? rad_rgb_scale(hit->r->pattern, share)
                   : rad_grey((float)share);
}

static void
add_ambient(struct scatter_hit *hit, struct rad_rgb reflected,
            struct rad_rgb passed)
{
    double back[3];

    reflected = rad_rgb_add(reflected, hit->rdiff);
    passed = rad_rgb_add(passed, hit->tdiff);
    if (is_lit(reflected)) {
        rad_ambient_apply(hit->ctx, hit->r, hit->norm, &reflected);
        add_light(hit->r, reflected);
    }
    if (is_lit(passed)) {
        rad_scale(back, -1, hit->norm);
        rad_ambient_apply(hit->ctx, &hit->behind, back, &passed);
        add_light(hit->r, passed);
    }
}

/* --- a hit -----------------------------------------------------------------
 */

/* Set the diffuse parts, with the patterns. */
static void
set_diffuse(struct scatter_hit *hit, bool front)
{
    const struct scatter *s = hit->s;
    double xyz[3];

    rad_bsdf_diffuse(s->bsdf, front, false, xyz);
    hit->rdiff = rad_rgb_add(to_rgb(hit, xyz), front ? s->front : s->back);
    hit->rdiff = rad_rgb_mul(hit->rdiff, hit->r->pattern);
    rad_bsdf_diffuse(s->bsdf, front, true, xyz);
    hit->tdiff = rad_rgb_add(to_rgb(hit, xyz), s->through);
    hit->tdiff = rad_rgb_mul(hit->tdiff, hit->r->pattern);
}

/* Evaluate thickness and up vector.  As in Radiance a number without a value is
 * 0; false: there is such a number, and it has been counted. */
static bool
evaluate(const struct scatter_hit *hit, double *thick, double up[3])
{
    const struct scatter *s = hit->s;
    double v[4];
    bool sound =
        rad_expr_values_all(hit->ctx, &s->expr, hit->r, s->expr.n, false, v);

    *thick = s->proxy_type ? v[0] * rad_expr_scale(&s->expr, hit->r) : 0;
    if (fabs(*thick) <= RAD_TINY)
        *thick = 0;
    rad_copy(up, v + s->proxy_type);
    rad_expr_outward(&s->expr, hit->r, up);
    return sound;
}

/* Does the ray see the geometry that the surface stands for?  Yes, if it is a
 * view ray or shadow ray, or comes from the side of that geometry. */
static bool
shows_geometry(const struct scatter_hit *hit, double thick)
{
    const struct rad_ray *r = hit->r;

    return thick != 0 && (r->path & RAD_RAY_SHADOW ||
                          !(r->path & (RAD_RAY_SPECULAR | RAD_RAY_AMBIENT)) ||
                          (thick > 0) != (r->cos_o > 0));
}

static void
pass_shadow(struct scatter_hit *hit)
{
    struct rad_ray *r = hit->r, tr;

    find_peak(hit);
    if (!rad_ray_spawn(hit->ctx, &tr, RAD_RAY_TRANS, r, &hit->peak,
                       RAD_BRANCH_TRANSMIT))
        return;
    rad_copy(tr.dir, r->dir);
    rad_ray_trace(hit->ctx, &tr);
    r->L = rad_rgb_mul(tr.L, tr.coef);
}

static void
set_cells(struct scatter_hit *hit)
{
    rad_bsdf_cells(&hit->eye, hit->cell);
    hit->cell[0] = sqrt(hit->cell[0]);
    hit->cell[1] = sqrt(hit->cell[1]);
    if (!from_front(hit))
        rad_scale(hit->norm, -1, hit->norm);
    hit->behind = *hit->r;
    rad_madd(hit->behind.hit.p, hit->r->hit.p, -hit->thick, hit->r->n);
}

bool
rad_scatter_shade(struct rad_ctx *ctx, const struct rad_material *mat,
                  struct rad_ray *r)
{
    struct scatter_hit hit = { .ctx = ctx, .r = r, .s = mat->data };
    bool front = r->cos_o > 0, shadow = r->path & RAD_RAY_SHADOW, sound;
    struct rad_rgb reflected, passed;
    double up[3];

    if (!front && !ctx->job->params.backvis) {
        rad_ray_transmit(ctx, r);
        return true;
    }
    sound = evaluate(&hit, &hit.thick, up);
    if (shows_geometry(&hit, hit.thick)) {
        rad_ray_transmit(ctx, r);
        return true;
    }
    if (shadow &&
        (hit.s->proxy_type || !rad_bsdf_scatters(hit.s->bsdf, true, true)))
        return true;
    rad_ray_texture(ctx, r, mat->next);
    rad_ray_normal(r, hit.norm);
    if (!set_frame(&hit, up)) {
        if (sound)
            rad_counts_fault(&ctx->counts, hit.s->expr.object);
        return true;
    }
    if (shadow) {
        pass_shadow(&hit);
        return true;
    }
    set_diffuse(&hit, front);
    set_cells(&hit);
    reflected = sample(&hit, false);
    passed = sample(&hit, true);
    add_ambient(&hit, reflected, passed);
    add_direct(&hit);
    return true;
}
