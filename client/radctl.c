/* radctl.c - look at and steer a running cluster; see radctl(1)
 *
 * Each command is one row of a table: what it says to the coordinator and what
 * it does with the answer. */
#include "config.h"

#include "fetch.h"
#include "keyctl.h"
#include "picfile.h"
#include "picture/number.h"
#include "statecheck.h"
#include "table.h"

#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <time.h>
#include <unistd.h>

enum {
    CONNECT_MS = 3000,
    ANSWER_MS = 4500, /* from the start: 69 comes within 5 s */
    MOST_ROWS = 200   /* of a table for people */
};

struct ctl {
    const struct command *command;
    const char *arg;         /* the command's, NULL where it has none */
    const char *name;        /* the word behind it: a key's, or NULL */
    const char *coordinator; /* --coordinator */
    const char *key;         /* --key: what to show the coordinator */
    json_t *problems;        /* of check, as JSON */
    const char *keys;        /* --keys: the file that `key` edits */
    const char *expires;     /* --expires */
    const char *output;
    int frame;
    bool json;
    bool admin; /* what the coordinator let us be */
    uv_loop_t loop;
    int wake;
    struct link *link;
    uint32_t request;
    uint64_t start_ms;
    struct rad_error *err;
};

struct command {
    const char *name;
    const char *arg; /* what it is called in the help; NULL: none */
    const char *help;
    int (*run)(struct ctl *c);
    int number; /* message or query that it sends */
};

/* --- asking --- */

/* Send m and wait for its answer of that type; a FAILED is the error. */
static int
ask(struct ctl *c, struct msg *m, uint16_t type, const struct msg **answer)
{
    int rc, left;

    m->request = ++c->request;
    if ((rc = link_send(c->link, m, c->err)) < 0)
        return rc;
    for (;;) {
        uv_update_time(&c->loop);
        left = ANSWER_MS - (int)(uv_now(&c->loop) - c->start_ms);
        rc = link_recv(c->link, left > 0 ? left : 0, answer, c->err);
        if (rc < 0)
            return rc;
        if (rc == 0)
            return rad_fail(c->err, RAD_EUNAVAIL,
                            "the coordinator does not answer");
        if ((*answer)->request != c->request)
            continue;
        if ((*answer)->type == MSG_FAILED)
            return rad_fail(c->err, link_code((*answer)->failed.status), "%s",
                            (*answer)->failed.text);
        if ((*answer)->type == type)
            return 0;
    }
}

static int
ask_query(struct ctl *c, int what, const char *text, const struct msg **answer)
{
    struct msg m = { .type = MSG_QUERY };

    m.query.what = (uint8_t)what;
    m.query.text = text ? text : "";
    return ask(c, &m, MSG_ANSWER, answer);
}

static json_t *
parse_answer(struct ctl *c, const struct msg *answer)
{
    json_error_t why;
    json_t *root = json_loadb((const char *)answer->answer.text,
                              answer->answer.len, 0, &why);

    if (!root)
        rad_fail(c->err, RAD_EPROTO, "the coordinator's answer is no JSON: %s",
                 why.text);
    return root;
}

/* The id that the argument stands for: all of its digits, or the first ones
 * of a job that the coordinator knows. */
static int
find_job(struct ctl *c, uint8_t job[MSG_JOB])
{
    const struct msg *answer;
    const char *id;
    json_t *root;
    int rc = 0;

    if (msg_job_parse(c->arg, job))
        return 0;
    if (strspn(c->arg, "0123456789abcdefABCDEF") != strlen(c->arg) ||
        c->arg[0] == '\0')
        return rad_fail(c->err, RAD_EUSAGE, "'%s' is no job's id", c->arg);
    if ((rc = ask_query(c, MSG_QUERY_JOB, c->arg, &answer)) < 0)
        return rc;
    root = parse_answer(c, answer);
    if (!root)
        return c->err->code;
    id = json_string_value(json_object_get(root, "job"));
    if (!id || !msg_job_parse(id, job))
        rc = rad_fail(c->err, RAD_EPROTO,
                      "the coordinator's answer names no "
                      "job");
    json_decref(root);
    return rc;
}

/* --- commands --- */

