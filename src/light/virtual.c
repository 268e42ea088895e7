/* virtual.c - see virtual.h
 *
 * Images are made level by level: first of the sources, then of the first
 * images, and so on.  A mirror relays what can possibly shine on it; these
 * tests only save work, for a way that does not exist brings no light.  What
 * -dp then finds does decide: an image that no ray of the test has reached is
 * dropped, as in rpict, so the number of rays is rpict's.  */
#include "config.h"

#include "light/virtual.h"
#include "light/sources.h"
#include "base/rng.h"
#include "base/vec.h"
#include "scene/part.h"
#include "shade/emitter.h"
#include "shade/mirror.h"
#include "shade/prism.h"

#include <stdlib.h>
#include <string.h>

/* Rays that test an image at least, and places tried for each, as in rpict. */
#define MIN_SAMPLES 16
#define MAX_TRIES   32
#define MAX_SAMPLES (1 << 24)
/* rpict's density of the test for distant sources: samples for a mirror as
 * large as the scene, for each that -dp asks for. */
#define DISTANT_SAMPLES 32.0
/* Bound of the rounding in a few dozen operations on coordinates, relative to
 * the largest. */
#define ROUNDING 0x1p-46
/* A loss of more than this share of the light is something in the way. */
#define DIMMED 1e-6

/* A mirror, or a prism. */
struct mirror {
    int32_t obj;
    int32_t prism; /* material of a prism, or RAD_VOID */
    double normal[3], offset;
    double centre[3], radius; /* of a disk that holds it, */
    double lo[3], hi[3];      /* and of a box */
};

struct maker {
    struct rad_job *job;
    struct rad_sources *s;
    struct mirror *mirrors;
    int32_t nmirrors;
    int32_t capacity;
    double size; /* of the scene */
};

/* --- mirrors --- */

/* The material that makes obj a mirror or prism, its own or what an illum puts
 * in its place; RAD_VOID: it is none. */
static int32_t
mirror_material(const struct rad_job *job, int32_t obj)
{
    const struct rad_scene *scene = job->scene;
    const struct rad_object *o = &scene->objects[obj];
    const struct rad_emitter *em;
    int32_t m;

    if (o->type != RAD_POLYGON && o->type != RAD_RING)
        return RAD_VOID;
    m = rad_material_of(scene, o->modifier);
    em = rad_emitter_of(job, obj);
    if (em && em->alternate != RAD_VOID)
        m = rad_material_of(scene, em->alternate);
    if (m == RAD_VOID)
        return RAD_VOID;
    switch (scene->objects[m].type) {
    case RAD_MIRROR:
    case RAD_PRISM1:
    case RAD_PRISM2:
        return m;
    default:
        return RAD_VOID;
    }
}

/* The box about a ring; or a polygon, and what is in its plane there, if it is
 * not quite flat. */
static void
box_mirror(struct mirror *m, const struct rad_object *o)
{
    int n = o->type == RAD_POLYGON ? o->nreals / 3 : 0;
    double off = n > 0 ? 0 : m->radius;

    rad_copy(m->lo, n > 0 ? o->reals : m->centre);
    rad_copy(m->hi, m->lo);
    for (const double *v = o->reals; n > 0; v += 3, n--) {
        off = rad_most(off, fabs(rad_dot(m->normal, v) - m->offset));
        for (int k = 0; k < 3; k++) {
            m->lo[k] = rad_least(m->lo[k], v[k]);
            m->hi[k] = rad_most(m->hi[k], v[k]);
        }
    }
    for (int k = 0; k < 3; k++) {
        m->lo[k] -= off;
        m->hi[k] += off;
    }
}

