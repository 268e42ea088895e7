/* ambsmooth.h - what pixels show of a frozen cache, with less noise
 *
 * The records that pixels ask for are smoothed among themselves (light/smooth/
 * smooth.h) once all passes have been.  Deeper ones are averaged by the
 * hemispheres that ask for them.
 * Thread: any number may ask at once, none while another makes it.  */
#ifndef RAD_LIGHT_AMBSMOOTH_H
#define RAD_LIGHT_AMBSMOOTH_H

#include "light/indirect/ambcache.h"
#include "light/indirect/ambshape.h"
#include "light/smooth/smooth.h"

struct rad_ambsmooth {
    struct rad_smooth *smooth; /* NULL: there is none */
    uint32_t *place; /* of each of the first n records, or UINT32_MAX */
    size_t n;
    uint32_t *shown; /* the record of each place, nshown of them */
    size_t nshown;
    const struct rad_geom *geom;
    const struct rad_ambitem *item;
    const struct rad_ambscale *scale;
};

/* Of item[], n records on what is in *geom, in the place of what there was.  It
 * is asked no more when item[] changes or one of the others is gone, until it
 * is made again.  False: out of memory; then there is none. */
bool rad_ambsmooth_make(struct rad_ambsmooth *s, const struct rad_geom *geom,
                        const struct rad_ambscale *scale,
                        const struct rad_ambitem *item, size_t n);
void rad_ambsmooth_release(struct rad_ambsmooth *s);

/* Bytes that it takes. */
size_t rad_ambsmooth_bytes(const struct rad_ambsmooth *s);

/* Record number i; false: it is not smoothed. */
static inline bool
rad_ambsmooth_at(const struct rad_ambsmooth *s, size_t i,
                 struct rad_smooth_value *v)
{
    if (i >= s->n || s->place[i] == UINT32_MAX)
        return false;
    rad_smooth_at(s->smooth, s->place[i], v);
    return true;
}

/* A record that is not one of them and that one pixel shows; false: there is
 * nothing to smooth it with. */
bool rad_ambsmooth_beside(const struct rad_ambsmooth *s,
                          const struct rad_ambitem *item,
                          struct rad_smooth_value *v);

#endif
