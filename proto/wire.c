/* wire.c - see wire.h */
#include "config.h"

#include "proto/wire.h"

#include "base/bits.h"
#include "base/text.h"

#include <stdlib.h>
#include <string.h>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

static bool
utf8_valid(const uint8_t *s, size_t n)
{
    while (n > 0) {
        size_t k = rad_text_char((const char *)s, n, NULL);

        if (k == 0)
            return false;
        s += k;
        n -= k;
    }
    return true;
}

void
wire_in_init(struct wire_in *in, const void *data, size_t n)
{
    const uint8_t *p = data;

    *in = (struct wire_in){ .p = p, .end = n > 0 ? p + n : p };
}

const uint8_t *
wire_get_view(struct wire_in *in, size_t n)
{
    const uint8_t *p = in->p;

    if (in->bad || n > wire_left(in)) {
        in->bad = true;
        return NULL;
    }
    in->p += n;
    return p;
}

static uint64_t
get_be(struct wire_in *in, int n)
{
    const uint8_t *p = wire_get_view(in, (size_t)n);

    return p ? rad_load_be(p, n) : 0;
}

uint8_t
wire_get_u8(struct wire_in *in)
{
    return (uint8_t)get_be(in, 1);
}

uint16_t
wire_get_u16(struct wire_in *in)
{
    return (uint16_t)get_be(in, 2);
}

uint32_t
wire_get_u32(struct wire_in *in)
{
    return (uint32_t)get_be(in, 4);
}

uint64_t
wire_get_u64(struct wire_in *in)
{
    return get_be(in, 8);
}

int32_t
wire_get_i32(struct wire_in *in)
{
    uint32_t u = wire_get_u32(in);
    int32_t v;

    memcpy(&v, &u, sizeof v);
    return v;
}

float
wire_get_f32(struct wire_in *in)
{
    uint32_t u = wire_get_u32(in);
    float v;

    memcpy(&v, &u, sizeof v);
    return v;
}

double
wire_get_f64(struct wire_in *in)
{
    uint64_t u = wire_get_u64(in);
    double v;

    memcpy(&v, &u, sizeof v);
    return v;
}

void
wire_get_bytes(struct wire_in *in, void *dst, size_t n, size_t cap)
{
    const uint8_t *p;

    if (n > cap) {
        in->bad = true;
        return;
    }
    p = wire_get_view(in, n);
    if (p)
        memcpy(dst, p, n);
    else
        memset(dst, 0, n);
}

const char *
wire_get_str(struct wire_in *in, size_t max)
{
    size_t n = wire_get_u16(in);
    const uint8_t *p = wire_get_view(in, n + 1);

    if (!p || n > max || p[n] != '\0' || memchr(p, '\0', n) ||
        !utf8_valid(p, n)) {
        in->bad = true;
        return "";
    }
    return (const char *)p;
}

const uint8_t *
wire_get_blob(struct wire_in *in, size_t max, size_t *n)
{
    const uint8_t *p;

    *n = wire_get_u32(in);
    if (*n > max)
        in->bad = true;
    p = wire_get_view(in, *n);
    if (!p)
        *n = 0;
    return p;
}

uint32_t
wire_get_count(struct wire_in *in, size_t entry_min, uint32_t max)
{
    uint32_t n = wire_get_u32(in);

    if (n > max || n > wire_left(in) / entry_min) {
        in->bad = true;
        return 0;
    }
    return n;
}

void
wire_out_init(struct wire_out *out, size_t max)
{
    *out = (struct wire_out){ .max = max };
}

void
wire_out_release(struct wire_out *out)
{
    free(out->buf);
    *out = (struct wire_out){ 0 };
}

/* Room for n more bytes; NULL, with bad set, if there is none. */
static uint8_t *
out_room(struct wire_out *out, size_t n)
{
    size_t cap = out->cap ? out->cap : 256;
    uint8_t *p;

    if (out->bad || n > out->max - out->len) {
        out->bad = true;
        return NULL;
    }
    while (cap - out->len < n)
        cap *= 2; /* max is far below SIZE_MAX / 2 */
    if (cap != out->cap) {
        p = realloc(out->buf, cap);
        if (!p) {
            out->bad = out->nomem = true;
            return NULL;
        }
        out->buf = p;
        out->cap = cap;
    }
    p = out->buf + out->len;
    out->len += n;
    return p;
}

