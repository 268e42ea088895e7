/* image.c - the images of light sources in mirrors and prisms
 *
 * Images are made level by level: first those of the sources, then images of
 * these images, and so on.  A mirror relays every source or image that may
 * shine on it.  These tests, but for is_across(), only save work: an image that
 * no light comes from would add nothing.  The tests of -dp (pretest.c) change
 * the picture: they drop images that no test ray reaches.  */
#include "config.h"

#include "light/direct/image.h"
#include "arith/elementary.h"
#include "base/vec.h"
#include "scene/part.h"
#include "light/direct/cover.h"
#include "light/direct/emitter.h"
#include "trace/asks.h"

#include <stdlib.h>
#include <string.h>

struct maker {
    struct rad_job *job;
    struct rad_sources *s;
    struct rad_mirrors mirrors;
    int32_t capacity;
};

/* --- mirrors --- */

/* The mirror or prism material of obj, be it its own material or the alternate
 * of an illum; RAD_VOID: obj is neither mirror nor prism. */
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

/* Set lo and hi to a box about the mirror.  A polygon that is not quite flat is
 * met in its mean plane: the box grows by how far corners are off that plane.
 */
static void
box_mirror(struct rad_mirror *m, const struct rad_object *o)
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

/* Fill in *m for obj.  0, 1 if obj has no area, or a negative code. */
static int
make_mirror(struct rad_mirror *m, struct rad_job *job, int32_t obj, int32_t mat)
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
    mk->mirrors.list = calloc((size_t)n, sizeof *mk->mirrors.list);
    if (!mk->mirrors.list)
        return rad_fail_memory(err);
    for (int32_t i = 0; i < rad_scene_own(mk->job->scene); i++) {
        int32_t mat = mirror_material(mk->job, i);
        struct rad_mirror *m = &mk->mirrors.list[mk->mirrors.n];
        int rc;

        if (mat == RAD_VOID)
            continue;
        rc = make_mirror(m, mk->job, i, mat);
        if (rc < 0)
            return rad_fail(err, rc, "out of memory");
        /* a mirror larger than the scene has a vertex such as 1e308, and the
         * tree of surfaces lacks it */
        mk->mirrors.n += rc == 0 && m->radius <= 2 * mk->mirrors.size;
    }
    return rad_drop_covered(mk->job, mk->mirrors.list, &mk->mirrors.n,
                            sizeof *mk->mirrors.list,
                            offsetof(struct rad_mirror, obj))
               ? 0
               : rad_fail_memory(err);
}

/* --- may a mirror relay a source? --- */

/* How far a disk with unit normal b reaches from its centre along unit vector
 * a. */
static double
reach(const double a[3], const double b[3], double radius)
{
    double c = rad_dot(a, b);

    return radius * sqrt(rad_most(1 - c * c, 0));
}

/* Does any of a spotlight's cone fall on a disk of this radius about the
 * mirror's centre?
 *   aim  the cone's axis, a unit vector
 *   to   from the spotlight to the mirror's centre */
static bool
spot_meets(const struct rad_source *root, const double aim[3],
           const double to[3], double radius)
{
    double d = sqrt(rad_dot(to, to)), wide = radius + root->radius;
    double half = rad_acos(rad_most(1 - root->spot.omega / (2 * M_PI), -1));

    if (d <= wide)
        return true;
    return rad_acos(rad_least(rad_dot(aim, to) / d, 1)) <=
           half + rad_asin(wide / d);
}

/* Does any light of a source that is not distant fall on the mirror?
 *   v      image of the source, NULL: the source itself
 *   image  centre of the image or source */
static bool
local_meets(const struct rad_source *root, const struct rad_virtual *v,
            const double image[3], const struct rad_mirror *m)
{
    double extent = root->radius, normal[3], aim[3], to[3];

    rad_sub(to, m->centre, image);
    if (root->flags & RAD_LIGHT_FLAT) {
        rad_virtual_turn(v, root->normal, normal);
        if (!(rad_dot(normal, to) > -m->radius))
            return false;
        extent = reach(m->normal, normal, extent);
    }
    if (!(rad_dot(m->normal, image) - m->offset > -extent))
        return false;
    if (root->flags & RAD_LIGHT_NEAR &&
        sqrt(rad_dot(to, to)) > root->reach + root->radius + m->radius)
        return false;
    rad_virtual_turn(v, root->spot.aim, aim);
    return !(root->flags & RAD_LIGHT_SPOT) ||
           spot_meets(root, aim, to, m->radius);
}

/* Does the plane of a prism pass through source or image i, which is not
 * distant?  The way from its centre to the prism's then all but lies in that
 * plane, and turned as the functions say it would give an image anywhere. */
