/* bsdfimpl.h - shared by the files of bsdf (inside scene/bsdf only) */
#ifndef RAD_SCENE_BSDFIMPL_H
#define RAD_SCENE_BSDFIMPL_H

#include "scene/bsdf/bsdf.h"

/* The parts of a BSDF: for light seen from the front or the back, reflected or
 * passed through. */
enum side { SIDE_RF, SIDE_RB, SIDE_TF, SIDE_TB, NSIDES };

struct bsdf_matrix;
struct bsdf_tree;

struct bsdf_part {
    enum side side;
    double finest; /* projected solid angle of the smallest cell */
    double most;   /* largest hemispherical share scattered, without the rest */
    struct bsdf_matrix *matrix;
    struct bsdf_tree *tree; /* at most one of the two is set */
};

struct rad_bsdf {
    struct bsdf_part part[NSIDES]; /* without matrix and tree: not there */
    double diffuse[NSIDES][3];
};

/* --- XML ------------------------------------------------------------------ */

struct xml_node {
    const char *name;
    const char *text; /* without blanks at its ends; "" if it has elements */
    struct xml_node *kid, *next;
};

/* Parse a file's elements into arena; attributes are dropped. */
struct xml_node *rad_xml_parse(struct rad_arena *arena, const char *xml,
                               size_t len, struct rad_error *err);

/* The first element of that name in n, and the next one of the same name after
 * n; NULL: there is none.  n may be NULL in rad_xml_kid(). */
const struct xml_node *rad_xml_kid(const struct xml_node *n, const char *name);
const struct xml_node *rad_xml_next(const struct xml_node *n);

/* The text of n's first element of that name, or "". */
const char *rad_xml_text(const struct xml_node *n, const char *name);

/* --- numbers and colours --- */

/* Read the next number of a list with blanks and commas, and move *p behind it
 * and its separator.  False: there is no number. */
bool rad_bsdf_number(const char **p, double *value);

/* Convert between XYZ and primaries that are so sharp that the minimum of two
 * colours can be taken by channel.  Source: Ward & Eydelberg-Vileshin 2002,
 * Picture perfect RGB rendering using spectral prefiltering and sharp color
 * primaries. */
void rad_bsdf_sharpen(double sharp[3], const double xyz[3]);
void rad_bsdf_unsharpen(double xyz[3], const double sharp[3]);

/* Hilbert's curve through a square: one pattern, with its axes exchanged or
 * mirrored. */
struct hilbert {
    bool swap, flip;
};
#define HILBERT_START ((struct hilbert){ true, false })

/* Go into quarter q of the curve, 0 to 3.  *x and *y, 0 or 1, say which quarter
 * of the square that is; *h becomes the curve in it: through quarter 0 that is
 * mirrored about the diagonal, through quarter 3 about the other diagonal. */
static inline void
rad_hilbert_enter(struct hilbert *h, unsigned q, unsigned *x, unsigned *y)
{
    unsigned rx = q >> 1, ry = (q ^ rx) & 1;

    *x = (h->swap ? ry : rx) ^ h->flip;
    *y = (h->swap ? rx : ry) ^ h->flip;
    h->swap = h->swap != (ry == 0);
    h->flip = h->flip != (rx > ry);
}

/* The point of the unit square after a fraction t of the curve. */
void rad_hilbert_point(struct hilbert h, double t, double p[2]);

/* --- the two forms of data --- */

/* Read all parts.  RAD_EUNSUPPORTED: the data have another form. */
int rad_bsdf_read_matrices(struct rad_bsdf *b, struct rad_arena *arena,
                           const struct xml_node *layer, struct rad_error *err);
int rad_bsdf_read_trees(struct rad_bsdf *b, struct rad_arena *arena,
                        const struct xml_node *layer, struct rad_error *err);

/* The index of the text of n's element `kid` among the names, in any case; -1:
 * it is none of them. */
int rad_bsdf_which(const struct xml_node *n, const char *kid,
                   const char *const name[], int nnames);

/* The part that a data block of a file describes, or -1. */
int rad_bsdf_side(const struct xml_node *block);

/* Fill w for light from v; w->part is set. */
void rad_matrix_look_from(struct rad_bsdf_way *w, const double v[3]);
void rad_tree_look_from(struct rad_bsdf_way *w, const double v[3]);

/* The scattered light of a part of this form.  xyz and *cell (not NULL) are
 * unchanged if the part has no value for `out`. */
void rad_matrix_value(const struct rad_bsdf_way *w, const double out[3],
                      double xyz[3], double *cell);
void rad_tree_value(const struct rad_bsdf_way *w, const double in[3],
                    const double out[3], double xyz[3], double *cell);

/* Widen range to the cells that the light is scattered to. */
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
