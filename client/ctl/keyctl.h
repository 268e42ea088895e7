/* keyctl.h - radctl's commands about keys
 *
 * They edit a key file, or ask the coordinator to; the answer is the JSON of
 * key_order_run() in both cases.
 * Thread: any. */
#ifndef RADD_CLIENT_KEYCTL_H
#define RADD_CLIENT_KEYCTL_H

#include "net/key/keyorder.h"

#include <jansson.h>

/* Make an order of the words after "key": what to do; the name, or NULL;
 * --expires, or NULL.  RAD_EUSAGE. */
int keyctl_parse(struct key_order *order, const char *what, const char *name,
                 const char *expires, struct rad_error *err);

/* Print the answer: with `json` as it is; else the line of a new key, or a
 * table of a list.  RAD_EPROTO: it has no key. */
int keyctl_print(const struct key_order *order, const json_t *root, bool json,
                 struct rad_error *err);

#endif
