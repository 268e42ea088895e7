/* seqpict.c - the renderer alone: one thread, the whole picture one window
 *
 * usage: seqpict [-vf FILE] [rpict options] [-z FILE] [--counts]
 *                [--window=X,Y,W,H] [--frame=N] [--oversample=N] [--clamp=F]
 *                [--ambient=passes] [--error=PERCENT] [--rungs=A,P] [--doubt]
 *                -o OUT.hdr scene.rad...
 * What a cluster must agree with.  -vf is a view file, -z gets distances as
 * rpict writes them; --counts prints what was counted on standard error;
 * --window renders that part of the picture by itself, the rest is black;
 * --frame is which of an animation it is, whose view does not move;
 * --oversample and --clamp filter the whole picture down as radsubmit's do;
 * --ambient=passes fills the cache in passes first; --error does so in stages,
 * until the picture is estimated to be no farther off, and says of each on
 * standard error with which rungs it was made and what was found, the first
 * with those of --rungs; --doubt says how far off the picture is, as a cluster
 * does. */
#include "config.h"

#include "compile/compile.h"
#include "image/filter.h"
#include "picture/frame.h"
#include "image/hdr.h"
#include "passes/passes.h"
#include "refine/recheck.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

struct task {
    struct rad_params params; /* of the stage, or the picture */
    struct rad_params own;    /* as they were asked for */
    struct rad_view view;
    struct rad_window window; /* width 0: all */
    uint32_t frame;
    const char *out, *depth;
    bool counts, passes, says;
    double error; /* 0: not asked for */
    int rungs[2]; /* of its first stage */
    int oversample;
    double clamp;
    int nscenes;
    char **scenes;
};

static int
say(const struct rad_error *err)
{
    char text[600];

    rad_error_format(err, text, sizeof text);
    fprintf(stderr, "seqpict: %s\n", text);
    return rad_exit_status(err->code);
}

static int
read_view(struct rad_view *v, const char *path, struct rad_error *err)
{
    size_t len;
    unsigned char *text = rad_file_read(path, 1 << 26, &len, err);
    int rc;

    if (!text)
        return err->code;
    rc = rad_view_read(v, (char *)text, len, err);
    free(text);
    if (rc == 0)
        return rad_fail(err, RAD_EDATA, "%s: no view in it", path);
    return rc;
}

/* An option of this program's own: words used, 0 if it is none. */
static int
own_option(struct task *t, int argc, char **argv, struct rad_error *err)
{
    struct rad_window *w = &t->window;

    if (strcmp(argv[0], "--counts") == 0) {
        t->counts = true;
        return 1;
    }
    if (strcmp(argv[0], "--doubt") == 0) {
        t->says = true;
        return 1;
    }
    if (strcmp(argv[0], "--ambient=passes") == 0) {
        t->passes = true;
        return 1;
    }
    if (sscanf(argv[0], "--window=%d,%d,%d,%d", &w->x, &w->y, &w->width,
               &w->height) == 4)
        return 1;
    if (sscanf(argv[0], "--frame=%" SCNu32, &t->frame) == 1)
        return 1;
    if (sscanf(argv[0], "--error=%lf", &t->error) == 1) {
        t->error /= 100;
        return 1;
    }
    if (sscanf(argv[0], "--rungs=%d,%d", &t->rungs[0], &t->rungs[1]) == 2)
        return 1;
    if (sscanf(argv[0], "--oversample=%d", &t->oversample) == 1 ||
        sscanf(argv[0], "--clamp=%lf", &t->clamp) == 1)
        return 1;
    if (argc < 2)
        return 0;
    if (strcmp(argv[0], "-o") == 0)
        t->out = argv[1];
    else if (strcmp(argv[0], "-z") == 0)
        t->depth = argv[1];
    else if (strcmp(argv[0], "-vf") != 0)
        return 0;
    else if (read_view(&t->view, argv[1], err) < 0)
        return err->code;
    return 2;
}

