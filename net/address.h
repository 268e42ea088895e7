/* address.h - where to listen and whom to dial
 *
 * An address is "HOST:PORT", "[::1]:PORT", or a path with a '/' in it for a
 * Unix socket; to listen at, "*" as HOST stands for all addresses of this
 * machine.  An IPv4 address that is mapped into IPv6 is shown as IPv4.
 * Thread: any; address_resolve() may wait for the resolver. */
#ifndef RADD_NET_ADDRESS_H
#define RADD_NET_ADDRESS_H

#include "base/error.h"

#include <netinet/in.h>
#include <stdbool.h>
#include <sys/socket.h>
#include <sys/un.h>

#define ADDRESS_TEXT 256

struct address {
    union {
        struct sockaddr any;
        struct sockaddr_in in;
        struct sockaddr_in6 in6;
        struct sockaddr_un un;
    } sa;
};

/* RAD_EUSAGE: the text is an IPv6 address, with or without a port, that lacks
 * its brackets. */
int address_check_brackets(const char *text, struct rad_error *err);

/* Split a text into host and port; *local is true for a Unix socket's path,
 * which has none.  RAD_EUSAGE if the text is neither. */
int address_split(const char *text, char host[ADDRESS_TEXT], char port[8],
                  bool *local, struct rad_error *err);

/* The addresses to dial, of which a host's name may have several.  Returns how
 * many there are, at least one and at most `most`, in the resolver's order.
 * RAD_EUSAGE: malformed; UV_EAI_NONAME, UV_EAI_AGAIN or UV_EAI_FAIL: the host
 * was not found. */
int address_resolve(const char *text, struct address to[], int most,
                    struct rad_error *err);

/* The address to listen at: a name's first IPv4 address or, if it has none, its
 * first one; for "*" the address that means all IPv6 and IPv4 addresses. */
int address_resolve_listen(const char *text, struct address *a,
                           struct rad_error *err);

/* The address of "*" on a machine without IPv6. */
void address_wildcard_v4(struct address *a);

bool address_is_local(const struct address *a);    /* a Unix socket */
bool address_is_loopback(const struct address *a); /* or a Unix socket */

/* May a daemon without keys listen there?  0, or RAD_EPERM with the reason. */
int address_permitted(const struct address *a, const char *text,
                      struct rad_error *err);

/* Is this the wildcard address ("0.0.0.0:7421", "[::]:7421")?  Nobody can dial
 * it. */
bool address_is_wildcard(const char *text);

/* "127.0.0.1:7420", "[::1]:7420" or the path. */
void address_format(const struct address *a, char text[ADDRESS_TEXT]);

#endif
