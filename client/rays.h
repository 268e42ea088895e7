/* rays.h - `radscene rays`: what single rays see
 *
 *   radscene rays [-I] [-af FILE] [rendering options] FILE...
 * Each line of the input has six numbers, a ray's origin and direction, or with
 * -I a point and a normal; each gives a line of output, its radiance
 * [W/sr/m^2] or irradiance [W/m^2], as "r g b" with nine significant digits;
 * with -co+ as one number for each of the bands of -cs, the longest waves
 * first. What has no direction sees 0 0 0, as with rtrace; empty lines are
 * skipped. A ray's random numbers depend on --seed and the ray's number, from
 * 0.  */
#ifndef RADD_CLIENT_RAYS_H
#define RADD_CLIENT_RAYS_H

#include "base/files.h"
#include "base/params.h"
#include "scene/scene.h"
#include "trace/job.h"
#include "common/words.h"

#include <stdbool.h>
#include <stdio.h>

struct rays_options {
    struct rad_params params;
    bool irradiance;     /* -I */
    bool spectral;       /* -co+ */
    bool commands;       /* of octrees are run, too */
    const char *ambfile; /* -af, a word of the command line, or NULL */
};

/* Take the options at the front of w, opening @file words.  Returns where the
 * files begin in w->list, or RAD_EUSAGE for an option that is wrong or unknown
 * and for no file. */
int rays_options(struct rays_options *o, struct words *w,
                 struct rad_error *err);

/* Trace what `in` has.  The scene is checked; `files` are those it needs.
 * `faults` gets which of its objects' functions had no value (trace/job.h).
 * With -af the file's records are read first, and after the last ray written
 * with those that were made; digest, compile_digest()'s, is needed for it
 * alone. RAD_EDATA with "stdin:LINE" for a line that is not six finite numbers,
 * RAD_EIO, or why the scene cannot be rendered. */
int rays_run(const struct rays_options *o, const struct rad_scene *scene,
             const struct rad_files *files, FILE *in, FILE *out,
             const char *digest, struct rad_fault faults[RAD_MAX_FAULTS],
             struct rad_error *err);

#endif
