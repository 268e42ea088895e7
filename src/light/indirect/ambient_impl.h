/* ambient_impl.h - fields and functions that the files of the ambient cache
 * share (inside light/indirect only) */
#ifndef RAD_LIGHT_AMBIENT_IMPL_H
#define RAD_LIGHT_AMBIENT_IMPL_H

#include "light/hemisphere/bright.h"
#include "light/record/ambcache.h"
#include "light/indirect/ambient.h"
#include "light/record/ambread.h"
#include "light/indirect/ambserving.h"
#include "light/indirect/ambshape.h"
#include "light/indirect/ambsmooth.h"
#include "light/indirect/ambtile.h"

#include <stdatomic.h>

/* The reflectance that is assumed where the real reflectance must not matter:
 * each bounce halves the weight of records, and -aw makes radiances of the
 * records' irradiances. */
#define RAD_AMBIENT_MEAN_REFLECTANCE .5

/* For -aw, logarithms of luminances are summed as integers in this unit: such
 * sums do not depend on their order. */
#define RAD_AMBIENT_LOG_UNIT 0x1p-20

/* The records that a ray of this weight may use. */
struct rad_ambterms {
    float weight;
    float max_angle; /* between the normals [rad], measured as their chord */
    struct rad_ambfit fit;
};

/* rad_ambient has terms for the usual weights of so many levels. */
#define RAD_AMBIENT_USUAL 8

/* A state of a frozen cache: its first n records. */
struct rad_ambview {
    size_t n;
    struct rad_bright bright; /* places by the glints of these records */
    /* sum of the logarithms of these records' luminances
     * [RAD_AMBIENT_LOG_UNIT], and the number of these luminances */
    int64_t log_sum, log_count;
};

struct rad_ambient {
    const struct rad_job *job;   /* [fixed] */
    struct rad_ambcache *cache;  /* [fixed] the records of a live cache */
    struct rad_ambread read;     /* the records of a frozen cache */
    struct rad_ambsmooth smooth; /* smoothed values of a frozen cache */
    double org[3];               /* [fixed] the cube's corner */
    struct rad_ambscale scale;   /* [fixed] */
    /* of `read`, by number of settlings modulo */
    struct rad_ambview view[RAD_AMBIENT_VIEWS];
    const struct rad_ambview *newest; /* of these that is whole */
    bool frozen; /* [fixed] once there are records */
    bool blind;  /* memory was out for a view's bright places */
    /* [fixed] by level, for rays of the weight that is usual there */
    struct rad_ambterms usual[RAD_AMBIENT_USUAL];
    _Atomic int64_t log_sum; /* [atomic] relaxed: an average may lag */
    _Atomic int64_t log_count;
    _Atomic size_t held; /* [atomic] read.n, for the loop thread */
    uint64_t drained;    /* [loop] log position of rad_ambient_drain */
};

/* ambient.c: keep a sound record that the context made: in a live cache, or
 * with the context's tile.  False: the record was not kept. */
bool rad_ambient_keep(struct rad_ctx *ctx, const struct rad_ambrec *rec);

/* Has the context's tile traced all rays that it may?  A hemisphere that is
 * under way then is given up: no record is kept of it. */
static inline bool
rad_ambient_gave_up(const struct rad_ctx *ctx)
{
    return ctx->tile && ctx->counts.ambient_rays >= ctx->tile->end;
}

/* The state of a frozen cache that rays read; tile: the context's, or NULL. */
static inline const struct rad_ambview *
rad_ambient_seen(const struct rad_ambient *amb, const struct rad_ambtile *tile)
{
    return tile ? tile->view : amb->newest;
}

/* ambient_find.c: set *t for rays of that weight. */
void rad_ambient_set_terms(const struct rad_ambient *amb, float weight,
                           struct rad_ambterms *t);

/* How records are looked for. */
struct rad_ambasker {
    const struct rad_ambtile *tile; /* the tile's own records serve, too; or
                                     * NULL */
    bool fresh; /* find nothing, as if there were no records */
    bool only;  /* find out whether any record serves; E is not wanted */
    bool sensor; /* leave out records beyond -aa, and those that a surface parts
                  * from the place */
    struct rad_ambserving *serving; /* gets the records that serve at level 0;
                                     * or NULL */
    struct rad_geom_counts *counts; /* work of rays that test for light leaks */
    uint64_t *rays;                 /* the number of these rays is added */
};

/* The records' answer. */
struct rad_ambsaid {
    double serves;    /* weight of records within -aa; if it is positive, no
                       * further record is needed */
    double weight;    /* of all records found */
    struct rad_rgb E; /* mean of all records found, if weight is positive and
                       * !only */
    double off;       /* expected squared error of E, over its square; 0 at a
                       * level above 0 */
};

/* ambient_find.c: look for records at a place and set *said. */
void rad_ambient_ask(const struct rad_ambient *amb,
                     const struct rad_ambplace *at,
                     const struct rad_ambasker *asker,
                     struct rad_ambsaid *said);

/* An extrapolation is believed up to these factors. */
#define RAD_AMBIENT_LEAST_FACTOR   .05f
#define RAD_AMBIENT_LARGEST_FACTOR 20.f

static inline float
rad_dotf(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Set *factor, by which the record's E changes for a surface with normal pn
 * where it changes by `moved' in its plane; false: the factor is below the
 * least, which *factor gets.  The tilt n x pn has the components -pn.across and
 * pn.u.  */
static inline bool
rad_ambient_extrapolate(const struct rad_ambitem *it, const float across[3],
                        float moved, const float pn[3], float *factor)
{
    float f = moved + (it->gdir[1] * rad_dotf(pn, it->u) -
                       it->gdir[0] * rad_dotf(pn, across));

    *factor = f < RAD_AMBIENT_LARGEST_FACTOR ? f : RAD_AMBIENT_LARGEST_FACTOR;
    if (f > RAD_AMBIENT_LEAST_FACTOR)
        return true;
    *factor = RAD_AMBIENT_LEAST_FACTOR;
    return false;
}

#endif