/* 0, 1 if it has no area, or a negative code. */
static int
make_mirror(struct mirror *m, struct rad_job *job, int32_t obj, int32_t mat)
{
    struct rad_source shape = { .obj = obj };
    int rc = rad_light_shape(&shape, &job->scene->objects[obj], &job->arena);

    m->obj = obj;
    m->prism = job->scene->objects[mat].type == RAD_MIRROR ? RAD_VOID : mat;
    rad_copy(m->normal, shape.normal);
    rad_copy(m->centre, shape.centre);
    m->offset = rad_dot(m->normal, m->centre);
    m->radius = shape.radius;
    box_mirror(m, &job->scene->objects[obj]);
    return rc;
}

static int
find_mirrors(struct maker *mk, struct rad_error *err)
{
    int32_t n = 0;

    for (int32_t i = 0; i < rad_scene_own(mk->job->scene); i++)
        n += mirror_material(mk->job, i) != RAD_VOID;
    if (n == 0)
        return 0;
    mk->mirrors = calloc((size_t)n, sizeof *mk->mirrors);
    if (!mk->mirrors)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    for (int32_t i = 0; i < rad_scene_own(mk->job->scene); i++) {
        int32_t mat = mirror_material(mk->job, i);
        int rc;

        if (mat == RAD_VOID)
            continue;
        rc = make_mirror(&mk->mirrors[mk->nmirrors], mk->job, i, mat);
        if (rc < 0)
            return rad_fail(err, rc, "out of memory");
        mk->nmirrors += rc == 0;
    }
    return 0;
}

/* --- may a mirror relay a source? --- */

static const struct rad_virtual *
virtual_of(const struct rad_sources *s, int32_t i)
{
    return i < s->n ? NULL : &s->virtuals[i - s->n];
}

static const struct rad_source *
root_of(const struct rad_sources *s, int32_t i)
{
    return &s->list[i < s->n ? i : s->virtuals[i - s->n].root];
}

/* A direction at the source as it is at image v (NULL: the source itself). */
static void
turn_back(const struct rad_virtual *v, const double from[3], double dir[3])
{
    if (!v) {
        rad_copy(dir, from);
        return;
    }
    for (int k = 0; k < 3; k++)
        dir[k] = v->turn[0][k] * from[0] + v->turn[1][k] * from[1] +
                 v->turn[2][k] * from[2];
}

/* How far a disk about a point of normal b reaches along a. */
static double
reach(const double a[3], const double b[3], double radius)
{
    double c = rad_dot(a, b);

    return radius * sqrt(rad_most(1 - c * c, 0));
}

/* Does any of the cone of a spotlight, which stands to[] before the mirror,
 * fall on it? */
static bool
spot_meets(const struct rad_source *root, const double aim[3],
           const double to[3], double radius)
{
    double d = sqrt(rad_dot(to, to)), wide = radius + root->radius;
    double half = acos(rad_most(1 - root->spot.omega / (2 * M_PI), -1));

    if (d <= wide)
        return true;
    return acos(rad_least(rad_dot(aim, to) / d, 1)) <= half + asin(wide / d);
}

/* The same for a source or image that is not far away, at `image`. */
static bool
local_meets(const struct rad_source *root, const struct rad_virtual *v,
            const double image[3], const struct mirror *m)
{
    double extent = root->radius, normal[3], aim[3], to[3];

    rad_sub(to, m->centre, image);
    if (root->flags & RAD_LIGHT_FLAT) {
        turn_back(v, root->normal, normal);
        if (!(rad_dot(normal, to) > -m->radius))
            return false;
        extent = reach(m->normal, normal, extent);
    }
    if (!(rad_dot(m->normal, image) - m->offset > -extent))
        return false;
    if (root->flags & RAD_LIGHT_NEAR &&
        sqrt(rad_dot(to, to)) > root->reach + root->radius + m->radius)
        return false;
    turn_back(v, root->spot.aim, aim);
    return !(root->flags & RAD_LIGHT_SPOT) ||
           spot_meets(root, aim, to, m->radius);
}

