/* cluster.c - see cluster.h */
#include "config.h"

#include "cluster.h"

#include "base/rng.h"
#include "worker/peer.h"
#include "desk/desk.h"
#include "jobs/attempt.h"
#include "jobs/job.h"
#include "jobs/part.h"
#include "jobs/unit.h"
#include "front/coord.h"
#include "strict/strict_state.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define TROUBLE_MS 20000u /* until then accidents happen */
#define SPARE_MS   30000u /* time to spare, for messages that are slow */

int
sim_find_job(const struct sim *s, const uint8_t id[MSG_JOB])
{
    for (int i = 0; i < s->njobs; i++)
        if (memcmp(s->job[i].id, id, MSG_JOB) == 0)
            return i;
    net_fail(&s->net, __FILE__, __LINE__, "unknown job");
}

int
sim_file(const uint8_t hash[MSG_HASH])
{
    return hash[0];
}

/* --- the coordinator's shell --- */

static void
coord_put_chunk(struct sim *s, uint64_t conn, const struct msg_chunk *c)
{
    if (c->offset + c->len < c->total)
        return;
    s->store[sim_file(c->hash)] = true;
    coord_file_stored(s->coord, s->net.now_ms, conn, c->hash);
}

static void
send_file(struct sim *s, uint64_t conn, const uint8_t *hash)
{
    struct msg m = { .type = MSG_CHUNK,
                     .chunk = { hash, 0, 10, (const uint8_t *)"helloworld",
                                10 } };

    SIM_CHECK(&s->net, s->store[sim_file(hash)]);
    net_send_msg(&s->net, NODE_COORD, conn, &m);
}

/* Send the statistics of a job that is over, from the disk. */
static void
send_stats(struct sim *s, const struct action *a, int job)
{
    const char *text = s->job[job].kept.stats;
    struct msg m = { .type = MSG_CHUNK, .request = a->request };

    if (a->what == MSG_WHAT_PREVIEW) {
        m = (struct msg){ .type = MSG_FAILED,
                          .request = a->request,
                          .failed = { a->job, EX_NOINPUT,
                                      "no pictures here" } };
        net_send_msg(&s->net, NODE_COORD, a->conn, &m);
        return;
    }
    SIM_CHECK(&s->net, a->what == MSG_WHAT_STATS && text != NULL);
    m.chunk.total = strlen(text);
    for (size_t at = 0; at < m.chunk.total; at += m.chunk.len) {
        m.chunk.offset = at;
        m.chunk.data = (const uint8_t *)text + at;
        m.chunk.len = m.chunk.total - at < MSG_MAX_CHUNK ? m.chunk.total - at
                                                         : MSG_MAX_CHUNK;
        net_send_msg(&s->net, NODE_COORD, a->conn, &m);
    }
}

static void
coord_action(struct sim *s, const struct action *a)
{
    struct net *net = &s->net;
    int job = a->job ? sim_find_job(s, a->job) : 0;

    switch (a->type) {
    case ACT_SEND:
        net_send(net, NODE_COORD, a->conn, a->bytes, a->len);
        break;
    case ACT_SESSION:
        net_session(net, NODE_COORD, a->conn, a->session, a->version);
        break;
    case ACT_CLOSE:
        net_close(net, NODE_COORD, a->conn);
        break;
    case ACT_LOG:
        if (net->verbose)
            printf("%8llu coord: %s\n", (unsigned long long)net->now_ms,
                   a->text);
        break;
    case ACT_PUT_CHUNK:
        coord_put_chunk(s, a->conn, &a->chunk);
        break;
    case ACT_SEND_FILE:
        send_file(s, a->conn, a->hash);
        break;
    case ACT_DROP_FILES: /* they were sent at once */
        break;
    case ACT_SEND_PICTURE:
        send_stats(s, a, job);
        break;
    case ACT_PUT_COLOURS:
        sim_check_colours(net, &s->job[job], &a->colours);
        break;
    case ACT_DRAINED:
        for (int i = 0; i < s->nworkers; i++)
            if (strcmp(s->worker[i].name, a->text) == 0)
                s->worker[i].drained = a->status != 0;
        break;
    case ACT_OPTIONS:
        snprintf(s->job[job].options, sizeof s->job[job].options, "%s",
                 a->text);
        break;
    case ACT_WRITE_PICTURE:
        sim_check_options(net, &s->job[job]);
        sim_disk(s, a, job);
        break;
    case ACT_JOB_OPEN:
    case ACT_JOB_STATE:
    case ACT_JOB_END:
    case ACT_SETTLE:
    case ACT_KEEP_UNIT:
    case ACT_PUT_PASS:
    case ACT_LOAD_CACHE:
    case ACT_PUT_ROWS:
        sim_disk(s, a, job);
        break;
    default:
        net_fail(net, __FILE__, __LINE__, "no action of a coordinator");
    }
}

