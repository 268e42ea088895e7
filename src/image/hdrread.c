/* hdrread.c - reading pictures: coded rows, and files in all their forms;
 * see hdr.h, and hdrimpl.h for the format of a row */
#include "config.h"

#include "image/hdrimpl.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    LONGEST_SIDE = 1 << 24,
    WINDOW = 64 * 1024 /* bytes of a stream in memory */
};

/* The bytes of a coded component of n pixels; 0: there is none. */
static size_t
component_bytes(const uint8_t *c, size_t len, int n)
{
    size_t at = 0;

    while (n > 0) {
        int k = at < len ? c[at] : 0;
        size_t more = k > 128 ? 2 : 1 + (size_t)k;

        k = k > 128 ? k - 128 : k;
        if (k == 0 || k > n || more > len - at)
            return 0;
        at += more;
        n -= k;
    }
    return at;
}

size_t
rad_hdr_row_bytes(const uint8_t *code, size_t len, int width)
{
    size_t at = 4;

    if (is_flat(width))
        return len >= 4 * (size_t)width ? 4 * (size_t)width : 0;
    if (len < 4 || code[0] != 2 || code[1] != 2 ||
        (code[2] << 8 | code[3]) != width)
        return 0;
    for (int i = 0; i < 4; i++) {
        size_t n = component_bytes(code + at, len - at, width);

        if (n == 0)
            return 0;
        at += n;
    }
    return at;
}

void
rad_picture_release(struct rad_picture *pic)
{
    free(pic->L);
    rad_edges_release(&pic->edges);
    memset(pic, 0, sizeof *pic);
}

struct reader {
    const uint8_t *at, *end;
    const struct rad_stream *more; /* what follows the end; NULL: nothing */
    uint8_t *window;               /* of WINDOW bytes, for `more` */
    struct rad_error *err;
    double divide[3]; /* EXPOSURE times COLORCORR */
    double pixaspect;
    double chroma[8];   /* PRIMARIES */
    bool primaries;     /* there is a PRIMARIES line */
    bool seen, sensed;  /* -i, -I of rtrace in a command line in the header */
    bool xyz;           /* tristimulus values instead of RGB */
    bool xmajor;        /* scan lines are columns */
    bool yup, xleft;    /* rows begin at the bottom, columns at the right */
    int nscan, nlength; /* scan lines, pixels in each */
    int width, height;  /* of the picture in standard order */
};

static int
damaged(struct reader *in, const char *what)
{
    return rad_fail(in->err, RAD_EDATA, "picture: %s", what);
}

/* Read on until at least n bytes, of WINDOW at most, are there; false: the file
 * ends before. */
static bool
read_on(struct reader *in, size_t n)
{
    size_t left = (size_t)(in->end - in->at);

    if (!in->more)
        return false;
    memmove(in->window, in->at, left);
    in->at = in->window;
    while (left < n) {
        long k = in->more->read(in->more->arg, in->window + left, WINDOW - left,
                                in->err);

        if (k <= 0)
            break; /* the stream has set the error, if there is one */
        left += (size_t)k;
    }
    in->end = in->window + left;
    return left >= n;
}

static inline bool
has(struct reader *in, size_t n)
{
    return (size_t)(in->end - in->at) >= n || read_on(in, n);
}

/* Copy the next line, without its end, into line; a long one is cut. */
static int
get_line(struct reader *in, char *line, size_t size)
{
    uint8_t c, last = 0;
    size_t n = 0;

    for (;; last = c, n++) {
        if (!has(in, 1))
            return damaged(in, "header ends early");
        c = *in->at++;
        if (c == '\n')
            break;
        if (n < size)
            line[n] = (char)c;
    }
    if (last == '\r')
        n--;
    line[n < size - 1 ? n : size - 1] = '\0';
    return 0;
}

/* Multiply *value by a factor from a header line; false: the factor is not
 * finite and above 0. */
static bool
get_factor(char **text, double *value)
{
    double v = strtod(*text, text);

    *value *= v;
    return v > 0 && v < DBL_MAX;
}

