/* rows_picture.c - pictures and distances of the rows of a file */
#include "config.h"

#include "folder/rows.h"

#include "image/filter.h"

#include <stdlib.h>

/* Coded bytes that are copied at a time, unless a single row has more. */
#define COPY_BYTES (64u << 10)

static int
encode_rows(struct rows *r, const struct rad_sink *sink, struct rad_error *err)
{
    uint8_t *rgbe = malloc(4 * (size_t)r->width);
    void *work = malloc(ROWS_WORK_BYTES(r->width));
    uint8_t *code = malloc(RAD_HDR_ROW_BYTES(r->width));
    int rc = 0;

    if (!rgbe || !work || !code)
        rc = rad_fail_memory(err);
    for (int y = 0; y < r->height && rc == 0; y++) {
        rc = rows_read_rgbe(r, y, rgbe, work, err);
        if (rc == 0)
            rc = sink->write(sink->arg, code,
                             rad_hdr_encode_rgbe(rgbe, r->width, code), err);
    }
    free(rgbe);
    free(work);
    free(code);
    return rc;
}

/* Coded rows that are copied. */
struct copier {
    struct rows *rows;
    const struct rad_sink *sink;
    uint8_t *code;  /* room for them */
    uint8_t *black; /* a black row, of nblack bytes */
    size_t nblack;
};

/* Copy rows from row y on that lie one behind the other; a row that has not
 * come is black.  Returns the number of rows, or a code. */
static int
copy_rows(const struct copier *c, int y, struct rad_error *err)
{
    struct rows *r = c->rows;
    const struct rows_place *p = r->place ? &r->place[y] : NULL;
    size_t n = p ? p->n : 0;
    int k = 1, rc;

    if (n == 0) {
        rc = c->sink->write(c->sink->arg, c->black, c->nblack, err);
        return rc < 0 ? rc : 1;
    }
    for (; y + k < r->height && p[k].n > 0 && p[k].at == p[0].at + n &&
           n + p[k].n <= COPY_BYTES;
         k++)
        n += p[k].n;
    rc = rows_use(r, err);
    if (rc == 0)
        rc = disk_read_at(r->fd, c->code, n, (off_t)p->at, r->path, err);
    if (rc == 0)
        rc = c->sink->write(c->sink->arg, c->code, n, err);
    return rc < 0 ? rc : k;
}

static int
copy_coded(struct rows *r, const struct rad_sink *sink, struct rad_error *err)
{
    size_t room = RAD_HDR_ROW_BYTES(r->width);
    struct copier c = { r, sink, malloc(COPY_BYTES + room), malloc(room), 0 };
    struct rad_rgb *line = calloc((size_t)r->width, sizeof *line);
    int rc = 0;

    if (!c.code || !c.black || !line) {
        rc = rad_fail_memory(err);
    } else {
        c.nblack = rad_hdr_encode_row(line, r->width, c.black);
        for (int y = 0; y < r->height && rc >= 0; y += rc)
            rc = copy_rows(&c, y, err);
    }
    free(c.code);
    free(c.black);
    free(line);
    return rc < 0 ? rc : 0;
}

int
rows_close_picture(struct rows *r, struct disk_file *w, int rc, bool durable,
                   struct rad_error *err)
{
    rc = disk_file_close(w, rc, err);
    if (rc == 0 && durable)
        rc = syncs_add(&r->among->closed, w->path, true, err);
    return rc;
}

int
rows_picture(struct rows *r, const struct rad_hdr_info *info,
             const struct rows_output *out, struct rad_error *err)
{
    struct disk_file w;
    struct rad_sink sink = { disk_file_write, &w };
    int rc = disk_file_open(&w, out->path, out->mark, err);

    if (rc < 0)
        return rc;
    rc = rad_hdr_write_header(info, &sink, err);
    if (rc == 0)
        rc = r->kind == ROWS_CODED && !r->coarse ? copy_coded(r, &sink, err)
                                                 : encode_rows(r, &sink, err);
    return rows_close_picture(r, &w, rc, out->durable, err);
}

/* Reduce a row of samples, in place, to the distances of its pixels. */
static void
thin_out(const struct rows *r, int oversample, int width, float *samples)
{
    for (int x = 0; x < width; x++) {
        int at = rad_filter_middle(r->width, oversample, x);

        samples[x] = samples[4 * (size_t)at + 3];
    }
}

int
rows_depth(struct rows *r, int oversample, bool whole,
           const struct rows_output *out, struct rad_error *err)
{
    int width = rad_filter_side(r->width, oversample);
    int height = rad_filter_side(r->height, oversample), rc;
    size_t n = (size_t)width * (whole ? 4 : 1);
    struct disk_file w;
    float *pixels;

    if (r->kind != ROWS_DISTANCES)
        return rad_fail(err, RAD_EDATA, "the job has no depth");
    pixels = malloc(rows_bytes(r, r->width));
    if (!pixels)
        return rad_fail_memory(err);
    rc = disk_file_open(&w, out->path, out->mark, err);
    if (rc < 0) {
        free(pixels);
        return rc;
    }
    for (int y = 0; y < height && rc == 0; y++) {
        rc = rows_read(r, rad_filter_middle(r->height, oversample, y), pixels,
                       err);
        if (!whole)
            thin_out(r, oversample, width, pixels);
        if (rc == 0)
            rc = disk_file_write(&w, pixels, n * sizeof *pixels, err);
    }
    rc = rows_close_picture(r, &w, rc, out->durable, err);
    free(pixels);
    return rc;
}
