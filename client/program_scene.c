/* program_scene.c - the scene that is compiled; see program_scene.h */
#include "config.h"

#include "program_scene.h"

#include "job/submit_pairs.h"
#include "compile/command.h"
#include "trial/dryrun.h"
#include "link/local.h"
#include "program_files.h"
#include "program_say.h"

#include <stdlib.h>
#include <unistd.h>

/* --dry-run: predict the job. */
static int
try_scene(struct program *p)
{
    struct rad_params params = p->o.params;
    struct rad_points points;
    struct dryrun_job job = { .scene = p->scene.scene,
                              .files = compile_files(&p->scene),
                              .params = &params,
                              .frames = p->frames.list,
                              .nframes = p->frames.n,
                              .passes = jobspec_passes(&p->o),
                              .oversample = p->o.oversample };
    uint8_t *bytes = NULL;
    int rc = 0;

    if (p->planes.n > 1) /* each plane takes about as much as the first */
        params.bands.plane = 0;
    if (p->o.points.file)
        rc = pointjob_pack(&p->points, &points, &bytes, p->err);
    if (bytes)
        job.points = &points;
    if (rc == 0)
        rc = dryrun_predict(&p->prediction, &job, p->err);
    if (rc == 0)
        trial_repeat(&p->prediction, program_jobs(p));
    free(bytes);
    return rc;
}

/* A scene without spectra needs one plane for all bands. */
static void
settle_bands(struct program *p)
{
    if (p->planes.n == 0 || rad_scene_spectrum(p->scene.scene))
        return;
    p->o.params.bands.plane = RAD_PLANE_COLOURS;
    p->planes.n = 1;
}

/* Is the place of what is shown to be found? */
static bool
lacks_place(const struct program *p)
{
    const struct rad_params *q = &p->o.params;

    return q->surroundings > 1 && !(q->shown[3] > 0) && !p->o.ambient;
}

/* Find how large what is shown is, and where it is, unless these were given. */
static int
find_surroundings(struct program *p)
{
    struct rad_params *q = &p->o.params;
    struct surroundings_of of = { p->frames.list, p->frames.n, NULL };
    struct rad_points points;
    struct surroundings s;
    uint8_t *bytes = NULL;
    int rc = 0;

    if (p->o.points.file) {
        rc = pointjob_pack(&p->points, &points, &bytes, p->err);
        of.points = bytes ? &points : NULL;
    }
    if (rc == 0)
        rc = surroundings_find(&s, p->scene.scene, &of, p->err);
    if (rc == 0 && q->surroundings == 0) {
        p->surroundings = s;
        if (!p->o.ambient)
            q->surroundings = surroundings_times(&s);
    }
    if (rc == 0 && lacks_place(p))
        rc = surroundings_place(&s, &of, q->shown, p->err);
    free(bytes);
    return rc;
}

/* Find how much larger the scene is than what is shown, and where that is,
 * unless these were given; then -ar, unless it was given, goes by what is
 * shown.  A file of ambient values serves views of all sizes: for it nothing is
 * found but a warning. */
static int
settle_surroundings(struct program *p)
{
    struct rad_params *q = &p->o.params;
    int rc = 0;

    if ((p->frames.n == 0 && !p->stream.is) || !submit_options_cache(&p->o))
        return 0;
    if (!p->stream.is && (q->surroundings == 0 || lacks_place(p)))
        rc = find_surroundings(p);
    if (!p->o.ambres_given)
        q->ambres = surroundings_ambres(q->surroundings, q->ambres);
    return rc;
}

/* Refuse options that jobs of several planes cannot have. */
static int
check_planes(struct program *p)
{
    struct rad_error why = { 0 };
    int rc = p->planes.n > 1 ? submit_pairs_check(&p->o, true, &why) : 0;

    return rc == 0 ? 0
                   : rad_scene_fail(p->scene.scene,
                                    rad_scene_spectrum(p->scene.scene), p->err,
                                    rc, "%s", why.what);
}

/* What program_compile() shares with its thread. */
struct compiling {
    struct program *p;
    bool done;
    int rc;
};

static void
compile_work(uv_work_t *w)
{
    struct compiling *c = w->data;
    struct program *p = c->p;
    struct compile_from from = { (const char *const *)p->o.scenes, p->o.nscenes,
                                 p->o.commands };
    uint64_t begin = uv_hrtime();

    if (!p->scene.scene) {
        c->rc = compile_scene(&p->scene, &from, local_folder(p->cluster.local),
                              &p->words.inputs, p->err);
        p->compile_s = (double)(uv_hrtime() - begin) * 1e-9;
    }
    if (c->rc == 0) {
        settle_bands(p);
        c->rc = check_planes(p);
    }
    if (c->rc == 0)
        c->rc = settle_surroundings(p);
    if (c->rc == 0 && p->o.dry_run && p->frames.n > 0)
        c->rc = try_scene(p);
}

static void
compile_done(uv_work_t *w, int status)
{
    (void)status;
    ((struct compiling *)w->data)->done = true;
}

/* Say that the trial may take long: only with hemispheres of so many rays does
 * it take more than a few seconds. */
static void
say_of_trial(struct program *p)
{
    enum { MANY_RAYS = 2048 };
    const struct rad_params *q = &p->o.params;

    if (p->o.dry_run && p->frames.n > 0 && q->ambounce > 0 &&
        q->ambdiv >= MANY_RAYS)
        program_news(p, "the trial traces some of the pixels, which may take "
                        "minutes with these options");
}

/* The thread cannot be stopped.  It may be writing files, so our folder is left
 * to its keeper (local.c). */
int
program_compile(struct program *p)
{
    struct compiling c = { .p = p };
    uv_work_t work = { .data = &c };
    int rc;

    say_of_trial(p);
    if (uv_queue_work(&p->loop.uv, &work, compile_work, compile_done) != 0)
        return rad_fail_memory(p->err);
    while (!c.done) {
        uv_run(&p->loop.uv, UV_RUN_ONCE);
        if (p->loop.interrupts > 0 && !c.done) {
            command_stop_all();
            _exit(program_status(p, RAD_ETEMPFAIL));
        }
    }
    rc = program_check_apart(p); /* first, for it closes a wrong file of -e */
    return c.rc < 0 ? c.rc : rc;
}

int
program_take_rif(struct program *p)
{
    int rc = rifjob_begin(&p->rif, &p->o, &p->words, p->err);

    if (rc == 0 && p->rif.is && p->o.points.file)
        rc = rad_fail(p->err, RAD_EUSAGE,
                      "--points is for a scene, not for a .rif file");
    if (rc == 0 && !p->rif.is && p->o.rif_view)
        rc = rad_fail(p->err, RAD_EUSAGE, "--view is for a .rif file");
    if (rc < 0 || !p->rif.is)
        return rc;
    if ((rc = program_loop_init(&p->loop, p->err)) < 0 ||
        (rc = local_new(&p->cluster.local, p->err)) < 0 ||
        (rc = program_compile(p)) < 0 ||
        (rc = rifjob_finish(&p->rif, &p->o, &p->words, &p->scene.octree,
                            p->err)) < 0)
        return rc;
    return frames_init_views(&p->frames, &p->o, p->rif.views, p->rif.nviews,
                             p->err);
}
