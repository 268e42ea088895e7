/* radctl.c - look at and steer a running cluster; see radctl(1)
 *
 * This file has the command line and the table of commands, ctl_*.c have the
 * commands themselves. */
#include "config.h"

#include "ctl/ctl.h"
#include "common/option.h"
#include "common/tell.h"
#include "base/help.h"
#include "base/list.h"
#include "base/output.h"
#include "ground/memory.h"

#include <errno.h>
#include <limits.h>
#include <poll.h>
#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <sysexits.h>
#include <unistd.h>

static const struct ctl_command commands[] = {
    { "status", NULL, "coordinator, workers and jobs in short", NULL,
      ctl_run_query, MSG_QUERY_STATUS },
    { "workers", NULL, "one line a worker", ctl_check_list, ctl_run_list,
      MSG_QUERY_WORKERS },
    { "jobs", NULL, "one line a job", ctl_check_list, ctl_run_list,
      MSG_QUERY_JOBS },
    { "top", NULL, "workers and jobs on the full screen", ctl_check_top,
      ctl_run_top, 0 },
    { "limits", NULL, "your limits, and what you use of them", NULL,
      ctl_run_limits, MSG_QUERY_LIMITS },
    { "job", "ID", "all about a job", NULL, ctl_run_job_report, MSG_QUERY_JOB },
    { "cancel", "ID...", "end jobs", ctl_check_job, ctl_run_job, MSG_CANCEL },
    { "delete", "ID...", "forget jobs that are over, with their pictures",
      ctl_check_job, ctl_run_job, MSG_DELETE },
    { "pause", "ID...", "let jobs rest, at once", NULL, ctl_run_job,
      MSG_PAUSE },
    { "resume", "ID...", "go on with paused jobs", NULL, ctl_run_job,
      MSG_RESUME },
    { "priority", "ID N", "give a job another priority", ctl_check_priority,
      ctl_run_priority, MSG_PRIORITY },
    { "fetch", "ID...", "get a finished picture, of planes put together",
      ctl_check_fetch, ctl_run_fetch, 0 },
    { "drain", "WORKER...", "give workers no more work", NULL, ctl_run_worker,
      MSG_DRAIN },
    { "undrain", "WORKER...", "give them work again", NULL, ctl_run_worker,
      MSG_UNDRAIN },
    { "forget", "WORKER...", "list no more workers that are gone", NULL,
      ctl_run_worker, MSG_FORGET },
    { "key", "add NAME | retire NAME | list", "of hosts and users",
      ctl_check_key, ctl_run_key, MSG_KEY },
    { "enroll", "WORKER...", "make each host's radd.conf and key",
      ctl_check_enroll, ctl_run_enroll, 0 },
    { "check", "STATE-DIR", "is a coordinator's state folder sound?", NULL,
      ctl_run_check, 0 },
};

enum { NCOMMANDS = sizeof commands / sizeof commands[0] };

/* May that role use the command?  A coordinator closes the connection of
 * others. */
static int
check_role(const struct ctl_command *command, enum msg_role role,
           struct rad_error *err)
{
    bool steers =
        command->run == ctl_run_job || command->run == ctl_run_priority;
    bool governs = command->run == ctl_run_worker ||
                   command->run == ctl_run_key ||
                   command->run == ctl_run_enroll;

    if (governs && role != MSG_ROLE_ADMIN)
        return rad_fail(err, RAD_EPERM,
                        "command '%s' is for administrators: use --key with "
                        "an admin's key, or root on the coordinator's machine",
                        command->name);
    if (steers && role == MSG_ROLE_OBSERVER)
        return rad_fail(err, RAD_EPERM, "command '%s' is not for observers",
                        command->name);
    return 0;
}

/* --- options --- */

/* The options; .with: the commands that they go with, with commas between;
 * NULL: all commands. */
