/* address.h - where to listen and whom to dial
 *
 * "HOST:PORT", "[::1]:PORT", or a path with a '/' in it for a Unix socket; "*"
 * as HOST is all addresses of this machine, where one listens.
 * An IPv4 address that comes in the clothes of IPv6 is shown as it is.
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

/* A text's host and port; true for a Unix socket's path (host gets nothing).
 * RAD_EUSAGE when it is neither. */
int address_split(const char *text, char host[ADDRESS_TEXT], char port[8],
                  bool *local, struct rad_error *err);

/* Text to the address to dial; a host's name is looked up, and may have several
 * addresses: nth counts from 0.  RAD_EUSAGE for a bad text, UV_EAI_NONAME,
 * UV_EAI_AGAIN or UV_EAI_FAIL for a host that is not found, RAD_EUNAVAIL for
 * one that has no nth address. */
int address_resolve(const char *text, unsigned nth, struct address *a,
                    struct rad_error *err);

/* Text to the address to listen at: of a name the first of IPv4, or else the
 * first; of "*" that of all IPv6 and IPv4 addresses. */
int address_resolve_listen(const char *text, struct address *a,
                           struct rad_error *err);

/* "*" on a machine without IPv6. */
void address_wildcard_v4(struct address *a);

bool address_is_local(const struct address *a);    /* a Unix socket */
bool address_is_loopback(const struct address *a); /* or a loopback address */

/* Where one without keys may listen: 0, or RAD_EPERM with the reason. */
int address_permitted(const struct address *a, const char *text,
                      struct rad_error *err);

/* Does the text stand for all addresses of this machine ("0.0.0.0:7421",
 * "[::]:7421")?  Then nobody can dial it. */
bool address_is_wildcard(const char *text);

/* "127.0.0.1:7420", "[::1]:7420" or the path. */
void address_format(const struct address *a, char text[ADDRESS_TEXT]);

#endif
