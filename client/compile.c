/* compile.c - see compile.h */
#include "config.h"

#include "compile.h"

#include "command.h"
#include "scene/octfile.h"
#include "scene/parse.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
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
    const char *folder; /* of the file that is being read */
    void (*each)(void *arg, const struct rad_error *err);
    void *arg;
};

static int
begin_command(void *arg, const char *text, struct rad_stream *out, void **job,
              struct rad_error *err)
{
    const struct reading *r = arg;
    struct command *c = command_start(text, r->folder, err);

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

/* Errors other than the parser's, which tells its own. */
static int
failed(const struct reading *r, const struct rad_error *err)
{
    if (r->each)
        r->each(r->arg, err);
    return err->code;
}

static int
read_octree(struct compiled *c, const struct rad_stream *in, const char *name,
            bool alone, const struct reading *r, struct rad_error *err)
{
    struct rad_error now = { 0 };
    int rc = alone ? rad_octfile_read(c->scene, NULL, in, name, &now)
                   : rad_fail(&now, RAD_EUSAGE,
                              "octree '%s' must be the only scene file", name);

    if (rc && err && err->code == 0)
        *err = now;
    return rc ? failed(r, &now) : 0;
}

static int
read_source_file(struct compiled *c, struct source *src, const char *file,
                 bool alone, struct reading *r, struct rad_error *err)
{
    struct rad_stream in = { read_source, src };
    struct rad_parse_io io = { begin_command, end_command,
                               r->each ? tell : NULL, r };

    if (has_suffix(file, ".oct") || rad_octfile_is(src->head, src->len))
        return read_octree(c, &in, src->fd.name, alone, r, err);
    r->folder = src->folder;
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
    if (rc && err && err->code == 0)
        *err = now;
    rc = rc ? failed(r, &now) : read_source_file(c, src, file, alone, r, err);
    close_source(src);
    free(src);
    return rc;
}

/* --- files that the scene needs ----------------------------------------------
 */

/* Call `visit` for each file name of each object that a surface reaches; its
 * failures end the visit unless someone wants all. */
static int
visit_files(struct compiled *c, const struct reading *r,
            int (*visit)(struct compiled *c, const char *name, const char *dir,
                         struct rad_error *err),
            const char *dir, struct rad_error *err)
{
    const struct rad_scene *s = c->scene;
    uint8_t *reached = malloc((size_t)s->nobjects + 1);
    const char *name;
    int first = 0;

    if (!reached)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    rad_scene_reach(s, reached);
    for (int32_t i = 0; i < s->nobjects && (r->each || !first); i++)
        for (int k = 0;
             reached[i] && (name = rad_object_file(&s->objects[i], k)); k++) {
            struct rad_error why = { 0 }, now = { 0 };

            if (visit(c, name, dir, &why) == 0)
                continue;
            rad_scene_fail(s, &s->objects[i], &now, why.code, "%s", why.what);
            if (r->each)
                r->each(r->arg, &now);
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
    struct rad_files files = paths_files(&c->paths);
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

int
compile_parse(struct compiled *c, const char *const *files, int n,
              void (*each)(void *arg, const struct rad_error *err), void *arg,
              struct rad_error *err)
{
    struct reading r = { NULL, each, arg };
    int rc;

    memset(c, 0, sizeof *c);
    rad_octree_init(&c->octree);
    rad_bundle_init(&c->bundle);
    c->scene = rad_scene_new();
    rc = c->scene ? paths_init(&c->paths, err)
                  : rad_fail(err, RAD_ENOMEM, "out of memory");
    for (int i = 0; c->paths.raypath && i < n && (each || !rc); i++) {
        int now = read_file(c, files[i], n == 1, &r, err);

        rc = rc ? rc : now;
    }
    if (rc)
        compile_release(c);
    return rc;
}

int
compile_read(struct compiled *c, const char *const *files, int n,
             void (*each)(void *arg, const struct rad_error *err), void *arg,
             struct rad_error *err)
{
    struct reading r = { NULL, each, arg };
    int missing, rc = compile_parse(c, files, n, each, arg, err);

    if (rc)
        return rc;
    rc = rad_scene_check(c->scene, each, arg, err);
    if (!rc || each) {
        missing = visit_files(c, &r, find_file, NULL, err);
        rc = rc ? rc : missing;
    }
    if (rc)
        compile_release(c);
    return rc;
}

int
compile_octree(struct compiled *c, struct rad_error *err)
{
    return rad_octree_build(&c->octree, c->scene, err);
}

bool
compile_warning(const struct compiled *c, char text[COMPILE_WARNING])
{
    int32_t n = c->octree.left_out;

    if (n == 0)
        return false;
    snprintf(text, COMPILE_WARNING,
             "warning: full cubes of the octree lack %" PRId32 " surface%s, "
             "%d a cube being Radiance's limit: its programs may miss %s "
             "there; our own rendering is not affected",
             n, n == 1 ? "" : "s", RAD_OCTREE_MAX_SET, n == 1 ? "it" : "them");
    return true;
}

int
compile_bundle(struct compiled *c, const char *dir, struct rad_error *err)
{
    struct reading r = { 0 };
    int rc = bundle_octree(c, dir, err);

    return rc ? rc : visit_files(c, &r, bundle_file, dir, err);
}

int
compile_scene(struct compiled *c, const char *const *files, int n,
              const char *dir, struct rad_error *err)
{
    int rc = compile_read(c, files, n, NULL, NULL, err);

    if (rc)
        return rc;
    rc = compile_octree(c, err);
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
    paths_release(&c->paths);
    rad_octree_release(&c->octree);
    rad_bundle_release(&c->bundle);
}
