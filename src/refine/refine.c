/* refine.c - see refine.h
 *
 * What comes next is foreseen from the last stage's sums: errors fall by so
 * much with a rung, and rays grow.  Of all rungs the cheapest that come down to
 * what is wanted are taken: those of a further stage, or more rays of a pixel
 * over the cache that is there.  Where time does not allow any of these, of
 * those that it allows the ones that come farthest down are, in quarters of a
 * rung.
 * Only products, sums and square roots: they are the same everywhere. */
#include "config.h"

#include "refine/refine.h"

#include <math.h>

/* Tiles of a check pass: one for so many pixels, within these bounds.  A tile
 * makes about LOOKS pixels again (recheck.c), and looks records up in as many.
 * Of a few sensors a check makes each again LOOKS_A_SENSOR times, not more
 * often. */
#define PIXELS_A_TILE 2048
#define LEAST_TILES   36
#define MOST_TILES    96
#define LOOKS         16

#define LOOKS_A_SENSOR 2

/* A check of a cache with a smaller -aa than COARSE has more tiles, as the cache
 * has more records, up to TIMES_MOST times as many: what it tells is nearer to
 * the truth, and it takes no greater part of its stage. */
#define COARSE     .25
#define TIMES_MOST 4

/* Squares of errors: so much less than what is wanted is aimed at, and so much
 * more is near enough, for another stage takes longer than this one did. */
#define AIM         .85
#define NEAR_ENOUGH 1.2

/* A further stage brings so much at least: not the last seventh, where rays
 * leave no more.  Time is there to be used. */
#define WORTH_IT       .85
#define WORTH_ITS_TIME .95

/* What takes more than so many times the rays of this stage is not foreseen
 * well: a stage with such a part of its rays comes before it, and tells how
 * fast the error falls. */
#define FAR    20
#define BEFORE .25

/* Rays of passes that go to lattices and paths, for a pixel: they do not grow
 * with rungs.  But some part of a stage always does. */
#define WALKED     .25
#define LEAST_MADE .2

/* Of the time that is left, what is planned to be used. */
#define TIME_USED .85

/* A ray of a picture takes so much of the time that one of a check does, whose
 * windows are small and far apart: .5 to .9 (doc/measured.md). */
#define PICTURE_PRICE .8

/* Of the time that is planned to be used, what a last stage takes at most, the
 * rest being the pixels'.  Both errors fall with the root of their time at
 * best, so no other split is better than halves by more than a factor of 1.4;
 * and the cache's may fall more slowly than was foreseen. */
#define STAGE_TAKES .5

/* If the time to be used is more than so many times as long as this stage took,
 * a stage with such a part of it comes first, for what a stage takes is
 * foreseen well from one near it. */
#define FAR_IN_TIME    5
#define BEFORE_IN_TIME .15

/* Without a limit of time, rays that a stage and its pictures may be foreseen
 * to take: so many for a pixel, or some ten minutes of a processor where that
 * is more.  Whoever waits longer for an error says so by a time. */
#define RAYS_A_PIXEL 1024.
#define ALWAYS_RAYS  8e8

/* Time for any stage, and seconds for a ray where they are not known. */
#define AMPLE_S 1e12
#define QUICK_S 1e-12

/* No picture any more. */
#define MOST_ERROR 1e6

/* --- options --- */

/* Of an octave, one for each quarter of a rung that falls by an eighth. */
#define EIGHTHS 8
#define PARTS   (EIGHTHS * RAD_REFINE_RUNG)

/* 2 to the power of -n / PARTS. */
static double
fall(int n)
{
    static const double eighth[EIGHTHS] = {
        1.0,
        0.91700404320467121,
        0.84089641525371454,
        0.77110541270397037,
        0.70710678118654752,
        0.64841977732550483,
        0.59460355750136053,
        0.54525386633262884,
    };
    static const double part[RAD_REFINE_RUNG] = { 1.0, 0.97857206208770013,
                                                  0.95760328069857365,
                                                  0.93708381705514995 };

    return ldexp(eighth[n / RAD_REFINE_RUNG % EIGHTHS] *
                     part[n % RAD_REFINE_RUNG],
                 -(n / PARTS));
}

