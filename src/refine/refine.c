/* refine.c - see refine.h
 *
 * The next stage is decided by what the checks of all stages say together: with
 * a rung errors fall, and rays grow, by foreseen factors.  Of all rungs that
 * are foreseen to reach the wanted error the cheapest are taken: rungs of a
 * further stage, or more rays of a pixel over the cache that is there.  Where
 * time allows none of these, the rungs with the least error that time allows
 * are taken, in quarters of a rung. Only basic operations and square roots are
 * used: their results are the same on all machines. */
#include "config.h"

#include "refine/refine.h"

#include <limits.h>
#include <math.h>

/* Tiles of a check pass: one for so many pixels, within these bounds.  A tile
 * renders about LOOKS pixels again (recheck.c), and looks records up in as
 * many.  Where pixels are few, such as sensors, a check renders each again
 * about LOOKS_A_SENSOR times, not more often. */
#define PIXELS_A_TILE 2048
#define LEAST_TILES   36
#define MOST_TILES    96
#define LOOKS         16

#define LOOKS_A_SENSOR 2

/* In pictures of fewer pixels than SMALL each pixel may have hemispheres of its
 * own, and the windows of LEAST_TILES would be 4 to 15 times the picture.
 * So a check of these has a quarter of the tiles, and looks at all areas of its
 * windows: its estimate is as near to the truth, for a third of the rays
 * (doc/measured.md).  With -ps 1, as sensors have it, windows are small. */
#define SMALL       5000
#define SMALL_TILES 4

/* A check of a cache with a smaller -aa than COARSE has more tiles, as the
 * cache has more records, up to TIMES_MOST times as many: its estimate is
 * nearer to the truth, and it takes no greater part of its stage. */
#define COARSE     .25
#define TIMES_MOST 4

/* Factors of the square of the wanted error: a further stage aims at AIM times
 * that square, and NEAR_ENOUGH times that square is near enough, for another
 * stage takes longer than this stage did. */
#define AIM         .85
#define NEAR_ENOUGH 1.2

/* A further stage must lower the error to this part of it, or less: the last
 * seventh is not worth a stage (WORTH_IT).  With a limit of time the time is
 * there to be used (WORTH_ITS_TIME). */
#define WORTH_IT       .85
#define WORTH_ITS_TIME .95

/* A stage that takes more than FAR times the rays of this stage is not foreseen
 * well: a stage with BEFORE times its rays comes before it, and tells how fast
 * the error falls. */
#define FAR    20
#define BEFORE .25

/* Rays of passes that find the places of lattices and paths, for a pixel: they
 * do not grow with rungs.  But at least LEAST_MADE of the rays of passes are
 * taken to grow. */
#define WALKED     .25
#define LEAST_MADE .2

/* The part of the time left that is planned to be used. */
#define TIME_USED .85

/* A ray of a picture takes this part of the time that a ray of a check takes,
 * whose windows are small and far apart: .5 to .9 (doc/measured.md). */
#define PICTURE_PRICE .8

/* The part of the planned time that a last stage takes at most; the rest is for
 * pixels.  Both errors fall with the root of their time at best, so no other
 * split is better than halves by more than a factor of 1.4; and the cache's
 * error may fall more slowly than was foreseen. */
#define STAGE_TAKES .5

/* If the stage that is chosen after the first stage would take, with its
 * pictures, more than FAR_IN_TIME times as long as the first stage, a stage
 * that takes BEFORE_IN_TIME of the time left comes first: the time of a stage
 * is foreseen well only from a stage near it. */
#define FAR_IN_TIME    5
#define BEFORE_IN_TIME .15

/* Without a limit of time, the rays that a stage and its pictures may be
 * foreseen to take: so many for a pixel, or ALWAYS_RAYS, some ten minutes of a
 * processor, where that is more.  A user who would wait longer sets a limit of
 * time. */
#define RAYS_A_PIXEL 1024.
#define ALWAYS_RAYS  8e8

/* Time that is enough for any stage, and the time of a ray where it is not
 * known. */
#define AMPLE_S 1e12
#define QUICK_S 1e-12

/* --- options --- */

/* Parts of an octave: what falls by an eighth of an octave with a rung falls by
 * one part with a quarter of a rung. */
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

/* n, such as a number of rays, times x, cut to the limit.  A number that is 0,
 * or not below the limit, stays. */
