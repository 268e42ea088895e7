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

/* A file, or the output of a command of the command line, that is being read.
 * Its beginning is in memory, to tell what it is. */
struct source {
    struct rad_fd fd;
    struct command *command; /* NULL: a file */
    char *folder;            /* of a file */
    size_t pos, len;
    unsigned char head[16 * 1024];
};

static struct rad_stream
rest_of(struct source *src)
{
    return src->command ? command_output(src->command)
                        : rad_fd_stream(&src->fd);
}

static long
read_source(void *arg, void *buf, size_t n, struct rad_error *err)
{
    struct source *src = arg;
    struct rad_stream rest = rest_of(src);

    if (src->pos == src->len)
        return rest.read(rest.arg, buf, n, err);
    if (n > src->len - src->pos)
        n = src->len - src->pos;
    memcpy(buf, src->head + src->pos, n);
    src->pos += n;
    return (long)n;
}

static int
read_head(struct source *src, struct rad_error *err)
{
    struct rad_stream in = rest_of(src);

    src->pos = src->len = 0;
    while (src->len < sizeof src->head) {
        long n = in.read(in.arg, src->head + src->len,
                         sizeof src->head - src->len, err);

        if (n <= 0)
            return (int)n;
        src->len += (size_t)n;
    }
    return 0;
}

/* Open a file and read its beginning. */
static int
open_source(struct source *src, const char *file, struct rad_error *err)
{
    bool standard = strcmp(file, "-") == 0;

    src->command = NULL;
    src->folder = NULL;
    src->fd.name = standard ? STDIN_NAME : file;
    src->fd.fd = standard ? STDIN_FILENO : open(file, O_RDONLY | O_CLOEXEC);
    if (src->fd.fd < 0)
        return rad_fail(err, RAD_ENOINPUT, "cannot open '%s': %s", file,
                        strerror(errno));
    src->folder = standard ? strdup(".") : paths_folder_of(file);
    return src->folder ? read_head(src, err) : rad_fail_memory(err);
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
    struct reading *r = arg;
    struct source *begun = r->begun;
    struct command *c;

    if (begun) {
        r->begun = NULL;
        *out = (struct rad_stream){ read_source, begun };
        *job = begun->command;
        return 0;
    }
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

/* The same of an error that ends the reading of a whole file; *err gets it, if
 * it is the first. */
static int
fail_whole(const struct reading *r, const struct rad_error *now,
           struct rad_error *err)
{
    if (err && err->code == 0)
        *err = *now;
    return failed(r, now);
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
    rc = rc ? fail_whole(r, &now, err)
            : read_source_file(r, src, file, alone, err);
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

/* Read the octree that a command writes, to the end of its output. */
static int
read_made_octree(struct reading *r, struct source *src, const char *text,
                 bool alone, struct rad_error *err)
{
    struct rad_stream in = { read_source, src }, rest = rest_of(src);
    struct rad_error now = { 0 };
    int rc, end;

    r->octree = true;
    rc = read_octree(r, &in, text, alone, err);
    while (rc == 0 &&
           rest.read(rest.arg, src->head, sizeof src->head, NULL) > 0)
        ;
    end = command_end(src->command, rc != 0, &now);
    return rc ? rc : end ? fail_whole(r, &now, err) : 0;
}

/* Read the text that a command writes.  The parser is given the command's first
 * line: the shell has all of them. */
static int
read_made_text(struct reading *r, struct source *src, const char *text,
               struct rad_error *err)
{
    struct rad_parse_io io = parse_io(r);
    int rc;

    io.warn = warn_of_command;
    r->begun = src;
    rc = rad_parse_text(r->c->scene, text, strcspn(text, "\n"), COMMAND_LINE,
                        &io, err);
    if (r->begun) /* the parser did not come to it */
        command_end(src->command, true, NULL);
    r->begun = NULL;
    return rc;
}

int
reading_command(struct reading *r, const char *text, bool alone,
                struct rad_error *err)
{
    struct source *src = malloc(sizeof *src);
    struct rad_error now = { 0 };
    int rc;

    if (!src)
        return rad_fail_memory(err);
    r->folder = ".";
    src->command = command_start(text + 1, r->folder, &now);
    rc = src->command ? read_head(src, &now) : now.code;
    if (rc && src->command)
        command_end(src->command, true, NULL);
    if (rc)
        rc = fail_whole(r, &now, err);
    else if (rad_octfile_is(src->head, src->len))
        rc = read_made_octree(r, src, text, alone, err);
    else
        rc = read_made_text(r, src, text, err);
    free(src);
    return rc;
}
