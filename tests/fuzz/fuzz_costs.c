/* fuzz_costs.c - any bytes as the statistics of a former job */
#include "config.h"

#include "job/costs.h"
#include "tests/fuzz/fuzz.h"

#include <stdlib.h>

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct costs c;

    if (costs_parse(&c, (const char *)data, size, NULL) == 0) {
        struct msg_frame *f = calloc(c.nframes, sizeof *f);
        uint8_t *bytes = NULL;
        uint32_t n;

        for (uint32_t i = 0; f && i < c.nframes; i++) {
            f[i].width = c.frames[i].width;
            f[i].height = c.frames[i].height;
        }
        if (f)
            costs_of_lines(&c, &(struct frames){ .list = f, .n = c.nframes }, 4,
                           &bytes, &n, NULL);
        free(bytes);
        free(f);
    }
    costs_release(&c);
    return 0;
}
