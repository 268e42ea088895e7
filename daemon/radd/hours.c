/* hours.c - see hours.h */
#include "config.h"

#include "radd/hours.h"

#include <ctype.h>
#include <string.h>

#define DAY (24 * 60)

static void
skip_space(const char **s)
{
    while (**s == ' ' || **s == '\t')
        ++*s;
}

/* Take a day, "sun" to "sat", and return its number, 0 to 6; -1: not a day. */
static int
take_day(const char **s)
{
    static const char name[7][4] = { "sun", "mon", "tue", "wed",
                                     "thu", "fri", "sat" };

    for (int i = 0; i < 7; i++) {
        int n = 0;

        while (n < 3 && tolower((unsigned char)(*s)[n]) == name[i][n])
            n++;
        if (n == 3 && !isalpha((unsigned char)(*s)[3])) {
            *s += 3;
            return i;
        }
    }
    return -1;
}

/* Take a number of one or two digits; -1: no digits, or more than two. */
static int
take_number(const char **s)
{
    int v = 0, n = 0;

    while (isdigit((unsigned char)**s) && n++ < 3)
        v = 10 * v + *(*s)++ - '0';
    return n == 1 || n == 2 ? v : -1;
}

/* Take a time, such as "7", "7:30" or "24", in minutes; -1: not a time. */
static int
take_time(const char **s)
{
    int h = take_number(s), m = 0;

    if (**s == ':') {
        ++*s;
        m = take_number(s);
    }
    return h < 0 || m < 0 || m > 59 || 60 * h + m > DAY ? -1 : 60 * h + m;
}

static void
open_minutes(struct hours *h, int day, int from, int to)
{
    for (int m = from; m < (to <= from ? to + DAY : to); m++) {
        int i = (day * DAY + m) % HOURS_MINUTES;

        h->open[i / 8] |= (uint8_t)(1u << i % 8);
    }
}

/* Take one item, up to its comma; false: it is malformed. */
static bool
take_item(const char **s, struct hours *h)
{
    int first, last, from = 0, to = DAY;

    skip_space(s);
    first = last = take_day(s);
    if (first >= 0 && **s == '-') {
        ++*s;
        if ((last = take_day(s)) < 0)
            return false;
    }
    skip_space(s);
    if (first < 0 || (**s != ',' && **s != '\0')) {
        from = take_time(s);
        if (from < 0 || *(*s)++ != '-' || (to = take_time(s)) < 0 || from == to)
            return false;
        skip_space(s);
    }
    if (first < 0)
        first = 0, last = 6;
    for (int day = first;; day = (day + 1) % 7) {
        open_minutes(h, day, from, to);
        if (day == last)
            break;
    }
    return **s == ',' || **s == '\0';
}

int
hours_parse(const char *text, struct hours *h, struct rad_error *err)
{
    const char *s = text;

    memset(h->open, text[0] ? 0 : 0xff, sizeof h->open);
    while (*s) {
        if (!take_item(&s, h) || (*s == ',' && s[1] == '\0'))
            return rad_fail(err, RAD_EUSAGE,
                            "hours are like 'mon-fri 19:00-07:00, sat', not "
                            "'%.100s'",
                            text);
        if (*s == ',')
            s++;
    }
    return 0;
}

bool
hours_open(const struct hours *h, int weekday, int minute)
{
    int i = weekday * DAY + minute;

    return h->open[i / 8] >> i % 8 & 1;
}
