/* fuzz_hdr.c - Radiance pictures */
#include "config.h"

#include "picture/hdr.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct rad_picture pic;
    struct rad_error err = { 0 };

    rad_hdr_read(data, size, 1 << 20, &pic, &err);
    rad_picture_release(&pic);
    return 0;
}
