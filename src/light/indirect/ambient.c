/* ambient.c - the ambient records of a job: inserted, kept, listed; see
 * ambient.h
 *
 * ambient_find.c computes what records say of a place; ambient_apply.c makes
 * records.
 *
 * The cache's cube is the one that oconv would make about the scene; -ar is
 * relative to its side, as in rpict.  */
#include "config.h"

#include "light/indirect/ambient_impl.h"
#include "arith/elementary.h"
#include "base/number.h"
#include "base/vec.h"

#include <stdlib.h>
#include <string.h>

/* In a frozen cache, tiles of passes for other records ask for deep records up
 * to so many times -aa: else each tile that lacks a deep record would make it.
 */
#define DEEP_REACH 1.25

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
    for (int i = 0; i < RAD_AMBIENT_USUAL; i++)
        rad_ambient_set_terms(amb,
                              (float)rad_pow(RAD_AMBIENT_MEAN_REFLECTANCE, i),
                              &amb->usual[i]);
    rad_ambread_init(&amb->read, amb->org, amb->scale.side);
    amb->newest = amb->view;
    amb->cache = rad_ambcache_new(amb->org, amb->scale.side, false);
    if (amb->cache)
        return amb;
nomem:
    free(amb);
    rad_fail_memory(err);
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

/* Is v of unit length and, unless w is NULL, perpendicular to w?  Within the
 * errors of single precision and of a conversion. */
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

/* Limits of a plausible record.  The variance of E over its square is 1 where
 * one ray met all the light, and hardly ever more.  Glints lie within ten sides
 * of the cube of the scene for which the record was made, which may be another
 * version of this scene. */
#define MOST_VARIANCE 1000
#define MOST_SIDES    1000

bool
rad_ambient_fits(const struct rad_ambient *amb, const struct rad_ambrec *rec)
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
           rec->radius[1] <= 1.001 * amb->scale.widest &&
           rad_rgb_sound(rec->E) && is_finite(rec->gpos, 2) &&
           is_finite(rec->gdir, 2) &&
           (rec->var == RAD_AMBREC_UNSURE ||
            (rec->var >= 0 && rec->var <= MOST_VARIANCE)) &&
           is_finite(rec->glint.p, 3) && is_finite(&rec->glint.lum, 1) &&
           rec->glint.lum >= 0 && rec->weight > 0 && rec->weight <= 2 &&
           rec->level < amb->job->params.ambounce;
}

static struct rad_ambzone
zone_of(const struct rad_ambient *amb, const float radius[2], int level)
{
    double reach = rad_ambscale_reach(&amb->scale, level);

    return (struct rad_ambzone){ .reach = radius[1] * reach,
                                 .height = radius[0] * reach,
                                 .behind =
                                     amb->scale.least * amb->scale.ambacc };
}

/* Count the light of a record that was inserted: -aw wants the mean, and so do
 * hemispheres' guides (usual_luminance()). */
static void
count_light(struct rad_ambient *amb, const struct rad_ambrec *rec)
{
    float lum = rad_rgb_lum(rec->E);

    if (!(amb->frozen || amb->job->params.ambvwt > 0) || !(lum > 0))
        return;
    atomic_fetch_add_explicit(
        &amb->log_sum,
        (int64_t)floor(rad_log(lum / M_PI) / RAD_AMBIENT_LOG_UNIT + .5),
        memory_order_relaxed);
    atomic_fetch_add_explicit(&amb->log_count, 1, memory_order_relaxed);
}

static bool
insert(struct rad_ambient *amb, const struct rad_ambrec *rec, bool local)
{
    struct rad_ambzone zone = zone_of(amb, rec->radius, rec->level);

    if (!rad_ambient_fits(amb, rec))
        return false;
    if (rad_ambient_is_smooth(amb))
        rad_ambsmooth_release(&amb->smooth); /* has pointers to the records */
    if (!(amb->frozen ? rad_ambread_add(&amb->read, rec)
                      : rad_ambcache_insert(amb->cache, rec, &zone, local)))
        return false;
    if (amb->frozen) /* relaxed: threads that count the records read none */
        atomic_store_explicit(&amb->held, amb->read.n, memory_order_relaxed);
    count_light(amb, rec);
    return true;
}

bool
rad_ambient_keep(struct rad_ctx *ctx, const struct rad_ambrec *rec)
{
    struct rad_ambient *amb = ctx->job->ambient;
    struct rad_ambzone zone;

    if (!amb->frozen)
        return insert(amb, rec, true);
    if (!ctx->tile || rad_ambient_gave_up(ctx) || !rad_ambient_fits(amb, rec))
        return false;
    zone = zone_of(amb, rec->radius, rec->level);
    return rad_ambtile_add(ctx->tile, amb, rec, &zone);
}

bool
rad_ambient_insert(struct rad_ambient *amb, const struct rad_ambrec *rec)
{
    return insert(amb, rec, false);
}

/* rad_ambread_zone_fn */
static struct rad_ambzone
zone_in(const void *arg, const struct rad_ambitem *item)
{
    return zone_of(arg, item->radius, item->level);
}

/* The median coordinate of some MEDIAN_OF records. */
#define MEDIAN_OF 1024
static double
median(const struct rad_ambread *read, int axis)
{
    size_t stride = read->n / MEDIAN_OF + 1, n = 0;
    double at[MEDIAN_OF];

    for (size_t i = 0; i < read->n; i += stride)
        at[n++] = read->item[i].p[axis];
    qsort(at, n, sizeof *at, rad_compare_reals);
    return at[n / 2];
}

