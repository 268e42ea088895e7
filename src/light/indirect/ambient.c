/* ambient.c - see ambient.h
 *
 * Where the cache misses, the hemisphere is sampled (hemisphere.c) and a
 * record is made of it: E, how it changes as the point moves and the normal
 * turns, and an elliptic zone in which a linear extrapolation is good
 * (ambshape.c).
 *
 * Where the zones of several records reach, their extrapolations are averaged
 * with weights that fall to zero at the edges of the zones, in distance and in
 * angle, so nothing jumps where a zone ends.
 *
 * A record serves its own level alone.  One of a lower level holds the light of
 * more bounces than a deeper ray has left, so that as many bounces as -ab says
 * would become up to twice as many: with -ab 4 the Cornell box was 1.6 % too
 * bright however fine the cache.
 *
 * Light leaks: a record made in the open, near a wall that does not reach down
 * to it, must not serve beyond the wall.  A record remembers in which
 * directions something stood near by at the horizon; asked for from there, it
 * serves only if a ray toward a place above it passes.
 *
 * The cache's cube is the one in which oconv would put the scene, and -ar
 * counts in it as rpict has it.  */
#include "config.h"

#include "light/indirect/ambient.h"
#include "light/indirect/ambcache.h"
#include "light/indirect/ambread.h"
#include "light/indirect/ambshape.h"
#include "light/indirect/ambsmooth.h"
#include "light/indirect/ambtile.h"
#include "light/indirect/bright.h"
#include "light/indirect/gradient.h"
#include "light/indirect/hemisphere.h"
#include "arith/elementary.h"
#include "base/vec.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* Reflectance that is assumed where the real one must not matter: each bounce
 * halves the weight of records, and -aw averages radiance, not irradiance. */
#define MEAN_REFLECTANCE .5

/* A factor beyond which an extrapolation is not believed. */
#define LEAST_FACTOR   .05f
#define LARGEST_FACTOR 20.f

/* Zones of the smaller cells suffice if their weights sum to this. */
#define ENOUGH_WEIGHT .05

/* Where the cache is frozen, so much farther than -aa deep records are asked
 * for: by tiles of passes that are not for them.  Those would be made by each
 * tile that lacks them. */
#define DEEP_REACH 1.25

/* For a glance hemispheres are so much coarser where no record is near. */
#define GLANCE_SHARE (1. / 16)

/* The least weight of records beyond -aa that serve. */
#define LEAST_FAR_WEIGHT 1e-3

/* Whether something stands before a record takes a ray to find out.  Where it
 * matters only whether some record serves, and for deep ones of a frozen cache,
 * so many such records are put off, and left out if others have that weight. */
#define ENOUGH_DEEP  .05
#define MOST_PUT_OFF 24

/* -aw: luminances are averaged by logarithm, in units of 2^-20, for sums of
 * integers do not depend on their order. */
#define LOG_UNIT 0x1p-20

/* Of a record's rays so many will do for a place that a frozen cache lacks and
 * one pixel shows, and for deeper records of a tile that has traced its rays. */
#define ALONE_SHARE .25

/* Stands for infinity in the positions of what is seen, in sides of the
 * scene's cube: far enough to be still as the point moves. */
#define FAR_SIDES 10.

/* Fewest cells along a side: what a picture shows needs gradients. */
#define SIDE_SHOWN 7
#define SIDE_DEEP  5

/* What records for light rays are for, in parts of the weight of rays that have
 * been reflected as often. */
#define LIGHT .125

/* What a search for a ray of some weight looks for. */
struct terms {
    float weight;
    float max_angle; /* between the normals [rad], as their chord has it */
    struct rad_ambfit fit;
};

#define USUAL_LEVELS 8

struct rad_ambient {
    const struct rad_job *job;  /* [fixed] */
    struct rad_ambcache *cache; /* [fixed] of a cache that is not frozen */
    struct rad_ambread read;    /* of one that is */
    struct rad_ambsmooth smooth; /* the same with less noise */
    double org[3];              /* [fixed] the cube's corner */
    struct rad_ambscale scale;  /* [fixed] */
    struct rad_bright bright;   /* places by the records of that */
    bool frozen;                /* [fixed] once there are records */
    /* [fixed] for rays that hemispheres alone have made lighter */
    struct terms usual[USUAL_LEVELS];
    _Atomic int64_t log_sum; /* [atomic] relaxed: an average may lag */
    _Atomic int64_t log_count;
    uint64_t drained; /* [loop] log position of rad_ambient_drain */
};

