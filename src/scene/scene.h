/* scene.h - the objects of a scene, as their authors wrote them
 *
 * A scene is an array of objects in the order of their definition: modifiers
 * (materials, textures, patterns, mixtures) and surfaces.  Each has string and
 * real arguments, and names the modifier, defined before it, that applies to
 * it.  parse.h makes a scene from .rad text, octfile.h from an octree; both
 * give the same array.  job.h compiles it for rendering.
 * Limits: RAD_MAX_OBJECTS objects; RAD_MAX_ARGS string and as many real
 * arguments each; words (names and strings) of RAD_MAX_WORD bytes, which is
 * what Radiance's octree files can hold and its programs read; modifiers that
 * surfaces use nested RAD_MAX_NESTED deep.
 * Memory: rad_scene_free() frees all of it.
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
#define RAD_MAX_NESTED  256 /* by strings that name modifiers: shading
                             * recurses */

struct rad_names;
struct rad_part; /* part.h */
struct rad_use;

struct rad_object {
    enum rad_otype type;
    int32_t modifier; /* index of the object that modifies this, or RAD_VOID */
    int32_t file;     /* index into scene->files; -1: not known */
    int32_t line;     /* 1-based, where the definition starts; 0: not known */
    const char *name;
    int32_t nstrings;
    int32_t nreals;
    const char *const *strings;
    const double *reals;
    const struct rad_use *use; /* of an instance or mesh: rad_scene_include() */
};

struct rad_scene {
    struct rad_arena arena;
    struct rad_object *objects;
    int32_t nobjects;
    const char **files; /* names of the files that the scene was read from */
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

/* The index of the last modifier called `name` among the first `before`
 * objects, or RAD_VOID.  It takes at most logarithmic time, by an index of
 * names.  As in Radiance, a definition that repeats the one before it of that
 * name does not replace it: the first of the two is found. */
int rad_scene_find_modifier(const struct rad_scene *s, const char *name,
                            int32_t before);

/* The first object that is a spectrum; NULL: the scene gives all its colours as
 * red, green and blue. */
const struct rad_object *rad_scene_spectrum(const struct rad_scene *s);

/* The modifier that string argument k of object `index` names; it must be
 * defined before that object.  *mod is RAD_VOID for "void".  RAD_EDATA: there
 * is none of that name. */
int rad_scene_named(const struct rad_scene *s, int32_t index, int32_t k,
                    int32_t *mod, struct rad_error *err);

/* Fail with "office.rad:214: material 'wood': <fmt...>"; err->where is set to
 * file and line if they are known.  Returns code. */
int rad_scene_fail(const struct rad_scene *s, const struct rad_object *o,
                   struct rad_error *err, int code, const char *fmt, ...)
    __attribute__((format(printf, 5, 6)));

/* Have the two radii of a cone, cup or ring a surface?  Not if they have
 * opposite signs, or if a ring's is negative; such an object is left out of the
 * scene. */
bool rad_object_radii_fit(const struct rad_object *o);

/* The type of a surface as its radii make it: negative ones turn a sphere, a
 * bubble, a cylinder, a tube or a cup inside out, and a cone of equal radii is
 * a cylinder. */
enum rad_otype rad_object_shape(const struct rad_object *o);

/* The modifier that an alias stands for: the end of the chain of aliases that
 * starts at object `index`, or RAD_VOID if the chain ends in nothing.  For
 * another type, index itself.  If *own is set, the result is modified by the
 * first alias' modifier, else by its own. */
int32_t rad_scene_alias(const struct rad_scene *s, int32_t index, bool *own);

/* Set reached[i] for all objects i that count: surfaces, the modifiers in their
 * chains, and the modifiers that strings of these name.  Surfaces of a part
 * only count if there is a copy of it in which they keep their own
 * modifiers. */
void rad_scene_reach(const struct rad_scene *s, uint8_t *reached);

/* By object, how deep modifiers are nested by strings that name others (in
 * mixtures, aliases, illums).  A chain of modifiers is as deep as the deepest
 * of them. */
void rad_scene_nesting(const struct rad_scene *s, int32_t *depth);

/* Which string arguments of a type name files that its objects read when they
 * are rendered: the function file, or -1, and n others from `first` on. */
struct rad_file_strings {
    int function;
    int first, n;
};
struct rad_file_strings rad_otype_files(enum rad_otype type);

/* The name of the k-th file that an object reads when it is rendered; NULL
 * beyond the last.  Files of instances and meshes are not among them: they are
 * the scene's parts. */
const char *rad_object_file(const struct rad_object *o, int k);

/* Set needs[t] for each type t of surfaces and of modifiers that they reach. */
void rad_scene_needs(const struct rad_scene *s, bool needs[RAD_NOTYPES]);

/* Check the arguments of every object against the rules of its type.  Problems
 * of modifiers that no surface uses are not errors.  Returns 0, or the code of
 * the first error, which is put in *err.  If `each` is not NULL, it is called
 * with every error (radscene check prints them all), and with warnings, of code
 * RAD_WARNING: for problems of modifiers that no surface uses, and for surfaces
 * that rays do not meet. */
int rad_scene_check(const struct rad_scene *s,
                    void (*each)(void *arg, const struct rad_error *err),
                    void *arg, struct rad_error *err);

#endif
