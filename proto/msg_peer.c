/* msg_peer.c - the codec of the messages by which workers find each other, and
 * of ambient records
 *
 * See "peers" in message.h and message.def. */
#include "config.h"

#include "codec.h"

#define PEER_MIN  26 /* bytes of a peer with empty strings, in any version */
#define MAX_PEERS 4096

/* Version 1 knows no keys that are retired, and nobody to be dropped. */
static bool
peer_is_told(unsigned version, const struct msg_peer *p)
{
    return version >= 2 || !(p->flags & MSG_PEER_DROP);
}

static void
put_peer(struct wire_out *o, const struct msg_peer *p)
{
    wire_put_str(o, p->name, MSG_MAX_NAME);
    wire_put_str(o, p->address, MSG_MAX_ADDRESS);
    wire_put_bytes(o, p->token, MSG_TOKEN);
    wire_put_u32(o, p->flags);
    if (o->version >= 2)
        wire_put_u16(o, p->version);
}

void
msg_pack_job_peers(struct wire_out *o, const struct msg_job_peers *b)
{
    uint32_t n = 0;

    msg_put_must(o, b->npeers <= MAX_PEERS);
    for (uint32_t i = 0; i < b->npeers; i++)
        n += peer_is_told(o->version, &b->peers[i]);
    msg_put_job(o, b->job);
    wire_put_u32(o, n);
    for (uint32_t i = 0; i < b->npeers && !o->bad; i++)
        if (peer_is_told(o->version, &b->peers[i]))
            put_peer(o, &b->peers[i]);
}

void
msg_unpack_job_peers(struct wire_in *in, struct msg_job_peers *b, struct msg *m)
{
    struct msg_peer *p;

    b->job = wire_get_view(in, MSG_JOB);
    b->npeers = wire_get_count(in, PEER_MIN, MAX_PEERS);
    b->peers = p = msg_list_room(m, in, b->npeers, sizeof *p);
    if (!p)
        b->npeers = 0;
    for (uint32_t i = 0; i < b->npeers; i++) {
        p[i].name = wire_get_str(in, MSG_MAX_NAME);
        p[i].address = wire_get_str(in, MSG_MAX_ADDRESS);
        p[i].token = wire_get_view(in, MSG_TOKEN);
        p[i].flags = wire_get_u32(in);
        p[i].version = in->version >= 2 ? wire_get_u16(in) : 1;
        msg_must(in, p[i].flags <= (MSG_PEER_DIAL | MSG_PEER_GIVE) ||
                         (p[i].flags == MSG_PEER_DROP && in->version >= 2));
        msg_must(in, msg_common_version(p[i].version, p[i].version) != 0);
    }
}

void
msg_pack_peer_hello(struct wire_out *o, const struct msg_peer_hello *b)
{
    msg_put_job(o, b->job);
    wire_put_str(o, b->name, MSG_MAX_NAME);
    wire_put_bytes(o, b->token, MSG_TOKEN);
}

void
msg_unpack_peer_hello(struct wire_in *in, struct msg_peer_hello *b,
                      struct msg *m)
{
    (void)m;
    b->job = wire_get_view(in, MSG_JOB);
    b->name = wire_get_str(in, MSG_MAX_NAME);
    b->token = wire_get_view(in, MSG_TOKEN);
}

void
msg_pack_ambient(struct wire_out *o, const struct msg_ambient *b)
{
    wire_put_u32(o, b->to);
    wire_put_u32(o, b->count);
    wire_put_blob(o, b->data, b->len, MSG_MAX_AMBIENT);
}

void
msg_unpack_ambient(struct wire_in *in, struct msg_ambient *b, struct msg *m)
{
    (void)m;
    b->to = wire_get_u32(in);
    b->count = wire_get_u32(in);
    b->data = wire_get_blob(in, MSG_MAX_AMBIENT, &b->len);
    msg_must(in, b->count <= b->len);
}

void
msg_pack_records(struct wire_out *o, const struct msg_records *b)
{
    msg_put_job(o, b->job);
    wire_put_u32(o, b->count);
    wire_put_blob(o, b->data, b->len, MSG_MAX_AMBIENT);
}

void
msg_unpack_records(struct wire_in *in, struct msg_records *b, struct msg *m)
{
    (void)m;
    b->job = wire_get_view(in, MSG_JOB);
    b->count = wire_get_u32(in);
    b->data = wire_get_blob(in, MSG_MAX_AMBIENT, &b->len);
    msg_must(in, b->count <= b->len);
}

void
msg_pack_give(struct wire_out *o, const struct msg_give *b)
{
    wire_put_u32(o, b->to);
}

void
msg_unpack_give(struct wire_in *in, struct msg_give *b, struct msg *m)
{
    (void)m;
    b->to = wire_get_u32(in);
}
