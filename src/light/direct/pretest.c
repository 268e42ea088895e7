/* pretest.c - which images are hidden, and which in full view (-dp)
 *
 * Rays go to each image from random places of its mirror.  An image that no ray
 * reaches is dropped.  That changes the picture, so the number of rays is
 * rpict's.  */
#include "config.h"

#include "light/direct/image.h"
#include "arith/elementary.h"
#include "base/rng.h"
#include "base/vec.h"

/* The least number of rays that test an image, and how many random places are
 * tried for each ray until the mirror is met, both as in rpict; and the most
 * rays. */
#define MIN_SAMPLES 16
#define MAX_TRIES   32
#define MAX_SAMPLES (1 << 24)
/* Rays that test a distant source in a mirror as large as the scene, for each
 * ray that -dp asks for; as in rpict. */
#define DISTANT_SAMPLES 32.0
/* If more than this share of the light is lost, something is in the way. */
#define DIMMED 1e-6

struct pick {
    uint64_t key;
    uint32_t n;
    struct rad_light_sample sample;
};

/* rad_light_fn: keep a single sample of all, each with the same probability. */
static void
pick_one(void *arg, const struct rad_light_sample *s)
{
    struct pick *p = arg;

    if (rad_rand(p->key, RAD_DIM_SOURCE | p->n) * (p->n + 1) < 1)
        p->sample = *s;
    p->n++;
}

/* Shrink the mirror's disk to the part that a spotlight's cone may meet.  The
 * mirror's plane is at distance h from the spotlight, or its image, at `image`.
 * Let a be the half angle of the cone and b the angle between its axis and the
 * plane's normal: in the plane the cone reaches farthest from its axis on the
 * outer side, by h (tan(a + b) - tan b). */
static void
shrink_to_spot(struct rad_mirror *m, const struct rad_source *root,
               const struct rad_virtual *from, const double image[3], double h)
{
    double a = rad_acos(rad_most(1 - root->spot.omega / (2 * M_PI), -1));
    double aim[3], cosine, b, radius;

    rad_virtual_turn(from, root->spot.aim, aim);
    cosine = -rad_dot(aim, m->normal);
    b = rad_acos(rad_most(rad_least(cosine, 1), -1));
    if (a + b >= M_PI / 2)
        return;
    radius = h * (rad_tan(a + b) - rad_tan(b)) + root->radius / rad_cos(a + b);
    if (!(radius < m->radius))
        return;
    m->radius = radius;
    rad_madd(m->centre, image, h / cosine, aim);
}

/* Shrink the mirror's disk to the part that lies within the reach of a glow,
 * which is measured from its image. */
static void
shrink_to_reach(struct rad_mirror *m, const struct rad_source *root,
                const struct rad_virtual *v)
{
    double h = m->offset - rad_dot(m->normal, v->image);
    double far = root->reach + v->spread, r2 = far * far - h * h;

    if (!(r2 < m->radius * m->radius))
        return;
    m->radius = sqrt(rad_most(r2, 0));
    rad_madd(m->centre, v->image, h, m->normal);
}

/* Set *part to the part of mirror m in which image v may be seen. */
static void
find_part(const struct rad_sources *s, const struct rad_virtual *v,
          const struct rad_mirror *m, struct rad_mirror *part)
{
    const struct rad_source *root = &s->list[v->root];
    const struct rad_virtual *from = rad_source_virtual(s, v->from);
    const double *image = from ? from->image : root->centre;
    double h = rad_dot(m->normal, image) - m->offset;

    *part = *m;
    if (root->flags & RAD_LIGHT_DISTANT)
        return;
    if (root->flags & RAD_LIGHT_NEAR)
        shrink_to_reach(part, root, v);
    else if (root->flags & RAD_LIGHT_SPOT && h > 0)
        shrink_to_spot(part, root, from, image, h);
}

static int32_t
sample_count(const struct rad_job *job, double size,
             const struct rad_virtual *v, const struct rad_mirror *m)
{
    double r2 = m->radius * m->radius, n = job->params.vspretest;

    if (job->sources->list[v->root].flags & RAD_LIGHT_DISTANT)
        n *= DISTANT_SAMPLES * r2 / (size * size);
    else /* solid angle of the disk, as seen from its axis */
        n *= 2 * M_PI *
             (1 - sqrt(1 / (1 + r2 / rad_dist2(v->image, m->centre))));
    return n > MIN_SAMPLES ? (int32_t)rad_least(n + .5, MAX_SAMPLES)
                           : MIN_SAMPLES;
}

/* Make r a ray that has met a random place of the mirror's disk; false: the
 * mirror is not there. */
static bool
meet_mirror(struct rad_ctx *ctx, const struct rad_mirror *m, uint64_t key,
            struct rad_ray *r)
{
    struct rad_span span = { .tmax = INFINITY };
    double u[3], v[3];

