/* shadow.c - which light sources a point sees
 *
 * First every sample of every source is weighed: what would it add if nothing
 * were in the way?  Then shadow rays are sent in order of that potential, until
 * what the untested ones could add is below -dt of what was found (Ward 1991;
 * -dc says how many of them are looked at together).
 * What is untested still counts.  Radiance takes its visibility from the hit
 * rates of each source so far, so one pixel's luck colours the next.  The
 * visible share of what was tested at this very point would leave a pixel a
 * function, but is too bright where what is weak is hidden more often than what
 * is strong.  So one of the samples left is drawn, as likely as its part in the
 * sum of their potentials, and tested for all of them (Shirley, Wang &
 * Zimmerman 1996, Monte Carlo techniques for direct lighting calculations):
 * their sum is right in the mean, and its noise within -dt.
 *
 * Rays of indirect light are many, and what each says need be right in the mean
 * only: there one sample is drawn from all, but for one that is most of their
 * sum.
 *
 * A shadow ray stops at the first opaque thing it finds, whichever that is.
 * Only if there is none, but something to see through, does it go on, from
 * surface to surface, as a ray that materials shade; no rays are made for what
 * are plain panes and mirrors alone (way.h).
 *
 * The ray to an image in a mirror ends at the mirror, which shows it what is at
 * the end of the way (rad_source_aimed).  It is tested stretch by stretch.  */
#include "config.h"

#include "light/direct/way.h"
#include "base/rng.h"
#include "base/vec.h"
#include "trace/asks.h"

#include <string.h>

/* Shadow rays sent whatever -dt says, as in rpict. */
#define MIN_TESTS 2

/* For rays of hemispheres sources are cut into parts so many times as large as
 * -ds says.  One of them is tested, whatever they are; unobstructed their light
 * is exact, and its colours may take long: those of an illum are a function.
 * Not without -dj: then what stands before a source is seen by the middle of a
 * part alone, and larger parts would be another picture. */
#define COARSER 2

/* Where one sample is drawn from all, one that is more than this part of the
 * sum is tested by itself: so strong a source that cannot be seen, like the sun
 * from most of a room, would be drawn nearly always, and what is left, at last
 * drawn once, would count for many times what it is. */
#define APART .5

struct potential {
    struct rad_span span; /* of the shadow ray, which ends short of the
                           * source */
    struct rad_rgb coef;  /* of the source's radiance */
    struct rad_rgb val;   /* coef times radiance, if all of it is seen */
    int32_t source;
    uint32_t branch; /* of the shadow ray */
};

/* The order of testing; and, from the end, what is still to come. */
struct order {
    float lum; /* of val */
    int32_t i; /* index of the potential */
};

/* Where shadow rays start to one side of the hit. */
struct start {
    bool known;
    double org[3];
    double height; /* above the lamp's plane: of flat ones */
    double round;  /* bound of what rounding does to that */
};

struct direct {
    struct rad_ctx *ctx;
    struct rad_ray *r;
    rad_brdf_fn *brdf;
    void *data;
    int32_t source;    /* whose samples are being weighed */
    uint32_t nsamples; /* so far, weighed or not */
    /* that source, if nothing of the place aimed at need be known */
    const struct rad_source *lamp;
    struct start start[2]; /* for directions above and below the hit */
    struct potential *list;
    int32_t n, capacity;
};

/* Nothing is weighed yet.  (Clearing all of *d would take longer than most of
 * what follows.) */
static void
begin(struct direct *d, struct rad_ctx *ctx, struct rad_ray *r,
      rad_brdf_fn *brdf, void *data)
{
    d->ctx = ctx;
    d->r = r;
    d->brdf = brdf;
    d->data = data;
    d->nsamples = 0;
    d->list = NULL;
    d->n = d->capacity = 0;
}

/* Room for one more; false: out of memory, and the sample is lost. */
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

/* A ray along p's span, not yet traced.  False: the path is too deep. */
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

/* How shadow rays start in direction dir. */
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
    rad_geom_leave(from, dir, s->org);
    rad_sub(to, s->org, lamp->centre);
    s->height = rad_dot(to, lamp->normal);
    s->round =
        RAD_LIGHT_ROUNDING *
        (rad_largest(s->org) + rad_largest(lamp->centre) + rad_largest(to));
    return s;
}

/* How far is a sphere in direction dir, less what rounding may do to that and
 * to another surface on it?  Not positive: it is missed. */
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

/* rad_way_aim() for p's span, if it goes to d's lamp. */
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

/* The source, if it is flat or a sphere and looks the same all over; else
 * NULL. */
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

/* The source whose samples are weighed next. */
static void
turn_to(struct direct *d, int32_t source)
{
    d->source = source;
    d->lamp = plain_lamp(d->ctx->job->sources, source);
    d->start[0].known = d->start[1].known = false;
}

/* Shade a ray that nothing has stopped on its way to its source, which it meets
 * at hit. */
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

/* What the source, met at hit, sends along p's span. */
static struct rad_rgb
source_radiance(const struct direct *d, const struct potential *p,
                const struct rad_hit *hit)
{
    const struct rad_sources *s = d->ctx->job->sources;
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
    if (src)
        return rad_rgb_mul(src->L, rad_mist_veil(d->ctx, d->r, p->span.tmax));
    if (!start_ray(d, p, &sr))
        return rad_grey(0);
    sr.path |= RAD_RAY_UNTESTED;
    shade_target(d->ctx, &sr, hit);
    return sr.L;
}

