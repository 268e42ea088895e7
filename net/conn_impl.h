/* conn_impl.h - inside a connection: conn.c uses conn_in.c uses conn_out.c
 *
 * Input calls output, never the other way.  When output ends a connection, or
 * has made room for further requests, it calls input by the function pointers
 * that conn.c has set in the struct.
 * Thread: the loop's. */
#ifndef RADD_NET_CONN_IMPL_H
#define RADD_NET_CONN_IMPL_H

#include "net/conn.h"

#define READ_BYTES  (64u << 10)
#define PLAIN_BYTES (16u << 10) /* the content of one TLS record */

/* Requests of a user's connection wait while more than ANSWERS_HIGH bytes of
 * answers are unread, until there are less than ANSWERS_LOW. */
#define ANSWERS_HIGH (1u << 20)
#define ANSWERS_LOW  (256u << 10)

/* Bytes that were read wait in `rest` unless the gate is open:
 *
 *        --- others are before it ---> GATE_LINE
 *   GATE_OPEN <--- its turn (fair.h) ------'
 *        --- ANSWERS_HIGH unread ----> GATE_UNREAD
 *        <--- below ANSWERS_LOW -----------' */
enum conn_gate { GATE_OPEN, GATE_LINE, GATE_UNREAD };

/* States of a connection:
 *
 *   CONN_NEW ----> CONN_LIVE         conn_live(): the handshake is over
 *      |   \         |    |
 *      |    v        v    |
 *      |  CONN_FINISHING  |          conn_finish(): the queue is sent
 *      |        |         |
 *      '------> v <-------'
 *           CONN_CLOSED              handles are closed, then it is freed */
enum conn_state { CONN_NEW, CONN_LIVE, CONN_FINISHING, CONN_CLOSED };

struct conn {
    enum conn_state state; /* set by conn_out_set_state() */
    union conn_stream *stream;
    struct tls *tls; /* NULL: no TLS */
    uint8_t *plain;  /* with tls: a buffer for decrypted bytes */
    bool primed;     /* tls may hold bytes that came with the handshake */
    uv_timer_t timer;
    uv_prepare_t before; /* before and after the loop waits, while bytes are
                          * corked */
    uv_check_t after;
    uint8_t *cork; /* CORK_BYTES; NULL: not needed so far */
    size_t corked; /* bytes in cork */
    size_t owed;   /* written bytes that written() has not told yet */
    int handles;   /* handles that are not closed yet */
    const struct conn_handler *handler;
    void *arg;
    struct frame_reader reader;
    struct msg in;
    size_t queued;  /* bytes that libuv has, and corked ones */
    size_t updates; /* bytes of the TLS session's own answers, to key updates,
                     * since nothing was queued */
    size_t awaited; /* sum of conn_expect() */
    struct msg_ping says; /* numbers for PINGs */
    uint64_t opened_ms;
    unsigned silent;      /* PINGs sent since a byte last came */
    struct rad_error end; /* why the connection ended */
    bool ping;       /* set by conn_live() */
    bool paused;     /* set by conn_pause() */
    bool skipped;    /* RECORDS were skipped, which is logged once */
    enum conn_gate gate;
    const uint8_t *rest; /* bytes in buf or plain that wait for the gate */
    size_t nrest;
    struct fair_place place;
    /* calls of conn_in.c by conn_out.c */
    void (*hear_rest)(struct conn *c);
    void (*reopen)(struct conn *c);
    char peer[ADDRESS_TEXT];
    char buf[READ_BYTES];
};

/* --- conn_out.c --- */

void conn_out_set_state(struct conn *c, enum conn_state to);

/* Does the connection take no message, neither in nor out? */
bool conn_out_is_over(const struct conn *c);

/* End the connection by itself, for a reason with a code of ours or libuv's;
 * why is for the owner's log. */
void conn_out_end(struct conn *c, int code, const char *why);
void conn_out_end_uv(struct conn *c, int code);
void conn_out_end_with(struct conn *c, const struct rad_error *err,
                       const char *why);

/* Write the corked messages. */
void conn_out_uncork(struct conn *c);

/* Send what the TLS session has to say itself, such as an alert. */
void conn_out_flush(struct conn *c);

/* Is the other side a user, an administrator or an observer? */
bool conn_out_to_user(const struct conn *c);

/* --- conn_in.c --- */

void conn_in_start(struct conn *c);

/* Decrypt and handle what came by TLS, as far as the gate lets it. */
void conn_in_unseal(struct conn *c);

/* Open the gate again: it is the connection's turn, or its answers have been
 * read. */
void conn_in_reopen(struct conn *c);

/* A write failed because the other side has closed the connection: read what it
 * sent before, which may say why. */
void conn_in_hear_rest(struct conn *c);

/* Log an error, unless the owner asked for silence (quiet). */
#define conn_tell(c, ...)                                                      \
    do {                                                                       \
        if (!(c)->handler->quiet)                                              \
            log_err(__VA_ARGS__);                                              \
    } while (0)

#endif
