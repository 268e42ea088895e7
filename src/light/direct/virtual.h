/* virtual.h - light that reaches a point by way of mirrors
 *
 * A flat surface of material mirror relays each source that shines on it: seen
 * from a point before the mirror, the source's image stands behind it, and the
 * way to the image, folded at the mirror, is the way to the source.  Images
 * are relayed again, up to -dr times.  A flat prism relays sources, too, from
 * either side and to either; its images are sheared along it, so that the ray
 * from the source's centre to the prism's goes where the prism sends it.
 * An image has no shape of its own: the source is sampled from the point to
 * which the mirrors map the point that sees the image, and the samples are
 * mapped back.  Sources are numbered first, images after them.
 * Source: rpict(1) on -dr and -dp; Radiance's reference manual, "mirror". */
#ifndef RAD_LIGHT_VIRTUAL_H
#define RAD_LIGHT_VIRTUAL_H

#include "base/vec.h"
#include "light/sample/sample.h"
#include "light/direct/source.h"

/* At most so many images, of all sources in all mirrors. */
#define RAD_MAX_VIRTUALS 1000000

/* The map from a point p of the source to its image, where prisms are on the
 * way: p[0] axis[0] + p[1] axis[1] + p[2] axis[2] + move. */
struct rad_bend {
    double axis[3][3], move[3];
};

struct rad_virtual {
    int32_t mirror; /* object that shows the image: a mirror or prism */
    int32_t from;   /* source or image that the mirror relays */
    int32_t root;   /* source at the end of the way */
    bool sure;      /* nothing between the mirror and the source (-dp) */
    bool plain;     /* the image has radiance L wherever nothing is in the way:
                     * its source is RAD_LIGHT_PLAIN, and each mirror has one
                     * colour */
    struct rad_rgb L;            /* [W/sr/m^2] if plain */
    double normal[3], offset;    /* of the mirror: before it n.p > offset */
    double turn[3][3], move[3];  /* maps a point p that sees the image to the
                                  * point that sees the source alike: turn p +
                                  * move; turn is orthogonal without prisms */
    double image[3];             /* centre, or unit direction, of the image */
    double spread;               /* radius of a ball about its centre that holds
                                  * the image; distant: half angle [rad] */
    double middle[3], extent;    /* of a disk that holds the mirror */
    double lo[3], hi[3];         /* of a box that holds the mirror */
    double along, loose;         /* of a distant image, per distance of a point
                                  * to the mirror's plane: distance to where
                                  * the image's centre is seen in the plane, and
                                  * how far from there any part of the image may
                                  * be seen */
    int32_t way;                 /* number of the prism's way (shade/prism.h) */
    const struct rad_bend *bend; /* NULL: mirrors alone */
};

/* Map a direction at the source to image v (NULL: the source itself), which is
 * unbent. */
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

/* Map a direction at the source to its bent image; dir has any length. */
static inline void
rad_bend_direction(const struct rad_bend *b, const double from[3],
                   double dir[3])
{
    for (int k = 0; k < 3; k++)
        dir[k] = b->axis[0][k] * from[0] + b->axis[1][k] * from[1] +
                 b->axis[2][k] * from[2];
}

/* Make the images of job->sources, in the job's arena.  With -dp above 0, test
 * them: hidden images are dropped, and `sure` is set for those that are in full
 * view from all of their mirror.  Without mirrors nothing is allocated.
 * 0 or a negative code. */
int rad_virtuals_make(struct rad_job *job, struct rad_error *err);

/* Is p, whose rounding error is err, before the image's mirror? */
bool rad_virtual_faces(const struct rad_virtual *v, const double p[3],
                       double err);

/* May p, which is before the mirror, see a part of the image in the mirror?
 * True wherever p sees a part, and sometimes where the image is just beyond the
 * mirror's edge. */
bool rad_virtual_shows(const struct rad_sources *s, const struct rad_virtual *v,
                       const double p[3]);

/* Call fn with the samples of the image, as rad_light_samples() does for a
 * source; their directions are those in which a ray leaves view->p. */
void rad_virtual_samples(const struct rad_sources *s,
                         const struct rad_virtual *v,
                         const struct rad_light_view *view, rad_light_fn *fn,
                         void *arg);

#endif
