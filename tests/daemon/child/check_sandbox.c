/* check_sandbox.c - what a job's child may not do, tried one by one
 *
 * Each thing is tried in a process of its own, which ends with 0 where it was
 * done, with 1 where it was refused, or by SIGSYS. */
#include "config.h"

#include "child/sandbox.h"

#include "ground/sanitized.h"
#include "tests/scarce.h"
#include "tests/scratch.h"

#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>

/* Files in the scenes' folder, which is the test's, and beside it. */
static char inside[80], outside[80], fresh[80];

static void
write_file(const char *path)
{
    int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);

    ck_assert(fd >= 0 && write(fd, "x", 1) == 1 && close(fd) == 0);
}

static void
make_files(void)
{
    scratch_make();
    snprintf(inside, sizeof inside, "%s/inside", dir);
    snprintf(fresh, sizeof fresh, "%s/fresh", dir);
    snprintf(outside, sizeof outside, "%s.outside", dir);
    write_file(inside);
    write_file(outside);
}

static void
remove_files(void)
{
    unlink(outside);
    scratch_remove();
}

FIXTURE(make_files, remove_files)

/* --- things to try: true where it worked --- */

static bool
opens(const char *path, int flags)
{
    int fd = open(path, flags, 0600);

    return fd >= 0;
}

static bool
reads_inside(void)
{
    return opens(inside, O_RDONLY);
}

static bool
reads_outside(void)
{
    return opens(outside, O_RDONLY);
}

static bool
reads_passwd(void)
{
    return opens("/etc/passwd", O_RDONLY);
}

static bool
reads_own_memory(void)
{
    return opens("/proc/self/mem", O_RDWR);
}

static bool
lists_inside(void)
{
    int fd = open(dir, O_RDONLY | O_DIRECTORY);
    char buf[1024];

    return fd >= 0 && syscall(SYS_getdents64, fd, buf, sizeof buf) > 0;
}

static bool
writes_inside(void)
{
    return opens(inside, O_WRONLY);
}

static bool
creates_inside(void)
{
    return opens(fresh, O_RDWR | O_CREAT | O_EXCL);
}

static bool
creates_by_old_call(void)
{
    return creat(fresh, 0600) >= 0;
}

static bool
removes_inside(void)
{
    return unlink(inside) == 0;
}

static bool
renames_inside(void)
{
    return rename(inside, fresh) == 0;
}

static bool
makes_tcp_socket(void)
{
    return socket(AF_INET, SOCK_STREAM, 0) >= 0;
}

static bool
makes_unix_socket(void)
{
    return socket(AF_UNIX, SOCK_DGRAM, 0) >= 0;
}

static bool
makes_netlink_socket(void)
{
    return socket(AF_NETLINK, SOCK_RAW, 0) >= 0;
}

static bool
makes_socket_pair(void)
{
    int fd[2];

    return socketpair(AF_UNIX, SOCK_STREAM, 0, fd) == 0;
}

static bool
runs_program(void)
{
    execl("/bin/true", "true", (char *)NULL);
    return false; /* it would have ended with 0 */
}

static bool
runs_command(void)
{
    return system("true") == 0;
}

static bool
starts_process(void)
{
    pid_t pid = (pid_t)syscall(SYS_clone, SIGCHLD, 0, 0, 0, 0);

    if (pid == 0)
        _exit(0);
    return pid > 0;
}

static bool
traces_parent(void)
{
    return ptrace(PTRACE_ATTACH, getppid(), 0, 0) == 0;
}

static bool
reads_parent(void)
{
    char c;
    struct iovec to = { &c, 1 }, from = { dir, 1 };

    return syscall(SYS_process_vm_readv, getppid(), &to, 1, &from, 1, 0) == 1;
}

static bool
signals_parent(void)
{
    return kill(getppid(), 0) == 0;
}

static bool
signals_parent_thread(void)
{
    return syscall(SYS_tgkill, getppid(), getppid(), 0) == 0;
}

static bool
maps_code(void)
{
    return mmap(NULL, 4096, PROT_READ | PROT_WRITE | PROT_EXEC,
                MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) != MAP_FAILED;
}

static bool
makes_code(void)
{
    void *p = mmap(NULL, 4096, PROT_READ | PROT_WRITE,
                   MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);

    return mprotect(p, 4096, PROT_READ | PROT_EXEC) == 0;
}

static bool
raises_limit(void)
{
    struct rlimit more = { 1000, 1000 };

    return setrlimit(RLIMIT_NOFILE, &more) == 0;
}

