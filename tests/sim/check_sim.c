/* check_sim.c - clusters under many seeds: whatever happens, every job ends,
 * with the pictures and primary rays that one sampler alone makes
 *
 * RADD_SIM_SEED=n replays one seed and prints what happens.  RADD_SIM_RUNS=n
 * runs that many seeds, from RADD_SIM_FIRST on.  With RADD_SIM_DIGEST the
 * digest of all decisions is printed for each seed: a change that only moves
 * code keeps it. */
#include "config.h"

#include "cluster.h"

#include "image/hdr.h"

#include <jansson.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define RUNS 2500

/* What happens in clusters: counts of struct sim, each of which a run of all
 * these tests must have. */
/* clang-format off */
#define EVENTS(X)                                                              \
    X(coord_deaths) X(deaths) X(cuts) X(peer_cuts) X(crashes) X(drains)        \
    X(stops) X(parted) X(late) X(refused) X(parked) X(gave) X(loans)           \
    X(blocked) X(estimates) X(aside) X(tiles) X(passes) X(colours) X(reused)   \
    X(stages) X(pauses) X(priorities) X(rests) X(yields)
#define FIELD(name) unsigned name;
#define ADD(name) sum.name += cluster.name;
#define IS_ANY(name) && sum.name > 0
/* clang-format on */

/* Of all clusters, summed. */
static struct {
    EVENTS(FIELD)
    unsigned repeats, pictures;
    unsigned blows[SIM_TYPES][SIM_NBLOW];
    uint64_t primary, speculative, unsaid;
    uint64_t resumed, again;  /* see note_again() */
    uint64_t ordered, wasted; /* primary rays, and rays in vain, of clusters
                               * where nothing happened but orders */
} sum;

static json_int_t
number(const json_t *o, const char *name)
{
    return json_integer_value(json_object_get(o, name));
}

/* Make the picture that is wanted of a job in windows, each of which is sampled
 * by itself.  Returns its primary rays. */
static uint64_t
want_windows(struct sim_job *job, const json_t *units)
{
    const json_t *unit;
    uint64_t n = 0;
    size_t i;

    json_array_foreach(units, i, unit)
    {
        /* in these jobs a frame's number is its index */
        n += sim_alone(job, (uint32_t)number(unit, "frame"),
                       (int)number(unit, "x"), (int)number(unit, "y"),
                       (int)number(unit, "width"), (int)number(unit, "height"),
                       job->want[number(unit, "frame")]);
    }
    return n;
}

static uint64_t
want_frames(struct sim_job *job)
{
    uint64_t n = 0;

    for (uint32_t f = 0; f < job->spec.nframes; f++)
        n += sim_alone(job, f, 0, 0, (int)job->frame[f].width,
                       (int)job->frame[f].height, job->want[f]);
    return n;
}

/* Are two pixels the same?  Rows without distances are coded, so their colours
 * are compared as a picture file has them. */
static bool
same(const struct sim_job *job, const struct rad_pixel *a,
     const struct rad_pixel *b)
{
    uint8_t one[4], other[4];

    if (job->spec.flags & MSG_JOB_DEPTH)
        return memcmp(a, b, sizeof *a) == 0;
    rad_rgbe(a->L, one);
    rad_rgbe(b->L, other);
    return memcmp(one, other, 4) == 0;
}

/* Compare each pixel of the pictures with what is wanted. */
static void
check_pictures(struct sim *s, const struct sim_job *job)
{
    for (uint32_t f = 0; f < job->spec.nframes; f++) {
        size_t n = (size_t)job->frame[f].width * job->frame[f].height;

        SIM_CHECK(&s->net, job->frames[f].written);
        for (size_t i = 0; i < n; i++)
            SIM_CHECK(&s->net,
                      same(job, &job->picture[f][i], &job->want[f][i]));
    }
}

static bool
is_ordered(const struct sim *s)
{
    return s->pauses + s->priorities + s->rests + s->yields > 0;
}

/* Did nothing happen but delays, and orders of users and administrators? */
static bool
is_sound(const struct sim *s)
{
    return s->coord_deaths + s->deaths + s->cuts + s->peer_cuts + s->crashes +
               s->drains + s->stops + s->parted + s->late ==
           0;
}

/* Did nothing happen but delays, and did no unit go back for another job? */
static bool
is_quiet(const struct sim *s)
{
    return is_sound(s) && !is_ordered(s);
}

/* Did nothing happen but deaths of the coordinator and cuts of links to it? */
static bool
is_only_cut(const struct sim *s)
{
    return s->coord_deaths + s->cuts > 0 && !is_ordered(s) &&
           s->deaths + s->peer_cuts + s->crashes + s->drains + s->stops +
                   s->parted + s->late ==
               0;
}

