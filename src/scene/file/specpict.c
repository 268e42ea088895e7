/* specpict.c - see specpict.h */
#include "config.h"

#include "scene/file/specpict.h"
#include "image/spectrum.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#define LONGEST_LINE 4096
#define LONGEST_SIDE (1 << 24)

/* Bias of the exponent's byte, and 8 bits of the mantissa; decode() adds half a
 * step to each mantissa. */
#define EXPONENT_EXCESS (128 + 8)

struct reader {
    const uint8_t *at, *end;
    struct rad_error *err;
    int channels;
    float edge[4]; /* WAVELENGTH_SPLITS [nm] */
    double pixaspect;
    int width, height;
    bool ends; /* the header has ended */
};

static int
bad(const struct reader *in, const char *what)
{
    return rad_fail(in->err, RAD_EDATA, "hyperspectral picture: %s", what);
}

static int
get_line(struct reader *in, char line[LONGEST_LINE])
{
    const uint8_t *stop = memchr(in->at, '\n', (size_t)(in->end - in->at));
    size_t n;

    if (!stop)
        return bad(in, "header ends early");
    n = (size_t)(stop - in->at);
    if (n >= LONGEST_LINE)
        n = LONGEST_LINE - 1;
    memcpy(line, in->at, n);
    line[n] = '\0';
    in->at = stop + 1;
    return 0;
}

static int
take_line(struct reader *in, const char *line)
{
    char format[64];
    double aspect;

    if (line[0] == '\0')
        in->ends = true;
    else if (sscanf(line, "NCOMP=%9d", &in->channels) == 1)
        return 0;
    else if (sscanf(line, "PIXASPECT=%lf", &aspect) == 1)
        in->pixaspect *= aspect;
    else if (strncmp(line, "WAVELENGTH_SPLITS=", 18) == 0) {
        if (sscanf(line + 18, "%f %f %f %f", &in->edge[0], &in->edge[1],
                   &in->edge[2], &in->edge[3]) != 4)
            return bad(in, "bad WAVELENGTH_SPLITS");
    } else if (sscanf(line, "FORMAT=%63s", format) == 1 &&
               strcmp(format, "Radiance_spectra") != 0)
        return bad(in, "format is not Radiance_spectra");
    return 0;
}

static bool
is_wavelength(double nm)
{
    return nm >= 1 && nm <= 1e6;
}

static int
read_header(struct reader *in)
{
    char line[LONGEST_LINE];
    int rc;

    while (!in->ends)
        if ((rc = get_line(in, line)) < 0 || (rc = take_line(in, line)) < 0)
            return rc;
    if (in->channels < 4 || in->channels > RAD_MAX_BANDS)
        return bad(in, "NCOMP is not 4 to 24");
    if (!is_wavelength(in->edge[0]) || !is_wavelength(in->edge[3]) ||
        in->edge[0] == in->edge[3])
        return bad(in, "no WAVELENGTH_SPLITS, or bad ones");
    if (!(in->pixaspect > 1e-6 && in->pixaspect < 1e6))
        return bad(in, "PIXASPECT out of range");
    if ((rc = get_line(in, line)) < 0)
        return rc;
    if (sscanf(line, "-Y %9d +X %9d", &in->height, &in->width) != 2 ||
        in->height < 1 || in->width < 1 || in->height > LONGEST_SIDE ||
        in->width > LONGEST_SIDE)
        return bad(in, "bad resolution line, or not in standard order");
    return 0;
}

/* Is the file as long as its size says?  Checked before memory is allocated. */
static int
check_size(const struct reader *in)
{
    size_t pixels = (size_t)in->width * (size_t)in->height;
    size_t left = (size_t)(in->end - in->at);

    if (pixels > RAD_MAX_DATA_PIXELS)
        return bad(in, "too many pixels");
    if (left / (size_t)(in->channels + 1) < pixels)
        return bad(in, "ends early");
    return 0;
}

static void
decode(const struct reader *in, const uint8_t *pixel, float *value)
{
    int exponent = pixel[in->channels];

    for (int i = 0; i < in->channels; i++)
        value[i] = exponent == 0 ? 0
                                 : ldexpf((float)pixel[i] + .5f,
                                          exponent - EXPONENT_EXCESS);
}

static void
read_pixels(const struct reader *in, float *value)
{
    size_t n = (size_t)in->channels, row = n * (size_t)in->width;
    const uint8_t *at = in->at;

    for (int y = in->height - 1; y >= 0; y--)
        for (int x = 0; x < in->width; x++, at += n + 1)
            decode(in, at, value + (size_t)y * row + (size_t)x * n);
}

struct rad_data *
rad_specpict_parse(struct rad_arena *arena, const uint8_t *bytes, size_t len,
                   struct rad_error *err)
{
    struct reader in = {
        .at = bytes, .end = bytes + len, .err = err, .pixaspect = 1
    };
    struct rad_data *d;
    double tall, wide, range;
    float *value;

    if (read_header(&in) < 0 || check_size(&in) < 0)
        return NULL;
    tall = in.height * in.pixaspect / in.width;
    wide = tall < 1 ? 1 / tall : 1;
    tall = tall < 1 ? 1 : tall;
    range = ((double)in.edge[3] - (double)in.edge[0]) / in.channels;
    d = rad_data_grid(arena, 3, (int[]){ in.height, in.width, in.channels },
                      (double[]){ tall, wide, range * (in.channels - 1) },
                      (double)in.edge[0] + .5 * range, &value);
    if (!d)
        rad_fail_memory(err);
    else
        read_pixels(&in, value);
    return d;
}
