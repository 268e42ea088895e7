/* ambcache.h - the store of ambient records: an octree and a log
 *
 * The octree finds the records whose zones may reach a point; the log holds
 * all of them in the order of their making, for the other workers.  What a
 * record means is ambient.c's.
 * Thread: any number may insert, visit and read the log at once; none ever
 * waits for another (see "Growth" in ambcache.c).  */
#ifndef RAD_LIGHT_AMBCACHE_H
#define RAD_LIGHT_AMBCACHE_H

#include "light/ambient.h"

struct rad_ambcache;

/* For points in the cube at org with this side. */
struct rad_ambcache *rad_ambcache_new(const double org[3], double side);
void rad_ambcache_free(struct rad_ambcache *c);

/* Bounds of the part of space in which a record may serve: beyond `reach` from
 * its point, beyond `height` before its plane and `behind` behind that, it does
 * not. */
struct rad_ambzone {
    double reach, height, behind;
};

/* Add a copy of *rec, which must be sound: finite, its normal near enough to
 * unit length.  False: out of memory. */
bool rad_ambcache_insert(struct rad_ambcache *c, const struct rad_ambrec *rec,
                         const struct rad_ambzone *zone, bool local);

/* What is asked for: records whose zone includes p, whose normal is within
 * that of n, and that were made at `level` bounces for a weight of `weight` at
 * least. */
struct rad_ambquery {
    double p[3], n[3];
    double min_cos; /* of the angle between the normals */
    int level;
    double weight; /* at most 4 */
};

/* Call fn with every record that meets the query, and with some that nearly do
 * (in the cube about the zone, and up to a seventh of its reach beyond): it
 * must look for itself.  Small zones come before large ones: `more` is told
 * how far those reach that were looked at, and says whether larger ones are
 * wanted, too.  Which records come does not depend on the order in which they
 * were inserted, but the order in which they come does. */
typedef void rad_ambcache_fn(void *arg, const struct rad_ambrec *rec);
typedef bool rad_ambcache_more_fn(void *arg, double reach);
void rad_ambcache_visit(const struct rad_ambcache *c,
                        const struct rad_ambquery *q, rad_ambcache_fn *fn,
                        rad_ambcache_more_fn *more, void *arg);

/* Copy records from the log, from position *cursor on, at most max, and move
 * the cursor; with local_only, those alone that were inserted as local.  Stops
 * before a record that is still being written.  Position 0 is the start. */
size_t rad_ambcache_read(const struct rad_ambcache *c, uint64_t *cursor,
                         bool local_only, struct rad_ambrec *out, size_t max);

/* Records inserted so far. */
size_t rad_ambcache_count(const struct rad_ambcache *c);

#endif
