/* shadow.c - which light sources a point sees
 *
 * First every sample of every source is weighed: its potential is the light
 * that it would add if nothing were in the way.  Then shadow rays are sent to
 * samples, largest potential first, until the next untested samples together
 * could add less than -dt of the light found so far (Ward 1991; -dc says how
 * many samples are taken together).
 * The untested samples still count.  Radiance guesses their visibility from the
 * hit rate of each source in earlier pixels, so a pixel depends on other
 * pixels.  The visible share of the samples tested at this point depends on no
 * other pixel, but gives too much light where weak sources are hidden more
 * often than strong sources.  So one of the untested samples is drawn, with a
 * probability in proportion to its potential, and tested for all of them
 * (Shirley, Wang & Zimmerman 1996, Monte Carlo techniques for direct lighting
 * calculations): the mean of their sum is right, and its noise within -dt.
 *
 * Rays of indirect light are many, and their light need only have the right
 * mean: for such a ray one sample is drawn from all, but a sample that is most
 * of their sum is tested by itself.
 *
 * A shadow ray stops at the first opaque surface that is found, which need not
 * be the nearest.  If there are transparent surfaces alone, the shadow ray goes
 * from surface to surface as a ray that materials shade; where all of them are
 * plain panes and mirrors, no rays are made (way.h).
 *
 * The shadow ray to an image in a mirror ends at the mirror, whose shader sends
 * a ray on toward the source (rad_source_aimed).  Each stretch of the way is
 * tested by itself.  */
#include "config.h"

#include "light/direct/way.h"
#include "base/rng.h"
#include "base/vec.h"
#include "trace/asks.h"

#include <string.h>

/* So many shadow rays are sent whatever -dt says, as in rpict. */
#define MIN_TESTS 2

/* At hits of hemispheres' rays sources are cut into parts so many times as
 * large as -ds says.  Of all parts only one or two are tested there (APART),
 * and each part costs time: the radiance of an illum, for example, is a
 * function.  The mean light of unobstructed parts is right at any size.  With
 * -dj 0 the size stays: a shadow ray aims at the middle of its part, so larger
 * parts would shift the shadows. */
#define COARSER 2

/* Where one sample is drawn from all, a sample of more than this part of the
 * sum is tested by itself.  Else a strong source that is hidden, like the sun
 * from most of a room, would be drawn nearly always; and a weak source, when it
 * is drawn at last, would count for many times its own light. */
#define APART .5

/* A sample of a source, and the light that it would add. */
struct potential {
    struct rad_span span; /* of the shadow ray; ends short of the source */
    struct rad_rgb coef;  /* factor of the source's radiance (rad_brdf_fn) */
    struct rad_rgb val;   /* coef times radiance: the light if unobstructed */
    int32_t source;       /* number of a source or image */
    uint32_t branch;      /* of the shadow ray's key */
    /* the way from the prism that shows the source: where that is clear val is
     * what arrives; NULL: only a ray can tell */
    const struct rad_span *beyond;
};

/* An entry of the list that says in which order potentials are tested. */
struct order {
    float lum; /* luminance of the potential's val */
    int32_t i; /* index of the potential */
};

/* Where shadow rays to the lamp start, on one side of the surface that is hit.
 */
struct start {
    bool left;  /* org is set: it is the same for all lamps */
    bool known; /* the other fields are set */
    double org[3];
    double height; /* above the plane of a flat lamp, and above what is flush
                    * with it */
    double round;  /* bound of the rounding error of height */
};

struct direct {
    struct rad_ctx *ctx;
    struct rad_ray *r;
    rad_brdf_fn *brdf;
    void *data;
    int32_t source;    /* the source or image whose samples are weighed */
    uint32_t nsamples; /* samples of all sources so far, weighed or not */
    /* the source whose samples are weighed, if it is flat or a sphere and has
     * the same radiance everywhere, so that the place where a shadow ray meets
     * it need not be known; else NULL */
    const struct rad_source *lamp;
    struct start start[2]; /* above and below the surface (along hit.n) */
    struct potential *list;
    int32_t n, capacity;
};

/* Initialize *d with no sample weighed.  Field by field, since clearing all of
 * *d would take longer than most of the work that follows. */
