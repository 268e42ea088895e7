/* strict_edge.h - tops and bottoms of strict units, by frame and line
 *
 * The machine owns edges; a pointer is valid until the edge is dropped. */
#ifndef DAEMON_STRICT_EDGE_H
#define DAEMON_STRICT_EDGE_H

#include "machine/shelf.h"
#include "strict/strict.h"

/* A base line that is some unit's top or bottom; its values are true, but for
 * the guess, which serves a unit whose top is the next line. */
struct edge {
    struct edge *next;    /* the next newer edge */
    struct edge *chained; /* next in its slot */
    uint32_t frame;
    int line;
    struct shelf shelf; /* pieces from other workers, until all have come */
    struct rad_pixel *pixels; /* of the whole line; NULL: it is not whole */
    uint8_t *density;
    uint8_t *guess; /* densities as another worker guesses them; NULL: none */
    int known;      /* how many lines the guess follows from */
};

/* The edge of a line; NULL: there is none. */
struct edge *edge_find(const struct strict *s, uint32_t frame, int line);
/* The edge of a line, made if need be; NULL: memory is out. */
struct edge *edge_make(struct strict *s, uint32_t frame, int line);
/* Free the edge of a line, if no unit needs it. */
void edge_drop(struct strict *s, uint32_t frame, int line);
/* The same of an edge that has only a guess; nothing of another. */
void edge_drop_guess(struct strict *s, uint32_t frame, int line);
/* Set the values of a line that was made here; false: memory is out. */
bool edge_set(struct strict *s, struct edge *e, const struct rad_pixel *pixels,
              const uint8_t *density);
/* Add a piece, which fits the line.  True: the piece makes the line whole. */
bool edge_put(struct strict *s, struct edge *e, const struct msg_base_line *m);
/* Keep a guess that fits the line, if it is the best so far. */
void edge_guess(struct strict *s, struct edge *e, const struct msg_guess *m);
/* Decode n pixels of a message. */
void edge_decode(struct rad_pixel *to, const uint8_t *from, uint32_t n,
                 int channels);
/* The shelf size of a frame's lines. */
struct shelf_size edge_size(const struct strict *s, uint32_t frame);
void edge_release(struct strict *s);

#endif