static bool
may_relay(const struct rad_sources *s, int32_t i, const struct mirror *m)
{
    const struct rad_source *root = root_of(s, i);
    const struct rad_virtual *v = virtual_of(s, i);
    const double *image = v ? v->image : root->centre;

    if (root->flags & RAD_LIGHT_SKIP || rad_source_object(s, i) == m->obj)
        return false;
    /* what a mirror relays goes on before it */
    if (v && !(rad_dot(v->normal, m->centre) - v->offset >
               -reach(v->normal, m->normal, m->radius)))
        return false;
    if (m->prism != RAD_VOID)
        return true; /* its functions say */
    if (root->flags & RAD_LIGHT_DISTANT)
        return rad_dot(m->normal, image) > -root->radius;
    return local_meets(root, v, image, m);
}

/* --- images --- */

/* What a mirror or prism does to space: p + (normal.p - offset) w, where w is
 * `in` for the place that the source sees a point from, and `out` for the image
 * of a point of the source.  Each undoes the other. */
struct fold {
    double in[3], out[3];
    bool backwards; /* what comes through leaves against the normal */
};

static void
fold_mirror(const struct mirror *m, struct fold *f)
{
    rad_scale(f->in, -2, m->normal);
    rad_copy(f->out, f->in);
    f->backwards = false;
}

/* A ray from a source or image to the middle of a mirror, entered. */
static void
aim_at_mirror(struct rad_ctx *ctx, const double image[3], bool far,
              const struct mirror *m, struct rad_ray *r)
{
    r->key = 0;
    r->tmax = INFINITY;
    rad_ray_spawn(ctx, r, RAD_RAY_PRIMARY, NULL, NULL, 0);
    rad_ray_clear(r);
    if (far)
        rad_scale(r->dir, -1, image);
    else
        rad_sub(r->dir, m->centre, image);
    r->hit.t = rad_normalize(r->dir);
    rad_madd(r->org, m->centre, -r->hit.t, r->dir);
    r->hit.obj = m->obj;
    r->hit.err = 0;
    r->hit.uv[0] = r->hit.uv[1] = 0;
    rad_copy(r->hit.p, m->centre);
    rad_copy(r->hit.n, m->normal);
    rad_ray_enter(r);
}

/* A prism turns the light of a source as it turns the ray from the source's
 * centre to its own: space behind it is sheared along it, and mirrored if the
 * ray comes back.  False: no light comes of it. */
static bool
fold_prism(struct rad_ctx *ctx, const double image[3], bool far,
           const struct mirror *m, int way, struct fold *f)
{
    double dir[3], cos_in, cos_out;
    struct rad_ray r;

    aim_at_mirror(ctx, image, far, m, &r);
    cos_in = rad_dot(r.dir, m->normal);
    if (r.hit.t == 0 || fabs(cos_in) <= RAD_TINY ||
        !rad_prism_way(ctx, &ctx->job->materials[m->prism], &r, way, dir))
        return false;
    cos_out = rad_dot(dir, m->normal);
    if (fabs(cos_out) <= RAD_TINY)
        return false;
    rad_scale(f->out, 1 / cos_out, dir);
    rad_madd(f->out, f->out, -1 / cos_in, r.dir);
    if ((cos_in > 0) != (cos_out > 0)) {
        rad_madd(f->out, f->out, -2, m->normal);
        rad_copy(f->in, f->out);
    } else {
        rad_scale(f->in, -1, f->out);
    }
    f->backwards = cos_out < 0;
    return true;
}

/* p folded, or as a direction where offset is 0. */
static void
folded(const double normal[3], double offset, const double w[3],
       const double p[3], double q[3])
{
    rad_madd(q, p, rad_dot(normal, p) - offset, w);
}

/* A direction at the source as it is at its bent image, of any length. */
static void
bend_direction(const struct rad_bend *b, const double from[3], double dir[3])
{
    for (int k = 0; k < 3; k++)
        dir[k] = b->axis[0][k] * from[0] + b->axis[1][k] * from[1] +
                 b->axis[2][k] * from[2];
}

