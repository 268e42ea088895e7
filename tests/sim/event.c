/* event.c - see event.h */
#include "config.h"

#include "event.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

static void *
checked(void *p)
{
    if (!p) {
        fputs("sim: out of memory\n", stderr);
        exit(EX_OSERR);
    }
    return p;
}

void *
sim_alloc(size_t n)
{
    return checked(calloc(1, n + 1));
}

void
event_take(struct event *e, const void *bytes, size_t len)
{
    e->bytes = checked(malloc(len + 1));
    memcpy(e->bytes, bytes, len);
    e->len = len;
}

static bool
before(const struct event *a, const struct event *b)
{
    return a->at != b->at ? a->at < b->at : a->sequence < b->sequence;
}

static void
swap(struct event *a, struct event *b)
{
    struct event t = *a;

    *a = *b;
    *b = t;
}

struct event *
events_add(struct events *v, const struct event *e)
{
    size_t i = v->n++;

    if (i == v->cap) {
        v->cap = i ? 2 * i : 256;
        v->heap = realloc(v->heap, v->cap * sizeof *v->heap);
        if (!v->heap)
            exit(EX_OSERR);
    }
    v->heap[i] = *e;
    v->heap[i].sequence = v->sequence++;
    for (; i > 0 && before(&v->heap[i], &v->heap[(i - 1) / 2]); i = (i - 1) / 2)
        swap(&v->heap[i], &v->heap[(i - 1) / 2]);
    return &v->heap[i];
}

static struct event
pop(struct events *v)
{
    struct event top = v->heap[0];
    size_t i = 0;

    v->heap[0] = v->heap[--v->n];
    for (;;) {
        size_t least = i;

        for (size_t k = 2 * i + 1; k <= 2 * i + 2 && k < v->n; k++)
            if (before(&v->heap[k], &v->heap[least]))
                least = k;
        if (least == i)
            return top;
        swap(&v->heap[i], &v->heap[least]);
        i = least;
    }
}

bool
events_step(struct events *v, uint64_t *now, void *arg)
{
    struct event e;

    if (v->n == 0)
        return false;
    e = pop(v);
    *now = e.at;
    e.fn(arg, &e);
    free(e.bytes);
    return true;
}

void
events_release(struct events *v)
{
    for (size_t i = 0; i < v->n; i++)
        free(v->heap[i].bytes);
    free(v->heap);
    *v = (struct events){ 0 };
}