    rad_frame(u, v, m->normal);
    rad_madd(span.org, m->centre, m->radius, m->normal);
    rad_madd(span.org, span.org, m->radius * (2 * rad_rand(key, 0) - 1), u);
    rad_madd(span.org, span.org, m->radius * (2 * rad_rand(key, 1) - 1), v);
    rad_scale(span.dir, -1, m->normal);
    r->key = key;
    r->tmax = INFINITY;
    rad_ray_spawn(ctx, r, RAD_RAY_PRIMARY, NULL, NULL, 0);
    rad_ray_clear(r);
    rad_copy(r->org, span.org);
    rad_copy(r->dir, span.dir);
    if (!rad_geom_hit_object(ctx->job->geom, m->obj, &span, &r->hit,
                             &ctx->counts.geom))
        return false;
    rad_ray_enter(r);
    return true;
}

enum light { NO_LIGHT, HIDDEN, DIM, FULL };

/* How much light of source or image i arrives where r met a mirror? */
static enum light
look(struct rad_ctx *ctx, const struct rad_ray *r, int32_t i)
{
    const struct rad_sources *s = ctx->job->sources;
    const struct rad_virtual *v = rad_source_virtual(s, i);
    struct rad_light_view view = {
        .sizerat = ctx->job->params.srcsizerat,
        .jitter = ctx->job->params.srcjitter,
        .key = rad_key_branch(r->key, 1),
    };
    struct pick pick = { .key = rad_key_branch(r->key, 2) };
    struct rad_ray sr;
    float all;

    rad_copy(view.p, r->hit.p);
    if (v && !rad_virtual_faces(v, view.p, r->hit.err))
        return NO_LIGHT;
    if (v)
        rad_virtual_samples(s, v, &view, pick_one, &pick);
    else
        rad_light_samples(&s->list[i], &view, pick_one, &pick);
    if (pick.n == 0 ||
        !rad_ray_spawn(ctx, &sr, RAD_RAY_RSHADOW, r, NULL, RAD_BRANCH_SHADOW))
        return NO_LIGHT;
    sr.source = i;
    rad_copy(sr.dir, pick.sample.aim);
    sr.path |= RAD_RAY_UNTESTED;
    rad_source_aimed(ctx, &sr);
    all = rad_rgb_lum(sr.L);
    if (!(all > 0))
        return NO_LIGHT;
    sr.path &= (uint16_t)~RAD_RAY_UNTESTED;
    rad_source_aimed(ctx, &sr);
    if (!(rad_rgb_lum(sr.L) > 0))
        return HIDDEN;
    return all - rad_rgb_lum(sr.L) > DIMMED * all ? DIM : FULL;
}

/* Test image v in mirror m; sets v->sure.  False: no ray brought light, so the
 * image is hidden. */
static bool
test_image(struct rad_ctx *ctx, struct rad_virtual *v,
           const struct rad_mirror *m, double size, uint64_t key)
{
    struct rad_mirror part;
    bool full = false, hidden = false;
    int64_t tries;
    int32_t n;

    find_part(ctx->job->sources, v, m, &part);
    n = sample_count(ctx->job, size, v, &part);
    tries = (int64_t)n * MAX_TRIES;

    for (int64_t t = 0; n > 0; t++) {
        struct rad_ray r;

        if (t == tries)
            return true; /* the mirror fills too little of its disk to test */
        if (!meet_mirror(ctx, &part, rad_key_branch(key, (uint64_t)t), &r))
            continue;
        n--;
        switch (look(ctx, &r, v->from)) {
        case NO_LIGHT:
            break;
        case HIDDEN:
            hidden = true;
            break;
        case DIM:
            return true;
        case FULL:
            full = true;
            break;
        }
        if (full && hidden)
            return true;
    }
    v->sure = full;
    return full;
}

/* The mirror that shows v, found by bisection. */
static const struct rad_mirror *
mirror_of(const struct rad_mirrors *mirrors, const struct rad_virtual *v)
{
    int32_t lo = 0, hi = mirrors->n - 1;

    while (lo < hi) {
        int32_t mid = lo + (hi - lo) / 2;

        if (mirrors->list[mid].obj < v->mirror)
            lo = mid + 1;
        else
            hi = mid;
    }
    return &mirrors->list[lo];
}

int
rad_pretest(struct rad_job *job, const struct rad_mirrors *mirrors,
            int32_t first, struct rad_error *err)
{
    struct rad_sources *s = job->sources;
    uint64_t seed =
        rad_key_branch(rad_mix64(job->params.seed), RAD_BRANCH_SHADOW);
    struct rad_ctx ctx;
    int32_t kept = first;
    int code = rad_ctx_init(&ctx, job, err);

    for (int32_t i = first; code == 0 && i < s->nvirtuals; i++) {
        struct rad_virtual *v = &s->virtuals[i];
        uint64_t key =
            rad_key_branch(seed, (uint64_t)v->from << 32 | (uint32_t)v->mirror);

        if (test_image(&ctx, v, mirror_of(mirrors, v), mirrors->size, key))
            s->virtuals[kept++] = *v;
    }
    if (code == 0 && ctx.scratch.lacked)
        code = rad_fail_memory(err);
    rad_ctx_release(&ctx);
    if (code == 0)
        s->nvirtuals = kept;
    return code;
}
