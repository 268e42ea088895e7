/* fuzz_ambfile.c - any bytes as a file of ambient records */
#include "config.h"

#include "ambfile.h"

#include <assert.h>
#include <math.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void
take(void *arg, const struct rad_ambrec *rec)
{
    ++*(size_t *)arg;
    assert(isfinite(rec->p[0]) && isfinite(rec->p[1]) && isfinite(rec->p[2]));
    assert(rec->radius[0] > 0 && rec->radius[1] > 0 && rec->weight > 0);
    assert(rec->E.r >= 0 && rec->E.g >= 0 && rec->E.b >= 0);
    assert(isfinite(rec->n[0]) && isfinite(rec->u[2]));
}

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct rad_error err = { 0 };
    struct ambfile a = { .format = AMBFILE_OURS };
    size_t n = 0;
    int rc;

    rad_params_init(&a.params);
    memset(a.scene, '0', RAD_SHA_HEX);
    rc = ambfile_parse(&a, data, size, take, &n, &err);
    assert((rc == 0) == (err.code == 0));
    assert(rc == 0 || n == 0);
    assert(n <= size / 67);
    return 0;
}
