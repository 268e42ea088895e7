/* msg_store.c - the codec of the messages that carry files
 *
 * See "store" in message.h and message.def. */
#include "config.h"

#include "codec.h"

void
msg_pack_hashes(struct wire_out *o, const struct msg_hashes *b)
{
    msg_put_must(o, b->n <= MSG_MAX_FILES);
    if (o->bad)
        return;
    wire_put_u32(o, b->n);
    wire_put_bytes(o, b->hash, (size_t)b->n * MSG_HASH);
}

void
msg_unpack_hashes(struct wire_in *in, struct msg_hashes *b, struct msg *m)
{
    (void)m;
    b->n = wire_get_count(in, MSG_HASH, MSG_MAX_FILES);
    b->hash = wire_get_view(in, (size_t)b->n * MSG_HASH);
}

static bool
chunk_fits(const struct msg_chunk *b)
{
    return b->offset <= b->total && b->len <= b->total - b->offset &&
           (b->len > 0 || b->total == 0);
}

void
msg_pack_chunk(struct wire_out *o, const struct msg_chunk *b)
{
    msg_put_must(o, chunk_fits(b));
    msg_put_hash(o, b->hash);
    wire_put_u64(o, b->offset);
    wire_put_u64(o, b->total);
    wire_put_blob(o, b->data, b->len, MSG_MAX_CHUNK);
}

void
msg_unpack_chunk(struct wire_in *in, struct msg_chunk *b, struct msg *m)
{
    (void)m;
    b->hash = wire_get_view(in, MSG_HASH);
    b->offset = wire_get_u64(in);
    b->total = wire_get_u64(in);
    b->data = wire_get_blob(in, MSG_MAX_CHUNK, &b->len);
    msg_must(in, chunk_fits(b));
}

void
msg_pack_have(struct wire_out *o, const struct msg_have *b)
{
    msg_put_hash(o, b->hash);
}

void
msg_unpack_have(struct wire_in *in, struct msg_have *b, struct msg *m)
{
    (void)m;
    b->hash = wire_get_view(in, MSG_HASH);
}
