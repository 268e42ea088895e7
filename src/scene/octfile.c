/* octfile.c - reading octree files; see octfile.h, and octwrite.c for the rest
 *
 * The input remembers its first failure, so that the code that follows the
 * format is straight and checks at its ends.  No count is believed: arrays
 * grow with what really arrives. */
#include "config.h"

#include "scene/octfile.h"
#include "scene/octreal.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MAX_HEADER (1024 * 1024)
#define MAX_LINE   2048
#define MAX_DEPTH  64  /* of a tree that we read; Radiance's go to 14 */
#define MAX_TYPES  128 /* a type's place is a signed byte */

struct input {
    struct rad_stream in;
    struct rad_error *err;
    int rc;        /* first failure */
    uint64_t base; /* offset of buf in the file */
    size_t pos, len;
    int width; /* bytes of an index */
    int32_t nobjects;
    int types[MAX_TYPES]; /* enum rad_otype, or -1: unknown */
    char unknown[32];     /* the first of those */
    int ntypes;
    unsigned char buf[64 * 1024];
};

__attribute__((format(printf, 2, 3))) static int
bad(struct input *f, const char *fmt, ...)
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

/* True if a byte is there. */
static bool
fill(struct input *f)
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

static int
get_byte(struct input *f)
{
    if (f->pos == f->len && !fill(f)) {
        bad(f, "truncated");
        return 0;
    }
    return f->buf[f->pos++];
}

/* Big-endian, two's complement, 1 to 8 bytes.  Four that are there, nearly all
 * of a file, need no look at each. */
