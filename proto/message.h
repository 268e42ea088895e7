/* message.h - what coordinator, workers, users and children say to each other
 *
 * One struct per message, all in the tagged struct msg; the structs stand by
 * group in msg_*.h.  message.def lists
 * them with their numbers, limits and where each may arrive; doc/protocol.md
 * has their bytes.
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
#include "proto/msg_peer.h"
#include "proto/msg_session.h"
#include "proto/msg_sharing.h"
#include "proto/msg_store.h"
#include "proto/msg_work.h"

struct msg {
    uint16_t type;    /* enum msg_type */
    uint32_t request; /* a reply repeats its request's; 0 where none is due */
    union {
#define MSG(NAME, name, body, number, since, limit, at) struct msg_##body name;
#include "proto/message.def"
    };
    /* scratch of the unpacked list; see msg_release() */
    void *list;
    size_t list_size;
};

/* A struct msg starts as { .type = MSG_X, ... } for packing, or { 0 } for
 * unpacking; release what was unpacked into. */
void msg_release(struct msg *m);

/* Append m as one whole frame, header and payload, to out (whose max should
 * leave room for MSG_FRAME_MAX bytes).  0, RAD_EPROTO when a field is out of
 * its bounds, or RAD_ENOMEM; out is as before then. */
int msg_pack(struct wire_out *out, const struct msg *m);

/* The same for somebody who speaks that version.  RAD_EPROTO, too, for a
 * message that it does not have. */
int msg_pack_as(unsigned version, struct wire_out *out, const struct msg *m);

/* The type of a whole frame of ours; 0: it is none. */
uint16_t msg_frame_type(const uint8_t *frame, size_t n);

/* Decode a payload of n bytes.  0, or RAD_EPROTO: fields missing, out of
 * range, or bytes left over; or RAD_ENOMEM. */
int msg_unpack(struct msg *m, uint16_t type, uint32_t request,
               const uint8_t *payload, size_t n, struct rad_error *err);

/* The same for one in the bytes of that version. */
int msg_unpack_as(unsigned version, struct msg *m, uint16_t type,
                  uint32_t request, const uint8_t *payload, size_t n,
                  struct rad_error *err);

/* The file that a job's frames come in, and the costs of their lines
 * (MSG_JOB_VIEWS), appended to out.  0; RAD_EPROTO: there are too many of them;
 * RAD_ENOMEM. */
int msg_views_pack(struct wire_out *out, const struct msg_spec *spec);

/* Make of its n bytes, which are lent, the frames and costs of a spec that says
 * how many frames there are and how large; room is kept in *m, as by
 * msg_unpack().  RAD_EDATA, or RAD_ENOMEM. */
int msg_views_unpack(struct msg *m, struct msg_spec *spec, const uint8_t *bytes,
                     size_t n, struct rad_error *err);

/* The highest of our versions in [min, max]; 0: none is. */
unsigned msg_common_version(unsigned min, unsigned max);

/* Add the pixels of b; the first of both is kept. */
void msg_nan_add(struct msg_nan *a, const struct msg_nan *b);

/* Add b's faults to a's. */
void msg_faults_add(struct msg_fault a[MSG_FAULTS],
                    const struct msg_fault b[MSG_FAULTS]);

/* Add what b says of rays and of what came of them: not of pixels and time. */
void msg_rays_add(struct msg_counts *a, const struct msg_counts *b);

/* Add all of b. */
void msg_counts_add(struct msg_counts *a, const struct msg_counts *b);
/* What a sum has that another has not, field by field; nothing of primary rays,
 * nan, faults and wall_s. */
void msg_counts_lack(struct msg_counts *out, const struct msg_counts *all,
                     const struct msg_counts *have);
void msg_doubt_add(struct msg_doubt *a, const struct msg_doubt *b);

/* "JOB-START"; "?" for a number that is no message. */
const char *msg_name(uint16_t type);

/* Largest payload; 0 for a number that is no message. */
size_t msg_limit(uint16_t type);

/* The version that brought it; 0 for a number that is no message. */
unsigned msg_since(uint16_t type);

/* May this type arrive there?  Default: no. */
bool msg_allowed(enum msg_session session, uint16_t type);

/* Walk the table: the i-th message's number, 0 past the end. */
uint16_t msg_nth(size_t i);

/* A job's id as 32 hex digits and back; false when text is no id. */
#define MSG_JOB_HEX (2 * MSG_JOB + 1)
void msg_job_format(const uint8_t job[MSG_JOB], char hex[MSG_JOB_HEX]);
bool msg_job_parse(const char *hex, uint8_t job[MSG_JOB]);

#endif
