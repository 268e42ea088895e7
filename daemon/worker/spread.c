/* spread.c - see spread.h
 *
 * Records that are passed on wait at their link until this worker's own child
 * has records to send (at the start of a job, when records are urgent, every
 * few milliseconds), or for WAIT_MS, or until there are many.  So passing
 * records on takes no messages beside the worker's own. */
#include "config.h"

#include "worker/spread.h"

#include "worker/peer.h"
#include "worker/state.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FULL_BYTES ((size_t)32 << 10) /* so much at a link is sent at once */

/* The time that records wait at a link if the child sends none: as long as a
 * child gathers records that are not urgent. */
#define WAIT_MS 200

/* After so long the coordinator is told again of a link that is gone: it may
 * have been busy with an earlier report. */
#define TELL_MS 5000

struct slink {
    char name[MSG_MAX_NAME + 1];
    uint32_t offset, below; /* as in msg_ring_link */
    bool was;               /* the link was there since the RING */
    uint64_t told_ms;       /* UNLINKED was sent then; 0: it was not */
    uint64_t since_ms;      /* the oldest waiting record came then */
    struct msg_part *part;  /* that wait; their data are not set */
    uint32_t nparts, cap;
    struct wire_out bytes; /* of all of them */
};

/* The links of one RING. */
struct circle {
    uint32_t generation, places;
    uint32_t nlinks;
    struct slink *link;
};

struct spread {
    struct circle now;
    struct circle before;     /* for records under way when places changed */
    struct wire_out gathered; /* records for the child */
    uint32_t ngathered;
};

/* --- to links --- */

/* The peer of a link; NULL: the peer is gone, or has not dialled: tell the
 * coordinator. */
static struct wpeer *
peer_of(struct worker *w, struct wjob *job, struct slink *l)
{
    struct wpeer *p = peer_awaited(w, job, l->name);
    struct msg m = { .type = MSG_UNLINKED,
                     .unlinked = { job->id, l->name, l->was } };

    if (!p && job->started &&
        (l->told_ms == 0 || w->now_ms - l->told_ms >= TELL_MS)) {
        l->told_ms = w->now_ms;
        worker_send_coord(w, &m);
    }
    return p;
}

static void
flush(struct worker *w, struct wjob *job, const struct circle *c,
      struct slink *l)
{
    struct msg m = { .type = MSG_SPREAD };
    struct wire_out *out = &w->actions.scratch;
    struct wpeer *p = l->nparts > 0 ? peer_of(w, job, l) : NULL;
    const uint8_t *data = l->bytes.buf;
    uint8_t *kept = NULL;

    for (uint32_t i = 0; i < l->nparts; data += l->part[i++].len)
        l->part[i].data = data;
    m.spread = (struct msg_spread){ c->generation, l->nparts, l->part };
    out->len = 0;
    if (p && msg_pack(out, &m) == 0)
        peer_records(w, job, p, &kept);
    l->nparts = 0;
    l->bytes.len = 0;
}

/* Send the records of all links that have waited for so long. */
static void
flush_all(struct worker *w, struct wjob *job, uint64_t ms)
{
    const struct circle *c[] = { &job->spread->before, &job->spread->now };

    for (int k = 0; k < 2; k++)
        for (uint32_t i = 0; i < c[k]->nlinks; i++)
            if (w->now_ms - c[k]->link[i].since_ms >= ms)
                flush(w, job, c[k], &c[k]->link[i]);
}

/* Add a part to the waiting records, or lengthen the last; false: memory is
 * out. */
static bool
add_part(struct slink *l, uint32_t distance, const struct msg_part *p)
{
    struct msg_part *last = l->nparts > 0 ? &l->part[l->nparts - 1] : NULL;

    wire_put_bytes(&l->bytes, p->data, p->len);
    if (l->bytes.bad)
        return false;
    if (last && last->distance == distance) {
        last->count += p->count;
        last->len += p->len;
        return true;
    }
    if (l->nparts == l->cap) {
        uint32_t cap = l->cap ? 2 * l->cap : 16;
        struct msg_part *part = realloc(l->part, cap * sizeof *part);

        if (!part)
            return false;
        l->part = part;
        l->cap = cap;
    }
    l->part[l->nparts++] =
        (struct msg_part){ distance, p->count, NULL, p->len };
    return true;
}

