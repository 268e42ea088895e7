/* doubt.c - see doubt.h
 *
 * A difference is relative to the mean of the two values that are compared:
 * such a difference is close to the difference of their logarithms, and at most
 * 2.
 *
 * Most error is at edges and in a little gloss, on a few pixels.  So areas are
 * chosen by how much neighbouring pixels differ, and an area that was likelier
 * to be chosen counts less (Horvitz & Thompson 1952).  All pixels of a chosen
 * area are rendered once; the more the area is off, the likelier all are
 * rendered a second time, and again the area counts less for that.  All pixels
 * are needed: an error on a few of many pixels is missing from most subsets,
 * and so is its light from their mean. */
#include "config.h"

#include "picture/doubt.h"

#include "base/rng.h"
#include "light/indirect/ambserving.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

/* Keeps the keys of this file apart from those of pixels, which have a frame's
 * number in this place. */
#define BRANCH UINT64_C(0x636865636b730000)

/* The largest square of an error: one wrong edge of a lamp must not outweigh
 * all other areas. */
#define MOST_SQUARE 1.

/* Fresh samples of so many places weigh as much in the estimate as the squares
 * that all records predict.  Fresh samples are few, and a single sample may be
 * most of their sum; but where few places are badly off they show less error
 * than records predict, and rightly. */
#define AS_GOOD 64.

/* The square of the cache's error over the square that fresh samples show,
 * above -ab 1: fresh samples are made of deeper records, whose error they have
 * in common with the cache. */
#define DEEPER 1.4

/* The square of pixels' error over the square that is found: differences
 * relative to noisy light come out smaller, and areas are wider than high
 * (doc/measured.md). */
#define PIXELS 1.3

/* The largest ratio of light beyond -ab to a pixel's light, and the number of
 * further bounces that a path may have: white rooms get dark by them. */
#define MOST_BEYOND 20.
#define FURTHER     64

/* How many areas, if all are even, and places are looked at in a picture: one
 * for so many pixels (SPARSE), and no more than AREAS and PLACES.  A small
 * picture nevertheless has FEW, but not more than one for DENSEST pixels: each
 * area takes some 40 pixels, and each place two hemispheres. */
#define SPARSE_AREAS   900.
#define FEW_AREAS      80.
#define DENSEST_AREAS  400.
#define AREAS          400.
#define SPARSE_PLACES  3000.
#define FEW_PLACES     8.
#define DENSEST_PLACES 100.
#define PLACES         48.

/* Areas take few hemispheres: where these have more than MORE_RAYS rays there
 * may be as many times more areas for the same part of a picture's rays, up to
 * MORE_AREAS times.  Without a cache no small picture has more for being small,
 * for each pixel that is traced takes as many rays as in an area. */
#define MORE_RAYS  128.
#define MORE_AREAS 4.

/* An area with roughness r is 1 + BY_ROUGHNESS r times as likely to be chosen
 * as an even one.  A black area has roughness BLACK: light may be missing. */
#define BY_ROUGHNESS 10.
#define BLACK        .1

/* If an area is off by r, relative, all of its pixels are rendered a second
 * time with probability GO_ON + BY_OFF r. */
#define GO_ON  .2
#define BY_OFF 10.

/* Of the tried pixels one becomes the place, with a probability that goes by
 * the square of the error that its records predict (cut at MOST_OFF), plus EVEN
 * times the mean square of all, so that each has a chance. */
#define EVEN     .3
#define MOST_OFF 1.

/* The side of an area, in pixels of the picture that is written, and the most
 * pixels of an area: area_at() rounds to whole columns, and may add half a
 * width. */
enum {
    SIDE = RAD_DOUBT_SIDE,
    MOST_SIDE = SIDE * RAD_MAX_OVERSAMPLE,
    MOST = (MOST_SIDE * MOST_SIDE + MOST_SIDE) * 3 / 2
};
_Static_assert(RAD_QUINCUNX_MAX_YSTEP <= 2 * MOST_SIDE, "no room");