static int
grow(int n, double x, int limit)
{
    double to = floor(n * x + .5);

    return n <= 0 || n >= limit ? n : to < limit ? (int)to : limit;
}

/* x to six digits, since options are read in headers; tiny numbers stay as they
 * are. */
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

/* Eighths of an octave by which an option, or the square of an error, changes
 * with a rung of the cache; as many PARTS of an octave with a quarter of a
 * rung.  soon: in the first SOON quarters; later: after these.  -aa and -ar
 * come first: a coarse -ar leaves zones that are too large wherever objects are
 * near, and records that are close together average each other's noise, so many
 * records with few rays are worth more than few records with many rays; but
 * each record needs enough rays to find what is small and bright
 * (doc/measured.md). */
enum { SOON = 4 * RAD_REFINE_RUNG };
struct course {
    int soon, later;
};
static const struct course ambacc_fall = { 2, 1 };
static const struct course ambdiv_growth = { 0, 1 };
static const struct course ambres_growth = { 6, 1 };

/* PARTS of an octave from rung 0 to this rung, in quarters. */
static int
parts_at(struct course c, int ambient)
{
    return ambient <= SOON ? c.soon * ambient
                           : c.soon * SOON + c.later * (ambient - SOON);
}

/* Options of pixels change once, with the first rung of pixels; from then on a
 * pixel gets more rays, which lower the error more for their price. */
enum { SAMPLES_GROWTH = 4, ONE_RAY = RAD_REFINE_RUNG };

/* The largest -ds from the first rung of pixels on.  Still smaller parts of
 * lamps take more rays than samples with -dj that find as much. */
#define SMALL_PART .2

/* With the first rung of pixels, the factor of -dt and of 1 less -dc, and the
 * factor of -pt. */
#define SHADOWS_LEFT .25
#define MAXDIFF_LEFT .5

#define MOST_AMBDIV 65536
#define MOST_AMBRES 1024 /* for a cube as large as what is shown */

static int
most_ambres(const struct rad_params *job)
{
    return (int)fmin(MOST_AMBRES * fmax(job->surroundings, 1), INT_MAX);
}

/* The rays of a pixel over its rays at rung 0, as a whole number: 1 up to a
 * rung above ONE_RAY. */
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
                           most_ambres(job));
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

/* Is a at least as fine as b?  Of -ds, 0 leaves a source whole and is coarsest;
 * of -ar, 0 sets no limit and is finest. */
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

bool
rad_refine_is_small(const struct rad_params *par, uint64_t pixels)
{
    return pixels < SMALL && par->psample > 1;
}

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
    if (rad_refine_is_small(par, pixels))
        n /= SMALL_TILES;
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

/* Eighths of an octave by which the square of the cache's error falls with a
 * rung, in five scenes on average.  In single scenes it falls by an eighth more
 * or less: after DOUBTFUL quarters of a rung that is as uncertain as a check is
 * by chance. */
static const struct course ambient_fall = { 6, 3 };
#define DOUBTFUL (6. * RAD_REFINE_RUNG)

/* A stage that comes before another is more than so many quarters from this
 * one (shorten_step). */
enum { APART = 3 * RAD_REFINE_RUNG };

/* The first rung of pixels leaves NOISE_LEFT of the square of the noise and
 * PIXEL_LEFT of the rest of the square of pixels' error.  (Noise of lamps
 * falls; noise of edges and of gloss that few pixels show stays.)  It takes
 * FIRST_TAKES times the rays. */
#define PIXEL_LEFT  .5
#define NOISE_LEFT  .7
#define FIRST_TAKES 1.4

