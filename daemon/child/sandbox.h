/* sandbox.h - a job's child in a sandbox
 *
 * A child reads bytes that other people sent: a scene, its files, messages.
 * Should these bytes exploit an error of the renderer, they control a process
 * with one socket, to radd, which may
 *   from its first instruction of ours on: read files in the folder of scenes,
 *     by names that it must know; map memory, start threads, use its socket;
 *     but make no socket, run no program, write no file, look at no other
 *     process, and have no memory that is both writable and executable;
 *   once the scene is loaded: open no file at all.
 * Any other system call ends the process (SIGSYS), except calls that the C
 * library tries and can do without: these fail.
 *
 * Needs seccomp, and for the folder Landlock (Linux 5.13).  A build with
 * AddressSanitizer or ThreadSanitizer forbids less, since these look at their
 * own process; under valgrind, which knows no seccomp, nothing is put on.
 * Thread: the process's only one for sandbox_begin(). */
#ifndef RADD_DAEMON_SANDBOX_H
#define RADD_DAEMON_SANDBOX_H

#include "base/error.h"

#include <stdbool.h>

/* The features that the machine lacks for a sandbox, as "seccomp, Landlock";
 * NULL: none.  *refuse: not only the limit to the scenes' folder is lacking. */
const char *sandbox_lacks(bool *refuse);

/* Give up all rights but those that loading a scene needs.  files_dir: the
 * folder of the scene's files.  required: fail with RAD_EPERM where seccomp
 * does not work; otherwise go on without. */
int sandbox_begin(const char *files_dir, bool required, struct rad_error *err);

/* Give up opening files, in all threads. */
int sandbox_seal(bool required, struct rad_error *err);

/* Is a denied call the end of the process?  Else it fails. */
bool sandbox_kills(void);

#endif
