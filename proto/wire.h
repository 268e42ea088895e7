/* wire.h - bounded reading and writing of big-endian fields
 *
 * Both sides keep a sticky `bad` flag: a codec is straight-line code with one
 * check at its end.  A read that fails gives zeros and changes nothing else.
 * Floats travel as their IEEE bits.  A string is a u16 length, that many bytes
 * of UTF-8 without a NUL, and one NUL that the length does not count, so that
 * a reader can lend it out as a C string.
 * Thread: a wire_in or wire_out belongs to one thread. */
#ifndef WIRE_H
#define WIRE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct wire_in {
    const uint8_t *p, *end;
    bool bad;
    bool nomem;       /* bad because memory is out */
    unsigned version; /* of the layout that is read; wire.c ignores it */
};

/* A buffer that grows up to `max` bytes. */
struct wire_out {
    uint8_t *buf;
    size_t len, cap, max;
    bool bad;         /* too long, a bad argument, or memory is out */
    bool nomem;       /* bad because memory is out */
    unsigned version; /* of the layout that is written; wire.c ignores it */
};

/* Begin to read n bytes (0: data may be NULL), which are borrowed: strings and
 * views that are read point into them.  The version is none, 0, until the
 * caller sets it. */
void wire_in_init(struct wire_in *in, const void *data, size_t n);
static inline size_t
wire_left(const struct wire_in *in)
{
    return (size_t)(in->end - in->p);
}

uint8_t wire_get_u8(struct wire_in *in);
uint16_t wire_get_u16(struct wire_in *in);
uint32_t wire_get_u32(struct wire_in *in);
uint64_t wire_get_u64(struct wire_in *in);
int32_t wire_get_i32(struct wire_in *in);
float wire_get_f32(struct wire_in *in);
double wire_get_f64(struct wire_in *in);

/* Copy n bytes out.  Checks both ends: what is left and what fits. */
void wire_get_bytes(struct wire_in *in, void *dst, size_t n, size_t cap);

/* Lend n bytes; NULL when fewer are left. */
const uint8_t *wire_get_view(struct wire_in *in, size_t n);

/* Lend a string of at most max bytes; "" when the input is bad.  Checks that
 * the bytes are UTF-8 and that a NUL follows them. */
const char *wire_get_str(struct wire_in *in, size_t max);

/* Lend a u32 length and that many bytes, at most max. */
const uint8_t *wire_get_blob(struct wire_in *in, size_t max, size_t *n);

/* Read a u32 count of entries of at least entry_min bytes each; bad, and 0,
 * when fewer bytes are left or the count is above max. */
uint32_t wire_get_count(struct wire_in *in, size_t entry_min, uint32_t max);

void wire_out_init(struct wire_out *out, size_t max);
void wire_out_release(struct wire_out *out);

void wire_put_u8(struct wire_out *out, uint8_t v);
void wire_put_u16(struct wire_out *out, uint16_t v);
void wire_put_u32(struct wire_out *out, uint32_t v);
void wire_put_u64(struct wire_out *out, uint64_t v);
void wire_put_i32(struct wire_out *out, int32_t v);
void wire_put_f32(struct wire_out *out, float v);
void wire_put_f64(struct wire_out *out, double v);
void wire_put_bytes(struct wire_out *out, const void *src, size_t n);

/* Replace bytes that are not UTF-8 by '?', such as half a character where a
 * text was cut. */
void wire_clean(char *s);

/* Put a string of at most max bytes (NULL is ""); a longer one sets bad.  Bytes
 * that are not UTF-8 become '?'. */
void wire_put_str(struct wire_out *out, const char *s, size_t max);
void wire_put_blob(struct wire_out *out, const void *src, size_t n, size_t max);

/* Replace the four bytes at offset `at` by a u32. */
void wire_set_u32(struct wire_out *out, size_t at, uint32_t v);

/* Convert n floats from and to their bytes on the wire; src and dst may not
 * overlap. */
void wire_floats_get(float *dst, const uint8_t *src, size_t n);
void wire_floats_put(uint8_t *dst, const float *src, size_t n);

#endif
