/* warning.c - see warning.h */
#include "config.h"

#include "compile/warning.h"

#include "compile/compile.h"
#include "scene/part.h"
#include "trace/material.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MOST_KEPT 8

struct warnings {
    int n; /* warnings so far; MOST_KEPT at most are kept */
    char text[MOST_KEPT][WARNING_SIZE];
};

/* Surfaces of instances and meshes that would be light sources outside.  An
 * instance or mesh that gives its own material to its surfaces counts as one.
 */
static int32_t
lights_within(const struct compiled *c)
{
    const struct rad_scene *s = c->scene;
    int32_t n = 0;

    for (int32_t i = 0; i < s->nobjects; i++) {
        const struct rad_object *o = &s->objects[i];
        bool within = i >= rad_scene_own(s) || o->type == RAD_INSTANCE ||
                      o->type == RAD_MESH;

        n += within && rad_surface_lights(s, i);
    }
    return n;
}

static bool
warn_of_octree(const struct compiled *c, char text[WARNING_SIZE])
{
    int32_t n = c->octree.left_out;

    if (n == 0)
        return false;
    snprintf(text, WARNING_SIZE,
             "warning: full cubes of the octree lack %" PRId32 " surface%s, "
             "%d a cube being Radiance's limit: its programs may miss %s "
             "there; our own rendering is not affected",
             n, n == 1 ? "" : "s", RAD_OCTREE_MAX_SET, n == 1 ? "it" : "them");
    return true;
}

static bool
warn_of_lights(const struct compiled *c, char text[WARNING_SIZE])
{
    int32_t n = lights_within(c);

    if (n == 0)
        return false;
    snprintf(text, WARNING_SIZE,
             "warning: %" PRId32 " surface%s of instances and meshes %s of a "
             "light source's material: seen, but no source of light, as in "
             "Radiance",
             n, n == 1 ? "" : "s", n == 1 ? "is" : "are");
    return true;
}

/* Does surface i light others?  Distant glows, and surfaces within instances,
 * do so by indirect light alone. */
static bool
gives_light(const struct rad_scene *s, int32_t i, bool indirect)
{
    const struct rad_object *o = &s->objects[i], *m;
    int32_t material = rad_material_of(s, o->modifier);

    if (material == RAD_VOID)
        return false;
    m = &s->objects[material];
    if (indirect && m->type == RAD_GLOW)
        return true;
    if (!indirect && (i >= rad_scene_own(s) ||
                      (m->type == RAD_GLOW && o->type == RAD_SOURCE)))
        return false;
    return rad_material_lights(m) || /* which may hold such a material */
           rad_otype_class(m->type) == RAD_CLASS_MIXTURE;
}

/* Is there a light source of this name?  Names of relays may stand before it,
 * each followed by '>'. */
static bool
is_light(const struct rad_scene *s, const char *name)
{
    const char *last = strrchr(name, '>');

    if (last)
        name = last + 1;
    for (int32_t i = 0; i < rad_scene_own(s); i++)
        if (strcmp(s->objects[i].name, name) == 0 && rad_surface_lights(s, i))
            return true;
    return false;
}

/* Warn of the first mist that names a missing light source. */
static bool
warn_of_mists(const struct compiled *c, char text[WARNING_SIZE])
{
    const struct rad_scene *s = c->scene;
    struct rad_error err = { 0 };
    char where[WARNING_SIZE - 10];

    for (int32_t i = 0; i < s->nobjects; i++) {
        const struct rad_object *o = &s->objects[i];

        for (int k = 0; o->type == RAD_MIST && k < o->nstrings; k++) {
            if (is_light(s, o->strings[k]))
                continue;
            rad_scene_fail(s, o, &err, RAD_EDATA, "no light source '%.40s'",
                           o->strings[k]);
            rad_error_format(&err, where, sizeof where);
            snprintf(text, WARNING_SIZE, "warning: %s", where);
            return true;
        }
    }
    return false;
}

void
warning_keep(struct compiled *c, const struct rad_error *err)
{
    char text[WARNING_SIZE - 10];

    if (!c->warnings)
        c->warnings = calloc(1, sizeof *c->warnings);
    if (!c->warnings || c->warnings->n++ >= MOST_KEPT)
        return;
    rad_error_format(err, text, sizeof text);
    snprintf(c->warnings->text[c->warnings->n - 1], WARNING_SIZE, "warning: %s",
             text);
}

/* The i-th warning that was kept; one more says how many were not. */
static bool
kept(const struct compiled *c, int i, char text[WARNING_SIZE])
{
    int n = c->warnings ? c->warnings->n : 0;

    if (i >= n || i > MOST_KEPT)
        return false;
    if (i < MOST_KEPT)
        memcpy(text, c->warnings->text[i], WARNING_SIZE);
    else
        snprintf(text, WARNING_SIZE,
                 "warning: %d more of these: radscene check tells them all",
                 n - MOST_KEPT);
    return true;
}

bool
warning_of(const struct compiled *c, int i, char text[WARNING_SIZE])
{
    static bool (*const warnings[])(
        const struct compiled *,
        char[WARNING_SIZE]) = { warn_of_octree, warn_of_lights, warn_of_mists };

    if (kept(c, i, text))
        return true;
    for (int before = 0; kept(c, before, text); before++)
        i--;
    for (size_t k = 0; k < sizeof warnings / sizeof warnings[0]; k++)
        if (warnings[k](c, text) && i-- == 0)
            return true;
    return false;
}

bool
warning_dark(const struct compiled *c, bool indirect, char text[WARNING_SIZE])
{
    const struct rad_scene *s = c->scene;
    int32_t surfaces = 0;

    for (int32_t i = 0; i < s->nobjects; i++) {
        if (!rad_otype_is_surface(s->objects[i].type))
            continue;
        surfaces++;
        if (gives_light(s, i, indirect))
            return false;
    }
    snprintf(text, WARNING_SIZE, "warning: %s",
             surfaces == 0 ? "the scene has no surface"
                           : "no light sources found: what does not shine "
                             "itself is black but for -av");
    return true;
}

bool
warning_fault(const struct rad_scene *scene, uint32_t object, uint64_t count,
              char text[WARNING_SIZE])
{
    struct rad_error what = { 0 };
    char place[WARNING_SIZE];
    enum rad_otype type;
    bool upright; /* has it an up vector, without which it is black? */

    if (object >= (uint32_t)scene->nobjects)
        return false;
    type = scene->objects[object].type;
    upright = type == RAD_BSDF || type == RAD_ABSDF;
    rad_scene_fail(scene, &scene->objects[object], &what, RAD_EDATA,
                   upright ? "no way up, or no value, in %" PRIu64
                             " place%s (up vector along the normal, domain "
                             "error, division by zero or missing argument), "
                             "black there"
                           : "no value in %" PRIu64
                             " place%s (domain error, division by zero or "
                             "missing argument), passed over there",
                   count, count == 1 ? "" : "s");
    rad_error_format(&what, place, sizeof place);
    snprintf(text, WARNING_SIZE, "warning: %.*s", WARNING_SIZE - 12, place);
    return true;
}
