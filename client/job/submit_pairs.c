/* submit_pairs.c - see submit_pairs.h */
#include "config.h"

#include "job/submit_pairs.h"

#include "base/list.h"

#include <string.h>

/* What a rule can speak of: an option, or an option with some value. */
enum given {
    JOB_ID,
    DETACH,
    DRY_RUN,
    POINTS,
    OUTPUT,
    OUTPUT_FILE,
    DEPTH,
    STATS,
    PREVIEW,
    FORMAT,
    TONE,
    BITS,
    EXPOSURE,
    FALSE_COLOUR,
    FOR_PIXELS,
    FRAMES,
    VIEWS,
    ONE_VIEW,
    NO_CLOBBER,
    OVERSAMPLE,
    CLAMP,
    BY_LINES,
    STATIC,
    NO_BALANCE,
    WINDOWS,
    ORDER,
    PASSES,
    LIVE,
    NO_SHARE,
    FRESH_FRAMES,
    AMBIENT_FILE,
    ERROR_GOAL,
    TIME_GOAL,
    REUSE,
    REUSE_ID,
    BANDS,
    PLANES,
    COSTS,
    PRIMARIES,
    XYZ,
    SPECTRA,
    MEAN,
    LOCAL,
    LAUNCH,
    COORDINATOR,
    ADDRESS,
    GIVENS
};
_Static_assert(GIVENS <= 64, "a set of them is 64 bits");

#define SET(g)  (UINT64_C(1) << (g))
#define SHOWN   (SET(TONE) | SET(BITS) | SET(EXPOSURE) | SET(FALSE_COLOUR))
#define GOAL    (SET(ERROR_GOAL) | SET(TIME_GOAL))
#define VIEWING                                                                \
    (SET(FOR_PIXELS) | SET(FRAMES) | SET(VIEWS) | SET(ONE_VIEW) | SET(DEPTH) | \
     SET(FORMAT) | SET(PREVIEW) | SET(OVERSAMPLE) | SET(CLAMP) | SHOWN |       \
     SET(NO_CLOBBER) | SET(FRESH_FRAMES))

/* Options of which only some go together.  The reason is what a user is told
 * behind both names. */
static const struct {
    enum given option;
    uint64_t others;
    const char *reason;
} excludes[] = {
    { JOB_ID, SET(DETACH) | SET(DRY_RUN),
      "--job asks for values that a former job has made" },
    { POINTS, VIEWING, "--points makes no picture" },
    { POINTS, SET(PRIMARIES),
      "values are red, green and blue, or X, Y and Z (-pXYZ)" },
    { MEAN, SET(XYZ) | SET(SPECTRA), "each says what a value's numbers are" },
    { DETACH, SET(OUTPUT) | SHOWN,
      "--detach waits for no picture: give such options to radctl fetch" },
    { DETACH, SET(DEPTH) | SET(STATS) | SET(PREVIEW),
      "--detach waits for no picture" },
    { DRY_RUN, SET(DETACH), "--dry-run makes no job" },
    { DRY_RUN, GOAL | SET(REUSE),
      "--dry-run foretells what given options bring, without a cache" },
    { BY_LINES, SET(WINDOWS) | SET(ORDER),
      "windows and their order are for --partition=window" },
    { PASSES, SET(NO_SHARE) | SET(FRESH_FRAMES),
      "passes fill a cache that all workers and frames share; use "
      "--ambient=live" },
    { LIVE, GOAL | SET(REUSE), "the cache must have been filled in passes" },
    { NO_SHARE, GOAL | SET(REUSE), "the cache must be shared by all workers" },
    { FRESH_FRAMES, GOAL | SET(REUSE),
      "the cache must be shared by all frames" },
    { AMBIENT_FILE, GOAL,
      "the values of a file are of given options, and a goal chooses its own; "
      "--reuse begins with a former job's" },
    { PLANES, GOAL, "each three bands would choose options of their own" },
    { PLANES, SET(PREVIEW) | SET(AMBIENT_FILE) | SET(COSTS) | SET(REUSE_ID),
      "each three bands are a job of their own" },
    { BANDS, SET(PRIMARIES), "bands have no primaries" },
    { LOCAL, SET(LAUNCH) | SET(COORDINATOR), "a job has one cluster" },
    { LAUNCH, SET(COORDINATOR), "a job has one cluster" },
    { REUSE, SET(LOCAL) | SET(LAUNCH),
      "a cluster of radsubmit's own keeps nothing, as a coordinator does" },
};

static const struct {
    enum given option, needed;
    const char *needed_name, *reason;
} needs[] = {
    { JOB_ID, POINTS, "--points", "radctl fetch gets pictures" },
    { VIEWS, FRAMES, "-S", "it is the file of an animation's views" },
    { FRESH_FRAMES, FRAMES, "-S", "it is for animations" },
    { NO_CLOBBER, FRAMES, "-S", "it leaves out frames" },
    { NO_CLOBBER, OUTPUT_FILE, "-o FILE",
      "it leaves out frames whose pictures exist" },
    { ADDRESS, LAUNCH, "--launch", "it is what launched workers dial" },
    { NO_BALANCE, STATIC, "--partition=static", "it keeps static parts whole" },
};

