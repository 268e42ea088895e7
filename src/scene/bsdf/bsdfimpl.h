/* bsdfimpl.h - what the parts of bsdf share (inside scene/bsdf only) */
#ifndef RAD_SCENE_BSDFIMPL_H
#define RAD_SCENE_BSDFIMPL_H

#include "scene/bsdf/bsdf.h"

#include <stdint.h>

/* Which part of a BSDF: seen from the front or the back, reflected or passed
 * through. */
enum side { SIDE_RF, SIDE_RB, SIDE_TF, SIDE_TB, NSIDES };

struct bsdf_matrix;
struct bsdf_tree;

struct bsdf_part {
    enum side side;
    double finest; /* projected solid angle of the smallest cell */
    double most;   /* hemispherical, the Lambertian rest apart */
    struct bsdf_matrix *matrix;
    struct bsdf_tree *tree; /* one of the two */
};

struct rad_bsdf {
    struct bsdf_part part[NSIDES]; /* neither matrix nor tree: not there */
    double diffuse[NSIDES][3];
};

/* --- XML ------------------------------------------------------------------ */

struct xml_node {
    const char *name;
    const char *text; /* without blanks at its ends; "" where there are
                       * elements */
    struct xml_node *kid, *next;
};

/* The elements of a file, in arena; attributes are dropped. */
struct xml_node *rad_xml_parse(struct rad_arena *arena, const char *xml,
                               size_t len, struct rad_error *err);

/* The first element of that name in n or behind n; NULL: none.  n may be NULL.
 */
const struct xml_node *rad_xml_kid(const struct xml_node *n, const char *name);
const struct xml_node *rad_xml_next(const struct xml_node *n);

/* The text of n's kid of that name, "" where there is none. */
const char *rad_xml_text(const struct xml_node *n, const char *name);

/* --- numbers and colours ---------------------------------------------------
 */

/* The next number of a list with blanks and commas; *p moves behind it and
 * them. False: there is none. */
bool rad_bsdf_number(const char **p, double *value);

/* Between XYZ and primaries so sharp that the least of two colours can be taken
 * channel by channel.  Source: Ward & Eydelberg-Vileshin 2002, Picture perfect
 * RGB rendering using spectral prefiltering and sharp color primaries. */
void rad_bsdf_sharpen(double sharp[3], const double xyz[3]);
void rad_bsdf_unsharpen(double xyz[3], const double sharp[3]);

/* Hilbert's curve through squares: a turned or mirrored one, and where in its
 * four quarters it goes. */
struct hilbert {
    bool swap, flip;
};
#define HILBERT_START ((struct hilbert){ true, false })

/* Quarter q of the curve, 0 to 3: *x, *y get the place of the quarter (0 or 1
 * each); *h becomes the curve in it. */
void rad_hilbert_enter(struct hilbert *h, unsigned q, unsigned *x, unsigned *y);

/* The point in the unit square after a fraction t of the way. */
void rad_hilbert_point(struct hilbert h, double t, double p[2]);

/* --- the two kinds of data -------------------------------------------------
 */

/* Read all parts; RAD_EUNSUPPORTED where the structure is another. */
int rad_bsdf_read_matrices(struct rad_bsdf *b, struct rad_arena *arena,
                           const struct xml_node *layer, struct rad_error *err);
int rad_bsdf_read_trees(struct rad_bsdf *b, struct rad_arena *arena,
                        const struct xml_node *layer, struct rad_error *err);

/* Which of the names the text of that kid of n is, in any case; or -1. */
int rad_bsdf_which(const struct xml_node *n, const char *kid,
                   const char *const name[], int nnames);

/* The side that a data block of a file describes, or -1. */
int rad_bsdf_side(const struct xml_node *block);

/* Fill w, whose part is set, for light from v. */
void rad_matrix_look_from(struct rad_bsdf_way *w, const double v[3]);
void rad_tree_look_from(struct rad_bsdf_way *w, const double v[3]);

/* What is scattered, for a part that is of this kind: xyz and *cell (not NULL)
 * stay as they are where the part says nothing of `out`. */
void rad_matrix_value(const struct rad_bsdf_way *w, const double out[3],
                      double xyz[3], double *cell);
void rad_tree_value(const struct rad_bsdf_way *w, const double in[3],
                    const double out[3], double xyz[3], double *cell);

/* Widen range to the cells that light goes to. */
void rad_matrix_cells(const struct rad_bsdf_way *w, const double in[3],
                      double range[2]);
void rad_tree_cells(const struct rad_bsdf_way *w, double range[2]);

double rad_matrix_total(const struct rad_bsdf_way *w);
double rad_tree_total(const struct rad_bsdf_way *w);
bool rad_matrix_sample(const struct rad_bsdf_way *w, const double in[3],
                       double x, double out[3]);
bool rad_tree_sample(const struct rad_bsdf_way *w, const double in[3], double x,
                     double out[3]);

#endif
