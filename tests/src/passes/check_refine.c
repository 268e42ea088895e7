/* check_refine.c - stages of a job that goes on until its picture is good
 * enough */
#include "config.h"

#include "machine/jobtext.h"
#include "refine/refine.h"

#include "tests/world.h"

#include <math.h>
#include <stdlib.h>

/* --- options --- */

static struct rad_params
params_of(const char *options)
{
    struct world w;

    memset(&w, 0, sizeof w);
    rad_params_init(&w.params);
    world_options(&w, options);
    return w.params;
}

static const char *const jobs[] = {
    "-ab 4 -aa .5 -ar 16 -ad 64 -as 16 -pt .15 -ds .4 -dt .1 -dc .5 -st .1",
    "-ab 2 -aa .1 -ar 0 -ad 1 -as 0 -pt 0 -ds 0 -dt 0 -dc 1 -st 0 -lw 0",
    "-ab 1 -aa 9 -ar 2147483647 -ad 16777216 -as 16777216 -pt 1e9 -ds 1e9",
    "-ab 1 -aa 1e-300 -ad 65535 -pt 1e-300 -ds 1e-300 -lw 1e-300",
};

LOOP_TEST(the_job_s_own_options_are_rung_0, N_ELEM(jobs))
{
    struct rad_params job = params_of(jobs[_i]), out;
    char a[RAD_PARAMS_TEXT], b[RAD_PARAMS_TEXT];

    rad_refine_params(&job, (struct rad_refine_rungs){ 0, 0 }, &out);
    rad_params_format(&job, a, sizeof a);
    rad_params_format(&out, b, sizeof b);
    ck_assert_str_eq(a, b);
}

static void
assert_finer(const struct rad_params *a, const struct rad_params *b)
{
    ck_assert_double_le(b->ambacc, a->ambacc);
    ck_assert_int_ge(b->ambdiv, a->ambdiv);
    ck_assert_int_ge(b->ambssamp, a->ambssamp);
    ck_assert_int_ge(b->ambres, a->ambres);
    ck_assert_int_ge(b->samples, a->samples);
    ck_assert_double_le(b->maxdiff, a->maxdiff);
    ck_assert_double_le(b->srcsizerat, a->srcsizerat);
    ck_assert_double_ge(b->srcjitter, a->srcjitter);
    ck_assert_double_le(b->shadthresh, a->shadthresh);
    ck_assert_double_le(b->specthresh, a->specthresh);
    ck_assert_double_ge(b->shadcert, a->shadcert);
    ck_assert_double_le(b->shadcert, 1);
    ck_assert_double_gt(b->ambacc, 0);
}

/* What comes out can be said in words, and is what these words say. */
static void
assert_sayable(const struct rad_params *p)
{
    char text[RAD_PARAMS_TEXT], again[RAD_PARAMS_TEXT];
    struct rad_params read;

    rad_params_format(p, text, sizeof text);
    ck_assert_int_eq(jobtext_params(text, &read, NULL), 0);
    ck_assert_int_eq(rad_params_check(&read, NULL), 0);
    rad_params_format(&read, again, sizeof again);
    ck_assert_str_eq(text, again);
}

LOOP_TEST(each_rung_is_finer, N_ELEM(jobs))
{
    struct rad_params job = params_of(jobs[_i]), last = job, p;

    for (int n = 0; n <= 255; n++) {
        struct rad_refine_rungs r = { (uint8_t)n, (uint8_t)n };

        rad_refine_params(&job, r, &p);
        assert_finer(&last, &p);
        assert_sayable(&p);
        ck_assert_int_eq(p.psample, job.psample);
        ck_assert_int_eq(p.ambounce, job.ambounce);
        last = p;
    }
}

/* Kept jobs go on with the options that their rungs had: who changes these
 * changes LAYOUT (daemon/filling/stages.c), too. */
static const struct {
    double rung;
    const char *aa;
    int ad, as, ar;
} rungs[] = {
    { 1, ".420448", 64, 16, 27 },     { 4, ".25", 64, 16, 128 },
    { 4.25, ".244643", 65, 16, 131 }, { 8, ".176777", 91, 23, 181 },
    { 16, ".0883883", 181, 45, 362 }, { 32, ".0220971", 724, 181, 1024 },
};

LOOP_TEST(rungs_keep_their_meaning, N_ELEM(rungs))
{
    struct rad_params job = params_of(jobs[0]), p;
    uint8_t rung = (uint8_t)(RAD_REFINE_RUNG * rungs[_i].rung);

    rad_refine_params(&job, (struct rad_refine_rungs){ rung, 0 }, &p);
    ck_assert_double_eq(p.ambacc, atof(rungs[_i].aa));
    ck_assert_int_eq(p.ambdiv, rungs[_i].ad);
    ck_assert_int_eq(p.ambssamp, rungs[_i].as);
    ck_assert_int_eq(p.ambres, rungs[_i].ar);
    ck_assert_double_eq(p.srcsizerat, job.srcsizerat);
    ck_assert_int_eq(p.samples, 1);
}

