/* msg_peer.c - the codec of the messages by which workers find each other, and
 * of ambient records
 *
 * See msg_peer.h. */
#include "config.h"

#include "proto/codec.h"

#define PEER_MIN  26 /* bytes of a peer with empty strings */
#define MAX_PEERS 4096
#define LINK_MIN  11 /* bytes of a link of a ring with an empty name */
#define PART_MIN  12 /* bytes of a part without records */

static void
code_peer(struct codec *c, struct msg_peer *p)
{
    code_str(c, &p->name, MSG_MAX_NAME);
    code_str(c, &p->address, MSG_MAX_ADDRESS);
    code_view(c, &p->token, MSG_TOKEN);
    code_u32(c, &p->flags);
    code_u16(c, &p->version);
    code_read_must(c, p->flags <= (MSG_PEER_DIAL | MSG_PEER_GIVE) ||
                          p->flags == MSG_PEER_DROP);
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
    code_u32(c, &b->to);
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

void
msg_code_give(struct codec *c, struct msg_give *b)
{
    code_u32(c, &b->to);
}

static void
code_ring_link(struct codec *c, struct msg_ring_link *l, uint32_t places)
{
    code_u32(c, &l->offset);
    code_u32(c, &l->below);
    code_str(c, &l->name, MSG_MAX_NAME);
    code_read_must(c, l->offset == 0 || l->offset < places);
    code_read_must(c,
                   l->below <= l->offset && (l->below > 0) == (l->offset > 0));
}

void
msg_code_ring(struct codec *c, struct msg_ring *b)
{
    struct msg_ring_link *l;

    code_job(c, &b->job);
    code_u32(c, &b->generation);
    code_u32(c, &b->places);
    code_read_must(c, b->places <= MSG_MAX_PLACES);
    l = code_list(c, b->links, &b->nlinks, LINK_MIN, MAX_PEERS, sizeof *l);
    for (uint32_t i = 0; i < b->nlinks && !code_bad(c); i++)
        code_ring_link(c, &l[i], b->places);
    b->links = l;
}

void
msg_code_unlinked(struct codec *c, struct msg_unlinked *b)
{
    code_job(c, &b->job);
    code_str(c, &b->name, MSG_MAX_NAME);
    code_below(c, &b->was, 2);
}

static void
code_part(struct codec *c, struct msg_part *p)
{
    code_u32(c, &p->distance);
    code_u32(c, &p->count);
    code_blob(c, &p->data, &p->len, MSG_MAX_AMBIENT);
    code_read_must(c, p->distance > 0 && p->distance < MSG_MAX_PLACES);
    code_read_must(c, p->count <= p->len);
}

void
msg_code_spread(struct codec *c, struct msg_spread *b)
{
    struct msg_part *p;

    code_u32(c, &b->generation);
    p = code_list(c, b->parts, &b->nparts, PART_MIN, MSG_MAX_PARTS, sizeof *p);
    for (uint32_t i = 0; i < b->nparts && !code_bad(c); i++)
        code_part(c, &p[i]);
    b->parts = p;
}
