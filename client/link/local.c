/* local.c - see local.h */
#include "config.h"

#include "link/local.h"

#include "link/programs.h"

#include "base/output.h"
#include "net/address.h"
#include "net/listen.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <sysexits.h>
#include <unistd.h>
#include <uv.h>

enum {
    READY_MS = 60000, /* an overloaded host takes seconds to start a program */
    STOP_MS = 2000,   /* then a daemon is killed */
    LOOK_MS = 2,
    SWEEPS = 100, /* removals, for daemons may still write */
    SWEEP_MS = 20,
    LEAST_SHARED = 1 << 20 /* bytes; smaller files are sent as fast */
};

/* leaves room for a socket's name: the kernel limits its path */
enum {
    LONGEST_FOLDER = 80,
    MOST_ARGS = 16,
    MOST_LAUNCHED = 4096,
    MOST_WAITING = 4096
};

struct local {
    char folder[LONGEST_FOLDER + 1];
    struct target target;
    int alive[2];    /* a pipe; daemons end when [1] is closed */
    int launched[2]; /* a pipe to the keeper: process groups that it has to end;
                      * a negative number cancels one */
    int notify; /* socket on which the coordinator reports that it is ready */
    pid_t keeper;
    pid_t coordinator;
    pid_t *workers; /* nworkers pids; 0: has ended */
    int lack; /* a daemon has ended for want of memory: RAD_ENOMEM; of threads
               * or descriptors: RAD_ESHORT; 0: none has */
    int nworkers;
};

/* --- the folder --- */

static bool
make_folder(struct local *l, const char *base)
{
    int n = snprintf(l->folder, sizeof l->folder, "%s/radsubmit.XXXXXX", base);

    return n < (int)sizeof l->folder && mkdtemp(l->folder) != NULL;
}

/* End the launched process groups: first by SIGTERM, then by SIGKILL. */
static void
end_launched(const struct local *l)
{
    static const int how[] = { SIGTERM, SIGKILL };
    pid_t group[MOST_LAUNCHED], g;
    size_t n = 0;

    while (read(l->launched[0], &g, sizeof g) == (ssize_t)sizeof g) {
        for (size_t i = 0; i < n; i++)
            if (group[i] == -g)
                group[i--] = group[--n];
        if (g > 0 && n < MOST_LAUNCHED)
            group[n++] = g;
    }
    for (int k = 0; k < 2 && n > 0; k++) {
        for (size_t i = 0; i < n; i++)
            kill(-group[i], how[k]);
        poll(NULL, 0, k == 0 ? STOP_MS : 0);
    }
}

/* What the keeper does: wait until radsubmit has ended, then end launchers and
 * remove the folder, several times while ending daemons may still write into
 * it. */
static void
keep(const struct local *l)
{
    int null = open("/dev/null", O_RDWR);
    struct pollfd life = { .fd = l->alive[0] };
    char byte;

    setsid();
    for (int fd = 0; fd < 3 && null >= 0; fd++)
        dup2(null, fd); /* or a reader of our output would wait */
    close(l->alive[1]);
    close(l->launched[1]);
    /* non-blocking: the daemons share this end, and libuv makes it so */
    while (read(l->alive[0], &byte, 1) != 0)
        poll(&life, 1, -1);
    end_launched(l);
    for (int i = 0; i < SWEEPS && access(l->folder, F_OK) == 0; i++) {
        poll(NULL, 0, SWEEP_MS);
        rad_remove_dir(l->folder);
    }
}

/* Start the keeper, a process that removes the folder if radsubmit is killed.
 * It ignores signals, for libuv's handlers in it would act on radsubmit's loop.
 */
static int
start_keeper(struct local *l, struct rad_error *err)
{
    if (pipe2(l->alive, O_CLOEXEC) != 0 || pipe2(l->launched, O_CLOEXEC) != 0)
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
        return rad_fail_memory(err);
    l->alive[0] = l->alive[1] = l->notify = -1;
    l->launched[0] = l->launched[1] = -1;
    if (!(tmp && tmp[0] == '/' && make_folder(l, tmp)) &&
        !make_folder(l, "/tmp")) {
        free(l);
        return rad_fail(err, RAD_ECANTCREAT,
                        "cannot make a private folder in /tmp: %s",
                        strerror(errno));
    }
    *out = l;
    return start_keeper(l, err);
}

const char *
local_folder(const struct local *l)
{
    return l->folder;
}

/* --- programs --- */

/* Start a daemon with these options; it gets the pipe that ends it and, if not
 * negative, `in` as its input.  notify: where it tells that it is ready; "":
 * nowhere. */
