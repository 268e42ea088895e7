/* submit_results.c - pictures, previews and statistics; see submit_impl.h */
#include "config.h"

#include "link/submit_impl.h"

#include "link/fetch.h"

#include <stdlib.h>

enum {
    PREVIEW_MS = 1000,  /* least time between previews, */
    PREVIEW_SHARE = 10, /* plus the time that one takes, so many times */
};

/* Get a file of the job.  The caller frees f->bytes whatever is returned. */
static int
fetch(struct submit *s, uint32_t frame, enum msg_what what,
      struct rad_memory_out *f)
{
    const struct msg *m;
    int rc;

    *f = (struct rad_memory_out){ 0 };
    s->fetching = true;
    rc = fetch_start(s->link, s->job->spec->job, frame, what, ++s->request,
                     s->err);
    while (rc == 0) {
        rc = submit_next(s, &m);
        if (rc == 1)
            rc = m->request == s->request ? fetch_take(f, m, s->err) : 0;
    }
    s->fetching = false;
    return rc < 0 ? rc : 0;
}

int
submit_deliver_frame(struct submit *s)
{
    struct rad_memory_out picture = { 0 }, depth = { 0 };
    uint32_t flags = s->job->spec->flags;
    int rc = 0;

    if (!(flags & MSG_JOB_POINTS))
        rc = fetch(s, s->delivered, MSG_WHAT_PICTURE, &picture);
    if (rc == 0 && flags & MSG_JOB_DEPTH)
        rc = fetch(s, s->delivered, MSG_WHAT_DEPTH, &depth);
    if (rc == 0)
        rc = s->cb->frame(s->cb->arg, s->delivered, &picture, &depth, s->err);
    free(picture.bytes);
    free(depth.bytes);
    if (rc == 0)
        s->delivered++;
    return rc;
}

/* Returns 1; or 0 if there is no preview, which does no harm; or an error. */
static int
fetch_preview(struct submit *s, struct rad_memory_out *f)
{
    struct rad_error *err = s->err;
    struct rad_error why = { 0 };
    int rc;

    s->err = &why;
    rc = fetch(s, s->delivered, MSG_WHAT_PREVIEW, f);
    s->err = err;
    if (rc == 0 ||
        (s->ending != ENDING_OVER && rc != RAD_EUNAVAIL && rc != RAD_EPROTO))
        return rc < 0 ? 0 : 1;
    if (err)
        *err = why;
    return rc;
}

int
submit_preview(struct submit *s)
{
    uint64_t begin = submit_now_ms(s), end;
    struct rad_memory_out f;
    int rc;

    if (!s->cb->preview || begin < s->preview_due_ms)
        return 0;
    rc = fetch_preview(s, &f);
    if (rc == 1)
        rc = s->cb->preview(s->cb->arg, f.bytes, f.len, s->err);
    free(f.bytes);
    end = submit_now_ms(s);
    s->preview_due_ms = end + PREVIEW_MS + PREVIEW_SHARE * (end - begin);
    return rc;
}

int
submit_deliver_stats(struct submit *s)
{
    struct rad_memory_out f;
    int rc;

    if (!s->cb->stats)
        return 0;
    rc = fetch(s, 0, MSG_WHAT_STATS, &f);
    if (rc == 0)
        rc = s->cb->stats(s->cb->arg, f.bytes, f.len, s->err);
    free(f.bytes);
    return rc;
}
