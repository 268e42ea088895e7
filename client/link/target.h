/* target.h - which coordinator a client means
 *
 * The first of these that is there: the command line, the variable
 * RADD_COORDINATOR, the key `coordinator` of the user's radsubmit.conf
 * ($XDG_CONFIG_HOME/radd, else ~/.config/radd), the system's
 * (SYSCONFDIR/radd).  An address is a socket's path (it has a '/') or
 * HOST:PORT, HOST alone meaning the default port; an IPv6 host stands in
 * brackets.
 * A coordinator's own machine has one more, for clients that only ask: the
 * socket that radcoord makes where nothing else is said.
 * The key file is named in the same places: by the command line, RADD_KEY, the
 * key `key` of either file.  */
#ifndef RADD_CLIENT_TARGET_H
#define RADD_CLIENT_TARGET_H

#include "base/error.h"
#include "common/inputs.h"

#include <stdbool.h>

struct target {
    bool local;      /* a Unix socket */
    char text[1024]; /* as given, for messages */
    char path[108];  /* local: the socket */
    char host[256];  /* else */
    char port[8];    /* decimal */
    char key[1024];  /* a key file, for what is not local; empty: none */
};

/* Parse what the user wrote; RAD_EUSAGE. */
int target_parse(struct target *a, const char *text, struct rad_error *err);

/* given, key: the command line's, or NULL.  Returns 1 and *a, 0 if no
 * coordinator is named anywhere, or a negative code: RAD_EUSAGE, RAD_ECONFIG
 * for a bad file.
 */
int target_find(struct target *a, const char *given, const char *key,
                struct rad_error *err);

/* Note the configuration files that target_find() may read. */
int target_note(struct inputs *in, struct rad_error *err);

/* The socket of this machine's coordinator, which may not be there. */
void target_default(struct target *a);

#endif
