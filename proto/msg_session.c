/* msg_session.c - the codec of the messages by which two programs get to know
 * each other and stay in touch; the version that both speak
 *
 * See msg_session.h. */
#include "config.h"

#include "proto/codec.h"

unsigned
msg_common_version(unsigned min, unsigned max)
{
    unsigned highest = max < MSG_VERSION ? max : MSG_VERSION;

    return highest < min || highest < MSG_VERSION_MIN ? 0 : highest;
}

void
msg_code_hello(struct codec *c, struct msg_hello *b)
{
    code_u16(c, &b->min);
    code_u16(c, &b->max);
    code_u8(c, &b->role);
    if (c->in && msg_common_version(b->min, b->max) == 0) {
        b->name = b->program = b->address = "";
        wire_get_view(c->in, wire_left(c->in));
        return;
    }
    code_read_must(c,
                   b->role >= MSG_ROLE_WORKER && b->role <= MSG_ROLE_OBSERVER);
    code_str(c, &b->name, MSG_MAX_NAME);
    code_str(c, &b->program, MSG_MAX_NAME);
    code_str(c, &b->address, MSG_MAX_ADDRESS);
    code_u16(c, &b->threads);
    code_read_must(c, b->threads <= MSG_MAX_THREADS);
    code_u64(c, &b->fingerprint);
}

void
msg_code_welcome(struct codec *c, struct msg_welcome *b)
{
    code_u16(c, &b->version);
    code_u64(c, &b->epoch);
    code_str(c, &b->program, MSG_MAX_NAME);
}

void
msg_code_refuse(struct codec *c, struct msg_refuse *b)
{
    code_u16(c, &b->status); /* any value: the connection ends in any case */
    code_str(c, &b->text, MSG_MAX_TEXT);
}

void
msg_code_ping(struct codec *c, struct msg_ping *b)
{
    code_u64(c, &b->progress);
    code_u32(c, &b->load);
}

void
msg_code_bye(struct codec *c, struct msg_bye *b)
{
    code_str(c, &b->text, MSG_MAX_TEXT);
}
