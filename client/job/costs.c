/* costs.c - see costs.h */
#include "config.h"

#include "job/costs.h"

#include "base/files.h"
#include "base/number.h"
#include "picture/quincunx.h"

#include <jansson.h>
#include <stdlib.h>
#include <string.h>

enum { LONGEST = 512 << 20 /* most bytes of a statistics file */ };

/* Most rows: no more lines could be sent, and the rows of all frames are in
 * memory. */
#define MOST_ROWS ((uint64_t)MSG_MAX_COSTS * RAD_QUINCUNX_MAX_YSTEP)

/* Far more seconds than any unit takes, and far below what a float can hold. */
#define MOST_CPU_S 1e15

/* A unit as the file has it. */
struct unit {
    json_int_t frame, x, y, width, height;
    double rays, cpu_s, start_s;
    double cost; /* cpu_s, or in all units rays */
    const char *worker;
};

/* All units of a job. */
struct units {
    struct unit *v;
    size_t n;
    json_int_t first; /* the least number of their frames */
};

/* Number of lines after a worker's first one; their median stands for the first
 * line's time with ambient records in the cache. */
enum { LINES_AFTER = 5 };

static int
unpack_unit(const json_t *json, struct unit *u, struct rad_error *err)
{
    json_int_t rays;

    u->worker = "";
    if (json_unpack((json_t *)json, "{s:I,s:I,s:I,s:I,s:I,s:I,s:F,s?F,s?s}",
                    "frame", &u->frame, "x", &u->x, "y", &u->y, "width",
                    &u->width, "height", &u->height, "rays", &rays, "cpu_s",
                    &u->cpu_s, "start_s", &u->start_s, "worker",
                    &u->worker) != 0)
        return rad_fail(err, RAD_EDATA, "no statistics: a unit lacks a number");
    u->rays = (double)rays;
    if (u->frame < 0 || u->x < 0 || u->y < 0 || u->width < 1 || u->height < 1 ||
        u->width > MSG_MAX_SIDE || u->height > MSG_MAX_SIDE ||
        u->x > MSG_MAX_SIDE - u->width || u->y > MSG_MAX_SIDE - u->height ||
        rays < 0 || !(u->cpu_s >= 0 && u->cpu_s <= MOST_CPU_S))
        return rad_fail(err, RAD_EDATA, "no statistics: an impossible unit");
    return 0;
}

/* The distance of base lines, by the former job's rendering options. */
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

/* The frame of unit i; NULL: out of range. */
static struct costs_frame *
frame_of(const struct costs *c, const struct units *u, size_t i)
{
    json_int_t k = u->v[i].frame - u->first;

    return k < (json_int_t)c->nframes ? &c->frames[k] : NULL;
}

/* Take the frames' sizes from the units that reach farthest.  pixels[k]: how
 * many pixels all units of frame k have. */
static int
measure_frames(struct costs *c, const struct units *all, uint64_t *pixels,
               struct rad_error *err)
{
    for (size_t i = 0; i < all->n; i++) {
        struct costs_frame *f = frame_of(c, all, i);
        const struct unit *u = &all->v[i];

        if (!f)
            return rad_fail(err, RAD_EDATA,
                            "no statistics: a unit of frame %lld, after %u "
                            "from %lld",
                            (long long)u->frame, c->nframes,
                            (long long)all->first);
        if (u->x + u->width > f->width)
            f->width = (uint32_t)(u->x + u->width);
        if (u->y + u->height > f->height)
            f->height = (uint32_t)(u->y + u->height);
        pixels[f - c->frames] += (uint64_t)u->width * (uint64_t)u->height;
    }
    return 0;
}

/* Check that each frame has as many pixels as its units together, and make its
 * rows. */
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
            return rad_fail_memory(err);
    }
    return 0;
}

/* Choose the cost of all units: processor time or, if any unit lacks it, rays.
 */
static void
weigh(const struct units *u)
{
    bool by_rays = false;

    for (size_t i = 0; i < u->n; i++)
        by_rays |= u->v[i].cpu_s == 0;
    for (size_t i = 0; i < u->n; i++)
        u->v[i].cost = by_rays ? u->v[i].rays : u->v[i].cpu_s;
}

static void
spread(struct costs *c, const struct units *all)
{
    for (size_t i = 0; i < all->n; i++) {
        struct costs_frame *f = frame_of(c, all, i);
        const struct unit *u = &all->v[i];

        for (json_int_t y = u->y; y < u->y + u->height; y++)
            f->row[y] += u->cost / (double)u->height;
    }
}

