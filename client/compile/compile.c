/* compile.c - see compile.h */
#include "config.h"

#include "compile/compile.h"

#include "compile/command.h"
#include "scene/octfile.h"
#include "scene/file/parse.h"
#include "scene/part.h"
#include "trace/job.h"
#include "compile/warning.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define STDIN_NAME "standard input"

/* --- reading ----------------------------------------------------------------
 */

/* One file being read: what was read to see what it is, then the rest. */
struct source {
    struct rad_fd fd;
    char *folder;
    size_t pos, len;
    unsigned char head[16 * 1024];
};

static long
read_source(void *arg, void *buf, size_t n, struct rad_error *err)
{
    struct source *src = arg;
    struct rad_stream rest = rad_fd_stream(&src->fd);

    if (src->pos == src->len)
        return rest.read(rest.arg, buf, n, err);
    if (n > src->len - src->pos)
        n = src->len - src->pos;
    memcpy(buf, src->head + src->pos, n);
    src->pos += n;
    return (long)n;
}

/* Open and read the beginning. */
static int
open_source(struct source *src, const char *file, struct rad_error *err)
{
    struct rad_stream in = rad_fd_stream(&src->fd);
    bool standard = strcmp(file, "-") == 0;

    src->pos = src->len = 0;
    src->folder = NULL;
    src->fd.name = standard ? STDIN_NAME : file;
    src->fd.fd = standard ? STDIN_FILENO : open(file, O_RDONLY | O_CLOEXEC);
    if (src->fd.fd < 0)
        return rad_fail(err, RAD_ENOINPUT, "cannot open '%s': %s", file,
                        strerror(errno));
    src->folder = standard ? strdup(".") : paths_folder_of(file);
    if (!src->folder)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    while (src->len < sizeof src->head) {
        long n = in.read(in.arg, src->head + src->len,
                         sizeof src->head - src->len, err);

        if (n <= 0)
            return (int)n;
        src->len += (size_t)n;
    }
    return 0;
}

static void
close_source(struct source *src)
{
    if (src->fd.fd > STDIN_FILENO)
        close(src->fd.fd);
    free(src->folder);
}

static bool
has_suffix(const char *name, const char *suffix)
{
    size_t n = strlen(name), m = strlen(suffix);

    return n > m && strcmp(name + n - m, suffix) == 0;
}

struct reading {
    struct compiled *c;
    const char *folder; /* of the file that is being read */
    bool told;          /* what ended the reading */
    bool octree;        /* a file is one: after a failure it is in pieces */
    bool within;        /* what an octree names is being read */
    bool beside;        /* it is in the octree's folder */
    void (*each)(void *arg, const struct rad_error *err);
    void *arg;
};

/* The user can read which commands a scene's text would run; those of an octree
 * nobody sees. */
static int
refuse_command(const char *text, struct rad_error *err)
{
    return rad_fail(err, RAD_EPERM,
                    "command '%.60s' of an octree is not run: use --commands "
                    "if you trust it",
                    text);
}

static int
begin_command(void *arg, const char *text, struct rad_stream *out, void **job,
              struct rad_error *err)
{
    const struct reading *r = arg;
    struct command *c;

    if (r->within && !r->c->commands)
        return refuse_command(text, err);
    c = command_start(text, r->folder, err);
    if (!c)
        return RAD_EIO;
    *out = command_output(c);
    *job = c;
    return 0;
}

static int
end_command(void *arg, void *job, bool stop, struct rad_error *err)
{
    (void)arg;
    return command_end(job, stop, err);
}

static void
tell(void *arg, const struct rad_error *err)
{
    const struct reading *r = arg;

    r->each(r->arg, err);
}

/* Warnings that nobody asks for are kept. */
static void
warn(void *arg, const struct rad_error *err)
{
    const struct reading *r = arg;

    if (r->each)
        r->each(r->arg, err);
    else
        warning_keep(r->c, err);
}

static struct rad_parse_io
parse_io(struct reading *r)
{
    struct rad_parse_io io = { begin_command, end_command,
                               r->each ? tell : NULL, warn, r };

    return io;
}

