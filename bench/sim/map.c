/* map.c - see map.h */
#include "config.h"

#include "map.h"

#include "base/files.h"
#include "job/costs.h"
#include "team/team.h"
#include "tests/sim/event.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

/* A window's first row is sampled as finely as a base line below full
 * densities: about half as many pixels again.  Measured: 16 and 256 windows of
 * the office at night have 2 and 9 % more primary rays than one. */
#define WINDOW_EDGE .5

#define MOST_BYTES  ((size_t)1 << 30) /* of a picture */
#define MOST_PIXELS ((size_t)1 << 28)

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
    m->q.maxdiff = .05;
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

/* The windows of frame k, which took so many seconds in all. */
static void
take_windows(struct map *m, uint32_t k, const struct costs_frame *f,
             double seconds)
{
    double sx = (double)m->q.width / f->width;
    double sy = (double)m->q.height / f->height;
    double sum = 0;

    for (uint32_t i = 0; i < f->nwindows; i++)
        sum += f->window[i].cost;
    for (uint32_t i = 0; i < f->nwindows; i++) {
        const struct costs_window *w = &f->window[i];

        m->window[m->nwindows++] =
            (struct map_window){ k,
                                 sx * w->x,
                                 sy * w->y,
                                 sx * (w->x + w->width),
                                 sy * (w->y + w->height),
                                 sum > 0 ? seconds * w->cost / sum : 0 };
    }
}

static void
make_window_room(struct map *m, const struct costs *c)
{
    size_t n = 0;

    for (uint32_t k = 0; k < m->nframes && c->nframes > 0; k++)
        n += c->frames[k % c->nframes].nwindows;
    if (n > 0)
        m->window = sim_alloc(n * sizeof *m->window);
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
        if (f)
            take_windows(m, k, f, seconds);
    }
}

/* Column or row i of a picture that goes on as in a mirror. */
static size_t
mirrored(int i, int n)
{
    i %= 2 * n;
    return (size_t)(i < n ? i : 2 * n - 1 - i);
}

struct rad_rgb
map_pixel(const struct map *m, int x, int y)
{
    const struct rad_picture *p = &m->picture;

    if (p->L)
        return p->L[mirrored(y, p->height) * (size_t)p->width +
                    mirrored(x, p->width)];
    return rad_grey((float)(1u << (3 * x + 7 * y) % 29));
}

static bool
count_pixel(void *arg, struct rad_ctx *ctx, int x, int y, struct rad_pixel *out)
{
    struct map *m = arg;

    (void)ctx;
    m->wanted[y]++;
    m->nwanted++;
    *out = (struct rad_pixel){ .L = map_pixel(m, x, y) };
    return true;
}

static void
ignore_row(void *arg, int row, const struct rad_pixel *pixels)
{
    (void)arg;
    (void)row;
    (void)pixels;
}

/* Sample a frame, to see which pixels it takes. */
static void
count_pixels(struct map *m)
{
    struct team_spec spec = { .sampler = m->q,
                              .last = m->nlines,
                              .truth.rows = ignore_row,
                              .trace = count_pixel,
                              .arg = m,
                              .nthreads = 1 };
    struct team *t = team_new(&spec);

    m->wanted = sim_alloc((size_t)m->q.height * sizeof *m->wanted);
    if (!t)
        abort();
    team_work(t, NULL);
    team_free(t);
}

static int
read_picture(struct map *m, const char *file, struct rad_error *err)
{
    size_t len;
    unsigned char *bytes = rad_file_read(file, MOST_BYTES, &len, err);
    int rc = bytes ? rad_hdr_read(bytes, len, MOST_PIXELS, &m->picture, err)
                   : RAD_ENOINPUT;

    free(bytes);
    return rc;
}

int
map_init(struct map *m, const struct map_spec *s, struct rad_error *err)
{
    struct costs c = { 0 };
    int rc = 0;

    memset(m, 0, sizeof *m);
    if (s->picture)
        rc = read_picture(m, s->picture, err);
    if (rc == 0 && s->file)
        rc = costs_read(&c, s->file, err);
    if (rc < 0) {
        costs_release(&c);
        return rc;
    }
    set_size(m, s, &c);
    m->row =
        sim_alloc((size_t)m->nframes * (size_t)m->q.height * sizeof(double));
    make_window_room(m, &c);
    fill(m, s, &c);
    count_pixels(m);
    costs_release(&c);
    return 0;
}

void
map_release(struct map *m)
{
    free(m->row);
    free(m->wanted);
    rad_picture_release(&m->picture);
    free(m->window);
    memset(m, 0, sizeof *m);
}

double
map_row(const struct map *m, uint32_t frame, int y, int columns)
{
    return m->row[(size_t)frame * (size_t)m->q.height + (size_t)y] * columns /
           m->q.width;
}

double
map_pixel_cost(const struct map *m, uint32_t frame, int y)
{
    uint32_t n = m->wanted[y]; /* 0: a guess was wrong */

    return map_row(m, frame, y, m->q.width) / (n ? n : (uint32_t)m->q.width);
}

/* How much of [a0, a1] and [b0, b1] is common. */
static double
common(double a0, double a1, double b0, double b1)
{
    return fmax(fmin(a1, b1) - fmax(a0, b0), 0);
}

/* What measured windows took where u lies. */
static double
measured(const struct map *m, const struct msg_unit *u)
{
    double sum = 0;

    for (size_t i = 0; i < m->nwindows; i++) {
        const struct map_window *w = &m->window[i];
        double part = common(w->x0, w->x1, u->x, (double)u->x + u->width) *
                      common(w->y0, w->y1, u->y, (double)u->y + u->height);

        if (w->frame == u->frame)
            sum += w->cost * part / ((w->x1 - w->x0) * (w->y1 - w->y0));
    }
    return sum;
}

double
map_window(const struct map *m, const struct msg_unit *u)
{
    double sum = 0;

    if (m->window)
        return measured(m, u);
    for (uint32_t y = u->y; y < u->y + u->height; y++)
        sum += map_row(m, u->frame, (int)y, (int)u->width);
    if (u->height < (uint32_t)m->q.height || u->width < (uint32_t)m->q.width)
        sum += m->window_edge * map_row(m, u->frame, (int)u->y, (int)u->width);
    return sum;
}
