/* submit_options.c - see submit_options.h
 *
 * One table has radsubmit's own options, another rpict's that name files; the
 * rest of rpict's come from the tables of src/picture.  What rpict has and we
 * lack is in a third table: refused by name. */
#include "config.h"

#include "job/submit_options.h"
#include "records/amblist.h"
#include "proto/message.h"
#include "show/picfile.h"
#include "common/outname.h"
#include "job/quality.h"
#include "link/launch.h"

#include "base/help.h"
#include "image/filter.h"
#include "base/number.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum kind {
    KIND_FLAG, /* bool */
    KIND_TEXT, /* const char * */
    KIND_MAYBE, /* the same, "" where no '=' follows */
    KIND_INT,  /* int, lo..hi */
    KIND_REAL, /* double, lo..hi */
    KIND_WORD  /* int: the word's place in `words` */
};

struct option {
    const char *name;
    enum kind kind;
    size_t field; /* offset in struct submit_options */
    double lo, hi;
    const char *words; /* of KIND_WORD: "auto|window" */
    const char *arg;   /* what the help calls the value */
    const char *help;
};

#define FIELD(f) offsetof(struct submit_options, f)
#define FLAG(name, f, help)                                                    \
    {                                                                          \
        name, KIND_FLAG, FIELD(f), 0, 0, 0, 0, help                            \
    }
#define TEXT(name, f, arg, help)                                               \
    {                                                                          \
        name, KIND_TEXT, FIELD(f), 0, 0, 0, arg, help                          \
    }
#define MAYBE(name, f, arg, help)                                              \
    {                                                                          \
        name, KIND_MAYBE, FIELD(f), 0, 0, 0, arg, help                         \
    }
#define INT(name, f, lo, hi, arg, help)                                        \
    {                                                                          \
        name, KIND_INT, FIELD(f), lo, hi, 0, arg, help                         \
    }
#define REAL(name, f, lo, hi, arg, help)                                       \
    {                                                                          \
        name, KIND_REAL, FIELD(f), lo, hi, 0, arg, help                        \
    }
#define WORD(name, f, words, help)                                             \
    {                                                                          \
        name, KIND_WORD, FIELD(f), 0, 0, words, words, help                    \
    }

/* --error [%], --time [s] */
#define LEAST_ERROR .1
#define LEAST_TIME  .1
#define MOST_TIME   1e6

enum {
    MOST_LOCAL = 64,
    MOST_WORKERS = 4096,
    MOST_THREADS = 1024,
    MOST_WINDOWS = 1 << 20
};

