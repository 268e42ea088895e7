/* render_load.c - a job's child loads the scene and what is made of it
 *
 * All files are read from the cache, under the names that the bundle's manifest
 * has for them.  The cache has files of other users' jobs, too, and to know a
 * hash gives no right to a file.  The coordinator has checked the user's right
 * to the files that the job names: no other file is opened, not even a
 * manifest. */
#include "config.h"

#include "child/render_impl.h"

#include "files/blobs.h"
#include "machine/jobtext.h"
#include "scene/file/bundle.h"
#include "scene/octfile.h"
#include "scene/part.h"
#include "files/views.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LARGEST_MANIFEST (64u << 20)

static int
read_manifest(struct render *r, const uint8_t *hash, struct rad_bundle *bundle,
              struct rad_error *err)
{
    char name[RAD_SHA_HEX + 1], path[BLOBS_PATH_MAX];
    unsigned char *text;
    size_t len;
    int rc;

    rad_sha_to_hex(hash, name);
    snprintf(path, sizeof path, "%s/%s", r->files_dir, name);
    text = rad_file_read(path, LARGEST_MANIFEST, &len, err);
    if (!text)
        return err->code;
    rc = rad_bundle_parse(bundle, (const char *)text, len, err);
    free(text);
    return rc;
}

/* Read the bundle, all of whose files must be among the job's n files, which
 * are sorted.  Others are not opened: errors would tell which files other users
 * have. */
static int
read_own(struct render *r, const uint8_t *manifest, const uint8_t *files,
         size_t n, struct rad_bundle *bundle, struct rad_error *err)
{
    uint8_t hash[RAD_SHA_BYTES];
    int rc;

    if (!rad_sha_among(files, n, manifest))
        return rad_fail(err, RAD_ENOINPUT,
                        "the manifest is none of the job's files");
    rc = read_manifest(r, manifest, bundle, err);
    for (int i = 0; rc == 0 && i < bundle->n; i++) {
        rad_sha_from_hex(bundle->entries[i].hash, hash);
        if (!rad_sha_among(files, n, hash))
            rc = rad_fail(err, RAD_ENOINPUT,
                          "file '%s' is none of the job's files",
                          bundle->entries[i].name);
    }
    return rc;
}

static int
load_bundle(struct render *r, const struct msg_spec *spec,
            struct rad_bundle *bundle, struct rad_error *err)
{
    size_t len = (size_t)spec->files.n * MSG_HASH;
    uint8_t *sorted = malloc(len + 1);
    int rc;

    if (!sorted)
        return rad_fail_memory(err);
    if (len > 0)
        memcpy(sorted, spec->files.hash, len);
    rc = read_own(r, spec->manifest, sorted,
                  rad_sha_unique(sorted, spec->files.n), bundle, err);
    free(sorted);
    return rc;
}

/* Load the file of ambient records, if the job has one. */
static int
load_records(struct render *r, const struct rad_bundle *bundle,
             struct rad_error *err)
{
    struct rad_bundle_dir where = { bundle, r->files_dir };
    struct rad_files files = rad_bundle_files(&where);
    unsigned char *bytes;
    size_t len;
    int rc;

    if (!r->job->ambient ||
        !rad_bundle_find(bundle, RAD_BUNDLE_FILE, RAD_BUNDLE_RECORDS))
        return 0;
    bytes = files.read(files.arg, RAD_BUNDLE_RECORDS, &len, err);
    if (!bytes)
        return err->code;
    rc = ambshare_load(r->job->ambient, bytes, len, err);
    free(bytes);
    return rc;
}

/* Load the scene, unless it was kept from the stage before. */
static int
load_scene(struct render *r, const struct rad_bundle *bundle,
           const struct rad_files *files, struct rad_error *err)
{
    const struct rad_bundle_entry *e =
        rad_bundle_find(bundle, RAD_BUNDLE_SCENE, NULL);
    char path[BLOBS_PATH_MAX];

    if (r->scene)
        return 0;
    if (!e)
        return rad_fail(err, RAD_EDATA, "the bundle has no scene");
    snprintf(path, sizeof path, "%s/%s", r->files_dir, e->hash);
    r->scene = rad_octfile_load(path, err);
    if (!r->scene)
        return err->code;
    return rad_scene_include(r->scene, files, NULL, NULL, err);
}

static int
load_job(struct render *r, const struct rad_bundle *bundle,
         const struct msg_spec *spec, struct rad_error *err)
{
    struct rad_bundle_dir where = { bundle, r->files_dir };
    struct rad_files files = rad_bundle_files(&where);
    struct rad_params params;
    int rc = jobtext_params(spec->params, &params, err);

    if (rc < 0 || (rc = load_scene(r, bundle, &files, err)) < 0)
        return rc;
    params.seed = spec->seed;
    r->job = rad_job_new(r->scene, &params, &files, err);
    if (!r->job)
        return err->code;
    if (spec->flags & MSG_JOB_PASSES && r->job->ambient)
        rad_ambient_freeze(r->job->ambient);
    return load_records(r, bundle, err);
}

