/* ambient_find.c - irradiance at a place, from ambient records; see ambient.h
 *
 * The extrapolations of all records in whose zones a place lies are averaged,
 * with weights that fall to zero at the edges of the zones, in distance and in
 * angle: so E does not jump where a zone ends.
 *
 * A record serves rays of its own level alone.  A record of a lower level holds
 * the light of more bounces than a deeper ray has left: served by such records
 * light would bounce up to twice as often as -ab says, which with -ab 4 makes
 * the Cornell box 1.6 % too bright, however fine the cache.
 *
 * Steps.  A record of a chair's cushion says nothing about the face below that
 * stands back a little: there the light of the floor is another.  So for pixels
 * a record with a large zone does not serve what lies behind its surface,
 * unless the surface may bend so far.
 *
 * Light leaks.  A record that was made near a wall which does not reach down to
 * the record's surface must not serve beyond the wall.  So a record remembers
 * the directions in which a surface stands near by at the horizon (its corral);
 * to a place in such a direction it serves only if a ray from there to a point
 * above the record meets nothing.  */
#include "config.h"

#include "light/indirect/ambient_impl.h"
#include "base/vec.h"

/* Records with larger zones are left out if the weights of records with smaller
 * zones sum to this; and for pixels, over a frozen cache, those beyond -aa if
 * the weights of those within do. */
#define ENOUGH_WEIGHT .05

/* For pixels records with larger zones count by what the weights of records
 * with smaller zones lack to this.  With less, edges of small zones are seen.
 */
#define ENOUGH_SMALLER .4

/* A place is behind a step if it is behind a record's surface by this part of
 * its distance, and the angle between normals, which leaves a bent surface
 * twice what it needs.  Zones of up to SMALL_ZONE times the least radius may
 * cross a step: most are among blinds and the like, where light is much the
 * same. */
#define STEP       .05f
#define SMALL_ZONE 1.5

/* The test for a light leak takes a ray.  If the question is only whether some
 * record serves, and for deep records of a frozen cache, records that need the
 * test are put off, and left out if other records have the weight ENOUGH_DEEP.
 * Else the nearest MOST_PUT_OFF of them are tested, from the nearest one on. */
#define ENOUGH_DEEP  .05
#define MOST_PUT_OFF 24

/* The ray of that test rises by this over the distance along the surface: at 20
 * degrees. */
#define RISE .36397023426620234

/* A search for deep records of a frozen cache leaves out larger zones when
 * those found serve with this weight: each of the many rays of a hemisphere
 * makes such a search.  It does not end among zones of one size: these come in
 * the order in which tiles made them, which goes through the scene from one
 * side to the other, so records on that side would serve more places than
 * others. */
#define ENOUGH_FOR_RAYS .1

/* The largest angle between normals is ten degrees and -aa radians, and more
 * for rays of little weight. */
void
rad_ambient_set_terms(const struct rad_ambient *amb, float weight,
                      struct rad_ambterms *t)
{
    double angle = M_PI / 18 + amb->scale.ambacc;

    if (weight < .6f) /* rpict has weight^.13, which takes longer */
        angle =
            M_PI / 2 - (M_PI / 2 - angle) * sqrt(sqrt(sqrt((double)weight)));
    t->weight = weight;
    t->max_angle = (float)angle;
    rad_ambfit_set(&t->fit, rad_most(1 - .5 * angle * angle, 0),
                   .9 * (double)weight);
}

/* --- interpolation --- */

/* Does a surface, which may be a pane, stand between the place and a point
 * above the record?  The ray rises from the place's plane (RISE), so that it
 * passes over small objects, which hide little light. */