/* clang-format off */
static const struct option own[] = {
    TEXT("--coordinator", coordinator, "HOST:PORT|SOCKET",
         "cluster that renders"),
    TEXT("--key", key, "FILE", "key to show a coordinator over the network"),
    FLAG("--local", local, "render on a cluster of its own on this machine"),
    TEXT("--launch", launch, "COMMAND",
         "the same, its workers started by COMMAND: srun, mpirun, "
         "'ssh ws%d'"),
    TEXT("--address", address, "HOST[:PORT]",
         "of this machine, for workers of --launch (chosen)"),
    INT("--workers", workers, 1, MOST_WORKERS, "W",
        "worker processes of that cluster, or of --launch at least (1)"),
    INT("--threads", threads, 1, MOST_THREADS, "T",
        "threads of each (the processors / W)"),
    REAL("--wait", wait_s, 0, 1e9, "S",
         "seconds for a coordinator and a worker to be there (60)"),
    WORD("--format", format, "auto|hdr|png",
         "of the picture, whatever the suffix"),
    WORD("--tone", tone, SHOW_TONES, "how a .png shows light"),
    TEXT("--exposure", exposure, "[first,|each,]auto|+-STOPS|FACTOR",
         "of a .png: stops from its own one, as +1, or a factor of "
         "radiance; all frames have the first one's, or each its own "
         "(first,auto)"),
    WORD("--bits", bits, SHOW_BITS, "of a channel of a .png"),
    MAYBE("--false-colour", false_colour, "[=auto|SCALE][,...]",
          "a .png of luminance in colours, with a legend; behind SCALE "
          "log=DECADES, n=DIVISIONS, contour=lines|bands|steps, label=TEXT"),
    WORD("--quality", quality, QUALITY_WORDS,
         "a set of rpict's options, for those that are not given"),
    REAL("--error", error, LEAST_ERROR, 100, "PERCENT",
         "go on until the picture is estimated to be so far off (from rpict's "
         "options, or a set of its own, on)"),
    REAL("--time", time_s, LEAST_TIME, MOST_TIME, "S",
         "go on for so many seconds; with --error, for no longer"),
    FLAG("--stamp", stamp,
         "the day, the host and the job in the picture's header"),
    TEXT("--points", points.file, "FILE",
         "sensor points in place of pictures, as rtrace takes them; '-' is the "
         "standard input"),
    INT("--oversample", oversample, 1, RAD_MAX_OVERSAMPLE, "N",
        "trace N by N samples a pixel, and filter them down (by --quality; "
        "2 for a .png without it, else 1)"),
    REAL("--clamp", clamp, RAD_MIN_CLAMP, RAD_MAX_CLAMP, "FACTOR",
         "most weight of a sample, times the mean of those about it (any)"),
    TEXT("--preview", preview, "FILE.png", "picture so far, while rendering"),
    TEXT("--stats", stats, "FILE.json", "statistics of the job"),
    WORD("--progress", progress, "auto|always|never",
         "a line on stderr that says how far it is"),
    FLAG("--dry-run", dry_run,
         "say what the job needs and will take, and render nothing"),
    FLAG("--detach", detach, "print the job's id and do not wait"),
    TEXT("--name", name, "TEXT", "of the job, for people"),
    INT("--priority", priority, -100, 100, "N",
        "jobs with more go first (0)"),
    INT("--memory-mib", memory_mib, 0, 1 << 24, "N",
        "most memory of the job's process on each worker [MiB] (0: any)"),
    WORD("--partition", partition, "auto|static|scanbar|window",
         "how the work is shared"),
    INT("--windows", windows, 1, MOST_WINDOWS, "N",
        "windows to share out (by the picture's size)"),
    WORD("--order", order, "forward|backward|random|cost",
         "order in which windows are handed out"),
    TEXT("--estimate", estimate, "uniform|NNa|NNb|FILE.json",
         "what the parts of the picture cost: by their size, by the rays or "
         "tests of NN random pixels of each, by a former run's statistics"),
    FLAG("--no-balance", no_balance,
         "a static part stays with the worker that got it"),
    WORD("--ambient", ambient_way, "passes|live",
         "ambient values in passes before the picture, so that it is the same "
         "whoever makes it, or each as rays ask for it (passes)"),
    TEXT("--reuse", reuse, "JOB|last",
         "begin with the ambient values that a former job on the same scene "
         "left: that job, or the last one that fits"),
    TEXT("--job", job, "ID",
         "of sensor points: write the values of the job that the same words "
         "with --detach have left"),
    FLAG("--no-share", no_share, "no ambient values from worker to worker"),
    FLAG("--same-bits", same_bits,
         "only workers whose arithmetic is the same to the bit"),
    FLAG("--commands", commands,
         "run the commands of an octree's scene files, too"),
    FLAG("--fresh-frames", fresh_frames,
         "frame by frame, nothing kept from one to the next"),
    TEXT("--views", views, "FILE", "views of an animation, one a line"),
    FLAG("--no-clobber", no_clobber,
         "with -S, leave out frames whose pictures are there"),
    TEXT("--view", rif_view, "NAME", "the one of a .rif file's views"),
    FLAG("--rpict-status", rpict_status,
         "exit with rpict's status: 1 for what is wrong with the command line "
         "or the scene, 2 for all else")
};

static const struct option rpicts[] = {
    TEXT("-o", output, "FILE", "the picture (standard output)"),
    TEXT("-z", depth, "FILE", "distances, as floats"),
    TEXT("-af", ambient, "FILE", "ambient values, read and added to"),
    INT("-S", first_frame, 1, INT_MAX, "N", "animation, first frame's number"),
    INT("-t", report_s, 0, INT_MAX, "S", "seconds between progress reports"),
    TEXT("-e", errors, "FILE", "errors and progress reports, for stderr")
};

/* rpict's own that we lack */
static const struct {
    const char *option; /* whole word, or "--name=value" */
    const char *why;
} lacking[] = {
    { "-features", "an option of rpict that is not supported" }
};
/* clang-format on */

#define N_ELEM(a) (sizeof(a) / sizeof((a)[0]))

/* Where a parser stands. */
struct cursor {
    struct submit_options *o;
    struct words *w;
    int at;
    quality_given given; /* for --quality */
    struct rad_error *err;
};

static void
set_defaults(struct submit_options *o)
{
    memset(o, 0, sizeof *o);
    rad_params_init(&o->params);
    rad_view_init(&o->view);
    o->wait_s = 60;
    o->quality = o->tone = o->bits = o->spectral = -1;
    show_init(&o->show);
    o->order = ORDER_NONE;
    o->ambient_way = AMBIENT_NONE;
    pointspec_init(&o->points);
}

static int
out_of_range(const struct option *opt, const char *text, struct rad_error *err)
{
    char lo[RAD_NUMBER_TEXT], hi[RAD_NUMBER_TEXT];

    rad_format_real(lo, opt->lo);
    rad_format_real(hi, opt->hi);
    return rad_fail(
        err, RAD_EUSAGE, "option '%s': '%.40s' is not a%s number from %s to %s",
        opt->name, text, opt->kind == KIND_INT ? " whole" : "", lo, hi);
}

static int
take_word(int *field, const struct option *opt, const char *text,
          struct rad_error *err)
{
    int i = words_place(opt->words, text);

    if (i >= 0) {
        *field = i;
        return 0;
    }
    return rad_fail(err, RAD_EUSAGE, "option '%s': '%.40s' is none of %s",
                    opt->name, text, opt->words);
}

static int
take_value(struct submit_options *o, const struct option *opt, const char *text,
           struct rad_error *err)
{
    void *field = (char *)o + opt->field;

