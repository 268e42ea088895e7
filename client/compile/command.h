/* command.h - the `!command` lines of scene files
 *
 * /bin/sh runs a command, as the user, without standard input, in the folder
 * that command_folder() chooses; its standard error is ours.  Its output is
 * read as it comes.  It has a process group of its own, so that stopping it
 * ends a whole pipeline.  SIGINT, SIGTERM and SIGHUP, which reach our own group
 * only, are passed on to running commands; a program that handles these signals
 * itself calls command_stop_all() before it ends.
 * Thread: one in the whole program. */
#ifndef RADD_CLIENT_COMMAND_H
#define RADD_CLIENT_COMMAND_H

#include "base/files.h"

#include <stdbool.h>

struct command;

/* The folder in which a command of a scene file in `folder` runs: that folder;
 * but the current one, as with Radiance, if the command has paths (with a
 * slash) of files from the current folder and none of files from `folder`. */
const char *command_folder(const char *text, const char *folder);

/* Start a command in `folder`.  NULL with *err set: it could not be started. */
struct command *command_start(const char *text, const char *folder,
                              struct rad_error *err);

/* Its output, to be read before command_end(). */
struct rad_stream command_output(struct command *c);

/* Wait for the command's end, or stop it; free it.  RAD_EDATA: its exit status
 * is not 0; or it wrote nothing and names a program that is not installed,
 * which the status of a pipeline does not tell.  0 if it was stopped. */
int command_end(struct command *c, bool stop, struct rad_error *err);

/* End all running commands by SIGTERM.  From any thread or signal handler. */
void command_stop_all(void);

#endif
