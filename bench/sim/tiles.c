/* tiles.c - see tiles.h */
#include "config.h"

#include "tiles.h"

#include "tests/sim/event.h"
#include "machine/jobtext.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* More tiles than that of a pass are damage. */
#define MOST_TILES 10000000

static bool
read_pass(struct tiles *t, FILE *f)
{
    struct tile_pass *p = &t->pass[t->npasses];
    int level, step;

    if (t->npasses == RAD_MOST_PASSES ||
        fscanf(f, "%d %d %" SCNu32 " %lf\n", &level, &step, &p->n,
               &p->begin_s) != 4 ||
        p->n > MOST_TILES)
        return false;
    t->npasses++;
    p->tile = sim_alloc((p->n + 1) * sizeof *p->tile);
    for (uint32_t i = 0; i < p->n; i++) {
        struct tile_cost *c = &p->tile[i];

        if (fscanf(f, "tile %lf %" SCNu64 " %" SCNu32 "\n", &c->seconds,
                   &c->rays, &c->records) != 3)
            return false;
        t->passes_s += c->seconds;
    }
    return true;
}

static bool
read_lines(struct tiles *t, FILE *f)
{
    char word[16];

    if (fscanf(f, "params %3999[^\n]\n", t->params) != 1)
        return false;
    while (fscanf(f, "%15s ", word) == 1 && strcmp(word, "pass") == 0)
        if (!read_pass(t, f))
            return false;
    return strcmp(word, "picture") == 0 &&
           fscanf(f, "%d %d %lf %lf", &t->width, &t->height, &t->live_s,
                  &t->picture_s) == 4;
}

/* Are the passes those that a coordinator will give out? */
static int
check_plan(struct tiles *t, struct rad_error *err)
{
    struct rad_pass_size size = { t->width, t->height };
    struct rad_pass plan[RAD_MOST_PASSES];
    struct rad_params params;
    int rc = jobtext_params(t->params, &params, err);
    uint32_t n;

    if (rc < 0)
        return rc;
    n = rad_passes_plan(&params, &size, 1, plan);
    for (uint32_t i = 0; i < n && n == t->npasses; i++) {
        t->pass[i].reads = plan[i].reads;
        t->pass[i].alone = plan[i].walks || rad_pass_is_last(plan, n, i);
        if (plan[i].tiles != t->pass[i].n)
            n = 0;
    }
    return n == t->npasses
               ? 0
               : rad_fail(err, RAD_EDATA,
                          "passes are planned otherwise by now: write the file "
                          "again");
}

int
tiles_read(struct tiles *t, const char *file, struct rad_error *err)
{
    FILE *f = fopen(file, "r");
    bool ok;

    memset(t, 0, sizeof *t);
    if (!f)
        return rad_fail(err, RAD_ENOINPUT, "cannot open '%s': %s", file,
                        strerror(errno));
    ok = read_lines(t, f);
    fclose(f);
    return ok ? check_plan(t, err)
              : rad_fail(err, RAD_EDATA, "'%s' is no whole file of tiles",
                         file);
}

void
tiles_scale(struct tiles *t, double seconds)
{
    double by = seconds / (t->passes_s + t->picture_s);

    t->live_s *= by;
    t->picture_s *= by;
    t->passes_s *= by;
    for (uint32_t i = 0; i < t->npasses; i++)
        for (uint32_t k = 0; k < t->pass[i].n; k++)
            t->pass[i].tile[k].seconds *= by;
}

void
tiles_release(struct tiles *t)
{
    for (uint32_t i = 0; i < t->npasses; i++)
        free(t->pass[i].tile);
    memset(t, 0, sizeof *t);
}
