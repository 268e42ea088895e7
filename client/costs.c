/* costs.c - see costs.h */
#include "config.h"

#include "costs.h"

#include "base/files.h"
#include "picture/quincunx.h"

#include <jansson.h>
#include <stdlib.h>
#include <string.h>

enum { LONGEST = 512 << 20 /* bytes of statistics */ };

/* No more could be sent; and all of them are kept. */
#define MOST_ROWS ((uint64_t)MSG_MAX_COSTS * RAD_QUINCUNX_MAX_YSTEP)

/* Seconds beyond all doubt, and far from what a float cannot hold. */
#define MOST_CPU_S 1e15

/* One unit as the file has it. */
struct unit {
    json_int_t frame, x, y, width, height;
    double rays, cpu_s;
};

static int
no_memory(struct rad_error *err)
{
    return rad_fail(err, RAD_ENOMEM, "out of memory");
}

static int
unpack_unit(const json_t *json, struct unit *u, struct rad_error *err)
{
    json_int_t rays;

    if (json_unpack((json_t *)json, "{s:I,s:I,s:I,s:I,s:I,s:I,s:F}", "frame",
                    &u->frame, "x", &u->x, "y", &u->y, "width", &u->width,
                    "height", &u->height, "rays", &rays, "cpu_s",
                    &u->cpu_s) != 0)
        return rad_fail(err, RAD_EDATA, "no statistics: a unit lacks a number");
    u->rays = (double)rays;
    if (u->frame < 0 || u->x < 0 || u->y < 0 || u->width < 1 || u->height < 1 ||
        u->width > MSG_MAX_SIDE || u->height > MSG_MAX_SIDE ||
        u->x > MSG_MAX_SIDE - u->width || u->y > MSG_MAX_SIDE - u->height ||
        rays < 0 || !(u->cpu_s >= 0 && u->cpu_s <= MOST_CPU_S))
        return rad_fail(err, RAD_EDATA, "no statistics: an impossible unit");
    return 0;
}

/* ystep from the former job's rendering options. */
static int
read_ystep(const char *options, int *ystep, struct rad_error *err)
{
    const char *at = strstr(options, "-ps ");
    char *end;
    long psample;
    int xstep;

    if (!at || (at > options && at[-1] != ' '))
        return rad_fail(err, RAD_EDATA, "no statistics: no -ps in its options");
    psample = strtol(at + 4, &end, 10);
    if (end == at + 4 || psample < 1 || psample > 16)
        return rad_fail(err, RAD_EDATA, "no statistics: a wrong -ps");
    rad_quincunx_steps((int)psample, &xstep, ystep);
    return 0;
}

/* The frame of a unit; numbers of frames count on from the first. */
static struct costs_frame *
frame_of(const struct costs *c, json_int_t first, json_int_t number)
{
    if (number - first >= (json_int_t)c->nframes)
        return NULL;
    return &c->frames[number - first];
}

/* Frames are as large as their units reach; pixels[k] is how many the units
 * of frame k have. */
static int
measure_frames(struct costs *c, const struct unit *u, size_t n,
               json_int_t first, uint64_t *pixels, struct rad_error *err)
{
    for (size_t i = 0; i < n; i++) {
        struct costs_frame *f = frame_of(c, first, u[i].frame);

        if (!f)
            return rad_fail(err, RAD_EDATA,
                            "no statistics: a unit of frame %lld, after %u "
                            "from %lld",
                            (long long)u[i].frame, c->nframes,
                            (long long)first);
        if (u[i].x + u[i].width > f->width)
            f->width = (uint32_t)(u[i].x + u[i].width);
        if (u[i].y + u[i].height > f->height)
            f->height = (uint32_t)(u[i].y + u[i].height);
        pixels[f - c->frames] += (uint64_t)u[i].width * (uint64_t)u[i].height;
    }
    return 0;
}

/* Each frame must have as many pixels as its units. */
static int
make_rows(struct costs *c, const uint64_t *pixels, struct rad_error *err)
{
    uint64_t rows = 0;

    for (uint32_t k = 0; k < c->nframes; k++) {
        struct costs_frame *f = &c->frames[k];

        if (pixels[k] == 0 || pixels[k] != (uint64_t)f->width * f->height)
            return rad_fail(err, RAD_EDATA,
                            "statistics of a job that was not done");
        rows += f->height;
        if (rows > MOST_ROWS)
            return rad_fail(err, RAD_EDATA, "statistics of too many rows");
        f->row = calloc(f->height, sizeof *f->row);
        if (!f->row)
            return no_memory(err);
    }
    return 0;
}

/* By rays as soon as one unit has no time, so that all count the same. */
static void
spread(struct costs *c, const struct unit *u, size_t n, json_int_t first)
{
    bool by_rays = false;

    for (size_t i = 0; i < n; i++)
        by_rays |= u[i].cpu_s == 0;
    for (size_t i = 0; i < n; i++) {
        struct costs_frame *f = frame_of(c, first, u[i].frame);
        double cost = by_rays ? u[i].rays : u[i].cpu_s;

        for (json_int_t y = u[i].y; y < u[i].y + u[i].height; y++)
            f->row[y] += cost / (double)u[i].height;
    }
}

static int
take_units(struct costs *c, const struct unit *u, size_t n,
           struct rad_error *err)
{
    uint64_t *pixels = calloc(c->nframes, sizeof *pixels);
    json_int_t first = n > 0 ? u[0].frame : 0;
    int rc;

    for (size_t i = 0; i < n; i++)
        if (u[i].frame < first)
            first = u[i].frame;
    c->frames = calloc(c->nframes, sizeof *c->frames);
    rc = pixels && c->frames ? 0 : no_memory(err);
    if (rc == 0)
        rc = measure_frames(c, u, n, first, pixels, err);
    if (rc == 0)
        rc = make_rows(c, pixels, err);
    if (rc == 0)
        spread(c, u, n, first);
    free(pixels);
    return rc;
}

