/* fuzz_rif.c - any text as a file of rad's variables
 *
 * What is taken has words, options and views that can be asked for. */
#include "config.h"

#include "rif/rif_view.h"
#include "tests/fuzz/fuzz.h"

#include <stdlib.h>
#include <string.h>

static void
look_at_words(struct rif *r)
{
    for (int v = 0; v < RIF_VARS; v++) {
        const char *text = rif_text(r, (enum rif_var)v);
        char **words;
        int n = rif_words(r, (enum rif_var)v, &words, NULL);

        if ((text == NULL) != (r->first[v] == NULL) || (n >= 0 && words[n]))
            abort();
        for (int i = 0; i < n; i++)
            if (strlen(words[i]) > RIF_MAX_BYTES)
                abort();
    }
}

static void
look_at_meaning(struct rif *r)
{
    const struct rad_octree t = { .org = { -1, 0, 2 }, .size = 3 };
    char light[RIF_RULES_TEXT], sampling[RIF_RULES_TEXT];
    struct rif_view *views;
    struct rif_zone z;
    int n;

    if (rif_zone(r, &t, &z, NULL) < 0)
        return;
    if (rif_rules(r, &z, light, sampling, NULL) == 0 &&
        (strlen(light) > 400 || strlen(sampling) > 40))
        abort();
    n = rif_views(r, &z, NULL, &views, NULL);
    for (int i = 0; i < n; i++)
        if (views[i].words[views[i].nwords] || !views[i].name)
            abort();
    rif_views(r, &z, "b", &views, NULL);
}

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct rif r;

    if (rif_parse(&r, "fuzz", (const char *)data, size, NULL) == 0 &&
        rif_check(&r, NULL) == 0) {
        look_at_words(&r);
        look_at_meaning(&r);
    }
    rif_release(&r);
    return 0;
}