/* Errors other than the parser's, which tells its own. */
static int
failed(const struct reading *r, const struct rad_error *err)
{
    if (r->each)
        r->each(r->arg, err);
    return err->code;
}

static int read_text_file(struct compiled *c, const char *file,
                          struct reading *r, struct rad_error *err);

/* Where an octree's scene file is: in the folder of the octree, in ours, or
 * along RAYPATH; malloc'd. */
static char *
find_scene_file(struct reading *r, const char *name, struct rad_error *err)
{
    char *path = NULL;

    if (name[0] != '/' && asprintf(&path, "%s/%s", r->folder, name) < 0)
        path = NULL;
    if (path && access(path, R_OK) == 0) {
        r->beside = true;
        return path;
    }
    free(path);
    if (access(name, R_OK) == 0)
        return strdup(name);
    return paths_find(&r->c->paths, name, err);
}

/* A scene file, or "!command", that an octree names.  As with Radiance a command
 * is run in our folder, for which oconv was given it, whatever the octree's is;
 * but in that one where the files before it were found there. */
static int
read_named(void *arg, const char *name, struct rad_error *err)
{
    struct reading *r = arg;
    struct rad_parse_io io = parse_io(r);
    const char *folder = r->folder;
    char *path;
    int rc;

    if (name[0] == '!' && !r->c->commands)
        return refuse_command(name + 1, err);
    if (name[0] == '!') {
        if (!r->beside)
            r->folder = ".";
        rc =
            rad_parse_text(r->c->scene, name, strlen(name), "octree", &io, err);
        r->told = rc != 0;
        r->folder = folder;
        return rc;
    }
    path = find_scene_file(r, name, err);
    if (!path)
        return err->code;
    rc = read_text_file(r->c, path, r, err);
    r->told = rc != 0;
    r->folder = folder;
    free(path);
    return rc;
}

static int
read_octree(struct compiled *c, const struct rad_stream *in, const char *name,
            bool alone, struct reading *r, struct rad_error *err)
{
    struct rad_error now = { 0 };
    struct rad_octfile how = { .text = read_named, .arg = r };
    int rc;

    r->within = alone;
    rc = alone ? rad_octfile_read_as(c->scene, &how, in, name, &now)
               : rad_fail(&now, RAD_EUSAGE,
                          "octree '%s' must be the only scene file", name);

    if (rc && err && err->code == 0)
        *err = now;
    return rc && !r->told ? failed(r, &now) : rc;
}

static int
read_source_file(struct compiled *c, struct source *src, const char *file,
                 bool alone, struct reading *r, struct rad_error *err)
{
    struct rad_stream in = { read_source, src };
    struct rad_parse_io io = parse_io(r);

    r->folder = src->folder;
    if (has_suffix(file, ".oct") || rad_octfile_is(src->head, src->len)) {
        r->octree = true;
        return read_octree(c, &in, src->fd.name, alone, r, err);
    }
    return rad_parse(c->scene, &in, src->fd.name, &io, err);
}

static int
read_file(struct compiled *c, const char *file, bool alone, struct reading *r,
          struct rad_error *err)
{
    struct source *src = malloc(sizeof *src);
    struct rad_error now = { 0 };
    int rc;

    if (!src)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    rc = open_source(src, file, &now);
    if (!rc)
        rc = paths_add_file(&c->paths, file, &now);
    if (!rc)
        rc = inputs_add_fd(&c->paths.inputs, "a file of the scene", src->fd.fd,
                           &now);
    if (rc && err && err->code == 0)
        *err = now;
    rc = rc ? failed(r, &now) : read_source_file(c, src, file, alone, r, err);
    close_source(src);
    free(src);
    return rc;
}

static int
read_text_file(struct compiled *c, const char *file, struct reading *r,
               struct rad_error *err)
{
    return read_file(c, file, false, r, err);
}

/* "!command" in place of a file, as oconv(1) takes it. */
static int
read_command(struct compiled *c, const char *text, struct reading *r,
             struct rad_error *err)
{
    struct rad_parse_io io = parse_io(r);

