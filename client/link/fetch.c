/* fetch.c - see fetch.h */
#include "config.h"

#include "link/fetch.h"

#include <stdlib.h>
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
take_chunk(struct fetched *f, const struct msg_chunk *c, struct rad_error *err)
{
    if (c->offset != f->len || c->total < f->len || c->len > c->total - f->len)
        return rad_fail(err, RAD_EPROTO,
                        "the coordinator's pieces of a file do not fit");
    if (f->cap - f->len < c->len) {
        size_t cap = 2 * (f->len + c->len);
        uint8_t *p = realloc(f->bytes, cap);

        if (!p)
            return rad_fail_memory(err);
        f->bytes = p;
        f->cap = cap;
    }
    if (c->len > 0)
        memcpy(f->bytes + f->len, c->data, c->len);
    f->len += c->len;
    return f->len == c->total;
}

int
fetch_take(struct fetched *f, const struct msg *m, struct rad_error *err)
{
    if (m->type == MSG_CHUNK)
        return take_chunk(f, &m->chunk, err);
    if (m->type == MSG_FAILED)
        return rad_fail(err, link_code(m->failed.status), "%s", m->failed.text);
    return 0;
}
