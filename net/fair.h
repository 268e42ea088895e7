/* fair.h - the order in which users' requests are looked at, and how many
 * unread answers a user may have
 *
 * While there are more requests than one turn of the loop has time for
 * (FAIR_MS), connections stand in line.  Users take turns, and so do the
 * connections of each user, for one request at a time.  So a user with many
 * connections and requests makes another user wait for one request only.
 * Between two turns the loop does all its other work.
 *
 * Bytes of answers that are not read yet are counted per user, over all its
 * connections.  A user above the limit is not served until a quarter of that
 * has been read.
 * Lifetime: a user lives as long as its connections.
 * Thread: the loop's. */
#ifndef RADD_NET_FAIR_H
#define RADD_NET_FAIR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <uv.h>

#define FAIR_MS 4

struct fair_user;

/* A connection's place in line; when zeroed, it belongs to no user. */
struct fair_place {
    struct fair_user *user; /* NULL: it need not stand in line */
    struct fair_place *next;
    bool waits;
    void (*go)(struct fair_place *p); /* look at one request: fair_begin() */
};

struct fair {
    uv_check_t after; /* after the loop has waited: serve the line */
    uv_idle_t awake;  /* runs while a connection is in line: do not wait */
    bool open;
    struct fair_user *users;         /* all */
    struct fair_user *first, **last; /* in line */
    struct fair_place *serving;      /* whose go() is running */
    bool granted;                    /* serving may still begin its request */
    uint64_t spent_ns, since_ns;     /* time on requests in this turn */
    uint64_t (*clock)(void);         /* [ns]: uv_hrtime(), but in a test */
    size_t unread_high;              /* most unread bytes of one user */
};

void fair_init(struct fair *f, uv_loop_t *loop);
/* Close the handles; no connection is served any more. */
void fair_close(struct fair *f);

/* Set how many bytes of answers a user may leave unread. */
void fair_set_unread(struct fair *f, size_t bytes);
/* The unread bytes of the user of that name; 0 if it has no connection. */
size_t fair_unread(const struct fair *f, const char *name);

/* Add a connection to the user of that name, which is made if need be; NULL:
 * memory is out.  fair_leave() takes a connection away. */
struct fair_user *fair_join(struct fair *f, const char *name);
void fair_leave(struct fair_place *p);

/* May the connection look at a request now?  If so, call fair_done() after it.
 * If not, it stands in line now, and go() will be called. */
bool fair_begin(struct fair_place *p);
void fair_done(struct fair_place *p);

/* Count n bytes for the connection as unread, or as read. */
void fair_owe(struct fair_place *p, size_t n);
void fair_paid(struct fair_place *p, size_t n);
/* Has its user too much unread? */
bool fair_full(const struct fair_place *p);

#endif
