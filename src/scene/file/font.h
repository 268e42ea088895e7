/* font.h - letters as polygons, and setting them in a line
 *
 * A font file lists glyphs, each a character code (1 to 255), a number of
 * vertices and that many pairs x y, integers from 0 to 255 in a square cell
 * with the origin at its lower left; # starts a comment.  A glyph is the
 * region inside its polygon by the even-odd rule; one without vertices is a
 * space.
 * Lengths in a line of text are in the same unit, 255 to the height of a line.
 * Source: Radiance's font files (helvet.fnt, hexbit4x1.fnt) and the spacing
 * argument of "brighttext" in its reference manual. */
#ifndef RAD_SCENE_FONT_H
#define RAD_SCENE_FONT_H

#include "base/arena.h"
#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct rad_glyph {
    int32_t nverts;
    uint8_t left, right, bottom, top; /* bounds, of its middle, too */
    uint8_t (*vert)[2];               /* x, y */
};

struct rad_font {
    int mean_width;               /* of glyphs that have a width */
    struct rad_glyph *glyph[256]; /* by character; NULL: none */
};

/* A line of text that is set: glyph i of n begins at start[i].  reach[i] is the
 * largest of start[0..i], so that a place can be found by bisection even though
 * a squeezed letter may begin before its neighbour. */
struct rad_textline {
    int32_t n;
    int32_t width;
    const struct rad_glyph **glyph; /* [n], NULL: the font has none */
    int32_t *start, *reach;         /* [n] */
};

#define RAD_FONT_MAX_VERTS 32000

/* Parse a font file's text into arena.  NULL and *err (RAD_EDATA with the line,
 * RAD_ENOMEM) on failure. */
struct rad_font *rad_font_parse(struct rad_arena *arena, const char *text,
                                size_t len, struct rad_error *err);

/* Is (x, y) inside the glyph? */
bool rad_glyph_inside(const struct rad_glyph *g, double x, double y);

/* Set text[0..len), with a spacing between letters:
 *   0    each letter in a cell of 255
 *   > 0  proportional, with that space between letters, words in columns
 *   < 0  squeezed together to that space, without columns
 * Returns 0, RAD_EDATA (too long) or RAD_ENOMEM. */
int rad_textline_set(struct rad_textline *line, const struct rad_font *font,
                     struct rad_arena *arena, const char *text, size_t len,
                     int spacing, struct rad_error *err);

/* Is (x, y) inside a letter of the line?  y is 0 at the bottom of the line. */
bool rad_textline_inside(const struct rad_textline *line, double x, double y);

#endif
