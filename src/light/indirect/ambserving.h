/* ambserving.h - the records that serve in a pixel, for errors of areas
 *
 * What records are off by averages out over an area in which many serve, and
 * does not where the same ones serve everywhere.
 * Growth: none.  Thread: that of the context which fills it. */
#ifndef RAD_LIGHT_AMBSERVING_H
#define RAD_LIGHT_AMBSERVING_H

#define RAD_AMBSERVING_MOST 128

/* Each record of level 0, with its share of the pixel's luminance.  Of more
 * than there is room for the last are left out. */
struct rad_ambserving {
    int n, scaled; /* the shares from `scaled` on are in any unit */
    struct {
        const void *record; /* NULL: a hemisphere for this pixel alone */
        double share;
    } v[RAD_AMBSERVING_MOST];
};

void rad_ambserving_add(struct rad_ambserving *s, const void *record,
                        double share);

/* What was added since the last call brings so much luminance; if nothing was
 * added, a hemisphere for this pixel alone does. */
void rad_ambserving_scale(struct rad_ambserving *s, double lum);

/* What was added since the last call does not serve after all. */
static inline void
rad_ambserving_forget(struct rad_ambserving *s)
{
    s->n = s->scaled;
}

/* The correlation of two pixels' errors, if the records' relative errors are
 * alike and do not depend on each other.  (Smoothed records share noise of
 * their neighbours, so it is somewhat more.)  1 if the same records serve in
 * the same parts, 0 if none serves in both. */
double rad_ambserving_common(const struct rad_ambserving *a,
                             const struct rad_ambserving *b);

#endif
