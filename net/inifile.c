/* inifile.c - see inifile.h
 *
 * inih calls its reader for each line.  Ours counts the lines, so that an error
 * can name the line, and refuses a line that inih would split. */
#include "config.h"

#include "net/inifile.h"

#include <errno.h>
#include <ini.h>
#include <string.h>

struct reader {
    FILE *file;
    const char *path;
    inifile_fn *fn;
    void *arg;
    int line;
    int code; /* of the first error; 0: none */
    struct rad_error *err;
};

static void
reader_failed(struct reader *r, int code)
{
    if (r->code == 0) {
        r->code = code;
        rad_error_where(r->err, "%s:%d", r->path, r->line);
    }
}

static char *
read_line(char *str, int num, void *stream)
{
    struct reader *r = stream;

    if (r->code || !fgets(str, num, r->file))
        return NULL;
    r->line++;
    if (!strchr(str, '\n') && !feof(r->file)) {
        reader_failed(r, rad_fail(r->err, RAD_ECONFIG,
                                  "line longer than %d bytes", num - 2));
        return NULL;
    }
    return str;
}

static int
take_pair(void *user, const char *section, const char *name, const char *value)
{
    struct reader *r = user;
    int rc = r->fn(r->arg, section, name, value, r->err);

    if (rc < 0)
        reader_failed(r, rc);
    return rc == 0;
}

int
inifile_read(FILE *file, const char *path, inifile_fn *fn, void *arg,
             struct rad_error *err)
{
    struct reader r = {
        .file = file, .path = path, .fn = fn, .arg = arg, .err = err
    };
    int line = ini_parse_stream(read_line, &r, take_pair, &r);

    if (r.code == 0 && ferror(file))
        r.code = rad_fail(err, RAD_EIO, "cannot read '%s': %s", path,
                          strerror(errno));
    if (r.code == 0 && line != 0) {
        r.line = line > 0 ? line : r.line;
        reader_failed(&r, rad_fail(err, RAD_ECONFIG,
                                   "expected 'key = value' or '[section]'"));
    }
    return r.code;
}
