/* ambrec.h - an ambient record: the indirect irradiance E at a surface point
 *
 * E is irradiance [W/m^2], not E/pi.  Points are double[3] in world space,
 * lengths in scene units, normals of unit length.  ambient.h has the sources. */
#ifndef RAD_LIGHT_AMBREC_H
#define RAD_LIGHT_AMBREC_H

#include "base/color.h"
#include "light/hemisphere/glint.h"

#include <stdint.h>

#define RAD_AMBREC_UNSURE (-1.f)

/* One record.  Records also travel between workers; proto/ packs them field by
 * field. */
struct rad_ambrec {
    double p[3];            /* position */
    float n[3];             /* unit normal of the side that the record is for */
    float u[3];             /* unit vector of the smaller radius, in the tangent
                             * plane; the other axis is n x u */
    float radius[2];        /* validity radii along u and n x u, smaller first
                             * [scene units] */
    float weight;           /* ray weight that the record was made for */
    uint16_t level;         /* diffuse bounces before the record, 0 for a
                             * primary ray */
    struct rad_rgb E;       /* indirect irradiance [W/m^2] */
    float gpos[2];          /* translation gradient of ln E along u, n x u
                             * [1/unit], the same for all channels */
    float gdir[2];          /* rotation gradient about u, n x u [1/rad] */
    float var;              /* variance of E's luminance over its square, by the
                             * samples' noise; RAD_AMBREC_UNSURE: not known */
    struct rad_glint glint; /* of its hemisphere */
    uint32_t corral; /* bits of 32 directions about n, from u on, in which a
                      * surface stands near by at the horizon (ambient_find.c,
                      * "Light leaks") */
};

#endif
