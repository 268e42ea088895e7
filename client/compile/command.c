/* command.c - see command.h
 *
 * While commands run, three signals that end a program at a terminal have a
 * handler of ours: it ends the commands, then lets the signal end the program.
 * Signals for which the program has handlers of its own are left alone: ours
 * only replaces the default action. */
#include "config.h"

#include "compile/command.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define MAX_RUNNING 64

struct command {
    char *text;
    pid_t pid; /* also its process group */
    int fd;    /* its output */
    bool wrote;
    int slot; /* in running[] */
};

extern char **environ;

static _Atomic int running[MAX_RUNNING]; /* process groups; 0: free */
static int nrunning;
static const int passed_on[] = { SIGINT, SIGTERM, SIGHUP };

static void
pass_on(int sig)
{
    command_stop_all();
    signal(sig, SIG_DFL);
    raise(sig); /* acts when the handler returns */
}

/* Replace the handler `from` by `to`, where it is in place. */
static void
swap_handlers(void (*from)(int), void (*to)(int))
{
    for (size_t i = 0; i < sizeof passed_on / sizeof passed_on[0]; i++) {
        struct sigaction old, act = { .sa_handler = to };

        sigemptyset(&act.sa_mask);
        if (sigaction(passed_on[i], NULL, &old) == 0 && old.sa_handler == from)
            sigaction(passed_on[i], &act, NULL);
    }
}

static int
enter(pid_t group)
{
    for (int i = 0; i < MAX_RUNNING; i++)
        if (running[i] == 0) {
            if (nrunning++ == 0)
                swap_handlers(SIG_DFL, pass_on);
            running[i] = (int)group;
            return i;
        }
    return -1;
}

static void
leave(int slot)
{
    if (slot < 0)
        return;
    running[slot] = 0;
    if (--nrunning == 0)
        swap_handlers(pass_on, SIG_DFL);
}

/* Run `sh -c text` in the folder; its output goes to fd (-1: nowhere). */
static int
spawn_shell(pid_t *pid, const char *text, const char *folder, int fd)
{
    char *argv[] = { (char *)"sh", (char *)"-c", (char *)text, NULL };
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attr;
    sigset_t none, defaults;
    int rc;

    sigemptyset(&none);
    sigemptyset(&defaults);
    sigaddset(&defaults, SIGPIPE);
    sigaddset(&defaults, SIGXFSZ);
    if (posix_spawn_file_actions_init(&actions))
        return ENOMEM;
    if (posix_spawnattr_init(&attr)) {
        posix_spawn_file_actions_destroy(&actions);
        return ENOMEM;
    }
    posix_spawnattr_setpgroup(&attr, 0);
    posix_spawnattr_setsigmask(&attr, &none);
    posix_spawnattr_setsigdefault(&attr, &defaults);
    posix_spawnattr_setflags(&attr, POSIX_SPAWN_SETPGROUP |
                                        POSIX_SPAWN_SETSIGMASK |
                                        POSIX_SPAWN_SETSIGDEF);
    rc =
        posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    if (!rc && fd < 0)
        rc = posix_spawn_file_actions_addopen(&actions, 1, "/dev/null",
                                              O_WRONLY, 0);
    if (!rc && fd >= 0)
        rc = posix_spawn_file_actions_adddup2(&actions, fd, 1);
    if (!rc)
        rc = posix_spawn_file_actions_addchdir_np(&actions, folder);
    if (!rc)
        rc = posix_spawn(pid, "/bin/sh", &actions, &attr, argv, environ);
    posix_spawnattr_destroy(&attr);
    posix_spawn_file_actions_destroy(&actions);
    return rc;
}

/* Run the command.  A signal that comes meanwhile waits until the command is
 * among those that it ends. */
static int
launch(struct command *c, const char *folder, int fd)
{
    sigset_t held, before;
    int rc;

    sigemptyset(&held);
    for (size_t i = 0; i < sizeof passed_on / sizeof passed_on[0]; i++)
        sigaddset(&held, passed_on[i]);
    pthread_sigmask(SIG_BLOCK, &held, &before);
    rc = spawn_shell(&c->pid, c->text, folder, fd);
    if (!rc)
        c->slot = enter(c->pid);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return rc;
}

/* Is a word of the command, which is split roughly as the shell does, a
 * relative path with a slash that leads from `folder` to a file?  Words without
 * a slash may be anything. */
static bool
names_file_in(const char *folder, const char *text)
{
    static const char between[] = " \t\n;|&()<>\"'`=";
    char path[PATH_MAX];
    struct stat st;

    for (;;) {
        text += strspn(text, between);

        int n = (int)strcspn(text, between);

        if (n == 0)
            return false;
        if (text[0] != '/' && memchr(text, '/', (size_t)n) &&
            snprintf(path, sizeof path, "%s/%.*s", folder, n, text) <
                (int)sizeof path &&
            stat(path, &st) == 0 && S_ISREG(st.st_mode))
            return true;
        text += n;
    }
}

