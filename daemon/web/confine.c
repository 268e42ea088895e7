/* confine.c - see confine.h
 *
 * The list names the system calls that are denied.  A job's child has a list of
 * allowed calls instead.  radweb cannot have such a list: when it dials again
 * it looks up names, for which the C library may read any files and ask any
 * servers. */
#include "config.h"

#include "web/confine.h"

#include "base/list.h"
#include "ground/filter.h"
#include "ground/sanitized.h"
#include "net/log.h"

#include <errno.h>
#include <fcntl.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>

/* Linux has it since 6.6, on every architecture with this number; headers and
 * libseccomp of Debian 12 do not know its name. */
#define FCHMODAT2 452

/* clang-format off */
static const int denied[] = {
    SCMP_SYS(acct), SCMP_SYS(bpf), SCMP_SYS(chmod), SCMP_SYS(chown),
    SCMP_SYS(chroot), SCMP_SYS(creat), SCMP_SYS(delete_module),
    SCMP_SYS(execve), SCMP_SYS(execveat), SCMP_SYS(fchmod),
    SCMP_SYS(fchmodat), SCMP_SYS(fchown), SCMP_SYS(fchownat),
    SCMP_SYS(finit_module), SCMP_SYS(fork), SCMP_SYS(init_module),
    SCMP_SYS(io_uring_setup), SCMP_SYS(kexec_load), SCMP_SYS(keyctl),
    SCMP_SYS(link), SCMP_SYS(linkat), SCMP_SYS(mkdir), SCMP_SYS(mkdirat),
    SCMP_SYS(mknod), SCMP_SYS(mknodat), SCMP_SYS(mount), SCMP_SYS(openat2),
    SCMP_SYS(perf_event_open), SCMP_SYS(pivot_root),
    SCMP_SYS(process_vm_readv), SCMP_SYS(process_vm_writev), SCMP_SYS(ptrace),
    SCMP_SYS(reboot), SCMP_SYS(rename), SCMP_SYS(renameat),
    SCMP_SYS(renameat2), SCMP_SYS(rmdir), SCMP_SYS(setns), SCMP_SYS(swapon),
    SCMP_SYS(symlink), SCMP_SYS(symlinkat), SCMP_SYS(truncate),
    SCMP_SYS(umount2), SCMP_SYS(unlink), SCMP_SYS(unlinkat),
    SCMP_SYS(unshare), SCMP_SYS(userfaultfd), SCMP_SYS(vfork),
    FCHMODAT2,
};

#define MASKED(n, mask, x) \
    { .arg = (n), .op = SCMP_CMP_MASKED_EQ, .datum_a = (mask), .datum_b = (x) }
static const struct {
    int call;
    struct scmp_arg_cmp arg;
} rules[] = {
    { SCMP_SYS(open), MASKED(1, O_CREAT, O_CREAT) },
    { SCMP_SYS(openat), MASKED(2, O_CREAT, O_CREAT) },
    { SCMP_SYS(open), MASKED(1, O_TRUNC, O_TRUNC) },
    { SCMP_SYS(openat), MASKED(2, O_TRUNC, O_TRUNC) },
    { SCMP_SYS(clone), MASKED(0, CLONE_THREAD, 0) },
};
/* clang-format on */

static int
fill(scmp_filter_ctx f)
{
    int rc = 0;

    for (size_t i = 0; i < N_ELEM(denied) && rc == 0; i++)
        rc = seccomp_rule_add(f, SCMP_ACT_ERRNO(EPERM), denied[i], 0);
    for (size_t i = 0; i < N_ELEM(rules) && rc == 0; i++)
        rc = seccomp_rule_add(f, SCMP_ACT_ERRNO(EPERM), rules[i].call, 1,
                              rules[i].arg);
    if (rc == 0) /* clone3's flags are in memory, which a filter cannot read;
                  * libc falls back on clone */
        rc = seccomp_rule_add(f, SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(clone3), 0);
    return rc;
}

int
confine_begin(struct rad_error *err)
{
    struct rlimit none = { 0, 0 };
    int rc;

    if (RAD_SANITIZED)
        return 0;
    setrlimit(RLIMIT_CORE, &none);
    prctl(PR_SET_DUMPABLE, 0);
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) < 0)
        return rad_fail(err, RAD_EPERM, "no sandbox: %s", strerror(errno));
    rc = filter_put_on(SCMP_ACT_ALLOW, fill);
    if (rc == -ENOMEM)
        return rad_fail_memory(err);
    if (rc == -ENOSYS || rc == -EINVAL)
        log_warn("sandbox incomplete lacks=seccomp");
    else if (rc < 0)
        return rad_fail(err, RAD_EPERM, "no sandbox: %s", strerror(-rc));
    return 0;
}