/* Take a machine's action into the cluster's digest (FNV-1a), log lines
 * excepted: two programs that decide alike have the same digest for each seed.
 */
static void
digest_bytes(struct sim *s, const void *bytes, size_t len)
{
    const uint8_t *b = bytes;

    for (size_t i = 0; b && i < len; i++)
        s->digest = (s->digest ^ b[i]) * UINT64_C(1099511628211);
}

static void
digest_number(struct sim *s, uint64_t n)
{
    digest_bytes(s, &n, sizeof n);
}

static void
digest_action(struct sim *s, int node, const struct action *a)
{
    const struct action_rows *r = &a->rows;

    if (a->type == ACT_LOG)
        return;
    digest_number(s, (uint64_t)node << 32 | (uint64_t)a->type);
    digest_number(s, s->net.now_ms);
    digest_number(s, a->conn);
    digest_number(s, (uint64_t)a->request << 32 | (uint32_t)a->status);
    digest_bytes(s, a->bytes, a->len);
    digest_bytes(s, a->job, MSG_JOB);
    digest_bytes(s, a->hash, MSG_HASH);
    digest_bytes(s, a->text, a->text ? strlen(a->text) : 0);
    if (a->type == ACT_PUT_ROWS) {
        digest_number(s, (uint64_t)r->unit << 32 | r->attempt);
        digest_number(s, (uint64_t)r->row << 32 | r->rows);
    }
}

/* Carry out the coordinator's actions.  That may cause further actions, which
 * are appended and carried out, too. */
void
sim_coord_actions(struct sim *s)
{
    struct action_list *l = coord_actions(s->coord);

    for (size_t i = 0; i < l->n; i++) {
        struct action a = l->v[i];

        if (a.type == ACT_LOG) {
            s->late += !!strstr(a.text, "unit late");
            SIM_CHECK(&s->net, !strstr(a.text, "duplicate differs"));
        }
        digest_action(s, NODE_COORD, &a);
        coord_action(s, &a);
    }
    SIM_CHECK(&s->net, !l->failed);
    actions_clear(l);
}

static void
coord_node_message(struct net *net, int node, uint64_t conn,
                   const struct msg *m)
{
    (void)node;
    coord_message(sim_of(net)->coord, net->now_ms, conn, m);
    sim_coord_actions(sim_of(net));
}

static void
coord_node_closed(struct net *net, int node, uint64_t conn)
{
    (void)node;
    coord_closed(sim_of(net)->coord, net->now_ms, conn, "closed");
    sim_coord_actions(sim_of(net));
}

static const struct node_ops coord_ops = { coord_node_message,
                                           coord_node_closed };

/* --- a worker's shell --- */

static bool
worker_has(void *arg, const uint8_t hash[MSG_HASH])
{
    struct sim_worker *w = arg;

    return w->cache[sim_file(hash)];
}

static void
worker_random(void *arg, void *buf, size_t n)
{
    struct sim_worker *w = arg;

    memset(buf, (int)(w->random++ * 37), n);
}

