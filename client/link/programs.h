/* programs.h - finding and starting our programs
 *
 * They are looked for beside radsubmit, in the folders where a build or an
 * installation has them, and along PATH.
 * Thread: one. */
#ifndef RADD_CLIENT_PROGRAMS_H
#define RADD_CLIENT_PROGRAMS_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

/* The path of a program, or its name alone, to be found along PATH. */
void programs_path(const char *name, char *path, size_t size);

/* The folder of our program rpict; false: it was not found. */
bool programs_rpict(char *path, size_t size);

/* The environment with `setting`, VARIABLE=VALUE, in place of its own VARIABLE.
 * The caller frees the array, but not the strings.  NULL: memory is out. */
char **programs_environment(char *setting);

/* Start a program, found along PATH, in a session of its own and with default
 * signals.  Its input is the descriptor `in`, nothing if that is negative; its
 * output goes to our standard error; `keep`, if not negative, becomes its
 * descriptor PROGRAMS_KEPT.  Returns 0 or a code of errno. */
#define PROGRAMS_KEPT 3
int programs_spawn(pid_t *pid, char *const argv[], char **env, int in,
                   int keep);

/* Tell of such a code: RAD_ENOMEM if processes, memory or descriptors are out.
 */
int programs_not_started(const char *path, int number, struct rad_error *err);

#endif
