/* octin.c - see octin.h */
#include "config.h"

#include "scene/octin.h"
#include "scene/octree.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_HEADER (1024 * 1024)
#define MAX_LINE   2048
#define MAX_DEPTH  64 /* levels of a tree; Radiance's have up to 14 */

int
rad_octin_bad(struct rad_octin *f, const char *fmt, ...)
{
    char what[200];
    va_list ap;

    if (f->rc)
        return f->rc;
    va_start(ap, fmt);
    vsnprintf(what, sizeof what, fmt, ap);
    va_end(ap);
    f->rc = rad_fail(f->err, RAD_EDATA, "%s at byte %llu", what,
                     (unsigned long long)(f->base + f->pos));
    return f->rc;
}

bool
rad_octin_fill(struct rad_octin *f)
{
    long n;

    if (f->pos < f->len)
        return true;
    if (f->rc)
        return false;
    f->base += f->len;
    f->pos = f->len = 0;
    n = f->in.read(f->in.arg, f->buf, sizeof f->buf, f->err);
    if (n < 0)
        f->rc = (int)n;
    else
        f->len = (size_t)n;
    return n > 0;
}

static void
skip(struct rad_octin *f, uint64_t n)
{
    while (n > 0) {
        size_t some;

        if (!rad_octin_fill(f)) {
            rad_octin_bad(f, "truncated");
            return;
        }
        some = f->len - f->pos;
        if (some > n)
            some = (size_t)n;
        f->pos += some;
        n -= some;
    }
}

int
rad_octin_string(struct rad_octin *f, char *buf, size_t size)
{
    size_t n = 0;

    while (!f->rc && (buf[n] = (char)rad_octin_byte(f)) != '\0')
        if (++n == size) {
            buf[size - 1] = '\0';
            return rad_octin_bad(f, "string of more than %zu bytes", size - 1);
        }
    return f->rc;
}

int32_t
rad_octin_index(struct rad_octin *f, int32_t max, const char *what)
{
    int64_t v = rad_octin_int(f, f->width);

    if (f->rc)
        return 0;
    if (v < 0 || v > max) {
        rad_octin_bad(f, "%s is %lld, at most %ld is possible,", what,
                      (long long)v, (long)max);
        return 0;
    }
    return (int32_t)v;
}

/* Read a line of the header, without its newline; a long one is cut. */
static int
get_line(struct rad_octin *f, char *buf, size_t size)
{
    size_t n = 0;
    int c;

    while (!f->rc && (c = rad_octin_byte(f)) != '\n')
        if (n + 1 < size)
            buf[n++] = (char)c;
    buf[n] = '\0';
    if (n && buf[n - 1] == '\r')
        buf[n - 1] = '\0';
    return f->rc;
}

bool
rad_octin_says(const char *line, const char *format)
{
    const char *key = "FORMAT=";
    size_t n = strlen(format);

    if (strncmp(line, key, strlen(key)) != 0)
        return false;
    line += strlen(key);
    line += strspn(line, " \t");
    return strncmp(line, format, n) == 0 &&
           line[n + strspn(line + n, " \t")] == '\0';
}

static int
not_of(struct rad_octin *f, const char *format)
{
    f->rc = rad_fail(f->err, RAD_EDATA, "not %s",
                     strcmp(format, RAD_OCT_FORMAT) == 0 ? "an octree"
                                                         : "a compiled mesh");
    return f->rc;
}

bool
rad_octin_begins(const char *start, size_t len)
{
    return (len >= 2 && memcmp(start, "#?", 2) == 0) ||
           (len >= 6 && memcmp(start, "oconv ", 6) == 0);
}

int
rad_octin_header(struct rad_octin *f, const char *format)
{
    char line[MAX_LINE];
    bool found = false;

    if (get_line(f, line, sizeof line))
        return f->rc;
    if (!rad_octin_begins(line, strlen(line)))
        return not_of(f, format);
    do {
        if (get_line(f, line, sizeof line))
            return f->rc;
        found = found || rad_octin_says(line, format);
        if (f->base + f->pos > MAX_HEADER)
            return rad_octin_bad(f, "header does not end");
    } while (line[0]);
    return found ? 0 : not_of(f, format);
}

int
rad_octin_cube(struct rad_octin *f, double org[3], double *size)
{
    double value[4];

    for (int i = 0; i < 4; i++) {
        char text[64], *end;

        if (rad_octin_string(f, text, sizeof text))
            return f->rc;
        value[i] = strtod(text, &end);
        if (end == text || *end || !isfinite(value[i]))
            return rad_octin_bad(f, "bad cube");
    }
    if (value[3] < 0)
        return rad_octin_bad(f, "bad cube");
    memcpy(org, value, 3 * sizeof *org);
    *size = value[3];
    return 0;
}

/* --- trees */

