/* fuzz_tls.c - whatever comes to a server, or to a client, of TLS
 *
 * The first byte says to which, and how long the pieces are.  Nobody gets in:
 * the bytes cannot know the secret. */
#include "config.h"

#include "net/tls.h"
#include "tests/fuzz/fuzz.h"

#include <stdlib.h>
#include <string.h>

static const char *
find(void *arg, const char *id, uint8_t secret[TLS_SECRET])
{
    (void)arg;
    memset(secret, 7, TLS_SECRET);
    if (strncmp(id, "peer:", 5) == 0)
        return TLS_LATER;
    return strcmp(id, "worker:w:k1") == 0 ? NULL : "unknown key";
}

static void
hear(struct tls *t, size_t piece, const uint8_t *data, size_t size)
{
    const uint8_t *out;
    uint8_t buf[64];
    int rc = tls_handshake(t, NULL);

    for (size_t at = 0; at < size && rc == 0; at += piece) {
        size_t n = size - at < piece ? size - at : piece;

        if (tls_put(t, data + at, n, NULL) < 0)
            break;
        rc = tls_handshake(t, NULL);
        tls_out(t, &out);
        tls_sent(t);
    }
    if (rc == 1 || tls_read(t, buf, sizeof buf, NULL) != 0)
        abort();
}

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const uint8_t secret[TLS_SECRET] = { 9 };
    struct tls_ctx *ctx;
    struct tls *t;

    if (size < 1)
        return 0;
    ctx = data[0] & 1 ? tls_client() : tls_server(find, NULL);
    t = !ctx          ? NULL
        : data[0] & 1 ? tls_dial(ctx, "worker:w:k1", secret)
                      : tls_accept(ctx);
    if (t)
        hear(t, (size_t)(data[0] >> 1) + 1, data + 1, size - 1);
    tls_free(t);
    tls_ctx_free(ctx);
    return 0;
}
