/* event.h - virtual time
 *
 * Events of one simulated cluster, by time and, of the same time, in the order
 * in which they were made.  Times are of the unit that the cluster counts in:
 * microseconds in bench/sim, milliseconds here.
 * Thread: one. */
#ifndef SIM_EVENT_H
#define SIM_EVENT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct event {
    uint64_t at, sequence;
    void (*fn)(void *arg, struct event *e);
    int node, k; /* these, n and len are what fn takes them for */
    uint64_t n;
    uint8_t *bytes; /* freed afterwards */
    size_t len;
};

struct events {
    struct event *heap;
    size_t n, cap;
    uint64_t sequence;
};

void events_release(struct events *v);

/* Have e->fn called; memory that is out ends the program.  What is returned may
 * be filled in until the next call. */
struct event *events_add(struct events *v, const struct event *e);

/* Call the next one with this argument, when *now is its time; false: there is
 * none. */
bool events_step(struct events *v, uint64_t *now, void *arg);

/* Of memory, or end the program. */
void *sim_alloc(size_t n);

#endif
