/* points.c - see points.h
 *
 * Points are sorted along a curve through their bounding cube, and laid out in
 * the picture along curves through squares, one square below the other. */
#include "config.h"

#include "points/points.h"

#include "arith/bits.h"
#include "points/curve.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char magic[8] = { 'r', 'a', 'd', 'd', 'p', 't', 's', '2' };

/* --- bytes --- */

static void
put_u32(uint8_t *to, uint32_t v)
{
    for (int i = 0; i < 4; i++)
        to[i] = (uint8_t)(v >> 8 * i);
}

static uint32_t
get_u32(const uint8_t *from)
{
    return from[0] | (uint32_t)from[1] << 8 | (uint32_t)from[2] << 16 |
           (uint32_t)from[3] << 24;
}

static void
put_u64(uint8_t *to, uint64_t v)
{
    put_u32(to, (uint32_t)v);
    put_u32(to + 4, (uint32_t)(v >> 32));
}

static uint64_t
get_u64(const uint8_t *from)
{
    return get_u32(from) | (uint64_t)get_u32(from + 4) << 32;
}

/* Does the direction say that a pixel has no point? */
static bool
is_nowhere(const double dir[3])
{
    return dir[0] == 0 && dir[1] == 0 && dir[2] == 0;
}

size_t
rad_points_bytes(int width, int height)
{
    return RAD_POINTS_HEAD + (size_t)width * (size_t)height * RAD_POINT_BYTES;
}

/* --- reading --- */

/* RAD_EDATA if a number is not finite, or there are more than p->n points. */
static int
check_points(const struct rad_points *p, struct rad_error *err)
{
    uint32_t n = 0;
    double v[6];

    for (int y = 0; y < p->height; y++)
        for (int x = 0; x < p->width; x++) {
            n += rad_points_at(p, x, y, v, v + 3);
            for (int k = 0; k < 6; k++)
                if (!isfinite(v[k]))
                    return rad_fail(err, RAD_EDATA,
                                    "a point with a number that is not finite");
        }
    return n <= p->n
               ? 0
               : rad_fail(err, RAD_EDATA,
                          "%u sensor points where %u are said to be", n, p->n);
}

int
rad_points_open(struct rad_points *p, const void *bytes, size_t n,
                struct rad_error *err)
{
    const uint8_t *b = bytes;
    uint32_t width, height;

    memset(p, 0, sizeof *p);
    if (n < RAD_POINTS_HEAD || memcmp(b, magic, sizeof magic) != 0)
        return rad_fail(err, RAD_EDATA, "no file of sensor points");
    p->flags = get_u32(b + 8);
    width = get_u32(b + 12);
    height = get_u32(b + 16);
    p->n = get_u32(b + 20);
    p->first = get_u64(b + 24);
    n -= RAD_POINTS_HEAD;
    if (p->flags & ~RAD_POINTS_FLAGS || width < 1 || height < 1 ||
        width > 2 * RAD_MAX_POINTS || height > 2 * RAD_MAX_POINTS ||
        p->n > RAD_MAX_POINTS || n % RAD_POINT_BYTES != 0 ||
        n / RAD_POINT_BYTES != (uint64_t)width * height)
        return rad_fail(err, RAD_EDATA, "a file of sensor points is damaged");
    p->width = (int)width;
    p->height = (int)height;
    p->bytes = b + RAD_POINTS_HEAD;
    return check_points(p, err);
}

static const uint8_t *
bytes_of(const struct rad_points *p, int x, int y)
{
    return p->bytes +
           ((size_t)y * (size_t)p->width + (size_t)x) * RAD_POINT_BYTES;
}

uint64_t
rad_points_number(const struct rad_points *p, int x, int y)
{
    return p->first + get_u32(bytes_of(p, x, y) + 48);
}

