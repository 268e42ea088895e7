/* keyring.h - the coordinator's keys, while it runs
 *
 * Its key file (keyfile.h) in memory; read again when somebody says so or the
 * file has changed.  A file that cannot be read any more changes nothing.
 * Thread: the loop's. */
#ifndef RADD_NET_KEYRING_H
#define RADD_NET_KEYRING_H

#include "net/key/keyfile.h"

struct keyring;

/* An empty path: no keys, and nobody who proves one.  Codes of
 * keyfile_load(). */
int keyring_open(struct keyring **k, const char *path, struct rad_error *err);
void keyring_free(struct keyring *k);

bool keyring_has_file(const struct keyring *k);
const char *keyring_path(const struct keyring *k);

/* Read the file again.  Until keyring_settle(), keyring_fault() compares with
 * what was there before. */
int keyring_reload(struct keyring *k, struct rad_error *err);
void keyring_settle(struct keyring *k);
/* Is the file another than the one that was read? */
bool keyring_changed(const struct keyring *k);

/* A tls_find_fn. */
const char *keyring_find(void *keyring, const char *id, uint8_t *secret);

/* A shell_key_fn: why a key that was proven is no longer good. */
const char *keyring_fault(void *keyring, const char *id);

#endif
