/* rif_rules.h - the rpict options that rad makes of a scene's description
 *
 * QUALITY, DETAIL, VARIABILITY, PENUMBRAS, INDIRECT, ZONE and EXPOSURE say what
 * the scene is like; the options follow from tables that are rad's.
 * Source: rad(1); its rules are those of Radiance 6.
 * Thread: one. */
#ifndef RADD_CLIENT_RIF_RULES_H
#define RADD_CLIENT_RIF_RULES_H

#include "rif/rif.h"

#include "scene/octree.h"

/* The box that the scene is about, in world space. */
struct rif_zone {
    bool interior;
    double org[3], size[3]; /* each size is above 0 */
    double cube;            /* the edge of the scene's octree */
};

/* From ZONE; without it, the octree's cube seen from outside.  RAD_EDATA. */
int rif_zone(struct rif *r, const struct rad_octree *t, struct rif_zone *z,
             struct rad_error *err);

/* What EXPOSURE multiplies radiance by; 0: there is none.  RAD_EDATA. */
int rif_exposure(const struct rif *r, double *factor, struct rad_error *err);

/* How many columns and rows of the large picture make one of what is written:
 * 1, 2 or 3 by QUALITY. */
int rif_oversample(const struct rif *r);

/* The options that describe light, and those that describe sampling, each with
 * a blank before it.  rad lets render= come between the two, and OPTFILE holds
 * but the first. */
enum { RIF_RULES_TEXT = 512 };
int rif_rules(const struct rif *r, const struct rif_zone *z,
              char light[RIF_RULES_TEXT], char sampling[RIF_RULES_TEXT],
              struct rad_error *err);

#endif