/* The way from the source to its image, where there is a prism between. */
static void
make_bend(const struct rad_virtual *before, const struct mirror *m,
          const struct fold *f, struct rad_bend *b)
{
    for (int j = 0; j < 3; j++) {
        double column[3] = { j == 0, j == 1, j == 2 };

        if (before && before->bend)
            rad_copy(column, before->bend->axis[j]);
        else if (before) /* its inverse is its transpose */
            for (int k = 0; k < 3; k++)
                column[k] = before->turn[j][k];
        folded(m->normal, 0, f->out, column, b->axis[j]);
    }
    b->move[0] = b->move[1] = b->move[2] = 0;
    if (before && before->bend)
        rad_copy(b->move, before->bend->move);
    else if (before)
        for (int j = 0; j < 3; j++)
            rad_madd(b->move, b->move, -before->move[j], before->turn[j]);
    folded(m->normal, m->offset, f->out, b->move, b->move);
}

static void
make_image(const struct rad_sources *s, int32_t from, const struct mirror *m,
           const struct fold *f, struct rad_virtual *v)
{
    const struct rad_virtual *before = virtual_of(s, from);
    const struct rad_source *root = root_of(s, from);
    bool far = root->flags & RAD_LIGHT_DISTANT;

    v->mirror = m->obj;
    v->from = from;
    v->root = before ? before->root : from;
    rad_scale(v->normal, f->backwards ? -1 : 1, m->normal);
    v->offset = f->backwards ? -m->offset : m->offset;
    for (int j = 0; j < 3; j++) {
        double row[3] = { j == 0, j == 1, j == 2 }, along;

        if (before)
            rad_copy(row, before->turn[j]);
        along = rad_dot(row, f->in);
        rad_madd(v->turn[j], row, along, m->normal);
        v->move[j] = (before ? before->move[j] : 0) - m->offset * along;
    }
    folded(m->normal, far ? 0 : m->offset, f->out,
           before ? before->image : root->centre, v->image);
    if (far)
        rad_normalize(v->image);
    rad_copy(v->middle, m->centre);
    v->extent = m->radius;
    rad_copy(v->lo, m->lo);
    rad_copy(v->hi, m->hi);
}

/* How far the image reaches from its centre.  A linear map stretches no vector
 * by more than the root of the sum of all its squares. */
static void
set_spread(struct rad_virtual *v, const struct rad_source *root)
{
    const struct rad_bend *b = v->bend;
    double stretch2 = 0, centre[3];

    v->spread = root->radius;
    if (!b)
        return;
    for (int k = 0; k < 3; k++)
        stretch2 += rad_dot(b->axis[k], b->axis[k]);
    v->spread *= sqrt(stretch2);
    if (!(root->flags & RAD_LIGHT_DISTANT))
        return;
    bend_direction(b, root->centre, centre);
    v->spread = asin(rad_least(v->spread / sqrt(rad_dot(centre, centre)), 1));
}

/* How far the places where a cone of half angle a about dir, whose cosine to
 * the plane is c, meets a plane at distance 1 may lie from where dir does;
 * INFINITY: any distance. */
static double
cone_slack(double c, double a)
{
    double least = c * cos(a) - sqrt(rad_most(1 - c * c, 0)) * sin(a);

    return least > 0 ? 1 / least - 1 / c + a / least : INFINITY;
}

/* What rad_virtual_shows() needs of a distant image. */
static void
set_slack(struct rad_virtual *v)
{
    double c = -rad_dot(v->normal, v->image);

    v->along = 1 / c;
    v->loose = cone_slack(c, v->spread);
}

/* What it shows, where that is one colour. */
static void
set_radiance(const struct rad_job *job, struct rad_virtual *v)
{
    const struct rad_virtual *from = virtual_of(job->sources, v->from);
    const struct rad_source *root = root_of(job->sources, v->from);
    struct rad_rgb color;

    v->plain = !v->bend &&
               (from ? from->plain : root->flags & RAD_LIGHT_PLAIN) &&
               rad_mirror_plain(job, v->mirror, &color);
    if (v->plain)
        v->L = rad_rgb_mul(from ? from->L : root->L, color);
}

