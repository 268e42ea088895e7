/* check_states.c - the states of jobs, their frames, their units, attempts at
 * these, workers' parts in a job and jobs at a worker, and what may follow what
 */
#include "config.h"

#include "jobs/attempt.h"
#include "jobs/job.h"
#include "jobs/part.h"
#include "jobs/unit.h"
#include "machine/steps.h"
#include "worker/wjob.h"
#include "tests/unit.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

/* A table, how its states are taken, and its steps as in the drawing at the
 * head of its file, which these lists say again on purpose. */
struct machine {
    const struct steps *table;
    int (*take)(int from, int to);
    const char *steps[STEPS_STATES]; /* "working: parked blocked" */
};

static int
take_attempt(int from, int to)
{
    struct job_attempt attempt = { .state = (enum attempt_state)from };

    attempt_step(&attempt, (enum attempt_state)to);
    return (int)attempt.state;
}

static int
take_unit(int from, int to)
{
    struct job_unit u = { .state = (enum unit_state)from };

    unit_step(&u, (enum unit_state)to);
    return (int)u.state;
}

static int
take_part(int from, int to)
{
    struct job_part part = { .state = (enum part_state)from };

    part_step(&part, (enum part_state)to);
    return (int)part.state;
}

static int
take_frame(int from, int to)
{
    struct job_frame f = { .state = (enum frame_state)from };

    frame_step(&f, (enum frame_state)to);
    return (int)f.state;
}

static int
take_state(int from, int to)
{
    struct job job = { .state = (enum job_state)from };

    life_step(&job, (enum job_state)to);
    return (int)job.state;
}

static int
take_place(int from, int to)
{
    struct job job = { .place = (enum job_place)from };

    life_move(&job, (enum job_place)to);
    return (int)job.place;
}

static int
take_wjob(int from, int to)
{
    struct wjob job = { .state = (enum wjob_state)from };

    wjob_step(&job, (enum wjob_state)to);
    return (int)job.state;
}

static const struct machine machines[] = {
    { &attempt_steps,
      take_attempt,
      { "over: working", "working: parked blocked yielding delivered over",
        "parked: working yielding delivered over",
        "blocked: working yielding delivered over", "yielding: delivered over",
        "delivered: over" } },
    { &unit_steps,
      take_unit,
      { "waiting: out done", "suspect: out", "out: waiting suspect done",
        "done:" } },
    { &part_steps,
      take_part,
      { "gone: loading", "no-room: gone", "excluded:",
        "loading: ready gone no-room excluded", "ready: gone excluded" } },
    { &frame_steps,
      take_frame,
      { "open: writing written fetched", "writing: written", "written: fetched",
        "fetched:" } },
    { &life_states,
      take_state,
      { "waiting: running paused done failed cancelled",
        "running: paused done failed cancelled",
        "paused: waiting running done failed cancelled",
        "done:", "failed:", "cancelled:" } },
    { &life_places,
      take_place,
      { "arriving: opening open filed", "opening: no-room open kept",
        "no-room: open kept", "open: kept", "kept: filed", "filed:" } },
    { &wjob_steps,
      take_wjob,
      { "fetching: no-room loading idle", "no-room: fetching idle",
        "loading: ready idle", "ready: idle", "idle: fetching" } },
};

/* Does a line of steps begin with that state, and have the other? */
static bool
says(const char *line, const char *from, const char *to)
{
    size_t n = strlen(from);
    char words[128], word[32];

    if (strncmp(line, from, n) != 0 || line[n] != ':')
        return false;
    snprintf(words, sizeof words, "%s ", line + n + 1);
    snprintf(word, sizeof word, " %s ", to);
    return strstr(words, word) != NULL;
}

static bool
follows(const struct machine *m, int from, int to)
{
    for (int i = 0; i < (int)m->table->n; i++)
        if (says(m->steps[i], m->table->state[from].name,
                 m->table->state[to].name))
            return true;
    return false;
}

