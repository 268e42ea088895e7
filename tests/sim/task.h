/* task.h - what a simulated child works at: a pass of a strict unit, or a
 * window, by a real team
 *
 * A member of the team is a fibre.  Where work is to take virtual time, a
 * callback of the team yields, and messages may come until the fibre runs on.
 * Who lets several members work at once must have their uv_cond_wait() yield,
 * too.
 * What is done at each step is what the real pool does (daemon/pool/pool*.c).
 * Thread: one. */
#ifndef SIM_TASK_H
#define SIM_TASK_H

#include "strict/strict.h"

struct task {
    struct msg_unit unit;     /* with the rows of the whole unit */
    struct strict_pass *pass; /* NULL: the task is a window */
    enum team_mode mode;
    struct team *team; /* NULL: there is no task */
    struct fibre **fibre; /* of its members so far, */
    int nfibres, members; /* and how many there are of these; that work still */
    int row0;              /* the sampler's row that is the unit's first */
    uint32_t nrows, nsent; /* rows of the unit that are made; that are sent */
    bool over;             /* all members have left */
    bool dropped;          /* the task was given up: nothing counts */
};

/* Begin the pass; or the window *u, if it is NULL; with one member.  spec: the
 * callbacks, the rows' only for TRUTH, the sampler of the whole frame, and most
 * members at once (0: one). */
void task_begin(struct task *t, const struct team_spec *spec,
                struct strict_pass *pass, const struct msg_unit *u);

/* Another member: fibre_run() lets it work until it yields or leaves. */
struct fibre *task_join(struct task *t);

/* Let the first member work until it yields or the team is over. */
void task_run(struct task *t);

/* Called by the first member's callbacks: stop until the next task_run(). */
void task_yield(struct task *t);

/* Carry out what the machine asks of the pass, and report progress. */
void task_look(const struct task *t, struct strict *s);

/* The task is over: tell the machine.  True: its unit is done, and *total is
 * what that cost; *spent is the cost of this task, but for its primary rays. */
bool task_end(struct task *t, struct strict *s, struct msg_counts *spent,
              struct msg_counts *total);

/* Give the task up, if there is one. */
void task_drop(struct task *t, struct strict *s);

void task_release(struct task *t);

/* Give the machine a message about lines; false: it is no such message. */
bool task_message(struct strict *s, const struct msg *m);

#endif
