/* arena.c - see arena.h
 *
 * Blocks form a stack.  A rewind pops blocks down to the mark and keeps them as
 * spares, so a scratch arena calls malloc only for the first bars. */
#include "config.h"

#include "base/arena.h"

#include <stdalign.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define ALIGN ((size_t)16)
#define FIRST_BLOCK ((size_t)16 * 1024)
#define LARGEST_STEP ((size_t)4 * 1024 * 1024)

struct rad_arena_block {
    struct rad_arena_block *older;
    size_t size; /* of data */
    size_t used;
    alignas(16) unsigned char data[];
};

struct rad_arena_adopted {
    struct rad_arena_adopted *older;
    void *p; /* malloc'd */
    size_t size;
};

void
rad_arena_init(struct rad_arena *a)
{
    memset(a, 0, sizeof *a);
}

static void
free_chain(struct rad_arena_block *b)
{
    while (b) {
        struct rad_arena_block *older = b->older;

        free(b);
        b = older;
    }
}

/* Free what was adopted after `last`. */
static void
free_adopted(struct rad_arena *a, const struct rad_arena_adopted *last)
{
    for (; a->adopted != last; a->adopted = a->adopted->older) {
        free(a->adopted->p);
        a->total -= a->adopted->size;
    }
}

void
rad_arena_release(struct rad_arena *a)
{
    free_adopted(a, NULL);
    free_chain(a->head);
    free_chain(a->spare);
    memset(a, 0, sizeof *a);
}

/* Push a block with room for n bytes: a spare one, or a new one of twice the
 * size of the block below, up to LARGEST_STEP. */
static struct rad_arena_block *
push_block(struct rad_arena *a, size_t n)
{
    struct rad_arena_block **link = &a->spare, *b;
    size_t size = a->head ? a->head->size * 2 : FIRST_BLOCK;

    for (; (b = *link) != NULL; link = &b->older)
        if (b->size >= n) {
            *link = b->older;
            break;
        }
    if (!b) {
        if (size > LARGEST_STEP)
            size = LARGEST_STEP;
        if (size < n)
            size = n;
        if (size > SIZE_MAX - sizeof *b)
            return NULL;
        b = malloc(sizeof *b + size);
        if (!b)
            return NULL;
        b->size = size;
        a->total += sizeof *b + size;
    }
    b->used = 0;
    b->older = a->head;
    a->head = b;
    return b;
}

static void *
lack(struct rad_arena *a)
{
    a->lacked = true;
    if (a->on_lack)
        a->on_lack();
    return NULL;
}

void *
rad_arena_alloc(struct rad_arena *a, size_t n)
{
    struct rad_arena_block *b = a->head;
    void *p;

    if (n > SIZE_MAX - ALIGN)
        return lack(a);
    n = (n + ALIGN - 1) & ~(ALIGN - 1);
    if (!b || n > b->size - b->used) {
        b = push_block(a, n);
        if (!b)
            return lack(a);
    }
    p = b->data + b->used;
    b->used += n;
    return p;
}

void *
rad_arena_calloc(struct rad_arena *a, size_t count, size_t size)
{
    void *p;

    if (size && count > SIZE_MAX / size)
        return lack(a);
    p = rad_arena_alloc(a, count * size);
    if (p)
        memset(p, 0, count * size);
    return p;
}

void *
rad_arena_dup(struct rad_arena *a, const void *src, size_t n)
{
    void *p = rad_arena_alloc(a, n);

    if (p && n)
        memcpy(p, src, n);
    return p;
}

char *
rad_arena_strndup(struct rad_arena *a, const char *s, size_t len)
{
    char *p = len < SIZE_MAX ? rad_arena_alloc(a, len + 1) : NULL;

    if (p) {
        memcpy(p, s, len);
        p[len] = '\0';
    }
    return p;
}

void *
rad_arena_adopt(struct rad_arena *a, void *p, size_t n)
{
    struct rad_arena_adopted *x = rad_arena_alloc(a, sizeof *x);

    if (!x) {
        free(p);
        return NULL;
    }
    x->older = a->adopted;
    x->p = p;
    x->size = n;
    a->adopted = x;
    a->total += n;
    return p;
}

struct rad_arena_mark
rad_arena_mark(const struct rad_arena *a)
{
    struct rad_arena_mark m = { a->head, a->adopted,
                                a->head ? a->head->used : 0 };

    return m;
}

void
rad_arena_rewind(struct rad_arena *a, struct rad_arena_mark mark)
{
    free_adopted(a, mark.adopted);
    while (a->head != mark.block) {
        struct rad_arena_block *b = a->head;

        a->head = b->older;
        b->older = a->spare;
        a->spare = b;
    }
    if (a->head)
        a->head->used = mark.used;
}
