/* confine.c - run a program under a systemd unit's directives, by hand
 *
 * confine CALLS WRITABLE PROGRAM ARGUMENT...: no new privileges, no
 * capabilities, the system calls whose names are in the file CALLS (others fail
 * with EPERM), sockets of AF_UNIX, AF_INET and AF_INET6 alone, no memory that
 * can be written and run, no namespaces; and where the caller may, all files
 * but those below WRITABLE read-only.  What a machine without systemd can show
 * of its units: that the daemons work so. */
#include "config.h"

#include <errno.h>
#include <fcntl.h>
#include <sched.h>
#include <seccomp.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sysexits.h>
#include <unistd.h>

static void
die(const char *what)
{
    fprintf(stderr, "confine: %s: %s\n", what, strerror(errno));
    exit(EX_OSERR);
}

/* ProtectSystem=strict; false: not permitted. */
static bool
protect_system(const char *writable)
{
    struct {
        uint64_t set, clear, propagation, userns;
    } ro = { .set = 1 /* MOUNT_ATTR_RDONLY */ }, rw = { .clear = 1 };

    return unshare(CLONE_NEWNS) == 0 &&
           mount(NULL, "/", NULL, MS_REC | MS_PRIVATE, NULL) == 0 &&
           mount(writable, writable, NULL, MS_BIND | MS_REC, NULL) == 0 &&
           syscall(SYS_mount_setattr, AT_FDCWD, "/", AT_RECURSIVE, &ro,
                   sizeof ro) == 0 &&
           syscall(SYS_mount_setattr, AT_FDCWD, writable, AT_RECURSIVE, &rw,
                   sizeof rw) == 0;
}

static void
drop_capabilities(void)
{
    for (int cap = 0; cap < 64; cap++)
        if (prctl(PR_CAPBSET_READ, cap) > 0)
            prctl(PR_CAPBSET_DROP, cap); /* fails where there are none */
}

/* SystemCallFilter=: the calls of the list. */
static int
allow_listed(scmp_filter_ctx f, const char *path)
{
    FILE *list = fopen(path, "r");
    char name[64];
    int n = 0;

    if (!list)
        die(path);
    while (fscanf(list, "%63s", name) == 1) {
        int call = seccomp_syscall_resolve_name(name);

        if (call == __NR_SCMP_ERROR || call == SCMP_SYS(socket) ||
            call == SCMP_SYS(clone) || call == SCMP_SYS(mmap) ||
            call == SCMP_SYS(mprotect))
            continue; /* unknown here, or below */
        if (seccomp_rule_add(f, SCMP_ACT_ALLOW, call, 0) < 0)
            die(name);
        n++;
    }
    fclose(list);
    return n;
}

/* RestrictAddressFamilies=, MemoryDenyWriteExecute=, RestrictNamespaces=. */
static int
allow_parts(scmp_filter_ctx f)
{
    static const unsigned families[] = { AF_UNIX, AF_INET, AF_INET6 };
    const uint64_t spaces = CLONE_NEWNS | CLONE_NEWUTS | CLONE_NEWIPC |
                            CLONE_NEWUSER | CLONE_NEWPID | CLONE_NEWNET |
                            CLONE_NEWCGROUP;
    int rc = 0;

    for (int i = 0; i < 3 && rc == 0; i++)
        rc = seccomp_rule_add(f, SCMP_ACT_ALLOW, SCMP_SYS(socket), 1,
                              (struct scmp_arg_cmp){
                                  .arg = 0,
                                  .op = SCMP_CMP_EQ,
                                  .datum_a = families[i] });
    if (rc == 0)
        rc = seccomp_rule_add(f, SCMP_ACT_ALLOW, SCMP_SYS(clone), 1,
                              SCMP_A0(SCMP_CMP_MASKED_EQ, spaces, 0));
    if (rc == 0) /* its flags cannot be seen */
        rc = seccomp_rule_add(f, SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(clone3), 0);
    if (rc == 0)
        rc = seccomp_rule_add(f, SCMP_ACT_ALLOW, SCMP_SYS(mmap), 1,
                              SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0));
    if (rc == 0)
        rc = seccomp_rule_add(f, SCMP_ACT_ALLOW, SCMP_SYS(mmap), 1,
                              SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_WRITE, 0));
    if (rc == 0)
        rc = seccomp_rule_add(f, SCMP_ACT_ALLOW, SCMP_SYS(mprotect), 1,
                              SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0));
    return rc;
}

static void
filter(const char *calls)
{
    scmp_filter_ctx f = seccomp_init(SCMP_ACT_ERRNO(EPERM));

    if (!f || allow_listed(f, calls) < 100 || allow_parts(f) < 0 ||
        /* to begin with */
        seccomp_rule_add(f, SCMP_ACT_ALLOW, SCMP_SYS(execve), 0) < 0 ||
        seccomp_load(f) < 0)
        die("filter");
    seccomp_release(f);
}

int
main(int argc, char *argv[])
{
    if (argc < 4)
        return EX_USAGE;
    umask(0077);
    if (!protect_system(argv[2]))
        fprintf(stderr, "confine: files are not protected: %s\n",
                strerror(errno));
    drop_capabilities();
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) < 0)
        die("no new privileges");
    filter(argv[1]);
    execv(argv[3], argv + 3);
    die(argv[3]);
}
