/* codec.h - what the codecs of message bodies share
 *
 * Private to message.c, the msg_*.c and the journal.  Each body has one
 * function that goes over its fields in their order on the wire; the codec
 * decides whether each field is written or read, so a layout stands in one
 * place.  The body that is written is a copy of the caller's: a codec function
 * may change its fields, but not the bytes that they point to.
 * A value out of its range sets the sticky `bad` of wire.h.  A field that a
 * later version of the protocol brings is coded where codec.version is that
 * version or a later one.  Thread: any. */
#ifndef CODEC_H
#define CODEC_H

#include "proto/message.h"

struct codec {
    struct wire_out *out; /* where fields are written; NULL: they are read */
    struct wire_in *in;   /* where fields are read; NULL: they are written */
    struct msg *m;        /* the message that is read, for its list */
    unsigned version;     /* of the protocol, whose layout is coded */
};

bool code_bad(const struct codec *c);

/* Set `bad` unless cond holds. */
void code_must(struct codec *c, bool cond);

/* The same for fields that are read only: our own are right. */
void code_read_must(struct codec *c, bool cond);

void code_u8(struct codec *c, uint8_t *v);
void code_u16(struct codec *c, uint16_t *v);
void code_u32(struct codec *c, uint32_t *v);
void code_u64(struct codec *c, uint64_t *v);
void code_i32(struct codec *c, int32_t *v);
void code_f64(struct codec *c, double *v);

/* Seconds, or a sum of squares: 0 or more, and below 1e100, so that sums of
 * such values are finite. */
void code_amount(struct codec *c, double *v);

/* The status of a failure, of sysexits.h: never 0. */
void code_failure(struct codec *c, uint16_t *v);

/* A byte that must be below n. */
void code_below(struct codec *c, uint8_t *v, uint8_t n);

/* As wire_put_...() and wire_get_...() code them; bytes that are read are lent
 * by the payload. */
void code_view(struct codec *c, const uint8_t **v, size_t n);
void code_str(struct codec *c, const char **v, size_t max);
void code_blob(struct codec *c, const uint8_t **v, size_t *n, size_t max);

/* A job's id, a file's hash; NULL is written as zeros. */
void code_job(struct codec *c, const uint8_t **job);
void code_hash(struct codec *c, const uint8_t **hash);

/* A job's id, a unit's number and that of an attempt at the unit. */
void code_attempt(struct codec *c, const uint8_t **job, uint32_t *unit,
                  uint32_t *attempt);

/* The length of a list of at most max entries, of at least `least` bytes each
 * on the wire.  Sets `bad`, and *n to 0, if the payload cannot hold so many. */
void code_count(struct codec *c, uint32_t *n, size_t least, uint32_t max);

/* The length, as above, and the entries, for the caller to code: `list` itself
 * when it is written, which the caller must not change; else room in the
 * message's own list, `entry` bytes each.  NULL when the list is empty; or when
 * memory is out, with `bad` set. */
void *code_list(struct codec *c, const void *list, uint32_t *n, size_t least,
                uint32_t max, size_t entry);

void code_faults(struct codec *c, struct msg_fault faults[MSG_FAULTS]);
void code_counts(struct codec *c, struct msg_counts *counts);

/* Counts outside of any message, for the journal. */
void msg_put_counts(struct wire_out *o, const struct msg_counts *counts);
void msg_get_counts(struct wire_in *in, struct msg_counts *counts);

/* One function for each body. */
#define MSG(NAME, name, body, number, since, limit, at)                        \
    void msg_code_##body(struct codec *c, struct msg_##body *b);
#include "proto/message.def"

#endif
