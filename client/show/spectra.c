/* spectra.c - see spectra.h */
#include "config.h"

#include "show/spectra.h"

#include "image/hdr.h"
#include "image/spectrum.h"

#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct joint {
    const struct spectra_order *order;
    struct rad_coded_picture pic[RAD_MAX_PLANES];
    int nplanes, npics;             /* npics of nplanes are decoded */
    const struct rad_spectrum *eye; /* for colours; NULL: spectra */
    uint8_t *out;
    size_t n, room;
};

static int
damaged(struct rad_error *err)
{
    return rad_fail(err, RAD_EDATA, "the planes that came are damaged");
}

static int
decode(struct joint *j, const struct spectra_plane plane[],
       struct rad_error *err)
{
    for (; j->npics < j->nplanes; j->npics++) {
        struct rad_coded_picture *pic = &j->pic[j->npics];
        int rc = rad_hdr_read_coded(plane[j->npics].hdr, plane[j->npics].len,
                                    INT_MAX, pic, err);

        if (rc < 0)
            return rc;
        if (pic->width != j->pic[0].width || pic->height != j->pic[0].height) {
            j->npics++;
            return damaged(err);
        }
    }
    return 0;
}

/* --- the header ----------------------------------------------------------- */

static void
put(struct joint *j, const char *text, size_t n)
{
    if (n <= j->room - j->n) {
        memcpy(j->out + j->n, text, n);
        j->n += n;
    }
}

__attribute__((format(printf, 2, 3))) static void
print(struct joint *j, const char *fmt, ...)
{
    char line[160];
    va_list args;

    va_start(args, fmt);
    vsnprintf(line, sizeof line, fmt, args);
    va_end(args);
    put(j, line, strlen(line));
}

/* Copy a header line.  In that of the options the first plane's number is
 * replaced. */
static void
put_line(struct joint *j, const char *line, size_t n)
{
    char plane[32];
    size_t len = (size_t)snprintf(
        plane, sizeof plane, " --plane %d ",
        j->order->bands.plane == RAD_PLANE_COLOURS ? RAD_PLANE_COLOURS : 0);
    const char *at = memmem(line, n, plane, len);

    if (!at) {
        put(j, line, n);
        return;
    }
    put(j, line, (size_t)(at - line));
    print(j, " -co%c ", j->order->spectral ? '+' : '-');
    at += len;
    put(j, at, n - (size_t)(at - line));
}

static bool
begins(const char *line, size_t n, const char *word)
{
    return n >= strlen(word) && memcmp(line, word, strlen(word)) == 0;
}

static void
put_format(struct joint *j)
{
    const struct rad_bands *b = &j->order->bands;

    if (j->order->spectral) {
        print(j, "WAVELENGTH_SPLITS= %g %g %g %g\nNCOMP=%d\n",
              rad_bands_split(b, 0), rad_bands_split(b, 1),
              rad_bands_split(b, 2), rad_bands_split(b, 3), b->n);
        print(j, "FORMAT=Radiance_spectra\n");
    } else {
        print(j, "FORMAT=32-bit_rle_%s\n",
              j->order->primaries == RAD_PRIM_XYZ ? "xyze" : "rgbe");
    }
}

static int
put_header(struct joint *j, const struct spectra_plane *first,
           struct rad_error *err)
{
    const char *at = (const char *)first->hdr, *end = at + first->len;

    for (;;) {
        const char *stop = memchr(at, '\n', (size_t)(end - at));
        size_t n = stop ? (size_t)(stop + 1 - at) : 0;

        if (!stop)
            return damaged(err);
        if (n == 1)
            break;
        if (!begins(at, n, "FORMAT="))
            put_line(j, at, n);
        at += n;
    }
    put_format(j);
    print(j, "\n-Y %d +X %d\n", j->pic[0].height, j->pic[0].width);
    return 0;
}

/* --- pixels --------------------------------------------------------------- */

static void
gather(const struct joint *j, size_t pixel, float band[RAD_MAX_BANDS])
{
    struct rad_rgb L[RAD_MAX_PLANES];

    for (int p = 0; p < j->nplanes; p++)
        L[p] = rad_rgbe_radiance(j->pic[p].rgbe + 4 * pixel);
    rad_bands_gather(&j->order->bands, L, band);
}

static struct rad_rgb
colour(const struct joint *j, const float band[])
{
    double sum[3] = { 0 };
    struct rad_rgb c;

    for (int i = 0; i < j->order->bands.n; i++)
        rad_spectrum_add(j->eye, i, (double)band[i], sum);
    if (j->order->primaries != RAD_PRIM_XYZ)
        rad_spectrum_colour(j->eye, sum);
    c = rad_rgb((float)sum[0], (float)sum[1], (float)sum[2]);
    return j->order->primaries == RAD_PRIM_XYZ ? rad_rgb_to_xyz(c) : c;
}

