/* filtered.c - see filtered.h */
#include "config.h"

#include "folder/filtered.h"

#include "machine/jobtext.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static_assert(MSG_MAX_OVERSAMPLE == RAD_MAX_OVERSAMPLE, "one range");

#define ALL_AROUND (360 - 1e-6) /* degrees */

int
filtered_shape(struct rad_filter_shape *s, int width, int height,
               int oversample, double clamp, const char *view,
               struct rad_error *err)
{
    struct rad_view v;
    int rc = jobtext_view(view, &v, err);

    if (rc < 0)
        return rc;
    *s = (struct rad_filter_shape){ .width = width,
                                    .height = height,
                                    .oversample = oversample,
                                    .clamp = clamp,
                                    .around = v.type == 'c' &&
                                              v.horiz >= ALL_AROUND };
    return 0;
}

/* Memory that filtering works in. */
struct workplace {
    struct rad_filter *filter;
    uint8_t *rgbe;       /* a row of samples */
    void *work;          /* for rows_read_rgbe() */
    struct rad_rgb *row; /* of pixels */
    struct rad_edge *edge;
    uint8_t *code;
};

static void
release(struct workplace *p)
{
    rad_filter_free(p->filter);
    free(p->rgbe);
    free(p->work);
    free(p->row);
    free(p->edge);
    free(p->code);
}

static int
prepare(struct workplace *p, const struct rad_filter_shape *s, int width,
        struct rad_error *err)
{
    size_t samples = (size_t)s->width;

    *p = (struct workplace){
        .rgbe = malloc(4 * samples),
        .work = malloc(ROWS_WORK_BYTES(samples)),
        .row = malloc((size_t)width * sizeof *p->row),
        .edge = malloc((size_t)width * sizeof *p->edge),
        .code = malloc(RAD_HDR_ROW_BYTES(width) + RAD_EDGE_ROW_BYTES(width)),
    };
    if (!p->rgbe || !p->work || !p->row || !p->edge || !p->code)
        return rad_fail_memory(err);
    return rad_filter_new(&p->filter, s, err);
}

/* Write for each pixel the sample nearest to its middle. */
static int
pick_rows(struct rows *r, const struct rad_filter_shape *s, struct workplace *p,
          const struct rad_hdr_info *info, const struct rad_sink *sink,
          struct rad_error *err)
{
    int n = s->oversample, rc = 0;

    for (int y = 0; y < info->height && rc == 0; y++) {
        rc = rows_read_rgbe(r, rad_filter_middle(s->height, n, y), p->rgbe,
                            p->work, err);
        for (int x = 0; x < info->width; x++)
            memmove(p->rgbe + 4 * (size_t)x,
                    p->rgbe + 4 * (size_t)rad_filter_middle(s->width, n, x), 4);
        if (rc == 0)
            rc = sink->write(
                sink->arg, p->code,
                rad_hdr_encode_rgbe(p->rgbe, info->width, p->code), err);
    }
    return rc;
}

static int
filter_rows(struct rows *r, struct workplace *p, int width,
            const struct rad_sink *sink, struct rad_error *err)
{
    int rc = 0;

    for (int y = 0; y < r->height && rc == 0; y++) {
        rc = rows_read_rgbe(r, y, p->rgbe, p->work, err);
        if (rc == 0)
            rad_filter_push(p->filter, p->rgbe);
        while (rc == 0 && rad_filter_pull(p->filter, p->row))
            rc = sink->write(sink->arg, p->code,
                             rad_hdr_encode_row(p->row, width, p->code), err);
    }
    return rc;
}

/* Write what meets within the pixels.  The rows are filtered once more, since
 * all of a picture's pixels come before its edges. */
static int
filter_edges(struct rows *r, const struct rad_filter_shape *s,
             struct workplace *p, const struct rad_sink *sink,
             struct rad_error *err)
{
    uint64_t bytes = 0;
    int rc, n;

    rad_filter_free(p->filter);
    rc = rad_filter_new_edges(&p->filter, s, err);
    for (int y = 0; y < r->height && rc == 0; y++) {
        rc = rows_read_rgbe(r, y, p->rgbe, p->work, err);
        if (rc == 0)
            rad_filter_push(p->filter, p->rgbe);
        while (rc == 0 &&
               (n = rad_filter_pull_edges(p->filter, p->edge)) >= 0) {
            size_t row = rad_edge_encode_row(p->edge, n, p->code);

            bytes += row;
            rc = sink->write(sink->arg, p->code, row, err);
        }
    }
    if (rc < 0)
        return rc;
    rad_edge_encode_end(bytes, p->code);
    return sink->write(sink->arg, p->code, RAD_EDGE_END_BYTES, err);
}

int
filtered_picture(struct rows *r, const struct rad_filter_shape *s,
                 const struct rad_hdr_info *info, const struct rows_output *out,
                 struct rad_error *err)
{
    double times = out->edges ? 2 : 1; /* that samples are filtered */
    bool pick = out->preview && times * s->width * s->height > FILTERED_PREVIEW;
    struct disk_file w;
    struct rad_sink sink = { disk_file_write, &w };
    struct workplace p;
    int rc = prepare(&p, s, info->width, err);

    if (rc == 0)
        rc = disk_file_open(&w, out->path, out->mark, err);
    if (rc == 0) {
        rc = rad_hdr_write_header(info, &sink, err);
        if (rc == 0)
            rc = pick ? pick_rows(r, s, &p, info, &sink, err)
                      : filter_rows(r, &p, info->width, &sink, err);
        if (rc == 0 && out->edges && !pick)
            rc = filter_edges(r, s, &p, &sink, err);
        rc = rows_close_picture(r, &w, rc, out->durable, err);
    }
    release(&p);
    return rc;
}