static bool
get_colorcorr(struct reader *in, char *text)
{
    return get_factor(&text, &in->divide[0]) &&
           get_factor(&text, &in->divide[1]) &&
           get_factor(&text, &in->divide[2]);
}

/* Read a PRIMARIES line; as in Radiance, an incomplete one is ignored. */
static void
get_primaries(struct reader *in, char *text)
{
    for (int i = 0; i < 8; i++) {
        char *end;

        in->chroma[i] = strtod(text, &end);
        if (end == text || !(fabs(in->chroma[i]) < 1e6))
            return;
        text = end;
    }
    in->primaries = true;
}

/* Set *on as a switch of that name does, each time that the line has it. */
static void
get_switch(const char *line, const char *name, bool *on)
{
    size_t n = strlen(name);

    for (const char *at = line; (at = strstr(at, name)); at += n) {
        char sign = at[n];

        if (sign == ' ' || sign == '\0')
            *on = !*on;
        else if (strchr("+1yYtT", sign))
            *on = true;
        else if (strchr("-0nNfF", sign))
            *on = false;
    }
}

/* If a line is the command of a program that renders, note whether it asks for
 * irradiance, at the surfaces that are seen or at sensors. */
static void
get_irradiance(struct reader *in, const char *line)
{
    static const char *const programs[] = { "radsubmit ", "rpict ", "rtpict ",
                                            "rvu ", "rtrace " };

    for (size_t i = 0; i < sizeof programs / sizeof programs[0]; i++)
        if (strncmp(line, programs[i], strlen(programs[i])) == 0) {
            get_switch(line, " -i", &in->seen);
            get_switch(line, " -I", &in->sensed);
        }
}

static int
take_header_line(struct reader *in, char *line)
{
    char *value = strchr(line, '=');
    double expo = 1;

    get_irradiance(in, line);
    if (!value)
        return 0;
    *value++ = '\0';
    if (strcmp(line, "EXPOSURE") == 0) {
        if (!get_factor(&value, &expo))
            return damaged(in, "bad EXPOSURE");
        for (int i = 0; i < 3; i++)
            in->divide[i] *= expo;
    } else if (strcmp(line, "COLORCORR") == 0) {
        if (!get_colorcorr(in, value))
            return damaged(in, "bad COLORCORR");
    } else if (strcmp(line, "PIXASPECT") == 0) {
        if (!get_factor(&value, &in->pixaspect))
            return damaged(in, "bad PIXASPECT");
    } else if (strcmp(line, "PRIMARIES") == 0) {
        get_primaries(in, value);
    } else if (strcmp(line, "FORMAT") == 0) {
        value += strspn(value, " \t");
        value[strcspn(value, " \t")] = '\0';
        in->xyz = strcmp(value, "32-bit_rle_xyze") == 0;
        if (!in->xyz && strcmp(value, "32-bit_rle_rgbe") != 0)
            return rad_fail(in->err, RAD_EDATA,
                            "picture: format is '%.40s', only "
                            "32-bit_rle_rgbe and 32-bit_rle_xyze are read",
                            value);
    }
    return 0;
}

static int
read_header(struct reader *in)
{
    char line[512];
    bool more;
    int rc;

    do {
        if ((rc = get_line(in, line, sizeof line)) < 0)
            return rc;
        more = line[0] != '\0';
        if ((rc = take_header_line(in, line)) < 0)
            return rc;
    } while (more);
    for (int i = 0; i < 3; i++)
        if (!(in->divide[i] > 0 && in->divide[i] < DBL_MAX))
            return damaged(in, "EXPOSURE or COLORCORR out of range");
    if (!(in->pixaspect > 0 && in->pixaspect < DBL_MAX))
        return damaged(in, "PIXASPECT out of range");
    return 0;
}

/* Read a line like "-Y 480 +X 640": the axis from one scan line to the next
 * comes first. */
