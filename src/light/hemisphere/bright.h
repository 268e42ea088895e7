/* bright.h - bright places of a scene, as the records of a frozen cache saw
 * them
 *
 * A sun patch, a lamp's spot, the image of either in a mirror: little of what a
 * hemisphere sees, and most of its noise.  A record keeps one place that was
 * far brighter than its hemisphere's mean, its glint, drawn by how much
 * brighter; glints travel with records.  Between passes those of all records
 * are gathered by cells of a grid into places, each with a mean point and
 * luminance and an area.  A new record's hemisphere (hemisphere.h) then knows
 * in which of its own cells they lie, before it traces a ray.
 * Thread: any may read, none while another gathers. */
#ifndef RAD_LIGHT_BRIGHT_H
#define RAD_LIGHT_BRIGHT_H

#include "light/hemisphere/glint.h"
#include "light/hemisphere/hemisphere.h"
#include "light/sample/contrast.h"

/* Most places that are kept: those that most records chose. */
#define RAD_BRIGHT_MOST 512

/* A place that brings less than this over the mean of them is left out. */
#define RAD_BRIGHT_DIM .25

struct rad_bright_place {
    double p[3];  /* mean point */
    double lum;   /* mean luminance of its radiance [W/sr/m^2] */
    double area;  /* about, as seen from anywhere [unit^2] */
    double reach; /* of a square that may hold it, about [unit^2] */
};

struct rad_bright {
    struct rad_bright_place place[RAD_BRIGHT_MOST];
    size_t n;
    double cell; /* side of the cells of the grid [unit] */
};

/* Gather the glints of n records, in a scene whose cube has its corner at org
 * and that side.  What comes out depends on these and their order alone.
 * False: out of memory. */
bool rad_bright_gather(struct rad_bright *b, const struct rad_glint *glint,
                       size_t n, const double org[3], double side);

/* The glint of a record at p: what a cell's first ray met, drawn by how far it
 * is above the mean; `key` is that of the ray that asked for the record. */
struct rad_glint rad_bright_glint(const struct rad_hemi *h, const double p[3],
                                  uint64_t key);

/* Look at the first n places from p: share[i] gets what part of the
 * hemisphere's square a unit of area at place i has [1/unit^2], 0 if it is
 * below the horizon. */
void rad_bright_look(const struct rad_bright *b, size_t n,
                     const struct rad_hemi *h, const double p[3],
                     double *share);

/* Where in the hemisphere's square a place is. */
void rad_bright_where(const struct rad_bright_place *q,
                      const struct rad_hemi *h, const double p[3],
                      double at[2]);

/* Add to cell[k].square the mean square of the luminance that all places but
 * the dim ones are expected to bring to cell k of a hemisphere at p; share is
 * of rad_bright_look(), of all places. */
void rad_bright_cells(const struct rad_bright *b, const struct rad_hemi *h,
                      const double p[3], const double *share,
                      struct rad_contrast *cell);

#endif
