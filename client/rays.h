/* rays.h - `radscene rays`: what single rays see
 *
 *   radscene rays [-I] [-af FILE] [rendering options] FILE...
 * Each line of the input has six numbers: a ray's origin and direction, or with
 * -I a point and a normal.  For each a line is printed: its radiance [W/sr/m^2]
 * or irradiance [W/m^2], as "r g b" with nine significant digits; with -co+ as
 * a number for each band of -cs, from the longest waves on.  A ray without a
 * direction sees 0 0 0, as with rtrace; empty lines are skipped.  A ray's
 * random numbers depend on --seed and on the ray's number, from 0. */
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
    bool commands;       /* run commands of octrees, too */
    const char *ambfile; /* -af: a word of the command line; or NULL */
};

/* Take the options at the beginning of w, expanding @file words.  Returns the
 * index of the first file in w->list; RAD_EUSAGE: a wrong or unknown option, or
 * no file. */
int rays_options(struct rays_options *o, struct words *w,
                 struct rad_error *err);

/* What is traced. */
struct rays_scene {
    const struct rad_scene *scene; /* checked */
    const struct rad_files *files; /* that it needs */
    const char *digest;            /* compile_digest()'s; only for -af */
};

/* Trace the rays of `in`.  `faults` gets the objects whose functions failed
 * (trace/job.h).  With -af the file's records are read first, and written after
 * the last ray with those that were made.
 * RAD_EDATA with "stdin:LINE": a line is not six finite numbers; RAD_EIO; or
 * why the scene cannot be rendered. */
int rays_run(const struct rays_options *o, const struct rays_scene *s, FILE *in,
             FILE *out, struct rad_fault faults[RAD_MAX_FAULTS],
             struct rad_error *err);

#endif
