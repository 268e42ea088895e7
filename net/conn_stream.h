/* conn_stream.h - an open stream, before a connection takes it
 *
 * Thread: the loop's. */
#ifndef RADD_NET_CONN_STREAM_H
#define RADD_NET_CONN_STREAM_H

#include "net/address.h"

#include <stdbool.h>
#include <uv.h>

/* A stream's handle, whichever kind it is. */
union conn_stream {
    uv_handle_t handle;
    uv_stream_t stream;
    uv_tcp_t tcp;
    uv_pipe_t pipe;
};

/* A heap-allocated, initialised stream for uv_accept or connecting; NULL when
 * memory is out. */
uv_stream_t *conn_stream_new(uv_loop_t *loop, bool local);
/* Close and free one that no conn has taken. */
void conn_stream_close(uv_stream_t *stream);
/* Name the other side of an open stream: "uid:1000", or its address, which
 * from (may be NULL) gets, too. */
void conn_stream_peer(uv_stream_t *stream, char text[ADDRESS_TEXT],
                      struct address *from);
/* The user id at the other end of a Unix socket; -1 for TCP. */
long conn_stream_uid(uv_stream_t *stream);

#endif
