/* arena.h - memory that is given back all at once
 *
 * A scene lives in one arena and dies with it; each render thread has a
 * scratch arena that is marked and rewound, so that no ray allocates: once its
 * blocks have grown to the high-water mark, rewinding keeps them.
 * Thread: an arena belongs to one thread at a time.  */
#ifndef RAD_BASE_ARENA_H
#define RAD_BASE_ARENA_H

#include <stddef.h>

struct rad_arena_block;

struct rad_arena {
    struct rad_arena_block *head; /* block in use; older ones behind it */
    struct rad_arena_block *spare; /* blocks that a rewind emptied */
    size_t total;                 /* bytes asked of malloc so far */
};

struct rad_arena_mark {
    struct rad_arena_block *block;
    size_t used;
};

void rad_arena_init(struct rad_arena *a);
void rad_arena_release(struct rad_arena *a);

/* n bytes aligned to 16, not cleared; NULL when memory is out. */
void *rad_arena_alloc(struct rad_arena *a, size_t n);

/* count * size bytes, cleared; NULL when memory is out or the product
 * overflows. */
void *rad_arena_calloc(struct rad_arena *a, size_t count, size_t size);

/* Copies; the string one takes len bytes and adds a NUL. */
void *rad_arena_dup(struct rad_arena *a, const void *src, size_t n);
char *rad_arena_strndup(struct rad_arena *a, const char *s, size_t len);

struct rad_arena_mark rad_arena_mark(const struct rad_arena *a);
void rad_arena_rewind(struct rad_arena *a, struct rad_arena_mark mark);

#endif