static void
append(struct worker *w, struct wjob *job, const struct circle *c,
       struct slink *l, uint32_t distance, const struct msg_part *p)
{
    if (l->nparts == 0)
        l->since_ms = w->now_ms;
    if (l->nparts == MSG_MAX_PARTS || p->len > MSG_MAX_AMBIENT - l->bytes.len)
        flush(w, job, c, l);
    if (!add_part(l, distance, p)) { /* the link's waiting records are lost */
        l->bytes.bad = l->bytes.nomem = false;
        l->bytes.len = 0;
        l->nparts = 0;
    }
    if (l->bytes.len >= FULL_BYTES)
        flush(w, job, c, l);
}

/* Pass records that were made so many places back on, over the ring's links. */
static void
pass(struct worker *w, struct wjob *job, const struct circle *c,
     const struct msg_part *p, uint32_t distance)
{
    for (uint32_t i = 0; i < c->nlinks; i++) {
        struct slink *l = &c->link[i];

        if (l->offset > 0 && distance < l->below &&
            l->offset < c->places - distance)
            append(w, job, c, l, distance + l->offset, p);
    }
}

/* Send records to this worker's guests, but not to the peer that sent them. */
static void
tell_others(struct worker *w, struct wjob *job, const struct msg_ambient *m,
            const char *from)
{
    struct msg pass = { .type = MSG_AMBIENT, .ambient = *m };
    struct wire_out *out = &w->actions.scratch;
    uint8_t *kept = NULL;

    pass.ambient.to = 0;
    for (uint32_t i = 0; i < job->spread->now.nlinks; i++) {
        struct slink *l = &job->spread->now.link[i];
        struct wpeer *p;

        if (l->offset > 0 || strcmp(l->name, from) == 0)
            continue;
        p = peer_of(w, job, l);
        out->len = 0;
        if (p && msg_pack(out, &pass) == 0)
            peer_records(w, job, p, &kept);
    }
}

/* --- from the child and from peers --- */

void
spread_own(struct worker *w, struct wjob *job, const struct msg_ambient *m)
{
    struct msg_part part = { 0, m->count, m->data, m->len };

    tell_others(w, job, m, "");
    pass(w, job, &job->spread->now, &part, 0);
    flush_all(w, job, 0);
}

static bool
speaks_for(const struct circle *c, const char *name)
{
    for (uint32_t i = 0; i < c->nlinks; i++)
        if (c->link[i].offset == 0 && strcmp(c->link[i].name, name) == 0)
            return true;
    return false;
}

void
spread_heard(struct worker *w, struct wjob *job, const struct wpeer *from,
             const struct msg_ambient *m)
{
    struct msg_part part = { 0, m->count, m->data, m->len };

    if (!speaks_for(&job->spread->now, from->name))
        return;
    tell_others(w, job, m, from->name);
    pass(w, job, &job->spread->now, &part, 0);
}

/* Send the gathered records to the child and to this worker's guests. */
static void
hand_down(struct worker *w, struct wjob *job)
{
    struct spread *s = job->spread;
    struct msg_ambient m = { 0, s->ngathered, s->gathered.buf,
                             s->gathered.len };

    if (s->ngathered > 0) {
        tell_others(w, job, &m, "");
        peer_receive(w, job, &m);
    }
    s->ngathered = 0;
    s->gathered.len = 0;
}

