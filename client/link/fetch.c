/* fetch.c - see fetch.h */
#include "config.h"

#include "link/fetch.h"

#include <string.h>

int
fetch_start(struct link *l, const uint8_t job[MSG_JOB], uint32_t frame,
            enum msg_what what, uint32_t request, struct rad_error *err)
{
    struct msg m = { .type = MSG_FETCH, .request = request };

    m.fetch.job = job;
    m.fetch.frame = frame;
    m.fetch.what = (uint8_t)what;
    return link_send(l, &m, err);
}

static int
take_chunk(struct rad_memory_out *f, const struct msg_chunk *c,
           struct rad_error *err)
{
    if (c->offset != f->len || c->total < f->len || c->len > c->total - f->len)
        return rad_fail(err, RAD_EPROTO,
                        "the coordinator's pieces of a file do not fit");
    if (rad_memory_add(f, c->data, c->len, err) != 0)
        return RAD_ENOMEM;
    return f->len == c->total;
}

int
fetch_take(struct rad_memory_out *f, const struct msg *m, struct rad_error *err)
{
    if (m->type == MSG_CHUNK)
        return take_chunk(f, &m->chunk, err);
    if (m->type == MSG_FAILED)
        return rad_fail(err, link_code(m->failed.status), "%s", m->failed.text);
    return 0;
}
