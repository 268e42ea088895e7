/* bsdf.h - measured or computed scattering, from XML files of LBNL's format
 *
 * A file holds, for light from the front and the back of a surface, how much is
 * reflected and how much passes, by direction in and direction out.  Two ways
 * to write that are read:
 *   matrices  between patches of the hemispheres: Klems full, half and quarter
 *             bases, and those that a file defines itself
 *   tensor trees of rank 3 (isotropic) and 4: squares that Shirley and Chiu's
 *             map makes of hemispheres, divided where it is worth it
 * Each of the four parts is split into a Lambertian rest, its minimum over all
 * directions, and what is scattered beyond that; a part of which no more than a
 * thousandth is scattered has the former only.
 *
 * Vectors are of unit length, in a frame whose z axis is the front's normal and
 * whose y axis is up; both point away from the surface.  The file's front is
 * our back: that is how Radiance has it.  Values are CIE XYZ, [1/sr], Y being
 * the photopic value; where a file has no colour they are grey.
 * Projected solid angles are those of the cells of directions between which a
 * value does not change.
 *
 * Limits: RAD_MAX_BSDF_*; parts of finer cells than 2^-RAD_MAX_BSDF_LEVELS are
 * refused.
 * Memory: all of it is allocated from the caller's arena.
 * Thread: read-only once made.
 * Sources: Klems 1994, A new method for predicting the solar heat gain of
 * complex fenestration systems; LBNL's BSDF XML format; Ward, Kurt & Bonneel
 * 2012, A practical framework for sharing and rendering real-world
 * bidirectional scattering distribution functions (tensor trees); Shirley &
 * Chiu 1997, A low distortion map between disk and square. */
#ifndef RAD_SCENE_BSDF_H
#define RAD_SCENE_BSDF_H

#include "base/arena.h"
#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>

#define RAD_MAX_BSDF_LEVELS 12
#define RAD_MAX_BSDF_NODES  (1 << 20) /* elements of the XML file */
#define RAD_MAX_BSDF_RINGS  46        /* of a basis that a file defines */
#define RAD_MAX_BSDF_BASES  16
#define RAD_MAX_BSDF_ANGLES 2500 /* patches of such a basis */

struct rad_bsdf;

/* Parse an XML file.  NULL and *err on failure: RAD_EDATA with the line where
 * the file is not well-formed, RAD_EUNSUPPORTED for another structure of data,
 * RAD_ENOMEM. */
struct rad_bsdf *rad_bsdf_parse(struct rad_arena *arena, const char *xml,
                                size_t len, struct rad_error *err);

/* Is there more than the Lambertian rest?  For light that is seen from the
 * front (or the back), reflected (or passed through). */
bool rad_bsdf_scatters(const struct rad_bsdf *b, bool front, bool through);

/* The Lambertian rest as a reflectance or transmittance. */
void rad_bsdf_diffuse(const struct rad_bsdf *b, bool front, bool through,
                      double xyz[3]);

/* The smallest cell of a part, and the most that any direction scatters. */
double rad_bsdf_finest(const struct rad_bsdf *b, bool front, bool through);
double rad_bsdf_most(const struct rad_bsdf *b, bool front, bool through);

/* A direction that light comes from, as far as it can be looked up without the
 * one that it goes to. */
struct bsdf_part;
struct rad_bsdf_eye {
    const struct rad_bsdf *b;
    double v[3];
    struct rad_bsdf_way {
        const struct bsdf_part *part; /* NULL: Lambertian */
        bool swapped; /* the part has light come in where this one goes out */
        int patch;    /* of matrices; -1: none */
        double sq[2]; /* of trees: place in the square, or from the rim and 0 */
        double turn[2]; /* of isotropic trees: cosine and sine */
    } way[2];           /* reflected, through */
};
void rad_bsdf_look_from(const struct rad_bsdf *b, const double in[3],
                        struct rad_bsdf_eye *eye);

/* All that goes to a direction, the rest included.  *cell, unless cell is NULL,
 * gets the projected solid angle of the smaller of the two cells that the
 * directions lie in; pi where there is nothing but the rest. */
void rad_bsdf_value(const struct rad_bsdf_eye *eye, const double out[3],
                    double xyz[3], double *cell);

/* The smallest and the largest of the cells that light goes to. */
void rad_bsdf_cells(const struct rad_bsdf_eye *eye, double range[2]);

/* How much of the light is scattered, the rest apart (Y). */
double rad_bsdf_total(const struct rad_bsdf_eye *eye, bool through);

/* Draw a direction from what is scattered, the rest apart, by a number x in
 * [0, 1): neighbouring numbers give neighbouring directions.  xyz gets the
 * whole weight, whose Y is rad_bsdf_total().  False: there is nothing. */
bool rad_bsdf_sample(const struct rad_bsdf_eye *eye, bool through, double x,
                     double out[3], double xyz[3]);

#endif