static int
add_image(struct maker *mk, int32_t from, const struct mirror *m, int way,
          const struct fold *f, struct rad_error *err)
{
    struct rad_sources *s = mk->s;
    const struct rad_virtual *before;
    struct rad_bend *bend = NULL;
    struct rad_virtual *v;

    if (s->nvirtuals == RAD_MAX_VIRTUALS)
        return rad_fail(err, RAD_EDATA,
                        "more than %d images of light sources in mirrors; "
                        "lower -dr",
                        RAD_MAX_VIRTUALS);
    if (s->nvirtuals == mk->capacity) {
        int32_t cap = mk->capacity ? 2 * mk->capacity : 16;
        struct rad_virtual *more =
            rad_arena_alloc(&mk->job->arena, (size_t)cap * sizeof *more);

        if (!more)
            return rad_fail(err, RAD_ENOMEM, "out of memory");
        if (s->nvirtuals > 0)
            memcpy(more, s->virtuals, (size_t)s->nvirtuals * sizeof *more);
        s->virtuals = more;
        mk->capacity = cap;
    }
    before = virtual_of(s, from);
    if (m->prism != RAD_VOID || (before && before->bend)) {
        bend = rad_arena_alloc(&mk->job->arena, sizeof *bend);
        if (!bend)
            return rad_fail(err, RAD_ENOMEM, "out of memory");
        make_bend(before, m, f, bend);
    }
    v = &s->virtuals[s->nvirtuals++];
    memset(v, 0, sizeof *v);
    make_image(s, from, m, f, v);
    v->way = way;
    v->bend = bend;
    set_spread(v, root_of(s, from));
    set_slack(v);
    set_radiance(mk->job, v);
    return 0;
}

/* --- the test for visibility --- */

struct pick {
    uint64_t key;
    uint32_t n;
    struct rad_light_sample sample;
};

/* rad_light_fn: keep one of all samples, each as likely. */
static void
pick_one(void *arg, const struct rad_light_sample *s)
{
    struct pick *p = arg;

    if (rad_rand(p->key, RAD_DIM_SOURCE | p->n) * (p->n + 1) < 1)
        p->sample = *s;
    p->n++;
}

/* Let the disk hold only what a spotlight's cone meets of the mirror, whose
 * plane is h before the image.  With a the half angle of the cone and b that
 * between its axis and the plane's normal, the cone reaches farthest from its
 * axis on the outer side: h (tan(a + b) - tan b). */
static void
shrink_to_spot(struct mirror *m, const struct rad_source *root,
               const struct rad_virtual *from, const double image[3], double h)
{
    double a = acos(rad_most(1 - root->spot.omega / (2 * M_PI), -1));
    double aim[3], cosine, b, radius;

    turn_back(from, root->spot.aim, aim);
    cosine = -rad_dot(aim, m->normal);
    b = acos(rad_most(rad_least(cosine, 1), -1));
    if (a + b >= M_PI / 2)
        return;
    radius = h * (tan(a + b) - tan(b)) + root->radius / cos(a + b);
    if (!(radius < m->radius))
        return;
    m->radius = radius;
    rad_madd(m->centre, image, h / cosine, aim);
}

/* The same for the reach of a glow. */
static void
shrink_to_reach(struct mirror *m, const struct rad_source *root,
                const double image[3], double h)
{
    double far = root->reach + root->radius, r2 = far * far - h * h;

    if (!(r2 < m->radius * m->radius))
        return;
    m->radius = sqrt(rad_most(r2, 0));
    rad_madd(m->centre, image, -h, m->normal);
}

