/* arena.h - memory that is freed all at once
 *
 * A scene lives in one arena and is freed with it.  Each render thread has a
 * scratch arena that is marked and rewound; rewinding keeps its blocks, so that
 * tracing a ray allocates nothing once they are large enough.
 * Thread: an arena belongs to one thread at a time.  */
#ifndef RAD_BASE_ARENA_H
#define RAD_BASE_ARENA_H

#include <stdbool.h>
#include <stddef.h>

struct rad_arena_block;
struct rad_arena_adopted;

struct rad_arena {
    struct rad_arena_block *head; /* block in use; older ones behind it */
    struct rad_arena_block *spare; /* blocks that a rewind emptied */
    struct rad_arena_adopted *adopted; /* the newest first */
    size_t total;                 /* bytes allocated by malloc so far */
    bool lacked;                  /* memory was out for an allocation */
    void (*on_lack)(void); /* called then, and may end the process: what is
                            * made without is wrong; NULL: nothing */
};

struct rad_arena_mark {
    struct rad_arena_block *block;
    struct rad_arena_adopted *adopted;
    size_t used;
};

void rad_arena_init(struct rad_arena *a);
void rad_arena_release(struct rad_arena *a);

/* n bytes aligned to 16, not cleared; NULL when memory is out. */
void *rad_arena_alloc(struct rad_arena *a, size_t n);

/* count * size bytes, cleared; NULL when memory is out or the product
 * overflows. */
void *rad_arena_calloc(struct rad_arena *a, size_t count, size_t size);

/* Copies in the arena; rad_arena_strndup() copies len bytes and adds a NUL.
 * NULL when memory is out. */
void *rad_arena_dup(struct rad_arena *a, const void *src, size_t n);
char *rad_arena_strndup(struct rad_arena *a, const char *s, size_t len);

/* Take n bytes at p, which are malloc'd: they live as long as what the arena
 * allocates now.  Returns p; NULL, with p freed, when memory is out. */
void *rad_arena_adopt(struct rad_arena *a, void *p, size_t n);

/* A rewind frees all that was allocated after the mark; the arena keeps the
 * memory for later allocations. */
struct rad_arena_mark rad_arena_mark(const struct rad_arena *a);
void rad_arena_rewind(struct rad_arena *a, struct rad_arena_mark mark);

#endif
