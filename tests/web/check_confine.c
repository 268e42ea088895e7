/* check_confine.c - rights that radweb gives up, also where memory is short */
#include "config.h"

#include "web/confine.h"

#include "tests/scarce.h"
#include "tests/unit.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/seccomp.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#define FCHMODAT2 452

enum { CONFINED, HALF, OPEN, NO_MEMORY, OTHER, NO_MORE };

static bool
denied(int rc)
{
    return rc < 0 && errno == EPERM;
}

/* Modes are set by other calls in later kernels. */
static int
how_confined(void)
{
    if (!denied(rename("/nowhere", "/else")))
        return OPEN;
    return denied(chmod("/nowhere", 0)) &&
                   denied((int)syscall(FCHMODAT2, AT_FDCWD, "/nowhere", 0, 0))
               ? CONFINED
               : HALF;
}

/* How a process ends that gives up its rights and lacks the memory of one
 * allocation; NO_MORE: there are not so many. */
static int
begun_without(long allocation)
{
    /* processor time, of which it takes 10 ms: libseccomp may try for ever */
    struct itimerval patience = { .it_value = { .tv_usec = 200000 } };
    struct rad_error err = { 0 };
    int status, rc;
    pid_t pid = fork();

    if (pid == 0) {
        freopen("/dev/null", "w", stderr);
        setitimer(ITIMER_PROF, &patience, NULL);
        scarce_at = allocation;
        rc = confine_begin(&err);
        if (scarce_at > 0)
            _exit(NO_MORE);
        if (rc < 0)
            _exit(err.code == RAD_ENOMEM ? NO_MEMORY : OTHER);
        _exit(how_confined());
    }
    ck_assert_int_eq(waitpid(pid, &status, 0), pid);
    /* libseccomp may end the process */
    return WIFEXITED(status) ? WEXITSTATUS(status) : NO_MEMORY;
}

static bool
has_filters(void)
{
    uint32_t refuse = SECCOMP_RET_ERRNO;

    return !RAD_SANITIZED &&
           syscall(SYS_seccomp, SECCOMP_GET_ACTION_AVAIL, 0, &refuse) == 0;
}

TEST(what_lacks_memory_is_not_half_confined)
{
    int how, refused = 0;

    if (!has_filters()) {
        puts("SKIP: no filters of system calls here");
        return;
    }
    ck_assert_int_eq(begun_without(0), CONFINED);
    for (long i = 1; (how = begun_without(i)) != NO_MORE; i++) {
        ck_assert_msg(how == CONFINED || how == NO_MEMORY, "allocation %ld: %d",
                      i, how);
        refused += how == NO_MEMORY;
    }
    ck_assert_int_gt(refused, 10);
}