/* Ten degrees and -aa radians; more for rays that weigh little. */
static void
set_terms(const struct rad_ambient *amb, float weight, struct terms *t)
{
    double angle = M_PI / 18 + amb->scale.ambacc;

    if (weight < .6f)
        angle = M_PI / 2 - (M_PI / 2 - angle) * rad_pow((double)weight, .13);
    t->weight = weight;
    t->max_angle = (float)angle;
    rad_ambfit_set(&t->fit, rad_most(1 - .5 * angle * angle, 0),
                   .9 * (double)weight);
}

struct rad_ambient *
rad_ambient_new(const struct rad_job *job, struct rad_error *err)
{
    struct rad_ambient *amb = calloc(1, sizeof *amb);
    double lo[3], hi[3], side = 0;

    if (!amb)
        goto nomem;
    amb->job = job;
    rad_geom_bounds(job->geom, lo, hi);
    for (int k = 0; k < 3; k++)
        side = rad_most(side, hi[k] - lo[k]);
    rad_ambscale_set(&amb->scale, side, &job->params);
    for (int k = 0; k < 3; k++)
        amb->org[k] = (lo[k] + hi[k] - amb->scale.side) / 2;
    for (int i = 0; i < USUAL_LEVELS; i++)
        set_terms(amb, (float)rad_pow(MEAN_REFLECTANCE, i), &amb->usual[i]);
    rad_ambread_init(&amb->read, amb->org, amb->scale.side);
    amb->cache = rad_ambcache_new(amb->org, amb->scale.side);
    if (amb->cache)
        return amb;
nomem:
    free(amb);
    rad_fail(err, RAD_ENOMEM, "out of memory");
    return NULL;
}

void
rad_ambient_free(struct rad_ambient *amb)
{
    if (!amb)
        return;
    rad_ambcache_free(amb->cache);
    rad_ambread_release(&amb->read);
    rad_ambsmooth_release(&amb->smooth);
    free(amb);
}

void
rad_ambient_freeze(struct rad_ambient *amb)
{
    amb->frozen = true;
    rad_ambcache_free(amb->cache);
    amb->cache = NULL;
    amb->scale.deep = DEEP_REACH * amb->scale.ambacc;
}

bool
rad_ambient_is_frozen(const struct rad_ambient *amb)
{
    return amb->frozen;
}

void
rad_ambient_cube(const struct rad_ambient *amb, double org[3], double *side)
{
    rad_copy(org, amb->org);
    *side = amb->scale.side;
}

/* --- records --- */

static bool
is_finite(const float *v, int n)
{
    for (int i = 0; i < n; i++)
        if (!(v[i] >= -3.4e38f && v[i] <= 3.4e38f))
            return false;
    return true;
}

/* Unit length, and perpendicular to w unless w is NULL, to what single
 * precision and a conversion on the way may lose. */
static bool
is_direction(const float v[3], const float *w)
{
    double len2 =
        (double)v[0] * v[0] + (double)v[1] * v[1] + (double)v[2] * v[2];

    if (!(fabs(len2 - 1) < 1e-4))
        return false;
    return !w || fabs((double)v[0] * w[0] + (double)v[1] * w[1] +
                      (double)v[2] * w[2]) < 1e-3;
}

/* Variances of E over its square are 1 where one ray met all the light, and
 * hardly more anywhere; glints lie within FAR_SIDES, in the cube of the scene
 * that a record was made for. */
#define MOST_VARIANCE 1000
#define MOST_SIDES    1000

