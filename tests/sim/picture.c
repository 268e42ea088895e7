/* picture.c - pictures by formula, and what one sampler alone makes of them */
#include "config.h"

#include "cluster.h"

#include "base/rng.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static double
random_of(const struct sim_job *job, uint32_t frame, uint32_t i)
{
    return rad_rand(rad_mix64(job->look + frame), i);
}

static void
make_look(struct sim_job *job, uint32_t frame)
{
    struct sim_look *l = &job->looks[frame];

    l->disc_u = random_of(job, frame, 0);
    l->disc_v = random_of(job, frame, 1);
    l->disc = .01 + .09 * random_of(job, frame, 2);
    for (int i = 0; i < SIM_EDGES; i++) {
        double angle = 6.283 * random_of(job, frame, 10 + 3 * (uint32_t)i);

        l->edge[i][0] = cos(angle);
        l->edge[i][1] = sin(angle);
        l->edge[i][2] =
            l->edge[i][0] * random_of(job, frame, 11 + 3 * (uint32_t)i) +
            l->edge[i][1] * random_of(job, frame, 12 + 3 * (uint32_t)i);
    }
}

/* The grey of a pixel: a ramp, edges, a rail, a bright disc and a speckled
 * corner; some views show nothing in two corners. */
static double
grey(const struct sim_job *job, uint32_t frame, int x, int y)
{
    const struct sim_look *l = &job->looks[frame];
    double u = (double)x / job->frame[frame].width;
    double v = (double)y / job->frame[frame].height;
    double a = .2 + .1 * u + .1 * v * v, d[SIM_EDGES];

    for (int i = 0; i < SIM_EDGES; i++)
        d[i] = l->edge[i][0] * u + l->edge[i][1] * v - l->edge[i][2];
    if (d[0] > 0)
        a *= 1.6;
    if (d[1] > 0)
        a *= .6;
    if (fabs(d[2]) < .02)
        a += .5;
    if ((u - l->disc_u) * (u - l->disc_u) + (v - l->disc_v) * (v - l->disc_v) <
        l->disc)
        a += .8 + .3 * v;
    if (d[3] > .5)
        a *= 1 + .4 * rad_rand(rad_key_pixel(job->look, frame, (uint32_t)x,
                                             (uint32_t)y),
                               0);
    return a;
}

bool
sim_pixel(const struct sim_job *job, uint32_t frame, int x, int y,
          struct rad_pixel *out)
{
    double u = (double)x / job->frame[frame].width;
    double v = (double)y / job->frame[frame].height;
    double a;

    out->L = rad_grey(0);
    out->z = 0;
    if (job->round && (u + v < .15 || u + v > 1.85))
        return false;
    a = grey(job, frame, x, y);
    out->L = rad_rgb((float)a, (float)(a * (1 - .3 * u)), (float)(.5 * a));
    if (job->spec.flags & MSG_JOB_DEPTH)
        out->z = (float)(1 + a + u);
    return true;
}

void
sim_paint(const struct sim_job *job, uint32_t frame, int x0, int x1, int y,
          struct rad_pixel *row)
{
    for (int x = x0; x < x1 && job->paint; x++)
        if (rad_mix64(job->look + frame + (uint64_t)(x * 7919 + y)) % 37 == 0)
            row[x - x0].L.g = row[x - x0].L.g * .5F + 2; /* twice would show */
}

unsigned
sim_pixel_us(const struct sim_job *job, uint32_t frame, int x, int y)
{
    const struct sim_look *l = &job->looks[frame];
    double v = (double)y / job->frame[frame].height;

    (void)x;
    return job->pixel_us * (v > l->disc_v ? 6 : 1);
}

struct rad_quincunx
sim_sampler(const struct sim_job *job, uint32_t frame)
{
    struct rad_quincunx q = { .width = (int)job->frame[frame].width,
                              .height = (int)job->frame[frame].height,
                              .maxdiff = job->maxdiff,
                              .depth = job->spec.flags & MSG_JOB_DEPTH };

    rad_quincunx_steps(job->psample, &q.xstep, &q.ystep);
    return q;
}

/* --- one sampler alone --- */

struct alone {
    const struct sim_job *job;
    uint32_t frame;
    uint64_t primary;
    bool first[SIM_HEIGHT]; /* rows whose column 0 was traced */
};

static void
trace_alone(void *arg, int x, int y, struct rad_pixel *out)
{
    struct alone *a = arg;

    a->primary += sim_pixel(a->job, a->frame, x, y, out);
    a->first[y] |= x == 0;
}

static void
sample(struct alone *a, int x, int y, int width, int height,
       struct rad_pixel *picture)
{
    const struct sim_job *job = a->job;
    uint32_t frame = a->frame;
    struct rad_quincunx q = sim_sampler(job, frame);
    size_t stride = (size_t)q.width;
    struct rad_pixel *rows[RAD_QUINCUNX_MAX_YSTEP + 1];
    uint8_t density[SIM_WIDTH];