static int64_t
get_int(struct input *f, int bytes)
{
    const unsigned char *p = f->buf + f->pos;
    uint64_t v;

    if (bytes == 4 && f->len - f->pos >= 4) {
        f->pos += 4;
        return (int32_t)((uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 |
                         (uint32_t)p[2] << 8 | p[3]);
    }
    v = (uint64_t)get_byte(f);

    if (v & 0x80)
        v |= ~UINT64_C(0xff);
    while (--bytes > 0)
        v = v << 8 | (uint64_t)get_byte(f);
    return (int64_t)v;
}

static void
skip_bytes(struct input *f, uint64_t n)
{
    while (n > 0) {
        size_t some;

        if (!fill(f)) {
            bad(f, "truncated");
            return;
        }
        some = f->len - f->pos;
        if (some > n)
            some = (size_t)n;
        f->pos += some;
        n -= some;
    }
}

/* A string into buf; 0, or the failure for one of `size` bytes or more. */
static int
get_string(struct input *f, char *buf, size_t size)
{
    size_t n = 0;

    while (!f->rc && (buf[n] = (char)get_byte(f)) != '\0')
        if (++n == size) {
            buf[size - 1] = '\0';
            return bad(f, "string of more than %zu bytes", size - 1);
        }
    return f->rc;
}

static double
get_real(struct input *f)
{
    struct rad_octreal p;

    p.mantissa = (int32_t)get_int(f, 4);
    p.exponent = (int)get_int(f, 1);
    return rad_octreal_value(p);
}

/* An index or count of 0 to max, else the failure and 0. */
static int32_t
get_index(struct input *f, int32_t max, const char *what)
{
    int64_t v = get_int(f, f->width);

    if (f->rc)
        return 0;
    if (v < 0 || v > max) {
        bad(f, "%s is %lld, at most %ld is possible,", what, (long long)v,
            (long)max);
        return 0;
    }
    return (int32_t)v;
}

/* A header's line without its newline; longer ones are cut. */
static int
get_line(struct input *f, char *buf, size_t size)
{
    size_t n = 0;
    int c;

    while (!f->rc && (c = get_byte(f)) != '\n')
        if (n + 1 < size)
            buf[n++] = (char)c;
    buf[n] = '\0';
    if (n && buf[n - 1] == '\r')
        buf[n - 1] = '\0';
    return f->rc;
}

static bool
says_octree(const char *line)
{
    const char *format = strchr(RAD_OCT_FORMAT, '=') + 1;
    size_t n = strlen(format);

    if (strncmp(line, RAD_OCT_FORMAT, (size_t)(format - RAD_OCT_FORMAT)) != 0)
        return false;
    line += format - RAD_OCT_FORMAT;
    line += strspn(line, " \t");
    return strncmp(line, format, n) == 0 &&
           line[n + strspn(line + n, " \t")] == '\0';
}

static int
get_header(struct input *f)
{
    char line[MAX_LINE];
    bool octree = false;

    if (get_line(f, line, sizeof line))
        return f->rc;
    if (strncmp(line, "#?", 2) != 0) {
        f->rc = rad_fail(f->err, RAD_EDATA, "not an octree");
        return f->rc;
    }
    do {
        if (get_line(f, line, sizeof line))
            return f->rc;
        octree = octree || says_octree(line);
        if (f->base + f->pos > MAX_HEADER)
            return bad(f, "header does not end");
    } while (line[0]);
    if (!octree)
        f->rc = rad_fail(f->err, RAD_EDATA, "not an octree");
    return f->rc;
}

/* The cube, to *tree if that is wanted. */
static int
get_cube(struct input *f, struct rad_octree *tree)
{
    double value[4];

    for (int i = 0; i < 4; i++) {
        char text[64], *end;

        if (get_string(f, text, sizeof text))
            return f->rc;
        value[i] = strtod(text, &end);
        if (end == text || *end || !isfinite(value[i]))
            return bad(f, "bad cube");
    }
    if (value[3] < 0)
        return bad(f, "bad cube");
    if (tree) {
        memcpy(tree->org, value, sizeof tree->org);
        tree->size = value[3];
    }
    return 0;
}

/* What stands before the tree. */
static int
get_start(struct input *f, struct rad_octree *tree)
{
    char name[512];
    int64_t magic;

    if (get_header(f))
        return f->rc;
    magic = get_int(f, 2);
    f->width = (int)(magic - RAD_OCT_MAGIC);
    if (!f->rc && (magic <= RAD_OCT_MAGIC || magic > RAD_OCT_MAGIC + 8))
        return bad(f, "not an octree of a version that is known");
    if (get_cube(f, tree) || get_string(f, name, sizeof name))
        return f->rc;
    if (name[0]) {
        f->rc = rad_fail(f->err, RAD_EUNSUPPORTED,
                         "octree is not frozen (it names scene file '%s'): "
                         "give the scene files instead, or freeze it with "
                         "oconv -f",
                         name);
        return f->rc;
    }
    f->nobjects = get_index(f, RAD_MAX_OBJECTS, "the number of objects");
    return f->rc;
}

/* --- trees */

static void
skip_tree(struct input *f)
{
    /* how many trees are still to come at each level */
    int left[MAX_DEPTH + 1], depth = 0;

    left[0] = 1;
    while (!f->rc && depth >= 0) {
        if (left[depth] == 0) {
            depth--;
            continue;
        }
        left[depth]--;
        switch (get_byte(f)) {
        case RAD_OCT_EMPTY:
            break;
        case RAD_OCT_FULL:
            skip_bytes(f, (uint64_t)get_index(f, RAD_OCTREE_MAX_SET, "a set") *
                              (uint64_t)f->width);
            break;
        case RAD_OCT_TREE:
            if (depth == MAX_DEPTH)
                bad(f, "tree of more than %d levels", MAX_DEPTH);
            else
                left[++depth] = 8;
            break;
        default:
            bad(f, "damaged tree");
        }
    }
}

/* Room for n more int32_t or kids. */
static int
reserve(struct input *f, struct rad_octree *t, int32_t sets, int32_t kids)
{
    if (sets > t->max_sets - t->nsets) {
        size_t max = 2 * (size_t)t->max_sets + (size_t)sets + 1024;
        int32_t *more =
            max <= INT32_MAX ? realloc(t->sets, max * sizeof *more) : NULL;

        if (!more)
            goto nomem;
        t->sets = more;
        t->max_sets = (int32_t)max;
    }
    if (kids > t->max_kids - t->nkids) {
        size_t max = 2 * (size_t)t->max_kids + 256;
        int32_t(*more)[8] =
            max <= INT32_MAX ? realloc(t->kids, max * sizeof *more) : NULL;

        if (!more)
            goto nomem;
        t->kids = more;
        t->max_kids = (int32_t)max;
    }
    return 0;
nomem:
    f->rc = rad_fail(f->err, RAD_ENOMEM, "out of memory for the octree");
    return f->rc;
}

static int32_t
get_set(struct input *f, struct rad_octree *t)
{
    int32_t n = get_index(f, RAD_OCTREE_MAX_SET, "a set"), at = t->nsets;
    int32_t last = -1;

    if (f->rc || reserve(f, t, n + 1, 0))
        return RAD_OCTREE_EMPTY;
    t->sets[t->nsets++] = n;
    for (int32_t i = 0; i < n && !f->rc; i++) {
        int32_t obj = get_index(f, f->nobjects - 1, "an object's index");

        if (!f->rc && obj <= last)
            bad(f, "set is not in order");
        last = obj;
        t->sets[t->nsets++] = obj;
    }
    return -2 - at;
}

static int32_t
get_tree(struct input *f, struct rad_octree *t, int depth)
{
    int32_t node;

    switch (get_byte(f)) {
    case RAD_OCT_EMPTY:
        return RAD_OCTREE_EMPTY;
    case RAD_OCT_FULL:
        return get_set(f, t);
    case RAD_OCT_TREE:
        break;
    default:
        bad(f, "damaged tree");
        return RAD_OCTREE_EMPTY;
    }
    if (depth == MAX_DEPTH)
        bad(f, "tree of more than %d levels", MAX_DEPTH);
    if (f->rc || reserve(f, t, 0, 1))
        return RAD_OCTREE_EMPTY;
    node = t->nkids++;
    for (int i = 0; i < 8; i++) {
        /* kids may move while one is read */
        int32_t kid = f->rc ? RAD_OCTREE_EMPTY : get_tree(f, t, depth + 1);

        t->kids[node][i] = kid;
    }
    return node;
}

/* --- objects */

static int
get_types(struct input *f)
{
    char name[RAD_MAX_WORD + 1];

    for (;;) {
        if (get_string(f, name, sizeof name) || name[0] == '\0')
            return f->rc;
        if (f->ntypes == MAX_TYPES)
            return bad(f, "more than %d types", MAX_TYPES);
        f->types[f->ntypes] = rad_otype_find(name);
        if (f->types[f->ntypes] < 0 && !f->unknown[0])
            snprintf(f->unknown, sizeof f->unknown, "%.31s", name);
        f->ntypes++;
    }
}

/* Buffers of one object's arguments, used again for the next. */
struct workspace {
    char name[RAD_MAX_WORD + 1];
    const char *strings[RAD_MAX_ARGS];
    double reals[RAD_MAX_ARGS];
    struct rad_arena arena; /* of the strings */
};

static int
get_strings(struct input *f, struct workspace *w, struct rad_object *o)
{
    char word[RAD_MAX_WORD + 1];
    int64_t n = get_int(f, 2);

    if (f->rc)
        return f->rc;
    if (n < 0)
        return bad(f, "negative number of strings");
    for (int i = 0; i < n; i++) {
        if (get_string(f, word, sizeof word))
            return f->rc;
        w->strings[i] = rad_arena_strndup(&w->arena, word, strlen(word));
        if (!w->strings[i]) {
            f->rc = rad_fail(f->err, RAD_ENOMEM, "out of memory");
            return f->rc;
        }
    }
    o->nstrings = (int32_t)n;
    o->strings = w->strings;
    return 0;
}

static int
get_reals(struct input *f, struct workspace *w, struct rad_object *o)
{
    int64_t n = get_int(f, 2);

    if (f->rc)
        return f->rc;
    if (n < 0)
        return bad(f, "negative number of reals");
    for (int i = 0; i < n && !f->rc; i++)
        w->reals[i] = get_real(f);
    o->nreals = (int32_t)n;
    o->reals = w->reals;
    return f->rc;
}

/* What an object modifies must be a modifier that came before it. */
static int
get_modifier(struct input *f, const struct rad_scene *s, int32_t *modifier)
{
    int64_t m = get_int(f, f->width);

    if (f->rc)
        return f->rc;
    if (m < RAD_VOID || m >= s->nobjects ||
        (m >= 0 && rad_otype_class(s->objects[m].type) == RAD_CLASS_SURFACE))
        return bad(f, "object %ld has a bad modifier", (long)s->nobjects);
    *modifier = (int32_t)m;
    return 0;
}

/* One object; *more is false at the end of them. */
static int
get_object(struct input *f, struct rad_scene *s, int32_t file,
           struct workspace *w, bool *more)
{
    struct rad_arena_mark mark = rad_arena_mark(&w->arena);
    struct rad_object o = { .file = file, .name = w->name };
    int64_t type = get_int(f, 1);
    int rc;

    *more = !f->rc && type != -1;
    if (!*more)
        return f->rc;
    if (type < 0 || type >= f->ntypes)
        return bad(f, "object %ld has a bad type", (long)s->nobjects);
    if (f->types[type] < 0)
        return bad(f, "object of unknown type '%s'", f->unknown);
    o.type = (enum rad_otype)f->types[type];
    if (get_modifier(f, s, &o.modifier) ||
        get_string(f, w->name, sizeof w->name) || get_strings(f, w, &o) ||
        get_reals(f, w, &o))
        return f->rc;
    rc = rad_scene_add(s, &o, f->err);
    rad_arena_rewind(&w->arena, mark);
    if (rc < 0)
        f->rc = rc;
    return f->rc;
}

static int
get_objects(struct input *f, struct rad_scene *s, int32_t file)
{
    struct workspace *w = malloc(sizeof *w);
    bool more = true;

    if (!w) {
        f->rc = rad_fail(f->err, RAD_ENOMEM, "out of memory");
        return f->rc;
    }
    rad_arena_init(&w->arena);
    while (!f->rc && more)
        get_object(f, s, file, w, &more);
    rad_arena_release(&w->arena);
    free(w);
    if (!f->rc && s->nobjects != f->nobjects)
        bad(f, "%ld objects instead of %ld", (long)s->nobjects,
            (long)f->nobjects);
    return f->rc;
}

/* The differences that make the reals exact; the type of a real's place in
 * the scene is const for all but who builds it. */
static int
get_exact_reals(struct input *f, struct rad_object *o)
{
    for (int32_t i = 0; i < o->nreals; i++) {
        double *x = (double *)(uintptr_t)&o->reals[i];
        uint64_t zigzag = 0;
        int c, shift = 0;

        do {
            c = get_byte(f);
            if (shift > 63 || (shift == 63 && (c & 0x7e)))
                return bad(f, "number of more than 64 bits");
            zigzag |= (uint64_t)(c & 0x7f) << shift;
            shift += 7;
        } while (c & 0x80);
        if (f->rc)
            return f->rc;
        *x =
            rad_double_of(rad_bits_of(*x) + (zigzag >> 1 ^ (0 - (zigzag & 1))));
        if (!isfinite(*x))
            return bad(f, "number is not finite");
    }
    return 0;
}

static int
get_exact(struct input *f, struct rad_scene *s)
{
    const char *magic = RAD_OCT_EXACT;

    if (!fill(f)) /* the file ends as Radiance's do */
        return f->rc;
    for (; *magic; magic++)
        if (get_byte(f) != (unsigned char)*magic)
            return bad(f, "unknown data behind the octree");
    for (int32_t i = 0; i < s->nobjects && !f->rc; i++)
        get_exact_reals(f, &s->objects[i]);
    if (!f->rc && fill(f))
        bad(f, "unknown data behind the octree");
    return f->rc;
}

bool
rad_octfile_is(const void *start, size_t len)
{
    const char *p = start, *end = p + len;
    char line[MAX_LINE];

    if (len < 2 || memcmp(p, "#?", 2) != 0)
        return false;
    while (p < end && *p != '\n') {
        const char *nl = memchr(p, '\n', (size_t)(end - p));
        size_t n = nl ? (size_t)(nl - p) : (size_t)(end - p);

        if (n < sizeof line) {
            memcpy(line, p, n);
            line[n] = '\0';
            if (n && line[n - 1] == '\r')
                line[n - 1] = '\0';
            if (says_octree(line))
                return true;
        }
        if (!nl)
            break;
        p = nl + 1;
    }
    return false;
}

int
rad_octfile_read(struct rad_scene *s, struct rad_octree *tree,
                 const struct rad_stream *in, const char *name,
                 struct rad_error *err)
{
    struct rad_error mine = { 0 };
    struct input *f = calloc(1, sizeof *f);
    int rc, file = f ? rad_scene_add_file(s, name, err) : RAD_ENOMEM;

    if (tree)
        rad_octree_init(tree);
    if (file < 0) {
        free(f);
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    }
    f->in = *in;
    f->err = err ? err : &mine;
    if (!get_start(f, tree)) {
        if (tree)
            tree->root = get_tree(f, tree, 0);
        else
            skip_tree(f);
    }
    if (!f->rc && !get_types(f) && !get_objects(f, s, file))
        get_exact(f, s);
    rc = f->rc;
    if (rc)
        rad_error_where(f->err, "%s", name);
    if (rc && tree)
        rad_octree_release(tree);
    free(f);
    return rc;
}

struct rad_scene *
rad_octfile_load(const char *path, struct rad_error *err)
{
    struct rad_fd from = { open(path, O_RDONLY | O_CLOEXEC), path };
    struct rad_stream in = rad_fd_stream(&from);
    struct rad_scene *s;

    if (from.fd < 0) {
        rad_fail(err, RAD_ENOINPUT, "cannot open '%s': %s", path,
                 strerror(errno));
        return NULL;
    }
    s = rad_scene_new();
    if (!s) {
        rad_fail(err, RAD_ENOMEM, "out of memory");
    } else if (rad_octfile_read(s, NULL, &in, path, err)) {
        rad_scene_free(s);
        s = NULL;
    }
    close(from.fd);
    return s;
}
