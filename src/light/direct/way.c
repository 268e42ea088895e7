/* way.c - see way.h */
#include "config.h"

#include "light/direct/way.h"
#include "light/direct/sources.h"
#include "base/vec.h"
#include "trace/asks.h"

#include <float.h>

bool
rad_way_aim(struct rad_ctx *ctx, const struct rad_hit *from, int32_t source,
            const double dir[3], struct rad_span *span, struct rad_hit *hit)
{
    const struct rad_sources *s = ctx->job->sources;

    rad_copy(span->dir, dir);
    rad_geom_leave(from, dir, span->org);
    span->tmin = 0;
    span->tmax = INFINITY;
    if (rad_source_distant(s, source))
        return true;
    if (!rad_geom_hit_object(ctx->job->geom, rad_source_target(s, source), span,
                             hit, &ctx->counts.geom))
        return false;
    double cosine = rad_most(fabs(rad_dot(hit->n, dir)), DBL_MIN);
    double height = hit->t * cosine;

    /* both surfaces may be off by their error bounds */
    span->tmax =
        (height - rad_flush_gap(hit->p, hit->n, height) - 2 * hit->err) /
        cosine;
    return span->tmax > 0;
}

bool
rad_way_faces(const struct rad_sources *s, int32_t source,
              const struct rad_hit *at)
{
    return source < s->n ||
           rad_virtual_faces(&s->virtuals[source - s->n], at->p, at->err);
}

/* Reflect dir at a mirror, which is met at hit, and aim the next stretch of the
 * way at a source or image.  *span and *next as in rad_way_aim(). */
static bool
turn(struct rad_ctx *ctx, int32_t source, const struct rad_hit *hit,
     double dir[3], struct rad_span *span, struct rad_hit *next)
{
    rad_madd(dir, dir, -2 * rad_dot(dir, hit->n), hit->n);
    rad_normalize(dir);
    return rad_way_faces(ctx->job->sources, source, hit) &&
           rad_way_aim(ctx, hit, source, dir, span, next);
}

bool
rad_way_leads(struct rad_ctx *ctx, const struct rad_virtual *v,
              const double dir[3], const struct rad_hit *hit)
{
    const struct rad_sources *s = ctx->job->sources;
    struct rad_hit at[2];
    struct rad_span span;
    double d[3];
    int k = 0;

    rad_copy(d, dir);
    for (int32_t from = v->from; !rad_source_distant(s, from);
         from = s->virtuals[from - s->n].from) {
        if (!turn(ctx, from, hit, d, &span, &at[k]))
            return false;
        if (from < s->n)
            return true;
        hit = &at[k];
        k = !k;
    }
    return true;
}

/* A way that is being followed. */
struct follow {
    struct rad_ctx *ctx;
    struct rad_hit at; /* the last hit: on a mirror, a pane or the source */
    struct rad_rgb T;  /* product of the colours met so far */
    uint64_t stretches, panes; /* passed so far; they count as rays, although no
                                * rays are made */
};

/* Pass the panes on a stretch, of which the first is at f->at.  CLEAR: f->at is
 * the stretch's target, unless that is distant. */
static enum rad_sight
pass_panes(struct follow *f, int32_t source, const struct rad_span *span,
           const struct rad_line *line)
{
    const struct rad_job *job = f->ctx->job;
    int32_t target = rad_source_target(job->sources, source);

    if (job->cut || !job->params.backvis)
        return RAD_SIGHT_VEILED;
    for (int i = 1; f->at.obj != target; i++) {
        struct rad_hit pane = f->at;
        struct rad_rgb T;
        double org[3];

        if (!rad_glass_plain(job, &pane, span->dir, &T))
            return RAD_SIGHT_VEILED;
        f->T = rad_rgb_mul(f->T, T);
        if (rad_rgb_black(f->T))
            return RAD_SIGHT_BLOCKED;
        f->panes++;
        rad_geom_leave(&pane, span->dir, org);
        switch (rad_geom_beyond(job->geom, line, i, &pane, org, span->dir,
                                &f->at)) {
        case RAD_BEYOND_MET:
            break;
        case RAD_BEYOND_NONE:
            return rad_source_distant(job->sources, source) ? RAD_SIGHT_CLEAR
                                                            : RAD_SIGHT_VEILED;
        default:
            return RAD_SIGHT_VEILED;
        }
    }
    return RAD_SIGHT_CLEAR;
}

/* Follow the way from the mirror of v, which is met at f->at, to the source. */
static enum rad_sight
follow_mirrors(struct follow *f, const struct rad_virtual *v,
               const double dir[3])
{
    const struct rad_job *job = f->ctx->job;
    const struct rad_sources *s = job->sources;
    struct rad_span span;
    double d[3];

    rad_copy(d, dir);
    for (int32_t from = v->from;; from = s->virtuals[from - s->n].from) {
        int32_t target = rad_source_target(s, from);
        enum rad_sight seen;
        struct rad_line line;
        struct rad_hit next, veil;

        if (!turn(f->ctx, from, &f->at, d, &span, &next))
            return RAD_SIGHT_BLOCKED;
        f->stretches++;
        seen = rad_geom_sight(job->geom, &span, target,
                              &f->ctx->last_blocker[from], &veil, &line,
                              &f->ctx->counts.geom);
        f->at = seen == RAD_SIGHT_VEILED ? veil : next;
        if (seen == RAD_SIGHT_VEILED)
            seen = pass_panes(f, from, &span, &line);
        if (seen != RAD_SIGHT_CLEAR || from < s->n)
            return seen;
    }
}

/* Count the way's rays and set *T, unless it is VEILED. */
static enum rad_sight
finish(const struct follow *f, enum rad_sight seen, struct rad_rgb *T)
{
    if (seen == RAD_SIGHT_VEILED)
        return seen;
    f->ctx->counts.rays += f->stretches + f->panes;
    f->ctx->counts.shadow_rays += f->stretches;
    *T = f->T;
    return seen;
}

enum rad_sight
rad_way_clear(struct rad_ctx *ctx, const struct rad_virtual *v,
              const double dir[3], const struct rad_hit *hit, struct rad_rgb *T)
{
    struct follow f = { .ctx = ctx, .at = *hit, .T = *T };

    return finish(&f, follow_mirrors(&f, v, dir), T);
}

enum rad_sight
rad_way_through(struct rad_ctx *ctx, int32_t source,
                const struct rad_span *span, const struct rad_hit *hit,
                const struct rad_line *line, struct rad_rgb *T)
{
    const struct rad_sources *s = ctx->job->sources;
    struct follow f = { .ctx = ctx, .at = *hit, .T = *T };
    enum rad_sight seen = pass_panes(&f, source, span, line);

    if (seen == RAD_SIGHT_CLEAR && source >= s->n)
        seen = follow_mirrors(&f, &s->virtuals[source - s->n], span->dir);
    return finish(&f, seen, T);
}