/* Keep the units of frames that have units narrower than the frame. */
static int
keep_windows(struct costs *c, const struct units *all, struct rad_error *err)
{
    for (size_t i = 0; i < all->n; i++) {
        struct costs_frame *f = frame_of(c, all, i);

        if (f->window || all->v[i].width == f->width)
            continue;
        f->window = calloc(all->n, sizeof *f->window);
        if (!f->window)
            return rad_fail_memory(err);
    }
    for (size_t i = 0; i < all->n; i++) {
        struct costs_frame *f = frame_of(c, all, i);
        const struct unit *u = &all->v[i];

        if (f->window)
            f->window[f->nwindows++] =
                (struct costs_window){ (uint32_t)u->x, (uint32_t)u->y,
                                       (uint32_t)u->width, (uint32_t)u->height,
                                       u->cost };
    }
    return 0;
}

/* --- lines --- */

static struct rad_quincunx
sampler_of(uint32_t width, uint32_t height, int ystep)
{
    return (struct rad_quincunx){ .width = (int)width,
                                  .height = (int)height,
                                  .ystep = ystep };
}

/* Read the seconds that a frame's n lines took. */
static int
read_lines(const json_t *list, double *line, size_t n, struct rad_error *err)
{
    if (!json_is_array(list) || json_array_size(list) != n)
        return rad_fail(err, RAD_EDATA, "no statistics: a line_s of not %zu",
                        n);
    for (size_t i = 0; i < n; i++) {
        const json_t *s = json_array_get(list, i);

        line[i] = json_number_value(s);
        if (!json_is_number(s) || !(line[i] >= 0 && line[i] <= MOST_CPU_S))
            return rad_fail(err, RAD_EDATA,
                            "no statistics: an impossible line_s");
    }
    return 0;
}

/* The median of the lines after line i; 0: there are none. */
static double
lines_after(const double *line, size_t n, size_t i)
{
    double v[LINES_AFTER];
    size_t k = 0;

    while (k < LINES_AFTER && i + 1 + k < n) {
        v[k] = line[i + 1 + k];
        k++;
    }
    qsort(v, k, sizeof *v, rad_compare_reals);
    return k > 0 ? v[k / 2] : 0;
}

/* A worker's first line is traced without ambient records nearby, wherever it
 * lies.  The next job's workers will begin at other lines; so the extra time of
 * the first line is spread over all lines. */
static void
level_first(double *line, size_t n, size_t i)
{
    double own = lines_after(line, n, i), more = line[i] - own;

    if (own == 0 || more <= 0)
        return;
    line[i] = own;
    for (size_t k = 0; k < n; k++)
        line[k] += more / (double)n;
}

static void
put_rows(struct costs_frame *f, const struct rad_quincunx *q,
         const double *line)
{
    int n = rad_quincunx_nbases(q), y = 0;

    for (int i = 0; i < n; i++) {
        int base = rad_quincunx_base_row(q, i), rows = base + 1 - y;

        for (; y <= base; y++)
            f->row[y] = line[i] / rows;
    }
}

/* Order by worker, then by start. */
static int
compare_starts(const void *a, const void *b)
{
    const struct unit *x = a, *y = b;
    int by_name = strcmp(x->worker, y->worker);

    return by_name ? by_name
                   : (x->start_s > y->start_s) - (x->start_s < y->start_s);
}

/* Take the times of frame k's lines.  Units must be sorted by
 * compare_starts(). */
static int
take_lines(struct costs *c, uint32_t k, const json_t *list,
           const struct units *all, struct rad_error *err)
{
    struct costs_frame *f = &c->frames[k];
    struct rad_quincunx q = sampler_of(f->width, f->height, c->ystep);
    size_t n = (size_t)rad_quincunx_nbases(&q);
    double *line = malloc(n * sizeof *line);
    int rc = line ? read_lines(list, line, n, err) : rad_fail_memory(err);

    for (size_t i = 0; i < all->n && rc == 0; i++) {
        const struct unit *u = &all->v[i];

        if (u->frame - all->first == k &&
            (i == 0 || strcmp(u->worker, u[-1].worker) != 0))
            level_first(line, n, (size_t)((u->y + c->ystep - 1) / c->ystep));
    }
    if (rc == 0)
        put_rows(f, &q, line);
    free(line);
    return rc;
}

static int
take_all_lines(struct costs *c, const json_t *frames, const struct units *u,
               struct rad_error *err)
{
    int rc = 0;

    if (!json_is_array(frames) || json_array_size(frames) != c->nframes)
        return rad_fail(err, RAD_EDATA,
                        "no statistics: line_s is not of %u frames",
                        c->nframes);
    qsort(u->v, u->n, sizeof *u->v, compare_starts);
    for (uint32_t k = 0; k < c->nframes && rc == 0; k++)
        rc = take_lines(c, k, json_array_get(frames, k), u, err);
    return rc;
}

static int
take_units(struct costs *c, struct units *u, const json_t *line_s,
           struct rad_error *err)
{
    uint64_t *pixels = calloc(c->nframes, sizeof *pixels);
    int rc;

