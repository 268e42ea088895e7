/* ambserving.h - the records that serve in a pixel, for errors of areas
 *
 * What records are off by averages out over an area in which many serve, and
 * does not where the same ones serve everywhere.
 * Growth: none.  Thread: that of the context which fills it. */
#ifndef RAD_LIGHT_AMBSERVING_H
#define RAD_LIGHT_AMBSERVING_H

#define RAD_AMBSERVING_MOST 32

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

/* What was added since the last call brings so much luminance; if that is
 * nothing, a hemisphere does. */
void rad_ambserving_scale(struct rad_ambserving *s, double lum);

/* The correlation of two pixels' errors, if the records' errors are equal and
 * do not depend on each other: 1 if the same records serve in the same parts, 0
 * if none serves in both. */
double rad_ambserving_common(const struct rad_ambserving *a,
                             const struct rad_ambserving *b);

#endif
