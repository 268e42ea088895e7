/* program_files.c - the files that radsubmit writes, and checks of them; see
 * program_files.h */
#include "config.h"

#include "program_files.h"

#include "job/apart.h"
#include "show/expose.h"
#include "base/output.h"
#include "image/edge.h"
#include "show/picfile.h"
#include "link/rescue.h"
#include "common/tell.h"
#include "trial/dryrun.h"
#include "program_say.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Write a file of n bytes. */
static int
write_file(struct program *p, const char *path, const void *bytes, size_t n,
           struct rad_error *err)
{
    int rc;

    program_loop_free_signals(&p->loop, path);
    rc = rad_output_write(path, bytes, n, !p->cluster.embedded, err);
    program_loop_catch_signals(&p->loop);
    return rc;
}

/* --- pictures --- */

static int
write_picture(struct program *p, uint32_t frame, const uint8_t *picture,
              size_t len, struct rad_error *err)
{
    struct picfile to = { .format = (enum picfile_format)p->o.format,
                          .durable = !p->cluster.embedded };
    char *name = NULL;
    uint8_t *exposed = NULL;
    int rc = 0;

    if (p->o.output)
        rc = frames_name(&p->frames, &p->o, p->o.output, frame, &name, err);
    if (rc == 0 && p->rif.exposure > 0 && p->rif.exposure != 1 &&
        !submit_options_spectra(&p->o) && !picfile_is_png(name, to.format)) {
        rc = expose(picture, len, p->rif.exposure, &exposed, &len, err);
        picture = exposed;
    }
    if (rc == 0) {
        program_loop_free_signals(&p->loop, name);
        to.path = name;
        rc = picfile_write(&to, picture, len, &p->o.show, err);
        program_loop_catch_signals(&p->loop);
    }
    free(exposed);
    free(name);
    return rc;
}

static int
write_depth(struct program *p, uint32_t frame,
            const struct rad_memory_out *depth, struct rad_error *err)
{
    char *name = NULL;
    int rc = frames_name(&p->frames, &p->o, p->o.depth, frame, &name, err);

    if (rc == 0)
        rc = write_file(p, name, depth->bytes, depth->len, err);
    free(name);
    return rc;
}

/* Note whether a preview was written.  A failure does not stop the job: the
 * first one is warned of, and the last preview decides about the exit status.
 */
static void
note_preview(struct program *p, const struct rad_error *why)
{
    bool warned = p->preview.warned;
    char text[sizeof *why + 80];
    int n;

    p->preview.why = *why;
    p->preview.warned |= why->code != 0;
    if (why->code == 0 || warned)
        return;
    n = snprintf(text, sizeof text,
                 "warning: no preview, but the job goes on: ");
    rad_error_format(why, text + n, sizeof text - (size_t)n);
    program_warn(p, text);
}

int
program_on_preview(void *arg, const uint8_t *picture, size_t len,
                   struct rad_error *err)
{
    struct program *p = arg;
    struct rad_error why = { 0 };

    (void)err;
    program_loop_free_signals(&p->loop, p->o.preview);
    picfile_preview(p->o.preview, picture, len, &p->o.show, &p->preview.last,
                    &why);
    program_loop_catch_signals(&p->loop);
    note_preview(p, &why);
    return 0;
}

void
program_show_whole(struct program *p, const uint8_t *picture, size_t len)
{
    const struct picfile to = { p->o.preview, PICFILE_PNG, .durable = false };
    struct rad_error why = { 0 };

    program_loop_free_signals(&p->loop, p->o.preview);
    picfile_write(&to, picture, len, &p->o.show, &why);
    program_loop_catch_signals(&p->loop);
    note_preview(p, &why);
    memset(&p->preview.last, 0, sizeof p->preview.last);
}

/* Save what could not be written, for our own cluster keeps nothing.  picture
 * NULL: it was written. */