/* What is known after a stage. */
struct outlook {
    const struct rad_refine_ask *ask;
    double ambient, pixel, noise; /* squares of errors; `noise` is a part of
                                   * `pixel` */
    double walk, made; /* rays of passes: those of WALKED, and the others */
    double check, picture; /* rays of a check, and of all pictures */
    int most_rays;         /* most rays of a pixel, over its rays at rung 0 */
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

/* The part of a square that is left with that rung of a stage, if the first
 * rung leaves by_first. */
static double
left_by_first(int pixel, double by_first)
{
    return pixel > 0 ? by_first : 1;
}

static double
mix(double a, double b, double part_of_b)
{
    return a + part_of_b * (b - a);
}

/* A check looks at so few areas and places that what it says is often twice too
 * much or too little, so those of former stages count, too, each by its places.
 * Of pixels they say the same whatever the cache is.  Of the cache each says
 * what is foreseen from it, and counts less for that the farther it is. */
static struct rad_refine_known
pool(const struct rad_refine_ask *ask)
{
    const struct rad_refine_known *past = &ask->past;
    const struct rad_doubt *doubt = &ask->sums.doubt;
    struct rad_error_squares now = rad_doubt_squares(doubt);
    int from = past->rungs.pixel, to = ask->rungs.pixel;
    double away = (ask->rungs.ambient - past->rungs.ambient) / DOUBTFUL;
    int fallen =
        parts_between(ambient_fall, past->rungs.ambient, ask->rungs.ambient);
    double places = fmax(rad_doubt_sound(doubt->v[RAD_DOUBT_PLACES]), 1);
    double part = places / (places + past->places);
    struct rad_refine_known k = { ask->rungs, 0, 0, 0, places + past->places };

    k.ambient = mix(past->ambient * rise(-fallen), now.ambient,
                    places / (places + past->places / (1 + away * away)));
    k.noise = mix(past->noise * left_by_first(to, NOISE_LEFT) /
                      left_by_first(from, NOISE_LEFT),
                  now.noise, part);
    k.pixel = k.noise +
              mix((past->pixel - past->noise) * left_by_first(to, PIXEL_LEFT) /
                      left_by_first(from, PIXEL_LEFT),
                  now.sampling - now.noise, part);
    return k;
}

/* The rays of a pixel with that rung over its rays at rung 0: at most so many
 * that a pixel has RAD_MOST_SAMPLES. */
static int
rays_given(const struct outlook *o, int pixel)
{
    return least(rays_of_pixel(pixel), o->most_rays);
}

/* The part of a square that is left with that rung, if the first rung leaves
 * by_first. */
static double
left_at(const struct outlook *o, int pixel, double by_first)
{
    return left_by_first(pixel, by_first) / rays_given(o, pixel);
}

/* The rays of a picture with that rung, over its rays at rung 0. */
static double
picture_growth(const struct outlook *o, int pixel)
{
    return (pixel > 0 ? FIRST_TAKES : 1) * rays_given(o, pixel);
}

static struct outlook
look_out(const struct rad_refine_ask *ask)
{
    struct rad_refine_known known = pool(ask);
    struct outlook o = { .ask = ask,
                         .ambient = known.ambient,
                         .pixel = known.pixel,
                         .noise = known.noise,
                         .check = (double)ask->check,
                         .most_rays =
                             RAD_MOST_SAMPLES / (int)fmax(ask->samples, 1) };
    double cache = fmax((double)ask->rays, 1);

    o.walk = fmin(WALKED * (double)ask->pixels, (1 - LEAST_MADE) * cache);
    o.made = cache - o.walk;
    if (ask->sums.shown >= 1)
        o.picture = rad_doubt_sound(ask->sums.rays / ask->sums.shown) *
                    (double)ask->pixels;
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

    return o->ambient * rise(-parts_between(ambient_fall, now, ambient)) +
           foresee_pixels(o, pixel);
}

/* Rays of a stage's passes with that rung: each record takes the rays of -ad,
 * and the number of records goes by the area that -aa gives a record. */
static double
foresee_passes(const struct outlook *o, int ambient)
{
    int now = o->ask->rungs.ambient;

    return o->walk +
           o->made * rise(2 * parts_between(ambacc_fall, now, ambient) +
                          parts_between(ambdiv_growth, now, ambient));
}

/* The factor by which the rays of a check grow with that rung, except those of
 * its pixels. */
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

/* The factor by which the rays of a picture grow from the present rung to that
 * rung. */
static double
more_rays(const struct outlook *o, int pixel)
{
    return picture_growth(o, pixel) / picture_growth(o, o->ask->rungs.pixel);
}

/* Seconds of a stage with these rungs.  Its check is foreseen more closely than
 * by foresee_stage(): its windows are sampled as the picture is, but with the
 * rays that a pixel has at rung 0; of its other rays about half make pixels
 * again, and the rest are for places of the cache. */
static double
foresee_wait(const struct outlook *o, int ambient, int pixel)
{
    const struct rad_refine_ask *ask = o->ask;
    double windows = fmin(rad_doubt_sound(ask->sums.rays), o->check);
    double half = (o->check - windows) / 2;

    return foresee_passes(o, ambient) * ask->pass_s +
           ((windows + half) * more_rays(o, least(pixel, ONE_RAY)) +
            half * check_growth(o, ambient)) *
               ask->look_s;
}

struct choice {
    int ambient, pixel;
    bool ends; /* the pictures are made over the cache that is there */
    double square, rays, seconds; /* square of the error; rays and seconds of
                                   * the stage, if any, and of the pictures */
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

/* Limits of the rays and seconds of a stage, if any, and its pictures together;
 * and of the seconds of the stage (wait). */
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
        b.seconds = known ? TIME_USED * rad_doubt_sound(ask->left_s) : 0;
    else
        b.rays = fmax(RAYS_A_PIXEL * (double)ask->pixels, ALWAYS_RAYS);
    return b;
}

/* Wanted squares of the error: with a further stage, and without. */
struct goals {
    double stage, end;
};

/* A further stage aims at less than the wanted error, since its error is
 * foreseen from afar. */
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

/* Is a better than b?  A choice that reaches the goal is better than a choice
 * that does not.  Of two that reach it the cheaper is better, of two that do
 * not the choice with less error. */
static bool
is_better(const struct choice *a, const struct choice *b, struct goals goals)
{
    bool there = is_there(a, goals), other = is_there(b, goals);

    if (there != other)
        return there;
    return there ? a->rays < b->rays : a->square < b->square;
}

/* May c be chosen?  Its options must not be coarser than the options of the
 * last stage; over that stage's cache pixels must get no fewer rays than they
 * have.  A further stage is in steps of `step` quarters of a rung, and the job
 * must not have had its last stage. */
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

/* Set *best to the best rungs within these bounds, the cache's rungs at most
 * `most`; false: there are none. */
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

/* The square of the error of pictures that are made now, without more rays. */
static double
square_now(const struct outlook *o)
{
    return o->ambient + o->pixel;
}

/* Set *best to the best rungs within these bounds; false: there are none.  If
 * no rungs reach the goals: without a limit of time the cheapest rungs that are
 * worth it and whose error is at most 1 / WORTH_IT times the least, since the
 * rest of the gain may take a hundred times the rays; with a limit of time,
 * which is there to be used, the rungs with the least error, in quarters. */
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

/* The largest square of the error that is near enough to the wanted error. */
static double
near_enough(const struct rad_refine_ask *ask)
{
    return NEAR_ENOUGH * goals_of(ask).end;
}

/* Set *end to the best pictures over the cache that is there; false: they do
 * not come down to `square`. */
static bool
choose_end(const struct outlook *o, struct bounds within, double square,
           struct choice *end)
{
    struct goals goals = { 0, square };

