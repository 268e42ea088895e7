/* blob.h - bytes that several answers share
 *
 * A page, an event or a picture is made once and sent to all browsers that ask
 * for it; it is freed when the slowest of them has read it.  blob_alive() is
 * the memory that all blobs take: while it is above BLOB_MOST no page, list or
 * event is made, so browsers that do not read cannot make radweb grow without
 * end.
 * Thread: the loop's. */
#ifndef RADD_OBSERVER_BLOB_H
#define RADD_OBSERVER_BLOB_H

#include <stddef.h>

#define BLOB_MOST ((size_t)192 << 20)

struct blob {
    size_t refs, len;
    char *bytes;
};

/* Make a blob of malloc'd bytes, which are taken; the caller has its only
 * reference.  NULL: bytes is NULL or memory is out; the bytes are freed then.
 */
struct blob *blob_new(char *bytes, size_t len);
struct blob *blob_ref(struct blob *b); /* both accept NULL */
void blob_unref(struct blob *b);

/* Bytes of all blobs. */
size_t blob_alive(void);

#endif
