/* meshfile.c - see meshfile.h
 *
 * The patches' vertices are stored one patch after the other.  A vertex of
 * another patch is looked up when all patches have been read. */
#include "config.h"

#include "scene/meshfile.h"
#include "scene/octin.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define HAS_NORMALS 2
#define HAS_UV      4

/* A triangle's corner is the index of a vertex; until all patches are read it
 * is the vertex' place in the file: patch << 8 | vertex. */
struct patch {
    uint32_t first; /* index of its first vertex */
    uint32_t n;
};

struct reading {
    struct rad_octin *f;
    struct rad_mesh *mesh;
    struct patch *patches;
    int32_t npatches, max_patches;
    uint32_t max_verts, max_tris;
    int32_t nmods;     /* modifiers in the file */
    uint32_t *face_of; /* by modifier: index in faces, 0: none yet */
};

static int
out_of_memory(struct reading *r)
{
    if (!r->f->rc)
        r->f->rc = rad_fail(r->f->err, RAD_ENOMEM,
                            "out of memory for the "
                            "mesh");
    return r->f->rc;
}

/* Resize the array *p to n elements of `size` bytes. */
static int
grow(struct reading *r, void *p, size_t size, size_t n)
{
    void *old, *more;

    memcpy(&old, p, sizeof old);
    more = realloc(old, n * size);
    if (!more)
        return out_of_memory(r);
    memcpy(p, &more, sizeof more);
    return 0;
}

/* Resize an array that only some patches need: if it is not there yet, once one
 * of them comes; the vertices before it have zeros. */
static int
grow_some(struct reading *r, void *p, size_t size, size_t n, bool needed)
{
    void *old, *fresh;

    memcpy(&old, p, sizeof old);
    if (!(old ? n > r->max_verts : needed))
        return 0;
    if (grow(r, p, size, n))
        return r->f->rc;
    memcpy(&fresh, p, sizeof fresh);
    if (!old)
        memset(fresh, 0, r->mesh->nverts * size);
    return 0;
}

static int
reserve_verts(struct reading *r, uint32_t n, bool normals, bool uv)
{
    struct rad_mesh *m = r->mesh;
    bool more = n > r->max_verts - m->nverts;
    uint32_t max = more ? r->max_verts / 2 * 3 + n + 256 : r->max_verts;

    if (max > UINT32_MAX / 4) /* the limit on patches excludes this */
        return rad_octin_bad(r->f, "too many vertices");
    if ((more && grow(r, &m->xyz, sizeof *m->xyz, max)) ||
        grow_some(r, &m->normals, sizeof *m->normals, max, normals) ||
        grow_some(r, &m->uv, sizeof *m->uv, max, uv))
        return r->f->rc;
    r->max_verts = max;
    return 0;
}

/* Read a count from least to most. */
static uint32_t
get_count(struct reading *r, int least, int most, const char *what)
{
    int64_t n = rad_octin_int(r->f, 2);

    if (r->f->rc)
        return 0;
    if (n < least || n > most) {
        rad_octin_bad(r->f, "%lld %s in a patch, %d to %d are possible,",
                      (long long)n, what, least, most);
        return 0;
    }
    return (uint32_t)n;
}

static uint32_t
get_u32(struct reading *r)
{
    return (uint32_t)rad_octin_int(r->f, 4);
}

static void
get_vertices(struct reading *r)
{
    int64_t flags = rad_octin_int(r->f, 1);
    uint32_t n = get_count(r, 1, 256, "vertices");
    struct rad_mesh *m = r->mesh;
    struct patch *p = &r->patches[r->npatches];

    if (!r->f->rc && (flags < 1 || flags > 7 || !(flags & 1)))
        rad_octin_bad(r->f, "bad patch");
    if (r->f->rc || reserve_verts(r, n, flags & HAS_NORMALS, flags & HAS_UV))
        return;
    p->first = m->nverts;
    p->n = n;
    for (uint32_t i = p->first; i < p->first + n; i++)
        for (int k = 0; k < 3; k++)
            m->xyz[i][k] = (int32_t)(get_u32(r) ^ 0x80000000u);
    for (uint32_t i = p->first; i < p->first + n && m->normals; i++)
        m->normals[i] = flags & HAS_NORMALS ? get_u32(r) : 0;
    for (uint32_t i = p->first; i < p->first + n && m->uv; i++)
        for (int k = 0; k < 2; k++)
            m->uv[i][k] = flags & HAS_UV ? get_u32(r) : 0;
    m->nverts += n;
}

