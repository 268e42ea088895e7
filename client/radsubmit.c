/* radsubmit.c - render a Radiance scene on a cluster; see radsubmit(1)
 *
 * The course of a run: the command line (submit_options), the pictures that it
 * asks for (frames), and all checks that can be made before the work begins;
 * then the job (program_job). */
#include "config.h"

#include "program.h"

#include "job/apart.h"
#include "job/submit_parse.h"
#include "job/submit_table.h"
#include "link/launch.h"
#include "link/local.h"
#include "link/programs.h"
#include "base/output.h"
#include "common/tell.h"
#include "program_cluster.h"
#include "program_files.h"
#include "program_job.h"
#include "program_say.h"
#include "program_scene.h"
#include "program_stream.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sysexits.h>
#include <unistd.h>

/* -e: send standard error to a file from here on, as rpict does behind what the
 * file has: it may turn out to be a file of the scene. */
static int
open_errors(struct program *p)
{
    struct stat st;
    FILE *f;

    if (!p->o.errors)
        return 0;
    p->own_stderr = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    f = fopen(p->o.errors, "a");
    if (!f || fstat(fileno(f), &st) < 0 || dup2(fileno(f), STDERR_FILENO) < 0)
        return rad_fail(p->err, RAD_ECANTCREAT, "cannot create '%s': %s",
                        p->o.errors, strerror(errno));
    p->errors_before = st.st_size;
    fclose(f);
    return 0;
}

/* Could all of it be written to the file of -e?  If not, go back to the real
 * standard error. */
static int
check_errors(struct program *p)
{
    if (!p->o.errors || !ferror(stderr))
        return 0;
    dup2(p->own_stderr, STDERR_FILENO);
    return rad_fail(p->err, RAD_EIO, "cannot write '%s'", p->o.errors);
}

/* Set up the pictures; or the sensor points, as a picture. */
static int
init_frames(struct program *p)
{
    int rc;

    if (!p->o.points.file)
        return frames_init(&p->frames, &p->o, p->err);
    p->stream.is = strcmp(p->o.points.file, "-") == 0 && !p->o.dry_run &&
                   pointstream_is_one();
    if (p->stream.is)
        return program_check_stream(p);
    rc = pointjob_read(&p->points, &p->o.points, p->err);
    if (rc < 0)
        return rc;
    if (pointjob_is_short(&p->points))
        program_warn(p, "warning: fewer points than -x and -y say");
    return frames_init_points(&p->frames, p->points.width, p->points.height,
                              p->err);
}

/* Check all that can be checked before the work begins. */
static int
prepare(struct program *p)
{
    struct inputs *in = &p->words.inputs;
    int rc = apart_outputs(&p->o, p->err);

    if (rc == 0)
        rc = apart_note(in, &p->o, p->err);
    if (rc == 0)
        rc = apart_inputs(&p->o, NULL, in, p->err);
    if (rc == 0)
        rc = open_errors(p);
    if (rc < 0)
        return rc;
    progress_init(&p->progress, stderr,
                  p->o.detach ? PROGRESS_NEVER : p->o.progress);
    if (p->o.report_s > 0 && p->o.progress != PROGRESS_NEVER)
        progress_every(&p->progress, stderr, p->o.report_s);
    program_warn_of_options(p);
    program_warn_of_rif(p);
    p->planes.n = submit_options_planes(&p->o);
    if ((rc = program_cluster_choose(p)) < 0 ||
        (!p->rif.is && (rc = init_frames(p)) < 0) ||
        (rc = jobspec_check_goal(&p->o, p->frames.n, p->err)) < 0 ||
        (rc = jobspec_check_windows(&p->o, &p->frames, p->err)) < 0 ||
        (rc = inputs_add(in, "the key", p->cluster.target.key, p->err)) < 0 ||
        (rc = program_check_apart(p)) < 0 ||
        (rc = jobspec_read_costs(&p->job, &p->o, &p->frames, p->err)) < 0 ||
        (rc = program_check_outputs(p)) < 0)
        return rc;
    return program_check_ambient(p);
}

static int
name_job(struct jobspec *job, const char *id, struct rad_error *err)
{
    if (!id)
        return jobspec_name(job, err);
    msg_job_parse(id, job->id); /* checked by submit_check() */
    return 0;
}

static int
run(struct program *p)
{
    int rc = program_take_rif(p);

    if (rc == 0)
        rc = prepare(p);
    if (rc == 0 && p->rif.is && !p->o.dry_run) {
        rc = rifjob_prepare(&p->rif, &p->o, p->err);
        program_warn_of_rif(p);
    }
    if (rc == 0 && !p->loop.watched)
        rc = program_loop_init(&p->loop, p->err);
    if (rc == 0 && p->stream.is)
        rc = pointstream_open(&p->stream.input, &p->o.points, &p->loop.uv,
                              p->err);
    if (rc == 0 && !p->cluster.local)
        rc = local_new(&p->cluster.local, p->err);
    if (rc == 0 && p->frames.n == 0)
        program_warn(
            p, "the pictures of all frames are there: nothing is rendered");
    else if (rc == 0 && p->o.dry_run)
        rc = program_run_dry(p);
    else if (rc == 0 && (rc = name_job(&p->job, p->o.job, p->err)) == 0) {
        program_warn_of_rest(p);
        rc = program_run_job(p);
    }
    pointstream_close(&p->stream.input);
    launch_stop(p->cluster.launch);
    local_stop(p->cluster.local);
    cargo_release(&p->cargo);
    records_release(&p->records);
    compile_release(&p->scene);
    if (p->loop.watched && rc == 0) /* after an error main() ends all at once */
        program_loop_release(&p->loop);
    return rc;
}

static int
say_rpict_path(struct program *p)
{
    char path[PATH_MAX];

    if (!programs_rpict(path, sizeof path))
        return rad_fail(p->err, RAD_ENOINPUT,
                        "the program rpict is not there, neither beside "
                        "radsubmit nor in " RADD_LIBEXECDIR);
    puts(path);
    return 0;
}

static int
act(struct program *p, int argc, char *argv[])
{
    int rc = words_init(&p->words, argc, argv, p->err);

    if (rc == 0)
        rc = submit_parse(&p->o, &p->words, p->err);
    switch (rc) {
    case SUBMIT_RUN:
        rc = run(p);
        break;
    case SUBMIT_HELP:
        submit_table_help(stdout);
        break;
    case SUBMIT_VERSION:
        puts("radsubmit (radd) " PACKAGE_VERSION);
        break;
    case SUBMIT_RPICT:
        rc = say_rpict_path(p);
        break;
    case SUBMIT_DEFAULTS:
        submit_options_defaults(&p->o, stdout);
        break;
    }
    if (rc >= 0 && (rc = tell_printed(p->err)) == 0)
        rc = check_errors(p);
    if (rc < 0) /* main() ends the program, and may still tell of all this */
        return rc;
    jobspec_release(&p->job);
    frames_release(&p->frames);
    pointjob_release(&p->points);
    words_release(&p->words);
    rifjob_release(&p->rif);
    return rc;
}

int
main(int argc, char *argv[])
{
    struct rad_error err = { 0 };
    struct program p = { .err = &err };
    char text[600];
    int rc;

    rad_output_guard();
    rc = act(&p, argc, argv);
    if (rc == 0)
        return EX_OK;
    rad_error_format(&err, text, sizeof text);
    program_loop_free_for_message(&p.loop);
    fprintf(stderr, "radsubmit: %s\n", text);
    program_say_where_it_is(&p);
    fflush(stdout);
    /* not exit(): libuv would wait until a name is looked up */
    _exit(program_status(&p, rc));
}
