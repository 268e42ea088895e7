/* msg_order.c - the codec of what radsubmit and radctl ask the coordinator for
 *
 * FETCH to KEY in message.def, and ANSWER. */
#include "config.h"

#include "codec.h"

void
msg_pack_fetch(struct wire_out *o, const struct msg_fetch *b)
{
    msg_put_must(o, b->what < MSG_NWHAT);
    msg_put_job(o, b->job);
    wire_put_u32(o, b->frame);
    wire_put_u8(o, b->what);
}

void
msg_unpack_fetch(struct wire_in *in, struct msg_fetch *b, struct msg *m)
{
    (void)m;
    b->job = wire_get_view(in, MSG_JOB);
    b->frame = wire_get_u32(in);
    b->what = msg_get_below(in, MSG_NWHAT);
}

void
msg_pack_query(struct wire_out *o, const struct msg_query *b)
{
    msg_put_must(o, b->what < MSG_NQUERY);
    wire_put_u8(o, b->what);
    wire_put_str(o, b->text, MSG_MAX_NAME);
}

void
msg_unpack_query(struct wire_in *in, struct msg_query *b, struct msg *m)
{
    (void)m;
    b->what = msg_get_below(in, MSG_NQUERY);
    b->text = wire_get_str(in, MSG_MAX_NAME);
}

void
msg_pack_answer(struct wire_out *o, const struct msg_answer *b)
{
    wire_put_blob(o, b->text, b->len, MSG_MAX - 4);
}

void
msg_unpack_answer(struct wire_in *in, struct msg_answer *b, struct msg *m)
{
    (void)m;
    b->text = wire_get_blob(in, MSG_MAX - 4, &b->len);
}

void
msg_pack_key(struct wire_out *o, const struct msg_key *b)
{
    msg_put_must(o, b->what < MSG_NKEY);
    wire_put_u8(o, b->what);
    wire_put_str(o, b->name, MSG_MAX_KEY);
    wire_put_u64(o, b->expires);
}

void
msg_unpack_key(struct wire_in *in, struct msg_key *b, struct msg *m)
{
    (void)m;
    b->what = msg_get_below(in, MSG_NKEY);
    b->name = wire_get_str(in, MSG_MAX_KEY);
    b->expires = wire_get_u64(in);
    msg_must(in, b->expires <= INT64_MAX);
}

void
msg_pack_worker(struct wire_out *o, const struct msg_worker *b)
{
    wire_put_str(o, b->name, MSG_MAX_NAME);
}

void
msg_unpack_worker(struct wire_in *in, struct msg_worker *b, struct msg *m)
{
    (void)m;
    b->name = wire_get_str(in, MSG_MAX_NAME);
}
