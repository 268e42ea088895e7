/* codec.h - what the codecs of message bodies share
 *
 * Private to message.c, the msg_*.c and the journal.  A body has one function,
 * which goes over its fields in their order on the wire: whether they are
 * written or read is the codec's, so that a layout stands in one place.  What
 * is written is a copy of the caller's body, which may be changed on the way,
 * but for what it points to.
 * Writers and readers rely on the sticky `bad` of wire.h: a range that is wrong
 * sets it.  A field that version N of the protocol will bring is written
 * and read where the wire's version is N or later.  Thread: any. */
#ifndef CODEC_H
#define CODEC_H

#include "proto/message.h"

struct codec {
    struct wire_out *out; /* what is written to; NULL: it is read */
    struct wire_in *in;   /* what is read; NULL: it is written */
    struct msg *m;        /* when read: the message itself, for its list */
    unsigned version;
};

bool code_bad(const struct codec *c);

/* Bad unless cond. */
void code_must(struct codec *c, bool cond);

/* The same when it is read: what we write ourselves is right. */
void code_read_must(struct codec *c, bool cond);

void code_u8(struct codec *c, uint8_t *v);
void code_u16(struct codec *c, uint16_t *v);
void code_u32(struct codec *c, uint32_t *v);
void code_u64(struct codec *c, uint64_t *v);
void code_i32(struct codec *c, int32_t *v);
void code_f64(struct codec *c, double *v);

/* Seconds, or a sum of squares: 0 or more, and so much at most that sums of
 * such are finite. */
void code_amount(struct codec *c, double *v);

/* How something ended: one of sysexits.h, which never says that it is well. */
void code_failure(struct codec *c, uint16_t *v);

/* A byte that must be below n. */
void code_below(struct codec *c, uint8_t *v, uint8_t n);

/* As wire_put_...() and wire_get_...() have them; what is read is lent. */
void code_view(struct codec *c, const uint8_t **v, size_t n);
void code_str(struct codec *c, const char **v, size_t max);
void code_blob(struct codec *c, const uint8_t **v, size_t *n, size_t max);

/* NULL goes out as zeros. */
void code_job(struct codec *c, const uint8_t **job);
void code_hash(struct codec *c, const uint8_t **hash);

/* The length of a list of at most max entries, of at least `least` bytes each
 * on the wire.  Bad, and 0, if there cannot be so many. */
void code_count(struct codec *c, uint32_t *n, size_t least, uint32_t max);

/* The same, and where the entries are for the caller to go over: those of
 * `list`, which are only looked at, when they are written; else room of `entry`
 * bytes for each in the message's own list.  NULL when there are none, or (and
 * bad) when memory is out. */
void *code_list(struct codec *c, const void *list, uint32_t *n, size_t least,
                uint32_t max, size_t entry);

void code_faults(struct codec *c, struct msg_fault faults[MSG_FAULTS]);
void code_counts(struct codec *c, struct msg_counts *counts);

/* Counts by themselves, for who keeps them. */
void msg_put_counts(struct wire_out *o, const struct msg_counts *counts);
void msg_get_counts(struct wire_in *in, struct msg_counts *counts);

/* Every body's. */
#define MSG(NAME, name, body, number, since, limit, at)                        \
    void msg_code_##body(struct codec *c, struct msg_##body *b);
#include "proto/message.def"

#endif