/* -ar grows by as much where the scene is far larger than what is shown. */
TEST(surroundings_leave_rungs_alone)
{
    struct rad_params room = params_of(jobs[0]), site = room, p, q;
    struct rad_refine_rungs far = { 32 * RAD_REFINE_RUNG, 0 };

    site.surroundings = 256;
    site.ambres = 256 * room.ambres;
    rad_refine_params(&room, far, &p);
    rad_refine_params(&site, far, &q);
    ck_assert_int_eq(q.ambres, 256 * p.ambres);
}

static const struct {
    int rung; /* in quarters */
    int samples;
} pixel_rungs[] = { { 1, 1 }, { 4, 1 },  { 8, 1 },
                    { 9, 2 }, { 16, 3 }, { 52, 64 } };

/* ... and so for those of pixels: light changes with the first, once. */
LOOP_TEST(rungs_of_pixels_keep_their_meaning, N_ELEM(pixel_rungs))
{
    struct rad_params job = params_of(jobs[0]), p;
    uint8_t rung = (uint8_t)pixel_rungs[_i].rung;

    rad_refine_params(&job, (struct rad_refine_rungs){ 0, rung }, &p);
    ck_assert_int_eq(p.samples, pixel_rungs[_i].samples);
    ck_assert_double_eq(p.maxdiff, .075);
    ck_assert_double_eq(p.srcsizerat, .2);
    ck_assert_double_eq(p.srcjitter, 1);
    ck_assert_double_eq(p.shadthresh, .025);
    ck_assert_double_eq(p.shadcert, .875);
    ck_assert_double_eq(p.specthresh, 0);
    ck_assert_double_eq(p.ambacc, job.ambacc);
    ck_assert_int_eq(p.ambdiv, job.ambdiv);
}

/* A job begins where another ended, if that is as fine in all that rungs change
 * of records; what they do not change is its own. */
static const struct {
    const char *own, *former;
    bool joins;
} joined[] = {
    { "-aa .2 -ad 64", "-aa .2 -ad 64", true },
    { "-aa .2", "-aa .1", true },
    { "-aa .1", "-aa .2", false },
    { "-ad 64", "-ad 65", true },
    { "-ad 65", "-ad 64", false },
    { "-as 8", "-as 7", false },
    { "-ar 16", "-ar 32", true },
    { "-ar 16", "-ar 0", true }, /* no limit */
    { "-ar 0", "-ar 4096", false },
    { "-ds .4", "-ds .1", true },
    { "-ds .4", "-ds 0", false }, /* no parts */
    { "-dt .1", "-dt .2", false },
    { "-dc .5", "-dc .4", false },
    { "-st 0", "-st .1", false },
};

LOOP_TEST(what_is_as_fine_is_joined, N_ELEM(joined))
{
    struct rad_params own = params_of(joined[_i].own), is = own;
    struct rad_params former = params_of(joined[_i].former);
    char a[RAD_PARAMS_TEXT], b[RAD_PARAMS_TEXT];

    former.psample = own.psample + 1;
    former.maxdiff = own.maxdiff + 1;
    ck_assert_int_eq(rad_refine_join(&is, &former), joined[_i].joins);
    former.psample = own.psample;
    former.maxdiff = own.maxdiff;
    rad_params_format(joined[_i].joins ? &former : &own, a, sizeof a);
    rad_params_format(&is, b, sizeof b);
    ck_assert_str_eq(a, b);
}

TEST(the_check_pass_is_the_last)
{
    struct rad_params job = params_of(jobs[0]);
    struct rad_pass_size size[2] = { { 1920, 1080 }, { 5, 3 } };
    struct rad_pass own[RAD_MOST_PASSES], pass[RAD_MOST_PASSES];
    uint32_t n = rad_passes_plan(&job, size, 2, own);

    ck_assert_uint_eq(rad_refine_plan(&job, size, 2, false, true, pass), n + 1);
    for (uint32_t i = 0; i < n; i++)
        ck_assert(!pass[i].check && pass[i].tiles == own[i].tiles);
    ck_assert(pass[n].check && pass[n].tiles > 0);
    job.ambounce = 0;
    ck_assert_uint_eq(rad_refine_plan(&job, size, 2, false, true, pass), 0);
}

/* Tiles of the check of a cache with that -aa, and a picture of that size. */
static uint32_t
tiles_of_check(double ambacc, int width, int height)
{
    struct rad_pass pass[RAD_MOST_PASSES];
    struct rad_pass_size size = { width, height };
    struct rad_params job = params_of(jobs[0]);
    uint32_t n;

    job.ambacc = ambacc;
    n = rad_refine_plan(&job, &size, 1, false, true, pass);
    ck_assert_uint_gt(n, 0);
    return pass[n - 1].tiles;
}

