/* ray.c - see ray.h
 *
 * Which surfaces a ray sees, and what counts as its length, is decided as in
 * Radiance's ray tracing core, so that depth pictures and irradiance agree with
 * rpict's. */
#include "config.h"

#include "trace/ray.h"
#include "arith/expf.h"
#include "base/rng.h"
#include "base/vec.h"
#include "trace/asks.h"

#include <string.h>

/* Beyond this optical depth the transmittance is 0: exp(-92) times any sensible
 * radiance is too small for a float. */
#define OPAQUE_DEPTH 92.0

/* The factor by which extinction along the parent's length lowers a child's
 * weight: that of the clearest channel, and 1 if the depth is too small to be
 * worth an exponential. */
static float
medium_weight(const struct rad_ray *parent)
{
    const struct rad_rgb *e = &parent->ext;
    double least = rad_least(e->r, rad_least(e->g, e->b)), depth;

    if (least <= 0)
        return 1;
    depth = least * parent->hit.t;
    return depth <= .1 ? 1 : depth > OPAQUE_DEPTH ? 0 : rad_expf(-depth);
}

static void
spawn_primary(const struct rad_ctx *ctx, struct rad_ray *r,
              enum rad_raykind kind)
{
    r->level = 0;
    r->depth = 0;
    r->path = (uint16_t)kind;
    r->source = -1;
    r->sample = 0;
    r->blur = 0;
    r->ext = ctx->job->params.cextinction;
    r->medium = ctx->job->medium;
}

static void
spawn_child(struct rad_ray *r, enum rad_raykind kind,
            const struct rad_ray *parent, uint32_t branch)
{
    r->key = rad_key_branch(parent->key, branch);
    r->depth = parent->depth + 1;
    r->level = parent->level;
    r->path = (uint16_t)(parent->path | kind);
    r->ext = parent->ext;
    r->medium = parent->medium;
    if (kind & RAD_RAY_REFL) {
        if (r->level < INT16_MAX)
            r->level++;
        r->source = -1;
        r->tmax = INFINITY;
    } else {
        r->source = parent->source;
        r->tmax = parent->tmax - parent->hit.t;
    }
    r->weight *= parent->weight * medium_weight(parent);
    r->sample = kind & RAD_RAY_AMBIENT ? r->weight : parent->sample;
    r->blur = parent->blur;
}

/* A hemisphere's ray is a sample among many, and the noise of their mean hardly
 * falls if all its branches are traced: a branch with less than this share of
 * its weight is left to roulette.  With .25 offices and rooms of mirrors take
 * .66 to .75 of the time at the same error (doc/accuracy.md). */
#define WHOLE_SHARE .25f

/* Russian roulette: let a ray below the weight `least` die at random; one that
 * survives gets that weight, and a coefficient raised as much. */
static bool
roulette(struct rad_ray *r, double least)
{
    if (r->weight >= least)
        return true;
    if (rad_rand(r->key, RAD_DIM_ROULETTE) > r->weight / least)
        return false;
    r->coef = rad_rgb_scale(r->coef, least / r->weight);
    r->weight = (float)least;
    return true;
}

/* The same for a branch of a tree that has more than its share of rays.  The
 * larger the tree, the less likely a branch lives: so each ray has less than
 * one child on average in the end, whatever its surface makes of it. */
static bool
lives_in_tree(const struct rad_ctx *ctx, struct rad_ray *r)
{
    double several = rad_most(ctx->job->params.specjitter, 1);
    bool many = ctx->walk > 0 || r->path & RAD_RAY_AMBIENT;
    double most = (many ? RAD_MAX_WALK : RAD_MAX_TREE) * several;

    if (ctx->tree <= most)
        return true;
    if (rad_rand(r->key, RAD_DIM_TREE) > most / ctx->tree)
        return false;
    r->coef = rad_rgb_scale(r->coef, ctx->tree / most);
    return true;
}

/* Set all fields of a spawned ray but its direction.  False: its parent is
 * infinitely long, the path is too deep, or its weight is 0. */
