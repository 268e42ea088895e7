/* poke.c - sends standard input to a socket and writes what comes back
 *
 * poke "tcp 127.0.0.1:7420" or poke "unix /run/x.sock", as in a ports file.
 * Exits with 0 once the other side has closed the connection, 1 if it has not
 * after 20 s, 69 if there is nobody. */
#include "config.h"

#include "net/address.h"

#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sysexits.h>
#include <unistd.h>

#define PATIENCE_MS 100000

static int
open_socket(const char *where)
{
    struct address a;
    socklen_t n;
    int fd;

    where += strncmp(where, "tcp ", 4) == 0    ? 4
             : strncmp(where, "unix ", 5) == 0 ? 5
                                               : 0;
    if (address_resolve(where, &a, 1, NULL) < 0)
        return -1;
    n = a.sa.any.sa_family == AF_UNIX   ? sizeof a.sa.un
        : a.sa.any.sa_family == AF_INET ? sizeof a.sa.in
                                        : sizeof a.sa.in6;
    fd = socket(a.sa.any.sa_family, SOCK_STREAM, 0);
    if (fd >= 0 && connect(fd, &a.sa.any, n) == 0)
        return fd;
    perror(where);
    return -1;
}

static void
send_input(int fd)
{
    char buf[4096];
    ssize_t n;

    while ((n = read(STDIN_FILENO, buf, sizeof buf)) > 0)
        if (send(fd, buf, (size_t)n, MSG_NOSIGNAL) < 0)
            return; /* it has heard enough */
}

int
main(int argc, char *argv[])
{
    struct pollfd p = { .events = POLLIN };
    char buf[4096];
    ssize_t n;

    if (argc != 2) {
        fprintf(stderr, "usage: poke \"tcp HOST:PORT\"|\"unix PATH\"\n");
        return EX_USAGE;
    }
    p.fd = open_socket(argv[1]);
    if (p.fd < 0)
        return EX_UNAVAILABLE;
    send_input(p.fd);
    while (poll(&p, 1, PATIENCE_MS) > 0) {
        n = recv(p.fd, buf, sizeof buf, 0);
        if (n <= 0)
            return 0;
        fwrite(buf, 1, (size_t)n, stdout);
    }
    return 1;
}
