/* text.c - see text.h
 *
 * Text is in a plane.  The anchor is its upper left corner; one vector is the
 * width of a character to the right, the other the height of a line down.  Both
 * become covectors, so that a point's column and line are two dot products.  A
 * point off the plane is projected onto it along the normal. */
#include "config.h"

#include "pattern/text.h"
#include "base/vec.h"
#include "base/xform.h"
#include "scene/file/font.h"
#include "scene/octfile.h"
#include "pattern/mixture.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

#define CELL      255.0
#define MAX_LINES 1000000

struct text {
    double anchor[3], right[3], down[3]; /* covectors: right in columns, down
                                          * in lines */
    double column;                       /* width of a column in font units */
    const struct rad_font *font;
    struct rad_textline *line;
    int32_t nlines;
    int spacing;
    struct rad_rgb fore, back;
    int32_t part[2]; /* of mixtext, instead of colours */
};

/* The string that names the font; the text follows it. */
static int
font_at(const struct rad_object *o)
{
    return o->type == RAD_MIXTEXT ? 2 : 0;
}

/* Set right and down: the part of R across D and the part of D across R, scaled
 * so that right.R = down.D = 1. */
static int
set_plane(const struct rad_job *job, const struct rad_object *o, struct text *t,
          struct rad_error *err)
{
    const double *R = o->reals + 3, *D = o->reals + 6;
    double n[3], r2, d2;

    rad_copy(t->anchor, o->reals);
    rad_cross(n, D, R);
    rad_cross(t->right, n, D);
    rad_cross(t->down, R, n);
    r2 = rad_dot(t->right, R);
    d2 = rad_dot(t->down, D);
    if (!(r2 > 0 && d2 > 0 && r2 < INFINITY && d2 < INFINITY))
        return rad_scene_fail(job->scene, o, err, RAD_EDATA,
                              "right and down must span a plane");
    rad_scale(t->right, 1 / r2, t->right);
    rad_scale(t->down, 1 / d2, t->down);
    return 0;
}

/* The font called `name`, if an earlier text uses it; else NULL. */
static const struct rad_font *
find_font(const struct rad_job *job, int32_t index, const char *name)
{
    const struct rad_object *objects = job->scene->objects;

    for (int32_t i = 0; i < index; i++) {
        const struct rad_object *o = &objects[i];
        const struct text *t = job->materials[i].data;

        if ((o->type == RAD_BRIGHTTEXT || o->type == RAD_COLORTEXT ||
             o->type == RAD_MIXTEXT) &&
            t && strcmp(o->strings[font_at(o)], name) == 0)
            return t->font;
    }
    return NULL;
}

static int
load_font(struct rad_job *job, int32_t index, const struct rad_files *files,
          struct text *t, struct rad_error *err)
{
    const struct rad_object *o = &job->scene->objects[index];
    const char *name = o->strings[font_at(o)];
    struct rad_error why = { 0 };
    size_t len;
    char *data;
    int code;

    t->font = find_font(job, index, name);
    if (t->font)
        return 0;
    code = rad_material_file(job, o, files, name, &data, &len, err);
    if (code < 0)
        return code;
    t->font = rad_font_parse(&job->arena, data, len, &why);
    free(data);
    return t->font ? 0 : rad_material_file_fail(job, o, name, &why, err);
}

static int
set_lines(struct rad_job *job, struct text *t, const char *s, size_t len,
          struct rad_error *err)
{
    const char *end = s + len, *eol;
    size_t n = 1;

    for (const char *p = s; p < end; p++)
        n += *p == '\n';
    if (n > MAX_LINES)
        return rad_fail(err, RAD_EDATA, "more than %d lines of text",
                        MAX_LINES);
    t->line = rad_arena_calloc(&job->arena, n, sizeof *t->line);
    if (!t->line)
        return rad_fail_memory(err);
    while (s < end) {
        int code;

        eol = memchr(s, '\n', (size_t)(end - s));
        code =
            rad_textline_set(&t->line[t->nlines++], t->font, &job->arena, s,
                             (size_t)((eol ? eol : end) - s), t->spacing, err);
        if (code < 0)
            return code;
        s = eol ? eol + 1 : end;
    }
    return 0;
}

/* Set the words from string `first` on, as one line: a newline in a
 * quoted word begins no other. */
static int
set_words(struct rad_job *job, const struct rad_object *o, int first,
          struct text *t, struct rad_error *err)
{
    struct rad_error why = { 0 };
    size_t len = 0;
    char *buf, *p;
    int code;