/* What people look for in a list of jobs, the rest is for --json and job. */
static json_t *
short_jobs(const json_t *jobs)
{
    static const char *const keys[] = { "job",       "state",    "done",
                                        "owner",     "priority", "workers",
                                        "elapsed_s", "name",     "text" };
    json_t *list = json_array(), *row, *value;
    const json_t *job;
    size_t i;

    json_array_foreach(jobs, i, job)
    {
        row = json_object();
        for (size_t k = 0; k < sizeof keys / sizeof keys[0]; k++) {
            value = json_object_get(job, keys[k]);
            if (strcmp(keys[k], "done") == 0) /* rounded down: 100 is all */
                json_object_set_new(
                    row, keys[k],
                    json_sprintf("%3d %%",
                                 (int)(json_number_value(value) * 100)));
            else if (value)
                json_object_set(row, keys[k], value);
        }
        json_array_append_new(list, row);
    }
    return list;
}

static int
run_query(struct ctl *c)
{
    const struct msg *answer;
    json_t *root;
    int rc = ask_query(c, c->command->number, c->arg, &answer);

    if (rc < 0)
        return rc;
    if (c->json) {
        fwrite(answer->answer.text, 1, answer->answer.len, stdout);
        putchar('\n');
        return 0;
    }
    root = parse_answer(c, answer);
    if (!root)
        return c->err->code;
    if (c->command->number == MSG_QUERY_JOBS && json_is_array(root)) {
        json_t *list = short_jobs(root);

        json_decref(root);
        root = list;
    }
    table_print(stdout, root, MOST_ROWS);
    json_decref(root);
    return 0;
}

static int
say_done(const struct ctl *c)
{
    if (c->json)
        puts("{ \"ok\": true }");
    return 0;
}

/* cancel, pause, resume: messages that name a job */
static int
run_job(struct ctl *c)
{
    struct msg m = { .type = (uint16_t)c->command->number };
    const struct msg *answer;
    uint8_t job[MSG_JOB];
    int rc = find_job(c, job);

    if (rc < 0)
        return rc;
    m.cancel.job = job; /* the three share a struct */
    rc = ask(c, &m, MSG_ANSWER, &answer);
    return rc < 0 ? rc : say_done(c);
}

/* drain, undrain: messages that name a worker */
static int
run_worker(struct ctl *c)
{
    struct msg m = { .type = (uint16_t)c->command->number };
    const struct msg *answer;
    int rc;

    m.drain.name = c->arg;
    rc = ask(c, &m, MSG_ANSWER, &answer);
    return rc < 0 ? rc : say_done(c);
}

/* A file of a job, whole; the caller frees its bytes. */
static int
fetch_file(struct ctl *c, const uint8_t job[MSG_JOB], enum msg_what what,
           struct fetched *f)
{
    const struct msg *m;
    int rc = fetch_start(c->link, job, (uint32_t)c->frame, what, ++c->request,
                         c->err);

    while (rc == 0) {
        rc = link_recv(c->link, INT_MAX, &m, c->err);
        if (rc == 1)
            rc = m->request == c->request ? fetch_take(f, m, c->err) : 0;
    }
    return rc < 0 ? rc : 0;
}

static int
run_fetch(struct ctl *c)
{
    uint8_t job[MSG_JOB];
    struct fetched f = { 0 };
    int rc;

    if (c->output && (rc = output_check(c->output, c->err)) < 0)
        return rc;
    if ((rc = find_job(c, job)) < 0)
        return rc;
    rc = fetch_file(c, job, MSG_WHAT_PICTURE, &f);
    if (rc == 0)
        rc = picfile_write(c->output, PICFILE_BY_SUFFIX, f.bytes, f.len, true,
                           c->err);
    free(f.bytes);
    return rc < 0 || !c->output ? rc : say_done(c);
}

/* What the queue knows of a job, into its statistics. */
static int
add_state(struct ctl *c, json_t *stats)
{
    const struct msg *answer;
    json_t *state;
    int rc = ask_query(c, MSG_QUERY_JOB, c->arg, &answer);

    if (rc < 0)
        return rc;
    state = parse_answer(c, answer);
    if (!state)
        return c->err->code;
    json_object_update_missing(stats, state);
    json_decref(state);
    return 0;
}