static bool
begin(const struct rad_ctx *ctx, struct rad_ray *r, enum rad_raykind kind,
      const struct rad_ray *parent, const struct rad_rgb *coef, uint32_t branch)
{
    /* channel by channel: a load of all three would have to wait for the stores
     * of each, which the caller has just made */
    r->coef = coef ? rad_rgb(coef->r, coef->g, coef->b) : rad_grey(1);
    /* coefficients above 1 must not let paths grow */
    r->weight = rad_rgb_max(r->coef);
    r->weight = r->weight < 1 ? r->weight : 1;
    r->kind = (uint16_t)kind;
    r->parent = parent;
    r->line = NULL;
    if (!parent) {
        spawn_primary(ctx, r, kind);
    } else {
        if (!(parent->hit.t < INFINITY) || parent->depth >= RAD_MAX_DEPTH)
            return false;
        spawn_child(r, kind, parent, branch);
    }
    return r->weight > 0;
}

/* Is r within the limits of -lw and -lr?  With roulette (-lr 0 or less) -lw is
 * none: a ray with a coefficient plays for it, and another goes as far as the
 * ray that it goes on from. */
static bool
is_within_limits(const struct rad_params *p, const struct rad_ray *r)
{
    if (r->path & RAD_RAY_SHADOW) /* no limit applies to shadow rays */
        return true;
    if (p->maxdepth <= 0)
        return p->maxdepth == 0 || r->level <= -p->maxdepth;
    return r->weight >= p->minweight && r->level <= p->maxdepth;
}

bool
rad_ray_spawn(struct rad_ctx *ctx, struct rad_ray *r, enum rad_raykind kind,
              const struct rad_ray *parent, const struct rad_rgb *coef,
              uint32_t branch)
{
    const struct rad_params *p = &ctx->job->params;
    double whole;

    if (!parent)
        ctx->tree = 0;
    if (!begin(ctx, r, kind, parent, coef, branch))
        return false;
    if (!is_within_limits(p, r))
        return false;
    if (!coef || (r->path & RAD_RAY_SHADOW))
        return true;
    whole = WHOLE_SHARE * r->sample;
    return roulette(r,
                    p->maxdepth > 0 ? whole : rad_most(p->minweight, whole)) &&
           lives_in_tree(ctx, r);
}

bool
rad_ray_go_on(const struct rad_ctx *ctx, struct rad_ray *r)
{
    if (!(r->hit.t < INFINITY) || r->depth >= RAD_MAX_DEPTH)
        return false;
    r->key = rad_key_branch(r->key, RAD_BRANCH_TRANSMIT);
    r->depth++;
    r->kind = RAD_RAY_TRANS;
    r->path |= RAD_RAY_TRANS;
    r->tmax -= r->hit.t;
    r->coef = rad_grey(1);
    r->weight *= medium_weight(r);
    return r->weight > 0 && is_within_limits(&ctx->job->params, r);
}

void
rad_ray_clear(struct rad_ray *r)
{
    r->hit.obj = RAD_VOID;
    r->hit.t = INFINITY;
    r->hit.in = NULL;
    r->hit.bent = false;
    memset(r->hit.way, 0, sizeof r->hit.way);
    r->far_source = -1;
    r->passed_cut = RAD_VOID;
    r->L = rad_grey(0);
    r->L_mirror = rad_grey(0);
    r->dist = INFINITY;
    r->mirror_dist = INFINITY;
}

/* Set r->org: where a ray of direction r->dir leaves its parent's hit. */
static void
leave_parent(struct rad_ray *r)
{
    if (r->parent)
        rad_geom_leave(&r->parent->hit, r->dir, r->org);
}

void
rad_ray_enter(struct rad_ray *r)
{
    rad_copy(r->n, r->hit.n);
    r->cos_o = -rad_dot(r->dir, r->n);
    if (r->hit.bent)
        rad_copy(r->pert, r->hit.bend);
    else
        r->pert[0] = r->pert[1] = r->pert[2] = 0;
    r->pattern = rad_grey(1);
    r->dist = r->hit.t;
}

