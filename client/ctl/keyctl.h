/* keyctl.h - radctl's commands about keys
 *
 * Edits a key file itself, or asks the coordinator to; either way the answer
 * is the JSON of key_order_run().
 * Thread: any.  */
#ifndef RADD_CLIENT_KEYCTL_H
#define RADD_CLIENT_KEYCTL_H

#include "net/key/keyorder.h"

#include <jansson.h>

/* From the words behind "key": what to do, the name that it needs or NULL, and
 * --expires or NULL.  RAD_EUSAGE. */
int keyctl_parse(struct key_order *order, const char *what, const char *name,
                 const char *expires, struct rad_error *err);

/* Onto standard output: the answer as it is, or for people: of a new key the
 * line for its host, of a list a table.  RAD_EPROTO if it holds no key. */
int keyctl_print(const struct key_order *order, const json_t *root, bool json,
                 struct rad_error *err);

#endif
