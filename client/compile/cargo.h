/* cargo.h - the files of a compiled scene, ready to be offered and sent
 *
 * They are the bundle's files, by their hashes in binary, and its manifest,
 * which is a file of the job, too.
 * Thread: one. */
#ifndef RADD_CLIENT_CARGO_H
#define RADD_CLIENT_CARGO_H

#include "proto/message.h"
#include "scene/file/bundle.h"

struct cargo {
    const struct rad_bundle *bundle; /* borrowed, like dir */
    const char *dir;                 /* files lie at dir/<hash> */
    char *manifest;
    size_t manifest_len;
    uint8_t *hashes; /* n of MSG_HASH bytes, all different, manifest first */
    uint32_t n;
};

/* RAD_EDATA: more files than a message can list; RAD_ENOMEM. */
int cargo_init(struct cargo *c, const struct rad_bundle *bundle,
               const char *dir, struct rad_error *err);
void cargo_release(struct cargo *c);

/* Read the file of that hash, malloc'd; RAD_EPROTO: it is not in the cargo. */
int cargo_read(const struct cargo *c, const uint8_t hash[MSG_HASH],
               unsigned char **bytes, size_t *len, struct rad_error *err);

#endif
