/* expose.c - see expose.h
 *
 * A value that was cut to eight bits is multiplied and cut again: it is off by
 * less than one step more.  By a power of two it is exact. */
#include "config.h"

#include "show/expose.h"

#include "image/hdr.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int
damaged(struct rad_error *err)
{
    return rad_fail(err, RAD_EDATA, "the picture that came is damaged");
}

/* Where the header's empty line begins; NULL: nowhere. */
static const uint8_t *
header_end(const uint8_t *hdr, size_t n)
{
    for (size_t i = 0; i + 1 < n; i++)
        if (hdr[i] == '\n' && hdr[i + 1] == '\n')
            return hdr + i + 1;
    return NULL;
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

struct bytes {
    uint8_t *p;
    size_t n, room;
};

static int
append(struct bytes *b, const void *from, size_t n, struct rad_error *err)
{
    if (n > b->room - b->n) {
        size_t room = 2 * b->room + n;
        uint8_t *p = realloc(b->p, room);

        if (!p)
            return rad_fail(err, RAD_ENOMEM, "out of memory");
        b->p = p;
        b->room = room;
    }
    memcpy(b->p + b->n, from, n);
    b->n += n;
    return 0;
}

/* Rows, from at to end. */
static int
expose_rows(const uint8_t *at, const uint8_t *end, int width, int height,
            double factor, struct bytes *to, struct rad_error *err)
{
    uint8_t *rgbe = malloc(4 * (size_t)width);
    uint8_t *code = malloc(RAD_HDR_ROW_BYTES(width));
    int rc = rgbe && code ? 0 : rad_fail(err, RAD_ENOMEM, "out of memory");

    for (int y = 0; y < height && rc == 0; y++) {
        size_t n = rad_hdr_decode_row(at, (size_t)(end - at), width, rgbe);

        if (n == 0) {
            rc = damaged(err);
            break;
        }
        multiply(rgbe, width, factor);
        at += n;
        rc = append(to, code, rad_hdr_encode_rgbe(rgbe, width, code), err);
    }
    free(rgbe);
    free(code);
    return rc;
}

int
expose(const uint8_t *hdr, size_t n, double factor, uint8_t **out, size_t *nout,
       struct rad_error *err)
{
    const uint8_t *head = header_end(hdr, n), *rows;
    struct bytes to = { 0 };
    char line[64], size[64] = "";
    int width, height, used = 0, rc;

    if (!head)
        return damaged(err);
    rows = head + 1;
    snprintf(
        size, sizeof size, "%.*s",
        (int)(n - (size_t)(rows - hdr) < 60 ? n - (size_t)(rows - hdr) : 60),
        (const char *)rows);
    if (sscanf(size, "-Y %d +X %d%n", &height, &width, &used) != 2 ||
        size[used] != '\n' || width < 1 || height < 1)
        return damaged(err);
    rows += used + 1;
    snprintf(line, sizeof line, "EXPOSURE=%e\n", factor);
    if ((rc = append(&to, hdr, (size_t)(head - hdr), err)) == 0 &&
        (rc = append(&to, line, strlen(line), err)) == 0 &&
        (rc = append(&to, head, (size_t)(rows - head), err)) == 0)
        rc = expose_rows(rows, hdr + n, width, height, factor, &to, err);
    if (rc < 0) {
        free(to.p);
        return rc;
    }
    *out = to.p;
    *nout = to.n;
    return 0;
}
