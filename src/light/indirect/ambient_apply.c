/* ambient_apply.c - indirect light where rays ask for it; see ambient.h
 *
 * Where the cache misses, the hemisphere is sampled (hemisphere.c) and a record
 * is made: E, its gradients as the point moves and the normal turns, and an
 * elliptic zone in which a linear extrapolation is good (ambshape.c).  */
#include "config.h"

#include "light/hemisphere/gradient.h"
#include "light/hemisphere/hemisphere.h"
#include "light/indirect/ambient_impl.h"
#include "arith/elementary.h"
#include "base/vec.h"

/* Records beyond -aa serve if their weights sum to more than this. */
#define LEAST_FAR_WEIGHT 1e-3

/* The distance that stands for infinity in the positions of hits, in sides of
 * the scene's cube: so far that a hit seems to stand still as the point moves.
 */
#define FAR_SIDES 10.

/* With ctx->glance, a hemisphere has this part of its rays. */
#define GLANCE_SHARE (1. / 16)

/* This part of a record's rays is enough where the frozen cache lacks a record
 * for a place that a single pixel shows, unless the pixel is a sensor; and for
 * deeper records of a tile that has traced its share of rays. */
#define ALONE_SHARE .25

/* The fewest cells along a side of a hemisphere.  A place that a picture shows
 * needs gradients.  A record that a frozen cache lacks at a deep place is
 * needed by a single ray, one of the many samples of a hemisphere; and in a
 * cleft that the passes missed each ray needs such a record of its own. */
#define SIDE_SHOWN 7
#define SIDE_DEEP  5
#define SIDE_ALONE 2

/* Records for rays of little weight are made for this part of the usual weight
 * of rays that have been reflected as often. */
#define LIGHT .125

/* --- making records --- */

/* The weight for which a record is made: the usual weight of a ray that has
 * been reflected as often, or LIGHT times that for much lighter rays.  (A
 * record does not serve rays that are heavier than its weight: if a record had
 * just the weight of its ray, rays of slightly different weights would each
 * make a record.) */
static float
record_weight(const struct rad_ambplace *at)
{
    double usual = rad_pow(RAD_AMBIENT_MEAN_REFLECTANCE, at->level);

    return (float)(at->weight < .1 * usual ? LIGHT * usual : usual);
}

/* The sum of the logarithms of the records' luminances, and their number. */
static void
sum_logs(const struct rad_ambient *amb, const struct rad_ambtile *tile,
         double *sum, double *n)
{
    const struct rad_ambview *v = rad_ambient_seen(amb, tile);
    int64_t logs = v->log_sum, count = v->log_count;

    if (!amb->frozen) {
        logs = atomic_load_explicit(&amb->log_sum, memory_order_relaxed);
        count = atomic_load_explicit(&amb->log_count, memory_order_relaxed);
    }
    *sum = (double)logs * RAD_AMBIENT_LOG_UNIT;
    *n = (double)count;
}

/* The geometric mean of the luminances that records see. */
static double
usual_luminance(const struct rad_ambient *amb, const struct rad_ambtile *tile)
{
    double sum, n;

    sum_logs(amb, tile, &sum, &n);
    return n > 0 ? rad_exp(sum / n) : 0;
}

/* Does a record that is made now serve a single pixel, or a single ray of such
 * a record?  Yes, with a frozen cache, unless a tile makes it; but what a pixel
 * shows is sampled afresh (ctx->fresh) with all rays of a record. */
static bool
is_alone(const struct rad_ctx *ctx, const struct rad_ambplace *at)
{
    return ctx->job->ambient->frozen && !ctx->tile &&
           !(ctx->fresh && at->level == 0);
}

/* Is the place a sensor's own?  Such a place is served by records within -aa
 * and in sight alone, or gets a record of its own with all samples. */
static bool
is_sensors(const struct rad_ctx *ctx, const struct rad_ambplace *at)
{
    return ctx->sensor && at->level == 0;
}

/* E of a new record at its own place, for the normal at->pn that textures have
 * tilted.  *off is set as by irradiance() if E was smoothed. */
