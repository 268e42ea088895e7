/* submit_check.c - see submit_check.h */
#include "config.h"

#include "job/submit_check.h"
#include "job/submit_pairs.h"
#include "link/launch.h"
#include "proto/message.h"
#include "show/picfile.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_LOCAL = 64 }; /* most --workers of --local */

/* Is it "20a" or the like: random pixels of each area, and how they count? */
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

static bool
is_dash(const char *name)
{
    return name && strcmp(name, "-") == 0;
}

/* "-" means standard output, for the picture alone; a scene may come from "-",
 * too.  With --detach the coordinator keeps a picture with a header in any
 * case. */
static int
check_outputs(struct submit_options *o, struct rad_error *err)
{
    if (is_dash(o->depth) || is_dash(o->stats) || is_dash(o->preview))
        return rad_fail(err, RAD_EUSAGE,
                        "'-' is a name for -o alone, not for -z, --stats or "
                        "--preview");
    if (is_dash(o->output))
        o->output = NULL;
    if (o->stamp && !o->detach &&
        picfile_is_png(o->output, (enum picfile_format)o->format))
        return rad_fail(err, RAD_EUSAGE,
                        "--stamp: a .png has no header that could hold it");
    return 0;
}

/* Options for a .png are an error if none is written. */
static int
check_show(struct submit_options *o, struct rad_error *err)
{
    struct show_asked asked = { o->tone >= 0, o->bits >= 0, o->exposure,
                                o->false_colour };
    const char *given;
    int rc = show_first(&asked, &given, err);

    if (rc < 0)
        return rc;
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
    return show_take(&o->show, &asked, err);
}

/* Settle the samples of a pixel.  From here on -x and -y count samples, as they
 * do in the job. */
static int
count_samples(struct submit_options *o, struct rad_error *err)
{
    int n, most;
    bool wide;

    submit_options_samples(o);
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

static int
check_planes(const struct submit_options *o, struct rad_error *err)
{
    bool spectra = submit_options_spectra(o);

    if (submit_options_planes(o) == 0)
        return submit_options_hsr(o)
                   ? rad_fail(err, RAD_EUSAGE,
                              "'%s': spectra have more than three bands: "
                              "use -cs N",
                              o->output)
                   : 0;
    if (submit_options_hsr(o) && !spectra)
        return rad_fail(err, RAD_EUSAGE,
                        "'%s' is a name for spectra, and -co- asks for none",
                        o->output);
    if (spectra && picfile_is_png(o->output, (enum picfile_format)o->format))
        return rad_fail(err, RAD_EUSAGE, "-co+: a .png has no spectra");
    if (spectra && o->params.primaries != RAD_PRIM_RGB)
        return rad_fail(err, RAD_EUSAGE, "-co+ and -pXYZ exclude each other");
    if (o->detach && o->params.primaries == RAD_PRIM_XYZ)
        return rad_fail(
            err, RAD_EUSAGE,
            "-cs above 3 with --detach and -pXYZ: radctl fetch puts "
            "planes together in red, green and blue");
    if (!spectra && !rad_bands_show_colour(&o->params.bands))
        return rad_fail(err, RAD_EUSAGE,
                        "option '-cw': %g to %g nm show no colours: use -co+",
                        o->params.bands.shortest, o->params.bands.longest);
    return 0;
}

/* A goal refines the ambient cache, in passes: indirect light is needed. */
static int
check_goal(const struct submit_options *o, struct rad_error *err)
{
    const char *goal = o->error > 0 ? "--error" : "--time";

    if (submit_options_goal(o) &&
        (o->params.ambounce <= 0 || o->params.ambacc <= 0 ||
         o->params.ambdiv <= 0))
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

    if (o->reuse && strcmp(o->reuse, "last") != 0 &&
        !msg_job_parse(o->reuse, job))
        return rad_fail(err, RAD_EUSAGE,
                        "option '--reuse': '%.40s' is neither a job's id, of "
                        "%d digits, nor 'last'",
                        o->reuse, MSG_JOB_HEX - 1);
    return 0;
}

/* Sensor points are a picture without a view, each pixel of which is traced. */
static int
check_points(struct submit_options *o, struct rad_error *err)
{
    int rc = pointspec_check(&o->points, err);
    uint8_t id[MSG_JOB];

    if (o->job && !msg_job_parse(o->job, id))
        return rad_fail(err, RAD_EUSAGE,
                        "option '--job': '%.40s' is no job's id, of %d digits",
                        o->job, MSG_JOB_HEX - 1);

    if (rc < 0 || !o->points.file)
        return rc;
    if ((o->detach || o->job) &&
        (!pointspec_lit(&o->points) || submit_options_planes(o) > 0))
        return rad_fail(err, RAD_EUSAGE,
                        "%s is for one job: not for -o letters that need no "
                        "light, nor for more than three bands (-cs) of points",
                        o->detach ? "--detach" : "--job");
    if (picfile_is_png(o->output, PICFILE_BY_SUFFIX))
        return rad_fail(err, RAD_EUSAGE,
                        "'%s': --points makes no picture: -fac with -x and -y "
                        "writes colours for a .hdr",
                        o->output);
    for (int i = 0; i < o->nscenes; i++)
        if (is_dash(o->points.file) && is_dash(o->scenes[i]))
            return rad_fail(err, RAD_EUSAGE,
                            "standard input cannot hold both scene and points");
    o->params.psample = o->oversample = 1;
    return 0;
}

static int
check_cluster(const struct submit_options *o, struct rad_error *err)
{
    char dial[LAUNCH_ADDRESS], listen[LAUNCH_ADDRESS];

    if (o->launch && strspn(o->launch, " \t\n") == strlen(o->launch))
        return rad_fail(err, RAD_EUSAGE, "--launch: expected a command");
    if (!o->launch && o->workers > MOST_LOCAL)
        return rad_fail(err, RAD_EUSAGE,
                        "option '--workers': at most %d on one machine",
                        MOST_LOCAL);
    return o->address ? launch_address(o->address, dial, listen, err) : 0;
}

static int
check_together(struct submit_options *o, struct rad_error *err)
{
    int rc = check_estimate(o, err);

    if (rc < 0 || (rc = submit_pairs_check(o, false, err)) < 0 ||
        (rc = check_points(o, err)) < 0 || (rc = check_outputs(o, err)) < 0 ||
        (rc = check_show(o, err)) < 0 || (rc = check_cluster(o, err)) < 0)
        return rc;
    if (o->name && strlen(o->name) > MSG_MAX_LABEL)
        return rad_fail(
            err, RAD_EUSAGE,
            "option '--name': %zu bytes, and at most %d are allowed",
            strlen(o->name), MSG_MAX_LABEL);
    if (o->errors && strpbrk(o->errors, "=:"))
        return rad_fail(err, RAD_EUSAGE,
                        "option '-e': '%.40s' is an expression, and "
                        "definitions belong in the function files of the scene",
                        o->errors);
    if (o->params.motion > 0 && o->first_frame > 1)
        return rad_fail(err, RAD_EUSAGE,
                        "option '-pm' needs the view before the first: use "
                        "-S 1 and all views");
    if ((rc = check_reuse(o, err)) < 0 || (rc = check_goal(o, err)) < 0 ||
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
submit_check(struct submit_options *o, struct rad_error *err)
{
    int rc = check_together(o, err);

    return rc == 0 ? count_samples(o, err) : rc;
}
