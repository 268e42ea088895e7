/* steps.h - an input as a row of steps, for targets that are a session
 *
 * A step is a byte: its low two bits say who acts, the others what happens;
 * where that is that somebody speaks, two bytes with a length (the first is the
 * higher) and so many bytes follow, or what is left.  Time goes on with each.
 */
#ifndef RADD_TESTS_FUZZ_STEPS_H
#define RADD_TESTS_FUZZ_STEPS_H

#include "proto/message.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum step_what { STEP_BYTES, STEP_LOSE, STEP_TICK };

struct step {
    enum step_what what;
    unsigned who;     /* 0 to 3 */
    uint64_t ms;      /* since the step before */
    const uint8_t *p; /* the bytes, for STEP_BYTES */
    size_t n;
};

/* Take the step at *at, which goes on to the next; false: there is none. */
static inline bool
step_next(struct step *s, const uint8_t *data, size_t size, size_t *at)
{
    unsigned what;

    if (*at >= size)
        return false;
    what = data[*at] >> 2;
    *s = (struct step){ .what = what == 63   ? STEP_LOSE
                                : what >= 61 ? STEP_TICK
                                             : STEP_BYTES,
                        .who = data[*at] & 3,
                        .p = data,
                        .ms = what == 61 ? 20000 : 50 };
    ++*at;
    if (s->what != STEP_BYTES || size - *at < 2)
        return true;
    s->n = (size_t)data[*at] << 8 | data[*at + 1];
    *at += 2;
    if (s->n > size - *at)
        s->n = size - *at;
    s->p = data + *at;
    *at += s->n;
    return true;
}

/* With RADD_FUZZ_SAY in the environment targets say what happens, so that one
 * sees how far an input gets. */
static inline void
steps_say(unsigned who, const char *what, const char *name)
{
    if (getenv("RADD_FUZZ_SAY"))
        printf("%u %s %s\n", who, what, name);
}

/* For their environments: half of all files are here, and nothing is random. */
static inline bool
steps_has_file(void *arg, const uint8_t hash[MSG_HASH])
{
    (void)arg;
    return hash[0] & 1;
}

static inline void
steps_no_random(void *arg, void *buf, size_t n)
{
    (void)arg;
    memset(buf, 7, n);
}

#endif
