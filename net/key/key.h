/* key.h - a key by which a host or a user proves who it is: one line of text
 *
 *     ROLE:NAME:kN SECRET [EXPIRES]
 *
 * ROLE is worker, user, admin or observer.  NAME has up to 64 letters, digits,
 * '.', '_' and '-'.  N counts the keys of a name from 1: a new key can be
 * handed out while the old one is still valid.  SECRET is 64 hexadecimal
 * digits, 32 random bytes; or the word "retired", and then the line only keeps
 * its number from being given again.  EXPIRES is a date, 2027-01-31 (at 00:00
 * UTC) or 2027-01-31T12:00:00Z, from which on the key is not accepted.
 * Thread: any. */
#ifndef KEY_H
#define KEY_H

#include "proto/message.h"

#include <stdbool.h>
#include <stdint.h>

#define KEY_SECRET     32         /* bytes */
#define KEY_MAX_NUMBER 999999     /* highest N of a name */
#define KEY_ID         96         /* room for "worker:NAME:k999999", its NUL */
#define KEY_LINE       256        /* longest line, without its end */
#define KEY_DATE       24         /* room for a date, with its NUL */

struct key {
    enum msg_role role;
    char name[MSG_MAX_NAME + 1];
    uint32_t number; /* the N of kN */
    bool retired;    /* then it has no secret */
    uint8_t secret[KEY_SECRET];
    int64_t expires; /* seconds since 1970, UTC; 0: never */
    size_t at, len;  /* of a key file: the line in its text, without newline */
};

enum key_state { KEY_VALID, KEY_EXPIRED, KEY_RETIRED };

/* Parse a line, without its newline; returns why it is not a key, or NULL. */
const char *key_parse(const char *line, size_t len, struct key *k);
/* A key's line without its newline; wipe it after use. */
void key_format(const struct key *k, char line[KEY_LINE + 1]);

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

/* A key's date: "2027-01-31", with the time of day unless it is midnight; ""
 * for never. */
void key_date_format(int64_t expires, char text[KEY_DATE]);
/* Is the date past?  "Never", 0, is not. */
bool key_date_is_past(int64_t expires, int64_t now);
/* RAD_EUSAGE: malformed. */
int key_date_parse(const char *text, int64_t *expires, struct rad_error *err);

/* Parse the "ROLE:NAME" of a new key; RAD_EUSAGE. */
int key_name_parse(const char *name, struct key *k, struct rad_error *err);
/* Parse an id that a user gave, as key_id_parse() does; RAD_EUSAGE. */
int key_which_parse(const char *id, struct key *k, struct rad_error *err);

#endif
