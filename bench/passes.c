/* passes.c - what it costs to fill the ambient cache in passes
 *
 *      passes [--tiles=FILE] [rendering options] scene.rad... views.vf
 *
 * Pictures of all the views, one a line, are rendered twice by one thread: with
 * a cache to which each new record is added at once, and with one that is
 * filled in passes beforehand, for a batch of frames at a time. Of each pass
 * stand there its tiles, its records, those of them that are for deeper levels
 * than the pass, those that another tile of the pass, or the cache, would have
 * served already, the rays of hemispheres, all rays, and seconds of a
 * processor; and in the end how much memory a record takes, and how long all
 * threads of a worker would be busy from pass to pass: with what one of them
 * does alone and with pieces that they share.  --tiles writes
 * what each tile of a single picture took, for bench/sim (sim/tiles.h). */
#include "config.h"

#define TOOL "passes"
#include "tool.h"

#include "base/files.h"
#include "compile/compile.h"
#include "light/indirect/ambient.h"
#include "passes/passes.h"
#include "proto/ambshare.h"
#include "scene/file/parse.h"

#include <inttypes.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Workers of so many threads. */
static const int team[] = { 4, 16, 64 };
enum { N_TEAMS = sizeof team / sizeof team[0], MOST_THREADS = 64 };

struct bench {
    struct compiled compiled;
    struct rad_files files;
    struct rad_params params;
    struct rad_view *view;
    uint32_t n; /* of them */
    struct rad_job *job;
    struct rad_frame *frame;
    struct rad_ambient *met; /* all records of passes, as of a live cache */
    struct rad_ctx ctx;
    FILE *tiles; /* what each took; NULL: not wanted */
    double alone, shared; /* seconds of work between passes: of one thread, and
                           * in pieces */
    double longest[N_TEAMS]; /* the pieces' part of wall time */
};

/* Each line is a view. */
static void
read_views(struct bench *b, const char *file)
{
    struct rad_error err = { 0 };
    size_t len, n;
    char *text = (char *)rad_file_read(file, SIZE_MAX / 2, &len, &err);

    if (!text)
        die(&err);
    for (const char *at = text; at < text + len; at += n + 1) {
        n = strcspn(at, "\n");
        if (n == 0)
            continue;
        b->view = realloc(b->view, (b->n + 1) * sizeof *b->view);
        if (!b->view)
            die_of("out of memory");
        rad_view_init(&b->view[b->n]);
        if (rad_view_read(&b->view[b->n++], at, n, &err) < 0)
            die(&err);
    }
    free(text);
    if (b->n == 0)
        die_of("there is no view");
}

static void
load(struct bench *b, char **file, int n)
{
    struct rad_error err = { 0 };

    if (n < 2)
        die_of("usage: passes [--tiles=FILE] [rendering options] scene.rad... "
               "views.vf");
    if (compile_read(
            &b->compiled,
            &(struct compile_from){ (const char *const *)file, n - 1, false },
            NULL, NULL, &err) < 0)
        die(&err);
    b->files = compile_files(&b->compiled);
    read_views(b, file[n - 1]);
}

static void
open_tiles(struct bench *b, const char *file)
{
    char text[RAD_PARAMS_TEXT];

    b->tiles = fopen(file, "w");
    if (!b->tiles)
        die_of("the file of tiles cannot be written");
    rad_params_format(&b->params, text, sizeof text);
    fprintf(b->tiles, "params %s\n", text);
}

static void
open_job(struct bench *b)
{
    struct rad_error err = { 0 };

    b->job = rad_job_new(b->compiled.scene, &b->params, &b->files, &err);
    if (!b->job)
        die(&err);
    b->met = rad_ambient_new(b->job, NULL);
    if (!b->job->ambient || !b->met)
        die_of("the options have no ambient cache");
    b->frame = calloc(b->n, sizeof *b->frame);
    if (!b->frame)
        die_of("out of memory");
    for (uint32_t i = 0; i < b->n; i++)
        if (rad_frame_init(&b->frame[i], b->job, &b->view[i], i, false, &err) <
            0)
            die(&err);
    if (rad_ctx_init(&b->ctx, b->job, &err) < 0)
        die(&err);
}

static void
close_job(struct bench *b)
{
    rad_ctx_release(&b->ctx);
    for (uint32_t i = 0; i < b->n; i++)
        rad_frame_release(&b->frame[i]);
    free(b->frame);
    rad_ambient_free(b->met);
    rad_job_free(b->job);
}