static void
put_be(struct wire_out *out, uint64_t v, int n)
{
    uint8_t *p = out_room(out, (size_t)n);

    if (p)
        rad_store_be(p, v, n);
}

void
wire_put_u8(struct wire_out *out, uint8_t v)
{
    put_be(out, v, 1);
}

void
wire_put_u16(struct wire_out *out, uint16_t v)
{
    put_be(out, v, 2);
}

void
wire_put_u32(struct wire_out *out, uint32_t v)
{
    put_be(out, v, 4);
}

void
wire_put_u64(struct wire_out *out, uint64_t v)
{
    put_be(out, v, 8);
}

void
wire_put_i32(struct wire_out *out, int32_t v)
{
    put_be(out, (uint32_t)v, 4);
}

void
wire_put_f32(struct wire_out *out, float v)
{
    uint32_t u;

    memcpy(&u, &v, sizeof u);
    put_be(out, u, 4);
}

void
wire_put_f64(struct wire_out *out, double v)
{
    uint64_t u;

    memcpy(&u, &v, sizeof u);
    put_be(out, u, 8);
}

void
wire_put_bytes(struct wire_out *out, const void *src, size_t n)
{
    uint8_t *p = out_room(out, n);

    if (p && n > 0)
        memcpy(p, src, n);
}

void
wire_clean(char *s)
{
    size_t n = strlen(s);

    for (size_t i = 0; i < n;) {
        size_t k = rad_text_char(s + i, n - i, NULL);

        if (k == 0)
            s[i] = '?';
        i += k > 0 ? k : 1;
    }
}

void
wire_put_str(struct wire_out *out, const char *s, size_t max)
{
    size_t n = s ? strlen(s) : 0;
    uint8_t *p;

    if (n > max || n > UINT16_MAX) {
        out->bad = true;
        return;
    }
    wire_put_u16(out, (uint16_t)n);
    p = out_room(out, n + 1);
    if (!p)
        return;
    if (n > 0)
        memcpy(p, s, n);
    p[n] = '\0';
    wire_clean((char *)p);
}

void
wire_put_blob(struct wire_out *out, const void *src, size_t n, size_t max)
{
    if (n > max || n > UINT32_MAX) {
        out->bad = true;
        return;
    }
    wire_put_u32(out, (uint32_t)n);
    wire_put_bytes(out, src, n);
}

void
wire_set_u32(struct wire_out *out, size_t at, uint32_t v)
{
    if (out->bad || out->len < 4 || at > out->len - 4)
        out->bad = true;
    else
        rad_store_be(out->buf + at, v, 4);
}

/* Change a float's bits from the machine's byte order to big-endian, or back.
 */
static uint32_t
big_endian(uint32_t u)
{
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    return __builtin_bswap32(u);
#else
    return u;
#endif
}

/* Copy n floats in the other byte order.  Rows of pictures come through here,
 * so four are done at a time where vectors are quick: swap the bytes of each
 * half, then the halves. */
static void
copy_big_endian(uint8_t *dst, const uint8_t *src, size_t n)
{
    size_t i = 0;

#ifdef __SSE2__
    for (; n - i >= 4; i += 4) {
        __m128i v = _mm_loadu_si128((const __m128i *)(src + 4 * i));

        v = _mm_or_si128(_mm_slli_epi16(v, 8), _mm_srli_epi16(v, 8));
        v = _mm_shufflelo_epi16(v, _MM_SHUFFLE(2, 3, 0, 1));
        v = _mm_shufflehi_epi16(v, _MM_SHUFFLE(2, 3, 0, 1));
        _mm_storeu_si128((__m128i *)(dst + 4 * i), v);
    }
#endif
    for (; i < n; i++) {
        uint32_t u;

        memcpy(&u, src + 4 * i, sizeof u);
        u = big_endian(u);
        memcpy(dst + 4 * i, &u, sizeof u);
    }
}

void
wire_floats_get(float *dst, const uint8_t *src, size_t n)
{
    copy_big_endian((uint8_t *)dst, src, n);
}

void
wire_floats_put(uint8_t *dst, const float *src, size_t n)
{
    copy_big_endian(dst, (const uint8_t *)src, n);
}
