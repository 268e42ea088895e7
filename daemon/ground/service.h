/* service.h - what a daemon does for the system that runs it
 *
 * Thread: main's, and the loop's. */
#ifndef RADD_DAEMON_SERVICE_H
#define RADD_DAEMON_SERVICE_H

#include "base/error.h"

#include <stdbool.h>
#include <uv.h>

/* Where daemons listen unless told otherwise. */
#define RADCOORD_PORT "7420"
#define RADD_PORT     "7421"

/* As many descriptors as this process may have: many systems give less for the
 * sake of programs that cannot use more.  RAD_ESHORT: too few for a daemon. */
int service_raise_descriptors(struct rad_error *err);

/* Tell systemd: "READY=1", "RELOADING=1", "STOPPING=1", "STATUS=..."; does
 * nothing unless NOTIFY_SOCKET is set (sd_notify(3)).  fd is what
 * service_notify_open() made: a sign of life must not want a descriptor. */
int service_notify_open(void);
void service_notify(int fd, const char *state);

/* How long systemd waits for a WATCHDOG=1 [ms]; 0: it does not. */
uint64_t service_watchdog_ms(void);

/* A credential that systemd handed over (LoadCredential=): its file's path,
 * and true; false and an empty path where there is none, or nothing but white
 * space in it. */
bool service_credential(const char *name, char *path, size_t size);

/* End by log_out_of_memory() where libuv or libcrypto, which abort or crash in
 * places, cannot allocate; to be called before their first use. */
void service_catch_no_memory(void);

/* Write lines to path, whole where that is a file (output.h).
 * RAD_ECANTCREAT or RAD_EIO. */
int service_ports_file(const char *path, const char *const lines[], int n,
                       struct rad_error *err);

/* Take the folder for this process alone, until it ends or closes what is
 * returned; RAD_ECANTCREAT when another has it, RAD_EPERM when the lock is
 * denied to us. */
int service_lock_dir(const char *path, struct rad_error *err);

/* Call end(arg) once when the pipe at fd reaches its end: whoever started
 * this process is gone.  fd < 0 does nothing. */
struct service_lifetime {
    uv_poll_t poll;
    void (*end)(void *arg);
    void *arg;
};
int service_watch_lifetime(struct service_lifetime *l, uv_loop_t *loop, int fd,
                           void (*end)(void *arg), void *arg,
                           struct rad_error *err);

/* Large pieces of memory go back to the system as they are freed, whatever lies
 * beside them; and all that is free does now. */
void service_return_memory(void);
void service_trim_memory(void);

#endif