    switch (opt->kind) {
    case KIND_FLAG:
        *(bool *)field = true;
        return 0;
    case KIND_MAYBE:
        *(const char **)field = text;
        return 0;
    case KIND_TEXT:
        if (text[0] == '\0')
            return rad_fail(err, RAD_EUSAGE, "option '%s': empty value",
                            opt->name);
        *(const char **)field = text;
        return 0;
    case KIND_INT:
        if (!rad_parse_int(text, field) || *(int *)field < opt->lo ||
            *(int *)field > opt->hi)
            return out_of_range(opt, text, err);
        return 0;
    case KIND_REAL:
        if (!rad_parse_real(text, field) || *(double *)field < opt->lo ||
            *(double *)field > opt->hi)
            return out_of_range(opt, text, err);
        return 0;
    default:
        return take_word(field, opt, text, err);
    }
}

/* Take the option at the cursor if the table has it: the words used, 0 if it
 * has not.  Values follow a '=' or are the next word. */
static int
take_from(struct cursor *c, const struct option *table, size_t n)
{
    const char *word = c->w->list[c->at];
    size_t len = strcspn(word, "=");
    const struct option *opt = NULL;
    const char *value = word[len] ? word + len + 1 : NULL;
    int rc, used = 1;

    for (size_t i = 0; i < n && !opt; i++)
        if (strlen(table[i].name) == len &&
            strncmp(table[i].name, word, len) == 0)
            opt = &table[i];
    if (!opt)
        return 0;
    if (opt->kind == KIND_FLAG && value)
        return rad_fail(c->err, RAD_EUSAGE, "option '%s' takes no value",
                        opt->name);
    if (opt->kind == KIND_MAYBE && !value)
        value = "";
    if (opt->kind != KIND_FLAG && !value) {
        value = c->w->list[c->at + 1]; /* the list ends with a NULL */
        used = 2;
        if (!value)
            return rad_fail(c->err, RAD_EUSAGE, "option '%s': missing value",
                            opt->name);
    }
    rc = take_value(c->o, opt, value, c->err);
    return rc < 0 ? rc : used;
}

/* 0, or RAD_EUSAGE if the word is something that we lack. */
static int
refuse_lacking(struct cursor *c)
{
    const char *word = c->w->list[c->at];
    const char *next = c->w->list[c->at + 1];
    char joined[64];

    snprintf(joined, sizeof joined, "%s=%s", word, next ? next : "");
    for (size_t i = 0; i < N_ELEM(lacking); i++) {
        const char *l = lacking[i].option;
        size_t n = strlen(l);

        if ((strncmp(word, l, n) == 0 && (word[n] == '\0' || word[n] == '=')) ||
            strcmp(joined, l) == 0)
            return rad_fail(c->err, RAD_EUSAGE, "option '%s': %s", l,
                            lacking[i].why);
    }
    return 0;
}

/* -vf FILE */
static int
take_view_file(struct cursor *c)
{
    enum { LONGEST = 1 << 20 };
    const char *path = c->w->list[c->at + 1];
    char *text;
    size_t n;
    FILE *f;
    int rc;

    if (strcmp(c->w->list[c->at], "-vf") != 0)
        return 0;
    if (!path)
        return rad_fail(c->err, RAD_EUSAGE, "option '-vf': missing value");
    f = fopen(path, "r");
    text = malloc(LONGEST);
    if (!f || !text) {
        rc = rad_fail(c->err, f ? RAD_ENOMEM : RAD_ENOINPUT,
                      "cannot open view file '%s': %s", path, strerror(errno));
    } else {
        n = fread(text, 1, LONGEST, f);
        rc = inputs_add_fd(&c->w->inputs, "the view file", fileno(f), c->err);
        if (rc == 0)
            rc = rad_view_read(&c->o->view, text, n, c->err);
        if (rc == 0)
            rc = rad_fail(c->err, RAD_EDATA, "no view in the file");
        if (rc < 0)
            rad_error_where(c->err, "%s", path);
    }
    if (f)
        fclose(f);
    free(text);
    return rc < 0 ? rc : 2;
}

/* -w, -w+, -w-: warnings, which are on. */
static int
take_warnings(struct cursor *c)
{
    const char *word = c->w->list[c->at];

    if (strncmp(word, "-w", 2) != 0 || (word[2] && word[3]) ||
        !strchr("+-10", word[2]))
        return 0;
    c->o->quiet = word[2] ? strchr("-0", word[2]) != NULL : !c->o->quiet;
    return 1;
}

/* -co, -co+, -co-: spectra in place of colours. */
static int
take_spectral(struct cursor *c)
{
    const char *word = c->w->list[c->at];

    if (strncmp(word, "-co", 3) != 0 || (word[3] && word[4]) ||
        !strchr("+-10", word[3]))
        return 0;
    c->o->spectral =
        word[3] ? strchr("+1", word[3]) != NULL : c->o->spectral != 1;
    return 1;
}