static int
read_options(struct task *t, int argc, char **argv, struct rad_error *err)
{
    int i = 1, rc;

    t->oversample = 1;
    rad_params_init(&t->params);
    rad_view_init(&t->view);
    for (; i < argc && argv[i][0] == '-'; i += rc) {
        rc = own_option(t, argc - i, argv + i, err);
        if (rc == 0)
            rc = rad_params_option(&t->params, argc - i, argv + i, err);
        if (rc == 0)
            rc = rad_view_option(&t->view, argc - i, argv + i, err);
        if (rc == 0)
            return rad_fail(err, RAD_EUSAGE, "unknown option '%s'", argv[i]);
        if (rc < 0)
            return rc;
    }
    t->params.xres *= t->oversample;
    t->params.yres *= t->oversample;
    t->nscenes = argc - i;
    t->scenes = argv + i;
    if (t->nscenes == 0 || !t->out)
        return rad_fail(err, RAD_EUSAGE, "no scene or no -o");
    return rad_params_check(&t->params, err);
}

static int
write_file(void *arg, const void *data, size_t len, struct rad_error *err)
{
    if (fwrite(data, 1, len, arg) != len)
        return rad_fail(err, RAD_EIO, "write failed");
    return 0;
}

static int
write_rows(const struct rad_frame *f, const struct rad_pixel *pixels,
           const struct rad_sink *sink, struct rad_error *err)
{
    struct rad_rgb *L = malloc((size_t)f->width * sizeof *L);
    uint8_t *bytes = malloc(RAD_HDR_ROW_BYTES(f->width));
    int rc = L && bytes ? 0 : rad_fail_memory(err);

    for (int y = 0; rc == 0 && y < f->height; y++) {
        for (int x = 0; x < f->width; x++)
            L[x] = pixels[(size_t)y * (size_t)f->width + (size_t)x].L;
        rc = sink->write(sink->arg, bytes,
                         rad_hdr_encode_row(L, f->width, bytes), err);
    }
    free(bytes);
    free(L);
    return rc;
}

static struct rad_filter_shape
shape_of(const struct task *t, const struct rad_frame *f)
{
    return (struct rad_filter_shape){ .width = f->width,
                                      .height = f->height,
                                      .oversample = t->oversample,
                                      .clamp = t->clamp };
}

static int
write_filtered(const struct task *t, const struct rad_frame *f,
               const struct rad_pixel *pixels, const struct rad_sink *sink,
               struct rad_error *err)
{
    struct rad_filter_shape s = shape_of(t, f);
    size_t width = (size_t)f->width;
    int columns = rad_filter_side(f->width, t->oversample);
    struct rad_rgb *L = malloc(width * sizeof *L);
    uint8_t *rgbe = malloc(4 * width);
    uint8_t *bytes = malloc(RAD_HDR_ROW_BYTES(width));
    struct rad_filter *filter;
    int rc = rad_filter_new(&filter, &s, err);

    if (rc == 0 && !(L && rgbe && bytes))
        rc = rad_fail_memory(err);
    for (size_t y = 0; rc == 0 && y < (size_t)f->height; y++) {
        for (size_t x = 0; x < width; x++)
            rad_rgbe(pixels[y * width + x].L, rgbe + 4 * x);
        rad_filter_push(filter, rgbe);
        while (rc == 0 && rad_filter_pull(filter, L))
            rc = sink->write(sink->arg, bytes,
                             rad_hdr_encode_row(L, columns, bytes), err);
    }
    rad_filter_free(filter);
    free(L);
    free(rgbe);
    free(bytes);
    return rc;
}

static int
write_picture(const struct task *t, const struct rad_frame *f,
              const struct rad_pixel *pixels, struct rad_error *err)
{
    char options[RAD_FILTER_OPTIONS], view[RAD_VIEW_TEXT];
    struct rad_hdr_info info = {
        .program = "seqpict",
        .options = options,
        .view = view,
        .pixaspect = f->pixaspect,
        .width = rad_filter_side(f->width, t->oversample),
        .height = rad_filter_side(f->height, t->oversample)
    };
    struct rad_filter_shape s = shape_of(t, f);
    FILE *file = fopen(t->out, "wb");
    struct rad_sink sink = { write_file, file };
    int rc;

    if (!file)
        return rad_fail(err, RAD_ECANTCREAT, "cannot write %s", t->out);
    info.pixaspect = rad_filter_pixaspect(&s, f->pixaspect);
    rad_filter_options(&t->params, t->oversample, t->clamp, options);
    rad_view_format(&f->view, view, sizeof view);
    rc = rad_hdr_write_header(&info, &sink, err);
    if (rc == 0)
        rc = t->oversample > 1 ? write_filtered(t, f, pixels, &sink, err)
                               : write_rows(f, pixels, &sink, err);
    if (fclose(file) != 0)
        rc = rad_fail(err, RAD_EIO, "cannot write %s", t->out);
    return rc;
}