/* job: for people a summary, as JSON the statistics so far and the state. */
static int
run_job_report(struct ctl *c)
{
    struct fetched f = { 0 };
    uint8_t job[MSG_JOB];
    json_t *stats = NULL;
    int rc;

    if (!c->json)
        return run_query(c);
    if ((rc = find_job(c, job)) < 0)
        return rc;
    rc = fetch_file(c, job, MSG_WHAT_STATS, &f);
    if (rc == 0) {
        stats = json_loadb((const char *)f.bytes, f.len, 0, NULL);
        rc = stats ? add_state(c, stats)
                   : rad_fail(c->err, RAD_EPROTO, "the statistics are no JSON");
    }
    if (rc == 0) {
        json_dumpf(stats, stdout, JSON_INDENT(1) | JSON_REAL_PRECISION(9));
        putchar('\n');
    }
    json_decref(stats);
    free(f.bytes);
    return rc;
}

/* key: in the file itself, if one is named, else by the coordinator */
static int
run_key_file(struct ctl *c, const struct key_order *order)
{
    char *text;
    int rc = key_order_run(c->keys, order, (int64_t)time(NULL), &text, c->err);

    if (rc == 0)
        rc = keyctl_print(order, text, strlen(text), c->json, c->err);
    if (text)
        explicit_bzero(text, strlen(text));
    free(text);
    return rc;
}

static int
run_key(struct ctl *c)
{
    struct msg m = { .type = MSG_KEY };
    const struct msg *answer;
    struct key_order order;
    int rc = keyctl_parse(&order, c->arg, c->name, c->expires, c->err);

    if (rc < 0)
        return rc;
    if (c->keys)
        return run_key_file(c, &order);
    m.key = (struct msg_key){ (uint8_t)order.what, order.name,
                              (uint64_t)order.expires };
    rc = ask(c, &m, MSG_ANSWER, &answer);
    return rc < 0 ? rc
                  : keyctl_print(&order, (const char *)answer->answer.text,
                                 answer->answer.len, c->json, c->err);
}

/* A user who said it to a coordinator would be hung up on. */
static bool
for_admins(const struct command *command)
{
    return command->run == run_worker || command->run == run_key;
}

static void
tell_finding(void *arg, bool problem, const char *text)
{
    struct ctl *c = arg;

    if (!c->problems)
        printf("%s: %s\n", problem ? "problem" : "to be made again", text);
    else if (problem)
        json_array_append_new(c->problems, json_string(text));
}

static void
print_check(struct ctl *c, const struct statecheck *found)
{
    json_t *root;

    if (!c->problems && found->redo > 0)
        printf("the rows of %u unit%s will be made again: is the disk sound?\n",
               found->redo, found->redo == 1 ? "" : "s");
    if (!c->problems) {
        printf("%s: %u job%s, %u of them not over; %u problem%s\n",
               found->problems ? "damaged" : "sound", found->jobs,
               found->jobs == 1 ? "" : "s", found->open, found->problems,
               found->problems == 1 ? "" : "s");
        return;
    }
    root = json_pack("{s:b,s:i,s:i,s:i,s:O}", "sound", found->problems == 0,
                     "jobs", (int)found->jobs, "open", (int)found->open, "redo",
                     (int)found->redo, "problems", c->problems);
    json_dumpf(root, stdout, JSON_INDENT(1));
    putchar('\n');
    json_decref(root);
}

/* check: of a folder of this machine */
static int
run_check(struct ctl *c)
{
    struct statecheck found;
    int rc;

    c->problems = c->json ? json_array() : NULL;
    rc = statecheck_run(c->arg, &found, tell_finding, c, c->err);
    if (rc == 0)
        print_check(c, &found);
    json_decref(c->problems);
    if (rc == 0 && found.problems > 0)
        rc = rad_fail(c->err, RAD_EDATA,
                      "'%s' is damaged: put a backup in its place, or move it "
                      "away to begin without its jobs",
                      c->arg);
    return rc;
}

