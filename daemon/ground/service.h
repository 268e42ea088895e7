/* service.h - what a daemon does for the system that runs it
 *
 * Thread: main's, and the loop's. */
#ifndef RADD_DAEMON_SERVICE_H
#define RADD_DAEMON_SERVICE_H

#include "base/error.h"

#include <stdbool.h>
#include <uv.h>

/* Ports at which daemons listen by default. */
#define RADCOORD_PORT "7420"
#define RADD_PORT     "7421"

/* Raise the limit of descriptors as far as this process may: many systems set
 * it low for programs that cannot use more.  RAD_ESHORT: too few are allowed
 * for a daemon. */
int service_raise_descriptors(struct rad_error *err);

/* Open systemd's socket; -1: NOTIFY_SOCKET is not set (sd_notify(3)), or cannot
 * be opened, as the log tells.  Tell systemd a state: "READY=1", "RELOADING=1",
 * "STOPPING=1", "WATCHDOG=1"; with fd -1 do nothing.  The socket stays open, so
 * that a sign of life needs no new descriptor. */
int service_notify_open(void);
void service_notify(int fd, const char *state);

/* How long systemd waits for a WATCHDOG=1 [ms]; 0: it does not wait. */
uint64_t service_watchdog_ms(void);

/* Set path to the file of a credential of systemd's (LoadCredential=).  False,
 * and path is "": there is no such file, or only white space in it. */
bool service_credential(const char *name, char *path, size_t size);

/* Write n lines to path; a file appears there only when it is whole (output.h).
 * RAD_ECANTCREAT or RAD_EIO. */
int service_ports_file(const char *path, const char *const lines[], int n,
                       struct rad_error *err);

/* Lock the folder for this process alone, until it ends or closes the
 * descriptor that is returned.  RAD_ECANTCREAT: another process has the lock,
 * or its file cannot be made; RAD_EPERM: the file is denied to us; RAD_EDATA:
 * the file is no regular one; RAD_EIO: the file system locks nothing. */
int service_lock_dir(const char *path, struct rad_error *err);

/* Call end(arg) once when the pipe at fd reaches its end: the process that
 * started this one is gone.  fd < 0: do nothing.  RAD_EUSAGE: fd cannot be
 * watched.  *l is in use until its poll handle is closed. */
struct service_lifetime {
    uv_poll_t poll;
    void (*end)(void *arg);
    void *arg;
};
int service_watch_lifetime(struct service_lifetime *l, uv_loop_t *loop, int fd,
                           void (*end)(void *arg), void *arg,
                           struct rad_error *err);

/* From now on return large blocks to the system when they are freed. */
void service_return_memory(void);
/* Return all free memory to the system now. */
void service_trim_memory(void);

#endif
