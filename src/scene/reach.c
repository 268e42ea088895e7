/* reach.c - which modifiers and files objects name, and which objects a scene's
 * surfaces use; see scene.h */
#include "config.h"

#include "scene/part.h"

#include <stdlib.h>
#include <string.h>

/* Which strings of an object name modifiers, as bits. */
static unsigned
named_strings(const struct rad_object *o)
{
    switch (o->type) {
    case RAD_ALIAS:
    case RAD_ILLUM:
    case RAD_MIRROR:
    case RAD_ANTIMATTER: /* its further strings are compared as names only */
        return 1;
    case RAD_MIXFUNC:
    case RAD_MIXDATA:
    case RAD_MIXPICT:
    case RAD_MIXTEXT:
        return 3;
    case RAD_WGMDFUNC:
        return 1 << 0 | 1 << 4 | 1 << 8;
    default:
        return 0;
    }
}

/* Mark the parts that objects [first, first + n) are copies of without a
 * modifier that would replace those of the part. */
static void
bare(const struct rad_scene *s, int32_t first, int32_t n, uint8_t *parts)
{
    for (int32_t i = first; i < first + n; i++) {
        const struct rad_object *o = &s->objects[i];

        if (o->use && o->modifier == RAD_VOID)
            parts[o->use->part->index] = 1;
    }
}

/* By part: is there a copy of it in which surfaces keep their own modifiers?
 * One pass by depth is enough, since a part holds only parts of lesser depth.
 * malloc'd; NULL: memory is out. */
static uint8_t *
bare_parts(const struct rad_scene *s)
{
    uint8_t *parts = calloc((size_t)s->nparts + 1, 1);

    if (!parts)
        return NULL;
    bare(s, 0, rad_scene_own(s), parts);
    for (int32_t depth = RAD_MAX_PART_DEPTH; depth > 0; depth--)
        for (int32_t i = 0; i < s->nparts; i++)
            if (parts[i] && s->parts[i]->depth == depth)
                bare(s, s->parts[i]->first, s->parts[i]->n, parts);
    return parts;
}

static void
reach_surfaces(const struct rad_scene *s, int32_t first, int32_t n,
               uint8_t *reached)
{
    for (int32_t i = first; i < first + n; i++)
        if (rad_otype_is_surface(s->objects[i].type))
            reached[i] = 1;
}

/* Mark the modifiers that object i names. */
static void
reach_modifiers(const struct rad_scene *s, int32_t i, uint8_t *reached)
{
    const struct rad_object *o = &s->objects[i];

    if (o->modifier != RAD_VOID)
        reached[o->modifier] = 1;
    for (int k = 0; k < o->nstrings && named_strings(o) >> k; k++) {
        int32_t named = RAD_VOID;

        if (named_strings(o) >> k & 1)
            named = rad_scene_find_modifier(s, o->strings[k], i);
        if (named != RAD_VOID)
            reached[named] = 1;
    }
}

/* An object refers only to objects before it, so a pass downwards is enough. */
void
rad_scene_reach(const struct rad_scene *s, uint8_t *reached)
{
    uint8_t *parts = s->nparts ? bare_parts(s) : NULL;

    memset(reached, 0, (size_t)s->nobjects);
    reach_surfaces(s, 0, rad_scene_own(s), reached);
    for (int32_t i = 0; i < s->nparts; i++)
        if (!parts || parts[i]) /* if memory is out, every part */
            reach_surfaces(s, s->parts[i]->first, s->parts[i]->n, reached);
    free(parts);
    for (int32_t i = s->nobjects; i-- > 0;)
        if (reached[i])
            reach_modifiers(s, i, reached);
}

void
rad_scene_nesting(const struct rad_scene *s, int32_t *depth)
{
    for (int32_t i = 0; i < s->nobjects; i++) {
        const struct rad_object *o = &s->objects[i];

        depth[i] = o->modifier == RAD_VOID ? 0 : depth[o->modifier];
        for (int k = 0; k < o->nstrings && named_strings(o) >> k; k++) {
            int32_t named = RAD_VOID;

            if (named_strings(o) >> k & 1)
                named = rad_scene_find_modifier(s, o->strings[k], i);
            if (named != RAD_VOID && depth[named] >= depth[i])
                depth[i] = depth[named] + 1;
        }
    }
}