/* A task of the worker's store has looked for a job's files and for room. */
static void
looked(void *arg, struct event *e)
{
    struct net *net = arg;
    struct sim *s = sim_of(net);
    struct sim_worker *w = &s->worker[e->node];
    struct action_look l = { .why = "no room" };

    if (!w->machine || w->life != (unsigned)e->k)
        return;
    memcpy(l.job, e->bytes, MSG_JOB);
    if (!s->calm && net_chance(net, 2))
        l.status = EX_IOERR;
    s->refused += l.status != 0;
    worker_looked(w->machine, net->now_ms, &l);
    sim_worker_actions(s, e->node);
}

/* In some clusters workers' disks are full now and then. */
static bool
worker_look(void *arg, const struct action_look *l)
{
    struct sim_worker *w = arg;
    struct sim *s = w->sim;
    struct event *e;

    if (s->net.seed % 7 != 0)
        return true;
    e = net_later(&s->net, net_random(&s->net, 30), looked);
    e->node = (int)(w - s->worker);
    e->k = (int)w->life;
    event_take(e, l->job, MSG_JOB);
    return false;
}

static const struct node_ops worker_ops;

/* A dial ends: with a link, if the other side lives. */
static void
dialled(void *arg, struct event *e)
{
    struct net *net = arg;
    struct sim *s = sim_of(net);
    int other = e->k;
    struct sim_worker *w = &s->worker[e->node];
    uint64_t there = ++net->next_conn;

    if (!w->machine || w->life != (unsigned)e->len || e->n == w->given_up)
        return;
    if (!net->ops[other] || (!s->calm && net_chance(net, 10))) {
        worker_closed(w->machine, net->now_ms, e->n, "refused");
        sim_worker_actions(s, e->node);
        return;
    }
    net_join(net, NODE_WORKER + e->node, e->n, other, there, MSG_NSESSION,
             other == NODE_COORD ? MSG_AT_COORD_NEW : MSG_AT_PEER_NEW);
    if (other == NODE_COORD) {
        coord_opened(s->coord, net->now_ms, there,
                     &(struct coord_peer){ w->name, "daemon",
                                           1u << MSG_ROLE_WORKER, NULL });
        sim_coord_actions(s);
    } else {
        worker_accepted(s->worker[other - NODE_WORKER].machine, net->now_ms,
                        there);
        sim_worker_actions(s, other - NODE_WORKER);
    }
    worker_opened(w->machine, net->now_ms, e->n);
    sim_worker_actions(s, e->node);
}

static void
dial(struct sim *s, int worker, uint64_t conn, const char *address)
{
    struct event *e = net_later(&s->net, net_random(&s->net, 30), dialled);

    e->node = worker;
    e->k = address[0] ? NODE_WORKER + atoi(address + 4) : NODE_COORD;
    e->n = conn;
    e->len = s->worker[worker].life;
}

static void
worker_put_chunk(struct sim *s, int worker, const struct msg_chunk *c)
{
    struct sim_worker *w = &s->worker[worker];

    w->cache[sim_file(c->hash)] = true;
    worker_file_stored(w->machine, s->net.now_ms, c->hash);
}

static void left(void *net, struct event *e);

static void
worker_action(struct sim *s, int i, const struct action *a)
{
    struct net *net = &s->net;
    struct event *e;
    int node = NODE_WORKER + i;

    switch (a->type) {
    case ACT_SEND:
        net_send(net, node, a->conn, a->bytes, a->len);
        worker_written(s->worker[i].machine, net->now_ms, a->conn, a->len);
        break;
    case ACT_SESSION:
        net_session(net, node, a->conn, a->session, a->version);
        break;
    case ACT_CLOSE:
        if (net_find(net, node, a->conn))
            net_close(net, node, a->conn);
        else
            s->worker[i].given_up = a->conn; /* it was still dialling */
        break;
    case ACT_LOG:
        if (net->verbose)
            printf("%8llu %s: %s\n", (unsigned long long)net->now_ms,
                   s->worker[i].name, a->text);
        break;
    case ACT_PUT_CHUNK:
        worker_put_chunk(s, i, &a->chunk);
        break;
    case ACT_DIAL:
        dial(s, i, a->conn, a->text);
        break;
    case ACT_SPAWN:
        sim_spawn(s, i, a->conn);
        break;
    case ACT_KILL:
        sim_kill(s, i, a->conn);
        break;
    case ACT_STOP:
        SIM_CHECK(net, a->status == 0);
        e = net_later(net, net_random(net, 20), left);
        e->node = i;
        e->k = (int)s->worker[i].life;
        break;
    default:
        net_fail(net, __FILE__, __LINE__, "no action of a worker here");
    }
}

