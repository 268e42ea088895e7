/* fair.h - whose requests a daemon looks at next, and what their answers hold
 *
 * Requests of users come in any number.  While there are more than one turn of
 * the loop has time for (FAIR_MS), connections stand in line: users take turns,
 * and of each user its connections, for one request at a time.  So what one
 * user asks for, by however many connections, costs another the wait for one
 * request of the first.  Between two turns the loop sees to all else.
 *
 * Answers that a user does not read are counted over all its connections.
 * Above a limit none of its requests is looked at until most of that is read.
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

/* A connection's place in line; zeroed, it is nobody's. */
struct fair_place {
    struct fair_user *user; /* NULL: it need not stand in line */
    struct fair_place *next;
    bool waits;
    void (*go)(struct fair_place *p); /* look at one request */
};

struct fair {
    uv_loop_t *loop;
    uv_check_t after; /* the loop waited: serve those in line */
    uv_idle_t awake;  /* while somebody is: do not wait */
    bool open;
    struct fair_user *users;         /* all */
    struct fair_user *first, **last; /* in line */
    struct fair_place *serving;      /* in its go() */
    bool granted;                    /* it may still look at its request */
    uint64_t spent_ns, since_ns;     /* on requests, in this turn */
    size_t unread_high;              /* bytes of answers of one user */
};

void fair_init(struct fair *f, uv_loop_t *loop);
/* Nobody is served any more; closes its handles. */
void fair_close(struct fair *f);

/* Most bytes that the answers to one user may hold. */
void fair_set_unread(struct fair *f, size_t bytes);
/* Of the user of that name now; 0 if it has no connection. */
size_t fair_unread(const struct fair *f, const char *name);

/* The user of that name, a new one if there is none, with one connection more;
 * NULL when memory is out.  And with one less. */
struct fair_user *fair_join(struct fair *f, const char *name);
void fair_leave(struct fair_place *p);

/* May the connection look at a request now?  Then fair_done() follows.  Else it
 * is in line, and go() is called. */
bool fair_begin(struct fair_place *p);
void fair_done(struct fair_place *p);

/* Bytes for it wait to be read; or no longer do. */
void fair_owe(struct fair_place *p, size_t n);
void fair_paid(struct fair_place *p, size_t n);
/* Has its user left too much unread? */
bool fair_full(const struct fair_place *p);

#endif
