/* sandbox.c - see sandbox.h
 *
 * Two filters: the first, a list of permitted calls, is put on before a scene
 * is read; the second forbids opening files.  Both let the processor speculate
 * (SCMP_FLTATR_CTL_SSB): otherwise kernels before 5.16 make every load wait for
 * the stores before it.  That would cost a renderer a tenth of its speed and
 * more, to protect secrets that this process does not have.
 *
 * A filter cannot see the flags of clone3, so clone3 fails as in a kernel
 * without it.  The C library then calls clone, whose flags tell threads from
 * processes. */
#include "config.h"

#include "child/sandbox.h"

#include "base/list.h"
#include "ground/filter.h"
#include "ground/sanitized.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

/* Most open descriptors: the link, the loop's, one file while loading. */
#define MOST_FILES 64
/* Flags of open that ask for more than reading. */
#define WRITES (O_WRONLY | O_RDWR | O_CREAT | O_TRUNC | O_APPEND)

/* --- the lists --- */

/* clang-format off */

/* Calls that are allowed with any arguments. */
static const int allowed[] = {
    SCMP_SYS(brk), SCMP_SYS(clock_getres), SCMP_SYS(clock_gettime),
    SCMP_SYS(clock_nanosleep), SCMP_SYS(close), SCMP_SYS(epoll_create1),
    SCMP_SYS(epoll_ctl), SCMP_SYS(epoll_pwait), SCMP_SYS(epoll_pwait2),
    SCMP_SYS(epoll_wait), SCMP_SYS(eventfd2), SCMP_SYS(exit),
    SCMP_SYS(exit_group), SCMP_SYS(fstat), SCMP_SYS(futex), SCMP_SYS(getcpu),
    SCMP_SYS(get_robust_list), SCMP_SYS(getpid), SCMP_SYS(getppid),
    SCMP_SYS(getpriority), SCMP_SYS(getrandom), SCMP_SYS(getrusage),
    SCMP_SYS(gettid), SCMP_SYS(gettimeofday), SCMP_SYS(lseek),
    SCMP_SYS(madvise), SCMP_SYS(membarrier), SCMP_SYS(mremap), SCMP_SYS(munmap),
    SCMP_SYS(nanosleep), SCMP_SYS(pipe2), SCMP_SYS(poll), SCMP_SYS(ppoll),
    SCMP_SYS(pread64), SCMP_SYS(read), SCMP_SYS(readv),
    SCMP_SYS(restart_syscall), SCMP_SYS(rseq), SCMP_SYS(rt_sigaction),
    SCMP_SYS(rt_sigprocmask), SCMP_SYS(rt_sigreturn),
    SCMP_SYS(sched_getaffinity), SCMP_SYS(sched_yield), SCMP_SYS(seccomp),
    SCMP_SYS(set_robust_list), SCMP_SYS(set_tid_address), SCMP_SYS(shutdown),
    SCMP_SYS(sigaltstack), SCMP_SYS(sysinfo), SCMP_SYS(time), SCMP_SYS(uname),
    SCMP_SYS(write), SCMP_SYS(writev),
};

/* Calls that libraries try and can do without: they fail with this errno. */
static const struct {
    int call, with;
} probed[] = {
    { SCMP_SYS(access), EACCES },     { SCMP_SYS(clone3), ENOSYS },
    { SCMP_SYS(faccessat), EACCES },  { SCMP_SYS(faccessat2), EACCES },
    { SCMP_SYS(getcwd), EACCES },     { SCMP_SYS(getdents64), EACCES },
    { SCMP_SYS(getsockopt), EACCES }, { SCMP_SYS(io_uring_setup), ENOSYS },
    { SCMP_SYS(lstat), EACCES },      { SCMP_SYS(openat2), ENOSYS },
    { SCMP_SYS(readlink), EACCES },   { SCMP_SYS(readlinkat), EACCES },
    { SCMP_SYS(setsockopt), EACCES }, { SCMP_SYS(stat), EACCES },
    { SCMP_SYS(statx), ENOSYS },
};