static void
rescue(struct program *p, uint32_t frame, const struct rad_memory_out *picture,
       const struct rad_memory_out *depth)
{
    const char *suffix = submit_options_spectra(&p->o) ? ".hsr" : ".hdr";

    if (picture)
        p->rescue.picture =
            rescue_write(p->job.id, frame, suffix, picture->bytes,
                         rad_edge_begin(picture->bytes, picture->len));
    if (depth->bytes)
        p->rescue.depth =
            rescue_write(p->job.id, frame, ".zbf", depth->bytes, depth->len);
}

void
program_fill_text(struct program *p)
{
    p->text = (struct pointwriter_text){ .origin = p->job.spec.origin,
                                         .params = &p->o.params,
                                         .spectral = p->o.spectral > 0,
                                         .scene = &p->scene };
}

struct to_write {
    const struct program *p;
    const struct pointwriter_light *light;
};

static int
write_points(void *arg, const char *path, struct rad_error *err)
{
    const struct to_write *w = arg;

    return pointwriter_all(&w->p->points, &w->p->text, w->light, path,
                           !w->p->cluster.embedded, err);
}

int
program_write_points(struct program *p, const struct pointwriter_light *light,
                     struct rad_error *err)
{
    struct to_write w = { p, light };
    int rc;

    if (!p->stream.is)
        program_fill_text(p);
    program_loop_free_signals(&p->loop, p->o.output);
    rc = p->stream.is
             ? pointwriter_put(p->stream.writer, &p->points, light, err)
             : write_points(&w, p->o.output, err);
    program_loop_catch_signals(&p->loop);
    if (p->stream.is)
        return rc;
    if (rc < 0 && rc != RAD_EPROTO && light->n > 0)
        p->rescue.picture = rescue_by(p->job.id, 0, ".pts", write_points, &w);
    p->rescue.needed = rc < 0 && light->n > 0;
    return rc;
}

int
program_on_frame(void *arg, uint32_t frame,
                 const struct rad_memory_out *picture,
                 const struct rad_memory_out *depth, struct rad_error *err)
{
    struct program *p = arg;
    bool there; /* the picture was written */
    int rc;

    progress_clear(&p->progress); /* stdout may be the same terminal */
    if (p->o.points.file) {
        struct pointwriter_light light = { { depth->bytes }, 1, depth->len };

        return program_write_points(p, &light, err);
    }
    rc = write_picture(p, frame, picture->bytes, picture->len, err);
    there = rc == 0;
    if (p->result.light != LIGHT_SOME && !submit_options_spectra(&p->o))
        p->result.light = expose_nothing(picture->bytes, picture->len)
                              ? LIGHT_NONE
                              : LIGHT_SOME;
    if (rc == 0 && depth->bytes)
        rc = write_depth(p, frame, depth, err);
    p->rescue.needed = rc < 0;
    if (p->rescue.needed && p->cluster.embedded)
        rescue(p, frame, there ? NULL : picture, depth);
    if (rc == 0 && p->o.preview && !submit_options_spectra(&p->o))
        program_show_whole(p, picture->bytes, picture->len);
    return rc;
}

void
program_say_where_it_is(const struct program *p)
{
    const char *with = program_lone_plane(p);
    char hex[MSG_JOB_HEX];

    if (p->rescue.picture)
        tell(stderr, "radsubmit: the %s in %s",
             p->o.points.file ? "values are" : "picture is", p->rescue.picture);
    if (p->rescue.depth)
        tell(stderr, "radsubmit: its distances are in %s", p->rescue.depth);
    if (!p->rescue.needed || p->cluster.embedded)
        return;
    if (p->planes.n > 1 && !p->o.points.file) {
        tell(stderr, "radsubmit: the coordinator keeps the planes: radctl "
                     "fetch -o FILE with all of the jobs above");
        return;
    }
    msg_job_format(p->job.id, hex);
    if (p->o.points.file) {
        if (!p->stream.is && p->planes.n == 0)
            tell(stderr,
                 "radsubmit: the coordinator keeps the values: submit again "
                 "with --job=%s",
                 hex);
        return;
    }
    fprintf(stderr,
            "radsubmit: the coordinator keeps %s: radctl fetch %s%s -o "
            "FILE%s\n",
            p->frames.n > 1 ? "the pictures" : "the picture", hex,
            with ? with : "", p->frames.n > 1 ? " --frame=N" : "");
}