static int
write_depth(const struct task *t, const struct rad_frame *f,
            const struct rad_pixel *pixels, struct rad_error *err)
{
    int n = t->oversample, columns = rad_filter_side(f->width, n);
    int rows = rad_filter_side(f->height, n), done = 0;
    FILE *file = fopen(t->depth, "wb");

    if (!file)
        return rad_fail(err, RAD_ECANTCREAT, "cannot write %s", t->depth);
    for (int y = 0; y < rows; y++)
        for (int x = 0; x < columns; x++) {
            int at = rad_filter_middle(f->height, n, y) * f->width +
                     rad_filter_middle(f->width, n, x);

            done += fwrite(&pixels[at].z, sizeof(float), 1, file) == 1;
        }
    if (fclose(file) != 0 || done < rows * columns)
        return rad_fail(err, RAD_EIO, "cannot write %s", t->depth);
    return 0;
}

static void
print_counts(const struct rad_counts *c)
{
    fprintf(stderr,
            "rays %" PRIu64 "\nprimary_rays %" PRIu64 "\nshadow_rays %" PRIu64
            "\nambient_rays %" PRIu64 "\npaint_rays %" PRIu64
            "\nambient_values %" PRIu64 "\nnan_pixels %" PRIu64
            "\nintersection_tests %" PRIu64 "\n",
            c->rays, c->primary_rays, c->shadow_rays, c->ambient_rays,
            c->paint_rays, c->ambient_values, c->nan_pixels, c->geom.tests);
}

/* How far off the picture is, as a cluster says it. */
static void
print_error(const struct rad_frame *f, struct rad_ctx *ctx,
            struct rad_pixel *const rows[])
{
    const struct rad_window all = { 0, 0, f->width, f->height };
    struct rad_doubt_share share = rad_doubt_of_picture(f);
    struct rad_doubt found = { { 0 } };
    struct rad_error_estimate e;
    struct rad_quincunx q;
    uint64_t rays = ctx->counts.rays;
    int next = 0;

    rad_frame_sampler(f, &all, &q);
    for (int i = 0; i < rad_quincunx_nbases(&q); i++) {
        int end = rad_quincunx_base_row(&q, i) + 1;
        struct rad_doubt_rows r = {
            .frame = f,
            .y = next,
            .width = f->width,
            .n = end - next,
            .row = (const struct rad_pixel *const *)rows + next
        };

        rad_doubt_look(&r, ctx, &share, NULL, &found);
        next = end;
    }
    e = rad_doubt_error(&found);
    fprintf(stderr,
            "error %.4f ambient %.4f sampling %.4f left out %.4f places %.0f "
            "areas %.0f rays %" PRIu64 "\n",
            e.all, e.ambient, e.sampling, rad_doubt_left_out(&found),
            found.v[RAD_DOUBT_PLACES], found.v[RAD_DOUBT_AREAS],
            ctx->counts.rays - rays);
}

static int
render(const struct task *t, const struct rad_frame *f, struct rad_ctx *ctx,
       struct rad_error *err)
{
    size_t width = (size_t)f->width, height = (size_t)f->height;
    struct rad_pixel *pixels = calloc(width * height, sizeof *pixels);
    struct rad_pixel **rows = malloc(height * sizeof *rows);
    struct rad_window w = t->window;
    int rc = pixels && rows ? 0 : rad_fail_memory(err);

    if (w.width == 0)
        w = (struct rad_window){ 0, 0, f->width, f->height };
    for (int k = 0; rc == 0 && k < w.height; k++)
        rows[k] = pixels + (size_t)(w.y + k) * width + w.x;
    if (rc == 0 && (rc = rad_frame_window(f, ctx, &w, rows)) < 0)
        rad_fail(err, rc, "cannot render that window");
    if (rc == 0)
        rc = write_picture(t, f, pixels, err);
    if (rc == 0 && t->says)
        print_error(f, ctx, rows);
    if (rc == 0 && t->depth)
        rc = write_depth(t, f, pixels, err);
    free(rows);
    free(pixels);
    return rc;
}

