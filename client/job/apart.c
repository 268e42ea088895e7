/* apart.c - see apart.h */
#include "config.h"

#include "job/apart.h"

#include "base/output.h"
#include "link/target.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct out {
    const char *option, *path; /* path NULL: this output is not asked for */
    bool of_frame;             /* each frame has its own file */
};

enum { NOUT = 6 };

static void
list_outputs(const struct submit_options *o, struct out out[NOUT])
{
    const struct out list[NOUT] = {
        { "-o", o->output, true },      { "-z", o->depth, true },
        { "--stats", o->stats, false }, { "--preview", o->preview, false },
        { "-af", o->ambient, false },   { "-e", o->errors, false }
    };

    memcpy(out, list, sizeof list);
}

int
apart_note(struct inputs *in, const struct submit_options *o,
           struct rad_error *err)
{
    int rc = 0;

    for (int i = 0; i < o->nscenes && rc == 0; i++)
        rc = strcmp(o->scenes[i], "-") == 0
                 ? inputs_add_fd(in, "the scene", STDIN_FILENO, err)
                 : inputs_add(in, "the scene", o->scenes[i], err);
    if (rc == 0 && o->first_frame > 0 && !o->views)
        rc = inputs_add_fd(in, "the file of views", STDIN_FILENO, err);
    if (rc == 0)
        rc = inputs_add(in, "the file of views", o->views, err);
    if (rc == 0 && o->points.file && strcmp(o->points.file, "-") == 0)
        rc = inputs_add_fd(in, "the file of points", STDIN_FILENO, err);
    else if (rc == 0)
        rc = inputs_add(in, "the file of points", o->points.file, err);
    if (rc == 0)
        rc = inputs_add(in, "the file of --estimate", o->costs, err);
    if (rc == 0)
        rc = inputs_add(in, "the key", o->key, err);
    return rc == 0 ? target_note(in, err) : rc;
}

int
apart_outputs(const struct submit_options *o, struct rad_error *err)
{
    struct out out[NOUT];

    list_outputs(o, out);
    for (int i = 0; i < NOUT; i++)
        for (int k = 0; out[i].path && k < i; k++)
            if (out[k].path && rad_output_same(out[k].path, out[i].path))
                return rad_fail(err, RAD_EUSAGE,
                                "'%s': %s and %s cannot go to one file",
                                out[i].path, out[k].option, out[i].option);
    return 0;
}

static int
check_name(const char *option, const char *path, const struct inputs *in,
           struct rad_error *err)
{
    const char *what = inputs_find(in, path);

    if (!what)
        return 0;
    return rad_fail(err, RAD_EUSAGE, "'%s' is %s: %s would change it", path,
                    what, option);
}

static int
check_frames(const struct out *out, const struct submit_options *o,
             const struct frames *frames, const struct inputs *in,
             struct rad_error *err)
{
    int rc = 0;

    for (uint32_t i = 0; i < frames->n && rc == 0; i++) {
        char *name = NULL;

        rc = frames_name(frames, o, out->path, i, &name, err);
        if (rc == 0)
            rc = check_name(out->option, name, in, err);
        free(name);
    }
    return rc;
}

int
apart_inputs(const struct submit_options *o, const struct frames *frames,
             const struct inputs *in, struct rad_error *err)
{
    struct out out[NOUT];
    int rc = 0;

    list_outputs(o, out);
    for (int i = 0; i < NOUT && rc == 0; i++) {
        if (!out[i].path)
            continue;
        if (out[i].of_frame &&
            (o->first_frame > 0 || (frames && frames->names)))
            rc = frames ? check_frames(&out[i], o, frames, in, err) : 0;
        else
            rc = check_name(out[i].option, out[i].path, in, err);
    }
    return rc;
}
