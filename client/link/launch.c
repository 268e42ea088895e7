/* launch.c - see launch.h */
#include "config.h"

#include "link/launch.h"

#include "link/programs.h"
#include "link/target.h"
#include "net/address.h"
#include "net/key/keyfile.h"

#include <errno.h>
#include <fcntl.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>
#include <uv.h>

enum {
    LOOK_MS = 20,
    SETTLE_MS = 500, /* most time between workers that start together */
    GONE_MS = 10000, /* without any worker; a lost one dials again */
    LEAVE_MS = 5000, /* for workers to notice the coordinator's end */
    KILL_MS = 2000,  /* for launchers to end after a signal */
    SAY_MS = 2000    /* least time between two lists of workers */
};

static const char key_name[] = "worker:launched";
static const char variable[] = "RADD_LAUNCH_KEY";

struct launcher {
    pid_t pid;  /* also its process group */
    bool ended; /* but not waited for, so pid stays reserved */
    int how;    /* CLD_EXITED, or another code of waitid() */
    int status; /* exit status, or signal */
};

struct launch {
    struct local *local;
    struct launch_order order;
    struct launcher *v;
    int n;
    char dial[LAUNCH_ADDRESS]; /* HOST:PORT of the coordinator, for workers */
    int workers;               /* connected or, later, taking part in the job */
    bool came;                 /* a worker was connected at some time */
    uint64_t begin_ms;
    uint64_t changed_ms; /* when `workers` last changed or was above 0 */
    int said;            /* how many workers the last list named */
    uint64_t said_ms;    /* when that was */
};

static uint64_t
now_ms(void)
{
    return uv_hrtime() / 1000000;
}

/* --- the command --- */

bool
launch_each(const char *command)
{
    for (const char *p = command; (p = strchr(p, '%')) != NULL; p += 2)
        if (p[1] == 'd')
            return true;
        else if (p[1] == '\0')
            return false;
    return false;
}

char *
launch_command(const char *command, int number)
{
    char digits[16], *text, *to;
    size_t places = 0;

    for (const char *p = command; *p; p++)
        places += *p == '%';
    snprintf(digits, sizeof digits, "%d", number);
    text = to = malloc(strlen(command) + places * sizeof digits + 1);
    for (const char *p = command; text && *p; p++) {
        bool mark = p[0] == '%' && (p[1] == 'd' || p[1] == '%');

        if (mark && p[1] == 'd')
            to = stpcpy(to, digits);
        else
            *to++ = *p;
        p += mark;
    }
    if (text)
        *to = '\0';
    return text;
}

/* --- the coordinator's address --- */

/* This machine's address for outgoing packets; finding it sends none. */
static bool
outgoing(struct sockaddr_in *mine)
{
    struct sockaddr_in to = { .sin_family = AF_INET,
                              .sin_port = htons(9),
                              .sin_addr = {
                                  htonl(0xc0000201) } }; /* TEST-NET */
    socklen_t size = sizeof *mine;
    int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    bool found = fd >= 0 &&
                 connect(fd, (struct sockaddr *)&to, sizeof to) == 0 &&
                 getsockname(fd, (struct sockaddr *)mine, &size) == 0;

    if (fd >= 0)
        close(fd);
    return found;
}

/* The first address of an interface that is not the loopback. */
static bool
first_interface(struct sockaddr_in *mine)
{
    struct ifaddrs *all = NULL;
    bool found = false;

    if (getifaddrs(&all) != 0)
        return false;
    for (const struct ifaddrs *i = all; i && !found; i = i->ifa_next)
        if (i->ifa_addr && i->ifa_addr->sa_family == AF_INET &&
            (i->ifa_flags & IFF_UP) && !(i->ifa_flags & IFF_LOOPBACK)) {
            memcpy(mine, i->ifa_addr, sizeof *mine);
            found = true;
        }
    freeifaddrs(all);
    return found;
}

static void
choose_address(char text[LAUNCH_ADDRESS])
{
    struct address a = { .sa.in = { .sin_family = AF_INET } };
    char format[ADDRESS_TEXT];

    if (!outgoing(&a.sa.in) && !first_interface(&a.sa.in))
        a.sa.in.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    a.sa.in.sin_port = 0;
    address_format(&a, format);
    snprintf(text, LAUNCH_ADDRESS, "%s", format);
}

int
launch_address(const char *given, char dial[LAUNCH_ADDRESS],
               char listen[LAUNCH_ADDRESS], struct rad_error *err)
{
    char host[ADDRESS_TEXT], port[8];
    bool local;
    int rc;

    if (!given) {
        choose_address(dial);
        memcpy(listen, dial, LAUNCH_ADDRESS);
        return 0;
    }
    if (strlen(given) >= ADDRESS_TEXT || strchr(given, '/') || !given[0])
        return rad_fail(err, RAD_EUSAGE,
                        "--address: expected HOST or HOST:PORT, got '%.60s'",
                        given);
    target_complete(dial, LAUNCH_ADDRESS, given, "0");
    if ((rc = address_split(dial, host, port, &local, err)) < 0)
        return rc;
    /* all addresses: a host's own name may stand for one that only the host has
     */
    snprintf(listen, LAUNCH_ADDRESS, "*:%s", port);
    return 0;
}