static int
read_resolution(struct reader *in)
{
    char line[128], axis[2][3], rest;
    int n[2], rc;

    if ((rc = get_line(in, line, sizeof line)) < 0)
        return rc;
    if (sscanf(line, "%2s %9d %2s %9d %c", axis[0], &n[0], axis[1], &n[1],
               &rest) != 4)
        return damaged(in, "bad resolution line");
    for (int i = 0; i < 2; i++)
        if ((axis[i][0] != '+' && axis[i][0] != '-') ||
            (axis[i][1] != 'X' && axis[i][1] != 'Y') || n[i] < 1 ||
            n[i] > LONGEST_SIDE)
            return damaged(in, "bad resolution line");
    if (axis[0][1] == axis[1][1])
        return damaged(in, "bad resolution line");
    in->xmajor = axis[0][1] == 'X';
    in->yup = axis[in->xmajor ? 1 : 0][0] == '+';
    in->xleft = axis[in->xmajor ? 0 : 1][0] == '-';
    in->nscan = n[0];
    in->nlength = n[1];
    in->width = n[!in->xmajor];
    in->height = n[in->xmajor];
    return 0;
}

/* Read header and resolution.  The oldest pictures do not begin with "#?", so
 * only the rest tells whether a file is a picture. */
static int
read_head(struct reader *in)
{
    bool marked = has(in, 2) && memcmp(in->at, "#?", 2) == 0;
    struct rad_error why = { 0 }, *err = in->err;
    int rc;

    in->err = &why;
    rc = read_header(in);
    if (rc == 0)
        rc = read_resolution(in);
    in->err = err;
    if (rc == 0)
        return 0;
    return marked ? rad_fail(err, rc, "%s", why.what)
                  : damaged(in, "not a Radiance picture");
}

static int
decode_component(struct reader *in, uint8_t *component, int n)
{
    for (int i = 0; i < n;) {
        const uint8_t *from; /* a local: stores into the row do not change it */
        uint8_t byte;
        int k;

        if (!has(in, 2))
            return damaged(in, "ends early");
        k = *in->at++;
        if (k > 128) {
            k &= 127;
            if (k > n - i)
                return damaged(in, "run past the end of a row");
            byte = *in->at++;
            for (; k > 0; k--)
                component[4 * i++] = byte;
        } else {
            if (k == 0 || k > n - i)
                return damaged(in, "bad length of bytes in a row");
            if (!has(in, (size_t)k))
                return damaged(in, "ends early");
            from = in->at;
            in->at += k;
            for (; k > 0; k--)
                component[4 * i++] = *from++;
        }
    }
    return 0;
}

/* Decode flat pixels and old run lengths. */
static int
decode_old(struct reader *in, uint8_t *rgbe, int n)
{
    int shift = 0;

    for (int i = 0; i < n;) {
        if (!has(in, 4))
            return damaged(in, "ends early");
        if (in->at[0] == 1 && in->at[1] == 1 && in->at[2] == 1) {
            /* a count of more than 24 bits is more than any row has */
            long k = shift < 24 ? (long)in->at[3] << shift : LONG_MAX;

            if (i == 0 || (in->at[3] && k > n - i))
                return damaged(in, "bad old run in a row");
            for (; in->at[3] && k > 0; k--, i++)
                memcpy(rgbe + 4 * i, rgbe + 4 * (i - 1), 4);
            shift += 8;
        } else {
            memcpy(rgbe + 4 * i++, in->at, 4);
            shift = 0;
        }
        in->at += 4;
    }
    return 0;
}

static int
decode_row(struct reader *in, uint8_t *rgbe)
{
    int n = in->nlength;
    int rc;

    if (is_flat(n) || !has(in, 4) || in->at[0] != 2 || in->at[1] != 2 ||
        in->at[2] > 127)
        return decode_old(in, rgbe, n);
    if ((in->at[2] << 8 | in->at[3]) != n)
        return damaged(in, "a row's length is not the picture's");
    in->at += 4;
    for (int c = 0; c < 4; c++)
        if ((rc = decode_component(in, rgbe + c, n)) < 0)
            return rc;
    return 0;
}