struct records {
    struct rad_ambrec *rec;
    size_t n, cap;
    bool failed;
};

static void
keep_records(void *arg, const struct rad_ambrec *rec, size_t n)
{
    struct records *k = arg;

    if (k->n + n > k->cap) {
        size_t cap = 2 * (k->n + n);
        struct rad_ambrec *more = realloc(k->rec, cap * sizeof *more);

        k->failed |= !more;
        if (!more)
            return;
        k->rec = more;
        k->cap = cap;
    }
    memcpy(k->rec + k->n, rec, n * sizeof *rec);
    k->n += n;
}

static int
make_pass(struct rad_passes *p, struct rad_ctx *ctx,
          const struct rad_pass *pass, bool last, struct records *k,
          struct rad_error *err)
{
    static const _Atomic bool never;
    size_t before = rad_ambient_count(ctx->job->ambient);
    int rc = rad_passes_begin(p, ctx, pass, err);

    k->n = 0;
    for (uint32_t i = 0; rc == 0 && i < pass->tiles; i++)
        if (!rad_passes_make(
                p, ctx,
                &(struct rad_passes_order){
                    .pass = pass,
                    .seen = rad_ambient_view(ctx->job->ambient, pass->reads),
                    .tile = i,
                    .stop = &never,
                    .fn = keep_records,
                    .arg = k }) ||
            k->failed)
            rc = rad_fail_memory(err);
    if (rc == 0)
        rad_ambient_insert_all(ctx->job->ambient, k->rec, k->n);
    if (rc == 0 && (rad_ambient_count(ctx->job->ambient) != before + k->n ||
                    !rad_ambient_settle(ctx->job->ambient) ||
                    (last && !rad_ambient_smooth(ctx->job->ambient))))
        rc = rad_fail_memory(err);
    return rc;
}

/* Make the tiles of the check pass. */
static int
make_check(struct rad_passes *p, struct rad_ctx *ctx,
           const struct rad_pass *pass, struct rad_refine_sums *sums,
           struct rad_error *err)
{
    static const _Atomic bool never;
    struct rad_refine_sums of;
    int rc = rad_passes_begin(p, ctx, pass, err);

    for (uint32_t i = 0; rc == 0 && i < pass->tiles; i++)
        if (rad_refine_make(p, ctx, i, &never, &of))
            rad_refine_add(sums, &of);
        else
            rc = rad_fail_memory(err);
    return rc;
}

/* Fill the cache; with --error, check it, too: what is to be decided upon. */
static int
fill_cache(const struct task *t, const struct rad_frame *f, struct rad_ctx *ctx,
           struct rad_refine_ask *ask, struct rad_error *err)
{
    struct rad_pass_size size = { f->width, f->height };
    struct rad_pass plan[RAD_MOST_PASSES];
    uint32_t n =
        rad_refine_plan(&f->job->params, &size, 1, false, t->error > 0, plan);
    struct rad_passes *p = rad_passes_new(f, 1, err);
    struct records k = { 0 };
    int rc = p ? 0 : err->code;

    for (uint32_t i = 0; rc == 0 && i < n; i++) {
        if (!plan[i].check) {
            rc = make_pass(p, ctx, &plan[i], rad_pass_is_last(plan, n, i), &k,
                           err);
            continue;
        }
        ask->rays = ctx->counts.rays;
        ask->pixels = (uint64_t)f->width * (uint64_t)f->height;
        ask->samples = t->own.samples;
        rc = make_check(p, ctx, &plan[i], &ask->sums, err);
    }
    rad_passes_free(p);
    free(k.rec);
    return rc;
}

/* Of squares at places. */
static double
root_mean(const struct rad_doubt *d, enum rad_doubt_sum squares)
{
    double mean = d->v[squares] / d->v[RAD_DOUBT_PLACES];

    return mean > 0 ? sqrt(mean) : 0;
}

