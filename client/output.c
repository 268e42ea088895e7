/* output.c - see output.h */
#include "config.h"

#include "output.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

/* Does the name stand for something that must be written in place? */
static bool
in_place(const char *path)
{
    struct stat st;

    return stat(path, &st) == 0 && !S_ISREG(st.st_mode);
}

static int
cannot_create(const char *path, const char *why, struct rad_error *err)
{
    return rad_fail(err, RAD_ECANTCREAT, "cannot create '%s': %s", path, why);
}

/* The folder that path's file is made in; to be freed. */
static char *
folder_of(const char *path)
{
    char *copy = strdup(path), *folder = NULL;

    if (copy)
        folder = strdup(dirname(copy));
    free(copy);
    return folder;
}

/* The name that is replaced: a link is followed.  To be freed. */
static char *
real_name(const char *path)
{
    char *real = realpath(path, NULL);

    return real ? real : strdup(path);
}

static int
check_folder(const char *path, struct rad_error *err)
{
    char *folder = folder_of(path);
    struct stat st;
    int rc = 0;

    if (!folder)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    if (stat(folder, &st) != 0)
        rc = cannot_create(
            path, errno == ENOENT ? "no such folder" : strerror(errno), err);
    else if (!S_ISDIR(st.st_mode))
        rc = cannot_create(path, "its folder is a file", err);
    else if (access(folder, W_OK | X_OK) != 0)
        rc = cannot_create(path, strerror(errno), err);
    free(folder);
    return rc;
}

int
output_check(const char *path, struct rad_error *err)
{
    struct stat st;
    char *real;
    int rc;

    if (path[0] == '\0' || path[strlen(path) - 1] == '/')
        return cannot_create(path, "not a file's name", err);
    if (stat(path, &st) == 0 && S_ISDIR(st.st_mode))
        return cannot_create(path, "is a folder", err);
    if (in_place(path)) {
        if (access(path, W_OK) != 0)
            return cannot_create(path, strerror(errno), err);
        return 0;
    }
    real = real_name(path);
    if (!real)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    rc = check_folder(real, err);
    free(real);
    return rc;
}

/* The name from the root on, of a file that need not be there; NULL if its
 * folder is not.  To be freed. */
static char *
full_name(const char *path)
{
    char *real = realpath(path, NULL), *folder, *base;
    const char *slash = strrchr(path, '/');

    if (real)
        return real;
    folder = folder_of(path);
    base = folder ? realpath(folder, NULL) : NULL;
    free(folder);
    slash = slash ? slash + 1 : path;
    real = base ? malloc(strlen(base) + strlen(slash) + 2) : NULL;
    if (real)
        sprintf(real, "%s/%s", base, slash);
    free(base);
    return real;
}

bool
output_same(const char *a, const char *b)
{
    char *fa, *fb;
    bool same;

    if (in_place(a) || in_place(b))
        return false;
    fa = full_name(a);
    fb = full_name(b);
    same = fa && fb && strcmp(fa, fb) == 0;
    free(fa);
    free(fb);
    return same;
}

static int
open_temp(struct output *out, struct rad_error *err)
{
    static const char tail[] = ".XXXXXX";
    mode_t mask = umask(0);
    int fd;

    umask(mask);
    out->real = real_name(out->path);
    if (!out->real)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    out->temp = malloc(strlen(out->real) + sizeof tail);
    if (!out->temp)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    sprintf(out->temp, "%s%s", out->real, tail);
    fd = mkstemp(out->temp);
    if (fd < 0) {
        free(out->temp);
        out->temp = NULL;
        return cannot_create(out->path, strerror(errno), err);
    }
    fchmod(fd, 0666 & ~mask);
    out->file = fdopen(fd, "wb");
    if (!out->file) {
        close(fd);
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    }
    return 0;
}

int
output_open(struct output *out, const char *path, bool durable,
            struct rad_error *err)
{
    int rc = 0;

    memset(out, 0, sizeof *out);
    out->durable = durable;
    if (!path) {
        out->file = stdout;
        return 0;
    }
    out->path = strdup(path);
    if (!out->path)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    if (in_place(path)) {
        out->file = fopen(path, "wb");
        if (!out->file)
            rc = cannot_create(path, strerror(errno), err);
    } else {
        rc = open_temp(out, err);
    }
    if (rc < 0)
        output_abort(out);
    return rc;
}

static void
release(struct output *out)
{
    free(out->path);
    free(out->real);
    free(out->temp);
    memset(out, 0, sizeof *out);
}

int
output_commit(struct output *out, struct rad_error *err)
{
    int bad = fflush(out->file) != 0 || ferror(out->file);

    if (out->file != stdout) {
        if (out->durable && out->temp && !bad)
            bad = fsync(fileno(out->file)) != 0;
        bad |= fclose(out->file) != 0;
        out->file = NULL;
    }
    if (!bad && out->temp && rename(out->temp, out->real) != 0)
        bad = 1;
    if (bad) {
        rad_fail(err, RAD_EIO, "cannot write '%s': %s",
                 out->path ? out->path : "standard output", strerror(errno));
        output_abort(out);
        return RAD_EIO;
    }
    release(out);
    return 0;
}

void
output_abort(struct output *out)
{
    if (out->file && out->file != stdout)
        fclose(out->file);
    if (out->temp)
        unlink(out->temp);
    release(out);
}

int
output_write(const char *path, const void *bytes, size_t n, bool durable,
             struct rad_error *err)
{
    struct output out;
    int rc = output_open(&out, path, durable, err);

    if (rc < 0)
        return rc;
    if (n > 0) /* a failure shows at the commit */
        (void)!fwrite(bytes, 1, n, out.file);
    return output_commit(&out, err);
}

bool
output_suffix(const char *path, const char *suffix)
{
    size_t n = strlen(path), k = strlen(suffix);

    return n > k && strcasecmp(path + n - k, suffix) == 0;
}

/* The length of a "%d" or "%03d" at s, 0 for anything else; its width. */
static size_t
conversion(const char *s, int *width)
{
    char *end;
    long w = strtol(s + 1, &end, 10);

    if ((s[1] != 'd' && (s[1] < '0' || s[1] > '9')) || *end != 'd' || w > 20)
        return 0;
    *width = s[1] == 'd' ? 0 : (int)w;
    return (size_t)(end + 1 - s);
}

int
output_frame_name(char **name, const char *pattern, int frame, bool need,
                  struct rad_error *err)
{
    size_t size = strlen(pattern) + 32, used = 0, k;
    char *buf = malloc(size);
    int width, found = 0;

    if (!buf)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    for (const char *s = pattern; *s;) {
        if (*s != '%') {
            buf[used++] = *s++;
        } else if (s[1] == '%') {
            buf[used++] = '%';
            s += 2;
        } else if ((k = conversion(s, &width)) > 0 && found++ == 0) {
            used +=
                (size_t)snprintf(buf + used, size - used,
                                 s[1] == '0' ? "%0*d" : "%*d", width, frame);
            s += k;
        } else {
            free(buf);
            return rad_fail(err, RAD_EUSAGE,
                            "'%s': expected one %%d, as in '%%03d'", pattern);
        }
    }
    buf[used] = '\0';
    if (need && !found) {
        free(buf);
        return rad_fail(err, RAD_EUSAGE, "'%s': no %%d for the frame's number",
                        pattern);
    }
    *name = buf;
    return 0;
}