size_t
rad_hdr_decode_row(const uint8_t *code, size_t len, int width, uint8_t *rgbe)
{
    struct reader in = { .at = code, .end = code + len, .nlength = width };

    if (is_flat(width)) {
        if (len < 4 * (size_t)width)
            return 0;
        memcpy(rgbe, code, 4 * (size_t)width);
        return 4 * (size_t)width;
    }
    if (len < 4 || code[0] != 2 || code[1] != 2 || code[2] > 127)
        return 0;
    return decode_row(&in, rgbe) < 0 ? 0 : (size_t)(in.at - code);
}

/* Decode all rows into *rgbe, which grows as they come; or, not to be kept,
 * each over the row before. */
static int
decode_rows(struct reader *in, bool kept, uint8_t **rgbe)
{
    size_t row = 4 * (size_t)in->nlength, room = 0;

    for (int y = 0; y < in->nscan; y++) {
        size_t used = kept ? row * (size_t)y : 0;
        int rc;

        if (used + row > room) {
            size_t all = row * (size_t)in->nscan;
            uint8_t *more;

            room = 2 * (used + row) < all ? 2 * (used + row) : all;
            more = realloc(*rgbe, room);
            if (!more)
                return rad_fail_memory(in->err);
            *rgbe = more;
        }
        if ((rc = decode_row(in, *rgbe + used)) < 0) {
            rad_error_where(in->err, "scan line %d of %d", y + 1, in->nscan);
            return rc;
        }
    }
    return 0;
}

/* The pixel in column x of row y, counted in standard order. */
static const uint8_t *
pixel_at(const struct reader *in, const uint8_t *rgbe, int x, int y)
{
    int u = in->xleft ? in->width - 1 - x : x;
    int v = in->yup ? in->height - 1 - y : y;
    int scan = in->xmajor ? u : v, along = in->xmajor ? v : u;

    return rgbe + 4 * ((size_t)scan * (size_t)in->nlength + (size_t)along);
}

/* Read header and pixels; *rgbe is malloc'd, in the file's order.  kept false:
 * only its first row's bytes can be used. */
static int
read_coded(struct reader *in, size_t max_pixels, bool kept, uint8_t **rgbe)
{
    int rc;

    *rgbe = NULL;
    if ((rc = read_head(in)) < 0)
        return rc;
    if ((size_t)in->nscan > max_pixels / (size_t)in->nlength)
        return rad_fail(in->err, RAD_EDATA,
                        "picture: %d by %d is more than the %zu pixels that "
                        "are read",
                        in->nlength, in->nscan, max_pixels);
    rc = decode_rows(in, kept, rgbe);
    if (rc < 0) {
        free(*rgbe);
        *rgbe = NULL;
    }
    return rc;
}

static struct reader
start_reader(const uint8_t *data, const uint8_t *end, struct rad_error *err)
{
    struct reader in = { .at = data,
                         .end = end,
                         .err = err,
                         .divide = { 1, 1, 1 },
                         .pixaspect = 1 };

    return in;
}

static struct rad_rgb
within_gamut(struct rad_rgb c)
{
    return rad_rgb(fmaxf(c.r, 0), fmaxf(c.g, 0), fmaxf(c.b, 0));
}

/* Convert coded pixels to radiance in standard order. */
static int
arrange(const struct reader *in, const uint8_t *rgbe, struct rad_picture *pic)
{
    struct rad_rgb *to;

    pic->width = in->width;
    pic->height = in->height;
    to = pic->L = malloc(rad_picture_pixels(pic) * sizeof *pic->L);
    if (!pic->L)
        return rad_fail_memory(in->err);
    for (int y = 0; y < in->height; y++)
        for (int x = 0; x < in->width; x++) {
            struct rad_rgb L = rad_rgbe_radiance(pixel_at(in, rgbe, x, y));

            L = rad_rgb((float)(L.r / in->divide[0]),
                        (float)(L.g / in->divide[1]),
                        (float)(L.b / in->divide[2]));
            *to++ = in->xyz ? within_gamut(rad_xyz_to_rgb(L)) : L;
        }
    pic->pixaspect = in->pixaspect;
    pic->irradiance = in->seen || in->sensed;
    pic->other_primaries = in->primaries && !in->xyz;
    memcpy(pic->chroma, in->chroma, sizeof pic->chroma);
    return 0;
}

