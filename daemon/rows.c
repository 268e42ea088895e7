/* rows.c - see rows.h */
#include "config.h"

#include "rows.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

static size_t
row_bytes(const struct rows *r, int width)
{
    return (size_t)width * (size_t)r->channels * sizeof(float);
}

int
rows_create(struct rows *r, const char *path, int width, int height,
            int channels, bool reserve, struct rad_error *err)
{
    off_t size;
    int rc;

    memset(r, 0, sizeof *r);
    r->fd = -1;
    if (strlen(path) >= sizeof r->path)
        return rad_fail(err, RAD_ECANTCREAT, "path too long: '%s'", path);
    memcpy(r->path, path, strlen(path) + 1);
    r->width = width;
    r->height = height;
    r->channels = channels;
    r->fd = open(path, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0640);
    if (r->fd < 0)
        return rad_fail(err, RAD_ECANTCREAT, "cannot create '%s': %s", path,
                        strerror(errno));
    size = (off_t)row_bytes(r, width) * height;
    if (reserve)
        rc = posix_fallocate(r->fd, 0, size);
    else
        rc = ftruncate(r->fd, size) < 0 ? errno : 0;
    rows_rest(r);
    if (rc == 0)
        return 0;
    unlink(r->path);
    return rad_fail(err, RAD_EIO, "no room for '%s', %lld bytes: %s", path,
                    (long long)size, strerror(rc));
}

static int
use(struct rows *r, struct rad_error *err)
{
    if (r->fd < 0)
        r->fd = open(r->path, O_RDWR | O_CLOEXEC);
    if (r->fd < 0)
        return rad_fail(err, RAD_EIO, "cannot open '%s': %s", r->path,
                        strerror(errno));
    return 0;
}

static int
put_at(struct rows *r, const void *data, size_t n, off_t at,
       struct rad_error *err)
{
    const char *from = data;

    while (n > 0) {
        ssize_t put = pwrite(r->fd, from, n, at);

        if (put < 0 && errno == EINTR)
            continue;
        if (put < 0)
            return rad_fail(err, RAD_EIO, "cannot write '%s': %s", r->path,
                            strerror(errno));
        from += put;
        at += put;
        n -= (size_t)put;
    }
    return 0;
}

int
rows_write(struct rows *r, int x, int y, int w, int h, const float *pixels,
           struct rad_error *err)
{
    int step = h, rc;

    if (x < 0 || y < 0 || w < 1 || h < 1 || w > r->width - x ||
        h > r->height - y)
        return rad_fail(err, RAD_EPROTO,
                        "pixels %d,%d %dx%d do not lie in a picture of %dx%d",
                        x, y, w, h, r->width, r->height);
    rc = use(r, err);
    r->dirty = rc == 0;
    if (w < r->width) /* not contiguous in the file */
        step = 1;
    for (int k = 0; k < h && rc == 0; k += step) {
        off_t at =
            (off_t)row_bytes(r, r->width) * (y + k) + (off_t)row_bytes(r, x);

        rc = put_at(r, (const char *)pixels + row_bytes(r, w) * (size_t)k,
                    row_bytes(r, w) * (size_t)step, at, err);
    }
    return rc;
}

int
rows_sync(struct rows *r, struct rad_error *err)
{
    if (r->dirty && fdatasync(r->fd) < 0)
        return rad_fail(err, RAD_EIO, "cannot sync '%s': %s", r->path,
                        strerror(errno));
    r->dirty = false;
    return 0;
}

int
rows_read(struct rows *r, int y, float *pixels, struct rad_error *err)
{
    size_t n = row_bytes(r, r->width);
    off_t at = (off_t)n * y;
    char *to = (char *)pixels;

    if (use(r, err) < 0)
        return RAD_EIO;
    while (n > 0) {
        ssize_t got = pread(r->fd, to, n, at);

        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return rad_fail(err, RAD_EIO, "cannot read '%s'", r->path);
        to += got;
        at += got;
        n -= (size_t)got;
    }
    return 0;
}

void
rows_rest(struct rows *r)
{
    if (r->fd >= 0)
        close(r->fd);
    r->fd = -1;
}

void
rows_remove(struct rows *r)
{
    rows_rest(r);
    unlink(r->path);
    r->dirty = false;
}

