/* scene.c - see scene.h
 *
 * Objects are an array on the heap.  Name and arguments of an object lie side
 * by side in the arena.  Modifiers are found by name in a hash table with open
 * addressing.  An entry keeps all definitions of its name in order, so that
 * "the last one before" is found by binary search. */
#include "config.h"

#include "scene/scene.h"
#include "base/list.h"
#include "base/text.h"
#include "scene/meshfile.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct name_entry {
    const char *name; /* NULL: free */
    uint64_t hash;
    int32_t *defs; /* indices of objects, ascending */
    int32_t ndefs;
    int32_t capacity;
};

struct rad_names {
    struct name_entry *entries;
    size_t size; /* a power of two, or 0 */
    size_t used;
};

struct rad_scene *
rad_scene_new(void)
{
    struct rad_scene *s = calloc(1, sizeof *s);

    if (!s)
        return NULL;
    rad_arena_init(&s->arena);
    s->names = calloc(1, sizeof *s->names);
    if (!s->names) {
        free(s);
        return NULL;
    }
    return s;
}

void
rad_scene_free(struct rad_scene *s)
{
    if (!s)
        return;
    for (size_t i = 0; i < s->names->size; i++)
        free(s->names->entries[i].defs);
    free(s->names->entries);
    free(s->names);
    for (int32_t i = 0; i < s->nparts; i++)
        rad_mesh_free(s->parts[i]->mesh);
    free(s->parts);
    free(s->objects);
    free(s->files);
    rad_arena_release(&s->arena);
    free(s);
}

static int
out_of_memory(struct rad_error *err)
{
    return rad_fail(err, RAD_ENOMEM, "out of memory for the scene");
}

int
rad_scene_add_file(struct rad_scene *s, const char *name, struct rad_error *err)
{
    int32_t n = s->nfiles;

    if (!rad_list_grow(&s->files, (size_t)n, sizeof *s->files))
        return out_of_memory(err);
    s->files[n] = rad_arena_strndup(&s->arena, name, strlen(name));
    if (!s->files[n])
        return out_of_memory(err);
    return s->nfiles++;
}

/* Make room for one more object.  Memory that doubling reserves but does not
 * use is never touched, so it costs only address space. */
static int
reserve_object(struct rad_scene *s, struct rad_error *err)
{
    size_t n = (size_t)s->nobjects;

    if (n >= RAD_MAX_OBJECTS)
        return rad_fail(err, RAD_EDATA, "more than %d objects",
                        RAD_MAX_OBJECTS);
    return rad_list_grow(&s->objects, n, sizeof *s->objects)
               ? 0
               : out_of_memory(err);
}

/* The entry of a name, or the free one where it would go; t->size is not 0. */
static struct name_entry *
find_entry(const struct rad_names *t, const char *name, uint64_t hash)
{
    size_t i = hash & (t->size - 1);

    for (;; i = (i + 1) & (t->size - 1)) {
        struct name_entry *e = &t->entries[i];

        if (!e->name || (e->hash == hash && strcmp(e->name, name) == 0))
            return e;
    }
}

static int
grow_names(struct rad_names *t, struct rad_error *err)
{
    struct rad_names bigger = { .size = t->size ? 2 * t->size : 64,
                                .used = t->used };

    bigger.entries = calloc(bigger.size, sizeof *bigger.entries);
    if (!bigger.entries)
        return out_of_memory(err);
    for (size_t i = 0; i < t->size; i++)
        if (t->entries[i].name)
            *find_entry(&bigger, t->entries[i].name, t->entries[i].hash) =
                t->entries[i];
    free(t->entries);
    *t = bigger;
    return 0;
}

/* How many of a modifier's first strings name modifiers. */
static int32_t
reference_count(const struct rad_object *o)
{
    switch (o->type) {
    case RAD_ALIAS:
    case RAD_ILLUM:
    case RAD_MIRROR:
        return o->nstrings > 0;
    case RAD_MIXFUNC:
    case RAD_MIXDATA:
    case RAD_MIXTEXT:
    case RAD_MIXPICT:
        return o->nstrings >= 2 ? 2 : 0;
    case RAD_ANTIMATTER:
        return o->nstrings;
    default:
        return 0;
    }
}