/* The part of mirror m in which an image may be seen. */
static void
find_part(const struct rad_sources *s, const struct rad_virtual *v,
          const struct mirror *m, struct mirror *part)
{
    const struct rad_source *root = &s->list[v->root];
    const struct rad_virtual *from = virtual_of(s, v->from);
    const double *image = from ? from->image : root->centre;
    double h = rad_dot(m->normal, image) - m->offset;

    *part = *m;
    if (root->flags & RAD_LIGHT_DISTANT || !(h > 0))
        return;
    if (root->flags & RAD_LIGHT_SPOT)
        shrink_to_spot(part, root, from, image, h);
    else if (root->flags & RAD_LIGHT_NEAR)
        shrink_to_reach(part, root, image, h);
}

static int32_t
sample_count(const struct maker *mk, const struct rad_virtual *v,
             const struct mirror *m)
{
    double r2 = m->radius * m->radius, n = mk->job->params.vspretest;

    if (mk->s->list[v->root].flags & RAD_LIGHT_DISTANT)
        n *= DISTANT_SAMPLES * r2 / (mk->size * mk->size);
    else /* solid angle of the disk, as seen from its axis */
        n *= 2 * M_PI *
             (1 - sqrt(1 / (1 + r2 / rad_dist2(v->image, m->centre))));
    return n > MIN_SAMPLES ? (int32_t)rad_least(n + .5, MAX_SAMPLES)
                           : MIN_SAMPLES;
}

