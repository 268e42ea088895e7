/* keyfile.h - the keys by which hosts and users prove who they are
 *
 * A text file with one key per line:
 *
 *     ROLE:NAME:kN SECRET [EXPIRES]
 *
 * ROLE is worker, user, admin or observer.  NAME has up to 64 letters, digits,
 * '.', '_' and '-'.  N counts the keys of a name from 1: a new key can be
 * handed out while the old one is still valid.  SECRET is 64 hexadecimal
 * digits, 32 random bytes; or the word "retired", and then the line only keeps
 * its number from being given again.  EXPIRES is a date, 2027-01-31 (at 00:00
 * UTC) or 2027-01-31T12:00:00Z, from which on the key is not accepted.  Blank
 * lines and those that begin with '#' are ignored, and kept.
 *
 * A key file that group or others may read or write is refused, except for one
 * that systemd hands over (LoadCredential), which root's group may read.
 * Thread: a struct keyfile belongs to one thread. */
#ifndef KEYFILE_H
#define KEYFILE_H

#include "proto/message.h"

#include <stdbool.h>
#include <stdint.h>

#define KEY_SECRET     32         /* bytes */
#define KEY_MAX_NUMBER 999999     /* highest N of a name */
#define KEY_ID         96         /* room for "worker:NAME:k999999", its NUL */
#define KEY_LINE       256        /* longest line, without its end */
#define KEY_MOST       4096       /* keys in a file */
#define KEY_MAX_FILE   (1u << 20) /* bytes */
#define KEY_DATE       24         /* room for a date, with its NUL */

struct key {
    enum msg_role role;
    char name[MSG_MAX_NAME + 1];
    uint32_t number; /* the N of kN */
    bool retired;    /* then it has no secret */
    uint8_t secret[KEY_SECRET];
    int64_t expires; /* seconds since 1970, UTC; 0: never */
    size_t at, len;  /* the key's line in the text, without its newline */
};

struct keyfile {
    struct key *v; /* in the file's order */
    size_t n;
    char *text; /* the file's text, with its comments */
    size_t len;
};

enum key_state { KEY_VALID, KEY_EXPIRED, KEY_RETIRED };

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

/* --- keys of a file --- */

/* "worker:ws07:k1". */
void key_id(const struct key *k, char id[KEY_ID]);
/* Parse an id; k->number is 0 if it has no ":kN".  False: malformed. */
bool key_id_parse(const char *id, struct key *k);

/* now: seconds since 1970. */
enum key_state key_state(const struct key *k, int64_t now);
const char *key_state_name(enum key_state s); /* "valid", for instance */
const char *key_role_name(enum msg_role role);
/* Are these n bytes a valid NAME?  NAMEs appear in logs, JSON and file names.
 */
bool key_name_valid(const char *name, size_t n);

/* The key of that id, in any state; NULL: there is none. */
const struct key *keyfile_find(const struct keyfile *f, const char *id);

/* The newest valid key of that role; NULL: there is none. */
const struct key *keyfile_best(const struct keyfile *f, enum msg_role role,
                               int64_t now);

/* Choose the key to dial with in that role from a file: its best key; if it has
 * none, an expired key or one of another role, so that the other side refuses
 * it and says why.  (A user prefers an administrator's key to those.)  Errors
 * as of keyfile_load(); RAD_EPERM also if all keys are retired. */
int keyfile_choose(const char *path, enum msg_role role, char id[KEY_ID],
                   uint8_t secret[KEY_SECRET], struct rad_error *err);

/* A key's date: "2027-01-31", with the time of day unless it is midnight; ""
 * for never. */
void key_date_format(int64_t expires, char text[KEY_DATE]);
/* RAD_EUSAGE: malformed. */
int key_date_parse(const char *text, int64_t *expires, struct rad_error *err);

/* A key's line without its newline; wipe it after use. */
void key_format(const struct key *k, char line[KEY_LINE + 1]);

/* --- changing a key file --- */

/* Parse the "ROLE:NAME" of a new key; RAD_EUSAGE. */
int key_name_parse(const char *name, struct key *k, struct rad_error *err);

/* Make the next key of "ROLE:NAME", with a random secret, at the text's end; it
 * becomes the last of f->v.  RAD_EUSAGE: a bad name; RAD_ECONFIG: too many
 * keys. */
int keyfile_add(struct keyfile *f, const char *name, int64_t expires,
                struct rad_error *err);

/* Retire "ROLE:NAME:kN", or all keys of "ROLE:NAME".  Returns how many of these
 * were not retired yet; RAD_EUSAGE: a bad name; RAD_ENOINPUT: no such key. */
int keyfile_retire(struct keyfile *f, const char *name, struct rad_error *err);

#endif
