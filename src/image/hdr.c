/* hdr.c - writing of pictures: pixels, rows and the header; see hdr.h, and
 * hdrimpl.h for the format of a row */
#include "config.h"

#include "image/hdrimpl.h"
#include "image/pixel.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

enum {
    LONGEST_RUN = 127,
    LONGEST_LITERAL = 128,
    EXPONENT_BIAS = 128,
};

/* The text after the option `name` in a line of options; NULL: the option is
 * not there. */
static const char *
find_word(const char *options, const char *name)
{
    size_t n = strlen(name);

    for (const char *at = options; (at = strstr(at, name)) != NULL; at += n)
        if ((at == options || at[-1] == ' ') && (at[n] == ' ' || at[n] == '\0'))
            return at + n;
    return NULL;
}

/* Write the lines of a header that name a picture's format and primaries. */
static void
colour_lines(const char *options, char *buf, size_t size)
{
    const char *given = find_word(options, "-pc");
    double c[8];
    char *end;
    int n = 0;

    if (find_word(options, "-pXYZ")) {
        snprintf(buf, size, "FORMAT=32-bit_rle_xyze\n");
        return;
    }
    buf[0] = '\0';
    if (given)
        for (; n < 8; n++, given = end) {
            c[n] = strtod(given, &end);
            if (end == given)
                break;
        }
    if (n == 8) {
        n = snprintf(buf, size,
                     "PRIMARIES= %.4f %.4f %.4f %.4f %.4f %.4f %.4f %.4f\n",
                     c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7]);
        buf += n;
        size -= (size_t)n;
    }
    snprintf(buf, size, "FORMAT=32-bit_rle_rgbe\n");
}

int
rad_hdr_write_header(const struct rad_hdr_info *info,
                     const struct rad_sink *sink, struct rad_error *err)
{
    char text[16384], extra[96] = "", colour[160], software[128] = "";
    int n, used = 0;

    /* Radiance leaves it out within half a percent of 1 */
    if (fabs(info->pixaspect - 1) > .005)
        used = snprintf(extra, sizeof extra, "PIXASPECT=%f\n", info->pixaspect);
    if (info->frame > 0)
        snprintf(extra + used, sizeof extra - (size_t)used, "FRAME=%lu\n",
                 (unsigned long)info->frame);
    if (info->software)
        snprintf(software, sizeof software, "SOFTWARE= %s\n", info->software);
    colour_lines(info->options, colour, sizeof colour);
    n = snprintf(text, sizeof text,
                 "#?RADIANCE\n%s%s %s\n%s%s%s%s%s%s\n-Y %d +X %d\n",
                 info->origin ? info->origin : "", info->program,
                 info->options, software, info->view ? "VIEW= " : "",
                 info->view ? info->view : "", info->view ? "\n" : "", extra,
                 colour, info->height, info->width);
    if (n < 0 || (size_t)n >= sizeof text)
        return rad_fail(err, RAD_EINTERNAL, "picture header is too long");
    return sink->write(sink->arg, text, (size_t)n, err);
}

/* Radiance writes 0 for values up to 1e-32; this is the float below. */
#define LEAST_CODED 0x1.9f623cp-107f

static inline float
clamped(float v)
{
    return v > 0 ? v <= FLT_MAX ? v : FLT_MAX : 0; /* NaN is 0 */
}

/* v * scale, truncated, at most 255. */
static inline uint32_t
mantissa(float v, float scale)
{
    int32_t m = (int32_t)(v * scale);

    return (uint32_t)(m < UINT8_MAX ? m : UINT8_MAX);
}

/* The four bytes as one number, red lowest.  With most = m 2^e, m from .5 to 1,
 * the exponent is e and mantissas count 2^e / 256.  Multiplying by a power of
 * two is exact. */
