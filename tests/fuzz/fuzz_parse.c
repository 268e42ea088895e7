/* fuzz_parse.c - any bytes as scene text, parsed and checked */
#include "config.h"

#include "scene/file/parse.h"
#include "tests/fuzz/fuzz.h"

#include <stdlib.h>

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct rad_scene *s = rad_scene_new();
    struct rad_error err = { 0 };
    int rc;

    if (!s)
        return 0;
    rc = rad_parse_text(s, (const char *)data, size, "fuzz.rad", NULL, &err);
    if (!rc)
        rc = rad_scene_check(s, NULL, NULL, &err);
    if (rc != err.code || (rc && !err.what[0]))
        abort();
    rad_scene_free(s);
    return 0;
}
