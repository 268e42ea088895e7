/* message.c - packing and unpacking of whole messages, by message.def
 *
 * Each body has a short codec function, declared in codec.h; those of a group
 * of messages are in msg_<group>.c. */
#include "config.h"

#include "proto/message.h"

#include "proto/codec.h"
#include "proto/frame.h"

#include <stdlib.h>

#define AT(session)     (1u << MSG_AT_##session)
#define AT_COORD_CLIENT (AT(COORD_USER) | AT(COORD_ADMIN))
/* also observers, who may only ask */
#define AT_COORD_VIEWER (AT_COORD_CLIENT | AT(COORD_OBSERVER))
#define AT_PARENT       (AT(PARENT_NEW) | AT(PARENT))
#define AT_SHARED       (AT(COORD_WORKER) | AT(PARENT)) /* from a child */
/* the sessions of network connections after HELLO or PEER_HELLO */
#define AT_LIVE                                                                \
    (AT(COORD_WORKER) | AT_COORD_VIEWER | AT(WORKER) | AT(CLIENT) | AT(PEER))

struct row {
    uint16_t type;
    const char *name;
    unsigned since; /* protocol version that brought the message */
    size_t limit;
    unsigned at; /* bit i: it may arrive in enum msg_session i */
    void (*pack)(struct wire_out *o, const struct msg *m);
    void (*unpack)(struct wire_in *in, struct msg *m);
};

/* Functions that take a whole message, made from the codec of its body. */
#define MSG(NAME, lower, body, number, since, limit, at)                       \
    static void pack_##lower(struct wire_out *o, const struct msg *m)          \
    {                                                                          \
        struct codec c = { .out = o, .version = o->version };                  \
        struct msg_##body copy = m->lower;                                     \
                                                                               \
        msg_code_##body(&c, &copy);                                            \
    }                                                                          \
    static void unpack_##lower(struct wire_in *in, struct msg *m)              \
    {                                                                          \
        struct codec c = { .in = in, .m = m, .version = in->version };         \
                                                                               \
        msg_code_##body(&c, &m->lower);                                        \
    }
#include "proto/message.def"

enum {
#define MSG(NAME, lower, body, number, since, limit, at) ROW_##NAME,
#include "proto/message.def"
};

static const struct row rows[] = {
#define MSG(NAME, lower, body, number, since, limit, at)                       \
    { number, #NAME, since, limit, at, pack_##lower, unpack_##lower },
#include "proto/message.def"
};

#define NROWS (sizeof rows / sizeof rows[0])

/* The index of each number's row, plus 1; 0: no such message.  A table, for
 * each message is looked up some six times. */
static const uint8_t row_at[] = {
#define MSG(NAME, lower, body, number, since, limit, at)                       \
    [number] = ROW_##NAME + 1,
#include "proto/message.def"
};

static const struct row *
find_row(uint16_t type)
{
    if (type >= sizeof row_at || row_at[type] == 0)
        return NULL;
    return &rows[row_at[type] - 1];
}

void
msg_release(struct msg *m)
{
    free(m->list);
    *m = (struct msg){ 0 };
}

int
msg_pack(struct wire_out *out, const struct msg *m)
{
    return msg_pack_as(MSG_VERSION, out, m);
}

int
msg_pack_as(unsigned version, struct wire_out *out, const struct msg *m)
{
    const struct row *row = find_row(m->type);
    size_t start = out->len;

    if (!row || out->bad || version < row->since)
        return RAD_EPROTO;
    out->version = version;
    wire_put_u32(out, MSG_MAGIC);
    wire_put_u16(out, m->type);
    wire_put_u16(out, 0);
    wire_put_u32(out, m->request);
    wire_put_u32(out, 0);
    row->pack(out, m);
    if (!out->bad && out->len - start - MSG_HEADER > row->limit)
        out->bad = true;
    if (out->bad) {
        int rc = out->nomem ? RAD_ENOMEM : RAD_EPROTO;

        out->len = start;
        out->bad = out->nomem = false;
        return rc;
    }
    wire_set_u32(out, start + 12, (uint32_t)(out->len - start - MSG_HEADER));
    return 0;
}

uint16_t
msg_frame_type(const uint8_t *frame, size_t n)
{
    struct wire_in in;

    wire_in_init(&in, frame, n);
    wire_get_u32(&in); /* the magic: frames made here have the right one */
    return wire_get_u16(&in);
}

int
msg_unpack(struct msg *m, uint16_t type, uint32_t request,
           const uint8_t *payload, size_t n, struct rad_error *err)
{
    return msg_unpack_as(MSG_VERSION, m, type, request, payload, n, err);
}

int
msg_unpack_as(unsigned version, struct msg *m, uint16_t type, uint32_t request,
              const uint8_t *payload, size_t n, struct rad_error *err)
{
    const struct row *row = find_row(type);
    void *list = m->list;
    size_t list_size = m->list_size;
    struct wire_in in;

    *m = (struct msg){
        .type = type, .request = request, .list = list, .list_size = list_size
    };
    if (!row || version < row->since)
        return rad_fail(err, RAD_EPROTO, "unknown message %u", type);
    wire_in_init(&in, payload, n);
    in.version = version;
    row->unpack(&in, m);
    if (in.nomem)
        return rad_fail_memory(err);
    if (in.bad)
        return rad_fail(err, RAD_EPROTO, "malformed %s of %zu bytes", row->name,
                        n);
    if (wire_left(&in) > 0)
        return rad_fail(err, RAD_EPROTO, "%s has %zu bytes too many", row->name,
                        wire_left(&in));
    return 0;
}

const char *
msg_name(uint16_t type)
{
    const struct row *row = find_row(type);

    return row ? row->name : "?";
}

size_t
msg_limit(uint16_t type)
{
    const struct row *row = find_row(type);

    return row ? row->limit : 0;
}

unsigned
msg_since(uint16_t type)
{
    const struct row *row = find_row(type);

    return row ? row->since : 0;
}

bool
msg_allowed(enum msg_session session, uint16_t type)
{
    const struct row *row = find_row(type);

    return row && (row->at >> session & 1);
}

uint16_t
msg_nth(size_t i)
{
    return i < NROWS ? rows[i].type : 0;
}
