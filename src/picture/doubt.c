/* doubt.c - see doubt.h
 *
 * A difference is relative to the mean of the two values that are compared:
 * such a difference is close to the difference of their logarithms, and at most
 * 2.
 *
 * Most error is at edges and in a little gloss, on a few pixels.  So areas are
 * chosen by their contrast, and an area that was likelier to be chosen counts
 * less (Horvitz & Thompson 1952).  A few pixels of a chosen area are rendered
 * first; the more these are off, the likelier all pixels of the area are
 * rendered, twice, and again the area counts less for that.  All pixels are
 * needed: an error on a few of many pixels is missing from most subsets, and
 * so is its light from their mean. */
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

/* The square of the cache's error over the square that fresh samples show:
 * fresh samples are made of deeper records, whose error they have in common
 * with the cache. */
#define DEEPER 1.4

/* The square of pixels' error over the square that is found: differences
 * relative to noisy light come out smaller, and areas are wider than high
 * (doc/measured.md). */
#define PIXELS 1.3

/* The largest ratio of light beyond -ab to a pixel's light, and the number of
 * further bounces that a path may have: white rooms get dark by them. */
#define MOST_BEYOND 20.
#define FURTHER     64

/* The number of areas, if none has contrast, and the number of places that are
 * looked at in a picture. */
#define AREAS  600.
#define PLACES 48.

/* But there is at most one area, or place, for so many pixels.  Areas take few
 * hemispheres: where these have more than DENSER_RAYS rays there may be as many
 * times more areas for the same part of a picture's rays, up to DENSEST_AREAS
 * times.  A small picture nevertheless has up to FEW_PLACES places, but not
 * more than one for DENSEST_PLACES pixels: each place takes two hemispheres. */
#define SPARSE_AREAS   600.
#define DENSER_RAYS    128.
#define DENSEST_AREAS  4.
#define SPARSE_PLACES  3000.
#define FEW_PLACES     8.
#define DENSEST_PLACES 100.

/* An area with contrast c is 1 + BY_CONTRAST c^2 times as likely to be chosen
 * as one without.  A black area has contrast BLACK: light may be missing. */
#define BY_CONTRAST 3.
#define BLACK       .5

/* If the first pixels of an area are off by r, relative, all of its pixels are
 * rendered again with probability GO_ON + BY_OFF r. */
#define GO_ON  .3
#define BY_OFF 2.

/* Of the tried pixels one becomes the place, with a probability that goes by
 * the square of the error that its records predict (cut at MOST_OFF), plus EVEN
 * times the mean square of all, so that each has a chance. */
#define EVEN     .3
#define MOST_OFF 1.

enum {
    SIDE = 5,
    AREA = SIDE * SIDE, /* pixels of an area, about */
    FEW = 4,            /* pixels of an area that are rendered first */
    MOST = 50           /* pixels of an area, at most */
};
/* area_at() rounds to whole columns, and may add half a width */
_Static_assert((AREA + RAD_QUINCUNX_MAX_YSTEP / 2) * 3 / 2 <= MOST, "no room");

/* The two renderings: frames like the job's, with other random numbers. */
enum { FIRST, SECOND, NFRAMES };

struct look {
    struct rad_job exact; /* the job, with all direct light */
    struct rad_frame frame[NFRAMES];
    const struct rad_job *job; /* the context's job, put back by end() */
    const struct rad_doubt_rows *rows;
    struct rad_ctx *ctx;
    const _Atomic bool *stop;
    uint64_t key;   /* of the area or place */
    uint32_t drawn; /* random numbers drawn of this key */
    double *sum;
    struct rad_doubt_off *off; /* NULL: not wanted */
};

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

/* Render the pixel in column x, row y of the rows again; returns its luminance.
 */
static double
again(struct look *k, int frame, int x, int y)
{
    return pixel(k, frame, k->rows->x + x, k->rows->y + y);
}

/* The luminance that the picture has in column x, row y of the rows. */
static double
shown(const struct look *k, int x, int y)
{
    return rad_rgb_lum(k->rows->row[y][x].L);
}

/* --- places --- */

