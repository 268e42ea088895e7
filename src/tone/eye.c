/* eye.c - see eye.h
 *
 * The histogram is made of a lattice of pixels, where pcond(1) takes random
 * ones, so that a picture always looks the same. */
#include "config.h"

#include "tone/eye.h"

#include "base/vec.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define DEGREE (3.14159265358979323846 / 180)
#define VEIL   .08f /* share of the light that is scattered in the eye */

/* Only rods see below the first, only cones above the second [cd/m^2]. */
#define MESOPIC_LOW  5.62e-3
#define MESOPIC_HIGH 5.62

#define BRIGHTEST    1e25 /* largest radiance of a sample, so that sums fit */
#define NARROWEST    5.   /* views of a smaller angle [degrees] are unknown, */
#define USUAL_VIEW   40.  /* and this angle is assumed for them */
#define VEILED_RANGE 4.5  /* ln; in a smaller range no veil can be seen */
#define DARK_SHARE   .05  /* share of samples that count as dark */

enum {
    FEWEST = 3,           /* samples along each side */
    MOST_SAMPLES = 32800, /* for a fish-eye of 180 degrees; time is quadratic */
    LANES = 4,
    LATTICE = 1 << 20, /* most pixels in the histogram */
    MOST_LEVELS = 8    /* of the pyramid */
};

/* The picture, averaged over squares of 2^level pixels. */
struct level {
    int width, height;
    struct rad_rgb *L;
};

struct rad_eye {
    const struct rad_picture *pic;
    struct rad_view view;
    bool partial;
    int nx, ny;     /* numbers of samples, the first at the upper left */
    size_t room;    /* for nx * ny, rounded up to whole LANES, which are 0 */
    float *rgb[3];  /* radiance of each, after add_veil() with its veil */
    float *dir[3];  /* of length 1; 0 outside the view and if not known */
    float *veil[3]; /* light scattered to each */
    float *rate;    /* pixels of a cycle of the finest visible detail */
    bool veiled, rated;
    struct level level[MOST_LEVELS]; /* level 0 is the picture */
    int nlevels;
    float *memory; /* for all arrays of samples */
};

static double
luminance(struct rad_rgb L)
{
    return RAD_HUMAN_EFFICACY * rad_rgb_lum(L);
}

/* What rods see, in units in which white is 1. */
static double
scotopic(struct rad_rgb L)
{
    return .062 * L.r + .608 * L.g + .330 * L.b;
}

/* --- foveal samples --- */

static double
degrees_of(double tangent)
{
    return 2 / DEGREE * atan(tangent);
}

/* Set the picture's view, or the one that is assumed. */
static void
take_view(struct rad_eye *e, const struct rad_view *view)
{
    const double tangent = tan(USUAL_VIEW / 2 * DEGREE);
    double aspect =
        e->pic->pixaspect * e->pic->height / e->pic->width; /* of the picture */

    if (view && view->type != 'l' && view->horiz > NARROWEST &&
        view->vert > NARROWEST) {
        e->view = *view;
        return;
    }
    rad_view_init(&e->view);
    e->view.horiz = aspect < 1 ? USUAL_VIEW : degrees_of(tangent / aspect);
    e->view.vert = aspect < 1 ? degrees_of(tangent * aspect) : USUAL_VIEW;
    rad_view_setup(&e->view, NULL);
}

/* Let a sample be a degree at the middle of the view, or larger if MOST_SAMPLES
 * requires. */
static void
take_size(struct rad_eye *e)
{
    double x = sqrt(e->view.hn2) / DEGREE, y = sqrt(e->view.vn2) / DEGREE;
    double shrink = sqrt(MOST_SAMPLES / (x * y));

    if (shrink < 1) {
        x *= shrink;
        y *= shrink;
    }
    x = fmin(fmax(x + .5, FEWEST), MOST_SAMPLES / FEWEST);
    y = fmin(fmax(y + .5, FEWEST), MOST_SAMPLES / FEWEST);
    e->nx = (int)x;
    e->ny = (int)y;
}

static bool
is_known(const struct rad_eye *e, struct rad_rgb L)
{
    return !e->partial || !rad_rgb_black(L);
}

/* The pixels [*first, *end) of sample i of n along a side of `size`. */
static void
span(int i, int n, int size, int *first, int *end)
{
    *first = (int)((long)i * size / n);
    *end = (int)(((long)i + 1) * size / n);
    if (*end <= *first)
        *end = *first + 1;
}