void
rad_scene_needs(const struct rad_scene *s, bool needs[RAD_NOTYPES])
{
    uint8_t *reached = malloc((size_t)s->nobjects + 1);

    memset(needs, 0, RAD_NOTYPES * sizeof *needs);
    if (reached)
        rad_scene_reach(s, reached);
    for (int32_t i = 0; i < s->nobjects; i++)
        if (!reached || reached[i] || /* if memory is out, every type */
            rad_otype_is_surface(s->objects[i].type))
            needs[s->objects[i].type] = true;
    free(reached);
}

static const struct {
    enum rad_otype type;
    struct rad_file_strings at;
} named_files[] = {
    { RAD_BRIGHTTEXT, { -1, 0, 2 } }, /* the font and the text */
    { RAD_COLORTEXT, { -1, 0, 2 } },  { RAD_MIXTEXT, { -1, 2, 2 } },
    { RAD_BRIGHTFUNC, { 1, 0, 0 } },  { RAD_COLORFUNC, { 3, 0, 0 } },
    { RAD_TEXFUNC, { 3, 0, 0 } },     { RAD_MIXFUNC, { 3, 0, 0 } },
    { RAD_BRIGHTDATA, { 2, 1, 1 } },  { RAD_COLORDATA, { 6, 3, 3 } },
    { RAD_COLORPICT, { 4, 3, 1 } },   { RAD_TEXDATA, { 6, 3, 3 } },
    { RAD_SPECFILE, { -1, 0, 1 } },   { RAD_SPECFUNC, { 1, 0, 0 } },
    { RAD_SPECDATA, { 2, 1, 1 } },    { RAD_SPECPICT, { 2, 1, 1 } },
    { RAD_MIXDATA, { 4, 3, 1 } },     { RAD_MIXPICT, { 4, 3, 1 } },
    { RAD_PLASTIC2, { 3, 0, 0 } },    { RAD_METAL2, { 3, 0, 0 } },
    { RAD_TRANS2, { 3, 0, 0 } },      { RAD_ASHIK2, { 3, 0, 0 } },
    { RAD_PLASFUNC, { 1, 0, 0 } },    { RAD_METFUNC, { 1, 0, 0 } },
    { RAD_TRANSFUNC, { 1, 0, 0 } },   { RAD_BRTDFUNC, { 9, 0, 0 } },
    { RAD_PLASDATA, { 2, 1, 1 } },    { RAD_METDATA, { 2, 1, 1 } },
    { RAD_TRANSDATA, { 2, 1, 1 } },   { RAD_PRISM1, { 4, 0, 0 } },
    { RAD_PRISM2, { 8, 0, 0 } },      { RAD_WGMDFUNC, { 12, 0, 0 } },
    { RAD_BSDF, { 5, 1, 1 } },        { RAD_ABSDF, { 4, 0, 1 } },
};

struct rad_file_strings
rad_otype_files(enum rad_otype type)
{
    for (size_t i = 0; i < sizeof named_files / sizeof named_files[0]; i++)
        if (named_files[i].type == type)
            return named_files[i].at;
    return (struct rad_file_strings){ .function = -1 };
}

/* Is string `at` the place of a text's file in an object that holds the text
 * itself, as the words that follow or, after ".", as none? */
static bool
is_own_text(const struct rad_object *o, int at)
{
    int text = o->type == RAD_MIXTEXT ? 3 : 1;

    return at == text && at < o->nstrings &&
           (o->type == RAD_BRIGHTTEXT || o->type == RAD_COLORTEXT ||
            o->type == RAD_MIXTEXT) &&
           (o->nstrings > at + 1 || strcmp(o->strings[at], ".") == 0);
}

/* String `at` if it names a file.  For a function file "." means none. */
static const char *
file_at(const struct rad_object *o, int at, bool function)
{
    if (at < 0 || at >= o->nstrings || is_own_text(o, at) ||
        (function && strcmp(o->strings[at], ".") == 0))
        return NULL;
    return o->strings[at];
}

const char *
rad_object_file(const struct rad_object *o, int k)
{
    const struct rad_file_strings at = rad_otype_files(o->type);

    if (k < at.n)
        return file_at(o, at.first + k, false);
    return k == at.n ? file_at(o, at.function, true) : NULL;
}

int32_t
rad_scene_alias(const struct rad_scene *s, int32_t index, bool *own)
{
    *own = index >= 0 && s->objects[index].type == RAD_ALIAS &&
           s->objects[index].nstrings > 0;
    while (index >= 0 && s->objects[index].type == RAD_ALIAS) {
        const struct rad_object *o = &s->objects[index];

        index = o->nstrings ? rad_scene_find_modifier(s, o->strings[0], index)
                            : o->modifier;
    }
    return index;
}