static void
put_spectra(struct joint *j)
{
    size_t n = (size_t)j->pic[0].width * (size_t)j->pic[0].height;
    int nbands = j->order->bands.n;
    float band[RAD_MAX_BANDS];

    for (size_t i = 0; i < n; i++, j->n += (size_t)nbands + 1) {
        gather(j, i, band);
        rad_hdr_spectrum(band, nbands, j->out + j->n);
    }
}

static int
put_colours(struct joint *j, struct rad_error *err)
{
    int width = j->pic[0].width;
    struct rad_rgb *row = calloc((size_t)width, sizeof *row);
    float band[RAD_MAX_BANDS];

    if (!row)
        return rad_fail_memory(err);
    for (int y = 0; y < j->pic[0].height; y++) {
        for (int x = 0; x < width; x++) {
            gather(j, (size_t)y * (size_t)width + (size_t)x, band);
            row[x] = colour(j, band);
        }
        j->n += rad_hdr_encode_row(row, width, j->out + j->n);
    }
    free(row);
    return 0;
}

/* Make room for the whole result. */
static int
reserve(struct joint *j, const struct spectra_plane *first,
        struct rad_error *err)
{
    enum { MORE_HEADER = 400 };
    size_t width = (size_t)j->pic[0].width;
    size_t row = j->order->spectral ? width * ((size_t)j->order->bands.n + 1)
                                    : RAD_HDR_ROW_BYTES(width);
    const uint8_t *pixels = memmem(first->hdr, first->len, "\n\n", 2);

    if (!pixels)
        return damaged(err);
    j->room = (size_t)(pixels - first->hdr) + MORE_HEADER +
              row * (size_t)j->pic[0].height;
    j->out = malloc(j->room);
    return j->out ? 0 : rad_fail_memory(err);
}

static int
join(struct joint *j, const struct spectra_plane plane[], struct rad_error *err)
{
    int rc = decode(j, plane, err);

    if (rc < 0 || (rc = reserve(j, plane, err)) < 0 ||
        (rc = put_header(j, plane, err)) < 0)
        return rc;
    if (!j->order->spectral)
        return put_colours(j, err);
    put_spectra(j);
    return 0;
}

int
spectra_bands(const struct spectra_plane *plane, struct rad_bands *bands,
              struct rad_error *err)
{
    enum { MOST_HEADER = 16384 };
    const uint8_t *end = memmem(plane->hdr, plane->len, "\n\n", 2);
    char *text, *at = NULL;
    struct rad_bands b;
    bool sound = false;

    if (!end || end - plane->hdr > MOST_HEADER ||
        !(text = strndup((const char *)plane->hdr, (size_t)(end - plane->hdr))))
        return end ? rad_fail_memory(err) : damaged(err);
    /* take the last one: a name in the scene may look like options */
    for (char *next = text; (next = strstr(next, " -cs ")) != NULL; next++)
        at = next;
    if (at && sscanf(at, " -cs %2d -cw %lf %lf --plane %2d", &b.n, &b.shortest,
                     &b.longest, &b.plane) == 4)
        sound =
            b.n > 3 && b.n <= RAD_MAX_BANDS && b.shortest > 0 &&
            b.longest - b.shortest >= RAD_LEAST_RANGE && b.longest <= 1e6 &&
            b.plane >= 0 &&
            (b.plane < rad_bands_planes(&b) || b.plane == RAD_PLANE_COLOURS);
    free(text);
    if (!sound)
        return rad_fail(err, RAD_EDATA, "the picture shows no plane of -cs");
    *bands = b;
    return 0;
}

int
spectra_join(const struct spectra_order *order,
             const struct spectra_plane plane[], uint8_t **out, size_t *nout,
             struct rad_error *err)
{
    struct joint j = { .order = order,
                       .nplanes = rad_bands_planes(&order->bands) };
    struct rad_bands colours = rad_bands_rgb();
    struct rad_arena arena;
    int rc;

    rad_arena_init(&arena);
    j.eye = rad_spectrum_new(&arena, order->bands.n, order->bands.longest,
                             order->bands.shortest, &colours);
    rc = j.eye ? join(&j, plane, err) : rad_fail_memory(err);
    for (int i = 0; i < j.npics; i++)
        rad_coded_picture_release(&j.pic[i]);
    rad_arena_release(&arena);
    if (rc < 0) {
        free(j.out);
        return rc;
    }
    *out = j.out;
    *nout = j.n;
    return 0;
}