void
sim_worker_actions(struct sim *s, int i)
{
    struct action_list *l = worker_actions(s->worker[i].machine);

    for (size_t k = 0; k < l->n; k++) {
        struct action a = l->v[k];

        digest_action(s, NODE_WORKER + i, &a);
        worker_action(s, i, &a);
    }
    SIM_CHECK(&s->net, !l->failed);
    actions_clear(l);
}

static void
worker_node_message(struct net *net, int node, uint64_t conn,
                    const struct msg *m)
{
    worker_message(sim_of(net)->worker[node - NODE_WORKER].machine, net->now_ms,
                   conn, m);
    sim_worker_actions(sim_of(net), node - NODE_WORKER);
}

static bool
is_child(const struct worker *machine, uint64_t conn)
{
    for (const struct wjob *job = machine->jobs; job; job = job->next)
        if (job->child == conn)
            return true;
    return false;
}

static void
worker_node_closed(struct net *net, int node, uint64_t conn)
{
    struct worker *machine = sim_of(net)->worker[node - NODE_WORKER].machine;

    if (is_child(machine, conn))
        worker_child_ended(machine, net->now_ms, conn, EX_SOFTWARE,
                           "killed by signal 11");
    else
        worker_closed(machine, net->now_ms, conn, "closed");
    sim_worker_actions(sim_of(net), node - NODE_WORKER);
}

static const struct node_ops worker_ops = { worker_node_message,
                                            worker_node_closed };

static void
birth(struct sim *s, int i)
{
    struct sim_worker *w = &s->worker[i];
    struct worker_env env = { .has_file = worker_has,
                              .random = worker_random,
                              .arg = w,
                              .look = worker_look,
                              .program = "radd",
                              .name = w->name,
                              .coordinator = "sim",
                              .address = w->address,
                              .threads = w->threads };

    snprintf(w->name, sizeof w->name, "ws%d", i);
    snprintf(w->address, sizeof w->address, "sim %d", i);
    w->life++;
    w->sim = s;
    w->given_up = 0; /* a new life counts its connections from 1 again */
    w->machine = worker_new(&env);
    SIM_CHECK(&s->net, w->machine != NULL);
    s->net.ops[NODE_WORKER + i] = &worker_ops;
    worker_start(w->machine, s->net.now_ms);
    sim_worker_actions(s, i);
}

static void
reborn(void *net, struct event *e)
{
    if (!sim_of(net)->worker[e->node].machine)
        birth(sim_of(net), e->node);
}

void
sim_worker_dies(struct sim *s, int i)
{
    net_close_all(&s->net, NODE_WORKER + i);
    s->net.ops[NODE_WORKER + i] = NULL;
    worker_free(s->worker[i].machine);
    s->worker[i].machine = NULL;
    net_later(&s->net, net_random(&s->net, 4000), reborn)->node = i;
}

/* A worker that has drained ends. */
static void
left(void *net, struct event *e)
{
    struct sim_worker *w = &sim_of(net)->worker[e->node];

    if (w->machine && w->life == (unsigned)e->k)
        sim_worker_dies(sim_of(net), e->node);
}

void
sim_coord_cut(struct sim *s, int i)
{
    struct worker *machine = s->worker[i].machine;
    uint64_t conn;

    if (!machine || machine->coord == 0)
        return;
    conn = machine->coord;
    if (!net_find(&s->net, NODE_WORKER + i, conn))
        return;
    s->cuts++;
    if (net_chance(&s->net, 2)) {
        net_cut(&s->net, NODE_WORKER + i, NODE_COORD, NODE_COORD);
        return;
    }
    net_close(&s->net, NODE_WORKER + i, conn);
    worker_closed(machine, s->net.now_ms, conn, "cut");
    sim_worker_actions(s, i);
}

