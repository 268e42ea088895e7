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

/* Add a copy of *rec, whose zone extends no farther than `reach` from rec->p.
 * False: out of memory. */
bool rad_ambcache_insert(struct rad_ambcache *c, const struct rad_ambrec *rec,
                         double reach, bool local);

/* Call fn with every record whose zone may include p, smallest cells first:
 * the cell with the smallest zones, then the one about it, and so on.  After
 * each cell, `more` is told its side and says whether larger ones are wanted.
 */
typedef void rad_ambcache_fn(void *arg, const struct rad_ambrec *rec);
typedef bool rad_ambcache_more_fn(void *arg, double side);
void rad_ambcache_visit(const struct rad_ambcache *c, const double p[3],
                        rad_ambcache_fn *fn, rad_ambcache_more_fn *more,
                        void *arg);

/* Copy records from the log, from position *cursor on, at most max, and move
 * the cursor; with local_only, those alone that were inserted as local.  Stops
 * before a record that is still being written.  Position 0 is the start. */
size_t rad_ambcache_read(const struct rad_ambcache *c, uint64_t *cursor,
                         bool local_only, struct rad_ambrec *out, size_t max);

/* Records inserted so far. */
size_t rad_ambcache_count(const struct rad_ambcache *c);

#endif
