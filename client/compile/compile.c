/* compile.c - see compile.h */
#include "config.h"

#include "compile/compile.h"

#include "compile/reading.h"
#include "scene/octfile.h"
#include "scene/part.h"
#include "trace/job.h"
#include "compile/warning.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* --- octrees of instances that are not frozen --- */

struct frozen {
    struct frozen *next;
    char *name;
    struct rad_memory_out file;
};

/* Freeze the octree in bytes[len], of which c's scene has an instance. */
static int
freeze(struct compiled *c, const char *name, const void *bytes, size_t len,
       struct rad_memory_out *file, struct rad_error *err)
{
    struct compiled in = { .paths = c->paths,
                           .commands = c->commands,
                           .depth = c->depth + 1 };
    struct reading r = { .c = &in, .within = true };
    struct rad_memory_in from = { bytes, len };
    struct rad_stream stream = rad_memory_stream(&from);
    struct rad_octfile how = { .text = reading_named, .arg = &r };
    struct rad_files files = compile_files(c);
    struct rad_sink out = rad_memory_sink(file);
    char *path = paths_find(&c->paths, name, err);
    char *folder = path ? paths_folder_of(path) : NULL;
    int rc;

    rad_octree_init(&in.octree);
    in.scene = rad_scene_new();
    r.folder = folder;
    c->depth++;
    if (c->depth > RAD_MAX_PART_DEPTH)
        rc = rad_fail(err, RAD_EDATA,
                      "instances are nested more than %d files deep",
                      RAD_MAX_PART_DEPTH);
    else if (!folder || !in.scene)
        rc = rad_fail_memory(err);
    else
        rc = rad_octfile_read_as(in.scene, &how, &stream, name, err);
    c->paths = in.paths; /* reading may have added folders */
    if (!rc)
        rc = rad_scene_include(in.scene, &files, NULL, NULL, err);
    if (!rc)
        rc = rad_octree_build(&in.octree, in.scene, RAD_OCTREE_MAX_SET, err);
    if (!rc)
        rc = rad_octfile_write(in.scene, &in.octree, &out, err);
    c->depth--;
    rad_octree_release(&in.octree);
    rad_scene_free(in.scene);
    free(in.warnings);
    free(folder);
    free(path);
    return rc;
}

static const struct frozen *
find_frozen(const struct compiled *c, const char *name)
{
    const struct frozen *f = c->frozen;

    while (f && strcmp(f->name, name) != 0)
        f = f->next;
    return f;
}

static const struct frozen *
add_frozen(struct compiled *c, const char *name, const void *bytes, size_t len,
           struct rad_error *err)
{
    struct frozen *f = calloc(1, sizeof *f);

    if (f)
        f->name = strdup(name);
    if (!f || !f->name)
        rad_fail_memory(err);
    if (f && (!f->name || freeze(c, name, bytes, len, &f->file, err))) {
        free(f->name);
        free(f->file.bytes);
        free(f);
        return NULL;
    }
    if (f) {
        f->next = c->frozen;
        c->frozen = f;
    }
    return f;
}

static void
release_frozen(struct compiled *c)
{
    while (c->frozen) {
        struct frozen *f = c->frozen;

        c->frozen = f->next;
        free(f->name);
        free(f->file.bytes);
        free(f);
    }
}

static unsigned char *
copy_frozen(const struct frozen *f, size_t *len, struct rad_error *err)
{
    unsigned char *copy = f ? malloc(f->file.len + 1) : NULL;

    if (!f)
        return NULL;
    if (!copy) {
        rad_fail_memory(err);
        return NULL;
    }
    memcpy(copy, f->file.bytes, f->file.len);
    copy[f->file.len] = '\0';
    *len = f->file.len;
    return copy;
}

static unsigned char *
read_needed(void *arg, const char *name, size_t *len, struct rad_error *err)
{
    struct compiled *c = arg;
    struct rad_files files = paths_files(&c->paths);
    const struct frozen *f = find_frozen(c, name);
    unsigned char *bytes, *copy;

    if (f)
        return copy_frozen(f, len, err);
    bytes = files.read(files.arg, name, len, err);
    if (!bytes || !rad_octfile_names(bytes, *len))
        return bytes;
    copy = copy_frozen(add_frozen(c, name, bytes, *len, err), len, err);
    free(bytes);
    return copy;
}

static int
open_needed(void *arg, const char *name, struct rad_error *err)
{
    struct compiled *c = arg;
    struct rad_files files = paths_files(&c->paths);

    return files.open(files.arg, name, err);
}