/* A file that gets its name when it is whole. */
struct whole_file {
    char tmp[ROWS_PATH_MAX + 8];
    const char *path;
    FILE *f;
};

static int
whole_open(struct whole_file *w, const char *path, struct rad_error *err)
{
    w->path = path;
    if (snprintf(w->tmp, sizeof w->tmp, "%s.tmp", path) >= (int)sizeof w->tmp)
        return rad_fail(err, RAD_ECANTCREAT, "path too long: '%s'", path);
    w->f = fopen(w->tmp, "we");
    if (!w->f)
        return rad_fail(err, RAD_ECANTCREAT, "cannot create '%s': %s", w->tmp,
                        strerror(errno));
    return 0;
}

static int
whole_write(void *arg, const void *data, size_t len, struct rad_error *err)
{
    struct whole_file *w = arg;

    if (fwrite(data, 1, len, w->f) != len)
        return rad_fail(err, RAD_EIO, "cannot write '%s': %s", w->tmp,
                        strerror(errno));
    return 0;
}

/* Close and name it, or drop it if rc says that writing failed. */
static int
whole_close(struct whole_file *w, int rc, bool durable, struct rad_error *err)
{
    if (rc == 0 && (fflush(w->f) || (durable && fsync(fileno(w->f)) < 0)))
        rc = rad_fail(err, RAD_EIO, "cannot write '%s': %s", w->tmp,
                      strerror(errno));
    fclose(w->f);
    if (rc == 0 && rename(w->tmp, w->path) < 0)
        rc = rad_fail(err, RAD_EIO, "cannot rename to '%s': %s", w->path,
                      strerror(errno));
    if (rc < 0)
        unlink(w->tmp);
    return rc;
}

static int
encode_rows(struct rows *r, const struct rad_sink *sink, float *pixels,
            struct rad_rgb *line, uint8_t *code, struct rad_error *err)
{
    for (int y = 0; y < r->height; y++) {
        int rc = rows_read(r, y, pixels, err);

        for (int x = 0; x < r->width; x++) {
            const float *p = pixels + (size_t)x * (size_t)r->channels;

            line[x] = rad_rgb(p[0], p[1], p[2]);
        }
        if (rc == 0)
            rc = sink->write(sink->arg, code,
                             rad_hdr_encode_row(line, r->width, code), err);
        if (rc < 0)
            return rc;
    }
    return 0;
}

int
rows_picture(struct rows *r, const struct rad_hdr_info *info, const char *path,
             bool durable, struct rad_error *err)
{
    struct whole_file w;
    struct rad_sink sink = { whole_write, &w };
    float *pixels = malloc(row_bytes(r, r->width));
    struct rad_rgb *line = calloc((size_t)r->width, sizeof *line);
    uint8_t *code = malloc(RAD_HDR_ROW_BYTES(r->width));
    int rc;

    if (!pixels || !line || !code)
        rc = rad_fail(err, RAD_ENOMEM, "out of memory");
    else
        rc = whole_open(&w, path, err);
    if (rc == 0) {
        rc = rad_hdr_write_header(info, &sink, err);
        if (rc == 0)
            rc = encode_rows(r, &sink, pixels, line, code, err);
        rc = whole_close(&w, rc, durable, err);
    }
    free(pixels);
    free(line);
    free(code);
    return rc;
}

int
rows_depth(struct rows *r, const char *path, bool durable,
           struct rad_error *err)
{
    struct whole_file w;
    float *pixels;
    int rc;

    if (r->channels != 4)
        return rad_fail(err, RAD_EDATA, "the job has no depth");
    pixels = malloc(row_bytes(r, r->width));
    if (!pixels)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    rc = whole_open(&w, path, err);
    if (rc < 0) {
        free(pixels);
        return rc;
    }
    for (int y = 0; y < r->height && rc == 0; y++) {
        rc = rows_read(r, y, pixels, err);
        for (int x = 0; x < r->width; x++)
            pixels[x] = pixels[4 * (size_t)x + 3];
        if (rc == 0)
            rc =
                whole_write(&w, pixels, (size_t)r->width * sizeof *pixels, err);
    }
    rc = whole_close(&w, rc, durable, err);
    free(pixels);
    return rc;
}
