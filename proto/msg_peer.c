/* msg_peer.c - the codec of the messages by which workers find each other, and
 * of ambient records
 *
 * See msg_peer.h. */
#include "config.h"

#include "proto/codec.h"

#define PEER_MIN  26 /* bytes of a peer with empty strings */
#define MAX_PEERS 4096

static void
code_peer(struct codec *c, struct msg_peer *p)
{
    code_str(c, &p->name, MSG_MAX_NAME);
    code_str(c, &p->address, MSG_MAX_ADDRESS);
    code_view(c, &p->token, MSG_TOKEN);
    code_u32(c, &p->flags);
    code_u16(c, &p->version);
    code_read_must(c, p->flags <= MSG_PEER_DROP);
    code_read_must(c, msg_common_version(p->version, p->version) != 0);
}

void
msg_code_job_peers(struct codec *c, struct msg_job_peers *b)
{
    struct msg_peer *p;

    code_job(c, &b->job);
    p = code_list(c, b->peers, &b->npeers, PEER_MIN, MAX_PEERS, sizeof *p);
    for (uint32_t i = 0; i < b->npeers && !code_bad(c); i++)
        code_peer(c, &p[i]);
    b->peers = p;
}

void
msg_code_peer_hello(struct codec *c, struct msg_peer_hello *b)
{
    code_job(c, &b->job);
    code_str(c, &b->name, MSG_MAX_NAME);
    code_view(c, &b->token, MSG_TOKEN);
}

void
msg_code_ambient(struct codec *c, struct msg_ambient *b)
{
    code_u32(c, &b->count);
    code_blob(c, &b->data, &b->len, MSG_MAX_AMBIENT);
    code_read_must(c, b->count <= b->len);
}

void
msg_code_records(struct codec *c, struct msg_records *b)
{
    code_job(c, &b->job);
    code_u32(c, &b->count);
    code_blob(c, &b->data, &b->len, MSG_MAX_AMBIENT);
    code_read_must(c, b->count <= b->len);
}