static const struct option options[] = {
    { "--coordinator", OPTION_TEXT, offsetof(struct ctl, coordinator),
      "HOST:PORT|SOCKET", "the coordinator (this machine's)", .with = NULL },
    { "--key", OPTION_TEXT, offsetof(struct ctl, key), "FILE",
      "what to show a coordinator over the network", .with = NULL },
    { "--json", OPTION_FLAG, offsetof(struct ctl, json), NULL,
      "print answers as JSON", .with = NULL },
    { "--keys", OPTION_TEXT, offsetof(struct ctl, keys), "FILE",
      "edit this key file, not the coordinator's", .with = "key, enroll" },
    { "--expires", OPTION_TEXT, offsetof(struct ctl, expires), "DATE",
      "when a new key ends: 2027-01-31, at 00:00 UTC", .with = "key" },
    { "--user", OPTION_TEXT, offsetof(struct ctl, user), "NAME",
      "jobs, keys or limits of that user",
      .with = "jobs, limits, key, cancel, delete" },
    { "--state", OPTION_TEXT, offsetof(struct ctl, state), "STATE",
      "jobs, workers or keys in that state", .with = "jobs, workers, key" },
    { "--limit", OPTION_INT, offsetof(struct ctl, limit), "N",
      "so many rows at most; of jobs the newest", .lo = 1, .hi = INT_MAX,
      .with = "jobs, workers, key" },
    { "--all", OPTION_FLAG, offsetof(struct ctl, all), NULL,
      "cancel or delete all jobs of yours, or --user's",
      .with = "cancel, delete" },
    { "--output", OPTION_TEXT, offsetof(struct ctl, folder), "DIR",
      "where enroll makes a folder for each worker", .with = "enroll" },
    { "-o", OPTION_TEXT, offsetof(struct ctl, output), "FILE",
      "where fetch writes (standard output); %d stands for the frame's "
      "number",
      .with = "fetch" },
    { "--frame", OPTION_INT, offsetof(struct ctl, frame), "N",
      "picture of an animation to fetch, by its number (the first; all of "
      "them where FILE has a %d)",
      .lo = 0, .hi = INT_MAX, .with = "fetch" },
    { "--plane", OPTION_FLAG, offsetof(struct ctl, plane), NULL,
      "of a job that shows one plane of bands: fetch that alone",
      .with = "fetch" },
    { "--tone", OPTION_TEXT, offsetof(struct ctl, tone), SHOW_TONES,
      "how a .png shows light", .with = "fetch" },
    { "--exposure", OPTION_TEXT, offsetof(struct ctl, exposure),
      "[first,|each,]auto|+-STOPS|FACTOR", "of a .png", .with = "fetch" },
    { "--bits", OPTION_TEXT, offsetof(struct ctl, bits), SHOW_BITS,
      "of a channel of a .png", .with = "fetch" },
    { "--false-colour", OPTION_MAYBE, offsetof(struct ctl, false_colour),
      "[=SCALE][,...]", "a .png of luminance in colours, as radsubmit's",
      .with = "fetch" },
};
_Static_assert(N_ELEM(options) <= 32, "a set of them is 32 bits");

static void
help(void)
{
    char head[80];

    puts("usage: radctl [options] COMMAND [ARGUMENT]\n"
         "Look at and steer a running cluster.\n");
    for (int i = 0; i < NCOMMANDS; i++) {
        snprintf(head, sizeof head, "%s %s", commands[i].name,
                 commands[i].arg ? commands[i].arg : "");
        rad_help_row(head, commands[i].help, tell_line, stdout);
    }
    puts("");
    option_help(options, N_ELEM(options), stdout);
    rad_help_row("--help", "this text", tell_line, stdout);
    rad_help_row("--version", "the version", tell_line, stdout);
}