static int
start(pid_t *pid, const struct local *l, const char *name,
      const char *const options[], int in, const char *notify,
      struct rad_error *err)
{
    char path[4200], lifetime[32], setting[160];
    char *argv[MOST_ARGS], **env;
    int argc = 0, rc;

    programs_path(name, path, sizeof path);
    snprintf(lifetime, sizeof lifetime, "--lifetime-fd=%d", PROGRAMS_KEPT);
    snprintf(setting, sizeof setting, "NOTIFY_SOCKET=%s", notify);
    env = programs_environment(setting);
    if (!env)
        return rad_fail_memory(err);
    argv[argc++] = path;
    argv[argc++] = lifetime;
    argv[argc++] = (char *)"--log-level=err";
    for (int i = 0; options[i] && argc < MOST_ARGS - 1; i++)
        argv[argc++] = (char *)options[i];
    argv[argc] = NULL;
    rc = programs_spawn(pid, argv, env, in, l->alive[0]);
    free(env);
    if (rc == ENOENT)
        return rad_fail(err, RAD_EUNAVAIL,
                        "'%s' is not installed here: name a coordinator "
                        "(--coordinator), or install it",
                        name);
    return rc != 0 ? programs_not_started(path, rc, err) : 0;
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

/* Has the process ended?  If so *pid becomes 0. */
static bool
ended(struct local *l, pid_t *pid)
{
    int how;

    if (*pid > 0 && waitpid(*pid, &how, WNOHANG) == *pid) {
        if (WIFEXITED(how) && WEXITSTATUS(how) == EX_OSERR)
            l->lack = RAD_ENOMEM;
        else if (WIFEXITED(how) && WEXITSTATUS(how) == EX_TEMPFAIL)
            l->lack = RAD_ESHORT;
        *pid = 0;
    }
    return *pid == 0;
}

static uint64_t
now_ms(void)
{
    return uv_hrtime() / 1000000;
}

/* Has the coordinator said that it serves? */
static bool
said_ready(const struct local *l)
{
    char text[256];
    ssize_t n = recv(l->notify, text, sizeof text - 1, MSG_DONTWAIT);

    text[n > 0 ? n : 0] = '\0';
    return strstr(text, "READY=1") != NULL;
}

static int
wait_ready(struct local *l, const struct link_where *where,
           struct rad_error *err)
{
    uint64_t until = now_ms() + READY_MS;

    while (!said_ready(l)) {
        if (*where->wake > 0)
            return rad_fail(err, RAD_ETEMPFAIL, "interrupted");
        if (ended(l, &l->coordinator))
            return rad_fail(err, l->lack ? l->lack : RAD_EUNAVAIL,
                            "radcoord ended before it was ready");
        if (now_ms() > until)
            return rad_fail(err, RAD_EUNAVAIL,
                            "radcoord is not ready after %d s",
                            READY_MS / 1000);
        link_pause(where, LOOK_MS);
    }
    /* close it, for nobody reads it from now on: a sender then gets an error,
     * instead of waiting for ever at a full queue */
    close(l->notify);
    l->notify = -1;
    return 0;
}

/* --- the cluster --- */

int
local_threads(int nworkers, int nthreads)
{
    int n = nthreads ? nthreads : (int)uv_available_parallelism() / nworkers;

    return n > 0 ? n : 1;
}

/* The coordinator's socket, where workers and radsubmit wait for it while it
 * starts. */
static int
open_socket(const char *path, struct rad_error *err)
{
    struct address a;
    int fd = address_resolve_listen(path, &a, err);

    if (fd < 0)
        return fd;
    fd = listener_socket(&a, path, MOST_WAITING);
    return fd >= 0 ? fd
                   : rad_fail(err, RAD_ECANTCREAT, "cannot listen at '%s': %s",
                              path, uv_strerror(fd));
}

/* address: where it listens on the network; "": only on its Unix socket. */
static int
start_coordinator(struct local *l, const char *address, const char *keys,
                  struct rad_error *err)
{
    char socket[120], state[120], listen[300], file[200], ports[120],
        ready[120];
    const char *options[] = { socket, state, listen, "--embedded",
                              file,   ports, NULL };
    int fd = open_socket(l->target.path, err), rc;

    if (fd < 0)
        return fd;
    snprintf(socket, sizeof socket, "--socket=%s/coord", l->folder);
    snprintf(state, sizeof state, "--state=%s/state", l->folder);
    snprintf(listen, sizeof listen, "--listen=%s", address);
    snprintf(file, sizeof file, "--keys=%s", keys);
    snprintf(ports, sizeof ports, "--ports-file=%s/ports", l->folder);
    snprintf(ready, sizeof ready, "%s/ready", l->folder);
    rc = start(&l->coordinator, l, "radcoord", options, fd, ready, err);
    close(fd); /* so that a dialler hears of the coordinator's end */
    return rc;
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
    return start(&l->workers[i], l, "radd", options, -1, "", err);
}

static int
begin(struct local *l, const char *address, const char *keys,
      struct rad_error *err)
{
    char socket[sizeof l->target.path];
    int rc;