int
program_on_stats(void *arg, const uint8_t *json, size_t len,
                 struct rad_error *err)
{
    struct program *p = arg;

    if (submit_options_goal(&p->o))
        program_note_goal(&p->result.goal, json, len);
    return p->o.stats ? write_file(p, p->o.stats, json, len, err) : 0;
}

int
program_write_stats(struct program *p, char *json)
{
    int rc = json ? write_file(p, p->o.stats, json, strlen(json), p->err)
                  : rad_fail_memory(p->err);

    free(json);
    return rc;
}

int
program_write_stats_of_none(struct program *p)
{
    if (!p->o.stats)
        return 0;
    return program_write_stats(p, dryrun_json_of_none(&p->job.spec));
}

/* Check the -af file: does the job have records, and can the file be written?
 * As with rpict, a file that cannot be written is only read. */
int
program_check_ambient(struct program *p)
{
    const char *path = p->o.ambient;
    char text[600];

    if (!path)
        return 0;
    if (p->o.params.ambounce <= 0 || p->o.params.ambacc <= 0) {
        program_warn(
            p, "warning: -af: there are no ambient values to keep without "
               "-ab and -aa");
        p->o.ambient = NULL;
        return 0;
    }
    p->records.keep = !p->o.detach && !p->o.dry_run;
    if (p->o.detach)
        program_warn(
            p, "warning: -af: the file is read, but nobody waits to add to "
               "it");
    if (!p->records.keep || access(path, W_OK) == 0)
        return 0;
    if (errno == ENOENT)
        return rad_output_check(path, p->err);
    if (access(path, R_OK) == 0) {
        snprintf(text, sizeof text,
                 "warning: -af: '%.400s' may only be read: it is not added to",
                 path);
        program_warn(p, text);
        p->records.keep = false;
    }
    return 0;
}

/* Check that the file can be written, before anything is rendered for it. */
static int
check_output(const char *path, struct rad_error *err)
{
    return path ? rad_output_check(path, err) : 0;
}

/* Check the files of all frames, for a number or a view's name in the pattern
 * may lead to another folder. */
static int
check_frames(const struct program *p, const char *pattern)
{
    int rc = 0;

    for (uint32_t i = 0; pattern && rc == 0 && i < p->frames.n; i++) {
        char *name = NULL;

        rc = frames_name(&p->frames, &p->o, pattern, i, &name, p->err);
        if (rc == 0)
            rc = check_output(name, p->err);
        free(name);
    }
    return rc;
}

static int
check_formats(const struct submit_options *o, struct rad_error *err)
{
    int rc = 0;

    if (o->points.file)
        return 0;
    if (o->output && o->format == PICFILE_BY_SUFFIX)
        rc = picfile_check(o->output, false, err);
    if (rc == 0 && o->preview)
        rc = picfile_check(o->preview, true, err);
    return rc;
}

int
program_check_outputs(const struct program *p)
{
    int rc;

    if ((rc = check_formats(&p->o, p->err)) < 0)
        return rc;
    if ((rc = check_frames(p, p->o.output)) < 0 ||
        (rc = check_frames(p, p->o.depth)) < 0 ||
        (rc = check_output(p->o.preview, p->err)) < 0 ||
        (rc = check_output(p->o.stats, p->err)) < 0)
        return rc;
    if (!p->o.output && !p->o.detach && !p->o.dry_run && !p->o.points.file &&
        isatty(1))
        return rad_fail(p->err, RAD_EUSAGE,
                        "standard output is a terminal: use -o");
    return 0;
}

int
program_check_apart(struct program *p)
{
    const struct inputs *in = &p->words.inputs;
    int rc = apart_inputs(&p->o, &p->frames, in, p->err);

    if (rc < 0 && p->own_stderr > 0 && inputs_find(in, p->o.errors) &&
        ftruncate(STDERR_FILENO, p->errors_before) == 0)
        dup2(p->own_stderr, STDERR_FILENO);
    return rc;
}
