/* rows.c - see rows.h; rows_picture.c makes pictures of rows */
#include "config.h"

#include "folder/rows.h"

#include "folder/coarse.h"
#include "machine/rowsum.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

/* Bytes of pixels to which coded rows are decoded at a time, unless a single
 * row has more: code may stand for a hundred times its own bytes. */
#define DECODE_BYTES (256u << 10)

size_t
rows_bytes(const struct rows *r, int w)
{
    if (r->kind == ROWS_RGBE)
        return 4 * (size_t)w;
    return (size_t)w * (size_t)r->kind * sizeof(float);
}

/* Set *r to a closed file of that name and form. */
static int
describe(struct rows *r, struct rows_open *among, const char *path,
         struct rows_form form, struct rad_error *err)
{
    memset(r, 0, sizeof *r);
    r->among = among;
    r->fd = -1;
    if (strlen(path) >= sizeof r->path)
        return rad_fail(err, RAD_ECANTCREAT, "path too long: '%s'", path);
    memcpy(r->path, path, strlen(path) + 1);
    r->width = form.width;
    r->height = form.height;
    r->kind = form.kind;
    r->durable = form.durable;
    return 0;
}

/* Bytes of all pixels; 0 for coded rows, whose length is not known before. */
static off_t
pixels_size(const struct rows *r)
{
    if (r->kind == ROWS_CODED)
        return 0;
    return (off_t)rows_bytes(r, r->width) * r->height;
}

static off_t
pixel_at(const struct rows *r, int x, int y)
{
    return (off_t)rows_bytes(r, r->width) * y + (off_t)rows_bytes(r, x);
}

static off_t
line_at(const struct rows *r, int y)
{
    return pixels_size(r) + (off_t)ROWS_LINE_BYTES(r->width) * y;
}

static off_t
whole_size(const struct rows *r)
{
    return r->kind == ROWS_RGBE ? line_at(r, r->height) : pixels_size(r);
}

/* --- open files --- */

/* Close the file, and take it from the list of open files. */
static void
close_one(struct rows *r)
{
    struct rows **v = r->among->file;
    int i = 0;

    if (r->fd < 0)
        return;
    while (v[i] != r)
        i++;
    memmove(v + i, v + i + 1, (ROWS_OPEN - 1 - (size_t)i) * sizeof *v);
    v[ROWS_OPEN - 1] = NULL;
    close(r->fd);
    r->fd = -1;
}

static int
sync_one(struct rows *r, struct rad_error *err)
{
    int rc = r->dirty ? disk_sync_data(r->fd, r->path, err) : 0;

    r->dirty = false;
    return rc;
}

/* Put an opened file first in the list; if that is full close the file that was
 * used the longest time ago. */
static int
note_open(struct rows *r, int fd, struct rad_error *err)
{
    struct rows **v = r->among->file, *oldest = v[ROWS_OPEN - 1];
    int rc = 0;

    if (oldest && oldest->durable && oldest->dirty)
        rc = syncs_add(&r->among->closed, oldest->path, false, err);
    if (rc < 0) { /* the oldest stays, and is synced as it is */
        close(fd);
        return rc;
    }
    if (oldest) {
        oldest->dirty = false;
        close_one(oldest);
    }
    memmove(v + 1, v, (ROWS_OPEN - 1) * sizeof *v);
    v[0] = r;
    r->fd = fd;
    return 0;
}

int
rows_use(struct rows *r, struct rad_error *err)
{
    struct rows **v = r->among->file;
    int i = 0, fd;

    if (r->fd < 0) {
        fd = open(r->path, O_RDWR | O_CLOEXEC);
        return fd < 0 ? disk_fail(err, errno, "open", r->path)
                      : note_open(r, fd, err);
    }
    while (v[i] != r)
        i++;
    memmove(v + 1, v, (size_t)i * sizeof *v);
    v[0] = r;
    return 0;
}