static int
is_wish(const char *word)
{
    if (strcmp(word, "--help") == 0 || strcmp(word, "-help") == 0)
        return SUBMIT_HELP;
    if (strcmp(word, "--version") == 0 || strcmp(word, "-version") == 0)
        return SUBMIT_VERSION;
    if (strcmp(word, "--rpict-path") == 0)
        return SUBMIT_RPICT;
    if (strcmp(word, "-defaults") == 0)
        return SUBMIT_DEFAULTS;
    return SUBMIT_RUN;
}

/* The renderer's; it brings -ps to what the sampler does. */
static int
take_params(struct cursor *c, int argc, char *const argv[])
{
    int rc = rad_params_option(&c->o->params, argc, argv, c->err);

    if (rc > 0 && strncmp(argv[0], "-p", 2) == 0 &&
        islower((unsigned char)argv[0][2]) && strcmp(argv[0], "-pc") != 0 &&
        !c->o->for_pixels)
        c->o->for_pixels = argv[0];
    if (rc > 0 && strcmp(argv[0], "-ps") == 0)
        c->o->psample_asked = (int)strtol(argv[1], NULL, 10);
    if (rc > 0)
        c->given |= quality_bit(argv[0]);
    return rc;
}

/* -aE, -aI */
static int
take_name_list(struct cursor *c, int argc, char *const argv[])
{
    int rc = amblist_option(&c->o->params, argc, argv, c->err);
    int noted = rc > 1 ? inputs_add(&c->w->inputs, "a list of modifiers",
                                    argv[1], c->err)
                       : 0;

    return noted < 0 ? noted : rc;
}

static int
take_option(struct cursor *c)
{
    char *const *argv = c->w->list + c->at;
    int argc = c->w->n - c->at, rc;

    if ((rc = refuse_lacking(c)) != 0 || (rc = take_warnings(c)) != 0 ||
        (rc = take_spectral(c)) != 0 ||
        (rc = take_name_list(c, argc, argv)) != 0)
        return rc;
    if ((rc = take_view_file(c)) != 0) {
        c->o->for_pixels = argv[0];
        return rc;
    }
    if (strncmp(argv[0], "--", 2) == 0) {
        if ((rc = take_from(c, own, N_ELEM(own))) != 0)
            return rc;
    } else if (!strchr(argv[0], '=')) { /* rpict knows no "-o=FILE" */
        if ((rc = take_from(c, rpicts, N_ELEM(rpicts))) != 0)
            return rc;
    }
    if ((rc = pointspec_option(&c->o->points, argc, argv, c->err)) != 0 ||
        (rc = take_params(c, argc, argv)) != 0)
        return rc;
    if ((rc = rad_view_option(&c->o->view, argc, argv, c->err)) != 0) {
        c->o->for_pixels = argv[0];
        return rc;
    }
    return rad_fail(c->err, RAD_EUSAGE,
                    "unknown option '%s'; see radsubmit --help", argv[0]);
}

/* Options up to the first scene; what else the user wants. */
static int
take_options(struct cursor *c)
{
    int wish = SUBMIT_RUN, rc;

    for (;;) {
        const char *word;

        if ((rc = words_expand(c->w, c->at, c->err)) < 0)
            return rc;
        word = c->w->list[c->at];
        if (!word || word[0] != '-' || word[1] == '\0')
            return wish;
        if (strcmp(word, "--") == 0) {
            c->at++;
            return wish;
        }
        rc = is_wish(word);
        if (rc == SUBMIT_HELP || rc == SUBMIT_VERSION || rc == SUBMIT_RPICT)
            return rc;
        if (rc == SUBMIT_DEFAULTS) {
            wish = rc;
            c->at++;
            continue;
        }
        if ((rc = take_option(c)) < 0)
            return rc;
        c->at += rc;
    }
}

static int
take_scenes(struct cursor *c, bool dashes)
{
    int nstdin = 0;

    c->o->scenes = c->w->list + c->at;
    c->o->nscenes = c->w->n - c->at;
    if (c->o->nscenes == 0)
        return rad_fail(c->err, RAD_EUSAGE,
                        "no scene given; see radsubmit --help");
    for (int i = 0; i < c->o->nscenes; i++) {
        const char *word = c->o->scenes[i];

        if (strcmp(word, "-") == 0)
            nstdin++;
        else if (word[0] == '-' && !dashes)
            return rad_fail(c->err, RAD_EUSAGE, "option '%s' after scene '%s'",
                            word, c->o->scenes[0]);
    }
    if (nstdin > 1)
        return rad_fail(c->err, RAD_EUSAGE, "standard input given twice");
    if (nstdin && c->o->first_frame && !c->o->views)
        return rad_fail(c->err, RAD_EUSAGE,
                        "standard input cannot hold both scene and views: "
                        "use --views");
    return 0;
}

/* "20a": random pixels, and what of them counts. */
static bool
is_sampled(const char *text)
{
    enum { MOST = 1000 };
    size_t n = strspn(text, "0123456789");
    long rays = n > 0 && n < 9 ? strtol(text, NULL, 10) : 0;

    return rays >= 1 && rays <= MOST &&
           (strcmp(text + n, "a") == 0 || strcmp(text + n, "b") == 0);
}

