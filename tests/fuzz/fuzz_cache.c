/* fuzz_cache.c - any bytes as the file of a job's passes, and as the one that
 * is kept of a job that is done */
#include "config.h"

#include "folder/folder.h"
#include "tests/fuzz/fuzz.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

/* It is put together in place. */
static void
parse_kept(const uint8_t *data, size_t size)
{
    uint8_t *bytes = malloc(size + 1);
    size_t n;

    if (!bytes)
        return;
    memcpy(bytes, data, size);
    n = folder_parse_kept(bytes, size);
    assert(n == FOLDER_NO_CACHE || n < size);
    free(bytes);
}

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct saved_pass pass[MSG_MOST_PASSES];
    uint32_t n;
    size_t end = folder_parse_passes(data, size, pass, &n);
    uint64_t sum = 0;

    if (size > 0)
        parse_kept(data, size);
    assert(end <= size && n <= MSG_MOST_PASSES);
    for (uint32_t i = 0; i < n; i++) {
        assert(pass[i].len <= size);
        for (size_t k = 0; k < pass[i].len; k++)
            sum += pass[i].bytes[k];
    }
    return sum == UINT64_MAX; /* so that every byte is read */
}
