/* ambient.c - what the store of ambient records costs
 *
 *      ambient [-n records] [-t seconds] [rendering options]
 *              [scene.rad... view.vf]
 *
 * Records are made at points that the view sees, and where rays from there
 * land, until there are so many; then they are put into an empty cache, as
 * another worker's would be, and looked up at fresh points of both kinds, all
 * in one thread.  Beside that stands what one ray of a hemisphere takes, with
 * its direct light and without a look-up.  Without a scene the room is empty,
 * and the records made up: on its six walls, of any size.  */
#include "config.h"

#define TOOL "ambient"
#include "tool.h"

#include "base/files.h"
#include "base/rng.h"
#include "base/vec.h"
#include "compile/compile.h"
#include "light/indirect/ambient.h"
#include "picture/view.h"
#include "scene/file/parse.h"

#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NPLACES   100000
#define MAX_WALKS 1000000 /* where records have become dense enough */

struct bench {
    struct compiled compiled; /* of a scene of files */
    const struct rad_scene *scene;
    struct rad_files files;
    struct rad_params params;
    struct rad_view view;
    double seconds; /* at least so long for each figure */
    size_t nrecs;
    struct rad_ambrec *rec;
    struct rad_ambplace *place; /* NPLACES */
    struct rad_span *span;      /* NPLACES rays of hemispheres */
};

static struct rad_job *
new_job(const struct bench *b, int bounces)
{
    struct rad_params params = b->params;
    struct rad_error err = { 0 };
    struct rad_job *job;

    params.ambounce = bounces;
    job = rad_job_new(b->scene, &params, &b->files, &err);
    if (!job)
        die(&err);
    return job;
}

/* --- points --- */

/* A cosine-distributed direction about n. */
static void
scatter(const double n[3], uint64_t key, double dir[3])
{
    double u[3], v[3], r = sqrt(rad_rand(key, 3));
    double phi = 2 * M_PI * rad_rand(key, 4);

    rad_frame(u, v, n);
    rad_scale(dir, sqrt(1 - r * r), n);
    rad_madd(dir, dir, r * cos(phi), u);
    rad_madd(dir, dir, r * sin(phi), v);
    rad_normalize(dir);
}

/* Where the ray lands, on the side that it comes from. */
static bool
land(const struct rad_job *job, const struct rad_span *s, struct rad_hit *hit,
     struct rad_ambplace *at)
{
    struct rad_geom_counts counts = { 0 };

    if (!rad_geom_nearest(job->geom, s, hit, &counts))
        return false;
    rad_scale(hit->n, rad_dot(hit->n, s->dir) < 0 ? 1 : -1, hit->n);
    *at = (struct rad_ambplace){ .err = hit->err, .weight = 1 };
    rad_copy(at->p, hit->p);
    rad_copy(at->n, hit->n);
    rad_copy(at->pn, hit->n);
    return true;
}

/* Walk number i: what the view sees at a random place, and where a ray of that
 * place's hemisphere lands; false: it leaves the scene. */
static bool
walk(const struct bench *b, const struct rad_job *job, uint64_t i,
     struct rad_ambplace at[2], struct rad_span *ray)
{
    uint64_t key = rad_key_branch(11, i);
    struct rad_span s = { .tmax = INFINITY };
    struct rad_hit hit;

    if (rad_view_ray(&b->view, rad_rand(key, 1), rad_rand(key, 2), s.org,
                     s.dir) < 0 ||
        !land(job, &s, &hit, &at[0]))
        return false;
    scatter(hit.n, key, s.dir);
    rad_geom_leave(&hit, s.dir, s.org);
    *ray = s;
    if (!land(job, &s, &hit, &at[1]))
        return false;
    at[1].level = 1;
    at[1].weight = .5;
    return true;
}

static void
draw_places(struct bench *b)
{
    struct rad_job *job = new_job(b, 0);
    struct rad_ambplace at[2];
    size_t n = 0;

    b->place = calloc(NPLACES, sizeof *b->place);
    b->span = calloc(NPLACES, sizeof *b->span);
    if (!b->place || !b->span)
        die_of("out of memory");
    for (uint64_t i = UINT64_C(1) << 40; n < NPLACES; i++)
        if (walk(b, job, i, at, &b->span[n])) {
            b->place[n] = at[n & 1];
            n++;
        }
    rad_job_free(job);
}

/* --- records --- */

static void
keep_records(struct bench *b, const struct rad_ambient *amb)
{
    uint64_t cursor = 0;

    b->nrecs = rad_ambient_count(amb);
    b->rec = calloc(b->nrecs, sizeof *b->rec);
    if (!b->rec)
        die_of("out of memory");
    b->nrecs = rad_ambient_list(amb, &cursor, b->rec, b->nrecs);
}