static int
check_estimate(struct submit_options *o, struct rad_error *err)
{
    size_t len = o->estimate ? strlen(o->estimate) : 0;

    if (!o->estimate || strcmp(o->estimate, "uniform") == 0 ||
        is_sampled(o->estimate))
        return 0;
    if (len <= 5 || strcmp(o->estimate + len - 5, ".json") != 0)
        return rad_fail(err, RAD_EUSAGE,
                        "option '--estimate': '%.40s' is not uniform, NNa or "
                        "NNb with NN from 1 to 1000, or a FILE.json",
                        o->estimate);
    o->costs = o->estimate;
    o->estimate = NULL;
    return 0;
}

/* What is for windows asks for them, or contradicts. */
static int
check_sharing(struct submit_options *o, struct rad_error *err)
{
    bool lines =
        o->partition == PARTITION_STATIC || o->partition == PARTITION_SCANBAR;

    if (lines && o->windows > 0)
        return rad_fail(err, RAD_EUSAGE, "--windows is for --partition=window");
    if (lines && o->order != ORDER_NONE)
        return rad_fail(err, RAD_EUSAGE, "--order is for --partition=window");
    return check_estimate(o, err);
}

static bool
is_dash(const char *name)
{
    return name && strcmp(name, "-") == 0;
}

/* "-" is standard output, as it is input for a scene, but the picture's. */
static int
check_outputs(struct submit_options *o, struct rad_error *err)
{
    if (o->detach && (o->output || o->depth || o->stats || o->preview))
        return rad_fail(err, RAD_EUSAGE,
                        "--detach waits for no picture: leave out -o, -z, "
                        "--stats and --preview, and use radctl fetch");
    if (is_dash(o->depth) || is_dash(o->stats) || is_dash(o->preview))
        return rad_fail(err, RAD_EUSAGE,
                        "'-' is a name for -o alone, not for -z, --stats or "
                        "--preview");
    if (is_dash(o->output))
        o->output = NULL;
    return 0;
}

/* Options that no picture heeds are a mistake. */
static int
check_show(struct submit_options *o, struct rad_error *err)
{
    const char *given = o->tone >= 0    ? "--tone"
                        : o->exposure   ? "--exposure"
                        : o->bits >= 0  ? "--bits"
                                        : NULL;

    if (given && o->false_colour)
        return rad_fail(err, RAD_EUSAGE,
                        "%s is no matter of --false-colour: leave one of them "
                        "out",
                        given);
    if (o->false_colour)
        given = "--false-colour";
    if (given && o->detach)
        return rad_fail(err, RAD_EUSAGE,
                        "%s is for a .png, and --detach writes none: use "
                        "radctl fetch with it",
                        given);
    if (given && !o->preview &&
        !picfile_is_png(o->output, (enum picfile_format)o->format))
        return rad_fail(err, RAD_EUSAGE,
                        "%s is for a .png: use -o FILE.png, --format=png or "
                        "--preview with it",
                        given);
    if (o->tone >= 0)
        o->show.screen.tone.curve = (enum rad_tone_curve)o->tone;
    if (o->bits >= 0)
        o->show.screen.bits = o->bits == SHOW_16_BITS ? 16 : 8;
    if (o->false_colour)
        return show_false(&o->show, o->false_colour, err);
    return o->exposure ? show_exposure(&o->show, o->exposure, err) : 0;
}

/* What nobody said of --oversample goes by --quality; without that, what is for
 * the eye alone has smooth edges. */
static void
choose_oversample(struct submit_options *o)
{
    if (o->oversample > 0)
        return;
    if (o->quality >= 0)
        o->oversample = quality_oversample(o->quality);
    else
        o->oversample =
            picfile_is_png(o->output, (enum picfile_format)o->format) ? 2 : 1;
}

/* From here on -x and -y are those of what is traced, as in the job. */
static int
count_samples(struct submit_options *o, struct rad_error *err)
{
    int n, most;
    bool wide;

    choose_oversample(o);
    n = o->oversample;
    most = RAD_MAX_RES / n;
    wide = o->params.xres > most;
    if (o->clamp > 0 && n < 2)
        return rad_fail(err, RAD_EUSAGE,
                        "--clamp is for the samples of --oversample=2 or more");
    if (wide || o->params.yres > most)
        return rad_fail(err, RAD_EUSAGE,
                        "option '-%c': %d is too large with --oversample=%d: "
                        "at most %d",
                        wide ? 'x' : 'y',
                        wide ? o->params.xres : o->params.yres, n, most);
    o->params.xres *= n;
    o->params.yres *= n;
    return 0;
}

/* Passes are for values that all workers share, in all frames. */
static int
check_ambient(const struct submit_options *o, struct rad_error *err)
{
    if (o->ambient_way == AMBIENT_PASSES && (o->no_share || o->fresh_frames))
        return rad_fail(err, RAD_EUSAGE, "%s needs --ambient=live",
                        o->no_share ? "--no-share" : "--fresh-frames");
    return 0;
}

