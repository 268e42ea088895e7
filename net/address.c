/* address.c - see address.h */
#include "config.h"

#include "net/address.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <uv.h>

#define ANY_HOST "*"

int
address_check_brackets(const char *text, struct rad_error *err)
{
    const char *colon = strchr(text, ':');
    char end = text[strspn(text, "0123456789abcdefABCDEF:.")];

    if (!colon || !strchr(colon + 1, ':') || (end != '\0' && end != '%'))
        return 0;
    return rad_fail(err, RAD_EUSAGE,
                    "'%s': an IPv6 address stands in brackets, as in "
                    "[::1]:7420",
                    text);
}

int
address_split(const char *text, char host[ADDRESS_TEXT], char port[8],
              bool *local, struct rad_error *err)
{
    const char *colon = strrchr(text, ':'), *start = text;
    size_t n, digits = colon ? strspn(colon + 1, "0123456789") : 0;

    host[0] = port[0] = '\0';
    *local = strchr(text, '/') != NULL;
    if (*local)
        return strlen(text) < sizeof((struct sockaddr_un *)0)->sun_path
                   ? 0
                   : rad_fail(err, RAD_EUSAGE, "socket path too long: '%s'",
                              text);
    if (address_check_brackets(text, err) < 0)
        return RAD_EUSAGE;
    if (digits < 1 || digits > 5 || colon[1 + digits] != '\0')
        return rad_fail(err, RAD_EUSAGE,
                        "expected HOST:PORT or a path with '/', got '%s'",
                        text);
    if (atoi(colon + 1) > UINT16_MAX) /* getaddrinfo() would cut bits off */
        return rad_fail(err, RAD_EUSAGE, "'%s': a port is at most 65535", text);
    n = (size_t)(colon - text);
    if (text[0] == '[' && colon[-1] == ']') {
        start++;
        n -= 2;
    } else if (strcspn(text, "[]:") < n) {
        n = 0;
    }
    if (n == 0 || n >= ADDRESS_TEXT)
        return rad_fail(err, RAD_EUSAGE, "bad host in '%s'", text);
    memcpy(host, start, n);
    host[n] = '\0';
    memcpy(port, colon + 1, digits + 1);
    return 0;
}

/* The addresses of host and port, to be freed; NULL on failure. */
static struct addrinfo *
look_up(const char *text, const char *host, const char *port,
        struct rad_error *err)
{
    struct addrinfo hints = { .ai_socktype = SOCK_STREAM,
                              .ai_flags = AI_NUMERICSERV };
    struct addrinfo *found;
    int rc = getaddrinfo(host, port, &hints, &found);

    if (rc == 0)
        return found;
    rad_fail(err,
             rc == EAI_NONAME  ? UV_EAI_NONAME
             : rc == EAI_AGAIN ? UV_EAI_AGAIN
                               : UV_EAI_FAIL,
             "cannot look up '%s': %s", text, gai_strerror(rc));
    return NULL;
}

/* Put a Unix socket's path into *a and return 1; or a text's host and port into
 * host and port and return 0. */
static int
split(const char *text, struct address *a, char host[ADDRESS_TEXT],
      char port[8], struct rad_error *err)
{
    bool local;
    int rc = address_split(text, host, port, &local, err);

    memset(a, 0, sizeof *a);
    if (rc < 0 || !local)
        return rc;
    a->sa.un.sun_family = AF_UNIX;
    memcpy(a->sa.un.sun_path, text, strlen(text) + 1);
    return 1;
}

static void
copy_address(struct address *a, const struct addrinfo *from)
{
    memset(a, 0, sizeof *a);
    if (from->ai_addrlen <= sizeof a->sa)
        memcpy(&a->sa, from->ai_addr, from->ai_addrlen);
}

int
address_resolve(const char *text, struct address to[], int most,
                struct rad_error *err)
{
    struct addrinfo *found;
    struct rad_error why = { 0 };
    char host[ADDRESS_TEXT], port[8];
    int n = 0, rc = split(text, to, host, port, err);