/* The two renderings: frames like the job's, with other random numbers. */
enum { FIRST, SECOND, NFRAMES };

struct look {
    struct rad_job exact; /* the job, with all direct light */
    struct rad_frame frame[NFRAMES];
    const struct rad_job *job; /* the context's job, put back by end() */
    const struct rad_doubt_rows *rows;
    struct rad_ctx *ctx;
    const _Atomic bool *stop;
    int oversample; /* of the frames, from 1 */
    uint64_t key;   /* of the area or place */
    uint32_t drawn; /* random numbers drawn of this key */
    double *sum;
    struct rad_doubt_off *off; /* NULL: not wanted */
};

static double
squared(double d)
{
    return d * d;
}

static double
bound(double square)
{
    return fmax(fmin(square, MOST_SQUARE), -MOST_SQUARE);
}

static bool
is_stopped(const struct look *k)
{
    return k->stop && atomic_load_explicit(k->stop, memory_order_relaxed);
}

static double
draw(struct look *k)
{
    return rad_rand(k->key, k->drawn++);
}

/* Render pixel (x, y) of the picture again; returns its luminance. */
static double
pixel(struct look *k, int frame, int x, int y)
{
    struct rad_pixel p;

    rad_frame_pixel(&k->frame[frame], k->ctx, x, y, &p);
    return rad_rgb_lum(p.L);
}

/* The luminance that the picture has in column x, row y of the rows. */
static double
shown(const struct look *k, int x, int y)
{
    return rad_rgb_lum(k->rows->row[y][x].L);
}

/* --- places --- */

/* The number, from 0 to beyond - 1, of a pixel in place of pixel n: both lie at
 * random in a run of an area's side. */
static int
move(struct look *k, int n, int beyond)
{
    int side = SIDE * k->oversample;
    int first = n - (int)(draw(k) * side);
    int to = first + (int)(draw(k) * side);

    return to < 0 ? 0 : to < beyond ? to : beyond - 1;
}

/* Move at[] to another pixel of its area.  Sensor points have no areas. */
static void
move_in_area(struct look *k, int at[2])
{
    const struct rad_frame *f = &k->frame[FIRST];

    if (f->points)
        return;
    at[0] = move(k, at[0], f->width);
    at[1] = move(k, at[1], f->height);
}

/* Pixels of which one becomes the place. */
struct tried {
    const int (*at)[2];
    double lum[RAD_DOUBT_TRIED]; /* luminance with cached indirect light */
    double off[RAD_DOUBT_TRIED]; /* square of its relative error, as the
                                  * records predict */
    double mean;                 /* of these squares */
};

/* Render the pixel again; *serving gets the records that serve in it. */
static double
pixel_served(struct look *k, const int at[2], struct rad_ambserving *serving)
{
    double lum;

    serving->n = serving->scaled = 0;
    k->ctx->serving = serving;
    k->ctx->doubt = 0;
    lum = pixel(k, FIRST, at[0], at[1]);
    k->ctx->serving = NULL;
    return lum;
}

/* The part of a pixel's squared error that its area shares: the correlation
 * with another pixel of the area.  Differences between the pixel's records
 * count like their noise: other records differ otherwise. */
static double
in_common(struct look *k, const int pixel_at[2],
          const struct rad_ambserving *serving)
{
    int at[2] = { pixel_at[0], pixel_at[1] };
    struct rad_ambserving other;

    move_in_area(k, at);
    if (at[0] == pixel_at[0] && at[1] == pixel_at[1])
        return 1;
    k->ctx->no_direct = true; /* the records are wanted, not the light */
    pixel_served(k, at, &other);
    k->ctx->no_direct = false;
    return rad_ambserving_common(serving, &other);
}