static bool
is_across(const struct rad_sources *s, int32_t i, const struct rad_mirror *m)
{
    const struct rad_source *root = rad_source_root(s, i);
    const struct rad_virtual *v = rad_source_virtual(s, i);
    double extent = 0, axis[3];

    for (int k = 0; k < (root->flags & RAD_LIGHT_FLAT ? 2 : 3); k++) {
        if (v && v->bend)
            rad_bend_direction(v->bend, root->axis[k], axis);
        else
            rad_virtual_turn(v, root->axis[k], axis);
        extent += fabs(rad_dot(m->normal, axis));
    }
    return fabs(rad_dot(m->normal, v ? v->image : root->centre) - m->offset) <
           extent;
}

static bool
may_relay(const struct rad_sources *s, int32_t i, const struct rad_mirror *m)
{
    const struct rad_source *root = rad_source_root(s, i);
    const struct rad_virtual *v = rad_source_virtual(s, i);
    const double *image = v ? v->image : root->centre;

    if (root->flags & RAD_LIGHT_SKIP || rad_source_object(s, i) == m->obj)
        return false;
    /* light that the image's mirror relays is before that mirror */
    if (v && !(rad_dot(v->normal, m->centre) - v->offset >
               -reach(v->normal, m->normal, m->radius)))
        return false;
    if (m->prism != RAD_VOID) /* it sends light where its functions say */
        return root->flags & RAD_LIGHT_DISTANT || !is_across(s, i, m);
    if (root->flags & RAD_LIGHT_DISTANT)
        return rad_dot(m->normal, image) > -root->radius;
    return local_meets(root, v, image, m);
}

/* --- images --- */

/* A mirror or prism maps space by p + (normal.p - offset) w.  With w = out a
 * point of the source goes to its image; with w = in a point that sees the
 * image goes to where the source is seen in the same way.  The two maps are
 * inverse to each other. */
struct fold {
    double in[3], out[3];
    bool backwards; /* light leaves the prism against m's normal */
};

static void
fold_mirror(const struct rad_mirror *m, struct fold *f)
{
    rad_scale(f->in, -2, m->normal);
    rad_copy(f->out, f->in);
    f->backwards = false;
}

/* Make r a ray that has met the centre of the mirror.  It comes from the source
 * or image at the place `image`; if `far`, `image` is the unit direction to a
 * distant source or image. */
static void
aim_at_mirror(struct rad_ctx *ctx, const double image[3], bool far,
              const struct rad_mirror *m, struct rad_ray *r)
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

/* Set *f to the map of a prism: the ray from the source's centre to the
 * prism's is turned as the prism's functions say, other rays by the same map.
 * It shears space along the prism's plane, and mirrors it if the ray comes back
 * to the side of the source.  False: the prism sends no light this way. */
static bool
fold_prism(struct rad_ctx *ctx, const double image[3], bool far,
           const struct rad_mirror *m, int way, struct fold *f)
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

/* Map the point p by w (struct fold); with offset 0 the direction p. */
static void
folded(const double normal[3], double offset, const double w[3],
       const double p[3], double q[3])
{
    rad_madd(q, p, rad_dot(normal, p) - offset, w);
}

/* Set *b to the map from the source to its image, if a prism is on the way.
 *   before  the image that m relays, NULL: the source itself */
