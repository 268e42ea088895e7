/* telling.h - answers for which a connection waits over several turns of the
 * loop
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_TELLING_H
#define DAEMON_TELLING_H

#include "desk/desk.h"

/* A request that made a change, and is answered when the store has kept that
 * change. */
struct coord_settling {
    struct coord_settling *next;
    uint32_t request;
    uint64_t since_ms;
};

/* Statistics that a request waits for. */
struct coord_telling {
    struct coord_telling *next;
    struct stats_text *text; /* being made; NULL: not begun, or whole */
    char *whole;             /* the whole text; NULL: not yet */
    size_t len, sent;        /* of whole [bytes] */
    uint8_t job[MSG_JOB];
    uint64_t sequence; /* of the job */
    uint32_t request;
    uint64_t turn; /* coord.pieces_told when the request came, or when its last
                    * piece was made or sent */
};

/* Begin the text; no other text may be in the making for the connection's user.
 * False: memory is out.  telling_whole(): all of the text is written. */
bool telling_begin(struct coord_conn *conn, struct coord_telling *t,
                   const struct job *job, uint64_t now_ms);
void telling_whole(struct coord_conn *conn, struct coord_telling *t);

/* Are statistics of the job being made for any connection? */
bool telling_of(const struct coord *c, const struct job *job);

/* Drop the answer *at of one of the connection's lists. */
void telling_drop(struct coord_conn *conn, struct coord_telling **at);
void telling_drop_settling(struct coord_conn *conn, struct coord_settling **at);

/* The connection has ended: drop all its answers. */
void telling_release(struct coord_conn *conn);

#endif