int
submit_options_planes(const struct submit_options *o)
{
    return o->params.bands.plane >= 0 ? 1 : rad_bands_planes(&o->params.bands);
}

static bool
is_hsr(const struct submit_options *o)
{
    return o->format == PICFILE_BY_SUFFIX && o->output &&
           outname_suffix(o->output, ".hsr");
}

bool
submit_options_spectra(const struct submit_options *o)
{
    return submit_options_planes(o) > 1 &&
           (o->spectral < 0 ? is_hsr(o) : o->spectral > 0);
}

/* What goes with a job for each plane. */
static const char *
hinders_planes(const struct submit_options *o)
{
    return o->preview                                ? "--preview"
           : o->error > 0                              ? "--error"
           : o->time_s > 0                             ? "--time"
           : o->ambient                                ? "-af"
           : o->costs                                  ? "--estimate=FILE"
           : o->reuse && strcmp(o->reuse, "last") != 0 ? "--reuse=JOB"
           : o->params.primaries == RAD_PRIM_CUSTOM    ? "-pc"
                                                       : NULL;
}

static int
check_planes(const struct submit_options *o, struct rad_error *err)
{
    const char *not = hinders_planes(o);
    bool spectra = submit_options_spectra(o);

    if (submit_options_planes(o) == 1)
        return is_hsr(o) ? rad_fail(err, RAD_EUSAGE,
                                    "'%s': spectra have more than three bands: "
                                    "use -cs N",
                                    o->output)
                         : 0;
    if (not )
        return rad_fail(err, RAD_EUSAGE,
                        "%s does not go with more than three bands (-cs %d)",
                        not, o->params.bands.n);
    if (is_hsr(o) && !spectra)
        return rad_fail(err, RAD_EUSAGE,
                        "'%s' is a name for spectra, and -co- asks for none",
                        o->output);
    if (spectra && picfile_is_png(o->output, (enum picfile_format)o->format))
        return rad_fail(err, RAD_EUSAGE, "-co+: a .png has no spectra");
    if (spectra && o->params.primaries != RAD_PRIM_RGB)
        return rad_fail(err, RAD_EUSAGE, "-co+ and -pXYZ exclude each other");
    if (!spectra && !rad_bands_show_colour(&o->params.bands))
        return rad_fail(err, RAD_EUSAGE,
                        "option '-cw': %g to %g nm show no colours: use -co+",
                        o->params.bands.shortest, o->params.bands.longest);
    return 0;
}

bool
submit_options_goal(const struct submit_options *o)
{
    return o->error > 0 || o->time_s > 0;
}

/* Options that go with no goal. */
static const char *
hinders_goal(const struct submit_options *o)
{
    return o->ambient_way == AMBIENT_LIVE ? "--ambient=live"
           : o->no_share                  ? "--no-share"
           : o->fresh_frames              ? "--fresh-frames"
           : o->dry_run                   ? "--dry-run"
           : o->ambient                   ? "-af"
           : o->reuse                     ? "--reuse"
                                          : NULL;
}

/* A picture is refined by its ambient cache, in passes. */
static int
check_goal(const struct submit_options *o, struct rad_error *err)
{
    const char *goal = o->error > 0 ? "--error" : "--time", *not ;

    if (!submit_options_goal(o))
        return 0;
    not = hinders_goal(o);
    if (not )
        return rad_fail(err, RAD_EUSAGE, "%s does not go with %s", goal, not );
    if (o->params.ambounce <= 0 || o->params.ambacc <= 0 ||
        o->params.ambdiv <= 0)
        return rad_fail(err, RAD_EUSAGE,
                        "%s is for pictures with indirect light: -ab, -aa and "
                        "-ad must be above 0",
                        goal);
    return 0;
}

static int
check_reuse(const struct submit_options *o, struct rad_error *err)
{
    uint8_t job[MSG_JOB];
    const char *other = o->ambient_way == AMBIENT_LIVE ? "--ambient=live"
                        : o->no_share                  ? "--no-share"
                        : o->fresh_frames              ? "--fresh-frames"
                        : o->dry_run                   ? "--dry-run"
                                                       : NULL;

    if (!o->reuse)
        return 0;
    if (strcmp(o->reuse, "last") != 0 && !msg_job_parse(o->reuse, job))
        return rad_fail(err, RAD_EUSAGE,
                        "option '--reuse': '%.40s' is neither a job's id, of "
                        "%d digits, nor 'last'",
                        o->reuse, MSG_JOB_HEX - 1);
    if (other)
        return rad_fail(err, RAD_EUSAGE, "--reuse and %s exclude each other",
                        other);
    if (o->local || o->launch)
        return rad_fail(err, RAD_EUSAGE,
                        "--reuse needs a coordinator: a cluster of radsubmit's "
                        "own keeps nothing");
    return 0;
}

