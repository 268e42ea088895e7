/* parse.h - scene text to objects
 *
 * Reads what Radiance's programs read: objects, aliases (with `inherit`),
 * comments, and `!command` lines, whose output is read in their place.  The
 * parser runs no commands: a callback does, and without one they are errors.
 * The parser checks syntax only; rad_scene_check() checks arguments.
 * Limits: those of scene.h and lex.h; commands nested RAD_MAX_NESTING deep.
 * Source: Radiance's reference manual, "Scene description".
 * Thread: any, one at a time for a scene.  */
#ifndef RAD_SCENE_PARSE_H
#define RAD_SCENE_PARSE_H

#include "base/files.h"
#include "scene/scene.h"

#define RAD_MAX_NESTING 32

struct rad_parse_io {
    /* Start a command; set *out to its output and *job to the argument of
     * end_command.  Negative code: it could not be started. */
    int (*begin_command)(void *arg, const char *command, struct rad_stream *out,
                         void **job, struct rad_error *err);
    /* End a command whose output was read to its end, or, with `stop`, is not
     * wanted any more.  Negative code: the command failed. */
    int (*end_command)(void *arg, void *job, bool stop, struct rad_error *err);
    /* If not NULL, called with every error; reading goes on after undefined
     * modifiers and types, and ends after others. */
    void (*each)(void *arg, const struct rad_error *err);
    /* If not NULL, called with a RAD_WARNING for each text without objects. */
    void (*warn)(void *arg, const struct rad_error *err);
    void *arg;
};

/* Append the objects of a text called `name` to the scene.  io may be NULL.
 * *err gets the first error, with file and line ("office.rad:214: undefined
 * modifier 'wood'"), and its code is returned; the scene then holds what was
 * read so far. */
int rad_parse(struct rad_scene *s, const struct rad_stream *in,
              const char *name, const struct rad_parse_io *io,
              struct rad_error *err);

/* The same for text in memory. */
int rad_parse_text(struct rad_scene *s, const char *text, size_t len,
                   const char *name, const struct rad_parse_io *io,
                   struct rad_error *err);

#endif
