/* local.c - see local.h */
#include "config.h"

#include "link/local.h"

#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <spawn.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

extern char **environ;

enum {
    LIFETIME_FD = 3, /* where a daemon finds the pipe */
    READY_MS = 10000,
    STOP_MS = 2000, /* a daemon that has not ended by then is killed */
    LOOK_MS = 10,
    SWEEPS = 100 /* of a folder in which daemons may still write */
};

/* room for a socket's name in it, which the kernel bounds */
enum { LONGEST_FOLDER = 80, MOST_ARGS = 16 };

struct local {
    char folder[LONGEST_FOLDER + 1];
    char programs[4096]; /* radsubmit's own folder; empty: not known */
    struct target target;
    int alive[2]; /* the pipe; [1] is what keeps them alive */
    int notify;   /* socket on which a daemon says that it is ready */
    pid_t keeper;
    pid_t coordinator;
    pid_t *workers; /* nworkers, 0 for one that has ended */
    int nworkers;
};

/* --- the folder --- */

static bool
make_folder(struct local *l, const char *base)
{
    int n = snprintf(l->folder, sizeof l->folder, "%s/radsubmit.XXXXXX", base);

    return n < (int)sizeof l->folder && mkdtemp(l->folder) != NULL;
}

/* radsubmit's own folder, its slash included. */
static void
find_programs(struct local *l)
{
    ssize_t n = readlink("/proc/self/exe", l->programs, sizeof l->programs - 1);

    l->programs[n > 0 ? n : 0] = '\0';
    for (; n > 0 && l->programs[n - 1] != '/'; n--)
        l->programs[n - 1] = '\0';
}