TEST(a_check_of_more_records_has_more_tiles)
{
    uint32_t coarse = tiles_of_check(.5, 960, 640);

    ck_assert_uint_eq(tiles_of_check(.25, 960, 640), coarse);
    ck_assert_uint_eq(tiles_of_check(.15, 960, 640), 2 * coarse);
    ck_assert_uint_eq(tiles_of_check(.1, 960, 640), 4 * coarse);
    ck_assert_uint_eq(tiles_of_check(1e-300, 960, 640), 4 * coarse);
}

/* Not 36 tiles of 18 pixels each, whose hemispheres are all made anew. */
TEST(a_check_of_few_sensors_is_small)
{
    ck_assert_uint_eq(tiles_of_check(.2, 1, 1), 1);
    ck_assert_uint_eq(tiles_of_check(.1, 24, 1), 3);
    ck_assert_uint_eq(tiles_of_check(.5, 96, 96), tiles_of_check(.5, 120, 90));
}

/* Not windows of several times the picture; from 5000 pixels on as always. */
TEST(a_check_of_a_small_picture_is_small)
{
    struct rad_params sensors = params_of("-ps 1");
    uint32_t usual = tiles_of_check(.5, 300, 200);

    ck_assert_uint_eq(4 * tiles_of_check(.5, 40, 30), usual);
    ck_assert_uint_eq(4 * tiles_of_check(.5, 80, 62), usual);
    ck_assert_uint_eq(tiles_of_check(.5, 100, 50), usual);
    ck_assert_uint_eq(tiles_of_check(.1, 40, 30), usual);
    ck_assert(!rad_refine_is_small(&sensors, 1));
}

/* --- decisions --- */

#define RUNGS(n) (RAD_REFINE_RUNG * (n))

/* After a stage with these errors, of ambient light, pixels, and noise. */
static struct rad_refine_ask
ask_of(double error, double ambient, double pixel, double noise)
{
    struct rad_refine_ask ask = {
        .error = error, .rays = 1000000, .pixels = 100000, .left_s = INFINITY
    };
    double *v = ask.sums.doubt.v;

    v[RAD_DOUBT_PLACES] = v[RAD_DOUBT_AREAS] = 100;
    v[RAD_DOUBT_AMBIENT] = v[RAD_DOUBT_SAID] = 100 * ambient * ambient;
    /* PIXELS of picture/doubt.c */
    v[RAD_DOUBT_PIXEL] = 100 * pixel * pixel / 1.3;
    v[RAD_DOUBT_NOISE] = 100 * noise * noise / 1.3;
    ask.sums.shown = 1000;
    ask.sums.rays = 3000;
    ask.check = 100000;
    return ask;
}

TEST(what_is_good_enough_ends)
{
    struct rad_refine_ask ask = ask_of(.1, .05, .05, .02);
    struct rad_refine_rungs next = { 77, 77 };
    double error;

    ask.rungs = (struct rad_refine_rungs){ RUNGS(3), RUNGS(1) };

    ck_assert(!rad_refine_next(&ask, &next, &error));
    ck_assert_double_gt(error, .06);
    ck_assert_double_lt(error, .09);
    ck_assert_int_eq(next.ambient, RUNGS(3));
    ck_assert_int_eq(next.pixel, RUNGS(1));
}

/* So much time is left, and a million rays take a second. */
static void
set_clock(struct rad_refine_ask *ask, double left_s)
{
    ask->left_s = left_s;
    ask->pass_s = ask->look_s = 1e-6;
}

static const struct {
    double ambient, pixel;
} causes[] = { { .3, .01 }, { .01, .3 }, { .2, .2 } };

/* The less is wanted, the higher the rungs of what is the cause: those of the
 * cache in the next stage, those of pixels at its end. */
LOOP_TEST(rungs_go_by_the_cause, N_ELEM(causes))
{
    struct rad_refine_rungs last = { 0, 0 }, next, end;
    double error;

    for (double wanted = .16; wanted > .03; wanted /= 2) {
        struct rad_refine_ask ask =
            ask_of(wanted, causes[_i].ambient, causes[_i].pixel, 0);

        set_clock(&ask, 1e12);
        ask.stage = RAD_REFINE_STAGES - 2; /* none is to come between */
        ck_assert(rad_refine_next(&ask, &next, &error));
        ck_assert_int_ge(next.ambient, last.ambient);
        ck_assert_int_le(next.pixel, RUNGS(1));
        ask = ask_of(wanted, .01, causes[_i].pixel, 0);
        ask.stage = RAD_REFINE_STAGES - 1;
        ask.rungs = next;
        ck_assert(!rad_refine_next(&ask, &end, &error));
        ck_assert_int_eq(end.ambient, next.ambient);
        ck_assert_int_ge(end.pixel, last.pixel);
        ck_assert_double_le(error, 1.1 * wanted);
        last = end;
    }
    ck_assert_int_eq(last.ambient > RUNGS(8), causes[_i].ambient > .1);
    ck_assert_int_eq(last.pixel > RUNGS(8), causes[_i].pixel > .1);
}