/* Calls that the loose filter denies; it allows all others. */
static const int denied[] = {
    SCMP_SYS(accept), SCMP_SYS(accept4), SCMP_SYS(bind), SCMP_SYS(bpf),
    SCMP_SYS(connect), SCMP_SYS(creat), SCMP_SYS(execve), SCMP_SYS(execveat),
    SCMP_SYS(fork), SCMP_SYS(io_uring_setup), SCMP_SYS(link), SCMP_SYS(linkat),
    SCMP_SYS(listen), SCMP_SYS(mkdir), SCMP_SYS(mkdirat), SCMP_SYS(mknod),
    SCMP_SYS(mknodat), SCMP_SYS(mount), SCMP_SYS(openat2),
    SCMP_SYS(process_vm_readv), SCMP_SYS(process_vm_writev), SCMP_SYS(rename),
    SCMP_SYS(renameat), SCMP_SYS(renameat2), SCMP_SYS(sendmsg),
    SCMP_SYS(sendto), SCMP_SYS(setns), SCMP_SYS(socket), SCMP_SYS(socketpair),
    SCMP_SYS(symlink), SCMP_SYS(symlinkat), SCMP_SYS(truncate),
    SCMP_SYS(unlink), SCMP_SYS(unlinkat), SCMP_SYS(unshare), SCMP_SYS(vfork),
};

/* clang-format on */

/* Argument number n is x; is not x; is x in the bits of the mask.  The
 * library's own macros leave a field unnamed, which compilers warn of. */
/* clang-format off */
#define EQUAL(n, x) \
    { .arg = (n), .op = SCMP_CMP_EQ, .datum_a = (uint32_t)(x) }
#define OTHER(n, x) \
    { .arg = (n), .op = SCMP_CMP_NE, .datum_a = (uint32_t)(x) }
#define MASKED(n, mask, x) \
    { .arg = (n), .op = SCMP_CMP_MASKED_EQ, .datum_a = (mask), .datum_b = (x) }
/* clang-format on */

/* Calls that are allowed or denied by an argument.  Any rule of a call that
 * fits decides; if none fits the filter's default does. */
static const struct rule {
    int call;
    unsigned with; /* errno; 0: allowed */
    struct scmp_arg_cmp arg;
} rules[] = {
    { SCMP_SYS(open), 0, MASKED(1, WRITES, 0) },
    { SCMP_SYS(openat), 0, MASKED(2, WRITES, 0) },
    { SCMP_SYS(newfstatat), 0, MASKED(3, AT_EMPTY_PATH, AT_EMPTY_PATH) },
    { SCMP_SYS(newfstatat), EACCES, MASKED(3, AT_EMPTY_PATH, 0) },
    { SCMP_SYS(mmap), 0, MASKED(2, PROT_EXEC, 0) },
    { SCMP_SYS(mprotect), 0, MASKED(2, PROT_EXEC, 0) },
    { SCMP_SYS(clone), 0, MASKED(0, CLONE_THREAD, CLONE_THREAD) },
    { SCMP_SYS(ioctl), 0, EQUAL(1, FIONBIO) },
    { SCMP_SYS(ioctl), 0, EQUAL(1, FIOCLEX) },
    { SCMP_SYS(ioctl), ENOTTY, EQUAL(1, TCGETS) },
    { SCMP_SYS(fcntl), 0, EQUAL(1, F_GETFL) },
    { SCMP_SYS(fcntl), 0, EQUAL(1, F_SETFL) },
    { SCMP_SYS(fcntl), 0, EQUAL(1, F_GETFD) },
    { SCMP_SYS(fcntl), 0, EQUAL(1, F_SETFD) },
    { SCMP_SYS(prctl), 0, EQUAL(0, PR_SET_NAME) },
    /* names of mappings, and calls that later libraries may try */
    { SCMP_SYS(prctl), EPERM, OTHER(0, PR_SET_NAME) },
    /* a limit may be read, not set */
    { SCMP_SYS(prlimit64), 0, EQUAL(2, 0) },
    { SCMP_SYS(prlimit64), EPERM, OTHER(2, 0) },
};

