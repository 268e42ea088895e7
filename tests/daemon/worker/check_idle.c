/* check_idle.c - when a worker may work: hours, and nobody at the machine */
#include "config.h"

#include "radd/hours.h"
#include "radd/idle.h"

#include "tests/unit.h"

#include <math.h>

enum { SUN, MON, TUE, WED, THU, FRI, SAT };

static const struct {
    const char *text;
    int day, minute;
    bool open;
} times[] = {
    { "", WED, 0, true },
    { "9-17", MON, 9 * 60, true },
    { "9-17", MON, 17 * 60, false },
    { "9-17", SUN, 16 * 60 + 59, true },
    { "19:30-07:00", TUE, 19 * 60 + 29, false },
    { "19:30-07:00", TUE, 19 * 60 + 30, true },
    { "19:30-07:00", TUE, 6 * 60 + 59, true },
    { "fri 22-6", SAT, 5 * 60, true }, /* of Friday night */
    { "fri 22-6", FRI, 5 * 60, false },
    { "sat 22-6", SUN, 60, true }, /* over the week's end */
    { "mon-fri 19:00-07:00, sat, sun", SAT, 12 * 60, true },
    { "mon-fri 19:00-07:00, sat, sun", WED, 12 * 60, false },
    { "mon-fri 19:00-07:00, sat, sun", MON, 0, false },
    { "mon-fri 19:00-07:00, sat, sun", SUN, 23 * 60 + 59, true },
    { "Fri-Mon 0-24", SUN, 0, true }, /* around the week's end */
    { "Fri-Mon 0-24", TUE, 0, false },
    { "  sun  0-24 ", SUN, 23 * 60 + 59, true },
    { "sun 0-24", MON, 0, false },
};

LOOP_TEST(hours_are_open_as_they_say, N_ELEM(times))
{
    struct hours h;

    ck_assert_int_eq(hours_parse(times[_i].text, &h, NULL), 0);
    ck_assert_int_eq(hours_open(&h, times[_i].day, times[_i].minute),
                     times[_i].open);
}

static const char *const no_times[] = {
    "always",     "9",      "9-",     "-9",       "9-25",      "24:01-25",
    "9:60-10",    "mon-",   ",",      "9-17,",    "mon tue",   "9-9",
    "9-17 18-19", "monday", "009-10", "9:1:1-10", "xmon 9-10",
};

LOOP_TEST(what_are_no_hours_is_refused, N_ELEM(no_times))
{
    struct hours h;

    ck_assert_int_eq(hours_parse(no_times[_i], &h, NULL), RAD_EUSAGE);
}

TEST(time_of_what_gives_way_is_not_counted)
{
    const char *stat = "cpu  1000 99999 500 7 8 9 10 0 0 0\ncpu0 1 2 3\n";

    ck_assert_double_eq_tol(idle_used(stat, 100), 15, 1e-9);
    ck_assert(idle_used("", 100) < 0);
    ck_assert(idle_used("intr 1 2 3", 100) < 0);
}

TEST(a_terminal_in_use_is_somebody)
{
    struct idle i = { 0 };
    uint64_t t = 1000000;

    ck_assert(!idle_judge(&i, t, 0, INFINITY));
    ck_assert(!idle_judge(&i, t += 5000, 0, IDLE_QUIET_S + 1));
    ck_assert(idle_judge(&i, t += 5000, 0, 2));
    ck_assert(idle_judge(&i, t += 1000 * IDLE_QUIET_S - 3000, 0, INFINITY));
    ck_assert(!idle_judge(&i, t += 3000, 0, INFINITY));
}

TEST(at_first_a_terminal_that_was_just_left_counts)
{
    struct idle i = { 0 };

    ck_assert(idle_judge(&i, 5, 0, 60)); /* the machine has just booted */
}

TEST(a_busy_processor_is_somebody)
{
    struct idle i = { 0 };
    uint64_t t = 1000000;
    double used = 1e6;

    ck_assert(
        !idle_judge(&i, t, used, INFINITY)); /* since boot: says nothing */
    ck_assert(!idle_judge(&i, t += 5000, used += 2, INFINITY));
    ck_assert(idle_judge(&i, t += 5000, used += 3, INFINITY));
    for (int k = 0; k < 59; k++)
        ck_assert(idle_judge(&i, t += 5000, used += 1, INFINITY));
    ck_assert(!idle_judge(&i, t += 5000, used += 1, INFINITY));
    /* nor does the first figure after one that could not be read */
    ck_assert(!idle_judge(&i, t += 5000, -1, INFINITY));
    ck_assert(!idle_judge(&i, t += 5000, used += 2, INFINITY));
    ck_assert(idle_judge(&i, t += 5000, used += 3, INFINITY));
}