/* Pixels that stay noisy: after some rungs there is no more. */
TEST(what_cannot_be_reached_ends)
{
    struct rad_refine_ask ask = ask_of(.001, .1, .1, .1);
    struct rad_refine_rungs next;
    double error;

    ck_assert(rad_refine_next(&ask, &next, &error));
    ck_assert_int_lt(next.ambient, RAD_REFINE_MOST_AMBIENT / 2);
    ask = ask_of(.001, .05, .1, .1);
    ask.rungs = (struct rad_refine_rungs){ RUNGS(4), RAD_REFINE_MOST_PIXEL };
    ck_assert(!rad_refine_next(&ask, &next, &error));
    ck_assert_double_gt(error, .1);
}

/* A picture of few pixels, of whose error the cache is a small part: the bound
 * allows it minutes of a processor. */
TEST(what_cannot_be_reached_costs_no_more_than_it_brings)
{
    struct rad_refine_ask ask = ask_of(.015, .036, .21, .106);
    struct rad_refine_rungs next;
    double error;

    ask.pixels = 9;
    ask.rays = ask.check = 15000;
    ck_assert(rad_refine_next(&ask, &next, &error));
    ck_assert_int_eq(next.pixel, RUNGS(1));
    ck_assert_int_lt(next.ambient, RUNGS(10));
    ask.rungs = next;
    ask.stage = RAD_REFINE_STAGES - 1;
    ck_assert(!rad_refine_next(&ask, &next, &error));
    ck_assert_int_gt(next.pixel, RUNGS(10));
}

TEST(stages_are_few)
{
    struct rad_refine_ask ask = ask_of(.01, .5, .5, 0);
    struct rad_refine_rungs next;
    double error;

    ask.stage = RAD_REFINE_STAGES - 2;
    ck_assert(rad_refine_next(&ask, &next, &error));
    ask.stage++;
    ck_assert(!rad_refine_next(&ask, &next, &error));
    ask.stage = UINT32_MAX;
    ck_assert(!rad_refine_next(&ask, &next, &error));
}

/* A cache that is all but good enough: pixels get more rays for which a stage
 * would take as many, since pictures over the cache that is there come near
 * enough. */
TEST(what_comes_near_enough_without_a_stage_has_none)
{
    struct rad_refine_ask ask = ask_of(.0235, .0236, .017, .013);
    struct rad_refine_rungs next;
    double error;

    ask.stage = 1;
    ask.rungs = (struct rad_refine_rungs){ RUNGS(3), RUNGS(1) };
    ck_assert(!rad_refine_next(&ask, &next, &error));
    ck_assert_int_eq(next.ambient, RUNGS(3));
    ck_assert_int_gt(next.pixel, RUNGS(1));
    ck_assert_double_gt(error, .0235);
    ck_assert_double_lt(error, .0235 * 1.1);
}

/* What is far off is not foreseen well: some of it is made first, unless there
 * is no further stage. */
TEST(a_far_goal_has_a_stage_before_it)
{
    struct rad_refine_ask ask = ask_of(.02, .5, .01, 0);
    struct rad_refine_rungs first, whole;
    double error;

    ck_assert(rad_refine_next(&ask, &first, &error));
    ask.stage = RAD_REFINE_STAGES - 2;
    ck_assert(rad_refine_next(&ask, &whole, &error));
    ck_assert_int_gt(first.ambient, RUNGS(3));
    ck_assert_int_lt(first.ambient, whole.ambient);
    ask = ask_of(.3, .5, .01, 0);
    ck_assert(rad_refine_next(&ask, &first, &error));
    ask.stage = RAD_REFINE_STAGES - 2;
    ck_assert(rad_refine_next(&ask, &whole, &error));
    ck_assert_int_eq(first.ambient, whole.ambient);
}

/* After a stage three rungs on that has these errors. */
static struct rad_refine_ask
ask_after(const struct rad_refine_ask *first, double ambient, double pixel)
{
    struct rad_refine_ask ask = ask_of(first->error, ambient, pixel, 0);

    ask.stage = first->stage + 1;
    ask.rungs.ambient = first->rungs.ambient + RUNGS(3);
    ask.rungs.pixel = first->rungs.pixel;
    ask.past = rad_refine_pass_on(first);
    return ask;
}

/* A check by chance: a stage that seems no better than the one before is
 * followed by a stage that takes the rays of one or two rungs more than without
 * this chance, not of a dozen. */
