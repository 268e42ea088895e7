/* target.h - the coordinator that a client talks to
 *
 * Its address comes from the first of these that names one: the command line;
 * the variable RADD_COORDINATOR; the key `coordinator` of the user's
 * radsubmit.conf ($XDG_CONFIG_HOME/radd or ~/.config/radd); that of the
 * system's (SYSCONFDIR/radd).  An address is a socket's path, with a '/', or
 * HOST:PORT; HOST alone means the default port, and an IPv6 host stands in
 * brackets.
 * If none is named, clients that only ask try radcoord's default socket on this
 * machine.
 * The key file comes from the same places: the command line, RADD_KEY, the key
 * `key` of either file. */
#ifndef RADD_CLIENT_TARGET_H
#define RADD_CLIENT_TARGET_H

#include "base/error.h"
#include "common/inputs.h"
#include "net/address.h"

#include <stdbool.h>

struct target {
    bool local;      /* a Unix socket */
    char text[1024]; /* as given, for messages */
    char path[108];  /* local: the socket */
    char host[ADDRESS_TEXT]; /* if not local */
    char port[8];    /* decimal */
    char key[1024];  /* a key file, if not local; empty: none */
};

/* Write a text that is HOST or HOST:PORT, with this port if it has none. */
void target_complete(char *to, size_t size, const char *text, const char *port);

/* Parse an address, which has room in a->text; RAD_EUSAGE. */
int target_parse(struct target *a, const char *text, struct rad_error *err);

/* Find the coordinator.  given, key: of the command line, or NULL.  Returns 1
 * and *a; 0 if none is named; RAD_EUSAGE; RAD_ECONFIG: a malformed file. */
int target_find(struct target *a, const char *given, const char *key,
                struct rad_error *err);

/* Note the configuration files that target_find() may read. */
int target_note(struct inputs *in, struct rad_error *err);

/* The default socket on this machine, which need not exist. */
void target_default(struct target *a);

#endif
