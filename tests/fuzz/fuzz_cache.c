/* fuzz_cache.c - any bytes as the file of a job's passes */
#include "config.h"

#include "folder/folder.h"

#include <assert.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct saved_pass pass[MSG_MOST_PASSES];
    uint32_t n;
    size_t end = folder_parse_passes(data, size, pass, &n);
    uint64_t sum = 0;

    assert(end <= size && n <= MSG_MOST_PASSES);
    for (uint32_t i = 0; i < n; i++) {
        assert(pass[i].len <= size);
        for (size_t k = 0; k < pass[i].len; k++)
            sum += pass[i].bytes[k];
    }
    return sum == UINT64_MAX; /* so that every byte is read */
}
