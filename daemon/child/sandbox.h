/* sandbox.h - the sandbox of a job's child
 *
 * A child reads bytes that other people sent: a scene, its files, messages.  If
 * these exploit an error of the renderer they control a process that has one
 * socket, to radd, and may
 *   from sandbox_begin() on: read files of the scenes' folder whose names it
 *     knows; map memory, start threads, use its socket; but make no socket, run
 *     no program, write no file, look at no other process, and have no memory
 *     that is both writable and executable;
 *   from sandbox_seal() on, when the scene is loaded: open no file at all.
 * Any other system call ends the process (SIGSYS), but calls that the C library
 * tries and can do without fail.
 *
 * It needs seccomp, and Landlock (Linux 5.13) to limit files to the folder.  A
 * build with AddressSanitizer or ThreadSanitizer forbids less, because these
 * look at their own process.  valgrind does not know seccomp, so under valgrind
 * there is no sandbox.
 * Thread: sandbox_begin() before there is a second thread. */
#ifndef RADD_DAEMON_SANDBOX_H
#define RADD_DAEMON_SANDBOX_H

#include "base/error.h"

#include <stdbool.h>

/* What this machine lacks for the sandbox, as "seccomp, Landlock"; NULL:
 * nothing.  *refuse: seccomp is lacking; else only the limit to the scenes'
 * folder is. */
const char *sandbox_lacks(bool *refuse);

/* Give up all rights but those that loading a scene from files_dir needs.
 * required: fail with RAD_EPERM where seccomp does not work; else go on without
 * it. */
int sandbox_begin(const char *files_dir, bool required, struct rad_error *err);

/* Give up opening files, in all threads. */
int sandbox_seal(bool required, struct rad_error *err);

#endif
