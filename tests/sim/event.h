/* event.h - virtual time
 *
 * The events of a simulated cluster, ordered by time; events of the same time
 * keep the order in which they were added.  Time has the unit of the user:
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
    int node, k; /* node, k, n and len mean what fn wants */
    uint64_t n;
    uint8_t *bytes; /* freed after the event */
    size_t len;
};

struct events {
    struct event *heap;
    size_t n, cap;
    uint64_t sequence;
};

void events_release(struct events *v);

/* Give an event a copy of bytes. */
void event_take(struct event *e, const void *bytes, size_t len);

/* Add a copy of *e, whose fn will be called.  Ends the program if memory is
 * out.  The returned event may be changed until the next call. */
struct event *events_add(struct events *v, const struct event *e);

/* Advance *now to the next event, and call its fn with arg; false: there is
 * none. */
bool events_step(struct events *v, uint64_t *now, void *arg);

/* Allocate memory, or end the program. */
void *sim_alloc(size_t n);

#endif