bool
rad_points_at(const struct rad_points *p, int x, int y, double org[3],
              double dir[3])
{
    const uint8_t *at = bytes_of(p, x, y);

    for (int k = 0; k < 3; k++) {
        org[k] = rad_double_of(get_u64(at + 8 * k));
        dir[k] = rad_double_of(get_u64(at + 24 + 8 * k));
    }
    return !is_nowhere(dir);
}

/* --- layout --- */

/* The place of a point in the order of the curve. */
struct place {
    uint64_t at; /* number on the curve */
    uint32_t i;  /* index of the point */
};

static int
by_place(const void *a, const void *b)
{
    const struct place *x = a, *y = b;

    return x->at != y->at ? (x->at < y->at ? -1 : 1)
                          : (x->i > y->i) - (x->i < y->i);
}

/* The bounding cube of all origins: sets its corner, and returns the number of
 * cells per unit of length; 0: all points lie in one cell. */
static double
grid_of(const double (*point)[6], uint32_t n, double corner[3])
{
    double side = 0, scale;

    for (int k = 0; k < 3; k++) {
        double lo = point[0][k], hi = lo;

        for (uint32_t i = 1; i < n; i++) {
            lo = fmin(lo, point[i][k]);
            hi = fmax(hi, point[i][k]);
        }
        corner[k] = lo;
        side = fmax(side, hi - lo);
    }
    scale = ((UINT32_C(1) << RAD_CURVE_BITS) - 1) / side;
    /* 0 if there is no extent, or it is too large for a double */
    return isfinite(scale) ? scale : 0;
}

static struct place *
sort_points(const double (*point)[6], uint32_t n)
{
    struct place *place = malloc(n * sizeof *place);
    double corner[3], scale = grid_of(point, n, corner);

    if (!place)
        return NULL;
    for (uint32_t i = 0; i < n; i++) {
        uint32_t cell[3];

        for (int k = 0; k < 3; k++)
            cell[k] =
                scale > 0 ? (uint32_t)((point[i][k] - corner[k]) * scale) : 0;
        place[i] = (struct place){ rad_curve_in_cube(cell), i };
    }
    qsort(place, n, sizeof *place, by_place);
    return place;
}

/* Squares of side 2^bits make a picture that is two to eight times as high as
 * wide, with at most a third more pixels than points. */
static int
bits_for(uint32_t n)
{
    int bits = 0;

    while ((uint64_t)8 << 2 * bits < n)
        bits++;
    return bits;
}

int
rad_points_lay(const double (*point)[6], uint32_t n, int *width, int *height,
               uint32_t *pixel, struct rad_error *err)
{
    struct place *place = sort_points(point, n);
    int bits = bits_for(n);
    uint32_t square = UINT32_C(1) << 2 * bits, last = 0, cell[2];

    if (!place)
        return rad_fail_memory(err);
    for (uint32_t k = 0; k < n; k++) {
        rad_curve_in_square(bits, k % square, cell);
        cell[0] += k / square << bits; /* the row, in the picture */
        last = cell[0] > last ? cell[0] : last;
        pixel[place[k].i] = (cell[0] << bits) + cell[1];
    }
    free(place);
    *width = 1 << bits;
    *height = (int)last + 1;
    return 0;
}

uint8_t *
rad_points_pack(const double (*point)[6], uint32_t n, uint64_t first,
                uint32_t flags, int width, int height, const uint32_t *pixel)
{
    uint8_t *b = calloc(rad_points_bytes(width, height), 1);

    if (!b)
        return NULL;
    memcpy(b, magic, sizeof magic);
    put_u32(b + 8, flags);
    put_u32(b + 12, (uint32_t)width);
    put_u32(b + 16, (uint32_t)height);
    put_u32(b + 20, n);
    put_u64(b + 24, first);
    for (uint32_t i = 0; i < n; i++) {
        uint8_t *at = b + RAD_POINTS_HEAD + (size_t)pixel[i] * RAD_POINT_BYTES;

        for (int k = 0; k < 6; k++)
            put_u64(at + 8 * k, rad_bits_of(point[i][k]));
        put_u32(at + 48, i);
    }
    return b;
}