bool
local_rpict(char *path, size_t size)
{
    /* beside a build's radsubmit, where it was to be installed, and beside an
     * installation that was moved */
    static const char *const folders[] = { "libexec/radd", RADD_LIBEXECDIR,
                                           "../libexec/radd" };
    struct local l = { 0 };
    bool found = false;

    find_programs(&l);
    for (int i = 0; i < 3 && !found; i++) {
        char *rpict = NULL, *real;

        if (asprintf(&rpict, "%s%s/rpict", i == 1 ? "" : l.programs,
                     folders[i]) < 0)
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

static int
remove_entry(const char *path, const struct stat *st, int flag, struct FTW *ftw)
{
    (void)st;
    (void)flag;
    (void)ftw;
    remove(path); /* what cannot be removed stays; the rest goes */
    return 0;
}

static void
remove_folder(const struct local *l)
{
    nftw(l->folder, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
}

/* The keeper's life: wait until radsubmit is gone, then remove the folder,
 * again while daemons that are about to end put something into it. */
static void
keep(const struct local *l)
{
    int null = open("/dev/null", O_RDWR);
    struct pollfd life = { .fd = l->alive[0] };
    char byte;

    setsid();
    for (int fd = 0; fd < 3 && null >= 0; fd++)
        dup2(null, fd); /* whoever reads radsubmit's output need not wait */
    close(l->alive[1]);
    /* the daemons share this end, and their libuv makes it non-blocking */
    while (read(l->alive[0], &byte, 1) != 0)
        poll(&life, 1, -1);
    for (int i = 0; i < SWEEPS && access(l->folder, F_OK) == 0; i++) {
        poll(NULL, 0, 2 * LOOK_MS);
        remove_folder(l);
    }
}

/* A process that removes the folder if radsubmit is killed.  Signals do not
 * end it: libuv's handlers would answer them in radsubmit's name. */
static int
start_keeper(struct local *l, struct rad_error *err)
{
    if (pipe2(l->alive, O_CLOEXEC) != 0)
        return rad_fail(err, RAD_ENOMEM, "cannot make a pipe: %s",
                        strerror(errno));
    l->keeper = fork();
    if (l->keeper < 0)
        return rad_fail(err, RAD_ENOMEM, "cannot start a process: %s",
                        strerror(errno));
    if (l->keeper == 0) {
        signal(SIGINT, SIG_IGN);
        signal(SIGTERM, SIG_IGN);
        signal(SIGHUP, SIG_IGN);
        keep(l);
        _exit(0);
    }
    return 0;
}

int
local_new(struct local **out, struct rad_error *err)
{
    struct local *l = calloc(1, sizeof *l);
    const char *tmp = getenv("TMPDIR");

    *out = NULL;
    if (!l)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    l->alive[0] = l->alive[1] = l->notify = -1;
    if (!(tmp && tmp[0] == '/' && make_folder(l, tmp)) &&
        !make_folder(l, "/tmp")) {
        free(l);
        return rad_fail(err, RAD_ECANTCREAT,
                        "cannot make a private folder in /tmp: %s",
                        strerror(errno));
    }
    find_programs(l);
    *out = l;
    return start_keeper(l, err);
}

const char *
local_folder(const struct local *l)
{
    return l->folder;
}

/* --- programs --- */

static bool
executable(const char *path)
{
    struct stat st;

    return stat(path, &st) == 0 && S_ISREG(st.st_mode) &&
           access(path, X_OK) == 0;
}

/* The program's path, or its name alone for PATH to find. */
static void
program_path(const struct local *l, const char *name, char *path, size_t size)
{
    static const char *const beside[] = { "", "../sbin/" };

    for (size_t i = 0; l->programs[0] && i < 2; i++) {
        int n = snprintf(path, size, "%s%s%s", l->programs, beside[i], name);

        if (n < (int)size && executable(path))
            return;
    }
    snprintf(path, size, "%s", name);
}

/* The environment with NOTIFY_SOCKET set to socket; its array is to be freed,
 * the variable is in `text`. */
static char **
environment(char *text, size_t size, const char *socket)
{
    size_t n = 0, k = 0;
    char **env;

    while (environ[n])
        n++;
    env = calloc(n + 2, sizeof *env);
    if (!env)
        return NULL;
    for (size_t i = 0; i < n; i++)
        if (strncmp(environ[i], "NOTIFY_SOCKET=", 14) != 0)
            env[k++] = environ[i];
    snprintf(text, size, "NOTIFY_SOCKET=%s", socket);
    env[k] = text;
    return env;
}

/* What a daemon starts with: no input, its output where our errors go, the
 * pipe, default signals, a session of its own. */
static int
spawn(pid_t *pid, const struct local *l, char *const argv[], char **env)
{
    posix_spawn_file_actions_t fa;
    posix_spawnattr_t attr;
    sigset_t set;
    int rc;

    posix_spawn_file_actions_init(&fa);
    posix_spawnattr_init(&attr);
    posix_spawn_file_actions_addopen(&fa, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&fa, 2, 1);
    posix_spawn_file_actions_adddup2(&fa, l->alive[0], LIFETIME_FD);
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

/* Start a daemon with options, each of them in the private folder. */
static int
start(pid_t *pid, const struct local *l, const char *name,
      const char *const options[], struct rad_error *err)
{
    char path[4200], lifetime[32], notify[160], socket[120];
    char *argv[MOST_ARGS], **env;
    int argc = 0, rc;

    program_path(l, name, path, sizeof path);
    snprintf(lifetime, sizeof lifetime, "--lifetime-fd=%d", LIFETIME_FD);
    snprintf(socket, sizeof socket, "%s/ready", l->folder);
    env = environment(notify, sizeof notify, socket);
    if (!env)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    argv[argc++] = path;
    argv[argc++] = lifetime;
    argv[argc++] = (char *)"--log-level=err";
    for (int i = 0; options[i] && argc < MOST_ARGS - 1; i++)
        argv[argc++] = (char *)options[i];
    argv[argc] = NULL;
    rc = spawn(pid, l, argv, env);
    free(env);
    if (rc != 0)
        return rad_fail(err, RAD_EINTERNAL, "cannot start '%s': %s", path,
                        strerror(rc));
    return 0;
}

/* --- readiness --- */

static int
open_notify(struct local *l, struct rad_error *err)
{
    struct sockaddr_un un = { .sun_family = AF_UNIX };

    snprintf(un.sun_path, sizeof un.sun_path, "%s/ready", l->folder);
    l->notify = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (l->notify < 0 ||
        bind(l->notify, (struct sockaddr *)&un, sizeof un) != 0)
        return rad_fail(err, RAD_ECANTCREAT, "cannot bind '%s': %s",
                        un.sun_path, strerror(errno));
    return 0;
}

/* Has the process ended?  Its pid becomes 0 then. */
static bool
ended(pid_t *pid)
{
    if (*pid > 0 && waitpid(*pid, NULL, WNOHANG) == *pid)
        *pid = 0;
    return *pid == 0;
}

static uint64_t
now_ms(void)
{
    struct timespec t;

    clock_gettime(CLOCK_MONOTONIC, &t);
    return (uint64_t)t.tv_sec * 1000 + (uint64_t)t.tv_nsec / 1000000;
}

static int
wait_ready(struct local *l, const int *stop, struct rad_error *err)
{
    struct pollfd fd = { .fd = l->notify, .events = POLLIN };
    uint64_t until = now_ms() + READY_MS;
    char text[256];
    ssize_t n;

    while (now_ms() < until && !*stop) {
        if (poll(&fd, 1, LOOK_MS) > 0) {
            n = recv(l->notify, text, sizeof text - 1, 0);
            text[n > 0 ? n : 0] = '\0';
            if (strstr(text, "READY=1")) {
                /* nobody reads what is said from now on: a sender must be
                 * refused, or it waits for ever once the queue is full */
                close(l->notify);
                l->notify = -1;
                return 0;
            }
        } else if (ended(&l->coordinator)) {
            return rad_fail(err, RAD_EINTERNAL,
                            "radcoord ended before it was ready");
        }
    }
    return rad_fail(err, RAD_EUNAVAIL, "radcoord is not ready after %d s",
                    READY_MS / 1000);
}

/* --- the cluster --- */

static int
processors(void)
{
    cpu_set_t set;
    int n = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;

    return n > 0 ? n : 1;
}

int
local_threads(int nworkers, int nthreads)
{
    int n = nthreads ? nthreads : processors() / nworkers;

    return n > 0 ? n : 1;
}

static int
start_coordinator(struct local *l, struct rad_error *err)
{
    char socket[120], state[120];
    const char *options[] = { socket, state, "--listen=", "--embedded", NULL };

    snprintf(socket, sizeof socket, "--socket=%s/coord", l->folder);
    snprintf(state, sizeof state, "--state=%s/state", l->folder);
    return start(&l->coordinator, l, "radcoord", options, err);
}

static int
start_worker(struct local *l, int i, int nthreads, struct rad_error *err)
{
    char to[160], name[32], cache[128], threads[32], listen[128];
    const char *options[] = { to,     name,       cache,        threads,
                              listen, "--nice=0", "--embedded", NULL };

    snprintf(to, sizeof to, "--coordinator=%s/coord", l->folder);
    snprintf(name, sizeof name, "--name=local-%d", i + 1);
    snprintf(cache, sizeof cache, "--cache=%s/cache-%d", l->folder, i + 1);
    snprintf(threads, sizeof threads, "--threads=%d", nthreads);
    snprintf(listen, sizeof listen, "--listen=%s/peer-%d", l->folder, i + 1);
    return start(&l->workers[i], l, "radd", options, err);
}

int
local_start(struct local *l, int nworkers, int nthreads, const int *stop,
            struct rad_error *err)
{
    char socket[sizeof l->target.path];
    int rc;

    nthreads = local_threads(nworkers, nthreads);
    snprintf(socket, sizeof socket, "%s/coord", l->folder);
    if ((rc = target_parse(&l->target, socket, err)) < 0 ||
        (rc = open_notify(l, err)) < 0)
        return rc;
    l->workers = calloc((size_t)nworkers, sizeof *l->workers);
    if (!l->workers)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    if ((rc = start_coordinator(l, err)) < 0 ||
        (rc = wait_ready(l, stop, err)) < 0)
        return rc;
    for (int i = 0; i < nworkers; i++) {
        if ((rc = start_worker(l, i, nthreads, err)) < 0)
            return rc;
        l->nworkers = i + 1;
    }
    return 0;
}

const struct target *
local_target(const struct local *l)
{
    return &l->target;
}

int
local_workers(struct local *l)
{
    int n = 0;

    for (int i = 0; i < l->nworkers; i++)
        n += !ended(&l->workers[i]);
    return n;
}

bool
local_alive(struct local *l)
{
    return !ended(&l->coordinator) && local_workers(l) > 0;
}

static bool
all_ended(struct local *l)
{
    bool all = ended(&l->coordinator);

    for (int i = 0; i < l->nworkers; i++)
        all &= ended(&l->workers[i]);
    return all;
}

static void
end_keeper(struct local *l)
{
    if (l->keeper <= 0)
        return;
    kill(l->keeper, SIGKILL);
    while (waitpid(l->keeper, NULL, 0) < 0 && errno == EINTR)
        ;
}

/* A daemon leads its session, so its group has its children in it. */
static void
kill_one(pid_t *pid)
{
    if (*pid <= 0)
        return;
    kill(-*pid, SIGKILL);
    while (waitpid(*pid, NULL, 0) < 0 && errno == EINTR)
        ;
    *pid = 0;
}

static void
stop_daemons(struct local *l)
{
    uint64_t until = now_ms() + STOP_MS;

    if (l->alive[1] >= 0)
        close(l->alive[1]);
    while (!all_ended(l) && now_ms() < until)
        poll(NULL, 0, 1);
    kill_one(&l->coordinator);
    for (int i = 0; i < l->nworkers; i++)
        kill_one(&l->workers[i]);
}

void
local_stop(struct local *l)
{
    if (!l)
        return;
    end_keeper(l);
    stop_daemons(l);
    if (l->alive[0] >= 0)
        close(l->alive[0]);
    if (l->notify >= 0)
        close(l->notify);
    remove_folder(l);
    free(l->workers);
    free(l);
}