/* L with negative channels set to 0, as in rpict's pictures; black if a channel
 * is not finite. */
static struct rad_rgb
made_sound(struct rad_rgb L)
{
    L = rad_rgb(L.r < 0 ? 0 : L.r, L.g < 0 ? 0 : L.g, L.b < 0 ? 0 : L.b);
    return rad_rgb_sound(L) ? L : rad_grey(0);
}

/* Make r's radiance sound if it is not, and count that.  A radiance must be
 * finite; one that goes to a pixel or an ambient record must not be negative.
 * A negative radiance may go to another surface, where it lowers the sum, as in
 * rpict. */
static void
drop_unsound(struct rad_ctx *ctx, struct rad_ray *r)
{
    bool last = !r->parent || r->kind & RAD_RAY_AMBIENT;

    if (last ? !rad_rgb_sound(r->L) : !rad_rgb_bounded(r->L)) {
        r->L = made_sound(r->L);
        r->L_mirror =
            rad_rgb_black(r->L) ? rad_grey(0) : made_sound(r->L_mirror);
        ctx->counts.unsound_rays++;
    }
}

void
rad_ray_onward(struct rad_ray *r)
{
    const struct rad_ray *p = r->parent;

    if (p->line && r->dir[0] == p->dir[0] && r->dir[1] == p->dir[1] &&
        r->dir[2] == p->dir[2]) {
        r->line = p->line;
        r->line_at = p->line_at;
    }
}

/* Find what r meets; false: nothing.  If it is not known yet what lies straight
 * ahead (r->line), *own may become r's line. */
static bool
meet(struct rad_ctx *ctx, struct rad_ray *r, struct rad_line *own)
{
    const struct rad_geom *geom = ctx->job->geom;
    struct rad_span span;

    if (r->line) {
        switch (rad_geom_beyond(geom, r->line, r->line_at++, &r->parent->hit,
                                r->org, r->dir, &r->hit)) {
        case RAD_BEYOND_NONE:
            return false;
        case RAD_BEYOND_MET:
            return true;
        default:
            break;
        }
    }
    rad_copy(span.org, r->org);
    rad_copy(span.dir, r->dir);
    span.tmin = 0;
    span.tmax = r->tmax;
    if (!rad_geom_passes(geom))
        return rad_geom_nearest(geom, &span, &r->hit, &ctx->counts.geom);
    r->line = own;
    r->line_at = 1;
    return rad_geom_first(geom, &span, &r->hit, own, &ctx->counts.geom);
}

/* Trace r, in the tree that the context counts. */
static void
trace(struct rad_ctx *ctx, struct rad_ray *r)
{
    struct rad_line own;

    leave_parent(r);
    rad_ray_clear(r);
    ctx->counts.rays++;
    if (!(r->path & RAD_RAY_SHADOW))
        ctx->tree++;
    if (meet(ctx, r, &own)) {
        if (r->source >= 0)
            rad_source_in_plane(ctx, r);
        rad_ray_enter(r);
        rad_ray_continue(ctx, r);
    } else if (!(r->tmax < INFINITY)) { /* else the aft plane hides it */
        int32_t mod = rad_source_behind(ctx, r);

        if (mod != RAD_VOID)
            rad_ray_shade(ctx, r, mod);
    }
    rad_ray_absorb(ctx, r);
    drop_unsound(ctx, r);
    r->line = NULL;
}

void
rad_ray_trace(struct rad_ctx *ctx, struct rad_ray *r)
{
    uint32_t outer = ctx->tree;

    if (!(r->kind & RAD_RAY_AMBIENT) || ctx->walk > 0) {
        trace(ctx, r);
        return;
    }
    ctx->tree = 0;
    trace(ctx, r);
    ctx->tree = outer;
}

