/* frame.h - cutting a byte stream into messages
 *
 * A frame is a header of 16 bytes, big-endian: magic "RADD", u16 type, u16
 * flags (0), u32 request id, u32 payload length; then the payload.  The reader
 * checks magic, type against the session, and length against the type's limit
 * as soon as the header is there, before it keeps a byte of the body; memory
 * grows with the bytes that came, never with the length that was claimed.
 * Thread: a reader belongs to one thread. */
#ifndef FRAME_H
#define FRAME_H

#include "proto/message.h"

#define MSG_MAGIC     0x52414444u /* "RADD" */
#define MSG_HEADER    16
#define MSG_FRAME_MAX (MSG_HEADER + MSG_MAX)

struct msg_header {
    uint16_t type;
    uint32_t request, length;
};

struct frame_reader {
    /* the owner sets both when the state of the connection changes */
    enum msg_session session;
    unsigned version; /* of the protocol, for the frames that are read */
    struct msg_header head;
    bool have_head, bad;
    uint8_t *buf;
    size_t len, cap;
};

/* A new reader reads the current version.  The messages that come before both
 * sides have agreed on a version have the same bytes in every version. */
void frame_reader_init(struct frame_reader *r, enum msg_session session);
void frame_reader_release(struct frame_reader *r);

/* Read from the *n bytes at *data until a message is whole or no byte is left;
 * *data and *n move on.  Returns 1 with *m unpacked, valid until the next call;
 * 0 if more bytes are needed; or a negative code with *err set, and then every
 * later call fails.
 * When r->session or r->version has to change, change it before the call that
 * reads the next message. */
int frame_read(struct frame_reader *r, const uint8_t **data, size_t *n,
               struct msg *m, struct rad_error *err);

/* Take over the payload of the message that was read last, which stays valid
 * until the caller frees these bytes.  Only between calls of frame_read(). */
uint8_t *frame_reader_take(struct frame_reader *r);

/* Check a header; 0 or RAD_EPROTO. */
int frame_header(struct msg_header *h, enum msg_session session,
                 unsigned version, const uint8_t bytes[MSG_HEADER],
                 struct rad_error *err);

#endif