/* Options that are about pictures or their views. */
static const char *
is_for_pictures(const struct submit_options *o)
{
    return o->for_pixels       ? o->for_pixels
           : o->first_frame    ? "-S"
           : o->views          ? "--views"
           : o->rif_view       ? "--view"
           : o->depth          ? "-z"
           : o->format         ? "--format"
           : o->preview        ? "--preview"
           : o->oversample > 1 ? "--oversample"
           : o->clamp > 0      ? "--clamp"
           : o->tone >= 0      ? "--tone"
           : o->exposure       ? "--exposure"
           : o->bits >= 0      ? "--bits"
           : o->false_colour   ? "--false-colour"
           : o->no_clobber     ? "--no-clobber"
           : o->fresh_frames   ? "--fresh-frames"
                               : NULL;
}

/* Sensor points are a picture without a view, each pixel of which is traced. */
static int
check_points(struct submit_options *o, struct rad_error *err)
{
    const char *other = is_for_pictures(o);
    int rc = pointspec_check(&o->points, err);
    uint8_t id[MSG_JOB];

    if (o->job && (!o->points.file || o->detach || o->dry_run))
        return rad_fail(err, RAD_EUSAGE,
                        "--job is for the values of sensor points: without "
                        "--detach and --dry-run, and radctl fetch gets "
                        "pictures");
    if (o->job && !msg_job_parse(o->job, id))
        return rad_fail(err, RAD_EUSAGE,
                        "option '--job': '%.40s' is no job's id, of %d digits",
                        o->job, MSG_JOB_HEX - 1);

    if (rc < 0 || !o->points.file)
        return rc;
    if (other)
        return rad_fail(err, RAD_EUSAGE,
                        "%s is for pictures, and --points makes none", other);
    if ((o->detach || o->job) && (!pointspec_lit(&o->points) ||
                                  submit_options_planes(o) > 1))
        return rad_fail(err, RAD_EUSAGE,
                        "%s is for one job: not for -o letters that need no "
                        "light, nor for more than three bands (-cs) of points",
                        o->detach ? "--detach" : "--job");
    if (picfile_is_png(o->output, PICFILE_BY_SUFFIX))
        return rad_fail(err, RAD_EUSAGE,
                        "'%s': --points makes no picture: -fac with -x and -y "
                        "writes colours for a .hdr",
                        o->output);
    if (o->spectral > 0 && o->points.out == 'c')
        return rad_fail(err, RAD_EUSAGE,
                        "-f%cc writes colours, and -co+ asks for spectra",
                        o->points.in);
    for (int i = 0; i < o->nscenes; i++)
        if (is_dash(o->points.file) && is_dash(o->scenes[i]))
            return rad_fail(err, RAD_EUSAGE,
                            "standard input cannot hold both scene and points");
    o->params.psample = o->oversample = 1;
    return 0;
}

/* Whose cluster? */
static int
check_cluster(const struct submit_options *o, struct rad_error *err)
{
    char dial[LAUNCH_ADDRESS], listen[LAUNCH_ADDRESS];

    if ((o->local || o->launch) && o->coordinator)
        return rad_fail(err, RAD_EUSAGE,
                        "--%s and --coordinator exclude each other",
                        o->local ? "local" : "launch");
    if (o->local && o->launch)
        return rad_fail(err, RAD_EUSAGE,
                        "--local and --launch exclude each other");
    if (o->launch && strspn(o->launch, " \t\n") == strlen(o->launch))
        return rad_fail(err, RAD_EUSAGE, "--launch: expected a command");
    if (!o->launch && o->address)
        return rad_fail(err, RAD_EUSAGE, "--address is for --launch");
    if (!o->launch && o->workers > MOST_LOCAL)
        return rad_fail(err, RAD_EUSAGE,
                        "option '--workers': at most %d on one machine",
                        MOST_LOCAL);
    return o->address ? launch_address(o->address, dial, listen, err) : 0;
}

static int
check_together(struct submit_options *o, struct rad_error *err)
{
    int rc = check_points(o, err);

    if (rc < 0 || (rc = check_outputs(o, err)) < 0 ||
        (rc = check_show(o, err)) < 0)
        return rc;
    if ((rc = check_cluster(o, err)) < 0)
        return rc;
    if (o->name && strlen(o->name) > MSG_MAX_LABEL)
        return rad_fail(err, RAD_EUSAGE,
                        "option '--name': %zu bytes, and at most %d are allowed",
                        strlen(o->name), MSG_MAX_LABEL);
    if (o->views && !o->first_frame)
        return rad_fail(err, RAD_EUSAGE, "--views needs -S");
    if (o->errors && strpbrk(o->errors, "=:"))
        return rad_fail(err, RAD_EUSAGE,
                        "option '-e': '%.40s' is an expression, and "
                        "definitions belong in the function files of the scene",
                        o->errors);
    if (o->params.motion > 0 && o->first_frame > 1)
        return rad_fail(err, RAD_EUSAGE,
                        "option '-pm' needs the view before the first: use "
                        "-S 1 and all views");
    if (o->fresh_frames && !o->first_frame)
        return rad_fail(err, RAD_EUSAGE, "--fresh-frames needs -S");
    if (o->no_clobber && !(o->first_frame && o->output))
        return rad_fail(err, RAD_EUSAGE, "--no-clobber needs -S and -o");
    if (o->dry_run && o->detach)
        return rad_fail(err, RAD_EUSAGE,
                        "--dry-run makes no job that --detach could leave");
    if ((rc = check_sharing(o, err)) < 0 || (rc = check_ambient(o, err)) < 0 ||
        (rc = check_reuse(o, err)) < 0 || (rc = check_goal(o, err)) < 0 ||
        (rc = rad_params_check(&o->params, err)) < 0 ||
        (rc = check_planes(o, err)) < 0)
        return rc;
    if (!o->first_frame) {
        struct rad_view v = o->view;

        return rad_view_setup(&v, err);
    }
    return 0;
}

