/* key.c - see key.h */
#include "config.h"

#include "net/key/key.h"

#include "base/hex.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

#define RETIRED "retired"

static const char *const roles[] = { [MSG_ROLE_WORKER] = "worker",
                                     [MSG_ROLE_USER] = "user",
                                     [MSG_ROLE_ADMIN] = "admin",
                                     [MSG_ROLE_OBSERVER] = "observer" };
enum { NROLES = sizeof roles / sizeof roles[0] };

/* --- words --- */

const char *
key_role_name(enum msg_role role)
{
    return (unsigned)role < NROLES && roles[role] ? roles[role] : "?";
}

static bool
is_digit(char c)
{
    return c >= '0' && c <= '9';
}

bool
key_name_valid(const char *s, size_t n)
{
    if (n < 1 || n > MSG_MAX_NAME)
        return false;
    for (size_t i = 0; i < n; i++)
        if (!is_digit(s[i]) && !(s[i] >= 'a' && s[i] <= 'z') &&
            !(s[i] >= 'A' && s[i] <= 'Z') && !memchr("._-", s[i], 3))
            return false;
    return true;
}

/* The N of "kN", n bytes long, without leading zeros; 0: malformed. */
static uint32_t
parse_number(const char *s, size_t n)
{
    uint32_t number = 0;

    if (n < 2 || n > 7 || s[0] != 'k' || s[1] == '0')
        return 0;
    for (size_t i = 1; i < n; i++) {
        if (!is_digit(s[i]))
            return 0;
        number = number * 10 + (uint32_t)(s[i] - '0');
    }
    return number; /* cannot overflow: at most six digits */
}

/* Parse an id of n bytes. */
static bool
parse_id(const char *s, size_t n, struct key *k)
{
    const char *colon = memchr(s, ':', n), *name, *second;
    size_t nrole = colon ? (size_t)(colon - s) : 0, nname;

    memset(k, 0, sizeof *k);
    for (int r = 0; r < NROLES && colon; r++)
        if (roles[r] && strlen(roles[r]) == nrole &&
            memcmp(s, roles[r], nrole) == 0)
            k->role = (enum msg_role)r;
    if (k->role == 0)
        return false;
    name = colon + 1;
    nname = n - nrole - 1;
    second = memchr(name, ':', nname);
    if (second) {
        size_t nnumber = nname - (size_t)(second - name) - 1;

        nname = (size_t)(second - name);
        k->number = parse_number(second + 1, nnumber);
        if (k->number == 0)
            return false;
    }
    if (!key_name_valid(name, nname))
        return false;
    memcpy(k->name, name, nname);
    return true;
}

bool
key_id_parse(const char *id, struct key *k)
{
    return parse_id(id, strlen(id), k);
}

void
key_id(const struct key *k, char id[KEY_ID])
{
    snprintf(id, KEY_ID, "%s:%s:k%u", key_role_name(k->role), k->name,
             k->number);
}

static bool
parse_secret(const char *s, size_t n, struct key *k)
{
    if (n == strlen(RETIRED) && memcmp(s, RETIRED, n) == 0) {
        k->retired = true;
        return true;
    }
    return n == 2 * KEY_SECRET && rad_hex_read(s, KEY_SECRET, k->secret);
}

int
key_name_parse(const char *name, struct key *k, struct rad_error *err)
{
    if (key_id_parse(name, k) && k->number == 0)
        return 0;
    return rad_fail(err, RAD_EUSAGE,
                    "'%.100s' names no key: expected worker:HOST, user:NAME, "
                    "admin:NAME or observer:PROGRAM",
                    name);
}

int
key_which_parse(const char *id, struct key *k, struct rad_error *err)
{
    if (key_id_parse(id, k))
        return 0;
    return rad_fail(err, RAD_EUSAGE,
                    "'%.100s' names no key: expected ROLE:NAME or "
                    "ROLE:NAME:kN",
                    id);
}

/* --- dates --- */

/* Read n digits as a number; false: there are other characters. */
static bool
digits(const char *s, int n, int *value)
{
    *value = 0;
    for (int i = 0; i < n; i++) {
        if (!is_digit(s[i]))
            return false;
        *value = *value * 10 + (s[i] - '0');
    }
    return true;
}