/* Are the pixels in the file as they are in memory? */
static bool
is_plain(const struct reader *in)
{
    return !in->xyz && !in->primaries && !in->xmajor && !in->yup &&
           !in->xleft && in->divide[0] == 1 && in->divide[1] == 1 &&
           in->divide[2] == 1;
}

int
rad_hdr_read(const uint8_t *data, size_t len, size_t max_pixels,
             struct rad_picture *pic, struct rad_error *err)
{
    struct reader in = start_reader(data, data + len, err);
    uint8_t *rgbe;
    int rc;

    memset(pic, 0, sizeof *pic);
    rc = read_coded(&in, max_pixels, true, &rgbe);
    if (rc == 0)
        rc = arrange(&in, rgbe, pic);
    free(rgbe);
    if (rc == 0 && is_plain(&in))
        rc = rad_edges_read(data, len, pic->width, pic->height, &pic->edges,
                            err);
    if (rc < 0)
        rad_picture_release(pic);
    return rc;
}

void
rad_coded_picture_release(struct rad_coded_picture *pic)
{
    free(pic->rgbe);
    memset(pic, 0, sizeof *pic);
}

/* Put coded pixels, in the file's order, into pic's; takes rgbe. */
static int
arrange_coded(const struct reader *in, uint8_t *rgbe,
              struct rad_coded_picture *pic)
{
    uint8_t *to;

    if (!in->xmajor && !in->xleft && !in->yup) {
        pic->rgbe = rgbe;
        return 0;
    }
    to = malloc(4 * (size_t)pic->width * (size_t)pic->height);
    pic->rgbe = to;
    for (int y = 0; to && y < pic->height; y++)
        for (int x = 0; x < pic->width; x++, to += 4)
            memcpy(to, pixel_at(in, rgbe, x, y), 4);
    free(rgbe);
    if (pic->rgbe)
        return 0;
    rad_coded_picture_release(pic);
    return rad_fail_memory(in->err);
}

static int
read_coded_picture(struct reader *in, size_t max_pixels, bool kept,
                   struct rad_coded_picture *pic)
{
    uint8_t *rgbe;
    int rc;

    memset(pic, 0, sizeof *pic);
    rc = read_coded(in, max_pixels, kept, &rgbe);
    if (rc < 0)
        return rc;
    if (in->xyz)
        rc = rad_fail(in->err, RAD_EDATA,
                      "picture: tristimulus values (32-bit_rle_xyze), of which "
                      "ra_xyze -r makes RGBE");
    if (rc < 0 || !kept) {
        free(rgbe);
        rgbe = NULL;
    }
    if (rc < 0)
        return rc;
    pic->width = in->width;
    pic->height = in->height;
    pic->pixaspect = in->pixaspect;
    return kept ? arrange_coded(in, rgbe, pic) : 0;
}

int
rad_hdr_read_coded(const uint8_t *data, size_t len, size_t max_pixels,
                   struct rad_coded_picture *pic, struct rad_error *err)
{
    struct reader in = start_reader(data, data + len, err);

    return read_coded_picture(&in, max_pixels, true, pic);
}

int
rad_hdr_stream_coded(const struct rad_stream *from, size_t max_pixels,
                     bool kept, struct rad_coded_picture *pic,
                     struct rad_error *err)
{
    uint8_t *window = malloc(WINDOW);
    struct reader in = start_reader(NULL, NULL, err);
    int rc;

    if (!window)
        return rad_fail_memory(err);
    in.more = from;
    in.window = window;
    in.at = in.end = window;
    rc = read_coded_picture(&in, max_pixels, kept, pic);
    free(window);
    return rc;
}