static void
make_bend(const struct rad_virtual *before, const struct rad_mirror *m,
          const struct fold *f, struct rad_bend *b)
{
    for (int j = 0; j < 3; j++) {
        double column[3] = { j == 0, j == 1, j == 2 };

        if (before && before->bend)
            rad_copy(column, before->bend->axis[j]);
        else if (before) /* turn is orthogonal: its transpose is its inverse */
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
make_image(const struct rad_sources *s, int32_t from,
           const struct rad_mirror *m, const struct fold *f,
           struct rad_virtual *v)
{
    const struct rad_virtual *before = rad_source_virtual(s, from);
    const struct rad_source *root = rad_source_root(s, from);
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

/* Set v->spread, the radius of the image about its centre.  A linear map
 * stretches no vector by more than its Frobenius norm. */
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
    rad_bend_direction(b, root->centre, centre);
    v->spread =
        rad_asin(rad_least(v->spread / sqrt(rad_dot(centre, centre)), 1));
}

/* A cone of half angle a meets a plane at distance 1 from its apex; c is the
 * cosine between the cone's axis and the plane's normal.  Returns a bound of
 * the distance, in the plane, from the point where the axis meets it to any
 * point of the cone; INFINITY: there is no bound. */
static double
cone_slack(double c, double a)
{
    double least = c * rad_cos(a) - sqrt(rad_most(1 - c * c, 0)) * rad_sin(a);

    return least > 0 ? 1 / least - 1 / c + a / least : INFINITY;
}

/* Set what rad_virtual_shows() reads of a distant image. */
static void
set_slack(struct rad_virtual *v)
{
    double c = -rad_dot(v->normal, v->image);

    v->along = 1 / c;
    v->loose = cone_slack(c, v->spread);
}

/* Set v->plain, and v->L if the image is plain. */
static void
set_radiance(const struct rad_job *job, struct rad_virtual *v)
{
    const struct rad_virtual *from = rad_source_virtual(job->sources, v->from);
    const struct rad_source *root = rad_source_root(job->sources, v->from);
    struct rad_rgb color;

    v->plain = !v->bend &&
               (from ? from->plain : root->flags & RAD_LIGHT_PLAIN) &&
               rad_mirror_plain(job, v->mirror, &color);
    if (v->plain)
        v->L = rad_rgb_mul(from ? from->L : root->L, color);
}

/* Make room for another image. */
static int
reserve_image(struct maker *mk, struct rad_error *err)
{
    struct rad_sources *s = mk->s;
    int32_t cap = mk->capacity ? 2 * mk->capacity : 16;
    struct rad_virtual *more;

    if (s->nvirtuals == RAD_MAX_VIRTUALS)
        return rad_fail(err, RAD_EDATA,
                        "more than %d images of light sources in mirrors; "
                        "lower -dr",
                        RAD_MAX_VIRTUALS);
    if (s->nvirtuals < mk->capacity)
        return 0;
    more = rad_arena_alloc(&mk->job->arena, (size_t)cap * sizeof *more);
    if (!more)
        return rad_fail_memory(err);
    if (s->nvirtuals > 0)
        memcpy(more, s->virtuals, (size_t)s->nvirtuals * sizeof *more);
    s->virtuals = more;
    mk->capacity = cap;
    return 0;
}

static int
add_image(struct maker *mk, int32_t from, const struct rad_mirror *m, int way,
          const struct fold *f, struct rad_error *err)
{
    struct rad_sources *s = mk->s;
    const struct rad_virtual *before;
    struct rad_bend *bend = NULL;
    struct rad_virtual *v;
    int rc = reserve_image(mk, err);

    if (rc < 0)
        return rc;
    before = rad_source_virtual(s, from);
    if (m->prism != RAD_VOID || (before && before->bend)) {
        bend = rad_arena_alloc(&mk->job->arena, sizeof *bend);
        if (!bend)
            return rad_fail_memory(err);
        make_bend(before, m, f, bend);
    }
    v = &s->virtuals[s->nvirtuals++];
    memset(v, 0, sizeof *v);
    make_image(s, from, m, f, v);
    v->way = way;
    v->bend = bend;
    set_spread(v, rad_source_root(s, from));
    set_slack(v);
    set_radiance(mk->job, v);
    return 0;
}

/* --- all images --- */

/* Add the images of source or image i in a prism: one for each of its ways. */
static int
relay_by_prism(struct maker *mk, int32_t i, const struct rad_mirror *m,
               struct rad_error *err)
{
    const struct rad_virtual *v = rad_source_virtual(mk->s, i);
    const struct rad_source *root = rad_source_root(mk->s, i);
    bool far = root->flags & RAD_LIGHT_DISTANT;
    struct rad_ctx ctx;
    struct fold f;
    int code = rad_ctx_init(&ctx, mk->job, err);

    for (int way = 0;
         code == 0 && way < rad_prism_ways(&mk->job->materials[m->prism]);
         way++)
        if (fold_prism(&ctx, v ? v->image : root->centre, far, m, way, &f)) {
            code = add_image(mk, i, m, way, &f, err);
            v = rad_source_virtual(mk->s, i); /* the list may have moved */
        }
    if (code == 0 && ctx.scratch.lacked)
        code = rad_fail_memory(err);
    rad_ctx_release(&ctx);
    return code;
}

static int
relay_one(struct maker *mk, int32_t i, const struct rad_mirror *m,
          struct rad_error *err)
{
    struct fold f;

    if (m->prism != RAD_VOID)
        return relay_by_prism(mk, i, m, err);
    fold_mirror(m, &f);
    return add_image(mk, i, m, 0, &f, err);
}

/* Add the images of sources (or images) first .. end - 1 in all mirrors. */
static int
relay(struct maker *mk, int32_t first, int32_t end, struct rad_error *err)
{
    int32_t old = mk->s->nvirtuals;
    int code = 0;

    for (int32_t i = first; i < end; i++)
        for (int32_t k = 0; code == 0 && k < mk->mirrors.n; k++)
            if (may_relay(mk->s, i, &mk->mirrors.list[k]))
                code = relay_one(mk, i, &mk->mirrors.list[k], err);
    if (code == 0 && mk->job->params.vspretest > 0 && mk->s->nvirtuals > old)
        code = rad_pretest(mk->job, &mk->mirrors, old, err);
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
    rad_geom_bounds(job->geom, lo, hi);
    for (int k = 0; k < 3; k++)
        mk.mirrors.size = rad_most(mk.mirrors.size, hi[k] - lo[k]);
    code = find_mirrors(&mk, err);
    for (int n = 0; code == 0 && mk.mirrors.n > 0 && first < end &&
                    n < job->params.directrelay;
         n++) {
        code = relay(&mk, first, end, err);
        first = end;
        end = mk.s->n + mk.s->nvirtuals;
    }
    free(mk.mirrors.list);
    return code;
}
