/* program_loop.h - radsubmit's event loop, and signals in it
 *
 * Signals are counted and stop the loop, whose user then ends what is under
 * way.
 * Thread: the main one. */
#ifndef RADD_CLIENT_PROGRAM_LOOP_H
#define RADD_CLIENT_PROGRAM_LOOP_H

#include "base/error.h"

#include <stdbool.h>
#include <uv.h>

struct program_loop {
    uv_loop_t uv;
    uv_work_t first_work; /* see link_loop_init() */
    uv_signal_t signals[3];
    bool watched;   /* uv and signals are in use */
    int interrupts; /* so far; 2 end the program at once */
    int freed[3];   /* signals that are not caught for a while; 0: none */
};

/* Make the loop, and count SIGINT once, SIGTERM and SIGHUP (unless that is
 * ignored) twice. */
int program_loop_init(struct program_loop *l, struct rad_error *err);
void program_loop_release(struct program_loop *l);

/* Before and after a file is written (path NULL: standard output): signals end
 * the program meanwhile if writing may wait for a reader.  Pairs do not nest. */
void program_loop_free_signals(struct program_loop *l, const char *path);
/* The same before a message of at most a line, if standard error has no room
 * for it now. */
void program_loop_free_for_message(struct program_loop *l);
void program_loop_catch_signals(struct program_loop *l);

#endif
