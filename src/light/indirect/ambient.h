/* ambient.h - cache of indirect irradiance shared by the rays of one job
 *
 * A record keeps the indirect irradiance E and its gradients at one surface
 * point; nearby rays interpolate it instead of sampling the hemisphere again.
 * E is irradiance [W/m^2], not E/pi.  Points are double[3] in world space,
 * lengths in scene units, normals of unit length.
 * Growth: a live cache has append-only octrees (ambcache.c): readers never
 * wait, an insertion is a compare-and-swap on a list head, and records are
 * never moved or changed.  A frozen cache has an array of records, and trees
 * that are made anew where records come (ambread.h).
 * Sources: Ward, Rubinstein & Clear 1988 (record radius, error);
 *          Ward & Heckbert 1992 (gradients);
 *          Schwarzhaupt, Jensen & Jarosz 2012 (Hessian radii). */
#ifndef RAD_LIGHT_AMBIENT_H
#define RAD_LIGHT_AMBIENT_H

#include "light/record/ambrec.h"
#include "trace/ray.h"

struct rad_ambient;

/* Make an empty cache, which is live until rad_ambient_freeze(); *job must
 * outlive it.  NULL and *err on failure.
 * Thread: one thread makes and frees it; any number may find and insert. */
struct rad_ambient *rad_ambient_new(const struct rad_job *job,
                                    struct rad_error *err);
void rad_ambient_free(struct rad_ambient *amb);

/* Freeze the cache, before the first record.  A frozen cache changes by
 * rad_ambient_insert() and rad_ambient_insert_all() alone, while no thread
 * renders but tiles (ambtile.h), and the new records serve after the next
 * rad_ambient_settle().  A record that a place lacks is made for the tile that
 * asks (ambtile.h), or for that place alone. */
void rad_ambient_freeze(struct rad_ambient *amb);

/* Put the records of a frozen cache into the trees that look-ups read, while no
 * thread renders.  Does nothing for a live cache.  False: out of memory; then
 * nothing may be inserted any more. */
bool rad_ambient_settle(struct rad_ambient *amb);

/* The same for several threads, and beside tiles: begin, which returns a number
 * of pieces; make each of these once; end, with the result of
 * rad_ambient_settle().  The trees are the same, whoever makes which piece and
 * when.  When a settling begins the tiles are over that see a view older than
 * the last three; or, if `alone`, all that began before.
 * Thread: one begins, and one ends; any number make pieces. */
size_t rad_ambient_settle_begin(struct rad_ambient *amb, bool alone);
void rad_ambient_settle_piece(struct rad_ambient *amb, size_t piece);
bool rad_ambient_settle_end(struct rad_ambient *amb);

/* The state of a frozen cache after so many settlings, one of the last
 * RAD_AMBIENT_VIEWS: a tile (ambtile.h) sees the records of one such state
 * alone. */
#define RAD_AMBIENT_VIEWS 4
struct rad_ambview;
const struct rad_ambview *rad_ambient_view(const struct rad_ambient *amb,
                                           uint32_t settlings);

/* Smooth the records of a settled cache, while no thread renders: pixels see
 * smoothed values from now on (light/smooth/smooth.h), until records are
 * inserted, which no tile may be beside; rad_ambient_list() gives records as
 * they were made.  To be called when all records are there, and again after
 * insertions.  Does nothing for a live cache.  False: out of memory. */
bool rad_ambient_smooth(struct rad_ambient *amb);
bool rad_ambient_is_smooth(const struct rad_ambient *amb);

bool rad_ambient_is_frozen(const struct rad_ambient *amb);

/* The memory that the records of a frozen cache take, with their trees and
 * smoothed values [bytes]; 0 for a live cache. */
size_t rad_ambient_bytes(const struct rad_ambient *amb);

/* The cube that the records lie in: its corner and side. */
void rad_ambient_cube(const struct rad_ambient *amb, double org[3],
                      double *side);

/* Could radd have made this record in this scene?  It makes none outside of the
 * cube, where only sensor points can be. */
bool rad_ambient_fits(const struct rad_ambient *amb,
                      const struct rad_ambrec *rec);

/* Insert a record that came from another worker.  False: refused (it does
 * not fit, or memory is out); then the record is made again
 * where it is needed. */
bool rad_ambient_insert(struct rad_ambient *amb, const struct rad_ambrec *rec);

/* Insert n records, RAD_AMBIENT_TOGETHER at a time, which takes half as long as
 * one after the other; refused records are left out.  rec[] is overwritten. */
#define RAD_AMBIENT_TOGETHER 16
void rad_ambient_insert_all(struct rad_ambient *amb, struct rad_ambrec *rec,
                            size_t n);

/* Does the cache serve the place of *rec, which is not inserted yet?  For
 * counting how many records are redundant. */
bool rad_ambient_covers(const struct rad_ambient *amb,
                        const struct rad_ambrec *rec);

/* A place for which a ray wants indirect light. */
struct rad_ambplace {
    double p[3];   /* point on a surface */
    double err;    /* bound of its distance from the surface [scene units] */
    double n[3];   /* unit normal, on the side whose light is wanted */
    double pn[3];  /* the same normal, tilted by textures */
    int level;     /* diffuse bounces so far, 0 for a primary ray */
    double weight; /* of the ray, in (0, 1] */
};

/* Interpolate E at a place; *E is untouched on a miss.  Records of another
 * level, whose E holds more or fewer bounces, and records made for clearly
 * lighter rays do not serve.
 * Returns the summed record weight, 0 on a miss; cannot fail.  Takes no lock.
 *   counts  work of the rays that test for light leaks is added
 *   rays    the number of these rays is added */
double rad_ambient_find(const struct rad_ambient *amb,
                        const struct rad_ambplace *at, struct rad_rgb *E,
                        struct rad_geom_counts *counts, uint64_t *rays);

/* Does the cache serve the place, so that no record need be made there? */
bool rad_ambient_serves(struct rad_ctx *ctx, const struct rad_ambplace *at);

/* Copy records that this worker made since the last call, oldest first, at most
 * max; returns their number.  The loop thread sends them to the other workers.
 * Thread: one at a time. */
size_t rad_ambient_drain(struct rad_ambient *amb, struct rad_ambrec *out,
                         size_t max);

/* Copy at most max records, made here or received, from *cursor on (0: the
 * first), and move the cursor.  Returns their number, 0 at the end.  Any number
 * of cursors may be in use. */
size_t rad_ambient_list(const struct rad_ambient *amb, uint64_t *cursor,
                        struct rad_ambrec *out, size_t max);

/* The number of records.  Any thread may ask, even while others insert. */
size_t rad_ambient_count(const struct rad_ambient *amb);

/* Set *coef, a diffuse reflectance or transmittance at r's hit, to the radiance
 * that it makes of indirect light: *coef *= E / pi, on the side of unit normal
 * n.  With -ab 0, E / pi is -av. */
void rad_ambient_apply(struct rad_ctx *ctx, struct rad_ray *r,
                       const double n[3], struct rad_rgb *coef);

#endif
