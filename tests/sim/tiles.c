/* tiles.c - a child's ambient cache in passes: tiles take some time, and their
 * records come from a formula */
#include "config.h"

#include "cluster.h"

#include "base/list.h"
#include "base/rng.h"
#include "machine/jobtext.h"
#include "machine/sums.h"
#include "refine/refine.h"
#include "proto/ambshare.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST_RECORDS 6
#define TILE_MS      30
#define TELL_MS      500 /* time until all workers know that a pass is closed */

/* The records of a tile, the same from every worker; returns how many. */
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

/* The colour of a pixel, by formula. */
static void
colour(const struct sim_job *job, uint32_t frame, int x, int y, uint8_t rgbe[4])
{
    uint64_t key = rad_mix64(job->look + frame) + (uint64_t)x * 65536;

    key = rad_mix64(key + (uint64_t)y);
    memcpy(rgbe, &key, 4);
}

/* The colours of a tile's lattice; returns the number of bytes. */
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

/* The sums of a tile of a check pass.  Over all tiles these give errors from
 * none to several times the one that is wanted. */
static void
sums(const struct sim_job *job, uint32_t pass, uint32_t tile,
     struct rad_refine_sums *out)
{
    uint64_t key = rad_mix64(job->look + pass * 1000 + tile);
    double *v = out->doubt.v;

    for (int i = 0; i < RAD_DOUBT_SUMS; i++)
        v[i] = (double)(rad_mix64(key + (unsigned)i) >> 11) * 0x1p-53;
    v[RAD_DOUBT_PLACES] = v[RAD_DOUBT_AREAS] = 1;
    out->shown = out->rays = 1;
}

/* A stage of a job; or all passes, if the job has no goal. */
struct stage {
    uint32_t number, base, n;
    struct rad_refine_rungs rungs;
    struct rad_refine_known past;
    struct rad_params params, pictures; /* pictures: of the last stage */
    struct rad_pass plan[RAD_MOST_PASSES];
};

static void
options_of(const struct sim_job *job, struct rad_refine_rungs rungs,
           struct rad_params *out)
{
    struct rad_params own;

    if (jobtext_params(job->params, &own, NULL) != 0)
        abort();
    rad_refine_params(&own, rungs, out);
}

static void
plan_stage(const struct sim_job *job, struct stage *st)
{
    bool on = job->spec.flags & MSG_JOB_REUSE && st->base == 0;
    struct rad_pass_size size[SIM_FRAMES];

    options_of(job, st->rungs, &st->params);
    st->pictures = st->params;
    for (uint32_t f = 0; f < job->spec.nframes; f++)
        size[f] = (struct rad_pass_size){ (int)job->frame[f].width,
                                          (int)job->frame[f].height };
    st->n = job->spec.flags & MSG_JOB_PASSES
                ? rad_refine_plan(&st->params, size, job->spec.nframes, on,
                                  job->spec.error_ppm > 0, st->plan)
                : 0;
}

/* The rays of a pass of that many tiles; see made(). */
static uint64_t
rays(uint64_t tiles)
{
    return tiles * (tiles + 1) / 2;
}

/* Rays for making the records of another job's cache, roughly. */
static uint64_t
reused_rays(const struct sim_job *job, const struct rad_params *p)
{
    size_t n = job->kept.npasses > 0 ? job->kept.pass[0].len : 0;

    return n / AMBSHARE_BYTES * (uint64_t)(p->ambdiv + p->ambssamp);
}

/* The answers of rad_refine_next() to the last questions, for each tile asks
 * again: three quarters of the time of all clusters would go there. */
static struct answer {
    struct rad_refine_ask ask;
    struct rad_refine_rungs next;
    bool on;
} answers[SIM_JOBS * RAD_REFINE_STAGES];
static unsigned nanswers;

/* The bytes between the members of *ask must be 0. */
static const struct answer *
answer_to(const struct rad_refine_ask *ask)
{
    struct answer *a = answers;
    double error;

    for (; a < answers + N_ELEM(answers); a++)
        if (memcmp(&a->ask, ask, sizeof *ask) == 0)
            return a;
    a = &answers[nanswers++ % N_ELEM(answers)];
    a->ask = *ask;
    a->on = rad_refine_next(ask, &a->next, &error);
    return a;
}

