/* ambread.h - the ambient records of a frozen cache, laid out for reading
 *
 * With --ambient=passes records come many at a time.  They are added first, and
 * then settled: put into trees, each leaf of which lists all records that may
 * serve there (ambread_impl.h).
 * Growth: what visits read is never changed.  A settling makes new trees, which
 * share with the former all that stays the same, and records that need more
 * room get it elsewhere.  What only former trees had is freed when no visit can
 * be at it (rad_ambread_settle_begin()).
 * Thread: one at a time adds, settles or lists; meanwhile any number may visit.
 */
#ifndef RAD_LIGHT_AMBREAD_H
#define RAD_LIGHT_AMBREAD_H

#include "light/record/ambcache.h"

struct rad_ambread_trees;
struct rad_ambread_settling;

/* The glint of a record that has one. */
struct rad_ambread_glint {
    uint32_t item; /* index of the record */
    struct rad_glint glint;
};

struct rad_ambread {
    double org[3], side;      /* of the cube that the records are in */
    struct rad_ambitem *item; /* in the order in which they were added; visits
                               * may have a shorter array */
    size_t n, cap;
    struct rad_ambread_glint *glint; /* in the order of records */
    size_t nglints, glint_cap;
    size_t settled; /* so many records are in the trees */
    _Atomic(struct rad_ambread_trees *) trees; /* that visits read; NULL: none
                                                * yet */
    struct rad_ambread_trees *oldest; /* that are not freed, and behind them
                                       * all that were made since */
    uint32_t settlings;               /* so many were begun */
    struct rad_ambread_settling *settling; /* NULL: none is under way */
};

void rad_ambread_init(struct rad_ambread *r, const double org[3], double side);
void rad_ambread_release(struct rad_ambread *r);

/* Add a copy of *rec, which must be sound, as rad_ambcache_insert() wants it.
 * False: out of memory. */
bool rad_ambread_add(struct rad_ambread *r, const struct rad_ambrec *rec);

/* Settle: put the records that were added into the trees, by several threads
 * and beside visits.  Begin, which returns a number of pieces; make each of
 * these once; end.  zone(arg, item) is a record's zone, the same at each call.
 * The end returns false if memory was out; then nothing may be added any more.
 * Visits find what was settled before, and then all.
 * When a settling begins the visits are over that were under way, or the tiles
 * that made them, when the RAD_AMBREAD_LATE-th settling before it ended; or,
 * if `alone`, all that began before.
 * Thread: one begins, and one ends; any number make pieces. */
typedef struct rad_ambzone rad_ambread_zone_fn(const void *arg,
                                               const struct rad_ambitem *item);
#define RAD_AMBREAD_LATE 3
size_t rad_ambread_settle_begin(struct rad_ambread *r, bool alone,
                                rad_ambread_zone_fn *zone, const void *arg);
void rad_ambread_settle_piece(struct rad_ambread *r, size_t piece);
bool rad_ambread_settle_end(struct rad_ambread *r);

/* Free what former trees had, and room for more records; no visit is under way,
 * and all records are settled. */
void rad_ambread_tighten(struct rad_ambread *r);

/* As rad_ambcache_visit(), for the first `before` records, which are settled.
 * The order in which they come depends on the records and on the order in which
 * they were added, on nothing else. */
void rad_ambread_visit(const struct rad_ambread *r, size_t before,
                       const struct rad_ambquery *q, rad_ambcache_fn *fn,
                       rad_ambcache_more_fn *more, void *arg);

/* Copy at most max records from position *cursor on, in the order in which they
 * were added, and move the cursor; returns their number. */
size_t rad_ambread_list(const struct rad_ambread *r, uint64_t *cursor,
                        struct rad_ambrec *out, size_t max);

/* The memory that r takes, but for what former trees had [bytes]. */
size_t rad_ambread_bytes(const struct rad_ambread *r);

#endif
