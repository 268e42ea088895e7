/* msg_sharing.h - the messages by which workers share the lines of a picture
 *
 * Line i of a frame stands for base line i (quincunx.h) and the bar above it:
 * the rows from the one below base line i-1 to that of base line i; line 0 is
 * row 0 alone.  A strict unit is whole lines of one frame, as wide as it; its
 * top is the base line above it, its bottom the last of its own.
 * A fact is the value of a pixel that was traced with a ray, before painting.
 * Facts are pure: they may come in any order, twice, or never.
 * Thread: a struct belongs to one thread. */
#ifndef MSG_SHARING_H
#define MSG_SHARING_H

#include "proto/msg_basics.h"

enum msg_mode {
    MSG_MODE_WINDOW, /* sampled by itself */
    MSG_MODE_STRICT, /* lines of the whole frame */
    MSG_NMODE
};

/* Where a unit's worker begins each bar while it works ahead of the truth.
 * Twins begin at different ends, so that they trace the same pixels late. */
enum msg_end {
    MSG_END_LEFT,  /* left to right */
    MSG_END_RIGHT, /* right to left */
    MSG_END_MIDDLE_RIGHT,
    MSG_END_MIDDLE_LEFT,
    MSG_NEND
};

/* MSG_UNIT_TOP: no unit has the base line above this unit's lines; trace that
 * line first, and send it as FACTS.
 * MSG_UNIT_TWIN: other workers have the unit, too; send FACTS as they come.
 * MSG_UNIT_BARS: make bars along with the base lines, from the top, as the unit
 * below can wait for the last base line. */
#define MSG_UNIT_TOP   (1u << 0)
#define MSG_UNIT_TWIN  (1u << 1)
#define MSG_UNIT_BARS  (1u << 2)
#define MSG_UNIT_FLAGS 7u /* all of them */

/* x, y of the top left pixel, y from the top. */
struct msg_unit {
    const uint8_t *job;
    uint32_t unit, attempt;
    uint32_t frame; /* index into the job's frames */
    uint32_t x, y, width, height;
    uint8_t mode;  /* enum msg_mode */
    uint8_t end;   /* enum msg_end */
    uint8_t flags; /* MSG_UNIT_...; none with MSG_MODE_WINDOW */
};

#define MSG_FACTS_ESTIMATE (1u << 0) /* traced for an estimate */
#define MSG_FACTS_FLAGS    1u        /* all of them */

#define MSG_MAX_LINE_ROWS 32 /* most rows of a line */

/* Facts of one line.  Pixels outside of the view cost no ray and are no facts.
 */
struct msg_facts {
    const uint8_t *job;
    uint32_t frame, line;
    uint32_t row, rows; /* row from the line's top, where a bar's rows come
                         * first and the base line last */
    uint32_t width;     /* of the picture */
    uint8_t flags;      /* MSG_FACTS_... */
    uint8_t channels;   /* 3 or 4, as in a RESULT */
    /* (width + 7) / 8 bytes for each row: pixel x is 1 << x % 8 of byte x / 8;
     * bits past the width are 0 */
    const uint8_t *bitmap;
    const uint8_t *pixels; /* of the bits that are set: channels floats each */
    uint32_t npixels;      /* the bits that are set; counted by unpacking */
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

/* The worker that waits for a base line. */
struct msg_next_holder {
    const uint8_t *job;
    uint32_t frame, line;
    const char *name; /* a worker's; empty: no worker waits */
};

/* GAVE: the rows that the unit keeps after SPLIT or YIELD.  STILL: the rows
 * that the unit has in a worker that comes back. */
struct msg_gave {
    const uint8_t *job;
    uint32_t unit, attempt;
    uint32_t height; /* rows from now on.  In a GAVE, the height of before says
                      * that no row was given away, 0 that all were */
};

#endif