/* Could this be a record of ours?  In the cube, or off it by rounding. */
static bool
is_plausible(const struct rad_ambient *amb, const struct rad_ambrec *rec)
{
    for (int k = 0; k < 3; k++) {
        double off = rec->p[k] - amb->org[k], slack = 1e-3 * amb->scale.side;
        double seen = (double)rec->glint.p[k] - amb->org[k];

        if (!(off >= -slack && off <= amb->scale.side + slack) ||
            (rec->glint.lum > 0 &&
             !(fabs(seen) <= MOST_SIDES * amb->scale.side)))
            return false;
    }
    return is_direction(rec->n, NULL) && is_direction(rec->u, rec->n) &&
           rec->radius[0] > 0 && rec->radius[0] <= rec->radius[1] &&
           rec->radius[1] <= 1.001 * amb->scale.most && rad_rgb_sound(rec->E) &&
           is_finite(rec->gpos, 2) && is_finite(rec->gdir, 2) &&
           (rec->var == RAD_AMBREC_UNSURE ||
            (rec->var >= 0 && rec->var <= MOST_VARIANCE)) &&
           is_finite(rec->glint.p, 3) && is_finite(&rec->glint.lum, 1) &&
           rec->glint.lum >= 0 && rec->weight > 0 && rec->weight <= 2 &&
           rec->level < amb->job->params.ambounce;
}

static struct rad_ambzone
zone_of(const struct rad_ambient *amb, const struct rad_ambrec *rec)
{
    double reach = rad_ambscale_reach(&amb->scale, rec->level);

    return (struct rad_ambzone){ .reach = rec->radius[1] * reach,
                                 .height = rec->radius[0] * reach,
                                 .behind =
                                     amb->scale.least * amb->scale.ambacc };
}

/* For -aw, a record that was inserted. */
static void
count_light(struct rad_ambient *amb, const struct rad_ambrec *rec)
{
    float lum = rad_rgb_lum(rec->E);

    if (!(amb->job->params.ambvwt > 0 && lum > 0))
        return;
    atomic_fetch_add_explicit(
        &amb->log_sum, (int64_t)floor(rad_log(lum / M_PI) / LOG_UNIT + .5),
        memory_order_relaxed);
    atomic_fetch_add_explicit(&amb->log_count, 1, memory_order_relaxed);
}

static bool
insert(struct rad_ambient *amb, const struct rad_ambrec *rec, bool local)
{
    struct rad_ambzone zone = zone_of(amb, rec);

    if (!is_plausible(amb, rec) ||
        !(amb->frozen ? rad_ambread_add(&amb->read, rec)
                      : rad_ambcache_insert(amb->cache, rec, &zone, local)))
        return false;
    count_light(amb, rec);
    return true;
}

/* Keep a record that was made here: in the cache, or with the tile. */
static bool
keep(struct rad_ambient *amb, struct rad_ambtile *tile,
     const struct rad_ambrec *rec)
{
    struct rad_ambzone zone;

    if (!amb->frozen)
        return insert(amb, rec, true);
    if (!tile || !is_plausible(amb, rec))
        return false;
    zone = zone_of(amb, rec);
    if (rad_ambcache_insert(tile->own, rec, &zone, true)) {
        tile->made += rec->level == tile->level;
        return true;
    }
    tile->failed = true;
    return false;
}

bool
rad_ambient_insert(struct rad_ambient *amb, const struct rad_ambrec *rec)
{
    return insert(amb, rec, false);
}

/* rad_ambread_zone_fn */
static struct rad_ambzone
zone_in(const void *arg, const struct rad_ambrec *rec)
{
    return zone_of(arg, rec);
}

bool
rad_ambient_settle(struct rad_ambient *amb)
{
    if (!amb->frozen || amb->read.settled == amb->read.n)
        return true;
    return rad_ambread_settle(&amb->read, zone_in, amb) &&
           rad_bright_gather(&amb->bright, &amb->read);
}

bool
rad_ambient_smooth(struct rad_ambient *amb)
{
    return !amb->frozen || rad_ambsmooth_make(&amb->smooth, &amb->scale,
                                              amb->read.item, amb->read.n);
}