static int
least(int a, int b)
{
    return a < b ? a : b;
}

/* A number of rays or so, x times as large. */
static int
grow(int n, double x, int limit)
{
    double to = floor(n * x + .5);

    return n <= 0 || n >= limit ? n : to < limit ? (int)to : limit;
}

/* To six digits, for it is read in headers; what is tiny stays as it is. */
static double
shorten(double x)
{
    double scale = 1e5; /* a power of ten that is exact, or nearly */

    if (!(x >= 1e-12))
        return x;
    while (x * scale < 1e5)
        scale *= 10;
    return floor(x * scale + .5) / scale;
}

/* Eighths of an octave by which something changes with a rung of the cache,
 * which are as many PARTS of an octave with a quarter of a rung: in the first
 * SOON, and after these.  -aa and -ar come first: a coarse -ar leaves zones
 * that are too large wherever objects are near, and records that are close
 * together average each other's noise, so many with few rays are worth more
 * than few with many, but each needs enough to find what is small and bright
 * (doc/measured.md). */
enum { SOON = 4 * RAD_REFINE_RUNG };
struct course {
    int soon, later;
};
static const struct course ambacc_fall = { 2, 1 };
static const struct course ambdiv_growth = { 0, 1 };
static const struct course ambres_growth = { 6, 1 };

/* Parts of an octave from rung 0 to that one. */
static int
parts_at(struct course c, int ambient)
{
    return ambient <= SOON ? c.soon * ambient
                           : c.soon * SOON + c.later * (ambient - SOON);
}

/* Options of pixels change once, with their first rung; then a pixel gets more
 * rays, which bring more for their price. */
enum { SAMPLES_GROWTH = 4, ONE_RAY = RAD_REFINE_RUNG };

/* Parts of lamps that look smaller than this take more rays than samples with
 * -dj that find as much. */
#define SMALL_PART .2

/* What is left of what -dt and -dc leave out, and of what -pt lets pass. */
#define SHADOWS_LEFT .25
#define MAXDIFF_LEFT .5

#define MOST_AMBDIV 65536
#define MOST_AMBRES 1024

/* How many times the rays that a pixel has at rung 0, as a whole number:
 * one up to a rung above ONE_RAY. */
static int
rays_of_pixel(int pixel)
{
    return pixel > ONE_RAY
               ? (int)(1 / fall(SAMPLES_GROWTH * (pixel - ONE_RAY)) + .5)
               : 1;
}

void
rad_refine_params(const struct rad_params *job, struct rad_refine_rungs rungs,
                  struct rad_params *out)
{
    int a = least(rungs.ambient, RAD_REFINE_MOST_AMBIENT);
    int p = least(rungs.pixel, RAD_REFINE_MOST_PIXEL);
    double rays = 1 / fall(parts_at(ambdiv_growth, a));

    *out = *job;
    if (a > 0) {
        out->ambacc = shorten(job->ambacc * fall(parts_at(ambacc_fall, a)));
        out->ambdiv = grow(job->ambdiv, rays, MOST_AMBDIV);
        out->ambssamp = grow(job->ambssamp, rays, MOST_AMBDIV);
        out->ambres = grow(job->ambres, 1 / fall(parts_at(ambres_growth, a)),
                           MOST_AMBRES);
    }
    if (p > 0) {
        out->maxdiff = shorten(job->maxdiff * MAXDIFF_LEFT);
        out->samples = grow(job->samples, rays_of_pixel(p), RAD_MOST_SAMPLES);
        out->srcsizerat = fmin(job->srcsizerat, SMALL_PART);
        out->srcjitter = fmax(job->srcjitter, 1);
        out->shadthresh = shorten(job->shadthresh * SHADOWS_LEFT);
        out->shadcert = 1 - shorten((1 - job->shadcert) * SHADOWS_LEFT);
        out->specthresh = 0; /* what it leaves out is no noise */
    }
}

bool
rad_refine_same_cache(struct rad_refine_rungs a, struct rad_refine_rungs b)
{
    return a.ambient == b.ambient && (a.pixel > 0) == (b.pixel > 0);
}