/* Calls that even the loose filter denies by an argument. */
static const struct rule loose_rules[] = {
    { SCMP_SYS(open), EACCES, MASKED(1, O_CREAT, O_CREAT) },
    { SCMP_SYS(open), EACCES, MASKED(1, O_ACCMODE, O_WRONLY) },
    { SCMP_SYS(open), EACCES, MASKED(1, O_ACCMODE, O_RDWR) },
    { SCMP_SYS(openat), EACCES, MASKED(2, O_CREAT, O_CREAT) },
    { SCMP_SYS(openat), EACCES, MASKED(2, O_ACCMODE, O_WRONLY) },
    { SCMP_SYS(openat), EACCES, MASKED(2, O_ACCMODE, O_RDWR) },
};

/* --- seccomp --- */

/* valgrind makes the calls of its process itself, and others of its own. */
static bool
in_valgrind(void)
{
    const char *v = getenv("LD_PRELOAD");

    return v && strstr(v, "/vgpreload_");
}

static int
add_rules(scmp_filter_ctx f, const struct rule *r, size_t n)
{
    int rc = 0;

    for (size_t i = 0; i < n && rc == 0; i++)
        rc = seccomp_rule_add(
            f, r[i].with ? SCMP_ACT_ERRNO(r[i].with) : SCMP_ACT_ALLOW,
            r[i].call, 1, r[i].arg);
    return rc;
}

/* Allow signals to the process itself: for abort() and raise(). */
static int
add_own_signals(scmp_filter_ctx f)
{
    struct scmp_arg_cmp own = EQUAL(0, getpid());

    return seccomp_rule_add(f, SCMP_ACT_ALLOW, SCMP_SYS(tgkill), 1, own);
}

static int
set_attributes(scmp_filter_ctx f)
{
    int rc = seccomp_attr_set(f, SCMP_FLTATR_CTL_NNP, 0); /* is set already */

    if (rc == 0)
        rc = seccomp_attr_set(f, SCMP_FLTATR_CTL_SSB, 1);
    if (rc == 0) /* a binary search among calls, not a walk */
        rc = seccomp_attr_set(f, SCMP_FLTATR_CTL_OPTIMIZE, 2);
    return rc;
}

static int
fill_strict(scmp_filter_ctx f)
{
    int rc = set_attributes(f);

    for (size_t i = 0; i < N_ELEM(allowed) && rc == 0; i++)
        rc = seccomp_rule_add(f, SCMP_ACT_ALLOW, allowed[i], 0);
    for (size_t i = 0; i < N_ELEM(probed) && rc == 0; i++)
        rc = seccomp_rule_add(f, SCMP_ACT_ERRNO((unsigned)probed[i].with),
                              probed[i].call, 0);
    if (rc == 0)
        rc = add_rules(f, rules, N_ELEM(rules));
    return rc == 0 ? add_own_signals(f) : rc;
}

static int
fill_loose(scmp_filter_ctx f)
{
    int rc = set_attributes(f);

    for (size_t i = 0; i < N_ELEM(denied) && rc == 0; i++)
        rc = seccomp_rule_add(f, SCMP_ACT_ERRNO(EPERM), denied[i], 0);
    return rc == 0 ? add_rules(f, loose_rules, N_ELEM(loose_rules)) : rc;
}

static int
fill_seal(scmp_filter_ctx f)
{
    static const int opening[] = { SCMP_SYS(open), SCMP_SYS(openat),
                                   SCMP_SYS(creat), SCMP_SYS(openat2) };
    int rc = set_attributes(f);

    for (size_t i = 0; i < N_ELEM(opening) && rc == 0; i++)
        rc = seccomp_rule_add(f, SCMP_ACT_ERRNO(EACCES), opening[i], 0);
    return rc;
}

static bool
has_seccomp(void)
{
    uint32_t kill = SECCOMP_RET_KILL_PROCESS;

    return !in_valgrind() &&
           syscall(SYS_seccomp, SECCOMP_GET_ACTION_AVAIL, 0, &kill) == 0;
}

