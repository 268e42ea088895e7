/* virtual.c - see virtual.h
 *
 * How images are seen from a point; image.c makes them.  */
#include "config.h"

#include "light/direct/sources.h"
#include "base/vec.h"

bool
rad_virtual_faces(const struct rad_virtual *v, const double p[3], double err)
{
    return rad_dot(v->normal, p) - v->offset > err;
}

/* Lines go from a point, at distance k before a plane, to all points of a ball
 * of radius r behind the plane.  Returns a bound of the distance, in the plane,
 * from where the line to the ball's centre meets it to where any other line
 * does; INFINITY: the ball meets the plane.
 *   behind  distance of the ball's centre to the plane
 *   d       distance of the ball's centre to the point */
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

/* Set `there` to the point from which the source looks as the image does from
 * p. */
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

/* An image whose source is being sampled. */
struct unfolded {
    const struct rad_virtual *v;
    const struct rad_source *root;
    const double *p;         /* the point that sees the image */
    const double *there;     /* the point that sees the source as p the image */
    double axis[3], bent[3]; /* the source's normal or axis, and the image's */
    double reach;            /* of a glow, to its image; or INFINITY */
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

/* Set `to` to the unit direction from u->p to the image of a point, which lies
 * at a distance along dir from u->there; returns the distance of that image. */
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

/* The factor by which a source looks smaller, seen in direction dir, than in
 * full view: a cosine if it is flat, the sine of the angle to a cylinder's
 * axis, 1 for a sphere.
 *   axis  the source's normal, or the cylinder's axis */
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

/* The solid angle of a sample of a bent image.  As in Radiance the image has
 * the source's area, and its normal or axis is bent as any direction is. */
static double
bent_size(const struct unfolded *u, const struct rad_light_sample *s,
          const struct rad_light_sample *image)
{
    const struct rad_source *src = u->root;
    double now;

    now = width(src, u->bent, image->aim) / (image->dist * image->dist);
    return s->omega * now * s->dist * s->dist / width(src, u->axis, s->aim);
}

/* rad_light_fn: as fold(), for an image in a prism. */
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

/* The reach of a glow is compared with the distance to its image.  Let the
 * source that is sampled have no reach, since its distance from `there` is
 * another where a prism is on the way.  Nor has it a spotlight's cone: a prism
 * turns a ray as its functions say, not just as its image does, and the ray
 * that meets the lamp tells whether it leaves within the cone. */
static void
bend_reach(struct unfolded *u, struct rad_source *boundless)
{
    if (!(u->root->flags & (RAD_LIGHT_NEAR | RAD_LIGHT_SPOT)))
        return;
    *boundless = *u->root;
    if (boundless->flags & RAD_LIGHT_NEAR)
        u->reach = boundless->reach;
    boundless->flags &= ~(unsigned)RAD_LIGHT_NEAR;
    boundless->spot.omega = 4 * M_PI;
    boundless->apex = INFINITY;
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
