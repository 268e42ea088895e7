/* linking.c - see linking.h
 *
 * job->links lists the links that linking_need() made; NULL: it made none. */
#include "config.h"

#include "desk/linking.h"

#include "jobs/job.h"
#include "jobs/part.h"

#include "base/list.h"

#include <stdlib.h>
#include <string.h>

#define MOST_LINKED 256 /* links of a new worker, with --ambient=live */
#define MOST_NEEDED 16  /* links of a worker that linking_need() made */

/* Two linked workers of the job, by index; a < b. */
struct pair {
    uint32_t a, b;
};

struct links {
    struct pair *pair; /* the oldest link first */
    size_t n;
};

void
linking_free(struct links *l)
{
    if (!l)
        return;
    free(l->pair);
    free(l);
}

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
linking_can(const struct coord_worker *a, const struct coord_worker *b)
{
    return a->address[0] != '\0' || b->address[0] != '\0';
}

/* Tell two workers of a job of each other; false: neither can be dialled.  Each
 * pair gets a token of its own, for this link only. */
static bool
introduce(struct coord *c, const struct job *job, const struct coord_worker *a,
          const struct coord_worker *b)
{
    bool dial = a->address[0] != '\0'; /* b dials a, where a can be dialled */
    uint8_t token[MSG_TOKEN];

    if (!linking_can(a, b))
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
linking_end(struct coord *c, const struct job *job,
            const struct coord_worker *to, const struct coord_worker *about)
{
    static const uint8_t none[MSG_TOKEN];

    send_peer(c, to, job->id, about,
              (struct msg_peer){
                  .address = "", .token = none, .flags = MSG_PEER_DROP });
}

void
linking_drop(struct coord *c, const struct job *job,
             const struct coord_worker *w)
{
    for (uint32_t i = 0; i < job->nparts; i++) {
        const struct coord_worker *o = job->parts[i].worker;

        if (o != w && o->conn != 0 && part_is_here(&job->parts[i]))
            linking_end(c, job, o, w);
    }
}

static bool
can_be_linked(const struct job *job, uint32_t a, uint32_t b)
{
    return a != b && desk_is_ready(job, a) && desk_is_ready(job, b) &&
           linking_can(job->parts[a].worker, job->parts[b].worker);
}

static bool
shares_records(const struct job *job)
{
    return job->spec.flags & MSG_JOB_SHARE;
}

static bool
pair_has(const struct pair *p, uint32_t index)
{
    return p->a == index || p->b == index;
}

/* Add a pair to the list; false: memory is out. */
static bool
note_link(struct links *l, uint32_t a, uint32_t b)
{
    if (!rad_list_grow(&l->pair, l->n, sizeof *l->pair))
        return false;
    l->pair[l->n++] = (struct pair){ a < b ? a : b, a < b ? b : a };
    return true;
}

static void
end_link(struct coord *c, struct job *job, size_t i)
{
    struct links *l = job->links;
    const uint32_t end[2] = { l->pair[i].a, l->pair[i].b };

    for (int k = 0; k < 2; k++)
        if (job->parts[end[k]].worker->conn != 0 &&
            part_is_here(&job->parts[end[k]]))
            linking_end(c, job, job->parts[end[k]].worker,
                        job->parts[end[!k]].worker);
    memmove(&l->pair[i], &l->pair[i + 1], (--l->n - i) * sizeof l->pair[0]);
}

void
linking_join(struct coord *c, struct job *job, uint32_t index)
{
    const struct coord_worker *w = job->parts[index].worker;
    uint32_t n = 0;

    if (!shares_records(job))
        return;
    for (uint32_t k = 1; k < job->nparts && n < MOST_LINKED; k++) {
        uint32_t i = (index + job->nparts - k) % job->nparts;

        n +=
            desk_is_ready(job, i) && introduce(c, job, job->parts[i].worker, w);
    }
}

void
linking_left(struct coord *c, struct job *job, uint32_t index)
{
    struct links *l = job->links;

    for (size_t i = l ? l->n : 0; i-- > 0;)
        if (pair_has(&l->pair[i], index))
            end_link(c, job, i);
}

/* End the worker's oldest link, if it has MOST_NEEDED links or more. */
static void
make_room(struct coord *c, struct job *job, uint32_t index)
{
    const struct links *l = job->links;
    size_t oldest = l->n, n = 0;

    for (size_t i = l->n; i-- > 0;)
        if (pair_has(&l->pair[i], index)) {
            oldest = i;
            n++;
        }
    if (n >= MOST_NEEDED)
        end_link(c, job, oldest);
}

static bool
is_linked(const struct links *l, uint32_t a, uint32_t b)
{
    for (size_t i = 0; i < l->n; i++)
        if (pair_has(&l->pair[i], a) && pair_has(&l->pair[i], b))
            return true;
    return false;
}

void
linking_need(struct coord *c, struct job *job, uint32_t a, uint32_t b)
{
    if (shares_records(job) || !can_be_linked(job, a, b))
        return;
    if (!job->links)
        job->links = calloc(1, sizeof *job->links);
    if (!job->links) {
        c->actions.failed = true;
        return;
    }
    if (is_linked(job->links, a, b))
        return;
    make_room(c, job, a);
    make_room(c, job, b);
    introduce(c, job, job->parts[a].worker, job->parts[b].worker);
    if (!note_link(job->links, a, b))
        c->actions.failed = true;
}