/* The mean radiance of sample (i, j); false: none of it is known. */
static bool
average(const struct rad_eye *e, int i, int j, double mean[3])
{
    int x0, x1, y0, y1;
    size_t n = 0;

    mean[0] = mean[1] = mean[2] = 0;
    span(i, e->nx, e->pic->width, &x0, &x1);
    span(j, e->ny, e->pic->height, &y0, &y1);
    for (int y = y0; y < y1; y++) {
        const struct rad_rgb *L = e->pic->L + (size_t)y * (size_t)e->pic->width;

        for (int x = x0; x < x1; x++) {
            if (!is_known(e, L[x]))
                continue;
            mean[0] += (double)L[x].r;
            mean[1] += (double)L[x].g;
            mean[2] += (double)L[x].b;
            n++;
        }
    }
    for (int c = 0; n > 0 && c < 3; c++)
        mean[c] /= (double)n;
    return n > 0;
}

static void
take_sample(struct rad_eye *e, int i, int j)
{
    size_t at = (size_t)j * (size_t)e->nx + (size_t)i;
    double org[3], dir[3] = { 0 }, mean[3];
    bool seen = rad_view_ray(&e->view, (i + .5) / e->nx, 1 - (j + .5) / e->ny,
                             org, dir) >= 0;
    bool known = average(e, i, j, mean);

    for (int c = 0; c < 3; c++) {
        e->rgb[c][at] = (float)fmin(mean[c], BRIGHTEST);
        e->dir[c][at] = seen && known ? (float)dir[c] : 0;
    }
}

struct rad_eye *
rad_eye_new(const struct rad_picture *pic, const struct rad_view *view,
            bool partial, struct rad_error *err)
{
    enum { ARRAYS = 10 };
    struct rad_eye *e = calloc(1, sizeof *e);
    size_t room = 0;

    if (e) {
        e->pic = pic;
        e->partial = partial;
        take_view(e, view);
        take_size(e);
        room = (size_t)e->nx * (size_t)e->ny + LANES - 1;
        e->room = room -= room % LANES;
        e->memory = calloc(ARRAYS * room, sizeof *e->memory);
    }
    if (!e || !e->memory) {
        rad_eye_free(e);
        rad_fail_memory(err);
        return NULL;
    }
    for (size_t c = 0; c < 3; c++) {
        e->rgb[c] = e->memory + c * room;
        e->dir[c] = e->memory + (3 + c) * room;
        e->veil[c] = e->memory + (6 + c) * room;
    }
    e->rate = e->memory + 9 * room;
    for (int j = 0; j < e->ny; j++)
        for (int i = 0; i < e->nx; i++)
            take_sample(e, i, j);
    return e;
}

void
rad_eye_free(struct rad_eye *e)
{
    if (!e)
        return;
    for (int i = 1; i < e->nlevels; i++)
        free(e->level[i].L);
    free(e->memory);
    free(e);
}

static struct rad_rgb
sample(const struct rad_eye *e, size_t at)
{
    return rad_rgb(e->rgb[0][at], e->rgb[1][at], e->rgb[2][at]);
}

/* --- adaptation --- */

/* The pixels in the histogram: rows and columns are `step` apart, and n pixels
 * are known. */
struct lattice {
    int step;
    size_t n;
};

static const struct rad_rgb *
pixel(const struct rad_eye *e, int x, int y)
{
    return e->pic->L + (size_t)y * (size_t)e->pic->width + (size_t)x;
}

/* Find the least and the greatest luminance of samples and lattice pixels. */
static void
find_ends(const struct rad_eye *e, struct lattice *l, double *least,
          double *most)
{
    const struct rad_picture *p = e->pic;
    size_t n = (size_t)e->nx * (size_t)e->ny;

    l->step = (int)ceil(sqrt((double)p->width * p->height / LATTICE));
    l->n = 0;
    *least = INFINITY;
    *most = 0;
    for (size_t i = 0; i < n; i++)
        if (is_known(e, sample(e, i))) {
            *least = fmin(*least, luminance(sample(e, i)));
            *most = fmax(*most, luminance(sample(e, i)));
        }
    for (int y = l->step / 2; y < p->height; y += l->step)
        for (int x = l->step / 2; x < p->width; x += l->step)
            if (is_known(e, *pixel(e, x, y))) {
                *least = fmin(*least, luminance(*pixel(e, x, y)));
                *most = fmax(*most, luminance(*pixel(e, x, y)));
                l->n++;
            }
}