/* --- time, and accidents --- */

static void
tick(void *arg, struct event *e)
{
    struct net *net = arg;
    struct sim *s = sim_of(net);

    (void)e;
    coord_tick(s->coord, net->now_ms);
    sim_coord_actions(s);
    for (int i = 0; i < s->nworkers; i++)
        if (s->worker[i].machine) {
            worker_tick(s->worker[i].machine, net->now_ms);
            sim_worker_actions(s, i);
        }
    if (net->now_ms > TROUBLE_MS && !s->calm) {
        s->calm = true;
        net->repeats = false;
    }
    if (s->calm)
        sim_admin_relent(s);
    if (!s->calm && s->accidents && net_chance(net, s->accidents))
        sim_accident(s);
    if (!s->calm && s->orders && net_chance(net, s->orders))
        sim_order(s);
    net_later(net, 100, tick);
}

static void
late_worker(void *net, struct event *e)
{
    birth(sim_of(net), e->node);
}

/* Start a job's client.  If the job is to begin with another's cache it waits
 * until that job, the one before it, is over. */
static void
new_client(void *net, struct event *e)
{
    const struct sim_job *job = &sim_of(net)->job[e->node];

    if (job->reuses && !job[-1].stats)
        net_later(net, 200, new_client)->node = e->node;
    else
        sim_client_dial(sim_of(net), e->node);
}

/* Let a job leave its cache to others, if it can.  Half of the jobs that could
 * then begin with the cache of the job before do so.  Draws nothing from
 * net_random(). */
static void
choose_reuse(struct sim *s, int i)
{
    static const uint8_t scene[MSG_HASH] = { 1 };
    struct sim_job *job = &s->job[i];

    if (!(job->spec.flags & MSG_JOB_PASSES) || job->bounces == 0)
        return;
    job->spec.flags |= MSG_JOB_SCENE;
    job->spec.scene = scene;
    job->spec.reuse = job->from;
    job->reuses = i > 0 && job[-1].bounces == job->bounces &&
                  job[-1].spec.flags & MSG_JOB_SCENE &&
                  rad_mix64(s->net.seed + 79 + (uint64_t)i) % 2 == 0;
}

/* --- set-up --- */

static void
make_job(struct sim *s, int i)
{
    struct net *net = &s->net;
    struct sim_job *job = &s->job[i];
    bool goal = s->fault[0].type == MSG_STAGE || s->fault[0].type == MSG_SHOW;

    net_bytes(net, job->id, MSG_JOB);
    for (int f = 0; f < SIM_FILES; f++)
        job->hash[f * MSG_HASH] = (uint8_t)(i * SIM_FILES + f);
    job->spec = (struct msg_spec){
        .job = job->id,
        .manifest = job->hash,
        .name = "job",
        .needs = "mist glow",
        .seed = net->seed,
        .priority = (int32_t)net_random(net, 3) - 1,
        .flags = (net_chance(net, 2) ? MSG_JOB_SHARE : 0) |
                 (net_chance(net, 4) ? MSG_JOB_RECORDS : 0) |
                 (net_chance(net, 4) ? MSG_JOB_NO_BALANCE : 0) |
                 (net_chance(net, 4) ? MSG_JOB_FRESH_FRAMES : 0) |
                 (net_chance(net, 4) ? MSG_JOB_DEPTH : 0),
        .partition = (uint8_t)(net_chance(net, 8) ? MSG_PART_WINDOW
                                                  : net_random(net, MSG_NPART)),
        .order = (uint8_t)net_random(net, MSG_NORDER),
        .windows = 1 + net_random(net, 30),
        .files = { SIM_FILES, job->hash },
    };
    if (goal)
        job->spec.flags &= ~(uint32_t)(MSG_JOB_SHARE | MSG_JOB_FRESH_FRAMES);
    if (!(job->spec.flags & (MSG_JOB_SHARE | MSG_JOB_FRESH_FRAMES)) &&
        (goal || net_chance(net, 2)))
        job->spec.flags |= MSG_JOB_PASSES;
    job->watched = (job->spec.flags & MSG_JOB_PASSES) && /* draws nothing */
                   rad_mix64(net->seed + 79 + (unsigned)i) % 3 == 0;
    /* not by net_random(), so that few seeds change */
    if (job->spec.flags & MSG_JOB_PASSES &&
        (goal || rad_mix64(net->seed + 81 + (unsigned)i) % 2 == 0))
        job->spec.error_ppm =
            1 + (uint32_t)(rad_mix64(net->seed + 82) % 500000);
    sim_make_pictures(net, job);
    choose_reuse(s, i);
    job->poisoned = net_chance(net, 16);
    if (job->poisoned && job->spec.partition != MSG_PART_WINDOW)
        job->poison_y = sim_any_traced(net, job);
    job->cancel = net_chance(net, 6);
    job->vanish = net_chance(net, 4);
    net_later(net, net_random(net, 2000), new_client)->node = i;
}