struct rad_files
compile_files(struct compiled *c)
{
    struct rad_files files = { read_needed, c, open_needed };

    return files;
}

/* --- files that the scene needs --- */

/* Report that a file of object i failed, as `why` says: if no surface uses the
 * object, as a warning.  Returns the code of a failure, or 0. */
static int
file_failed(const struct compiled *c, const struct reading *r, int32_t i,
            bool used, const struct rad_error *why, struct rad_error *err)
{
    struct rad_error now = { 0 };

    rad_scene_fail(c->scene, &c->scene->objects[i], &now,
                   used ? why->code : RAD_WARNING, "%s%s", why->what,
                   used ? "" : "; no surface uses it");
    if (r->each)
        r->each(r->arg, &now);
    if (used && err && err->code == 0)
        *err = now;
    return used ? now.code : 0;
}

/* Call `visit` for each file name of each object that a surface uses; the first
 * failure is returned.  If all errors are wanted (r->each) the visit goes on
 * after a failure, and missing files of unused objects are warned of. */
static int
visit_files(struct compiled *c, const struct reading *r,
            int (*visit)(struct compiled *c, const char *name, const char *dir,
                         struct rad_error *err),
            const char *dir, struct rad_error *err)
{
    const struct rad_scene *s = c->scene;
    uint8_t *reached = malloc((size_t)s->nobjects + 1);
    const char *name, *last = ""; /* found last: faces of a mesh name the same
                                   */
    int first = 0;

    if (!reached)
        return rad_fail_memory(err);
    rad_scene_reach(s, reached);
    for (int32_t i = 0; i < s->nobjects && (r->each || !first); i++)
        for (int k = 0; (reached[i] || r->each) &&
                        (name = rad_object_file(&s->objects[i], k));
             k++) {
            struct rad_error why = { 0 };
            int rc = 0;

            if (strcmp(name, last) == 0 || visit(c, name, dir, &why) == 0)
                last = name;
            else
                rc = file_failed(c, r, i, reached[i], &why, err);
            first = first ? first : rc;
        }
    free(reached);
    return first;
}

static int
find_file(struct compiled *c, const char *name, const char *dir,
          struct rad_error *err)
{
    char *path = paths_find(&c->paths, name, err);

    (void)dir;
    free(path);
    return path ? 0 : err->code;
}

/* --- the bundle --- */

/* A file of the bundle that is being written; its hash will be its name. */
struct storing {
    struct compiled *c;
    const char *dir;
    struct rad_fd to;
    struct rad_sha sha;
    uint64_t size;
    char path[4096]; /* its name until then */
};

static int
store_begin(struct storing *f, struct compiled *c, const char *dir,
            struct rad_error *err)
{
    int rc;

    f->c = c;
    f->dir = dir;
    if ((size_t)snprintf(f->path, sizeof f->path, "%s/new", dir) >=
        sizeof f->path - RAD_SHA_HEX)
        return rad_fail(err, RAD_ECANTCREAT, "path '%s' is too long", dir);
    rc = rad_sha_init(&f->sha, err);
    if (rc)
        return rc;
    f->size = 0;
    f->to.name = f->path;
    f->to.fd = open(f->path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (f->to.fd >= 0)
        return 0;
    rad_sha_release(&f->sha);
    return rad_fail(err, RAD_ECANTCREAT, "cannot create '%s': %s", f->path,
                    strerror(errno));
}

static int
store_bytes(void *arg, const void *p, size_t n, struct rad_error *err)
{
    struct storing *f = arg;
    struct rad_sink out = rad_fd_sink(&f->to);

    rad_sha_update(&f->sha, p, n);
    f->size += n;
    return out.write(out.arg, p, n, err);
}

/* Give the file its name and enter it into the bundle; if rc is an error,
 * remove it. */
static int
store_end(struct storing *f, int rc, enum rad_bundle_role role,
          const char *name, struct rad_error *err)
{
    char hash[RAD_SHA_HEX + 1], path[sizeof f->path + RAD_SHA_HEX];

    if (rc)
        rad_sha_release(&f->sha);
    else
        rc = rad_sha_final(&f->sha, hash, err);
    if (close(f->to.fd) && !rc)
        rc = rad_fail(err, RAD_EIO, "cannot write '%s': %s", f->path,
                      strerror(errno));
    if (!rc) {
        snprintf(path, sizeof path, "%s/%s", f->dir, hash);
        if (rename(f->path, path))
            rc = rad_fail(err, RAD_ECANTCREAT, "cannot create '%s': %s", path,
                          strerror(errno));
    }
    if (rc)
        unlink(f->path);
    return rc ? rc
              : rad_bundle_add(&f->c->bundle, role, name, hash, f->size, err);
}

static int
bundle_octree(struct compiled *c, const char *dir, struct rad_error *err)
{
    struct storing f;
    struct rad_sink out = { store_bytes, &f };
    int rc = store_begin(&f, c, dir, err);

    if (rc)
        return rc;
    rc = rad_octfile_write(c->scene, &c->octree, &out, err);
    return store_end(&f, rc, RAD_BUNDLE_SCENE, NULL, err);
}

/* Add the file of an instance or a mesh, frozen if it is an octree. */
static int
bundle_part(struct compiled *c, const char *name, const char *dir,
            struct rad_error *err)
{
    struct rad_files files = compile_files(c);
    size_t len;
    unsigned char *bytes = files.read(files.arg, name, &len, err);
    int rc = bytes ? compile_add(c, name, bytes, len, dir, err) : err->code;

