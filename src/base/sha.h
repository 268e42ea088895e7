/* sha.h - SHA-256 (FIPS 180-4), by which files are named
 *
 * A thin layer over libcrypto.
 * Thread: a struct rad_sha belongs to one thread.  */
#ifndef RAD_BASE_SHA_H
#define RAD_BASE_SHA_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define RAD_SHA_BYTES 32
#define RAD_SHA_HEX   64 /* digits; a string has one byte more */

struct rad_sha {
    void *ctx; /* SHA256_CTX */
    bool bad;  /* a step failed; rad_sha_final() reports it */
};

int rad_sha_init(struct rad_sha *sha, struct rad_error *err);
void rad_sha_update(struct rad_sha *sha, const void *p, size_t n);
/* The digest as lower-case hex digits; releases sha. */
int rad_sha_final(struct rad_sha *sha, char hex[RAD_SHA_HEX + 1],
                  struct rad_error *err);
/* End without a digest. */
void rad_sha_release(struct rad_sha *sha);

/* The digest of n bytes. */
int rad_sha_hex(const void *p, size_t n, char hex[RAD_SHA_HEX + 1],
                struct rad_error *err);

void rad_sha_to_hex(const uint8_t digest[RAD_SHA_BYTES],
                    char hex[RAD_SHA_HEX + 1]);
/* hex must satisfy rad_sha_valid(). */
void rad_sha_from_hex(const char *hex, uint8_t digest[RAD_SHA_BYTES]);

/* Sort an array of n digests, one behind the other, and drop duplicates;
 * returns how many are left. */
size_t rad_sha_unique(uint8_t *digests, size_t n);
/* Is the digest in such a sorted array? */
bool rad_sha_among(const uint8_t *digests, size_t n,
                   const uint8_t digest[RAD_SHA_BYTES]);

/* Is hex exactly 64 digits 0-9 a-f?  Then it is safe as a file name. */
bool rad_sha_valid(const char *hex);

#endif
