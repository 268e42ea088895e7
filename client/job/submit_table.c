/* submit_table.c - see submit_table.h
 *
 * One table has radsubmit's own options, another those of rpict that name
 * files. */
#include "config.h"

#include "job/submit_table.h"
#include "common/option.h"
#include "job/quality.h"

#include "image/filter.h"
#include "base/list.h"

#include <limits.h>
#include <stddef.h>

/* ranges of --error [%] and --time [s] */
#define LEAST_ERROR .1
#define LEAST_TIME  .1
#define MOST_TIME   1e6

enum { MOST_WORKERS = 4096, MOST_THREADS = 1024, MOST_WINDOWS = 1 << 20 };

/* clang-format off */
#define FIELD(f) offsetof(struct submit_options, f)
#define FLAG(name, f, help) \
    { name, OPTION_FLAG, FIELD(f), 0, help, 0, 0, 0, 0 }
#define TEXT(name, f, arg, help) \
    { name, OPTION_TEXT, FIELD(f), arg, help, 0, 0, 0, 0 }
#define MAYBE(name, f, arg, help) \
    { name, OPTION_MAYBE, FIELD(f), arg, help, 0, 0, 0, 0 }
#define INT(name, f, lo, hi, arg, help) \
    { name, OPTION_INT, FIELD(f), arg, help, lo, hi, 0, 0 }
#define REAL(name, f, lo, hi, arg, help) \
    { name, OPTION_REAL, FIELD(f), arg, help, lo, hi, 0, 0 }
#define WORD(name, f, words, help) \
    { name, OPTION_WORD, FIELD(f), words, help, 0, 0, words, 0 }
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

int
submit_table_take(struct submit_options *o, char *const argv[],
                  struct rad_error *err)
{
    const struct option *opt = option_find(own, N_ELEM(own), argv[0]);

    if (!opt)
        opt = option_find(rpicts, N_ELEM(rpicts), argv[0]);
    return opt ? option_take(opt, o, argv, err) : 0;
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
    option_help(own, N_ELEM(own), to);
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
    option_help(rpicts, N_ELEM(rpicts), to);
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