/* Of parts of a whole 0 makes one, and of -ar it sets no limit. */
static bool
is_finer_part(double a, double b)
{
    return a == b || (a > 0 && (b == 0 || a < b));
}

static bool
is_higher_limit(int a, int b)
{
    return a == b || (b > 0 && (a > b || a == 0));
}

static bool
is_as_fine(const struct rad_params *a, const struct rad_params *b)
{
    return a->ambacc <= b->ambacc && a->ambdiv >= b->ambdiv &&
           a->ambssamp >= b->ambssamp &&
           is_higher_limit(a->ambres, b->ambres) &&
           is_finer_part(a->srcsizerat, b->srcsizerat) &&
           a->srcjitter >= b->srcjitter && a->shadthresh <= b->shadthresh &&
           a->specthresh <= b->specthresh && a->shadcert >= b->shadcert;
}

bool
rad_refine_join(struct rad_params *job, const struct rad_params *former)
{
    if (!is_as_fine(former, job))
        return false;
    job->ambacc = former->ambacc;
    job->ambdiv = former->ambdiv;
    job->ambssamp = former->ambssamp;
    job->ambres = former->ambres;
    job->maxdiff = fmin(former->maxdiff, job->maxdiff);
    job->samples =
        former->samples > job->samples ? former->samples : job->samples;
    job->srcsizerat = former->srcsizerat;
    job->srcjitter = former->srcjitter;
    job->shadthresh = former->shadthresh;
    job->specthresh = former->specthresh;
    job->shadcert = former->shadcert;
    return true;
}

/* --- passes --- */

static uint32_t
count_tiles(const struct rad_params *par, const struct rad_pass_size *size,
            uint32_t nsizes)
{
    double finer = fmax(COARSE / par->ambacc, 1);
    uint32_t times = (uint32_t)fmin(finer * finer, TIMES_MOST);
    uint64_t pixels = 0, n, few;

    for (uint32_t i = 0; i < nsizes; i++)
        pixels += (uint64_t)size[i].width * (uint64_t)size[i].height;
    n = pixels / PIXELS_A_TILE;
    n = n < LEAST_TILES ? LEAST_TILES : n > MOST_TILES ? MOST_TILES : n;
    n *= times;
    few = (LOOKS_A_SENSOR * pixels + LOOKS - 1) / LOOKS;
    return (uint32_t)(n < few ? n : few);
}

uint32_t
rad_refine_plan(const struct rad_params *par, const struct rad_pass_size *size,
                uint32_t nsizes, bool on, bool check,
                struct rad_pass pass[RAD_MOST_PASSES])
{
    uint32_t n =
        (on ? rad_passes_plan_on : rad_passes_plan)(par, size, nsizes, pass);

    if (n == 0 || !check)
        return n;
    if (n == RAD_MOST_PASSES)
        return 0;
    for (uint32_t i = 0; i < n; i++)
        pass[i].ready = 0;
    pass[n] = (struct rad_pass){ .reads = n,
                                 .part = -1,
                                 .check = true,
                                 .stride = 1,
                                 .beyond = nsizes,
                                 .ready = nsizes,
                                 .tiles = count_tiles(par, size, nsizes) };
    return n + 1;
}

void
rad_refine_add(struct rad_refine_sums *to, const struct rad_refine_sums *tile)
{
    rad_doubt_add(&to->doubt, &tile->doubt);
    to->off.light += tile->off.light;
    to->off.off += tile->off.off;
    to->off.square += tile->off.square;
    to->shown += tile->shown;
    to->rays += tile->rays;
}

/* --- decisions --- */

/* A number that is none, or negative, is 0. */
static double
sound(double x)
{
    return x > 0 ? fmin(x, MOST_ERROR * MOST_ERROR) : 0;
}

/* Eighths of an octave by which the square of the cache's error falls with a
 * rung, as it does in five scenes on average.  In single scenes it falls by one
 * more or less, which stages tell that are so many rungs apart. */