void
rad_ambient_insert_all(struct rad_ambient *amb, struct rad_ambrec *rec,
                       size_t n)
{
    struct rad_ambzone zone[RAD_AMBIENT_TOGETHER];

    if (amb->frozen) {
        for (size_t i = 0; i < n; i++)
            insert(amb, &rec[i], false);
        return;
    }
    while (n > 0) {
        size_t most = n < RAD_AMBIENT_TOGETHER ? n : RAD_AMBIENT_TOGETHER;
        size_t good = 0;

        for (size_t i = 0; i < most; i++)
            if (is_plausible(amb, &rec[i])) {
                zone[good] = zone_of(amb, &rec[i]);
                rec[good++] = rec[i];
            }
        if (rad_ambcache_insert_all(amb->cache, rec, zone, good, false))
            for (size_t i = 0; i < good; i++)
                count_light(amb, &rec[i]);
        rec += most;
        n -= most;
    }
}

size_t
rad_ambient_drain(struct rad_ambient *amb, struct rad_ambrec *out, size_t max)
{
    return amb->frozen
               ? 0
               : rad_ambcache_read(amb->cache, &amb->drained, true, out, max);
}

size_t
rad_ambient_list(const struct rad_ambient *amb, uint64_t *cursor,
                 struct rad_ambrec *out, size_t max)
{
    return amb->frozen ? rad_ambread_list(&amb->read, cursor, out, max)
                       : rad_ambcache_read(amb->cache, cursor, false, out, max);
}

size_t
rad_ambient_count(const struct rad_ambient *amb)
{
    return amb->frozen ? amb->read.n : rad_ambcache_count(amb->cache);
}

/* --- interpolation --- */