/* Is a equal to b, to 1e-6 of b?  Radiance compares definitions so: a number
 * that was written with six digits and read again is still the same. */
static bool
same_real(double a, double b)
{
    double d = b != 0 ? a / b - 1 : a;

    return fabs(d) <= 1e-6;
}

static bool
same_arguments(const struct rad_object *a, const struct rad_object *b)
{
    if (a->type != b->type || a->nstrings != b->nstrings ||
        a->nreals != b->nreals)
        return false;
    for (int32_t i = 0; i < a->nreals; i++)
        if (!same_real(a->reals[i], b->reals[i]))
            return false;
    for (int32_t i = 0; i < a->nstrings; i++)
        if (strcmp(a->strings[i], b->strings[i]) != 0)
            return false;
    return true;
}

/* Do objects a and b mean the same?  References are compared by the definitions
 * that they lead to; nested beyond `depth` they count as different, which is
 * always safe. */
static bool
same_definition(const struct rad_scene *s, int32_t a, int32_t b, int depth)
{
    for (; a != b; a = s->objects[a].modifier, b = s->objects[b].modifier) {
        if (a == RAD_VOID || b == RAD_VOID || depth == 0)
            return false;

        const struct rad_object *x = &s->objects[a], *y = &s->objects[b];

        if (!same_arguments(x, y))
            return false;
        for (int32_t i = 0; i < reference_count(x); i++)
            if (!same_definition(
                    s, rad_scene_find_modifier(s, x->strings[i], a),
                    rad_scene_find_modifier(s, y->strings[i], b), depth - 1))
                return false;
    }
    return true;
}

/* Enter object `index`, a modifier, in the index of names. */
static int
index_name(struct rad_scene *s, int32_t index, struct rad_error *err)
{
    struct rad_names *t = s->names;
    const char *name = s->objects[index].name;
    uint64_t hash = rad_text_hash(name);
    struct name_entry *e;

    if (t->used >= t->size / 2 && grow_names(t, err))
        return RAD_ENOMEM;
    e = find_entry(t, name, hash);
    if (e->name && same_definition(s, index, e->defs[e->ndefs - 1], 8))
        return 0;
    if (e->ndefs == e->capacity) {
        int32_t capacity = e->capacity ? 2 * e->capacity : 1;
        int32_t *more = realloc(e->defs, (size_t)capacity * sizeof *more);

        if (!more)
            return out_of_memory(err);
        e->defs = more;
        e->capacity = capacity;
    }
    if (!e->name) {
        e->name = name;
        e->hash = hash;
        t->used++;
    }
    e->defs[e->ndefs++] = index;
    return 0;
}

/* Copy the name and arguments of *src into the arena; *dst points to them. */
static int
copy_arguments(struct rad_scene *s, struct rad_object *dst,
               const struct rad_object *src, struct rad_error *err)
{
    size_t reals = (size_t)src->nreals * sizeof *src->reals;
    size_t ptrs = (size_t)src->nstrings * sizeof *src->strings;
    size_t size = reals + ptrs + strlen(src->name) + 1;
    const char **strings;
    char *p;

    for (int32_t i = 0; i < src->nstrings; i++)
        size += strlen(src->strings[i]) + 1;
    p = rad_arena_alloc(&s->arena, size);
    if (!p)
        return out_of_memory(err);
    dst->reals = (const double *)(void *)p;
    if (reals)
        memcpy(p, src->reals, reals);
    strings = (const char **)(void *)(p + reals);
    dst->strings = strings;
    p += reals + ptrs;
    dst->name = p;
    p = stpcpy(p, src->name) + 1;
    for (int32_t i = 0; i < src->nstrings; i++) {
        strings[i] = p;
        p = stpcpy(p, src->strings[i]) + 1;
    }
    return 0;
}

