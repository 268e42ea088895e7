/* part.c - see part.h
 *
 * The scene's array is gone through once.  A part that is read on the way
 * appends its objects, which are gone through before the next object.  Parts
 * are found by name, the last one found first, since objects that follow each
 * other often name the same file. */
#include "config.h"

#include "base/list.h"
#include "scene/meshfile.h"
#include "scene/octfile.h"
#include "scene/part.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct including {
    struct rad_scene *scene;
    const struct rad_files *files;
    void (*each)(void *arg, const struct rad_error *err);
    void *arg;
    struct rad_error *err; /* gets the first error */
    int rc;                /* its code */
    struct rad_part *last; /* the part found last */
};

/* Report an error of object i. */
static void
report(struct including *in, int32_t i, const struct rad_error *why)
{
    struct rad_error now = { 0 };
    char text[512];

    rad_error_format(why, text, sizeof text);
    rad_scene_fail(in->scene, &in->scene->objects[i], &now, why->code, "%s",
                   text);
    if (in->each)
        in->each(in->arg, &now);
    if (in->rc == 0) {
        in->rc = now.code;
        if (in->err && in->err->code == 0)
            *in->err = now;
    }
}

static struct rad_part *
find_part(const struct including *in, const struct rad_object *o)
{
    const struct rad_scene *s = in->scene;

    if (in->last && in->last->type == o->type &&
        strcmp(in->last->name, o->strings[0]) == 0)
        return in->last;
    for (int32_t i = 0; i < s->nparts; i++)
        if (s->parts[i]->type == o->type &&
            strcmp(s->parts[i]->name, o->strings[0]) == 0)
            return s->parts[i];
    return NULL;
}

static struct rad_part *
add_part(struct rad_scene *s, const struct rad_object *o, struct rad_error *err)
{
    int32_t n = s->nparts;
    struct rad_part *p;

    if (n == RAD_MAX_PARTS) {
        rad_fail(err, RAD_EDATA, "more than %d files of instances and meshes",
                 RAD_MAX_PARTS);
        return NULL;
    }
    p = rad_arena_calloc(&s->arena, 1, sizeof *p);
    if (!p || !rad_list_grow(&s->parts, (size_t)n, sizeof *s->parts)) {
        rad_fail_memory(err);
        return NULL;
    }
    p->name = o->strings[0]; /* it lives in the same arena */
    p->type = o->type;
    p->first = s->nobjects;
    p->index = n;
    s->parts[s->nparts++] = p;
    return p;
}

static int
read_bytes(struct rad_scene *s, struct rad_part *p, const void *bytes,
           size_t len, struct rad_error *err)
{
    struct rad_memory_in from = { bytes, len };
    struct rad_stream in = rad_memory_stream(&from);
    struct rad_octfile how = { 0 };
    int rc;

    if (p->type == RAD_MESH)
        return rad_meshfile_read(s, p, &in, p->name, err);
    rc = rad_octfile_read_as(s, &how, &in, p->name, err);
    memcpy(p->org, how.org, sizeof p->org);
    p->size = how.size;
    return rc;
}

static void include_range(struct including *in, int32_t first, int32_t end,
                          int level, int *depth);

/* Read a part and the parts within it. */
static int
read_part(struct including *in, struct rad_part *p, int level,
          struct rad_error *err)
{
    struct rad_scene *s = in->scene;
    unsigned char *bytes;
    size_t len;
    int rc, depth = 0;

    if (level > RAD_MAX_PART_DEPTH)
        return rad_fail(err, RAD_EDATA,
                        "instances are nested more than %d files deep",
                        RAD_MAX_PART_DEPTH);
    if (!in->files)
        return rad_fail(err, RAD_ENOINPUT, "no file '%s'", p->name);
    bytes = in->files->read(in->files->arg, p->name, &len, err);
    if (!bytes)
        return err->code;
    rc = read_bytes(s, p, bytes, len, err);
    free(bytes);
    if (rc)
        return rc;
    p->n = s->nobjects - p->first;
    include_range(in, p->first, s->nobjects, level, &depth);
    p->depth = depth;
    p->complete = true;
    return 0;
}

/* The part that object i names, read if need be. */
static struct rad_part *
get_part(struct including *in, int32_t i, int level, struct rad_error *err)
{
    const struct rad_object *o = &in->scene->objects[i];
    struct rad_part *p = find_part(in, o);

    if (!p) {
        p = add_part(in->scene, o, err);
        if (p && read_part(in, p, level, err))
            p->failed = true; /* report it once, not for every object */
        if (!p || p->failed)
            return NULL;
    }
    if (p->failed || p->complete)
        return p;
    rad_fail(err, RAD_EDATA, "'%s' holds itself", p->name);
    return NULL;
}

/* Set what object i is a copy of; *depth becomes at least the depth of a part
 * that holds it. */
static int
include(struct including *in, int32_t i, int level, int *depth,
        struct rad_error *err)
{
    struct rad_object *o = &in->scene->objects[i];
    struct rad_part *part;
    struct rad_use *use;
    int rc;

    if (o->nstrings < 1)
        return rad_fail(err, RAD_EDATA,
                        "expected at least 1 string arguments, got 0");
    use = rad_arena_alloc(&in->scene->arena, sizeof *use);
    if (!use)
        return rad_fail_memory(err);
    rc = rad_xform_parse(&use->move, o->strings + 1, o->nstrings - 1, err);
    if (rc)
        return rc;
    part = get_part(in, i, level, err);
    if (!part)
        return err->code;
    in->last = part;
    use->part = part;
    in->scene->objects[i].use = use; /* the array may have moved */
    if (part->depth >= *depth)
        *depth = part->depth + 1;
    return 0;
}

static void
include_range(struct including *in, int32_t first, int32_t end, int level,
              int *depth)
{
    for (int32_t i = first; i < end && (in->each || !in->rc); i++) {
        enum rad_otype type = in->scene->objects[i].type;
        struct rad_error why = { 0 };

        if (type != RAD_INSTANCE && type != RAD_MESH)
            continue;
        if (include(in, i, level + 1, depth, &why))
            report(in, i, &why);
    }
}

int
rad_scene_include(struct rad_scene *s, const struct rad_files *files,
                  void (*each)(void *arg, const struct rad_error *err),
                  void *arg, struct rad_error *err)
{
    struct including in = { s, files, each, arg, err, 0, NULL };
    int depth = 0;

    include_range(&in, 0, s->nobjects, 0, &depth);
    return in.rc;
}