static const struct course ambient_fall = { 6, 3 };
enum { APART = 3 * RAD_REFINE_RUNG };

/* What the first rung of pixels leaves of squares of their errors, and of noise
 * of a ray, which is of lamps or, and then it stays, of edges and gloss that
 * few pixels show; and how many times the rays it takes. */
#define PIXEL_LEFT  .5
#define NOISE_LEFT  .7
#define FIRST_TAKES 1.4

/* What is known after a stage. */
struct outlook {
    const struct rad_refine_ask *ask;
    double ambient, pixel, noise; /* squares; noise: no more than pixel */
    int steeper;       /* .ambient falls by so much more with a rung, -1 to 1 */
    double walk, made; /* rays of passes: see WALKED, and the rest */
    double check, picture; /* rays */
    int most_rays; /* times the rays of a pixel at rung 0 that it may have */
};

/* 2 to the power of n / PARTS, n of either sign. */
static double
rise(int n)
{
    return n > 0 ? 1 / fall(n) : fall(-n);
}

/* Parts of an octave from one rung to another. */
static int
parts_between(struct course c, int from, int to)
{
    return parts_at(c, to) - parts_at(c, from);
}

/* By how much more than on average it has fallen with a rung. */
static int
observed_steeper(const struct rad_refine_ask *ask, double ambient)
{
    int apart = ask->rungs.ambient - ask->past.rung;
    int usual = parts_between(ambient_fall, ask->past.rung, ask->rungs.ambient);
    double fell = ask->past.square / ambient;

    if (apart < APART || !(fell > 0))
        return 0;
    fell *= fell;
    return fell < rise(2 * usual - apart) ? -1 : fell > rise(2 * usual + apart);
}

/* How many times the rays of rung 0 a pixel gets, which has RAD_MOST_SAMPLES at
 * most. */
static int
rays_given(const struct outlook *o, int pixel)
{
    return least(rays_of_pixel(pixel), o->most_rays);
}

/* What that rung leaves of a square of which the first leaves so much. */
static double
left_at(const struct outlook *o, int pixel, double by_first)
{
    return (pixel > 0 ? by_first : 1) / rays_given(o, pixel);
}

/* By how much rays of a picture have grown. */
static double
picture_growth(const struct outlook *o, int pixel)
{
    return (pixel > 0 ? FIRST_TAKES : 1) * rays_given(o, pixel);
}

static struct outlook
look_out(const struct rad_refine_ask *ask)
{
    struct rad_error_squares found = rad_doubt_squares(&ask->sums.doubt);
    struct outlook o = { .ask = ask,
                         .ambient = found.ambient,
                         .pixel = found.sampling,
                         .noise = found.noise,
                         .steeper = observed_steeper(ask, found.ambient),
                         .check = (double)ask->check,
                         .most_rays =
                             RAD_MOST_SAMPLES / (int)fmax(ask->samples, 1) };
    double cache = fmax((double)ask->rays, 1);

    o.walk = fmin(WALKED * (double)ask->pixels, (1 - LEAST_MADE) * cache);
    o.made = cache - o.walk;
    if (ask->sums.shown >= 1)
        o.picture =
            sound(ask->sums.rays / ask->sums.shown) * (double)ask->pixels;
    return o;
}

/* The square of pixels' errors with that rung. */
static double
foresee_pixels(const struct outlook *o, int pixel)
{
    int now = o->ask->rungs.pixel;

    return o->noise * left_at(o, pixel, NOISE_LEFT) /
               left_at(o, now, NOISE_LEFT) +
           (o->pixel - o->noise) * left_at(o, pixel, PIXEL_LEFT) /
               left_at(o, now, PIXEL_LEFT);
}

/* The square of the error with these rungs. */
static double
foresee_square(const struct outlook *o, int ambient, int pixel)
{
    int now = o->ask->rungs.ambient;
    int fallen = parts_between(ambient_fall, now, ambient) +
                 o->steeper * (ambient - now);

    return o->ambient * rise(-fallen) + foresee_pixels(o, pixel);
}

/* Rays of a stage's passes with that rung: -ad of each record, and records by
 * the area that -aa gives them. */
