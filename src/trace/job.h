/* job.h - a scene made ready to render under one set of parameters
 *
 * rad_job_new() compiles what the scene and the parameters need, and nothing
 * else: geometry, materials, light sources, and, only with -ab above 0 and -aa
 * above 0, the ambient cache.  Everything in it but the cache is read-only
 * afterwards, so one job serves any number of threads, each with a rad_ctx.
 * Work done here depends on scene, parameters and seed alone.
 * Thread: rad_job_new and rad_job_free on one thread with none rendering. */
#ifndef RAD_TRACE_JOB_H
#define RAD_TRACE_JOB_H

#include "base/arena.h"
#include "base/color.h"
#include "base/error.h"
#include "base/files.h"
#include "geom/geom.h"
#include "base/params.h"
#include "scene/scene.h"

struct rad_ambient;
struct rad_ambtile;
struct rad_calc;
struct rad_calc_env;
struct rad_material;
struct rad_medium;
struct rad_sources;
struct rad_stored;

struct rad_job {
    const struct rad_scene *scene;
    struct rad_params params;
    uint8_t primary[3];     /* of a colour, which number each channel shows */
    struct rad_arena arena; /* of the compiled modifiers and sources */
    struct rad_geom *geom;
    struct rad_material *materials; /* by object, up to the last modifier */
    uint8_t *cut; /* by object: does antimatter name this modifier?  NULL:
                   * there is no antimatter */
    int32_t *first_like; /* by object: the first of modifiers that are the same
                          * as this one; as long as `cut` */
    struct rad_sources *sources;
    uint8_t *noambient; /* by object: is this modifier left out by -ae or -ai?
                         * NULL: there is no list */
    struct rad_medium *medium; /* the scene's own; NULL: it scatters nothing */
    struct rad_calc *calc;     /* NULL: no functions */
    struct rad_stored *stored; /* data files and pictures; NULL: none */
    struct rad_ambient *ambient; /* NULL: no cache (-ab 0 or -aa 0) */
};

/* A colour that a scene gives as red, green and blue, as the job's channels
 * show it (base/bands.h). */
static inline struct rad_rgb
rad_job_colour(const struct rad_job *job, const double rgb[3])
{
    return rad_rgb((float)rgb[job->primary[0]], (float)rgb[job->primary[1]],
                   (float)rgb[job->primary[2]]);
}

/* The scene must have passed rad_scene_check() and must outlive the job; files
 * (NULL: there are none) is used during the call only.  NULL and *err on
 * failure. */
struct rad_job *rad_job_new(const struct rad_scene *scene,
                            const struct rad_params *params,
                            const struct rad_files *files,
                            struct rad_error *err);

/* Would its modifiers compile, with their functions, data, pictures, fonts and
 * BSDFs?  Nothing is kept.  Returns 0 or what rad_job_new() would fail with
 * there, the scene's file and line in *err. */
int rad_job_check(const struct rad_scene *scene, const struct rad_files *files,
                  struct rad_error *err);
void rad_job_free(struct rad_job *job);

/* Make pictures with so many rays of a pixel (--samples) from now on, which
 * nothing that is compiled depends on.  Thread: none renders. */
void rad_job_show(struct rad_job *job, int samples);

/* Objects whose functions failed to give a value, by number, the first few:
 * count 0 ends them. */
#define RAD_MAX_FAULTS 4
struct rad_fault {
    int32_t object;
    uint64_t count;
};

/* What one thread counts; summed by whoever owns the contexts. */
struct rad_counts {
    uint64_t rays;         /* all, as rpict's report counts them */
    uint64_t primary_rays; /* pixels traced */
    uint64_t shadow_rays;
    uint64_t ambient_rays;
    uint64_t paint_rays;     /* of painted small sources */
    uint64_t ambient_values; /* records made here */
    uint64_t nan_pixels;     /* that unsound rays touched */
    int nan_x, nan_y;        /* the first of them, by row, then column */
    uint64_t unsound_rays;   /* brought back no radiance (NaN, infinite, or
                              * negative for a pixel or a record), made sound:
                              * who sees it grow knows that what it has traced
                              * is touched by it */
    struct rad_fault faults[RAD_MAX_FAULTS];
    struct rad_geom_counts geom;
};

/* A function of that object had no value. */
void rad_counts_fault(struct rad_counts *c, int32_t object);

/* Unsound rays touched the pixel at column x and row y of the picture: by
 * its sample, or by a small source painted into it, which count apart. */
void rad_counts_nan(struct rad_counts *c, int x, int y);

#define RAD_AT(x, y)                                                           \
    (UINT64_C(1) << 63 | (uint64_t)(uint32_t)(y) << 31 | (uint32_t)(x))
#define RAD_AT_X(at) ((int)((at)&0x7fffffff))
#define RAD_AT_Y(at) ((int)((at) >> 31 & 0x7fffffff))

/* A primary ray that was set up ahead of its pixel (picture/frame.c). */
struct rad_aim {
    uint64_t frame; /* whose it is; 0: none */
    int x, y;       /* its pixel */
    int step;       /* from the pixel before to that one, along the row */
    bool seen;      /* the view has a ray there */
    uint64_t key;
    double org[3], dir[3], tmax;
};

/* What one thread needs to trace rays.  Not shared, but for `at`. */
struct rad_ctx {
    const struct rad_job *job;
    struct rad_arena scratch; /* marked and rewound around its users */
    struct rad_counts counts;
    /* the pixel it is at, RAD_AT(x, y), or 0 before the first: relaxed, for
     * whoever watches the thread */
    _Atomic uint64_t at;
    struct rad_aim aim;
    struct rad_calc_env *calc; /* NULL: no functions */
    struct rad_ambtile *tile;  /* ambient records that it makes; NULL: they go
                                * into the job's cache (light/indirect) */
    bool no_direct; /* only indirect light is wanted of what a pixel shows */
    bool glance;    /* indirect light need not be good */
    double doubt;   /* how far all that a pixel shows of indirect light may be
                     * off, as the records that serve tell: squares of
                     * luminances, added to what is there */
    bool fresh; /* what a pixel shows of indirect light is sampled for it alone,
                 * whatever the cache has */
    bool aside; /* no record is kept */
    bool sensor; /* what is seen is no picture's pixel but a sensor's: set when
                  * that is traced, and of use in what it shows itself alone */
    int32_t *last_blocker; /* by source or image of one: object that blocked
                            * last, or RAD_VOID; only ever speeds a test up */
};

int rad_ctx_init(struct rad_ctx *ctx, const struct rad_job *job,
                 struct rad_error *err);
void rad_ctx_release(struct rad_ctx *ctx);

#endif