static void
make_records(struct bench *b)
{
    struct rad_job *job = new_job(b, b->params.ambounce);
    struct rad_error err = { 0 };
    double start = now();
    struct rad_ctx ctx;

    if (!job->ambient)
        die_of("the options have no ambient cache");
    if (rad_ctx_init(&ctx, job, &err) < 0)
        die(&err);
    for (uint64_t i = 0;
         rad_ambient_count(job->ambient) < b->nrecs && i < MAX_WALKS; i++) {
        struct rad_ambplace at[2];
        struct rad_span ray;
        struct rad_ray r;

        if (walk(b, job, i, at, &ray))
            rad_ray_irradiance(&ctx, &r, at[0].p, at[0].n, i);
    }
    keep_records(b, job->ambient);
    printf("%zu records made in %.1f s, %.0f ns a hemisphere's ray\n", b->nrecs,
           now() - start,
           1e9 * (now() - start) / (double)ctx.counts.ambient_rays);
    rad_ctx_release(&ctx);
    rad_job_free(job);
}

/* On a wall of the room from 0 to 10. */
static struct rad_ambrec
invent(uint64_t i)
{
    uint64_t key = rad_key_branch(12, i);
    int axis = (int)(3 * rad_rand(key, 0)), side = rad_rand(key, 1) < .5;
    float size = (float)exp(4 * rad_rand(key, 4));
    struct rad_ambrec rec = { .radius = { .2f * size, .2f * size },
                              .E = rad_grey(1),
                              .weight = i & 1 ? .5f : 1,
                              .level = i & 1 };

    rec.p[axis] = side ? 10 : 0;
    rec.p[(axis + 1) % 3] = 10 * rad_rand(key, 2);
    rec.p[(axis + 2) % 3] = 10 * rad_rand(key, 3);
    rec.n[axis] = side ? -1 : 1;
    rec.u[(axis + 1) % 3] = 1;
    return rec;
}

static void
invent_records(struct bench *b)
{
    b->rec = calloc(b->nrecs, sizeof *b->rec);
    if (!b->rec)
        die_of("out of memory");
    for (size_t i = 0; i < b->nrecs; i++)
        b->rec[i] = invent(i);
}

/* --- measuring --- */

static size_t
heap(void)
{
    struct mallinfo2 m = mallinfo2();

    return m.uordblks + m.hblkhd;
}

static void
insert_all(const struct bench *b, struct rad_job *job)
{
    for (size_t i = 0; i < b->nrecs; i++)
        rad_ambient_insert(job->ambient, &b->rec[i]);
}

/* The best of several rounds: what else the machine does only slows. */
static void
time_insertion(const struct bench *b)
{
    double start = now(), best = INFINITY;
    size_t bytes = 0;

    do {
        struct rad_job *job = new_job(b, b->params.ambounce);
        size_t before = heap();
        double round = now();

        insert_all(b, job);
        best = fmin(best, now() - round);
        bytes = heap() - before;
        rad_job_free(job);
    } while (now() - start < b->seconds);
    printf("insertion   %8.0f ns a record, %.0f bytes\n",
           1e9 * best / (double)b->nrecs, (double)bytes / (double)b->nrecs);
}

static void
time_look_up(const struct bench *b)
{
    struct rad_job *job = new_job(b, b->params.ambounce);
    double start = now(), best = INFINITY, sum = 0;
    uint64_t rays = 0;
    size_t hits = 0;

    insert_all(b, job);
    do {
        struct rad_geom_counts counts = { 0 };
        double round = now();

        rays = hits = 0;
        sum = 0;
        for (int i = 0; i < NPLACES; i++) {
            struct rad_rgb E = { 0, 0, 0 };

            hits += rad_ambient_find(job->ambient, &b->place[i], &E, &counts,
                                     &rays) > 0;
            sum += (double)E.g;
        }
        best = fmin(best, now() - round);
    } while (now() - start < b->seconds);
    printf("look-up     %8.0f ns, %.1f %% served, %.2f rays for leaks; "
           "mean E %.9g\n",
           1e9 * best / NPLACES, 100. * (double)hits / NPLACES,
           (double)rays / NPLACES, sum / NPLACES);
    rad_job_free(job);
}

