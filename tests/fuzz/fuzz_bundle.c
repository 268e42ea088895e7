/* fuzz_bundle.c - any bytes as a bundle's manifest */
#include "config.h"

#include "scene/file/bundle.h"
#include "tests/fuzz/fuzz.h"

#include <stdlib.h>
#include <string.h>

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct rad_bundle b;
    size_t len;
    char *text;

    if (rad_bundle_parse(&b, (const char *)data, size, NULL))
        return 0;
    /* what is accepted is what would be written */
    text = rad_bundle_format(&b, &len);
    if (text && (len != size || memcmp(text, data, size) != 0))
        abort();
    free(text);
    rad_bundle_release(&b);
    return 0;
}
