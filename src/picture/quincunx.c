/* quincunx.c - see quincunx.h
 *
 * The decisions are rpict's to the last bit, so precision matters where it
 * decides: pixels are floats, products with -pt and with the weights of an
 * interpolation are taken in double.
 * Columns of a bar are bisected from the lower base line upwards, since rpict
 * counts rows from the bottom; that shows wherever a gap's halves differ. */
#include "config.h"

#include "picture/quincunx.h"

#include <math.h>
#include <string.h>

void
rad_quincunx_steps(int psample, int *xstep, int *ystep)
{
    /* psample times sqrt(2) and over sqrt(2), rounded */
    *xstep = (140 * psample + 49) / 99;
    *ystep = (99 * psample + 70) / 140;
}

size_t
rad_quincunx_ndensity(const struct rad_quincunx *q)
{
    /* one for each sample, one for the gap cut in half, one at the end */
    return q->xstep > 2 ? (size_t)(q->width / q->xstep) + 3 : 0;
}

void
rad_quincunx_start(const struct rad_quincunx *q, uint8_t *density)
{
    memset(density, q->xstep, rad_quincunx_ndensity(q));
}

int
rad_quincunx_nbases(const struct rad_quincunx *q)
{
    return 1 + (q->height - 1 + q->ystep - 1) / q->ystep;
}

int
rad_quincunx_base_row(const struct rad_quincunx *q, int i)
{
    int y = i * q->ystep;

    return y < q->height ? y : q->height - 1;
}

static void
trace(const struct rad_quincunx *q, int x, int y, struct rad_pixel *out)
{
    q->trace(q->arg, q->x0 + x, q->y0 + y, out);
}

static bool
channel_differs(float a, float b, double maxdiff)
{
    return a - b > maxdiff * b || b - a > maxdiff * a;
}

static bool
differ(const struct rad_quincunx *q, const struct rad_pixel *a,
       const struct rad_pixel *b)
{
    if (q->depth && 2 * fabs(a->z - b->z) > q->maxdiff * (a->z + b->z))
        return true;
    return channel_differs(a->L.r, b->L.r, q->maxdiff) ||
           channel_differs(a->L.g, b->L.g, q->maxdiff) ||
           channel_differs(a->L.b, b->L.b, q->maxdiff);
}

static float
blend_channel(float a, float b, double wa, double wb)
{
    return (float)(b * wb) + (float)(a * wa);
}

/* A pixel between a and b, at wb of the way. */
static struct rad_pixel
blend(const struct rad_quincunx *q, const struct rad_pixel *a,
      const struct rad_pixel *b, double wb)
{
    double wa = 1 - wb;
    struct rad_pixel p;

    p.L.r = blend_channel(a->L.r, b->L.r, wa, wb);
    p.L.g = blend_channel(a->L.g, b->L.g, wa, wb);
    p.L.b = blend_channel(a->L.b, b->L.b, wa, wb);
    p.z = q->depth ? (float)((float)(b->z * wb) + a->z * wa) : 0;
    return p;
}

/* A gap on its way through bisection: pixels p[0] to p[len] in a row or going
 * up a column from (x, y). */
struct gap {
    const struct rad_quincunx *q;
    bool upwards;
};

/* Fill between p[0] and p[len], len at least 2; at least `density` pixels are
 * traced, spread evenly.  Returns how many were. */
static int
fill_gap(const struct gap *g, struct rad_pixel *p, int x, int y, int len,
         int density)
{
    int half = len / 2;
    int xm = g->upwards ? x : x + half, ym = g->upwards ? y - half : y;
    int found = 0;

    if (density > 0 || differ(g->q, &p[0], &p[len])) {
        trace(g->q, xm, ym, &p[half]);
        found = 1;
    } else {
        p[half] = blend(g->q, &p[0], &p[len], (double)half / len);
    }
    if (half > 1)
        found += fill_gap(g, p, x, y, half, (density - 1) / 2);
    if (len - half > 1)
        found += fill_gap(g, p + half, xm, ym, len - half, density / 2);
    return found;
}

/* Every other line has its samples half a step to the left, the first gap cut
 * in half. */
static bool
is_offset(const struct rad_quincunx_line *s)
{
    return s->i & 1;
}

/* Columns that the first gap of base line i lacks. */
static int
cut_off(const struct rad_quincunx *q, int i)
{
    return i & 1 && q->xstep > 1 ? q->xstep - q->xstep / 2 : 0;
}

void
rad_quincunx_line_start(struct rad_quincunx_line *s,
                        const struct rad_quincunx *q, int i,
                        const uint8_t *above, uint8_t *below,
                        struct rad_pixel *pixels)
{
    memset(s, 0, sizeof *s);
    s->q = q;
    s->i = i;
    s->above = above;
    s->below = below;
    s->pixels = pixels;
    s->found = q->xstep;
    trace(q, 0, rad_quincunx_base_row(q, i), &pixels[0]);
}