/* Fill in t; returns the mean square of areas' errors. */
static double
try_places(struct look *k, struct tried *t)
{
    struct rad_ambserving serving;
    double said = 0;

    t->mean = 0;
    for (int i = 0; i < RAD_DOUBT_TRIED; i++) {
        double lum = t->lum[i] = pixel_served(k, t->at[i], &serving);

        t->off[i] = lum > 0 ? fmin(k->ctx->doubt / (lum * lum), MOST_OFF) : 0;
        t->mean += t->off[i] / RAD_DOUBT_TRIED;
        if (t->off[i] > 0)
            said += t->off[i] * in_common(k, t->at[i], &serving);
    }
    return said / RAD_DOUBT_TRIED;
}

/* Choose one of the tried pixels, with a probability in proportion to
 * off[i] + EVEN mean.  *weight is the pixel's weight in the sums: an equal
 * probability over its own. */
static int
choose(struct look *k, const struct tried *t, double *weight)
{
    double mean = t->mean, share = (1 + EVEN) * RAD_DOUBT_TRIED * mean, left;
    int i = 0;

    if (!(mean > 0)) {
        *weight = 1;
        return (int)(draw(k) * RAD_DOUBT_TRIED);
    }
    left = draw(k) * share - t->off[0] - EVEN * mean;
    while (left >= 0 && i + 1 < RAD_DOUBT_TRIED)
        left -= t->off[++i] + EVEN * mean;
    *weight = (1 + EVEN) * mean / (t->off[i] + EVEN * mean);
    return i;
}

static double
deeper(const struct look *k)
{
    return k->exact.params.ambounce > 1 ? DEEPER : 1;
}

/* The square of the cache's relative error about a pixel, as the product of two
 * differences: at the pixel in the first frame, and at another pixel of its
 * area in the second frame.  So errors that average out in an area do not
 * count: of a fine cache several records serve in each area.  cached is the
 * pixel's luminance in the first frame with the cache's light; weight is the
 * place's weight in the sums. */
static double
square_at(struct look *k, const int pixel_at[2], double cached, double weight)
{
    int at[2] = { pixel_at[0], pixel_at[1] };
    double d[NFRAMES], mean = 0;

    for (int i = 0; i < NFRAMES; i++) {
        double fresh;

        if (i != FIRST) {
            move_in_area(k, at);
            cached = pixel(k, i, at[0], at[1]);
        }
        k->ctx->fresh = true;
        fresh = pixel(k, i, at[0], at[1]);
        k->ctx->fresh = false;
        d[i] = fresh - cached;
        mean += (fresh + cached) / (2 * NFRAMES);
    }
    if (k->off && !is_stopped(k)) {
        double off = sqrt(deeper(k)) * weight * (d[FIRST] + d[SECOND]) / 2;

        k->off->light += weight * mean;
        k->off->off += off;
        k->off->square += off * off;
    }
    return mean > 0 ? deeper(k) * bound(d[FIRST] * d[SECOND] / (mean * mean))
                    : 0;
}

/* Does the cache tell what comes by more bounces than it has? */
static bool
may_walk(const struct rad_params *p)
{
    return p->ambounce > 1 && !(rad_rgb_max(p->ambval) > 0) && !(p->ambvwt > 0);
}

/* The mean, over the tried pixels, of light beyond -ab, relative to the pixel's
 * light: by one path from each, without -lr, with roulette for -lw and, where
 * surfaces make light, for RAD_MAX_WALK.  With -ss above 1 a path would be
 * many. */
static double
beyond(struct look *k, const struct tried *t)
{
    struct rad_params *p = &k->exact.params;
    const struct rad_params own = *p;
    double sum = 0;

    if (!may_walk(p))
        return 0;
    p->ambdiv = 1;
    p->ambssamp = 0;
    p->ambounce += FURTHER;
    p->maxdepth = 0;
    p->specjitter = fmin(p->specjitter, 1);
    k->ctx->walk = own.ambounce;
    k->ctx->no_direct = true;
    for (int i = 0; i < RAD_DOUBT_TRIED; i++) {
        k->ctx->beyond = 0;
        pixel(k, FIRST, t->at[i][0], t->at[i][1]);
        if (t->lum[i] > 0)
            sum += fmin(k->ctx->beyond / t->lum[i], MOST_BEYOND);
    }
    k->ctx->walk = 0;
    k->ctx->no_direct = false;
    *p = own;
    return sum / RAD_DOUBT_TRIED;
}

