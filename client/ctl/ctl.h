/* ctl.h - what radctl's commands share
 *
 * A command is a function in the table of radctl.c.  One that asks the
 * coordinator gets an open link.  Each prints its result on standard output and
 * returns 0, or a negative code with *c->err set.
 * Private to radctl's own files.
 * Thread: one. */
#ifndef RADD_CLIENT_CTL_H
#define RADD_CLIENT_CTL_H

#include "base/files.h"
#include "link/link.h"
#include "net/key/keyorder.h"
#include "show/show.h"

#include <jansson.h>

struct ctl {
    const struct ctl_command *command;
    const char *arg; /* the command's argument; NULL: it takes none */
    char **args;     /* all arguments, if it takes several; nargs of them */
    int nargs;
    const char *name;        /* a second argument: a key's name, a number */
    uint32_t given;          /* a bit for each option (radctl.c) */
    const char *coordinator; /* --coordinator */
    const char *key;         /* --key: the key file */
    json_t *problems;        /* found by `check`, for --json */
    const char *keys;        /* --keys: the file that `key` edits */
    const char *expires;     /* --expires */
    const char *user;        /* --user: whose limits, jobs or keys are shown */
    const char *state;       /* --state: only rows of this state */
    int limit;               /* --limit: rows of a list; 0: all */
    bool all;                /* --all: cancel or delete all jobs of a user */
    const char *output;
    const char *folder;                 /* --output of enroll */
    const char *tone, *exposure, *bits; /* as given; NULL: not asked for */
    const char *false_colour;           /* its scale; NULL: not asked for */
    struct show show;        /* how a fetched .png is shown */
    int priority;            /* of `priority` */
    struct key_order order;  /* of `key` */
    int frame;               /* its number; -1: none given */
    bool plane;              /* --plane: fetch one plane by itself */
    bool json;
    enum msg_role role; /* that the coordinator has granted */
    bool local;         /* the coordinator is on this machine */
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
    const char *arg; /* its name in the help; NULL: none */
    const char *help;
    /* Are arguments and options valid together?  Called before there is a
     * connection; NULL: there is nothing to check. */
    int (*check)(struct ctl *c);
    int (*run)(struct ctl *c);
    int number; /* the message or query that it sends */
};

/* --- requests (ctl.c) --- */

/* Connect to c->to in the role with most rights that is granted. */
int ctl_connect(struct ctl *c);
/* Send m and wait for its ANSWER, valid until the next request.  A FAILED
 * becomes the error. */
int ctl_ask(struct ctl *c, struct msg *m, const struct msg **answer);
/* Send a QUERY; text may be NULL. */
int ctl_query(struct ctl *c, int what, const char *text,
              const struct msg **answer);
/* Parse an ANSWER as JSON; NULL with *c->err set. */
json_t *ctl_parse(struct ctl *c, const struct msg *answer);
/* Find the job of c->arg, a whole id or the beginning of that of a job which
 * the coordinator knows. */
int ctl_find_job(struct ctl *c, uint8_t job[MSG_JOB]);
/* Call fn with each of c->args as c->arg.  A failure is printed, and the others
 * go on.  Returns the code of the first failure. */
int ctl_each(struct ctl *c, int (*fn)(struct ctl *c));
/* End of a command that has no answer to print; returns 0. */
int ctl_done(const struct ctl *c);

/* --- commands --- */

/* ctl_list.c */
int ctl_run_query(struct ctl *c);
int ctl_run_list(struct ctl *c); /* jobs, workers */
/* Are --state and --user valid for the list? */
int ctl_check_list(struct ctl *c);
/* Get all rows that --user, --state and --limit select, the newest jobs first.
 */
int ctl_rows(struct ctl *c, const struct msg_page *ask, json_t **rows);
/* Remove from a list the rows that these options do not select.  user: the
 * member that --user is compared with, or NULL. */
void ctl_filter(const struct ctl *c, json_t *rows, const char *user);
int ctl_run_limits(struct ctl *c);

/* ctl_enroll.c */
int ctl_check_enroll(struct ctl *c);
int ctl_run_enroll(struct ctl *c);

/* ctl_top.c: the whole screen */
int ctl_check_top(struct ctl *c);
int ctl_run_top(struct ctl *c);

/* ctl_words.c: print an answer for people; --json prints its members instead.
 */
void ctl_tell_status(FILE *to, const json_t *status);
void ctl_tell_job(FILE *to, const json_t *job);
/* Seconds as text, rounded down from a minute on: "5 s", "12 min", "3 h 20
 * min", "4 days 2 h". */
enum { CTL_SPAN = 40 };
const char *ctl_span(char text[CTL_SPAN], double s);

/* ctl_job.c */
int ctl_check_job(struct ctl *c);
int ctl_run_job(struct ctl *c); /* cancel, pause, resume, delete */
int ctl_check_priority(struct ctl *c);
int ctl_run_priority(struct ctl *c);
int ctl_run_job_report(struct ctl *c); /* job */

/* ctl_fetch.c */
/* Get a whole file of a job, each piece within wait_ms; the caller frees its
 * bytes. */
int ctl_fetch_file(struct ctl *c, const uint8_t job[MSG_JOB], int frame,
                   enum msg_what what, int wait_ms, struct rad_memory_out *f);
int ctl_check_fetch(struct ctl *c);
int ctl_run_fetch(struct ctl *c);

/* ctl_admin.c */
int ctl_run_worker(struct ctl *c); /* drain, undrain, forget */
int ctl_check_key(struct ctl *c);
int ctl_run_key(struct ctl *c);
int ctl_run_check(struct ctl *c);

#endif
