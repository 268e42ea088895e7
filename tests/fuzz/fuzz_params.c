/* fuzz_params.c - rendering options and option files
 *
 * What is taken must be printed and taken again to the same parameters. */
#include "config.h"

#include "base/params.h"
#include "tests/fuzz/fuzz.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_WORDS = 1024 };

static void
take_all(struct rad_params *p, char *text, bool strict)
{
    char *argv[MOST_WORDS], *state = NULL;
    int argc = 0;

    for (char *w = strtok_r(text, " \n", &state); w && argc < MOST_WORDS;
         w = strtok_r(NULL, " \n", &state))
        argv[argc++] = w;
    for (int i = 0; i < argc;) {
        int used = rad_params_option(p, argc - i, argv + i, NULL);

        if (strict && used < 1)
            abort();
        i += used > 0 ? used : 1;
    }
}

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct rad_params p, q;
    struct rad_error err = { 0 };
    char out[RAD_PARAMS_TEXT];
    char *text = malloc(size + 1);

    if (!text)
        return 0;
    memcpy(text, data, size);
    text[size] = '\0';
    rad_params_init(&p);
    rad_params_init(&q);
    take_all(&p, text, false);
    free(text);
    rad_params_check(&p, &err);
    rad_params_format(&p, out, sizeof out);
    take_all(&q, out, true);
    if (memcmp(&p, &q, sizeof p) != 0)
        abort();
    return 0;
}