static void
look_at_place(struct look *k, const int at[RAD_DOUBT_TRIED][2])
{
    struct tried t = { .at = at };
    double said, more, weight, square;
    int i;

    /* one ray is enough: all samples of a pixel ask for the same records */
    k->exact.params.samples = 1;
    said = try_places(k, &t);
    more = beyond(k, &t);
    i = choose(k, &t, &weight);
    square = square_at(k, at[i], t.lum[i], weight);
    if (is_stopped(k))
        return;
    k->sum[RAD_DOUBT_PLACES] += 1;
    k->sum[RAD_DOUBT_AMBIENT] += weight * square;
    k->sum[RAD_DOUBT_SAID] += said;
    k->sum[RAD_DOUBT_BEYOND] += more;
}

/* --- areas --- */

/* Columns x to x + width - 1 of the rows. */
struct area {
    int x, width, n; /* n: pixels */
};

/* The pixels of an area, rendered again; sums over all of them. */
struct redone {
    double off[NFRAMES];   /* shown less fresh luminance */
    double fresh[NFRAMES]; /* fresh luminance */
    double light;          /* luminance as shown */
    double noise;          /* the pixels' variances, each from two values */
    double alone;          /* products of each pixel's two differences */
    double lum[MOST];      /* of each pixel, in the frame rendered last */
};

/* Render pixel i of the area again, and paint it as the picture is painted: a
 * ray hardly ever meets a source that is smaller than a pixel.  Returns the
 * pixel's luminance. */
static double
remake(struct look *k, const struct area *a, int frame, int i)
{
    const struct rad_frame *f = &k->frame[frame];
    int x = k->rows->x + a->x + i % a->width, y = k->rows->y + i / a->width;
    struct rad_pixel p;

    rad_frame_pixel(f, k->ctx, x, y, &p);
    rad_frame_paint_row(f, k->ctx, x, x + 1, y, &p);
    return rad_rgb_lum(p.L);
}

static double
shown_of(const struct look *k, const struct area *a, int i)
{
    return shown(k, a->x + i % a->width, i / a->width);
}

/* Render all pixels of the area again in one frame. */
static void
redo(struct look *k, const struct area *a, struct redone *r, int frame)
{
    for (int i = 0; i < a->n && !is_stopped(k); i++) {
        double lum = remake(k, a, frame, i), off = shown_of(k, a, i) - lum;

        r->off[frame] += off;
        r->fresh[frame] += lum;
        if (frame != FIRST) {
            r->noise += squared(lum - r->lum[i]) / 2;
            r->alone += off * (shown_of(k, a, i) - r->lum[i]);
        }
        r->lum[i] = lum;
    }
}

/* How many times less noise averages out to in the area than in one of 5 by 5
 * pixels.  (Without --oversample all areas count as such.) */
static double
evened(const struct look *k, const struct area *a)
{
    return k->oversample > 1 ? sqrt(a->n) / SIDE : 1;
}

/* The probability that the area is rendered a second time, given the first. */
static double
go_on(const struct look *k, const struct area *a, const struct redone *r)
{
    double all = (r->light + r->fresh[FIRST]) / 2;
    double by_off = BY_OFF * evened(k, a);

    return all > 0 ? fmin(GO_ON + by_off * fabs(r->off[FIRST]) / all, 1)
                   : GO_ON;
}

/* The part of an area that rows are too short for.  (Without --oversample areas
 * of fewer pixels count as they are.) */
static double
lacks(const struct look *k, const struct area *a)
{
    int side = SIDE * k->oversample;

    return k->oversample > 1 ? fmax(1 - (double)a->n / (side * side), 0) : 0;
}

