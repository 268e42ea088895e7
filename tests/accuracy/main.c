/* main.c - the renderer against closed forms
 *
 * usage: accuracy [--table] [WORDS]
 * Prints the rows that are off by more than they may be; with --table all, and
 * with 200 times as many rays where rays are counted.  WORDS: only rows whose
 * name has them.  Exit status 1 if any row is off. */
#include "config.h"

#include "accuracy.h"
#include "hard.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int
run(const struct row *rows, bool table, const char *words)
{
    int bad = 0;

    for (; rows->name; rows++) {
        if (!strstr(rows->name, words))
            continue;
        struct stage s = { .effort = 1 };
        struct outcome o = rows->measure(&s, rows->a);
        double error = fabs(o.found / o.truth - 1);
        bool ok = error <= rows->tolerance; /* not if it is no number */

        stage_close(&s);
        bad += !ok;
        if (table)
            printf("| %s | %.7g | %.7g | %.1e | %.0e |\n", rows->name, o.truth,
                   o.found, error, rows->tolerance);
        if (!ok)
            fprintf(stderr, "accuracy: %s: %.9g, not %.9g: off by %.1e\n",
                    rows->name, o.found, o.truth, error);
    }
    return bad;
}

static int
run_hard(const struct hard_row *rows, const char *title, bool table,
         const char *words)
{
    int bad = 0;

    if (table)
        printf("\n| %s | measured | held to |\n| --- | --- | --- |\n", title);
    for (; rows->name; rows++) {
        if (!strstr(rows->name, words))
            continue;
        struct stage s = { .effort = table ? 200 : 1 };
        double found = rows->measure(&s, rows->a);
        bool ok = found <= rows->most;

        stage_close(&s);
        bad += !ok;
        if (table)
            printf("| %s | %.2g | %g |\n", rows->name, found, rows->most);
        if (!ok)
            fprintf(stderr, "accuracy: %s: %g, not %g\n", rows->name, found,
                    rows->most);
    }
    return bad;
}

int
main(int argc, char **argv)
{
    bool table = argc > 1 && strcmp(argv[1], "--table") == 0;
    const char *words = argc > 1 + table ? argv[1 + table] : "";
    int bad;

    if (table)
        puts("| case | formula | found | relative error | held to |\n"
             "| --- | --- | --- | --- | --- |");
    bad =
        run(light_rows, table, words) + run(sky_rows, table, words) +
        run(matter_rows, table, words) +
        run_hard(bounce_rows, "indirect light: relative error", table, words) +
        run_hard(hard_rows, "hard case", table, words);
    return bad ? EXIT_FAILURE : EXIT_SUCCESS;
}
