/* client.c - radsubmit, played: sends files and submits; some clients cancel,
 * some vanish and come back.  And an administrator */
#include "config.h"

#include "cluster.h"
#include "desk/desk.h"
#include "front/coord.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct sim_job *
job_of(struct net *net, int node)
{
    return &sim_of(net)->job[node - NODE_CLIENT];
}

static void
send_chunk(struct net *net, int node, const uint8_t *hash, uint32_t request)
{
    struct msg m = { .type = MSG_CHUNK, .request = request };
    uint64_t half = 5;

    for (int i = 0; i < 2; i++) {
        m.chunk = (struct msg_chunk){ hash, i * half, 2 * half,
                                      (const uint8_t *)"helloworld" + i * half,
                                      half };
        net_send_msg(net, node, job_of(net, node)->conn, &m);
    }
}

static void
submit(struct net *net, int node)
{
    struct sim_job *job = job_of(net, node);
    static const uint8_t any[MSG_JOB];
    struct msg m = { .type = MSG_SUBMIT, .request = 7, .submit = job->spec };

    m.submit.flags &= ~MSG_JOB_REUSE;
    m.submit.flags |= job->reuses ? MSG_JOB_REUSE : 0;
    m.submit.reuse = any;
    net_send_msg(net, node, job->conn, &m);
}

static void
cancel(void *net, struct event *e)
{
    struct sim_job *job = job_of(net, e->node);
    struct msg m = { .type = MSG_CANCEL, .request = 8, .cancel = { job->id } };

    if (job->done || job->failed || job->conn == 0)
        return;
    net_send_msg(net, e->node, job->conn, &m);
}

static void
dial_again(void *net, struct event *e)
{
    sim_client_dial(sim_of(net), e->node - NODE_CLIENT);
}

static void
vanish(void *net, struct event *e)
{
    struct sim_job *job = job_of(net, e->node);

    if (job->done || job->failed || job->conn == 0)
        return;
    net_close(net, e->node, job->conn);
    job->conn = 0;
    net_later(net, net_random(net, 5000), dial_again)->node = e->node;
}

/* Ask for a preview, though there may be none yet. */
static void
ask_preview(struct net *net, int node)
{
    struct sim_job *job = job_of(net, node);
    struct msg m = { .type = MSG_FETCH,
                     .request = 10,
                     .fetch = { job->id, 0, MSG_WHAT_PREVIEW } };

    net_send_msg(net, node, job->conn, &m);
}

static void
accepted(struct net *net, int node)
{
    struct sim_job *job = job_of(net, node);

    if (job->watched)
        ask_preview(net, node);
    if (!job->accepted && job->cancel)
        net_later(net, net_random(net, 1500), cancel)->node = node;
    if (!job->accepted && job->vanish)
        net_later(net, net_random(net, 1500), vanish)->node = node;
    job->accepted = true;
}

static void
ask_stats(struct net *net, int node)
{
    struct sim_job *job = job_of(net, node);
    struct msg m = { .type = MSG_FETCH,
                     .request = 9,
                     .fetch = { job->id, 0, MSG_WHAT_STATS } };

    net_send_msg(net, node, job->conn, &m);
}

static void
failed(struct net *net, int node, const struct msg *m)
{
    struct sim_job *job = job_of(net, node);

    SIM_CHECK(net, m->request == 7 || m->request == 8 || m->request == 10);
    if (m->request != 7)
        return; /* too late to cancel, or no preview */
    job->failed = true;
    job->status = m->failed.status;
    snprintf(job->text, sizeof job->text, "%s", m->failed.text);
    ask_stats(net, node);
}

static void
add_stats(struct net *net, struct sim_job *job, const struct msg_chunk *c)
{
    SIM_CHECK(net, c->offset == job->stats_len);
    job->stats = realloc(job->stats, job->stats_len + c->len + 1);
    SIM_CHECK(net, job->stats != NULL);
    memcpy(job->stats + job->stats_len, c->data, c->len);
    job->stats_len += c->len;
    job->stats[job->stats_len] = '\0';
    job->partial = job->stats_len < c->total;
}

static void
message(struct net *net, int node, uint64_t conn, const struct msg *m)
{
    struct sim_job *job = job_of(net, node);
    struct msg offer = { .type = MSG_OFFER, .offer = job->spec.files };

    switch (m->type) {
    case MSG_WELCOME:
        net_session(net, node, conn, MSG_AT_CLIENT, m->welcome.version);
        net_send_msg(net, node, conn, &offer);
        break;
    case MSG_WANT:
        for (uint32_t i = 0; i < m->want.n; i++)
            send_chunk(net, node, m->want.hash + i * MSG_HASH, m->request);
        submit(net, node);
        break;
    case MSG_ACCEPT:
        accepted(net, node);
        break;
    case MSG_PROGRESS:
        SIM_CHECK(net, m->progress.pixels_done <= m->progress.pixels_total);
        SIM_CHECK(net, m->progress.units_done <= m->progress.units_total);
        break;
    case MSG_DONE:
        job->done = true;
        ask_stats(net, node);
        break;
    case MSG_FAILED:
        failed(net, node, m);
        break;
    case MSG_CHUNK:
        add_stats(net, job, &m->chunk);
        break;
    }
}

