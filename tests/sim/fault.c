/* fault.c - accidents, at any time and at chosen messages
 *
 * Workers die or drain, children die, connections are cut and lose what is
 * under way, processes stand still, or all that a worker sends or receives is
 * delayed.  Some accidents happen just before or after the n-th message of a
 * type is heard, to its sender, its receiver or a third worker. */
#include "config.h"

#include "cluster.h"

#include "base/rng.h"

/* Types at whose messages accidents happen.  Rare ones are listed several
 * times. */
static const enum msg_type types[] = {
    MSG_UNIT,     MSG_RESULT,    MSG_ACK,       MSG_REVOKE,     MSG_FACTS,
    MSG_PARKED,   MSG_BASE_LINE, MSG_LOST,      MSG_READY,      MSG_NEXT_HOLDER,
    MSG_ESTIMATE, MSG_ESTIMATED, MSG_JOB_PEERS, MSG_PEER_HELLO, MSG_SPLIT,
    MSG_SPLIT,    MSG_GAVE,      MSG_GAVE,      MSG_LEND,       MSG_LEND,
    MSG_LOAN,     MSG_LOAN,      MSG_BACK,      MSG_BACK,       MSG_PAID,
    MSG_PAID,     MSG_REVOKE,    MSG_REVOKE,    MSG_LOAN,       MSG_TILE,
    MSG_TILE,     MSG_TILE_MADE, MSG_TILE_MADE, MSG_FROZEN,     MSG_FROZEN,
    MSG_STAGE,    MSG_STAGE,     MSG_SHOW,      MSG_SHOW,       MSG_GUESS,
    MSG_FROZEN
};

#define NTYPES (sizeof types / sizeof types[0])

/* At which message of a type an accident happens.  Some types are rare: in few
 * clusters there are more than two messages of them. */
static uint32_t
which(struct net *net, enum msg_type type)
{
    if (type == MSG_SPLIT || type == MSG_GAVE || type == MSG_LEND ||
        type == MSG_LOAN || type == MSG_BACK || type == MSG_PAID ||
        type == MSG_REVOKE)
        return 1 + net_random(net, 2);
    if (type == MSG_SHOW)
        return 1;
    return 1 + net_random(net, net_chance(net, 3) ? 40 : 8);
}

static struct sim_fault
fault_of(struct net *net, unsigned type, unsigned blow)
{
    return (struct sim_fault){ .type = types[type],
                               .n = which(net, types[type]),
                               .victim = (enum sim_victim)net_random(net, 3),
                               .blow = (enum sim_blow)blow,
                               .after = net_chance(net, 2) };
}

/* The type and blow of the first accident go by the seed, so that all pairs of
 * these are tried about equally often. */
void
sim_make_faults(struct sim *s)
{
    static const unsigned every[] = { 0, 200, 60, 20, 12 };
    struct net *net = &s->net;

    s->accidents = every[net_random(net, 5)];
    s->orders = every[rad_mix64(net->seed + 90) % 5];
    s->net.repeats = net_chance(net, 3);
    s->fault[0] = fault_of(net, (unsigned)(net->seed % NTYPES),
                           (unsigned)(net->seed / NTYPES % SIM_NBLOW));
    for (int i = 1; i < SIM_FAULTS && net_chance(net, 2); i++)
        s->fault[i] =
            fault_of(net, net_random(net, NTYPES), net_random(net, SIM_NBLOW));
    if (net_chance(net, 4)) {
        s->accidents = 0;
        s->net.repeats = false;
        for (int i = 0; i < SIM_FAULTS; i++)
            s->fault[i].n = 0;
    }
}

void
sim_order(struct sim *s)
{
    int job = (int)net_random(&s->net, (unsigned)s->njobs);

    switch (net_random(&s->net, 8)) {
    case 0:
        s->priorities++;
        sim_admin_say(s, MSG_PRIORITY, job);
        break;
    case 1:
        s->rests++;
        sim_admin_say(s, net_chance(&s->net, 2) ? MSG_DRAIN : MSG_UNDRAIN,
                      (int)net_random(&s->net, (unsigned)s->nworkers));
        break;
    case 2:
    case 3:
    case 4:
        s->pauses++;
        sim_admin_say(s, MSG_PAUSE, job);
        break;
    default:
        sim_admin_say(s, MSG_RESUME, job);
    }
}