TEST(one_check_does_not_decide_alone)
{
    struct rad_refine_ask first = ask_of(.05, .12, .01, 0);
    struct rad_refine_ask as_foreseen = ask_after(&first, .055, .01);
    struct rad_refine_ask worse = ask_after(&first, .12, .01);
    struct rad_refine_rungs next, far;
    double error, seems;

    ck_assert(rad_refine_next(&as_foreseen, &next, &error));
    ck_assert(rad_refine_next(&worse, &far, &seems));
    ck_assert_int_gt(far.ambient, next.ambient);
    ck_assert_double_gt(seems, 1.3 * error);
    ck_assert_double_lt(seems, .1);
    worse.past.places = 0;
    ck_assert(rad_refine_next(&worse, &next, &error));
    ck_assert_double_gt(error, .12);
    ck_assert_int_lt(far.ambient, next.ambient);
}

/* ... of pixels' error the stages say the same, whatever their caches are. */
TEST(stages_tell_of_pixels_together)
{
    static const double found[] = { .02, .04, .06 };
    struct rad_refine_ask ask = ask_of(.01, .001, found[0], 0);
    double sum = found[0] * found[0], error;
    struct rad_refine_known known;
    struct rad_refine_rungs next;

    ask.rungs.pixel = RUNGS(1);
    for (int i = 1; i < N_ELEM(found); i++) {
        ask = ask_after(&ask, .001, found[i]);
        sum += found[i] * found[i];
        known = rad_refine_pass_on(&ask);
        ck_assert_double_eq_tol(known.pixel, sum / (i + 1), 1e-9);
    }
    ask.stage = RAD_REFINE_STAGES - 1;
    ck_assert(!rad_refine_next(&ask, &next, &error));
    ck_assert_int_gt(next.pixel, RUNGS(1));
}

/* With the first rung of pixels there is less, and a check counts by the number
 * of its places; of the cache the less the more rungs lie between. */
TEST(former_checks_count_by_what_they_tell)
{
    struct rad_refine_ask first = ask_of(.01, .1, .02, .01), ask;
    struct rad_refine_known known;

    ask = ask_after(&first, .1, .02);
    ask.rungs.pixel = RUNGS(1);
    known = rad_refine_pass_on(&ask);
    ck_assert_double_lt(known.pixel, .0004);
    ck_assert_double_gt(known.pixel, .0003);
    for (int i = RAD_DOUBT_PLACES; i < RAD_DOUBT_SUMS; i++)
        ask.sums.doubt.v[i] *= 1000;
    known = rad_refine_pass_on(&ask);
    ck_assert_double_eq_tol(known.pixel, .0004, 1e-6);
    ask = ask_after(&first, .1, .02);
    known = rad_refine_pass_on(&ask);
    first.rungs.ambient = RUNGS(20);
    ask = ask_after(&first, .1, .02);
    ask.rungs.ambient = RUNGS(60);
    ck_assert_double_lt(known.ambient, .7 * .01);
    ck_assert_double_gt(rad_refine_pass_on(&ask).ambient, .97 * .01);
}

/* A finer cache takes more rays, but for those that find where paths go: the
 * more of a stage's rays did that, the farther goes the next in the same time.
 */
TEST(finding_paths_is_no_part_of_what_grows)
{
    struct rad_refine_ask ask = ask_of(.001, .3, .01, 0);
    struct rad_refine_rungs few, many;
    double error;

    set_clock(&ask, 20);
    ask.sums.rays = ask.check = 1; /* so that pictures cost next to nothing */
    ask.pixels = 1;
    ck_assert(rad_refine_next(&ask, &few, &error));
    ask.pixels = 1000000;
    ck_assert(rad_refine_next(&ask, &many, &error));
    ck_assert_int_gt(many.ambient, few.ambient);
}

/* ... when the last cache is there: no stage has more than a ray of a pixel. */
TEST(noise_of_pixels_is_taken_away_by_rays)
{
    struct rad_params job = params_of(jobs[0]), p;
    struct rad_refine_ask ask = ask_of(.05, .04, .1, .1);
    struct rad_refine_rungs next;
    double error;

    ck_assert(rad_refine_next(&ask, &next, &error));
    rad_refine_params(&job, next, &p);
    ck_assert_int_eq(p.samples, 1);
    ask = ask_of(.05, .04, .1, .1);
    ask.rungs = next;
    ck_assert(!rad_refine_next(&ask, &next, &error));
    ck_assert(rad_refine_same_cache(ask.rungs, next));
    ck_assert_double_le(error, .05);
    rad_refine_params(&job, next, &p);
    ck_assert_int_ge(p.samples, 10); /* squares: .01 / (.0025 - .0016) */
    ck_assert_int_le(p.samples, 13);
    rad_refine_params(&job, (struct rad_refine_rungs){ 0, RUNGS(4) }, &p);
    ck_assert_int_eq(p.samples, 3); /* 2 to the power of 1.5, rounded */
    job.samples = 16; /* they get as many times more, as is foreseen */
    next.pixel = RAD_REFINE_MOST_PIXEL;
    rad_refine_params(&job, next, &p);
    ck_assert_int_eq(p.samples, 16 * 64);
    ask = ask_of(.05, .02, .05, .05); /* near enough */
    ck_assert(!rad_refine_next(&ask, &next, &error));
}

