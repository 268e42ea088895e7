/* ambsmooth.h - the records of a frozen cache, smoothed for pixels
 *
 * The records that pixels show, those of level 0, are smoothed among themselves
 * (light/smooth/smooth.h) when all passes are closed.  Deeper records are not:
 * hemispheres average them.
 * Thread: any number may ask for values at once, none while another makes or
 * releases it.  */
#ifndef RAD_LIGHT_AMBSMOOTH_H
#define RAD_LIGHT_AMBSMOOTH_H

#include "light/record/ambcache.h"
#include "light/indirect/ambshape.h"
#include "light/smooth/smooth.h"

struct rad_ambsmooth {
    struct rad_smooth *smooth; /* NULL: there is none */
    uint32_t *place; /* place of each record, or UINT32_MAX: it has none */
    size_t n;        /* records */
    uint32_t *shown; /* record of each place */
    size_t nshown;   /* places */
    const struct rad_geom *geom;
    const struct rad_ambitem *item;
    const struct rad_ambscale *scale;
};

/* Does any surface stand between the places p and q with these normals?  Glass
 * does, too: light differs behind it. */
bool rad_ambsmooth_parted(const struct rad_geom *geom, const double p[3],
                          const float n[3], const double q[3], const float m[3],
                          struct rad_geom_counts *counts);

/* Make *s anew for n records, item[], of a scene with *geom.  It keeps all
 * these pointers, so it must be made again, or released, before item[] changes.
 * False: out of memory; then no record is smoothed. */
bool rad_ambsmooth_make(struct rad_ambsmooth *s, const struct rad_geom *geom,
                        const struct rad_ambscale *scale,
                        const struct rad_ambitem *item, size_t n);
void rad_ambsmooth_release(struct rad_ambsmooth *s);

/* The memory that s takes [bytes]. */
size_t rad_ambsmooth_bytes(const struct rad_ambsmooth *s);

/* Set *v to the smoothed value of one of the records; false: it has none. */
static inline bool
rad_ambsmooth_at(const struct rad_ambsmooth *s, const struct rad_ambitem *item,
                 struct rad_smooth_value *v)
{
    size_t i = (size_t)(item - s->item);

    if (i >= s->n || s->place[i] == UINT32_MAX)
        return false;
    rad_smooth_at(s->smooth, s->place[i], v);
    return true;
}

/* Set *v to the smoothed value of a record that is not among the n records, and
 * that a single pixel shows; false: there are no smoothed records. */
bool rad_ambsmooth_beside(const struct rad_ambsmooth *s,
                          const struct rad_ambitem *item,
                          struct rad_smooth_value *v);

#endif
