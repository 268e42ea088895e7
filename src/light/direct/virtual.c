/* virtual.c - see virtual.h
 *
 * Images as they are seen from a point; image.c makes them.  */
#include "config.h"

#include "light/direct/sources.h"
#include "base/vec.h"

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
    slack += RAD_LIGHT_ROUNDING *
             (rad_largest(at) + rad_largest(v->middle) + v->extent);
    for (int i = 0; i < 3; i++)
        if (at[i] < v->lo[i] - slack || at[i] > v->hi[i] + slack)
            return false;
    slack += v->extent;
    return !(rad_dist2(at, v->middle) > slack * slack);
}

/* Where the image is seen from p, its source is seen from there. */
static void
turn_point(const struct rad_virtual *v, const double p[3], double there[3])
{
    for (int k = 0; k < 3; k++)
        there[k] = rad_dot(v->turn[k], p) + v->move[k];
}

void
rad_source_seen_from(const struct rad_sources *s, int32_t i, const double p[3],
                     double there[3])
{
    const struct rad_virtual *v = rad_source_virtual(s, i);

    if (v)
        turn_point(v, p, there);
    else
        rad_copy(there, p);
}

void
rad_source_appears(const struct rad_sources *s, int32_t i,
                   const double point[3], double at[3])
{
    const struct rad_virtual *v = rad_source_virtual(s, i);
    bool far = rad_source_root(s, i)->flags & RAD_LIGHT_DISTANT;
    double q[3];

    rad_copy(q, point);
    if (v && v->bend) {
        rad_bend_direction(v->bend, q, at);
        if (!far)
            rad_madd(at, at, 1, v->bend->move);
        return;
    }
    if (v && !far)
        rad_sub(q, q, v->move);
    rad_virtual_turn(v, q, at);
}

struct unfolded {
    const struct rad_virtual *v;
    const struct rad_source *root;
    const double *p;         /* where the image is seen from, */
    const double *there;     /* and where the source is */
    double axis[3], bent[3]; /* the source's normal or axis, and the image's */
    double reach;            /* of its light, by the bent way */
    rad_light_fn *fn;
    void *arg;
};

/* rad_light_fn: pass a sample of the source on as one of the image. */
static void
fold(void *arg, const struct rad_light_sample *s)
{
    const struct unfolded *u = arg;
    struct rad_light_sample image = *s;

    rad_virtual_turn(u->v, s->aim, image.aim);
    rad_virtual_turn(u->v, s->dir, image.dir);
    u->fn(u->arg, &image);
}

/* Where the point at a distance along dir from the source's side appears. */
static double
bend_point(const struct unfolded *u, const double dir[3], double dist,
           double to[3])
{
    double q[3];

    rad_madd(q, u->there, dist, dir);
    rad_bend_direction(u->v->bend, q, to);
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
    rad_bend_direction(u->v->bend, u->axis, u->bent);
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
        rad_bend_direction(u->v->bend, s->aim, image.aim);
        rad_normalize(image.aim);
        rad_bend_direction(u->v->bend, s->dir, image.dir);
        rad_normalize(image.dir);
    }
    if (image.dist > 0 && image.omega > 0 && !(image.dist > u->reach))
        u->fn(u->arg, &image);
}

/* A glow reaches as far by the way that a prism bends as it does without one:
 * its samples, seen from the unbent place, are not to be cut off by how far
 * away that is. */
static void
bend_reach(struct unfolded *u, struct rad_source *boundless)
{
    if (!(u->root->flags & RAD_LIGHT_NEAR))
        return;
    u->reach = u->root->reach;
    *boundless = *u->root;
    boundless->flags &= ~(unsigned)RAD_LIGHT_NEAR;
    u->root = boundless;
}

void
rad_virtual_samples(const struct rad_sources *s, const struct rad_virtual *v,
                    const struct rad_light_view *view, rad_light_fn *fn,
                    void *arg)
{
    struct rad_light_view there = *view;
    struct rad_source boundless;
    struct unfolded u = { .v = v,
                          .root = &s->list[v->root],
                          .reach = INFINITY,
                          .p = view->p,
                          .there = there.p,
                          .fn = fn,
                          .arg = arg };

    turn_point(v, view->p, there.p);
    if (v->bend) {
        bend_axis(&u);
        bend_reach(&u, &boundless);
    }
    rad_light_samples(u.root, &there, v->bend ? fold_bent : fold, &u);
}