int
rows_sync(struct rows_open *among, struct rad_error *err)
{
    int rc = 0;

    for (int i = 0; i < ROWS_OPEN && among->file[i]; i++)
        if (among->file[i]->dirty)
            syncs_begin(among->file[i]->fd);
    if (among->closed.n > 0)
        rc = syncs_settle(&among->closed, err);
    for (int i = 0; i < ROWS_OPEN && among->file[i] && rc == 0; i++)
        rc = sync_one(among->file[i], err);
    return rc;
}

/* --- files --- */

static int
make_room(const struct rows *r, int fd, struct rad_error *err)
{
    int rc = r->durable ? disk_allocate(fd, pixels_size(r), r->path, err) : 0;

    if (rc == 0 && ftruncate(fd, whole_size(r)) < 0)
        rc = disk_fail(err, errno, "make room for", r->path);
    return rc;
}

int
rows_create(struct rows *r, struct rows_open *among, const char *path,
            struct rows_form form, struct rad_error *err)
{
    int rc = describe(r, among, path, form, err), fd;

    if (rc < 0)
        return rc;
    if (r->durable && r->kind == ROWS_CODED)
        return rad_fail(err, RAD_EINTERNAL, "coded rows do not last");
    fd = open(path, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (fd < 0)
        return disk_fail(err, errno, "create", path);
    rc = make_room(r, fd, err);
    close(fd);
    if (rc < 0)
        unlink(r->path);
    return rc;
}

int
rows_open(struct rows *r, struct rows_open *among, const char *path,
          struct rows_form form, struct rad_error *err)
{
    int rc = describe(r, among, path, form, err);
    struct stat st;

    if (rc < 0)
        return rc;
    if (stat(path, &st) < 0 || access(path, R_OK | W_OK) < 0)
        return mark_missing(path, errno, err);
    if (!S_ISREG(st.st_mode) || st.st_size != whole_size(r))
        return rad_fail(err, RAD_EDATA,
                        "rows '%s' have %lld bytes, expected %lld", path,
                        (long long)st.st_size, (long long)whole_size(r));
    return 0;
}

static int
check_place(const struct rows *r, struct rows_area a, struct rad_error *err)
{
    if (a.x >= 0 && a.y >= 0 && a.w >= 1 && a.h >= 1 && a.w <= r->width - a.x &&
        a.h <= r->height - a.y)
        return 0;
    return rad_fail(err, RAD_EPROTO,
                    "pixels %d,%d %dx%d do not lie in a picture of %dx%d", a.x,
                    a.y, a.w, a.h, r->width, r->height);
}

int
rows_write(struct rows *r, struct rows_area a, const void *pixels,
           struct rad_error *err)
{
    size_t bytes = rows_bytes(r, a.w);
    int step = a.h, rc = check_place(r, a, err);

    if (rc == 0)
        rc = rows_use(r, err);
    r->dirty |= rc == 0;
    if (a.w < r->width) /* not contiguous in the file */
        step = 1;
    for (int k = 0; k < a.h && rc == 0; k += step)
        rc = disk_write_at(r->fd, (const char *)pixels + bytes * (size_t)k,
                           bytes * (size_t)step, pixel_at(r, a.x, a.y + k),
                           r->path, err);
    if (rc == 0 && r->coarse)
        coarse_mark(r->coarse, a.x, a.y, a.w, a.h);
    return rc;
}

static int
damaged(int h, struct rad_error *err)
{
    return rad_fail(err, RAD_EPROTO, "%d coded rows are damaged", h);
}

/* Note the places of coded rows that are going to be written at the file's end.
 */
static int
place_rows(struct rows *r, int y, int h, struct rows_code code,
           struct rad_error *err)
{
    size_t at = 0;