static void
begin(struct direct *d, struct rad_ctx *ctx, struct rad_ray *r,
      rad_brdf_fn *brdf, void *data)
{
    d->ctx = ctx;
    d->r = r;
    d->brdf = brdf;
    d->data = data;
    d->nsamples = 0;
    d->start[0].left = d->start[1].left = false;
    d->list = NULL;
    d->n = d->capacity = 0;
}

/* Make room for one more potential; false: out of memory, and the sample is
 * lost. */
static bool
reserve(struct direct *d)
{
    struct potential *more;
    int32_t cap;

    if (d->n < d->capacity)
        return true;
    cap = d->capacity ? 2 * d->capacity : 64;
    more = rad_arena_alloc(&d->ctx->scratch, (size_t)cap * sizeof *more);
    if (!more)
        return false;
    if (d->n > 0)
        memcpy(more, d->list, (size_t)d->n * sizeof *more);
    d->list = more;
    d->capacity = cap;
    return true;
}

/* Make *sr a shadow ray along p's span, not yet traced.  False: the path is too
 * deep. */
static bool
start_ray(const struct direct *d, const struct potential *p, struct rad_ray *sr)
{
    enum rad_raykind kind =
        rad_ray_through(d->r, p->span.dir) ? RAD_RAY_TSHADOW : RAD_RAY_RSHADOW;

    if (!rad_ray_spawn(d->ctx, sr, kind, d->r, &p->coef, p->branch))
        return false;
    rad_copy(sr->org, p->span.org);
    rad_copy(sr->dir, p->span.dir);
    sr->source = p->source;
    sr->tmax = INFINITY;
    rad_ray_clear(sr);
    return true;
}

/* Where shadow rays to d->lamp in direction dir start. */
static const struct start *
start_of(struct direct *d, const double dir[3])
{
    const struct rad_hit *from = &d->r->hit;
    const struct rad_source *lamp = d->lamp;
    struct start *s = &d->start[signbit(rad_dot(from->n, dir)) != 0];
    double to[3];

    if (s->known)
        return s;
    s->known = true;
    if (!s->left)
        rad_geom_leave(from, dir, s->org);
    s->left = true;
    rad_sub(to, s->org, lamp->centre);
    s->height = rad_dot(to, lamp->normal);
    s->height -= rad_flush_gap(lamp->centre, lamp->normal, s->height);
    s->round =
        RAD_LIGHT_ROUNDING *
        (rad_largest(s->org) + rad_largest(lamp->centre) + rad_largest(to));
    return s;
}

/* The distance to a spherical lamp in direction dir, less the rounding errors
 * of the lamp and of another surface that touches the lamp.  Not positive: the
 * lamp is missed. */
static double
reach_sphere(const struct rad_source *lamp, const struct start *s,
             const double dir[3])
{
    double to[3], aside[3], along, deep;

    rad_sub(to, lamp->centre, s->org);
    along = rad_dot(to, dir);
    rad_madd(aside, to, -along, dir);
    deep = lamp->r1 * lamp->r1 - rad_dot(aside, aside);
    if (!(deep > 0))
        return 0;
    deep = sqrt(deep); /* r1 times the cosine to the surface */
    return along - deep - s->round * lamp->r1 / deep;
}

/* Set p's span as rad_way_aim() does, where it goes to d->lamp.  False: the
 * lamp is missed. */
static bool
meet_lamp(struct direct *d, struct potential *p, const double dir[3])
{
    const struct start *s = start_of(d, dir);

    rad_copy(p->span.org, s->org);
    rad_copy(p->span.dir, dir);
    p->span.tmin = 0;
    p->span.tmax = d->lamp->flags & RAD_LIGHT_FLAT
                       ? (s->height - s->round) / -rad_dot(d->lamp->normal, dir)
                       : reach_sphere(d->lamp, s, dir);
    return p->span.tmax > 0;
}

/* The source, if it is flat or a sphere and has the same radiance everywhere;
 * else NULL. */