/* Set org to the corner of the cube for the grid of bright places, and return
 * its side.  Where a small part of the scene is shown it is a cube of that size
 * about the records: in a cell of the whole scene's all that is bright in a
 * room would be one place. */
static double
bright_cube(const struct rad_ambient *amb, double org[3])
{
    double side = amb->scale.shown_side;

    rad_copy(org, amb->read.org);
    if (!(side < amb->read.side) || amb->read.n == 0)
        return amb->read.side;
    for (int k = 0; k < 3; k++)
        org[k] = median(&amb->read, k) - side / 2;
    return side;
}

/* Gather the glints of all records into places. */
static bool
gather_bright(struct rad_ambient *amb, struct rad_bright *bright)
{
    const struct rad_ambread *read = &amb->read;
    struct rad_glint *glint = malloc(read->nglints * sizeof *glint + 1);
    double org[3], side = bright_cube(amb, org);
    bool ok;

    if (!glint)
        return false;
    for (size_t i = 0; i < read->nglints; i++)
        glint[i] = read->glint[i].glint;
    ok = rad_bright_gather(bright, glint, read->nglints, org, side);
    free(glint);
    return ok;
}

/* The view that the settling begun last makes. */
static struct rad_ambview *
view_to_be(struct rad_ambient *amb)
{
    return &amb->view[amb->read.settlings % RAD_AMBIENT_VIEWS];
}

_Static_assert(RAD_AMBIENT_VIEWS == RAD_AMBREAD_LATE + 1,
               "trees are kept as long as views");

size_t
rad_ambient_settle_begin(struct rad_ambient *amb, bool alone)
{
    const struct rad_ambview *last = amb->newest;
    struct rad_ambview *now;
    size_t pieces;

    if (!amb->frozen)
        return 0;
    pieces = rad_ambread_settle_begin(&amb->read, alone, zone_in, amb);
    now = view_to_be(amb);
    if (last->n == amb->read.n) {
        *now = *last;
        return 0;
    }
    now->n = amb->read.n;
    now->log_sum = atomic_load_explicit(&amb->log_sum, memory_order_relaxed);
    now->log_count =
        atomic_load_explicit(&amb->log_count, memory_order_relaxed);
    return 1 + pieces;
}

void
rad_ambient_settle_piece(struct rad_ambient *amb, size_t piece)
{
    if (piece > 0)
        rad_ambread_settle_piece(&amb->read, piece - 1);
    else
        amb->blind = !gather_bright(amb, &view_to_be(amb)->bright);
}

bool
rad_ambient_settle_end(struct rad_ambient *amb)
{
    amb->newest = view_to_be(amb);
    return rad_ambread_settle_end(&amb->read) && !amb->blind;
}

bool
rad_ambient_settle(struct rad_ambient *amb)
{
    size_t n = rad_ambient_settle_begin(amb, true);

    for (size_t i = 0; i < n; i++)
        rad_ambient_settle_piece(amb, i);
    return rad_ambient_settle_end(amb);
}

const struct rad_ambview *
rad_ambient_view(const struct rad_ambient *amb, uint32_t settlings)
{
    return &amb->view[settlings % RAD_AMBIENT_VIEWS];
}

bool
rad_ambient_smooth(struct rad_ambient *amb)
{
    if (amb->frozen)
        rad_ambread_tighten(&amb->read);
    return !amb->frozen ||
           rad_ambsmooth_make(&amb->smooth, amb->job->geom, &amb->scale,
                              amb->read.item, amb->read.n);
}

bool
rad_ambient_is_smooth(const struct rad_ambient *amb)
{
    return amb->smooth.smooth != NULL;
}

size_t
rad_ambient_bytes(const struct rad_ambient *amb)
{
    return amb->frozen ? rad_ambread_bytes(&amb->read) +
                             rad_ambsmooth_bytes(&amb->smooth)
                       : 0;
}

void
rad_ambient_insert_all(struct rad_ambient *amb, struct rad_ambrec *rec,
                       size_t n)
{
    struct rad_ambzone zone[RAD_AMBIENT_TOGETHER];

    for (size_t i = 0; i < n; i++)
        rad_ambrec_narrow(&amb->scale, &rec[i]);
    if (amb->frozen) {
        for (size_t i = 0; i < n; i++)
            insert(amb, &rec[i], false);
        return;
    }
    while (n > 0) {
        size_t most = n < RAD_AMBIENT_TOGETHER ? n : RAD_AMBIENT_TOGETHER;
        size_t good = 0;

        for (size_t i = 0; i < most; i++)
            if (rad_ambient_fits(amb, &rec[i])) {
                zone[good] = zone_of(amb, rec[i].radius, rec[i].level);
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
    return amb->frozen ? atomic_load_explicit(&amb->held, memory_order_relaxed)
                       : rad_ambcache_count(amb->cache);
}

bool
rad_ambient_covers(const struct rad_ambient *amb, const struct rad_ambrec *rec)
{
    struct rad_ambplace at = { .level = rec->level, .weight = rec->weight };
    struct rad_geom_counts counts = { 0, 0 };
    struct rad_rgb E;
    uint64_t rays = 0;

    if (!rad_ambient_fits(amb, rec))
        return false;
    rad_copy(at.p, rec->p);
    at.err = 1e-6 * amb->scale.least;
    for (int k = 0; k < 3; k++)
        at.n[k] = at.pn[k] = rec->n[k];
    return rad_ambient_find(amb, &at, &E, &counts, &rays) > 0;
}
