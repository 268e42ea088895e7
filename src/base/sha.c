/* sha.c - see sha.h */
#include "config.h"

#include "base/sha.h"

#include <openssl/evp.h>

int
rad_sha_init(struct rad_sha *sha, struct rad_error *err)
{
    sha->bad = false;
    sha->ctx = EVP_MD_CTX_new();
    if (!sha->ctx)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    if (!EVP_DigestInit_ex(sha->ctx, EVP_sha256(), NULL)) {
        rad_sha_release(sha);
        return rad_fail(err, RAD_EINTERNAL, "SHA-256 is not available");
    }
    return 0;
}

void
rad_sha_update(struct rad_sha *sha, const void *p, size_t n)
{
    if (n && !EVP_DigestUpdate(sha->ctx, p, n))
        sha->bad = true;
}

int
rad_sha_final(struct rad_sha *sha, char hex[RAD_SHA_HEX + 1],
              struct rad_error *err)
{
    static const char digit[] = "0123456789abcdef";
    unsigned char sum[RAD_SHA_BYTES];

    if (!EVP_DigestFinal_ex(sha->ctx, sum, NULL))
        sha->bad = true;
    rad_sha_release(sha);
    if (sha->bad)
        return rad_fail(err, RAD_EINTERNAL, "SHA-256 failed");
    for (int i = 0; i < RAD_SHA_BYTES; i++) {
        hex[2 * i] = digit[sum[i] >> 4];
        hex[2 * i + 1] = digit[sum[i] & 15];
    }
    hex[RAD_SHA_HEX] = '\0';
    return 0;
}

void
rad_sha_release(struct rad_sha *sha)
{
    EVP_MD_CTX_free(sha->ctx);
    sha->ctx = NULL;
}

int
rad_sha_hex(const void *p, size_t n, char hex[RAD_SHA_HEX + 1],
            struct rad_error *err)
{
    struct rad_sha sha;
    int rc = rad_sha_init(&sha, err);

    if (rc)
        return rc;
    rad_sha_update(&sha, p, n);
    return rad_sha_final(&sha, hex, err);
}

bool
rad_sha_valid(const char *hex)
{
    int i = 0;

    for (; hex[i]; i++)
        if (i >= RAD_SHA_HEX || !((hex[i] >= '0' && hex[i] <= '9') ||
                                  (hex[i] >= 'a' && hex[i] <= 'f')))
            return false;
    return i == RAD_SHA_HEX;
}
