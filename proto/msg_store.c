/* msg_store.c - the codec of the messages that carry files
 *
 * See msg_store.h. */
#include "config.h"

#include "proto/codec.h"

void
msg_code_hashes(struct codec *c, struct msg_hashes *b)
{
    code_count(c, &b->n, MSG_HASH, MSG_MAX_FILES);
    code_view(c, &b->hash, (size_t)b->n * MSG_HASH);
}

static bool
chunk_fits(const struct msg_chunk *b)
{
    return b->total <= MSG_MAX_BYTES && b->offset <= b->total &&
           b->len <= b->total - b->offset && (b->len > 0 || b->total == 0);
}

void
msg_code_chunk(struct codec *c, struct msg_chunk *b)
{
    code_hash(c, &b->hash);
    code_u64(c, &b->offset);
    code_u64(c, &b->total);
    code_blob(c, &b->data, &b->len, MSG_MAX_CHUNK);
    code_must(c, chunk_fits(b));
}

void
msg_code_have(struct codec *c, struct msg_have *b)
{
    code_hash(c, &b->hash);
}
