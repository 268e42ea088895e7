/* blob.h - bytes that several answers share
 *
 * A page, an event or a picture is made once and sent to all who want it; the
 * slowest reader keeps it alive.  blob_alive() is what all of them take, so
 * that readers who do not read cannot make radweb grow without end: while it is
 * above BLOB_MOST no page, list or event is made.
 * Thread: the loop's. */
#ifndef RADD_OBSERVER_BLOB_H
#define RADD_OBSERVER_BLOB_H

#include <stddef.h>

#define BLOB_MOST ((size_t)192 << 20)

struct blob {
    size_t refs, len;
    char *bytes;
};

/* Takes the malloc'd bytes; one reference.  NULL when they are NULL or memory
 * is out. */
struct blob *blob_new(char *bytes, size_t len);
struct blob *blob_ref(struct blob *b); /* NULL is accepted by both */
void blob_unref(struct blob *b);

/* Bytes of all blobs that there are. */
size_t blob_alive(void);

#endif
