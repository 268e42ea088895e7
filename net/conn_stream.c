/* conn_stream.c - see conn_stream.h */
#include "config.h"

#include "net/conn_stream.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

uv_stream_t *
conn_stream_new(uv_loop_t *loop, bool local)
{
    union conn_stream *s = calloc(1, sizeof *s);

    if (!s)
        return NULL;
    if (local)
        uv_pipe_init(loop, &s->pipe, 0);
    else
        uv_tcp_init(loop, &s->tcp);
    return &s->stream;
}

static void
free_stream(uv_handle_t *h)
{
    free(h);
}

void
conn_stream_close(uv_stream_t *stream)
{
    uv_close((uv_handle_t *)stream, free_stream);
}

long
conn_stream_uid(uv_stream_t *stream)
{
    struct ucred cred;
    socklen_t n = sizeof cred;
    int fd;

    if (stream->type != UV_NAMED_PIPE ||
        uv_fileno((uv_handle_t *)stream, &fd) < 0 ||
        getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &cred, &n) < 0)
        return -1;
    return (long)cred.uid;
}

void
conn_stream_peer(uv_stream_t *stream, char text[ADDRESS_TEXT],
                 struct address *from)
{
    struct address a;
    int n = sizeof a.sa;

    memset(&a, 0, sizeof a);
    if (stream->type == UV_NAMED_PIPE)
        snprintf(text, ADDRESS_TEXT, "uid:%ld", conn_stream_uid(stream));
    else if (uv_tcp_getpeername((uv_tcp_t *)stream, &a.sa.any, &n) < 0)
        snprintf(text, ADDRESS_TEXT, "?"); /* it has closed already */
    else
        address_format(&a, text);
    if (from)
        *from = a;
}