    free(bytes);
    return rc;
}

static int
store_stream(struct storing *f, const struct rad_stream *in,
             struct rad_error *err)
{
    unsigned char piece[16 * 1024];
    long n;

    while ((n = in->read(in->arg, piece, sizeof piece, err)) > 0) {
        int rc = store_bytes(f, piece, (size_t)n, err);

        if (rc)
            return rc;
    }
    return (int)n;
}

/* Add a file that an object names, unless it is there. */
static int
bundle_file(struct compiled *c, const char *name, const char *dir,
            struct rad_error *err)
{
    struct rad_files files = compile_files(c);
    struct rad_opened file;
    struct storing f;
    int rc;

    if (rad_bundle_find(&c->bundle, RAD_BUNDLE_FILE, name))
        return 0;
    if (rad_files_open(&files, name, &file, err) < 0)
        return err->code;
    rc = store_begin(&f, c, dir, err);
    if (!rc) {
        rc = store_stream(&f, &file.in, err);
        rc = store_end(&f, rc, RAD_BUNDLE_FILE, name, err);
    }
    rad_opened_close(&file);
    return rc;
}

/* --- the whole --- */

/* Read the scene without the files of its instances and meshes.  After a
 * failure c has what was read, and must be released. */
static int
read_scene(struct reading *r, const struct compile_from *from,
           struct rad_error *err)
{
    struct compiled *c = r->c;
    bool alone = from->n == 1;
    int rc;

    memset(c, 0, sizeof *c);
    c->commands = from->commands;
    rad_octree_init(&c->octree);
    rad_bundle_init(&c->bundle);
    c->scene = rad_scene_new();
    rc = c->scene ? paths_init(&c->paths, err) : rad_fail_memory(err);
    c->paths.inputs = r->inputs;
    for (int i = 0; c->paths.raypath && i < from->n && (r->each || !rc); i++) {
        const char *name = from->files[i];
        int now = name[0] == '!' ? reading_command(r, name, alone, err)
                                 : reading_file(r, name, alone, err);

        rc = rc ? rc : now;
    }
    return rc;
}

static int
include_parts(struct compiled *c,
              void (*each)(void *arg, const struct rad_error *err), void *arg,
              struct rad_error *err)
{
    struct rad_files files = compile_files(c);

    return rad_scene_include(c->scene, &files, each, arg, err);
}

int
compile_parse(struct compiled *c, const struct compile_from *from,
              struct rad_error *err)
{
    struct reading r = { .c = c };
    int rc = read_scene(&r, from, err);

    if (!rc)
        rc = include_parts(c, NULL, NULL, err);
    if (rc)
        compile_release(c);
    return rc;
}

/* Report what rad_scene_check() finds: a warning, or an error if all are
 * wanted. */
static void
judge(void *arg, const struct rad_error *err)
{
    const struct reading *r = arg;

    if (r->each || err->code == RAD_WARNING)
        reading_warn(arg, err);
}

static int
read_and_check(struct reading *r, const struct compile_from *from,
               struct rad_error *err)
{
    struct compiled *c = r->c;
    int now, rc = read_scene(r, from, err);