static bool
parse_date(const char *s, size_t n, int64_t *expires)
{
    struct tm tm = { 0 }, back;
    char text[KEY_DATE] = "";
    time_t t;

    if (n != 10 && n != 20)
        return false;
    memcpy(text, s, n); /* safe: behind a digit is a character, or the NUL */
    if (!digits(text, 4, &tm.tm_year) || text[4] != '-' ||
        !digits(text + 5, 2, &tm.tm_mon) || text[7] != '-' ||
        !digits(text + 8, 2, &tm.tm_mday))
        return false;
    if (n == 20 && (text[10] != 'T' || !digits(text + 11, 2, &tm.tm_hour) ||
                    text[13] != ':' || !digits(text + 14, 2, &tm.tm_min) ||
                    text[16] != ':' || !digits(text + 17, 2, &tm.tm_sec) ||
                    text[19] != 'Z'))
        return false;
    if (tm.tm_year < 1971) /* so no date is 0, which means never */
        return false;
    tm.tm_year -= 1900;
    tm.tm_mon--;
    back = tm;
    t = timegm(&tm);
    /* timegm() takes 2027-02-31 for a day in March */
    if (back.tm_mon != tm.tm_mon || back.tm_mday != tm.tm_mday ||
        back.tm_hour != tm.tm_hour || back.tm_min != tm.tm_min ||
        back.tm_sec != tm.tm_sec)
        return false;
    *expires = (int64_t)t;
    return true;
}

int
key_date_parse(const char *text, int64_t *expires, struct rad_error *err)
{
    if (parse_date(text, strlen(text), expires))
        return 0;
    return rad_fail(err, RAD_EUSAGE,
                    "'%s' is no date: expected 2027-01-31 or "
                    "2027-01-31T12:00:00Z",
                    text);
}

void
key_date_format(int64_t expires, char text[KEY_DATE])
{
    time_t t = (time_t)expires;
    struct tm tm;

    text[0] = '\0';
    if (expires != 0 && gmtime_r(&t, &tm))
        strftime(text, KEY_DATE,
                 expires % 86400 ? "%Y-%m-%dT%H:%M:%SZ" : "%Y-%m-%d", &tm);
}

/* --- lines --- */

/* The next word of a line; *at moves behind it.  Returns its length, 0 at the
 * end. */
static size_t
next_word(const char *line, size_t len, size_t *at, const char **word)
{
    size_t n = 0;

    while (*at < len && (line[*at] == ' ' || line[*at] == '\t'))
        ++*at;
    *word = line + *at;
    while (*at < len && line[*at] != ' ' && line[*at] != '\t') {
        ++*at;
        n++;
    }
    return n;
}

const char *
key_parse(const char *line, size_t len, struct key *k)
{
    const char *word;
    size_t at = 0, n = next_word(line, len, &at, &word);

    if (!parse_id(word, n, k) || k->number == 0)
        return "expected ROLE:NAME:kN, with ROLE worker, user, admin or "
               "observer";
    n = next_word(line, len, &at, &word);
    if (!parse_secret(word, n, k))
        return "expected 64 hexadecimal digits or 'retired'";
    n = next_word(line, len, &at, &word);
    if (n > 0 && !parse_date(word, n, &k->expires))
        return "expected a date as 2027-01-31";
    if (next_word(line, len, &at, &word) > 0)
        return "something stands behind the key";
    return NULL;
}

void
key_format(const struct key *k, char line[KEY_LINE + 1])
{
    char id[KEY_ID], secret[2 * KEY_SECRET + 1] = RETIRED, date[KEY_DATE];

    key_id(k, id);
    if (!k->retired)
        rad_hex_write(k->secret, KEY_SECRET, secret);
    key_date_format(k->expires, date);
    snprintf(line, KEY_LINE + 1, "%s %s%s%s", id, secret, date[0] ? " " : "",
             date);
    explicit_bzero(secret, sizeof secret);
}

/* --- states --- */

bool
key_date_is_past(int64_t expires, int64_t now)
{
    return expires != 0 && now >= expires;
}

enum key_state
key_state(const struct key *k, int64_t now)
{
    if (k->retired)
        return KEY_RETIRED;
    return key_date_is_past(k->expires, now) ? KEY_EXPIRED : KEY_VALID;
}

const char *
key_state_name(enum key_state s)
{
    static const char *const names[] = { "valid", "expired", RETIRED };

    return names[s];
}