    if (!r->place)
        r->place = calloc((size_t)r->height, sizeof *r->place);
    if (!r->place)
        return rad_fail_memory(err);
    for (int k = 0; k < h; k++) {
        size_t row = rad_hdr_row_bytes(code.bytes + at, code.n - at, r->width);

        if (row == 0 || row > RAD_HDR_CODED_BYTES(r->width))
            break;
        r->place[y + k] = (struct rows_place){ r->end + at, row };
        at += row;
        if (k + 1 == h && at == code.n)
            return 0;
    }
    memset(r->place + y, 0, (size_t)h * sizeof *r->place);
    return damaged(h, err);
}

static int
append_coded(struct rows *r, int y, int h, struct rows_code code,
             struct rad_error *err)
{
    int rc = rows_use(r, err);

    if (rc == 0)
        rc = place_rows(r, y, h, code, err);
    if (rc == 0)
        rc = disk_write_at(r->fd, code.bytes, code.n, (off_t)r->end, r->path,
                           err);
    if (rc < 0)
        return rc;
    r->end += code.n;
    if (r->coarse)
        coarse_mark(r->coarse, 0, y, r->width, h);
    return 0;
}

/* Is the code exactly h rows of w pixels? */
static int
check_code(int w, int h, struct rows_code code, struct rad_error *err)
{
    size_t at = 0;

    for (int k = 0; k < h; k++) {
        size_t row = rad_hdr_row_bytes(code.bytes + at, code.n - at, w);

        if (row == 0)
            return damaged(h, err);
        at += row;
    }
    return at == code.n ? 0 : damaged(h, err);
}

/* Decode h rows of w pixels to rgbe; *code moves on to the rows behind them. */
static int
decode_rows(int w, int h, struct rows_code *code, uint8_t *rgbe,
            struct rad_error *err)
{
    for (int k = 0; k < h; k++) {
        size_t row = rad_hdr_decode_row(code->bytes, code->n, w,
                                        rgbe + 4 * (size_t)w * (size_t)k);

        if (row == 0)
            return damaged(h, err);
        code->bytes += row;
        code->n -= row;
    }
    return 0;
}

/* Decode and write a few rows at a time; if the disk fails, earlier rows are
 * written. */
static int
write_decoded(struct rows *r, struct rows_area a, struct rows_code code,
              uint64_t *sum, struct rad_error *err)
{
    size_t bytes = rows_bytes(r, a.w);
    int most = bytes < DECODE_BYTES ? (int)(DECODE_BYTES / bytes) : 1, rc = 0;
    uint8_t *rgbe = malloc(bytes * (size_t)(a.h < most ? a.h : most));
    uint64_t all = 0;

    if (!rgbe)
        return rad_fail_memory(err);
    for (int left = a.h; left > 0 && rc == 0; left -= most) {
        a.h = left < most ? left : most;
        rc = decode_rows(a.w, a.h, &code, rgbe, err);
        if (rc == 0)
            rc = rows_write(r, a, rgbe, err);
        if (rc == 0 && sum)
            all ^= rowsum(rgbe, bytes, (uint32_t)a.y, (uint32_t)a.h);
        a.y += a.h;
    }
    if (rc == 0 && sum)
        *sum = all;
    free(rgbe);
    return rc;
}

int
rows_write_coded(struct rows *r, struct rows_area a, struct rows_code code,
                 uint64_t *sum, struct rad_error *err)
{
    int rc = check_place(r, a, err);

    if (rc < 0)
        return rc;
    if (r->kind == ROWS_CODED && a.w == r->width)
        return append_coded(r, a.y, a.h, code, err);
    if (r->kind != ROWS_RGBE)
        return rad_fail(err, RAD_EPROTO, "no coded rows are wanted");
    rc = check_code(a.w, a.h, code, err);
    if (rc == 0)
        rc = write_decoded(r, a, code, sum, err);
    return rc;
}

/* Open the file for the line of row y; RAD_EDATA: no such line can be there. */
static int
use_line(struct rows *r, int y, struct rad_error *err)
{
    if (r->kind != ROWS_RGBE || y < 0 || y >= r->height)
        return rad_fail(err, RAD_EDATA, "there is no line of row %d", y);
    return rows_use(r, err);
}

int
rows_write_line(struct rows *r, int y, const float *line, struct rad_error *err)
{
    int rc = use_line(r, y, err);

    if (rc < 0)
        return rc;
    r->dirty = true;
    return disk_write_at(r->fd, line, ROWS_LINE_BYTES(r->width), line_at(r, y),
                         r->path, err);
}

int
rows_read_line(struct rows *r, int y, float *line, struct rad_error *err)
{
    int rc = use_line(r, y, err);

    if (rc < 0)
        return rc;
    return disk_read_at(r->fd, line, ROWS_LINE_BYTES(r->width), line_at(r, y),
                        r->path, err);
}

int
rows_read_part(struct rows *r, int x, int y, int w, void *pixels,
               struct rad_error *err)
{
    int rc;