    return choose(o, goals, within, 1, o->ask->rungs.ambient, end) &&
           is_there(end, goals);
}

/* Replace a further stage by pictures over the cache that is there, if these
 * come near enough for no more rays. */
static void
end_if_near(const struct outlook *o, struct bounds within, struct choice *best)
{
    struct choice end;

    if (!best->ends && choose_end(o, within, near_enough(o->ask), &end) &&
        end.rays <= best->rays)
        *best = end;
}

/* The choice where the error is near enough: no further stage, but more rays of
 * pixels, if these reach the wanted error for no more rays than the stage took.
 */
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

/* If the wanted error is too far for one stage (FAR), and another stage may
 * follow, make the next stage less fine. */
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

/* If *c takes far longer than the first stage took (FAR_IN_TIME), make it a
 * shorter stage (BEFORE_IN_TIME) that comes before.  Its pixels get no more
 * rays than at rung 0: the cost of more rays is known.  Its options differ from
 * those of the first stage. */
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

/* The best choice within these bounds: pictures over the cache that is there,
 * if nothing else is worth it.  A choice that comes near enough to the wanted
 * error is worth it always. */
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
    *error =
        fmin(sqrt(best.ends ? best.square : square_now(&o)), RAD_DOUBT_MOST);
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

struct rad_refine_known
rad_refine_pass_on(const struct rad_refine_ask *ask)
{
    return pool(ask);
}

double
rad_refine_mean(const struct rad_refine_sums *sums)
{
    return rad_doubt_of_mean(&sums->off, sums->doubt.v[RAD_DOUBT_PLACES]);
}