void
rad_ray_continue(struct rad_ctx *ctx, struct rad_ray *r)
{
    const struct rad_job *job = ctx->job;
    int32_t mod = job->scene->objects[r->hit.obj].modifier;

    r->kind &= (uint16_t)~RAD_RAY_CUT;
    if ((job->cut && mod != RAD_VOID && job->cut[mod] &&
         rad_antimatter_hides(ctx, r)) ||
        !rad_ray_shade(ctx, r, mod))
        rad_ray_transmit(ctx, r);
}

/* Shade a surface that the eye sees directly with -i: L is its irradiance.
 * Transparent materials let the ray through, emitters are seen as they are. */
static bool
shade_irradiance(struct rad_ctx *ctx, const struct rad_material *mat,
                 struct rad_ray *r)
{
    if (mat->flags & RAD_MAT_TRANSPARENT) {
        rad_ray_transmit(ctx, r);
        return true;
    }
    if (mat->shader->flags & RAD_MAT_EMITS)
        return mat->shader->shade(ctx, mat, r);
    r->pattern = rad_grey(1);
    return rad_normal_irradiance(ctx, r);
}

bool
rad_ray_shade(struct rad_ctx *ctx, struct rad_ray *r, int32_t mod)
{
    const struct rad_job *job = ctx->job;
    bool irradiance = job->params.irradiance &&
                      !(r->path & ~(RAD_RAY_PRIMARY | RAD_RAY_TRANS));

    while (mod != RAD_VOID) {
        const struct rad_material *mat = &job->materials[mod];

        mod = mat->next;
        if (!mat->shader)
            continue;
        if (irradiance &&
            !(mat->shader->flags &
              (RAD_MAT_PATTERN | RAD_MAT_CUTS | RAD_MAT_MIXTURE))) {
            if (shade_irradiance(ctx, mat, r))
                return true;
        } else if (mat->shader->shade(ctx, mat, r)) {
            return true;
        }
    }
    return false;
}

void
rad_ray_transmit(struct rad_ctx *ctx, struct rad_ray *r)
{
    struct rad_ray tr;

    /* not rad_ray_spawn(): -lw and -lr do not apply, since nothing is lost */
    if (!begin(ctx, &tr, RAD_RAY_TRANS, r, NULL, RAD_BRANCH_TRANSMIT))
        return;
    rad_copy(tr.dir, r->dir);
    rad_ray_onward(&tr);
    rad_ray_trace(ctx, &tr);
    r->L = tr.L;
    r->L_mirror = tr.L_mirror;
    r->dist = r->hit.t + tr.dist;
    r->mirror_dist = r->hit.t + tr.mirror_dist;
}

void
rad_ray_absorb(struct rad_ctx *ctx, struct rad_ray *r)
{
    const struct rad_rgb *e = &r->ext;
    double t = r->hit.t;
    struct rad_rgb T;

    if (e->r <= 0 && e->g <= 0 && e->b <= 0)
        return;
    if (r->medium) {
        rad_mist_participate(ctx, r);
        return;
    }
    /* a clear channel is unchanged: exp(-0 * INFINITY) would be NaN */
    T.r = e->r > 0 ? rad_expf(-e->r * t) : 1;
    T.g = e->g == e->r ? T.r : e->g > 0 ? rad_expf(-e->g * t) : 1;
    T.b = e->b == e->g ? T.g : e->b > 0 ? rad_expf(-e->b * t) : 1;
    r->L = rad_rgb_mul(r->L, T);
}

void
rad_ray_texture(struct rad_ctx *ctx, struct rad_ray *r, int32_t mod)
{
    while (mod != RAD_VOID) {
        const struct rad_material *mat = &ctx->job->materials[mod];

        if (mat->shader) {
            if (!(mat->shader->flags & (RAD_MAT_PATTERN | RAD_MAT_MIXTURE)))
                return; /* a second material: rad_scene_check() refuses
                         * surfaces with one */
            mat->shader->shade(ctx, mat, r);
        }
        mod = mat->next;
    }
}