/* All of a picture; returns the seconds that it took. */
static double
render(struct bench *b, const struct rad_frame *f)
{
    struct rad_window all = { 0, 0, f->width, f->height };
    struct rad_pixel **rows = calloc((size_t)all.height, sizeof *rows);
    double start = now();

    for (int y = 0; rows && y < all.height; y++)
        rows[y] = malloc((size_t)all.width * sizeof **rows);
    if (!rows || rad_frame_window(f, &b->ctx, &all, rows))
        die_of("the picture cannot be rendered");
    for (int y = 0; y < all.height; y++)
        free(rows[y]);
    free(rows);
    return now() - start;
}

/* The records of a pass. */
struct records {
    int level; /* of the pass */
    struct rad_ambrec *v;
    size_t n, room;
    size_t deeper; /* of these, than the pass */
};

static void
keep(void *arg, const struct rad_ambrec *rec, size_t n)
{
    struct records *r = arg;

    if (r->n + n > r->room) {
        r->room = 2 * (r->n + n);
        r->v = realloc(r->v, r->room * sizeof *r->v);
        if (!r->v)
            die_of("out of memory");
    }
    memcpy(r->v + r->n, rec, n * sizeof *rec);
    r->n += n;
    for (size_t i = 0; i < n; i++)
        r->deeper += rec[i].level > r->level;
}

/* When n pieces are done, each by the first of so many threads that is free. */
static double
share_out(const double *took, size_t n, int threads)
{
    double busy[MOST_THREADS] = { 0 }, last = 0;

    for (size_t i = 0; i < n; i++) {
        int least = 0;

        for (int k = 1; k < threads; k++)
            least = busy[k] < busy[least] ? k : least;
        busy[least] += took[i];
        last = busy[least] > last ? busy[least] : last;
    }
    return last;
}

/* Put the records of a pass into the cache. */
static void
settle(struct bench *b, struct records *r)
{
    struct rad_ambient *amb = b->job->ambient;
    double start = now(), pieces = 0, all;
    double *took;
    size_t n;

    rad_ambient_insert_all(amb, r->v, r->n);
    n = rad_ambient_settle_begin(amb, true);
    took = calloc(n + 1, sizeof *took);
    if (!took)
        die_of("out of memory");
    for (size_t i = 0; i < n; i++) {
        took[i] = -now();
        rad_ambient_settle_piece(amb, i);
        took[i] += now();
        pieces += took[i];
    }
    if (!rad_ambient_settle_end(amb))
        die_of("out of memory");
    all = now() - start;
    b->alone += all - pieces;
    b->shared += pieces;
    for (int i = 0; i < N_TEAMS; i++)
        b->longest[i] += share_out(took, n, team[i]);
    free(took);
}

/* Add them to the cache; returns how many of them one by one it would not have
 * needed. */
static size_t
add(struct bench *b, struct records *r)
{
    size_t needless = 0;

    for (size_t i = 0; i < r->n; i++) {
        needless += rad_ambient_covers(b->met, &r->v[i]);
        rad_ambient_insert(b->met, &r->v[i]);
    }
    settle(b, r);
    r->n = 0;
    return needless;
}

/* What the spots of a tile's paths take on their way, in records. */
static size_t
walk_records(const struct rad_pass *pass, uint32_t tile)
{
    uint32_t first;
    size_t n = (size_t)rad_pass_paths(pass, tile, &first) *
               (size_t)pass->walks * sizeof(struct rad_pass_spot);

    return (n + AMBSHARE_BYTES - 1) / AMBSHARE_BYTES;
}

static void
do_tile(struct bench *b, struct rad_passes *p, const struct rad_pass *pass,
        uint32_t tile, struct records *r)
{
    const struct rad_ambview *seen =
        rad_ambient_view(b->job->ambient, pass->reads);
    static const _Atomic bool never;
    uint64_t rays = b->ctx.counts.rays;
    double start = now();
    size_t made = r->n;

    if (!rad_passes_make(p, &b->ctx,
                         &(struct rad_passes_order){ .pass = pass,
                                                     .seen = seen,
                                                     .tile = tile,
                                                     .stop = &never,
                                                     .fn = keep,
                                                     .arg = r }))
        die_of("out of memory");
    if (b->tiles)
        fprintf(b->tiles, "tile %.6f %" PRIu64 " %zu\n", now() - start,
                b->ctx.counts.rays - rays,
                pass->walks ? walk_records(pass, tile) : r->n - made);
}

