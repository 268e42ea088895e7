/* msg_session.c - the codec of the messages by which two get to know each other
 * and stay in touch, and the version that both speak
 *
 * See "session" in message.h and message.def. */
#include "config.h"

#include "codec.h"

unsigned
msg_common_version(unsigned min, unsigned max)
{
    unsigned highest = max < MSG_VERSION ? max : MSG_VERSION;

    return highest < min || highest < MSG_VERSION_MIN ? 0 : highest;
}

void
msg_pack_hello(struct wire_out *o, const struct msg_hello *b)
{
    wire_put_u16(o, b->min);
    wire_put_u16(o, b->max);
    wire_put_u8(o, b->role);
    wire_put_str(o, b->name, MSG_MAX_NAME);
    wire_put_str(o, b->program, MSG_MAX_NAME);
    wire_put_str(o, b->address, MSG_MAX_ADDRESS);
    wire_put_u16(o, b->threads);
    wire_put_u64(o, b->fingerprint);
}

void
msg_unpack_hello(struct wire_in *in, struct msg_hello *b, struct msg *m)
{
    (void)m;
    b->min = wire_get_u16(in);
    b->max = wire_get_u16(in);
    b->role = wire_get_u8(in);
    if (msg_common_version(b->min, b->max) == 0) {
        b->name = b->program = b->address = "";
        wire_get_view(in, wire_left(in));
        return;
    }
    msg_must(in, b->role >= MSG_ROLE_WORKER && b->role <= MSG_ROLE_ADMIN);
    b->name = wire_get_str(in, MSG_MAX_NAME);
    b->program = wire_get_str(in, MSG_MAX_NAME);
    b->address = wire_get_str(in, MSG_MAX_ADDRESS);
    b->threads = wire_get_u16(in);
    b->fingerprint = wire_get_u64(in);
}

void
msg_pack_welcome(struct wire_out *o, const struct msg_welcome *b)
{
    wire_put_u16(o, b->version);
    wire_put_u64(o, b->epoch);
    wire_put_str(o, b->program, MSG_MAX_NAME);
}

void
msg_unpack_welcome(struct wire_in *in, struct msg_welcome *b, struct msg *m)
{
    (void)m;
    b->version = wire_get_u16(in);
    b->epoch = wire_get_u64(in);
    b->program = wire_get_str(in, MSG_MAX_NAME);
}

void
msg_pack_refuse(struct wire_out *o, const struct msg_refuse *b)
{
    wire_put_u16(o, b->status);
    wire_put_str(o, b->text, MSG_MAX_TEXT);
}

void
msg_unpack_refuse(struct wire_in *in, struct msg_refuse *b, struct msg *m)
{
    (void)m;
    b->status = wire_get_u16(in);
    b->text = wire_get_str(in, MSG_MAX_TEXT);
}

void
msg_pack_ping(struct wire_out *o, const struct msg_ping *b)
{
    wire_put_u64(o, b->progress);
}

void
msg_unpack_ping(struct wire_in *in, struct msg_ping *b, struct msg *m)
{
    (void)m;
    b->progress = wire_get_u64(in);
}

void
msg_pack_bye(struct wire_out *o, const struct msg_bye *b)
{
    wire_put_str(o, b->text, MSG_MAX_TEXT);
}

void
msg_unpack_bye(struct wire_in *in, struct msg_bye *b, struct msg *m)
{
    (void)m;
    b->text = wire_get_str(in, MSG_MAX_TEXT);
}