static const struct rad_source *
plain_lamp(const struct rad_sources *s, int32_t source)
{
    const struct rad_source *src;

    if (source >= s->n)
        return NULL;
    src = &s->list[source];
    return src->flags & RAD_LIGHT_PLAIN &&
                   (src->flags & RAD_LIGHT_FLAT || src->shape == RAD_SPHERE)
               ? src
               : NULL;
}

/* Note the source or image whose samples are weighed next. */
static void
turn_to(struct direct *d, int32_t source)
{
    d->source = source;
    d->lamp = plain_lamp(d->ctx->job->sources, source);
    d->start[0].known = d->start[1].known = false;
}

/* Shade a shadow ray that meets its target (source or mirror) at hit; the way
 * there is taken to be clear. */
static void
shade_target(struct rad_ctx *ctx, struct rad_ray *sr, const struct rad_hit *hit)
{
    const struct rad_job *job = ctx->job;

    if (rad_source_distant(job->sources, sr->source)) {
        int32_t mod = rad_source_behind(ctx, sr);

        if (mod != RAD_VOID)
            rad_ray_shade(ctx, sr, mod);
    } else {
        sr->hit = *hit;
        rad_ray_enter(sr);
        rad_ray_shade(ctx, sr, job->scene->objects[hit->obj].modifier);
    }
    rad_ray_absorb(ctx, sr);
}

/* Does the point lie in mist other than -me, or in a dielectric? */
static bool
is_in_mist(const struct direct *d)
{
    const struct rad_job *job = d->ctx->job;
    struct rad_rgb ext = d->r->ext, endless = job->params.cextinction;

    return d->r->medium != job->medium || ext.r != endless.r ||
           ext.g != endless.g || ext.b != endless.b;
}

/* The radiance that arrives along p's span from its source or image, which is
 * met at hit, if nothing is in the way but the endless mist of -me.  Where the
 * point lies in other mist, which may end on the way, none of it dims: no less
 * arrives than this says, so that the sun is seen from within a cloud. */
static struct rad_rgb
source_radiance(const struct direct *d, const struct potential *p,
                const struct rad_hit *hit)
{
    const struct rad_sources *s = d->ctx->job->sources;
    const struct rad_job *job = d->ctx->job;
    const struct rad_source *src = NULL;
    struct rad_ray sr;

    if (p->source < s->n && s->list[p->source].flags & RAD_LIGHT_PLAIN)
        src = &s->list[p->source];
    if (rad_rgb_black(d->r->ext)) {
        const struct rad_virtual *v = rad_source_virtual(s, p->source);

        if (src)
            return src->L;
        if (v && v->plain)
            return rad_way_leads(d->ctx, v, p->span.dir, hit) ? v->L
                                                              : rad_grey(0);
    }
    if (src && is_in_mist(d))
        return src->L;
    if (src)
        return rad_rgb_mul(src->L, rad_mist_veil(d->ctx, job->medium,
                                                 job->params.cextinction,
                                                 p->span.tmax));
    if (!start_ray(d, p, &sr))
        return rad_grey(0);
    sr.path |= RAD_RAY_UNTESTED;
    if (is_in_mist(d)) {
        sr.ext = rad_grey(0);
        sr.medium = NULL;
    }
    shade_target(d->ctx, &sr, hit);
    return sr.L;
}

/* Does a shadow ray with radiance L bring light?  As in Radiance the mean of
 * the channels decides: materials on the way may make one of them negative. */
static bool
arrives(struct rad_rgb L)
{
    return L.r + L.g + L.b > 0;
}

/* As source_radiance(); also set p->beyond, for a ray that goes through a prism
 * is dear: functions say where. */
static struct rad_rgb
radiance_by_prism(const struct direct *d, struct potential *p,
                  const struct rad_hit *hit)
{
    struct rad_ctx *ctx = d->ctx;
    struct rad_span *beyond = rad_arena_alloc(&ctx->scratch, sizeof *beyond);
    struct rad_rgb L;

    if (beyond)
        beyond->tmax = 0;
    ctx->relayed = beyond;
    L = source_radiance(d, p, hit);
    ctx->relayed = NULL;
    if (beyond && beyond->tmax > 0 && arrives(L))
        p->beyond = beyond;
    return L;
}

