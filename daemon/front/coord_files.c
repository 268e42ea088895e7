/* coord_files.c - see coord_files.h */
#include "config.h"

#include "front/coord_files.h"

#include "desk/verdict.h"
#include "front/coord.h"
#include "jobs/job.h"
#include "users/known.h"
#include "users/uploads.h"

#include <stdlib.h>
#include <string.h>

/* Files of which nothing was heard since then may be forgotten. */
static uint64_t
forget_before(const struct coord *c)
{
    uint64_t ms = c->limits.upload_ms;

    return c->now_ms > ms ? c->now_ms - ms : 0;
}

/* Note for each user whose files are on their way since when these are offered
 * and when some of them last came.  On a full disk none can come, so there they
 * count as if they did. */
static void
note_offers(struct coord *c)
{
    for (struct coord_conn *i = c->conns; i; i = i->next) {
        if (c->full)
            i->moved_ms = c->now_ms;
        if (i->offer_ms != 0)
            i->payer->uploads.offer_ms = i->offer_ms;
    }
    for (const struct coord_conn *i = c->conns; i; i = i->next) {
        struct uploads_sum *of = &i->payer->uploads;

        if (i->offer_ms == 0)
            continue;
        if (i->offer_ms < of->offer_ms)
            of->offer_ms = i->offer_ms;
        if (i->moved_ms > of->moved_ms)
            of->moved_ms = i->moved_ms;
    }
}

void
coord_files_tick(struct coord *c)
{
    uint64_t ms = c->limits.upload_ms;

    if (c->now_ms - c->uploads_ms < 1000)
        return;
    c->uploads_ms = c->now_ms;
    note_offers(c);
    if (c->now_ms >= ms)
        uploads_forget(&c->uploads, c->now_ms - ms);
    for (struct coord_conn *conn = c->conns, *next; conn; conn = next) {
        next = conn->next;
        if (conn->offer_ms != 0 && c->now_ms - conn->moved_ms >= ms)
            verdict_break(c, conn->id, "what it sends does not go on");
    }
}

void
coord_files_expire(struct coord *c)
{
    if (c->now_ms - c->known_ms < c->limits.upload_ms / 4)
        return;
    c->known_ms = c->now_ms;
    for (struct coord_owner *o = c->owners; o; o = o->next)
        known_expire(&o->files,
                     uploads_kept_from(&o->uploads, forget_before(c)));
}

/* The user's files that were offered too long ago for the store to keep them of
 * itself, and that are kept, for other files of the offer still come. */
static size_t
offered(const struct coord *c, const struct coord_owner *o, uint8_t *hashes)
{
    uint64_t since_ms = forget_before(c),
             from_ms = uploads_kept_from(&o->uploads, since_ms);

    return from_ms < since_ms ? known_free(&o->files, from_ms, hashes) : 0;
}

uint8_t *
coord_files(const struct coord *c, size_t *n)
{
    size_t all = 0, at = 0;
    uint8_t *list;

    for (size_t i = 0; i < c->njobs; i++)
        all += c->jobs[i]->spec.files.n;
    for (const struct coord_owner *o = c->owners; o; o = o->next)
        all += o->files.nfree;
    list = malloc((all + c->uploads.n) * MSG_HASH + 1);
    if (!list)
        return NULL;
    for (size_t i = 0; i < c->njobs; i++) {
        const struct msg_hashes *f = &c->jobs[i]->spec.files;

        if (f->n > 0)
            memcpy(list + at * MSG_HASH, f->hash, (size_t)f->n * MSG_HASH);
        at += f->n;
    }
    for (const struct coord_owner *o = c->owners; o; o = o->next)
        at += offered(c, o, list + at * MSG_HASH);
    *n = at + uploads_waiting(&c->uploads, list + at * MSG_HASH);
    return list;
}
