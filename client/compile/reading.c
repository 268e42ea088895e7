/* reading.c - see reading.h */
#include "config.h"

#include "compile/reading.h"

#include "compile/command.h"
#include "compile/warning.h"
#include "scene/file/parse.h"
#include "scene/octfile.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define STDIN_NAME   "standard input"
#define COMMAND_LINE "command line"

/* A file that is being read.  Its beginning is in memory, to tell what it is.
 */
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

/* Open a file and read its beginning. */
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
        return rad_fail_memory(err);
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

/* Refuse a command of an octree: a user can see the commands in a scene's text,
 * but not those in an octree. */
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
    c = command_start(text, command_folder(text, r->folder), err);
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

void
reading_warn(void *arg, const struct rad_error *err)
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
                               r->each ? tell : NULL, reading_warn, r };

    return io;
}

/* Report an error that the parser has not reported itself; returns its code. */
static int
failed(const struct reading *r, const struct rad_error *err)
{
    if (r->each)
        r->each(r->arg, err);
    return err->code;
}

/* The path of a scene file that an octree names, malloc'd: in the octree's
 * folder, in the current one, or along RAYPATH. */
static char *
find_scene_file(struct reading *r, const char *name, struct rad_error *err)
{
    char path[PATH_MAX], *found;
    int n = snprintf(path, sizeof path, "%s/%s", r->folder, name);
    bool beside = name[0] != '/' && n < PATH_MAX && access(path, R_OK) == 0;

    r->beside |= beside;
    if (!beside && access(name, R_OK) < 0)
        return paths_find(&r->c->paths, name, err);
    found = strdup(beside ? path : name);
    if (!found)
        rad_fail_memory(err);
    return found;
}

/* A command that an octree names runs in the current folder, as with Radiance:
 * it was given to oconv.  But if scene files before it were found in the
 * octree's folder it runs there. */
int
reading_named(void *arg, const char *name, struct rad_error *err)
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
    rc = reading_file(r, path, false, err);
    r->told = rc != 0;
    r->folder = folder;
    free(path);
    return rc;
}

static int
read_octree(struct reading *r, const struct rad_stream *in, const char *name,
            bool alone, struct rad_error *err)
{
    struct rad_error now = { 0 };
    struct rad_octfile how = { .text = reading_named, .arg = r };
    int rc;

    r->within = alone;
    rc = alone ? rad_octfile_read_as(r->c->scene, &how, in, name, &now)
               : rad_fail(&now, RAD_EUSAGE,
                          "octree '%s' must be the only scene file", name);

    if (rc && err && err->code == 0)
        *err = now;
    return rc && !r->told ? failed(r, &now) : rc;
}

static int
read_source_file(struct reading *r, struct source *src, const char *file,
                 bool alone, struct rad_error *err)
{
    struct rad_stream in = { read_source, src };
    struct rad_parse_io io = parse_io(r);

    r->folder = src->folder;
    if (has_suffix(file, ".oct") || rad_octfile_is(src->head, src->len)) {
        r->octree = true;
        return read_octree(r, &in, src->fd.name, alone, err);
    }
    return rad_parse(r->c->scene, &in, src->fd.name, &io, err);
}

int
reading_file(struct reading *r, const char *file, bool alone,
             struct rad_error *err)
{
    struct paths *paths = &r->c->paths;
    struct source *src = malloc(sizeof *src);
    struct rad_error now = { 0 };
    int rc;

    if (!src)
        return rad_fail_memory(err);
    rc = open_source(src, file, &now);
    if (!rc)
        rc = paths_add_file(paths, file, &now);
    if (!rc)
        rc = inputs_add_fd(paths->inputs, "a file of the scene", src->fd.fd,
                           &now);
    if (!rc && alone && src->len == 0 && strcmp(file, "-") == 0)
        rc = rad_fail(&now, RAD_EDATA,
                      "nothing came on " STDIN_NAME
                      ": has what writes the scene failed?");
    if (rc && err && err->code == 0)
        *err = now;
    rc = rc ? failed(r, &now) : read_source_file(r, src, file, alone, err);
    close_source(src);
    free(src);
    return rc;
}

/* A command of the command line that makes nothing reports that itself, so the
 * warning of it is dropped. */
static void
warn_of_command(void *arg, const struct rad_error *err)
{
    if (strcmp(err->where, COMMAND_LINE) != 0)
        reading_warn(arg, err);
}

int
reading_command(struct reading *r, const char *text, struct rad_error *err)
{
    struct rad_parse_io io = parse_io(r);

    io.warn = warn_of_command;
    r->folder = ".";
    return rad_parse_text(r->c->scene, text, strlen(text), COMMAND_LINE, &io,
                          err);
}
