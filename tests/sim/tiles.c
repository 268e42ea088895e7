/* tiles.c - a child's ambient cache in passes: tiles take a while, and have
 * records by formula */
#include "config.h"

#include "cluster.h"

#include "base/rng.h"
#include "proto/ambshare.h"

#include <stdlib.h>
#include <string.h>

#define MOST_RECORDS 6
#define TILE_MS      30

/* The records of a tile, the same whoever makes it; returns how many. */
static uint32_t
records(const struct sim_job *job, uint32_t pass, uint32_t tile,
        uint8_t out[MOST_RECORDS * AMBSHARE_BYTES])
{
    uint64_t key = rad_mix64(job->look + pass * 1000 + tile);
    uint32_t n = (uint32_t)(key % (MOST_RECORDS + 1));

    for (uint32_t i = 0; i < n * AMBSHARE_BYTES; i++)
        out[i] = (uint8_t)(rad_mix64(key + i) >> 8);
    return n;
}

/* Of the pixel, by formula. */
static void
colour(const struct sim_job *job, uint32_t frame, int x, int y, uint8_t rgbe[4])
{
    uint64_t key = rad_mix64(job->look + frame) + (uint64_t)x * 65536;

    key = rad_mix64(key + (uint64_t)y);
    memcpy(rgbe, &key, 4);
}

/* The colours of a tile's lattice; returns their bytes. */
static size_t
colours(const struct sim_job *job, const struct rad_pass *pass, uint32_t tile,
        uint8_t out[MSG_MAX_COLOURS])
{
    uint32_t frame = pass->frame, n;
    struct rad_pass_area a;
    size_t len = 0;

    if (!rad_pass_shows(pass))
        return 0;
    for (; tile >= (n = rad_pass_tiles(pass, (int)job->frame[frame].width,
                                       (int)job->frame[frame].height));
         frame += pass->stride)
        tile -= n;
    a = rad_pass_area(pass, (int)job->frame[frame].width,
                      (int)job->frame[frame].height, tile);
    for (int y = a.y0; y < a.y1; y += pass->step)
        for (int x = a.x0; x < a.x1; x += pass->step, len += 4)
            colour(job, frame, x, y, out + len);
    return len;
}

void
sim_check_colours(struct net *net, const struct sim_job *job,
                  const struct action_colours *k)
{
    const uint8_t *at = k->rgbe;
    uint8_t want[4];

    SIM_CHECK(net, job->watched);
    for (int j = 0; j < k->rows; j++)
        for (int i = 0; i < k->columns; i++, at += 4) {
            int x = k->x + i * k->step, y = k->y + j * k->step;

            SIM_CHECK(net, x < (int)job->frame[k->frame].width &&
                               y < (int)job->frame[k->frame].height);
            colour(job, k->frame, x, y, want);
            SIM_CHECK(net, memcmp(at, want, 4) == 0);
        }
    sim_of(net)->colours++;
}

uint32_t
sim_plan(const struct sim_job *job, struct rad_pass plan[RAD_MOST_PASSES])
{
    struct rad_pass_size size[SIM_FRAMES];
    struct rad_params params;

    rad_params_init(&params);
    params.ambounce = job->bounces;
    params.psample = job->psample;
    for (uint32_t f = 0; f < job->spec.nframes; f++)
        size[f] = (struct rad_pass_size){ (int)job->frame[f].width,
                                          (int)job->frame[f].height };
    if (!(job->spec.flags & MSG_JOB_PASSES))
        return 0;
    return job->spec.flags & MSG_JOB_REUSE
               ? rad_passes_plan_on(&params, size, job->spec.nframes, plan)
               : rad_passes_plan(&params, size, job->spec.nframes, plan);
}

/* e->b: the tile; e->len: twice its pass, and 1 if its colours are wanted. */
static void
made(struct net *net, struct net_event *e)
{
    struct sim_child *k = sim_child_of(net, e->a);
    uint8_t data[MOST_RECORDS * AMBSHARE_BYTES], shown[MSG_MAX_COLOURS];
    struct rad_pass plan[RAD_MOST_PASSES];
    struct msg m = { .type = MSG_TILE_MADE };
    struct msg_tile_made *t = &m.tile_made;

    if (!net->ops[e->a] || k->conn != e->c || k->passes != e->len / 2)
        return; /* a pass that was closed */
    *t = (struct msg_tile_made){ .job = sim_of(net)->job[k->job].id,
                                 .pass = (uint32_t)e->len / 2,
                                 .tile = (uint32_t)e->b,
                                 .data = data };
    t->count = records(&sim_of(net)->job[k->job], t->pass, t->tile, data);
    t->len = (size_t)t->count * AMBSHARE_BYTES;
    sim_plan(&sim_of(net)->job[k->job], plan);
    t->colours = shown;
    if (e->len % 2)
        t->colours_len =
            colours(&sim_of(net)->job[k->job], &plan[t->pass], t->tile, shown);
    t->counts.rays = t->counts.ambient_rays = t->tile + 1;
    t->counts.cpu_s = .001;
    sim_of(net)->job[k->job].tile_rays += t->counts.rays;
    sim_of(net)->tiles++;
    net_send_msg(net, e->a, k->conn, &m);
}