/* Read a modifier by the file's numbers; returns its face. */
static uint32_t
get_face(struct reading *r)
{
    int64_t mod = rad_octin_int(r->f, 2);
    struct rad_mesh *m = r->mesh;

    if (r->f->rc)
        return 0;
    if (mod < -1 || mod >= r->nmods) {
        rad_octin_bad(r->f, "triangle with a bad modifier");
        return 0;
    }
    if (mod < 0)
        return 0;
    if (r->face_of[mod] == 0) {
        r->face_of[mod] = m->nfaces;
        m->faces[m->nfaces++] = (int32_t)mod; /* add_faces() makes it an
                                               * object */
    }
    return r->face_of[mod];
}

static struct rad_mesh_tri *
new_triangle(struct reading *r)
{
    struct rad_mesh *m = r->mesh;

    if (m->ntris == r->max_tris) {
        uint32_t max = r->max_tris / 2 * 3 + 1024;

        if (m->ntris >= RAD_MAX_MESH_TRIANGLES) {
            rad_octin_bad(r->f, "more than %u triangles",
                          RAD_MAX_MESH_TRIANGLES);
            return NULL;
        }
        if (grow(r, &m->tris, sizeof *m->tris, max))
            return NULL;
        r->max_tris = max;
    }
    return &m->tris[m->ntris++];
}

static uint32_t
local_vertex(struct reading *r)
{
    return (uint32_t)r->npatches << 8 |
           ((uint32_t)rad_octin_int(r->f, 1) & 255);
}

static void
get_inner_triangles(struct reading *r)
{
    uint32_t n = get_count(r, 0, 512, "triangles"), first = r->mesh->ntris;
    int64_t nmods;
    uint32_t face;

    for (uint32_t i = 0; i < n && !r->f->rc; i++) {
        struct rad_mesh_tri *t = new_triangle(r);

        for (int k = 0; k < 3 && t; k++)
            t->v[k] = local_vertex(r);
    }
    nmods = rad_octin_int(r->f, 2);
    face = nmods > 1 ? 0 : get_face(r);
    for (uint32_t i = first; i < r->mesh->ntris && !r->f->rc; i++)
        r->mesh->tris[i].face = nmods > 1 ? get_face(r) : face;
}

/* Triangles with one or two vertices in other patches. */
static void
get_outer_triangles(struct reading *r, int elsewhere)
{
    uint32_t n = get_count(r, 0, 256, "joining triangles");

    for (uint32_t i = 0; i < n && !r->f->rc; i++) {
        struct rad_mesh_tri *t = new_triangle(r);

        for (int k = 0; k < 3 && t; k++)
            t->v[k] = k < elsewhere ? get_u32(r) : local_vertex(r);
        if (t)
            t->face = get_face(r);
    }
}

static void
get_patch(struct reading *r)
{
    if (r->npatches == r->max_patches) {
        size_t max = 2 * (size_t)r->max_patches + 64;

        if (grow(r, &r->patches, sizeof *r->patches, max))
            return;
        r->max_patches = (int32_t)max;
    }
    get_vertices(r);
    if (!r->f->rc)
        get_inner_triangles(r);
    if (!r->f->rc)
        get_outer_triangles(r, 1);
    if (!r->f->rc)
        get_outer_triangles(r, 2);
    r->npatches++;
}

/* Replace the corners' places in the file by indices of vertices. */
static void
link_corners(struct reading *r)
{
    struct rad_mesh *m = r->mesh;

    for (uint32_t i = 0; i < m->ntris; i++)
        for (int k = 0; k < 3; k++) {
            uint32_t v = m->tris[i].v[k], patch = v >> 8;

            if (patch >= (uint32_t)r->npatches ||
                (v & 255) >= r->patches[patch].n) {
                rad_octin_bad(r->f, "triangle %lu lacks a vertex",
                              (unsigned long)i);
                return;
            }
            m->tris[i].v[k] = r->patches[patch].first + (v & 255);
        }
}

static void
get_patches(struct reading *r)
{
    int64_t n = rad_octin_int(r->f, 4);

    if (!r->f->rc && (n < 0 || n > 1 << 22))
        rad_octin_bad(r->f, "bad number of patches");
    for (int64_t i = 0; i < n && !r->f->rc; i++)
        get_patch(r);
    if (!r->f->rc)
        link_corners(r);
    if (!r->f->rc && rad_octin_fill(r->f))
        rad_octin_bad(r->f, "unknown data behind the mesh");
}

