/* shelf.h - a base line that comes in pieces
 *
 * A piece is the part of a line in a BASE_LINE: columns and densities, as bytes
 * of the wire.  A sender begins at the line's beginning, and so does the next
 * sender when the first is gone.  So a shelf holds the beginning of a line;
 * pieces that it has may come again, and a piece that would leave a gap is
 * dropped.
 * Growth: with the pieces, up to twice the line's size; the caller makes sure
 * that each piece lies in the line (shelf_fits).
 * Thread: one. */
#ifndef DAEMON_SHELF_H
#define DAEMON_SHELF_H

#include "proto/message.h"

/* The size of the lines of a frame. */
struct shelf_size {
    uint32_t width, ndensity;
    uint8_t channels; /* of a pixel, 3 or 4 */
};

/* All zero: empty. */
struct shelf {
    uint32_t nx, nd;  /* columns and densities that are there */
    uint8_t channels; /* of a pixel; 0: nothing came */
    uint8_t *pixels, *density;
    size_t pixels_room, density_room; /* [bytes] */
};

/* Does the piece lie within a line of that size? */
bool shelf_fits(const struct shelf_size *of, const struct msg_base_line *m);

/* Copy a piece that fits onto the shelf.  RAD_ENOMEM: nothing is copied. */
int shelf_put(struct shelf *s, const struct msg_base_line *m);
bool shelf_is_whole(const struct shelf *s, const struct shelf_size *of);

/* Set m's columns and densities to the piece from column *x and density *first
 * on, as wide as fits a message, and *x and *first to the piece behind it.
 * False: the shelf has nothing there.  m points into the shelf, and is valid
 * until that changes. */
bool shelf_piece(const struct shelf *s, uint32_t *x, uint32_t *first,
                 struct msg_base_line *m);

/* Bytes of memory that the shelf takes. */
size_t shelf_bytes(const struct shelf *s);
void shelf_clear(struct shelf *s);

#endif
