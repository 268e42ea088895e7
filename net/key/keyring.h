/* keyring.h - the coordinator's keys, while it runs
 *
 * The keys of its key file (keyfile.h), which is read again on request or when
 * it has changed.  If it cannot be read the old keys stay.
 * Thread: the loop's. */
#ifndef RADD_NET_KEYRING_H
#define RADD_NET_KEYRING_H

#include "net/key/keyfile.h"

struct keyring;

/* An empty path: there are no keys, and nobody can prove one.  Returns codes of
 * keyfile_load(). */
int keyring_open(struct keyring **k, const char *path, struct rad_error *err);
void keyring_free(struct keyring *k);

bool keyring_has_file(const struct keyring *k);
const char *keyring_path(const struct keyring *k);

/* Read the file again.  Until keyring_settle(), keyring_fault() also compares
 * with the old keys. */
int keyring_reload(struct keyring *k, struct rad_error *err);
void keyring_settle(struct keyring *k);
/* Has the file changed since it was read? */
bool keyring_changed(const struct keyring *k);

/* A tls_find_fn. */
const char *keyring_find(void *keyring, const char *id, uint8_t *secret);

/* A shell_key_fn: why a key that was proven is not valid any more; NULL: it is.
 */
const char *keyring_fault(void *keyring, const char *id);

#endif