static const struct command commands[] = {
    { "status", NULL, "coordinator, workers and jobs in short", run_query,
      MSG_QUERY_STATUS },
    { "workers", NULL, "one line a worker", run_query, MSG_QUERY_WORKERS },
    { "jobs", NULL, "one line a job", run_query, MSG_QUERY_JOBS },
    { "job", "ID", "all about a job", run_job_report, MSG_QUERY_JOB },
    { "cancel", "ID", "end a job", run_job, MSG_CANCEL },
    { "pause", "ID", "hand out no more of a job", run_job, MSG_PAUSE },
    { "resume", "ID", "go on with a paused job", run_job, MSG_RESUME },
    { "fetch", "ID", "get a finished picture", run_fetch, 0 },
    { "drain", "WORKER", "give a worker no more work", run_worker, MSG_DRAIN },
    { "undrain", "WORKER", "give it work again", run_worker, MSG_UNDRAIN },
    { "key", "add NAME | retire NAME | list", "of hosts and users", run_key,
      MSG_KEY },
    { "check", "STATE-DIR", "is a coordinator's state folder sound?", run_check,
      0 },
};
enum { NCOMMANDS = sizeof commands / sizeof commands[0] };

/* --- command line --- */

static void
help(void)
{
    puts("usage: radctl [options] COMMAND [ARGUMENT]\n"
         "Look at and steer a running cluster.\n");
    for (int i = 0; i < NCOMMANDS; i++) {
        char head[80];
        int n = snprintf(head, sizeof head, "%s %s", commands[i].name,
                         commands[i].arg ? commands[i].arg : "");

        printf("  %-16s%s%s\n", head, n > 16 ? "\n                    " : "  ",
               commands[i].help);
    }
    puts("\n"
         "  --coordinator=HOST:PORT|SOCKET\n"
         "                    the coordinator\n"
         "  --key=FILE        what to show a coordinator over the network\n"
         "  --json            print answers as JSON\n"
         "  --keys=FILE       edit this key file, not the coordinator's\n"
         "  --expires=DATE    when a new key ends: 2027-01-31, at 00:00 UTC\n"
         "  -o FILE           where fetch writes (standard output)\n"
         "  --frame=N         picture of an animation to fetch, from 0\n"
         "  --help            this text\n"
         "  --version         the version");
}

/* The value of an option called name at argv[*i]: after '=' or the next word.
 * 1 if it is that option, 0 if not. */
static int
option_value(const char *name, char *argv[], int *i, const char **value,
             struct rad_error *err)
{
    size_t n = strlen(name);

    if (strncmp(argv[*i], name, n) != 0)
        return 0;
    if (argv[*i][n] == '=' && name[1] == '-') {
        *value = argv[*i] + n + 1;
        return 1;
    }
    if (argv[*i][n] != '\0')
        return 0;
    *value = argv[*i + 1];
    if (!*value)
        return rad_fail(err, RAD_EUSAGE, "option '%s': missing value", name);
    ++*i;
    return 1;
}

static int
take_option(struct ctl *c, char *argv[], int *i)
{
    const char *text;
    int rc;

    if (strcmp(argv[*i], "--json") == 0) {
        c->json = true;
        return 0;
    }
    if ((rc = option_value("--coordinator", argv, i, &c->coordinator,
                           c->err)) != 0 ||
        (rc = option_value("--key", argv, i, &c->key, c->err)) != 0 ||
        (rc = option_value("--keys", argv, i, &c->keys, c->err)) != 0 ||
        (rc = option_value("--expires", argv, i, &c->expires, c->err)) != 0 ||
        (rc = option_value("-o", argv, i, &c->output, c->err)) != 0)
        return rc < 0 ? rc : 0;
    if ((rc = option_value("--frame", argv, i, &text, c->err)) != 0) {
        if (rc > 0 && (!rad_parse_int(text, &c->frame) || c->frame < 0))
            rc = rad_fail(c->err, RAD_EUSAGE,
                          "option '--frame': '%s' is no whole number from 0",
                          text);
        return rc < 0 ? rc : 0;
    }
    return rad_fail(c->err, RAD_EUSAGE,
                    "unknown option '%s'; see radctl --help", argv[*i]);
}

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

