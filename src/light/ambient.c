/* ambient.c - see ambient.h */
#include "config.h"

#include "light/ambient.h"

struct rad_ambient *
rad_ambient_new(const struct rad_job *job, struct rad_error *err)
{
    (void)job;
    rad_fail(err, RAD_EUNSUPPORTED, "option -ab: only 0 is supported");
    return NULL;
}

void
rad_ambient_free(struct rad_ambient *amb)
{
    (void)amb;
}

void
rad_ambient_apply(struct rad_ctx *ctx, struct rad_ray *r, const double n[3],
                  struct rad_rgb *coef)
{
    (void)r;
    (void)n;
    *coef = rad_rgb_mul(*coef, ctx->job->params.ambval);
}