    picture += (size_t)y * stride + (size_t)x;
    q.x0 = x;
    q.y0 = y;
    q.width = width;
    q.height = height;
    q.trace = trace_alone;
    q.arg = a;
    rad_quincunx_start(&q, density);
    for (int i = 0; i < rad_quincunx_nbases(&q); i++) {
        int base = rad_quincunx_base_row(&q, i), top = base;

        rad_quincunx_base(&q, i, density, picture + (size_t)base * stride);
        if (i > 0) {
            top = rad_quincunx_base_row(&q, i - 1);
            for (int k = 0; k <= base - top; k++)
                rows[k] = picture + (size_t)(top + k) * stride;
            rad_quincunx_bar_below(&q, i - 1, rows);
            top++;
        }
        for (int k = top; k <= base; k++)
            sim_paint(job, frame, x, x + width, y + k,
                      picture + (size_t)k * stride);
    }
}

uint64_t
sim_alone(const struct sim_job *job, uint32_t frame, int x, int y, int width,
          int height, struct rad_pixel *picture)
{
    struct alone a = { .job = job, .frame = frame };

    sample(&a, x, y, width, height, picture);
    return a.primary;
}

int
sim_any_traced(struct net *net, const struct sim_job *job)
{
    struct alone a = { .job = job };
    int height = (int)job->frame[0].height;
    int y = (int)net_random(net, (unsigned)height);

    sample(&a, 0, 0, (int)job->frame[0].width, height, job->want[0]);
    while (!a.first[y])
        y = (y + 1) % height;
    return y;
}

/* --- set-up --- */

/* Random costs of the lines, which need not fit the picture. */
static void
make_costs(struct net *net, struct sim_job *job)
{
    float v[SIM_FRAMES * SIM_HEIGHT];
    uint32_t n = 0;

    for (uint32_t f = 0; f < job->spec.nframes; f++) {
        struct rad_quincunx q = sim_sampler(job, f);

        for (int i = 0; i < rad_quincunx_nbases(&q); i++)
            v[n++] = (float)(net_chance(net, 10) ? 0 : net_random(net, 100));
    }
    wire_floats_put(job->costs, v, n);
    job->spec.ncosts = n;
    job->spec.costs = job->costs;
}

/* Choose -ps: 4 or 8, as is usual.  In some small pictures a rare value, with
 * which each pixel is traced, lines have one row, or steps are wider than the
 * picture; these are not chosen by net_random(), so other choices of a seed
 * stay the same. */
static int
sampling(struct net *net, bool tall)
{
    static const int rare[] = { 1, 2, 3, 16 };
    uint64_t r = rad_mix64(net->seed + 79);
    int usual = !tall && net_chance(net, 3) ? 8 : 4;

    return tall || r % 8 != 0 ? usual : rare[r / 8 % 4];
}

void
sim_make_pictures(struct net *net, struct sim_job *job)
{
    static const char *const estimates[] = { "uniform", "5a", "2b" };
    bool large = net_chance(net, 10);
    /* with regions for two workers; not by net_random(), so few seeds change */
    bool tall = !large && rad_mix64(net->seed + 78) % 8 == 0;
    /* so its passes come in halves */
    bool tower = tall && rad_mix64(net->seed + 79) % 3 == 0;
    unsigned side = large ? 90 : 50, least = net_chance(net, 4) ? 1 : 20;

    job->look = rad_mix64(net->seed + 77);
    job->psample = sampling(net, tall);
    job->maxdiff = net_chance(net, 3) ? .1 : .05;
    job->round = net_chance(net, 3);
    job->paint = net_chance(net, 3);
    job->pixel_us =
        (net_chance(net, 3) ? 100 : 3000) * (1 + net_random(net, 4));
    if (tower) {
        job->psample = 16;
        job->pixel_us = 10;
        sim_of(net)->work_ms += 120000; /* for its many units, in turn */
    }
    job->bounces =
        job->spec.flags & MSG_JOB_PASSES ? (int)net_random(net, 3) : 0;
    snprintf(job->params, sizeof job->params, "-ps %d -ab %d", job->psample,
             job->bounces);
    job->spec.params = job->params;
    job->spec.estimate = estimates[net_random(net, 3)];
    job->spec.nframes = 1 + net_random(net, large || tall ? 1 : SIM_FRAMES);
    job->spec.frames = job->frame;
    for (uint32_t f = 0; f < job->spec.nframes; f++) {
        uint32_t w = least + net_random(net, side - least);
        uint32_t h = least + net_random(net, side - least);
        size_t n;

        if (tall)
            h = 150 + net_random(net, SIM_TALL - 150);
        if (tower) {
            w = 1 + w % 3;
            h += SIM_HEIGHT - SIM_TALL;
        }
        n = (size_t)w * h;
        job->frame[f] = (struct msg_frame){ f, w, h, "-vp 0 0 0" };
        make_look(job, f);
        job->picture[f] = calloc(n, sizeof(struct rad_pixel));
        job->want[f] = calloc(n, sizeof(struct rad_pixel));
        job->line[f] = malloc(n * 12);
        SIM_CHECK(net, job->picture[f] && job->want[f] && job->line[f]);
        memset(job->line[f], 0xff, n * 12); /* NaN, until it is stored */
    }
    if (net_chance(net, 4))
        make_costs(net, job);
}
