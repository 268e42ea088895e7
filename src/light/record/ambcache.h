/* ambcache.h - the store of ambient records: an octree and a log
 *
 * The octree finds the records whose zones may reach a point; the log holds
 * all records in the order in which they were inserted, for the other workers.
 * What a record says of a place is computed in ambient_find.c.
 * Thread: any number may insert, visit and read the log at once; none ever
 * waits for another (see "Growth" in ambcache.c).  */
#ifndef RAD_LIGHT_AMBCACHE_H
#define RAD_LIGHT_AMBCACHE_H

#include "light/record/ambrec.h"

#include <stdbool.h>
#include <stddef.h>

struct rad_ambcache;

/* Make a cache for records in the cube with corner org and this side; points
 * outside count as on its face.  few: not many records are expected, so memory
 * is allocated in small pieces.  NULL: out of memory. */
struct rad_ambcache *rad_ambcache_new(const double org[3], double side,
                                      bool few);
void rad_ambcache_free(struct rad_ambcache *c);

/* Bounds of a record's zone, the part of space in which it may serve [scene
 * units]: half an ellipsoid before the surface, with the half-axes `reach`
 * along n x u and `height` along n and u; and the part of the other half that
 * is at most `behind` deep. */
struct rad_ambzone {
    double reach, height, behind;
};

/* A record as it is kept for look-ups; fields as of struct rad_ambrec.  The
 * glint is kept apart, since few records have one. */
struct rad_ambitem {
    double p[3];
    float n[3], u[3], radius[2], weight;
    uint16_t level;
    struct rad_rgb E;
    float gpos[2], gdir[2], var;
    uint32_t corral;
};

/* Set *item from *rec. */
void rad_ambitem_set(struct rad_ambitem *item, const struct rad_ambrec *rec);
/* Set *rec from *item; glint NULL: the record has none. */
void rad_ambitem_get(const struct rad_ambitem *item,
                     const struct rad_glint *glint, struct rad_ambrec *rec);

/* n x u, the axis of radius[1]. */
static inline void
rad_ambitem_across(const struct rad_ambitem *item, float across[3])
{
    const float *n = item->n, *u = item->u;

    across[0] = n[1] * u[2] - n[2] * u[1];
    across[1] = n[2] * u[0] - n[0] * u[2];
    across[2] = n[0] * u[1] - n[1] * u[0];
}

/* Add a copy of *rec, which must be sound: finite, its normal of about unit
 * length.  local: the record was made by this worker.  False: out of memory. */
bool rad_ambcache_insert(struct rad_ambcache *c, const struct rad_ambrec *rec,
                         const struct rad_ambzone *zone, bool local);
/* Add copies of n records, as rad_ambcache_insert() does, but faster than one
 * after the other. */
bool rad_ambcache_insert_all(struct rad_ambcache *c,
                             const struct rad_ambrec *rec,
                             const struct rad_ambzone *zone, size_t n,
                             bool local);

/* How far records may differ from a query; made once for many look-ups. */
struct rad_ambfit {
    double sine;          /* of the angle between the normals; above 1: any */
    uint8_t turn, weight; /* the limits as bytes: struct probe's */
};

/* Let records fit whose normal has at least the cosine min_cos to the query's
 * normal, and whose weight is at least the lesser of `weight` and 1.27. */
void rad_ambfit_set(struct rad_ambfit *fit, double min_cos, double weight);

/* A query for records whose zone includes p, whose normal and weight fit, and
 * that were made at `level` bounces. */
struct rad_ambquery {
    double p[3], n[3];
    int level;
    const struct rad_ambfit *fit;
};

/* Call fn with every record that meets the query, some at a time, and also with
 * records that nearly do (p is in the cube about the zone, or beyond it by up
 * to a seventh of its reach), so fn must test each.  If fn returns false it
 * wants no more records, but may still be called.
 * Small zones come before large zones.  Between sizes `more` is called with the
 * least reach [scene units] of the zones that come next, and says whether they
 * are wanted.
 * Which records come does not depend on the order of insertion; the order in
 * which they come does. */
typedef bool rad_ambcache_fn(void *arg, const struct rad_ambitem *const *found,
                             int n);
typedef bool rad_ambcache_more_fn(void *arg, double reach);
void rad_ambcache_visit(const struct rad_ambcache *c,
                        const struct rad_ambquery *q, rad_ambcache_fn *fn,
                        rad_ambcache_more_fn *more, void *arg);

/* Copy at most max records from the log, from position *cursor on (0: the
 * start), and move the cursor; local_only: only records that were inserted as
 * local.  Returns their number.  Stops before a record that is being written.
 */
size_t rad_ambcache_read(struct rad_ambcache *c, uint64_t *cursor,
                         bool local_only, struct rad_ambrec *out, size_t max);

/* The number of records inserted so far. */
size_t rad_ambcache_count(const struct rad_ambcache *c);

#endif