static double
foresee_passes(const struct outlook *o, int ambient)
{
    int now = o->ask->rungs.ambient;

    return o->walk +
           o->made * rise(2 * parts_between(ambacc_fall, now, ambient) +
                          parts_between(ambdiv_growth, now, ambient));
}

/* By how much rays of a check grow with that rung, but those of its pixels. */
static double
check_growth(const struct outlook *o, int ambient)
{
    return rise(parts_between(ambdiv_growth, o->ask->rungs.ambient, ambient));
}

/* Rays of a stage's passes and of its check. */
static double
foresee_stage(const struct outlook *o, int ambient)
{
    return foresee_passes(o, ambient) + o->check * check_growth(o, ambient);
}

/* By how much rays of a picture grow with that rung. */
static double
more_rays(const struct outlook *o, int pixel)
{
    return picture_growth(o, pixel) / picture_growth(o, o->ask->rungs.pixel);
}

/* Seconds of a stage with these rungs.  Its check is looked at more closely
 * than where rays are compared: its windows are sampled as the picture is, but
 * with one ray a pixel, and about half of what is made again are pixels, too;
 * the rest are places of the cache. */
static double
foresee_wait(const struct outlook *o, int ambient, int pixel)
{
    const struct rad_refine_ask *ask = o->ask;
    double windows = fmin(sound(ask->sums.rays), o->check);
    double half = (o->check - windows) / 2;

    return foresee_passes(o, ambient) * ask->pass_s +
           ((windows + half) * more_rays(o, least(pixel, ONE_RAY)) +
            half * check_growth(o, ambient)) *
               ask->look_s;
}

struct choice {
    int ambient, pixel;
    bool ends; /* the pictures are made over the cache that is there */
    double square, rays, seconds; /* with the pictures' */
    double wait;                  /* seconds of the stage */
};

static struct choice
foresee(const struct outlook *o, int ambient, int pixel)
{
    double picture = o->picture * more_rays(o, pixel);
    struct rad_refine_rungs rungs = { (uint8_t)ambient, (uint8_t)pixel };
    struct choice c = { .ambient = ambient,
                        .pixel = pixel,
                        .ends = rad_refine_same_cache(o->ask->rungs, rungs),
                        .square = foresee_square(o, ambient, pixel),
                        .rays = picture,
                        .seconds = picture * PICTURE_PRICE * o->ask->look_s };

    if (!c.ends) {
        c.rays += foresee_stage(o, ambient);
        c.wait = foresee_wait(o, ambient, pixel);
        c.seconds += c.wait;
    }
    return c;
}

/* What a stage and its pictures, or these alone, may take, and a stage. */
struct bounds {
    double rays, seconds, wait;
};
static const struct bounds unbound = { INFINITY, INFINITY, INFINITY };

static bool
has_clock(const struct rad_refine_ask *ask)
{
    return ask->left_s < INFINITY;
}

static struct bounds
bounds_of(const struct rad_refine_ask *ask)
{
    bool known = ask->pass_s > 0 && ask->look_s > 0;
    struct bounds b = unbound;

    if (has_clock(ask))
        b.seconds = known ? TIME_USED * sound(ask->left_s) : 0;
    else
        b.rays = fmax(RAYS_A_PIXEL * (double)ask->pixels, ALWAYS_RAYS);
    return b;
}

/* Squares that are wanted, where a stage is to be made and where none is. */
struct goals {
    double stage, end;
};

/* Less than what is wanted is aimed at by what is foreseen from afar. */
static struct goals
goals_of(const struct rad_refine_ask *ask)
{
    double square = ask->error * ask->error;

    return (struct goals){ AIM * square, square };
}

static bool
is_there(const struct choice *c, struct goals goals)
{
    return c->square <= (c->ends ? goals.end : goals.stage);
}

/* Is a better than b?  Those that come down to the goal before those that do
 * not; of the former the cheaper, of the latter the one with less error. */
static bool
is_better(const struct choice *a, const struct choice *b, struct goals goals)
{
    bool there = is_there(a, goals), other = is_there(b, goals);

    if (there != other)
        return there;
    return there ? a->rays < b->rays : a->square < b->square;
}

