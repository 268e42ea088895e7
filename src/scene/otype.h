/* otype.h - the primitive types of Radiance's scene language
 *
 * One table, otype.def, lists every type with its class.  check.c checks the
 * arguments of a type; its behaviour is in geom/, pattern/ and shade/. */
#ifndef RAD_SCENE_OTYPE_H
#define RAD_SCENE_OTYPE_H

#include <stdbool.h>

enum rad_oclass {
    RAD_CLASS_SURFACE,
    RAD_CLASS_MATERIAL, /* ends a modifier chain: gives a radiance */
    RAD_CLASS_TEXTURE,  /* perturbs the normal */
    RAD_CLASS_PATTERN,  /* multiplies the colour */
    RAD_CLASS_MIXTURE,
    RAD_CLASS_ALIAS
};

enum rad_otype {
#define OTYPE(symbol, name, class) RAD_##symbol,
#include "scene/otype.def"
#undef OTYPE
    RAD_NOTYPES
};

const char *rad_otype_name(enum rad_otype t);
enum rad_oclass rad_otype_class(enum rad_otype t);
int rad_otype_find(const char *name); /* -1: no such type */

static inline bool
rad_otype_is_surface(enum rad_otype t)
{
    return rad_otype_class(t) == RAD_CLASS_SURFACE;
}

#endif
