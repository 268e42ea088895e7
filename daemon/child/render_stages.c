/* render_stages.c - the stages of a goal, in a job's child
 *
 * Each stage has other options, so all but the scene is made again.  Pictures
 * are made over the cache of the last stage, with --samples of their own
 * (SHOW). */
#include "config.h"

#include "child/render_impl.h"
#include "machine/jobtext.h"

static int
take_stage(struct render *r, const struct msg_stage *m, struct rad_error *err)
{
    struct render_passes *k = &r->passes;
    struct msg_spec spec = r->start.job_start;
    int rc;

    if (!msg_has_goal(&r->start.job_start) || !k->passes ||
        m->pass < k->base + k->next || render_cache_is_whole(r))
        return rad_fail(err, RAD_EPROTO,
                        "a stage from pass %u on does not fit the job",
                        m->pass);
    spec.params = m->params;
    render_keep_tally(r);
    render_unload_job(r);
    k->base = m->pass;
    rc = render_load(r, &spec, err);
    return rc;
}

void
render_take_stage(struct render *r, const struct msg_stage *m)
{
    struct rad_error err = { 0 };

    if (take_stage(r, m, &err) < 0)
        render_fail(r, &err);
}

static int
take_show(struct render *r, const struct msg_stage *m, struct rad_error *err)
{
    struct render_passes *k = &r->passes;
    struct rad_params params;

    if (!msg_has_goal(&r->start.job_start) || !k->passes ||
        m->pass + 1 != k->base + k->n || !render_cache_is_whole(r))
        return rad_fail(err, RAD_EPROTO,
                        "pictures after pass %u do not fit the job", m->pass);
    if (k->shown) /* SHOW came before the connection broke */
        return 0;
    if (jobtext_params(m->params, &params, err) < 0)
        return err->code;
    if (!pool_show(r->pool, r->job, params.samples))
        return rad_fail_memory(err);
    k->shown = true;
    return 0;
}

void
render_take_show(struct render *r, const struct msg_stage *m)
{
    struct rad_error err = { 0 };

    if (take_show(r, m, &err) < 0)
        render_fail(r, &err);
}
