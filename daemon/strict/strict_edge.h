/* strict_edge.h - tops and bottoms of strict units, by frame and line
 *
 * The machine owns edges; a pointer is good until the edge is dropped. */
#ifndef DAEMON_STRICT_EDGE_H
#define DAEMON_STRICT_EDGE_H

#include "machine/shelf.h"
#include "strict/strict.h"

/* The base line under some unit, true. */
struct edge {
    struct edge *next;    /* the next newer edge */
    struct edge *chained; /* the next edge in the same slot */
    uint32_t frame;
    int line;
    struct shelf shelf; /* pieces from other workers; empty once all came */
    struct rad_pixel *pixels; /* the width; NULL: the edge is not whole */
    uint8_t *density;
};

/* NULL: none. */
struct edge *edge_find(const struct strict *s, uint32_t frame, int line);
/* The edge of a line, made if need be; NULL: memory is out. */
struct edge *edge_make(struct strict *s, uint32_t frame, int line);
/* Free the edge of a line, if no unit needs it. */
void edge_drop(struct strict *s, uint32_t frame, int line);
/* The line was made here, and is whole; false: memory is out. */
bool edge_set(struct strict *s, struct edge *e, const struct rad_pixel *pixels,
              const uint8_t *density);
/* A piece that fits came.  True: it makes the line whole. */
bool edge_put(struct strict *s, struct edge *e, const struct msg_base_line *m);
/* Decode n pixels of a message. */
void edge_decode(struct rad_pixel *to, const uint8_t *from, uint32_t n,
                 int channels);
/* The size of shelves of a frame's lines. */
struct shelf_size edge_size(const struct strict *s, uint32_t frame);
void edge_release(struct strict *s);

#endif