static struct rad_rgb
own_light(const struct rad_ctx *ctx, const struct rad_ambrec *rec,
          const struct rad_ambplace *at, double *off)
{
    float pn[3] = { (float)at->pn[0], (float)at->pn[1], (float)at->pn[2] };
    struct rad_rgb E = rec->E;
    struct rad_smooth_value v;
    struct rad_ambitem item;
    float across[3], factor;

    rad_ambitem_set(&item, rec);
    rad_ambitem_across(&item, across);
    if (at->level == 0 && is_alone(ctx, at) &&
        rad_ambsmooth_beside(&ctx->job->ambient->smooth, &item, &v)) {
        E = rad_rgb(v.E[0], v.E[1], v.E[2]);
        *off = (double)v.var;
    }
    rad_ambient_extrapolate(&item, across, 1, pn, &factor);
    return rad_rgb_scale(E, factor);
}

/* Is the record for a pixel that is made again to estimate its error?  Then
 * gloss below -st takes rays to many places that no record serves; noise there
 * need only be small beside the pixel's light. */
static bool
is_estimates(const struct rad_ctx *ctx, const struct rad_ambplace *at)
{
    return ctx->aside && at->level == 0 && is_alone(ctx, at);
}

static int
least_side(const struct rad_ctx *ctx, const struct rad_ambplace *at)
{
    if (at->level > 0)
        return is_alone(ctx, at) ? SIDE_ALONE : SIDE_DEEP;
    if (is_estimates(ctx, at)) /* cells by the weight, too */
        return (int)rad_most(SIDE_SHOWN * sqrt(at->weight) + .5, SIDE_ALONE);
    return SIDE_SHOWN;
}

/* Sample the hemisphere at a place, and keep the result as a record if it is
 * sound.  Sets *E and *off as irradiance() does.  False: no ray could be
 * traced. */
static bool
make_record(struct rad_ctx *ctx, const struct rad_ray *r,
            const struct rad_ambplace *at, bool behind, struct rad_rgb *E,
            double *off)
{
    struct rad_ambient *amb = ctx->job->ambient;
    struct rad_ambrec rec = { .level = (uint16_t)at->level };
    struct rad_arena_mark mark = rad_arena_mark(&ctx->scratch);
    struct rad_hemi_plan plan = { .behind = behind, .store = true };
    uint64_t unsound = ctx->counts.unsound_rays;
    const struct rad_ambview *seen;
    struct rad_hemi h;
    bool ok;

    if (rad_ambient_gave_up(ctx))
        return false;
    rec.weight = record_weight(at);
    plan.weight = rad_ambrec_worth(&rec);
    if (is_alone(ctx, at) && !is_sensors(ctx, at))
        /* each of the pixel's samples makes a record of its own */
        plan.weight *= ALONE_SHARE / ctx->job->params.samples;
    else if (ctx->tile && at->level > ctx->tile->level &&
             ctx->counts.ambient_rays >= ctx->tile->most)
        plan.weight *= ALONE_SHARE;
    if (ctx->glance)
        plan.weight *= GLANCE_SHARE;
    if (is_estimates(ctx, at))
        plan.weight *= at->weight;
    plan.side = least_side(ctx, at);
    plan.coef = rad_grey((float)RAD_AMBIENT_MEAN_REFLECTANCE);
    plan.far = FAR_SIDES * amb->scale.side;
    seen = rad_ambient_seen(amb, ctx->tile);
    if (seen->bright.n > 0) {
        plan.bright = &seen->bright;
        plan.usual = usual_luminance(amb, ctx->tile);
    }
    rad_copy(plan.normal, at->n);
    ok = rad_hemi_sample(ctx, r, &plan, &h);
    if (ok)
        *E = h.E;
    /* not kept: a hemisphere in which a ray was NaN, which counted as black,
     * or with so few cells that gradients would be noise */
    if (ok && h.complete && h.n >= SIDE_DEEP &&
        ctx->counts.unsound_rays == unsound) {
        rad_copy(rec.p, at->p);
        for (int k = 0; k < 3; k++)
            rec.n[k] = (float)at->n[k];
        rec.E = h.E;
        rec.var = (float)h.var;
        rec.glint = rad_bright_glint(&h, at->p, r->key);
        rad_ambrec_shape(&amb->scale, &h, &rec);
        if (!ctx->aside && rad_ambient_keep(ctx, &rec))
            ctx->counts.ambient_values++;
        *E = own_light(ctx, &rec, at, off);
    }
    rad_arena_rewind(&ctx->scratch, mark);
    return ok;
}

/* Without a cache: sample the hemisphere for this place alone.  If the
 * hemisphere has few cells, or the rays of some cells were refused, textures do
 * not tilt the normal, as in rpict. */