static void
print_stage(const struct rad_refine_ask *ask, const struct rad_job *job)
{
    const struct rad_params *par = &job->params;
    const struct rad_doubt *d = &ask->sums.doubt;
    struct rad_error_estimate e = rad_doubt_error(d);

    fprintf(stderr,
            "stage %" PRIu32 " rungs %d %d error %.4f ambient %.4f pixel %.4f "
            "noise %.4f rays %" PRIu64 " check %" PRIu64
            " fresh %.4f records %.4f aa %.4g ad %d pt %.4g ds %.4g\n",
            ask->stage, ask->rungs.ambient / RAD_REFINE_RUNG,
            ask->rungs.pixel / RAD_REFINE_RUNG, e.all, e.ambient, e.sampling,
            sqrt(rad_doubt_squares(d).noise), ask->rays, ask->check,
            root_mean(d, RAD_DOUBT_AMBIENT), root_mean(d, RAD_DOUBT_SAID),
            par->ambacc, par->ambdiv, par->maxdiff, par->srcsizerat);
}

/* The picture is made with these rungs. */
static void
show_with(struct task *t, struct rad_job *job, struct rad_refine_rungs rungs,
          double error)
{
    rad_refine_params(&t->own, rungs, &t->params);
    rad_job_show(job, t->params.samples);
    fprintf(stderr, "picture error %.4f samples %d\n", error,
            t->params.samples);
}

/* Make a stage, or all that there is without --error; the picture if it is the
 * last: ask->stage goes on if it is not. */
static int
make_stage(struct task *t, struct rad_job *job, struct rad_ctx *ctx,
           struct rad_frame *f, struct rad_refine_ask *ask,
           struct rad_error *err)
{
    struct rad_refine_rungs next;
    double error;
    int rc = 0;

    if ((t->passes || t->error > 0) && ctx->job->ambient) {
        rad_ambient_freeze(ctx->job->ambient);
        memset(&ask->sums, 0, sizeof ask->sums);
        rc = fill_cache(t, f, ctx, ask, err);
    }
    if (rc == 0 && t->error > 0 && ctx->job->ambient) {
        ask->check = ctx->counts.rays - ask->rays;
        print_stage(ask, ctx->job);
        if (rad_refine_next(ask, &next, &error)) {
            ask->past = rad_refine_pass_on(ask);
            ask->rungs = next;
            ask->stage++;
            return 0;
        }
        show_with(t, job, next, error);
    }
    return rc == 0 ? render(t, f, ctx, err) : rc;
}

static int
render_stage(struct task *t, const struct rad_params *params,
             struct compiled *c, struct rad_refine_ask *ask,
             struct rad_error *err)
{
    struct rad_files files = compile_files(c);
    struct rad_job *job = rad_job_new(c->scene, params, &files, err);
    struct rad_frame f = { 0 };
    struct rad_ctx ctx = { 0 };
    int rc = err->code;

    t->params = *params;
    if (job && (rc = rad_ctx_init(&ctx, job, err)) == 0) {
        rc = rad_frame_init(&f, job, &t->view, t->frame, t->depth != NULL, err);
        f.oversample = t->oversample;
        if (rc == 0)
            rc = make_stage(t, job, &ctx, &f, ask, err);
        if (rc == 0 && ctx.scratch.lacked)
            rc = rad_fail_memory(err);
        if (rc == 0 && t->counts)
            print_counts(&ctx.counts);
        rad_frame_release(&f);
        rad_ctx_release(&ctx);
    }
    rad_job_free(job);
    return rc;
}

static uint8_t
rung(int whole)
{
    return (uint8_t)(RAD_REFINE_RUNG * (whole < 63 ? whole : 63));
}

static int
render_scene(struct task *t, struct compiled *c, struct rad_error *err)
{
    struct rad_refine_ask ask = { .error = t->error,
                                  .rungs = { rung(t->rungs[0]),
                                             rung(t->rungs[1]) },
                                  .left_s = INFINITY };
    struct rad_params params;
    uint32_t stage;
    int rc;

    t->own = t->params;
    do {
        stage = ask.stage;
        rad_refine_params(&t->own, ask.rungs, &params);
        rc = render_stage(t, &params, c, &ask, err);
    } while (rc == 0 && ask.stage > stage);
    return rc;
}

int
main(int argc, char **argv)
{
    struct rad_error err = { 0 };
    struct task t = { 0 };
    struct compiled c;
    int rc;

    if (read_options(&t, argc, argv, &err) < 0 ||
        compile_read(&c,
                     &(struct compile_from){ (const char *const *)t.scenes,
                                             t.nscenes, true },
                     NULL, NULL, &err) < 0)
        return say(&err);
    rc = render_scene(&t, &c, &err);
    compile_release(&c);
    return rc < 0 ? say(&err) : EX_OK;
}