/* Is p's source an image in one prism, and not seen through mist? */
static bool
is_bent_once(const struct direct *d, const struct potential *p)
{
    const struct rad_sources *s = d->ctx->job->sources;
    const struct rad_virtual *v = rad_source_virtual(s, p->source);

    return v && v->bend && v->from < s->n && !is_in_mist(d);
}

/* rad_light_fn: add the sample to the list, unless it has no light. */
static void
weigh(void *arg, const struct rad_light_sample *s)
{
    struct direct *d = arg;
    struct rad_hit hit;
    struct potential *p;
    struct rad_rgb L;
    uint32_t branch = RAD_BRANCH_SHADOW + d->nsamples++;

    if (!reserve(d))
        return;
    p = &d->list[d->n];
    d->brdf(&p->coef, d->data, s->dir, s->omega);
    if (rad_rgb_black(p->coef))
        return;
    p->source = d->source;
    p->branch = branch;
    if (!(d->lamp ? meet_lamp(d, p, s->aim)
                  : rad_way_aim(d->ctx, &d->r->hit, p->source, s->aim, &p->span,
                                &hit)))
        return;
    p->beyond = NULL;
    L = is_bent_once(d, p) ? radiance_by_prism(d, p, &hit)
                           : source_radiance(d, p, &hit);
    p->val = rad_rgb_mul(L, p->coef);
    if (rad_rgb_lum(p->val) > 0)
        d->n++;
}

/* Is the light of p, where nothing is in the way, known without a ray?  Yes, if
 * its source has one radiance, its mirrors have one colour each, and the point
 * does not lie in mist. */
static bool
is_plain(const struct direct *d, const struct potential *p)
{
    const struct rad_sources *s = d->ctx->job->sources;

    return rad_rgb_black(d->r->ext) &&
           (p->source < s->n ? s->list[p->source].flags & RAD_LIGHT_PLAIN
                             : s->virtuals[p->source - s->n].plain);
}

/* Set p->val to the light that comes from p's target, met at hit; false: none
 * does. */
static bool
take_light(const struct direct *d, struct potential *p,
           const struct rad_hit *hit)
{
    struct rad_ray sr;

    if (!start_ray(d, p, &sr))
        return false;
    shade_target(d->ctx, &sr, hit);
    p->val = rad_rgb_mul(sr.L, p->coef);
    return arrives(sr.L);
}

/* Is the way from p's prism to the source clear?  VEILED: only a ray can tell.
 */
static enum rad_sight
look_beyond(const struct direct *d, const struct potential *p)
{
    struct rad_ctx *ctx = d->ctx;
    const struct rad_sources *s = ctx->job->sources;
    int32_t from = s->virtuals[p->source - s->n].from;
    struct rad_line line;
    struct rad_hit hit;
    enum rad_sight seen = rad_geom_sight(
        ctx->job->geom, p->beyond, rad_source_target(s, from),
        &ctx->last_blocker[from], &hit, &line, &ctx->counts.geom);

    if (seen != RAD_SIGHT_VEILED) {
        ctx->counts.rays++;
        ctx->counts.shadow_rays++;
    }
    return seen;
}

/* The way to the mirror that shows p's image is clear: is it clear from there
 * to the source?  Sets p->val to the light that arrives; false: none does. */
static bool
see_in_mirror(const struct direct *d, struct potential *p)
{
    const struct rad_sources *s = d->ctx->job->sources;
    const struct rad_virtual *v = &s->virtuals[p->source - s->n];
    struct rad_span span;
    struct rad_hit hit;

    if (v->sure && !is_in_mist(d))
        return true;
    if (p->beyond) {
        enum rad_sight seen = look_beyond(d, p);

        if (seen != RAD_SIGHT_VEILED)
            return seen == RAD_SIGHT_CLEAR;
    }
    if (!rad_way_aim(d->ctx, &d->r->hit, p->source, p->span.dir, &span, &hit))
        return false;
    if (is_plain(d, p)) {
        enum rad_sight seen =
            rad_way_clear(d->ctx, v, p->span.dir, &hit, &p->val);

        if (seen != RAD_SIGHT_VEILED)
            return seen == RAD_SIGHT_CLEAR;
    }
    return take_light(d, p, &hit);
}

