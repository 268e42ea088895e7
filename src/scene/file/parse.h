/* parse.h - scene text to objects
 *
 * Reads what Radiance's programs read: objects, aliases (with `inherit`),
 * comments, and `!command` lines, whose output is read in their place.  The
 * parser runs nothing itself: commands go to a callback, and without one they
 * are an error.  What it accepts is well formed; whether arguments fit their
 * types is rad_scene_check()'s to say.
 * Limits: those of scene.h and lex.h, and commands RAD_MAX_NESTING deep.
 * Source: Radiance's reference manual, "Scene description".
 * Thread: any, one at a time for a scene.  */
#ifndef RAD_SCENE_PARSE_H
#define RAD_SCENE_PARSE_H

#include "base/error.h"
#include "scene/file/lex.h"
#include "scene/scene.h"

#define RAD_MAX_NESTING 32

struct rad_parse_io {
    /* Start a command that stands at file:line and set *out to its output, and
     * *job to what end_command gets.  Negative code: it could not be started.
     */
    int (*begin_command)(void *arg, const char *command, struct rad_stream *out,
                         void **job, struct rad_error *err);
    /* The command's output was read to the end, or is wanted no longer
     * (`stop`). Negative code: the command failed. */
    int (*end_command)(void *arg, void *job, bool stop, struct rad_error *err);
    /* If not NULL, called with every error that reading can go on after
     * (undefined modifiers and types); others end it. */
    void (*each)(void *arg, const struct rad_error *err);
    /* If not NULL, called with RAD_WARNINGs: texts without objects. */
    void (*warn)(void *arg, const struct rad_error *err);
    void *arg;
};

/* Append the objects of a text called `name` to the scene.  io may be NULL.
 * The first failure is put in *err with file and line
 * ("office.rad:214: undefined modifier 'wood'") and its code returned; the
 * scene then holds what was read before. */
int rad_parse(struct rad_scene *s, const struct rad_stream *in,
              const char *name, const struct rad_parse_io *io,
              struct rad_error *err);

/* The same from memory. */
int rad_parse_text(struct rad_scene *s, const char *text, size_t len,
                   const char *name, const struct rad_parse_io *io,
                   struct rad_error *err);

#endif
