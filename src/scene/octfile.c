/* octfile.c - reading octree files; see octfile.h.  octwrite.c writes them. */
#include "config.h"

#include "scene/octfile.h"
#include "scene/octin.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MAX_LINE  2048
#define MAX_DEPTH 64 /* levels of a tree; Radiance's have up to 14 */

/* Read the names of scene files, and each file as text.  True: there are any,
 * and the octree holds no objects of its own. */
static bool
get_names(struct rad_octin *f, const struct rad_octfile *how)
{
    char name[RAD_OCT_NAME + 1];
    bool any = false;

    while (!rad_octin_string(f, name, sizeof name) && name[0]) {
        any = true;
        if (how->text)
            f->rc = how->text(how->arg, name, f->err);
        else
            f->rc = rad_fail(f->err, RAD_EUNSUPPORTED,
                             "octree is not frozen (it names scene file "
                             "'%.80s'): freeze it with oconv -f",
                             name);
        if (f->rc)
            break;
    }
    return any;
}

/* Read all that comes before the names of scene files. */
static int
get_start(struct rad_octin *f, struct rad_octfile *how)
{
    int64_t magic;

    if (rad_octin_header(f, RAD_OCT_FORMAT))
        return f->rc;
    magic = rad_octin_int(f, 2);
    f->width = (int)(magic - RAD_OCT_MAGIC);
    if (!f->rc && (magic <= RAD_OCT_MAGIC || magic > RAD_OCT_MAGIC + 8))
        return rad_octin_bad(f, "not an octree of a version that is known");
    return rad_octin_cube(f, how->org, &how->size);
}

/* --- trees */

static int
reserve(struct rad_octin *f, struct rad_octree *t, int32_t sets, int32_t kids)
{
    if (!rad_octree_reserve(t, sets, kids))
        f->rc = rad_fail(f->err, RAD_ENOMEM, "out of memory for the octree");
    return f->rc;
}

static int32_t
get_set(struct rad_octin *f, struct rad_octree *t)
{
    int32_t n = rad_octin_index(f, RAD_OCTREE_MAX_SET, "a set"), at = t->nsets;
    int32_t last = -1;

    if (f->rc || reserve(f, t, n + 1, 0))
        return RAD_OCTREE_EMPTY;
    t->sets[t->nsets++] = n;
    for (int32_t i = 0; i < n && !f->rc; i++) {
        int32_t obj = rad_octin_index(f, f->nobjects - 1, "an object's index");

        if (!f->rc && obj <= last)
            rad_octin_bad(f, "set is not in order");
        last = obj;
        t->sets[t->nsets++] = obj;
    }
    return -2 - at;
}

static int32_t
get_tree(struct rad_octin *f, struct rad_octree *t, int depth)
{
    int32_t node;

    switch (rad_octin_byte(f)) {
    case RAD_OCT_EMPTY:
        return RAD_OCTREE_EMPTY;
    case RAD_OCT_FULL:
        return get_set(f, t);
    case RAD_OCT_TREE:
        break;
    default:
        rad_octin_bad(f, "damaged tree");
        return RAD_OCTREE_EMPTY;
    }
    if (depth == MAX_DEPTH)
        rad_octin_bad(f, "tree of more than %d levels", MAX_DEPTH);
    if (f->rc || reserve(f, t, 0, 1))
        return RAD_OCTREE_EMPTY;
    node = t->nkids++;
    for (int i = 0; i < 8; i++) {
        /* reading a child may move t->kids, so get its number first */
        int32_t kid = f->rc ? RAD_OCTREE_EMPTY : get_tree(f, t, depth + 1);

        t->kids[node][i] = kid;
    }
    return node;
}

/* Add the differences that make the reals exact.  An object's reals are const
 * for everybody but the reader of its file. */
static int
get_exact_reals(struct rad_octin *f, struct rad_object *o)
{
    for (int32_t i = 0; i < o->nreals; i++) {
        double *x = (double *)(uintptr_t)&o->reals[i];
        uint64_t zigzag = 0;
        int c, shift = 0;

        do {
            c = rad_octin_byte(f);
            if (shift > 63 || (shift == 63 && (c & 0x7e)))
                return rad_octin_bad(f, "number of more than 64 bits");
            zigzag |= (uint64_t)(c & 0x7f) << shift;
            shift += 7;
        } while (c & 0x80);
        if (f->rc)
            return f->rc;
        *x =
            rad_double_of(rad_bits_of(*x) + (zigzag >> 1 ^ (0 - (zigzag & 1))));
        if (!isfinite(*x))
            return rad_octin_bad(f, "number is not finite");
    }
    return 0;
}