/* The way to p's source is clear, and all of it in the mist that the point lies
 * in: does light arrive?  Sets p->val to it. */
static bool
see_in_mist(const struct direct *d, struct potential *p)
{
    const struct rad_ray *r = d->r;
    const struct rad_source *src = &d->ctx->job->sources->list[p->source];
    struct rad_rgb L;
    struct rad_span span;
    struct rad_hit hit;

    if (!(src->flags & RAD_LIGHT_PLAIN))
        return rad_way_aim(d->ctx, &r->hit, p->source, p->span.dir, &span,
                           &hit) &&
               take_light(d, p, &hit);
    L = rad_rgb_mul(src->L,
                    rad_mist_veil(d->ctx, r->medium, r->ext, p->span.tmax));
    p->val = rad_rgb_mul(L, p->coef);
    return arrives(L);
}

/* The way to p's target is clear: does its light arrive? */
static bool
see_beyond(const struct direct *d, struct potential *p)
{
    if (p->source >= d->ctx->job->sources->n)
        return see_in_mirror(d, p);
    return !is_in_mist(d) || see_in_mist(d, p);
}

/* Let a shadow ray go through the surfaces on its way (the first at hit, all on
 * line) and on to its source. */
static void
go_through(struct rad_ctx *ctx, struct rad_ray *sr, const struct rad_hit *hit,
           const struct rad_line *line)
{
    sr->hit = *hit;
    sr->line = line;
    sr->line_at = 1;
    rad_ray_enter(sr);
    rad_ray_continue(ctx, sr);
    rad_ray_absorb(ctx, sr);
    sr->line = NULL;
}

/* Follow the shadow ray of p through transparent surfaces, the first at hit.
 * Sets p->val to the light that arrives; false: none does. */
static bool
see_through(const struct direct *d, struct potential *p,
            const struct rad_hit *hit, const struct rad_line *line)
{
    const struct rad_job *job = d->ctx->job;
    const struct rad_source *lamp = plain_lamp(job->sources, p->source);
    int32_t target = rad_source_target(job->sources, p->source);
    struct rad_rgb T;
    struct rad_ray sr;

    if (hit->obj == target)
        return see_beyond(d, p);
    if (is_plain(d, p)) {
        enum rad_sight seen =
            rad_way_through(d->ctx, p->source, &p->span, hit, line, &p->val);

        if (seen != RAD_SIGHT_VEILED)
            return seen == RAD_SIGHT_CLEAR;
    }
    /* if there is nothing but mist before the lamp, no ray is needed */
    if (lamp && line->n > 0 &&
        rad_geom_ahead(job->geom, line, line->n - 1) == target &&
        rad_mist_veils(d->ctx, d->r, &p->span, line, &T)) {
        p->val = rad_rgb_mul(rad_rgb_mul(lamp->L, T), p->coef);
        return rad_rgb_lum(p->val) > 0;
    }
    if (!start_ray(d, p, &sr))
        return false;
    go_through(d->ctx, &sr, hit, line);
    p->val = rad_rgb_mul(sr.L, p->coef);
    return arrives(sr.L);
}

/* Send p's shadow ray.  Sets p->val to the light that arrives; false: none
 * does. */
static bool
test(const struct direct *d, struct potential *p)
{
    struct rad_ctx *ctx = d->ctx;
    const struct rad_job *job = ctx->job;
    struct rad_line line;
    struct rad_hit hit;

    ctx->counts.rays++;
    ctx->counts.shadow_rays++;
    switch (rad_geom_sight(
        job->geom, &p->span, rad_source_target(job->sources, p->source),
        &ctx->last_blocker[p->source], &hit, &line, &ctx->counts.geom)) {
    case RAD_SIGHT_BLOCKED:
        return false;
    case RAD_SIGHT_VEILED:
        return see_through(d, p, &hit, &line);
    default:
        return see_beyond(d, p);
    }
}

/* Is r's way to its target, along the span, clear?  If not, r gets the light
 * that comes through the surfaces in the way. */
