/* sandbox.h - what a job's child can do to the machine: next to nothing
 *
 * A child reads bytes that somebody sent: a scene, its files, the messages of
 * radd.  Should one of them find a hole in the renderer, what it has is a
 * process with one socket to radd, and that can
 *   from its first instruction of ours on: read the files of the folder of
 *     scenes, by names that it must know; map memory, start threads, talk on
 *     its socket; no socket of its own, no program, no file to write, no other
 *     process to look at, no memory to write and run;
 *   once the scene is loaded: open no file at all.
 * What is not in the list ends the process (SIGSYS), unless the C library
 * probes for it and does without.
 *
 * Needs seccomp, and for the folder Landlock (Linux 5.13).  A build with
 * AddressSanitizer or ThreadSanitizer forbids less, since these look at their
 * own process; under valgrind, which knows no seccomp, nothing is put on.
 * Thread: the process's only one for sandbox_begin(). */
#ifndef RADD_DAEMON_SANDBOX_H
#define RADD_DAEMON_SANDBOX_H

#include "base/error.h"

#include <stdbool.h>

/* What the machine lacks for the above, as "seccomp, Landlock"; NULL: nothing.
 * *refuse: and it is more than where a scene's files lie. */
const char *sandbox_lacks(bool *refuse);

/* Give up everything but what loading a scene needs.  files_dir: where its
 * files lie.  required: fail with RAD_EPERM where seccomp does not work;
 * otherwise go on without. */
int sandbox_begin(const char *files_dir, bool required, struct rad_error *err);

/* Give up opening files, in all threads. */
int sandbox_seal(bool required, struct rad_error *err);

/* Is a denied call the end of the process?  Else it fails. */
bool sandbox_kills(void);

#endif