    if (rc && (!r->each || r->octree || !c->paths.raypath)) {
        compile_release(c);
        return rc;
    }
    /* look for errors in what was read, too */
    now = include_parts(c, r->each, r->arg, err);
    rc = rc ? rc : now;
    if (!rc || r->each) {
        now = rad_scene_check(c->scene, judge, r, err);
        rc = rc ? rc : now;
    }
    if (!rc || r->each) {
        now = visit_files(c, r, find_file, NULL, err);
        rc = rc ? rc : now;
    }
    if (rc)
        compile_release(c);
    return rc;
}

int
compile_read(struct compiled *c, const struct compile_from *from,
             void (*each)(void *arg, const struct rad_error *err), void *arg,
             struct rad_error *err)
{
    struct reading r = { .c = c, .each = each, .arg = arg };

    return read_and_check(&r, from, err);
}

int
compile_octree(struct compiled *c, int leaf, struct rad_error *err)
{
    return rad_octree_build(&c->octree, c->scene, leaf, err);
}

/* Write the bundle of a scene that has an octree. */
static int
make_bundle(struct compiled *c, const char *dir, struct rad_error *err)
{
    struct reading r = { 0 };
    int rc = bundle_octree(c, dir, err);

    for (int32_t i = 0; i < c->scene->nparts && !rc; i++)
        rc = bundle_part(c, c->scene->parts[i]->name, dir, err);
    return rc ? rc : visit_files(c, &r, bundle_file, dir, err);
}

int
compile_check(struct compiled *c, struct rad_error *err)
{
    struct rad_files files = compile_files(c);

    return rad_job_check(c->scene, &files, err);
}

int
compile_add(struct compiled *c, const char *name, const void *bytes, size_t len,
            const char *dir, struct rad_error *err)
{
    struct storing f;
    int rc = store_begin(&f, c, dir, err);

    if (rc)
        return rc;
    rc = store_bytes(&f, bytes, len, err);
    return store_end(&f, rc, RAD_BUNDLE_FILE, name, err);
}

void
compile_drop(struct compiled *c, const char *name, const char *dir)
{
    const struct rad_bundle_entry *e =
        rad_bundle_find(&c->bundle, RAD_BUNDLE_FILE, name);
    char *path = NULL;

    if (e && asprintf(&path, "%s/%s", dir, e->hash) >= 0) {
        unlink(path);
        free(path);
    }
    rad_bundle_remove(&c->bundle, RAD_BUNDLE_FILE, name);
}

int
compile_name(const struct compiled *c, char hex[RAD_SHA_HEX + 1],
             struct rad_error *err)
{
    size_t len;
    char *text = rad_bundle_format(&c->bundle, &len);
    int rc;

    if (!text)
        return rad_fail_memory(err);
    rc = rad_sha_hex(text, len, hex, err);
    free(text);
    return rc;
}

int
compile_digest(struct compiled *c, char hex[RAD_SHA_HEX + 1],
               struct rad_error *err)
{
    const char *tmp = getenv("TMPDIR");
    char dir[512], path[sizeof dir + RAD_SHA_HEX + 2];
    int n = snprintf(dir, sizeof dir, "%s/radscene-XXXXXX",
                     tmp && *tmp ? tmp : "/tmp"),
        rc;

    if (n < 0 || (size_t)n >= sizeof dir || !mkdtemp(dir))
        return rad_fail(err, RAD_ECANTCREAT, "cannot make a folder in '%s': %s",
                        tmp && *tmp ? tmp : "/tmp", strerror(errno));
    rc = compile_octree(c, RAD_OCTREE_MAX_SET, err);
    if (!rc)
        rc = make_bundle(c, dir, err);
    if (!rc)
        rc = compile_name(c, hex, err);
    for (int i = 0; i < c->bundle.n; i++) {
        snprintf(path, sizeof path, "%s/%s", dir, c->bundle.entries[i].hash);
        unlink(path);
    }
    rmdir(dir);
    return rc;
}

int
compile_scene(struct compiled *c, const struct compile_from *from,
              const char *dir, struct inputs *inputs, struct rad_error *err)
{
    struct reading r = { .c = c, .inputs = inputs };
    int rc = read_and_check(&r, from, err);

    if (rc)
        return rc;
    rc = compile_check(c, err);
    if (!rc)
        rc = compile_octree(c, RAD_OCTREE_MAX_SET, err);
    if (!rc)
        rc = make_bundle(c, dir, err);
    if (rc)
        compile_release(c);
    return rc;
}

void
compile_release(struct compiled *c)
{
    rad_scene_free(c->scene);
    c->scene = NULL;
    release_frozen(c);
    free(c->warnings);
    c->warnings = NULL;
    paths_release(&c->paths);
    rad_octree_release(&c->octree);
    rad_bundle_release(&c->bundle);
}