/* Go on to the stage after this one; false: there is none. */
static bool
next_stage(const struct sim_job *job, struct stage *st)
{
    const struct answer *answer;
    struct rad_refine_ask ask;
    struct rad_refine_sums of;
    struct rad_params first;

    if (st->n == 0 || job->spec.error_ppm == 0)
        return false;
    options_of(job, (struct rad_refine_rungs){ 0 }, &first);
    memset(&ask, 0, sizeof ask); /* see answer_to() */
    ask.error = job->spec.error_ppm / 1e6;
    ask.stage = st->number;
    ask.rungs = st->rungs;
    ask.past.rungs = st->past.rungs;
    ask.past.ambient = st->past.ambient;
    ask.past.pixel = st->past.pixel;
    ask.past.noise = st->past.noise;
    ask.past.places = st->past.places;
    ask.left_s = INFINITY;
    ask.samples = first.samples;
    for (uint32_t i = 0; i < st->plan[st->n - 1].tiles; i++) {
        sums(job, st->base + st->n - 1, i, &of);
        rad_refine_add(&ask.sums, &of);
    }
    for (uint32_t i = 0; i + 1 < st->n; i++)
        ask.rays += rays(st->plan[i].tiles);
    if (job->spec.flags & MSG_JOB_REUSE && st->base == 0)
        ask.rays += reused_rays(job, &st->params);
    ask.check = rays(st->plan[st->n - 1].tiles);
    for (uint32_t f = 0; f < job->spec.nframes; f++)
        ask.pixels += (uint64_t)job->frame[f].width * job->frame[f].height;
    answer = answer_to(&ask);
    if (!answer->on) {
        options_of(job, answer->next, &st->pictures);
        return false;
    }
    st->rungs = answer->next;
    st->past = rad_refine_pass_on(&ask);
    st->number++;
    st->base += st->n;
    plan_stage(job, st);
    return true;
}

/* Find the stage of a pass; the last stage for passes beyond it. */
static void
stage_of(const struct sim_job *job, uint32_t pass, struct stage *st)
{
    st->number = st->base = 0; /* not a whole initializer: the plan is large */
    st->rungs = (struct rad_refine_rungs){ 0 };
    st->past = (struct rad_refine_known){ 0 };
    plan_stage(job, st);
    while (pass >= st->base + st->n && next_stage(job, st))
        ;
}

static void
fill(const struct sim_job *job, struct msg_tile_made *t,
     uint8_t data[MOST_RECORDS * AMBSHARE_BYTES])
{
    struct stage st;
    struct rad_refine_sums all;
    struct wire_out w;

    stage_of(job, t->pass, &st);
    if (!st.plan[t->pass - st.base].check) {
        t->count = records(job, t->pass, t->tile, data);
        t->len = (size_t)t->count * AMBSHARE_BYTES;
        return;
    }
    sums(job, t->pass, t->tile, &all);
    wire_out_init(&w, SUMS_BYTES);
    sums_pack(&w, &all);
    memcpy(data, w.buf, SUMS_BYTES);
    t->len = SUMS_BYTES;
    wire_out_release(&w);
}

static void made(void *net, struct event *e);

/* Make another event like this one: e->k is the tile, e->len twice its pass,
 * plus 1 if its colours are wanted. */
static void
make_later(struct net *net, unsigned ms, const struct event *like)
{
    struct event *e = net_later(net, ms, made);

    e->node = like->node;
    e->k = like->k;
    e->n = like->n;
    e->len = like->len;
}

static void
made(void *arg, struct event *e)
{
    struct net *net = arg;
    struct sim_child *k = sim_child_of(net, e->node);
    uint8_t data[MOST_RECORDS * AMBSHARE_BYTES], shown[MSG_MAX_COLOURS];
    const struct sim_job *job = &sim_of(net)->job[k->job];
    struct stage st;
    struct msg m = { .type = MSG_TILE_MADE };
    struct msg_tile_made *t = &m.tile_made;

    if (!net->ops[e->node] || k->conn != e->n || k->passes > e->len / 2)
        return; /* the pass is closed */
    stage_of(job, (uint32_t)e->len / 2, &st);
    if (st.base + st.plan[e->len / 2 - st.base].reads > k->passes) {
        make_later(net, TILE_MS, e); /* a pass that it reads has not come */
        return;
    }
    *t = (struct msg_tile_made){ .job = sim_of(net)->job[k->job].id,
                                 .pass = (uint32_t)e->len / 2,
                                 .tile = (uint32_t)e->k,
                                 .data = data };
    fill(job, t, data);
    t->colours = shown;
    if (e->len % 2)
        t->colours_len =
            colours(job, &st.plan[t->pass - st.base], t->tile, shown);
    t->counts.rays = t->counts.ambient_rays = t->tile + 1;
    t->counts.cpu_s = .001;
    sim_of(net)->job[k->job].tile_rays += t->counts.rays;
    sim_of(net)->tiles++;
    net_send_msg(net, e->node, k->conn, &m);
}