static int
get_exact(struct rad_octin *f, struct rad_scene *s)
{
    const char *magic = RAD_OCT_EXACT;

    if (!rad_octin_fill(f)) /* Radiance's files end here */
        return f->rc;
    for (; *magic; magic++)
        if (rad_octin_byte(f) != (unsigned char)*magic)
            return rad_octin_bad(f, "unknown data behind the octree");
    for (int32_t i = f->first; i < s->nobjects && !f->rc; i++)
        get_exact_reals(f, &s->objects[i]);
    if (!f->rc && rad_octin_fill(f))
        rad_octin_bad(f, "unknown data behind the octree");
    return f->rc;
}

bool
rad_octfile_is(const void *start, size_t len)
{
    const char *p = start, *end = p + len;
    char line[MAX_LINE];

    if (!rad_octin_begins(p, len))
        return false;
    while (p < end && *p != '\n') {
        const char *nl = memchr(p, '\n', (size_t)(end - p));
        size_t n = nl ? (size_t)(nl - p) : (size_t)(end - p);

        if (n < sizeof line) {
            memcpy(line, p, n);
            line[n] = '\0';
            if (n && line[n - 1] == '\r')
                line[n - 1] = '\0';
            if (rad_octin_says(line, RAD_OCT_FORMAT))
                return true;
        }
        if (!nl)
            break;
        p = nl + 1;
    }
    return false;
}

bool
rad_octfile_names(const void *start, size_t len)
{
    struct rad_memory_in from = { start, len };
    struct rad_octin *f = calloc(1, sizeof *f);
    struct rad_octfile how = { 0 };
    struct rad_error err = { 0 };
    bool names = false;

    if (!f)
        return false;
    f->in = rad_memory_stream(&from);
    f->err = &err;
    if (!get_start(f, &how))
        names = rad_octin_byte(f) != 0 && !f->rc;
    free(f);
    return names;
}

/* The octree's objects were read from other files: are there as many as when
 * the octree was made? */
static void
check_names(struct rad_octin *f, const struct rad_scene *s)
{
    int32_t n = s->nobjects - f->first;

    if (n != f->nobjects && !f->rc)
        f->rc = rad_fail(f->err, RAD_EDATA,
                         "octree of %ld objects, but its scene files have %ld: "
                         "make it again",
                         (long)f->nobjects, (long)n);
}

static void
get_rest(struct rad_octin *f, struct rad_scene *s, int32_t file,
         struct rad_octree *tree)
{
    if (tree)
        tree->root = get_tree(f, tree, 0);
    else
        rad_octin_skip_tree(f);
    if (!f->rc && !rad_octin_types(f) && !rad_octin_objects(f, s, file))
        get_exact(f, s);
}

static int
read_all(struct rad_octin *f, struct rad_scene *s, int32_t file,
         struct rad_octfile *how)
{
    bool named;

    if (get_start(f, how))
        return f->rc;
    if (how->tree) {
        memcpy(how->tree->org, how->org, sizeof how->org);
        how->tree->size = how->size;
    }
    f->first = s->nobjects;
    named = get_names(f, how);
    if (f->rc)
        return f->rc;
    f->nobjects = rad_octin_index(f, RAD_MAX_OBJECTS, "the number of objects");
    if (named)
        check_names(f, s);
    else if (!f->rc)
        get_rest(f, s, file, how->tree);
    return f->rc;
}

int
rad_octfile_read_as(struct rad_scene *s, struct rad_octfile *how,
                    const struct rad_stream *in, const char *name,
                    struct rad_error *err)
{
    struct rad_error mine = { 0 };
    struct rad_octin *f = calloc(1, sizeof *f);
    int rc, file = f ? rad_scene_add_file(s, name, err) : RAD_ENOMEM;

    if (how->tree)
        rad_octree_init(how->tree);
    if (file < 0) {
        free(f);
        return rad_fail_memory(err);
    }
    f->in = *in;
    f->err = err ? err : &mine;
    rc = read_all(f, s, file, how);
    if (rc)
        rad_error_where(f->err, "%s", name);
    if (rc && how->tree)
        rad_octree_release(how->tree);
    free(f);
    return rc;
}

int
rad_octfile_read(struct rad_scene *s, struct rad_octree *tree,
                 const struct rad_stream *in, const char *name,
                 struct rad_error *err)
{
    struct rad_octfile how = { .tree = tree };

    return rad_octfile_read_as(s, &how, in, name, err);
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
        rad_fail_memory(err);
    } else if (rad_octfile_read(s, NULL, &in, "the scene", err)) {
        rad_scene_free(s);
        s = NULL;
    }
    close(from.fd);
    return s;
}