size_t
rad_quincunx_line_needs(const struct rad_quincunx_line *s)
{
    return s->above ? s->gap + 2 : 0;
}

/* The densities beyond what the line reached stay as they were above. */
static void
finish_densities(struct rad_quincunx_line *s)
{
    size_t n = rad_quincunx_ndensity(s->q);

    if (!s->above)
        return;
    if (!is_offset(s))
        s->below[s->ndensity++] = (uint8_t)s->found;
    if (s->below != s->above)
        memcpy(s->below + s->ndensity, s->above + s->ndensity, n - s->ndensity);
    s->ndensity = n;
}

/* A line without offset hands each gap's count to the gap that begins half a
 * step before its end, so its densities lag by one. */
static void
leave_density(struct rad_quincunx_line *s, int found)
{
    if (s->above)
        s->below[s->ndensity++] = (uint8_t)(is_offset(s) ? found : s->found);
}

bool
rad_quincunx_line_step(struct rad_quincunx_line *s)
{
    const struct rad_quincunx *q = s->q;
    struct gap g = { q, false };
    int y = rad_quincunx_base_row(q, s->i);
    int len = q->xstep, density = s->found, found;

    if (s->x >= q->width - 1) {
        if (s->ndensity < rad_quincunx_ndensity(q))
            finish_densities(s);
        return false;
    }
    if (s->gap == 0 && is_offset(s) && len > 1)
        len /= 2;
    if (len > q->width - 1 - s->x)
        len = q->width - 1 - s->x;
    if (s->above) {
        int a = s->above[s->gap], b = s->above[s->gap + 1];

        density = a > b ? a : b;
    }
    trace(q, s->x + len, y, &s->pixels[s->x + len]);
    found =
        len > 1 ? fill_gap(&g, s->pixels + s->x, s->x, y, len, density / 2) : 0;
    leave_density(s, found);
    s->found = found;
    s->gap++;
    s->x += len;
    if (s->x == q->width - 1)
        finish_densities(s);
    return true;
}

void
rad_quincunx_base(const struct rad_quincunx *q, int i, uint8_t *density,
                  struct rad_pixel *line)
{
    struct rad_quincunx_line s;

    if (rad_quincunx_ndensity(q) == 0)
        density = NULL;
    rad_quincunx_line_start(&s, q, i, density, density, line);
    while (rad_quincunx_line_step(&s))
        ;
}

int
rad_quincunx_ngaps(const struct rad_quincunx *q, int i)
{
    return (q->width - 1 + cut_off(q, i) + q->xstep - 1) / q->xstep;
}

int
rad_quincunx_gap_begin(const struct rad_quincunx *q, int i, int g)
{
    int x = g == 0 ? 0 : g * q->xstep - cut_off(q, i);

    return x < q->width - 1 ? x : q->width - 1;
}

void
rad_quincunx_gap(const struct rad_quincunx *q, int i, int g,
                 const uint8_t *above, struct rad_pixel *pixels)
{
    struct gap gap = { q, false };
    int y = rad_quincunx_base_row(q, i);
    int x = rad_quincunx_gap_begin(q, i, g);
    int len = rad_quincunx_gap_begin(q, i, g + 1) - x;
    int density = 0;

    if (above)
        density = above[g] > above[g + 1] ? above[g] : above[g + 1];
    trace(q, x, y, &pixels[x]);
    trace(q, x + len, y, &pixels[x + len]);
    if (len > 1)
        fill_gap(&gap, pixels + x, x, y, len, density / 2);
}

void
rad_quincunx_bar_to(const struct rad_quincunx *q, int i,
                    struct rad_pixel *const rows[], struct rad_quincunx_fill *s,
                    int end)
{
    struct rad_pixel column[RAD_QUINCUNX_MAX_YSTEP + 1];
    struct gap g = { q, true };
    int y = rad_quincunx_base_row(q, i + 1);
    int n = y - rad_quincunx_base_row(q, i);

    if (n < 2) {
        s->x = end;
        return;
    }
    if (s->x == 0)
        s->found = n;
    for (; s->x < end; s->x++) {
        column[0] = rows[n][s->x];
        column[n] = rows[0][s->x];
        s->found = fill_gap(&g, column, s->x, y, n, s->found / 2);
        for (int k = 1; k < n; k++)
            rows[n - k][s->x] = column[k];
    }
}

void
rad_quincunx_bar(const struct rad_quincunx *q, int i,
                 struct rad_pixel *const rows[])
{
    struct rad_quincunx_fill s = { 0, 0 };

    rad_quincunx_bar_to(q, i, rows, &s, q->width);
}