const char *
command_folder(const char *text, const char *folder)
{
    if (!names_file_in(folder, text) && names_file_in(".", text))
        return ".";
    return folder;
}

struct command *
command_start(const char *text, const char *folder, struct rad_error *err)
{
    struct command *c = calloc(1, sizeof *c);
    int fd[2], rc;

    if (!c || !(c->text = strdup(text))) {
        free(c);
        rad_fail_memory(err);
        return NULL;
    }
    rc = pipe2(fd, O_CLOEXEC) ? errno : 0;
    if (!rc) {
        rc = launch(c, folder, fd[1]);
        close(fd[1]);
        if (rc)
            close(fd[0]);
    }
    if (rc) {
        rad_fail(err, RAD_EIO, "cannot run '!%.60s' in '%s': %s", text, folder,
                 strerror(rc));
        free(c->text);
        free(c);
        return NULL;
    }
    c->fd = fd[0];
    return c;
}

static long
read_output(void *arg, void *buf, size_t n, struct rad_error *err)
{
    struct command *c = arg;
    struct rad_fd from = { c->fd, c->text };
    struct rad_stream in = rad_fd_stream(&from);
    long got = in.read(in.arg, buf, n, err);

    c->wrote = c->wrote || got > 0;
    return got;
}

struct rad_stream
command_output(struct command *c)
{
    struct rad_stream in = { read_output, c };

    return in;
}

static int
wait_for(pid_t pid)
{
    int status;

    while (waitpid(pid, &status, 0) < 0)
        if (errno != EINTR)
            return -1;
    return status;
}

/* Does the shell know the word, as a program, builtin or reserved word? */
static bool
shell_knows(const char *word)
{
    char text[300];
    pid_t pid;

    snprintf(text, sizeof text, "command -v '%s'", word);
    return spawn_shell(&pid, text, "/", -1) != 0 || wait_for(pid) == 0;
}

/* Is p, outside of quotes, the end of a command?  Not in `2>&1` or `>|file`. */
static bool
parts_commands(const char *text, const char *p)
{
    return strchr("|&;\n", *p) && (p == text || !strchr("<>", p[-1]));
}

/* Is p, outside of quotes, the beginning of a comment? */
static bool
begins_comment(const char *text, const char *p)
{
    return *p == '#' && (p == text || strchr(" \t\n|&;", p[-1]));
}

/* Find the first word of the next command of a pipeline or list; "" unless it
 * is a plain name.  *at moves behind the command.  Quotes and comments may hide
 * characters that separate commands. */
static bool
next_program(const char **at, char *word, size_t size)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyz"
                                "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_+.-";
    const char *text = *at, *p = text + strspn(text, " \t\n\\|&;");
    size_t n = strspn(p, plain);
    char quote = 0;
    bool good = n > 0 && n < size && strchr(" \t\n|;&", p[n]);

    if (*p == '\0')
        return false;
    word[0] = '\0';
    if (good) {
        memcpy(word, p, n);
        word[n] = '\0';
    }
    for (; *p && (quote || !parts_commands(text, p)); p++) {
        if (!quote && begins_comment(text, p))
            p += strcspn(p, "\n") - 1;
        else if (*p == '\\' && p[1] && quote != '\'')
            p++;
        else if (quote ? *p == quote : *p == '"' || *p == '\'')
            quote = quote ? 0 : *p;
    }
    *at = p;
    return true;
}

/* Find a program of the command that is not installed; its name is in word. */
static bool
find_missing(const char *text, char *word, size_t size)
{
    while (next_program(&text, word, size))
        if (word[0] && !shell_knows(word))
            return true;
    return false;
}

static int
explain_status(const struct command *c, int status, struct rad_error *err)
{
    char word[200];

    if (status == 0 && c->wrote)
        return 0;
    if (find_missing(c->text, word, sizeof word))
        return rad_fail(err, RAD_EDATA,
                        "program '%s' is not installed: '!%.100s'", word,
                        c->text);
    if (status == 0)
        return 0;
    if (status > 0 && WIFSIGNALED(status))
        return rad_fail(err, RAD_EDATA, "'!%.100s' was ended by signal %d",
                        c->text, WTERMSIG(status));
    return rad_fail(err, RAD_EDATA, "'!%.100s' failed with exit status %d",
                    c->text, status > 0 ? WEXITSTATUS(status) : -1);
}

int
command_end(struct command *c, bool stop, struct rad_error *err)
{
    int status, rc;

    close(c->fd);
    if (stop)
        kill(-c->pid, SIGTERM);
    status = wait_for(c->pid);
    leave(c->slot);
    rc = stop ? 0 : explain_status(c, status, err);
    free(c->text);
    free(c);
    return rc;
}

void
command_stop_all(void)
{
    for (int i = 0; i < MAX_RUNNING; i++) {
        int group = running[i];

        if (group > 0)
            kill(-(pid_t)group, SIGTERM);
    }
}
