/* rowsum.h - sums of rows, which show whether rows are what they were
 *
 * Quick, not safe from forgery: rows that differ by chance have other sums.
 * Thread: any. */
#ifndef DAEMON_ROWSUM_H
#define DAEMON_ROWSUM_H

#include <stddef.h>
#include <stdint.h>

/* The hash of n bytes; never 0. */
uint64_t rowsum_hash(const void *bytes, size_t n);

/* The sum of rows from picture row y on, of n bytes each.  The sum of all rows
 * is the exclusive or of the sums of their parts.  Below 2^63, for a database
 * keeps signed numbers. */
uint64_t rowsum(const void *pixels, size_t n, uint32_t y, uint32_t rows);

#endif
