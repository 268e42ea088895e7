/* ambient_impl.h - what the files of the ambient cache share: its fields, and
 * what one does for another.  Not for others. */
#ifndef RAD_LIGHT_AMBIENT_IMPL_H
#define RAD_LIGHT_AMBIENT_IMPL_H

#include "light/hemisphere/bright.h"
#include "light/indirect/ambcache.h"
#include "light/indirect/ambient.h"
#include "light/indirect/ambread.h"
#include "light/indirect/ambshape.h"
#include "light/indirect/ambsmooth.h"
#include "light/indirect/ambtile.h"

#include <stdatomic.h>

/* Reflectance that is assumed where the real one must not matter: each bounce
 * halves the weight of records, and -aw averages radiance, not irradiance. */
#define RAD_AMBIENT_MEAN_REFLECTANCE .5

/* -aw: luminances are averaged by logarithm, in units of 2^-20, for sums of
 * integers do not depend on their order. */
#define RAD_AMBIENT_LOG_UNIT 0x1p-20

/* What a search for a ray of some weight looks for. */
struct rad_ambterms {
    float weight;
    float max_angle; /* between the normals [rad], as their chord has it */
    struct rad_ambfit fit;
};

#define RAD_AMBIENT_USUAL 8

/* A frozen cache with its first n records. */
struct rad_ambview {
    size_t n;
    struct rad_bright bright; /* places by these records */
    int64_t log_sum, log_count;
};

struct rad_ambient {
    const struct rad_job *job;   /* [fixed] */
    struct rad_ambcache *cache;  /* [fixed] of a cache that is not frozen */
    struct rad_ambread read;     /* of one that is */
    struct rad_ambsmooth smooth; /* the same with less noise */
    double org[3];               /* [fixed] the cube's corner */
    struct rad_ambscale scale;   /* [fixed] */
    struct rad_ambview view[RAD_AMBIENT_VIEWS]; /* of that, the last first */
    bool frozen; /* [fixed] once there are records */
    /* [fixed] for rays that hemispheres alone have made lighter */
    struct rad_ambterms usual[RAD_AMBIENT_USUAL];
    _Atomic int64_t log_sum; /* [atomic] relaxed: an average may lag */
    _Atomic int64_t log_count;
    _Atomic size_t held; /* [atomic] read.n, for the loop thread to tell */
    uint64_t drained;    /* [loop] log position of rad_ambient_drain */
};

/* ambient.c: keep a sound record that the context made, in the cache, or with
 * its tile.  False: it was not kept. */
bool rad_ambient_keep(struct rad_ctx *ctx, const struct rad_ambrec *rec);

/* Has the context's tile traced too much?  Hemispheres that are not done then
 * lack what they would have seen. */
static inline bool
rad_ambient_gave_up(const struct rad_ctx *ctx)
{
    return ctx->tile && ctx->counts.ambient_rays >= ctx->tile->end;
}

/* What rays read of a frozen cache, in that tile or in none. */
static inline const struct rad_ambview *
rad_ambient_seen(const struct rad_ambient *amb, const struct rad_ambtile *tile)
{
    return tile ? tile->view : amb->view;
}

/* ambient_find.c: what is to be looked for by rays of that weight. */
void rad_ambient_set_terms(const struct rad_ambient *amb, float weight,
                           struct rad_ambterms *t);

/* On whose behalf records are looked for, and how. */
struct rad_ambasker {
    const struct rad_ambtile *tile; /* whose records serve, too; or NULL */
    bool fresh; /* none is wanted, as if there were no records */
    bool only;  /* wanted is whether any serves, not what they hold */
    bool near;  /* those beyond -aa say nothing */
    struct rad_geom_counts *counts; /* of the tests for light leaks; */
    uint64_t *rays;                 /* their number is added to that */
};

struct rad_ambsaid {
    double serves;    /* weight of those that make a further one needless */
    double weight;    /* of all that were found */
    struct rad_rgb E; /* their mean, if there is weight */
    double off;       /* the square of how far that may be off, over its own;
                       * 0 where pixels do not ask, at level above 0 */
};

/* ambient_find.c: ask the records for a place. */
void rad_ambient_ask(const struct rad_ambient *amb,
                     const struct rad_ambplace *at,
                     const struct rad_ambasker *asker,
                     struct rad_ambsaid *said);

/* A factor beyond which an extrapolation is not believed. */
#define RAD_AMBIENT_LEAST_FACTOR   .05f
#define RAD_AMBIENT_LARGEST_FACTOR 20.f

static inline float
rad_dotf(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The factor by which E of the record changes at displacement u, v in its plane
 * with normal pn; false: too far to be believed.  The tilt n x pn has the
 * components -pn.across and pn.u. */
static inline bool
rad_ambient_extrapolate(const struct rad_ambitem *it, const float across[3],
                        const float gpos[2], float u, float v,
                        const float pn[3], float *factor)
{
    float f = 1 + gpos[0] * u + gpos[1] * v +
              (it->gdir[1] * rad_dotf(pn, it->u) -
               it->gdir[0] * rad_dotf(pn, across));

    *factor = f < RAD_AMBIENT_LARGEST_FACTOR ? f : RAD_AMBIENT_LARGEST_FACTOR;
    if (f > RAD_AMBIENT_LEAST_FACTOR)
        return true;
    *factor = RAD_AMBIENT_LEAST_FACTOR;
    return false;
}

#endif
