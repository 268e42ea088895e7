/* shelf.h - a base line that comes in pieces
 *
 * A piece is what a BASE_LINE has of the line: columns and densities, as bytes
 * of the wire.  Whoever sends a line begins at its beginning, and so does the
 * next sender when the first is gone; so a shelf holds the beginning of a line,
 * pieces that it has may come again, and a piece that would leave a gap is
 * dropped.
 * Growth: with what came, up to twice the line's size, within which the caller
 * sees to it that a piece lies (shelf_fits).
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

/* Does the piece lie within such a line? */
bool shelf_fits(const struct shelf_size *of, const struct msg_base_line *m);

/* Put a piece, which fits, to those that are there.  RAD_ENOMEM: the shelf is
 * as it was. */
int shelf_put(struct shelf *s, const struct msg_base_line *m);
bool shelf_is_whole(const struct shelf *s, const struct shelf_size *of);

/* The piece from column *x and density *first on, not wider than fits a
 * message: sets what m has of them, and *x and *first to what follows.  False:
 * there is nothing more.  Valid until the next call that changes the shelf. */
bool shelf_piece(const struct shelf *s, uint32_t *x, uint32_t *first,
                 struct msg_base_line *m);

/* Bytes that it holds. */
size_t shelf_bytes(const struct shelf *s);
void shelf_clear(struct shelf *s);

#endif