/* Half of an area's light is as shown, half rendered again. */
static void
look_at_area(struct look *k, const struct area *a, double weight)
{
    struct redone r = { .light = 0 };
    double likely, all, square;

    for (int i = 0; i < a->n; i++)
        r.light += shown_of(k, a, i);
    redo(k, a, &r, FIRST);
    if (is_stopped(k))
        return;
    k->sum[RAD_DOUBT_AREAS] += weight;
    likely = go_on(k, a, &r);
    if (draw(k) >= likely)
        return;
    redo(k, a, &r, SECOND);
    all = r.light / 2 + (r.fresh[FIRST] + r.fresh[SECOND]) / 4;
    if (is_stopped(k) || !(all > 0))
        return;
    weight /= likely;
    /* what pixels err by alone would average out over more of them */
    square = r.off[FIRST] * r.off[SECOND] - lacks(k, a) * r.alone;
    square = weight * bound(square / squared(all));
    k->sum[RAD_DOUBT_PIXEL] += square;
    k->sum[RAD_DOUBT_PIXEL2] += squared(square);
    k->sum[RAD_DOUBT_NOISE] +=
        weight * fmin((1 - lacks(k, a)) * r.noise / squared(all), MOST_SQUARE);
}

/* The root of the summed squares by which neighbouring pixels differ, over the
 * light of all.  An area's light is off by some .3 times as much where edges
 * run anywhere between two pixels. */
static double
roughness(const struct look *k, const struct area *a)
{
    double lum[MOST], light = 0, squares = 0;

    for (int i = 0; i < a->n; i++) {
        light += lum[i] = shown_of(k, a, i);
        if (i % a->width > 0)
            squares += squared(lum[i] - lum[i - 1]);
        if (i >= a->width)
            squares += squared(lum[i] - lum[i - a->width]);
    }
    return light > 0 ? sqrt(squares) / light : BLACK;
}

static void
look_about(struct look *k, const struct area *a,
           const struct rad_doubt_share *share)
{
    double rough = 1 + BY_ROUGHNESS * evened(k, a) * roughness(k, a);
    double pixels = k->oversample > 1 ? SIDE * SIDE : a->n;
    double likely = fmin(share->areas * pixels * rough, 1);

    if (draw(k) < likely)
        look_at_area(k, a, 1 / likely);
}

/* --- rows --- */

/* How many places to look at in a picture. */
static double
places_of(double pixels)
{
    double few = fmin(FEW_PLACES, pixels / DENSEST_PLACES);

    return fmin(fmax(pixels / SPARSE_PLACES, few), PLACES);
}

/* How many areas to look at in a picture. */
static double
areas_of(const struct rad_job *job, double pixels)
{
    double few = fmin(FEW_AREAS, pixels / DENSEST_AREAS);
    double more = fmin(fmax(job->params.ambdiv / MORE_RAYS, 1), MORE_AREAS);

    if (!job->ambient)
        return fmin(pixels / SPARSE_AREAS, AREAS);
    return fmin(more * fmax(pixels / SPARSE_AREAS, few), AREAS);
}

struct rad_doubt_share
rad_doubt_of_picture(const struct rad_frame *f)
{
    double pixels = (double)f->width * f->height;

    /* most of what sensor points err by is on the few at shadows' edges, of
     * which a sparse subset knows nothing */
    return (struct rad_doubt_share){
        .areas = f->points ? 0 : areas_of(f->job, pixels) / pixels,
        .places = f->job->ambient ? places_of(pixels) / pixels : 0
    };
}

static struct rad_frame
with_key(const struct rad_frame *f, uint64_t which)
{
    struct rad_frame out = *f;

    out.key = rad_key_branch(f->key ^ BRANCH, which);
    out.stamp = rad_key_branch(f->stamp ^ BRANCH, which) | 1;
    return out;
}

/* The width of areas in rows.  A sensor point is an area by itself: a user
 * reads each point, not the mean of neighbours.  With --oversample rows may be
 * much lower than an area: then areas are no longer than a square, which has
 * neighbours as near to each other (the sum of the sides' squares is the same),
 * so that errors that pixels share are the same part of both; and lacks()
 * counts for what pixels err by alone. */
