/* radweb_auth.c - may a request be answered? see radweb_impl.h
 *
 * If radweb has a token each request must carry it, as a bearer's
 * ("Authorization: Bearer TOKEN") or as the password of any user name, for
 * which a browser asks its user.  Without a token radweb serves this machine
 * alone.  A stranger's page in a browser on this machine must not read the
 * answers, though it may have the name of its server resolve to 127.0.0.1 (DNS
 * rebinding): so the Host that the browser sends has to be a name of this
 * machine. */
#include "config.h"

#include "web/radweb_impl.h"

#include "base/files.h"

#include <openssl/crypto.h>
#include <openssl/sha.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

int
radweb_read_token(struct radweb *r, struct rad_error *err)
{
    size_t n;
    char *text;

    if (!r->set.token_file[0])
        return 0;
    text = (char *)rad_file_read(r->set.token_file, RADWEB_TOKEN - 1, &n, err);
    if (!text)
        return err->code;
    n = strcspn(text, " \t\r\n");
    snprintf(r->token, sizeof r->token, "%.*s", (int)n, text);
    explicit_bzero(text, strlen(text));
    free(text);
    if (n >= RADWEB_MIN_TOKEN)
        return 0;
    return rad_fail(err, RAD_ECONFIG,
                    "'%s': a token has at least %d characters",
                    r->set.token_file, RADWEB_MIN_TOKEN);
}

int
radweb_check_listen(const struct radweb *r, struct rad_error *err)
{
    struct address a;
    int rc = address_resolve_listen(r->set.listen, &a, err);

    if (!r->set.tls_cert[0] != !r->set.tls_key[0])
        return rad_fail(err, RAD_EUSAGE,
                        "tls_cert and tls_key: one is there without the other");
    if (rc < 0 || address_is_loopback(&a))
        return rc;
    if (!r->set.tls_cert[0] && !r->set.proxy)
        return rad_fail(err, RAD_EPERM,
                        "'%s' is for other machines: that takes tls_cert and "
                        "tls_key, or proxy=yes behind one that speaks TLS",
                        r->set.listen);
    if (!r->token[0])
        return rad_fail(err, RAD_EPERM,
                        "'%s' is for other machines: that takes a token "
                        "(token_file)",
                        r->set.listen);
    return 0;
}

/* Does the request carry our token?  The time of the comparison does not tell
 * how many characters are right. */
static bool
is_token(const struct radweb *r, const char *said)
{
    uint8_t is[SHA256_DIGEST_LENGTH], ours[SHA256_DIGEST_LENGTH];

    SHA256((const uint8_t *)said, strlen(said), is);
    SHA256((const uint8_t *)r->token, strlen(r->token), ours);
    return CRYPTO_memcmp(is, ours, sizeof is) == 0;
}

static bool
knows_token(const struct radweb *r, struct MHD_Connection *c)
{
    const char *said = MHD_lookup_connection_value(
        c, MHD_HEADER_KIND, MHD_HTTP_HEADER_AUTHORIZATION);
    char *user, *password = NULL;
    bool ok = false;

    if (!said)
        return false;
    if (strncasecmp(said, "Bearer ", 7) == 0)
        return is_token(r, said + 7 + strspn(said + 7, " "));
    user = MHD_basic_auth_get_username_password(c, &password);
    if (user && password)
        ok = is_token(r, password);
    MHD_free(user);
    MHD_free(password);
    return ok;
}

/* Is the host "localhost", 127.x.y.z or [::1], with or without a port? */
static bool
names_this_machine(const char *host)
{
    size_t n;

    if (!host) /* no browser: a browser always sends a Host */
        return true;
    if (host[0] == '[')
        return strncmp(host, "[::1]", 5) == 0 &&
               (host[5] == '\0' || host[5] == ':');
    n = strcspn(host, ":");
    if (n == 9 && strncasecmp(host, "localhost", 9) == 0)
        return true;
    return strncmp(host, "127.", 4) == 0 && strspn(host, "0123456789.") == n;
}

unsigned
radweb_refuses(struct radweb *r, struct MHD_Connection *c)
{
    const char *host =
        MHD_lookup_connection_value(c, MHD_HEADER_KIND, MHD_HTTP_HEADER_HOST);
    unsigned status = 0, dropped;

    if (r->token[0])
        status = knows_token(r, c) ? 0 : MHD_HTTP_UNAUTHORIZED;
    else if (!names_this_machine(host))
        status = MHD_HTTP_MISDIRECTED_REQUEST;
    if (status == 0)
        return 0;
    r->served.refused++;
    if (log_allowed(&r->refused, uv_now(&r->daemon.loop), &dropped))
        log_info("request refused status=%u kept_back=%u", status, dropped);
    return status;
}