/* The signal that ends a process which takes the step; 0: it lives. */
static int
signal_of_step(const struct machine *m, int from, int to)
{
    int status;
    pid_t pid = fork();

    ck_assert_int_ge(pid, 0);
    if (pid == 0) {
        setrlimit(RLIMIT_CORE, &(struct rlimit){ 0, 0 });
        if (!freopen("/dev/null", "w", stderr)) /* what assert() says */
            _exit(1);
        _exit(m->take(from, to) == to ? 0 : 2);
    }
    ck_assert_int_eq(waitpid(pid, &status, 0), pid);
    if (WIFSIGNALED(status))
        return WTERMSIG(status);
    ck_assert_int_eq(WEXITSTATUS(status), 0);
    return 0;
}

LOOP_TEST(the_steps_of_the_drawings_and_no_others_can_be_taken,
          N_ELEM(machines))
{
    const struct machine *m = &machines[_i];

    for (int from = 0; from < (int)m->table->n; from++)
        for (int to = 0; to < (int)m->table->n; to++) {
            bool may = follows(m, from, to);

            ck_assert_msg(
                steps_permit(m->table, (unsigned)from, (unsigned)to) == may,
                "%s to %s", m->table->state[from].name,
                m->table->state[to].name);
            ck_assert_msg(signal_of_step(m, from, to) == (may ? 0 : SIGABRT),
                          "%s to %s", m->table->state[from].name,
                          m->table->state[to].name);
        }
}

/* A word that is misspelt in the lists above would permit nothing. */
LOOP_TEST(the_drawings_name_states_that_there_are, N_ELEM(machines))
{
    const struct machine *m = &machines[_i];
    size_t n = 0, words = 0;

    for (int i = 0; i < (int)m->table->n; i++)
        for (const char *s = m->steps[i]; *s; s++)
            words += *s == ' ';
    for (int from = 0; from < (int)m->table->n; from++)
        for (int to = 0; to < (int)m->table->n; to++)
            n += follows(m, from, to);
    ck_assert_uint_eq(n, words);
}

LOOP_TEST(an_attempt_works_or_waits_or_neither, ATTEMPT_STATES)
{
    static const struct {
        bool works, waits;
    } is[ATTEMPT_STATES] = {
        [ATTEMPT_WORKING] = { true, false },
        [ATTEMPT_PARKED] = { false, true },
        [ATTEMPT_BLOCKED] = { false, true },
        [ATTEMPT_YIELDING] = { false, true },
        [ATTEMPT_DELIVERED] = { false, false },
    };
    const struct job_attempt attempt = { .state = (enum attempt_state)_i };

    ck_assert_int_eq(attempt_works(&attempt), is[_i].works);
    ck_assert_int_eq(attempt_waits(&attempt), is[_i].waits);
}

/* Units 0, 1 and 2 have one, two and three attempts; none is ended on the way;
 * or each when it was met; or then all of its unit. */
LOOP_TEST(a_walk_meets_each_attempt_that_is_not_over_once, 3)
{
    static const int met[] = { 6, 6, 3 };
    struct job_unit unit[3] = { { 0 } };
    struct job job = { .units = unit, .nunits = 3 };
    struct attempt_walk walk;
    struct job_attempt *attempt;
    bool seen[3][3] = { { false } };
    int n = 0;

    for (uint32_t u = 0; u < 3; u++)
        for (uint32_t k = 0; k <= u; k++)
            attempt_add(&job, u)->number = k;
    for (walk = attempt_walk(&job); (attempt = attempt_next(&job, &walk));
         n++) {
        uint32_t u = attempt->unit;

        ck_assert(!seen[u][attempt->number]);
        seen[u][attempt->number] = true;
        if (_i == 1)
            attempt_remove(&job, attempt);
        while (_i == 2 && unit[u].nattempts > 0)
            attempt_remove(&job, &unit[u].attempts[0]);
    }
    ck_assert_int_eq(n, met[_i]);
    ck_assert_uint_eq(job.nout, _i == 0 ? 3 : 0);
    for (int u = 0; u < 3; u++)
        free(unit[u].attempts);
    free(job.out);
}