    u->first = u->n > 0 ? u->v[0].frame : 0;
    for (size_t i = 0; i < u->n; i++)
        if (u->v[i].frame < u->first)
            u->first = u->v[i].frame;
    weigh(u);
    c->frames = calloc(c->nframes, sizeof *c->frames);
    rc = pixels && c->frames ? 0 : rad_fail_memory(err);
    if (rc == 0)
        rc = measure_frames(c, u, pixels, err);
    if (rc == 0)
        rc = make_rows(c, pixels, err);
    if (rc == 0 && line_s)
        rc = take_all_lines(c, line_s, u, err);
    else if (rc == 0)
        spread(c, u);
    if (rc == 0)
        rc = keep_windows(c, u, err);
    free(pixels);
    return rc;
}

static int
take_list(struct costs *c, const json_t *list, const json_t *line_s,
          struct rad_error *err)
{
    struct units u = { .n = json_array_size(list) };
    int rc = (u.v = calloc(u.n + 1, sizeof *u.v)) ? 0 : rad_fail_memory(err);

    for (size_t i = 0; i < u.n && rc == 0; i++)
        rc = unpack_unit(json_array_get(list, i), &u.v[i], err);
    if (rc == 0)
        rc = take_units(c, &u, line_s, err);
    free(u.v);
    return rc;
}

static int
take_root(struct costs *c, const json_t *root, struct rad_error *err)
{
    const char *options;
    json_t *units, *line_s = NULL;
    int frames, rc;

    if (json_unpack((json_t *)root, "{s:s,s:{s:i},s:o,s?o}", "options",
                    &options, "picture", "frames", &frames, "units", &units,
                    "line_s", &line_s) != 0 ||
        !json_is_array(units))
        return rad_fail(err, RAD_EDATA,
                        "no statistics: it lacks options, picture or units");
    if (frames < 1 || frames > MSG_MAX_FRAMES)
        return rad_fail(err, RAD_EDATA, "no statistics: %d frames", frames);
    c->nframes = (uint32_t)frames;
    if ((rc = read_ystep(options, &c->ystep, err)) < 0)
        return rc;
    return take_list(c, units, line_s, err);
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
    for (uint32_t k = 0; c->frames && k < c->nframes; k++) {
        free(c->frames[k].row);
        free(c->frames[k].window);
    }
    free(c->frames);
    memset(c, 0, sizeof *c);
}

/* Do the frames have the same number and sizes, and the same base lines? */
static int
check_fit(const struct costs *c, const struct frames *frames, int psample,
          struct rad_error *err)
{
    int xstep, ystep;

    rad_quincunx_steps(psample, &xstep, &ystep);
    if (c->nframes != frames->n)
        return rad_fail(err, RAD_EDATA, "statistics of %u frames, not %u",
                        c->nframes, frames->n);
    for (uint32_t k = 0; k < frames->n; k++) {
        const struct msg_frame *f = &frames->list[k];

        if (c->frames[k].width != f->width || c->frames[k].height != f->height)
            return rad_fail(
                err, RAD_EDATA, "statistics of %u by %u pixels, not %u by %u",
                c->frames[k].width, c->frames[k].height, f->width, f->height);
    }
    if (c->ystep != ystep)
        return rad_fail(err, RAD_EDATA,
                        "statistics with another -ps: base lines are %d rows "
                        "apart, not %d",
                        c->ystep, ystep);
    return 0;
}

static uint64_t
count_lines(const struct frames *frames, int ystep)
{
    uint64_t n = 0;

    for (uint32_t k = 0; k < frames->n; k++) {
        struct rad_quincunx q =
            sampler_of(frames->list[k].width, frames->list[k].height, ystep);

        n += (uint64_t)rad_quincunx_nbases(&q);
    }
    return n;
}

/* Write the costs of a frame's lines at `to`; returns their end. */
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
costs_of_lines(const struct costs *c, const struct frames *frames, int psample,
               uint8_t **bytes, uint32_t *n, struct rad_error *err)
{
    uint64_t lines = count_lines(frames, c->ystep);
    int rc = check_fit(c, frames, psample, err);
    uint8_t *to;

    if (rc < 0)
        return rc;
    if (lines > MSG_MAX_COSTS)
        return rad_fail(err, RAD_EUSAGE,
                        "a statistics file serves pictures of at most %u base "
                        "lines, not %llu",
                        MSG_MAX_COSTS, (unsigned long long)lines);
    *bytes = to = malloc(lines * sizeof(float));
    if (!to)
        return rad_fail_memory(err);
    for (uint32_t k = 0; k < frames->n; k++) {
        struct rad_quincunx q =
            sampler_of(frames->list[k].width, frames->list[k].height, c->ystep);

        to = put_frame(to, &c->frames[k], &q);
    }
    *n = (uint32_t)lines;
    return 0;
}
