/* facts.h - the traced pixels of one line of a picture
 *
 * A line is a base line with the bar above it (quincunx.h), in rows from the
 * top; the base line is the last row, and the only one of line 0.  A fact is
 * the value of a pixel that was traced, before anything is painted.  A pixel is
 * a function of the picture and its place, so a fact is true whatever it was
 * traced for: a guess of what the sampler will need, another worker's work on
 * the same line, an estimate.  Facts may come in any order and twice; the first
 * is kept.  A pixel that the view does not show is not kept, for finding that
 * out again is cheaper.
 * Each fact knows whether it was used, that is, whether the sampler asked for
 * it once all that its decision depends on was known.  So rays traced for
 * nothing can be counted.
 * Thread: get, use, put, import and the counts from any thread, without locks;
 * export and settle from one thread at a time. */
#ifndef RAD_PICTURE_FACTS_H
#define RAD_PICTURE_FACTS_H

#include "picture/quincunx.h"

struct rad_facts;

/* Where a fact comes from, and whether it was used; or'ed. */
enum {
    RAD_FACT_USED = 1,     /* set by rad_facts_use() */
    RAD_FACT_ESTIMATE = 4, /* traced for an estimate: never counted as unused */
    RAD_FACT_FOREIGN = 8   /* from another worker: never exported */
};

/* A line of this size, without facts.  NULL: memory is out. */
struct rad_facts *rad_facts_new(int width, int rows);
void rad_facts_free(struct rad_facts *f);

int rad_facts_rows(const struct rad_facts *f);

/* Get a pixel; false, and *out untouched, if it is not known. */
bool rad_facts_get(const struct rad_facts *f, int x, int row,
                   struct rad_pixel *out);

/* Get a pixel as rad_facts_get() does, and mark the fact used. */
bool rad_facts_use(struct rad_facts *f, int x, int row, struct rad_pixel *out);

/* Keep a pixel; false: it is known already, or another thread is putting it. */
bool rad_facts_put(struct rad_facts *f, int x, int row,
                   const struct rad_pixel *p, unsigned origin);

/* Facts that were not used, other than for estimates: once the line is done,
 * rays traced for nothing. */
size_t rad_facts_unused(const struct rad_facts *f);

/* How often a pixel was traced here, not for an estimate, and then found to be
 * known, since the last rad_facts_settle(). */
size_t rad_facts_late(const struct rad_facts *f);

/* rad_facts_late(), plus facts made here that also came from another worker, so
 * were traced twice.  Facts that export has given do not count: another worker
 * may just have sent them back.  Thread: as export. */
size_t rad_facts_doubled(const struct rad_facts *f);

/* Facts made here that export has not given yet, estimates included: an upper
 * bound. */
size_t rad_facts_fresh(const struct rad_facts *f);

/* Bytes of one row of a bitmap; column x is bit x % 8 of byte x / 8, bit 0
 * being the lowest. */
size_t rad_facts_stride(int width);

/* Facts of rows [row, row + n) as they travel: a bitmap (n * stride bytes, row
 * after row) has a bit for each, and in the order of the bits come `channels`
 * floats for each: 3, or 4 with z. */
struct rad_fact_rows {
    int row, n, channels;
    unsigned origin; /* exported: of estimates (RAD_FACT_ESTIMATE), or others
                      * (0); imported: as rad_facts_put() has it */
};

/* Export facts that were made here and never exported.  pixels has room for
 * n * width facts.  Returns the number of bits. */
size_t rad_facts_export(struct rad_facts *f, const struct rad_fact_rows *of,
                        uint8_t *bitmap, float *pixels);

/* Treat all facts as exported, and reset rad_facts_late(): no other worker
 * needs them any more.  Thread: as export. */
void rad_facts_settle(struct rad_facts *f);

/* Import what another worker exported; npixels is the number of facts in
 * pixels.  Values that are not finite or are negative are left out.
 * RAD_EPROTO, with nothing imported: rows outside the line, channels not 3 or
 * 4, bits beyond the width, or not npixels bits. */
int rad_facts_import(struct rad_facts *f, const struct rad_fact_rows *of,
                     const uint8_t *bitmap, const float *pixels,
                     size_t npixels);

#endif
