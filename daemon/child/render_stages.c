/* render_stages.c - the stages of a job's child
 *
 * A stage has other options than the one before: all that is made of them is
 * made anew. */
#include "config.h"

#include "child/render_impl.h"

static int
take_stage(struct render *r, const struct msg_stage *m, struct rad_error *err)
{
    struct render_passes *k = &r->passes;
    struct msg_spec spec = r->start.job_start;
    int rc;

    if (!render_has_stages(r) || !k->passes || m->pass < k->base + k->next ||
        render_cache_is_whole(r))
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
