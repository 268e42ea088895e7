/* warning.h - what the user should know of a scene that renders all the same
 *
 * What rad_scene_check() warns of, if nobody was told while the scene was read,
 * and what its octree, its lights and its rendering show.  Each is one line,
 * "warning: " and so on.
 * Thread: as compile.h. */
#ifndef RADD_CLIENT_WARNING_H
#define RADD_CLIENT_WARNING_H

#include "base/error.h"

#include <stdbool.h>
#include <stdint.h>

#define WARNING_SIZE 560 /* a place and what is wrong there */

struct compiled;
struct rad_scene;

/* Keep a warning for warning_of(); of many the first few. */
void warning_keep(struct compiled *c, const struct rad_error *err);

/* Warning number i of a scene and its octree, counted from 0; false: there are
 * no more. */
bool warning_of(const struct compiled *c, int i, char text[WARNING_SIZE]);

/* Is there nothing that could light a picture of the scene, with indirect light
 * or without, or nothing to see?  Said of what is rendered, for a part of a
 * scene may well be dark. */
bool warning_dark(const struct compiled *c, bool indirect,
                  char text[WARNING_SIZE]);

/* What the user should know of functions of object number `object` that had no
 * value in so many places; false: there is no such object. */
bool warning_fault(const struct rad_scene *scene, uint32_t object,
                   uint64_t count, char text[WARNING_SIZE]);

#endif
