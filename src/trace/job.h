/* job.h - a scene made ready to render under one set of parameters
 *
 * rad_job_new() compiles what the scene and the parameters need: geometry,
 * materials, light sources, and, with -ab and -aa above 0, the ambient cache.
 * All but the cache is read-only afterwards, so one job serves any number of
 * threads, each with a rad_ctx of its own.
 * A job is a function of scene, parameters and seed.
 * Thread: rad_job_new and rad_job_free on one thread, while none renders. */
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
    uint8_t primary[3];     /* by channel: which of red, green, blue it shows */
    struct rad_arena arena; /* of the compiled modifiers and sources */
    struct rad_geom *geom;
    struct rad_material *materials; /* by object, up to the last modifier */
    uint8_t *cut; /* by object: does antimatter name this modifier?  NULL:
                   * there is no antimatter */
    int32_t *first_like; /* by object: the first modifier of equal definition
                          * (antimatter.c); NULL if `cut` is */
    struct rad_sources *sources;
    uint8_t *noambient; /* by object: is this modifier left out by -ae or -ai?
                         * NULL: there is no list */
    struct rad_medium *medium;   /* of the whole scene (-me -ma -mg); NULL: it
                                  * scatters nothing */
    struct rad_calc *calc;       /* NULL: no functions */
    struct rad_stored *stored;   /* data files and pictures; NULL: none */
    bool unseen; /* no ray will be traced, so pictures need no pixels */
    struct rad_ambient *ambient; /* NULL: no cache (-ab 0 or -aa 0) */
};

/* A scene's colour, of red, green and blue, in the job's channels
 * (base/bands.h). */
static inline struct rad_rgb
rad_job_colour(const struct rad_job *job, const double rgb[3])
{
    return rad_rgb((float)rgb[job->primary[0]], (float)rgb[job->primary[1]],
                   (float)rgb[job->primary[2]]);
}

/* Compile a job.  The scene must have passed rad_scene_check(), and must
 * outlive the job; files (NULL: there are none) is used during the call only.
 * NULL and *err on failure. */
struct rad_job *rad_job_new(const struct rad_scene *scene,
                            const struct rad_params *params,
                            const struct rad_files *files,
                            struct rad_error *err);

/* Do the scene's modifiers compile, with their functions, data, pictures, fonts
 * and BSDFs?  Nothing is kept.  0, or the code with which rad_job_new() would
 * fail there, and the scene's file and line in *err. */
int rad_job_check(const struct rad_scene *scene, const struct rad_files *files,
                  struct rad_error *err);
void rad_job_free(struct rad_job *job);

/* Trace so many rays for a pixel (--samples) from now on; nothing that is
 * compiled depends on it.  Thread: one, while none renders. */
void rad_job_show(struct rad_job *job, int samples);

/* Objects whose functions failed to give a value, or whose up vector failed to
 * orient a surface: the first few by number; the list ends with count 0. */
#define RAD_MAX_FAULTS 4
struct rad_fault {
    int32_t object;
    uint64_t count;
};

/* The counts of one thread; the owner of the contexts adds them up. */
struct rad_counts {
    uint64_t rays;         /* all, as rpict's report counts them */
    uint64_t primary_rays; /* of pixels */
    uint64_t shadow_rays;  /* toward light sources */
    uint64_t ambient_rays; /* of hemispheres, and of random paths (passes.c) */
    uint64_t paint_rays;   /* of painted small sources */
    uint64_t ambient_values; /* ambient records made */
    uint64_t nan_pixels;     /* rad_counts_nan() */
    int nan_x, nan_y;        /* the first of these, by row, then column */
    uint64_t unsound_rays;   /* rays whose radiance was NaN, infinite, or, for a
                              * pixel or a record, negative, and was replaced;
                              * if it grows while light is traced, that light
                              * is touched */
    struct rad_fault faults[RAD_MAX_FAULTS];
    struct rad_geom_counts geom;
};

/* Count that a function of the object had no value, or that its up vector does
 * not orient a surface. */
void rad_counts_fault(struct rad_counts *c, int32_t object);

/* Count that unsound rays touched the pixel at column x and row y: once for its
 * sample, and once for each small source painted into it. */
void rad_counts_nan(struct rad_counts *c, int x, int y);

/* A pixel as a number other than 0, and its column and row. */
#define RAD_AT(x, y)                                                           \
    (UINT64_C(1) << 63 | (uint64_t)(uint32_t)(y) << 31 | (uint32_t)(x))
#define RAD_AT_X(at) ((int)((at)&0x7fffffff))
#define RAD_AT_Y(at) ((int)((at) >> 31 & 0x7fffffff))

/* A primary ray that is set up before its pixel is asked for (picture/frame.c).
 */
struct rad_aim {
    uint64_t frame; /* stamp of its frame; 0: there is no ray */
    int x, y;       /* its pixel */
    int step;       /* columns from the pixel before to this one */
    bool seen;      /* the view has a ray there */
    uint64_t key;
    double org[3], dir[3], tmax;
};

struct rad_ambserving;

/* How a prism sent a shadow ray on. */
struct rad_bent {
    double dir[3], aim[3]; /* of the ray, and to its source; 0: none so far */
    double coef, out[3];   /* coefficient and direction of the ray beyond */
};

/* What one thread needs to trace rays.  Not shared, except for `at`. */
struct rad_ctx {
    const struct rad_job *job;
    struct rad_arena scratch; /* each user marks and rewinds it */
    struct rad_counts counts;
    /* the pixel being traced, RAD_AT(x, y), or 0 before the first: relaxed, for
     * a thread that watches this one */
    _Atomic uint64_t at;
    struct rad_aim aim;
    struct rad_calc_env *calc; /* NULL: no functions */
    struct rad_ambtile *tile;  /* the tile that gets new ambient records; NULL:
                                * they go to the job's cache, if that is live
                                * (light/indirect) */
    bool no_direct; /* leave out direct light, except at hemispheres' hits */
    bool glance;    /* indirect light may be coarse */
    double doubt;   /* expected squared errors of the luminance of indirect
                     * light in a pixel, by the records that serve: each is
                     * added; the user sets it to 0 */
    struct rad_ambserving *serving; /* gets the records that serve in a pixel
                                     * (light/indirect); NULL: not wanted */
    int walk;      /* not 0: indirect light is followed along a single path, to
                    * find what comes by more than so many bounces */
    double beyond; /* luminance that such paths bring to a pixel; the user sets
                    * it to 0 */
    uint32_t tree; /* rays so far of the tree that is traced (ray.h) */
    bool fresh;  /* find no records at points that pixels show: sample for the
                  * point alone */
    bool aside;  /* keep no record */
    bool sensor; /* the pixel is a sensor: set when its ray is traced, and read
                  * at the point that it shows */
    struct rad_span *relayed; /* gets where an untested shadow ray is sent on
                               * last; NULL: nowhere (light/direct) */
    int32_t *last_blocker; /* by source or image: object that blocked a shadow
                            * ray last, or RAD_VOID; only makes tests faster */
    struct rad_bent *bent; /* by image: the last shadow ray in its prism, where
                            * others of those directions go on alike */
};

/* Initialize a context for one thread.  0, or RAD_ENOMEM and *err. */
int rad_ctx_init(struct rad_ctx *ctx, const struct rad_job *job,
                 struct rad_error *err);
void rad_ctx_release(struct rad_ctx *ctx);

#endif
