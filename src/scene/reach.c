/* reach.c - what of a scene its surfaces use; see scene.h */
#include "config.h"

#include "scene/scene.h"

#include <stdlib.h>
#include <string.h>

/* How many of an object's first strings name modifiers. */
static int
named_count(const struct rad_object *o)
{
    switch (o->type) {
    case RAD_ALIAS:
    case RAD_ILLUM:
    case RAD_MIRROR:
    case RAD_ANTIMATTER: /* of the others only the name counts */
        return o->nstrings > 0;
    case RAD_MIXFUNC:
        return o->nstrings >= 2 ? 2 : 0;
    default:
        return 0;
    }
}

/* An object refers to lower indices only, so one pass downwards finds all. */
void
rad_scene_reach(const struct rad_scene *s, uint8_t *reached)
{
    memset(reached, 0, (size_t)s->nobjects);
    for (int32_t i = s->nobjects; i-- > 0;) {
        const struct rad_object *o = &s->objects[i];
        if (rad_otype_class(o->type) == RAD_CLASS_SURFACE)
            reached[i] = 1;
        if (!reached[i])
            continue;
        if (o->modifier != RAD_VOID)
            reached[o->modifier] = 1;
        for (int k = named_count(o); k-- > 0;) {
            int32_t named = rad_scene_find_modifier(s, o->strings[k], i);

            if (named != RAD_VOID)
                reached[named] = 1;
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
        if (!reached || reached[i]) /* out of memory: all there are */
            needs[s->objects[i].type] = true;
    free(reached);
}

/* A function file; "." stands for none. */
static const char *
function_file(const struct rad_object *o, int at)
{
    if (at >= o->nstrings || strcmp(o->strings[at], ".") == 0)
        return NULL;
    return o->strings[at];
}

const char *
rad_object_file(const struct rad_object *o, int k)
{
    switch (o->type) {
    case RAD_COLORTEXT:
    case RAD_BRIGHTTEXT: /* the font, and the text if it is in a file */
        if (k < o->nstrings && (k == 0 || (k == 1 && o->nstrings == 2)))
            return o->strings[k];
        return NULL;
    case RAD_BRIGHTFUNC:
        return k == 0 ? function_file(o, 1) : NULL;
    case RAD_COLORFUNC:
    case RAD_TEXFUNC:
    case RAD_MIXFUNC:
    case RAD_PLASTIC2:
    case RAD_METAL2:
    case RAD_TRANS2:
        return k == 0 ? function_file(o, 3) : NULL;
    default:
        return NULL;
    }
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
