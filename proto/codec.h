/* codec.h - what the codecs of message bodies share
 *
 * Private to message.c, the msg_*.c and the journal.  Each body has one
 * function that goes over its fields in their order on the wire.  struct codec
 * decides whether a field is written or read, so each layout is stated once.
 * The body that is written is a copy of the caller's: a codec function may
 * change its fields, but not the bytes that they point to.
 * A value out of its range sets the sticky `bad` of wire.h.  A field that came
 * with a later version of the protocol is coded if codec.version is at least
 * that version.
 * Thread: any. */
#ifndef CODEC_H
#define CODEC_H

#include "proto/message.h"

struct codec {
    struct wire_out *out; /* where fields are written; NULL: they are read */
    struct wire_in *in;   /* where fields are read; NULL: they are written */
    struct msg *m;        /* the message that is read, for its list */
    unsigned version;     /* of the protocol: decides the layout */
};

bool code_bad(const struct codec *c);

/* Set `bad` unless cond holds. */
void code_must(struct codec *c, bool cond);

/* As code_must(), but only where fields are read: in fields that we write cond
 * holds anyway. */
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

/* A byte below n. */
void code_below(struct codec *c, uint8_t *v, uint8_t n);

/* Coded as by wire_put_...() and wire_get_...(); bytes that are read point into
 * the payload. */
void code_view(struct codec *c, const uint8_t **v, size_t n);
void code_str(struct codec *c, const char **v, size_t max);
void code_blob(struct codec *c, const uint8_t **v, size_t *n, size_t max);

/* A job's id, a file's hash; NULL is written as zeros. */
void code_job(struct codec *c, const uint8_t **job);
void code_hash(struct codec *c, const uint8_t **hash);

/* A job's id, a unit's number and that of an attempt at the unit. */
void code_attempt(struct codec *c, const uint8_t **job, uint32_t *unit,
                  uint32_t *attempt);

/* The length of a list of at most max entries, each of at least `least` bytes
 * on the wire.  Sets `bad`, and *n to 0, if the payload cannot hold so many. */
void code_count(struct codec *c, uint32_t *n, size_t least, uint32_t max);

/* The length, as above; then returns the entries for the caller to code.  When
 * writing this is `list`, which the caller must not change; when reading, room
 * for *n entries of `entry` bytes in the message's own list.  NULL if the list
 * is empty, or if memory is out, with `bad` set. */
void *code_list(struct codec *c, const void *list, uint32_t *n, size_t least,
                uint32_t max, size_t entry);

void code_faults(struct codec *c, struct msg_fault faults[MSG_FAULTS]);
void code_counts(struct codec *c, struct msg_counts *counts);

/* Counts by themselves, for the journal. */
void msg_put_counts(struct wire_out *o, const struct msg_counts *counts);
void msg_get_counts(struct wire_in *in, struct msg_counts *counts);

/* The codec function of each body. */
#define MSG(NAME, name, body, number, since, limit, at)                        \
    void msg_code_##body(struct codec *c, struct msg_##body *b);
#include "proto/message.def"

#endif