int
submit_options_parse(struct submit_options *o, struct words *w,
                     struct rad_error *err)
{
    struct cursor c = { .o = o, .w = w, .err = err };
    int rc;

    set_defaults(o);
    rc = take_options(&c);
    if (rc >= 0 && o->points.file) { /* the same from rtrace's defaults on */
        set_defaults(o);
        pointspec_defaults(&o->params);
        c = (struct cursor){ .o = o, .w = w, .err = err };
        rc = take_options(&c);
    }
    if (rc >= 0 && o->quality < 0 && c.given == 0 && submit_options_goal(o)) {
        int bad = quality_first(&o->params, err);

        rc = bad < 0 ? bad : rc;
    }
    if (rc >= 0 && o->quality >= 0) {
        int bad = quality_apply(o->quality, c.given, &o->params, err);

        o->quality_whole = c.given == 0 && o->oversample == 0;

        rc = bad < 0 ? bad : rc;
    }
    if (rc != SUBMIT_RUN)
        return rc;
    rc = take_scenes(&c, c.at > 0 && strcmp(w->list[c.at - 1], "--") == 0);
    if (rc == 0)
        rc = check_together(o, err);
    if (rc == 0)
        rc = count_samples(o, err);
    return rc < 0 ? rc : SUBMIT_RUN;
}

static void
print_line(void *to, const char *text)
{
    fprintf(to, "%s\n", text);
}

static void
help_rows(FILE *to, const struct option *table, size_t n, const char *between)
{
    for (size_t i = 0; i < n; i++) {
        char head[80];

        snprintf(head, sizeof head, "%s%s%s", table[i].name,
                 table[i].arg && table[i].kind != KIND_MAYBE ? between : "",
                 table[i].arg ? table[i].arg : "");
        rad_help_row(head, table[i].help, print_line, to);
    }
}

void
submit_options_help(FILE *to)
{
    fputs("usage: radsubmit [options] [rpict's options] scene.oct\n"
          "       radsubmit [options] [rpict's options] scene.rad ...\n"
          "       radsubmit [options] [rpict's options] room.rif "
          "[VARIABLE=value ...]\n"
          "       radsubmit [rpict's options] -defaults\n"
          "Render a Radiance scene on a cluster; with no coordinator named, "
          "on one of its\nown on this machine.\n\n",
          to);
    help_rows(to, own, N_ELEM(own), "=");
    fputs("  --seed=N                    of all random numbers (0)\n"
          "  --rpict-path                print the folder of a program "
          "rpict that calls\n"
          "                              radsubmit, for PATH\n"
          "  --help                      this text\n"
          "  --version                   the version\n\n"
          "rpict's options keep their meaning; radsubmit -defaults lists "
          "them with their\nvalues, radsubmit(1) explains them.  To them "
          "belong\n"
          "  -vf FILE                    view file; or -vp X Y Z, -vd X Y Z "
          "and others\n"
          "  -x N, -y N                  columns and rows at most (512)\n"
          "  -ab N                       bounces of indirect light (0: none)\n"
          "  -cs N                       bands of wavelengths, 3 to 24 (3: "
          "colours)\n"
          "  -co                         write them as spectra (-co+; for a name "
          "in .hsr),\n"
          "                              not as colours (-co-)\n",
          to);
    help_rows(to, rpicts, N_ELEM(rpicts), " ");
    fputs("  @FILE                       options from a file\n"
          "\n"
          "Examples:\n"
          "  radsubmit -vf eye.vf -x 1024 -y 768 --quality=medium "
          "-o room.hdr room.rad\n"
          "  radsubmit -S 1 --views=walk.vf -ab 2 -o walk%03d.png room.oct\n"
          "  radsubmit --view=entrance room.rif QUALITY=High\n"
          "  radsubmit --coordinator=render:7420 --detach -vf eye.vf "
          "room.oct\n",
          to);
}

void
submit_options_defaults(const struct submit_options *o, FILE *to)
{
    struct submit_options chosen = *o;
    char text[32];

    rad_view_print_defaults(&o->view, print_line, to);
    rad_params_print_defaults(&o->params, print_line, to);
    choose_oversample(&chosen);
    snprintf(text, sizeof text, "--oversample %d", chosen.oversample);
    fprintf(to, "%-31s # samples a side of a pixel\n", text);
    snprintf(text, sizeof text, "-t %d", o->report_s);
    fprintf(to, "%-31s # time between reports\n", text);
    fprintf(to, "%-31s # warning messages\n", o->quiet ? "-w-" : "-w+");
}
