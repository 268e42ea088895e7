/* output.h - files that are there whole or not at all
 *
 * A file is written under a temporary name in its own folder and renamed over
 * its name when complete, with the mode, and as far as may be the owner and
 * group, of the one that was there.  What is no regular file (a terminal, a
 * pipe, /dev/null), and what a descriptor of ours already writes (/dev/stdout),
 * is written as it is; a link's target is made or replaced, not the link.
 * Thread: any, each output its own.  */
#ifndef RADD_PROTO_OUTPUT_H
#define RADD_PROTO_OUTPUT_H

#include "base/error.h"

#include <stdbool.h>
#include <stdio.h>

struct rad_output {
    FILE *file;
    char *path; /* for messages; NULL: standard output */
    char *real; /* what is written or replaced: path without links */
    char *temp;
    bool durable; /* on the disk before it gets its name */
};

/* Before anything is opened: where standard input, output or error is closed,
 * its number is taken by what can only fail to be read or written, so that no
 * file or socket gets it.  And a file that a limit (ulimit -f) lets grow no
 * larger is an error of who writes it, not a signal. */
void rad_output_guard(void);

/* Can path be written?  RAD_ECANTCREAT with the reason.  To be asked before
 * work begins: a picture that nobody can keep need not be rendered. */
int rad_output_check(const char *path, struct rad_error *err);

/* Do two names stand for one file, of which the second writer would take away
 * what the first wrote?  A terminal, a pipe or /dev/null does not count. */
bool rad_output_same(const char *a, const char *b);

/* Open for writing; path NULL: standard output.  RAD_ECANTCREAT. */
int rad_output_open(struct rad_output *out, const char *path, bool durable,
                    struct rad_error *err);

/* Give the file its name.  RAD_EIO, and the old file stays. */
int rad_output_commit(struct rad_output *out, struct rad_error *err);

/* Take back what was written; does nothing after a commit. */
void rad_output_abort(struct rad_output *out);

/* All three: the n bytes become the file. */
int rad_output_write(const char *path, const void *bytes, size_t n,
                     bool durable, struct rad_error *err);

/* Make the folder and those above it, mode 0755 (the last one `mode`); it is
 * fine if it is there.  RAD_ECANTCREAT. */
int rad_make_dir(const char *path, int mode, struct rad_error *err);

/* Remove the folder and what is in it, but not what links in it lead to; what
 * cannot be removed stays, and the rest goes. */
void rad_remove_dir(const char *path);

#endif
