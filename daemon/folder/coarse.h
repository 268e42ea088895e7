/* coarse.h - a frame as a lattice of its pixels shows it, before its rows come
 *
 * While the ambient cache comes in passes, tiles tell the colours of their
 * pixels (passes/passplan.h): first of every 32nd along both axes, or fewer,
 * then of every 16th and every 8th.  A preview has these colours where rows
 * have not come, bilinear between four pixels of the lattice.  Pixels that a
 * lattice lacks are first filled in from the next coarser lattice.
 * Memory: five bytes for each pixel of the finest lattice, a bit for each pixel
 * of the frame.
 * Thread: one at a time. */
#ifndef DAEMON_COARSE_H
#define DAEMON_COARSE_H

#include "machine/action.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct coarse;

/* Bytes for a frame of that size; the most for all frames together. */
size_t coarse_bytes(int width, int height);
#define COARSE_MOST ((size_t)256 << 20)

/* Make an empty lattice of a frame without rows; NULL: memory is out. */
struct coarse *coarse_new(int width, int height);
void coarse_free(struct coarse *c);

/* Put colours, in place of earlier ones at the same points; false: they do not
 * lie on the lattice. */
bool coarse_put(struct coarse *c, const struct action_colours *k);

/* Note pixels that have come: coarse_fill() leaves them alone. */
void coarse_mark(struct coarse *c, int x, int y, int width, int height);

/* Fill the pixels of row y that have not come, four bytes of RGBE each; a pixel
 * with no known point around it stays as it is. */
void coarse_fill(struct coarse *c, int y, uint8_t *rgbe);

#endif
