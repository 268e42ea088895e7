/* codec.h - what the codecs of message bodies share
 *
 * Private to message.c and the msg_*.c.  Writers and readers rely on the sticky
 * `bad` of wire.h: a range that is wrong sets it.  A field that version N
 * brought is written and read where the wire's version is N or later; when N is
 * the oldest that is spoken, the question goes. Thread: any. */
#ifndef CODEC_H
#define CODEC_H

#include "message.h"

/* NULL goes out as zeros. */
void msg_put_job(struct wire_out *o, const uint8_t *job);
void msg_put_hash(struct wire_out *o, const uint8_t *hash);

/* Bad unless cond. */
void msg_put_must(struct wire_out *o, bool cond);
void msg_must(struct wire_in *in, bool cond);

/* A byte that must be below n. */
uint8_t msg_get_below(struct wire_in *in, uint8_t n);

void msg_put_faults(struct wire_out *o,
                    const struct msg_fault faults[MSG_FAULTS]);
void msg_get_faults(struct wire_in *in, struct msg_fault faults[MSG_FAULTS]);
void msg_put_counts(struct wire_out *o, const struct msg_counts *c);
void msg_get_counts(struct wire_in *in, struct msg_counts *c);

/* Room for n entries in the message's own list; NULL when n is 0, or (and bad)
 * when memory is out.  n was checked against the payload, so this is bounded
 * by it. */
void *msg_list_room(struct msg *m, struct wire_in *in, size_t n, size_t entry);

/* Every body's pair.  m is the message itself, for its list. */
#define MSG(NAME, name, body, number, since, bytes, limit, at)                 \
    void msg_pack_##body(struct wire_out *o, const struct msg_##body *b);      \
    void msg_unpack_##body(struct wire_in *in, struct msg_##body *b,           \
                           struct msg *m);
#include "message.def"

#endif
