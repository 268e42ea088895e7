/* warning.h - warnings about a scene that can be rendered
 *
 * These are the warnings of rad_scene_check() that were kept while the scene
 * was read, and those about its octree, its lights and its rendering.  Each is
 * one line that begins with "warning: ".
 * Thread: as compile.h. */
#ifndef RADD_CLIENT_WARNING_H
#define RADD_CLIENT_WARNING_H

#include "base/error.h"

#include <stdbool.h>
#include <stdint.h>

#define WARNING_SIZE 560 /* room for a place and its fault */

struct compiled;
struct rad_scene;

/* Keep a warning for warning_of(); only the first few are kept. */
void warning_keep(struct compiled *c, const struct rad_error *err);

/* Get warning number i, from 0, of a scene and its octree; false: there are no
 * more. */
bool warning_of(const struct compiled *c, int i, char text[WARNING_SIZE]);

/* Can nothing light a picture of the scene, with or without indirect light, or
 * is nothing there to be seen?  For a whole picture only, since parts of a
 * scene may be dark. */
bool warning_dark(const struct compiled *c, bool indirect,
                  char text[WARNING_SIZE]);

/* Warn that functions of object number `object`, or its up vector, failed in
 * `count` places; false: there is no such object. */
bool warning_fault(const struct rad_scene *scene, uint32_t object,
                   uint64_t count, char text[WARNING_SIZE]);

#endif