/* Fill the histogram.  All pixels together weigh as much as all samples. */
static void
count(const struct rad_eye *e, const struct lattice *l,
      const struct rad_human *h, struct rad_histogram *w)
{
    const struct rad_picture *p = e->pic;
    size_t n = (size_t)e->nx * (size_t)e->ny;
    double weight;

    memset(w, 0, sizeof *w);
    for (size_t i = 0; i < n; i++)
        if (is_known(e, sample(e, i)))
            rad_human_count(h, w, luminance(sample(e, i)), 1);
    weight = w->total / (double)l->n;
    for (int y = l->step / 2; y < p->height; y += l->step)
        for (int x = l->step / 2; x < p->width; x += l->step)
            if (is_known(e, *pixel(e, x, y)))
                rad_human_count(h, w, luminance(*pixel(e, x, y)), weight);
}

/* Set the range and fill the histogram; false: nothing can be seen. */
static bool
look(const struct rad_eye *e, struct rad_human *h, struct rad_histogram *w)
{
    struct lattice l;
    double least, most;

    find_ends(e, &l, &least, &most);
    if (!rad_human_range(h, least, most))
        return false;
    count(e, &l, h, w);
    return w->total > 0;
}

/* --- veil --- */

/* Vectors of GCC and Clang: neither vectorizes these sums in plain C unless it
 * is allowed to reorder them. */
typedef float lanes __attribute__((vector_size(LANES * sizeof(float))));
typedef int32_t mask __attribute__((vector_size(LANES * sizeof(float))));

static lanes
load(const float *p)
{
    lanes v;

    memcpy(&v, p, sizeof v);
    return v;
}

/* Add up light from all other samples, weighted by angle: cos(t) / t^2, with
 * 2 - 2 cos(t) for t^2.  Only the sample itself is nearer than 1e-6. */
static void
scatter(const struct rad_eye *e, size_t to, lanes sum[4])
{
    float x = e->dir[0][to], y = e->dir[1][to], z = e->dir[2][to];

    if (x == 0 && y == 0 && z == 0)
        return;
    for (size_t i = 0; i < e->room; i += LANES) {
        lanes c = x * load(e->dir[0] + i) + y * load(e->dir[1] + i) +
                  z * load(e->dir[2] + i);
        mask counts = (c > 0) & (1 - c > 1e-6f);
        lanes w = (lanes)((mask)(c / (2 - 2 * c)) & counts);

        for (int k = 0; k < 3; k++)
            sum[k] += w * load(e->rgb[k] + i);
        sum[3] += w;
    }
}

static float
sum_of(lanes v)
{
    float sum = 0;

    for (int k = 0; k < LANES; k++)
        sum += v[k];
    return sum;
}

