/* scene.h - the objects of a scene, as their authors wrote them
 *
 * A scene is an array of objects in the order of their definition: modifiers
 * (materials, textures, patterns, mixtures) and surfaces, each naming the
 * modifier before it that applies to it, with string and real arguments.
 * parse.h makes one from .rad text, octfile.h from an octree; both give the
 * same array.  The array says nothing of how a ray meets it: job.h compiles
 * it for rendering.
 * Limits: RAD_MAX_OBJECTS objects, RAD_MAX_ARGS string and as many real
 * arguments each, words (names and strings) of RAD_MAX_WORD bytes: what
 * Radiance's octree files can hold, and its programs read.  What a surface leads
 * to may be nested RAD_MAX_NESTED deep.
 * Memory: rad_scene_free() ends all of it.
 * Thread: immutable once made; any number of threads may read it.
 * Source: Radiance's reference manual, "Scene description". */
#ifndef RAD_SCENE_SCENE_H
#define RAD_SCENE_SCENE_H

#include "base/arena.h"
#include "base/error.h"
#include "scene/otype.h"

#include <stdbool.h>
#include <stdint.h>

#define RAD_VOID (-1) /* no modifier, no object */

#define RAD_MAX_OBJECTS 100000000
#define RAD_MAX_ARGS    32767
#define RAD_MAX_WORD    511
#define RAD_MAX_NESTED  256 /* modifiers by way of strings: shading recurses */

struct rad_names;
struct rad_part; /* part.h */
struct rad_use;

struct rad_object {
    enum rad_otype type;
    int32_t modifier; /* index of the object that modifies this, or RAD_VOID */
    int32_t file;     /* index into scene->files, or -1 (from an octree) */
    int32_t line;     /* 1-based, where the definition starts; 0 unknown */
    const char *name;
    int32_t nstrings;
    int32_t nreals;
    const char *const *strings;
    const double *reals;
    const struct rad_use *use; /* instance, mesh: by rad_scene_include() */
};

struct rad_scene {
    struct rad_arena arena;
    struct rad_object *objects;
    int32_t nobjects;
    int32_t capacity;
    const char **files; /* names of the files that it was read from */
    int32_t nfiles;
    struct rad_names *names; /* modifiers by name */
    struct rad_part **parts; /* files of instances and meshes: part.h */
    int32_t nparts;
};

struct rad_scene *rad_scene_new(void); /* NULL: out of memory */
void rad_scene_free(struct rad_scene *s);

/* Remember a file's name; returns its index or a negative code. */
int rad_scene_add_file(struct rad_scene *s, const char *name,
                       struct rad_error *err);

/* Append a copy of *o (name and arguments are copied into the arena).
 * Returns its index or a negative code (RAD_ENOMEM; RAD_EDATA beyond a limit
 * above). */
int rad_scene_add(struct rad_scene *s, const struct rad_object *o,
                  struct rad_error *err);

/* Index of the last modifier called name among the first `before` objects, or
 * RAD_VOID.  Logarithmic or better: the scene keeps an index by name.  As in
 * Radiance, a definition that repeats the one before it of that name does not
 * replace it: the first of the two is found. */
int rad_scene_find_modifier(const struct rad_scene *s, const char *name,
                            int32_t before);

/* The modifier before object `index` that its string argument k names; *mod is
 * RAD_VOID for "void".  RAD_EDATA: there is none of that name. */
int rad_scene_named(const struct rad_scene *s, int32_t index, int32_t k,
                    int32_t *mod, struct rad_error *err);

/* "office.rad:214: material 'wood': <fmt...>", with err->where set to file and
 * line when they are known; returns code. */
int rad_scene_fail(const struct rad_scene *s, const struct rad_object *o,
                   struct rad_error *err, int code, const char *fmt, ...)
    __attribute__((format(printf, 5, 6)));

/* Are the two radii of a cone, cup or ring such as have a surface?  One that
 * has none, by opposite signs or a ring's below 0, is left out of the scene. */
bool rad_object_radii_fit(const struct rad_object *o);

/* The modifier that an alias stands for: the end of the chain of aliases that
 * starts at object `index`, which is no alias itself; RAD_VOID where the chain
 * ends in nothing.  For another type, index itself.  What modifies the result
 * is the first alias' own modifier if *own is set, else the result's. */
int32_t rad_scene_alias(const struct rad_scene *s, int32_t index, bool *own);

/* Set reached[i], for all i, to whether object i is a surface whose modifier
 * counts or what such a surface leads to: its modifiers, theirs, and those named
 * by strings.  The modifiers of what an instance or mesh is a copy of count
 * unless its own modifier replaces them, in every copy there is. */
void rad_scene_reach(const struct rad_scene *s, uint8_t *reached);

/* How deep modifiers are nested by strings that name others (mixtures, aliases,
 * what stands in for an illum), by object; a chain of modifiers is as deep as
 * the deepest of them. */
void rad_scene_nesting(const struct rad_scene *s, int32_t *depth);

/* The k-th file that an object reads when it is rendered, as it names it; NULL
 * beyond the last.  Those of instances and meshes are the scene's parts. */
const char *rad_object_file(const struct rad_object *o, int k);

/* Which types do the surfaces reach, with their own?  needs[t] is set for
 * those. */
void rad_scene_needs(const struct rad_scene *s, bool needs[RAD_NOTYPES]);

/* Check the arguments of every object against what its type demands, and
 * refuse what is wrong where a surface reaches it: modifiers that nothing uses
 * may be anything.  The first problem is put in *err; if `each` is not NULL it
 * is called with every one (radscene check prints them all).  Returns 0 or the
 * first code. Besides, `each` is called with warnings, of the code RAD_WARNING:
 * of what is wrong with modifiers that nothing uses, and of surfaces that rays
 * do not meet. */
int rad_scene_check(const struct rad_scene *s,
                    void (*each)(void *arg, const struct rad_error *err),
                    void *arg, struct rad_error *err);

#endif
