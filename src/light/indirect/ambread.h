/* ambread.h - the ambient records of a frozen cache, laid out for reading
 *
 * With --ambient=passes nothing reads the cache while it changes.  So records
 * are first added, and then, before the next look-up, settled: put into trees
 * whose leaves list all that a look-up there can want (see ambread.c).
 * Thread: any number may visit and list at once, none while another adds or
 * settles.  */
#ifndef RAD_LIGHT_AMBREAD_H
#define RAD_LIGHT_AMBREAD_H

#include "light/indirect/ambcache.h"

struct rad_ambread_tree;

/* The glint of a record that has one. */
struct rad_ambread_glint {
    uint32_t item; /* whose it is, rising */
    struct rad_glint glint;
};

struct rad_ambread {
    double org[3], side;      /* of the cube that the records are in */
    struct rad_ambitem *item; /* in the order in which they were added */
    size_t n, cap;
    struct rad_ambread_glint *glint;
    size_t nglints, glint_cap;
    size_t settled;                /* of n: the rest is not in the trees yet */
    struct rad_ambread_tree *tree; /* by bounces and face; NULL: none yet */
};

void rad_ambread_init(struct rad_ambread *r, const double org[3], double side);
void rad_ambread_release(struct rad_ambread *r);

/* Add a copy of *rec, which must be sound, as rad_ambcache_insert() wants it.
 * False: out of memory. */
bool rad_ambread_add(struct rad_ambread *r, const struct rad_ambrec *rec);

/* Make trees anew where records have been added.  zone(arg, item) tells where a
 * record may serve, the same at each call.  False: out of memory; then some
 * records are not found, and the next call tries again. */
typedef struct rad_ambzone rad_ambread_zone_fn(const void *arg,
                                               const struct rad_ambitem *item);
bool rad_ambread_settle(struct rad_ambread *r, rad_ambread_zone_fn *zone,
                        const void *arg);

/* As rad_ambcache_visit(), of records that are settled, and of these of the
 * first `before` that were added.  In which order they come depends on these
 * and the order of their adding alone. */
void rad_ambread_visit(const struct rad_ambread *r, size_t before,
                       const struct rad_ambquery *q, rad_ambcache_fn *fn,
                       rad_ambcache_more_fn *more, void *arg);

/* Copy records from position *cursor on, in the order of their adding, at most
 * max, and move the cursor. */
size_t rad_ambread_list(const struct rad_ambread *r, uint64_t *cursor,
                        struct rad_ambrec *out, size_t max);

/* Bytes that it has taken. */
size_t rad_ambread_bytes(const struct rad_ambread *r);

#endif
