/* frame.c - see frame.h */
#include "config.h"

#include "proto/frame.h"

#include <stdlib.h>
#include <string.h>

void
frame_reader_init(struct frame_reader *r, enum msg_session session)
{
    *r = (struct frame_reader){ .session = session, .version = MSG_VERSION };
}

void
frame_reader_release(struct frame_reader *r)
{
    free(r->buf);
    *r = (struct frame_reader){ .bad = true };
}

uint8_t *
frame_reader_take(struct frame_reader *r)
{
    uint8_t *bytes = r->buf;

    r->buf = NULL;
    r->cap = 0;
    return bytes;
}

int
frame_header(struct msg_header *h, enum msg_session session, unsigned version,
             const uint8_t bytes[MSG_HEADER], struct rad_error *err)
{
    struct wire_in in;
    uint32_t magic;
    uint16_t flags;

    wire_in_init(&in, bytes, MSG_HEADER);
    magic = wire_get_u32(&in);
    h->type = wire_get_u16(&in);
    flags = wire_get_u16(&in);
    h->request = wire_get_u32(&in);
    h->length = wire_get_u32(&in);
    if (magic != MSG_MAGIC)
        return rad_fail(err, RAD_EPROTO, "not radd's protocol");
    if (msg_limit(h->type) == 0 || version < msg_since(h->type) || flags != 0)
        return rad_fail(err, RAD_EPROTO, "unknown message %u, flags %u",
                        h->type, flags);
    if (!msg_allowed(session, h->type))
        return rad_fail(err, RAD_EPROTO, "unexpected %s", msg_name(h->type));
    if (h->length > msg_limit(h->type))
        return rad_fail(err, RAD_EPROTO, "%s of %u bytes is too long",
                        msg_name(h->type), h->length);
    return 0;
}

/* Move bytes until r->buf holds `want`.  Returns 1 when it does, 0 if more must
 * come.  The buffer at most doubles, so it never grows far beyond what came. */
static int
fill(struct frame_reader *r, size_t want, const uint8_t **data, size_t *n,
     struct rad_error *err)
{
    size_t take = want - r->len < *n ? want - r->len : *n;

    if (r->len + take > r->cap) {
        size_t cap = r->cap ? r->cap : 1024;
        uint8_t *p;

        while (cap < r->len + take)
            cap *= 2;
        p = realloc(r->buf, cap);
        if (!p)
            return rad_fail_memory(err);
        r->buf = p;
        r->cap = cap;
    }
    if (take > 0) { /* *data may be NULL where there is nothing */
        memcpy(r->buf + r->len, *data, take);
        *data += take;
    }
    r->len += take;
    *n -= take;
    return r->len == want;
}

static int
read_step(struct frame_reader *r, const uint8_t **data, size_t *n,
          struct msg *m, struct rad_error *err)
{
    int rc;

    if (!r->have_head) {
        rc = fill(r, MSG_HEADER, data, n, err);
        if (rc <= 0)
            return rc;
        rc = frame_header(&r->head, r->session, r->version, r->buf, err);
        if (rc < 0)
            return rc;
        r->have_head = true;
        r->len = 0;
    }
    rc = fill(r, r->head.length, data, n, err);
    if (rc <= 0)
        return rc;
    r->have_head = false;
    r->len = 0;
    rc = msg_unpack_as(r->version, m, r->head.type, r->head.request, r->buf,
                       r->head.length, err);
    return rc < 0 ? rc : 1;
}

int
frame_read(struct frame_reader *r, const uint8_t **data, size_t *n,
           struct msg *m, struct rad_error *err)
{
    int rc;

    if (r->bad)
        return rad_fail(err, RAD_EPROTO, "the stream is broken");
    rc = read_step(r, data, n, m, err);
    if (rc < 0)
        r->bad = true;
    return rc;
}