    for (int32_t i = first; i < o->nstrings; i++)
        len += strlen(o->strings[i]) + 1;
    p = buf = malloc(len + 1);
    if (!buf)
        return rad_fail_memory(err);
    for (int32_t i = first; i < o->nstrings; i++) {
        size_t n = strlen(o->strings[i]);

        memcpy(p, o->strings[i], n);
        p += n;
        *p++ = ' ';
    }
    t->line = rad_arena_calloc(&job->arena, 1, sizeof *t->line);
    t->nlines = 1;
    code = t->line ? rad_textline_set(t->line, t->font, &job->arena, buf,
                                      len ? len - 1 : 0, t->spacing, &why)
                   : rad_fail_memory(&why);
    free(buf);
    return code < 0 ? rad_material_file_fail(job, o, "text", &why, err) : 0;
}

static int
set_text(struct rad_job *job, const struct rad_object *o,
         const struct rad_files *files, struct text *t, struct rad_error *err)
{
    struct rad_error why = { 0 };
    int at = font_at(o) + 1, code;
    size_t len;
    char *data;

    if (!rad_object_file(o, 1))
        return set_words(job, o, at + 1, t, err);
    code = rad_material_file(job, o, files, o->strings[at], &data, &len, err);
    if (code < 0)
        return code;
    code = set_lines(job, t, data, len, &why);
    free(data);
    return code < 0 ? rad_material_file_fail(job, o, o->strings[at], &why, err)
                    : 0;
}

static void
set_colors(const struct rad_job *job, const struct rad_object *o,
           struct text *t)
{
    const double *v = o->reals + 9;

    if (o->type == RAD_MIXTEXT)
        return;
    if (o->type == RAD_BRIGHTTEXT) {
        t->fore = rad_grey((float)v[0]);
        t->back = rad_grey((float)v[1]);
    } else {
        t->fore = rad_job_colour(job, v);
        t->back = rad_job_colour(job, v + 3);
    }
}

int
rad_text_prepare(struct rad_job *job, int32_t index,
                 const struct rad_files *files, const void **data,
                 struct rad_error *err)
{
    const struct rad_object *o = &job->scene->objects[index];
    int n = o->type == RAD_BRIGHTTEXT ? 11 : o->type == RAD_COLORTEXT ? 15 : 9;
    int code = rad_material_reals(job, index, n, INT_MAX, err);
    double spacing = 0;
    struct text *t;

    if (code < 0)
        return code;
    if (o->nstrings < font_at(o) + 2)
        return rad_scene_fail(job->scene, o, err, RAD_EDATA,
                              "expected a font and a text");
    t = rad_arena_calloc(&job->arena, 1, sizeof *t);
    if (!t)
        return rad_fail_memory(err);
    if (o->nreals > n)
        spacing = o->reals[n];
    if (!(fabs(spacing) <= 30)) /* in letters; keeps widths in range */
        return rad_scene_fail(job->scene, o, err, RAD_EDATA,
                              "spacing out of range");
    /* a spacing of .2 should be 51 units, but is 50 in all pictures of frozen
     * octrees, which store slightly less than .2 */
    t->spacing = (int)(CELL * rad_octfile_real(spacing));
    set_colors(job, o, t);
    code = set_plane(job, o, t, err);
    if (code == 0)
        code = load_font(job, index, files, t, err);
    if (code == 0)
        code = set_text(job, o, files, t, err);
    if (code == 0 && o->type == RAD_MIXTEXT)
        code = rad_mixture_parts(job, index, t->part, err);
    if (code < 0)
        return code;
    t->column =
        o->nreals > n ? t->font->mean_width + CELL * fabs(spacing) : CELL;
    *data = t;
    return 0;
}

/* Is there a letter at the hit?  In an instance or mesh the text is placed in
 * the coordinates of its file. */
static bool
is_foreground(const struct text *t, const struct rad_ray *r)
{
    struct rad_xform move;
    double v[3], x, y;
    int32_t line;

    rad_copy(v, r->hit.p);
    if (rad_geom_place(&r->hit, &move)) {
        rad_xform_invert(&move, &move);
        rad_xform_point(v, &move, v);
    }
    rad_sub(v, v, t->anchor);
    x = rad_dot(v, t->right) * t->column;
    y = rad_dot(v, t->down);
    if (!(x >= 0 && y >= 0 && y < t->nlines))
        return false;
    line = (int32_t)y;
    return rad_textline_inside(&t->line[line], x, (line + 1 - y) * CELL);
}

bool
rad_text_shade(struct rad_ctx *ctx, const struct rad_material *mat,
               struct rad_ray *r)
{
    const struct text *t = mat->data;

    (void)ctx;
    r->pattern =
        rad_rgb_mul(r->pattern, is_foreground(t, r) ? t->fore : t->back);
    return false;
}

/* Shade letters with the first modifier, the space around them with the
 * second. */
bool
rad_text_mix(struct rad_ctx *ctx, const struct rad_material *mat,
             struct rad_ray *r)
{
    const struct text *t = mat->data;

    return rad_ray_shade(ctx, r, t->part[!is_foreground(t, r)]);
}
