/* conn_impl.h - inside a connection: conn.c on conn_in.c on conn_out.c
 *
 * What comes in calls what goes out, never the other way: where output ends or
 * makes room for requests again, it calls the functions that conn.c has put
 * into the struct.
 * Thread: the loop's. */
#ifndef RADD_NET_CONN_IMPL_H
#define RADD_NET_CONN_IMPL_H

#include "net/conn.h"

#define READ_BYTES  (64u << 10)
#define PLAIN_BYTES (16u << 10) /* what a record of TLS holds */

/* A connection of a user's with more unread answers than the one gets none of
 * its requests looked at, until there are less than the other. */
#define ANSWERS_HIGH (1u << 20)
#define ANSWERS_LOW  (256u << 10)

/* What was read, and is not looked at yet:
 *
 *        --- others are before it ---> GATE_LINE
 *   GATE_OPEN <--- its turn (fair.h) ------'
 *        --- ANSWERS_HIGH unread ----> GATE_UNREAD
 *        <--- ANSWERS_LOW -----------------'          */
enum conn_gate { GATE_OPEN, GATE_LINE, GATE_UNREAD };

/* What the owner has said of it:
 *
 *   CONN_NEW ----> CONN_LIVE         conn_live(): the handshake is over
 *      |   \         |    |
 *      |    v        v    |
 *      |  CONN_FINISHING  |          conn_finish(): what waits goes out
 *      |        |         |
 *      '------> v <-------'
 *           CONN_CLOSED              its handles go, and at last itself */
enum conn_state { CONN_NEW, CONN_LIVE, CONN_FINISHING, CONN_CLOSED };

struct conn {
    enum conn_state state; /* by conn_out_set_state() */
    union conn_stream *stream;
    struct tls *tls; /* NULL: messages go as they are */
    uint8_t *plain;  /* with tls: what was read of it */
    bool primed;     /* tls may have bytes that came with its handshake */
    uv_timer_t timer;
    uv_prepare_t before; /* the loop waits; and after it did: while there is */
    uv_check_t after;
    uint8_t *cork; /* room for CORK_BYTES; NULL: there was no need yet */
    size_t corked; /* bytes there that wait */
    size_t owed;   /* bytes that the owner is to be told were written */
    int handles;   /* still to be closed before c may go */
    const struct conn_handler *handler;
    void *arg;
    struct frame_reader reader;
    struct msg in;
    size_t queued;  /* bytes with libuv, and corked ones */
    size_t awaited; /* conn_expect() */
    struct msg_ping says; /* in PINGs */
    uint64_t opened_ms;
    unsigned silent;      /* PINGs since the last byte that came */
    struct rad_error end; /* why it ends */
    bool ping;       /* conn_live() */
    bool paused;     /* conn_pause() */
    bool skipped;    /* something that it could do without, and logged */
    enum conn_gate gate;
    const uint8_t *rest; /* of buf, not looked at unless the gate is open */
    size_t nrest;
    struct fair_place place;
    /* what output calls of input: see conn_in.c */
    void (*hear_rest)(struct conn *c);
    void (*reopen)(struct conn *c);
    char peer[ADDRESS_TEXT];
    char buf[READ_BYTES];
};

/* --- conn_out.c --- */

void conn_out_set_state(struct conn *c, enum conn_state to);

/* Is nothing more sent or taken? */
bool conn_out_is_over(const struct conn *c);

/* The connection ends by itself, for a reason with a code of ours or libuv's;
 * `why` is for the owner's log. */
void conn_out_end(struct conn *c, int code, const char *why);
void conn_out_end_uv(struct conn *c, int code);
void conn_out_end_with(struct conn *c, const struct rad_error *err,
                       const char *why);

/* Short messages that wait for others go out. */
void conn_out_uncork(struct conn *c);

/* An alert or a key update of the session's own goes out; counted or not. */
void conn_out_flush(struct conn *c, bool counted);

/* Is the other side a user or an admin? */
bool conn_out_to_user(const struct conn *c);

/* --- conn_in.c --- */

void conn_in_start(struct conn *c);

/* Look at what came by TLS, as far as it may be looked at. */
void conn_in_unseal(struct conn *c);

/* Go on with the requests of a connection: it is its turn, or its answers have
 * been read. */
void conn_in_reopen(struct conn *c);

/* The other side has closed the connection while we write: look at what it said
 * before, as why it did, which lies ready. */
void conn_in_hear_rest(struct conn *c);

/* An error for the log, unless closed() is to tell the owner of it. */
#define conn_tell(c, ...)                                                      \
    do {                                                                       \
        if (!(c)->handler->quiet)                                              \
            log_err(__VA_ARGS__);                                              \
    } while (0)

#endif