static bool
may_be_traced(void)
{
    return prctl(PR_SET_DUMPABLE, 1, 0, 0, 0) == 0;
}

static bool
leaves_namespace(void)
{
    return unshare(CLONE_NEWUSER) == 0;
}

static bool
loads_filter_program(void)
{
    char attr[64] = { 0 };

    return syscall(SYS_bpf, 0, attr, sizeof attr) >= 0;
}

static bool
opens_ring(void)
{
    char params[128] = { 0 };

    return syscall(SYS_io_uring_setup, 1, params) >= 0;
}

static void *
thread(void *arg)
{
    *(bool *)arg = true;
    return NULL;
}

static bool
starts_thread(void)
{
    bool ran = false;
    pthread_t t;

    return pthread_create(&t, NULL, thread, &ran) == 0 &&
           pthread_join(t, NULL) == 0 && ran;
}

static bool
takes_memory(void)
{
    char *p = malloc(64 << 20);

    if (!p)
        return false;
    memset(p, 1, 64 << 20);
    p = realloc(p, 128 << 20);
    free(p);
    return p != NULL;
}

static void *
opens_later(void *arg)
{
    int *attempt = arg;
    char c;

    if (read(*attempt, &c, 1) != 1) /* until the filter is on */
        return NULL;
    return reads_inside() ? arg : NULL;
}

/* A thread that was there before the folder was closed. */
static bool
old_thread_reads(void)
{
    struct rad_error err = { 0 };
    pthread_t t;
    int go[2];
    void *read_it;

    if (pipe(go) < 0 || pthread_create(&t, NULL, opens_later, &go[0]) != 0)
        return false;
    if (sandbox_seal(true, &err) < 0)
        return true; /* which the caller does not want to see */
    if (write(go[1], "x", 1) != 1)
        return true;
    pthread_join(t, &read_it);
    return read_it != NULL;
}

/* --- trying --- */

enum what {
    DIES,    /* the call ends the process; where it cannot, it fails */
    FAILS,   /* the call fails */
    WORKS,   /* it is allowed */
    FILES,   /* it fails where the kernel can confine files */
    SPECIAL, /* it fails, but for a loose sandbox */
    KILLED   /* it dies, but for a loose sandbox */
};

static const struct {
    const char *name;
    bool (*try)(void);
    enum what loading, sealed;
} table[] = {
    { "reads_inside", reads_inside, WORKS, SPECIAL },
    { "reads_outside", reads_outside, FILES, SPECIAL },
    { "reads_passwd", reads_passwd, FILES, SPECIAL },
    { "reads_own_memory", reads_own_memory, DIES, DIES },
    { "lists_inside", lists_inside, SPECIAL, SPECIAL },
    { "writes_inside", writes_inside, DIES, DIES },
    { "creates_inside", creates_inside, DIES, DIES },
    { "creates_by_old_call", creates_by_old_call, DIES, DIES },
    { "removes_inside", removes_inside, DIES, DIES },
    { "renames_inside", renames_inside, DIES, DIES },
    { "makes_tcp_socket", makes_tcp_socket, DIES, DIES },
    { "makes_unix_socket", makes_unix_socket, DIES, DIES },
    { "makes_netlink_socket", makes_netlink_socket, DIES, DIES },
    { "makes_socket_pair", makes_socket_pair, DIES, DIES },
    { "runs_program", runs_program, DIES, DIES },
    { "runs_command", runs_command, KILLED, KILLED },
    { "starts_process", starts_process, KILLED, KILLED },
    { "traces_parent", traces_parent, KILLED, KILLED },
    { "reads_parent", reads_parent, DIES, DIES },
    { "signals_parent", signals_parent, KILLED, KILLED },
    { "signals_parent_thread", signals_parent_thread, KILLED, KILLED },
    { "maps_code", maps_code, KILLED, KILLED },
    { "makes_code", makes_code, KILLED, KILLED },
    { "raises_limit", raises_limit, SPECIAL, SPECIAL },
    { "may_be_traced", may_be_traced, SPECIAL, SPECIAL },
    { "leaves_namespace", leaves_namespace, DIES, DIES },
    { "loads_filter_program", loads_filter_program, DIES, DIES },
    { "opens_ring", opens_ring, FAILS, FAILS },
    { "starts_thread", starts_thread, WORKS, WORKS },
    { "takes_memory", takes_memory, WORKS, WORKS },
    { "old_thread_reads", old_thread_reads, SPECIAL, SPECIAL },
};