static int
width_of_areas(const struct rad_doubt_rows *rows)
{
    int side = SIDE * rad_frame_oversample(rows->frame), n = rows->n;

    if (rows->frame->points)
        return 1;
    if (rad_frame_oversample(rows->frame) > 1 && n < side)
        return (int)(sqrt(2 * side * side - n * n) + .5);
    return (side * side + n / 2) / n;
}

/* The area that begins at column x.  The columns left are cut into equal parts,
 * because a narrow area at the end would count as much as any other. */
static struct area
area_at(const struct rad_doubt_rows *rows, int x)
{
    int width = width_of_areas(rows);
    int left = rows->width - x, parts = (left + width / 2) / width;
    struct area a = { .x = x, .width = parts > 1 ? left / parts : left };

    a.n = a.width * rows->n;
    return a;
}

static void
begin(struct look *k, const struct rad_frame *f, struct rad_ctx *ctx,
      struct rad_doubt *to)
{
    *k = (struct look){ .exact = *f->job,
                        .job = ctx->job,
                        .ctx = ctx,
                        .oversample = rad_frame_oversample(f),
                        .sum = to->v };
    k->exact.params.specthresh = 0;
    k->exact.params.shadthresh = 0;
    k->exact.params.shadcert = 1;
    k->exact.params.srcjitter = 1;
    for (int i = 0; i < NFRAMES; i++) {
        k->frame[i] = with_key(f, (uint64_t)i);
        k->frame[i].job = &k->exact;
    }
    ctx->job = &k->exact;
    ctx->aside = true;
}

static void
end(struct look *k)
{
    k->ctx->job = k->job;
    k->ctx->aside = false;
}

void
rad_doubt_place(const struct rad_frame *f, struct rad_ctx *ctx, uint64_t key,
                const int at[RAD_DOUBT_TRIED][2], struct rad_doubt *to,
                struct rad_doubt_off *off)
{
    struct look k;

    begin(&k, f, ctx, to);
    k.key = key;
    k.off = off;
    look_at_place(&k, at);
    end(&k);
}

/* Look at `share` places per pixel of the rows. */
static void
look_at_places(struct look *k, double share)
{
    const struct rad_doubt_rows *r = k->rows;
    double n = floor(share * r->width * r->n + draw(k));
    int at[RAD_DOUBT_TRIED][2];

    for (; n >= 1 && !is_stopped(k); n--) {
        for (int i = 0; i < RAD_DOUBT_TRIED; i++) {
            at[i][0] = r->x + (int)(draw(k) * r->width);
            at[i][1] = r->y + (int)(draw(k) * r->n);
        }
        look_at_place(k, (const int(*)[2])at);
    }
}

static void
draw_anew(struct look *k, int x)
{
    const struct rad_doubt_rows *r = k->rows;

    k->key = rad_key_in_frame(r->frame->key ^ BRANCH, (uint32_t)(r->x + x),
                              (uint32_t)r->y);
    k->drawn = 0;
}

bool
rad_doubt_look(const struct rad_doubt_rows *rows, struct rad_ctx *ctx,
               const struct rad_doubt_share *share, const _Atomic bool *stop,
               struct rad_doubt *to)
{
    struct look k;
    struct area a;

    begin(&k, rows->frame, ctx, to);
    k.rows = rows;
    k.stop = stop;
    for (int x = 0; x < rows->width && !is_stopped(&k); x += a.width) {
        a = area_at(rows, x);
        draw_anew(&k, x);
        look_about(&k, &a, share);
    }
    draw_anew(&k, rows->width);
    look_at_places(&k, share->places);
    end(&k);
    return !is_stopped(&k);
}

/* How many of a window's rows have areas beside each other: those of a bar, as
 * in a picture; with --oversample, where that would make areas long, so many
 * that areas are square. */