/* rad_light_fn */
static void
weigh(void *arg, const struct rad_light_sample *s)
{
    struct direct *d = arg;
    struct rad_hit hit;
    struct potential *p;
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
    p->val = rad_rgb_mul(source_radiance(d, p, &hit), p->coef);
    if (rad_rgb_lum(p->val) > 0)
        d->n++;
}

/* Is nothing but products of colours between p's source and where it is seen
 * from, if that is clear? */
static bool
is_plain(const struct direct *d, const struct potential *p)
{
    const struct rad_sources *s = d->ctx->job->sources;

    return rad_rgb_black(d->r->ext) &&
           (p->source < s->n ? s->list[p->source].flags & RAD_LIGHT_PLAIN
                             : s->virtuals[p->source - s->n].plain);
}

/* Is L, of a shadow ray, light that arrives?  By the mean of its channels, as
 * in Radiance: what it went through may make one negative. */
static bool
arrives(struct rad_rgb L)
{
    return L.r + L.g + L.b > 0;
}

/* The way to the image that p aims at is clear; is it so behind the mirror?
 * False: no light arrives.  Sets p->val to what does. */
static bool
see_in_mirror(const struct direct *d, struct potential *p)
{
    const struct rad_sources *s = d->ctx->job->sources;
    const struct rad_virtual *v = &s->virtuals[p->source - s->n];
    struct rad_span span;
    struct rad_hit hit;
    struct rad_ray sr;

    if (v->sure)
        return true;
    if (!rad_way_aim(d->ctx, &d->r->hit, p->source, p->span.dir, &span, &hit))
        return false;
    if (is_plain(d, p)) {
        enum rad_sight seen =
            rad_way_clear(d->ctx, v, p->span.dir, &hit, &p->val);

        if (seen != RAD_SIGHT_VEILED)
            return seen == RAD_SIGHT_CLEAR;
    }
    if (!start_ray(d, p, &sr))
        return false;
    shade_target(d->ctx, &sr, &hit);
    p->val = rad_rgb_mul(sr.L, p->coef);
    return arrives(sr.L);
}

/* The same for p's source, image or not. */
static bool
see_beyond(const struct direct *d, struct potential *p)
{
    return p->source < d->ctx->job->sources->n || see_in_mirror(d, p);
}

/* Let a shadow ray, which meets what hit and line say, go through that and on
 * to its source. */
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

/* Follow the shadow ray of p through what is not opaque, first at hit; false:
 * no light arrives.  Sets p->val to what does. */
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
    /* up to a lamp there may be nothing but mist */
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

/* Send p's shadow ray; false: no light arrives. */
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

/* Is r's way to its source, along the span, clear?  If not, r gets what comes
 * through. */
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
    if (r->path & RAD_RAY_UNTESTED || is_clear(ctx, r, &span))
        shade_target(ctx, r, &hit);
}

/* Larger first; the order of the samples settles ties, so that it is one. */
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

/* With -dt 0 every one is tested, so the order does not matter. */
static void
test_all(struct direct *d)
{
    for (int32_t i = 0; i < d->n; i++)
        add_if_seen(d, &d->list[i]);
}

/* The sum of the samples' luminances, and the brightest of them. */
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

/* Test a sample that is most of the sum by itself, if there is one, and take it
 * off the list.  Returns the sum of the others. */
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

/* The sample that is drawn, tested for all but one that is tested apart. */
static void
test_drawn(struct direct *d)
{
    double all = test_apart(d), at, lum = 0;
    struct potential *p = d->list;

    at = all * rad_rand(d->r->key, RAD_DIM_SOURCE);
    /* rounding may leave nothing behind the last */
    for (int32_t i = 0; i < d->n && at >= 0; i++) {
        p = &d->list[i];
        lum = rad_rgb_lum(p->val);
        at -= lum;
    }
    if (test(d, p))
        d->r->L =
            rad_rgb_add(d->r->L, rad_rgb_scale(p->val, (float)(all / lum)));
}

/* The part of each channel of a that is left in b. */
static struct rad_rgb
part_left(struct rad_rgb a, struct rad_rgb b)
{
    float all = fminf(rad_rgb_lum(b) / rad_rgb_lum(a), 1);

    return rad_rgb(a.r > 0 ? fminf(b.r / a.r, 1) : all,
                   a.g > 0 ? fminf(b.g / a.g, 1) : all,
                   a.b > 0 ? fminf(b.b / a.b, 1) : all);
}

/* Draw from the samples from the first of o on, n of them, which add up to a
 * luminance of `all`, and test that: what is left of it is left of each, so
 * where all is seen there is no noise. */
static void
test_rest(struct direct *d, const struct order *o, int32_t n, double all)
{
    double at = all * rad_rand(d->r->key, RAD_DIM_SOURCE);
    struct rad_rgb sum = { 0, 0, 0 }, was;
    struct potential *p = &d->list[o->i]; /* also where `all` is infinite */

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

/* How high is the centre of the source, which is there, above the horizon of
 * r's hit?  Below minus its radius nothing of it is to be seen. */
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

/* The key of the random numbers for samples of a source or image; without
 * jitter there are none. */
static uint64_t
sample_key(const struct rad_ray *r, const struct rad_light_view *view,
           int32_t source)
{
    /* above every ray's branch number, below every dimension's bit */
    return view->jitter > 0
               ? rad_key_branch(r->key, (uint64_t)(source + 1) << 32)
               : 0;
}

/* Weigh the samples of the sources themselves. */
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

/* Weigh the samples of what mirrors show. */
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
    /* a tilted normal may see what the surface itself does not */
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
    if (s->nvirtuals > 0)
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