static void
time_ray(const struct bench *b)
{
    struct rad_job *job = new_job(b, 0);
    struct rad_error err = { 0 };
    double start = now(), best = INFINITY;
    struct rad_ctx ctx;

    if (rad_ctx_init(&ctx, job, &err) < 0)
        die(&err);
    do {
        double round = now();

        for (int i = 0; i < NPLACES; i++) {
            struct rad_ray r;

            rad_ray_spawn(&ctx, &r, RAD_RAY_PRIMARY, NULL, NULL, 0);
            rad_copy(r.org, b->span[i].org);
            rad_copy(r.dir, b->span[i].dir);
            r.tmax = INFINITY;
            r.key = rad_key_branch(13, (uint64_t)i);
            rad_ray_trace(&ctx, &r);
        }
        best = fmin(best, now() - round);
    } while (now() - start < b->seconds);
    printf("one ray     %8.0f ns\n", 1e9 * best / NPLACES);
    rad_ctx_release(&ctx);
    rad_job_free(job);
}

/* --- scenes --- */

static void
load(struct bench *b, char **file, int n)
{
    struct rad_error err = { 0 };
    unsigned char *text;
    size_t len;

    if (n < 2)
        die_of("expected scene files and a view file");
    if (compile_read(
            &b->compiled,
            &(struct compile_from){ (const char *const *)file, n - 1, false },
            NULL, NULL, &err) < 0)
        die(&err);
    b->scene = b->compiled.scene;
    b->files = compile_files(&b->compiled);
    text = rad_file_read(file[n - 1], SIZE_MAX / 2, &len, &err);
    if (!text || rad_view_read(&b->view, (char *)text, len, &err) < 0)
        die(&err);
    free(text);
}

static void
build_room(struct bench *b)
{
    static const char text[] =
        "void plastic grey 0 0 5 .5 .5 .5 0 0\n"
        "void light lamp 0 0 3 9 9 9\n"
        "lamp sphere it 0 0 4 5 5 9 .1\n"
        "grey polygon a 0 0 12 0 0 0  10 0 0  10 10 0  0 10 0\n"
        "grey polygon b 0 0 12 0 0 10  0 10 10  10 10 10  10 0 10\n"
        "grey polygon c 0 0 12 0 0 0  0 10 0  0 10 10  0 0 10\n"
        "grey polygon d 0 0 12 10 0 0  10 0 10  10 10 10  10 10 0\n"
        "grey polygon e 0 0 12 0 0 0  0 0 10  10 0 10  10 0 0\n"
        "grey polygon f 0 0 12 0 10 0  10 10 0  10 10 10  0 10 10\n";
    struct rad_error err = { 0 };
    struct rad_scene *scene = rad_scene_new();

    if (!scene)
        die_of("out of memory");
    if (rad_parse_text(scene, text, sizeof text - 1, "room", NULL, &err) < 0 ||
        rad_scene_check(scene, NULL, NULL, &err) < 0)
        die(&err);
    b->scene = scene;
    rad_copy(b->view.vp, (double[]){ 1, 1, 5 });
    rad_copy(b->view.vdir, (double[]){ 1, 1, -.2 });
    b->view.horiz = b->view.vert = 90;
}

/* What the command line may overrule: records small enough for so many. */
static void
usual_options(struct rad_params *p)
{
    p->ambounce = 2;
    p->ambacc = .05;
    p->ambres = 1000;
    p->ambdiv = 64;
    p->ambssamp = 0;
    p->minweight = 1e-4;
}

int
main(int argc, char **argv)
{
    struct bench b = { .seconds = 1, .nrecs = 100000 };
    struct rad_error err = { 0 };
    int at = 1, n;

    rad_params_init(&b.params);
    rad_view_init(&b.view);
    usual_options(&b.params);
    while (at < argc && argv[at][0] == '-') {
        if (at + 1 < argc && strcmp(argv[at], "-n") == 0) {
            b.nrecs = strtoul(argv[at + 1], NULL, 10);
            at += 2;
            continue;
        }
        if (at + 1 < argc && strcmp(argv[at], "-t") == 0) {
            b.seconds = strtod(argv[at + 1], NULL);
            at += 2;
            continue;
        }
        n = rad_params_option(&b.params, argc - at, argv + at, &err);
        if (n < 0)
            die(&err);
        if (n == 0)
            die_of("usage: ambient [-n records] [-t seconds] "
                   "[rendering options] [scene.rad... view.vf]");
        at += n;
    }
    if (at < argc)
        load(&b, argv + at, argc - at);
    else
        build_room(&b);
    if (rad_view_setup(&b.view, &err) < 0)
        die(&err);
    draw_places(&b);
    if (at < argc)
        make_records(&b);
    else
        invent_records(&b);
    time_insertion(&b);
    time_look_up(&b);
    time_ray(&b);
    return 0;
}
