/* fuzz_units.c - any text as a job's statistics, and as text of others
 *
 * Statistics that are taken make a chart whose spans lie within it; text that
 * is put into a page has nothing that a browser takes for its own. */
#include "config.h"

#include "web/chart.h"
#include "observer/units.h"
#include "tests/fuzz/fuzz.h"

#include <stdlib.h>
#include <string.h>

static void
check_spans(const struct units *u)
{
    if (u->nspans > UNITS_SPANS || u->nworkers > UNITS_WORKERS)
        abort();
    for (size_t i = 0; i < u->nspans; i++) {
        const struct units_span *s = &u->spans[i];

        if (s->worker >= u->nworkers || s->lane >= u->lanes[s->worker] ||
            !(s->start <= s->end) || (i > 0 && s->worker < s[-1].worker))
            abort();
    }
}

static void
check_text(const uint8_t *data, size_t size)
{
    char *s = malloc(size + 1), *text;
    struct markup m = { 0 };

    if (!s)
        return;
    memcpy(s, data, size);
    s[size] = '\0';
    markup_text(&m, s);
    text = markup_take(&m, NULL);
    if (text && strpbrk(text, "<>\"'\n\033"))
        abort();
    free(text);
    free(s);
}

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct markup m = { 0 };
    struct units u;

    check_text(data, size);
    if (units_read(&u, (const char *)data, size, NULL) < 0)
        return 0;
    check_spans(&u);
    chart_units(&m, &u);
    if (m.failed)
        abort();
    markup_release(&m);
    units_release(&u);
    return 0;
}
