/* children.h - the processes that render, one for each job
 *
 * A child is this program run again (render.h) with one end of a socket pair;
 * the other end is a connection of the shell.  When a child has ended and all
 * that it sent was delivered, its owner is told once.
 * Thread: the loop's. */
#ifndef RADD_DAEMON_CHILDREN_H
#define RADD_DAEMON_CHILDREN_H

#include "shell/shell.h"

#include <uv.h>

#define CHILDREN_PATH_MAX 4096
#define CHILDREN_MAX_ENV  9

struct children_conf {
    const char *files_dir; /* of the store */
    int threads;
    int memory_mib; /* most that a child may use; 0: no limit */
    int nice;       /* 0..19: how much a child gives way to others */
    int pixel_s;    /* most processor time of a pixel [s]; 0: any */
    bool sandboxed; /* must be: without seccomp none is started */
};

/* How a process ended; both -1 where that is not why it is gone. */
struct child_end {
    int status, signal;
};

/* text: "killed by signal 11", "exit status 70" */
typedef void child_ended_fn(void *arg, uint64_t id, struct child_end how,
                            const char *text);

struct child;
struct children {
    struct shell *shell;
    struct children_conf conf;
    char files_dir[CHILDREN_PATH_MAX]; /* conf's, from the root */
    child_ended_fn *ended;
    void *arg;
    struct child *list;
    bool held;
};

void children_init(struct children *all, struct shell *shell,
                   const struct children_conf *conf, child_ended_fn *ended,
                   void *arg);

/* Start one as connection id, whose job wants no more than memory_mib (0: any);
 * the lower limit holds.  If that fails, ended() is called later, as for every
 * other end. */
void children_spawn(struct children *all, uint64_t id, uint32_t memory_mib);

/* End one; ended() will not be called. */
void children_kill(struct children *all, uint64_t id);

/* The shell says that connection id is gone.  False: it is no child's. */
bool children_closed(struct children *all, uint64_t id, const char *why);

/* Read nothing from any of them, or go on. */
void children_hold(struct children *all, bool held);

/* What a child has of the environment at `from`. */
void children_environment(char *const *from, char *to[CHILDREN_MAX_ENV + 1]);

/* End all, at once. */
void children_kill_all(struct children *all);

#endif