/* The number, from 0 to beyond - 1, of a pixel in place of pixel n: both lie at
 * random in a run of SIDE pixels. */
static int
move(struct look *k, int n, int beyond)
{
    int first = n - (int)(draw(k) * SIDE);
    int to = first + (int)(draw(k) * SIDE);

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
        double off = weight * (d[FIRST] + d[SECOND]) / 2;

        k->off->light += weight * mean;
        k->off->off += off;
        k->off->square += off * off;
    }
    return mean > 0 ? bound(d[FIRST] * d[SECOND] / (mean * mean)) : 0;
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

/* Pixels of an area that are rendered again. */
struct redone {
    int order[MOST];     /* the area's pixels, shuffled */
    int n[NFRAMES];      /* so many pixels are done, in each frame */
    double off[NFRAMES]; /* sums of shown less fresh luminance */
    double first[MOST];  /* shown less fresh luminance in the first frame, by
                          * pixel of `order` */
    double noise;        /* sum of the pixels' variances, each from two
                          * values */
    double light, fresh; /* luminance of all pixels as shown, and of all that
                          * were rendered again */
};

static double
remake(struct look *k, const struct area *a, int frame, int i)
{
    return again(k, frame, a->x + i % a->width, i / a->width);
}

static double
shown_of(const struct look *k, const struct area *a, int i)
{
    return shown(k, a->x + i % a->width, i / a->width);
}

static void
shuffle(struct look *k, const struct area *a, int order[MOST])
{
    for (int i = 0; i < a->n; i++)
        order[i] = i;
    for (int i = 0; i + 1 < a->n; i++) {
        int other = i + (int)(draw(k) * (a->n - i)), kept = order[i];

        order[i] = order[other];
        order[other] = kept;
    }
}

/* Render pixels again in one frame until n are done. */
static void
redo(struct look *k, const struct area *a, struct redone *r, int frame, int n)
{
    for (int i = r->n[frame]; i < n && !is_stopped(k); r->n[frame] = ++i) {
        double lum = remake(k, a, frame, r->order[i]);
        double off = shown_of(k, a, r->order[i]) - lum;

        r->off[frame] += off;
        r->fresh += lum;
        if (frame == FIRST)
            r->first[i] = off;
        else
            r->noise += (off - r->first[i]) * (off - r->first[i]) / 2;
    }
}

/* The area's mean luminance: half shown, half rendered again. */
static double
mean_of(const struct area *a, const struct redone *r)
{
    return (r->light / a->n + r->fresh / (r->n[FIRST] + r->n[SECOND])) / 2;
}

/* The probability that all pixels of the area are rendered again, given the
 * first few. */
static double
go_on(const struct area *a, const struct redone *r)
{
    double mean = mean_of(a, r), off = 0;

    for (int i = 0; i < r->n[FIRST]; i++)
        off += fabs(r->first[i]);
    return mean > 0 ? fmin(GO_ON + BY_OFF * off / (r->n[FIRST] * mean), 1)
                    : GO_ON;
}

/* whole: all pixels of the area are rendered again, whatever the first few are
 * off by. */
static void
look_at_area(struct look *k, const struct area *a, double weight, bool whole)
{
    struct redone r = { .light = 0 };
    double likely, all, square;

    shuffle(k, a, r.order);
    for (int i = 0; i < a->n; i++)
        r.light += shown_of(k, a, i);
    redo(k, a, &r, FIRST, a->n < FEW ? a->n : FEW);
    if (is_stopped(k))
        return;
    k->sum[RAD_DOUBT_AREAS] += weight;
    likely = whole ? 1 : go_on(a, &r);
    if (draw(k) >= likely)
        return;
    redo(k, a, &r, FIRST, a->n);
    redo(k, a, &r, SECOND, a->n);
    all = a->n * mean_of(a, &r);
    if (is_stopped(k) || !(all > 0))
        return;
    weight /= likely;
    square = r.off[FIRST] * r.off[SECOND] / (all * all);
    square = weight * bound(square);
    k->sum[RAD_DOUBT_PIXEL] += square;
    k->sum[RAD_DOUBT_PIXEL2] += square * square;
    k->sum[RAD_DOUBT_NOISE] +=
        weight * fmin(r.noise / (all * all), MOST_SQUARE);
}

