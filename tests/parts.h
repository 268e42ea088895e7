/* parts.h - files of instances and meshes made in memory, for tests */
#ifndef RADD_TESTS_PARTS_H
#define RADD_TESTS_PARTS_H

#include "scene/octree.h"
#include "scene/octfile.h"
#include "scene/file/parse.h"
#include "scene/part.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PARTS_MAX 80

struct parts {
    struct {
        char name[32];
        struct rad_memory_out file;
        int reads;
    } list[PARTS_MAX];
    int n;
};

static inline void
parts_release(struct parts *p)
{
    for (int i = 0; i < p->n; i++)
        free(p->list[i].file.bytes);
    p->n = 0;
}

static inline unsigned char *
parts_read(void *arg, const char *name, size_t *len, struct rad_error *err)
{
    struct parts *p = arg;

    for (int i = 0; i < p->n; i++)
        if (strcmp(p->list[i].name, name) == 0) {
            unsigned char *copy = malloc(p->list[i].file.len + 1);

            ck_assert_ptr_nonnull(copy);
            memcpy(copy, p->list[i].file.bytes, p->list[i].file.len);
            *len = p->list[i].file.len;
            p->list[i].reads++;
            return copy;
        }
    rad_fail(err, RAD_ENOINPUT, "no file '%s'", name);
    return NULL;
}

static inline struct rad_files
parts_files(struct parts *p)
{
    struct rad_files f = { .read = parts_read, .arg = p };

    return f;
}

/* A file of that name, to be written through the sink. */
static inline struct rad_sink
parts_add(struct parts *p, const char *name)
{
    ck_assert_int_lt(p->n, PARTS_MAX);
    snprintf(p->list[p->n].name, sizeof p->list[0].name, "%s", name);
    p->list[p->n].reads = 0;
    return rad_memory_sink(&p->list[p->n++].file);
}

/* The frozen octree of a scene text, which may have instances of what was
 * added before. */
static inline void
parts_add_octree(struct parts *p, const char *name, const char *text)
{
    struct rad_scene *s = rad_scene_new();
    struct rad_files files = parts_files(p);
    struct rad_error err = { 0 };
    struct rad_octree tree;
    struct rad_sink out;

    ck_assert_int_eq(rad_parse_text(s, text, strlen(text), name, NULL, &err),
                     0);
    ck_assert_msg(rad_scene_include(s, &files, NULL, NULL, &err) == 0, "%s: %s",
                  err.where, err.what);
    ck_assert_int_eq(rad_octree_build(&tree, s, RAD_OCTREE_LEAF, &err), 0);
    out = parts_add(p, name);
    ck_assert_int_eq(rad_octfile_write(s, &tree, &out, &err), 0);
    rad_octree_release(&tree);
    rad_scene_free(s);
}

/* --- a mesh of up to 256 vertices, written as Radiance's obj2mesh does ---- */

struct parts_vertex {
    double p[3];
    double n[3];  /* zero: none */
    double uv[2]; /* in (0, 1); zero: none */
};

struct parts_triangle {
    int v[3];
    int modifier; /* its place in `types`, -1: none */
};

static inline void
parts_put_int(const struct rad_sink *out, int64_t v, int bytes)
{
    unsigned char b[8];

    for (int i = 0; i < bytes; i++)
        b[i] = (unsigned char)((uint64_t)v >> 8 * (bytes - 1 - i));
    ck_assert_int_eq(out->write(out->arg, b, (size_t)bytes, NULL), 0);
}

static inline void
parts_put_text(const struct rad_sink *out, const char *s)
{
    ck_assert_int_eq(out->write(out->arg, s, strlen(s) + 1, NULL), 0);
}

static inline void
parts_put_real(const struct rad_sink *out, double x)
{
    int e = 0;
    double m = frexp(x, &e);

    parts_put_int(out, (int64_t)(m * 0x7fffffff), 4);
    parts_put_int(out, e, 1);
}