/* May c be chosen?  No options are coarser than those of the stage before, and
 * over its cache pixels get no fewer rays than they have; further stages are in
 * steps of so many quarters of a rung, and there is none after the last that a
 * job may have. */
static bool
is_open(const struct rad_refine_ask *ask, const struct choice *c,
        struct bounds within, int step)
{
    int pixel = ask->rungs.pixel;
    bool open = c->ends ? c->pixel >= pixel
                        : ask->stage < RAD_REFINE_STAGES - 1 &&
                              c->pixel >= least(pixel, ONE_RAY) &&
                              c->pixel % step == 0;

    return open && c->rays <= within.rays && c->seconds < within.seconds &&
           c->wait <= within.wait;
}

/* The best rungs within these bounds, those of the cache no higher than that;
 * false: there are none. */
static bool
choose(const struct outlook *o, struct goals goals, struct bounds within,
       int step, int most, struct choice *best)
{
    bool any = false;

    for (int a = o->ask->rungs.ambient; a <= most; a += step)
        for (int p = 0; p <= RAD_REFINE_MOST_PIXEL; p++) {
            struct choice c = foresee(o, a, p);

            if (is_open(o->ask, &c, within, step) &&
                (!any || is_better(&c, best, goals))) {
                *best = c;
                any = true;
            }
        }
    return any;
}

/* The square without any further stage or ray. */
static double
square_now(const struct outlook *o)
{
    return o->ambient + o->pixel;
}

/* The best rungs within these bounds; where none comes down to the goals, the
 * cheapest of those that are a seventh worse than the best at most, and worth
 * it: the last of it may take a hundred times the rays.  With a limit of time
 * it is there to be used. */
static bool
choose_well(const struct outlook *o, struct bounds within, struct choice *best)
{
    struct goals goals = goals_of(o->ask);
    double worth = WORTH_IT * WORTH_IT;
    int most = RAD_REFINE_MOST_AMBIENT, step = RAD_REFINE_RUNG;
    bool any = choose(o, goals, within, step, most, best);

    if (any && is_there(best, goals))
        return true;
    if (has_clock(o->ask)) {
        within.wait = STAGE_TAKES * within.seconds;
        return choose(o, goals, within, 1, most, best);
    }
    if (!any)
        return false;
    goals.end = goals.stage = fmin(best->square / worth, worth * square_now(o));
    return choose(o, goals, within, step, most, best);
}

/* Squares that are near enough to what is wanted. */
static double
near_enough(const struct rad_refine_ask *ask)
{
    return NEAR_ENOUGH * goals_of(ask).end;
}

/* Pictures over the cache that is there which come down to that square. */
static bool
choose_end(const struct outlook *o, struct bounds within, double square,
           struct choice *end)
{
    struct goals goals = { 0, square };

    return choose(o, goals, within, 1, o->ask->rungs.ambient, end) &&
           is_there(end, goals);
}

/* No further stage, if pictures come near enough without for less. */
static void
end_if_near(const struct outlook *o, struct bounds within, struct choice *best)
{
    struct choice end;

    if (!best->ends && choose_end(o, within, near_enough(o->ask), &end) &&
        end.rays <= best->rays)
        *best = end;
}

/* What is near enough takes no further stage: rays of pixels alone, if these
 * bring the rest for less than the stage took. */
static struct choice
come_closer(const struct outlook *o, struct bounds within, struct choice now)
{
    const struct rad_refine_ask *ask = o->ask;
    double most = (double)ask->rays + (double)ask->check;
    struct choice end;

    return choose_end(o, within, goals_of(ask).end, &end) && end.rays <= most
               ? end
               : now;
}

/* Come nearer, if an error that is wanted is too far for one stage, and another
 * may follow. */
static void
shorten_step(const struct outlook *o, struct choice *c)
{
    int now = o->ask->rungs.ambient;
    double rays = foresee_stage(o, c->ambient);

    if (!(o->ask->error > 0) || o->ask->stage + 2 >= RAD_REFINE_STAGES ||
        rays <= FAR * foresee_stage(o, now))
        return;
    while (c->ambient > now + APART &&
           foresee_stage(o, c->ambient) > BEFORE * rays)
        c->ambient -= RAD_REFINE_RUNG;
}

