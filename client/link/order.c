/* order.c - see order.h */
#include "config.h"

#include "link/order.h"

#include "link/link.h"

enum {
    CONNECT_MS = 5000,
    ANSWER_MS = 5000 /* longest wait for the answer */
};

/* Send *m, about a job, and wait for the answer. */
static int
give(const struct target *to, uv_loop_t *loop, const struct msg *m)
{
    int never = 0, rc;
    struct link_where where = { loop, &never };
    struct rad_error why = { 0 };
    const struct msg *answer;
    struct link *link = NULL;

    rc = link_open(&link, &where, to, MSG_ROLE_USER, CONNECT_MS, &why);
    if (rc < 0)
        return rc;
    rc = link_send(link, m, &why);
    while (rc >= 0) {
        rc = link_recv(link, ANSWER_MS, &answer, &why);
        if (rc == 0 || (rc == 1 && answer->request == m->request))
            break;
    }
    link_close(link);
    return rc < 0 ? rc : 0;
}

int
order_cancel(const struct target *to, uv_loop_t *loop,
             const uint8_t job[MSG_JOB])
{
    struct msg m = { .type = MSG_CANCEL, .request = 1, .cancel = { job } };

    return give(to, loop, &m);
}

int
order_delete(const struct target *to, uv_loop_t *loop,
             const uint8_t job[MSG_JOB])
{
    struct msg m = { .type = MSG_DELETE, .request = 1, .delete = { job } };

    return give(to, loop, &m);
}
