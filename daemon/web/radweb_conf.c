/* radweb_conf.c - settings; see radweb_impl.h */
#include "config.h"

#include "web/radweb_impl.h"

#include "ground/service.h"

#include <string.h>

#define FIELD(f) offsetof(struct radweb_settings, f)
static const struct conf_key keys[] = {
    { "coordinator", CONF_TEXT_KEY, FIELD(coordinator), 0, 0,
      "127.0.0.1:" RADCOORD_PORT, "HOST:PORT|PATH", "whose cluster is shown",
      false },
    { "key", CONF_TEXT_KEY, FIELD(key), 0, 0, "", "FILE",
      "an observer's key, for a coordinator over the network", false },
    { "listen", CONF_TEXT_KEY, FIELD(listen), 0, 0, "127.0.0.1:7480",
      "ADDR:PORT", "where browsers come", false },
    { "token_file", CONF_TEXT_KEY, FIELD(token_file), 0, 0, "", "FILE",
      "with the token that browsers must know; empty: none", false },
    { "tls_cert", CONF_TEXT_KEY, FIELD(tls_cert), 0, 0, "", "FILE",
      "certificate (PEM) by which it speaks TLS", false },
    { "tls_key", CONF_TEXT_KEY, FIELD(tls_key), 0, 0, "", "FILE",
      "the certificate's key (PEM)", false },
    { "proxy", CONF_BOOL_KEY, FIELD(proxy), 0, 0, "no", "yes|no",
      "a proxy on another machine speaks TLS for it", false },
    DAEMON_KEYS,
};

static int
check_text(const char *name, const char *value, struct rad_error *err)
{
    char host[ADDRESS_TEXT], port[8];
    bool local;
    int rc;

    if (strcmp(name, "coordinator") == 0)
        return address_split(value, host, port, &local, err);
    if (strcmp(name, "listen") != 0)
        return daemon_check_text(name, value, err);
    rc = address_split(value, host, port, &local, err);
    if (rc == 0 && local)
        return rad_fail(err, RAD_ECONFIG, "expected ADDR:PORT, got '%s'",
                        value);
    return rc;
}

const struct conf_table radweb_table = {
    .program = "radweb",
    .synopsis = "[--coordinator=HOST:PORT] [--key=FILE] [--listen=ADDR:PORT] "
                "...",
    .about = "Show a cluster in a browser, and to programs that watch it, see "
             "radweb(8);\nit stays in the foreground.",
    .file = SYSCONFDIR "/radd/radweb.conf",
    .private_key = "embedded",
    .keys = keys,
    .size = sizeof(struct radweb_settings),
    .check_text = check_text,
};