/* A pixel has a most number of rays: what is beyond is not counted upon. */
TEST(a_full_pixel_gets_no_better)
{
    struct rad_refine_ask ask = ask_of(.02, .015, .1, .1);
    struct rad_refine_rungs next;
    double error;

    ask.rungs = (struct rad_refine_rungs){ RUNGS(8), RUNGS(1) };
    set_clock(&ask, 1e12);
    ask.stage = RAD_REFINE_STAGES - 1;
    ck_assert(!rad_refine_next(&ask, &next, &error));
    ck_assert_double_le(error, .022);
    ask.samples = RAD_MOST_SAMPLES / 4;
    ck_assert(!rad_refine_next(&ask, &next, &error));
    ck_assert_double_gt(error, .05); /* a quarter of the square */
    ask.samples = RAD_MOST_SAMPLES;
    ck_assert(!rad_refine_next(&ask, &next, &error));
    ck_assert_double_gt(error, .1);
}

/* The rest of an error that is nearly small enough is taken away by rays of
 * pixels, as long as they cost no more than the stage did. */
TEST(what_is_near_enough_comes_closer_if_that_is_cheap)
{
    struct rad_refine_ask ask = ask_of(.08, .07, .043, .04);
    struct rad_refine_rungs next;
    double error;

    ask.stage = 1;
    ask.rungs = (struct rad_refine_rungs){ RUNGS(8), RUNGS(1) };
    ck_assert(!rad_refine_next(&ask, &next, &error));
    ck_assert_int_gt(next.pixel, RUNGS(2));
    ck_assert_double_le(error, .08);
    ask.rays = ask.check = 100; /* ... of so cheap a stage it is not */
    ck_assert(!rad_refine_next(&ask, &next, &error));
    ck_assert_int_eq(next.pixel, RUNGS(1));
    ck_assert_double_gt(error, .08);
}

/* No option of a stage is coarser than in the stage before. */
TEST(a_stage_keeps_the_options_of_pixels)
{
    int stages = 0;

    for (int i = 0; i < 200; i++) {
        struct rad_refine_ask ask = ask_of(.02, .01 + .001 * i, .01, .005);
        struct rad_refine_rungs next;
        double error;

        ask.stage = 1;
        ask.rungs = (struct rad_refine_rungs){ RUNGS(4), RUNGS(1) };
        if (rad_refine_next(&ask, &next, &error)) {
            ck_assert_int_ge(next.ambient, RUNGS(4));
            ck_assert_int_ge(next.pixel, RUNGS(1));
            stages++;
        }
    }
    ck_assert_int_gt(stages, 100);
}

/* What is off by too much does not stay so where stages are left, and rays: the
 * last part of it is not too little to go for. */
TEST(what_is_not_near_enough_does_not_end)
{
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 13; k++) {
            struct rad_refine_ask ask =
                ask_of(.05, .005 * k, .02 + .005 * i, .016 + .004 * i);
            struct rad_refine_rungs next;
            double error;

            ask.stage = 1;
            ask.rungs = (struct rad_refine_rungs){ RUNGS(10), RUNGS(1) };
            ck_assert_msg(rad_refine_next(&ask, &next, &error) ||
                              error <= .05 * sqrt(1.2) + 1e-9,
                          "ambient %.3f, pixels %.3f: %.4f", .005 * k,
                          .02 + .005 * i, error);
        }
}

/* A smaller error never ends where a larger one goes on, whatever part of the
 * error is noise of pixels. */
TEST(a_smaller_error_gets_no_less)
{
    for (int noise = 0; noise <= 10; noise++) {
        bool on = true;

        for (int i = 1; i <= 30; i++) {
            struct rad_refine_ask ask = ask_of(.01 * i, .08, .1, .01 * noise);
            struct rad_refine_rungs next;
            double error;
            bool goes_on;

            ask.rungs.pixel = RAD_REFINE_MOST_PIXEL / 2;
            goes_on = rad_refine_next(&ask, &next, &error);
            ck_assert_msg(on || !goes_on, "noise %d, error %d", noise, i);
            on = goes_on;
        }
        ck_assert(!on);
    }
}

