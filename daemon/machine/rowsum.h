/* rowsum.h - sums of rows, by which two that should be the same are told apart
 *
 * Quick rather than safe from forgery: what differs by chance differs here.
 * Thread: any. */
#ifndef DAEMON_ROWSUM_H
#define DAEMON_ROWSUM_H

#include <stddef.h>
#include <stdint.h>

/* Of n bytes; never 0. */
uint64_t rowsum_hash(const void *bytes, size_t n);

/* Of rows from picture row y on, of n bytes each.  Sums of pieces are those of
 * the whole when they are put together by exclusive or; below 2^63, as a
 * database keeps numbers. */
uint64_t rowsum(const void *pixels, size_t n, uint32_t y, uint32_t rows);

#endif
