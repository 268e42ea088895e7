/* fuzz_ambfile.c - any bytes as a file of ambient records */
#include "config.h"

#include "records/ambfile.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "proto/ambshare.h"
#include "tests/fuzz/fuzz.h"

#include <stdio.h>
#include <stdlib.h>

/* Parse a file; returns how many records it has, all of them sound. */
static size_t
parse(struct ambfile *a, const void *bytes, size_t size, int *rc,
      struct rad_error *err)
{
    struct rad_ambrec rec;
    struct wire_out out;
    struct wire_in in;
    size_t n = 0;

    wire_out_init(&out, SIZE_MAX / 4);
    *rc = ambfile_parse(a, bytes, size, &out, err);
    wire_in_init(&in, out.buf, out.len);
    for (; wire_left(&in) > 0; n++) {
        ambshare_unpack(&in, &rec);
        assert(isfinite(rec.p[0]) && isfinite(rec.p[1]) && isfinite(rec.p[2]));
        assert(rec.radius[0] > 0 && rec.radius[1] > 0 && rec.weight > 0);
        assert(rec.E.r >= 0 && rec.E.g >= 0 && rec.E.b >= 0);
        assert(isfinite(rec.n[0]) && isfinite(rec.u[2]));
    }
    wire_out_release(&out);
    return n;
}

/* The same bytes as a list of what workers made: what is sound of it makes a
 * file that is read again, every record. */
static void
list(const uint8_t *data, size_t size)
{
    struct ambfile a = { .format = size & 1 ? AMBFILE_RADIANCE : AMBFILE_OURS };
    size_t len, n, sound = 0;
    struct rad_ambrec rec;
    struct wire_in in;
    char *text = NULL;
    int rc;
    FILE *f = open_memstream(&text, &len);

    assert(f);
    rad_params_init(&a.params);
    memset(a.scene, '0', RAD_SHA_HEX);
    wire_in_init(&in, data, size);
    while (wire_left(&in) >= AMBSHARE_BYTES)
        sound += ambshare_unpack(&in, &rec);
    assert(ambfile_format(&a, data, size, f, NULL) == 0);
    assert(fclose(f) == 0);
    n = parse(&a, text, len, &rc, NULL);
    assert(rc == 0);
    /* Radiance's numbers reach to 2^127, and what is beyond comes back as none
     * or as nothing */
    assert(a.format == AMBFILE_OURS ? n == sound : n <= sound);
    free(text);
}

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct rad_error err = { 0 };
    struct ambfile a = { .format = AMBFILE_OURS };
    size_t n;
    int rc;

    rad_params_init(&a.params);
    memset(a.scene, '0', RAD_SHA_HEX);
    n = parse(&a, data, size, &rc, &err);
    assert((rc == 0) == (err.code == 0));
    assert(rc == 0 || n == 0);
    assert(n <= size / 67);
    list(data, size);
    return 0;
}