double
rad_ray_normal(const struct rad_ray *r, double norm[3])
{
    double cos_n;

    if (!rad_ray_perturbed(r)) {
        rad_copy(norm, r->n);
        return r->cos_o;
    }
    for (int i = 0; i < 3; i++)
        norm[i] = r->n[i] + r->pert[i];
    if (rad_normalize(norm) == 0) {
        rad_copy(norm, r->n);
        return r->cos_o;
    }
    cos_n = -rad_dot(norm, r->dir);
    if ((cos_n > 0) != (r->cos_o > 0)) {
        /* reflect the normal at the plane perpendicular to the ray, so that
         * the side that is seen is the side that was hit */
        rad_madd(norm, norm, 2 * cos_n, r->dir);
        cos_n = -cos_n;
    }
    return cos_n;
}

bool
rad_ray_bends(const struct rad_ctx *ctx, const struct rad_ray *r)
{
    const struct rad_object *objects = ctx->job->scene->objects;
    int32_t modifier;

    if (!rad_ray_perturbed(r) || r->hit.obj == RAD_VOID)
        return false;
    modifier = objects[r->hit.obj].modifier;
    return modifier == RAD_VOID || strcmp(objects[modifier].name, "Phong") != 0;
}

void
rad_ray_ahead(const struct rad_ctx *ctx, const struct rad_ray *r,
              double ahead[3])
{
    rad_copy(ahead, r->dir);
    if (!rad_ray_bends(ctx, r))
        return;
    rad_sub(ahead, r->dir, r->pert);
    if (!(rad_dot(ahead, r->n) < -RAD_TINY) || rad_normalize(ahead) == 0)
        rad_copy(ahead, r->dir);
}

void
rad_ray_flip(struct rad_ray *r)
{
    rad_scale(r->n, -1, r->n);
    rad_scale(r->pert, -1, r->pert);
    r->cos_o = -r->cos_o;
}

bool
rad_ray_face(struct rad_ctx *ctx, struct rad_ray *r, int32_t mod)
{
    if (r->cos_o < 0 && !ctx->job->params.backvis) {
        rad_ray_transmit(ctx, r);
        return false;
    }
    rad_ray_texture(ctx, r, mod);
    if (r->cos_o < 0)
        rad_ray_flip(r);
    return true;
}

bool
rad_ray_on_flat(const struct rad_ctx *ctx, const struct rad_ray *r)
{
    enum rad_otype type;

    if (r->hit.obj == RAD_VOID)
        return false;
    type = ctx->job->scene->objects[r->hit.obj].type;
    return type == RAD_POLYGON || type == RAD_RING;
}

bool
rad_ray_through(const struct rad_ray *r, const double dir[3])
{
    return (r->cos_o > 0) != (rad_dot(r->n, dir) > 0);
}

/* The effective distance of r: that of the mirrored part if it is more than
 * half of the radiance `whole`. */
static double
effective(const struct rad_ray *r, struct rad_rgb whole)
{
    double d = rad_rgb_lum(r->L_mirror) > .5f * rad_rgb_lum(whole)
                   ? r->mirror_dist
                   : r->dist;

    return d < INFINITY ? d : 1e10;
}

double
rad_ray_distance(const struct rad_ray *r)
{
    return effective(r, r->L);
}

double
rad_ray_way_of(const struct rad_ray *child)
{
    return effective(child, rad_rgb_mul(child->L, child->coef));
}

void
rad_ray_mirror(struct rad_ctx *ctx, struct rad_ray *r, struct rad_ray *child,
               bool clear)
{
    rad_normalize(child->dir);
    rad_ray_trace(ctx, child);
    r->L_mirror = rad_rgb_mul(child->L, child->coef);
    r->L = rad_rgb_add(r->L, r->L_mirror);
    r->mirror_dist = r->hit.t;
    if (clear)
        r->mirror_dist += rad_ray_way_of(child);
}

