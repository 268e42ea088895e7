/* bright.h - bright places of a scene, found by the records of a frozen cache
 *
 * A sun patch, a lamp's spot, or the image of either in a mirror fills little
 * of a hemisphere and makes most of its noise.  A record keeps a glint: the
 * place and luminance of one hit that is far brighter than the mean of the
 * record's hemisphere, drawn with a probability in proportion to its excess.
 * Glints travel with records.  Between passes the glints of all records are
 * gathered by the cells of a grid into places, each with a mean point, a mean
 * luminance and an area.  Before a new hemisphere (hemisphere.h) traces a ray
 * it looks up in which of its own cells these places lie.
 * Thread: any thread may read, but not while another gathers. */
#ifndef RAD_LIGHT_BRIGHT_H
#define RAD_LIGHT_BRIGHT_H

#include "light/hemisphere/glint.h"
#include "light/hemisphere/hemisphere.h"
#include "light/sample/contrast.h"

/* At most so many places are kept: those with most glints. */
#define RAD_BRIGHT_MOST 512

/* A place is left out if it is expected to bring less than this part of the
 * mean over all places. */
#define RAD_BRIGHT_DIM .25

struct rad_bright_place {
    double p[3];  /* mean point */
    double lum;   /* mean luminance of its radiance [W/sr/m^2] */
    double area;  /* estimated, as if the place faced every point [unit^2] */
    double reach; /* estimated area of a square that holds the place [unit^2] */
};

struct rad_bright {
    struct rad_bright_place place[RAD_BRIGHT_MOST];
    size_t n;
    double cell; /* side of the cells of the grid [unit] */
};

/* Gather the glints of n records into *b; the cube that the grid is for, the
 * scene's or a part of it, has its corner at org and this side.  The result
 * depends on the arguments alone, among them the order of the glints.  False:
 * out of memory. */
bool rad_bright_gather(struct rad_bright *b, const struct rad_glint *glint,
                       size_t n, const double org[3], double side);

/* The glint of a record at p: the end of a cell's first ray, drawn by how far
 * its luminance is above a limit (bright.c, FAR_ABOVE); lum is 0 if no first
 * ray is above the limit.  `key` is that of the ray that asked for the record.
 */
struct rad_glint rad_bright_glint(const struct rad_hemi *h, const double p[3],
                                  uint64_t key);

/* Look at the first n places from p: share[i] gets the part of the hemisphere's
 * square that a unit of area at place i fills [1/unit^2]; 0 if the place is
 * below the horizon. */
void rad_bright_look(const struct rad_bright *b, size_t n,
                     const struct rad_hemi *h, const double p[3],
                     double *share);

/* The point `at` of the hemisphere's square where place q is seen from p. */
void rad_bright_where(const struct rad_bright_place *q,
                      const struct rad_hemi *h, const double p[3],
                      double at[2]);

/* Add to each cell's square (contrast.h) the mean square of the luminance that
 * places in that cell of a hemisphere at p are expected to bring; dim places
 * (RAD_BRIGHT_DIM) are left out.  share: of all places, as rad_bright_look()
 * sets it. */
void rad_bright_cells(const struct rad_bright *b, const struct rad_hemi *h,
                      const double p[3], const double *share,
                      struct rad_contrast *cell);

#endif