static void
describe_strict(const struct strict_unit *u)
{
    fprintf(stderr, "  unit %u attempt %u frame %u lines %d to %d %s %s%s%s%s",
            u->unit, u->attempt, u->frame, u->first, u->last,
            strict_progress_steps.state[u->progress].name,
            strict_fate_steps.state[u->fate].name, u->loan ? " loan" : "",
            u->parked ? " parked" : "",
            u->lending.blocked ? " blocked by what it lends" : "");
    if (u->pass)
        fprintf(stderr, ", a pass of rank %d%s", u->pass->rank,
                u->pass->stop ? " is to stop" : "");
    fprintf(stderr, "\n");
}

/* Print the strict units of each child. */
static void
describe_children(const struct sim *s)
{
    for (int i = 0; i < SIM_CHILDREN; i++) {
        const struct strict *strict = s->child[i].strict;

        if (!strict)
            continue;
        fprintf(stderr, "child %d of ws%d, job %d\n", i, s->child[i].worker,
                s->child[i].job);
        for (const struct strict_unit *u = strict->units; u; u = u->next)
            describe_strict(u);
    }
}

/* Print the states of workers, jobs, units and attempts.  struct net is the
 * first member of struct sim. */
static void
describe(const struct net *net)
{
    const struct sim *s = (const struct sim *)net;

    for (int i = 0; i < s->nworkers; i++) {
        const struct worker *w = s->worker[i].machine;

        fprintf(stderr, "ws%d%s%s%s%s%s\n", i, w ? "" : " dead",
                w && w->coord_state == COORD_WELCOME ? " welcome" : "",
                w && w->jobs ? " busy" : "",
                w && w->draining ? " draining" : "",
                w && w->stopped ? " stopped" : "");
    }
    describe_children(s);
    if (!s->coord) {
        fprintf(stderr, "the coordinator is dead\n");
        return;
    }
    for (const struct coord_worker *w = s->coord->workers; w; w = w->next)
        fprintf(stderr,
                "%s conn %llx: %u in flight, %u parked, %u delivered%s%s%s%s\n",
                w->name, (unsigned long long)w->conn, w->in_flight, w->parked,
                w->delivered, w->loading ? " loading " : "",
                w->loading ? w->loading->hex : "", w->alone ? " alone" : "",
                w->drained   ? " drained"
                : w->leaving ? " leaving"
                             : "");
    for (size_t i = 0; i < s->coord->njobs; i++) {
        const struct job *job = s->coord->jobs[i];

        fprintf(stderr,
                "job %s %s %s partition %d flags %x waiting %u done %u\n",
                job->hex, job_state_name(job->state),
                life_places.state[job->place].name, job->spec.partition,
                job->spec.flags, job->partition ? job_waiting(job) : 0,
                job->units_done);
        for (uint32_t k = 0; k < job->nparts; k++)
            fprintf(stderr, "  %s: %s%s\n", job->parts[k].name,
                    part_steps.state[job->parts[k].state].name,
                    job->parts[k].late ? " late" : "");
        for (uint32_t k = 0; k < job->nunits; k++)
            if (job->units[k].state < UNIT_OUT)
                fprintf(stderr, "  unit %u %s\n", k,
                        unit_steps.state[job->units[k].state].name);
        for (uint32_t k = 0; k < job->nout; k++) {
            const struct job_unit *u = &job->units[job->out[k]];
            struct partition_area a;

            partition_area(job->partition, job->out[k], &a);
            fprintf(stderr,
                    "  unit %u frame %u rows %u to %u, %u here:", job->out[k],
                    a.frame, a.y, a.y + a.height, u->next_row);
            for (uint8_t g = 0; g < u->nattempts; g++)
                fprintf(stderr, " %s attempt %u %s%s%s",
                        job->parts[u->attempts[g].part].name,
                        u->attempts[g].number,
                        attempt_steps.state[u->attempts[g].state].name,
                        u->attempts[g].origin == ATTEMPT_LOAN ? " loan" : "",
                        u->attempts[g].handoff.top_sent ? " top sent" : "");
            fprintf(stderr, "\n");
        }
    }
}

