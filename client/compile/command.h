/* command.h - the `!command` lines of scene files
 *
 * A command is run by /bin/sh, as the user, in the folder of the scene file
 * that it stands in, or in ours (command_folder()), with no standard input;
 * what it writes to its standard error goes where ours goes.  Its output is
 * read as it comes.  It has a process group of its own, so that all of a
 * pipeline ends when it is stopped; SIGINT, SIGTERM and SIGHUP, which reach our
 * group only, are passed on to the commands that run, unless the program
 * handles them itself: then it calls command_stop_all() before it ends.
 * Thread: one in the whole program. */
#ifndef RADD_CLIENT_COMMAND_H
#define RADD_CLIENT_COMMAND_H

#include "base/files.h"

#include <stdbool.h>

struct command;

/* Where to run a command of a scene file in `folder`: there; but in the current
 * folder, as Radiance does, where its words are paths, with a slash, of files
 * from that one on and none is of a file from the scene file's. */
const char *command_folder(const char *text, const char *folder);

/* Start it in `folder`.  Negative code: it could not be started. */
struct command *command_start(const char *text, const char *folder,
                              struct rad_error *err);

/* The command's output, to be read while the command is there. */
struct rad_stream command_output(struct command *c);

/* Wait for the command's end, or stop it, and free it.  RAD_EDATA for an exit
 * status other than 0, or when it wrote nothing and names a program that is not
 * installed (in a pipeline, no status tells); 0 if it was stopped. */
int command_end(struct command *c, bool stop, struct rad_error *err);

/* End all commands that run, as SIGTERM does.  From any thread or signal
 * handler. */
void command_stop_all(void);

#endif