void
rad_octin_skip_tree(struct rad_octin *f)
{
    /* how many trees are left to read at each level */
    int left[MAX_DEPTH + 1], depth = 0;

    left[0] = 1;
    while (!f->rc && depth >= 0) {
        if (left[depth] == 0) {
            depth--;
            continue;
        }
        left[depth]--;
        switch (rad_octin_byte(f)) {
        case RAD_OCT_EMPTY:
            break;
        case RAD_OCT_FULL:
            skip(f, (uint64_t)rad_octin_index(f, RAD_OCTREE_MAX_SET, "a set") *
                        (uint64_t)f->width);
            break;
        case RAD_OCT_TREE:
            if (depth == MAX_DEPTH)
                rad_octin_bad(f, "tree of more than %d levels", MAX_DEPTH);
            else
                left[++depth] = 8;
            break;
        default:
            rad_octin_bad(f, "damaged tree");
        }
    }
}

/* --- objects */

int
rad_octin_types(struct rad_octin *f)
{
    char name[RAD_MAX_WORD + 1];

    for (;;) {
        if (rad_octin_string(f, name, sizeof name) || name[0] == '\0')
            return f->rc;
        if (f->ntypes == RAD_OCTIN_TYPES)
            return rad_octin_bad(f, "more than %d types", RAD_OCTIN_TYPES);
        f->types[f->ntypes] = rad_otype_find(name);
        if (f->types[f->ntypes] < 0 && !f->unknown[0])
            snprintf(f->unknown, sizeof f->unknown, "%.31s", name);
        f->ntypes++;
    }
}

/* Buffers for one object's arguments, used for all objects in turn. */
struct workspace {
    char name[RAD_MAX_WORD + 1];
    const char *strings[RAD_MAX_ARGS];
    double reals[RAD_MAX_ARGS];
    struct rad_arena arena; /* of the strings */
};

static int
get_strings(struct rad_octin *f, struct workspace *w, struct rad_object *o)
{
    char word[RAD_MAX_WORD + 1];
    int64_t n = rad_octin_int(f, 2);

    if (f->rc)
        return f->rc;
    if (n < 0)
        return rad_octin_bad(f, "negative number of strings");
    for (int i = 0; i < n; i++) {
        if (rad_octin_string(f, word, sizeof word))
            return f->rc;
        w->strings[i] = rad_arena_strndup(&w->arena, word, strlen(word));
        if (!w->strings[i]) {
            f->rc = rad_fail_memory(f->err);
            return f->rc;
        }
    }
    o->nstrings = (int32_t)n;
    o->strings = w->strings;
    return 0;
}

static int
get_reals(struct rad_octin *f, struct workspace *w, struct rad_object *o)
{
    int64_t n = rad_octin_int(f, 2);

    if (f->rc)
        return f->rc;
    if (n < 0)
        return rad_octin_bad(f, "negative number of reals");
    for (int i = 0; i < n && !f->rc; i++)
        w->reals[i] = rad_octin_real(f);
    o->nreals = (int32_t)n;
    o->reals = w->reals;
    return f->rc;
}

/* Read the modifier of an object: a modifier that comes before it in the file,
 * or none. */
static int
get_modifier(struct rad_octin *f, const struct rad_scene *s, int32_t *modifier)
{
    int64_t m = rad_octin_int(f, f->width);

    if (f->rc)
        return f->rc;
    if (m < RAD_VOID || m >= s->nobjects - f->first ||
        (m >= 0 && rad_otype_is_surface(s->objects[f->first + m].type)))
        return rad_octin_bad(f, "object %ld has a bad modifier",
                             (long)(s->nobjects - f->first));
    *modifier = m == RAD_VOID ? RAD_VOID : f->first + (int32_t)m;
    return 0;
}

/* Read an object; *more becomes false at the end of the objects. */
static int
get_object(struct rad_octin *f, struct rad_scene *s, int32_t file,
           struct workspace *w, bool *more)
{
    struct rad_arena_mark mark = rad_arena_mark(&w->arena);
    struct rad_object o = { .file = file, .name = w->name };
    int64_t type = rad_octin_int(f, 1);
    int rc;

    *more = !f->rc && type != -1;
    if (!*more)
        return f->rc;
    if (type < 0 || type >= f->ntypes)
        return rad_octin_bad(f, "object %ld has a bad type",
                             (long)(s->nobjects - f->first));
    if (f->types[type] < 0)
        return rad_octin_bad(f, "object of unknown type '%s'", f->unknown);
    o.type = (enum rad_otype)f->types[type];
    if (get_modifier(f, s, &o.modifier) ||
        rad_octin_string(f, w->name, sizeof w->name) || get_strings(f, w, &o) ||
        get_reals(f, w, &o))
        return f->rc;
    rc = rad_scene_add(s, &o, f->err);
    rad_arena_rewind(&w->arena, mark);
    if (rc < 0)
        f->rc = rc;
    return f->rc;
}

int
rad_octin_objects(struct rad_octin *f, struct rad_scene *s, int32_t file)
{
    struct workspace *w = malloc(sizeof *w);
    bool more = true;

    if (!w) {
        f->rc = rad_fail_memory(f->err);
        return f->rc;
    }
    rad_arena_init(&w->arena);
    while (!f->rc && more)
        get_object(f, s, file, w, &more);
    rad_arena_release(&w->arena);
    free(w);
    if (!f->rc && f->nobjects >= 0 && s->nobjects - f->first != f->nobjects)
        rad_octin_bad(f, "%ld objects instead of %ld",
                      (long)(s->nobjects - f->first), (long)f->nobjects);
    return f->rc;
}
