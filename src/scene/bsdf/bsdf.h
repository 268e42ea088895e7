/* bsdf.h - measured or computed scattering data, from XML files in LBNL's
 * format
 *
 * A file says, for light from the front and the back of a surface, how much is
 * reflected and how much passes, by direction in and direction out.  We read
 * two forms of data:
 *   matrices  between patches of the hemispheres, in the Klems full, half and
 *             quarter bases and in bases that a file defines
 *   tensor trees  of rank 3 (isotropic) and 4: Shirley and Chiu's map turns
 *             hemispheres into squares, which are divided as finely as needed
 * So a file has up to four parts.  Each is split into a Lambertian rest, which
 * is its minimum over all directions, and the light that is scattered beyond
 * the rest.  A part that scatters at most a thousandth of the light has only a
 * rest.
 *
 * Vectors have unit length.  z is the normal of the front and y is up;
 * directions in and out both point away from the surface.  The file's front is
 * our back, as in Radiance.  Values are CIE XYZ, [1/sr], Y being the photopic
 * value; without colour in the file they are grey.  A cell is a set of
 * directions for which a value is constant; cell sizes are projected solid
 * angles.
 *
 * Limits: RAD_MAX_BSDF_*; parts with cells finer than 2^-RAD_MAX_BSDF_LEVELS
 * are refused.
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
#define RAD_MAX_BSDF_RINGS  46        /* of a basis in the file */
#define RAD_MAX_BSDF_BASES  16
#define RAD_MAX_BSDF_ANGLES 2500 /* patches of a basis in the file */

struct rad_bsdf;

/* Parse an XML file.  NULL and *err on failure: RAD_EDATA (with the line if the
 * file is not well-formed), RAD_EUNSUPPORTED for data in another form,
 * RAD_ENOMEM. */
struct rad_bsdf *rad_bsdf_parse(struct rad_arena *arena, const char *xml,
                                size_t len, struct rad_error *err);

/* Does a part scatter more than the rest?  The part of light seen from the
 * front (or the back), reflected (or passed through). */
bool rad_bsdf_scatters(const struct rad_bsdf *b, bool front, bool through);

/* A part's Lambertian rest, as reflectance or transmittance. */
void rad_bsdf_diffuse(const struct rad_bsdf *b, bool front, bool through,
                      double xyz[3]);

/* The smallest cell of a part, and the largest share of light that it scatters
 * from any direction. */
double rad_bsdf_finest(const struct rad_bsdf *b, bool front, bool through);
double rad_bsdf_most(const struct rad_bsdf *b, bool front, bool through);

/* A direction of incident light, looked up as far as possible without the
 * outgoing direction. */
struct bsdf_part;
struct rad_bsdf_eye {
    const struct rad_bsdf *b;
    double v[3];
    struct rad_bsdf_way {
        const struct bsdf_part *part; /* NULL: only the Lambertian rest */
        bool swapped; /* in and out are exchanged (reciprocity) */
        int patch;    /* of a matrix; -1: none */
        double sq[2]; /* of a tree: place in the square, or (0, from the rim) */
        double turn[2]; /* of an isotropic tree: cosine and sine */
    } way[2];           /* reflected, through */
};
void rad_bsdf_look_from(const struct rad_bsdf *b, const double in[3],
                        struct rad_bsdf_eye *eye);

/* The same for reflection, or transmission (through), alone: the other one must
 * not be asked for. */
void rad_bsdf_look_one_way(const struct rad_bsdf *b, const double in[3],
                           bool through, struct rad_bsdf_eye *eye);

/* The value for an outgoing direction, with the rest.  *cell (cell may be NULL)
 * gets the size of the smaller of the two cells that the directions are in; pi
 * if there is only the rest. */
void rad_bsdf_value(const struct rad_bsdf_eye *eye, const double out[3],
                    double xyz[3], double *cell);

/* The smallest and the largest cell that the light is scattered to. */
void rad_bsdf_cells(const struct rad_bsdf_eye *eye, double range[2]);

/* The share of the light (Y) that is scattered, without the rest. */
double rad_bsdf_total(const struct rad_bsdf_eye *eye, bool through);

/* Draw a direction from the scattered light, without the rest, by a number x in
 * [0, 1); near numbers give near directions.  xyz gets the sample's weight,
 * whose Y is rad_bsdf_total().  False: nothing is scattered. */
bool rad_bsdf_sample(const struct rad_bsdf_eye *eye, bool through, double x,
                     double out[3], double xyz[3]);

#endif