static inline uint32_t
coded(struct rad_rgb L)
{
    float r = clamped(L.r), g = clamped(L.g), b = clamped(L.b), scale;
    float most = r > g ? r : g;
    uint32_t bits;
    int32_t e;

    most = most > b ? most : b;
    if (most <= LEAST_CODED)
        return 0;
    memcpy(&bits, &most, sizeof bits);
    e = (int32_t)(bits >> 23) - 126;
    e = e + EXPONENT_BIAS < UINT8_MAX ? e : UINT8_MAX - EXPONENT_BIAS;
    bits = (uint32_t)(8 - e + 127) << 23;
    memcpy(&scale, &bits, sizeof scale);
    return mantissa(r, scale) | mantissa(g, scale) << 8 |
           mantissa(b, scale) << 16 | (uint32_t)(e + EXPONENT_BIAS) << 24;
}

void
rad_rgbe(struct rad_rgb L, uint8_t rgbe[4])
{
    uint32_t c = coded(L);

    for (int i = 0; i < 4; i++)
        rgbe[i] = (uint8_t)(c >> 8 * i);
}

struct rad_rgb
rad_rgbe_radiance(const uint8_t rgbe[4])
{
    float step;

    if (rgbe[3] == 0)
        return rad_grey(0);
    step = ldexpf(1, rgbe[3] - (EXPONENT_BIAS + 8));
    return rad_rgb((rgbe[0] + .5f) * step, (rgbe[1] + .5f) * step,
                   (rgbe[2] + .5f) * step);
}

void
rad_hdr_spectrum(const float band[], int n, uint8_t *pixel)
{
    float most = 0;
    int exponent;

    for (int i = 0; i < n; i++)
        most = fmaxf(most, band[i]);
    memset(pixel, 0, (size_t)n + 1);
    if (most <= 1e-32f)
        return;
    frexpf(most, &exponent);
    exponent = exponent > 127 ? 127 : exponent;
    for (int i = 0; i < n; i++)
        pixel[i] = (uint8_t)fminf(ldexpf(fmaxf(band[i], 0), 8 - exponent), 255);
    pixel[n] = (uint8_t)(exponent + EXPONENT_BIAS);
}

/* A bit for each byte of a component that equals the next one, then zeros. */
struct alike {
    uint64_t bit[(LONGEST_CODED + 63) / 64 + 2];
};

static void
find_alike(const uint8_t *c, int n, struct alike *a)
{
    int i = 0;

#ifdef __SSE2__
    for (; n - i > 64; i += 64) {
        uint64_t bits = 0;

        for (int k = 0; k < 64; k += 16) {
            __m128i v = _mm_loadu_si128((const __m128i *)(c + i + k));
            __m128i w = _mm_loadu_si128((const __m128i *)(c + i + k + 1));

            bits |= (uint64_t)_mm_movemask_epi8(_mm_cmpeq_epi8(v, w)) << k;
        }
        a->bit[i / 64] = bits;
    }
#endif
    for (; i < n; i += 64) {
        uint64_t bits = 0;

        for (int k = 0; k < 64 && i + k + 1 < n; k++)
            bits |= (uint64_t)(c[i + k] == c[i + k + 1]) << k;
        a->bit[i / 64] = bits;
    }
    a->bit[i / 64] = a->bit[i / 64 + 1] = 0;
}

/* Bits i to i + 63. */
static inline uint64_t
bits_from(const struct alike *a, int i)
{
    const uint64_t *w = &a->bit[i / 64];

    return i % 64 ? w[0] >> i % 64 | w[1] << (64 - i % 64) : w[0];
}

/* The index of the next run of at least four equal bytes, from byte i of n on;
 * n if there is none.  A shorter run costs more than it saves. */
static inline int
find_run(const struct alike *a, int i, int n)
{
    for (; i < n; i += 62) { /* two of 64 bits have too few behind them */
        uint64_t same = bits_from(a, i);

        same &= same >> 1 & same >> 2;
        if (same)
            return i + __builtin_ctzll(same);
    }
    return n;
}

