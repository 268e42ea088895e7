/* check_confine.c - rights that radweb gives up, also where memory is short */
#include "config.h"

#include "web/confine.h"

#include "tests/scarce.h"
#include "tests/unit.h"

#include <errno.h>
#include <stdio.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { CONFINED, OPEN, NO_MEMORY, OTHER, NO_MORE };

/* How a process ends that gives up its rights and lacks the memory of one
 * allocation; NO_MORE: there are not so many. */
static int
begun_without(long allocation)
{
    struct rlimit patience = { 1, 2 }; /* s: libseccomp may try for ever */
    struct rad_error err = { 0 };
    int status, rc;
    pid_t pid = fork();

    if (pid == 0) {
        freopen("/dev/null", "w", stderr);
        setrlimit(RLIMIT_CPU, &patience);
        scarce_at = allocation;
        rc = confine_begin(&err);
        if (scarce_at > 0)
            _exit(NO_MORE);
        if (rc < 0)
            _exit(err.code == RAD_ENOMEM ? NO_MEMORY : OTHER);
        _exit(rename("/nowhere", "/else") < 0 && errno == EPERM ? CONFINED
                                                                : OPEN);
    }
    ck_assert_int_eq(waitpid(pid, &status, 0), pid);
    /* libseccomp may end the process */
    return WIFEXITED(status) ? WEXITSTATUS(status) : NO_MEMORY;
}

TEST(what_lacks_memory_is_not_half_confined)
{
    int how = begun_without(0), refused = 0;

    if (how != CONFINED) {
        puts("SKIP: no seccomp here");
        return;
    }
    for (long i = 1; (how = begun_without(i)) != NO_MORE; i++) {
        ck_assert_msg(how == CONFINED || how == NO_MEMORY, "allocation %ld: %d",
                      i, how);
        refused += how == NO_MEMORY;
    }
    ck_assert_int_gt(refused, 10);
}
