/* coarse.h - a frame as a lattice of its pixels shows it, before its rows come
 *
 * While the ambient cache comes in passes, tiles tell the colours of their
 * pixels (passes/passplan.h): first of every 32nd along both axes, or fewer,
 * then of every 16th and every 8th.  A preview fills from these what rows have
 * not come of the frame, bilinear between four pixels of the lattice.  A
 * lattice that is only begun is filled in the same way from the coarser one.
 * Memory: five bytes for each pixel of the finest lattice, a bit for each of
 * the frame.
 * Thread: one at a time. */
#ifndef DAEMON_COARSE_H
#define DAEMON_COARSE_H

#include "machine/action.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct coarse;

/* Bytes that a frame of that size takes, and most of all frames together. */
size_t coarse_bytes(int width, int height);
#define COARSE_MOST ((size_t)256 << 20)

/* Nothing is known, and no row has come; NULL: memory is out. */
struct coarse *coarse_new(int width, int height);
void coarse_free(struct coarse *c);

/* Later colours take the place of earlier ones; false: they do not lie on the
 * lattice. */
bool coarse_put(struct coarse *c, const struct action_colours *k);

/* Pixels of the picture that have come: they are never filled. */
void coarse_mark(struct coarse *c, int x, int y, int width, int height);

/* Fill what has not come of row y, four bytes a pixel; what is not known by any
 * pixel near by stays as it is. */
void coarse_fill(struct coarse *c, int y, uint8_t *rgbe);

#endif
