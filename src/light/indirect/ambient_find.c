/* ambient_find.c - what the ambient records say of a place; see ambient.h
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
 * serves only if a ray toward a place above it passes.  */
#include "config.h"

#include "light/indirect/ambient_impl.h"
#include "arith/elementary.h"
#include "base/vec.h"

/* Zones of the smaller cells suffice if their weights sum to this. */
#define ENOUGH_WEIGHT .05

/* Whether something stands before a record takes a ray to find out.  Where it
 * matters only whether some record serves, and for deep ones of a frozen cache,
 * so many such records are put off, and left out if others have that weight. */
#define ENOUGH_DEEP  .05
#define MOST_PUT_OFF 24

/* Of deep records of a frozen cache the first few do that serve with more than
 * that weight: the many rays of a hemisphere ask for them. */
#define ENOUGH_FOR_RAYS .1

/* Ten degrees and -aa radians; more for rays that weigh little. */
void
rad_ambient_set_terms(const struct rad_ambient *amb, float weight,
                      struct rad_ambterms *t)
{
    double angle = M_PI / 18 + amb->scale.ambacc;

    if (weight < .6f)
        angle = M_PI / 2 - (M_PI / 2 - angle) * rad_pow((double)weight, .13);
    t->weight = weight;
    t->max_angle = (float)angle;
    rad_ambfit_set(&t->fit, rad_most(1 - .5 * angle * angle, 0),
                   .9 * (double)weight);
}

/* --- interpolation --- */

/* Is something between the point and the air above the record, be it a pane?
 * The ray rises at 20 degrees from the plane of the point, over what is small
 * and does not matter. */
static bool
is_walled_off(const struct rad_ambient *amb, const struct rad_ambplace *at,
              const struct rad_ambitem *rec, struct rad_geom_counts *counts,
              uint64_t *rays)
{
    double n[3] = { (double)rec->n[0], (double)rec->n[1], (double)rec->n[2] };
    double to[3], rise = rad_tan(M_PI / 9);
    struct rad_span span = { .tmin = 0 };
    struct rad_hit hit = { .err = at->err }, veil;
    struct rad_line line;

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
    return rad_geom_sight(amb->job->geom, &span, RAD_VOID, NULL, &veil, &line,
                          counts) != RAD_SIGHT_CLEAR;
}

/* Which of 32 parts of a turn from u toward v the direction (u, v) is in. */
static inline unsigned
part_of_turn(float u, float v)
{
    /* tangents of one, two and three parts */
    const float one = .198912367f, two = .414213562f, three = .668178638f;
    float x = fabsf(u), y = fabsf(v), lo = x < y ? x : y, hi = x < y ? y : x;
    unsigned part = (unsigned)(lo > one * hi) + (unsigned)(lo > two * hi) +
                    (unsigned)(lo > three * hi);

    part = x < y ? 7 - part : part;
    part = u < 0 ? 15 - part : part;
    return v < 0 ? 31 - part : part;
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
    const struct rad_ambasker *asker;
    double enough; /* no more records are wanted when these serve with more */
    bool doubts;   /* lum2 and var are wanted */
    bool spares;   /* records that something may stand before are put off, */
    int nput_off;
    const struct rad_ambitem **put_off; /* [MOST_PUT_OFF] */
};

/* No more need be looked at. */
static inline bool
is_answered(const struct search *s)
{
    return s->serves > s->enough;
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

    k->E = it->E;
    k->gpos[0] = it->gpos[0];
    k->gpos[1] = it->gpos[1];
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
    float d[3], across[3], u, v, z, x, y, h, dist2, dist, turn2, turn, factor;
    float per = 1 / it->radius[0];
    double w, angular, lum;
    struct says says;

    for (int k = 0; k < 3; k++)
        d[k] = (float)(s->at->p[k] - it->p[k]);
    rad_ambitem_across(it, across);
    u = rad_dotf(d, it->u);
    v = rad_dotf(d, across);
    z = rad_dotf(d, it->n);
    x = u * per;
    y = v * (1 / it->radius[1]);
    h = z * per;
    dist2 = x * x + y * y + h * h; /* in the zone's units */
    for (int k = 0; k < 3; k++)
        d[k] = it->n[k] - s->n[k];
    /* the chord, which is the angle for small ones */
    turn2 = rad_dotf(d, d);
    if (!(dist2 < s->reach * s->reach) | (z < s->behind) | (turn2 >= 2) |
        (it->level != s->at->level) | (it->weight < s->weight9))
        return;
    dist = sqrtf(dist2);
    turn = sqrtf(turn2);
    if (!(dist < s->reach) | (turn >= s->max_angle))
        return;
    hear(s, it, &says);
    if (!rad_ambient_extrapolate(it, across, says.gpos, u, v, s->pn, &factor))
        return;
    if (it->corral && it->corral >> part_of_turn(u, v) & 1) {
        if (s->spares && s->nput_off < MOST_PUT_OFF) {
            s->put_off[s->nput_off++] = it;
            return;
        }
        if (is_walled_off(s->amb, s->at, it, s->asker->counts, s->asker->rays))
            return;
    }
    angular = (double)(1 - turn / s->max_angle);
    if (dist < s->aa)
        s->serves += angular * (double)(1 - dist / s->aa);
    w = angular * (double)(1 - dist / s->reach);
    s->weight += w;
    if (s->doubts) {
        lum = (double)(factor * rad_rgb_lum(says.E));
        s->lum2 += w * lum * lum;
        s->var += w * (double)says.var;
    }
    w *= (double)factor;
    s->E[0] += w * (double)says.E.r;
    s->E[1] += w * (double)says.E.g;
    s->E[2] += w * (double)says.E.b;
}