    if (x < 0 || y < 0 || w < 1 || w > r->width - x || y >= r->height)
        return rad_fail(err, RAD_EDATA,
                        "pixels %d,%d %dx1 do not lie in a picture of %dx%d", x,
                        y, w, r->width, r->height);
    rc = rows_use(r, err);
    if (rc < 0)
        return rc;
    return disk_read_at(r->fd, pixels, rows_bytes(r, w), pixel_at(r, x, y),
                        r->path, err);
}

int
rows_read(struct rows *r, int y, void *pixels, struct rad_error *err)
{
    return rows_read_part(r, 0, y, r->width, pixels, err);
}

/* Read a coded row; a row that has not come is black. */
static int
read_coded(struct rows *r, int y, uint8_t *rgbe, uint8_t *code,
           struct rad_error *err)
{
    const struct rows_place *p = r->place ? &r->place[y] : NULL;
    int rc;

    if (!p || p->n == 0) {
        memset(rgbe, 0, 4 * (size_t)r->width);
        return 0;
    }
    rc = rows_use(r, err);
    if (rc == 0)
        rc = disk_read_at(r->fd, code, p->n, (off_t)p->at, r->path, err);
    if (rc == 0 && rad_hdr_decode_row(code, p->n, r->width, rgbe) != p->n)
        rc = damaged(1, err);
    return rc;
}

static int
read_rgbe(struct rows *r, int y, uint8_t *rgbe, void *work,
          struct rad_error *err)
{
    const float *p = work;
    int rc;

    if (r->kind == ROWS_CODED)
        return read_coded(r, y, rgbe, work, err);
    if (r->kind == ROWS_RGBE)
        return rows_read(r, y, rgbe, err);
    rc = rows_read(r, y, work, err);
    for (int x = 0; x < r->width && rc == 0; x++, p += r->kind)
        rad_rgbe(rad_rgb(p[0], p[1], p[2]), rgbe + 4 * (size_t)x);
    return rc;
}

int
rows_read_rgbe(struct rows *r, int y, uint8_t *rgbe, void *work,
               struct rad_error *err)
{
    int rc = read_rgbe(r, y, rgbe, work, err);

    if (rc == 0 && r->coarse)
        coarse_fill(r->coarse, y, rgbe);
    return rc;
}

void
rows_put_colours(struct rows *r, const struct action_colours *colours)
{
    size_t n = coarse_bytes(r->width, r->height);
    size_t *all = &r->among->coarse_bytes;

    if (!r->coarse && n <= COARSE_MOST - *all &&
        (r->coarse = coarse_new(r->width, r->height)))
        *all += n;
    if (r->coarse)
        coarse_put(r->coarse, colours);
}

void
rows_drop_colours(struct rows *r)
{
    if (r->coarse)
        r->among->coarse_bytes -= coarse_bytes(r->width, r->height);
    coarse_free(r->coarse);
    r->coarse = NULL;
}

void
rows_release(struct rows *r)
{
    rows_drop_colours(r);
    close_one(r);
    r->dirty = false;
    free(r->place);
    r->place = NULL;
    r->end = 0;
}

void
rows_remove(struct rows *r)
{
    rows_release(r);
    unlink(r->path);
}