void
sim_take_tile(struct net *net, int node, const struct msg_tile *m)
{
    struct sim_child *k = sim_child_of(net, node);
    const struct sim_worker *w = &sim_of(net)->worker[k->worker];
    struct rad_pass plan[RAD_MOST_PASSES];
    struct net_event *e;
    unsigned ms = net_random(net, TILE_MS) * w->slow;

    SIM_CHECK(net, m->pass == k->passes);
    SIM_CHECK(net, m->pass < sim_plan(&sim_of(net)->job[k->job], plan));
    SIM_CHECK(net, m->tile < plan[m->pass].tiles);
    SIM_CHECK(net, !m->colours || sim_of(net)->job[k->job].watched);
    if (w->stopped_ms > net->now_ms)
        ms += (unsigned)(w->stopped_ms - net->now_ms);
    sim_of(net)->work_ms += ms;
    e = net_later(net, ms, made);
    e->a = node;
    e->b = (int)m->tile;
    e->c = k->conn;
    e->len = 2 * (size_t)m->pass + m->colours;
}

/* Byte `at` and those that follow of a pass's records, tile after tile. */
static void
check_records(struct net *net, const struct sim_job *job,
              const struct msg_frozen *m, uint32_t tiles)
{
    uint8_t data[MOST_RECORDS * AMBSHARE_BYTES];
    uint32_t at = 0, left = m->count;
    const uint8_t *p = m->data;

    for (uint32_t i = 0; i < tiles; i++) {
        uint32_t n = records(job, m->pass, i, data);

        for (uint32_t k = 0; k < n; k++, at++) {
            if (at < m->first || left == 0)
                continue;
            SIM_CHECK(
                net, memcmp(p, data + k * AMBSHARE_BYTES, AMBSHARE_BYTES) == 0);
            p += AMBSHARE_BYTES;
            left--;
        }
    }
    SIM_CHECK(net, left == 0);
    SIM_CHECK(net, !m->last || m->first + m->count == at);
}

/* Those of the first pass where it is another job's cache. */
static void
check_reused(struct net *net, const struct sim_job *job,
             const struct msg_frozen *m)
{
    const struct saved_pass *first = &job->kept.pass[0];
    size_t at = (size_t)m->first * AMBSHARE_BYTES;

    SIM_CHECK(net, job->kept.npasses > 0 && at + m->len <= first->len);
    SIM_CHECK(net, memcmp(m->data, first->bytes + at, m->len) == 0);
    SIM_CHECK(net, !m->last || at + m->len == first->len);
    sim_of(net)->reused += m->last;
}

void
sim_take_frozen(struct net *net, int node, const struct msg_frozen *m)
{
    struct sim_child *k = sim_child_of(net, node);
    struct rad_pass plan[RAD_MOST_PASSES];

    SIM_CHECK(net, m->pass == k->passes);
    SIM_CHECK(net, m->pass < sim_plan(&sim_of(net)->job[k->job], plan));
    SIM_CHECK(net, m->first == 0 || m->first == k->nrecords);
    if (m->pass == 0 && sim_of(net)->job[k->job].spec.flags & MSG_JOB_REUSE)
        check_reused(net, &sim_of(net)->job[k->job], m);
    else
        check_records(net, &sim_of(net)->job[k->job], m, plan[m->pass].tiles);
    k->nrecords = m->first + m->count;
    if (!m->last)
        return;
    k->nrecords = 0;
    k->passes++;
    sim_of(net)->work_ms += TILE_MS; /* all wait for the slowest tile */
    sim_of(net)->passes++;
}

bool
sim_cache_is_whole(const struct sim *s, const struct sim_child *k)
{
    struct rad_pass plan[RAD_MOST_PASSES];

    return k->passes == sim_plan(&s->job[k->job], plan);
}
