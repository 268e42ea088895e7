/* render.h - the body of a job's child: threads that render, a loop that talks
 *
 * radd starts this in a process of its own, with one end of a socket pair as
 * descriptor RENDER_LINK_FD: the link.  Its messages are those that
 * proto/message.def permits at CHILD_NEW, CHILD, PARENT_NEW and PARENT.  The
 * process ends when the link does. */
#ifndef RADD_DAEMON_RENDER_H
#define RADD_DAEMON_RENDER_H

#define RENDER_CHILD_OPTION "--child"
#define RENDER_LINK_FD      3

/* radd --child FILES-DIR THREADS MEMORY-MIB NICE PIXEL-S SANDBOX; returns the
 * exit status.  SANDBOX: RENDER_SANDBOXED if a sandbox is required (sandbox.h),
 * else empty.  PIXEL-S: most processor time of a pixel, 0 for any. */
#define RENDER_SANDBOXED "sandboxed"
int render_main(int argc, char *argv[]);

#endif