/* The length of the run of equal bytes that begins at i. */
static inline int
run_length(const struct alike *a, int i)
{
    uint64_t other = ~bits_from(a, i);
    int k = 1;

    if (!other) {
        k += 64;
        other = ~bits_from(a, i + 64);
    }
    k += other ? __builtin_ctzll(other) : 64;
    return k < LONGEST_RUN ? k : LONGEST_RUN;
}

/* memcpy() of few bytes; returns the end of out. */
static inline uint8_t *
copy(uint8_t *out, const uint8_t *c, int n)
{
    int i = 0;

    for (; n - i >= 8; i += 8)
        memcpy(out + i, c + i, 8);
    if (n >= 8) /* the last eight, maybe some of them twice */
        memcpy(out + n - 8, c + n - 8, 8);
    else
        for (; i < n; i++)
            out[i] = c[i];
    return out + n;
}

/* Code one component of n pixels; returns the end of out. */
static uint8_t *
encode_component(const uint8_t *c, int n, uint8_t *out)
{
    struct alike a;
    int i = 0;

    find_alike(c, n, &a);
    while (i < n) {
        int run = find_run(&a, i, n); /* start of the next run */

        while (i < run) { /* literals before it */
            int k = run - i < LONGEST_LITERAL ? run - i : LONGEST_LITERAL;

            *out++ = (uint8_t)k;
            out = copy(out, c + i, k);
            i += k;
        }
        if (i < n) {
            int k = run_length(&a, i);

            *out++ = (uint8_t)(128 + k);
            *out++ = c[i];
            i += k;
        }
    }
    return out;
}

/* A row's bytes, component by component. */
struct planes {
    uint8_t *c[4]; /* red, green, blue, exponent */
};

/* Rows are colours, or pixels with a distance: the number of floats for
 * each. */
enum { COLOURS = 3, PIXELS = 4 };

#ifdef __SSE2__
/* Load red, green and blue of four pixels. */
static inline void
load_four(const float *row, int step, __m128 v[3])
{
    __m128 p = _mm_loadu_ps(row);     /* r0 g0 b0 r1, or z0 */
    __m128 q = _mm_loadu_ps(row + 4); /* g1 b1 r2 g2, or r1 g1 b1 z1 */
    __m128 s = _mm_loadu_ps(row + 8); /* b2 r3 g3 b3, or r2 g2 b2 z2 */

    if (step == PIXELS) {
        __m128 t = _mm_loadu_ps(row + 12);

        _MM_TRANSPOSE4_PS(p, q, s, t);
        v[0] = p;
        v[1] = q;
        v[2] = s;
        return;
    }
    v[0] = _mm_shuffle_ps(p, _mm_shuffle_ps(q, s, _MM_SHUFFLE(1, 1, 2, 2)),
                          _MM_SHUFFLE(2, 0, 3, 0));
    v[1] = _mm_shuffle_ps(_mm_shuffle_ps(p, q, _MM_SHUFFLE(0, 0, 1, 1)),
                          _mm_shuffle_ps(q, s, _MM_SHUFFLE(2, 2, 3, 3)),
                          _MM_SHUFFLE(2, 0, 2, 0));
    v[2] = _mm_shuffle_ps(_mm_shuffle_ps(p, q, _MM_SHUFFLE(1, 1, 2, 2)), s,
                          _MM_SHUFFLE(3, 0, 2, 0));
}

/* coded() for four pixels at once; c gets their components. */
static inline void
code_four(const float *row, int step, __m128i c[4])
{
    const __m128 most_float = _mm_set1_ps(FLT_MAX), zero = _mm_setzero_ps();
    __m128 v[3], most, scale;
    __m128i e, none;

    load_four(row, step, v);
    for (int k = 0; k < 3; k++) /* if one value is NaN, the second is taken */
        v[k] = _mm_min_ps(_mm_max_ps(v[k], zero), most_float);
    most = _mm_max_ps(_mm_max_ps(v[0], v[1]), v[2]);
    none = _mm_castps_si128(_mm_cmple_ps(most, _mm_set1_ps(LEAST_CODED)));
    e = _mm_srli_epi32(_mm_castps_si128(most), 23);
    /* biased as in a float, where 126 means e = 0; 127 is the greatest e */
    e = _mm_add_epi32(e, _mm_cmpgt_epi32(e, _mm_set1_epi32(253)));
    scale = _mm_castsi128_ps(
        _mm_slli_epi32(_mm_sub_epi32(_mm_set1_epi32(8 + 126 + 127), e), 23));
    for (int k = 0; k < 3; k++)
        c[k] =
            _mm_andnot_si128(none, _mm_cvttps_epi32(_mm_mul_ps(v[k], scale)));
    c[3] = _mm_andnot_si128(none, _mm_add_epi32(e, _mm_set1_epi32(2)));
}