    r->folder = ".";
    return rad_parse_text(c->scene, text, strlen(text), "command line", &io,
                          err);
}

/* --- octrees of instances that are not frozen ---------------------------- */

struct frozen {
    struct frozen *next;
    char *name;
    struct rad_memory_out file;
};

/* Freeze the octree in bytes[len], which c's scene has an instance of. */
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
    struct rad_octfile how = { .text = read_named, .arg = &r };
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
        rc = rad_fail(err, RAD_ENOMEM, "out of memory");
    else
        rc = rad_octfile_read_as(in.scene, &how, &stream, name, err);
    c->paths = in.paths; /* scene files add folders */
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
        rad_fail(err, RAD_ENOMEM, "out of memory");
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
        rad_fail(err, RAD_ENOMEM, "out of memory");
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

struct rad_files
compile_files(struct compiled *c)
{
    struct rad_files files = { read_needed, c };

    return files;
}

/* --- files that the scene needs ----------------------------------------------
 */

/* Call `visit` for each file name of each object that a surface reaches; its
 * failures end the visit unless someone wants all, who is warned of those of
 * the other objects, too. */
static int
visit_files(struct compiled *c, const struct reading *r,
            int (*visit)(struct compiled *c, const char *name, const char *dir,
                         struct rad_error *err),
            const char *dir, struct rad_error *err)
{
    const struct rad_scene *s = c->scene;
    uint8_t *reached = malloc((size_t)s->nobjects + 1);
    const char *name, *last = ""; /* found: faces of a mesh name the same */
    int first = 0;

    if (!reached)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    rad_scene_reach(s, reached);
    for (int32_t i = 0; i < s->nobjects && (r->each || !first); i++)
        for (int k = 0; (reached[i] || r->each) &&
                        (name = rad_object_file(&s->objects[i], k));
             k++) {
            struct rad_error why = { 0 }, now = { 0 };

            if (strcmp(name, last) == 0 || visit(c, name, dir, &why) == 0) {
                last = name;
                continue;
            }
            rad_scene_fail(s, &s->objects[i], &now,
                           reached[i] ? why.code : RAD_WARNING, "%s%s",
                           why.what, reached[i] ? "" : "; no surface uses it");
            if (r->each)
                r->each(r->arg, &now);
            if (!reached[i])
                continue;
            if (!first && err && err->code == 0)
                *err = now;
            first = first ? first : now.code;
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

/* --- the bundle
 * ---------------------------------------------------------------- */

/* A file that gets its name when its bytes are known. */
struct storing {
    struct rad_fd to;
    struct rad_sha sha;
    uint64_t size;
    char path[4096]; /* while it has no other name */
};

static int
store_begin(struct storing *f, const char *dir, struct rad_error *err)
{
    int rc;

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

/* Give it its name, and enter it; or drop it if rc says so. */
static int
store_end(struct storing *f, int rc, struct compiled *c, const char *dir,
          enum rad_bundle_role role, const char *name, struct rad_error *err)
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
        snprintf(path, sizeof path, "%s/%s", dir, hash);
        if (rename(f->path, path))
            rc = rad_fail(err, RAD_ECANTCREAT, "cannot create '%s': %s", path,
                          strerror(errno));
    }
    if (rc)
        unlink(f->path);
    return rc ? rc : rad_bundle_add(&c->bundle, role, name, hash, f->size, err);
}

static int
bundle_octree(struct compiled *c, const char *dir, struct rad_error *err)
{
    struct storing f;
    struct rad_sink out = { store_bytes, &f };
    int rc = store_begin(&f, dir, err);

    if (rc)
        return rc;
    rc = rad_octfile_write(c->scene, &c->octree, &out, err);
    return store_end(&f, rc, c, dir, RAD_BUNDLE_SCENE, NULL, err);
}

static int
bundle_file(struct compiled *c, const char *name, const char *dir,
            struct rad_error *err)
{
    struct rad_files files = compile_files(c);
    struct storing f;
    unsigned char *bytes;
    size_t len;
    int rc;

    if (rad_bundle_find(&c->bundle, RAD_BUNDLE_FILE, name))
        return 0;
    bytes = files.read(files.arg, name, &len, err);
    if (!bytes)
        return err->code;
    rc = store_begin(&f, dir, err);
    if (!rc) {
        rc = store_bytes(&f, bytes, len, err);
        rc = store_end(&f, rc, c, dir, RAD_BUNDLE_FILE, name, err);
    }
    free(bytes);
    return rc;
}

/* --- the whole ---------------------------------------------------------------
 */

/* Read the scene, but not the files of its instances and meshes.  After a
 * failure c holds what was read, to be released. */
static int
read_scene(struct compiled *c, const char *const *files, int n, bool commands,
           struct reading *r, struct rad_error *err)
{
    int rc;

    memset(c, 0, sizeof *c);
    c->commands = commands;
    rad_octree_init(&c->octree);
    rad_bundle_init(&c->bundle);
    c->scene = rad_scene_new();
    rc = c->scene ? paths_init(&c->paths, err)
                  : rad_fail(err, RAD_ENOMEM, "out of memory");
    for (int i = 0; c->paths.raypath && i < n && (r->each || !rc); i++) {
        int now = files[i][0] == '!' ? read_command(c, files[i], r, err)
                                     : read_file(c, files[i], n == 1, r, err);

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
compile_parse(struct compiled *c, const char *const *files, int n,
              bool commands,
              void (*each)(void *arg, const struct rad_error *err), void *arg,
              struct rad_error *err)
{
    struct reading r = { .c = c, .each = each, .arg = arg };
    int rc = read_scene(c, files, n, commands, &r, err);

    if (!rc)
        rc = include_parts(c, each, arg, err);
    if (rc)
        compile_release(c);
    return rc;
}

/* What is wrong with the scene. */
static void
judge(void *arg, const struct rad_error *err)
{
    const struct reading *r = arg;

    if (r->each || err->code == RAD_WARNING)
        warn(arg, err);
}

int
compile_read(struct compiled *c, const char *const *files, int n, bool commands,
             void (*each)(void *arg, const struct rad_error *err), void *arg,
             struct rad_error *err)
{
    struct reading r = { .c = c, .each = each, .arg = arg };
    int now, rc = read_scene(c, files, n, commands, &r, err);

    if (rc && (!each || r.octree || !c->paths.raypath)) {
        compile_release(c);
        return rc;
    }
    /* what was read may have other errors */
    now = include_parts(c, each, arg, err);
    rc = rc ? rc : now;
    if (!rc || each) {
        now = rad_scene_check(c->scene, judge, &r, err);
        rc = rc ? rc : now;
    }
    if (!rc || each) {
        now = visit_files(c, &r, find_file, NULL, err);
        rc = rc ? rc : now;
    }
    if (rc)
        compile_release(c);
    return rc;
}

int
compile_octree(struct compiled *c, int leaf, struct rad_error *err)
{
    return rad_octree_build(&c->octree, c->scene, leaf, err);
}

int
compile_bundle(struct compiled *c, const char *dir, struct rad_error *err)
{
    struct reading r = { 0 };
    int rc = bundle_octree(c, dir, err);

    for (int32_t i = 0; i < c->scene->nparts && !rc; i++)
        rc = bundle_file(c, c->scene->parts[i]->name, dir, err);
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
    int rc = store_begin(&f, dir, err);

    if (rc)
        return rc;
    rc = store_bytes(&f, bytes, len, err);
    return store_end(&f, rc, c, dir, RAD_BUNDLE_FILE, name, err);
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
        return rad_fail(err, RAD_ENOMEM, "out of memory");
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
        rc = compile_bundle(c, dir, err);
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
compile_scene(struct compiled *c, const char *const *files, int n,
              bool commands, const char *dir, struct rad_error *err)
{
    int rc = compile_read(c, files, n, commands, NULL, NULL, err);

    if (rc)
        return rc;
    rc = compile_check(c, err);
    if (!rc)
        rc = compile_octree(c, RAD_OCTREE_MAX_SET, err);
    if (!rc)
        rc = compile_bundle(c, dir, err);
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
