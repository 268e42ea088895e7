/* event.h - virtual time
 *
 * Events of one simulated cluster, by time [us] and, within a microsecond, in
 * the order in which they were made.
 * Thread: one. */
#ifndef SIM_EVENT_H
#define SIM_EVENT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct event {
    uint64_t at_us, sequence;
    void (*fn)(void *arg, struct event *e);
    int host;
    uint64_t n;     /* what fn takes it for */
    uint8_t *bytes; /* freed afterwards */
    size_t len;
};

struct events {
    struct event *heap;
    size_t n, cap;
    uint64_t sequence, now_us;
};

void events_release(struct events *v);

/* Have e->fn called; memory that is out ends the program. */
void events_add(struct events *v, const struct event *e);

/* Deal with the next one; false: there is none. */
bool events_step(struct events *v, void *arg);

/* Of memory, or end the program. */
void *sim_alloc(size_t n);

#endif
