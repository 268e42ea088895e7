/* submit_table.c - see submit_table.h
 *
 * One table has radsubmit's own options, another those of rpict that name
 * files.  An option's row has the kind of its value, the field that it sets and
 * its text for --help. */
#include "config.h"

#include "job/submit_table.h"
#include "common/tell.h"
#include "common/words.h"
#include "job/quality.h"

#include "base/help.h"
#include "image/filter.h"
#include "base/list.h"
#include "base/number.h"

#include <limits.h>
#include <stddef.h>
#include <string.h>

enum kind {
    KIND_FLAG,  /* bool */
    KIND_TEXT,  /* const char * */
    KIND_MAYBE, /* as KIND_TEXT; "" if no '=' follows */
    KIND_INT,   /* int, lo..hi */
    KIND_REAL,  /* double, lo..hi */
    KIND_WORD   /* int: index of the word in `words` */
};

struct option {
    const char *name;
    enum kind kind;
    size_t field; /* offset in struct submit_options */
    double lo, hi;
    const char *words; /* for KIND_WORD: "auto|window" */
    const char *arg;   /* name of the value in --help */
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

/* ranges of --error [%] and --time [s] */
#define LEAST_ERROR .1
#define LEAST_TIME  .1
#define MOST_TIME   1e6

enum { MOST_WORKERS = 4096, MOST_THREADS = 1024, MOST_WINDOWS = 1 << 20 };

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
         "or the scene, 3 after a signal, 2 for all else; no news without -t")
};

static const struct option rpicts[] = {
    TEXT("-o", output, "FILE", "the picture (standard output)"),
    TEXT("-z", depth, "FILE", "distances, as floats"),
    TEXT("-af", ambient, "FILE", "ambient values, read and added to"),
    INT("-S", first_frame, 1, INT_MAX, "N", "animation, first frame's number"),
    INT("-t", report_s, 0, INT_MAX, "S", "seconds between progress reports"),
    TEXT("-e", errors, "FILE", "errors and progress reports, for stderr")
};
/* clang-format on */

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

/* Take the option at argv[0]; its value follows a '=', or is the next word. */
static int
take_from(struct submit_options *o, const struct option *table, size_t n,
          char *const argv[], struct rad_error *err)
{
    const char *word = argv[0];
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
        return rad_fail(err, RAD_EUSAGE, "option '%s' takes no value",
                        opt->name);
    if (opt->kind == KIND_MAYBE && !value)
        value = "";
    if (opt->kind != KIND_FLAG && !value) {
        value = argv[1];
        used = 2;
        if (!value)
            return rad_fail(err, RAD_EUSAGE, "option '%s': missing value",
                            opt->name);
    }
    rc = take_value(o, opt, value, err);
    return rc < 0 ? rc : used;
}

int
submit_table_take(struct submit_options *o, char *const argv[],
                  struct rad_error *err)
{
    if (strncmp(argv[0], "--", 2) == 0)
        return take_from(o, own, N_ELEM(own), argv, err);
    if (strchr(argv[0], '=')) /* rpict has no "-o=FILE" */
        return 0;
    return take_from(o, rpicts, N_ELEM(rpicts), argv, err);
}

static void
help_rows(FILE *to, const struct option *table, size_t n, const char *between)
{
    for (size_t i = 0; i < n; i++) {
        char head[80];

        snprintf(head, sizeof head, "%s%s%s", table[i].name,
                 table[i].arg && table[i].kind != KIND_MAYBE ? between : "",
                 table[i].arg ? table[i].arg : "");
        rad_help_row(head, table[i].help, tell_line, to);
    }
}

void
submit_table_help(FILE *to)
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
    fputs(
        "  --samples=N                 rays of a pixel that is traced, for "
        "their mean (1)\n"
        "  --surroundings=N            how many times as large as what is "
        "shown the scene\n"
        "                              is (found)\n"
        "  --shown X Y Z RADIUS        a ball that holds what is shown "
        "(found)\n"
        "  --seed=N                    of all random numbers (0)\n"
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
