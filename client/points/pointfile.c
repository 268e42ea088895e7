/* pointfile.c - see pointfile.h */
#include "config.h"

#include "points/pointfile.h"

#include "base/files.h"
#include "base/list.h"
#include "base/number.h"
#include "base/text.h"
#include "points/points.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Most bytes of a file; a point takes some 60 bytes of text. */
#define LARGEST ((size_t)1 << 30)

/* Make room for one more point. */
static int
reserve(struct pointfile *f, struct rad_error *err)
{
    if (f->n == RAD_MAX_POINTS)
        return rad_fail(err, RAD_EUSAGE,
                        "more than %d sensor points, which is the most that a "
                        "job can have: take them apart",
                        RAD_MAX_POINTS);
    return rad_list_grow(&f->point, f->n, sizeof *f->point)
               ? 0
               : rad_fail_memory(err);
}

static bool
is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v';
}

/* Read the number at s, before `end`; returns its end, or NULL with *err set.
 */
static const char *
take_number(const char *s, const char *end, double *v, struct rad_error *err)
{
    char word[64];
    size_t n = 0;

    while (s + n < end && !is_blank(s[n]))
        n++;
    snprintf(word, sizeof word, "%.*s", (int)(n < 63 ? n : 63), s);
    if (n == strlen(word) && rad_parse_real(word, v))
        return s + n;
    rad_fail(err, RAD_EDATA, "'%.40s' is not a number", word);
    return NULL;
}

/* Are there fewer points than f->most so far? */
static bool
wanted(const struct pointfile *f)
{
    return f->taken + f->n < f->most;
}

/* Where the line at s ends: at a newline or, as programs for Windows and
 * bifacial_radiance write, at a return. */
static const char *
line_end(const char *s, const char *end)
{
    while (s < end && *s != '\n' && *s != '\r')
        s++;
    return s;
}

static int
parse_text(struct pointfile *f, const char *s, size_t n, bool last,
           size_t *used, struct rad_error *err)
{
    const char *begin = s, *end = s + n;
    int rc = 0;

    if (f->line == 0)
        s += rad_text_mark(s, n);
    while (rc == 0 && s < end && wanted(f)) {
        const char *stop = line_end(s, end);
        double v[6];

        if (stop == end && !last)
            break;
        if (*s != '\n' || !f->returned) /* not within "\r\n" */
            f->line++;
        rc = pointfile_line(s, (size_t)(stop - s), v, err);
        if (rc == 1 && (rc = reserve(f, err)) == 0)
            memcpy(f->point[f->n++], v, sizeof v);
        if (rc < 0)
            rad_error_where(err, "%s:%ld", f->name, f->line);
        f->returned = stop < end && *stop == '\r';
        s = stop < end ? stop + 1 : end;
    }
    *used = (size_t)(s - begin);
    return rc;
}

static void
take_binary(const uint8_t *bytes, bool wide, double v[6])
{
    float narrow[6];

    if (wide) {
        memcpy(v, bytes, 6 * sizeof *v);
        return;
    }
    memcpy(narrow, bytes, sizeof narrow);
    for (int k = 0; k < 6; k++)
        v[k] = (double)narrow[k];
}

static int
parse_binary(struct pointfile *f, const uint8_t *bytes, size_t n, bool last,
             size_t *used, struct rad_error *err)
{
    bool wide = f->format == 'd';
    const uint8_t *begin = bytes, *end = bytes + n;
    size_t each = 6 * (wide ? sizeof(double) : sizeof(float));
    int rc = 0;

    for (; (size_t)(end - bytes) >= each && wanted(f); bytes += each) {
        double v[6];

        take_binary(bytes, wide, v);
        for (int k = 0; k < 6 && rc == 0; k++)
            if (!isfinite(v[k]))
                rc = rad_fail(err, RAD_EDATA,
                              "sensor point %" PRIu64
                              " has a number that is not finite",
                              f->taken + f->n + 1);
        if (rc < 0 || (rc = reserve(f, err)) < 0)
            break;
        memcpy(f->point[f->n++], v, sizeof v);
    }
    if (rc == 0 && last && bytes < end && wanted(f))
        rc = rad_fail(err, RAD_EDATA,
                      "%zu bytes behind sensor point %" PRIu64
                      ", and each has %zu",
                      (size_t)(end - bytes), f->taken + f->n, each);
    if (rc < 0)
        rad_error_where(err, "%s", f->name);
    *used = (size_t)(bytes - begin);
    return rc;
}

int
pointfile_line(const char *line, size_t len, double v[6], struct rad_error *err)
{
    const char *s = line, *end = line + len;
    int n = 0;

    for (;; n++) {
        double extra;

        while (s < end && is_blank(*s))
            s++;
        if (s == end)
            break;
        s = take_number(s, end, n < 6 ? &v[n] : &extra, err);
        if (!s)
            return RAD_EDATA;
    }
    if (n == 0 || n == 6)
        return n > 0;
    return rad_fail(err, RAD_EDATA, "expected six numbers, got %d", n);
}

int
pointfile_more(struct pointfile *f, const void *bytes, size_t n, bool last,
               size_t *used, struct rad_error *err)
{
    return f->format == 'a' ? parse_text(f, bytes, n, last, used, err)
                            : parse_binary(f, bytes, n, last, used, err);
}

void
pointfile_init(struct pointfile *f, const char *name, char format,
               uint64_t most)
{
    *f = (struct pointfile){ .name = name, .format = format, .most = most };
}

int
pointfile_read(struct pointfile *f, struct rad_error *err)
{
    bool std = strcmp(f->name, "-") == 0;
    unsigned char *bytes;
    size_t n, used;
    int rc;

    if (std)
        f->name = "stdin";
    bytes = std ? rad_fd_read(STDIN_FILENO, f->name, LARGEST, &n, err)
                : rad_file_read(f->name, LARGEST, &n, err);
    if (!bytes)
        return err->code;
    rc = pointfile_more(f, bytes, n, true, &used, err);
    free(bytes);
    if (rc == 0 && f->n == 0)
        rc = rad_fail(err, RAD_EDATA, "no sensor points in '%s'", f->name);
    return rc;
}

int
pointfile_take(struct pointfile *from, uint32_t n, struct pointfile *to,
               struct rad_error *err)
{
    *to = (struct pointfile){ .n = n };
    if (n == 0)
        return 0;
    to->point = malloc(n * sizeof *to->point);
    if (!to->point)
        return rad_fail_memory(err);
    memcpy(to->point, from->point, n * sizeof *to->point);
    from->n -= n;
    from->taken += n;
    memmove(from->point, from->point + n, from->n * sizeof *from->point);
    return 0;
}

void
pointfile_release(struct pointfile *f)
{
    free(f->point);
    memset(f, 0, sizeof *f);
}