void
sim_init(struct sim *s, uint64_t seed)
{
    struct net *net = &s->net;

    memset(s, 0, sizeof *s);
    net_init(net, seed);
    net->describe = describe;
    net->most_delay_ms = net_random(net, 120);
    /* most clusters are small: each worker sees more accidents */
    s->nworkers =
        1 + (int)net_random(net, net_chance(net, 4) ? SIM_WORKERS : 6);
    s->njobs = 1 + (int)net_random(net, SIM_JOBS);
    sim_make_faults(s);
    net->hear = sim_hear;
    s->direct = seed / 2 % 3; /* so records of tiles go by way of workers */
    s->keeps = !net_chance(net, 3);
    for (int i = 0; i < SIM_FAULTS; i++)
        s->keeps |= s->fault[i].blow == SIM_COORD_DIES;
    sim_coord_born(s);
    net->ops[NODE_COORD] = &coord_ops;
    for (int i = 0; i < s->nworkers; i++) {
        s->worker[i].threads = 1 + net_random(net, SIM_THREADS);
        s->worker[i].slow = net_chance(net, 3) ? 1 + net_random(net, 8) : 1;
        net_later(net, net_random(net, i < 2 ? 10 : 6000), late_worker)->node =
            i;
    }
    for (int i = 0; i < s->njobs; i++)
        make_job(s, i);
    sim_admin_dial(s);
    net_later(net, 100, tick);
}

/* Are all jobs over, and have the workers dropped them? */
static bool
at_rest(const struct sim *s)
{
    for (int i = 0; i < s->njobs; i++)
        if (!s->job[i].stats)
            return false;
    for (int i = 0; i < s->nworkers; i++)
        if (!s->worker[i].machine || s->worker[i].machine->jobs ||
            s->worker[i].machine->coord_state != COORD_WELCOME)
            return false;
    return true;
}

void
sim_run(struct sim *s)
{
    while (!at_rest(s)) {
        /* the limit is as if one thread did all the work: a stall exceeds it */
        bool late = (double)s->net.now_ms > TROUBLE_MS + SPARE_MS + s->work_ms;

        SIM_CHECK(&s->net, !late);
        SIM_CHECK(&s->net, net_step(&s->net));
    }
}

void
sim_release(struct sim *s)
{
    coord_free(s->coord);
    sim_children_release(s);
    for (int i = 0; i < s->nworkers; i++)
        worker_free(s->worker[i].machine);
    for (int i = 0; i < s->njobs; i++) {
        for (int f = 0; f < SIM_FRAMES; f++) {
            free(s->job[i].picture[f]);
            free(s->job[i].want[f]);
            free(s->job[i].line[f]);
        }
        free(s->job[i].stats);
        sim_disk_release(&s->job[i]);
    }
    net_release(&s->net);
}
