/* ambient.h - cache of indirect irradiance shared by the rays of one job
 *
 * A record keeps the indirect irradiance E and its gradients at one surface
 * point; nearby rays interpolate it instead of sampling the hemisphere again.
 * E is irradiance [W/m^2], not E/pi.  Points are double[3] in world space,
 * lengths in scene units, normals of unit length.
 * Growth: append-only octrees (ambcache.c).  Readers never wait; an insertion
 * is a compare-and-swap on a list head; records are never moved or changed.
 * A frozen cache is an array and trees made anew after insertions (ambread.c).
 * Sources: Ward, Rubinstein & Clear 1988 (record radius, error);
 *          Ward & Heckbert 1992 (gradients);
 *          Schwarzhaupt, Jensen & Jarosz 2012 (Hessian radii). */
#ifndef RAD_LIGHT_AMBIENT_H
#define RAD_LIGHT_AMBIENT_H

#include "light/hemisphere/glint.h"
#include "trace/ray.h"

struct rad_ambient;

#define RAD_AMBREC_UNSURE (-1.f)

/* One record; also what travels between workers (proto/ packs it field by
 * field). */
struct rad_ambrec {
    double p[3];      /* position */
    float n[3];       /* unit normal of the side it was made on */
    float u[3];       /* unit vector of the smaller radius, in the tangent
                       * plane; the other axis is n x u */
    float radius[2];  /* validity radii along u and n x u, smaller first
                       * [scene units] */
    float weight;     /* ray weight it was made for */
    uint16_t level;   /* diffuse bounces before it, 0 for a primary ray */
    struct rad_rgb E; /* indirect irradiance [W/m^2] */
    float gpos[2];    /* translation gradient of ln E along u, n x u
                       * [1/unit], the same for all channels */
    float gdir[2];    /* rotation gradient about u, n x u [1/rad] */
    float var;        /* variance of E's luminance over its square, by the
                       * samples' noise; RAD_AMBREC_UNSURE: not known */
    struct rad_glint glint;
    uint32_t corral; /* directions blocked near by (leak plug) */
};

/* Thread: one thread makes and frees it; any number may find and insert. */
struct rad_ambient *rad_ambient_new(const struct rad_job *job,
                                    struct rad_error *err);
void rad_ambient_free(struct rad_ambient *amb);

/* From now on the cache changes by rad_ambient_insert() and
 * rad_ambient_insert_all() alone, with no thread rendering, and what these
 * brought serves once rad_ambient_settle() was called: what a place lacks is
 * made for the tile that asks (ambtile.h), or for that place alone.  To be
 * called before the first record. */
void rad_ambient_freeze(struct rad_ambient *amb);

/* Make of a frozen cache what look-ups read; to be called after insertions and
 * before the next look-up.  Nothing to do for one that is not frozen.  False:
 * out of memory; the cache must not be read then. */
bool rad_ambient_settle(struct rad_ambient *amb);

/* What look-ups read of a frozen cache, as it was before the last `behind`
 * times that it was settled; a tile (ambtile.h) sees that alone. */
#define RAD_AMBIENT_VIEWS 4
struct rad_ambview;
const struct rad_ambview *rad_ambient_view(const struct rad_ambient *amb,
                                           uint32_t behind);

/* All records of a settled cache are there: from now on pixels see what they
 * say with less noise (light/smooth/smooth.h); listed they are as they were
 * made.  To be called again after insertions.  Nothing to do for a cache that
 * is not frozen.  False: out of memory. */
bool rad_ambient_smooth(struct rad_ambient *amb);

bool rad_ambient_is_frozen(const struct rad_ambient *amb);

/* Bytes that the records of a frozen cache take, with what they are read by and
 * what smoothing knows of them. */
size_t rad_ambient_bytes(const struct rad_ambient *amb);

/* The cube that its records are in. */
void rad_ambient_cube(const struct rad_ambient *amb, double org[3],
                      double *side);

/* Insert a record that came from another worker.  False: refused (not finite,
 * not plausible in this scene, or memory is out), which costs time, not
 * correctness. */
bool rad_ambient_insert(struct rad_ambient *amb, const struct rad_ambrec *rec);

/* Insert n of them, RAD_AMBIENT_TOGETHER at a time, which takes half as long as
 * one after the other; what is refused is left out.  rec[] is overwritten. */
#define RAD_AMBIENT_TOGETHER 16
void rad_ambient_insert_all(struct rad_ambient *amb, struct rad_ambrec *rec,
                            size_t n);

/* Would the cache have served a new record's place already?  For the
 * redundancy meter: ask before inserting. */
bool rad_ambient_covers(const struct rad_ambient *amb,
                        const struct rad_ambrec *rec);

/* Where indirect light is asked for. */
struct rad_ambplace {
    double p[3];   /* point on a surface */
    double err;    /* bound of its distance from that [scene units] */
    double n[3];   /* its unit normal, on the side asked for */
    double pn[3];  /* the same as textures tilt it */
    int level;     /* diffuse bounces so far, 0 for a primary ray */
    double weight; /* of the ray, in (0, 1] */
};

/* Interpolate E at a place; *E is untouched on a miss.  A record made at
 * another level, whose E has more or fewer bounces, or for a clearly lighter
 * ray, does not serve.
 * Returns the summed record weight, 0 on a miss; cannot fail.  Takes no lock.
 *   counts  of the tests for light leaks; their number is added to *rays */
double rad_ambient_find(const struct rad_ambient *amb,
                        const struct rad_ambplace *at, struct rad_rgb *E,
                        struct rad_geom_counts *counts, uint64_t *rays);

/* Would the cache serve that place: need no record be made there? */
bool rad_ambient_serves(struct rad_ctx *ctx, const struct rad_ambplace *at);

/* Records that were made here since the last call, oldest first, at most max;
 * the loop thread sends them to the other workers.  One thread at a time. */
size_t rad_ambient_drain(struct rad_ambient *amb, struct rad_ambrec *out,
                         size_t max);

/* Walk all records, made here or received (a late joiner gets what there is):
 * call with *cursor = 0 first; returns how many were copied, 0 at the end.
 * Any number of walks may go on. */
size_t rad_ambient_list(const struct rad_ambient *amb, uint64_t *cursor,
                        struct rad_ambrec *out, size_t max);

/* How many there are.  Any thread may ask, while others insert, too. */
size_t rad_ambient_count(const struct rad_ambient *amb);

/* The indirect light at r's hit: coef (in: diffuse reflectance or
 * transmittance, out: radiance) *= E/pi on the side of unit normal n.  With
 * -ab 0 that is -av alone. */
void rad_ambient_apply(struct rad_ctx *ctx, struct rad_ray *r,
                       const double n[3], struct rad_rgb *coef);

#endif