static int
rows_at_once(const struct rad_frame *f, int rows, int ystep)
{
    int side = SIDE * rad_frame_oversample(f), parts = (rows + side / 2) / side;

    if (rad_frame_oversample(f) == 1)
        return ystep;
    return parts > 1 ? (rows + parts - 1) / parts : rows;
}

bool
rad_doubt_look_at_window(const struct rad_doubt_rows *window,
                         struct rad_ctx *ctx,
                         const struct rad_doubt_share *share,
                         const _Atomic bool *stop, struct rad_doubt *to)
{
    struct rad_doubt_rows rows = *window;
    int first = window->n > 1, n, xstep, ystep;
    bool ok = true;

    rad_quincunx_steps(rows.frame->job->params.psample, &xstep, &ystep);
    n = rows_at_once(rows.frame, window->n - first, ystep);
    for (int y = first; ok && y < window->n; y += n) {
        rows.y = window->y + y;
        rows.n = window->n - y < n ? window->n - y : n;
        rows.row = window->row + y;
        ok = rad_doubt_look(&rows, ctx, share, stop, to);
    }
    return ok;
}

/* --- errors --- */

void
rad_doubt_add(struct rad_doubt *to, const struct rad_doubt *more)
{
    for (int i = 0; i < RAD_DOUBT_SUMS; i++)
        to->v[i] += more->v[i];
}

/* The mean over n areas, given the sum of their products and the sum of the
 * products' squares.  By chance the sum may be negative or near 0, so the
 * result is at least half of its own standard error. */
static double
mean_square(double n, double sum, double squares)
{
    return n >= 1 ? rad_doubt_sound(
                        fmax(sum / n, .5 * sqrt(rad_doubt_sound(squares)) / n))
                  : 0;
}

static double
ambient_square(const double *v)
{
    double n = v[RAD_DOUBT_PLACES], fresh;

    if (!(n >= 1))
        return 0;
    fresh = n / (n + AS_GOOD);
    return fresh * rad_doubt_sound(v[RAD_DOUBT_AMBIENT] / n) +
           (1 - fresh) * rad_doubt_sound(v[RAD_DOUBT_SAID] / n);
}

struct rad_error_squares
rad_doubt_squares(const struct rad_doubt *d)
{
    const double *v = d->v;
    struct rad_error_squares s = { ambient_square(v),
                                   PIXELS * mean_square(v[RAD_DOUBT_AREAS],
                                                        v[RAD_DOUBT_PIXEL],
                                                        v[RAD_DOUBT_PIXEL2]),
                                   0 };

    if (v[RAD_DOUBT_AREAS] >= 1)
        s.noise = fmin(
            PIXELS * rad_doubt_sound(v[RAD_DOUBT_NOISE] / v[RAD_DOUBT_AREAS]),
            s.sampling);
    return s;
}

struct rad_error_estimate
rad_doubt_error(const struct rad_doubt *d)
{
    struct rad_error_squares s = rad_doubt_squares(d);

    return (struct rad_error_estimate){ fmin(sqrt(s.ambient), RAD_DOUBT_MOST),
                                        fmin(sqrt(s.sampling), RAD_DOUBT_MOST),
                                        fmin(sqrt(s.ambient + s.sampling),
                                             RAD_DOUBT_MOST) };
}

double
rad_doubt_left_out(const struct rad_doubt *d)
{
    double n = d->v[RAD_DOUBT_PLACES], more;

    if (!(n >= 1))
        return 0;
    more = rad_doubt_sound(d->v[RAD_DOUBT_BEYOND] / n);
    return more / (1 + more);
}

/* The square of the places' summed error, less the part that their noise is
 * expected to leave in it. */
double
rad_doubt_of_mean(const struct rad_doubt_off *o, double n)
{
    double off = o->off / o->light, square = off * off, chance;

    if (!(n >= 2 && o->light > 0))
        return 0;
    chance = rad_doubt_sound(o->square / (o->light * o->light) - square / n) *
             n / (n - 1);
    return fmin(sqrt(rad_doubt_sound(fmax(square - chance, .25 * chance))),
                RAD_DOUBT_MOST);
}
