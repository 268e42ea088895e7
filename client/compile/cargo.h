/* cargo.h - a compiled scene's files as they are offered and sent
 *
 * A bundle's files by their hashes, in binary, and its manifest, which is one
 * more file of the job.
 * Thread: one.  */
#ifndef RADD_CLIENT_CARGO_H
#define RADD_CLIENT_CARGO_H

#include "proto/message.h"
#include "scene/file/bundle.h"

struct cargo {
    const struct rad_bundle *bundle; /* borrowed, as is dir */
    const char *dir;                 /* files lie at dir/<hash> */
    char *manifest;
    size_t manifest_len;
    uint8_t *hashes; /* n of MSG_HASH bytes, all different, manifest first */
    uint32_t n;
};

/* RAD_EDATA for more files than a message can name, RAD_ENOMEM. */
int cargo_init(struct cargo *c, const struct rad_bundle *bundle,
               const char *dir, struct rad_error *err);
void cargo_release(struct cargo *c);

/* The file of that hash, malloc'd; RAD_EPROTO if it is none of the cargo. */
int cargo_read(const struct cargo *c, const uint8_t hash[MSG_HASH],
               unsigned char **bytes, size_t *len, struct rad_error *err);

#endif