/* --- the key --- */

static int
write_private(const char *path, const char *text, struct rad_error *err)
{
    size_t n = strlen(text);
    int fd = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    bool whole = fd >= 0 && write(fd, text, n) == (ssize_t)n;

    if (!whole)
        rad_fail(err, RAD_ECANTCREAT, "cannot write '%s': %s", path,
                 strerror(errno));
    if (fd >= 0)
        close(fd);
    return whole ? 0 : err->code;
}

/* Make the job's key: write the coordinator's key file, and return its line. */
static int
make_key(const char *path, char line[KEY_LINE + 1], struct rad_error *err)
{
    struct keyfile f;
    int rc;

    keyfile_init(&f);
    rc = keyfile_add(&f, key_name, 0, err);
    if (rc == 0)
        rc = write_private(path, f.text, err);
    if (rc == 0)
        key_format(&f.v[f.n - 1], line);
    keyfile_release(&f);
    return rc;
}

/* --- launchers --- */

/* The reading end of a pipe that gives the line and then ends; negative on
 * failure. */
static int
line_to_read(const char *line)
{
    int fd[2];
    bool whole;

    if (pipe2(fd, O_CLOEXEC) != 0)
        return -1;
    whole = write(fd[1], line, strlen(line)) == (ssize_t)strlen(line) &&
            write(fd[1], "\n", 1) == 1;
    close(fd[1]);
    if (whole)
        return fd[0];
    close(fd[0]);
    return -1;
}

static int
run_command(struct launch *l, const char *text, const char *line, char **env,
            struct rad_error *err)
{
    char path[4200], coordinator[LAUNCH_ADDRESS + 20], threads[32];
    const char *argv[] = { "/bin/sh",
                           "-c",
                           text,
                           "sh",
                           path,
                           "--embedded",
                           "--launched",
                           coordinator,
                           "--nice=0",
                           "--log-level=err",
                           l->order.threads ? threads : NULL,
                           NULL };
    struct launcher *one = &l->v[l->n];
    int in = line_to_read(line), rc;

    programs_path("radd", path, sizeof path);
    snprintf(coordinator, sizeof coordinator, "--coordinator=%s", l->dial);
    snprintf(threads, sizeof threads, "--threads=%d", l->order.threads);
    if (in < 0)
        return rad_fail(err, RAD_ENOMEM, "cannot make a pipe: %s",
                        strerror(errno));
    rc = programs_spawn(&one->pid, (char *const *)argv, env, in, -1);
    close(in);
    if (rc != 0)
        return programs_not_started(argv[0], rc, err);
    local_note_group(l->local, one->pid, false);
    l->n++;
    return 0;
}

/* Run COMMAND, once or for each worker. */
static int
run_all(struct launch *l, const char *line, struct rad_error *err)
{
    int times = launch_each(l->order.command) ? l->order.workers : 1, rc = 0;
    char setting[sizeof variable + KEY_LINE + 2], **env;

    /* or srun would end all workers when one host is lost */
    setenv("SLURM_NO_KILL", "set", 0);
    setenv("SLURM_KILL_BAD_EXIT", "0", 0);
    snprintf(setting, sizeof setting, "%s=%s", variable, line);
    env = programs_environment(setting);
    l->v = calloc((size_t)times, sizeof *l->v);
    if (!env || !l->v)
        rc = rad_fail_memory(err);
    for (int i = 1; rc == 0 && i <= times; i++) {
        char *text = launch_command(l->order.command, i), *whole = NULL;

        if (!text || asprintf(&whole, "%s \"$@\"", text) < 0)
            rc = rad_fail_memory(err);
        else
            rc = run_command(l, whole, line, env, err);
        free(text);
        free(whole);
    }
    explicit_bzero(setting, sizeof setting);
    free(env);
    return rc;
}

int
launch_start(struct launch **out, struct local *local,
             const struct launch_order *order, const struct link_where *where,
             struct rad_error *err)
{
    struct launch *l = *out = calloc(1, sizeof *l);
    char listen[LAUNCH_ADDRESS], path[120];
    char line[KEY_LINE + 1];
    int rc;

    if (!l)
        return rad_fail_memory(err);
    l->local = local;
    l->order = *order;
    snprintf(path, sizeof path, "%s/keys", local_folder(local));
    if ((rc = launch_address(order->address, l->dial, listen, err)) < 0 ||
        (rc = make_key(path, line, err)) < 0)
        return rc;
    rc = local_coordinate(local, listen, path, where, err);
    if (rc == 0) {
        snprintf(strrchr(l->dial, ':'), 8, ":%d", local_port(local));
        rc = run_all(l, line, err);
    }
    explicit_bzero(line, sizeof line);
    l->begin_ms = l->changed_ms = l->said_ms = now_ms();
    return rc;
}