void
sim_take_tile(struct net *net, int node, const struct msg_tile *m)
{
    struct sim_child *k = sim_child_of(net, node);
    const struct sim_worker *w = &sim_of(net)->worker[k->worker];
    struct stage st;
    unsigned ms = net_random(net, TILE_MS) * w->slow;

    stage_of(&sim_of(net)->job[k->job], m->pass, &st);
    SIM_CHECK(net, k->stage == st.base && m->pass < st.base + st.n);
    SIM_CHECK(net, m->pass >= k->passes);
    SIM_CHECK(net, m->tile < st.plan[m->pass - st.base].tiles);
    SIM_CHECK(net, !m->colours || sim_of(net)->job[k->job].watched);
    if (w->stopped_ms > net->now_ms)
        ms += (unsigned)(w->stopped_ms - net->now_ms);
    sim_of(net)->work_ms += ms + TELL_MS;
    make_later(net, ms,
               &(struct event){ .node = node,
                                .k = (int)m->tile,
                                .n = k->conn,
                                .len = 2 * (size_t)m->pass + m->colours });
}

/* Compare a FROZEN with the records of the pass, tile after tile. */
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

/* Compare a FROZEN of the first pass with the cache of the other job. */
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
    const struct sim_job *job = &sim_of(net)->job[k->job];
    const struct rad_pass *pass;
    struct stage st;

    stage_of(job, m->pass, &st);
    SIM_CHECK(net, m->pass == k->passes && k->stage == st.base);
    SIM_CHECK(net, m->pass < st.base + st.n);
    SIM_CHECK(net, m->first == 0 || m->first == k->nrecords);
    pass = &st.plan[m->pass - st.base];
    if (pass->check) { /* only the last stage's is sent */
        SIM_CHECK(net, m->count == 0 && m->last && !next_stage(job, &st));
    } else if (m->pass == 0 && job->spec.flags & MSG_JOB_REUSE) {
        check_reused(net, job, m);
    } else if (!pass->walks || m->count > 0) { /* later lives lack these */
        check_records(net, job, m, pass->tiles);
    }
    k->nrecords = m->first + m->count;
    if (!m->last)
        return;
    k->nrecords = 0;
    k->passes++;
    sim_of(net)->work_ms += TILE_MS; /* all workers wait for the slowest tile */
    sim_of(net)->passes++;
}

static bool
says(const char *text, const struct rad_params *p)
{
    char other[RAD_PARAMS_TEXT];

    rad_params_format(p, other, sizeof other);
    return strcmp(text, other) == 0;
}

/* A child that comes late gets the pictures' options at once. */
void
sim_take_stage(struct net *net, int node, const struct msg_stage *m)
{
    struct sim_child *k = sim_child_of(net, node);
    const struct sim_job *job = &sim_of(net)->job[k->job];
    struct stage st;

    stage_of(job, m->pass, &st);
    SIM_CHECK(net, m->pass == st.base && m->pass >= k->passes && st.base > 0);
    SIM_CHECK(net, says(m->params, &st.params) ||
                       (!next_stage(job, &st) && says(m->params, &st.pictures)));
    k->passes = k->stage = m->pass;
    k->nrecords = 0;
    k->shown = false;
    sim_of(net)->stages++;
}

void
sim_take_show(struct net *net, int node, const struct msg_stage *m)
{
    struct sim_child *k = sim_child_of(net, node);
    const struct sim_job *job = &sim_of(net)->job[k->job];
    struct stage st;

    stage_of(job, MSG_MOST_PASSES, &st);
    SIM_CHECK(net, k->stage == st.base && k->passes == st.base + st.n);
    SIM_CHECK(net, m->pass + 1 == k->passes && says(m->params, &st.pictures));
    k->shown = true;
}

bool
sim_cache_serves(const struct sim *s, const struct sim_child *k, uint32_t frame)
{
    const struct sim_job *job = &s->job[k->job];
    uint32_t closed;
    struct stage st;

    stage_of(job, k->passes, &st);
    closed = k->passes - st.base;
    if (st.n > 0 && job->spec.error_ppm > 0 && !k->shown)
        return false;
    return st.n == 0 ||
           (closed > 0 && frame < rad_passes_ready(st.plan, closed) &&
            frame >= rad_passes_ready(st.plan, closed - 1));
}

void
sim_check_options(struct net *net, const struct sim_job *job)
{
    bool goal = job->spec.error_ppm > 0;
    struct stage st;

    stage_of(job, MSG_MOST_PASSES, &st);
    SIM_CHECK(net, goal && st.n > 0 ? says(job->options, &st.pictures)
                                    : !*job->options);
}