static bool
is_walled_off(const struct rad_ambient *amb, const struct rad_ambplace *at,
              const struct rad_ambitem *rec, struct rad_geom_counts *counts,
              uint64_t *rays)
{
    double n[3] = { (double)rec->n[0], (double)rec->n[1], (double)rec->n[2] };
    double to[3];
    struct rad_span span = { .tmin = 0 };
    struct rad_hit hit = { .err = at->err }, veil;
    struct rad_line line;

    rad_sub(to, rec->p, at->p);
    double height = rad_dot(to, at->n), d2 = rad_dot(to, to);
    double along = sqrt(rad_most(d2 - height * height, 0));
    double up = (RISE * along - height) / rad_dot(n, at->n);

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

/* In which of 32 equal parts of a full turn, from axis u toward axis v, the
 * direction (u, v) lies. */
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

/* A record that is tested later for a light leak. */
struct put_off {
    const struct rad_ambitem *item;
    float dist;  /* of the place [radii] */
    bool frozen; /* it is the frozen cache's */
};

/* A search for the records that serve at a place. */
struct search {
    const struct rad_ambient *amb;
    const struct rad_ambplace *at;
    float n[3], pn[3]; /* of at */
    float weight9;     /* least weight of a record: .9 times the ray's */
    float max_angle;   /* between normals [rad] */
    float aa, reach;   /* distance in radii up to which records serve, and up to
                        * which they are averaged */
    double share;      /* factor of weights in averages */
    double lack;       /* the same, for the size of zones that comes now */
    float behind;  /* least height over a record's surface where it serves */
    double serves; /* weight of records within aa, found so far */
    double weight; /* of all records found so far */
    double E[3];   /* weighted sum of the records' E */
    /* sums for the expected error: weighted, of squared luminances and of
     * variances of smoothed values; and of squared weights */
    double lum2, var, w2;
    bool frozen; /* records that come now are the frozen cache's */
    const struct rad_ambasker *asker;
    double enough; /* larger zones are left out when `serves` is more */
    bool doubts;   /* lum2, var and w2 are wanted */
    bool spares;   /* records that need a test for leaks are put off */
    int nput_off;
    struct put_off *put_off; /* [MOST_PUT_OFF] */
};

/* Do the records found suffice? */
static inline bool
is_answered(const struct search *s)
{
    return s->serves > s->enough;
}

/* A record's values at its own place, smoothed if they can be. */
struct says {
    struct rad_rgb E;
    float gpos[2], least, var; /* as of struct rad_smooth_value */
};

static inline void
hear(const struct search *s, const struct rad_ambitem *it, struct says *k)
{
    const struct rad_ambient *amb = s->amb;
    struct rad_smooth_value v;

    k->E = it->E;
    k->gpos[0] = it->gpos[0];
    k->gpos[1] = it->gpos[1];
    k->least = 0;
    k->var = 0;
    if (!s->frozen || !rad_ambsmooth_at(&amb->smooth, it, &v))
        return;
    k->E = rad_rgb(v.E[0], v.E[1], v.E[2]);
    k->gpos[0] = v.gpos[0];
    k->gpos[1] = v.gpos[1];
    k->least = v.least;
    k->var = v.var;
}

/* Put the test of a record for light leaks off.  Where there are too many the
 * farthest is left out. */
static void
put_off_test(struct search *s, const struct rad_ambitem *it, float dist)
{
    struct put_off *at = &s->put_off[s->nput_off];

    if (s->nput_off == MOST_PUT_OFF) {
        at = s->put_off;
        for (int i = 1; i < MOST_PUT_OFF; i++)
            if (s->put_off[i].dist > at->dist)
                at = &s->put_off[i];
        if (at->dist <= dist)
            return;
    } else {
        s->nput_off++;
    }
    *at = (struct put_off){ it, dist, s->frozen };
}

/* Is the place behind a step, as seen from the record?  z is its height over
 * the record's surface, along2 the square of its distance along the surface. */
static inline bool
is_behind_step(const struct search *s, const struct rad_ambitem *it, float z,
               float along2, float turn)
{
    float most = STEP + turn;

    return z < 0 && s->at->level == 0 && z * z > most * most * along2 &&
           (double)it->radius[0] > SMALL_ZONE * s->amb->scale.least;
}

/* Does something part the place, at (u, v) on the record's surface and `dist`
 * radii away, from the record?  Also true if the record is tested later. */
static inline bool
is_parted(struct search *s, const struct rad_ambitem *it, float u, float v,
          float dist)
{
    if (it->corral && it->corral >> part_of_turn(u, v) & 1) {
        if (s->spares) {
            put_off_test(s, it, dist);
            return true;
        }
        if (is_walled_off(s->amb, s->at, it, s->asker->counts, s->asker->rays))
            return true;
    }
    /* a sensor may be above, below or inside of things */
    *s->asker->rays += s->asker->sensor;
    return s->asker->sensor &&
           rad_ambsmooth_parted(s->amb->job->geom, s->at->p, s->n, it->p, it->n,
                                s->asker->counts);
}

/* Add what a record says to the sums, times `factor`.  dist [radii] and turn
 * [rad] lie between the record and the place. */
static inline void
add_says(struct search *s, const struct rad_ambitem *it, const struct says *k,
         float factor, float dist, float turn)
{
    double angular = (double)(1 - turn / s->max_angle);
    double w = s->share * s->lack * angular * (double)(1 - dist / s->reach);

    if (dist < s->aa)
        s->serves += angular * (double)(1 - dist / s->aa);
    s->weight += w;
    if (s->doubts) {
        double lum = (double)(factor * rad_rgb_lum(k->E));

        if (s->asker->serving)
            rad_ambserving_add(s->asker->serving, it, w * lum);
        s->lum2 += w * lum * lum;
        s->var += w * (double)k->var;
        s->w2 += w * w;
    }
    w *= (double)factor;
    s->E[0] += w * (double)k->E.r;
    s->E[1] += w * (double)k->E.g;
    s->E[2] += w * (double)k->E.b;
}

/* Add a record to the sums, if it serves at the place. */
static inline void
add_record(struct search *s, const struct rad_ambitem *it)
{
    float d[3], across[3], u, v, z, x, y, h, dist2, dist, turn2, turn, factor;
    float per = 1 / it->radius[0], moved;
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
    dist2 = x * x + y * y + h * h; /* squared distance in radii */
    for (int k = 0; k < 3; k++)
        d[k] = it->n[k] - s->n[k];
    /* the square of the chord, which is about the angle between normals */
    turn2 = rad_dotf(d, d);
    if (!(dist2 < s->reach * s->reach) | (z < s->behind) | (turn2 >= 2) |
        (it->level != s->at->level) | (it->weight < s->weight9))
        return;
    dist = sqrtf(dist2);
    turn = sqrtf(turn2);
    if (!(dist < s->reach) | (turn >= s->max_angle) ||
        is_behind_step(s, it, z, u * u + v * v, turn))
        return;
    hear(s, it, &says);
    moved = 1 + says.gpos[0] * u + says.gpos[1] * v;
    if (!rad_ambient_extrapolate(it, across, moved, s->pn, &factor))
        return;
    if (moved < says.least)
        factor += says.least - moved;
    if (!is_parted(s, it, u, v, dist))
        add_says(s, it, &says, factor, dist, turn);
}

/* Is nothing more to be learned, whatever the records that come next are? */
static inline bool
is_over(const struct search *s)
{
    return s->asker->only && is_answered(s);
}

/* rad_ambcache_fn */
static bool
add_records(void *arg, const struct rad_ambitem *const *found, int n)
{
    for (int i = 0; i < n && !is_over(arg); i++)
        add_record(arg, found[i]);
    return !is_over(arg);
}

/* rad_ambcache_more_fn: if records with small zones serve well enough, larger
 * zones are left out, except those near the least size.  For pixels they count
 * ever less, so E does not jump; in hemispheres jumps average out. */
static bool
want_more(void *arg, double side)
{
    struct search *s = arg;
    bool small = side * s->amb->scale.ambacc <= s->amb->scale.least;

    if (is_answered(s))
        return false;
    if (s->at->level > 0)
        return small || s->serves < ENOUGH_WEIGHT;
    if (!small)
        s->lack = 1 - s->serves / ENOUGH_SMALLER;
    return s->lack > 0;
}

/* Test records that were put off, until those found are enough. */
static void
look_at_put_off(struct search *s)
{
    s->spares = false;
    while (s->nput_off > 0 && !is_answered(s) &&
           (s->asker->only || s->weight < ENOUGH_DEEP)) {
        struct put_off *next = s->put_off;

        for (int i = 1; i < s->nput_off; i++)
            if (s->put_off[i].dist < next->dist)
                next = &s->put_off[i];
        s->frozen = next->frozen;
        add_record(s, next->item);
        *next = s->put_off[--s->nput_off];
    }
}

/* Add the records that meet the query to the sums. */
static void
search_once(struct search *s, const struct rad_ambquery *q)
{
    const struct rad_ambient *amb = s->amb;
    const struct rad_ambtile *tile = s->asker->tile;

    s->frozen = amb->frozen;
    s->lack = 1;
    if (amb->frozen)
        rad_ambread_visit(&amb->read, rad_ambient_seen(amb, tile)->n, q,
                          add_records, want_more, s);
    else
        rad_ambcache_visit(amb->cache, q, add_records, want_more, s);
    s->frozen = false;
    s->lack = 1; /* small zones come first again */
    if (tile && rad_ambtile_has(tile, s->at->level) && !is_answered(s))
        rad_ambcache_visit(tile->own, q, add_records, want_more, s);
    look_at_put_off(s);
}

/* Find the records that serve at s->at.  Pixels see the mean of records within
 * -aa, which are smoothed: the mean of more would take longer and have no less
 * noise.  Where these weigh little, at the edges of their zones, records beyond
 * count by what is lacking: so E does not jump there. */
static void
search_all(struct search *s)
{
    const struct rad_ambplace *at = s->at;
    const struct rad_ambient *amb = s->amb;
    const struct rad_ambterms *t = &amb->usual[at->level % RAD_AMBIENT_USUAL];
    struct rad_ambterms others;
    struct rad_ambquery q = { .level = at->level };
    float reach = (float)rad_ambscale_reach(&amb->scale, at->level);
    bool near = s->asker->only || s->asker->sensor;

    if ((float)at->weight != t->weight) {
        rad_ambient_set_terms(amb, (float)at->weight, &others);
        t = &others;
    }
    s->weight9 = (float)(.9 * at->weight);
    s->max_angle = t->max_angle;
    s->aa = (float)amb->scale.ambacc;
    s->reach = near || (amb->frozen && at->level == 0) ? s->aa : reach;
    s->share = 1;
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
    s->spares = s->asker->only || (amb->frozen && at->level > 0);
    search_once(s, &q);
    if (!near && s->reach < reach && s->weight < ENOUGH_WEIGHT) {
        s->share = 1 - s->weight / ENOUGH_WEIGHT;
        s->reach = reach;
        s->serves = 0; /* these records are found again */
        search_once(s, &q);
    }
}

/* The mean E of the records found. */
static struct rad_rgb
found(const struct search *s)
{
    return rad_rgb((float)(s->E[0] / s->weight), (float)(s->E[1] / s->weight),
                   (float)(s->E[2] / s->weight));
}

/* The expected squared error of the mean, over its square.  The noise of single
 * records averages out; by as much as records differ all of them may be wrong.
 */
static double
doubt(const struct search *s)
{
    double mean = rad_rgb_lum(found(s)), w = s->weight;

    if (!(mean > 0))
        return 0;
    return rad_most(s->lum2 / w / (mean * mean) - 1, 0) +
           s->var / w * s->w2 / (w * w);
}

void
rad_ambient_ask(const struct rad_ambient *amb, const struct rad_ambplace *at,
                const struct rad_ambasker *asker, struct rad_ambsaid *said)
{
    struct put_off put_off[MOST_PUT_OFF]; /* not initialized */
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
