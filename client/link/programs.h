/* programs.h - where our programs are, and what they are started with
 *
 * They are looked for beside radsubmit's own, in the folders where a build or
 * an installation has them, and along PATH.
 * Thread: one.  */
#ifndef RADD_CLIENT_PROGRAMS_H
#define RADD_CLIENT_PROGRAMS_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

/* The program's path, or its name alone for PATH to find. */
void programs_path(const char *name, char *path, size_t size);

/* The folder of our program rpict, where it is; false: it is nowhere. */
bool programs_rpict(char *path, size_t size);

/* The environment with VARIABLE=VALUE, `setting`, in the place of what it has
 * of that name; the array is to be freed, not what it points at.  NULL when
 * memory is out. */
char **programs_environment(char *setting);

/* Start a program of PATH with default signals in a session of its own: its
 * input from the descriptor `in` (negative: nothing), its output where our
 * errors go, and `keep` as PROGRAMS_KEPT where that is not negative.  0, or a
 * code of errno. */
#define PROGRAMS_KEPT 3
int programs_spawn(pid_t *pid, char *const argv[], char **env, int in,
                   int keep);

#endif