static void
gather(struct worker *w, struct wjob *job, const struct msg_part *p)
{
    struct spread *s = job->spread;

    if (p->len > MSG_MAX_AMBIENT - s->gathered.len)
        hand_down(w, job);
    wire_put_bytes(&s->gathered, p->data, p->len);
    if (s->gathered.bad) /* no memory: lost */
        s->gathered.bad = s->gathered.nomem = false;
    else
        s->ngathered += p->count;
}

/* The ring whose places a SPREAD counts by; NULL: neither of ours. */
static const struct circle *
circle_of(const struct spread *s, uint32_t generation)
{
    if (generation == s->now.generation)
        return &s->now;
    return generation == s->before.generation ? &s->before : NULL;
}

void
spread_take(struct worker *w, struct wjob *job, const struct msg_spread *m)
{
    const struct circle *c =
        job->spread ? circle_of(job->spread, m->generation) : NULL;

    for (uint32_t i = 0; job->spread && i < m->nparts; i++) {
        const struct msg_part *p = &m->parts[i];

        gather(w, job, p);
        if (c && p->distance < c->places)
            pass(w, job, c, p, p->distance);
    }
    if (job->spread)
        hand_down(w, job);
}

void
spread_tick(struct worker *w, struct wjob *job)
{
    if (job->spread)
        flush_all(w, job, WAIT_MS);
}

/* --- links --- */

void
spread_linked(struct wjob *job, const char *name, bool linked)
{
    struct spread *s = job->spread;

    for (int k = 0; s && k < 2; k++) {
        struct circle *c = k ? &s->before : &s->now;

        for (uint32_t i = 0; i < c->nlinks; i++)
            if (strcmp(c->link[i].name, name) == 0) {
                c->link[i].was = linked;
                c->link[i].told_ms = 0;
            }
    }
}

static void
drop_links(struct circle *c)
{
    for (uint32_t i = 0; i < c->nlinks; i++) {
        free(c->link[i].part);
        wire_out_release(&c->link[i].bytes);
    }
    free(c->link);
    *c = (struct circle){ 0 };
}

static bool
was_linked(const struct circle *c, const char *name)
{
    for (uint32_t i = 0; i < c->nlinks; i++)
        if (strcmp(c->link[i].name, name) == 0)
            return c->link[i].was;
    return false;
}

/* False: memory is out. */
static bool
set_links(const struct wjob *job, const struct circle *old, struct circle *c,
          const struct msg_ring *m)
{
    c->link = calloc(m->nlinks + 1, sizeof *c->link);
    if (!c->link)
        return false;
    c->generation = m->generation;
    c->places = m->places;
    c->nlinks = m->nlinks;
    for (uint32_t i = 0; i < m->nlinks; i++) {
        struct slink *l = &c->link[i];

        snprintf(l->name, sizeof l->name, "%s", m->links[i].name);
        l->offset = m->links[i].offset;
        l->below = m->links[i].below;
        l->was = peer_linked(job, l->name) || was_linked(old, l->name);
        wire_out_init(&l->bytes, MSG_MAX_AMBIENT);
    }
    return true;
}

void
spread_set(struct worker *w, struct wjob *job, const struct msg_ring *m)
{
    struct spread *s = job->spread;
    struct circle old;

    if (!s) {
        s = job->spread = calloc(1, sizeof *s);
        if (s)
            wire_out_init(&s->gathered, MSG_MAX_AMBIENT);
    }
    if (!s) {
        w->actions.failed = true;
        return;
    }
    flush_all(w, job, 0);
    old = s->now;
    s->now = (struct circle){ 0 };
    if (!set_links(job, &old, &s->now, m))
        w->actions.failed = true;
    if (m->generation ==
        old.generation) { /* but for its guests the ring is the same */
        drop_links(&old);
    } else {
        drop_links(&s->before);
        s->before = old;
    }
}

void
spread_release(struct wjob *job)
{
    if (!job->spread)
        return;
    drop_links(&job->spread->now);
    drop_links(&job->spread->before);
    wire_out_release(&job->spread->gathered);
    free(job->spread);
    job->spread = NULL;
}