    if (rc != 0) /* one path, or an error */
        return rc;
    if (strcmp(host, ANY_HOST) == 0)
        return rad_fail(err, RAD_EUSAGE, "'%s' is no address to dial", text);
    found = look_up(text, host, port, &why);
    if (!found)
        return rad_fail(err, why.code, "%s", why.what);
    for (const struct addrinfo *one = found; one && n < most;
         one = one->ai_next)
        copy_address(&to[n++], one);
    freeaddrinfo(found);
    return n;
}

int
address_resolve_listen(const char *text, struct address *a,
                       struct rad_error *err)
{
    struct addrinfo *found, *one;
    struct rad_error why = { 0 };
    char host[ADDRESS_TEXT], port[8];
    int rc = split(text, a, host, port, err);

    if (rc != 0)
        return rc < 0 ? rc : 0;
    if (strcmp(host, ANY_HOST) == 0) {
        a->sa.in6.sin6_family = AF_INET6; /* in6addr_any is all zeros */
        a->sa.in6.sin6_port = htons((uint16_t)atoi(port));
        return 0;
    }
    one = found = look_up(text, host, port, &why);
    if (!found)
        return rad_fail(err, RAD_EUNAVAIL, "%s", why.what);
    while (one && one->ai_family != AF_INET)
        one = one->ai_next;
    copy_address(a, one ? one : found);
    freeaddrinfo(found);
    return 0;
}

void
address_wildcard_v4(struct address *a)
{
    in_port_t port = a->sa.in6.sin6_port;

    memset(a, 0, sizeof *a);
    a->sa.in.sin_family = AF_INET; /* INADDR_ANY is 0 */
    a->sa.in.sin_port = port;
}

bool
address_is_local(const struct address *a)
{
    return a->sa.any.sa_family == AF_UNIX;
}

bool
address_is_loopback(const struct address *a)
{
    switch (a->sa.any.sa_family) {
    case AF_UNIX:
        return true;
    case AF_INET:
        return ntohl(a->sa.in.sin_addr.s_addr) >> 24 == 127;
    case AF_INET6:
        return IN6_IS_ADDR_LOOPBACK(&a->sa.in6.sin6_addr);
    default:
        return false;
    }
}

int
address_permitted(const struct address *a, const char *text,
                  struct rad_error *err)
{
    if (address_is_loopback(a))
        return 0;
    return rad_fail(err, RAD_EPERM,
                    "'%.64s' is no loopback address and takes a key file "
                    "(radcoord --keys, radd --key; see radd.keys(5)): without "
                    "one use 127.0.0.1 or [::1]",
                    text);
}

bool
address_is_wildcard(const char *text)
{
    return strncmp(text, "0.0.0.0:", 8) == 0 || strncmp(text, "[::]:", 5) == 0;
}

void
address_format(const struct address *a, char text[ADDRESS_TEXT])
{
    char host[INET6_ADDRSTRLEN] = "?";
    bool mapped; /* an IPv4 address, as IPv6 writes it */

    switch (a->sa.any.sa_family) {
    case AF_UNIX:
        snprintf(text, ADDRESS_TEXT, "%.*s", (int)sizeof a->sa.un.sun_path,
                 a->sa.un.sun_path);
        break;
    case AF_INET:
        inet_ntop(AF_INET, &a->sa.in.sin_addr, host, sizeof host);
        snprintf(text, ADDRESS_TEXT, "%s:%d", host, ntohs(a->sa.in.sin_port));
        break;
    case AF_INET6:
        mapped = IN6_IS_ADDR_V4MAPPED(&a->sa.in6.sin6_addr);
        inet_ntop(mapped ? AF_INET : AF_INET6,
                  a->sa.in6.sin6_addr.s6_addr + (mapped ? 12 : 0), host,
                  sizeof host);
        snprintf(text, ADDRESS_TEXT, mapped ? "%s:%d" : "[%s]:%d", host,
                 ntohs(a->sa.in6.sin6_port));
        break;
    default:
        snprintf(text, ADDRESS_TEXT, "?");
    }
}