/* The code of a unit normal; see rad_mesh_normal(). */
static inline uint32_t
parts_normal_code(const double n[3])
{
    uint32_t code = 0, c[3], larger;

    if (n[0] == 0 && n[1] == 0 && n[2] == 0)
        return 0;
    for (int i = 0; i < 3; i++) {
        code |= (uint32_t)(n[i] < 0) << i;
        c[i] = (uint32_t)(fabs(n[i]) * 11584.5 + .5);
    }
    larger = c[0] <= c[1] ? c[1] : c[0];
    code |= c[0] <= c[1] ? 8 | c[0] << 5 : c[1] << 5;
    code |= c[2] <= larger ? 16 | c[2] << 18 : larger << 18;
    return code ? code : 8;
}

/* The cube goes from org to org + size along each axis; materials is scene text
 * of nothing but modifiers. */
static inline void
parts_add_mesh(struct parts *p, const char *name, const double org[3],
               double size, const struct parts_vertex *v, int nv,
               const struct parts_triangle *t, int nt, const char *materials)
{
    struct rad_scene *s = rad_scene_new();
    struct rad_sink sink = parts_add(p, name), *out = &sink;
    char text[64];

    ck_assert_int_eq(
        rad_parse_text(s, materials, strlen(materials), name, NULL, NULL), 0);
    ck_assert_int_eq(
        out->write(out->arg, "#?RADIANCE\nFORMAT=Radiance_tmesh\n\n",
                   strlen("#?RADIANCE\nFORMAT=Radiance_tmesh\n\n"), NULL),
        0);
    parts_put_int(out, 319 + 4, 2);
    for (int i = 0; i < 4; i++) {
        snprintf(text, sizeof text, "%.12g", i < 3 ? org[i] : size);
        parts_put_text(out, text);
    }
    for (int i = 0; i < 4; i++)
        parts_put_real(out, i & 1);
    parts_put_int(out, 1, 1); /* a tree of one cube, which lists none */
    parts_put_int(out, 0, 4);
    for (int32_t i = 0; i < s->nobjects; i++)
        parts_put_text(out, rad_otype_name(s->objects[i].type));
    parts_put_text(out, "");
    for (int32_t i = 0; i < s->nobjects; i++) {
        const struct rad_object *o = &s->objects[i];

        parts_put_int(out, i, 1);
        parts_put_int(out, o->modifier, 4);
        parts_put_text(out, o->name);
        parts_put_int(out, o->nstrings, 2);
        for (int k = 0; k < o->nstrings; k++)
            parts_put_text(out, o->strings[k]);
        parts_put_int(out, o->nreals, 2);
        for (int k = 0; k < o->nreals; k++)
            parts_put_real(out, o->reals[k]);
    }
    parts_put_int(out, -1, 1);
    rad_scene_free(s);
    parts_put_int(out, 1, 4); /* patches */
    parts_put_int(out, 7, 1);
    parts_put_int(out, nv, 2);
    for (int i = 0; i < nv; i++)
        for (int k = 0; k < 3; k++)
            parts_put_int(
                out, (int64_t)((v[i].p[k] - org[k]) / size * 4294967296.), 4);
    for (int i = 0; i < nv; i++)
        parts_put_int(out, parts_normal_code(v[i].n), 4);
    for (int i = 0; i < nv; i++)
        for (int k = 0; k < 2; k++)
            parts_put_int(out, (int64_t)(v[i].uv[k] * 4294967296.), 4);
    parts_put_int(out, nt, 2);
    for (int i = 0; i < nt; i++)
        for (int k = 0; k < 3; k++)
            parts_put_int(out, t[i].v[k], 1);
    parts_put_int(out, nt > 1 ? 2 : 1, 2);
    for (int i = 0; i < nt; i++)
        parts_put_int(out, t[i].modifier, 2);
    parts_put_int(out, 0, 2); /* none with vertices elsewhere */
    parts_put_int(out, 0, 2);
}

#endif