/* Come nearer than what would take all the time, if that is far from the first
 * stage.  Pixels get no more than a ray: how many more rays several take is
 * known.  It stays a stage, of other options than this one. */
static void
try_before(const struct outlook *o, struct choice *c)
{
    const struct rad_refine_ask *ask = o->ask;
    double most = BEFORE_IN_TIME * ask->left_s;
    struct rad_refine_rungs now = ask->rungs;
    int a = c->ambient, p = least(c->pixel, ONE_RAY);

    if (ask->stage > 0 ||
        c->seconds <= FAR_IN_TIME * foresee_wait(o, now.ambient, now.pixel))
        return;
    while (a > now.ambient + 1 && foresee_wait(o, a, p) > most)
        a--;
    while (p > (a == now.ambient) && foresee_wait(o, a, p) > most)
        p--;
    *c = foresee(o, a, p);
}

/* What is best within these bounds: what is there, where nothing else is worth
 * it.  What brings the error that is wanted is, however little that is. */
static struct choice
decide(const struct outlook *o, struct bounds within)
{
    const struct rad_refine_ask *ask = o->ask;
    struct choice now = { .ambient = ask->rungs.ambient,
                          .pixel = ask->rungs.pixel,
                          .ends = true,
                          .square = square_now(o) };
    double worth = has_clock(ask) ? WORTH_ITS_TIME : WORTH_IT;
    struct choice best;

    if (now.square <= near_enough(ask))
        return come_closer(o, within, now);
    if (!choose_well(o, within, &best))
        return now;
    end_if_near(o, within, &best);
    return best.square <= near_enough(ask) ||
                   best.square <= worth * worth * now.square
               ? best
               : now;
}

bool
rad_refine_next(const struct rad_refine_ask *ask, struct rad_refine_rungs *next,
                double *error)
{
    struct outlook o = look_out(ask);
    struct choice best = decide(&o, bounds_of(ask));

    if (!best.ends && has_clock(ask) && !is_there(&best, goals_of(ask)))
        try_before(&o, &best);
    else if (!best.ends)
        shorten_step(&o, &best);
    *error = fmin(sqrt(best.ends ? best.square : square_now(&o)), MOST_ERROR);
    next->ambient = (uint8_t)least(best.ambient, RAD_REFINE_MOST_AMBIENT);
    next->pixel =
        (uint8_t)least(best.pixel, best.ends ? RAD_REFINE_MOST_PIXEL : ONE_RAY);
    return !best.ends;
}

bool
rad_refine_is_short(const struct rad_refine_ask *ask)
{
    struct outlook o = look_out(ask);
    struct choice best = decide(&o, bounds_of(ask));
    struct choice free = decide(&o, unbound);

    return best.ends && best.square > near_enough(ask) &&
           free.square <= WORTH_IT * WORTH_IT * best.square;
}

bool
rad_refine_by_clock(const struct rad_refine_ask *ask)
{
    struct rad_refine_ask ample = *ask;
    struct rad_refine_rungs got, other;
    double error;
    bool on;

    if (!has_clock(ask))
        return false;
    ample.left_s = AMPLE_S;
    ample.pass_s = fmax(ask->pass_s, QUICK_S);
    ample.look_s = fmax(ask->look_s, QUICK_S);
    on = rad_refine_next(ask, &got, &error);
    return rad_refine_next(&ample, &other, &error) != on ||
           other.ambient != got.ambient || other.pixel != got.pixel;
}

struct rad_refine_past
rad_refine_pass_on(const struct rad_refine_ask *ask)
{
    return (struct rad_refine_past){
        ask->rungs.ambient, rad_doubt_squares(&ask->sums.doubt).ambient
    };
}

double
rad_refine_mean(const struct rad_refine_sums *sums)
{
    return rad_doubt_of_mean(&sums->off, sums->doubt.v[RAD_DOUBT_PLACES]);
}
