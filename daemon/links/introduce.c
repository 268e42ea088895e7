/* introduce.c - see introduce.h
 *
 * Each pair of workers gets a token of its own, for this link only.  linking.c
 * decides which pairs are linked. */
#include "config.h"

#include "links/introduce.h"

#include "jobs/part.h"

/* Tell worker `to` of worker `about`. */
static void
send_peer(struct coord *c, const struct coord_worker *to, const uint8_t *job,
          const struct coord_worker *about, struct msg_peer peer)
{
    struct msg m = { .type = MSG_JOB_PEERS, .job_peers = { job, 1, &peer } };

    peer.name = about->name;
    peer.version =
        (uint16_t)(about->version < to->version ? about->version : to->version);
    actions_send(&c->actions, to->conn, &m);
}

bool
introduce_can(const struct coord_worker *a, const struct coord_worker *b)
{
    return a->address[0] != '\0' || b->address[0] != '\0';
}

bool
introduce_link(struct coord *c, const struct job *job,
               const struct coord_worker *a, const struct coord_worker *b)
{
    bool dial = a->address[0] != '\0'; /* b dials a, where a can be dialled */
    uint8_t token[MSG_TOKEN];

    if (!introduce_can(a, b))
        return false;
    c->env.random(c->env.arg, token, sizeof token);
    send_peer(c, a, job->id, b,
              (struct msg_peer){ .address = dial ? "" : b->address,
                                 .token = token,
                                 .flags = dial ? 0 : MSG_PEER_DIAL });
    send_peer(c, b, job->id, a,
              (struct msg_peer){ .address = dial ? a->address : "",
                                 .token = token,
                                 .flags = dial ? MSG_PEER_DIAL : 0 });
    return true;
}

void
introduce_worker(struct coord *c, const struct job *job, uint32_t index,
                 uint32_t most)
{
    const struct coord_worker *w = job->workers[index].worker;

    for (uint32_t k = 1; k < job->nworkers && most > 0; k++) {
        uint32_t i = (index + job->nworkers - k) % job->nworkers;
        const struct coord_worker *o = job->workers[i].worker;

        if (desk_is_ready(job, i) && introduce_link(c, job, o, w))
            most--;
    }
}

void
introduce_unlink(struct coord *c, const struct job *job,
                 const struct coord_worker *to,
                 const struct coord_worker *about)
{
    static const uint8_t none[MSG_TOKEN];

    send_peer(c, to, job->id, about,
              (struct msg_peer){
                  .address = "", .token = none, .flags = MSG_PEER_DROP });
}

void
introduce_drop(struct coord *c, const struct job *job,
               const struct coord_worker *w)
{
    for (uint32_t i = 0; i < job->nworkers; i++) {
        const struct coord_worker *o = job->workers[i].worker;

        if (o != w && o->conn != 0 && part_is_here(&job->workers[i]))
            introduce_unlink(c, job, o, w);
    }
}