static inline float
dotf(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The factor by which E of the record changes at displacement u, v in its plane
 * with normal pn; false: too far to be believed.  The tilt n x pn has the
 * components -pn.across and pn.u. */
static inline bool
extrapolate(const struct rad_ambitem *it, const float gpos[2], float u, float v,
            const float pn[3], float *factor)
{
    const struct rad_ambrec *rec = &it->rec;
    float f =
        1 + gpos[0] * u + gpos[1] * v +
        (rec->gdir[1] * dotf(pn, rec->u) - rec->gdir[0] * dotf(pn, it->across));

    *factor = f < LARGEST_FACTOR ? f : LARGEST_FACTOR;
    if (f > LEAST_FACTOR)
        return true;
    *factor = LEAST_FACTOR;
    return false;
}

/* Is something between the point and the air above the record?  The ray rises
 * at 20 degrees from the plane of the point, over what is small and does not
 * matter. */
static bool
is_walled_off(const struct rad_ambient *amb, const struct rad_ambplace *at,
              const struct rad_ambrec *rec, struct rad_geom_counts *counts,
              uint64_t *rays)
{
    double n[3] = { (double)rec->n[0], (double)rec->n[1], (double)rec->n[2] };
    double to[3], rise = rad_tan(M_PI / 9);
    struct rad_span span = { .tmin = 0 };
    struct rad_hit hit = { .err = at->err };

    rad_sub(to, rec->p, at->p);
    double height = rad_dot(to, at->n), d2 = rad_dot(to, to);
    double along = sqrt(rad_most(d2 - height * height, 0));
    double up = (rise * along - height) / rad_dot(n, at->n);

    if (!(up > 0))
        return false; /* the record is high enough itself */
    rad_madd(span.dir, to, up, n);
    span.tmax = rad_normalize(span.dir);
    rad_copy(hit.p, at->p);
    rad_copy(hit.n, at->n);
    rad_geom_leave(&hit, span.dir, span.org);
    ++*rays;
    return rad_geom_occluded(amb->job->geom, &span, RAD_VOID, NULL, counts);
}

struct search {
    const struct rad_ambient *amb;
    const struct rad_ambplace *at;
    float n[3], pn[3]; /* of at */
    float weight9;     /* the least of a record's */
    float max_angle;
    float aa, reach; /* relative distance of those that serve, are wanted */
    float behind;    /* distance behind a record's surface where it serves */
    double serves;   /* weight of those that make a further one needless */
    double weight;   /* found so far */
    double E[3];     /* weighted */
    /* how far they may be off: sums of squared luminances, and of variances of
     * those that are smoothed, weighted */
    double lum2, var;
    bool frozen; /* what comes now is of the frozen cache */
    struct rad_geom_counts *counts;
    uint64_t *rays;
    const struct rad_ambtile *tile; /* whose records serve, too; or NULL */
    bool asks; /* wanted is whether any serves, not what they hold */
    bool spares; /* records that something may stand before are put off, */
    int nput_off;
    const struct rad_ambitem *put_off[MOST_PUT_OFF];
};

/* No more need be looked at. */
static inline bool
is_answered(const struct search *s)
{
    return s->asks && s->serves > 0;
}

/* What a record says at its place. */
struct says {
    struct rad_rgb E;
    float gpos[2], var;
};

static inline void
hear(const struct search *s, const struct rad_ambitem *it, struct says *k)
{
    const struct rad_ambient *amb = s->amb;
    struct rad_smooth_value v;

    k->E = it->rec.E;
    k->gpos[0] = it->rec.gpos[0];
    k->gpos[1] = it->rec.gpos[1];
    k->var = 0;
    if (!s->frozen ||
        !rad_ambsmooth_at(&amb->smooth, (size_t)(it - amb->read.item), &v))
        return;
    k->E = rad_rgb(v.E[0], v.E[1], v.E[2]);
    k->gpos[0] = v.gpos[0];
    k->gpos[1] = v.gpos[1];
    k->var = v.var;
}

static inline void
add_record(struct search *s, const struct rad_ambitem *it)
{
    const struct rad_ambrec *rec = &it->rec;
    float d[3], u, v, z, x, y, h, dist2, dist, turn2, turn, factor;
    double w, angular, lum;
    struct says says;

    for (int k = 0; k < 3; k++)
        d[k] = (float)(s->at->p[k] - rec->p[k]);
    u = dotf(d, rec->u);
    v = dotf(d, it->across);
    z = dotf(d, rec->n);
    x = u * it->per[0];
    y = v * it->per[1];
    h = z * it->per[0];
    dist2 = x * x + y * y + h * h; /* in the zone's units */
    for (int k = 0; k < 3; k++)
        d[k] = rec->n[k] - s->n[k];
    /* the chord, which is the angle for small ones */
    turn2 = dotf(d, d);
    if (!(dist2 < s->reach * s->reach) | (z < s->behind) | (turn2 >= 2) |
        (rec->level != s->at->level) | (rec->weight < s->weight9))
        return;
    dist = sqrtf(dist2);
    turn = sqrtf(turn2);
    if (!(dist < s->reach) | (turn >= s->max_angle))
        return;
    hear(s, it, &says);
    if (!extrapolate(it, says.gpos, u, v, s->pn, &factor))
        return;
    if (rec->corral && rec->corral >> rad_part_of_turn(u, v) & 1) {
        if (s->spares && s->nput_off < MOST_PUT_OFF) {
            s->put_off[s->nput_off++] = it;
            return;
        }
        if (is_walled_off(s->amb, s->at, rec, s->counts, s->rays))
            return;
    }
    angular = (double)(1 - turn / s->max_angle);
    if (dist < s->aa)
        s->serves += angular * (double)(1 - dist / s->aa);
    w = angular * (double)(1 - dist / s->reach);
    s->weight += w;
    lum = (double)(factor * rad_rgb_lum(says.E));
    s->lum2 += w * lum * lum;
    s->var += w * (double)says.var;
    w *= (double)factor;
    s->E[0] += w * (double)says.E.r;
    s->E[1] += w * (double)says.E.g;
    s->E[2] += w * (double)says.E.b;
}

/* rad_ambcache_fn */
static void
add_records(void *arg, const struct rad_ambitem *const *found, int n)
{
    for (int i = 0; i < n && !is_answered(arg); i++)
        add_record(arg, found[i]);
}

/* Where small zones have given enough, large ones are left out, unless they
 * could not be much larger. */
static bool
want_more(void *arg, double side)
{
    const struct search *s = arg;

    return !is_answered(s) &&
           (s->serves < ENOUGH_WEIGHT ||
            side * s->amb->scale.ambacc <= s->amb->scale.least);
}

/* Look at records that were put off, of which those before `frozen` are of the
 * frozen cache, until what was found will do. */
static void
look_at_put_off(struct search *s, int frozen)
{
    s->spares = false;
    for (int i = 0; i < s->nput_off && !is_answered(s) &&
                    (s->asks || s->weight < ENOUGH_DEEP);
         i++) {
        s->frozen = i < frozen;
        add_record(s, s->put_off[i]);
    }
    s->frozen = false;
}

/* Find all that serves at s->at. */
static void
search_all(struct search *s)
{
    const struct rad_ambplace *at = s->at;
    const struct rad_ambient *amb = s->amb;
    const struct terms *t = &amb->usual[at->level % USUAL_LEVELS];
    struct terms others;
    struct rad_ambquery q = { .level = at->level };
    int frozen;

    if ((float)at->weight != t->weight) {
        set_terms(amb, (float)at->weight, &others);
        t = &others;
    }
    s->weight9 = (float)(.9 * at->weight);
    s->max_angle = t->max_angle;
    s->aa = (float)amb->scale.ambacc;
    s->reach =
        s->asks ? s->aa : (float)rad_ambscale_reach(&amb->scale, at->level);
    s->behind = -(float)(amb->scale.least * amb->scale.ambacc);
    q.fit = &t->fit;
    rad_copy(q.p, at->p);
    rad_copy(q.n, at->n);
    for (int k = 0; k < 3; k++) {
        s->n[k] = (float)at->n[k];
        s->pn[k] = (float)at->pn[k];
    }
    s->frozen = amb->frozen;
    s->spares = s->asks || (amb->frozen && at->level > 0);
    if (amb->frozen)
        rad_ambread_visit(&amb->read, &q, add_records, want_more, s);
    else
        rad_ambcache_visit(amb->cache, &q, add_records, want_more, s);
    s->frozen = false;
    frozen = s->nput_off;
    if (s->tile && !is_answered(s))
        rad_ambcache_visit(s->tile->own, &q, add_records, want_more, s);
    look_at_put_off(s, frozen);
}

/* Are records for such a place made now?  Those of a frozen cache are in a pass
 * of their own. */
static bool
is_due(const struct search *s)
{
    return !s->amb->frozen || (s->tile && s->tile->level == s->at->level);
}

/* Does what was found do, so that no record is made?  Of a frozen cache that is
 * not asked so much: the pass for these records has been. */
static bool
serves(const struct search *s)
{
    return s->serves > 0 || (!is_due(s) && s->weight > LEAST_FAR_WEIGHT);
}

static struct rad_rgb
found(const struct search *s)
{
    return rad_rgb((float)(s->E[0] / s->weight), (float)(s->E[1] / s->weight),
                   (float)(s->E[2] / s->weight));
}

double
rad_ambient_find(const struct rad_ambient *amb, const struct rad_ambplace *at,
                 struct rad_rgb *E, struct rad_geom_counts *counts,
                 uint64_t *rays)
{
    struct search s = { .amb = amb, .at = at, .counts = counts, .rays = rays };

    search_all(&s);
    if (s.serves > 0)
        *E = found(&s);
    return s.serves;
}

/* The square of how far what was found may be off, over its own: what the
 * records differ by, and what those that are smoothed may be off by themselves.
 */
static double
doubt(const struct search *s)
{
    double mean = rad_rgb_lum(found(s));

    if (!(mean > 0))
        return 0;
    return rad_most(s->lum2 / s->weight / (mean * mean) - 1, 0) +
           s->var / s->weight;
}

bool
rad_ambient_covers(const struct rad_ambient *amb, const struct rad_ambrec *rec)
{
    struct rad_ambplace at = { .level = rec->level, .weight = rec->weight };
    struct rad_geom_counts counts = { 0, 0 };
    struct rad_rgb E;
    uint64_t rays = 0;

    if (!is_plausible(amb, rec))
        return false;
    rad_copy(at.p, rec->p);
    at.err = 1e-6 * amb->scale.least;
    for (int k = 0; k < 3; k++)
        at.n[k] = at.pn[k] = rec->n[k];
    return rad_ambient_find(amb, &at, &E, &counts, &rays) > 0;
}

/* --- making records --- */

/* The weight that a record made here is for: that of a ray which has been
 * reflected as often, or of all that are much lighter: a record does not serve
 * a heavier ray than it is for, so if each were for one weight, rays of
 * slightly different weights would all make their own. */
static float
record_weight(const struct rad_ambplace *at)
{
    double usual = rad_pow(MEAN_REFLECTANCE, at->level);

    return (float)(at->weight < .1 * usual ? LIGHT * usual : usual);
}

/* Sample the hemisphere at a place and keep the result if it is fit to be
 * kept.  False: no light could be traced. */
static bool
make_record(struct rad_ctx *ctx, const struct rad_ray *r,
            const struct rad_ambplace *at, bool behind, struct rad_rgb *E)
{
    struct rad_ambient *amb = ctx->job->ambient;
    struct rad_ambrec rec = { .level = (uint16_t)at->level };
    struct rad_arena_mark mark = rad_arena_mark(&ctx->scratch);
    struct rad_hemi_plan plan = { .behind = behind, .store = true };
    uint64_t unsound = ctx->counts.unsound_rays;
    struct rad_hemi h;
    bool ok;

    rec.weight = record_weight(at);
    plan.weight = rad_ambrec_worth(&rec);
    if (amb->frozen && !ctx->fresh &&
        (!ctx->tile || (at->level > ctx->tile->level &&
                        ctx->counts.ambient_rays >= ctx->tile->most)))
        plan.weight *= ALONE_SHARE;
    if (ctx->glance)
        plan.weight *= GLANCE_SHARE;
    plan.side = at->level > 0 ? SIDE_DEEP : SIDE_SHOWN;
    plan.coef = rad_grey((float)MEAN_REFLECTANCE);
    plan.far = FAR_SIDES * amb->scale.side;
    plan.bright = amb->bright.n > 0 ? &amb->bright : NULL;
    rad_copy(plan.normal, at->n);
    ok = rad_hemi_sample(ctx, r, &plan, &h);
    if (ok)
        *E = h.E;
    /* what a NaN has touched on the way, now black, is not kept */
    if (ok && h.complete && ctx->counts.unsound_rays == unsound) {
        float pn[3] = { (float)at->pn[0], (float)at->pn[1], (float)at->pn[2] };
        struct rad_ambitem item;
        float factor;

        rad_copy(rec.p, at->p);
        for (int k = 0; k < 3; k++)
            rec.n[k] = (float)at->n[k];
        rec.E = h.E;
        rec.var = (float)h.var;
        rec.glint = rad_bright_glint(&h, at->p, r->key);
        rad_ambrec_shape(&amb->scale, &h, &rec);
        if (!ctx->aside && keep(amb, ctx->tile, &rec))
            ctx->counts.ambient_values++;
        rad_ambitem_set(&item, &rec);
        extrapolate(&item, rec.gpos, 0, 0, pn, &factor);
        *E = rad_rgb_scale(*E, factor);
    }
    rad_arena_rewind(&ctx->scratch, mark);
    return ok;
}

/* Without a cache: sample for this place alone. */
static bool
sample_here(struct rad_ctx *ctx, const struct rad_ray *r,
            const struct rad_ambplace *at, bool behind,
            const struct rad_rgb *coef, struct rad_rgb *E)
{
    struct rad_arena_mark mark = rad_arena_mark(&ctx->scratch);
    struct rad_hemi_plan plan = { .behind = behind,
                                  .coef = *coef,
                                  .weight = at->weight };
    struct rad_hemi h;
    double turn[2], axis[3];
    bool ok;

    rad_copy(plan.normal, at->n);
    ok = rad_hemi_sample(ctx, r, &plan, &h);
    if (ok) {
        *E = h.E;
        rad_cross(axis, at->n, at->pn);
        if (rad_dot(axis, axis) > 0 && rad_rgb_lum(*E) > 0) {
            rad_hemi_turn(&h, turn);
            double f =
                1 + turn[0] * rad_dot(axis, h.u) + turn[1] * rad_dot(axis, h.v);

            *E = rad_rgb_scale(*E, (float)rad_most(f, (double)LEAST_FACTOR));
        }
    }
    rad_arena_rewind(&ctx->scratch, mark);
    return ok;
}

/* --- use --- */

/* Diffuse bounces on the way to r's hit. */
static int
bounces(const struct rad_ray *r)
{
    int n = 0;

    for (; r; r = r->parent)
        if (r->kind & RAD_RAY_AMBIENT)
            n++;
    return n;
}

bool
rad_ambient_serves(struct rad_ctx *ctx, const struct rad_ambplace *at)
{
    struct search s = { .amb = ctx->job->ambient,
                        .at = at,
                        .counts = &ctx->counts.geom,
                        .rays = &ctx->counts.rays,
                        .tile = ctx->tile };

    s.asks = is_due(&s);
    search_all(&s);
    return serves(&s);
}

/* -av, or its mean with the records so far (-aw), times what a surface leaves
 * of it. */
static struct rad_rgb
constant_radiance(const struct rad_job *job)
{
    const struct rad_params *par = &job->params;
    struct rad_rgb av = par->ambval;
    const struct rad_ambient *amb = job->ambient;
    double lum = rad_rgb_lum(av), sum, n;

    if (!amb || par->ambvwt <= 0)
        return av;
    sum = (double)atomic_load_explicit(&amb->log_sum, memory_order_relaxed) *
          LOG_UNIT;
    n = (double)atomic_load_explicit(&amb->log_count, memory_order_relaxed);
    if (!(n > 0))
        return av;
    sum += n * rad_log(1 - MEAN_REFLECTANCE);
    if (!(lum > 0))
        return rad_grey((float)rad_exp(sum / n));
    sum += par->ambvwt * rad_log(lum);
    return rad_rgb_scale(av, (float)(rad_exp(sum / (par->ambvwt + n)) / lum));
}

/* E at the place, interpolated or sampled; false: neither is possible, or there
 * are records for it and nobody wants E: a tile of a pass asks for records.
 * *var becomes its relative variance, if it is known. */
static bool
irradiance(struct rad_ctx *ctx, const struct rad_ray *r,
           const struct rad_ambplace *at, bool behind,
           const struct rad_rgb *coef, struct rad_rgb *E, double *off)
{
    struct search s = { .amb = ctx->job->ambient,
                        .at = at,
                        .counts = &ctx->counts.geom,
                        .rays = &ctx->counts.rays,
                        .tile = ctx->tile };

    if (!s.amb)
        return sample_here(ctx, r, at, behind, coef, E);
    s.asks = ctx->tile && ctx->no_direct && is_due(&s);
    if (!ctx->fresh || at->level > 0)
        search_all(&s);
    if (!serves(&s) && !(ctx->glance && s.weight > LEAST_FAR_WEIGHT))
        return make_record(ctx, r, at, behind, E);
    if (s.asks)
        return false;
    *E = found(&s);
    *off = doubt(&s);
    return true;
}

/* What a pixel shows of L at r's hit may be off by that square. */
static void
note_doubt(struct rad_ctx *ctx, const struct rad_ray *r, struct rad_rgb L,
           double off)
{
    double lum = rad_rgb_lum(L);

    for (; r; r = r->parent)
        lum *= rad_rgb_lum(r->coef);
    ctx->doubt += lum * lum * off;
}

/* Is the surface that r met left out by -ae or -ai? */
static bool
left_out(const struct rad_job *job, const struct rad_ray *r)
{
    int32_t mod;

    if (!job->noambient || r->hit.obj == RAD_VOID)
        return false;
    mod = job->scene->objects[r->hit.obj].modifier;
    return mod != RAD_VOID && job->noambient[mod];
}

void
rad_ambient_apply(struct rad_ctx *ctx, struct rad_ray *r, const double n[3],
                  struct rad_rgb *coef)
{
    const struct rad_params *par = &ctx->job->params;
    struct rad_ambplace at;
    struct rad_rgb E = { 0, 0, 0 };
    double off = 0;
    bool behind = rad_dot(r->n, n) < 0;

    if (par->ambounce > 0 && par->ambdiv > 0 &&
        (at.level = bounces(r)) < par->ambounce && !left_out(ctx->job, r)) {
        at.weight = r->weight;
        rad_copy(at.p, r->hit.p);
        at.err = r->hit.err;
        rad_scale(at.n, behind ? -1 : 1, r->n);
        rad_copy(at.pn, n);
        if (irradiance(ctx, r, &at, behind, coef, &E, &off)) {
            *coef = rad_rgb_scale(rad_rgb_mul(*coef, E), (float)(1 / M_PI));
            if (at.level == 0)
                note_doubt(ctx, r, *coef, off);
            return;
        }
    }
    *coef = rad_rgb_mul(*coef, constant_radiance(ctx->job));
}