/* Of rays, and it grows with the pixels; a limit of time is in its place. */
TEST(a_stage_has_a_bound)
{
    struct rad_refine_ask ask = ask_of(.01, .3, .1, 0);
    struct rad_refine_rungs bound, whole, next;
    double error;

    ask.stage = RAD_REFINE_STAGES - 2;
    ck_assert(rad_refine_next(&ask, &bound, &error));
    set_clock(&ask, 1e12);
    ck_assert(rad_refine_next(&ask, &whole, &error));
    ck_assert_int_lt(bound.ambient, whole.ambient);
    ck_assert(!rad_refine_is_short(&ask));
    ask.left_s = INFINITY;
    ask.rays = 600000000;
    ck_assert(!rad_refine_next(&ask, &next, &error));
    ck_assert(rad_refine_is_short(&ask));
    ask.pixels = 100000000;
    ck_assert(rad_refine_next(&ask, &next, &error));
    ask.left_s = .1;
    ck_assert(!rad_refine_next(&ask, &next, &error));
    ck_assert(rad_refine_is_short(&ask));
    ask.error = .4;
    ck_assert(!rad_refine_next(&ask, &next, &error));
    ck_assert(!rad_refine_is_short(&ask));
}

TEST(the_clock_decides_where_more_time_is_another_decision)
{
    struct rad_refine_ask ask = ask_of(.1, .3, .1, 0);

    ck_assert(!rad_refine_by_clock(&ask)); /* there is none */
    set_clock(&ask, 1e6);
    ck_assert(!rad_refine_by_clock(&ask));
    ask.left_s = .1;
    ck_assert(rad_refine_by_clock(&ask));
    ask.error = 0; /* as good as may be */
    ask.left_s = 60;
    ck_assert(rad_refine_by_clock(&ask));
    ask.error = .4; /* it is there already */
    ask.left_s = .1;
    ck_assert(!rad_refine_by_clock(&ask));
}

/* More time is a finer stage, and at its end more rays of a pixel: of a clock
 * that goes up by tenths none is for nothing, up to the finest of pixels. */
TEST(more_time_is_used)
{
    struct rad_refine_rungs last = { 0, 0 }, next;
    double error;
    int stages = 0;

    for (double s = .1; s < 1e6 && last.ambient < RUNGS(15); s *= 1.1) {
        struct rad_refine_ask ask = ask_of(0, .3, .1, .05);

        set_clock(&ask, s);
        ask.stage = 1;
        if (!rad_refine_next(&ask, &next, &error))
            continue;
        ck_assert(s > 1);
        ck_assert_int_ge(next.ambient + RUNGS(1), last.ambient);
        stages += next.ambient != last.ambient;
        last = next;
    }
    ck_assert_int_gt(stages, 20);
    last.pixel = RUNGS(1);
    for (double s = .5; last.pixel < RAD_REFINE_MOST_PIXEL; s *= 1.1) {
        struct rad_refine_ask ask = ask_of(0, .01, .1, .05);

        set_clock(&ask, s);
        ask.stage = RAD_REFINE_STAGES - 1;
        ask.rungs.pixel = RUNGS(1);
        ck_assert(!rad_refine_next(&ask, &next, &error));
        ck_assert_int_ge(next.pixel, last.pixel);
        ck_assert(s < 100);
        stages += next.pixel != last.pixel;
        last = next;
    }
    ck_assert_int_gt(stages, 50);
}

/* Where the cache alone is off, too, half of the time is the pixels'. */
TEST(a_stage_leaves_time_for_pixels)
{
    struct rad_refine_ask ask = ask_of(0, .3, .001, .0005);
    const struct rad_params job = { .ambacc = .5, .ambdiv = 512 };
    struct rad_refine_rungs next;
    struct rad_params par;
    double error, records, rays;

    set_clock(&ask, 50);
    ask.stage = 1;
    ck_assert(rad_refine_next(&ask, &next, &error));
    rad_refine_params(&job, next, &par);
    records = job.ambacc / par.ambacc;
    rays = (double)ask.rays * records * records * par.ambdiv / job.ambdiv;
    ck_assert_double_lt(rays * ask.pass_s, 25);
    ck_assert_double_gt(rays * ask.pass_s, 10);
}

/* What takes all the time is foreseen from a stage that takes some of it. */
TEST(much_time_has_a_stage_before_the_last)
{
    struct rad_refine_ask ask = ask_of(0, .3, .1, .05);
    struct rad_refine_rungs first, last;
    double error;

    set_clock(&ask, 200);
    ck_assert(rad_refine_next(&ask, &first, &error));
    ask.stage = 1;
    ck_assert(rad_refine_next(&ask, &last, &error));
    ck_assert(first.ambient > RUNGS(3) &&
              first.ambient + RUNGS(2) < last.ambient);
    ck_assert_int_le(first.pixel, RUNGS(8));
    ask.stage = 0;
    set_clock(&ask, 6); /* from here it is foreseen well */
    ck_assert(rad_refine_next(&ask, &first, &error));
    ask.stage = 1;
    ck_assert(rad_refine_next(&ask, &last, &error));
    ck_assert_int_eq(first.ambient, last.ambient);
    ck_assert_int_eq(first.pixel, last.pixel);
}