static int
check_limits(const struct rad_object *o, struct rad_error *err)
{
    if (o->nstrings > RAD_MAX_ARGS || o->nreals > RAD_MAX_ARGS)
        return rad_fail(err, RAD_EDATA, "%s '%s': more than %d arguments",
                        rad_otype_name(o->type), o->name, RAD_MAX_ARGS);
    if (strlen(o->name) > RAD_MAX_WORD)
        return rad_fail(err, RAD_EDATA, "name of more than %d bytes",
                        RAD_MAX_WORD);
    for (int32_t i = 0; i < o->nstrings; i++)
        if (strlen(o->strings[i]) > RAD_MAX_WORD)
            return rad_fail(err, RAD_EDATA,
                            "%s '%s': argument of more than %d bytes",
                            rad_otype_name(o->type), o->name, RAD_MAX_WORD);
    return 0;
}

int
rad_scene_add(struct rad_scene *s, const struct rad_object *o,
              struct rad_error *err)
{
    struct rad_object copy = *o;
    int rc = check_limits(o, err);

    if (rc)
        return rc;
    rc = reserve_object(s, err);
    if (rc)
        return rc;
    rc = copy_arguments(s, &copy, o, err);
    if (rc)
        return rc;
    s->objects[s->nobjects] = copy;
    if (!rad_otype_is_surface(o->type)) {
        rc = index_name(s, s->nobjects, err);
        if (rc)
            return rc;
    }
    return s->nobjects++;
}

int
rad_scene_find_modifier(const struct rad_scene *s, const char *name,
                        int32_t before)
{
    const struct rad_names *t = s->names;
    const struct name_entry *e;
    int32_t lo = 0, hi;

    if (t->size == 0)
        return RAD_VOID;
    e = find_entry(t, name, rad_text_hash(name));
    hi = e->name ? e->ndefs : 0;
    if (hi && e->defs[hi - 1] < before)
        return e->defs[hi - 1];
    while (lo < hi) { /* how many definitions come before? */
        int32_t mid = lo + (hi - lo) / 2;

        if (e->defs[mid] < before)
            lo = mid + 1;
        else
            hi = mid;
    }
    return lo ? e->defs[lo - 1] : RAD_VOID;
}

const struct rad_object *
rad_scene_spectrum(const struct rad_scene *s)
{
    for (int32_t i = 0; i < s->nobjects; i++)
        switch (s->objects[i].type) {
        case RAD_SPECTRUM:
        case RAD_SPECFILE:
        case RAD_SPECFUNC:
        case RAD_SPECDATA:
        case RAD_SPECPICT:
            return &s->objects[i];
        default:
            break;
        }
    return NULL;
}

int
rad_scene_named(const struct rad_scene *s, int32_t index, int32_t k,
                int32_t *mod, struct rad_error *err)
{
    const struct rad_object *o = &s->objects[index];
    const char *name = o->strings[k];

    *mod = RAD_VOID;
    if (strcmp(name, "void") == 0)
        return 0;
    *mod = rad_scene_find_modifier(s, name, index);
    if (*mod != RAD_VOID)
        return 0;
    return rad_scene_fail(s, o, err, RAD_EDATA, "undefined modifier '%s'",
                          name);
}

int
rad_scene_fail(const struct rad_scene *s, const struct rad_object *o,
               struct rad_error *err, int code, const char *fmt, ...)
{
    char text[4 * sizeof err->what]; /* rad_fail() keeps the end, the reason */
    va_list ap;

    va_start(ap, fmt);
    vsnprintf(text, sizeof text, fmt, ap);
    va_end(ap);
    if (err && err->code == 0 && o->file >= 0 && o->file < s->nfiles) {
        if (o->line > 0)
            rad_error_where(err, "%s:%d", s->files[o->file], (int)o->line);
        else
            rad_error_where(err, "%s", s->files[o->file]);
    }
    return rad_fail(err, code, "%s '%s': %s", rad_otype_name(o->type), o->name,
                    text);
}
