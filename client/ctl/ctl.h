/* ctl.h - what radctl's commands share
 *
 * A command is a function of the table in radctl.c.  One that asks the
 * coordinator finds a link that is open; each prints what it found, on standard
 * output, and returns 0 or a negative code with *c->err filled.
 * Private to radctl's own files.  Thread: one.  */
#ifndef RADD_CLIENT_CTL_H
#define RADD_CLIENT_CTL_H

#include "link/link.h"
#include "show/show.h"

#include <jansson.h>

struct ctl {
    const struct ctl_command *command;
    const char *arg; /* the command's, NULL where it has none */
    char **args;     /* all words that are like arg, nargs of them */
    int nargs;
    const char *name;        /* the word behind it: a key's, a number */
    const char *coordinator; /* --coordinator */
    const char *key;         /* --key: what to show the coordinator */
    json_t *problems;        /* of check, as JSON */
    const char *keys;        /* --keys: the file that `key` edits */
    const char *expires;     /* --expires */
    const char *user;        /* --user: whose limits, jobs or keys */
    const char *state;       /* --state: of jobs, workers or keys */
    int limit;               /* --limit: rows of a list; 0: all */
    bool all;                /* --all: cancel or delete all jobs of a user */
    const char *output;
    const char *folder;                 /* --output: of enroll */
    const char *tone, *exposure, *bits; /* as asked for; NULL: not */
    const char *false_colour;           /* its scale; NULL: not asked for */
    struct show show;        /* of a .png that is fetched */
    int frame;               /* -1: not named */
    bool json;
    enum msg_role role; /* what the coordinator let us be */
    bool local;         /* it is on this machine */
    uv_loop_t loop;
    int wake;
    struct target to;
    struct link *link;
    uint32_t request;
    uint64_t start_ms;
    struct rad_error *err;
};

struct ctl_command {
    const char *name;
    const char *arg; /* what it is called in the help; NULL: none */
    const char *help;
    int (*run)(struct ctl *c);
    int number; /* message or query that it sends */
};

/* Connect to c->to, as the most that the coordinator lets us be (radctl.c). */
int ctl_connect(struct ctl *c);

/* --- asking (ctl.c) --- */

/* Send m and wait for its answer of that type, valid until the next one; a
 * FAILED is the error. */
int ctl_ask(struct ctl *c, struct msg *m, uint16_t type,
            const struct msg **answer);
/* A QUERY, text NULL for none. */
int ctl_query(struct ctl *c, int what, const char *text,
              const struct msg **answer);
/* An ANSWER as JSON; NULL: the error is there. */
json_t *ctl_parse(struct ctl *c, const struct msg *answer);
/* The id that c->arg stands for: all of its digits, or the first ones of a job
 * that the coordinator knows. */
int ctl_find_job(struct ctl *c, uint8_t job[MSG_JOB]);
/* Do it for each of c->args, which c->arg is then; what fails is told, and the
 * others go on.  The first failure's code. */
int ctl_each(struct ctl *c, int (*fn)(struct ctl *c));
/* A command that answers nothing is done; 0. */
int ctl_done(const struct ctl *c);

/* --- commands --- */

/* ctl_list.c */
int ctl_run_query(struct ctl *c);
int ctl_run_list(struct ctl *c); /* jobs, workers */
/* Can these options be those of such a list? */
int ctl_check_list(const struct ctl *c);
/* All rows that --user, --state and --limit leave, jobs from the newest on. */
int ctl_rows(struct ctl *c, const struct msg_page *ask, json_t **rows);
/* Take out of a list what these options leave out; user: the member that is
 * compared, or NULL. */
void ctl_filter(const struct ctl *c, json_t *rows, const char *user);
int ctl_run_limits(struct ctl *c);

/* ctl_enroll.c */
int ctl_run_enroll(struct ctl *c);

/* ctl_top.c: the full screen */
int ctl_run_top(struct ctl *c);

/* ctl_words.c: an answer as people read it; as JSON it has all members, by
 * their names. */
void ctl_tell_status(FILE *to, const json_t *status);
void ctl_tell_job(FILE *to, const json_t *job);
/* So many seconds, rounded down from a minute on: "5 s", "12 min",
 * "3 h 20 min", "4 days 2 h". */
enum { CTL_SPAN = 40 };
const char *ctl_span(char text[CTL_SPAN], double s);

/* ctl_job.c */
int ctl_run_job(struct ctl *c);        /* cancel, pause, resume, delete */
int ctl_run_priority(struct ctl *c);
int ctl_run_job_report(struct ctl *c); /* job */
int ctl_run_fetch(struct ctl *c);

/* ctl_admin.c */
int ctl_run_worker(struct ctl *c); /* drain, undrain, forget */
int ctl_run_key(struct ctl *c);
int ctl_run_check(struct ctl *c);

#endif