static int
take_list(struct costs *c, const json_t *list, struct rad_error *err)
{
    size_t n = json_array_size(list);
    struct unit *u = calloc(n + 1, sizeof *u);
    int rc = u ? 0 : no_memory(err);

    for (size_t i = 0; i < n && rc == 0; i++)
        rc = unpack_unit(json_array_get(list, i), &u[i], err);
    if (rc == 0)
        rc = take_units(c, u, n, err);
    free(u);
    return rc;
}

static int
take_root(struct costs *c, const json_t *root, struct rad_error *err)
{
    const char *options;
    json_t *units;
    int frames, rc;

    if (json_unpack((json_t *)root, "{s:s,s:{s:i},s:o}", "options", &options,
                    "picture", "frames", &frames, "units", &units) != 0 ||
        !json_is_array(units))
        return rad_fail(err, RAD_EDATA,
                        "no statistics: it lacks options, picture or units");
    if (frames < 1 || frames > MSG_MAX_FRAMES)
        return rad_fail(err, RAD_EDATA, "no statistics: %d frames", frames);
    c->nframes = (uint32_t)frames;
    if ((rc = read_ystep(options, &c->ystep, err)) < 0)
        return rc;
    return take_list(c, units, err);
}

int
costs_parse(struct costs *c, const char *text, size_t len,
            struct rad_error *err)
{
    json_error_t what;
    json_t *root;
    int rc;

    memset(c, 0, sizeof *c);
    root = json_loadb(text, len, 0, &what);
    if (!root)
        return rad_fail(err, RAD_EDATA, "line %d: no statistics: %s", what.line,
                        what.text);
    rc = take_root(c, root, err);
    json_decref(root);
    return rc;
}

int
costs_read(struct costs *c, const char *path, struct rad_error *err)
{
    size_t len;
    unsigned char *text;
    int rc;

    memset(c, 0, sizeof *c);
    text = rad_file_read(path, LONGEST, &len, err);
    if (!text)
        return err->code;
    rc = costs_parse(c, (const char *)text, len, err);
    if (rc < 0)
        rad_error_where(err, "%s", path);
    free(text);
    return rc;
}

void
costs_release(struct costs *c)
{
    for (uint32_t k = 0; c->frames && k < c->nframes; k++)
        free(c->frames[k].row);
    free(c->frames);
    memset(c, 0, sizeof *c);
}

static struct rad_quincunx
sampler_of(const struct msg_frame *f, int psample)
{
    struct rad_quincunx q = { .width = (int)f->width,
                              .height = (int)f->height };

    rad_quincunx_steps(psample, &q.xstep, &q.ystep);
    return q;
}

/* Is it the same picture, as far as its lines are concerned? */
static int
check_fit(const struct costs *c, const struct msg_frame *frames,
          uint32_t nframes, int psample, struct rad_error *err)
{
    int xstep, ystep;

    rad_quincunx_steps(psample, &xstep, &ystep);
    if (c->nframes != nframes)
        return rad_fail(err, RAD_EDATA, "statistics of %u frames, not %u",
                        c->nframes, nframes);
    for (uint32_t k = 0; k < nframes; k++)
        if (c->frames[k].width != frames[k].width ||
            c->frames[k].height != frames[k].height)
            return rad_fail(err, RAD_EDATA,
                            "statistics of %u by %u pixels, not %u by %u",
                            c->frames[k].width, c->frames[k].height,
                            frames[k].width, frames[k].height);
    if (c->ystep != ystep)
        return rad_fail(err, RAD_EDATA,
                        "statistics with another -ps: base lines are %d rows "
                        "apart, not %d",
                        c->ystep, ystep);
    return 0;
}

static uint64_t
count_lines(const struct msg_frame *frames, uint32_t nframes, int psample)
{
    uint64_t n = 0;

    for (uint32_t k = 0; k < nframes; k++) {
        struct rad_quincunx q = sampler_of(&frames[k], psample);

        n += (uint64_t)rad_quincunx_nbases(&q);
    }
    return n;
}

/* One frame's lines, appended at `to`; returns the end. */
static uint8_t *
put_frame(uint8_t *to, const struct costs_frame *f,
          const struct rad_quincunx *q)
{
    int lines = rad_quincunx_nbases(q), row = 0;

    for (int i = 0; i < lines; i++, to += sizeof(float)) {
        double sum = 0;
        float cost;

        for (; row <= rad_quincunx_base_row(q, i); row++)
            sum += f->row[row];
        cost = (float)sum;
        wire_floats_put(to, &cost, 1);
    }
    return to;
}

int
costs_of_lines(const struct costs *c, const struct msg_frame *frames,
               uint32_t nframes, int psample, uint8_t **bytes, uint32_t *n,
               struct rad_error *err)
{
    uint64_t lines = count_lines(frames, nframes, psample);
    int rc = check_fit(c, frames, nframes, psample, err);
    uint8_t *to;

    if (rc < 0)
        return rc;
    if (lines > MSG_MAX_COSTS)
        return rad_fail(err, RAD_EUSAGE,
                        "a statistics file serves pictures of at most %d base "
                        "lines, not %llu",
                        MSG_MAX_COSTS, (unsigned long long)lines);
    *bytes = to = malloc(lines * sizeof(float));
    if (!to)
        return no_memory(err);
    for (uint32_t k = 0; k < nframes; k++) {
        struct rad_quincunx q = sampler_of(&frames[k], psample);

        to = put_frame(to, &c->frames[k], &q);
    }
    *n = (uint32_t)lines;
    return 0;
}
