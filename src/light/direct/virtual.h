/* virtual.h - light that reaches a point by way of mirrors
 *
 * A flat surface of material mirror relays each source that shines on it: seen
 * from a point before the mirror, the source's image stands behind it, and the
 * way to the image, folded at the mirror, is the way to the source.  Images
 * are relayed again, up to -dr times.  A flat prism relays sources, too, from
 * either side and to either; its images are sheared along it, so that the ray
 * from the source's centre to the prism's goes where the prism sends it.
 * An image keeps no shape: its samples are the source's own, seen from where
 * the mirrors put the point.  Sources are numbered first, images after them.
 * Source: rpict(1) on -dr and -dp; Radiance's reference manual, "mirror". */
#ifndef RAD_LIGHT_VIRTUAL_H
#define RAD_LIGHT_VIRTUAL_H

#include "base/vec.h"
#include "light/sample/sample.h"
#include "light/direct/source.h"

/* Images of all real sources in all mirrors at most. */
#define RAD_MAX_VIRTUALS 1000000

/* Where a point of the source appears by way of prisms: p[0] axis[0] + p[1]
 * axis[1] + p[2] axis[2] + move. */
struct rad_bend {
    double axis[3][3], move[3];
};

struct rad_virtual {
    int32_t mirror; /* object that shows it: a mirror or prism */
    int32_t from;   /* source or image that the mirror relays */
    int32_t root;   /* source at the end of the way */
    bool sure;      /* nothing between the mirror and the source (-dp) */
    bool plain;     /* L is what it shows wherever the way is free: the source
                     * is RAD_LIGHT_PLAIN and all mirrors of one colour */
    struct rad_rgb L;
    double normal[3], offset;    /* of the mirror: before it n.p > offset */
    double turn[3][3], move[3];  /* p to where the source sees it from:
                                  * turn p + move; turn is orthogonal where
                                  * there are mirrors alone */
    double image[3];             /* centre, or direction, of the image */
    double spread;               /* radius of a ball about it that holds it;
                                  * distant: half angle [rad] */
    double middle[3], extent;    /* of a disk that holds the mirror, */
    double lo[3], hi[3];         /* and of a box */
    double along, loose;         /* of a distant image, by distance to the
                                  * mirror's plane: how far away the image's
                                  * centre is seen in it, and how far from
                                  * there any of the image may be */
    int32_t way;                 /* of a prism: which (shade/prism.h) */
    const struct rad_bend *bend; /* NULL: mirrors alone */
};

/* A direction at the source as it is at image v (NULL: the source itself). */
static inline void
rad_virtual_turn(const struct rad_virtual *v, const double from[3],
                 double dir[3])
{
    if (!v) {
        rad_copy(dir, from);
        return;
    }
    for (int k = 0; k < 3; k++)
        dir[k] = v->turn[0][k] * from[0] + v->turn[1][k] * from[1] +
                 v->turn[2][k] * from[2];
}

/* A direction at the source as it is at its bent image, of any length. */
static inline void
rad_bend_direction(const struct rad_bend *b, const double from[3],
                   double dir[3])
{
    for (int k = 0; k < 3; k++)
        dir[k] = b->axis[0][k] * from[0] + b->axis[1][k] * from[1] +
                 b->axis[2][k] * from[2];
}

/* Find the images of a job's sources, and with -dp above 0 test which of them
 * are hidden for good, and which are in full view from all of their mirror.
 * Nothing is done, and no memory taken, without mirrors.
 * 0 or a negative code. */
int rad_virtuals_make(struct rad_job *job, struct rad_error *err);

/* Is p, whose error is err, before the image's mirror? */
bool rad_virtual_faces(const struct rad_virtual *v, const double p[3],
                       double err);

/* May p, which is before the mirror, see any of the image in it?  May be wrong
 * about what is near the mirror's edge, never about what is seen. */
bool rad_virtual_shows(const struct rad_sources *s, const struct rad_virtual *v,
                       const double p[3]);

/* The samples of the image, as rad_light_samples() gives those of a source;
 * directions are those in which the ray leaves view->p. */
void rad_virtual_samples(const struct rad_sources *s,
                         const struct rad_virtual *v,
                         const struct rad_light_view *view, rad_light_fn *fn,
                         void *arg);

#endif
