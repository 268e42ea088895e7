/* message.h - what coordinator, workers, users and children say to each other
 *
 * Each message body is a struct, in the msg_*.h of its group; struct msg is the
 * tagged union of all.  message.def lists the messages with their numbers,
 * limits and sessions; doc/protocol.md has their bytes.
 *
 * A message that was unpacked borrows: its strings and byte ranges point into
 * the payload, its list (frames, peers, units) into msg.list.  Both are valid
 * until the payload goes or the same struct msg is unpacked into again.
 * Strings are never NULL, always terminated and UTF-8.
 * Thread: a struct msg belongs to one thread. */
#ifndef MESSAGE_H
#define MESSAGE_H

#include "proto/msg_job.h"
#include "proto/msg_lending.h"
#include "proto/msg_order.h"
#include "proto/msg_passes.h"
#include "proto/msg_peer.h"
#include "proto/msg_session.h"
#include "proto/msg_sharing.h"
#include "proto/msg_store.h"
#include "proto/msg_work.h"

struct msg {
    uint16_t type;    /* enum msg_type */
    uint32_t request; /* a reply repeats the request's; 0: none is due */
    union {
#define MSG(NAME, name, body, number, since, limit, at) struct msg_##body name;
#include "proto/message.def"
    };
    /* memory of the list in the body; see msg_release() */
    void *list;
    size_t list_size;
};

/* Free the list of a struct msg that was unpacked into.  A struct msg begins as
 * { 0 } for unpacking, as { .type = MSG_X, ... } for packing. */
void msg_release(struct msg *m);

/* Append m to out as one whole frame, header and payload; out->max should leave
 * room for MSG_FRAME_MAX bytes.  Returns 0; RAD_EPROTO: a field is out of its
 * bounds; RAD_ENOMEM.  After a failure out is as before. */
int msg_pack(struct wire_out *out, const struct msg *m);

/* The same in the layout of another version of the protocol.  RAD_EPROTO also
 * if that version does not have the message. */
int msg_pack_as(unsigned version, struct wire_out *out, const struct msg *m);

/* The type of a whole frame that was made here; 0 if n is too small. */
uint16_t msg_frame_type(const uint8_t *frame, size_t n);

/* Decode a payload of n bytes.  Returns 0; RAD_EPROTO: fields are missing or
 * out of range, or bytes are left over; RAD_ENOMEM. */
int msg_unpack(struct msg *m, uint16_t type, uint32_t request,
               const uint8_t *payload, size_t n, struct rad_error *err);

/* The same for a payload of another version of the protocol. */
int msg_unpack_as(unsigned version, struct msg *m, uint16_t type,
                  uint32_t request, const uint8_t *payload, size_t n,
                  struct rad_error *err);

/* Append to out the file of a job's frames and of the costs of their lines
 * (MSG_JOB_VIEWS).  0; RAD_EPROTO: there are too many frames or costs;
 * RAD_ENOMEM. */
int msg_views_pack(struct wire_out *out, const struct msg_spec *spec);

/* Unpack the n bytes of such a file into the frames and costs of spec, which
 * says how many frames there are and how large.  spec borrows the bytes, and
 * the list in *m as with msg_unpack().  0, RAD_EDATA or RAD_ENOMEM. */
int msg_views_unpack(struct msg *m, struct msg_spec *spec, const uint8_t *bytes,
                     size_t n, struct rad_error *err);

/* The highest of our versions within [min, max]; 0: none. */
unsigned msg_common_version(unsigned min, unsigned max);

/* Add b's pixels to a's; a then names the first pixel of both. */
void msg_nan_add(struct msg_nan *a, const struct msg_nan *b);

/* Add b's faults to a's. */
void msg_faults_add(struct msg_fault a[MSG_FAULTS],
                    const struct msg_fault b[MSG_FAULTS]);

/* Add b's rays, intersection tests and ambient values to a's, but not its
 * pixels, faults and times. */
void msg_rays_add(struct msg_counts *a, const struct msg_counts *b);

/* Add all fields of b to a's. */
void msg_counts_add(struct msg_counts *a, const struct msg_counts *b);
/* The difference all - have, at least 0 in each field; primary_rays, nan,
 * faults and wall_s are zero. */
void msg_counts_lack(struct msg_counts *out, const struct msg_counts *all,
                     const struct msg_counts *have);
void msg_doubt_add(struct msg_doubt *a, const struct msg_doubt *b);

/* "JOB-START"; "?" for a number that is no message. */
const char *msg_name(uint16_t type);

/* Largest payload; 0 for a number that is no message. */
size_t msg_limit(uint16_t type);

/* The version that brought the message; 0 for a number that is no message. */
unsigned msg_since(uint16_t type);

/* May a message of this type arrive in that session? */
bool msg_allowed(enum msg_session session, uint16_t type);

/* The number of the i-th message of message.def; 0 past the end. */
uint16_t msg_nth(size_t i);

/* A job's id as 32 hex digits, and back; false: the text is not an id. */
#define MSG_JOB_HEX (2 * MSG_JOB + 1)
void msg_job_format(const uint8_t job[MSG_JOB], char hex[MSG_JOB_HEX]);
bool msg_job_parse(const char *hex, uint8_t job[MSG_JOB]);
/* The chain of a job in a hash table of n, at most 65536; ids are random. */
size_t msg_job_chain(const uint8_t job[MSG_JOB], size_t n);

#endif