/* How a message names each of them; NULL: it is not given. */
static void
name_given(const struct submit_options *o, bool spectra,
           const char *name[GIVENS])
{
    static const char *const by_lines[] = {
        [MSG_PART_AUTO] = "--partition=auto",
        [MSG_PART_STATIC] = "--partition=static",
        [MSG_PART_SCANBAR] = "--partition=scanbar",
        [MSG_PART_WINDOW] = NULL,
    };
    const struct {
        bool is;
        const char *name;
    } all[GIVENS] = {
        [JOB_ID] = { o->job, "--job" },
        [DETACH] = { o->detach, "--detach" },
        [DRY_RUN] = { o->dry_run, "--dry-run" },
        [POINTS] = { o->points.file, "--points" },
        [OUTPUT] = { o->output, "-o" },
        [OUTPUT_FILE] = { o->output && strcmp(o->output, "-") != 0, "-o FILE" },
        [DEPTH] = { o->depth, "-z" },
        [STATS] = { o->stats, "--stats" },
        [PREVIEW] = { o->preview, "--preview" },
        [FORMAT] = { o->format, "--format" },
        [TONE] = { o->tone >= 0, "--tone" },
        [BITS] = { o->bits >= 0, "--bits" },
        [EXPOSURE] = { o->exposure, "--exposure" },
        [FALSE_COLOUR] = { o->false_colour, "--false-colour" },
        [FOR_PIXELS] = { o->for_pixels, o->for_pixels },
        [FRAMES] = { o->first_frame, "-S" },
        [VIEWS] = { o->views, "--views" },
        [ONE_VIEW] = { o->rif_view, "--view" },
        [NO_CLOBBER] = { o->no_clobber, "--no-clobber" },
        [OVERSAMPLE] = { o->oversample > 1, "--oversample" },
        [CLAMP] = { o->clamp > 0, "--clamp" },
        [BY_LINES] = { o->partition >= 0 && o->partition != MSG_PART_WINDOW,
                       by_lines[o->partition >= 0 ? o->partition : 0] },
        [STATIC] = { o->partition == MSG_PART_STATIC, "--partition=static" },
        [NO_BALANCE] = { o->no_balance, "--no-balance" },
        [WINDOWS] = { o->windows > 0, "--windows" },
        [ORDER] = { o->order != ORDER_NONE, "--order" },
        [PASSES] = { o->ambient_way == AMBIENT_PASSES, "--ambient=passes" },
        [LIVE] = { o->ambient_way == AMBIENT_LIVE, "--ambient=live" },
        [NO_SHARE] = { o->no_share, "--no-share" },
        [FRESH_FRAMES] = { o->fresh_frames, "--fresh-frames" },
        [AMBIENT_FILE] = { o->ambient, "-af" },
        [ERROR_GOAL] = { o->error > 0, "--error" },
        [TIME_GOAL] = { o->time_s > 0, "--time" },
        [REUSE] = { o->reuse, "--reuse" },
        [REUSE_ID] = { o->reuse && strcmp(o->reuse, "last") != 0,
                       "--reuse=JOB" },
        [BANDS] = { submit_options_planes(o) > 0, "-cs above 3" },
        [PLANES] = { spectra, "-cs above 3" },
        [COSTS] = { o->costs, "--estimate=FILE" },
        [PRIMARIES] = { o->params.primaries == RAD_PRIM_CUSTOM, "-pc" },
        [XYZ] = { o->params.primaries == RAD_PRIM_XYZ, "-pXYZ" },
        [SPECTRA] = { o->spectral > 0, "-co+" },
        [MEAN] = { o->points.mean, o->points.mean },
        [LOCAL] = { o->local, "--local" },
        [LAUNCH] = { o->launch, "--launch" },
        [COORDINATOR] = { o->coordinator, "--coordinator" },
        [ADDRESS] = { o->address, "--address" },
    };

    for (int i = 0; i < GIVENS; i++)
        name[i] = all[i].is ? all[i].name : NULL;
}

int
submit_pairs_check(const struct submit_options *o, bool spectra,
                   struct rad_error *err)
{
    const char *name[GIVENS];

    name_given(o, spectra, name);
    for (size_t i = 0; i < N_ELEM(excludes); i++) {
        const char *one = name[excludes[i].option];

        for (int other = 0; one && other < GIVENS; other++)
            if (name[other] && excludes[i].others & SET(other))
                return rad_fail(err, RAD_EUSAGE,
                                "%s and %s exclude each other: %s", one,
                                name[other], excludes[i].reason);
    }
    for (size_t i = 0; i < N_ELEM(needs); i++) {
        const char *one = name[needs[i].option];

        if (one && !name[needs[i].needed])
            return rad_fail(err, RAD_EUSAGE, "%s needs %s: %s", one,
                            needs[i].needed_name, needs[i].reason);
    }
    return 0;
}
