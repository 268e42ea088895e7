/* children.h - the processes that render, one for each job
 *
 * A child is this program run again (render.h) with one end of a socket pair,
 * its link; the other end is a connection of the shell.  When a child has ended
 * and all that it sent was delivered, ended() is called once.
 * Thread: the loop's. */
#ifndef RADD_DAEMON_CHILDREN_H
#define RADD_DAEMON_CHILDREN_H

#include "shell/shell.h"

#define CHILDREN_PATH_MAX 4096
#define CHILDREN_MAX_ENV  9

struct children_conf {
    const char *files_dir; /* of the store; may be relative */
    int threads;
    int memory_mib; /* most that a child may use; 0: no limit */
    int nice;       /* 0..19: how much a child gives way to others */
    int pixel_s;    /* most processor time of a pixel [s]; 0: any */
    bool sandboxed; /* start no child where the kernel lacks seccomp */
};

/* How a process ended; both are -1 if its link ended first. */
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
    char files_dir[CHILDREN_PATH_MAX]; /* conf's, made absolute */
    child_ended_fn *ended;
    void *arg;
    struct child *list;
};

void children_init(struct children *all, struct shell *shell,
                   const struct children_conf *conf, child_ended_fn *ended,
                   void *arg);

/* Start a child as connection id.  memory_mib: the job's limit, 0 for none; the
 * lower of it and conf.memory_mib holds.  If the start fails ended() is called
 * later, as at any other end. */
void children_spawn(struct children *all, uint64_t id, uint32_t memory_mib);

/* End the child; ended() is not called. */
void children_kill(struct children *all, uint64_t id);

/* The shell tells that connection id has ended.  False: it is no child's. */
bool children_closed(struct children *all, uint64_t id, const char *why);

/* Is a child to be held, that is not read from, if it is held or not now? */
typedef bool child_hold_fn(void *arg, uint64_t id, bool held);
/* Hold each child that has a link, or go on reading from it, as hold() says. */
void children_hold(struct children *all, child_hold_fn *hold);

/* Pick from the environment `from` the variables that a child gets. */
void children_environment(char *const *from, char *to[CHILDREN_MAX_ENV + 1]);

/* Kill all children; ended() is not called. */
void children_kill_all(struct children *all);

#endif
