/* programs.c - see programs.h */
#include "config.h"

#include "link/programs.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

extern char **environ;

/* The folder of radsubmit itself, with its slash; "": unknown. */
static void
own_folder(char *path, size_t size)
{
    ssize_t n = readlink("/proc/self/exe", path, size - 1);

    path[n > 0 ? n : 0] = '\0';
    for (; n > 0 && path[n - 1] != '/'; n--)
        path[n - 1] = '\0';
}

static bool
executable(const char *path)
{
    struct stat st;

    return stat(path, &st) == 0 && S_ISREG(st.st_mode) &&
           access(path, X_OK) == 0;
}

void
programs_path(const char *name, char *path, size_t size)
{
    static const char *const beside[] = { "", "../sbin/" };
    char own[PATH_MAX];

    own_folder(own, sizeof own);
    for (size_t i = 0; own[0] && i < 2; i++) {
        int n = snprintf(path, size, "%s%s%s", own, beside[i], name);

        if (n < (int)size && executable(path))
            return;
    }
    snprintf(path, size, "%s", name);
}

bool
programs_rpict(char *path, size_t size)
{
    /* beside radsubmit in a build; where it was to be installed; and beside it
     * in an installation that was moved */
    static const char *const folders[] = { "libexec/radd", RADD_LIBEXECDIR,
                                           "../libexec/radd" };
    char own[PATH_MAX];
    bool found = false;

    own_folder(own, sizeof own);
    for (int i = 0; i < 3 && !found; i++) {
        char *rpict = NULL, *real;

        if (asprintf(&rpict, "%s%s/rpict", i == 1 ? "" : own, folders[i]) < 0)
            return false;
        real = access(rpict, X_OK) == 0 ? realpath(rpict, NULL) : NULL;
        if (real) {
            real[strlen(real) - strlen("/rpict")] = '\0';
            found = snprintf(path, size, "%s", real) < (int)size;
        }
        free(real);
        free(rpict);
    }
    return found;
}

char **
programs_environment(char *setting)
{
    size_t n = 0, k = 0, name = strcspn(setting, "=") + 1;
    char **env;

    while (environ[n])
        n++;
    env = calloc(n + 2, sizeof *env);
    if (!env)
        return NULL;
    for (size_t i = 0; i < n; i++)
        if (strncmp(environ[i], setting, name) != 0)
            env[k++] = environ[i];
    env[k] = setting;
    return env;
}

int
programs_spawn(pid_t *pid, char *const argv[], char **env, int in, int keep)
{
    posix_spawn_file_actions_t fa;
    posix_spawnattr_t attr;
    sigset_t set;
    int rc;

    posix_spawn_file_actions_init(&fa);
    posix_spawnattr_init(&attr);
    if (in >= 0)
        posix_spawn_file_actions_adddup2(&fa, in, 0);
    else
        posix_spawn_file_actions_addopen(&fa, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&fa, 2, 1);
    if (keep >= 0)
        posix_spawn_file_actions_adddup2(&fa, keep, PROGRAMS_KEPT);
    sigemptyset(&set);
    posix_spawnattr_setsigmask(&attr, &set);
    sigfillset(&set);
    posix_spawnattr_setsigdefault(&attr, &set);
    posix_spawnattr_setflags(&attr, POSIX_SPAWN_SETSID |
                                        POSIX_SPAWN_SETSIGMASK |
                                        POSIX_SPAWN_SETSIGDEF);
    rc = posix_spawnp(pid, argv[0], &fa, &attr, argv, env);
    posix_spawn_file_actions_destroy(&fa);
    posix_spawnattr_destroy(&attr);
    return rc;
}

int
programs_not_started(const char *path, int number, struct rad_error *err)
{
    bool lack = number == EAGAIN || number == ENOMEM || number == EMFILE ||
                number == ENFILE;

    return rad_fail(err, lack ? RAD_ENOMEM : RAD_EINTERNAL,
                    "cannot start '%s': %s", path, strerror(number));
}
