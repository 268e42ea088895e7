/* keyfile.h - the keys by which hosts and users prove who they are
 *
 * A text file of one key a line:
 *
 *     ROLE:NAME:kN SECRET [EXPIRES]
 *
 * ROLE is worker, user, admin or observer; NAME has up to 64 letters, digits,
 * '.', '_' and '-'; N counts a name's keys from 1, so that a new one can be
 * handed out while the old one is still good.  SECRET is 64 hexadecimal digits,
 * 32 random bytes, or the word "retired": the line then only keeps its number
 * from being given again.  EXPIRES is a date, 2027-01-31 (at 00:00 UTC) or
 * 2027-01-31T12:00:00Z; from then on the key is not taken.  Blank lines and
 * those that begin with '#' are left alone.
 *
 * A key file is for its owner's eyes: one that its group or others may read or
 * write is refused.  But for what systemd hands over (LoadCredential), which
 * root's group may read.
 * Thread: a struct keyfile belongs to one thread. */
#ifndef KEYFILE_H
#define KEYFILE_H

#include "proto/message.h"

#include <stdbool.h>
#include <stdint.h>

#define KEY_SECRET     32         /* bytes */
#define KEY_MAX_NUMBER 999999     /* of one name */
#define KEY_ID         96         /* room for "worker:NAME:k999999", its NUL */
#define KEY_LINE       256        /* longest line, without its end */
#define KEY_MOST       4096       /* keys in a file */
#define KEY_MAX_FILE   (1u << 20) /* bytes */
#define KEY_DATE       24         /* room for a date, with its NUL */

struct key {
    enum msg_role role;
    char name[MSG_MAX_NAME + 1];
    uint32_t number; /* the N of kN */
    bool retired;    /* there is no secret then */
    uint8_t secret[KEY_SECRET];
    int64_t expires; /* seconds since 1970, UTC; 0: never */
    size_t at, len;  /* its line in the text, without the line's end */
};

struct keyfile {
    struct key *v; /* in the file's order */
    size_t n;
    char *text; /* the file as it is, comments and all */
    size_t len;
};

enum key_state { KEY_VALID, KEY_EXPIRED, KEY_RETIRED };

/* Nothing in it; release wipes the secrets. */
void keyfile_init(struct keyfile *f);
void keyfile_release(struct keyfile *f);

/* Take a text apart, which is copied; f is initialised by this.  RAD_ECONFIG
 * with the line's number as where, or RAD_ENOMEM; f is empty then. */
int keyfile_parse(struct keyfile *f, const char *text, size_t len,
                  struct rad_error *err);

/* The same from a file.  RAD_ENOINPUT when it cannot be read, RAD_EPERM when
 * others may read it, RAD_ECONFIG for what is wrong in it. */
int keyfile_load(struct keyfile *f, const char *path, struct rad_error *err);
/* From one that is open. */
int keyfile_load_fd(struct keyfile *f, int fd, const char *path,
                    struct rad_error *err);

/* --- what is in it --- */

/* "worker:ws07:k1". */
void key_id(const struct key *k, char id[KEY_ID]);
/* Take an id apart; `number` 0 where it has no ":kN".  False: it is none. */
bool key_id_parse(const char *id, struct key *k);

/* now: seconds since 1970. */
enum key_state key_state(const struct key *k, int64_t now);
const char *key_state_name(enum key_state s); /* "valid" ... */
const char *key_role_name(enum msg_role role);
/* May that be a NAME, n bytes long?  They go into logs, JSON and the names of
 * files. */
bool key_name_valid(const char *name, size_t n);

/* The key of that id, whatever its state; NULL: there is none. */
const struct key *keyfile_find(const struct keyfile *f, const char *id);

/* The newest valid key of a role; NULL: there is none. */
const struct key *keyfile_best(const struct keyfile *f, enum msg_role role,
                               int64_t now);

/* What to dial with in that role, from a file: its best key; else one that the
 * other side will refuse and say why: an expired one, or one of another role.
 * (A user has an admin's key before that.)  As keyfile_load(); RAD_EPERM, too,
 * where there is none but retired ones. */
int keyfile_choose(const char *path, enum msg_role role, char id[KEY_ID],
                   uint8_t secret[KEY_SECRET], struct rad_error *err);

/* A key's date: "2027-01-31", with the time of day where it is not midnight;
 * "" for never. */
void key_date_format(int64_t expires, char text[KEY_DATE]);
/* RAD_EUSAGE when it is none. */
int key_date_parse(const char *text, int64_t *expires, struct rad_error *err);

/* A key's line without its end; wipe it after use. */
void key_format(const struct key *k, char line[KEY_LINE + 1]);

/* --- changing it --- */

/* Take apart the "ROLE:NAME" of a key that is to be made; RAD_EUSAGE. */
int key_name_parse(const char *name, struct key *k, struct rad_error *err);

/* Make the next key of "ROLE:NAME", random, at the text's end; it is the last
 * of f->v.  RAD_EUSAGE for a bad name, RAD_ECONFIG when there are too many. */
int keyfile_add(struct keyfile *f, const char *name, int64_t expires,
                struct rad_error *err);

/* Retire "ROLE:NAME:kN", or all keys of "ROLE:NAME".  Returns how many were
 * not yet retired, or RAD_EUSAGE for a bad name, RAD_ENOINPUT for one that is
 * not there. */
int keyfile_retire(struct keyfile *f, const char *name, struct rad_error *err);

#endif
