/* ambserving.h - the records that serve in a pixel, for errors of areas
 *
 * Errors of records average out over an area in which many records serve, and
 * do not where the same few records serve everywhere.
 * Growth: none.  Thread: that of the context which fills it. */
#ifndef RAD_LIGHT_AMBSERVING_H
#define RAD_LIGHT_AMBSERVING_H

#define RAD_AMBSERVING_MOST 128

/* The records of level 0 that serve, each with its share of the pixel's
 * luminance.  If there is no room for all, the last are left out. */
struct rad_ambserving {
    int n, scaled; /* the shares from `scaled` on are in any unit */
    struct {
        const void *record; /* NULL: a hemisphere for this pixel alone */
        double share;
    } v[RAD_AMBSERVING_MOST];
};

void rad_ambserving_add(struct rad_ambserving *s, const void *record,
                        double share);

/* Scale the shares of the records that were added since the last call, so that
 * their sum is `lum`.  If none was added, a hemisphere for this pixel alone
 * gets the share. */
void rad_ambserving_scale(struct rad_ambserving *s, double lum);

/* Drop the records that were added since the last call of
 * rad_ambserving_scale(): they do not serve after all. */
static inline void
rad_ambserving_forget(struct rad_ambserving *s)
{
    s->n = s->scaled;
}

/* The correlation of two pixels' errors, if the records' relative errors are
 * alike and do not depend on each other.  (Smoothed records share noise of
 * their neighbours, so the correlation is somewhat more.)  1 if the same
 * records serve in both pixels with the same shares, 0 if no record serves in
 * both. */
double rad_ambserving_common(const struct rad_ambserving *a,
                             const struct rad_ambserving *b);

#endif
