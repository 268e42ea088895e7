/* keyorder.h - orders of `radctl key`: add, retire, list
 *
 * The file is changed in place, by radctl itself or by the coordinator at an
 * administrator's request.
 * Thread: any. */
#ifndef KEYORDER_H
#define KEYORDER_H

#include "net/key/keyfile.h"

struct key_order {
    enum msg_key_order what;
    const char *name; /* not used by a list */
    int64_t expires;  /* of a new key, seconds since 1970; 0: never */
    bool in_use;      /* a coordinator uses the file: never make a new one */
};

/* Can there be such a key?  now: seconds since 1970.  RAD_EUSAGE: no, or a new
 * key would have expired already. */
int key_order_check(const struct key_order *order, int64_t now,
                    struct rad_error *err);

/* Carry out the order on the key file at path.  MSG_KEY_ADD makes a missing
 * file, unless it is in use: a file with just one key would shut all others
 * out.  *json gets the result, to be freed by the caller (that of a new key
 * holds its secret): an object, or an array for a list; NULL on failure. Errors
 * as of key_order_check(), keyfile_load(), keyfile_add() and keyfile_retire();
 * RAD_ECANTCREAT, RAD_EIO, RAD_ENOMEM. */
int key_order_run(const char *path, const struct key_order *order, int64_t now,
                  char **json, struct rad_error *err);

#endif