static bool
sample_here(struct rad_ctx *ctx, const struct rad_ray *r,
            const struct rad_ambplace *at, bool behind,
            const struct rad_rgb *coef, struct rad_rgb *E)
{
    struct rad_arena_mark mark = rad_arena_mark(&ctx->scratch);
    struct rad_hemi_plan plan = { .behind = behind,
                                  .coef = *coef,
                                  .weight = at->weight };
    struct rad_hemi h;
    double turn[2], axis[3];
    bool ok;

    rad_copy(plan.normal, at->n);
    ok = rad_hemi_sample(ctx, r, &plan, &h);
    if (ok) {
        *E = h.E;
        rad_cross(axis, at->n, at->pn);
        if (h.complete && h.n >= SIDE_SHOWN && rad_dot(axis, axis) > 0 &&
            rad_rgb_lum(*E) > 0) {
            rad_hemi_turn(&h, turn);
            double f =
                1 + turn[0] * rad_dot(axis, h.u) + turn[1] * rad_dot(axis, h.v);

            *E = rad_rgb_scale(
                *E, (float)rad_most(f, (double)RAD_AMBIENT_LEAST_FACTOR));
        }
    }
    rad_arena_rewind(&ctx->scratch, mark);
    return ok;
}

/* --- where a ray is --- */

/* Diffuse bounces on the way to r's hit. */
static int
bounces(const struct rad_ray *r)
{
    int n = 0;

    for (; r; r = r->parent)
        if (r->kind & RAD_RAY_AMBIENT)
            n++;
    return n;
}

/* The luminance that light L at r's hit brings to the pixel. */
static double
through(const struct rad_ray *r, struct rad_rgb L)
{
    for (; r; r = r->parent)
        L = rad_rgb_mul(L, r->coef);
    return rad_rgb_lum(L);
}

/* Are records of the place's level made now?  In a frozen cache each level has
 * passes of its own. */
static bool
is_due(const struct rad_ctx *ctx, const struct rad_ambplace *at)
{
    return !ctx->job->ambient->frozen ||
           (ctx->tile && ctx->tile->level == at->level);
}

/* Do the records that were found serve, so that none is made?  If records of
 * this level are not due, records beyond -aa are good enough: the passes for
 * this level are over. */
static bool
serves(const struct rad_ambsaid *said, bool due)
{
    return said->serves > 0 || (!due && said->weight > LEAST_FAR_WEIGHT);
}

bool
rad_ambient_serves(struct rad_ctx *ctx, const struct rad_ambplace *at)
{
    bool due = is_due(ctx, at);
    struct rad_ambasker asker = { .tile = ctx->tile,
                                  .only = due,
                                  .counts = &ctx->counts.geom,
                                  .rays = &ctx->counts.rays };
    struct rad_ambsaid said;

    rad_ambient_ask(ctx->job->ambient, at, &asker, &said);
    return serves(&said, due);
}

/* -av; with -aw its geometric mean with the radiances of the records so far,
 * which are E / pi times 1 - the mean reflectance. */
static struct rad_rgb
constant_radiance(const struct rad_ctx *ctx)
{
    const struct rad_params *par = &ctx->job->params;
    struct rad_rgb av = par->ambval;
    const struct rad_ambient *amb = ctx->job->ambient;
    double lum = rad_rgb_lum(av), sum, n;

    if (!amb || par->ambvwt <= 0)
        return av;
    sum_logs(amb, ctx->tile, &sum, &n);
    if (!(n > 0))
        return av;
    sum += n * rad_log(1 - RAD_AMBIENT_MEAN_REFLECTANCE);
    if (!(lum > 0))
        return rad_grey((float)rad_exp(sum / n));
    sum += par->ambvwt * rad_log(lum);
    return rad_rgb_scale(av, rad_exp(sum / (par->ambvwt + n)) / lum);
}

/* --- light beyond -ab --- */

/* With -ab n, which is ctx->walk, a pixel has n bounces of indirect light. What
 * it lacks comes to the n-th surface of a path from there.  A record of level 1
 * at that surface knows n - 1 bounces of it; what that record lacks comes to
 * the surface n - 1 bounces further, and so on. */
static bool
is_surface_asked(const struct rad_ctx *ctx, int level)
{
    int beyond = level - ctx->walk;

    return beyond >= 0 && beyond % (ctx->walk - 1) == 0;
}