/* A random child of the worker; -1: none. */
static int
child_of(struct sim *s, int worker)
{
    int first = (int)net_random(&s->net, SIM_CHILDREN);

    for (int i = 0; i < SIM_CHILDREN; i++) {
        int k = (first + i) % SIM_CHILDREN;

        if (s->net.ops[NODE_CHILD + k] && s->child[k].worker == worker)
            return k;
    }
    return -1;
}

static void
cut_peers(struct sim *s, int worker)
{
    s->peer_cuts += net_cut(&s->net, NODE_WORKER + worker, NODE_WORKER,
                            NODE_WORKER + SIM_WORKERS - 1);
}

static bool
strike(struct sim *s, int worker, enum sim_blow blow)
{
    int child;

    if (!s->worker[worker].machine)
        return false;
    switch (blow) {
    case SIM_WORKER_DIES:
        s->deaths++;
        sim_worker_dies(s, worker);
        break;
    case SIM_CHILD_DIES:
        child = child_of(s, worker);
        if (child < 0)
            return false;
        sim_crash(s, child);
        break;
    case SIM_PEERS_CUT:
        cut_peers(s, worker);
        break;
    case SIM_COORD_DIES:
        if (!s->keeps)
            return false;
        sim_coord_dies(s);
        break;
    default:
        sim_coord_cut(s, worker);
    }
    return true;
}

/* Delay what a worker receives, sends, or both, for less time than it takes to
 * be declared dead for silence. */
static void
part(struct sim *s, int worker)
{
    unsigned way = net_random(&s->net, 3);

    s->parted++;
    net_hold(&s->net, NODE_WORKER + worker, net_random(&s->net, 14000),
             way != 0, way != 1);
}

static void
drain(struct sim *s, int i)
{
    struct sim_worker *w = &s->worker[i];

    s->drains++;
    if (net_chance(&s->net, 3)) {
        worker_drain(w->machine, s->net.now_ms);
        sim_worker_actions(s, i);
    } else {
        sim_admin_say(s, net_chance(&s->net, 2) ? MSG_DRAIN : MSG_UNDRAIN, i);
    }
}

void
sim_accident(struct sim *s)
{
    int i = (int)net_random(&s->net, (unsigned)s->nworkers);
    struct sim_worker *w = &s->worker[i];

    if (!w->machine)
        return;
    switch (net_random(&s->net, 8)) {
    case 0:
        drain(s, i);
        break;
    case 1:
    case 2:
        w->stopped_ms = s->net.now_ms + net_random(&s->net, 3000);
        s->stops++;
        break;
    case 3:
        strike(s, i, SIM_CHILD_DIES);
        break;
    case 4:
        part(s, i);
        break;
    default:
        strike(s, i, (enum sim_blow)net_random(&s->net, SIM_NBLOW));
    }
}

/* The worker of a node that is a worker or a child; -1: the node is neither. */
static int
worker_of(const struct sim *s, int node)
{
    if (node >= NODE_CHILD)
        return s->child[node - NODE_CHILD].worker;
    return node >= NODE_WORKER && node < NODE_WORKER + SIM_WORKERS
               ? node - NODE_WORKER
               : -1;
}

/* The worker to which the accident happens. */
static int
victim_of(struct sim *s, const struct sim_fault *f, int from, int to)
{
    int a = worker_of(s, from), b = worker_of(s, to);
    int first = (int)net_random(&s->net, (unsigned)s->nworkers);

    if (f->victim == SIM_GIVER && a >= 0)
        return a;
    if (f->victim == SIM_RECEIVER && b >= 0)
        return b;
    for (int i = 0; i < s->nworkers; i++) {
        int w = (first + i) % s->nworkers;

        if (w != a && w != b && s->worker[w].machine)
            return w;
    }
    return a >= 0 ? a : b;
}

void
sim_hear(struct net *net, int from, int to, const struct msg *m, bool after)
{
    struct sim *s = sim_of(net);

    if (s->calm)
        return;
    for (int i = 0; i < SIM_FAULTS; i++) {
        struct sim_fault *f = &s->fault[i];
        int w;

        if (f->n == 0 || f->type != m->type || f->after != after || --f->n > 0)
            continue;
        w = victim_of(s, f, from, to);
        if (w >= 0 && strike(s, w, f->blow))
            s->blows[f->type][f->blow]++;
    }
}
