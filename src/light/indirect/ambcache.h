/* ambcache.h - the store of ambient records: an octree and a log
 *
 * The octree finds the records whose zones may reach a point; the log holds
 * all of them in the order of their making, for the other workers.  What a
 * record means is ambient_find.c's.
 * Thread: any number may insert, visit and read the log at once; none ever
 * waits for another (see "Growth" in ambcache.c).  */
#ifndef RAD_LIGHT_AMBCACHE_H
#define RAD_LIGHT_AMBCACHE_H

#include "light/indirect/ambient.h"

struct rad_ambcache;

/* For points in the cube at org with this side; those outside count as on its
 * face.  `few` are expected, in the end, or many. */
struct rad_ambcache *rad_ambcache_new(const double org[3], double side,
                                      bool few);
void rad_ambcache_free(struct rad_ambcache *c);

/* Bounds of the part of space in which a record may serve: half an ellipsoid,
 * with `reach` as its axis across (n x u) and `height` as those along n and u,
 * and what of the other half is less than `behind` deep. */
struct rad_ambzone {
    double reach, height, behind;
};

/* A record as it is kept for look-ups: all but its glint, which few have. */
struct rad_ambitem {
    double p[3];
    float n[3], u[3], radius[2], weight;
    uint16_t level;
    struct rad_rgb E;
    float gpos[2], gdir[2], var;
    uint32_t corral;
};

void rad_ambitem_set(struct rad_ambitem *item, const struct rad_ambrec *rec);
/* The record again; glint may be NULL, for none. */
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

/* Add a copy of *rec, which must be sound: finite, its normal near enough to
 * unit length.  False: out of memory. */
bool rad_ambcache_insert(struct rad_ambcache *c, const struct rad_ambrec *rec,
                         const struct rad_ambzone *zone, bool local);
/* The same for n of them, which is faster than one after the other. */
bool rad_ambcache_insert_all(struct rad_ambcache *c,
                             const struct rad_ambrec *rec,
                             const struct rad_ambzone *zone, size_t n,
                             bool local);

/* How records may differ from what is asked for: the same for many look-ups. */
struct rad_ambfit {
    double sine;          /* of the angle between the normals; above 1: any */
    uint8_t turn, weight; /* see ambcache_find.c */
};

/* Normals with a cosine of min_cos at least, weights that are no less than
 * `weight`, which counts as 1.27 beyond that. */
void rad_ambfit_set(struct rad_ambfit *fit, double min_cos, double weight);

/* What is asked for: records whose zone includes p, whose normal fits that of
 * n, and that were made at `level` bounces for a weight that fits. */
struct rad_ambquery {
    double p[3], n[3];
    int level;
    const struct rad_ambfit *fit;
};

/* Call fn with every record that meets the query, some at a time, and with some
 * that nearly do (in the cube about the zone, and up to a seventh of its reach
 * beyond): it must look for itself.  False: no more are wanted, though some may
 * come.  Small zones come before large ones: `more` is told how far those reach
 * that were looked at, and says whether larger ones are wanted, too.  Which
 * records come does not depend on the order in which they were inserted, but
 * the order in which they come does. */
typedef bool rad_ambcache_fn(void *arg, const struct rad_ambitem *const *found,
                             int n);
typedef bool rad_ambcache_more_fn(void *arg, double reach);
void rad_ambcache_visit(const struct rad_ambcache *c,
                        const struct rad_ambquery *q, rad_ambcache_fn *fn,
                        rad_ambcache_more_fn *more, void *arg);

/* Copy records from the log, from position *cursor on, at most max, and move
 * the cursor; with local_only, those alone that were inserted as local.  Stops
 * before a record that is still being written.  Position 0 is the start. */
size_t rad_ambcache_read(struct rad_ambcache *c, uint64_t *cursor,
                         bool local_only, struct rad_ambrec *out, size_t max);

/* Records inserted so far. */
size_t rad_ambcache_count(const struct rad_ambcache *c);

#endif