static double
contrast(const struct look *k, const struct area *a)
{
    double lo = shown(k, a->x, 0), hi = lo;

    for (int i = 0; i < a->n; i++) {
        double lum = shown(k, a->x + i % a->width, i / a->width);

        lo = fmin(lo, lum);
        hi = fmax(hi, lum);
    }
    return hi > 0 ? (hi - lo) / (hi + lo) : BLACK;
}

static void
look_about(struct look *k, const struct area *a,
           const struct rad_doubt_share *share)
{
    double c = contrast(k, a);
    double likely = fmin(share->areas * a->n * (1 + BY_CONTRAST * c * c), 1);

    if (draw(k) < likely)
        look_at_area(k, a, 1 / likely, isinf(share->areas));
}

/* --- rows --- */

/* How many places to look at in a picture. */
static double
places_of(double pixels)
{
    double few = fmin(FEW_PLACES, pixels / DENSEST_PLACES);

    return fmin(fmax(pixels / SPARSE_PLACES, few), PLACES);
}

/* How many areas to look at per pixel. */
static double
areas_of(const struct rad_job *job, double pixels)
{
    double rays = job->ambient ? job->params.ambdiv / DENSER_RAYS : 0;

    return fmin(fmin(fmax(rays, 1), DENSEST_AREAS) / SPARSE_AREAS,
                AREAS / pixels);
}

struct rad_doubt_share
rad_doubt_of_picture(const struct rad_frame *f)
{
    double pixels = (double)f->width * f->height;

    /* most of what sensor points err by is on the few at shadows' edges, of
     * which a sparse subset knows nothing */
    return (struct rad_doubt_share){
        .areas = f->points ? 0 : areas_of(f->job, pixels),
        .places = f->job->ambient ? places_of(pixels) / pixels : 0
    };
}

static struct rad_frame
with_key(const struct rad_frame *f, uint64_t which)
{
    struct rad_frame out = *f;

    out.key = rad_key_branch(f->key ^ BRANCH, which);
    out.stamp = rad_key_branch(f->stamp ^ BRANCH, which) | 1;
    out.depth = false;
    return out;
}

/* The area that begins at column x.  The columns left are cut into equal parts,
 * because a narrow area at the end would count as much as any other.  A sensor
 * point is an area by itself: a user reads each point, not the mean of
 * neighbours. */
static struct area
area_at(const struct rad_doubt_rows *rows, int x)
{
    int width = rows->frame->points ? 1 : (AREA + rows->n / 2) / rows->n;
    int left = rows->width - x, parts = (left + width / 2) / width;
    struct area a = { .x = x, .width = parts > 1 ? left / parts : left };

    a.n = a.width * rows->n;
    return a;
}

static void
begin(struct look *k, const struct rad_frame *f, struct rad_ctx *ctx,
      struct rad_doubt *to)
{
    *k = (struct look){
        .exact = *f->job, .job = ctx->job, .ctx = ctx, .sum = to->v
    };
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

bool
rad_doubt_look_at_window(const struct rad_frame *f, struct rad_ctx *ctx,
                         const struct rad_window *w,
                         const struct rad_pixel *const row[],
                         const struct rad_doubt_share *share,
                         const _Atomic bool *stop, struct rad_doubt *to)
{
    struct rad_doubt_rows rows = { .frame = f, .x = w->x, .width = w->width };
    bool ok = true;
    int xstep, ystep;

    rad_quincunx_steps(f->job->params.psample, &xstep, &ystep);
    for (int y = w->height > 1; ok && y < w->height; y += ystep) {
        rows.y = w->y + y;
        rows.n = w->height - y < ystep ? w->height - y : ystep;
        rows.row = row + y;
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
    return fresh * DEEPER * rad_doubt_sound(v[RAD_DOUBT_AMBIENT] / n) +
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
    return fmin(
        sqrt(DEEPER * rad_doubt_sound(fmax(square - chance, .25 * chance))),
        RAD_DOUBT_MOST);
}