/* The connection has ended.  Only a dying coordinator ends those of clients. */
static void
closed(struct net *net, int node, uint64_t conn)
{
    struct sim_job *job = job_of(net, node);

    SIM_CHECK(net, sim_of(net)->coord_deaths > 0);
    if (job->conn != conn || (job->stats && !job->partial))
        return;
    job->conn = 0;
    net_later(net, net_random(net, 2000), dial_again)->node = node;
}

const struct node_ops sim_client_ops = { message, closed };

void
sim_client_dial(struct sim *s, int job)
{
    struct net *net = &s->net;
    int node = NODE_CLIENT + job;
    uint64_t there = ++net->next_conn;
    struct coord_peer peer = { "sim", "ana", 1u << MSG_ROLE_USER, NULL };
    struct msg hello = { .type = MSG_HELLO,
                         .hello = { MSG_VERSION_MIN, MSG_VERSION, MSG_ROLE_USER,
                                    "", "radsubmit", "", 0, 0 } };

    s->job[job].conn = ++net->next_conn;
    s->job[job].stats_len = 0;
    s->job[job].failed = s->job[job].done = false;
    net->ops[node] = &sim_client_ops;
    net_join(net, node, s->job[job].conn, NODE_COORD, there, MSG_AT_DIALLER,
             MSG_AT_COORD_NEW);
    coord_opened(s->coord, net->now_ms, there, &peer);
    sim_coord_actions(s);
    net_send_msg(net, node, s->job[job].conn, &hello);
}

/* --- an administrator, who steers jobs and workers --- */

static void
admin_message(struct net *net, int node, uint64_t conn, const struct msg *m)
{
    if (m->type != MSG_WELCOME)
        return;
    sim_of(net)->admin_welcome = true;
    net_session(net, node, conn, MSG_AT_CLIENT, m->welcome.version);
}

static void
admin_again(void *net, struct event *e)
{
    (void)e;
    sim_admin_dial(sim_of(net));
}

static void
admin_closed(struct net *net, int node, uint64_t conn)
{
    (void)node;
    if (sim_of(net)->admin != conn)
        return;
    sim_of(net)->admin = 0;
    net_later(net, net_random(net, 200), admin_again);
}

const struct node_ops sim_admin_ops = { admin_message, admin_closed };

void
sim_admin_dial(struct sim *s)
{
    struct net *net = &s->net;
    uint64_t there = ++net->next_conn;
    struct coord_peer peer = { "sim", "root", 1u << MSG_ROLE_ADMIN, NULL };
    struct msg hello = { .type = MSG_HELLO,
                         .hello = { MSG_VERSION_MIN, MSG_VERSION,
                                    MSG_ROLE_ADMIN, "", "radctl", "", 0, 0 } };

    s->admin = ++net->next_conn;
    s->admin_welcome = false;
    net->ops[NODE_ADMIN] = &sim_admin_ops;
    net_join(net, NODE_ADMIN, s->admin, NODE_COORD, there, MSG_AT_DIALLER,
             MSG_AT_COORD_NEW);
    coord_opened(s->coord, net->now_ms, there, &peer);
    sim_coord_actions(s);
    net_send_msg(net, NODE_ADMIN, s->admin, &hello);
}

void
sim_admin_say(struct sim *s, enum msg_type type, int i)
{
    struct msg m = { .type = (uint16_t)type, .request = 5 };

    if (s->admin == 0 || !s->admin_welcome)
        return;
    if (type == MSG_DRAIN || type == MSG_UNDRAIN)
        m.drain.name = s->worker[i].name;
    else
        m.pause.job = s->job[i].id;
    if (type == MSG_PRIORITY)
        m.priority.priority = (int32_t)net_random(&s->net, 5) - 2;
    net_send_msg(&s->net, NODE_ADMIN, s->admin, &m);
}

static int
worker_named(const struct sim *s, const char *name)
{
    for (int i = 0; i < s->nworkers; i++)
        if (strcmp(s->worker[i].name, name) == 0)
            return i;
    return -1;
}

void
sim_admin_relent(struct sim *s)
{
    for (const struct coord_worker *w = s->coord->workers; w; w = w->next)
        if (w->drained)
            sim_admin_say(s, MSG_UNDRAIN, worker_named(s, w->name));
    for (size_t i = 0; i < s->coord->njobs; i++)
        if (s->coord->jobs[i]->state == JOB_PAUSED)
            sim_admin_say(s, MSG_RESUME,
                          sim_find_job(s, s->coord->jobs[i]->id));
}
