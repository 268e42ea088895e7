/* facts.h - traced pixels of one line of a picture, whoever traced them
 *
 * A line is a base line with the bar above it (quincunx.h), in rows from the
 * top; the base line is the last row, the only one of line 0.  A fact is the
 * value of a pixel that a ray was traced for, before anything is painted.  A
 * pixel is a function of the picture and its place, so a fact is true whatever
 * made one trace it: a guess of what the sampler will want, another worker at
 * the same line, an estimate.  Facts may come in any order and twice; the
 * first is kept.  A pixel that the view does not show is no fact: to ask again
 * is cheaper than to remember.
 * Each fact knows whether it was used, that is, whether the sampler wanted it
 * when all that it depends on was known; so what was traced for nothing can be
 * counted.
 * Thread: get, use, put, import and the counts from any, without locks; export
 * and settle from one thread at a time. */
#ifndef RAD_PICTURE_FACTS_H
#define RAD_PICTURE_FACTS_H

#include "picture/quincunx.h"

struct rad_facts;

/* Where a fact comes from, and what becomes of it; or'ed. */
enum {
    RAD_FACT_USED = 1,     /* as rad_facts_use() marks it */
    RAD_FACT_ESTIMATE = 4, /* traced for an estimate: never counted unused */
    RAD_FACT_FOREIGN = 8   /* from another worker: never exported */
};

/* No facts yet, for width columns and as many rows as the line has.  NULL:
 * memory is out. */
struct rad_facts *rad_facts_new(int width, int rows);
void rad_facts_free(struct rad_facts *f);

int rad_facts_rows(const struct rad_facts *f);

/* Is the pixel known?  *out is untouched if not. */
bool rad_facts_get(const struct rad_facts *f, int x, int row,
                   struct rad_pixel *out);

/* The same, and mark it used. */
bool rad_facts_use(struct rad_facts *f, int x, int row, struct rad_pixel *out);

/* Keep a pixel; false: it was known, or is being put by another thread. */
bool rad_facts_put(struct rad_facts *f, int x, int row,
                   const struct rad_pixel *p, unsigned origin);

/* Did another worker trace any of columns [x, x + width), rows [row, row + n)?
 * Not for an estimate. */
bool rad_facts_met(const struct rad_facts *f, int row, int n, int x, int width);

/* Facts that are there and nobody used, but for those of estimates: rays for
 * nothing, once the line is done. */
size_t rad_facts_unused(const struct rad_facts *f);

/* Times that a pixel was known when somebody here had traced it (not for an
 * estimate), until rad_facts_settle(). */
size_t rad_facts_late(const struct rad_facts *f);

/* rad_facts_late(), and facts made here that came from elsewhere as well, so
 * were traced twice, but for those that export gave: they may only have come
 * back.  By the exporter. */
size_t rad_facts_doubled(const struct rad_facts *f);

/* Facts that export has not given yet, of both kinds: an upper bound. */
size_t rad_facts_fresh(const struct rad_facts *f);

/* Bytes of a row of a bitmap; column x is bit x % 8, from the low end, of byte
 * x / 8. */
size_t rad_facts_stride(int width);

/* Give rows [row, row + n) of facts made here that no call gave before: those
 * of estimates (origin RAD_FACT_ESTIMATE) or the others (0).  Bits are set in
 * bitmap (n * stride bytes, row after row), and for each bit, in this order,
 * channels (3 or 4, with z) floats go to pixels (room for n * width of them).
 * Returns the number of bits. */
size_t rad_facts_export(struct rad_facts *f, int row, int n, int channels,
                        unsigned origin, uint8_t *bitmap, float *pixels);

/* Give nothing of what is there, and count none of it again: nobody has a use
 * for it any more.  Thread: as export. */
void rad_facts_settle(struct rad_facts *f);

/* Take what export gave elsewhere; npixels is how many there are in pixels.
 * What is not finite or negative is left out.  RAD_EPROTO, and nothing is
 * taken: the rows are not the line's, channels is not 3 or 4, the bitmap has
 * bits beyond the width, or another number of them. */
int rad_facts_import(struct rad_facts *f, int row, int n, int channels,
                     unsigned origin, const uint8_t *bitmap,
                     const float *pixels, size_t npixels);

#endif