/* Code sixteen pixels from column x on; packing also limits values to 255. */
static inline void
code_sixteen(const float *row, int step, const struct planes *to, int x)
{
    __m128i c[4][4];

    for (int i = 0; i < 4; i++)
        code_four(row + (ptrdiff_t)(x + 4 * i) * step, step, c[i]);
    for (int k = 0; k < 4; k++)
        _mm_storeu_si128((__m128i *)(to->c[k] + x),
                         _mm_packus_epi16(_mm_packs_epi32(c[0][k], c[1][k]),
                                          _mm_packs_epi32(c[2][k], c[3][k])));
}
#endif

static inline struct rad_rgb
colour_at(const float *row, int step, int x)
{
    const float *p = row + (ptrdiff_t)x * step;

    return rad_rgb(p[0], p[1], p[2]);
}

static inline void
code_row(const float *row, int step, int width, const struct planes *to)
{
    int x = 0;

#ifdef __SSE2__
    for (; width - x >= 16; x += 16)
        code_sixteen(row, step, to, x);
#endif
    for (; x < width; x++) {
        uint32_t c = coded(colour_at(row, step, x));

        for (int k = 0; k < 4; k++)
            to->c[k][x] = (uint8_t)(c >> 8 * k);
    }
}

/* The work space of components is the upper half of a row's room; coded bytes
 * go to the lower half. */
static inline struct planes
planes_of(uint8_t *out, int width)
{
    uint8_t *upper = out + RAD_HDR_ROW_BYTES(width) / 2;

    return (struct planes){ { upper, upper + width, upper + 2 * width,
                              upper + 3 * width } };
}

static inline size_t
encode_planes(const struct planes *planes, int width, uint8_t *out)
{
    uint8_t *at = out;

    *at++ = 2;
    *at++ = 2;
    *at++ = (uint8_t)(width >> 8);
    *at++ = (uint8_t)(width & 255);
    for (int i = 0; i < 4; i++)
        at = encode_component(planes->c[i], width, at);
    return (size_t)(at - out);
}

static inline size_t
encode_row(const float *row, int step, int width, uint8_t *out)
{
    struct planes planes = planes_of(out, width);

    if (is_flat(width)) {
        for (int x = 0; x < width; x++)
            rad_rgbe(colour_at(row, step, x), out + 4 * (ptrdiff_t)x);
        return 4 * (size_t)width;
    }
    code_row(row, step, width, &planes);
    return encode_planes(&planes, width, out);
}

size_t
rad_hdr_encode_row(const struct rad_rgb *row, int width, uint8_t *out)
{
    return encode_row(&row->r, COLOURS, width, out);
}

size_t
rad_hdr_encode_pixels(const struct rad_pixel *row, int width, uint8_t *out)
{
    return encode_row(&row->L.r, PIXELS, width, out);
}

size_t
rad_hdr_encode_rgbe(const uint8_t *rgbe, int width, uint8_t *out)
{
    struct planes planes = planes_of(out, width);

    if (is_flat(width)) {
        memcpy(out, rgbe, 4 * (size_t)width);
        return 4 * (size_t)width;
    }
    for (int x = 0; x < width; x++)
        for (int k = 0; k < 4; k++)
            planes.c[k][x] = rgbe[4 * (ptrdiff_t)x + k];
    return encode_planes(&planes, width, out);
}
