/* blob.c - see blob.h */
#include "config.h"

#include "observer/blob.h"

#include <stdlib.h>

static size_t alive; /* [loop] bytes of all blobs, of one process */

struct blob *
blob_new(char *bytes, size_t len)
{
    struct blob *b = bytes ? malloc(sizeof *b) : NULL;

    if (!b) {
        free(bytes);
        return NULL;
    }
    *b = (struct blob){ 1, len, bytes };
    alive += len;
    return b;
}

struct blob *
blob_ref(struct blob *b)
{
    if (b)
        b->refs++;
    return b;
}

void
blob_unref(struct blob *b)
{
    if (!b || --b->refs > 0)
        return;
    alive -= b->len;
    free(b->bytes);
    free(b);
}

size_t
blob_alive(void)
{
    return alive;
}
