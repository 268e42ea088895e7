/* job.c - contexts of threads, and counts; see job.h.  Jobs are made in
 * shade/compile.c. */
#include "config.h"

#include "trace/job.h"
#include "trace/asks.h"
#include "scene/calc/calc.h"

#include <stdlib.h>
#include <string.h>

int
rad_ctx_init(struct rad_ctx *ctx, const struct rad_job *job,
             struct rad_error *err)
{
    int32_t n = rad_sources_targets(job->sources);

    memset(ctx, 0, sizeof *ctx);
    ctx->job = job;
    rad_arena_init(&ctx->scratch);
    ctx->last_blocker =
        malloc((n > 0 ? (size_t)n : 1) * sizeof *ctx->last_blocker);
    ctx->bent = calloc(n > 0 ? (size_t)n : 1, sizeof *ctx->bent);
    if (!ctx->last_blocker || !ctx->bent) {
        rad_ctx_release(ctx);
        return rad_fail_memory(err);
    }
    for (int32_t i = 0; i < n; i++)
        ctx->last_blocker[i] = RAD_VOID;
    if (job->calc && !(ctx->calc = rad_calc_env_new(job->calc))) {
        rad_ctx_release(ctx);
        return rad_fail_memory(err);
    }
    return 0;
}

void
rad_counts_fault(struct rad_counts *c, int32_t object)
{
    struct rad_fault *f = c->faults;
    int at = 0;

    while (at < RAD_MAX_FAULTS && f[at].count > 0 && f[at].object < object)
        at++;
    if (at == RAD_MAX_FAULTS)
        return; /* no room for a later object */
    if (f[at].count == 0 || f[at].object != object) {
        memmove(f + at + 1, f + at,
                (size_t)(RAD_MAX_FAULTS - 1 - at) * sizeof *f);
        f[at] = (struct rad_fault){ object, 0 };
    }
    f[at].count++;
}

void
rad_counts_nan(struct rad_counts *c, int x, int y)
{
    if (c->nan_pixels++ == 0 || y < c->nan_y ||
        (y == c->nan_y && x < c->nan_x)) {
        c->nan_x = x;
        c->nan_y = y;
    }
}

void
rad_ctx_release(struct rad_ctx *ctx)
{
    rad_arena_release(&ctx->scratch);
    rad_calc_env_free(ctx->calc);
    ctx->calc = NULL;
    free(ctx->last_blocker);
    free(ctx->bent);
    ctx->last_blocker = NULL;
}