/* --- while launchers run --- */

/* Notice launchers that have ended; returns how many still run. */
static int
running(struct launch *l)
{
    int n = 0;

    for (int i = 0; i < l->n; i++) {
        struct launcher *one = &l->v[i];
        siginfo_t end = { .si_pid = 0 };

        if (!one->ended &&
            waitid(P_PID, (id_t)one->pid, &end, WEXITED | WNOHANG | WNOWAIT) ==
                0 &&
            end.si_pid == one->pid) {
            one->ended = true;
            one->how = end.si_code;
            one->status = end.si_status;
        }
        n += !one->ended;
    }
    return n;
}

/* Describe how the first launcher that failed ended; false: none has failed. */
static bool
failed(struct launch *l, char *text, size_t size)
{
    for (int i = 0; i < l->n; i++) {
        const struct launcher *one = &l->v[i];
        char which[24] = "";

        if (!one->ended || one->status == 0)
            continue;
        if (launch_each(l->order.command))
            snprintf(which, sizeof which, " of worker %d", i + 1);
        snprintf(text, size, "the launcher%s ended with %s %d", which,
                 one->how == CLD_EXITED ? "status" : "signal", one->status);
        return true;
    }
    return false;
}

void
launch_note_workers(struct launch *l, int n)
{
    if (n != l->workers || n > 0)
        l->changed_ms = now_ms();
    l->workers = n;
}

int
launch_gathered(struct launch *l, int n, const char *names, bool *news,
                struct rad_error *err)
{
    uint64_t t = now_ms();
    bool waited = (double)(t - l->begin_ms) >= 1000 * l->order.wait_s;
    bool enough = n >= l->order.workers;
    char how[80];

    running(l);
    if (n != l->workers)
        l->changed_ms = t;
    enough = enough && (waited || t - l->changed_ms >= SETTLE_MS);
    *news = n != l->said && (enough || t - l->said_ms >= SAY_MS);
    if (*news) {
        l->said = n;
        l->said_ms = t;
    }
    l->workers = n;
    l->came |= n > 0;
    if (enough)
        return 1;
    if (n < l->order.workers && failed(l, how, sizeof how))
        return rad_fail(err, RAD_EUNAVAIL,
                        "%s: %d of %d workers came to %s%s%s", how, n,
                        l->order.workers, l->dial, n ? ": " : "", names);
    if (waited)
        return rad_fail(err, RAD_EUNAVAIL,
                        "%d of %d workers came to %s in %g s%s%s%s", n,
                        l->order.workers, l->dial, l->order.wait_s,
                        running(l) == 0 ? ", and the launcher has ended" : "",
                        n ? ": " : "", names);
    return 0;
}

int
launch_alive(struct launch *l, struct rad_error *err)
{
    uint64_t ms = now_ms() - l->changed_ms;
    bool runs = running(l) > 0;
    char how[80];

    if (!local_coordinated(l->local))
        return rad_fail(err, RAD_EINTERNAL,
                        "the coordinator of this job has ended");
    if (l->workers > 0 || ms < GONE_MS ||
        (runs && (double)ms < 1000 * l->order.wait_s))
        return 0;
    if (failed(l, how, sizeof how))
        return rad_fail(err, RAD_EUNAVAIL, "no worker is left: %s", how);
    return rad_fail(err, RAD_EUNAVAIL, "no worker is left");
}

/* --- stopping --- */

/* Do any launchers, or processes in their groups, still run?  A launcher that
 * has ended is waited for here; its group's number stays reserved while any
 * process is in the group. */
static bool
are_left(struct launch *l)
{
    bool left = running(l) > 0;

    for (int i = 0; i < l->n; i++) {
        struct launcher *one = &l->v[i];

        if (one->pid == 0 || !one->ended)
            continue;
        waitpid(one->pid, NULL, WNOHANG);
        if (kill(-one->pid, 0) == 0) {
            left = true;
            continue;
        }
        local_note_group(l->local, one->pid, true);
        one->pid = 0;
    }
    return left;
}

static bool
end_within(struct launch *l, int ms)
{
    uint64_t until = now_ms() + (uint64_t)ms;

    while (are_left(l) && now_ms() < until)
        poll(NULL, 0, LOOK_MS);
    return !are_left(l);
}

static void
signal_all(struct launch *l, int signum)
{
    for (int i = 0; i < l->n; i++)
        if (l->v[i].pid > 0)
            kill(-l->v[i].pid, signum);
}

void
launch_stop(struct launch *l)
{
    if (!l)
        return;
    local_end_coordinator(l->local);
    if (!end_within(l, l->came ? LEAVE_MS : 0)) {
        signal_all(l, SIGTERM);
        if (!end_within(l, KILL_MS))
            signal_all(l, SIGKILL);
        end_within(l, KILL_MS);
    }
    free(l->v);
    free(l);
}