static bool
is_clear(struct rad_ctx *ctx, struct rad_ray *r, const struct rad_span *span)
{
    const struct rad_job *job = ctx->job;
    int32_t target = rad_source_target(job->sources, r->source);
    struct rad_line line;
    struct rad_hit hit;

    ctx->counts.rays++;
    ctx->counts.shadow_rays++;
    switch (rad_geom_sight(job->geom, span, target,
                           &ctx->last_blocker[r->source], &hit, &line,
                           &ctx->counts.geom)) {
    case RAD_SIGHT_BLOCKED:
        return false;
    case RAD_SIGHT_VEILED:
        if (hit.obj == target)
            return true;
        go_through(ctx, r, &hit, &line);
        return false;
    default:
        return true;
    }
}

void
rad_source_aimed(struct rad_ctx *ctx, struct rad_ray *r)
{
    struct rad_span span;
    struct rad_hit hit;

    rad_ray_clear(r);
    if (!rad_way_faces(ctx->job->sources, r->source, &r->parent->hit) ||
        !rad_way_aim(ctx, &r->parent->hit, r->source, r->dir, &span, &hit))
        return;
    rad_copy(r->org, span.org);
    if (r->path & RAD_RAY_UNTESTED && ctx->relayed)
        *ctx->relayed = span;
    if (r->path & RAD_RAY_UNTESTED || is_clear(ctx, r, &span))
        shade_target(ctx, r, &hit);
}

/* Is a tested before b?  The larger luminance comes first; of equal luminances
 * the sample that was weighed first, so that there is only one order. */
static bool
before(const struct order *a, const struct order *b)
{
    return a->lum != b->lum ? a->lum > b->lum : a->i < b->i;
}

static void
sift(struct order *o, int32_t root, int32_t n)
{
    struct order top = o[root];

    for (int32_t k; (k = 2 * root + 1) < n; root = k) {
        if (k + 1 < n && before(&o[k], &o[k + 1]))
            k++;
        if (!before(&top, &o[k]))
            break;
        o[root] = o[k];
    }
    o[root] = top;
}

/* Heap sort: in place, and never quadratic. */
static void
sort(struct order *o, int32_t n)
{
    for (int32_t i = n / 2; i-- > 0;)
        sift(o, i, n);
    for (int32_t i = n - 1; i > 0; i--) {
        struct order t = o[0];

        o[0] = o[i];
        o[i] = t;
        sift(o, 0, i);
    }
}

static void
add_if_seen(struct direct *d, struct potential *p)
{
    if (test(d, p))
        d->r->L = rad_rgb_add(d->r->L, p->val);
}

/* Test every sample (-dt 0), in any order. */
static void
test_all(struct direct *d)
{
    for (int32_t i = 0; i < d->n; i++)
        add_if_seen(d, &d->list[i]);
}

/* Returns the sum of the samples' luminances; *brightest is the index of the
 * largest. */
static double
sum_up(const struct direct *d, int32_t *brightest)
{
    double all = 0, most = -1;

    for (int32_t i = 0; i < d->n; i++) {
        double lum = rad_rgb_lum(d->list[i].val);

        all += lum;
        if (lum > most) {
            most = lum;
            *brightest = i;
        }
    }
    return all;
}

/* If a sample is most of the sum, test it by itself and take it off the list.
 * Returns the sum of the samples on the list. */
static double
test_apart(struct direct *d)
{
    int32_t i = 0;
    double all = sum_up(d, &i);

    if (!(d->n > 1 && rad_rgb_lum(d->list[i].val) > APART * all))
        return all;
    add_if_seen(d, &d->list[i]);
    d->list[i] = d->list[--d->n];
    return sum_up(d, &i);
}

/* Test one sample that is drawn, for all samples but the one that is tested
 * apart. */
static void
test_drawn(struct direct *d)
{
    double all = test_apart(d), at, lum = 0;
    struct potential *p = d->list;

    at = all * rad_rand(d->r->key, RAD_DIM_SOURCE);
    /* where rounding leaves at >= 0 to the end the last sample is drawn */
    for (int32_t i = 0; i < d->n && at >= 0; i++) {
        p = &d->list[i];
        lum = rad_rgb_lum(p->val);
        at -= lum;
    }
    if (test(d, p))
        d->r->L = rad_rgb_add(d->r->L, rad_rgb_scale(p->val, all / lum));
}