/* A ray that has met a random place of the mirror; false: it has missed. */
static bool
meet_mirror(struct rad_ctx *ctx, const struct mirror *m, uint64_t key,
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

/* How much of the light of source i arrives where r met a mirror? */
static enum light
look(struct rad_ctx *ctx, const struct rad_ray *r, int32_t i)
{
    const struct rad_sources *s = ctx->job->sources;
    const struct rad_virtual *v = virtual_of(s, i);
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

/* Test image v in m; sets v->sure.  False: nowhere on the mirror does any of
 * it arrive. */
static bool
test_image(struct maker *mk, struct rad_ctx *ctx, struct rad_virtual *v,
           const struct mirror *m, uint64_t key)
{
    struct mirror part;
    bool full = false, hidden = false;
    int64_t tries;
    int32_t n;

    find_part(mk->s, v, m, &part);
    n = sample_count(mk, v, &part);
    tries = (int64_t)n * MAX_TRIES;

    for (int64_t t = 0; n > 0; t++) {
        struct rad_ray r;

        if (t == tries)
            return true; /* too small to hit: as if it were not tested */
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

/* The mirror that shows v; they are in the order of objects. */
static const struct mirror *
mirror_of(const struct maker *mk, const struct rad_virtual *v)
{
    int32_t lo = 0, hi = mk->nmirrors - 1;

    while (lo < hi) {
        int32_t mid = lo + (hi - lo) / 2;

        if (mk->mirrors[mid].obj < v->mirror)
            lo = mid + 1;
        else
            hi = mid;
    }
    return &mk->mirrors[lo];
}

/* Test the images from `first` on, and drop those that are hidden. */
static int
test_images(struct maker *mk, int32_t first, struct rad_error *err)
{
    struct rad_sources *s = mk->s;
    uint64_t seed =
        rad_key_branch(rad_mix64(mk->job->params.seed), RAD_BRANCH_SHADOW);
    struct rad_ctx ctx;
    int32_t kept = first;
    int code = rad_ctx_init(&ctx, mk->job, err);

    for (int32_t i = first; code == 0 && i < s->nvirtuals; i++) {
        struct rad_virtual *v = &s->virtuals[i];
        uint64_t key =
            rad_key_branch(seed, (uint64_t)v->from << 32 | (uint32_t)v->mirror);

        if (test_image(mk, &ctx, v, mirror_of(mk, v), key))
            s->virtuals[kept++] = *v;
    }
    rad_ctx_release(&ctx);
    if (code == 0)
        s->nvirtuals = kept;
    return code;
}

/* --- all of them --- */

/* Images of source or image i in a prism. */
static int
relay_by_prism(struct maker *mk, int32_t i, const struct mirror *m,
               struct rad_error *err)
{
    const struct rad_virtual *v = virtual_of(mk->s, i);
    const struct rad_source *root = root_of(mk->s, i);
    bool far = root->flags & RAD_LIGHT_DISTANT;
    struct rad_ctx ctx;
    struct fold f;
    int code = rad_ctx_init(&ctx, mk->job, err);

    for (int way = 0;
         code == 0 && way < rad_prism_ways(&mk->job->materials[m->prism]);
         way++)
        if (fold_prism(&ctx, v ? v->image : root->centre, far, m, way, &f)) {
            code = add_image(mk, i, m, way, &f, err);
            v = virtual_of(mk->s, i); /* the list may have moved */
        }
    rad_ctx_release(&ctx);
    return code;
}

static int
relay_one(struct maker *mk, int32_t i, const struct mirror *m,
          struct rad_error *err)
{
    struct fold f;

    if (m->prism != RAD_VOID)
        return relay_by_prism(mk, i, m, err);
    fold_mirror(m, &f);
    return add_image(mk, i, m, 0, &f, err);
}

/* Images of the sources from `first` to `end` in all mirrors. */
static int
relay(struct maker *mk, int32_t first, int32_t end, struct rad_error *err)
{
    int32_t old = mk->s->nvirtuals;
    int code = 0;

    for (int32_t i = first; i < end; i++)
        for (int32_t k = 0; code == 0 && k < mk->nmirrors; k++)
            if (may_relay(mk->s, i, &mk->mirrors[k]))
                code = relay_one(mk, i, &mk->mirrors[k], err);
    if (code == 0 && mk->job->params.vspretest > 0 && mk->s->nvirtuals > old)
        code = test_images(mk, old, err);
    return code;
}

int
rad_virtuals_make(struct rad_job *job, struct rad_error *err)
{
    struct maker mk = { .job = job, .s = job->sources };
    int32_t first = 0, end = job->sources->n;
    double lo[3], hi[3];
    int code = 0;

    if (job->params.directrelay <= 0 || job->sources->nlit == 0)
        return 0;
    code = find_mirrors(&mk, err);
    rad_geom_bounds(job->geom, lo, hi);
    for (int k = 0; k < 3; k++)
        mk.size = rad_most(mk.size, hi[k] - lo[k]);
    for (int n = 0; code == 0 && mk.nmirrors > 0 && first < end &&
                    n < job->params.directrelay;
         n++) {
        code = relay(&mk, first, end, err);
        first = end;
        end = mk.s->n + mk.s->nvirtuals;
    }
    free(mk.mirrors);
    return code;
}

/* --- from a point --- */

bool
rad_virtual_faces(const struct rad_virtual *v, const double p[3], double err)
{
    return rad_dot(v->normal, p) - v->offset > err;
}

/* The same for what leads to a ball of radius r, whose centre is at distance
 * behind on the other side and d from the cone's point. */
static double
ball_slack(double k, double behind, double d, double r)
{
    double most = k / (k + behind - r);

    return behind > r ? r * most + d * (most - k / (k + behind + r)) : INFINITY;
}

static double
largest(const double v[3])
{
    return rad_most(fabs(v[0]), rad_most(fabs(v[1]), fabs(v[2])));
}

bool
rad_virtual_shows(const struct rad_sources *s, const struct rad_virtual *v,
                  const double p[3])
{
    double k = rad_dot(v->normal, p) - v->offset, at[3], d[3], slack, c;

    if (s->list[v->root].flags & RAD_LIGHT_DISTANT) {
        slack = k * v->loose;
        rad_madd(at, p, k * v->along, v->image);
    } else {
        c = v->offset - rad_dot(v->normal, v->image);
        rad_sub(d, v->image, p);
        slack = ball_slack(k, c, sqrt(rad_dot(d, d)), v->spread);
        rad_madd(at, p, k / (k + c), d);
    }
    if (!(slack < INFINITY))
        return true;
    slack += ROUNDING * (largest(at) + largest(v->middle) + v->extent);
    for (int i = 0; i < 3; i++)
        if (at[i] < v->lo[i] - slack || at[i] > v->hi[i] + slack)
            return false;
    slack += v->extent;
    return !(rad_dist2(at, v->middle) > slack * slack);
}

struct unfolded {
    const struct rad_virtual *v;
    const struct rad_source *root;
    const double *p;         /* where the image is seen from, */
    const double *there;     /* and where the source is */
    double axis[3], bent[3]; /* the source's normal or axis, and the image's */
    rad_light_fn *fn;
    void *arg;
};

/* rad_light_fn: pass a sample of the source on as one of the image. */
static void
fold(void *arg, const struct rad_light_sample *s)
{
    const struct unfolded *u = arg;
    struct rad_light_sample image = *s;

    turn_back(u->v, s->aim, image.aim);
    turn_back(u->v, s->dir, image.dir);
    u->fn(u->arg, &image);
}

/* Where the point at a distance along dir from the source's side appears. */
static double
bend_point(const struct unfolded *u, const double dir[3], double dist,
           double to[3])
{
    double q[3];

    rad_madd(q, u->there, dist, dir);
    bend_direction(u->v->bend, q, to);
    for (int k = 0; k < 3; k++)
        to[k] += u->v->bend->move[k] - u->p[k];
    return rad_normalize(to);
}

/* How wide the source shows itself in direction dir, whose normal or axis is
 * as given. */
static double
width(const struct rad_source *src, const double axis[3], const double dir[3])
{
    double c = rad_dot(axis, dir);

    if (src->flags & RAD_LIGHT_FLAT)
        return rad_most(-c, 0);
    return src->shape == RAD_CYLINDER ? sqrt(rad_most(1 - c * c, 0)) : 1;
}

static void
bend_axis(struct unfolded *u)
{
    const struct rad_source *src = u->root;

    rad_copy(u->axis, src->flags & RAD_LIGHT_FLAT ? src->normal : src->axis[0]);
    rad_normalize(u->axis);
    bend_direction(u->v->bend, u->axis, u->bent);
    rad_normalize(u->bent);
}

/* The image keeps the source's area, and its normal or axis is bent as any
 * direction is: so Radiance has it. */
static double
bent_size(const struct unfolded *u, const struct rad_light_sample *s,
          const struct rad_light_sample *image)
{
    const struct rad_source *src = u->root;
    double now;

    now = width(src, u->bent, image->aim) / (image->dist * image->dist);
    return s->omega * now * s->dist * s->dist / width(src, u->axis, s->aim);
}

/* rad_light_fn: the same as fold() by way of a prism. */
static void
fold_bent(void *arg, const struct rad_light_sample *s)
{
    const struct unfolded *u = arg;
    struct rad_light_sample image = *s;

    if (s->dist < INFINITY) {
        image.dist = bend_point(u, s->aim, s->dist, image.aim);
        bend_point(u, s->dir, s->dist, image.dir);
        image.omega = bent_size(u, s, &image);
    } else {
        bend_direction(u->v->bend, s->aim, image.aim);
        rad_normalize(image.aim);
        bend_direction(u->v->bend, s->dir, image.dir);
        rad_normalize(image.dir);
    }
    if (image.dist > 0 && image.omega > 0)
        u->fn(u->arg, &image);
}

void
rad_virtual_samples(const struct rad_sources *s, const struct rad_virtual *v,
                    const struct rad_light_view *view, rad_light_fn *fn,
                    void *arg)
{
    struct rad_light_view there = *view;
    struct unfolded u = { .v = v,
                          .root = &s->list[v->root],
                          .p = view->p,
                          .there = there.p,
                          .fn = fn,
                          .arg = arg };

    for (int k = 0; k < 3; k++)
        there.p[k] = rad_dot(v->turn[k], view->p) + v->move[k];
    if (v->bend)
        bend_axis(&u);
    rad_light_samples(u.root, &there, v->bend ? fold_bent : fold, &u);
}