/* The status of a process that tries it in the sandbox. */
static int
tried(bool (*try)(void), bool sealed)
{
    struct rad_error err = { 0 };
    int status;
    pid_t pid = fork();

    if (pid == 0) {
        if (sandbox_begin(dir, true, &err) < 0 ||
            (sealed && sandbox_seal(true, &err) < 0)) {
            fprintf(stderr, "%s\n", err.what);
            _exit(2);
        }
        _exit(try() ? 0 : 1);
    }
    ck_assert_int_eq(waitpid(pid, &status, 0), pid);
    return status;
}

static void
check_tried(int i, bool sealed)
{
    enum what what = sealed ? table[i].sealed : table[i].loading;
    const char *name = table[i].name;
    bool lacking, loose = RAD_SANITIZED;
    int status;

    if (what == FILES && sandbox_lacks(&lacking))
        return; /* no Landlock here */
    if (loose && (what == FILES || what == SPECIAL || what == KILLED))
        return; /* a sanitizer needs it; and it would stop this process */
    status = tried(table[i].try, sealed);
    if (!loose && (what == DIES || what == KILLED)) {
        ck_assert_msg(WIFSIGNALED(status) && WTERMSIG(status) == SIGSYS,
                      "%s: status %#x, not killed", name, (unsigned)status);
        return;
    }
    ck_assert_msg(WIFEXITED(status), "%s: status %#x", name, (unsigned)status);
    ck_assert_msg(WEXITSTATUS(status) == (what == WORKS ? 0 : 1), "%s: %s",
                  name, WEXITSTATUS(status) ? "was refused" : "was done");
}

LOOP_TEST(while_loading_only_its_folder_is_open, N_ELEM(table))
{
    check_tried(_i, false);
}

LOOP_TEST(once_loaded_nothing_is, N_ELEM(table))
{
    check_tried(_i, true);
}

enum { NO_MORE = 3 }; /* exit status: nothing was left to refuse */

/* The status of a process whose sandbox lacks the memory of one allocation; an
 * exit with 1: that sandbox is on, and does not keep it from opening files.
 * libseccomp may end such a process, or try for ever. */
static int
begun_without(long allocation, bool sealed)
{
    struct rlimit patience = { 1, 2 }; /* s of processor time */
    int status, rc;
    pid_t pid = fork();

    if (pid == 0) {
        if (freopen("/dev/null", "w", stderr) == NULL)
            _exit(2);
        setrlimit(RLIMIT_CPU, &patience);
        if (sealed && sandbox_begin(dir, true, NULL) < 0)
            _exit(2);
        scarce_at = allocation;
        rc = sealed ? sandbox_seal(false, NULL)
                    : sandbox_begin(dir, false, NULL);
        if (scarce_at > 0)
            _exit(NO_MORE);
        _exit(rc == 0 && opens(inside, sealed ? O_RDONLY : O_WRONLY) ? 1 : 0);
    }
    ck_assert_int_eq(waitpid(pid, &status, 0), pid);
    return status;
}

static void
check_begun_without(long allocation, bool sealed, int *status)
{
    *status = begun_without(allocation, sealed);
    ck_assert_msg(!WIFEXITED(*status) || WEXITSTATUS(*status) == 0 ||
                      WEXITSTATUS(*status) == NO_MORE,
                  "allocation %ld: status %#x", allocation, (unsigned)*status);
}

/* Even where the sandbox is not required. */
TEST(what_lacks_memory_is_no_sandbox)
{
    int status = 0;

    for (long i = 1; i <= 10; i++)
        check_begun_without(i, false, &status);
    for (long i = 1; !WIFEXITED(status) || WEXITSTATUS(status) != NO_MORE; i++)
        check_begun_without(i, true, &status);
}

/* How it crashed must still be told. */
TEST(an_abort_is_an_abort)
{
    int status;
    pid_t pid = fork();

    if (pid == 0) {
        sandbox_begin(dir, true, NULL);
        sandbox_seal(true, NULL);
        abort();
    }
    ck_assert_int_eq(waitpid(pid, &status, 0), pid);
    ck_assert(WIFSIGNALED(status));
    ck_assert_int_eq(WTERMSIG(status), SIGABRT);
    ck_assert(!WCOREDUMP(status));
}

int
main(void)
{
    bool refuse;

    sandbox_lacks(&refuse);
    if (refuse) {
        puts("SKIP: no seccomp here");
        return 77;
    }
    return unit_run();
}