/* The part, by channel, of light a that arrives as b; 1 at most. */
static struct rad_rgb
part_left(struct rad_rgb a, struct rad_rgb b)
{
    float all = fminf(rad_rgb_lum(b) / rad_rgb_lum(a), 1);

    return rad_rgb(a.r > 0 ? fminf(b.r / a.r, 1) : all,
                   a.g > 0 ? fminf(b.g / a.g, 1) : all,
                   a.b > 0 ? fminf(b.b / a.b, 1) : all);
}

/* Draw and test one of the n samples that begin at *o; `all` is the sum of
 * their luminances.  The part of its light that arrives is taken for the part
 * of each sample's, so where all are visible there is no noise. */
static void
test_rest(struct direct *d, const struct order *o, int32_t n, double all)
{
    double at = all * rad_rand(d->r->key, RAD_DIM_SOURCE);
    struct rad_rgb sum = { 0, 0, 0 }, was;
    struct potential *p = &d->list[o->i]; /* drawn if `all` is infinite */

    for (int32_t i = 0; i < n; i++) {
        struct potential *q = &d->list[o[i].i];

        if (at >= 0)
            p = q;
        at -= o[i].lum;
        sum = rad_rgb_add(sum, q->val);
    }
    was = p->val;
    if (test(d, p))
        d->r->L =
            rad_rgb_add(d->r->L, rad_rgb_mul(sum, part_left(was, p->val)));
}

/* Test samples, largest first, until -dt allows to stop; then one sample drawn
 * from the rest.  o has room for all samples. */
static void
test_selected(struct direct *d, struct order *o)
{
    const struct rad_params *par = &d->ctx->job->params;
    int32_t k, ahead = d->n < RAD_FEW_SAMPLES
                           ? d->ctx->job->sources->share[d->n]
                           : rad_share_of(d->n, par->shadcert);
    double thresh = par->shadthresh / d->r->weight;
    float *rest; /* luminance of o[k] and all after it */

    rest = rad_arena_alloc(&d->ctx->scratch, (size_t)d->n * sizeof *rest);
    if (!rest) {
        test_all(d);
        return;
    }
    for (int32_t i = 0; i < d->n; i++)
        o[i] = (struct order){ rad_rgb_lum(d->list[i].val), i };
    sort(o, d->n);
    for (int32_t i = d->n; i-- > 0;)
        rest[i] = o[i].lum + (i + 1 < d->n ? rest[i + 1] : 0);
    for (k = 0; k < d->n; k++) {
        struct potential *p = &d->list[o[k].i];
        float next = rest[k] - (k + ahead < d->n ? rest[k + ahead] : 0);

        if (k >= MIN_TESTS && next < thresh * rad_rgb_lum(d->r->L))
            break;
        if (test(d, p))
            d->r->L = rad_rgb_add(d->r->L, p->val);
    }
    if (k < d->n)
        test_rest(d, o + k, d->n - k, rest[k]);
}

/* The height of a source's (or its image's) centre above the plane of r's hit,
 * on r's side.  If the height is below minus the radius the source is out of
 * sight. */
static double
height_of(const struct rad_source *src, const double centre[3],
          const struct rad_ray *r)
{
    double side = r->cos_o < 0 ? -1 : 1, d[3];

    if (src->flags & RAD_LIGHT_DISTANT)
        return side * rad_dot(centre, r->n);
    rad_sub(d, centre, r->hit.p);
    return side * rad_dot(d, r->n);
}

/* The key of the random numbers for samples of a source or image; 0 without
 * jitter, which needs none. */
static uint64_t
sample_key(const struct rad_ray *r, const struct rad_light_view *view,
           int32_t source)
{
    /* rays' branch numbers have 32 bits, dimensions of random numbers bit 63 */
    return view->jitter > 0
               ? rad_key_branch(r->key, (uint64_t)(source + 1) << 32)
               : 0;
}

