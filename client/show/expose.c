/* expose.c - see expose.h
 *
 * A value of eight bits is multiplied and cut to eight bits again, which adds
 * an error of less than one step.  A power of two is exact. */
#include "config.h"

#include "show/expose.h"

#include "base/files.h"
#include "image/hdr.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int
damaged(struct rad_error *err)
{
    return rad_fail(err, RAD_EDATA, "the picture that came is damaged");
}

static void
multiply(uint8_t *rgbe, int width, double factor)
{
    for (int x = 0; x < width; x++) {
        struct rad_rgb L = rad_rgbe_radiance(rgbe + 4 * x);

        L.r = (float)(L.r * factor);
        L.g = (float)(L.g * factor);
        L.b = (float)(L.b * factor);
        rad_rgbe(L, rgbe + 4 * x);
    }
}

/* The parts of a picture's bytes. */
struct layout {
    const uint8_t *head; /* the header's empty line */
    const uint8_t *rows, *end;
    int width, height;
};

static int
find_rows(const uint8_t *hdr, size_t n, struct layout *at,
          struct rad_error *err)
{
    const uint8_t *size = memmem(hdr, n, "\n\n", 2);
    char text[64] = "";
    int used = 0;

    if (!size)
        return damaged(err);
    at->head = size + 1;
    size += 2;
    at->end = hdr + n;
    snprintf(text, sizeof text, "%.*s",
             (int)(at->end - size < 60 ? at->end - size : 60),
             (const char *)size);
    if (sscanf(text, "-Y %d +X %d%n", &at->height, &at->width, &used) != 2 ||
        text[used] != '\n' || at->width < 1 || at->height < 1)
        return damaged(err);
    at->rows = size + used + 1;
    return 0;
}

/* Multiply all rows. */
static int
expose_rows(const struct layout *pic, double factor, struct rad_memory_out *to,
            struct rad_error *err)
{
    uint8_t *rgbe = malloc(4 * (size_t)pic->width);
    uint8_t *code = malloc(RAD_HDR_ROW_BYTES(pic->width));
    const uint8_t *at = pic->rows;
    int rc = rgbe && code ? 0 : rad_fail_memory(err);

    for (int y = 0; y < pic->height && rc == 0; y++) {
        size_t n =
            rad_hdr_decode_row(at, (size_t)(pic->end - at), pic->width, rgbe);

        if (n == 0) {
            rc = damaged(err);
            break;
        }
        multiply(rgbe, pic->width, factor);
        at += n;
        rc = rad_memory_add(to, code,
                            rad_hdr_encode_rgbe(rgbe, pic->width, code), err);
    }
    free(rgbe);
    free(code);
    return rc;
}

int
expose(const uint8_t *hdr, size_t n, double factor, uint8_t **out, size_t *nout,
       struct rad_error *err)
{
    struct layout at;
    struct rad_memory_out to = { 0 };
    char line[64];
    int rc = find_rows(hdr, n, &at, err);

    if (rc < 0)
        return rc;
    snprintf(line, sizeof line, "EXPOSURE=%e\n", factor);
    if ((rc = rad_memory_add(&to, hdr, (size_t)(at.head - hdr), err)) == 0 &&
        (rc = rad_memory_add(&to, line, strlen(line), err)) == 0 &&
        (rc = rad_memory_add(&to, at.head, (size_t)(at.rows - at.head), err)) ==
            0)
        rc = expose_rows(&at, factor, &to, err);
    if (rc < 0) {
        free(to.bytes);
        return rc;
    }
    *out = to.bytes;
    *nout = to.len;
    return 0;
}

static bool
is_black(const uint8_t *rgbe, int width)
{
    for (int x = 0; x < width; x++)
        if (rgbe[4 * x + 3] != 0)
            return false;
    return true;
}

bool
expose_nothing(const uint8_t *hdr, size_t n)
{
    struct layout at;
    bool black = find_rows(hdr, n, &at, NULL) == 0;
    uint8_t *rgbe = black ? malloc(4 * (size_t)at.width) : NULL;

    for (int y = 0; rgbe && black && y < at.height; y++) {
        size_t row = rad_hdr_decode_row(at.rows, (size_t)(at.end - at.rows),
                                        at.width, rgbe);

        at.rows += row;
        black = row > 0 && is_black(rgbe, at.width);
    }
    black = black && rgbe;
    free(rgbe);
    return black;
}