/* A sensor's place counts as on a surface that is ahead of it by no more than
 * places written with six digits, which are off by 5e-6 of a coordinate, leave
 * open along the normal: above a ground of 1000 km the height counts alone.  Of
 * a scene far from the origin its extent limits that; near the origin a tenth
 * of the extent counts, for the surface is written so, too, unless its numbers
 * are round: no place 2 m above a sphere of radius 1e6 is on it.  It is also
 * less than 1e-4 of the surface's size, for a scene may be much larger than the
 * room that the sensor is in. */
#define WRITTEN    1e-5
#define ON_SURFACE 1e-4

static double
largest(const double p[3])
{
    return rad_most(fabs(p[0]), rad_most(fabs(p[1]), fabs(p[2])));
}

/* How far the numbers of the surface that was hit may be off: by their rounding
 * to six digits, or if they have fewer digits, by what a frozen octree keeps of
 * them.  Of a surface in a copy they are not known. */
static double
left_open(const struct rad_scene *scene, const struct rad_hit *met)
{
    const struct rad_object *o = &scene->objects[met->obj];
    double most = 0;

    if (met->in)
        return INFINITY;
    for (int i = 0; i < o->nreals; i++) {
        double x = fabs(o->reals[i]), off = 0x1p-30 * x, unit = 1;

        while (unit <= x / 1e5)
            unit *= 10;
        while (unit > x / 1e4 && unit > 1e-12)
            unit /= 10;
        if (fabs(x - unit * rint(x / unit)) > off)
            off = WRITTEN * x;
        most = rad_most(most, off);
    }
    return most;
}

/* Move p off the surface that it is on, to the side of n, if it is on one. */
static void
step_off(struct rad_ctx *ctx, const double n[3], double p[3])
{
    const struct rad_geom *geom = ctx->job->geom;
    struct rad_span span = { .tmin = 0 };
    double lo[3], hi[3], all[3], extent, far = largest(p), before;
    struct rad_hit met;

    rad_geom_bounds(geom, lo, hi);
    rad_sub(all, hi, lo);
    extent = sqrt(rad_dot(all, all));
    rad_copy(span.org, p);
    rad_copy(span.dir, n);
    span.tmax = WRITTEN * rad_least(rad_most(rad_dot_sizes(n, p),
                                             rad_dot_sizes(n, all) / 10),
                                    extent);
    if (rad_geom_nearest(geom, &span, &met, &ctx->counts.geom) &&
        met.t < ON_SURFACE * rad_geom_size(geom, &met) &&
        met.t < WRITTEN * far + left_open(ctx->job->scene, &met)) {
        rad_geom_leave(&met, n, p);
        return;
    }
    /* Is a surface at p, or behind p by no more than rounding?  A ray from p
     * itself would not meet the surface that p is exactly on. */
    before = 0x1p-48 * (far + extent);
    rad_madd(span.org, p, before, n);
    rad_scale(span.dir, -1, n);
    if (rad_geom_nearest(geom, &span, &met, &ctx->counts.geom) &&
        fabs(met.t - before) * fabs(rad_dot(met.n, n)) < 2 * met.err)
        rad_geom_leave(&met, n, p);
}

void
rad_ray_place(struct rad_ctx *ctx, struct rad_ray *r, const double p[3],
              const double n[3], uint64_t key)
{
    r->tmax = INFINITY;
    r->key = key;
    rad_ray_spawn(ctx, r, RAD_RAY_PRIMARY, NULL, NULL, 0);
    rad_ray_clear(r);
    rad_scale(r->dir, -1, n);
    rad_copy(r->org, p);
    rad_copy(r->hit.p, p);
    step_off(ctx, n, r->hit.p);
    rad_copy(r->hit.n, n);
    r->hit.t = 0;
    r->hit.err = 0;
    r->hit.uv[0] = r->hit.uv[1] = 0;
    r->hit.bent = false;
    rad_ray_enter(r);
}

void
rad_ray_irradiance(struct rad_ctx *ctx, struct rad_ray *r, const double p[3],
                   const double n[3], uint64_t key)
{
    rad_ray_place(ctx, r, p, n, key);
    rad_normal_irradiance(ctx, r);
    drop_unsound(ctx, r);
}
