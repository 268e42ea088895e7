/* keyfile.h - the keys by which hosts and users prove who they are
 *
 * A text file with one key per line (key.h).  Blank lines and those that begin
 * with '#' are ignored, and kept.
 *
 * A key file that group or others may read or write is refused, except for one
 * that systemd hands over (LoadCredential), which root's group may read.
 * Thread: a struct keyfile belongs to one thread. */
#ifndef KEYFILE_H
#define KEYFILE_H

#include "net/key/key.h"

#define KEY_MOST     4096       /* keys in a file */
#define KEY_MAX_FILE (1u << 20) /* bytes */

struct keyfile {
    struct key *v; /* in the file's order */
    size_t n;
    char *text; /* the file's text, with its comments */
    size_t len;
};

/* Init makes an empty one; release wipes the secrets. */
void keyfile_init(struct keyfile *f);
void keyfile_release(struct keyfile *f);

/* Parse a text, which is copied; initialises f.  RAD_ECONFIG with the line's
 * number as where, or RAD_ENOMEM; f is empty then. */
int keyfile_parse(struct keyfile *f, const char *text, size_t len,
                  struct rad_error *err);

/* Read a file.  RAD_ENOINPUT: it cannot be read; RAD_EPERM: others may read it;
 * RAD_ECONFIG: it is malformed. */
int keyfile_load(struct keyfile *f, const char *path, struct rad_error *err);
/* The same for an open file. */
int keyfile_load_fd(struct keyfile *f, int fd, const char *path,
                    struct rad_error *err);

/* The key of that id, in any state; NULL: there is none. */
const struct key *keyfile_find(const struct keyfile *f, const char *id);

/* The newest valid key of that role; NULL: there is none. */
const struct key *keyfile_best(const struct keyfile *f, enum msg_role role,
                               int64_t now);

/* Choose the key to dial with in that role from a file: its best key; if it has
 * none, an expired key or one of another role, which the other side refuses. (A
 * user prefers an administrator's key to those.)  expires: as in struct key.
 * Errors as of keyfile_load(); RAD_EPERM also if all keys are retired. */
int keyfile_choose(const char *path, enum msg_role role, char id[KEY_ID],
                   uint8_t secret[KEY_SECRET], int64_t *expires,
                   struct rad_error *err);

/* --- changing a key file --- */

/* Make the next key of "ROLE:NAME", with a random secret, at the text's end; it
 * becomes the last of f->v.  RAD_EUSAGE: a bad name; RAD_ECONFIG: too many
 * keys. */
int keyfile_add(struct keyfile *f, const char *name, int64_t expires,
                struct rad_error *err);

/* Retire "ROLE:NAME:kN", or all keys of "ROLE:NAME".  Returns how many of these
 * were not retired yet; RAD_EUSAGE: a bad name; RAD_ENOINPUT: no such key. */
int keyfile_retire(struct keyfile *f, const char *name, struct rad_error *err);

#endif