static int
check_words(struct ctl *c)
{
    bool output = c->output != NULL;

    if (!c->command)
        return rad_fail(c->err, RAD_EUSAGE,
                        "no command given; see radctl --help");
    if (c->command->arg && !c->arg)
        return rad_fail(c->err, RAD_EUSAGE, "command '%s': missing %s",
                        c->command->name, c->command->arg);
    if (c->output && strcmp(c->output, "-") == 0)
        c->output = NULL;
    /* of a job it would be how all of them begin, and so one that is alone */
    if (c->arg && c->arg[0] == '\0')
        return rad_fail(c->err, RAD_EUSAGE, "command '%s': empty %s",
                        c->command->name, c->command->arg);
    if (c->command->run != run_fetch && (output || c->frame))
        return rad_fail(c->err, RAD_EUSAGE,
                        "-o and --frame go with fetch alone");
    if (c->command->run != run_key && (c->keys || c->expires))
        return rad_fail(c->err, RAD_EUSAGE,
                        "--keys and --expires go with key alone");
    if (c->command->run == run_fetch && c->json && !c->output)
        return rad_fail(c->err, RAD_EUSAGE, "fetch: --json needs -o");
    return c->output ? picfile_check(c->output, false, c->err) : 0;
}

/* Options and words may mix. */
static int
take_words(struct ctl *c, int argc, char *argv[])
{
    int rc = 0;

    for (int i = 1; i < argc && rc == 0; i++) {
        if (argv[i][0] == '-' && argv[i][1] != '\0')
            rc = take_option(c, argv, &i);
        else if (!c->command)
            rc = find_command(c, argv[i]);
        else if (c->command->arg && !c->arg)
            c->arg = argv[i];
        else if (c->command->run == run_key && !c->name)
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

/* As an administrator where the coordinator lets us, else as a user. */
static int
connect_to(struct ctl *c, const struct target *to)
{
    struct link_where where = { &c->loop, &c->wake };
    struct rad_error refused = { 0 };
    int rc = RAD_EPERM;

    c->admin = link_may_be_admin(to);
    if (c->admin)
        rc = link_open(&c->link, &where, to, MSG_ROLE_ADMIN, CONNECT_MS,
                       &refused);
    if (rc == RAD_EPERM && (to->local || refused.code == 0)) {
        c->admin = false;
        return link_open(&c->link, &where, to, MSG_ROLE_USER, CONNECT_MS,
                         c->err);
    }
    if (rc < 0)
        *c->err = refused;
    return rc;
}

/* What was printed is out. */
static int
end_output(struct ctl *c)
{
    if (fflush(stdout) == 0 && !ferror(stdout))
        return 0;
    return rad_fail(c->err, RAD_EIO, "cannot write: %s", strerror(errno));
}

static int
run(struct ctl *c)
{
    struct target to;
    int rc;

    if (c->keys || c->command->run == run_check) { /* without coordinator */
        rc = c->command->run(c);
        return rc < 0 ? rc : end_output(c);
    }
    rc = target_find(&to, c->coordinator, c->key, c->err);
    if (rc < 0)
        return rc;
    if (rc == 0)
        return rad_fail(
            c->err, RAD_EUNAVAIL,
            "no coordinator named: use --coordinator, "
            "RADD_COORDINATOR or radsubmit.conf%s",
            c->command->run == run_key ? ", or --keys to edit a key file" : "");
    if (uv_loop_init(&c->loop) != 0)
        return rad_fail(c->err, RAD_ENOMEM, "out of memory");
    c->start_ms = uv_now(&c->loop);
    rc = connect_to(c, &to);
    if (rc == 0 && !c->admin && for_admins(c->command))
        rc = rad_fail(c->err, RAD_EPERM, "command '%s' is for administrators",
                      c->command->name);
    if (rc == 0)
        rc = c->command->run(c);
    link_close(c->link);
    uv_loop_close(&c->loop);
    return rc < 0 ? rc : end_output(c);
}

int
main(int argc, char *argv[])
{
    struct rad_error err = { 0 };
    struct ctl c = { .err = &err };
    char text[600];
    int rc;

    if (asks_for(argc, argv, "--help")) {
        help();
        return EX_OK;
    }
    if (asks_for(argc, argv, "--version")) {
        puts("radctl (radd) " PACKAGE_VERSION);
        return EX_OK;
    }
    rc = take_words(&c, argc, argv);
    if (rc == 0)
        rc = run(&c);
    if (rc == 0)
        return EX_OK;
    rad_error_format(&err, text, sizeof text);
    fflush(stdout);
    fprintf(stderr, "radctl: %s\n", text);
    /* exit() would wait for a resolver that still looks for the host */
    _exit(rad_exit_status(rc));
}