/* ... a stage, though pixels alone are off, and their first rung takes more
 * than the part of the time that such a stage may. */
TEST(a_stage_before_the_last_is_one)
{
    for (double s = .5; s < 50; s *= 1.05) {
        struct rad_refine_ask ask = ask_of(0, 0, .3, .2);
        struct rad_refine_rungs first, last;
        double error;

        set_clock(&ask, s);
        ask.rays = 10000;
        ask.stage = 1;
        if (!rad_refine_next(&ask, &last, &error))
            continue;
        ask.stage = 0;
        ck_assert_msg(rad_refine_next(&ask, &first, &error), "%.2f s", s);
        ck_assert(!rad_refine_same_cache(ask.rungs, first));
    }
}

/* ... but if the error that is wanted is reached in time, the clock is none. */
TEST(a_goal_in_time_has_whole_rungs_as_without_a_clock)
{
    for (int i = 5; i <= 20; i++) {
        struct rad_refine_ask ask = ask_of(.01 * i, .3, .1, .05);
        struct rad_refine_rungs calm, timed;
        double error;

        ck_assert(rad_refine_next(&ask, &calm, &error));
        ck_assert(calm.ambient % RUNGS(1) == 0 && calm.pixel % RUNGS(1) == 0);
        set_clock(&ask, 1e5);
        ck_assert(rad_refine_next(&ask, &timed, &error));
        ck_assert_int_eq(timed.ambient, calm.ambient);
        ck_assert_int_eq(timed.pixel, calm.pixel);
    }
}

static const double wild[] = { 0,    -0.0,  -1,     1e-320, 1,
                               1e30, 1e308, -1e308, NAN,    INFINITY };

enum { SUMS = RAD_DOUBT_SUMS + 5 };

static double *
sum(struct rad_refine_sums *s, int k)
{
    double *more[] = { &s->off.light, &s->off.off, &s->off.square, &s->shown,
                       &s->rays };

    return k < RAD_DOUBT_SUMS ? &s->doubt.v[k] : more[k - RAD_DOUBT_SUMS];
}

/* Whatever is said, an end comes, with a number. */
LOOP_TEST(sums_may_be_anything, N_ELEM(wild))
{
    for (int k = 0; k < SUMS; k++)
        for (int i = 0; i < N_ELEM(wild); i++)
            for (int timed = 0; timed <= 1; timed++) {
                struct rad_refine_ask ask = ask_of(.02, .1, .1, .05);
                struct rad_refine_rungs next = { 0, 0 };
                double error = -1;

                *sum(&ask.sums, k) = wild[i];
                *sum(&ask.sums, (k + 1) % SUMS) = wild[_i];
                if (timed ^ (k & 1))
                    ask.rungs = (struct rad_refine_rungs){ 255, 255 };
                if (timed) {
                    ask.left_s = wild[i];
                    ask.pass_s = wild[_i];
                    ask.look_s = wild[(_i + 1) % N_ELEM(wild)];
                }
                rad_refine_next(&ask, &next, &error);
                ck_assert(error >= 0 && error <= 1e6);
                error = rad_refine_mean(&ask.sums);
                ck_assert(error >= 0 && error <= 1e6);
                ck_assert_int_le(next.ambient, RAD_REFINE_MOST_AMBIENT);
                ck_assert_int_le(next.pixel, RAD_REFINE_MOST_PIXEL);
            }
}

TEST(a_black_picture_is_good_enough)
{
    struct rad_refine_ask ask = { .error = .01, .left_s = INFINITY };
    struct rad_refine_rungs next;
    double error;

    ck_assert(!rad_refine_next(&ask, &next, &error));
    ck_assert_double_eq(error, 0);
}

/* The mean is off by what places have in common, not by what each is. */
TEST(mean_keeps_what_places_err_by_in_common)
{
    struct rad_refine_sums s = { 0 };
    double all;

    s.doubt.v[RAD_DOUBT_PLACES] = 100;
    s.doubt.v[RAD_DOUBT_AMBIENT] = s.doubt.v[RAD_DOUBT_SAID] = 100 * .02 * .02;
    s.off.light = 200;
    s.off.off = 100 * .04; /* each by 2 % */
    s.off.square = 100 * .04 * .04;
    all = rad_doubt_error(&s.doubt).ambient;
    ck_assert_double_eq_tol(rad_refine_mean(&s), all, 1e-9);
    s.off.off = 0; /* half of them too bright, half too dark */
    ck_assert_double_gt(rad_refine_mean(&s), 0);
    ck_assert_double_le(rad_refine_mean(&s), all / 10);
}