/* Add an object for each modifier that triangles have. */
static void
add_faces(struct reading *r, struct rad_scene *s, int32_t file)
{
    static const double nowhere[9];
    struct rad_mesh *m = r->mesh;

    for (uint32_t i = 1; i < m->nfaces && !r->f->rc; i++) {
        struct rad_object o = { .type = RAD_POLYGON,
                                .modifier = r->f->first + m->faces[i],
                                .file = file,
                                .name = RAD_MESH_FACE,
                                .nreals = 9,
                                .reals = nowhere };
        int at = rad_scene_add(s, &o, r->f->err);

        if (at < 0)
            r->f->rc = at;
        else
            m->faces[i] = at;
    }
}

static void
get_start(struct reading *r)
{
    struct rad_octin *f = r->f;
    struct rad_mesh *m = r->mesh;
    int64_t magic;

    if (rad_octin_header(f, RAD_MESH_FORMAT))
        return;
    magic = rad_octin_int(f, 2);
    f->width = (int)(magic - RAD_MESH_MAGIC);
    if (!f->rc && (magic <= RAD_MESH_MAGIC || magic > RAD_MESH_MAGIC + 8))
        rad_octin_bad(f, "not a mesh of a version that is known");
    if (f->rc || rad_octin_cube(f, m->org, &m->size))
        return;
    for (int i = 0; i < 2; i++) {
        m->uv0[i] = rad_octin_real(f);
        m->uv1[i] = rad_octin_real(f);
    }
    rad_octin_skip_tree(f);
}

static void
get_modifiers(struct reading *r, struct rad_scene *s, int32_t file)
{
    struct rad_octin *f = r->f;

    f->first = s->nobjects;
    f->nobjects = -1;
    if (rad_octin_types(f) || rad_octin_objects(f, s, file))
        return;
    r->nmods = s->nobjects - f->first;
    for (int32_t i = f->first; i < s->nobjects; i++)
        if (rad_otype_is_surface(s->objects[i].type)) {
            rad_octin_bad(f, "a surface among the modifiers of a mesh");
            return;
        }
    r->face_of = calloc((size_t)r->nmods + 1, sizeof *r->face_of);
    r->mesh->faces = calloc((size_t)r->nmods + 1, sizeof *r->mesh->faces);
    if (!r->face_of || !r->mesh->faces) {
        out_of_memory(r);
        return;
    }
    r->mesh->faces[0] = RAD_VOID;
    r->mesh->nfaces = 1;
}

static void
read_all(struct reading *r, struct rad_scene *s, int32_t file)
{
    get_start(r);
    if (!r->f->rc)
        get_modifiers(r, s, file);
    if (!r->f->rc)
        get_patches(r);
    if (!r->f->rc)
        add_faces(r, s, file);
}

int
rad_meshfile_read(struct rad_scene *s, struct rad_part *part,
                  const struct rad_stream *in, const char *name,
                  struct rad_error *err)
{
    struct rad_error mine = { 0 };
    struct reading r = { .f = calloc(1, sizeof *r.f) };
    int rc, file = rad_scene_add_file(s, name, err);

    part->mesh = r.mesh = calloc(1, sizeof *r.mesh);
    if (!r.f || !r.mesh || file < 0) {
        free(r.f);
        return rad_fail_memory(err);
    }
    r.f->in = *in;
    r.f->err = err ? err : &mine;
    read_all(&r, s, file);
    memcpy(part->org, r.mesh->org, sizeof part->org);
    part->size = r.mesh->size;
    rc = r.f->rc;
    if (rc)
        rad_error_where(r.f->err, "%s", name);
    free(r.patches);
    free(r.face_of);
    free(r.f);
    return rc;
}

void
rad_mesh_free(struct rad_mesh *mesh)
{
    if (!mesh)
        return;
    free(mesh->xyz);
    free(mesh->normals);
    free(mesh->uv);
    free(mesh->tris);
    free(mesh->faces);
    free(mesh);
}

/* Bits 0 to 2 are the signs of x, y, z.  Two of the absolute values are stored,
 * times 11584.5 (2^13 / sqrt 2), and the third, the largest, follows from the
 * unit length.  Bits 5 to 17: the lesser of |x| and |y|, which is |x| if bit 3
 * is set.  Bits 18 to 30: the lesser of the other one and |z|, which is |z| if
 * bit 4 is set. */
void
rad_mesh_normal(double n[3], uint32_t code)
{
    double a = (code >> 5 & 0x1fff) / 11584.5;
    double b = (code >> 18 & 0x1fff) / 11584.5;
    int first = code & 8 ? 0 : 1;
    int second = code & 16 ? 2 : 1 - first;
    int third = 3 - first - second;

    n[first] = a;
    n[second] = b;
    n[third] = sqrt(fmax(0, 1 - a * a - b * b));
    for (int i = 0; i < 3; i++)
        n[i] = code >> i & 1 ? -n[i] : n[i];
}