/* Add what a record of level 1 brings from r's hit to the pixel. */
static void
note_beyond(struct rad_ctx *ctx, const struct rad_ray *r,
            const struct rad_ambplace *at, const struct rad_rgb *coef)
{
    struct rad_ambplace deep = *at;
    struct rad_ambasker asker = { .counts = &ctx->counts.geom,
                                  .rays = &ctx->counts.rays };
    struct rad_ambsaid said;

    deep.level = 1;
    deep.weight = LIGHT * RAD_AMBIENT_MEAN_REFLECTANCE; /* any record serves */
    rad_ambient_ask(ctx->job->ambient, &deep, &asker, &said);
    if (said.weight > LEAST_FAR_WEIGHT)
        ctx->beyond += through(r, rad_rgb_mul(*coef, said.E)) / M_PI;
}

/* Follow a path on from r's hit. */
static bool
walk_on(struct rad_ctx *ctx, const struct rad_ray *r,
        const struct rad_ambplace *at, bool behind, const struct rad_rgb *coef,
        struct rad_rgb *E)
{
    if (is_surface_asked(ctx, at->level))
        note_beyond(ctx, r, at, coef);
    return sample_here(ctx, r, at, behind, coef, E);
}

/* --- use --- */

/* Set *E at the place, interpolated or sampled, and *off to its expected
 * squared error, over its square.  False: no ray could be traced; or records
 * serve, and E itself is not wanted, since a tile asks for records only. */
static bool
irradiance(struct rad_ctx *ctx, const struct rad_ray *r,
           const struct rad_ambplace *at, bool behind,
           const struct rad_rgb *coef, struct rad_rgb *E, double *off)
{
    struct rad_ambasker asker = { .tile = ctx->tile,
                                  .counts = &ctx->counts.geom,
                                  .rays = &ctx->counts.rays };
    struct rad_ambsaid said;
    bool due;

    if (!ctx->job->ambient)
        return sample_here(ctx, r, at, behind, coef, E);
    if (ctx->walk > 0)
        return walk_on(ctx, r, at, behind, coef, E);
    due = is_due(ctx, at);
    asker.only = ctx->tile && ctx->no_direct && due;
    asker.fresh = ctx->fresh && at->level == 0;
    asker.sensor = is_sensors(ctx, at);
    asker.serving = at->level == 0 ? ctx->serving : NULL;
    rad_ambient_ask(ctx->job->ambient, at, &asker, &said);
    if (!serves(&said, due) &&
        !(ctx->glance && said.weight > LEAST_FAR_WEIGHT)) {
        if (asker.serving)
            rad_ambserving_forget(asker.serving);
        return make_record(ctx, r, at, behind, E, off);
    }
    if (asker.only)
        return false;
    *E = said.E;
    *off = said.off;
    return true;
}

/* Add to the pixel's doubt that light of luminance `lum` in it has the expected
 * squared error `off`, over its square. */
static void
note_doubt(struct rad_ctx *ctx, double lum, double off)
{
    ctx->doubt += lum * lum * off;
    if (ctx->serving)
        rad_ambserving_scale(ctx->serving, lum);
}

/* Is the surface that r met left out by -ae or -ai? */
static bool
left_out(const struct rad_job *job, const struct rad_ray *r)
{
    int32_t mod;

    if (!job->noambient || r->hit.obj == RAD_VOID)
        return false;
    mod = job->scene->objects[r->hit.obj].modifier;
    return mod != RAD_VOID && job->noambient[mod];
}

void
rad_ambient_apply(struct rad_ctx *ctx, struct rad_ray *r, const double n[3],
                  struct rad_rgb *coef)
{
    const struct rad_params *par = &ctx->job->params;
    struct rad_ambplace at;
    struct rad_rgb E = { 0, 0, 0 };
    double off = 0;
    bool behind = rad_dot(r->n, n) < 0;

    if (par->ambounce > 0 && par->ambdiv > 0 &&
        (at.level = bounces(r)) < par->ambounce && !left_out(ctx->job, r)) {
        at.weight = r->weight;
        rad_copy(at.p, r->hit.p);
        at.err = r->hit.err;
        rad_scale(at.n, behind ? -1 : 1, r->n);
        rad_copy(at.pn, n);
        if (irradiance(ctx, r, &at, behind, coef, &E, &off)) {
            *coef = rad_rgb_scale(rad_rgb_mul(*coef, E), 1 / M_PI);
            if (at.level == 0)
                note_doubt(ctx, through(r, *coef), off);
            return;
        }
    }
    *coef = rad_rgb_mul(*coef, constant_radiance(ctx));
}
