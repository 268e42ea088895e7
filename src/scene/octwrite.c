/* octwrite.c - writing octree files; see octfile.h
 *
 * As in the reader, the output remembers its first failure. */
#include "config.h"

#include "scene/octfile.h"
#include "scene/octreal.h"
#include "scene/part.h"

#include <stdio.h>
#include <stdlib.h>

struct rad_output {
    struct rad_sink out;
    struct rad_error *err;
    int rc;
    size_t used;
    unsigned char buf[64 * 1024];
};

static void
flush(struct rad_output *f)
{
    if (!f->rc && f->used)
        f->rc = f->out.write(f->out.arg, f->buf, f->used, f->err);
    f->used = 0;
}

static void
put_byte(struct rad_output *f, int c)
{
    if (f->used == sizeof f->buf)
        flush(f);
    f->buf[f->used++] = (unsigned char)c;
}

static void
put_int(struct rad_output *f, int64_t v, int bytes)
{
    if (sizeof f->buf - f->used < 8)
        flush(f);
    while (bytes-- > 0)
        f->buf[f->used++] = (unsigned char)((uint64_t)v >> 8 * bytes);
}

/* Write a string, with its NUL or without. */
static void
put_text(struct rad_output *f, const char *s, bool nul)
{
    for (; *s; s++)
        put_byte(f, *s);
    if (nul)
        put_byte(f, '\0');
}

static void
put_real(struct rad_output *f, double x)
{
    struct rad_octreal p = rad_octreal_of(x);

    put_int(f, p.mantissa, 4);
    put_int(f, p.exponent, 1);
}

static void
put_start(struct rad_output *f, const struct rad_scene *s,
          const struct rad_octree *t)
{
    char text[64];

    put_text(f, "#?RADIANCE\nSOFTWARE= radd\nFORMAT=" RAD_OCT_FORMAT "\n\n",
             false);
    put_int(f, RAD_OCT_MAGIC + 4, 2);
    for (int i = 0; i < 4; i++) {
        snprintf(text, sizeof text, "%.12g", i < 3 ? t->org[i] : t->size);
        put_text(f, text, true);
    }
    put_byte(f, '\0'); /* no scene files */
    put_int(f, rad_scene_own(s), 4);
}

static void
put_tree(struct rad_output *f, const struct rad_octree *t, int32_t node)
{
    const int32_t *set;
    int32_t n;

    if (node == RAD_OCTREE_EMPTY) {
        put_byte(f, RAD_OCT_EMPTY);
    } else if (node < 0) {
        set = rad_octree_set(t, node, &n);
        put_byte(f, RAD_OCT_FULL);
        put_int(f, n, 4);
        for (int32_t i = 0; i < n; i++)
            put_int(f, set[i], 4);
    } else {
        put_byte(f, RAD_OCT_TREE);
        for (int i = 0; i < 8; i++)
            put_tree(f, t, t->kids[node][i]);
    }
}

static void
put_object(struct rad_output *f, const struct rad_object *o, int place)
{
    put_int(f, place, 1);
    put_int(f, o->modifier, 4);
    put_text(f, o->name, true);
    put_int(f, o->nstrings, 2);
    for (int32_t i = 0; i < o->nstrings; i++)
        put_text(f, o->strings[i], true);
    put_int(f, o->nreals, 2);
    for (int32_t i = 0; i < o->nreals; i++)
        put_real(f, o->reals[i]);
}

/* List only types that occur, so that programs that know fewer types can read
 * scenes that do not use the others. */
static void
put_objects(struct rad_output *f, const struct rad_scene *s)
{
    int place[RAD_NOTYPES], n = 0;

    for (int t = 0; t < RAD_NOTYPES; t++)
        place[t] = -1;
    for (int32_t i = 0; i < rad_scene_own(s); i++)
        place[s->objects[i].type] = 0;
    for (int t = 0; t < RAD_NOTYPES; t++)
        if (place[t] == 0) {
            place[t] = n++;
            put_text(f, rad_otype_name((enum rad_otype)t), true);
        }
    put_byte(f, '\0');
    for (int32_t i = 0; i < rad_scene_own(s) && !f->rc; i++)
        put_object(f, &s->objects[i], place[s->objects[i].type]);
    put_int(f, -1, 1);
}

static void
put_exact(struct rad_output *f, const struct rad_scene *s)
{
    put_text(f, RAD_OCT_EXACT, false);
    for (int32_t i = 0; i < rad_scene_own(s) && !f->rc; i++)
        for (int32_t k = 0; k < s->objects[i].nreals; k++) {
            double x = s->objects[i].reals[k];
            uint64_t d = rad_bits_of(x) - rad_bits_of(rad_octfile_real(x));
            uint64_t zigzag = d << 1 ^ (0 - (d >> 63));

            for (; zigzag > 0x7f; zigzag >>= 7)
                put_byte(f, 0x80 | (int)(zigzag & 0x7f));
            put_byte(f, (int)zigzag);
        }
}

int
rad_octfile_write(const struct rad_scene *s, const struct rad_octree *tree,
                  const struct rad_sink *out, struct rad_error *err)
{
    struct rad_output *f = malloc(sizeof *f);
    int rc;

    if (!f)
        return rad_fail_memory(err);
    f->out = *out;
    f->err = err;
    f->rc = 0;
    f->used = 0;
    put_start(f, s, tree);
    put_tree(f, tree, tree->root);
    put_objects(f, s);
    put_exact(f, s);
    flush(f);
    rc = f->rc;
    free(f);
    return rc;
}

double
rad_octfile_real(double x)
{
    return rad_octreal_value(rad_octreal_of(x));
}