static void
do_pass(struct bench *b, struct rad_passes *p, const struct rad_pass *pass)
{
    struct records r = { .level = pass->level };
    struct rad_counts before = b->ctx.counts;
    double start = now(), took;
    size_t made;

    if (rad_passes_begin(p, &b->ctx, pass, NULL) < 0)
        die_of("out of memory");
    b->alone += now() - start;
    if (b->tiles)
        fprintf(b->tiles, "pass %d %d %" PRIu32 " %.6f\n", pass->level,
                pass->step, pass->tiles, now() - start);
    for (uint32_t i = 0; i < pass->tiles; i++)
        do_tile(b, p, pass, i, &r);
    took = now() - start;
    made = r.n;
    printf("level %d, ", pass->level);
    if (pass->level > 0 || pass->walks)
        printf("%5" PRIu32 " paths ", pass->end - pass->first);
    else
        printf("%s of %2d ", pass->scattered ? "rest   " : "lattice",
               pass->step);
    printf("%6" PRIu32 " tiles %7zu records %6zu deeper %6zu needless %9" PRIu64
           " of %9" PRIu64 " rays %7.3f s\n",
           pass->tiles, made, r.deeper, add(b, &r),
           b->ctx.counts.ambient_rays - before.ambient_rays,
           b->ctx.counts.rays - before.rays, took);
    free(r.v);
}

static void
tell_picture(const struct bench *b, double live, double rendered)
{
    if (!b->tiles)
        return;
    fprintf(b->tiles, "picture %d %d %.6f %.6f\n", b->frame->width,
            b->frame->height, live, rendered);
    if (fclose(b->tiles) != 0)
        die_of("the file of tiles cannot be written");
}

/* Fill the cache in passes, and render the frames of each batch over it. */
static void
fill_and_render(struct bench *b, double *filled, double *rendered)
{
    struct rad_pass *pass = malloc(RAD_MOST_PASSES * sizeof *pass);
    struct rad_pass_size *size = calloc(b->n, sizeof *size);
    struct rad_passes *p = rad_passes_new(b->frame, b->n, NULL);
    uint32_t n, done = 0;
    double start;

    if (!p || !pass || !size)
        die_of("out of memory");
    for (uint32_t i = 0; i < b->n; i++)
        size[i] =
            (struct rad_pass_size){ b->frame[i].width, b->frame[i].height };
    n = rad_passes_plan(&b->params, size, b->n, pass);
    for (uint32_t i = 0; i < n; i++) {
        start = now();
        do_pass(b, p, &pass[i]);
        b->alone -= now();
        if (rad_pass_is_last(pass, n, i) &&
            !rad_ambient_smooth(b->job->ambient))
            die_of("out of memory");
        b->alone += now();
        *filled += now() - start;
        for (; done < pass[i].ready; done++)
            *rendered += render(b, &b->frame[done]);
    }
    rad_passes_free(p);
    free(size);
    free(pass);
}

static void
tell_between(const struct bench *b)
{
    printf("between passes %.3f s, of these %.3f by one thread alone;",
           b->alone + b->shared, b->alone);
    for (int i = 0; i < N_TEAMS; i++)
        printf(" %.3f by %d", b->alone + b->longest[i], team[i]);
    printf("\n");
}

static void
tell(const struct bench *b, const char *what, double filled, double rendered)
{
    printf("%-7s %zu records, %" PRIu64 " rays of hemispheres, %" PRIu64
           " rays; %.3f + %.3f = %.3f s\n",
           what, rad_ambient_count(b->job->ambient), b->ctx.counts.ambient_rays,
           b->ctx.counts.rays, filled, rendered, filled + rendered);
}

int
main(int argc, char **argv)
{
    struct bench b = { 0 };
    struct rad_error err = { 0 };
    double live = 0, filled = 0, rendered = 0;
    const char *tiles = NULL;
    int at = 1, n;

    rad_params_init(&b.params);
    if (at < argc && strncmp(argv[at], "--tiles=", 8) == 0)
        tiles = argv[at++] + 8;
    for (; at < argc && argv[at][0] == '-'; at += n) {
        n = rad_params_option(&b.params, argc - at, argv + at, &err);
        if (n < 0)
            die(&err);
        if (n == 0)
            load(&b, NULL, 0);
    }
    load(&b, argv + at, argc - at);
    if (tiles && b.n > 1)
        die_of("--tiles is for a single view");
    if (tiles)
        open_tiles(&b, tiles);
    open_job(&b);
    for (uint32_t i = 0; i < b.n; i++)
        live += render(&b, &b.frame[i]);
    tell(&b, "live", 0, live);
    close_job(&b);
    open_job(&b);
    rad_ambient_freeze(b.job->ambient);
    fill_and_render(&b, &filled, &rendered);
    tell(&b, "passes", filled, rendered);
    printf("%.0f bytes a record\n",
           (double)rad_ambient_bytes(b.job->ambient) /
               (double)rad_ambient_count(b.job->ambient));
    tell_between(&b);
    tell_picture(&b, live, rendered);
    close_job(&b);
    compile_release(&b.compiled);
    free(b.view);
    return 0;
}
