/* map.c - see map.h */
#include "config.h"

#include "map.h"

#include "costs.h"
#include "event.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

/* A window's first row is sampled as finely as a base line below full
 * densities: about half as many pixels again.  Measured: 16 and 256 windows of
 * the office at night have 2 and 9 % more primary rays than one. */
#define WINDOW_EDGE .5

/* The cost of row y of a picture whose rows are those of `from`, stretched. */
static double
stretched(const double *from, uint32_t n, int y, int height)
{
    double lo = (double)y * n / height, hi = (double)(y + 1) * n / height;
    double sum = 0;

    for (uint32_t i = (uint32_t)lo; i < n && i < hi; i++) {
        double a = lo > i ? lo : i, b = hi < i + 1 ? hi : i + 1;

        sum += (b - a) * from[i];
    }
    return sum;
}

static double
made_up(int y, int height)
{
    return 2.5 - 1.5 * cos(4 * PI * (y + .5) / height);
}

/* Weigh base lines, and bring frame k to so many seconds. */
static void
finish_frame(struct map *m, uint32_t k, double base, double seconds)
{
    double *row = m->row + (size_t)k * (size_t)m->q.height, sum = 0;

    for (int i = 0; i < m->nlines; i++)
        row[rad_quincunx_base_row(&m->q, i)] *= base;
    for (int y = 0; y < m->q.height; y++)
        sum += row[y];
    for (int y = 0; y < m->q.height; y++)
        row[y] *= sum > 0 ? seconds / sum : 0;
    m->total += seconds;
}

static int
ystep_psample(int ystep)
{
    int x, y;

    for (int ps = 1; ps <= 16; ps++) {
        rad_quincunx_steps(ps, &x, &y);
        if (y == ystep)
            return ps;
    }
    return 4;
}

/* Set the size and the sampler's steps. */
static void
set_size(struct map *m, const struct map_spec *s, const struct costs *c)
{
    int width = 480, height = 320;

    m->psample = 4;
    if (c->nframes > 0) {
        m->psample = ystep_psample(c->ystep);
        width = (int)c->frames[0].width;
        height = (int)c->frames[0].height;
    }
    m->q.width = s->width ? s->width : width;
    m->q.height = s->height ? s->height : height;
    rad_quincunx_steps(m->psample, &m->q.xstep, &m->q.ystep);
    m->nlines = rad_quincunx_nbases(&m->q);
    m->nframes = s->nframes ? s->nframes : c->nframes ? c->nframes : 1;
    m->window_edge = WINDOW_EDGE;
}

static double
sum_of(const struct costs_frame *f)
{
    double sum = 0;

    for (uint32_t y = 0; y < f->height; y++)
        sum += f->row[y];
    return sum;
}

static void
fill(struct map *m, const struct map_spec *s, const struct costs *c)
{
    for (uint32_t k = 0; k < m->nframes; k++) {
        const struct costs_frame *f =
            c->nframes > 0 ? &c->frames[k % c->nframes] : NULL;
        double *row = m->row + (size_t)k * (size_t)m->q.height;
        double seconds = s->seconds;

        for (int y = 0; y < m->q.height; y++)
            row[y] = f ? stretched(f->row, f->height, y, m->q.height)
                       : made_up(y, m->q.height);
        if (seconds == 0 && f)
            seconds = sum_of(f) * m->q.width * m->q.height /
                      ((double)f->width * f->height);
        else if (seconds == 0)
            seconds = 16e-6 * m->q.width * m->q.height; /* as the office */
        finish_frame(m, k, s->base, seconds);
    }
}

int
map_init(struct map *m, const struct map_spec *s, struct rad_error *err)
{
    struct costs c = { 0 };
    int rc;

    memset(m, 0, sizeof *m);
    if (s->file && (rc = costs_read(&c, s->file, err)) < 0) {
        costs_release(&c);
        return rc;
    }
    set_size(m, s, &c);
    m->row =
        sim_alloc((size_t)m->nframes * (size_t)m->q.height * sizeof(double));
    fill(m, s, &c);
    costs_release(&c);
    return 0;
}

void
map_release(struct map *m)
{
    free(m->row);
    memset(m, 0, sizeof *m);
}

double
map_row(const struct map *m, uint32_t frame, int y, int columns)
{
    return m->row[(size_t)frame * (size_t)m->q.height + (size_t)y] * columns /
           m->q.width;
}

double
map_window(const struct map *m, const struct msg_unit *u)
{
    double sum = 0;

    for (uint32_t y = u->y; y < u->y + u->height; y++)
        sum += map_row(m, u->frame, (int)y, (int)u->width);
    if (u->height < (uint32_t)m->q.height || u->width < (uint32_t)m->q.width)
        sum += m->window_edge * map_row(m, u->frame, (int)u->y, (int)u->width);
    return sum;
}
