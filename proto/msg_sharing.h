/* msg_sharing.h - the messages by which workers share the lines of a picture
 *
 * Line i of a frame is base line i (quincunx.h) and the bar above it: the rows
 * from the one below base line i-1 to base line i; line 0 is row 0 alone.  A
 * strict unit is some lines of one frame, in full width.  Its top is the base
 * line above its lines, its bottom its own last base line.
 * A fact is the value of a pixel that was traced with a ray, before painting.
 * Facts depend on the pixel alone: they may come in any order, twice, or never.
 * Thread: a struct belongs to one thread. */
#ifndef MSG_SHARING_H
#define MSG_SHARING_H

#include "proto/msg_basics.h"

enum msg_mode {
    MSG_MODE_WINDOW, /* sampled by itself */
    MSG_MODE_STRICT, /* lines of the whole frame */
    MSG_NMODE
};

/* MSG_UNIT_TOP: no worker has the base line above this unit; trace that line
 * first, and send it as FACTS. */
#define MSG_UNIT_TOP   (1u << 0)
#define MSG_UNIT_FLAGS 1u /* all of them */

/* x, y: the top left pixel, y from the picture's top. */
struct msg_unit {
    const uint8_t *job;
    uint32_t unit, attempt;
    uint32_t frame; /* index into the job's frames */
    uint32_t x, y, width, height;
    uint8_t mode;  /* enum msg_mode */
    uint8_t flags; /* MSG_UNIT_...; none with MSG_MODE_WINDOW */
};

#define MSG_FACTS_ESTIMATE (1u << 0) /* traced for an estimate */
#define MSG_FACTS_FLAGS    1u        /* all of them */

#define MSG_MAX_LINE_ROWS 32 /* most rows of a line */

/* Facts of one line.  Pixels outside the view need no ray and are not facts. */
struct msg_facts {
    const uint8_t *job;
    uint32_t frame, line;
    uint32_t row, rows; /* row counts from the line's top; a bar's rows come
                         * first, the base line last */
    uint32_t width;     /* of the picture */
    uint8_t flags;      /* MSG_FACTS_... */
    uint8_t channels;   /* 3 or 4, as in a RESULT */
    /* (width + 7) / 8 bytes for each row: pixel x is 1 << x % 8 of byte x / 8;
     * bits past the width are 0 */
    const uint8_t *bitmap;
    const uint8_t *pixels; /* channels floats for each bit that is set */
    uint32_t npixels;      /* bits that are set; counted by unpacking */
};

/* A piece of a base line that is true, sent as soon as it is made. */
struct msg_base_line {
    const uint8_t *job;
    uint32_t frame, line;
    uint32_t x, n;            /* columns of pixels */
    uint32_t first, ndensity; /* densities */
    uint8_t channels;         /* 3 or 4 */
    const uint8_t *density;
    const uint8_t *pixels; /* as in the picture: n * channels floats */
};

/* The densities after a base line, as its worker guesses them while its unit's
 * top is not there: with them the unit below can trace ahead what its own guess
 * would miss. */
struct msg_guess {
    const uint8_t *job;
    uint32_t frame, line;
    uint8_t known; /* how many lines the densities follow from, at least 1 */
    uint32_t ndensity;
    const uint8_t *density; /* of the whole line */
};

/* Which worker waits for a base line. */
struct msg_next_holder {
    const uint8_t *job;
    uint32_t frame, line;
    const char *name; /* empty: none */
};

/* GAVE: how many rows the unit keeps after SPLIT or YIELD.  STILL: how many
 * rows the unit has at a worker that comes back. */
struct msg_gave {
    const uint8_t *job;
    uint32_t unit, attempt;
    uint32_t height; /* rows from now on.  In a GAVE the height as before means
                      * that no row was given away, 0 that all were */
};

#endif