/* rad_ambcache_fn */
static bool
add_records(void *arg, const struct rad_ambitem *const *found, int n)
{
    for (int i = 0; i < n && !is_answered(arg); i++)
        add_record(arg, found[i]);
    return !is_answered(arg);
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
                    (s->asker->only || s->weight < ENOUGH_DEEP);
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
    const struct rad_ambtile *tile = s->asker->tile;
    const struct rad_ambterms *t = &amb->usual[at->level % RAD_AMBIENT_USUAL];
    struct rad_ambterms others;
    struct rad_ambquery q = { .level = at->level };
    int frozen;

    if ((float)at->weight != t->weight) {
        rad_ambient_set_terms(amb, (float)at->weight, &others);
        t = &others;
    }
    s->weight9 = (float)(.9 * at->weight);
    s->max_angle = t->max_angle;
    s->aa = (float)amb->scale.ambacc;
    s->reach = s->asker->only || s->asker->near
                   ? s->aa
                   : (float)rad_ambscale_reach(&amb->scale, at->level);
    s->behind = -(float)(amb->scale.least * amb->scale.ambacc);
    q.fit = &t->fit;
    rad_copy(q.p, at->p);
    rad_copy(q.n, at->n);
    for (int k = 0; k < 3; k++) {
        s->n[k] = (float)at->n[k];
        s->pn[k] = (float)at->pn[k];
    }
    s->enough = s->asker->only                 ? 0
                : amb->frozen && at->level > 0 ? ENOUGH_FOR_RAYS
                                               : INFINITY;
    s->frozen = amb->frozen;
    s->spares = s->asker->only || (amb->frozen && at->level > 0);
    if (amb->frozen)
        rad_ambread_visit(&amb->read, rad_ambient_seen(amb, tile)->n, &q,
                          add_records, want_more, s);
    else
        rad_ambcache_visit(amb->cache, &q, add_records, want_more, s);
    s->frozen = false;
    frozen = s->nput_off;
    if (tile && rad_ambtile_has(tile, at->level) && !is_answered(s))
        rad_ambcache_visit(tile->own, &q, add_records, want_more, s);
    look_at_put_off(s, frozen);
}

static struct rad_rgb
found(const struct search *s)
{
    return rad_rgb((float)(s->E[0] / s->weight), (float)(s->E[1] / s->weight),
                   (float)(s->E[2] / s->weight));
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

void
rad_ambient_ask(const struct rad_ambient *amb, const struct rad_ambplace *at,
                const struct rad_ambasker *asker, struct rad_ambsaid *said)
{
    const struct rad_ambitem *put_off[MOST_PUT_OFF]; /* not set to anything */
    struct search s = { .amb = amb,
                        .at = at,
                        .asker = asker,
                        .doubts = at->level == 0,
                        .put_off = put_off };

    if (!asker->fresh)
        search_all(&s);
    *said = (struct rad_ambsaid){ .serves = s.serves, .weight = s.weight };
    if (asker->only || !(s.weight > 0))
        return;
    said->E = found(&s);
    if (s.doubts)
        said->off = doubt(&s);
}

double
rad_ambient_find(const struct rad_ambient *amb, const struct rad_ambplace *at,
                 struct rad_rgb *E, struct rad_geom_counts *counts,
                 uint64_t *rays)
{
    struct rad_ambasker asker = { .counts = counts, .rays = rays };
    struct rad_ambsaid said;

    rad_ambient_ask(amb, at, &asker, &said);
    if (said.serves > 0)
        *E = said.E;
    return said.serves;
}