static int
take_option(struct ctl *c, char *argv[], int *i)
{
    const struct option *o = option_find(options, N_ELEM(options), argv[*i]);
    int used;

    if (!o)
        return rad_fail(c->err, RAD_EUSAGE,
                        "unknown option '%s'; see radctl --help", argv[*i]);
    c->given |= UINT32_C(1) << (o - options);
    used = option_take(o, c, argv + *i, c->err);
    *i += used - 1;
    return used < 0 ? used : 0;
}

/* Is the command's name one of the words of `with`? */
static bool
is_with(const char *with, const char *name)
{
    size_t n;

    for (; *with; with += n + strspn(with + n, ", ")) {
        n = strcspn(with, ",");
        if (n == strlen(name) && memcmp(with, name, n) == 0)
            return true;
    }
    return false;
}

/* Refuse options that the command has no use for. */
static int
check_options(const struct ctl *c)
{
    for (int k = 0; k < N_ELEM(options); k++)
        if (c->given & UINT32_C(1) << k && options[k].with &&
            !is_with(options[k].with, c->command->name))
            return rad_fail(c->err, RAD_EUSAGE, "%s goes with %s, not with %s",
                            options[k].name, options[k].with, c->command->name);
    return 0;
}

/* --- words --- */

static int
find_command(struct ctl *c, const char *name)
{
    for (int i = 0; i < NCOMMANDS; i++)
        if (strcmp(commands[i].name, name) == 0)
            c->command = &commands[i];
    if (c->command)
        return 0;
    return rad_fail(c->err, RAD_EUSAGE,
                    "unknown command '%s'; see radctl --help", name);
}

/* Is arg valid for the command?  An empty id is refused: it is the beginning of
 * every job's, so it could mean the only job. */
static int
check_arg(const struct ctl *c, const char *arg)
{
    const char *kind = c->command->arg;
    size_t n = strlen(arg);

    if (n == 0)
        return rad_fail(c->err, RAD_EUSAGE, "command '%s': empty %s",
                        c->command->name, kind);
    if (strncmp(kind, "ID", 2) == 0 &&
        (n > 2 * MSG_JOB || strspn(arg, "0123456789abcdefABCDEF") != n))
        return rad_fail(c->err, RAD_EUSAGE, "'%.80s' is no job's id", arg);
    if (n > MSG_MAX_NAME && strncmp(kind, "WORKER", 6) == 0)
        return rad_fail(c->err, RAD_EUSAGE,
                        "'%.80s' is no worker's name: at most %d bytes are "
                        "allowed",
                        arg, MSG_MAX_NAME);
    return 0;
}

static int
check_words(struct ctl *c)
{
    int rc;

    if (!c->command)
        return rad_fail(c->err, RAD_EUSAGE,
                        "no command given; see radctl --help");
    if ((rc = check_options(c)) < 0)
        return rc;
    if (c->command->arg && !c->arg && !c->all)
        return rad_fail(c->err, RAD_EUSAGE, "command '%s': missing %s",
                        c->command->name, c->command->arg);
    for (int i = 0; i < c->nargs; i++)
        if ((rc = check_arg(c, c->args[i])) < 0)
            return rc;
    if (c->user && strlen(c->user) > MSG_MAX_NAME)
        return rad_fail(c->err, RAD_EUSAGE, "'%.80s' is no user's name",
                        c->user);
    return c->command->check ? c->command->check(c) : 0;
}

/* Collect the command's arguments at the beginning of argv. */
static void
take_arg(struct ctl *c, char *argv[], int i)
{
    c->args = argv;
    c->args[c->nargs++] = argv[i];
    c->arg = c->args[0];
}

/* Is the next word the number of `priority`, which may begin with a minus? */
static bool
takes_number(const struct ctl *c)
{
    return c->command && c->command->run == ctl_run_priority && c->arg &&
           !c->name;
}

static bool
is_number(const char *word)
{
    return word[word[0] == '-'] >= '0' && word[word[0] == '-'] <= '9';
}