/* Make the one frame of a job of sensor points. */
static int
load_points(struct render *r, const struct rad_bundle *bundle,
            const struct msg_spec *spec, struct rad_error *err)
{
    const struct rad_bundle_entry *e =
        rad_bundle_find(bundle, RAD_BUNDLE_FILE, RAD_BUNDLE_POINTS);
    char path[BLOBS_PATH_MAX];
    size_t len;
    int rc;

    if (!e || spec->nframes != 1)
        return rad_fail(err, RAD_EDATA, "the job has no sensor points");
    snprintf(path, sizeof path, "%s/%s", r->files_dir, e->hash);
    r->points_bytes = rad_file_read(path, RAD_MAX_POINTS_FILE, &len, err);
    if (!r->points_bytes)
        return err->code;
    rc = rad_points_open(&r->points, r->points_bytes, len, err);
    if (rc < 0)
        return rc;
    if (r->points.width != (int)spec->frames[0].width ||
        r->points.height != (int)spec->frames[0].height)
        return rad_fail(err, RAD_EDATA, "the sensor points are of another job");
    r->frames = calloc(2, sizeof *r->frames);
    if (!r->frames)
        return rad_fail_memory(err);
    rad_frame_of_points(&r->frames[0], r->job, &r->points);
    r->nframes = 1;
    return 0;
}

static int
load_frames(struct render *r, const struct msg_spec *spec,
            struct rad_error *err)
{
    bool depth = spec->flags & MSG_JOB_DEPTH;
    struct rad_view before;

    r->frames = calloc(spec->nframes + 1, sizeof *r->frames);
    if (!r->frames)
        return rad_fail_memory(err);
    for (uint32_t i = 0; i < spec->nframes; i++) {
        const struct msg_frame *f = &spec->frames[i];
        struct rad_view view;
        int rc = jobtext_view(f->view, &view, err);

        if (rc == 0)
            rc = rad_frame_init(&r->frames[i], r->job, &view, f->number, depth,
                                err);
        if (rc < 0)
            return rc;
        r->nframes = i + 1;
        if (i > 0 && (rc = rad_frame_move(&r->frames[i], &before, err)) < 0)
            return rc;
        before = view;
        r->frames[i].oversample = spec->oversample;
        if (r->frames[i].width != (int)f->width ||
            r->frames[i].height != (int)f->height)
            return rad_fail(
                err, RAD_EDATA, "frame %u is %dx%d by its view, not %ux%u", i,
                r->frames[i].width, r->frames[i].height, f->width, f->height);
    }
    return 0;
}

/* Make the strict units' machine, if the job has such units. */
static int
load_strict(struct render *r, const struct msg_spec *spec,
            struct rad_error *err)
{
    struct rad_quincunx *q;
    bool painted = false;

    if (!msg_shares_lines(spec->partition))
        return 0;
    q = calloc(r->nframes + 1, sizeof *q);
    if (q) {
        for (uint32_t i = 0; i < r->nframes; i++) {
            const struct rad_frame *f = &r->frames[i];
            const struct rad_window all = { 0, 0, f->width, f->height };

            rad_frame_sampler(f, &all, &q[i]);
            painted |= f->paint.n > 0;
        }
        r->strict = strict_new(q, r->nframes, painted, r->id);
        free(q);
    }
    return r->strict ? 0 : rad_fail_memory(err);
}

static int
start_pool(struct render *r, bool coded, struct rad_error *err)
{
    const struct pool_spec spec = { .job = r->job,
                                    .frames = r->frames,
                                    .strict = r->strict,
                                    .nthreads = r->nthreads,
                                    .coded = coded,
                                    .rows = render_on_rows,
                                    .news = render_on_news,
                                    .arg = r };

    r->pool = pool_new(&r->loop, &spec, err);
    if (!r->pool)
        return err->code;
    render_begin_passes(r);
    return 0;
}

int
render_load(struct render *r, const struct msg_spec *spec,
            struct rad_error *err)
{
    struct rad_bundle bundle;
    struct msg_spec whole = *spec;
    struct views views = { 0 };
    int rc;

    rad_bundle_init(&bundle);
    rc = load_bundle(r, spec, &bundle, err);
    if (rc == 0)
        rc = load_job(r, &bundle, spec, err);
    if (rc == 0)
        rc = views_read(&views, r->files_dir, &whole, err);
    if (rc == 0)
        rc = spec->flags & MSG_JOB_POINTS ? load_points(r, &bundle, spec, err)
                                          : load_frames(r, &whole, err);
    views_release(&views);
    rad_bundle_release(&bundle);
    if (rc == 0)
        rc = load_strict(r, spec, err);
    if (rc == 0)
        rc = render_load_passes(r, err);
    if (rc < 0)
        return rc;
    r->frame = r->nframes;
    return start_pool(r, spec->flags & MSG_JOB_CODED, err);
}

void
render_unload_job(struct render *r)
{
    pool_free(r->pool);
    r->pool = NULL;
    render_unload_passes(r);
    strict_free(r->strict);
    r->strict = NULL;
    for (uint32_t i = 0; i < r->nframes; i++)
        rad_frame_release(&r->frames[i]);
    r->nframes = 0;
    free(r->frames);
    r->frames = NULL;
    free(r->points_bytes);
    r->points_bytes = NULL;
    rad_job_free(r->job);
    r->job = NULL;
}

void
render_unload(struct render *r)
{
    render_unload_job(r);
    rad_scene_free(r->scene);
    r->scene = NULL;
}
