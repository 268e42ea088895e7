/* lossy.c - see lossy.h */
#include "config.h"

#include "ground/lossy.h"

#include <stdlib.h>
#include <string.h>

void
lossy_init(struct lossy *q)
{
    *q = (struct lossy){ .head = NULL };
    q->tail = &q->head;
}

static struct lossy_frame *
pop(struct lossy *q)
{
    struct lossy_frame *f = q->head;

    if (!f)
        return NULL;
    q->head = f->next;
    if (!q->head)
        q->tail = &q->head;
    q->queued -= f->len;
    return f;
}

void
lossy_release(struct lossy *q)
{
    struct lossy_frame *f;

    while ((f = pop(q)) != NULL)
        free(f);
    lossy_init(q);
}

void
lossy_put(struct lossy *q, const uint8_t *bytes, size_t len)
{
    struct lossy_frame *f = malloc(sizeof *f + len);

    if (!f) {
        q->dropped++;
        return;
    }
    f->next = NULL;
    f->len = len;
    memcpy(f->bytes, bytes, len);
    *q->tail = f;
    q->tail = &f->next;
    q->queued += len;
    while (q->queued > LOSSY_MAX) {
        free(pop(q));
        q->dropped++;
    }
}

bool
lossy_pass(struct lossy *q, size_t len)
{
    if (q->head || q->outstanding >= LOSSY_WINDOW)
        return false;
    q->outstanding += len;
    return true;
}

struct lossy_frame *
lossy_take(struct lossy *q)
{
    struct lossy_frame *f;

    if (q->outstanding >= LOSSY_WINDOW)
        return NULL;
    f = pop(q);
    if (f)
        q->outstanding += f->len;
    return f;
}

void
lossy_sent(struct lossy *q, size_t n)
{
    q->outstanding += n;
}

void
lossy_written(struct lossy *q, size_t n)
{
    q->outstanding -= n < q->outstanding ? n : q->outstanding;
}