/* Take options, until "--", and arguments in any order. */
static int
take_words(struct ctl *c, int argc, char *argv[])
{
    bool ended = false; /* the options are, by "--" */
    int rc = 0;

    for (int i = 1; i < argc && rc == 0; i++) {
        if (takes_number(c) && is_number(argv[i]))
            c->name = argv[i];
        else if (!ended && strcmp(argv[i], "--") == 0)
            ended = true;
        else if (!ended && argv[i][0] == '-' && argv[i][1] != '\0')
            rc = take_option(c, argv, &i);
        else if (!c->command)
            rc = find_command(c, argv[i]);
        else if (c->command->arg && (!c->arg || strstr(c->command->arg, "...")))
            take_arg(c, argv, i);
        else if ((c->command->run == ctl_run_key && !c->name) ||
                 takes_number(c))
            c->name = argv[i];
        else
            rc = rad_fail(c->err, RAD_EUSAGE, "unexpected word '%s'", argv[i]);
    }
    return rc < 0 ? rc : check_words(c);
}

static bool
asks_for(int argc, char *argv[], const char *option)
{
    for (int i = 1; i < argc; i++)
        if (strcmp(argv[i], option) == 0)
            return true;
    return false;
}

/* --- connection --- */

/* Explain an error if no coordinator was named and none is on this machine. */
static void
say_unnamed(struct ctl *c)
{
    snprintf(c->err->where, sizeof c->err->where,
             "no coordinator is named by --coordinator, RADD_COORDINATOR or "
             "radsubmit.conf%s",
             c->command->run == ctl_run_key ? " (--keys edits a key file)"
                                            : "");
}

/* A coordinator that is gone when something is written to it is told of; a
 * program that reads the output and is gone ends radctl, as it ends others. */
static void
on_pipe(int signum)
{
    struct pollfd out = { .fd = STDOUT_FILENO };
    int number = errno;

    if (poll(&out, 1, 0) > 0 && out.revents & POLLERR) {
        signal(signum, SIG_DFL);
        raise(signum);
    }
    errno = number;
}

static int
run(struct ctl *c)
{
    struct sigaction broken = { .sa_handler = on_pipe, .sa_flags = SA_RESTART };
    bool named;
    int rc;

    if (c->keys || c->command->run == ctl_run_check) /* needs no coordinator */
        return c->command->run(c);
    rc = target_find(&c->to, c->coordinator, c->key, c->err);
    if (rc < 0)
        return rc;
    named = rc > 0;
    if (!named)
        target_default(&c->to);
    if ((rc = link_loop_init(&c->loop, NULL, c->err)) < 0)
        return rc;
    sigaction(SIGPIPE, &broken, NULL);
    c->start_ms = uv_now(&c->loop);
    rc = ctl_connect(c);
    if (rc == RAD_EUNAVAIL && !named)
        say_unnamed(c);
    if (rc == 0)
        rc = check_role(c->command, c->role, c->err);
    if (rc == 0)
        rc = c->command->run(c);
    link_close(c->link);
    uv_loop_close(&c->loop);
    return rc;
}

int
main(int argc, char *argv[])
{
    struct rad_error err = { 0 };
    struct ctl c = { .frame = -1, .err = &err };
    char text[600];
    int rc = 0;

    rad_output_guard();
    json_set_alloc_funcs(memory_need, free);
    show_init(&c.show);
    if (asks_for(argc, argv, "--help"))
        help();
    else if (asks_for(argc, argv, "--version"))
        puts("radctl (radd) " PACKAGE_VERSION);
    else if ((rc = take_words(&c, argc, argv)) == 0)
        rc = run(&c);
    if (rc >= 0)
        rc = tell_printed(&err);
    if (rc == 0)
        return EX_OK;
    rad_error_format(&err, text, sizeof text);
    fflush(stdout);
    fprintf(stderr, "radctl: %s\n", text);
    return rad_exit_status(rc);
}