/* --- Landlock --- */

static int
landlock_version(void)
{
    return (int)syscall(SYS_landlock_create_ruleset, NULL, 0,
                        LANDLOCK_CREATE_RULESET_VERSION);
}

/* All access to files that this kernel can deny: versions 2, 3 and 5 know one
 * bit more each. */
static uint64_t
landlock_files(int version)
{
    uint64_t bits = (1u << 13) - 1;

    if (version >= 2)
        bits |= 1u << 13;
    if (version >= 3)
        bits |= 1u << 14;
    if (version >= 5)
        bits |= 1u << 15;
    return bits;
}

/* Allow to read files below the folder by name, not to list it; 0 or a negative
 * errno. */
static int
confine_files(const char *files_dir)
{
    struct landlock_ruleset_attr all = { 0 };
    struct landlock_path_beneath_attr dir = {
        .allowed_access = LANDLOCK_ACCESS_FS_READ_FILE
    };
    int version = landlock_version(), rules_fd, rc;

    if (version < 1)
        return -ENOSYS;
    all.handled_access_fs = landlock_files(version);
    rules_fd = (int)syscall(SYS_landlock_create_ruleset, &all,
                            sizeof all.handled_access_fs, 0);
    if (rules_fd < 0)
        return -errno;
    dir.parent_fd = open(files_dir, O_PATH | O_DIRECTORY | O_CLOEXEC);
    rc = dir.parent_fd < 0 ||
                 syscall(SYS_landlock_add_rule, rules_fd,
                         LANDLOCK_RULE_PATH_BENEATH, &dir, 0) < 0 ||
                 syscall(SYS_landlock_restrict_self, rules_fd, 0) < 0
             ? -errno
             : 0;
    if (dir.parent_fd >= 0)
        close(dir.parent_fd);
    close(rules_fd);
    return rc;
}

/* --- public --- */

const char *
sandbox_lacks(bool *refuse)
{
    bool landlock = RAD_SANITIZED || landlock_version() >= 1;

    *refuse = !has_seccomp();
    if (*refuse)
        return landlock ? "seccomp" : "seccomp, Landlock";
    return landlock ? NULL : "Landlock";
}

/* Close descriptors that were inherited by mistake. */
static void
close_others(void)
{
#ifdef SYS_close_range
    syscall(SYS_close_range, 4u, ~0u, 0u);
#endif
}

/* A kernel may lack a sandbox that is not required; memory may not. */
static int
failed(int rc, bool required, struct rad_error *err)
{
    if (rc == -ENOMEM)
        return rad_fail_memory(err);
    return rc < 0 && required
               ? rad_fail(err, RAD_EPERM, "no sandbox: %s", strerror(-rc))
               : 0;
}

int
sandbox_begin(const char *files_dir, bool required, struct rad_error *err)
{
    struct rlimit none = { 0, 0 }, files = { MOST_FILES, MOST_FILES };

    setrlimit(RLIMIT_CORE, &none);
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) < 0)
        return failed(-errno, required, err);
    if (!RAD_SANITIZED && !in_valgrind()) {
        close_others();
        setrlimit(RLIMIT_NOFILE, &files);
        prctl(PR_SET_DUMPABLE, 0);
        confine_files(files_dir); /* where the kernel can */
    }
    if (!has_seccomp())
        return failed(-ENOSYS, required, err);
    if (RAD_SANITIZED)
        return failed(filter_put_on(SCMP_ACT_ALLOW, fill_loose), required, err);
    return failed(filter_put_on(SCMP_ACT_KILL_PROCESS, fill_strict), required,
                  err);
}

int
sandbox_seal(bool required, struct rad_error *err)
{
    if (RAD_SANITIZED || !has_seccomp())
        return 0; /* as in sandbox_begin(); radd has told that it is lacking */
    return failed(filter_put_on(SCMP_ACT_ALLOW, fill_seal), required, err);
}
