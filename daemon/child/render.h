/* render.h - the main function of a job's child: its loop talks, and threads
 * render (pool/pool.h)
 *
 * radd starts it in a process of its own, with one end of a socket pair, the
 * link, as descriptor RENDER_LINK_FD.  On the link go the messages that
 * proto/message.def permits in the sessions CHILD_NEW, CHILD, PARENT_NEW and
 * PARENT.  When the link is closed the process ends. */
#ifndef RADD_DAEMON_RENDER_H
#define RADD_DAEMON_RENDER_H

#include <stddef.h>

#define RENDER_CHILD_OPTION "--child"
#define RENDER_LINK_FD      3

/* radd --child FILES-DIR THREADS MEMORY-MIB NICE PIXEL-S SANDBOX RADD; returns
 * the exit status.  PIXEL-S: most processor seconds of a pixel, 0: no limit.
 * SANDBOX: RENDER_SANDBOXED if a sandbox is required (sandbox.h), else empty.
 * RADD: radd's process id; a child of another process ends at once. */
#define RENDER_SANDBOXED "sandboxed"
int render_main(int argc, char *argv[]);

/* A child had no memory.  `limit` is what it may have [MiB], `own` what its job
 * may have anywhere (--memory-mib); 0: any.  Say in text, after what is there,
 * which limit it was.  RAD_EDATA if it was the job's, which is the same at all
 * workers, so the job fails; RAD_ENOMEM if it was radd's or the machine's. */
int render_blame_limit(unsigned own, unsigned limit, char *text, size_t size);

#endif
