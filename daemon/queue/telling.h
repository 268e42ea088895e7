/* telling.h - answers that a connection waits for, and that take a while
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_TELLING_H
#define DAEMON_TELLING_H

#include "desk/desk.h"

/* A request that is answered when the change it made is kept. */
struct coord_settling {
    struct coord_settling *next;
    uint32_t request;
    uint64_t since_ms;
};

/* Statistics that somebody waits for. */
struct coord_telling {
    struct coord_telling *next;
    struct stats_text *text; /* NULL: it is whole */
    char *whole;
    size_t len, sent; /* of that [bytes] */
    uint8_t job[MSG_JOB];
    uint64_t sequence; /* of the job */
    uint32_t request;
};

/* Is a connection being sent statistics that are made from the job in memory?
 */
bool telling_of(const struct coord *c, const struct job *job);

/* Forget an answer, *at, which is on one of the connection's lists. */
void telling_drop(struct coord_conn *conn, struct coord_telling **at);
void telling_drop_settling(struct coord_conn *conn, struct coord_settling **at);

/* The connection is gone: forget all its answers. */
void telling_release(struct coord_conn *conn);

#endif
