/* reach.c - what of a scene its surfaces use; see scene.h */
#include "config.h"

#include "scene/scene.h"

#include <stdlib.h>
#include <string.h>

/* Modifier that object i names by string, or RAD_VOID. */
static int32_t
named_modifier(const struct rad_scene *s, int32_t i)
{
    const struct rad_object *o = &s->objects[i];

    if (o->nstrings == 0)
        return RAD_VOID;
    switch (o->type) {
    case RAD_ALIAS:
    case RAD_ILLUM:
    case RAD_MIRROR:
    case RAD_ANTIMATTER: /* of the others only the name counts */
        return rad_scene_find_modifier(s, o->strings[0], i);
    default:
        return RAD_VOID;
    }
}

/* An object refers to lower indices only, so one pass downwards finds all. */
void
rad_scene_reach(const struct rad_scene *s, uint8_t *reached)
{
    memset(reached, 0, (size_t)s->nobjects);
    for (int32_t i = s->nobjects; i-- > 0;) {
        const struct rad_object *o = &s->objects[i];
        int32_t named;

        if (rad_otype_class(o->type) == RAD_CLASS_SURFACE)
            reached[i] = 1;
        if (!reached[i])
            continue;
        if (o->modifier != RAD_VOID)
            reached[o->modifier] = 1;
        named = named_modifier(s, i);
        if (named != RAD_VOID)
            reached[named] = 1;
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

const char *
rad_object_file(const struct rad_object *o, int k)
{
    switch (o->type) {
    case RAD_COLORTEXT:
    case RAD_BRIGHTTEXT: /* the font, and the text if it is in a file */
        if (k < o->nstrings && (k == 0 || (k == 1 && o->nstrings == 2)))
            return o->strings[k];
        return NULL;
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
