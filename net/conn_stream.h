/* conn_stream.h - an open stream, before a connection takes it
 *
 * Thread: the loop's. */
#ifndef RADD_NET_CONN_STREAM_H
#define RADD_NET_CONN_STREAM_H

#include "net/address.h"

#include <stdbool.h>
#include <uv.h>

/* The handle of a stream of any kind. */
union conn_stream {
    uv_handle_t handle;
    uv_stream_t stream;
    uv_tcp_t tcp;
    uv_pipe_t pipe;
};

/* A new stream on the heap, initialised for accepting or connecting; NULL:
 * memory is out. */
uv_stream_t *conn_stream_new(uv_loop_t *loop, bool local);
/* Close and free a stream that no struct conn has taken. */
void conn_stream_close(uv_stream_t *stream);
/* Name the other side of an open stream: "uid:1000", or its address, which
 * *from (may be NULL) gets, too. */
void conn_stream_peer(uv_stream_t *stream, char text[ADDRESS_TEXT],
                      struct address *from);
/* The user id of the other end of a Unix socket; -1 for TCP. */
long conn_stream_uid(uv_stream_t *stream);

#endif
