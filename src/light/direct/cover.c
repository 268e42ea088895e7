/* cover.c - see cover.h */
#include "config.h"

#include "light/direct/cover.h"

#include "scene/part.h"

#include <stdlib.h>
#include <string.h>

/* A place that a lamp or mirror takes. */
struct place {
    const struct rad_object *o; /* a surface there */
    int32_t from;               /* its first real argument, for comparison */
    int32_t best;               /* the surface there that rays see */
};

/* Compare real arguments, as many of both, by value (-0 is 0): a's from i on
 * with b's from j on, round and round. */
static int
compare_reals(const struct rad_object *a, int32_t i, const struct rad_object *b,
              int32_t j)
{
    int32_t n = a->nreals;

    for (int32_t k = 0; k < n; k++) {
        double x = a->reals[i], y = b->reals[j];

        if (x != y)
            return x < y ? -1 : 1;
        i = i + 1 < n ? i + 1 : 0;
        j = j + 1 < n ? j + 1 : 0;
    }
    return 0;
}

/* The place where a polygon's numbers are read from, so that they are the same
 * whichever corner the scene names first: they are the least then.  A corner
 * may be there twice, as where the seam of a hole begins. */
static int32_t
least_corner(const struct rad_object *o)
{
    int32_t least = 0;

    for (int32_t i = 3; i + 2 < o->nreals; i += 3)
        if (compare_reals(o, i, o, least) < 0)
            least = i;
    return least;
}

static struct place
place_of(const struct rad_object *objects, int32_t i)
{
    const struct rad_object *o = &objects[i];

    return (struct place){ o, o->type == RAD_POLYGON ? least_corner(o) : 0, i };
}

/* For qsort() and bsearch(). */
static int
compare(const void *p, const void *q)
{
    const struct place *a = p, *b = q;

    if (a->o->type != b->o->type)
        return a->o->type < b->o->type ? -1 : 1;
    if (a->o->nreals != b->o->nreals)
        return a->o->nreals < b->o->nreals ? -1 : 1;
    return compare_reals(a->o, a->from, b->o, b->from);
}

/* Note in each of the n places which of the scene's surfaces rays see there. */
static void
find_best(const struct rad_job *job, struct place *places, size_t n)
{
    const struct rad_scene *scene = job->scene;

    for (int32_t i = 0; n > 0 && i < rad_scene_own(scene); i++) {
        struct place *at, key;

        if (!rad_otype_is_surface(scene->objects[i].type))
            continue;
        key = place_of(scene->objects, i);
        at = bsearch(&key, places, n, sizeof key, compare);
        if (at && rad_geom_outranks(job->geom, i, at->best))
            at->best = i;
    }
}

static bool
is_covered(const struct rad_object *objects, const struct place *places,
           size_t n, int32_t obj)
{
    struct place key = place_of(objects, obj);
    const struct place *at;

    if (key.o->type == RAD_SOURCE)
        return false;
    at = bsearch(&key, places, n, sizeof key, compare);
    return at && at->best != obj;
}

bool
rad_drop_covered(const struct rad_job *job, void *list, int32_t *n, size_t size,
                 size_t at)
{
    const struct rad_object *objects = job->scene->objects;
    struct place *places = malloc((size_t)*n * sizeof *places + 1);
    char *from = list, *to = list, *end = from + (size_t)*n * size;
    size_t all = 0, some = 0;
    int32_t obj;

    if (!places)
        return false;
    for (char *p = list; p < end; p += size) {
        memcpy(&obj, p + at, sizeof obj);
        if (objects[obj].type != RAD_SOURCE)
            places[all++] = place_of(objects, obj);
    }
    qsort(places, all, sizeof *places, compare);
    for (size_t i = 0; i < all; i++)
        if (i == 0 || compare(&places[i], &places[some - 1]) != 0)
            places[some++] = places[i];
    find_best(job, places, some);
    for (; from < end; from += size) {
        memcpy(&obj, from + at, sizeof obj);
        if (is_covered(objects, places, some, obj)) {
            --*n;
            continue;
        }
        memmove(to, from, size);
        to += size;
    }
    free(places);
    return true;
}