/* Weigh the samples of all sources; skip: without sources below the horizon. */
static void
weigh_sources(struct direct *d, struct rad_light_view *view, bool skip)
{
    const struct rad_sources *s = d->ctx->job->sources;
    const struct rad_ray *r = d->r;
    double up[3];

    rad_scale(up, r->cos_o < 0 ? -1 : 1, r->n);
    for (int32_t i = 0; i < s->n; i++) {
        const struct rad_source *src = &s->list[i];
        double height = INFINITY;

        if (src->flags & RAD_LIGHT_SKIP)
            continue;
        if (skip && (height = height_of(src, src->centre, r)) < -src->radius)
            continue;
        view->up = height < src->radius ? up : NULL;
        view->key = sample_key(r, view, i);
        turn_to(d, i);
        rad_light_samples(src, view, weigh, d);
    }
    view->up = NULL;
}

/* Weigh the samples of all images; skip: without images below the horizon. */
static void
weigh_images(struct direct *d, struct rad_light_view *view, bool skip)
{
    const struct rad_sources *s = d->ctx->job->sources;

    for (int32_t i = 0; i < s->nvirtuals; i++) {
        const struct rad_virtual *v = &s->virtuals[i];

        if (!rad_virtual_faces(v, view->p, d->r->hit.err) ||
            !rad_virtual_shows(s, v, view->p) ||
            (skip && !v->bend &&
             height_of(&s->list[v->root], v->image, d->r) <
                 -s->list[v->root].radius))
            continue;
        turn_to(d, s->n + i);
        view->key = sample_key(d->r, view, d->source);
        rad_virtual_samples(s, v, view, weigh, d);
    }
}

void
rad_direct(struct rad_ctx *ctx, struct rad_ray *r, rad_brdf_fn *brdf,
           void *data, bool through)
{
    const struct rad_sources *s = ctx->job->sources;
    const struct rad_params *par = &ctx->job->params;
    struct rad_light_view view = { .jitter = par->srcjitter };
    struct rad_arena_mark mark;
    struct direct d;
    struct order *o;
    /* a normal tilted by a texture may face sources below the horizon */
    bool skip = !through && !rad_ray_perturbed(r), drawn;

    if (s->nlit == 0 || ctx->no_direct)
        return;
    begin(&d, ctx, r, brdf, data);
    mark = rad_arena_mark(&ctx->scratch);
    rad_copy(view.p, r->hit.p);
    view.sizerat = par->srcsizerat / r->weight;
    if (r->path & RAD_RAY_AMBIENT && view.jitter > 0)
        view.sizerat *= COARSER;
    weigh_sources(&d, &view, skip);
    weigh_images(&d, &view, skip);
    o = NULL;
    drawn = d.n > 1 && par->shadthresh > 0 && r->path & RAD_RAY_AMBIENT;
    if (d.n > 0 && par->shadthresh > 0 && !drawn)
        o = rad_arena_alloc(&ctx->scratch, (size_t)d.n * sizeof *o);
    if (drawn)
        test_drawn(&d);
    else if (o)
        test_selected(&d, o);
    else
        test_all(&d);
    rad_arena_rewind(&ctx->scratch, mark);
}

void
rad_direct_from(struct rad_ctx *ctx, struct rad_ray *r, int32_t source,
                rad_brdf_fn *brdf, void *data)
{
    const struct rad_sources *s = ctx->job->sources;
    const struct rad_virtual *v = rad_source_virtual(s, source);
    struct rad_light_view view = { .jitter = ctx->job->params.srcjitter };
    struct rad_arena_mark mark;
    struct direct d;

    if (rad_source_root(s, source)->flags & RAD_LIGHT_SKIP || ctx->no_direct)
        return;
    begin(&d, ctx, r, brdf, data);
    mark = rad_arena_mark(&ctx->scratch);
    rad_copy(view.p, r->hit.p);
    view.key = sample_key(r, &view, source);
    turn_to(&d, source);
    if (!v)
        rad_light_samples_within(&s->list[source], &view, weigh, &d);
    else if (rad_virtual_faces(v, view.p, r->hit.err))
        rad_virtual_samples(s, v, &view, weigh, &d);
    test_all(&d);
    rad_arena_rewind(&ctx->scratch, mark);
}