static void
add_veil(struct rad_eye *e)
{
    size_t n = (size_t)e->nx * (size_t)e->ny;

    for (size_t to = 0; to < n; to++) {
        lanes sum[4] = { { 0 } };
        float all;

        scatter(e, to, sum);
        all = sum_of(sum[3]);
        for (int c = 0; c < 3; c++)
            e->veil[c][to] = all > 1e-6f ? VEIL * sum_of(sum[c]) / all : 0;
    }
    for (int c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            e->rgb[c][i] = (1 - VEIL) * e->rgb[c][i] + e->veil[c][i];
    e->veiled = true;
}

bool
rad_eye_fit(struct rad_eye *e, struct rad_human *h)
{
    struct rad_histogram w;
    double range, dark, lines;
    bool fits, veil;

    if (!look(e, h, &w))
        return false;
    fits = rad_human_fits(h);
    range = h->bmax - h->bmin;
    dark = rad_human_darkest(h, &w, DARK_SHARE);
    veil = range >= VEILED_RANGE;
    if (veil) { /* the veil changes what can be seen */
        add_veil(e);
        look(e, h, &w);
    }
    /* pixels to a degree, averaged over both sides */
    lines = DEGREE / 2 *
            (e->pic->width / sqrt(e->view.hn2) +
             e->pic->height / sqrt(e->view.vn2));
    h->veil = veil;
    h->acuity = rad_human_acuity(dark) < lines;
    h->colour = dark < MESOPIC_HIGH;
    rad_human_adapt(h, &w, fits);
    return true;
}

/* --- acuity --- */

/* The difference of two samples' directions, times k. */
static void
direction_step(const struct rad_eye *e, size_t a, size_t b, double k,
               double step[3])
{
    for (int c = 0; c < 3; c++)
        step[c] = k * (double)(e->dir[c][b] - e->dir[c][a]);
}

static float
rate_at(const struct rad_eye *e, int i, int j)
{
    size_t nx = (size_t)e->nx, at = (size_t)j * nx + (size_t)i;
    double dx[3], dy[3], cross[3], omega;

    direction_step(e, at - 1, at + 1, .5 * e->nx / e->pic->width, dx);
    direction_step(e, at - nx, at + nx, .5 * e->ny / e->pic->height, dy);
    rad_cross(cross, dx, dy);
    omega = .5 * sqrt(rad_dot(cross, cross));
    if (omega < 1e-12)
        return 1;
    return (float)(DEGREE / sqrt(omega) /
                   rad_human_acuity(luminance(sample(e, at))));
}

/* Set all rates; samples at the edge get those of their neighbours.  Returns
 * the largest. */
static float
take_rates(struct rad_eye *e)
{
    float most = 1;

    for (int j = 0; j < e->ny; j++)
        for (int i = 0; i < e->nx; i++) {
            int u = i < 1 ? 1 : i > e->nx - 2 ? e->nx - 2 : i;
            int v = j < 1 ? 1 : j > e->ny - 2 ? e->ny - 2 : j;
            float rate = rate_at(e, u, v);

            e->rate[(size_t)j * (size_t)e->nx + (size_t)i] = rate;
            most = fmaxf(most, rate);
        }
    e->rated = true;
    return most;
}

static struct rad_rgb
mix(struct rad_rgb a, struct rad_rgb b, float part)
{
    return rad_rgb_add(rad_rgb_scale(a, 1 - part), rad_rgb_scale(b, part));
}

static bool
halve(const struct level *from, struct level *to)
{
    to->width = from->width / 2;
    to->height = from->height / 2;
    to->L = malloc((size_t)to->width * (size_t)to->height * sizeof *to->L);
    for (int y = 0; to->L && y < to->height; y++) {
        const struct rad_rgb *a =
            from->L + (size_t)(2 * y) * (size_t)from->width;
        const struct rad_rgb *b = a + from->width;
        struct rad_rgb *out = to->L + (size_t)y * (size_t)to->width;

        for (int x = 0; x < to->width; x++)
            out[x] = mix(mix(a[2 * x], a[2 * x + 1], .5f),
                         mix(b[2 * x], b[2 * x + 1], .5f), .5f);
    }
    return to->L != NULL;
}

/* Build levels up to one that is coarser than the largest rate. */
static int
build_levels(struct rad_eye *e, float most, struct rad_error *err)
{
    e->level[0] = (struct level){ e->pic->width, e->pic->height, e->pic->L };
    e->nlevels = 1;
    while (e->nlevels < MOST_LEVELS && 1 << (e->nlevels - 1) <= most &&
           e->level[e->nlevels - 1].width >= 4 &&
           e->level[e->nlevels - 1].height >= 4) {
        if (!halve(&e->level[e->nlevels - 1], &e->level[e->nlevels]))
            return rad_fail_memory(err);
        e->nlevels++;
    }
    return 0;
}

int
rad_eye_open(struct rad_eye *e, const struct rad_human *h,
             struct rad_error *err)
{
    if (h->veil && !e->veiled)
        add_veil(e);
    if (h->acuity && !e->rated)
        return build_levels(e, take_rates(e), err);
    return 0;
}

/* A place between elements i and i + 1 of n: `part` is the weight of i + 1. */
struct between {
    int i;
    float part;
};

static struct between
between(double x, int n)
{
    struct between b = { 0, 0 };

    x = fmin(fmax(x, 0), n - 1);
    b.i = x >= n - 1 ? n - 2 : (int)x;
    b.part = (float)(x - b.i);
    return b;
}

static float
blend(const float *v, int width, struct between x, struct between y)
{
    const float *a = v + (size_t)y.i * (size_t)width + (size_t)x.i;
    const float *b = a + width;

    return (1 - y.part) * ((1 - x.part) * a[0] + x.part * a[1]) +
           y.part * ((1 - x.part) * b[0] + x.part * b[1]);
}

static struct rad_rgb
at_level(const struct rad_eye *e, int k, int x, int y)
{
    const struct level *l = &e->level[k];
    struct between u, v;
    const struct rad_rgb *a, *b;

    if (k == 0)
        return l->L[(size_t)y * (size_t)l->width + (size_t)x];
    u = between(ldexp(x + .5, -k) - .5, l->width);
    v = between(ldexp(y + .5, -k) - .5, l->height);
    a = l->L + (size_t)v.i * (size_t)l->width + (size_t)u.i;
    b = a + l->width;
    return mix(mix(a[0], a[1], u.part), mix(b[0], b[1], u.part), v.part);
}

/* The picture around (x, y) without detail finer than `rate` pixels. */
static struct rad_rgb
blurred(const struct rad_eye *e, int x, int y, float rate)
{
    int k = 0;

    while (k < e->nlevels - 1 && (float)(1 << k) <= rate)
        k++;
    if (k == 0)
        return at_level(e, 0, x, y);
    /* between levels k - 1 and k, with squares of 2^(k - 1) and 2^k pixels */
    return mix(
        at_level(e, k, x, y), at_level(e, k - 1, x, y),
        fminf(fmaxf(((float)(1 << k) - rate) / (float)(1 << (k - 1)), 0), 1));
}

/* --- rows --- */

/* Mix in what rods see, which is grey. */
static struct rad_rgb
faded(struct rad_rgb L)
{
    double lum = luminance(L);
    double cones = (lum - MESOPIC_LOW) / (MESOPIC_HIGH - MESOPIC_LOW);

    if (cones >= 1)
        return L;
    cones = fmax(cones, 0);
    return rad_rgb_add(rad_rgb_scale(L, cones),
                       rad_grey((float)((1 - cones) * scotopic(L))));
}

static struct rad_rgb
shown(const struct rad_human *h, struct rad_rgb L)
{
    double Lw = luminance(L), Ld;

    if (h->linear) /* keep values far above white finite */
        return rad_rgb_scale(L,
                             (float)fmin(h->scale, BRIGHTEST / rad_rgb_max(L)));
    if (!(Lw >= RAD_HUMAN_LEAST))
        return rad_grey(0);
    Ld = rad_human_display(h, Lw);
    Ld = (Ld - RAD_HUMAN_DARKEST) / (RAD_HUMAN_BRIGHTEST - RAD_HUMAN_DARKEST);
    return rad_rgb_scale(L, Ld * RAD_HUMAN_EFFICACY / Lw);
}

/* The foveal samples about the middle of column x of n; likewise rows. */
static struct between
among_samples(int x, int n, int samples)
{
    return between((x + .5) * ((double)samples / n) - .5, samples);
}

/* A colour between foveal samples as the light of a screen. */
static struct rad_rgb
seen(const struct rad_eye *e, const struct rad_human *h, struct between u,
     struct between v, struct rad_rgb c)
{
    if (h->veil)
        c = rad_rgb_add(rad_rgb_scale(c, 1 - VEIL),
                        rad_rgb(blend(e->veil[0], e->nx, u, v),
                                blend(e->veil[1], e->nx, u, v),
                                blend(e->veil[2], e->nx, u, v)));
    return shown(h, h->colour ? faded(c) : c);
}

void
rad_eye_row(struct rad_eye *e, const struct rad_human *h, int y,
            struct rad_rgb *out)
{
    int width = e->pic->width;
    const struct rad_rgb *L = e->pic->L + (size_t)y * (size_t)width;
    struct between v = among_samples(y, e->pic->height, e->ny);

    for (int x = 0; x < width; x++) {
        struct between u = among_samples(x, width, e->nx);

        if (!is_known(e, L[x]))
            out[x] = L[x];
        else if (h->acuity)
            out[x] =
                seen(e, h, u, v, blurred(e, x, y, blend(e->rate, e->nx, u, v)));
        else
            out[x] = seen(e, h, u, v, L[x]);
    }
}

struct rad_rgb
rad_eye_colour(const struct rad_eye *e, const struct rad_human *h, int x, int y,
               struct rad_rgb L)
{
    return seen(e, h, among_samples(x, e->pic->width, e->nx),
                among_samples(y, e->pic->height, e->ny), L);
}