    snprintf(socket, sizeof socket, "%s/coord", l->folder);
    if ((rc = target_parse(&l->target, socket, err)) < 0 ||
        (rc = open_notify(l, err)) < 0)
        return rc;
    return start_coordinator(l, address, keys, err);
}

int
local_coordinate(struct local *l, const char *address, const char *keys,
                 const struct link_where *where, struct rad_error *err)
{
    int rc = begin(l, address, keys, err);

    return rc < 0 ? rc : wait_ready(l, where, err);
}

int
local_start(struct local *l, int nworkers, int nthreads,
            const struct link_where *where, struct rad_error *err)
{
    int rc;

    nthreads = local_threads(nworkers, nthreads);
    l->workers = calloc((size_t)nworkers, sizeof *l->workers);
    if (!l->workers)
        return rad_fail_memory(err);
    if ((rc = begin(l, "", "", err)) < 0)
        return rc;
    for (int i = 0; i < nworkers; i++) {
        if ((rc = start_worker(l, i, nthreads, err)) < 0)
            return rc;
        l->nworkers = i + 1;
    }
    return wait_ready(l, where, err);
}

/* Link a file into the store of a daemon; both are in our folder. */
static void
link_into(const struct local *l, const char *store, const char *hash)
{
    char from[180], to[180];

    snprintf(from, sizeof from, "%s/%s", l->folder, hash);
    snprintf(to, sizeof to, "%s/%s/files", l->folder, store);
    if (rad_make_dir(to, 0700, NULL) < 0)
        return; /* so the file is sent */
    snprintf(to, sizeof to, "%s/%s/files/%s", l->folder, store, hash);
    (void)!link(from, to);
}

void
local_share(const struct local *l, const struct cargo *cargo)
{
    for (int i = 0; i < cargo->bundle->n; i++) {
        const struct rad_bundle_entry *e = &cargo->bundle->entries[i];
        char cache[32];

        if (e->size < LEAST_SHARED)
            continue;
        link_into(l, "state", e->hash);
        for (int k = 0; k < l->nworkers; k++) {
            snprintf(cache, sizeof cache, "cache-%d", k + 1);
            link_into(l, cache, e->hash);
        }
    }
}

int
local_port(const struct local *l)
{
    char path[120], line[300], *colon;
    int port = 0;
    FILE *f;

    snprintf(path, sizeof path, "%s/ports", l->folder);
    f = fopen(path, "re");
    while (f && port == 0 && fgets(line, sizeof line, f))
        if (strncmp(line, "tcp ", 4) == 0 && (colon = strrchr(line, ':')))
            port = atoi(colon + 1);
    if (f)
        fclose(f);
    return port;
}

void
local_note_group(struct local *l, pid_t group, bool ended)
{
    pid_t g = ended ? -group : group;

    /* less than PIPE_BUF is written at once or not at all */
    if (write(l->launched[1], &g, sizeof g) < 0)
        return; /* the keeper has ended */
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
        n += !ended(l, &l->workers[i]);
    return n;
}

/* Kill a daemon with its children: they are in its process group, since it
 * leads a session. */
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

bool
local_coordinated(struct local *l)
{
    return !ended(l, &l->coordinator);
}

int
local_alive(struct local *l, struct rad_error *err)
{
    if (local_coordinated(l) && local_workers(l) > 0)
        return 0;
    return rad_fail(err, l->lack ? l->lack : RAD_EINTERNAL,
                    "the cluster on this machine has ended%s",
                    l->lack == RAD_ENOMEM ? ": out of memory"
                    : l->lack             ? ": too few threads or descriptors"
                                          : "");
}

void
local_end_coordinator(struct local *l)
{
    uint64_t until = now_ms() + STOP_MS;

    if (l->coordinator > 0)
        kill(l->coordinator, SIGTERM);
    while (!ended(l, &l->coordinator) && now_ms() < until)
        poll(NULL, 0, 1);
    kill_one(&l->coordinator);
}

static bool
all_ended(struct local *l)
{
    bool all = ended(l, &l->coordinator);

    for (int i = 0; i < l->nworkers; i++)
        all &= ended(l, &l->workers[i]);
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

/* A worker waits for its job's process, so that its time counts as ours. */
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
    for (int i = 0; i < 2; i++)
        if (l->launched[i] >= 0)
            close(l->launched[i]);
    if (l->notify >= 0)
        close(l->notify);
    rad_remove_dir(l->folder);
    free(l->workers);
    free(l);
}
