/* keyorder.h - what `radctl key` asks of a key file
 *
 * The file is changed where it lies, by radctl itself or by the coordinator
 * that an admin asks to.
 * Thread: any. */
#ifndef KEYORDER_H
#define KEYORDER_H

#include "net/key/keyfile.h"

struct key_order {
    enum msg_key_order what;
    const char *name; /* not of a list */
    int64_t expires;  /* of a new key, seconds since 1970; 0: never */
    bool in_use;      /* the file has been read before, and is not made anew */
};

/* Do that to the file at path, which MSG_KEY_ADD makes if it is missing, unless
 * it is in use: with one key alone it would shut all others out.  *json says
 * what came of it, for the caller to free (that of a new key holds its secret):
 * an object, of a list an array; NULL on failure.  now: seconds since 1970.
 * RAD_EUSAGE for a new key that would have expired by then; errors as of
 * keyfile_load(), keyfile_add() and keyfile_retire(); RAD_ECANTCREAT, RAD_EIO,
 * RAD_ENOMEM. */
int key_order_run(const char *path, const struct key_order *order, int64_t now,
                  char **json, struct rad_error *err);

#endif