/* Note how much was traced again after a loss of the coordinator.  Workers that
 * come back go on with their units, so that is little, unless one is away for
 * long because its dials fail. */
static void
note_again(const struct sim *s, const struct sim_job *job, uint64_t primary,
           uint64_t spec)
{
    if (!is_only_cut(s))
        return;
    sum.resumed += primary;
    sum.again += job->traced - primary - spec;
}

/* Check rays in vain (spec): all of them were traced, and in a quiet cluster
 * they are few.  But in a small picture a guess may go wrong everywhere: a
 * unit's guess errs in a few gaps of its first bars, and the base line above it
 * may be traced by its neighbour, too.  So a row of pixels is allowed for each
 * attempt at a unit.  (With repeated messages nothing is checked, for they are
 * counted twice.) */
static void
check_waste(struct sim *s, const struct sim_job *job, uint64_t primary,
            uint64_t spec, const json_t *units, const json_t *totals)
{
    const json_t *unit;
    json_int_t pixels = 0;
    size_t i;

    sum.pictures += job->spec.nframes;
    if (s->net.repeated > 0 || job->spec.partition == MSG_PART_WINDOW)
        return;
    SIM_CHECK(&s->net, primary + spec <= job->traced);
    /* no ray is counted in two units, or in a unit and as dropped; estimates
     * draw some pixels twice and count both */
    SIM_CHECK(&s->net, number(totals, "estimate_rays") > 0 ||
                           (uint64_t)number(totals, "rays") <=
                               job->traced + job->tile_rays);
    json_array_foreach(units, i, unit)
    {
        pixels += number(unit, "attempts") * number(unit, "width");
    }
    if (number(totals, "estimate_rays") == 0)
        note_again(s, job, primary, spec);
    if (is_sound(s) && is_ordered(s) && number(totals, "estimate_rays") == 0) {
        sum.ordered += primary;
        sum.wasted += job->traced - primary;
    }
    if (!is_quiet(s))
        return;
    /* if all rays were reported, each is in the picture or in vain */
    if ((uint64_t)number(totals, "rays") == job->traced &&
        number(totals, "dropped_rays") == 0 &&
        number(totals, "estimate_rays") == 0)
        sum.unsaid += job->traced - primary - spec;
    sum.primary += primary;
    sum.speculative += spec;
    SIM_CHECK(&s->net, spec <= primary / 50 + (uint64_t)pixels);
}

static void
check_done(struct sim *s, struct sim_job *job)
{
    json_t *root = json_loads(job->stats, 0, NULL), *units, *unit, *totals;
    json_int_t redone = 0, rays = 0, primary = 0;
    uint64_t want;
    size_t i;

    SIM_CHECK(&s->net, root != NULL);
    units = json_object_get(root, "units");
    totals = json_object_get(root, "totals");
    json_array_foreach(units, i, unit)
    {
        redone += number(unit, "attempts") - 1;
        rays += number(unit, "rays");
        primary += number(unit, "primary_rays");
    }
    want = job->spec.partition == MSG_PART_WINDOW ? want_windows(job, units)
                                                  : want_frames(job);
    check_pictures(s, job);
    /* a twin is an attempt, but does not count as redone */
    SIM_CHECK(&s->net, number(totals, "units_redone") <= redone);
    SIM_CHECK(&s->net,
              number(totals, "rays") == rays + number(totals, "estimate_rays") +
                                            number(totals, "tile_rays"));
    SIM_CHECK(&s->net, number(totals, "primary_rays") == primary);
    SIM_CHECK(&s->net, (uint64_t)primary == want);
    check_waste(s, job, want, (uint64_t)number(totals, "speculative_rays"),
                units, totals);
    json_decref(root);
}

static void
check_job(struct sim *s, struct sim_job *job)
{
    if (job->poisoned && !job->cancel) {
        SIM_CHECK(&s->net, job->failed && job->status == EX_SOFTWARE);
        SIM_CHECK(&s->net, strstr(job->text, "brought the renderer down"));
    } else if (job->failed) {
        SIM_CHECK(&s->net, job->cancel || job->poisoned);
    } else {
        SIM_CHECK(&s->net, job->done);
        check_done(s, job);
    }
}

/* The cluster under test. */
static struct sim cluster;

/* An assertion failed, such as that of a permitted step of a state: print the
 * seed. */
static void
on_abort(int number)
{
    (void)number;
    net_fail(&cluster.net, __FILE__, __LINE__, "assertion failed");
}

