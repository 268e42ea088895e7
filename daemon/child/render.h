/* render.h - the main function of a job's child: threads render, a loop talks
 *
 * radd starts it in a process of its own, with one end of a socket pair, the
 * link, as descriptor RENDER_LINK_FD.  On the link go the messages that
 * proto/message.def permits in the sessions CHILD_NEW, CHILD, PARENT_NEW and
 * PARENT.  When the link is closed the process ends. */
#ifndef RADD_DAEMON_RENDER_H
#define RADD_DAEMON_RENDER_H

#define RENDER_CHILD_OPTION "--child"
#define RENDER_LINK_FD      3

/* radd --child FILES-DIR THREADS MEMORY-MIB NICE PIXEL-S SANDBOX RADD; returns
 * the exit status.  PIXEL-S: most processor seconds of a pixel, 0: no limit.
 * SANDBOX: RENDER_SANDBOXED if a sandbox is required (sandbox.h), else empty.
 * RADD: radd's process id; a child of another process ends at once. */
#define RENDER_SANDBOXED "sandboxed"
int render_main(int argc, char *argv[]);

#endif
