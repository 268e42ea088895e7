/* rif_rules.h - the rpict options that rad derives from a scene's description
 *
 * QUALITY, DETAIL, VARIABILITY, PENUMBRAS, INDIRECT, ZONE and EXPOSURE describe
 * the scene; rad's tables give the options for that.
 * Source: rad(1); the rules of Radiance 6.
 * Thread: one. */
#ifndef RADD_CLIENT_RIF_RULES_H
#define RADD_CLIENT_RIF_RULES_H

#include "rif/rif.h"

#include "scene/octree.h"

/* The box that is to be looked at, in world space. */
struct rif_zone {
    bool interior;
    double org[3], size[3]; /* all sizes are above 0 */
    double cube;            /* edge of the octree's cube */
};

/* The zone of ZONE; without it, the octree's cube seen from outside.
 * RAD_EDATA. */
int rif_zone(struct rif *r, const struct rad_octree *t, struct rif_zone *z,
             struct rad_error *err);

/* The factor for radiance that EXPOSURE gives; 0: it is not set.  RAD_EDATA. */
int rif_exposure(const struct rif *r, double *factor, struct rad_error *err);

/* How many columns and rows of the rendered picture make one of the written
 * one: 1, 2 or 3, by QUALITY. */
int rif_oversample(const struct rif *r);

/* The options for light, and those for sampling, each with a blank before it.
 * rad puts render= between the two, and only the first into OPTFILE. */
enum { RIF_RULES_TEXT = 512 };
int rif_rules(const struct rif *r, const struct rif_zone *z,
              char light[RIF_RULES_TEXT], char sampling[RIF_RULES_TEXT],
              struct rad_error *err);

#endif