static void
run(uint64_t seed, bool verbose)
{
    sim_init(&cluster, seed);
    cluster.net.verbose = verbose;
    sim_run(&cluster);
    if (getenv("RADD_SIM_DIGEST"))
        printf("%llu %016llx\n", (unsigned long long)seed,
               (unsigned long long)cluster.digest);
    for (int i = 0; i < cluster.njobs; i++)
        check_job(&cluster, &cluster.job[i]);
    if (verbose)
        printf("seed %llu: %d workers, %d jobs, %u deaths, %u cuts, %u "
               "crashes, %llu ms\n",
               (unsigned long long)seed, cluster.nworkers, cluster.njobs,
               cluster.deaths, cluster.cuts, cluster.crashes,
               (unsigned long long)cluster.net.now_ms);
    EVENTS(ADD)
    sum.repeats += cluster.net.repeated;
    for (int t = 0; t < SIM_TYPES; t++)
        for (int b = 0; b < SIM_NBLOW; b++)
            sum.blows[t][b] += cluster.blows[t][b];
    sim_release(&cluster);
}

static unsigned
at_type(enum msg_type type)
{
    unsigned n = 0;

    for (int b = 0; b < SIM_NBLOW; b++)
        n += sum.blows[type][b];
    return n;
}

/* Did everything that these tests are for happen at least once? */
static bool
was_tried(void)
{
    static const enum msg_type types[] = {
        MSG_UNIT,     MSG_RESULT,    MSG_ACK,       MSG_FACTS,       MSG_PARKED,
        MSG_SPLIT,    MSG_GAVE,      MSG_BASE_LINE, MSG_NEXT_HOLDER, MSG_REVOKE,
        MSG_ESTIMATE, MSG_ESTIMATED, MSG_LEND,      MSG_LOAN,        MSG_BACK,
        MSG_PAID,     MSG_TILE,      MSG_TILE_MADE, MSG_FROZEN,      MSG_STAGE,
        MSG_SHOW,     MSG_GUESS
    };
    bool tried = at_type(MSG_JOB_PEERS) && sum.repeats EVENTS(IS_ANY);

    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
        for (int b = 0; b < SIM_NBLOW; b++)
            if (sum.blows[types[i]][b] == 0) {
                printf("no accident %d at %s\n", b, msg_name(types[i]));
                tried = false;
            }
    return tried;
}

static void
tell(uint64_t runs)
{
    unsigned blows = 0;

    for (int t = 0; t < SIM_TYPES; t++)
        for (int b = 0; b < SIM_NBLOW; b++)
            blows += sum.blows[t][b];
    printf("%llu clusters: %u pictures as one thread's, %llu primary rays of "
           "strict ones, %llu speculative, %llu for nothing and not told of; "
           "%llu of %llu again where only the coordinator was away\n"
           "%u coordinators died, %u workers, %u links to the coordinator were "
           "cut, %u of "
           "peers, %u children died; %u of these at chosen messages; %u "
           "drains, %u stood still, %u were cut off, %u messages came twice\n"
           "%u units late, %u parked, %u answers to SPLIT, %u "
           "loans, %u waits for them, %u aside, %u estimates; %u "
           "accidents at "
           "JOB_PEERS\n",
           (unsigned long long)runs, sum.pictures,
           (unsigned long long)sum.primary, (unsigned long long)sum.speculative,
           (unsigned long long)sum.unsaid, (unsigned long long)sum.again,
           (unsigned long long)sum.resumed, sum.coord_deaths, sum.deaths,
           sum.cuts, sum.peer_cuts, sum.crashes, blows, sum.drains, sum.stops,
           sum.parted, sum.repeats, sum.late, sum.parked, sum.gave, sum.loans,
           sum.blocked, sum.aside, sum.estimates, at_type(MSG_JOB_PEERS));
    printf("%u pauses, %u priorities, %u workers drained or not: %u units went "
           "back; where that was all, %llu rays for nothing, of %llu\n",
           sum.pauses, sum.priorities, sum.rests, sum.yields,
           (unsigned long long)sum.wasted, (unsigned long long)sum.ordered);
    printf("%u jobs refused by workers that had no room\n", sum.refused);
}

int
main(void)
{
    const char *one = getenv("RADD_SIM_SEED"), *many = getenv("RADD_SIM_RUNS");
    const char *from = getenv("RADD_SIM_FIRST");
    uint64_t runs = many ? strtoull(many, NULL, 10) : RUNS;
    uint64_t first = from ? strtoull(from, NULL, 10) : 0;

    signal(SIGABRT, on_abort);
    if (one) {
        run(strtoull(one, NULL, 10), true);
        return EXIT_SUCCESS;
    }
    for (uint64_t seed = first; seed < first + runs; seed++)
        run(seed, false);
    tell(runs);
    if (runs < RUNS)
        return EXIT_SUCCESS;
    return was_tried() && sum.speculative < sum.primary / 50 &&
                   sum.unsaid < sum.speculative / 20 &&
                   sum.wasted < sum.ordered / 50
               ? EXIT_SUCCESS
               : EXIT_FAILURE;
}
